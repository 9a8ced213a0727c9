"""The figures: what is drawn stands in the results, limits and jumps are marked, bytes repeat."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from camwright.figures.comparison import bars_figure, comparison_figure
from camwright.figures.design import design_figures
from camwright.figures.profile import profile_figure
from camwright.figures.servo import AXES, servo_figure
from camwright.figures.style import (
    LINES,
    RC,
    title,
    zone_parts,
)
from camwright.jobs.job import Job, load_job
from camwright.profiles.cut import Cut
from camwright.profiles.returns import BASELINES, baseline
from camwright.studies.comparison import Comparison, compare
from camwright.studies.design import Design, optimise
from camwright.validation.servo.simulation import simulate

PNG = b"\x89PNG\r\n\x1a\n"
EVERY_FILE = [
    f"{name}.{ending}" for name in ("comparison", "profile", "servo", "speed_band") for ending in ("png", "svg")
]


@pytest.fixture(scope="module")
def paper() -> Design:
    return optimise(load_job())


def curve(axes: Axes, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the line that has the colour of a profile and the most points."""
    lines = [line for line in axes.lines if line.get_color() == LINES[name]["color"]]
    line = max(lines, key=lambda line: len(line.get_xdata()))
    return np.asarray(line.get_xdata(), dtype=float), np.asarray(line.get_ydata(), dtype=float)


def heights(axes: Axes) -> list[float]:
    """Return the heights of all horizontal lines across a panel."""
    return [float(line.get_ydata()[0]) for line in axes.lines if list(line.get_xdata()) == [0, 1]]


def arrows(axes: Axes) -> list[tuple[float, float]]:
    """Return the tips of all arrows."""
    return [text.xy for text in axes.texts if getattr(text, "arrow_patch", None) is not None]


def texts(figure: Figure) -> str:
    return "\n".join(text.get_text() for axes in figure.axes for text in (*axes.texts, axes.title, axes.xaxis.label))


def with_limits(job: Job, **changes: float) -> Job:
    return replace(job, limits=replace(job.limits, **changes))


def test_every_figure_is_written_twice(paper: Design, tmp_path: Path) -> None:
    files = design_figures(paper, tmp_path)
    assert sorted(file.name for file in files) == EVERY_FILE
    assert sorted(file.name for file in tmp_path.iterdir()) == EVERY_FILE
    for file in files:
        data = file.read_bytes()
        if file.suffix == ".png":
            assert data.startswith(PNG)
        else:
            assert b"<svg" in data
            assert b"dc:date" not in data


def test_the_same_comparison_gives_the_same_bytes_whatever_the_users_settings(paper: Design, tmp_path: Path) -> None:
    import matplotlib as mpl

    own = {"font.size": 20, "svg.fonttype": "none", "axes.facecolor": "red", "savefig.dpi": 50}
    plain = [file.read_bytes() for file in comparison_figure(paper.comparison, tmp_path)]
    with mpl.rc_context(own):
        before = dict(mpl.rcParams)
        assert [file.read_bytes() for file in comparison_figure(paper.comparison, tmp_path)] == plain
        assert dict(mpl.rcParams) == before  # and nothing of the house's style is left behind


def test_profile_curves_are_the_profiles_derivatives_over_time(paper: Design) -> None:
    figure = profile_figure(paper.comparison)
    v = paper.job.cut.line_speed
    for name in LINES:
        profile = paper.comparison[name].profile
        for axes, order, factor in zip(figure.axes[1:], (1, 2, 3), (1.0, v**2, v**3), strict=True):
            x, y = curve(axes, name)
            inside = np.min(np.abs(x[:, None] * 1e-3 - profile.breaks), axis=1) > 1e-9
            assert y[inside] == pytest.approx(factor * profile(x[inside] * 1e-3, order), rel=1e-12, abs=1e-12)
        x, y = curve(figure.axes[0], name)
        assert y == pytest.approx((profile(np.clip(x * 1e-3, 0, profile.end)) - x * 1e-3) * 1e3, abs=1e-9)


def test_profile_limits_are_lines(paper: Design) -> None:
    limits, v = paper.job.limits, paper.job.cut.line_speed
    _, ratio, acceleration, jerk = profile_figure(paper.comparison).axes
    assert heights(ratio) == pytest.approx([0.0, limits.speed / v])
    assert heights(acceleration) == pytest.approx([-limits.acceleration, limits.acceleration])
    assert heights(jerk) == pytest.approx([-limits.jerk, limits.jerk])


def test_a_limit_far_beyond_the_motion_is_named_not_drawn(paper: Design) -> None:
    job = with_limits(paper.job, acceleration=5000.0, speed=1000.0)
    _, ratio, acceleration, _ = profile_figure(replace(paper.comparison, job=job)).axes
    assert heights(acceleration) == []
    assert [text.get_text() for text in acceleration.texts if text.get_text()] == ["limits ±5000: off scale"]
    assert heights(ratio) == [0.0]
    assert [text.get_text() for text in ratio.texts] == ["limit 750: off scale"]


def test_arrows_stand_at_the_jumps_of_the_linear_return_and_nowhere_else(paper: Design) -> None:
    _, ratio, acceleration, jerk = profile_figure(paper.comparison).axes
    start, end = paper.job.cut.return_zone * 1e3, paper.job.cut.length * 1e3
    low, high = acceleration.get_ylim()
    # the ratio steps up into the sync zone and down again at the seam
    assert arrows(acceleration) == [pytest.approx((start, high)), pytest.approx((end, low))]
    assert [x for x, _ in arrows(jerk)] == pytest.approx([start, start, end, end])
    assert arrows(ratio) == []
    assert np.abs(curve(acceleration, "linear_return")[1]).max() == 0.0  # no finite number stands for the jump


