"""Weights refined by the lines of a drawing."""

import numpy as np
import pytest

from sketchwidget.inference import refinement
from sketchwidget.inference.framing import Frame
from sketchwidget.inference.matching import PLACES, DrawnLines
from sketchwidget.inference.refinement import LineRefiner
from sketchwidget.inference.shape_code import COUNTS, split_lines
from sketchwidget.sketch import SILHOUETTE
from sketchwidget.training.standard import standardisation


@pytest.fixture(scope="module")
def refiner(model):
    return LineRefiner(model, standardisation(model))


def drawn(refiner, identity, expression):
    """A head's lines as a normalised drawing."""
    points = refiner.lines(identity, expression)
    lines = split_lines(Frame.of_outline(points[: COUNTS[SILHOUETTE]])(points))
    closed = np.concatenate([lines[SILHOUETTE], lines[SILHOUETTE][:1]])
    lines |= {SILHOUETTE: closed}
    return DrawnLines(list(lines.values()), list(lines)).match


def weights(model, person, expression):
    return model.bilinear.identities[person], model.expression_weights(expression)


def test_lines_are_the_projected_handles(model, refiner):
    face = model.face(*weights(model, 5, "smile"))
    nose = split_lines(refiner.lines(face.identity, face.expression))["nose"]
    handle = face.curve("nose")[:, :2] / 250 * [1, -1] + 0.5
    assert np.abs(nose - handle[np.rint(np.linspace(0, len(handle) - 1, len(nose))).astype(int)]).max() < 1e-4


def test_a_head_whose_lines_are_drawn_stays_what_it_is(model, refiner):
    u, v = weights(model, 8, "neutral")
    found = refiner(u, v, drawn(refiner, u, v))
    moved = model.face(*found).vertices - model.face(u, v).vertices
    assert np.linalg.norm(moved, axis=1).mean() < 0.3


@pytest.mark.parametrize("expression", ["smile", "mouth_open", "surprise"])
def test_a_guess_comes_nearer_to_the_drawn_head(model, refiner, expression):
    u, v = weights(model, 12, expression)
    start = (u, 0.2 * v + 0.8 * weights(model, 12, "neutral")[1])
    truth = model.face(u, v)

    def error(found):
        return np.linalg.norm(model.face(*found).vertices - truth.vertices, axis=1).mean()

    assert error(refiner(*start, drawn(refiner, u, v))) < 0.8 * error(start)


def test_nothing_drawn_changes_nothing(model, refiner):
    u, v = weights(model, 3, "neutral")
    found = refiner(u, v, DrawnLines([], []).match)
    np.testing.assert_array_equal(found[0], u)
    np.testing.assert_array_equal(found[1], v)


def test_a_moved_drawing_moves_no_vertex_far(model, refiner):
    """A view offset is one of the unknowns: place and size of the drawing do not become shape."""
    u, v = weights(model, 20, "neutral")
    points = refiner.lines(u, v)
    moved = split_lines(1.02 * (Frame.of_outline(points[: COUNTS[SILHOUETTE]])(points) - 0.5) + 0.5 + [0.01, -0.006])
    found = refiner(u, v, DrawnLines(list(moved.values()), list(moved)).match)
    assert np.linalg.norm(model.face(*found).vertices - model.face(u, v).vertices, axis=1).mean() < 1.2


def test_errors_of_a_feature_count_as_its_covariance_says():
    """A feature is misplaced as a whole, and each of its points besides."""
    at = PLACES["mouth"]
    apart, together = refinement._MISDRAWN, refinement._MISPLACED
    covariance = apart**2 * np.eye(len(at)) + together**2
    weight = np.zeros(sum(COUNTS.values()))
    weight[at] = 1.0
    error = np.random.default_rng(0).normal(0, 0.01, (len(weight), 2))
    expected = sum(axis @ np.linalg.solve(covariance, axis) for axis in error[at].T)
    assert refinement._normal_matrix(error[..., None], weight).item() == pytest.approx(expected)


def test_a_feature_that_is_not_drawn_keeps_its_shape(model, refiner):
    u, v = weights(model, 8, "neutral")
    jowls = split_lines(refiner.lines(model.bilinear.identities[31], v))[SILHOUETTE]
    found = refiner(u, v, DrawnLines([Frame.of_outline(jowls)(jowls)], [SILHOUETTE]).match)
    before, after = (split_lines(refiner.lines(*given)) for given in ((u, v), found))

    def gap(lines):
        return np.abs(lines["mouth_upper"] - lines["mouth_lower"]).max()

    assert np.abs(after[SILHOUETTE] - before[SILHOUETTE]).max() > 0.01
    assert abs(gap(after) - gap(before)) < 0.003
