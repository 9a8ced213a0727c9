"""Springback: how far the mould must turn for a workpiece angle, as tables measured on one rule (S4)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from camwright.profiles.bender.curve import Curve
from camwright.profiles.bender.plan import BendPlan
from camwright.profiles.errors import InputError
from camwright.profiles.notice import Notice, Number
from camwright.profiles.polynomial.profile import FloatArray

Interpolation = Literal["linear", "cubic"]

PAPER_STEP = math.radians(14.4)
"""Workpiece angle of the bends that the paper's radius table was measured with: a circle in 25 sides (S4)."""

_MOST_FAULTS = 20


@dataclass(frozen=True, eq=False)
class Springback:
    """Mould angles that leave wanted workpiece angles after the rule has sprung back.

    Corners follow the angle table. The bends of an arc follow the radius table if there is one: a bend by the table's
    step angle needs the mould angle of its radius, any other bend in proportion. A table holds between its rows; the
    last row of the radius table holds for all greater radii.

    Parameters
    ----------
    name
        The table's name in messages.
    workpiece, mould
        Shape ``(n,)``: workpiece angles, increasing, and their mould angles (rad).
    radius, radius_mould
        Shape ``(m,)``: radii, increasing (m), and the mould angles of a bend by ``step`` (rad); no rows, no radius
        table.
    step
        Workpiece angle that the radius table was measured with (rad).
    interpolation
        ``"linear"`` as in the paper, or ``"cubic"``: a monotone cubic through the rows of the angle table.
    """

    name: str
    workpiece: FloatArray
    mould: FloatArray
    radius: FloatArray
    radius_mould: FloatArray
    step: float = PAPER_STEP
    interpolation: Interpolation = "linear"

    def __post_init__(self) -> None:
        faults = [
            *self._order_faults("angle table", "workpiece angle", np.degrees(self.workpiece), "°"),
            *self._order_faults("radius table", "radius", 1e3 * self.radius, "mm"),
        ]
        if len(self.workpiece) < 2:
            faults.append(f"{self.name}: the angle table has {len(self.workpiece)} rows; it needs 2 or more")
        if len(self.workpiece) != len(self.mould) or len(self.radius) != len(self.radius_mould):
            faults.append(f"{self.name}: each row of a table needs two values")
        elif not faults:
            falls = np.flatnonzero(np.diff(self.mould) <= 0)
            faults += [
                f"{self.name}: angle table, row {i + 2}: the mould angle {math.degrees(self.mould[i + 1]):.3f}° "
                "does not exceed "
                f"the {math.degrees(self.mould[i]):.3f}° of row {i + 1}; a mould that turns further must bend further: "
                "measure both rows again"
                for i in falls
            ]
        if faults:
            raise InputError(*faults[:_MOST_FAULTS])

    def _order_faults(self, table: str, quantity: str, values: FloatArray, unit: str) -> list[str]:
        if not np.isfinite(values).all() or (values < 0).any():
            return [f"{self.name}: {table}: a {quantity} is negative, NaN or infinite"]
        return [
            f"{self.name}: {table}, row {i + 2}: the {quantity} {values[i + 1]:.3f} {unit} does not exceed the "
            f"{values[i]:.3f} "
            f"{unit} of row {i + 1}; sort the rows and keep each {quantity} once"
            for i in np.flatnonzero(np.diff(values) <= 0)
        ]

    @cached_property
    def _curve(self) -> Curve:
        if self.interpolation == "linear":
            return Curve.linear(self.workpiece, self.mould)
        return Curve.monotone_cubic(self.workpiece, self.mould)

    def warnings(self) -> tuple[str, ...]:
        """Rows that cannot be true: the mould turned less far than the workpiece, or arcs that do not run evenly."""
        low = [
            Notice(
                "{table}: angle table, row {row}: mould angle {mould}° is less than the workpiece angle {workpiece}°; springback "
                "opens a bend, so this row under-bends: measure it again",
                table=self.name,
                row=str(i + 1),
                mould=Number(math.degrees(b), ".3f"),
                workpiece=Number(math.degrees(a), ".3f"),
            )
            for i, (a, b) in enumerate(zip(self.workpiece, self.mould, strict=True))
            if b < a - 1e-9
        ]
        low += [
            Notice(
                "{table}: radius table, row {row}: mould angle {mould}° is less than the step of {step}°; springback opens a "
                "bend, so this row under-bends: measure it again",
                table=self.name,
                row=str(i + 1),
                mould=Number(math.degrees(b), ".3f"),
                step=Number(math.degrees(self.step), ".3f"),
            )
            for i, b in enumerate(self.radius_mould)
            if b < self.step - 1e-9
        ]
        slopes = np.sign(np.diff(self.radius_mould))
        low += [
            Notice(
                "{table}: radius table, row {row}: the mould angle {mould}° turns back on the trend of the rows before it; "
                "springback changes one way with the radius: measure it again",
                table=self.name,
                row=str(i + 2),
                mould=Number(math.degrees(self.radius_mould[i + 1]), ".3f"),
            )
            for i in 1 + np.flatnonzero(slopes[1:] * slopes[:-1] < 0)
        ]
        return tuple(low)

    def factor(self, radius: FloatArray) -> FloatArray:
        """Mould angle over workpiece angle of an arc's bends, by its radius (m)."""
        return np.asarray(np.interp(radius, self.radius, self.radius_mould) / self.step, dtype=np.float64)

    def by_radius(self, radius: FloatArray) -> FloatArray:
        """Factor of each bend by the radius table; NaN where the angle table counts: corners, or no radius table."""
        if len(self.radius) == 0:
            return np.full(np.shape(radius), np.nan)
        return np.where(np.isinf(radius), np.nan, self.factor(radius))

    def mould_angle(self, turn: float, factor: float = math.nan) -> float:
        """Mould angle (rad) for a workpiece angle (rad), both signed alike; the factor is that of `by_radius`.

        Beyond the table's rows the nearest interval is carried on; `faults` tells whether a plan stays inside.
        """
        size = abs(turn)
        return math.copysign(
            size * factor if factor == factor else self._curve.value(size), turn
        )  # NaN differs from itself

    def workpiece_angle(self, mould: float, factor: float = math.nan) -> float:
        """Workpiece angle (rad) that a mould angle (rad) leaves: `mould_angle` inverted."""
        size = abs(mould)
        return math.copysign(size / factor if factor == factor else self._curve.inverse(size), mould)

    def faults(self, plan: BendPlan) -> tuple[str, ...]:
        """Bends that the tables do not cover, each named with its place."""
        factor = self.by_radius(plan.radii)
        turns = np.abs(plan.turns)
        found = []
        allowance = 1e-9
        by_angle = np.isnan(factor) & (
            (turns < self.workpiece[0] - allowance) | (turns > self.workpiece[-1] + allowance)
        )
        for i in np.flatnonzero(by_angle)[:_MOST_FAULTS]:
            x, y = 1e3 * plan.vertices[i + 1]
            row = 1 if turns[i] < self.workpiece[0] else len(self.workpiece)
            found.append(
                f"{plan.outline.name}: bend {i + 1} at ({x:.3f}, {y:.3f}) mm: workpiece angle "
                f"{math.degrees(turns[i]):.3f}° lies outside "
                f"the springback table {self.name}, {math.degrees(self.workpiece[0]):.3f}° to "
                f"{math.degrees(self.workpiece[-1]):.3f}° (row {row}); measure a row for it"
            )
        if len(self.radius):
            small = ~np.isnan(factor) & (plan.radii < self.radius[0] * (1 - 1e-9))
            segments, first = np.unique(plan.segments[small], return_index=True)
            for segment, i in zip(segments[:_MOST_FAULTS], np.flatnonzero(small)[first], strict=False):
                found.append(
                    f"{plan.outline.name}: segment {segment + 1}: radius {1e3 * plan.radii[i]:.3f} mm lies below "
                    "the springback table "
                    f"{self.name}, which begins at {1e3 * self.radius[0]:.3f} mm (row 1 of the radius table); "
                    "measure a row for it"
                )
        return tuple(found)
