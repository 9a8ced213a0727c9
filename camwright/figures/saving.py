"""Writing figures as SVG and PNG, with the same bytes for the same results."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from camwright.figures.style import RC

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def written(draw: Callable[[], Figure], directory: Path, name: str) -> list[Path]:
    """Draw a figure in the house's style, whatever the user's settings of matplotlib, and save it twice."""
    from matplotlib import style as matplotlib_style
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    vector, pixels = directory / f"{name}.svg", directory / f"{name}.png"
    with matplotlib_style.context(["default", RC]):
        figure = draw()
        ConstrainedLayoutEngine().execute(figure)
        figure.set_layout_engine("none")  # laid out once: each file would do it again
        figure.savefig(vector, metadata={"Date": None, "Creator": None})
        figure.savefig(pixels, metadata={"Software": None})
    return [vector, pixels]
