"""The servo under a line that ramps: the sync error in the shear zone on the way between standstill and the line speed, at every phase."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.servo import Servo
from camwright.profiles.task import Task
from camwright.validation.servo.sampled_axis import axis_response
from camwright.validation.servo.simulation import memory

PHASES = 32
"""Places of the cycle at which a ramp begins; the servo's clock is another one each time."""

PLACES = 9
"""Places of the shear zone at which the error is looked at in each pass."""

HALVINGS = 60
"""Halvings by which the time of a place is found: to rounding."""

_GOLDEN = 0.5 * (5**0.5 - 1.0)


@dataclass(frozen=True, eq=False)
class RampedSync:
    """Sync error in the shear zone while the line ramps.

    Parameters
    ----------
    ways
        ``"speeding"``, ``"braking"``: the ramps that the line makes.
    line_speeds
        Of each way, line speed in the middle of each pass through the shear zone (m/s), all phases, shape ``(passes,)``.
    errors
        Greatest magnitude of the sync error in that pass (m), same shapes.
    """

    ways: tuple[str, ...]
    line_speeds: tuple[FloatArray, ...]
    errors: tuple[FloatArray, ...]

    @property
    def worst(self) -> tuple[float, float, str]:
        """Greatest error (m), the line speed at which it is reached (m/s), and the way."""
        found = [
            (float(errors.max()), float(speeds[int(errors.argmax())]), way)
            for way, speeds, errors in zip(self.ways, self.line_speeds, self.errors, strict=True)
        ]
        return max(found)


def ramped_sync(profile: CamProfile, task: Task, servo: Servo, phases: int = PHASES) -> RampedSync | None:
    """Run a line between standstill and its speed, up and down as hard as the job says, and the servo on its cam meanwhile.

    The line's acceleration comes and goes with its jerk, at once where that is not known. Before a braking ramp the line runs steadily as
    long as the servo remembers, and after one that speeds up too; a lead looks ahead along the ramp. Exact at the times that are looked at
    (`camwright.validation.servo.sampled_axis.axis_response`).

    Parameters
    ----------
    profile
        One cycle over ``[0, x_c]``.
    task
        The machine, its sync zone placed, the cut and the line.
    servo
        The servo, stable.
    phases
        Places of the cycle at which the ramp begins.

    Returns
    -------
    RampedSync or None
        ``None`` for a line that keeps its speed.
    """
    line, v = task.line, task.cut.line_speed
    ways = [
        (name, way, ramp)
        for name, way, ramp in (("speeding", 1.0, line.speeding), ("braking", -1.0, line.braking))
        if ramp
    ]
    if not ways:
        return None
    speeds, errors = [], []
    for _, way, ramp in ways:
        travel = line_travel(v, way * ramp, line.known_jerk, memory(servo.loop) * servo.sample_time + abs(servo.delay))
        passes = [_passes(profile, task, servo, travel, phase / phases) for phase in range(phases)]
        speeds.append(np.concatenate([each[0] for each in passes]))
        errors.append(np.concatenate([each[1] for each in passes]))
    kept = [number for number in range(len(ways)) if len(errors[number])]
    if not kept:
        return None
    return RampedSync(tuple(ways[k][0] for k in kept), tuple(speeds[k] for k in kept), tuple(errors[k] for k in kept))


