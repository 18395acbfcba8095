"""Light on skin: a Lambertian surface under low-frequency light, as spherical harmonics."""

from __future__ import annotations

import torch

# Of the real spherical harmonics up to degree 2, in the order 1, y, z, x, xy, yz, 3 z^2 - 1, xz, x^2 - y^2.
_FACTORS = (0.282095, 0.488603, 0.488603, 0.488603, 1.092548, 1.092548, 0.315392, 1.092548, 0.546274)


def harmonics(normals: torch.Tensor) -> torch.Tensor:
    """The nine basis functions (..., 9) at unit normals (..., 3): the phi_k of section 3.1.2.

    References
    ----------
    Ramamoorthi and Hanrahan, "An efficient representation for irradiance environment maps", 2001.
    """
    x, y, z = normals.unbind(-1)
    values = (torch.ones_like(x), y, z, x, x * y, y * z, 3 * z * z - 1, x * z, x * x - y * y)
    return torch.stack([factor * value for factor, value in zip(_FACTORS, values, strict=True)], dim=-1)


def shade(albedo: torch.Tensor, normals: torch.Tensor, light: torch.Tensor) -> torch.Tensor:
    """Colour (..., n, 3) of vertices with an albedo (..., n, 3) and unit normals (..., n, 3) under a light (..., 9)."""
    return albedo * (harmonics(normals) @ light[..., None])


def vertex_normals(vertices: torch.Tensor, faces: torch.Tensor) -> torch.Tensor:
    """Unit normals (..., n, 3) of vertices (..., n, 3), the faces about each weighted by their area."""
    a, b, c = vertices[..., faces, :].unbind(-2)
    across = torch.linalg.cross(b - a, c - a)
    normals = torch.zeros_like(vertices)
    normals = normals.index_add(-2, faces.flatten(), across.repeat_interleave(3, dim=-2))
    return torch.nn.functional.normalize(normals, dim=-1)
