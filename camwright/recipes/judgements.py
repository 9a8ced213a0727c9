"""What was judged: limits and what is reached, the checks of cam and tables, the checksums."""

from __future__ import annotations

from camwright.house.numbers import (
    Units,
    fine_length,
    in_print,
    number,
    shown,
    si_unit,
    unit_shown,
)
from camwright.recipes.blocks import Block, table_block, text_block
from camwright.recipes.catalogue import Catalogue
from camwright.recipes.model import Recipe, RecipeCheck, RecipeTable

REACHED = (
    "speed",
    "acceleration",
    "jerk",
    "reversal",
    "stroke",
    "motor_speed",
    "motor_torque",
    "line_ramp",
    "shear_zone_error",
)
"""Checks that compare a quantity of the machine with its limit."""

SHORT = 16
"""Digits of a checksum in print."""

_BESIDE = 4
"""Tables whose checks stand side by side on a page."""


def reached(recipe: Recipe, words: Catalogue) -> list[Block]:
    """Set the limits of the machine beside what the cam reaches."""
    checks = [check for name in REACHED for check in recipe.checks if check.name == name]
    head = [words(f"column.{key}") for key in ("quantity", "unit", "reached", "limit", "share", "at")]
    rows = []
    for check in checks:
        share = check.value / check.limit if check.value is not None and check.limit else None
        rows.append(
            [
                words.named("check", check.name),
                unit_shown(check.unit, words.units),
                _marked(
                    words("unbounded") if check.value is None else _rounded(check.value, check.unit, words.units), check
                ),
                words("nothing") if check.limit is None else shown(check.limit, check.unit, units=words.units),
                words.number(None if share is None else round(100.0 * share, 2)),
                words("nothing") if check.at is None else shown(check.at, "m", units=words.units),
            ]
        )
    return [table_block(head, rows, left=2)]


def _rounded(value: float, unit: str, units: Units) -> str:
    """Write a value; a length to a tenth of a micrometre."""
    return in_print(number(fine_length(value, units)), units) if unit == "m" else shown(value, unit, units=units)


def checks(recipe: Recipe, words: Catalogue) -> list[Block]:
    """Set the checks on the cam."""
    head = [words(f"column.{key}") for key in ("check", "value", "limit", "unit", "passed")]
    rows = [
        [
            words.named("check", check.name),
            words.number(check.value, 4),
            words.number(check.limit, 4),
            si_unit(check.unit),
            _marked(words("yes" if check.passed else "no"), check),
        ]
        for check in recipe.checks
    ]
    return [table_block(head, rows), text_block(words("checks.note"))]


def table_checks(recipe: Recipe, words: Catalogue) -> list[Block]:
    """Set the checks of the tables side by side, as many as fit; what failed is marked."""
    return [
        _checks_beside(recipe.tables[first : first + _BESIDE], words) for first in range(0, len(recipe.tables), _BESIDE)
    ]


def _checks_beside(tables: tuple[RecipeTable, ...], words: Catalogue) -> Block:
    names = list(dict.fromkeys(check.name for table in tables for check in table.checks))
    found = [{check.name: check for check in table.checks} for table in tables]
    rows = []
    for name in names:
        checks = [each.get(name) for each in found]
        first = next(check for check in checks if check is not None)
        named = words.messages.get(f"table_check.{name}", words.named("check", name))
        label = named + ("" if first.unit == "1" else f" ({si_unit(first.unit)})")
        limit = next((check.limit for check in checks if check is not None and check.limit is not None), None)
        rows.append([label, words.number(limit, 4), *(_judged(check, words) for check in checks)])
    head = [words("column.check"), words("column.limit"), *(table.target for table in tables)]
    return table_block(head, rows)


def _judged(check: RecipeCheck | None, words: Catalogue) -> str:
    if check is None:
        return words("nothing")
    return _marked(words("unbounded") if check.value is None else words.number(check.value, 4), check)


def _marked(text: str, check: RecipeCheck) -> str:
    """Mark what failed."""
    return text if check.passed else f"✗ {text}"


def files(recipe: Recipe, words: Catalogue) -> list[Block]:
    """List the tables with the first digits of their checksums."""
    tables = [*recipe.tables, *(table for motion in recipe.start_tables for table in motion.tables)]
    rows = [[file.path, file.sha256[:SHORT]] for table in tables for file in table.files]
    head = [words("column.file"), words("column.sha256")]
    return [*([table_block(head, rows, left=2)] if rows else []), text_block(words("files.note"))]
