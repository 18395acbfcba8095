"""Gesture-based refinement in a plain script."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from refining import about, drawn, stroke

from sketchwidget import GESTURES, Face, FaceModel, View, register_gesture
from sketchwidget.geometry import rotation_about_y
from sketchwidget.geometry.visibility import covering
from sketchwidget.session import Brush, Gesture, Session, SessionFileError, behaviours
from sketchwidget.sketch import Sketch

NOSE, CHIN, CORNER = 30, 8, 54
FRONT = View()


class Broadening:
    """Infers the mean face, broader once the drawing has two strokes."""

    BROADER = np.float32([1.2, 1.0, 1.0])

    def __init__(self):
        self.model, self.asked = FaceModel.load(), 0

    def infer(self, sketch: Sketch):
        self.asked += 1
        face = Face(self.model, self.model.mean * (self.BROADER if len(sketch) > 1 else 1))
        return SimpleNamespace(face=face, names=("unnamed",) * len(sketch), frame=View(), timings={})


REGRESSOR = Broadening()


@pytest.fixture
def session():
    return Session(REGRESSOR)


def place(session, landmark, view=FRONT):
    return view.project(session.face.landmarks[landmark])


def moved(session, before):
    return np.linalg.norm(session.face.vertices - before.vertices, axis=1)


# -- handles and region ------------------------------------------------------------------------------------------------


def test_brushing_marks_and_unmarks(session):
    assert session.brush([5, 3, 3])
    assert session.mode == "refine" and session.handles.tolist() == [3, 5]
    assert not session.brush([3])
    assert session.brush([3, 9], erase=True)
    assert session.handles.tolist() == [5]
    assert session.events == (Brush([3, 5]), Brush([3, 9], erase=True))
    session.undo()
    assert session.handles.tolist() == [3, 5]


def test_eyes_and_teeth_are_not_marked(session):
    hard = np.flatnonzero(session.face.model.template.fine_parts > 1)
    session.brush([5, hard[0]])
    assert session.handles.tolist() == [5]
    with pytest.raises(ValueError, match="go along with the skin"):
        session.brush(hard)


@pytest.mark.parametrize("vertices", [[-1], [10**6], [0.5], ["nose"], [[1, 2]], [[1], [2, 3]]])
def test_what_is_no_vertex_of_the_head_is_an_error(session, vertices):
    with pytest.raises(ValueError, match="given"):
        session.brush(vertices)
    assert session.events == () and session.mode == "initial"


def test_a_region_is_what_of_the_surface_lies_inside(session):
    assert len(session.region) == len(session.face.vertices)
    assert session.gesture(drawn("region", place(session, NOSE), 0.2)) == "region"
    region, canvas = session.region, FRONT.project(session.face.vertices)
    assert (np.abs(canvas[region] - place(session, NOSE)).max(axis=1) <= 0.1 + 1e-6).all()
    assert session.face.model.landmarks[NOSE] in region
    soft = session.face.model.template.fine_parts[region] <= 1
    assert (session.face.vertices[region[soft], 2] > 0).all()  # nothing of the back of the head


def test_clear_takes_the_marks_and_leaves_the_head(session):
    session.brush(about(session.face, NOSE, 6))
    session.gesture(drawn("up roll 1", place(session, NOSE)))
    refined = session.face
    session.gesture(drawn("region", place(session, NOSE), 0.2))
    assert session.clear()
    assert not len(session.handles) and len(session.region) == len(refined.vertices)
    np.testing.assert_array_equal(session.face.vertices, refined.vertices)
    assert not session.clear()


# -- deformation -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("level", [1, 2, 3])
def test_rolls_bulge_and_depress_the_handles_along_the_view(session, level):
    before, handles = session.face, about(session.face, NOSE, 6)
    session.brush(handles)
    assert session.gesture(drawn(f"up roll {level}", place(session, NOSE))) == f"up roll {level}"
    change = session.face.vertices - before.vertices
    np.testing.assert_allclose(change[handles], np.tile([0, 0, 4.0 * level], (len(handles), 1)), atol=1e-3)
    assert session.gesture(drawn(f"down roll {level}", place(session, NOSE))) == f"down roll {level}"
    np.testing.assert_allclose(session.face.vertices, before.vertices, atol=1e-3)


def test_the_depths_are_those_that_are_set_when_a_roll_is_drawn(session, monkeypatch):
    monkeypatch.setattr(behaviours, "DEPTHS", (1.0, 2.0, 30.0))
    before, handles = session.face, about(session.face, NOSE, 6)
    session.brush(handles)
    session.gesture(drawn("down roll 3", place(session, NOSE)))
    np.testing.assert_allclose((session.face.vertices - before.vertices)[handles, 2], -30.0, atol=1e-3)


def test_bulging_follows_the_view(session):
    view = View(rotation_about_y(-40))
    before, handles = session.face, about(session.face, NOSE, 6)
    session.brush(handles)
    session.gesture(drawn("up roll 2", place(session, NOSE, view)), view)
    change = (session.face.vertices - before.vertices)[handles]
    np.testing.assert_allclose(change, np.tile(8.0 * view.rotation[2], (len(handles), 1)), atol=1e-3)


def test_a_line_moves_the_handles_by_its_vector_and_nothing_outside_the_region(session):
    before = session.face
    chin = place(session, CHIN)
    session.gesture(drawn("region", chin - np.array([0, 0.03]), 0.3))
    handles = np.intersect1d(about(before, CHIN, 8), session.region)
    session.brush(handles)
    session.gesture(stroke(chin, chin + np.array([0.02, 0.04])))
    change = session.face.vertices - before.vertices
    np.testing.assert_allclose(change[handles], np.tile([5.0, -10.0, 0], (len(handles), 1)), atol=1e-3)
    outside = np.setdiff1d(np.arange(len(change)), session.region)
    assert (change[outside] == 0).all()


def test_handles_up_to_the_border_of_the_region_and_over_it_make_no_step(session):
    before = session.face
    session.gesture(drawn("region", place(session, 31), 0.2))
    session.brush(about(before, NOSE, 25))  # over the border of the region
    session.gesture(drawn("up roll 3", place(session, NOSE)))
    change = session.face.vertices - before.vertices
    soft = before.model.template.fine_parts <= 1
    outside = np.setdiff1d(np.flatnonzero(soft), session.region)
    assert len(np.intersect1d(outside, session.handles)) > 50
    assert np.abs(change[:, 2]).max() > 10 and (change[outside] == 0).all()
    edges = before.mesh.edges_unique
    length = np.linalg.norm(before.vertices[edges[:, 0]] - before.vertices[edges[:, 1]], axis=1)
    step = np.linalg.norm(change[edges[:, 0]] - change[edges[:, 1]], axis=1)
    at_border = np.isin(edges, outside).sum(axis=1) == 1
    # Nowhere does the surface rise by more than an edge is long; without fading it is 24 times that.
    assert (step[at_border] < np.maximum(length[at_border], 0.5)).all()


def test_handles_on_the_far_side_move_as_well(session):
    left = View.preset("left")
    before, handles = session.face, about(session.face, NOSE, 8)
    seen = before.vertices[handles, 0] > 1
    session.brush(handles)
    nose = place(session, NOSE, left)
    session.gesture(stroke(nose, nose - np.array([0.02, 0])), left)
    assert seen.any() and not seen.all()
    change = session.face.vertices - before.vertices
    np.testing.assert_allclose(change[handles], np.tile([0, 0, 5.0], (len(handles), 1)), atol=1e-3)


def test_an_eye_goes_along_with_the_skin_about_it(session):
    before = session.face
    eye = before.landmarks[36:42].mean(axis=0)
    session.gesture(drawn("region", FRONT.project(eye), 0.22))
    handles = np.intersect1d(about(before, 36, 6), session.region)
    session.brush(np.concatenate([handles, np.intersect1d(about(before, 39, 6), session.region)]))
    session.gesture(stroke([0.5, 0.3], [0.5, 0.32]))
    change = session.face.vertices - before.vertices
    ball = before.model.template.fine_parts == 2
    right = ball & (before.vertices[:, 0] < 0)
    np.testing.assert_allclose(change[right], np.tile([0, -5.0, 0], (right.sum(), 1)), atol=0.5)
    assert (change[ball & ~right] == 0).all()


def through_the_skin(face):
    """How many vertices of eyes, teeth and tongue are before the skin that they were behind, seen from the front."""
    parts = face.model.template.fine_parts
    hard, skin = np.flatnonzero(parts > 1), face.faces[(parts[face.faces] == 0).all(axis=1)]
    point, above = covering(face.vertices[hard], face.vertices, skin)
    outermost = np.full(len(hard), -np.inf)
    np.maximum.at(outermost, point, np.where(above > -12, above, -np.inf))  # what is deeper is the back of the head
    return int((np.isfinite(outermost) & (outermost < 0)).sum())


@pytest.mark.parametrize(
    ("marked", "radius", "name", "view"),
    [
        (range(17, 27), 8, "up roll 3", "front"),  # brows
        (range(17, 27), 8, "down roll 3", "front"),
        ([51], 5, "down roll 3", "front"),  # the upper lip
        ([CORNER], 14, "down roll 3", "three-quarter"),  # of the mouth
    ],
)
def test_no_eye_and_no_teeth_come_through_the_skin(session, marked, radius, name, view):
    assert through_the_skin(session.face) == 0
    session.brush(np.concatenate([about(session.face, landmark, radius) for landmark in marked]))
    for _ in range(2):
        session.gesture(drawn(name, place(session, marked[0], View.preset(view))), view)
        assert through_the_skin(session.face) == 0


def test_a_line_in_a_side_view_moves_in_its_plane(session):
    left = View.preset("left")
    before, handles = session.face, about(session.face, NOSE, 6)
    session.brush(handles)
    nose = place(session, NOSE, left)
    session.gesture(stroke(nose, nose - np.array([0.04, 0])), "left")  # to the left of the picture: forwards
    change = (session.face.vertices - before.vertices)[handles]
    np.testing.assert_allclose(change, np.tile([0, 0, 10.0], (len(handles), 1)), atol=1e-3)


def test_a_line_without_handles_drags_the_silhouette_onto_it(session):
    left = View.preset("left")
    before = session.face
    root, tip = place(session, 27, left), place(session, NOSE, left)
    wanted = stroke(root - [0.02, 0], tip - [0.04, 0])
    session.gesture(wanted, left)
    seen = left.project(session.face.vertices)
    skin = before.model.template.fine_parts == 0
    for point in wanted[4:-1]:  # the profile has come to the line
        level = skin & (np.abs(seen[:, 1] - point[1]) < 0.006)
        assert abs(seen[level, 0].min() - point[0]) < 0.012
    far = np.linalg.norm(before.vertices - before.landmarks[NOSE], axis=1) > 90
    assert moved(session, before)[far & (before.model.template.fine_parts <= 1)].max() == 0


def bow(start, end, sag):
    """A stroke whose middle is off the straight way by `sag` of its length, to its right on the canvas."""
    t = np.linspace(0, 1, 40)[:, None]
    along = np.asarray(end) - start
    return start + t * along + 4 * sag * t * (1 - t) * np.array([-along[1], along[0]])


@pytest.mark.parametrize("sag", [0.1, 0.2, 0.3, 0.4])
@pytest.mark.parametrize("backwards", [False, True])
def test_a_cheek_is_dragged_onto_a_round_stroke(session, sag, backwards):
    wanted = bow(place(session, 2) - [0.01, 0], place(session, 6) - [0.01, 0], sag)
    assert session.gesture(wanted[::-1] if backwards else wanted) == "line"
    skin = session.face.vertices[session.face.model.template.fine_parts == 0]
    seen = FRONT.project(skin)
    for point in wanted[8:-8]:
        assert np.linalg.norm(seen - point, axis=1).min() < 0.02
    fullest = wanted[20]
    level = np.abs(seen[:, 1] - fullest[1]) < 0.01
    assert abs(seen[level, 0].min() - fullest[0]) < 0.015


def test_a_round_stroke_is_a_line_beside_an_outline_and_without_handles_only(session):
    cheek = bow(place(session, 2) - [0.01, 0], place(session, 6) - [0.01, 0], 0.35)
    for elsewhere in (cheek + np.array([0.28, -0.1]), 0.5 + (cheek - cheek[0])[:, ::-1]):
        with pytest.raises(ValueError, match="not a gesture"):
            session.gesture(elsewhere)
    session.brush(about(session.face, NOSE, 6))
    with pytest.raises(ValueError, match="not a gesture"):
        session.gesture(cheek)


def test_the_outline_of_a_nose_is_no_arrow(session, monkeypatch):
    """Even if the classifier takes it for one."""
    seeing_arrows = SimpleNamespace(classify=lambda points: ("left arrow", 1.0))
    monkeypatch.setitem(session._modeller.__dict__, "gestures", seeing_arrows)
    before, nose = session.face, session.profile("left")[50:66]
    assert session.gesture(drawn("left arrow", place(session, NOSE, View.preset("left")), 0.1), "left") == "left arrow"
    assert session.gesture(nose - [0.02, 0], "left") == "line"
    assert session.face.landmarks[NOSE, 2] > before.landmarks[NOSE, 2] + 3


def test_the_region_bounds_silhouette_editing_too(session):
    left = View.preset("left")
    root, tip = place(session, 27, left), place(session, NOSE, left)
    session.gesture(drawn("region", (root + tip) / 2, 0.3), left)
    before = session.face
    session.gesture(stroke(root - [0.02, 0], tip - [0.04, 0]), left)
    change = moved(session, before)
    assert change.max() > 5
    soft = before.model.template.fine_parts <= 1
    assert change[np.setdiff1d(np.flatnonzero(soft), session.region)].max() == 0


@pytest.mark.parametrize("view", ["front", "left"])
def test_an_outline_is_dragged_within_a_region_from_any_view(session, view):
    session.gesture(drawn("region", place(session, NOSE, View.preset(view)), 0.28), view)
    before = session.face
    assert session.gesture(session.profile("left")[50:66] - [0.03, 0], "left") == "line"
    assert (session.face.vertices - before.vertices)[:, 2].max() > 6
    soft = np.flatnonzero(before.model.template.fine_parts <= 1)
    assert moved(session, before)[np.setdiff1d(soft, session.region)].max() == 0


def test_arrows_undo_and_redo(session):
    before = session.face
    session.brush(about(session.face, NOSE, 6))
    session.gesture(drawn("up roll 3", place(session, NOSE)))
    after = session.face
    assert session.gesture(drawn("left arrow", [0.5, 0.5])) == "left arrow"
    np.testing.assert_array_equal(session.face.vertices, before.vertices)
    assert session.gesture(drawn("right arrow", [0.5, 0.5])) == "right arrow"
    np.testing.assert_array_equal(session.face.vertices, after.vertices)
    assert session.gesture(drawn("right arrow", [0.5, 0.5])) == "right arrow"  # nothing to redo
    assert len(session.events) == 4


def test_a_refined_head_is_smooth(session):
    """No spike and no crease: the displacement of neighbours differs little beside that of the handles."""
    before = session.face
    session.brush(about(session.face, NOSE, 6))
    session.gesture(drawn("up roll 3", place(session, NOSE)))
    change = session.face.vertices - before.vertices
    edges = before.mesh.edges_unique
    length = np.linalg.norm(before.vertices[edges[:, 0]] - before.vertices[edges[:, 1]], axis=1)
    step = np.linalg.norm(change[edges[:, 0]] - change[edges[:, 1]], axis=1)
    assert (step / np.maximum(length, 0.5)).max() < 1.5  # 12 mm, spread over the 10 mm and more to the cheeks


# -- what lies below ---------------------------------------------------------------------------------------------------


def test_the_refinement_stays_when_the_head_below_changes():
    session = Session(Broadening())
    session.draw(stroke([0.2, 0.2], [0.3, 0.3]))
    session.brush(about(session.face, NOSE, 6))
    session.gesture(drawn("up roll 3", place(session, NOSE)))
    refined = session.face.vertices
    session.mode = "initial"
    session.draw(stroke([0.4, 0.4], [0.5, 0.5]))  # the head below is broader
    mean = session.face.model.mean
    np.testing.assert_allclose(session.face.vertices, refined + mean * (Broadening.BROADER - 1), atol=1e-3)


def test_a_gesture_infers_nothing():
    regressor = Broadening()
    session = Session(regressor)
    session.brush(about(session.face, NOSE, 6))
    asked = regressor.asked
    session.gesture(drawn("up roll 3", place(session, NOSE)))
    session.gesture(drawn("up roll 1", place(session, NOSE)))
    assert regressor.asked <= asked + 1


def test_lines_edited_after_a_gesture_keep_it_on_top():
    session = Session(REGRESSOR, inference=False)
    session.brush(about(session.face, NOSE, 6))
    session.gesture(drawn("up roll 3", place(session, NOSE)))
    tip = session.face.landmarks[NOSE]
    session.mode = "followup"
    np.testing.assert_array_equal(session.face.landmarks[NOSE], tip)
    brow = session.sketch.lines["left_brow"][0]
    session.erase(brow[len(brow) // 2], radius=0.005)
    session.draw(brow - np.array([0, 0.02]))
    assert (
        session.face.curve("left_brow")[:, 1].max()
        > session.face.model.mean[:, 1][session.face.model.curves["left_brow"]].max() + 2.0
    )
    np.testing.assert_allclose(session.face.landmarks[NOSE], tip, atol=1.0)


# -- bad input ---------------------------------------------------------------------------------------------------------


def bad_gestures(session):
    """Each with a part of what is said."""
    nose = place(session, NOSE)
    return [
        (lambda: session.gesture(np.random.default_rng(0).random((40, 2))), "not a gesture"),
        (lambda: session.gesture([[0.1, 0.1], [0.2, 0.2]]), "at least 3 points; given 2"),
        (lambda: session.gesture([[0.1, 0.1], [0.1, 0.1], [0.2, 0.2]]), "at least 3 points; given 2"),
        (lambda: session.gesture(np.concatenate([stroke(nose, nose + 0.1), stroke(nose + 0.1, nose)])), "not a gest"),
        (lambda: session.gesture(drawn("line", nose), View(scale=1e-6)), "at a scale from"),
        (lambda: session.gesture(drawn("line", nose), View(scale=10.0)), "at a scale from"),
        (lambda: session.gesture([[0.1, np.nan], [0.2, 0.2], [0.3, 0.3]]), "finite"),
        (lambda: session.gesture(drawn("region", np.array([0.1, 0.1]), 0.1)), "contains nothing"),
        (lambda: session.gesture(stroke([0.05, 0.1], [0.05, 0.3])), "no silhouette is near"),
        (lambda: session.gesture(drawn("up roll 1", nose)), "brush the handles first"),
        (lambda: session.gesture(drawn("line", nose), "above"), "given 'above'"),
        (lambda: session.gesture(drawn("line", nose), 3), "a view is a View"),
        (lambda: session.gesture(drawn("line", nose), {"rotation": 1, "scale": "a", "centre": None}), "view"),
        (lambda: session.gesture(drawn("line", nose), tool="chisel"), "given 'chisel'"),
    ]


@pytest.mark.parametrize("number", range(14))
def test_bad_input_is_told_and_changes_nothing(session, number):
    before = session.face
    act, said = bad_gestures(session)[number]
    with pytest.raises(ValueError, match=said):
        act()
    assert session.face is before and session.events == () and session.mode == "initial"


def test_handles_that_cannot_be_moved_are_told(session):
    session.brush(about(session.face, NOSE, 6))
    nose = place(session, NOSE)
    before = session.face
    with pytest.raises(ValueError, match="edge on"):
        session.gesture(drawn("up roll 1", nose), "left")
    with pytest.raises(ValueError, match="no handle is seen"):
        session.gesture(stroke(nose, nose + np.array([0, 0.1])), View(rotation_about_y(180)))
    session.gesture(drawn("region", place(session, CHIN), 0.2))
    with pytest.raises(ValueError, match="outside the region"):
        session.gesture(stroke(nose, nose + np.array([0, 0.1])))
    assert session.face is before or np.array_equal(session.face.vertices, before.vertices)


@pytest.mark.parametrize("name", ["line", "up roll 1", "down roll 3"])
def test_handles_are_not_moved_from_off_the_head(session, name):
    session.brush(about(session.face, NOSE, 6))
    before = session.face, session.events
    with pytest.raises(ValueError, match="off the head"):
        session.gesture(drawn(name, np.array([0.08, 0.12]), 0.1))
    assert (session.face, session.events) == before
    assert session.gesture(drawn(name, place(session, NOSE), 0.1)) == name


def test_a_head_is_not_pulled_apart(session):
    session.brush(about(session.face, NOSE, 6))
    nose = place(session, NOSE)
    for _ in range(8):
        session.gesture(drawn("up roll 3", nose))
    before = session.face
    with pytest.raises(ValueError, match="up to 100 mm"):
        session.gesture(drawn("up roll 3", nose))
    assert session.face is before


@settings(max_examples=15, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.integers(0, 10_000))
def test_random_gestures_never_explode(seed):
    session, random = Session(REGRESSOR), np.random.default_rng(seed)
    for _ in range(8):
        try:
            if random.random() < 0.3:
                session.brush(about(session.face, random.integers(68), random.uniform(1, 20)), bool(random.integers(2)))
                continue
            view = random.choice(["front", "left", "right", "three-quarter"])
            name = random.choice(GESTURES)
            seen = session.face.landmarks[random.integers(68)]
            session.gesture(drawn(name, View.preset(view).project(seen), random.uniform(0.02, 0.5)), str(view))
        except ValueError:
            pass
    vertices = session.face.vertices
    assert np.isfinite(vertices).all()
    assert np.linalg.norm(vertices - session.face.model.mean, axis=1).max() < 110


# -- files -------------------------------------------------------------------------------------------------------------


def test_a_session_of_gestures_replays(session):
    view = View(rotation_about_y(-33.3), 1 / 240, [0.51, 0.47])
    session.brush(about(session.face, NOSE, 6))
    session.gesture(drawn("up roll 2", place(session, NOSE, view)), view)
    session.gesture(drawn("up roll 1", place(session, NOSE)))
    session.gesture(drawn("left arrow", [0.5, 0.5]))
    again = Session.loads(session.dumps(), Broadening())
    assert again.events == session.events
    np.testing.assert_allclose(again.face.vertices, session.face.vertices, atol=1e-4)
    assert again.can_redo


def test_events_are_read_as_they_are_written():
    view = View(rotation_about_y(-33.3), 1 / 240, [0.51, 0.47])
    event = Gesture(drawn("line", [0.5, 0.5]), view)
    assert Gesture(event.points, event.view) == event
    assert event.to_json()["view"]["scale"] == pytest.approx(1 / 240)
    assert Gesture(event.points).to_json()["view"] is None


def test_a_gesture_is_kept_with_its_name_and_replayed_by_it(session, restored):
    session.brush(about(session.face, NOSE, 6))
    session.gesture(drawn("up roll 2", place(session, NOSE)))
    assert [event.name for event in session.events[1:]] == ["up roll 2"]
    text = session.dumps()
    register_gesture("everything", lambda edit: edit.refinement, lambda points: True)
    again = Session.loads(text, REGRESSOR)
    assert again.events == session.events
    np.testing.assert_array_equal(again.face.vertices, session.face.vertices)


def test_a_gesture_of_an_old_file_is_named_when_it_is_read(session):
    session.brush(about(session.face, NOSE, 6))
    session.gesture(drawn("up roll 2", place(session, NOSE)))
    old = session.dumps().replace(',"name":"up roll 2"', "")
    assert "up roll" not in old
    again = Session.loads(old, REGRESSOR)
    assert again.dumps() == session.dumps()
    np.testing.assert_array_equal(again.face.vertices, session.face.vertices)


def test_a_damaged_gesture_is_told_by_its_line():
    text = '{"format":"sketchwidget session","version":1,"events":1}\n{"event":"brush","vertices":[-1],"erase":false}\n'
    with pytest.raises(SessionFileError, match="line 2"):
        Session.loads(text, Broadening())


# -- behaviours of users -----------------------------------------------------------------------------------------------


@pytest.fixture
def restored():
    """Behaviours as they were."""
    known, recognisers = dict(behaviours._BEHAVIOURS), dict(behaviours._RECOGNISERS)
    yield
    for table, content in ((behaviours._BEHAVIOURS, known), (behaviours._RECOGNISERS, recognisers)):
        table.clear()
        table.update(content)


def test_a_gesture_is_added_by_one_call(session, restored):
    def is_zigzag(points):
        turns = np.diff(np.sign(np.diff(points[:, 1])))
        return (turns != 0).sum() >= 3

    def lift(edit):
        return edit.displaced(np.tile([0, 1.0, 0], (len(edit.face.vertices), 1)))

    zigzag = [[0.3, 0.4], [0.35, 0.6], [0.4, 0.4], [0.45, 0.6], [0.5, 0.4]]
    with pytest.raises(ValueError, match="not a gesture"):
        session.gesture(zigzag)
    register_gesture("zigzag", lift, is_zigzag)
    before = session.face
    assert session.gesture(zigzag) == "zigzag"
    soft = before.model.template.fine_parts <= 1
    np.testing.assert_allclose((session.face.vertices - before.vertices)[soft, 1], 1.0, atol=1e-3)
    assert session.gesture(drawn("left arrow", [0.5, 0.5])) == "left arrow"


def test_a_tool_takes_any_stroke(session, restored):
    seen = []

    def look(edit):
        seen.append((edit.points, edit.view))
        return edit.refinement

    register_gesture("look", look)
    points = np.random.default_rng(0).random((30, 2))
    assert session.gesture(points, "left", tool="look") == "look"
    assert len(seen[0][0]) == 30 and np.allclose(seen[0][1].rotation, View.preset("left").rotation)


def test_arrows_are_not_taken():
    with pytest.raises(ValueError, match="left arrow"):
        register_gesture("left arrow", lambda edit: edit.refinement)


def test_a_behaviour_that_gives_no_refinement_is_told_and_changes_nothing(session, restored):
    register_gesture("forgetful", lambda edit: None)
    before = session.face, session.events
    with pytest.raises(ValueError, match="'forgetful' does must give a Refinement; it gave None"):
        session.gesture([[0.4, 0.4], [0.5, 0.45], [0.6, 0.6]], tool="forgetful")
    assert (session.face, session.events) == before
    with pytest.raises(TypeError, match="given 3"):
        register_gesture("three", 3)
