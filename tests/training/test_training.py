"""Training a network: its loss, its schedule, its team, and the commands."""

import hashlib
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
import torch
from safetensors import safe_open
from safetensors.torch import save_file
from typer.testing import CliRunner

from sketchwidget import FaceModel, FaceRegressor, Sketch, cli
from sketchwidget.database.database import Interpolated
from sketchwidget.database.drawings import Drawing, write_drawings
from sketchwidget.face.bilinear import fit_identity
from sketchwidget.inference.network import TINY, PixelShapeCNN
from sketchwidget.inference.network_file import read_network
from sketchwidget.training.curve import Curve, read_curve
from sketchwidget.training.evaluate import test_set
from sketchwidget.training.examples import Variety
from sketchwidget.training.face_table import vertex_metric
from sketchwidget.training.loss import VertexLoss
from sketchwidget.training.manners import Manner
from sketchwidget.training.network import Schedule, train
from sketchwidget.training.pipeline import Pipeline
from sketchwidget.training.standard import standardisation, standardised_pose
from sketchwidget.training.tasks import Classes, Faces, Weights, standardised_identities
from sketchwidget.training.team import Team

ANGLE = np.arange(0, 7, 0.1)
OVAL = np.stack([0.5 + 0.3 * np.cos(ANGLE), 0.5 + 0.4 * np.sin(ANGLE)], axis=1)
EXACT = Variety(manners={Manner.EXACT: 1.0}, mixed=0.0, blended=0.0)


@pytest.fixture(scope="module")
def metric(database):
    return vertex_metric(database.model)


def test_standardised_weights_have_mean_0_and_deviation_1(model):
    statistics = standardisation(model)
    np.testing.assert_allclose(statistics["identity_mean"], model.bilinear.identities.mean(axis=0))
    poses = standardised_pose(model, model.bilinear.expressions)
    np.testing.assert_allclose(poses.mean(axis=0), 0, atol=1e-4)
    np.testing.assert_allclose(poses.std(axis=0), 1, atol=1e-4)


def standardised(model, u, v):
    """Weights as a network gives them, a batch of one."""
    statistics = standardisation(model)
    p = (u - statistics["identity_mean"]) / statistics["identity_std"]
    q = (v - statistics["expression_mean"]) / statistics["expression_std"]
    return torch.from_numpy(p)[None], torch.from_numpy(q)[None]


def test_the_vertex_loss_of_the_right_weights_is_its_floor(database, metric):
    model = database.model
    u, v = model.bilinear.identities[5], model.bilinear.expressions[1]
    loss = VertexLoss(model, metric)
    p, q = standardised(model, u, v)
    for ours, theirs in zip(loss.weights(p, q), (u, v), strict=True):
        np.testing.assert_allclose(ours[0].numpy(), theirs, atol=1e-5)
    code = torch.from_numpy(model.bilinear.core @ v @ u)[None]
    assert loss(p, q, code).item() == pytest.approx(0.1, abs=0.02)


