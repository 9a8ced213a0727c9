"""What the numbers of a job must be to each other, whatever the machine."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from camwright.job_fields import Known
from camwright.machine_checks import machine_conflicts, sync_zone_of
from camwright.machine_tables import machine_of
from profiles.machines import Machine
from profiles.servo import Servo, spectral_radius


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
    numbers = known.numbers
    return [*_zones(known, machine), *machine_conflicts(known, machine), *_servo(numbers)]


def _mm(value: float) -> str:
    """Write a length in millimetres."""
    return f"{value * 1e3:.10g} mm"


def _zones(known: Known, machine: Machine | None) -> Iterator[str]:
    """Check that the zones fit into what holds them."""
    sync = sync_zone_of(known, machine)
    if sync is None:
        return
    numbers = known.numbers
    length = numbers.get("length")
    if length is not None and sync >= length:
        yield (
            f"[cut] sync_zone = {_mm(sync)}: not below [cut] length = {_mm(length)}, so no return zone is left; "
            "shorten the sync zone or cut longer"
        )
    shear, at = numbers.get("shear_zone"), numbers.get("shear_zone_at")
    if shear is not None and shear > sync:
        yield (
            f"[cut] shear_zone = {_mm(shear)}: above [cut] sync_zone = {_mm(sync)}, in which it must lie; "
            "shorten the shear zone or lengthen the sync zone"
        )
    elif shear is not None and at is not None and at + shear > sync * (1 + 1e-12):
        yield (
            f"[cut] shear_zone_at = {_mm(at)}: the shear zone of {_mm(shear)} would end {_mm(at + shear)} after the "
            f"start of the sync zone of {_mm(sync)}; begin it at {_mm(sync - shear)} at the latest"
        )


def _servo(values: Mapping[str, float]) -> Iterator[str]:
    """Check that the servo samples at least once a cycle and is stable."""
    sample, length, line_speed = (values.get(key) for key in ("sample_time", "length", "line_speed"))
    if sample is None:
        return
    if length is not None and line_speed is not None and sample > length / line_speed:
        yield (
            f"[servo] sample_time = {sample * 1e3:.10g} ms: longer than the cycle of "
            f"{length / line_speed * 1e3:.10g} ms ([cut] length / line_speed); "
            "give the drive's sampling period, usually 1 ms to 8 ms"
        )
        return  # a servo that slow is unstable for this reason alone
    keys = ("bandwidth", "damping", "position_gain", "velocity_feedforward")
    if not all(key in values for key in keys):
        return
    radius = spectral_radius(Servo(sample_time=sample, **{key: values[key] for key in keys}))
    if not radius < 1.0:
        yield (
            f"[servo] position_gain = {values['position_gain']:.10g} 1/s: the sampled position loop is unstable: its "
            f"spectral radius is {radius:.6g} and must be below 1; lower the position gain or the sample time "
            f"({sample * 1e3:.10g} ms)"
        )
