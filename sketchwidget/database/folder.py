"""Faces from a folder of registered OBJ files, one for each identity and expression, as FaceWarehouse is laid out."""

from __future__ import annotations

import json
import os
import re
from pathlib import Path
from typing import Any

import numpy as np

from ..face.template import PARTS
from ..face.wrinkles import LIPS
from ..geometry.alignment import similarity
from ..sketch import FEATURES, SILHOUETTE
from .obj import read_obj, read_registered, unrefined_template
from .posing import to_millimetres

_TOPOLOGY = "topology.json"
_CURVES = {SILHOUETTE, *FEATURES, *LIPS}


class MeshFolderSource:
    """Heads from OBJ files in a folder with one folder for each identity.

    FaceWarehouse's layout, ``Tester_1/TrainingPose/pose_0.obj``, is one, and ``anna/smile.obj`` another. Identities and
    files are in the order of their numbers. Heads stand upright in them: x to their left, y up, z to the front. Beside
    the identities lies ``topology.json``, with these entries:

    ``expressions``
        Names of the expressions, in the order of an identity's files. Files that bear these names may be in any order.
    ``neutral``
        Which of them is the face at rest; it is called "neutral" from then on.
    ``files``
        Optional: pattern of the files in an identity's folder, ``**/*.obj`` by default. FaceWarehouse has two sets of
        expressions: ``TrainingPose/pose_*.obj`` and ``Blendshape/shape_*.obj``.
    ``landmarks``
        68 vertices in iBUG order, counted from 0 as all vertices here.
    ``curves``
        The vertices of each of the 14 curves by name, as in `Template`.
    ``parts``
        Optional: vertices by part ("mouth", "eyes", "teeth", "tongue"); all others are skin.

    Parameters
    ----------
    path : str or path
        The folder.

    Raises
    ------
    FileNotFoundError
        If the folder, ``topology.json`` or a file of an identity is missing.
    ValueError
        If ``topology.json`` or the first neutral face is not to be read, or they do not fit.
    """

    name = "folder"

    def __init__(self, path: str | os.PathLike[str]) -> None:
        folder = Path(path)
        self._described = folder / _TOPOLOGY
        if not self._described.is_file():
            raise FileNotFoundError(
                f"{folder} has no {_TOPOLOGY}: the source 'folder' wants one beside the identities' folders, with the"
                " entries that sketchwidget.database.folder.MeshFolderSource explains"
            )
        topology = self._read_topology()
        self._identities, self._files = self._find_files(folder, topology)
        self.count: int | None = len(self._identities)
        rest = topology["expressions"].index(topology["neutral"])
        self._names = tuple("neutral" if k == rest else name for k, name in enumerate(topology["expressions"]))
        self._first = read_obj(self._identities[0] / self._files[rest])
        try:
            parts = _parts(topology.get("parts", {}), len(self._first.vertices))
            self.template, self._kept = unrefined_template(
                self._first.quads, parts, topology["curves"], topology.get("landmarks")
            )
        except ValueError as error:
            raise ValueError(f"{self._described} does not fit {self._first.path}: {error}") from error
        self._skin = np.flatnonzero(self.template.parts == PARTS.index("skin"))
        face = self._first.vertices[self._kept]
        right, left, menton, bridge, tip = face[self.template.landmarks[[0, 16, 8, 27, 30]]]
        if not (left[0] > right[0] and bridge[1] > menton[1] and tip[2] > max(right[2], left[2])):
            raise ValueError(
                f"{self._first.path}: by the landmarks of {self._described} this head does not stand upright and look"
                " along z, its left where x is larger"
            )
        scale, origin = to_millimetres(face, self.template)
        self._rest = scale * (face - origin)

    @property
    def expressions(self) -> tuple[str, ...]:
        """Names of the expressions in the order of the files, "neutral" among them."""
        return self._names

    def heads(self, number: int) -> np.ndarray:
        """Identity `number` in every expression: vertices (expressions, n, 3) float32, millimetres.

        Its face at rest is brought onto that of the first identity by a similarity, and its other faces with it.

        Raises
        ------
        IndexError
            If there are not as many identities.
        FileNotFoundError, ValueError
            If one of its files is missing, damaged, or of another topology.
        """
        faces = np.stack([self._read(number, file) for file in self._files])
        return self._aligned(faces, faces[self._names.index("neutral")]).astype(np.float32)

    def rest(self, number: int) -> np.ndarray:
        """Identity `number` at rest, (n, 3), millimetres, aligned; raises as `heads` does."""
        rest = self._read(number, self._files[self._names.index("neutral")])
        return self._aligned(rest, rest)

    def _aligned(self, faces: np.ndarray, rest: np.ndarray) -> np.ndarray:
        """Faces (..., n, 3) of an identity, with its face at rest (n, 3) on that of the first one."""
        scale, rotation, translation = similarity(rest[self._skin], self._rest[self._skin])
        return scale * faces @ rotation.T + translation

    def _read(self, number: int, file: Path) -> np.ndarray:
        """One face (n, 3) of an identity, in its file's unit and place."""
        if not 0 <= number < len(self._identities):
            raise IndexError(f"identities are numbered 0 to {len(self._identities) - 1}; given {number}")
        return read_registered(self._identities[number] / file, self._first)[self._kept]

    def _read_topology(self) -> dict[str, Any]:
        try:
            topology = json.loads(self._described.read_text())
        except ValueError as error:
            raise ValueError(f"{self._described} is no JSON: {error}") from error
        names = topology.get("expressions") if isinstance(topology, dict) else None
        if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
            raise ValueError(f"{self._described}: 'expressions' is the list of their names, in the order of the files")
        if topology.get("neutral") not in names:
            raise ValueError(f"{self._described}: 'neutral' is one of {', '.join(names)}")
        if len({"neutral" if name == topology["neutral"] else name for name in names}) < len(names):
            raise ValueError(f"{self._described}: no two expressions have one name, and the face at rest is 'neutral'")
        curves = topology.get("curves")
        if not isinstance(curves, dict) or set(curves) != _CURVES:
            raise ValueError(f"{self._described}: 'curves' are {', '.join(sorted(_CURVES))}")
        pattern = topology.get("files", "**/*.obj")
        if not isinstance(pattern, str) or not pattern or Path(pattern).is_absolute():
            raise ValueError(f"{self._described}: 'files' is a pattern such as TrainingPose/pose_*.obj")
        return topology

    def _find_files(self, folder: Path, topology: dict[str, Any]) -> tuple[list[Path], list[Path]]:
        """Folders of the identities, and in each of them the files of the expressions."""
        identities = sorted(
            (entry for entry in folder.iterdir() if entry.is_dir() and any(entry.glob("**/*.obj"))), key=_natural
        )
        if not identities:
            raise FileNotFoundError(f"{folder} has no folder with OBJ files: the source 'folder' wants one an identity")
        names, pattern = topology["expressions"], topology.get("files", "**/*.obj")
        found = sorted((file.relative_to(identities[0]) for file in identities[0].glob(pattern)), key=_natural)
        named = {file.stem: file for file in found}
        files = [named[name] for name in names] if set(names) <= set(named) else found
        if len(files) != len(names) or (files is not found and len(named) != len(found)):
            raise ValueError(
                f"{identities[0]} has {len(found)} files {pattern}, and {self._described} names {len(names)}"
                " expressions: make 'files' the pattern of those that count, and 'expressions' their names"
            )
        missing = [str(entry / file) for entry in identities for file in files if not (entry / file).is_file()]
        if missing:
            more = f" and {len(missing) - 5} more" if len(missing) > 5 else ""
            raise FileNotFoundError(f"{folder} lacks {', '.join(missing[:5])}{more}: each identity has the same files")
        return identities, files


def _natural(path: Path) -> list[str | int]:
    """Sorts pose_10 behind pose_9."""
    return [int(piece) if piece.isdecimal() else piece for piece in re.split(r"(\d+)", str(path))]


def _parts(given: Any, count: int) -> np.ndarray:
    """For each vertex the index in `PARTS` of what it belongs to, (n,) uint8."""
    if not isinstance(given, dict) or not set(given) <= set(PARTS):
        raise ValueError(f"'parts' has lists of vertices by the names {', '.join(PARTS)}")
    parts = np.full(count, PARTS.index("skin"), dtype=np.uint8)
    for name, vertices in given.items():
        if not isinstance(vertices, list) or not all(
            type(vertex) is int and 0 <= vertex < count for vertex in vertices
        ):
            raise ValueError(f"'parts': {name} is a list of vertices, whole numbers from 0 to {count - 1:,}")
        parts[vertices] = PARTS.index(name)
    return parts
