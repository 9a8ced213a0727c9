"""The servo in job files: dead time and lead, ranges of its parameters, servo-aware designs, and every fault of these."""

from __future__ import annotations

import re
import tomllib

import jsonschema
import pytest

from camwright.jobs.job import BUNDLED_JOB, load_job, parse_job
from camwright.jobs.structure import job_schema
from camwright.profiles.errors import InputError
from camwright.profiles.servo import Servo, gain_margin, spectral_radius
from camwright.profiles.servo_tolerance import ServoTolerance

PAPER = BUNDLED_JOB.read_text(encoding="utf-8")
AWARE = 'minimise = "peak_acceleration"\nservo_aware = true'


def changed(servo: str = "", objective: str = 'minimise = "peak_acceleration"', tolerance: str = "") -> str:
    """Add lines to [servo], put others in the place of those of [objective], and add a [servo.tolerance]."""
    text = PAPER.replace("velocity_feedforward = 1.0\n", f"velocity_feedforward = 1.0\n{servo}\n")
    text = text.replace('minimise = "peak_acceleration"', objective)
    return f"{text}\n[servo.tolerance]\n{tolerance}\n" if tolerance else text


def faults(text: str) -> tuple[str, ...]:
    with pytest.raises(InputError) as caught:
        parse_job(text, "job.toml")
    return tuple(fault.removeprefix("job.toml: ") for fault in caught.value.faults)


def test_the_papers_job_has_no_dead_time_and_is_not_servo_aware() -> None:
    job = load_job()
    assert (job.servo.dead_time, job.servo.lead_time) == (0.0, 0.0)
    assert (job.servo_aware, job.command, job.servo_tolerance) == (False, "in_sync", None)


def test_dead_time_and_lead_are_read_in_seconds() -> None:
    job = parse_job(changed('dead_time = "2.5 ms"\nlead_time = "0 ms"'), "")
    assert job.servo == Servo(120.0, 0.7, 35.0, 0.004, 1.0, 0.0025, 0.0)
    assert parse_job(changed('lead_time = "0.001 s"'), "").servo.delay == -0.001


def test_a_servo_aware_job_says_so() -> None:
    job = parse_job(changed(objective=AWARE), "")
    assert (job.servo_aware, job.command, job.objective) == (True, "in_sync", "peak_acceleration")
    job = parse_job(changed(objective='servo_aware = true\ncommand = "shaped"\nminimise = "sync_error"'), "")
    assert (job.servo_aware, job.command, job.objective) == (True, "shaped", "sync_error")


def test_ranges_are_read_as_percentages_and_as_ends() -> None:
    ranges = 'bandwidth = "10 %"\ndamping = [0.65, 0.8]\nposition_gain = "5%"\nsample_time = ["3 ms", "4 ms"]'
    tolerance = parse_job(changed(tolerance=ranges), "").servo_tolerance
    assert tolerance is not None
    assert tolerance.bandwidth == pytest.approx((108.0, 132.0), rel=1e-15)
    assert tolerance.damping == (0.65, 0.8)
    assert tolerance.position_gain == pytest.approx((33.25, 36.75), rel=1e-15)
    assert tolerance.sample_time == (0.003, 0.004)
    assert tolerance.dead_time == (0.0, 0.0)
    late = parse_job(changed('dead_time = "1 ms"', tolerance='dead_time = ["0 ms", "2 ms"]'), "").servo_tolerance
    assert late is not None
    assert late.varying == ("dead_time",)
    assert late.dead_time == (0.0, 0.002)
    assert late.bandwidth == (120.0, 120.0)


