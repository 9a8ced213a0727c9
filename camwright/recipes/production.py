"""What a recipe says of starting, stopping and print marks."""

from __future__ import annotations

from dataclasses import astuple

from camwright.house.numbers import in_print, shown, unit_shown, with_unit
from camwright.production.marks import marks_at_speeds
from camwright.production.ramps import Ramps, fastest_standing, ramps
from camwright.profiles.errors import InfeasibleError
from camwright.profiles.mark_range import MarkRange
from camwright.profiles.ramp import Ramp
from camwright.recipes.blocks import Block, table_block, text_block
from camwright.recipes.catalogue import Catalogue
from camwright.recipes.model import MarkEnds, MarksAt, RampRecord, Recipe, StartStop
from camwright.recipes.release import marked, outside_note
from camwright.stored.design_file import StoredDesign


def found_ramps(design: StoredDesign) -> Ramps | None:
    """Design start and stop of a cam's machine; ``None`` where there are none at its line speed."""
    try:
        return ramps(design.job, cam=design.profile)
    except InfeasibleError:
        return None


def start_stop(design: StoredDesign, found: Ramps | None) -> StartStop:
    """Write start and stop of a cam's machine as a recipe holds them; where there are none, up to which line speed there are."""
    if found is None:
        return StartStop(fastest_standing(design.job))
    return StartStop(
        standing_up_to=found.fastest,
        park=float(found.stand.park),
        ramp_in=_record(found.ramp_in),
        ramp_out=_record(found.ramp_out),
        one_shot_master=found.one_shot.length,
        least_arc=None if found.arcs.run_up is None else found.arcs.run_up.arc,
        latency=found.latency,
        sensor_ahead=found.sensor,
        passed=found.passed,
    )


def _record(ramp: Ramp) -> RampRecord:
    return RampRecord(ramp.arc, ramp.master, ramp.time, float(ramp.peak_acceleration))


def marks_of(design: StoredDesign) -> tuple[MarksAt, ...]:
    """Find what print marks may ask of a cam, over the line speed."""
    return tuple(
        MarksAt(
            float(each.line_speed),
            _ends(each.redesign),
            _ends(each.master_phase),
            None if each.slave_offset is None else _ends(each.slave_offset),
        )
        for each in marks_at_speeds(design.profile, design.job)
    )


def _ends(found: MarkRange) -> MarkEnds:
    return MarkEnds(*(None if end is None else float(end) for end in (found.earliest, found.latest)))


_MOTIONS = {"ramp_in": "start.in", "ramp_out": "start.out", "one_shot": "start.one"}
"""Names of motions, by keys of the catalogue."""


def start_blocks(recipe: Recipe, words: Catalogue) -> list[Block]:
    """Set start and stop: a table of both, and what they ask of park, sensor and line speed."""
    found, units = recipe.start_stop, words.units
    if found is None:
        return []
    standing = shown(found.standing_up_to, "m/s", 5, units)
    if found.ramp_in is None or found.ramp_out is None:
        return [text_block(words("start.none", speed=standing))]
    slave = recipe.slave_unit
    units_of = (slave, "m", "s", f"{slave}/s^2")
    names = ("start.arc", "start.master", "start.time", "start.peak")
    rows = [
        [words(key), *(shown(value, unit, 5, units) for value, unit in zip(astuple(ramp), units_of, strict=True))]
        for key, ramp in (("start.in", found.ramp_in), ("start.out", found.ramp_out))
    ]
    head = ["", *(words(name, unit=unit_shown(unit, units)) for name, unit in zip(names, units_of, strict=True))]
    facts = words(
        "start.facts",
        park=_told(found.park, slave, words),
        piece=_told(found.one_shot_master, "m", words),
        least=_told(found.least_arc, slave, words),
        speed=standing,
        sensor=_told(found.sensor_ahead, "m", words),
        latency=_told(found.latency, "s", words),
    )
    verdict = [] if found.passed else [text_block(words("start.failed"), strong=True)]
    return [table_block(head, rows), *verdict, text_block(facts), *_table_blocks(recipe, words)]


