"""What an answer says of the objective."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from camwright.studies.design import Design

_UNITS = {"rms_torque": "N m", "peak_torque": "N m", "energy": "J"}


_OVER_TIME = {"acceleration": "/s^2", "jerk": "/s^3"}


def objective_unit(design: Design) -> str:
    """Name the unit of a design's objective."""
    if design.job.minimise_sync_error:
        return "m"
    return _UNITS.get(design.solution.objective_name, design.job.machine.slave_unit) + _OVER_TIME.get(
        design.solution.objective_name.rpartition("_")[2], ""
    )


def objective_name(design: Design) -> str:
    """Name what a design minimised."""
    return "sync_error" if design.job.minimise_sync_error else design.solution.objective_name


def objective_answer(design: Design) -> dict[str, Any]:
    """Write the objective of a design: name, value, unit, lower bound and gap, null where there is no bound."""
    return {
        "name": objective_name(design),
        "value": design.objective,
        "unit": objective_unit(design),
        "lower_bound": None if math.isnan(design.bound.value) else design.bound.value,
        "gap": design.gap,
    }


def starts_answer(design: Design) -> dict[str, Any] | None:
    """Write what several starts agree on; null where one was enough because the problem is convex."""
    return None if design.solution.starts is None else asdict(design.solution.starts)
