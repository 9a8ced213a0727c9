"""The splines of a servo-aware command, against scipy's and against the machine's sync zone."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import BSpline

from camwright.design.optimise import solve
from camwright.design.servo_aware.command_basis import (
    INTERVALS,
    Command,
    command_basis,
    spline_pieces,
)
from camwright.profiles.cut import Cut
from camwright.profiles.limits import Limits
from camwright.profiles.machines import (
    CrankSlider,
    LinearCarriage,
    Machine,
    RotaryKnife,
)
from camwright.profiles.polynomial.profile import FloatArray
from camwright.profiles.task import Task

FREE = Limits(float("inf"), float("inf"), float("inf"))  # nothing here asks for limits
CUT = Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4)
MACHINES: dict[str, tuple[Machine, Cut]] = {
    "knife": (RotaryKnife(0.4), CUT),
    "horizontal": (RotaryKnife(0.8, blades=2, sync="horizontal"), replace(CUT, length=0.5, sync_ratio=1.02)),
    "carriage": (LinearCarriage(0.9, home=-0.3), CUT),
    "crank": (CrankSlider(0.15, 0.6, 0.02, sync_at=1.2), replace(CUT, length=0.9, sync_zone=0.1, shear_zone_at=0.05)),
}
EVERY = pytest.mark.parametrize("name", MACHINES)
BOTH = pytest.mark.parametrize("command", ["in_sync", "shaped"])


def any_unknowns(count: int, seed: int = 1) -> FloatArray:
    return np.random.default_rng(seed).normal(size=count)


@settings(max_examples=40)
@given(st.lists(st.floats(0.05, 3.0), min_size=8, max_size=20))
def test_pieces_are_scipys_b_splines(widths: list[float]) -> None:
    knots = np.concatenate([[0.0], np.cumsum(widths)])
    pieces = spline_pieces(knots)
    for interval in range(len(pieces)):
        start, end = knots[interval + 3 : interval + 5]
        part = np.linspace(0.0, end - start, 7)[:-1]
        for spline in range(4):
            coefficients = np.zeros(len(knots) - 4)
            coefficients[interval + spline] = 1.0
            expected = BSpline(knots, coefficients, 3)(start + part)
            assert np.polyval(pieces[interval, ::-1, spline], part) == pytest.approx(expected, abs=1e-9)


@EVERY
@BOTH
def test_the_profile_is_one_cycle_with_a_continuous_second_derivative(name: str, command: Command) -> None:
    machine, cut = MACHINES[name]
    basis = command_basis(Task(machine, cut, FREE), command)
    profile = basis.profile(any_unknowns(basis.matrix.shape[1]) * 0.01)
    assert (profile.start, profile.end) == (0.0, cut.length)
    assert profile.advance == pytest.approx(machine.pitch, abs=1e-12)
    for order in (0, 1, 2):
        inside = profile.breaks[1:-1]
        left, right = profile(inside, order, side="left"), profile(inside, order)
        size = np.abs(right).max()
        assert np.abs(left - right).max() <= 1e-9 * size
        turn = machine.pitch if order == 0 else 0.0
        assert profile(profile.end, order, side="left") - turn == pytest.approx(profile(0.0, order), abs=1e-9 * size)


@EVERY
def test_an_in_sync_command_is_the_machine_in_its_sync_zone(name: str) -> None:
    machine, cut = MACHINES[name]
    basis = command_basis(Task(machine, cut, FREE), "in_sync")
    profile = basis.profile(any_unknowns(basis.matrix.shape[1]))
    sync = machine.sync_profile(cut)
    at = np.linspace(sync.start, sync.end, 50)[:-1]
    travel = profile(cut.return_zone + (at - sync.start)) - profile(profile.end)
    assert travel == pytest.approx(sync(at) - float(sync(sync.end)), abs=1e-12)
    assert float(profile(0.0)) == pytest.approx(0.0, abs=1e-12)


@EVERY
@BOTH
def test_coefficients_of_the_derivatives_are_their_hull(name: str, command: Command) -> None:
    machine, cut = MACHINES[name]
    basis = command_basis(Task(machine, cut, FREE), command)
    unknowns = any_unknowns(basis.matrix.shape[1])
    profile = basis.profile(unknowns).restrict(0.0, float(basis.nodes[-1]))
    nodes = basis.nodes
    for order, (matrix, constant) in enumerate(basis.differences):
        values = matrix @ unknowns + constant
        least, greatest = profile.extrema(order)
        size = np.abs(values).max()
        assert values.min() <= least.value + 1e-9 * size
        assert values.max() >= greatest.value - 1e-9 * size
        if order == 2:  # linear between the nodes
            assert values == pytest.approx(
                np.append(profile(nodes[:-1], 2), profile(nodes[-1], 2, side="left")), abs=1e-9 * size
            )
        if order == 3:  # constant on the intervals
            assert values == pytest.approx(profile(nodes[:-1], 3), abs=1e-9 * size)


@EVERY
@BOTH
def test_rows_are_weighted_sums_of_the_profile(name: str, command: Command) -> None:
    machine, cut = MACHINES[name]
    basis = command_basis(Task(machine, cut, FREE), command)
    unknowns = any_unknowns(basis.matrix.shape[1])
    generator = np.random.default_rng(2)
    places = generator.uniform(-3 * cut.length, 2 * cut.length, (30, 9))
    places[0, :4] = (0.0, cut.length, cut.return_zone, -cut.length)
    weights = generator.normal(size=9)
    matrix, constant = basis.rows(places, weights)
    profile = basis.profile(unknowns)
    expected = profile(places, outside="repeat") @ weights
    assert matrix @ unknowns + constant == pytest.approx(expected, abs=1e-10)


def test_the_arcs_of_a_structure_become_nodes_and_its_return_is_among_the_commands() -> None:
    machine = RotaryKnife(0.4)
    back = solve(Task(machine, CUT, Limits(200 / 60, 30.0, 3000.0)), "peak_acceleration").back
    basis = command_basis(Task(machine, CUT, FREE), "in_sync", back)
    assert all(np.abs(basis.nodes - place).min() <= 1e-12 for place in back.breaks)
    assert abs(len(basis.nodes) - 1 - INTERVALS["in_sync"]) <= back.pieces
    at = np.linspace(0.0, back.end, 300)
    collocation = np.array([basis.profile(column)(at) for column in np.eye(basis.matrix.shape[1])])
    constant = basis.profile(np.zeros(basis.matrix.shape[1]))(at)
    nearest, *_ = np.linalg.lstsq((collocation - constant).T, back(at) - constant, rcond=None)
    assert basis.profile(np.asarray(nearest, dtype=np.float64))(at) == pytest.approx(back(at), abs=1e-11)


def test_arcs_of_next_to_no_length_get_no_node() -> None:
    machine = RotaryKnife(0.4)
    back = solve(Task(machine, CUT, Limits(200 / 60, 30.0, 3000.0)), "peak_acceleration").back
    sliver = back.breaks.copy()
    sliver[1] = 1e-9
    basis = command_basis(Task(machine, CUT, FREE), "in_sync", replace(back, breaks=sliver))
    assert np.diff(basis.nodes).min() > 0.1 * back.end / INTERVALS["in_sync"]
    assert math.isclose(float(basis.nodes[-1]), CUT.return_zone, rel_tol=1e-15)


@EVERY
def test_without_more_a_shaped_command_is_a_motion_of_even_speed(name: str) -> None:
    machine, cut = MACHINES[name]
    basis = command_basis(Task(machine, cut, FREE), "shaped")
    profile = basis.profile(np.zeros(basis.matrix.shape[1]))
    at = np.linspace(0.0, cut.length, 50)
    assert profile(at) == pytest.approx(machine.pitch * at / cut.length, abs=1e-13)
    assert all(np.abs(basis.differences[order][1]).max() <= 1e-7 for order in (2, 3))


@EVERY
def test_without_more_a_command_in_sync_returns_along_a_line_but_for_its_ends(name: str) -> None:
    machine, cut = MACHINES[name]
    basis = command_basis(Task(machine, cut, FREE), "in_sync")
    inside = basis.profile(np.zeros(basis.matrix.shape[1]))(basis.nodes[4:-5] + 1e-6, 2)
    assert np.abs(inside).max() <= 1e-6
