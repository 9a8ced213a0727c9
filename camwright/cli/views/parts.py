"""What views are made of; rich is loaded when the first is made, which no answer as JSON needs."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from camwright.cli.views.whole_table import WholeTable

if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions, Group, RenderableType
    from rich.text import Text

View: TypeAlias = "RenderableType"
"""What a command shows."""


def new_table(
    title: str | Text | None = None,
    headings: Sequence[str] = (),
    left: Collection[str] = (),
    whole: Collection[str] = (),
    **look: Any,
) -> WholeTable:
    """Make an empty table, whose words are never cut; its columns hold numbers, at the right, but for those named in `left`.

    Parameters
    ----------
    whole
        Headings of columns whose lines are not divided between words.
    """
    table = WholeTable(title, {"title_justify": "left", **look})
    for heading in headings:
        table.add_column(heading, justify="left" if heading in left else "right", no_wrap=heading in whole)
    return table


def new_text(text: str = "", style: str = "") -> Text:
    """Make a text that stands as it is: brackets in it are no markup."""
    from rich.text import Text

    return Text(text, style)


def files_view(files: Sequence[Path]) -> Text:
    """Show the files that were written, one a line."""
    return new_text("\n".join(f"wrote {file}" for file in files))


def stacked(*views: View) -> Group:
    """Put views one below the other."""
    from rich.console import Group

    return Group(*views)


@dataclass(frozen=True)
class _Fitting:
    """A view that is chosen when it is known how wide the terminal is."""

    wide: WholeTable
    narrow: View
    least: int

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[View]:
        yield self.wide if options.max_width >= max(self.least, self.wide.least) else self.narrow


def fitting(wide: WholeTable, narrow: View, least: int) -> View:
    """Take the wide table on a terminal of so many columns at least, if it stands there undivided; else the narrow view."""
    return _Fitting(wide, narrow, least)
