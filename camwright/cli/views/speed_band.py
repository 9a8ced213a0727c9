"""The line speeds at which a cam is released."""

from __future__ import annotations

from camwright.cli.views.parts import View, new_text
from camwright.house.numbers import Units, converted, inside, number, unit_shown, with_unit
from camwright.studies.speed_band import NO_END, SpeedBand


def band_view(band: SpeedBand, units: Units) -> View:
    """Say at which line speeds a cam passes every check, and what ends them."""
    return new_text(band_words(band, units))


def band_words(band: SpeedBand, units: Units) -> str:
    """Word a band: its parts, each end with the check that ends it."""
    if not band.parts:
        return f"no line speed passes every check: {', '.join(band.forbids)}"
    parts = [_part(*ends, *binds, units) for ends, binds in zip(band.parts, band.binds, strict=True)]
    return f"passes every check at line speeds {', and '.join(parts)}"


def _part(low: float, high: float, below: str, above: str, units: Units) -> str:
    """Word a part of a band; one speed where both ends are the same as they are written."""
    if inside(converted(low, "m/s", units), up=True) >= inside(converted(high, "m/s", units), up=False):
        return f"of {with_unit(high, 'm/s', units=units)} alone ({below} below, {above} above)"
    first = "from 0" if below == NO_END else f"from {end_words(low, units, up=True)} ({below})"
    return f"{first} to {end_words(high, units)} {unit_shown('m/s', units)} ({above})"


def end_words(speed: float, units: Units, *, up: bool = False) -> str:
    """Write the end of a range of line speeds without its unit, rounded to the inside."""
    return number(inside(converted(speed, "m/s", units), up=up))
