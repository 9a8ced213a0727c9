"""The virtual bender: random outlines bent by their written programs, and the comparison with the drawing."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from outlines import outline_of

from camwright.profiles.bender.compensation import compensate
from camwright.profiles.bender.division import (
    DivisionRule,
    EqualSides,
    EqualSteps,
    FewestBends,
)
from camwright.profiles.bender.nc_code import Numbering, read_program, write_program
from camwright.profiles.bender.outline import Outline
from camwright.profiles.bender.plan import BendPlan, plan_bends
from camwright.profiles.bender.program import NcProgram
from camwright.profiles.bender.springback import Springback
from camwright.profiles.errors import InputError
from camwright.validation.bender.virtual_bender import (
    BendingProof,
    bend,
    greatest_distance,
    prove,
)

RULES: list[DivisionRule] = [FewestBends(5e-5), EqualSides(25), EqualSteps(1e-3), FewestBends(5e-4)]
LEAST = math.radians(0.01)
RANGE = math.radians(168.0)


def written_and_proved(plan: BendPlan, table: Springback) -> tuple[NcProgram, BendingProof]:
    program = compensate(plan, table, "TEST")
    read = read_program(write_program(program, "fagor", Numbering(), 1000.0))
    return read, prove(read, plan, table)


def check(outline: Outline, rule: DivisionRule, table: Springback) -> None:
    plan = plan_bends(outline, rule, LEAST)
    assume((np.abs(plan.turns) < RANGE).all() and (outline.radii > 0.5e-3).all())
    program, proof = written_and_proved(plan, table)
    assert proof.deviation <= plan.chord_error + 5e-6
    if outline.closed:
        assert proof.closing_error is not None
        assert proof.closing_error <= 10e-6
    assert proof.rule_length == pytest.approx(plan.feeds.sum(), abs=1e-6 * len(program.feeds))


@settings(max_examples=60)
@given(seed=st.integers(0, 2**32 - 1), rule=st.sampled_from(RULES))
def test_random_outlines(seed: int, rule: DivisionRule, random_outline: Callable[[int], Outline], table: Springback):
    check(random_outline(seed), rule, table)


@pytest.mark.slow
@settings(max_examples=500, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), rule=st.sampled_from(RULES))
def test_500_random_outlines(
    seed: int, rule: DivisionRule, random_outline: Callable[[int], Outline], table: Springback
):
    check(random_outline(seed), rule, table)


def drawn(outline: Outline, spacing: float) -> np.ndarray:
    """Points along an outline, each arc turned about its centre."""
    parts = []
    for i, length in enumerate(outline.lengths):
        t = np.linspace(0, 1, math.ceil(length / spacing) + 1)
        if outline.arcs[i]:
            out, angle = outline.points[i] - outline.centres[i], t * outline.included[i]
            cos, sin = np.cos(angle), np.sin(angle)
            turned = np.stack([cos * out[0] - sin * out[1], sin * out[0] + cos * out[1]], axis=1)
            parts.append(outline.centres[i] + turned)
        else:
            parts.append(outline.points[i] + t[:, None] * (outline.points[i + 1] - outline.points[i]))
    return np.vstack(parts)


def test_deviation_against_nearest_points(random_outline: Callable[[int], Outline], table: Springback):
    from scipy.spatial import cKDTree

    spacing, compared = 5e-5, 0
    for seed in range(60):
        outline = random_outline(seed)
        plan = plan_bends(outline, FewestBends(2e-4), LEAST)
        if (np.abs(plan.turns) > RANGE).any() or not outline.arcs.any() or len(outline.bulges) > 8:
            continue
        _, proof = written_and_proved(plan, table)
        a, b = drawn(outline, spacing), drawn(outline_of(proof.points), spacing)
        # the nearest point may belong to another part of the outline, so brute force finds the same or less; its grid
        # of points adds at most a half of its spacing, square to the distance
        away = max(cKDTree(a).query(b)[0].max(), cKDTree(b).query(a)[0].max())
        assert away <= math.hypot(proof.deviation, spacing)
        assert away >= 0.7 * proof.deviation
        compared += 1
    assert compared >= 5


def test_a_wrong_angle_is_seen(table: Springback):
    outline = outline_of(np.array([[0, 0], [50, 0], [50, 40], [0, 40], [0, 0]]) * 1e-3)
    plan = plan_bends(outline, FewestBends(5e-5), LEAST)
    program = compensate(plan, table, "TEST")
    wrong = NcProgram("TEST", program.feeds, program.bends + np.array([0, 100, 0]))
    proof = prove(wrong, plan, table)
    turn = table.workpiece_angle(math.radians(wrong.bends[1] / 1e3)) - math.pi / 2
    # the last two sides turn about the second bend: the end lies at (-50, 0) mm from it, 40 mm down
    assert proof.closing_error == pytest.approx(turn * math.hypot(50e-3, 40e-3), rel=1e-2)
    assert proof.deviation >= 0.9 * proof.closing_error


def test_rounding_is_shared_by_both_ends_of_a_long_side(table: Springback):
    # one side of 1 m: half a thousandth of a degree is 8.7 µm at its end, 4.4 µm when shared
    outline = outline_of(np.array([[0, 0], [0, 100], [1000, 137], [1010, 260]]) * 1e-3)
    worst = 0.0
    for angle in np.linspace(0, 0.001, 23):
        turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
        points = outline.points.copy()
        points[2:] = (points[2:] - points[1]) @ turn.T + points[1]
        plan = plan_bends(outline_of(points), FewestBends(5e-5), LEAST)
        worst = max(worst, written_and_proved(plan, table)[1].deviation)
    assert worst <= 5e-6


def test_place_of_the_worst_deviation():
    outline = outline_of([[0, 0], [1, 0], [1, 1]])
    plan = plan_bends(outline, FewestBends(1e-3), LEAST)
    away, place = greatest_distance(np.array([[0, 0], [1.0, 0.25], [1, 1.0]]), plan)
    assert away == 0.25
    assert place.tolist() == [1.0, 0.25]


def test_joints_that_are_not_bent_are_compared():
    # three points nearly in line: no bend, and the rule passes 1 mm below the middle one
    outline = outline_of([[0, 0], [1, 0.001], [2, 0]])
    plan = plan_bends(outline, FewestBends(1e-3), math.radians(1.0))
    assert plan.bends == 0
    away, place = greatest_distance(np.array([[0, 0], [2.0, 0]]), plan)
    assert away == pytest.approx(1e-3)
    assert place == pytest.approx([1, 0])


def test_program_of_another_outline(table: Springback):
    plan = plan_bends(outline_of([[0, 0], [1, 0], [1, 1]]), FewestBends(1e-3), LEAST)
    other = NcProgram("OTHER", np.array([1, 1, 1]), np.array([1000, 1000]))
    with pytest.raises(InputError, match="OTHER has 2 bends, its outline needs 1"):
        bend(other, plan, table)
