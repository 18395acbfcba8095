"""The picture on the head: projection, diffusion over the background, and what the picture does not show."""

from __future__ import annotations

import cv2
import igl
import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu
from scipy.spatial import KDTree

from ..face.model import FaceModel
from ..face.template import PARTS
from ..geometry.camera import Camera
from ..geometry.edges import edges
from ..geometry.rasterise import rasterise
from ..portrait.landmarks import FaceLandmarks
from .coarse import CoarseFit
from .eyes import Eyeball
from .iris import iris_colour, iris_radius, paint
from .template import AvatarTemplate

_FACING = (0.15, 0.5)  # cosine with the view: from where a texel is seen, and where wholly
_HIDDEN_MM = 2.0  # behind another surface
_NECK_MM = (2.0, 10.0)  # below the chin: what is there may be a collar
_JAW = 0.01  # of its breadth: how far inside it the face is sure
_EAR_MM = 21.0  # about the ears' outline: hair may lie over them
_PULL = 0.008  # of hidden skin towards the typical colour of its region, against its neighbours
_SURE, _RIM = 0.7, 0.012  # of a mask: what is the person; of the picture's side: its rim, which has background in it

_MENTON = 8


def diffused(image: np.ndarray, inside: np.ndarray) -> np.ndarray:
    """A picture whose pixels outside a region continue it: section 3.2.3, Diffused Texture.

    Breadth first from the region, each pixel takes the mean colour of its neighbours that were reached before.

    Parameters
    ----------
    image : (H, W, 3) uint8 array
    inside : (H, W) bool array

    Returns
    -------
    (H, W, 3) uint8 array
        The picture itself if the region is empty.
    """
    height, width = inside.shape
    colour = np.zeros((height + 2, width + 2, 4))
    reached = np.zeros((height + 2, width + 2), dtype=bool)
    reached[1:-1, 1:-1] = inside
    colour[1:-1, 1:-1, :3] = image
    colour[..., 3] = 1
    colour[~reached] = 0
    flat, step = colour.reshape(-1, 4), width + 2
    around = np.array([-step - 1, -step, -step + 1, -1, 1, step - 1, step, step + 1])
    frame = np.zeros_like(reached)
    frame[[0, -1]] = frame[:, [0, -1]] = True
    closed = (reached | frame).ravel()
    stamp = np.zeros(closed.shape, dtype=np.int64)
    front = np.flatnonzero(reached & (cv2.erode(reached.astype(np.uint8), np.ones((3, 3))) == 0))
    while len(front):
        following = (front[:, None] + around).ravel()
        following = following[~closed[following]]
        number = np.arange(len(following))
        stamp[following] = number
        following = following[stamp[following] == number]  # each once
        total = flat[following[:, None] + around].sum(axis=1)
        flat[following] = total / total[:, 3:]
        closed[following] = True
        front = following
    result = np.array(image)
    filled = ~inside & closed.reshape(reached.shape)[1:-1, 1:-1]
    result[filled] = np.rint(colour[1:-1, 1:-1, :3][filled])
    return result


