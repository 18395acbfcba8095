"""Scripted sessions from a blank pad to an exported head, through all three modes."""

import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import trimesh

import sketchwidget as sw

sys.path.insert(0, str(Path(__file__).parents[2]))

from benchmarks.sessions import MODES, SCRIPTS


@pytest.fixture(scope="module")
def regressor():
    return sw.FaceRegressor.load()


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.name)
def test_a_head_is_made_and_its_session_replays(script, regressor, tmp_path):
    session = sw.Session(regressor)
    artist, heads = script.play(session)
    assert session.mode == "refine" and set(artist.edits) == set(MODES)
    for before, after in pairwise(heads):
        assert 1.0 < np.linalg.norm(after.vertices - before.vertices, axis=1).max() < 60.0
    session.save(tmp_path / "session.jsonl")
    again = sw.Session.load(tmp_path / "session.jsonl", regressor)
    assert again.events == session.events
    np.testing.assert_allclose(again.face.vertices, session.face.vertices, atol=1e-3)
    again.face.export(tmp_path / "head.glb")
    exported = trimesh.load(tmp_path / "head.glb", force="mesh")
    assert len(exported.faces) == len(again.face.faces)
    np.testing.assert_allclose(1000 * exported.extents, np.ptp(again.face.vertices, axis=0), atol=0.1)
