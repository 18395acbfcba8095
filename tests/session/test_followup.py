"""Follow-up sketching on the shipped face model, with a regressor that knows nothing but the number of wrinkles."""

from types import SimpleNamespace

import numpy as np
import pytest
from folds import turned_over
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.spatial import KDTree
from skimage.draw import polygon2mask

from sketchwidget.face import FaceModel
from sketchwidget.face.handles import LINES, CurveHandles
from sketchwidget.face.template import PARTS
from sketchwidget.geometry import View
from sketchwidget.geometry.regularity import normals
from sketchwidget.session import Session
from sketchwidget.sketch import Piece, resample
from sketchwidget.sketch.polyline import arc_length

TURN = np.linspace(0, 2 * np.pi, 60)
OVAL = np.stack([0.5 + 0.27 * np.sin(TURN), 0.5 - 0.38 * np.cos(TURN)], axis=1)
WRINKLE = [[0.4, 0.25], [0.5, 0.24], [0.6, 0.25]]
NEAR = 0.0024  # canvas units: 0.6 mm
FLAP = 5.0  # mm^2 of skin: creases of lids are less


class WrinkleCounter:
    """Infers a head that is older by a step for each wrinkle; a stroke it has to name itself is a wrinkle."""

    def __init__(self):
        self.model = FaceModel.load()
        self.asked = 0

    def infer(self, sketch):
        self.asked += 1
        names = tuple("wrinkle" if segment.name == "unnamed" else segment.name for segment in sketch.segments)
        weights = self.model.bilinear.identities
        identity = self.model.mean_identity + 0.2 * names.count("wrinkle") * (weights[1] - weights[0])
        return SimpleNamespace(face=self.model.face(identity), frame=View(), names=names, timings={})


class NamesBrow:
    """Infers the heads of another regressor, and takes what has no name for the left brow."""

    def __init__(self, other):
        self.other, self.model = other, other.model

    def infer(self, sketch):
        names = ["left_brow" if segment.name == "unnamed" else segment.name for segment in sketch.segments]
        return self.other.infer(sketch.renamed(names))


class Elsewhere:
    """Infers the heads of another regressor, beside the middle of the canvas."""

    def __init__(self, other):
        self.other, self.model = other, other.model

    def infer(self, sketch):
        inference = self.other.infer(sketch)
        inference.frame = View(centre=inference.frame.centre - [0.05, 0])
        return inference


@pytest.fixture(scope="module")
def regressor():
    return WrinkleCounter()


@pytest.fixture
def session(regressor):
    session = Session(regressor)
    session.start_from_template()
    return session


def strayed(session):
    """How far, in canvas units, a handle point is from its drawn line at most."""
    farthest = 0.0
    for name in LINES:
        pieces = session.sketch.lines[name]
        ink = np.concatenate([resample(points, 3000 if name == "silhouette" else 300) for points in pieces])
        away = KDTree(ink).query(session.frame.project(session.face.curve(name)))[0]
        farthest = max(farthest, away.max())
    return farthest


def flipped(session):
    """How many triangles of the skin that face the front on the mean head face the back."""
    return turned_over(session.face.model, session.face.model.mean, session.face.vertices)


def flaps(session, before):
    """Square millimetres of skin that face the front and are turned by more than a right angle from a head (V, 3)."""
    model = session.face.model
    skin = model.faces[(model.template.fine_parts == PARTS.index("skin"))[model.faces].all(axis=1)]
    after, was = normals(session.face.vertices, skin), normals(before, skin)
    turned = ((after * was).sum(axis=0) < 0) & (after[2] > 0)
    return np.linalg.norm(after[:, turned], axis=0).sum() / 2


