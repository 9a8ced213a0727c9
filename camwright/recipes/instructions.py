"""What a fitter does: before enabling, when importing, and what is written down at the end."""

from __future__ import annotations

from camwright.house.numbers import (
    shown,
    unit_shown,
    with_unit,
)
from camwright.jobs.numbers import stored_machine
from camwright.recipes.blocks import Block, fixed_text, record_block, text_block
from camwright.recipes.catalogue import Catalogue
from camwright.recipes.model import AtSpeed, Recipe, RecipeTable
from camwright.recipes.release import marked, outside_note

_ROUNDING = 1e-12
"""Share of its travel that is none of the slave's."""

_FINEST = 0.001
"""What an error is at least said to be within: micrometres, and percent of the acceleration."""


def before(recipe: Recipe, words: Catalogue) -> list[Block]:
    """List what to see with one's own eyes before the drive is enabled."""
    machine, cut = stored_machine(recipe.job.si["machine"]), recipe.job.si["cut"]
    full = _at_full_speed(recipe)
    speed, unit = shown(cut["line_speed"], "m/s", units=words.units), recipe.slave_unit
    values = {
        "origin": words.named("word", cut["origin"]),
        "start": shown(recipe.slave_start, unit, units=words.units),
        "first": with_unit(_first(recipe), unit, units=words.units),
        "pitch": shown(recipe.pitch, unit, units=words.units),
        "line_speed": speed,
        "lead": shown(recipe.lead_time, "s", 4, words.units),
        "speed": shown(full.motor_speed, "rad/s", 4, words.units),
        "error": fixed_text(full.following_error, words),
    }
    if machine.slave_turn is not None:
        values["turn"] = shown(machine.slave_turn, unit, units=words.units)
    if machine.guide is not None:
        values["home"], values["end"] = (shown(end, unit, units=words.units) for end in machine.guide)
    keys = (
        "guards",
        "master",
        f"direction.{machine.kind}",
        f"scale.{machine.kind}",
        f"zero.{machine.kind}",
        "motor",
        "following",
        "lead",
        "readback",
        "run",
    )
    items = [words(f"before.{key}", **values) for key in keys]
    if recipe.released and outside_note((row.line_speed for row in recipe.speeds), recipe, words):
        items.append(words("before.outside"))
    return [{"kind": "checklist", "items": items}]


def _first(recipe: Recipe) -> float:
    """Take where the table has the slave at master zero; nothing for what rounding leaves of it."""
    rows = recipe.profile.coefficients
    return rows[0][0] if abs(rows[0][0]) > _ROUNDING * max(abs(row[0]) for row in rows) else 0.0


def _at_full_speed(recipe: Recipe) -> AtSpeed:
    return max(recipe.speeds, key=lambda row: row.share)


def imports(recipe: Recipe, words: Catalogue) -> list[Block]:
    """List the import steps of every target, and what its controller makes of the cam."""
    blocks: list[Block] = []
    for table in recipe.tables:
        about: list[Block] = [{"kind": "heading", "text": words.phrase(table.title)}]
        about += [{"kind": "files", "paths": [file.path for file in table.files]}] if table.files else []
        about.append(text_block(_table_words(table, words)))
        if not table.released:
            about.append(text_block(words("import.not_released"), strong=True))
        else:
            about.append({"kind": "checklist", "items": [words.phrase(step) for step in table.steps]})
        blocks.append({"kind": "together", "blocks": about})
    if recipe.refused:
        blocks.append(text_block(words("import.refused", targets=", ".join(each.target for each in recipe.refused))))
    return [*blocks, text_block(words("import.safety"), strong=True)]


def _table_words(table: RecipeTable, words: Catalogue) -> str:
    # the CSV table is in millimetres, which its reader turns into metres
    master, slave = (
        "mm" if table.target == "csv" and unit.symbol == "m" else unit.symbol
        for unit in (table.master_unit, table.slave_unit)
    )
    values = {
        "points": str(len(table.points.master)),
        "master": master,
        "slave": slave,
        "position": words.number(max(table.position_error * 1e6, _FINEST), 2),
    }
    if table.acceleration_error is None:
        text = words("import.facts_unbounded", **values)
    else:
        text = words(
            "import.facts", **values, acceleration=words.number(max(100.0 * table.acceleration_error, _FINEST), 2)
        )
    gap = "" if words.language == "zh" else " "
    if not table.within_asked_error:
        text += gap + words("import.inaccurate")
    if not table.tested_on_controller:
        text += gap + words("import.untested")
    return text


def _record_name(key: str, recipe: Recipe, words: Catalogue) -> str:
    """Name a row of the record; one of a line speed outside the release is marked."""
    name, share = words(f"record.{key}"), key.removeprefix("length_")
    full = recipe.job.si["cut"]["line_speed"]
    return marked(name, recipe, 0.01 * int(share) * full) if share.isdigit() else name


def record(recipe: Recipe, words: Catalogue) -> list[Block]:
    """Make the form for what was found and what was left."""
    servo = recipe.job.si["servo"]
    unit = recipe.slave_unit
    designed = {
        "position_gain": words.number(servo["position_gain"]),
        "velocity_feedforward": words.number(servo["velocity_feedforward"]),
        **{
            f"{kind}_feedforward": f"{shown(servo[f'{kind}_feedforward'], power, 4, words.units)} {unit_shown(power, words.units)}"
            for kind, power in (("acceleration", "s^2"), ("jerk", "s^3"))
            if f"{kind}_feedforward" in servo
        },
        "lead_time": shown(recipe.lead_time, "s", 4, words.units),
        "slave_zero": f"{shown(recipe.slave_start, unit, units=words.units)} {unit_shown(unit, words.units)}",
        "following_error": fixed_text(_at_full_speed(recipe).following_error, words),
    }
    length = shown(recipe.job.si["cut"]["length"], "m", units=words.units)
    designed |= {f"length_{share}": length for share in (25, 50, 100)}
    return [record_block([[_record_name(key, recipe, words), value] for key, value in designed.items()], words)]
