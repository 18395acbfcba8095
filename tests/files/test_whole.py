import os

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


def test_a_file_cannot_take_the_place_of_a_folder(tmp_path):
    (tmp_path / "a").mkdir()
    with pytest.raises(OSError) as caught, whole(tmp_path / "a") as unfinished:
        unfinished.write_bytes(b"new")
    assert str(caught.value).count(str(tmp_path / "a")) == 1 and list(tmp_path.iterdir()) == [tmp_path / "a"]


def test_a_link_and_who_may_read_stay(tmp_path):
    path, link = tmp_path / "a.bin", tmp_path / "b.bin"
    path.write_bytes(b"former")
    path.chmod(0o600)
    link.symlink_to(path)
    with whole(link) as unfinished:
        unfinished.write_bytes(b"new")
    assert link.is_symlink() and path.read_bytes() == b"new" and path.stat().st_mode & 0o777 == 0o600


def test_what_a_killed_process_left_goes_after_a_day(tmp_path):
    old, young = tmp_path / ".a.bin.1.part", tmp_path / ".a.bin.2.part"
    for left in (old, young):
        left.write_bytes(b"half of it")
    os.utime(old, (0, 0))
    with whole(tmp_path / "a.bin") as unfinished:
        unfinished.write_bytes(b"new")
    assert not old.exists() and young.exists()


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
