"""Heads from a clone of ICT-FaceKit: a tiny one, and the real one where there is a part of it."""

import json
import warnings
from pathlib import Path

import numpy as np
import pytest
from tiny_head import CURVES, FACES, LANDMARKS, VERTICES, write_obj

from sketchwidget import FaceModel
from sketchwidget.database import ict
from sketchwidget.database.build import MODEL, build, prepare
from sketchwidget.database.database import FaceDatabase
from sketchwidget.database.ict import ICTFaceKitSource
from sketchwidget.face import PARTS
from sketchwidget.sketch import FEATURES, SILHOUETTE

CLONE = Path(__file__).resolve().parents[3] / "shared" / "data" / "ict-facekit"
MOUTH, LID = 18, 26  # vertices of the tiny head that its blend shapes move
HEAD = {
    "vertex_count": 75,
    "parts": {"skin": [[8, 14], [15, 64]], "eyes": [[64, 72]]},  # without the lowest ring, the nape's 14 and the lash
    "curves": CURVES,
}
RECIPES = {
    "neutral": {},
    "smile": {"mouthSmile": 0.5},
    "wink": {"eyeBlinkLeft": 1, "jawOpen": 0.5},
    "gape": {"jawOpen": 1},
}


def moved(vertex, by):
    vertices = VERTICES.copy()
    vertices[vertex] += by
    return vertices


@pytest.fixture
def clone(tmp_path, monkeypatch):
    """A clone of 75 vertices, with two identities and three blend shapes."""
    described = tmp_path / "described"
    described.mkdir()
    (described / "ict_head.json").write_text(json.dumps(HEAD))
    (described / "expressions.json").write_text(json.dumps(RECIPES))
    monkeypatch.setattr(ict, "files", lambda package: described)
    folder = tmp_path / "clone" / "FaceXModel"
    write_obj(folder / "generic_neutral_mesh.obj")
    write_obj(folder / "identity000.obj", VERTICES * [1.1, 1, 1])
    write_obj(folder / "identity001.obj", VERTICES + [0, 0, 0.1] * (VERTICES[:, 1:2] > 0))
    write_obj(folder / "mouthSmile_L.obj", moved(MOUTH, [0, 0.2, 0]))
    write_obj(folder / "mouthSmile_R.obj", moved(MOUTH + 1, [0, 0.4, 0]))
    write_obj(folder / "eyeBlink_L.obj", moved(LID, [0, 0, 0.3]))
    (folder / "vertex_indices.json").write_text(json.dumps({"idx_to_landmark_verts": LANDMARKS}))
    return tmp_path / "clone"


@pytest.fixture
def source(clone):
    with pytest.warns(UserWarning, match="jawOpen"):
        return ICTFaceKitSource(clone)


def test_parts_without_a_name_are_left_out_and_cut_quads_leave_a_triangle(source):
    template = source.template
    assert template.coarse_count == 63 and not template.refined
    assert np.bincount(template.parts).tolist() == [55, 0, 8]
    # 8 quads of the tube lie on the lowest ring; of the 4 about vertex 14 the lower two go with it or lose two corners.
    triangles = template.quads[template.quads[:, 2] == template.quads[:, 3]]
    skin = triangles[template.parts[triangles[:, 0]] == 0]
    assert len(skin) == 2 and len(triangles) == 6
    assert len(template.quads) == len(FACES) - 8 - 1
    source_normals = np.cross(
        *(VERTICES[source._kept][skin[:, k]] - VERTICES[source._kept][skin[:, 0]] for k in (1, 2))
    )
    assert (np.einsum("ij,ij->i", source_normals, VERTICES[source._kept][skin[:, 0]] * [1, 0, 1]) > 0).all()


def test_curves_and_landmarks_are_those_of_the_files_on_the_smaller_mesh(source):
    np.testing.assert_array_equal(source._kept[source.template.landmarks], LANDMARKS)
    for name, path in CURVES.items():
        np.testing.assert_array_equal(source._kept[source.template.curves[name]], path)


