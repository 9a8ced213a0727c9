"""Bounds of the motor's objectives: closed forms, other roads, and no motion that goes below."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid

from camwright.design.optimise import solve
from camwright.profiles.cut import Cut
from camwright.profiles.limits import Limits
from camwright.profiles.machines import CrankSlider, LinearCarriage, RotaryKnife
from camwright.profiles.machines.machine import Machine
from camwright.profiles.objective import MotorObjective
from camwright.profiles.returns import assemble, quintic_between
from camwright.profiles.task import Task
from camwright.validation.bounds import constant_inertia
from camwright.validation.bounds.motor_bound import STANDING, ZONE
from camwright.validation.bounds.optimality import lower_bound
from camwright.validation.bounds.path_convex import least_square_in_time
from camwright.validation.bounds.path_dual import (
    least_drawn,
    least_square,
    no_motion_below,
    square_tube,
    standing_square,
    turning_peak,
    turning_square,
)
from camwright.validation.bounds.path_limits import least_square_limited
from camwright.validation.bounds.path_task import PathTask
from camwright.validation.bounds.path_tubes import Kind, least_in_tubes
from camwright.validation.bounds.path_turns import Around, turning_peak_around, turning_square_around
from camwright.validation.motor import measure_motor

CRANK = CrankSlider(
    crank=0.15, rod=0.6, crank_inertia=0.6, carriage_mass=60.0, gear_ratio=10.0, sync_at=math.radians(98)
)
TURNS = Limits(31.4, 400.0, 20_000.0)
SHEAR = Cut(0.9, 0.5, 0.15, 0.04, 0.08, 2e-4)
KNIFE = RotaryKnife(circumference=0.52, drum_inertia=0.02, drum_friction=9.0, gear_ratio=3.0)
KNIVES = Limits(4.4, 60.0, 6000.0)
SHEET = Cut(2.1, 1.1, 0.13, 0.02, 0.05, 1e-4)
SAW = LinearCarriage(stroke=2.0, mass=280.0)
BARS = Cut(12.0, 1.5, 1.0, 0.1, 0.5, 1e-3)
EVEN = PathTask(np.full(501, 2.0), 6.0, (3.0, 3.0), 1.0, 100.0)


def test_in_a_short_time_the_bound_is_the_cubic_of_constant_inertia() -> None:
    """Over the straight line the way is 6 - 3 from rest to rest: 12 h² / T³, times the inertia squared."""
    assert least_square_in_time(EVEN) == pytest.approx(4.0 * 12 * 9.0, rel=3e-4)


def test_a_long_time_costs_nothing_there() -> None:
    assert least_square_in_time(replace(EVEN, time=5.0)) < 1e-3


def test_a_speed_limit_raises_it() -> None:
    fast = least_square_in_time(replace(EVEN, time=1.2, greatest=5.6))
    assert fast > 1.05 * least_square_in_time(replace(EVEN, time=1.2))


def test_standing_costs_two_stops_in_their_best_times() -> None:
    way = np.linspace(0.01, 5.99, 4001)
    stops = 4.0 * 4 / 9 * 27.0 * (1 / way + 1 / (6.0 - way))  # of each 4 v³ / 9 d, with the time 3 d / v
    assert standing_square(EVEN) == pytest.approx(stops.min(), rel=1e-4)


def test_where_time_is_to_be_wasted_the_value_function_sees_it() -> None:
    """Slower over the straight line: 12 h² / T³ again, as long as the motion is slow nowhere."""
    slow = replace(EVEN, time=2.4)
    exact = 4.0 * 12 * (6.0 - 7.2) ** 2 / 2.4**3
    assert 0.95 * exact < least_square(slow, 1.02 * exact) <= exact * (1 + 1e-9)
    assert least_square_in_time(slow) < 0.01 * exact


def test_a_tube_holds_the_motions_below_its_level_and_no_others() -> None:
    tube = square_tube(EVEN, 400.0)
    assert tube.low[0] == tube.high[0] == pytest.approx(9.0)
    middle = len(tube.low) // 2
    cost = standing_square(replace(EVEN, speeds=(3.0, 3.0)))
    assert tube.low[middle] == 0.0
    assert cost < 400.0


def test_energy_of_a_slave_that_must_slow_down_is_what_it_takes_to_be_fast_again() -> None:
    slow = replace(EVEN, time=3.0)  # at 2 m/s on the way, without limits of the acceleration
    exact = 9.0 - 4.0
    found = least_drawn(slow, 1.05 * exact)
    assert 0.9 * exact < found <= exact * (1 + 1e-9)


def test_energy_with_friction_is_what_braking_first_and_rolling_on_leaves_to_be_drawn() -> None:
    """Nothing wastes more time than the kinetic energy ``g - F q`` all the way: rolling, ``T = (I / F) (u - w)``, and then a jump."""
    inertia, friction, way, first = 2.0, 1.0, 6.0, 2.6
    last = math.sqrt(first**2 - 2 * friction * way / inertia)
    rubs = replace(EVEN, friction=friction, time=inertia / friction * (first - last))
    exact = 9.0 - 0.5 * inertia * last**2
    assert exact > friction * way
    found = least_drawn(rubs, 1.03 * exact)
    assert 0.95 * exact < found <= exact * (1 + 1e-9)
    assert least_drawn(replace(rubs, time=2.4), 6.3) == pytest.approx(
        friction * way, rel=5e-3
    )  # it rolls to less than that


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(1, 20))])
def test_no_motion_that_rubs_draws_less_than_its_bound(seed: int) -> None:
    """Random motions of a random inertia in time, their torque by its formula; the level is a little above the motion, or far."""
    _, t, q, u, a = _jerky(seed)
    wave, size, friction = 2 * np.pi / q[-1], 0.8 * (seed % 4) / 3, float(np.abs(a).max()) * (0.1 + 0.2 * (seed % 3))
    inertia = 1.0 + size * np.sin(wave * np.linspace(0.0, q[-1], 2001))
    path = PathTask(inertia, float(q[-1]), (u[0], u[-1]), 1.0, float(u.max()), friction=friction)
    torque = (1.0 + size * np.sin(wave * q)) * a + size * wave * np.cos(wave * q) * u**2 / 2 + friction
    power = float(np.trapezoid(np.maximum(torque * u, 0.0), t))
    assert least_drawn(path, (1.02 + 0.3 * (seed % 2)) * power) <= power * (1 + 1e-6)


def test_the_energy_of_a_knife_in_horizontal_sync_that_rubs_is_bounded() -> None:
    knife = replace(KNIFE, sync="horizontal", drum_friction=2.0)
    value, bound, _ = _checked(knife, replace(SHEET, length=0.9), KNIVES, "energy")
    assert bound > 0.9 * value


def test_a_peak_below_what_the_way_asks_is_proved_to_be_too_low() -> None:
    """Slower over the straight line: two even torques, h = a T² / 4."""
    slow = replace(EVEN, time=2.4)
    exact = 2.0 * 4 * 1.2 / 2.4**2
    assert no_motion_below(slow, 0.9 * exact)
    assert not no_motion_below(slow, 1.01 * exact)


def _checked(machine: Machine, cut: Cut, limits: Limits, objective: MotorObjective) -> tuple[float, float, str]:
    task = Task(machine, cut, limits)
    solution = solve(task, objective)
    value = getattr(measure_motor(solution.profile, task), objective)
    bound = lower_bound(solution.profile, task, objective)
    quintic = assemble(quintic_between(task.sync, cut.return_zone, task.height), task)
    anybody = getattr(measure_motor(quintic, task), objective)
    assert bound.value <= value * (1 + 1e-9)
    if quintic.extrema(1)[0].value >= 0 and quintic.extrema(1)[1].value <= task.greatest_ratio:
        assert lower_bound(quintic, task, objective).value <= min(value, anybody) * (1 + 1e-9)
    return float(value), bound.value, bound.method


@pytest.mark.parametrize("objective", ["rms_torque", "energy"])
@pytest.mark.parametrize("length", [0.5, 0.9, 2.0])
def test_the_shear_is_within_a_few_per_cent_of_its_bound(objective: MotorObjective, length: float) -> None:
    value, bound, _ = _checked(CRANK, replace(SHEAR, length=length), TURNS, objective)
    assert bound > 0.94 * value


def test_a_long_cut_of_the_shear_is_bounded_by_standing() -> None:
    value, bound, method = _checked(CRANK, replace(SHEAR, length=12.0), TURNS, "rms_torque")
    assert bound > 0.94 * value
    assert method == STANDING


def test_where_the_zone_is_the_peak_it_is_the_bound_and_named() -> None:
    value, bound, method = _checked(CRANK, replace(SHEAR, length=3.0), TURNS, "peak_torque")
    assert method == ZONE
    assert value == pytest.approx(bound, rel=1e-3)


@pytest.mark.parametrize("objective", ["rms_torque", "peak_torque", "energy"])
@pytest.mark.parametrize("length", [0.3, 0.9, 2.1])
def test_a_knife_that_rubs(objective: MotorObjective, length: float) -> None:
    value, bound, _ = _checked(KNIFE, replace(SHEET, length=length), KNIVES, objective)
    assert bound > 0.8 * value


def test_a_carriage_that_goes_back_slowly_is_proved_to_be_best() -> None:
    value, bound, _ = _checked(SAW, BARS, Limits(8.0, 3.0, 600.0), "energy")
    assert bound == pytest.approx(value, rel=1e-4)


def test_the_speed_that_every_return_must_have() -> None:
    """Without limits of acceleration and jerk the slave moves at the mean speed of its return."""
    task = Task(replace(KNIFE, drum_friction=0.0), SHEET, Limits(4.4, 1e9, 1e15))
    assert constant_inertia.farthest_speed(task) == pytest.approx(0.39 / (1.97 / 1.1), rel=1e-3)


def test_a_force_with_friction_is_that_of_uneven_accelerations() -> None:
    """Triangle of the speed over the line: 1/a⁺ + 1/a⁻ = T² / 2h."""
    knife = replace(KNIFE, drum_friction=2.0)
    task = Task(knife, replace(SHEET, length=0.9), Limits(100.0, 1e9, 1e15))
    force = constant_inertia.peak_with_friction(task)
    inertia, friction = float(knife.inertia(0.0)), knife.friction
    time, height = 0.77 / 1.1, 0.77 - 0.39
    slow, fast = (force - friction) / inertia, (force + friction) / inertia
    assert 1 / slow + 1 / fast == pytest.approx(time**2 / (2 * height), rel=1e-6)


def _inertia(q: np.ndarray) -> np.ndarray:
    return np.asarray(0.8 + 0.5 * np.sin(3.0 * q))


@pytest.mark.parametrize("seed", range(12))
def test_no_motion_that_turns_goes_below_its_bounds(seed: int) -> None:
    """Random motions in time, their torque by differences; those that turn must lie above both bounds."""
    rng = np.random.default_rng(seed)
    time = float(rng.uniform(0.5, 3.0))
    t = np.linspace(0.0, time, 20_001)
    turned = 0
    for _ in range(40):
        first, last = rng.uniform(0.1, 3.0, 2)
        u = first + (last - first) * t / time
        for k in range(1, 4):
            u = u + rng.normal() * 2.0 * np.sin(k * np.pi * t / time)
        q = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(t) * (u[1:] + u[:-1]))])
        if u.min() >= 0.0 or q[-1] <= 0.0:
            continue
        turned += 1
        path = PathTask(_inertia(np.linspace(0.0, q[-1], 4001)), float(q[-1]), (first, last), time, float(u.max()))
        torque = _inertia(q) * np.gradient(u, t) + 1.5 * np.cos(3.0 * q) * u**2 / 2
        around = np.array([0.3, 1.3])
        square = float(np.trapezoid(torque**2, t))
        assert square >= turning_square(path, around)
        if turned == 1 and seed < 2:
            pitch = np.linspace(0.0, 2 * np.pi / 3.0, 2001)
            ways = Around(_inertia(pitch), _inertia(q[-1] - pitch), float(pitch[-1]))
            assert square >= turning_square_around(path, ways, 2 * square)
        if turned <= 2:
            pitch = np.linspace(0.0, 2 * np.pi / 3.0, 2001)
            ways = Around(_inertia(pitch), _inertia(q[-1] - pitch), float(pitch[-1]))
            a, peak = np.gradient(u, t), float(np.abs(torque).max())
            jerk, slopes = float(np.abs(np.gradient(a, t)).max()), (float(a[0]), float(a[-1]))
            within = replace(
                path, greatest=float(np.abs(u).max()), acceleration=float(np.abs(a).max()), jerk=jerk, slopes=slopes
            )
            assert turning_peak_around(within, ways, 2 * peak) <= peak * (1 + 1e-6)
        assert np.abs(torque).max() >= turning_peak(path, around) * (1 - 1e-6)
    assert turned > 0


def test_a_turn_within_the_way_brakes_all_it_has_on_what_there_is_of_it() -> None:
    """Two ways to rest, each of the energy over the peak, and the time that two even torques need."""
    path = PathTask(np.full(501, 2.0), 1.0, (2.0, 2.0), 1.0, 9.0, 1e6, 1e12)
    pitch = np.full(101, 2.0)
    level = 100.0
    found = turning_peak_around(path, Around(pitch, pitch, 7.0), level)
    exact = 2 * 4.0 / 1.0  # of I v²/2 on half the way each: there in 0.5 s, as long as it takes
    assert 0.93 * exact < found <= exact


def test_a_turn_beyond_a_place_that_is_passed_slowly_only_costs_the_braking_before_it() -> None:
    """Where the inertia falls to a hundredth the speed limit leaves little kinetic energy: to go on beyond it saves nothing."""
    pitch = np.linspace(0.0, 2.0, 2001)
    inertia = 1.0 - 0.99 * np.sin(np.pi * pitch / 2.0) ** 2
    path = PathTask(inertia, 2.0, (1.0, 1.0), 400.0, 1.5)
    found = turning_square_around(path, Around(inertia, inertia, 2.0), 10.0)
    s = path.stretched[1000]
    first, top = 0.5**0.75, (0.5 * 0.01 * 1.5**2) ** 0.75
    before = 16 / 9 * (first - top) ** 2 / s  # down to what the speed limit leaves halfway, from either end
    assert 0.9 * 2 * before <= found <= 2 * 16 / 9 * first**2 / s
    assert turning_square(path, inertia) < 0.1 * found


def _jerky(seed: int) -> tuple[PathTask, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Random motion in time, of whose limits its path is told what it uses: path, time, place, speed, acceleration."""
    rng = np.random.default_rng(seed)
    t = np.linspace(0.0, 1.0, 40_001)
    jerk = sum((rng.normal() * 8.0 * np.sin(k * np.pi * t + rng.uniform(0.0, 6.0)) for k in range(1, 5)), 0.0 * t)
    a = rng.normal() * 2.0 + cumulative_trapezoid(jerk, t, initial=0.0)
    u = cumulative_trapezoid(a, t, initial=0.0)
    u += 0.2 - u.min()
    q = cumulative_trapezoid(u, t, initial=0.0)
    limits = float(np.abs(a).max()), float(np.abs(jerk).max())
    inertia = np.full(2001, 2.0)
    path = PathTask(inertia, float(q[-1]), (u[0], u[-1]), 1.0, float(u.max()), *limits, (a[0], a[-1]))
    return path, t, q, u, a


