import igl
import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from sketchwidget.geometry.deformation_representation import Deformation, DeformationRepresentation, polar

SPHERE = trimesh.creation.icosphere(subdivisions=2)
VERTICES, FACES = np.array(SPHERE.vertices), np.array(SPHERE.faces)
BALL = DeformationRepresentation(VERTICES, FACES)

# A tetrahedron with a right corner: all about vertex 0, whose edges are the axes.
CORNER = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
CORNER_FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])


def bent(vertices, by=1.0):
    """Turned about y, the more so the higher."""
    angle = by * vertices[:, 1]
    cos, sin = np.cos(angle), np.sin(angle)
    x, y, z = vertices.T
    return np.stack([cos * x + sin * z, y, -sin * x + cos * z], axis=1)


def test_gradient_of_one_corner_by_hand():
    """Edges along the axes doubled, kept and halved: whatever the weights, the gradient is that diagonal."""
    representation = DeformationRepresentation(CORNER, CORNER_FACES)
    gradients = representation.gradients(CORNER * [2.0, 1.0, 0.5])
    np.testing.assert_allclose(gradients, np.tile(np.diag([2.0, 1.0, 0.5]), (4, 1, 1)), atol=1e-7)
    deformation = polar(gradients)
    np.testing.assert_allclose(deformation.rotations, 0.0, atol=1e-7)
    np.testing.assert_allclose(deformation.stretches[0], np.diag([1.0, 0.0, -0.5]), atol=1e-7)


def test_a_quarter_turn_by_hand():
    turn = np.array([[[0.0, -2, 0], [1, 0, 0], [0, 0, 1]]])
    deformation = polar(turn)
    np.testing.assert_allclose(deformation.rotations, [[0, 0, np.pi / 2]], atol=1e-12)
    np.testing.assert_allclose(deformation.stretches[0], np.diag([0.0, 1.0, 0.0]), atol=1e-12)
    np.testing.assert_allclose(deformation.gradients, turn, atol=1e-12)


def test_a_mirror_image_has_a_proper_rotation_and_a_negative_stretch():
    deformation = polar(np.diag([1.0, 1.0, -0.5])[None])
    assert np.linalg.det(deformation.turns[0]) == pytest.approx(1.0)
    np.testing.assert_allclose(deformation.gradients[0], np.diag([1.0, 1.0, -0.5]), atol=1e-12)


def test_weights_are_igls_cotangents_where_triangles_are_acute():
    np.testing.assert_allclose(
        BALL.laplacian.toarray(), -igl.cotmatrix(VERTICES, FACES.astype(np.int64)).toarray(), atol=1e-12
    )


def test_no_deformation_is_zero():
    deformation = BALL.encode(VERTICES)
    assert np.abs(deformation.rotations).max() < 1e-7 and np.abs(deformation.stretches).max() < 1e-7
    np.testing.assert_allclose(BALL.reconstruct(np.tile(np.eye(3), (len(VERTICES), 1, 1))), VERTICES, atol=1e-12)


@given(st.integers(0, 2**32 - 1))
def test_affine_maps_come_back_exactly(seed):
    linear = np.eye(3) + 0.5 * np.random.default_rng(seed).normal(size=(3, 3))
    mapped = VERTICES @ linear.T
    gradients = BALL.gradients(mapped)
    np.testing.assert_allclose(gradients, np.broadcast_to(linear, gradients.shape), atol=1e-6)
    back = BALL.reconstruct(gradients)
    np.testing.assert_allclose(back - back[0], mapped - mapped[0], atol=1e-6)


def test_a_flat_mesh_stays_well_posed():
    x, y = np.meshgrid(np.arange(4.0), np.arange(4.0))
    flat = np.stack([x.ravel(), y.ravel(), np.zeros(16)], axis=1)
    quads = np.array([[i, i + 1, i + 5, i + 4] for i in range(11) if i % 4 != 3])
    faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    representation = DeformationRepresentation(flat, faces)
    linear = np.array([[1.5, 0.2, 0.3], [0, 0.8, 0.1], [0.4, 0, 1.2]])
    gradients = representation.gradients(flat @ linear.T)
    np.testing.assert_allclose(gradients[:, :, 2], np.tile([0, 0, 1.0], (16, 1)), atol=1e-6)
    back = representation.reconstruct(gradients)
    np.testing.assert_allclose(back - back[0], flat @ linear.T, atol=1e-6)


