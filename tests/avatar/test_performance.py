import numpy as np
import pytest

from sketchwidget.avatar.performance import Performance, performances


def test_weights_between_frames():
    track = Performance("nod", np.array([0.0, 1, 3]), {"jawOpen": np.array([0.0, 1, 0])})
    assert [track.at(time)["jawOpen"] for time in (-1, 0.5, 1, 2, 9)] == [0, 0.5, 1, 0.5, 0]
    assert len(list(track)) == 91


def test_ready_performances_begin_and_end_at_rest():
    ready = performances()
    assert {"blink", "speak", "laugh"} <= set(ready)
    for track in ready.values():
        for time in (0.0, track.duration):
            assert all(weight == 0 for weight in track.at(time).values())
        assert all(0 <= weight <= 1 for frame in track for weight in frame.values())


def test_recorded_frames_play_back():
    frames = [{"jawOpen": 0.1}, {"jawOpen": 0.5, "browInnerUp": 1.0}, {}]
    track = Performance.recorded("take", frames, fps=10)
    assert track.at(0.1) == {"jawOpen": 0.5, "browInnerUp": 1.0} and track.at(0.2)["jawOpen"] == 0


@pytest.mark.parametrize(
    ("times", "weights"), [([0.0, 0], {}), ([1.0, 2], {}), ([0.0, 1], {"jawOpen": [1.0]}), ([], {})]
)
def test_times_that_do_not_grow_are_told(times, weights):
    with pytest.raises(ValueError):
        Performance("wrong", np.array(times), {name: np.array(track) for name, track in weights.items()})
