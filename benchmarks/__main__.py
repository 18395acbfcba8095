"""Measure everything and write the table.

python -m benchmarks
"""

from __future__ import annotations

from pathlib import Path

from sketchwidget.training.tables import machine

from . import browser, kernel

DELAY = 50.0  # milliseconds each way, of the network to a server that is far away
TABLE = Path(__file__).parent / "RESULTS.md"


def main() -> None:
    """Write `RESULTS.md` beside this file."""
    in_kernel, in_page, from_afar = kernel.measure(), browser.measure(), browser.measure(delay=DELAY)
    rows = [
        ("network, one sketch", f"{in_kernel['network']:.1f} ms"),
        ("mesh from its weights", f"{in_kernel['mesh']:.1f} ms"),
        ("sketch to face: a freehand face with ears, strokes named", f"{in_kernel['inference']:.1f} ms", "20 ms"),
        ("the same on one thread, as a session computes", f"{in_kernel['inference, one thread']:.1f} ms"),
        ("one stroke of a session, from points to head", f"{in_kernel['session']:.1f} ms"),
        ("deformation by all curve handles", f"{in_kernel['deformation']:.1f} ms", "8 ms"),
        ("the same, unfolding a mouth drawn twice as wide", f"{in_kernel['unfolding']:.1f} ms"),
        ("a piece of a line redrawn in follow-up sketching", f"{in_kernel['followup']:.1f} ms"),
        ("a gesture told from the others", f"{in_kernel['classification']:.1f} ms", "5 ms"),
        ("deformation of a region by free handles, once factored", f"{in_kernel['region']:.1f} ms", "8 ms"),
        ("the factorisation of that region", f"{in_kernel['factor']:.0f} ms"),
        ("a gesture of a session, from stroke to head", f"{in_kernel['gesture']:.1f} ms"),
        ("caricature from 68 landmarks", f"{in_kernel['caricature'] / 1000:.2f} s", "2 s"),
        ("one step of it, from a former one on", f"{in_kernel['caricature step']:.0f} ms"),
        ("pen-up to updated frame, median", _ms(in_page["head"]["median"])),
        ("pen-up to updated frame, 95th percentile", _ms(in_page["head"]["p95"]), "150 ms"),
        ("the same in follow-up sketching, median", _ms(in_page["followup"]["median"])),
        ("the same in follow-up sketching, 95th percentile", _ms(in_page["followup"]["p95"]), "150 ms"),
        ("pointer event to ink, median", f"{in_page['ink']['median']:.1f} ms"),
        ("pointer event to ink, 95th percentile", f"{in_page['ink']['p95']:.1f} ms", "16 ms"),
        (
            f"pen-up to updated frame through a network of {DELAY:.0f} ms each way, median",
            _ms(from_afar["head"]["median"]),
        ),
        ("the same, 95th percentile", _ms(from_afar["head"]["p95"])),
        ("pointer event to ink through it, 95th percentile", f"{from_afar['ink']['p95']:.1f} ms", "16 ms"),
        ("`import sketchwidget`", f"{in_kernel['import']:.0f} ms", "1 s"),
        ("first Studio on screen, from running the cell", f"{in_page['shown']:.1f} s", "6 s"),
        ("memory of a Python with a Studio, after a stroke", f"{in_kernel['memory']:.0f} MB", "900 MB"),
    ]
    lines = [
        "# Speed",
        "",
        f"Medians on: {machine()}; no graphics card, the browser draws in software. Made by `python -m benchmarks`.",
        "",
        "| what | measured | goal |",
        "|---|---|---|",
        *(f"| {what} | {measured} | {goal[0] if goal else ''} |" for what, measured, *goal in rows),
    ]
    TABLE.write_text("\n".join(lines) + "\n")
    print(TABLE.read_text())


def _ms(milliseconds: float) -> str:
    return f"{milliseconds:.0f} ms"


if __name__ == "__main__":
    main()
