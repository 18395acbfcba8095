import sys
from pathlib import Path

import pytest
from hypothesis import settings

sys.path.insert(0, str(Path(__file__).parent))

# No test is timed: a busy machine is not a bug. Every run tries the same examples;
# `--hypothesis-profile=searching` tries others.
settings.register_profile("searching", deadline=None)
settings.register_profile("repeatable", deadline=None, derandomize=True)
settings.load_profile("repeatable")


@pytest.fixture(scope="session", autouse=True)
def state_of_no_user(tmp_path_factory):
    """What Studios keep is kept elsewhere, in kernels too."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_STATE_HOME", str(tmp_path_factory.mktemp("state")))
        yield


@pytest.fixture(scope="session")
def model():
    """The shipped one; nobody changes it."""
    from sketchwidget.face import FaceModel

    return FaceModel.load()


@pytest.fixture(scope="session")
def three_expressions():
    from small_database import ThreeExpressions

    return ThreeExpressions()


@pytest.fixture(scope="session")
def small_folder(three_expressions, tmp_path_factory):
    """A database of three identities in three expressions; nobody changes it."""
    from sketchwidget.database.build import build

    out = tmp_path_factory.mktemp("built") / "faces"
    build(three_expressions, out, identities=3, interpolated=5)
    return out


@pytest.fixture(scope="session")
def folder_beyond_its_model(three_expressions, tmp_path_factory):
    """The same of a model that is made of the first two identities."""
    from sketchwidget.database import build as building

    out = tmp_path_factory.mktemp("beyond") / "faces"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(building, "MODEL_IDENTITIES", 2)
        building.build(three_expressions, out, identities=3, interpolated=5)
    return out


@pytest.fixture
def lines_restored():
    """Line kinds that a test adds are gone after it."""
    from sketchwidget.sketch import names

    tables = (names._KINDS, names.COLOURS)
    before = [dict(table) for table in tables]
    yield
    for table, kept in zip(tables, before, strict=True):
        table.clear()
        table.update(kept)
    names._ADDED.clear()
