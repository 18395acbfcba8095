import pytest
import torch

from sketchwidget import FaceModel
from sketchwidget.database.database import FaceDatabase
from sketchwidget.training.pipeline import Pipeline


@pytest.fixture(scope="session")
def model():
    """The shipped one."""
    return FaceModel.load()


@pytest.fixture(scope="session")
def database(folder_beyond_its_model):
    """Three identities in three expressions; the model knows two of them."""
    return FaceDatabase.open(folder_beyond_its_model)


@pytest.fixture(scope="session")
def pipeline(database, tmp_path_factory):
    return Pipeline(database, tmp_path_factory.mktemp("work"))


@pytest.fixture(autouse=True)
def one_thread():
    """Small networks gain nothing from a second one, and lose much to it on a busy machine."""
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    yield
    torch.set_num_threads(threads)
