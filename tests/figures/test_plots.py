"""The figures: what is drawn stands in the results, limits and jumps are marked, bytes repeat."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from camwright.figures.comparison import _xticks, bars_figure
from camwright.figures.design import design_figures
from camwright.figures.profile import profile_figure
from camwright.figures.servo import AXES, servo_figure
from camwright.figures.speed_band import speed_band_figure
from camwright.figures.strokes import LINES
from camwright.figures.style import title, zone_parts
from camwright.house.picture_files import write_pictures
from camwright.house.pictures import Arrow, Band, Bar, DrawnLine, DrawnMarks, Frame, Note, Picture
from camwright.house.svg import legend_rows, picture_svg, text_width
from camwright.jobs.job import BUNDLED_JOB, Job, load_job, parse_job
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


def lines(frame: Frame) -> list[DrawnLine]:
    return [item for item in frame.items if isinstance(item, DrawnLine)]


def curve(frame: Frame, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the line that has the colour of a profile and the most points."""
    line = max((line for line in lines(frame) if line.colour == LINES[name].colour), key=lambda line: len(line.points))
    return line.points[:, 0], line.points[:, 1]


def heights(frame: Frame) -> list[float]:
    """Return the heights of all dotted lines across a panel."""
    across = [line.points for line in lines(frame) if line.points[:, 0].tolist() == [frame.low[0], frame.high[0]]]
    return [float(points[0, 1]) for points in across if points[0, 1] == points[1, 1]]


def arrows(frame: Frame) -> list[tuple[float, float]]:
    """Return the tips of all arrows."""
    return [(item.place, item.tip) for item in frame.items if isinstance(item, Arrow)]


def notes(frame: Frame) -> list[str]:
    return [item.text for item in frame.items if isinstance(item, Note)]


def texts(picture: Picture) -> str:
    return "\n".join(text for frame in picture.frames for text in (*notes(frame), frame.title, frame.xlabel))


def with_limits(job: Job, **changes: float) -> Job:
    return replace(job, limits=replace(job.limits, **changes))


def test_every_figure_is_written_twice(paper: Design, tmp_path: Path) -> None:
    files = write_pictures(design_figures(paper), tmp_path)
    assert sorted(file.name for file in files) == EVERY_FILE
    assert sorted(file.name for file in tmp_path.iterdir()) == EVERY_FILE
    for file in files:
        data = file.read_bytes()
        if file.suffix == ".png":
            assert data.startswith(PNG)
        else:
            assert b"<svg" in data
            assert b"dc:date" not in data


def test_the_same_comparison_gives_the_same_bytes(paper: Design, tmp_path: Path) -> None:
    first, again = (picture_svg(bars_figure(paper.comparison)) for _ in range(2))
    assert first == again


def test_profile_curves_are_the_profiles_derivatives_over_time(paper: Design) -> None:
    figure = profile_figure(paper.comparison)
    v = paper.job.cut.line_speed
    for name in LINES:
        profile = paper.comparison[name].profile
        for axes, order, factor in zip(figure.frames[1:], (1, 2, 3), (1.0, v**2, v**3), strict=True):
            x, y = curve(axes, name)
            inside = np.min(np.abs(x[:, None] * 1e-3 - profile.breaks), axis=1) > 1e-9
            assert y[inside] == pytest.approx(factor * profile(x[inside] * 1e-3, order), rel=1e-12, abs=1e-12)
        x, y = curve(figure.frames[0], name)
        assert y == pytest.approx((profile(np.clip(x * 1e-3, 0, profile.end)) - x * 1e-3) * 1e3, abs=1e-9)


def test_profile_limits_are_lines(paper: Design) -> None:
    limits, v = paper.job.limits, paper.job.cut.line_speed
    _, ratio, acceleration, jerk = profile_figure(paper.comparison).frames
    assert heights(ratio) == pytest.approx([0.0, limits.speed / v])
    assert heights(acceleration) == pytest.approx([-limits.acceleration, limits.acceleration])
    assert heights(jerk) == pytest.approx([-limits.jerk, limits.jerk])


