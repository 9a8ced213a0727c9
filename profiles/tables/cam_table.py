"""`CamTable`: a cam as knots, between the profile and the files of the targets."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.machines.machine import SlaveUnit
from camwright.profiles.polynomial.profile import CamProfile, FloatArray

PieceLaw = Literal["line", "cubic", "quintic", "spline"]
"""What lies between two knots.

``line``: the chord. ``cubic``: the polynomial of degree 3 through position and ratio of both knots. ``quintic``: that of
degree 5 through position, ratio and ratio slope of both knots. ``spline``: part of a cubic spline through the positions;
what closes it at the ends is the target's affair.
"""

Kind = Literal["open", "closed", "appending"]

LARGEST_VALUE = 1e12
"""Largest magnitude that a table may hold."""


@dataclass(frozen=True)
class Unit:
    """A unit of length (or angle) of a table.

    Parameters
    ----------
    symbol
        How it is written: ``mm``, ``deg``, ``count``.
    size
        Metres per unit, positive; radians per unit where the machine's slave is counted in radians.
    si
        Which of both.
    """

    symbol: str
    size: float
    si: SlaveUnit = "m"

    @property
    def counted(self) -> bool:
        """Whether it is the size of a count, ``9.25um`` or ``1/36000rev``, not a unit by name."""
        return self.symbol[:1].isdigit()

    def __post_init__(self) -> None:
        if not (np.isfinite(self.size) and self.size > 0):
            raise InputError(f"the size of the unit {self.symbol!r} must be a positive number; got {self.size!r}")


@dataclass(frozen=True)
class TableUnits:
    """The units of a table's two axes."""

    master: Unit
    slave: Unit

    def to_si(self, profile: CamProfile) -> CamProfile:
        """Turn a profile in these units into one in SI units."""
        return profile.scale(master=self.master.size, slave=self.slave.size)


@dataclass(frozen=True, eq=False)
class CamTable:
    """Knots of one cycle, both ends stored, in the table's own units.

    Parameters
    ----------
    x
        Shape ``(n,)``, strictly increasing master positions.
    y
        Shape ``(n,)``, slave positions.
    ratio
        Shape ``(n,)``, ``dy/dx`` at the knots; NaN where the table holds none.
    ratio_slope
        Shape ``(n,)``, ``d²y/dx²`` at the knots; NaN where the table holds none.
    laws
        The law of each of the ``n - 1`` pieces.
    units
        Units of both axes, or ``None`` if the file does not say.
    periodic
        Whether the cycle repeats.
    notes
        What a reader found worth telling.
    words
        What the file calls its units where only the job says how long they are: a degree of the master is part of the
        cycle. ``None`` for one that it does not name.
    travel_known
        Whether the last point is the file's: where a layout leaves it out, for the table closes by itself, the slave
        stands at the first point's position there and the travel must be found.
    listed
        Whether the master positions only count the file's rows, the last of which may end the cycle or be a step before its end.

    Raises
    ------
    InputError
        Fewer than two knots, lengths that differ, a value that is not finite or beyond `LARGEST_VALUE`, or master
        positions that do not increase.
    """

    x: FloatArray
    y: FloatArray
    ratio: FloatArray
    ratio_slope: FloatArray
    laws: tuple[PieceLaw, ...]
    units: TableUnits | None = None
    periodic: bool = True
    notes: tuple[str, ...] = ()
    words: tuple[str | None, str | None] = (None, None)
    travel_known: bool = True
    listed: bool = False

    def __post_init__(self) -> None:
        n = len(self.x)
        if n < 2:
            raise InputError(f"a cam table needs at least 2 points; there are {n}")
        shapes = {array.shape for array in (self.x, self.y, self.ratio, self.ratio_slope)}
        if shapes != {(n,)} or len(self.laws) != n - 1:
            raise InputError(f"a cam table of {n} points needs {n} values in each column and {n - 1} laws")
        for name, array in (("master position", self.x), ("slave position", self.y)):
            if not (np.abs(array) <= LARGEST_VALUE).all():  # NaN fails the comparison
                i = int(np.argmax(~(np.abs(array) <= LARGEST_VALUE)))
                raise InputError(
                    f"the {name} of point {i + 1} is {array[i]!r}; it must be a number up to {LARGEST_VALUE:g}"
                )
        for name, array in (("ratio", self.ratio), ("ratio slope", self.ratio_slope)):
            if np.isinf(array).any():
                raise InputError(f"the {name} of point {int(np.argmax(np.isinf(array))) + 1} is infinite")
        steps = np.diff(self.x)
        if (steps <= 0).any():
            i = int(np.argmax(steps <= 0))
            raise InputError(
                f"master positions must increase strictly: point {i + 2} ({float(self.x[i + 1])!r}) does not lie "
                f"beyond point {i + 1} ({float(self.x[i])!r})"
            )
        for array in (self.x, self.y, self.ratio, self.ratio_slope):
            array.setflags(write=False)

    @property
    def points(self) -> int:
        """Number of knots."""
        return len(self.x)

    @property
    def period(self) -> float:
        """Master period in the table's unit."""
        return float(self.x[-1] - self.x[0])

    @property
    def advance(self) -> float:
        """Slave travel per cycle in the table's unit."""
        return float(self.y[-1] - self.y[0])

    @property
    def kind(self) -> Kind:
        """``open``, or for a repeated cycle ``closed`` (no advance) or ``appending``."""
        if not self.periodic:
            return "open"
        return "closed" if abs(self.advance) <= 1e-9 * float(np.ptp(self.y) or 1.0) else "appending"

    def closing_by(self, travel: float) -> CamTable:
        """State the slave's travel per cycle of a table that leaves it out."""
        return replace(self, y=np.append(self.y[:-1], self.y[0] + travel), travel_known=True)

    def with_units(self, units: TableUnits) -> CamTable:
        """State the units of a table."""
        return replace(self, units=units)


