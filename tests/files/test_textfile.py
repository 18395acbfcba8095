import pytest

from sketchwidget.files import textfile


def test_what_is_written_is_read(tmp_path):
    textfile.write(tmp_path / "a.txt", "Büste\n")
    textfile.write(tmp_path / "a.txt", "Kopf\n")
    assert textfile.read(tmp_path / "a.txt") == "Kopf\n"


def test_a_failed_write_leaves_the_former_file_and_nothing_else(tmp_path, monkeypatch):
    path = tmp_path / "a.txt"
    textfile.write(path, "former")

    def full_disk(*_):
        raise OSError("No space left on device")

    monkeypatch.setattr("os.replace", full_disk)
    with pytest.raises(OSError, match="space"):
        textfile.write(path, "new")
    assert path.read_text() == "former"
    assert list(tmp_path.iterdir()) == [path]


def test_a_file_too_large_is_neither_read_nor_written(tmp_path, monkeypatch):
    monkeypatch.setattr(textfile, "MAX_BYTES", 4)
    textfile.write(tmp_path / "a.txt", "four")
    assert textfile.read(tmp_path / "a.txt") == "four"
    with pytest.raises(ValueError, match="bytes are more than"):
        textfile.write(tmp_path / "a.txt", "five!")
    (tmp_path / "b.txt").write_text("five!")
    with pytest.raises(ValueError, match="larger than"):
        textfile.read(tmp_path / "b.txt")


def test_bytes_that_are_no_text_are_an_error(tmp_path):
    (tmp_path / "a.txt").write_bytes(b"ab\xff")
    with pytest.raises(ValueError, match="byte 2"):
        textfile.read(tmp_path / "a.txt")
