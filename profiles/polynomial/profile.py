"""`CamProfile`: the slave over the master as pieces of polynomials."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from camwright.profiles.errors import InputError
from camwright.profiles.polynomial import rows
from camwright.profiles.polynomial.roots import roots_between

FloatArray = NDArray[np.float64]
Side = Literal["left", "right"]
Outside = Literal["raise", "repeat"]

_ROUNDING = 1e-9
"""Part of a profile's length that its ends may be off by rounding: a thousand times what scaling and joining leave behind."""


@dataclass(frozen=True)
class Extremum:
    """The least or greatest value of a derivative of a profile, and the master position where it is first reached."""

    value: float
    at: float


@dataclass(frozen=True, eq=False)
class CamProfile:
    """Slave position ``y`` over master position ``x``, piece by piece a polynomial.

    On piece ``i``, between ``breaks[i]`` and ``breaks[i + 1]``::

        y(x) = sum_p coefficients[i, p] * (x - breaks[i])**p

    Parameters
    ----------
    breaks
        Shape ``(n + 1,)``, strictly increasing master positions (m).
    coefficients
        Shape ``(n, degree + 1)``, ascending powers; entry ``p`` in slave unit per m**p.

    Notes
    -----
    At a break the value belongs to the piece on the stated side: ``side="right"`` (the piece that begins there) unless told
    otherwise; the last break always belongs to the last piece, the first always to the first. Outside its domain a profile
    raises, or repeats if asked: one period on, the slave has advanced by `advance`.

    Examples
    --------
    >>> ramp = CamProfile.from_arrays([0.0, 0.5, 1.0], [[0.0, 1.0], [0.5, 2.0]])
    >>> float(ramp(0.75)), float(ramp(0.5, order=1)), float(ramp(0.5, order=1, side="left"))
    (1.0, 2.0, 1.0)
    >>> float(ramp(1.25, outside="repeat"))
    1.75
    """

    breaks: FloatArray
    coefficients: FloatArray
    # what was found already: a profile never changes, and its peaks are asked for again and again
    _derivatives: dict[int, FloatArray] = field(default_factory=dict, init=False, repr=False)
    _peaks: dict[int, tuple[Extremum, Extremum]] = field(default_factory=dict, init=False, repr=False)

    def __post_init__(self) -> None:
        if self.breaks.ndim != 1 or self.coefficients.ndim != 2 or len(self.breaks) != len(self.coefficients) + 1:
            raise InputError(
                f"a profile of n pieces needs n + 1 breaks and n rows of coefficients; "
                f"got breaks {self.breaks.shape} and coefficients {self.coefficients.shape}"
            )
        if len(self.coefficients) == 0 or self.coefficients.shape[1] == 0:
            raise InputError("a profile needs at least one piece with at least one coefficient")
        # breaks that rise from a finite number to another have no other between
        rises = self.breaks[1:] > self.breaks[:-1]
        rising = bool(rises.all()) and math.isfinite(self.breaks[0]) and math.isfinite(self.breaks[-1])
        if not (np.isfinite(self.coefficients).all() and (rising or np.isfinite(self.breaks).all())):
            raise InputError("a profile's breaks and coefficients must be finite numbers; one is NaN or infinite")
        if not rising:
            i = int(rises.argmin())
            raise InputError(
                f"a profile's breaks must increase: break {i + 1} ({float(self.breaks[i + 1])!r} m) does not lie beyond "
                f"break {i} ({float(self.breaks[i])!r} m)"
            )
        self.breaks.setflags(write=False)
        self.coefficients.setflags(write=False)

    @classmethod
    def from_arrays(cls, breaks: ArrayLike, coefficients: Sequence[ArrayLike] | ArrayLike) -> CamProfile:
        """Make a profile from anything array-like; rows of coefficients may differ in length."""
        listed = [np.atleast_1d(np.asarray(row, dtype=np.float64)) for row in coefficients]  # type: ignore[union-attr]
        width = max((len(row) for row in listed), default=0)
        table = np.zeros((len(listed), width))
        for target, row in zip(table, listed, strict=True):
            target[: len(row)] = row
        return cls(np.array(breaks, dtype=np.float64), table)

    # -- what it is -------------------------------------------------------------------------------------------------

    @property
    def start(self) -> float:
        """First master position (m)."""
        return float(self.breaks[0])

    @property
    def end(self) -> float:
        """Last master position (m)."""
        return float(self.breaks[-1])

    @property
    def length(self) -> float:
        """Length of the domain on the master (m)."""
        return self.end - self.start

    @property
    def advance(self) -> float:
        """Slave travel from the start to the end of the domain (slave unit)."""
        width, end = float(self.breaks[-1] - self.breaks[-2]), 0.0
        for coefficient in reversed(self.coefficients[-1].tolist()):  # Horner
            end = end * width + coefficient
        return end - float(self.coefficients[0, 0])

    @property
    def mean_ratio(self) -> float:
        """Advance of the slave over that of the master: slope of the straight line that the repeated profile follows."""
        return self.advance / self.length

    @property
    def degree(self) -> int:
        """Largest power carried."""
        return int(self.coefficients.shape[1]) - 1

    @property
    def pieces(self) -> int:
        """Number of polynomial pieces."""
        return len(self.coefficients)

    # -- evaluation -------------------------------------------------------------------------------------------------

    def __call__(
        self, x: ArrayLike | float, order: int = 0, *, side: Side = "right", outside: Outside = "raise"
    ) -> FloatArray:
        """Evaluate the profile or a derivative over the master.

        Parameters
        ----------
        x
            Master positions (m), any shape.
        order
            Order of the derivative with respect to the master; 0 is the position, 1 the ratio, 2 the ratio slope.
        side
            Which piece answers at a break.
        outside
            ``"raise"`` refuses positions outside the domain; ``"repeat"`` repeats the cycle with the slave's advance.

        Returns
        -------
        ndarray
            Same shape as ``x``, in slave unit per m**order.

        Raises
        ------
        InputError
            A position lies outside the domain and ``outside="raise"``.
        """
        start, end = self.start, self.end
        if isinstance(x, float) and outside == "raise" and start <= x <= end:
            return self._at_one(float(x), order, side)
        position = np.asarray(x, dtype=np.float64)
        turns: FloatArray | None = None
        if outside == "repeat":
            turns = np.floor((position - start) / (end - start))
            if side == "left":  # a seam belongs to the cycle that ends there
                turns = turns - ((position - start) == turns * (end - start))
            position = np.minimum(np.maximum(position - turns * (end - start), start), end)
        elif position.size and (position.min() < start or position.max() > end):
            worst = position.min() if position.min() < start else position.max()
            raise InputError(f"master position {worst!r} m lies outside the profile, {start!r} to {end!r} m")
        value = self._valued(position, order, side)
        if turns is not None and order == 0:
            value = value + turns * self.advance
        return np.asarray(value, dtype=np.float64)

    def _at_one(self, x: float, order: int, side: Side) -> FloatArray:
        """Evaluate a derivative at one place inside the domain: single numbers are quicker than arrays of one."""
        table = self._derived(order)
        piece = int(self.breaks[1:-1].searchsorted(x, side=side))
        local, value = x - float(self.breaks[piece]), 0.0
        for coefficient in reversed(table[piece].tolist()):  # Horner
            value = value * local + coefficient
        return np.array(value)

    def _valued(self, position: FloatArray, order: int, side: Side) -> FloatArray:
        """Evaluate a derivative inside the domain."""
        table = self._derived(order)
        if len(table) == 1:  # one piece for all positions
            local = position - self.breaks[0]
            *others, most = table[0].tolist()
            value = np.full(local.shape, most + 0.0)
            for number in reversed(others):  # Horner
                value *= local
                value += number
        else:
            index = self.breaks[1:-1].searchsorted(position, side=side)
            local = position - self.breaks.take(index, mode="clip")
            value = np.zeros(local.shape)
            for coefficient in table.T[::-1]:  # Horner
                value *= local
                value += coefficient.take(index, mode="clip")  # faster than the default; all are in range
        return value

    def _derived(self, order: int) -> FloatArray:
        """Coefficients of the derivative of the given order, shape ``(n, max(1, degree + 1 - order))``."""
        if order < 0:
            raise InputError(f"the order of a derivative must not be negative; got {order}")
        if order == 0:
            return self.coefficients
        known = self._derivatives.get(order)
        if known is None:
            known = self._derivatives[order] = rows.differentiated(self._derived(order - 1))
        return known

    def on_pieces(self, piece: NDArray[np.intp], local: FloatArray, order: int = 0) -> FloatArray:
        """Evaluate by the pieces that are named, whatever lies at a break.

        Parameters
        ----------
        piece
            Numbers of the pieces, of a shape that broadcasts to that of ``local``.
        local
            Distances on the master from the start of that piece (m), any shape.
        order
            Order of the derivative.
        """
        return rows.values(self._derived(order), piece, local)

    def holding(self, x: FloatArray) -> NDArray[np.intp]:
        """Name the piece that holds a master position by its number, at a break the right one; shape of ``x``."""
        return np.asarray(self.breaks[1:-1].searchsorted(x, side="right"))

    def within_degree(self, degree: int) -> NDArray[np.bool_]:
        """Say of each piece whether it is a polynomial of at most this degree; shape ``(pieces,)``."""
        return np.asarray(~self.coefficients[:, degree + 1 :].any(axis=1))

    def jumps(self, order: int = 0, *, seam: bool = True) -> FloatArray:
        """Jump of a derivative (right minus left) at every inner break, and last at the seam of the repeated cycle.

        At the seam the position (``order=0``) is compared with its own advance, so it never jumps: use `advance` and the
        machine's pitch to judge closure of the position.
        """
        table = self._derived(order)
        ends = rows.at_ends(table, self.breaks[1:] - self.breaks[:-1])
        value = np.empty(self.pieces)
        np.subtract(table[1:, 0], ends[:-1], out=value[:-1])
        value[-1] = 0.0 if order == 0 else table[0, 0] - ends[-1]
        return value if seam else value[:-1]

    def extrema(self, order: int = 0) -> tuple[Extremum, Extremum]:
        """Least and greatest value of a derivative, exactly: from the roots of the next derivative on each piece.

        Returns
        -------
        (least, greatest)
            Value (slave unit per m**order) and master position (m); one-sided limits at breaks count.
        """
        if order in self._peaks:
            return self._peaks[order]
        where, values = self._extreme(order)

        def extremum(index: int) -> Extremum:
            return Extremum(float(values.flat[index]), float(self.breaks[index // where.shape[1]] + where.flat[index]))

        self._peaks[order] = extremum(int(values.argmin())), extremum(int(values.argmax()))
        return self._peaks[order]

    def peak(self, order: int = 0) -> float:
        """Greatest magnitude of a derivative, as `extrema` has it."""
        return max(abs(extremum.value) for extremum in self.extrema(order))

    def ranges(self, order: int = 0) -> tuple[FloatArray, FloatArray]:
        """Least and greatest value of a derivative on each piece, as exact as `extrema`; two arrays of shape ``(pieces,)``."""
        _, values = self._extreme(order)
        return np.asarray(values.min(axis=1)), np.asarray(values.max(axis=1))

    def _extreme(self, order: int) -> tuple[FloatArray, FloatArray]:
        """Give where a derivative may be extreme on each piece, from the piece's start, and its values there."""
        a, b = np.zeros(self.pieces), np.diff(self.breaks)
        where = np.column_stack([a, roots_between(self._derived(order + 1), a, b), b])
        where = np.where(np.isnan(where), a[:, None], where)
        return where, self.on_pieces(np.arange(self.pieces)[:, None], where, order)

    def roots(self, order: int = 0) -> FloatArray:
        """Master positions inside the pieces where a derivative is zero, ascending.

        A piece on which it is zero throughout has none.
        """
        table, width = self._derived(order), np.diff(self.breaks)
        size = np.abs(table * width[:, None] ** np.arange(table.shape[1]))
        may = np.nonzero(size[:, 0] <= size[:, 1:].sum(axis=1))[0]  # elsewhere the constant term outweighs the rest
        if not len(may):
            return np.zeros(0)
        found = self.breaks[may, None] + roots_between(table[may], np.zeros(len(may)), width[may])
        return rows.ascending(found[~np.isnan(found)])

    def mean_square(self, order: int, start: float | None = None, end: float | None = None) -> float:
        """Mean of the squared derivative over a part of the domain, exactly (Gauss-Legendre of sufficient degree)."""
        first, last = self.start if start is None else start, self.end if end is None else end
        part = self if (first == self.start and last == self.end) else self.restrict(first, last)
        table = part._derived(order)
        node, weight = _gauss(table.shape[1])
        width = part.breaks[1:] - part.breaks[:-1]
        local = 0.5 * width[:, None] * (node + 1.0)
        value = part.on_pieces(np.arange(part.pieces)[:, None], local, order)
        return float(np.sum(0.5 * width[:, None] * weight * value**2) / part.length)

    # -- making new profiles from old -------------------------------------------------------------------------------

    def shift(self, master: float = 0.0, slave: float = 0.0) -> CamProfile:
        """Move the profile along the master (m) and the slave (slave unit)."""
        table = self.coefficients.copy()
        table[:, 0] += slave
        return CamProfile(self.breaks + master, table)

    def scale(self, master: float = 1.0, slave: float = 1.0) -> CamProfile:
        """Stretch the profile about the origin: ``y_new(master * x) = slave * y(x)``, ``master`` > 0."""
        if not master > 0:
            raise InputError(f"the master of a profile can be scaled by a positive factor only; got {master!r}")
        powers = np.arange(self.degree + 1)
        return CamProfile(self.breaks * master, self.coefficients * (slave / master**powers))

    def add_line(self, slope: float) -> CamProfile:
        """Add the straight line that passes through zero at the start of the domain with the given slope."""
        line = np.column_stack([slope * (self.breaks[:-1] - self.start), np.full(self.pieces, slope)])
        return CamProfile(self.breaks.copy(), rows.added(self.coefficients, line))

    def derivative(self, order: int = 1) -> CamProfile:
        """Make the derivative over the master a profile of its own."""
        return CamProfile(self.breaks.copy(), self._derived(order).copy())

    def integral(self) -> CamProfile:
        """Antiderivative over the master, continuous, zero at the start."""
        return CamProfile(self.breaks.copy(), rows.integrated(self.coefficients, np.diff(self.breaks)))

    def plus(self, other: CamProfile) -> CamProfile:
        """Sum of two profiles over the same breaks."""
        self._require_breaks(other)
        return CamProfile(self.breaks.copy(), rows.added(self.coefficients, other.coefficients))

    def times(self, other: CamProfile) -> CamProfile:
        """Product of two profiles over the same breaks."""
        self._require_breaks(other)
        return CamProfile(self.breaks.copy(), rows.multiplied(self.coefficients, other.coefficients))

    def _require_breaks(self, other: CamProfile) -> None:
        """Refuse a profile whose pieces are not those of this one."""
        if not np.array_equal(self.breaks, other.breaks):
            raise InputError(
                "profiles can be added or multiplied piece by piece only: they have other breaks; recut one"
            )

    def over(self, start: float, end: float) -> CamProfile:
        """Put both ends exactly where they are but for rounding; the pieces stay what they are, and those of no length fall away.

        Raises
        ------
        InputError
            An end is away from there by more than 1e-9 of the length: this would be another motion.
        """
        if max(abs(self.start - start), abs(self.end - end)) > _ROUNDING * (end - start):
            raise InputError(
                f"a profile from {self.start!r} m to {self.end!r} m cannot be put over {start!r} m to {end!r} m: "
                "its ends must be there but for rounding; scale it first"
            )
        inner = self.breaks[1:-1]
        first, last = int((inner <= start).sum()), self.pieces - int((inner >= end).sum())
        return CamProfile(
            np.concatenate([[start], inner[first : last - 1], [end]]), self.coefficients[first:last].copy()
        )

    def restrict(self, start: float, end: float) -> CamProfile:
        """Cut out the part between two master positions inside the domain."""
        if not (self.start <= start < end <= self.end):
            raise InputError(
                f"the part {start!r} to {end!r} m does not lie inside the profile, {self.start!r} to {self.end!r} m"
            )
        inner = self.breaks[(self.breaks > start) & (self.breaks < end)]
        breaks = np.concatenate([[start], inner, [end]])
        index = np.clip(np.searchsorted(self.breaks, breaks[:-1], side="right") - 1, 0, self.pieces - 1)
        offset = breaks[:-1] - self.breaks[index]
        return CamProfile(breaks, rows.recentred(self.coefficients[index], offset))

    def recut(self, breaks: FloatArray) -> CamProfile:
        """Cut the profile at other breaks: each new piece belongs to the old piece that holds its middle."""
        piece = self.holding(0.5 * (breaks[:-1] + breaks[1:]))
        return CamProfile(breaks.copy(), rows.recentred(self.coefficients[piece], breaks[:-1] - self.breaks[piece]))

    def split(self, places: FloatArray) -> CamProfile:
        """Give the profile further breaks, none nearer to another than 1e-12 of its length."""
        least = 1e-12 * self.length
        if not len(places):
            return self
        away = np.abs(self.breaks[:, None] - places).min(axis=0)
        apart = [x for x, off in zip(places.tolist(), away.tolist(), strict=True) if off > least]
        kept = [x for i, x in enumerate(apart) if i == 0 or x - apart[i - 1] > least]
        return self.recut(rows.ascending(np.concatenate([self.breaks, kept]))) if kept else self

    def repeat(self, cycles: int) -> CamProfile:
        """Repeat the cycle, the slave advancing by `advance` each time."""
        if cycles < 1:
            raise InputError(f"a profile can be repeated once or more often; got {cycles} cycles")
        return join(*(self.shift(n * self.length, n * self.advance) for n in range(cycles)))

    def roll(self, start: float) -> CamProfile:
        """Begin the repeated cycle at another master position of the domain; the new profile starts at (0, 0)."""
        if not (self.start <= start < self.end):
            raise InputError(
                f"the new start {start!r} m does not lie inside the profile, {self.start!r} to {self.end!r} m"
            )
        nearest = float(self.breaks[np.abs(self.breaks - start).argmin()])
        if (
            abs(nearest - start) <= 1e-12 * self.length
        ):  # a break but for rounding: no sliver of a piece is left between
            start = nearest if nearest < self.end else self.start
        tail = self.restrict(start, self.end)
        if start > self.start:
            head = self.restrict(self.start, start).shift(self.length, self.advance)
            tail = join(tail, head)
        return tail.shift(-start, -float(self(start)))

    # -- storage ----------------------------------------------------------------------------------------------------

    def to_dict(self) -> dict[str, list[float] | list[list[float]]]:
        """Plain lists for JSON; Python writes floats so that they are read back bit by bit."""
        return {"breaks": self.breaks.tolist(), "coefficients": self.coefficients.tolist()}

    @classmethod
    def from_dict(cls, data: object) -> CamProfile:
        """Read what `to_dict` wrote; anything else is refused."""
        if not isinstance(data, dict) or set(data) != {"breaks", "coefficients"}:
            raise InputError("a profile is an object with the keys 'breaks' and 'coefficients', and no others")
        try:
            breaks = np.array(data["breaks"], dtype=np.float64)
            coefficients = np.array(data["coefficients"], dtype=np.float64)
        except (TypeError, ValueError) as error:
            raise InputError(f"a profile's breaks and coefficients must be lists of numbers: {error}") from error
        return cls(breaks, coefficients)


def steps(breaks: FloatArray, levels: FloatArray) -> CamProfile:
    """Constant on every piece: ``levels``, shape ``(pieces,)``."""
    return CamProfile(breaks.copy(), levels[:, None].copy())


def join(*parts: CamProfile) -> CamProfile:
    """Join profiles where one ends and the next begins.

    Raises
    ------
    InputError
        The master positions of two neighbours do not meet to 1e-12 of the whole length. The slave may jump: `CamProfile.jumps`
        tells by how much.
    """
    if not parts:
        raise InputError("there is nothing to join: no profile was given")
    length = parts[-1].end - parts[0].start
    breaks = [parts[0].breaks]
    for left, right in itertools.pairwise(parts):
        if abs(left.end - right.start) > 1e-12 * abs(length):
            raise InputError(f"profiles do not meet: one ends at {left.end!r} m, the next begins at {right.start!r} m")
        breaks.append(right.breaks[1:])
    table = np.zeros((sum(part.pieces for part in parts), max(part.degree for part in parts) + 1))
    row = 0
    for part in parts:
        table[row : row + part.pieces, : part.degree + 1] = part.coefficients
        row += part.pieces
    return CamProfile(np.concatenate(breaks), table)


@cache
def _gauss(count: int) -> tuple[FloatArray, FloatArray]:
    """Nodes and weights of a Gauss-Legendre rule; kept, for each is an eigenvalue problem."""
    node, weight = np.polynomial.legendre.leggauss(count)
    return node, weight