def test_the_vertex_loss_is_a_distance_in_millimetres(database, metric):
    """All vertices 3 mm further on are 3 mm away, whatever they weigh."""
    model = database.model
    u, v = model.bilinear.identities[5], model.bilinear.expressions[1]
    code = model.bilinear.core @ v @ u
    random = np.random.default_rng(0)
    change = random.normal(size=code.shape).astype(np.float32)
    expected = np.sqrt(change @ metric @ change)
    loss = VertexLoss(model, metric)(*standardised(model, u, v), torch.from_numpy(code + change)[None]).item()
    assert loss == pytest.approx(np.sqrt(expected**2 + 0.01), rel=1e-2)
    shift = np.tile([0.0, 3.0, 0.0], len(model.bilinear.mean) // 3)
    held = model.bilinear.basis.T @ shift
    assert np.sqrt(held @ metric @ held) <= 3.01


def test_learning_rate_rises_stays_level_and_falls_to_nothing():
    schedule = Schedule(steps=5000, rate=1.0)
    rates = np.array([schedule.rate_at(step) for step in range(5000)])
    assert schedule.level == 4000
    np.testing.assert_allclose(np.diff(rates[:500]), 1 / 500)
    assert (rates[500:4000] == 1.0).all()
    assert (np.diff(rates[3999:]) < 0).all() and 0 < rates[-1] < 0.01


def network(database, layout=TINY):
    torch.manual_seed(7)
    return PixelShapeCNN(database.model.identity_size, database.model.expression_size, layout)


def faces(database, metric, layout=TINY):
    return Faces(network(database, layout), database.model, metric)


def test_training_learns_and_tells_how_it_goes(database, pipeline, metric, tmp_path):
    model, examples = database.model, pipeline.examples(EXACT, 8)
    schedule = Schedule(steps=60, batch=8, rate=5e-3, checkpoint=25, warming=5, averaging=0.8)
    trained = train(faces(database, metric), examples, schedule, tmp_path / "run", workers=0)
    assert not trained.training
    untrained = network(database).eval()
    images, shapes, codes, *_ = map(torch.from_numpy, pipeline.examples(EXACT, 16).numbered(10_000))
    loss = VertexLoss(model, metric)

    def errors(regressor):
        with torch.inference_mode():
            return [loss(*answer, codes).item() for answer in regressor(images.float(), shapes)]

    assert all(after < 0.7 * before for before, after in zip(errors(untrained), errors(trained), strict=True))
    columns, ((step, _, pixels, shape),) = read_curve(tmp_path / "run" / "curve.csv")
    assert columns == ["step", "seconds", "pixels", "shape"]
    assert step == 50 and pixels > 0 and shape > 0


class Stopped(Exception):
    pass


@pytest.fixture
def sitting(database, pipeline, metric, tmp_path):
    """One sitting of a training in a folder: the network, if it was not stopped, and the batches that it saw."""

    def sit(folder, steps, stop_at=None):
        examples = pipeline.examples(Variety(), 2)
        numbered, seen = examples.numbered, []

        def counted(number):
            if number == stop_at:
                raise Stopped
            seen.append(number)
            return numbered(number)

        examples.numbered = counted
        schedule, unseen = Schedule(steps=steps, batch=2, checkpoint=2), pipeline.examples(EXACT, 4)
        try:
            task = faces(database, metric)
            return train(task, examples, schedule, tmp_path / folder, workers=0, unseen=unseen), seen
        except Stopped:
            return None, seen

    return sit


def assert_same_weights(one, other, **tolerance):
    for name, weight in other.state_dict().items():
        torch.testing.assert_close(one.state_dict()[name], weight, msg=name, **tolerance)


def test_training_that_was_stopped_goes_on_as_if_it_was_not(sitting, tmp_path):
    whole, seen = sitting("whole", 6)
    assert seen == [0, 1, 2, 3, 4, 5]
    assert sitting("stopped", 6, stop_at=5) == (None, [0, 1, 2, 3, 4])
    assert torch.load(tmp_path / "stopped" / "last.pt", weights_only=True)["step"] == 5
    resumed, seen = sitting("stopped", 6)
    assert seen == [5]
    assert_same_weights(resumed, whole, atol=1e-4, rtol=1e-3)
    again, seen = sitting("stopped", 6)
    assert seen == []
    assert_same_weights(again, resumed, atol=0, rtol=0)
    kept = {"last.pt", "level.pt", "curve.csv", "unseen.csv"}
    assert {path.name for path in (tmp_path / "stopped").iterdir()} == kept
    columns, rows = read_curve(tmp_path / "stopped" / "unseen.csv")
    assert columns == ["step", "seconds", "pixels", "shape"]
    assert [row[0] for row in rows] == [2, 4, 5, 6]
    assert (np.diff([row[1] for row in rows]) >= 0).all()
    _, expected = read_curve(tmp_path / "whole" / "unseen.csv")
    np.testing.assert_allclose(np.array(rows)[:, 2:], np.array(expected)[:, 2:], rtol=1e-3)


def test_a_longer_training_goes_on_from_where_the_rate_had_not_yet_fallen(sitting):
    long, _ = sitting("long", 10)
    sitting("lengthened", 5)  # the rate falls in its last step
    lengthened, seen = sitting("lengthened", 10)
    assert seen == [4, 5, 6, 7, 8, 9]
    assert_same_weights(lengthened, long, atol=1e-4, rtol=1e-3)
    with pytest.raises(ValueError, match=r"is at step 8, where one of 5 steps would be slower already"):
        sitting("lengthened", 5)


def test_a_curve_drops_what_a_training_does_again(tmp_path):
    path = tmp_path / "curve.csv"
    curve = Curve(path, ["pixels"], 0)
    for step in (50, 100, 150):
        curve.add(step, 2.0 * step, [1 / step])
    Curve(path, ["pixels"], 120).add(150, 310.0, [0.25])
    columns, rows = read_curve(path)
    assert columns == ["step", "seconds", "pixels"]
    assert rows == [[50, 100, 0.02], [100, 200, 0.01], [150, 310, 0.25]]


def test_classes_and_weights_are_learnt_and_convolutions_stay_in_the_second_step(database, pipeline, tmp_path):
    model, known = database.model, pipeline.examples(EXACT, 8, reshaped=False)
    schedule = Schedule(steps=40, batch=8, rate=5e-3, checkpoint=40, warming=5)
    poses = standardised_pose(model, model.bilinear.expressions)
    classifier = train(Classes(network(database), poses, len(pipeline.table.codes)), known, schedule, tmp_path / "1", 0)
    task = Weights(classifier, standardised_identities(pipeline.table, model))
    before = {name: value.clone() for name, value in classifier.convolutions.state_dict().items()}
    regressor = train(task, known, replace(schedule, steps=50), tmp_path / "2", 0)
    for name, value in regressor.convolutions.state_dict().items():
        assert torch.equal(value, before[name]), name
    for step, columns in (("1", ["identity", "expression"]), ("2", ["pixels", "shape"])):
        names, rows = read_curve(tmp_path / step / "curve.csv")
        assert names[2:] == columns
    assert rows[0][0] == 50 and 0 < rows[0][3] < 1.8  # of 2, the variance of two kinds of standardised weights


def test_identities_of_a_table_fit_their_meshes_as_well_as_those_of_each_mesh_do(database, pipeline):
    model, table = database.model, pipeline.table
    statistics = standardisation(model)
    found = standardised_identities(table, model) * statistics["identity_std"] + statistics["identity_mean"]
    for person in range(4):
        meshes = model.bilinear.mean + table.codes[person] @ model.bilinear.basis.T
        best = fit_identity(model.bilinear, meshes, model.bilinear.expressions)

        def misfit(identity, codes=table.codes[person]):
            by_pose = np.einsum("kpq,eq,p->ek", model.bilinear.core, model.bilinear.expressions, identity)
            return np.linalg.norm(by_pose - codes)

        assert misfit(found[person]) <= 1.001 * misfit(best) + 1e-3


def test_training_does_not_go_on_from_another_one(database, pipeline, metric, tmp_path):
    schedule = Schedule(steps=1, batch=2, checkpoint=1)

    def run(layout=TINY, about="a database"):
        return train(faces(database, metric, layout), pipeline.examples(EXACT, 2), schedule, tmp_path, 0, about)

    run()
    for others in ({"layout": replace(TINY, hidden=32)}, {"about": "another"}):
        with pytest.raises(ValueError, match=r"last\.pt is of another training"):
            run(**others)
    checkpoint = tmp_path / "last.pt"
    checkpoint.write_bytes(checkpoint.read_bytes()[:1000])
    with pytest.raises(ValueError, match=r"last\.pt is damaged; remove it"):
        run()


def test_a_network_is_trained_in_the_three_steps_of_the_paper(database, pipeline, tmp_path):
    out = tmp_path / "steps.safetensors"
    schedule = Schedule(steps=18, batch=2, checkpoint=9)
    pipeline.train_network(out, "a test", schedule, TINY, workers=0, in_three_steps=True)
    assert FaceRegressor.load(str(out), database.model).sees == ("pixels", "shape")
    folder = pipeline.work / f"steps-{database.model.fingerprint[:8]}"
    steps = [torch.load(folder / step / "last.pt", weights_only=True)["step"] for step in ("classes", "weights", ".")]
    assert steps == [5, 8, 5]


@pytest.mark.parametrize("what", ["table", "shape"])
def test_what_is_kept_of_a_database_is_named_if_it_is_damaged(database, tmp_path, what):
    made = Pipeline(database, tmp_path)
    assert made.shape_model.core.any()
    (file,) = tmp_path.glob(f"{what}-*.npz")
    file.write_bytes(file.read_bytes()[:500])
    with pytest.raises(ValueError, match=rf"{file.name} is damaged; remove it"):
        _ = Pipeline(database, tmp_path).shape_model if what == "shape" else Pipeline(database, tmp_path).table


def test_the_shape_model_is_made_once(database, pipeline):
    again = Pipeline(database, pipeline.work).shape_model
    np.testing.assert_array_equal(again.core, pipeline.shape_model.core)
    np.testing.assert_array_equal(again.identity_std, pipeline.shape_model.identity_std)


def test_unseen_faces_are_none_of_those_that_are_trained_on(database, pipeline):
    kept, known, unknown = set(pipeline.kept), set(pipeline.unseen("random", 99)), set(pipeline.unseen("identity", 99))
    assert kept | known | unknown == set(range(len(database)))
    assert not (kept & known or kept & unknown or known & unknown)
    assert {database[int(number)].identity for number in unknown} == {2}
    assert {database[int(number)].identity for number in known} <= {0, 1}
    np.testing.assert_array_equal(pipeline.unseen("identity", 5), pipeline.unseen("identity", 5))
    assert len(pipeline.unseen("identity", 5)) == 5 and set(pipeline.unseen("identity", 5)) <= unknown


def test_a_tenth_of_the_interpolated_faces_is_tested_on(database, tmp_path, monkeypatch):
    """As in the paper's final data: faces of the model's people, and ones between them."""
    between = Interpolated(database.model, 40, seed=7)
    monkeypatch.setitem(database.__dict__, "interpolated", between)
    pipeline = Pipeline(database, tmp_path)
    faces = [face for face, _ in pipeline.faces("random", 99)]
    numbers = pipeline.unseen("random", 99)
    assert len(faces) == len(numbers) + 4
    for number, face in zip(numbers, faces, strict=False):
        np.testing.assert_array_equal(face.vertices, database[int(number)].vertices)
    for face in faces[-4:]:
        assert any(np.array_equal(face.vertices, one.vertices) for one in between)
    tests = test_set(pipeline, "random", Manner.EXACT, 99)
    assert len(tests.drawn) == len(faces) and all(drawn.image.any() for drawn in tests.drawn)
    assert len(pipeline.faces("identity", 99)) == len(pipeline.unseen("identity", 99))


def test_a_process_alone_leads(monkeypatch):
    for name in ("RANK", "WORLD_SIZE", "LOCAL_RANK"):
        monkeypatch.delenv(name, raising=False)
    team = Team.join()
    assert (team.rank, team.size, team.leads) == (0, 1, True)
    done = []
    with team.leader_first():
        done.append("at once")
    assert done


def test_two_processes_train_one_network(folder_beyond_its_model, pipeline, tmp_path):
    assert pipeline.table is not None
    (tmp_path / "together.py").write_text(
        f"""
import sys
from pathlib import Path

import torch

from sketchwidget.database.database import FaceDatabase
from sketchwidget.inference.network import TINY, PixelShapeCNN
from sketchwidget.training.examples import Variety
from sketchwidget.training.face_table import vertex_metric
from sketchwidget.training.network import Schedule, train
from sketchwidget.training.pipeline import Pipeline
from sketchwidget.training.tasks import Faces
from sketchwidget.training.team import Team

torch.set_num_threads(1)
team = Team.join()
pipeline = Pipeline(FaceDatabase.open({str(folder_beyond_its_model)!r}), Path({str(pipeline.work)!r}))
with team.leader_first():
    examples = pipeline.examples(Variety(), 2)
numbered, seen = examples.numbered, []
examples.numbered = lambda number: seen.append(number) or numbered(number)
model = pipeline.database.model
schedule = Schedule(steps=3, batch=2, checkpoint=3)
task = Faces(PixelShapeCNN(model.identity_size, model.expression_size, TINY), model, vertex_metric(model))
network = train(task, examples, schedule, Path("run"), workers=0)
torch.save({{"seen": seen, "weights": dict(network.named_parameters())}}, f"rank{{team.rank}}.pt")
"""
    )
    command = [sys.executable, "-m", "torch.distributed.run", "--standalone", "--nproc-per-node", "2", "together.py"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=240)
    assert done.returncode == 0, done.stderr
    one, other = (torch.load(tmp_path / f"rank{rank}.pt") for rank in (0, 1))
    assert (one["seen"], other["seen"]) == ([0, 2, 4], [1, 3, 5])
    for name, weight in one["weights"].items():
        torch.testing.assert_close(other["weights"][name], weight, atol=1e-6, rtol=1e-5, msg=name)
    assert torch.load(tmp_path / "run" / "last.pt", weights_only=True)["step"] == 3


def invoke(*arguments):
    return CliRunner().invoke(cli.main, [str(argument) for argument in arguments])


def run(*arguments):
    result = invoke(*arguments)
    assert result.exit_code == 0, result.output + repr(result.exception)
    return result.output


@pytest.fixture(scope="module")
def tiny_network(folder_beyond_its_model, pipeline, tmp_path_factory):
    """A network that the command made, and the work folder."""
    out = tmp_path_factory.mktemp("made") / "tiny.safetensors"
    told = run("train", "network", folder_beyond_its_model, "--tiny", "--out", out, "--work", pipeline.work)
    assert f"{out}: " in " ".join(told.split())
    return out


def test_the_command_makes_a_network_of_a_database(database, tiny_network):
    head = FaceRegressor.load(str(tiny_network), database.model).predict(Sketch.from_strokes([OVAL]))
    assert np.isfinite(head.vertices).all()
    with safe_open(tiny_network, "pt") as file:
        header = file.metadata()
    assert header["database"] == database.sum and header["licence"].startswith("CC0")
    assert header["face_model"] == database.model.fingerprint
    assert header["command"].startswith("sketchwidget") and "torch" in header["versions"]


@pytest.mark.parametrize(
    ("layout", "sees"),
    [
        (replace(TINY, shape=0), ("pixels",)),
        (replace(TINY, convolutions="none"), ("shape",)),
        (replace(TINY, branched=False), ("pixels", "shape")),
    ],
)
def test_networks_of_every_layout_are_made(database, pipeline, tmp_path, layout, sees):
    out, schedule = tmp_path / f"{'-'.join(sees)}.safetensors", Schedule(steps=2, batch=2, checkpoint=2)
    pipeline.train_network(out, "a test", schedule, layout, Variety(wrinkles=0.0), workers=0)
    regressor = FaceRegressor.load(str(out), database.model)
    assert regressor.sees == sees and (regressor.shape_model is None) == (sees == ("pixels",))
    assert (pipeline.work / f"{out.stem}-{database.model.fingerprint[:8]}" / "last.pt").exists()


@pytest.mark.parametrize(("variant", "sees"), [("PixelCNN", ("pixels",)), ("ShapeNN", ("shape",))])
def test_a_tiny_variant_has_the_parts_of_the_variant(
    folder_beyond_its_model, database, pipeline, tmp_path, variant, sees
):
    out = tmp_path / f"tiny{variant}.safetensors"
    arguments = ("--variant", variant, "--tiny", "--out", out, "--work", pipeline.work)
    run("train", "network", folder_beyond_its_model, *arguments)
    regressor = FaceRegressor.load(str(out), database.model)
    assert regressor.sees == sees
    if variant == "ShapeNN":
        with pytest.raises(ValueError, match="sees lines only"):
            regressor.predict(Sketch.from_strokes([OVAL]))


def test_the_command_takes_drawings_by_people(folder_beyond_its_model, database, pipeline, tmp_path):
    face = database.model.face(expression="laugh")
    strokes = [np.column_stack([line.points, np.zeros((len(line.points), 2))]) for line in face.sketch().segments]
    write_drawings(tmp_path / "people.jsonl", [Drawing.of(face, strokes)])
    out = tmp_path / "people.safetensors"
    arguments = ("--drawings", tmp_path / "people.jsonl", "--tiny", "--out", out, "--work", pipeline.work)
    run("train", "network", folder_beyond_its_model, *arguments)
    assert out.exists()
    shipped = FaceModel.load().face()
    write_drawings(tmp_path / "people.jsonl", [Drawing.of(shipped, strokes)])
    result = invoke("train", "network", folder_beyond_its_model, *arguments)
    assert result.exit_code == 1 and "the weights of another face model" in " ".join(result.stderr.split())


def test_a_network_is_made_of_a_database_that_its_model_knows_all_of(small_folder, tmp_path):
    """Of fewer people than the model has identity weights, as some are left out."""
    out = tmp_path / "small.safetensors"
    run("train", "network", small_folder, "--tiny", "--out", out, "--work", tmp_path / "work")
    assert out.exists()


def test_a_training_begins_with_the_weights_of_another_network(
    folder_beyond_its_model, pipeline, tiny_network, tmp_path
):
    out = tmp_path / "further.safetensors"
    arguments = ("--tiny", "--out", out, "--work", pipeline.work, "--start", tiny_network)
    run("train", "network", folder_beyond_its_model, *arguments)
    with safe_open(out, "pt") as file:
        assert file.metadata()["started from"] == hashlib.sha256(tiny_network.read_bytes()).hexdigest()
    # Six small steps with a rate that has hardly risen leave it near where it began.
    started, further = (dict(read_network(path).network.named_parameters()) for path in (tiny_network, out))
    for name, weight in started.items():
        torch.testing.assert_close(further[name], weight, atol=0.02, rtol=0.1, msg=name)
    other = invoke("train", "network", folder_beyond_its_model, *arguments, "--variant", "PixelCNN")
    assert other.exit_code == 1 and "another layout" in " ".join(other.stderr.split())


def test_the_command_makes_a_face_model_of_another_rank(folder_beyond_its_model, database, tmp_path):
    out = tmp_path / "face.safetensors"
    told = run("train", "face", folder_beyond_its_model, "--out", out, "--identity", "4", "--expression", "2")
    assert "4 identity and 2 expression weights" in " ".join(told.split())
    model = FaceModel.load(out)
    assert (model.identity_size, model.expression_size) == (4, 2) and tuple(model.expressions) == database.expressions
    np.testing.assert_array_equal(model.faces, database.model.faces)


def test_what_is_shipped_is_not_replaced_by_itself(folder_beyond_its_model):
    for kind in ("face", "network"):
        result = invoke("train", kind, folder_beyond_its_model)
        assert result.exit_code == 2 and "Missing option '--out'" in " ".join(result.stderr.split())


def test_networks_are_evaluated_beside_the_mean_face_and_the_best_fit(
    folder_beyond_its_model, tiny_network, pipeline, tmp_path
):
    out = tmp_path / "tables" / "accuracy.md"
    arguments = ("--network", tiny_network, "--out", out, "--work", pipeline.work, "--faces", "2")
    told = run("evaluate", folder_beyond_its_model, *arguments)
    text = out.read_text()
    assert text in told and "over 2 faces a column" in text
    rows = {row.split("|")[1].strip(): row.split("|")[2:-1] for row in text.splitlines() if row.startswith("| ")}
    assert list(rows)[:3] == ["", "mean face", "best fit in 3D"] and {"tiny, pixels alone", "tiny"} <= set(rows)
    wanted = [f"people {seen}: {manner.value}" for seen in ("seen", "left out") for manner in Manner]
    assert [column.strip() for column in rows.pop("")] == wanted
    errors = {name: [float(value) for value in row] for name, row in rows.items()}
    assert all(len(row) == 6 and 0 <= min(row) <= max(row) < 100 for row in errors.values())
    assert (np.array(errors["best fit in 3D"]) < errors["mean face"]).all() and max(errors["best fit in 3D"][:3]) < 0.1
    assert {path.name for path in out.parent.iterdir()} == {"accuracy.md", "accuracy_maps.png", "accuracy_wrinkles.png"}


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["train", "nose"], "No such command 'nose'"),
        (["train", "face"], "Missing argument"),
        (["train", "face", "nowhere", "--out", "face"], "nowhere holds no face database"),
        (["train", "network", "nowhere", "--out", "net", "--tiny"], "nowhere holds no face database"),
        (
            ["train", "network", "nowhere", "--out", "net", "--variant", "PixelRNN"],
            "one of PixelShapeCNN, PixelShapeCNN-Coefficients, PixelCNN",
        ),
        (["train", "network", "nowhere", "--out", "net", "--steps", "-1"], "Invalid value for '--steps'"),
        (["evaluate"], "Missing argument"),
        (["evaluate", "nowhere", "--out", "table"], "nowhere holds no face database"),
        (["evaluate", "nowhere", "--faces", "0"], "Invalid value for '--faces'"),
    ],
)
def test_bad_use_of_the_commands_ends_with_a_message(tmp_path, monkeypatch, arguments, complaint):
    monkeypatch.chdir(tmp_path)
    result = invoke(*arguments)
    assert result.exit_code != 0 and "Traceback" not in result.output
    assert complaint in " ".join(result.stderr.replace("│", " ").split())


