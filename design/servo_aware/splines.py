"""Weighted sums of a command at places on an even lattice, where its splines are all alike.

On even knots each spline is the first one moved by some steps, and so is what a servo makes of it. One response, on a lattice that parts a
step evenly, is therefore that of all splines at all places of the lattice.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

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


def lattice_sums(
    places: tuple[float, int],
    past: tuple[float, float],
    weights: FloatArray,
    splines: EvenSplines,
    found: FloatArray,
) -> None:
    """Several weighted sums of every spline at places of a lattice.

    Parameters
    ----------
    places
        The first place (m), and how many of them there are in a step of the knots.
    past
        How far behind a place its newest sample lies, and the distance of samples (m).
    weights
        Shape ``(samples, sums)``, newest sample first.
    found
        Where the sums go, shape ``(places, sums, splines)``.
    """
    (first, parts), many = places, splines.count
    size = len(found) + parts * (many - 1)
    fine, period = splines.step / parts, splines.cycle * parts / splines.step
    # where the spline of each sample begins, in parts of a step from where the response is wanted
    origin = first - splines.begin - fine * parts * (many - 1)
    starts = ((past[0] - origin) + past[1] * np.arange(len(weights))) / fine % period
    starts = starts + period * np.arange(-1, math.ceil(size / period) + 1)[:, None]
    again, sample = np.nonzero((starts > -_SUPPORT * parts) & (starts < size))
    at = starts[again, sample]
    index = np.floor(at).astype(np.intp)[:, None] + np.arange(1, 1 + _SUPPORT * parts)
    values = cubic((index - at[:, None]) / parts)
    bins = (index + _SUPPORT * parts).ravel()
    for number in range(weights.shape[1]):
        response = np.bincount(
            bins, (values * weights[sample, number, None]).ravel(), minlength=size + 2 * _SUPPORT * parts
        )
        windows = np.lib.stride_tricks.sliding_window_view(response[_SUPPORT * parts :], parts * (many - 1) + 1)
        found[:, number] = windows[: len(found), ::-parts]


def sums(places: FloatArray, weights: FloatArray, splines: EvenSplines, found: FloatArray) -> None:
    """Several weighted sums of every spline, each over samples at places (m) of its own: shapes as in `lattice_sums`."""
    turns = math.ceil(splines.cycle / splines.step - _ALIKE)
    at = (places - splines.begin) / splines.step % (splines.cycle / splines.step)
    piece = np.floor(at)
    values = cubic((at - piece)[..., None] + np.arange(_SUPPORT))
    index = (piece.astype(np.intp)[..., None] - np.arange(_SUPPORT)) % turns
    bins = (index + turns * np.arange(len(places))[:, None, None]).ravel()
    for number in range(weights.shape[1]):
        every = np.bincount(bins, (values * weights[:, number, None]).ravel(), minlength=turns * len(places))
        found[:, number] = every.reshape(len(places), turns)[:, : splines.count]


def cubic(x: FloatArray) -> FloatArray:
    """Cubic spline on the knots 0 to 4."""
    off = np.abs(x - 2.0)
    wide, narrow = np.maximum(2.0 - off, 0.0), np.maximum(1.0 - off, 0.0)
    return np.asarray((wide * wide * wide - 4.0 * narrow * narrow * narrow) / 6.0)
