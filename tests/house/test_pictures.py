"""Pictures: round ticks, lines without what cannot be seen, and lines that stay lines in every file."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camwright.house.picture_files import write_pictures
from camwright.house.pictures import Band, DrawnLine, DrawnMarks, Frame, Picture, ticks
from camwright.house.svg import FINEST, picture_svg, simplified


@given(st.floats(-1e3, 1e3), st.floats(1e-3, 1e5), st.integers(3, 20))
def test_ticks_are_round_numbers_inside(place: float, width: float, most: int):
    low = place * width
    high = low + width
    values, labels = ticks(low, high, most)
    assert 1 <= len(values) <= most
    steps = np.diff(values)
    assert values[0] >= low - 1e-6 * width
    assert values[-1] <= high + 1e-6 * width
    if len(values) > 1:
        step = float(steps[0])
        assert steps == pytest.approx(step)
        leading = step / 10.0 ** math.floor(math.log10(step) + 1e-6)
        assert min(abs(leading - digit) for digit in (1, 2, 5)) < 1e-4
        # with the next finer step there would be too many
        finer = step / (2.5 if abs(leading - 5) < 1e-4 else 2)
        assert math.floor(high / finer + 1e-6) - math.ceil(low / finer - 1e-6) + 1 >= most
        assert [float(label.replace("\u2212", "-")) for label in labels] == pytest.approx(values, abs=1e-6 * step)
        assert len(set(labels)) == len(labels)


def test_ticks_as_written():
    assert ticks(-55, 60, 6)[1] == ["\u221240", "\u221220", "0", "20", "40", "60"]
    assert ticks(0.0, 1.0, 6)[1] == ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]


def distance(points: np.ndarray, line: np.ndarray) -> float:
    """Greatest distance of points from a polyline, side by side."""
    start, along = line[:-1], np.diff(line, axis=0)
    size = np.maximum((along**2).sum(axis=1), 1e-300)
    part = np.clip(((points[:, None] - start) * along).sum(axis=2) / size, 0, 1)
    return float(np.hypot(*np.moveaxis(points[:, None] - start - part[..., None] * along, 2, 0)).min(axis=1).max())


@given(st.integers(0, 10**6), st.integers(2, 300), st.floats(0.01, 3.0))
def test_a_simplified_line_is_the_same_line_for_the_eye(seed: int, count: int, step: float):
    random = np.random.default_rng(seed)
    points = np.round(np.cumsum(random.normal(0, step, (count, 2)) * [1, 0.2], axis=0), 2)
    kept = simplified(points)
    assert len(kept) <= len(points)
    assert (kept[0] == points[0]).all()
    assert (kept[-1] == points[-1]).all()
    assert {tuple(p) for p in kept.tolist()} <= {tuple(p) for p in points.tolist()}
    if len(kept) > 1:
        assert distance(points, kept) <= 6 * FINEST + 1e-9


def test_points_on_a_straight_line_go_and_corners_stay():
    line = np.stack([np.linspace(0, 100, 4001), np.zeros(4001)], axis=1)
    assert len(simplified(line)) < 4001 / 30
    corner = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 0.0], [10.0, 10.0]])
    assert simplified(corner).tolist() == [[0, 0], [10, 0], [10, 10]]


def picture(count: int) -> Picture:
    wave = np.stack([np.arange(count), np.arange(count) % 2], axis=1).astype(np.float64)
    wave[count // 2] = np.nan  # two stretches
    items = (DrawnLine(wave, "#11304f", 0.9, "a wave"), DrawnMarks(wave[:1], "#c1121f", 6.0, "ring", "its start"))
    panel = Frame(60, 48, 480, 240, np.array([0.0, -1.0]), np.array([count, 2.0]), items, "x (mm)", "y (mm)", "wave")
    return Picture(648, 360, "A <wave> & its start", 60, (panel,), items)


def test_ten_thousand_segments_stay_a_vector(tmp_path: Path):
    write_pictures({"few": picture(11), "many": picture(10_001)}, tmp_path)
    for name, least in (("few", 10), ("many", 9_990)):
        text = (tmp_path / f"{name}.svg").read_text(encoding="utf-8")
        assert "<image" not in text
        assert "data:" not in text
        assert "A &lt;wave&gt; &amp; its start</text>" in text
        path = re.search(r'<path d="(M[^"]*)" stroke="#11304f" stroke-width="0.9"', text)
        assert path is not None
        assert path[1].count("M") == 2
        assert len(path[1].replace("M", " ").split()) // 2 >= least
        assert (tmp_path / f"{name}.png").read_bytes().startswith(b"\x89PNG")
    # where the line runs: the first of eleven points lies at the left edge, a third up in [-1, 2]
    few = re.search(r'<path d="M([\d.]+) ([\d.]+) ', (tmp_path / "few.svg").read_text(encoding="utf-8"))
    assert few is not None
    assert (float(few[1]), float(few[2])) == (0.0, 160.0)


def test_ticks_without_room_for_their_decimals_are_powers_of_ten():
    assert ticks(0.0, 3e-6, 6)[1] == ["0", "1e\u22126", "2e\u22126", "3e\u22126"]


def test_a_band_is_as_wide_as_its_part_and_dotted_where_it_has_none():
    bands = (Band(2.0, 4.0, "grey", "sync"), Band(3.0, 4.0, "hatched"), Band(8.0, 8.0, "hatched"))
    frame = Frame(10, 10, 100, 50, np.array([0.0, 0.0]), np.array([10.0, 1.0]), bands, "x")
    text = picture_svg(Picture(120, 90, "", 10, (frame,), bands[:1]))
    assert '<rect x="20" width="20" height="50" fill="#e4e4e4"/>' in text
    assert '<rect x="30" width="10" height="50" fill="url(#cam-hatch)"/>' in text
    assert '<path d="M80 0V50" stroke="#000" stroke-width="1.5" stroke-dasharray="1.5 2.5"/>' in text
    assert text.count('<pattern id="cam-hatch"') == 1
    assert ">sync</text>" in text