def test_folder_of_the_objs_will_do(clone, source):
    with pytest.warns(UserWarning):
        inside = ICTFaceKitSource(clone / "FaceXModel")
    np.testing.assert_array_equal(inside.identity(1), source.identity(1))


def test_identity_adds_components_with_the_normal_weights_of_its_number(source):
    first, second = np.random.default_rng([4, 2017]).normal(size=2)
    wanted = VERTICES * [1 + 0.1 * first, 1, 1] + second * np.array([0, 0, 0.1]) * (VERTICES[:, 1:2] > 0)
    np.testing.assert_allclose(source.identity(4), wanted[source._kept], atol=1e-6)


def test_sides_of_an_action_are_added_by_the_recipe(source):
    poses = source.poses()
    assert list(poses) == ["neutral", "smile", "wink"]
    smile = (poses["smile"] - poses["neutral"])[np.searchsorted(source._kept, [MOUTH, MOUTH + 1])]
    np.testing.assert_allclose(smile, [[0, 0.1, 0], [0, 0.2, 0]], atol=1e-12)
    wink = poses["wink"] - poses["neutral"]
    assert np.flatnonzero(wink.any(axis=1)).tolist() == [np.searchsorted(source._kept, LID)]
    np.testing.assert_allclose(wink.max(), 0.3)


def test_one_warning_names_what_is_missing(clone):
    (clone / "FaceXModel" / "mouthSmile_R.obj").unlink()  # half an action is none
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        source = ICTFaceKitSource(clone)
        source.heads(0)
    assert len(told) == 1
    assert "jawOpen, mouthSmile: " in str(told[0].message) and "smile, gape are left out" in str(told[0].message)
    assert source.expressions == ("neutral", "wink")


def test_complete_clone_warns_of_nothing(clone):
    write_obj(clone / "FaceXModel" / "jawOpen.obj", moved(MOUTH, [0, -0.3, 0]))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert ICTFaceKitSource(clone).expressions == tuple(RECIPES)


def test_heads_are_posed_aligned_and_in_millimetres(source):
    head = source.heads(2)
    assert head.shape == (3, 63, 3) and head.dtype == np.float32
    rest, smile = head[0], head[1]
    height = rest[source.template.parts == 0, 1].max() - rest[source.template.landmarks[8], 1]
    assert 150 < height < 250
    mouth = np.searchsorted(source._kept, MOUTH)
    assert np.abs(smile - rest)[mouth].max() > 1


def test_a_resting_face_is_as_it_is_among_the_others(source):
    for number in range(2):
        np.testing.assert_allclose(source.rest(number), source.heads(number)[0], atol=1e-3)


def test_a_database_of_it_has_its_faces_and_a_model_that_draws(source, tmp_path):
    build(source, tmp_path / "faces", identities=3, interpolated=0)
    database = FaceDatabase.open(tmp_path / "faces")
    assert database.origin["licence"] == "MIT, from ICT-FaceKit"
    model = FaceModel.load(tmp_path / "faces" / MODEL)
    assert not model.template.refined and model.expressions == ["neutral", "smile", "wink"]
    assert (model.identity_size, model.expression_size) == (12, 3)
    np.testing.assert_array_equal(model.faces, source.template.faces)
    maker, smile = prepare(source, 3), database[database.index(1, "smile")]
    np.testing.assert_allclose(smile.vertices, maker.scale * (source.heads(1)[1] - maker.origin), atol=1e-3)
    face = model.face(*smile.weights)
    np.testing.assert_allclose(face.vertices, smile.vertices, atol=0.1)
    assert {SILHOUETTE, *FEATURES} <= set(face.sketch(wrinkles=False).lines)
    assert face.mesh.faces.shape == model.faces.shape and face.to_bytes("glb")


