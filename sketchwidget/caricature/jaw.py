"""Where the jaw's landmarks of a picture are on a head: on the silhouette of the posed face."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..face.template import PARTS, Template
from ..geometry.camera import Camera

JAW = 17  # landmarks, from the subject's right ear round the chin to the left one

_RAYS = 64  # from the middle of the face outwards
_INNER = 0.5  # of the way to the jaw: nearer to the middle are nose and mouth
_BEHIND_MM = 2.0  # the line through the mean face's landmarks: beyond are ears and neck
_BETWEEN = 1.0  # what all points between two landmarks count together, over a landmark
_MEMORY = 4  # silhouettes


@dataclass(frozen=True)
class JawMatch:
    """Where a jaw's landmarks are on a head.

    Parameters
    ----------
    vertices : (17,) int array
        One for each landmark.
    outline : (k,) int array
        What is on the silhouette between them, and was so lately ...
    targets : (k, 2) array
        ... and where in the picture it should be, in pixels: on the curve through the landmarks.
    weights : (k,) array
    lately : tuple of (m,) int arrays
        The last silhouettes, for the next match.
    """

    vertices: np.ndarray
    outline: np.ndarray
    targets: np.ndarray
    weights: np.ndarray
    lately: tuple[np.ndarray, ...]


class Jaw:
    """Finds the silhouette of a posed face, from ear to ear round the chin.

    The face is what lies before ears and neck. Rays from its middle outwards part it into sectors, and the outermost
    vertex of each as it is seen is on the silhouette: on a cheek that is turned away the cheek's contour, on the other
    side the jaw's edge.

    Parameters
    ----------
    template : Template
    mean : (V, 3) array
        The mean face.
    """

    def __init__(self, template: Template, mean: np.ndarray) -> None:
        self._defaults = template.landmarks[:JAW]
        jaw = mean[self._defaults]
        middle = np.array([0.0, mean[template.landmarks[JAW:], 1].mean()])
        angle, distance = _polar(mean[:, :2] - middle)
        angles, distances = _polar(jaw[:, :2] - middle)
        first, last = 1.5 * angles[0] - 0.5 * angles[1], 1.5 * angles[-1] - 0.5 * angles[-2]
        face = template.fine_parts == PARTS.index("skin")
        face &= (angle > first) & (angle < last)
        face &= distance > _INNER * np.interp(angle, angles, distances)
        face &= mean[:, 2] >= np.interp(angle, angles, jaw[:, 2]) - _BEHIND_MM
        self._face = np.flatnonzero(face)
        self._ray = ((angle[self._face] - first) / (last - first) * _RAYS).astype(int)
        self._ray_of = np.full(len(mean), -1)
        self._ray_of[self._face] = self._ray
        self._rays = ((angles - first) / (last - first) * _RAYS).astype(int)  # of the mean face's landmarks
        along = first + (np.arange(_RAYS) + 0.5) / _RAYS * (last - first)
        self._directions = np.stack([np.sin(along), -np.cos(along)], axis=1)
        # A landmark is looked for from its neighbour on one side to that on the other.
        borders = np.concatenate([[first], angles, [last]])
        self._reach = (along >= borders[:-2, None]) & (along <= borders[2:, None])

    def silhouette(self, vertices: np.ndarray, camera: Camera) -> np.ndarray:
        """Fine vertices (64,) of a head (V, 3) on its silhouette, ray by ray; -1 where a ray has none."""
        seen = vertices[self._face] @ camera.rotation[:2].T
        directions = self._directions @ camera.rotation[:2, :2].T
        outwards = (seen * directions[self._ray]).sum(axis=1)
        order = np.lexsort((-outwards, self._ray))
        rays, outermost = np.unique(self._ray[order], return_index=True)
        found = np.full(_RAYS, -1)
        found[rays] = self._face[order[outermost]]
        return found

    def match(
        self,
        vertices: np.ndarray,
        camera: Camera,
        landmarks: np.ndarray,
        weights: np.ndarray,
        before: JawMatch | None = None,
    ) -> JawMatch:
        """Where landmarks are on a posed head.

        Parameters
        ----------
        vertices : (V, 3) array
        camera : Camera
        landmarks : (17, 2) array
            Pixels.
        weights : (17,) array
        before : JawMatch, optional
            Of a moment ago. What was on the silhouette then and was pulled inwards stays held, or it would come out
            again while what lay behind it is pulled.
        """
        silhouette = self.silhouette(vertices, camera)
        seen = camera.project(vertices[silhouette])
        distance = np.linalg.norm(seen[None] - landmarks[:, None], axis=2)
        distance[~(self._reach & (silhouette >= 0))] = np.inf
        known = weights > 0
        found = np.flatnonzero(known & np.isfinite(distance.min(axis=1)))
        rays = self._rays
        if len(found):  # those that do not count are between those that do, wherever they are in the picture
            shifts = np.interp(np.arange(JAW), found, distance.argmin(axis=1)[found] - rays[found])
            rays = np.maximum.accumulate(np.clip(np.rint(rays + shifts).astype(int), 0, _RAYS - 1))
        matched = np.where(silhouette[rays] >= 0, silhouette[rays], self._defaults)
        lately = ((before.lately if before else ()) + (silhouette[silhouette >= 0],))[-_MEMORY:]
        outline = np.unique(np.concatenate(lately))
        along = np.interp(self._ray_of[outline], rays, np.arange(JAW))
        index = np.minimum(along.astype(int), JAW - 2)
        kept = known[index] & known[index + 1]
        kept &= (self._ray_of[outline] >= rays[0]) & (self._ray_of[outline] <= rays[-1])
        outline, along, index = outline[kept], along[kept], index[kept]
        targets = _through(landmarks, known, index, (along - index)[:, None])
        shares = np.minimum(weights[index], weights[index + 1]) / np.bincount(index, minlength=JAW)[index]
        return JawMatch(matched, outline, targets, _BETWEEN * shares, lately)


def _polar(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Angle (n,) from straight down towards the subject's left, and distance (n,), of points (n, 2)."""
    return np.arctan2(points[:, 0], -points[:, 1]), np.hypot(*points.T)


def _through(points: np.ndarray, known: np.ndarray, index: np.ndarray, share: np.ndarray) -> np.ndarray:
    """Places (k, 2) on the Catmull-Rom spline through points (n, 2): after those at `index`, shares (k, 1) of the way.

    Where the neighbour of an end is not known, or none, the spline goes on straight there.
    """
    start, end = points[index], points[index + 1]
    first, last = np.maximum(index - 1, 0), np.minimum(index + 2, len(points) - 1)
    before = np.where(((index > 0) & known[first])[:, None], points[first], 2 * start - end)
    after = np.where(((last > index + 1) & known[last])[:, None], points[last], 2 * end - start)
    linear, square, cube = end - before, 2 * before - 5 * start + 4 * end - after, 3 * (start - end) + after - before
    return start + 0.5 * share * (linear + share * (square + share * cube))
