"""The command ``camwright marks``."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from camwright.answers.measures import millimetres
from camwright.cli.destination import destination
from camwright.cli.options import GivenJob, Json, NoFigures, Quiet, option_quantity, out_folder
from camwright.cli.views.parts import View, files_view, new_table, new_text, stacked
from camwright.figures.print_marks import print_marks_figure
from camwright.house.json_text import to_json
from camwright.house.numbers import Units, number, unit_shown, with_unit
from camwright.house.output import Voice
from camwright.jobs.job import load_job
from camwright.jobs.wording import in_job_words
from camwright.production.mark_offsets import DeadTime, dead_time
from camwright.production.marks import STEPS, Marks, marks
from camwright.profiles.closed_forms.mark_loop import best_gain
from camwright.profiles.errors import InputError
from camwright.profiles.mark_range import MarkRange

MOST_DELAY = 1000
"""Most cuts by which an error may be known late."""


def run(
    job: GivenJob,
    delay: Annotated[
        int,
        typer.Option("--delay", metavar="N", help="Cuts between a cut and the first one that its error can correct."),
    ] = 0,
    offsets: Annotated[
        Path | None,
        typer.Option(
            "--offsets", metavar="FILE", help="Measured offsets over line speeds (CSV), for the sensor's dead time."
        ),
    ] = None,
    noise: Annotated[
        str | None, typer.Option("--noise", metavar="LENGTH", help="Standard deviation of the sensor; with --stretch.")
    ] = None,
    stretch: Annotated[
        str | None,
        typer.Option(
            "--stretch", metavar="LENGTH", help="Standard deviation of the material's stretch in one cut; with --noise."
        ),
    ] = None,
    out: Annotated[Path | None, out_folder("-marks")] = None,
    as_json: Json = False,
    no_figures: NoFigures = False,
    quiet: Quiet = False,
) -> int:
    """Say how early and how late a print mark may come, by what the controller does, and how to tune its loop."""
    if not 0 <= delay <= MOST_DELAY:
        raise InputError(f"--delay takes 0 to {MOST_DELAY} cuts; got {delay}")
    wander = _wander(noise, stretch)
    dead = None if offsets is None else dead_time(offsets)
    asked = load_job(job)
    voice = Voice(as_json, quiet)
    with voice.progress(STEPS) as step:
        with in_job_words(asked.units):
            found = marks(asked, delay, step)
        step("writing files")
        texts = {"marks.csv": clamp_table(found), "marks.json": to_json(marks_answer(found, dead, wander))}
        pictures = {} if no_figures else {"marks": print_marks_figure(found)}
        files = destination("marks", asked, job, out, "-marks").write(texts, pictures)
    voice.answer(lambda: marks_answer(found, dead, wander), lambda: _view(found, dead, wander, files))
    return 0 if found.proved else 1


def _wander(noise: str | None, stretch: str | None) -> tuple[float, float] | None:
    """Read the standard deviations of stretch and sensor."""
    if noise is None and stretch is None:
        return None
    if noise is None or stretch is None:
        raise InputError("--noise and --stretch go together: the best gain weighs one against the other")
    found = (
        option_quantity("--stretch", stretch, "length", zero=True, example="0.5 mm"),
        option_quantity("--noise", noise, "length", zero=True, example="0.5 mm"),
    )
    if found == (0.0, 0.0):
        raise InputError("--noise and --stretch are both zero: there is nothing to weigh")
    return found


def _view(found: Marks, dead: DeadTime | None, wander: tuple[float, float] | None, files: Sequence[Path]) -> View:
    """Show the ranges at the job's line speed and below, the loop, and the dead time."""
    units = found.job.units
    here = new_table(
        f"A print mark at {with_unit(found.here.line_speed, 'm/s', units=units)} ({unit_shown('m', units)})",
        ("what the controller does", "earliest", "latest", "by acceleration alone"),
        ("what the controller does",),
    )
    for words, ends, alone in (
        ("next length, designed anew", found.here.redesign, None),
        ("phase of the master, cam as it is", found.here.master_phase, found.phase_alone),
        ("offset of the slave, cam as it is", found.here.slave_offset, found.offset_alone),
    ):
        if ends is None:
            here.add_row(words, "not in sync", "not in sync", "")
            continue
        here.add_row(words, *_ends(ends, units), "" if alone is None else " to ".join(_ends(alone, units)))
    heads = (unit_shown("m/s", units), "designed anew", "phase", "offset")
    table = new_table(f"Earliest and latest over the line speed ({unit_shown('m', units)})", heads)
    for each in found.by_speed:
        table.add_row(
            with_unit(each.line_speed, "m/s", units=units),
            *("–" if part is None else " to ".join(_ends(part, units)) for part in each.ranges.values()),
        )
    proved = (
        "cams at both ends were designed, none 1 % beyond"
        if found.proved
        else "NOT PROVED: a cam at an end was not designed, or one beyond was"
    )
    return stacked(
        here,
        table,
        new_text(
            "\n".join([proved, *_loop(found, wander, units), *_dead(dead, units)]), "" if found.proved else "bold red"
        ),
        files_view(files),
    )


