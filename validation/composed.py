"""Quantities along a cycle as polynomials: a formula of the slave's position and its derivatives, piece by piece.

A torque or a tool's speed is a smooth function of the slave's polynomials. Interpolated at Chebyshev points it becomes polynomials itself,
so that peaks, mean squares and zeros come from the same exact roads as those of the motion.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.fitting import interpolation
from camwright.profiles.polynomial.profile import CamProfile, FloatArray

TOLERANCE = 1e-13
"""Error of a composed quantity, relative to its largest magnitude."""

ROUNDING = 1e-12
"""Error that is taken for rounding where halving a piece no longer makes it smaller; a smooth quantity's falls a thousandfold."""

_FALLS = 8.0
"""Factor by which it must fall to go on."""

DEGREE = 9
"""Degree of the pieces. Chebyshev points lie inside a piece, so at a jump each piece answers for itself alone."""

_SLIVER = 1e-12
"""Pieces shorter than this, relative to the domain, are left behind by rounding: a quantity is constant on them."""

_MOST_HALVINGS = 14
"""How often a piece may be halved; a smooth quantity needs few."""

_BETWEEN = 0.5 - 0.5 * np.cos(np.pi * np.arange(DEGREE + 2) / (DEGREE + 1))
"""Points where the interpolation is farthest from its own points: there its error is judged."""


def compose(formula: Callable[[FloatArray, FloatArray, FloatArray], FloatArray], profile: CamProfile) -> CamProfile:
    """Polynomials of a formula of ``y``, ``y'``, ``y''``, to 1e-13 of its largest magnitude, or to its own rounding.

    Parameters
    ----------
    formula
        Smooth function of position (slave unit), ratio and ratio slope, arrays of one shape.
    profile
        The slave over the master.

    Returns
    -------
    CamProfile
        The quantity over the master, its breaks among them those of the profile. It jumps where the profile's derivatives do.

    Raises
    ------
    InputError
        The formula has no finite value somewhere, or is not smooth.
    """
    lower, piece = profile.breaks[:-1], np.arange(profile.pieces)
    width = np.diff(profile.breaks)
    origin = lower.copy()  # where the polynomial of each part is counted from
    sliver = _SLIVER * profile.length
    done: list[tuple[FloatArray, FloatArray]] = []
    size, before = 0.0, np.full(profile.pieces, np.inf)
    points, to_series, to_powers = interpolation(DEGREE)
    for halving in range(_MOST_HALVINGS + 1):
        values = formula(*_states(profile, piece, lower - origin, width, points))
        size = max(size, float(np.abs(values).max(initial=0.0)))
        rows = (values @ to_series) @ to_powers
        truth = formula(*_states(profile, piece, lower - origin, width, _BETWEEN))
        found = np.polynomial.polynomial.polyval(_BETWEEN, rows.T, tensor=True)
        error = np.abs(found - truth).max(axis=1)
        if not np.isfinite(error).all():
            raise InputError(
                "a quantity along the cycle has no finite value: the machine cannot take all positions of this profile; "
                "check the machine's lengths"
            )
        rounded = (error <= ROUNDING * size) & (error > before / _FALLS)
        good = (error <= TOLERANCE * size) | rounded | (width < sliver)
        rows[width < sliver, 1:] = 0.0
        done.append((lower[good], rows[good] / np.maximum(width[good, None], sliver) ** np.arange(DEGREE + 1)))
        if good.all():
            break
        if halving == _MOST_HALVINGS:
            raise InputError(
                f"a quantity along the cycle is not smooth at master {float(lower[~good][0])!r} m: pieces of {float(width[~good][0])!r} m "
                f"do not carry it as polynomials"
            )
        half = 0.5 * width[~good]
        origin, piece = np.repeat(origin[~good], 2), np.repeat(piece[~good], 2)
        lower = np.stack([lower[~good], lower[~good] + half], axis=1).ravel()
        width, before = np.repeat(half, 2), np.repeat(error[~good], 2)
    starts = np.concatenate([start for start, _ in done])
    order = np.argsort(starts)
    return CamProfile(np.append(starts[order], profile.end), np.concatenate([rows for _, rows in done])[order])


def _states(
    profile: CamProfile, piece: NDArray[np.intp], start: FloatArray, width: FloatArray, points: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Position, ratio and ratio slope at points of parts of pieces, by each part's own piece; shapes ``(parts, points)``.

    Each part's polynomial is first counted from its own start: on a long piece the large terms that cancel there would otherwise put
    their rounding on every point anew, and no halving would make that smoother.
    """
    table = profile.coefficients[piece].copy()
    for power in range(profile.degree):  # synthetic division, once for each power
        for k in range(profile.degree - 1, power - 1, -1):
            table[:, k] += start * table[:, k + 1]
    local = width[:, None] * points
    states = []
    for _ in range(3):
        value = np.zeros_like(local)
        for k in range(table.shape[1] - 1, -1, -1):  # Horner
            value = value * local + table[:, k, None]
        states.append(value)
        table = table[:, 1:] * np.arange(1, table.shape[1]) if table.shape[1] > 1 else np.zeros((len(piece), 1))
    return states[0], states[1], states[2]
