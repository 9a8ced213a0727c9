"""The pieces of a torque programme: what holds from node to node, what each point asks of the motor, and the sync zone that is placed."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np

from camwright.design.torque.layout import Layout
from camwright.design.torque.numbers import TorqueForm, TorqueNumbers
from camwright.design.torque.pieces import NONE, Laid, Places, ProgrammePiece
from camwright.design.torque.task import PEAKS, TorqueTask
from camwright.design.torque.zone import Zone, available_torque, zone_looks, zone_met, zone_point
from camwright.profiles.machines import Machine
from camwright.profiles.polynomial.profile import FloatArray

# NumPy's functions on CasADi's symbols are meant: a machine is written once, for numbers and symbols alike.
ca.GlobalOptions.setNumpyMode(1)

JERK_DRAWN_IN = 3e-7
"""Share by which the jerk's limit is drawn in, which short phases see magnified."""
CURVE_DRAWN_IN = 2e-3
"""Share by which the motor's torque is drawn in, which is looked at in Gauss-Lobatto points only."""
KEPT = 32
"""Pieces that are kept: those of the last few programmes."""


def lay(layout: Layout) -> list[Laid]:
    """Lay the pieces of a programme; the steps from node to node first, a row each for the velocity between them the last."""
    form = layout.form
    a, v, q, lengths, bound, drawn, ends, zone_drawn = (each.start for each in layout.slices)
    mesh, weights, places, signs, zone_places, zone_weights, numbers, _ = (each.start for each in layout.given)
    n, peak = layout.intervals, form.aim == "peak_jerk"
    node, phase = np.arange(n), lengths + layout.phase
    rows = [a + node, a + node + 1, v + node, v + node + 1, q + node, q + node + 1]
    rows += [phase] if layout.free else []
    laid = [_laid(layout, _step(form, layout.free), n, [*rows, *([bound] if peak else [])], [mesh + node, numbers])]
    if layout.free or form.aim in PEAKS:
        own = [*range(lengths, lengths + len(layout.pattern)), bound]
        laid.append(_laid(layout, _whole(form, len(layout.pattern)), 1, own, [numbers + 2]))
    if form.aim == "peak_acceleration":
        laid.append(_laid(layout, _node(form), n + 1, [a + np.arange(n + 1), bound], [numbers]))
    if form.feels_motor:
        i, count = layout.owner, layout.points
        point = np.arange(count)
        rows = [a + i, a + i + 1, v + i, q + i, bound]
        rows += [phase[i]] if layout.free else []
        rows += [drawn + point] if form.aim == "energy" else []
        rows += [ends + 1] if layout.placed else []
        given = [mesh + i, weights + point, places + point, signs + point, *(numbers + k for k in (0, 1, 3))]
        laid.append(_laid(layout, _point(form, layout.free, layout.placed), count, rows, given))
    if layout.placed:
        point = np.arange(layout.zone_points)
        rows = [ends, ends + 1, bound, *([zone_drawn + point] if form.aim == "energy" else [])]
        given = [zone_places + point, zone_weights + point, numbers, numbers + 1]
        laid.append(_laid(layout, _zone_point(form), len(point), rows, given))
        laid.append(_laid(layout, _join(form), 1, [ends, ends + 1, a, v, q, a + n, v + n, q + n], [numbers]))
    return laid


def _laid(
    layout: Layout, part: tuple[ProgrammePiece, list[int]], count: int, rows: list[Any], given: list[Any]
) -> Laid:
    """Lay a piece at a number of places, with what is given there and the numbers of the task that it asks for."""
    piece, asked = part
    return Laid(piece, _rows(count, rows), _rows(count, [*given, *(layout.given[-1].start + k for k in asked)]))


def _rows(count: int, rows: list[Any]) -> Places:
    return np.stack([np.broadcast_to(row, count) for row in rows])


