"""The line speeds at which a cam passes every check: closed forms, naive twins, gaps, and random jobs judged anew."""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from hypothesis import Phase, assume, given, settings
from hypothesis import strategies as st
from shaped_job import JOB

from camwright.jobs.job import Job, load_job, parse_job
from camwright.profiles.cut import Cut
from camwright.profiles.limits import Limits
from camwright.profiles.machines import CrankSlider, LinearCarriage, Machine, RotaryKnife
from camwright.profiles.motor import MotorCurve
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import baseline
from camwright.profiles.servo import Servo, spectral_radius
from camwright.profiles.task import Task
from camwright.studies import speed_band as band_module
from camwright.studies.axis_study import solve_job
from camwright.studies.speed_band import ACCURACY, NO_END, SpeedBand, job_band, speed_band
from camwright.studies.speed_scan import NAMES, TOLERANCE
from camwright.validation.report import judge
from camwright.validation.servo.axis_motion import axis_peaks
from camwright.validation.servo.creeping import command_error, creeping_axis, creeping_speeds
from camwright.validation.servo.line_speeds import line_speed_errors

BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"
PAPER = load_job()
SHAPED = JOB.replace('"0.1 mm"', '"0.25 mm"').replace(
    'minimise = "sync_error"', 'minimise = "sync_error"\nline_speeds = "100 %"'
)
"""Shaped for its full line speed alone."""


def band_of(profile: CamProfile, job: Job) -> SpeedBand:
    return job_band(profile, job, judge(profile, job.task, job.servo, servo_aware=job.servo_aware))


@dataclass(frozen=True)
class Made:
    """Checks of no cam: the sync error goes over the tolerance between two line speeds, while the axis comes near its limit."""

    hump: float

    def excess(self, speeds: np.ndarray, _: int) -> np.ndarray:
        """Give values over limits, as `SpeedScan.excess`."""
        found = np.zeros((len(speeds), len(NAMES)))
        found[:, NAMES.index("shear_zone_error")] = 1.0007 - 0.5 * (speeds - self.hump) ** 2
        found[:, NAMES.index("axis_acceleration")] = (speeds / 3.6951) ** 2
        return found


@pytest.mark.parametrize("hump", [3.552, 3.555, 3.56])
def test_a_gap_that_opens_between_two_steps_is_found_while_another_check_rises(hump: float) -> None:
    scan, speeds = Made(hump), np.array([3.2, 3.3, 3.39, 3.495, 3.605, 3.695])
    rows = scan.excess(speeds, 64)
    assert (rows <= 1.0).all()
    found = band_module._with_extrema(scan, speeds, rows)[1]  # type: ignore[arg-type]
    assert (found > 1.0).any()


def edge(profile: CamProfile, job: Job, low: float, high: float) -> float:
    """Bisect where the verdict changes, by whole validations."""

    def passes(speed: float) -> bool:
        task = job.task.at_speed(speed)
        return judge(profile, task, job.servo, servo_aware=job.servo_aware).passed

    first = passes(low)
    assert passes(high) is not first
    while high - low > 1e-5 * low:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if passes(middle) is first else (low, middle)
    return low


@pytest.mark.parametrize(("name", "order"), [("speed", 1), ("acceleration", 2), ("jerk", 3)])
def test_the_highest_line_speed_of_a_limit_is_exact(name: str, order: int) -> None:
    profile = baseline("cycloid", PAPER.task)
    motion = judge(profile, PAPER.task, PAPER.servo).motion
    peak = (motion.peak_speed, motion.peak_acceleration, motion.peak_jerk)[order - 1]
    assert peak is not None
    free = Limits(1e3, 1e5, 1e7)
    job = replace(PAPER, limits=replace(free, **{name: 1.05**order * peak}))
    band = band_of(profile, job)
    assert band.binds == ((NO_END, name),)
    assert band.parts[0][0] == 0.0
    assert band.parts[0][1] == pytest.approx(1.05 * job.cut.line_speed, rel=2e-9)


def test_what_the_servo_forbids_is_where_whole_validations_change_their_verdict() -> None:
    profile = baseline("poly_3_4_5", PAPER.task)
    job = replace(PAPER, limits=Limits(1e3, 1e5, 1e7))
    band = band_of(profile, job)
    assert band.binds == ((NO_END, "shear_zone_error"),)
    found = edge(profile, job, 1.3, 6.0)
    assert band.parts[0][1] == pytest.approx(found, rel=2 * ACCURACY)


