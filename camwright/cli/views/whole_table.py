"""`WholeTable`: a table whose words and numbers are never cut: where it is too wide it is divided, its first column repeated."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions
    from rich.measure import Measurement
    from rich.table import Table
    from rich.text import Text

    Cell = str | Text

_BESIDE, _FRAME = 3, 1
"""Columns of the terminal that each column of a table needs beside its text, and the table beside its columns."""


@dataclass(frozen=True)
class _Column:
    """A column and its cells, and how wide it is with every line or only every word whole."""

    heading: Cell
    look: dict[str, Any]
    cells: tuple[Cell, ...]
    least: int
    most: int


@dataclass(frozen=True, eq=False)
class WholeTable:
    """A table that is laid out when it is known how wide the terminal is.

    Parameters
    ----------
    title
        Its title, over each part.
    look
        As of ``rich.table.Table``.
    """

    title: Cell | None
    look: dict[str, Any]
    _headings: list[tuple[Cell, dict[str, Any]]] = field(default_factory=list)
    _rows: list[tuple[tuple[Cell, ...], str]] = field(default_factory=list)

    def add_column(self, heading: Cell = "", **look: Any) -> None:
        """Add a column; ``no_wrap`` keeps its lines whole, else its words are."""
        self._headings.append((heading, look))

    def add_row(self, *cells: Cell, style: str = "") -> None:
        """Add a row; cells that are missing are empty."""
        self._rows.append((cells, style))

    @property
    def least(self) -> int:
        """Columns of the terminal on which it stands undivided."""
        return _needed([column.least for column in self._columns()])

    def __rich_measure__(self, console: Console, options: ConsoleOptions) -> Measurement:
        """Say how wide it is: for ``rich``."""
        from rich.measure import Measurement

        most = _needed([column.most for column in self._columns()])
        return Measurement(min(self.least, options.max_width), min(most, options.max_width))

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[Table]:
        """Lay it out, in as many parts as it needs: for ``rich``."""
        for part in _parts(self._columns(), options.max_width):
            yield self._laid(part, options.max_width)

    def _columns(self) -> list[_Column]:
        """Put the cells of rows into columns and measure them."""
        found = []
        more = max((len(cells) for cells, _ in self._rows), default=0) - len(self._headings)
        bare: list[tuple[Cell, dict[str, Any]]] = [("", {})] * more  # cells beyond the columns that were added
        for number, (heading, look) in enumerate([*self._headings, *bare]):
            cells = tuple(cells[number] if number < len(cells) else "" for cells, _ in self._rows)
            shown = (heading, *cells) if self.look.get("show_header", True) else cells
            most = _longest(shown, words=False)
            found.append(
                _Column(heading, look, cells, most if look.get("no_wrap") else _longest(shown, words=True), most)
            )
        return found

    def _laid(self, columns: Sequence[_Column], room: int) -> Table:
        """Lay out some columns; widths are set only where there is too little room for all lines."""
        from rich.table import Table

        table = Table(title=self.title, **self.look)
        widths: Sequence[int | None] = [None] * len(columns)
        if _needed([column.most for column in columns]) > room:
            widths = _widths(columns, room - _needed([0] * len(columns)))
        for column, width in zip(columns, widths, strict=True):
            table.add_column(column.heading, **{**column.look, "no_wrap": False, "overflow": "fold", "width": width})
        for number, (_, style) in enumerate(self._rows):
            table.add_row(*(column.cells[number] for column in columns), style=style)
        return table


def _needed(widths: Sequence[int]) -> int:
    """Columns of the terminal for columns of a table."""
    return sum(widths) + _BESIDE * len(widths) + _FRAME


def _longest(cells: Sequence[Cell], *, words: bool) -> int:
    """Length of the longest word or line of cells."""
    from rich.cells import cell_len

    texts = [cell if isinstance(cell, str) else cell.plain for cell in cells]
    return max((cell_len(part) for text in texts for part in (text.split() if words else text.split("\n"))), default=0)


def _parts(columns: Sequence[_Column], room: int) -> list[list[_Column]]:
    """Divide columns into tables that have room, the first column in each."""
    if not columns:
        return []
    first, *rest = columns
    parts = [[first]]
    for column in rest:
        beside = [*parts[-1], column]
        if len(parts[-1]) > 1 and _needed([each.least for each in beside]) > room:
            parts.append([first, column])
        else:
            parts[-1] = beside
    return parts


def _widths(columns: Sequence[_Column], room: int) -> list[int]:
    """Share out room: words whole if that can be, then the same to all that want more; the widest give first where there is too little."""
    widths = [column.least for column in columns]
    while sum(widths) > max(room, len(widths)):
        widths[widths.index(max(widths))] -= 1
    while sum(widths) < room:
        wanting = [n for n, column in enumerate(columns) if widths[n] < column.most]
        if not wanting:
            break
        widths[min(wanting, key=lambda n: widths[n])] += 1
    return widths
