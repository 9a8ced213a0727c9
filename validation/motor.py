"""What a profile asks of the motor: torque, speed and energy, for every machine."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from camwright.profiles.machines import Machine
from camwright.profiles.motor import MotorCurve
from camwright.profiles.polynomial.profile import CamProfile, Extremum, FloatArray, steps
from camwright.profiles.task import Task
from camwright.validation.composed import compose
from camwright.validation.motion import greatest_magnitude, is_steady, require_period

_STANDING = 1e-9
"""Ratio, relative to the cycle's greatest, below which the slave stands still on a piece: friction then asks for no torque."""


@dataclass(frozen=True)
class MotorMeasures:
    """What one cycle asks of the motor, at the motor's shaft.

    ``None`` stands for what cannot be told: the machine gives neither inertia nor friction, or the profile's acceleration is unbounded.

    Parameters
    ----------
    peak_torque
        Greatest magnitude of the torque (N·m).
    rms_torque
        Root mean square of the torque over the whole cycle, which is what heats the motor (N·m).
    peak_speed
        Greatest speed (rad/s).
    min_velocity
        Least velocity, negative where the motor turns back (rad/s).
    energy
        Energy drawn in one cycle, nothing recovered (J): integral of ``max(torque × velocity, 0)``.
    regenerated
        Energy fed back in one cycle (J): integral of ``max(-torque × velocity, 0)``.
    """

    peak_torque: float | None
    rms_torque: float | None
    peak_speed: float
    min_velocity: float
    energy: float | None
    regenerated: float | None


def measure_motor(profile: CamProfile, task: Task) -> MotorMeasures:
    """Measure what a profile asks of the motor, at the line speed of the cut.

    The torque is ``(I(y) ÿ + I'(y) ẏ² / 2 + F sign(ẏ)) / ratio`` with the machine's inertia ``I``, friction ``F`` and motor ratio; friction
    asks for nothing where the slave stands still. Peaks come from roots of polynomials, mean squares and energies from exact
    integration: to rounding where the inertia is constant, else to 1e-12 of the largest torque (`camwright.validation.composed.compose`).

    Parameters
    ----------
    profile
        One cycle over the master period ``[0, x_c]`` (slave unit).
    task
        The machine, its sync zone placed, and the cut it is judged for.

    Raises
    ------
    InputError
        The profile does not run over ``[0, x_c]``, or the machine's sync zone is not placed.
    """
    machine = task.machine
    require_period(profile, task.cut)
    pace = task.cut.line_speed * machine.motor_ratio
    peak_speed = pace * greatest_magnitude(profile, 1).value
    min_velocity = pace * profile.extrema(1)[0].value
    if not (is_steady(profile, machine) and machine.moves_something):
        return MotorMeasures(None, None, peak_speed, min_velocity, None, None)
    torque = motor_torque(profile, task)
    drawn, regenerated = _energies(torque, profile, machine)
    return MotorMeasures(
        peak_torque=greatest_magnitude(torque, 0).value,
        rms_torque=math.sqrt(torque.mean_square(0)),
        peak_speed=peak_speed,
        min_velocity=min_velocity,
        energy=drawn,
        regenerated=regenerated,
    )


def motor_torque(profile: CamProfile, task: Task) -> CamProfile:
    """Torque at the motor over the master (N·m), as polynomials; at a jump both one-sided values belong to it.

    Parameters
    ----------
    profile
        One cycle with a bounded acceleration; its position may begin anywhere.
    """
    machine = task.machine
    start = task.slave_zero(profile)
    v, ratio = task.cut.line_speed, machine.motor_ratio

    def inertial(y: FloatArray, slope: FloatArray, bend: FloatArray) -> FloatArray:
        place = start + y
        return np.asarray(v**2 / ratio * (machine.inertia(place) * bend + machine.inertia_slope(place) * slope**2 / 2))

    one_way = profile.split(profile.roots(1))
    torque = compose(inertial, one_way)
    direction = _direction(one_way)[one_way.holding(torque.breaks[:-1])]
    return torque.plus(steps(torque.breaks, machine.friction / ratio * direction))


def greatest_load(profile: CamProfile, task: Task, curve: MotorCurve) -> tuple[Extremum, float]:
    """Torque where it exceeds what the motor gives at its speed by most, or comes nearest to it, and what the motor gives there.

    Between the curve's points, and where neither torque nor velocity changes its sign, torque less available torque is a polynomial: its
    greatest value is exact.

    Returns
    -------
    (torque, available)
        Magnitude of the torque (N·m) and its master position (m); torque available there (N·m).
    """
    torque = motor_torque(profile, task)
    pace = task.cut.line_speed * task.machine.motor_ratio
    velocity = profile.derivative().scale(slave=pace)
    places = [torque.roots(), velocity.roots()]
    places += [velocity.shift(slave=-way * speed).roots() for speed, _ in curve.points[1:] for way in (1, -1)]
    parts = torque.split(np.unique(np.concatenate(places)))
    middle = 0.5 * (parts.breaks[:-1] + parts.breaks[1:])
    speeds, torques = np.array(curve.points).T
    segment = np.searchsorted(speeds, np.abs(velocity(middle)), side="right") - 1
    fall = np.append(np.diff(torques) / np.diff(speeds), 0.0)[segment]
    base = np.where(segment < len(speeds) - 1, torques[segment] - fall * speeds[segment], 0.0)
    pull = parts.times(steps(parts.breaks, np.sign(parts(middle))))
    gives = velocity.recut(parts.breaks).times(steps(parts.breaks, fall * np.sign(velocity(middle))))
    worst = pull.plus(gives.plus(steps(parts.breaks, base)).scale(slave=-1.0)).extrema(0)[1]
    available = float(curve.torque(float(velocity(worst.at))))
    return Extremum(worst.value + available, worst.at), available


def _direction(one_way: CamProfile) -> FloatArray:
    """Sign of the ratio on each piece, none of which turns; zero where the slave stands."""
    middle = one_way(0.5 * (one_way.breaks[:-1] + one_way.breaks[1:]), 1)
    standing = np.abs(middle) <= _STANDING * greatest_magnitude(one_way, 1).value
    return np.where(standing, 0.0, np.sign(middle))


def work_drawn(torque: CamProfile, profile: CamProfile, machine: Machine) -> float:
    """Energy drawn over a stretch of a cycle, nothing recovered (J).

    Parameters
    ----------
    torque, profile
        Torque at the motor (N·m) and slave over the same stretch of the master.
    """
    return _energies(torque, profile, machine)[0]


def _energies(torque: CamProfile, profile: CamProfile, machine: Machine) -> tuple[float, float]:
    """Energy drawn and energy fed back in one cycle (J): the work over the slave's travel, split where it changes its sign."""
    parts = torque.split(torque.roots())
    turn = profile.recut(parts.breaks).derivative().scale(slave=machine.motor_ratio)
    work = np.diff(parts.times(turn).integral()(parts.breaks))
    return float(work[work > 0].sum()), float(-work[work < 0].sum())
