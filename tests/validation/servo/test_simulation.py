"""The lifted servo simulation against a plain loop over the samples, run from standstill in absolute positions."""

from __future__ import annotations

import bisect
import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import RotaryKnife
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import baseline
from camwright.profiles.servo import (
    PAPER_RANGES,
    Servo,
    closed_loop,
    mean_lag,
    sample_plant,
)
from camwright.profiles.task import Task
from camwright.validation.servo.axis_run import hermite
from camwright.validation.servo.lifting import BLOCK, SUBSTEPS, lift, lift_side_by_side, loops_of
from camwright.validation.servo.simulation import (
    PHASES,
    memory,
    simulate,
    simulate_part,
    steady_following_error,
)
from camwright.validation.servo.sweep import sweep_servos

FREE = Limits(math.inf, math.inf, math.inf)
"""Nothing here asks for limits."""

KNIFE = RotaryKnife(0.4)
CUT = Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4)
PAPER = Servo(120.0, 0.7, 35.0, 0.004, 1.0)
ROUNDING = 2e-12
"""What the naive twin may differ by (m): its positions grow over the cycles, and with them their rounding."""


def naive_command(profile: CamProfile, x: float) -> float:
    """Position of the repeated profile at one master position, in plain Python."""
    turns = math.floor((x - profile.start) / profile.length)
    x = min(max(x - turns * profile.length, profile.start), profile.end)
    i = min(max(bisect.bisect_right(profile.breaks, x) - 1, 0), profile.pieces - 1)
    value = 0.0
    for c in reversed(profile.coefficients[i]):
        value = value * (x - profile.breaks[i]) + c
    return float(value + turns * profile.advance)


