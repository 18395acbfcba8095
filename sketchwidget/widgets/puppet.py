"""A head that is moved by weights of expressions: the page adds them up at the screen's rate."""

from __future__ import annotations

import gzip
import time
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import anywidget
import numpy as np
import pythreejs
import traitlets
from ipywidgets import widget_serialization

if TYPE_CHECKING:
    from ..avatar import Avatar, Performance

_STEP_MM = 0.01  # to which displacements are rounded on their way
_LARGEST, _MOST = 32767, 65536  # steps, vertices: two bytes each
_GROUPS = (("Eyes", "eye"), ("Brows", "brow"), ("Jaw", "jaw"), ("Mouth", "mouth"), ("Cheeks, nose, tongue", ""))


class Puppet(anywidget.AnyWidget):
    """Sliders for every expression, and performances, that move a head on the page without asking the kernel.

    What each expression moves is sent once, about 1 MB; what drives the head is the trait ``weights``. The message
    format is in ``puppet.js``.

    Parameters
    ----------
    geometry : pythreejs.BufferGeometry
        Of the head, shown by a `MeshStream`.
    """

    _esm = Path(__file__).parent / "puppet.js"

    geometry = traitlets.Instance(pythreejs.BufferGeometry).tag(sync=True, **widget_serialization)
    weights = traitlets.Dict(help="by ARKit's names; what is not named is at rest").tag(sync=True)
    names = traitlets.List(help="[title, [names]] of each group of sliders").tag(sync=True)
    performances = traitlets.Dict(help="{name: {times, weights: {name: [...]}}}, seconds").tag(sync=True)
    playing = traitlets.Unicode("", help="name of the performance that is played").tag(sync=True)

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._rig: tuple[dict[str, Any], list[bytes]] | None = None
        self.on_msg(self._receive)

    def hold(self, avatar: Avatar | None, tracks: Iterable[Performance] = ()) -> None:
        """Move this head from now on, at rest first, and offer performances; with None no head is moved.

        Raises
        ------
        ValueError
            If the head has more than 65,536 vertices, or an expression moves it by more than 328 mm; the head before is
            moved then.
        """
        rig = None if avatar is None else _message(avatar)
        with self.hold_sync():
            self.weights, self.playing = {}, ""
            self.names = [] if avatar is None else grouped(avatar.rig)
            self.performances = {} if avatar is None else {track.name: _as_keys(track) for track in tracks}
        self._rig = rig
        self._send_rig()

    def drive(self, frames: Iterable[Mapping[str, float]], rate: float | None = 30.0) -> None:
        """Move the head by a driver.

        Parameters
        ----------
        frames : iterable of mappings
            Weights by ARKit's names, one mapping a frame.
        rate : float, optional
            Frames a second; None shows each as soon as it comes, which is right for a camera's.

        Raises
        ------
        ValueError
            If the rate is not positive.
        """
        if rate is not None and not rate > 0:
            raise ValueError(f"a rate is a positive number of frames a second, or None; given {rate!r}")
        self.playing = ""
        for frame in frames:
            self.weights = {name: float(weight) for name, weight in frame.items()}
            if rate is not None:
                time.sleep(1 / rate)

    def _send_rig(self) -> None:
        if self._rig is None:
            self.send({"type": "release"})
        else:
            self.send(*self._rig)

    def _receive(self, _: Any, content: dict[str, Any], buffers: list[memoryview]) -> None:
        if content.get("type") == "ready" and self._rig is not None:
            self._send_rig()


def grouped(names: Iterable[str]) -> list[list[Any]]:
    """Expressions by the part of the face that they move: [title, [names]] of each group."""
    left = list(names)
    groups = []
    for title, beginning in _GROUPS:
        members = [name for name in left if name.startswith(beginning)]
        left = [name for name in left if name not in members]
        groups += [[title, members]] if members else []
    return groups


def _as_keys(track: Performance) -> dict[str, Any]:
    weights = {name: np.asarray(values).tolist() for name, values in track.weights.items()}
    return {"times": np.asarray(track.times).tolist(), "weights": weights}


def _message(avatar: Avatar) -> tuple[dict[str, Any], list[bytes]]:
    """The rig as ``puppet.js`` reads it."""
    from ..avatar.eyes import TURNS, gaze_names

    vertices = np.ascontiguousarray(avatar.face.vertices, dtype="<f4")
    if len(vertices) > _MOST:
        raise ValueError(f"a head on the page has at most {_MOST} vertices; given {len(vertices)}")
    parts, counts = [vertices.tobytes()], {}
    for name, moved in avatar.rig.items():
        steps = np.rint(np.asarray(moved) / _STEP_MM)
        if np.abs(steps).max(initial=0) > _LARGEST:
            raise ValueError(f"{name} moves the head by more than {_LARGEST * _STEP_MM:.0f} mm")
        moving = np.flatnonzero(steps.any(axis=1))
        counts[name] = len(moving)
        gaps = np.diff(moving, prepend=0)  # they compress better than numbers that grow
        parts += [gaps.astype("<u2").tobytes(), steps[moving].T.astype("<i2").tobytes()]
    eyes = []
    for eye in avatar.eyes:
        eyes.append({"side": eye.side, "gaze": gaze_names(eye.side), "count": len(eye.vertices)})
        eyes[-1] |= {"centre": np.asarray(eye.centre).tolist(), "turns": TURNS}
        parts.append(np.asarray(eye.vertices, dtype="<u2").tobytes())
    content = {"type": "rig", "vertices": len(vertices), "step": _STEP_MM, "counts": counts, "eyes": eyes}
    return content, [gzip.compress(b"".join(parts), 6)]
