"""Makes ``camwright/house/units.json``: every name of a unit that pint knows by these definitions, its factor and its dimension.

    python tests/house/unit_table.py

Commands read the file, which takes a thousandth of the time that pint takes to load; a test says that it is what pint makes.
"""

from __future__ import annotations

import json
from fractions import Fraction
from itertools import product
from pathlib import Path
from typing import Any

import pint

FILE = Path(__file__).parents[2] / "camwright" / "house" / "units.json"

# Angle is a dimension of its own, so that "120 1/s" is not taken for 120 rad/s; hertz counts turns, as drives state a
# bandwidth, so that a gain cannot be written in it. The gram is the unit that is defined: pint would else take "kgram"
# for a new kilogram. Numbers are fractions: 600 mm is the float nearest to 0.6, whatever the order of the factors.
DEFINITIONS = """
kilo- = 1e3 = k-
centi- = 1e-2 = c-
milli- = 1e-3 = m-
micro- = 1e-6 = µ- = μ- = u-
meter = [length] = m = metre
second = [time] = s = sec
radian = [angle] = rad
gram = [mass] = g
pound = 453.59237 * gram = lb
newton = 1000 * gram * meter / second ** 2 = N
newton_meter = newton * meter = Nm
inch = 0.0254 * meter = in = inches
foot = 0.3048 * meter = ft = feet
minute = 60 * second = min
hour = 3600 * second = h
turn = 6.283185307179586476925286766559 * radian = _ = rev = revolution
degree = turn / 360 = deg = °
turn_per_minute = turn / minute = rpm
hertz = turn / second = Hz
foot_per_minute = foot / minute = fpm
"""


def registry() -> pint.UnitRegistry[Fraction]:
    """Make pint's registry of these definitions alone."""
    return pint.UnitRegistry(DEFINITIONS.strip().splitlines(), non_int_type=Fraction)


def unit_table() -> dict[str, list[Any]]:
    """Ask pint about every prefix, name and plural; for each name that it knows the factor as text and the powers of the dimensions."""
    known = registry()
    lines = [line.partition("=") for line in DEFINITIONS.strip().splitlines()]
    words = [[name.strip(), *(each.strip() for each in rest.split("=")[1:])] for name, _, rest in lines]
    prefixes = [each[:-1] for names in words for each in names if each.endswith("-")]
    units = [each for names in words for each in names if not each.endswith("-") and each != "_"]
    table: dict[str, list[Any]] = {}
    for prefix, unit, plural in product(["", *prefixes], units, ["", "s"]):
        name = prefix + unit + plural
        try:
            found = known.UnitsContainer({known.get_name(name): 1})
        except pint.UndefinedUnitError:
            continue
        dimension = {each: int(power) for each, power in sorted(known.get_dimensionality(found).items())}
        factor = Fraction(known.get_base_units(found)[0]) / 1000 ** dimension.get(
            "[mass]", 0
        )  # our unit of mass is the kilogram
        table[name] = [str(factor), dimension]
    return table


def written() -> str:
    """Give the text of the file, a unit a line."""
    rows = [f"{json.dumps(name, ensure_ascii=False)}: {json.dumps(row)}" for name, row in sorted(unit_table().items())]
    return "{\n" + ",\n".join(rows) + "\n}\n"


if __name__ == "__main__":
    FILE.write_text(written(), encoding="utf-8")
