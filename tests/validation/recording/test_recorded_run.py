"""Runs simulated with known errors, by formulas of their own: each kind of error is found, on every machine, as scopes record it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from camwright.jobs.job import BUNDLED_JOB, Job, load_job, parse_job
from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.returns import baseline
from camwright.studies.recording import RecordedRun, recorded_run

EXAMPLES = Path(__file__).parents[3] / "examples"
CUTS = 14
Write = Callable[[str, str], Path]


@dataclass(frozen=True)
class Twin:
    """A run as it was, in SI units: what the axis adds to its command, and the command to the cam, by cut."""

    job: Job
    profile: CamProfile
    times: FloatArray
    master: FloatArray
    command: FloatArray
    actual: FloatArray


def paper() -> Job:
    return load_job()


def example(name: str) -> Job:
    job = load_job(EXAMPLES / f"{name}.toml")
    task = job.task if job.machine.placed else job.task.placed_midway()
    return replace(job, machine=task.machine)


def nearest_cut(job: Job, master: FloatArray) -> FloatArray:
    """Count the sync zone that is nearest: its middle lies half a sync zone before the end of a cycle, or at its seam."""
    middle = job.cut.length - 0.5 * job.cut.sync_zone if job.cut.origin == "return" else 0.0
    return np.round((master - middle) / job.cut.length)


def twin(
    job: Job,
    *,
    offset: float = 0.0,
    drift: float = 0.0,
    scatter: FloatArray | None = None,
    command_drift: float = 0.0,
    lag: float = 0.0,
    begins: float = 0.31,
    speeds: Callable[[FloatArray], FloatArray] = np.ones_like,
    step: float | None = None,
) -> Twin:
    """Make a run whose slave is off by an offset, a drift from cut to cut, a number for each cut, and a lag (slave unit, s)."""
    profile = baseline("poly_3_4_5", job.task)
    cut = job.cut
    step = cut.period / 400 if step is None else step
    times = step * np.arange(round(CUTS * cut.period / step))
    speed = cut.line_speed * speeds(times)
    master = begins * cut.length + np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * step)])
    late = np.interp(times - lag, times, master) - speed[0] * np.maximum(lag - times, 0.0)
    number = nearest_cut(job, master)
    command = profile(master, outside="repeat") + command_drift * number
    seen = profile(late, outside="repeat") + command_drift * number
    added = np.zeros_like(times) if scatter is None else scatter[(number - number.min()).astype(int) % len(scatter)]
    return Twin(job, profile, times, master, command, seen + offset + drift * number + added)


def csv_text(
    run: Twin, *, master: bool = True, unit: str = "mm", zeros: tuple[float, float, float] = (0.0, 0.0, 0.0)
) -> str:
    """Write a run as a scope would, in mm or deg, or in; each column from its own zero."""
    factor = {"mm": 1e3, "deg": 180.0 / math.pi, "in": 1 / 0.0254}[unit]
    along = 1 / 0.0254 if unit == "in" else 1e3
    heads = [
        "time [ms]",
        *([f"master [{'in' if unit == 'in' else 'mm'}]"] if master else []),
        f"command [{unit}]",
        f"actual [{unit}]",
    ]
    columns = [run.times * 1e3, *([(run.master + zeros[0]) * along] if master else [])]
    columns += [(run.command + zeros[1]) * factor, (run.actual + zeros[2]) * factor]
    lines = (",".join(f"{value:.7f}" for value in row) for row in np.stack(columns, axis=1).tolist())
    return "\n".join([",".join(heads), *lines]) + "\n"


def laid(tmp_path: Path, run: Twin, text: str | None = None, **known: float) -> RecordedRun:
    file = tmp_path / "run.csv"
    unit = "mm" if run.job.machine.slave_unit == "m" else "deg"
    file.write_text(csv_text(run, unit=unit) if text is None else text, encoding="utf-8")
    return recorded_run(file.read_bytes(), str(file), run.job, run.profile, **known)


def tool_error(run: Twin, slave: float) -> float:
    """Say what a slave that is off at mid shear zone makes of the tool there (m), by the machine's own map."""
    job, cut = run.job, run.job.cut
    middle = job.task.slave_at_sync_start + float(job.task.sync(cut.shear_zone_at + 0.5 * cut.shear_zone))
    return float(job.machine.tool(middle + slave) - job.machine.tool(middle))


MACHINES = ["paper", "flying-saw", "chasing-shear", "thick-product", "cross-cutter"]


