"""Numbers as cells of tables hold them: with a decimal comma, an exponent of Fortran's, a unit behind, or thousands set apart."""

from __future__ import annotations

import re

from camwright.profiles.tables.column_words import is_unsized, unit_word

_NUMBER = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eEdD][+-]?[0-9]{1,4})?")
_COMMA = re.compile(r"[+-]?(?:[0-9]+,[0-9]*|,[0-9]+)(?:[eEdD][+-]?[0-9]{1,4})?")
_MEASURED = re.compile(r"([-+]?[0-9.,]{1,40}(?:[eEdD][+-]?[0-9]{1,4})?)[ ]{0,3}([^\s0-9.,+-]\S{0,11})")
"""A number with its unit in one cell."""
_SIGNS = str.maketrans(
    "\u2212\u2013\uff0d\uff0b\uff0e\uff0c\u00a0\u2009\u202f０１２３４５６７８９", "---+.,   0123456789"
)
"""Signs of numbers as word processors and Asian keyboards write them."""
_STAMP = re.compile(
    r"[0-9]{1,4}[-./:][0-9]{1,2}[-./:][0-9]{1,4}(?:[.,][0-9]{1,9}|[ T][0-9:.,]{1,20})?(?: ?[AP]M)?(?:Z| ?[+-][0-9]{2}:?[0-9]{2})?"
)
_WITH_E = re.compile("[dD]")
"""The exponent's sign of Fortran's double precision."""
_GROUPED = re.compile(r"[+-]?[0-9]{1,3}(?:([.,' \u00a0\u2009\u202f])[0-9]{3})(?:\1[0-9]{3})*(?:[.,][0-9]*)?")
GROUPS = "has its thousands set apart; export the numbers without such signs, like 1234.5"
"""What is wrong with a number whose thousands are set apart."""


def is_stamp(cell: str) -> bool:
    """Whether a cell is a date, with a time of day and the zone that it is in or without."""
    return _STAMP.fullmatch(cell.strip()) is not None


def number_in(cell: str, comma: bool) -> float | None:
    """Read a cell with a decimal point, or where allowed a comma; ``None`` for what is no number."""
    plain = _plain(cell)
    if _NUMBER.fullmatch(plain):
        return float(_WITH_E.sub("e", plain))
    if comma and _COMMA.fullmatch(plain):
        return float(_WITH_E.sub("e", plain).replace(",", "."))
    return None


def _plain(cell: str) -> str:
    plain = cell.strip()
    return plain if plain.isascii() else plain.translate(_SIGNS)


def measured_in(cell: str, comma: bool) -> tuple[str, str] | None:
    """Take a cell apart into its number, as text, and a unit; ``None`` for what is not a number with a unit."""
    found = _MEASURED.fullmatch(_plain(cell))
    if found is None or number_in(found[1], comma) is None:
        return None
    unit = unit_word(found[2]) or (found[2] if is_unsized(found[2]) else None)
    return None if unit is None else (found[1], unit)


def grouped(cell: str) -> bool:
    """Whether a cell is a number whose thousands are set apart."""
    plain = cell.strip().strip('"').strip()
    return _GROUPED.fullmatch(plain) is not None and number_in(plain, True) is None


def is_number(cell: str, comma: bool) -> bool:
    """Whether a cell is a number, with a unit or without."""
    return number_in(cell, comma) is not None or measured_in(cell, comma) is not None