def _part(form: TorqueForm, piece: ProgrammePiece) -> tuple[ProgrammePiece, list[int]]:
    """Give a piece the numbers of the task that it asks for, after what else it is given; and say which these are."""
    used = {symbol.name() for symbol in ca.symvar(ca.vertcat(piece.cost, piece.rows, piece.made))}
    asked = [k for k, symbol in enumerate(form.numbers.flat) if symbol.name() in used]
    return replace(piece, given=ca.vertcat(piece.given, *(form.numbers.flat[k] for k in asked))), asked


def _motion(form: TorqueForm, *names: str) -> list[Any]:
    """Unknown accelerations (a), velocities (v) and positions, the former two in units of the pace: pairs of symbol and value."""
    pace = form.numbers.pace
    symbols = [ca.SX.sym(name) for name in names]
    units = [{"a": pace**2, "v": pace}.get(name[0], 1.0) for name in names]
    return [(symbol, symbol * unit) for symbol, unit in zip(symbols, units, strict=True)]


@lru_cache(KEPT)
def _step(form: TorqueForm, free: bool) -> tuple[ProgrammePiece, list[int]]:
    """Hold the motion from node to node within its limits; the velocity between is the last row."""
    states = _motion(form, "a", "a1", "v", "v1", "q", "q1")
    a, a1, v, v1, q, q1 = (value for _, value in states)
    length, bound = ca.SX.sym("l"), ca.SX.sym("t")
    share, unit = ca.SX.sym("p"), ca.SX.sym("u")
    phase = length if free else 1.0
    h, rise = share * phase, a1 - a
    equal = ca.vertcat((v + h * (a + a1) / 2 - v1) / form.numbers.pace, q + h * v + h * h * (a / 3 + a1 / 6) - q1)
    sharpest = form.numbers.sharpest
    by_phase = (1.0 - JERK_DRAWN_IN) * phase
    above = [
        by_phase - rise / share / sharpest,
        by_phase + rise / share / sharpest,
        *_ramps(form, a, a1, v, v1, h, share),
    ]
    cost = ca.SX(0)
    if form.aim == "rms_acceleration":
        cost = h * (a**2 + a * a1 + a1**2) / 3 / unit**2
    elif form.aim == "rms_jerk":
        cost = rise**2 / h / unit**2
    elif form.aim == "peak_jerk":
        above += [bound - rise / h / unit, bound + rise / h / unit]
    unknowns = [symbol for symbol, _ in states] + [length] * free + [bound] * (form.aim == "peak_jerk")
    return _part(
        form,
        ProgrammePiece(ca.vertcat(*unknowns), ca.vertcat(share, unit), cost, equal, ca.vertcat(*above, v + h * a / 2)),
    )


def _ramps(form: TorqueForm, a: Any, a1: Any, v: Any, v1: Any, h: Any, share: Any) -> list[Any]:
    """Make what the line's ramps leave (`camwright.design.line.forms`) by Bernstein coefficients, times the lengths of the phases."""
    found = []
    for ratio, slope, jerk in form.numbers.forms:
        for pace, bend in ((v, a), (v + h * a / 2, (a + a1) / 2), (v1, a1)):
            free = h * (1.0 - JERK_DRAWN_IN - ratio * pace - slope * bend) - jerk * (a1 - a)
            found.append(free / share)
    return found


@lru_cache(KEPT)
def _whole(form: TorqueForm, phases: int) -> tuple[ProgrammePiece, list[int]]:
    """Add the lengths of the phases up to the return, and let the bound of a peak pay."""
    lengths, bound, paid = ca.SX.sym("l", phases), ca.SX.sym("t"), ca.SX.sym("w")
    equal = ca.sum1(lengths) - 1.0 if phases > 1 else NONE
    cost = paid * bound if form.aim in PEAKS else ca.SX(0)
    return _part(form, ProgrammePiece(ca.vertcat(lengths, bound), paid, cost, equal, NONE))


