"""Vertex positions streamed whole into a pythreejs geometry that is on screen."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import anywidget
import numpy as np
import pythreejs
import traitlets
from ipywidgets import CallbackDispatcher, widget_serialization

from ..face.texture import Texture


class MeshStream(anywidget.AnyWidget):
    """Shows a pythreejs `Renderer` and updates a mesh in it by one message a frame.

    Setting a geometry's ``position`` and ``normal`` traits one after the other shows frames in between; here the
    browser writes the positions in place, computes the normals, and renders once. The message format is in
    ``mesh_stream.js``.

    Parameters
    ----------
    renderer : pythreejs.Renderer
        With an `OrthographicCamera` and `OrbitControls`. It is shown square, as large as its place on the page.
    geometry : pythreejs.BufferGeometry
        The geometry of the mesh; its ``position`` is what is updated.
    material : pythreejs.Material
        Of the mesh, with the colours of its vertices.
    swatch : pythreejs.DataTexture
        Any; textures are made as it is.
    """

    _esm = Path(__file__).parent / "mesh_stream.js"

    renderer = traitlets.Instance(pythreejs.Renderer).tag(sync=True, **widget_serialization)
    geometry = traitlets.Instance(pythreejs.BufferGeometry).tag(sync=True, **widget_serialization)
    material = traitlets.Instance(pythreejs.Material).tag(sync=True, **widget_serialization)
    swatch = traitlets.Instance(pythreejs.DataTexture).tag(sync=True, **widget_serialization)

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._serial = 0
        self._ready_callbacks = CallbackDispatcher()
        self.on_msg(self._receive)

    def on_ready(self, callback: Callable[[], None]) -> None:
        """Call ``callback()`` when a page is ready for positions; it has none, or old ones, until they are sent."""
        self._ready_callbacks.register_callback(callback)

    def send_positions(self, positions: np.ndarray, scale: float, centre: np.ndarray, passing: bool = False) -> None:
        """Show new positions.

        Parameters
        ----------
        positions : (V, 3) array
            Millimetres, in the order of the geometry's vertices.
        scale, centre : float, (2,) array
            Canvas units per millimetre, and where the origin falls on the canvas, as in `View`.
        passing : bool
            Whether they are of no use once the pen is up.
        """
        self._serial += 1
        frame = {"scale": float(scale), "centre": [float(value) for value in centre]}
        self.send(
            {"type": "mesh", "serial": self._serial, "passing": passing, **frame},
            [np.ascontiguousarray(positions, dtype="<f4").data],
        )

    def send_skin(self, skin: Texture | None) -> None:
        """Show a texture on the mesh in place of the colours of its vertices, or these again."""
        buffers = [] if skin is None else [np.ascontiguousarray(skin.uv, dtype="<f4").data, skin.picture]
        self.send({"type": "skin"}, buffers)

    def look(self, direction: np.ndarray) -> None:
        """Turn the camera, so that it looks from ``direction`` (3,), upright, at its first size and place."""
        self.send({"type": "look", "direction": [float(value) for value in direction]})

    def _receive(self, _: Any, content: dict[str, Any], buffers: list[memoryview]) -> None:
        if content.get("type") == "ready":
            self._ready_callbacks()
