"""What figures are made of: a blank sheet and the marks of a legend; matplotlib is loaded when the first is made."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from camwright.figures.style import WIDTH

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch


def blank_figure(height: float) -> Figure:
    """Make an empty figure of the text's width; the height in inches."""
    from matplotlib.figure import Figure

    return Figure(figsize=(WIDTH, height), layout="constrained")


def line_mark(**style: Any) -> Line2D:
    """Make the mark of a line in a legend."""
    from matplotlib.lines import Line2D

    return Line2D([], [], **style)


def patch_mark(**style: Any) -> Patch:
    """Make the mark of an area in a legend."""
    from matplotlib.patches import Patch

    return Patch(**style)
