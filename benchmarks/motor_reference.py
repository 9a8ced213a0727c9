"""A reference for least torque and energy, written for the benchmark alone: a nonlinear programme from many starts.

Pieces of constant jerk on even grids that are finer towards the ends, torque by Simpson's rule of the nodes and middles, friction smoothed,
the motor's curve at the same points, IPOPT with exact derivatives. A programme is compiled once for a kind of job, whatever differs is a
parameter. Starts are looked at on a coarse grid: the quintic bent by waves, or made to wait on its way and to run back; for an open
place on the crank from random places. The best of them are taken on to a fine grid, there also with what stands made to stand, and an
open place is moved to where it is best. What is found counts with its torque measured exactly, and only where it keeps the limits.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

import casadi as ca
import numpy as np
import numpy.typing as npt

from camwright.profiles.errors import InputError
from camwright.profiles.machines import CrankSlider
from camwright.profiles.objective import MotorObjective
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.returns import assemble, quintic_between
from camwright.profiles.task import Task
from camwright.validation.motor import greatest_load, measure_motor

COARSE, FINE = 60, 160
"""Intervals of the two grids."""
WITHIN = 1e-6
"""Share by which a limit may be exceeded."""
RESIDUAL = 1e-8
"""Greatest gap between the pieces of a motion that counts, scaled."""
TAKEN, MOVES, PLACES = 3, 12, 100
"""Looks that are taken further; steps of the search for an open place; places that are started from."""
NEAR, SAME = 0.05, 1e-3
"""Share within which of the best a look is taken to the fine grid, and share within which two looks are the same."""
SMOOTHED = 0.02
"""Power, scaled, at which a look rounds what is drawn off."""
SHARPNESS = {COARSE: 30.0, FINE: 100.0}
"""Steepness of the friction that is rounded off, over the speed as a share of the greatest."""
CREEPING = 0.02
"""Share of the greatest speed below which a slave may as well stand."""
COARSE_STEPS, FINE_STEPS = (8, 3, 1), (2,)
"""Nodes by which a slave is tried to stand longer or shorter."""
TIGHTER, FURTHEST = 3, 0.05
"""Attempts at a motion that exceeds a limit between the grid's points; each draws the limits in by twice the excess, to this share."""


Standing = npt.NDArray[np.bool_] | None
"""Nodes at which the slave stands; none where friction is rounded off instead."""


class Shape(NamedTuple):
    """What a compiled programme is for: its objective, whether the inertia changes, whether there is a motor's curve, its intervals."""

    objective: MotorObjective
    bent: bool
    curve: bool
    intervals: int


@dataclass(frozen=True)
class Found:
    """A motion that keeps its limits, its place and its value."""

    value: float
    cycle: CamProfile
    task: Task


LOADS = ("theta", "turn", "crank", "rod", "offset", "inertia", "mass", "bend", "square", "friction", "sharp", "smooth")
UNITS = ("of_speed", "of_place", "of_jerk", "fall_1", "top_1", "fall_2", "top_2")


