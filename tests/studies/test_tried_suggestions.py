"""Comparisons and trade-offs of jobs that cannot be done suggest only what was designed and passed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from camwright.jobs.job import Job, load_job
from camwright.profiles.errors import InfeasibleError
from camwright.studies.comparison import compare
from camwright.studies.remedies import solve_or_advise
from camwright.studies.tradeoff import trade_off


@pytest.mark.parametrize("study", [compare, trade_off])
def test_the_changes_that_a_refusal_names_were_tried(study: Callable[[Job], object]) -> None:
    job = load_job()
    job = replace(job, cut=replace(job.cut, line_speed=2.5))
    with pytest.raises(InfeasibleError) as tried:
        solve_or_advise(job)
    with pytest.raises(InfeasibleError) as told:
        study(job)
    assert str(told.value) == str(tried.value)
    assert "designed and checked" in str(told.value)
