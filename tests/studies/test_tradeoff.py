"""The trade-off of objectives and laws, and the screw-driven carriage that a crank is compared with."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from camwright.cli.compare import compare_objectives
from camwright.cli.destination import Destination
from camwright.cli.views.tradeoff import tradeoff_view
from camwright.design.optimise import (
    Solution,
    solve,
)
from camwright.figures.labels import label_size
from camwright.figures.tradeoff import tradeoff_figure
from camwright.house.output import Voice
from camwright.house.owned import LIST, Work
from camwright.house.pictures import DrawnMarks, Frame, Note
from camwright.jobs.job import Job, load_job
from camwright.profiles.errors import InfeasibleError, InputError, SolverError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import (
    CrankSlider,
    LinearCarriage,
    RotaryKnife,
)
from camwright.profiles.objective import COMMAND_OBJECTIVES, MOTION_OBJECTIVES, CommandObjective
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.task import Task
from camwright.studies.comparison import Comparison, compare
from camwright.studies.screw import ScrewCarriage, reversals, screw_carriage
from camwright.studies.tradeoff import (
    Failure,
    TradeOff,
    trade_off,
    tradeoff_answer,
)

EXAMPLES = Path(__file__).parents[2] / "examples"

WORK = Work("compare --objectives", "paper-600", "0" * 64)


@pytest.fixture(scope="module")
def paper() -> TradeOff:
    return trade_off(load_job())


@pytest.fixture(scope="module")
def carriage() -> TradeOff:
    """Solve a carriage without friction: its torque is proportional to its acceleration."""
    return trade_off(load_job(EXAMPLES / "flying-saw.toml"))


@pytest.fixture(scope="module")
def crank() -> tuple[Job, Comparison]:
    job = load_job(EXAMPLES / "chasing-shear.toml")
    assert isinstance(job.machine, CrankSlider)
    job = replace(job, machine=replace(job.machine, sync_at=math.radians(98.0)))
    return job, compare(job, solve(job.task, job.objective).profile)


@pytest.fixture(scope="module")
def screw(crank: tuple[Job, Comparison]) -> ScrewCarriage:
    job, comparison = crank
    found = screw_carriage(job, comparison["optimised"])
    assert found is not None
    return found


def test_each_objective_is_best_in_its_own_measure(paper: TradeOff, carriage: TradeOff) -> None:
    for result in (paper, carriage):
        for measure in result.measures:
            row = next(row for row in result.rows if row.name == measure)
            # the solver keeps its limits by 2e-10 and its pieces cost RMS jerk and energy a little (docs/decisions.md)
            assert result.cost(row, measure) == pytest.approx(1.0, abs=1e-4), measure


def test_torque_objectives_need_something_to_move(paper: TradeOff, carriage: TradeOff) -> None:
    assert {row.name for row in paper.rows if row.kind == "objective"} == set(MOTION_OBJECTIVES) == set(paper.measures)
    assert (
        {row.name for row in carriage.rows if row.kind == "objective"}
        == set(COMMAND_OBJECTIVES)
        == set(carriage.measures)
    )


def test_torques_of_a_carriage_follow_from_its_acceleration(carriage: TradeOff) -> None:
    machine, cut = carriage.job.machine, carriage.job.cut
    assert isinstance(machine, LinearCarriage)
    lever = machine.mass * machine.travel_per_turn / (2 * math.pi)
    share = math.sqrt(cut.return_zone / cut.length)  # the torque's mean square is over the whole cycle
    for row in carriage.rows:
        if row.values["peak_acceleration"] is None:
            assert row.values["rms_torque"] is row.values["energy"] is None
            continue
        assert row.values["peak_torque"] == pytest.approx(lever * row.values["peak_acceleration"], rel=1e-9)
        assert row.values["rms_torque"] == pytest.approx(lever * share * row.values["rms_acceleration"], rel=1e-9)


def test_costs_below_one_belong_to_profiles_that_break_a_limit(paper: TradeOff, carriage: TradeOff) -> None:
    for result in (paper, carriage):
        costs = [(row, result.cost(row, measure)) for row in result.rows for measure in result.measures]
        assert all(cost is None or cost >= 1.0 or not row.within_limits for row, cost in costs)
    # the parabolic law lies below the optimum: its jerk is unbounded
    parabolic = next(row for row in paper.rows if row.name == "parabolic")
    assert paper.cost(parabolic, "peak_acceleration") < 1.0
    assert not parabolic.within_limits


def test_a_law_that_leaves_the_stroke_breaks_a_limit(carriage: TradeOff) -> None:
    quintic = next(row for row in carriage.rows if row.name == "poly_3_4_5")
    assert not quintic.within_limits
    longer = replace(carriage.job, machine=replace(carriage.job.machine, stroke=1.4))
    from camwright.studies.tradeoff import _row

    assert _row("poly_3_4_5", "baseline", quintic.profile, longer, carriage.measures).within_limits


def failing(names: set[str]) -> Callable[..., Solution]:
    """Solver that fails on some objectives."""

    def solve_or_fail(task: Task, objective: CommandObjective, *, suggest: bool) -> Solution:
        if objective in names:
            raise SolverError(f"no luck with {objective}")
        return solve(task, objective, suggest=suggest)

    return solve_or_fail


def test_an_objective_that_fails_is_listed_and_the_rest_goes_on(
    paper: TradeOff, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("camwright.studies.tradeoff.solve", failing({"peak_acceleration", "rms_jerk"}))
    result = trade_off(paper.job)
    assert result.failures == (
        Failure("peak_acceleration", "no luck with peak_acceleration"),
        Failure("rms_jerk", "no luck with rms_jerk"),
    )
    assert {row.name for row in paper.rows} - {row.name for row in result.rows} == {"peak_acceleration", "rms_jerk"}
    answer = tradeoff_answer(result, [])
    assert answer["failed"][0] == {"name": "peak_acceleration", "reason": "no luck with peak_acceleration"}
    Voice(as_json=False, quiet=False).answer(lambda: answer, lambda: tradeoff_view(result))
    shown = capsys.readouterr().out
    assert "minimised RMS jerk, failed: no luck with rms_jerk" in shown
    assert len(tradeoff_figure(result).frames) == 2


def test_where_every_objective_fails_so_does_the_trade_off(paper: TradeOff, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("camwright.studies.tradeoff.solve", failing(set(COMMAND_OBJECTIVES)))
    with pytest.raises(SolverError, match="no objective was solved; the first, peak_acceleration: no luck"):
        trade_off(paper.job)


def test_rows_are_sorted_by_the_objective_of_the_job(paper: TradeOff, carriage: TradeOff) -> None:
    for result in (paper, carriage):
        values = [row.values[result.job.objective] for row in result.rows]
        finite = [value for value in values if value is not None]
        assert finite == sorted(finite)
        assert all(value is None for value in values[len(finite) :])


def test_the_answer_is_plain_json(paper: TradeOff) -> None:
    answer = json.loads(json.dumps(tradeoff_answer(paper, []), allow_nan=False))
    assert answer["sorted_by"] == "peak_acceleration"
    assert answer["measures"]["peak_jerk"]["unit"] == "m/s^3"
    assert answer["measures"]["peak_jerk"]["best_of"] == "peak_jerk"
    rows = {row["name"]: row for row in answer["profiles"]}
    assert rows["linear_return"]["values"] == dict.fromkeys(paper.measures)
    assert rows["linear_return"]["cost"] == dict.fromkeys(paper.measures)
    for row in rows.values():
        for measure, value in row["values"].items():
            if value is not None:
                assert row["cost"][measure] == pytest.approx(value / answer["measures"][measure]["best"])


def test_the_command_prints_and_draws(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, paper: TradeOff
) -> None:
    monkeypatch.setattr("camwright.cli.compare.trade_off", lambda _job, _step: paper)
    assert compare_objectives(paper.job, Destination(tmp_path, WORK), Voice(as_json=False, quiet=False)) == 0
    said = capsys.readouterr().out
    assert any(line.split()[1:7] == ["peak", "acceleration", "│", "9.072", "×1.00", "│"] for line in said.splitlines())
    assert "parabolic †" in said
    assert sorted(file.name for file in tmp_path.iterdir()) == [LIST, "tradeoff.png", "tradeoff.svg"]
    first = {file.name: file.read_bytes() for file in tmp_path.iterdir()}
    assert compare_objectives(paper.job, Destination(tmp_path, WORK), Voice(as_json=True, quiet=False)) == 0
    assert json.loads(capsys.readouterr().out)["files"] == [
        str(tmp_path / name) for name in sorted(first) if name != LIST
    ]
    assert {file.name: file.read_bytes() for file in tmp_path.iterdir()} == first  # the same bytes


def labels(frame: Frame) -> list[tuple[Note, np.ndarray]]:
    """Give the labels of a panel with their boxes (pt): left, top, right, bottom."""
    size = np.array([frame.width, frame.height])
    notes = [item for item in frame.items if isinstance(item, Note) and item.text != "unbounded"]
    middles = [(np.array(note.place) - frame.low) / (frame.high - frame.low) * size for note in notes]
    halves = [label_size(note.text, note.size) / 2 for note in notes]
    return [(n, np.concatenate([m - h, m + h])) for n, m, h in zip(notes, middles, halves, strict=True)]


def test_labels_of_points_do_not_overlap(paper: TradeOff, carriage: TradeOff) -> None:
    for result in (paper, carriage):
        for frame in tradeoff_figure(result).frames:
            boxes = [box for _, box in labels(frame)]
            assert len(boxes) >= 8
            for i, box in enumerate(boxes):
                assert box[0] >= 0.0
                assert box[1] >= 0.0
                assert box[2] <= frame.width
                assert box[3] <= frame.height
                for other in boxes[i + 1 :]:
                    assert (np.minimum(box[2:], other[2:]) <= np.maximum(box[:2], other[:2])).any()


def test_every_bounded_profile_is_a_mark_and_a_label_and_the_others_are_named(paper: TradeOff) -> None:
    upper, lower = tradeoff_figure(paper).frames
    bounded = [row for row in paper.rows if row.values["peak_acceleration"] is not None]
    for frame in (upper, lower):
        names = [name for note, _ in labels(frame) for name in note.text.splitlines()]
        assert len(names) == len(set(names)) == len(bounded)
        assert sum(isinstance(item, DrawnMarks) for item in frame.items) == len(bounded)
    assert "linear return" in lower.xlabel
    # a mark stands where its two measures are, by logarithms where the axis is
    marks = [item.points[0] for item in upper.items if isinstance(item, DrawnMarks)]
    expected = [(row.values["rms_acceleration"], row.values["peak_acceleration"]) for row in bounded]
    for axis, ticks in enumerate((upper.xticks, upper.yticks)):
        assert ticks
        wide = any(abs(tick.value - float(tick.text)) > 1e-9 for tick in ticks)
        values = [10.0 ** mark[axis] if wide else mark[axis] for mark in marks]
        assert values == pytest.approx([pair[axis] for pair in expected])
        assert [10.0**tick.value if wide else tick.value for tick in ticks] == pytest.approx(
            [float(tick.text) for tick in ticks]
        )


# -- the screw-driven carriage ----------------------------------------------------------------------------------------


def test_the_screw_is_the_crank_s_equal_where_it_says_so(crank: tuple[Job, Comparison], screw: ScrewCarriage) -> None:
    job, comparison = crank
    best, own = comparison["optimised"], screw.row
    assert isinstance(job.machine, CrankSlider)
    assert screw.machine.mass == job.machine.carriage_mass
    assert screw.machine.stroke == job.machine.stroke == pytest.approx(0.3, abs=1e-12)
    assert own.motor.peak_speed == pytest.approx(best.motor.peak_speed, rel=1e-12)
    assert own.motion.peak_speed <= best.tool.peak_speed * (1 + 2e-6)
    assert own.motion.peak_acceleration <= best.tool.peak_acceleration * (1 + 2e-6)
    assert own.motion.peak_jerk <= best.tool.peak_jerk * (1 + 2e-6)
    assert own.motion.sync_ratio_error < 1e-9


def test_the_screw_turns_back_twice_and_heats_its_motor_more(screw: ScrewCarriage) -> None:
    assert screw.reversals == 2
    assert reversals(screw.crank.profile) == 0
    assert screw.row.motor.min_velocity < 0.0 < screw.crank.motor.min_velocity
    assert screw.heating == pytest.approx(screw.row.motor.rms_torque / screw.crank.motor.rms_torque)
    assert screw.heating > 2.0
    assert "2 reversals a cut" in screw.sentence
    assert f"{screw.row.motor.rms_torque:.4g} N m RMS" in screw.sentence


def test_torque_on_a_screw_is_force_times_lead_over_a_turn(screw: ScrewCarriage) -> None:
    force = screw.machine.mass * screw.row.motion.peak_acceleration
    assert screw.row.motor.peak_torque == pytest.approx(force * screw.machine.travel_per_turn / (2 * math.pi), rel=1e-9)


def test_lead_and_speeds() -> None:
    screw = CrankSlider(crank=0.1, rod=0.5, carriage_mass=7.0).on_screw(0.5, 100.0)
    assert screw.motor_ratio * 0.5 == pytest.approx(100.0)
    assert (screw.mass, screw.home) == (7.0, 0.0)
    assert screw.stroke == pytest.approx(0.2)


def test_there_is_no_screw_where_there_is_nothing_to_compare(crank: tuple[Job, Comparison]) -> None:
    job, comparison = crank
    best = comparison["optimised"]
    for machine in (RotaryKnife(0.4), replace(job.machine, carriage_mass=0.0)):
        with pytest.raises(InputError, match="--screw: only a crank whose carriage has a mass has an equal on a screw"):
            screw_carriage(replace(job, machine=machine), best)
    with pytest.raises(InputError, match=r"--screw: .* its acceleration or jerk is unbounded"):
        screw_carriage(job, comparison["linear_return"])
    # a carriage that may accelerate a hundredth as much cannot turn within the stroke
    weak = replace(best, tool=replace(best.tool, peak_acceleration=0.01 * best.tool.peak_acceleration))
    with pytest.raises(InfeasibleError):
        screw_carriage(job, weak)


def test_reversals_are_counted_over_the_seam() -> None:
    assert reversals(CamProfile.from_arrays([0.0, 1.0], [[0.0, 1.0]])) == 0
    there_and_back = CamProfile.from_arrays([0.0, 0.5, 1.0], [[0.0, 1.0], [0.5, -1.0]])
    assert reversals(there_and_back) == 2  # at the middle and at the seam
    waits = CamProfile.from_arrays([0.0, 0.25, 0.5, 1.0], [[0.0, 1.0], [0.25, 0.0], [0.25, 1.0]])
    assert reversals(waits) == 0
    x = np.linspace(0.0, 1.0, 5)
    saw = CamProfile.from_arrays(x, [[0.0, 1.0], [0.25, -1.0], [0.0, 1.0], [0.25, -1.0]])
    assert reversals(saw) == 4


def test_limits_of_the_screw_are_stated(screw: ScrewCarriage) -> None:
    assert isinstance(screw.limits, Limits)
    assert screw.limits.speed == pytest.approx(screw.crank.tool.peak_speed, rel=2e-6)
