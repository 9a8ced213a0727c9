"""Writing a cam for drives: points chosen, written, read back, rebuilt in the drive's numbers, and judged."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from camwright.house.progress import Step, ignore
from camwright.house.provenance import camwright_version, provenance
from camwright.jobs.job import Job
from camwright.jobs.table_units import default_units, parse_units
from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.tables.cam_table import CamTable, TableUnits
from camwright.profiles.tables.deviation import Deviation, deviation
from camwright.profiles.tables.knots import (
    Accuracy,
    ChosenTable,
    choose,
    closing_cuts,
    table_units,
)
from camwright.profiles.tables.target import Header, Target
from camwright.profiles.tables.targets import TARGETS, read_table, target_of
from camwright.profiles.tables.text import decode
from camwright.validation.rebuilt import LEAST_WRAPS, RUN, TableJudgement, cuts_in, judge_table

DENSE = 1001
"""Points of a table that one might take for finer: in float32 its acceleration is worse."""

_PLACES = 20_001
_FINER = (1 / 4, 1 / 16, 1 / 64)
"""Parts of the accuracy asked for that are tried where a table so near to the cam breaks a limit that the cam runs along."""
_NEARER = {"speed", "acceleration", "jerk", "reversal", "sync_ratio"}
"""Checks that a table nearer to the cam may pass."""

_NO_DRIFT = 1e-12
"""A drift in a cut (m, or rad) that is rounding."""


@dataclass(frozen=True, eq=False)
class Exported:
    """A cam written for one target.

    Parameters
    ----------
    table
        The table as it was read back from the file.
    units
        Units of the table, whether its file states them or not.
    deviation
        How far the rebuilt motion is off the profile.
    position_error
        How far the tool of a slave in rad is off, along the material, else the slave (m).
    accurate
        Whether the motion is as near to the profile as was asked for.
    judgement
        The checks on the rebuilt motion.
    files
        Texts by file name; none if the table was not released.
    dense
        What a table of `DENSE` points would be like, for targets that round points to float32 and take any number.
    cuts
        Cuts in the table: several where its counts close after several only.
    drift
        What it goes beyond the pitch in a cut (slave unit).
    """

    target: Target
    table: CamTable
    units: TableUnits
    deviation: Deviation
    position_error: float
    accurate: bool
    judgement: TableJudgement
    files: dict[str, str]
    dense: ChosenTable | None = None
    cuts: int = 1
    drift: float = 0.0

    @property
    def passed(self) -> bool:
        """Whether every check passed."""
        return self.judgement.passed


@dataclass(frozen=True, eq=False)
class Stretch:
    """A motion that a drive runs once, and does not repeat: a start, a stop, one piece on demand.

    Parameters
    ----------
    name
        What the names of its tables begin with.
    zones
        Where zones begin and end inside it (m).
    slave_start
        Slave coordinate of the machine at its start (slave unit).
    judge
        Judges the motion that a drive makes of its table; the second argument as ``stored`` of `judge_table`.
    """

    name: str
    zones: tuple[float, ...]
    slave_start: float
    judge: Callable[[CamProfile, float], TableJudgement]


def export_possible(
    profile: CamProfile,
    job: Job,
    names: Sequence[str],
    *,
    units: TableUnits | None = None,
    accuracy: Accuracy | None = None,
    points: int | None = None,
    force: bool = False,
    stretch: Stretch | None = None,
    step: Step = ignore,
) -> tuple[list[Exported], dict[str, tuple[str, ...]]]:
    """Write a cycle for drives, or a motion that is run once, and say of those that cannot take it why not.

    Every file is read back by the target's own reader, and the motion that the drive will make of it is judged over
    three wraps. A table that breaks a limit or the sync tolerance has no files, unless forced: then its head says so.

    Parameters
    ----------
    profile
        One cycle over the master period ``[0, x_c]``.
    job
        The job that it belongs to, its machine with everything that the design chose.
    names
        Names of targets.
    units
        Units of the tables; millimetres if not given, degrees for a slave in rad.
    accuracy
        What the rebuilt motion may be off: the tool's position (m), the ratio as a part of the ratio in sync, the
        acceleration as a part of its peak.
    points
        Number of points, for targets that leave a choice.
    force
        Write tables that were not released, too.
    stretch
        The motion that is run once; the job's cycle if not given.

    Returns
    -------
    (results, refused)
        The tables; why not by the targets' names, all faults of each.

    Raises
    ------
    InputError
        An unknown target.
    """
    targets = [target_of(name) for name in dict.fromkeys(names)]
    wanted = _Wanted(units or default_units(job.machine), asked=units is not None)
    judge = _Judge(profile, job, stretch or _running(job))
    asked = _in_slave_units(accuracy or Accuracy(), judge)
    results, refused = [], {}
    for target in targets:
        step(f"writing for {target.name}")
        try:
            in_counts = units is None and target.counts and job.output.counts
            own = _Wanted(_counts_of(job), asked=True) if in_counts else wanted
            results.append(_export(profile, judge, target, own, asked, points, force))
        except InputError as error:
            refused[target.name] = tuple(error.faults)
    return results, refused


def _counts_of(job: Job) -> TableUnits:
    """Read the counts that a job names for its encoders."""
    try:
        return parse_units(job.output.counts, job.task)
    except InputError as error:
        raise InputError(*(fault.replace("--units", "[output] counts") for fault in error.faults)) from error


def stored_count(target: Target, job: Job, size: float) -> float:
    """Size of the count of a table in the counts that its job names (slave unit), as ``stored`` of `judge_table`; 0 for others."""
    return size if target.counts and job.output.counts else 0.0


def _running(job: Job) -> Stretch:
    """Describe the cycle of a job like a motion that is run once; its tables are called as the job."""
    cut = job.cut
    zones = (cut.return_zone,) if cut.origin == "return" else (0.5 * cut.sync_zone, cut.length - 0.5 * cut.sync_zone)

    def judge(rebuilt: CamProfile, stored: float) -> TableJudgement:
        return judge_table(rebuilt, job.task, job.servo, LEAST_WRAPS, RUN, stored)

    return Stretch("", zones, job.task.slave_at_start, judge)


def _in_slave_units(accuracy: Accuracy, judge: _Judge) -> Accuracy:
    """Turn what the tool may be off into what the slave may be off; nothing changes for a slave in m."""
    job, profile = judge.job, judge.profile
    if job.machine.slave_unit == "m":
        return accuracy
    y = judge.stretch.slave_start + profile(np.linspace(profile.start, profile.end, 721))
    lever = float(np.abs(job.machine.tool_ratio(y)).max())
    in_sync = abs(float(job.task.sync(0.0, 1)))
    return replace(accuracy, position=accuracy.position / lever, ratio=accuracy.ratio * in_sync)


@dataclass(frozen=True)
class _Wanted:
    """Units of tables, and whether the user named them."""

    units: TableUnits
    asked: bool


@dataclass(frozen=True, eq=False)
class _Judge:
    """Judges rebuilt motions, each once: the same numbers bit by bit are the same motion.

    Many targets take the same points and put the same quintics between them, and a file read back should hold what was
    written into it.
    """

    profile: CamProfile
    job: Job
    stretch: Stretch
    _known: dict[tuple[bytes, ...], tuple[Deviation, float, TableJudgement]] = field(default_factory=dict)

    def __call__(self, rebuilt: CamProfile, stored: float = 0.0) -> tuple[Deviation, float, TableJudgement]:
        """Deviation from the profile, `position_error`, and the checks."""
        numbers = (rebuilt.breaks, rebuilt.coefficients, np.array([stored]))
        key = tuple((each + 0.0).tobytes() for each in numbers)  # no negative zero
        if key not in self._known:
            meant = self.profile if self.stretch.name else covering(self.profile, rebuilt, self.job)
            off = deviation(meant, rebuilt)
            error = position_error(meant, rebuilt, off, self.job, self.stretch.slave_start)
            self._known[key] = off, error, self.stretch.judge(rebuilt, stored)
        return self._known[key]


def _export(
    profile: CamProfile,
    judge: _Judge,
    target: Target,
    wanted: _Wanted,
    accuracy: Accuracy,
    points: int | None,
    force: bool,
) -> Exported:
    job, zones, name = judge.job, judge.stretch.zones, judge.stretch.name
    units = table_units(target, profile, wanted.units, asked=wanted.asked, travel=job.machine.pitch)
    cuts = 1 if name else closing_cuts(target, profile, units)
    if cuts > 1:
        zones = tuple(at + k * job.cut.length for k in range(cuts) for at in zones)
        profile = profile.repeat(cuts)
    stored = units.slave.size if wanted.asked and target.counts else 0.0
    first = choose(profile, target, units, accuracy, points, zones)
    choice, error, expected = _nearer(
        judge,
        first,
        accuracy,
        stored,
        lambda to: choose(profile, target, units, to, points, zones),
        free=points is None,
    )
    if name:
        choice = replace(choice, table=replace(choice.table, periodic=False))
    facts = _facts(expected, job, error)
    if stored and not name:
        facts += (("cuts in this table", str(cuts)), ("drift of the slave in a cut", _drift_words(choice.rebuilt, job)))
    link = f"{profile.length / wanted.units.master.size:.12g}" if wanted.asked else ""
    head = Header("-".join(filter(None, (name, job.name))), camwright_version(), job.sha256, facts, link=link)
    result = _written(judge, choice, target, head, accuracy, stored)
    if target.number_format == "float32" and target.spacing == "free":
        dense = choose(profile, target, units, accuracy, DENSE, zones)
        result = replace(result, dense=dense)
    if result.passed:
        return result
    if not force:
        return replace(result, files={})
    failed = tuple(f"check {check.name} failed" for check in result.judgement.checks if not check.passed)
    forced = _written(judge, choice, target, replace(head, warnings=failed), accuracy, stored)
    return replace(forced, dense=result.dense)


def _nearer(
    judge: _Judge,
    first: ChosenTable,
    accuracy: Accuracy,
    stored: float,
    chosen: Callable[[Accuracy], ChosenTable],
    *,
    free: bool,
) -> tuple[ChosenTable, float, TableJudgement]:
    """Choose points nearer to the cam while a check fails that they may mend, if their number is free; the first where none helps."""
    choice = first
    _, error, expected = beginning = judge(first.rebuilt, stored)
    for part in _FINER if free and accuracy.kept_by(first.deviation) else ():
        if {check.name for check in expected.checks if not check.passed} - _NEARER or expected.passed:
            break
        choice = chosen(Accuracy(part * accuracy.position, part * accuracy.ratio, part * accuracy.acceleration))
        _, error, expected = judge(choice.rebuilt, stored)
    return (choice, error, expected) if expected.passed else (first, *beginning[1:])


def _written(
    judge: _Judge, choice: ChosenTable, target: Target, head: Header, accuracy: Accuracy, stored: float
) -> Exported:
    """Write the table, read it back, and judge what the drive makes of it."""
    units = choice.table.units
    if units is None:
        raise InputError("the table's units were lost")
    files = target.write(choice.table, head)
    table, rebuilt = read_back(target, files, units)
    off, error, judgement = judge(rebuilt, stored)
    kept, once = accuracy.kept_by(off), bool(judge.stretch.name)
    cuts, lost = (1, 0.0) if once else (cuts_in(rebuilt, judge.job.cut), drift(rebuilt, judge.job))
    return Exported(target, table, table.units or units, off, error, kept, judgement, files, cuts=cuts, drift=lost)


def covering(profile: CamProfile, rebuilt: CamProfile, job: Job) -> CamProfile:
    """Give the cycle, so often repeated as a table holds cuts."""
    cuts = cuts_in(rebuilt, job.cut)
    return profile if cuts == 1 else profile.repeat(cuts)


def drift(rebuilt: CamProfile, job: Job) -> float:
    """Tell what a table goes beyond the pitch in a cut (slave unit); negative where it falls short."""
    return rebuilt.advance / cuts_in(rebuilt, job.cut) - job.machine.pitch


def _drift_words(rebuilt: CamProfile, job: Job) -> str:
    off = drift(rebuilt, job)
    return "none" if abs(off) < _NO_DRIFT else f"{off:.3g} {job.machine.slave_unit}"


def position_error(profile: CamProfile, rebuilt: CamProfile, off: Deviation, job: Job, begin: float) -> float:
    """Greatest error of the slave (m); of a slave in rad the tool's, along the material (m), from its coordinate at the start."""
    if job.machine.slave_unit == "m":
        return off.position
    inner = np.union1d(profile.breaks, rebuilt.breaks)
    x = np.linspace(max(profile.start, rebuilt.start), min(profile.end, rebuilt.end), _PLACES)
    x = np.union1d(x, inner[(inner > x[0]) & (inner < x[-1])])
    return float(np.abs(job.machine.tool(begin + rebuilt(x)) - job.machine.tool(begin + profile(x))).max())


