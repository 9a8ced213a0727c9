"""Job files that are not TOML: the remedy stands in the message, with its line."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from camwright.bender.job import load_bender
from camwright.jobs.job import BUNDLED_JOB, parse_job
from camwright.profiles.errors import InputError

PAPER = BUNDLED_JOB.read_text(encoding="utf-8")
LINE = 1 + PAPER[: PAPER.index("length =")].count("\n")


@pytest.mark.parametrize(
    ("written", "remedy"),
    [
        ("length = 600 mm", 'a quantity stands in quotes; write length = "600 mm"'),
        ("length = 600mm  # cut", 'a quantity stands in quotes; write length = "600 mm"'),
        (
            "length = 600,5 mm",
            'a quantity stands in quotes and numbers have a decimal point; write length = "600.5 mm"',
        ),
        ("length = 80 m/min", 'a quantity stands in quotes; write length = "80 m/min"'),
        ("length = 0,6", "numbers have a decimal point; write length = 0.6"),
        ("length = ,6", "numbers have a decimal point; write length = 0.6"),
        ("length = 1,000", "write length = 1.000 for a fraction, length = 1000 for thousands"),
        ("length = “600 mm”", '“ is no quote of a job file; write length = "600 mm"'),
    ],
)
def test_the_remedy_stands_in_the_message(written: str, remedy: str, tmp_path: Path) -> None:
    text = re.sub(r"(?m)^length = .*$", lambda _: written, PAPER, count=1)
    told = rf"not TOML: line {LINE}: {re.escape(written[:20])}.*{re.escape(remedy)}"
    with pytest.raises(InputError, match=told):
        parse_job(text, "job.toml")
    file = tmp_path / "bender.toml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=told):
        load_bender(file)


@pytest.mark.parametrize("text", ["name = ", "[machine", "a = 1\na = 2", 'a = "x', "a = [1, 2", "a == 600 mm"])
def test_where_nothing_shows_what_was_meant_the_parser_speaks(text: str) -> None:
    with pytest.raises(InputError, match=r"not TOML: .*line [12]"):
        parse_job(text, "job.toml")
