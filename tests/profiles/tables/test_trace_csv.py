"""Recorded traces as CSV: units, columns, and every fault with its line."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camwright.profiles.errors import InputError
from camwright.profiles.tables.trace_csv import MOST_ROWS, read_trace_csv

HEADER = "time [ms],command [mm],actual [mm]"


def rows(count: int = 5, step: float = 1.0) -> list[str]:
    return [f"{n * step:.6g},{2.0 * n:.6g},{2.0 * n - 0.5:.6g}" for n in range(count)]


def text(*lines: str, header: str = HEADER) -> str:
    return "\n".join([header, *lines]) + "\n"


def test_a_trace_is_read_in_si_units() -> None:
    found = read_trace_csv("# drive 3\n\n" + text(*rows()), "t.csv")
    assert (found.start, found.unit) == (0.0, "m")
    assert found.step == pytest.approx(1e-3, rel=1e-12)
    assert found.command == pytest.approx(2e-3 * np.arange(5), abs=1e-15)
    assert found.actual == pytest.approx(2e-3 * np.arange(5) - 0.5e-3, abs=1e-15)


def test_columns_stand_in_any_order_beside_others() -> None:
    header = "torque,Actual (deg), Command [rev] ,speed [rpm],time [s]"
    found = read_trace_csv(
        "\ufeff" + text("9,90,0.5,x,2.5", "9,180,1,,2.501", header=header).replace("\n", "\r\n"), "t.csv"
    )
    assert (found.unit, found.start) == ("rad", 2.5)
    assert found.step == pytest.approx(1e-3, rel=1e-9)
    assert found.actual == pytest.approx([math.pi / 2, math.pi])
    assert found.command == pytest.approx([math.pi, 2 * math.pi])


def test_rounded_times_are_equally_spaced() -> None:
    lines = [f"{n / 3:.3f},{n},{n}" for n in range(300)]
    assert read_trace_csv(text(*lines), "t.csv").step == pytest.approx(1e-3 / 3, rel=1e-5)


@pytest.mark.parametrize(
    ("written", "message"),
    [
        ("", "t.csv: there is no recording in it; write a header like time [ms],command [mm],actual [mm] and rows"),
        ("# only a comment\n", "t.csv: there is no recording in it"),
        (text(), "t.csv: 0 rows below the header"),
        (text(*rows(), header="time;command;actual"), "t.csv: there is no column time; write a header like"),
        (text(*rows(), header="time [ms],cmmand [mm],actual [mm]"),
         "t.csv, line 1: there is no column command; is it 'cmmand'? write a header like time [ms],command [mm],actual [mm]"),
        (text(*rows(), header="time [ms],command [mm],actual"),
         "t.csv, line 1: column actual has no unit; write it in brackets, e.g. actual [mm]"),
        (text(*rows(), header="time,command [mm],actual [mm]"),
         "t.csv, line 1: column time has no unit; write it in brackets, e.g. time [ms]"),
        (text("2026-01-01T10:00:00.000+02:00,1,2", "2026-01-01T10:00:00.004+02:00,1,2", header="time,command [mm],actual [mm]"),
         "t.csv, line 2: '2026-01-01T10:00:00.000+02:00' is a time of day; export the time since the start"),
        (text(*rows(), header="time [mm],command [mm],actual [mm]"),
         "t.csv, line 1: column time cannot be in 'mm'; its unit is one of s, ms, us"),
        (text(*rows(), header="time [ms],command [V],actual [mm]"), "column command cannot be in 'V'; its unit is one of m, "),
        (text(*rows(), header="time [ms],command [mm],actual [deg]"), "command and actual are a length and an angle"),
        (text(*(f"{row},0" for row in rows()), header=f"{HEADER},time [ms]"), "t.csv, line 1: column time stands there twice"),
        (text(*rows(2), "2,4", *rows(2)), "t.csv, line 4: 2 cells where the header has 3; separate cells by one sign"),
        (text(*rows(2), "2,nan,4"), "t.csv, line 4: command 'nan' is not a finite number of at most 1e+12"),
        (text(*rows(2), "2,4,inf"), "t.csv, line 4: actual 'inf' is not a finite number"),
        (text(*rows(2), "2,,4"), "t.csv, line 4: command '' is not a finite number"),
        (text(*rows(2), "2,4,1e15"), "t.csv, line 4: actual '1e15' is not a finite number of at most 1e+12"),
        (text(*rows(3), "1.5,4,4"), "t.csv, line 5: the time does not increase from the row before; sort the rows"),
        (text(*rows(3), "2,4,4"), "t.csv, line 5: the time does not increase"),
        (text(*rows(9), "12,4,4", "13,4,4"),
         "t.csv, line 11: a gap of 4 ms where rows are 1 ms apart; record again, or cut out a part without gaps"),
        (text(*rows(9), "12,4,4", "16,4,4"), "t.csv, line 11: a gap of 4 ms where rows are 1 ms apart, the first of 2"),
        (text(*rows(9), "9.2,4,4", "10,4,4"),
         "t.csv, line 11: 1.2 ms after the row before where rows are 1 ms apart; the sampling must be equal"),
        (text(*rows(MOST_ROWS + 1)), f"t.csv: {MOST_ROWS + 1} rows, the limit is {MOST_ROWS}; cut out a part"),
    ],
)  # fmt: skip
def test_a_fault_is_told_with_its_place(written: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        read_trace_csv(written, "t.csv")
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("header", "row", "cell"),
    [
        ("time [ms];command [mm];actual [mm]", "{k};1.234.{k:03d},5;1.234.{k:03d},5", "'1.234.000,5'"),
        ("time [ms]\tcommand [mm]\tactual [mm]", "{k}\t1,234.{k:03d}\t1,234.{k:03d}", "'1,234.000'"),
        ("time [ms],command [mm],actual [mm]", '{k},"1,234.{k:03d}","1,234.{k:03d}"', "'1,234.000'"),
        ("time [ms];command [mm];actual [mm]", "{k};1 234,{k:03d};1 234,{k:03d}", "'1 234,000'"),
        ("time [ms];command [mm];actual [mm]", "{k};1'234.{k:03d};1'234.{k:03d}", '"1\'234.000"'),
    ],
)
def test_thousands_set_apart_are_refused_by_line(header: str, row: str, cell: str) -> None:
    lines = [row.format(k=k) for k in range(300)]
    with pytest.raises(InputError) as caught:
        read_trace_csv("\n".join([header, *lines]), "t")
    assert (
        str(caught.value)
        == f"t, line 2: {cell} has its thousands set apart; export the numbers without such signs, like 1234.5"
    )


def test_the_master_is_read_where_it_is_asked_for() -> None:
    text = "t [ms];Master set [mm];Master act [mm];Slave set [mm];Slave act [mm]\n0;1;2;3;4\n1;5;6;7;8"
    found = read_trace_csv(text, "t", master=True)
    assert found.master is not None
    assert found.master.tolist() == [0.002, 0.006]
    assert found.command.tolist() == [0.003, 0.007]
    plain = read_trace_csv(text, "t")
    assert plain.master is None
    assert plain.actual.tolist() == [0.004, 0.008]


def test_positions_are_found_among_what_else_is_commanded_and_fed_back() -> None:
    """Channels as a recorder of a bus writes them, with where they come from before their names."""
    names = [
        "MotorCmdKd#0",
        "MotorCmdPos#0",
        "MotorCmdTor#0",
        "MotorCmdVel#0",
        "MotorFbPos#0",
        "MotorFbTemp#0",
        "t [ms]",
    ]
    head = ",".join(f"MotorTest/{name}" for name in names)
    found = read_trace_csv(text(*(f"0.1,{n},0,0,{n - 0.5},24,{n}" for n in range(5)), header=head), "t.csv")
    assert found.command == pytest.approx(1e-3 * np.arange(5))
    assert found.actual == pytest.approx(1e-3 * np.arange(5) - 0.5e-3)
    with pytest.raises(InputError, match="column time has no unit; write it in brackets"):
        read_trace_csv(text("0.1,1,0,0,1,24,0", "0.1,1,0,0,1,24,1", header=head.replace(" [ms]", "")), "t.csv")


LOG = """t,q_cmd_1,q_1,q_cmd_2,q_2
0,0,0,1,1
0.002,1,0.5,3,2
0.004,3,2,7,5
"""


def test_the_lag_stands_for_the_position_that_is_missing() -> None:
    want = read_trace_csv(text(*rows()), "t")
    behind = [f"{n},{2 * n},0.5" for n in range(5)]
    led = read_trace_csv(text(*behind, header="time [ms],SetPos [mm],LagError [mm]"), "t")
    measured = [f"{n},{2 * n - 0.5},0.5" for n in range(5)]
    followed = read_trace_csv(text(*measured, header="time [ms];ActPos [mm];Schleppfehler [mm]".replace(";", ",")), "t")
    for found in (led, followed):
        assert found.command == pytest.approx(want.command, abs=1e-15)
        assert found.actual == pytest.approx(want.actual, abs=1e-15)
        assert any("lag" in note for note in found.notes)
    with pytest.raises(InputError, match="column lag has no unit"):
        read_trace_csv(text(*behind, header="time [ms],SetPos [mm],LagError"), "t")
    with pytest.raises(InputError, match="there is no column time"):
        read_trace_csv(text(*behind, header="n,SetPos [mm],LagError [mm]"), "t")


@pytest.mark.parametrize(
    "columns", ["t [s],q_cmd_2 [rad],q_2 [rad]", "1 [s], 4 [rad], 5 [rad]", "T [s],Q_CMD_2 [rad],q_2 [rad]"]
)
def test_columns_are_chosen_by_heading_or_number(columns: str) -> None:
    found = read_trace_csv(LOG, "t", columns=columns)
    assert (found.unit, found.step) == ("rad", pytest.approx(0.002))
    assert found.command.tolist() == [1.0, 3.0, 7.0]
    assert found.actual.tolist() == [1.0, 2.0, 5.0]


def test_the_time_is_found_by_its_name_where_only_positions_are_chosen() -> None:
    found = read_trace_csv(LOG.replace("t,", "time [s],", 1), "t", columns="q_cmd_1 [deg],q_1 [deg]")
    assert found.actual[-1] == pytest.approx(math.radians(2.0))
    with pytest.raises(InputError, match="there is no column time; say which is meant with --columns"):
        read_trace_csv(LOG.replace("t,", "n,", 1), "t", columns="q_cmd_1 [deg],q_1 [deg]")


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ("t", "--columns takes headings or numbers of command and actual, or of time, command and actual"),
        ("t [s],q_9,q_1", "t: --columns 'q_9': 0 columns are called so; the columns are 't', 'q_cmd_1', 'q_1'"),
        ("t,q_cmd_1,q_1", "t, line 1: column time has no unit; write it in brackets, e.g. time [ms]"),
        ("t [m],q_cmd_1,q_1", "t, line 1: column time cannot be in 'm'"),
    ],
)
def test_columns_that_are_not_there_are_told(columns: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        read_trace_csv(LOG, "t", columns=columns)
    assert str(caught.value).startswith(message)


def test_a_unit_of_the_file_is_not_overruled() -> None:
    with pytest.raises(InputError, match="the file says that it is in 'mm'"):
        read_trace_csv(text(*rows()), "t", columns="time,command [deg],actual")


def test_several_axes_ask_which_is_meant() -> None:
    several = "time [ms],target_q_0 [rad],actual_q_0 [rad],target_q_1 [rad]\n0,0,0,0\n1,1,1,1\n"
    with pytest.raises(
        InputError,
        match=r"'target_q_1 .rad.'\); leave one out, or say which is meant with --columns TIME,COMMAND,ACTUAL",
    ):
        read_trace_csv(several, "t")
