"""Arguments that several commands take."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from camwright.house.units import quantity
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
To = Annotated[
    str | None,
    typer.Option(
        "--to", metavar="NAMES", help="Targets, separated by commas, or all; the job's, else csv, if left out."
    ),
]
CommonPlace = Annotated[
    bool, typer.Option("--common-place", help="Place the sync zone of a crank at one place for all designs.")
]


def out_folder(kind: str = "") -> Any:
    """Make the option of the output directory, which names the folder of this kind that is taken if it is left out."""
    return typer.Option("--out", metavar="DIR", help=f"Output directory; out/<name>{kind} if left out.")


Out = Annotated[Path | None, out_folder()]
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


def optional_quantity(option: str, text: str | None, kind: str, *, example: str) -> float | None:
    """Read the quantity of an option that may be left out."""
    return None if text is None else option_quantity(option, text, kind, example=example)


def option_quantity(option: str, text: str, kind: str, *, zero: bool = False, example: str | None = None) -> float:
    """Read the quantity of an option as `quantity` does; what is wrong with it is told with the option's name."""
    try:
        return quantity(text, kind, zero=zero, example=example)
    except InputError as error:
        raise InputError(*(f"{option}: {fault}" for fault in error.faults)) from error
