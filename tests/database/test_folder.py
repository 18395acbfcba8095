"""Heads from a folder of registered meshes."""

import json

import numpy as np
import pytest
from safetensors import safe_open
from tiny_head import CURVES, FACES, LANDMARKS, VERTICES, write_obj
from typer.testing import CliRunner

from sketchwidget import FaceModel, cli
from sketchwidget.database.build import MODEL, build
from sketchwidget.database.database import FaceDatabase
from sketchwidget.database.folder import MeshFolderSource
from sketchwidget.face import PARTS

HEIGHT_MM = 200 / 6  # of one unit: the tiny head's menton is at -2 and its crown at 4
TOPOLOGY = {
    "expressions": ["rest", "smile", "shock"],
    "neutral": "rest",
    "files": "TrainingPose/pose_*.obj",
    "landmarks": LANDMARKS,
    "curves": CURVES,
    "parts": {"eyes": list(range(64, 72))},
}
TURN = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])  # about the upright axis


def posed(vertices, pose):
    """Rest, a smile that lifts one vertex by 0.3, a shock that lowers it by 0.6."""
    moved = np.array(vertices)
    moved[18, 1] += {0: 0, 2: 0.3, 10: -0.6}[pose]
    return moved


def describe(folder, **changes):
    topology = {key: value for key, value in (TOPOLOGY | changes).items() if value is not None}
    (folder / "topology.json").write_text(json.dumps(topology))


@pytest.fixture
def folder(tmp_path):
    """Three identities as in FaceWarehouse: the second is the first elsewhere and larger, the tenth is broader."""
    for pose in (0, 2, 10):
        file = f"TrainingPose/pose_{pose}.obj"
        write_obj(tmp_path / "Tester_1" / file, posed(VERTICES, pose))
        write_obj(tmp_path / "Tester_2" / file, 3 * posed(VERTICES, pose) @ TURN.T + [5, 6, 7])
        write_obj(tmp_path / "Tester_10" / file, posed(VERTICES, pose) * [1.2, 1, 1])
    for tester in (1, 2, 10):
        write_obj(tmp_path / f"Tester_{tester}" / "Blendshape" / "shape_0.obj")
    (tmp_path / "notes").mkdir()
    describe(tmp_path)
    return tmp_path


def test_files_are_in_the_order_of_their_numbers_and_the_resting_face_is_neutral(folder):
    source = MeshFolderSource(folder)
    assert source.expressions == ("neutral", "smile", "shock") and source.count == 3
    head = source.heads(0)
    assert head.shape == (3, 75, 3) and head.dtype == np.float32
    np.testing.assert_allclose((head - head[0])[:, 18, 1], np.array([0, 0.3, -0.6]) * HEIGHT_MM, atol=1e-4)


def test_heads_are_in_millimetres_and_centred(folder):
    rest = MeshFolderSource(folder).heads(0)[0]
    np.testing.assert_allclose([rest[LANDMARKS[8], 1], rest[:64, 1].max()], [-100, 100], atol=1e-4)


def test_place_size_and_turn_of_an_identity_do_not_matter(folder):
    source = MeshFolderSource(folder)
    np.testing.assert_allclose(source.heads(1), source.heads(0), atol=1e-3)
    assert np.abs(source.heads(2) - source.heads(0)).max() > 1


def test_parts_are_as_described_and_the_rest_is_skin(folder):
    source = MeshFolderSource(folder)
    assert source.template.parts[64:72].tolist() == [PARTS.index("eyes")] * 8
    assert (source.template.parts[:64] == PARTS.index("skin")).all()
    describe(folder, parts=None)
    assert not MeshFolderSource(folder).template.parts.any()


def test_files_named_as_expressions_may_be_in_any_order(tmp_path):
    for name in ("anna", "berta"):
        for pose, expression in ((0, "rest"), (2, "smile"), (10, "shock")):
            write_obj(tmp_path / name / "a" / "b" / f"{expression}.obj", posed(VERTICES, pose))
    describe(tmp_path, files=None, expressions=["smile", "rest", "shock"])
    source = MeshFolderSource(tmp_path)
    assert source.expressions == ("smile", "neutral", "shock")
    head = source.heads(1)
    np.testing.assert_allclose((head - head[1])[:, 18, 1], np.array([0.3, 0, -0.6]) * HEIGHT_MM, atol=1e-4)


