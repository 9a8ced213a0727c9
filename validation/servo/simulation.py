"""The discrete servo of S1 run on a profile, at every sampling phase, sampling instants and between them.

The servo samples on its own clock, so where its samples fall in a cycle (the sampling phase) drifts from cycle to
cycle, or stays where the start of the machine happened to put it. Every phase is therefore simulated: `PHASES`
clocks, shifted against each other by equal parts of the sample time, each followed continuously through as many
earlier cycles as its memory reaches back.

The command is split into its mean straight line, which the servo follows with the constant error of
`steady_following_error`, and what is periodic in the cut length. Only the latter is simulated, so the accuracy does not
depend on how far the slave has run. Exact at the sampling instants and between them: no step size but the servo's own.
The loop sees the command of the time ``t - delay`` (`camwright.profiles.servo.Servo.delay`): of the master position that
lies ``v delay`` behind.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.servo import Servo, spectral_radius
from camwright.validation.motion import require_period
from camwright.validation.servo.axis_run import AxisRun, ServoRun
from camwright.validation.servo.lifting import SUBSTEPS, Lifted, follow, lift
from camwright.validation.servo.periodic import periodic_part
from camwright.validation.servo.slow_axis import SlowAxis

PHASES = 16
"""Sampling phases simulated: shifts of the servo's clock by a 16th of the sample time. A multiple of `SUBSTEPS`, so that all
phases share one command grid."""

Part = tuple[float, float] | tuple[FloatArray, FloatArray]
"""Two master positions (m), or two of each servo."""

_FORGOTTEN = 1e-12
"""The start-up transient has decayed to this part of itself when the simulated cycle begins."""

_TRANSIENT_GROWTH = 1e3
"""Added to the decay because the loop's poles are not orthogonal: with it, the part of the command that is left out
moves the axis by less than 1e-12 of its size, over all of S1's ranges."""

_MOST_VALUES = 2**17
"""Command values of one simulation above which fewer phases are taken (never fewer than `SUBSTEPS`)."""

WHOLE, WHOLE_PART = 2**13, 2**11
"""Samples of one phase, memory and simulated part together, up to which all of them are simulated one after another: of a cycle, which has
fewer phases in closed form, and of a part of it, where closed form is the quicker from here on."""

_MOST_SAMPLES = 2**17
"""Most samples of one phase where there is no closed form."""


@lru_cache(maxsize=32)
def memory(servo: Servo) -> int:
    """Count the samples after which the servo has forgotten its past to 1e-12.

    Raises
    ------
    InputError
        The position loop is unstable: a pole lies on or outside the unit circle.
    """
    radius = spectral_radius(servo)
    if not radius < 1.0:
        raise InputError(
            f"the servo is unstable: its largest pole in the z-plane has the magnitude {radius:.6g}, the limit is 1; "
            f"lower the position gain ({servo.position_gain:g} 1/s), shorten the sample time ({servo.sample_time:g} s) "
            f"or raise the bandwidth ({servo.bandwidth:g} rad/s)"
        )
    return memory_at(radius)


def memory_at(radius: float) -> int:
    """Count the samples after which a servo whose largest pole has this magnitude, below 1, has forgotten its past."""
    return int(memories_at(np.array([radius]))[0])


def memories_at(radii: FloatArray, forgotten: float = _FORGOTTEN) -> NDArray[np.intp]:
    """Count the samples after which servos have forgotten their past to a part of itself, by their largest poles; 0 for unstable ones."""
    poles = np.clip(radii, 1e-3, None)
    found = np.zeros(len(poles), dtype=np.intp)
    stable = poles < 1.0
    found[stable] = np.maximum(4, np.ceil(math.log(forgotten / _TRANSIENT_GROWTH) / np.log(poles[stable])))
    return found