def test_corners_are_all_combinations_in_a_fixed_order() -> None:
    servo = Servo(120.0, 0.7, 35.0, 0.004, 0.9, 0.001, 0.002)
    ranges = ServoTolerance((108.0, 132.0), (0.63, 0.77), (33.0, 37.0), (0.004, 0.004), (0.001, 0.001))
    corners = ranges.vertices(servo)
    assert len(set(corners)) == 8
    assert corners[0] == Servo(108.0, 0.63, 33.0, 0.004, 0.9, 0.001, 0.002)
    assert corners[1] == Servo(108.0, 0.63, 37.0, 0.004, 0.9, 0.001, 0.002)
    assert corners[-1] == Servo(132.0, 0.77, 37.0, 0.004, 0.9, 0.001, 0.002)
    known = ServoTolerance((120.0, 120.0), (0.7, 0.7), (35.0, 35.0), (0.004, 0.004), (0.001, 0.001))
    assert known.vertices(servo) == (servo,)
    assert known.draw(servo, 3, 1) == (servo,) * 3


def test_draws_fill_the_ranges_evenly_and_repeat_with_their_seed() -> None:
    servo = Servo(120.0, 0.7, 35.0, 0.004, 1.0)
    ranges = ServoTolerance((108.0, 132.0), (0.63, 0.77), (35.0, 35.0), (0.004, 0.004), (0.0, 0.002))
    drawn = ranges.draw(servo, 2000, 7)
    assert drawn == ranges.draw(servo, 2000, 7)
    assert drawn != ranges.draw(servo, 2000, 8)
    assert {each.position_gain for each in drawn} == {35.0}
    for name in ranges.varying:
        low, high = ranges.ranges[name]
        parts = [(getattr(each, name) - low) / (high - low) for each in drawn]
        assert 0.0 <= min(parts) < 0.01
        assert 0.99 < max(parts) <= 1.0
        # of 2000 even draws the mean is within 4 standard deviations, 1 / sqrt(12 · 2000) each
        assert sum(parts) / len(parts) == pytest.approx(0.5, abs=4 / (12 * 2000) ** 0.5)


@pytest.mark.parametrize("bandwidth", [60.0, 120.0])
@pytest.mark.parametrize("gain", [1.0, 35.0, 400.0])
def test_the_gain_margin_is_where_the_loop_becomes_unstable(bandwidth: float, gain: float) -> None:
    margin = gain_margin(Servo(bandwidth, 0.7, gain, 0.004, 1.0))
    for part, stable in ((0.999999, True), (1.000001, False)):
        assert (spectral_radius(Servo(bandwidth, 0.7, part * margin * gain, 0.004, 1.0)) < 1.0) == stable


