"""The texture of a head that was taken over: it stays through whatever is done to that head, and in files."""

import base64
import io
import json
import zlib
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import Image

from sketchwidget.face.texture import Texture, TexturedFace
from sketchwidget.session import Session, SessionFileError


@pytest.fixture(scope="module")
def someone(model):
    return model.face(model.bilinear.identities[4 * 16])


@pytest.fixture(scope="module")
def texture(model):
    spread = (model.mean[:, :2] - model.mean[:, :2].min(axis=0)) / np.ptp(model.mean[:, :2], axis=0)
    return Texture(file_of("JPEG"), spread)


@pytest.fixture
def session(model):
    return Session(SimpleNamespace(model=model), inference=False)


def file_of(kind, side=32):
    file = io.BytesIO()
    Image.fromarray(np.full((side, side, 3), (200, 90, 40), dtype=np.uint8)).save(file, kind)
    return file.getvalue()


def wearing(session):
    return None if session.texture is None else (session.texture.picture, session.texture.uv.tobytes())


def test_it_stays_through_edits_refinement_and_exaggeration(session, someone, texture):
    session.take_over(someone, texture)
    piece = session.sketch.lines["left_brow"][0]
    session.erase(piece[len(piece) // 2], radius=0.005)
    session.draw(piece - [0, 0.02])
    assert session.texture is texture
    session.exaggerate(1.6)
    session.exaggerate(1.3)
    assert session.texture is texture
    session.brush(session.face.model.curves["nose"])
    assert session.mode == "refine" and session.texture is texture


def test_it_goes_with_the_head(session, someone, texture):
    session.take_over(someone, texture)
    session.undo()
    assert session.texture is None
    session.redo()
    assert session.texture is texture
    session.start_from_template()
    assert session.texture is None
    session.undo()
    session.take_over(someone)
    assert session.texture is None


def test_a_session_that_is_read_back_wears_it_and_undoes_to_it(session, someone, texture, tmp_path):
    session.take_over(someone, texture)
    session.exaggerate(1.5)
    session.save(tmp_path / "textured.jsonl")
    again = Session.load(tmp_path / "textured.jsonl", session._modeller.given)
    assert again.events == session.events
    assert wearing(again) == wearing(session)
    again.undo()
    assert wearing(again) == wearing(session)


def test_files_from_before_textures_are_read(session, someone):
    session.take_over(someone)
    *before, event = session.dumps().splitlines()
    old = json.loads(event)
    del old["texture"]
    again = Session.loads("\n".join([*before, json.dumps(old)]), session._modeller.given)
    assert again.texture is None and np.array_equal(again.face.vertices, session.face.vertices)


def broken(name):
    """What a file may hold in place of a texture."""
    places = base64.b64encode(zlib.compress(np.zeros((100, 2), dtype="<u2").tobytes())).decode()
    endless = base64.b64encode(zlib.compress(bytes(8 * 2**20))).decode()
    header = b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR\x00\x01\x86\xa0\x00\x01\x86\xa0\x08\x02\x00\x00\x00"
    vast = base64.b64encode(header + zlib.crc32(header[12:]).to_bytes(4, "big")).decode()
    picture = base64.b64encode(file_of("PNG")).decode()
    return {
        "no object": 3,
        "another number of vertices": {"picture": picture, "uv": places},
        "endless places": {"picture": picture, "uv": endless},
        "no base64": {"picture": "?", "uv": places},
        "no picture": {"picture": base64.b64encode(b"GIF89a, or a pickle").decode(), "uv": places},
        "a picture of ten gigapixels": {"picture": vast, "uv": places},
        "numbers": {"picture": 1, "uv": 2},
    }[name]


@pytest.mark.parametrize(
    "name, message",
    [
        ("no object", '"picture" and a "uv"'),
        ("another number of vertices", "for 100 vertices"),
        ("endless places", "more than 200,000"),
        ("no base64", "no packed picture"),
        ("no picture", "JPEG or PNG"),
        ("a picture of ten gigapixels", "JPEG or PNG|4096 pixels a side"),
        ("numbers", "are texts"),
    ],
)
def test_what_is_no_texture_is_refused_with_its_line(session, someone, name, message):
    session.take_over(someone)
    *before, event = session.dumps().splitlines()
    damaged = json.loads(event) | {"texture": broken(name)}
    with pytest.raises(SessionFileError, match=f"line 3.*({message})"):
        Session.loads("\n".join([*before, json.dumps(damaged)]), session._modeller.given)


def test_a_texture_for_another_head_changes_nothing(session, someone, texture):
    events = session.events
    with pytest.raises(ValueError, match="for 3 vertices"):
        session.take_over(someone, Texture(texture.picture, np.zeros((3, 2))))
    assert session.events == events and session.texture is None


def test_the_exported_head_has_it(someone, texture):
    import trimesh

    scene = trimesh.load(io.BytesIO(TexturedFace(someone, texture).to_bytes("glb")), file_type="glb")
    (mesh,) = scene.geometry.values()
    assert mesh.visual.material.baseColorTexture.size == (32, 32)
    assert len(mesh.faces) == len(someone.faces) and np.ptp(mesh.vertices[:, 1]) < 0.4
    assert np.allclose(mesh.visual.uv[:100], texture.uv[:100], atol=1e-4)
    assert TexturedFace(someone, texture).to_bytes("obj") == someone.to_bytes("obj")


def test_what_is_no_file_is_told():
    with pytest.raises(ValueError, match="bytes of a file, 8 MB at most; given str"):
        Texture("head.jpg", np.zeros((3, 2)))
    with pytest.raises(ValueError, match="8 MB at most; given 8,388,609 bytes"):
        Texture(bytes(8 * 2**20 + 1), np.zeros((3, 2)))
