"""The slider that exaggerates the head on show."""

from __future__ import annotations

from collections.abc import Callable

from ipywidgets import FloatSlider, HBox, Label

from ..caricature.exaggeration import LARGEST

_STEP = 0.05


class Exaggerating:
    """A slider from 0, the mean face, by 1, the head as it is, to 3.

    Parameters
    ----------
    exaggerate : callable
        Called with the amount when the user moves the slider. While that is done, the browser keeps back all further
        moves but the last.

    Attributes
    ----------
    bar : widget
    """

    def __init__(self, exaggerate: Callable[[float], None]) -> None:
        self._exaggerate = exaggerate
        self._shown = 1.0
        self._slider = FloatSlider(
            1.0, min=0.0, max=LARGEST, step=_STEP, readout_format=".2f", tooltip="0: the mean face, 1: as it is"
        )
        self._slider.observe(self._on_value, "value")
        label = Label("exaggerate").add_class("sketchwidget-caption")
        self.bar = HBox([label, self._slider]).add_class("sketchwidget-exaggeration")

    def show(self, amount: float) -> None:
        """Show an amount that came about otherwise."""
        self._shown = self._slider.value = amount

    def _on_value(self, change: dict[str, float]) -> None:
        if change["new"] != self._shown:
            self._shown = change["new"]
            self._exaggerate(change["new"])
