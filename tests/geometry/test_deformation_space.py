import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from sketchwidget.geometry.deformation_representation import DeformationRepresentation
from sketchwidget.geometry.deformation_space import DeformationSpace
from sketchwidget.geometry.levenberg_marquardt import levenberg_marquardt

SPHERE = trimesh.creation.icosphere(subdivisions=3)
VERTICES, FACES = np.array(SPHERE.vertices), np.array(SPHERE.faces)
REPRESENTATION = DeformationRepresentation(VERTICES, FACES)


def bent(by):
    """Turned about y, the more so the higher."""
    turns = Rotation.from_rotvec(VERTICES[:, 1:2] * [0, by, 0])
    return turns.apply(VERTICES)


PEAR = VERTICES * (1 + 0.3 * VERTICES[:, 1:2])
SPACE = DeformationSpace(REPRESENTATION, [bent(0.6), PEAR])

weight_pairs = st.lists(st.floats(-1.5, 1.5), min_size=4, max_size=4).map(lambda four: np.reshape(four, (2, 2)))


def test_zero_weights_give_the_reference():
    np.testing.assert_allclose(SPACE.vertices(np.zeros((2, 2))), VERTICES, atol=1e-10)


@pytest.mark.parametrize("number", [0, 1])
def test_unit_weights_give_the_example(number):
    weights = np.zeros((2, 2))
    weights[:, number] = 1
    target = REPRESENTATION.aligned([bent(0.6), PEAR][number])
    error = np.linalg.norm(REPRESENTATION.aligned(SPACE.vertices(weights)) - target, axis=1)
    assert np.sqrt((error**2).mean()) < 0.005  # of a radius; on a head 100 mm in radius, 0.5 mm


def test_an_example_that_is_affine_comes_back_exactly():
    linear = np.array([[1.5, 0.2, 0.3], [0, 0.8, 0.1], [0.4, 0, 1.2]])
    space = DeformationSpace(REPRESENTATION, [VERTICES @ linear.T])
    target = REPRESENTATION.aligned(VERTICES @ linear.T)
    back = space.vertices(np.ones((2, 1)))
    np.testing.assert_allclose(back - back.mean(axis=0), target - target.mean(axis=0), atol=1e-6)


def test_rotation_and_stretch_weights_are_separate():
    """A turn without its stretches keeps lengths; a stretch without its turns keeps directions."""
    space = DeformationSpace(REPRESENTATION, [VERTICES * [1, 2, 1]])
    np.testing.assert_allclose(space.vertices(np.array([[1.0], [0.0]])), VERTICES, atol=1e-6)
    stretched = space.vertices(np.array([[0.0], [0.5]]))
    np.testing.assert_allclose(stretched - stretched[0], (VERTICES - VERTICES[0]) * [1, 1.5, 1], atol=1e-6)


@given(weight_pairs)
@settings(max_examples=20)
def test_analytic_and_numeric_jacobians_agree(weights):
    analytic = SPACE.jacobian(weights)
    step = 1e-6
    for kind in range(2):
        for number in range(2):
            change = np.zeros((2, 2))
            change[kind, number] = step
            numeric = (SPACE.gradients(weights + change) - SPACE.gradients(weights - change)) / (2 * step)
            np.testing.assert_allclose(analytic[..., kind, number], numeric, atol=1e-7)


def test_jacobian_at_no_rotation():
    """Where the formula is 0 / 0."""
    change = np.zeros((2, 2))
    change[0, 0] = 1e-6
    numeric = (SPACE.gradients(change) - SPACE.gradients(-change)) / 2e-6
    np.testing.assert_allclose(SPACE.jacobian(np.zeros((2, 2)))[..., 0, 0], numeric, atol=1e-9)


def test_normal_equations_are_those_of_the_energy():
    weights = np.array([[0.4, -0.2], [0.3, 0.6]])
    normal, gradient, by_weights = SPACE.normal_equations(weights, PEAR)
    numeric = np.zeros(4)
    for index in range(4):
        change = np.zeros(4)
        change[index] = 1e-5
        up, down = (
            REPRESENTATION.energy(PEAR, SPACE.gradients(weights + sign * change.reshape(2, 2))) for sign in (1, -1)
        )
        numeric[index] = (up - down) / 2e-5
    np.testing.assert_allclose(2 * gradient, numeric, rtol=1e-5)
    full = np.einsum("nija,njk,nikb->ab", by_weights, REPRESENTATION.covariance, by_weights)
    np.testing.assert_allclose(normal, full, rtol=1e-4, atol=1e-4)


def weights_of(mesh):
    """Weights (2, 2) of a mesh, brought onto the reference (equation 9)."""
    mesh = REPRESENTATION.aligned(mesh)
    return levenberg_marquardt(
        lambda flat: REPRESENTATION.energy(mesh, SPACE.gradients(flat.reshape(2, 2))),
        lambda flat: SPACE.normal_equations(flat.reshape(2, 2), mesh)[:2],
        np.zeros(4),
    ).reshape(2, 2)


@given(weight_pairs)
@settings(max_examples=10)
def test_no_other_weights_are_nearer_to_a_mesh(weights):
    """Against SciPy's Levenberg-Marquardt on all edges, one residual for each coordinate of each."""
    mesh = REPRESENTATION.aligned(SPACE.vertices(weights))
    found = weights_of(mesh)
    lower = np.linalg.cholesky(REPRESENTATION.covariance)
    wanted = np.linalg.solve(lower, REPRESENTATION.spread(mesh).swapaxes(1, 2)).swapaxes(1, 2)

    def residuals(flat):
        return (SPACE.gradients(flat.reshape(2, 2)) @ lower - wanted).ravel()

    independent = least_squares(residuals, np.zeros(4), method="lm").x
    ours, theirs = (REPRESENTATION.energy(mesh, SPACE.gradients(each)) for each in (found, independent.reshape(2, 2)))
    assert ours <= theirs * (1 + 1e-4) + 1e-9


@pytest.mark.parametrize("number", [0, 1])
def test_weights_of_an_example_are_its_unit_weights(number):
    wanted = np.zeros((2, 2))
    wanted[:, number] = 1
    turn = Rotation.from_rotvec([0.3, 0.5, -0.2])
    moved = turn.apply([bent(0.6), PEAR][number]) + np.array([1, 2, 3])
    np.testing.assert_allclose(weights_of(moved), wanted, atol=0.03)


def test_bad_input_is_refused():
    with pytest.raises(ValueError, match="at least one example"):
        DeformationSpace(REPRESENTATION, [])
    with pytest.raises(ValueError, match=r"\(2, 2\)"):
        SPACE.vertices(np.zeros(4))
    with pytest.raises(ValueError, match="finite"):
        SPACE.vertices(np.full((2, 2), np.inf))
