"""A head of 75 vertices: a tube of eight rings with a lid, two eyes of triangles, and a lash."""

import numpy as np

RINGS, AROUND = 8, 8


def _ring(number):
    return [number * AROUND + k for k in range(AROUND)]


def _vertices():
    angle = np.arange(AROUND) * 2 * np.pi / AROUND  # from the subject's left by the front to the right
    radius = [1.0, 0.9, 1.0, 1.1, 1.15, 1.1, 0.9, 0.6]
    tube = [
        np.stack([r * np.cos(angle), np.full(AROUND, y - 3.0), r * np.sin(angle)], axis=1) for y, r in enumerate(radius)
    ]
    eye = np.array([[0.0, 0.1, 1.2], [-0.1, -0.1, 1.1], [0.1, -0.1, 1.1], [0.2, 0.1, 1.1]])
    aside = np.array([0.4, 0, 0])
    lash = np.array([[0.0, 0.5, 1.3], [0.1, 0.5, 1.3], [0.0, 0.6, 1.3]])
    return np.concatenate([*tube, eye + aside, eye - aside, lash])


VERTICES = _vertices()
_TUBE = [
    [_ring(r)[k], _ring(r)[k - 1], _ring(r + 1)[k - 1], _ring(r + 1)[k]]
    for r in range(RINGS - 1)
    for k in range(AROUND)
]
_LID = [[_ring(7)[k] for k in corners] for corners in ((3, 2, 1, 0), (7, 4, 3, 0), (7, 6, 5, 4))]
FACES = [*_TUBE, *_LID, [64, 65, 66], [64, 66, 67], [68, 69, 70], [68, 70, 71], [72, 73, 74]]

LANDMARKS = [(_ring(2) + _ring(3))[k % 16] for k in range(68)]
LANDMARKS[0], LANDMARKS[16] = _ring(2)[4], _ring(2)[0]
LANDMARKS[8] = _ring(1)[2]  # menton
LANDMARKS[30] = _ring(3)[2]  # tip of the nose
_NAMES = ("brow", "eye_upper", "eye_lower", "ear")
CURVES = {f"{side}_{name}": _ring(3)[:7] for side in ("left", "right") for name in _NAMES}
CURVES |= {name: _ring(2)[:7] for name in ("mouth_upper", "mouth_lower", "nose", "lip_upper", "lip_lower")}
CURVES["silhouette"] = [
    *(_ring(r)[0] for r in range(7, 0, -1)),
    _ring(1)[2],
    *(_ring(r)[4] for r in range(1, 8)),
    _ring(7)[0],
]


def write_obj(path, vertices=VERTICES, faces=FACES):
    path.parent.mkdir(parents=True, exist_ok=True)
    lines = [
        "# a head",
        "mtllib none.mtl",
        *(f"v {x!r} {y!r} {z!r}" for x, y, z in np.asarray(vertices).tolist()),
        "vt 0 0",
    ]
    lines += ["f " + " ".join(f"{corner + 1}/1" for corner in face) for face in faces]
    path.write_text("\n".join(lines) + "\n")
