"""The programme of returns whose torque counts: as the objective, or within what the motor gives at its speed.

Time and slave are scaled: the return takes the time 1, the slave's travel is counted in the task's scale from the place where the return
starts. The acceleration is a broken line over a mesh that is a parameter, so that it can be refined without a new programme. The return
may be made of phases of unknown length (forwards, at rest, backwards), in each of which the sign of the friction is known. Torque and power
are evaluated at Gauss-Lobatto points of every interval through the machine's own formulas. It is not convex where the inertia changes or
the length of a rest is unknown.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from camwright.design.returns.ipopt import QUIET
from camwright.design.torque.layout import LOBATTO, Layout
from camwright.design.torque.numbers import FAR_SLOPE, TorqueForm, TorqueNumbers, moved
from camwright.design.torque.parts import lay, zone_numbers
from camwright.design.torque.pieces import programme
from camwright.design.torque.task import Pattern, TorqueTask
from camwright.design.torque.watch import MOST_AT_FIRST, MOST_MULTIPLIER, WatchedSolver
from camwright.design.torque.zone import Zone
from camwright.profiles.objective import MOTION_OBJECTIVES
from camwright.profiles.polynomial.profile import FloatArray

# A peak, and the energy, also pay this share of the mean square, so that of all motions with nearly that value the smoothest is taken.
ROUNDING = {"peak_torque": 3e-5, "load": 3e-5, "energy": 1e-4}
# A first look pays this much: far quicker, and near enough.
FIRST_ROUNDING = {"peak_torque": 1e-2, "load": 1e-2, "energy": 1e-3}
DRAWN_IN = 3e-8
"""Share by which limits are drawn in here: the solver answers this programme to about 1e-8, the contract says 1e-9."""
SHORTEST_PHASE = 1e-5
"""Least length of a phase with motion, as a share of the return."""

ACCURACY, MOST_ITERATIONS = 1e-8, 300
"""Accuracy of the solver, scaled, and its most iterations."""
KEPT = 16
"""Solvers that are kept: those of one design, whose starts of a kind have one, and of jobs of the same form, as a book's are."""

_OPTIONS: dict[str, Any] = QUIET | {
    "ipopt.mu_strategy": "adaptive",
    "ipopt.bound_relax_factor": 1e-10,
    # steps are refined where they need it, not always
    "ipopt.min_refinement_steps": 0,
}
_FROM_NEAR: dict[str, Any] = {"ipopt.mu_strategy": "monotone", "ipopt.mu_init": 1e-4}


@dataclass(frozen=True, eq=False)
class Guess:
    """A motion to start from, at the nodes of a mesh.

    Parameters
    ----------
    mesh
        Lengths of the intervals as shares of their phase, one array for each phase with motion.
    lengths
        Lengths of all phases, their sum 1.
    acceleration, velocity, position
        Scaled, at the nodes of the mesh, phases with motion one after the other, neighbours sharing a node.
    ends
        Slave coordinates of the sync zone's start and end, for a programme that places it.
    """

    mesh: tuple[FloatArray, ...]
    lengths: FloatArray
    acceleration: FloatArray
    velocity: FloatArray
    position: FloatArray
    ends: tuple[float, float] | None = None


@dataclass(frozen=True, eq=False)
class TorqueAnswer:
    """One answer of the solver.

    Parameters
    ----------
    guess
        The motion, to start from again.
    value
        Its objective at the slave, over the return, or over the cycle where the zone is placed: torque or force, mean power, the load as a
        share; over the scaled return for motions.
    residual
        Largest KKT residual (scaled).
    success
        Whether the solver converged to numbers.
    """

    guess: Guess
    value: float
    residual: float
    success: bool
    iterations: int


