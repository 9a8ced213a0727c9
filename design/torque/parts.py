"""The pieces of a torque programme: what holds from node to node, what each point asks of the motor, and the sync zone that is placed."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np

from camwright.design.line.forms import ramp_forms
from camwright.design.torque.layout import Layout
from camwright.design.torque.pieces import NONE, Laid, ProgrammePiece
from camwright.design.torque.task import PEAKS, TorqueTask
from camwright.design.torque.zone import Zone, available_torque
from camwright.profiles.polynomial.profile import FloatArray

# NumPy's functions on CasADi's symbols are meant: a machine is written once, for numbers and symbols alike.
ca.GlobalOptions.setNumpyMode(1)

JERK_DRAWN_IN = 3e-7
"""Share by which the jerk's limit is drawn in, which short phases see magnified."""
FAR_SLOPE, FAR_JERK = 1e5, 1e8
"""Limits of the scaled acceleration and jerk are no greater than these, times how much its ends alone move it. On slow lines they are by
powers of ten, and the solver, whose steps go by the room to a limit, takes hundreds of them or finds no end."""
CURVE_DRAWN_IN = 2e-3
"""Share by which the motor's torque is drawn in, which is looked at in Gauss-Lobatto points only."""
KEPT = 32
"""Pieces that are kept: those of the last few programmes."""


def moved(task: TorqueTask) -> float:
    """How much the ratios and slopes at the ends move the slave over the return, in units of its scale, at least 1."""
    problem = task.problem
    ratios = (problem.start_ratio * problem.length, problem.end_ratio * problem.length)
    slopes = (problem.start_slope * problem.length**2, problem.end_slope * problem.length**2)
    return max(task.scale, *map(abs, (*ratios, *slopes))) / task.scale


def lay(task: TorqueTask, layout: Layout) -> list[Laid]:
    """Lay the pieces of a task's programme; the steps from node to node first, a row each for the velocity between them the last."""
    a, v, q, lengths, bound, drawn, ends, zone_drawn = (each.start for each in layout.slices)
    mesh, weights, places, signs, zone_places, zone_weights, numbers = (each.start for each in layout.given)
    n, peak = layout.intervals, task.aim == "peak_jerk"
    node, phase = np.arange(n), lengths + layout.phase
    rows = [a + node, a + node + 1, v + node, v + node + 1, q + node, q + node + 1]
    rows += [phase] if layout.free else []
    laid = [Laid(_step(task, layout.free), _rows(n, *rows, *([bound] if peak else [])), _rows(n, mesh + node, numbers))]
    if layout.free or _bounded(task):
        own = [*range(lengths, lengths + len(layout.pattern)), bound]
        laid.append(Laid(_whole(task, len(layout.pattern)), _rows(1, *own), _rows(1, numbers + 2)))
    if task.aim == "peak_acceleration":
        nodes = np.arange(n + 1)
        laid.append(Laid(_node(task), _rows(n + 1, a + nodes, bound), _rows(n + 1, numbers)))
    zone = layout.zone
    if task.feels_motor:
        i, count = layout.owner, layout.points
        point = np.arange(count)
        rows = [a + i, a + i + 1, v + i, q + i, bound]
        rows += [phase[i]] if layout.free else []
        rows += [drawn + point] if task.aim == "energy" else []
        rows += [] if zone is None else [ends + 1]
        given = [mesh + i, weights + point, places + point, signs + point, *(numbers + k for k in (0, 1, 3))]
        laid.append(Laid(_point(task, layout.free, zone is not None), _rows(count, *rows), _rows(count, *given)))
    if zone is not None:
        point = np.arange(layout.zone_points)
        rows = [ends, ends + 1, bound, *([zone_drawn + point] if task.aim == "energy" else [])]
        given = [zone_places + point, zone_weights + point, numbers, numbers + 1]
        laid.append(Laid(_zone_point(task, zone), _rows(len(point), *rows), _rows(len(point), *given)))
        rows = [ends, ends + 1, a, v, q, a + n, v + n, q + n]
        laid.append(Laid(_join(task, zone), _rows(1, *rows), _rows(1, numbers)))
    return laid


def _rows(count: int, *rows: Any) -> Any:
    return np.stack([np.broadcast_to(row, count) for row in rows])


def _bounded(task: TorqueTask) -> bool:
    """Whether a bound of what is to be least is an unknown."""
    return task.aim in PEAKS


def _pace(task: TorqueTask) -> float:
    return 1.0 / task.crossing


def _motion(task: TorqueTask, *names: str) -> list[Any]:
    """Unknown accelerations (a), velocities (v) and positions, the former two in units of the pace: pairs of symbol and value."""
    pace = _pace(task)
    symbols = [ca.SX.sym(name) for name in names]
    units = [{"a": pace**2, "v": pace}.get(name[0], 1.0) for name in names]
    return [(symbol, symbol * unit) for symbol, unit in zip(symbols, units, strict=True)]


