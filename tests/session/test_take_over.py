"""Heads from elsewhere in a session, on the shipped model; what is inferred is the mean face, older by each wrinkle."""

import json
from types import SimpleNamespace

import numpy as np
import pytest
from folds import turned_over
from scipy.spatial import KDTree

import sketchwidget as sw
from sketchwidget.face.handles import LINES
from sketchwidget.geometry import View
from sketchwidget.session import Session, SessionFileError
from sketchwidget.session.apply import apply
from sketchwidget.session.events import Erase, Exaggerate, TakeOver
from sketchwidget.session.modeller import Modeller
from sketchwidget.session.state import State
from sketchwidget.session.take_over import standing
from sketchwidget.sketch import resample

WRINKLE = [[0.4, 0.25], [0.5, 0.24], [0.6, 0.25]]
STROKE = [[0.3, 0.6], [0.5, 0.8], [0.7, 0.6]]
LINE = np.array([[0.4 + 0.002 * t, 0.5] for t in range(40)])


class WrinkleCounter:
    """Infers a head of another size and place, wider by a step for each wrinkle."""

    def __init__(self, model):
        self.model = model

    def infer(self, sketch):
        names = tuple("wrinkle" if segment.name == "unnamed" else segment.name for segment in sketch.segments)
        count = names.count("wrinkle")
        face = sw.Face(self.model, self.model.mean * np.float32([1 + 0.05 * count, 1, 1]))
        frame = View(scale=1 / 300, centre=np.array([0.4, 0.6]))
        return SimpleNamespace(face=face, frame=frame, names=names, timings={})


@pytest.fixture(scope="module")
def someone(model):
    """An exaggerated head, of which the pad holds all."""
    return sw.caricature.exaggerate(model.face(model.bilinear.identities[4 * 16], "grin_open"), 1.6)


@pytest.fixture(scope="module")
def regressor(model):
    return WrinkleCounter(model)


@pytest.fixture(params=[True, False], ids=["inferred", "not inferred"])
def session(regressor, request):
    return Session(regressor, inference=request.param)


def snapshot(session):
    return session.face.vertices.tobytes(), session.sketch, session.mode, session.frame.scale


def away(one, other):
    return float(np.linalg.norm(one.vertices - other.vertices, axis=1).max())