@lru_cache(KEPT)
def _node(form: TorqueForm) -> tuple[ProgrammePiece, list[int]]:
    """Hold the acceleration at a node under its bound."""
    ((symbol, a),) = _motion(form, "a")
    bound, unit = ca.SX.sym("t"), ca.SX.sym("u")
    above = ca.vertcat(bound - a / unit, bound + a / unit)
    return _part(form, ProgrammePiece(ca.vertcat(symbol, bound), unit, ca.SX(0), NONE, above))


@lru_cache(KEPT)
def _point(form: TorqueForm, free: bool, placed: bool) -> tuple[ProgrammePiece, list[int]]:
    """Ask of the motor what a point of the return needs."""
    states = _motion(form, "a", "a1", "v", "q")
    a, a1, v, q = (value for _, value in states)
    bound, length, drawn, start = (ca.SX.sym(name) for name in ("t", "l", "e", "s"))
    given = ca.SX.sym("p", 7)
    share, weight, s, sign, unit, power_unit, rounding = ca.vertsplit(given)
    h, rise = share * (length if free else 1.0), a1 - a
    machine, numbers = form.machine, form.numbers
    between = ca.SX.sym("m", 3)
    y, velocity, acceleration = ca.vertsplit(between)
    made = ca.vertcat(
        (start if placed else numbers.start) + numbers.scale * (q + h * s * (v + h * s * (a / 2 + rise * s / 6))),
        numbers.scale / numbers.duration * (v + h * s * (a + rise * s / 2)),
        numbers.scale / numbers.duration**2 * (a + rise * s),
    )
    inertia, inertia_slope, *around = _inertia_about(machine, y)
    torque = inertia * acceleration + inertia_slope * velocity**2 / 2 + machine.friction * sign
    available = available_torque(form, velocity)
    if form.forms:  # what a ramp takes of it
        available -= inertia * ca.fabs(velocity) * numbers.hardest
    part = weight * (length if free else 1.0)
    square = part * (torque / unit) ** 2
    cost, above = rounding * square, []
    match form.aim:
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
    above += _within(form, torque, available)
    unknowns = [symbol for symbol, _ in states] + [bound] + [length] * free + [drawn] * (form.aim == "energy")
    return _part(
        form,
        ProgrammePiece(
            ca.vertcat(*unknowns, *[start] * placed), given, cost, NONE, ca.vertcat(*above), between, made, *around
        ),
    )


def _inertia_about(machine: Machine, y: Any) -> tuple[Any, Any, Any, Any]:
    """Inertia and its slope about a slave coordinate to the second order; the symbols that hold it and its derivatives, and what they are.

    The slope is the derivative of the inertia, which CasADi would work out again, and its derivatives twice.
    """
    place, *inertias = (ca.SX.sym(name) for name in ("at", "i", "i1", "i2", "i3"))
    off, (own, first, second, third) = y - place, inertias
    slope = machine.inertia_slope(y)
    bend = ca.jacobian(slope, y)  # forward, which is shorter here than a gradient
    settled = ca.densify(ca.vertcat(y, machine.inertia(y), slope, bend, ca.jacobian(bend, y)))
    inertia = own + off * (first + off * second / 2)
    return inertia, first + off * (second + off * third / 2), ca.vertcat(place, *inertias), settled


def _within(form: TorqueForm, torque: Any, available: Any) -> list[Any]:
    """Make what the motor's curve leaves, if it is a limit."""
    if form.curve is None or form.aim == "load":
        return []
    allowed, strongest = available * (1 - CURVE_DRAWN_IN), form.curve.points[0][1] * form.machine.motor_ratio
    return [(allowed - torque) / strongest, (allowed + torque) / strongest]


