"""One head: its drawing and its files."""

import io

import numpy as np
import pytest
import trimesh

from sketchwidget.face import Face
from sketchwidget.geometry import View
from sketchwidget.sketch import FEATURES, LINE_NAMES, SILHOUETTE, WRINKLE


def test_sketch_has_every_line_in_its_place(model):
    face = model.face()
    lines = face.sketch().lines
    assert set(lines) == {SILHOUETTE, *FEATURES, WRINKLE}
    assert len(lines[SILHOUETTE]) == 1 and all(len(lines[name]) > 1 for name in FEATURES)
    np.testing.assert_array_equal(lines[SILHOUETTE][0][0], lines[SILHOUETTE][0][-1])
    for name in FEATURES:
        np.testing.assert_allclose(np.concatenate(lines[name]), View().project(face.curve(name)), atol=1e-6)
    assert set(face.sketch(wrinkles=False).lines) == {SILHOUETTE, *FEATURES}
    assert set(lines) <= set(LINE_NAMES)


def test_silhouette_is_smooth_and_near_its_handle(model):
    for expression in model.expressions:
        face = model.face(expression=expression)
        line = face.sketch().lines[SILHOUETTE][0]
        steps = np.diff(line, axis=0)
        turn = np.diff(np.unwrap(np.arctan2(steps[:, 1], steps[:, 0])))
        assert np.abs(turn).max() < 0.6, expression
        handle = View().project(face.curve(SILHOUETTE))
        nearest = np.linalg.norm(handle[:, None] - line[None], axis=2).min(axis=1)
        assert nearest.max() < 0.016, expression  # 4 mm


def test_image_is_binary_and_fills_the_canonical_frame(model):
    image = model.face().sketch().image(256)
    assert image.shape == (256, 256) and image.dtype == bool
    rows = np.flatnonzero(image.any(axis=1))
    assert abs(rows[0] / 256 - 0.1) < 0.02 and abs(rows[-1] / 256 - 0.9) < 0.02


@pytest.mark.parametrize("suffix", ["obj", "ply", "stl", "glb"])
def test_export_is_read_back_by_trimesh(model, tmp_path, suffix):
    face = model.face(expression="smile")
    face.export(tmp_path / f"head.{suffix}")
    mesh = trimesh.load(tmp_path / f"head.{suffix}", force="mesh", process=False)
    size = 0.001 if suffix == "glb" else 1.0
    assert len(mesh.faces) == len(face.faces)
    np.testing.assert_allclose(mesh.bounds, size * np.stack([face.vertices.min(0), face.vertices.max(0)]), rtol=1e-3)


def test_export_keeps_colours(model):
    loaded = trimesh.load(io.BytesIO(model.face().to_bytes("ply")), file_type="ply", process=False)
    np.testing.assert_allclose(loaded.visual.vertex_colors[:, :3] / 255, model.colors, atol=1 / 255)


def test_a_picture_takes_colours_by_vertex(model):
    face = model.face()
    half = np.where(face.vertices[:, :1] > 0, [0.0, 0, 1], [1.0, 0, 0])  # the subject's left is the viewer's right
    shown = face.picture(size=64, colors=half)
    red, blue = shown[32, 24:30], shown[32, 34:40]
    assert (red[:, 0] > 0).all() and (red[:, 2] == 0).all() and (blue[:, 2] > 0).all() and (blue[:, 0] == 0).all()
    np.testing.assert_array_equal(face.picture(size=64), face.picture(size=64, colors=model.colors))
    with pytest.raises(ValueError, match=r"given an array of shape \(3,\)"):
        face.picture(colors=[1.0, 0, 0])


def test_other_formats_and_shapes_are_refused(model, tmp_path):
    with pytest.raises(ValueError, match="'fbx'"):
        model.face().export(tmp_path / "head.fbx")
    assert not list(tmp_path.iterdir())
    with pytest.raises(ValueError, match=r"finite vertices \(16837, 3\); given shape \(3, 3\)$"):
        Face(model, np.zeros((3, 3)))
    broken = np.zeros(model.mean.shape)
    broken[[7, 9], 1] = np.inf
    with pytest.raises(ValueError, match=r"finite vertices \(16837, 3\); given \[0.0, inf, 0.0\] as vertex 7$"):
        Face(model, broken)
    with pytest.raises(KeyError, match="moustache"):
        model.face().curve("moustache")


def test_a_face_cannot_be_changed_by_accident(model):
    with pytest.raises(ValueError, match="read-only"):
        model.face().vertices[0] = 0
    with pytest.raises(ValueError, match="read-only"):
        model.face().identity[0] = 0
