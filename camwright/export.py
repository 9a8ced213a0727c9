"""Writing a cam for drives: points chosen, written, read back, rebuilt in the drive's numbers, and judged."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from camwright.job import Job
from camwright.progress import Step, ignore
from camwright.provenance import camwright_version, provenance
from profiles.errors import InputError
from profiles.polynomial import CamProfile
from profiles.tables.cam_table import CamTable, Unit, Units
from profiles.tables.deviation import Deviation, deviation
from profiles.tables.knots import Accuracy, Choice, choose, table_units
from profiles.tables.target import Header, Target
from profiles.tables.targets import TARGETS, read_table, target_of
from profiles.tables.text import decode

if TYPE_CHECKING:
    from validation.tables import TableJudgement

_MOST_NAMES = 50


@dataclass(frozen=True, eq=False)
class Exported:
    """A cam written for one target.

    Parameters
    ----------
    target
        The target.
    table
        The table as it was read back from the file.
    deviation
        How far the rebuilt motion is off the profile.
    judgement
        The checks on the rebuilt motion.
    files
        Texts by file name; none if the table was not released.
    """

    target: Target
    table: CamTable
    deviation: Deviation
    judgement: TableJudgement
    files: dict[str, str]

    @property
    def passed(self) -> bool:
        """Whether every check passed."""
        return self.judgement.passed


def export(
    profile: CamProfile,
    job: Job,
    names: Sequence[str],
    *,
    units: Units | None = None,
    accuracy: Accuracy | None = None,
    points: int | None = None,
    force: bool = False,
    step: Step = ignore,
) -> list[Exported]:
    """Write a cycle for drives.

    Every file is read back by the target's own reader, and the motion that the drive will make of it is judged over
    three wraps. A table that breaks a limit or the sync tolerance has no files, unless forced: then its head says so.

    Parameters
    ----------
    profile
        One cycle over the master period ``[0, x_c]``.
    job
        The job that it belongs to.
    names
        Names of targets.
    units
        Units of the tables; millimetres if not given.
    accuracy
        What the rebuilt motion may be off.
    points
        Number of points, for targets that leave a choice.
    force
        Write tables that were not released, too.
    step
        Told what begins now.

    Raises
    ------
    InputError
        An unknown target, or one that cannot take the cam; all faults at once.
    """
    targets = [target_of(name) for name in dict.fromkeys(names)]
    wanted = units or Units(Unit("mm", 1e-3), Unit("mm", 1e-3))
    results, faults = [], []
    for target in targets:
        step(f"writing for {target.name}")
        try:
            results.append(_export(profile, job, target, wanted, accuracy or Accuracy(), points, force))
        except InputError as error:
            faults += [f"{target.name}: {fault}" for fault in error.faults]
    if faults:
        raise InputError(*faults)
    return results


def _export(
    profile: CamProfile, job: Job, target: Target, wanted: Units, accuracy: Accuracy, points: int | None, force: bool
) -> Exported:
    choice = choose(profile, target, table_units(target, profile, wanted), accuracy, points)
    expected = _judged(choice.rebuilt, job)
    head = Header(job.name, camwright_version(), job.sha256, _facts(expected, job, choice.deviation))
    result = _written(profile, job, choice, target, head, expected)
    if result.passed:
        return result
    if not force:
        return replace(result, files={})
    failed = tuple(f"check {check.name} failed" for check in result.judgement.checks if not check.passed)
    return _written(profile, job, choice, target, replace(head, warnings=failed), expected)


def _written(
    profile: CamProfile, job: Job, choice: Choice, target: Target, head: Header, expected: TableJudgement
) -> Exported:
    """Write the table, read it back, and judge what the drive makes of it."""
    units = choice.table.units
    if units is None:
        raise InputError("the table's units were lost")
    files = target.write(choice.table, head)
    table, rebuilt = _read_back(target, files, units)
    same = np.array_equal(rebuilt.breaks, choice.rebuilt.breaks) and np.array_equal(
        rebuilt.coefficients, choice.rebuilt.coefficients
    )
    judgement = expected if same else _judged(rebuilt, job)  # the same numbers bit by bit are the same motion
    return Exported(target, table, deviation(profile, rebuilt), judgement, files)


def _read_back(target: Target, files: dict[str, str], units: Units) -> tuple[CamTable, CamProfile]:
    """Read the table out of the file as it will lie on the disk; the first file holds it."""
    name, text = next(iter(files.items()))
    table = read_table(target, decode(text.encode(), name), name)
    return table, (table.units or units).to_si(target.rebuild(table))


def _judged(rebuilt: CamProfile, job: Job) -> TableJudgement:
    from validation.tables import judge_table

    return judge_table(rebuilt, job.machine, job.cut, job.limits, job.servo)


def _facts(judgement: TableJudgement, job: Job, off: Deviation) -> tuple[tuple[str, str], ...]:
    """Give what the head says of the motion."""
    found = {check.name: check.value for check in judgement.checks}
    facts = [("line speed", f"{job.cut.line_speed:.9g} m/s")]
    for name, unit in (("speed", "m/s"), ("acceleration", "m/s^2"), ("jerk", "m/s^3")):
        facts.append((f"peak {name}", f"{found[name]:.6g} {unit}"))
    facts.append(("greatest error of the rebuilt position", f"{off.position * 1e6:.3g} um"))
    facts.append(("wraps judged", str(judgement.wraps)))
    return tuple(facts)


def export_answer(results: Sequence[Exported]) -> dict[str, Any]:
    """Answer of ``camwright export``."""
    return {
        "targets": {
            result.target.name: {
                "knots": result.table.points,
                "position_error_m": result.deviation.position,
                "acceleration_error_rel": result.deviation.acceleration,
                "passed": result.passed,
                "files": list(result.files),
            }
            for result in results
        }
    }


def export_report(results: Sequence[Exported], job: Job) -> dict[str, Any]:
    """Contents of ``report.json``: the answer, with ratio errors, checks, reader's notes and provenance."""
    from dataclasses import asdict

    answer = export_answer(results)
    for result in results:
        entry = answer["targets"][result.target.name]
        entry["ratio_error"] = result.deviation.ratio
        entry["wraps"] = result.judgement.wraps
        entry["number_format"] = result.target.number_format
        entry["interpolation"] = result.target.interpolation
        entry["tested_on_controller"] = result.target.tested_on_controller
        entry["notes"] = list(result.table.notes)
        entry["checks"] = [asdict(check) for check in result.judgement.checks]
    return {**answer, "job": job.name, "provenance": provenance(job.sha256)}


