"""Layouts that are read and not written, and laws that only foreign files have."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline

from camwright import load_job
from camwright.drives.running_cam import running_cam
from camwright.profiles.errors import InputError
from camwright.profiles.returns import baseline
from camwright.profiles.tables.cam_table import make_table
from camwright.profiles.tables.interpolation import by_law
from camwright.profiles.tables.target import Header
from camwright.profiles.tables.targets import LAYOUTS, TARGETS, detect, layout_of, read_table

GALIL = """' knife, slave B
#CAM
EAA;EM 2000,1000
EP 20,0
NO ET[9]=7 is a remark
ET[0]=,0;ET[1]=,3
  ET[2]=,12
ET[3]=,40
EB 1
EN
"""


def test_a_galil_table_is_read():
    assert detect(GALIL, "cam.dmc").name == "galil"
    table = read_table(detect(GALIL, "cam.dmc"), GALIL, "cam.dmc")
    assert table.x.tolist() == [0, 20, 40, 60]
    assert table.y.tolist() == [0, 3, 12, 40]
    assert LAYOUTS["galil"].rebuild(table)(30.0) == pytest.approx(7.5)
    assert "20 counts of the master" in table.notes[0]
    uncounted = read_table(LAYOUTS["galil"], GALIL.replace("EP 20,0\n", ""), "cam.dmc")
    assert uncounted.x.tolist() == [0, 1, 2, 3]
    assert "EP, the master interval, is not in the file" in uncounted.notes[0]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("ET[2]=,12", "ET[N]=((4800)*((1-@COS[(N*2)]))/2)", r"line 7: ET\['N'\] is filled by the program as it runs"),
        ("ET[2]=,12", "ET[2]=12", "line 7: ET gives positions of more than one slave"),
        ("ET[2]=,12", "ET[2]=1,12", r"line 7: ET\[2\] must give the position of one slave; it gives 2"),
        ("ET[2]=,12", "ET[1]=,12", r"line 7: ET\[1\] is given twice"),
        ("ET[2]=,12", "", r"ET\[2\] is missing: the entries run from ET\[0\] to ET\[3\]"),
        ("ET[2]=,12", "ET[99999]=,12", r"ET\[0\] is missing|ET\[2\] is missing"),
        ("ET[2]=,12", "ET[2]=,x+1", "line 7: 'x\\+1' is not a number; write the positions as numbers"),
        ("ET[2]=,12", "EW 2=30", "line 7: EW widens segments"),
        ("EP 20,0", "EP 20\nEP 30", "line 5: EP gives more than one master interval"),
        ("EP 20,0", "EP 0", "line 4: EP 0 is no master interval"),
    ],
)
def test_a_galil_table_that_says_less_is_refused(old: str, new: str, message: str):
    with pytest.raises(InputError, match=message):
        LAYOUTS["galil"].read(GALIL.replace(old, new), "cam.dmc")


def arrays(x: list[float], y: list[float]) -> str:
    """Write a table as the cam editor Quintic does."""
    return (
        f"(* Quintic Cam Profile Export *)\n(* Total Points: {len(x)} *)\n\n"
        f"MasterPos : ARRAY[1..{len(x)}] OF LREAL := [{', '.join(f'{value:.4f}' for value in x)}];\n\n"
        f"SlavePos : ARRAY[1..{len(y)}] OF LREAL := [{', '.join(f'{value:.4f}' for value in y)}];\n\n"
        f"(* Logic Tracks *)\nTrack_1 : ARRAY[1..{len(x)}] OF BOOL := [{', '.join(['FALSE'] * len(x))}];\n"
    )


def test_two_arrays_of_a_cam_editor_are_a_cam_of_the_job():
    job = load_job()
    profile = baseline("double_s", job.task)
    x = np.linspace(0, profile.length, 181)
    text = arrays((x / profile.length * 360).tolist(), (1e3 * profile(x)).tolist())
    found = running_cam(text, "cam.st", job)
    assert found.target.name == "st-arrays"
    assert found.table.points == 181
    assert any("a cubic spline is assumed" in note for note in found.notes)
    error = found.cycle(x) - profile(x)
    assert np.abs(error - error[0]).max() < 1e-6


def test_the_columns_of_that_editor_are_a_cam_of_the_job():
    job = load_job()
    profile = baseline("double_s", job.task)
    x = np.linspace(0, profile.length, 181)
    turn = 360 / profile.length  # degrees of the cycle
    columns = [turn * x, *(1e3 * profile(x, order) / turn**order for order in range(4))]
    rows = [",".join(f"{value:.6f}" for value in row) + ",0" for row in zip(*columns, strict=True)]
    text = "\ufeffTheta (deg),S (Pos),V (Vel),A (Acc),J (Jerk),Blow off (CH1)\n" + "\n".join(rows) + "\n"
    found = running_cam(text, "cam.csv", job)
    assert any("so that they belong to the positions" in note for note in found.notes)
    error = found.cycle(x) - profile(x)
    assert np.abs(error - error[0]).max() < 1e-6


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("SlavePos", "Unknown", "there is no array of LREAL with positions of the slave"),
        ("Track_1 : ARRAY[1..3] OF BOOL", "MasterZero : ARRAY[1..3] OF LREAL", "line 9: both 'MasterPos' and 'MasterZero' look"),
        ("SlavePos : ARRAY[1..3]", "SlavePos : ARRAY[1..4]", "line 6: the array 'SlavePos' has 4 places but 3 values"),
        ("[0.0000, 5.0000, 9.0000]", "[0.0000, a, 9.0000]", "line 6: the array 'SlavePos' holds something that is no number"),
        ("[0.0000, 1.0000, 2.0000]", "[0.0000, 1.0000, 1.0000]", "line 4: master positions must increase strictly"),
        (
            "SlavePos : ARRAY[1..3] OF LREAL := [0.0000, 5.0000, 9.0000]",
            "SlavePos : ARRAY[1..2] OF LREAL := [0.0000, 5.0000]",
            "line 6: there are 3 master positions but 2 slave positions",
        ),
    ],
)  # fmt: skip
def test_arrays_that_are_no_cam_are_refused(old: str, new: str, message: str):
    text = arrays([0, 1, 2], [0, 5, 9])
    assert old in text
    with pytest.raises(InputError, match=message):
        LAYOUTS["st-arrays"].read(text.replace(old, new), "cam.st")


def test_what_is_read_only_is_no_target():
    assert set(LAYOUTS) - set(TARGETS) == {"galil", "st-arrays", "trio-linked-moves"}
    assert layout_of("GALIL") is LAYOUTS["galil"]
    with pytest.raises(InputError, match=r"there is no layout 'gail'; the layouts are codesys, .*galil"):
        layout_of("gail")
    table = read_table(LAYOUTS["galil"], GALIL, "cam.dmc")
    with pytest.raises(InputError, match="of 4 points of knife is not written: this layout is read only"):
        LAYOUTS["galil"].write(table, Header("knife", "1"))


def test_a_cubic_piece_is_hermites():
    x, y, ratio = [0.0, 2.0, 5.0, 6.0], [0.0, 3.0, 3.5, 7.0], [0.5, -1.0, 0.0, 2.0]
    profile = by_law(make_table(x, y, ratio, law="cubic"))
    at = np.linspace(0.0, 6.0, 61)[:-1]
    for order in range(3):
        np.testing.assert_allclose(profile(at, order), CubicHermiteSpline(x, y, ratio)(at, order), atol=1e-12)
    with pytest.raises(InputError, match="piece 1 is a cubic, but a knot of it has no ratio"):
        by_law(make_table(x, y, [np.nan, 1.0, 0.0, 0.0], law="cubic"))


def polynom3(ratio: float) -> str:
    rows = [(0, 0, 0, 3), (120, 30, 0, 1), (240, 60, ratio, 3), (360, 90, ratio, 3)]
    return "".join(
        f"p[{k}].PointIndex := {k};\np[{k}].FunctionType := {function};\np[{k}].MasterPos := {x};\np[{k}].SlavePos := {y};\n"
        f"p[{k}].SlaveVelo := {v};\n"
        for k, (x, y, v, function) in enumerate(rows, start=1)
    )


def test_a_polynom3_leads_from_rest_to_rest():
    table = TARGETS["twincat"].read(polynom3(0.0), "cam.st")
    assert table.laws == ("cubic", "line", "cubic")
    profile = TARGETS["twincat"].rebuild(table)
    u = np.linspace(0.0, 1.0, 11)
    np.testing.assert_allclose(profile(240 + 120 * u[:-1]), 60 + 30 * (3 * u**2 - 2 * u**3)[:-1])
    with pytest.raises(
        InputError, match="line 11: a POLYNOM3 leads from rest to rest, but a point of it has a velocity"
    ):
        TARGETS["twincat"].read(polynom3(0.25), "cam.st")


PROGRAM = """' two axes were loaded, this one is the knife
profile_link_dist = 321.92
profile_start = 4.2 : master_ax = 10
TABLE(1000, 0, 994, 2988, 5000)
TABLE(3000, 1, 2, 3)
CAMBOX(1000, 1003, 0.5, profile_link_dist, master_ax, 8194, profile_start) AXIS(0)
WAIT LOADED AXIS(0)
"""


def test_variables_of_a_trio_program_are_known():
    table = TARGETS["trio"].read(PROGRAM, "cam.bas")
    np.testing.assert_allclose(table.x, np.linspace(0.0, 321.92, 4))
    assert table.y.tolist() == [0.0, 497.0, 1494.0, 2500.0]
    twice = PROGRAM.replace("master_ax = 10", "profile_link_dist = 300")
    with pytest.raises(InputError, match="the addresses of the table have a gap"):  # of two values neither is taken
        TARGETS["trio"].read(twice, "cam.bas")
