"""The command ``camwright simulate``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from camwright.cli.options import GivenJob, Json, NoFigures, Quiet, final_paths, job_work, option_quantity
from camwright.cli.views.files import files_view
from camwright.cli.views.parts import new_table, new_text, stacked
from camwright.figures.shift import shift_figure
from camwright.figures.style import title
from camwright.house.numbers import number, unit_shown
from camwright.house.output import Voice, complain
from camwright.house.owned import owned
from camwright.jobs.job import Job, load_job
from camwright.production.cut_list import line_of
from camwright.production.list_file import read_cut_list, read_line_run
from camwright.production.shift_answer import pieces_text, shift_answer
from camwright.production.simulation import MOTIONS, Disturbances, ShiftStudy, simulate_shift
from camwright.profiles.errors import InputError

if TYPE_CHECKING:
    from rich.console import RenderableType

_STEPS = 6
_MOST_SLIP = 0.1
_MOST_SERVOS, _USUAL_SERVOS = 200, 8


def run(
    job: GivenJob,
    cut_list: Annotated[
        Path, typer.Option("--list", metavar="LIST", help="Cut list (CSV): length, quantity and kind.")
    ],
    line: Annotated[
        Path | None,
        typer.Option("--line", metavar="PROFILE", help="Line speed over time (CSV); the fastest plan if left out."),
    ] = None,
    line_acceleration: Annotated[
        str | None,
        typer.Option(
            "--line-acceleration", metavar="A", help='Ramp of the planned line, e.g. "0.5 m/s^2"; else the job\'s.'
        ),
    ] = None,
    noise: Annotated[
        str | None,
        typer.Option("--noise", metavar="LENGTH", help='Noise of the encoder at each sample (RMS), e.g. "5 um".'),
    ] = None,
    slip: Annotated[
        float,
        typer.Option(
            "--slip",
            metavar="SHARE",
            min=0.0,
            max=_MOST_SLIP,
            help="Slip of the measuring wheel from piece to piece (RMS).",
        ),
    ] = 0.0,
    marks: Annotated[
        str | None,
        typer.Option("--marks", metavar="LENGTH", help='By how much print marks are off (RMS), e.g. "0.5 mm".'),
    ] = None,
    servos: Annotated[
        int | None,
        typer.Option(
            "--servos",
            metavar="N",
            min=0,
            max=_MOST_SERVOS,
            help="Servos drawn from [servo.tolerance], beside the job's own; 8 if left out and the job gives ranges.",
        ),
    ] = None,
    seed: Annotated[
        int, typer.Option("--seed", metavar="N", min=0, max=2**32 - 1, help="Seed of all that is drawn.")
    ] = 1,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Output directory; out/<name>-shift if left out.")
    ] = None,
    no_figures: NoFigures = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Simulate a shift: each piece's length and sync error, with the optimised cams and with linear returns."""
    given = load_job(job)
    rows = read_cut_list(cut_list)
    ramp = (
        None
        if line_acceleration is None
        else option_quantity("--line-acceleration", line_acceleration, "acceleration", example="0.5 m/s^2")
    )
    if line is not None and ramp is not None:
        raise InputError("--line-acceleration: the line's speed is given by --line; leave one of them out")
    wrong = Disturbances(_length("--noise", noise), slip, _length("--marks", marks), _servos(given, servos), seed)
    voice = Voice(as_json, quiet)
    with voice.progress(_STEPS) as step:
        if line is None:
            study = simulate_shift(line_of(given, ramp), rows, None, wrong, step)
        else:
            study = simulate_shift(given, rows, read_line_run(line), wrong, step)
    directory = Path("out") / f"{given.name}-shift" if out is None else out
    with owned(directory, job_work("simulate", given, job, out), complain) as aside:
        (aside / "pieces.csv").write_bytes(pieces_text(study).encode())
        if not no_figures:
            shift_figure(study, aside)
        files = final_paths(aside, directory)

    def data() -> dict[str, Any]:
        return {**shift_answer(study), "files": [str(file) for file in files]}

    voice.answer(data, lambda: stacked(*_views(study), files_view(files)))
    return 0


def _servos(job: Job, asked: int | None) -> int:
    """Give the number of servos to draw."""
    if asked is not None:
        return asked
    return _USUAL_SERVOS if job.servo_tolerance is not None and job.servo_tolerance.varying else 0


def _length(option: str, text: str | None) -> float:
    """Read a length that may be left out."""
    return 0.0 if text is None else option_quantity(option, text, "length", zero=True, example="0.5 mm")


def _views(study: ShiftStudy) -> list[RenderableType]:
    """Show lengths and sync errors of both motions."""
    job = study.planned.job
    factor, unit = job.units.shown["m"].factor, unit_shown("m", job.units)
    answer = shift_answer(study)
    table = new_table(
        title=f"{job.name}: {answer['pieces']} pieces in {study.cut_times[-1]:.6g} s ({unit})", title_justify="left"
    )
    heads = (
        "",
        "length\nspread",
        "length\nworst",
        "sync error\n99 %",
        "sync error\nworst",
        "pieces\noutside",
        "of all\nservos",
    )
    for name in heads:
        table.add_column(name, justify="right" if name else "left")
    for motion in MOTIONS:
        found = answer[motion]
        table.add_row(
            title(motion),
            number(found["length_error_m"]["deviation"] * factor, 4),
            number(found["length_error_m"]["worst"] * factor, 4),
            number(found["sync_error_m"]["of_99_percent"] * factor, 4),
            number(found["sync_error_m"]["worst"] * factor, 4),
            str(found["pieces_outside_tolerance"]),
            number(found["all_servos"]["sync_error_m"] * factor, 4),
        )
    said = [f"servos run: {study.servos}; line {answer['line']}; seed {study.disturbances.seed}"]
    if study.too_fast:
        said.append(
            f"the line runs faster than the cam may on {study.too_fast} pieces: camwright cutlist gives the highest speeds"
        )
    if study.too_hard:
        said.append(
            f"the line ramps harder than the cam bears on {study.too_hard} pieces: camwright limits says what it bears"
        )
    return [table, new_text("\n".join(said))]
