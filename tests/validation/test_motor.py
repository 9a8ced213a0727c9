"""Torque, speed and energy at the motor: closed forms, quadrature by another road, energy balance."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from camwright.profiles.cut import Cut
from camwright.profiles.limits import Limits
from camwright.profiles.machines import (
    CrankSlider,
    LinearCarriage,
    Machine,
    RotaryKnife,
)
from camwright.profiles.motor import MotorCurve
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import baseline
from camwright.profiles.task import Task
from camwright.validation.motion import measure_motion
from camwright.validation.motor import (
    MotorMeasures,
    greatest_load,
    measure_motor,
    motor_torque,
)

FREE = Limits(math.inf, math.inf, math.inf)
"""Nothing here asks for limits."""

CUT = Cut(0.9, 1.2, 0.1, 0.02, 0.07, 2e-4)
KNIFE = RotaryKnife(0.4, blades=1, gear_ratio=5.0, drum_inertia=0.02)
CARRIAGE = LinearCarriage(0.8, mass=30.0, travel_per_turn=0.04)
CRANK = CrankSlider(0.15, 0.6, 0.02, 0.5, 20.0, 10.0, 1.5)


def by_quadrature(profile: CamProfile, machine: Machine, cut: Cut) -> tuple[float, float, float, float]:
    """Naive twin: peak, root mean square, energy drawn and fed back by the formulas on a grid and by adaptive quadrature."""
    start, v = Task(machine, cut, FREE).slave_at_start, cut.line_speed

    def force(x: float) -> float:
        y, velocity, acceleration = start + float(profile(x)), v * float(profile(x, 1)), v**2 * float(profile(x, 2))
        inertial = machine.inertia(y) * acceleration + machine.inertia_slope(y) * velocity**2 / 2
        return float(inertial + machine.friction * np.sign(velocity)) / machine.motor_ratio

    def over_time(what) -> float:  # type: ignore[no-untyped-def]
        edges = np.unique(np.concatenate([profile.breaks, np.linspace(0, cut.length, 12)]))
        return sum(quad(what, a, b, epsrel=1e-8, limit=200)[0] for a, b in pairwise(edges.tolist())) / v

    def power(x: float) -> float:
        return force(x) * v * float(profile(x, 1)) * machine.motor_ratio

    peak = max(abs(force(float(x))) for x in [*profile.breaks, *np.linspace(0.0, cut.length, 2001)])
    rms = math.sqrt(over_time(lambda x: force(x) ** 2) / cut.period)
    return peak, rms, over_time(lambda x: max(power(x), 0.0)), over_time(lambda x: max(-power(x), 0.0))


@pytest.mark.parametrize("machine", [KNIFE, CARRIAGE, CRANK], ids=["knife", "carriage", "crank"])
def test_measures_against_quadrature(machine: Machine) -> None:
    profile = baseline("poly_3_4_5", Task(machine, CUT, FREE))
    found = measure_motor(profile, Task(machine, CUT, FREE))
    peak, rms, drawn, regenerated = by_quadrature(profile, machine, CUT)
    assert found.peak_torque == pytest.approx(peak, rel=1e-5)  # the grid misses the peak by a little
    assert found.peak_torque >= peak * (1 - 1e-12)
    assert found.rms_torque == pytest.approx(rms, rel=1e-9)
    assert found.energy == pytest.approx(drawn, rel=1e-7)
    assert found.regenerated == pytest.approx(regenerated, rel=1e-7)


@pytest.mark.parametrize("machine", [KNIFE, CARRIAGE, CRANK], ids=["knife", "carriage", "crank"])
def test_measures_do_not_depend_on_the_origin(machine: Machine) -> None:
    other = replace(CUT, origin="cut")
    here = measure_motor(baseline("poly_3_4_5", Task(machine, CUT, FREE)), Task(machine, CUT, FREE))
    there = measure_motor(baseline("poly_3_4_5", Task(machine, other, FREE)), Task(machine, other, FREE))
    for name in ("peak_torque", "rms_torque", "peak_speed", "min_velocity", "energy", "regenerated"):
        assert getattr(there, name) == pytest.approx(getattr(here, name), rel=1e-9)


def test_constant_inertia_is_the_motion_s_own_measure() -> None:
    motion = measure_motion(baseline("poly_3_4_5", Task(KNIFE, CUT, FREE)), Task(KNIFE, CUT, FREE))
    found = measure_motor(baseline("poly_3_4_5", Task(KNIFE, CUT, FREE)), Task(KNIFE, CUT, FREE))
    per_force = KNIFE.inertia(0.0) / KNIFE.motor_ratio
    assert found.peak_torque == pytest.approx(per_force * motion.peak_acceleration, rel=1e-12)
    share = math.sqrt(CUT.return_zone / CUT.length)
    assert found.rms_torque == pytest.approx(per_force * motion.rms_acceleration * share, rel=1e-12)
    assert found.peak_speed == pytest.approx(motion.peak_speed / KNIFE.radius * 5, rel=1e-12)
    assert found.min_velocity == pytest.approx(motion.min_speed / KNIFE.radius * 5, rel=1e-12)


def test_a_sprung_profile_in_closed_form() -> None:
    """A carriage of mass m that swings as a parabola: constant force out, and all energy given comes back."""
    v, m, reach = CUT.line_speed, CARRIAGE.mass, 0.1
    half = 0.5 * CUT.length
    k = reach / (half / 2) ** 2
    swing = CamProfile.from_arrays([0.0, half, 2 * half], [[0.0, k * half, -k], [0.0, -k * half, k]])
    found = measure_motor(swing, Task(CARRIAGE, CUT, FREE))
    force = 2 * k * v**2 * m
    energy = 2 * 0.5 * m * (k * half * v) ** 2  # up to full speed twice in a cycle
    assert found.peak_torque == pytest.approx(force * 0.04 / (2 * math.pi), rel=1e-12)
    assert found.rms_torque == pytest.approx(found.peak_torque, rel=1e-12)
    assert found.energy == pytest.approx(energy, rel=1e-12)
    assert found.regenerated == pytest.approx(energy, rel=1e-12)


@pytest.mark.parametrize("machine", [KNIFE, CRANK], ids=["knife", "crank"])
def test_without_friction_a_cycle_takes_no_net_energy(machine: Machine) -> None:
    found = measure_motor(baseline("poly_3_4_5", Task(machine, CUT, FREE)), Task(machine, CUT, FREE))
    assert found.energy == pytest.approx(found.regenerated, rel=1e-10)


@settings(deadline=None, max_examples=10)
@given(st.floats(0.35, 1.5), st.floats(0.1, 20.0))
def test_net_energy_is_the_friction_s_work(length: float, friction: float) -> None:
    knife = replace(KNIFE, drum_friction=friction)
    cut = replace(CUT, length=length)
    profile = baseline("cycloid", Task(knife, cut, FREE))  # a long cut makes it run backwards
    found = measure_motor(profile, Task(knife, cut, FREE))
    turned = (
        quad(lambda x: abs(float(profile(x, 1))), 0.0, length, limit=400, points=profile.breaks[1:-1])[0] / knife.radius
    )
    assert found.energy - found.regenerated == pytest.approx(friction * turned, rel=1e-6)


@settings(deadline=None, max_examples=15)
@given(st.floats(0.05, 0.3), st.floats(1.2, 6.0), st.floats(-0.3, 0.3), st.floats(1.2, 1.9))
def test_crank_s_kinetic_energy_is_the_torque_s_work(radius: float, rod: float, offset: float, at: float) -> None:
    crank = CrankSlider(radius, radius * (rod + abs(offset)), radius * offset, 0.2, 10.0, 3.0, at)
    cut = replace(CUT, sync_zone=0.2 * radius, length=6 * radius)
    profile = baseline("poly_3_4_5", Task(crank, cut, FREE))
    torque = motor_torque(profile, Task(crank, cut, FREE))
    start = Task(crank, cut, FREE).slave_at_start

    def kinetic(x: float) -> float:
        return 0.5 * float(crank.inertia(start + float(profile(x)))) * (cut.line_speed * float(profile(x, 1))) ** 2

    for end in (0.3 * cut.length, 0.7 * cut.length):
        x = np.linspace(0.0, end, 4001)
        power = torque(x) * profile(x, 1) * crank.motor_ratio
        work = float(np.sum((power[1:] + power[:-1]) / 2 * np.diff(x)))
        scale = 0.5 * crank.inertia(math.pi / 2) * (cut.line_speed * profile.extrema(1)[1].value) ** 2
        assert work == pytest.approx(kinetic(end) - kinetic(0.0), abs=1e-4 * scale)


def test_friction_asks_for_nothing_at_standstill() -> None:
    knife = replace(KNIFE, drum_inertia=0.0, drum_friction=3.0)
    x = CUT.length / 3
    waiting = CamProfile.from_arrays(
        [0.0, x, 2 * x, 3 * x], [[0.0, 0.0, 0.0], [0.0, 0.0, 0.2 / x**2], [0.2, 0.4 / x, -0.2 / x**2]]
    )
    found = measure_motor(waiting, Task(knife, CUT, FREE))
    assert found.peak_torque == pytest.approx(3.0 / 5, rel=1e-12)
    assert found.rms_torque == pytest.approx(3.0 / 5 * math.sqrt(2 / 3), rel=1e-12)
    assert found.energy == pytest.approx(3.0 * 0.4 / knife.radius, rel=1e-12)
    assert found.regenerated == 0.0


def test_what_cannot_be_told_is_none() -> None:
    profile = baseline("linear_return", Task(KNIFE, CUT, FREE))
    speed = pytest.approx(CUT.line_speed / KNIFE.radius * 5)
    assert measure_motor(profile, Task(KNIFE, CUT, FREE)) == MotorMeasures(
        None, None, speed, pytest.approx(0.375 * speed.expected), None, None
    )
    bare = replace(KNIFE, drum_inertia=0.0)
    found = measure_motor(baseline("cycloid", Task(KNIFE, CUT, FREE)), Task(bare, CUT, FREE))
    assert (found.peak_torque, found.rms_torque, found.energy, found.regenerated) == (None, None, None, None)
    assert not bare.moves_something
    assert CrankSlider(0.15, 0.6, carriage_mass=1.0).moves_something  # though at a dead centre it weighs nothing


@pytest.mark.parametrize("machine", [KNIFE, CARRIAGE, CRANK], ids=["knife", "carriage", "crank"])
@pytest.mark.parametrize("top", [0.8, 1.0, 1.3])
def test_greatest_load_against_a_grid(machine: Machine, top: float) -> None:
    profile = baseline("poly_3_4_5", Task(machine, CUT, FREE))
    found = measure_motor(profile, Task(machine, CUT, FREE))
    t, w = found.peak_torque, found.peak_speed
    curve = MotorCurve(((0.0, 1.1 * t), (0.4 * w, t), (top * w, 0.3 * t)))
    load, available = greatest_load(profile, Task(machine, CUT, FREE), curve)
    x = np.union1d(profile.breaks, np.linspace(0.0, CUT.length, 40_001))
    torque = np.abs(motor_torque(profile, Task(machine, CUT, FREE))(x))
    over = torque - curve.torque(CUT.line_speed * machine.motor_ratio * profile(x, 1))
    assert load.value - available == pytest.approx(over.max(), abs=2e-4 * t)
    assert load.value - available >= over.max() - 1e-9 * t
