"""Messages of the lower floors, worded for people who write job files."""

from __future__ import annotations

from dataclasses import replace

import pytest

from camwright import load_job, optimise
from camwright.jobs.wording import error_words, in_job_words, place_of, value_words, words
from camwright.profiles.errors import Covered, InfeasibleError, InputError, SolverError
from camwright.profiles.message import Message, Value

SHORT = Message(
    "{@machine.stroke} = {stroke}: too short; lengthen it to {longer}, or run {@line_speed} at {speed}",
    (("stroke", Value(0.1, "m")), ("longer", Value(0.105, "m", toward="above")), ("speed", Value(1.25, "m/s", 6))),
)


def test_a_message_is_plain_in_si_and_worded_as_in_a_job_file() -> None:
    assert str(SHORT) == "stroke = 0.1 m: too short; lengthen it to 0.105001 m, or run line speed at 1.25 m/s"
    assert words(SHORT) == (
        "[machine] stroke = 100 mm: too short; lengthen it to 105.001 mm, or run [cut] line_speed at 75 m/min"
    )
    assert words("as it is") == "as it is"


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (Value(1 / 3, "m"), "333.3333333 mm"),
        (Value(0.4, "m", toward="below"), "399.999 mm"),
        (Value(0.4, "m", toward="above"), "400.001 mm"),
        (Value(1.7, "rad", toward="above"), "97.403 deg"),
        (Value(1.7, "rad", toward="below"), "97.402 deg"),
        (Value(100.0, "rad/s", 6), "954.93 rpm"),
        (Value(30.0, "m/s^2", 6), "30 m/s^2"),
        (Value(0.5, ""), "0.5"),
    ],
)
def test_values_are_written_in_the_units_that_people_use(value: Value, text: str) -> None:
    assert value_words(value) == text


@pytest.mark.parametrize("number", [0.4, 0.399999, 12.3456, 1e-3])
def test_a_bound_that_does_not_work_itself_works_as_it_is_printed(number: float) -> None:
    assert float(Value(number, "m", toward="below").written(1.0, "")) < number
    assert float(Value(number, "m", toward="above").written(1.0, "")) > number


def test_a_machine_may_have_a_number_of_any_name() -> None:
    assert (place_of("length"), place_of("machine.length")) == ("[cut] length", "[machine] length")


def test_errors_that_leave_speak_of_the_job_file() -> None:
    with pytest.raises(InputError, match=r"\[machine\] stroke = 100 mm") as caught, in_job_words():
        raise InputError("first", SHORT)
    assert caught.value.faults == ("first", words(SHORT))
    covered = Covered((0.5, 1.0), ((0.1, 0.6), (0.5, 1.0)))
    with pytest.raises(InfeasibleError, match=r"^\[limits\] jerk binds$") as refused, in_job_words():
        raise InfeasibleError(Message("{@jerk} binds"), "jerk", None, "m/s^3", (), covered)
    assert (refused.value.binding, refused.value.unit, refused.value.covered) == ("jerk", "m/s^3", covered)
    assert error_words(SolverError("no answer")) == ("no answer",)


def test_a_refusal_of_a_job_names_its_tables() -> None:
    job = load_job()
    short = replace(job, cut=replace(job.cut, length=0.3))
    with pytest.raises(
        InfeasibleError, match=r"\[limits\] jerk 3000 m/s\^3 binds.*\[cut\] length 300 mm at \[cut\] line_speed 80"
    ):
        optimise(short)
