"""Lips, lids and teeth that are where they belong."""

import numpy as np
import pytest

from sketchwidget.database.anny import AnnySource
from sketchwidget.database.contact import Contact
from sketchwidget.face import PARTS
from sketchwidget.geometry.visibility import covering


@pytest.fixture(scope="module")
def source():
    return AnnySource()


@pytest.fixture(scope="module")
def posed(source):
    return dict(zip(source.expressions, source.heads(5), strict=True))


@pytest.fixture(scope="module")
def contact(source, posed):
    return Contact(source.template, posed["neutral"])


@pytest.mark.parametrize("expression", ["smile", "big_pout", "eyes_closed", "wink"])
def test_mended_heads_pass_the_test_that_they_failed(contact, posed, expression):
    assert max(contact.crossing(posed[expression]).values()) > 0
    assert contact.crossing(contact.mended(posed[expression])) == {"lips": 0, "lids": 0}


def test_mending_twice_is_mending_once(contact, posed):
    once = contact.mended(posed["smile"])
    np.testing.assert_allclose(contact.mended(once), once, atol=0.05)


def test_an_open_mouth_stays_as_it_is(source, contact, posed):
    head = posed["mouth_open"]
    change = np.abs(contact.mended(head) - head).max(axis=1)
    mouth = (head[:, 1] < -30) & (source.template.parts <= PARTS.index("mouth"))
    assert change[mouth].max() < 1e-4


def test_only_what_lies_about_mouth_and_eyes_moves(source, contact, posed):
    head = posed["smile"]
    change = np.linalg.norm(contact.mended(head) - head, axis=1)
    assert change.max() < 6  # mm
    fine = source.template.subdivision @ head
    curves = source.template.curves
    near = np.concatenate([fine[path] for name, path in curves.items() if "eye" in name or "mouth" in name])
    distance = np.linalg.norm(head[:, None] - near[None], axis=2).min(axis=1)
    assert change[distance > 25].max() < 1e-4
    assert change[source.template.parts > PARTS.index("mouth")].max() < 1e-4


def test_lips_part_by_no_more_than_they_crossed(source, contact, posed):
    """Half of the overlap each: the mouth is shut still."""
    mended = contact.mended(posed["smile"])
    fine = source.template.subdivision @ mended
    upper = fine[source.template.curves["mouth_upper"]]
    lower = fine[source.template.curves["mouth_lower"]]
    middle = np.abs(upper[:, 0] - upper[:, 0].mean()) < 10
    gap = upper[middle, 1].min() - lower[np.abs(lower[:, 0] - lower[:, 0].mean()) < 10, 1].max()
    assert -3 < gap < 3


def upper_and_lower(source, posed):
    """Coarse vertices of both rows of teeth."""
    teeth = np.flatnonzero(source.template.parts == PARTS.index("teeth"))
    height = posed["neutral"][teeth, 1]
    return teeth[height > height.mean()], teeth[height <= height.mean()]


def skin_in_front(source, head, row):
    """How far the outermost skin lies before each tooth's vertex that has some before it, mm."""
    template = source.template
    skin = template.faces[(template.fine_parts[template.faces] == PARTS.index("skin")).all(axis=1)]
    point, above = covering(head[row], template.subdivision @ head, skin)
    return np.array([above[point == number].max() for number in np.unique(point)])


def test_teeth_that_come_through_the_skin_are_moved_back(source, contact, posed):
    upper, _ = upper_and_lower(source, posed)
    head = posed["neutral"].copy()
    head[upper, 2] += 12
    assert skin_in_front(source, head, upper).min() < 0
    seated = contact.seated(head)
    change = seated - head
    assert (change[upper, :2] == 0).all() and change[upper, 2].max() < -1
    np.testing.assert_allclose(change[upper, 2], change[upper[0], 2], atol=1e-4)
    assert skin_in_front(source, seated, upper).min() == pytest.approx(1.5, abs=1e-3)
    others = np.setdiff1d(np.arange(len(head)), upper)
    np.testing.assert_array_equal(seated[others], head[others])


def test_teeth_behind_the_skin_stay_where_they_are(source, contact, posed):
    head = posed["neutral"]
    assert min(skin_in_front(source, head, row).min() for row in upper_and_lower(source, posed)) > 1.5
    np.testing.assert_array_equal(contact.seated(head), head)
    assert contact.seated(head).dtype == head.dtype


@pytest.mark.parametrize("expression", ["laugh", "shout", "jaw_drop"])
def test_teeth_that_an_open_mouth_shows_stay_where_they_are(contact, posed, expression):
    head = posed[expression]
    np.testing.assert_array_equal(contact.seated(head), head)
