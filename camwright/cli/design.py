"""The command ``camwright design``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import typer

from camwright.answers.axis import (
    axis_answer,
    lead_answer,
    robust_answer,
)
from camwright.answers.measures import (
    agreement_answer,
    band_answer,
    checks_answer,
    lengths_answer,
    objective_answer,
    objective_unit,
    profiles_answer,
)
from camwright.cli.destination import destination
from camwright.cli.options import JobOrPaper, Json, NoFigures, Out, Quiet
from camwright.cli.views.checks import checks_view
from camwright.cli.views.lead import lead_view
from camwright.cli.views.lengths import lengths_view
from camwright.cli.views.parts import View, files_view, new_text, stacked
from camwright.cli.views.profiles import profiles_view
from camwright.cli.views.speed_band import band_view
from camwright.figures.design import design_figures
from camwright.house.numbers import number, with_unit
from camwright.house.output import Voice, complain
from camwright.house.progress import Step
from camwright.jobs.job import load_job
from camwright.stored.profile_files import rows_note
from camwright.stored.save import design_files
from camwright.studies.axis_study import AxisStudy
from camwright.studies.design import STEPS, Design, optimise
from camwright.studies.remedies import Bands, Remedy, family_of, family_words, remedies

_BESIDE = 4
"""Steps of a design that is not brief: what it is compared with, files, ways out."""


def run(
    job: JobOrPaper = None,
    out: Out = None,
    as_json: Json = False,
    no_figures: NoFigures = False,
    brief: Annotated[
        bool, typer.Option("--brief", help="The cam, its bound, checks and line speeds alone; no figures.")
    ] = False,
    quiet: Quiet = False,
) -> int:
    """Design the optimal cam of a job; write the design, the cam table and the figures."""
    asked = load_job(job)
    voice = Voice(as_json, quiet)
    with voice.progress(STEPS + (1 if brief else _BESIDE)) as step:
        result = optimise(asked, step)
        if not brief:
            _compare(result, step)
        texts = design_files(result)
        step("writing files")
        pictures = {} if no_figures or brief else design_figures(result)
        files = destination("design", asked, job, out).write(texts, pictures)
        if note := rows_note(result.profile, result.job):
            complain(f"camwright: {note}")
        if not brief:
            step("looking for a way out")
            ways = remedies(asked, result.report, result.band)
            bands = None if result.passed else family_of(asked)
    if brief:
        voice.answer(lambda: brief_answer(result, files), lambda: _view(result, files))
    else:
        voice.answer(
            lambda: design_answer(result, ways, bands, files),
            lambda: _view(result, files, _ways(result, ways, bands)),
        )
    return 0 if result.passed else 1


def _compare(design: Design, step: Step) -> None:
    """Measure what a design is compared with: what cannot be measured is refused before a file is written."""
    step("measuring the baselines")
    _ = design.comparison
    step("finding minimum cut lengths")
    _ = design.lengths


def _view(design: Design, files: Sequence[Path], ways: Sequence[View] | None = None) -> View:
    """Show a design: objective, checks, files, line speeds; if it is not brief also comparison, minimum cut lengths and ways out."""
    compared: list[View] = []
    lengths: list[View] = []
    if ways is not None:
        compared.append(profiles_view(design.comparison))
        lengths.append(lead_view(design.job, design.report.length_errors))
        lengths += [] if design.lengths is None else [lengths_view(design.lengths, design.job.units)]
    return stacked(
        new_text("\n".join(_head(design))),
        *compared,
        checks_view(design.report.checks, design.job.units),
        *_axis(design),
        *lengths,
        files_view(files),
        band_view(design.band, design.job.units),
        *(ways or []),
        new_text(_verdict(design), "bold" if design.passed else "bold red"),
    )


def _ways(design: Design, ways: Sequence[Remedy], bands: Bands | None) -> list[View]:
    """Show the changes with which the job passed, where it did not as it is, and the family that covers its line speeds."""
    if design.passed:
        return []
    told = ["what makes it pass, each alone, designed and checked:", *(f"  {way.words}" for way in ways)]
    if not ways:
        told = ["no change that was tried makes it pass"]
    if bands is not None:
        told.append(family_words(bands, design.job.units))
    return [new_text("\n".join(told))]


def _verdict(design: Design) -> str:
    """Say in the last line whether the cam passed, or what failed."""
    if design.failed:
        return f"{design.job.name}: FAILED: {', '.join(design.failed)}"
    return f"{design.job.name}: passed every check at {with_unit(design.job.cut.line_speed, 'm/s', units=design.job.units)}"


def _head(design: Design) -> list[str]:
    """Say how the design ended: objective and bound, what was chosen, how well several starts agree."""
    solution, of = design.solution, objective_unit(design.job)
    measure = design.job.units.shown["m"] if of == "m" else design.job.units.measure(of)
    factor, unit = measure.factor, measure.printed
    bound = (
        "no lower bound is known"
        if design.gap is None
        else f"lower bound {number(design.bound.value * factor)} {unit} ({design.bound.method}), gap {design.gap:.1e}"
    )
    ending = (
        f"{design.job.name}: {solution.status.value}, {design.job.objective} {number(design.objective * factor)} {unit}"
    )
    lines = [f"{ending} in {design.profile.pieces} pieces; {bound}"]
    machine = solution.machine
    if machine.place_name:
        place = with_unit(machine.place, machine.slave_unit, units=design.job.units)
        lines.append(f"sync zone on the {machine.noun}: its middle at {place}")
    starts = solution.agreement
    if starts is not None:
        lines.append(
            f"{starts.agreeing} of {starts.converged} starts found this motion or one as good (objectives on their first meshes within "
            f"{starts.spread:.1e}); KKT residual {starts.residual:.1e}; local minima over the place of the sync zone: {starts.valleys}"
        )
    return [*lines, *machine.remarks(design.job.cut)]


def _axis(design: Design) -> list[View]:
    """Show what a servo-aware design promises of the axis, and the sync error over the servo's ranges."""
    lines = []
    axis, robust = design.axis, design.robust
    if axis is not None:
        held = (
            "holds the limits of speed and acceleration too"
            if axis.axis_limits
            else "does not hold all limits of the command"
        )
        lines.append(
            f"servo-aware, command {axis.mode}: sync error of the axis {_um(axis.designed_error)} µm designed, "
            f"{_um(axis.simulated_error)} µm simulated, over {axis.phases} sampling phases, {_line_speeds(axis)}; the axis {held}"
        )
    if robust is not None:
        designed = (
            ""
            if robust.designed_worst is None
            else f"{_um(robust.designed_worst)} µm at the {robust.vertices} corners as designed, "
        )
        lines.append(
            f"over the ranges of the servo: sync error at most {designed}{_um(robust.worst)} µm in {robust.draws} random servos"
        )
    return [new_text("\n".join(lines))] if lines else []


