"""What is no number is refused with its line, wherever it stands; nothing is passed over."""

from __future__ import annotations

import pytest

from camwright.profiles.errors import InputError
from camwright.profiles.tables.targets import TARGETS

HEAD = "x [mm],y [mm],dy/dx [1],d2y/dx2 [1/m]\n"
ROWS = ["0.0,0.0,1.0,0.0", "200.0,100.0,0.1,0.0", "400.0,300.0,1.0,0.0", "600.0,400.0,1.0,0.0"]
POINTS = "\n".join(
    f"p[{k}].FunctionType := 15; p[{k}].MasterPos := {x}; p[{k}].SlavePos := {y}; p[{k}].SlaveVelo := 1.0; p[{k}].SlaveAcc := 0.0;"
    for k, (x, y) in enumerate(((0.0, 0.0), (200.0, 100.0), (600.0, 400.0)), start=1)
)


@pytest.mark.parametrize("row", range(4))
@pytest.mark.parametrize("cell", ["0.0x", "nan", "2.0*(0)", "x", "#REF!", ""])
def test_a_first_cell_that_is_no_number_is_refused_by_line(row: int, cell: str) -> None:
    rows = [*ROWS]
    rows[row] = ",".join([cell, *rows[row].split(",")[1:]])
    with pytest.raises(InputError, match=rf"line {row + 2}\b"):
        TARGETS["csv"].read(HEAD + "\n".join(rows) + "\n", "cam.csv")


def test_headings_of_several_lines_stay_headings() -> None:
    text = "Channel,1,2,3\n" + HEAD + "\n".join(ROWS) + "\n"
    assert TARGETS["csv"].read(text, "cam.csv").points == 4


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("SlavePos := 100.0", "SlavePos := --100.0", "slavepos must be a number"),
        ("SlavePos := 100.0", "SlavePos := -(100.0)", "slavepos must be a number"),
        ("SlavePos := 100.0", "SlavePos := 100.0+1.0", "slavepos must be a number"),
        ("SlavePos := 100.0", "SlavePos := 2.0*50.0", "slavepos must be a number"),
        ("SlavePos := 100.0", "SlavePos := 100,0", "line 2"),
        ("p[2].SlavePos", "p[2].SlavePoz", "a point has no member 'slavepoz'"),
        ("p[2].SlavePos", "p[k].SlavePos", "'slavepos' is given a value, but of which point is not known"),
        ("p[2].SlavePos", "p2].SlavePos", "'slavepos' is given a value, but of which point is not known"),
        ("p[2].SlavePos", "q[2].SlavePos", "fills more than one array of points"),
    ],
)
def test_an_assignment_that_is_not_understood_is_refused_by_line(old: str, new: str, said: str) -> None:
    assert TARGETS["twincat"].read(POINTS, "cam.st").points == 3
    with pytest.raises(InputError, match="line 2") as caught:
        TARGETS["twincat"].read(POINTS.replace(old, new, 1), "cam.st")
    assert said in str(caught.value)
