"""What the numbers of a job must be to each other, whatever the machine."""

from __future__ import annotations

from collections.abc import Iterator

from camwright.house.numbers import typed
from camwright.jobs.fields import Known
from camwright.jobs.line_speeds import line_speed_conflicts
from camwright.jobs.machine_checks import machine_conflicts
from camwright.jobs.machine_tables import machine_of
from camwright.jobs.servo_checks import servo_conflicts


def conflicts(known: Known) -> list[str]:
    """Check the numbers of a job against each other.

    Parameters
    ----------
    known
        The numbers that are right in themselves. A check is made when all its numbers are there.

    Returns
    -------
    list
        One message for each conflict: quantity, value, limit, place, way out.
    """
    machine = machine_of(known)
    return [
        *_zones(known),
        *machine_conflicts(known, machine),
        *servo_conflicts(known),
        *line_speed_conflicts(known),
        *_line(known),
    ]


def _line(known: Known) -> Iterator[str]:
    """Check that a jerk of the line has a ramp that it belongs to."""
    jerk = known.numbers.get("line.jerk")
    if jerk is not None and not known.numbers.keys() & {"line.acceleration", "line.stop"}:
        yield (
            f"[line] jerk = {typed(jerk, 'm/s^3', units=known.units)}: the line has no ramp whose jerk it could be; "
            'add [line] acceleration or stop, e.g. acceleration = "1 m/s^2", or leave jerk out'
        )


def _zones(known: Known) -> Iterator[str]:
    """Check that the zones fit into what holds them."""
    sync = known.numbers.get("cut.sync_zone")
    if sync is None:
        return
    numbers = known.numbers

    def written(value: float) -> str:
        return typed(value, "m", units=known.units)

    length = numbers.get("cut.length")
    if length is not None and sync >= length:
        yield (
            f"[cut] sync_zone = {written(sync)}: not below [cut] length = {written(length)}, so no return zone is left; "
            "shorten the sync zone or cut longer"
        )
    shear, at = numbers.get("cut.shear_zone"), numbers.get("cut.shear_zone_at")
    if shear is not None and shear > sync:
        yield (
            f"[cut] shear_zone = {written(shear)}: above [cut] sync_zone = {written(sync)}, in which it must lie; "
            "shorten the shear zone or lengthen the sync zone"
        )
    elif shear is not None and at is not None and at + shear > sync * (1 + 1e-12):
        yield (
            f"[cut] shear_zone_at = {written(at)}: the shear zone of {written(shear)} would end {written(at + shear)} after the "
            f"start of the sync zone of {written(sync)}; begin it at {written(sync - shear)} at the latest"
        )
