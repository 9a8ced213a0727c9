"""Tables that a controller adds, each times a power of the line speed: written, read back, and their sum judged at every line speed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from camwright.design.servo_aware.speed_tables import speed_cam
from camwright.drives.export import read_back
from camwright.house.provenance import camwright_version
from camwright.jobs.job import Job
from camwright.jobs.servos import servos_of
from camwright.jobs.table_units import default_units
from camwright.profiles.errors import InputError
from camwright.profiles.speed_cam import SpeedCam
from camwright.profiles.tables.cam_table import TableUnits
from camwright.profiles.tables.knots import Accuracy, choose
from camwright.profiles.tables.target import Header, Target, companion
from camwright.profiles.tables.targets import TARGETS, target_of
from camwright.validation.report import judge
from camwright.validation.servo.monte_carlo import shear_zone_errors

ORDERS = (2, 3)
"""Tables beside the position that are tried in turn: ratio and curvature, then the change of the curvature too."""

SPEEDS = 21
"""Line speeds at which the sum is judged."""

_SLOWEST = 0.1
"""Least line speed of a job that is not servo-aware, as a share of its own."""

_NEAR = 0.25
"""Share of the accuracy that each table may use up at the job's line speed."""


@dataclass(frozen=True)
class SummedTables:
    """The sum of the tables at a line speed.

    Parameters
    ----------
    line_speed
        In m/s.
    error
        Greatest sync error in the shear zone over all phases and the servos of the job's ranges (m).
    alone
        That of the position table alone (m).
    failed
        Checks that it fails.
    """

    line_speed: float
    error: float
    alone: float
    failed: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class SpeedTables:
    """Tables for one target, as they were read back.

    Parameters
    ----------
    cam
        The tables that the drive makes of the files, in SI units.
    units
        Units of the position table; the others are in the slave's unit per (m/s), (m/s)², …
    judged
        What their sum does, by line speed from the lowest up.
    files
        Texts by file name; none if a line speed fails a check.
    """

    target: Target
    cam: SpeedCam
    units: TableUnits
    judged: tuple[SummedTables, ...]
    files: dict[str, str]

    @property
    def error(self) -> float:
        """Greatest sync error over the line speeds (m)."""
        return max(each.error for each in self.judged)

    @property
    def up_to(self) -> float | None:
        """Highest line speed of those judged up to which all pass (m/s)."""
        failing = [number for number, each in enumerate(self.judged) if each.failed]
        last = failing[0] if failing else len(self.judged)
        return self.judged[last - 1].line_speed if last else None

    @property
    def passed(self) -> bool:
        """Whether every check passed at every line speed."""
        return not any(each.failed for each in self.judged)


def speed_tables(job: Job, target: Target) -> SpeedTables:
    """Make the fewest tables with which the axis keeps to the material at every line speed, write them and read them back.

    The position is not the job's optimum, whose jerk has jumps, but a smooth return (`camwright.design.servo_aware.speed_tables`).

    Parameters
    ----------
    job
        The job, its machine placed.
    target
        A target that adds cams scaled while they run.

    Returns
    -------
    SpeedTables
        Without files where no number of tables passes at every line speed; then those of the least sync error.

    Raises
    ------
    InputError
        The target cannot add them, or the sync zone is bent.
    """
    _require(job, target)
    found = []
    for order in ORDERS:
        found.append(_made(job, target, speed_cam(job.task, job.servo, order)))
        if found[-1].passed:
            return found[-1]
    best = min(found, key=lambda each: each.error)
    return replace(best, files={})


def _require(job: Job, target: Target) -> None:
    """Refuse what cannot have such tables."""
    if not target.adds_scaled:
        able = ", ".join(name for name, each in TARGETS.items() if each.adds_scaled)
        raise InputError(
            f"{target.name} has no documented way to add cams that are scaled while they run; --speed-tables goes with --to {able}"
        )
    if not job.task.straight:
        raise InputError(
            f"--speed-tables: the ratio of this {job.machine.noun} changes in its sync zone, and tables added by powers of the line speed "
            "keep a straight sync zone only; design it servo_aware over its line_speeds instead"
        )


