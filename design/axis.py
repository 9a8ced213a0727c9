"""The axis of a servo-aware design: rows of its response, and its response on the grid of all sampling phases."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from design.command_basis import CommandBasis
from design.servo_weights import memory, sampled_response, servo_weights
from profiles.cycle import Cut
from profiles.machines import Machine
from profiles.polynomial import CamProfile, FloatArray
from profiles.servo import Servo

# Sampling phases, and points between two samples, on which a design is judged: those of the validation.
PHASES = 16
SUBSTEPS = 8
_STRIDE = PHASES // SUBSTEPS
_NEWTON = 12


@dataclass(frozen=True, eq=False)
class Axis:
    """A machine's axis with one servo: where it must be, and where a command takes it.

    Master positions count from the start of the return zone, slave positions from the machine's position there.

    Parameters
    ----------
    machine
        The machine, its sync zone placed.
    cut
        The cut.
    servo
        The servo.
    """

    machine: Machine
    cut: Cut
    servo: Servo

    @property
    def sample(self) -> float:
        """Master travel in a sampling period (m)."""
        return self.servo.sample_time * self.cut.line_speed

    @property
    def shear_zone(self) -> tuple[float, float]:
        """Shear zone (m)."""
        start = self.cut.return_zone + self.cut.shear_zone_at
        return start, min(start + self.cut.shear_zone, self.cut.length)

    def ideal(self, places: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Slave, ratio, and slave coordinate of the machine in sync, at places in the sync zone."""
        sync = self.machine.sync_profile(self.cut)
        inside = np.clip(places - self.cut.return_zone, sync.start, sync.end)
        travel = sync(inside)
        return (
            travel + (self.machine.pitch - sync.advance - float(sync(sync.start))),
            sync(inside, 1),
            self.machine.sync_start(self.cut) + travel,
        )

    def band(self, places: FloatArray, tolerance: float) -> tuple[FloatArray, FloatArray]:
        """Least and greatest deviation of the slave that keep the tool within a tolerance (m) of the material."""
        coordinate = self.ideal(places)[2]
        edges = []
        for sign in (-1.0, 1.0):
            slope = np.asarray(self.machine.tool_ratio(coordinate)) + np.zeros_like(coordinate)
            deviation = sign * tolerance / slope
            for _ in range(
                _NEWTON
            ):  # the tool's map is monotonic in the sync zone and nearly straight over a tolerance
                off = self.machine.tool(coordinate + deviation) - self.machine.tool(coordinate) - sign * tolerance
                deviation = deviation - off / self.machine.tool_ratio(coordinate + deviation)
            edges.append(deviation)
        return np.minimum(*edges), np.maximum(*edges)

    def rows(
        self, basis: CommandBasis, places: FloatArray, times: FloatArray, order: int = 0
    ) -> tuple[FloatArray, FloatArray]:
        """Axis, or its ratio (1) or ratio slope (2), as rows over the unknowns of a command.

        Parameters
        ----------
        places
            Master positions (m).
        times
            Time (s) since the sampling instant before, for each place; below the sample time.
        order
            Derivative over the master.
        """
        matrix, constant = np.empty((len(places), basis.matrix.shape[1])), np.empty(len(places))
        v = self.cut.line_speed
        for time in np.unique(times):
            which = times == time
            row = self._weights(float(time), order)
            past = time + self.servo.delay + self.servo.sample_time * np.arange(len(row))
            matrix[which], constant[which] = basis.rows(places[which, None] - v * past, row)
        return matrix, constant

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
        samples = memory(self.servo.loop) + 1
        rows = -(-count // PHASES)
        ahead = (SUBSTEPS - 1) * _STRIDE
        step = self.sample / PHASES
        grid = first - (samples - 1) * PHASES - ahead + np.arange((samples - 1 + rows) * PHASES + ahead)
        command = profile(grid * step - self.cut.line_speed * self.servo.delay, outside="repeat")
        found = np.empty((SUBSTEPS, count))
        for sub in range(SUBSTEPS):
            start = ahead - sub * _STRIDE
            by_phase = command[start : start + (samples - 1 + rows) * PHASES].reshape(-1, PHASES)
            weights = self._weights(sub * self.servo.sample_time / SUBSTEPS, order)
            # a place takes the weights, newest last, over the samples of its phase: one row of a Toeplitz matrix for each sample
            padded = np.concatenate([np.zeros(rows - 1), weights[::-1], np.zeros(rows - 1)])
            band = np.lib.stride_tricks.sliding_window_view(padded, samples - 1 + rows)[::-1]
            found[sub] = (band @ by_phase).ravel()[:count]
        return found

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
        place, time, value = self._in_zone(profile, 0)
        travel, _, coordinate = self.ideal(place)
        errors = self.machine.tool(coordinate + (value - travel)) - self.machine.tool(coordinate)
        return place, time, np.asarray(errors)

    def zone_ratios(self, profile: CamProfile) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Places, times and ratio of the axis in the shear zone; as `zone_errors`."""
        return self._in_zone(profile, 1)

    def _in_zone(self, profile: CamProfile, order: int) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Places, times and the axis or its ratio in the shear zone."""
        start, end = self.shear_zone
        step = self.sample / PHASES
        first, last = math.ceil(start / step - 1e-9), math.floor(end / step + 1e-9)
        places, times, values = [], [], []
        if last >= first:
            response = self.on_grid(profile, first, last - first + 1, order)
            steps = np.arange(first, last + 1) * step
            after = np.arange(SUBSTEPS)[:, None] * (self.servo.sample_time / SUBSTEPS)
            places.append(np.broadcast_to(np.clip(steps, start, end), response.shape).ravel())
            times.append(np.broadcast_to(after, response.shape).ravel())
            values.append(response.ravel())
        for edge in dict.fromkeys((start, end)):
            after = self._edge_times(edge)
            samples = np.arange(memory(self.servo.loop) + 1)
            past = after[:, None] + self.servo.delay + self.servo.sample_time * samples
            command = profile(edge - self.cut.line_speed * past, outside="repeat")
            places.append(np.full(len(after), edge))
            times.append(after)
            values.append(sampled_response(self.servo, after, command, order) / self.cut.line_speed**order)
        return np.concatenate(places), np.concatenate(times), np.concatenate(values)

    def _weights(self, time: float, order: int) -> FloatArray:
        """Weights of the command's samples for the axis or a derivative over the master, a time (s) after a sample."""
        weights = servo_weights(self.servo.loop, time)
        return (weights.position, weights.velocity, weights.acceleration)[order] / self.cut.line_speed**order

    def _edge_times(self, place: float) -> FloatArray:
        """List the times since the sampling instant before (s) that occur at a place among the phases."""
        sixteenth = self.servo.sample_time / PHASES
        return np.asarray((place / self.cut.line_speed) % sixteenth + sixteenth * np.arange(PHASES))
