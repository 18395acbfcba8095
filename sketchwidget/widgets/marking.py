"""A picture of a face and its landmarks: opened, found or begun by three clicks, and corrected by hand."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from ipywidgets import CallbackDispatcher

from ..caricature.three_points import COUNT, landmarks_from
from ..face import FaceModel
from ..portrait import FaceDetector, load_picture
from ..portrait.mediapipe import MediaPipeDetector
from ..portrait.models import missing
from . import toolbar
from .picture_pad import PicturePad
from .status import Status, sentence
from .steps import Steps

ACCEPTED = "image/*,.tif,.tiff,.webp"
INVITATION = "Open a picture of a face"
CLICKS = ("the outer corners of both eyes, then the chin", "the outer corner of the other eye", "the chin")
DRAG = "Drag any landmark to where it belongs."

# Jaw, brows, nose, eyes and mouth, in iBUG order; the last number closes a line.
LINES = (
    (*range(17),),
    (*range(17, 22),),
    (*range(22, 27),),
    (*range(27, 31),),
    (*range(31, 36),),
    (*range(36, 42), 36),
    (*range(42, 48), 42),
    (*range(48, 60), 48),
    (*range(60, 68), 60),
)


@dataclass(frozen=True, eq=False)
class Marked:
    """A picture and what is marked on it.

    Parameters
    ----------
    picture : (H, W, 3) uint8 array or None
    points : (n, 2) array
        Pixels: the 68 landmarks, or fewer than three clicks.
    """

    picture: np.ndarray | None = None
    points: np.ndarray = field(default_factory=lambda: np.empty((0, 2)))

    @property
    def landmarks(self) -> np.ndarray | None:
        """The landmarks (68, 2), once there are all."""
        return self.points if len(self.points) > COUNT else None


class Marking:
    """The picture that tabs of the Studio share, with its pad and the buttons for it.

    Parameters
    ----------
    status : Status
        Where it says what happened and what to do.
    detector : FaceDetector, optional
        What finds landmarks; by default MediaPipe, where its models were fetched.

    Attributes
    ----------
    bar, pad : widgets
    """

    def __init__(self, status: Status, detector: FaceDetector | None = None) -> None:
        self._status, self._detector = status, detector
        self._steps = Steps(Marked())
        self._shown = Marked()
        self._change_callbacks = CallbackDispatcher()
        self.pad = PicturePad(invitation=INVITATION)
        opening = toolbar.picker("picture", ACCEPTED)
        opening.observe(self._on_file, "value")
        self.bar = toolbar.bar((opening,))
        self.pad.on_move(self._on_move)
        self.pad.on_click(self._on_click)

    def on_change(self, callback: Callable[[Marked, bool], None]) -> None:
        """Call ``callback(marked, done)`` when the picture or its landmarks change; not done while one is dragged."""
        self._change_callbacks.register_callback(callback)

    @property
    def present(self) -> Marked:
        """What is marked now."""
        return self._steps.present

    @property
    def can_undo(self) -> bool:
        """Whether something can be taken back."""
        return self._steps.can_undo

    @property
    def can_redo(self) -> bool:
        """Whether something was taken back, and nothing done since."""
        return self._steps.can_redo

    @property
    def expected(self) -> str:
        """What to do next, as a sentence."""
        if self.present.picture is None:
            return f"{INVITATION}: its landmarks are found, or begun by three clicks."
        if self.present.landmarks is None:
            return f"Click {CLICKS[len(self.present.points)]}."
        return DRAG

    def open(self, source: Any, name: str = "The picture") -> None:
        """Open a picture, as `load_picture` takes them, and look for a face in it.

        Raises
        ------
        ValueError, FileNotFoundError
            If it is no picture; what was there stays.
        """
        picture = load_picture(source)
        points, found = self._found(picture)
        self._go_to(Marked(picture, points), f"{name} is open. {found}")

    def place(self, points: np.ndarray) -> None:
        """Mark landmarks (68, 2) on the picture."""
        self._go_to(replace(self.present, points=np.asarray(points, dtype=float)))

    def clear(self) -> bool:
        """Take all marks off the picture, and without any the picture away; False if there is none."""
        if self.present.picture is None:
            return False
        self._go_to(Marked(self.present.picture) if len(self.present.points) else Marked())
        return True

    def undo(self) -> bool:
        """Take the last change back; False if there was none."""
        return self._went(self._steps.undo())

    def redo(self) -> bool:
        """Do the change last taken back again; False if there was none."""
        return self._went(self._steps.redo())

    def _went(self, changed: bool) -> bool:
        if changed:
            self._show()
        return changed

    def _go_to(self, marked: Marked, happened: str | None = None) -> None:
        """Let something else be marked; what follows it may have more to say than what happened."""
        self._steps.go_to(marked)
        if happened is not None:
            self._status.say(happened, self.expected)
        self._show()

    def _show(self) -> None:
        marked, before, known = self.present, self._shown, self.present.landmarks
        self._shown = marked
        another = marked.picture is not before.picture
        if another:
            self.pad.show_picture(marked.picture)
        if known is not None and (another or before.landmarks is None):
            self.pad.look_at(known)
        self.pad.clickable = marked.picture is not None and known is None
        self.pad.show_points(marked.points, () if known is None else LINES)
        self._change_callbacks(marked, True)

    def _found(self, picture: np.ndarray) -> tuple[np.ndarray, str]:
        """Landmarks, or none, and what to say of them."""
        nothing = np.empty((0, 2))
        if self._detector is None and missing():
            return nothing, "The models that find faces are not here (`sketchwidget models`)."
        detector = self._detector or MediaPipeDetector()
        try:
            boxes = detector.faces(picture)
            if not len(boxes):
                return nothing, "No face was found in it."
            return detector.landmarks(picture, boxes[0]).points, "A face was found."
        except ValueError as error:  # a damaged model is no reason to do without the picture
            return nothing, sentence(error)

    # -- what the user does --------------------------------------------------------------------------------------------

    def _on_file(self, change: dict[str, Any]) -> None:
        if not change["new"]:
            return
        file = change["new"][0]
        change["owner"].value = ()  # so that the same file can be picked again
        with self._status.reporting(f"{file.name} was not opened, all is as it was"):
            self.open(bytes(file.content), file.name)

    def _on_click(self, place: np.ndarray) -> None:
        if self.present.picture is None or self.present.landmarks is not None:
            return
        with self._status.reporting("No face can be there"):
            points = np.vstack([self.present.points, place])
            if len(points) == COUNT:
                points = landmarks_from(points, FaceModel.load())
            self._go_to(replace(self.present, points=points), "")

    def _on_move(self, number: int, place: np.ndarray, done: bool) -> None:
        if not 0 <= number < len(self.present.points):
            return
        points = self.present.points.copy()
        points[number] = place
        if done:
            self.place(points)
        else:
            self._change_callbacks(replace(self.present, points=points), False)