@lru_cache(KEPT)
def _zone_point(form: TorqueForm) -> tuple[ProgrammePiece, list[int]]:
    """Ask of the motor and the limits what a point of the sync zone needs."""
    start, end, bound, drawn = (ca.SX.sym(name) for name in ("s", "e", "t", "d"))
    given = ca.SX.sym("p", 4)
    share, weight, unit, power_unit = ca.vertsplit(given)
    point = zone_point(start, end, share, form)
    cost, values = ca.SX(0), []
    above = [1.0 - point.shares, *_within(form, point.torque, point.available)]
    match form.aim:
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
    unknowns = ca.vertcat(start, end, bound, *[drawn] * (form.aim == "energy"))
    return _part(form, ProgrammePiece(unknowns, given, cost, NONE, ca.vertcat(*above)))


@lru_cache(KEPT)
def _join(form: TorqueForm) -> tuple[ProgrammePiece, list[int]]:
    """Join the return to the ends of the sync zone."""
    start, end = ca.SX.sym("s"), ca.SX.sym("e")
    states = _motion(form, "a", "v", "q", "a1", "v1", "q1")
    closure, met = zone_met(start, end, form)
    own = ca.vertcat(*[value for _, value in states])
    return _part(
        form,
        ProgrammePiece(
            ca.vertcat(start, end, *[symbol for symbol, _ in states]),
            ca.SX.sym("u"),
            ca.SX(0),
            ca.vertcat(closure, own - ca.vertcat(*met)),
            NONE,
        ),
    )


@lru_cache(KEPT)
def _zone_function(form: TorqueForm, count: int) -> Any:
    """Make the function of torque, velocity, weight and greatest share of a limit at so many points of zones."""
    start, end, share = (ca.SX.sym(name) for name in ("s", "e", "x"))
    point = zone_point(start, end, share, form)
    asked = [start, end, share, ca.vertcat(*form.numbers.flat)]
    return ca.Function("zone", asked, [point.torque, point.velocity, point.weight, ca.mmax(point.shares)]).map(count)


def _zones(task: TorqueTask, zone: Zone, starts: FloatArray, ends: FloatArray) -> list[FloatArray]:
    """Torque, velocity, weight and greatest share of a limit of zones between pairs of slave coordinates, at their points; a row each."""
    shares, form = zone_looks(zone.points)[0], TorqueForm.of(task)
    count, points = len(starts), len(shares)
    if not count:  # CasADi maps a function over no points to an error
        return [np.empty((0, points))] * 4
    numbers = np.tile(np.array(TorqueNumbers.of(task).flat)[:, None], count * points)
    found = _zone_function(form, count * points)(
        np.repeat(starts, points)[None, :], np.repeat(ends, points)[None, :], np.tile(shares, count)[None, :], numbers
    )
    return [np.asarray(part).reshape(count, points) for part in found]


def zone_numbers(task: TorqueTask, zone: Zone, start: float, end: float) -> list[FloatArray]:
    """Torque, power and weight of a sync zone between two slave coordinates, at its points."""
    torque, velocity, weight, _ = (rows[0] for rows in _zones(task, zone, np.array([start]), np.array([end])))
    return [torque, torque * velocity, zone_looks(zone.points)[1] * weight]


def zone_floors(task: TorqueTask, zone: Zone, starts: FloatArray, ends: FloatArray) -> FloatArray:
    """Bound the objective, as `TorqueAnswer.value` has it, by what sync zones between pairs of coordinates need; 0 for others."""
    torque, velocity, weight, _ = _zones(task, zone, starts, ends)
    weights = zone_looks(zone.points)[1] * weight
    match task.aim:
        case "rms_torque":
            return np.asarray(np.sqrt((weights * torque**2).sum(axis=1) / (1.0 + weights.sum(axis=1))))
        case "peak_torque":
            return np.asarray(np.abs(torque).max(axis=1))
        case "energy":
            return np.asarray((weights * np.maximum(torque * velocity, 0.0)).sum(axis=1))
    return np.zeros(len(starts))


def greatest_share(task: TorqueTask, zone: Zone, starts: FloatArray, ends: FloatArray) -> FloatArray:
    """Greatest share of a limit that the sync zone itself uses, between pairs of slave coordinates."""
    return np.asarray(_zones(task, zone, starts, ends)[3].max(axis=1))
