"""The command ``camwright check``."""

from __future__ import annotations

import math

from rich.console import RenderableType
from rich.text import Text

from camwright.answers.check import check_answer
from camwright.cli.options import GivenJob, Json, Quiet
from camwright.cli.views.numbers import millimetres, number
from camwright.house.output import Voice
from camwright.jobs.job import Job, load_job
from camwright.jobs.machine_words import machine_words


def run(job: GivenJob, as_json: Json = False, quiet: Quiet = False) -> int:
    """Read a job file and say whether it has faults."""
    asked = load_job(job)

    Voice(as_json, quiet).answer(lambda: check_answer(asked), lambda: _view(asked))
    return 0


def _view(job: Job) -> RenderableType:
    """Show what a job file says."""
    cut, limits, unit = job.cut, job.limits, job.machine.slave_unit
    speed = f"{number(limits.speed * 60)} m/min" if unit == "m" else f"{number(limits.speed * 30 / math.pi)} rpm"
    return Text(
        f"{job.name}: cut {millimetres(cut.length)} mm at {number(cut.line_speed * 60)} m/min, "
        f"{machine_words(job.machine)}, sync zone {millimetres(cut.sync_zone)} mm, "
        f"shear zone {millimetres(cut.shear_zone)} mm; at most {speed}, "
        f"{number(limits.acceleration)} {unit}/s², {number(limits.jerk)} {unit}/s³.\nThe job file has no faults."
    )
