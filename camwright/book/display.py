"""The progress of a book on standard error: what is done, how fast, how long it will take."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterator

from camwright.book.run import Told, nothing


@contextlib.contextmanager
def progress(total: int, *, quiet: bool) -> Iterator[Told]:
    """Show a progress bar with rate and remaining time, if standard error is a terminal; gives what to tell it."""
    if quiet or not sys.stderr.isatty():
        yield nothing
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, ProgressColumn, Task, TimeRemainingColumn
    from rich.text import Text

    class Rate(ProgressColumn):
        """Designs a second, over the last seconds."""

        def render(self, task: Task) -> Text:
            """Write the rate."""
            return Text("" if task.speed is None else f"{task.speed:.1f} designs/s")

    columns = (BarColumn(), MofNCompleteColumn(), Rate(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as display:
        task = display.add_task("", total=total)
        begun = False

        def told(done: int) -> None:
            nonlocal begun
            if begun:
                display.update(task, completed=done)
            else:  # what was done before is no measure of the speed
                display.reset(task, completed=done, total=total)
            begun = True

        yield told
