"""The command of a servo-aware design: a cubic spline over the part of the cycle that is free, linear in its unknowns."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from camwright.design.servo_aware.splines import EvenSplines, LaidSamples
from camwright.profiles.polynomial.profile import CamProfile, FloatArray, join
from camwright.profiles.task import Task

Command = Literal["in_sync", "shaped"]
"""What a design may choose: the return alone, or the whole cycle."""

INTERVALS: dict[Command, int] = {"in_sync": 48, "shaped": 64}
"""Intervals of the free part, if it has no structure of its own."""

ROBUST_SHARE = 1.5
"""Times as many for several servos."""

# What a number of samples is rounded up to, for servos that forget nearly alike; and most samples at places that are kept for them.
_SHARED, _MOST_KEPT = 128, 2**16
# Arcs of a structure shorter than this share of an interval get no node of their own.
_SHORTEST = 0.1
_DEGREE = 3
_BINOMIAL = ((1,), (1, 1), (1, 2, 1), (1, 3, 3, 1))


@dataclass(frozen=True, eq=False)
class CommandBasis:
    """The command over one cycle from the start of the return, repeated for ever with the pitch.

    In the free part, from 0 to the last node, it is a cubic spline with the coefficients ``matrix @ z + constant`` (slave unit); in the
    rest it is the machine's sync zone.

    Parameters
    ----------
    length
        Cut length (m).
    pitch
        Slave travel per cycle (slave unit).
    knots
        Knots of the spline (m): its nodes, and three more before and behind them.
    matrix, constant
        Shapes ``(N + 3, n)`` and ``(N + 3,)`` for ``N`` intervals.
    sync
        Slave over master in the part that is not free; ``None`` if all is.
    step
        Distance of the knots (m) where it is the same everywhere and many servos ask, so that sums are made on a lattice of places; else 0.
    """

    length: float
    pitch: float
    knots: FloatArray
    matrix: FloatArray
    constant: FloatArray
    sync: CamProfile | None
    step: float = 0.0

    @property
    def nodes(self) -> FloatArray:
        """Nodes of the spline, shape ``(N + 1,)``."""
        return self.knots[_DEGREE:-_DEGREE]

    @cached_property
    def differences(self) -> tuple[tuple[FloatArray, FloatArray], ...]:
        """Coefficients of the spline and of its first three derivatives over the master, each as ``(matrix, constant)``.

        A spline lies within the hull of its coefficients; those of the second derivative are its values at the nodes, those of the third
        its values on the intervals.
        """
        found = [(self.matrix, self.constant)]
        for order in range(1, 4):
            degree = _DEGREE + 1 - order
            knots = self.knots[order : len(self.knots) - order]
            widths = (knots[degree:] - knots[:-degree]) / degree
            matrix, constant = found[-1]
            found.append((np.diff(matrix, axis=0) / widths[:, None], np.diff(constant) / widths))
        return tuple(found)

    @cached_property
    def ratios(self) -> tuple[FloatArray, FloatArray]:
        """Ratio at the nodes, as ``(matrix, constant)`` of shapes ``(N + 1, n)`` and ``(N + 1,)``."""
        count = len(self.nodes) - 1
        index = np.arange(count)[:, None] + np.arange(_DEGREE + 1)
        first = self.pieces[:, 1, :]
        matrix, constant = (
            np.einsum("kc,kcn->kn", first, self.matrix[index]),
            (first * self.constant[index]).sum(axis=1),
        )
        (slope, slope_constant), width = self.differences[2], float(self.nodes[-1] - self.nodes[-2])
        last = matrix[-1] + 0.5 * width * (slope[-2] + slope[-1])
        last_constant = constant[-1] + 0.5 * width * (slope_constant[-2] + slope_constant[-1])
        return np.vstack([matrix, last]), np.append(constant, last_constant)

    @cached_property
    def pieces(self) -> FloatArray:
        """Powers of the four splines of each interval, ascending: shape ``(N, 4 powers, 4 splines)``."""
        return spline_pieces(self.knots)

    def rows(self, places: FloatArray, weights: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Weighted sums of the command at given places.

        Parameters
        ----------
        places
            Master positions (m), any cycle, shape ``(rows, samples)``.
        weights
            Their weights, shape ``(samples,)`` or one row for each.

        Returns
        -------
        (matrix, constant)
            Shapes ``(rows, n)`` and ``(rows,)``: the sums are ``matrix @ z + constant``.
        """
        turns = np.floor(places / self.length)
        local = places - turns * self.length
        constant = self.pitch * (turns * weights).sum(axis=1)
        free = local < self.nodes[-1] if self.sync is not None else np.ones(local.shape, dtype=bool)
        inside = np.minimum(local, self.nodes[-1])
        index = np.clip(np.searchsorted(self.nodes, inside, side="right") - 1, 0, len(self.nodes) - 2)
        part = inside - self.nodes[index]
        powers = np.stack([np.ones_like(part), part, part * part, part**3], axis=-1)
        values = np.einsum("rsp,rspc->rsc", powers * (weights * free)[..., None], self.pieces[index])
        if self.sync is not None:
            known = self.sync(np.clip(local, self.sync.start, self.sync.end))
            constant += np.einsum("rs,rs->r", np.where(free, 0.0, weights), known)
        count = len(self.constant)
        flat = (np.arange(len(places))[:, None, None] * count + index[..., None] + np.arange(4)).ravel()
        found = np.bincount(flat, values.ravel(), minlength=len(places) * count)
        table = np.asarray(found.reshape(len(places), count), dtype=np.float64)
        return self._of_unknowns(table), constant + table @ self.constant

    def sums(self, places: FloatArray, weights: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Several weighted sums of the command at the same places.

        Of every interval the moments of the weights are taken first, then the splines' powers: less to gather than spline by spline.

        Parameters
        ----------
        places
            Master positions (m), any cycle, shape ``(rows, samples)``.
        weights
            Shape ``(samples, sums)``, the same for all rows.

        Returns
        -------
        (matrix, constant)
            Shapes ``(rows, sums, n)`` and ``(rows, sums)``: the sums are ``matrix @ z + constant``.
        """
        rows, kinds = len(places), weights.shape[1]
        turns = np.floor(places / self.length)
        local = places - turns * self.length
        constant = self.pitch * (turns @ weights)
        intervals = len(self.nodes) - 1
        inside = np.minimum(local, self.nodes[-1])
        index = np.clip(np.searchsorted(self.nodes, inside, side="right") - 1, 0, intervals - 1)
        part = inside - self.nodes[index]
        flat = (index + np.arange(rows)[:, None] * intervals).ravel()
        free = np.ones(local.shape)
        if self.sync is not None:
            free = np.asarray(local < self.nodes[-1], dtype=np.float64)
            known = (1.0 - free) * self.sync(np.clip(local, self.sync.start, self.sync.end))
            constant = constant + known @ weights
        moments = np.empty((kinds, _DEGREE + 1, rows, intervals))
        power = free
        for degree in range(_DEGREE + 1):
            for kind in range(kinds):
                found = np.bincount(flat, (power * weights[:, kind]).ravel(), minlength=rows * intervals)
                moments[kind, degree] = found.reshape(rows, intervals)
            power = power * part
        table = np.zeros((rows, kinds, len(self.constant)))
        for spline in range(_DEGREE + 1):
            table[:, :, spline : spline + intervals] += np.einsum("kpri,ip->rki", moments, self.pieces[:, :, spline])
        return self._of_unknowns(table), constant + table @ self.constant

    def lattice(
        self, places: FloatArray, regular: int, delay: float, sample: float, weights: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Several weighted sums at places most of which lie on a lattice that parts `step` evenly: as `sums`, in a fraction of the time.

        Parameters
        ----------
        places
            Master positions (m), shape ``(rows,)``.
        regular
            How many of them, the first ones, are the lattice, ascending; it may be none.
        delay, sample
            How far behind a place its newest sample lies, and the distance of samples (m).
        weights
            Shape ``(samples, sums)``, newest sample first.
        """
        laid = self._laid(places, regular, delay, sample, len(weights))
        return laid.sums.of(weights), laid.known[:, : len(weights)] @ weights

    def looked(
        self,
        places: FloatArray,
        regular: int,
        delay: float,
        sample: float,
        weights: FloatArray,
        unknowns: FloatArray,
    ) -> FloatArray:
        """Give the sums of `lattice` of one command, shape ``(rows, sums)``: for a servo of many that is looked at once."""
        laid = self._laid(places, regular, delay, sample, len(weights))
        return np.asarray(laid.values(unknowns)[:, : len(weights)] @ weights)

    @cached_property
    def _lattices(self) -> dict[tuple[bytes, float, float], LaidSamples]:
        """Samples that were laid out: servos differ in their weights alone, and in how many they have."""
        return {}

    @cached_property
    def _widest(self) -> dict[tuple[bytes, float, float], LaidSamples]:
        """The last ones that were too many to be kept longer: servos that share them are looked at one after another."""
        return {}

    def _laid(self, places: FloatArray, regular: int, delay: float, sample: float, count: int) -> LaidSamples:
        """Lay out samples behind places (m), at least so many, and give the command there that the unknowns are added to."""
        key = places.tobytes(), delay, sample
        laid = self._widest.get(key) or self._lattices.get(key)
        if laid is None or laid.known.shape[1] < count:
            samples = delay + sample * np.arange(_SHARED * -(-count // _SHARED), dtype=np.float64)
            first = 0 if self.sync is None else _DEGREE
            splines = EvenSplines(self.step, float(self.knots[first]), self.matrix.shape[1], self.length)
            past = places[:, None] - samples
            # what a shaped command is added to is a straight line
            known = past * (self.pitch / self.length) if self.sync is None else self._even(past, outside="repeat")
            laid = LaidSamples(places, regular, samples, splines, known)
            if known.size > _MOST_KEPT:
                self._widest.clear()
            (self._lattices if known.size <= _MOST_KEPT else self._widest)[key] = laid
        return laid

    @cached_property
    def _even(self) -> CamProfile:
        """The command that the unknowns are added to."""
        return self.profile(np.zeros(self.matrix.shape[1]))

    def _of_unknowns(self, table: FloatArray) -> FloatArray:
        """Turn rows over the coefficients into rows over the unknowns: ``table @ matrix``, whose columns hold a single 1 each, or two."""
        count = self.matrix.shape[1]
        if count == len(self.constant) - 2 * _DEGREE:  # the states at both ends are given
            return np.ascontiguousarray(table[..., _DEGREE:-_DEGREE])
        found = table[..., :count].copy()
        found[..., :_DEGREE] += table[..., count:]  # the coefficients behind the end are those of the beginning
        return found

    def profile(self, unknowns: FloatArray) -> CamProfile:
        """Return the command as a profile over ``[0, length]``, its slave counted as in the basis."""
        coefficients = self.matrix @ unknowns + self.constant
        windows = np.lib.stride_tricks.sliding_window_view(coefficients, 4)
        powers = np.einsum("npc,nc->np", self.pieces, windows)
        free = CamProfile.from_arrays(self.nodes, powers)
        return free if self.sync is None else join(free, self.sync).over(0.0, self.length)


def spline_pieces(knots: FloatArray) -> FloatArray:
    """Cubic B-splines as powers of the distance from the start of each interval (de Boor's recursion on polynomials).

    Parameters
    ----------
    knots
        Ascending, shape ``(N + 7,)``.

    Returns
    -------
    ndarray
        Shape ``(N, 4 powers, 4 splines)``.
    """
    count = len(knots) - 2 * _DEGREE - 1
    first = knots[_DEGREE : _DEGREE + count]
    table = np.zeros((count, 4, 4))
    table[:, 0, 3] = 1.0  # the spline of degree 0 of the interval itself, the last of the four
    for degree in range(1, _DEGREE + 1):
        raised = np.zeros_like(table)
        for c in range(_DEGREE - degree, _DEGREE + 1):
            start = np.arange(count) + c  # knot where this spline begins
            if c > _DEGREE - degree:
                width = knots[start + degree] - knots[start]
                offset = first - knots[start]
                raised[:, :, c] += (table[:, :, c] * offset[:, None] + _times(table[:, :, c])) / width[:, None]
            if c < _DEGREE:
                width = knots[start + degree + 1] - knots[start + 1]
                offset = knots[start + degree + 1] - first
                raised[:, :, c] += (table[:, :, c + 1] * offset[:, None] - _times(table[:, :, c + 1])) / width[:, None]
        table = raised
    return table


def _times(powers: FloatArray) -> FloatArray:
    """Multiply polynomials by their variable."""
    return np.concatenate([np.zeros((len(powers), 1)), powers[:, :-1]], axis=1)


def command_basis(
    task: Task, command: Command, structure: CamProfile | None = None, *, robust: bool = False
) -> CommandBasis:
    """Basis of the commands that a servo-aware design may choose from.

    Slave zero is the machine at the end of its sync zone, master zero the start of the return. The unknowns are what is added to an even
    motion, so that they and their derivatives are small where the motion is gentle.

    Parameters
    ----------
    structure
        A return whose breaks become nodes, so that it is among the commands; of use with ``"in_sync"``.
    robust
        Whether the command is for several servos, and needs more freedom.
    """
    machine, cut = task.machine, task.cut
    count = round(INTERVALS[command] * (ROBUST_SHARE if robust else 1.0))
    if command == "shaped":
        step = cut.length / count
        knots = np.asarray(step * np.arange(-_DEGREE, count + _DEGREE + 1), dtype=np.float64)
        knots[_DEGREE + count] = cut.length
        places = np.arange(count + 3)
        matrix = np.zeros((count + 3, count))
        matrix[places, places % count] = 1.0
        even = np.asarray(
            machine.pitch * (places - 1) / count, dtype=np.float64
        )  # the coefficients of a motion of even speed
        return CommandBasis(cut.length, machine.pitch, knots, matrix, even, None, step if robust else 0.0)
    sync = task.sync
    nodes = _nodes(cut.return_zone, count, structure)
    placed = sync.shift(nodes[-1] - sync.start, task.height - float(sync(sync.start)))
    start = np.array([0.0, float(sync(sync.end, 1)), float(sync(sync.end, 2, side="left")) / 2])
    end = np.array([float(placed(placed.start)), float(sync(sync.start, 1)), float(sync(sync.start, 2)) / 2])
    step = cut.return_zone / count if robust and structure is None else 0.0
    return CommandBasis(cut.length, machine.pitch, *clamped(nodes, start, end), placed, step)


def clamped(nodes: FloatArray, start: FloatArray, end: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Cubic splines that begin and end in given states: their knots, and their coefficients as ``matrix @ z + constant``.

    Parameters
    ----------
    nodes
        Where the pieces meet (m), shape ``(N + 1,)``.
    start, end
        Position, ratio and half the ratio slope at both ends.

    Returns
    -------
    (knots, matrix, constant)
        As in `CommandBasis`, with ``N - 3`` unknowns.
    """
    count = len(nodes) - 1
    before = nodes[0] - (nodes[1] - nodes[0]) * np.arange(_DEGREE, 0, -1)
    behind = nodes[-1] + (nodes[-1] - nodes[-2]) * np.arange(1, _DEGREE + 1)
    spread = np.asarray(np.concatenate([before, nodes, behind]), dtype=np.float64)
    pieces = spline_pieces(spread)
    last = np.zeros((4, 4))  # the last interval's splines about its end
    width = nodes[-1] - nodes[-2]
    for power in range(4):
        for k in range(power + 1):
            last[k] += pieces[-1, power] * (_BINOMIAL[power][k] * width ** (power - k))
    constant = np.zeros(count + 3)
    constant[:3] = np.linalg.solve(pieces[0, :3, :3], start)  # the fourth spline of the first interval is flat there
    constant[count:] = np.linalg.solve(last[:3, 1:], end)
    averages = (
        spread[1:-3] + spread[2:-2] + spread[3:-1]
    ) / 3  # where a straight line takes the values of its coefficients
    constant[3:count] = np.interp(averages[3:count], averages[[2, count]], constant[[2, count]])
    matrix = np.zeros((count + 3, count - 3))
    matrix[3:count] = np.eye(count - 3)
    return spread, matrix, constant


def _nodes(width: float, count: int, structure: CamProfile | None) -> FloatArray:
    """Divide a return into about equal intervals, the breaks of a structure among them."""
    step = width / count
    if structure is None:
        return np.append(step * np.arange(count), width)
    nodes = [0.0]
    for place in structure.breaks[1:]:
        arc = float(place) - nodes[-1]
        if arc < _SHORTEST * step:
            continue
        parts = max(1, round(arc / step))
        nodes += [nodes[-1] + arc * (part + 1) / parts for part in range(parts)]
    nodes[-1] = width
    return np.array(nodes)
