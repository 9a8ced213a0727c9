"""Tables as files of a directory, with their report: released ones are written, older ones of what is withheld are set aside."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from camwright.drives.export import Exported, export_possible, export_report
from camwright.drives.options import parse_targets
from camwright.drives.withheld import older_tables, setting_aside
from camwright.house.files import fill
from camwright.house.json_text import to_json
from camwright.house.owned import Work
from camwright.house.progress import Step, ignore
from camwright.house.provenance import camwright_version
from camwright.jobs.job import Job
from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.tables.cam_table import TableUnits
from camwright.profiles.tables.knots import Accuracy
from camwright.profiles.tables.target import Header
from camwright.profiles.tables.targets import target_of


class OfJob(Protocol):
    """A cam and the job that it is for: a design, or one read from a file."""

    @property
    def profile(self) -> CamProfile:
        """One cycle over the master period ``[0, x_c]``."""

    @property
    def job(self) -> Job:
        """Its job, the machine with everything that the design chose."""


@dataclass(frozen=True, eq=False)
class TableFiles:
    """What an export has left in a directory.

    Parameters
    ----------
    results
        The tables, those without files not released.
    refused
        Targets that cannot take the cam, and why.
    older
        By target: older files of tables that are withheld now, and what they are called instead.
    files
        The files written, ``report.json`` the last.
    """

    results: tuple[Exported, ...]
    refused: Mapping[str, tuple[str, ...]]
    older: Mapping[str, Mapping[str, str]]
    files: tuple[Path, ...]

    @property
    def passed(self) -> bool:
        """Whether every table was released."""
        return all(result.passed for result in self.results)


def export(
    design: OfJob,
    to: str | Sequence[str],
    directory: str | Path,
    *,
    units: TableUnits | None = None,
    accuracy: Accuracy | None = None,
    points: int | None = None,
    force: bool = False,
    step: Step = ignore,
    told: Callable[[str], None] = ignore,
) -> TableFiles:
    """Write a cam for drives into a directory.

    Parameters
    ----------
    design
        What `camwright.optimise` or `camwright.read_design` gives.
    to
        Names of targets, or ``"all"``: then those that cannot take the cam are named, not refused.
    directory
        Where the files shall stand; made if it is missing.
    units, accuracy, points, force, step
        As of `camwright.drives.export.export`.
    told
        Told of tables that are replaced and were not of this design.

    Raises
    ------
    InputError
        An unknown target, one that cannot take the cam, or a file that cannot be written; then none is.

    Examples
    --------
    >>> import tempfile
    >>> from camwright import export, load_job, optimise
    >>> written = export(optimise(load_job()), ["csv", "trio"], tempfile.mkdtemp())
    >>> written.passed, [file.name for file in written.files]
    (True, ['paper_600_cam.csv', 'paper_600_trio.bas', 'paper_600_trio.txt', 'report.json'])
    """
    asked = to if isinstance(to, str) else ",".join(to)
    names, job, place = parse_targets(asked), design.job, Path(directory)
    results, refused = export_possible(
        design.profile, job, names, units=units, accuracy=accuracy, points=points, force=force, step=step
    )
    if refused and (asked.strip() != "all" or not results):
        raise InputError(*(f"{name}: {fault}" for name, faults in refused.items() for fault in faults))
    step("writing files")
    withheld = [result.target for result in results if not result.files] + [target_of(name) for name in refused]
    older = older_tables(place, withheld, Header(job.name, camwright_version()))
    texts = {name: text for result in results for name, text in result.files.items()}
    texts["report.json"] = to_json({**export_report(results, job, refused), "set_aside": older})
    with setting_aside(place, Work("export", job.name, _sum(design), adds=True), older, told) as aside:
        fill(aside, texts)
    return TableFiles(tuple(results), refused, older, tuple(place / name for name in texts))


def _sum(design: OfJob) -> str:
    """SHA-256 of a cam and its job."""
    numbers = (design.profile.breaks.tobytes(), design.profile.coefficients.tobytes())
    return hashlib.sha256(b"".join((design.job.sha256.encode(), *numbers))).hexdigest()
