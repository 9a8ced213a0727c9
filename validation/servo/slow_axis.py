"""`SlowAxis`: the axis on a slow line, in closed form, at the samples where something can be told apart.

On a piece of the cam the command is a polynomial. What the servo makes of it is a polynomial too, and what is left of the breaks before,
which dies with the powers of the closed loop's matrix. So any sample can be computed alone, and a cycle of a hundred million samples costs
what its breaks cost. Samples stand close where the transients are quick, wide apart where nothing but a polynomial is left, and are added
(`decided`) until those that decide a measure are neighbours as in a whole simulation.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.servo import Servo, closed_loop, spectral_radius
from camwright.validation.servo.lifting import SUBSTEPS, lift_side_by_side, loops_of
from camwright.validation.servo.periodic import straightened

Samples = NDArray[np.int64]
"""Numbers of samples, ascending."""

_Found = TypeVar("_Found")

_SHARE = 0.5
"""Distance of samples in a transient, as a share of the time in which its quickest part falls to 1/e or turns by 1 rad."""

_GONE = 1e-15
"""A transient that is smaller than this share of its beginning is gone."""

_SMOOTH, _ADDED = 32, 8
"""Samples on a piece beside its transient, and samples that are added evenly in a gap."""

_MOST_KEPT = 2**11
"""Samples of the first round, beside the least that every piece needs."""

_ROUNDS = 16
"""Most rounds in which samples are added; a gap of a hundred million samples is closed in six."""

_HUMPS = 6
"""Humps that are looked at more closely in each round."""

_ROUNDING = 1e-13
"""Share of the greatest size by which sizes differ that are the same."""

_MOST_GROWTH = 10.0
"""What the steady state's terms may be, as a multiple of the slave's travel: what they lose in digits."""

_EDGE = 3
"""Samples that are kept on either side of a place that is asked for."""

_AWAY = np.array([*range(1, _EDGE), *(_EDGE << power for power in range(48))], dtype=np.int64)
_TOWARDS: Samples = np.concatenate([-_AWAY[::-1], [0], _AWAY])
"""Samples about a place where something is decided, each twice as far from it as the one before."""


@dataclass(frozen=True, eq=False)
class SlowAxis:
    """One servo's axis in a part of the cycle, at any of its samples.

    Sample ``k`` of phase ``j`` lies ``(j / phases - 1 + k)`` samples after the start of the return zone, like those of a whole simulation.

    Parameters
    ----------
    profile
        One cycle over the master period.
    servo
        A stable servo.
    line_speed
        Line speed (m/s).
    origin
        Start of the return zone (m).
    shift
        How far behind on the master the command lies that the loop sees (m).
    behind
        Constant error with which the axis follows the profile's mean straight line (slave unit).
    first, last
        First and last sample of the part.
    phases
        Sampling phases.
    past
        Samples that the servo remembers.
    orders
        Derivatives of the axis that are asked for.
    places
        Master positions about which samples are kept at once: ends of zones.
    """

    profile: CamProfile
    servo: Servo
    line_speed: float
    origin: float
    shift: float
    behind: float
    first: int
    last: int
    phases: int
    past: int
    orders: tuple[int, ...]
    places: tuple[float, ...]

    @property
    def sample(self) -> float:
        """Master travel of a sample (m)."""
        return self.line_speed * self.servo.sample_time

    @cached_property
    def _zero(self) -> FloatArray:
        """Master position of sample 0 at every phase (m), shape ``(phases, 1)``."""
        at = (np.arange(self.phases) / self.phases - 1.0) * self.sample
        return np.asarray(self.origin + at[:, None])

    @cached_property
    def _table(self) -> FloatArray:
        """The pieces that are seen, one after another: `straightened`, shape ``(powers + 1, pieces)``."""
        table, length = straightened(self.profile), self.profile.length
        ends = self.origin - self.shift + self.sample * np.array([self.first - self.past - 3.0, self.last + 3.0])
        first, last = (math.floor((x - self.profile.start) / length) for x in ends.tolist())
        whole = np.tile(table, last + 1 - first)
        whole[-1] += np.repeat(np.arange(first, last + 1) * length, self.profile.pieces)
        return whole

    @cached_property
    def _begins(self) -> Samples:
        """First sample in each piece, at every phase: shape ``(phases, pieces)``."""
        found: Samples = np.ceil((self._table[-1] - (self._zero - self.shift)) / self.sample).astype(np.int64)
        return found

    @cached_property
    def _steady(self) -> FloatArray:
        """What the loop's state is on a piece once transients are gone, as a polynomial in the master: ``(powers, 3, pieces)``."""
        return self._weighted(self._table[:-1], _weights(self.servo, len(self._table) - 1))

    def _weighted(self, coefficients: FloatArray, weights: FloatArray) -> FloatArray:
        """Polynomials made of weighted Taylor coefficients of polynomials."""
        found = np.zeros((len(coefficients), 3, coefficients.shape[1]))
        for power in range(len(coefficients)):
            for more, weight in enumerate(weights[: len(coefficients) - power]):
                row = math.comb(power + more, more) * self.sample**more * coefficients[power + more]
                found[power] += weight[:, None] * row
        return found

    @property
    def tells(self) -> bool:
        """Whether the closed form is exact: where a servo is far slower than the motion it is a difference of large numbers."""
        command = np.abs(self._table[:-1, : self.profile.pieces])
        powers = np.diff(self.profile.breaks) ** np.arange(len(command))[:, None]
        slow, quick = self.servo.position_gain, self.servo.bandwidth
        terms = self._weighted(command, np.abs(_weights(self.servo, len(command)))) / [
            [quick * slow],
            [slow],
            [1.0],
        ]  # (m)
        size = max(float((command * powers).sum(axis=0).max()), abs(self.profile.advance))
        return bool((terms.sum(axis=1) * powers).sum(axis=0).max() <= _MOST_GROWTH * size)

    def _at(self, polynomials: FloatArray, samples: Samples, pieces: Samples) -> FloatArray:
        """Polynomials of pieces at samples, both of shape ``(phases, n)``."""
        local = self._zero - self.shift + samples * self.sample - self._table[-1][pieces]
        found = polynomials[-1][..., pieces]
        for coefficient in polynomials[-2::-1]:
            found = found * local + coefficient[..., pieces]
        return np.asarray(found)

    def _input(self, samples: Samples) -> FloatArray:
        """Input of the closed loop: ``K c[k] + alpha (c[k] - c[k-1]) / dT``; shape ``(phases, n)``."""
        lead = self.servo.velocity_feedforward / self.servo.sample_time
        now, before = (self._at(self._table[:-1], at, _pieces(self._begins, at)) for at in (samples, samples - 1))
        return (self.servo.position_gain + lead) * now - lead * before

    @cached_property
    def _transients(self) -> FloatArray:
        """State less the steady one, a sample after the first of each piece: shape ``(phases, 3, pieces)``."""
        begins, count = self._begins, self._begins.shape[1]
        pieces = np.broadcast_to(np.arange(count), begins.shape)
        loop, column = closed_loop(self.servo)[0], _input_column(self.servo)
        steady = self._at(self._steady, begins + 1, pieces).transpose(1, 0, 2)
        before = self._at(self._steady, begins[:, 1:], pieces[:, :-1]).transpose(1, 0, 2)
        forced = column[:, None] * self._input(begins)[:, None, :]
        between = begins[:, 1:] - begins[:, :-1] - 1
        powers = _powers(self.servo, np.maximum(between, 0), self.past)
        found = np.zeros((self.phases, 3, count))
        state = steady[:, :, 0].copy()  # remembered by no sample of the part
        for piece in range(1, count):
            left = np.einsum("pij,pj->pi", powers[:, piece - 1], found[:, :, piece - 1])
            after = (before[:, :, piece - 1] + left) @ loop.T + forced[:, :, piece]
            state = np.where(between[:, piece - 1, None] < 0, state, after)  # a piece between two samples
            found[:, :, piece] = state - steady[:, :, piece]
        return found

    def samples(self) -> Samples:
        """Choose the samples of the first round: closest after the breaks that shake the axis most."""
        shaken = np.abs(self._transients[:, 2]) + np.abs(self._transients[:, 1]) / self.servo.position_gain
        order = (-shaken.max(axis=0)).argsort()
        close = _offsets(self.servo, _MOST_KEPT)
        few = _MOST_KEPT // len(close)
        wide = _offsets(self.servo, _MOST_KEPT // len(order))
        after = [
            (self._begins[0, pieces, None] + offsets).ravel()
            for pieces, offsets in ((order[:few], close), (order[few:], wide))
        ]
        begins = np.unique(self._begins[0].clip(self.first - 1, self.last))
        ends = np.append(begins, self.last)
        steps = max(2, min(_SMOOTH, _MOST_KEPT // len(begins)))
        even = ends[:-1, None] + np.arange(steps) * np.diff(ends)[:, None] // steps
        edge = np.arange(-_EDGE, _EDGE + 1)
        asked = np.floor((np.array(self.places) - self.origin) / self.sample).astype(np.int64)[:, None] + 1 + edge
        sides = np.array([self.first, self.last])[:, None] + edge
        kept = np.concatenate([part.ravel() for part in (*after, even, asked, sides)])
        return np.unique(kept[(kept >= self.first) & (kept <= self.last)])

    def finer(self, samples: Samples, places: Iterable[float]) -> Samples:
        """Choose more samples in the gaps about master positions: some evenly, and ever closer ones towards each place."""
        added = []
        for place in places:
            place_sample = math.floor((place - self.origin) / self.sample)
            at = int(samples.searchsorted(place_sample))
            near = samples[max(at - 2, 0) : at + 3]
            about = place_sample + _TOWARDS
            added.append(np.linspace(near[:-1], near[1:], _ADDED + 2).astype(np.int64).ravel())
            added.append(about[(about >= near[0]) & (about <= near[-1])])
        if not added:
            return samples[:0]
        asked = np.unique(np.concatenate(added))
        return np.asarray(asked[samples[samples.searchsorted(asked).clip(max=len(samples) - 1)] != asked])

    def at(self, samples: Samples) -> tuple[FloatArray, FloatArray]:
        """Master positions and, there, the derivatives of the axis over the master that are asked for.

        Returns
        -------
        (master, found)
            Shapes ``(phases, points)`` and ``(orders, phases, points)``: `SUBSTEPS` points a sample.
        """
        rows = np.broadcast_to(samples, (self.phases, len(samples)))
        pieces = _pieces(self._begins + 1, rows)
        known = np.empty((self.phases, len(samples), 4))
        known[..., 0] = self._input(rows)
        known[..., 1:] = self._at(self._steady, rows, pieces).transpose(1, 2, 0)
        since = rows - np.take_along_axis(self._begins, pieces, axis=1) - 1
        phase, live = np.nonzero(since <= self.past)
        powers = _powers(self.servo, since[phase, live], self.past)
        left = self._transients[phase, :, pieces[phase, live]]
        known[phase, live, 1:] += np.einsum("nij,nj->ni", powers, left)
        master = self._zero[:, :, None] + self.sample * (samples[:, None] + np.arange(SUBSTEPS) / SUBSTEPS)
        slope = self.profile.mean_ratio
        zero = float(self.profile.coefficients[0, 0]) - slope * self.profile.start
        found = np.empty((len(self.orders), self.phases, len(samples), SUBSTEPS))
        for order, matrix, values in zip(self.orders, _points(self.servo, self.orders), found, strict=True):
            np.matmul(known, matrix / self.line_speed**order, out=values)
            if order < 2:  # the straight line, which is left out of what is seen
                np.add(values, slope if order else slope * master + (zero - self.behind), out=values)
        return master.reshape(self.phases, -1), found.reshape(len(self.orders), self.phases, -1)


def decided(axis: SlowAxis, measure: Callable[[FloatArray, FloatArray], tuple[_Found, Iterable[float]]]) -> _Found:
    """Measure an axis at more and more samples until those that decide have their neighbours.

    Parameters
    ----------
    measure
        Takes what `SlowAxis.at` gives; gives what is measured, and the master positions (m) that decided it.
    """
    samples = axis.samples()
    known = axis.at(samples)
    found, places = measure(*known)
    for _ in range(_ROUNDS):
        added = axis.finer(samples, places)
        if not len(added):
            break
        all_samples = np.concatenate([samples, added])
        order = all_samples.argsort()
        points = (SUBSTEPS * order[:, None] + np.arange(SUBSTEPS)).ravel()
        master, values = (
            np.concatenate(parts, axis=-1)[..., points] for parts in zip(known, axis.at(added), strict=True)
        )
        samples, known = all_samples[order], (master, values)
        found, places = measure(*known)
    return found


def humps(master: FloatArray, size: FloatArray, noise: float = 0.0) -> list[float]:
    """Find where a size is greatest, at any phase: its greatest value and its highest humps.

    Parameters
    ----------
    master, size
        Points and their size, shape ``(phases, points)``.
    noise
        Differences up to this are rounding.

    Returns
    -------
    list
        Master positions (m), a few: where the parabola through a hump's samples is greatest. Humps that are rounding are left out.
    """
    starts = np.arange(0, size.shape[1], SUBSTEPS)
    by_sample = np.maximum.reduceat(size.max(axis=0), starts)
    floor = max(_ROUNDING * float(np.abs(by_sample).max()), noise)
    padded = np.concatenate([[-np.inf], by_sample, [-np.inf]])
    left, right = by_sample - padded[:-2], by_sample - padded[2:]
    tops = np.nonzero((np.minimum(left, right) >= 0.0) & (np.maximum(left, right) > floor))[0]
    tops = tops[by_sample[tops].argsort()[::-1][:_HUMPS]].tolist()
    # the first of those that are as great: a plateau's own rounding must not lead from place to place
    first = int((by_sample >= by_sample.max() - floor).argmax())
    if max(left[first], right[first]) > floor:
        tops.append(first)
    at = master[0, starts]
    return [_vertex(at, top, float(left[top]), float(right[top])) for top in tops]


def _vertex(at: FloatArray, top: int, left: float, right: float) -> float:
    """Place of the top of the parabola through a highest sample and its neighbours, which are lower by so much."""
    place = float(at[top])
    if not (math.isfinite(left) and math.isfinite(right)) or min(left, right) < 0.0:
        return place
    before, after = place - float(at[top - 1]), float(at[top + 1]) - place
    if min(before, after) <= 0.0:  # the ends of a zone, by which rows are filled up
        return place
    bend = left / before + right / after
    return place + 0.5 * (left * after / before - right * before / after) / bend


def _pieces(begins: Samples, samples: Samples) -> Samples:
    """Piece of each sample: the last that has begun; shapes ``(phases, pieces)`` and ``(phases, n)``."""
    return np.array([row.searchsorted(at, side="right") for row, at in zip(begins, samples, strict=True)]) - 1


def _input_column(servo: Servo) -> FloatArray:
    """Give what the closed loop's input does to the state in a sample, shape ``(3,)``."""
    return loops_of((servo,), 1).held[0, -1, :3, 3]


@lru_cache(maxsize=32)
def _points(servo: Servo, orders: tuple[int, ...]) -> FloatArray:
    """Matrices from input and state at a sample to the quantities after it: shape ``(orders, 4, SUBSTEPS)``."""
    return lift_side_by_side(loops_of((servo,)), 2, orders).points[:, 0]


@lru_cache(maxsize=32)
def _weights(servo: Servo, powers: int) -> FloatArray:
    """Weights of the command's Taylor coefficients (per sample) in the steady state: shape ``(powers, 3)``.

    A shift by one sample takes the coefficients ``g`` to ``g[n] + sum over m > n of C(m, n) g[m]``; the steady state ``sum of g[n] w[n]``
    must go through the loop like any other state, which gives ``w`` one after another.
    """
    loop, column = closed_loop(servo)[0], _input_column(servo)
    lead = servo.velocity_feedforward / servo.sample_time
    found = np.zeros((powers, 3))
    for n in range(powers):
        right = column * (servo.position_gain if n == 0 else -lead * (-1.0) ** n)
        for m in range(n):
            right -= math.comb(n, m) * found[m]
        found[n] = np.linalg.solve(np.eye(3) - loop, right)
    return found


@lru_cache(maxsize=32)
def _squares(servo: Servo) -> FloatArray:
    """Raise the closed loop's matrix to the powers 1, 2, 4, …, shape ``(40, 3, 3)``."""
    found = [closed_loop(servo)[0]]
    while len(found) < 40:
        found.append(found[-1] @ found[-1])
    return np.array(found)


def _powers(servo: Servo, exponents: Samples, past: int) -> FloatArray:
    """Powers of the closed loop's matrix, zero beyond what is remembered; shape ``(..., 3, 3)``."""
    known, index = np.unique(exponents, return_inverse=True)
    found = np.broadcast_to(np.eye(3), (len(known), 3, 3)).copy()
    found[known > past] = 0.0
    left = np.where(known > past, 0, known)
    for square in _squares(servo):
        odd = (left & 1).astype(bool)
        if odd.any():
            found[odd] = found[odd] @ square
        left = left >> 1
        if not left.any():
            break
    return found[index.reshape(exponents.shape)]


@lru_cache(maxsize=32)
def _offsets(servo: Servo, most: int) -> Samples:
    """Choose samples after a break between which a transient does nothing of its own, close at first."""
    poles = np.linalg.eigvals(closed_loop(servo)[0]).astype(complex)
    poles = poles[np.abs(poles) > _GONE]
    lasts = (math.log(_GONE) / np.log(np.minimum(np.abs(poles), spectral_radius(servo)))).tolist()
    rates = np.abs(np.log(poles)).tolist()
    parts = [
        (last, max(rate for rate, felt in zip(rates, lasts, strict=True) if felt >= last)) for last in sorted(lasts)
    ]
    share = _SHARE
    while True:
        found, at = [0, 1, 2], 2
        for last, quickest in parts:
            step = max(1, int(share / quickest))
            while at < last:
                at += step
                found.append(at)
        if len(found) <= max(most, 2 * _EDGE) or share > 1e3:
            return np.array(found, dtype=np.int64)
        share *= 2.0
