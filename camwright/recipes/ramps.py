"""How hard the line may ramp, as a recipe holds and a sheet tells it."""

from __future__ import annotations

import math

from camwright.house.numbers import converted, inside, shown, unit_shown
from camwright.recipes.blocks import Block, table_block, text_block
from camwright.recipes.catalogue import Catalogue
from camwright.recipes.model import LineRampRecord, RampAt, Recipe
from camwright.recipes.release import marked, outside_note
from camwright.studies.line_ramps import LEAST_RAMP, LineRamps
from camwright.validation.production.line_ramp import Allowed

_SHOWN = 5
"""Of the line speeds each of this number is on the sheet."""


def ramp_record(found: LineRamps) -> LineRampRecord:
    """Write how hard the line may ramp as a recipe holds it."""
    worst = None if found.sync is None else found.sync.worst
    return LineRampRecord(
        acceleration=_number(found.up_to.ramp),
        stop=_number(found.up_to.braking),
        binding=found.up_to.ramp.binds,
        stop_length=found.stop_length,
        by_acceleration_alone=_number(found.alone),
        by_speed=tuple(
            RampAt(each.line_speed, _number(each.speeding), _number(each.braking), each.ramp.binds)
            for each in found.curve
        ),
        sync_error=None if worst is None else worst[0],
    )


def _number(allowed: Allowed) -> float | None:
    return float(allowed.value) if math.isfinite(allowed.value) else None


def ramp_blocks(recipe: Recipe, words: Catalogue) -> list[Block]:
    """Set what the line may do at some speeds, the two numbers for the PLC, and what the axis makes of the job's ramps."""
    found = recipe.line_ramp
    if found is None:
        return [text_block(words("nothing"))]
    head = [
        words("column.line_speed"),
        *(words(key, unit=unit_shown("m/s^2", words.units)) for key in ("column.ramp_up", "column.ramp_down")),
        words("column.binding"),
    ]
    told = found.by_speed[_SHOWN - 1 :: _SHOWN]
    rows = [
        [
            marked(shown(each.line_speed, "m/s", 4, words.units), recipe, each.line_speed),
            ramp_text(each.acceleration, words),
            ramp_text(each.stop, words),
            words.named("binding", each.binding),
        ]
        for each in told
    ]
    unit = unit_shown("m/s^2", words.units)
    speed = shown(recipe.job.si["cut"]["line_speed"], "m/s", units=words.units)
    plc = words(
        "ramp.plc", speed=speed, ramp=ramp_text(found.acceleration, words), stop=ramp_text(found.stop, words), unit=unit,
        binding=words.named("binding", found.binding),
    )  # fmt: skip
    outside = outside_note((each.line_speed for each in told), recipe, words)
    blocks = [table_block(head, rows, widths=[1.0] * 4), *outside, text_block(plc, strong=True)]
    if found.stop_length is not None:
        blocks.append(text_block(words("ramp.stop_length", length=shown(found.stop_length, "m", 4, words.units))))
    alone = ramp_text(found.by_acceleration_alone, words)
    blocks.append(text_block(words("ramp.alone", ramp=alone, unit=unit)))
    if found.sync_error is not None:
        blocks.append(text_block(words("ramp.sync", error=shown(found.sync_error, "m", 3, words.units))))
    return blocks


def ramp_text(value: float | None, words: Catalogue) -> str:
    """Write a ramp that is allowed, rounded to the safe side, none below `LEAST_RAMP`; nothing binds where there is none."""
    if value is None:
        return words("ramp.any")
    return words.number(inside(converted(value, "m/s^2", words.units), 4, up=False), 4) if value >= LEAST_RAMP else "0"
