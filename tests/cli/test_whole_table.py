"""Tables on narrow terminals: every word and number can be read."""

from __future__ import annotations

import re
from io import StringIO

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.cells import cell_len
from rich.console import Console

from camwright.cli.main import main
from camwright.cli.views.parts import fitting, new_table, new_text
from camwright.cli.views.whole_table import WholeTable

WORDS = st.text("abcdefgh0123456789.−", min_size=1, max_size=14)
CELLS = st.lists(WORDS, max_size=3).map(" ".join)


def rendered(view: object, width: int) -> str:
    """Render a view for a terminal of some columns."""
    told = StringIO()
    Console(file=told, width=width, highlight=False, markup=False).print(view)
    return told.getvalue()


def table_of(headings: list[str], rows: list[list[str]]) -> WholeTable:
    """Make a table of plain cells."""
    table = new_table(title="Title")
    for heading in headings:
        table.add_column(heading, justify="right")
    for row in rows:
        table.add_row(*row)
    return table


@given(st.integers(40, 120), st.lists(WORDS, min_size=1, max_size=9), st.data())
def test_no_word_is_cut_and_no_line_too_long(width: int, headings: list[str], data: st.DataObject) -> None:
    rows = data.draw(st.lists(st.lists(CELLS, min_size=len(headings), max_size=len(headings)), max_size=4))
    text = rendered(table_of(headings, rows), width)
    assert "…" not in text
    assert max(cell_len(line) for line in text.splitlines()) <= width
    there = re.findall(r"[^\s│┃┏┓┗┛┡┩╇┳━─┴└┘]+", text)
    wanted = [word for row in [headings, *rows] for cell in row for word in cell.split()]
    assert set(wanted) <= set(there)


def test_a_table_that_fits_stands_in_one_part() -> None:
    text = rendered(table_of(["profile", "speed"], [["cubic", "1.3333"]]), 40)
    assert text.count("Title") == 1
    assert "│   cubic │ 1.3333 │" in text


def test_a_table_that_is_too_wide_is_divided_and_its_first_column_repeated() -> None:
    headings = ["profile", *(f"measure{number}" for number in range(6))]
    text = rendered(table_of(headings, [["cubic", *["123456789"] * 6]]), 40)
    assert text.count("Title") == text.count("cubic") == 3
    assert text.count("123456789") == 6


def test_a_word_that_is_wider_than_the_terminal_is_folded() -> None:
    text = rendered(table_of(["file", "SHA-256"], [["cam.csv", "0123456789" * 6]]), 30)
    digits = "".join(line.rsplit("│", 2)[-2].strip() for line in text.splitlines() if line.startswith("│"))
    assert digits == "0123456789" * 6


def test_the_narrow_view_stands_where_the_wide_would_be_divided() -> None:
    wide = table_of(["check", "value"], [["a", "1" * 30]])
    assert "narrow" in rendered(fitting(wide, new_text("narrow"), 20), 30)
    assert "narrow" not in rendered(fitting(wide, new_text("narrow"), 20), 60)


def test_columns_of_the_environment_are_obeyed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.argv", ["camwright", "targets"])
    monkeypatch.setenv("COLUMNS", "60")
    assert main() == 0
    assert max(cell_len(line) for line in capsys.readouterr().out.splitlines()) <= 60


def test_cells_without_a_column_of_their_own_are_shown() -> None:
    table = WholeTable(None, {"show_header": False})
    table.add_row("case", "1")
    console = Console(width=40, file=StringIO())
    console.print(table)
    shown = console.file.getvalue()  # type: ignore[attr-defined]
    assert "case" in shown
    assert "1" in shown
