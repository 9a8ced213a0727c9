"""How far a rebuilt motion is off the profile that it stands for."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.polynomial.rows import ascending

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


@lru_cache(maxsize=16)  # asked for where the points are chosen, and where the motion is judged
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
    worst, peak = _worst(profile, rebuilt, _NODES)
    return Deviation(worst[0], worst[1], worst[2] / max(peak, 1e-300) if _bounded(profile, rebuilt) else None)


@lru_cache(maxsize=64)  # of motions that several targets make of the same points
def glance(profile: CamProfile, rebuilt: CamProfile, peak: float) -> Deviation:
    """Bound `deviation` from below, in a fifth of its time: by both ends and the middle of every piece.

    Parameters
    ----------
    profile, rebuilt
        As in `deviation`.
    peak
        Greatest magnitude of the profile's ratio slope.
    """
    worst, _ = _worst(profile, rebuilt, _NODES[::8])
    acceleration = worst[2] / max(peak * (1.0 + 1e-12), 1e-300)
    return Deviation(worst[0], worst[1], acceleration if _bounded(profile, rebuilt) else None)


def _worst(profile: CamProfile, rebuilt: CamProfile, nodes: FloatArray) -> tuple[list[float], float]:
    """Greatest deviations of position, ratio and ratio slope at places of the pieces, and the profile's greatest slope."""
    start, end = max(profile.start, rebuilt.start), min(profile.end, rebuilt.end)
    breaks = ascending(np.concatenate([profile.breaks, rebuilt.breaks]))
    breaks = np.concatenate([[start], breaks[(breaks > start) & (breaks < end)], [end]])
    middle = 0.5 * (breaks[1:] + breaks[:-1])
    x = breaks[:-1] + np.diff(breaks) * nodes[:, None]
    worst: list[float] = []
    for wanted, found in zip(_on_pieces(profile, middle, x), _on_pieces(rebuilt, middle, x), strict=True):
        peak = max(float(wanted.max()), -float(wanted.min()))
        off = found
        off -= wanted
        worst.append(max(float(off.max()), -float(off.min())))
    return worst, peak


@lru_cache(maxsize=16)
def _bounded(profile: CamProfile, rebuilt: CamProfile) -> bool:
    """Say whether the rebuilt ratio does not jump, so that there is an acceleration.

    Where the profile's own ratio does not meet itself at the seam, it is a motion that is run once, and has none.
    """
    allowed = _JUMP * max(1.0, float(np.abs(profile(profile.breaks[:-1], 1)).max()))
    jumps = rebuilt.jumps(1, seam=bool(abs(profile.jumps(1)[-1]) <= allowed))
    return float(np.abs(jumps).max(initial=0.0)) <= allowed


def _on_pieces(profile: CamProfile, middle: FloatArray, x: FloatArray) -> Iterator[FloatArray]:
    """Evaluate position, ratio and ratio slope at places ``x``, shape ``(n, pieces)``, by the pieces that hold the middles."""
    piece = profile.holding(middle)
    local = x - profile.breaks[piece]
    for order in range(3):
        yield profile.on_pieces(piece, local, order)
