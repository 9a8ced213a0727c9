"""Ten servos, recorded as people's scopes do: modulo, with a zero of its own, in dialects; the servo is that of the clean trace."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import RotaryKnife
from camwright.profiles.returns import baseline
from camwright.profiles.servo import PAPER_RANGES, Servo, sample_plant
from camwright.profiles.tables.text import decode
from camwright.profiles.tables.trace_csv import read_trace_csv
from camwright.profiles.task import Task
from camwright.profiles.trace import Trace
from camwright.validation.identify.colour import with_colour
from camwright.validation.identify.fit import Minimum
from camwright.validation.identify.identification import Identified, identify
from camwright.validation.identify.rounding import with_rounding

KNIFE = RotaryKnife(0.4173519)
CUT = Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4)
CYCLE = baseline("poly_3_4_5", Task(KNIFE, CUT, Limits(math.inf, math.inf, math.inf)))
NAMES = ("bandwidth", "damping", "position_gain", "sample_time", "dead_time")


def servo(number: int) -> Servo:
    random = np.random.default_rng(700 + number)
    loop = {name: float(random.uniform(*span)) for name, span in PAPER_RANGES.items()}
    return Servo(**loop, velocity_feedforward=1.0, dead_time=float(random.uniform(0.0, 4e-3)))


@cache
def clean(number: int) -> Trace:
    """Record a servo by a plain loop: 1.6 s at 1 kHz, 5 µm of noise, written to 0.1 µm."""
    what, random = servo(number), np.random.default_rng(number)
    clock = -1.0 - what.sample_time * random.random()
    whole = sample_plant(what, what.sample_time)
    times = 1e-3 * np.arange(1600)
    actual, row, before = np.empty(1600), 0, float(CYCLE((clock - what.delay) * CUT.line_speed, outside="repeat"))
    state = np.array([0.0, 0.0, before])
    for k in range(math.ceil((times[-1] - clock) / what.sample_time) + 1):
        start = clock + k * what.sample_time
        now = float(CYCLE((start - what.delay) * CUT.line_speed, outside="repeat"))
        held = what.position_gain * (now - state[2]) + (now - before) / what.sample_time
        while row < 1600 and times[row] < start + what.sample_time:
            plant = sample_plant(what, times[row] - start)
            actual[row] = plant.transition[2] @ state + plant.input[2] * held
            row += 1
        state, before = whole.transition @ state + whole.input * held, now
    command = np.asarray(CYCLE(times * CUT.line_speed, outside="repeat"))
    return Trace(0.0, 1e-3, np.round(command, 7), np.round(actual + random.normal(0.0, 5e-6, 1600), 7), "m")


def rows(trace: Trace, factor: float, digits: int) -> list[list[str]]:
    return [
        [f"{1e3 * t:.4f}", f"{factor * c:.{digits}f}", f"{factor * a:.{digits}f}"]
        for t, c, a in zip(trace.times, trace.command, trace.actual, strict=True)
    ]


def plain(trace: Trace) -> bytes:
    return "\n".join(["time [ms],command [mm],actual [mm]", *map(",".join, rows(trace, 1e3, 4))]).encode()


def spreadsheet(trace: Trace) -> bytes:
    body = [";".join(row).replace(".", ",") + ";" for row in rows(trace, 1e3, 4)]
    return "\r\n".join(["sep=;", "Aufzeichnung Messer", "Zeit;Sollposition;Istposition;", "ms;mm;mm;", *body]).encode(
        "utf-16"
    )


def scope(trace: Trace) -> bytes:
    head = [["Name", "SetPos", "Name", "ActPos"], ["Unit", "mm", "Unit", "mm"]]
    body = [[row[0], row[1], row[0], row[2]] for row in rows(trace, 1e3, 4)]
    return "\n".join("\t".join(cells) for cells in head + body).encode()


def scope_by_rates(trace: Trace) -> bytes:
    """One column of times a rate, times of day, a slower channel repeated, a channel drawn twice, decimal commas."""
    names = ["Name", "Axis.SetPos", "Axis.ActPos", "Axis.ActPos (1)", "Name", "Axis.Torque"]
    units = ["Unit", "(None)", "(None)", "(None)", "Unit", "Nm"]
    head = [
        ["Name", "YT Scope Project"],
        ["File", "C:\\run.svdx"],
        ["Starttime of export", "133238090039920000"],
        names,
        units,
    ]
    body = [
        [
            str(133238090039920000 + round(float(t) * 1e4)),
            c,
            a,
            a,
            str(133238090039920000 + k // 4 * 40000),
            f"{k // 4 % 7}.5",
        ]
        for k, (t, c, a) in enumerate(rows(trace, 1e3, 4))
    ]
    return (
        "\n".join("\t".join(cells) for cells in head + body).replace(".", ",").replace("Axis,", "Axis.") + "\nEOF\n"
    ).encode()


def chinese(trace: Trace) -> bytes:
    return "\n".join(
        [
            "序号,时间(ms),指令位置(mm),实际位置(mm)",
            *(f"{k},{','.join(row)}" for k, row in enumerate(rows(trace, 1e3, 4))),
        ]
    ).encode("gbk")


def drum_in_radians(trace: Trace) -> bytes:
    body = rows(trace, 2 * math.pi / KNIFE.circumference, 8)
    return "\n".join(["time (ms)\tcommand (rad)\tactual (rad)", *map("\t".join, body)]).encode()


DIALECTS: list[Callable[[Trace], bytes]] = [plain, spreadsheet, scope, chinese, drum_in_radians, scope_by_rates]


def modulo(trace: Trace) -> Trace:
    return replace(trace, command=trace.command % KNIFE.circumference, actual=trace.actual % KNIFE.circumference)


def other_zero(trace: Trace, by: float = 1.2345) -> Trace:
    return replace(trace, actual=trace.actual + by)


def found(data: bytes) -> Identified:
    return identify(read_trace_csv(decode(data, "t"), "t"), "t", 1.0)


@cache
def by_clean(number: int) -> Identified:
    return found(plain(clean(number)))


@cache
def by_near_zero(number: int) -> Identified:
    """Identify the clean trace with its zero a little off, so that a constant is fitted too: a lag looks like one, so it costs accuracy."""
    return found(plain(other_zero(clean(number), -0.01)))


@pytest.mark.slow
@pytest.mark.parametrize("number", range(10))
@pytest.mark.parametrize("kind", ["modulo", "other_zero", *[each.__name__ for each in DIALECTS[1:]]])
def test_the_servo_does_not_depend_on_how_it_was_recorded(number: int, kind: str) -> None:
    trace, expected = clean(number), by_near_zero(number) if kind == "other_zero" else by_clean(number)
    if kind == "modulo":
        data = DIALECTS[number % len(DIALECTS)](modulo(trace))
    elif kind == "other_zero":
        data = DIALECTS[number % 4](other_zero(trace))
    else:
        data = next(each for each in DIALECTS if each.__name__ == kind)(trace)
    again = found(data)
    for name in NAMES:
        low, high = expected.confidence[name]
        value = getattr(again.servo, name)
        assert value == pytest.approx(getattr(expected.servo, name), abs=0.02 * (high - low)), name
        # beside the trace whose zeros agree: within what the constant leaves open of a parameter, twice that for the lag that it looks like
        open_to = (1.0 if name == "dead_time" else 0.5) * (high - low)
        assert value == pytest.approx(getattr(by_clean(number).servo, name), abs=open_to), name


def test_the_clean_trace_of_one_servo_gives_its_truth() -> None:
    for name, (low, high) in by_clean(3).confidence.items():
        half = 0.5 * (high - low)
        assert low - half <= getattr(servo(3), name) <= high + half, name


@pytest.mark.slow
@pytest.mark.parametrize("number", range(10))
def test_swapped_columns_are_refused_whatever_the_servo(number: int) -> None:
    trace = clean(number)
    with pytest.raises(
        InputError, match=r"runs ahead of the command by .* ms on average: command and actual are swapped"
    ):
        identify(replace(trace, command=trace.actual, actual=trace.command), "t")


def test_a_parameter_that_moves_nothing_does_no_harm() -> None:
    """At the end of a range slopes may vanish; the confidence of such a fit was a traceback."""
    trace = clean(3)
    found = by_clean_fit(3)
    still = SimpleNamespace(
        times=trace.times,
        slopes=lambda *_: np.zeros((len(trace.times), len(found.names))),
        residual=lambda *_: np.zeros(len(trace.times)),
        mean=lambda _: trace.actual,
        command=lambda _: trace.command,
        filtered=lambda _, error: error,
    )
    assert with_rounding(still, found, 0.0, 1e-6).errors == pytest.approx(found.errors)
    assert with_colour(still, found).errors == found.errors


def by_clean_fit(number: int) -> Minimum:
    """Give a minimum with the values of a servo and errors of a part in a thousand."""
    values = {name: getattr(servo(number), name) for name in (*NAMES, "velocity_feedforward")}
    errors = dict.fromkeys(NAMES, 0.001)
    return Minimum(
        values, NAMES, None, 1e-6, errors, {name: (0.99 * values[name], 1.01 * values[name]) for name in NAMES}
    )