def test_the_gain_margin_of_a_fast_sampled_loop_is_that_of_routh() -> None:
    assert gain_margin(Servo(120.0, 0.7, 35.0, 1e-6, 1.0)) == pytest.approx(2 * 0.7 * 120.0 / 35.0, rel=1e-3)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (changed('dead_time = "-1 ms"'),
         "[servo] dead_time = '-1 ms': negative; a time not below zero is expected; write e.g. \"4 ms\""),
        (changed('lead_time = "-1 ms"'), "[servo] lead_time = '-1 ms': negative; a time not below zero"),
        (changed("dead_time = 2"), '[servo] dead_time = 2: a number without a unit; write e.g. "2 ms"'),
        (changed('dead_tme = "2 ms"'), "[servo] dead_tme: there is no such key; did you mean dead_time?"),
        (changed(objective='servo_aware = "yes"'),
         "[objective] servo_aware = 'yes': neither true nor false; write true or false without quotes"),
        (changed(objective='minimise = "sync_error"'),
         ("[objective] minimise = 'sync_error': for servo-aware designs only; add servo_aware = true or minimise e.g. "
         '"peak_acceleration"')),
        (changed(objective='servo_aware = false\ncommand = "shaped"'),
         "[objective] command = 'shaped': for servo-aware designs only; add servo_aware = true or leave command out"),
        (changed(objective='command = "in_sync"'), "[objective] command = 'in_sync': for servo-aware designs only"),
        (changed(objective='servo_aware = true\ncommand = "free"'),
         "[objective] command = 'free': not known; write \"in_sync\" or \"shaped\""),
        (changed(objective='servo_aware = true\nminimise = "time"'),
         "[objective] minimise = 'time': not known; write \"peak_acceleration\", "),
        (changed(tolerance='bandwidth = ["132 rad/s", "108 rad/s"]'),
         "[servo.tolerance] bandwidth = ['132 rad/s', '108 rad/s']: the range is upside down; give its lower end first"),
        (changed(tolerance="damping = [0.8, 0.6]"),
         "[servo.tolerance] damping = [0.8, 0.6]: the range is upside down; give its lower end first"),
        (changed(tolerance='bandwidth = ["125 rad/s", "132 rad/s"]'),
         ("[servo.tolerance] bandwidth: the range from 125 rad/s to 132 rad/s does not contain [servo] bandwidth = 120 "
         "rad/s; begin it lower, or correct [servo] bandwidth")),
        (changed(tolerance='sample_time = ["1 ms", "2 ms"]'),
         ("[servo.tolerance] sample_time: the range from 1 ms to 2 ms does not contain [servo] sample_time = 4 ms; end it "
         "higher, or correct [servo] sample_time")),
        (changed(tolerance='dead_time = ["1 ms", "2 ms"]'),
         "[servo.tolerance] dead_time: the range from 1 ms to 2 ms does not contain [servo] dead_time = 0 ms; begin"),
        (changed(tolerance="damping = [0.8, 0.9]"), "does not contain [servo] damping = 0.7; begin it lower"),
        (changed(tolerance='dead_time = "10 %"'),
         ("[servo.tolerance] dead_time = 10 %: no range, since [servo] dead_time = 0 ms; write its ends, e.g. dead_time = "
         '["0 ms", "1 ms"]')),
        (changed(tolerance='bandwidth = "100 %"'),
         ("[servo.tolerance] bandwidth = '100 %': not a percentage above 0 % and below 100 %; write e.g. \"10 %\", to "
         'both sides, or the ends of the range, ["108 rad/s", "132 rad/s"]')),
        (changed(tolerance='damping = "-5 %"'), "[servo.tolerance] damping = '-5 %': not a percentage above 0 %"),
        (changed(tolerance='damping = "12 rad/s"'), "[servo.tolerance] damping = '12 rad/s': not a percentage above"),
        (changed(tolerance="bandwidth = 10"),
         "[servo.tolerance] bandwidth = 10: not a range; write e.g. \"10 %\", to both sides, or its two ends, "),
        (changed(tolerance='position_gain = ["30 1/s"]'), "[servo.tolerance] position_gain = ['30 1/s']: not a range"),
        (changed(tolerance='position_gain = ["30 1/s", "40 mm"]'),
         "'40 mm': a length, but a gain is expected; write e.g. \"35 1/s\""),
        (changed(tolerance='sample_time = ["0 ms", "4 ms"]'), "'0 ms': zero; a time greater than zero is expected"),
        (changed(tolerance='damping = [0.6, "0.8"]'), "'0.8': not a number; write e.g. 0.63"),
        (changed(tolerance="damping = [0.0, 0.8]"), "0.0: the damping ratio is above 0 and at most 100; write e.g. 0.63"),
        (changed(tolerance="damping = [nan, 0.8]"), "nan: the damping ratio is above 0 and at most 100"),
        (changed(tolerance='lead_time = "10 %"'), "[servo.tolerance] lead_time: there is no such key; did you mean dead_time?"),
        (changed("tolerance = 3"), "[servo] tolerance = 3: not a table; write [servo.tolerance] on a line of its own"),
        (changed().replace('"0.1 mm"', '"1e-7 mm"'),
         "[cut] sync_tolerance = '1e-7 mm': outside the range of a length, 1e-09 to 1e+06 m; write e.g. \"0.1 mm\""),
    ],
)  # fmt: skip
def test_a_fault_is_told_with_its_place_and_the_way_out(text: str, message: str) -> None:
    found = faults(text)
    assert len(found) == 1, found
    assert message in found[0]


