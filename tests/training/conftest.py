import pytest
import torch
from threadpoolctl import threadpool_limits

from sketchwidget.database.database import FaceDatabase
from sketchwidget.training.pipeline import Pipeline


@pytest.fixture(scope="session")
def database(folder_beyond_its_model):
    """Three identities in three expressions; the model knows two of them."""
    return FaceDatabase.open(folder_beyond_its_model)


@pytest.fixture(scope="session")
def pipeline(database, tmp_path_factory):
    return Pipeline(database, tmp_path_factory.mktemp("work"))


@pytest.fixture(autouse=True)
def one_thread():
    """What is small gains nothing from a second one, and loses much to it on a busy machine."""
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    with threadpool_limits(1):
        yield
    torch.set_num_threads(threads)
