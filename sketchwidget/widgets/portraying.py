"""The Portrait tab of the Studio: a picture as an animatable head, stage by stage."""

from __future__ import annotations

import base64
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import cv2
import numpy as np
from ipywidgets import HTML, HBox, VBox

from ..face import Face, FaceModel
from . import toolbar
from .marking import Marked
from .puppet import Puppet
from .status import sentence
from .tab import Tab
from .worker import Report, Worker

if TYPE_CHECKING:
    from ..avatar import Avatar

BUILDING = "Building the head takes a few seconds: {} …"
BUILT = "The head is built in {:.1f} s: play it, move its sliders, or export it as GLB."
STAGES = {
    "landmarks": "landmarks",
    "stylize": "cartoon",
    "mask": "mask",
    "coarse": "coarse",
    "fine": "fine",
    "rig": "rig",
    "texture": "texture",
}

_SIDE = 96  # pixels of a stage's picture
_ACCENT = (13, 131, 119)


@dataclass(frozen=True, eq=False)
class _Stage:
    """What one stage gave."""

    name: str
    milliseconds: float
    picture: np.ndarray
    face: Face | None


@dataclass(frozen=True, eq=False)
class _Built:
    """What a job gave."""

    avatar: Avatar
    marked: Marked


class Portraying(Tab):
    """A textured head that is built from a picture whenever its landmarks change, and moved on the page.

    Heads are exaggerated once they are taken over: it has no slider for it. While one is built, that of the last stage
    is on show.

    Attributes
    ----------
    panel : widget
        Below the head: what the stages gave, performances and sliders.
    puppet : Puppet
    avatar : Avatar or None
        Of the landmarks at present.
    """

    name = "portrait"

    def __init__(self, *shared: Any) -> None:
        super().__init__(*shared)
        self.avatar: Avatar | None = None
        self._followed: Marked | None = None  # what the head is of, or is being built of
        self._worker = Worker(self._on_built, self._on_failure, self._on_stage)
        self._stages = HTML().add_class("sketchwidget-stages")
        self._figures: list[str] = []
        self.puppet = Puppet(geometry=self._head.geometry)
        self.bar = HBox([toolbar.bar((self._take,))])
        self.panel = VBox([self._stages, self.puppet])

    @property
    def exported(self) -> Avatar | None:
        """What is exported while the tab is on show."""
        return self.avatar

    def leave(self) -> None:
        """Follow the landmarks no more; the head stays, at rest."""
        super().leave()
        self.puppet.hold(None)

    def _follow(self, marked: Marked, done: bool) -> None:
        if not done:
            return
        if marked is self._followed:
            if self.avatar is None:  # it is being built
                self._show(False)
            else:
                self._wear(self.avatar)
            return
        self._worker.drop()
        self._followed = marked
        self._forget()
        picture, marks, model = marked.picture, marked.marks, self._model_of()
        if picture is None or marks is None:
            self._show(False)
            return

        def job(report: Report) -> _Built:
            from ..avatar import build

            def tell(name: str, milliseconds: float, result: np.ndarray) -> None:
                report(_seen(name, milliseconds, result, picture, model))

            return _Built(build(picture, marks, model=model, report=tell), marked)

        self._status.say(BUILDING.format("landmarks"))
        self._worker.do(job)

    def _forget(self) -> None:
        self.avatar = self.face = self.skin = None
        self.timings, self._figures, self._stages.value = {}, [], ""
        self.puppet.hold(None)
        toolbar.set_useful(self._take, False)

    def _on_stage(self, stage: _Stage) -> None:
        self.timings = {**self.timings, stage.name: stage.milliseconds}
        self._figures.append(_figure(stage))
        self._stages.value = "".join(self._figures)
        following = list(STAGES)[list(STAGES).index(stage.name) + 1 :]
        if self._active and following:
            self._status.say(BUILDING.format(STAGES[following[0]]))
        if stage.face is not None:
            self.face = stage.face
            if self._active:
                self._show(False)

    def _on_built(self, built: _Built) -> None:
        if built.marked is not self._followed:
            return
        self.avatar = built.avatar
        seconds = sum(built.avatar.timings.values()) / 1000
        self.timings = {**built.avatar.timings, "total": 1000 * seconds}
        toolbar.set_useful(self._take, True)
        if self._active:
            self._wear(built.avatar)
            self._status.say(BUILT.format(seconds))

    def _wear(self, avatar: Avatar) -> None:
        from ..avatar import performances

        self.face = avatar.face
        self.skin = avatar.skin
        self._show(False)
        self.puppet.hold(avatar, performances().values())

    def _on_failure(self, error: Exception) -> None:
        self._followed = None
        if self._active:  # else it fails again, and is told, once the tab is on show
            self._status.fail(f"There is no head of this picture: {sentence(error)}")


def _seen(name: str, milliseconds: float, result: np.ndarray, picture: np.ndarray, model: FaceModel) -> _Stage:
    """A stage as it is shown."""
    if name in ("coarse", "fine", "rig"):
        face = Face(model, result.astype(np.float32))
        return _Stage(name, milliseconds, _cut_out(face.picture(size=_SIDE)), face)
    if name == "landmarks":
        return _Stage(name, milliseconds, _dotted(picture, result), None)
    small = cv2.resize(result, (_SIDE, _SIDE), interpolation=cv2.INTER_AREA)
    return _Stage(name, milliseconds, _silhouette(small) if name == "mask" else small, None)


def _cut_out(drawn: np.ndarray) -> np.ndarray:
    """A head (n, n, 3) that was drawn on white, on no ground at all: (n, n, 4)."""
    return np.dstack([drawn, np.where((drawn == 255).all(axis=2), 0, 255).astype(np.uint8)])


def _silhouette(mask: np.ndarray) -> np.ndarray:
    """A mask (n, n) between 0 and 1 in the accent colour, on no ground: (n, n, 4)."""
    plain = np.broadcast_to(np.array(_ACCENT, dtype=np.uint8), (*mask.shape, 3))
    return np.dstack([plain, np.rint(255 * mask).astype(np.uint8)])


def _dotted(picture: np.ndarray, points: np.ndarray) -> np.ndarray:
    """The part of a picture about some landmarks, which are drawn."""
    low, high = points.min(axis=0), points.max(axis=0)
    side = 1.5 * float((high - low).max())
    corner, scale = (low + high) / 2 - side / 2, _SIDE / side
    matrix = np.array([[scale, 0, -corner[0] * scale], [0, scale, -corner[1] * scale]])
    part = cv2.warpAffine(picture, matrix, (_SIDE, _SIDE), flags=cv2.INTER_AREA, borderMode=cv2.BORDER_REPLICATE)
    for x, y in np.rint((points - corner) * scale).astype(int).tolist():
        cv2.circle(part, (x, y), 1, _ACCENT, -1)
    return part


def _figure(stage: _Stage) -> str:
    order = cv2.COLOR_RGBA2BGRA if stage.picture.shape[2] == 4 else cv2.COLOR_RGB2BGR
    encoded = base64.b64encode(cv2.imencode(".png", cv2.cvtColor(stage.picture, order))[1].tobytes()).decode()
    shown = f'<img alt="" src="data:image/png;base64,{encoded}">'
    return f"<figure>{shown}<figcaption>{STAGES[stage.name]}<br>{stage.milliseconds:.0f} ms</figcaption></figure>"