class TextureBaker:
    """Makes textures for heads of one model.

    Parameters
    ----------
    model : FaceModel
    template : AvatarTemplate
    side : int
        Pixels a side of the texture.
    """

    def __init__(self, model: FaceModel, template: AvatarTemplate, side: int) -> None:
        self._model, self._template, self._side = model, template, side
        refine, parts = model.template.subdivision, model.template.fine_parts
        self.uv = np.clip(refine @ template.chart, 0, 1).astype(np.float32)
        self._is_skin = parts == PARTS.index("skin")
        corners = self.uv * (side, -side) + (0, side)
        # Backs of eyeballs, which are never seen, lie under their fronts.
        self._triangle, self._weights = rasterise(corners, model.faces, (side, side), model.mean[:, 2])
        ears = model.mean[np.concatenate([model.curves["left_ear"], model.curves["right_ear"]])]
        self._ears = self._is_skin & (KDTree(ears).query(model.mean)[0] < _EAR_MM)
        self._ears &= np.abs(model.mean[:, 0]) > np.abs(ears[:, 0]).min() - 8
        self._scalp = np.clip(refine @ template.scalp, 0, 1)
        soft = parts <= PARTS.index("mouth")
        between = edges(model.faces)
        between = between[soft[between].all(axis=1)]
        graph = sparse.csr_matrix((np.ones(len(between)), between.T), shape=(len(parts),) * 2)
        self._neighbours = graph + graph.T

    def __call__(
        self,
        image: np.ndarray,
        person: np.ndarray,
        fit: CoarseFit,
        head: np.ndarray,
        eyes: list[Eyeball],
        marks: FaceLandmarks,
    ) -> np.ndarray:
        """The texture (side, side, 3) uint8 of a head as the picture shows it.

        Parameters
        ----------
        image : (H, W, 3) uint8 array
        person : (H, W) array
            How sure each pixel is of the person, 0 to 1.
        fit : CoarseFit
            Whose camera took the picture, and whose albedo colours what it never shows.
        head : (V, 3) array
            Fine vertices as the picture shows them, eyeballs in place.
        eyes : list of Eyeball
            To be painted.
        marks : FaceLandmarks
            Of the picture; tells where its irises are.
        """
        rim = 2 * round(_RIM * len(image) / 2) + 1
        inside = cv2.erode((person > _SURE).astype(np.uint8), np.ones((rim, rim)), borderValue=1) > 0
        picture = diffused(image, inside)
        head = np.asarray(head, dtype=np.float64)
        pixels = fit.camera.project(head)
        trust = self._trust(head, fit.camera, image.shape[:2]) * _above_jaw(pixels, marks.points)
        seen = _sampled(picture, pixels)
        colour = self._completed(seen, trust, self._flat_colours(fit))

        drawn = self._triangle >= 0
        corners, share = self._model.faces[self._triangle[drawn]], self._weights[drawn][..., None]
        known = (trust[corners][..., None] * share).sum(axis=1)
        fill = (colour[corners] * share).sum(axis=1)
        at = (pixels[corners] * share).sum(axis=1)
        texture = np.zeros((self._side, self._side, 3))
        texture[drawn] = known * _sampled(picture, at) + (1 - known) * fill
        for eye in eyes:
            self._paint(texture, eye, image, marks, fit.camera)
        # Filters look beyond the border of the chart.
        return diffused(np.rint(np.clip(texture, 0, 255)).astype(np.uint8), drawn)

    def _paint(
        self, texture: np.ndarray, eye: Eyeball, image: np.ndarray, marks: FaceLandmarks, camera: Camera
    ) -> None:
        """Paint an eyeball into the texture."""
        is_ball = np.zeros(len(self.uv), dtype=bool)
        is_ball[eye.vertices] = True
        drawn = (self._triangle >= 0) & is_ball[self._model.faces[self._triangle]].all(axis=2)
        corners, share = self._model.faces[self._triangle[drawn]], self._weights[drawn][..., None]
        place = np.zeros((len(self.uv), 3))
        place[eye.vertices] = eye.directions
        direction = (place[corners] * share).sum(axis=1)
        aside = np.linalg.norm(direction[:, :2], axis=1)
        around = direction[:, :2] / np.maximum(aside, 1e-9)[:, None]
        size = iris_radius(eye, marks, camera) / eye.radius
        colour = iris_colour(image, eye, marks)
        texture[drawn] = paint(np.arctan2(aside, direction[:, 2]), around, size, colour)

    def _trust(self, head: np.ndarray, camera: Camera, shape: tuple[int, int]) -> np.ndarray:
        """How well each vertex (V,) is seen in the picture, 0 to 1."""
        faces = self._model.faces
        pixels, depth = camera.project(head), camera.depth(head)
        triangle, weights = rasterise(pixels, faces, shape, depth)
        nearest = np.where(triangle >= 0, (depth[faces[triangle]] * weights).sum(axis=2), -np.inf).astype(np.float32)
        column, row = np.clip(pixels.astype(int), 0, (shape[1] - 1, shape[0] - 1)).T
        # The nearest surface about the pixel, at most: an edge of the mesh is no cover.
        behind = cv2.erode(nearest, np.ones((3, 3)))[row, column] - depth
        inside = ((pixels >= 0) & (pixels < (shape[1], shape[0]))).all(axis=1)
        facing = _normals(head, faces) @ camera.rotation[2]
        trust = np.clip((facing - _FACING[0]) / (_FACING[1] - _FACING[0]), 0, 1) * inside * (behind < _HIDDEN_MM)
        below = head[self._model.landmarks[_MENTON], 1] - head[:, 1]
        trust *= 1 - np.clip((below - _NECK_MM[0]) / (_NECK_MM[1] - _NECK_MM[0]), 0, 1)
        trust[~self._is_skin | self._ears] = 0.0
        return trust

    def _flat_colours(self, fit: CoarseFit) -> np.ndarray:
        """Colour (V, 3), 0 to 255, of the albedo alone."""
        albedo = self._template.albedo + np.tensordot(fit.texture, self._template.albedo_basis, axes=1)
        return np.clip(self._model.template.subdivision @ albedo, 0, 1) * 255

    def _completed(self, seen: np.ndarray, trust: np.ndarray, flat: np.ndarray) -> np.ndarray:
        """Colours (V, 3): what is seen, continued harmonically over the skin that is not.

        Unseen skin is drawn a little towards the median colour of its region, hair or skin.
        """
        scalp = self._scalp
        sure = trust > 0.5
        colour = flat.copy()
        if not sure.any():
            return colour
        skin, hair = sure & (scalp < 0.2), sure & (scalp > 0.8)
        skin_tone = np.median(seen[skin if skin.any() else sure], axis=0)
        hair_tone = np.median(seen[hair], axis=0) if hair.any() else skin_tone

        fixed = sure & self._is_skin
        free = np.flatnonzero(self._is_skin & ~fixed)
        valence = np.maximum(np.ravel(self._neighbours.sum(axis=1)), 1)
        laplacian = sparse.identity(len(seen)) - sparse.diags(1 / valence) @ self._neighbours
        system = (laplacian[free][:, free] + _PULL * sparse.identity(len(free))).tocsc()
        others = np.flatnonzero(fixed)
        coupling, factor = laplacian[free][:, others], splu(system)
        # A fringe hangs below where hair grows: what is seen tells how hair goes on beside it.
        hairy = _likeness(seen[others], hair_tone, skin_tone)
        hairy = factor.solve(_PULL * scalp[free] - coupling @ hairy)[:, None]
        typical = hairy * hair_tone + (1 - hairy) * skin_tone
        colour[fixed] = seen[fixed]
        colour[free] = factor.solve(_PULL * typical - coupling @ seen[others])
        return np.clip(colour, 0, 255)


