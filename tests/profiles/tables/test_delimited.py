"""Columns of numbers as people have them: separators, decimal commas, headings, units, encodings, scopes."""

from __future__ import annotations

import numpy as np
import pytest

from camwright.profiles.errors import InputError
from camwright.profiles.tables.cam_rows import read_cam_csv
from camwright.profiles.tables.column_words import cam_role, split_unit, trace_role
from camwright.profiles.tables.targets import TARGETS, detect, read_table
from camwright.profiles.tables.text import decode
from camwright.profiles.tables.trace_csv import read_trace_csv

X = np.array([0.0, 1.5, 3.0, 4.5])
Y = np.array([0.0, 2.25, 2.5, 3.75])


def rows(sign: str, *, comma: bool = False, before: str = "", behind: str = "") -> str:
    lines = [f"{before.format(n=n)}{a}{sign}{b}{behind}" for n, (a, b) in enumerate(zip(X, Y, strict=True))]
    text = "\n".join(lines) + "\n"
    return text.replace(".", ",") if comma else text


@pytest.mark.parametrize(
    "text",
    [
        "x [mm],y [mm]\n" + rows(","),
        "Master [mm];Slave [mm]\n" + rows(";", comma=True),
        "Master [mm];Slave [mm];\n" + rows(";", comma=True, behind=";"),
        "Leitachse (mm)\tFolgeachse (mm)\n" + rows("\t", comma=True),
        "master mm | slave mm\n" + rows("|"),
        'sep=;\n"Master [mm]";"Slave [mm]"\n' + rows(";", comma=True),
        "sep=,\nmaster_mm,slave_mm\n" + rows(","),
        'Master [mm],Slave [mm]\n"0,0","0,0"\n"1,5","2,25"\n"3,0","2,5"\n"4,5","3,75"\n',
        "Knife 3, upper drum\nexported by hand\nMaster;Slave\n[mm];[mm]\n" + rows(";", comma=True),
        "Master,Slave\nmm,mm\n" + rows(","),
        "主轴位置(毫米),从轴位置(毫米)\n" + rows(","),
        "No;Master [mm];Slave [mm]\n" + rows(";", before="{n};"),
        "# Master [mm];Slave [mm]\n" + rows(";"),
        "Leitwert / mm;Folgewert / mm\r\n" + rows(";", comma=True).replace("\n", "\r\n"),
    ],
)
def test_the_same_table_in_many_hands(text: str) -> None:
    for data in (text.encode(), text.encode("utf-16"), text.encode("utf-16-le"), b"\xef\xbb\xbf" + text.encode()):
        read = decode(data, "t")
        assert detect(read, "t").name == "csv"
        found = read_cam_csv(read, "t")
        assert found.words is None
        assert found.x == pytest.approx(X * 1e-3)
        assert found.y == pytest.approx(Y * 1e-3)


def test_old_code_pages() -> None:
    chinese = "主轴(毫米),从轴(毫米)\n" + rows(",")
    assert read_cam_csv(decode(chinese.encode("gbk"), "t"), "t").x == pytest.approx(X * 1e-3)
    german = "Länge der Leitachse (°);Hub (µm)\n" + rows(";")
    found = read_cam_csv(decode(german.encode("cp1252"), "t"), "t")
    assert found.words == ("deg", "um")


def test_an_index_without_a_name_is_passed_over() -> None:
    found = read_cam_csv(rows(";", before="{n};"), "t")
    assert found.x == pytest.approx(X)
    assert found.words == (None, None)
    assert "the first column counts the rows" in found.notes


def test_velocity_and_acceleration_are_scaled_to_the_positions() -> None:
    x = np.linspace(0.0, 2.0, 41)
    y = x + np.sin(np.pi * x) / np.pi
    v, a = 1.0 + np.cos(np.pi * x), -np.pi * np.sin(np.pi * x)
    lines = [
        f"{p!r},{q!r},{r!r},{s!r}" for p, q, r, s in zip(*(c.tolist() for c in (x, y, 7.5 * v, 0.02 * a)), strict=True)
    ]
    found = read_cam_csv("Theta (deg),S (Pos),V (Vel),A (Acc)\n" + "\n".join(lines) + "\n", "t")
    assert found.words == ("deg", None)
    assert found.dy is not None
    assert found.d2y is not None
    assert found.dy == pytest.approx(v, abs=5e-4)
    assert found.d2y == pytest.approx(a, abs=1e-2)
    assert found.y == pytest.approx(y, abs=1e-4)
    coarse = [
        f"{p!r},{q:.3f},{7.5 * r!r},{0.02 * s!r}"
        for p, q, r, s in zip(*(c.tolist() for c in (x, y, v, a)), strict=True)
    ]
    again = read_cam_csv("Theta (deg),S (Pos),Slave vel [m/s],A (Acc)\n" + "\n".join(coarse) + "\n", "t")
    assert again.y == pytest.approx(y, abs=1e-3)
    lines = [
        f"{p!r},{q!r},{r!r},{s!r}" for p, q, r, s in zip(*(c.tolist() for c in (x, y, v[::-1] + x, a)), strict=True)
    ]
    found = read_cam_csv("Theta (deg),S (Pos),V (Vel),A (Acc)\n" + "\n".join(lines) + "\n", "t")
    assert found.dy is None
    assert any("do not belong to the positions" in note for note in found.notes)