@pytest.mark.parametrize("seed", range(6))
def test_motions_stay_within_the_reach_of_their_acceleration_and_jerk(seed: int) -> None:
    path, _, q, u, _ = _jerky(seed)
    places = np.linspace(0.0, q[-1], 2001)
    low, high = path.reach
    energy = np.interp(places, q, u) ** 2
    assert (low <= energy * (1 + 1e-6)).all()
    assert (energy <= high * (1 + 1e-6)).all()
    free = replace(path, jerk=math.inf).reach
    assert (low >= free[0] - 1e-9).all()
    assert (high <= free[1] + 1e-9).all()
    assert float((high - low).sum()) < float((free[1] - free[0]).sum())


@pytest.mark.parametrize(
    ("seed", "kind"),
    [
        (0, "square"),
        (1, "peak"),
        (3, "drawn"),
        *(pytest.param(n, kind, marks=pytest.mark.slow) for n in range(4, 24) for kind in ("square", "peak", "drawn")),
    ],
)
def test_no_motion_within_its_jerk_goes_below_the_bound_in_tubes(seed: int, kind: Kind) -> None:
    """Random motions of a random inertia, its torque by its formula; the level is a little above the motion, or far."""
    path, t, q, u, a = _jerky(seed)
    wave, size = 2 * np.pi / q[-1] * (1 + seed % 3), 0.9 * (seed % 4) / 3
    path = replace(path, inertia=1.0 + size * np.sin(wave * np.linspace(0.0, q[-1], 2001)))
    torque = (1.0 + size * np.sin(wave * q)) * a + size * wave * np.cos(wave * q) * u**2 / 2
    costs: dict[Kind, float] = {
        "square": float(np.trapezoid(torque**2, t)),
        "peak": float(np.abs(torque).max()),
        "drawn": float(np.trapezoid(np.maximum(torque * u, 0.0), t)),
    }
    assert least_in_tubes(path, kind, costs[kind] * (1.01 + 0.3 * (seed % 2))) <= costs[kind] * (1 + 1e-6)


