"""Deformation transfer, after Sumner and Popovic 2004."""

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from sketchwidget.geometry.deformation_transfer import DeformationTransfer, deformation_gradients

SPHERE = trimesh.creation.icosphere(subdivisions=2)
VERTICES, FACES = np.array(SPHERE.vertices), np.array(SPHERE.faces)
HELD = VERTICES[:, 2] < -0.5


def smooth_pose(vertices):
    """A bend of the upper part, none below."""
    return vertices + np.maximum(vertices[:, 2:] + 0.5, 0) ** 2 * [0.3, 0.1, 0.2]


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=20)
def test_gradients_of_an_affine_map_are_its_linear_part(seed):
    """In the triangle's plane; its normal is mapped to the new normal, so a rotation with scale comes back whole."""
    linear = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    linear *= np.sign(np.linalg.det(linear))
    gradients = deformation_gradients(VERTICES, 4.0 * VERTICES @ linear.T, FACES)
    scale = np.linalg.norm(gradients, axis=(1, 2))
    edges = np.stack([VERTICES[FACES[:, 1]] - VERTICES[FACES[:, 0]]], axis=-1)
    np.testing.assert_allclose(gradients @ edges, 4.0 * linear @ edges, atol=1e-9)
    assert np.ptp(scale) < 1e-9


def test_source_as_target_gives_back_the_pose():
    posed = smooth_pose(VERTICES)
    transfer = DeformationTransfer(VERTICES, FACES, HELD)
    np.testing.assert_allclose(transfer(deformation_gradients(VERTICES, posed, FACES)), posed, atol=1e-9)


def test_no_pose_leaves_any_target_at_rest_and_held_vertices_never_move():
    target = VERTICES * [1.0, 1.5, 0.8]
    transfer = DeformationTransfer(target, FACES, HELD)
    np.testing.assert_allclose(transfer(np.broadcast_to(np.eye(3), (len(FACES), 3, 3))), target, atol=1e-9)
    posed = transfer(deformation_gradients(VERTICES, smooth_pose(VERTICES), FACES))
    np.testing.assert_array_equal(posed[HELD], target[HELD])
    assert np.abs(posed - target).max() > 0.1


def test_many_poses_at_once_equal_one_by_one():
    target = VERTICES * [1.0, 1.5, 0.8]
    transfer = DeformationTransfer(target, FACES, HELD)
    gradients = np.stack(
        [deformation_gradients(VERTICES, VERTICES + k * (smooth_pose(VERTICES) - VERTICES), FACES) for k in (0.5, 1)]
    )
    np.testing.assert_allclose(transfer(gradients), [transfer(one) for one in gradients], atol=1e-12)


def test_minimises_the_sum_with_free_fourth_vertices():
    """Against the paper's own system, whose unknowns are all vertices and a fourth one for each triangle."""
    mesh = trimesh.creation.icosphere(subdivisions=1)
    rest, faces = np.array(mesh.vertices) * [1, 1.3, 0.9], np.array(mesh.faces)
    source = np.array(mesh.vertices)
    gradients = deformation_gradients(source, smooth_pose(source), faces)
    held = source[:, 2] < -0.5
    a, b, c = (rest[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    area = np.linalg.norm(normal, axis=1) / 2
    inverse = np.linalg.inv(np.stack([b - a, c - a, normal / np.sqrt(2 * area)[:, None]], axis=-1))
    n, m = len(rest), len(faces)
    system, wanted = np.zeros((3 * m, n + m)), np.zeros((3 * m, 3))
    for f, (i, j, k) in enumerate(faces):
        for column in range(3):  # column of the affine map: sum over edges of edge * inverse[edge, column]
            row = 3 * f + column
            for vertex, weight in ((j, inverse[f, 0]), (k, inverse[f, 1]), (n + f, inverse[f, 2])):
                system[row, vertex] += weight[column] * area[f] ** 0.5
                system[row, i] -= weight[column] * area[f] ** 0.5
            wanted[row] = gradients[f, :, column] * area[f] ** 0.5
    free = np.concatenate([~held, np.ones(m, dtype=bool)])
    right = wanted - system[:, ~free] @ rest[held]
    solved = np.linalg.lstsq(system[:, free], right, rcond=None)[0]
    ours = DeformationTransfer(rest, faces, held)(gradients)
    np.testing.assert_allclose(ours[~held], solved[: (~held).sum()], atol=1e-8)


def test_bad_input_is_refused():
    with pytest.raises(ValueError, match="triangles with area; 1 have none"):
        deformation_gradients(np.zeros((3, 3)), np.zeros((3, 3)), np.array([[0, 1, 2]]))
    with pytest.raises(ValueError, match="at least one vertex"):
        DeformationTransfer(VERTICES, FACES, np.zeros(len(VERTICES), dtype=bool))
