"""The crank figure, after S3: crank to carriage, master to carriage, and the servo curve of the optimum and of the table."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from camwright.figures.panel import (
    LEFT,
    NOTHING,
    RIGHT,
    WIDTH,
    first_frame,
    head,
    page,
    stroked,
    wide_frame,
    zone_bands,
)
from camwright.figures.profile import curve
from camwright.figures.strokes import BLACK, LINES, Stroke
from camwright.figures.style import title
from camwright.house.numbers import converted, number, unit_shown
from camwright.house.pictures import Band, DrawnLine, DrawnMarks, Frame, Item, Picture, Tick
from camwright.jobs.job import Job
from camwright.jobs.machine_words import machine_words
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.studies.comparison import Comparison

TABULATED = "crank_tabulated"

STYLES: dict[str, Stroke] = {"optimised": LINES["optimised"], TABULATED: Stroke("#a0522d", 1.5, (4.5, 2.2))}
"""Strokes of the two profiles drawn."""

_ANGLES = 721
"""Points drawn of the crank's turn."""

_UPPER, _LOWER, _BETWEEN = 168.0, 132.0, 60.0
"""Heights of the upper two and the lower two panels, and room between the upper two (pt)."""

_ROOM = 0.05


def crank_figure(comparison: Comparison) -> Picture:
    """Draw the maps of a crank and the running curve of its servo.

    Parameters
    ----------
    comparison
        Profiles of a job whose machine is a crank with its sync zone placed; the optimised one and the tabulated one are drawn.

    Raises
    ------
    TypeError
        The machine's tool has no dead centres.
    """
    job = comparison.job
    machine = job.machine
    if machine.dead_centres is None:
        raise TypeError(f"the crank figure is about a tool that turns back, not a {machine.kind}")
    profiles = {row.name: row.profile for row in comparison.rows}
    shown = {name: profiles[name] for name in STYLES if name in profiles}
    heading = head(job.name, f"{machine_words(machine, digits=6)}, gear {machine.motor_ratio:g}")
    top = first_frame(heading) + 24.0
    width = 0.5 * (WIDTH - LEFT - RIGHT - _BETWEEN)
    below = top + _UPPER + 72.0
    frames = [
        _turn(job, machine.dead_centres, top, width),
        _travel(job, shown, machine.dead_centres[0], (LEFT + width + _BETWEEN, top, width)),
        *_motor(job, shown, below),
    ]
    legend: list[Item] = [stroked(STYLES[name], NOTHING, title(name)) for name in shown]
    return page(heading, frames, [*legend, *zone_bands(job.cut, job.units)])


def _turn(job: Job, dead_centres: tuple[float, float], top: float, width: float) -> Frame:
    """Draw the carriage over one turn of the crank from its back dead centre, with the zones on the crank and their ends."""
    task, cut, machine = job.task, job.cut, job.machine
    back, front = dead_centres
    factor, length = converted(1.0, "m", job.units), unit_shown("m", job.units)
    angle = np.linspace(back, back + 2 * np.pi, _ANGLES)
    lowest = float(machine.tool(back))
    way = np.stack([np.degrees(angle), (machine.tool(angle) - lowest) * factor], axis=1)
    shear = (cut.shear_zone_at, min(cut.shear_zone_at + cut.shear_zone, cut.sync_zone))
    ends = task.slave_at_sync_start + task.sync(np.array([0.0, cut.sync_zone, *shear]))
    first, last, cut_first, cut_last = np.degrees(ends).tolist()
    places = (machine.tool(ends[:2]) - lowest) * factor
    low, high = _span(way[:, 1])
    dead = float(np.degrees(front))
    items: list[Item] = [
        Band(first, last, "grey"),
        *([Band(cut_first, cut_last, "hatched")] if cut_last > cut_first else []),
        DrawnLine(np.array([[dead, low], [dead, high]]), "#8c8c8c", 1.0),
        DrawnLine(way, BLACK, 1.6),
        DrawnMarks(np.stack([[first, last], places], axis=1), BLACK, 6.0, "disc"),
    ]
    start = float(np.degrees(back))
    turned: FloatArray = np.arange(np.ceil(start / 60.0), np.floor(start / 60.0 + 6.0) + 1.0) * 60.0
    words = f"{first:.1f}° to {last:.1f}°, carriage {number(places[0], 4)} to {number(places[1], 4)} {length}"
    return Frame(
        LEFT, top, width, _UPPER, np.array([start, low]), np.array([start + 360.0, high]), items,
        f"crank angle (°)\nsync zone {words}", f"carriage position ({length})", "crank to carriage", grid=True, apart=24.0,
        xticks=[Tick(float(each), f"{each:g}") for each in turned + 0.0],
    )  # fmt: skip


def _travel(job: Job, shown: Mapping[str, CamProfile], back: float, place: tuple[float, float, float]) -> Frame:
    """Draw the carriage over the master; left, top and width of the panel (pt)."""
    machine, start = job.machine, job.task.slave_at_start
    factor, length = converted(1.0, "m", job.units), unit_shown("m", job.units)
    lines = []
    for name, profile in shown.items():
        x, y = curve(profile, 0)
        tool = machine.tool(start + y - float(profile(profile.start))) - float(machine.tool(back))
        lines.append(stroked(STYLES[name], np.stack([x, tool], axis=1) * factor))
    low, high = _span(np.concatenate([line.points[:, 1] for line in lines]))
    left, top, width = place
    return Frame(
        left, top, width, _UPPER, np.array([0.0, low]), np.array([job.cut.length * factor, high]),
        [*zone_bands(job.cut, job.units), *reversed(lines)], f"master position x ({length})", "", "master to carriage",
        grid=True, apart=24.0,
    )  # fmt: skip


def _motor(job: Job, shown: Mapping[str, CamProfile], top: float) -> list[Frame]:
    """Draw speed and acceleration of the servo over the master."""
    v, gear, factor = job.cut.line_speed, job.machine.motor_ratio, converted(1.0, "m", job.units)
    frames = []
    for order, scale, label in (
        (1, gear * v * 30 / np.pi, "servo speed (rpm)"),
        (2, gear * v**2, "servo acceleration (rad/s²)"),
    ):
        lines = [
            stroked(STYLES[name], np.stack(curve(profile, order), axis=1) * [factor, scale])
            for name, profile in shown.items()
        ]
        low, high = _span(np.concatenate([*(line.points[:, 1] for line in lines), [0.0]]))
        ends = np.array([0.0, low]), np.array([job.cut.length * factor, high])
        words = (
            ("", label, "servo curve") if order == 1 else (f"master position x ({unit_shown('m', job.units)})", label)
        )
        items: list[Item] = [*zone_bands(job.cut, job.units), *reversed(lines)]
        frames.append(wide_frame(top + (order - 1) * (_LOWER + 18.0), _LOWER, *ends, items, *words))
    return frames


def _span(values: FloatArray) -> tuple[float, float]:
    """Least and greatest of a panel, with room around."""
    low, high = float(values.min()), float(values.max())
    room = _ROOM * (high - low)
    return low - room, high + room
