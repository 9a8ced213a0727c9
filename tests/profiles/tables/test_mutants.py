"""Tables with one fault each: refused, or read as the motion that stands in the file, told by a reader of its own here."""

from __future__ import annotations

import random
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
import pytest
from knives import HEADER, chosen

from camwright.profiles.errors import InputError
from camwright.profiles.tables.cam_table import CamTable
from camwright.profiles.tables.targets import TARGETS

PLAIN = re.compile(r"[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?")
COLUMNS = ("x", "y", "ratio", "ratio_slope")
COMMA = ("lenze", "sew", "twincat-cnc", "kollmorgen-kas")
"""Layouts in which a decimal comma is one."""

MEMBERS = {
    "codesys": r"dX := (\S+), dY := (\S+), dV := (\S+), dA := ([^\s)]+)\)",
    "s7-1500t": r"leadingValue := (\S+), followingValue := (\S+), velocityRatio := (\S+), accelerationRatio := ([^\s)]+)\)",
    "twincat": r"MasterPos := ([^;]+);\s*\S+SlavePos := ([^;]+);\s*\S+SlaveVelo := ([^;]+);\s*\S+SlaveAcc := ([^;]+);",
    "csv": r"(?m)^([-0-9.e+]+),([-0-9.e+]+),([-0-9.e+]+),([-0-9.e+]+)$",
    "sew": r"(?m)^([-0-9.e+]+)\t([-0-9.e+]+)$",
    "lenze": r"(?m)^([-0-9.e+]+) ([-0-9.e+]+)(?= |$)",
    "twincat-cnc": r"(?m)^([-0-9]+) ([-0-9]+)$",
    "technosoft": r"(?m)^([-0-9]+)\t([-0-9]+)$",
    "kollmorgen-kas": r"(?m)^([-0-9.e+]+);([-0-9.e+]+);SPLINE$",
    "logix": r'Name="Master" [^>]*Value="([^"]+)"/>\s*<DataValueMember Name="Slave" [^>]*Value="([^"]+)"/>',
}  # fmt: skip
"""How each layout writes a row."""


@dataclass(frozen=True)
class Cell:
    """Where a number stands in a file, and whose it is."""

    start: int
    end: int
    row: int
    column: str


def text_of(target: str) -> str:
    table = chosen(target, "jerk-limited", 41 if TARGETS[target].law != "quintic" else None).table
    return next(iter(TARGETS[target].write(table, HEADER).values()))


def read(target: str, text: str) -> CamTable | None:
    try:
        return TARGETS[target].read(text, "file")
    except InputError:
        return None


def cells(target: str, text: str) -> list[Cell]:
    if target == "trio":
        found = [match for line in re.finditer(r"TABLE\([0-9]+((?:, [-0-9]+)+)\)", text) for match in _numbers(line)]
        return [Cell(start, end, i, "y") for i, (start, end) in enumerate(found)]
    rows = re.finditer(MEMBERS[target], text)
    return [
        Cell(*match.span(k + 1), row, COLUMNS[k])
        for row, match in enumerate(rows)
        for k in range(len(match.groups()))
    ]  # fmt: skip


def _numbers(line: re.Match[str]) -> Iterator[tuple[int, int]]:
    for number in re.finditer(r"[-0-9]+", line[1]):
        yield line.start(1) + number.start(), line.start(1) + number.end()


def same(table: CamTable, other: CamTable) -> bool:
    return table.points == other.points and all(
        np.array_equal(getattr(table, name), getattr(other, name), equal_nan=True) for name in COLUMNS
    )


def another_digit(token: str, rng: random.Random) -> str:
    at = rng.choice([i for i, letter in enumerate(token) if letter.isdigit()])
    return token[:at] + rng.choice("0123456789") + token[at + 1 :]


WRITTEN: tuple[Callable[[str, random.Random], str], ...] = (
    another_digit,
    another_digit,
    lambda token, _: token[1:] if token.startswith("-") else f"-{token}",
    lambda token, _: token.replace(".", ",") if "." in token else f"{token},5",
    lambda token, _: f"2.0*({token})",
    lambda token, _: f"{token}+1.0",
    lambda token, _: f"({token})",
    lambda token, _: f"-(-{token})",
    lambda token, _: f"{token}/3",
    lambda token, _: f"--{token}",
    lambda token, _: f"{token}e",
    lambda token, _: f"{token}.5.5",
    lambda token, _: f"{token}x",
    lambda token, _: f"0x{token}",
    lambda token, _: f"{token[:1]} {token[1:]}",
    lambda _token, rng: rng.choice(["", "nan", "inf", "NaN", "TRUE", "x", "1#QNAN", "?", "1,234.5", "١٢", "1e999", "−1", "12%"]),
    lambda token, rng: token[: rng.randrange(len(token))],
)  # fmt: skip
"""What happens to one number."""


