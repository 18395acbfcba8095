import pytest

from sketchwidget.portrait import models


@pytest.fixture(scope="session")
def portrait_models():
    if models.missing():
        pytest.skip("the portrait models are not here: sketchwidget models --yes")
