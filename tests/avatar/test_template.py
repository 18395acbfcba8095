import numpy as np
import pytest

from sketchwidget.avatar.template import AvatarTemplate
from sketchwidget.face.template import PARTS

# Apple's documentation of ARFaceAnchor.BlendShapeLocation names 52.
ARKIT_BOTH_SIDES = [
    "eyeBlink",
    "eyeLookDown",
    "eyeLookIn",
    "eyeLookOut",
    "eyeLookUp",
    "eyeSquint",
    "eyeWide",
    "mouthSmile",
    "mouthFrown",
    "mouthDimple",
    "mouthStretch",
    "mouthPress",
    "mouthLowerDown",
    "mouthUpperUp",
    "browDown",
    "browOuterUp",
    "cheekSquint",
    "noseSneer",
]
ARKIT_WHOLE = [
    "jawForward",
    "jawLeft",
    "jawRight",
    "jawOpen",
    "mouthClose",
    "mouthFunnel",
    "mouthPucker",
    "mouthLeft",
    "mouthRight",
    "mouthRollLower",
    "mouthRollUpper",
    "mouthShrugLower",
    "mouthShrugUpper",
    "browInnerUp",
    "cheekPuff",
    "tongueOut",
]
ARKIT = [name + side for name in ARKIT_BOTH_SIDES for side in ("Left", "Right")] + ARKIT_WHOLE


def test_the_expressions_are_arkits(template):
    assert sorted(template.action_names) == sorted(ARKIT)
    assert all(np.abs(moved).max() > 0.5 for name, moved in template.actions.items() if "eyeLook" not in name)


def test_left_is_the_subjects(template):
    """x grows to the subject's left."""
    for name, moved in template.actions.items():
        side = 1 if name.endswith("Left") else -1
        if name.endswith(("Left", "Right")) and not name.startswith(("jaw", "mouthLeft", "mouthRight")):
            amount = np.linalg.norm(moved, axis=1)
            assert side * (amount * template.neutral[:, 0]).sum() > 0, name


def test_the_chart_turns_nothing_over_and_lays_nothing_on_top(model, template):
    soft, faces = model.template.soft
    a, b, c = (template.chart[soft][faces[:, k]] for k in range(3))
    area = np.cross(b - a, c - a)
    assert (area > 0).all()
    # One piece with all triangles one way round covers no place twice if its area is that inside its border.
    assert area.sum() / 2 < 1
    assert template.chart.min() >= 0 and template.chart.max() <= 1


def test_most_of_the_chart_is_for_the_face(model, template):
    soft, faces = model.template.soft
    a, b, c = (template.chart[soft][faces[:, k]] for k in range(3))
    front = template.neutral[soft][faces][..., 2].mean(axis=1) > 20
    area = np.cross(b - a, c - a)
    assert area[front].sum() > 0.5 * area.sum()


def test_the_albedo_is_a_face(model, template):
    colour = template.albedo
    skin = template.albedo[model.template.parts == PARTS.index("skin")]
    fine = model.template.subdivision @ colour
    lip = fine[model.curves["mouth_upper"][5:-5]].mean(axis=0)
    assert lip[1] < np.median(skin[:, 1]) and lip[0] > 0.5  # redder than skin
    crown = model.template.subdivision @ template.scalp
    assert crown[model.mean[:, 1].argmax()] > 0.95 and crown[model.landmarks].max() < 0.2


def test_it_is_read_as_it_was_written(template, tmp_path):
    path = tmp_path / "avatar.safetensors"
    template.save(path, {"command": "test"})
    read = AvatarTemplate.load(path)
    assert np.array_equal(read.chart, template.chart) and read.action_names == template.action_names
    assert np.array_equal(read.actions["jawOpen"], template.actions["jawOpen"])


def test_another_topology_is_told(template, three_expressions):
    from dataclasses import replace

    with pytest.raises(ValueError, match="topology"):
        replace(template, quads=template.quads[::-1]).check(type("Model", (), {"template": template})())