def make_table(
    x: object,
    y: object,
    ratio: object = None,
    ratio_slope: object = None,
    *,
    law: PieceLaw | tuple[PieceLaw, ...] = "quintic",
    units: TableUnits | None = None,
    periodic: bool = True,
    notes: tuple[str, ...] = (),
    travel_known: bool = True,
) -> CamTable:
    """Make a `CamTable` from anything array-like; columns not given hold NaN, one law stands for all pieces."""
    master = np.array(x, dtype=np.float64)
    columns = [
        np.full(len(master), np.nan) if c is None else np.array(c, dtype=np.float64) for c in (ratio, ratio_slope)
    ]
    laws = (law,) * max(0, len(master) - 1) if isinstance(law, str) else law
    slave = np.array(y, dtype=np.float64)
    return CamTable(master, slave, columns[0], columns[1], laws, units, periodic, notes, travel_known=travel_known)


def sample_profile(profile: CamProfile, x: FloatArray, units: TableUnits, law: PieceLaw = "quintic") -> CamTable:
    """Read a profile off at master positions and write it as a table.

    Parameters
    ----------
    profile
        One cycle, in SI units.
    x
        Shape ``(n,)``, master positions (m) from the start to the end of the cycle.
    law
        Law of the pieces. With ``"quintic"`` a piece on which the profile is straight gets the law ``"line"``.

    Notes
    -----
    A knot holds one ratio and one ratio slope. Where the profile's own values jump, the mean of both sides is taken.
    """
    master, slave = units.master.size, units.slave.size
    on_break = profile.breaks[np.searchsorted(profile.breaks, x).clip(max=profile.pieces)] == x
    columns = []
    for order in range(3):
        value = profile(x, order)
        value[on_break] = 0.5 * (value[on_break] + profile(x[on_break], order, side="left"))
        columns.append(value * (master**order / slave))
    laws: tuple[PieceLaw, ...] = (law,) * (len(x) - 1)
    if law == "quintic":
        straight = profile.within_degree(1)
        piece = np.searchsorted(profile.breaks, 0.5 * (x[1:] + x[:-1]), side="right") - 1
        whole = np.searchsorted(profile.breaks, x[1:], side="left") - 1 == piece  # the span holds no break inside
        laws = tuple("line" if flat else "quintic" for flat in straight[piece] & whole)
    return CamTable(x / master, columns[0], columns[1], columns[2], laws, units)
