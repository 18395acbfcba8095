"""A model's head as something to deform: its skin as one coarse mesh, and what follows it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import igl
import numpy as np
from scipy import sparse
from scipy.linalg import qr
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from ..face.attached import attached_parts
from ..face.exaggeration import LEVELS
from ..face.model import FaceModel
from ..face.template import PARTS
from ..geometry.alignment import similarity
from ..geometry.deformation_representation import DeformationRepresentation
from ..geometry.deformation_space import DeformationSpace
from .jaw import Jaw

EXPRESSIONS, IDENTITIES = 10, 20  # of the basis
_ATTACHED = 400  # vertices of the skin that an eye, a row of teeth or the tongue moves with


class DeformableHead:
    """The heads of one model, deformed from its mean face at rest.

    Deformations live on the coarse mesh of the skin and the mouth's inside, whose refinement every head is: it has a
    quarter of the vertices and loses nothing. Eyes, teeth and tongue are pieces of their own, which move rigidly, and
    grow, with the skin that they are attached to.

    Parameters
    ----------
    model : FaceModel
    """

    def __init__(self, model: FaceModel) -> None:
        self.model = model
        template = model.template
        self.rest = self._mesh(model.mean_identity, model.expression_weights("neutral"))
        self.skin, faces = _largest_piece(*template.soft)
        self.representation = DeformationRepresentation(self.rest[self.skin], faces)
        self._refine = template.subdivision.astype(np.float64).tocsr()
        self.jaw = Jaw(template, self._refine @ self.rest)
        self._on_skin = self._refine[:, self.skin]

    @cached_property
    def space(self) -> DeformationSpace:
        """The space spanned by normal faces that differ most (section 5.1)."""
        return DeformationSpace(self.representation, [example[self.skin] for example in self.examples])

    @cached_property
    def names(self) -> tuple[str, ...]:
        """What each example of the space is: an expression's name, or "identity" and its number."""
        expressions, people = self._chosen
        return (*(self.model.expressions[number] for number in expressions), *(f"identity {who}" for who in people))

    def rows(self, vertices: np.ndarray) -> sparse.csr_matrix:
        """Places of fine vertices (k,) as weights (k, n) of the skin's."""
        return self._on_skin[vertices]

    def coarse(self, vertices: np.ndarray) -> np.ndarray:
        """The coarse head (m, 3) whose refinement is nearest to fine vertices (V, 3)."""
        return self.model.nearest_coarse(vertices)

    def vertices(self, skin: np.ndarray, start: np.ndarray | None = None) -> np.ndarray:
        """All fine vertices (V, 3) float32 of a deformed skin (n, 3).

        Its eyes, teeth and tongue come from a coarse head (m, 3), by default the mean face at rest.
        """
        start = self.rest if start is None else start
        coarse = start.copy()
        coarse[self.skin] = skin
        for part in self._attached:
            scale, rotation, offset = similarity(start[part.skin], coarse[part.skin])
            moved = scale * start[part.vertices] @ rotation.T + offset
            if not part.is_eye:
                expected = scale * start[part.beside] @ rotation.T + offset
                moved = _narrowed(moved, expected, coarse[part.beside], rotation[:, 0])
            coarse[part.vertices] = moved
        return np.asarray(self._refine @ coarse, dtype=np.float32)

    def _mesh(self, identity: np.ndarray, expression: np.ndarray) -> np.ndarray:
        return self.model.coarse(identity, expression).astype(np.float64)

    @cached_property
    def _chosen(self) -> tuple[list[int], list[int]]:
        """Numbers of the expressions of the mean face, and of the people at rest, that differ most.

        Each is the one that differs most from the mean face once what those before it explain is taken away: pivoted QR
        decomposition. Nobody exaggerated is among them.
        """
        model = self.model.bilinear
        rest = self.model.expression_weights("neutral")
        shapes = np.einsum("kpq,p,eq->ek", model.core, self.model.mean_identity, model.expressions - rest)
        people = (model.identities[::LEVELS] - self.model.mean_identity) @ (model.core @ rest).T
        expressions, identities = (
            [int(number) for number in qr(differences.T, mode="r", pivoting=True)[-1][:count]]
            for differences, count in ((shapes, EXPRESSIONS), (people, IDENTITIES))
        )
        return [number for number in expressions if self.model.expressions[number] != "neutral"], identities

    @cached_property
    def examples(self) -> list[np.ndarray]:
        """Coarse heads (m, 3) of the basis, in the order of `names`."""
        expressions, people = self._chosen
        model, rest = self.model.bilinear, self.model.expression_weights("neutral")
        return [self._mesh(self.model.mean_identity, model.expressions[number]) for number in expressions] + [
            self._mesh(model.identities[::LEVELS][who], rest) for who in people
        ]

    @cached_property
    def _attached(self) -> list[_Part]:
        """Eyes, teeth and tongue; their coarse vertices come first in the fine mesh."""
        template, parts = self.model.template, []
        outside = self.skin[template.parts[self.skin] == PARTS.index("skin")]
        nearest = KDTree(self.rest[outside])
        for part in attached_parts(template, self._refine @ self.rest):
            vertices = part.vertices[part.vertices < template.coarse_count]
            skin = self.skin[self._strays(vertices).argsort()[:_ATTACHED]]
            parts.append(_Part(vertices, skin, outside[nearest.query(self.rest[vertices])[1]], part.is_eye))
        return parts

    def _strays(self, part: np.ndarray) -> np.ndarray:
        """How far (n,) each vertex of the skin strays in the examples from moving as a piece does, squared."""
        strays = np.zeros(len(self.skin))
        for example in self.examples:
            scale, rotation, offset = similarity(self.rest[part], example[part])
            moved = scale * self.rest[self.skin] @ rotation.T + offset
            strays += ((moved - example[self.skin]) ** 2).sum(axis=1)
        return strays


@dataclass(frozen=True, eq=False)
class _Part:
    """A loose piece, by coarse vertices: its own (p,), those of the skin (k,) that move in the examples as it does, and
    the outer skin (p,) nearest to it."""

    vertices: np.ndarray
    skin: np.ndarray
    beside: np.ndarray
    is_eye: bool


def _narrowed(points: np.ndarray, expected: np.ndarray, found: np.ndarray, across: np.ndarray) -> np.ndarray:
    """Points (p, 3) as much narrower in a direction (3,) as what is beside them (p, 3) was found than was expected."""
    middle = expected.mean(axis=0)
    wide, narrow = (expected - middle) @ across, (found - found.mean(axis=0)) @ across
    share = min(1.0, float(wide @ narrow / (wide @ wide)))
    return points + (share - 1) * ((points - middle) @ across)[:, None] * across


def _largest_piece(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of a mesh given by the numbers of its vertices (n,) and its triangles (m, 3) among them."""
    piece = connected_components(igl.adjacency_matrix(faces.astype(np.int64)), directed=False)[1]
    kept = piece == np.bincount(piece).argmax()
    return vertices[kept], (np.cumsum(kept) - 1)[faces[kept[faces].all(axis=1)]]