def judge_cell(target: str, text: str, table: CamTable, rng: random.Random) -> bool:
    """Write one number otherwise; whether it was read."""
    cell = rng.choice(cells(target, text))
    token = rng.choice(WRITTEN)(text[cell.start : cell.end], rng)
    if (" " in token and target == "lenze") or ("," in token and target == "trio"):
        return False  # one number more is right here
    found = read(target, text[: cell.start] + token + text[cell.end :])
    if found is None:
        return False
    bare = (
        re.sub(r"^([-+]?) *|[ ]*$", r"\1", re.sub(r"^\((.*)\)$", r"\1", token))
        if target not in ("csv", "logix")
        else token
    )
    if target == "twincat-cnc":
        bare = bare.partition("#")[0]  # the rest is a comment
    token = bare.replace("−", "-") if target == "csv" else bare  # spreadsheets write a minus so
    plain = token.replace(",", ".") if target in COMMA and token.count(",") == 1 else token
    if target == "trio" and not PLAIN.fullmatch(plain):  # programs compute: the value must be that of the expression
        plain = repr(float(eval(token, {"__builtins__": {}})))  # noqa: S307 - made above, of digits and signs
    assert PLAIN.fullmatch(plain), f"{target}: {token!r} was read as a number"
    value = float(np.float32(plain)) if target == "logix" else float(plain)
    if target == "csv":
        value *= {"x": 1e-3, "y": 1e-3}.get(cell.column, 1.0)
        assert found.points == table.points
        if any("turns over" in note for note in found.notes):  # put in the order of the master, and told
            meant = table.x.copy()
            meant[cell.row] = value
            assert np.allclose(found.x, np.sort(meant), rtol=1e-14)
            return True
        assert getattr(found, cell.column)[cell.row] == pytest.approx(value, rel=1e-14, abs=1e-300)
        return True
    rows = slice(None, -1 if target == "twincat-cnc" else None)  # its last row follows from the first
    for name in COLUMNS:
        meant = getattr(table, name).copy()
        if name == cell.column:
            meant[cell.row] = value
        size = 1e-7 if target == "logix" else 0.0  # as near as its two copies may be
        assert np.allclose(getattr(found, name)[rows], meant[rows], rtol=size, atol=1e-30, equal_nan=True), (
            f"{target}: {token!r} for {cell} was read as another motion"
        )
    return True


def judge_elsewhere(target: str, text: str, table: CamTable, rng: random.Random) -> bool:
    """Change, drop or double a character that is part of no number of the table; whether the file was read."""
    taken = {at for cell in cells(target, text) for at in range(cell.start, cell.end)}
    places = [i for i in range(len(text)) if i not in taken and not _in_comment(target, text, i)]
    at = rng.choice(places)
    new = rng.choice(["", text[at] * 2, rng.choice("aZ_:=;,.()[]# \n'")])
    if new.isdigit() or (at and text[at - 1].isdigit() and new in ("", ".")):
        return False  # would join to a number, and be another one
    found = read(target, text[:at] + new + text[at + 1 :])
    if found is None:
        return False
    changed = cells(target, text[:at] + new + text[at + 1 :])
    if len(changed) == len(cells(target, text)):
        if target == "logix" and np.isnan(found.ratio).all():  # slopes that are not found are asked for
            found = replace(found, ratio=table.ratio)
        assert same(found, table), (
            f"{target}: {text[max(0, at - 20) : at + 20]!r} with {new!r} was read as another motion"
        )
    return True


def _in_comment(target: str, text: str, at: int) -> bool:
    line = text[text.rfind("\n", 0, at) + 1 : text.find("\n", at) if "\n" in text[at:] else len(text)]
    mark = {"csv": "#", "twincat-cnc": "#"}.get(target, "//")
    if target == "csv" and line.startswith("x ["):
        return True  # names and units say what the numbers are
    begins = text.find("<!--"), text.find("-->")
    return mark in line or begins[0] <= at <= begins[1]