def _um(length: float) -> str:
    """Write a length in micrometres."""
    return number(length * 1e6, 4)


def _line_speeds(axis: AxisStudy) -> str:
    """Say for which line speeds a servo-aware design is made."""
    low, high = (number(speed * 60, 4) for speed in axis.line_speeds)
    if low == high:
        return f"at {high} m/min only"
    return f"at every line speed from {low} to {high} m/min ({len(axis.used)} of them carry it)"


def design_answer(design: Design, ways: Sequence[Remedy], bands: Bands | None, files: Sequence[Path]) -> dict[str, Any]:
    """Answer of ``camwright design``."""
    return brief_answer(design, files) | {
        "profiles": profiles_answer(design.comparison),
        "remedies": [asdict(way) for way in ways],
        "family_bands_m_per_s": None if bands is None else [list(band) for band in bands],
        "minimum_cut_length_mm": lengths_answer(design.lengths),
        **lead_answer(design.job, design.report.length_errors),
    }


def brief_answer(design: Design, files: Sequence[Path]) -> dict[str, Any]:
    """Answer of ``camwright design --brief``: the cam, what proves it, and the line speeds that it is released for."""
    return {
        "job": design.job.name,
        "status": design.solution.status.value,
        "objective": objective_answer(design),
        "lower_bound_method": design.bound.method,
        "starts": agreement_answer(design),
        "pieces": design.profile.pieces,
        "checks": checks_answer(design.report.checks),
        "passed": design.passed,
        **band_answer(design.band),
        "servo_aware": axis_answer(design.axis),
        "robust": robust_answer(design.robust),
        "tangential_mismatch": design.report.tangential_mismatch,
        "files": [str(file) for file in files],
    }
