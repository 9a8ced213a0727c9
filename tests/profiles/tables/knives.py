"""Profiles and units that the tests of the tables share."""

from __future__ import annotations

import math
from functools import cache

from camwright.profiles.cut import Cut
from camwright.profiles.limits import Limits
from camwright.profiles.machines import RotaryKnife
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import baseline
from camwright.profiles.tables.cam_table import TableUnits, Unit
from camwright.profiles.tables.knots import (
    Accuracy,
    ChosenTable,
    choose,
    table_units,
)
from camwright.profiles.tables.target import Header
from camwright.profiles.tables.targets import TARGETS
from camwright.profiles.task import Task

FREE = Limits(math.inf, math.inf, math.inf)
"""Nothing here asks for limits."""
KNIFE = RotaryKnife(0.4)
UNITS = TableUnits(Unit("mm", 1e-3), Unit("deg", 0.4 / 360))
HEADER = Header("knife-600", "0.4.0", "ab" * 32, (("peak acceleration", "12.5 m/s2"),))

KNIVES: dict[str, tuple[str, float, str]] = {
    "quintic": ("poly_3_4_5", 0.6, "return"),
    "jerk-limited": ("double_s", 0.6, "return"),
    "short, origin at the cut": ("double_s", 0.36, "cut"),
    "of degree 15": ("modified_sine", 0.45, "return"),
}


def cut(length: float = 0.6, origin: str = "return") -> Cut:
    return Cut(length, 80 / 60, 0.2, 0.04, 0.1, 0.25e-3, origin)  # type: ignore[arg-type]


@cache
def knife(name: str) -> CamProfile:
    law, length, origin = KNIVES[name]
    return baseline(law, Task(KNIFE, cut(length, origin), FREE))


@cache
def chosen(target: str, name: str, points: int | None = None) -> ChosenTable:
    profile = knife(name)
    units = table_units(TARGETS[target], profile, UNITS)
    return choose(profile, TARGETS[target], units, Accuracy(), points)


@cache
def written(target: str, name: str) -> dict[str, str]:
    return TARGETS[target].write(chosen(target, name).table, HEADER)


def main_text(target: str, name: str) -> tuple[str, str]:
    file, text = next(iter(written(target, name).items()))
    return file, text
