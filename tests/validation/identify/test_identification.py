"""Parameters from synthetic traces with noise, made by a plain loop, and every trace that is refused."""

from __future__ import annotations

import json
import math
import tomllib
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from camwright.cli.main import main
from camwright.jobs.job import BUNDLED_JOB, parse_job
from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import RotaryKnife
from camwright.profiles.returns import baseline
from camwright.profiles.servo import Servo, sample_plant
from camwright.profiles.task import Task
from camwright.profiles.trace import Trace
from camwright.validation.identify.fit import RANGES, TraceFit
from camwright.validation.identify.identification import identify
from camwright.validation.identify.preparation import geared, unwrapped, without_jumps
from camwright.validation.identify.quality import require_lag, require_usable

FREE = Limits(math.inf, math.inf, math.inf)
"""Nothing here asks for limits."""

PAPER = Servo(120.0, 0.7, 35.0, 0.004, 1.0, 0.002)
CUT = Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4)
CYCLES = {law: baseline(law, Task(RotaryKnife(0.4), CUT, FREE)) for law in ("poly_3_4_5", "linear_return")}
STEP, ROWS, NOISE = 1e-3, 2000, 10e-6
Command = Callable[[float], float]


def cam(law: str) -> Command:
    """Commands of the paper's cut with a return."""
    return lambda time: float(CYCLES[law](np.array(time * CUT.line_speed), outside="repeat"))


def sweep(size: float, last: float) -> Command:
    """Sine from half a hertz to a last frequency in 2 s; at rest before."""
    return lambda time: size * math.sin(2 * math.pi * (0.5 + (last - 0.5) * time / 4.0) * time) if time > 0 else 0.0


def recorded(servo: Servo, command: Command, seed: int, *, noise: float = NOISE, rows: int = ROWS) -> Trace:
    """Run the servo by a plain loop over its samples, from a second before the recording, its clock anywhere; add noise."""
    random = np.random.default_rng(seed)
    clock = -1.0 - servo.sample_time * random.random()
    whole = sample_plant(servo, servo.sample_time)
    times = STEP * np.arange(rows)
    actual = np.empty(rows)
    before = command(clock - servo.delay)
    state, past, earliest = np.array([0.0, 0.0, before]), (before, before), before
    row = 0
    for k in range(math.ceil((times[-1] - clock) / servo.sample_time) + 1):
        start = clock + k * servo.sample_time
        now = command(start - servo.delay)
        step, before = servo.sample_time, past[0]
        asked = now + servo.acceleration_feedforward * (now - 2 * before + past[1]) / step**2
        asked += servo.jerk_feedforward * (now - 3 * before + 3 * past[1] - earliest) / step**3
        held = servo.position_gain * (asked - state[2]) + servo.velocity_feedforward * (now - before) / step
        while row < rows and times[row] < start + servo.sample_time:
            plant = sample_plant(servo, times[row] - start)
            actual[row] = plant.transition[2] @ state + plant.input[2] * held
            row += 1
        state, past, earliest = whole.transition @ state + whole.input * held, (now, before), past[1]
    return Trace(0.0, STEP, np.array([command(t) for t in times]), actual + random.normal(0.0, noise, rows), "m")


def csv(trace: Trace) -> str:
    lines = (
        f"{t * 1e3:.3f},{c * 1e3:.7g},{a * 1e3:.7g}"
        for t, c, a in zip(trace.times, trace.command, trace.actual, strict=True)
    )
    return "\n".join(["time [ms],command [mm],actual [mm]", *lines]) + "\n"


def assert_found(found: Servo, servo: Servo) -> None:
    """Every parameter within 2 per cent, the dead time within 0.1 ms or this."""
    for name in ("bandwidth", "damping", "position_gain", "sample_time"):
        assert getattr(found, name) == pytest.approx(getattr(servo, name), rel=0.02), name
    assert found.dead_time == pytest.approx(servo.dead_time, rel=0.02, abs=1e-4)


@pytest.mark.parametrize(
    ("law", "seed"), [("poly_3_4_5", 1), ("poly_3_4_5", 2), ("poly_3_4_5", 3), ("linear_return", 1)]
)
def test_the_papers_servo_is_found_from_the_papers_cut(law: str, seed: int) -> None:
    found = identify(recorded(PAPER, cam(law), seed), "t", 1.0)
    assert_found(found.servo, PAPER)
    assert found.feedforward_from == "given"
    assert "velocity_feedforward" not in found.confidence
    assert found.residual == pytest.approx(NOISE, rel=0.05)
    assert found.fit > 0.9999


