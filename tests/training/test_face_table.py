"""What training reads of each face."""

import numpy as np
import pytest

from sketchwidget.face import PARTS
from sketchwidget.training import face_table
from sketchwidget.training.face_table import LINES, tabulate, vertex_metric


def place(face, database):
    """Row and expression of a face in the table."""
    return 4 * face.identity + face.level - 1, database.expressions.index(face.expression)


def test_points_are_those_of_the_faces_lines(database, pipeline):
    table = pipeline.table
    assert table.points.shape[:2] == (12, 3) and table.points.dtype == np.float16
    for number in (0, 17, 35):
        face = database[number]
        lines = table.lines(table.points[place(face, database)])
        assert tuple(lines) == LINES
        for name, line in lines.items():
            np.testing.assert_allclose(line, face.vertices[database.model.curves[name]], atol=0.06)


def test_codes_are_the_meshes_in_the_model_s_basis(database, pipeline):
    model = database.model
    for number in (5, 20):
        face = database[number]
        code = pipeline.table.codes[place(face, database)]
        vertices = model.template.subdivision @ (model.bilinear.mean + model.bilinear.basis @ code).reshape(-1, 3)
        assert np.linalg.norm(vertices - face.vertices, axis=1).mean() < 0.3  # mm


def test_wrinkles_are_those_of_the_database(database, pipeline):
    table = pipeline.table
    for number in (1, 34):
        kept, drawn = table.wrinkles[place(database[number], database)], database.wrinkles(database[number])
        np.testing.assert_allclose(kept, drawn[: len(kept)], atol=5e-4)
        assert np.isnan(drawn[len(kept) :]).all()
    assert np.isfinite(table.wrinkles[:, :, -1]).any()


def test_a_table_is_made_once(database, pipeline, tmp_path, monkeypatch):
    made = tabulate(database, tmp_path / "work" / "table.npz")
    assert [path.name for path in (tmp_path / "work").iterdir()] == ["table.npz"]
    monkeypatch.setattr(database, "person", None)
    again = tabulate(database, tmp_path / "work" / "table.npz")
    for name in ("points", "codes", "wrinkles"):
        np.testing.assert_array_equal(getattr(again, name), getattr(made, name))
        np.testing.assert_array_equal(getattr(again, name), getattr(pipeline.table, name))


def test_the_metric_is_the_weighted_distance_of_the_vertices(model):
    """Equation 2 written out over all fine vertices."""
    metric = vertex_metric(model)
    difference = np.random.default_rng(2).normal(size=len(metric))
    moved = model.template.subdivision @ (model.bilinear.basis @ difference).reshape(-1, 3)
    weights = np.array([face_table._PART_WEIGHTS[part] for part in PARTS])[model.template.fine_parts]
    weights[np.unique(np.concatenate([model.curves[name] for name in LINES]))] *= face_table._LINE_WEIGHT
    expected = (weights * (moved**2).sum(axis=1)).sum() / weights.sum()
    assert difference @ metric @ difference == pytest.approx(expected, rel=1e-3)