def test_an_unstable_servo_is_told_its_gain_margin_and_the_advice_works() -> None:
    text = changed().replace('"35 1/s"', '"200 1/s"')
    (fault,) = faults(text)
    found = re.fullmatch(
        r"\[servo\] position_gain = 200 1/s: the sampled position loop is unstable: its spectral radius is 1\.\d+ and must be below 1; "
        r"the gain margin is (0\.\d+): lower the position gain by the factor (1\.\d+), to (\d+\.\d) 1/s or less, or the sample "
        r"time \(4 ms\)",
        fault,
    )
    assert found, fault
    margin, factor, gain = (float(text) for text in found.groups())
    assert margin == pytest.approx(gain_margin(Servo(120.0, 0.7, 200.0, 0.004, 1.0)), rel=1e-3)
    for advised in (gain, 200 / factor):
        assert parse_job(text.replace('"200 1/s"', f'"{advised} 1/s"'), "").servo.position_gain == advised


def test_an_unstable_corner_of_the_ranges_is_told() -> None:
    (fault,) = faults(changed(tolerance='position_gain = ["35 1/s", "200 1/s"]\nbandwidth = "10 %"'))
    assert fault.startswith(
        "[servo.tolerance]: at the corner bandwidth = 108 rad/s, position_gain = 200 1/s the sampled position loop is unstable: "
    )
    assert "narrow the ranges; there the gain margin is 0.59" in fault


@pytest.mark.parametrize("sample_time", [31.0, 100.0])
def test_a_servo_aware_job_needs_a_sample_in_the_shear_zone(sample_time: float) -> None:
    # 40 mm at 80 m/min last 30 ms
    text = changed(objective=AWARE).replace('"4 ms"', f'"{sample_time} ms"').replace('"35 1/s"', '"5 1/s"')
    (fault,) = faults(text)
    assert fault.startswith(
        f"[servo] sample_time = {sample_time:g} ms: longer than the shear zone lasts, 30 ms ([cut] shear_zone / line_speed), so "
        f"{30 / sample_time:.3g} samples fall in it"
    )
    advised = re.search(r"lengthen the shear zone to (\S+) mm or more", fault)
    assert advised
    parse_job(text.replace('shear_zone = "40 mm"', f'shear_zone = "{advised.group(1)} mm"'), "")
    parse_job(text.replace(AWARE, ""), "")  # of no matter to others


def test_a_servo_aware_job_needs_a_shear_zone() -> None:
    (fault,) = faults(changed(objective=AWARE).replace('shear_zone = "40 mm"', 'shear_zone = "0 mm"'))
    assert "longer than the shear zone lasts, 0 ms ([cut] shear_zone / line_speed), so 0 samples fall in it" in fault


@pytest.mark.parametrize(
    "text",
    [
        changed('dead_time = "-1 ms"'),
        changed(objective='servo_aware = "yes"'),
        changed(objective='servo_aware = true\ncommand = "free"'),
        changed(tolerance="bandwidth = 10"),
        changed(tolerance='position_gain = ["30 1/s"]'),
        changed(tolerance='lead_time = "10 %"'),
        changed(tolerance="damping = [0.0, 0.8]"),
    ],
)
def test_the_schema_refuses_what_the_reader_refuses(text: str) -> None:
    assert faults(text)
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(tomllib.loads(text), job_schema())


def test_the_schema_takes_what_the_reader_takes() -> None:
    text = changed(
        'dead_time = "1 ms"',
        'servo_aware = true\ncommand = "shaped"\nminimise = "sync_error"',
        'bandwidth = "10 %"\ndamping = [0.65, 0.8]\ndead_time = ["0 ms", "2 ms"]',
    )
    parse_job(text, "")
    jsonschema.validate(tomllib.loads(text), job_schema())
