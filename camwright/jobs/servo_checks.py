"""What the numbers of a job must be for its servo: sampled often enough, stable, its ranges about it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields

from camwright.house.numbers import typed
from camwright.jobs.fields import Known
from camwright.jobs.spread_fields import ends
from camwright.profiles.servo import Servo, gain_margin, spectral_radius
from camwright.profiles.servo_tolerance import ServoTolerance

_UNITS = {"bandwidth": "bandwidth", "damping": "1", "position_gain": "1/s"}


def servo_conflicts(known: Known) -> Iterator[str]:
    """Check that the servo samples at least once a cycle, is stable, and lies in its ranges.

    Of a servo-aware design also that at least one sample falls in the shear zone.
    """
    values = known.numbers
    late = list(_sampling(known))
    yield from late
    ranges = list(_ranges(known))
    yield from ranges
    needed = [each.name for each in fields(Servo)]
    if late or not all(f"servo.{key}" in values for key in needed):
        return  # a servo that samples so late is unstable for this reason alone
    servo = Servo(**{key: values[f"servo.{key}"] for key in needed})
    radius = spectral_radius(servo)
    if not radius < 1.0:
        yield (
            f"[servo] position_gain = {_written('position_gain', servo.position_gain)}: the sampled position loop is unstable: its "
            f"spectral radius is {radius:.6g} and must be below 1; {_way_out(servo)}"
        )
    elif known.spreads and not ranges:
        yield from _corners(tolerance_of(known, servo), servo)


def tolerance_of(known: Known, servo: Servo) -> ServoTolerance:
    """Ranges of a servo's parameters; those that the job file does not give have no width."""
    names = [each.name for each in fields(ServoTolerance)]
    return ServoTolerance(**{key: ends(known.spreads.get(key), getattr(servo, key)) for key in names})


def _sampling(known: Known) -> Iterator[str]:
    """Check the sample time against the cycle and, of a servo-aware design, against the shear zone."""
    values = known.numbers
    sample, length, line_speed = (values.get(key) for key in ("servo.sample_time", "cut.length", "cut.line_speed"))
    if sample is None or line_speed is None:
        return
    shear = values.get("cut.shear_zone")
    if length is not None and sample > length / line_speed:
        yield (
            f"[servo] sample_time = {_written('sample_time', sample)}: longer than the cycle of "
            f"{_written('sample_time', length / line_speed)} ([cut] length / line_speed); "
            "give the drive's sampling period, usually 1 ms to 8 ms"
        )
    elif known.servo_aware and shear is not None and sample > shear / line_speed:
        lasts, longer = shear / line_speed, typed(1.00001 * sample * line_speed, "m", 6, known.units)
        yield (
            f"[servo] sample_time = {_written('sample_time', sample)}: longer than the shear zone lasts, "
            f"{typed(lasts, 's', 4)} ([cut] shear_zone / line_speed), so {lasts / sample:.3g} samples fall in it and the servo cannot see "
            f"the sync tolerance there; lengthen the shear zone to {longer} or more, or sample faster"
        )


def _ranges(known: Known) -> Iterator[str]:
    """Check that every range has some width and contains the servo's own value."""
    for key, spread in known.spreads.items():
        nominal = known.numbers.get(f"servo.{key}")
        if nominal is None:
            continue
        own = f"[servo] {key} = {_written(key, nominal)}"
        low, high = ends(spread, nominal)
        if nominal == 0.0 and not isinstance(spread, tuple):
            yield (
                f"[servo.tolerance] {key} = {spread * 100:.10g} %: no range, since {own}; "
                f'write its ends, e.g. {key} = ["0 ms", "1 ms"]'
            )
        elif not low <= nominal <= high:
            yield (
                f"[servo.tolerance] {key}: the range from {_written(key, low)} to {_written(key, high)} does not contain {own}; "
                f"{'begin it lower' if nominal < low else 'end it higher'}, or correct [servo] {key}"
            )


def _corners(tolerance: ServoTolerance, servo: Servo) -> Iterator[str]:
    """Check that the servo is stable at all corners of its ranges; tells the one that is furthest from it."""
    radius, worst = max(
        ((spectral_radius(corner), corner) for corner in tolerance.vertices(servo)), key=lambda pair: pair[0]
    )
    if not radius < 1.0:
        place = ", ".join(f"{key} = {_written(key, getattr(worst, key))}" for key in tolerance.varying)
        yield (
            f"[servo.tolerance]: at the corner {place} the sampled position loop is unstable: its spectral radius is {radius:.6g} and "
            f"must be below 1; narrow the ranges; there {_way_out(worst)}"
        )


def _way_out(servo: Servo) -> str:
    """Say by how much the gain of an unstable servo must fall."""
    margin = gain_margin(servo)
    return (
        f"the gain margin is {margin:.4g}: lower the position gain by the factor {1.001 / margin:.4g}, to "
        f"{0.999 * margin * servo.position_gain:.4g} 1/s or less, or the sample time ({_written('sample_time', servo.sample_time)})"
    )


def _written(key: str, value: float) -> str:
    """Write a parameter with its unit."""
    return typed(value, _UNITS.get(key, "s"))
