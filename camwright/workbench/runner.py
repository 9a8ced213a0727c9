"""`Runner`: one process that runs commands for the page; what it answers is what the command line answers, for it is the command line."""

from __future__ import annotations

import asyncio
import contextlib
import io
import multiprocessing
import os
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path

JOB_FILE = "job.toml"
"""What the page's job is called where commands run."""


CommandLine = Callable[[Sequence[str]], int]
"""The command line: arguments to exit code, its answer on standard output."""


@dataclass(frozen=True)
class Ran:
    """What came of commands.

    Parameters
    ----------
    exit_code
        Of the last that ran.
    answer
        Its standard output: one JSON object.
    files
        Files that the commands wrote, by their path under the place where they ran.
    """

    exit_code: int
    answer: str
    files: dict[str, bytes]


class StaleError(Exception):
    """A newer call has taken the place of this one."""


@dataclass(frozen=True)
class _Child:
    process: BaseProcess
    line: Connection


class Runner:
    """Runs commands in a process of its own, the newest call only: an older one that still runs is stopped.

    Parameters
    ----------
    command_line
        What runs them; a function of a module, so that the process finds it by its name.
    """

    def __init__(self, command_line: CommandLine) -> None:
        self._command_line = command_line
        self._context = multiprocessing.get_context("spawn")
        self._child = self._spawn()
        self._calls = 0
        self._busy = False

    def _spawn(self) -> _Child:
        """Start a process that waits for commands."""
        ours, theirs = self._context.Pipe()
        process = self._context.Process(target=_serve, args=(theirs, self._command_line), daemon=True)
        process.start()
        theirs.close()
        return _Child(process, ours)

    async def run(self, commands: Sequence[Sequence[str]], inputs: dict[str, bytes]) -> Ran:
        """Run commands one after the other, in a folder that holds the inputs, until one fails.

        Raises
        ------
        StaleError
            A newer call came before this one was done.
        """
        self._calls += 1
        call = self._calls
        if self._busy:
            self._stop()
            self._child = self._spawn()
        self._busy, child = True, self._child
        try:
            child.line.send((tuple(tuple(command) for command in commands), inputs))
            ran = await asyncio.get_running_loop().run_in_executor(None, _received, child.line)
        finally:
            if call == self._calls:
                self._busy = False
        if ran is None or call != self._calls:
            raise StaleError
        return ran

    def _stop(self) -> None:
        """End the process, whatever it does."""
        self._child.process.terminate()
        self._child.process.join()

    def close(self) -> None:
        """End the process."""
        self._stop()
        self._child.line.close()


def _received(line: Connection) -> Ran | None:
    """Wait for an answer; nothing where the process was stopped."""
    try:
        found = line.recv()
    except (EOFError, OSError):
        return None
    return found if isinstance(found, Ran) else None


def _serve(line: Connection, command_line: CommandLine) -> None:
    """Run commands as they come, until the other end is closed."""
    with contextlib.suppress(EOFError, OSError, KeyboardInterrupt):  # the page is gone
        while True:
            commands, inputs = line.recv()
            line.send(_run(command_line, commands, inputs))


def _run(command_line: CommandLine, commands: Sequence[Sequence[str]], inputs: dict[str, bytes]) -> Ran:
    """Run commands in a folder of their own."""
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        for name, data in inputs.items():
            Path(name).write_bytes(data)
        exit_code, said = 0, ""
        for command in commands:
            with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.redirect_stderr(io.StringIO()):
                exit_code = command_line(command)
            said = out.getvalue()
            if exit_code > 1:
                break
        return Ran(exit_code, said, _written(Path(), inputs))


def _written(place: Path, inputs: dict[str, bytes]) -> dict[str, bytes]:
    """Read what was written beside the inputs."""
    found = {}
    for root, _, names in os.walk(place):
        for name in names:
            path = Path(root) / name
            if path.as_posix() not in inputs:
                found[path.as_posix()] = path.read_bytes()
    return dict(sorted(found.items()))
