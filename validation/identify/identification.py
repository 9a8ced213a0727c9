"""The servo's parameters from a recorded trace."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.servo import Servo
from camwright.profiles.trace import Trace
from camwright.validation.identify.clock import with_clock
from camwright.validation.identify.colour import with_colour
from camwright.validation.identify.fit import (
    BEYOND,
    CONFIDENCE,
    RANGES,
    ROUNDS,
    Minimum,
    TraceFit,
)
from camwright.validation.identify.level import with_level
from camwright.validation.identify.preparation import geared, unwrapped
from camwright.validation.identify.quality import require_lag, require_usable
from camwright.validation.identify.rounding import count_of, with_rounding

Origin = Literal["trace", "assumed", "given"]
"""Where the velocity feed-forward comes from."""

_UNITS = {
    "bandwidth": (1.0, " rad/s"),
    "damping": (1.0, ""),
    "position_gain": (1.0, " 1/s"),
    "sample_time": (1e3, " ms"),
    "dead_time": (1e3, " ms"),
    "velocity_feedforward": (1.0, ""),
    "acceleration_feedforward": (1e6, " ms^2"),
    "jerk_feedforward": (1e9, " ms^3"),
}
_WORST_FIT = 0.5
_ROUNDED = 1e-5
"""Dead time below which a negative one is the fit's own error (s)."""
_AHEAD = 2e-4
"""Time by which the axis cannot run ahead of its command (s): noise may make it seem a little."""
_FAR_AHEAD = 1e-3
"""The same where nothing is known of the zeros yet: such a trace is not worth a search."""
_LIVELIER = "record a livelier motion, e.g. a sweep up to the bandwidth of the axis, or a longer one"


@dataclass(frozen=True)
class Identified:
    """What a trace tells of a servo.

    Parameters
    ----------
    servo
        The servo, no lead in it.
    confidence
        Least and greatest value of each fitted parameter by name, 95 % confidence, in SI units.
    feedforward_from
        Where the velocity feed-forward comes from: fitted to the trace, assumed to be 0 or 1, which the trace allows, or given.
    fit
        ``1 - |residual| / |actual - mean|``: 1 where the model is the axis.
    residual
        Rms of what the model leaves over (unit of the trace).
    rows
        Rows that were judged.
    notes
        What was taken off the trace before, or fitted beside.
    """

    servo: Servo
    confidence: dict[str, tuple[float, float]]
    feedforward_from: Origin
    fit: float
    residual: float
    rows: int
    notes: tuple[str, ...] = ()


def identify(
    trace: Trace,
    place: str,
    velocity_feedforward: float | None = None,
    beyond: Mapping[str, float | None] | None = None,
) -> Identified:
    """Find the servo that makes of the recorded command what was recorded of the axis.

    The axis' state at the beginning is not known and fitted too (three numbers, linear). The sampling clock's phase is not known either:
    where the trace shows it, it is fitted; where it does not, the model is the mean over all phases.

    The velocity feed-forward is a number that was set; the trace often tells it from the sample time only poorly. Unless given it is
    fitted, and taken as 1 or as 0 where the fit does not contradict this.

    Parameters
    ----------
    place
        What messages begin with.
    velocity_feedforward
        Share of the command's velocity that is fed forward, if known.
    beyond
        Feed-forward of acceleration and jerk by name, in SI units: as it is set, or ``None`` where it is to be fitted; 0 where it is not
        named.

    Raises
    ------
    InputError
        The trace cannot be used (`camwright.validation.identify.quality.require_usable`, `require_lag`), does not tell a parameter, or no
        servo of this kind does what it shows.
    """
    trace = unwrapped(trace, place)
    require_usable(trace, place)
    trace = geared(trace, place)
    require_lag(trace, place)
    counts = count_of(trace.command), count_of(trace.actual)
    asked = beyond or {}
    fit = replace(
        TraceFit.of(trace, counts[0]),
        told={name: value for name, value in asked.items() if value is not None},
        sought=tuple(name for name in BEYOND if name in asked and asked[name] is None),
    )
    early = replace(fit, level=True).lag  # whatever the zeros are
    if early < -_FAR_AHEAD and _alike(fit, early):  # what the zeros may have added is told only where it agrees
        raise InputError(f"{place}: {_ahead(fit.lag if 3.0 * early < fit.lag < 0.3 * early else early)}")
    fit = with_level(fit, velocity_feedforward)
    origin: Origin = "given"
    if velocity_feedforward is None:
        solution, origin = _choose(fit, counts)
    else:
        solution = with_clock(fit, fit.solve(velocity_feedforward))
    solution = _widened(fit, solution, counts)
    share = 1.0 - math.sqrt(solution.cost / float(np.sum((fit.actual - fit.actual.mean()) ** 2)))
    faults = list(_faults(solution, share, fit.lag))
    if faults:
        raise InputError(*(f"{place}: {fault}" for fault in faults))
    values = solution.values
    return Identified(
        servo=Servo(
            **{
                **values,
                "dead_time": max(0.0, values["dead_time"]),
                "velocity_feedforward": min(max(0.0, values["velocity_feedforward"]), 1.0),
                **{name: max(0.0, values[name]) for name in BEYOND if name in values},
            }
        ),
        confidence={name: _holding(name, solution.bounds[name]) for name in solution.names},
        feedforward_from=origin,
        fit=share,
        residual=math.sqrt(solution.cost / len(fit.times)),
        rows=len(fit.times),
        notes=(*trace.notes, *_level_note(fit, solution, trace)),
    )


