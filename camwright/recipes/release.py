"""For which line speeds a recipe releases its cam: the status line, what to heed beside it, and the mark of other speeds."""

from __future__ import annotations

from collections.abc import Iterable
from functools import reduce

from camwright.house.numbers import converted, inside, shown, with_unit
from camwright.recipes.blocks import Block, text_block
from camwright.recipes.catalogue import Catalogue
from camwright.recipes.model import Recipe, SpeedPart

_SAME = 1e-3
"""Part by which the end of a range may differ from the job's line speed that no one need be told."""

_RAMP = 1.0
"""Acceleration of the line for which the scrap of starting up is told (m/s²); it goes inversely with it."""

_MARK = "✗"


def status_text(recipe: Recipe, words: Catalogue) -> str:
    """Say whether the cam is released, and from what to what line speed."""
    return words("released", speeds=released_speeds(recipe, words)) if recipe.released else words("not_released")


def released_speeds(recipe: Recipe, words: Catalogue) -> str:
    """Write the line speeds of a recipe (m/min), every end rounded to its inside."""
    parts = [_part(part, words) for part in recipe.speed_band]
    if not parts:
        return words("nothing")
    return reduce(lambda first, second: words("speeds.two", first=first, second=second), parts)


def _part(part: SpeedPart, words: Catalogue) -> str:
    """Write the ends of a part of a band, one where both are the same as they are written."""
    low, high = (
        inside(converted(end, "m/s", words.units), up=up) for end, up in ((part.low, True), (part.high, False))
    )
    if low >= high:
        return words("speeds.alone", speed=shown(part.high, "m/s", units=words.units))
    return words("speeds.part", low=words.number(low), high=words.number(high))


def boxed(recipe: Recipe) -> bool:
    """Whether the release is not simply from standstill to the job's line speed."""
    own, band = recipe.job.si["cut"]["line_speed"], recipe.speed_band
    if not recipe.released or not band:
        return False
    return len(band) > 1 or band[0].low > 0.0 or abs(band[0].high - own) > _SAME * own


def warnings(recipe: Recipe, words: Catalogue) -> list[str]:
    """List what a fitter must know: what failed; or what ends the speeds, whether the job's own is among them, and the scrap."""
    own, band = recipe.job.si["cut"]["line_speed"], recipe.speed_band
    if not recipe.released:
        failed = ", ".join(_failed(recipe, words))
        return [words("release.failed", checks=failed)] if failed else []
    if not boxed(recipe):
        return []
    found = []
    if not released_at(recipe, own):
        found.append(words("release.not_at_job", line_speed=shown(own, "m/s", units=words.units)))
    for part in band:
        if part.low > 0.0:
            found.append(
                words(
                    "release.below",
                    line_speed=_rounded(part.low, words, up=True),
                    check=_check(part.low_binding, words),
                )
            )
        if abs(part.high - own) > _SAME * own:
            found.append(
                words(
                    "release.above",
                    line_speed=_rounded(part.high, words, up=False),
                    check=_check(part.high_binding, words),
                )
            )
    found += [
        words(
            "release.scrap",
            low=_rounded(low, words, up=False),
            high=_rounded(high, words, up=True),
            length=words.number(converted((high**2 - low**2) / (2.0 * _RAMP), "m", words.units), 4),
            ramp=with_unit(_RAMP, "m/s^2", 4, words.units),
        )
        for low, high in _gaps(recipe)
    ]
    return found


def _failed(recipe: Recipe, words: Catalogue) -> list[str]:
    """Name the checks that failed, those of a table with its target."""
    own = [_check(check.name, words) for check in recipe.checks if not check.passed]
    return own + [
        f"{_check(check.name, words)} ({table.target})"
        for table in recipe.tables
        for check in table.checks
        if not check.passed
    ]


def _gaps(recipe: Recipe) -> list[tuple[float, float]]:
    """List the ranges outside the release that starting and stopping passes (m/s)."""
    ends = [0.0, *(part.high for part in recipe.speed_band)]
    return [(end, part.low) for end, part in zip(ends, recipe.speed_band, strict=False) if end < part.low]


def _check(name: str, words: Catalogue) -> str:
    return words.named("check", name)


def released_at(recipe: Recipe, line_speed: float) -> bool:
    """Whether the cam is released at a line speed (m/s)."""
    return any(part.low <= line_speed <= part.high for part in recipe.speed_band)


def outside_note(line_speeds: Iterable[float], recipe: Recipe, words: Catalogue) -> list[Block]:
    """Say what the mark means, where one of these line speeds (m/s) has it."""
    if all(released_at(recipe, line_speed) for line_speed in line_speeds):
        return []
    return [text_block(words("speeds.outside" if recipe.released else "speeds.failing"), strong=True)]


def marked(text: str, recipe: Recipe, line_speed: float) -> str:
    """Mark what belongs to a line speed (m/s) outside the release."""
    return text if released_at(recipe, line_speed) else f"{_MARK} {text}"


def _rounded(speed: float, words: Catalogue, *, up: bool) -> str:
    """Write a line speed with five digits, up or down."""
    return words.number(inside(converted(speed, "m/s", words.units), up=up))
