import numpy as np
import pytest
from safetensors import SafetensorError
from safetensors.numpy import load_file, save_file

from sketchwidget.files.kept import keep, kept
from sketchwidget.files.tensorfile import writing
from sketchwidget.files.whole import whole


def test_nothing_is_to_be_seen_before_all_is_written(tmp_path):
    path = tmp_path / "a.bin"
    path.write_bytes(b"former")
    with whole(path) as unfinished:
        unfinished.write_bytes(b"new")
        assert path.read_bytes() == b"former"
    assert path.read_bytes() == b"new" and list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("error", [ValueError, OSError, KeyboardInterrupt])
def test_a_failed_write_leaves_the_former_file_and_nothing_else(tmp_path, error):
    path = tmp_path / "a.bin"
    path.write_bytes(b"former")
    with pytest.raises(error), whole(path) as unfinished:
        unfinished.write_bytes(b"half of it")
        raise error
    assert path.read_bytes() == b"former" and list(tmp_path.iterdir()) == [path]


def test_an_error_names_the_file_that_was_asked_for(tmp_path):
    with pytest.raises(FileNotFoundError) as caught, whole(tmp_path / "none" / "a.bin") as unfinished:
        unfinished.write_bytes(b"new")
    assert caught.value.filename == str(tmp_path / "none" / "a.bin")


def test_tensors_that_cannot_be_written_leave_the_former_ones(tmp_path):
    path = tmp_path / "a.safetensors"
    with writing(path) as unfinished:
        save_file({"one": np.ones(3)}, unfinished)
    with pytest.raises(OSError, match=r"a\.safetensors cannot be written"), writing(path) as unfinished:
        save_file({"one": np.zeros(3)}, unfinished)
        raise SafetensorError("No space left on device")
    np.testing.assert_array_equal(load_file(path)["one"], np.ones(3))
    assert list(tmp_path.iterdir()) == [path] and path.stat().st_mode & 0o044 == 0o044  # others may read it


def test_arrays_that_cannot_be_written_leave_the_former_ones(tmp_path):
    path = tmp_path / "a.npz"
    keep(path, {"one": np.ones(3)})
    with pytest.raises(ValueError, match="pickle"):
        keep(path, {"one": np.zeros(3), "two": np.array([object()])})
    np.testing.assert_array_equal(kept(path, ["one"])["one"], np.ones(3))
    assert list(tmp_path.iterdir()) == [path]
