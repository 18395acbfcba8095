"""Registered meshes from OBJ files, their vertices in order and their quads whole, as no library here reads them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..face.template import Template

_TEXTURE = re.compile(r"/\S*")  # what follows the vertex in a face's corner: 7/1/3


@dataclass(frozen=True)
class ObjMesh:
    """The mesh of an OBJ file.

    Parameters
    ----------
    path : Path
    vertices : (n, 3) float64 array
        In the order of the file.
    quads : (m, 4) int32 array
        Faces in the order of the file; a triangle repeats its third corner, as in `Template`.
    """

    path: Path
    vertices: np.ndarray
    quads: np.ndarray


def read_obj(path: Path) -> ObjMesh:
    """Read an OBJ file.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If it is no OBJ: it has no vertices or no faces, numbers that are none or not finite, faces of more than four
        corners or with corners that are no vertices.
    """
    if not path.is_file():
        raise FileNotFoundError(f"there is no file {path}")
    lines = path.read_text(errors="replace").splitlines()
    rows = [line for line in lines if line.startswith(("v ", "v\t"))]
    faces = [_TEXTURE.sub("", line).split()[1:] for line in lines if line.startswith(("f ", "f\t"))]
    if not rows or not faces:
        raise ValueError(f"{path} is no OBJ file of a mesh: it has {len(rows)} vertices and {len(faces)} faces")
    try:
        vertices = np.loadtxt(rows, usecols=(1, 2, 3), ndmin=2)
        quads = np.array([face + face[-1:] if len(face) == 3 else face for face in faces], dtype=np.int32) - 1
    except (OverflowError, ValueError) as error:
        raise ValueError(
            f"{path} is no OBJ file that can be read: a vertex is three numbers and a face three or four whole ones"
            f" ({error})"
        ) from error
    if quads.shape[1:] != (4,) or quads.min() < 0 or quads.max() >= len(vertices):
        raise ValueError(
            f"{path} is no OBJ file that can be read: a face has three or four corners, each among its"
            f" {len(vertices):,} vertices, counted from 1"
        )
    if not np.isfinite(vertices).all():
        broken = int(np.flatnonzero(~np.isfinite(vertices).all(axis=1))[0])
        raise ValueError(f"{path} is damaged: vertex {broken + 1} is at {vertices[broken]}")
    return ObjMesh(path, vertices, quads)


def read_registered(path: Path, first: ObjMesh) -> np.ndarray:
    """Vertices (n, 3) float64 of an OBJ file with the topology of another.

    Raises
    ------
    FileNotFoundError, ValueError
        As in `read_obj`, and ValueError if vertices or faces are others than in `first`.
    """
    mesh = read_obj(path)
    if len(mesh.vertices) != len(first.vertices):
        raise ValueError(
            f"{path} has {len(mesh.vertices):,} vertices and {first.path} has {len(first.vertices):,}:"
            " registered meshes have as many"
        )
    if not np.array_equal(mesh.quads, first.quads):
        raise ValueError(f"{path} has other faces than {first.path}: registered meshes have the same, in one order")
    return mesh.vertices


def unrefined_template(
    quads: np.ndarray, parts: np.ndarray, curves: Mapping[str, Any], landmarks: Any
) -> tuple[Template, np.ndarray]:
    """The template of some faces of a mesh, which are fine enough as they are.

    Parameters
    ----------
    quads : (m, 4) int array
        The faces, as in `ObjMesh`.
    parts : (n,) uint8 array
        For each vertex of the mesh the index in `PARTS` of what it belongs to.
    curves : dict of sequences of int
        Vertices of the mesh by line name.
    landmarks : sequence of 68 int
        Vertices of the mesh in iBUG order.

    Returns
    -------
    template : Template
    kept : (k,) int array
        The vertices of the mesh that are in it, those of the faces, in order.

    Raises
    ------
    ValueError
        If a curve or the landmarks are no list of vertices of the faces, or there are not 68 landmarks.
    """
    kept = np.unique(quads)
    used = np.zeros(len(parts), dtype=bool)
    used[kept] = True

    def placed(what: str, given: Any) -> np.ndarray:
        path = np.array(given) if _is_path(given) else None
        if path is None or path.min() < 0 or path.max() >= len(used) or not used[path].all():
            raise ValueError(f"{what} is a list of vertices of the head, whole numbers from 0 to {len(used) - 1:,}")
        return np.searchsorted(kept, path).astype(np.int32)

    template = Template(
        quads=np.searchsorted(kept, quads).astype(np.int32),
        parts=parts[kept],
        curves={name: placed(f"the curve {name!r}", path) for name, path in curves.items()},
        landmarks=placed("'landmarks'", landmarks),
        refined=False,
    )
    return template, kept


def _is_path(given: Any) -> bool:
    return isinstance(given, list) and len(given) > 1 and all(type(vertex) is int for vertex in given)
