"""The cam figure as SVG: position, ratio and acceleration over one cycle, told apart without colour."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from html import escape

import numpy as np

from camwright.house.numbers import (
    converted,
    number,
    shown,
    unit_shown,
)
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.recipes.catalogue import Catalogue
from camwright.recipes.model import Recipe

_WIDTH, _HEIGHT = 680.0, 440.0
_LEFT, _RIGHT, _TOP, _PANEL, _GAP = 84.0, 18.0, 8.0, 114.0, 14.0
_FAR = 3.0
"""A limit is drawn if it is at most this many times the greatest value drawn."""
_NOTHING = 1e-6
_MOST_POINTS = 1600
_ROOM = 0.06
_DOTTED = 'stroke-dasharray="1.5 2.5"'


@dataclass(frozen=True, eq=False)
class Panel:
    """One curve over the master.

    Parameters
    ----------
    label
        What is drawn, and its unit.
    x, y
        The curve: master (m), value in the unit shown.
    limits
        Limits that may be drawn.
    """

    label: str
    x: FloatArray
    y: FloatArray
    limits: tuple[float, ...] = ()


def figure_svg(recipe: Recipe, words: Catalogue) -> str:
    """Draw the cam of a recipe.

    Zones are grey and hatched, limits dashed, so the figure reads in black and white. Text stays text.
    """
    length = recipe.job.si["cut"]["length"]
    parts = [
        (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH:g} {_HEIGHT:g}" role="img" '
            'font-family="DejaVu Sans, Noto Sans SC, Arial, sans-serif" font-size="11">'
        ),
        (
            '<defs><pattern id="cam-hatch" width="6" height="6" patternUnits="userSpaceOnUse">'
            '<path d="M-1 1L1 -1M0 6L6 0M5 7L7 5" stroke="#555" stroke-width="0.8"/></pattern></defs>'
        ),
    ]
    top = _TOP
    for panel in _panels(recipe, words):
        parts += _drawn(panel, recipe, length, top)
        top += _PANEL + _GAP
    parts += _master_axis(length, top - _GAP, words)
    parts += _legend(words)
    return "\n".join([*parts, "</svg>"])


def _panels(recipe: Recipe, words: Catalogue) -> Iterable[Panel]:
    profile = CamProfile(np.array(recipe.profile.breaks), np.array(recipe.profile.coefficients))
    v, limits, unit = recipe.job.si["cut"]["line_speed"], recipe.job.si["limits"], recipe.slave_unit
    per_master = "1" if unit == "m" else "rad/m"
    over_time = f"{unit}/s^2"
    x, y = _curve(profile, 0)
    yield Panel(words("figure.position", unit=unit_shown(unit, words.units)), x, y * converted(1.0, unit, words.units))
    x, y = _curve(profile, 1)
    yield Panel(words("figure.ratio", unit=unit_shown(per_master, words.units)), x, y, (limits["speed"] / v,))
    x, y = _curve(profile, 2)
    peak = limits["acceleration"]
    scale = converted(1.0, over_time, words.units)
    limit = scale * peak
    yield Panel(
        words("figure.acceleration", unit=unit_shown(over_time, words.units)), x, scale * y * v * v, (-limit, limit)
    )


def _curve(profile: CamProfile, order: int) -> tuple[FloatArray, FloatArray]:
    """Points of a derivative over the master (m), every piece from its first to its last break."""
    each = max(2, min(48, _MOST_POINTS // profile.pieces))
    part = np.linspace(0.0, 1.0, each + 1)
    x = profile.breaks[:-1, None] + np.diff(profile.breaks)[:, None] * part
    x[:, -1] = profile.breaks[1:]
    value = profile(x, order)
    value[:, -1] = profile(x[:, -1], order, side="left")
    return x.ravel(), value.ravel()


def _drawn(panel: Panel, recipe: Recipe, length: float, top: float) -> list[str]:
    """Draw one panel: zones, grid, limits, curve, frame."""
    low, high = float(panel.y.min()), float(panel.y.max())
    reach = max(abs(low), abs(high), 1e-12)
    if panel.limits and reach < _NOTHING * max(panel.limits):
        reach = max(panel.limits)  # rounding is not worth a scale of its own
    limits = [limit for limit in panel.limits if abs(limit) <= _FAR * reach]
    low, high = min([low, *limits]), max([high, *limits])
    if high - low < 1e-9 * reach:
        low, high = low - reach, high + reach
    ticks = _ticks(low, high, 5)
    low, high = low - _ROOM * (high - low), high + _ROOM * (high - low)

    def down(value: float) -> float:
        return top + _PANEL * (high - value) / (high - low)

    bottom = top + _PANEL
    parts = []
    for zones, fill in ((recipe.zones.sync, "#e4e4e4"), (recipe.zones.shear, "url(#cam-hatch)")):
        for start, end in zones:
            left, right = (_across(x, length) for x in (start, end))
            if start == end:  # a shear zone of no length
                parts.append(f'<path d="M{left:.2f} {top:.2f}v{_PANEL:g}" stroke="#000" stroke-width="1.5" {_DOTTED}/>')
                continue
            parts.append(
                f'<rect x="{left:.2f}" y="{top:.2f}" width="{right - left:.2f}" height="{_PANEL:g}" fill="{fill}"/>'
            )
    for tick in ticks:
        at = down(tick)
        stroke = "#999" if tick == 0.0 else "#ccc"
        parts.append(f'<path d="M{_LEFT:g} {at:.2f}H{_WIDTH - _RIGHT:g}" stroke="{stroke}" stroke-width="0.5"/>')
        parts.append(f'<text x="{_LEFT - 5:g}" y="{at + 3.8:.2f}" text-anchor="end">{number(tick, 6)}</text>')
    parts += [
        f'<path d="M{_LEFT:g} {down(limit):.2f}H{_WIDTH - _RIGHT:g}" stroke="#000" stroke-width="1" stroke-dasharray="5 3"/>'
        for limit in limits
    ]
    line = " ".join(
        f"{_across(float(x), length):.2f},{down(float(y)):.2f}" for x, y in zip(panel.x, panel.y, strict=True)
    )
    parts.append(f'<polyline points="{line}" fill="none" stroke="#000" stroke-width="1.6" stroke-linejoin="round"/>')
    parts.append(
        f'<rect x="{_LEFT:g}" y="{top:.2f}" width="{_WIDTH - _LEFT - _RIGHT:g}" height="{_PANEL:g}" fill="none" stroke="#000" '
        'stroke-width="0.7"/>'
    )
    middle = 0.5 * (top + bottom)
    quantity, _, unit = panel.label.rpartition(" ")
    for text, across in ((quantity, 13), (unit, 28)):
        parts.append(
            f'<text transform="translate({across} {middle:.2f}) rotate(-90)" text-anchor="middle">{escape(text)}</text>'
        )
    return parts


def _across(master: float, length: float) -> float:
    return _LEFT + (_WIDTH - _LEFT - _RIGHT) * master / length


def _master_axis(length: float, bottom: float, words: Catalogue) -> list[str]:
    parts = []
    shown_length = converted(length, "m", words.units)
    for tick in _ticks(0.0, shown_length, 8):
        at = _across(tick, shown_length)
        parts.append(f'<path d="M{at:.2f} {bottom:.2f}v4" stroke="#000" stroke-width="0.7"/>')
        parts.append(f'<text x="{at:.2f}" y="{bottom + 15:.2f}" text-anchor="middle">{number(tick, 6)}</text>')
    middle = _across(0.5 * length, length)
    return [
        *parts,
        f'<text x="{middle:.2f}" y="{bottom + 30:.2f}" text-anchor="middle">{escape(words("figure.master"))}</text>',
    ]


def _legend(words: Catalogue) -> list[str]:
    y = _HEIGHT - 16
    frame = 'stroke="#000" stroke-width="0.5"'
    marks = (
        ("figure.sync", f'<rect x="0" y="0" width="22" height="11" fill="#e4e4e4" {frame}/>'),
        ("figure.shear", f'<rect x="0" y="0" width="22" height="11" fill="url(#cam-hatch)" {frame}/>'),
        ("figure.limit", '<path d="M0 5.5H22" stroke="#000" stroke-width="1" stroke-dasharray="5 3"/>'),
    )
    return [
        f'<g transform="translate({_LEFT + 170 * i:g} {y:g})">{mark}<text x="28" y="9.5">{escape(words(key))}</text></g>'
        for i, (key, mark) in enumerate(marks)
    ]


def _ticks(low: float, high: float, most: int) -> list[float]:
    """Round values between two, at most so many and one more, in steps of 1, 2 or 5 times a power of ten."""
    rough = (high - low) / most
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(factor * power for factor in (1, 2, 5, 10) if factor * power >= rough * (1 - 1e-9))
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [i * step for i in range(first, last + 1)]


def figure_caption(recipe: Recipe, words: Catalogue) -> str:
    """Say what the figure shows."""
    return words("figure.caption", line_speed=shown(recipe.job.si["cut"]["line_speed"], "m/s", units=words.units))
