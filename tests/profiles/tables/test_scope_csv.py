"""TwinCAT Scope's export in the settings that it has: documented (TE13xx, export to csv), and as public readers of it describe it."""

from __future__ import annotations

import numpy as np
import pytest

from camwright.profiles.errors import InputError
from camwright.profiles.tables.trace_csv import read_trace_csv

KEYS = {"SymbolComment": "", "Data-Type": "REAL64", "SampleTime[ms]": "1", "Port": "851", "Offset": "0", "Unit": "mm"}
TIMES = np.arange(40.0)
SET, ACT = 100 * np.sin(TIMES / 9) + 50, 100 * np.sin((TIMES - 1) / 9) + 50
START = 133_238_090_039_920_000


def export(
    groups: list[list[str]], rows: list[list[str]], sign: str = "\t", keys: dict[str, str] = KEYS, comma: bool = True
) -> str:
    """Write an export: the project, the keys of each group of channels, the rows."""
    lines = [["Name", "YT Scope Project"], ["File", "C:\\x.svdx"], ["Starttime of export", str(START), "Monday"], []]
    lines.append([cell for group in groups for cell in ("Name", *group)])
    lines += [[cell for group in groups for cell in (key, *[value] * len(group))] for key, value in keys.items()]
    body = [sign.join(row).replace(".", ",") if comma else sign.join(row) for row in rows]
    return "\n".join([*(sign.join(line) for line in lines), "", *body]) + "\nEOF\n"


def cells(*columns: np.ndarray) -> list[list[str]]:
    return [[f"{value:.6g}" for value in row] for row in zip(*columns, strict=True)]


BOTH = ["Axis 1.SetPos", "Axis 1.ActPos"]
PLAIN = cells(TIMES, SET, ACT)
SLOW = [[*row, f"{k // 4 * 4}", f"{k // 4}"] for k, row in enumerate(PLAIN)]
SHORT = [[*row, f"{4 * k}", f"{k}"] if k < 10 else row for k, row in enumerate(PLAIN)]
TICKS = [[str(START + 10_000 * k), *row[1:]] for k, row in enumerate(PLAIN)]


@pytest.mark.parametrize(
    "text",
    [
        export([BOTH], PLAIN),
        export([BOTH], PLAIN, ";"),
        export([BOTH], PLAIN, ",", comma=False),
        export([BOTH[:1], BOTH[1:]], cells(TIMES, SET, TIMES, ACT)),
        export([BOTH, ["Torque"]], SLOW),
        export([["Torque"], BOTH], [[*row[3:], *row[:3]] for row in SLOW]),
        export([BOTH, ["Torque"]], SHORT),
        export([BOTH], TICKS),
        export([[*BOTH, f"{BOTH[0]} (1)", f"{BOTH[1]} (1)"]], [[*row, *row[1:]] for row in PLAIN]),
        export([[*BOTH, "Torque"]], [[*row, "" if k == 7 else "1"] for k, row in enumerate(PLAIN)]),
        export([BOTH], PLAIN).replace("EOF\n", ""),
        export([BOTH], PLAIN, ":"),
        export([[*BOTH, "func_timeshift", "Time_s"]], [[*row, "3", "4"] for row in PLAIN]),
    ],
)
def test_the_recording_is_the_same_whatever_the_settings(text: str) -> None:
    found = read_trace_csv(text, "t")
    assert found.step == pytest.approx(1e-3, rel=1e-9)
    np.testing.assert_allclose(found.command, 1e-3 * SET, atol=1e-6)
    np.testing.assert_allclose(found.actual, 1e-3 * ACT, atol=1e-6)
    assert found.notes == ()


def test_names_alone_are_enough() -> None:
    found = read_trace_csv(export([BOTH], PLAIN, ",", {}, comma=False), "t")
    np.testing.assert_allclose(found.command, 1e-3 * SET, atol=1e-6)
    assert "mm is taken" in found.notes[0]


def test_a_slow_channel_alone_has_its_own_rate() -> None:
    rows = [[f"{k // 4 * 4}", row[1], row[2]] for k, row in enumerate(np.repeat(PLAIN, 4, axis=0).tolist())]
    found = read_trace_csv(export([BOTH], rows), "t")
    assert (len(found.command), found.step) == (40, pytest.approx(4e-3, rel=1e-9))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (export([BOTH[:1], BOTH[1:]], cells(TIMES, SET, TIMES // 4 * 4, ACT)), "the channels have times of their own, which differ"),
        (export([BOTH], PLAIN).replace("Name\tAxis", "Axis"), "no row of names has times beside the channels: export"),
        (export([BOTH], [row[1:] for row in PLAIN]), "2 cells where the names are 3: export the recording with its times"),
        (export([BOTH], PLAIN, ","), "t, line 13: 4 cells where the channels and their times are 3; a comma cannot both separate"),
        ("Name\tScope\nFile\tx\n", "begins as an export of TwinCAT Scope, but there are no channels or no rows in it"),
        (export([["A.SetPos", "B.SetPos", "A.ActPos"]], cells(TIMES, SET, SET + 1, ACT)), "column command stands there twice"),
        (export([BOTH], [*PLAIN[:5], ["5", "x", "1"], *PLAIN[6:]]), "t, line 18: command 'x' is not a finite number"),
        (export([["Axis.Pos"]], cells(TIMES, SET)), "there is no column command; the columns are 'Name', 'Axis.Pos'"),
    ],
)  # fmt: skip
def test_what_is_no_recording_of_an_axis_is_refused(text: str, message: str) -> None:
    with pytest.raises(InputError, match=message.replace("(", r"\(").replace("[", r"\[")):
        read_trace_csv(text, "t")


def test_a_trace_of_codesys_counts_cycles() -> None:
    text = "Trace\nD:\\KNIFE.PRO\nCycle PLC_PRG.fSetPos PLC_PRG.fActPos\n" + "\n".join(map(" ".join, PLAIN))
    with pytest.raises(
        InputError,
        match="t, line 3: column 'Cycle' counts cycles of the PLC, and how long one lasts is not in the file",
    ):
        read_trace_csv(text, "t")
    found = read_trace_csv(text.replace("Cycle", "time/ms"), "t")
    np.testing.assert_allclose(found.command, 1e-3 * SET, atol=1e-6)