def test_a_shaped_cam_is_released_about_its_own_line_speed_only() -> None:
    job = parse_job(SHAPED, "shaped.toml")
    profile = solve_job(job).profile
    band = band_of(profile, job)
    ((low, high),) = band.parts
    own = job.cut.line_speed
    assert 0.9 * own < low < own < high < 1.1 * own
    assert band.binds == (("shear_zone_error", "shear_zone_error"),)
    assert low == pytest.approx(edge(profile, job, 0.9 * own, own), rel=2 * ACCURACY)
    assert high == pytest.approx(edge(profile, job, own, 1.1 * own), rel=2 * ACCURACY)
    assert not band.holds(0.0)
    assert not band.holds(0.5 * own)


def test_a_shaped_cam_whose_own_line_speed_is_its_slowest_is_released_at_it() -> None:
    """Just below it the cam passes at the phases of the scan alone; the end that passes at more phases lies at it, not beyond."""
    job = replace(PAPER, servo_aware=True, slowest=1.0, cut=replace(PAPER.cut, shaped=True))
    profile = solve_job(job).profile
    ((low, high),) = band_of(profile, job).parts
    own = job.cut.line_speed
    assert (1.0 - 2 * ACCURACY) * own <= low <= own < high


def test_the_corners_of_the_servo_narrow_the_band_and_are_named() -> None:
    profile = solve_job(parse_job(SHAPED, "shaped.toml")).profile
    ranges = '[servo.tolerance]\nbandwidth = "0.1 %"\n[objective]'
    job = parse_job(SHAPED.replace("[objective]", ranges), "shaped.toml")
    band = band_of(profile, job)
    alone = band_of(profile, replace(job, servo_tolerance=None))
    ((low, high),), ((least, most),) = band.parts, alone.parts
    assert least <= low < job.cut.line_speed <= high <= most
    assert TOLERANCE in band.binds[0]


def test_a_motor_ends_the_band_where_its_torque_does() -> None:
    task = Task(
        RotaryKnife(0.4, drum_inertia=0.02),
        replace(PAPER.cut),
        Limits(1e3, 1e5, 1e7, motor=MotorCurve(((0.0, 4.0), (400.0, 4.0)))),
    )
    job = replace(PAPER, machine=task.machine, limits=task.limits)
    profile = baseline("cycloid", task)
    band = band_of(profile, job)
    motor = judge(profile, task, job.servo).motor
    assert motor.peak_torque is not None
    expected = job.cut.line_speed * np.sqrt(4.0 / motor.peak_torque)  # inertia alone: as the square
    assert band.parts[0][1] == pytest.approx(expected, rel=2 * ACCURACY)
    assert band.binds[0][1] == "motor_torque"


def test_a_cam_that_fails_at_every_speed_has_no_band_and_says_why() -> None:
    assert band_of(baseline("linear_return", PAPER.task), PAPER) == SpeedBand((), (), ("ratio_joins",))
    unstable = replace(PAPER, servo=replace(PAPER.servo, position_gain=300.0))
    band = band_of(baseline("cycloid", PAPER.task), unstable)
    assert band.parts == ()
    assert band.forbids == ("servo_stability",)
    tight = replace(
        PAPER,
        servo_aware=True,
        servo=replace(PAPER.servo, velocity_feedforward=0.0),
        cut=replace(PAPER.cut, shaped=True, sync_tolerance=1e-9),
    )
    assert band_of(baseline("cycloid", PAPER.task), tight).forbids == ("shear_zone_error",)


def test_a_band_has_what_lies_in_its_parts() -> None:
    band = SpeedBand(((0.0, 1.0), (1.5, 2.0), (3.0, 4.0)), (("none", "a"), ("b", "c"), ("d", "e")))
    assert band.holds(1.7)
    assert not band.holds(2.5)
    assert band.holds(0.0)


