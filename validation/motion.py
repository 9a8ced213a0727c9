"""Motion of a profile over time at the cut's line speed: peaks, root mean squares, error of the ratio in sync."""

from __future__ import annotations

import math
from dataclasses import dataclass

from profiles.cycle import Cut
from profiles.errors import InputError
from profiles.polynomial import CamProfile, Extremum

RATIO_JUMP = 1e-9
"""Jump of the ratio (pure number) above which acceleration and jerk count as unbounded."""

SLOPE_JUMP = 1e-9
"""Jump of the ratio slope above which the jerk counts as unbounded, relative to `slope_scale`. Rounding of the
standard laws leaves jumps of up to about 3e-12 of that scale, a table of 1e-7 relative resolution jumps of more than
1e-7."""

POSITION_JUMP = 1e-12
"""Jump of the position, relative to the cut length, above which speed, acceleration and jerk count as unbounded."""

_DOMAIN = 1e-12
"""Rounding, relative to the cut length, that a profile's domain may be off the period ``[0, x_c]``."""

_EDGE = 1e-12
"""Rounding, relative to the cut length, by which a break may miss the end of the sync zone that it stands for."""


@dataclass(frozen=True)
class Motion:
    """Measures of one cycle over time, SI units.

    ``None`` stands for unbounded. The peaks are of the whole cycle, the root mean squares of the return zone alone,
    so that they do not depend on how long the slave runs in sync. The least velocity is signed.

    Parameters
    ----------
    peak_speed
        Greatest speed (m/s).
    min_speed
        Least velocity, negative where the slave runs backwards (m/s).
    peak_acceleration, rms_acceleration
        Greatest magnitude and root mean square over the return zone (m/s²).
    peak_jerk, rms_jerk
        Greatest magnitude and root mean square over the return zone (m/s³).
    sync_ratio_error
        Greatest ``|k - 1|`` inside the sync zone.
    """

    peak_speed: float
    min_speed: float
    peak_acceleration: float | None
    rms_acceleration: float | None
    peak_jerk: float | None
    rms_jerk: float | None
    sync_ratio_error: float


def require_period(profile: CamProfile, cut: Cut) -> None:
    """Refuse a profile that does not run over one master period ``[0, x_c]`` of the cut.

    Raises
    ------
    InputError
        The profile's domain is another one.
    """
    allowed = _DOMAIN * cut.length
    if abs(profile.start) > allowed or abs(profile.end - cut.length) > allowed:
        raise InputError(
            f"the profile runs over the master from {profile.start!r} m to {profile.end!r} m, but one cycle of this "
            f"cut runs from 0 m to the cut length {cut.length!r} m; judge it with the cut that it was made for"
        )


def greatest_magnitude(profile: CamProfile, order: int) -> Extremum:
    """Greatest magnitude of a derivative over the master, one-sided values at breaks included, and its place."""
    least, greatest = profile.extrema(order)
    return Extremum(-least.value, least.at) if -least.value > greatest.value else greatest


def greatest_jump(profile: CamProfile, order: int) -> Extremum:
    """Greatest magnitude of the jumps of a derivative, at all joins and at the seam, and where it is.

    The position (``order=0``) is judged at the joins only: at the seam it is judged by the advance.
    """
    jumps = abs(profile.jumps(order))
    worst = int(jumps.argmax())
    return Extremum(float(jumps[worst]), float(profile.breaks[worst + 1]))


def slope_scale(profile: CamProfile) -> float:
    """Size of the ratio slope (1/m): its greatest magnitude, at least a ratio of one per cycle."""
    return max(greatest_magnitude(profile, 2).value, 1.0 / profile.length)


def sync_ratio_error(profile: CamProfile, cut: Cut) -> Extremum:
    """Greatest ``|k - 1|`` inside the sync zone, and where it is reached.

    The ends of the zone count with their one-sided values inside the zone.
    """
    edge = _EDGE * cut.length
    worst = Extremum(0.0, cut.sync_parts[0][0])
    for start, end in cut.sync_parts:
        for found in profile.extrema(1, start + edge, end - edge):
            if abs(found.value - 1.0) > worst.value:
                worst = Extremum(abs(found.value - 1.0), found.at)
    return worst


def measure_motion(profile: CamProfile, cut: Cut) -> Motion:
    """Measure a profile at the line speed of the cut, by roots of its polynomials and exact integration.

    Over time ``velocity = v y'``, ``acceleration = v² y''``, ``jerk = v³ y'''``.

    Parameters
    ----------
    profile
        One cycle over the master period ``[0, x_c]`` (m).
    cut
        The cut it is judged for.

    Raises
    ------
    InputError
        The profile does not run over ``[0, x_c]``.
    """
    require_period(profile, cut)
    v = cut.line_speed
    steady = (
        greatest_jump(profile, 0).value <= POSITION_JUMP * cut.length and greatest_jump(profile, 1).value <= RATIO_JUMP
    )
    smooth = steady and greatest_jump(profile, 2).value <= SLOPE_JUMP * slope_scale(profile)

    start, end = cut.return_start, cut.return_start + cut.return_zone

    def rms(order: int) -> float:
        return v**order * math.sqrt(profile.mean_square(order, start, min(end, profile.end)))

    return Motion(
        peak_speed=v * greatest_magnitude(profile, 1).value,
        min_speed=v * profile.extrema(1)[0].value,
        peak_acceleration=v**2 * greatest_magnitude(profile, 2).value if steady else None,
        rms_acceleration=rms(2) if steady else None,
        peak_jerk=v**3 * greatest_magnitude(profile, 3).value if smooth else None,
        rms_jerk=rms(3) if smooth else None,
        sync_ratio_error=sync_ratio_error(profile, cut).value,
    )