def _made(job: Job, target: Target, cam: SpeedCam) -> SpeedTables:
    """Write tables, read them back, and judge their sum."""
    units, top = default_units(job.machine), job.cut.line_speed
    cut, files, tables = job.cut, dict[str, str](), []
    zones = (cut.return_zone,) if cut.origin == "return" else (0.5 * cut.sync_zone, cut.length - 0.5 * cut.sync_zone)
    for power, profile in enumerate(cam.tables):
        share = _NEAR / top**power
        near = Accuracy(position=share * 1e-6, ratio=share * 1e-3, acceleration=0.01)
        choice = choose(profile, target, units, near, zones=zones)
        unit = f"{units.slave.symbol}{f' per (m/s)^{power}' if power else ''}"
        what = f"{power} of {len(cam.tables) - 1}, times the line speed in m/s to the power {power}; in {unit}"
        facts = (("table", what),)
        head = Header(f"{job.name}-v{power}", camwright_version(), job.sha256, facts)
        written = target.write(choice.table, head)
        tables.append(read_back(target, written, units)[1].over(0.0, cut.length))
        files |= written
    found = SpeedCam(tuple(tables))
    judged = _judged(job, found)
    slowest, fastest = judged[0].line_speed * 60, top * 60
    lines = [
        f"camwright {camwright_version()}: {len(tables)} tables of {job.name}, each times a power of the line speed, for {target.title}",
        f"sync error from {slowest:.4g} to {fastest:.4g} m/min: at most {max(each.error for each in judged) * 1e3:.3g} mm",
        f"simulated with the servo of the job at {len(judged)} line speeds, each steady; while the line ramps it is off by more",
        f"evidence: {target.adds_scaled}",
    ]
    name = Header(job.name, "").identifier
    files[f"{name}_speed_tables.txt"] = companion(lines, _steps(len(tables)))
    return SpeedTables(target, found, units, judged, files)


def _steps(count: int) -> tuple[str, ...]:
    """Say what the engineer does with the tables."""
    added = (
        f"Add the tables v1 to v{count - 1} with MC_CamAdd on the same master, at the same master position, SlaveOffset 0, "
        "SlaveScaling 0 while the line stands."
    )
    scaled = (
        "In every cycle of the PLC set the SlaveScaling of table vk to the line speed in m/s to the power k, with MC_CamScaling_V2, master "
        "scaling MC_CAMSCALING_OFF, slave scaling MC_CAMSCALING_USERDEFINED: an automatic offset would keep the old place."
    )
    return (
        "Select all tables with MC_CamTableSelect, Periodic := TRUE.",
        "Couple the table v0 with MC_CamIn_V2, SlaveScaling 1.",
        added,
        scaled,
        "Take the speed that the master is commanded with, or a measured one smoothed over some cycles: its ripple goes into the command.",
        "It was not tested on a controller: watch the sum on a virtual axis first.",
    )


def _judged(job: Job, cam: SpeedCam) -> tuple[SummedTables, ...]:
    """Judge the sum at line speeds up to the job's."""
    slowest = job.slowest if job.servo_aware else _SLOWEST
    shaped = job.task.with_cut(replace(job.cut, shaped=True))
    found = []
    for speed in np.linspace(slowest, 1.0, SPEEDS if slowest < 1.0 else 1) * job.cut.line_speed:
        task, profile = shaped.at_speed(float(speed)), cam.at(float(speed))
        report = judge(profile, task, job.servo, servo_aware=True)
        errors = shear_zone_errors(profile, task, servos_of(job))
        failed = [check.name for check in report.checks if not check.passed]
        if errors.max() > job.cut.sync_tolerance and "shear_zone_error" not in failed:
            failed.append("servo_tolerance")
        alone = float(shear_zone_errors(cam.tables[0], task, (job.servo,))[0])
        found.append(SummedTables(float(speed), float(errors.max()), alone, tuple(failed)))
    return tuple(found)


def speed_tables_answer(found: Sequence[SpeedTables]) -> dict[str, Any]:
    """Answer of ``camwright export --speed-tables``."""
    return {
        "targets": [
            {
                "target": each.target.name,
                "passed": each.passed,
                "tables": len(each.cam.tables),
                "sync_error_mm": each.error * 1e3,
                "passes_up_to_m_per_min": None if each.up_to is None else each.up_to * 60,
                "line_speeds": [
                    {
                        "line_speed_m_per_min": at.line_speed * 60,
                        "sync_error_mm": at.error * 1e3,
                        "position_alone_mm": at.alone * 1e3,
                        "failed": list(at.failed),
                    }
                    for at in each.judged
                ],
                "files": sorted(each.files),
            }
            for each in found
        ]
    }


def named(names: Sequence[str]) -> list[Target]:
    """Give the targets of some names, each once."""
    return [target_of(name) for name in dict.fromkeys(names)]
