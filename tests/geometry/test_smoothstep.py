import numpy as np

from sketchwidget.geometry.smoothstep import smoothstep


def test_rises_from_0_to_1_without_a_bend_at_either_end():
    np.testing.assert_array_equal(smoothstep(np.array([-1.0, 2, 3, 4, 9]), 2, 4), [0, 0, 0.5, 1, 1])
    ends = np.array([1e-4, 1 - 1e-4])
    np.testing.assert_allclose(smoothstep(ends), [0, 1], atol=1e-7)