def read_back(target: Target, files: dict[str, str], units: TableUnits) -> tuple[CamTable, CamProfile]:
    """Read the table out of the file as it will lie on the disk; the first file holds it."""
    name, text = next(iter(files.items()))
    table = read_table(target, decode(text.encode(), name), name)
    return table, (table.units or units).to_si(target.rebuild(table))


def _facts(judgement: TableJudgement, job: Job, off: float) -> tuple[tuple[str, str], ...]:
    """Give what the head says of the motion."""
    found = {check.name: check for check in judgement.checks}
    facts = [("line speed", f"{job.cut.line_speed:.9g} m/s")]
    unit = job.machine.slave_unit
    for name, power in (("speed", "/s"), ("acceleration", "/s^2"), ("jerk", "/s^3")):
        check = found[name]
        how = "" if check.source == "exact" else f" ({check.source})"
        facts.append((f"peak {name}", f"{check.value:.6g} {unit}{power}{how}"))
    if job.machine.place_name:
        facts.append((job.machine.place_name, f"{job.machine.place!r} {job.machine.slave_unit}"))
    facts.append(("greatest error of the rebuilt position", f"{off * 1e6:.3g} um"))
    facts.append(("wraps judged", str(judgement.wraps)))
    return tuple(facts)


def export_answer(results: Sequence[Exported]) -> dict[str, Any]:
    """Answer of ``camwright export``."""
    return {
        "targets": {
            result.target.name: {
                "knots": result.table.points,
                "position_error_m": result.position_error,
                "acceleration_error_rel": result.deviation.acceleration,
                "passed": result.passed,
                "files": list(result.files),
            }
            for result in results
        }
    }


