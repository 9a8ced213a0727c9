"""The programme of returns whose torque counts: as the objective, or within what the motor gives at its speed.

Time and slave are scaled: the return takes the time 1, the slave's travel is counted in the task's scale from the place where the return
starts. The acceleration is a broken line over a mesh that is a parameter, so that it can be refined without a new programme. The return
may be made of phases of unknown length (forwards, at rest, backwards), in each of which the sign of the friction is known. Torque and power
are evaluated at Gauss-Lobatto points of every interval through the machine's own formulas. It is not convex where the inertia changes or
the length of a rest is unknown.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from camwright.design.line.forms import ramp_forms
from camwright.design.returns.ipopt import QUIET
from camwright.design.torque.task import Pattern, TorqueTask
from camwright.design.torque.watch import MOST_AT_FIRST, MOST_MULTIPLIER, WatchedSolver
from camwright.design.torque.zone import Zone, available_torque
from camwright.profiles.objective import MOTION_OBJECTIVES
from camwright.profiles.polynomial.profile import FloatArray

# NumPy's functions on CasADi's symbols are meant: a machine is written once, for numbers and symbols alike.
ca.GlobalOptions.setNumpyMode(1)

# A peak, and the energy, also pay this share of the mean square, so that of all motions with nearly that value the smoothest is taken.
ROUNDING = {"peak_torque": 3e-5, "load": 3e-5, "energy": 1e-4}
# A first look pays this much: far quicker, and near enough.
FIRST_ROUNDING = {"peak_torque": 1e-2, "load": 1e-2, "energy": 1e-3}
DRAWN_IN = 3e-8
"""Share by which limits are drawn in here: the solver answers this programme to about 1e-8, the contract says 1e-9."""
JERK_DRAWN_IN = 3e-7
"""The same for the jerk, which short phases see magnified."""

FAR_SLOPE, FAR_JERK = 1e5, 1e8
"""Limits of the scaled acceleration and jerk are no greater than these, times how much its ends alone move it. On slow lines they are by
powers of ten, and the solver, whose steps go by the room to a limit, takes hundreds of them or finds no end."""

CURVE_DRAWN_IN = 2e-3
"""The same for the motor's torque, which is looked at in Gauss-Lobatto points only."""
SHORTEST_PHASE = 1e-5
"""Least length of a phase with motion, as a share of the return."""

ACCURACY, MOST_ITERATIONS = 1e-8, 300
"""Accuracy of the solver, scaled, and its most iterations."""

PARAMETERS = 4
"""Parameters besides the mesh: units of torque and power, what a peak pays, and what the mean square."""

LOBATTO = (
    0.5 + 0.5 * np.array([-1.0, -math.sqrt(0.2), math.sqrt(0.2), 1.0]),
    np.array([1.0, 5.0, 5.0, 1.0]) / 12.0,
)
"""Gauss-Lobatto points on the unit interval, and their weights: exact to degree 5, and at the nodes, where a peak may stand."""

