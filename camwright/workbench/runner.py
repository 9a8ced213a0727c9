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
"""What a process that stands by runs before it is needed: a design of the bundled job imports and makes all that takes long."""

_QUIET = 2.0
"""Time (s) without a call after which a process begins to stand by: a hand that drags needs both processors."""


class _Processes:
    """Processes that wait for commands: one runs them, and behind it one stands by once nobody has asked for anything for a while."""

    def __init__(self, command_line: CommandLine, quiet: float) -> None:
        self._command_line, self._quiet = command_line, quiet
        self._all = [self._spawn()]
        self._waking: asyncio.TimerHandle | None = None

    @property
    def first(self) -> _Child:
        """The one that runs commands."""
        return self._all[0]

    def _spawn(self, *, rehearse: bool = False) -> _Child:
        """Start a process that waits for commands."""
        ours, theirs = _PROCESSES.Pipe()
        process = _PROCESSES.Process(target=_serve, args=(theirs, self._command_line, rehearse), daemon=True)
        with _deaf():
            process.start()
        theirs.close()
        return _Child(process, ours)

    def put_off(self) -> None:
        """Begin to wait for quiet anew, if none stands by."""
        self._wake_no_more()
        if len(self._all) == 1:
            self._waking = asyncio.get_running_loop().call_later(self._quiet, self._stand_by)

    def _wake_no_more(self) -> None:
        """Wait for quiet no longer."""
        if self._waking is not None:
            self._waking.cancel()

    def _stand_by(self) -> None:
        self._all.append(self._spawn(rehearse=True))

    def replace(self) -> None:
        """End the one that runs commands, whatever it does; who stands by takes its place."""
        self._wake_no_more()
        _stop(self._all.pop(0))
        if not self._all:
            self._all.append(self._spawn())

    def close(self) -> None:
        """End all."""
        self._wake_no_more()
        for child in self._all:
            _stop(child)


class Runner:
    """Runs commands in a process of its own, one call at a time; a newer call of the same kind ends an older one with its process.

    After some quiet a second one stands by, so that who follows an ended call does not wait for a process to begin.

    Parameters
    ----------
    command_line
        What runs them; a function of a module, so that the process finds it by its name.
    quiet
        Time (s) without a call after which the second one begins.
    """

    def __init__(self, command_line: CommandLine, quiet: float = _QUIET) -> None:
        self._processes = _Processes(command_line, quiet)
        self._newest: dict[str, int] = {}
        self._running: str | None = None
        self._closed = False
        self._free = asyncio.Lock()

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
            self._running, child = kind, self._processes.first
            child.line.send((tuple(tuple(command) for command in commands), inputs))
            ran = await asyncio.get_running_loop().run_in_executor(None, _received, child.line)
            if child is self._processes.first:
                self._running = None
            self.asked()
        if ran is None or call != self._newest[kind]:
            raise StaleError
        return ran

    def asked(self) -> None:
        """Hear that somebody asks for something, of whomever: nothing else is begun meanwhile."""
        if not self._closed:
            self._processes.put_off()

    def forget(self, kind: str) -> None:
        """End what is asked for, for nobody waits for it any more."""
        self._newest[kind] = self._newest.get(kind, 0) + 1
        self._end(kind)

    def _end(self, kind: str) -> None:
        """End a call of a kind if it runs."""
        if self._running == kind and not self._closed:
            self._running = None
            self._processes.replace()

    def close(self) -> None:
        """End the processes; calls that wait for them are told that they are stale, and so are all that come later."""
        self._closed = True
        self._processes.close()


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
