"""The template of avatars: expressions from free targets, a texture chart, and an albedo model drawn on the head."""

from __future__ import annotations

import igl
import numpy as np
from scipy import sparse
from scipy.sparse.linalg import spsolve
from scipy.spatial import KDTree

from ..avatar.template import AvatarTemplate
from ..database.anny import AnnySource
from ..database.posing import to_millimetres
from ..face.template import PARTS, Template

_SKIN, _MOUTH, _EYES, _TEETH, _TONGUE = range(len(PARTS))

# The chart: rounds of bringing areas towards the wanted ones, and the strip of it below which the loose parts lie.
_ROUNDS, _STRIP, _BORDER = 12, 0.14, 0.01
_FACE_SHARE, _EARS_SHARE, _MOUTH_SHARE = 5.0, 0.4, 0.05  # texels for an area, of what the back of the head has
_CORNERS = 1.25  # how far the chart's border reaches into the corners of its square, of its half side

# Colours and their standard deviations, by region; all are our own choice.
_REGIONS = {
    "skin": ((0.78, 0.60, 0.50), ((0.16, 0.15, 0.14), (0.05, 0.0, -0.04), (0.0, 0.04, -0.02))),
    "lips": ((-0.06, -0.15, -0.10), ((0.10, 0.02, 0.03), (0.04, 0.06, 0.05), (0.06, 0.06, 0.06))),
    "brows": ((-0.30, -0.26, -0.22), ((0.14, 0.13, 0.12), (0.08, 0.04, 0.0))),
    "scalp": ((-0.45, -0.36, -0.32), ((0.24, 0.22, 0.20), (0.12, 0.02, -0.06))),
    "beard": ((-0.03, -0.03, -0.02), ((0.10, 0.09, 0.08),)),
    "cheeks": ((0.02, -0.03, -0.02), ((0.05, -0.02, -0.01),)),
    "lids": ((-0.05, -0.06, -0.05), ((0.08, 0.08, 0.08),)),
}
_FLAT = {_MOUTH: (0.30, 0.11, 0.11), _EYES: (0.94, 0.93, 0.91), _TEETH: (0.93, 0.91, 0.85), _TONGUE: (0.58, 0.26, 0.26)}
_HAIRLINE, _NAPE = np.array([62.0, 80.0]), np.array([-45.0, -80.0])  # y and z of the scalp's border, millimetres


def build_template(source: AnnySource) -> AvatarTemplate:
    """The template of avatars on heads of a source."""
    template = source.template
    rest, actions = source.actions()
    scale, origin = to_millimetres(template.subdivision @ rest, template)
    neutral = scale * (rest - origin)
    masks = _masks(template, neutral)
    albedo, basis = _albedo(template, masks)
    return AvatarTemplate(
        quads=template.quads,
        neutral=neutral,
        actions={name: scale * moved for name, moved in actions.items()},
        chart=_chart(template, neutral),
        albedo=albedo,
        albedo_basis=basis,
        scalp=masks["scalp"],
    )


def _chart(template: Template, neutral: np.ndarray) -> np.ndarray:
    """Texture coordinates (n, 2): skin and mouth as one piece without a cut, the loose parts in a strip below."""
    soft, faces = template.soft
    chart = np.zeros((template.coarse_count, 2))
    flat = _unwrapped(neutral[soft], faces, _shares(template.parts[soft], neutral[soft], faces))
    chart[soft] = (flat + 1) / 2 * (1 - 2 * _BORDER) + _BORDER
    chart[:, 1] = _STRIP + (1 - _STRIP) * chart[:, 1]
    for column, part in enumerate((_EYES, _EYES, _TEETH, _TONGUE)):
        members = template.parts == part
        if part == _EYES:  # the subject's left eye first
            members = members & ((neutral[:, 0] > 0) == (column == 0))
        if members.any():
            chart[members] = _boxed(neutral[members], part == _EYES) * 0.8 * _STRIP + (
                (column + 0.1) * _STRIP,
                0.1 * _STRIP,
            )
    return chart


def _boxed(points: np.ndarray, ball: bool) -> np.ndarray:
    """Loose parts (n, 3) in the unit square: seen from the front; a ball by the angle from its axis, whole."""
    low, high = points.min(axis=0), points.max(axis=0)
    if not ball:
        return ((points - low) / (high - low))[:, :2]
    direction = points - (low + high) / 2
    around = np.hypot(direction[:, 0], direction[:, 1])
    angle = np.sqrt(np.arctan2(around, direction[:, 2]) / np.pi)  # most of the room for the front
    return 0.5 + 0.5 * angle[:, None] * direction[:, :2] / np.maximum(around, 1e-9)[:, None]


