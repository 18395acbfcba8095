"""People beyond those of a database."""

import numpy as np
import pytest

from sketchwidget.database import build as building
from sketchwidget.training.examples import Variety
from sketchwidget.training.further_people import Further
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
