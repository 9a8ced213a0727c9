"""The text of a job follows its numbers: the file's own while they are the file's, else written anew and read back bit by bit."""

from __future__ import annotations

import hashlib
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camwright import Job, load_job, optimise
from camwright.house.units import KINDS, quantity, quantity_text
from camwright.jobs.job import BUNDLED_JOB, parse_job
from camwright.jobs.numbers import job_numbers
from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.limits import Limits
from camwright.profiles.line import Line
from camwright.profiles.machines import CrankSlider, LinearCarriage, RotaryKnife
from camwright.profiles.motor import MotorCurve
from camwright.profiles.servo import Servo
from camwright.stored.design_file import parse_design
from camwright.stored.design_text import design_text

EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("*.toml"))
PAPER = BUNDLED_JOB.read_text(encoding="utf-8")


def anew(job: Job) -> Job:
    """Read a job again from a text that is not its file's."""
    without = replace(job, source=None)
    return parse_job(without.text, "again")


@pytest.mark.parametrize("file", [BUNDLED_JOB, *EXAMPLES], ids=lambda file: file.stem)
def test_a_text_written_anew_says_the_same_numbers(file: Path) -> None:
    job = load_job(file)
    assert job.text == file.read_text(encoding="utf-8")
    assert job.sha256 == hashlib.sha256(file.read_bytes()).hexdigest()
    again = anew(job)
    assert again.text != job.text
    assert repr(again) == repr(job)
    assert anew(again).text == again.text


def test_a_changed_job_writes_its_own_text() -> None:
    job = load_job()
    shorter = replace(job, cut=replace(job.cut, length=0.5))
    assert 'length = "500 mm"' in shorter.text
    assert parse_job(shorter.text, "") == shorter
    assert shorter.sha256 == hashlib.sha256(shorter.text.encode()).hexdigest() != job.sha256
    back = replace(shorter, cut=job.cut)
    assert (back.text, back.sha256) == (PAPER, job.sha256)


def test_what_is_saved_of_a_changed_job_agrees_with_itself() -> None:
    job = load_job()
    result = optimise(replace(job, cut=replace(job.cut, length=0.5)))
    stored = parse_design(design_text(result), "design.json")
    assert stored.job == result.job
    assert stored.job.cut.length == 0.5
    assert job_numbers(parse_job(stored.job.text, "")) == job_numbers(result.job)


def test_a_place_that_the_design_chose_leaves_the_text_as_it_was() -> None:
    job = load_job(next(file for file in EXAMPLES if not load_job(file).machine.placed))
    placed = replace(job, machine=job.machine.placed_at(1.7))
    assert placed.text == job.text
    other = replace(placed, cut=replace(placed.cut, length=1.01 * placed.cut.length))
    assert parse_job(other.text, "") == other
    assert other.machine.place == 1.7
    elsewhere = load_job()
    assert replace(job, machine=elsewhere.machine, limits=elsewhere.limits).text != job.text


@pytest.mark.parametrize(
    "change",
    [
        {"name": "other"},
        {"objective": "rms_jerk"},
        {"servo_aware": True},
        {"servo": Servo(121.0, 0.7, 35.0, 0.004, 1.0)},
        {"output": replace(load_job().output, points=100)},
        {"limits": replace(load_job().limits, motor=MotorCurve(((0.0, 12.0), (100 * math.pi, 8.0))))},
        {"machine": RotaryKnife(0.4, drum_inertia=0.1 + 0.2)},
        {"cut": replace(load_job().cut, origin="cut")},
        {"line": Line(1.0, 5.0, 50.0)},
        {"line": Line(stop=1 / 3)},
    ],
    ids=lambda change: next(iter(change)),
)
def test_every_part_of_a_job_is_in_its_text(change: dict[str, Any]) -> None:
    job = replace(load_job(), **change)
    if "limits" in change:
        job = replace(job, machine=RotaryKnife(0.4, drum_inertia=0.05))
    assert parse_job(job.text, "") == job
    assert job.text != PAPER


@settings(max_examples=300, deadline=None)
@given(
    length=st.floats(0.3, 3.0),
    share=st.floats(0.01, 0.4),
    inside=st.just(0.0) | st.floats(1e-6, 1.0),
    late=st.sampled_from([0.0, 0.3, 1.0]),
    speed=st.floats(0.01, 3.0),
    limit=st.floats(3.1, 90.0),
    gain=st.floats(1.0, 40.0),
    tolerance=st.floats(1e-6, 1e-2),
)
def test_any_numbers_are_read_back_bit_by_bit(
    length: float, share: float, inside: float, late: float, speed: float, limit: float, gain: float, tolerance: float
) -> None:
    zone = share * min(length, 0.4)
    shear = inside * zone
    cut = Cut(length, speed, zone, shear, late * (zone - shear) if zone - shear > 1e-6 else 0.0, tolerance)
    job = replace(
        load_job(),
        cut=cut,
        limits=Limits(limit, 1e3 / 7 * limit, 1e5 * limit),
        servo=Servo(119.3, 0.7, gain, 0.001, 0.9),
    )
    assert parse_job(job.text, "") == job


@given(st.sampled_from(sorted(KINDS)), st.floats(0.0, 1.0))
def test_a_quantity_is_read_back_bit_by_bit(kind: str, share: float) -> None:
    of = KINDS[kind]
    value = of.least * (of.greatest / of.least) ** share
    value = min(max(value, of.least), of.greatest)
    assert quantity(quantity_text(value, kind), kind) == value
    assert quantity(quantity_text(-value, kind), kind, signed=True) == -value


