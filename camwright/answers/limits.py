"""The object that ``camwright limits --json`` prints."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from camwright.answers.line_ramps import line_ramps_answer
from camwright.answers.measures import lengths_answer, millimetres
from camwright.studies.axis_lengths import AxisLengths
from camwright.studies.band_lengths import BandLengths
from camwright.studies.limits import MachineLimits


def limits_answer(found: MachineLimits) -> dict[str, Any]:
    """Answer of ``camwright limits``; null where nothing works, or where the published equations are not about the machine."""
    far, within, lengths = found.far, found.within, found.lengths
    return {
        "job": found.job.name,
        "max_line_speed_m_per_min": None if far.max_line_speed is None else far.max_line_speed * 60,
        "min_cut_length_mm": millimetres(far.min_cut_length),
        "binding": {"line_speed": far.line_speed_binding, "cut_length": far.cut_length_binding},
        "highest_line_speed_m_per_s": {"perfect_axis": far.max_line_speed, "axis_in_tolerance": within.max_line_speed},
        "shortest_cut_mm": {
            "perfect_axis": millimetres(far.min_cut_length),
            "axis_in_tolerance": millimetres(within.min_cut_length),
            **shortest_cuts_answer(found.axis, found.over_band),
        },
        "axis_in_tolerance_binding": {"line_speed": within.line_speed_binding, "cut_length": within.cut_length_binding},
        "minimum_cut_length_mm": lengths_answer(lengths),
        "physical_bound_binding": lengths.binding if lengths else None,
        "eq10_with_settling_mm": millimetres(lengths.eq10_settling) if lengths else None,
        "transition_length_mm": {
            "crossing": millimetres(lengths.crossing) if lengths else None,
            "settling": millimetres(lengths.settling) if lengths else None,
        },
        **axis_lengths_answer(found.axis),
        "line_ramp": line_ramps_answer(found.ramps),
    }


_BY = ("linear_return", "poly_3_4_5", "in_sync", "shaped")
"""Motions whose shortest cut is told."""


def shortest_cuts_answer(single: AxisLengths | None, band: BandLengths | None) -> dict[str, Any]:
    """Shortest cuts with the axis in tolerance by motion (mm): at the job's line speed and over its band; null where there is none."""
    at_speed = None
    if single is not None:
        found = (single.linear_return, single.poly_3_4_5, single.in_sync_axis_limits, single.shaped_axis_limits)
        at_speed = {name: millimetres(length) for name, length in zip(_BY, found, strict=True)}
    over = None if band is None else {name: millimetres(getattr(band, name)) for name in _BY}
    return {
        "at_line_speed": at_speed,
        "over_band": over,
        "band_m_per_s": None if band is None else list(band.line_speeds),
    }


def axis_lengths_answer(lengths: AxisLengths | None) -> dict[str, Any]:
    """Minimum cut lengths with the axis in sync, in mm; null for machines that the published equations are not about."""
    if lengths is None:
        none = dict.fromkeys(_BY)
        return {"axis_minimum_cut_length_mm": none, "axis_minimum_cut_length_axis_limits_mm": dict.fromkeys(_BY[2:])}
    values = {name: None if value is None else value * 1e3 for name, value in asdict(lengths).items()}
    return {
        "axis_minimum_cut_length_mm": {name: values[name] for name in _BY},
        "axis_minimum_cut_length_axis_limits_mm": {name: values[f"{name}_axis_limits"] for name in _BY[2:]},
    }