def slow_axis(
    profile: CamProfile,
    cut: Cut,
    servo: Servo,
    orders: tuple[int, ...],
    part: tuple[float, float],
    places: Sequence[float] = (),
    phases: int = SUBSTEPS,
    most: int | None = None,
) -> SlowAxis | None:
    """Put the axis of one servo in a part of the cycle into closed form; ``None`` where its samples are simulated one by one.

    Parameters
    ----------
    profile, cut, servo
        As in `simulate`.
    orders
        Derivatives of the axis that are asked for.
    part
        Master positions (m), counted on from the start of the return zone.
    places
        Master positions in it whose neighbours are asked for: ends of zones.
    phases
        Sampling phases.
    most
        Samples up to which there is none; `WHOLE_PART` if not given.
    """
    require_period(profile, cut)
    past, sample = memory(servo.loop), cut.line_speed * servo.sample_time
    first, last = (part[0] - cut.return_start) / sample, (part[1] - cut.return_start) / sample
    if past + last - first <= (WHOLE_PART if most is None else most):
        return None
    slow = SlowAxis(
        profile=profile,
        servo=servo.loop,
        line_speed=cut.line_speed,
        origin=cut.return_start,
        shift=_shift(cut, servo, cut.line_speed),
        behind=steady_following_error(profile.mean_ratio * cut.line_speed, servo),
        first=math.floor(first),
        last=math.ceil(last) + 1,
        phases=phases,
        past=past,
        orders=orders,
        places=(*part, *places),
    )
    more = len(servo.drive) > 2  # than the velocity is fed forward: the closed form does not know it
    if slow.tells and not more:
        return slow
    if last - first > _MOST_SAMPLES:
        raise InputError(
            f"no closed form tells what the servo makes of this motion, and a cycle of {cut.period:.6g} s has {last - first:.0f} samples "
            f"to simulate, the limit is {_MOST_SAMPLES}; raise the line speed or cut shorter"
        )
    if past + last - first > _MOST_SAMPLES:
        raise InputError(
            f"the servo remembers {past} samples of {servo.sample_time:g} s and is far slower than the motion, whose "
            f"cycle takes {cut.period:.6g} s: it cannot follow; raise the position gain ({servo.position_gain:g} 1/s)"
        )
    return None


