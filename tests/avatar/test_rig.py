import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sketchwidget.avatar.eyes import fit_eyeballs
from sketchwidget.avatar.rig import Blend, RigBuilder


@pytest.fixture(scope="module")
def builder(model, template):
    return RigBuilder(model, template)


@pytest.fixture(scope="module")
def person(model, builder):
    """A head of the model at rest, fine, its rig and its eyes."""
    coarse = model.coarse(model.bilinear.identities[5], model.expression_weights("neutral")).astype(np.float64)
    head = model.template.subdivision @ coarse
    rig, eyes = builder(coarse, fit_eyeballs(model, head, head))
    return head, rig, eyes


def test_on_the_template_itself_expressions_are_its_own(model, template, builder):
    head = model.template.subdivision @ template.neutral
    rig, _ = builder(template.neutral.astype(np.float64), fit_eyeballs(model, head, head))
    balls = model.template.fine_parts == 2
    for name, moved in template.actions.items():
        if name.startswith("eyeBlink"):
            continue  # mended, so that lids meet
        expected = model.template.subdivision @ moved
        assert np.abs(rig[name][~balls] - expected[~balls]).max() < 0.05, name


def test_every_expression_comes_over_to_another_head(person, template):
    head, rig, _ = person
    assert tuple(rig) == template.action_names
    for name, moved in rig.items():
        assert moved.shape == head.shape and np.isfinite(moved).all()
        if "eyeLook" not in name and name != "tongueOut":
            assert 0.5 < np.linalg.norm(moved, axis=1).max() < 60, name


def test_lids_meet_and_do_not_enter_the_eye(model, person):
    head, rig, eyes = person
    for eye in eyes:
        upper, lower = (model.curves[f"{eye.side}_eye_{lid}"] for lid in ("upper", "lower"))
        blink = rig[f"eyeBlink{eye.side.capitalize()}"]
        open_gap = head[upper, 1].max() - head[lower, 1].min()
        closed = head + blink
        opposite = np.abs(closed[upper, None, 0] - closed[lower, 0]).argmin(axis=1)
        gap = closed[upper, 1] - closed[lower[opposite], 1]
        assert open_gap > 4 and np.abs(gap[3:-3]).max() < 0.25 * open_gap and np.median(np.abs(gap)) < 0.6
        for share in (0.0, 0.3, 0.6, 1.0):
            margin = (head + share * blink)[np.concatenate([upper, lower])]
            in_front = margin[:, 2] > eye.centre[2]
            away = np.linalg.norm(margin[in_front] - eye.centre, axis=1)
            assert (away > eye.radius - 0.3).all()


def test_closing_lids_stay_smooth(model, person):
    """The margins bend as gently as they do when open: third differences, in millimetres."""
    head, rig, _ = person
    for side in ("left", "right"):
        for share in (0.3, 0.5, 0.8, 1.0):
            closed = head + share * rig[f"eyeBlink{side.capitalize()}"]
            for lid in ("upper", "lower"):
                assert np.abs(np.diff(closed[model.curves[f"{side}_eye_{lid}"], 1], 3)).max() < 0.5


weights = st.dictionaries(
    st.sampled_from(["jawOpen", "mouthSmileLeft", "eyeBlinkRight", "browInnerUp"]), st.floats(0, 1)
)


@settings(max_examples=20)
@given(weights, weights)
def test_expressions_add_up_linearly(person, one, other):
    """Equation 13."""
    head, rig, _ = person
    blend = Blend(head, rig)
    both = {name: one.get(name, 0) + other.get(name, 0) for name in one | other}
    assert np.allclose(blend(both) - head, (blend(one) - head) + (blend(other) - head), atol=1e-3)


def test_one_expression_alone_is_its_displacement(person):
    head, rig, _ = person
    assert np.allclose(Blend(head, rig)({"jawOpen": 1.0}), head + rig["jawOpen"], atol=2e-3)


def test_wrong_names_and_weights_are_told(person):
    head, rig, _ = person
    blend = Blend(head, rig)
    with pytest.raises(ValueError, match="jawOpne"):
        blend({"jawOpne": 1.0})
    with pytest.raises(ValueError, match="finite"):
        blend({"jawOpen": float("nan")})
