"""The command of a whole shift as one table of polynomials: cams one after the other along the material."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.polynomial.profile import CamProfile, FloatArray

_SEAM = 1e-12
"""Share of a cam's length by which pieces may overlap where two cams meet: rounding."""


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


def motion_table(cams: Sequence[ShiftCam], order: NDArray[np.intp], pitch: float, start: float = 0.0) -> MotionTable:
    """Put cams one after the other.

    Parameters
    ----------
    cams
        The cams.
    order
        Which one runs at each piece, shape ``(pieces,)``.
    pitch
        Slave travel per cycle (slave unit): what each piece adds.
    start
        Material at which the first begins (m).
    """
    degree = max(cam.profile.degree for cam in cams)
    lengths = np.array([cam.profile.end for cam in cams])
    joints = start + np.concatenate([[0.0], np.cumsum(lengths[order])])
    counts = np.array([cam.profile.pieces for cam in cams])
    firsts = np.concatenate([[0], np.cumsum(counts)[:-1]])
    table = np.zeros((counts.sum(), degree + 1))
    begins = np.concatenate([cam.profile.breaks[:-1] for cam in cams])
    for cam, first in zip(cams, firsts, strict=True):
        table[first : first + cam.profile.pieces, : cam.profile.degree + 1] = cam.profile.coefficients
        table[first : first + cam.profile.pieces, 0] += cam.zero
    each = counts[order]
    piece = np.repeat(np.arange(len(order)), each)
    row = np.arange(each.sum()) - np.repeat(np.cumsum(each) - each, each) + np.repeat(firsts[order], each)
    coefficients = table[row]
    coefficients[:, 0] += pitch * piece
    return MotionTable(joints[piece] + begins[row], coefficients, joints)
