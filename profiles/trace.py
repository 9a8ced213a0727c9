"""A recorded motion of an axis."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camwright.profiles.machines.machine import SlaveUnit
from camwright.profiles.polynomial.profile import FloatArray


@dataclass(frozen=True, eq=False)
class Trace:
    """What a drive recorded: command and actual position at equally spaced times.

    Parameters
    ----------
    start
        Time of the first row (s).
    step
        Time between two rows (s).
    command, actual
        Positions (m or rad), shape ``(n,)``.
    unit
        Whether positions are counted in m or in rad.
    notes
        What the reader found worth telling.
    master
        Position of the master (m or rad, a turn for each cycle), shape ``(n,)``; ``None`` where it was not recorded or not asked for.
    master_unit
        Whether the master is counted in m or in rad.
    """

    start: float
    step: float
    command: FloatArray
    actual: FloatArray
    unit: SlaveUnit
    notes: tuple[str, ...] = ()
    master: FloatArray | None = None
    master_unit: SlaveUnit = "m"

    @property
    def times(self) -> FloatArray:
        """Times of the rows (s)."""
        return self.start + self.step * np.arange(len(self.command), dtype=np.float64)