def test_a_limit_far_beyond_the_motion_is_named_not_drawn(paper: Design) -> None:
    job = with_limits(paper.job, acceleration=5000.0, speed=1000.0)
    _, ratio, acceleration, _ = profile_figure(replace(paper.comparison, job=job)).frames
    assert heights(acceleration) == []
    assert notes(acceleration) == ["limits ±5000: off scale"]
    assert heights(ratio) == [0.0]
    assert notes(ratio) == ["limit 750: off scale"]


def test_arrows_stand_at_the_jumps_of_the_linear_return_and_nowhere_else(paper: Design) -> None:
    _, ratio, acceleration, jerk = profile_figure(paper.comparison).frames
    start, end = paper.job.cut.return_zone * 1e3, paper.job.cut.length * 1e3
    low, high = acceleration.low[1], acceleration.high[1]
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
    _, _, acceleration, _ = profile_figure(comparison).frames
    assert heights(acceleration) == [-30.0, 30.0]
    assert arrows(acceleration) == []
    assert "crossing 0.0 mm" in texts(servo_figure(comparison, runs_of(comparison)))
    assert bars_figure(comparison).frames[0].high[0] > 0


def runs_of(comparison: Comparison) -> dict[str, object]:
    return {name: simulate(comparison[name].profile, comparison.job.cut, comparison.job.servo) for name in AXES}


def test_servo_figure_draws_every_phase_and_marks_crossing_and_settling(paper: Design) -> None:
    runs = runs_of(paper.comparison)
    figure = servo_figure(paper.comparison, runs)
    _, _, whole, close = figure.frames
    for frame in (whole, close):
        for name in AXES:
            response, colour = paper.comparison[name].response, LINES[name].colour
            others, first = (line for line in lines(frame) if line.colour == colour)
            assert not np.isnan(first.points).any()
            # the others are one line, a gap after each
            assert 1 + int(np.isnan(others.points[:, 1]).sum()) == runs[name].phases == response.phases
            marks = [item for item in frame.items if isinstance(item, DrawnMarks) and item.colour == colour]
            assert [mark.shape for mark in marks] == ["open", "diamond"]
            (crossing, _), (settling, there) = (mark.points[0].tolist() for mark in marks)
            assert crossing == pytest.approx(response.crossing * 1e3)
            assert settling == pytest.approx(response.settling * 1e3)
            assert abs(there) == pytest.approx(paper.job.cut.sync_tolerance * 1e3, rel=2e-3)
            drawn = max(np.nanmax(line.points[:, 1]) for line in (first, others))
            assert drawn == pytest.approx(response.overshoot * 1e3, rel=1e-9)
        assert heights(frame) == pytest.approx([-0.1, 0.1])
    assert "linear return †: crossing 81.5 mm, overshoot 0.76 mm, settled after 136.3 mm" in whole.title


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
    for frame, values in zip(figure.frames, columns, strict=True):
        widths = [item.high[0] for item in frame.items if isinstance(item, Bar)]
        assert widths == pytest.approx([frame.high[0] if value is None else value for value in values])
        assert notes(frame).count("unbounded") == values.count(None)
    assert figure.frames[0].yticks
    assert [tick.bold for tick in figure.frames[0].yticks] == [True] + [False] * (len(rows) - 1)
    labels = [tick.text for tick in figure.frames[0].yticks]
    assert labels[0] == "optimised"
    assert labels[-1] == "linear return †"
    assert "parabolic †" in labels  # least of all peak accelerations, by a jerk without bound


def test_bars_beyond_a_limit_are_hatched(paper: Design) -> None:
    job = with_limits(paper.job, acceleration=12.0)
    figure = bars_figure(replace(paper.comparison, job=job))
    peaks = [row.motion.peak_acceleration for row in paper.comparison.rows]
    hatched = [bool(item.hatch) for item in figure.frames[0].items if isinstance(item, Bar)]
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
    for picture in (
        profile_figure(paper.comparison),
        servo_figure(paper.comparison, runs_of(paper.comparison)),
        bars_figure(paper.comparison),
        speed_band_figure(paper),
    ):
        assert picture.title_left + max(text_width(line, 12.0) for line in picture.title.split("\n")) <= picture.width
        rows = legend_rows(picture.legend, picture.width)
        for frame in picture.frames:
            assert frame.top >= 12.0 + 14.0 * len(picture.title.split("\n")) + 14.0 * (
                frame.title.count("\n") + bool(frame.title)
            )
            below = frame.top + frame.height + (28.0 if frame.xlabel else 16.0 if frame.numbers else 4.0)
            assert below <= picture.height - 15.0 * len(rows)
            middle = frame.left + 0.5 * frame.width
            for text in (*frame.title.split("\n"), frame.xlabel):
                assert middle + 0.45 * text_width(text) <= picture.width
            names = [text_width(tick.text) for tick in frame.yticks or ()]
            assert max(names, default=0.0) * 0.93 <= frame.left - 6.5  # no letter of these is as wide as the bound