def _table_blocks(recipe: Recipe, words: Catalogue) -> list[Block]:
    """Set a row for each target: the points of its tables of start, stop and one piece, or that there is none, and why."""
    motions = recipe.start_tables
    if not motions:
        return []
    written = any(table.files for record in motions for table in record.tables)
    cells: dict[str, list[str]] = {}
    reasons: dict[str, str] = {}
    withheld: dict[str, None] = {}
    for number, record in enumerate(motions):
        for table in record.tables:
            failed = [words.named("check", check.name) for check in table.checks if not check.passed]
            why = ", ".join(failed) or words("start.no_cam")
            cell = str(len(table.points.master)) if table.files else "✗"
            cells.setdefault(table.target, [words("nothing")] * len(motions))[number] = cell
            if not table.files:  # told below: cells of numbers are not broken, and a narrow screen has no room for it
                withheld[f"{table.target} ✗ {why}"] = None
        for refusal in record.refused:
            cells.setdefault(refusal.target, [words("nothing")] * len(motions))
            reasons.setdefault(refusal.target, "; ".join(refusal.reasons))
    head = [words("start.target"), *(words(_MOTIONS[record.motion]) for record in motions)]
    not_taken = [text_block(each) for each in withheld]
    not_taken += [
        text_block(words("start.refused", target=target, reasons=reason)) for target, reason in reasons.items()
    ]
    return [
        table_block(head, [[target, *row] for target, row in cells.items()], widths=[0.8, *(1.0,) * len(motions)]),
        text_block(words("start.tables")),
        *([text_block(words("start.files"))] if written else []),
        *not_taken,
    ]


def _told(value: float | None, unit: str, words: Catalogue) -> str:
    return words("nothing") if value is None else with_unit(value, unit, 5, words.units)


def mark_head(words: Catalogue) -> list[str]:
    """List the headings of the table of print marks."""
    speed, length = unit_shown("m/s", words.units), unit_shown("m", words.units)
    methods = [words(key) for key in ("marks.redesign", "marks.phase", "marks.offset")]
    return [
        words("marks.line", unit=speed),
        *(words(end, method=method, unit=length) for method in methods for end in ("marks.earliest", "marks.latest")),
    ]


def mark_cells(row: MarksAt) -> list[float | str | None]:
    """List the ends of a row (m): nothing for no limit, the word for a method that is not in sync."""
    cells: list[float | str | None] = []
    for part in (row.redesign, row.master_phase, row.slave_offset):
        cells += ["nothing"] * 2 if part is None else [part.earliest, part.latest]
    return cells


def mark_blocks(recipe: Recipe, words: Catalogue) -> list[Block]:
    """Set how far a print mark may be off, one row a line speed."""
    if not recipe.marks:
        return []
    rows = [
        [
            marked(shown(row.line_speed, "m/s", 4, words.units), recipe, row.line_speed),
            *(_mark_text(cell, words) for cell in mark_cells(row)),
        ]
        for row in recipe.marks
    ]
    return [
        table_block(mark_head(words), rows, widths=[0.9, *(1.0,) * 6]),
        *outside_note((row.line_speed for row in recipe.marks), recipe, words),
        text_block(words("marks.note")),
    ]


def _mark_text(cell: float | str | None, words: Catalogue) -> str:
    """Write one end, rounded towards zero: what is told can be done."""
    if isinstance(cell, str):
        return words(cell)
    if cell is None:
        return words("marks.no_limit")
    factor = words.units.shown["m"].factor
    tenths = 10.0 ** (1 if words.units.name == "metric" else 3)
    return in_print(f"{int(cell * factor * tenths) / tenths:.{1 if tenths == 10.0 else 3}f}", words.units).replace(
        "-", "−"
    )