@lru_cache(KEPT)
def _step(task: TorqueTask, free: bool) -> ProgrammePiece:
    """Hold the motion from node to node within its limits; the velocity between is the last row."""
    states = _motion(task, "a", "a1", "v", "v1", "q", "q1")
    a, a1, v, v1, q, q1 = (value for _, value in states)
    length, bound = ca.SX.sym("l"), ca.SX.sym("t")
    share, unit = ca.SX.sym("p"), ca.SX.sym("u")
    phase = length if free else 1.0
    h, rise = share * phase, a1 - a
    equal = ca.vertcat((v + h * (a + a1) / 2 - v1) / _pace(task), q + h * v + h * h * (a / 3 + a1 / 6) - q1)
    problem = task.problem
    sharpest = min(problem.greatest_jerk * problem.length**3 / task.scale, FAR_JERK * moved(task))
    by_phase = (1.0 - JERK_DRAWN_IN) * phase
    above = [
        by_phase - rise / share / sharpest,
        by_phase + rise / share / sharpest,
        *_ramps(task, a, a1, v, v1, h, share),
    ]
    cost = ca.SX(0)
    if task.aim == "rms_acceleration":
        cost = h * (a**2 + a * a1 + a1**2) / 3 / unit**2
    elif task.aim == "rms_jerk":
        cost = rise**2 / h / unit**2
    elif task.aim == "peak_jerk":
        above += [bound - rise / h / unit, bound + rise / h / unit]
    unknowns = [symbol for symbol, _ in states] + [length] * free + [bound] * (task.aim == "peak_jerk")
    return ProgrammePiece(
        ca.vertcat(*unknowns), ca.vertcat(share, unit), cost, equal, ca.vertcat(*above, v + h * a / 2)
    )


def _ramps(task: TorqueTask, a: Any, a1: Any, v: Any, v1: Any, h: Any, share: Any) -> list[Any]:
    """Make what the line's ramps leave (`camwright.design.line.forms`) by Bernstein coefficients, times the lengths of the phases."""
    if not task.task.line.ramps:
        return []
    found, length = [], task.problem.length
    for form in ramp_forms(task.task):
        ratio, slope, jerk = (
            factor * task.scale / length**order
            for order, factor in enumerate((form.ratio, form.slope, form.jerk), start=1)
        )
        for pace, bend in ((v, a), (v + h * a / 2, (a + a1) / 2), (v1, a1)):
            free = h * (1.0 - JERK_DRAWN_IN - ratio * pace - slope * bend) - jerk * (a1 - a)
            found.append(free / share)
    return found


@lru_cache(KEPT)
def _whole(task: TorqueTask, phases: int) -> ProgrammePiece:
    """Add the lengths of the phases up to the return, and let the bound of a peak pay."""
    lengths, bound, paid = ca.SX.sym("l", phases), ca.SX.sym("t"), ca.SX.sym("w")
    equal = ca.sum1(lengths) - 1.0 if phases > 1 else NONE
    return ProgrammePiece(ca.vertcat(lengths, bound), paid, paid * bound if _bounded(task) else ca.SX(0), equal, NONE)


@lru_cache(KEPT)
def _node(task: TorqueTask) -> ProgrammePiece:
    """Hold the acceleration at a node under its bound."""
    ((symbol, a),) = _motion(task, "a")
    bound, unit = ca.SX.sym("t"), ca.SX.sym("u")
    return ProgrammePiece(
        ca.vertcat(symbol, bound), unit, ca.SX(0), NONE, ca.vertcat(bound - a / unit, bound + a / unit)
    )


@lru_cache(KEPT)
def _point(task: TorqueTask, free: bool, placed: bool) -> ProgrammePiece:
    """Ask of the motor what a point of the return needs."""
    states = _motion(task, "a", "a1", "v", "q")
    a, a1, v, q = (value for _, value in states)
    bound, length, drawn, start = (ca.SX.sym(name) for name in ("t", "l", "e", "s"))
    given = ca.SX.sym("p", 7)
    share, weight, s, sign, unit, power_unit, rounding = ca.vertsplit(given)
    h, rise = share * (length if free else 1.0), a1 - a
    machine = task.machine
    between = ca.SX.sym("m", 3)
    y, velocity, acceleration = ca.vertsplit(between)
    made = ca.vertcat(
        (start if placed else task.start) + task.scale * (q + h * s * (v + h * s * (a / 2 + rise * s / 6))),
        task.scale / task.duration * (v + h * s * (a + rise * s / 2)),
        task.scale / task.duration**2 * (a + rise * s),
    )
    torque = machine.inertia(y) * acceleration + machine.inertia_slope(y) * velocity**2 / 2 + machine.friction * sign
    available = available_torque(task, velocity)
    if task.task.line.ramps:  # what a ramp takes of it
        available -= machine.inertia(y) * ca.fabs(velocity) * task.task.line.hardest / task.cut.line_speed
    part = weight * (length if free else 1.0)
    square = part * (torque / unit) ** 2
    cost, above = rounding * square, []
    match task.aim:
        case "rms_torque":
            cost = square
        case "energy":  # what is drawn is the power or, as its bound says, nothing
            cost += part * drawn
            above = [drawn - torque * velocity / power_unit]
        case "peak_torque":
            above = [bound - torque / unit, bound + torque / unit]
        case "load":
            above = [bound - torque / available, bound + torque / available]
        case _:
            cost = ca.SX(0)
    above += _within(task, torque, available)
    unknowns = [symbol for symbol, _ in states] + [bound] + [length] * free + [drawn] * (task.aim == "energy")
    return ProgrammePiece(
        ca.vertcat(*unknowns, *[start] * placed), given, cost, NONE, ca.vertcat(*above), between, made
    )


