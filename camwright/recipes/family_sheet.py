"""The sheet of a family of cams: its cams, when the controller changes from one to the next, and what was proved of that."""

from __future__ import annotations

from typing import Any

from camwright.house.numbers import converted, inside, shown, with_unit
from camwright.recipes.blocks import Block, record_block, shortened, table_block, text_block, visible
from camwright.recipes.catalogue import Catalogue, catalogue_of
from camwright.recipes.facts import PRODUCT, fact_text, listed, servo_rows
from camwright.recipes.html import page
from camwright.recipes.pdf import typeset

FAMILY_FILE = "family.json"
PAGE, PRINT = "family.html", "family.pdf"

_DIGITS = 7
"""Digits of a line speed that is set in the controller, rounded to the side where both cams hold."""


def family_sheets(record: dict[str, Any]) -> dict[str, bytes]:
    """Set the contents of a family.json as a page and in print, in its language."""
    words = catalogue_of(record["language"], record["toml"])
    data = family_sheet(record, words)
    return {PAGE: page(data).encode(), PRINT: typeset(data, record["provenance"]["camwright"])}


def family_sheet(record: dict[str, Any], words: Catalogue) -> dict[str, Any]:
    """Set the contents of a family.json in a language; as `camwright.recipes.sheet.sheet`."""
    low, high = record["line_speeds_m_per_s"]
    span = words("speeds.part", low=_speed(low, words, up=True), high=_speed(high, words, up=False))
    passed, several = record["passed"], len(record["cams"]) > 1
    name = visible(record["job"])
    makers = (
        ("heading.cams", _cams),
        ("heading.switching", _switching),
        ("heading.changes", _changes),
        ("heading.steps", _steps),
        ("section.record", _record),
    )
    return {
        "title": name,
        "short": shortened(name),
        "kind": words("family"),
        "language": words.language,
        "released": passed,
        "status": words("family.released", speeds=span) if passed else words("family.not_released"),
        "boxed": record["hold_line_speed"] and several,
        "warnings": [words("family.holds_line" if record["hold_line_speed"] else "family.ramps")] if several else [],
        "head": [
            *_counted(record, words),
            [words("head.objective"), words.named("word", record["cams"][0]["objective"]["name"])],
            [words("head.camwright"), f"camwright {record['provenance']['camwright']}"],
            [words("head.job_sha256"), record["provenance"]["job_sha256"]],
        ],
        "groups": [
            [_group("section.product", listed(record["si"]["cut"], PRODUCT), words)],
            [_group("section.servo", servo_rows(record["si"]), words)],
        ],
        "page": words("page"),
        "sections": [
            {"key": key, "heading": words(key), "blocks": blocks}
            for key, make in makers
            if (blocks := make(record, words))
        ],
    }


def _counted(record: dict[str, Any], words: Catalogue) -> list[list[str]]:
    """Say how many cams there are, whether fewer would do, and how far their bands overlap; of one cam there is nothing to say."""
    cams = str(len(record["cams"]))
    if len(record["cams"]) == 1:
        return [[words("family.cams"), cams]]
    fewest = words("family.fewest" if record["fewest"] else "family.at_least", cams=cams, least=str(record["at_least"]))
    return [[words("family.cams"), fewest], [words("family.overlap"), f"{words.number(100.0 * record['overlap'])} %"]]


def _group(heading: str, facts: list[Any], words: Catalogue) -> Block:
    return {"heading": words(heading), "rows": [[words(fact.name), fact_text(fact, words)] for fact in facts]}


def _speed(value: float, words: Catalogue, *, up: bool) -> str:
    """Write a line speed, rounded to its inside."""
    return words.number(inside(converted(value, "m/s", words.units), _DIGITS, up=up), _DIGITS)