def _loop(found: Marks, wander: tuple[float, float] | None, units: Units) -> list[str]:
    """Say how much of an error to correct."""
    lines = [
        (
            f"loop with {found.delay} cuts of delay: gain below {number(found.greatest_gain, 4)}, without overshoot up to "
            f"{number(found.gain, 4)}; then the cut has {number(found.noise, 4)} of the sensor's variance"
        )
    ]
    if wander is not None:
        stretch, noise = (with_unit(each, "m", units=units) for each in wander)
        lines.append(
            f"best gain without delay against {stretch} of stretch a cut and {noise} of noise: {number(best_gain(*wander), 4)}"
        )
    return lines


def _dead(dead: DeadTime | None, units: Units) -> list[str]:
    """Say what measured offsets tell of the sensor."""
    if dead is None:
        return []
    return [
        (
            f"dead time {number(dead.time * 1e3, 4)} ms (± {number(dead.time_error * 1e3, 2)}), offset at standstill "
            f"{with_unit(dead.constant, 'm', units=units)}, measurements within {with_unit(dead.residual, 'm', 3, units=units)} of the line"
        )
    ]


def _ends(found: MarkRange, units: Units) -> list[str]:
    """Write both ends of a range, rounded towards zero: what is told can be done."""
    factor = units.shown["m"].factor
    return [
        "no limit" if end is None else number(int(end * factor * 1e3) / 1e3, 7)
        for end in (found.earliest, found.latest)
    ]


def marks_answer(
    found: Marks, dead: DeadTime | None = None, wander: tuple[float, float] | None = None
) -> dict[str, Any]:
    """Answer of ``camwright marks``; null for an end of a range is no limit, for a method that it does not hold on this machine.

    Parameters
    ----------
    dead
        Dead time of the sensor, if offsets were given.
    wander
        Standard deviations of the material's stretch in a cut and of the sensor (m), if they were given.
    """
    here = found.here
    return {
        "job": found.job.name,
        "line_speed_m_per_s": here.line_speed,
        **range_answer(here.redesign),
        "proved": found.proved,
        "by_method": {
            "redesign": range_answer(here.redesign),
            "master_phase": _beside(here.master_phase, found.phase_alone),
            "slave_offset": here.slave_offset and _beside(here.slave_offset, found.offset_alone),
        },
        "by_speed": [
            {
                "line_speed_m_per_s": each.line_speed,
                **range_answer(each.redesign),
                "master_phase": range_answer(each.master_phase),
                "slave_offset": each.slave_offset and range_answer(each.slave_offset),
            }
            for each in found.by_speed
        ],
        "loop": {
            "delay_cuts": found.delay,
            "greatest_gain": found.greatest_gain,
            "gain_without_overshoot": found.gain,
            "noise_variance_share": found.noise,
            "best_gain": None if wander is None else best_gain(*wander),
        },
        "window_mm": range_answer(here.redesign),
        "dead_time": None
        if dead is None
        else {
            "time_ms": dead.time * 1e3,
            "time_error_ms": dead.time_error * 1e3,
            "constant_mm": dead.constant * 1e3,
            "greatest_residual_mm": dead.residual * 1e3,
            "measurements": dead.points,
        },
    }


def range_answer(found: MarkRange) -> dict[str, float | None]:
    """Answer of one range."""
    return {"earliest_mm": millimetres(found.earliest), "latest_mm": millimetres(found.latest)}


def _beside(found: MarkRange, alone: MarkRange | None) -> dict[str, Any]:
    return {**range_answer(found), "by_acceleration_alone": alone and range_answer(alone)}


def clamp_table(found: Marks) -> str:
    """Write the ranges over the line speed as CSV, mm: a cell that is empty has no limit, or the method does not hold."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    ends = [f"{method}_{end}_mm" for method in found.here.ranges for end in ("earliest", "latest")]
    rows.writerow(["line_speed_m_per_min", *ends])
    for each in found.by_speed:
        cells: list[str] = []
        for part in each.ranges.values():
            pair = (None, None) if part is None else (part.earliest, part.latest)
            # towards zero: what is written lies inside
            cells += ["" if end is None else f"{int(end * 1e6) / 1e3:.3f}" for end in pair]
        rows.writerow([f"{each.line_speed * 60:.6g}", *cells])
    return text.getvalue()