def _within(task: TorqueTask, torque: Any, available: Any) -> list[Any]:
    """Make what the motor's curve leaves, if it is a limit."""
    if task.curve is None or task.aim == "load":
        return []
    allowed, strongest = available * (1 - CURVE_DRAWN_IN), task.curve.points[0][1] * task.machine.motor_ratio
    return [(allowed - torque) / strongest, (allowed + torque) / strongest]


@lru_cache(KEPT)
def _zone_point(task: TorqueTask, zone: Zone) -> ProgrammePiece:
    """Ask of the motor and the limits what a point of the sync zone needs."""
    start, end, bound, drawn = (ca.SX.sym(name) for name in ("s", "e", "t", "d"))
    given = ca.SX.sym("p", 4)
    share, weight, unit, power_unit = ca.vertsplit(given)
    point = zone.at(start, end, share, task)
    cost, values = ca.SX(0), []
    above = [1.0 - point.shares, *_within(task, point.torque, point.available)]
    match task.aim:
        case "rms_torque":
            cost = weight * point.weight * (point.torque / unit) ** 2
        case "energy":
            cost = weight * point.weight * drawn
            above += [drawn - point.torque * point.velocity / power_unit]
        case "peak_torque":
            values = [point.torque]
        case "peak_acceleration":
            values = [point.acceleration]
        case "peak_jerk":
            values = [point.jerk]
    above += [bound + sign * value / unit for value in values for sign in (-1.0, 1.0)]
    unknowns = ca.vertcat(start, end, bound, *[drawn] * (task.aim == "energy"))
    return ProgrammePiece(unknowns, given, cost, NONE, ca.vertcat(*above))


@lru_cache(KEPT)
def _join(task: TorqueTask, zone: Zone) -> ProgrammePiece:
    """Join the return to the ends of the sync zone."""
    start, end = ca.SX.sym("s"), ca.SX.sym("e")
    states = _motion(task, "a", "v", "q", "a1", "v1", "q1")
    closure, met = zone.met(start, end, task)
    own = ca.vertcat(*[value for _, value in states])
    return ProgrammePiece(
        ca.vertcat(start, end, *[symbol for symbol, _ in states]),
        ca.SX.sym("u"),
        ca.SX(0),
        ca.vertcat(closure, own - ca.vertcat(*met)),
        NONE,
    )


@lru_cache(KEPT)
def _zone_function(task: TorqueTask, zone: Zone) -> Any:
    start, end, share = (ca.SX.sym(name) for name in ("s", "e", "x"))
    point = zone.at(start, end, share, task)
    return ca.Function("zone", [start, end, share], [point.torque, point.velocity, point.weight])


def zone_numbers(task: TorqueTask, zone: Zone, start: float, end: float) -> list[FloatArray]:
    """Torque, power and weight of a sync zone between two slave coordinates, at its points."""
    shares, weights = zone.looks
    rows = (np.full((1, len(shares)), each) for each in (start, end))
    found = _zone_function(task, zone).map(len(shares))(*rows, shares[None, :])
    torque, velocity, weight = (np.asarray(part).ravel() for part in found)
    return [torque, torque * velocity, weights * weight]


def zone_floor(task: TorqueTask, zone: Zone, start: float, end: float) -> float:
    """Bound the objective, as `TorqueAnswer.value` has it, by what a sync zone between two slave coordinates needs; 0 for others."""
    torque, power, weights = zone_numbers(task, zone, start, end)
    match task.aim:
        case "rms_torque":
            return math.sqrt(float(weights @ torque**2) / (1.0 + float(weights.sum())))
        case "peak_torque":
            return float(np.abs(torque).max())
        case "energy":
            return float(weights @ np.maximum(power, 0.0))
    return 0.0


def greatest_share(task: TorqueTask, zone: Zone, starts: FloatArray, ends: FloatArray) -> FloatArray:
    """Greatest share of a limit that the sync zone itself uses, between pairs of slave coordinates."""
    start, end, share = (ca.SX.sym(name) for name in ("s", "e", "x"))
    function = ca.Function("shares", [start, end, share], [ca.mmax(zone.at(start, end, share, task).shares)])
    shares = zone.looks[0]
    found = function.map(len(starts) * len(shares))(
        np.repeat(starts, len(shares))[None, :],
        np.repeat(ends, len(shares))[None, :],
        np.tile(shares, len(starts))[None, :],
    )
    return np.asarray(np.asarray(found).reshape(len(starts), len(shares)).max(axis=1))