@lru_cache(maxsize=64)
def compiled(shape: Shape) -> tuple[Any, Any]:
    """Compile the programme: the solver, and the gaps between pieces as a function."""
    n = shape.intervals
    y, u, a = (ca.SX.sym(name, n + 1) for name in "yua")
    t = ca.SX.sym("t")
    drawn = ca.SX.sym("d", 2 * n + 1 if shape.objective == "energy" and n == FINE else 0)
    h, sign = ca.SX.sym("h", n), ca.SX.sym("s", 2 * n + 1)
    load = {name: ca.SX.sym(name) for name in (*LOADS, *UNITS)}
    r1, r2 = load["of_speed"], load["of_place"]
    rise = a[1:] - a[:-1]
    gaps = ca.vertcat(
        u[:-1] + r1 * h * (a[:-1] + a[1:]) / 2 - u[1:],
        y[:-1] + r2 * h * u[:-1] + r1 * r2 * h**2 * (a[:-1] / 3 + a[1:] / 6) - y[1:],
    )
    jerk = rise * load["of_jerk"] / h
    half_u = u[:-1] + r1 * h / 2 * (0.75 * a[:-1] + 0.25 * a[1:])
    half_y = y[:-1] + r2 * h / 2 * u[:-1] + r1 * r2 * (h / 2) ** 2 * (a[:-1] * 5 / 12 + a[1:] / 12)
    place, speed = ca.vertcat(y, half_y), ca.vertcat(u, half_u)
    torque = _torque(shape, load, place, speed, ca.vertcat(a, 0.5 * (a[:-1] + a[1:])))
    torque += load["friction"] * (sign + (1 - sign**2) * ca.tanh(speed * load["sharp"]))
    weight = ca.vertcat(ca.vertcat(h, 0) / 6 + ca.vertcat(0, h) / 6, h * 2 / 3)
    square = ca.dot(weight, torque**2)
    rows = [jerk - 1, -jerk - 1]
    if shape.objective == "rms_torque":
        cost = square
    elif shape.objective == "peak_torque":
        cost = t + load["smooth"] * square
        rows += [torque - t, -torque - t]
    elif n == COARSE:
        power = torque * speed
        cost = ca.dot(weight, power + ca.sqrt(power**2 + SMOOTHED**2)) / 2 + load["smooth"] * square
    else:
        cost = ca.dot(weight, drawn) + load["smooth"] * square
        rows += [torque * speed - drawn]
    if shape.curve:
        size = ca.sqrt(speed**2 + 1e-8)
        for k in "12":
            rows += [way * torque + load[f"fall_{k}"] * size - load[f"top_{k}"] for way in (1, -1)]
    w, p = ca.vertcat(y, u, a, t, drawn), ca.vertcat(h, sign, *load.values())
    options = {
        "print_time": False,
        "error_on_fail": False,
        "ipopt.print_level": 0,
        "ipopt.sb": "yes",
        "ipopt.mu_strategy": "adaptive",
        "ipopt.max_iter": 100 if n == COARSE else 200,
        "ipopt.tol": 1e-4 if n == COARSE else 1e-7,
        "ipopt.constr_viol_tol": 1e-5 if n == COARSE else 1e-9,
        "ipopt.bound_relax_factor": 1e-9,
    }
    solver = ca.nlpsol("reference", "ipopt", {"x": w, "p": p, "f": cost, "g": ca.vertcat(gaps, *rows)}, options)
    return solver, ca.Function("gaps", [w, p], [gaps])


def _torque(shape: Shape, load: dict[str, Any], place: Any, speed: Any, bend: Any) -> Any:
    """Torque of the inertia: of the crank's kinetic energy, or of a mass."""
    if not shape.bent:
        return load["bend"] * bend
    one, two, three = (ca.SX.sym(name) for name in "abc")
    angle = load["theta"] + load["turn"] * one
    turned = ca.SX.sym("angle")
    across = load["crank"] * ca.sin(turned) - load["offset"]
    tool = -load["crank"] * ca.cos(turned) + ca.sqrt(load["rod"] ** 2 - across**2)
    inertia = load["inertia"] + load["mass"] * ca.gradient(tool, turned) ** 2
    slope = ca.gradient(inertia, turned)
    inertia, slope = (ca.substitute(each, turned, angle) for each in (inertia, slope))
    force = load["bend"] * inertia * three + load["square"] * slope * two**2
    given = [load[name] for name in LOADS]
    one_point = ca.Function("torque", [one, two, three, *given], [force])
    return ca.vertcat(
        *(one_point(*at, *given) for at in zip(*(ca.vertsplit(e) for e in (place, speed, bend)), strict=True))
    )


