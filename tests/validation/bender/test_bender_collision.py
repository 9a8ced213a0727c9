"""Where a polyline meets itself, and where the bent part meets the mould or the rule to come."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camwright.profiles.bender.nearby import BoxTree, crossings
from camwright.profiles.errors import InputError
from camwright.validation.bender.collision import MOST_REPORTED, MouldEnvelope, collisions

ENVELOPE = MouldEnvelope(np.array([0.0, 0.03, 0.12]), np.array([0.0, 0.005, 0.005]), 0.7e-3)


def bent(feeds: list[float], turns: list[float]) -> tuple[np.ndarray, np.ndarray]:
    heading = np.radians(np.concatenate([[0.0], np.cumsum(turns)]))
    steps = np.array(feeds)[:, None] * 1e-3 * np.stack([np.cos(heading), np.sin(heading)], axis=1)
    return np.vstack([[0, 0], np.cumsum(steps, axis=0)]), np.radians(turns)


@given(st.integers(0, 10**6), st.integers(2, 60))
def test_crossings_against_every_pair(seed: int, count: int):
    points = np.cumsum(np.random.default_rng(seed).normal(size=(count, 2)), axis=0)

    def side(p: np.ndarray, q: np.ndarray, r: np.ndarray) -> bool:
        return (q[0] - p[0]) * (r[1] - p[1]) > (q[1] - p[1]) * (r[0] - p[0])

    naive = [
        (i, j)
        for i in range(count - 1)
        for j in range(i + 2, count - 1)
        if side(points[i], points[i + 1], points[j]) != side(points[i], points[i + 1], points[j + 1])
        and side(points[j], points[j + 1], points[i]) != side(points[j], points[j + 1], points[i + 1])
    ]
    first, second, _ = crossings(points, 0.0)
    assert list(zip(first.tolist(), second.tolist(), strict=True)) == naive


def test_place_of_a_crossing_and_contact_at_the_ends():
    points = np.array([[0.0, 0], [2, 0], [2, 1], [1, 1], [1, -1]])
    assert crossings(points, 1e-6)[2].tolist() == [[1.0, 0.0]]
    closed = np.array([[0.0, 0], [2, 0], [2, 1], [0, 1], [0, -1e-9]])  # its end pokes through its start by a nanometre
    assert len(crossings(closed, 0.0)[2]) in (0, 1)
    assert len(crossings(closed, 1e-6)[2]) == 0


@given(st.integers(0, 10**6), st.integers(1, 40))
def test_candidates_contain_every_box_in_the_region(seed: int, count: int):
    random = np.random.default_rng(seed)
    points = np.cumsum(random.normal(size=(count + 1, 2)), axis=0)
    low, high = np.sort(random.normal(scale=3, size=(2, 2)), axis=0)
    normals = np.array([[[1.0, 0], [-1, 0], [0, 1], [0, -1]]])
    offsets = np.array([[high[0], -low[0], high[1], -low[1]]])
    before = int(random.integers(0, count + 1))
    _, sides = BoxTree.over(points).inside(normals, offsets, np.array([before]))
    boxes = [
        i
        for i in range(before)
        if (np.minimum(points[i], points[i + 1]) <= high).all() and (np.maximum(points[i], points[i + 1]) >= low).all()
    ]
    assert sorted(sides.tolist()) == boxes


@pytest.mark.parametrize("turn", np.linspace(0, 6, 13).tolist())
def test_passing_through_a_vertex_or_touching_at_one_counts(turn: float):
    c, s = math.cos(turn), math.sin(turn)
    for last in ([10, -20], [14, 20]):
        points = np.array([[0, 0], [20, 0], [20, 30], [10, 30], [10, 0], last]) @ np.array([[c, s], [-s, c]])
        assert crossings(points, 1e-6)[2] == pytest.approx(np.array([points[4]] * 2))


def test_an_open_angle_meets_nothing():
    points, moulds = bent([50, 50, 50], [60, -60])
    assert collisions(points, moulds, ENVELOPE) == ()


def test_a_hook_meets_the_mould():
    # 100 mm, then 40 mm across and back: the start lies beside the feed line, behind the third bend
    points, moulds = bent([100, 4, 200, 10], [90, 90, 30])
    hits = collisions(points, moulds, ENVELOPE)
    assert [(hit.bend, hit.what) for hit in hits][:1] == [(1, "mould")]
    assert hits[0].side == 0


def test_a_spiral_meets_the_rule_to_come():
    # the last corner turns the long rest of the rule through the first side, 150 mm behind the bend
    points, moulds = bent([100, 150, 60, 10, 400], [90, 90, 90, 5])
    hits = collisions(points, moulds, ENVELOPE)
    assert [(hit.bend, hit.side, hit.what) for hit in hits] == [(2, 0, "rule"), (3, 0, "rule")]


def test_a_large_square_closes_without_meeting_the_mould_and_a_small_one_does_not():
    points, moulds = bent([150, 300, 300, 300, 150], [90, 90, 90, 90])
    assert collisions(points, moulds, ENVELOPE) == ()
    points, moulds = bent([30, 60, 60, 60, 30], [90, 90, 90, 90])
    assert [hit.bend for hit in collisions(points, moulds, ENVELOPE)] == [3]


def test_brute_force_of_one_pose():
    # which bends hit, against points every 0.1 mm of the part in a mould drawn out by the feed
    random, hits = np.random.default_rng(6), 0
    for _ in range(150):
        count = int(random.integers(3, 9))
        points, moulds = bent(list(random.uniform(5, 60, count + 1)), list(random.uniform(-20, 84, count)))
        found = {hit.bend for hit in collisions(points, moulds, ENVELOPE) if hit.what == "mould"}
        for k in range(1, count):
            part = np.vstack([p + np.linspace(0, 1, 800)[:, None] * (q - p) for p, q in pairwise(points[: k + 1])])
            step = points[k + 2] - points[k + 1]
            along = step / math.hypot(*step)
            behind = (part - points[k + 1]) @ along
            beside = np.abs((part - points[k + 1]) @ np.array([-along[1], along[0]]))
            width = np.minimum(behind / 6, 0.005)
            reach = 0.12 + (math.hypot(*step) if k < count - 1 else 0.0)
            deep = (behind > 1e-4) & (behind < reach - 1e-4) & (beside < width - 1e-4)
            if deep.any():
                hits += 1
                assert k in found
    assert hits > 10


def test_report_ends():
    # a tight coil: every bend after the first turns meets something
    points, moulds = bent([2.0] * 401, [30.0] * 400)
    assert len(collisions(points, moulds, ENVELOPE)) == MOST_REPORTED


@pytest.mark.parametrize(
    ("distance", "width", "message"),
    [
        ([0, 0.03, 0.12], [0, 0.002, 0.02], "must be convex; row 2"),
        ([0.01, 0.03], [0, 0.002], "the first 0"),
        ([0, 0.03, 0.02], [0, 0.002, 0.002], "increasing"),
        ([0], [0], "rows"),
    ],
)
def test_envelope_refused(distance: list[float], width: list[float], message: str):
    with pytest.raises(InputError, match=message):
        MouldEnvelope(np.array(distance), np.array(width), 1e-3)


def test_a_mould_that_narrows_again_counts_with_its_greatest_width():
    narrowing = MouldEnvelope(np.array([0.0, 0.03, 0.06, 0.12]), np.array([0.0, 0.01, 0.01, 0.002]), 0.7e-3)
    blunt = MouldEnvelope(np.array([0.0, 0.03, 0.12]), np.array([0.0, 0.01, 0.01]), 0.7e-3)
    random, hits = np.random.default_rng(8), 0
    for _ in range(40):
        points, moulds = bent(list(random.uniform(5, 60, 9)), list(random.uniform(-20, 85, 8)))
        found = collisions(points, moulds, narrowing)
        assert found == collisions(points, moulds, blunt)
        hits += len(found)
    assert hits > 10