def export_report(
    results: Sequence[Exported], job: Job, refused: dict[str, tuple[str, ...]] | None = None
) -> dict[str, Any]:
    """Contents of ``report.json``: the answer, with ratio errors, checks, reader's notes and provenance, and who cannot take the cam."""
    answer = export_answer(results)
    for result in results:
        entry = answer["targets"][result.target.name]
        entry["ratio_error"] = result.deviation.ratio
        entry["within_asked_error"] = result.accurate
        entry["wraps"] = result.judgement.wraps
        entry["cuts"] = result.cuts
        entry["drift_per_cut"] = {"value": result.drift, "unit": job.machine.slave_unit, "run_cuts": RUN}
        entry["number_format"] = result.target.number_format
        entry["interpolation"] = result.target.interpolation
        entry["tested_on_controller"] = result.target.tested_on_controller
        if result.dense is not None:
            entry["dense"] = {
                "knots": result.dense.table.points,
                "acceleration_error_rel": result.dense.deviation.acceleration,
            }
        entry["notes"] = list(result.table.notes)
        entry["checks"] = [dict(vars(check)) for check in result.judgement.checks]
    reasons = {name: list(faults) for name, faults in (refused or {}).items()}
    return {**answer, "refused": reasons, "job": job.name, "provenance": provenance(job.sha256)}


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
