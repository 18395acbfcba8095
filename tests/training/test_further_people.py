"""People beyond those of a database."""

from dataclasses import replace

import numpy as np
import pytest

from sketchwidget.database import build as building
from sketchwidget.geometry import View
from sketchwidget.inference.network import TINY
from sketchwidget.inference.shape_code import DETAILS
from sketchwidget.training import examples as examples_module
from sketchwidget.training import manners
from sketchwidget.training import pipeline as training_pipeline
from sketchwidget.training.examples import Examples, Variety
from sketchwidget.training.further_people import Further
from sketchwidget.training.looked_at import LookedAt
from sketchwidget.training.manners import Manner
from sketchwidget.training.network import Schedule
from sketchwidget.training.pipeline import Pipeline


@pytest.fixture
def with_further(database, three_expressions, pipeline, monkeypatch):
    """Two people behind the three of the database, in the frame of its model."""
    monkeypatch.setattr(building, "MODEL_IDENTITIES", 2)
    return Pipeline(database, pipeline.work, Further(three_expressions, 2))


def test_they_are_those_that_a_larger_database_would_hold(with_further, three_expressions, tmp_path, monkeypatch):
    store = building.build(three_expressions, tmp_path / "larger", identities=5, interpolated=5)
    model, table = with_further.database.model, with_further.table
    assert table.points.shape[0] == 20 and len(table.wrinkles) == 12
    skin = model.template.parts == 0
    for person in (3, 4):
        heads = store.read(person).vertices[2, 1]
        lines = table.lines(table.points[4 * person + 2, 1])
        fine = model.template.subdivision @ heads
        for name, line in lines.items():
            np.testing.assert_allclose(line, fine[model.curves[name]], atol=0.06)
        code = table.codes[4 * person + 2, 1]
        off = model.bilinear.coordinates(heads.reshape(-1)) - code
        assert np.linalg.norm((model.bilinear.basis @ off).reshape(-1, 3)[skin], axis=1).mean() < 0.05


def test_they_are_made_once(with_further, monkeypatch):
    made = with_further.table
    monkeypatch.setattr(building.Maker, "skin", None)
    again = Pipeline(with_further.database, with_further.work, with_further.further).table
    np.testing.assert_array_equal(again.points, made.points)


def test_they_are_trained_on_and_the_database_s_own_stay_what_they_were(with_further, pipeline):
    np.testing.assert_array_equal(with_further.kept, pipeline.kept)
    np.testing.assert_array_equal(with_further.unseen("random", 3), pipeline.unseen("random", 3))
    assert not np.isin(with_further.examples(Variety(), 1)._kept, with_further.unseen("identity", 99)).any()
    people = with_further.examples(Variety(wrinkles=1.0), 64).numbered(0).people
    assert {12, 19} & set(people.tolist()) and people.max() < 20
    assert pipeline.examples(Variety(), 64).numbered(0).people.max() < 12


def test_a_source_without_so_many_people_says_so(database, three_expressions, pipeline, monkeypatch):
    monkeypatch.setattr(type(three_expressions), "count", 4, raising=False)
    with pytest.raises(ValueError, match="has 4 people; 5 were asked for"):
        _ = Pipeline(database, pipeline.work, Further(three_expressions, 2)).table


def test_other_people_than_the_database_s_source_has_are_told_apart(database, three_expressions, tmp_path, monkeypatch):
    with pytest.raises(ValueError, match="was begun with other heads"):  # all people of three make another frame
        _ = Pipeline(database, tmp_path, Further(three_expressions, 2)).table
    monkeypatch.setattr(type(three_expressions), "expressions", property(lambda _: ("smile", "neutral", "open")))
    with pytest.raises(ValueError, match=r"the expressions .*; given"):
        _ = Pipeline(database, tmp_path, Further(three_expressions, 2)).table


@pytest.mark.parametrize("count", [0, -3])
def test_nobody_is_no_further_people(three_expressions, count):
    with pytest.raises(ValueError, match=f"1 or more; given {count}"):
        Further(three_expressions, count)


def _exact(pipeline, of, wrinkles):
    """Two batches of exact drawings of some faces as they are."""
    plain = Variety({Manner.EXACT: 1.0}, wrinkles=wrinkles, of_model=0.0, mixed=0.0, blended=0.0, found=0.0)
    examples = pipeline.examples(plain, 12, of=np.array(of))
    return [examples.numbered(number) for number in (0, 1)]


def test_they_have_wrinkles_of_somebody_in_the_same_expression(with_further):
    one, other, smile = 3 * 13 + 1, 3 * 2 + 1, 3 * 2 + 2  # of a further person; of one of the database
    (alone, _), (plain, _) = (_exact(with_further, [one], share) for share in (1.0, 0.0))
    np.testing.assert_array_equal(alone.images, plain.images)  # nobody to have them from
    bare = plain.images[0]
    for donors, wrinkled in (([other], True), ([smile], False)):
        for batch in _exact(with_further, [*donors, one], 1.0):
            images = batch.images[batch.people == 13]
            assert len(images) and all((image & bare).sum() >= bare.sum() for image in images)
            assert all((image.sum() > bare.sum()) == wrinkled for image in images)


def test_wrinkles_are_carried_from_the_face_that_has_them(with_further, monkeypatch):
    given = []

    def draw(manner, lines, parts, wrinkles, front, *rest):
        given.append((wrinkles, front))
        return manners.draw(manner, lines, parts, wrinkles, front, *rest)

    monkeypatch.setattr(examples_module, "draw", draw)
    one, other = 3 * 13 + 1, 3 * 2 + 1
    batch = _exact(with_further, [other, one], 1.0)[0]
    table = with_further.table
    of_other = table.lines(View().project(table.points[2, 1].astype(np.float32)))
    assert 13 in batch.people.tolist()
    for wrinkles, front in given:
        np.testing.assert_array_equal(wrinkles, table.wrinkles[2, 1])
        for name, line in front.items():
            np.testing.assert_allclose(line, of_other[name], atol=1e-6)


def test_drawings_looked_at_are_of_the_model_s_people_and_of_further_ones_whom_nothing_before_has_seen(
    with_further, tmp_path, monkeypatch
):
    seen = {}
    by, train = LookedAt.by, training_pipeline.train

    def looked_at(network, examples, *rest):
        seen["lines" if network is None else "drawings"] = set(examples._kept.tolist())
        return by(network, examples, *rest)

    def trained(task, examples, *rest):
        if isinstance(examples, Examples):
            seen["before"] = set(examples._kept.tolist())
        return train(task, examples, *rest)

    monkeypatch.setattr(LookedAt, "by", looked_at)
    monkeypatch.setattr(training_pipeline, "train", trained)
    monkeypatch.setattr(training_pipeline, "_FAMILIAR", 1)
    layout = replace(TINY, details=DETAILS, joined=16)
    with_further.train_network(
        tmp_path / "a.safetensors", "a test", Schedule(steps=2, batch=4, checkpoint=2), layout, workers=0, looked_at=2
    )
    kept, first, second = set(with_further.kept.tolist()), set(range(36, 48)), set(range(48, 60))
    assert seen["before"] == kept | first
    assert seen["drawings"] == {face for face in kept if face < 24} | second
    assert seen["lines"] == kept | first | second
    everybody = tmp_path / "b.safetensors", "a test", Schedule(steps=2, batch=4, checkpoint=2), layout
    with_further.train_network(*everybody, workers=0)
    assert seen["before"] == kept | first | second
    with pytest.raises(ValueError, match="of another training"):  # which has seen the strangers
        with_further.train_network(*everybody, workers=0, looked_at=2)
