"""From one servo-aware cam into another: a cycle in between through which the axis, not the command, stays in sync.

The commands of two shaped cams differ where they meet, and what the servo still remembers of the one is not what the other was designed
after. So the cycle of the change is a spline that begins in the state in which the one cam ends and ends in that of the other; the axis,
over its own shear zone and that of the first cycle behind it, is linear in the spline. As in the design of a cam its limits and the band
in the shear zone are rows, for every servo and at line speeds over the part that both cams hold.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camwright.design.production.change_rows import ChangeRows
from camwright.design.production.transition import RunningCam, within_ramps
from camwright.design.servo_aware.command_basis import Command
from camwright.design.servo_aware.convex import ConvexProgramme
from camwright.design.servo_aware.programme import BAND_ACCEPTED, LIMIT_MARGIN
from camwright.design.servo_aware.rows import AxisRows
from camwright.profiles.errors import SolverError
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.servo import Servo

_SPEEDS = 3
"""Line speeds over the part that both cams hold, its ends among them."""

_EACH = 32
"""Rows of a block that stand from the start, and the most that are added to it in a round."""

_MARGIN = 1e-2
"""Share by which the band in the shear zone is drawn in, as rows stand at single places, times and line speeds."""

_ROUNDS = 40
_FELT = 1e-6
"""Part of its bound by which a row must change for a travel of a cycle, else it does not know the transition."""

_SOFTER = 1e-3
"""Share by which the sync error may be above the least, where that is above what is asked."""


@dataclass(frozen=True, eq=False)
class AxisTransition:
    """A cycle that leads from one servo-aware cam into another.

    Parameters
    ----------
    profile
        One cycle, counted like that of the cam after it.
    share
        Greatest sync error that it predicts, of all servos, as a share of the tolerance.
    """

    profile: CamProfile
    share: float


def design_axis_transition(
    before: RunningCam, after: RunningCam, line_speeds: tuple[float, float], command: Command, servos: tuple[Servo, ...]
) -> AxisTransition | None:
    """Design the transition of the least peak acceleration that keeps the axis in the tolerance.

    Parameters
    ----------
    before, after
        The cam that runs, and the one that is to run, of one machine and one cut.
    line_speeds
        Least and greatest line speed at which the change is made (m/s).
    command
        Whether the whole cycle is free or the return alone.
    servos
        Servos with which the tolerance is to be kept; the axis of the first keeps the limits, too.

    Returns
    -------
    AxisTransition or None
        ``None`` where no command of the spline keeps the tolerance and the limits.

    Raises
    ------
    SolverError
        A solver ended without an answer.
    """
    programme = _TransitionProgramme(ChangeRows(before, after, command), line_speeds, servos)
    least = programme.solve(None)
    if least is None or least[1] > 1.0:
        return None
    softest = programme.solve(max(1.0 - _MARGIN, (1.0 + _SOFTER) * least[1]))
    unknowns = least[0] if softest is None else softest[0]
    return AxisTransition(programme.change.profile(unknowns), programme.share(unknowns))


class _TransitionProgramme:
    """A linear programme whose rows come as answers break them."""

    def __init__(self, change: ChangeRows, line_speeds: tuple[float, float], servos: tuple[Servo, ...]) -> None:
        self.change = change
        task = change.after.task.at_speed(line_speeds[1])
        slopes = (change.before.last[2], float(change.after.profile(change.after.zone_start, 2)))
        self._task = within_ramps(task, max(map(abs, slopes)) * line_speeds[1] ** 2)
        low, high = line_speeds
        speeds = np.unique(np.linspace(low, high, _SPEEDS)).tolist()
        self._bands = [_Block(change.bands(servo, speed), change.scale) for servo in servos for speed in speeds]
        self._own = [_Block(change.own(servos[0], speed), change.scale) for speed in speeds[:: len(speeds) - 1 or 1]]

    def solve(self, band: float | None) -> tuple[FloatArray, float] | None:
        """Make the sync error least (``None``), or the peak acceleration within a band (share of the tolerance).

        Returns
        -------
        (unknowns, value) or None
            The value is a share of the tolerance, or of the limit of acceleration.
        """
        for _ in range(_ROUNDS):
            found = self._solve_once(band)
            if found is None:
                return None
            allowed = found[1] if band is None else band
            more = [block.add_worst(found[0], allowed) for block in self._bands]
            more += [block.add_worst(found[0], 1.0) for block in self._own]
            if not any(more):
                return found
        raise SolverError("the rows of a transition between two cams came to no end; report this job")

    def share(self, unknowns: FloatArray) -> float:
        """Greatest sync error of an answer, as a share of the tolerance."""
        return max(float(block.used(unknowns).max()) for block in self._bands)

    def _solve_once(self, band: float | None) -> tuple[FloatArray, float] | None:
        basis, scale, task = self.change.basis, self.change.scale, self._task
        count = basis.matrix.shape[1]
        programme = ConvexProgramme(count + 1)
        limits = {
            1: (task.least_ratio, task.greatest_ratio),
            2: (-task.greatest_slope, task.greatest_slope),
            3: (-task.greatest_jerk, task.greatest_jerk),
        }
        if task.machine.guide is not None:
            limits[0] = (task.machine.guide[0] - self.change.after.zero, task.machine.guide[1] - self.change.after.zero)
        for order, (low, high) in limits.items():
            matrix, constant = basis.differences[order]
            free = np.abs(matrix).max(axis=1) > 0.0  # the states at the ends are given
            size = max(abs(low), abs(high))
            room = LIMIT_MARGIN * size if order else 0.0
            matrix, constant = matrix[free] * (scale / size), constant[free] / size
            programme.add(matrix, (low + room) / size - constant, (high - room) / size - constant)
            if order == 2 and band is not None:
                programme.add_peak(matrix, constant, -1.0, 1.0)
        for block in self._bands:
            matrix, constant, below, above = block.standing
            if band is None:
                programme.add_peak(matrix, constant, below, above, BAND_ACCEPTED)
            else:
                programme.add(matrix, band * below - constant, band * above - constant, BAND_ACCEPTED)
        for block in self._own:
            matrix, constant, below, above = block.standing
            programme.add(matrix, below - constant, above - constant, BAND_ACCEPTED)
        answer = programme.solve(np.append(np.zeros(count), 1.0))
        return None if answer is None else (answer[:-1], float(answer[-1]))


class _Block:
    """Rows of one servo at one line speed, in units of their bounds, and those of them that stand."""

    def __init__(self, rows: AxisRows, scale: float) -> None:
        # what a row cannot change is the other cam's, and was judged there
        felt = np.abs(rows.matrix).max(axis=1) * scale > _FELT * rows.size
        size = rows.size[felt]
        self._matrix, self._constant = rows.matrix[felt] * (scale / size)[:, None], rows.constant[felt] / size
        self._low, self._high = rows.low[felt] / size, rows.high[felt] / size
        self._stands = np.zeros(len(size), dtype=bool)
        self._stands[:: max(1, len(size) // _EACH)] = True

    @property
    def standing(self) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Matrix, constant and bounds of the rows that stand."""
        rows = self._stands
        return self._matrix[rows], self._constant[rows], self._low[rows], self._high[rows]

    def used(self, unknowns: FloatArray) -> FloatArray:
        """How much of its bound each row of an answer takes; 1 at the bound."""
        values = self._matrix @ unknowns + self._constant
        return np.asarray(np.where(values > 0.0, values / self._high, values / self._low))

    def add_worst(self, unknowns: FloatArray, band: float) -> bool:
        """Let those rows stand that an answer breaks most, of bounds widened to a share of themselves; whether there are new ones."""
        values = self._matrix @ unknowns + self._constant
        excess = np.maximum(values - band * self._high, band * self._low - values)
        excess[self._stands] = 0.0
        worst = np.argsort(-excess, kind="stable")[:_EACH]
        worst = worst[excess[worst] > 2.0 * BAND_ACCEPTED]
        self._stands[worst] = True
        return len(worst) > 0
