"""Jobs that say by the drum's angle what others say along the blade circle, and by its diameter what others say by its circumference."""

from __future__ import annotations

import math
import re

import jsonschema
import numpy as np
import pytest

from camwright.jobs.job import BUNDLED_JOB, Job, parse_job
from camwright.jobs.structure import job_schema
from camwright.profiles.errors import InputError

PAPER = BUNDLED_JOB.read_text(encoding="utf-8")
TURN = 0.4


def job(text: str = PAPER, **changes: str) -> Job:
    """Read the paper's job with keys changed, or added below the key of the same name in another table."""
    for key, value in changes.items():
        text, found = re.subn(rf"(?m)^{key} = .*$", f'{key} = "{value}"', text, count=1)
        assert found, key
    return parse_job(text, "job.toml")


@pytest.mark.parametrize(
    ("written", "turns_per_second"),
    [
        ("500 rpm", 500 / 60),
        ("500 rev/min", 500 / 60),
        ("3000 deg/s", 3000 / 360),
        ("8 Hz", 8),
        ("52 rad/s", 26 / math.pi),
    ],
)
@pytest.mark.parametrize("blades", [1, 2, 3])
def test_a_drums_speed_is_the_edges_whatever_the_blades(written: str, turns_per_second: float, blades: int) -> None:
    text = PAPER.replace("[cut]", f"blades = {blades}\n\n[cut]", 1)
    text = re.sub(r"(?m)^(sync_zone|shear_zone) = .*$", r'\1 = "20 mm"', text)
    assert job(text, speed=written).limits.speed == pytest.approx(turns_per_second * TURN, rel=1e-15)


@pytest.mark.parametrize(
    ("key", "written", "radians"),
    [
        ("acceleration", "470 rad/s^2", 470.0),
        ("acceleration", "27000 deg/s^2", math.radians(27000)),
        ("acceleration", "75 rev/s^2", 150 * math.pi),
        ("acceleration", "4500 rpm/s", 150 * math.pi),
        ("jerk", "47000 rad/s^3", 47000.0),
        ("jerk", "7500 rev/s^3", 15000 * math.pi),
    ],
)
def test_acceleration_and_jerk_go_by_the_radius(key: str, written: str, radians: float) -> None:
    assert getattr(job(**{key: written}).limits, key) == pytest.approx(radians * TURN / (2 * math.pi), rel=1e-15)


def test_the_same_job_in_degrees_is_the_same_job() -> None:
    straight, turned = job(), job(sync_zone="180 deg", shear_zone="36 deg", speed="500 rpm")
    assert turned.cut.sync_zone == pytest.approx(straight.cut.sync_zone, rel=1e-14)
    assert turned.cut.shear_zone == pytest.approx(straight.cut.shear_zone, rel=1e-14)
    assert turned.cut.shear_zone_at == pytest.approx(straight.cut.shear_zone_at, rel=1e-14)


@pytest.mark.parametrize("sync", ["tangential", "horizontal"])
@pytest.mark.parametrize("at", [None, "10 deg", "12 mm"])
def test_the_blade_turns_by_the_angle_of_the_shear_zone(sync: str, at: str | None) -> None:
    text = PAPER.replace("[cut]", f'sync = "{sync}"\n\n[cut]', 1)
    if at is not None:
        text = text.replace("shear_zone =", f'shear_zone_at = "{at}"\nshear_zone =', 1)
    made = job(text, sync_zone="100 mm", shear_zone="25 deg", speed="400 m/min")
    profile, radius = made.machine.sync_profile(made.cut), TURN / (2 * math.pi)
    start = made.cut.shear_zone_at
    angles = np.array([profile(x) for x in (0.0, start, start + made.cut.shear_zone)]) / radius
    assert math.degrees(angles[2] - angles[1]) == pytest.approx(25.0, abs=1e-6)
    if at == "10 deg":
        assert math.degrees(angles[1] - angles[0]) == pytest.approx(10.0, abs=1e-6)
    elif at == "12 mm":
        assert start == 0.012
    else:
        assert start + made.cut.shear_zone == pytest.approx(made.cut.sync_zone, rel=1e-14)


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"shear_zone": "225 deg"}, r"\[cut\] shear_zone = 250 mm: above \[cut\] sync_zone = 200 mm"),
        (
            {"speed": "150 rpm"},
            r"\[limits\] speed = 150 rpm: below the 200 rpm that the knife needs in the sync zone.*run the line at 60",
        ),
        ({"speed": "500 kg"}, r"\[limits\] speed = '500 kg': a mass, but a speed is expected"),
        ({"jerk": "5 rad/s^2"}, r"\[limits\] jerk = '5 rad/s\^2': an angular acceleration, but a jerk is expected"),
    ],
)
def test_what_does_not_go_together_is_told(changes: dict[str, str], told: str) -> None:
    with pytest.raises(InputError, match=told):
        job(**changes)


def test_a_carriage_knows_no_angle() -> None:
    text = re.sub(
        r"(?ms)^\[machine\].*?^\[cut\]", '[machine]\nkind = "linear_carriage"\nstroke = "800 mm"\n\n[cut]', PAPER
    )
    with pytest.raises(InputError, match="an angle, which only a rotary_knife knows"):
        job(text, shear_zone="30 deg")
    with pytest.raises(InputError, match="the slave of a linear_carriage is counted in metres"):
        job(text, speed="300 rpm")


def test_a_diameter_gives_the_circumference() -> None:
    by_diameter = PAPER.replace('circumference = "400 mm"', 'diameter = "127.5 mm"')
    assert parse_job(by_diameter, "").machine.slave_turn == math.pi * 0.1275
    with pytest.raises(
        InputError,
        match=r'\[machine\] circumference: missing; add e.g. circumference = "400 mm", or diameter = "127 mm"',
    ):
        parse_job(PAPER.replace('circumference = "400 mm"', ""), "")
    both = PAPER.replace('circumference = "400 mm"', 'circumference = "400 mm"\ndiameter = "127 mm"')
    with pytest.raises(
        InputError,
        match=r"\[machine\] diameter: there is circumference too, which says the same; leave one of them out",
    ):
        parse_job(both, "")
    schema = job_schema()
    table = schema["$defs"]["RotaryKnifeTable"] | {"$defs": schema["$defs"]}
    knife = {"kind": "rotary_knife"}
    for good in ({"circumference": "400 mm"}, {"diameter": "127 mm"}):
        jsonschema.validate(knife | good, table)
    for bad in ({}, {"circumference": "400 mm", "diameter": "127 mm"}):
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate(knife | bad, table)
