"""`Entry`: what a book knows of one combination; small, and the same wherever it was computed."""

from __future__ import annotations

import json
from dataclasses import dataclass, fields
from typing import Any, Literal

Status = Literal["passed", "check_failed", "infeasible", "failed"]
"""How a combination ended: every check passed; designed, but a check failed or a table was not released; no motion keeps the
limits, or the combination is no job; the solver failed."""


@dataclass(frozen=True)
class Limit:
    """How fast a cut length can be run at all.

    Parameters
    ----------
    line_speed
        Highest line speed that the limits allow, with a perfect axis (m/s); None if none works.
    binding
        What binds there.
    in_tolerance
        Highest line speed with the axis in tolerance, designed anew there (m/s); None if none was found.
    failing
        What binds or fails beyond that.
    """

    line_speed: float | None
    binding: str
    in_tolerance: float | None
    failing: str


@dataclass(frozen=True)
class Entry:
    """One line of a book's index. Numbers in SI units; None for what does not exist.

    Parameters
    ----------
    number
        Number of the combination.
    status
        How it ended.
    objective, unit
        Value of the objective at line speed, and its unit.
    peak_speed, peak_acceleration, rms_acceleration, peak_jerk
        Of the tool (m/s, m/s², m/s³).
    following_error, settling, shear_zone_error
        Of the servo (m).
    worst_shear_zone_error
        Greatest over the corners of the servo's ranges, too (m); None without ranges.
    failed_checks
        Names of the checks that failed, of the design and, after the target's name, of its tables.
    tables
        Points of each table that was released, by target.
    binding
        What binds where the combination is infeasible, else empty.
    reason
        Why it is infeasible or failed, else empty.
    limit
        How fast the cut length can be run; with the first combination of each cut length only.
    speed_band
        Line speeds at which this very cam passes every check (m/s): lowest and highest of each part. Of passed ones only.
    mark_earliest, mark_latest
        How early (not above zero) and how late a print mark may come, its return designed anew (m); no latest where the slave can wait. Of
        passed ones only.
    line_ramp, line_stop
        Greatest ramp of the line up and down, and greatest deceleration of an emergency stop, between standstill and this line speed
        (m/s²); None where nothing binds. Of passed ones only.
    files
        Names, SHA-256 of the files in its folder.
    """

    number: int
    status: Status
    objective: float | None = None
    unit: str = ""
    peak_speed: float | None = None
    peak_acceleration: float | None = None
    rms_acceleration: float | None = None
    peak_jerk: float | None = None
    following_error: float | None = None
    settling: float | None = None
    shear_zone_error: float | None = None
    worst_shear_zone_error: float | None = None
    failed_checks: tuple[str, ...] = ()
    tables: tuple[tuple[str, int], ...] = ()
    binding: str = ""
    reason: str = ""
    limit: Limit | None = None
    speed_band: tuple[tuple[float, float], ...] = ()
    mark_earliest: float | None = None
    mark_latest: float | None = None
    line_ramp: float | None = None
    line_stop: float | None = None
    files: tuple[tuple[str, str], ...] = ()

    def to_json(self) -> str:
        """Write the entry as JSON; what has its default is left out."""
        values = {name: value for name, value in vars(self).items() if value != _DEFAULTS[name]}
        if self.limit is not None:
            values["limit"] = vars(self.limit)
        return json.dumps(values, allow_nan=False, separators=(",", ":"))

    @classmethod
    def from_json(cls, text: str) -> Entry:
        """Read what `to_json` wrote, bit by bit."""
        values: dict[str, Any] = json.loads(text)
        if "limit" in values:
            values["limit"] = Limit(**values["limit"])
        for name in ("failed_checks", "tables", "speed_band", "files"):
            if name in values:
                values[name] = tuple(tuple(item) if isinstance(item, list) else item for item in values[name])
        return cls(**values)


_DEFAULTS = {each.name: each.default for each in fields(Entry)}
