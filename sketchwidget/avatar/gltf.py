"""Binary glTF files of textured meshes with morph targets and animations of their weights."""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

_FLOAT, _UINT = 5126, 5125
_VERTICES, _INDICES = 34962, 34963  # what a buffer view is for
_GRID = 2**15  # to the metre: targets are rounded to 0.03 mm, so that files compress to a third


@dataclass(frozen=True, eq=False)
class MorphMesh:
    """One mesh of a file.

    Parameters
    ----------
    name : str
    positions, normals : (n, 3) arrays
        Metres, y up.
    uv : (n, 2) array
        v downwards, as glTF has it.
    faces : (m, 3) int array
    targets : dict of (n, 3) arrays
        Displacements by name.
    """

    name: str
    positions: np.ndarray
    normals: np.ndarray
    uv: np.ndarray
    faces: np.ndarray
    targets: Mapping[str, np.ndarray]


@dataclass(frozen=True, eq=False)
class WeightTrack:
    """An animation: weights (k,) by the name of a target at times (k,) in seconds, linear in between."""

    name: str
    times: np.ndarray
    weights: Mapping[str, np.ndarray] = field(default_factory=dict)


def write_glb(meshes: Sequence[MorphMesh], picture: bytes, mime: str, tracks: Sequence[WeightTrack]) -> bytes:
    """A glTF 2.0 binary file.

    Each mesh is a node; targets are sparse, and named in ``extras.targetNames`` as viewers expect.

    Parameters
    ----------
    meshes : sequence of MorphMesh
        They share the picture.
    picture : bytes
        An encoded image.
    mime : str
        "image/jpeg" or "image/png".
    tracks : sequence of WeightTrack
    """
    file = _Writer()
    nodes, definitions = [], []
    for mesh in meshes:
        attributes = {
            "POSITION": file.vectors(mesh.positions, _VERTICES, bounds=True),
            "NORMAL": file.vectors(mesh.normals, _VERTICES),
            "TEXCOORD_0": file.vectors(mesh.uv, _VERTICES),
        }
        definition: dict[str, Any] = {
            "name": mesh.name,
            "primitives": [
                {
                    "attributes": attributes,
                    "indices": file.scalars(mesh.faces.ravel(), _UINT, _INDICES),
                    "material": 0,
                    "targets": [{"POSITION": file.sparse(moved)} for moved in mesh.targets.values()],
                }
            ],
            "weights": [0.0] * len(mesh.targets),
            "extras": {"targetNames": list(mesh.targets)},
        }
        nodes.append({"name": mesh.name, "mesh": len(definitions)})
        definitions.append(definition)
    document: dict[str, Any] = {
        "asset": {"version": "2.0", "generator": "sketchwidget"},
        "scene": 0,
        "scenes": [{"nodes": list(range(len(nodes)))}],
        "nodes": nodes,
        "meshes": definitions,
        "materials": [
            {
                "name": "head",
                "doubleSided": True,
                "pbrMetallicRoughness": {
                    "baseColorTexture": {"index": 0},
                    "metallicFactor": 0.0,
                    "roughnessFactor": 0.9,
                },
            }
        ],
        "textures": [{"source": 0, "sampler": 0}],
        "samplers": [{"magFilter": 9729, "minFilter": 9987, "wrapS": 33071, "wrapT": 33071}],
        "images": [{"bufferView": file.view(picture), "mimeType": mime}],
    }
    if tracks:
        document["animations"] = [_animation(file, track, meshes) for track in tracks]
    return file.finished(document)


def _animation(file: _Writer, track: WeightTrack, meshes: Sequence[MorphMesh]) -> dict[str, Any]:
    times = file.scalars(np.asarray(track.times, dtype=np.float32), _FLOAT, None, bounds=True)
    still = np.zeros(len(track.times))
    samplers, channels = [], []
    for number, mesh in enumerate(meshes):
        if not track.weights.keys() & mesh.targets.keys():
            continue
        values = np.stack([track.weights.get(name, still) for name in mesh.targets], axis=1)
        output = file.scalars(values.ravel().astype(np.float32), _FLOAT, None)
        channels.append({"sampler": len(samplers), "target": {"node": number, "path": "weights"}})
        samplers.append({"input": times, "output": output, "interpolation": "LINEAR"})
    return {"name": track.name, "samplers": samplers, "channels": channels}


class _Writer:
    """Collects the parts of a file."""

    def __init__(self) -> None:
        self._data = bytearray()
        self._views: list[dict[str, Any]] = []
        self._accessors: list[dict[str, Any]] = []

    def view(self, data: bytes, target: int | None = None) -> int:
        self._data += b"\0" * (-len(self._data) % 4)
        view: dict[str, Any] = {"buffer": 0, "byteOffset": len(self._data), "byteLength": len(data)}
        if target is not None:
            view["target"] = target
        self._data += data
        self._views.append(view)
        return len(self._views) - 1

    def vectors(self, values: np.ndarray, target: int, bounds: bool = False) -> int:
        values = np.ascontiguousarray(values, dtype=np.float32)
        accessor = {
            "bufferView": self.view(values.tobytes(), target),
            "componentType": _FLOAT,
            "count": len(values),
            "type": f"VEC{values.shape[1]}",
        }
        return self._accessor(accessor, values if bounds else None)

    def scalars(self, values: np.ndarray, kind: int, target: int | None, bounds: bool = False) -> int:
        values = np.ascontiguousarray(values, dtype=np.uint32 if kind == _UINT else np.float32)
        view = self.view(values.tobytes(), target)
        accessor = {"bufferView": view, "componentType": kind, "count": len(values), "type": "SCALAR"}
        return self._accessor(accessor, values[:, None] if bounds else None)

    def sparse(self, moved: np.ndarray) -> int:
        """Displacements (n, 3), most of them zero; an accessor must name some, so one that does nothing names one."""
        moved = (np.rint(np.asarray(moved, dtype=np.float64) * _GRID) / _GRID).astype(np.float32)
        moving = np.flatnonzero(moved.any(axis=1))
        if not len(moving):
            moving = np.array([0])
        values = moved[moving]
        accessor: dict[str, Any] = {"componentType": _FLOAT, "count": len(moved), "type": "VEC3"}
        accessor["sparse"] = {
            "count": len(moving),
            "indices": {"bufferView": self.view(moving.astype(np.uint32).tobytes()), "componentType": _UINT},
            "values": {"bufferView": self.view(np.ascontiguousarray(values).tobytes())},
        }
        return self._accessor(accessor, np.concatenate([values, np.zeros((int(len(moving) < len(moved)), 3))]))

    def _accessor(self, accessor: dict[str, Any], values: np.ndarray | None) -> int:
        if values is not None:
            accessor["min"] = values.min(axis=0).astype(float).tolist()
            accessor["max"] = values.max(axis=0).astype(float).tolist()
        self._accessors.append(accessor)
        return len(self._accessors) - 1

    def finished(self, document: dict[str, Any]) -> bytes:
        data = bytes(self._data) + b"\0" * (-len(self._data) % 4)
        document |= {
            "buffers": [{"byteLength": len(data)}],
            "bufferViews": self._views,
            "accessors": self._accessors,
        }
        text = json.dumps(document, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(data), 0x004E4942) + data
        return struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks
