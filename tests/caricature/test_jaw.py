import numpy as np
from scipy.spatial.transform import Rotation

from sketchwidget.caricature import Camera


def camera_of(yaw):
    return Camera(2.0, Rotation.from_euler("y", yaw, degrees=True).as_matrix(), np.array([200.0, 200.0]))


def test_from_the_front_the_silhouette_is_symmetric_and_passes_the_landmarks(head, model):
    found = head.jaw.silhouette(model.mean, camera_of(0))
    points = model.mean[found]
    np.testing.assert_allclose(points[:, 0], -points[::-1, 0], atol=2.5)
    nearest = np.linalg.norm(points[None, :, :2] - model.mean[model.landmarks[:17], None, :2], axis=2).min(axis=1)
    assert nearest.max() < 6


def test_nothing_of_the_face_is_outside_its_silhouette(head, model):
    """On its rays; the face is turned, so that a cheek's contour is among it."""
    camera = camera_of(35)
    seen = camera.project(model.mean)
    outline = seen[head.jaw.silhouette(model.mean, camera)]
    assert outline[:, 0].max() >= seen[model.landmarks[17:], 0].max() - 1
    assert outline[:, 1].max() >= seen[model.landmarks[:17], 1].max() - 1


def test_on_a_cheek_that_is_turned_away_landmarks_move_to_the_contour(head, model):
    """The subject turns to the picture's right: the left cheek's landmarks are hidden behind its contour."""
    camera = camera_of(40)
    seen = camera.project(model.mean)
    silhouette = head.jaw.silhouette(model.mean, camera)
    far = silhouette[-20:]
    assert model.mean[far, 2].mean() > model.mean[model.landmarks[12:17], 2].mean() + 15
    assert seen[far, 0].mean() > seen[model.landmarks[12:17], 0].mean()


def test_landmarks_on_the_silhouette_are_matched_where_they_are(head, model):
    camera = camera_of(20)
    silhouette = head.jaw.silhouette(model.mean, camera)
    chosen = silhouette[np.linspace(4, 60, 17).astype(int)]
    landmarks = camera.project(model.mean[chosen])
    match = head.jaw.match(model.mean, camera, landmarks, np.ones(17))
    np.testing.assert_allclose(camera.project(model.mean[match.vertices]), landmarks, atol=12)
    assert (np.linalg.norm(camera.project(model.mean[match.vertices]) - landmarks, axis=1) < 1e-3).sum() >= 12


def test_the_outline_is_wanted_on_a_curve_through_the_landmarks_that_count(head, model):
    camera, weights = camera_of(0), np.ones(17)
    weights[8] = 0
    angle = np.linspace(-np.pi / 2, np.pi / 2, 17)
    arc = np.stack([200 + 140 * np.sin(angle), 240 + 140 * np.cos(angle)], axis=1)
    match = head.jaw.match(model.mean, camera, arc, weights)
    radius = np.linalg.norm(match.targets - [200, 240], axis=1)
    assert len(match.outline) == len(match.targets) == len(match.weights) > 30
    np.testing.assert_allclose(radius, 140, atol=2)
    # None is between the landmark that does not count and its neighbours.
    gap = (match.targets[:, 0] > arc[7, 0] + 1e-6) & (match.targets[:, 0] < arc[9, 0] - 1e-6)
    assert not gap.any()


def test_former_silhouettes_stay_held(head, model):
    camera = camera_of(0)
    landmarks = camera.project(model.mean[model.landmarks[:17]])
    first = head.jaw.match(model.mean, camera, landmarks, np.ones(17))
    wider = model.mean.copy()
    wider[:, 0] *= 1 + 0.2 * (wider[:, 2] < 30)
    second = head.jaw.match(wider, camera, landmarks, np.ones(17), first)
    assert set(second.outline) > set(head.jaw.match(wider, camera, landmarks, np.ones(17)).outline)
