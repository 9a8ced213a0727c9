"""The command ``camwright ramps``."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, cast, get_args

import typer

from camwright.answers.measures import checks_answer, millimetres
from camwright.cli.destination import Destination, destination
from camwright.cli.options import GivenJob, Json, NoFigures, Quiet, To, option_quantity, out_folder
from camwright.cli.views.checks import checks_view
from camwright.cli.views.parts import View, files_view, new_table, new_text, stacked
from camwright.drives.export import export_answer
from camwright.drives.options import chosen_targets, parse_targets
from camwright.drives.withheld import setting_aside
from camwright.figures.ramps import AIMS, ramps_figure
from camwright.house.json_text import to_json
from camwright.house.numbers import number, with_unit
from camwright.house.output import Voice, complain
from camwright.jobs.job import Job, load_job
from camwright.jobs.table_units import slave_length
from camwright.jobs.wording import in_job_words
from camwright.production.ramp_tables import KINDS, AllRampTables, tables_answer, write_ramps
from camwright.production.ramps import LATENCY, STEPS, Ramps, ramps
from camwright.profiles.errors import InputError
from camwright.profiles.ramp import Aim, Ramp


def run(
    job: GivenJob,
    park: Annotated[
        str,
        typer.Option(
            "--park",
            metavar="POSITION",
            help="Where the slave stands, as its coordinate (-200 mm, 180 deg); auto: opposite the sync zone, a carriage at home.",
        ),
    ] = "auto",
    minimise: Annotated[
        str, typer.Option("--minimise", metavar="WHAT", help=f"What is made least: {', '.join(get_args(Aim))}.")
    ] = "peak_acceleration",
    latency: Annotated[
        str, typer.Option("--latency", metavar="TIME", help="Time from the sensor to the start.")
    ] = f"{LATENCY * 1e3:g} ms",
    to: To = None,
    out: Annotated[Path | None, out_folder("-ramps")] = None,
    as_json: Json = False,
    no_figures: NoFigures = False,
    quiet: Quiet = False,
) -> int:
    """Design how the machine starts into the running line, stops out of it, and makes one piece on demand."""
    aim, delay = _aim(minimise), option_quantity("--latency", latency, "time", zero=True, example="10 ms")
    if to is not None:
        parse_targets(to)  # a wrong name is told before anything is designed
    asked = load_job(job)
    place, names = _park(park, asked), chosen_targets(to, asked)
    voice = Voice(as_json, quiet)
    with voice.progress(STEPS + len(KINDS) + 2) as step:
        with in_job_words(asked.units):
            found = ramps(asked, place, aim, delay, step)
        step("checking")
        found.report  # noqa: B018 - simulated here, so that the progress says so
        tables = write_ramps(found, names, required=to != "all", step=step)
        step("writing files")
        files = _write(found, tables, destination("ramps", asked, job, out, "-ramps"), figures=not no_figures)
    voice.answer(lambda: ramps_answer(found, tables), lambda: _view(found, tables, files))
    return 0 if found.passed and tables.passed else 1


def _aim(text: str) -> Aim:
    """Read what is to be made least."""
    if text not in get_args(Aim):
        raise InputError(f"--minimise takes one of {', '.join(get_args(Aim))}; got {text[:40]!r}")
    return cast("Aim", text)


def _park(text: str, job: Job) -> float | None:
    """Read where the slave stands; None where that is camwright's to choose."""
    if text.strip() == "auto":
        return None
    try:
        return slave_length(text, job.machine)
    except InputError as error:
        raise InputError(*(f"--park: {fault}; or write auto" for fault in error.faults)) from error


def _write(found: Ramps, tables: AllRampTables, place: Destination, *, figures: bool) -> list[Path]:
    """Write tables, their report, the answer and the figure, all or none; older tables of what is withheld are set aside."""
    older = tables.older(found, place.directory)
    texts = {
        **tables.files,
        "ramps.json": to_json({**ramps_answer(found, tables), "profiles": _profiles(found)}),
        "report.json": to_json({**tables_answer(tables, found), "set_aside": older}),
    }
    with setting_aside(place.directory, place.work, older, complain) as aside:
        return place.fill(aside, texts, {"ramps": ramps_figure(found)} if figures else {})


