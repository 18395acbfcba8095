"""The Studio: draw a face on the pad, and the head beside it follows."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING, Any

import traitlets
from ipywidgets import Box, VBox

from ..face import Face, FaceModel
from ..face.texture import Texture, TexturedFace
from ..session import Session
from ..session.events import MODES
from ..session.take_over import standing
from . import toolbar
from .caricaturing import Caricaturing
from .connection import Connection
from .drawing import Drawing
from .exaggerating import Exaggerating
from .files import Files
from .head_view import HeadView
from .ink import TOOLS
from .keeping import Keeping, files
from .keyboard import Keyboard
from .marking import Marking
from .portraying import Portraying
from .refine_pad import TOOLS as REFINING_TOOLS
from .refining import EXPECTED, Refining
from .status import Status
from .tab import Tab
from .welcome import Welcome

if TYPE_CHECKING:
    from ..avatar import Avatar

TABS = (*MODES, "caricature", "portrait")
VIEWS = ("front", "left", "right", "three-quarter")


class Studio(VBox):
    """A drawing pad and the 3D head that follows it.

    Parameters
    ----------
    session : Session, optional
        What is drawn and the face it gives; a new one if not given. Scripts may work on it too: the Studio shows what
        it becomes. Another session may be assigned to the trait at any time.

    Attributes
    ----------
    session : Session
        The session on show.
    marking : Marking
        The picture of the tabs that begin with one; scripts may open it, and place its landmarks.
    portrait : Puppet
        What moves the head of the tab *Portrait* on the page; scripts may drive it.

    Examples
    --------
    >>> studio = sw.Studio()  # shown at the end of a notebook's cell
    >>> studio.session.draw([[0.3, 0.4], [0.4, 0.38], [0.45, 0.4]])  # appears on the pad
    >>> len(studio.session.sketch)
    1
    """

    session = traitlets.Instance(Session)

    def __init__(self, session: Session | None = None) -> None:
        session = Session() if session is None else session
        if not isinstance(session, Session):
            raise TypeError(f"a Studio shows a Session; given {session!r}")
        # A session infers its first face when asked for it; the mean face needs no network, so the page has it at once.
        self._resting_face = session.face if session.trait_has_value("face") else FaceModel.load().face()
        self._head = HeadView(self._resting_face)
        self._status = Status()
        self._keeping, self._connection = Keeping(), Connection()
        self._shown: tuple[Any, ...] = (None,) * 7  # what of the session is on show
        self._tab: Tab | None = None  # the tab on show, if it is none of a mode of the session
        super().__init__()
        self.children = self._layout()
        self.add_class("sketchwidget-studio")
        self._head.widget.on_ready(self._wake)
        self._waking = Thread(target=_wake, args=[session], daemon=True)
        self.session = session

    def __repr__(self) -> str:
        return f"Studio({self.session!r})"

    def _repr_mimebundle_(self, **kwargs: Any) -> Any:
        """What a notebook shows; where it was saved and is opened without its kernel, how to see more."""
        shown = super()._repr_mimebundle_(**kwargs)
        return shown and {**shown, "text/plain": "The Studio appears here once this cell is run (Shift+Enter)."}

    @staticmethod
    def kept() -> list[Path]:
        """What was drawn in Studios on a page of late, the newest first: files for `Session.load`."""
        return files()

    # -- building ------------------------------------------------------------------------------------------------------

    def _layout(self) -> list[Any]:
        self._mode = toolbar.choice(*TABS)
        self._undo, self._redo, self._clear = (toolbar.button(name) for name in ("undo", "redo", "clear"))
        template = toolbar.button("template")
        views = [toolbar.button(name) for name in VIEWS]
        self._files = Files(lambda: self.session, self._set_session, lambda: self._exported, self._status)
        self._welcome = Welcome(self._on_example)
        inked = (lambda: self.session, lambda: self._drawn, self._head, self._show_head, lambda: self._expected)
        self._drawing = Drawing(*inked, self._status)
        self._refining = Refining(lambda: self.session, self._head, self._status)
        self._exaggerating = Exaggerating(self._on_exaggerate)
        self.marking = Marking(self._status)
        shared = (self.marking, self._head, self._status, lambda: self._drawn.model, self._show_tab, self._take_over)
        portraying = Portraying(*shared)
        self.portrait = portraying.puppet
        self._tabs: dict[str, Tab] = {"caricature": Caricaturing(*shared), "portrait": portraying}

        self._undo.on_click(lambda _: self._on_undo())
        self._redo.on_click(lambda _: self._on_redo())
        self._clear.on_click(lambda _: self._on_clear())
        template.on_click(lambda _: self._on_template())
        self._mode.observe(self._on_mode, "value")
        for name, button in zip(VIEWS, views, strict=True):
            button.on_click(lambda _, name=name: self._on_view(name))

        saving, exports = self._files.groups
        title = Box([toolbar.bar((self._mode,)), toolbar.bar((template, *saving), exports)])
        title.add_class("sketchwidget-title")
        drawing = self._drawing
        edits = toolbar.bar((self._undo, self._redo, self._clear))
        pads = [drawing.pad.widget.add_class(at("drawing")), self.marking.pad.add_class(at("picture"))]
        pad_bars = [drawing.tools.add_class(at("drawing")), self.marking.bar.add_class(at("picture"))]
        pad_bars += [edits, drawing.more.add_class(at("drawing"))]
        left = VBox([_row(*pad_bars), *pads, self._welcome.add_class(at("drawing"))]).add_class("sketchwidget-panel")
        head_bars = [toolbar.bar(tuple(views)).add_class("sketchwidget-views"), self._refining.bar]
        head_bars += [tab.bar.add_class(at(name)) for name, tab in self._tabs.items()]
        below = [self._exaggerating.bar, portraying.panel.add_class(at("portrait")), self._refining.chart]
        right = VBox([_row(*head_bars), self._head.widget, *below]).add_class("sketchwidget-panel")
        desk = Box([left, right]).add_class("sketchwidget-desk")
        keyboard = Keyboard(bindings=toolbar.bindings(TOOLS, TABS, REFINING_TOOLS))
        return [title, desk, self._status, self._connection, self._files.downloads, keyboard, self._refining.pad]

    # -- the session, shown --------------------------------------------------------------------------------------------

    @traitlets.observe("session")
    def _on_session(self, change: dict[str, Any]) -> None:
        if isinstance(change["old"], Session):
            change["old"].unobserve(self._on_change)
        self.session.observe(self._on_change)
        self._open(None)
        self._show_all()
        self._status.say(self._expected)

    def _on_change(self, change: dict[str, Any]) -> None:
        # There is one call a trait, but the session sets all of them before it tells of any: the first shows the whole.
        session = self.session
        state = (session.sketch, self._drawn, session.frame, session.timings, session.gap)
        state += (session.mode, session.refinement)
        if any(new is not old for new, old in zip(state, self._shown, strict=True)):
            self._shown = state
            with self._status.reporting("The Studio could not show the change"):
                self._show_all()
                self._status.say(self._expected)  # what the user did says more after that, a script does not
            self._keep()

    def _show_all(self) -> None:
        session = self.session
        self._show_head()
        self._drawing.show()
        self._refining.show(hidden=self._tab is not None)
        loaded = self._tab is None and self._files.just_loaded
        toolbar.set_useful(self._undo, self._edited.can_undo or loaded)
        self._welcome.show(not len(session.sketch) and session.mode == "initial")
        toolbar.set_useful(self._redo, self._edited.can_redo)
        marked = len(session.handles) or session.refinement.region is not None
        there = bool(marked if session.mode == "refine" else len(session.sketch))
        toolbar.set_useful(self._clear, there if self._tab is None else self.marking.present.picture is not None)
        name = session.mode if self._tab is None else self._tab.name
        self._mode.value = name if name in TABS else None
        self._exaggerating.show(session.exaggeration if self._tab is None else self._tab.amount)
        self._status.show_figures(name, session.timings if self._tab is None else self._tab.timings)

    def _show_head(self, passing: bool = False) -> None:
        face = self._face
        self._head.dress(self._skin)
        self._head.show(face, self.session.frame if face is self._drawn else standing(face), passing)

    def _show_tab(self, passing: bool) -> None:
        """Show what has become of a tab's head."""
        if passing:
            self._show_head(passing)
        else:
            self._show_all()

    @property
    def _expected(self) -> str:
        if self._tab is not None:
            return self._tab.expected
        if self.session.mode == "refine":
            return EXPECTED
        return self._drawing.expected

    @property
    def _face(self) -> Face:
        """The head on show: the tab's own, if it has one."""
        return self._drawn if self._tab is None or self._tab.face is None else self._tab.face

    @property
    def _skin(self) -> Texture | None:
        """The texture of the head on show: the tab's, or of a head that was taken over and edited since."""
        if self._face is not self._drawn:
            return None if self._tab is None else self._tab.skin
        return self.session.texture

    @property
    def _exported(self) -> Face | TexturedFace | Avatar:
        """What is exported."""
        own = None if self._tab is None else self._tab.exported
        if own is not None:
            return own
        return self._face if self._skin is None else TexturedFace(self._face, self._skin)

    @property
    def _edited(self) -> Session | Marking:
        """What is undone and cleared."""
        return self.session if self._tab is None else self.marking

    @property
    def _drawn(self) -> Face:
        return self.session.face if self.session.trait_has_value("face") else self._resting_face

    def _wake(self) -> None:
        """Load the network while the user looks at the page: the first stroke would wait some seconds for it."""
        if not self._waking.ident:
            self._waking.start()
        self._keep()

    def _keep(self) -> None:
        """Keep what was drawn, once somebody sees it: a script saves what it wants to."""
        if self._waking.ident:
            self._connection.kept = self._keeping.keep(self.session)

    # -- what the user does --------------------------------------------------------------------------------------------

    def _on_undo(self) -> None:
        with self._status.reporting("Nothing could be undone"):
            if self._tab is not None or not self._files.undo_loading():
                happened = "Undone." if self._edited.undo() else "Nothing to undo."
                self._status.say(happened, self._expected)

    def _on_redo(self) -> None:
        with self._status.reporting("Nothing could be redone"):
            happened = "Redone." if self._edited.redo() else "Nothing to redo."
            self._status.say(happened, self._expected)

    def _on_clear(self) -> None:
        with self._status.reporting("The drawing could not be cleared"):
            self._edited.clear()
            marks = self._tab is not None or self.session.mode == "refine"
            self._status.say(f"Cleared; undo brings the {'marks' if marks else 'drawing'} back.", self._expected)

    def _on_template(self) -> None:
        with self._status.reporting("The template could not be drawn"):
            self._open(None)
            self.session.start_from_template()
            self._show_all()
            self._status.say("These are the lines of the template; undo brings the drawing back.", self._expected)

    def _on_mode(self, change: dict[str, Any]) -> None:
        name = change["new"]
        if name in (None, self.session.mode if self._tab is None else self._tab.name):
            return
        with self._status.reporting("The mode could not be changed"):
            self._open(self._tabs.get(name))
            if self._tab is None:
                self.session.mode = name
            self._status.say(self._expected)
        self._show_all()

    def _open(self, tab: Tab | None) -> None:
        """Show a tab, or with None the one of the session's mode."""
        if self._tab is not None:
            self._tab.leave()
            self._head.look("front")
            self._drawing.turn("front")
        self._tab, name = tab, None if tab is None else tab.name
        shown = {"drawing": tab is None, "picture": tab is not None, **{other: other == name for other in self._tabs}}
        for place, on in shown.items():
            (self.add_class if on else self.remove_class)(f"sketchwidget-at-{place}")
        if tab is not None:
            tab.enter()

    def _take_over(self, face: Face, skin: Texture | None = None) -> None:
        with self._status.reporting("The head could not be taken over"):
            self.session.take_over(face, skin)
            self._open(None)
            self._show_all()
            self._status.say("The head is taken over; undo brings the drawing back.", self._expected)

    def _on_exaggerate(self, amount: float) -> None:
        with self._status.reporting("The head could not be exaggerated"):
            if self._tab is not None:
                self._tab.exaggerate(amount)
                return
            if self._drawn is self._resting_face or not len(self.session.sketch):
                self._status.say("The mean face has nothing to exaggerate: draw first.")
            else:
                self.session.exaggerate(amount)
                happened = f"Exaggerated by a factor of {amount:.2f}; undo brings the head back."
                self._status.say("The head is as it was." if amount == 1.0 else happened, self._expected)
        self._exaggerating.show(self.session.exaggeration)

    def _on_example(self, name: str, text: str) -> None:
        if not self.session.awake:
            self._status.say("The network is waking up; the head follows in a moment.")
        self._files.load(name, text.encode(), lambda: self._expected)

    def _set_session(self, session: Session) -> None:
        self.session = session

    def _on_view(self, name: str) -> None:
        self._head.look(name)
        if self._tab is None and self._drawing.turn(name):
            self._status.say(self._expected)


def _wake(session: Session) -> None:
    # What fails here fails again, and is told, when it is needed.
    with suppress(Exception):
        session.prepare()


def _row(*bars: Any) -> Box:
    return Box(bars).add_class("sketchwidget-bars")


def at(place: str) -> str:
    """The class of what is on show at a place only: "drawing", "picture", or a tab of its own."""
    return f"sketchwidget-in-{place}"
