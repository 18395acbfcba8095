import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sketchwidget.avatar.template import AvatarTemplate
from sketchwidget.geometry.camera import Camera
from sketchwidget.geometry.view import View
from sketchwidget.portrait import models


@pytest.fixture(scope="session", autouse=True)
def no_models(tmp_path_factory):
    """As on a bare machine, whatever this one has in its cache."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(models, "user_cache_path", lambda name: tmp_path_factory.getbasetemp() / "no models" / name)
        yield


@pytest.fixture(scope="session")
def template():
    return AvatarTemplate.load()


@pytest.fixture(scope="session")
def camera():
    """A camera that sees a head a little from the side, in a picture of 512 pixels."""
    turn = Rotation.from_euler("yxz", [8, -4, 3], degrees=True).as_matrix()
    return Camera(1.7, turn, np.array([256.0, 250.0]))


@pytest.fixture(scope="session")
def portrait(model):
    """A picture of a smiling head of the model, its landmarks in pixels, and the head."""
    head = model.face(identity=model.bilinear.identities[3], expression="smile")
    view = View(scale=1 / 300)
    return head.picture(view, 640), view.project(head.landmarks) * 640, head


@pytest.fixture(scope="session")
def avatar(portrait):
    from sketchwidget.avatar import build

    image, landmarks, _ = portrait
    return build(image, landmarks)