CUTS: list[tuple[Machine, Cut, str]] = [
    (RotaryKnife(0.4), PAPER.cut, "poly_3_4_5"),
    (RotaryKnife(0.4), replace(PAPER.cut, shear_zone_at=0.0, origin="cut"), "cycloid"),
    (RotaryKnife(0.8, blades=2, sync="horizontal"), replace(PAPER.cut, length=0.5), "poly_3_4_5"),
    (LinearCarriage(0.8), PAPER.cut, "poly_3_4_5"),
    (CrankSlider(0.15, 0.6, 0.02, sync_at=1.2), Cut(0.9, 0.5, 0.1, 0.02, 0.05, 1e-4), "poly_3_4_5"),
]


@settings(max_examples=20, deadline=None, phases=(Phase.explicit, Phase.generate))
@given(
    which=st.sampled_from(range(len(CUTS))),
    bandwidth=st.floats(60.0, 200.0),
    gain=st.floats(5.0, 60.0),
    sample=st.floats(1e-3, 8e-3),
    feedforward=st.sampled_from([0.9, 0.99, 1.0]),
    tolerance=st.floats(2e-5, 2e-3),
    dead=st.sampled_from([0.0, 0.002]),
    share=st.floats(0.2, 1.0),
)
def test_a_line_slower_than_the_bound_is_in_tolerance(
    which: int,
    bandwidth: float,
    gain: float,
    sample: float,
    feedforward: float,
    tolerance: float,
    dead: float,
    share: float,
) -> None:
    machine, cut, law = CUTS[which]
    servo = Servo(bandwidth, 0.8, gain, sample, feedforward, dead_time=dead)
    assume(spectral_radius(servo) < 0.98)
    task = Task(machine, replace(cut, sync_tolerance=tolerance), Limits(3.0, 30.0, 3e3))
    profile = baseline(law, task)
    assert command_error(profile, task) < 1e-9
    within, outside = creeping_speeds(profile, task, servo)
    assert outside == 0.0
    assert within > 0.0
    speed = share * within
    assume(speed > 0.02)
    assert line_speed_errors(profile, task, [servo], np.array([speed]), 64)[0, 0] <= tolerance
    at_ease = share * creeping_axis(profile, task, servo, 3e-3)
    assume(at_ease > 0.02)
    peaks = axis_peaks(profile, task.at_speed(at_ease).cut, servo)
    assert peaks.peak_speed <= task.limits.speed
    assert peaks.peak_acceleration <= task.limits.acceleration
    assert task.reverses or profile.extrema(1)[0].value < 0.0 or peaks.least_velocity >= -3e-3


def test_a_shaped_command_that_is_off_by_itself_is_surely_outside_when_the_line_creeps() -> None:
    job = parse_job(SHAPED, "shaped.toml")
    profile = solve_job(job).profile
    within, outside = creeping_speeds(profile, job.task, job.servo)
    assert within == 0.0
    speeds = np.array([0.5, 1.0]) * outside
    off = line_speed_errors(profile, job.task, [job.servo], speeds)[0]
    assert (off > job.cut.sync_tolerance).all()
    assert off[0] == pytest.approx(command_error(profile, job.task), rel=0.02)


@pytest.fixture
def benchmark() -> Iterator[ModuleType]:
    """Load the benchmark of many random jobs."""
    sys.path.insert(0, str(BENCHMARKS))
    try:
        spec = importlib.util.spec_from_file_location("speed_bands", BENCHMARKS / "speed_bands.py")
        assert spec is not None
        assert spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        sys.modules["speed_bands"] = module
        spec.loader.exec_module(module)
        yield module
    finally:
        sys.path.remove(str(BENCHMARKS))
        sys.modules.pop("speed_bands", None)


@pytest.mark.slow
def test_random_jobs_judged_anew_in_and_out_of_their_band(benchmark: ModuleType) -> None:
    """Twenty of the two hundred jobs of the benchmark."""
    found = 0
    kinds = list(benchmark.MACHINES)
    for number in range(20):
        rng = np.random.default_rng([3, number])
        cam = next(
            filter(None, (benchmark.designed(rng, kinds[number % len(kinds)], number % 3) for _ in range(20))), None
        )
        if cam is None:
            continue
        judged, wrong = benchmark.wrong_speeds(rng, cam)
        found += judged
        assert not wrong, (cam.band, wrong)
    assert found > 500


def test_a_band_needs_no_job() -> None:
    profile = baseline("cycloid", PAPER.task)
    report = judge(profile, PAPER.task, PAPER.servo)
    assert speed_band(profile, PAPER.task, (PAPER.servo,), report) == job_band(profile, PAPER, report)
