"""How a command speaks: one answer on standard output, progress and messages on standard error."""

from __future__ import annotations

import contextlib
import io
import os
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import typer

from camwright.house.json_text import to_json
from camwright.house.progress import Step, ignore

if TYPE_CHECKING:
    from rich.console import RenderableType

BROKEN_PIPE = 141
"""Exit code when the reader of standard output is gone, as a shell reports it."""

_PLAIN_WIDTH = 160


@dataclass(frozen=True)
class Voice:
    """How a command answers.

    Parameters
    ----------
    as_json
        One JSON object instead of tables.
    quiet
        No tables and no progress; files, messages and the exit code only.
    """

    as_json: bool
    quiet: bool

    def answer(self, data: Callable[[], dict[str, Any]], view: Callable[[], RenderableType]) -> None:
        """Print the answer in the form that was asked for."""
        if self.as_json:
            _say(to_json(data()))
        elif not self.quiet:
            _say(_rendered(view()))

    @contextlib.contextmanager
    def progress(self, steps: int) -> Iterator[Step]:
        """Show a progress bar on standard error, if that is a terminal; gives what to tell each step to."""
        if self.quiet or not sys.stderr.isatty():
            yield ignore
            return
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

        columns = (TextColumn("{task.description}", markup=False), BarColumn(), TimeElapsedColumn())
        with Progress(*columns, console=Console(stderr=True), transient=True) as display:
            task = display.add_task("starting", total=steps)
            begun = False

            def step(what: str) -> None:
                nonlocal begun
                display.update(task, description=what, advance=1 if begun else 0)
                begun = True

            yield step


def _say(text: str) -> None:
    """Write to standard output; end quietly when nobody reads it any more."""
    try:
        sys.stdout.write(text)
        sys.stdout.flush()
    except BrokenPipeError as error:
        silence_stdout()
        raise typer.Exit(BROKEN_PIPE) from error


def complain(message: str) -> None:
    """Write a message to standard error."""
    sys.stderr.write(f"{message}\n")
    sys.stderr.flush()


def prepare_streams() -> None:
    """Make both streams fit for any text: what the encoding does not know is escaped, a closed stream swallows."""
    if sys.stdout is None:
        sys.stdout = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115 - lives as long as the process
    if sys.stderr is None:
        sys.stderr = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115 - lives as long as the process
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def silence_stdout() -> None:
    """Point standard output to nowhere, so that Python does not try to flush it into a closed pipe at exit."""
    with contextlib.suppress(OSError, ValueError), open(os.devnull, "wb") as nowhere:  # ValueError: not a real file
        os.dup2(nowhere.fileno(), sys.stdout.fileno())


def _rendered(view: RenderableType) -> str:
    """Render for the terminal, or as plain text of a fixed width unless ``COLUMNS`` says one."""
    from rich.console import Console

    told = os.environ.get("COLUMNS", "").isdecimal()
    width = None if sys.stdout.isatty() or told else _PLAIN_WIDTH
    console = Console(
        file=sys.stdout, highlight=False, markup=False, emoji=False, width=width
    )  # brackets in names are text
    with console.capture() as capture:
        console.print(view)
    return capture.get()
