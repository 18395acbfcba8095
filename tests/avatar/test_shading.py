import igl
import numpy as np
import torch

from sketchwidget.avatar.shading import harmonics, shade, vertex_normals


def test_the_basis_is_orthonormal_on_the_sphere():
    """Gauss-Legendre in height and even steps around integrate products of degree 4 exactly."""
    height, weight = np.polynomial.legendre.leggauss(8)
    turn = np.arange(16) * 2 * np.pi / 16
    z, angle = (values.ravel() for values in np.meshgrid(height, turn, indexing="ij"))
    across = np.sqrt(1 - z**2)
    normals = np.stack([across * np.cos(angle), across * np.sin(angle), z], axis=1)
    values = harmonics(torch.tensor(normals)).numpy()
    area = np.repeat(weight, 16) * 2 * np.pi / 16
    assert np.allclose(values.T @ (area[:, None] * values), np.eye(9), atol=1e-5)


def test_constant_light_shows_the_albedo():
    albedo = torch.rand(5, 3)
    light = torch.zeros(9)
    light[0] = 1 / 0.282095
    assert torch.allclose(shade(albedo, torch.nn.functional.normalize(torch.randn(5, 3)), light), albedo, atol=1e-5)


def test_normals_are_those_of_libigl(model):
    vertices, faces = model.mean.astype(np.float64), model.faces.astype(np.int64)
    expected = np.asarray(igl.per_vertex_normals(vertices, faces, igl.PER_VERTEX_NORMALS_WEIGHTING_TYPE_AREA))
    found = vertex_normals(torch.from_numpy(vertices), torch.from_numpy(faces)).numpy()
    assert np.allclose(found, expected, atol=1e-6)