def test_the_only_motion_within_a_jerk_is_the_bound_in_tubes() -> None:
    """Jerk up, down and up again is the quickest: way ``v T + J T³/32``, integral of the squared acceleration ``J² T³/48``."""
    v, time, jerk, inertia = 4.0, 1.0, 40.0, 0.6
    way = v * time + jerk * time**3 / 32
    path = PathTask(np.full(501, inertia), way, (v, v), time * (1 + 1e-6), 50.0, 100.0, jerk)
    only = inertia**2 * jerk**2 * time**3 / 48
    assert max(least_square_in_time(path), least_square_limited(path)) < 0.75 * only
    assert 0.78 * only < least_in_tubes(path, "square", only) <= only * (1 + 1e-4)
    peak = inertia * jerk * time / 4
    assert 0.6 * peak < least_in_tubes(path, "peak", peak) <= peak * (1 + 1e-4)


@pytest.mark.parametrize("kind", ["square", "peak"])
def test_no_tube_is_asked_that_cannot_raise_what_is_known(kind: Kind) -> None:
    path, t, _, _, a = _jerky(1)
    level = 1.01 * float(np.trapezoid(a**2, t) if kind == "square" else np.abs(a).max())
    plain = least_in_tubes(path, kind, level)
    assert least_in_tubes(path, kind, level, 0.999 * level) == 0.0
    assert least_in_tubes(path, kind, level, 0.5 * plain) == plain