_OPTIONS: dict[str, Any] = QUIET | {
    "ipopt.mu_strategy": "adaptive",
    "ipopt.bound_relax_factor": 1e-10,
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


@dataclass(frozen=True, eq=False)
class _Layout:
    """How the unknowns of a programme lie.

    Phases of the return, intervals of those with motion, the sync zone if it is to be placed, numbers of unknowns by kind, their units.
    """

    pattern: Pattern
    counts: tuple[int, ...]
    zone: Zone | None
    sizes: list[int]
    units: FloatArray


def _moved(task: TorqueTask) -> float:
    """How much the ratios and slopes at the ends move the slave over the return, in units of its scale, at least 1."""
    problem = task.problem
    ratios = (problem.start_ratio * problem.length, problem.end_ratio * problem.length)
    slopes = (problem.start_slope * problem.length**2, problem.end_slope * problem.length**2)
    return max(task.scale, *map(abs, (*ratios, *slopes))) / task.scale


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
            What it is for.
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
        self._task = task
        n = sum(counts)
        drawn_in_zone = zone.points + 2 if zone is not None and task.aim == "energy" else 0
        drawn_count = len(LOBATTO[0]) * n if task.aim == "energy" else 0
        sizes = [n + 1, n + 1, n + 1, len(pattern), 1, drawn_count, 0 if zone is None else 2, drawn_in_zone]
        pace = 1.0 / task.crossing
        scales = np.repeat([pace**2, pace, *np.ones(len(sizes) - 2)], sizes)
        self._layout = _Layout(pattern, counts, zone, sizes, scales)
        unknowns = ca.MX.sym("x", sum(sizes))
        x = unknowns * ca.DM(scales)
        a, v, q, lengths, t, drawn, ends, zone_drawn = ca.vertsplit(x, [0, *np.cumsum(sizes).tolist()])
        p = ca.MX.sym("p", n + PARAMETERS)
        units, paid, rounding = p[n : n + 2], p[n + 2], p[n + 3]
        moving = [k for k, phase in enumerate(pattern) if phase != "rest"]
        owner = np.repeat(moving, counts)
        h = p[:n] * ca.vec(lengths[owner.tolist()])
        rise = a[1:] - a[:-1]
        equations = [
            (v[:-1] + h * (a[:-1] + a[1:]) / 2 - v[1:]) / pace,
            q[:-1] + h * v[:-1] + h * h * (a[:-1] / 3 + a[1:] / 6) - q[1:],
            ca.sum1(lengths) - 1.0,
        ]
        sign = np.array([{"back": -1.0}.get(pattern[k], 1.0) for k in owner])
        between = v[:-1] + h * a[:-1] / 2
        start = task.start if zone is None else ends[1]
        interval = self._interval().map(n)
        rows = (a[:-1].T, rise.T, v[:-1].T, q[:-1].T, h.T, ca.DM(sign).T, ca.repmat(start, 1, n))
        torque, power, available = (ca.vec(part) for part in interval(*rows))
        weights = ca.vec(ca.DM(LOBATTO[1]) @ h.T)
        self._measure = ca.Function("measure", [unknowns, p], [torque, power, available, weights, h])
        mean_square = ca.dot(weights, (torque / units[0]) ** 2)
        sharpest = min(task.problem.greatest_jerk * task.problem.length**3 / task.scale, FAR_JERK * _moved(task))
        by_phase = (1.0 - JERK_DRAWN_IN) * h / p[:n]
        jerk = (
            by_phase - rise / p[:n] / sharpest,
            by_phase + rise / p[:n] / sharpest,
            *self._ramps(a, v, h, p[:n]),
        )
        peaks: list[Any] = []
        match task.aim:
            case "rms_torque":
                cost = mean_square
            case "energy":
                peaks = [drawn - power / units[1]]  # what is drawn is the power or, as its bound says, nothing
                cost = ca.dot(weights, drawn) + rounding * mean_square
            case "rms_acceleration":
                cost = ca.dot(h, a[:-1] ** 2 + a[:-1] * a[1:] + a[1:] ** 2) / 3 / units[0] ** 2
            case "rms_jerk":
                cost = ca.sum1(rise**2 / h) / units[0] ** 2
            case _:
                values = {
                    "peak_torque": torque / units[0],
                    "load": torque / available,
                    "peak_acceleration": a / units[0],
                    "peak_jerk": rise / h / units[0],
                }[task.aim]
                peaks = [t - values, t + values]
                cost = paid * t + (rounding * mean_square if task.aim in ROUNDING else 0.0)
        strongest = 1.0 if task.curve is None else task.curve.points[0][1] * task.machine.motor_ratio
        limited = task.curve is not None and task.aim != "load"
        if limited:
            allowed = available * (1 - CURVE_DRAWN_IN)
            peaks += [(allowed - torque) / strongest, (allowed + torque) / strongest]
        if zone is not None:
            joined = zone.join(ends[0], ends[1], task)
            if limited:
                allowed = joined.available * (1 - CURVE_DRAWN_IN)
                peaks += [(allowed - joined.torque) / strongest, (allowed + joined.torque) / strongest]
            equations += [
                joined.closure,
                *(state - met for state, met in zip((a[0], v[0], a[-1], v[-1]), joined.states, strict=True)),
            ]
            equations += [q[0], q[-1] - joined.travel]
            peaks += [1.0 - joined.shares]
            match task.aim:
                case "rms_torque":
                    cost += ca.dot(joined.weights, (joined.torque / units[0]) ** 2)
                case "peak_torque":
                    peaks += [t - joined.torque / units[0], t + joined.torque / units[0]]
                case "energy":
                    peaks += [zone_drawn - joined.power / units[1]]
                    cost += ca.dot(joined.weights, zone_drawn)
                case "peak_acceleration" | "peak_jerk":
                    peak = joined.accelerations if task.aim == "peak_acceleration" else joined.jerks
                    peaks += [t - peak / units[0], t + peak / units[0]]
            self._joined = ca.Function(
                "joined", [unknowns], [joined.torque, joined.power, joined.weights, joined.travel]
            )
        self._rows = (sum(part.numel() for part in equations), sum(part.numel() for part in (*peaks, *jerk)))
        nlp = {"x": unknowns, "p": p, "f": cost, "g": ca.vertcat(*equations, *peaks, *jerk, between)}
        options = _OPTIONS | {"ipopt.tol": accuracy, "ipopt.max_iter": iterations} | (_FROM_NEAR if near else {})
        self._watched = WatchedSolver.of("camwright_torque", nlp, options)

    def _ramps(self, a: Any, v: Any, h: Any, mesh: Any) -> list[Any]:
        """Make what the line's ramps leave (`camwright.design.line.forms`) by Bernstein coefficients, times the lengths of the phases."""
        task, length = self._task, self._task.problem.length
        if not task.task.line.ramps:
            return []
        middle = v[:-1] + h * a[:-1] / 2
        found = []
        for form in ramp_forms(task.task):
            ratio, slope, jerk = (
                factor * task.scale / length**order
                for order, factor in enumerate((form.ratio, form.slope, form.jerk), start=1)
            )
            for pace, bend in ((v[:-1], a[:-1]), (middle, (a[:-1] + a[1:]) / 2), (v[1:], a[1:])):
                free = h * (1.0 - JERK_DRAWN_IN - ratio * pace - slope * bend) - jerk * (a[1:] - a[:-1])
                found.append(free / mesh)
        return found

    def _interval(self) -> Any:
        """Make the function of one interval: torque or force and power at the slave, and what the motor gives, at its Gauss-Lobatto points.

        It takes the acceleration at the interval's start and its rise, ratio and position at the start, the interval's length, the
        direction of the motion, and the slave coordinate at the start of the return.
        """
        task, machine = self._task, self._task.machine
        a, rise, v, q, h, sign, start = (ca.SX.sym(name) for name in ("a", "r", "v", "q", "h", "d", "s"))
        s = ca.DM(LOBATTO[0])
        y = start + task.scale * (q + h * s * (v + h * s * (a / 2 + rise * s / 6)))
        velocity = task.scale / task.duration * (v + h * s * (a + rise * s / 2))
        acceleration = task.scale / task.duration**2 * (a + rise * s)
        force = machine.inertia(y) * acceleration + machine.inertia_slope(y) * velocity**2 / 2 + machine.friction * sign
        available = available_torque(task, velocity, len(LOBATTO[0]))
        if task.task.line.ramps:  # what a ramp takes of it
            available -= machine.inertia(y) * ca.fabs(velocity) * task.task.line.hardest / task.cut.line_speed
        return ca.Function("interval", [a, rise, v, q, h, sign, start], [force, force * velocity, available])

    def _state(self, guess: Guess) -> FloatArray:
        ends = np.array(guess.ends if self._layout.zone is not None and guess.ends is not None else [])
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
        return self._value(self._state(guess), np.concatenate([*guess.mesh, np.ones(PARAMETERS)]))

    def _value(self, state: FloatArray, parameters: FloatArray) -> float:
        torque, power, available, weights, h = (
            np.asarray(part).ravel() for part in self._measure(state / self._layout.units, parameters)
        )
        if self._layout.zone is not None:
            more = [np.asarray(part).ravel() for part in self._joined(state / self._layout.units)]
            torque, power, weights = (
                np.append(one, other) for one, other in zip((torque, power, weights), more, strict=False)
            )
        a = state[: self._layout.sizes[0]]
        match self._task.aim:
            case "rms_torque":
                return math.sqrt(
                    float(weights @ torque**2) / float(weights.sum())
                    if self._layout.zone
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
        start, parameters = self._state(guess), np.append(mesh, np.ones(PARAMETERS))
        torque, power, _, _, _ = (
            np.asarray(part).ravel() for part in self._measure(start / self._layout.units, parameters)
        )
        value = self._value(start, parameters)
        motion = self._task.aim in MOTION_OBJECTIVES
        unit = value if motion else float(np.sqrt(np.mean(torque**2)))
        units = [max(unit, 1e-300), max(float(np.abs(power).max()), 1e-300)]
        parameters[-PARAMETERS:] = [*units, *self._payment(rough, ceiling)]
        a, v, q, lengths, bound, drawn, ends, zone_drawn = self._slices()
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
        equal, above = self._rows
        low, high = self._paces()
        self._watched.watch.most = MOST_AT_FIRST if rough else MOST_MULTIPLIER
        try:
            answer = self._watched.solver(
                x0=start / self._layout.units,
                p=parameters,
                lbx=lower / self._layout.units,
                ubx=upper / self._layout.units,
                lbg=np.concatenate([np.zeros(equal + above), low]),
                ubg=np.concatenate([np.zeros(equal), np.full(above, np.inf), high]),
            )
        except RuntimeError:  # a number that is none, on the way or in the guess: no answer from this start
            return TorqueAnswer(guess, math.inf, math.inf, False, 0)
        statistics = self._watched.solver.stats()
        flat: FloatArray = np.asarray(answer["x"], dtype=np.float64).ravel() * self._layout.units
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
            None if self._layout.zone is None else (float(flat[ends][0]), float(flat[ends][1])),
        )
        finite = bool(np.isfinite(flat).all()) and math.isfinite(residual)
        value = self._value(flat, parameters) if finite else math.inf
        return TorqueAnswer(
            found, value, residual, bool(statistics["success"]) and math.isfinite(value), int(statistics["iter_count"])
        )

    def _payment(self, rough: bool, ceiling: float | None) -> tuple[float, float]:
        """Give what a peak pays, and the mean square of the torque."""
        if ceiling is not None:
            return 0.0, 1.0
        return 1.0, (FIRST_ROUNDING if rough else ROUNDING).get(self._task.aim, 0.0)

    def _slices(self) -> list[slice]:
        edges = np.cumsum([0, *self._layout.sizes])
        return [slice(int(one), int(other)) for one, other in itertools.pairwise(edges)]

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
        a, v, q, lengths, _, drawn, ends, zone_drawn = self._slices()
        slope = min(problem.greatest_slope * length**2 / scale, FAR_SLOPE * _moved(task)) * (1 - DRAWN_IN)
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
        if self._layout.zone is not None:
            lower[ends], upper[ends] = self._layout.zone.range
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
