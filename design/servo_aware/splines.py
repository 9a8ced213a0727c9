"""Weighted sums of a command at places on an even lattice, where its splines are all alike.

On even knots each spline is the first one moved by some steps, and so is what a servo makes of it. One response, on a lattice that parts a
step evenly, is therefore that of all splines at all places of the lattice.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.polynomial.profile import FloatArray

_SUPPORT = 4
"""Steps on which a cubic spline is not zero."""

_ALIKE = 1e-9
"""Share of a step by which a cycle may be off a whole number of them by rounding."""


@dataclass(frozen=True)
class EvenSplines:
    """Cubic splines on even knots, one a step.

    Parameters
    ----------
    step
        Of the knots (m).
    begin
        Where the first one begins (m).
    count
        How many there are.
    cycle
        After so much of the master (m) all come again.
    """

    step: float
    begin: float
    count: int
    cycle: float

    @property
    def turns(self) -> int:
        """Steps in a cycle, the last of which may be cut short."""
        return math.ceil(self.cycle / self.step - _ALIKE)


class SplineSums:
    """Which samples at places move which splines by how much; weighted sums of them for any weights follow by gathering alone.

    Servos that are looked at at the same places, and sample at the same times, differ in nothing but their weights.

    Parameters
    ----------
    places
        Master positions (m), shape ``(rows,)``.
    regular
        How many of them, the first ones, are a lattice that parts a step evenly, ascending; it may be none.
    samples
        How far behind a place its samples lie (m), newest first, evenly apart.
    splines
        The splines.
    """

    def __init__(self, places: FloatArray, regular: int, samples: FloatArray, splines: EvenSplines) -> None:
        self._counts, self._splines = (regular, len(places) - regular, len(samples)), splines
        self._parts, self._size = 1, 0
        found = [_alone(places[regular:, None] - samples, splines)]
        if regular:
            self._parts = round(splines.step * (regular - 1) / float(places[regular - 1] - places[0]))
            self._size = regular + self._parts * (splines.count - 1) + 2 * _SUPPORT * self._parts
            found.append(self._on_lattice(float(places[0]), samples))
        starts = np.array([self._size, 0])
        values, sample, bins = zip(*found, strict=True)
        moved = [each + start for each, start in zip(bins, starts, strict=False)]
        self._shares: _Shares = np.concatenate(values), np.concatenate(sample), np.concatenate(moved)

    def _on_lattice(self, first: float, samples: FloatArray) -> _Shares:
        """Lay the samples out along the response of one spline, which is that of all splines at all places of the lattice."""
        splines, parts = self._splines, self._parts
        size = self._size - 2 * _SUPPORT * parts
        fine, period = splines.step / parts, splines.cycle * parts / splines.step
        # where the spline of each sample begins, in parts of a step from where the response is wanted
        origin = first - splines.begin - fine * parts * (splines.count - 1)
        starts = (samples - origin) / fine % period
        starts = starts + period * np.arange(-1, math.ceil(size / period) + 1)[:, None]
        again, sample = np.nonzero((starts > -_SUPPORT * parts) & (starts < size))
        at = starts[again, sample]
        index = np.floor(at).astype(np.intp)[:, None] + np.arange(1, 1 + _SUPPORT * parts)
        values = cubic((index - at[:, None]) / parts)
        return values.ravel(), np.repeat(sample, values.shape[1]), (index + _SUPPORT * parts).ravel()

    def of(self, weights: FloatArray) -> FloatArray:
        """Give the sums by weights of shape ``(samples, sums)``, which may be fewer, as an array ``(places, sums, splines)``."""
        (regular, alone, samples), count, turns = self._counts, self._splines.count, self._splines.turns
        (values, sample, bins), parts = self._shares, self._parts
        found = np.empty((regular + alone, weights.shape[1], count))
        for number in range(weights.shape[1]):
            column = np.zeros(samples)
            column[: len(weights)] = weights[:, number]
            every = np.bincount(bins, values * column[sample], minlength=self._size + turns * alone)
            found[regular:, number] = every[self._size :].reshape(alone, turns)[:, :count]
            if regular:
                response = every[_SUPPORT * parts : self._size]
                windows = np.lib.stride_tricks.sliding_window_view(response, parts * (count - 1) + 1)
                found[:regular, number] = windows[:regular, ::-parts]
        return found


class LaidSamples:
    """Samples of a command that servos look back to from places: sums of them over the unknowns, and their values.

    Parameters
    ----------
    places, regular, samples, splines
        As `SplineSums` has them.
    known
        The command there that the unknowns are added to, shape ``(places, samples)``.
    """

    def __init__(
        self, places: FloatArray, regular: int, samples: FloatArray, splines: EvenSplines, known: FloatArray
    ) -> None:
        self.known = known
        self._of = places, regular, samples, splines
        self._turns = splines.turns
        self._last: tuple[FloatArray, FloatArray] | None = None

    @cached_property
    def sums(self) -> SplineSums:
        """Their sums over the unknowns."""
        return SplineSums(*self._of)

    @cached_property
    def _pieces(self) -> tuple[NDArray[np.intp], FloatArray]:
        """In which step of the knots each sample lies, and where in it."""
        places, _, samples, splines = self._of
        at, turn = (places[:, None] - samples - splines.begin) / splines.step, splines.cycle / splines.step
        at -= turn * np.floor(at / turn)  # a remainder takes ten times as long
        piece = np.clip(at.astype(np.intp), 0, self._turns - 1)
        return piece, at - piece

    def values(self, unknowns: FloatArray) -> FloatArray:
        """Give the command at the samples; of the unknowns that were asked for last they are kept."""
        if self._last is None or self._last[0] is not unknowns:
            piece, part = self._pieces
            every = np.zeros(self._turns + _SUPPORT - 1)  # those that began before the first step come before it
            every[_SUPPORT - 1 :][: self._of[3].count] = unknowns
            every[: _SUPPORT - 1] = every[self._turns :]
            powers = _POWERS @ np.lib.stride_tricks.sliding_window_view(every, self._turns)[::-1]
            found = powers[3][piece]
            for power in powers[2::-1]:
                found *= part
                found += power[piece]
            found += self.known
            self._last = unknowns, found
        return self._last[1]


_POWERS = np.array([[0, 1, 4, 1], [0, 3, 0, -3], [0, 3, -6, 3], [1, -3, 3, -1]]) / 6.0
"""Powers of the place in a step, ascending, of the cubic splines that began in it and in the steps before."""

_Shares = tuple[FloatArray, NDArray[np.intp], NDArray[np.intp]]
"""What samples have in bins: the shares, the number of the sample of each, and its bin."""


def _alone(places: FloatArray, splines: EvenSplines) -> _Shares:
    """Lay out samples at places (m), shape ``(rows, samples)``; a row has as many bins as splines begin in a cycle."""
    (rows, samples), turns = places.shape, splines.turns
    at = (places - splines.begin) / splines.step % (splines.cycle / splines.step)
    piece = np.floor(at)
    values = cubic((at - piece)[..., None] + np.arange(_SUPPORT))
    index = (piece.astype(np.intp)[..., None] - np.arange(_SUPPORT)) % turns
    sample = np.broadcast_to(np.arange(samples)[:, None], values.shape)
    return values.ravel(), sample.ravel(), (index + turns * np.arange(rows)[:, None, None]).ravel()


def cubic(x: FloatArray) -> FloatArray:
    """Cubic spline on the knots 0 to 4."""
    off = np.abs(x - 2.0)
    wide, narrow = np.maximum(2.0 - off, 0.0), np.maximum(1.0 - off, 0.0)
    return np.asarray((wide * wide * wide - 4.0 * narrow * narrow * narrow) / 6.0)