def test_networks_of_other_models_are_not_evaluated(small_folder, tiny_network, tmp_path):
    result = invoke("evaluate", small_folder, "--network", tiny_network, "--out", tmp_path / "table")
    assert result.exit_code == 1 and "was trained for another face model" in " ".join(result.stderr.split())


def test_networks_of_one_name_are_not_evaluated_together(folder_beyond_its_model, tiny_network, pipeline, tmp_path):
    network = ("--network", tiny_network)
    arguments = (*network, *network, "--out", tmp_path / "table", "--work", pipeline.work)
    result = invoke("evaluate", folder_beyond_its_model, *arguments)
    assert result.exit_code == 1 and "could not be told apart" in " ".join(result.stderr.split())


def test_networks_of_other_databases_are_not_evaluated(
    folder_beyond_its_model, database, tiny_network, pipeline, tmp_path
):
    with safe_open(tiny_network, "pt") as file:
        header, tensors = file.metadata(), {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
    save_file(tensors, tmp_path / "other.safetensors", header | {"database": "0" * 64})
    arguments = ("--network", tmp_path / "other.safetensors", "--out", tmp_path / "table", "--work", pipeline.work)
    result = invoke("evaluate", folder_beyond_its_model, *arguments)
    assert result.exit_code == 1 and "was trained on another database" in " ".join(result.stderr.split())


@pytest.mark.parametrize("command", [("train", "network"), ("evaluate",)])
def test_a_file_that_cannot_be_written_is_told_before_the_work(folder_beyond_its_model, tmp_path, command):
    result = invoke(*command, folder_beyond_its_model, "--out", tmp_path, "--work", tmp_path / "work")
    assert result.exit_code == 1 and "cannot be written" in " ".join(result.stderr.split())
    assert not any(tmp_path.iterdir())
