import numpy as np
import pytest
from scipy.optimize import minimize

from sketchwidget.caricature import Camera
from sketchwidget.caricature.problem import Problem


@pytest.fixture(scope="module")
def problem(head, drawn, model):
    return Problem(head.space, head.rows(model.landmarks[17:]), drawn[1][17:], np.linspace(20, 80, 51))


@pytest.fixture(scope="module")
def weights(head):
    return 0.2 * np.random.default_rng(0).normal(size=(2, head.space.size))


def whole_energy(problem, head, model, drawn, camera, weights, vertices):
    """Equation 14 as it is written, the translation chosen best."""
    seen = (head.rows(model.landmarks[17:]) @ vertices) @ camera.rotation[:2].T
    missed = seen - drawn[1][17:] * [1, -1] / camera.scale
    strengths = np.linspace(20, 80, 51)
    missed -= np.average(missed, axis=0, weights=strengths)
    deformation = head.representation.energy(vertices, head.space.gradients(weights))
    return deformation + strengths @ (missed**2).sum(axis=1)


def test_no_other_vertices_are_better(problem, head, model, drawn, camera, weights):
    vertices = problem.vertices(weights, camera)
    least = whole_energy(problem, head, model, drawn, camera, weights, vertices)
    assert problem.energy(weights, camera) == pytest.approx(least)
    random = np.random.default_rng(1)
    places = head.rows(model.landmarks[17:]).toarray().sum(axis=0) > 0
    for _ in range(5):
        for change in (random.normal(size=vertices.shape), places[:, None] * random.normal(size=vertices.shape)):
            slope = (
                whole_energy(problem, head, model, drawn, camera, weights, vertices + 1e-3 * change)
                - whole_energy(problem, head, model, drawn, camera, weights, vertices - 1e-3 * change)
            ) / 2e-3
            assert abs(slope) < 1e-4 * least


def test_normal_equations_are_those_of_the_energy_with_vertices_following(problem, camera, weights):
    normal, gradient = problem.normal_equations(weights, camera)
    random = np.random.default_rng(2)
    for _ in range(3):
        change = random.normal(size=weights.shape)
        up, here, down = (problem.energy(weights + step * change, camera) for step in (1e-3, 0, -1e-3))
        assert (up - down) / 2e-3 == pytest.approx(2 * gradient @ change.ravel(), rel=1e-3)
        # Gauss-Newton leaves out what is curved in the gradients themselves.
        curvature = (up - 2 * here + down) / 1e-6
        assert change.ravel() @ normal @ change.ravel() == pytest.approx(curvature / 2, rel=0.3)


def test_each_step_lowers_the_energy(problem, head, camera):
    turned = Camera(camera.scale * 1.1, camera.rotation, camera.translation)
    start = np.zeros((2, head.space.size))
    energies = [problem.energy(start, turned)]
    found = problem.camera(start, turned)
    energies.append(problem.energy(start, found))
    energies.append(problem.energy(problem.weights(start, found, 1), found))
    energies.append(problem.energy(problem.weights(start, found, 3), found))
    assert (np.diff(energies) < 0).all()


def test_no_other_scale_is_better(problem, head, camera):
    start = np.zeros((2, head.space.size))
    found = problem.camera(start, camera)

    def energy(logarithm):
        return problem.energy(start, Camera(found.scale * np.exp(float(logarithm[0])), found.rotation, np.zeros(2)))

    assert energy([0.0]) <= minimize(energy, [0.0], method="Nelder-Mead").fun * (1 + 1e-6)
