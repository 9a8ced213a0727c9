"""Ramps of all machines: the paper's check values, limits kept, refusals with what works."""

import math
from dataclasses import replace

import pytest

from camwright.design.production.ramp_refusal import refused
from camwright.design.production.ramps import (
    balanced,
    can_stand,
    can_start_and_stop,
    highest_that_works,
    least_arcs,
    ramp_in,
    ramp_out,
    zone_kept,
)
from camwright.jobs.examples import example
from camwright.jobs.job import load_job
from camwright.profiles.cut import Cut
from camwright.profiles.limits import Limits
from camwright.profiles.machines import CrankSlider, LinearCarriage, RotaryKnife
from camwright.profiles.motor import MotorCurve
from camwright.profiles.ramp import Stand, stand
from camwright.profiles.task import Task

PAPER = load_job().task
AIMS = ("peak_acceleration", "rms_acceleration", "shortest")
HORIZONTAL = load_job(example("thick-product").path).task
SAW = load_job(example("flying-saw").path).task
CRANK = Task(
    CrankSlider(0.15, 0.6, 0.02, sync_at=1.7), Cut(0.9, 0.5, 0.15, 0.04, 0.08, 2.5e-4), Limits(10 * math.pi, 400.0, 2e4)
)
MACHINES = {"paper": PAPER, "horizontal": HORIZONTAL, "saw": SAW, "crank": CRANK}


def at(task: Task, park: float | None = None) -> Stand:
    """Put a task beside its best park, or a given one."""
    return balanced(stand(task)) if park is None else stand(task, park=park)


def test_the_machine_of_the_paper() -> None:
    there = at(PAPER)
    start, stop = ramp_in(there, "peak_acceleration"), ramp_out(there, "peak_acceleration")
    for ramp in (start, stop):
        assert (ramp.arc, ramp.master, ramp.time) == pytest.approx((0.1, 0.2, 0.15), rel=1e-12)
        assert ramp.peak_acceleration == pytest.approx(9.07177, abs=1e-5)
    assert there.park == pytest.approx(-0.2)
    least = least_arcs(there).run_up
    assert (least.arc * 1e3, least.master * 1e3) == pytest.approx((36.296, 72.593), abs=1e-3)
    assert highest_that_works(there, can_stand) * 60 == pytest.approx(138.24, abs=5e-3)


def test_standstill_is_the_time_to_reach_the_speed() -> None:
    """A knife stands between two cuts as long as v t_a(v) <= H."""
    v = highest_that_works(at(PAPER), can_stand)
    assert v * (v / 30.0 + 30.0 / 3000.0) == pytest.approx(PAPER.height, rel=1e-9)


@pytest.mark.parametrize("aim", AIMS)
@pytest.mark.parametrize("name", MACHINES)
def test_ramps_meet_their_ends_and_keep_the_limits(name: str, aim: str) -> None:
    task = MACHINES[name]
    there, v, limits = at(task), task.cut.line_speed, task.limits
    start, stop = ramp_in(there, aim), ramp_out(there, aim)
    for ramp, way in ((start, there.run_up), (stop, there.run_out)):
        cam = ramp.profile
        assert cam.start == 0.0
        assert cam.advance == pytest.approx(way, rel=1e-9)
        peaks = [cam.peak(order) * v**order for order in (1, 2, 3)]
        for found, limit in zip(peaks, (limits.speed, limits.acceleration, limits.jerk), strict=True):
            assert found <= limit * (1 + 1e-9)
        if ramp is start or not task.machine.turns_back:
            assert cam.extrema(1)[0].value >= -1e-9 * start.profile.extrema(1)[1].value  # never backwards
    zone, end = there.zone, start.profile.end
    for order in (1, 2):
        size = start.profile.peak(order)
        assert float(start.profile(end, order, side="left")) == pytest.approx(
            float(zone(zone.start, order)), abs=1e-8 * size
        )
        assert float(stop.profile(0.0, order)) == pytest.approx(float(zone(zone.end, order)), abs=1e-8 * size)
        for rest in (start.profile(0.0, order), stop.profile(stop.profile.end, order, side="left")):
            assert abs(float(rest)) <= (1e-8 if order == 1 else 2e-8) * size


@pytest.mark.parametrize("name", MACHINES)
def test_each_aim_is_the_best_at_it(name: str) -> None:
    there = at(MACHINES[name])
    start = {aim: ramp_in(there, aim) for aim in AIMS}
    assert start["peak_acceleration"].peak_acceleration <= min(ramp.peak_acceleration for ramp in start.values()) * (
        1 + 1e-9
    )
    assert start["rms_acceleration"].heat <= min(ramp.heat for ramp in start.values()) * (1 + 1e-9)
    assert start["shortest"].master <= min(ramp.master for ramp in start.values()) * (1 + 1e-9)


def test_a_carriage_waits_at_home_and_stays_on_its_guide() -> None:
    there = at(SAW)
    assert there.park == SAW.machine.home
    stop = ramp_out(there, "peak_acceleration").profile
    assert there.zone_end + stop.extrema(0)[1].value <= SAW.machine.guide[1] * (1 + 1e-9)
    assert there.zone_end + stop.extrema(0)[0].value >= SAW.machine.guide[0] - 1e-9


