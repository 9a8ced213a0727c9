"""Zones written as times: a flying punch's press is shut so long whatever the line does."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from camwright import Cut, optimise
from camwright.design.feasible.envelope import linear_speed, quintic_speed
from camwright.design.feasible.extremes import extremes
from camwright.design.feasible.feasibility import is_feasible
from camwright.jobs.job import Job, load_job, parse_job
from camwright.profiles.errors import InputError

EXAMPLES = Path(__file__).parents[2] / "examples"
PUNCH = (EXAMPLES / "flying-punch.toml").read_text(encoding="utf-8")


def punch(**keys: str) -> Job:
    """Read the punch with other lines."""
    text = PUNCH
    for key, value in keys.items():
        text, count = re.subn(rf"(?m)^{key} = .*$", f'{key} = "{value}"', text)
        assert count == 1, key
    return parse_job(text, "punch.toml")


def test_a_zone_is_as_long_as_the_line_runs_in_its_time() -> None:
    cut = punch(line_speed="120 m/min", sync_zone="40 ms", shear_zone="25 ms").cut
    assert (cut.sync_zone, cut.shear_zone) == (0.04 * 2.0, 0.025 * 2.0)
    assert cut.shear_zone_at == cut.sync_zone - cut.shear_zone
    assert (cut.sync_time, cut.shear_time, cut.timed) == (0.04, 0.025, True)


def test_the_closest_holes_and_the_least_acceleration_of_a_punch() -> None:
    job = punch(line_speed="120 m/min", length="460 mm", sync_zone="40 ms", shear_zone="40 ms")
    gap, time = 0.46, (0.46 - 0.08) / 2.0
    assert 4 * gap / time**2 == pytest.approx(50.97, abs=5e-3)
    with_jerk = optimise(replace(job, limits=replace(job.limits, acceleration=100.0)))
    # half of the way and of the time is a double S without constant speed: T/2 = a/J + a0' where G/2 = a (T/2)²/2 - a²(T/2)/(2 J)
    jerk, half = 5000.0, time / 2
    closed = 0.5 * jerk * (half - math.sqrt(half**2 - 4 * gap / (jerk * half)))
    assert closed == pytest.approx(58.07, abs=5e-3)
    assert with_jerk.objective == pytest.approx(58.07, abs=5e-3)
    assert with_jerk.profile.extrema(1)[0].value * 2.0 == pytest.approx(-2.84, abs=5e-3)
    assert extremes(job.task).min_cut_length == pytest.approx(0.7055, abs=5e-5)


def test_another_design_at_another_line_speed_has_the_zone_of_that_speed() -> None:
    cut = punch().cut
    slower = cut.designed_at(0.5 * cut.line_speed)
    assert slower.sync_zone == cut.sync_time * 0.5 * cut.line_speed  # type: ignore[operator]
    assert slower.shear_zone_at == slower.sync_zone - slower.shear_zone
    assert slower.designed_at(cut.line_speed) == cut


def test_the_same_cam_on_a_slower_line_keeps_its_zone_on_the_material() -> None:
    cut = punch().cut
    slower = replace(cut, line_speed=0.5 * cut.line_speed)
    assert slower.sync_zone == cut.sync_zone
    assert (slower.sync_time, slower.timed) == (None, False)


@given(st.floats(0.1, 3.0), st.floats(1e-3, 0.2), st.floats(0.0, 1.0), st.floats(0.2, 5.0))
def test_zones_follow_whatever_speed(speed: float, time: float, share: float, factor: float) -> None:
    zone = time * speed
    cut = Cut(1.0, speed, zone, share * zone, 0.0, 1e-4, sync_time=time)
    there = cut.designed_at(factor * speed)
    assert there.sync_zone == time * there.line_speed
    assert (
        0.0 <= there.shear_zone_at + there.shear_zone <= there.sync_zone * (1 + 1e-12) or share * zone > there.sync_zone
    )


def test_the_text_follows_the_numbers() -> None:
    job = punch(length="800 mm")
    faster = replace(job, cut=job.cut.designed_at(1.0))
    assert 'sync_zone = "120 ms"' in faster.text
    assert parse_job(faster.text, "") == faster
    fixed = replace(job, cut=replace(job.cut, line_speed=1.0))
    assert 'sync_zone = "180 mm"' in fixed.text
    assert parse_job(fixed.text, "") == fixed


def test_the_edges_are_those_of_zones_that_grow_with_the_speed() -> None:
    task = punch().task
    fastest = extremes(task).max_line_speed
    assert fastest is not None
    assert is_feasible(task.designed_at(fastest * (1 - 1e-9)))
    assert not is_feasible(task.designed_at(fastest * (1 + 1e-9)))
    kept = extremes(task.with_cut(replace(task.cut, sync_time=None, shear_time=None))).max_line_speed
    assert kept is not None
    assert kept < fastest if task.cut.line_speed > fastest else kept > fastest


@pytest.mark.parametrize("speed_of", [quintic_speed, linear_speed])
def test_baselines_have_the_zone_of_their_speed(speed_of: object) -> None:
    task = punch().task
    fastest = speed_of(task)  # type: ignore[operator]
    there = task.designed_at(fastest)
    fixed = there.with_cut(replace(there.cut, sync_time=None, shear_time=None))
    assert speed_of(fixed) == pytest.approx(fastest, rel=1e-9)  # type: ignore[operator]


def test_no_zone_is_longer_than_the_cut_at_any_speed() -> None:
    task = punch(sync_zone="120 ms").task
    assert not is_feasible(task.designed_at(0.75 / 0.12))


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("sync_zone", "500 ms", "[cut] sync_zone = 750 mm: not below [cut] length = 750 mm"),
        ("sync_zone", "-40 ms", "[cut] sync_zone = '-40 ms'"),
        ("sync_zone", "40 Hz", "[cut] sync_zone = '40 Hz'"),
        ("shear_zone", "130 ms", "[cut] shear_zone = 195 mm: above [cut] sync_zone = 180 mm"),
    ],
)
def test_refusals(key: str, value: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        punch(**{key: value})
    assert message in str(caught.value)


def test_where_the_shear_zone_begins_is_no_time() -> None:
    with pytest.raises(InputError, match=r"\[cut\] shear_zone_at = '10 ms'"):
        parse_job(PUNCH.replace("sync_tolerance", 'shear_zone_at = "10 ms"\nsync_tolerance'), "punch.toml")


def test_the_cross_sealers_zone() -> None:
    text = (EXAMPLES / "cross-sealer.toml").read_text(encoding="utf-8")
    job = parse_job(text.replace('circumference = "376 mm"', 'diameter = "120 mm"'), "sealer.toml")
    radius, angle = 0.06, math.radians(20.0)
    assert job.cut.sync_zone == pytest.approx(2 * radius * math.sin(angle), rel=1e-12)
    assert 1e3 * job.cut.sync_zone == pytest.approx(41.042, abs=5e-4)
    assert 1e3 * job.task.sync.advance == pytest.approx(41.888, abs=5e-4)
    assert float(job.task.sync(0.0, 1)) == pytest.approx(1.06418, abs=5e-6)


@pytest.mark.parametrize("factor", [0.98, 1.0, 1.05])
def test_the_jaws_are_faster_than_the_film_by_the_sync_ratio(factor: float) -> None:
    job = load_job(EXAMPLES / "cross-sealer.toml")
    task = job.task.with_cut(replace(job.cut, sync_ratio=factor))
    middle = 0.5 * task.cut.sync_zone
    assert float(task.sync(middle, 1)) == pytest.approx(factor, rel=1e-9)


@pytest.mark.parametrize(("time", "what"), [("-40 ms", "negative"), ("0 ms", "zero")])
@pytest.mark.parametrize("key", ["sync_zone", "shear_zone"])
def test_a_time_that_no_zone_can_last_is_refused_as_a_time(key: str, time: str, what: str) -> None:
    with pytest.raises(InputError, match=rf"{key} = '{time}': {what}; a time greater than zero is expected"):
        punch(**{key: time})
