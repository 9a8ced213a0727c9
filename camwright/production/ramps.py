"""`Ramps`: how a job's machine starts into the running line and stops out of it, and what one piece on demand takes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

from camwright.design.production.ramp_refusal import refused
from camwright.design.production.ramps import (
    Arcs,
    balanced,
    can_stand,
    highest_that_works,
    least_arcs,
    ramp_in,
    ramp_out,
    zone_kept,
)
from camwright.house.progress import Step, ignore
from camwright.jobs.job import Job
from camwright.profiles.closed_forms.transfer import State
from camwright.profiles.polynomial.profile import CamProfile, join
from camwright.profiles.ramp import Aim, Ramp, Stand, stand
from camwright.profiles.servo import spectral_radius
from camwright.profiles.task import Task
from camwright.studies.remedies import solve_or_advise
from camwright.validation.check import Check
from camwright.validation.production.run_up_bound import least_heat, least_peak, least_time, least_turn_peak
from camwright.validation.report import ValidationReport, judge
from camwright.validation.servo.simulation import memory

STEPS = 3
"""Steps that `ramps` tells."""

LATENCY = 0.01
"""Time from the sensor to the first set value that moves (s), where nothing else is said: sensor, bus and cycle of the controller."""


@dataclass(frozen=True, eq=False)
class Ramps:
    """A start, a stop, and both with a sync zone between them, at a job's line speed.

    Parameters
    ----------
    job
        The job, its machine with everything that the design chose.
    stand
        The machine beside its park.
    aim
        What was made least.
    arcs
        Least ways that start and stop need at the line speed, wherever the slave parks.
    fastest
        Highest line speed at which the slave can come to rest between two cuts; ``None`` where none was found.
    latency
        Time between the sensor and the start (s).
    """

    job: Job
    stand: Stand
    aim: Aim
    ramp_in: Ramp
    ramp_out: Ramp
    arcs: Arcs
    fastest: float | None
    latency: float

    @property
    def one_shot(self) -> CamProfile:
        """The cam of one piece on demand: from rest at the park through the sync zone to rest, from zero to zero."""
        start, zone, stop = self._parts
        return join(start, zone, stop)

    @property
    def start_table(self) -> CamProfile:
        """What a drive runs to start: to where the running cam begins, at the end of the sync zone or in its middle."""
        start, zone, _ = self._parts
        return join(start, zone if self.seam is None else zone.restrict(zone.start, zone.start + self.seam))

    @property
    def stop_table(self) -> CamProfile:
        """What a drive runs to stop, from where the running cam begins."""
        _, zone, stop = self._parts
        whole = stop if self.seam is None else join(zone.restrict(zone.start + self.seam, zone.end), stop)
        return whole.shift(-whole.start, -float(whole(whole.start)))

    @property
    def seam(self) -> float | None:
        """Where in the sync zone the running cam begins (m); ``None`` at its end."""
        return None if self.job.cut.origin == "return" else 0.5 * self.job.cut.sync_zone

    @property
    def _parts(self) -> tuple[CamProfile, CamProfile, CamProfile]:
        """Start, sync zone and stop one after the other, the slave from zero at the park."""
        start, at = self.ramp_in.profile, self.stand
        zone = at.zone.shift(start.end - at.zone.start, -at.park)
        return start, zone, self.ramp_out.profile.shift(zone.end, at.zone_end - at.park)

    @property
    def peak_acceleration(self) -> float:
        """Greatest acceleration of the one-shot cam (slave unit over s²)."""
        v = self.job.cut.line_speed
        zone = self.stand.zone.peak(2) * v**2
        return max(self.ramp_in.peak_acceleration, self.ramp_out.peak_acceleration, zone)

    @cached_property
    def bounds(self) -> tuple[float | None, float | None]:
        """Values below which no start and no stop from this park can be, in the unit of what was made least."""
        return lower_bounds(self.stand, self.aim)

    @property
    def least_sensor(self) -> float | None:
        """Distance ahead of the cut, at mid sync zone, at which a sensor must stand for the fastest start from any park (m)."""
        return None if self.arcs.run_up is None else self.arcs.run_up.master + self._beside

    @property
    def sensor(self) -> float:
        """The same for the start from this park, as it was designed (m)."""
        return self.ramp_in.master + self._beside

    @property
    def _beside(self) -> float:
        """Master beside that of the start: what passes in the latency, and up to the cut (m)."""
        cut = self.job.cut
        return self.latency * cut.line_speed + 0.5 * cut.sync_zone

    @property
    def zone_end(self) -> float:
        """Where on the master of the one-shot cam the sync zone ends (m)."""
        return self.ramp_in.profile.end + self.stand.zone.length

    @cached_property
    def report(self) -> ValidationReport:
        """The checks on the one-shot cam: limits, stroke, torque, and the servo from rest."""
        cycle, task = one_shot_cycle(self.stand, self.one_shot, self.zone_end, waiting(self.job))
        aware = self.job.servo_aware or self.job.cut.shaped
        return judge(cycle, task, self.job.servo, servo_aware=aware)

    @property
    def checks(self) -> tuple[Check, ...]:
        """Those checks of the report that are about start and stop, not about how short a cut may be."""
        return tuple(check for check in self.report.checks if not check.name.endswith("_cut_length"))

    @property
    def passed(self) -> bool:
        """Whether every check passed."""
        return all(check.passed for check in self.checks)


def ramps(
    job: Job,
    park: float | None = None,
    aim: Aim = "peak_acceleration",
    latency: float = LATENCY,
    step: Step = ignore,
    *,
    cam: CamProfile | None = None,
) -> Ramps:
    """Design the start and the stop of a job's machine, and judge them.

    Parameters
    ----------
    park
        Slave coordinate at which the slave stands (slave unit); chosen if not given: opposite the sync zone, or where start and stop need
        the same acceleration; a carriage waits at home.
    aim
        What is made least: the peak of the acceleration, the heat of one start, or the master that it takes.
    latency
        Time from the sensor to the first set value that moves (s).
    cam
        The running cam, if it is known, with the sync zone of the job's machine placed; designed where it is needed.

    Raises
    ------
    InfeasibleError
        The machine cannot start or stop from there at the line speed; the message says what would work, each change tried.

    Examples
    --------
    >>> from camwright import load_job
    >>> found = ramps(load_job())
    >>> round(found.ramp_in.peak_acceleration, 5), round(found.ramp_in.time * 1e3, 9), round(found.one_shot.length, 9)
    (9.07177, 150.0, 0.6)
    """
    step("placing the sync zone")
    placed, zone = _placed(job, cam)
    step("designing start and stop")
    free = park is None
    at = stand(placed.task, zone, park)
    at = balanced(at) if free else at
    first, last = ramp_in(at, aim), ramp_out(at, aim)
    if first is None or last is None or not zone_kept(at) or not at.parked_within:
        raise refused(at, free=free)
    step("finding where they end")
    arcs, fastest = least_arcs(at), highest_that_works(at, can_stand)
    return Ramps(placed, at, aim, first, last, arcs, fastest, latency)


def lower_bounds(at: Stand, aim: Aim) -> tuple[float | None, float | None]:
    """Values below which no start and no stop can be: peak, heat or master; ``None`` where no bound is known."""
    limits, v = at.task.limits, at.task.cut.line_speed
    a, j = limits.acceleration, limits.jerk

    def bound(way: float, end: State) -> float:
        if aim == "rms_acceleration":
            return least_heat(way, end, a, j)
        if aim == "shortest":
            return v * least_time(way, end, a, j)
        return least_peak(way, end, j)

    start = bound(at.run_up, at.into)
    if at.task.machine.guide is None:
        return start, bound(at.run_out, State(at.out_of.velocity, -at.out_of.acceleration))
    return start, least_turn_peak(at.out_of.velocity, at.room, j) if aim == "peak_acceleration" else None


def _placed(job: Job, cam: CamProfile | None) -> tuple[Job, CamProfile | None]:
    """Place the sync zone where the running cam has it, and take the zone of a shaped command from that cam."""
    if job.machine.placed and not job.cut.shaped:
        return job, None
    if cam is None:
        solution = solve_or_advise(job)
        job, cam = replace(job, machine=solution.machine), solution.profile
    return (job, _zone_of(cam, job)) if job.cut.shaped else (job, None)


def fastest_standing(job: Job) -> float | None:
    """Highest line speed at which the slave of a placed machine can come to rest between two cuts (m/s); None where none was found."""
    return highest_that_works(stand(job.task), can_stand)


def _zone_of(profile: CamProfile, placed: Job) -> CamProfile:
    """Cut the sync zone out of a cam, the slave counted as the machine counts it."""
    task, cut = placed.task, placed.cut
    start = cut.sync_start % cut.length
    cycle = profile.repeat(2)
    part = cycle.restrict(start, start + cut.sync_zone)
    back = 0.0 if cut.origin == "return" else task.machine.pitch
    # the cycle begins where the slave is one pitch short of where the zone that it ends with is
    shift = task.slave_zero(profile) - (task.machine.pitch if cut.origin == "return" else back)
    return part.shift(-start, shift)


def one_shot_cycle(at: Stand, run: CamProfile, zone_end: float, wait: float) -> tuple[CamProfile, Task]:
    """Make a run from rest to rest, with a wait, a cam of its own that begins at the end of the sync zone, and the task of that cam.

    Parameters
    ----------
    at
        The machine beside its park.
    run
        From rest at the park through the sync zone to rest.
    zone_end
        Where on its master the sync zone ends (m).
    wait
        Master that passes while the slave stands (m).
    """
    rest = CamProfile.from_arrays([run.end, run.end + wait], [[run.advance + float(run(run.start))]])
    cycle = join(run, rest).roll(zone_end)
    task = at.task.with_cut(replace(at.task.cut, length=cycle.length, origin="return"))
    if task.cut.shaped:
        cycle = cycle.shift(slave=at.zone_end - task.slave_at_start)
    return cycle.shift(-cycle.start).over(0.0, cycle.length), task


def waiting(job: Job) -> float:
    """Master that passes until the servo has forgotten what it did before (m)."""
    sample = job.cut.line_speed * job.servo.sample_time
    return sample * (memory(job.servo.loop) if spectral_radius(job.servo) < 1.0 else 1)