def _cams(record: dict[str, Any], words: Catalogue) -> list[Block]:
    head = [words(f"column.{key}") for key in ("cam", "name", "from_speed", "to_speed", "sync_error", "passed")]
    rows = []
    for cam in record["cams"]:
        low, top = cam["band_m_per_s"]
        failed = ", ".join(words.named("check", check) for check in cam["failed_checks"])
        rows.append(
            [
                str(cam["cam"]),
                visible(cam["name"]),
                _speed(low, words, up=True),
                _speed(top, words, up=False),
                shown(cam["worst_of_all_servos_m"], "m", 3, words.units),
                words("yes") if cam["passed"] else f"✗ {failed}",
            ]
        )
    tolerance = with_unit(record["cams"][0]["sync_tolerance_m"], "m", units=words.units)
    return [
        table_block(head, rows, left=2, widths=[0.6, 3, 1.2, 1.2, 2, 1.5]),
        text_block(words("family.cams_note", tolerance=tolerance)),
    ]


def _switching(record: dict[str, Any], words: Catalogue) -> list[Block]:
    """Set what the controller does: one row for each change, the hysteresis between two of them beside both."""
    head = [words(f"column.{key}") for key in ("runs", "change_to", "change_at", "between_speeds", "through")]
    rows = []
    for each in record["switching"]:
        up, down = _speed(each["up_m_per_s"], words, up=False), _speed(each["down_m_per_s"], words, up=True)
        between = words("speeds.span", low=down, high=up)
        for way, runs, then, at in (("up", "slower", "faster", up), ("down", "faster", "slower", down)):
            change = each["transition"][way]
            how = change["name"] or words(f"change.{change['how']}")
            rows.append([str(each[runs]), str(each[then]), words(f"change.{way}", speed=at), between, how])
    return (
        [table_block(head, rows, left=5, widths=[1, 1, 2, 2, 1.6]), text_block(words("family.hysteresis"))]
        if rows
        else []
    )


def _changes(record: dict[str, Any], words: Catalogue) -> list[Block]:
    """Set the checks of every change as they were run."""
    head = [words(f"column.{key}") for key in ("change", "check", "value", "limit", "passed")]
    rows = []
    for each in record["switching"]:
        for way, pair in (("up", ("slower", "faster")), ("down", ("faster", "slower"))):
            told = " → ".join(str(each[cam]) for cam in pair)
            for check in each["transition"][way]["checks"]:
                values = [_value(check[key], check["unit"], words) for key in ("value", "limit")]
                rows.append([told, _check(check["name"], words), *values, words("yes" if check["passed"] else "no")])
    return (
        [table_block(head, rows, left=2, widths=[1, 3, 1.5, 1.5, 1]), text_block(words("family.changes_note"))]
        if rows
        else []
    )


def _check(name: str, words: Catalogue) -> str:
    """Name a check of a change; some words mean there another thing than in a cycle that repeats."""
    own = f"change_check.{name}"
    return words(own) if own in words.messages else words.named("check", name)


def _value(value: float | None, unit: str, words: Catalogue) -> str:
    """Write a value of a check with its unit, in that of the reader where it has one."""
    return words("nothing") if value is None else with_unit(value, unit, 4, words.units)


def _steps(record: dict[str, Any], words: Catalogue) -> list[Block]:
    """List what is done at the controller."""
    keys = ["load", "table", "zone", *(["hold"] if record["hold_line_speed"] else []), "run", "changes"]
    if len(record["cams"]) == 1:
        keys = ["load", "run"]
    return [{"kind": "checklist", "items": [words(f"step.{key}") for key in keys]}]


def _record(record: dict[str, Any], words: Catalogue) -> list[Block]:
    length = shown(record["si"]["cut"]["length"], "m", units=words.units)
    rows = []
    for cam in record["cams"]:
        middle = shown(sum(cam["band_m_per_s"]) / 2.0, "m/s", 4, words.units)
        rows.append([words("record.cam_length", cam=str(cam["cam"]), speed=middle), length])
    for each in record["switching"]:
        for way, pair, up in (("up", ("slower", "faster"), False), ("down", ("faster", "slower"), True)):
            told = " → ".join(str(each[cam]) for cam in pair)
            rows.append([words(f"record.switching_{way}", change=told), _speed(each[f"{way}_m_per_s"], words, up=up)])
    return [record_block(rows, words)]
