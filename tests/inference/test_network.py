"""PixelShapeCNN and its layouts."""

import json
from dataclasses import replace

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from torch import nn

from sketchwidget.inference.network import IMAGE_SIZE, PAPER, TINY, Layout, PixelShapeCNN
from sketchwidget.inference.shape_code import DETAILS
from sketchwidget.training.variants import VARIANTS

SIZES = (50, 16)
SMALL = {"channels": TINY.channels, "blocks": TINY.blocks, "bottleneck": 8, "hidden": 64, "branch": 48}


def small(name):
    """The layout of a variant with few neurons."""
    layout = VARIANTS[name].layout
    return replace(layout, **SMALL, shape=min(layout.shape, 32), joined=min(layout.joined, 32))


@pytest.fixture
def batch():
    torch.manual_seed(1)
    return (torch.rand(2, 1, IMAGE_SIZE, IMAGE_SIZE) < 0.05).float(), torch.randn(2, sum(SIZES) + DETAILS + 1)


def linear(layers):
    return [layer for layer in layers if isinstance(layer, nn.Linear)]


@pytest.mark.parametrize(
    ("name", "answers"),
    [
        ("PixelShapeCNN", 2),
        ("PixelShapeCNN-Coefficients", 2),
        ("PixelCNN", 1),
        ("PixelCNN-Wrinkle", 1),
        ("ShapeNN", 1),
        ("PixelCNNSingle", 1),
        ("AlexNet", 2),
    ],
)
@pytest.mark.parametrize("precision", [torch.float32, torch.bfloat16])
def test_every_variant_gives_weights_of_identity_and_expression(name, answers, precision, batch):
    network = PixelShapeCNN(*SIZES, small(name)).eval().to(precision)
    given = network(*(inputs.to(precision) for inputs in batch))
    assert len(given) == answers
    for identity, expression in given:
        assert identity.shape == (2, SIZES[0]) and expression.shape == (2, SIZES[1])
        assert torch.isfinite(identity).all() and torch.isfinite(expression).all()


def test_all_variants_are_tested():
    others = {"PixelShapeCNN-Coefficients", "PixelCNN", "PixelCNN-Wrinkle", "ShapeNN", "PixelCNNSingle", "AlexNet"}
    assert set(VARIANTS) == {"PixelShapeCNN", *others}


def test_the_paper_s_layout_has_the_layers_of_alexnet(batch):
    network = PixelShapeCNN(*SIZES, PAPER).eval()
    convolutions = [layer for layer in network.convolutions if isinstance(layer, nn.Conv2d)]
    assert [layer.out_channels for layer in convolutions] == [96, 256, 384, 384, 256]
    assert [layer.kernel_size[0] for layer in convolutions] == [11, 5, 3, 3, 3]
    assert [layer.out_features for layer in linear(network.shared)] == [4096]
    assert [[layer.out_features for layer in linear(branch)] for branch in network.branches] == [[1024] * 3, [1024]]
    pixels, with_shape = network(*batch)
    assert [weights.shape for weights in (*pixels, *with_shape)] == [(2, 50), (2, 16)] * 2


@pytest.mark.parametrize("name", ["PixelShapeCNN", "PixelCNN", "ShapeNN", "AlexNet"])
def test_identity_has_a_branch_of_three_layers_and_expression_one_of_one(name):
    network = PixelShapeCNN(*SIZES, small(name))
    assert [len(linear(branch)) for branch in network.branches] == [3, 1]
    assert [output.out_features for output in network.outputs] == list(SIZES)


def test_a_single_stack_gives_both(batch):
    network = PixelShapeCNN(*SIZES, small("PixelCNNSingle"))
    assert [len(linear(branch)) for branch in network.branches] == [3]
    assert [output.out_features for output in network.outputs] == [sum(SIZES)]
    ((identity, expression),) = network.eval()(*batch)
    (both,) = network.features(batch[0])
    torch.testing.assert_close(network.outputs[0](both), torch.cat([identity, expression], dim=1))


def test_pixels_are_answered_alone_and_with_the_shape(batch):
    network, (images, codes) = PixelShapeCNN(*SIZES, TINY).eval(), batch
    alone, together = network(images, codes)
    other_alone, other_together = network(images, codes + 1)
    assert all(torch.equal(ours, theirs) for ours, theirs in zip(alone, other_alone, strict=True))
    assert all((ours != theirs).any() for ours, theirs in zip(together, other_together, strict=True))
    features = network.features(images)
    apart = [*network.from_pixels(features), *network.with_shape(features, codes)]
    for ours, theirs in zip([*alone, *together], apart, strict=True):
        torch.testing.assert_close(ours, theirs)