def test_start_and_stop_of_a_crank_need_the_same_limit() -> None:
    there = at(CRANK)
    limits = CRANK.limits
    eased = CRANK.with_limits(replace(limits, acceleration=0.9 * limits.acceleration))
    assert least_arcs(at(eased)).whole <= there.run_up + there.run_out
    peaks = [ramp(there, "peak_acceleration").peak_acceleration for ramp in (ramp_in, ramp_out)]
    moved = [stand(CRANK, park=there.park + shift) for shift in (-0.3, 0.3)]
    assert max(peaks) <= min(
        max(ramp(other, "peak_acceleration").peak_acceleration for ramp in (ramp_in, ramp_out)) for other in moved
    )


def test_a_park_any_pitch_off_is_the_same() -> None:
    assert stand(PAPER, park=0.2).park == pytest.approx(-0.2)
    assert stand(PAPER, park=-1.0).park == pytest.approx(-0.2)


def test_a_motor_that_is_weak_makes_the_start_gentler_or_impossible() -> None:
    knife = RotaryKnife(0.4, drum_inertia=0.05)
    inertia = 0.05 / knife.radius**2
    force = 10.0 * inertia  # enough for 10 m/s²
    curve = MotorCurve(((0.0, force / knife.motor_ratio), (1000.0, force / knife.motor_ratio)))
    weak = Task(knife, PAPER.cut, replace(PAPER.limits, motor=curve))
    assert ramp_in(at(weak), "shortest").peak_acceleration == pytest.approx(10.0, rel=1e-9)
    weaker = MotorCurve(((0.0, 0.8 * force / knife.motor_ratio), (1000.0, 0.8 * force / knife.motor_ratio)))
    assert ramp_in(at(Task(knife, PAPER.cut, replace(PAPER.limits, motor=weaker))), "peak_acceleration") is None


def reason(there: Stand, *, free: bool = False) -> tuple[str, dict[str, float]]:
    """Why a start cannot be, and what is said to work."""
    error = refused(there, free=free)
    for suggestion in error.suggestions:  # each is tried here once more
        if suggestion.change == "park":
            size = 1e3 if there.task.machine.slave_unit == "m" else math.degrees(1.0)
            assert can_start_and_stop(there.parked_at(suggestion.value / size))
        else:
            assert (can_stand if free else can_start_and_stop)(there.at_speed(suggestion.value / 60))
    return str(error), {suggestion.change: suggestion.value for suggestion in error.suggestions}


def test_too_late_a_park_is_refused_with_an_earlier_one_and_a_slower_line() -> None:
    there = at(PAPER, -0.1 - 0.9 * 0.036296296)
    assert ramp_in(there, "peak_acceleration") is None
    words, ways = reason(there)
    assert "backing up first would do, but a ramp never runs backwards" in words
    assert "needs 0.0362963 m" in words
    assert ways["park"] == pytest.approx(-136.297, abs=1e-3)
    assert 70.0 < ways["line_speed"] < 80.0


def test_too_early_a_park_leaves_no_way_to_stop() -> None:
    there = at(PAPER, 0.1 + 0.5 * 0.0363)
    assert ramp_out(there, "peak_acceleration") is None
    words, ways = reason(there)
    assert "stops" in words
    assert ways["park"] == pytest.approx(-263.703, abs=1e-3)


def test_a_park_in_the_sync_zone_is_refused_as_one() -> None:
    words, ways = reason(at(PAPER, -0.05))
    assert "--park: the knife stands at -0.05 m, in the sync zone from -0.1 m to 0.1 m" in words
    assert "park earlier" in words  # 86 mm back, not 186 mm on
    assert ways["park"] == pytest.approx(-136.297, abs=1e-3)
    words, ways = reason(at(PAPER, 0.02))
    assert "the knife stands at 0.02 m" in words
    assert "park later" in words
    assert ways["park"] == pytest.approx(-263.703, abs=1e-3)


def test_a_carriage_stands_before_its_sync_zone() -> None:
    there = at(SAW, 5.0)
    words, ways = reason(there)
    assert (
        f"the carriage stands at 5 m, and must stand before the sync zone, which begins at {there.zone_start:.6g} m"
        in words
    )
    assert can_start_and_stop(there.parked_at(ways["park"] / 1e3))


def test_too_fast_a_line_leaves_no_park() -> None:
    there = at(PAPER.at_speed(150 / 60))
    words, ways = reason(there, free=True)
    assert ways == {"line_speed": pytest.approx(138.24)}
    assert "0.1 m before the sync zone" in words


def test_a_line_faster_than_the_slave_is_refused_by_its_zone() -> None:
    there = at(PAPER.at_speed(250 / 60))
    assert not zone_kept(there)
    words, ways = reason(there, free=True)
    assert "the sync zone itself breaks a limit" in words
    assert ways == {"line_speed": pytest.approx(138.24)}


def test_a_carriage_that_cannot_turn_is_refused() -> None:
    short = Task(LinearCarriage(0.9), replace(SAW.cut, line_speed=1.2), SAW.limits)
    words, _ = reason(at(short), free=True)
    assert "before the sync zone" in words
    roomy = Stand(short, at(short).zone.shift(slave=0.09), 0.0)  # all the room before the zone, little beyond
    words, ways = reason(roomy)
    assert "cannot turn within it" in words
    assert ways["line_speed"] < 72.0


def test_what_no_speed_and_no_park_would_help_says_so() -> None:
    words, ways = reason(at(PAPER.at_speed(150 / 60), 0.02))  # in the sync zone, and too fast for any park
    assert "No park and no line speed that was tried works" in words
    assert ways == {}