class TorqueProgramme:
    """The programme of one task and pattern on a mesh of a size: accelerations at nodes, linear between, and the node states."""

    def __init__(
        self,
        task: TorqueTask,
        pattern: Pattern,
        counts: tuple[int, ...],
        zone: Zone | None = None,
        accuracy: float = ACCURACY,
        iterations: int = MOST_ITERATIONS,
        near: bool = False,
    ) -> None:
        """Build the programme.

        Parameters
        ----------
        task
            What it is for; programmes that differ in its numbers alone share a solver.
        pattern
            The phases of the return.
        counts
            Numbers of intervals of the phases with motion.
        zone
            The sync zone, if the programme is to place it.
        accuracy, iterations
            Of the solver: how well it must end (scaled), and how long it may take.
        near
            Whether its guesses are near an answer: the solver then does not leave the valley that they lie in.
        """
        self._task, self._zone = task, zone
        looks = 0 if zone is None else zone.points
        kept = _kept_solver(TorqueForm.of(task), pattern, counts, looks, accuracy, iterations, near)
        self._kept = kept
        self._numbers = TorqueNumbers.of(task)
        pace, sizes = self._numbers.pace, kept.layout.sizes
        self._units = np.repeat([pace**2, pace, *np.ones(len(sizes) - 2)], sizes)
        self._limits = self._rows(kept)

    @property
    def _layout(self) -> Layout:
        return self._kept.layout

    def _state(self, guess: Guess) -> FloatArray:
        ends = np.array(guess.ends if self._zone is not None and guess.ends is not None else [])
        parts = (
            guess.acceleration,
            guess.velocity,
            guess.position,
            guess.lengths,
            [0.0],
            np.zeros(self._layout.sizes[5]),
        )
        return np.concatenate([*parts, ends, np.zeros(self._layout.sizes[7])])

    def value(self, guess: Guess) -> float:
        """Objective of a motion, as `TorqueAnswer.value` has it."""
        return self._value(self._state(guess), np.concatenate(guess.mesh))

    def _looked(self, state: FloatArray, mesh: FloatArray) -> tuple[FloatArray, ...]:
        """Torque or force, power and what the motor gives at the points, their weights, and the lengths of the intervals."""
        task, layout, machine = self._task, self._layout, self._task.machine
        a, v, q, lengths, _, _, ends, _ = (state[part] for part in layout.slices)
        h = mesh * lengths[layout.phase]
        i, s = layout.owner, LOBATTO[0][layout.place]
        rise, d = (a[1:] - a[:-1])[i], h[i] * s
        start = task.start if self._zone is None else float(ends[1])
        y = start + task.scale * (q[i] + d * (v[i] + d * (a[i] / 2 + rise * s / 6)))
        velocity = task.scale / task.duration * (v[i] + d * (a[i] + rise * s / 2))
        acceleration = task.scale / task.duration**2 * (a[i] + rise * s)
        torque = machine.inertia(y) * acceleration + machine.inertia_slope(y) * velocity**2 / 2
        torque = torque + machine.friction * layout.signs
        available = np.full(len(torque), np.inf)
        if task.curve is not None:
            motor = np.minimum(np.abs(velocity) * machine.motor_ratio, task.curve.top_speed)
            available = task.curve.torque(motor) * machine.motor_ratio
            if task.task.line.ramps:
                available -= machine.inertia(y) * np.abs(velocity) * task.task.line.hardest / task.cut.line_speed
        return torque, torque * velocity, available, layout.weights(mesh) * lengths[layout.phase[i]], h

    def _value(self, state: FloatArray, mesh: FloatArray) -> float:
        torque, power, available, weights, h = self._looked(state, mesh)
        zone = self._zone
        if zone is not None:
            more = zone_numbers(self._task, zone, *state[self._layout.slices[6]])
            torque, power, weights = (
                np.append(one, other) for one, other in zip((torque, power, weights), more, strict=True)
            )
        a = state[: self._layout.sizes[0]]
        match self._task.aim:
            case "rms_torque":
                return math.sqrt(
                    float(weights @ torque**2) / float(weights.sum())
                    if zone is not None
                    else float(weights @ torque**2)
                )
            case "peak_torque":
                return float(np.abs(torque).max())
            case "energy":
                return float(weights @ np.maximum(power, 0.0))
            case "load":
                return float(np.abs(torque / available).max())
            case "peak_acceleration":
                return float(np.abs(a).max())
            case "rms_acceleration":
                return math.sqrt(float(h @ (a[:-1] ** 2 + a[:-1] * a[1:] + a[1:] ** 2)) / 3)
            case "peak_jerk":
                return float(np.abs(np.diff(a) / h).max())
            case "rms_jerk":
                return math.sqrt(float((np.diff(a) ** 2 / h).sum()))

    def solve(
        self, guess: Guess, *, rough: bool = False, floor: float = 0.0, ceiling: float | None = None, hold: bool = False
    ) -> TorqueAnswer:
        """Solve from a guess.

        Parameters
        ----------
        guess
            The motion to start from.
        rough
            Whether this is a first look.
        floor
            Peak below which nothing is gained (N or N·m).
        ceiling
            Peak under which the least mean square of the torque is looked for, instead of the least peak (N or N·m).
        hold
            Whether the sync zone stays where the guess has it.
        """
        mesh = np.concatenate(guess.mesh)
        start, layout = self._state(guess), self._layout
        torque, power, _, _, _ = self._looked(start, mesh)
        value = self._value(start, mesh)
        motion = self._task.aim in MOTION_OBJECTIVES
        unit = value if motion else float(np.sqrt(np.mean(torque**2)))
        units = [max(unit, 1e-300), max(float(np.abs(power).max()), 1e-300)]
        parameters = layout.parameters(mesh, (*units, *self._payment(rough, ceiling), *self._numbers.flat))
        a, v, q, lengths, bound, drawn, ends, zone_drawn = layout.slices
        if self._task.aim == "energy":
            start[drawn] = np.maximum(power / units[1], 0.0) + 0.1
            start[zone_drawn] = 0.1
        start[bound] = 1.1 * value if self._task.aim == "load" else 1.1 * value / units[0]
        lower, upper = self._bounds()
        if hold:
            lower[ends] = upper[ends] = guess.ends
        lower[bound] = floor / units[0]
        if ceiling is not None:
            upper[bound] = ceiling / (1.0 if self._task.aim == "load" else units[0])
            start[bound] = upper[bound]
        self._kept.watched.watch.most = MOST_AT_FIRST if rough else MOST_MULTIPLIER
        try:
            answer = self._kept.watched.solver(
                x0=start / self._units,
                p=parameters,
                lbx=lower / self._units,
                ubx=upper / self._units,
                lbg=self._limits[0],
                ubg=self._limits[1],
            )
        except RuntimeError:  # a number that is none, on the way or in the guess: no answer from this start
            return TorqueAnswer(guess, math.inf, math.inf, False, 0)
        statistics = self._kept.watched.solver.stats()
        flat: FloatArray = np.asarray(answer["x"], dtype=np.float64).ravel() * self._units
        history = statistics.get("iterations", {})
        residual = max(
            (float(history[name][-1]) for name in ("inf_pr", "inf_du") if history.get(name)), default=math.inf
        )
        found = Guess(
            guess.mesh,
            flat[lengths],
            flat[a],
            flat[v],
            flat[q],
            None if self._zone is None else (float(flat[ends][0]), float(flat[ends][1])),
        )
        finite = bool(np.isfinite(flat).all()) and math.isfinite(residual)
        value = self._value(flat, mesh) if finite else math.inf
        return TorqueAnswer(
            found, value, residual, bool(statistics["success"]) and math.isfinite(value), int(statistics["iter_count"])
        )

    def _payment(self, rough: bool, ceiling: float | None) -> tuple[float, float]:
        """Give what a peak pays, and the mean square of the torque."""
        if ceiling is not None:
            return 0.0, 1.0
        return 1.0, (FIRST_ROUNDING if rough else ROUNDING).get(self._task.aim, 0.0)

    def _rows(self, kept: _KeptSolver) -> tuple[FloatArray, FloatArray]:
        """Limits of all rows; the last of every step from node to node is the velocity between."""
        lower, upper = (each.copy() for each in kept.limits)
        steps = slice(kept.step - 1, kept.step * self._layout.intervals, kept.step)
        lower[steps], upper[steps] = self._paces()
        return lower, upper

    def _paces(self) -> tuple[FloatArray, FloatArray]:
        """Limits of the velocity in each interval, by its phase; beside a rest it is what the ends of the interval make it."""
        problem, unit = self._task.problem, self._task.problem.length / self._task.scale
        low, high = problem.least_ratio * unit, problem.greatest_ratio * unit
        of = {"any": (low, high), "forth": (max(low, 0.0), high), "back": (low, min(high, 0.0))}
        moving = np.array([of[phase] for phase in self._layout.pattern if phase != "rest"])
        aside = DRAWN_IN * np.maximum(1.0, np.abs(moving))
        lower, upper = np.repeat(moving + aside * [1.0, -1.0], self._layout.counts, axis=0).T
        joints = np.cumsum(self._layout.counts)[:-1]
        for beside in (joints - 1, joints):
            lower[beside] = np.where(lower[beside] > 0, -DRAWN_IN, lower[beside])
            upper[beside] = np.where(upper[beside] < 0, DRAWN_IN, upper[beside])
        return lower, upper

    def _bounds(self) -> tuple[FloatArray, FloatArray]:
        task, problem = self._task, self._task.problem
        length, scale, count = problem.length, task.scale, sum(self._layout.sizes)
        lower, upper = np.full(count, -np.inf), np.full(count, np.inf)
        a, v, q, lengths, _, drawn, ends, zone_drawn = self._layout.slices
        slope = min(problem.greatest_slope * length**2 / scale, FAR_SLOPE * moved(task)) * (1 - DRAWN_IN)
        lower[a], upper[a] = -slope, slope
        low, high = self._paces()
        lower[v] = np.maximum(np.append(low, low[-1]), np.append(low[0], low))
        upper[v] = np.minimum(np.append(high, high[-1]), np.append(high[0], high))
        lower[q] = problem.least_position / scale + DRAWN_IN
        upper[q] = problem.greatest_position / scale - DRAWN_IN
        lower[drawn], lower[zone_drawn] = 0.0, 0.0
        lower[lengths] = [0.0 if phase == "rest" else SHORTEST_PHASE for phase in self._layout.pattern]
        if len(self._layout.pattern) == 1:
            lower[lengths] = upper[lengths] = 1.0
        node = 0
        counts = iter(self._layout.counts)
        for k, phase in enumerate(self._layout.pattern):
            if phase != "rest":
                node += next(counts)
            else:
                lower[a.start + node] = upper[a.start + node] = 0.0
            if k < len(self._layout.pattern) - 1:
                lower[v.start + node] = upper[v.start + node] = 0.0
        if self._zone is not None:
            lower[ends], upper[ends] = self._zone.range
            return lower, upper
        ratio = length / scale
        for part, first, last in (
            (a, problem.start_slope * length * ratio, problem.end_slope * length * ratio),
            (v, problem.start_ratio * ratio, problem.end_ratio * ratio),
            (q, 0.0, problem.height / scale),
        ):
            lower[part.start] = upper[part.start] = first
            lower[part.stop - 1] = upper[part.stop - 1] = last
        return lower, upper


