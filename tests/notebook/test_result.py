"""What a notebook gets of a design: its page, its figures, its samples, and a table where pandas is there."""

from __future__ import annotations

import re
import sys
from types import ModuleType
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from inch_job import JOB

from camwright import Design, Result, load_job, optimise
from camwright.jobs.job import parse_job


@pytest.fixture(scope="module")
def result() -> Result:
    return optimise(load_job())


def read(html: str) -> list[str]:
    """Give the texts of a page whose tags all close."""
    return [text for text in ElementTree.fromstring(f"<div>{html}</div>").itertext() if text.strip()]  # noqa: S314 - our own


def test_a_result_is_the_design_that_the_studies_make(result: Result) -> None:
    assert isinstance(result, Design)
    assert result.passed
    assert result.gap < 1e-8


def test_the_page_states_what_the_design_states(result: Result) -> None:
    cells = read(result._repr_html_())
    assert "peak acceleration 9.0718 m/s²" in "".join(cells)
    assert "every check passed" in cells
    for row in result.comparison.rows:
        assert row.name.replace("_", " ") in cells
    assert cells.count("unbounded") == sum(
        value is None
        for row in result.comparison.rows
        for value in (row.motion.peak_acceleration, row.motion.peak_jerk)
    )


def test_the_page_names_what_failed_and_is_in_the_units_of_the_job_and_escaped() -> None:
    text = JOB.replace('name = "boards"', 'name = "a & b"').replace('"0.004 in"', '"0.00004 in"')
    failed = optimise(parse_job(text, "job"))
    page = failed._repr_html_()
    assert "a &amp; b" in page
    assert re.search(r"[0-9]+ checks? failed: .*shear zone error", page)
    assert "peak acceleration (ft/s²)" in page
    assert "settling (in)" in page
    read(page)


@pytest.mark.parametrize(("what", "panels"), [("profile", 4), ("servo", 4), ("comparison", 5)])
def test_every_figure_is_drawn(result: Result, what: Any, panels: int) -> None:
    drawing = result.plot(what)
    assert len(drawing.picture.frames) == panels
    assert drawing._repr_svg_() == drawing.svg
    assert drawing.svg.startswith("<svg")


def test_a_figure_that_does_not_exist_is_told(result: Result) -> None:
    with pytest.raises(ValueError, match="there is no figure 'cam'; the figures are profile, servo, comparison"):
        result.plot("cam")  # type: ignore[arg-type]


def test_samples_are_the_profile_over_master_and_time(result: Result) -> None:
    found, job = result.samples(1001), result.job
    assert {len(each) for each in found.values()} == {1001}
    time = found["time_s"]
    assert time[-1] == pytest.approx(job.cut.length / job.cut.line_speed, rel=1e-14)
    velocity = np.gradient(found["slave_m"], time)
    assert velocity == pytest.approx(found["velocity_m_per_s"], abs=2e-2)
    assert np.abs(found["acceleration_m_per_s2"]).max() == pytest.approx(result.objective, rel=1e-3)
    assert len(result.samples()["ratio"]) == job.output.points


def test_a_table_needs_pandas(result: Result, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ModuleNotFoundError):
        result.to_dataframe()
    stand_in = ModuleType("pandas")
    stand_in.DataFrame = dict  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "pandas", stand_in)
    table = result.to_dataframe(5)
    assert list(table) == list(result.samples(5))