@pytest.mark.parametrize("name", ["PixelShapeCNN", "PixelShapeCNN-Coefficients", "ShapeNN", "AlexNet"])
def test_details_of_the_points_count_where_a_layout_takes_them(name, batch):
    network, (images, lines) = PixelShapeCNN(*SIZES, small(name)).eval(), batch
    moved = lines.clone()
    moved[:, sum(SIZES) :] += 1
    (*_, (identity, expression)), (*_, (other, otherwise)) = network(images, lines), network(images, moved)
    same = torch.equal(identity, other) and torch.equal(expression, otherwise)
    assert same == (not network.layout.details) == (name in ("AlexNet", "PixelShapeCNN-Coefficients"))


@pytest.mark.parametrize("name", ["PixelShapeCNN", "PixelShapeCNN-Coefficients", "ShapeNN", "AlexNet"])
def test_whether_points_were_found_counts_where_a_layout_takes_it(name, batch):
    network, (images, lines) = PixelShapeCNN(*SIZES, small(name)).eval(), batch
    found = lines.clone()
    found[:, -1] += 1
    (*_, (identity, _)), (*_, (other, _)) = network(images, lines), network(images, found)
    assert (
        torch.equal(identity, other)
        == (not network.layout.details)
        == (name in ("AlexNet", "PixelShapeCNN-Coefficients"))
    )


def test_a_network_of_lines_alone_does_not_look_at_the_pixels(batch):
    network, (images, codes) = PixelShapeCNN(*SIZES, small("ShapeNN")).eval(), batch
    ((identity, _),), ((other, _),) = network(images, codes), network(1 - images, codes)
    assert torch.equal(identity, other)


@pytest.mark.parametrize("name", ["PixelCNN", "PixelCNNSingle", "ShapeNN"])
def test_a_network_without_shape_level_input_takes_none(name, batch):
    network = PixelShapeCNN(*SIZES, small(name)).eval()
    inputs = batch[0] if network.convolutions is not None else batch[1]
    with pytest.raises(ValueError, match="no shape-level input"):
        network.with_shape(network.features(inputs), batch[1])


@pytest.mark.parametrize("name", ["PixelShapeCNN", "AlexNet", "ShapeNN"])
def test_folding_normalisation_changes_nothing(name, batch):
    network, (images, codes) = PixelShapeCNN(*SIZES, small(name)), batch
    network(images, codes)  # gives the normalisations statistics that are not their first ones
    folded = network.folded()
    assert not any(isinstance(layer, nn.BatchNorm2d) for layer in folded.modules())
    for ours, theirs in zip(folded(images, codes), network.eval()(images, codes), strict=True):
        torch.testing.assert_close(ours, theirs, atol=1e-5, rtol=1e-4)


@pytest.mark.parametrize(
    ("sizes", "message"),
    [
        ({"convolutions": "dense"}, "residual, alexnet or none; given 'dense'"),
        ({"convolutions": "none", "shape": 0}, "pixels or shape; this layout has neither"),
    ],
)
def test_layouts_that_are_none_are_refused(sizes, message):
    with pytest.raises(ValueError, match=message):
        Layout(**sizes)
    with pytest.raises(ValueError, match=message):
        Layout.from_json(json.dumps(json.loads(TINY.to_json()) | sizes))


@pytest.mark.parametrize("name", list(VARIANTS))
def test_a_tiny_layout_has_the_same_parts(name):
    layout = VARIANTS[name].layout
    tiny = layout.tiny()
    assert (tiny.convolutions, tiny.branched, tiny.shape > 0) == (
        layout.convolutions,
        layout.branched,
        layout.shape > 0,
    )
    assert tiny.hidden == TINY.hidden and PixelShapeCNN(*SIZES, tiny).sizes == SIZES


sizes = st.integers(1, 4096)
stages = st.lists(st.integers(0, 512), min_size=1, max_size=5).map(tuple)


@given(
    st.builds(
        Layout,
        convolutions=st.sampled_from(["residual", "alexnet", "none"]),
        channels=stages,
        blocks=stages,
        bottleneck=sizes,
        hidden=sizes,
        branch=sizes,
        shape=sizes,
        details=st.integers(0, 4096),
        joined=st.integers(0, 4096),
        branched=st.booleans(),
    )
)
def test_layouts_are_read_as_they_were_kept(layout):
    again = Layout.from_json(layout.to_json())
    assert again == layout and hash(again) == hash(layout)