@pytest.mark.parametrize("name", ["generic_neutral_mesh.obj", "vertex_indices.json"])
def test_missing_file_is_named(clone, name):
    (clone / "FaceXModel" / name).unlink()
    with pytest.raises(FileNotFoundError, match=rf"lacks {name}: .*a clone of https"):
        ICTFaceKitSource(clone)


def test_folder_with_nothing_of_it_says_what_to_give(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"identity000\.obj: give the source 'ict' a clone"):
        ICTFaceKitSource(tmp_path / "nowhere")


def test_clone_without_a_blend_shape_is_refused(clone):
    for file in (clone / "FaceXModel").glob("[me]*_[LR].obj"):
        file.unlink()
    with pytest.raises(FileNotFoundError, match="blend shapes of all expressions: eyeBlinkLeft, jawOpen, mouthSmile"):
        ICTFaceKitSource(clone)


def test_another_head_is_refused(clone):
    write_obj(clone / "FaceXModel" / "generic_neutral_mesh.obj", [*VERTICES, [0, 0, 0]])
    with pytest.raises(ValueError, match=r"generic_neutral_mesh\.obj has 76 vertices; ICT-FaceKit's has 75"):
        ICTFaceKitSource(clone)


@pytest.mark.parametrize(
    "text", ["", "[]", "{}", '{"idx_to_landmark_verts": [1, 2]}', json.dumps({"idx_to_landmark_verts": [0] * 68})]
)
def test_landmarks_that_are_none_are_refused(clone, text):
    (clone / "FaceXModel" / "vertex_indices.json").write_text(text)
    with pytest.raises(ValueError, match=r"vertex_indices\.json has no 68 landmarks"):
        ICTFaceKitSource(clone)


def test_identity_of_another_topology_is_named(source, clone):
    write_obj(clone / "FaceXModel" / "identity001.obj", VERTICES[:-1], FACES[:-1])
    with pytest.raises(ValueError, match=r"identity001\.obj has 74 vertices"):
        source.identity(0)


@pytest.fixture(scope="module")
def real():
    if not CLONE.is_dir():
        pytest.skip("no part of ICT-FaceKit is at hand")
    with pytest.warns(UserWarning, match="lacks the blend shapes browDown"):
        return ICTFaceKitSource(CLONE)


def test_real_head_has_all_parts_one_rim_and_fourteen_curves(real):
    template = real.template
    assert set(np.unique(template.parts)) == set(range(len(PARTS))) and len(template.curves) == 14
    skin = template.coarse_faces[(template.parts[template.coarse_faces] <= PARTS.index("mouth")).all(axis=1)]
    edges = np.sort(np.concatenate([skin[:, [0, 1]], skin[:, [1, 2]], skin[:, [2, 0]]]), axis=1)
    edges, count = np.unique(edges, axis=0, return_counts=True)
    rim = edges[count == 1]
    assert count.max() == 2 and len(rim) == len(np.unique(rim))


def test_real_curves_lie_as_those_of_the_shipped_model(real):
    """Ends, and what is a third of the way on: so left is left, and lines run the same way."""
    shipped = FaceModel.load()
    rest = real._posing._rest
    for name, path in real.template.curves.items():
        points, ours = rest[path], shipped.mean[shipped.curves[name]]
        assert (path[0] == path[-1]) == (name == SILHOUETTE), name
        assert len(set(path)) >= len(path) - 1, name
        np.testing.assert_allclose(points[[0, -1]], ours[[0, -1]], atol=20, err_msg=name)
        np.testing.assert_allclose(points[len(points) // 3], ours[len(ours) // 3], atol=25, err_msg=name)


def test_a_database_of_real_heads_draws(real, tmp_path):
    assert {"smile", "mouth_open", "eyes_closed"} <= set(real.expressions)
    build(real, tmp_path / "faces", identities=1, interpolated=0)
    face = FaceModel.load(tmp_path / "faces" / MODEL).face(expression="mouth_open")
    assert {SILHOUETTE, *FEATURES} <= set(face.sketch().lines)
    gape = face.landmarks[62, 1] - face.landmarks[66, 1]
    assert gape > 8
