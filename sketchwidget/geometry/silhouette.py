"""Silhouettes of a mesh in a view, and the one that a stroke means (Nealen et al. 2005)."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d

from .visibility import visible

_GAP = 3  # hidden vertices in a row that do not part a silhouette: what is seen edge on flickers
_SHORTEST = 4  # vertices of a silhouette
_LENGTHS = (0.5, 2.0)  # of the part of a silhouette that a stroke can mean, as shares of the stroke's
_SMOOTHING = 1.0  # vertices; a chain of edges zigzags about the contour, and the zigzag is the mesh's, not the stroke's


def silhouettes(
    vertices: np.ndarray, faces: np.ndarray, rotation: np.ndarray, among: np.ndarray | None = None
) -> list[np.ndarray]:
    """Chains of edges along which a mesh turns away from a distant viewer, as far as they are seen.

    Parameters
    ----------
    vertices : (n, 3) array
        Millimetres.
    faces : (m, 3) int array
        Triangles of a manifold mesh; its boundary is no silhouette.
    rotation : (3, 3) array
        From the mesh's frame to the viewer's: x right, y up, z to the viewer.
    among : (n,) bool array, optional
        The vertices that count; chains end where they do.

    Returns
    -------
    list of (k,) int arrays
        Vertices, those of the surface that is seen to the left. A closed chain ends where it starts.
    """
    seen = np.asarray(vertices, dtype=np.float64) @ np.asarray(rotation, dtype=np.float64).T
    chains = _chains(_contour_edges(seen, np.asarray(faces, dtype=np.int64)), seen)
    if not chains:
        return []
    used = np.unique(np.concatenate(chains))
    clear = np.zeros(len(vertices), dtype=bool)
    clear[used] = visible(np.asarray(vertices)[used], vertices, faces, rotation)
    runs = [run for chain in chains for run in _runs(chain, clear[chain])]
    return runs if among is None else [part for run in runs for part in _runs(run, among[run], gap=0)]


def _contour_edges(seen: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Edges (e, 2) between a triangle that faces the viewer and one that does not, as the former goes round."""
    a, b, c = (seen[faces[:, corner], :2] for corner in range(3))
    edge, other = b - a, c - a
    facing = edge[:, 0] * other[:, 1] - edge[:, 1] * other[:, 0] > 0
    halves = np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1)
    count = len(seen)
    front, back = halves[facing].reshape(-1, 2), halves[~facing].reshape(-1, 2)
    return front[np.isin(front @ [count, 1], back[:, ::-1] @ [count, 1])]


def _chains(edges: np.ndarray, seen: np.ndarray) -> list[np.ndarray]:
    """Edges one after the other; where several go on, the one that turns least on screen."""
    following: dict[int, list[int]] = defaultdict(list)
    for start, end in edges.tolist():
        following[start].append(end)
    ends = {end for _, end in edges.tolist()}
    # What begins at the mesh's boundary first, so that only loops are left.
    starts = [start for start in following if start not in ends] + list(following)
    chains = []
    for start in starts:
        while following[start]:
            chain = [start, following[start].pop()]
            while chain[-1] != start and (ways := following.get(chain[-1])):
                ways.sort(key=lambda way, chain=chain: _straightness(seen, chain[-2], chain[-1], way))
                chain.append(ways.pop())
            chains.append(np.array(chain))
    return chains


def _straightness(seen: np.ndarray, before: int, at: int, after: int) -> float:
    come, go = seen[at, :2] - seen[before, :2], seen[after, :2] - seen[at, :2]
    return float(come @ go / max(np.linalg.norm(come) * np.linalg.norm(go), 1e-12))


def _runs(chain: np.ndarray, clear: np.ndarray, gap: int = _GAP) -> list[np.ndarray]:
    """The parts of a chain that are clear; as many vertices in a row that are not do not part them."""
    closed = chain[0] == chain[-1]
    if closed and not clear.all():  # begin where it is hidden, so that no part goes over the end
        turn = int(np.argmin(clear))
        chain = np.append(np.roll(chain[:-1], -turn), chain[turn])
        clear = np.append(np.roll(clear[:-1], -turn), clear[turn])
    hidden = np.flatnonzero(~clear)
    for row in np.split(hidden, np.flatnonzero(np.diff(hidden) > 1) + 1):
        if 0 < len(row) <= gap and row[0] > 0 and row[-1] < len(clear) - 1:
            clear[row] = True
    places = np.flatnonzero(clear)
    runs = np.split(places, np.flatnonzero(np.diff(places) > 1) + 1)
    return [chain[run] for run in runs if len(run) >= _SHORTEST]


