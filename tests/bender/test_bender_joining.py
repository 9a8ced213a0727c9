"""Loose pieces: branches, frames that stay closed, free ends that nearly meet."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camwright.bender.joining import join
from camwright.bender.near_ends import near_ends
from camwright.bender.piece import Piece
from camwright.profiles.errors import InputError

GAP = 1e-5


def line(*places: tuple[float, float], bulge: float = 0.0) -> Piece:
    points = 1e-3 * np.array(places, dtype=float)
    return Piece(points, np.full(len(points) - 1, bulge), f"LINE {places}")


def shapes(paths: list[Piece]) -> list[tuple[bool, int, float]]:
    """Whether each path is closed, its number of segments and its length (mm)."""
    return sorted((path.closed, len(path.bulges), round(1e3 * path.length, 4)) for path in paths)


FRAME = [line((0, 0), (100, 0)), line((100, 0), (100, 60)), line((100, 60), (0, 60)), line((0, 60), (0, 0))]
CASES = {
    # the frame's lower side in two, and a branch between them that comes first
    "tee": (
        [line((50, 0), (50, 30)), line((0, 0), (50, 0)), line((50, 0), (100, 0)), *FRAME[1:]],
        [(False, 1, 30.0), (True, 5, 320.0)],
    ),
    "branch straight on from a corner": ([*FRAME, line((100, 0), (140, 0))], [(True, 4, 320.0), (False, 1, 40.0)]),
    "two of them": (
        [*FRAME, line((100, 0), (140, 0)), line((-40, 60), (0, 60))],
        [(True, 4, 320.0), (False, 1, 40.0), (False, 1, 40.0)],
    ),
    "diagonal of a frame": ([line((0, 0), (100, 60)), *FRAME], [(False, 1, 116.619), (True, 4, 320.0)]),
    "crossing": (
        [line((0, 0), (10, 0)), line((10, 0), (10, 10)), line((10, 0), (20, 0)), line((10, -10), (10, 0))],
        [(False, 2, 20.0), (False, 2, 20.0)],
    ),
    "two frames that touch": (
        [*FRAME, *(line(a, b) for a, b in itertools.pairwise([(100, 60), (150, 60), (150, 90), (100, 90), (100, 60)]))],
        [(True, 4, 320.0), (True, 4, 160.0)],
    ),
    "a loop with a tail": (
        [line((-50, 0), (0, 0)), line((0, 0), (30, 0), (30, 30)), line((30, 30), (0, 30), (0, 0))],
        [(False, 1, 50.0), (True, 4, 120.0)],
    ),
    "line that branches into an arc and a line: tangent": (
        [line((0, 0), (10, 0)), line((10, 0), (20, 5)), line((10, 0), (20, 10), bulge=math.tan(math.pi / 8))],
        [(False, 2, round(10 + 5 * math.pi, 4)), (False, 1, round(math.hypot(10, 5), 4))],
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_branches(name: str):
    pieces, expected = CASES[name]
    assert shapes(join(pieces, GAP)) == sorted(expected)


@given(st.sampled_from(sorted(CASES)), st.randoms(use_true_random=False))
def test_order_and_sense_in_the_file_do_not_matter(name: str, random):
    pieces, expected = CASES[name]
    mixed = [piece.reverse() if random.random() < 0.5 else piece for piece in pieces]
    random.shuffle(mixed)
    assert shapes(join(mixed, GAP)) == sorted(expected)


@given(st.lists(st.tuples(st.integers(0, 4), st.integers(0, 4), st.integers(0, 4), st.integers(0, 4)), max_size=25))
def test_every_piece_is_used_once_and_no_frame_passes_a_place_twice(rows):
    pieces = [line((10 * a, 10 * b), (10 * c, 10 * d)) for a, b, c, d in rows if (a, b) != (c, d)]
    paths = join(pieces, GAP)
    assert sum(len(path.bulges) for path in paths) == len(pieces)
    assert sum(path.length for path in paths) == pytest.approx(sum(piece.length for piece in pieces))
    for path in paths:
        inner = {tuple(place) for place in path.points[:-1].tolist()}
        assert len(inner) == len(path.points) - 1


def test_a_path_runs_as_its_first_piece_and_is_called_after_it():
    path = join([line((10, 0), (20, 0)), line((30, 5), (20, 0)), line((0, 0), (10, 0))], GAP)[0]
    assert path.points[:, 0] == pytest.approx(1e-3 * np.array([0, 10, 20, 30]))
    assert path.name == "LINE ((10, 0), (20, 0)) and 2 joined to it"


def test_too_many_ends_at_one_place():
    star = [line((0, 0), (math.cos(i), math.sin(i))) for i in range(401)]
    with pytest.raises(InputError, match=r"401 ends meet at \(0.000, 0.000\) mm, more than 400"):
        join(star, GAP)


def test_ends_that_nearly_meet_are_named_and_the_gap_closes_them():
    pieces = [line((0.02, 0), (99.98, 0)), line((100, 0.02), (100, 59.98)), line((100, 60), (0, 60), (0, 0))]
    found = near_ends(join(pieces, GAP), GAP)
    assert [ends.distance for ends in found] == pytest.approx([0.02e-3, math.hypot(0.02, 0.02) * 1e-3, 0.02e-3])
    assert (
        "LINE ((0.02, 0), (99.98, 0)) and LINE ((100, 0.02), (100, 59.98)) end 0.0283 mm apart at (99.980, 0.000) mm"
        in found[1].told
    )
    gap = max(ends.gap for ends in found)
    assert gap == pytest.approx(0.029e-3)
    (frame,) = join(pieces, gap)
    assert frame.closed
    assert near_ends([frame], gap) == ()


def test_how_near_is_near():
    def apart(distance: float, gap: float) -> int:
        return len(near_ends(join([line((0, 0), (10, 0)), line((10 + distance, 0), (20, 0))], gap), gap))

    assert [apart(d, GAP) for d in (0.005, 0.011, 0.99, 1.01)] == [0, 1, 1, 0]
    assert [apart(d, 1e-4) for d in (1.99, 2.01)] == [1, 0]  # 20 gaps


def test_a_line_that_nearly_closes_and_one_that_is_short():
    (ends,) = near_ends([line((0, 0), (50, 0), (50, 50), (0, 0.5))], GAP)
    assert ends.told.startswith("the ends of LINE")
    assert near_ends([line((0, 0), (0.8, 0))], GAP) == ()