@dataclass(frozen=True, eq=False)
class _KeptSolver:
    """What programmes share that differ in numbers alone.

    Parameters
    ----------
    limits
        Least and greatest values of all rows, but for those of velocities.
    step
        Rows of a step from node to node, which come first.
    """

    layout: Layout
    limits: tuple[FloatArray, FloatArray]
    step: int
    watched: WatchedSolver


@lru_cache(KEPT)
def _kept_solver(
    form: TorqueForm,
    pattern: Pattern,
    counts: tuple[int, ...],
    looks: int,
    accuracy: float,
    iterations: int,
    near: bool,
) -> _KeptSolver:
    """Build a solver, or give it again: nothing of one solution is left for the next."""
    layout = Layout(pattern, counts, looks, form)
    laid = lay(layout)
    nlp, derivatives = programme(laid, sum(layout.sizes), layout.given[-1].stop)
    options = _OPTIONS | derivatives | {"ipopt.tol": accuracy, "ipopt.max_iter": iterations}
    watched = WatchedSolver.of("camwright_torque", nlp, options | (_FROM_NEAR if near else {}))
    lower, upper = (np.concatenate([getattr(each, side) for each in laid]) for side in ("lower", "upper"))
    return _KeptSolver(layout, (lower, upper), laid[0].piece.rows.numel(), watched)