def judge_rows(target: str, text: str, table: CamTable, rng: random.Random) -> bool:
    """Drop, double or exchange lines; whether the file was read."""
    lines = text.split("\n")
    own = sorted({text.count("\n", 0, cell.start) for cell in cells(target, text)})
    at = rng.choice(own[:-1])
    kind = rng.choice(["drop", "double", "exchange"])
    if kind == "drop":
        del lines[at]
    elif kind == "double":
        lines.insert(at, lines[at])
    else:
        lines[at], lines[at + 1] = lines[at + 1], lines[at]
    found = read(target, "\n".join(lines))
    if found is None:
        return False
    first = target == "technosoft" and at == own[0]  # a table that begins one step later
    if kind == "drop" and (
        first or target in ("lenze", "csv", "kollmorgen-kas")
    ):  # layouts that say nowhere how many rows there are
        row = next(cell.row for cell in cells(target, text) if text.count("\n", 0, cell.start) == at)
        assert np.array_equal(found.x, np.delete(table.x, row))
        assert np.array_equal(found.y, np.delete(table.y, row))
        return True
    if kind == "drop" and target == "trio":  # addresses begin anywhere: the first or the last values are missing
        assert found.points < table.points
        assert list(found.y) in (list(table.y[-found.points :]), list(table.y[: found.points]))
        return True
    if kind == "drop" and target == "twincat":  # a member that nothing is assigned to is 0 in the controller
        (cell,) = (cell for cell in cells(target, text) if text.count("\n", 0, cell.start) == at)
        assert getattr(found, cell.column)[cell.row] == 0.0
        return True
    assert same(found, table), f"{target}: after {kind} of line {at + 1} another motion was read"
    return True


def judge_end(target: str, text: str, table: CamTable, rng: random.Random) -> bool:
    """Let the file break off; whether it was read: then as far as it goes, its last number perhaps cut short."""
    first = cells(target, text)[0].start
    found = read(target, text[: rng.randrange(first, len(text))])
    if found is None:
        return False
    whole = found.points - 1
    assert np.array_equal(found.x[:whole], table.x[:whole])
    assert np.array_equal(found.y[:whole], table.y[:whole])
    return True


JUDGES = (judge_cell, judge_cell, judge_cell, judge_elsewhere, judge_rows, judge_end)
KINDS = (*MEMBERS, "trio")


def judge(target: str, count: int, seed: int) -> tuple[int, int]:
    """Make so many mutants; how many were read, and how many refused."""
    text, rng = text_of(target), random.Random(f"{target} {seed}")  # noqa: S311 - no secret
    table = read(target, text)
    assert table is not None
    outcomes = [rng.choice(JUDGES)(target, text, table, rng) for _ in range(count)]
    return sum(outcomes), count - sum(outcomes)


@pytest.mark.parametrize("target", KINDS)
def test_the_reader_here_reads_what_the_target_s_reads(target: str) -> None:
    text = text_of(target)
    table = read(target, text)
    assert table is not None
    found = cells(target, text)
    scale = {"x": 1e-3, "y": 1e-3} if target == "csv" else {}
    columns = {cell.column for cell in found}
    left_out = 1 if target == "twincat-cnc" else 0  # the table closes by itself
    assert len(found) == (table.points - left_out) * len(columns)
    for cell in found:
        value = float(text[cell.start : cell.end]) * scale.get(cell.column, 1.0)
        assert getattr(table, cell.column)[cell.row] == pytest.approx(value, rel=1e-7, abs=1e-300)


@pytest.mark.parametrize("target", KINDS)
def test_no_mutant_is_read_as_another_motion(target: str) -> None:
    taken, refused = judge(target, 60, 1)
    assert taken
    assert refused


@pytest.mark.slow
@pytest.mark.parametrize("target", KINDS)
def test_no_mutant_of_500_is_read_as_another_motion(target: str) -> None:
    judge(target, 500, 2)


def test_two_copies_that_differ_are_refused() -> None:
    text = text_of("logix")
    for cell in cells("logix", text)[4:12]:
        token = text[cell.start : cell.end]
        changed = text[: cell.start] + another_digit(token, random.Random(3)) + text[cell.end :]  # noqa: S311 - no secret
        if changed != text:
            with pytest.raises(InputError, match="differ"):
                TARGETS["logix"].read(changed, "cam.L5X")
