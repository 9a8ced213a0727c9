"""What views are made of; rich is loaded when the first is made, which no answer as JSON needs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import Group, RenderableType
    from rich.table import Table
    from rich.text import Text


def new_table(title: str | Text | None = None, **look: Any) -> Table:
    """Make an empty table."""
    from rich.table import Table

    return Table(title=title, **look)


def new_text(text: str = "", style: str = "") -> Text:
    """Make a text that stands as it is: brackets in it are no markup."""
    from rich.text import Text

    return Text(text, style)


def stacked(*views: RenderableType) -> Group:
    """Put views one below the other."""
    from rich.console import Group

    return Group(*views)
