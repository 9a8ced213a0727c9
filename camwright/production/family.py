"""`Family`: the fewest cams that cover a job's line speeds, the changes between them, and their tables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from camwright.house.progress import Step, ignore
from camwright.jobs.job import Job
from camwright.production.family_cams import FamilyCam, FamilyCams, family_cams
from camwright.production.switching import Switching, switchings
from camwright.production.tables import TargetSeams, list_tables
from camwright.studies.family_bands import OVERLAP


@dataclass(frozen=True, eq=False)
class Family:
    """A family of cams, worked out.

    Parameters
    ----------
    switchings
        The changes between neighbours, from the slowest pair up.
    """

    found: FamilyCams
    switchings: tuple[Switching, ...]
    tables: tuple[TargetSeams, ...]

    @property
    def cams(self) -> tuple[FamilyCam, ...]:
        """Its cams, from the slowest up."""
        return self.found.cams

    @property
    def passed(self) -> bool:
        """Whether every cam, change and table passed its checks."""
        parts: tuple[FamilyCam | Switching | TargetSeams, ...] = (*self.cams, *self.switchings, *self.tables)
        return all(part.passed for part in parts)


def family(job: Job, names: Sequence[str], overlap: float = OVERLAP, step: Step = ignore) -> Family:
    """Cover a job's line speeds with the fewest cams, and lead from each to its neighbours.

    Parameters
    ----------
    job, overlap
        As in `camwright.production.family_cams.family_cams`.
    names
        Targets of the tables.

    Raises
    ------
    InputError
        As there; an unknown target.
    InfeasibleError, SolverError
        As there.
    """
    found = family_cams(job, overlap, step)
    step("leading from cam to cam")
    between = switchings(found)
    if not found.holds_line and not all(each.passed for each in between):  # over a narrower part they may
        found = family_cams(job, overlap, step, hold=True)
        between = switchings(found)
    step("writing the tables and running their seams")
    changes = {(each.before, each.after): each for one in between for each in one.changes}
    return Family(found, between, list_tables(found.cams, changes, names))
