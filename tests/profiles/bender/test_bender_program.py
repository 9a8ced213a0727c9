"""NC programs: the paper's fragment, both flavours, roll-over, and what the reader refuses."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camwright.profiles.bender.nc_code import (
    Flavour,
    Numbering,
    read_program,
    write_program,
)
from camwright.profiles.bender.program import NcProgram
from camwright.profiles.errors import InputError

PAPER = """\
N010 G01 G91 X22.000
N011 G01 G90 Y90.000
N012 G01 G90 Y0.0
N013 G01 G91 X22.000
N014 G01 G90 Y270.000
N015 G01 G90 Y0.0
N016 G01 G91 X12.500
"""


def program(feeds: list[int], bends: list[int], name: str = "TEST") -> NcProgram:
    return NcProgram(name, np.array(feeds, dtype=np.int64), np.array(bends, dtype=np.int64))


def test_fragment_of_the_paper():
    # feeds and angles as printed; the lines that the paper leaves out are bends of 17.4° to the right
    right = 342_600 - 360_000
    text = write_program(
        program([22_000, 22_000, 12_500, 1_000, 1_000, 320, 203], [90_000, -90_000, right, right, right, right]),
        "fagor", Numbering(), 30_000.0,
    )  # fmt: skip
    lines = text.splitlines()
    assert PAPER in text
    assert "N025 G01 G91 X0.320" in lines
    assert "N026 G01 G90 Y342.600" in lines
    assert lines[lines.index("N026 G01 G90 Y342.600") + 1] == "N027 G01 G90 Y0.0"
    assert lines[-2:] == ["N028 G01 G91 X0.203", "N029 M30"]
    assert lines[0] == "%TEST"


@given(
    st.lists(st.tuples(st.integers(0, 10**7), st.integers(-179_999, 179_999).filter(bool)), max_size=30),
    st.integers(1, 10**7),
    st.sampled_from(["fagor", "iso"]),
)
def test_read_back(rows: list[tuple[int, int]], last: int, flavour: Flavour):
    written = program([feed for feed, _ in rows] + [last], [bend for _, bend in rows])
    read = read_program(write_program(written, flavour, Numbering(10, 25), 1000.0))
    assert read.name == "TEST"
    assert (read.feeds == written.feeds).all()
    assert (read.bends == written.bends).all()


def test_roll_over_of_line_numbers():
    text = write_program(program([1000] * 5, [90_000] * 4), "iso", Numbering(10, 14), 1000.0)
    numbers = [line.split()[0] for line in text.splitlines() if line.startswith("N")]
    assert numbers[3:] == [f"N{10 + i % 5:03d}" for i in range(5 + 8 + 1)]
    assert text.startswith("%\n(TEST)\nN001 G21\n")
    assert text.endswith("M30\n%\n")


def test_bend_blocks_find_the_lines_of_the_bends():
    made = program([1000, 0, 500], [90_000, -10_000])
    lines = write_program(made, "fagor", Numbering(), 1.0).splitlines()[4:]
    assert [lines[i].split()[-1] for i in made.bend_blocks()] == ["Y90.000", "Y350.000"]
    assert made.blocks == len(lines) - 1


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("N010 G01 G91 X-1.000", "fed forwards only"),
        ("N010 G01 G90 Y180.000", "not at 180°"),
        ("N010 G01 G90 Y361.000", "between 0 and 360°"),
        ("N010 G02 G91 X1.000", "is not a header, feed, bend, return or end line"),
        ("N010 G01 G91 X1.0005", "is not a header"),
        ("N010 G01 G90 Y90.000\nN011 G01 G91 X1.000", "must return to zero"),
        ("N010 M30\nN011 G01 G91 X1.000", "after the end"),
        ("N002 G94 F1.000", "no end"),
    ],
)
def test_reader_refuses(line: str, message: str):
    with pytest.raises(InputError, match=message):
        read_program(f"%X\nN001 G71\n{line}\n", "x.nc")


@pytest.mark.parametrize(
    ("feeds", "bends", "message"),
    [
        ([1], [5], "needs m \\+ 1 feeds"),
        ([-1], [], "forwards only"),
        ([1, 1], [0], "between 0 and 180"),
        ([1, 1], [180_000], "180"),
    ],
)
def test_programs_refused(feeds: list[int], bends: list[int], message: str):
    with pytest.raises(InputError, match=message):
        program(feeds, bends)


@pytest.mark.parametrize(("first", "last"), [(3, 9999), (10, 9), (10, 10**9)])
def test_numbering_refused(first: int, last: int):
    with pytest.raises(InputError, match="line numbers from"):
        Numbering(first, last)