def naive_axis(
    profile: CamProfile, cut: Cut, servo: Servo, offset: float, samples: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Servo sample by sample from standstill: master, axis and velocity at the substeps of every sample."""
    steps = [sample_plant(servo, servo.sample_time * s / SUBSTEPS) for s in range(SUBSTEPS)]
    whole = sample_plant(servo, servo.sample_time)
    first = naive_command(profile, cut.line_speed * (offset - servo.sample_time - servo.delay))
    state, before = np.array([0.0, 0.0, first]), first
    master, axis, velocity = [], [], []
    for k in range(samples):
        time = offset + k * servo.sample_time
        command = naive_command(profile, cut.line_speed * (time - servo.delay))
        held = servo.position_gain * (command - state[2])
        held += servo.velocity_feedforward * (command - before) / servo.sample_time
        for s, plant in enumerate(steps):
            inner = plant.transition @ state + plant.input * held
            master.append(cut.line_speed * (time + s * servo.sample_time / SUBSTEPS))
            axis.append(inner[2])
            velocity.append(inner[1])
        state, before = whole.transition @ state + whole.input * held, command
    return np.array(master), np.array(axis), np.array(velocity)


@pytest.mark.parametrize("name", ["linear_return", "cycloid"])
@pytest.mark.parametrize("origin", ["return", "cut"])
@pytest.mark.parametrize("feedforward", [0.0, 0.7, 1.0])
def test_simulation_is_the_plain_loop_in_its_later_cycles(name: str, origin: str, feedforward: float) -> None:
    cut = replace(CUT, origin=origin)
    servo = replace(PAPER, velocity_feedforward=feedforward)
    profile = baseline(name, Task(KNIFE, cut, FREE))
    run = simulate(profile, cut, servo)
    cycles = math.ceil((memory(servo) + 30) * servo.sample_time / cut.period)
    for phase in (0, 5, PHASES - 1):
        # clock of this phase, moved back by whole cycles to before the memory of the servo
        first = run.master[phase, 0] + cycles * cut.length
        start = first / cut.line_speed % servo.sample_time
        samples = round((first / cut.line_speed - start) / servo.sample_time) + run.master.shape[1] // SUBSTEPS
        master, axis, velocity = naive_axis(profile, cut, servo, start, samples)
        size = run.master.shape[1]
        assert np.allclose(master[-size:], run.master[phase] + cycles * cut.length, rtol=0, atol=1e-12)
        assert np.abs(axis[-size:] - cycles * profile.advance - run.axis[phase]).max() <= ROUNDING
        assert np.abs(velocity[-size:] / cut.line_speed - run.axis_ratio[phase]).max() <= 1e-9
        command = [naive_command(profile, x) for x in run.master[phase]]
        assert np.abs(command - run.command[phase]).max() <= ROUNDING


def test_a_continuous_run_over_many_cycles_passes_through_the_phases_of_the_simulation() -> None:
    # 0.45 s a cycle, 4 ms a sample: 112.5 samples, so two phases alternate, half a sample apart
    profile = baseline("poly_3_4_5", Task(KNIFE, CUT, FREE))
    run = simulate(profile, CUT, PAPER)
    master, axis, _ = naive_axis(profile, CUT, PAPER, 0.0, 112 * 8)
    for phase, cycles in ((0, (4, 6)), (PHASES // 2, (3, 5))):
        for cycle in cycles:
            at = run.master[phase] + cycle * CUT.length
            nearest = np.searchsorted(master, at - 1e-9)
            assert np.abs(master[nearest] - at).max() < 1e-9
            assert np.abs(axis[nearest] - cycle * profile.advance - run.axis[phase]).max() <= ROUNDING


@settings(deadline=None, max_examples=25)
@given(
    st.floats(80.0, 150.0),
    st.floats(0.7, 0.9),
    st.floats(20.0, 50.0),
    st.floats(2e-3, 8e-3),
    st.floats(0.0, 1.2),
    st.floats(0.31, 1.1),
    st.floats(0.3, 3.0),
)
def test_simulation_is_the_plain_loop_for_any_servo_and_cut(
    bandwidth: float, damping: float, gain: float, sample_time: float, feedforward: float, length: float, speed: float
) -> None:
    servo = Servo(bandwidth, damping, gain, sample_time, feedforward)
    cut = replace(CUT, length=length, line_speed=speed)
    profile = baseline("modified_sine", Task(KNIFE, cut, FREE))
    run = simulate(profile, cut, servo)
    cycles = math.ceil((memory(servo) + 30) * sample_time / cut.period)
    first = run.master[3, 0] + cycles * length
    start = first / speed % sample_time
    samples = round((first / speed - start) / sample_time) + run.master.shape[1] // SUBSTEPS
    _, axis, _ = naive_axis(profile, cut, servo, start, samples)
    assert np.abs(axis[-run.master.shape[1] :] - cycles * profile.advance - run.axis[3]).max() <= 1e-11


@pytest.mark.parametrize(
    ("dead_time", "lead_time"),
    [(0.002, 0.0), (0.0, 0.0031), (0.0137, 0.002), (1.2345, 0.0), (0.45, 0.0), (1e-9, 0.0)],  # 0.45 s is a cycle
)
def test_a_delayed_command_is_that_of_the_plain_loop(dead_time: float, lead_time: float) -> None:
    servo = replace(PAPER, velocity_feedforward=0.6, dead_time=dead_time, lead_time=lead_time)
    profile = baseline("modified_sine", Task(KNIFE, CUT, FREE))
    run, prompt = (simulate(profile, CUT, each) for each in (servo, servo.loop))
    assert np.array_equal(run.master, prompt.master)
    assert np.array_equal(run.command, prompt.command)
    cycles = math.ceil((memory(servo) + 30) * servo.sample_time / CUT.period) + 3
    first = run.master[5, 0] + cycles * CUT.length
    start = first / CUT.line_speed % servo.sample_time
    size = run.master.shape[1]
    samples = round((first / CUT.line_speed - start) / servo.sample_time) + size // SUBSTEPS
    _, axis, velocity = naive_axis(profile, CUT, servo, start, samples)
    assert np.abs(axis[-size:] - cycles * profile.advance - run.axis[5]).max() <= 2 * ROUNDING
    assert np.abs(velocity[-size:] / CUT.line_speed - run.axis_ratio[5]).max() <= 1e-9


def test_lead_makes_up_for_dead_time() -> None:
    profile = baseline("cycloid", Task(KNIFE, CUT, FREE))
    prompt = simulate(profile, CUT, PAPER)
    led = simulate(profile, CUT, replace(PAPER, dead_time=0.0125, lead_time=0.0125))
    assert np.array_equal(led.axis, prompt.axis)
    late = simulate(profile, CUT, replace(PAPER, dead_time=0.0125, lead_time=0.0025))
    assert np.abs(late.axis - simulate(profile, CUT, replace(PAPER, dead_time=0.01)).axis).max() <= 1e-14


def test_dead_time_in_whole_samples_only_moves_the_axis_later() -> None:
    # the loop does not know: three samples later it is where it would have been
    profile = baseline("cycloid", Task(KNIFE, CUT, FREE))
    prompt, late = (simulate(profile, CUT, replace(PAPER, dead_time=n * PAPER.sample_time)) for n in (0, 3))
    assert np.abs(late.axis[:, 3 * SUBSTEPS :] - prompt.axis[:, : -3 * SUBSTEPS]).max() <= 1e-12


def test_the_matrices_do_not_depend_on_dead_time_and_lead() -> None:
    profile = baseline("cycloid", Task(KNIFE, CUT, FREE))
    simulate(profile, CUT, PAPER)
    before = lift.cache_info().misses, memory.cache_info().misses
    simulate(profile, CUT, replace(PAPER, dead_time=0.00321, lead_time=0.001))
    assert (lift.cache_info().misses, memory.cache_info().misses) == before


def test_phases_are_equally_spaced_and_cover_the_cycle() -> None:
    run = simulate(baseline("linear_return", Task(KNIFE, CUT, FREE)), CUT, PAPER)
    sample = CUT.line_speed * PAPER.sample_time
    assert run.phases == PHASES
    assert np.allclose(np.diff(run.master[:, 0]), sample / PHASES, rtol=1e-9)
    assert np.allclose(np.diff(run.master, axis=1), sample / SUBSTEPS, rtol=1e-9)
    assert run.master[:, 0].max() < CUT.return_start
    assert run.master[:, -1].min() >= CUT.return_start + CUT.length


@pytest.mark.parametrize("feedforward", [0.0, 0.4, 0.9, 1.1])
@pytest.mark.parametrize("delay", [0.0, 0.0062])
def test_steady_following_error_is_that_of_the_loop(feedforward: float, delay: float) -> None:
    # eqs. 1 and 2, by the plain loop at constant speed and by the end of a long linear return
    servo = replace(PAPER, velocity_feedforward=feedforward, dead_time=delay + 0.001, lead_time=0.001)
    line = CamProfile.from_arrays([0.0, 0.6], [[0.0, 1.0]])
    master, axis, _ = naive_axis(line, CUT, servo, 0.0, 400)
    expected = (1 - feedforward) * CUT.line_speed / servo.position_gain + CUT.line_speed * delay
    assert steady_following_error(CUT.line_speed, servo) == pytest.approx(expected, rel=1e-14)
    assert CUT.line_speed * (mean_lag(servo) - servo.lead_time) == pytest.approx(expected, rel=1e-14)
    assert master[-1] - axis[-1] == pytest.approx(expected, rel=1e-6)

    long = replace(CUT, length=3.0)
    run = simulate(baseline("linear_return", Task(KNIFE, long, FREE)), long, servo)
    ratio = 0.2 / 2.8
    x, axis, _ = run.window(2.79, 2.79)
    assert ratio * x - axis == pytest.approx(steady_following_error(ratio * CUT.line_speed, servo), rel=1e-6)


def test_steady_following_error_without_feedforward_is_speed_over_gain() -> None:
    assert steady_following_error(1.4, replace(PAPER, velocity_feedforward=0.0)) == pytest.approx(1.4 / 35, rel=1e-15)


def test_a_profile_and_its_position_offset_move_the_axis_alike() -> None:
    profile = baseline("cycloid", Task(KNIFE, CUT, FREE))
    here, there = simulate(profile, CUT, PAPER), simulate(profile.shift(0.0, 5.0), CUT, PAPER)
    assert np.allclose(there.axis, here.axis + 5.0, rtol=0, atol=1e-13)
    assert np.allclose(there.command, here.command + 5.0, rtol=0, atol=1e-13)


def test_many_pieces_shorter_than_the_grid_change_nothing() -> None:
    # the same curve cut into 5000 pieces: many between two points, none of some pieces among the points
    profile = baseline("poly_3_4_5", Task(KNIFE, CUT, FREE))
    edges = np.union1d(np.linspace(0.0, CUT.length, 5001), profile.breaks)
    edges = np.append(edges[:-1][np.diff(edges) > 1e-9], CUT.length)
    pieces = [profile.restrict(a, b).coefficients[0] for a, b in pairwise(edges)]
    fine = CamProfile.from_arrays(edges, pieces)
    here, there = simulate(profile, CUT, PAPER), simulate(fine, CUT, PAPER)
    assert np.abs(here.axis - there.axis).max() <= 1e-14
    assert np.abs(here.command - there.command).max() <= 1e-14


def test_window_has_its_ends_and_lies_on_the_axis() -> None:
    profile = baseline("linear_return", Task(KNIFE, CUT, FREE))
    run = simulate(profile, CUT, PAPER)
    start, end = 0.40013, 0.59977
    master, axis, ratio = run.window(start, end)
    assert np.array_equal(master[:, 0], np.full(PHASES, start))
    assert np.array_equal(master[:, -1], np.full(PHASES, end))
    assert (np.diff(master, axis=1) >= 0).all()
    step = run.master[0, 1] - run.master[0, 0]
    for phase in (0, 7):
        near = int(np.searchsorted(run.master[phase], start))
        part = np.array((start - run.master[phase, near - 1]) / step)
        points = slice(near - 1, near + 1)
        expected = hermite(part, step, tuple(run.axis[phase, points]), tuple(run.axis_ratio[phase, points]))
        assert (axis[phase, 0], ratio[phase, 0]) == pytest.approx(expected, rel=1e-13)


def test_the_cubic_between_two_points_is_the_axis() -> None:
    # over twice the step, inside one sample, it meets the point between; the error grows with step^4
    run = simulate(baseline("linear_return", Task(KNIFE, CUT, FREE)), CUT, PAPER)
    step = run.master[0, 1] - run.master[0, 0]
    middle = np.array([i for i in range(1, run.master.shape[1] - 1) if i % SUBSTEPS])
    ends, slopes = ((a[:, middle - 1], a[:, middle + 1]) for a in (run.axis, run.axis_ratio))
    error = hermite(np.array(0.5), 2 * step, ends, slopes)[0] - run.axis[:, middle]
    assert np.abs(error).max() / 16 < 1e-9


def test_window_of_no_length_is_its_point() -> None:
    run = simulate(baseline("linear_return", Task(KNIFE, CUT, FREE)), CUT, PAPER)
    master, axis, _ = run.window(0.5, 0.5)
    assert (master == 0.5).all()
    assert np.abs(axis - axis[:, :1]).max() == 0.0


def test_hermite_reproduces_a_cubic_and_its_slope() -> None:
    cubic = np.polynomial.Polynomial([0.3, -1.0, 2.0, 0.7])
    step, left, part = 0.4, 0.2, np.linspace(0.0, 1.0, 7)
    ends = (np.array(cubic(left)), np.array(cubic(left + step)))
    slopes = (np.array(cubic.deriv()(left)), np.array(cubic.deriv()(left + step)))
    value, slope = hermite(part, step, ends, slopes)
    assert np.allclose(value, cubic(left + part * step), rtol=1e-13)
    assert np.allclose(slope, cubic.deriv()(left + part * step), rtol=1e-12, atol=1e-13)


@pytest.mark.parametrize("servo", sweep_servos(PAPER), ids=str)
def test_what_the_memory_leaves_out_is_below_rounding(servo: Servo) -> None:
    a, past = closed_loop(servo)[0], memory(servo)
    state, left_out = sample_plant(servo, servo.sample_time).input, 0.0
    for k in range(2 * past):
        if k >= past:
            left_out += abs(state[2])
        state = a @ state
    # a command of size 1 makes an input of at most K + 2 alpha / dT
    assert left_out * (servo.position_gain + 2 / servo.sample_time) <= 1e-12


def test_ranges_hold_the_servo_of_the_paper() -> None:
    assert all(low <= getattr(PAPER, name) <= high for name, (low, high) in PAPER_RANGES.items())


def test_an_unstable_servo_is_refused_with_its_pole() -> None:
    unstable = replace(PAPER, position_gain=200.0)
    with pytest.raises(
        InputError, match=r"servo is unstable: .* magnitude 1\.\d+, the limit is 1; lower the position gain"
    ):
        simulate(baseline("linear_return", Task(KNIFE, CUT, FREE)), CUT, unstable)


def test_a_servo_that_hardly_forgets_is_refused() -> None:
    with pytest.raises(
        InputError, match=r"remembers \d+ samples .* cannot follow; raise the position gain \(0\.01 1/s\)"
    ):
        simulate(baseline("linear_return", Task(KNIFE, CUT, FREE)), CUT, replace(PAPER, position_gain=0.01))


def test_long_cycles_take_fewer_phases_and_stay_right() -> None:
    slow = replace(CUT, line_speed=CUT.line_speed / 100)
    profile = baseline("linear_return", Task(KNIFE, slow, FREE))
    run = simulate(profile, slow, PAPER)
    assert run.phases == SUBSTEPS
    assert not run.even
    step = slow.line_speed * PAPER.sample_time / SUBSTEPS
    shown = np.nonzero(np.abs(run.master[3] - slow.sync_start) < 500 * SUBSTEPS * step)[
        0
    ]  # before the sync zone, and in it
    first = run.master[3, shown[0]] / slow.line_speed - memory(PAPER) * PAPER.sample_time
    _, axis, _ = naive_axis(profile, slow, PAPER, first, memory(PAPER) + 1001)
    places = memory(PAPER) * SUBSTEPS + np.rint((run.master[3, shown] - run.master[3, shown[0]]) / step).astype(int)
    assert len(shown) > 200
    assert np.abs(axis[places] - run.axis[3, shown]).max() <= ROUNDING


def test_a_profile_of_another_cut_is_refused() -> None:
    with pytest.raises(InputError, match=r"0\.6 m, but one cycle of this cut runs from 0 m to the cut length 0\.5 m"):
        simulate(baseline("linear_return", Task(KNIFE, CUT, FREE)), replace(CUT, length=0.5), PAPER)


@pytest.mark.parametrize("size", [1, 2, BLOCK])
def test_servos_side_by_side_are_each_by_itself_in_any_part_and_block(size: int) -> None:
    profile = baseline("cycloid", Task(KNIFE, CUT, FREE))
    servos = [PAPER, replace(PAPER, sample_time=0.0031, dead_time=0.002), replace(PAPER, velocity_feedforward=0.4)]
    past = max(memory(servo.loop) for servo in servos)
    lifted = lift_side_by_side(loops_of(servos), past, (2, 0, 1), size)
    part = (0.07, 0.31)
    master, found = simulate_part(profile, CUT, servos, lifted, part)
    assert found.shape == (3, len(servos) * PHASES, master.shape[1])
    assert (master[:, 0] <= part[0]).all()
    assert (master[:, -1] >= part[1]).all()
    for n, servo in enumerate(servos):
        run = simulate(profile, CUT, servo)
        for row in range(n * PHASES, (n + 1) * PHASES):
            inside = (master[row] >= part[0]) & (master[row] <= part[1])
            phase = row - n * PHASES
            at = np.searchsorted(run.master[phase], master[row, inside] - 1e-9)
            assert np.abs(run.master[phase, at] - master[row, inside]).max() <= 1e-12
            assert np.abs(run.axis[phase, at] - found[1, row, inside]).max() <= ROUNDING
            assert np.abs(run.axis_ratio[phase, at] - found[2, row, inside]).max() <= 1e-11
        # the acceleration is the derivative of the velocity, whose second derivative within a sample is bounded
        steps = master[n * PHASES, 1] - master[n * PHASES, 0]
        ratio, slope = found[2, n * PHASES], found[0, n * PHASES]
        within = np.arange(len(ratio) - 1) % SUBSTEPS < SUBSTEPS - 1
        rise = (np.diff(ratio) / steps)[within]
        assert np.abs(rise - 0.5 * (slope[1:] + slope[:-1])[within]).max() <= 2e-3 * np.abs(slope).max()


def test_parts_of_a_sample_that_are_no_power_of_two() -> None:
    three, six = loops_of([PAPER], 3), loops_of([PAPER], 6)
    assert np.allclose(three.held, six.held[:, ::2], rtol=1e-13, atol=1e-15)
    assert np.allclose(three.closed(), closed_loop(PAPER)[0], rtol=1e-13, atol=1e-15)
