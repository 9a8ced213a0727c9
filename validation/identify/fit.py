"""Least squares between what a sampled servo does of a recorded command and what was recorded of the axis."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.polynomial.profile import FloatArray
from camwright.profiles.servo import Servo, spectral_radius
from camwright.profiles.trace import Trace
from camwright.validation.identify.quality import noise_of
from camwright.validation.servo.sampled_axis import (
    ComplexArray,
    axis_response,
    decays,
    mean_response,
)

RANGES: dict[str, tuple[float, float]] = {
    "bandwidth": (10.0, 3000.0),
    "damping": (0.1, 3.0),
    "position_gain": (0.5, 1000.0),
    "sample_time": (1e-4, 2e-2),
    "dead_time": (-0.02, 0.05),
    "velocity_feedforward": (-0.1, 1.2),
    "acceleration_feedforward": (-2e-3, 1e-2),
    "jerk_feedforward": (-5e-5, 2e-4),
}
"""Ranges that are searched, in SI units. A negative dead time is found where the controller leads."""

BEYOND = ("acceleration_feedforward", "jerk_feedforward")
"""Feed-forward beyond that of the velocity: fitted only where that is asked for."""

CONFIDENCE = 1.96
"""Standard deviations to both sides that hold 95 %."""

ROUNDS = 40
"""Most steps of a least squares fit."""

_LOGARITHMIC = frozenset({"bandwidth", "damping", "position_gain", "sample_time"})

_FARTHEST = 300.0
"""Greatest logarithm of a value: a bound that nothing is known of is no overflow."""

_UNTOLD = 1e6
"""Standard error of a coordinate that moves nothing: far more than any range, and finite, as it is multiplied and divided."""

_RUN_IN = 0.06
"""Beginning of the trace that is not judged (s): the greatest dead time and some samples, whose commands must be known."""

_START_TIMES = (0.0015, 0.005)
_START_GAINS = (12.0, 35.0)
"""Sample times (s) and position gains (1/s) from which the search starts, each with each."""

_START_SHARES = (0.0, 0.7)
"""Shares of what makes up for the velocity loop from which feed-forward beyond that of the velocity is searched."""

_COARSE_ROUNDS = 10
_BINS = 15
"""Bins of a spectrum over which its size is looked at."""
_SUNK = 3.0
"""How many times the power of rounding a command has that is still seen."""
_NEAR, _OUT, _CORNER = 121, 6.0, 17
"""Rows about each among which a corner of the command stands out, by so many times what is usual there, and rows that are its own."""

_SEARCH_ROWS = 600
_UNSTABLE = 1e3


@dataclass(frozen=True, eq=False)
class Minimum:
    """A minimum.

    Parameters
    ----------
    values
        All parameters by their names in `camwright.profiles.servo.Servo`, in SI units.
    names
        Those that were fitted.
    clock
        Sampling phase as a part of the sample time, nothing where it is not fitted.
    cost
        Squared residual.
    errors
        Standard errors of the coordinates (`moved`), by name.
    bounds
        95 % confidence, by name.
    """

    values: dict[str, float]
    names: tuple[str, ...]
    clock: float | None
    cost: float
    errors: dict[str, float]
    bounds: dict[str, tuple[float, float]]

    def widened(self, factors: dict[str, float]) -> Minimum:
        """Make the confidence of each parameter wider on both sides."""
        bounds = {}
        for name, (low, high) in self.bounds.items():
            factor = factors[name]
            at, below, above = (coordinate(name, value) for value in (self.values[name], low, high))
            bounds[name] = (value_at(name, at + factor * (below - at)), value_at(name, at + factor * (above - at)))
        return replace(self, errors={name: factors[name] * each for name, each in self.errors.items()}, bounds=bounds)


@dataclass(frozen=True, eq=False)
class TraceFit:
    """A trace as least squares of the servo's parameters.

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
    level
        Whether a constant between command and actual position is fitted too: zeros that differ.
    told
        Feed-forward beyond that of the velocity by name, where it is known to be set.
    sought
        Names of that which is fitted.
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
    level: bool = False
    told: dict[str, float] = field(default_factory=dict)
    sought: tuple[str, ...] = ()

    @classmethod
    def of(cls, trace: Trace, count: float = 0.0) -> TraceFit:
        """Prepare a trace, whose command was rounded to a count; what rounding made of it was not asked of the axis, and is taken off."""
        from scipy.fft import irfft, next_fast_len, rfft
        from scipy.interpolate import CubicSpline

        times, rows = trace.times, len(trace.command)
        curve = CubicSpline(times, trace.command)
        first = math.ceil(_RUN_IN / trace.step)
        begin, velocity = float(trace.command[0]), float(trace.command[-1] - trace.command[0]) / (times[-1] - times[0])
        beyond = trace.command - begin - velocity * (times - times[0])
        whole = 2 * next_fast_len(math.ceil(0.625 * rows), real=True)
        # back by a cubic, from the last command's velocity to the first's
        part, width = np.arange(1, whole - rows + 1) / (whole - rows + 1), trace.step * (whole - rows + 1)
        leaving, coming = (float(curve(times[row], 1)) - velocity for row in (-1, 0))
        back = width * part * (1.0 - part) * (leaving * (1.0 - part) - coming * part)
        rates = 2.0 * math.pi * np.arange(whole // 2 + 1) / (whole * trace.step)
        spectrum = np.asarray(rfft(np.concatenate([beyond, back])))
        if count:
            spectrum = _above_rounding(spectrum, rows * count**2 / 12.0)
            smooth = np.asarray(irfft(spectrum, whole))[:rows]
            curve = CubicSpline(times, smooth + begin + velocity * (times - times[0]))

        def command(at: FloatArray) -> FloatArray:
            return np.asarray(curve(np.clip(at, times[0], times[-1])))

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
        behind = command - self.actual
        if self.level:
            behind, velocity = behind - behind.mean(), velocity - velocity.mean()
        return float(velocity @ behind / (velocity @ velocity))

    def residual(self, values: dict[str, float], clock: float | None) -> FloatArray:
        """Take the model and its best beginning off the actual position; without clock the model is the mean over all phases.

        A servo that is unstable leaves far more than any other, so that the search turns back.
        """
        servo = Servo(**values)
        if not spectral_radius(servo) < 1.0:
            return np.full(len(self.times), _UNSTABLE * float(np.ptp(self.actual)))
        if clock is None:
            return without(self.actual - self.mean(servo), self.free(servo))
        position, free = axis_response(
            servo, float(self.times[0]) + clock * servo.sample_time, self.command, self.times
        )
        return without(self.actual - position, np.vstack([free, np.ones(len(self.times))]) if self.level else free)

    def free(self, servo: Servo) -> FloatArray:
        """Give what the beginning, and the level where there is one, can add to the mean position: a row each."""
        rows = decays(servo, self.times)
        return np.vstack([rows, np.ones(len(self.times))]) if self.level else rows

    def mean(self, servo: Servo) -> FloatArray:
        """Position at the rows, mean over all phases of the sampling clock."""
        from scipy.fft import irfft

        begin, velocity = self.line
        found = irfft(self.spectrum * mean_response(servo, self.rates), 2 * (len(self.rates) - 1))
        late = servo.delay + (1.0 - servo.velocity_feedforward) / servo.position_gain
        return np.asarray(found[self.rows] + begin + velocity * (self.step * self.rows - late))

    def filtered(self, servo: Servo, command: FloatArray) -> FloatArray:
        """Say what the axis makes of a command at the judged rows that is nothing before and after them (mean over all phases)."""
        from scipy.fft import irfft, rfft

        rows = len(command)
        rates = 2.0 * math.pi / (rows * self.step) * np.arange(rows // 2 + 1, dtype=np.float64)
        return np.asarray(irfft(rfft(command) * mean_response(servo, rates), rows))

    def doubt(self, found: Minimum) -> float:
        """Squared residual that the command between the rows may account for, which nobody knows: large where it has corners.

        A spline through fewer rows misses the others, and at a corner one through all rows misses in proportion. How much hangs on where
        between its rows the corner lies, so splines through every fourth row are asked, from each of four on: their mean, twice, is what is
        missed at worst. A smooth command is missed far less by all rows; of that every second row tells.
        """
        servo, every = Servo(**found.values), self.command(self.times)
        coarse = [self._missed(every, 4, first) for first in range(4)]
        corners = _peaks(np.sqrt(np.mean(np.square(coarse), axis=0)))
        fine = np.where(corners, 0.0, self._missed(every, 2, 0)) / 4.0
        parts = [self.filtered(servo, np.where(corners, missed, 0.0) / 16.0) for missed in coarse]
        return float(np.sum(self.filtered(servo, fine) ** 2) + 0.5 * np.sum(np.square(parts)))

    def _missed(self, every: FloatArray, step: int, first: int) -> FloatArray:
        """Give what a spline through some rows of the command misses of the rows between them."""
        from scipy.interpolate import CubicSpline

        knots = slice(first, None, step)
        missed = every - CubicSpline(self.times[knots], every[knots])(self.times)
        missed[:step] = missed[-step:] = 0.0  # beyond its ends
        return np.asarray(missed)

    def solve(self, alpha: float) -> Minimum:
        """Fit all parameters but the velocity feed-forward and the clock, from many starts; feed-forward beyond it where it is sought."""
        names = tuple(name for name in RANGES if name != "velocity_feedforward" and name not in BEYOND) + self.sought
        lag, found = self.lag, []
        for step in _START_TIMES:
            for gain in _START_GAINS:
                for share in _START_SHARES if self.sought else (0.0,):
                    full = {
                        "acceleration_feedforward": 1.6 / (110.0 * gain),
                        "jerk_feedforward": 1.0 / (110.0**2 * gain),
                    }
                    start = {
                        "bandwidth": 110.0,
                        "damping": 0.8,
                        "position_gain": gain,
                        "sample_time": step,
                        "dead_time": min(max(lag - step - (1.0 - alpha) / gain, 0.0), 0.04),
                        "velocity_feedforward": alpha,
                        **self.told,
                        **{name: share * full[name] for name in self.sought},
                    }
                    found.append(self.minimum(start, names, None, _COARSE_ROUNDS))
        found.sort(key=lambda each: each.cost)
        return min((self.minimum(each.values, names, None, ROUNDS) for each in found[:2]), key=lambda each: each.cost)

    def thinned(self) -> TraceFit:
        """Give the problem with no more rows than a search needs."""
        every = slice(None, None, max(1, len(self.times) // _SEARCH_ROWS))
        return replace(self, times=self.times[every], actual=self.actual[every], rows=self.rows[every])

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
                    sides.append(self.residual({**values, name: moved(name, values[name], side)}, clock))
            columns.append((sides[0] - sides[1]) / (2.0 * step))
        return np.stack(columns, axis=1)

    def minimum(self, start: dict[str, float], names: tuple[str, ...], clock: float | None, rounds: int) -> Minimum:
        """Least squares over some parameters, and the clock if one is given, from a start; ranges are kept."""
        from scipy.optimize import least_squares

        low, high = (np.array([coordinate(name, RANGES[name][end]) for name in names]) for end in (0, 1))
        begin = np.array([coordinate(name, start[name]) for name in names])
        if clock is not None:
            low, high, begin = np.append(low, clock - 2.0), np.append(high, clock + 2.0), np.append(begin, clock)

        def read(point: FloatArray) -> tuple[dict[str, float], float | None]:
            values = {name: value_at(name, float(x)) for name, x in zip(names, point, strict=False)}
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
        moves = scale > 0.0  # at the end of its range a parameter may move nothing
        cost = 2.0 * found.cost * size * size
        _, singular, directions = np.linalg.svd(jacobian[:, moves] / scale[moves], full_matrices=False)
        singular = np.maximum(
            singular, np.finfo(np.float64).eps * singular[:1]
        )  # what is not told at all is told badly
        variances = ((directions / singular[:, None]) ** 2).sum(axis=0)
        deviations = np.full(width, _UNTOLD)
        deviations[moves] = np.sqrt(variances * cost / (rows - width - 3)) / scale[moves]
        errors = {name: float(each) for name, each in zip(names, deviations, strict=False)}
        bounds = {
            name: (moved(name, values[name], -CONFIDENCE * each), moved(name, values[name], CONFIDENCE * each))
            for name, each in errors.items()
        }
        return Minimum(values, names, phase, cost, errors, bounds)


def _peaks(size: FloatArray) -> NDArray[np.bool_]:
    """Say where a size stands out of its neighbourhood."""
    from scipy.ndimage import median_filter

    near = min(_NEAR, 2 * (len(size) // 2) - 1)
    return np.asarray(np.convolve(size > _OUT * median_filter(size, near), np.ones(_CORNER), mode="same") > 0.5)


def _above_rounding(spectrum: ComplexArray, power: float) -> ComplexArray:
    """Cut a spectrum off where it sinks into rounding, of so much power a bin."""
    size = np.abs(spectrum) ** 2
    around = np.lib.stride_tricks.sliding_window_view(size, min(_BINS, len(size)))
    sunk = np.flatnonzero(np.median(around, axis=1) < _SUNK * power)
    if not len(sunk):
        return spectrum
    end = int(sunk[0]) + _BINS // 2
    return np.where(np.arange(len(spectrum)) < end, spectrum, 0.0)


def without(signal: FloatArray, rows: FloatArray) -> FloatArray:
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


def coordinate(name: str, value: float) -> float:
    """Say where the search puts a value: the logarithm of what is above zero."""
    return math.log(value) if name in _LOGARITHMIC else value


def value_at(name: str, at: float) -> float:
    """Give the value at a place of the search."""
    return math.exp(min(max(at, -_FARTHEST), _FARTHEST)) if name in _LOGARITHMIC else at


def moved(name: str, value: float, by: float) -> float:
    """Move a parameter by a part of itself, or by a number if it may be zero."""
    return value_at(name, coordinate(name, value) + by)


def _difference(name: str) -> float:
    """Step of a difference: of a logarithm, of the dead time (s), of feed-forward (s², s³), of a part."""
    steps = {"dead_time": 1e-6, "clock": 1e-2, "acceleration_feedforward": 1e-7, "jerk_feedforward": 1e-9}
    return steps.get(name, 1e-4)
