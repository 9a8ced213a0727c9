"""`Cut`: one cutting cycle on the master, and where its zones lie."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Origin = Literal["return", "cut"]


@dataclass(frozen=True)
class Cut:
    """What is cut, how fast, and where the slave must be in sync.

    Parameters
    ----------
    length
        Cut length ``x_c``: master travel per cycle (m).
    line_speed
        Line speed ``v`` (m/s), constant.
    sync_zone
        Length of the sync zone ``l_s`` on the master (m).
    shear_zone
        Length of the shear zone ``l_j`` (m), 0 for a cut of no width.
    shear_zone_at
        Where the shear zone begins, from the start of the sync zone (m).
    sync_tolerance
        What the axis may be off the material in the shear zone (m).
    origin
        Where the master is zero: at the start of the return zone (``"return"``) or at mid sync zone (``"cut"``).
    sync_ratio
        Speed of the tool over the speed of the material in the sync zone, 1 for sync.
    shaped
        Whether the command is shaped so that the axis, not the command itself, is in sync in the shear zone. A profile's slave zero is
        then the machine in sync at master zero, where the command may be elsewhere.

    Examples
    --------
    >>> from camwright import Cut
    >>> cut = Cut(0.6, 80 / 60, sync_zone=0.2, shear_zone=0.04, shear_zone_at=0.16, sync_tolerance=1e-4)
    >>> round(cut.return_zone, 9), round(cut.period, 9), round(cut.shear_start, 9)
    (0.4, 0.45, 0.56)
    """

    length: float
    line_speed: float
    sync_zone: float
    shear_zone: float
    shear_zone_at: float
    sync_tolerance: float
    origin: Origin = "return"
    sync_ratio: float = 1.0
    shaped: bool = False

    @property
    def return_zone(self) -> float:
        """Length of the return zone on the master (m)."""
        return self.length - self.sync_zone

    @property
    def period(self) -> float:
        """Cycle time (s)."""
        return self.length / self.line_speed

    @property
    def sync_start(self) -> float:
        """Master position at which the sync zone begins (m); negative with the origin at the cut."""
        return self.return_zone if self.origin == "return" else -0.5 * self.sync_zone

    @property
    def return_start(self) -> float:
        """Master position at which the return zone begins (m)."""
        return 0.0 if self.origin == "return" else 0.5 * self.sync_zone

    @property
    def sync_parts(self) -> tuple[tuple[float, float], ...]:
        """The sync zone as parts of the period ``[0, length]``: one part, or two with the origin at the cut."""
        if self.origin == "return":
            return ((self.return_zone, self.length),)
        half = 0.5 * self.sync_zone
        return ((0.0, half), (self.length - half, self.length))

    @property
    def shear_start(self) -> float:
        """Master position at which the shear zone begins (m), counted like `sync_start`."""
        return self.sync_start + self.shear_zone_at
