"""Wrinkle lines: suggestive contours of the face."""

import numpy as np
import pytest
from scipy.spatial import KDTree

from sketchwidget.face import PARTS
from sketchwidget.face.wrinkles import LIPS, region
from sketchwidget.geometry import CANVAS_MM, View, rotation_about_y
from sketchwidget.sketch import SILHOUETTE, WRINKLE, arc_length

LIP_SEGMENTS = 4
FOLDED = ("laugh", "huge_grin", "disgust", "shout")


def wrinkles(face, view=None):
    """Millimetres in the picture, x right and y down."""
    return [CANVAS_MM * line for line in face.sketch(view=view).lines[WRINKLE][LIP_SEGMENTS:]]


def length(face):
    return sum(arc_length(line)[-1] for line in wrinkles(face))


def people(model):
    return model.bilinear.identities[:600:60]


def test_a_face_at_rest_has_hardly_any_and_a_folded_one_has_more(model):
    rest = model.face()
    assert len(wrinkles(rest)) <= 4 and length(rest) < 80
    for expression in FOLDED:
        assert length(model.face(expression=expression)) > 1.3 * length(rest), expression
    for expression in ("laugh", "huge_grin"):
        more = [length(model.face(u, expression)) - length(model.face(u)) for u in people(model)]
        assert np.mean(more) > 15, expression


def test_lines_are_few_long_and_smooth(model):
    turns = []
    for expression in FOLDED:
        for u in people(model):
            lines = wrinkles(model.face(u, expression))
            assert len(lines) <= 24
            for line in lines:
                assert arc_length(line)[-1] > 6.5
                steps = np.diff(line, axis=0)
                turns.append(np.diff(np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))))
    assert np.quantile(np.abs(np.concatenate(turns)), 0.99) < 0.8


def test_the_region_is_skin_of_the_face_in_front(model):
    inside = region(model.template, model.mean)
    assert (model.template.fine_parts[inside] == PARTS.index("skin")).all()
    assert model.mean[inside, 1].min() > model.mean[model.landmarks[8], 1] + 5  # above the menton: not the neck
    ears = np.concatenate([model.curves["left_ear"], model.curves["right_ear"]])
    assert np.abs(model.mean[inside, 0]).max() < np.abs(model.mean[ears, 0]).min() - 5
    landmarks = model.landmarks
    assert not inside[landmarks[30:68]].any()  # tip of the nose, nostrils, eyes and lips
    chin = (model.mean[landmarks[8], 1] + model.mean[landmarks[57], 1]) / 2
    for height in (50, model.mean[landmarks[27], 1], chin):  # forehead, root of the nose, below the lip
        here = np.flatnonzero(np.hypot(model.mean[:, 0], model.mean[:, 1] - height) < 4)
        assert inside[here[model.mean[here, 2].argmax()]], height


def test_none_runs_along_a_predefined_curve_or_leaves_the_face(model):
    for expression in FOLDED:
        for u in people(model)[:4]:
            face = model.face(u, expression)
            points = np.concatenate(wrinkles(face))
            outline = CANVAS_MM * face.sketch(wrinkles=False).lines[SILHOUETTE][0]
            assert KDTree(outline).query(points)[0].min() > 3
            low, high = outline.min(axis=0), outline.max(axis=0)
            assert (points > low).all() and (points < high).all()
            lips = CANVAS_MM * View().project(np.concatenate([face.curve(name) for name in LIPS]))
            assert (KDTree(lips).query(points)[0] < 2).mean() < 0.1


def test_a_symmetric_face_has_nearly_symmetric_wrinkles(model):
    for expression in ("neutral", *FOLDED):
        points = np.concatenate(wrinkles(model.face(expression=expression)))
        mirrored = points * [-1, 1] + [CANVAS_MM, 0]
        assert (KDTree(mirrored).query(points)[0] < 5).mean() > 0.8, expression


def test_hidden_wrinkles_are_not_drawn(model):
    face = model.face(expression="huge_grin")
    assert wrinkles(face) and not wrinkles(face, View(rotation_about_y(180)))
    # Seen from the subject's left, what is drawn is on the near half of the face, left of the nose's ridge in x.
    drawn = wrinkles(face, View.preset("left"))
    nose = CANVAS_MM * View.preset("left").project(face.landmarks[30])
    assert drawn and np.concatenate(drawn)[:, 0].min() > nose[0]


@pytest.mark.parametrize("scale", [0.5, 2.0])
def test_wrinkles_stay_with_the_other_lines_wherever_the_head_stands(model, scale):
    face = model.face(expression="laugh")
    moved = face.sketch(view=View(scale=scale / CANVAS_MM, centre=np.array([0.4, 0.7])))
    for here, there in zip(face.sketch().segments, moved.segments, strict=True):
        assert here.name == there.name
        np.testing.assert_allclose(there.points, (here.points - 0.5) * scale + [0.4, 0.7], atol=2e-3)
