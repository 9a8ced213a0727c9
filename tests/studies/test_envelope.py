"""Edges of the envelope: nodes are found until what is drawn between them is true, jumps and bends too."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from camwright import load_job
from camwright.design.feasible.envelope import Envelope
from camwright.profiles.machines import RotaryKnife
from camwright.studies.envelope import (
    CLOSEST,
    FINE,
    FINEST,
    Edge,
    EnvelopeAnswer,
    _expected,
    _nodes,
    at_jump,
    envelope_answer,
    followed_edge,
    true_edge,
)
from camwright.studies.reach import TOLERANCE, Verdict, _edge, stand_in, verdict

EXAMPLES = Path(__file__).parents[2] / "examples"

LENGTHS = [1.0, 2.0, 3.0, 4.0]


def bend(length: float) -> float:
    """Level, then falling: bent where the line from 2 to 3 has its middle on the edge."""
    fall = 0.4 * (1.0 - math.exp(-2.0 * (length - 2.4)))
    return 3.0 if length < 2.4 else 3.0 - fall


def crossing_in_the_middle(length: float) -> float:
    """Level to 2.25, then convex: the middle of the first part lies on the line between its ends, and nothing else."""
    if length <= 2.25:
        return 1.0
    at = (length - 2.25) / 0.75
    return 1.0 - 0.1 * at * (1.0 - (1.0 - 1.5) * (1.0 - at)) if length <= 3.0 else 0.9


SHAPES: dict[str, Callable[[float], float]] = {
    "straight": lambda length: 2.0 - 0.3 * length,
    "bent": bend,
    "crossing": crossing_in_the_middle,
    "cusp": lambda length: 3.0 - 0.8 * math.sqrt(abs(length - 2.6)),
    "jump down": lambda length: 3.0 if length < 2.347 else 2.0,
    "jump up": lambda length: 2.0 - 0.1 * length if length < 2.347 else 3.0,
}


def drawn(edge: Edge, length: float) -> float:
    """Read an edge as it is drawn; at an upright part the lower end."""
    lengths, speeds = (np.array(each) for each in zip(*edge, strict=True))
    return float(np.interp(length, lengths, speeds))


@pytest.mark.parametrize("finest", [FINE, FINEST])
@pytest.mark.parametrize("name", SHAPES)
def test_what_is_drawn_is_true_within_a_percent(name: str, finest: float) -> None:
    shape = SHAPES[name]
    edge = true_edge(lambda length, _: shape(length), LENGTHS, finest)
    assert [length for length, _ in edge] == sorted(length for length, _ in edge)
    for length in np.random.default_rng(1).uniform(1.0, 4.0, 3000).tolist():
        within = [shape(length * (1 + aside)) for aside in (-FINEST, 0.0, FINEST)]  # how far a jump may be off
        assert 0.99 * min(within) <= drawn(edge, length) <= 1.01 * max(within), length


@pytest.mark.parametrize("name", ["jump down", "jump up"])
def test_a_jump_is_drawn_upright_with_two_nodes_of_one_length_and_nothing_impossible(name: str) -> None:
    shape = SHAPES[name]
    edge = true_edge(lambda length, _: shape(length), LENGTHS, FINE)
    (upright,) = [(a, b) for a, b in itertools.pairwise(edge) if a[0] == b[0]]
    assert abs(upright[0][0] / 2.347 - 1) <= FINEST
    for length in np.linspace(2.346, 2.348, 2001).tolist():
        if length != upright[0][0]:
            assert drawn(edge, length) <= shape(length) * (1 + FINEST)


def test_an_edge_ends_where_nothing_works() -> None:
    edge = true_edge(lambda length, _: None if length > 2.3 else 1.0, LENGTHS, FINE)
    last = max(length for length, speed in edge if not math.isnan(speed))
    first = min(length for length, speed in edge if math.isnan(speed))
    assert 0 < first - last <= FINE * first
    assert last <= 2.3 < first


KINKED: dict[str, Callable[[float], float]] = {
    "power": lambda length: 0.5 * length**1.7,
    "kink": lambda length: min(0.5 * length**3, 2.0),
    "dent": lambda length: 2.0 + abs(length - 2.3),
    "jump": lambda length: 2.0 if length < 2.347 else 3.0,
}


@pytest.mark.parametrize("name", sorted(KINKED))
def test_an_edge_that_is_followed_with_few_designs_is_never_drawn_too_high(name: str) -> None:
    shape, asked = KINKED[name], [0]

    def near(length: float, speed: float) -> bool:
        asked[0] += 1
        return abs(speed / shape(length) - 1.0) <= 5e-3

    edge = followed_edge(lambda length, _: shape(length), near, LENGTHS, CLOSEST)
    assert [length for length, _ in edge] == sorted(length for length, _ in edge)
    assert asked[0] == 3 if name == "power" else asked[0] <= 40
    for length in np.random.default_rng(1).uniform(1.0, 4.0, 3000).tolist():
        beside = [shape(length * (1 + aside)) for aside in (-CLOSEST, 0.0, CLOSEST)]
        assert 0.99 * min(beside) <= drawn(edge, length) <= 1.01 * shape(length), length


Asked = Callable[[float], Verdict]


def steep(share: float, form: str) -> Asked:
    """Fail beyond a share, by how much in one form or another."""

    def judged(at: float) -> Verdict:
        off = {
            "sign": math.copysign(math.inf, at - share),
            "line": 30.0 * (at - share) / share,
            "power": (at / share) ** 4 - 1.0,
        }[form]
        return ("settling", off) if at > share else ("", min(off, 0.0))

    return judged


@pytest.mark.parametrize("share", [0.03, 0.4, 0.875, 0.9999])
@pytest.mark.parametrize("near", [None, 0.02, 0.4, 0.4001, 0.8, 0.999, 1.2])
@pytest.mark.parametrize("form", ["sign", "line", "power"])
def test_an_edge_is_found_from_wherever_it_is_expected(share: float, near: float | None, form: str) -> None:
    asked: list[float] = []

    def judged(at: float) -> Verdict:
        asked.append(at)
        return steep(share, form)(at)

    found, failed = _edge(judged, 0.02, 1e-3, near)
    assert failed in ("settling", TOLERANCE)
    assert found is not None
    assert share / (1 + 1e-3) <= found <= share
    assert len(asked) <= 30
    if form != "sign" and near is not None and near < 1 and abs(near / share - 1) < 1e-3:
        assert len(asked) <= 6


@pytest.mark.parametrize("near", [None, 0.3, 0.9999])
def test_the_edge_of_the_perfect_axis_is_the_end(near: float | None) -> None:
    assert _edge(lambda _: ("", -math.inf), 0.02, 1e-3, near) == (1.0, "")
    assert _edge(lambda _: ("settling", math.inf), 0.02, 1e-3, near) == (None, "settling")


def test_the_next_node_is_expected_where_a_power_of_the_length_goes_on() -> None:
    expected: list[float] = []

    def asked(length: float, near: float) -> float:
        expected.append(near)
        return 0.3 * length**1.5

    _nodes(asked, LENGTHS)
    assert math.isnan(expected[0])
    assert expected[1:] == pytest.approx([0.3, 0.3 * 3.0**1.5, 0.3 * 4.0**1.5])


@pytest.mark.parametrize("speed", [0.5, 2.0])
def test_two_nodes_beside_a_jump_expect_nothing_beyond_all_measure(speed: float) -> None:
    assert _expected([(1.0, 1.0), (1.0 + 1e-9, speed)], 2.0) == speed
    assert speed / 20.0 < _expected([(1.0, 1.0), (1.02, speed)], 2.0) < speed * 20.0


@pytest.mark.parametrize("steep", [9.0, 15.0])
def test_an_edge_that_is_followed_takes_few_steps(steep: float) -> None:
    for near in (0.79, 0.8, 0.81):
        asked: list[float] = []

        def judged(at: float, asked: list[float] = asked) -> Verdict:
            asked.append(at)
            return ("settling" if at > 0.8 else ""), 12.0 * math.log(at / 0.8)

        found, _ = _edge(judged, 0.02, 7e-3, near, steep)
        assert found is not None
        assert 0.8 / (1 + 7e-3) <= found <= 0.8
        assert len(asked) <= 4


def test_an_edge_jumps_between_two_nodes_where_no_power_of_the_length_joins_them() -> None:
    assert at_jump({1.0: 2.0, 1.01: 3.0}, 1.005) == (2.0, 3.0)
    assert at_jump({1.0: 3.0, 1.01: 2.0}, 1.005) == (2.0, 3.0)
    assert at_jump({1.0: 2.5, 1.0006: 2.65}, 1.0003) == (2.5, 2.65)
    assert at_jump({1.0: 2.0, 1.01: 2.05}, 1.005) is None
    assert at_jump({1.0: 2.0, 1.5: 3.0}, 1.2) is None
    assert at_jump({1.0: 2.0, 1.01: None}, 1.005) is None
    assert at_jump({1.0: 2.0}, 1.2) is None


@pytest.mark.slow
def test_the_upper_end_of_a_hole_is_no_edge() -> None:
    """Of this knife the line speeds from 2.512 to 2.566 m/s miss the tolerance at 338.136 mm, those above to 2.645 m/s keep it."""
    job = load_job(EXAMPLES / "paper-600.toml")
    pitch, length = 0.3645689707371624, 0.3381358014423443
    cut = replace(
        job.cut,
        length=0.6313926366198452,
        line_speed=1.1178345039313426,
        sync_zone=0.4 * pitch,
        shear_zone=0.08 * pitch,
        shear_zone_at=0.32 * pitch,
        sync_tolerance=3e-4,
    )
    limits = replace(job.limits, acceleration=54.41847076991139, jerk=13497.499388397851)
    servo = replace(job.servo, position_gain=35.233356437314995, sample_time=1e-3)
    job = replace(job, machine=RotaryKnife(pitch), cut=cut, limits=limits, servo=servo)
    edge = drawn(envelope_answer(job, 7).within, length)
    for factor, passes in ((0.99, True), (1.01, False)):
        there = job.task.with_length(length).designed_at(factor * edge)
        assert (not verdict(job, there, stand_in(job))[0]) is passes


@pytest.mark.parametrize(("name", "sampled"), [("paper-600", False), ("chasing-shear", True), ("ramping-line", False)])
def test_an_edge_that_is_found_at_the_lengths_of_the_map_alone_says_so(name: str, sampled: bool) -> None:
    answer = EnvelopeAnswer(load_job(EXAMPLES / f"{name}.toml"), "peak_acceleration", Envelope((), ()), (), (), ())
    assert answer.to_dict()["axis_in_tolerance_at_lengths_only"] is sampled