@pytest.mark.parametrize(
    ("servo", "command"),
    [
        (Servo(82.0, 0.88, 11.0, 0.0078, 1.0, 0.0), sweep(0.02, 8.0)),
        (Servo(148.0, 0.72, 49.0, 0.0011, 1.0, 0.004), sweep(0.02, 15.0)),
        (Servo(105.0, 0.81, 28.0, 0.0063, 0.0, 0.006), sweep(0.02, 20.0)),
    ],
)
def test_servos_of_the_published_ranges_are_found_from_a_sweep(servo: Servo, command: Command) -> None:
    assert_found(identify(recorded(servo, command, 3), "t", servo.velocity_feedforward).servo, servo)


def test_a_whole_feedforward_is_assumed_where_the_trace_allows_it() -> None:
    found = identify(recorded(PAPER, cam("poly_3_4_5"), 5), "t")
    assert (found.servo.velocity_feedforward, found.feedforward_from) == (1.0, "assumed")
    assert_found(found.servo, PAPER)


def test_another_feedforward_is_fitted() -> None:
    servo = replace(PAPER, velocity_feedforward=0.9)
    found = identify(recorded(servo, sweep(0.02, 30.0), 6), "t")
    assert found.feedforward_from == "trace"
    assert found.servo.velocity_feedforward == pytest.approx(0.9, abs=0.01)
    assert_found(found.servo, servo)
    low, high = found.confidence["velocity_feedforward"]
    assert low < found.servo.velocity_feedforward < high < 1.0


@pytest.mark.parametrize(
    "command",
    [cam("poly_3_4_5"), pytest.param(sweep(0.02, 30.0), marks=pytest.mark.slow)],
    ids=["cam", "sweep"],
)
def test_feedforward_of_acceleration_and_jerk_is_found_or_told(command: Command) -> None:
    """A trace that was simulated with them gives them back, within its own 95 % widened to three standard deviations and more."""
    servo = replace(PAPER, acceleration_feedforward=2.5e-4, jerk_feedforward=1.5e-6)
    names = ("acceleration_feedforward", "jerk_feedforward")
    trace = recorded(servo, command, 3)
    found = identify(trace, "t", 1.0, dict.fromkeys(names))
    assert set(names) < set(found.confidence)
    for name, (low, high) in found.confidence.items():
        half = 0.5 * (high - low)
        assert low - half <= getattr(servo, name) <= high + half, name
    told = identify(trace, "t", 1.0, {name: getattr(servo, name) for name in names})
    assert_found(told.servo, servo)
    assert [getattr(told.servo, name) for name in names] == [2.5e-4, 1.5e-6]
    assert not set(names) & set(told.confidence)
    assert told.residual == pytest.approx(NOISE, rel=0.05)


