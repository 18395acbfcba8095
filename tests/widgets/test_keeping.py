"""Drawings that are kept without being asked."""

import os
import shutil
from pathlib import Path

import pytest

from sketchwidget.session import Session
from sketchwidget.widgets import Studio, keeping
from sketchwidget.widgets.keeping import Keeping

STROKE = [[0.3, 0.3], [0.6, 0.7]]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setattr(keeping, "folder", lambda: tmp_path / "state" / "sessions")
    return keeping.folder()


@pytest.fixture
def session():
    return Session(inference=False)


def other():
    return Session(inference=False)


def kept_events(path):
    return Session.load(path).events


def on_page(session):
    studio = Studio(session)
    studio._wake()
    return studio


def test_a_studio_on_a_page_keeps_every_change_from_the_first_on(folder, session):
    studio = on_page(session)
    assert Studio.kept() == [] and studio._connection.kept == ""
    session.draw(STROKE)
    (path,) = Studio.kept()
    assert studio._connection.kept == str(path) and kept_events(path) == session.events
    session.draw([[0.3, 0.4], [0.6, 0.8]])
    session.undo()
    assert Studio.kept() == [path] and kept_events(path) == session.events


def test_each_session_of_a_studio_has_a_file_of_its_own(folder, session):
    studio = on_page(session)
    session.draw(STROKE)
    former = session.events
    studio.session = other()
    studio.session.draw([[0.2, 0.2], [0.8, 0.2]])
    new, old = Studio.kept()
    assert kept_events(old) == former and kept_events(new) == studio.session.events


def test_a_session_that_saves_itself_is_left_alone(folder, session, tmp_path):
    session.autosave(tmp_path / "mine.jsonl")
    studio = on_page(session)
    session.draw(STROKE)
    assert Studio.kept() == [] and studio._connection.kept == str(tmp_path / "mine.jsonl")


def test_where_nothing_can_be_written_drawing_goes_on_and_nothing_is_claimed(folder, session):
    folder.parent.write_text("a file in the folder's place")
    studio = on_page(session)
    session.draw(STROKE)
    assert len(session.sketch) and studio._connection.kept == ""
    folder.parent.unlink()
    session.draw([[0.3, 0.4], [0.6, 0.8]])  # room again: the next change is kept, with all before
    assert kept_events(studio._connection.kept) == session.events


def test_what_was_kept_is_told_though_no_more_can_be_written(folder, session, monkeypatch):
    studio = on_page(session)
    session.draw(STROKE)
    path, events = studio._connection.kept, session.events
    with monkeypatch.context() as patch:
        patch.setattr(keeping.Autosave, "write", full)
        session.draw([[0.3, 0.4], [0.6, 0.8]])
        assert studio._connection.kept == path and kept_events(path) == events
    session.undo()
    assert studio._connection.kept == path and kept_events(path) == session.events
    # Somebody clears the folder away: the next change but one is in a new file.
    shutil.rmtree(folder)
    session.redo()
    assert studio._connection.kept == ""
    session.draw(STROKE)
    assert kept_events(studio._connection.kept) == session.events


def full(*_):
    raise OSError(28, "No space left on device")


def test_the_oldest_make_room(folder, monkeypatch):
    monkeypatch.setattr(keeping, "MOST", 3)
    paths = []
    for age in range(5):
        session = other()
        session.draw(STROKE)
        path = Path(Keeping().keep(session))
        os.utime(path, (1000 + age, 1000 + age))
        paths.append(path)
    assert keeping.files() == paths[:1:-1]


def test_what_a_script_does_is_its_own_until_a_page_shows_it(folder, session):
    studio = Studio(session)
    session.draw(STROKE)
    assert Studio.kept() == []
    studio._wake()
    assert kept_events(studio._connection.kept) == session.events