def _level_note(fit: TraceFit, solution: Minimum, trace: Trace) -> tuple[str, ...]:
    """Say what the zeros of command and actual position differ by."""
    if not fit.level:
        return ()
    servo = Servo(**solution.values)
    apart = float(np.mean(fit.actual - fit.mean(servo)))
    shown, unit = (apart * 1e3, "mm") if trace.unit == "m" else (math.degrees(apart), "deg")
    return (f"the actual position has another zero than the command: {shown:.6g} {unit} were taken off",)


def _choose(fit: TraceFit, counts: tuple[float, float]) -> tuple[Minimum, Origin]:
    """Fit the velocity feed-forward too, or take it as 0 or 1 where this is about as good, or within its confidence."""
    from scipy.optimize import minimize_scalar

    whole = min((fit.solve(alpha) for alpha in (0.0, 1.0)), key=lambda each: each.cost)
    names, free = whole.names, (*whole.names, "velocity_feedforward")
    assumed = with_clock(fit, whole)
    if assumed.clock is not None:
        freed = fit.minimum(assumed.values, free, assumed.clock, ROUNDS)
        if _about_as_good(fit, assumed, freed):
            return assumed, "assumed"
    tried = [whole]

    def cost(alpha: float) -> float:
        near = min(tried, key=lambda each: abs(each.values["velocity_feedforward"] - alpha))
        tried.append(fit.minimum({**near.values, "velocity_feedforward": alpha}, names, None, ROUNDS))
        return tried[-1].cost

    alpha = whole.values["velocity_feedforward"]
    minimize_scalar(cost, bracket=(alpha, alpha + (0.02 if alpha == 0.0 else -0.02)), options={"xtol": 1e-4})
    best = min(tried, key=lambda each: each.cost)
    if assumed.clock is None and _about_as_good(fit, whole, best):
        return assumed, "assumed"
    freed = with_clock(fit, fit.minimum(best.values, free, None, ROUNDS))
    low, high = _widened(fit, freed, counts).bounds["velocity_feedforward"]
    return (assumed, "assumed") if low <= alpha <= high else (freed, "trace")


def _widened(fit: TraceFit, found: Minimum, counts: tuple[float, float]) -> Minimum:
    """Widen the confidence by what is not white noise: rounding as it may have been, or the noise as it is seen, the greater."""
    rounded, coloured = with_rounding(fit, found, *counts), with_colour(fit, found)
    factors = {
        name: max(each.errors[name] for each in (rounded, coloured)) / found.errors[name] for name in found.names
    }
    return found.widened(factors)


def _about_as_good(fit: TraceFit, simple: Minimum, free: Minimum) -> bool:
    """Whether a fit of one parameter less is not significantly worse."""
    noise = free.cost / len(fit.times)
    return simple.cost - free.cost <= CONFIDENCE**2 * (noise + fit.doubt(free))


def _alike(fit: TraceFit, lag: float) -> bool:
    """Whether the actual position is the command at another time, whatever the zeros are."""
    off = fit.actual - fit.command(fit.times - lag)
    return bool(np.std(off) < (1.0 - _WORST_FIT) * np.std(fit.actual))


def _holding(name: str, bounds: tuple[float, float]) -> tuple[float, float]:
    """Make an interval hold what is told: a dead time is none where the fit has it a little below 0."""
    low, high = bounds
    return (low, max(high, 0.0)) if name == "dead_time" else bounds


def _ahead(lag: float) -> str:
    return (
        f"the actual position runs ahead of the command by {-1e3 * lag:.3g} ms on average: command and actual are swapped, or the "
        "controller leads; give them in their own columns, and switch a lead off for the recording"
    )


def _faults(solution: Minimum, fit: float, lag: float) -> Iterator[str]:
    """Say what the trace does not tell, or tells of no servo of this kind."""
    if not fit > _WORST_FIT:
        yield (
            f"no servo of this kind does what the trace shows: the best leaves {100 * (1 - fit):.3g} % of the motion over; check the "
            "units and the columns, and that it is one axis in position control"
        )
        return
    if lag < -_AHEAD:
        yield _ahead(lag)
        return
    for name in solution.names:
        yield from _untold(solution, name)


def _untold(solution: Minimum, name: str) -> Iterator[str]:
    """Say what the trace does not tell of a parameter."""
    values = solution.values
    factor, unit = _UNITS[name]
    words, value, (least, most) = name.replace("_", " "), values[name], solution.bounds[name]
    spread = 0.5 * (most - least)
    low, high = RANGES[name]
    about = f"{value * factor:.4g}{unit}, give or take {spread * factor:.2g}{unit} (95 %)"
    if spread > high - low:
        about = f"it may be anything from {low * factor:.4g} to {high * factor:.4g}{unit}"
    known = max(value, values["sample_time"]) if name == "dead_time" else abs(value)
    if name == "dead_time" and most < -_ROUNDED:
        yield (
            f"the actual position runs ahead of the command: {words} {about}; switch the controller's lead off for the recording, and "
            "give command and actual in their own columns"
        )
    elif name == "velocity_feedforward" and least > 1.0:
        yield f"{words} {about}: above 1, the axis would run ahead; give the share that is set in the drive, --velocity-feedforward"
    elif not low + 1e-6 * abs(low) < value < high - 1e-6 * abs(high):
        yield f"{words} {value * factor:.4g}{unit}: the end of the range that is searched; {_LIVELIER}"
    elif 2 * spread > known and name != "velocity_feedforward" and name not in BEYOND:
        yield (
            f"the trace does not tell the {words}: {about}; {_LIVELIER}"
            + "".join(f", or give --{each.replace('_', '-')}" for each in BEYOND if each in solution.names)
            + (", or give --velocity-feedforward" if "velocity_feedforward" in solution.names else "")
        )
