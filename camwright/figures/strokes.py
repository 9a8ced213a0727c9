"""Strokes of lines: colours and dashes that hold up in black and white."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Stroke:
    """How a line is drawn.

    Parameters
    ----------
    colour
        As ``"#rrggbb"``.
    width
        Of the stroke (pt).
    dash
        Lengths of strokes and gaps in turn (pt); drawn through if empty.
    """

    colour: str
    width: float
    dash: tuple[float, ...] = ()


LINES: dict[str, Stroke] = {
    "optimised": Stroke("#0072b2", 2.2),
    "linear_return": Stroke("#d55e00", 1.5, (8.0, 2.6)),
    "poly_3_4_5": Stroke("#007a5a", 1.5, (9.0, 2.3, 2.0, 2.3)),
}
"""Stroke of each profile drawn; colours of Okabe and Ito's palette, told apart by colour-blind readers."""

LIMIT = Stroke("#000", 1.3, (1.3, 2.0))
COMMAND = Stroke("#6b6b6b", 1.6, (1.3, 2.0))
BLACK, GREY = "#000", "#6b6b6b"