def test_a_level_is_lowered_until_it_is_proved() -> None:
    """Where standing costs little more than the motion, its own level proves little; nine tenths of it are."""
    slow = replace(EVEN, time=7.0)
    standing = standing_square(slow)
    assert 0.85 * standing < least_square(slow, 0.99 * standing) <= 0.99 * standing


def test_the_softest_turn_of_a_constant_inertia() -> None:
    """A cubic where that turns by itself, ``4 (v² + v w + w²) / T - 12 (v + w) D / T² + 12 D² / T³``; else a plain scan's best rest."""
    inertia, v, w, time = 0.7, 2.0, 1.5, 0.4
    for way in (0.1, 0.5):
        path = PathTask(np.full(101, inertia), way, (v, w), time, 50.0)
        t, d = np.meshgrid(np.linspace(0.0, time, 802)[1:-1], np.linspace(-way, 2 * way, 1501))
        left, rest = time - t, way - d
        both = 4 * v**2 / t - 12 * v * d / t**2 + 12 * d**2 / t**3
        both += 4 * w**2 / left - 12 * w * rest / left**2 + 12 * rest**2 / left**3
        least = inertia**2 * both.min()
        assert turning_square(path, path.inertia) == pytest.approx(least, rel=2e-3)
        assert turning_square(path, path.inertia) <= least
        cubic = 4 * (v**2 + v * w + w**2) / time - 12 * (v + w) * way / time**2 + 12 * way**2 / time**3
        assert (abs(least / (inertia**2 * cubic) - 1.0) < 1e-3) == (way == 0.1)


