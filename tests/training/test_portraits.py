from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import sketchwidget
from sketchwidget import FaceModel
from sketchwidget.avatar.coarse import CoarseFitter
from sketchwidget.avatar.network import PortraitNetwork
from sketchwidget.avatar.template import AvatarTemplate
from sketchwidget.cli import main
from sketchwidget.training.portrait_network import train_portrait_network
from sketchwidget.training.portraits import render_portrait


@pytest.fixture(scope="module")
def model():
    return FaceModel.load()


@pytest.fixture(scope="module")
def template():
    return AvatarTemplate.load()


def test_a_number_gives_one_portrait(model, template):
    one, again, other = (render_portrait(model, template, seed, side=96) for seed in (1, 1, 2))
    assert np.array_equal(one.image, again.image) and not np.array_equal(one.image, other.image)
    assert np.allclose(one.camera.project(one.vertices[model.landmarks]), one.landmarks)
    inside = one.landmarks[27:].astype(int)
    assert one.mask[inside[:, 1], inside[:, 0]].all() and 0.1 < one.mask.mean() < 0.9


def test_training_brings_landmarks_nearer(model, template):
    network, errors = train_portrait_network(model, template, steps=36, batch=2, channels=(8, 16, 24), variety=2)
    assert np.mean(errors[-4:]) < 0.6 * np.mean(errors[:4])
    fit = network.predict(render_portrait(model, template, 999, side=448).image, CoarseFitter(model, template))
    assert fit.vertices.shape == template.neutral.shape and 1.0 < fit.camera.scale < 2.5


def test_the_command_writes_what_is_read_back(model, tmp_path):
    path = tmp_path / "portraits.safetensors"
    result = CliRunner().invoke(main, ["train", "portraits", "--tiny", "--out", str(path)])
    assert result.exit_code == 0, result.output
    network = PortraitNetwork.load(path, model)
    assert network.channels == (8, 8, 16)
    with pytest.raises(ValueError, match="its format"):
        PortraitNetwork.load(Path(sketchwidget.__file__).parent / "data" / "avatar.safetensors", model)
