import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sketchwidget.caricature import Camera, exaggerate, fit
from sketchwidget.caricature.fitting import deformable_head


@pytest.fixture(scope="session")
def head(model):
    return deformable_head(model)


@pytest.fixture(scope="session")
def camera():
    """A head in a picture of 400 pixels, turned a little to the side and up."""
    turn = Rotation.from_euler("YXZ", [18, -6, 4], degrees=True).as_matrix()
    return Camera(1.4, turn, np.array([200.0, 190.0]))


@pytest.fixture(scope="session")
def drawn(model, camera, head):
    """An exaggerated head and the landmarks of its picture, as a person would mark them: the jaw on its silhouette."""
    someone = model.face(model.bilinear.identities[4 * 33], "grin_open")
    caricature = exaggerate(someone, 2.0)
    landmarks = camera.project(caricature.landmarks.astype(np.float64))
    jaw = head.jaw.match(caricature.vertices, camera, landmarks[:17], np.ones(17))
    landmarks[:17] = camera.project(caricature.vertices[jaw.vertices].astype(np.float64))
    return caricature, landmarks


@pytest.fixture(scope="session")
def fitted(model, drawn):
    steps = []
    return fit(drawn[1], model=model, progress=steps.append), steps