def _shares(parts: np.ndarray, points: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """How many texels an area is worth at each vertex (n,)."""
    towards = np.asarray(igl.per_vertex_normals(points, faces))[:, 2]
    share = 1 + (_FACE_SHARE - 1) * np.clip(towards, 0, 1) * np.clip((points[:, 2] - 10) / 40, 0, 1)
    share[np.abs(points[:, 0]) > 68] = _EARS_SHARE
    share[parts == _MOUTH] = _MOUTH_SHARE
    return share


def _unwrapped(points: np.ndarray, faces: np.ndarray, shares: np.ndarray) -> np.ndarray:
    """A mesh with holes in the square from -1 to 1, its lowest hole as the border: (n, 2).

    Tutte's barycentric map, whose positive weights turn no triangle over, with weights that are refined until areas
    have the wanted shares (Yoshizawa, Belyaev and Seidel, "A fast and simple stretch-minimizing mesh
    parameterization", 2004).
    """
    border = _border(points, faces)
    inner = np.setdiff1d(np.arange(len(points)), border)
    step = np.linalg.norm(np.diff(points[[*border, border[0]]], axis=0), axis=1)
    turn = 2 * np.pi * np.cumsum(step) / step.sum()
    turn -= turn[0]
    circle = np.stack([np.sin(turn), -np.cos(turn)], axis=1)
    square = circle / np.abs(circle).max(axis=1, keepdims=True)
    square /= np.maximum(1, np.linalg.norm(square, axis=1, keepdims=True) / _CORNERS)

    start, end = sparse.coo_matrix(igl.adjacency_matrix(faces)).coords
    weight = 1 / np.linalg.norm(points[start] - points[end], axis=1)
    wanted = np.asarray(igl.doublearea(points, faces)) * shares[faces].mean(axis=1)
    around = sparse.csr_matrix((np.ones(faces.size), (faces.ravel(), np.repeat(np.arange(len(faces)), 3))))
    flat = np.zeros((len(points), 2))
    flat[border] = square
    for _ in range(_ROUNDS):
        pull = sparse.csr_matrix((weight, (start, end)), shape=(len(points),) * 2)
        laplacian = (sparse.diags(np.ravel(pull.sum(axis=1))) - pull).tocsc()
        flat[inner] = np.asarray(spsolve(laplacian[inner][:, inner], pull[inner][:, border] @ square))
        area = np.abs(np.asarray(igl.doublearea(flat, faces)))
        stretch = np.sqrt((around @ wanted) / np.maximum(around @ area, 1e-12))
        weight = weight / np.sqrt(stretch / stretch.mean())[end]
    return flat


def _border(points: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """The lowest loop of the border, from its foremost vertex towards the subject's left."""
    loops = [np.asarray(loop) for loop in igl.boundary_loop_all(faces)]
    loop = min(loops, key=lambda loop: points[loop, 1].mean())
    loop = np.roll(loop, -int(points[loop, 2].argmax()))
    return loop if points[loop[1], 0] > 0 else np.concatenate([loop[:1], loop[1:][::-1]])


def _albedo(template: Template, masks: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Mean (n, 3) and standard deviations (k, n, 3) of colour, each region's laid over the skin's."""
    mean = sum(masks[name][:, None] * np.array(colour) for name, (colour, _) in _REGIONS.items())
    basis = [masks[name][:, None] * np.array(spread) for name, (_, spreads) in _REGIONS.items() for spread in spreads]
    mean, basis = np.asarray(mean), np.array(basis)
    for part, colour in _FLAT.items():
        mean[template.parts == part] = colour
        basis[:, template.parts == part] = 0.0
    return np.clip(mean, 0, 1), basis


def _masks(template: Template, neutral: np.ndarray) -> dict[str, np.ndarray]:
    """How much each coarse vertex belongs to the regions of `_REGIONS`, 0 to 1."""
    fine = template.subdivision @ neutral
    line = {name: fine[path] for name, path in template.curves.items()}

    def near(names: tuple[str, ...], full: float, none: float) -> np.ndarray:
        distance = KDTree(np.concatenate([line[name] for name in names])).query(neutral)[0]
        return np.clip((none - distance) / (none - full), 0.0, 1.0)

    lips = np.concatenate([line[name] for name in ("lip_upper", "lip_lower", "mouth_upper", "mouth_lower")])
    inside = (lips.min(axis=0) - 1 < neutral) & (neutral < lips.max(axis=0) + 1)
    towards = _NAPE - _HAIRLINE
    above = (neutral[:, 1:] - _HAIRLINE) @ np.array([-towards[1], towards[0]]) / np.linalg.norm(towards)
    x, y, z = neutral.T
    mouth = (line["mouth_upper"].mean(axis=0) + line["mouth_lower"].mean(axis=0)) / 2
    masks = {
        "skin": np.ones(len(neutral)),
        "lips": near(("mouth_upper", "mouth_lower"), 4.0, 7.0) * inside.all(axis=1),
        "brows": near(("left_brow", "right_brow"), 1.5, 5.5),
        "scalp": 1 / (1 + np.exp(-np.clip(above / 4, -30, 30))),
        "beard": np.clip((mouth[1] + 16 - y) / 8, 0, 1) * np.clip((y + 112) / 8, 0, 1) * np.clip((z - 5) / 30, 0, 1),
        "cheeks": np.exp(-(((np.abs(x) - 38) / 18) ** 2) - ((y - mouth[1] - 28) / 16) ** 2) * (z > 20),
        "lids": near(("left_eye_upper", "left_eye_lower", "right_eye_upper", "right_eye_lower"), 1.0, 7.0),
    }
    masks["beard"] *= 1 - masks["lips"]
    return masks