def test_feedforward_beyond_the_velocity_goes_into_the_servo_table(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    servo = replace(PAPER, acceleration_feedforward=2.5e-4)
    (tmp_path / "t.csv").write_text(csv(recorded(servo, cam("poly_3_4_5"), 3)), encoding="utf-8")
    call = ["identify", str(tmp_path / "t.csv"), "--velocity-feedforward", "1", "--acceleration-feedforward"]
    assert main([*call, "250 ms^2", "--out", str(tmp_path / "servo.toml"), "--quiet"]) == 0
    text = (tmp_path / "servo.toml").read_text(encoding="utf-8")
    line = next(line for line in text.splitlines() if line.startswith("acceleration"))
    assert line.split("#")[1].strip() == "given"
    assert tomllib.loads(text)["servo"]["acceleration_feedforward"] == "250.0 ms^2"
    assert "jerk" not in text
    capsys.readouterr()
    assert main([*call, "fit", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    low, high = answer["confidence"]["acceleration_feedforward_ms2"]
    assert low <= 250.0 <= high
    assert main([*call, "250"]) == 2
    said = "--acceleration-feedforward: '250': a number without a unit; write e.g. \"250 ms^2\""
    assert said in capsys.readouterr().err


def test_the_confidence_holds_the_truth_and_follows_the_noise() -> None:
    quiet, loud = (identify(recorded(PAPER, cam("poly_3_4_5"), 7, noise=noise), "t", 1.0) for noise in (1e-5, 4e-5))
    for found in (quiet, loud):
        for name, (low, high) in found.confidence.items():
            half = 0.5 * (high - low)  # twice the width: it holds the truth but for once in 10 000
            assert low - half <= getattr(PAPER, name) <= high + half, name
    for name, (low, high) in quiet.confidence.items():
        wider = loud.confidence[name]
        assert (wider[1] - wider[0]) / (high - low) == pytest.approx(4.0, rel=0.2), name


def line(time: float) -> float:
    return 0.3 * time


def clipped(trace: Trace) -> Trace:
    return replace(trace, actual=np.minimum(trace.actual, 0.8 * trace.actual.max()))


def stairs(trace: Trace) -> Trace:
    return replace(trace, command=np.repeat(trace.command[::4], 4))


SWEEP = recorded(PAPER, sweep(0.02, 15.0), 8)


@pytest.mark.parametrize(
    ("trace", "message"),
    [
        (recorded(PAPER, sweep(0.02, 15.0), 1, rows=150), "t: 150 rows over 0.149 s: too short to know the axis from; record 200 rows"),
        (replace(SWEEP, command=np.full(ROWS, 0.1)), "t: the command stands still, so the axis is not excited; record a motion"),
        (recorded(PAPER, line, 1), "t: the command runs straight, so the axis is not excited; record a motion"),
        (recorded(PAPER, lambda t: 0.3 * t + 1e-5 * math.sin(9 * t), 1), "t: the command leaves its straight line by "),
        (replace(SWEEP, actual=np.zeros(ROWS)), "t: the actual position stands still while the command moves"),
        (clipped(SWEEP), "t: the actual position is clipped: from 0."),
        (replace(SWEEP, actual=np.maximum(SWEEP.actual, -0.012)), "m, the end of its range, while the command moves on; record it"),
        (replace(SWEEP, command=np.maximum(SWEEP.command, -0.012)), "t: the command is clipped: from 0."),
        (stairs(SWEEP), "t: the command is recorded in stairs of 4 ms, as a sampled loop holds it; record the command before"),
        (replace(SWEEP, actual=25.4 * SWEEP.actual), "times as far as the command; give both in their true units"),
        (recorded(replace(PAPER, lead_time=0.006), cam("poly_3_4_5"), 1),
         "t: the actual position runs ahead of the command by 3.64 ms on average: command and actual are swapped, or"),
        (recorded(PAPER, sweep(0.05, 0.7), 1), "t: the trace does not tell the sample time: "),
    ],
)  # fmt: skip
def test_a_trace_that_does_not_tell_the_servo_is_refused(trace: Trace, message: str) -> None:
    with pytest.raises(InputError) as caught:
        identify(trace, "t", 1.0)
    assert message in str(caught.value)


def test_an_axis_that_is_no_such_servo_is_refused() -> None:
    wrong = replace(SWEEP, actual=-SWEEP.actual)
    with pytest.raises(InputError, match="no servo of this kind does what the trace shows: the best leaves"):
        identify(wrong, "t", 1.0)


def test_an_axis_that_counts_the_other_way_is_told() -> None:
    with pytest.raises(
        InputError, match="t: the actual position runs against the command: one of them counts the other way"
    ):
        identify(replace(CUT_TRACE, actual=-CUT_TRACE.actual), "t", 1.0)


def test_rest_before_and_after_a_motion_is_not_clipping() -> None:
    def move(time: float) -> float:
        part = min(max((time - 0.5) / 0.4, 0.0), 1.0)
        return 0.2 * part**3 * (10 - 15 * part + 6 * part**2)

    trace = recorded(replace(PAPER, dead_time=0.01), move, 1, noise=0.0)
    coarse = replace(trace, actual=np.round(trace.actual, 5), command=np.round(trace.command, 5))
    assert (coarse.actual[:400] == 0.0).all()
    require_usable(coarse, "t")


def test_the_command_writes_a_servo_for_job_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, out = tmp_path / "trace.csv", tmp_path / "new" / "servo.toml"
    file.write_text(csv(recorded(PAPER, cam("poly_3_4_5"), 9)), encoding="utf-8")
    assert main(["identify", str(file), "--out", str(out), "--velocity-feedforward", "1", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    expected = {
        "bandwidth_rad_per_s": 120.0, "damping": 0.7, "position_gain_per_s": 35.0, "sample_time_ms": 4.0, "dead_time_ms": 2.0
    }  # fmt: skip
    for key, value in expected.items():
        assert answer[key] == pytest.approx(value, rel=0.02)
        assert answer["confidence"][key][0] < answer[key] < answer["confidence"][key][1]
    assert answer["fit"] > 0.9999
    assert (answer["velocity_feedforward"], answer["velocity_feedforward_from"]) == (1.0, "given")
    assert answer["residual_rms"]["value"] == pytest.approx(10.0, rel=0.05)
    assert answer["residual_rms"]["unit"] == "um"
    assert answer["files"] == [str(out)]
    assert [path.name for path in out.parent.iterdir()] == ["servo.toml"]
    # it stands in the place of the job's own
    text = out.read_text(encoding="utf-8")
    assert tomllib.loads(text)["servo"]["velocity_feedforward"] == 1.0
    job = BUNDLED_JOB.read_text(encoding="utf-8")
    head, rest = job.split("[servo]")
    found = parse_job(head + text + "\n[objective]" + rest.split("[objective]")[1], "").servo
    assert found.bandwidth == pytest.approx(answer["bandwidth_rad_per_s"], rel=1e-4)
    assert found.dead_time * 1e3 == pytest.approx(answer["dead_time_ms"], rel=1e-3)


def test_the_command_shows_what_it_found(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "trace.csv"
    file.write_text(csv(SWEEP), encoding="utf-8")
    assert main(["identify", str(file), "--velocity-feedforward", "1"]) == 0
    shown = capsys.readouterr().out
    for words in (
        "bandwidth ω",
        "rad/s",
        "dead time",
        "95 % confidence",
        "given",
        "fit 0.999",
        "um rms over 1940 rows",
    ):
        assert words in shown
    assert "wrote" not in shown
    assert main(["identify", str(file), "--velocity-feedforward", "1", "--quiet"]) == 0
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize(
    ("content", "options", "message"),
    [
        (csv(SWEEP).replace("time [ms]", "time"), [], "line 1: column time has no unit"),
        (csv(SWEEP).replace("\n100.000,", "\n100.400,"), [], "the sampling must be equal"),
        ("\n".join(csv(SWEEP).split("\n")[:100]), [], "too short to know the axis from"),
        (csv(SWEEP), ["--velocity-feedforward", "1.5"], "--velocity-feedforward 1.5: it is a share from 0 to 1"),
    ],
)
def test_nothing_is_written_where_the_trace_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], content: str, options: list[str], message: str
) -> None:
    file, out = tmp_path / "trace.csv", tmp_path / "out" / "servo.toml"
    file.write_text(content, encoding="utf-8")
    assert main(["identify", str(file), "--out", str(out), "--json", *options]) == 2
    captured = capsys.readouterr()
    assert message in captured.err
    assert json.loads(captured.out)["exit_code"] == 2
    assert not out.parent.exists()


def test_a_directory_is_no_file_to_write(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["identify", "none.csv", "--out", str(tmp_path)]) == 2
    assert "a directory; --out names the file to write, e.g. servo.toml" in capsys.readouterr().err


# -- recordings as scopes have them: modulo axes, zeros that differ, swapped columns

CUT_TRACE = recorded(PAPER, cam("poly_3_4_5"), 3)


@pytest.mark.parametrize(("modulus", "told"), [(0.4, "400 mm"), (0.1, "100 mm"), (0.35, "350 mm")])
@pytest.mark.parametrize("offset", [0.0, 0.37])
def test_a_modulo_axis_is_unwrapped(modulus: float, told: str, offset: float) -> None:
    jumping = replace(
        CUT_TRACE, command=(CUT_TRACE.command + offset) % modulus, actual=(CUT_TRACE.actual + offset) % modulus
    )
    found = unwrapped(jumping, "t")
    start = (found.command - CUT_TRACE.command)[0]
    assert found.command - CUT_TRACE.command == pytest.approx(np.full(len(CUT_TRACE.command), start), abs=1e-12)
    assert found.actual - CUT_TRACE.actual == pytest.approx(np.full(len(CUT_TRACE.command), start), abs=1e-12)
    assert found.notes == (
        f"the command is recorded modulo {told} and was unwrapped",
        f"the actual position is recorded modulo {told} and was unwrapped",
    )


def test_a_turn_in_radians_may_fall() -> None:
    command = -(CUT_TRACE.command / 0.4 * 2 * np.pi) % (2 * np.pi)
    found = unwrapped(replace(CUT_TRACE, command=command, actual=-CUT_TRACE.actual, unit="rad"), "t")
    assert float(np.ptp(found.command)) == pytest.approx(float(np.ptp(CUT_TRACE.command)) / 0.4 * 2 * np.pi)
    assert found.notes == ("the command is recorded modulo 360 deg and was unwrapped",)


def test_a_trace_without_jumps_is_left_alone() -> None:
    found = unwrapped(CUT_TRACE, "t")
    assert (found.command == CUT_TRACE.command).all()
    assert found.notes == ()


@pytest.mark.parametrize("rows", [9, 12, 30, 60])
def test_a_short_recording_with_a_jump_is_unwrapped(rows: int) -> None:
    """Fewer rows than those beside a jump by which its step is estimated."""
    straight = 1e-3 * np.arange(rows)
    jumping = np.where(np.arange(rows) > rows // 2, straight - 1.0, straight)
    found, modulus = without_jumps(jumping, "m", (1e-3, 0.0), "t")
    assert modulus == 1.0
    assert found == pytest.approx(straight, abs=1e-12)


@pytest.mark.parametrize("modulus", [0.4, 0.4173519])
def test_an_axis_that_is_recorded_modulo_alone_is_measured_by_its_command(modulus: float) -> None:
    """Noise hides the last digits of a jump; a turn later command and axis are where they were."""
    lag = 0.02 * np.sin(2.0 * np.pi * CUT_TRACE.command / modulus)
    actual = CUT_TRACE.command - 0.01 - lag + np.random.default_rng(4).normal(0.0, 5e-6, len(lag))
    found = unwrapped(replace(CUT_TRACE, actual=actual % modulus), "t")
    assert np.ptp(found.actual - actual) < 1e-6
    assert abs(np.mean(found.actual - actual)) < modulus


@pytest.mark.parametrize("gear", ["3", "1/2", "7/3", "6/5"])
def test_a_plain_gear_is_taken_off(gear: str) -> None:
    ratio = float(Fraction(gear))
    found = geared(replace(CUT_TRACE, actual=CUT_TRACE.actual * ratio + 0.3), "t")
    assert found.notes[-1] == f"the actual position moves {gear} times as far as the command: that gear was taken off"
    assert np.ptp(found.actual - CUT_TRACE.actual) < 1e-12
    assert geared(CUT_TRACE, "t") is CUT_TRACE


def test_a_ratio_that_is_no_gear_is_refused() -> None:
    with pytest.raises(
        InputError,
        match=r"the actual position moves 25\.4.* times as far as the command; divide the column by the gear",
    ):
        geared(replace(CUT_TRACE, actual=25.4 * CUT_TRACE.actual), "t")


def test_where_the_command_comes_back_no_gear_is_sought() -> None:
    turn = np.sin(2.0 * np.pi * CUT_TRACE.times / CUT_TRACE.times[-1])
    back = replace(CUT_TRACE, command=turn, actual=0.5 * turn)
    assert geared(back, "t") is back


def test_a_jump_that_is_no_modulus_is_refused() -> None:
    command = CUT_TRACE.command % 0.4
    command[900:] += 0.2
    with pytest.raises(InputError, match=r"the command jumps by .* mm at .* s, which is no modulus of an axis"):
        unwrapped(replace(CUT_TRACE, command=command % 0.4, actual=CUT_TRACE.actual + 0.0), "t")


@pytest.mark.slow
@pytest.mark.parametrize("offset", [1.2345, -0.004])
def test_zeros_that_differ_are_taken_off(offset: float) -> None:
    found = identify(replace(CUT_TRACE, actual=CUT_TRACE.actual + offset), "t", 1.0)
    assert_found(found.servo, PAPER)
    assert float(found.notes[0].split(": ")[1].split(" mm")[0]) == pytest.approx(offset * 1e3, abs=0.05)
    for name, (low, high) in found.confidence.items():
        assert low <= getattr(found.servo, name) <= high, name


def test_equal_zeros_are_not_told() -> None:
    assert identify(CUT_TRACE, "t", 1.0).notes == ()


def test_swapped_columns_are_named() -> None:
    with pytest.raises(InputError, match="command and actual are swapped, or the controller leads"):
        identify(replace(CUT_TRACE, command=CUT_TRACE.actual, actual=CUT_TRACE.command), "t", 1.0)


def test_out_replaces_what_identify_wrote_and_nothing_else(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, out = tmp_path / "trace.csv", tmp_path / "servo.toml"
    file.write_text(csv(SWEEP), encoding="utf-8")
    asked = ["identify", str(file), "--out", str(out), "--velocity-feedforward", "1", "--quiet"]
    assert main(asked) == main(asked) == 0
    written = out.read_text(encoding="utf-8")
    changed = written.replace("[servo]", "[servo]  # as of the spring")
    for text in (changed, "my notes\n", "", "# camwright identify, SHA-256 of the lines above: "):
        out.write_text(text, encoding="utf-8")
        assert main(asked) == 2
        assert "servo.toml" in capsys.readouterr().err
        assert out.read_text(encoding="utf-8") == text
    out.unlink()
    out.symlink_to(tmp_path / "elsewhere")
    assert main(asked) == 2
    assert "a link is in the way of the file servo.toml and is left alone" in capsys.readouterr().err
    assert not (tmp_path / "elsewhere").exists()
    assert main([*asked[:3], "/dev/null", *asked[4:]]) == 2
    assert "a device is in the way of the file null" in capsys.readouterr().err
    assert Path("/dev/null").is_char_device()


def test_a_modulus_that_is_no_plain_number_is_measured() -> None:
    modulus = 0.4173519
    jumping = replace(CUT_TRACE, command=CUT_TRACE.command % modulus, actual=CUT_TRACE.actual % modulus)
    found = unwrapped(jumping, "t")
    assert float(np.abs(found.command - CUT_TRACE.command).max()) < 2e-6


@pytest.mark.parametrize("kind", ["same", "zero", "gear", "noise", "nine digits"])
def test_an_axis_that_is_its_command_is_refused(kind: str) -> None:
    """What a simulated axis, or one column exported twice, looks like."""
    command = np.array([sweep(0.05, 20.0)(STEP * row) for row in range(ROWS)])
    noise = np.random.default_rng(3).standard_normal(ROWS)
    actual = {
        "same": command,
        "zero": command + 0.02,
        "gear": 2.0 * command,
        "noise": command + NOISE * noise,
        "nine digits": np.array([float(f"{2 * each:.9g}") for each in command]),
    }[kind]
    trace = Trace(0.0, STEP, command, actual, "m")
    with pytest.raises(
        InputError, match=r"^t: the actual position is the command itself, but for .* m rms of noise or"
    ):
        identify(trace, "t")


def test_a_lag_that_noise_hides_for_the_eye_is_no_copy() -> None:
    """The lag of a servo with full feed-forward, a third of the noise: the copy's refusal does not touch it."""
    trace = recorded(PAPER, cam("poly_3_4_5"), 5, noise=3e-4)
    require_lag(trace, "t")


def test_parameters_that_move_nothing_are_untold_not_a_fault() -> None:
    """A loop that is not stable leaves the same whatever its parameters: each may be anything, which is no division by zero."""
    command = np.array([sweep(0.05, 20.0)(STEP * row) for row in range(ROWS + 5)])
    fit = TraceFit.of(Trace(0.0, STEP, command[5:], command[:-5], "m"))
    start = {"bandwidth": 477.0, "damping": 0.1, "position_gain": 129.0, "sample_time": 0.0076, "dead_time": 0.0}
    names = ("bandwidth", "position_gain", "dead_time")
    found = fit.minimum({**start, "velocity_feedforward": 0.0}, names, None, 5)
    assert all(found.bounds[name][0] < RANGES[name][0] and found.bounds[name][1] > RANGES[name][1] for name in names)
    assert all(math.isfinite(error) and error > 1e3 for error in found.errors.values())
