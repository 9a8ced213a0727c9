"""Running the cases of the golden run, and what is recorded of each."""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from cases import Case, all_cases
from inputs import inputs
from record import Record

TIMEOUT = 3600.0
"""Seconds that a case may take; the slowest takes a few minutes alone, and several times that beside other work."""

LEFT_OUT = {
    "designs_per_s": "a duration: differs from run to run",
    "peak_rss_mb": "memory of the process: differs from run to run",
}
"""Keys of answers that are recorded as "left out" wherever they stand, and why."""

LEFT_OUT_TEXT = {
    r"made at \S+ a second": "a duration: differs from run to run",
    r"peak memory \d+ MB": "memory of the process: differs from run to run",
    r"(?<=^CasADi - )[\d-]+ [\d:]+(?= WARNING)": "the time of day, in warnings of CasADi on standard error",
}
"""Patterns in texts that are left out, and why."""


def tell(text: str, stream: Any) -> None:
    """Write a line at once."""
    stream.write(text + "\n")
    stream.flush()


_NOT_KEPT = ("PYTHONHASHSEED", "SOURCE_DATE_EPOCH", "PYTHONDONTWRITEBYTECODE")


def environment(root: Path, compiled: Path) -> dict[str, str]:
    """Set what the runs shall not take from the terminal; one thread, as sums of several differ in the last bits.

    Compiled modules go to a folder of the run: a command that compiles all modules anew takes twice as long.
    """
    kept = {name: value for name, value in os.environ.items() if name not in _NOT_KEPT}
    threads = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    plain = {"COLUMNS": "120", "NO_COLOR": "1", "TERM": "dumb", "TZ": "UTC", "LC_ALL": "C.UTF-8"}
    return (
        kept | threads | plain | {"PYTHONPATH": str(root), "PYTHONSAFEPATH": "1", "PYTHONPYCACHEPREFIX": str(compiled)}
    )


def state_of(scratch: Path) -> dict[str, tuple[int, int, int]]:
    """Tell which files are there, and what changes when one is written: its number, time and size."""
    found = {}
    for folder, _, names in os.walk(scratch):
        for name in names:
            path = Path(folder, name)
            status = path.lstat()
            found[path.relative_to(scratch).as_posix()] = (status.st_ino, status.st_ctime_ns, status.st_size)
    return found


def without(value: Any) -> Any:
    """Leave out of an answer what differs from run to run."""
    if isinstance(value, dict):
        return {key: "left out" if key in LEFT_OUT else without(entry) for key, entry in value.items()}
    return [without(entry) for entry in value] if isinstance(value, list) else value


class Runner:
    """Runs cases in a scratch directory.

    Parameters
    ----------
    command
        How camwright is started.
    root
        The repository, for its examples.
    scratch
        The scratch directory, empty.
    """

    def __init__(self, command: Sequence[str], root: Path, scratch: Path) -> None:
        self._command = [*command]
        self._root = root.resolve()
        self._scratch = scratch.resolve()
        self._environment = environment(self._root, self._scratch.with_name("compiled"))
        shutil.copytree(self._root / "examples", self._scratch / "examples")
        self.examples = {
            file.stem: file.read_text(encoding="utf-8") for file in sorted((self._root / "examples").glob("*.toml"))
        }
        for name, content in inputs(self.examples).items():
            path = self._scratch / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content.encode() if isinstance(content, str) else content)

    def run(self, case: Case) -> dict[str, Any]:
        """Run a case; what is recorded of it."""
        if case.prepare is not None:
            case.prepare(self._scratch)
        before = state_of(self._scratch)
        try:
            done = subprocess.run(
                [*self._command, *case.arguments],
                cwd=self._scratch,
                env=self._environment,
                stdin=subprocess.DEVNULL,
                capture_output=True,
                timeout=TIMEOUT,
                check=False,
            )
            code, out, err = done.returncode, done.stdout, done.stderr
        except subprocess.TimeoutExpired:
            code, out, err = None, b"", b"golden: it took too long"
        after = state_of(self._scratch)
        written = sorted(name for name, state in after.items() if before.get(name) != state)
        answer = self._text(out)
        try:
            stdout = without(json.loads(answer))
        except ValueError:
            stdout = answer.splitlines()
        return {
            "arguments": list(case.arguments),
            "exit_code": code,
            "stdout": stdout,
            "stderr": self._text(err).splitlines(),
            "files": {name: hashlib.sha256((self._scratch / name).read_bytes()).hexdigest() for name in written},
            "removed": sorted(before.keys() - after.keys()),
        }

    def _text(self, data: bytes) -> str:
        """Read what was printed; name the directories in it the same wherever they are."""
        text = data.decode("utf-8", "backslashreplace").replace("\r\n", "\n")
        for directory, name in ((self._scratch, "<scratch>"), (self._root, "<root>")):
            text = text.replace(str(directory), name)
        # lines of code differ after any change; what was raised must not
        text = re.sub(r"^Traceback \(most.*?^(?=\S+$|\S+: )", "<traceback>\n", text, flags=re.MULTILINE | re.DOTALL)
        text = re.sub(re.escape(tempfile.gettempdir()) + r"/[\w.-]+", "<temporary>", text)
        text = re.sub(r"\.camwright-\w+", ".camwright-<temporary>", text)
        for pattern in LEFT_OUT_TEXT:
            text = re.sub(pattern, "<left out>", text, flags=re.MULTILINE)
        return text


def chosen(cases: Sequence[Case], only: str | None, *, fast: bool) -> list[Case]:
    """Choose the cases that are recorded."""
    return [case for case in cases if (only is None or only in case.name) and not (fast and case.slow)]


def with_needs(cases: Sequence[Case], wanted: Sequence[Case]) -> list[Case]:
    """Add the cases that others need, in the order of all."""
    by_name = {case.name: case for case in cases}
    names: set[str] = set()
    left = [case.name for case in wanted]
    while left:
        name = left.pop()
        if name not in names:
            names.add(name)
            left += by_name[name].needs
    return [case for case in cases if case.name in names]


def run_all(options: argparse.Namespace, record: Record) -> list[Case]:
    """Run the cases that are asked for and that the record does not have yet, those that ``--fast`` leaves out last.

    Returns
    -------
    list of Case
        The cases that were asked for.
    """
    with tempfile.TemporaryDirectory(prefix="golden-") as place:
        scratch = Path(place, "scratch")
        runner = Runner(shlex.split(options.command), options.root, scratch)
        cases = all_cases(runner.examples)
        wanted = chosen(cases, options.only, fast=options.fast)
        left = [case for case in wanted if case.name not in record.cases]
        missing = {case.name for case in left}
        order = sorted(with_needs(cases, left), key=lambda case: case.slow)
        begun = time.perf_counter()
        for number, case in enumerate(order, 1):
            start = time.perf_counter()
            result = runner.run(case)
            if case.name in missing:
                record.add(case.name, result)
            seconds = time.perf_counter() - start
            tell(f"{number}/{len(order)} {case.name}: exit code {result['exit_code']}, {seconds:.1f} s", sys.stderr)
        tell(f"{len(left)} cases in {time.perf_counter() - begun:.0f} s", sys.stderr)
        if options.keep is not None:
            shutil.rmtree(options.keep, ignore_errors=True)
            shutil.copytree(scratch, options.keep)
    return wanted
