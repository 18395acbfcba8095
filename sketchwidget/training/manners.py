"""Manners of drawing the lines of a face: exactly, with lines removed and deformed, or freehand."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from ..face.drawing import outline, split_line
from ..face.wrinkles import LIPS
from ..inference.framing import Frame
from ..inference.shape_code import COUNTS, LINES, sample
from ..sketch import SILHOUETTE, WRINKLE, Segment, Sketch, rasterise
from ..sketch.augment import deform_lines, remove_lines
from ..sketch.hand import PART_LINES, PARTS, Hand
from ..sketch.moving_least_squares import affine
from ..sketch.wobble import wobble

_SHARE_REMOVED = 0.25  # of the segments, at most
_BENT = 0.006  # canvas units by which the whole drawing is bent
_CONTROLS_APART = 8  # points of the lines, of those that carry the wrinkles along
_UNNAMED = 0.1  # chance that a freehand line is not recognised
_JITTER = 0.004  # canvas units by which recognised freehand lines are out of place


class Manner(StrEnum):
    """How a face's lines become a drawing."""

    EXACT = "exact"
    AUGMENTED = "augmented"
    FREEHAND = "freehand"


@dataclass(frozen=True)
class Drawn:
    """A drawing as networks see it.

    Parameters
    ----------
    image : (256, 256) bool array
        Normalised; (0, 0) if only the lines are wanted.
    points : (n, 2) array
        Of the shape model, in the normalised drawing.
    seen : (n,) bool array
        Which of them are drawn and recognised.
    """

    image: np.ndarray
    points: np.ndarray
    seen: np.ndarray


def draw(
    manner: Manner,
    lines: dict[str, np.ndarray],
    parts: set[str],
    wrinkles: np.ndarray | None,
    front: dict[str, np.ndarray],
    hand: Hand,
    random: np.random.Generator,
    pixels: bool = True,
) -> Drawn:
    """Draw a face.

    Parameters
    ----------
    manner : Manner
    lines : dict of (k, 2) arrays
        Projected lines by name.
    parts : set of str
        Which parts a freehand drawing has.
    wrinkles : (w, m, 2) array or None
        Suggestive contours of a face in the front view, NaN where there are no more; None draws no wrinkle lines.
    front : dict of (k, 2) arrays
        The lines of the face that has these wrinkles, in the front view: from there they are carried to `lines`.
    hand : Hand
        Who draws freehand.
    random : numpy Generator
    pixels : bool
        Whether there is an image; without it, it is empty, and drawing takes half the time.
    """
    if manner is Manner.FREEHAND:
        lines = hand.intend(lines, random)
    folds = [] if wrinkles is None else _carried(wrinkles, front, lines)
    whole = lines | {SILHOUETTE: outline(lines[SILHOUETTE])}
    if manner is Manner.FREEHAND:
        return _freehand(whole, parts, folds, hand, random, pixels)
    pieces = [Segment(name, piece) for name in LINES for piece in split_line(name, whole[name])]
    lips = [] if wrinkles is None else [piece for name in LIPS for piece in split_line(name, lines[name])]
    complete = Sketch((*pieces, *(Segment(WRINKLE, fold) for fold in (*lips, *folds))))
    if manner is Manner.EXACT:
        return _seen(
            [segment.points for segment in complete.segments],
            [(piece.name, piece.points) for piece in pieces],
            pixels,
        )
    kept = remove_lines(complete, random, share=random.uniform(0.0, _SHARE_REMOVED))
    moved = dict(zip(map(id, kept.segments), deform_lines(kept, random, overall=_BENT).segments, strict=True))
    found = [moved[id(piece)].points if id(piece) in moved else np.full_like(piece.points, np.nan) for piece in pieces]
    names = [piece.name for piece in pieces]
    return _seen([segment.points for segment in moved.values()], list(zip(names, found, strict=True)), pixels)


def _seen(strokes: list[np.ndarray], pieces: list[tuple[str, np.ndarray]], pixels: bool) -> Drawn:
    """What is seen of strokes and of the pieces of the lines, NaN where they are not drawn."""
    lines = {name: np.concatenate([points for of, points in pieces if of == name]) for name in LINES}
    drawn_outline = lines[SILHOUETTE]
    frame = Frame.of_outline(drawn_outline) if np.isfinite(drawn_outline).all() else Frame()
    points = frame(sample(lines))
    seen = np.isfinite(points[:, 0])
    return Drawn(_image(strokes, frame, pixels), np.where(seen[:, None], points, 0.0), seen)


def _freehand(
    lines: dict[str, np.ndarray],
    parts: set[str],
    folds: list[np.ndarray],
    hand: Hand,
    random: np.random.Generator,
    pixels: bool,
) -> Drawn:
    drawn = hand.draw(lines, parts, random)
    frame = Frame.of_outline(np.concatenate(drawn["outline"])) if "outline" in drawn else Frame()
    strokes = [stroke for part in drawn.values() for stroke in part]
    strokes += [wobble(fold, hand.tremor, random) for fold in folds if parts == set(PARTS)]
    present = {name for part in parts - {"outline"} for name in PART_LINES[part]}
    present |= {SILHOUETTE} if "outline" in parts else set()
    recognised = {name: name in present and random.random() >= _UNNAMED for name in LINES}
    off = np.concatenate([np.tile(random.normal(0.0, _JITTER, 2), (count, 1)) for count in COUNTS.values()])
    seen = np.concatenate([np.full(count, recognised[name]) for name, count in COUNTS.items()])
    # What is drawn of an outline may be open; the lines are coded where the whole head stands.
    head = Frame.of_outline(lines[SILHOUETTE]) if "outline" in drawn else Frame()
    points = head(sample(lines)) + off + random.normal(0.0, _JITTER / 2, off.shape)
    return Drawn(_image(strokes, frame, pixels), points, seen)


def _image(strokes: list[np.ndarray], frame: Frame, pixels: bool) -> np.ndarray:
    return rasterise([frame(stroke) for stroke in strokes]) if pixels else np.zeros((0, 0), dtype=bool)


def _carried(wrinkles: np.ndarray, front: dict[str, np.ndarray], lines: dict[str, np.ndarray]) -> list[np.ndarray]:
    """Wrinkles of a face in the front view, carried along to where its lines are drawn."""
    folds = wrinkles[np.isfinite(wrinkles[:, 0, 0])].astype(np.float64)
    if not len(folds):
        return []
    start, end = (np.concatenate([of[name] for name in lines])[::_CONTROLS_APART] for of in (front, lines))
    if np.array_equal(start, end):
        return list(folds)
    return list(affine(folds.reshape(-1, 2), start, end).reshape(folds.shape))
