"""What each gesture does to a head (paper 3.3), and how users add gestures and tools of their own.

A behaviour is a function from an `Edit` to a `Refinement`; it raises a ValueError, whose message the user reads, where
there is nothing to do.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from sketchwidget.geometry.enclosure import enclosed
from sketchwidget.geometry.silhouette import Drag, nearest_silhouette, silhouettes
from sketchwidget.gesture.names import ARROWS, DOWN_ROLLS, GESTURES, LEVELS, LINE, REGION, UP_ROLLS

from .refinement import Edit, Refinement

if TYPE_CHECKING:
    from .events import Gesture
    from .modeller import Modeller
    from .state import State

Behaviour = Callable[[Edit], Refinement]
Recogniser = Callable[[np.ndarray], bool]

DEPTHS = [4.0, 8.0, 12.0]  # mm of bulging or depression, by level; looked up by each roll, so they may be changed
PEN_TOOLS = ("gesture", "brush", "unbrush", "orbit")  # of the Studio
NEAR = 0.12  # canvas units from a silhouette within which a line means it: 30 mm
_RESERVED = (*ARROWS, *PEN_TOOLS)
_EDGE_ON = 0.2  # cosine of the angle between the handles' normal and the view, below which depth is no direction


def gestured(state: State, event: Gesture, modeller: Modeller) -> State:
    """The state after a gesture that refines the head, once it is named.

    Raises
    ------
    ValueError
        If there is nothing that it could do; the message says why.
    """
    if event.name is None:
        raise ValueError("a gesture is done by its name, and this one has none yet")
    refinement = behaviour(event.name)(Edit.of(event, state, modeller))
    if not isinstance(refinement, Refinement):
        raise ValueError(f"what {event.name!r} does must give a Refinement; it gave {refinement!r}")
    return state if refinement is state.refinement else replace(state, refinement=refinement)


def line(edit: Edit) -> Refinement:
    """The handles go along in the view plane; without any, the silhouette that is nearest goes where the line is."""
    if not len(edit.refinement.handles):
        return _silhouette_to(edit)
    handles = _seen_handles(edit)
    vector = edit.in_space(edit.points[-1] - edit.points[0])
    return edit.deformed(handles, np.tile(vector, (len(handles), 1)))


def region(edit: Edit) -> Refinement:
    """What of the visible surface lies inside becomes the region, with the eyes and teeth that it covers."""
    chosen = enclosed(edit.points, edit.face.vertices, edit.face.faces, edit.view, edit.modeller.soft)
    if not chosen.any():
        raise ValueError("the region contains nothing of the head's surface")
    for part in edit.modeller.attached:
        chosen[part.vertices] = chosen[part.leaders].mean() > 0.5
    return replace(edit.refinement, region=chosen)


def bulge(level: int, sign: int = 1) -> Behaviour:
    """The behaviour that moves the handles towards the viewer by `DEPTHS` of a level; away from them with sign -1."""

    def act(edit: Edit) -> Refinement:
        if not len(edit.refinement.handles):
            raise ValueError("a roll bulges or depresses what is marked: brush the handles first")
        handles = _seen_handles(edit)
        normal = edit.normals[handles].sum(axis=0)
        if normal @ edit.towards_viewer < _EDGE_ON * max(float(np.linalg.norm(normal)), 1e-9):
            raise ValueError("the handles are seen edge on in this view: turn the head, so that they face you")
        return edit.deformed(handles, np.tile(sign * DEPTHS[level - 1] * edit.towards_viewer, (len(handles), 1)))

    return act


def _seen_handles(edit: Edit) -> np.ndarray:
    """The handles that a stroke on the head moves: all, if some are seen; a nose moves with its far side."""
    if not edit.on_head:
        raise ValueError("this stroke is off the head: draw it over the face")
    handles = edit.handles
    if not len(handles):
        raise ValueError("all handles are outside the region: brush inside it, or draw another region")
    if not edit.seen(handles).any():
        raise ValueError("no handle is seen in this view: turn the head to them")
    return handles


def silhouette_beside(edit: Edit) -> Drag | None:
    """The part of a silhouette of the region that is nearest to a stroke; None if none is near."""
    faces, near = edit.modeller.soft_faces, edit.movable.copy()
    # A region of what was seen ends at a silhouette, of which it has a vertex here and there.
    near[faces[near[faces].any(axis=1)]] = True
    chains = silhouettes(edit.face.vertices, faces, edit.view.rotation, near)
    drag = nearest_silhouette(edit.points, chains, edit.canvas)
    return drag if drag is not None and drag.distance <= NEAR else None


def _silhouette_to(edit: Edit) -> Refinement:
    """Silhouette editing (Nealen et al. 2005)."""
    drag = silhouette_beside(edit)
    if drag is None:
        raise ValueError(
            "no handles are marked, and no silhouette is near this line: brush handles, or draw beside an outline"
        )
    vertices, first = np.unique(drag.vertices, return_index=True)
    vertices, first = vertices[edit.movable[vertices]], first[edit.movable[vertices]]
    # Where the region ends at a silhouette, this is to move nevertheless.
    outside = np.flatnonzero(edit.modeller.soft & ~edit.movable)
    return edit.deformed(vertices, edit.in_space(drag.displacement[first]), outside[edit.seen(outside)])


_BEHAVIOURS: dict[str, Behaviour] = {
    LINE: line,
    REGION: region,
    **{name: bulge(level) for name, level in zip(UP_ROLLS, LEVELS, strict=True)},
    **{name: bulge(level, -1) for name, level in zip(DOWN_ROLLS, LEVELS, strict=True)},
}
_RECOGNISERS: dict[str, Recogniser] = {}


def register_gesture(name: str, behaviour: Behaviour, recognise: Recogniser | None = None) -> None:
    """Add a gesture or a tool, or change what one does, in all sessions from now on.

    A session that is replayed needs what it was recorded with.

    Parameters
    ----------
    name : str
        One that is known already gets the new behaviour.
    behaviour : callable
        ``behaviour(edit) -> Refinement``; see `Edit`. A ValueError that it raises is told, and nothing is changed.
    recognise : callable, optional
        ``recognise(points) -> bool`` tells whether a stroke (n, 2) of canvas points, y down, is this gesture; it is
        asked before the classifier. Without one, the name is a tool: `Session.gesture(points, tool=name)`, and a button
        in the Studio from when the mode "refine" is entered next, or anything is done there.

    Raises
    ------
    ValueError
        If the name is that of an arrow, which undo and redo whatever was done, or of a tool of the Studio.
    TypeError
        If the behaviour or what recognises it cannot be called.

    Examples
    --------
    >>> def nod(edit):
    ...     return edit.displaced(np.tile([0.0, -2.0, 0.0], (len(edit.face.vertices), 1)))  # mm
    >>> sw.register_gesture("nod", nod)
    >>> session = sw.Session(inference=False)
    >>> before = session.face.landmarks
    >>> session.gesture([[0.4, 0.4], [0.5, 0.5], [0.6, 0.4]], tool="nod")
    'nod'
    >>> round(float((session.face.landmarks - before)[30, 1]), 3)
    -2.0
    """
    if not isinstance(name, str) or not name or name in _RESERVED:
        raise ValueError(f"a gesture has a name, which is none of {', '.join(_RESERVED)}; given {name!r}")
    for given in (behaviour, recognise):
        if given is not None and not callable(given):
            raise TypeError(f"a behaviour and what recognises it are functions; given {given!r}")
    _BEHAVIOURS[name] = behaviour
    _RECOGNISERS.pop(name, None)
    if recognise is not None:
        _RECOGNISERS[name] = recognise


def behaviour(name: str) -> Behaviour:
    """What a gesture or a tool does.

    Raises
    ------
    ValueError
        If there is none of that name.
    """
    if name not in _BEHAVIOURS:
        raise ValueError(f"a tool is one of {', '.join(_BEHAVIOURS)}, or registered first; given {name!r}")
    return _BEHAVIOURS[name]


def tools() -> tuple[str, ...]:
    """The names of the tools that users added: what they do is asked for by name, and no stroke is taken for them."""
    return tuple(name for name in _BEHAVIOURS if name not in GESTURES and name not in _RECOGNISERS)


def recognised(points: np.ndarray) -> str | None:
    """The name of the first gesture added by users that a stroke is."""
    for name, recognise in _RECOGNISERS.items():
        try:
            if bool(recognise(points)):
                return name
        except Exception as error:
            raise ValueError(f"what recognises {name!r} failed on this stroke: {error!r}") from error
    return None
