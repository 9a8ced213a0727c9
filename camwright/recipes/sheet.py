"""The recipe as a document: sections of blocks in the reader's language, which PDF and HTML set alike."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict
from typing import Any

from camwright.house.numbers import (
    shown,
    unit_shown,
    with_unit,
)
from camwright.recipes.blocks import (
    Block,
    length_text,
    shortened,
    table_block,
    text_block,
    visible,
)
from camwright.recipes.catalogue import Catalogue
from camwright.recipes.facts import AT_SPEED, GROUPS, POWERS, fact_text
from camwright.recipes.instructions import before, imports, record
from camwright.recipes.judgements import (
    checks,
    files,
    reached,
    table_checks,
)
from camwright.recipes.model import Edge, Recipe
from camwright.recipes.production import mark_blocks, start_blocks
from camwright.recipes.ramps import ramp_blocks
from camwright.recipes.release import boxed, marked, outside_note, released_speeds, status_text, warnings
from camwright.recipes.working_range import LONGEST, NOT_FOUND


def sheet(recipe: Recipe, words: Catalogue) -> dict[str, Any]:
    """Set a recipe in a language.

    Returns
    -------
    dict
        ``kind``, ``title``, ``short`` (the title on one line), ``language``, ``released``, ``status``, ``boxed`` (whether the status
        wants a thick frame), ``warnings`` (beside it), ``head`` (rows of two), ``groups`` (parameters in two columns), ``page`` and
        ``sections``: each a ``key``, a ``heading`` and ``blocks``, every one of a ``kind``. All values are plain text.
    """
    makers: tuple[tuple[str, Callable[[Recipe, Catalogue], list[Block]]], ...] = (
        ("section.cam", _cam),
        ("section.reached", reached),
        ("section.speeds", _speeds),
        ("section.line_ramp", ramp_blocks),
        ("section.range", _range),
        ("section.start_stop", start_blocks),
        ("section.marks", mark_blocks),
        ("section.before", before),
        ("section.import", imports),
        ("section.checks", checks),
        ("section.table_checks", table_checks),
        ("section.files", files),
        ("section.record", record),
    )
    note = [[words("note"), visible(recipe.note)]] if recipe.note else []
    name = visible(recipe.name)
    return {
        "title": name,
        "short": shortened(name),
        "kind": words("recipe"),
        "language": recipe.language,
        "released": recipe.released,
        "status": status_text(recipe, words),
        "boxed": boxed(recipe),
        "warnings": warnings(recipe, words),
        "head": [
            *note,
            *particular_rows(recipe, words),
            [words("head.objective"), objective_text(recipe, words)],
            [words("head.camwright"), f"camwright {recipe.provenance.camwright}"],
            [words("head.job_sha256"), recipe.provenance.job_sha256],
        ],
        "groups": [[_group(recipe, heading, words) for heading in column] for column in _COLUMNS],
        "page": words("page"),
        "sections": [
            {"key": key, "heading": words(key), "blocks": blocks}
            for key, make in makers
            if (blocks := make(recipe, words)) or key not in _MAY_LACK
        ],
    }


_MAY_LACK = ("section.start_stop", "section.marks")
"""Sections that recipes of earlier versions have nothing for."""

_PARTICULARS = {
    "revision": "head.revision",
    "customer": "head.customer",
    "author": "head.author",
    "date": "head.date",
}
"""Names of what the user gives, by keys of the catalogue."""


def particular_rows(recipe: Recipe, words: Catalogue) -> list[list[str]]:
    """List what the user gave of revision, customer, author and date, each with its name."""
    given = asdict(recipe.particulars)
    return [[words(key), visible(given[name])] for name, key in _PARTICULARS.items() if given[name]]


def objective_text(recipe: Recipe, words: Catalogue) -> str:
    """Name what was minimised, with its value where it has one."""
    objective = recipe.objective
    name = words.named("word", objective.name)
    return (
        name if objective.value is None else f"{name}: {with_unit(objective.value, objective.unit, units=words.units)}"
    )


_COLUMNS = (("section.machine", "section.servo"), ("section.product", "section.limits"))
"""Groups of parameters in two columns of about the same length."""


def _group(recipe: Recipe, heading: str, words: Catalogue) -> Block:
    rows = [[words(fact.name), fact_text(fact, words)] for fact in GROUPS[heading](recipe)]
    return {"heading": words(heading), "rows": rows}


def _cam(recipe: Recipe, words: Catalogue) -> list[Block]:
    speed = shown(recipe.job.si["cut"]["line_speed"], "m/s", units=words.units)
    return [{"kind": "figure", "caption": words("figure.caption", line_speed=speed)}]


def speed_columns(recipe: Recipe) -> dict[str, str]:
    """List the columns of what to expect at lower line speeds: field of `AtSpeed`, after which the heading is called, and SI unit."""
    slave = {name: recipe.slave_unit + power for name, power in POWERS.items()}
    lacking = ["peak_torque", "rms_torque"] if all(row.peak_torque is None for row in recipe.speeds) else []
    lacking += ["worst_sync_error"] if all(row.worst_sync_error is None for row in recipe.speeds) else []
    columns = {"line_speed": AT_SPEED["line_speed"], **slave, **AT_SPEED}
    return {name: unit for name, unit in columns.items() if name not in lacking}


def _speeds(recipe: Recipe, words: Catalogue) -> list[Block]:
    """Set what to expect with one column a speed: four of them fit the page, twelve quantities do not."""
    head = [
        words("column.share_of_speed"),
        *(marked(words.number(100.0 * row.share), recipe, row.line_speed) for row in recipe.speeds),
    ]
    rows = []
    for field, unit in speed_columns(recipe).items():
        values = [getattr(row, field) for row in recipe.speeds]
        rows.append(
            [
                words(f"column.{field}", unit=unit_shown(unit, words.units)),
                *(words("nothing") if value is None else length_text(value, unit, words.units) for value in values),
            ]
        )
    return [
        table_block(head, rows, widths=[2.6, *(1.0 for _ in recipe.speeds)]),
        *outside_note((row.line_speed for row in recipe.speeds), recipe, words),
        text_block(words("speeds.law")),
        text_block(words("speeds.lead", lead=shown(recipe.lead_time, "s", 4, words.units))),
    ]


def _range(recipe: Recipe, words: Catalogue) -> list[Block]:
    cut = recipe.job.si["cut"]
    speed, length = shown(cut["line_speed"], "m/s", units=words.units), shown(cut["length"], "m", units=words.units)
    far = recipe.working_range
    looked = far.max_length.binding == NOT_FOUND
    longest = words("range.not_looked", factor=words.number(LONGEST)) if looked else words("range.no_longest")
    ends: tuple[tuple[str, Edge, str, str], ...] = (
        ("range.min_length", far.min_length, "m", words("range.not_found")),
        ("range.max_length", far.max_length, "m", longest),
        ("range.min_line_speed", far.min_line_speed, "m/s", words("range.no_lowest")),
        ("range.max_line_speed", far.max_line_speed, "m/s", words("range.not_found")),
    )
    rows = [
        [
            words(key, line_speed=speed, length=length),
            without if edge.value is None else shown(edge.value, unit, units=words.units),
            words.named("binding", edge.binding),
        ]
        for key, edge, unit, without in ends
    ]
    head = [words(key) for key in ("column.end", "column.value", "column.binding")]
    notes = [words("range.note")]
    if recipe.speed_band:
        key = "range.released" if recipe.released else "range.passes"
        notes.append(words(key, released=released_speeds(recipe, words)))
    return [table_block(head, rows, left=3, widths=[2.2, 1.7, 1.0]), *map(text_block, notes)]
