"""Follow-up sketching: the lines of a head are edited, and the head obeys exactly (paper 3.2 and 5.1)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from sketchwidget.face.drawing import editable
from sketchwidget.face.handles import LINES
from sketchwidget.geometry.view import View
from sketchwidget.sketch import SILHOUETTE, UNNAMED, WRINKLE, Piece, Segment, Sketch
from sketchwidget.sketch.crossing import swept
from sketchwidget.sketch.erase import first_touched
from sketchwidget.sketch.fairing import FINEST, faired
from sketchwidget.sketch.gap import Gap, GapError, closed, feature_gap, fill, outline_gap
from sketchwidget.sketch.partner import follow, partner_of
from sketchwidget.sketch.piece import handle_points, joined, slid

from . import profile
from .events import Cancel, Clear, Draw, Erase, Event
from .state import State

if TYPE_CHECKING:
    from sketchwidget.face import Face

    from .modeller import Modelled, Modeller

_LEEWAY = 0.4  # mm by which handle points of the silhouette may be off its line
_EARS, _BROWS, _NOSE = ("left_ear", "right_ear"), ("right_brow", "left_brow"), "nose"
_BRIDGE, _BRIDGE_POINTS = "of the bridge of the nose", 12
_SIDES = {"left": "right", "right": "left"}


@dataclass(frozen=True, eq=False)
class Followup:
    """What follow-up sketching adds to a state.

    Parameters
    ----------
    start : Modelled
        The head whose lines are edited. It stays as it is until something is.
    lines : Sketch
        Its lines, and the wrinkles drawn before.
    profile : Dragged or None
        What was drawn of the profile.
    gap : Gap or None
        What was erased and must be drawn next.
    before : State or None
        The state before it was erased.
    """

    start: Modelled
    lines: Sketch
    profile: profile.Dragged | None = None
    gap: Gap | None = None
    before: State | None = None


@dataclass(frozen=True, eq=False)
class HandleTargets:
    """A layer: the lines of a head are where they were drawn.

    Parameters
    ----------
    inferred, frame : View
        Where the head below stands in the drawing, and where the edited one does: drawn wider, it is wider; depth
        stays.
    sketch : Sketch
        Its pieces tell where the handles of the lines go.
    followup : Followup
    """

    inferred: View
    frame: View
    sketch: Sketch
    followup: Followup

    def on(self, head: Face) -> Face:
        """The head with its lines moved."""
        from sketchwidget.face import Face

        vertices = np.array(head.vertices)
        placed = self.inferred.project(head.vertices)
        vertices[:, :2] = self._in_head(placed)
        model, drawn = head.model, self.followup.profile
        targets = {}
        for name in LINES:
            path = model.curves[name]
            targets[name] = self._in_head(self._targets(name, placed[path]))
        moves = None if drawn is None else drawn.moves(vertices[model.handles.profile])
        return Face(model, model.handles(vertices, targets, moves))

    def _in_head(self, points: np.ndarray) -> np.ndarray:
        """Canvas points (n, 2) as x and y in millimetres."""
        return (points - self.frame.centre) / self.frame.scale * [1, -1]

    def _targets(self, name: str, placed: np.ndarray) -> np.ndarray:
        """Where the handle points (k, 2) of a line, placed in the drawing, go on the canvas."""
        pieces = pieces_of(self.sketch, name)
        drawn = handle_points(pieces, len(placed))
        if name != SILHOUETTE or not pieces or not pieces[0].is_closed:
            return drawn
        if self.frame is not self.followup.start.frame:
            return slid(pieces[0], placed, np.zeros(len(placed), dtype=bool))
        # Drawn smoother than the mesh has it: what was not edited stays as near to its place as it may.
        former = handle_points(pieces_of(self.followup.lines, name), len(placed))
        off = self.frame.project(self.followup.start.layers.drawn.curve(name)) - former
        same = np.linalg.norm(drawn - former, axis=1) < 1e-6
        if same.all():
            return former + off
        off *= np.minimum(1.0, _LEEWAY * self.frame.scale / np.maximum(np.linalg.norm(off, axis=1), 1e-9))[:, None]
        return np.where(same[:, None], former + off, slid(pieces[0], placed, same))


def entered(state: State, modeller: Modeller) -> State:
    """The state in which the lines of the head on show are edited.

    The projected lines take the place of silhouette and features; drawn wrinkles stay, and so do lines that were edited
    before and not touched since. Of a line that was drawn again by hand, the head has the newer one.
    """
    shown = modeller.head(state)
    by_hand = {
        name
        for name, segment in zip(shown.names, state.sketch.segments, strict=True)
        if name != WRINKLE and not isinstance(segment, Piece)
    }
    newer = tuple(one for one in state.sketch.segments if not (isinstance(one, Piece) and one.name in by_hand))
    if len(newer) < len(state.sketch):
        state = replace(state, sketch=Sketch(newer))
        shown = modeller.head(state)
    modeller.prepare_editing()
    face = shown.layers.drawn
    kept = _whole_lines(state.sketch, face)
    if len(kept) == len(LINES) and all(segment.name != UNNAMED for segment in state.sketch.segments):
        return replace(state, mode="followup")
    projected = editable(face.model.template, face.vertices, shown.frame)
    lines = [piece for name in LINES for piece in kept.get(name) or pieces_of(projected, name)]
    named = state.sketch.renamed(shown.names).segments
    wrinkles = [segment for segment in named if segment.name == WRINKLE]
    sketch = Sketch((*lines, *wrinkles))
    former = state.followup and state.followup.profile
    return replace(state, mode="followup", sketch=sketch, followup=Followup(shown, sketch, former))


def from_template(modeller: Modeller) -> State:
    """The state in which the lines of the template are edited."""
    from .modeller import Modelled

    face = modeller.model.face()
    modeller.prepare_editing()
    sketch = editable(face.model.template, face.vertices, View())
    start = Modelled.of(face, View(), sketch)
    return State("followup", sketch, Followup(start, sketch))


def left(state: State) -> State:
    """The state as another mode begins: what was erased and not drawn anew is there again."""
    waiting = state.followup and state.followup.before
    return waiting or state


def edited(state: State, event: Event, modeller: Modeller) -> State:
    """The state after an edit in follow-up sketching; the same object if it changes nothing.

    Raises
    ------
    ValueError
        If a stroke closes no gap, or comes where something else must be drawn first.
    """
    followup = state.followup
    if followup is None:
        raise ValueError("there are no lines to edit: enter the mode by session.mode or session.start_from_template()")
    match event:
        case Draw(points=points, view="front", mirror=mirror, spacing=spacing):
            middle = float(modeller.head(state).frame.centre[0])
            strokes = [points, _mirrored(points, middle)] if mirror else [points]
            if followup.gap is None:
                return _with_wrinkles(state, strokes)
            return _filled(state, followup, strokes, spacing or FINEST)
        case Draw(points=points, view=view):
            if followup.gap is not None:
                raise GapError(f"the erased part of the line {followup.gap.name} must be drawn first, or cancelled")
            shown, lined = modeller.head(state), modeller.lined(state)
            drawn = profile.dragged(followup.profile, shown, lined, points, view)
            return replace(state, followup=replace(followup, profile=drawn))
        case Erase(points=points, radius=radius):
            return _erased(state, followup, points, radius)
        case Cancel():
            return followup.before or state
        case Clear():
            cleared = Sketch(tuple(segment for segment in followup.lines.segments if isinstance(segment, Piece)))
            unchanged = followup.profile is None and followup.gap is None and state.sketch == cleared
            return state if unchanged else replace(state, sketch=cleared, followup=Followup(followup.start, cleared))
        case _:
            raise TypeError(f"an edit is a Draw, Erase, Cancel or Clear; given {event!r}")


def pieces_of(sketch: Sketch, name: str) -> list[Piece]:
    """The pieces of a line, in its order."""
    pieces = [segment for segment in sketch.segments if segment.name == name and isinstance(segment, Piece)]
    return sorted(pieces, key=lambda piece: piece.low)


def _whole_lines(sketch: Sketch, face: Face) -> dict[str, list[Piece]]:
    """The lines of which every handle point is in the drawing."""
    found = {name: pieces_of(sketch, name) for name in LINES}
    counts = {name: len(face.model.curves[name]) for name in LINES}
    return {
        name: pieces
        for name, pieces in found.items()
        if pieces and np.isfinite(handle_points(pieces, counts[name])).all()
    }


def _with_line(sketch: Sketch, name: str, pieces: Sequence[Piece]) -> Sketch:
    """The sketch with other pieces of a line, in the order of the lines."""
    others = [segment for segment in sketch.segments if segment.name != name]
    order = {line: number for number, line in enumerate(LINES)}
    segments: list[Segment] = [*pieces, *others]
    return Sketch(tuple(sorted(segments, key=lambda segment: order.get(segment.name, len(order)))))


def _with_wrinkles(state: State, strokes: list[np.ndarray]) -> State:
    sketch = state.sketch
    for stroke in strokes:
        sketch = sketch.with_segment(WRINKLE, stroke)
    return replace(state, sketch=sketch)


def _erased(state: State, followup: Followup, points: np.ndarray, radius: float) -> State:
    waiting = followup.gap.name if followup.gap else None
    sketch = state.sketch
    within = [n for n, segment in enumerate(sketch.segments) if waiting in (None, segment.name)]
    touched = first_touched(Sketch(tuple(sketch.segments[n] for n in within)), points, radius)
    if touched is None:
        return state
    segment = sketch.segments[within[touched]]
    if not isinstance(segment, Piece):
        kept = tuple(other for n, other in enumerate(sketch.segments) if n != within[touched])
        return replace(state, sketch=Sketch(kept))
    before = followup.before or state
    whole = pieces_of(before.sketch, segment.name)
    if segment.name == SILHOUETTE:
        opened = outline_gap(whole[0], segment, points, radius)
        if opened is None:
            return state
        pieces, gap = [opened[0]], opened[1]
    else:
        low, high = segment.low, segment.high
        if followup.gap is not None:
            low, high = min(low, followup.gap.low), max(high, followup.gap.high)
        pieces, gap = feature_gap(whole, low, high)
    opened_followup = replace(followup, gap=gap, before=before)
    return replace(state, sketch=_with_line(sketch, segment.name, pieces), followup=opened_followup)


def _filled(state: State, followup: Followup, strokes: list[np.ndarray], spacing: int) -> State:
    gap, before = followup.gap, followup.before
    assert gap is not None and before is not None
    sketch = _redrawn(before.sketch, state.sketch, gap, strokes[0], spacing)
    side, _, rest = gap.name.partition("_")
    if len(strokes) > 1 and side in _SIDES:
        other = f"{_SIDES[side]}_{rest}"
        kept, mirrored = feature_gap(pieces_of(sketch, other), gap.low, gap.high)
        sketch = _redrawn(sketch, _with_line(sketch, other, kept), mirrored, strokes[1], spacing)
    return replace(state, sketch=sketch, followup=replace(followup, gap=None, before=None))


def _redrawn(before: Sketch, opened: Sketch, gap: Gap, stroke: np.ndarray, spacing: int) -> Sketch:
    """The sketch with a gap closed by a stroke, and the partner of the line taken along."""
    kept = pieces_of(opened, gap.name)
    new = fill(gap, stroke)
    if gap.name == SILHOUETTE:
        outline = closed(kept[0], new)
        _refuse_crossing(before, gap.erased, new)
        return _with_line(opened, SILHOUETTE, [outline])
    line = sorted([*kept, faired(new, kept, spacing)], key=lambda piece: piece.low)
    sketch = _with_line(opened, gap.name, line)
    partner = partner_of(gap.name)
    former = pieces_of(before, gap.name)
    _refuse_crossing(before, joined(former), joined(line))
    if partner is None:
        return sketch
    beside = pieces_of(opened, partner)
    following = follow(beside, former, line, spacing)
    _refuse_crossing(before, joined(beside), joined(following))
    return _with_line(sketch, partner, following)


def _refuse_crossing(before: Sketch, former: Piece, new: Piece) -> None:
    """Raise a `GapError` if a line would pass over another one: the skin between them would fold."""
    for name, line in _lines_to_keep_off(before).items():
        alone = {name, former.name} <= {SILHOUETTE, *_EARS} or name in (former.name, partner_of(former.name))
        alone |= (name, former.name) == (_BRIDGE, _NOSE)
        if not alone and swept(former.points, new.points, line):
            passing, passed = (text.replace("_", " ") for text in (former.name, name))
            raise GapError(
                f"the gap cannot be closed so: the line {passing} would pass over the line {passed}; move that first"
            )


def _lines_to_keep_off(sketch: Sketch) -> dict[str, np.ndarray]:
    """The lines (n, 2) of a head, and what no line draws: the bridge of the nose, from the height of the brows down."""
    lines = {name: joined(pieces).points for name in LINES if (pieces := pieces_of(sketch, name))}
    if lines.keys() >= {_NOSE, *_BROWS}:
        right, left = (lines[brow] for brow in _BROWS)
        root = (right[:, 0].max() + left[:, 0].min()) / 2, max(right[:, 1].max(), left[:, 1].max())
        tip = lines[_NOSE][len(lines[_NOSE]) // 2]
        lines[_BRIDGE] = np.linspace(root, tip, _BRIDGE_POINTS)
    return lines


def _mirrored(points: np.ndarray, middle: float) -> np.ndarray:
    return np.stack([2 * middle - points[:, 0], points[:, 1]], axis=1)
