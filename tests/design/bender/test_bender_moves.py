"""The bender's moves: shortest under their limits, overlapped where the mould is clear, settled in the servo."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camwright.design.bender.moves import (
    BenderDrive,
    Dwell,
    clearance,
    feed_delay,
    overlapped_table,
    sequential_table,
)
from camwright.profiles.bender.motion import double_s_moves, trapezoid_moves
from camwright.profiles.closed_forms.reach import fastest
from camwright.profiles.errors import InputError
from camwright.profiles.limits import Limits
from camwright.profiles.servo import Servo, closed_loop
from camwright.validation.bender.arrival import arrivals

DRIVE = BenderDrive(
    Limits(0.5, 5.0, 1000.0, True),
    Limits(*np.radians([720.0, 20_000.0, 4e6]).tolist(), True),
    8e-3,
    math.radians(2.5),
)
SERVO = Servo(500.0, 0.8, 100.0, 1e-3, 1.0)
NONE = Dwell()


@pytest.mark.parametrize("distance", [1e-5, 5e-4, 5e-3, 0.02, 0.049, 0.2, 2.0])
def test_double_s_is_ruckig_s_answer(distance: float):
    ruckig = pytest.importorskip("ruckig")
    limits = DRIVE.feed
    task = ruckig.InputParameter(1)
    task.target_position = [distance]
    task.max_velocity, task.max_acceleration, task.max_jerk = [limits.speed], [limits.acceleration], [limits.jerk]
    answer = ruckig.Trajectory(1)
    ruckig.Ruckig(1).calculate(task, answer)
    move = double_s_moves(np.array([distance]), limits)
    assert float(move.time[0]) == pytest.approx(answer.duration, rel=1e-9)
    t = np.linspace(0, answer.duration, 50)
    there = [answer.at_time(s)[0][0] for s in t]
    assert move.position(t[None, :])[0] == pytest.approx(there, abs=1e-9 * distance + 1e-15)


@given(st.floats(1e-6, 3.0))
def test_double_s_against_its_profile(distance: float):
    limits = DRIVE.feed
    move = double_s_moves(np.array([distance]), limits)
    profile = fastest(distance, limits.speed, limits.acceleration, limits.jerk).profile()
    t = np.linspace(0, profile.end, 33)
    assert move.position(t[None, :])[0] == pytest.approx(profile(t), abs=1e-11 * distance + 1e-16)
    assert float(move.distance[0]) == pytest.approx(distance, rel=1e-11)


@given(st.lists(st.tuples(st.floats(1e-5, 3.0), st.floats(0.0, 1.2)), min_size=1, max_size=8))
def test_reaching_inverts_the_position(pairs: list[tuple[float, float]]):
    distances, shares = np.array(pairs).T
    moves = double_s_moves(distances, DRIVE.feed)
    t = moves.reaching(shares * distances)
    at = moves.position(t[:, None])[:, 0]
    inside = shares < 1
    assert at[inside] == pytest.approx((shares * distances)[inside], abs=1e-9 * float(distances.max()))
    # never early: what must have been covered by then has been, but for rounding
    assert (at >= np.minimum(shares, 1.0) * distances * (1 - 1e-9) - 1e-15).all()
    assert t[shares > 1 + 1e-9] == pytest.approx(moves.time[shares > 1 + 1e-9])


def test_bends_alike_share_their_delay_and_others_do_not():
    # the same table whether bends are told apart one by one, or by what they have in common
    random = np.random.default_rng(1)
    kinds = random.integers(0, 3, (40, 3))
    feeds = np.concatenate([[0.02], np.array([2e-3, 8e-3, 0.05])[kinds[:, 0]]])
    moulds = np.radians(np.array([20.0, -60.0, 110.0])[kinds[:, 1]])
    turns = moulds * np.array([0.9, 0.95, 1.0])[kinds[:, 2]]
    table = overlapped_table(feeds, moulds, turns, DRIVE, NONE)
    for k in range(40):
        feed, bend = (
            double_s_moves(feeds[k + 1 : k + 2], DRIVE.feed),
            double_s_moves(np.abs(moulds[k : k + 1]), DRIVE.mould),
        )
        wait = float(feed_delay(feed, bend, np.abs(turns[k : k + 1]), DRIVE)[0])
        assert table.feed_start[k + 1] - table.return_start[k] == pytest.approx(wait, abs=1e-9)


@given(st.floats(1e-6, 3.0))
def test_trapezoid_against_closed_form(distance: float):
    v, a = DRIVE.feed.speed, DRIVE.feed.acceleration
    move = trapezoid_moves(np.array([distance]), DRIVE.feed)
    expected = distance / v + v / a if distance >= v * v / a else 2 * math.sqrt(distance / a)
    assert float(move.time[0]) == pytest.approx(expected, rel=1e-12)
    assert float(move.distance[0]) == pytest.approx(distance, rel=1e-12)


def test_sequential_table_adds_up():
    feeds, moulds = np.array([0.022, 0.022, 0.0125]), np.radians([90.0, -90.0])
    table = sequential_table(feeds, moulds, DRIVE, Dwell(0.01, 0.02))
    bend = float(trapezoid_moves(np.radians([90.0]), DRIVE.mould).time[0])
    feed = trapezoid_moves(feeds, DRIVE.feed).time
    assert table.total == pytest.approx(feed.sum() + 3 * 0.01 + 4 * (bend + 0.02))
    assert table.bend_start[0] == pytest.approx(feed[0] + 0.01)
    assert table.return_start[1] == pytest.approx(table.feed_start[1] + feed[1] + 0.01 + bend + 0.02)


@given(st.floats(2e-4, 0.2), st.floats(1.0, 150.0), st.floats(0.8, 1.0))
def test_the_overlapped_feed_stays_clear_of_the_finger(feed: float, mould: float, share: float):
    f, b = double_s_moves(np.array([feed]), DRIVE.feed), double_s_moves(np.radians([mould]), DRIVE.mould)
    turn = math.radians(mould) * share
    wait = float(feed_delay(f, b, np.array([turn]), DRIVE)[0])
    assert 0 <= wait <= float(b.time[0])
    t = np.linspace(0, float(b.time[0]), 4000)
    finger = math.radians(mould) - b.position(t[None, :])[0]
    fed = f.position((t - wait)[None, :])[0]
    fed[t < wait] = 0
    near = finger > DRIVE.play
    assert (
        fed[near]
        <= clearance(np.cos(finger[near]), np.sin(finger[near]), np.full(near.sum(), turn), DRIVE.finger_radius) + 1e-9
    ).all()
    # and it does not wait for long without need: 15 ms earlier it would meet the finger, or it starts with the return
    if wait > 0.015:
        early = f.position((t - wait + 0.015)[None, :])[0] * (t > wait - 0.015)
        assert (
            early[near]
            > clearance(np.cos(finger[near]), np.sin(finger[near]), np.full(near.sum(), turn), DRIVE.finger_radius)
        ).any()


def test_clearance_by_geometry():
    # finger on the axis: the radius; on the flank: nothing; half way up a right angle: r sin(45°) / sin(90°)
    angles = np.radians([0.0, 90.0, 45.0])
    assert clearance(np.cos(angles), np.sin(angles), np.full(3, math.pi / 2), 8e-3) == pytest.approx(
        [8e-3, 0, 8e-3 / math.sqrt(2)], abs=1e-12
    )
    # the flank of a bend by gamma begins at x and passes the finger: the finger is on its line at exactly the clearance
    gamma, phi = math.radians(60), math.radians(25)
    x = float(clearance(np.array([math.cos(phi)]), np.array([math.sin(phi)]), np.array([gamma]), 8e-3)[0])
    finger = 8e-3 * np.array([math.cos(phi), math.sin(phi)])
    assert math.atan2(finger[1], finger[0] - x) == pytest.approx(gamma)


@given(st.integers(0, 10**6), st.integers(0, 12))
def test_overlapped_table_keeps_the_order_of_the_moves(seed: int, count: int):
    random = np.random.default_rng(seed)
    feeds, moulds = random.uniform(2e-4, 0.1, count + 1), np.radians(random.uniform(-120, 120, count))
    dwell = Dwell(0.01, 0.02)
    table = overlapped_table(feeds, moulds, 0.95 * moulds, DRIVE, dwell)
    bend_end = table.bend_start + table.bends.time
    feed_end = table.feed_start + table.feeds.time + dwell.feed
    assert (table.return_start >= bend_end + dwell.mould - 1e-12).all()
    assert (table.feed_start[1:] >= table.return_start - 1e-12).all()
    return_end = table.return_start + table.bends.time
    assert (table.bend_start[1:] >= return_end[:-1] - 1e-12).all()
    # when the rule has arrived, the mould has moved through its play at most
    for k in range(count):
        moved = float(table.bends.take(np.array([k])).position(np.array([[feed_end[k] - table.bend_start[k]]]))[0, 0])
        assert moved <= DRIVE.play + 1e-9
    assert table.total >= float(feed_end[-1]) - 1e-12
    assert table.total <= sequential_table(feeds, moulds, DRIVE, dwell).total + 0.02 * (3 * count + 1)


def test_cycle_of_the_paper_s_fragment():
    feeds, moulds = np.full(11, 0.022), np.radians(np.full(10, 90.0))
    faster, paper = overlapped_table(feeds, moulds, moulds, DRIVE, NONE), sequential_table(feeds, moulds, DRIVE, NONE)
    assert faster.total < 0.85 * paper.total


def test_settling_against_a_plain_loop():
    moves = double_s_moves(np.array([0.001, 0.02, 0.2]), DRIVE.feed)
    found = arrivals(moves, SERVO, 1e-5)
    a, b = closed_loop(SERVO)
    for i in range(3):
        z, before, last, beyond, goal = np.zeros(3), 0.0, 0, 0.0, float(moves.distance[i])
        for k in range(2000):
            if abs(goal - z[2]) > 1e-5:
                last = k + 1
            beyond = max(beyond, z[2] - goal)
            command = float(moves.take(np.array([i])).position(np.array([[k * 1e-3]]))[0, 0])
            z = a @ z + b @ np.array([command, before])
            before = command
        assert found.settling[i] == pytest.approx(max(0.0, last * 1e-3 - float(moves.time[i])), abs=1e-12)
        assert found.overshoot[i] == pytest.approx(beyond, abs=1e-15)


def test_jerk_limited_moves_settle_no_later_than_trapezoids():
    distances = np.geomspace(2e-4, 0.2, 30)
    smooth = arrivals(double_s_moves(distances, DRIVE.feed), SERVO, 1e-5).settling
    sharp = arrivals(trapezoid_moves(distances, DRIVE.feed), SERVO, 1e-5).settling
    assert smooth.max() < sharp.max()


def test_velocity_feedforward_makes_the_feed_overshoot():
    moves = double_s_moves(np.geomspace(2e-4, 0.2, 30), DRIVE.feed)
    without = Servo(500.0, 0.8, 100.0, 1e-3, 0.0)
    assert arrivals(moves, SERVO, 1e-5).overshoot.max() > 1e-4
    assert arrivals(moves, without, 1e-5).overshoot.max() < 1e-9
    assert arrivals(moves, without, 1e-5).settling.max() < arrivals(moves, SERVO, 1e-5).settling.max()


def test_unstable_servo_is_refused():
    with pytest.raises(InputError, match="unstable"):
        arrivals(double_s_moves(np.array([0.01]), DRIVE.feed), Servo(500.0, 0.8, 3000.0, 1e-3, 1.0), 1e-5)


def test_time_at_constant_speed_is_left_out_without_a_change():
    # as many whole samples at 0.5 m/s lie between the two as the second is longer, and most of them are not looked at
    near, far = (arrivals(double_s_moves(np.array([d]), DRIVE.feed), SERVO, 1e-5) for d in (1.9, 30.0))
    assert far.settling == pytest.approx(near.settling, abs=1e-9)
    assert far.overshoot == pytest.approx(near.overshoot, rel=1e-6)