class Grid:
    """A task on a grid: its units, parameters and limits."""

    def __init__(self, task: Task, objective: MotorObjective, intervals: int) -> None:
        self.task, self.objective = task, objective
        self.shape = Shape(objective, isinstance(task.machine, CrankSlider), task.limits.motor is not None, intervals)
        even = np.linspace(0.0, 1.0, intervals + 1)
        self.xi = 0.45 * (1 - np.cos(np.pi * even)) + 0.1 * even
        self.xi[-1] = 1.0
        self.quintic = quintic_between(task.sync, task.cut.return_zone, task.height)

    @cached_property
    def units(self) -> tuple[float, float, float, float]:
        """Units of slave, ratio, ratio slope (over the return as 1), torque at the slave."""
        x, length, machine = self.xi * self.length, self.length, self.task.machine
        y, u, a = (abs(self.quintic(x, order)).max() * length**order for order in range(3))
        y = max(abs(self.task.height), y)
        heaviest = max(float(machine.inertia(self.task.slave_at_sync_end + each)) for each in self.quintic(x))
        a = max(a, u, 1e-9)
        return y, u, a, heaviest * (self.task.cut.line_speed / length) ** 2 * a + machine.friction

    @property
    def length(self) -> float:
        """Length of the return (m)."""
        return self.task.cut.return_zone

    def parameters(self, sign: FloatArray, smooth: float, drawn_in: float) -> FloatArray:
        """Values of the parameters."""
        task, machine, v = self.task, self.task.machine, self.task.cut.line_speed
        y, u, a, torque = self.units
        pace = v / self.length
        crank = isinstance(machine, CrankSlider)
        load = dict.fromkeys((*LOADS, *UNITS), 0.0)
        load |= {
            "theta": task.slave_at_sync_end,
            "turn": y,
            "bend": pace**2 * a / torque,
            "square": pace**2 * u**2 / 2 / torque,
            "friction": machine.friction / torque,
            "sharp": SHARPNESS[self.shape.intervals],
            "smooth": smooth,
            "of_speed": a / u,
            "of_place": u / y,
            "of_jerk": a / (task.greatest_jerk * self.length**3) * (1 + WITHIN / 4),
        }
        if crank:
            load |= {
                "crank": machine.crank,
                "rod": machine.rod,
                "offset": machine.offset,
                "inertia": machine.crank_inertia,
                "mass": machine.carriage_mass,
            }
        else:
            load["bend"] *= float(machine.inertia(0.0))
        if task.limits.motor is not None:
            speeds, torques = np.array(task.limits.motor.points).T
            falls = -np.diff(torques) / np.diff(speeds)
            for k, (speed, top, fall) in enumerate(zip(speeds, torques, falls, strict=False), start=1):
                at_slave = machine.motor_ratio / torque
                load[f"fall_{k}"] = fall * machine.motor_ratio * pace * u * at_slave
                load[f"top_{k}"] = (top + fall * speed) * at_slave * (1 - drawn_in)
        return np.concatenate([np.diff(self.xi), sign, list(load.values())])

    def limits(self, drawn_in: float) -> tuple[FloatArray, FloatArray]:
        """Least and greatest values of place, ratio and ratio slope at the nodes."""
        task, (y, u, a, _) = self.task, self.units
        fastest = task.greatest_ratio
        if task.limits.motor is not None:
            fastest = min(fastest, task.limits.motor.top_speed / (task.machine.motor_ratio * task.cut.line_speed))
        guide = task.machine.guide or (-math.inf, math.inf)
        room = 0.0 if task.machine.guide is None else drawn_in * (guide[1] - guide[0])
        start = task.slave_at_sync_end
        least = drawn_in * fastest + (task.least_ratio if task.least_ratio == 0 else max(task.least_ratio, -fastest))
        low = [(guide[0] + room - start) / y, least * self.length / u, -task.greatest_slope * self.length**2 / a]
        high = [
            (guide[1] - room - start) / y,
            fastest * (1 - drawn_in) * self.length / u,
            task.greatest_slope * self.length**2 / a,
        ]
        lower, upper = (np.repeat(each, len(self.xi)).reshape(3, -1) for each in (low, high))
        for order, unit in enumerate((y, u, a)):
            for end, at in ((0, 0.0), (-1, self.length)):
                lower[order, end] = upper[order, end] = float(self.quintic(at, order)) * self.length**order / unit
        return lower, upper

    def solve(
        self, nodes: FloatArray, smooth: float = 1e-5, drawn_in: float = 0.0, standing: Standing = None
    ) -> FloatArray | None:
        """Solve from values at the nodes; place, ratio and ratio slope at the nodes, none if the pieces do not meet.

        ``standing`` tells which nodes are to stand; the others are then held to the way that they go.
        """
        solver, gaps = compiled(self.shape)
        n = self.shape.intervals
        lower, upper = self.limits(drawn_in)
        sign = np.zeros(2 * n + 1)
        if standing is not None:
            way = np.where(standing, 0.0, np.sign(nodes[1]))
            lower[1:, standing] = upper[1:, standing] = 0.0
            lower[1, way > 0] = np.maximum(lower[1, way > 0], 0.0)
            upper[1, way < 0] = np.maximum(np.minimum(upper[1, way < 0], 0.0), lower[1, way < 0])
            sign = np.concatenate([way, np.sign(way[:-1] + way[1:])])
        loose = (
            np.zeros(n) if standing is None else np.where(standing[1:] & standing[:-1], 1.0, 0.0)
        )  # nothing to hold where all is zero
        p = self.parameters(sign, smooth, drawn_in)
        tail = solver.size1_in("x0") - 3 * (n + 1)
        count = solver.size1_in("lbg") - 2 * n
        answer = solver(
            x0=np.concatenate([np.clip(nodes, lower, upper).ravel(), np.ones(tail)]),
            p=p,
            lbx=np.concatenate([lower.ravel(), np.zeros(tail)]),
            ubx=np.concatenate([upper.ravel(), np.full(tail, np.inf)]),
            lbg=np.concatenate([-loose, np.zeros(n), np.full(count, -np.inf)]),
            ubg=np.concatenate([loose, np.zeros(n + count)]),
        )
        found = np.asarray(answer["x"]).ravel()
        missed = float(abs(np.asarray(gaps(found, p))).max())
        if not missed <= RESIDUAL:
            return None
        return found[: 3 * (n + 1)].reshape(3, -1)

    def cycle(self, nodes: FloatArray) -> CamProfile:
        """Cycle whose ratio slope is that of the nodes, but for the least change that makes it meet the sync zone to rounding."""
        x, h = self.xi * self.length, np.diff(self.xi * self.length)
        a = nodes[2] * self.units[2] / self.length**2
        given = [self.quintic(np.array([0.0, self.length]), order) for order in range(2)]

        def reached(bend: FloatArray) -> tuple[FloatArray, FloatArray]:
            ratio = given[1][0] + np.append(0.0, np.cumsum(h * (bend[:-1] + bend[1:]) / 2))
            steps = h * ratio[:-1] + h**2 * (bend[:-1] / 3 + bend[1:] / 6)
            return given[0][0] + np.append(0.0, np.cumsum(steps)), ratio

        ends = np.stack(
            [(np.append(h, 0) + np.append(0, h)) / 2] * 2
        )  # what each node adds to the last ratio, and to the last place
        ends[1] *= self.length - x
        ends[1, 1:] += h**2 / 6
        ends[1, :-1] -= h**2 / 6
        ends[:, (nodes[1] == 0) & (nodes[2] == 0)] = 0.0  # what stands, stands
        ends[:, [0, -1]] = 0.0
        for _ in range(2):
            y, u = reached(a)
            missed = np.array([given[1][1] - u[-1], given[0][1] - y[-1]])
            a = a + ends.T @ np.linalg.lstsq(ends @ ends.T, missed, rcond=None)[0]
        y, u = reached(a)
        rows = np.stack([y[:-1], u[:-1], a[:-1] / 2, np.diff(a) / h / 6], axis=1)
        return assemble(CamProfile.from_arrays(x, rows), self.task)

    def onto(self, other: Grid, nodes: FloatArray) -> FloatArray:
        """Bring values at the nodes onto another grid, which may be that of another place."""
        return np.stack(
            [
                np.interp(other.xi, self.xi, row) * mine / its
                for row, mine, its in zip(nodes, self.units, other.units, strict=False)
            ]
        )

    def starts(self, rng: np.random.Generator, number: int) -> tuple[FloatArray, Standing]:
        """One of many starts, and where it stands: the quintic, bent by waves, or waiting on its way, then running back."""
        y, standing = self.quintic(self.xi * self.length), None
        size = max(abs(self.task.height), 0.1 * abs(y).max())
        if number % 3 == 2:
            begin, end, turn = np.sort(rng.uniform(0.05, 0.95, 3))
            part, back = rng.uniform(size=2)
            if not self.task.reverses or rng.integers(2):
                turn, back = end, 0.0
            shares = np.array([0.0, part, part, part - 0.5 * back, 1.0])
            y = np.interp(self.xi, [0.0, begin, end, turn, 1.0], shares * self.task.height)
            standing = (self.xi >= begin) & (self.xi <= end)
        elif number:
            for k in range(1, 5):
                y = y + rng.normal(0, 0.15 * size / k) * np.sin(k * np.pi * self.xi)
        slope = np.gradient(y, self.xi)
        rows = (y, slope, np.gradient(slope, self.xi))
        return np.stack([row / unit for row, unit in zip(rows, self.units, strict=False)]), standing