@given(st.integers(0, 2**32 - 1))
def test_rigid_motion_changes_nothing(seed):
    random = np.random.default_rng(seed)
    turn = Rotation.random(rng=random).as_matrix()
    still = BALL.encode(bent(VERTICES))
    moved = BALL.encode(bent(VERTICES) @ turn.T + random.normal(size=3))
    np.testing.assert_allclose(moved.rotations, still.rotations, atol=1e-7)
    np.testing.assert_allclose(moved.stretches, still.stretches, atol=1e-7)


def test_reconstruction_minimises_the_energy():
    """Against a dense solution of the least squares over all edges, both ways (equation 7)."""
    representation = DeformationRepresentation(VERTICES * [1, 1.3, 0.8], FACES)
    reference = representation.reference
    gradients = np.eye(3) + 0.3 * np.random.default_rng(1).normal(size=(len(reference), 3, 3))
    weights = -np.triu(representation.laplacian.toarray(), 1)
    start, end = np.nonzero(weights)
    rows, wanted = [], []
    for i, j in [*zip(start, end, strict=True), *zip(end, start, strict=True)]:
        row = np.zeros(len(reference))
        root = np.sqrt(max(weights[i, j], weights[j, i]))
        row[i], row[j] = root, -root
        rows.append(row)
        wanted.append(root * gradients[i] @ (reference[i] - reference[j]))
    rows, wanted = np.array(rows), np.array(wanted)
    pinned = wanted - np.outer(rows[:, 0], reference[0])
    solved = np.linalg.lstsq(rows[:, 1:], pinned, rcond=None)[0]
    ours = representation.reconstruct(gradients)
    np.testing.assert_allclose(ours[1:], solved, atol=1e-8)
    np.testing.assert_array_equal(ours[0], reference[0])
    assert representation.energy(ours, gradients) == pytest.approx(((rows @ ours - wanted) ** 2).sum())


def test_bends_extrapolate_as_turns():
    """Twice the bend of a bar is the bar bent twice as far; twice its displacements is far from it."""
    ball = trimesh.creation.icosphere(subdivisions=3)
    vertices = np.array(ball.vertices) * [0.5, 0.5, 4.0]
    representation = DeformationRepresentation(vertices, np.array(ball.faces))

    def arc(angle):
        radius, along = 8 / angle, vertices[:, 2] * angle / 8
        across = radius + vertices[:, 0]
        return np.stack([across * np.cos(along) - radius, vertices[:, 1], across * np.sin(along)], axis=1)

    once, twice = (representation.aligned(arc(angle)) for angle in (1.2, 2.4))
    deformation = representation.encode(once)
    doubled = Deformation(2 * deformation.rotations, 2 * deformation.stretches)
    error, linear = (
        np.linalg.norm(representation.aligned(mesh) - twice, axis=1).mean()
        for mesh in (representation.reconstruct(doubled.gradients), 2 * once - vertices)
    )
    assert error < 0.25 * linear


def test_bad_input_is_refused():
    with pytest.raises(ValueError, match="triangles with area; 1 have none"):
        DeformationRepresentation(np.zeros((3, 3)), np.array([[0, 1, 2]]))
    two = np.concatenate([CORNER, CORNER + 5]), np.concatenate([CORNER_FACES, CORNER_FACES + 4])
    with pytest.raises(ValueError, match="one piece"):
        DeformationRepresentation(*two)
    with pytest.raises(ValueError, match=r"\(162, 3\); given shape \(3, 3\)"):
        BALL.encode(np.zeros((3, 3)))
    with pytest.raises(ValueError, match=r"finite vertices \(162, 3\); given \[nan, nan, nan\] as vertex 0"):
        BALL.encode(np.full(VERTICES.shape, np.nan))
