"""Reading TOML as people write it."""

from __future__ import annotations

import re
import tomllib
from typing import Any

from camwright.profiles.errors import InputError

MOST_BYTES = 1 << 20
"""The most bytes that a file of settings may have."""


def toml_data(text: str, place: str, what: str) -> dict[str, Any]:
    """Read what a TOML file holds.

    Parameters
    ----------
    text
        The file's text.
    place
        What messages begin with: the file's path.
    what
        What the file should be, e.g. ``"job file"``.

    Raises
    ------
    InputError
        It is not TOML.
    """
    try:
        return tomllib.loads(text.removeprefix("\ufeff"))
    except RecursionError as error:
        raise InputError(f"{place}: not a {what}: its arrays or tables are nested too deeply") from error
    except ValueError as error:  # TOMLDecodeError, and integers beyond Python's limit of digits
        raise InputError(f"{place}: not TOML: {toml_fault(text, error)}") from error


_LINE = re.compile(r"\(at line ([0-9]+), column [0-9]+\)")
_ASSIGNED = re.compile(r"\s*([A-Za-z_][\w.-]*)\s*=\s*(.*)", re.DOTALL)
_QUOTES = "“”„‟«»‘’"
_NUMBER = re.compile(r"([+-]?[0-9]*)([.,]?)([0-9]+)\s*([^\s0-9,.#\"'\[\]][^#\"'\[\]]{0,30}?)?\s*(?:#.*)?")


def toml_fault(text: str, error: Exception) -> str:
    """Say why a text is not TOML, in which line, and what to write where the line shows what was meant.

    Parameters
    ----------
    error
        What `tomllib` says of it.

    Examples
    --------
    >>> import tomllib
    >>> def told(text):
    ...     try:
    ...         tomllib.loads(text)
    ...     except ValueError as error:
    ...         return toml_fault(text, error)
    >>> told("length = 600 mm")
    'line 1: length = 600 mm: a quantity stands in quotes; write length = "600 mm"'
    >>> told("damping = 0,7")
    'line 1: damping = 0,7: numbers have a decimal point; write damping = 0.7'
    """
    end = f"at the end, line {text.rstrip().count(chr(10)) + 1}"
    plain = str(error).replace("at end of document", end)
    place = _LINE.search(plain)
    lines = text.split("\n")
    if place is None:
        wrong = next((line for line in lines[::-1] if line.strip()), "")
        number = max(1, len(text.rstrip().split("\n")))
    else:
        number = int(place[1])
        wrong = lines[number - 1] if number <= len(lines) else ""
    remedy = _remedy(wrong)
    return f"line {number}: {remedy}" if remedy else plain


def _remedy(line: str) -> str | None:
    """Say what to write for a line; nothing where it does not show what was meant."""
    assigned = _ASSIGNED.fullmatch(line.rstrip("\r"))
    if assigned is None:
        return None
    key, value = assigned[1], assigned[2].strip()
    written = f"{key} = {value}"[:80]
    curly = next((quote for quote in _QUOTES if value.startswith(quote)), None)
    if curly is not None:
        inner = value.strip(_QUOTES + '"')
        return f'{written}: {curly} is no quote of a job file; write {key} = "{inner}"'
    number = _NUMBER.fullmatch(value)
    if number is None:
        return None
    whole, point, rest, unit = number.groups()
    plain = f"{whole or '0'}.{rest}" if point else f"{whole}{rest}"
    if unit:
        comma = " and numbers have a decimal point" if point == "," else ""
        return f'{written}: a quantity stands in quotes{comma}; write {key} = "{plain} {unit.strip()}"'
    if point != ",":
        return None
    thousands = f" for a fraction, {key} = {whole}{rest} for thousands" if len(rest) == 3 and whole.strip("+-0") else ""
    return f"{written}: numbers have a decimal point; write {key} = {plain}{thousands}"
