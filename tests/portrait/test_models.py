import hashlib
import zipfile

import pytest
from typer.testing import CliRunner

from sketchwidget.cli import main
from sketchwidget.portrait import models


@pytest.fixture
def cache(tmp_path, monkeypatch):
    monkeypatch.setattr(models, "user_cache_path", lambda name: tmp_path / name)
    return tmp_path / "sketchwidget" / "portrait"


@pytest.fixture
def wheel(tmp_path, monkeypatch):
    """A wheel with small files in the place of the models, and the sums of these."""
    path = tmp_path / "some.whl"
    known = {}
    with zipfile.ZipFile(path, "w") as archive:
        for name, (member, _) in models.MODELS.items():
            archive.writestr(member, name)
            known[name] = (member, hashlib.sha256(name.encode()).hexdigest())
    monkeypatch.setattr(models, "MODELS", known)
    monkeypatch.setattr(models, "_WHEEL_SUM", hashlib.sha256(path.read_bytes()).hexdigest())
    return path


def test_models_of_the_wheel_are_kept(cache, wheel):
    assert models.missing() == list(models.MODELS)
    models.unpack(wheel)
    assert models.missing() == []
    assert models.path("iris_landmark").read_text() == "iris_landmark"


def test_another_wheel_is_refused(cache, wheel):
    with zipfile.ZipFile(wheel, "a") as archive:
        archive.writestr("more", "more")
    with pytest.raises(OSError, match="not the wheel"):
        models.unpack(wheel)
    assert models.missing() == list(models.MODELS)


def test_a_damaged_model_is_refused(cache, wheel):
    models.unpack(wheel)
    (cache / "iris_landmark.tflite").write_text("other")
    with pytest.raises(ValueError, match="delete it"):
        models.path("iris_landmark")


def test_a_missing_model_tells_how_to_get_it(cache):
    with pytest.raises(ValueError, match="sketchwidget models"):
        models.path("face_landmark")


def test_the_command_asks_before_it_downloads(cache, wheel, monkeypatch):
    monkeypatch.setattr(models, "fetch", lambda: models.unpack(wheel))
    refused = CliRunner().invoke(main, ["models"], input="n\n")
    assert refused.exit_code == 1 and models.missing()
    fetched = CliRunner().invoke(main, ["models", "--yes"])
    assert fetched.exit_code == 0 and not models.missing()
    assert "All portrait models" in CliRunner().invoke(main, ["models"]).output


def test_a_download_that_fails_is_a_message(cache, monkeypatch):
    monkeypatch.setattr(models, "_PACKAGE", "mediapipe==0.0.0")
    monkeypatch.setattr(models, "_WHEEL", ("--no-index",))
    result = CliRunner().invoke(main, ["models", "--yes"])
    assert result.exit_code == 1 and "could not download" in result.output