def _likeness(colours: np.ndarray, one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """How much nearer colours (n, 3) are to one colour than to another, (n,): 1 at the first, 0 at the second."""
    apart = one - other
    if (length := float(apart @ apart)) < 1.0:
        return np.zeros(len(colours))
    return np.clip((colours - other) @ apart / length, 0.0, 1.0)


def _above_jaw(pixels: np.ndarray, landmarks: np.ndarray) -> np.ndarray:
    """Which points (n, 2) the jaw of landmarks (68, 2) does not part from the face: beside it are hair and collar."""
    jaw = landmarks[:17]
    width, high = np.ptp(jaw[:, 0]), jaw[:, 1].min() - 10 * np.ptp(jaw[:, 1])
    outline = np.concatenate([[[jaw[0, 0] - width, high]], [jaw[0] - (width, 0)], jaw, [jaw[-1] + (width, 0)]])
    outline = np.concatenate([outline, [[jaw[-1, 0] + width, high]]]).astype(np.float32)
    margin = _JAW * width
    return np.array([cv2.pointPolygonTest(outline, point, True) > margin for point in pixels.tolist()], dtype=float)


def _sampled(picture: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Colours (n, 3) at pixels (n, 2), between them linear, beyond the border its own."""
    at = (points - 0.5).astype(np.float32)
    columns = 4096  # OpenCV maps pictures, not lists, and no side may pass 32,767
    padded = np.zeros((-(-len(at) // columns) * columns, 2), dtype=np.float32)
    padded[: len(at)] = at
    x, y = cv2.split(padded.reshape(-1, columns, 2))
    sampled = cv2.remap(picture.astype(np.float32), x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return sampled.reshape(-1, 3)[: len(at)]


def _normals(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    return np.nan_to_num(np.asarray(igl.per_vertex_normals(vertices, faces.astype(np.int64))))