def test_round_numbers_stay_round() -> None:
    assert quantity_text(0.0, "length") == "0 mm"
    assert quantity_text(200 / 60, "speed") == "200 m/min"
    assert quantity_text(100 * math.pi, "angular rate", "3000 rpm") == "3000 rpm"


CRANK = CrankSlider(0.15, 0.6, 0.0, 0.5, 20.0, 5.0)
TABLES: dict[str, Any] = {
    "machine": {"kind": "rotary_knife", "circumference": "400 mm"},
    "cut": {"length": "600 mm", "line_speed": "80 m/min", "sync_zone": "200 mm", "shear_zone": "40 mm"},
    "limits": {"speed": "200 m/min", "acceleration": "30 m/s^2", "jerk": "3000 m/s^3"},
    "servo": {
        "bandwidth": "120 rad/s", "damping": 0.7, "position_gain": "35 1/s", "sample_time": "4 ms", "velocity_feedforward": 1.0,
    },
}  # fmt: skip


def test_a_job_of_tables_is_that_of_the_file() -> None:
    assert Job.of("paper-600", **TABLES) == load_job()


def test_si_numbers_name_their_unit() -> None:
    job = Job.of(
        "paper-600",
        machine={"kind": "rotary_knife", "circumference_m": 0.4},
        cut={"length_m": 0.6, "line_speed_m_per_s": 80 / 60, "sync_zone_m": 0.2, "shear_zone_m": 0.04},
        limits={"speed_m_per_s": 200 / 60, "acceleration_m_per_s2": 30, "jerk_m_per_s3": 3000},
        servo={
            "bandwidth_rad_per_s": 120, "damping": 0.7, "position_gain_per_s": 35.0, "sample_time_s": 0.004,
            "velocity_feedforward": 1.0,
        },
    )  # fmt: skip
    assert job == load_job()


def test_objects_are_taken_as_they_are() -> None:
    paper = load_job()
    assert Job.of("paper-600", paper.machine, paper.cut, paper.limits, paper.servo) == paper
    shaped = replace(paper.cut, shaped=True, origin="cut")
    job = Job.of("shaped", paper.machine, shaped, paper.limits, paper.servo, "sync_error")
    assert (job.cut, job.objective, job.servo_aware, job.command) == (shaped, "sync_error", True, "shaped")
    cut = Cut(0.9, 1.0, 0.2, 0.04, 0.1, 1e-4)
    crank = Job.of("crank", CRANK, cut, Limits(60.0, 2000.0, 4e5), paper.servo, "rms_torque")
    assert (crank.limits, crank.machine.kind, crank.machine.placed) == (
        Limits(60.0, 2000.0, 4e5),
        "crank_slider",
        False,
    )
    saw = Job.of(
        "saw", LinearCarriage(1.2, mass=30.0), cut, Limits(3.0, 20.0, 500.0), paper.servo, output={"points": 100}
    )
    assert (saw.machine, saw.output.points) == (LinearCarriage(1.2, mass=30.0), 100)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        (
            {"cut": {**TABLES["cut"], "length": "600 kg"}},
            "mine: [cut] length = '600 kg': a mass, but a length is expected",
        ),
        ({"cut": {**TABLES["cut"], "length": 600}}, "mine: [cut] length = 600: a number without a unit"),
        ({"cut": {**TABLES["cut"], "length_m": 0.6}}, "mine: [cut] length_m: given twice, as length and as length_m"),
        (
            {"cut": {**TABLES["cut"], "sync_tolerance_m": "0.1 mm"}},
            "mine: [cut] sync_tolerance_m = '0.1 mm': the key names its unit; give it a number of m, or write sync_tolerance = \"0.1 mm\"",
        ),
        (
            {"servo": {"bandwidth_rad_per_s": "x"}},
            "mine: [servo] bandwidth_rad_per_s = 'x': the key names a unit, which belongs to the value; write e.g. bandwidth = ",
        ),
        ({"machine": RotaryKnife(0.1)}, "mine: [cut] sync_zone = 200 mm: not below [machine] circumference = 100 mm"),
        ({"limits": {**TABLES["limits"], "speed_m_per_s": -1.0}}, "mine: [limits] speed_m_per_s: given twice"),
        ({"servo": {"bandwith": "1 rad/s"}}, "mine: [servo] bandwith: there is no such key; did you mean bandwidth?"),
    ],
)
def test_faults_of_a_job_made_in_python_are_those_of_a_file(changed: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError) as caught:
        Job.of("mine", **{**TABLES, **changed})
    assert any(fault.startswith(message) for fault in caught.value.faults), caught.value.faults


def test_the_command_follows_the_cut_and_a_shaped_one_is_servo_aware() -> None:
    job = load_job()
    shaped = replace(job, servo_aware=True, cut=replace(job.cut, shaped=True))
    assert (shaped.command, shaped.task.cut.shaped) == ("shaped", True)
    assert parse_job(shaped.text, "job.toml") == shaped
    assert replace(shaped, cut=replace(shaped.cut, shaped=False)).command == "in_sync"
    # it is one fact: what does not exist cannot be left behind
    with pytest.raises(TypeError, match="command"):
        replace(job, servo_aware=True, command="shaped")
    for change in (lambda: replace(job, cut=shaped.cut), lambda: replace(shaped, servo_aware=False)):
        with pytest.raises(
            InputError, match="a shaped command, which is for servo-aware designs only; give servo_aware=True"
        ):
            change()
