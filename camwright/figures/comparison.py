"""The comparison figure: peaks, root mean squares and settling length of all profiles as bars."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from camwright.figures.marks import blank_figure, line_mark, patch_mark
from camwright.figures.saving import written
from camwright.figures.style import (
    LIMIT,
    LINES,
    title,
)
from camwright.profiles.objective import OBJECTIVES
from camwright.studies.comparison import Comparison
from camwright.studies.measured import Measured

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch


_BASELINE = "#b5b5b5"
_UNBOUNDED_HATCH = "xxxx"
_BEYOND_HATCH = "////"
_BEYOND = 1e-9
"""Part of a limit by which rounding may exceed it."""

_FAR = 4.0
"""A limit is drawn as a line if it is at most this many times the longest bar, else named in words."""


def comparison_figure(comparison: Comparison, directory: Path) -> list[Path]:
    """Write the bars of a comparison: ``comparison.svg`` and ``comparison.png`` in an existing directory."""
    return written(lambda: bars_figure(comparison), directory, "comparison")


def bars_figure(comparison: Comparison) -> Figure:
    """Draw the measures of all profiles side by side by the job's objective, what breaks a limit marked and at the bottom.

    What is unbounded, and what does not exist, has a hatched bar over the whole panel and says so.

    Parameters
    ----------
    comparison
        The profiles measured.
    """
    rows, limits = comparison.rows, comparison.job.limits
    figure = blank_figure(1.5 + 0.24 * len(rows))
    unit = comparison.job.machine.slave_unit
    names = [row.name for row in rows]
    columns: list[tuple[str, list[float | None], float | None, str]] = [
        (f"peak acc.\n({unit}/s²)", [row.motion.peak_acceleration for row in rows], limits.acceleration, "unbounded"),
        (f"RMS acc.\n({unit}/s²)", [row.motion.rms_acceleration for row in rows], None, "unbounded"),
        (f"peak jerk\n({unit}/s³)", [row.motion.peak_jerk for row in rows], limits.jerk, "unbounded"),
        (f"RMS jerk\n({unit}/s³)", [row.motion.rms_jerk for row in rows], None, "unbounded"),
        (
            "settling\n(mm)",
            [None if row.response.settling is None else row.response.settling * 1e3 for row in rows],
            None,
            "not in zone",
        ),
    ]
    if comparison.job.objective == "sync_error":
        errors: list[float | None] = [
            None if (error := row.value("sync_error")) is None else error * 1e3 for row in rows
        ]
        columns.append(("sync error\n(mm)", errors, comparison.job.cut.sync_tolerance * 1e3, "unbounded"))
    torques = [row.motor.rms_torque for row in rows]
    if any(torque is not None for torque in torques):
        columns.insert(2, ("RMS torque\n(N·m)", torques, None, "unbounded"))
    panels = figure.subplots(1, len(columns), sharey=True)
    limits_drawn = False
    for axes, (heading, values, limit, without) in zip(panels, columns, strict=True):
        limits_drawn |= _bars(axes, names, values, limit, without)
        axes.set_title(heading)
    panels[0].set_yticks(range(len(rows)), [_label(row) for row in rows])
    for label, name in zip(panels[0].get_yticklabels(), names, strict=True):
        label.set_fontweight("bold" if name == "optimised" else "normal")
    panels[0].invert_yaxis()
    note = "; † breaks a limit" if any(not row.within_limits for row in rows) else ""
    figure.suptitle(
        f"{comparison.job.name}: all profiles, by {OBJECTIVES[comparison.job.objective].words}{note}", fontsize=9.5
    )
    figure.legend(handles=_handles(columns, limits_drawn), loc="outside lower center", ncols=5)
    return figure


def _label(row: Measured) -> str:
    """Name a profile, marked if it breaks a limit of the job."""
    name = title(row.name).split(" (")[0].split(",")[0]
    return name if row.within_limits else f"{name} †"


def _handles(
    columns: Sequence[tuple[str, list[float | None], float | None, str]], limits_drawn: bool
) -> list[Patch | Line2D]:
    """Entries of the legend: what is there to be seen."""
    handles: list[Patch | Line2D] = [
        patch_mark(facecolor=LINES["optimised"]["color"], label="optimised"),
        patch_mark(facecolor=_BASELINE, label="baseline"),
    ]
    if any(_is_beyond(value, limit) for _, values, limit, _ in columns for value in values):
        handles.append(
            patch_mark(
                facecolor=_BASELINE, edgecolor="black", hatch=_BEYOND_HATCH, linewidth=0.0, label="beyond the limit"
            )
        )
    if any(value is None for _, values, _, _ in columns for value in values):
        handles.append(
            patch_mark(
                facecolor="white", edgecolor="#777777", hatch=_UNBOUNDED_HATCH, linewidth=0.5, label="unbounded or none"
            )
        )
    return [*handles, *([line_mark(label="limit of the drive", **LIMIT)] if limits_drawn else [])]


def _is_beyond(value: float | None, limit: float | None) -> bool:
    return value is not None and limit is not None and value > limit * (1 + _BEYOND)


def _bars(axes: Axes, names: Sequence[str], values: Sequence[float | None], limit: float | None, without: str) -> bool:
    """Draw one measure of all profiles, its numbers written beside the bars; tell whether its limit is drawn."""
    longest = max((value for value in values if value is not None), default=0.0) or limit or 1.0
    drawn = limit is not None and limit <= _FAR * longest
    if limit is not None and drawn:
        axes.axvline(limit, **LIMIT)
        longest = max(longest, limit)
    elif limit is not None:
        axes.set_xlabel(f"limit {limit:g}: off scale", fontsize=7)
    width = 1.55 * longest
    axes.set_xlim(0.0, width)
    for i, (name, value) in enumerate(zip(names, values, strict=True)):
        if value is None:
            axes.barh(i, width, 0.66, facecolor="white", edgecolor="#777777", hatch=_UNBOUNDED_HATCH, linewidth=0.0)
            axes.text(0.5 * width, i, without, ha="center", va="center", fontsize=6.5,
                      bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.8})  # fmt: skip
        else:
            beyond = _is_beyond(value, limit)
            colour = LINES["optimised"]["color"] if name == "optimised" else _BASELINE
            axes.barh(
                i,
                value,
                0.66,
                facecolor=colour,
                edgecolor="black",
                linewidth=0.0,
                hatch=_BEYOND_HATCH if beyond else "",
            )
            axes.text(value + 0.03 * width, i, f"{value:.4g}", ha="left", va="center", fontsize=6.5)
    axes.grid(visible=False)
    axes.tick_params(axis="y", length=0)
    axes.tick_params(axis="x", labelsize=6.5)
    axes.locator_params(axis="x", nbins=3)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    return drawn