@dataclass(frozen=True, eq=False)
class Look:
    """A motion on a grid, where it stands, and its value."""

    value: float
    grid: Grid
    nodes: FloatArray
    standing: Standing


def excess(cycle: CamProfile, task: Task) -> float:
    """Greatest share by which a cycle exceeds a limit; of the least ratio and the stroke as shares of the greatest and the length."""
    over = [moving_excess(cycle, task)]
    if task.machine.guide is not None:
        low, high = (each.value + task.slave_zero(cycle) for each in cycle.extrema(0))
        guide = task.machine.guide
        over += [(guide[0] - low) / (guide[1] - guide[0]), (high - guide[1]) / (guide[1] - guide[0])]
    if task.limits.motor is not None:
        torque, available = greatest_load(cycle, task, task.limits.motor)
        over.append(torque.value / available - 1 if available > 0 else math.inf)
    return max(over)


def moving_excess(profile: CamProfile, task: Task) -> float:
    """Greatest share by which a cycle, or its sync zone, exceeds the limits of ratio, slope and jerk."""
    least, greatest = profile.extrema(1)
    over = [greatest.value / task.greatest_ratio - 1, (task.least_ratio - least.value) / task.greatest_ratio]
    for order, limit in ((2, task.greatest_slope), (3, task.greatest_jerk)):
        over.append(profile.peak(order) / limit - 1)
    return max(over)


