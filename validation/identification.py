"""The servo's parameters from a recorded trace: least squares between what the sampled servo does and what was measured."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from profiles.errors import InputError
from profiles.polynomial import FloatArray
from profiles.servo import Servo, spectral_radius
from validation.sampled_axis import ComplexArray, axis_response, decays, mean_response
from validation.trace import Trace, noise_of, require_usable

Origin = Literal["trace", "assumed", "given"]
"""Where the velocity feed-forward comes from."""

RANGES: dict[str, tuple[float, float]] = {
    "bandwidth": (10.0, 3000.0),
    "damping": (0.1, 3.0),
    "position_gain": (0.5, 1000.0),
    "sample_time": (1e-4, 2e-2),
    "dead_time": (-0.02, 0.05),
    "velocity_feedforward": (-0.1, 1.2),
}
"""Ranges that are searched, in SI units. A negative dead time is found where the controller leads, and refused."""

_UNITS = {
    "bandwidth": (1.0, " rad/s"),
    "damping": (1.0, ""),
    "position_gain": (1.0, " 1/s"),
    "sample_time": (1e3, " ms"),
    "dead_time": (1e3, " ms"),
    "velocity_feedforward": (1.0, ""),
}
_LOGARITHMIC = frozenset({"bandwidth", "damping", "position_gain", "sample_time"})

_RUN_IN = 0.06
"""Beginning of the trace that is not judged (s): the greatest dead time and some samples, whose commands must be known."""

_START_TIMES = (0.0015, 0.005)
"""Sample times from which the search starts (s)."""

_START_GAINS = (12.0, 35.0)
_COARSE_ROUNDS, _ROUNDS = 10, 40

_CONFIDENCE = 1.96
"""Standard deviations to both sides that hold 95 %."""

_SEEN = 40.0
"""Gain of the fit from which on the sampling clock counts as seen: squared residual over squared noise. The best of the thousands of
teeth that are tried gains about 20 where there is nothing to see."""

_CLOCKS = 4
"""Sampling phases tried, and parts of a sample by which the clock may be off at the end of the trace between two sample times tried."""

_MOST_TRIALS = 2000
_SEARCH_ROWS = 600
_BEST_TEETH = 4
_REACHES = (0.01, 0.1)
"""Parts of the sample time by which the fit without clock may be off: little, and where the clock is seen plainly, which that fit takes
for the axis' own, much."""

_WHITE = 1.3
"""Squared residual over the squared noise of the rows up to which nothing else is looked for."""

