"""From a picture to an avatar: the whole pipeline (Figure 1)."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Literal

import cv2
import numpy as np

from ..face.face import Face
from ..face.model import FaceModel
from ..geometry.camera import Camera
from ..portrait.doubts import HIDDEN_EYES, eyes_hidden, is_face
from ..portrait.landmarks import EYES, FaceDetector, FaceLandmarks
from ..portrait.mask import PersonMask, face_oval
from ..portrait.mediapipe import MediaPipeDetector
from ..portrait.models import HOW_TO_GET, missing
from ..portrait.picture import load_picture
from ..threads import one_thread
from .avatar import Avatar
from .coarse import CoarseFitter
from .eyes import Eyeball, fit_eyeballs
from .fine import FineFitter
from .network import PortraitNetwork
from .rig import RigBuilder
from .square import square_about
from .stylize import Stylizer, drawn
from .template import AvatarTemplate
from .texture import TextureBaker

Transform = Callable[[np.ndarray], np.ndarray]
Report = Callable[[str, float, np.ndarray], None]

_SIDE = 512  # pixels of the square about the face that is worked on
_TEXTURE_SIDE = 1024
_LEAST_EYES = 12.0  # pixels between the outer corners of the eyes
_RIVAL = 0.5  # of the largest face's area: another that might be meant
_PROFILE = 5.0  # how many times nearer one eye is to the edge of the face than the other


@dataclass(frozen=True, eq=False)
class _Tools:
    """What all builds with one face model share."""

    model: FaceModel
    template: AvatarTemplate
    coarse: CoarseFitter
    fine: FineFitter
    rig: RigBuilder
    texture: TextureBaker
    network: PortraitNetwork | None

    @classmethod
    def of(cls, model: FaceModel, network: PortraitNetwork | None = None) -> _Tools:
        template = AvatarTemplate.load()
        rig = RigBuilder(model, template)  # it checks that the template is for the model
        coarse, fine = CoarseFitter(model, template), FineFitter(model)
        return cls(model, template, coarse, fine, rig, TextureBaker(model, template, _TEXTURE_SIDE), network)


@lru_cache(maxsize=1)
def _shipped() -> _Tools:
    return _Tools.of(model := FaceModel.load(), PortraitNetwork.load(model))


def _tools_for(model: FaceModel | None) -> _Tools:
    shipped = _shipped()
    return shipped if model is None or model.fingerprint == shipped.model.fingerprint else _Tools.of(model)


def build(
    image: Any,
    landmarks: Any = None,
    stylize: bool | Stylizer = True,
    *,
    model: FaceModel | None = None,
    detector: FaceDetector | None = None,
    face: int | None = None,
    network: PortraitNetwork | Literal[False] | None = None,
    report: Report | None = None,
) -> Avatar:
    """An animatable cartoon head from one portrait.

    Parameters
    ----------
    image : array, path or bytes
        The portrait, (H, W, 3) uint8 or what `load_picture` takes; the face looks at the viewer, more or less.
    landmarks : (68, 2) array or FaceLandmarks, optional
        In pixels of `image` (of a file, of what `load_picture` gives), iBUG order; then no model is needed. By default
        the detector finds them.
    stylize : bool or Stylizer
        Draw the portrait as a cartoon with larger eyes first, or by a stylizer of your own.
    model : FaceModel, optional
        The shipped one by default.
    detector : FaceDetector, optional
        MediaPipe's by default, whose models `sketchwidget models` fetches; nothing is downloaded here.
    face : int, optional
        Which one if there are several, counted from the left.
    network : PortraitNetwork or False, optional
        Gives the fit its first guess; the shipped one by default, or for another model one that `sketchwidget train
        portraits` would train for it. False begins at the mean face, as other models do without.
    report : callable, optional
        Called as ``report(stage, milliseconds, result)`` after each stage: "landmarks" with (68, 2) pixels,
        "stylize" with the cartoon, "mask" with how sure each of its pixels is of the person, from 0 to 1, "coarse" and
        "fine" with (V, 3) vertices as the picture shows them, "rig" with those of the head at rest, "texture" with the
        texture.

    Returns
    -------
    Avatar

    Warns
    -----
    UserWarning
        If something dark, as sunglasses, seems to hide both eyes of a face that the detector found.

    Raises
    ------
    ValueError
        If no face is found, or several and none is chosen; if the face is in profile or too small; if the models are
        missing and no landmarks are given; if the picture or the landmarks are no such thing. Each message tells what
        to do.
    """
    clock = _Clock(report)
    picture = load_picture(image)
    # Arrays that were made smaller have landmarks, too, in the pixels that were given.
    larger = image.shape[1] / picture.shape[1] if isinstance(image, np.ndarray) else 1.0
    if landmarks is not None:
        given = landmarks if isinstance(landmarks, FaceLandmarks) else FaceLandmarks(landmarks)
        landmarks = given.moved(lambda points: points / larger)
    with clock("landmarks"):
        marks = _marks(picture, landmarks, detector, face)
    clock.tell(marks.points * larger)
    tools = _tools_for(model)
    network = tools.network if network is None else network
    with one_thread():
        return _built(picture, larger, marks, stylize, tools, network or None, clock)


def _built(
    picture: np.ndarray,
    larger: float,
    marks: FaceLandmarks,
    stylize: bool | Stylizer,
    tools: _Tools,
    network: PortraitNetwork | None,
    clock: _Clock,
) -> Avatar:
    stages: dict[str, np.ndarray] = {}
    square, to_square, from_square = squared(picture, marks)
    marks = marks.moved(to_square).snapped()
    stages["portrait"] = square
    back = None
    if stylize:
        with clock("stylize"):
            stylized = (drawn if stylize is True else stylize)(square, marks)
        square, marks, back = stylized.image, stylized.marks.snapped(), stylized.back
        stages["cartoon"] = square
        clock.tell(square)
    with clock("mask"):
        person = person_about(square, marks)
    clock.tell(person)
    refine = tools.model.template.subdivision
    with clock("coarse"):
        oval = face_oval(marks.points, square.shape[:2])
        start = None if network is None else network.predict(square, tools.coarse)
        fit = tools.coarse.fit(square, marks.points, person * oval, start)
    clock.tell(refine @ fit.vertices)
    with clock("fine"):
        posed = tools.fine.fit(fit, marks)
        rest = tools.coarse.coarse(fit.identity, tools.model.expression_weights("neutral"))
        neutral = tools.fine.neutral(posed, fit.vertices, rest)
    clock.tell(refine @ posed)
    with clock("rig"):
        rig, eyes = tools.rig(neutral, fit_eyeballs(tools.model, refine @ neutral, refine @ rest))
        resting = _with_eyes(refine @ neutral, eyes)
    clock.tell(resting)
    with clock("texture"):
        aligned = refine @ posed
        shown = _with_eyes(aligned, fit_eyeballs(tools.model, aligned, refine @ fit.vertices))
        texture = tools.texture(square, person, fit, shown, eyes, marks)
    clock.tell(texture)
    landmarks = fit.camera.project(shown[tools.model.landmarks])
    if back is not None:
        landmarks = back(landmarks)
    origin, unit = larger * from_square(np.array([[0.0, 0.0], [1.0, 0.0]]))
    scale = float(unit[0] - origin[0])
    camera = Camera(fit.camera.scale * scale, fit.camera.rotation, fit.camera.translation * scale + origin)
    return Avatar(
        face=Face(tools.model, resting),
        portrait=Face(tools.model, shown),
        texture=texture,
        uv=tools.texture.uv,
        eyes=eyes,
        rig=rig,
        camera=camera,
        marks=landmarks * scale + origin,
        stages=stages,
        timings=clock.milliseconds,
    )


def _marks(
    picture: np.ndarray, given: FaceLandmarks | None, detector: FaceDetector | None, face: int | None
) -> FaceLandmarks:
    """The marks of the face that is meant, in pixels of the picture."""
    marks = _detected(picture, detector, face) if given is None else given
    if marks.eye_distance < _LEAST_EYES:
        raise ValueError(
            f"the face is too small: its eyes are {marks.eye_distance:.0f} pixels apart, and {_LEAST_EYES:.0f} are"
            " needed; give a larger picture"
        )
    right, left = (marks.points[eye].mean(axis=0) for eye in EYES.values())
    along = (left - right) / np.linalg.norm(left - right)
    aside = [float((right - marks.points[0]) @ along), float((marks.points[16] - left) @ along)]
    if min(aside) * _PROFILE < max(aside):
        raise ValueError("the face is seen in profile: give a portrait in which both eyes and both cheeks are seen")
    return marks


def _detected(picture: np.ndarray, detector: FaceDetector | None, face: int | None) -> FaceLandmarks:
    if detector is None:
        if missing():
            raise ValueError(f"no landmarks are given, and the portrait models are not here: {HOW_TO_GET}")
        detector = _mediapipe()
    boxes = detector.faces(picture)
    if not len(boxes):
        raise ValueError("no face is found in the picture: give a portrait, or the 68 landmarks of the face yourself")
    area = boxes[:, 2] * boxes[:, 3]
    likely = boxes[area > _RIVAL * area.max()]
    likely = likely[np.argsort(likely[:, 0])]
    if face is None and len(likely) > 1:
        raise ValueError(f"there are {len(likely)} faces: choose one with face=0 for the leftmost, 1 for the next, ...")
    if face is not None and not 0 <= face < len(likely):
        raise ValueError(f"there are {len(likely)} faces, numbered from 0 at the left; given face={face}")
    marks = detector.landmarks(picture, likely[face or 0])
    if not is_face(marks):
        raise ValueError("what looks like a face is none: give a portrait, or the 68 landmarks of the face yourself")
    if eyes_hidden(picture, marks):
        warnings.warn(HIDDEN_EYES, stacklevel=4)
    return marks


@lru_cache(maxsize=1)
def _mediapipe() -> MediaPipeDetector:
    return MediaPipeDetector()


@lru_cache(maxsize=1)
def _person_mask() -> PersonMask:
    return PersonMask()


def squared(picture: np.ndarray, marks: FaceLandmarks) -> tuple[np.ndarray, Transform, Transform]:
    """The square about a face, (512, 512, 3), and what takes points to it and back."""
    corner, side = square_about(marks.points)
    scale = _SIDE / side
    matrix = np.array([[1 / scale, 0, corner[0]], [0, 1 / scale, corner[1]]])
    matrix[:, 2] += 0.5 / scale - 0.5  # middles of pixels
    shrunk = cv2.GaussianBlur(picture, (0, 0), 0.5 / scale) if scale < 0.7 else picture
    square = cv2.warpAffine(
        shrunk, matrix, (_SIDE, _SIDE), flags=cv2.INTER_CUBIC | cv2.WARP_INVERSE_MAP, borderMode=cv2.BORDER_REPLICATE
    )
    return square, lambda points: (points - corner) * scale, lambda points: points / scale + corner


def person_about(square: np.ndarray, marks: FaceLandmarks) -> np.ndarray:
    """How sure each pixel is of the person; without the model the face alone is."""
    if "selfie_segmentation" in missing():
        return face_oval(marks.points, square.shape[:2]).astype(np.float32)
    return _person_mask()(square)


def _with_eyes(head: np.ndarray, eyes: list[Eyeball]) -> np.ndarray:
    """A head (V, 3) with its eyeballs where they are."""
    head = np.array(head)
    for eye in eyes:
        head[eye.vertices] = eye.points()
    return head


class _Clock:
    """Milliseconds of the stages, and who wants to know what came of them."""

    def __init__(self, report: Report | None) -> None:
        self.milliseconds: dict[str, float] = {}
        self._report = report

    def tell(self, result: np.ndarray) -> None:
        """Report what came of the last stage."""
        if self._report is not None:
            name, spent = list(self.milliseconds.items())[-1]
            self._report(name, spent, result)

    @contextmanager
    def __call__(self, stage: str) -> Iterator[None]:
        start = time.perf_counter()
        yield
        self.milliseconds[stage] = 1000 * (time.perf_counter() - start)