def test_vertices_in_no_face_are_left_out(folder):
    loose = np.concatenate([[[9.0, 9.0, 9.0]], VERTICES])
    for file in folder.glob("*/TrainingPose/*.obj"):
        write_obj(file, loose, [[corner + 1 for corner in face] for face in FACES])
    shifted = {name: [vertex + 1 for vertex in path] for name, path in CURVES.items()}
    describe(folder, curves=shifted, landmarks=[vertex + 1 for vertex in LANDMARKS], parts=None)
    source = MeshFolderSource(folder)
    assert source.heads(0).shape == (3, 75, 3)
    np.testing.assert_array_equal(source.template.landmarks, LANDMARKS)
    describe(folder, curves=shifted | {"nose": [0, 1]}, landmarks=LANDMARKS)
    with pytest.raises(ValueError, match="the curve 'nose'"):
        MeshFolderSource(folder)


def test_a_resting_face_is_as_it_is_among_the_others(folder):
    describe(folder, expressions=["smile", "rest", "shock"])
    source = MeshFolderSource(folder)
    for number in range(3):
        np.testing.assert_allclose(source.rest(number), source.heads(number)[1], atol=1e-3)


def test_a_database_of_it_has_its_faces_and_a_model_that_draws(folder, tmp_path):
    source, out = MeshFolderSource(folder), tmp_path / "faces"
    build(source, out, identities=3, interpolated=0)
    model = FaceModel.load(out / MODEL)
    assert not model.template.refined and model.expressions == ["neutral", "smile", "shock"]
    np.testing.assert_array_equal(model.faces, source.template.faces)
    shock = FaceDatabase.open(out)
    shock = shock[shock.index(2, "shock")]
    scale = np.ptp(shock.vertices[:64, 1]) / np.ptp(source.heads(2)[2][:64, 1])
    np.testing.assert_allclose(np.diff(shock.vertices, axis=0), scale * np.diff(source.heads(2)[2], axis=0), atol=1e-3)
    np.testing.assert_allclose(model.face(*shock.weights).vertices, shock.vertices, atol=0.1)
    assert "silhouette" in shock.face.sketch(wrinkles=False).lines and shock.face.to_bytes("obj")


def test_the_rank_is_limited_by_people_and_expressions(folder, tmp_path):
    build(MeshFolderSource(folder), tmp_path / "faces", identities=2, interpolated=0)
    model = FaceModel.load(tmp_path / "faces" / MODEL)
    assert (model.identity_size, model.expression_size) == (2 * 4, 3)
    smaller = FaceDatabase.open(tmp_path / "faces").decompose((5, 2))
    assert (smaller.identity_size, smaller.expression_size) == (5, 2)
    with pytest.raises(ValueError, match="the source folder has 3 identities; 4 were asked for"):
        build(MeshFolderSource(folder), tmp_path / "more", identities=4, interpolated=0)


def test_a_model_of_it_claims_no_licence_of_others(folder, tmp_path):
    def run(*arguments):
        result = CliRunner().invoke(cli.main, [str(argument) for argument in arguments])
        assert result.exit_code == 0, result.output + repr(result.exception)
        return result.output

    faces, file = tmp_path / "faces", tmp_path / "face.safetensors"
    run("database", "--source", "folder", "--path", folder, "--preset", "tiny", "--out", faces)
    told = run("train", "face", faces, "--out", file, "--identity", "4", "--expression", "3")
    assert "75 vertices, 4 identity and 3 expression weights" in " ".join(told.split())
    for path in (file, faces / MODEL):
        with safe_open(path, "numpy") as opened:
            header = opened.metadata()
        assert header["source"] == "folder" and header["licence"] == "that of the faces it was built from"
        assert "sketchwidget" in header["command"] and "tensorly" in header["versions"]
    with safe_open(file, "numpy") as opened:
        assert opened.metadata()["database"] == FaceDatabase.open(faces).sum


def test_a_second_folder_of_the_same_topology_is_another_database(folder, tmp_path):
    build(MeshFolderSource(folder), tmp_path / "faces", identities=3, interpolated=0)
    for file in (folder / "Tester_1").glob("TrainingPose/*.obj"):
        write_obj(file, VERTICES * [1.3, 1, 1])
    with pytest.raises(ValueError, match="was begun with other heads than those that the source folder gives now"):
        build(MeshFolderSource(folder), tmp_path / "faces", identities=3, interpolated=0)