def test_a_master_that_turns_over_is_put_in_order() -> None:
    found = read_cam_csv("x [mm],y [mm]\n4,9\n5,10\n6,11\n0,1\n1,2\n2,3\n3,5\n", "t")
    assert found.x * 1e3 == pytest.approx([0, 1, 2, 3, 4, 5, 6])
    assert found.y * 1e3 == pytest.approx([1, 2, 3, 5, 9, 10, 11])
    assert any("line 5: the master turns over" in note for note in found.notes)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("x [mm];y [mm]\n1,5;2\n2,5;zwei\n3;4\n5;6\n", "t, line 3: 'zwei' is not a finite number"),
        ("x [mm];y [mm]\n1;2\n2;3;4\n3;4\n5;6\n", "t, line 3: 3 cells where the header has 2"),
        ("Slave [mm];Torque [mm]\n1;2\n2;3\n3;4\n5;6\n", "t, line 1: column x is missing"),
        ("Master [mm];Slave [kg]\n1;2\n2;3\n3;4\n5;6\n", "t, line 1: column y cannot be in 'kg'; its unit is one of"),
        ("1,2,3\n2,3,4\nTheta,S,V 1\n3,4,5\n", "t, line 3: 'Theta' is not a finite number"),
        ("just words\nand more\n", "there is no table of two columns in it"),
    ],
)
def test_what_cannot_be_read_is_named(text: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        read_cam_csv(text, "t")
    assert message in str(caught.value)


def test_names_and_units() -> None:
    assert split_unit("Zeit / ms") == ("Zeit", "ms", True)
    assert split_unit("S (Pos)") == ("S (Pos)", None, True)
    assert split_unit("dy/dx [1]") == ("dy/dx", "1", True)
    assert split_unit("act [V]") == ("act", "V", False)
    assert split_unit("Weg in mm") == ("Weg", "mm", True)
    assert [cam_role(name) for name in ("SlaveVelo", "Leitposition", "Folge", "Drehmoment", "dy/dx", "Punkt")] == [
        "dy/dx", "x", "y", "other", "dy/dx", "index"]  # fmt: skip
    assert [trace_role(name) for name in ("Axis 1.ActPos", "Sollposition", "ActVelo", "Zeit", "指令位置", "foo")] == [
        "actual", "command", "other", "time", "command", None]  # fmt: skip


SCOPE = (
    "Name\tYT Scope\nFile\tC:\\a.svdx\nStarttime of export\t1\t2\n\n"
    "Name\tAxis 1.SetPos\tName\tAxis 1.ActPos\nData-Type\tREAL64\tData-Type\tREAL64\n"
    "SampleTime[ms]\t2\tSampleTime[ms]\t2\nUnit\t{unit}\tUnit\t{unit}\n\n"
)


def test_a_scope_gives_each_channel_its_times() -> None:
    body = "".join(f"{2 * k}\t{k},5\t{2 * k}\t{k},25\n" for k in range(9)) + "EOF\n"
    found = read_trace_csv(SCOPE.format(unit="deg") + body, "t")
    assert (found.step, found.unit, found.notes) == (pytest.approx(2e-3), "rad", ())
    assert found.command == pytest.approx(np.radians(np.arange(9) + 0.5))
    assert found.actual == pytest.approx(np.radians(np.arange(9) + 0.25))
    found = read_trace_csv(SCOPE.format(unit="(none)") + body, "t")
    assert found.command == pytest.approx(1e-3 * (np.arange(9) + 0.5))
    assert any("no unit in the file" in note for note in found.notes)
    other = "".join(f"{2 * k}\t{k},5\t{2 * k + 1}\t{k},25\n" for k in range(9))
    with pytest.raises(InputError, match="the channels have times of their own, which differ"):
        read_trace_csv(SCOPE.format(unit="deg") + other, "t")


POU = """<?xml version="1.0" encoding="utf-8"?>
<TcPlcObject Version="1.1.0.1">
  <POU Name="Cam"><Declaration><![CDATA[PROGRAM Cam
VAR p : ARRAY[1..2] OF MC_MotionFunctionPoint; END_VAR]]></Declaration>
    <Implementation><ST><![CDATA[
p[1].PointIndex := 1; p[1].FunctionType := 15; p[1].MasterPos := 0; p[1].SlavePos := 0; p[1].SlaveVelo := 1;
p[2].PointIndex := 2; p[2].FunctionType := 15; p[2].MasterPos := 4; p[2].SlavePos := {y}; p[2].SlaveVelo := 1;
]]></ST></Implementation></POU></TcPlcObject>
"""


def test_structured_text_inside_xml() -> None:
    text = POU.format(y=4)
    assert detect(text, "t").name == "twincat"
    table = read_table(TARGETS["twincat"], text, "t")
    assert table.y.tolist() == [0, 4]
    beside = text.replace("\n    <Implementation>", "<Implementation>").replace("<![CDATA[\np", "<![CDATA[p")
    assert "END_VAR]]></Declaration><Implementation><ST><![CDATA[p[1]" in beside
    assert read_table(TARGETS["twincat"], beside, "t").y.tolist() == [0, 4]
    escaped = POU.format(y="4 (* a &amp; b *)").replace("<![CDATA[", "").replace("]]>", "")
    assert read_table(TARGETS["twincat"], escaped, "t").y.tolist() == [0, 4]


@pytest.mark.parametrize("number", ["2.0*(-0.5)", "-0,0051", "a + b", "SQRT(2.0)"])
def test_a_number_that_is_none_is_refused_with_its_line(number: str) -> None:
    with pytest.raises(InputError, match="t, line 7: slavepos must be a number"):
        read_table(TARGETS["twincat"], POU.format(y=number), "t")


def test_a_whole_trio_program() -> None:
    text = (
        "' Rotary knife\nBASE(1)\nSPEED=100 : TABLE(100, 9, 9)\nTABLE(200, 0, 10.5, 40) ' the cam\nTABLE(203, 60)\n"
        "CAMBOX(200, 203, 2, 600, 0, 4)\nWAIT IDLE\n"
    )
    assert detect(text, "t").name == "trio"
    table = TARGETS["trio"].read(text, "t")
    assert table.x.tolist() == [0, 200, 400, 600]
    assert table.y.tolist() == [0, 21, 80, 120]
    assert TARGETS["trio"].rebuild(table)(200.0) == 21.0  # nothing is rounded
    with pytest.raises(InputError, match="line 6: CAMBOX runs over the address 203, which no TABLE line fills"):
        TARGETS["trio"].read(text.replace("TABLE(203, 60)", "PRINT 1"), "t")
    with pytest.raises(InputError, match="more than one CAMBOX"):
        TARGETS["trio"].read(text + "CAMBOX(200, 203, 1, 600, 0, 4)\n", "t")


@pytest.mark.parametrize(
    "text",
    [
        "x,y\n0,0\n1.5D0,2.25d+0\n3.0D+00,25D-1\n4.5,3.75\n",
        "x [mm];y [mm]\n0;0\n１，５;2,25\n3;2,5\u00a0\n４５e-1;3,75\n",
        "x [mm];y [mm]\n0 mm;0\n1,5 mm;2,25\n3\u00a0mm;2,5\n4,5mm;3,75 mm\n".replace("2,25", "2,25 mm").replace(";2,5\n", ";2,5 mm\n"),
        "x,y\n0 mm,0 mm\n1.5 mm,2.25 mm\n3 mm,2.5 mm\n4.5 mm,3.75 mm\n",
        "x [mm], y [mm]\n0, 0 # start\n1.5, 2.25 ! zone\n3, 2.5 ; there it ends\n4.5, 3.75 // end\n",
        "x [mm], y [mm]\n0, 0\n1.5," + " " * 9000 + "2.25 #" + " #" * 4000 + "\n3, 2.5 ; __\n4.5, 3.75 ;_\n",
        "% x [mm], y [mm]\n0 0\n1.5 2.25\n3 2.5\n4.5 3.75\n",
        "Number of points 0004\nMaster Units (PRIMARY)\nSlave Units (PRIMARY)\n0001 0 0\n0002 1.5 2.25\n0003 3 2.5\n0004 4.5 3.75\n",
        "主軸位置（mm）,従軸位置（mm）\n" + rows(","),
        "番号,主軸位相(度),従軸変位(mm)\n" + rows(",", before="{n},"),
        "Posizione master [mm];Posizione slave [mm]\n" + rows(";", comma=True),
        "Angolo [gradi];Corsa [mm]\n" + rows(";", comma=True),
        "Maître (mm);Esclave (mm)\n" + rows(";", comma=True),
        "Posición maestro [mm];Posición esclavo [mm]\n" + rows(";", comma=True),
    ],
)  # fmt: skip
def test_cells_and_headings_of_other_pens(text: str) -> None:
    found = read_cam_csv(text, "t")
    scale = 1e3 if found.words is None else 1.0
    assert found.x * scale == pytest.approx(X)
    assert found.y * scale == pytest.approx(Y)


def grouped(row: str) -> str:
    """Rows, more than are looked at for the sign between cells, with all thousands set apart as in English ``{0}`` and German ``{1}``."""
    cells = [f"{1000.5 * k:,.3f}" for k in range(1, 700)]
    swapped = [cell.translate(str.maketrans(".,", ",.")) for cell in cells]
    return "".join(row.format(*pair).replace("<TAB>", "\t") + "\n" for pair in zip(cells, swapped, strict=True))


QUOTED = '"{0}","{0}"'


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("x,y\n0 mm,0 mm\n1 mm,1 cm\n2 mm,2 mm\n3 mm,3 mm\n", "t, line 3: '1 cm' where the column is in mm; write the whole column"),
        ("x [mm],y [mm]\n0,0 cm\n1,1 cm\n2,2 cm\n3,3 cm\n", "t, line 2: '0 cm' where the column is in mm"),
        ("x,y\n0 mm,0 mm\n1 mm,1\n2 mm,2 mm\n3 mm,3 mm\n", "t, line 3: '1' where the column is in mm"),
        ("".join(f"{k},{7 * k % 90 + 10}\n" for k in range(20)), "t, line 1: '0,10' may be two numbers, or one with a decimal comma"),
        ("t [ms],y [mm]\n0,0\n1,1\n2,2\n3,3\n", "t, line 1: column x is missing, a time stands there; write the master's position"),
        ("x [mm];y [mm]\n0;0\n1'000.5;2\n2000;3\n3000;4\n", "t, line 3: \"1'000.5\" has its thousands set apart"),
        (f"x [um];y [um]\n0.0;0.0\n{grouped('{0};{0}')}", "t, line 3: '1,000.500' has its thousands set apart"),
        (f'x [um],y [um]\n"0.0","0.0"\n{grouped(QUOTED)}', "t, line 3: '1,000.500' has its thousands set apart"),
        (f"x [um]\ty [um]\n0,0\t0,0\n{grouped('{1}<TAB>{1}')}", "t, line 3: '1.000,500' has its thousands set apart"),
    ],
)  # fmt: skip
def test_what_would_be_a_guess_is_refused_by_its_line(text: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        read_table(detect(text, "t"), text, "t")
    assert str(caught.value).startswith(message)


@pytest.mark.parametrize(
    ("heading", "role"),
    [
        ("Lagesollwert", "command"), ("Positionsistwert", "actual"), ("Schleppabstand", "lag"), ("following error [mm]", "lag"),
        ("posDes", "command"), ("torDes", "other"), ("target_qd_0", "other"), ("target_q_0", "command"), ("real_time", "time"),
        ("present_position", "actual"), ("goal_position", "command"), ("current_position", "actual"), ("current", "other"),
        ("指令位置", "command"), ("現在位置", "actual"), ("Posizione comandata", "command"), ("Posizione misurata", "actual"),
        ("tempo", "time"),
        ("pos_estimate", "actual"), ("temperature", "other"),
    ],
)  # fmt: skip
def test_columns_of_recordings_are_known_by_their_names(heading: str, role: str) -> None:
    assert trace_role(split_unit(heading)[0]) == role


@pytest.mark.parametrize("head", [b"PK\x03\x04\x14\x00", b"\xd0\xcf\x11\xe0\xa1\xb1"])
def test_a_workbook_is_called_one(head: bytes) -> None:
    with pytest.raises(
        InputError, match="t: this is a workbook of a spreadsheet, or another packed file; save the sheet as CSV"
    ):
        decode(head + bytes(40), "t")


@pytest.mark.parametrize("code", ["cp932", "utf-8", "utf-16"])
def test_japanese_headings_in_their_codes(code: str) -> None:
    text = "時間[ms],指令位置[mm],現在位置[mm]\n0,0,0\n1,2,1\n2,4,3\n"
    assert read_trace_csv(decode(text.encode(code), "t"), "t").actual.tolist() == [0.0, 1e-3, 3e-3]


@pytest.mark.parametrize("code", ["big5", "gbk"])
def test_chinese_headings_in_their_codes(code: str) -> None:
    text = "從軸(mm),主軸(mm)\n" if code == "big5" else "从轴(mm),主轴(mm)\n"
    found = read_cam_csv(decode((text + "0,0\n1,2\n3,4\n5,6\n").encode(code), "t"), "t")
    assert found.x.tolist() == pytest.approx([0.0, 2e-3, 4e-3, 6e-3])


def test_umlauts_are_no_kanji() -> None:
    text = "Länge über Führung [mm];Folgeachse Größe [mm]\n"
    assert decode(text.encode("cp1252"), "t") == text
