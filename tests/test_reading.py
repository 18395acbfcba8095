"""Every reader of files, given damaged ones: it reads them or says what is wrong, and never runs what they hold."""

import os
import pickle
import warnings
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
import torch
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from PIL import Image
from safetensors.numpy import save

import sketchwidget
from sketchwidget.avatar.network import PortraitNetwork
from sketchwidget.avatar.stylegan import load_generator
from sketchwidget.avatar.template import AvatarTemplate
from sketchwidget.database.drawings import read_drawings
from sketchwidget.database.obj import read_obj
from sketchwidget.face import FaceModel
from sketchwidget.files import tensorfile
from sketchwidget.gesture import recordings
from sketchwidget.gesture.classifier import GestureClassifier
from sketchwidget.inference.network_file import read_network
from sketchwidget.portrait.picture import load_picture
from sketchwidget.session import Draw, Erase, Gesture, Mode, Session, Undo, file
from sketchwidget.sketch import Sketch
from sketchwidget.training.checkpoint import Checkpoints

STROKE = [[0.3, 0.4], [0.5, 0.2], [0.7, 0.4]]
TOLD = (ValueError, OSError)  # what a reader raises for a file that it does not like


def session_text():
    events = [Draw(STROKE), Draw(STROKE, mirror=True), Undo(), Erase(STROKE, 0.1), Mode("refine")]
    return file.dumps([*events, Gesture(STROKE, "left")]).encode()


def sketch():
    return b'{"format":"sketchwidget sketch","version":1,"segments":[{"name":"nose","points":[[0,0],[1,1]]}]}'


def drawing_lines():
    header = b'{"format":"sketchwidget drawings","version":1}\n'
    head = b'"identity":[0.5],"expression":[1,0],"model":"' + 64 * b"a" + b'","view":"front"}\n'
    return header + b'{"strokes":[[[0.1,0.2,0.5,0],[0.3,0.4,0.5,9]]],' + head


def gesture_lines():
    header = b'{"format":"sketchwidget gestures","version":1}\n'
    return header + b'{"name":"line","points":[[0.1,0.2,0.5,0],[0.3,0.4,0.5,9],[0.5,0.5,0.5,20]]}\n'


def shipped(name):
    return (Path(sketchwidget.__file__).parent / "data" / f"{name}.safetensors").read_bytes()


def picture():
    png = BytesIO()
    Image.fromarray(np.random.default_rng(0).integers(0, 255, (64, 64, 3), dtype=np.uint8)).save(png, "PNG")
    return png.getvalue()


def tensors():
    return save({"a": np.eye(3), "b": np.arange(5)}, {"format": "some tensors"})


def checkpoint():
    written = BytesIO()
    torch.save({"a": torch.ones(3), "step": 4, "plan": 9, "falling": False, "seconds": 1.0, "about": "x"}, written)
    return written.getvalue()


def load_checkpoint(path):
    return Checkpoints(path.parent, {}, "x").resume(9, 9, torch.device("cpu"))


HEAD = 8000  # bytes, within which files are damaged: there they say what they hold

READERS = {
    "session": ("drawing.jsonl", session_text(), lambda path: file.loads(path.read_text(encoding="utf-8"))),
    "sketch": ("s.json", sketch(), Sketch.load),
    "drawings": ("d.jsonl", drawing_lines(), read_drawings),
    "mesh": ("head.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", read_obj),
    "picture": ("me.png", picture(), load_picture),
    "tensors": ("t.safetensors", tensors(), lambda path: tensorfile.read(path, "thing", "some tensors")),
    "checkpoint": ("last.pt", checkpoint(), load_checkpoint),
    "generator": ("g.pt", checkpoint(), load_generator),
    "generator's tensors": ("g.safetensors", tensors(), load_generator),
    "recordings": ("r.jsonl", gesture_lines(), recordings.FILE.read),
    "classifier": ("c.safetensors", shipped("gestures"), GestureClassifier.load),
    "model": ("m.safetensors", shipped("face"), FaceModel.load),
    "network": ("n.safetensors", shipped("pixelshapecnn"), read_network),
    "portraits' network": (
        "p.safetensors",
        shipped("portrait"),
        lambda path: PortraitNetwork.load(FaceModel.load(), path),
    ),
    "avatars' template": ("a.safetensors", shipped("avatar"), AvatarTemplate.load),
}


@pytest.mark.parametrize("reader", [name for name in READERS if not name.startswith("generator")])
def test_a_sound_file_is_read(reader, tmp_path):
    name, whole, read = READERS[reader]
    (tmp_path / name).write_bytes(whole)
    assert read(tmp_path / name) is not None


@st.composite
def damaged(draw, whole):
    """A file of which a piece was cut out, replaced or repeated."""
    start = draw(st.integers(0, min(len(whole), HEAD)))
    stop = draw(st.one_of(st.integers(start, min(len(whole), start + 8)), st.just(len(whole))))
    return whole[:start] + draw(st.one_of(st.binary(max_size=12), st.just(whole[start:stop] * 2))) + whole[stop:]


@pytest.mark.parametrize("reader", READERS)
@given(data=st.data())
@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_damaged_file_is_read_or_refused_with_a_sentence(reader, tmp_path, data):
    name, whole, read = READERS[reader]
    path = tmp_path / name
    path.write_bytes(data.draw(damaged(whole)))
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            read(path)
    except TOLD as error:
        assert str(error)


class Bomb:
    """Leaves a trace if it is unpickled."""

    def __init__(self, trace):
        self.trace = trace

    def __reduce__(self):
        return os.mkdir, (self.trace,)


@pytest.mark.parametrize("reader", ["checkpoint", "generator"])
def test_a_file_is_not_run(reader, tmp_path):
    name, _, read = READERS[reader]
    trace = tmp_path / "trace"
    for content in (pickle.dumps(Bomb(str(trace))), _saved({"about": "x", "a": Bomb(str(trace))})):
        (tmp_path / name).write_bytes(content)
        with pytest.raises(ValueError):
            read(tmp_path / name)
        assert not trace.exists()


def _saved(thing):
    written = BytesIO()
    torch.save(thing, written)
    return written.getvalue()


@given(
    actions=st.lists(
        st.tuples(
            st.sampled_from(["draw", "erase", "gesture", "brush", "preview", "preview_gesture", "under_brush"]),
            st.one_of(
                st.none(),
                st.text(max_size=3),
                st.lists(st.lists(st.floats(allow_nan=True), max_size=3), max_size=4),
                st.lists(st.integers(), max_size=4),
                st.lists(st.tuples(st.floats(-0.5, 1.5), st.floats(-0.5, 1.5)), min_size=1, max_size=6),
            ),
            st.sampled_from(["front", "left", "three-quarter", "", None, 3]),
        ),
        max_size=6,
    )
)
@settings(max_examples=12)
def test_a_session_does_what_it_is_told_or_says_why_not(actions):
    session = Session(inference=False)
    for name, given_points, view in actions:
        more = {"erase": (0.02,), "brush": (), "under_brush": (0.02, view)}.get(name, (view,))
        before, events = session.face.vertices, session.events
        try:
            getattr(session, name)(given_points, *more)
        except (ValueError, TypeError) as error:
            assert str(error)
            assert session.face.vertices is before and session.events == events
    assert np.array_equal(Session.loads(session.dumps(), inference=False).face.vertices, session.face.vertices)
