"""The Portrait tab of the Studio: a picture as an animatable head, stage by stage."""

from __future__ import annotations

import base64
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import cv2
import numpy as np
from ipywidgets import HTML, HBox, VBox

from ..face import Face, FaceModel
from . import toolbar
from .head_view import HeadView
from .marking import Marked, Marking
from .mesh_stream import Skin
from .puppet import Puppet
from .status import Status, sentence
from .worker import Report, Worker

if TYPE_CHECKING:
    from ..avatar import Avatar

BUILDING = "The head is built, some seconds: {} …"
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


@dataclass(frozen=True, eq=False)
class _Stage:
    """What one stage gave."""

    name: str
    milliseconds: float
    picture: np.ndarray | None
    face: Face | None


@dataclass(frozen=True, eq=False)
class _Built:
    """What a job gave."""

    avatar: Avatar
    marked: Marked


class Portraying:
    """A textured head that is built from a picture whenever its landmarks change, and moved on the page.

    Parameters
    ----------
    marking : Marking
        The picture and its landmarks.
    head : HeadView
    status : Status
    model_of : callable
        Gives the model whose heads are built.
    show : callable
        ``show(passing)`` when there is another head to show.
    take_over : callable
        Called with the head that is to become the session's, and its texture.

    Attributes
    ----------
    bar, panel : widgets
        Buttons over the head; and below it what the stages gave, performances and sliders.
    puppet : Puppet
    avatar : Avatar or None
        Of the landmarks at present.
    face : Face or None
        The head on show: while one is built, that of the last stage.
    skin : Skin or None
    timings : dict of str to float
        Milliseconds of the stages.
    """

    name = "portrait"
    amount = 1.0  # heads are exaggerated once they are taken over

    def __init__(
        self,
        marking: Marking,
        head: HeadView,
        status: Status,
        model_of: Callable[[], FaceModel],
        show: Callable[[bool], None],
        take_over: Callable[[Face, Skin | None], None],
    ) -> None:
        self._marking, self._head, self._status = marking, head, status
        self._model_of, self._show, self._take_over = model_of, show, take_over
        self.avatar: Avatar | None = None
        self.face: Face | None = None
        self.skin: Skin | None = None
        self.timings: dict[str, float] = {}
        self._active = False
        self._followed: Marked | None = None  # what the head is of, or is being built of
        self._worker = Worker(self._on_built, self._on_failure, self._on_stage)
        self._take = toolbar.button("take")
        self._take.on_click(lambda _: self._on_take())
        toolbar.set_useful(self._take, False)
        self._stages = HTML().add_class("sketchwidget-stages")
        self._figures: list[str] = []
        self.puppet = Puppet(geometry=head.geometry)
        self.bar = HBox([toolbar.bar((self._take,))])
        self.panel = VBox([self._stages, self.puppet])
        marking.on_change(self._on_marks)

    @property
    def exported(self) -> Avatar | None:
        """What is exported while the tab is on show."""
        return self.avatar

    @property
    def expected(self) -> str:
        """What to do next, as a sentence."""
        return self._marking.expected

    def enter(self) -> None:
        """Follow the landmarks from now on."""
        self._active = True
        self._follow(self._marking.present)

    def leave(self) -> None:
        """Follow them no more; the head stays, at rest."""
        self._active = False
        self.puppet.hold(None)

    def exaggerate(self, amount: float) -> None:
        """Do nothing: it has no slider for it."""

    def _on_marks(self, marked: Marked, done: bool) -> None:
        if self._active and done:
            self._follow(marked)

    def _follow(self, marked: Marked) -> None:
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

            def tell(name: str, milliseconds: float, result: np.ndarray | None) -> None:
                report(_seen(name, milliseconds, result, picture, model))

            shipped = model is FaceModel.load()
            return _Built(build(picture, marks, model=None if shipped else model, report=tell), marked)

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
        if self.skin is None:
            self.skin = Skin(avatar.jpeg, avatar.uv)
        self._show(False)
        self.puppet.hold(avatar, performances().values())

    def _on_failure(self, error: Exception) -> None:
        self._followed = None
        self._status.fail(f"There is no head of this picture: {sentence(error)}")

    def _on_take(self) -> None:
        if self.avatar is None:
            self._status.say("There is no head to take over yet.", self.expected)
        else:
            self._take_over(self.avatar.face, self.skin)


def _seen(name: str, milliseconds: float, result: np.ndarray | None, picture: np.ndarray, model: FaceModel) -> _Stage:
    """A stage as it is shown."""
    if result is None:
        return _Stage(name, milliseconds, None, None)
    if name == "landmarks":
        return _Stage(name, milliseconds, _dotted(picture, result), None)
    if name in ("coarse", "fine"):
        face = Face(model, result.astype(np.float32))
        return _Stage(name, milliseconds, face.picture(size=_SIDE), face)
    return _Stage(name, milliseconds, cv2.resize(result, (_SIDE, _SIDE), interpolation=cv2.INTER_AREA), None)


def _dotted(picture: np.ndarray, points: np.ndarray) -> np.ndarray:
    """The part of a picture about some landmarks, which are drawn."""
    low, high = points.min(axis=0), points.max(axis=0)
    side = 1.5 * float((high - low).max())
    corner, scale = (low + high) / 2 - side / 2, _SIDE / side
    matrix = np.array([[scale, 0, -corner[0] * scale], [0, scale, -corner[1] * scale]])
    part = cv2.warpAffine(picture, matrix, (_SIDE, _SIDE), flags=cv2.INTER_AREA, borderMode=cv2.BORDER_REPLICATE)
    for x, y in np.rint((points - corner) * scale).astype(int).tolist():
        cv2.circle(part, (x, y), 1, (13, 131, 119), -1)
    return part


def _figure(stage: _Stage) -> str:
    shown = ""
    if stage.picture is not None:
        encoded = cv2.imencode(".jpg", cv2.cvtColor(stage.picture, cv2.COLOR_RGB2BGR))[1].tobytes()
        shown = f'<img alt="" src="data:image/jpeg;base64,{base64.b64encode(encoded).decode()}">'
    return f"<figure>{shown}<figcaption>{STAGES[stage.name]} {stage.milliseconds:.0f} ms</figcaption></figure>"
