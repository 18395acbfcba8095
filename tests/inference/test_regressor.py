"""From drawings to heads with the shipped network."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from safetensors import safe_open
from safetensors.torch import save_file
from scipy.spatial import KDTree

from sketchwidget import FaceModel, FaceRegressor, Sketch
from sketchwidget.files.shipped import shipped
from sketchwidget.inference.network import TINY, PixelShapeCNN
from sketchwidget.inference.network_file import save_network
from sketchwidget.inference.normalise import normalise
from sketchwidget.inference.regressor import soft_limit
from sketchwidget.inference.shape_code import COUNTS, DETAILS, ShapeModel
from sketchwidget.training.standard import standardisation

EAR = np.array([[0.23, 0.44], [0.19, 0.43], [0.18, 0.5], [0.2, 0.57], [0.24, 0.58]])
HAIR = np.array([[0.21, 0.5], [0.22, 0.25], [0.35, 0.08], [0.5, 0.04], [0.65, 0.08], [0.78, 0.25], [0.79, 0.5]])


def mouth_height(face):
    return face.curve("mouth_upper")[24, 1] - face.curve("mouth_lower")[14, 1]


def corner_lift(face):
    """How far the corners of the mouth stand above its middle, mm."""
    line = face.curve("mouth_lower")
    return line[[0, -1], 1].mean() - line[14, 1]


def test_an_empty_pad_is_the_mean_face(regressor):
    result = regressor.infer(Sketch())
    np.testing.assert_allclose(result.face.vertices, regressor.model.mean, atol=1e-4)
    assert result.names == ()


def test_the_same_drawing_moved_or_scaled_gives_the_same_face(regressor, drawing):
    face = regressor.predict(Sketch.from_strokes(drawing))
    for scale, offset in ((0.5, [0.1, 0.3]), (0.8, [0.15, 0.05]), (1.1, [-0.05, -0.05])):
        moved = regressor.predict(Sketch.from_strokes([scale * stroke + offset for stroke in drawing]))
        assert np.linalg.norm(moved.landmarks - face.landmarks, axis=1).max() < 1.0


def test_ears_and_hair_do_not_shift_the_rest(regressor, drawing):
    face = regressor.predict(Sketch.from_strokes(drawing))
    for added in ([EAR, [1, 0] + EAR * [-1, 1]], [HAIR], [HAIR, EAR, [1, 0] + EAR * [-1, 1]]):
        other = regressor.predict(Sketch.from_strokes([*drawing, *added]))
        assert np.linalg.norm(other.landmarks - face.landmarks, axis=1).max() < 1.6


def test_broad_ears_are_broad_on_the_head(regressor, drawing):
    def breadth(factor):
        ear = EAR.max(axis=0) + [factor, 1.0] * (EAR - EAR.max(axis=0))
        face = regressor.predict(Sketch.from_strokes([*drawing, ear, [1, 0] + ear * [-1, 1]]))
        return np.array([np.ptp(face.curve(f"{side}_ear")[:, 0]) for side in ("left", "right")])

    assert (breadth(0.5) < breadth(1.0) - 0.5).all() and (breadth(1.0) < breadth(1.5) - 0.5).all()


@pytest.mark.parametrize("size", [0.006, 0.012, 0.02])
def test_a_dot_for_a_mouth_says_where_it_is_and_not_how_broad(regressor, drawing, size):
    plain = regressor.predict(Sketch.from_strokes(drawing)).curve("mouth_upper")
    angle = np.linspace(0, 2 * np.pi, 20)
    dot = np.array([0.5, 0.73]) + size * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    mouth = regressor.predict(Sketch.from_strokes([*drawing[:4], dot])).curve("mouth_upper")
    assert np.ptp(mouth[:, 0]) > 0.5 * np.ptp(plain[:, 0])


def test_large_and_high_ears_are_ears_and_what_is_no_ear_there_is_nothing(regressor, drawing):
    high = EAR - [0.0, 0.06]
    large = EAR.max(axis=0) - 1.6 * (EAR.max(axis=0) - EAR) + [0.0, 0.05]
    beside = np.array([[0.14, 0.3], [0.12, 0.4], [0.13, 0.5]])
    names = [regressor.infer(Sketch.from_strokes([*drawing, stroke])).names[-1] for stroke in (high, large, beside)]
    assert names == ["right_ear", "right_ear", "unnamed"]


def test_ears_are_followed_by_their_lines_alone(regressor, drawing):
    unrefined = FaceRegressor.load(refine=False)
    with_ears = Sketch.from_strokes([*drawing, EAR, [1, 0] + EAR * [-1, 1]])
    faces = [unrefined.predict(sketch) for sketch in (with_ears, Sketch.from_strokes(drawing))]
    np.testing.assert_array_equal(faces[0].vertices, faces[1].vertices)


def test_some_of_the_lines_already_give_a_sensible_face(regressor, drawing):
    for count in (1, 2, 3):
        face = regressor.predict(Sketch.from_strokes(drawing[:count]))
        assert np.abs(face.vertices - regressor.model.mean).max() < 60
        assert mouth_height(face) < 6  # no mouth is drawn: it is shut


def test_a_broad_outline_gives_a_broad_head(regressor, drawing):
    def ratio(factor):
        strokes = [[0.5, 0] + (stroke - [0.5, 0]) * [factor, 1] for stroke in drawing]
        outline = regressor.predict(Sketch.from_strokes(strokes)).curve("silhouette")
        return np.ptp(outline[:, 0]) / np.ptp(outline[:, 1])

    assert ratio(0.85) < ratio(1.0) - 0.02 < ratio(1.2) - 0.04


def test_an_outline_alone_already_shapes_the_head(regressor, drawing):
    def ratio(factor):
        oval = [0.5, 0.0] + (drawing[0] - [0.5, 0.0]) * [factor, 1.0]
        outline = regressor.predict(Sketch.from_strokes([oval])).curve("silhouette")
        return np.ptp(outline[:, 0]) / np.ptp(outline[:, 1])

    assert ratio(0.85) < ratio(1.0) - 0.04 < ratio(1.2) - 0.08


def test_a_smile_smiles_a_frown_frowns_and_an_open_mouth_opens(regressor, drawing):
    def with_mouth(points):
        return regressor.predict(Sketch.from_strokes([*drawing[:4], np.array(points)]))

    smile = with_mouth([[0.38, 0.68], [0.43, 0.72], [0.5, 0.74], [0.57, 0.72], [0.62, 0.68]])
    frown = with_mouth([[0.41, 0.755], [0.45, 0.73], [0.5, 0.72], [0.55, 0.73], [0.59, 0.755]])
    flat = regressor.predict(Sketch.from_strokes(drawing))
    assert corner_lift(smile) > corner_lift(flat) + 2
    assert corner_lift(frown) < corner_lift(flat) - 1
    angle = np.linspace(0, 2 * np.pi, 40)
    shout = with_mouth(np.stack([0.5 + 0.06 * np.cos(angle), 0.75 + 0.075 * np.sin(angle)], axis=1))
    assert mouth_height(shout) > mouth_height(flat) + 12


def test_strokes_are_named(regressor, drawing):
    result = regressor.infer(Sketch.from_strokes([*drawing, EAR, HAIR]))
    assert result.names[0] == "silhouette"
    assert result.names[1].startswith("right_eye") and result.names[2].startswith("left_eye")
    assert result.names[3] == "nose" and result.names[4].startswith("mouth")
    assert result.names[5] == "right_ear" and result.names[6] == "unnamed"


def short(name):
    """A line's name without which contour of it: ruy is the right eye, lb the left brow."""
    side, _, rest = name.partition("_")
    return side[0] + rest[0] if rest and side in ("left", "right") else name.split("_")[0]


