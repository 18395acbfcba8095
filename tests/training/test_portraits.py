from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from typer.testing import CliRunner

import sketchwidget
from sketchwidget.avatar.coarse import CoarseFitter
from sketchwidget.avatar.network import PortraitNetwork
from sketchwidget.avatar.square import square_about
from sketchwidget.avatar.template import AvatarTemplate
from sketchwidget.cli import main
from sketchwidget.training.curve import read_curve
from sketchwidget.training.network import Schedule
from sketchwidget.training.portrait_network import train_portrait_network
from sketchwidget.training.portrait_set import PortraitSet
from sketchwidget.training.portraits import render_portrait


@pytest.fixture(scope="module")
def template():
    return AvatarTemplate.load()


def test_a_number_gives_one_portrait(model, template):
    one, again, other = (render_portrait(model, template, seed, side=96) for seed in (1, 1, 2))
    assert np.array_equal(one.image, again.image) and not np.array_equal(one.image, other.image)
    assert np.allclose(one.camera.project(one.vertices[model.landmarks]), one.landmarks)
    inside = one.landmarks[27:].astype(int)
    assert one.mask[inside[:, 1], inside[:, 0]].all() and 0.1 < one.mask.mean() < 0.9


@pytest.fixture(scope="module")
def fitter(model, template):
    return CoarseFitter(model, template)


@pytest.fixture(scope="module")
def portraits(model, template, fitter):
    return PortraitSet.rendered(model, template, fitter, 3)


def test_training_brings_landmarks_and_shape_nearer_and_goes_on_where_it_stopped(portraits, fitter, tmp_path):
    schedule = Schedule(40, 4, checkpoint=15, warming=5, averaging=0.5)
    network, (_, landmarks, shape) = train_portrait_network(portraits, fitter, schedule, tmp_path, (8, 16, 24))
    _, rows = read_curve(tmp_path / "curve.csv")
    assert landmarks < 0.9 * rows[0][3] and shape < rows[0][4]
    again, _ = train_portrait_network(portraits, fitter, schedule, tmp_path, (8, 16, 24))
    picture = portraits.images[0]
    one, other = (trained.predict(picture, fitter) for trained in (network, again))
    assert np.array_equal(one.vertices, other.vertices)
    assert 0.5 < one.camera.scale < 1.0
    with pytest.raises(ValueError, match="another training"):
        train_portrait_network(portraits, fitter, schedule, tmp_path, (8, 16, 24), about="of another model")


def test_varied_portraits_keep_their_landmarks(portraits):
    """Corners of eyes are where they were, however the picture was turned, wherever hair and background are."""
    picture = np.zeros_like(portraits.images)
    x, y = np.rint(portraits.landmarks[0, 45] - 0.5).astype(int)
    picture[:, y - 1 : y + 2, x - 1 : x + 2] = 255
    marked = replace(portraits, images=picture, masks=np.full_like(portraits.masks, 255))
    for seed in range(6):
        varied, head, points = marked.varied(0, np.random.default_rng(seed))
        around = np.argwhere(varied.min(axis=2) > 0.9 * varied.min(axis=2).max())
        assert np.linalg.norm(around.mean(axis=0)[::-1] + 0.5 - points[45]) < 1.5 or head[tuple(around[0])] < 1
        corner, side = square_about(points)
        assert np.abs(corner).max() < 16 and abs(side - 224) < 24


def test_a_set_is_read_as_it_was_written(portraits, tmp_path):
    portraits.save(tmp_path / "set")
    again = PortraitSet.load(tmp_path / "set")
    assert all(np.array_equal(getattr(again, name), values) for name, values in vars(portraits).items())
    assert not (tmp_path / "set.part").exists()


def test_of_several_pictures_the_loss_is_the_sum(portraits, fitter):
    """In one go as one after the other, gradients too."""
    unknowns = fitter.unknowns(fitter.mean_face(portraits.landmarks[0].astype(float)))
    several = {name: torch.stack([value.detach(), 1.1 * value.detach()]) for name, value in unknowns.items()}
    for value in several.values():
        value.requires_grad_()
    points = torch.from_numpy(portraits.landmarks[:2])
    weights = torch.ones(68)
    pictures = torch.from_numpy(portraits.images[:2].transpose(0, 3, 1, 2).astype(np.float32) / 255)
    sure, seen = torch.ones(2, 1, 224, 224), torch.from_numpy(portraits.seen[:2])
    together = fitter.loss(several, points, weights, pictures, sure, seen)
    gradient = torch.autograd.grad(together, several["identity"])[0]
    total = torch.zeros(())
    for k in range(2):
        one = {name: value[k].detach().clone().requires_grad_() for name, value in several.items()}
        loss = fitter.loss(one, points[k], weights, pictures[k : k + 1], sure[k : k + 1], seen[k])
        assert torch.allclose(torch.autograd.grad(loss, one["identity"])[0], gradient[k], rtol=1e-3, atol=1e-2)
        total = total + loss.detach()
    assert together.item() == pytest.approx(total.item(), rel=1e-4)


def test_the_command_writes_what_is_read_back(model, small_folder, tmp_path):
    path, own = tmp_path / "portraits.safetensors", small_folder / "face.safetensors"
    result = CliRunner().invoke(
        main,
        ["train", "portraits", "--tiny", "--model", str(own), "--out", str(path), "--work", str(tmp_path / "work")],
    )
    assert result.exit_code == 0, result.output
    assert PortraitNetwork.load(sketchwidget.FaceModel.load(own), path).channels == (8, 8, 16)
    with pytest.raises(ValueError, match="another face model"):
        PortraitNetwork.load(model, path)
    with pytest.raises(ValueError, match="its format"):
        PortraitNetwork.load(model, Path(sketchwidget.__file__).parent / "data" / "avatar.safetensors")
