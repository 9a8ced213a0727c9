"""What is no fault of a job file but worth a second look: numbers far from any machine's, and what is left out although it matters."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from camwright.house.numbers import SHOWN, Units, typed
from camwright.house.units import KINDS
from camwright.jobs.job import Job
from camwright.jobs.numbers import job_numbers
from camwright.jobs.template import values_of
from camwright.profiles.machines import MACHINES
from camwright.profiles.machines.fields import MachineField, Quantity, fields_of


@dataclass(frozen=True)
class Doubts:
    """What a job file should be looked at again for.

    Parameters
    ----------
    warnings
        Numbers that hardly any machine has, each with its place, the usual range and what may have happened.
    missing
        Optional keys that are left out and matter, each with what it is taken for.
    """

    warnings: tuple[str, ...]
    missing: tuple[str, ...]


USUAL: dict[str, tuple[str, float, float]] = {
    "cut.length": ("m", 0.005, 50.0),
    "cut.line_speed": ("m/s", 1 / 60, 1500 / 60),
    "cut.sync_tolerance": ("m", 1e-6, 5e-3),
    "line.acceleration": ("m/s^2", 0.01, 50.0),
    "line.stop": ("m/s^2", 0.05, 100.0),
    "line.jerk": ("m/s^3", 0.01, 1e5),
    "servo.bandwidth": ("bandwidth", 16.0, 750.0),
    "servo.damping": ("1", 0.3, 2.0),
    "servo.position_gain": ("1/s", 2.0, 250.0),
    "servo.sample_time": ("s", 1e-4, 0.02),
    "servo.dead_time": ("s", 0.0, 0.05),
}
"""Unit and range of numbers that machines have, by place; a servo's is the published range of S1 (bandwidth 80 to 150 rad/s, damping
0.7 to 0.9, gain 10 to 50 1/s, sample time 1 to 8 ms) and five times beyond."""

_MACHINE_LENGTH = (0.01, 20.0)
"""Range of a machine's lengths (m)."""

_LIMITS = {"m": {"speed": (0.02, 50.0), "acceleration": (0.2, 2000.0), "jerk": (2.0, 1e6)},
           "rad": {"speed": (0.2, 1000.0), "acceleration": (2.0, 50_000.0), "jerk": (20.0, 5e7)}}  # fmt: skip
_POWERS = {"speed": "/s", "acceleration": "/s^2", "jerk": "/s^3"}


def doubts(job: Job) -> Doubts:
    """Look at a job for what is no fault and yet hardly meant.

    Examples
    --------
    >>> from camwright import load_job
    >>> doubts(load_job()).warnings
    ()
    """
    given = values_of(job.text)
    return Doubts(tuple(_implausible(job, given)), tuple(_missing(job, given)))


def _implausible(job: Job, given: dict[str, object]) -> Iterator[str]:
    """Compare what is given with what machines have."""
    numbers = job_numbers(job)
    unit = job.machine.slave_unit
    for each in fields_of(MACHINES[job.machine.kind]):
        value = getattr(job.machine, each.name)
        if _is_length(each) and not _MACHINE_LENGTH[0] <= value <= _MACHINE_LENGTH[1]:
            yield _far(f"machine.{each.key}", value, "m", _MACHINE_LENGTH, given, job.units)
    for place, (si, *ends) in USUAL.items():
        table, key = place.split(".")
        value = numbers.get(table, {}).get(key)
        if value is not None and not ends[0] <= value <= ends[1]:
            yield _far(place, value, si, (ends[0], ends[1]), given, job.units)
    for key, limits in _LIMITS[unit].items():
        value = numbers["limits"][key]
        if not limits[0] <= value <= limits[1]:
            yield _far(f"limits.{key}", value, unit + _POWERS[key], limits, given, job.units)


def _is_length(each: MachineField) -> bool:
    """Whether a machine's number is a size of it: a length that must be given."""
    return isinstance(each.about, Quantity) and KINDS[each.about.kind].unit == "m" and each.required


def _far(place: str, value: float, si: str, ends: tuple[float, float], given: dict[str, object], units: Units) -> str:
    """Say that a number is far from what machines have."""
    table, key = place.split(".")
    known = si if si in SHOWN else "1"
    written = given.get(place, typed(value, known, 6, units))
    low, high = (typed(end, known, 5, units) for end in ends)
    side = "below" if value < ends[0] else "above"
    return (
        f"[{table}] {key} = {written}: {side} what machines have, {low} to {high}; is its unit the one that is meant?"
    )


def _missing(job: Job, given: dict[str, Any]) -> Iterator[str]:
    """List what is left out although an answer depends on it."""
    if job.cut.shear_zone == 0.0 and "cut.shear_zone" not in given:
        yield "[cut] shear_zone: taken as a cut of no length; the axis is judged in a point only"
    if "cut.sync_tolerance" not in given:
        yield f"[cut] sync_tolerance: taken as {typed(job.cut.sync_tolerance, 'm', 4, job.units)}"
    if not job.machine.moves_something:
        loads = " or ".join(each.key for each in fields_of(type(job.machine)) if each.load)
        yield f"[machine] {loads}: nothing to move, so no torque and no energy is told"
    elif job.limits.motor is None:
        yield "[limits] motor: no torque-speed curve, so torque is told but not limited"
    if not job.line.ramps:
        yield "[line] acceleration, stop: taken as a line that keeps its speed; what the cam does while it ramps is not checked"
    if "servo.dead_time" not in given:
        yield "[servo] dead_time: taken as 0 ms; where the cut falls depends on it"
