"""Drawings for training, the vertex loss, and the whole build on tiny settings."""

import numpy as np
import pytest
import torch
from typer.testing import CliRunner

from sketchwidget import FaceModel, FaceRegressor, Sketch, cli
from sketchwidget.face import PARTS as HEAD_PARTS
from sketchwidget.inference.network import TINY
from sketchwidget.sketch.hand import Hand
from sketchwidget.training import face_table
from sketchwidget.training.examples import PARTS, Examples, Variety, draw_example
from sketchwidget.training.face_table import LINES, FaceTable, Reshaping, vertex_metric
from sketchwidget.training.network import Schedule, VertexLoss, standardisation, standardised_poses, train


@pytest.fixture(scope="module")
def model():
    return FaceModel.load()


@pytest.fixture(scope="module")
def table(model):
    """Two identities in all expressions, straight from the model."""
    u = [model.mean_identity, model.bilinear.identities[0]]
    v = model.bilinear.expressions
    codes = np.stack([np.stack([model.bilinear.core @ q @ p for q in v]) for p in u])
    paths = np.concatenate([model.curves[name] for name in LINES])
    points = np.stack([np.stack([model.vertices(p, q)[paths] for q in v]) for p in u])
    return FaceTable(points.astype(np.float16), codes, {name: len(model.curves[name]) for name in LINES})


def test_exact_drawing_shows_the_face_s_lines(model, table):
    lines = table.lines(table.points[0, 0].astype(np.float32))
    image = draw_example(lines, set(PARTS), Variety(view=0, hand=None), np.random.default_rng(0))
    for name, line in model.face().sketch(wrinkles=False).lines.items():
        if name != "silhouette":
            pixels = (np.concatenate(line) * 256).astype(int)
            near = [image[y - 6 : y + 7, x - 6 : x + 7].any() for x, y in pixels]
            assert np.mean(near) > 0.9, name


def test_drawn_parts_are_the_ones_asked_for(table):
    lines = {name: points[:, :2] / 250 * [1, -1] + 0.5 for name, points in table.lines(table.points[0, 0]).items()}
    random = np.random.default_rng(1)
    for _ in range(50):
        parts = {part for part in PARTS if random.random() < 0.5}
        drawn = Hand(extras=0).draw(lines, parts, random)
        assert set(drawn) == parts
        assert all(np.isfinite(stroke).all() and np.abs(stroke - 0.5).max() < 1 for s in drawn.values() for stroke in s)


def test_batches_depend_on_seed_and_number_only(model, table):
    def batch(start):
        return next(
            iter(Examples(table, model.expressions, standardised_poses(model), Variety(), 3, seed=5, start=start))
        )

    np.testing.assert_array_equal(batch(2)[0], batch(2)[0])
    assert (batch(2)[0] != batch(3)[0]).any()
    from_start = iter(Examples(table, model.expressions, standardised_poses(model), Variety(), 3, seed=5))
    third = [next(from_start) for _ in range(3)][2]
    np.testing.assert_array_equal(third[1], batch(2)[1])


def test_left_out_faces_are_never_drawn(model, table):
    left_out = np.ones(table.codes.shape[:2], dtype=bool)
    left_out[1, 3] = False
    examples = Examples(table, model.expressions, standardised_poses(model), Variety(), 1, seed=0, left_out=left_out)
    assert {examples._pick(np.random.default_rng(k)) for k in range(20)} == {(1, 3)}


def test_a_face_without_a_mouth_is_a_quiet_one(model, table):
    examples = Examples(table, model.expressions, standardised_poses(model), Variety(), 1, seed=0)
    quiet = {
        tuple(np.round(table.codes[i, model.expressions.index(n)][:3]))
        for i in (0, 1)
        for n in ("neutral", "eyes_closed")
    }
    random = np.random.default_rng(3)
    for _ in range(30):
        _, code, _ = examples._face(random, quiet=True)
        mouth = model.bilinear.mean + model.bilinear.basis @ code
        fine = model.template.subdivision @ mouth.reshape(-1, 3)
        gap = fine[model.curves["mouth_upper"][24], 1] - fine[model.curves["mouth_lower"][14], 1]
        assert gap < 5
    assert quiet