def erase_feature(session, name, number=0):
    points = session.sketch.lines[name][number]
    assert session.erase(points[len(points) // 2], radius=0.005)
    return points


def redraw_line(session, name, change):
    """Erase a whole line and draw what becomes of it."""
    for _ in range(len(session.sketch.lines[name])):
        erase_feature(session, name)
    session.draw(change(session.gap.erased.points.astype(float)))


def widened(by, down=1.0):
    return lambda line: line.mean(axis=0) + (line - line.mean(axis=0)) * [by, down]


def moved(*shift):
    return lambda line: line + shift


def turned(degrees):
    angle = np.radians(degrees)
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    return lambda line: line.mean(axis=0) + (line - line.mean(axis=0)) @ turn


def trembling(seed, by):
    def hand(line):
        even = resample(line, 200)
        return even + np.random.default_rng(seed).normal(0, by, even.shape)

    return hand


def same(one, other):
    return np.array_equal(one.face.vertices, other[0]) and one.sketch == other[1]


def snapshot(session):
    return session.face.vertices.copy(), session.sketch


# -- entering -------------------------------------------------------------------------------------------------------


def test_the_template_is_drawn_line_by_line(session):
    assert session.mode == "followup" and set(session.sketch.lines) == set(LINES)
    assert len(session.sketch.lines["silhouette"]) == 1 and len(session.sketch.lines["left_brow"]) > 1
    outline = session.sketch.lines["silhouette"][0]
    assert (outline[0] == outline[-1]).all()
    assert (
        strayed(session) < 3 * NEAR
    )  # the silhouette is drawn smoother than the mesh has it, until something is edited
    np.testing.assert_array_equal(session.face.vertices, session.face.model.mean)


def test_from_a_drawing_the_head_stays_and_drawn_wrinkles_are_kept(regressor):
    session = Session(regressor)
    session.draw(OVAL)
    session.draw(WRINKLE)
    before = session.face
    session.mode = "followup"
    assert session.face is before
    assert [segment.points.shape for segment in session.sketch.segments if segment.name == "wrinkle"] == [
        (60, 2),
        (3, 2),
    ]
    assert session.undo() and len(session.sketch) == 2 and session.mode == "initial"


@pytest.mark.parametrize("entering", ["mode", "template"])
def test_what_deforms_heads_is_there_once_the_mode_is_entered(entering):
    regressor = WrinkleCounter()
    session = Session(regressor)
    session.draw(OVAL)
    assert "handles" not in vars(regressor.model)
    if entering == "mode":
        session.mode = "followup"
    else:
        session.start_from_template()
    assert "handles" in vars(regressor.model)


def test_without_inference_a_session_begins_with_the_template(regressor):
    session = Session(regressor, inference=False)
    asked = regressor.asked
    assert session.mode == "followup"
    erase_feature(session, "nose")
    session.draw(session.gap.erased.points + np.array([0.01, 0]))
    session.draw(WRINKLE)
    assert regressor.asked == asked and strayed(session) < NEAR
    again = Session.loads(session.dumps(), regressor)
    assert not again.inference and same(again, snapshot(session))
    assert Session.loads(session.dumps(), regressor, inference=True).inference


def test_without_inference_no_undo_leads_behind_the_template(regressor):
    session = Session(regressor, inference=False)
    start = snapshot(session)
    assert not session.can_undo and not session.undo()
    session.draw(WRINKLE)
    assert session.undo() and not session.can_undo and not session.undo()
    assert session.mode == "followup" and same(session, start)
    assert same(Session.loads(session.dumps(), regressor), start)


# -- erasing ----------------------------------------------------------------------------------------------------------


def test_erasing_takes_one_whole_segment_of_a_feature(session):
    erased = session.sketch.lines["left_brow"][0]
    before = session.face
    assert session.erase(session.sketch.lines["left_brow"][0])
    assert len(session.sketch.lines["left_brow"]) == 1
    assert not any(np.array_equal(erased, points) for points in session.sketch.lines["left_brow"])
    assert session.gap.name == "left_brow" and len(session.gap.ends) == 1
    assert session.face is before


def test_erasing_where_there_is_nothing_does_nothing(session):
    assert not session.erase([0.02, 0.02])
    assert session.gap is None and not session.erase([[0.5, 0.2], [0.5, 0.21]])


def test_erasing_elsewhere_waits(session):
    erase_feature(session, "left_brow")
    present = session.sketch
    assert not session.erase(session.sketch.lines["nose"][0])
    assert session.sketch is present
    assert session.cancel() and session.gap is None
    assert session.erase(session.sketch.lines["nose"][0])


def test_more_of_the_same_line_can_be_erased(session):
    for number in range(3):
        erase_feature(session, "mouth_upper")
        assert len(session.sketch.lines.get("mouth_upper", [])) == 2 - number
    assert len(session.gap.ends) == 0
    former = session.gap.erased.points
    session.draw(former - np.array([0, 0.01], dtype=np.float32))
    assert strayed(session) < NEAR


def test_the_outline_is_erased_part_by_part(session):
    outline = session.sketch.lines["silhouette"][0]
    assert session.erase(outline[80:100])
    assert len(session.gap.ends) == 2
    assert session.erase(outline[140:150])
    ends = session.gap.ends
    assert session.undo() and session.undo() and session.gap is None
    assert session.redo() and session.redo()
    np.testing.assert_array_equal(session.gap.ends, ends)


def test_a_wrinkle_is_erased_whole_and_changes_the_face_by_inference(session):
    start = snapshot(session)
    session.draw(WRINKLE)
    assert session.sketch.lines["wrinkle"] and not np.array_equal(session.face.vertices[:, 2], start[0][:, 2])
    assert strayed(session) < NEAR
    assert session.erase([0.5, 0.24]) and session.gap is None
    assert same(session, start)


# -- drawing ----------------------------------------------------------------------------------------------------------


def test_a_higher_brow_raises_the_brow(session):
    brow = session.face.model.curves["left_brow"]
    before = session.face.vertices[brow]
    for _ in range(2):
        erase_feature(session, "left_brow")
    session.draw(session.gap.erased.points - np.array([0, 0.04], dtype=np.float32))
    assert session.gap is None and strayed(session) < NEAR
    rise = session.face.vertices[brow, 1] - before[:, 1]
    assert rise == pytest.approx(10, abs=0.6)
    assert {"inference", "deformation"} <= session.timings.keys()


def test_the_lower_lip_follows_a_wider_upper_one(session):
    lower = session.face.curve("mouth_lower")
    for _ in range(3):
        erase_feature(session, "mouth_upper")
    middle = session.gap.erased.points.mean(axis=0)
    session.draw((session.gap.erased.points - middle) * 1.3 + middle)
    for end in (0, -1):
        upper_end = session.sketch.lines["mouth_upper"][end][end]
        assert (upper_end == session.sketch.lines["mouth_lower"][end][end]).all()
    wider = np.ptp(session.face.curve("mouth_lower")[:, 0]) / np.ptp(lower[:, 0])
    assert wider == pytest.approx(1.3, abs=0.03)
    assert strayed(session) < NEAR


def test_a_rough_stroke_with_a_tremor_is_met(session):
    outline = session.sketch.lines["silhouette"][0]
    session.erase(outline[120:180])
    a, b = session.gap.ends
    t = np.linspace(0.06, 0.97, 70)[:, None]
    sag = np.sin(np.pi * t) * [-0.15, -0.09]
    tremor = np.random.default_rng(0).normal(0, 0.0008, (70, 2))
    session.draw(b + t * (a - b) + sag + tremor)
    assert session.gap is None and strayed(session) < NEAR


def test_mirrored_drawing_redraws_both_sides(session):
    points = erase_feature(session, "left_brow")
    session.draw(points - np.array([0, 0.03], dtype=np.float32), mirror=True)
    curves = [session.frame.project(session.face.curve(f"{side}_brow")) for side in ("left", "right")]
    np.testing.assert_allclose(curves[0][:, 1], curves[1][:, 1], atol=0.003)
    np.testing.assert_allclose(curves[0][:, 0] - 0.5, 0.5 - curves[1][:, 0], atol=0.003)


@pytest.mark.parametrize(
    "stroke", [[[0.5, 0.5]], 0.02 * OVAL + [0.6, 0.4], np.tile(OVAL, (10, 1)), [[0.9, 0.95], [0.95, 0.9]]]
)
def test_a_refused_stroke_keeps_the_drawing_and_the_gap(session, stroke):
    erase_feature(session, "left_brow")
    before = session.sketch, session.gap, session.events
    with pytest.raises(ValueError, match="gap"):
        session.draw(stroke)
    assert (session.sketch, session.gap, session.events) == before


def looped(line):
    """A line with a loop in its middle."""
    even, turn = resample(line, 80).astype(float), np.linspace(0, 2 * np.pi, 40)
    return np.concatenate([even[:40], even[40] + 0.012 * np.stack([np.cos(turn) - 1, np.sin(turn)], axis=1), even[40:]])


def and_half_way_back(line):
    return np.concatenate([line, line[: len(line) // 2 : -1]])


@pytest.mark.parametrize("name", ["left_brow", "left_eye_upper", "mouth_upper", "nose", "left_ear"])
@pytest.mark.parametrize("change", [looped, and_half_way_back])
def test_a_stroke_that_crosses_itself_gives_a_sane_face(session, name, change):
    before = session.face.vertices
    redraw_line(session, name, change)
    assert flipped(session) == 0 and np.abs(session.face.vertices - before).max() < 25


@pytest.mark.parametrize(
    ("name", "shift", "over"),
    [("left_brow", 0.12, "left eye"), ("nose", 0.1, "mouth"), ("mouth_upper", 0.2, "silhouette")],
)
def test_a_line_does_not_pass_over_another(session, name, shift, over):
    for _ in range(len(session.sketch.lines[name])):
        erase_feature(session, name)
    before = session.sketch, session.gap
    with pytest.raises(ValueError, match=f"pass over the line {over}"):
        session.draw(session.gap.erased.points + np.array([0, shift]))
    assert (session.sketch, session.gap) == before


def test_a_brow_does_not_come_down_on_the_other_side_of_the_nose(session):
    erase_feature(session, "right_brow")
    with pytest.raises(ValueError, match="pass over the line of the bridge of the nose"):
        session.draw([[0.5, 0.25], [0.531, 0.6]])
    session.draw([[0.46, 0.45], [0.51, 0.45]])  # brows may meet
    assert flipped(session) == 0


def test_the_outline_does_not_pass_over_the_mouth(session):
    with pytest.raises(ValueError, match="pass over the line mouth"):
        redraw_chin(session, [0, -0.25])


def test_a_mirrored_stroke_is_mirrored_about_the_middle_of_the_head(regressor):
    session = Session(Elsewhere(regressor))
    session.draw(OVAL)
    session.mode = "followup"
    middle = session.frame.centre[0]
    points = erase_feature(session, "left_brow")
    session.draw(points - np.array([0, 0.03], dtype=np.float32), mirror=True)
    assert middle == pytest.approx(0.45) and session.gap is None
    curves = [session.frame.project(session.face.curve(f"{side}_brow")) for side in ("left", "right")]
    np.testing.assert_allclose(curves[0][:, 0] - middle, middle - curves[1][:, 0], atol=0.003)


def test_another_mode_gives_back_what_waits_and_keeps_the_edits(session):
    points = erase_feature(session, "left_brow")
    session.draw(points - np.array([0, 0.03], dtype=np.float32))
    edited = snapshot(session)
    erase_feature(session, "nose")
    session.mode = "initial"
    assert session.gap is None and same(session, edited)
    session.mode = "followup"
    assert same(session, edited)


def test_lines_that_initial_mode_leaves_alone_stay_as_they_were_drawn(session):
    points = erase_feature(session, "left_brow")
    session.draw(points - np.array([0, 0.03], dtype=np.float32))
    raised = session.sketch.lines["left_brow"]
    session.mode = "initial"
    session.erase(session.sketch.lines["nose"][1], radius=0.01)
    session.mode = "followup"
    assert all(np.array_equal(a, b) for a, b in zip(raised, session.sketch.lines["left_brow"], strict=True))
    assert all(isinstance(segment, Piece) for segment in session.sketch.segments)
    assert strayed(session) < NEAR


def test_a_line_drawn_again_by_hand_is_the_newer_one(session):
    points = erase_feature(session, "left_brow")
    session.draw(points - np.array([0, 0.03], dtype=np.float32))
    raised = session.face.curve("left_brow")[:, 1]
    session.mode = "initial"
    session._modeller._regressor = NamesBrow(session.regressor)
    session.draw(points)
    session.mode = "followup"
    session._modeller._regressor = session.regressor.other
    assert (session.face.curve("left_brow")[:, 1] < raised - 2).any()
    assert [segment.name for segment in session.sketch.segments].count("left_brow") == 2


def test_while_a_line_is_drawn_the_rest_of_it_is_as_it_was(session):
    before = session.face.curve("left_brow")[:, 1].copy()
    for _ in range(2):
        erase_feature(session, "left_brow")
    higher = resample(session.gap.erased.points - np.array([0, 0.03]), 40)
    waiting = session.sketch, session.gap
    rise = [session.preview(higher[:count]).face.curve("left_brow")[:, 1] - before for count in (14, 40)]
    assert rise[0][:4].min() > 5 and rise[0][-1] == pytest.approx(0, abs=0.6)
    assert (session.sketch, session.gap) == waiting
    session.draw(higher)
    drawn = session.face.curve("left_brow")[:, 1] - before
    np.testing.assert_allclose(rise[1], drawn, atol=1.5)
    assert drawn.min() > 5


def test_while_a_line_is_drawn_anew_nothing_is_inferred_again(session, monkeypatch):
    points = erase_feature(session, "left_brow")
    session.preview(points[:10] - np.array([0, 0.02]))
    inferred = []
    monkeypatch.setattr(session.regressor, "infer", lambda sketch: inferred.append(sketch))
    heads = [session.preview(points - np.array([0, rise])).face for rise in (0.01, 0.03)]
    low, high = (head.curve("left_brow")[:, 1].mean() for head in heads)
    assert high > low + 1 and not inferred


def test_while_a_profile_is_drawn_the_head_follows(session):
    line = session.profile()[45:75] - [0.03, 0]
    heads = [session.preview(line[:count], view="left").face for count in (10, 20, 30)] * 2
    session.draw(line, view="left")
    assert np.array_equal(session.face.vertices, heads[-1].vertices)
    assert session.undo() and np.array_equal(session.face.vertices, session.face.model.mean)


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("left_eye_upper", moved(0.08, 0)),
        ("left_eye_upper", moved(0, 0.1)),
        ("left_eye_upper", moved(0.07, 0.07)),
        ("left_eye_upper", turned(40)),
        ("left_eye_upper", widened(1.5, 1.5)),
        ("left_brow", moved(0, -0.06)),
        ("left_brow", turned(35)),
        ("mouth_upper", moved(0, 0.08)),
        ("mouth_upper", moved(0.08, 0)),
        ("mouth_upper", widened(2)),
        ("nose", widened(1.6)),
    ],
)
def test_a_large_edit_does_not_fold(session, name, change):
    redraw_line(session, name, change)
    assert flipped(session) == 0 and strayed(session) < NEAR


@pytest.mark.parametrize(
    ("name", "number", "shift"),
    [
        ("nose", 0, (0.031, 0)),
        ("nose", 2, (-0.031, 0)),
        ("left_eye_upper", 0, (0.031, 0)),
        ("left_eye_upper", 0, (-0.02, -0.01)),
        ("left_eye_lower", 0, (-0.02, 0.01)),
    ],
)
def test_a_piece_moved_again_and_again_does_not_fold(session, name, number, shift):
    for _ in range(2):
        before = session.face.vertices
        session.draw(erase_feature(session, name, number) + np.array(shift))
        assert flipped(session) == turned_over(session.face.model, before, session.face.vertices) == 0
        assert flaps(session, before) < FLAP and strayed(session) < NEAR


@pytest.mark.parametrize(
    ("name", "number", "shift", "reason"),
    [
        ("mouth_upper", 0, (0.032, -0.04), "no head can have this line"),
        ("mouth_lower", 2, (-0.032, 0.029), "the skin about the line mouth lower would fold: draw it nearer"),
        ("left_eye_upper", 0, (0.031, -0.031), "the line left eye upper would turn back on itself: draw it once"),
        ("left_eye_lower", 0, (0.031, 0), "the line left eye lower would turn back on itself: draw it once"),
        ("left_brow", 1, (-0.036, -0.035), "the line left brow would turn back on itself: draw it once"),
    ],
)
def test_what_no_head_can_have_is_refused(session, name, number, shift, reason):
    """A corner of the mouth or of an eye as a thin spike, a flap of the lip, lines that double back."""
    start = snapshot(session)
    points = erase_feature(session, name, number)
    before = session.sketch, session.gap, session.events
    with pytest.raises(ValueError, match=reason):
        session.draw(points + np.array(shift))
    assert (session.sketch, session.gap, session.events) == before and np.array_equal(session.face.vertices, start[0])
    assert session.cancel() and same(session, start)


def test_a_nose_dragged_into_a_flap_is_refused(session):
    session.draw(erase_feature(session, "nose", 0) + np.array([0.031, 0.031]))
    points = erase_feature(session, "nose", 0)
    before = session.sketch, session.gap, session.face
    with pytest.raises(ValueError, match=r"turn back on itself|would fold"):
        session.draw(points + np.array([0.031, 0.031]))
    assert (session.sketch, session.gap, session.face) == before


@pytest.mark.parametrize(("name", "number"), [("left_brow", 0), ("left_brow", 1), ("mouth_upper", 2), ("nose", 1)])
def test_a_whole_line_is_not_crammed_into_the_gap_of_a_piece(session, name, number):
    whole = np.concatenate(session.sketch.lines[name]) - np.array([0, 0.02])
    erase_feature(session, name, number)
    before = session.sketch, session.gap, session.face
    with pytest.raises(
        ValueError, match="far past the gap: draw only what is missing, or erase more of the line first"
    ):
        session.draw(whole)
    assert (session.sketch, session.gap, session.face) == before
    while name in session.sketch.lines:
        erase_feature(session, name)
    session.draw(whole)
    assert session.gap is None and strayed(session) < NEAR


@pytest.mark.parametrize("name", ["left_brow", "left_eye_upper", "mouth_lower", "nose", "left_ear"])
def test_a_stroke_may_overshoot_its_gap_or_fall_short_of_it(session, name):
    whole = np.concatenate(session.sketch.lines[name]).astype(float)
    along = arc_length(whole)
    for number in range(len(session.sketch.lines[name])):
        for by in (-0.004, 0.01, 0.02):
            points = erase_feature(session, name, number)
            first, last = (int(np.argmin(np.linalg.norm(whole - end, axis=1))) for end in points[[0, -1]])
            drawn = whole[(along >= along[first] - by) & (along <= along[last] + by)] - [0, 0.005]
            session.draw(drawn)
            assert session.gap is None and flipped(session) == 0
            session.undo()
            session.cancel()


@pytest.mark.parametrize("amount", [1.5, 2.2])
@pytest.mark.parametrize("expression", ["neutral", "grin_open", "mouth_open"])
def test_ordinary_edits_of_exaggerated_heads_are_done(regressor, amount, expression):
    session = Session(regressor)
    session.take_over(regressor.model.face(regressor.model.bilinear.identities[0], expression))
    session.exaggerate(amount)
    start = session.face.vertices
    for name, change in (
        ("left_brow", moved(0, -0.02)),
        ("left_eye_upper", moved(0, -0.008)),
        ("mouth_upper", widened(1.3)),
        ("nose", moved(0.01, 0)),
    ):
        redraw_line(session, name, change)
        assert session.gap is None and flaps(session, start) < FLAP
        session.undo()
        session.cancel()


def test_a_mirrored_stroke_takes_its_part_of_a_line_that_was_drawn_whole(session):
    redraw_line(session, "right_brow", moved(0, -0.01))
    points = erase_feature(session, "left_brow", 0)
    session.draw(points - np.array([0, 0.02]), mirror=True)
    assert session.gap is None and strayed(session) < NEAR
    sides = [session.sketch.lines[f"{side}_brow"] for side in ("left", "right")]
    assert [len(pieces) for pieces in sides] == [2, 2]


def eye_in_sight(session):
    """How many pixels the left eyeball is seen in, of 0.3 mm: within its lids, and outside of them."""
    eye = session.face.model.template.fine_parts == PARTS.index("eyes")
    red, green, _ = session.face.picture(session.frame, 800, eye[:, None] * [1.0, 0, 0]).astype(int).transpose(2, 0, 1)
    seen = (red - green > 40) & (np.arange(800) > 400)
    lids = [session.frame.project(session.face.curve(f"left_eye_{side}")) for side in ("upper", "lower")]
    opening = polygon2mask((800, 800), 800 * np.concatenate([lids[0], lids[1][::-1]])[:, ::-1])
    return int((seen & opening).sum()), int((seen & ~opening).sum())


@pytest.mark.parametrize("shift", [(0.04, 0), (0, 0.06), (-0.04, 0)])
def test_an_eyeball_keeps_behind_its_lids(session, shift):
    redraw_line(session, "left_eye_upper", moved(*shift))
    within, outside = eye_in_sight(session)
    assert within > 500 and outside < 12


@pytest.mark.parametrize(("drawn", "onto"), [("upper", "lower"), ("lower", "upper")])
def test_an_eye_drawn_shut_is_shut(session, drawn, onto):
    other = np.concatenate(session.sketch.lines[f"left_eye_{onto}"])
    redraw_line(session, f"left_eye_{drawn}", lambda _: other)
    within, outside = eye_in_sight(session)
    assert within + outside < 8 and flipped(session) == 0 and strayed(session) < NEAR


def test_a_wider_jaw_does_not_fold(session):
    outline = session.sketch.lines["silhouette"][0]
    session.erase(outline[outline[:, 1] > 0.62], radius=0.01)
    points = session.gap.erased.points.astype(float)
    before = session.face.curve("silhouette")
    wider = 0.4 * np.sin(np.linspace(0, np.pi, len(points))) ** 0.5
    session.draw(np.stack([0.5 + (points[:, 0] - 0.5) * (1 + wider), points[:, 1]], axis=1))
    assert flipped(session) == 0 and strayed(session) < NEAR
    assert np.abs(session.face.curve("silhouette") - before)[:, 0].max() > 12


@pytest.mark.parametrize("name", ["nose", "left_ear", "right_ear", "left_brow", "left_eye_lower", "mouth_lower"])
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_trembling_hand_is_obeyed(session, name, seed):
    redraw_line(session, name, trembling(seed, 0.0018))
    assert session.gap is None and strayed(session) < NEAR


def kinked(seed, kind):
    """A line with a kink that is finer than the mesh."""
    rng = np.random.default_rng(seed)

    def hand(line):
        even = resample(line, 160).astype(float)
        along = np.gradient(even, axis=0)
        across = np.stack([-along[:, 1], along[:, 0]], axis=1) / (np.linalg.norm(along, axis=1)[:, None] + 1e-12)
        at, size, place = rng.integers(40, 120), rng.uniform(0.006, 0.016), np.arange(160)
        if kind == "zigzag":
            return even + across * size * (np.abs(4 * (np.linspace(0, rng.integers(2, 8), 160) % 1) - 2) - 1)[:, None]
        if kind == "spike":
            return even + across * size * np.clip(1 - np.abs(place - at) / 6, 0, 1)[:, None]
        if kind == "step":
            return even + across * size * np.clip((place - at) / 4, 0, 1)[:, None]
        turn = np.linspace(0, (2 if kind == "loop" else 4) * np.pi, 60)[:, None]
        circle = (np.cos(turn) - 1) * across[at] + np.sin(turn) * along[at] / np.linalg.norm(along[at])
        return np.concatenate([even[:at], even[at] + size * turn / turn.max() * circle, even[at:]])

    return hand


@pytest.mark.parametrize("kind", ["zigzag", "spike", "step", "loop", "spiral"])
@pytest.mark.parametrize("name", ["left_brow", "nose", "mouth_lower", "right_ear", "right_eye_upper"])
def test_a_line_with_kinks_finer_than_the_mesh_is_drawn_as_the_head_can_have_it(session, name, kind):
    before = np.concatenate(session.sketch.lines[name])
    redraw_line(session, name, kinked(len(name), kind))
    assert strayed(session) < NEAR and flipped(session) == 0
    assert KDTree(np.concatenate(session.sketch.lines[name])).query(before)[0].max() < 0.02  # it is still that line


def test_how_smooth_a_line_became_stays_with_its_stroke(session, monkeypatch):
    redraw_line(session, "left_brow", kinked(3, "zigzag"))
    stroke = session.events[-1]
    assert stroke.spacing >= 2
    monkeypatch.setattr("sketchwidget.session.obeying._NEAR", -1.0)  # no head is near enough any more
    again = Session(session.regressor)
    for event in session.events:
        again.do(event)
    assert again.sketch == session.sketch and again.undo() and again.redo() and again.sketch == session.sketch


# -- side views -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("side", ["left", "right"])
def test_the_profile_is_dragged_to_a_stroke(session, side):
    forward = np.array([-0.03 if side == "left" else 0.03, 0.0])
    line = session.profile(side)
    part = slice(45, 75)
    front = session.frame.project(session.face.vertices)
    bump = np.sin(np.linspace(0, np.pi, 30))[:, None]
    session.draw(line[part] + forward * bump, view=side)
    moved = session.profile(side) - line
    assert np.abs(moved[58:62, 0] - forward[0]).max() < 0.006
    assert np.abs(moved[:20]).max() < 0.002
    across = session.frame.project(session.face.vertices)[:, 0] - front[:, 0]
    # But for the smoother silhouette, nothing moves across.
    assert np.abs(across).max() < 2.5 * NEAR and np.median(np.abs(across)) < 0.1 * NEAR and strayed(session) < NEAR
    assert session.undo() and np.array_equal(session.profile(side), line)


def dragged(session, part, forward, sign=1.0):
    """Drag a part of the profile, seen from the left, by canvas units to the front."""
    line = session.profile()[part]
    bump = np.sin(np.linspace(0, np.pi, len(line)))[:, None]
    session.draw(line - forward * bump * [1, 0], view="left")


def test_a_drag_of_the_profile_deforms_once(session, monkeypatch):
    redraw_line(session, "left_brow", moved(0, -0.02))
    dragged(session, slice(45, 75), 0.02)
    deform, calls = CurveHandles.__call__, []
    monkeypatch.setattr(CurveHandles, "__call__", lambda *given: calls.append(1) or deform(*given))
    dragged(session, slice(45, 75), 0.01)
    first = session.face.vertices
    assert len(calls) == 1
    session._modeller._lined = None
    session.undo()
    dragged(session, slice(45, 75), 0.01)
    assert len(calls) > 2 and np.array_equal(session.face.vertices, first)


def test_the_first_drag_of_the_profile_deforms_once_too(session, monkeypatch):
    deform, calls = CurveHandles.__call__, []
    monkeypatch.setattr(CurveHandles, "__call__", lambda *given: calls.append(1) or deform(*given))
    dragged(session, slice(45, 75), 0.02)
    assert len(calls) == 1 and not np.array_equal(session.face.vertices, session.face.model.mean)


def redraw_chin(session, shift):
    """Draw the lowest part of the outline lower, by canvas units at its middle."""
    outline = session.sketch.lines["silhouette"][0]
    low = np.flatnonzero(outline[:, 1] > 0.82)
    session.erase(outline[low])
    points = session.gap.erased.points.astype(float)
    session.draw(points + np.sin(np.linspace(0, np.pi, len(points)))[:, None] * shift)


def test_a_head_elsewhere_on_the_canvas_keeps_a_drawn_profile_in_depth(regressor):
    session = Session(Elsewhere(regressor))
    session.start_from_template()
    dragged(session, slice(45, 75), 0.03)
    profile = session.face.model.handles.profile[58:62]
    before = session.face.vertices[profile]
    session.mode = "initial"
    session.erase(session.sketch.lines["silhouette"][0][:3])
    session.mode = "followup"
    assert session.frame.centre[0] == pytest.approx(0.45)
    assert np.abs(session.face.vertices[profile, 2] - before[:, 2]).max() < 0.3


@pytest.mark.parametrize("low", [False, True])
@pytest.mark.parametrize("shift", [-0.06, 0.08])
def test_a_chin_drawn_after_the_profile_does_not_fold(session, shift, low):
    dragged(session, slice(-25, -5) if low else slice(20, 40), 0.015)
    redraw_chin(session, [0, shift])
    assert flipped(session) == 0


@pytest.mark.parametrize(
    ("stroke", "reason"),
    [
        (lambda line: np.concatenate([line, line[::-1]] * 5 + [line]), "far longer"),
        (lambda line: np.concatenate([line[:15], line[15] + [[-0.4, 0.0]], line[15:]]), "not near"),
        (lambda line: line[[0, 0]], "too short"),
    ],
)
def test_a_stroke_that_is_no_profile_is_refused(session, stroke, reason):
    before = session.sketch, session.face
    with pytest.raises(ValueError, match=reason):
        session.draw(stroke(session.profile()[45:75]), view="left")
    assert (session.sketch, session.face) == before


def test_a_side_stroke_far_from_the_profile_is_refused(session):
    with pytest.raises(ValueError, match="not near the profile"):
        session.draw([[0.9, 0.1], [0.9, 0.3]], view="left")
    session.mode = "initial"
    with pytest.raises(ValueError, match="follow-up mode"):
        session.draw(WRINKLE, view="left")


def test_loops_of_a_side_stroke_are_left_out(session):
    part = session.profile("left")[45:75]
    turn = np.linspace(0, 2 * np.pi, 24)
    loop = part[15] + 0.03 * np.stack([np.cos(turn) - 1, np.sin(turn)], axis=1)
    session.draw(np.concatenate([part[:16], loop, part[16:]]), view="left")
    assert np.abs(session.profile("left")[45:75] - part).max() < 0.006


# -- undoing ----------------------------------------------------------------------------------------------------------

coordinates = st.floats(0.05, 0.95)
strokes = st.lists(st.tuples(coordinates, coordinates).map(list), min_size=1, max_size=6)
edits = st.lists(
    st.one_of(
        st.tuples(st.just("erase"), strokes),
        st.tuples(st.just("redraw"), st.sampled_from(LINES), st.floats(-0.04, 0.04), st.floats(-0.04, 0.04)),
        st.tuples(st.just("draw"), strokes),
        st.tuples(st.just("profile"), st.sampled_from(["left", "right"]), st.floats(-0.03, 0.03)),
        st.tuples(st.sampled_from(["cancel", "undo", "redo"])),
    ),
    max_size=8,
)


def act(session, action, *arguments):
    if action == "redraw" and session.gap is None:
        name, *shift = arguments
        points = erase_feature(session, name) if name != "silhouette" else session.sketch.lines[name][0][100:140]
        if name == "silhouette":
            session.erase(points)
        action, arguments = "draw", [points + np.array(shift, dtype=np.float32)]
    if action == "profile":
        view, forward = arguments
        points = session.profile(view)[45:75] + np.array([forward, 0.0], dtype=np.float32)
        action, arguments = "draw", [points, view]
    if action != "redraw":
        getattr(session, action)(*arguments)


@settings(max_examples=12, deadline=None, suppress_health_check=list(HealthCheck))
@given(edits)
def test_any_edits_keep_the_topology_and_undo_to_the_last_bit(regressor, edits):
    session = Session(regressor)
    session.start_from_template()
    start = snapshot(session)
    for edit in edits:
        before = session.face.vertices
        try:
            act(session, *edit)
        except ValueError:
            continue
        if session.mode != "followup":
            session.redo()
        if session.gap is None:
            lines = session.sketch.lines
            assert set(LINES) <= set(lines) and (lines["silhouette"][0][0] == lines["silhouette"][0][-1]).all()
            for part in ("left_eye", "right_eye", "mouth"):
                for end in (0, -1):
                    assert (lines[f"{part}_upper"][end][end] == lines[f"{part}_lower"][end][end]).all()
        assert flipped(session) == 0
        if edit[0] == "redraw" and session.gap is None:
            assert strayed(session) < NEAR and flaps(session, before) < FLAP
        assert np.isfinite(session.face.vertices).all() and np.abs(session.face.vertices).max() < 400
    again = Session.loads(session.dumps(), regressor)
    assert same(again, snapshot(session))
    while session.can_undo and session.undo():
        if session.mode == "followup":
            last = snapshot(session)
    if edits and session.events:
        session.redo()
        last = snapshot(session)
        assert np.array_equal(last[0], start[0]) and last[1] == start[1]


def test_a_profile_is_one_of_a_side():
    with pytest.raises(ValueError, match="from the left or the right; given 'front'"):
        Session(inference=False).profile("front")
