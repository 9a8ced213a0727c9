"""Start, stop and one-shot cam as tables for drives: written like every table, read back, and judged in their place between the others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, get_args

from camwright.drives.export import Exported, Stretch, export_possible, export_report
from camwright.drives.withheld import older_tables
from camwright.house.progress import Step, ignore
from camwright.house.provenance import camwright_version
from camwright.production.ramps import Ramps, one_shot_cycle, waiting
from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import CamProfile, join
from camwright.profiles.tables.target import Header
from camwright.profiles.tables.targets import target_of
from camwright.validation.rebuilt import TableJudgement, judge_table

RampKind = Literal["ramp_in", "ramp_out", "one_shot"]
"""A start, a stop, or one piece on demand."""

KINDS: tuple[RampKind, ...] = get_args(RampKind)
"""Motions that are written."""


@dataclass(frozen=True, eq=False)
class AllRampTables:
    """The tables of start, stop and one-shot cam.

    Parameters
    ----------
    results
        By the kind of motion: what each target makes of it; those without files are not released.
    refused
        By the kind of motion: targets that cannot take it, and why.
    """

    results: dict[RampKind, tuple[Exported, ...]]
    refused: dict[RampKind, dict[str, tuple[str, ...]]]

    @property
    def files(self) -> dict[str, str]:
        """Texts by the names of the files."""
        return {
            name: text for group in self.results.values() for result in group for name, text in result.files.items()
        }

    @property
    def passed(self) -> bool:
        """Whether every table was released."""
        return all(result.passed for group in self.results.values() for result in group)

    def older(self, found: Ramps, directory: Path) -> dict[str, dict[str, str]]:
        """Find older tables of what is withheld now: new names by old ones, by target and motion."""
        names: dict[str, dict[str, str]] = {}
        for kind in KINDS:
            withheld = [result.target for result in self.results[kind] if not result.files]
            withheld += [target_of(name) for name in self.refused[kind]]
            older = older_tables(directory, withheld, Header(f"{_named(kind)}-{found.job.name}", camwright_version()))
            names |= {f"{kind} {target}": files for target, files in older.items()}
        return names


def write_ramps(found: Ramps, names: Sequence[str], *, required: bool = True, step: Step = ignore) -> AllRampTables:
    """Write start, stop and one-shot cam for targets.

    A drive runs one of them once, between the park and the running cam. So its table is judged in that place: with the others, as they
    were designed, and a wait at rest it makes a cycle, and this is judged as any table is.

    Parameters
    ----------
    required
        Whether a target that can take none of the three is a fault.

    Raises
    ------
    InputError
        An unknown target, or one that can take none of the three.
    """
    profiles = {"ramp_in": found.start_table, "ramp_out": found.stop_table, "one_shot": found.one_shot}
    results, refused = {}, {}
    for kind in KINDS:
        step(f"writing the {kind.replace('_', ' ')}")
        made, not_taken = export_possible(
            profiles[kind], found.job, names, stretch=stretch_of(found, kind, profiles[kind])
        )
        results[kind], refused[kind] = tuple(made), not_taken
    hopeless = [name for name in names if required and all(name in refused[kind] for kind in KINDS)]
    if hopeless:
        raise InputError(*(f"{name}: {'; '.join(refused['one_shot'][name])}" for name in hopeless))
    return AllRampTables(results, refused)


def _named(kind: str) -> str:
    """Name a motion as the names of tables begin."""
    return kind.replace("_", "-")


def stretch_of(found: Ramps, kind: str, profile: CamProfile) -> Stretch:
    """Describe one of the motions: its zones, where it starts, and how what a drive makes of it is judged."""
    at, start, stop = found.stand, found.ramp_in.profile, found.ramp_out.profile
    whole, half = found.one_shot, found.seam
    cut_at = start.end + (at.zone.length if half is None else half)  # where one table hands over to the next

    def judged(rebuilt: CamProfile, stored: float = 0.0) -> TableJudgement:
        own = rebuilt.shift(-rebuilt.start, -float(rebuilt(rebuilt.start)))
        if kind == "ramp_in":
            run = _continued(own, whole.restrict(cut_at, whole.end))
        elif kind == "ramp_out":
            run = _continued(whole.restrict(whole.start, cut_at), own)
        else:
            run = own
        cycle, task = one_shot_cycle(at, run, found.zone_end, waiting(found.job))
        nominal, _ = one_shot_cycle(at, whole, found.zone_end, waiting(found.job))
        meant = task.with_length(nominal.length)
        return judge_table(cycle, meant, found.job.servo, stored=stored)

    zones: tuple[float, ...]
    if kind == "ramp_in":
        zones, begin = (start.end,), at.park
    elif kind == "ramp_out":
        zones = () if half is None else (profile.end - stop.length,)
        begin = at.park + float(whole(cut_at))
    else:
        zones, begin = (start.end, found.zone_end), at.park
    return Stretch(_named(kind), zones, begin, judged)


def _continued(first: CamProfile, then: CamProfile) -> CamProfile:
    """Let a motion go on where another ends, wherever that is."""
    return join(
        first, then.shift(first.end - then.start, first.advance + float(first(first.start)) - float(then(then.start)))
    )


def tables_answer(tables: AllRampTables, found: Ramps) -> dict[str, Any]:
    """Contents of the report on the tables: by the kind of motion as of ``camwright export``."""
    return {kind: export_report(tables.results[kind], found.job, tables.refused[kind]) for kind in KINDS}
