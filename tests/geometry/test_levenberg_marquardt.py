import numpy as np
from scipy.optimize import least_squares

from sketchwidget.geometry.levenberg_marquardt import levenberg_marquardt


def rosenbrock(x):
    return np.array([10 * (x[1] - x[0] ** 2), 1 - x[0]])


def of_rosenbrock(x):
    jacobian = np.array([[-20 * x[0], 10.0], [-1.0, 0.0]])
    return jacobian.T @ jacobian, jacobian.T @ rosenbrock(x)


def test_goes_down_rosenbrocks_valley():
    found = levenberg_marquardt(lambda x: float((rosenbrock(x) ** 2).sum()), of_rosenbrock, np.array([-1.2, 1.0]), 100)
    np.testing.assert_allclose(found, least_squares(rosenbrock, [-1.2, 1.0], method="lm").x, atol=1e-3)


def test_the_cost_never_rises_and_a_minimum_is_left_where_it_is():
    costs = []

    def cost(x):
        costs.append(float((rosenbrock(x) ** 2).sum()))
        return costs[-1]

    start = np.array([1.0, 1.0])
    np.testing.assert_array_equal(levenberg_marquardt(cost, of_rosenbrock, start), start)
    assert costs[0] == min(costs)


def test_linear_least_squares_takes_one_step():
    random = np.random.default_rng(0)
    design, target = random.normal(size=(20, 3)), random.normal(size=20)
    found = levenberg_marquardt(
        lambda x: float(((design @ x - target) ** 2).sum()),
        lambda x: (design.T @ design, design.T @ (design @ x - target)),
        np.zeros(3),
    )
    np.testing.assert_allclose(found, np.linalg.lstsq(design, target, rcond=None)[0], atol=1e-6)
