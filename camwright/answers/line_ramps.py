"""What an answer says of how hard the line may ramp."""

from __future__ import annotations

import math
from typing import Any

from camwright.studies.line_ramps import LineRamps
from camwright.validation.production.line_ramp import Allowed


def line_ramps_answer(found: LineRamps | None) -> dict[str, Any] | None:
    """Write how hard the line may ramp; null of a job that has no cam, and for a number where nothing binds."""
    if found is None:
        return None
    return {
        "acceleration_m_per_s2": _number(found.up_to.ramp),
        "stop_m_per_s2": _number(found.up_to.braking),
        "binds": found.up_to.ramp.binds,
        "stop_length_mm": None if found.stop_length is None else found.stop_length * 1e3,
        "by_acceleration_alone_m_per_s2": _number(found.alone),
        "sync_error": _sync_answer(found),
        "by_speed": [
            {
                "line_speed_m_per_s": each.line_speed,
                "acceleration_m_per_s2": _number(each.speeding),
                "stop_m_per_s2": _number(each.braking),
                "binds": each.ramp.binds,
                "at_m": each.ramp.at,
            }
            for each in found.curve
        ],
    }


def _sync_answer(found: LineRamps) -> dict[str, Any] | None:
    """Write the greatest sync error while the line ramps as the job says; null where it says nothing or the servo is unstable."""
    if found.sync is None:
        return None
    error, speed, way = found.sync.worst
    within = error <= found.job.cut.sync_tolerance
    return {"worst_mm": error * 1e3, "line_speed_m_per_s": speed, "while": way, "within_tolerance": within}


def _number(allowed: Allowed) -> float | None:
    """Give a magnitude (m/s²); null where nothing binds."""
    return allowed.value if math.isfinite(allowed.value) else None