@dataclass(frozen=True, eq=False)
class _Clocks:
    """The samples of servos about a part of the cycle, at every phase.

    Phase ``j`` samples ``(j / phases - 1 + k) dT`` after the start of the return zone. The first sample here is the last that no phase has
    after the start of the part; the last has the end of the part between itself and its next.

    Parameters
    ----------
    origin
        Start of the return zone (m).
    step
        From phase to phase (m), shape ``(servos,)``.
    first
        Number of the grid's first point after the memory, counted from the origin, shape ``(servos,)``.
    past, samples, phases
        Samples remembered and samples of the part, at each phase; how many phases.
    """

    origin: float
    step: FloatArray
    first: FloatArray
    past: int
    samples: int
    phases: int

    def grid(self, more: int = 0) -> FloatArray:
        """Lay out the samples of all phases (m), memory first, ascending: shape ``(servos, (past + samples + more) phases)``."""
        before, after = self.past * self.phases, (self.samples + more) * self.phases
        found = self.first[:, None] + np.arange(-before, after)
        found *= self.step[:, None]
        found += self.origin
        return found

    def by_phase(self, values: FloatArray) -> FloatArray:
        """Spread the grid after the memory, a sample more, to ``(phases, points)``; phases overlap, so nothing is copied."""
        item = values.itemsize
        strides = (item, self.phases // SUBSTEPS * item)
        spread: FloatArray = np.ndarray(
            (self.phases, self.samples * SUBSTEPS), np.float64, buffer=values, strides=strides
        )
        spread.setflags(write=False)
        return spread


def _clocks(cut: Cut, speeds: FloatArray, lifted: Lifted, part: Part, phases: int) -> _Clocks:
    """Lay the samples of servos about a part of the cycle, each at its line speed."""
    sample = speeds * lifted.loops.sample_time
    first = np.floor((part[0] - cut.return_start) / sample) - 1.0
    samples = int(np.ceil((part[1] - cut.return_start) / sample - first).max()) + 1
    past = lifted.history.shape[2]
    return _Clocks(cut.return_start, sample / phases, first * phases, past, samples, phases)


@lru_cache(maxsize=8)  # many profiles are simulated with one cut and servo
def lifted_cycle(cut: Cut, servo: Servo) -> tuple[Lifted, _Clocks, FloatArray]:
    """Lift a servo, and lay its samples over the whole cycle, a sample more at the end; fewer phases where there are too many samples."""
    phases = _phases(cut, servo)
    lifted = lift(servo.loop, memory(servo.loop), (1, 0))
    speed = np.array([cut.line_speed])
    clocks = _clocks(cut, speed, lifted, (cut.return_start, cut.return_start + cut.length), phases)
    grid = clocks.grid(more=1)
    grid.setflags(write=False)
    return lifted, clocks, grid


def _phases(cut: Cut, servo: Servo) -> int:
    """Count the phases at which a cycle is simulated: fewer where there are too many samples."""
    samples, phases = memory(servo.loop) + math.ceil(cut.period / servo.sample_time), PHASES
    while phases > SUBSTEPS and phases * samples > _MOST_VALUES:
        phases //= 2
    return phases


def simulate(profile: CamProfile, cut: Cut, servo: Servo) -> ServoRun:
    """Periodic response of one servo to a profile repeated for ever: a whole cycle, and its command.

    Parameters
    ----------
    profile
        One cycle over the master period ``[0, x_c]`` (slave unit).
    cut
        Cut length, line speed and zones.

    Raises
    ------
    InputError
        The profile does not run over ``[0, x_c]``, the servo is unstable, or it is far slower than the motion and remembers more than
        131072 samples.
    """
    require_period(profile, cut)
    slow = slow_cycle(profile, cut, servo)
    if slow is not None:
        return slow_run(profile, *slow.at(slow.samples()))
    lifted, clocks, grid = lifted_cycle(cut, servo)
    periodic = periodic_part(profile, grid)
    shift = _shift(cut, servo, cut.line_speed)
    seen = periodic_part(profile, grid - shift) if shift else periodic
    after = clocks.past * clocks.phases
    starts = grid[:, after : after + clocks.phases]
    ratio, axis = _axes(profile, (servo,), np.array([cut.line_speed]), lifted, starts, seen[:, : -clocks.phases])
    master, periodic = grid[0, after:], periodic[0, after:]
    zero, slope = _mean_line(profile)
    command = slope * master
    command += zero
    command += periodic
    return ServoRun(clocks.by_phase(master), axis, ratio, clocks.by_phase(command))


def slow_cycle(profile: CamProfile, cut: Cut, servo: Servo) -> SlowAxis | None:
    """Put a whole cycle into closed form, to be looked at about the ends of sync zone and shear zone; ``None`` as `slow_axis`."""
    zone = cut.return_start + cut.return_zone
    shear = zone + cut.shear_zone_at
    places = (zone, shear, min(shear + cut.shear_zone, zone + cut.sync_zone))
    end = cut.return_start + cut.length
    return slow_axis(profile, cut, servo, (1, 0), (cut.return_start, end), places, most=WHOLE)


def slow_run(profile: CamProfile, master: FloatArray, found: FloatArray) -> ServoRun:
    """Put what a `slow_cycle` gives at some of its samples beside the command, as `simulate` does at all of them."""
    ratio, axis = found
    zero, slope = _mean_line(profile)
    return ServoRun(master, axis, ratio, periodic_part(profile, master) + (slope * master + zero), even=False)


def simulate_part(
    profile: CamProfile,
    cut: Cut,
    servos: Sequence[Servo],
    lifted: Lifted,
    part: Part,
    phases: int = PHASES,
    speeds: FloatArray | None = None,
) -> tuple[FloatArray, FloatArray]:
    """Simulate servos side by side about a part of the cycle: nothing else but what they remember.

    Parameters
    ----------
    profile, cut
        As in `simulate`; the profile runs over the period.
    servos
        Stable servos.
    lifted
        The same, lifted, with the memory of the one that remembers most; or one for all where all are alike.
    part
        Master positions (m), counted on from the start of the return zone like those of a run; or those of each servo.
    phases
        Sampling phases.
    speeds
        The line speed of each servo (m/s); that of the cut if not given.

    Returns
    -------
    (master, found)
        Master positions, shape ``(servos phases, points)``, and there the derivatives of the axes over the master of the lifted orders,
        shape ``(orders, servos phases, points)``.
    """
    speeds = np.broadcast_to(cut.line_speed if speeds is None else speeds, len(servos))
    clocks = _clocks(cut, speeds, lifted, part, phases)
    grid = clocks.grid()
    shift = np.fmod(speeds * [servo.delay for servo in servos], cut.length)  # as `_shift`
    # one grid for all, if it is
    alike = all(each.min() == each.max() for each in (clocks.step, clocks.first, shift))
    seen = periodic_part(profile, (grid - shift[:, None])[: 1 if alike else len(servos)])
    starts = grid[:, clocks.past * phases : (clocks.past + 1) * phases]
    found = _axes(profile, servos, speeds, lifted, starts, seen)
    spacing = np.repeat(clocks.step * (phases / lifted.parts), phases)[:, None]
    return starts.reshape(-1, 1) + spacing * np.arange(clocks.samples * lifted.parts), found


def run_about(profile: CamProfile, cut: Cut, servo: Servo, part: tuple[float, float]) -> AxisRun:
    """Simulate one servo about a part of the cycle, at the phases of `simulate`; arguments as in `simulate_part`."""
    require_period(profile, cut)
    lifted = lift(servo.loop, memory(servo.loop), (1, 0))
    master, (ratio, axis) = simulate_part(profile, cut, (servo,), lifted, part, _phases(cut, servo))
    return AxisRun(master, axis, ratio)


def shear_zone_run(
    profile: CamProfile, cut: Cut, servos: Sequence[Servo], lifted: Lifted, phases: int = PHASES
) -> AxisRun:
    """Simulate servos about the shear zone, ``phases`` rows a servo; arguments as in `simulate_part`, lifted for the orders ``(1, 0)``."""
    start = cut.return_start + cut.return_zone + cut.shear_zone_at
    master, (ratio, axis) = simulate_part(profile, cut, servos, lifted, (start, start + cut.shear_zone), phases)
    return AxisRun(master, axis, ratio)


def slow_shear_zone_run(profile: CamProfile, cut: Cut, servo: Servo, phases: int) -> AxisRun | None:
    """Give one servo's axis about the shear zone in closed form, at the samples of a first round; ``None`` as `slow_axis`."""
    start = cut.return_start + cut.return_zone + cut.shear_zone_at
    slow = slow_axis(profile, cut, servo, (1, 0), (start, start + cut.shear_zone), phases=phases)
    if slow is None:
        return None
    master, (ratio, axis) = slow.at(slow.samples())
    return AxisRun(master, axis, ratio, even=False)


def _axes(
    profile: CamProfile,
    servos: Sequence[Servo],
    speeds: FloatArray,
    lifted: Lifted,
    starts: FloatArray,
    seen: FloatArray,
) -> FloatArray:
    """Run loops on what they see of the command, about the mean straight line, which they follow late.

    Gives what `camwright.validation.servo.lifting.follow` gives.

    Parameters
    ----------
    starts
        Master positions of the first sample after the memory, shape ``(servos, phases)``.
    seen
        Command less the line, memory first, shape ``(servos or 1, samples phases)``.
    """
    zero, slope = _mean_line(profile)
    slave_speeds = (slope * speeds).tolist()
    behind = [[zero - steady_following_error(*each)] for each in zip(slave_speeds, servos, strict=True)]
    line = slope * starts + np.array(behind)
    return follow(lifted, seen.reshape(len(seen), -1, starts.shape[1]), line, slope, speeds)


def _shift(cut: Cut, servo: Servo, line_speed: float) -> float:
    """How far behind on the master the command lies that the loop sees (m); what is periodic may be taken a cycle on."""
    return math.fmod(line_speed * servo.delay, cut.length)


@lru_cache(maxsize=8)
def _mean_line(profile: CamProfile) -> tuple[float, float]:
    """Position at master zero and ratio of the straight line through the start of the profile."""
    return float(profile.coefficients[0, 0]) - profile.mean_ratio * profile.start, profile.mean_ratio


def steady_following_error(speed: float, servo: Servo) -> float:
    """Following error at constant speed (m), positive where the axis lags: ``(1 - alpha) v / K + v delay``.

    Without delay these are eq. 2 of S1 and, without velocity feed-forward (``alpha = 0``), eq. 1: ``v / K``.

    Parameters
    ----------
    speed
        Slave speed ``v`` (m/s).
    servo
        The servo, of position gain ``K``, velocity feed-forward ``alpha``, dead time and lead.
    """
    return (1.0 - servo.velocity_feedforward) * speed / servo.position_gain + speed * servo.delay
