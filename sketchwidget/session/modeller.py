"""What a session needs a network or a face model for: the head of a state."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from sketchwidget.face.attached import Attached, attached_parts
from sketchwidget.face.cover import Cover
from sketchwidget.face.template import PARTS
from sketchwidget.geometry.region_deformation import RegionDeformation
from sketchwidget.geometry.view import View
from sketchwidget.sketch import SILHOUETTE, Piece, Sketch

from .followup import Followup, HandleTargets
from .layers import Layers
from .refinement import UNREFINED
from .state import State

if TYPE_CHECKING:
    from sketchwidget.face import Face, FaceModel
    from sketchwidget.gesture.classifier import GestureClassifier
    from sketchwidget.inference import FaceRegressor

    from .take_over import Residual

_KEPT = 4  # heads: those of the present state, the one before, and of strokes that are still being drawn


@dataclass(frozen=True, eq=False)
class Modelled:
    """The head of a state.

    Parameters
    ----------
    layers : Layers
        What it is made of.
    frame : View
        Where it stands on the canvas.
    names : tuple of str
        A line name for each segment of the sketch.
    timings : mapping of str to float
        Milliseconds by step.
    """

    layers: Layers
    frame: View = field(default_factory=View)
    names: tuple[str, ...] = ()
    timings: Mapping[str, float] = field(default_factory=dict)

    @classmethod
    def of(cls, face: Face, frame: View, sketch: Sketch) -> Modelled:
        """A head that nothing was inferred for."""
        return cls(Layers(face), frame, _names(sketch))

    @property
    def face(self) -> Face:
        """The head, all layers on top of each other."""
        return self.layers.head


class Modeller:
    """Gives the head of any state; the same one as long as the model and the network are the same.

    Parameters
    ----------
    regressor : object with `infer(sketch) -> Inference`, optional
        Default: the shipped `FaceRegressor`, loaded when first needed.
    inference : bool
        If False, no sketch is inferred: the parameters of every head are those of the template.
    """

    def __init__(self, regressor: FaceRegressor | None = None, inference: bool = True) -> None:
        if inference and regressor is not None and not callable(getattr(regressor, "infer", None)):
            raise TypeError(f"a session's regressor has infer(sketch), such as a FaceRegressor; given {regressor!r}")
        self.inference = inference
        self._regressor = regressor
        self._model: FaceModel | None = None
        self._heads: deque[tuple[State, Modelled]] = deque(maxlen=_KEPT)
        self._below: tuple[State, Modelled] | None = None
        self._inferred: tuple[Sketch, Modelled] | None = None
        self._lined: tuple[Sketch, Residual | None, Modelled] | None = None
        self._deformations: deque[tuple[bytes, RegionDeformation]] = deque(maxlen=_KEPT)

    @cached_property
    def gestures(self) -> GestureClassifier:
        """What tells gestures apart; the shipped one, loaded when first needed."""
        from sketchwidget.gesture.classifier import GestureClassifier

        return GestureClassifier.load()

    @cached_property
    def soft(self) -> np.ndarray:
        """Which vertices (V,) bool deform: skin and mouth."""
        return self.model.template.fine_parts <= PARTS.index("mouth")

    @cached_property
    def soft_faces(self) -> np.ndarray:
        """The triangles (f, 3) of what deforms."""
        return self.model.faces[self.soft[self.model.faces].all(axis=1)]

    @cached_property
    def skin(self) -> np.ndarray:
        """The triangles (f, 3) of the skin."""
        skin = self.model.template.fine_parts == PARTS.index("skin")
        return self.model.faces[skin[self.model.faces].all(axis=1)]

    @cached_property
    def attached(self) -> list[Attached]:
        """Eyes, teeth and tongue, which do not deform, and what each of them follows."""
        return attached_parts(self.model.template, self.model.mean)

    @cached_property
    def covers(self) -> list[Cover]:
        """The skin about each of the attached parts."""
        return [Cover.of(part, self.model.template, self.model.mean) for part in self.attached]

    def deformation(self, movable: np.ndarray, handles: np.ndarray) -> RegionDeformation:
        """The deformation of a region (V,) bool by handles (h,); the last few are remembered, with their factors.

        Its metric is that of the mean face, whose triangles are all well shaped, whatever a head has been through.

        Raises
        ------
        ValueError
            As `RegionDeformation` does.
        """
        key = np.packbits(movable).tobytes() + np.asarray(handles, dtype=np.int32).tobytes()
        for known, deformation in self._deformations:
            if known == key:
                return deformation
        deformation = RegionDeformation(self.model.mean, self.model.faces, movable, handles)
        self._deformations.append((key, deformation))
        return deformation

    @property
    def given(self) -> FaceRegressor | None:
        """The regressor, unless it was not needed yet."""
        return self._regressor

    @property
    def regressor(self) -> FaceRegressor:
        """What infers the heads; the shipped one is loaded when it is first asked for."""
        if self._regressor is None:
            # Here, so that a session imports torch with the first face only.
            from sketchwidget.inference import FaceRegressor

            self._regressor = FaceRegressor.load()
        return self._regressor

    @property
    def model(self) -> FaceModel:
        """The regressor's face model; without inference and without a regressor, the shipped one."""
        if self._regressor is not None or self.inference:
            return self.regressor.model
        if self._model is None:
            from sketchwidget.face import FaceModel

            self._model = FaceModel.load()
        return self._model

    def face(self, vertices: np.ndarray) -> Face:
        """The head of given vertices (V, 3).

        Raises
        ------
        ValueError
            If there are not as many as the model has.
        """
        from sketchwidget.face import Face

        return Face(self.model, vertices)

    def prepare(self) -> None:
        """Load the network and what deforms heads."""
        if self.inference:
            _ = self.regressor
        self.prepare_editing()

    def prepare_editing(self) -> None:
        """Compute what the first edit of a line would wait for."""
        _ = self.model.handles

    def head(self, state: State) -> Modelled:
        """The head of a state; those of the states asked for last are remembered, and take no time."""
        modelled = self.tried(state)
        self._heads[-1] = (state, replace(modelled, timings={}))
        return modelled

    def tried(self, state: State) -> Modelled:
        """The head of a state that may come to nothing; if it does not, `head` still tells what it took."""
        for number, known in enumerate(self._heads):
            if known[0] is state:
                modelled = known[1]
                del self._heads[number]
                break
        else:
            modelled = _refined(self._unrefined(replace(state, refinement=UNREFINED)), state)
        self._heads.append((state, modelled))
        return modelled

    def obeying(self, state: State, opened: State) -> Modelled:
        """The head whose lines are those of a state, and which is inferred as before one of them was opened."""
        assert state.followup is not None and opened.followup is not None and opened.followup.before is not None
        below = replace(self._unedited(opened.followup.before), names=_names(state.sketch), timings={})
        return _refined(self._obeying(below, state.sketch, state.followup), state)

    def _unrefined(self, state: State) -> Modelled:
        """The head of a state without refinement; the last is remembered, so that gestures infer nothing."""
        if self._below is not None and self._below[0] == state:
            return self._below[1]
        modelled = self._modelled(state)
        self._below = (state, replace(modelled, timings={}))
        return modelled

    def _modelled(self, state: State) -> Modelled:
        followup = state.followup
        if followup is not None and followup.before is not None:
            # While a line waits to be drawn, the head is the one before it was erased.
            return replace(self.head(followup.before), names=_names(state.sketch))
        if followup is not None and followup.profile is None and state.sketch == followup.lines:
            return replace(followup.start, names=_names(state.sketch), timings={})
        if followup is None or not (_edited(state.sketch) or followup.profile is not None):
            return self._unedited(state)
        if followup.profile is None:
            return self.lined(state)
        return self._obeying(self._unedited(state), state.sketch, followup)

    def lined(self, state: State) -> Modelled:
        """The head that the lines of the front view alone give in follow-up sketching, without a drawn profile.

        That of the last sketch is remembered, and the one that editing began with does not change until a line does, so
        that a drag of the profile deforms once.
        """
        assert state.followup is not None
        sketch, residual, start = state.sketch, state.residual, state.followup.start
        if self._lined is not None and self._lined[0] is sketch and self._lined[1] is residual:
            return self._lined[2]
        below = self._unedited(state)
        if sketch == state.followup.lines and np.array_equal(below.face.vertices, start.layers.drawn.vertices):
            return start
        lined = self._obeying(below, sketch, replace(state.followup, profile=None))
        self._lined = (sketch, residual, replace(lined, timings={}))
        return lined

    def _unedited(self, state: State) -> Modelled:
        """The head below the edited lines; that of the last sketch is remembered, so that a profile infers nothing."""
        sketch = state.sketch
        if self._inferred is None or self._inferred[0] is not sketch:
            inferred = self.inferred(sketch)
            self._inferred = (sketch, replace(inferred, timings={}))
        else:
            inferred = self._inferred[1]
        return inferred if state.residual is None else state.residual.on(inferred)

    def inferred(self, sketch: Sketch) -> Modelled:
        """The head that is inferred from a sketch; without inference, that of the template."""
        if not self.inference:
            return Modelled.of(self.model.face(), View(), sketch)
        regressor = self.regressor
        started = perf_counter()
        inference = regressor.infer(sketch)
        timings = {**inference.timings, "inference": _milliseconds_since(started)}
        return Modelled(Layers(inference.face), inference.frame, inference.names, timings)

    def _obeying(self, inferred: Modelled, sketch: Sketch, followup: Followup) -> Modelled:
        """A head with its lines where they were drawn; without an edited silhouette it stands where it was inferred."""
        started = perf_counter()
        frame = followup.start.frame if SILHOUETTE in _edited(sketch) else inferred.frame
        layers = replace(inferred.layers, targets=HandleTargets(inferred.frame, frame, sketch, followup))
        _ = layers.head
        timings = {**inferred.timings, "deformation": _milliseconds_since(started)}
        return Modelled(layers, frame, inferred.names, timings)


def _refined(modelled: Modelled, state: State) -> Modelled:
    """A head with what gestures made of it."""
    layer = state.refinement.layer
    return modelled if modelled.layers.refinement is layer else replace(modelled, layers=modelled.layers.refined(layer))


def _edited(sketch: Sketch) -> set[str]:
    """Names of the lines that follow-up sketching has drawn."""
    return {segment.name for segment in sketch.segments if isinstance(segment, Piece)}


def _names(sketch: Sketch) -> tuple[str, ...]:
    return tuple(segment.name for segment in sketch.segments)


def _milliseconds_since(started: float) -> float:
    return 1e3 * (perf_counter() - started)