def _profiles(found: Ramps) -> dict[str, object]:
    """Give the three motions as pieces of polynomials, master and slave in SI units from zero."""
    return {
        "ramp_in": found.start_table.to_dict(),
        "ramp_out": found.stop_table.to_dict(),
        "one_shot": found.one_shot.to_dict(),
    }


def _view(found: Ramps, tables: AllRampTables, files: Sequence[Path]) -> View:
    """Show start and stop, what they ask of the line, checks and tables."""
    job, units = found.job, found.job.units
    slave = job.machine.slave_unit
    rows = new_table(
        f"Start and stop at {with_unit(job.cut.line_speed, 'm/s', units=units)}, minimised: {AIMS[found.aim]}",
        ("", "slave travels", "material", "time", "peak acceleration", "lower bound"),
        left=("",),
    )
    for name, ramp, bound in zip(("start", "stop"), (found.ramp_in, found.ramp_out), found.bounds, strict=True):
        unit = objective_of(found, ramp)[1]
        told = "none is known" if bound is None else with_unit(bound, unit, units=units)
        rows.add_row(
            name,
            with_unit(ramp.arc, slave, units=units),
            with_unit(ramp.master, "m", units=units),
            with_unit(ramp.time, "s", units=units),
            with_unit(ramp.peak_acceleration, f"{slave}/s^2", units=units),
            told,
        )
    rows.add_row(
        "one piece",
        "",
        with_unit(found.one_shot.length, "m", units=units),
        "",
        with_unit(found.peak_acceleration, f"{slave}/s^2", units=units),
        "",
    )
    return stacked(
        rows,
        new_text("\n".join(_facts(found))),
        checks_view(found.checks, units),
        _tables_view(tables),
        *(
            new_text(f"{target} cannot take the {kind}: {'; '.join(why)}")
            for kind, group in tables.refused.items()
            for target, why in group.items()
        ),
        files_view(files),
        new_text(*_verdict(found, tables)),
    )


def _facts(found: Ramps) -> list[str]:
    """Say where the slave stands, what a start needs at least, and where a sensor belongs."""
    job, units = found.job, found.job.units
    slave, noun = job.machine.slave_unit, job.machine.noun
    lines = [f"the {noun} stands at {with_unit(found.stand.park, slave, units=units)}"]
    if found.arcs.run_up is not None:
        lines.append(
            f"a start needs {with_unit(found.arcs.run_up.arc, slave, units=units)} at least "
            f"({with_unit(found.arcs.run_up.time, 's', units=units)}, {with_unit(found.arcs.run_up.master, 'm', units=units)} of material)"
        )
    if found.fastest is not None:
        lines.append(f"it can stand between two cuts up to {with_unit(found.fastest, 'm/s', units=units)}")
    if found.least_sensor is not None:
        ahead, fastest = (with_unit(way, "m", units=units) for way in (found.sensor, found.least_sensor))
        lines.append(
            f"first cut: the sensor must stand {ahead} ahead of the cut at mid sync zone for this start, {fastest} for the "
            f"fastest, with {with_unit(found.latency, 's', units=units)} of latency"
        )
    return lines


def _tables_view(tables: AllRampTables) -> View:
    """Show each table as its drive runs it."""
    heads = ("motion", "target", "points", "position\num", "judgement", "files")
    table = new_table("Tables as the drives run them", heads, left=("motion", "target", "judgement", "files"))
    for kind, results in tables.results.items():
        for result in results:
            failed = [check.name for check in result.judgement.checks if not check.passed]
            table.add_row(
                kind,
                result.target.name,
                str(result.table.points),
                number(result.position_error * 1e6, 3),
                "failed: " + ", ".join(failed) if failed else "passed",
                "\n".join(result.files) or "not released",
            )
    return table


