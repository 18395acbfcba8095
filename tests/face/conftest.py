import pytest

from sketchwidget import FaceModel


@pytest.fixture(scope="session")
def model():
    return FaceModel.load()
