from types import SimpleNamespace

import cv2
import numpy as np
import pytest

from sketchwidget.avatar.drivers import LandmarkSolver, blendshape_scores, video_performance
from sketchwidget.portrait import FaceLandmarks


def test_scores_of_the_landmarker_become_weights():
    category = SimpleNamespace(category_name="jawOpen", score=0.4)
    neutral = SimpleNamespace(category_name="_neutral", score=1.0)
    frames = list(
        blendshape_scores(
            [SimpleNamespace(face_blendshapes=[[neutral, category]]), SimpleNamespace(face_blendshapes=[])]
        )
    )
    assert frames == [{"jawOpen": 0.4}, {}]


@pytest.fixture(scope="module")
def solver(avatar):
    return LandmarkSolver(avatar.model, avatar.face.vertices, avatar.rig)


def test_a_head_at_rest_gives_no_weights(avatar, solver, camera):
    weights = solver(camera.project(avatar.face.landmarks))
    assert max(weights.values()) < 0.05


@pytest.mark.parametrize(
    "shown", [{"jawOpen": 0.6}, {"browOuterUpLeft": 0.8}, {"eyeBlinkLeft": 0.9, "eyeBlinkRight": 0.9}]
)
def test_what_is_shown_is_found_whatever_the_pose(avatar, solver, camera, shown):
    posed = avatar.pose(shown)
    weights = solver(camera.project(posed[avatar.model.landmarks]))
    for name, weight in shown.items():
        assert weights[name] > 0.5 * weight
    found = camera.project(avatar.pose(weights)[avatar.model.landmarks])
    off = np.linalg.norm(found - camera.project(posed[avatar.model.landmarks]), axis=1)
    assert off.mean() / camera.scale < 1.0  # millimetres as seen; depth a picture does not show


def test_another_performers_face_is_taken_off(avatar, camera):
    points = camera.project(avatar.face.landmarks)
    neutral = points * (1.0, 1.15)  # a longer face
    weights = LandmarkSolver(avatar.model, avatar.face.vertices, avatar.rig, neutral)(neutral)
    assert max(weights.values()) < 0.05


def test_a_video_becomes_a_performance(avatar, camera, tmp_path):
    path = tmp_path / "take.avi"
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 10, (64, 64))
    for level in (0, 120, 240):
        writer.write(np.full((64, 64, 3), level, np.uint8))
    writer.release()

    class Detector:
        def faces(self, image):
            return np.ones((int(image.mean() < 200), 4))  # no face in the last frame

        def landmarks(self, image, box):
            opened = {"jawOpen": 0.7 if image.mean() > 60 else 0.0}
            return FaceLandmarks(camera.project(avatar.pose(opened)[avatar.model.landmarks]))

    track = video_performance(path, avatar.model, avatar.face.vertices, avatar.rig, Detector())
    jaw = track.weights["jawOpen"]
    assert track.name == "take" and np.allclose(track.times, [0, 0.1, 0.2])
    assert jaw[0] < 0.05 and jaw[1] > 0.4 and jaw[2] == jaw[1]


def test_what_is_no_video_is_told(avatar, tmp_path):
    path = tmp_path / "text.mp4"
    path.write_text("no video")
    with pytest.raises(ValueError, match="no video"):
        video_performance(path, avatar.model, avatar.face.vertices, avatar.rig, None)
    with pytest.raises(FileNotFoundError):
        video_performance(tmp_path / "none.mp4", avatar.model, avatar.face.vertices, avatar.rig, None)
