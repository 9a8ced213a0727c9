"""Simulated shifts: what is drawn, what is compared, what is refused."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from camwright.cli.simulate import pieces_text, shift_answer
from camwright.jobs.job import load_job
from camwright.production.cut_list import line_of
from camwright.production.simulation import Disturbances, simulate_shift
from camwright.profiles.cut_list import CutList, ListRow
from camwright.profiles.errors import InputError
from camwright.profiles.line_run import LineRun
from tests.pace import in_time

EXAMPLES = Path(__file__).parents[2] / "examples"
ASKED = CutList((ListRow(0.6, 40), ListRow(0.35, 40)))
STEADY = LineRun(np.array([0.0, 1e4]), np.full(2, 1.0))


def test_a_steady_shift_without_faults_cuts_every_piece_alike() -> None:
    study = simulate_shift(load_job(), CutList((ListRow(0.6, 50),)), STEADY, Disturbances())
    answer = shift_answer(study)
    assert answer["optimised"]["length_error_m"]["worst"] < 1e-6
    assert answer["optimised"]["sync_error_m"]["worst"] < answer["linear_return"]["sync_error_m"]["worst"]
    assert answer["line"] == "given"
    assert answer["pieces_too_fast"] == 0
    assert sum(answer["histogram"]["optimised"]) == sum(answer["histogram"]["linear_return"]) == 50


def test_slip_makes_pieces_longer_by_its_share() -> None:
    study = simulate_shift(load_job(), CutList((ListRow(0.6, 400),)), STEADY, Disturbances(slip=0.001))
    errors = study.runs["optimised"].length_errors
    assert errors.std() == pytest.approx(0.6 * 0.001, rel=0.15)


def test_noise_spreads_the_cuts_and_marks_move_the_lengths() -> None:
    plain, noisy, marked = (
        simulate_shift(load_job(), ASKED, STEADY, wrong)
        for wrong in (Disturbances(), Disturbances(noise=2e-5), Disturbances(marks=1e-3))
    )
    assert noisy.runs["optimised"].length_errors.std() > 10 * plain.runs["optimised"].length_errors.std()
    assert (marked.lengths - ASKED.gaps).std() == pytest.approx(1e-3, rel=0.25)
    assert np.abs(marked.runs["optimised"].length_errors).max() < 2e-4  # the knife follows the marks


def test_the_same_seed_gives_the_same_bytes_and_another_other_ones() -> None:
    texts = [
        pieces_text(simulate_shift(load_job(), ASKED, STEADY, Disturbances(noise=1e-5, slip=1e-4, seed=seed)))
        for seed in (5, 5, 6)
    ]
    assert texts[0] == texts[1] != texts[2]
    assert len([line for line in texts[0].splitlines() if line[:1].isdigit()]) == 80


def test_servos_of_the_ranges_are_never_better_than_the_worst_of_them() -> None:
    job = load_job(EXAMPLES / "short-cut.toml")
    cut = replace(job.cut, shaped=False)
    job = replace(job, cut=cut, servo_aware=False, objective="peak_acceleration", slowest=1.0)
    few, many = (simulate_shift(job, CutList((ListRow(0.45, 30),)), STEADY, Disturbances(servos=n)) for n in (0, 6))
    assert many.servos == 7
    assert (many.runs["optimised"].worst_sync_errors >= few.runs["optimised"].worst_sync_errors).all()
    assert many.runs["optimised"].worst_sync_errors.max() > few.runs["optimised"].worst_sync_errors.max()


def test_a_line_that_is_too_fast_is_told() -> None:
    study = simulate_shift(load_job(), CutList((ListRow(0.6, 5), ListRow(0.3, 4))), STEADY, Disturbances())
    assert study.too_fast == 4  # 1 m/s is more than 47.66 m/min
    assert study.too_hard == 0


def test_cams_of_a_given_line_bear_its_ramps_or_it_is_told() -> None:
    asked = CutList((ListRow(0.6, 5), ListRow(0.3, 4)))
    gentle = LineRun(np.array([0.0, 4.0, 8.0, 30.0]), np.array([0.0, 0.6, 0.6, 0.6]))
    assert simulate_shift(load_job(), asked, gentle, Disturbances()).too_hard == 0
    hard = LineRun(
        np.array([0.0, 4.36, 4.41, 60.0]), np.array([0.7, 0.7, 0.785, 0.785])
    )  # on a cam that is at its limits
    assert simulate_shift(load_job(), asked, hard, Disturbances()).too_hard >= 1


def test_planned_lines_follow_marks() -> None:
    job = line_of(load_job(), 0.5)
    study = simulate_shift(job, CutList((ListRow(0.6, 20), ListRow(0.3, 20))), None, Disturbances(marks=5e-4))
    assert study.too_fast == 0
    assert study.planned.line.length == pytest.approx(study.lengths.sum())


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (Disturbances(servos=3), r"--servos: the job gives no ranges to draw servos from; add \[servo.tolerance\]"),
        (Disturbances(marks=0.2), "--marks: the shortest piece becomes"),
    ],
)
def test_what_cannot_be_simulated_is_refused(wrong: Disturbances, message: str) -> None:
    with pytest.raises(InputError, match=message):
        simulate_shift(load_job(), ASKED, STEADY, wrong)


def test_marks_on_a_crank_and_a_line_that_stands_still_are_refused() -> None:
    with pytest.raises(InputError, match="--marks: pieces are made longer by stretching the return"):
        simulate_shift(load_job(EXAMPLES / "chasing-shear.toml"), ASKED, STEADY, Disturbances(marks=1e-3))
    stopping = LineRun(np.array([0.0, 10.0]), np.array([1.0, 0.0]))
    with pytest.raises(InputError, match="the line stands still after 5 m, the list needs 38 m"):
        simulate_shift(load_job(), ASKED, stopping, Disturbances())


def test_ten_thousand_pieces_in_ten_seconds() -> None:
    asked = CutList((ListRow(0.6, 6000), ListRow(0.3, 2000), ListRow(0.45, 2000)))
    begun = time.process_time()
    study = simulate_shift(line_of(load_job(), 0.2), asked, None, Disturbances(noise=2e-6, slip=2e-4, marks=3e-4))
    assert in_time(time.process_time() - begun, 10.0)
    assert len(study.lengths) == 10_000
