"""The text of a table file: from bytes to lines and numbers, with every refusal naming file, line and reason."""

from __future__ import annotations

import math
import re
from pathlib import Path

from camwright.profiles.errors import InputError
from camwright.profiles.tables.cam_table import LARGEST_VALUE

LARGEST_FILE = 4_000_000
"""Bytes; a table of 10 000 points takes less than 1 500 000."""
LONGEST_LINE = 20_000
MOST_LINES = 40_000

_CONTROL = re.compile(r"[\x00-\x08\x0b\x0e-\x1f\x7f]")
_EASTERN = ("時間", "位置", "位相", "変位", "主軸", "従軸", "從軸", "指令", "現在", "角度")
"""Words of headings by which Japanese and Taiwanese codes are known: of other texts they come out of none."""
_WORKBOOKS = (b"PK\x03\x04", b"\xd0\xcf\x11\xe0")
"""How files of spreadsheets begin, packed ones and older ones."""
_HIGH = re.compile(rb"[\x80-\xff]+")
_GB2312 = re.compile(rb"(?:[\xa1-\xa9\xb0-\xf7][\xa1-\xfe])+")
_REAL = re.compile(r"[+-]?(?:[0-9]{1,40}(?:\.[0-9]{0,40})?|\.[0-9]{1,40})(?:[eE][+-]?[0-9]{1,4})?")
_INTEGER = re.compile(r"[+-]?[0-9]{1,18}")


def refuse(place: str, line: int | None, reason: str) -> InputError:
    """Make the error for a file that is not read: where and why."""
    return InputError(f"{place}: {reason}" if line is None else f"{place}, line {line}: {reason}")


def shown(text: str) -> str:
    """Render a piece of foreign text for a message: short, printable, quoted."""
    return ascii(text if len(text) <= 40 else text[:37] + "...")


def read_text(path: Path) -> str:
    """Read a table file.

    Raises
    ------
    InputError
        The file cannot be read, is larger than `LARGEST_FILE`, or is not text.
    """
    try:
        with path.open("rb") as file:
            data = file.read(LARGEST_FILE + 1)
    except OSError as error:
        raise InputError(f"{path}: the file cannot be read: {error.strerror or error}") from error
    return decode(data, str(path))


def decode(data: bytes, place: str, most: int = LARGEST_FILE) -> str:
    r"""Turn a table file's bytes into text with ``\n`` line ends.

    UTF-8 with or without a byte order mark; UTF-16, which has a zero in every second byte if it has no mark; what is
    neither is Shift JIS or Big5 where that gives words of headings, GBK if all its bytes beyond ASCII stand in pairs of
    that code, else the Windows code page 1252.
    """
    if len(data) > most:
        raise refuse(place, None, f"the file is larger than {most} bytes; no cam table of a drive is")
    if data.startswith(_WORKBOOKS):
        raise refuse(
            place,
            None,
            "this is a workbook of a spreadsheet, or another packed file; save the sheet as CSV, and name that",
        )
    text = text_of(data, place)
    found = _CONTROL.search(text)
    if found:
        line = text.count("\n", 0, found.start()) + 1
        raise refuse(place, line, f"the control character {found[0]!a} stands here; this is not a text file")
    if not text.strip():
        raise refuse(place, None, "the file is empty")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def text_of(data: bytes, place: str) -> str:
    """Find the code of a text."""
    wide = _wide(data)
    if wide is not None:
        try:
            return data.decode(wide).removeprefix("\ufeff")
        except UnicodeDecodeError as error:
            raise refuse(place, None, "the file begins like UTF-16 but is not") from error
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        pass
    for code in ("cp932", "big5"):
        text = data.decode(code, "ignore")
        if any(word in text for word in _EASTERN):
            return text
    runs = _HIGH.findall(data)
    if all(_GB2312.fullmatch(run) for run in runs):
        try:
            return data.decode("gbk")
        except UnicodeDecodeError:
            pass
    return data.decode("cp1252", "replace")


def _wide(data: bytes) -> str | None:
    """Name the code of a text in UTF-16, by its mark or by the zeros of its ASCII signs."""
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return "utf-16"
    head = data[:400]
    for name, first in (("utf-16-le", 1), ("utf-16-be", 0)):
        if (
            len(head) >= 8
            and head[first::2].count(0) > 0.2 * len(head)
            and head[1 - first :: 2].count(0) < 0.02 * len(head)
        ):
            return name
    return None


def lines_of(text: str, place: str) -> list[str]:
    """Split a point list into lines; too many or too long ones are refused."""
    count = text.count("\n") + 1
    if count > MOST_LINES:
        raise refuse(place, None, f"there are {count} lines; a cam table has at most {MOST_LINES}")
    lines = text.split("\n")
    for number, line in enumerate(lines, start=1):
        if len(line) > LONGEST_LINE:
            raise refuse(place, number, f"the line is {len(line)} characters long; at most {LONGEST_LINE} are read")
    return lines


def real(text: str, place: str, line: int, *, comma: bool = False) -> float:
    """Read a number; ``comma`` allows a decimal comma in place of the point."""
    plain = text.strip()
    if comma and plain.count(",") == 1 and "." not in plain:
        plain = plain.replace(",", ".")
    if not _REAL.fullmatch(plain):
        raise refuse(place, line, f"{shown(text.strip())} is not a number")
    value = float(plain)
    if not math.isfinite(value) or abs(value) > LARGEST_VALUE:
        raise refuse(place, line, f"{shown(plain)} is beyond {LARGEST_VALUE:g}")
    return value


def integer(text: str, place: str, line: int) -> int:
    """Read a whole number."""
    if not _INTEGER.fullmatch(text.strip()):
        raise refuse(place, line, f"{shown(text.strip())} is not a whole number")
    return int(text)


def check_points(x: list[float], lines: list[int], place: str, most: int | None, least: int = 2) -> None:
    """Refuse too few or too many points, or master positions that do not increase strictly."""
    check_count(len(x), least, most, place)
    check_ascending(x, lines, place)


def check_ascending(x: list[float], lines: list[int], place: str) -> None:
    """Refuse master positions that do not increase strictly, naming the line of the first that does not."""
    for k in range(1, len(x)):
        if not x[k] > x[k - 1]:
            what = "occurs twice" if x[k] == x[k - 1] else f"follows {x[k - 1]!r}"
            raise refuse(place, lines[k], f"master positions must increase strictly; {x[k]!r} {what}")


def check_count(points: int, least: int, most: int | None, place: str) -> None:
    """Refuse a table of too few or too many points."""
    if points < least:
        raise refuse(place, None, f"a table here needs at least {least} points; the file holds {points}")
    if most is not None and points > most:
        raise refuse(place, None, f"a table here has at most {most} points; the file holds {points}")
