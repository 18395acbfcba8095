"""Strokes told apart, by the shipped classifier."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from safetensors import safe_open
from safetensors.torch import save_file

import sketchwidget as sw
from sketchwidget.files.shipped import shipped
from sketchwidget.gesture import shapes
from sketchwidget.gesture.network import GestureCNN
from sketchwidget.gesture.picture import normalised, picture
from sketchwidget.gesture.shapes import EXAMPLES
from sketchwidget.gesture.writers import Writer

PATH = shipped("gestures.safetensors")


@pytest.fixture(scope="module")
def classifier():
    return sw.GestureClassifier.load()


@pytest.mark.parametrize("name", sw.GESTURES)
def test_each_example_is_what_it_is_wherever_it_is_drawn(classifier, name):
    for points in (EXAMPLES[name], 0.1 * EXAMPLES[name] + [0.7, 0.2], 300 * EXAMPLES[name]):
        found, probability = classifier.classify(points.tolist())
        assert found == name and classifier.threshold <= probability <= 1.0


@settings(max_examples=30)
@given(st.sampled_from([name for name in sw.GESTURES if name != "line"]), st.integers(0, 1000))
def test_nothing_but_a_line_has_a_direction(name, seed):
    """A stroke drawn from its other end looks the same."""
    classifier = sw.GestureClassifier.load()
    stroke = Writer.random(seed).draw(name, np.random.default_rng(seed))
    there, back = classifier.classify(stroke), classifier.classify(stroke[::-1])
    assert there[0] == back[0] and abs(there[1] - back[1]) < 0.05


@pytest.mark.parametrize("start", [0, 10, 37, 80])
def test_a_region_may_start_anywhere(classifier, start):
    loop = EXAMPLES["region"][:-1]
    assert classifier.classify(np.roll(loop, start, axis=0)[:-2])[0] == "region"


def test_the_mirror_image_of_an_arrow_is_the_other_and_of_a_roll_is_itself(classifier):
    for name, image in (("left arrow", "right arrow"), ("right arrow", "left arrow"), ("up roll 2", "up roll 2")):
        assert classifier.classify(EXAMPLES[name] * [-1, 1])[0] == image
    for level in (1, 2, 3):
        assert classifier.classify(EXAMPLES[f"up roll {level}"] * [1, -1])[0] == f"down roll {level}"


@pytest.mark.parametrize(
    "points",
    [
        [[0, 0], [0, 1], [1, 1]],  # an L
        [[0, 0], [1, 0], [0, 1], [1, 1]],  # a Z
        [[0, 0], [0.5, 1], [1, 0], [1.5, 1], [2, 0], [2.5, 1]],  # a zigzag
        [[0, 1], [0.5, 0], [1, 1]],  # a chevron upwards
        [[0, 0], [1, 0.2], [0, 0]],  # a line there and back
        [[0, 0], [1, 0.2], [0.5, 0.1]],
        [[0.3, 0.3]],  # a dot
        [[0.3, 0.3], [0.3, 0.3], [0.3, 0.3]],
    ],
)
def test_what_is_none_of_the_ten_is_refused(classifier, points):
    assert classifier.classify(points)[0] is None


@pytest.mark.parametrize("width", [0.7, 1.0])
@pytest.mark.parametrize("advance", [0.45, 0.6, 0.9])
def test_four_loops_are_no_roll(classifier, width, advance):
    for side in (1, -1):
        four = shapes.roll(4, widths=[width] * 4, advance=advance * width) * [1, side]
        assert classifier.classify(four)[0] is None


@pytest.mark.parametrize("turns", [2.0, 2.5, 3.0])
@pytest.mark.parametrize("inner", [0.0, 0.3])
def test_a_spiral_is_none(classifier, turns, inner):
    turn = np.linspace(0, 1, 200)
    radius = inner + (1 - inner) * turn
    path = radius[:, None] * np.stack([np.cos(2 * np.pi * turns * turn), np.sin(2 * np.pi * turns * turn)], axis=1)
    assert classifier.classify(path)[0] is None


def test_an_arrow_to_both_sides_is_none(classifier):
    one, other = shapes.arrow(0.0) * [-1, 1], shapes.arrow(0.0)
    both = np.concatenate([one, [[0, 0], [1, 0]], other + np.array([1, 0])])
    assert classifier.classify(both)[0] is None


@pytest.mark.parametrize("loops", [2, 3])
@pytest.mark.parametrize("lead", [0.1, 0.25, 0.35])
def test_round_rolls_that_are_packed_tightly_have_their_sign(classifier, loops, lead):
    for advance in (0.35, 0.5):
        roll = shapes.roll(loops, widths=[1.0] * loops, advance=advance, lead=(lead, lead))
        assert classifier.classify(roll)[0] == f"up roll {loops}"
        assert classifier.classify(roll * [1, -1])[0] == f"down roll {loops}"


@pytest.mark.parametrize("points", [[], [[0.0, np.nan]], "line", [[1, 2, 3]], [[0, 0], [1]]])
def test_what_is_no_stroke_is_an_error(classifier, points):
    with pytest.raises(ValueError, match="a stroke is an array"):
        classifier.classify(points)


def test_a_picture_is_the_same_at_any_size_and_place():
    stroke = Writer.random(5).draw("up roll 3", np.random.default_rng(5)).astype(np.float64)
    np.testing.assert_array_equal(picture(stroke), picture(4 * stroke + [3, -7]))
    box = normalised(stroke)
    np.testing.assert_allclose((box.min(axis=0) + box.max(axis=0)) / 2, 0.5)
    assert np.isclose(np.ptp(box, axis=0).max(), 0.84)


def test_the_network_has_the_papers_layers():
    sizes = [tuple(tensor.shape) for name, tensor in GestureCNN().state_dict().items() if name.endswith("weight")]
    assert sizes == [(32, 1, 11, 11), (64, 32, 5, 5), (16, 64, 3, 3), (256, 256), (10, 256)]


def test_the_shipped_file_is_small_and_says_where_it_came_from():
    assert PATH.stat().st_size < 2e6
    with safe_open(PATH, "np") as file:
        header = file.metadata()
    assert header["command"].startswith("sketchwidget train gestures")
    assert {"versions", "licence", "recorded strokes"} <= header.keys()


def test_a_classifier_is_written_and_read(classifier, tmp_path):
    classifier.save(tmp_path / "a.safetensors", {"command": "none"})
    again = sw.GestureClassifier.load(tmp_path / "a.safetensors")
    assert again.threshold == classifier.threshold
    images = picture(EXAMPLES["up roll 1"])[None]
    np.testing.assert_allclose(again.probabilities(images), classifier.probabilities(images), atol=1e-6)


def test_what_is_no_classifier_is_an_error(tmp_path):
    with pytest.raises(FileNotFoundError, match="no gesture classifier"):
        sw.GestureClassifier.load(tmp_path / "none.safetensors")
    tensors = {name: tensor for name, tensor in GestureCNN().state_dict().items() if "0" not in name}
    save_file(tensors, tmp_path / "part.safetensors", {"format": "sketchwidget gestures 1", "threshold": "0.5"})
    with pytest.raises(ValueError, match="damaged gesture classifier"):
        sw.GestureClassifier.load(tmp_path / "part.safetensors")
    save_file(tensors, tmp_path / "other.safetensors", {"format": "something"})
    with pytest.raises(ValueError, match="is no gesture classifier"):
        sw.GestureClassifier.load(tmp_path / "other.safetensors")