@dataclass(frozen=True)
class Drag:
    """A part of a silhouette, and where it is to go.

    Parameters
    ----------
    vertices : (k,) int array
    displacement : (k, 2) array
        In the plane of the stroke.
    distance : float
        From silhouette to stroke, on average.
    angle : float
        Between the directions of both, on average, radians.
    """

    vertices: np.ndarray
    displacement: np.ndarray
    distance: float
    angle: float


def nearest_silhouette(stroke: np.ndarray, chains: Sequence[np.ndarray], points: np.ndarray) -> Drag | None:
    """The part of a silhouette that is nearest to a stroke, dragged onto it.

    The part begins where the silhouette is nearest to the stroke's start and ends where it is nearest to its end; equal
    shares of the lengths of both correspond.

    Parameters
    ----------
    stroke : (n, 2) array
    chains : sequence of (k,) int arrays
        As `silhouettes` gives them.
    points : (v, 2) array
        The mesh's vertices in the plane of the stroke.

    Returns
    -------
    Drag or None
        None if no silhouette has a part that is about as long as the stroke.
    """
    drags = [drag for chain in chains if (drag := _drag(np.asarray(stroke, dtype=np.float64), chain, points))]
    return min(drags, key=lambda drag: drag.distance, default=None)


def _drag(stroke: np.ndarray, chain: np.ndarray, points: np.ndarray) -> Drag | None:
    closed = chain[0] == chain[-1]
    chain = chain[:-1] if closed else chain
    path = _smoothed(points[chain].astype(np.float64), closed)
    first, last = (int(np.argmin(np.linalg.norm(path - point, axis=1))) for point in (stroke[0], stroke[-1]))
    count = len(chain)
    ways = [np.arange(first, last + 1) if first <= last else np.arange(first, last - 1, -1)]
    if closed:  # the other way round
        ways.append(np.arange(first + count, last - 1, -1) if first <= last else np.arange(first, last + count + 1))
    drags = []
    for places in (way % count for way in ways):
        length, wanted = _length(path[places]), _length(stroke)
        if len(places) >= _SHORTEST and _LENGTHS[0] * wanted <= length <= _LENGTHS[1] * wanted:
            target = _at_shares(stroke, _shares(path[places]))
            displacement = target - path[places]
            distance = float(np.linalg.norm(displacement, axis=1).mean())
            drags.append(Drag(chain[places], displacement, distance, _angle(path[places], target)))
    return min(drags, key=lambda drag: drag.distance, default=None)


def _angle(path: np.ndarray, other: np.ndarray) -> float:
    """Mean angle between two paths (n, 2), radians, by the length of the first."""
    here, there = ((step := np.diff(each, axis=0))[:, 0] + 1j * step[:, 1] for each in (path, other))
    return float(np.average(np.abs(np.angle(here * there.conj())), weights=np.abs(here) + 1e-12))


def _smoothed(path: np.ndarray, closed: bool) -> np.ndarray:
    if closed:
        return gaussian_filter1d(path, _SMOOTHING, axis=0, mode="wrap")
    # Turned about its ends, so that these stay where they are.
    before, after = 2 * path[0] - path[:0:-1], 2 * path[-1] - path[-2::-1]
    longer = gaussian_filter1d(np.concatenate([before, path, after]), _SMOOTHING, axis=0)
    return longer[len(before) : len(before) + len(path)]


def _length(path: np.ndarray) -> float:
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())


def _shares(path: np.ndarray) -> np.ndarray:
    """Of the length of a path, how much comes before each of its points."""
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    return along / max(along[-1], 1e-12)


def _at_shares(path: np.ndarray, shares: np.ndarray) -> np.ndarray:
    along = _shares(path)
    return np.stack([np.interp(shares, along, path[:, axis]) for axis in range(2)], axis=1)
