"""The tables of a cut list as the drive will run them, and what happens at the seams between them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from camwright.drives.export import export_possible, read_back
from camwright.house.owned import Work, write_owned
from camwright.house.provenance import camwright_version
from camwright.jobs.table_units import default_units
from camwright.production.cams import ListCam
from camwright.production.changes import Change, Transition
from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.tables.knots import Accuracy, choose, table_units
from camwright.profiles.tables.target import Header
from camwright.profiles.tables.targets import target_of
from camwright.validation.production.seams import NO_JUMP, SeamJump, seam_jump
from camwright.validation.production.transition import judge_transition
from camwright.validation.rebuilt import ALLOWANCE

_TWICE = 2.0
"""Two tables meet at a seam, and each may be off by what is asked of one."""


@dataclass(frozen=True, eq=False)
class TargetSeams:
    """The tables of one target.

    Parameters
    ----------
    name, number_format
        The target, and how it stores its points.
    files
        Texts by file name; of tables that are released.
    jump
        Greatest steps at the seams that the list runs through, tables as read back.
    withheld
        Numbers of the cams whose table broke a limit, and why.
    refused
        Why the target cannot take a cam.
    within
        Whether all steps are within what two tables may be off.
    """

    name: str
    number_format: str
    files: dict[str, str]
    jump: SeamJump
    withheld: dict[int, str]
    refused: tuple[str, ...]
    within: bool

    @property
    def passed(self) -> bool:
        """Whether all tables are released and meet."""
        return self.within and not self.withheld and not self.refused

    def write(self, directory: Path, work: Work, told: Callable[[str], None]) -> list[Path]:
        """Write the tables into a folder of the target's own, where older ones of what is withheld now go; gives their paths."""
        folder = directory / self.name
        return sorted(write_owned(folder, work, self.files, told)) if self.files or folder.exists() else []


def transition_name(change: Change, number: int = 0) -> str:
    """Name a transition of a change, counted from 0, in the tables: with a letter where there are several."""
    letter = chr(ord("a") + number) if len(change.transitions) > 1 else ""
    return f"T{change.before:03d} to {change.after:03d}{letter}"


def list_tables(
    cams: Sequence[ListCam], changes: Mapping[tuple[int, int], Change], names: Sequence[str]
) -> tuple[TargetSeams, ...]:
    """Write the tables of all cams and transitions for each target, read them back, and run neighbours through each other's seams.

    Raises
    ------
    InputError
        An unknown target.
    """
    return tuple(_target_seams(cams, changes, name) for name in dict.fromkeys(names))


def _target_seams(cams: Sequence[ListCam], changes: Mapping[tuple[int, int], Change], name: str) -> TargetSeams:
    target = target_of(name)
    files: dict[str, str] = {}
    rebuilt: dict[int, CamProfile] = {}
    withheld: dict[int, str] = {}
    refused: list[str] = []
    for cam in cams:
        results, faults = export_possible(cam.solution.profile, cam.job, [name])
        refused += [f"cam {cam.number}: {fault}" for each in faults.values() for fault in each]
        for result in results:
            rebuilt[cam.number] = result.units.to_si(target.rebuild(result.table))
            files |= result.files
            failed = [check.name for check in result.judgement.checks if not check.passed]
            if failed:
                withheld[cam.number] = ", ".join(failed)
    jump, within = NO_JUMP, True
    by_number = {cam.number: cam for cam in cams}
    for change in changes.values():
        one, other = by_number[change.before], by_number[change.after]
        if not change.times or change.how == "stop" or not {one.number, other.number} <= rebuilt.keys():
            continue
        between: list[CamProfile] = []
        for number, transition in enumerate(change.transitions):
            try:
                text, run = _transition_table(change, number, other, name)
            except InputError as error:
                refused += [f"{transition_name(change, number)}: {fault}" for fault in error.faults]
                break
            refused += _beyond(run, transition_name(change, number), transition, other)
            files |= text
            between.append(run)
        if len(between) < len(change.transitions):
            continue
        worst = _through(one, other, rebuilt, between, change.line_speed)
        within = within and _allowed(worst, other, change.line_speed)
        jump = jump.worst(worst)
    for cam in cams:  # a cam runs into itself, too
        if cam.number in rebuilt:
            jump = jump.worst(_through(cam, cam, rebuilt, (), cam.line_speed))
    return TargetSeams(name, target.number_format, files, jump, withheld, tuple(refused), within)


def _beyond(rebuilt: CamProfile, name: str, transition: Transition, after: ListCam) -> list[str]:
    """Say where the motion that a drive makes of a transition's table exceeds speed or acceleration, beyond what any table may."""
    checks = judge_transition(rebuilt, after.running.zero, after.job.task.at_speed(transition.line_speed))
    return [
        f"{name}: {check.name} {check.value:.6g} {check.unit}, the limit is {check.limit:.6g}"
        for check in checks
        if check.name in ("speed", "acceleration") and (check.value or 0.0) > (check.limit or 0.0) * (1.0 + ALLOWANCE)
    ]


def _through(
    one: ListCam, other: ListCam, rebuilt: Mapping[int, CamProfile], between: Sequence[CamProfile], line_speed: float
) -> SeamJump:
    """Run from one table into another, through those of the transitions between."""
    chain = [(rebuilt[one.number], one.running.zero)]
    chain += [(run, other.running.zero) for run in between]
    chain.append((rebuilt[other.number], other.running.zero))
    found = NO_JUMP
    for (before, zero), (after, next_zero) in pairwise(chain):
        speed = min(line_speed, one.line_speed, other.line_speed)
        found = found.worst(seam_jump(before, zero, after, next_zero, other.job.task, speed))
    return found


def _allowed(jump: SeamJump, cam: ListCam, line_speed: float) -> bool:
    """Whether steps are within what is asked of two tables: position, ratio, and acceleration of the limit's."""
    asked, task = Accuracy(), cam.job.task
    lever = abs(float(task.machine.tool_ratio(task.slave_at_sync_end)))
    return (
        jump.position <= _TWICE * asked.position
        and jump.velocity <= _TWICE * asked.ratio * line_speed
        and jump.acceleration <= _TWICE * asked.acceleration * task.limits.acceleration * lever
    )


def _transition_table(change: Change, number: int, after: ListCam, name: str) -> tuple[dict[str, str], CamProfile]:
    """Write a transition's table, which runs once; its texts, and the motion that the drive makes of it."""
    target, job, transition = target_of(name), after.job, change.transitions[number]
    units = table_units(target, transition.profile, default_units(job.machine), travel=job.machine.pitch)
    choice = choose(transition.profile, target, units, Accuracy(), None, (job.cut.return_zone,))
    facts = (
        ("runs once, from cam", str(change.before)),
        ("into cam", str(change.after)),
        ("line speed at most", f"{transition.line_speed:.9g} m/s"),
    )
    head = Header(f"{transition_name(change, number)} {job.name}"[:60], camwright_version(), job.sha256, facts)
    files = target.write(choice.table, head)
    _, rebuilt = read_back(target, files, choice.table.units or units)
    return files, rebuilt
