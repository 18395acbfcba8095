"""The networks of the paper's Table 2 by name: each is a layout, and what it is trained on."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from ..inference.network import COMPACT, PAPER, Layout
from .examples import Variety


@dataclass(frozen=True)
class Variant:
    """A network to train.

    Parameters
    ----------
    layout : Layout
    variety : Variety
    """

    layout: Layout
    variety: Variety = field(default_factory=Variety)


_PIXELS = replace(COMPACT, shape=0)

VARIANTS = {
    "PixelShapeCNN": Variant(COMPACT),
    # As the paper joins the lines.
    "PixelShapeCNN-Coefficients": Variant(replace(COMPACT, details=0, joined=0)),
    "PixelCNN": Variant(_PIXELS),
    "PixelCNN-Wrinkle": Variant(_PIXELS, Variety(wrinkles=0.0)),
    "ShapeNN": Variant(replace(COMPACT, convolutions="none")),
    "PixelCNNSingle": Variant(replace(_PIXELS, branched=False)),
    "AlexNet": Variant(PAPER),
}