def test_a_crank_that_may_turn_has_as_sharp_a_bound_as_one_that_may_not() -> None:
    """On a short cut turning would cost far more: the leave to turn must not blunt the bound."""
    task = Task(CRANK, replace(SHEAR, length=0.8), TURNS)
    profile = solve(task, "rms_torque").profile
    found = {
        reversal: lower_bound(profile, replace(task, limits=replace(TURNS, reversal=reversal)), "rms_torque").value
        / measure_motor(profile, task).rms_torque
        for reversal in (False, True)
    }
    assert found[True] == pytest.approx(found[False], rel=1e-9)
    assert found[True] > 0.97


def test_without_a_limit_that_binds_the_acceleration_s_road_is_the_other_one() -> None:
    q = np.linspace(0.0, 2.0, 501)
    path = PathTask(_inertia(q), 2.0, (1.0, 1.5), 0.8, 9.0, 1e3)
    assert least_square_limited(path) == pytest.approx(least_square_in_time(path), rel=5e-3)
    assert least_square_limited(replace(path, acceleration=math.inf)) == 0.0


@pytest.mark.parametrize("acceleration", [8.0, 10.0, 14.0])
def test_no_motion_within_its_acceleration_goes_below_the_bound_that_knows_it(acceleration: float) -> None:
    """The motion of greatest acceleration up and down of a constant inertia is the only one in its time: the bound is its torque's."""
    way, v, inertia = 1.0, 1.0, 0.6
    top = math.sqrt(v**2 + acceleration * way)
    time = 2 * (top - v) / acceleration
    path = PathTask(np.full(501, inertia), way, (v, v), time * (1 + 1e-4), 50.0, acceleration)
    only = (inertia * acceleration) ** 2 * time
    assert only * 0.97 <= least_square_limited(path) <= only * (1 + 1e-4)
    assert least_square_in_time(path) < 0.95 * only
    assert not path.may_rest
    assert standing_square(path) == math.inf


