"""Writing figures as SVG and PNG, with the same bytes for the same results."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from camwright.figures.style import RC

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def written(draw: Callable[[], Figure], directory: Path, name: str) -> list[Path]:
    """Draw a figure in the house's style and save it twice.

    It is drawn once, as SVG with its text as outlines; the PNG is made of that.
    """
    from matplotlib import style as matplotlib_style

    vector, pixels = directory / f"{name}.svg", directory / f"{name}.png"
    figure = drawn(draw)
    with matplotlib_style.context(["default", RC]):
        figure.savefig(vector, metadata={"Date": None, "Creator": None})
        width, height = figure.get_size_inches()
    _to_pixels(vector, pixels, float(width), float(height))
    return [vector, pixels]


def drawn(draw: Callable[[], Figure]) -> Figure:
    """Draw a figure in the house's style, whatever the user's settings of matplotlib."""
    from matplotlib import style as matplotlib_style
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    with matplotlib_style.context(["default", RC]):
        figure = draw()
        ConstrainedLayoutEngine().execute(figure)
        figure.set_layout_engine("none")  # laid out once: saving would do it again
    return figure


def _to_pixels(vector: Path, pixels: Path, width: float, height: float) -> None:
    """Make a PNG of an SVG of a size (in), with the resolution of the house's style."""
    import typst

    with tempfile.TemporaryDirectory() as folder:
        page = Path(folder) / "figure.typ"
        shutil.copyfile(vector, page.with_suffix(".svg"))
        page.write_text(
            f"#set page(width: {width:.6f}in, height: {height:.6f}in, margin: 0pt)\n"
            '#image("figure.svg", width: 100%, height: 100%, fit: "stretch")',
            encoding="utf-8",
        )
        typst.compile(
            str(page),
            output=str(pixels),
            root=folder,
            ignore_system_fonts=True,
            format="png",
            ppi=float(RC["figure.dpi"]),
        )
