"""The object that ``camwright ramps --json`` prints."""

from __future__ import annotations

import math
from typing import Any

from camwright.answers.measures import checks_answer, millimetres
from camwright.drives.export import export_answer
from camwright.production.ramp_tables import KINDS, RampTables
from camwright.production.ramps import Ramps
from camwright.profiles.ramp import Ramp


def ramps_answer(found: Ramps, tables: RampTables | None = None) -> dict[str, Any]:
    """Answer of ``camwright ramps``: lengths in mm, times in ms; the measures in m are null for a slave that is counted in rad."""
    start, stop = found.bounds
    metres = found.job.machine.slave_unit == "m"
    least = None if found.arcs.run_up is None else found.arcs.run_up.arc
    return {
        "job": found.job.name,
        "minimised": found.aim,
        "line_speed_m_per_s": found.job.cut.line_speed,
        "park": {"mm": found.stand.park * 1e3} if metres else {"deg": math.degrees(found.stand.park)},
        "ramp_in": ramp_answer(found, found.ramp_in, start),
        "ramp_out": ramp_answer(found, found.ramp_out, stop),
        "one_shot": {"master_mm": found.one_shot.length * 1e3, **_peak(found, found.peak_acceleration)},
        "least_arc_mm": millimetres(least) if metres else None,
        **({} if metres else {"least_arc_rad": least}),
        "standstill_up_to_m_per_s": found.fastest,
        "first_cut": {
            "latency_ms": found.latency * 1e3,
            "sensor_ahead_mm": millimetres(found.least_sensor),
            "sensor_ahead_of_this_ramp_mm": found.sensor * 1e3,
        },
        "checks": checks_answer(found.checks),
        "passed": found.passed and (tables is None or tables.passed),
        "tables": {} if tables is None else {kind: export_answer(tables.results[kind])["targets"] for kind in KINDS},
        "refused": {} if tables is None else {kind: tables.refused[kind] for kind in KINDS if tables.refused[kind]},
    }


def ramp_answer(found: Ramps, ramp: Ramp, bound: float | None) -> dict[str, Any]:
    """Answer of one ramp; the bound is of what was made least."""
    metres = found.job.machine.slave_unit == "m"
    value, unit = objective_of(found, ramp)
    peak_bound = bound if found.aim == "peak_acceleration" else None
    return {
        "arc_mm": ramp.arc * 1e3 if metres else None,
        "master_mm": ramp.master * 1e3,
        "time_ms": ramp.time * 1e3,
        **_peak(found, ramp.peak_acceleration),
        "lower_bound_m_per_s2": peak_bound if metres else None,
        **({} if metres else {"arc_rad": ramp.arc, "lower_bound_rad_per_s2": peak_bound}),
        "rms_acceleration" + ("_m_per_s2" if metres else "_rad_per_s2"): ramp.rms_acceleration,
        "objective": {"value": value, "unit": unit, "lower_bound": bound},
    }


def objective_of(found: Ramps, ramp: Ramp) -> tuple[float, str]:
    """Value of what was made least of a ramp, and its SI unit."""
    slave = found.job.machine.slave_unit
    if found.aim == "rms_acceleration":
        return ramp.heat, f"{slave}^2/s^3"
    if found.aim == "shortest":
        return ramp.master, "m"
    return ramp.peak_acceleration, f"{slave}/s^2"


def _peak(found: Ramps, value: float) -> dict[str, float | None]:
    if found.job.machine.slave_unit == "m":
        return {"peak_acceleration_m_per_s2": value}
    return {"peak_acceleration_m_per_s2": None, "peak_acceleration_rad_per_s2": value}
