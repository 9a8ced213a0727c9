"""The command ``camwright check``."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from camwright.cli.options import Json, Quiet
from camwright.cli.views.parts import View, new_text, stacked
from camwright.house.numbers import typed, with_unit
from camwright.house.output import Voice
from camwright.house.toml_file import MOST_BYTES
from camwright.jobs.doubts import doubts
from camwright.jobs.job import Job, load_job, parse_job
from camwright.jobs.machine_words import machine_words
from camwright.jobs.numbers import job_numbers
from camwright.profiles.errors import InputError

_Checked = Annotated[Path, typer.Argument(metavar="JOB", help="Job file (TOML); - reads standard input.")]


def run(job: _Checked, as_json: Json = False, quiet: Quiet = False) -> int:
    """Read a job file and say whether it has faults."""
    asked = parse_job(_typed(), "standard input") if str(job) == "-" else load_job(job)

    Voice(as_json, quiet).answer(lambda: check_answer(asked), lambda: _view(asked))
    return 0


def _typed() -> str:
    """Read a job from standard input."""
    data = sys.stdin.buffer.read(MOST_BYTES + 1)
    if len(data) > MOST_BYTES:
        raise InputError(f"standard input: larger than {MOST_BYTES} bytes, the most that a job file may have")
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        raise InputError(f"standard input: not UTF-8 text (byte {error.start})") from error


def _view(job: Job) -> View:
    """Show what a job file says."""
    cut, limits, unit, units = job.cut, job.limits, job.machine.slave_unit, job.units
    speed = with_unit(limits.speed, "m/s", units=units) if unit == "m" else typed(limits.speed, "rad/s", 5)
    acceleration, jerk = (
        with_unit(value, unit + power, units=units)
        for value, power in ((limits.acceleration, "/s^2"), (limits.jerk, "/s^3"))
    )
    found = doubts(job)
    said = new_text(
        f"{job.name}: cut {with_unit(cut.length, 'm', 4, units)} at {with_unit(cut.line_speed, 'm/s', units=units)}, "
        f"{machine_words(job.machine, units=units)}, sync zone {with_unit(cut.sync_zone, 'm', 4, units)}, "
        f"shear zone {with_unit(cut.shear_zone, 'm', 4, units)}; at most {speed}, {acceleration}, {jerk}.\nThe job file has no faults."
    )
    notes = [new_text(f"Warning: {text}", "yellow") for text in found.warnings]
    if found.missing:
        notes.append(new_text("\n".join(["Optional and not given:", *(f"  {text}" for text in found.missing)])))
    return stacked(said, *notes)


def check_answer(job: Job) -> dict[str, Any]:
    """Answer of ``camwright check``: the job in SI numbers, and what is worth a second look."""
    found = doubts(job)
    return {
        "job": job.name,
        "sha256": job.sha256,
        "si": job_numbers(job),
        "warnings": list(found.warnings),
        "missing": list(found.missing),
    }
