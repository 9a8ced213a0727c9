"""Arguments that several commands take, and where their files go."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from camwright.house.owned import Work
from camwright.house.units import quantity
from camwright.jobs.job import Job
from camwright.profiles.errors import InputError

JobOrPaper = Annotated[
    Path | None, typer.Argument(metavar="[JOB]", help="Job file (TOML); the paper's job if left out.")
]
GivenJob = Annotated[Path, typer.Argument(metavar="JOB", help="Job file (TOML).")]
JudgedBy = Annotated[Path, typer.Option("--job", metavar="JOB", help="Job file (TOML) to judge it by.")]
StoredUnits = Annotated[
    str | None,
    typer.Option("--units", metavar="M,S", help="Units of master and slave, for files that state none: mm,deg."),
]
StoredTravel = Annotated[
    str | None,
    typer.Option("--travel", metavar="Q", help="Travel of the slave per cycle, for files that leave it out: 400 mm."),
]
TableTargets = Annotated[
    str | None,
    typer.Option(
        "--targets",
        metavar="NAMES",
        help="Targets of the tables, separated by commas, or all; else the job's, else csv.",
    ),
]
CommonPlace = Annotated[
    bool, typer.Option("--common-place", help="Place the sync zone of a crank at one place for all designs.")
]
Out = Annotated[Path | None, typer.Option("--out", metavar="DIR", help="Output directory; out/<name> if left out.")]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object instead of tables.")]
NoFigures = Annotated[bool, typer.Option("--no-figures", help="Write no figures.")]
TraceColumns = Annotated[
    str | None,
    typer.Option(
        "--columns",
        metavar="T,C,A",
        help="Columns of time, command and actual, by heading or number, where their names do not tell: 't [s],q_d [rad],q [rad]'.",
    ),
]
Quiet = Annotated[bool, typer.Option("--quiet", help="Print neither tables nor progress.")]


def option_quantity(option: str, text: str, kind: str, *, zero: bool = False, example: str | None = None) -> float:
    """Read the quantity of an option as `quantity` does; what is wrong with it is told with the option's name."""
    try:
        return quantity(text, kind, zero=zero, example=example)
    except InputError as error:
        raise InputError(*(f"{option}: {fault}" for fault in error.faults)) from error


def output_directory(out: Path | None, job: Job) -> Path:
    """Where the files of a job go."""
    return Path("out") / job.name if out is None else out


def job_work(command: str, job: Job, file: Path | None, out: Path | None) -> Work:
    """Say what a command makes of a job; where the user names no folder, another job of this name is told by its file."""
    return Work(command, job.name, job.sha256, file if out is None else None)


def final_paths(aside: Path, directory: Path) -> list[Path]:
    """Paths that the files aside will have."""
    return [directory / name for name in sorted(file.name for file in aside.iterdir())]
