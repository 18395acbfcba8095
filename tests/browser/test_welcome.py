"""A newcomer's first minute."""

from __future__ import annotations

from studio_page import StudioPage, until


def test_one_click_loads_a_drawing_and_undo_empties_the_pad_again(studio_lab: StudioPage) -> None:
    offers = studio_lab.root.locator(".sketchwidget-welcome button")
    until(lambda: offers.count() == 3 and offers.first.is_visible(), what="three drawings on offer")
    before = studio_lab.serial
    offers.first.click()
    studio_lab.wait_for_frame(before)
    until(lambda: studio_lab.message, lambda said: "F edits the head's own lines." in said, "the way onwards")
    until(lambda: not offers.first.is_visible(), what="an offer that is gone")
    studio_lab.press("Control+z")
    until(offers.first.is_visible, what="the offer once more")
