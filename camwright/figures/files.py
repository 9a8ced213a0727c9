"""Writing the figures as SVG and PNG, with the same bytes for the same results."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from camwright.drives.audit import Audit
from camwright.figures.audit import audit_figure
from camwright.figures.axis import AXES as SHOWN_AXES
from camwright.figures.axis import axis_figure
from camwright.figures.comparison import bars_figure
from camwright.figures.crank import crank_figure
from camwright.figures.profile import profile_figure
from camwright.figures.servo import AXES, servo_figure
from camwright.figures.style import RC
from camwright.figures.tradeoff import tradeoff_figure
from camwright.studies.axis_study import robust_band
from camwright.studies.comparison import Comparison
from camwright.studies.design import Design
from camwright.studies.tradeoff import TradeOff
from camwright.validation.servo.simulation import simulate

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def design_figures(design: Design, directory: Path) -> list[Path]:
    """Write the figures of a design, each as SVG and PNG.

    They are ``profile``, ``servo`` and ``comparison``; for a tool that turns back also ``crank``, for a servo-aware design ``axis``.

    Parameters
    ----------
    design
        What is drawn.
    directory
        An existing directory.

    Returns
    -------
    list
        The files.
    """
    job, comparison = design.job, design.comparison
    runs = {name: simulate(comparison[name].profile, job.cut, job.servo) for name in AXES}
    return [
        *written(lambda: profile_figure(comparison), directory, "profile"),
        *written(lambda: servo_figure(comparison, runs), directory, "servo"),
        *comparison_figure(comparison, directory),
        *(
            written(lambda: crank_figure(comparison), directory, "crank")
            if job.machine.dead_centres is not None
            else []
        ),
        *(_axis_figures(design, directory) if design.axis is not None else []),
    ]


def _axis_figures(design: Design, directory: Path) -> list[Path]:
    """Write the figure of a servo-aware design's axis."""
    job, names = design.job, {row.name for row in design.comparison.rows}
    runs = {name: simulate(design.comparison[name].profile, job.cut, job.servo) for name in SHOWN_AXES if name in names}
    band = robust_band(job, design.profile)
    return written(lambda: axis_figure(design, runs, band), directory, "axis")


def comparison_figure(comparison: Comparison, directory: Path) -> list[Path]:
    """Write the bars of a comparison: ``comparison.svg`` and ``comparison.png`` in an existing directory."""
    return written(lambda: bars_figure(comparison), directory, "comparison")


def tradeoff_figures(result: TradeOff, directory: Path) -> list[Path]:
    """Write the figure of a trade-off: ``tradeoff.svg`` and ``tradeoff.png`` in an existing directory."""
    return written(lambda: tradeoff_figure(result), directory, "tradeoff")


def audit_figures(audit: Audit, directory: Path) -> list[Path]:
    """Write the figure of an audit: ``audit.svg`` and ``audit.png`` in an existing directory."""
    return written(lambda: audit_figure(audit), directory, "audit")


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
