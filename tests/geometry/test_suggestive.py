"""Suggestive contours, against surfaces whose radial curvature is known."""

import numpy as np
import pytest
import trimesh

from sketchwidget.geometry.suggestive import SuggestiveContours

Z = np.array([0.0, 0, 1])
OBLIQUE = np.array([0.48, 0.36, 0.8])
EVERYTHING = {"angle": 1.0, "least": 0.0, "peak": 0.0}


def grid(rows, columns, wrapped=False):
    """Triangles of a grid of vertices, joined to a torus if wrapped."""
    i, j = np.meshgrid(*(np.arange(n if wrapped else n - 1) for n in (rows, columns)), indexing="ij")
    a, b, c, d = (
        ((i + di) % rows * columns + (j + dj) % columns).ravel() for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1))
    )
    return np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])


def bump(height):
    """A Gaussian bump or dent of spread 10 mm in a plate, seen from above: its slope is steepest at 10 mm."""
    x, y = np.meshgrid(np.linspace(-40, 40, 81), np.linspace(-40, 40, 81), indexing="ij")
    z = height * np.exp(-(x**2 + y**2) / 200)
    return np.stack([x, y, z], axis=-1).reshape(-1, 3), grid(81, 81)


def torus(ring=30.0, tube=10.0):
    u, t = np.meshgrid(np.arange(160) * np.pi / 80, np.arange(80) * np.pi / 40, indexing="ij")
    radius = ring + tube * np.cos(t)
    vertices = np.stack([radius * np.cos(u), radius * np.sin(u), tube * np.sin(t)], axis=-1).reshape(-1, 3)
    return vertices, grid(160, 80, wrapped=True)


def torus_curvature(points, direction, ring=30.0, tube=10.0):
    """Euler's formula, with the curvatures of the tube and of the ring."""
    u = np.arctan2(points[:, 1], points[:, 0])
    t = np.arctan2(points[:, 2], np.hypot(points[:, 0], points[:, 1]) - ring)
    along_tube = np.stack([-np.sin(t) * np.cos(u), -np.sin(t) * np.sin(u), np.cos(t)], axis=1) @ direction
    along_ring = np.stack([-np.sin(u), np.cos(u), 0 * u], axis=1) @ direction
    around = np.cos(t) / (ring + tube * np.cos(t))
    return (along_tube**2 / tube + along_ring**2 * around) / (along_tube**2 + along_ring**2)


def everywhere(vertices):
    return np.ones(len(vertices), dtype=bool)


def radial_curvature(vertices, faces, direction):
    """The curvature (n,), 1/mm, and how it grows towards the viewer, 1/mm^2; NaN where the direction is the normal."""
    bend, slope, sine = SuggestiveContours(faces, everywhere(vertices))._bend(vertices, direction)
    square = np.where(sine > 1e-6, sine, np.nan) ** 2
    return bend / square, slope / square


def test_a_sphere_bends_alike_everywhere_and_has_no_suggestive_contour():
    ball = trimesh.creation.icosphere(subdivisions=4, radius=50)
    contours = SuggestiveContours(ball.faces, everywhere(ball.vertices))
    curvature, _ = radial_curvature(ball.vertices, ball.faces, OBLIQUE)
    sideways = np.abs(ball.vertices @ OBLIQUE) < 45  # the direction has little to project in the middle
    np.testing.assert_allclose(curvature[sideways], 1 / 50, rtol=0.06)
    assert contours(ball.vertices, OBLIQUE, **EVERYTHING) == []


def test_radial_curvature_of_a_torus_is_euler_s():
    vertices, faces = torus()
    curvature, _ = radial_curvature(vertices, faces, OBLIQUE)
    error = np.abs(curvature - torus_curvature(vertices, OBLIQUE))
    assert np.median(error) < 0.001 and np.percentile(error, 95) < 0.01  # the tube's curvature is 0.1


def test_on_a_torus_the_contours_are_where_the_radial_curvature_vanishes():
    vertices, faces = torus()
    lines = SuggestiveContours(faces, everywhere(vertices))(vertices, OBLIQUE, angle=20.0, least=0.0, peak=0.0005)
    assert lines and np.abs(torus_curvature(np.concatenate(lines), OBLIQUE)).max() < 0.01


def test_a_torus_seen_along_its_axis_has_none():
    vertices, faces = torus()
    assert SuggestiveContours(faces, everywhere(vertices))(vertices, Z, **EVERYTHING) == []


@pytest.mark.parametrize("height", [8.0, -8.0])
def test_a_bump_or_dent_has_one_closed_contour_where_its_slope_is_steepest(height):
    vertices, faces = bump(height)
    inside = np.hypot(*vertices.T[:2]) < 30
    (line,) = SuggestiveContours(faces, inside)(vertices, Z, angle=10.0, least=1e-4, peak=1e-3)
    np.testing.assert_array_equal(line[0], line[-1])
    np.testing.assert_allclose(np.hypot(*line.T[:2]), 10, atol=0.6)
    assert len(line) > 60


def test_the_curvature_grows_towards_the_viewer_on_a_contour():
    """At the steepest slope of z(r), d kr / dr = z''' / (1 + z'^2)^(3/2), and the unit w is steeper than r."""
    vertices, faces = bump(8.0)
    _, derivative = radial_curvature(vertices, faces, Z)
    steepest = np.abs(np.hypot(*vertices.T[:2]) - 10) < 0.2
    slope, third = 0.8 * np.exp(-0.5), 0.016 * np.exp(-0.5)
    np.testing.assert_allclose(derivative[steepest], third / (1 + slope**2) ** 2, rtol=0.15)


def test_thresholds_leave_out_what_faces_the_viewer_and_what_is_weak():
    vertices, faces = bump(8.0)  # nowhere steeper than 26 degrees
    contours = SuggestiveContours(faces, np.hypot(*vertices.T[:2]) < 30)
    assert len(contours(vertices, Z, angle=20.0, least=1e-4, peak=1e-3)) == 1
    assert contours(vertices, Z, angle=30.0, least=1e-4, peak=1e-3) == []
    assert contours(vertices, Z, angle=20.0, least=1e-4, peak=0.1) == []


def test_lines_stay_in_the_region():
    vertices, faces = bump(8.0)
    region = (vertices[:, 0] > 0) & (np.hypot(*vertices.T[:2]) < 30)
    (line,) = SuggestiveContours(faces, region)(vertices, Z, angle=10.0, least=1e-4, peak=1e-3)
    assert line[:, 0].min() > 0 and abs(np.ptp(line[:, 1]) - 20) < 1
    with pytest.raises(ValueError, match="region has none"):
        SuggestiveContours(faces, np.zeros(len(vertices), dtype=bool))
