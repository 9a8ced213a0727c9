"""`Cut`: one cutting cycle on the master, and where its zones lie."""

from __future__ import annotations

from dataclasses import dataclass, replace
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
    sync_time, shear_time
        Times (s) that sync zone and shear zone last at the line speed, where these are given as times, as a press's stroke is;
        another design at another line speed then has other zones (`designed_at`). Forgotten where the zone is not that long.

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
    sync_time: float | None = None
    shear_time: float | None = None

    def __post_init__(self) -> None:
        """Forget the time of a zone that is not that long."""
        for name, zone in (("sync_time", self.sync_zone), ("shear_time", self.shear_zone)):
            time = getattr(self, name)
            if time is not None and zone != time * self.line_speed:
                object.__setattr__(self, name, None)

    @property
    def timed(self) -> bool:
        """Whether its zones depend on the line speed that it is designed at."""
        return self.sync_time is not None or self.shear_time is not None

    def designed_at(self, line_speed: float) -> Cut:
        """Give the cut that another design has at a line speed (m/s): zones that last a time are as long as it takes there.

        A cam that is there keeps its zones on the material at any line speed: that is the cut with another ``line_speed``. A shear zone at
        the end of the sync zone stays there.

        Examples
        --------
        >>> from camwright import Cut
        >>> press = Cut(0.75, 2.0, sync_zone=0.08, shear_zone=0.08, shear_zone_at=0.0, sync_tolerance=1e-4, sync_time=0.04, shear_time=0.04)
        >>> press.designed_at(1.0).sync_zone
        0.04
        """
        sync = self.sync_zone if self.sync_time is None else self.sync_time * line_speed
        shear = self.shear_zone if self.shear_time is None else self.shear_time * line_speed
        at_end = self.shear_zone_at == self.sync_zone - self.shear_zone
        at = sync - shear if at_end else min(self.shear_zone_at, sync - shear)
        return replace(self, line_speed=line_speed, sync_zone=sync, shear_zone=shear, shear_zone_at=at)

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
