"""`[line]` of a job file: what is read, what stands for what is left out, every fault with its way out."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from camwright import Job, load_job
from camwright.jobs.doubts import doubts
from camwright.jobs.job import BUNDLED_JOB, parse_job
from camwright.jobs.numbers import job_numbers
from camwright.profiles.errors import InputError
from camwright.profiles.line import Line

PAPER = BUNDLED_JOB.read_text(encoding="utf-8")
CRANK = (Path(__file__).parents[2] / "examples" / "chasing-shear.toml").read_text(encoding="utf-8")


def on_line(table: str, job: str = PAPER) -> Job:
    """Read a job with a table of its line."""
    return parse_job(f"{job}\n[line]\n{table}\n", "job")


@pytest.mark.parametrize(
    ("table", "line"),
    [
        ("", Line()),
        ('acceleration = "1 m/s^2"', Line(acceleration=1.0)),
        ('stop = "5 m/s^2"', Line(stop=5.0)),
        ('acceleration = "60 m/min/s"\nstop = "5000 mm/s^2"\njerk = "50 m/s^3"', Line(1.0, 5.0, 50.0)),
        ('acceleration = "1 ft/s^2"\njerk = "12 in/s^3"', Line(0.3048, None, 0.3048)),
    ],
)
@pytest.mark.parametrize("job", [PAPER, CRANK])
def test_the_line_is_read(table: str, line: Line, job: str) -> None:
    assert on_line(table, job).line == line


def test_a_job_without_has_a_line_that_keeps_its_speed() -> None:
    job = load_job()
    assert job.line == Line()
    assert not job.line.ramps
    assert "line" not in job_numbers(job)
    assert "[line]" not in replace(job, source=None).text


def test_what_is_left_out_is_stood_for() -> None:
    assert (Line(1.0).speeding, Line(1.0).braking, Line(1.0).hardest) == (1.0, 1.0, 1.0)
    assert (Line(1.0, 5.0).speeding, Line(1.0, 5.0).braking, Line(1.0, 5.0).hardest) == (1.0, 5.0, 5.0)
    assert (Line(5.0, 1.0).speeding, Line(5.0, 1.0).braking, Line(5.0, 1.0).hardest) == (5.0, 5.0, 5.0)
    assert (Line(stop=2.0).speeding, Line(stop=2.0).braking) == (0.0, 2.0)
    assert (Line().known_jerk, Line(jerk=7.0).known_jerk) == (0.0, 7.0)


@pytest.mark.parametrize(("deceleration", "length"), [(1.0, 0.889), (2.0, 0.444), (5.0, 0.178)])
def test_the_line_stops_within_half_the_square_of_its_speed(deceleration: float, length: float) -> None:
    speed = 80 / 60
    for line in (Line(stop=deceleration), Line(acceleration=deceleration), Line(0.1, deceleration)):
        assert line.stop_length(speed) == pytest.approx(speed**2 / (2 * deceleration), rel=1e-15)
        assert line.stop_length(speed) == pytest.approx(length, abs=5e-4)
    assert Line().stop_length(speed) is None


def test_numbers_of_the_line_are_the_task_s_too() -> None:
    job = on_line('acceleration = "1 m/s^2"')
    assert job.task.line == job.line
    assert job.task.at_speed(0.5).with_length(0.7).from_return().line == job.line
    assert job_numbers(job)["line"] == {"acceleration": 1.0, "stop": None, "jerk": None}
    assert job.task.with_line(Line()) == load_job().task


def test_python_gives_tables_and_objects() -> None:
    paper = load_job()
    parts = ("ramped", paper.machine, paper.cut, paper.limits, paper.servo)
    assert Job.of(*parts, line={"acceleration_m_per_s2": 1.0, "stop": "5 m/s^2"}).line == Line(1.0, 5.0)
    assert Job.of(*parts, line=Line(1.0, jerk=10.0)).line == Line(1.0, jerk=10.0)
    assert Job.of(*parts).line == Line()


@pytest.mark.parametrize(
    ("table", "told"),
    [
        ('jerk = "50 m/s^3"', "[line] jerk = 50 m/s^3: the line has no ramp whose jerk it could be; add [line] accel"),
        ("acceleration = 1", '[line] acceleration = 1: a number without a unit; write e.g. "1 m/s^2"'),
        ('acceleration = "0 m/s^2"', "[line] acceleration = '0 m/s^2': "),
        ('stop = "-5 m/s^2"', "[line] stop = '-5 m/s^2': "),
        ('stop = "5 m/s"', "[line] stop = '5 m/s': "),
        ('acceleration = "2 rad/s^2"', "[line] acceleration = '2 rad/s^2': "),
        ('ramp = "1 m/s^2"', "[line] ramp: "),
    ],
)
def test_faults_are_told_with_their_place(table: str, told: str) -> None:
    with pytest.raises(InputError) as error:
        on_line(table)
    (message,) = error.value.messages
    assert f"job: {told}" in str(message)


def test_an_inch_job_is_told_its_fault_in_feet() -> None:
    with pytest.raises(InputError, match=r"\[line\] jerk = 100 ft/s\^3: the line has no ramp"):
        on_line('jerk = "100 ft/s^3"', PAPER.replace('"600 mm"', '"24 in"'))


def test_a_slip_of_the_unit_is_doubted() -> None:
    (warning,) = doubts(on_line('acceleration = "1 mm/s^2"')).warnings
    assert warning.startswith("[line] acceleration = 1 mm/s^2: below what machines have, 0.01 m/s^2 to 50 m/s^2")