@pytest.mark.parametrize("master", [True, False])
@pytest.mark.parametrize("name", MACHINES)
def test_an_offset_is_the_same_at_every_cut_and_spoils_no_length(tmp_path: Path, name: str, master: bool) -> None:
    job = paper() if name == "paper" else example(name)
    small = 0.4 * job.cut.sync_tolerance
    run = twin(job, offset=small)
    unit = "mm" if job.machine.slave_unit == "m" else "deg"
    found = laid(tmp_path, run, csv_text(run, master=master, unit=unit, zeros=(0.4321, -2.0, -2.0)))
    expected = tool_error(run, small)
    assert found.passed
    assert found.total.offset == pytest.approx(expected, rel=0.02, abs=2e-9)
    assert abs(found.total.drift or 0.0) < 1e-9
    assert (found.total.scatter or 0.0) < 1e-8
    assert len(found.cuts) in (CUTS - 1, CUTS)
    assert [cut.length for cut in found.cuts[1:]] == pytest.approx([job.cut.length] * (len(found.cuts) - 1), abs=1e-8)
    assert found.cuts[0].length is None
    assert found.run.line_speed == pytest.approx(job.cut.line_speed, rel=1e-6)
    assert found.run.reconstructed is not master


@pytest.mark.parametrize("name", MACHINES)
def test_a_drift_of_the_axis_makes_every_piece_long_or_short(tmp_path: Path, name: str) -> None:
    job = paper() if name == "paper" else example(name)
    run = twin(job, drift=-2e-3 * job.machine.sync_pace(job.cut) * job.cut.sync_tolerance)
    found = laid(tmp_path, run)
    expected = tool_error(run, -2e-3 * job.machine.sync_pace(job.cut) * job.cut.sync_tolerance)
    assert found.total.drift == pytest.approx(expected, rel=0.03)
    assert found.total.drifts
    assert found.axis.drift == pytest.approx(expected, rel=0.03)
    assert abs(found.command.drift or 0.0) < 1e-9
    for cut in found.cuts[1:]:
        assert cut.length == pytest.approx(job.cut.length - expected, abs=2e-8)


def test_a_drift_that_the_command_has_is_told_from_that_of_the_axis(tmp_path: Path) -> None:
    found = laid(tmp_path, twin(paper(), command_drift=2e-5))
    assert found.command.drift == pytest.approx(2e-5, rel=0.01)
    assert abs(found.axis.drift or 0.0) < 1e-8
    assert found.kind == "drift"
    assert not found.passed
    assert found.causes[0].startswith(
        "drift: the tool gains 0.02 mm each cut, so every piece is short by that; the command has it already: the cycle of the table"
    )


def test_scatter_is_told_and_compared_with_what_sampling_explains(tmp_path: Path) -> None:
    job = paper()
    by_cut = 3e-5 * np.random.default_rng(5).normal(size=40)
    found = laid(tmp_path, twin(job, scatter=by_cut))
    numbers = np.arange(len(found.cuts))
    seen = np.array([cut.error for cut in found.cuts])
    straight = np.polyval(np.polyfit(numbers, seen, 1), numbers)
    assert found.total.scatter == pytest.approx(
        float(np.sqrt(np.sum((seen - straight) ** 2) / (len(seen) - 2))), rel=1e-9
    )
    assert found.total.scatter == pytest.approx(3e-5, rel=0.5)
    assert found.kind == "scatter"
    assert not found.total.drifts
    assert "the axis has it: play" in found.causes[0]
    for before, cut in zip(found.cuts, found.cuts[1:], strict=False):
        assert cut.length == pytest.approx(job.cut.length + before.error - cut.error, abs=1e-12)


def test_what_the_sampling_explains_is_no_fault_of_the_axis(tmp_path: Path) -> None:
    job = paper()
    early = replace(job.cut, shear_zone_at=0.0, shear_zone=0.02)  # where the axis has not settled
    job = replace(job, cut=early, servo=replace(job.servo, sample_time=0.008))
    within = laid(tmp_path, twin(job)).expected
    assert within is not None
    assert within.variation > 1e-7
    by_cut = 0.5 * within.variation * np.array([1.0, -1.0, -1.0, 1.0, 0.3])
    job = replace(job, cut=replace(early, sync_tolerance=within.variation))
    assert "no more than the sampling of the servo explains" in laid(tmp_path, twin(job, scatter=by_cut)).causes[0]
    assert "the axis has it: play" in laid(tmp_path, twin(job, scatter=5.0 * by_cut)).causes[0]


def test_a_mixture_comes_apart(tmp_path: Path) -> None:
    scatter = 1e-5 * np.random.default_rng(9).normal(size=40)
    found = laid(tmp_path, twin(paper(), offset=6e-5, drift=-8e-6, scatter=scatter))
    low, high = found.total.drift_interval or (0.0, 0.0)
    assert low < -8e-6 < high
    middle = 0.5 * (found.cuts[0].number + found.cuts[-1].number)
    numbers = nearest_cut(found.job, np.array([0.31 * found.job.cut.length]))[0] + middle
    assert found.total.offset == pytest.approx(6e-5 - 8e-6 * numbers, abs=2.5e-5)
    assert found.total.scatter == pytest.approx(1e-5, rel=0.5)