def test_identity_beyond_the_last_is_refused(folder):
    with pytest.raises(IndexError, match="0 to 2; given 3"):
        MeshFolderSource(folder).heads(3)


def test_folder_without_description_says_what_it_wants(folder):
    (folder / "topology.json").unlink()
    with pytest.raises(FileNotFoundError, match=r"has no topology\.json"):
        MeshFolderSource(folder)


def test_folder_without_identities_is_refused(tmp_path):
    describe(tmp_path)
    with pytest.raises(FileNotFoundError, match="no folder with OBJ files"):
        MeshFolderSource(tmp_path)


def test_missing_expression_of_an_identity_is_named(folder):
    (folder / "Tester_2" / "TrainingPose" / "pose_10.obj").unlink()
    with pytest.raises(FileNotFoundError, match=r"lacks .*Tester_2/TrainingPose/pose_10\.obj"):
        MeshFolderSource(folder)


def test_more_files_than_names_are_refused(folder):
    describe(folder, files=None)
    with pytest.raises(ValueError, match=r"has 4 files \*\*/\*\.obj, and .*topology\.json names 3 expressions"):
        MeshFolderSource(folder)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"expressions": None}, "'expressions' is the list"),
        ({"expressions": [1, 2, 3]}, "'expressions' is the list"),
        ({"neutral": "calm"}, "'neutral' is one of rest, smile, shock"),
        ({"neutral": None}, "'neutral' is one of"),
        ({"expressions": ["rest", "smile", "smile"]}, "no two expressions"),
        ({"expressions": ["rest", "smile", "neutral"]}, "no two expressions"),
        ({"curves": None}, "'curves' are left_brow"),
        ({"curves": {"nose": [1, 2]}}, "'curves' are left_brow"),
        ({"curves": CURVES | {"nose": "1, 2"}}, "the curve 'nose' is a list of vertices"),
        ({"curves": CURVES | {"nose": [1, 75]}}, "the curve 'nose' is a list of vertices"),
        ({"curves": CURVES | {"nose": [-1, 2]}}, "the curve 'nose' is a list of vertices"),
        ({"landmarks": None}, "'landmarks' is a list of vertices"),
        ({"landmarks": LANDMARKS[1:]}, "68 landmarks"),
        ({"landmarks": [0.5] * 68}, "'landmarks' is a list of vertices"),
        ({"parts": {"hat": [1]}}, "'parts' has lists of vertices by the names skin"),
        ({"parts": [1]}, "'parts' has lists of vertices by the names skin"),
        ({"parts": {"eyes": [75]}}, "eyes is a list of vertices"),
        ({"parts": {"eyes": 7}}, "eyes is a list of vertices"),
        ({"files": 3}, "'files' is a pattern"),
    ],
)
def test_wrong_description_is_refused_by_name(folder, changes, message):
    describe(folder, **changes)
    with pytest.raises(ValueError, match=r"topology\.json.*" + message):
        MeshFolderSource(folder)


@pytest.mark.parametrize("text", ["", "{", "[]", "3", "\x00"])
def test_description_that_is_none_is_refused(folder, text):
    (folder / "topology.json").write_text(text)
    with pytest.raises(ValueError, match=r"topology\.json"):
        MeshFolderSource(folder)


@pytest.mark.parametrize("axes", [[1, -1, -1], [-1, 1, -1], [-1, 1, 1]])
def test_head_that_stands_otherwise_is_refused(folder, axes):
    for file in folder.glob("*/TrainingPose/*.obj"):
        write_obj(file, VERTICES * axes)
    with pytest.raises(ValueError, match="does not stand upright"):
        MeshFolderSource(folder)


def test_damaged_face_is_named(folder):
    source = MeshFolderSource(folder)
    file = folder / "Tester_10" / "TrainingPose" / "pose_2.obj"
    write_obj(file, VERTICES[:-1], FACES[:-1])
    with pytest.raises(ValueError, match=r"Tester_10/TrainingPose/pose_2\.obj has 74 vertices"):
        source.heads(2)
    write_obj(file, np.where(np.arange(75)[:, None] == 7, np.nan, VERTICES))
    with pytest.raises(ValueError, match=r"pose_2\.obj is damaged: vertex 8 "):
        source.heads(2)
    file.unlink()
    with pytest.raises(FileNotFoundError, match=r"pose_2\.obj"):
        source.heads(2)