def line_travel(speed: float, ramp: float, jerk: float, beside: float) -> CamProfile:
    """Travel of the line over time (m over s), from the beginning of a ramp between standstill and a speed; steady before and after.

    Parameters
    ----------
    speed
        The line speed (m/s).
    ramp
        The line's acceleration, negative for braking (m/s²); less where the jerk does not let it come up.
    jerk
        The line's jerk (m/s³), 0 where it is not known.
    beside
        How long the line is steady on the side where it runs (s).
    """
    size = abs(ramp) if not jerk else min(abs(ramp), (speed * jerk) ** 0.5)
    corner = size / jerk if jerk else 0.0
    hold = speed / size - corner
    way = 1.0 if ramp > 0 else -1.0
    lengths = [beside, corner, hold, corner, beside]
    jerks = [0.0, way * jerk, 0.0, -way * jerk, 0.0]
    starts = [0.0, 0.0, way * size, way * size, 0.0]
    breaks, rows = [-beside], []
    place, pace = (0.0, 0.0) if ramp > 0 else (-speed * beside, speed)
    for length, third, second in zip(lengths, jerks, starts, strict=True):
        if length <= 0.0:
            continue
        rows.append([place, pace, second / 2, third / 6])
        place += length * (pace + length * (second / 2 + length * third / 6))
        pace += length * (second + length * third / 2)
        breaks.append(breaks[-1] + length)
    return CamProfile.from_arrays(breaks, rows)


def _passes(
    profile: CamProfile, task: Task, servo: Servo, travel: CamProfile, phase: float
) -> tuple[FloatArray, FloatArray]:
    """Give the line speed and the greatest error of each pass through the shear zone, for a ramp that begins at a share of the cycle."""
    cut = task.cut
    origin = phase * cut.length
    first, last = origin, origin + float(travel(travel.end))
    start = cut.sync_start + cut.shear_zone_at
    cycles = np.arange(
        np.ceil((first - start) / cut.length), np.floor((last - start - cut.shear_zone) / cut.length) + 1
    )
    if not len(cycles):
        return np.zeros(0), np.zeros(0)
    along = cut.shear_zone_at + cut.shear_zone * np.linspace(0.0, 1.0, PLACES)
    master = cut.sync_start + along + cycles[:, None] * cut.length
    times = _times(travel, (master - origin).ravel())
    run = np.unique(times[(times > 0.0) & (times < travel.end)])
    if not len(run):
        return np.zeros(0), np.zeros(0)

    def command(at: FloatArray) -> FloatArray:
        inside = np.clip(at, travel.start, travel.end)
        beyond = (at - inside) * np.where(
            at > inside, float(travel(travel.end, 1, side="left")), float(travel(travel.start, 1))
        )
        return np.asarray(profile(origin + travel(inside) + beyond, outside="repeat"))

    early = travel.start - 2.0 * servo.sample_time
    position, _ = axis_response(servo, phase * _GOLDEN * servo.sample_time, command, np.append(early, run))
    axis = np.interp(times, run, position[1:]).reshape(master.shape)
    error = np.abs(_tool_error(profile, task, master, along, axis))
    usable = ((times > 0.0) & (times < travel.end)).reshape(master.shape)
    error = np.where(usable, error, 0.0)
    whole = usable.any(axis=1)
    middle = times.reshape(master.shape)[:, PLACES // 2]
    return np.asarray(travel(middle, 1))[whole], error.max(axis=1)[whole]


def _tool_error(profile: CamProfile, task: Task, master: FloatArray, along: FloatArray, axis: FloatArray) -> FloatArray:
    """Tool against the material (m), of an axis counted as the profile is repeated."""
    machine = task.machine
    ideal = task.slave_at_sync_start + task.sync(np.clip(along, task.sync.start, task.sync.end))
    counted = (
        ideal - task.slave_zero(profile) + np.zeros(master.shape)
    )  # as the profile counts it, but for whole pitches
    if machine.pitch:
        counted += machine.pitch * np.round((profile(master, outside="repeat") - counted) / machine.pitch)
    return np.asarray(machine.tool(ideal + (axis - counted)) - machine.tool(ideal + 0.0 * axis))


def _times(travel: CamProfile, places: FloatArray) -> FloatArray:
    """Find the times at which a line that never runs back is at places (m), by bisection; its end where it does not get there."""
    low, high = np.full(len(places), travel.start), np.full(len(places), travel.end)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        before = travel(middle) < places
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    return high