def test_a_lag_is_told_from_a_zero(tmp_path: Path) -> None:
    late = laid(tmp_path, twin(paper(), lag=5e-4))
    assert late.run.zeros.lag == pytest.approx(5e-4, rel=0.01)
    assert late.run.zeros.zero == pytest.approx(0.0, abs=5e-6)
    assert late.total.offset == pytest.approx(-5e-4 * 80 / 60, rel=0.01)
    assert "a lag of 0.5 ms: dead time, velocity feed-forward below 1" in late.causes[0]
    off = laid(tmp_path, twin(paper(), offset=5e-4))
    assert off.run.zeros.zero == pytest.approx(5e-4, rel=1e-6)
    assert "the zero of the axis is off its command by 0.5 mm at any speed" in off.causes[0]


def test_a_lag_shows_where_the_line_changes_its_speed(tmp_path: Path) -> None:
    by_cut = 5e-6 * np.random.default_rng(2).normal(size=40)
    run = twin(paper(), lag=1e-3, scatter=by_cut, speeds=lambda t: 1.0 + 0.2 * np.sin(2 * math.pi * t / 2.3))
    found = laid(tmp_path, run)
    assert found.total.lag == pytest.approx(1e-3, rel=0.05)
    low, high = found.total.lag_interval or (0.0, 0.0)
    assert low < 1e-3 < high
    assert any(cause.startswith("line speed: the tool runs") and "late" in cause for cause in found.causes)
    assert not found.total.drifts


def test_foreign_zeros_are_taken_off_and_told(tmp_path: Path) -> None:
    run = twin(paper(), lag=2e-4)
    found = laid(tmp_path, run, csv_text(run, zeros=(7.0, 0.0, 1.2345)))
    assert found.run.zeros.taken_off == pytest.approx(1.2345, abs=1e-5)
    assert found.total.offset == pytest.approx(-2e-4 * 80 / 60, abs=1e-5)
    assert any("another zero than the command: 1234.5 mm were taken off" in note for note in found.notes)


# -- as scopes record it


def modulo(run: Twin, slave: float, master: float) -> Twin:
    return replace(run, master=run.master % master, command=run.command % slave, actual=run.actual % slave)


@pytest.mark.parametrize("name", ["paper", "cross-cutter", "chasing-shear"])
def test_modulo_axes_are_unwrapped_by_what_the_machine_has(tmp_path: Path, name: str) -> None:
    job = paper() if name == "paper" else example(name)
    run = twin(job, offset=0.3 * job.cut.sync_tolerance)
    plain, wrapped = laid(tmp_path, run), laid(tmp_path, modulo(run, job.machine.pitch, job.cut.length))
    assert wrapped.total.offset == pytest.approx(plain.total.offset, abs=1e-9)
    assert [cut.length for cut in wrapped.cuts[1:]] == pytest.approx([cut.length for cut in plain.cuts[1:]], abs=1e-8)
    assert sum("recorded modulo" in note for note in wrapped.notes) == 3


def test_a_circumference_that_is_no_plain_number_is_no_drift(tmp_path: Path) -> None:
    job = parse_job(BUNDLED_JOB.read_text(encoding="utf-8").replace('"400 mm"', '"417.3519 mm"'), "")
    run = modulo(twin(job, begins=0.11), job.machine.pitch, job.cut.length)
    found = laid(tmp_path, run)
    assert abs(found.total.drift or 0.0) < 1e-9
    assert abs(found.command.drift or 0.0) < 1e-9


def test_a_drum_recorded_in_degrees_and_a_motor_behind_a_gear(tmp_path: Path) -> None:
    run = twin(paper(), offset=5e-5)
    per_turn = 2 * math.pi / 0.4
    as_angle = replace(run, command=run.command * per_turn, actual=run.actual * per_turn)
    drum = laid(tmp_path, as_angle, csv_text(as_angle, unit="deg"))
    assert drum.total.offset == pytest.approx(5e-5, rel=1e-3)
    assert any("counts the slave by its turn" in note for note in drum.notes)
    geared = replace(as_angle, command=-7.5 * as_angle.command, actual=-7.5 * as_angle.actual)
    text = csv_text(geared, unit="deg")
    with pytest.raises(InputError, match=r"the command is not the cam of this design: .*--gear"):
        laid(tmp_path, geared, text)
    found = laid(tmp_path, geared, text, gear=7.5)
    assert found.total.offset == pytest.approx(5e-5, rel=1e-3)
    assert any("moves 7.5 times as far as the slave, counted the other way round" in note for note in found.notes)