def test_zones_and_released_speeds_are_bands(paper: Design) -> None:
    cut = paper.job.cut
    for frame in profile_figure(paper.comparison).frames:
        bands = [(item.look, item.start, item.end) for item in frame.items if isinstance(item, Band)]
        assert bands == [
            ("grey", pytest.approx(400.0), pytest.approx(600.0)),
            ("hatched", pytest.approx(560.0), pytest.approx(600.0)),
        ]
    frame = speed_band_figure(paper).frames[0]
    released = [(item.start, item.end) for item in frame.items if isinstance(item, Band)]
    assert released == [pytest.approx((low * 60, high * 60)) for low, high in paper.band.parts]
    own = [line for line in lines(frame) if line.label == "line speed of the job"]
    assert own[0].points[:, 0].tolist() == pytest.approx([cut.line_speed * 60] * 2)
    # powers of ten: the curve at the job's speed is the error that the design reports
    speeds, errors = curve(frame, "optimised")
    there = 10.0 ** np.interp(cut.line_speed * 60, speeds, errors)
    assert there == pytest.approx(paper.comparison["optimised"].response.shear_zone_error * 1e3, rel=1e-6)
    assert frame.yticks
    assert [float(tick.text) for tick in frame.yticks] == pytest.approx([10.0**tick.value for tick in frame.yticks])


def test_an_inch_job_is_drawn_in_inches() -> None:
    text = BUNDLED_JOB.read_text(encoding="utf-8").replace('length = "600 mm"', 'length = "24 in"')
    inch = optimise(parse_job(text, "inch.toml"))
    profile, servo = profile_figure(inch.comparison), servo_figure(inch.comparison, runs_of(inch.comparison))
    bars, band = bars_figure(inch.comparison), speed_band_figure(inch)
    for picture in (profile, servo, bars, band):
        words = picture.title + "".join(f"{f.title} {f.xlabel} {f.ylabel} {notes(f)}" for f in picture.frames)
        assert not re.search(r"\bmm\b|m/min|\(m/s", words)
        assert re.search(r"\bin\b|ft/", words)
    assert profile.frames[0].high[0] == pytest.approx(24.0)
    assert heights(profile.frames[2]) == pytest.approx([-30.0 / 0.3048, 30.0 / 0.3048])
    assert band.frames[0].xlabel == "line speed (ft/min)"
    widths = [item.high[0] for item in bars.frames[0].items if isinstance(item, Bar)]
    assert widths[0] == pytest.approx(inch.objective / 0.3048, rel=1e-6)


@pytest.mark.parametrize("high", [0.33, 1.0, 6.2, 31.0, 100.6, 155.0, 21_103.0, 31_000.0, 987_654.0])
def test_numbers_below_bars_stand_clear_of_each_other_and_of_the_next_column(high: float) -> None:
    """Seven columns leave 49 pt to each."""
    chosen = _xticks(high, 60.0)
    assert chosen[0].value == 0.0
    ends = [(tick.value / high * 60.0, 0.5 * text_width(tick.text)) for tick in chosen]
    assert all(at + half < then - beside for (at, half), (then, beside) in pairwise(ends))
    assert sum(ends[-1]) <= 60.0
    assert len(chosen) > 1 or high > 1e5


def test_a_baseline_that_breaks_a_limit_is_marked_over_the_line_speed(paper: Design) -> None:
    picture = speed_band_figure(paper)
    assert "linear return †" in {item.label for item in picture.legend}
    assert "† breaks a limit of the job" in picture.title