def possible_places(task: Task) -> list[Task]:
    """Places of an open sync zone at which the zone itself keeps the limits."""
    low, high = task.machine.place_range(task.cut)
    there = [task.placed_at(low + (high - low) * share) for share in (np.arange(PLACES) + 0.5) / PLACES]
    return [each for each in there if zone_keeps(each)]


def zone_keeps(task: Task) -> bool:
    """Whether the sync zone keeps the limits where it is placed; near the dead centres it is no motion at all."""
    try:
        return moving_excess(task.sync, task) <= WITHIN
    except InputError:
        return False


def reference(task: Task, objective: MotorObjective, rng: np.random.Generator, starts: int) -> Found | None:
    """Best motion found that keeps all limits; none if there is none."""
    places = [task] if task.machine.placed else possible_places(task)
    looks: list[Look] = []
    for number in range(starts if places else 0):
        grid = Grid(places[int(rng.integers(len(places)))], objective, COARSE)
        start, waits = grid.starts(rng, number)
        nodes = grid.solve(start, smooth=1e-3, standing=waits if task.machine.friction else None)
        if nodes is not None:
            looks.append(looked_at(grid, nodes, waits if task.machine.friction else None))
    taken = distinct(looks, math.inf)
    if not task.machine.placed:
        taken = [moved(look) for look in taken]
    taken = distinct([waited(look, COARSE_STEPS) for look in taken], NEAR)
    found = [motion for look in taken for motion in polished(look)]
    return min(found, key=lambda motion: motion.value, default=None)