def test_the_reach_and_the_rests_of_an_acceleration() -> None:
    """Two brakings at the limit, ``v²/(2 A)`` and ``w²/(2 A)``, fill a way in ``v/A + w/A``: then, and not a little sooner, it may rest."""
    v, w, limit = 1.0, 2.0, 4.0
    way, time = (v**2 + w**2) / (2 * limit), (v + w) / limit
    path = PathTask(np.full(101, 2.0), way, (v, w), time * (1 + 1e-12), 9.0, limit)
    assert path.may_rest
    assert not replace(path, time=0.999 * time).may_rest
    low, high = path.reach
    assert (low[0], low[-1]) == (pytest.approx(v**2), pytest.approx(w**2))
    assert low.min() == pytest.approx(0.0, abs=0.05)
    assert (low <= high * (1 + 1e-12)).all()


@pytest.mark.parametrize("line_speed", [3e-4, 1e-3, 0.02, 0.06])
def test_a_slave_that_coasts_to_rest_and_stands_on_a_slow_line_is_not_below_its_bound(line_speed: float) -> None:
    """Coasting takes no torque; the way that is left is a cubic from rest, its time the best by a search of its own."""
    knife = replace(KNIFE, drum_friction=2.0)
    task = Task(knife, Cut(0.75, line_speed, 0.12, 0.01, 0.11, 1e-4), Limits(4.4, 1e9, 1e15))
    inertia, friction = float(knife.inertia(0.0)), knife.friction
    coast = inertia * line_speed / friction
    way = task.height - 0.5 * line_speed * coast
    times = np.linspace(0.02, 1.0, 20_001)
    square = 4 * line_speed**2 / times - 12 * line_speed * way / times**2 + 12 * way**2 / times**3
    cost = 2 * friction * inertia * line_speed + (inertia**2 * square + friction**2 * times).min()
    found = constant_inertia.square_with_friction(task, 1e9)
    assert cost * (1 - 4e-3) <= found <= cost * (1 + 1e-9)
