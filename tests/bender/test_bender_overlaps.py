"""What is drawn twice, wholly or in part: found, named and used once."""

import math
import re
import time
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camwright.bender.drawing import Drawing, Reading, read_drawing
from camwright.bender.overlaps import without_overlaps
from camwright.bender.piece import Piece
from camwright.profiles.errors import InputError
from tests.pace import in_time

Make = Callable[..., Path]
TOLERANCE = 1e-5


def read(path: Path, **more: object) -> Drawing:
    return read_drawing(path, Reading(1e-5, 1e-5, **more))  # type: ignore[arg-type]


def rectangle(m, x, y, width=100.0, height=60.0):
    m.add_lwpolyline([(x, y), (x + width, y), (x + width, y + height), (x, y + height)], close=True)


def lines(*rows):
    return lambda m, _: [m.add_line(a, b) for a, b in rows]


def bulged(m):
    m.add_lwpolyline([(20, 0, math.tan(math.pi / 8)), (0, 20, 0), (-30, 20, 0)], format="xyb")


def round_(*rows):
    return lambda m, _: [m.add_circle((0, 0), 20) if row is None else m.add_arc((0, 0), 20, *row) for row in rows]


RING = 40 * math.pi
DEGREE = RING / 360
DRAWN = {
    "a line drawn back": (lines(((0, 0), (10, 0)), ((10, 0), (0, 0))), 10.0, 10.0),
    "partly": (lines(((0, 0), (60, 0)), ((40, 0), (100, 0))), 100.0, 20.0),
    "one inside the other": (lines(((40, 0), (60, 0)), ((0, 0), (100, 0))), 100.0, 20.0),
    "over two lines": (lines(((0, 0), (50, 0)), ((50, 0), (100, 0)), ((20, 0), (90, 0))), 100.0, 70.0),
    "aslant": (lines(((0, 0), (30, 40)), ((15, 20), (60, 80))), 100.0, 25.0),
    "not quite the same": (lines(((0, 0), (100, 0)), ((0, 0.004), (100, -0.004))), 100.0, 100.0),
    "circle on circle": (round_(None, None), RING, RING),
    "arc on circle": (round_(None, (30, 200)), RING, 170 * DEGREE),
    "circle on arc": (round_((300, 60), None), RING, 120 * DEGREE),
    "arcs partly": (round_((0, 90), (45, 135)), 135 * DEGREE, 45 * DEGREE),
    "arcs that overlap at both ends": (round_((0, 200), (180, 30)), RING, 50 * DEGREE),
    "arc on a bulge": (lambda m, _: [bulged(m), m.add_arc((0, 0), 20, 0, 90)], 90 * DEGREE + 30, 90 * DEGREE),
    "bulge on an arc": (lambda m, _: [m.add_arc((0, 0), 20, 0, 90), bulged(m)], 90 * DEGREE + 30, 90 * DEGREE),
    "outline twice": (lambda m, _: [rectangle(m, 0, 0), rectangle(m, 0, 0)], 320.0, 320.0),
    "common cut": (lambda m, _: [rectangle(m, 0, 0), rectangle(m, 100, 0)], 580.0, 60.0),
    "common cut in part": (lambda m, _: [rectangle(m, 0, 0), rectangle(m, 100, 30)], 610.0, 30.0),
    "twice round": (
        lambda m, _: m.add_lwpolyline([(0, 0), (100, 0), (100, 60), (0, 60)] * 2, close=True),
        320.0,
        320.0,
    ),
}


@pytest.mark.parametrize("name", DRAWN)
def test_every_stretch_is_bent_once(drawing: Make, name: str):
    draw, once, doubled = DRAWN[name]
    path = drawing(draw)
    found = read(path)
    assert 1e3 * sum(outline.lengths.sum() for outline in found.outlines) == pytest.approx(once, abs=2e-3)
    assert 1e3 * sum(overlap.length for overlap in found.overlaps) == pytest.approx(doubled, abs=2e-3)
    for overlap in found.overlaps:
        assert "#" in overlap.first
        assert "#" in overlap.second
        assert f"{overlap.told}; it is bent once" in "\n".join(found.warnings)
    with pytest.raises(InputError, match=r"#[0-9A-F]+ on layer 0 lies on .*#[0-9A-F]+ on layer 0 over .* remove it"):
        read(path, overlaps="refuse")


APART = {
    "beside": lines(((0, 0), (100, 0)), ((0, 0.02), (100, 0.02))),
    "end to end": lines(((0, 0), (50, 0)), ((50, 0), (100, 0))),
    "end over end by less than the gap": lines(((0, 0), (50, 0)), ((49.995, 0), (100, 0))),
    "crossing": lines(((0, 0), (100, 1)), ((0, 1), (100, 0))),
    "circles inside each other": lambda m, _: [m.add_circle((0, 0), 20), m.add_circle((0, 0), 20.02)],
    "two halves of a circle": lambda m, _: [m.add_arc((0, 0), 20, 0, 180), m.add_arc((0, 0), 20, 180, 0)],
    "arc and its chord": lambda m, _: [m.add_arc((0, 0), 20, 0, 90), m.add_line((20, 0), (0, 20))],
}


