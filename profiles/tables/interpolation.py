"""What controllers compute between the points of a table, as profiles."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.tables.cam_table import CamTable
from camwright.profiles.tables.number_formats import NumberFormat, rounded
from camwright.profiles.tables.splines import cyclic_spline


def in_format(table: CamTable, number_format: NumberFormat) -> CamTable:
    """Store a table as a controller does: every value rounded to the number format."""
    return replace(
        table,
        x=rounded(table.x, number_format),
        y=rounded(table.y, number_format),
        ratio=rounded(table.ratio, number_format),
        ratio_slope=rounded(table.ratio_slope, number_format),
    )


def in_float32(table: CamTable) -> CamTable:
    """Store a table as `in_format`; refused where two points fall on one master position."""
    x = rounded(table.x, "float32")
    if not np.all(np.diff(x) > 0):
        i = int(np.argmax(np.diff(x) <= 0))
        raise InputError(f"points {i + 1} and {i + 2} have the same master position in float32; use fewer points")
    return in_format(table, "float32")


def quintics(table: CamTable) -> CamProfile:
    """Lines, cubics through position and ratio, and quintics through position, ratio and ratio slope of the knots, in the table's units.

    With ``u`` from 0 to 1 over a piece of width ``h`` and the remainders ``P, V, A`` of position, ratio, ratio slope at
    its end after the start's own parabola, the powers 3 to 5 of ``u`` are ``10P - 4Vh + Ah²/2``,
    ``-15P + 7Vh - Ah²`` and ``6P - 3Vh + Ah²/2``. Those of a cubic, ``P`` and ``V`` after the start's tangent, are
    ``3P - Vh`` and ``Vh - 2P``.

    Raises
    ------
    InputError
        A cubic or quintic piece whose knots hold no ratio, or a quintic's no ratio slope.
    """
    quintic, cubic = (np.array([law == name for law in table.laws]) for name in ("quintic", "cubic"))
    tangent = np.isfinite(table.ratio)
    held = tangent & np.isfinite(table.ratio_slope)
    missing = (quintic & ~(held[:-1] & held[1:])) | (cubic & ~(tangent[:-1] & tangent[1:]))
    if missing.any():
        i = int(np.argmax(missing))
        what = (
            "quintic, but a knot of it has no ratio or ratio slope"
            if quintic[i]
            else "cubic, but a knot of it has no ratio"
        )
        raise InputError(f"piece {i + 1} is a {what}")
    h = np.diff(table.x)
    y0, y1 = table.y[:-1], table.y[1:]
    coefficients = np.zeros((len(h), 6))
    coefficients[:, 0] = y0
    coefficients[~quintic, 1] = ((y1 - y0) / h)[~quintic]
    if cubic.any():
        v0, v1 = table.ratio[:-1] * h, table.ratio[1:] * h
        p, v = y1 - y0 - v0, v1 - v0
        for k, value in enumerate([v0, 3 * p - v, v - 2 * p], start=1):
            coefficients[cubic, k] = (value / h**k)[cubic]
    if quintic.any():
        v0, v1 = table.ratio[:-1] * h, table.ratio[1:] * h
        a0, a1 = table.ratio_slope[:-1] * h**2, table.ratio_slope[1:] * h**2
        p, v, a = y1 - y0 - v0 - 0.5 * a0, v1 - v0 - a0, a1 - a0
        powers = [v0, 0.5 * a0, 10 * p - 4 * v + 0.5 * a, -15 * p + 7 * v - a, 6 * p - 3 * v + 0.5 * a]
        for k, value in enumerate(powers, start=1):
            coefficients[quintic, k] = (value / h**k)[quintic]
    return CamProfile(table.x.copy(), coefficients)


def chords(table: CamTable) -> CamProfile:
    """Straight lines between the points."""
    slope = np.diff(table.y) / np.diff(table.x)
    return CamProfile(table.x.copy(), np.column_stack([table.y[:-1], slope]))


def by_law(table: CamTable) -> CamProfile:
    """Do what the laws say: a cyclic spline, chords of a table without ratios, or lines and quintics."""
    if "spline" in table.laws:
        return cyclic_spline(table.x, table.y)
    if all(law == "line" for law in table.laws) and np.isnan(table.ratio).all():
        return chords(table)
    return quintics(table)
