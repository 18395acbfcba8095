"""A built database, read lazily: faces with what they are, how they look, and how they are drawn."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Self, overload

import numpy as np

from ..face.bilinear import fit_identity
from ..face.drawing import draw
from ..face.exaggeration import LEVELS
from ..face.face import Face
from ..face.model import FaceModel
from ..geometry.view import View
from ..sketch import WRINKLE, Segment, Sketch
from .build import MODEL, decomposed
from .provenance import licence
from .source import FaceSource
from .store import Store

_LEFT_OUT = 0.1  # of the faces, or of the identities, in the test part of a split (paper 4.4)


@dataclass(frozen=True)
class DatabaseFace:
    """One face of a database; what is large is read when it is asked for.

    Parameters
    ----------
    identity : int
    expression : str
    level : int
        Of exaggeration, 1 to 4; 1 is the face as it is.
    """

    identity: int
    expression: str
    level: int
    _database: FaceDatabase = field(repr=False)

    @property
    def vertices(self) -> np.ndarray:
        """Vertices (V, 3) float32, millimetres, of the model's topology."""
        return self._database.model.template.subdivision @ self._database.coarse(self)

    @property
    def weights(self) -> tuple[np.ndarray, np.ndarray]:
        """Identity (p,) and expression (q,) weights in the database's bilinear model."""
        return self._database.identity_weights(self.identity, self.level), self._database.expression_weights(
            self.expression
        )

    @property
    def face(self) -> Face:
        """The face as its model has it, with the vertices of the database."""
        return Face(self._database.model, self.vertices, *self.weights)

    @property
    def sketch(self) -> Sketch:
        """Silhouette, feature lines and wrinkles in the front view."""
        drawn = draw(self._database.model.template, self.vertices, View(), None)
        wrinkles = self._database.wrinkles(self)
        return Sketch((*drawn.segments, *(Segment(WRINKLE, line) for line in wrinkles if np.isfinite(line).all())))


