"""The command ``camwright simulate``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from camwright.answers.measures import with_files
from camwright.cli.destination import destination
from camwright.cli.options import GivenJob, Json, NoFigures, Quiet, option_quantity, optional_quantity, out_folder
from camwright.cli.views.parts import View, files_view, new_table, new_text, stacked
from camwright.figures.shift import shift_figure
from camwright.figures.style import title
from camwright.house.numbers import number, unit_shown
from camwright.house.output import Voice
from camwright.house.provenance import camwright_version
from camwright.jobs.job import Job, load_job
from camwright.production.cut_list import line_of
from camwright.production.list_file import read_cut_list, read_line_run
from camwright.production.simulation import MOTIONS, Disturbances, MotionRuns, ShiftStudy, simulate_shift
from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import FloatArray

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
    out: Annotated[Path | None, out_folder("-shift")] = None,
    no_figures: NoFigures = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Simulate a shift: each piece's length and sync error, with the optimised cams and with linear returns."""
    given = load_job(job)
    rows = read_cut_list(cut_list)
    ramp = optional_quantity("--line-acceleration", line_acceleration, "acceleration", example="0.5 m/s^2")
    if line is not None and ramp is not None:
        raise InputError("--line-acceleration: the line's speed is given by --line; leave one of them out")
    wrong = Disturbances(_length("--noise", noise), slip, _length("--marks", marks), _servos(given, servos), seed)
    voice = Voice(as_json, quiet)
    with voice.progress(_STEPS) as step:
        if line is None:
            study = simulate_shift(line_of(given, ramp), rows, None, wrong, step)
        else:
            study = simulate_shift(given, rows, read_line_run(line), wrong, step)
    pictures = {} if no_figures else {"shift": shift_figure(study)}
    files = destination("simulate", given, job, out, "-shift").write({"pieces.csv": pieces_text(study)}, pictures)

    voice.answer(lambda: with_files(shift_answer(study), files), lambda: stacked(*_views(study), files_view(files)))
    return 0


def _servos(job: Job, asked: int | None) -> int:
    """Give the number of servos to draw."""
    if asked is not None:
        return asked
    return _USUAL_SERVOS if job.servo_tolerance is not None and job.servo_tolerance.varying else 0


def _length(option: str, text: str | None) -> float:
    """Read a length that may be left out."""
    return 0.0 if text is None else option_quantity(option, text, "length", zero=True, example="0.5 mm")


def _views(study: ShiftStudy) -> list[View]:
    """Show lengths and sync errors of both motions."""
    job = study.planned.job
    factor, unit = job.units.shown["m"].factor, unit_shown("m", job.units)
    answer = shift_answer(study)
    heads = (
        "",
        "length\nspread",
        "length\nworst",
        "sync error\n99 %",
        "sync error\nworst",
        "pieces\noutside",
        "of all\nservos",
    )
    table = new_table(
        f"{job.name}: {answer['pieces']} pieces in {number(study.cut_times[-1], 6)} s ({unit})", heads, left=("",)
    )
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


PIECES_HEADER = "piece,asked [mm],time [s],line speed [m/min]," + ",".join(
    f"{motion} length [mm],{motion} sync error [mm]" for motion in MOTIONS
)


def shift_answer(study: ShiftStudy) -> dict[str, Any]:
    """Answer of ``camwright simulate``."""
    planned, wrong = study.planned, study.disturbances
    tolerance = planned.job.cut.sync_tolerance
    return {
        "job": planned.job.name,
        "pieces": planned.asked.pieces,
        "material_m": float(study.lengths.sum()),
        "time_s": float(study.cut_times[-1]),
        "line": "given" if study.given else "planned",
        "pieces_too_fast": study.too_fast,
        "pieces_ramped_too_hard": study.too_hard,
        "servos": study.servos,
        "sync_tolerance_m": tolerance,
        "disturbances": {"noise_m": wrong.noise, "slip": wrong.slip, "marks_m": wrong.marks, "seed": wrong.seed},
        **{motion: _motion(run, tolerance) for motion, run in study.runs.items()},
        "histogram": {
            "edges_m": study.edges.tolist(),
            **{motion: [int(count) for count in study.histogram(motion)] for motion in MOTIONS},
        },
    }


def _motion(run: MotionRuns, tolerance: float) -> dict[str, Any]:
    """Measures of one motion."""
    return {
        "length_error_m": _spread(run.length_errors),
        "sync_error_m": _spread(run.nominal.sync_errors),
        "pieces_outside_tolerance": run.outside(tolerance),
        "worst_piece": int(run.nominal.sync_errors.argmax()) + 1,
        "all_servos": {
            "length_error_m": float(run.worst_length_errors.max()),
            "sync_error_m": float(run.worst_sync_errors.max()),
            "pieces_outside_tolerance": int((run.worst_sync_errors > tolerance).sum()),
        },
    }


def _spread(values: FloatArray) -> dict[str, float]:
    """Mean, standard deviation, and the greatest magnitude, of all and of all but one in a hundred."""
    size = np.abs(values)
    return {
        "mean": float(values.mean()),
        "deviation": float(values.std()),
        "of_99_percent": float(np.quantile(size, 0.99)),
        "worst": float(size.max()),
    }


def pieces_text(study: ShiftStudy) -> str:
    """Write the table of pieces, with the job's own servo."""
    job = study.planned.job
    speeds = study.planned.line.speed(study.cut_times) * 60
    columns = [np.arange(1, len(study.lengths) + 1), study.lengths * 1e3, study.cut_times, speeds]
    for motion in MOTIONS:
        run = study.runs[motion].nominal
        columns += [run.lengths * 1e3, run.sync_errors * 1e3]
    lines = [f"# camwright {camwright_version()}: {job.name}", f"# job SHA-256: {job.sha256}", PIECES_HEADER]
    lines += [
        ",".join([str(int(row[0])), *(f"{value:.9g}" for value in row[1:])])
        for row in np.column_stack(columns).tolist()
    ]
    return "\n".join(lines) + "\n"