def test_a_mouth_far_from_where_the_network_sees_one_is_a_mouth_and_not_a_wrinkle(regressor):
    """A broad, low smile under two lidded eyes: a brow was enough to make a wrinkle of it."""

    def arc(*points):
        at = np.array(points, dtype=float)
        return np.stack([np.interp(np.linspace(0, 2, 25), [0, 1, 2], at[:, axis]) for axis in (0, 1)], axis=1)

    angle = np.linspace(-np.pi / 2, 1.5 * np.pi, 60)
    strokes = [
        np.stack([0.5 + 0.29 * np.cos(angle), 0.5 + 0.38 * np.sin(angle)], axis=1),
        *(arc([x, 0.45], [x + 0.07, y], [x + 0.14, 0.45]) for x in (0.3, 0.56) for y in (0.41, 0.47)),
        arc([0.36, 0.7], [0.51, 0.78], [0.64, 0.7]),
        arc([0.45, 0.58], [0.5, 0.61], [0.55, 0.58]),
        arc([0.27, 0.37], [0.36, 0.32], [0.44, 0.36]),
    ]
    for count in range(6, len(strokes) + 1):
        names = regressor.infer(Sketch.from_strokes(strokes[:count])).names
        assert names[5].startswith("mouth"), f"after {count} strokes: {names}"
    lips = [*strokes[:5], arc([0.36, 0.72], [0.5, 0.74], [0.64, 0.72]), arc([0.36, 0.72], [0.5, 0.82], [0.64, 0.72])]
    assert all(name.startswith("mouth") for name in regressor.infer(Sketch.from_strokes(lips)).names[5:])
    chin = [0.47, 0.84], [0.5, 0.845], [0.53, 0.84]
    assert regressor.infer(Sketch.from_strokes([*strokes, arc(*chin)])).names[-1] == "wrinkle"