def targets_answer() -> list[dict[str, Any]]:
    """Answer of ``camwright targets``."""
    return [
        {
            "name": target.name,
            "title": target.title,
            "interpolation": target.interpolation,
            "max_points": target.max_points,
            "number_format": target.number_format,
            "evidence": target.evidence,
            "tested_on_controller": target.tested_on_controller,
        }
        for target in TARGETS.values()
    ]


def parse_targets(text: str) -> list[str]:
    """Read ``codesys,logix`` or ``all`` into names of targets.

    Raises
    ------
    InputError
        An unknown name, or none.
    """
    if text.strip() == "all":
        return list(TARGETS)
    names = [name.strip() for name in text.split(",") if name.strip()]
    if not names or len(names) > _MOST_NAMES:
        raise InputError(
            f"--to names one or more targets, separated by commas, or all; the targets are {', '.join(TARGETS)}"
        )
    return [target_of(name).name for name in names]


def parse_units(text: str, pitch: float, period: float) -> Units:
    """Read ``mm,deg`` into the units of master and slave.

    A degree or a turn is the part of the cycle: on the slave 360 deg are the pitch, on the master the cut length.

    Parameters
    ----------
    text
        Two units, separated by a comma.
    pitch
        Slave travel per cycle (m).
    period
        Master travel per cycle (m).

    Raises
    ------
    InputError
        Not two units, or one that is not known.
    """
    names = [name.strip() for name in text.split(",")]
    lengths = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "in": 0.0254}
    units = []
    for name, turn in zip(names, (period, pitch), strict=False):
        size = {**lengths, "deg": turn / 360.0, "rev": turn}.get(name)
        if size is None:
            raise InputError(f"--units: there is no unit {name[:20]!r}; the units are {', '.join(lengths)}, deg, rev")
        units.append(Unit(name, size))
    if len(names) != 2:
        raise InputError(f"--units takes the master's unit and the slave's, for example mm,deg; got {text[:40]!r}")
    return Units(units[0], units[1])