_WORST_FIT = 0.5
_LIVELIER = "record a livelier motion, e.g. a sweep up to the bandwidth of the axis, or a longer one"
_UNSTABLE = 1e3


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
    """

    servo: Servo
    confidence: dict[str, tuple[float, float]]
    feedforward_from: Origin
    fit: float
    residual: float
    rows: int


def identify(trace: Trace, place: str, velocity_feedforward: float | None = None) -> Identified:
    """Find the servo that makes of the recorded command what was recorded of the axis.

    The axis' state at the beginning is not known and fitted too (three numbers, linear). The sampling clock's phase is not known either:
    where the trace shows it, it is fitted; where it does not, the model is the mean over all phases.

    The velocity feed-forward is a number that was set; the trace often tells it from the sample time only poorly. Unless given it is
    fitted, and taken as 1 or as 0 where the fit does not contradict this.

    Parameters
    ----------
    trace
        The trace.
    place
        What messages begin with.
    velocity_feedforward
        Share of the command's velocity that is fed forward, if known.

    Raises
    ------
    InputError
        The trace cannot be used (`validation.trace.require_usable`), does not tell a parameter, or no servo of this kind does what it
        shows.
    """
    require_usable(trace, place)
    problem = _Problem.of(trace)
    origin: Origin = "given"
    if velocity_feedforward is None:
        solution, origin = problem.choose()
    else:
        solution = problem.with_clock(problem.solve(velocity_feedforward))
    solution = problem.with_doubt(solution)
    fit = 1.0 - math.sqrt(solution.cost / float(np.sum((problem.actual - problem.actual.mean()) ** 2)))
    faults = list(_faults(solution, fit))
    if faults:
        raise InputError(*(f"{place}: {fault}" for fault in faults))
    values, spread = solution.values, solution.spreads
    confidence = {name: (values[name] - spread[name], values[name] + spread[name]) for name in solution.names}
    return Identified(
        servo=Servo(
            **{
                **values,
                "dead_time": max(0.0, values["dead_time"]),
                "velocity_feedforward": min(max(0.0, values["velocity_feedforward"]), 1.0),
            }
        ),
        confidence=confidence,
        feedforward_from=origin,
        fit=fit,
        residual=math.sqrt(solution.cost / len(problem.times)),
        rows=len(problem.times),
    )


@dataclass(frozen=True, eq=False)
class _Solution:
    """A minimum: all parameters by name, those fitted, and how well they are known.

    ``clock`` is the sampling phase as a part of the sample time, nothing where it is not fitted; ``spreads`` are half the widths of the
    95 % confidence.
    """

    values: dict[str, float]
    names: tuple[str, ...]
    clock: float | None
    cost: float
    spreads: dict[str, float]


@dataclass(frozen=True, eq=False)
class _Problem:
    """A trace's fit.

    Parameters
    ----------
    times, actual
        Rows that are judged.
    command
        The command between the rows.
    line
        The straight line from the first command to the last: where it begins (unit of the trace) and its velocity.
    spectrum
        What the command is beyond that line, bent back smoothly to where it began, by frequency.
    rates
        These frequencies (rad/s).
    rows
        Numbers of the rows that are judged.
    step
        Time between two rows of the trace (s).
    noise
        Noise of the actual position (rms).
    """

    times: FloatArray
    actual: FloatArray
    command: Callable[[FloatArray], FloatArray]
    line: tuple[float, float]
    spectrum: ComplexArray
    rates: FloatArray
    rows: NDArray[np.intp]
    step: float
    noise: float

    @classmethod
    def of(cls, trace: Trace) -> _Problem:
        from scipy.fft import next_fast_len, rfft
        from scipy.interpolate import CubicSpline

        times, rows = trace.times, len(trace.command)
        curve = CubicSpline(times, trace.command)
        first = math.ceil(_RUN_IN / trace.step)
        begin, velocity = float(trace.command[0]), float(trace.command[-1] - trace.command[0]) / (times[-1] - times[0])
        beyond = trace.command - begin - velocity * (times - times[0])
        whole = 2 * next_fast_len(math.ceil(0.625 * rows), real=True)
        part = np.arange(1, whole - rows + 1) / (
            whole - rows + 1
        )  # a cubic from the last command's velocity to the first's
        width = trace.step * (whole - rows + 1)
        leaving, coming = (float(curve(times[row], 1)) - velocity for row in (-1, 0))
        back = width * part * (1.0 - part) * (leaving * (1.0 - part) - coming * part)
        rates = 2.0 * math.pi * np.arange(whole // 2 + 1) / (whole * trace.step)

        def command(at: FloatArray) -> FloatArray:
            return np.asarray(curve(np.clip(at, times[0], times[-1])))

        spectrum = np.asarray(rfft(np.concatenate([beyond, back])))
        judged = np.arange(first, rows)
        return cls(
            times[judged],
            trace.actual[judged],
            command,
            (begin, velocity),
            spectrum,
            rates,
            judged,
            trace.step,
            noise_of(trace.actual),
        )

    @property
    def lag(self) -> float:
        """Time by which the actual position runs after the command, on average over the rows (s)."""
        ahead = 1e-3
        command = self.command(self.times)
        velocity = (command - self.command(self.times - ahead)) / ahead
        return float(velocity @ (command - self.actual) / (velocity @ velocity))

    def residual(self, values: dict[str, float], clock: float | None) -> FloatArray:
        """Take the model and its best beginning off the actual position; without clock the model is the mean over all phases.

        A servo that is unstable leaves far more than any other, so that the search turns back.
        """
        servo = Servo(**values)
        if not spectral_radius(servo) < 1.0:
            return np.full(len(self.times), _UNSTABLE * float(np.ptp(self.actual)))
        if clock is None:
            position, free = self.mean(servo), decays(servo, self.times)
        else:
            position, free = axis_response(
                servo, float(self.times[0]) + clock * servo.sample_time, self.command, self.times
            )
        return _without(self.actual - position, free)

    def mean(self, servo: Servo) -> FloatArray:
        """Position at the rows, mean over all phases of the sampling clock."""
        from scipy.fft import irfft

        begin, velocity = self.line
        found = irfft(self.spectrum * mean_response(servo, self.rates), 2 * (len(self.rates) - 1))
        late = servo.delay + (1.0 - servo.velocity_feedforward) / servo.position_gain
        return np.asarray(found[self.rows] + begin + velocity * (self.step * self.rows - late))

    def choose(self) -> tuple[_Solution, Origin]:
        """Fit the velocity feed-forward too, or take it as 0 or 1 where this is about as good."""
        from scipy.optimize import minimize_scalar

        whole = min((self.solve(alpha) for alpha in (0.0, 1.0)), key=lambda each: each.cost)
        names, free = whole.names, (*whole.names, "velocity_feedforward")
        assumed = self.with_clock(whole)
        if assumed.clock is not None:
            freed = self.minimum(assumed.values, free, assumed.clock, _ROUNDS)
            if self.about_as_good(assumed, freed):
                return assumed, "assumed"
        tried = [whole]

        def cost(alpha: float) -> float:
            near = min(tried, key=lambda each: abs(each.values["velocity_feedforward"] - alpha))
            tried.append(self.minimum({**near.values, "velocity_feedforward": alpha}, names, None, _ROUNDS))
            return tried[-1].cost

        alpha = whole.values["velocity_feedforward"]
        minimize_scalar(cost, bracket=(alpha, alpha + (0.02 if alpha == 0.0 else -0.02)), options={"xtol": 1e-4})
        best = min(tried, key=lambda each: each.cost)
        if assumed.clock is None and self.about_as_good(whole, best):
            return whole, "assumed"
        return self.with_clock(self.minimum(best.values, free, None, _ROUNDS)), "trace"

    def about_as_good(self, simple: _Solution, free: _Solution) -> bool:
        """Whether a fit of one parameter less is not significantly worse."""
        noise = free.cost / len(self.times)
        return simple.cost - free.cost <= _CONFIDENCE**2 * (noise + self.doubt(free))

    def doubt(self, found: _Solution) -> float:
        """Squared residual that the command between the rows may account for, which nobody knows: large where it has corners.

        A spline through every second row misses the others; one through all rows misses a fourth of that, at a corner.
        """
        from scipy.fft import irfft, rfft
        from scipy.interpolate import CubicSpline

        rows = len(self.times)
        every = self.command(self.times)
        missed = every - CubicSpline(self.times[::2], every[::2])(self.times)
        rates = 2.0 * math.pi / (rows * self.step) * np.arange(rows // 2 + 1, dtype=np.float64)
        effect = np.asarray(irfft(rfft(missed) * mean_response(Servo(**found.values), rates), rows))
        return float(np.sum((effect / 4.0) ** 2))

    def with_doubt(self, found: _Solution) -> _Solution:
        """Widen the confidence by what the command between the rows may do."""
        wider = math.sqrt(1.0 + self.doubt(found) * len(self.times) / found.cost)
        return replace(found, spreads={name: wider * spread for name, spread in found.spreads.items()})

    def solve(self, alpha: float) -> _Solution:
        """Fit all parameters but the velocity feed-forward and the clock, from many starts."""
        names = tuple(name for name in RANGES if name != "velocity_feedforward")
        lag, found = self.lag, []
        for step in _START_TIMES:
            for gain in _START_GAINS:
                start = {
                    "bandwidth": 110.0,
                    "damping": 0.8,
                    "position_gain": gain,
                    "sample_time": step,
                    "dead_time": min(max(lag - step - (1.0 - alpha) / gain, 0.0), 0.04),
                    "velocity_feedforward": alpha,
                }
                found.append(self.minimum(start, names, None, _COARSE_ROUNDS))
        found.sort(key=lambda each: each.cost)
        return min((self.minimum(each.values, names, None, _ROUNDS) for each in found[:2]), key=lambda each: each.cost)

    def thinned(self) -> _Problem:
        """Give the problem with no more rows than a search needs."""
        every = slice(None, None, max(1, len(self.times) // _SEARCH_ROWS))
        return replace(self, times=self.times[every], actual=self.actual[every], rows=self.rows[every])

    def with_clock(self, found: _Solution) -> _Solution:
        """Fit the clock too where the trace shows it."""
        mean = self.residual(found.values, None)
        noise = found.cost / len(self.times)
        if float(np.sum((self.residual(found.values, 0.0) - mean) ** 2)) < _SEEN * noise:
            return found
        for reach in _REACHES:
            best, lead = self.comb(found, reach)
            if best.cost <= _WHITE * len(self.times) * self.noise**2:
                break
        noise = best.cost / len(self.times)
        seen = found.cost - best.cost > _SEEN * noise and lead > _CONFIDENCE**2 * (noise + self.doubt(best))
        return best if seen else found

    def comb(self, found: _Solution, reach: float) -> tuple[_Solution, float]:
        """Fit the clock, the sample time scanned so finely that no tooth of its comb is missed.

        Parameters
        ----------
        found
            The fit without clock.
        reach
            Part of the sample time by which it may be off.

        Returns
        -------
        (best, lead)
            The best fit, and by how much the best at another tooth is worse.
        """
        step, lasts = found.values["sample_time"], float(self.times[-1] - self.times[0])
        tooth = step * step / (_CLOCKS * lasts)
        teeth = min(math.ceil(reach * step / tooth), _MOST_TRIALS // (2 * _CLOCKS))
        names = tuple(name for name in found.names if name != "sample_time")
        thin = self.thinned()
        others = thin.slopes(found.values, names, None)
        along = np.linalg.lstsq(others, -thin.slopes(found.values, ("sample_time",), None)[:, 0])[0]
        trials = []
        for number in range(-teeth, teeth + 1):
            values = {**found.values, "sample_time": step + number * tooth}
            by = math.log(values["sample_time"] / step)  # the others go along with the sample time
            values |= {
                name: _moved(name, values[name], by * float(way)) for name, way in zip(names, along, strict=True)
            }
            for part in range(_CLOCKS):
                left = _without(thin.residual(values, part / _CLOCKS), others.T)
                trials.append((float(left @ left), number, part / _CLOCKS, values))
        trials.sort(key=lambda trial: trial[0])
        chosen: list[tuple[float, int, float, dict[str, float]]] = []
        for trial in trials:
            if all(abs(trial[1] - other[1]) > _CLOCKS for other in chosen):  # teeth of its comb, each once
                chosen.append(trial)
            if len(chosen) == _BEST_TEETH:
                break
        fits = [self.minimum(values, found.names, clock, _ROUNDS) for _, _, clock, values in chosen]
        best, *others_best = sorted(fits, key=lambda each: each.cost)
        return best, min((other.cost for other in others_best), default=math.inf) - best.cost

    def slopes(self, values: dict[str, float], names: tuple[str, ...], clock: float | None) -> FloatArray:
        """Take derivatives of the residual by parameters (log of those above zero) and, last, the clock; central differences."""
        columns = []
        for name in (*names, *(("clock",) if clock is not None else ())):
            step = _difference(name)
            sides = []
            for side in (step, -step):
                if name == "clock":
                    sides.append(self.residual(values, (clock or 0.0) + side))
                else:
                    sides.append(self.residual({**values, name: _moved(name, values[name], side)}, clock))
            columns.append((sides[0] - sides[1]) / (2.0 * step))
        return np.stack(columns, axis=1)

    def minimum(self, start: dict[str, float], names: tuple[str, ...], clock: float | None, rounds: int) -> _Solution:
        """Least squares over some parameters, and the clock if one is given, from a start; ranges are kept."""
        from scipy.optimize import least_squares

        low, high = (np.array([_coordinate(name, RANGES[name][end]) for name in names]) for end in (0, 1))
        begin = np.array([_coordinate(name, start[name]) for name in names])
        if clock is not None:
            low, high, begin = np.append(low, clock - 2.0), np.append(high, clock + 2.0), np.append(begin, clock)

        def read(point: FloatArray) -> tuple[dict[str, float], float | None]:
            values = {name: _value(name, float(x)) for name, x in zip(names, point, strict=False)}
            return {**start, **values}, None if clock is None else float(point[-1])

        def left(point: FloatArray) -> FloatArray:
            values, phase = read(point)
            return self.residual(values, phase)

        def slopes(point: FloatArray) -> FloatArray:
            values, phase = read(point)
            return self.slopes(values, names, phase)

        edge = 1e-9 * (high - low)
        begin = np.clip(begin, low + edge, high - edge)
        size = float(np.abs(self.actual).max()) or 1.0
        found = least_squares(
            lambda point: left(point) / size,
            begin,
            jac=lambda point: slopes(point) / size,
            bounds=(low, high),
            x_scale="jac",
            max_nfev=rounds,
            ftol=1e-9,
            xtol=1e-9,
            gtol=1e-15,
        )
        values, phase = read(found.x)
        jacobian = found.jac * size
        rows, width = jacobian.shape
        scale = np.sqrt((jacobian**2).sum(axis=0))
        cost = 2.0 * found.cost * size * size
        inverse = np.linalg.pinv((jacobian / scale).T @ (jacobian / scale))
        spread = _CONFIDENCE * np.sqrt(np.diag(inverse) * cost / (rows - width - 3)) / scale
        spreads = {
            name: float(each) * (values[name] if name in _LOGARITHMIC else 1.0)
            for name, each in zip(names, spread, strict=False)
        }
        return _Solution(values, names, phase, cost, spreads)


def _without(signal: FloatArray, rows: FloatArray) -> FloatArray:
    """Take off a signal what some rows can make of it, by Gram and Schmidt, each twice."""
    basis: list[FloatArray] = []
    for row in rows:
        direction = row
        for _ in range(2):
            for other in basis:
                direction = direction - float(other @ direction) * other
        size = math.sqrt(float(direction @ direction))
        if size > 1e-13 * math.sqrt(float(row @ row)):
            basis.append(direction / size)
            signal = signal - float(basis[-1] @ signal) * basis[-1]
    return signal


def _coordinate(name: str, value: float) -> float:
    """Where the search puts a value: the logarithm of what is above zero."""
    return math.log(value) if name in _LOGARITHMIC else value


def _value(name: str, coordinate: float) -> float:
    return math.exp(coordinate) if name in _LOGARITHMIC else coordinate


def _moved(name: str, value: float, by: float) -> float:
    return _value(name, _coordinate(name, value) + by)


def _difference(name: str) -> float:
    """Step of a difference: of a logarithm, of the dead time (s), of a part."""
    return {"dead_time": 1e-6, "clock": 1e-2}.get(name, 1e-4)


def _faults(solution: _Solution, fit: float) -> Iterator[str]:
    """Say what the trace does not tell, or tells of no servo of this kind."""
    if not fit > _WORST_FIT:
        yield (
            f"no servo of this kind does what the trace shows: the best leaves {100 * (1 - fit):.3g} % of the motion over; check the "
            "units and the columns, and that it is one axis in position control"
        )
        return
    values = solution.values
    for name in solution.names:
        factor, unit = _UNITS[name]
        words, value, spread = name.replace("_", " "), values[name], solution.spreads[name]
        low, high = RANGES[name]
        about = f"{value * factor:.4g}{unit}, give or take {spread * factor:.2g}{unit} (95 %)"
        known = max(value, values["sample_time"]) if name == "dead_time" else abs(value)
        if name == "dead_time" and value + spread < 0.0:
            yield (
                f"the actual position runs ahead of the command: {words} {about}; switch the controller's lead off for the recording, and "
                "give command and actual in their own columns"
            )
        elif name == "velocity_feedforward" and value - spread > 1.0:
            yield f"{words} {about}: above 1, the axis would run ahead; give the share that is set in the drive, --velocity-feedforward"
        elif not low + 1e-6 * abs(low) < value < high - 1e-6 * abs(high):
            yield f"{words} {value * factor:.4g}{unit}: the end of the range that is searched; {_LIVELIER}"
        elif 2 * spread > known and name != "velocity_feedforward":
            yield (
                f"the trace does not tell the {words}: {about}; {_LIVELIER}"
                + (", or give --velocity-feedforward" if "velocity_feedforward" in solution.names else "")
            )
