"""Cut lists and line speeds as people write them, and every bad row by its line."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camwright.production.list_file import line_run_text, parse_cut_list, parse_line_run, read_cut_list, read_line_run
from camwright.profiles.cut_list import ListRow
from camwright.profiles.errors import InputError
from camwright.profiles.line_run import LineRun


@pytest.mark.parametrize(
    "text",
    [
        "length [mm],quantity,kind\n600,3,cut\n24.5,1,crop\n",
        "600 mm;3\n24.5 mm;1;crop\n",
        "Länge [mm];Anzahl;Art\n600;3\n24,5;1;crop\n",
        "length;qty;type\n600 mm;3;CUT\n24,5 mm;1;Crop\n",
        "# order 4711\nlength (mm)\tquantity\tkind\n600\t3\t\n2.45e1\t1.0\tcrop\n",
        "Order;4711\nlength;quantity;kind\n[mm];;\n600;3;\n24,5;1;crop\n",
        'quantity,kind,"length [mm]"\n3,,600\n1,crop,24.5\n',
        "\ufeff长度 [cm],数量,种类\r\n60,3,\r\n2.45,1,crop\r\n",
        "sep=;\nlength [m];quantity;kind\n0.6;3;cut\n0.0245;1;crop\n",
    ],
)
def test_lists_as_people_write_them(text: str) -> None:
    found = parse_cut_list(text, "L.csv").rows
    assert [(round(row.length, 12), row.quantity, row.kind) for row in found] == [(0.6, 3, "cut"), (0.0245, 1, "crop")]


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("Länge [mm];Stückzahl\n600,5;3\n300;2\n", "utf-8"),
        ("Länge [mm];Stückzahl\n600,5;3\n300;2\n", "utf-16"),
        ("Schnittlänge (mm)\tStückzahl\n600,5\t3\n300\t2\n", "cp1252"),
        ("产品长度（mm）,数量\n600.5,3\n300,2\n", "gb18030"),
        ("Part number,length [mm],quantity,remark\nA-1,600.5,3,two holes\nB-2,300,2,\n", "utf-8"),
        ("Pos;Länge;Stück\n;mm;Stk\n1;600,5;3\n2;300;2\n", "utf-16-le"),
    ],
)
def test_lists_as_spreadsheets_save_them(text: str, code: str, tmp_path: Path) -> None:
    file = tmp_path / "order.csv"
    file.write_bytes(text.encode(code))
    assert [(row.length, row.quantity) for row in read_cut_list(file).rows] == [(0.6005, 3), (0.3, 2)]


def test_line_speeds_as_spreadsheets_save_them(tmp_path: Path) -> None:
    file = tmp_path / "line.csv"
    file.write_bytes("Zeit [s];Liniengeschwindigkeit [m/min]\n0;30\n1,5;60\n".encode("utf-16"))
    assert read_line_run(file).speeds.tolist() == [0.5, 1.0]


def test_inches_are_exact() -> None:
    assert parse_cut_list("24 in,2\n", "L").rows == (ListRow(0.6096, 2, "cut", 1),)


@pytest.mark.parametrize(
    ("text", "faults"),
    [
        ("", ("L: there is no cut list in it; write a header like length [mm],quantity,kind and rows below",)),
        (
            "length [mm],quantity\n",
            ("L: there is no row in it; write rows below a header like length [mm],quantity,kind",),
        ),
        ("600 mm\n", ("L: 1 column where 2 are needed; write a header like length [mm],quantity,kind and rows below",)),
        ("600,3\n", ("L, line 1: length '600' has no unit; write 600 mm, or name the column length [mm]",)),
        (
            "length [mm],kind\n600,cut\n",
            ("L, line 1: there is no column quantity; write a header like length [mm],quantity,kind",),
        ),
        (
            "length [mm],quantity\nsixty,3\n600,0\n600,2.5\n600,\n-600,1\n",
            (
                "L, line 2: length 'sixty' is no length; write e.g. 600 in the column's mm",
                "L, line 3: quantity '0' is no whole number from 1 to 200000; write how many, e.g. 3",
                "L, line 4: quantity '2.5' is no whole number from 1 to 200000; write how many, e.g. 3",
                "L, line 5: quantity '' is no whole number from 1 to 200000; write how many, e.g. 3",
                "L, line 6: '-600 mm': negative; a length greater than zero is expected; write e.g. \"600 mm\"",
            ),
        ),
        (
            "length [mm];quantity\n1.200,5;3\n",
            (
                "L, line 2: length '1.200,5' has its thousands set apart; export the numbers without such signs, like 1234.5",
            ),
        ),
        ("600 kg,3\n", ("L, line 1: '600 kg': a mass, but a length is expected; write e.g. \"600 mm\"",)),
        ("600 mm,3,punch\n", ("L, line 1: kind 'punch' is none of cut, crop, skip; leave it out for a cut",)),
        (
            "600 mm,3\n200 mm,1,skip\n",
            ("L, line 2: the list ends with a skip, behind which nothing is cut; end it with a cut or a crop",),
        ),
        ("600 mm,200000\n600 mm,1\n", ("L: 200001 pieces, the limit is 200000; split the list",)),
    ],
)
def test_every_bad_row_is_refused_by_its_line(text: str, faults: tuple[str, ...]) -> None:
    with pytest.raises(InputError) as caught:
        parse_cut_list(text, "L")
    assert caught.value.faults == faults


cells = st.sampled_from(
    ["600", "600 mm", "24,5", "3", "cut", "skip", "-1", "", "x", "1e3", "length [mm]", "quantity", '"', "9" * 30, "∞"]
)
texts = st.lists(st.lists(cells, min_size=1, max_size=4), max_size=6).flatmap(
    lambda rows: st.sampled_from(",;\t| ").map(lambda sign: "\n".join(sign.join(row) for row in rows))
)


def faults(parse: Callable[[str, str], object], text: str) -> tuple[str, ...]:
    """Faults that are told, nothing where it is read."""
    try:
        parse(text, "L")
    except InputError as error:
        return error.faults
    return ()


@given(texts | st.text(max_size=60))
def test_any_text_is_a_list_or_refused_in_words(text: str) -> None:
    for parse in (parse_cut_list, parse_line_run):
        assert all(fault.startswith("L") for fault in faults(parse, text))


def test_of_many_bad_rows_twenty_are_told() -> None:
    with pytest.raises(InputError) as caught:
        parse_cut_list("length [mm],quantity\n" + "x,1\n" * 30, "L")
    assert len(caught.value.faults) == 21
    assert caught.value.faults[-1] == "L: 10 more rows with faults"


def test_line_speeds_as_people_write_them() -> None:
    for text in ("time [s],speed [m/min]\n2,0\n7,60\n", "t (ms);line speed (m/s)\n2000;0\n7000;1,0\n"):
        run = parse_line_run(text, "P")
        assert run.times.tolist() == [0.0, 5.0]
        assert run.speeds == pytest.approx([0.0, 1.0])


def test_a_plan_that_is_written_is_read_back() -> None:
    run = LineRun(np.array([0.0, 1.0 / 3.0, 2.0]), np.array([4 / 3, 0.1, 0.7]))
    again = parse_line_run(line_run_text(run, ["a plan"]), "P")
    assert again.times.tolist() == run.times.tolist()
    assert again.speeds == pytest.approx(run.speeds, rel=1e-15)
    smooth = LineRun(np.array([0.0, 1.0, 2.0]), np.array([1.0, 1.5, 2.0]), np.array([0.0, 1.0, 0.0]))
    again = parse_line_run(line_run_text(smooth), "P")
    assert again.accelerations == pytest.approx(smooth.accelerations)
    assert again.passed(0.5) == pytest.approx(0.5 + 0.5**3 / 6)


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("0,1\n2,3\n", "P: column time has no unit; write a header like time [s],speed [m/min]"),
        ("time [s],speed [kg]\n0,1\n2,3\n", "P, line 1: column speed: '1 kg': a mass, but a speed is expected"),
        (
            "time [s],speed [m/s]\n0,1\n0,2\n",
            "P, line 3: the time does not increase from the row before; sort the rows by time",
        ),
        ("time [s],speed [m/s]\n0,1\n1,-2\n", "P, line 3: a speed of -2 m/s; a line runs forwards: write 0 or more"),
        ("time [s],speed [m/s]\n0,1\n", "P: one row; the speed of the line needs two at least, the first at its start"),
        (
            "time [s],speed [m/s]\n0,1\n1,1e7\n",
            "P, line 3: 1e+07 m/s after 1 s; at most 1e+06 m/s and 1e+06 s are read",
        ),
        (
            "time [s],speed [m/s],acceleration [m/s^2]\n0,1,0\n1,1.5,1\n2,2.5,0\n",
            "P, line 4: accelerations do not add up to the speeds; leave the column out",
        ),
        ("time [s],position [m]\n0,1\n1,2\n", "P, line 1: there is no column speed; write a header like"),
    ],
)
def test_bad_line_speeds_are_refused(text: str, fault: str) -> None:
    with pytest.raises(InputError) as caught:
        parse_line_run(text, "P")
    assert caught.value.faults[0].startswith(fault)


@pytest.mark.parametrize("quantity", ["9" * 400, "1e999"])
def test_a_quantity_beyond_all_numbers_is_refused(quantity: str) -> None:
    with pytest.raises(InputError, match=r"L, line 2: quantity '[9e1]+' is no whole number from 1 to 200000"):
        parse_cut_list(f"length [mm],quantity\n600,{quantity}\n", "L")
