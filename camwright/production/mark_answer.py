"""The object that ``camwright marks --json`` prints, and the table that a controller clamps with."""

from __future__ import annotations

import csv
import io
from typing import Any

from camwright.answers.measures import millimetres
from camwright.production.mark_offsets import DeadTime
from camwright.production.marks import ByMethod, Marks
from camwright.profiles.closed_forms.mark_loop import best_gain
from camwright.profiles.mark_range import MarkRange

METHODS = ("redesign", "master_phase", "slave_offset")
"""What a controller can do about a mark."""


def marks_answer(
    found: Marks, dead: DeadTime | None = None, wander: tuple[float, float] | None = None
) -> dict[str, Any]:
    """Answer of ``camwright marks``; null for an end of a range is no limit, for a method that it does not hold on this machine.

    Parameters
    ----------
    dead
        Dead time of the sensor, if offsets were given.
    wander
        Standard deviations of the material's stretch in a cut and of the sensor (m), if they were given.
    """
    here = found.here
    return {
        "job": found.job.name,
        "line_speed_m_per_s": here.line_speed,
        **range_answer(here.redesign),
        "proved": found.proved,
        "by_method": {
            "redesign": range_answer(here.redesign),
            "master_phase": {
                **range_answer(here.master_phase),
                "by_acceleration_alone": range_answer(found.phase_alone),
            },
            "slave_offset": _offset(here, found),
        },
        "by_speed": [
            {"line_speed_m_per_s": each.line_speed, **range_answer(each.redesign), **_methods(each)}
            for each in found.by_speed
        ],
        "loop": {
            "delay_cuts": found.delay,
            "greatest_gain": found.greatest_gain,
            "gain_without_overshoot": found.gain,
            "noise_variance_share": found.noise,
            "best_gain": None if wander is None else best_gain(*wander),
        },
        "window_mm": range_answer(here.redesign),
        "dead_time": None
        if dead is None
        else {
            "time_ms": dead.time * 1e3,
            "time_error_ms": dead.time_error * 1e3,
            "constant_mm": dead.constant * 1e3,
            "greatest_residual_mm": dead.residual * 1e3,
            "measurements": dead.points,
        },
    }


def range_answer(found: MarkRange) -> dict[str, float | None]:
    """Answer of one range."""
    return {"earliest_mm": millimetres(found.earliest), "latest_mm": millimetres(found.latest)}


def _methods(each: ByMethod) -> dict[str, Any]:
    offset = each.slave_offset
    return {
        "master_phase": range_answer(each.master_phase),
        "slave_offset": None if offset is None else range_answer(offset),
    }


def _offset(here: ByMethod, found: Marks) -> dict[str, Any] | None:
    if here.slave_offset is None:
        return None
    alone = found.offset_alone
    return {
        **range_answer(here.slave_offset),
        "by_acceleration_alone": None if alone is None else range_answer(alone),
    }


def clamp_table(found: Marks) -> str:
    """Write the ranges over the line speed as CSV, mm: a cell that is empty has no limit, or the method does not hold."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    ends = [f"{method}_{end}_mm" for method in METHODS for end in ("earliest", "latest")]
    rows.writerow(["line_speed_m_per_min", *ends])
    for each in found.by_speed:
        cells: list[str] = []
        for part in (each.redesign, each.master_phase, each.slave_offset):
            pair = (None, None) if part is None else (part.earliest, part.latest)
            # towards zero: what is written lies inside
            cells += ["" if end is None else f"{int(end * 1e6) / 1e3:.3f}" for end in pair]
        rows.writerow([f"{each.line_speed * 60:.6g}", *cells])
    return text.getvalue()
