"""How far a rebuilt motion is off the profile that it stands for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from profiles.polynomial import CamProfile, FloatArray

_NODES = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, 17))
"""Where each common piece is looked at, as parts of it: dense at its ends, where polynomials have their extremes."""

_JUMP = 1e-9
"""A jump of the ratio above this part of the greatest ratio, at least of 1, makes the acceleration unbounded."""


@dataclass(frozen=True)
class Deviation:
    """Greatest deviations of a rebuilt motion from its profile over one cycle.

    Parameters
    ----------
    position
        Of the slave position (slave unit).
    ratio
        Of the ratio.
    acceleration
        Of the ratio slope, relative to the profile's greatest; ``None`` where the rebuilt ratio jumps.
    """

    position: float
    ratio: float
    acceleration: float | None


def deviation(profile: CamProfile, rebuilt: CamProfile) -> Deviation:
    """Compare two profiles piece by piece on the part of the master that both cover.

    Every piece between two breaks of either is looked at in 17 places, one-sided at its ends: a polynomial of degree 5
    is nowhere more than 2 % beyond its greatest value there.

    Parameters
    ----------
    profile
        What was meant, in SI units.
    rebuilt
        What the drive makes of the table, in SI units.
    """
    start, end = max(profile.start, rebuilt.start), min(profile.end, rebuilt.end)
    breaks = np.union1d(profile.breaks, rebuilt.breaks)
    breaks = np.concatenate([[start], breaks[(breaks > start) & (breaks < end)], [end]])
    middle = 0.5 * (breaks[1:] + breaks[:-1])
    x = breaks[:-1, None] + np.diff(breaks)[:, None] * _NODES
    worst: list[float] = []
    for order in range(3):
        wanted, found = _on_pieces(profile, middle, x, order), _on_pieces(rebuilt, middle, x, order)
        worst.append(float(np.abs(found - wanted).max()))
        peak = float(np.abs(wanted).max())
    scale = max(1.0, float(np.abs(profile(profile.breaks[:-1], 1)).max()))
    bounded = float(np.abs(rebuilt.jumps(1)).max()) <= _JUMP * scale
    return Deviation(worst[0], worst[1], worst[2] / max(peak, 1e-300) if bounded else None)


def _on_pieces(profile: CamProfile, middle: FloatArray, x: FloatArray, order: int) -> FloatArray:
    """Evaluate a derivative at the places ``x`` (shape ``(pieces, n)``) by the pieces that hold the middles."""
    index = np.clip(np.searchsorted(profile.breaks, middle, side="right") - 1, 0, profile.pieces - 1)
    table = profile.coefficients[index]
    for _ in range(order):
        table = table[:, 1:] * np.arange(1, table.shape[1])
    local = x - profile.breaks[index][:, None]
    value = np.zeros_like(local)
    for power in range(table.shape[1] - 1, -1, -1):  # Horner
        value = value * local + table[:, power, None]
    return value
