"""The cam figure: position, ratio and acceleration over one cycle, told apart without colour."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np

from camwright.house.numbers import Units, converted, unit_shown
from camwright.house.pictures import DASHED, Band, DrawnLine, Frame, Look, Picture
from camwright.house.svg import picture_svg
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.recipes.catalogue import Catalogue
from camwright.recipes.model import Recipe

_WIDTH, _BELOW = 620.0, 49.0
_LEFT, _RIGHT, _TOP, _PANEL, _GAP = 78.0, 14.0, 7.0, 104.0, 13.0
"""The page and its frames (pt)."""

_FAR = 3.0
"""A limit is drawn if it is at most this many times the greatest value drawn."""

_NOTHING = 1e-6
"""Share of a limit below which a curve is rounding, not worth a scale of its own."""

_MOST_POINTS = 1600
_ROOM = 0.06
"""Share of a curve's height that stays free above and below it."""

_INK = "#000"

_DECIMALS = re.compile(r">(−?\d+)\.(\d+)<")
"""A number with decimals that is all of a text, as at a tick."""


def figure_svg(recipe: Recipe, words: Catalogue) -> str:
    """Draw the cam of a recipe.

    Zones are grey and hatched, limits dashed, so the figure reads in black and white. Text stays text.
    """
    units = words.units
    zones = [*_bands(recipe.zones.sync, "grey", units), *_bands(recipe.zones.shear, "hatched", units)]
    length = converted(recipe.job.si["cut"]["length"], "m", units)
    curves = list(_curves(recipe, words))
    frames = [
        _frame(curve, limits, label, zones, length, _TOP + number * (_PANEL + _GAP), words if number == 2 else None)
        for number, (label, curve, limits) in enumerate(curves)
    ]
    legend = (
        Band(0.0, 1.0, "grey", words("figure.sync")),
        Band(0.0, 1.0, "hatched", words("figure.shear")),
        _limit(0.0, 1.0, words("figure.limit")),
    )
    height = _TOP + len(frames) * (_PANEL + _GAP) - _GAP + _BELOW
    svg = picture_svg(Picture(_WIDTH, height, "", _LEFT, frames, legend))
    return _DECIMALS.sub(rf">\g<1>{units.decimal}\g<2><", svg)


def _bands(zones: tuple[tuple[float, float], ...], look: Look, units: Units) -> list[Band]:
    """Turn zones on the master (m) into bands."""
    return [Band(converted(start, "m", units), converted(end, "m", units), look) for start, end in zones]


def _curves(recipe: Recipe, words: Catalogue) -> Iterator[tuple[str, FloatArray, tuple[float, ...]]]:
    """Give what is drawn over the master: label, points in the units shown, limits that may be drawn."""
    profile = CamProfile(np.array(recipe.profile.breaks), np.array(recipe.profile.coefficients))
    v, limits, unit = recipe.job.si["cut"]["line_speed"], recipe.job.si["limits"], recipe.slave_unit
    per_master = "1" if unit == "m" else "rad/m"
    over_time = f"{unit}/s^2"
    units = words.units
    across, up, per_acceleration = (converted(1.0, si, units) for si in ("m", unit, over_time))
    peak = limits["acceleration"] * per_acceleration
    label = words("figure.position", unit=unit_shown(unit, units))
    yield label, _curve(profile, 0) * [across, up], ()
    label = words("figure.ratio", unit=unit_shown(per_master, units))
    yield label, _curve(profile, 1) * [across, 1.0], (limits["speed"] / v,)
    label = words("figure.acceleration", unit=unit_shown(over_time, units))
    yield label, _curve(profile, 2) * [across, v * v * per_acceleration], (-peak, peak)


def _curve(profile: CamProfile, order: int) -> FloatArray:
    """Points of a derivative over the master (m), shape ``(n, 2)``, every piece from its first to its last break."""
    each = max(2, min(48, _MOST_POINTS // profile.pieces))
    part = np.linspace(0.0, 1.0, each + 1)
    x = profile.breaks[:-1, None] + np.diff(profile.breaks)[:, None] * part
    x[:, -1] = profile.breaks[1:]
    value = profile(x, order)
    value[:, -1] = profile(x[:, -1], order, side="left")
    return np.stack([x.ravel(), value.ravel()], axis=1)


def _frame(
    curve: FloatArray,
    most: tuple[float, ...],
    label: str,
    zones: list[Band],
    length: float,
    top: float,
    below: Catalogue | None,
) -> Frame:
    """Draw one curve with the limits that are near it; the last frame names the master below it."""
    low, high = float(curve[:, 1].min()), float(curve[:, 1].max())
    reach = max(abs(low), abs(high), 1e-12)
    if most and reach < _NOTHING * max(most):
        reach = max(most)
    limits = [limit for limit in most if abs(limit) <= _FAR * reach]
    low, high = min([low, *limits]), max([high, *limits])
    if high - low < 1e-9 * reach:
        low, high = low - reach, high + reach
    room = _ROOM * (high - low)
    quantity, _, unit = label.rpartition(" ")
    return Frame(
        _LEFT,
        top,
        _WIDTH - _LEFT - _RIGHT,
        _PANEL,
        np.array([0.0, low - room]),
        np.array([length, high + room]),
        [*zones, *(_limit(limit, length) for limit in limits), DrawnLine(curve, _INK, 1.5)],
        "" if below is None else below("figure.master"),
        f"{quantity}\n{unit}",
        grid=True,
        apart=18.0,
    )


def _limit(value: float, length: float, label: str = "") -> DrawnLine:
    return DrawnLine(np.array([[0.0, value], [length, value]]), _INK, 1.0, label, DASHED)