class FaceDatabase(Sequence[DatabaseFace]):
    """Faces by identity, level of exaggeration and expression, in that order; see `open`.

    Parameters
    ----------
    store : Store
    model : FaceModel
        The bilinear model of its first 150 identities.

    Examples
    --------
    >>> db = sw.FaceDatabase.open("faces")
    >>> face = db[db.index(identity=1, expression="laugh", level=3)]
    >>> face.identity, face.expression, face.level
    (1, 'laugh', 3)
    >>> train, test = db.split("identity")
    >>> {db[number].identity for number in test} & {db[number].identity for number in train}
    set()
    """

    def __init__(self, store: Store, model: FaceModel) -> None:
        self._store, self.model = store, model

    @classmethod
    def open(cls, path: str | os.PathLike[str]) -> Self:
        """Open a database that `sketchwidget database` built.

        Raises
        ------
        FileNotFoundError
            If there is none.
        ValueError
            If it is unfinished, damaged or of another version.
        """
        folder = Path(path)
        store = Store.open(folder)
        if not (folder / MODEL).exists():
            raise ValueError(f"{folder} is unfinished: the command that began it goes on where it was")
        try:
            return cls(store, FaceModel.load(folder / MODEL))
        except ValueError as error:
            raise ValueError(f"{error}; the command that built the database mends it") from error

    @property
    def expressions(self) -> tuple[str, ...]:
        """Names of the expressions."""
        return self._store.plan.expressions

    @property
    def identities(self) -> int:
        """Number of identities."""
        return self._store.plan.identities

    def __len__(self) -> int:
        return self.identities * LEVELS * len(self.expressions)

    @overload
    def __getitem__(self, index: int) -> DatabaseFace: ...
    @overload
    def __getitem__(self, index: slice) -> list[DatabaseFace]: ...
    def __getitem__(self, index: int | slice) -> DatabaseFace | list[DatabaseFace]:
        """The face number `index`, from 0 to the number of faces less 1."""
        if isinstance(index, slice):
            return [self[number] for number in range(*index.indices(len(self)))]
        if not -len(self) <= index < len(self):
            raise IndexError(f"a database of {len(self):,} faces has no face {index:,}")
        person, expression = divmod(int(index) % len(self), len(self.expressions))
        identity, level = divmod(person, LEVELS)
        return DatabaseFace(identity, self.expressions[expression], level + 1, self)

    def index(self, identity: int, expression: str, level: int = 1) -> int:  # type: ignore[override]
        """Number of the face with this identity, expression and level.

        Raises
        ------
        ValueError
            If there is none.
        """
        if not (0 <= identity < self.identities and 1 <= level <= LEVELS and expression in self.expressions):
            raise ValueError(
                f"a face has an identity from 0 to {self.identities - 1}, a level from 1 to {LEVELS} and one of the"
                f" expressions {', '.join(self.expressions)}; given {identity}, {level} and {expression!r}"
            )
        return (identity * LEVELS + level - 1) * len(self.expressions) + self.expressions.index(expression)

    def split(self, kind: str, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
        """Numbers of the faces to train on and of those to test on, a tenth.

        Parameters
        ----------
        kind : str
            "random": faces of all identities are left out for the test; "identity": whole identities are, of those
            that the model was not made of if there are enough.
        seed : int

        Raises
        ------
        ValueError
            If the kind is another, or a single identity is to be split.
        """
        random = np.random.default_rng([seed, len(self)])
        if kind == "random":
            left_out = np.zeros(len(self), dtype=bool)
            left_out[random.permutation(len(self))[: round(_LEFT_OUT * len(self))]] = True
        elif kind == "identity":
            if self.identities < 2:
                raise ValueError("a split by identity needs two of them; this database has one")
            # Those that not even the model has seen, if there are enough of them.
            count = max(1, round(_LEFT_OUT * self.identities))
            unseen = self.identities - len(self.model.bilinear.identities) // LEVELS
            first = self.identities - unseen if unseen >= count else 0
            people = first + random.permutation(self.identities - first)[:count]
            left_out = np.isin(np.arange(len(self)) // (LEVELS * len(self.expressions)), people)
        else:
            raise ValueError(f"a split is 'random' or 'identity'; given {kind!r}")
        return np.flatnonzero(~left_out), np.flatnonzero(left_out)

    @cached_property
    def interpolated(self) -> Interpolated:
        """Further faces between random pairs of those that the model was made of (paper 4.4)."""
        return Interpolated(self.model, self._store.plan.interpolated, self._store.plan.seed)

    @property
    def crossing(self) -> dict[str, float]:
        """Share of the faces whose "lips" cross, and of those whose "lids" enter the eyeballs."""
        found = np.asarray(self._store.array("crossing")[:]) > 0
        return dict(zip(("lips", "lids"), found.reshape(-1, 2).mean(axis=0).tolist(), strict=True))

    def require_source(self, source: FaceSource, scale: float, origin: np.ndarray) -> None:
        """See that a source gives the heads that this database was built from, in the frame of their maker.

        Raises
        ------
        ValueError
            If its expressions or its heads are others.
        """
        if source.name != self._store.plan.source or tuple(source.expressions) != self.expressions:
            raise ValueError(
                f"the database is of the source {self._store.plan.source} and the expressions"
                f" {', '.join(self.expressions)}; given {source.name} with {', '.join(source.expressions)}"
            )
        self._store.require_frame(scale, origin)

    @property
    def origin(self) -> dict[str, str]:
        """What a file made of this database says of it: its sum, its source and the licence of that."""
        source = self._store.plan.source
        return {"database": self.sum, "source": source, "licence": licence(source)}

    def decompose(self, rank: tuple[int, int]) -> FaceModel:
        """A bilinear model of another rank than the database's own; see `sketchwidget.database.build.decomposed`."""
        return decomposed(self._store, self.model.template, rank)

    @property
    def sum(self) -> str:
        """SHA-256 over all faces, in hexadecimal: two databases with the same sum hold the same faces."""
        return self._store.sum()

    def expression_weights(self, name: str) -> np.ndarray:
        """Expression weights (q,) of an expression."""
        return self.model.expression_weights(name)

    def identity_weights(self, identity: int, level: int) -> np.ndarray:
        """Identity weights (p,) of a person at a level: the model's own, or fitted if the model does not know them."""
        known, row = self.model.bilinear.identities, identity * LEVELS + level - 1
        if row < len(known):
            return known[row]
        meshes = self.person(identity, level)
        return fit_identity(self.model.bilinear, meshes.reshape(len(meshes), -1), self.model.bilinear.expressions)

    def person(self, identity: int, level: int) -> np.ndarray:
        """Coarse vertices (e, n, 3) of a person in all expressions."""
        return self._read("vertices", (identity, level - 1))

    def wrinkles_of(self, identity: int, level: int) -> np.ndarray:
        """Wrinkle lines (e, 48, 12, 2) of a person in all expressions, NaN where there are no more."""
        return self._read("wrinkles", (identity, level - 1))

    def coarse(self, face: DatabaseFace) -> np.ndarray:
        """Coarse vertices (n, 3) of a face."""
        return self._read("vertices", self._place(face))

    def wrinkles(self, face: DatabaseFace) -> np.ndarray:
        """Wrinkle lines (48, 12, 2) of a face, NaN where there are no more."""
        return self._read("wrinkles", self._place(face))

    def _place(self, face: DatabaseFace) -> tuple[int, int, int]:
        return face.identity, face.level - 1, self.expressions.index(face.expression)

    def _read(self, name: str, place: tuple[int, ...]) -> np.ndarray:
        try:
            read = np.asarray(self._store.array(name)[place])
            if name == "vertices" and not np.isfinite(read).all():
                raise ValueError("its file is missing")
            return read
        except Exception as error:  # whatever a codec makes of damaged bytes
            raise OSError(
                f"{self._store.path / name}: identity {place[0]} cannot be read;"
                " the command that built the database mends it"
            ) from error


class Interpolated(Sequence[Face]):
    """Faces whose weights lie between those of two random faces of a model, made when they are asked for.

    Parameters
    ----------
    model : FaceModel
    count : int
    seed : int
    """

    def __init__(self, model: FaceModel, count: int, seed: int) -> None:
        self._model, self._count, self._seed = model, count, seed

    def __len__(self) -> int:
        return self._count

    @overload
    def __getitem__(self, index: int) -> Face: ...
    @overload
    def __getitem__(self, index: slice) -> list[Face]: ...
    def __getitem__(self, index: int | slice) -> Face | list[Face]:
        """The face number `index`; the same number is always the same face."""
        if isinstance(index, slice):
            return [self[number] for number in range(*index.indices(self._count))]
        if not -self._count <= index < self._count:
            raise IndexError(f"there are {self._count:,} interpolated faces, and no number {index:,}")
        random = np.random.default_rng([self._seed, int(index) % self._count])
        share = random.random()
        identity, expression = (
            (1 - share) * rows[one] + share * rows[other]
            for rows in (self._model.bilinear.identities, self._model.bilinear.expressions)
            for one, other in [random.integers(len(rows), size=2)]
        )
        return self._model.face(identity, expression)