@pytest.mark.parametrize("way", ["width", "height", "jaw", "crown"])
def test_reshaping_moves_the_mesh_as_it_moves_the_points(model, table, way):
    before = table.points[0, 0].astype(np.float32)
    points, code = Reshaping(model)(before, table.codes[0, 0], {way: 0.15})
    fine = model.template.subdivision @ (model.bilinear.mean + model.bilinear.basis @ code).reshape(-1, 3)
    paths = np.concatenate([model.curves[name] for name in LINES])
    assert np.abs(fine[paths] - points).mean() < 1.5  # mm: what the vertex basis can hold of it
    axis = 1 if way == "height" else 0
    low, high = before[:, 1].min(), before[:, 1].max()
    part = {"jaw": before[:, 1] < low + 50, "crown": before[:, 1] > high - 50}.get(way, np.ones(len(before), bool))
    grown = np.ptp(points[part, axis]) / np.ptp(before[part, axis])
    assert grown == pytest.approx(1.15, abs=0.07)
    np.testing.assert_array_equal(np.delete(points, axis, axis=1), np.delete(before, axis, axis=1))


def test_vertex_loss_is_the_weighted_distance_of_the_vertices(model, table):
    """Equation 2 written out over all fine vertices."""
    metric = vertex_metric(model)
    difference = np.random.default_rng(2).normal(size=len(metric))
    moved = model.template.subdivision @ (model.bilinear.basis @ difference).reshape(-1, 3)
    weights = np.array([face_table._PART_WEIGHTS[part] for part in HEAD_PARTS])[model.template.fine_parts]
    weights[np.unique(np.concatenate([model.curves[name] for name in LINES]))] *= face_table._LINE_WEIGHT
    expected = (weights * (moved**2).sum(axis=1)).sum() / weights.sum()
    assert difference @ metric @ difference == pytest.approx(expected, rel=1e-3)
    loss = VertexLoss(model, metric)
    statistics = standardisation(model)
    u, v = model.bilinear.identities[0], model.bilinear.expressions[1]
    p = torch.from_numpy((u - statistics["identity_mean"]) / statistics["identity_std"])[None]
    q = torch.from_numpy((v - statistics["expression_mean"]) / statistics["expression_std"])[None]
    assert loss(p, q, torch.from_numpy(table.codes[1, 1])[None]).item() == pytest.approx(0.1, abs=0.02)  # its floor


def test_training_learns_and_resumes(model, table, tmp_path):
    metric = vertex_metric(model)
    schedule = Schedule(steps=30, batch=8, rate=3e-3, checkpoint=10)

    def run(steps, folder):
        examples = Examples(
            table, model.expressions, standardised_poses(model), Variety(partial=0, missing=0), 8, seed=0
        )
        return train(
            model, metric, examples, Schedule(**{**schedule.__dict__, "steps": steps}), folder, TINY, workers=0
        )

    run(30, tmp_path / "whole")
    curve = torch.load(tmp_path / "whole" / "checkpoint.pt", weights_only=True)
    assert curve["step"] == 30
    resumed = run(40, tmp_path / "whole")
    assert all(torch.isfinite(weight).all() for weight in resumed.state_dict().values())
    assert torch.load(tmp_path / "whole" / "checkpoint.pt", weights_only=True)["step"] == 40


def test_learning_rate_rises_then_falls_to_nothing():
    schedule = Schedule(steps=120, rate=1.0)
    rates = [schedule.rate_at(step) for step in range(120)]
    assert np.argmax(rates) in (9, 10) and max(rates) == pytest.approx(1.0)
    assert rates[-1] < 0.01 and (np.diff(rates[10:]) < 0).all()


def test_commands_build_a_tiny_face_model_and_network(tmp_path):
    def run(*arguments):
        result = CliRunner().invoke(cli.main, [str(argument) for argument in arguments])
        assert result.exit_code == 0, result.output + repr(result.exception)

    face, network, work = tmp_path / "face.safetensors", tmp_path / "network.safetensors", tmp_path / "work"
    run("train", "face", "--tiny", "--out", face, "--work", work)
    run("train", "network", "--tiny", "--out", network, "--model", face, "--work", work)
    model = FaceModel.load(face)
    assert model.identity_size == 6
    oval = np.stack([0.5 + 0.3 * np.cos(np.arange(0, 7, 0.1)), 0.5 + 0.4 * np.sin(np.arange(0, 7, 0.1))], axis=1)
    head = FaceRegressor.load(str(network), model).predict(Sketch.from_strokes([oval]))
    assert np.isfinite(head.vertices).all()


def test_tiny_builds_replace_nothing_that_is_shipped(tmp_path):
    shipped = FaceModel.load().bilinear.core.copy()
    result = CliRunner().invoke(cli.main, ["train", "face", "--tiny", "--work", str(tmp_path)])
    assert result.exit_code == 0 and (tmp_path / "face.safetensors").exists()
    np.testing.assert_array_equal(FaceModel.load().bilinear.core, shipped)


def test_bad_use_of_the_commands_ends_with_a_message(tmp_path):
    for arguments in (["train"], ["train", "nose"], ["evaluate", "--faces", "0"]):
        result = CliRunner().invoke(cli.main, arguments)
        assert result.exit_code != 0 and "Traceback" not in result.output
