"""The axis of a servo-aware design: rows of its response, and its response on the grid of all sampling phases."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from camwright.design.servo_aware.servo_weights import (
    greatest_gains,
    memory,
    servo_weights,
    state_weights,
)
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.servo import Servo, sample_plant
from camwright.profiles.task import Task

# Sampling phases, and points between two samples, on which a design is judged: those of the validation.
PHASES = 16
SUBSTEPS = 8
_STRIDE = PHASES // SUBSTEPS
_NEWTON, _NEWTON_ENDS = 12, 1e-11
# Most samples of the past that are gathered at a time, and what a number of samples is rounded up to.
_MOST_VALUES, _SHARED = 2**18, 32
# Least steps of the grid that are looked at, or passed over, together.
_STRETCH = 2**13


Sums = Callable[[FloatArray, FloatArray], tuple[FloatArray, FloatArray]]
"""What makes of places and weights, shapes ``(rows, samples)``, rows over unknowns, as ``(matrix, constant)``."""


@dataclass(frozen=True, eq=False)
class Axis:
    """A machine's axis with one servo: where it must be, and where a command takes it.

    Master positions count from the start of the return zone, slave positions from the machine's position there.

    Parameters
    ----------
    task
        The machine, its sync zone placed, and the cut.
    servo
        The servo, as it does at the cut's line speed.
    share
        Share of the cut's line speed for which that servo stands (`camwright.profiles.servo.Servo.at_speed`).
    """

    task: Task
    servo: Servo
    share: float = 1.0

    @property
    def sample(self) -> float:
        """Master travel in a sampling period (m)."""
        return self.servo.sample_time * self.task.cut.line_speed

    @property
    def shear_zone(self) -> tuple[float, float]:
        """Shear zone (m)."""
        start = self.task.cut.return_zone + self.task.cut.shear_zone_at
        return start, min(start + self.task.cut.shear_zone, self.task.cut.length)

    def ideal(self, places: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Slave, ratio, and slave coordinate of the machine in sync, at places in the sync zone."""
        sync = self.task.sync
        inside = np.clip(places - self.task.cut.return_zone, sync.start, sync.end)
        travel = sync(inside)
        return (
            travel + (self.task.height - float(sync(sync.start))),
            sync(inside, 1),
            self.task.slave_at_sync_start + travel,
        )

    def band(self, places: FloatArray, tolerance: float) -> tuple[FloatArray, FloatArray]:
        """Least and greatest deviation of the slave that keep the tool within a tolerance (m) of the material."""
        coordinate = self.ideal(places)[2]
        edges = []
        for sign in (-1.0, 1.0):
            slope = np.asarray(self.task.machine.tool_ratio(coordinate)) + np.zeros_like(coordinate)
            deviation = sign * tolerance / slope
            for _ in range(
                _NEWTON
            ):  # the tool's map is monotonic in the sync zone and nearly straight over a tolerance
                off = (
                    self.task.machine.tool(coordinate + deviation)
                    - self.task.machine.tool(coordinate)
                    - sign * tolerance
                )
                if np.abs(off).max(initial=0.0) <= _NEWTON_ENDS * tolerance:
                    break
                deviation = deviation - off / self.task.machine.tool_ratio(coordinate + deviation)
            edges.append(deviation)
        return np.minimum(*edges), np.maximum(*edges)

    def rows(self, sums: Sums, places: FloatArray, times: FloatArray, order: int = 0) -> tuple[FloatArray, FloatArray]:
        """Axis, or its ratio (1) or ratio slope (2), as rows over the unknowns of a command.

        Parameters
        ----------
        sums
            Weighted sums of the command over its unknowns, as `CommandBasis.rows`.
        places
            Master positions (m).
        times
            Time (s) since the sampling instant before, for each place; below the sample time.
        order
            Derivative over the master.
        """
        known, index = np.unique(times, return_inverse=True)
        weights = np.array([self._weights(float(time), order) for time in known])
        samples = self.servo.sample_time * np.arange(weights.shape[1])
        step = max(1, _MOST_VALUES // len(samples))
        found = []
        for part in (slice(start, start + step) for start in range(0, len(places), step)):
            past = (times[part] + self.servo.delay)[:, None] + samples
            found.append(sums(places[part, None] - self.task.cut.line_speed * past, weights[index[part]]))
        return np.concatenate([matrix for matrix, _ in found]), np.concatenate([constant for _, constant in found])

    def on_grid(self, profile: CamProfile, first: int, count: int, order: int = 0) -> FloatArray:
        """Response on the common grid, at every phase.

        Parameters
        ----------
        profile
            One cycle of the command, from the start of the return.
        first, count
            First step of the grid and number of steps (a 16th of a sample each).
        order
            Derivative over the master.

        Returns
        -------
        ndarray
            Shape ``(SUBSTEPS, count)``: by the time since the sampling instant before, in 8ths of a sample, and by place.
        """
        ahead = (SUBSTEPS - 1) * _STRIDE
        states, reference = _grid_states(self, profile, first - ahead, count + ahead)
        times = np.arange(SUBSTEPS, dtype=np.float64) * (self.servo.sample_time / SUBSTEPS)
        turned, pushed = self._after_sample(times, order)
        values = states @ turned.T + reference[:, None] * pushed
        # the sampling instants lie the more before the places the longer it is since
        return np.stack([values[ahead - sub * _STRIDE :, sub][:count] for sub in range(SUBSTEPS)])

    def keeps_within(self, profile: CamProfile, order: int, low: float, high: float) -> bool:
        """Whether the command's own range already tells that the axis' ratio (1) or ratio slope (2) stays between two limits."""
        least, greatest = (extremum.value for extremum in profile.extrema(order))
        return bool(self._within(order, np.array([least]), np.array([greatest]), low, high)[0])

    def loud(self, profile: CamProfile, order: int, low: float, high: float) -> list[tuple[int, int]]:
        """Stretches of the common grid where the command's range, as far back as the servo remembers, does not tell so.

        Returns
        -------
        list of (first, count)
            First step of each stretch and its steps; a line that creeps is quiet but for next to nothing of its cycle.
        """
        length, step = profile.length, self.sample / PHASES
        # a difference of the order, and the part of a sample since the last one
        reach = (memory(self.servo.loop) + order + 1) * self.sample
        firsts = np.arange(0, math.ceil(length / step), max(_STRETCH, 4 * math.ceil(reach / step)))
        ends = np.append(firsts[1:], math.ceil(length / step))
        newest = self.task.cut.line_speed * self.servo.delay
        oldest, latest = firsts * step - newest - reach, ends * step - newest
        before, behind = math.floor(float(oldest[0]) / length), math.ceil(float(latest[-1]) / length)
        breaks = np.append((np.arange(before, behind)[:, None] * length + profile.breaks[:-1]).ravel(), behind * length)
        pieces = np.column_stack([breaks.searchsorted(oldest, "right") - 1, breaks.searchsorted(latest)])
        least, greatest = (np.append(np.tile(each, behind - before), each[0]) for each in profile.ranges(order))
        lows, highs = (
            np.minimum.reduceat(least, pieces.ravel())[::2],
            np.maximum.reduceat(greatest, pieces.ravel())[::2],
        )
        turns = np.flatnonzero(np.diff(~self._within(order, lows, highs, low, high), prepend=False, append=False))
        return [(int(firsts[k]), int(ends[n - 1] - firsts[k])) for k, n in turns.reshape(-1, 2).tolist()]

    def _within(
        self, order: int, least: FloatArray, greatest: FloatArray, low: float, high: float
    ) -> NDArray[np.bool_]:
        """Tell of ranges of the command whether the axis stays between two limits."""
        up, down = greatest_gains(self.servo.loop, order, SUBSTEPS)
        return np.asarray((up * greatest - down * least <= high) & (up * least - down * greatest >= low))

    def zone_errors(self, profile: CamProfile) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Sync error of the tool in the shear zone at every phase, the ends of the zone included.

        Parameters
        ----------
        profile
            One cycle of the command, from the start of the return.

        Returns
        -------
        (places, times, errors)
            Master positions (m), times since the sampling instant before (s), errors (m).
        """
        zone = self._zone
        found = zone.coordinate + (self._in_zone(profile, 0) - zone.slave)
        return (
            zone.places,
            zone.times,
            np.asarray(self.task.machine.tool(found) - self.task.machine.tool(zone.coordinate)),
        )

    @cached_property
    def _zone(self) -> _Zone:
        """Where the shear zone is looked at: on the common grid, and at its ends at the times that occur there."""
        start, end = self.shear_zone
        step = self.sample / PHASES
        first, last = math.ceil(start / step - 1e-9), math.floor(end / step + 1e-9)
        steps = np.clip(np.arange(first, last + 1) * step, start, end)
        after = np.arange(SUBSTEPS) * (self.servo.sample_time / SUBSTEPS)
        edges = np.repeat(list(dict.fromkeys((start, end))), PHASES)
        edge_times = (edges / self.task.cut.line_speed) % (self.servo.sample_time / PHASES)
        edge_times += np.tile(np.arange(PHASES), len(edges) // PHASES) * (self.servo.sample_time / PHASES)
        places = np.concatenate([np.tile(steps, SUBSTEPS), edges])
        times = np.concatenate([np.repeat(after, len(steps)), edge_times])
        ideal = [
            np.concatenate([np.tile(on_steps, SUBSTEPS), at_edges])
            for on_steps, at_edges in zip(self.ideal(steps), self.ideal(edges), strict=True)
        ]
        return _Zone(first, len(steps), edges, edge_times, places, times, *ideal)

    def _in_zone(self, profile: CamProfile, order: int) -> FloatArray:
        """Axis, or a derivative of it over the master, where the shear zone is looked at."""
        zone = self._zone
        states, reference = _edge_states(self, profile)
        turned, pushed = self._after_sample(zone.edge_times, order)
        at_edges: FloatArray = np.einsum("ij,ij->i", turned, states) + pushed * reference
        if not zone.count:
            return at_edges
        return np.concatenate([self.on_grid(profile, zone.first, zone.count, order).ravel(), at_edges])

    def _after_sample(self, times: FloatArray, order: int) -> tuple[FloatArray, FloatArray]:
        """Give what state and held reference at a sampling instant contribute to a derivative over the master, times (s) after it."""
        turned, pushed = sampled_plants(self.servo.loop, tuple(times.tolist()))
        return turned[:, 2 - order] / self.task.cut.line_speed**order, pushed[
            :, 2 - order
        ] / self.task.cut.line_speed**order

    def _weights(self, time: float, order: int) -> FloatArray:
        """Weights of the command's samples for the axis or a derivative over the master, a time (s) after a sample."""
        return np.asarray(servo_weights(self.servo.loop, time)[order] / self.task.cut.line_speed**order)


@dataclass(frozen=True, eq=False)
class _Zone:
    """Where the shear zone is looked at: ``count`` steps of the common grid at every time after a sample, then the ends.

    ``edges`` and ``edge_times`` are the ends and the times since the sampling instant before (s) that occur there; ``places`` and ``times``
    are all of them, and ``slave``, ``ratio`` and ``coordinate`` what `Axis.ideal` says there.
    """

    first: int
    count: int
    edges: FloatArray
    edge_times: FloatArray
    places: FloatArray
    times: FloatArray
    slave: FloatArray
    ratio: FloatArray
    coordinate: FloatArray


@lru_cache(maxsize=4)  # the axis, its ratio and its ratio slope are asked for one after another
def _grid_states(axis: Axis, profile: CamProfile, first: int, count: int) -> tuple[FloatArray, FloatArray]:
    """States of the plant and held references as if each step of the common grid were a sampling instant."""
    past = memory(axis.servo.loop)
    ahead = shared(past)
    delay = axis.task.cut.line_speed * axis.servo.delay
    command = _on_steps(profile, axis.sample / PHASES, delay, first - ahead * PHASES, first + count)
    command = command[(ahead - past) * PHASES :]
    # the steps of one sampling phase are a sampled command of their own, of which the states are weighted sums: a convolution each
    rows = -(-len(command) // PHASES)
    phases = np.pad(command, (0, rows * PHASES - len(command))).reshape(rows, PHASES).T
    size = rows + past
    turned = np.fft.rfft(phases, size)[:, None] * np.fft.rfft(state_weights(axis.servo.loop, past).T, size)
    found = np.fft.irfft(turned, size)[:, :, past:rows].transpose(2, 0, 1).reshape(-1, 4)[:count]
    return found[:, :3], found[:, 3]


@lru_cache(maxsize=4)
def _edge_states(axis: Axis, profile: CamProfile) -> tuple[FloatArray, FloatArray]:
    """States of the plant and held references at the sampling instants before the ends of the shear zone."""
    zone = axis._zone
    past = memory(axis.servo.loop)
    newest = zone.edges - axis.task.cut.line_speed * (zone.edge_times + axis.servo.delay)
    commands = _before(profile, tuple(newest.tolist()), axis.sample, shared(past) + 1)
    found = commands[:, : past + 1] @ state_weights(axis.servo.loop, past)
    return found[:, :3], found[:, 3]


def shared(past: int) -> int:
    """Round a number of samples up: servos that forget nearly alike then ask for the same part of a command."""
    return -(-past // _SHARED) * _SHARED


@lru_cache(maxsize=4)
def _on_steps(profile: CamProfile, step: float, delay: float, first: int, end: int) -> FloatArray:
    """Give the command on steps of a grid, so much behind."""
    return profile(np.arange(first, end) * step - delay, outside="repeat")


@lru_cache(maxsize=4)
def _before(profile: CamProfile, places: tuple[float, ...], sample: float, count: int) -> FloatArray:
    """Give the command at places and a number of samples before each, newest first."""
    return profile(np.array(places)[:, None] - sample * np.arange(count), outside="repeat")


@lru_cache(maxsize=1024)
def sampled_plants(servo: Servo, times: tuple[float, ...]) -> tuple[FloatArray, FloatArray]:
    """Transitions and inputs of `camwright.profiles.servo.sample_plant` at several times, shapes ``(n, 3, 3)`` and ``(n, 3)``."""
    parts = [sample_plant(servo, time) for time in times]
    return np.array([part.transition for part in parts]), np.array([part.input for part in parts])