def raise_brow(session):
    piece = session.sketch.lines["left_brow"][0]
    assert session.erase(piece[len(piece) // 2], radius=0.005)
    session.draw(piece - [0, 0.03])


def test_the_head_is_exactly_the_one_taken_over_and_its_lines_lie_on_it(session, someone):
    session.take_over(someone)
    assert session.mode == "followup" and set(session.sketch.lines) == set(LINES)
    assert away(session.face, someone) < 0.01
    for name in LINES:
        ink = np.concatenate([resample(points, 500) for points in session.sketch.lines[name]])
        strays = KDTree(ink).query(session.frame.project(session.face.curve(name)))[0]
        assert strays.max() * 250 < 2.5


@pytest.mark.parametrize("amount", [1.0, 2.0, 3.0])
def test_a_brow_of_an_exaggerated_head_rises_without_folds(session, someone, model, amount):
    session.take_over(someone)
    if amount != 1.0:
        session.exaggerate(amount)
    before = session.face.vertices
    raise_brow(session)
    assert turned_over(model, before, session.face.vertices) == 0
    assert np.abs(session.face.vertices - before).max() < 12


def test_parameters_and_residual_are_apart(session, someone, model):
    session.take_over(someone)
    assert away(session.layers.parameters, model.face()) == 0
    assert away(session.layers.residual.on(session.layers.parameters), someone) < 0.01


def test_the_first_edit_moves_what_was_edited_and_nothing_jumps(session, someone, model):
    session.take_over(someone)
    taken = session.face
    raise_brow(session)
    moved = np.linalg.norm(session.face.vertices - taken.vertices, axis=1)
    assert moved[model.curves["left_brow"]].max() > 5
    low = taken.vertices[:, 1] < taken.landmarks[33, 1]
    assert moved[low].max() < 0.1


def test_a_wrinkle_changes_the_parameters_and_the_residual_stays(regressor, someone):
    session = Session(regressor)
    session.take_over(someone)
    residual = session.layers.residual
    session.draw(WRINKLE)
    assert session.layers.residual is residual
    widened = np.ptp(session.layers.parameters.vertices[:, 0]) / np.ptp(regressor.model.mean[:, 0])
    assert widened == pytest.approx(1.05, rel=1e-4)


def test_without_inference_a_wrinkle_moves_nothing(regressor, someone):
    session = Session(regressor, inference=False)
    session.take_over(someone)
    session.draw(WRINKLE)
    assert away(session.face, someone) < 0.02


def test_undo_and_redo_are_exact(session, someone, model):
    session.take_over(someone)
    moments = [snapshot(session)]
    steps = (
        lambda: raise_brow(session),
        lambda: session.exaggerate(1.4),
        lambda: session.brush(model.landmarks[27:31]),
        lambda: session.gesture(LINE),
        lambda: session.exaggerate(0.4),
    )
    for step in steps:
        step()
        moments.append(snapshot(session))
    seen = [moments.pop()]
    while session.can_undo and seen[-1] != moments[0]:
        session.undo()
        seen.append(snapshot(session))
    assert seen[0] != seen[1] and all(moment in seen for moment in moments)
    back = []
    while session.redo():
        back.append(snapshot(session))
    assert back == seen[-2::-1]


def test_a_saved_session_replays_bit_for_bit(session, someone, tmp_path):
    session.take_over(someone)
    raise_brow(session)
    session.exaggerate(1.3)
    session.brush(session.layers.parameters.model.landmarks[27:31])
    session.gesture(LINE, tool="line")
    session.save(tmp_path / "head.jsonl")
    again = Session.load(tmp_path / "head.jsonl", session.regressor, session.inference)
    assert snapshot(again) == snapshot(session) and again.events == session.events
    assert again.layers.refinement is not None


def test_initial_drawing_goes_on_from_the_head_and_clearing_drops_it(session, someone, regressor):
    session.take_over(someone)
    session.mode = "initial"
    assert away(session.face, someone) < 0.01
    session.draw(WRINKLE)
    assert session.layers.residual is not None
    session.clear()
    assert session.layers.residual is None and away(session.face, regressor.model.face()) == 0


def test_the_template_takes_the_place_of_a_head(session, someone, regressor):
    session.take_over(someone)
    session.start_from_template()
    assert away(session.face, regressor.model.face()) == 0
    session.take_over(regressor.model.face())
    session.start_from_template()
    assert session.layers.residual is None


def test_clearing_the_edits_brings_the_head_back(session, someone):
    session.take_over(someone)
    raise_brow(session)
    session.clear()
    assert away(session.face, someone) < 0.01


def test_a_head_larger_than_the_pad_stands_further_away(session, someone, model):
    large = sw.Face(model, 1.7 * someone.vertices + np.float32([30, 50, 0]))
    session.take_over(large)
    points = np.concatenate([segment.points for segment in session.sketch.segments])
    assert points.min() > 0 and points.max() < 1
    assert away(session.face, large) < 0.01
    raise_brow(session)
    low = large.vertices[:, 1] < large.landmarks[33, 1]
    assert np.linalg.norm(session.face.vertices - large.vertices, axis=1)[low].max() < 0.2
    assert standing(model.face()).scale == View().scale


@pytest.mark.parametrize("given", [None, "no head", np.zeros((4, 3)), np.full((4, 3), np.nan), np.zeros(3)])
def test_what_is_no_head_of_the_model_changes_nothing(session, given):
    before, events = snapshot(session), session.events
    with pytest.raises(ValueError):
        session.take_over(given)
    assert snapshot(session) == before and session.events == events


def test_a_head_without_extent_is_refused(session, someone):
    with pytest.raises(ValueError, match="at least 20 mm in each direction"):
        session.take_over(someone.vertices * [1, 1, 0.01])
    assert not any(isinstance(event, TakeOver) for event in session.events)


def test_a_file_with_another_model_s_head_says_where(session):
    session.take_over(session.face)
    header, *lines = session.dumps().splitlines()
    lines[-1] = json.dumps(TakeOver(np.eye(3)).to_json())
    with pytest.raises(SessionFileError, match=r"line \d of the session cannot be replayed: a face of this model"):
        session.another("\n".join([header, *lines]))


# -- exaggeration ------------------------------------------------------------------------------------------------------


def test_the_head_on_show_is_exaggerated_with_all_its_layers(session, someone, model):
    session.take_over(someone)
    session.brush(model.landmarks[27:31])
    session.gesture(LINE)
    shown, handles = session.face, session.handles
    assert session.exaggerate(1.5) and session.exaggeration == 1.5 and session.mode == "refine"
    assert away(session.face, sw.caricature.exaggerate(shown, 1.5)) < 0.01
    np.testing.assert_array_equal(session.handles, handles)


def test_the_slider_is_one_step_and_starts_from_the_same_head(session, someone):
    session.take_over(someone)
    before = snapshot(session)
    for amount in (1.2, 2.0, 0.3, 1.5):
        session.exaggerate(amount)
    once = Session.loads(session.dumps(), session.regressor, session.inference)
    assert [event.to_json() for event in session.events if event.to_json()["event"] == "exaggerate"] == [
        {"event": "exaggerate", "amount": 1.5}
    ]
    assert snapshot(once) == snapshot(session)
    session.undo()
    assert snapshot(session) == before and session.exaggeration == 1.0


def test_back_at_one_all_is_as_it_was(session):
    session.mode = "initial"
    session.draw(STROKE)
    before = snapshot(session)
    assert session.exaggerate(2) and session.mode == "followup"
    assert session.exaggerate(1) and snapshot(session) == before
    assert not session.exaggerate(1)
    again = Session.loads(session.dumps(), session.regressor, session.inference)
    assert snapshot(again) == before
    session.undo()
    assert not any(len(points) for points in session.sketch.lines.get("unnamed", []))


def test_what_is_done_after_it_starts_from_one(session, someone):
    session.take_over(someone)
    session.exaggerate(1.5)
    raise_brow(session)
    edited = session.face
    assert session.exaggeration == 1.0
    session.exaggerate(1.5)
    assert away(session.face, sw.caricature.exaggerate(edited, 1.5)) < 0.01
    session.exaggerate(1)
    assert away(session.face, edited) == 0


def test_exaggerating_and_back_keeps_what_can_be_redone(session, someone):
    session.take_over(someone)
    session.draw([(0.4, 0.2), (0.6, 0.2)])
    session.draw([(0.4, 0.25), (0.6, 0.25)])
    drawn = snapshot(session)
    session.undo()
    session.exaggerate(1.5)
    assert not session.can_redo
    session.exaggerate(1)
    assert session.can_redo and session.redo() and snapshot(session) == drawn
    assert snapshot(sw.Session.loads(session.dumps(), session.regressor)) == drawn
    # What was undone elsewhere does not come back here: the first stroke is taken away as well.
    session.undo()
    session.undo()
    session.exaggerate(1.5)
    session.draw([(0.4, 0.2), (0.6, 0.2)])
    session.draw([(0.4, 0.25), (0.6, 0.25)])
    session.undo()
    session.exaggerate(2)
    session.undo()
    session.undo()
    session.exaggerate(1)
    assert not session.can_redo and session.exaggeration == 1


def test_an_erased_line_is_back_before_the_head_is_exaggerated(session, someone):
    session.take_over(someone)
    shown, piece = session.face, session.sketch.lines["nose"][0]
    session.erase(piece[len(piece) // 2], radius=0.005)
    session.exaggerate(2)
    assert session.gap is None and away(session.face, sw.caricature.exaggerate(shown, 2)) < 0.01
    session.exaggerate(1)
    assert session.gap is not None  # it is as it was


def test_exaggerating_by_one_gives_the_very_state_from_before(model):
    modeller = Modeller(None, inference=False)
    head = apply(State(), TakeOver(model.face(model.bilinear.identities[3]).vertices), modeller)
    piece = head.sketch.lines["nose"][0]
    erased = apply(head, Erase(piece[len(piece) // 2 :][:1], 0.005), modeller)
    bold = apply(apply(erased, Exaggerate(2), modeller), Exaggerate(1.5), modeller)
    assert erased.followup.gap is not None and apply(bold, Exaggerate(1), modeller) is erased


@pytest.mark.parametrize("amount", [-0.1, 3.1, np.nan, "more", None])
def test_other_amounts_change_nothing(session, amount):
    before = snapshot(session)
    with pytest.raises(ValueError, match="a number from 0 to 3"):
        session.exaggerate(amount)
    assert snapshot(session) == before


@pytest.mark.parametrize(
    "leaving", [lambda session: session.cancel(), lambda session: setattr(session, "mode", "refine")]
)
def test_what_was_cancelled_after_an_exaggeration_is_no_part_of_it(model, leaving):
    session = Session(inference=False)
    session.take_over(model.face(model.bilinear.identities[3]))
    session.exaggerate(1.5)
    brow = session.sketch.lines["left_brow"][0]
    session.erase(brow[len(brow) // 2])
    leaving(session)
    left, mode = session.face.vertices, session.mode
    session.exaggerate(2.0)
    bold = session.face.vertices
    session.undo()
    np.testing.assert_array_equal(session.face.vertices, left)
    assert session.gap is None and session.mode == mode
    session.redo()
    np.testing.assert_array_equal(session.face.vertices, bold)


def test_a_head_is_not_exaggerated_without_end(model):
    session = Session(inference=False)
    session.take_over(model.face(model.bilinear.identities[3]))
    with pytest.raises(ValueError, match="mm of its origin"):
        for number in range(20):
            session.exaggerate(3.0)
            session.draw([[0.45, 0.2 + 0.001 * number], [0.55, 0.2 + 0.001 * number]])
    assert np.isfinite(session.face.vertices).all()
