"""`Runner`: a process that runs commands for the page; what it answers is what the command line answers, for it is the command line."""

from __future__ import annotations

import asyncio
import contextlib
import io
import multiprocessing
import os
import signal
import tempfile
import threading
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path

JOB_FILE = "job.toml"
"""What the page's job is called where commands run."""


_PROCESSES = multiprocessing.get_context("spawn")
"""How processes begin: with nothing of the server's."""

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
    """A newer call of the same kind has taken the place of this one."""


@dataclass(frozen=True)
class _Child:
    process: BaseProcess
    line: Connection


_REHEARSAL = ("design", "--brief", "--json", "--out", "out")
"""What a spare process runs before it is needed: a design of the bundled job has imported and made all that takes long."""


class Runner:
    """Runs commands in a process of its own, one call at a time; a newer call of the same kind ends an older one with its process.

    A second one stands by from the first answer on, so that who follows an ended call does not wait for a process to begin.

    Parameters
    ----------
    command_line
        What runs them; a function of a module, so that the process finds it by its name.
    """

    def __init__(self, command_line: CommandLine) -> None:
        self._command_line = command_line
        self._children = [self._spawn()]  # the one that runs commands, and behind it the one that stands by
        self._newest: dict[str, int] = {}
        self._running: str | None = None
        self._closed = False
        self._free = asyncio.Lock()

    def _spawn(self, *, rehearse: bool = False) -> _Child:
        """Start a process that waits for commands."""
        ours, theirs = _PROCESSES.Pipe()
        process = _PROCESSES.Process(target=_serve, args=(theirs, self._command_line, rehearse), daemon=True)
        with _deaf():
            process.start()
        theirs.close()
        return _Child(process, ours)

    async def run(self, kind: str, commands: Sequence[Sequence[str]], inputs: dict[str, bytes]) -> Ran:
        """Run commands one after the other, in a folder that holds the inputs, until one fails.

        Parameters
        ----------
        kind
            What is asked for; of each kind only the newest call is answered.
        commands, inputs
            Arguments of each command, and files by their path.

        Raises
        ------
        StaleError
            A newer call of the kind came before this one was done.
        """
        call = self._newest.get(kind, 0) + 1
        self._newest[kind] = call
        self._end(kind)
        async with self._free:
            if self._closed or call != self._newest[kind]:
                raise StaleError
            self._running, child = kind, self._children[0]
            child.line.send((tuple(tuple(command) for command in commands), inputs))
            ran = await asyncio.get_running_loop().run_in_executor(None, _received, child.line)
            if child is self._children[0]:
                self._running = None
            if len(self._children) == 1 and not self._closed:
                self._children.append(self._spawn(rehearse=True))
        if ran is None or call != self._newest[kind]:
            raise StaleError
        return ran

    def forget(self, kind: str) -> None:
        """End what is asked for, for nobody waits for it any more."""
        self._newest[kind] = self._newest.get(kind, 0) + 1
        self._end(kind)

    def _end(self, kind: str) -> None:
        """End a call of a kind if it runs; the spare process takes its place."""
        if self._running == kind and not self._closed:
            _stop(self._children.pop(0))
            self._running = None
            if not self._children:
                self._children.append(self._spawn())

    def close(self) -> None:
        """End the processes; calls that wait for them are told that they are stale, and so are all that come later."""
        self._closed = True
        for child in self._children:
            _stop(child)


def _stop(child: _Child) -> None:
    """End a process, whatever it does."""
    child.process.terminate()
    child.process.join()  # the line ends with it, which whoever waits there is told


@contextlib.contextmanager
def _deaf() -> Iterator[None]:
    """Start a process that a Ctrl-C in the terminal does not reach: it ends with the one that started it.

    Only the main thread may say so; another one is a test's.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _received(line: Connection) -> Ran | None:
    """Wait for an answer; nothing where the process was stopped."""
    try:
        found = line.recv()
    except (EOFError, OSError):
        return None
    return found if isinstance(found, Ran) else None


def _serve(line: Connection, command_line: CommandLine, rehearse: bool) -> None:
    """Run commands as they come, until the other end is closed."""
    with contextlib.suppress(EOFError, OSError, KeyboardInterrupt):  # the page is gone
        if rehearse:
            _run(command_line, (_REHEARSAL,), {})
        while True:
            commands, inputs = line.recv()
            line.send(_run(command_line, commands, inputs))


def _run(command_line: CommandLine, commands: Sequence[Sequence[str]], inputs: dict[str, bytes]) -> Ran:
    """Run commands in a folder of their own."""
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        for name, data in inputs.items():
            Path(name).parent.mkdir(exist_ok=True)
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