def distinct(looks: list[Look], near: float) -> list[Look]:
    """Take the best few of the looks, near the best of all, none of which has the value of another."""
    taken: list[Look] = []
    for look in sorted(looks, key=lambda look: look.value):
        if not taken or (
            taken[-1].value * (1 + SAME) < look.value < taken[0].value * (1 + near) and len(taken) < TAKEN
        ):
            taken.append(look)
    return taken


def value(cycle: CamProfile, task: Task, objective: MotorObjective) -> float:
    """Value of a cycle, measured exactly."""
    measured = getattr(measure_motor(cycle, task), objective)
    return math.inf if measured is None else float(measured)  # none where its pieces do not meet


def looked_at(grid: Grid, nodes: FloatArray, standing: Standing) -> Look:
    """Measure a look; its value is infinite if its sync zone needs what the motor does not give."""
    cycle, task = grid.cycle(nodes), grid.task
    fits = task.limits.motor is None or excess(cycle, task) <= FURTHEST
    return Look(value(cycle, task, grid.objective) if fits else math.inf, grid, nodes, standing)


def moved(look: Look) -> Look:
    """Move the sync zone of a look to where its value is least nearby."""
    low, high = look.grid.task.machine.place_range(look.grid.task.cut)
    step = 0.05 * (high - low)
    for _ in range(MOVES):
        for way in (step, -step):
            task = look.grid.task
            place = task.machine.place + way
            if not (low < place < high and zone_keeps(task.placed_at(place))):
                continue
            grid = Grid(task.placed_at(place), look.grid.objective, COARSE)
            nodes = grid.solve(look.grid.onto(grid, look.nodes), smooth=1e-4, standing=look.standing)
            other = look if nodes is None else looked_at(grid, nodes, look.standing)
            if other.value < look.value:
                look = other
                break
        else:
            step /= 2
    return look


def waited(look: Look, steps: tuple[int, ...]) -> Look:
    """Let the slave stand longer or shorter, earlier or later, by steps of so many nodes, as long as that is better."""
    for step in steps if look.standing is not None and look.standing.any() else ():
        for earlier, later in ((-step, 0), (step, 0), (0, step), (0, -step)):
            for _ in range(4):
                begin, end = np.flatnonzero(look.standing)[[0, -1]] + (earlier, later)
                if not 0 < begin < end < len(look.standing) - 1:
                    break
                standing = np.zeros(len(look.standing), bool)
                standing[begin : end + 1] = True
                nodes = look.grid.solve(look.nodes, smooth=1e-4, standing=standing)
                other = look if nodes is None else looked_at(look.grid, nodes, standing)
                if other.value >= look.value:
                    break
                look = other
    return look


def polished(look: Look) -> Iterator[Found]:
    """Take a look on to the fine grid, with and without standing where it creeps; those motions that keep the limits."""
    task = look.grid.task
    grid = Grid(task, look.grid.objective, FINE)
    begin = look.grid.onto(grid, look.nodes)
    creeps = abs(begin[1]) < CREEPING * abs(begin[1]).max()
    creeps[[0, -1]] = False
    for standing in (None, creeps) if task.machine.friction and creeps.sum() > 1 else (None,):
        drawn_in, now = 0.0, Look(math.inf, grid, begin, standing)
        for _ in range(TIGHTER):
            nodes = grid.solve(now.nodes, drawn_in=drawn_in, standing=now.standing)
            if nodes is None:
                break
            now = waited(looked_at(grid, nodes, now.standing), FINE_STEPS if drawn_in == 0 else ())
            cycle = grid.cycle(now.nodes)
            over = excess(cycle, task)
            if over <= WITHIN:
                yield Found(value(cycle, task, grid.objective), cycle, task)
                break
            drawn_in += 2 * over
            if drawn_in > FURTHEST:
                break