@pytest.mark.parametrize("name", APART)
def test_what_does_not_lie_on_another(drawing: Make, name: str):
    assert read(drawing(APART[name]), overlaps="refuse").overlaps == ()


def test_common_cuts_of_step_and_repeat_are_named_by_their_references(drawing: Make):
    def draw(m, d):
        rectangle(d.blocks.new("BOX"), 0, 0)
        boxes.extend(m.add_blockref("BOX", (100 * column, 0)).dxf.handle for column in range(3))

    boxes: list[str] = []
    found = read(drawing(draw))
    names = [f"LWPOLYLINE #32 in block reference #{handle} on layer 0" for handle in boxes]
    assert [(o.first, o.second) for o in found.overlaps] == list(pairwise(names))
    assert [outline.closed for outline in found.outlines] == [True, False, False]


def test_cells_of_one_reference_are_told_apart(drawing: Make):
    def draw(m, d):
        rectangle(d.blocks.new("BOX"), 0, 0)
        m.add_blockref("BOX", (0, 0), dxfattribs={"column_count": 2, "column_spacing": 100})

    (overlap,) = read(drawing(draw)).overlaps
    assert re.fullmatch(r"LWPOLYLINE #32 in block reference #[0-9A-F]+ \(1\) on layer 0", overlap.first)
    assert re.fullmatch(r"LWPOLYLINE #32 in block reference #[0-9A-F]+ \(2\) on layer 0", overlap.second)


def test_what_is_left_of_a_partly_doubled_frame_joins_on(drawing: Make):
    def draw(m, _):
        m.add_line((0, 0), (60, 0))
        m.add_lwpolyline([(40, 0), (100, 0), (100, 60), (0, 60), (0, 0)])

    (frame,) = read(drawing(draw)).outlines
    assert frame.closed
    assert frame.lengths.sum() == pytest.approx(0.320)


@given(st.lists(st.tuples(st.integers(0, 3), st.integers(0, 20), st.integers(0, 20)), min_size=1, max_size=20))
def test_as_many_stretches_as_there_are_on_a_ruler(rows):
    """On four parallel lines of unit cells: what is left covers each cell that was covered, once."""
    drawn = [(row, a, b) for row, a, b in rows if a != b]
    slant = np.array([[0.6, -0.8], [0.8, 0.6]])
    pieces = [
        Piece(1e-3 * (np.array([[a, row], [b, row]], dtype=float) @ slant), np.zeros(1), f"{i}")
        for i, (row, a, b) in enumerate(drawn)
    ]
    if not pieces:
        return
    cells = {(row, k) for row, a, b in drawn for k in range(min(a, b), max(a, b))}
    left, found = without_overlaps(pieces, TOLERANCE)
    covered = []
    for piece in left:
        (a, row), (b, _) = np.round(1e3 * piece.points @ slant.T).astype(int).tolist()
        covered += [(row, k) for k in range(min(a, b), max(a, b))]
    assert sorted(covered) == sorted(cells)
    assert bool(found) == (sum(abs(b - a) for _, a, b in drawn) > len(cells))


@pytest.mark.parametrize(
    ("limit", "message"),
    [
        ("camwright.profiles.bender.boxes.MOST_PAIRS", "more than 100 pairs of lines lie beside each other"),
        ("camwright.bender.overlaps._MOST_CUTS", "more than 100 stretches of lines lie on others"),
    ],
)
def test_too_many_doubles_are_refused(limit: str, message: str, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(limit, 100)
    pieces = [Piece(np.array([[0.0, 0.0], [1.0 + 0.01 * i, 0.0]]), np.zeros(1), f"{i}") for i in range(20)]
    with pytest.raises(InputError, match=message):
        without_overlaps(pieces, TOLERANCE)


def test_many_copies_are_one_line_and_each_is_named():
    line = np.array([[0.0, 0.0], [1.0, 0.0]])
    pieces = [Piece(line[::-1] if i % 2 else line, np.zeros(1), f"{i}") for i in range(3000)]
    begin = time.process_time()
    left, found = without_overlaps(pieces, TOLERANCE)
    assert in_time(time.process_time() - begin, 1.0)
    assert [piece.name for piece in left] == ["0"]
    assert [(overlap.first, overlap.second) for overlap in found] == [("0", f"{i}") for i in range(1, 3000)]
    assert {overlap.length for overlap in found} == {1.0}
