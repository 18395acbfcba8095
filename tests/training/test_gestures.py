"""Training of the gesture classifier, in small, and what is measured of it."""

import numpy as np
import pytest
from typer.testing import CliRunner

from sketchwidget import GESTURES, GestureClassifier, cli
from sketchwidget.gesture.recordings import FILE, Recording
from sketchwidget.training import gestures
from sketchwidget.training.gestures import NONE, Measured, measure, simulate, simulate_others, train


def test_no_writer_is_in_two_sets():
    sets = [set(gestures.TRAINING), set(gestures.CALIBRATION), set(gestures.HELD_OUT)]
    assert len(set().union(*sets)) == sum(map(len, sets))


def test_simulated_strokes_are_as_many_of_each_gesture_and_always_the_same():
    samples = simulate(gestures.HELD_OUT, 3, 0)
    assert np.bincount([label for _, label in samples]).tolist() == [3] * len(GESTURES)
    for (stroke, _), (again, _) in zip(samples, simulate(gestures.HELD_OUT, 3, 0), strict=True):
        np.testing.assert_array_equal(stroke, again)
    assert [label for _, label in simulate_others(gestures.HELD_OUT, 4, 0)] == [NONE] * 4


def test_shares_are_counted_by_hand():
    confusion = np.zeros((11, 11), dtype=int)
    confusion[0, 0], confusion[0, 3], confusion[0, -1] = 6, 1, 3  # ten lines, three of them refused
    confusion[-1, -1], confusion[-1, 2] = 3, 1
    measured = Measured(confusion)
    assert measured.accuracy == pytest.approx(0.6) and measured.refused == pytest.approx(0.3)
    assert measured.false_acceptance == pytest.approx(0.25)


def test_a_perfect_and_a_refusing_classifier():
    samples = simulate(gestures.HELD_OUT, 1, 0) + simulate_others(gestures.HELD_OUT, 5, 0)
    answers = iter(samples)

    class Perfect:
        def classify(self, _):
            label = next(answers)[1]
            return (None if label == NONE else GESTURES[label]), 1.0

    class Refusing:
        def classify(self, _):
            return None, 0.0

    assert measure(Perfect(), samples).confusion.tolist() == np.diag([1] * 10 + [5]).tolist()
    refused = measure(Refusing(), samples)
    assert (refused.accuracy, refused.refused, refused.false_acceptance) == (0.0, 1.0, 0.0)


def test_the_shipped_classifier_tells_gestures_apart():
    samples = simulate(gestures.HELD_OUT, 10, 3) + simulate_others(gestures.HELD_OUT, 100, 3)
    measured = measure(GestureClassifier.load(), samples)
    assert measured.accuracy >= 0.93  # of 100; the figure itself is measured on 4,000
    assert measured.false_acceptance <= 0.1


def test_a_short_training_learns_and_is_reproducible():
    recordings = [(np.array([[0.0, 0], [1, 0.1]]), 0)]
    first, again = (train(6, 8, seed=1, recordings=recordings) for _ in range(2))
    images = np.zeros((1, 256, 256), dtype=bool)
    np.testing.assert_array_equal(first.probabilities(images), again.probabilities(images))
    assert first.threshold == again.threshold > 0


def test_the_command_trains_and_tells_what_it_measured(tmp_path):
    recorded, out = tmp_path / "anna.jsonl", tmp_path / "gestures.safetensors"
    FILE.write(recorded, [Recording([[0, 0, 0.5, 0], [1, 0, 0.5, 9]], "line")])
    arguments = ["train", "gestures", "--out", str(out), "--recordings", str(recorded), "--tiny"]
    result = CliRunner().invoke(cli.main, arguments)
    assert result.exit_code == 0, result.output
    assert "held-out simulated writers" in result.output
    assert GestureClassifier.load(out).classify([[0, 0], [1, 1]])[0] in (*GESTURES, None)


def test_a_file_of_other_things_ends_in_a_message(tmp_path):
    (tmp_path / "a.jsonl").write_text("{}\n")
    out = tmp_path / "b.safetensors"
    result = CliRunner().invoke(
        cli.main, ["train", "gestures", "--out", str(out), "--recordings", str(tmp_path / "a.jsonl")]
    )
    assert result.exit_code == 1 and "holds no gestures" in result.output and not out.exists()