def _verdict(found: Ramps, tables: AllRampTables) -> tuple[str, str]:
    """Say in the last line whether start and stop passed, or what failed."""
    failed = [check.name for check in found.checks if not check.passed]
    if failed:
        return f"{found.job.name}: FAILED: {', '.join(failed)}", "bold red"
    if not tables.passed:
        return (
            f"{found.job.name}: start and stop passed every check; not every drive can run them (see the tables)",
            "bold red",
        )
    return (
        f"{found.job.name}: start and stop passed every check at {with_unit(found.job.cut.line_speed, 'm/s', units=found.job.units)}",
        "bold",
    )


def ramps_answer(found: Ramps, tables: AllRampTables | None = None) -> dict[str, Any]:
    """Answer of ``camwright ramps``: lengths in mm, times in ms; the measures in m are null for a slave that is counted in rad."""
    start, stop = found.bounds
    metres = found.job.machine.slave_unit == "m"
    least = None if found.arcs.run_up is None else found.arcs.run_up.arc
    return {
        "job": found.job.name,
        "minimised": found.aim,
        "line_speed_m_per_s": found.job.cut.line_speed,
        "park": {"mm": found.stand.park * 1e3} if metres else {"deg": math.degrees(found.stand.park)},
        "ramp_in": ramp_answer(found, found.ramp_in, start),
        "ramp_out": ramp_answer(found, found.ramp_out, stop),
        "one_shot": {"master_mm": found.one_shot.length * 1e3, **_peak(found, found.peak_acceleration)},
        "least_arc_mm": millimetres(least) if metres else None,
        **({} if metres else {"least_arc_rad": least}),
        "standstill_up_to_m_per_s": found.fastest,
        "first_cut": {
            "latency_ms": found.latency * 1e3,
            "sensor_ahead_mm": millimetres(found.least_sensor),
            "sensor_ahead_of_this_ramp_mm": found.sensor * 1e3,
        },
        "checks": checks_answer(found.checks),
        "passed": found.passed and (tables is None or tables.passed),
        "tables": {} if tables is None else {kind: export_answer(tables.results[kind])["targets"] for kind in KINDS},
        "refused": {} if tables is None else {kind: tables.refused[kind] for kind in KINDS if tables.refused[kind]},
    }


def ramp_answer(found: Ramps, ramp: Ramp, bound: float | None) -> dict[str, Any]:
    """Answer of one ramp; the bound is of what was made least."""
    metres = found.job.machine.slave_unit == "m"
    value, unit = objective_of(found, ramp)
    peak_bound = bound if found.aim == "peak_acceleration" else None
    return {
        "arc_mm": ramp.arc * 1e3 if metres else None,
        "master_mm": ramp.master * 1e3,
        "time_ms": ramp.time * 1e3,
        **_peak(found, ramp.peak_acceleration),
        "lower_bound_m_per_s2": peak_bound if metres else None,
        **({} if metres else {"arc_rad": ramp.arc, "lower_bound_rad_per_s2": peak_bound}),
        "rms_acceleration" + ("_m_per_s2" if metres else "_rad_per_s2"): ramp.rms_acceleration,
        "objective": {"value": value, "unit": unit, "lower_bound": bound},
    }


def objective_of(found: Ramps, ramp: Ramp) -> tuple[float, str]:
    """Value of what was made least of a ramp, and its SI unit."""
    slave = found.job.machine.slave_unit
    if found.aim == "rms_acceleration":
        return ramp.heat, f"{slave}^2/s^3"
    if found.aim == "shortest":
        return ramp.master, "m"
    return ramp.peak_acceleration, f"{slave}/s^2"


def _peak(found: Ramps, value: float) -> dict[str, float | None]:
    if found.job.machine.slave_unit == "m":
        return {"peak_acceleration_m_per_s2": value}
    return {"peak_acceleration_m_per_s2": None, "peak_acceleration_rad_per_s2": value}