def test_a_machine_that_need_not_leave_the_line_is_drawn() -> None:
    job = load_job()
    job = replace(job, cut=replace(job.cut, length=job.machine.pitch))
    straight = baseline("poly_3_4_5", job.task)
    comparison = compare(job, straight, ["linear_return", "poly_3_4_5"])
    _, _, acceleration, _ = profile_figure(comparison).axes
    assert heights(acceleration) == [-30.0, 30.0]
    assert arrows(acceleration) == []
    assert "crossing 0.0 mm" in texts(servo_figure(comparison, runs_of(comparison)))
    assert bars_figure(comparison).axes[0].get_xlim()[1] > 0


def runs_of(comparison: Comparison) -> dict[str, object]:
    return {name: simulate(comparison[name].profile, comparison.job.cut, comparison.job.servo) for name in AXES}


def test_servo_figure_draws_every_phase_and_marks_crossing_and_settling(paper: Design) -> None:
    runs = runs_of(paper.comparison)
    figure = servo_figure(paper.comparison, runs)
    _, _, whole, close = figure.axes
    for axes in (whole, close):
        for name in AXES:
            response = paper.comparison[name].response
            mine = [line for line in axes.lines if line.get_color() == LINES[name]["color"]]
            first, others = (line for line in mine if len(line.get_xdata()) > 1)
            assert not np.isnan(first.get_ydata()).any()
            # the others are one line, a gap after each
            assert 1 + int(np.isnan(others.get_ydata()).sum()) == runs[name].phases == response.phases
            crossing, settling = (line for line in mine if len(line.get_xdata()) == 1)
            assert crossing.get_xdata()[0] == pytest.approx(response.crossing * 1e3)
            assert settling.get_xdata()[0] == pytest.approx(response.settling * 1e3)
            assert abs(settling.get_ydata()[0]) == pytest.approx(paper.job.cut.sync_tolerance * 1e3, rel=2e-3)
            drawn = max(np.nanmax(line.get_ydata()) for line in (first, others))
            assert drawn == pytest.approx(response.overshoot * 1e3, rel=1e-9)
        assert heights(axes) == pytest.approx([-0.1, 0.1])
    assert "linear return: crossing 81.5 mm, overshoot 0.76 mm, settled after 136.3 mm" in whole.get_title()


def test_servo_figure_says_what_does_not_happen_in_the_zone(paper: Design) -> None:
    rows = tuple(
        replace(row, response=replace(row.response, crossing=None, settling=None)) for row in paper.comparison.rows
    )
    figure = servo_figure(replace(paper.comparison, rows=rows), runs_of(paper.comparison))
    assert "no crossing in the zone" in texts(figure)
    assert "not settled in the zone" in texts(figure)


def test_bars_are_the_measures_and_the_unbounded_ones_say_so(paper: Design) -> None:
    figure = bars_figure(paper.comparison)
    rows = paper.comparison.rows
    columns = [
        [row.motion.peak_acceleration for row in rows],
        [row.motion.rms_acceleration for row in rows],
        [row.motion.peak_jerk for row in rows],
        [row.motion.rms_jerk for row in rows],
        [row.response.settling * 1e3 for row in rows],
    ]
    for axes, values in zip(figure.axes, columns, strict=True):
        bars = [patch.get_width() for patch in axes.patches]
        whole = axes.get_xlim()[1]
        assert bars == pytest.approx([whole if value is None else value for value in values])
        assert [text.get_text() for text in axes.texts].count("unbounded") == values.count(None)
    labels = [label.get_text() for label in figure.axes[0].get_yticklabels()]
    assert labels[0] == "optimised"
    assert labels[-1] == "linear return †"
    assert "parabolic †" in labels  # least of all peak accelerations, by a jerk without bound


def test_bars_beyond_a_limit_are_hatched(paper: Design) -> None:
    job = with_limits(paper.job, acceleration=12.0)
    figure = bars_figure(replace(paper.comparison, job=job))
    peaks = [row.motion.peak_acceleration for row in paper.comparison.rows]
    hatched = [bool(patch.get_hatch()) for patch in figure.axes[0].patches]
    assert hatched == [peak is None or peak > 12.0 for peak in peaks]


def test_bars_name_a_settling_length_that_does_not_exist(paper: Design) -> None:
    rows = tuple(replace(row, response=replace(row.response, settling=None)) for row in paper.comparison.rows)
    assert texts(bars_figure(replace(paper.comparison, rows=rows))).count("not in zone") == len(rows)


@pytest.mark.parametrize(
    ("start", "parts"), [(0.4, [(0.4, 0.5)]), (-0.05, [(0.55, 0.6), (0.0, 0.05)]), (0.5, [(0.5, 0.6)])]
)
def test_zones_that_go_over_the_seam_are_two(start: float, parts: list[tuple[float, float]]) -> None:
    cut = Cut(0.6, 1.0, 0.2, 0.1, 0.0, 1e-4)
    assert zone_parts(cut, start, 0.1) == [pytest.approx(part) for part in parts]


def test_every_baseline_has_a_title() -> None:
    assert len({title(name) for name in BASELINES}) == len(BASELINES)


def test_no_text_of_a_figure_is_cut_off(paper: Design) -> None:
    import matplotlib.style

    with matplotlib.style.context(["default", RC]):
        runs = runs_of(paper.comparison)
        for figure in (
            profile_figure(paper.comparison),
            servo_figure(paper.comparison, runs),
            bars_figure(paper.comparison),
        ):
            figure.draw_without_rendering()
            box, (width, height) = figure.get_tightbbox(), figure.get_size_inches()
            assert min(box.x0, box.y0) >= 0.0
            assert box.x1 <= width
            assert box.y1 <= height
