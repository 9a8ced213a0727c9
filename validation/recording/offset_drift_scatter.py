"""Errors of many cuts told apart: what is the same for all, what grows from cut to cut, what changes with the line speed, what is left."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from camwright.profiles.polynomial.profile import FloatArray

Kind = Literal["offset", "drift", "scatter"]
"""The kinds of error, each of which points to another cause."""

FEWEST = 4
"""Cuts from which on drift and scatter are told apart."""

_VARIES = 0.02
"""Part of itself by which the line speed must vary to be looked at."""


@dataclass(frozen=True)
class Errors:
    """What the errors of some cuts in a row are made of.

    ``error = offset + drift * (number - middle) - lag * (speed - mean speed) + scatter``

    Parameters
    ----------
    offset
        Mean of all cuts (m).
    drift
        What each cut adds (m), least squares; ``None`` of fewer than `FEWEST` cuts.
    drift_interval
        95 % confidence of it.
    lag
        Time by which the tool runs later the faster the line (s); ``None`` where the line speed hardly changed.
    lag_interval
        95 % confidence of it.
    scatter
        Standard deviation of what is left (m).
    range
        Greatest minus least of what is left (m).
    """

    offset: float
    drift: float | None
    drift_interval: tuple[float, float] | None
    lag: float | None
    lag_interval: tuple[float, float] | None
    scatter: float | None
    range: float | None

    @property
    def drifts(self) -> bool:
        """Whether a drift is beyond chance."""
        return self.drift_interval is not None and not self.drift_interval[0] <= 0.0 <= self.drift_interval[1]

    def shares(self, cuts: int) -> dict[Kind, float]:
        """Say how far each kind moves a cut over the run (m): the offset, the drift to either end, twice the scatter."""
        drift = 0.5 * (cuts - 1) * abs(self.drift) if self.drift is not None and self.drifts else 0.0
        return {"offset": abs(self.offset), "drift": drift, "scatter": 2.0 * (self.scatter or 0.0)}


def told_apart(errors: Sequence[float], speeds: Sequence[float]) -> Errors:
    """Tell the errors of cuts in a row apart.

    Parameters
    ----------
    errors
        Error of each cut (m).
    speeds
        Line speed at each (m/s).
    """
    values, pace = np.asarray(errors, dtype=np.float64), np.asarray(speeds, dtype=np.float64)
    count, offset = len(values), float(values.mean())
    if count < FEWEST:
        return Errors(offset, None, None, None, None, None, None)
    columns = [np.ones(count), np.arange(count) - 0.5 * (count - 1)]
    if float(np.ptp(pace)) > _VARIES * float(pace.mean()) and count > FEWEST:
        columns.append(-(pace - pace.mean()))
    found, bounds, left = _least_squares(np.stack(columns, axis=1), values)
    lag = len(columns) > 2
    return Errors(
        offset=offset,
        drift=float(found[1]),
        drift_interval=(float(bounds[0, 1]), float(bounds[1, 1])),
        lag=float(found[2]) if lag else None,
        lag_interval=(float(bounds[0, 2]), float(bounds[1, 2])) if lag else None,
        scatter=math.sqrt(float(left @ left) / (count - len(columns))),
        range=float(np.ptp(left)),
    )


def _least_squares(columns: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Coefficients, their 95 % bounds by Student's t, and what is left."""
    from scipy.special import stdtrit

    rows, width = columns.shape
    found = np.asarray(np.linalg.lstsq(columns, values, rcond=None)[0], dtype=np.float64)
    left = values - columns @ found
    inverse = np.linalg.pinv(columns.T @ columns)
    spread = float(stdtrit(rows - width, 0.975)) * np.sqrt(np.diag(inverse) * float(left @ left) / (rows - width))
    return found, np.asarray([found - spread, found + spread]), left