def test_an_inch_job_and_an_inch_scope(tmp_path: Path) -> None:
    text = BUNDLED_JOB.read_text(encoding="utf-8")
    job = parse_job(text.replace('length = "600 mm"', 'length = "24 in"'), "")
    run = twin(job, drift=2e-5)
    found = laid(tmp_path, run, csv_text(run, unit="in"))
    assert found.total.drift == pytest.approx(2e-5, rel=0.01)
    assert " in each cut" in found.causes[0]


def test_a_scope_with_semicolons_commas_and_german_names(tmp_path: Path) -> None:
    run = twin(paper(), offset=5e-5)
    rows = (f"{t * 1e3:.4f};{m * 1e3:.5f};{c * 1e3:.5f};{a * 1e3:.5f}" for t, m, c, a in
            zip(run.times, run.master, run.command, run.actual, strict=True))  # fmt: skip
    text = "Aufzeichnung 3\nZeit;Leitachse Ist;Soll Messer;Ist Messer\nms;mm;mm;mm\n" + "\n".join(rows).replace(
        ".", ","
    )
    assert laid(tmp_path, run, text).total.offset == pytest.approx(5e-5, rel=1e-3)


def test_a_master_in_turns_of_a_cycle(tmp_path: Path) -> None:
    run = twin(paper(), drift=1e-5)
    text = csv_text(replace(run, master=run.master / run.job.cut.length * 0.360)).replace("master [mm]", "master [deg]")
    assert laid(tmp_path, run, text).total.drift == pytest.approx(1e-5, rel=0.01)


def test_another_line_speed_is_found_or_given(tmp_path: Path) -> None:
    slow = twin(paper(), drift=1e-5, speeds=lambda t: np.full_like(t, 0.37))
    found = laid(tmp_path, slow, csv_text(slow, master=False))
    assert found.run.line_speed == pytest.approx(0.37 * 80 / 60, rel=1e-5)
    assert "the master was not recorded: a steady line of 29.6 m/min is taken" in found.notes[0]
    given = laid(tmp_path, slow, csv_text(slow, master=False), line_speed=0.5)
    assert given.run.line_speed == pytest.approx(0.37 * 80 / 60, rel=1e-5)


def test_a_long_recording_keeps_its_line_speed(tmp_path: Path) -> None:
    job = paper()
    run = twin(job, drift=1e-6, step=job.cut.period / 60)
    times = np.arange(12_000) * job.cut.period / 60
    master = 0.2 + job.cut.line_speed * 0.913 * times
    cam = run.profile(master, outside="repeat")
    run = replace(run, times=times, master=master, command=cam, actual=cam + 1e-6 * nearest_cut(job, master))
    found = laid(tmp_path, run, csv_text(run, master=False))
    assert found.run.line_speed == pytest.approx(0.913 * job.cut.line_speed, rel=1e-8)
    assert len(found.cuts) > 180
    assert found.total.drift == pytest.approx(1e-6, rel=0.01)


# -- refused

RUN = twin(paper())


@pytest.mark.parametrize(
    ("run", "text", "message"),
    [
        (RUN, csv_text(replace(RUN, command=np.sin(9 * RUN.times), actual=np.sin(9 * RUN.times))),
         "the command is not the cam of this design: "),
        (RUN, csv_text(replace(RUN, command=np.full_like(RUN.times, 0.005))), "the command stands still, so no cam runs"),
        (RUN, csv_text(replace(RUN, master=np.zeros_like(RUN.master))), "the master does not move"),
        (RUN, csv_text(replace(RUN, master=900 * RUN.master)), "look at the unit of the master"),
        (RUN, csv_text(replace(RUN, master=0.01 * RUN.master)), "not the cam of this design"),
        (RUN, csv_text(RUN).replace("master [mm]", "master"), "column master has no unit"),
        (RUN, csv_text(RUN).replace("command [mm]", "voltage [V]"), "there is no column command"),
    ],
)  # fmt: skip
def test_a_recording_that_is_no_run_of_the_cam_is_refused(tmp_path: Path, run: Twin, text: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        laid(tmp_path, run, text)
    assert message in str(caught.value)


def test_a_part_of_a_cycle_is_no_run(tmp_path: Path) -> None:
    some = slice(0, 300)
    short = replace(
        RUN, times=RUN.times[some], master=RUN.master[some], command=RUN.command[some], actual=RUN.actual[some]
    )
    with pytest.raises(
        InputError, match=r"the master travels 448\.\d mm, less than one cut of 600 mm; record some cycles"
    ):
        laid(tmp_path, short)


def test_angles_are_no_carriage(tmp_path: Path) -> None:
    run = twin(example("flying-saw"))
    text = csv_text(run).replace("[mm],actual [mm]", "[deg],actual [deg]")
    with pytest.raises(
        InputError,
        match=r"positions in rad are no slave of a linear_carriage|the command is not the cam of this design",
    ):
        laid(tmp_path, run, text)
