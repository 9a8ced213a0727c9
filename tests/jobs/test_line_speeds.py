"""The line speeds of a servo-aware job: what is read, what is written again, every fault with its way out."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camwright.jobs.job import Job, load_job, parse_job
from camwright.profiles.errors import InputError

SHORT = (Path(__file__).parents[2] / "examples" / "short-cut.toml").read_text(encoding="utf-8")


def asked(line_speeds: str) -> Job:
    """Read the short cut with other line speeds."""
    lines = [line for line in SHORT.splitlines() if not line.startswith("line_speeds")]
    return parse_job("\n".join(lines).replace("servo_aware = true", f"servo_aware = true\n{line_speeds}"), "job")


@pytest.mark.parametrize(
    ("text", "slowest"),
    [
        ("", 0.1),
        ('line_speeds = "80 m/min"', 1.0),
        ('line_speeds = "100 %"', 1.0),
        ('line_speeds = ["100 %"]', 1.0),
        ('line_speeds = ["8 m/min", "80 m/min"]', 0.1),
        ('line_speeds = ["20 %", "100 %"]', 0.2),
        ('line_speeds = ["20 %", "80 m/min"]', 0.2),
        ('line_speeds = ["80 m/min", "80 m/min"]', 1.0),
        ('line_speeds = ["1 %", "100 %"]', 0.01),
    ],
)
def test_line_speeds_are_read(text: str, slowest: float) -> None:
    job = asked(text)
    assert job.slowest == pytest.approx(slowest, rel=1e-12)
    assert job.line_speeds == (job.slowest * job.cut.line_speed, job.cut.line_speed)


def test_a_servo_blind_job_has_one_line_speed() -> None:
    assert load_job().slowest == 1.0


@settings(max_examples=100, deadline=None)
@given(st.floats(0.01, 1.0))
def test_they_are_written_so_that_the_same_are_read(slowest: float) -> None:
    job = replace(asked(""), slowest=slowest)
    assert parse_job(job.text, "") == job


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            'line_speeds = ["8 m/min", "60 m/min"]',
            r'"60 m/min" is not \[cut\] line_speed = 80 m/min, .*; write "100 %"',
        ),
        ('line_speeds = "8 m/min"', r'"8 m/min" is not \[cut\] line_speed'),
        ('line_speeds = ["90 m/min", "80 m/min"]', "the range is upside down; give its lower end first"),
        ('line_speeds = ["0.5 %", "100 %"]', r"is 0.5 % of \[cut\] line_speed = 80 m/min, below 1 %; begin at 1 %"),
        ('line_speeds = ["8 m", "80 m/min"]', r"or a percentage of \[cut\] line_speed"),
        ("line_speeds = 8", 'neither a line speed nor the two ends of a range; write e.g. \\["10 %", "100 %"\\]'),
        ('line_speeds = ["8 m/min", "40 m/min", "80 m/min"]', "neither a line speed nor the two ends of a range"),
        ("line_speeds = []", "neither a line speed nor the two ends of a range"),
    ],
)
def test_line_speeds_that_cannot_be_are_refused(text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        asked(text)


def test_a_servo_blind_job_refuses_them() -> None:
    text = load_job().text.replace("[objective]", '[objective]\nline_speeds = "100 %"')
    with pytest.raises(
        InputError, match="for servo-aware designs only; add servo_aware = true or leave line_speeds out"
    ):
        parse_job(text, "job")
