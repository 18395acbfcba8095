"""What a network makes of drawings once, and the layers behind that see it again and again."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from safetensors import safe_open
from safetensors.torch import save_file

from sketchwidget.inference.network import TINY, PixelShapeCNN
from sketchwidget.inference.network_file import read_network
from sketchwidget.inference.shape_code import DETAILS
from sketchwidget.training.examples import Variety
from sketchwidget.training.looked_at import Again, LookedAt
from sketchwidget.training.network import Schedule

LAYOUT = replace(TINY, details=DETAILS, joined=16)
NOBODY_TWICE = Variety(wrinkles=0.0, of_model=0.0, blended=1.0)


@pytest.fixture(scope="module")
def network(database):
    torch.manual_seed(0)
    return PixelShapeCNN(database.model.identity_size, database.model.expression_size, LAYOUT).eval()


@pytest.fixture(scope="module")
def examples(pipeline):
    return pipeline.examples(NOBODY_TWICE, 4)


@pytest.fixture(scope="module")
def looked_at(network, examples):
    return LookedAt.by(network, examples, 3, workers=0)


def test_features_are_those_of_the_branches(network, examples, looked_at):
    assert looked_at.features.shape == (12, 2 * LAYOUT.branch)
    second = examples.numbered(1)
    with torch.inference_mode():
        features = torch.cat(network.features(torch.from_numpy(second.images).float()), dim=1).numpy()
    np.testing.assert_allclose(looked_at.features[4:8], features, atol=0.05 * np.abs(features).max())
    np.testing.assert_allclose(looked_at.shapes[4:8], second.shapes, atol=0.01)
    np.testing.assert_array_equal(looked_at.codes[4:8], second.codes)
    np.testing.assert_array_equal(looked_at.poses[4:8], second.poses)


def test_they_are_kept_in_a_file(looked_at, tmp_path):
    looked_at.save(tmp_path / "drawings.npz")
    assert [path.name for path in tmp_path.iterdir()] == ["drawings.npz"]
    again = LookedAt.load(tmp_path / "drawings.npz")
    np.testing.assert_array_equal(again.features, looked_at.features)
    np.testing.assert_array_equal(again.poses, looked_at.poses)
    (tmp_path / "drawings.npz").write_bytes((tmp_path / "drawings.npz").read_bytes()[:500])
    with pytest.raises(ValueError, match=r"drawings\.npz is damaged; remove it"):
        LookedAt.load(tmp_path / "drawings.npz")


@pytest.fixture(scope="module")
def lines(pipeline):
    return LookedAt.by(None, pipeline.examples(NOBODY_TWICE, 4, pixels=False), 5, workers=0)


def test_lines_alone_are_those_of_the_same_drawings(lines, looked_at):
    assert lines.features.shape == (20, 0)
    for name in ("shapes", "codes", "poses"):
        np.testing.assert_array_equal(getattr(lines, name)[:12], getattr(looked_at, name))


def test_batches_hold_drawings_with_their_features_and_lines_without(lines, looked_at):
    batch = Again(looked_at, lines, 101, 300, seed=3).numbered(7)
    seen = np.arange(401) < 101
    np.testing.assert_array_equal(batch.images.any(axis=1), seen)
    for of, chosen in ((looked_at, seen), (lines, ~seen)):
        rows = (batch.codes[chosen][:, None] == of.codes).all(axis=2).argmax(axis=1)
        assert set(rows) == set(range(len(of.codes)))
        np.testing.assert_array_equal(batch.shapes[chosen], of.shapes[rows])
        np.testing.assert_array_equal(batch.poses[chosen], of.poses[rows])
    rows = (batch.codes[seen][:, None] == looked_at.codes).all(axis=2).argmax(axis=1)
    np.testing.assert_array_equal(batch.images[seen], looked_at.features[rows])
    same, other = (Again(looked_at, lines, 101, 300, seed=3).numbered(number) for number in (7, 8))
    np.testing.assert_array_equal(same.images, batch.images)
    assert (other.codes != batch.codes).any()


def test_only_what_joins_lines_and_pixels_learns_again(database, pipeline, tmp_path):
    before, after = tmp_path / "before.safetensors", tmp_path / "after.safetensors"
    schedule = Schedule(steps=2, batch=4, checkpoint=2)
    pipeline.train_network(before, "a test", schedule, LAYOUT, Variety(wrinkles=0.0), workers=0)
    pipeline.train_network(
        after, "a test", replace(schedule, steps=0), LAYOUT, Variety(wrinkles=0.0), workers=0, start=before, looked_at=5
    )
    weights, learnt = (read_network(path).network.state_dict() for path in (before, after))
    changed = {name for name in weights if not torch.equal(weights[name], learnt[name])}
    assert changed and all(name.startswith("shape_") for name in changed)


def test_a_network_may_begin_with_one_that_joins_lines_in_another_way(database, pipeline, tmp_path):
    before, after = tmp_path / "plain.safetensors", tmp_path / "joined.safetensors"
    schedule = Schedule(steps=2, batch=4, checkpoint=2)
    pipeline.train_network(before, "a test", schedule, TINY, Variety(wrinkles=0.0), workers=0)
    none = replace(schedule, steps=0)
    pipeline.train_network(after, "a test", none, LAYOUT, Variety(wrinkles=0.0), workers=0, start=before, looked_at=5)
    weights, learnt = (read_network(path).network.state_dict() for path in (before, after))
    assert all(torch.equal(learnt[name], value) for name, value in weights.items() if not name.startswith("shape_"))
    with pytest.raises(ValueError, match="another layout"):
        pipeline.train_network(
            after, "a test", none, replace(LAYOUT, hidden=32), Variety(), workers=0, start=before, looked_at=5
        )


def test_a_network_may_begin_with_one_of_the_former_format(database, pipeline, tmp_path):
    before, former, after = (tmp_path / f"{name}.safetensors" for name in ("this-format", "former", "begun"))
    schedule = Schedule(steps=2, batch=4, checkpoint=2)
    pipeline.train_network(before, "a test", schedule, TINY, Variety(wrinkles=0.0), workers=0)
    with safe_open(before, "pt") as file:
        tensors = {name: file.get_tensor(name) for name in file.keys() if ".detail_" not in name}  # noqa: SIM118
        save_file(tensors, former, file.metadata() | {"format": "sketchwidget network 2"})
    none = replace(schedule, steps=0)
    pipeline.train_network(after, "a test", none, LAYOUT, Variety(wrinkles=0.0), workers=0, start=former, looked_at=5)
    learnt = read_network(after).network.state_dict()
    begun = [name for name in tensors if name in learnt and not name.startswith("shape_")]
    assert begun and all(torch.equal(learnt[name], tensors[name].to(learnt[name].dtype)) for name in begun)
    with pytest.raises(ValueError, match="its format is 'sketchwidget network 2'"):
        read_network(former)


def test_a_network_that_joins_nothing_cannot_end_so(pipeline, tmp_path):
    with pytest.raises(ValueError, match="no layers that learn again"):
        pipeline.train_network(
            tmp_path / "pixels.safetensors", "a test", Schedule(steps=1), replace(TINY, shape=0), looked_at=1
        )


def test_without_steps_there_is_a_network_to_start_from(pipeline, tmp_path):
    with pytest.raises(ValueError, match="without steps"):
        pipeline.train_network(tmp_path / "none.safetensors", "a test", Schedule(steps=0), LAYOUT, looked_at=1)