@pytest.mark.parametrize("eye", ["round", "lids", "closed"])
def test_a_brow_of_two_lines_is_a_brow_and_no_eye(regressor, drawing, eye):
    turn = np.linspace(0, 2 * np.pi, 40)
    across, arch = np.linspace(-1, 1, 20), 1 - np.linspace(-1, 1, 20) ** 2

    def face(middle):
        eyes = {
            "round": [np.stack([middle + 0.055 * np.cos(turn), 0.46 + 0.025 * np.sin(turn)], axis=1)],
            "lids": [np.stack([middle + 0.055 * across, 0.46 + lid * arch], axis=1) for lid in (-0.025, 0.02)],
            "closed": [np.stack([middle + 0.055 * across, 0.46 + 0.015 * arch], axis=1)],
        }
        brow = [np.stack([middle + 0.09 * across, 0.405 - rise * arch], axis=1) for rise in (0.02, 0.035)]
        return eyes[eye], brow

    right, left = face(0.385), face(0.615)
    strokes = [drawing[0], *right[0], *left[0], *drawing[3:], *right[1], *left[1]]
    names = [short(name) for name in regressor.infer(Sketch.from_strokes(strokes)).names]
    assert names[-4:] == ["rb", "rb", "lb", "lb"]
    count = len(right[0])
    assert names[1 : 1 + 2 * count] == ["re"] * count + ["le"] * count


@pytest.mark.parametrize(
    ("drawing", "expected"),
    [
        ("03_smiley", "silhouette re re le le mouth"),
        ("04_calm", "silhouette re re re le le le rb lb nose mouth re le"),
        ("06_surprised", "silhouette re le re re le le rb lb nose mouth"),
        ("07_angry", "silhouette re re re le le le rb lb nose mouth wrinkle wrinkle"),
        ("08_laughing", "silhouette re le rb lb nose mouth mouth"),
        ("09_wink", "silhouette re re re le rb lb nose mouth"),
        ("22_wink_left", "silhouette re re le rb lb nose mouth"),
        ("11_broad_jowls", "silhouette re re re le le le rb lb nose mouth re le"),
    ],
)
def test_freehand_strokes_are_named_as_they_were_meant(regressor, drawing, expected):
    path = Path(__file__).parents[2] / "docs" / "freehand" / f"{drawing}.json"
    assert [short(name) for name in regressor.infer(Sketch.load(path)).names] == expected.split()


def test_weights_stay_where_heads_are_sound():
    values = np.array([-20.0, -2.0, 0.0, 1.5, 4.0, 100.0])
    bent = soft_limit(values, 3.0, 5.0)
    np.testing.assert_array_equal(bent[1:4], values[1:4])
    assert (np.abs(bent) <= 5.0).all() and 3 < bent[4] < 4 and (np.diff(bent) > 0).all()


def test_the_head_stands_where_the_drawing_is(regressor, drawing):
    result = regressor.infer(Sketch.from_strokes([0.6 * stroke + [0.3, 0.1] for stroke in drawing]))
    outline = result.frame.project(result.face.curve("silhouette"))
    np.testing.assert_allclose(outline.min(axis=0), 0.6 * drawing[0].min(axis=0) + [0.3, 0.1], atol=0.03)
    np.testing.assert_allclose(outline.max(axis=0), 0.6 * drawing[0].max(axis=0) + [0.3, 0.1], atol=0.03)


@given(st.lists(st.lists(st.tuples(st.floats(-1, 2), st.floats(-1, 2)), min_size=1, max_size=6), max_size=6))
@settings(max_examples=25)
def test_any_strokes_give_a_finite_head(strokes):
    face = _cached().predict(Sketch.from_strokes([np.array(stroke) for stroke in strokes]))
    assert np.isfinite(face.vertices).all()
    assert np.abs(face.vertices).max() < 400


def _cached(made=[]):  # noqa: B006  (hypothesis cannot take the fixture)
    if not made:
        made.append(FaceRegressor.load())
    return made[0]


