"""The command of a whole shift as one table of polynomials: cams one after the other along the material."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.polynomial.profile import CamProfile, FloatArray

_ROUNDING = 1e-12
"""Share of a return's length by which its end may be off."""


@dataclass(frozen=True, eq=False)
class ShiftCam:
    """A cam of a shift.

    Parameters
    ----------
    profile
        One cycle over ``[0, x_c]``, its sync zone at the end.
    zero
        Slave coordinate of the machine at its slave zero (slave unit).
    """

    profile: CamProfile
    zero: float


@dataclass(frozen=True, eq=False)
class MotionTable:
    """Slave over the material, piece by piece a polynomial; beyond both ends it moves on in a straight line.

    Parameters
    ----------
    breaks
        Where the polynomials begin (m), ascending, shape ``(n,)``.
    coefficients
        Ascending powers from there, shape ``(n, degree + 1)``.
    joints
        Where the cams begin, and the end of the last (m), shape ``(pieces + 1,)``.
    """

    breaks: FloatArray
    coefficients: FloatArray
    joints: FloatArray

    def __call__(self, x: FloatArray) -> FloatArray:
        """Slave coordinate of the machine (slave unit) where ``x`` (m) of the material has passed; same shape."""
        first, last = self.joints[0], self.joints[-1]
        inside = np.clip(x, first, last)
        row = np.maximum(np.searchsorted(self.breaks, inside, side="right") - 1, 0)
        local = inside - self.breaks[row]
        value = np.zeros(np.shape(x))
        for power in range(self.coefficients.shape[1] - 1, -1, -1):
            value *= local
            value += self.coefficients[row, power]
        return np.asarray(value + np.where(x < first, self._slopes[0], self._slopes[1]) * (x - inside))

    @property
    def _slopes(self) -> tuple[float, float]:
        """Ratio at the very start and at the very end."""
        powers = np.arange(1, self.coefficients.shape[1])
        end = self.joints[-1] - self.breaks[-1]
        return float(self.coefficients[0, 1]), float((powers * self.coefficients[-1, 1:]) @ end ** (powers - 1))


def motion_table(
    cams: Sequence[ShiftCam],
    order: NDArray[np.intp],
    pitch: float,
    sync_zone: float = 0.0,
    longer: FloatArray | None = None,
) -> MotionTable:
    """Put cams one after the other.

    Parameters
    ----------
    order
        Which one runs at each piece, shape ``(pieces,)``.
    pitch
        Slave travel per cycle (slave unit): what each piece adds.
    sync_zone
        Length of the sync zone at the end of each cam (m); what `longer` needs.
    longer
        By how much each piece is longer than its cam (m), shape ``(pieces,)``: the return is stretched by it, and a law of fifth degree
        makes up for what the material moves more. Ends and sync zones stay as they are. Nothing of it if not given.
    """
    degree = max([cam.profile.degree for cam in cams] + ([] if longer is None else [5]))
    counts = np.array([cam.profile.pieces for cam in cams])
    firsts = np.cumsum(counts) - counts
    table = np.zeros((int(counts.sum()), degree + 1))
    for cam, first in zip(cams, firsts.tolist(), strict=True):
        table[first : first + cam.profile.pieces, : cam.profile.degree + 1] = cam.profile.coefficients
        table[first : first + cam.profile.pieces, 0] += cam.zero
    each = counts[order]
    piece = np.repeat(np.arange(len(order)), each)
    row = np.arange(each.sum()) - np.repeat(np.cumsum(each) - each, each) + np.repeat(firsts[order], each)
    lengths = np.array([cam.profile.end for cam in cams])[order]
    begins, coefficients = np.concatenate([cam.profile.breaks[:-1] for cam in cams])[row], table[row]
    if longer is not None:
        backs = np.array([cam.profile.end - sync_zone for cam in cams])
        correction = np.concatenate(
            [_correction(cam.profile, back, degree) for cam, back in zip(cams, backs, strict=True)]
        )
        more, back = longer[piece], backs[order][piece]
        returns = begins < back * (1.0 - _ROUNDING)
        coefficients += more[:, None] * correction[row]
        stretch = np.where(returns, 1.0 + more / back, 1.0)
        coefficients /= stretch[:, None] ** np.arange(degree + 1)
        begins = np.where(returns, begins * stretch, begins + more)
        lengths = lengths + longer
    joints = np.concatenate([[0.0], np.cumsum(lengths)])
    coefficients[:, 0] += pitch * piece
    return MotionTable(joints[piece] + begins, coefficients, joints)


def _correction(profile: CamProfile, back: float, degree: int) -> FloatArray:
    """Give what the slave does less for each metre that a piece is longer, piece by piece of the profile: ``k (u - s(u))``.

    ``k`` is the ratio in sync, ``u`` the share of the return, ``s`` the law 3-4-5; zero in the sync zone.
    """
    ratio = float(profile(profile.end, 1))
    law = np.array([0.0, 1.0, 0.0, -10.0, 15.0, -6.0]) * ratio / back ** np.arange(6)
    found = np.zeros((profile.pieces, degree + 1))
    for row, begin in enumerate(profile.breaks[:-1].tolist()):
        if begin < back * (1.0 - _ROUNDING):
            for power in range(6):
                terms = (law[q] * math.comb(q, power) * begin ** (q - power) for q in range(power, 6))
                found[row, power] = math.fsum(terms)
    return found
