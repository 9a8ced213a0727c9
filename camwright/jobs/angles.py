"""What a job file writes as an angle by which the tool turns, or as a time, as travel of the slave and the master."""

from __future__ import annotations

import math

from camwright.jobs.fields import Known
from camwright.profiles.cut import Cut
from camwright.profiles.machines import Machine

_LIMITS = ("limits.speed", "limits.acceleration", "limits.jerk")


def settle_angles(known: Known, machine: Machine | None) -> None:
    """Turn the angles that are known into numbers in metres, as far as machine and zone are known.

    A drum's speed, acceleration and jerk are those of the blade's edge by its radius, whatever the number of blades. An angle in the
    sync zone is that by which the blade turns from the start of the zone, or to its end where the shear zone ends there.
    """
    if machine is None or not machine.by_angle or machine.slave_turn is None:
        return
    numbers, angles = known.numbers, known.indirect.angles
    for key in _LIMITS:
        if key in angles:
            numbers[key] = angles[key] * machine.slave_turn / (2.0 * math.pi)
    ratio = numbers.get("cut.sync_ratio")
    if ratio is None:
        return
    if "cut.sync_zone" in angles:
        numbers["cut.sync_zone"] = machine.zone_of_angle(angles["cut.sync_zone"], ratio)
    zone = numbers.get("cut.sync_zone")
    if zone is not None:
        _settle_shear_zone(known, machine, Cut(2.0 * zone, 1.0, zone, 0.0, 0.0, 1e-4, sync_ratio=ratio))


def _settle_shear_zone(known: Known, machine: Machine, cut: Cut) -> None:
    """Turn the angles of the shear zone and of its start into lengths on the master."""
    numbers, angles = known.numbers, known.indirect.angles
    if "cut.shear_zone_at" in angles:
        numbers["cut.shear_zone_at"] = machine.master_of_angle(angles["cut.shear_zone_at"], cut)
    if "cut.shear_zone" not in angles:
        return
    at = numbers.get("cut.shear_zone_at")
    if at is not None:
        start = machine.angle_of_master(at, cut)
        numbers["cut.shear_zone"] = machine.master_of_angle(start + angles["cut.shear_zone"], cut) - at
    else:  # at the end of the sync zone
        end = machine.angle_of_master(cut.sync_zone, cut)
        numbers["cut.shear_zone"] = cut.sync_zone - machine.master_of_angle(end - angles["cut.shear_zone"], cut)


def settle_times(known: Known) -> None:
    """Turn the zones that are known as times into lengths, ``l = v t``, once the line speed is known."""
    line_speed = known.numbers.get("cut.line_speed")
    if line_speed is not None:
        known.numbers.update({place: time * line_speed for place, time in known.indirect.times.items()})