def untrained(model, layout=TINY):
    """A network of random weights, and a shape model about the mean face."""
    torch.manual_seed(0)
    random, size = np.random.default_rng(0), 2 * sum(COUNTS.values())
    p, q = model.identity_size, model.expression_size
    shape_model = ShapeModel(
        mean=random.uniform(0.3, 0.7, size).astype(np.float32),
        core=random.normal(0, 0.01, (size, p, q)).astype(np.float32),
        identity_mean=random.normal(0, 0.1, p).astype(np.float32),
        identity_std=np.full(p, 0.1, np.float32),
        expression_mean=random.normal(0, 0.1, q).astype(np.float32),
        expression_std=np.full(q, 0.1, np.float32),
        detail_mean=random.normal(0, 1, 3 * size // 2).astype(np.float32),
        detail_axes=random.normal(0, 0.01, (3 * size // 2, DETAILS)).astype(np.float32),
        detail_trust=np.ones(DETAILS, np.float32),
    )
    return PixelShapeCNN(p, q, layout).eval(), shape_model


def kept(path, model, layout=TINY, refine=True):
    network, shape_model = untrained(model, layout)
    save_network(path, network, standardisation(model), shape_model, model, {"command": "test"})
    return FaceRegressor.load(str(path), model, refine)


def test_networks_are_tied_to_their_face_model(tmp_path):
    model = FaceModel.load()
    again = kept(tmp_path / "tiny.safetensors", model)
    network, shape_model = untrained(model)
    image = Sketch.from_strokes([EAR, HAIR]).image()[None]
    codes = np.random.default_rng(1).normal(size=(1, 66)).astype(np.float32)
    expected = FaceRegressor(model, network, standardisation(model), shape_model)
    for arguments in ((image,), (image, codes)):
        for ours, theirs in zip(again.weights(*arguments), expected.weights(*arguments), strict=True):
            np.testing.assert_allclose(ours, theirs, atol=1e-3)  # weights are kept as bfloat16
    assert (again.weights(image)[0] != again.weights(image, codes)[0]).any()
    np.testing.assert_allclose(again.shape_model.core, shape_model.core, atol=1e-4)
    np.testing.assert_array_equal(again.shape_model.mean, shape_model.mean)
    model.bilinear.core[:] += 1
    with pytest.raises(ValueError, match="another face model"):
        FaceRegressor.load(str(tmp_path / "tiny.safetensors"), model)


def test_the_shape_of_the_lines_counts_once_there_is_an_outline(tmp_path, drawing):
    regressor = kept(tmp_path / "tiny.safetensors", FaceModel.load(), refine=False)
    assert regressor.sees == ("pixels", "shape") and regressor.shape_model is not None
    for strokes, counts in ((drawing, True), (drawing[1:], False)):
        sketch = Sketch.from_strokes(strokes)
        identity, _ = regressor.weights(normalise([segment.points for segment in sketch.segments]).face[None])
        assert (np.abs(regressor.predict(sketch).identity - identity[0]).max() > 1e-3) == counts


def test_a_network_of_pixels_answers_by_them_alone(tmp_path, drawing):
    regressor = kept(tmp_path / "pixels.safetensors", FaceModel.load(), replace(TINY, shape=0), refine=False)
    assert regressor.sees == ("pixels",) and regressor.shape_model is None
    sketch = Sketch.from_strokes(drawing)
    image = normalise([segment.points for segment in sketch.segments]).face[None]
    identity, expression = regressor.weights(image)
    face = regressor.predict(sketch)
    np.testing.assert_allclose(face.identity, identity[0], atol=1e-4)
    np.testing.assert_allclose(face.expression, expression[0], atol=1e-4)
    codes = np.ones((1, 66), np.float32)
    np.testing.assert_array_equal(regressor.weights(image, codes)[0], identity)


def test_codes_that_are_too_short_are_refused(tmp_path):
    regressor = kept(tmp_path / "tiny.safetensors", FaceModel.load())
    image = np.zeros((1, 256, 256), dtype=bool)
    for codes, named in ((np.ones((1, 50), np.float32), r"float32 \(1, 50\)"), ("no", "'no'")):
        with pytest.raises(ValueError, match=rf"\(b, 66\) or longer of numbers; given {named}"):
            regressor.weights(image, codes)


@pytest.mark.parametrize(
    ("images", "named"),
    [
        (None, "None"),
        (np.zeros((256, 256), dtype=bool), r"bool \(256, 256\)"),
        (np.zeros((1, 128, 128), dtype=bool), r"bool \(1, 128, 128\)"),
        (np.full((1, 256, 256), np.nan), r"float64 \(1, 256, 256\)"),
    ],
)
def test_images_of_another_kind_are_refused(regressor, images, named):
    with pytest.raises(ValueError, match=rf"images are bool arrays \(b, 256, 256\); given {named}"):
        regressor.weights(images)


@pytest.mark.parametrize("arguments", [{"name": 5}, {"model": "face"}, {"refine": "no"}])
def test_a_network_is_loaded_by_arguments_of_their_types(arguments):
    with pytest.raises(TypeError, match="by its name or path, with a FaceModel, and refine is true or false; given"):
        FaceRegressor.load(**arguments)


def test_refining_brings_the_lines_nearer_to_the_drawn_ones(tmp_path, drawing):
    model, sketch = FaceModel.load(), Sketch.from_strokes(drawing)

    def misfit(refine):
        result = kept(tmp_path / "pixels.safetensors", model, replace(TINY, shape=0), refine).infer(sketch)
        outline = result.frame.project(result.face.curve("silhouette"))
        return KDTree(drawing[0]).query(outline)[0].mean()

    assert misfit(True) < 0.9 * misfit(False)


def test_a_network_of_lines_alone_wants_their_codes(tmp_path):
    regressor = kept(tmp_path / "lines.safetensors", FaceModel.load(), replace(TINY, convolutions="none"))
    assert regressor.sees == ("shape",)
    images, codes = np.zeros((2, 256, 256), dtype=bool), np.ones((2, 66), dtype=np.float32)
    identity, expression = regressor.weights(images, codes)
    assert identity.shape == (2, 50) and expression.shape == (2, 16)
    with pytest.raises(ValueError, match="sees lines only"):
        regressor.weights(images)


def test_the_shipped_network_has_two_names(regressor, drawing):
    pixels = FaceRegressor.load("PixelCNN", regressor.model)
    assert regressor.shape_model is not None and pixels.shape_model is None
    image = Sketch.from_strokes(drawing).image()[None]
    for ours, theirs in zip(pixels.weights(image), regressor.weights(image), strict=True):
        np.testing.assert_array_equal(ours, theirs)
    sketch = Sketch.from_strokes(drawing)
    assert (pixels.predict(sketch).vertices != regressor.predict(sketch).vertices).any()


def test_what_is_no_drawing_is_refused(tmp_path):
    with pytest.raises(TypeError, match=r"a drawing is a Sketch, as Sketch\.from_strokes makes; given list"):
        kept(tmp_path / "tiny.safetensors", FaceModel.load()).predict([EAR])


def test_files_that_are_no_network_say_so(tmp_path):
    with pytest.raises(FileNotFoundError, match="no network 'AlexNet'"):
        FaceRegressor.load("AlexNet")
    (tmp_path / "text").write_text("nothing")
    with pytest.raises(ValueError, match="no safetensors file"):
        FaceRegressor.load(str(tmp_path / "text"))
    with pytest.raises(ValueError, match="is no network"):
        FaceRegressor.load(shipped("face.safetensors"))
    kept(tmp_path / "network", FaceModel.load())
    with pytest.raises(ValueError, match="is no face model"):
        FaceModel.load(tmp_path / "network")


@pytest.mark.parametrize("name", ["shared.0.weight", "shape_outputs.1.bias", "shape.core", "identity_std"])
def test_a_network_that_lacks_a_tensor_is_damaged(tmp_path, name):
    model = FaceModel.load()
    kept(tmp_path / "whole", model)
    with safe_open(tmp_path / "whole", "pt") as file:
        header, tensors = file.metadata(), {key: file.get_tensor(key) for key in file.keys()}  # noqa: SIM118
    del tensors[name]
    save_file(tensors, tmp_path / "damaged", header)
    with pytest.raises(ValueError, match="damaged network"):
        FaceRegressor.load(str(tmp_path / "damaged"), model)


@pytest.mark.parametrize("layout", [None, "", "{}", '{"channels": [8], "blocks": [0], "towers": 3}', '{"hidden": 3}'])
def test_a_network_whose_layout_is_none_is_damaged(tmp_path, layout):
    model = FaceModel.load()
    kept(tmp_path / "whole", model)
    with safe_open(tmp_path / "whole", "pt") as file:
        header, tensors = file.metadata(), {key: file.get_tensor(key) for key in file.keys()}  # noqa: SIM118
    header = {key: value for key, value in (header | {"layout": layout}).items() if value is not None}
    save_file(tensors, tmp_path / "damaged", header)
    with pytest.raises(ValueError, match="damaged network"):
        FaceRegressor.load(str(tmp_path / "damaged"), model)


def test_shipped_network_is_small():
    assert shipped("pixelshapecnn.safetensors").stat().st_size < 14e6
