"""Changes each promised number of the code in turn and shows that a test of ``tests/contract`` fails.

    python benchmarks/mutate_contract.py [--only WORDS] [--jobs N]

Each change is made in a copy of the checkout. A change that no test notices survives; there must be none. The table goes to
``benchmarks/results/mutate_contract.csv``. ``tests/house/test_mutations.py`` checks that every number of the contract is changed
here, and that each text to be changed is still in the code.
"""

from __future__ import annotations

import argparse
import csv
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from queue import Queue

ROOT = Path(__file__).resolve().parents[1]
RESULTS = ROOT / "benchmarks" / "results" / "mutate_contract.csv"
FLOORS = ("camwright", "design", "profiles", "validation")
COPIED = (*FLOORS, "tests/contract", "tests/conftest.py", "docs", "examples", "pyproject.toml")


Row = tuple[str, str, str, str, str, str]
"""Promise, file, text before, text after, outcome, and the first test that noticed."""


@dataclass(frozen=True)
class Change:
    """A promised number, and what it becomes.

    Parameters
    ----------
    promise
        What is promised, as `tests/contract` calls it where it has it in its table.
    file
        Name of the file that holds it; only one of that name has the text.
    before, after
        Text in the code, and what is put there.
    """

    promise: str
    file: str
    before: str
    after: str


CHANGES = (
    # the six that the tests of 0.1.0 did not notice
    Change("limit of a table", "rebuilt.py", "\nALLOWANCE = 0.01\n", "\nALLOWANCE = 0.03\n"),
    Change("acceleration of a table", "knots.py", "acceleration: float = 0.01", "acceleration: float = 0.03"),
    Change("recorded values", "sheet_faults.py", "\nSAME = 1e-6\n", "\nSAME = 1e-2\n"),
    Change("places of the sync zone", "place.py", "\nPLACES = 9\n", "\nPLACES = 3\n"),
    Change("standing", "motor.py", "\n_STANDING = 1e-9\n", "\n_STANDING = 0.1\n"),
    Change("twice the allowance in a report", "check.py", "value <= limit + room", "value <= limit + 2 * room"),
    # by behaviour, not by the name of a constant
    Change("twice the allowance of a table", "rebuilt.py", "allowed = 1.0 + ALLOWANCE", "allowed = 1.0 + 2 * ALLOWANCE"),
    Change("no allowance in a report", "check.py", "value <= limit + room", "value <= limit"),
    Change("twice the tolerance of verify", "sheet_faults.py", "<= share * abs(recorded)", "<= 2 * share * abs(recorded)"),
    Change("twice the threshold of standing", "motor.py", "<= _STANDING * ", "<= 2 * _STANDING * "),
    Change("one place less", "place.py", "greatest - margin, places)", "greatest - margin, places - 1)"),
    Change("places for a peak", "place.py", "\nPEAK_PLACES, PEAK_RESOLUTION = 41,", "\nPEAK_PLACES, PEAK_RESOLUTION = 21,"),
    Change("valleys gone down", "place.py", "\nMOST_DEEP = 3\n", "\nMOST_DEEP = 2\n"),
    Change("one wrap", "rebuilt.py", "wraps: int = LEAST_WRAPS", "wraps: int = 1"),
    # the numbers of the contract
    Change("limit", "report.py", "\nALLOWANCE = 1e-9\n", "\nALLOWANCE = 2e-9\n"),
    Change("travel", "report.py", "\nCLOSURE = 1e-12\n", "\nCLOSURE = 2e-12\n"),
    Change("ratio in sync", "report.py", "\nSYNC_RATIO = 1e-9\n", "\nSYNC_RATIO = 2e-9\n"),
    Change("position at joins", "motion.py", "\nPOSITION_JUMP = 1e-12\n", "\nPOSITION_JUMP = 2e-12\n"),
    Change("ratio at joins", "motion.py", "\nRATIO_JUMP = 1e-9\n", "\nRATIO_JUMP = 2e-9\n"),
    Change("ratio slope at joins", "motion.py", "\nSLOPE_JUMP = 1e-9\n", "\nSLOPE_JUMP = 2e-9\n"),
    Change("drawn in", "transcription.py", "\nLIMIT_MARGIN = 2e-10\n", "\nLIMIT_MARGIN = 0.0\n"),
    Change("memory of the servo", "simulation.py", "\n_FORGOTTEN = 1e-12\n", "\n_FORGOTTEN = 1e-6\n"),
    Change("phases", "simulation.py", "\nPHASES = 16\n", "\nPHASES = 8\n"),
    Change("phases of a design", "axis_response.py", "\nPHASES = 16\n", "\nPHASES = 8\n"),
    Change("samples", "simulation.py", "\n_MOST_SAMPLES = 2**17\n", "\n_MOST_SAMPLES = 2**16\n"),
    Change("samples one by one", "simulation.py", "\nWHOLE, WHOLE_PART = 2**13,", "\nWHOLE, WHOLE_PART = 2**14,"),
    Change("limits of the axis", "axis_motion.py", "\nALLOWANCE = 1e-3\n", "\nALLOWANCE = 2e-3\n"),
    Change("cut length, axis in sync", "axis_lengths.py", "\n_LENGTH_RESOLUTION = 2e-4\n", "\n_LENGTH_RESOLUTION = 2e-3\n"),
    Change("cut length to a tolerance", "minimum_length.py", "\n_LENGTH_RESOLUTION = 3e-6\n", "\n_LENGTH_RESOLUTION = 3e-5\n"),
    Change("sync zone to a tolerance", "minimum_length.py", "\n_ZONE_RESOLUTION = 1e-5\n", "\n_ZONE_RESOLUTION = 1e-4\n"),
    Change("sync zones tried", "minimum_length.py", "\n_FINE = 64\n", "\n_FINE = 32\n"),
    Change("meshes of a torque", "search.py", "\nFIRST = 60\n", "\nFIRST = 30\n"),
    Change("settled torque", "search.py", "\nSETTLED, SHRINKS = 1e-4, 0.45\n", "\nSETTLED, SHRINKS = 1e-2, 0.45\n"),
    Change("meshes of a place", "placing.py", "\nCOARSE, FINE, FINEST = 40, 120, 300\n", "\nCOARSE, FINE, FINEST = 40, 60, 120\n"),
    Change("meshes of a place that tell", "placing.py", "\nSTILL = 5e-3\n", "\nSTILL = 5e-2\n"),
    Change("places of a torque", "placing.py", "\nPLACES = 24\n", "\nPLACES = 12\n"),
    Change("accuracy of the place", "place.py", "\nRESOLUTION = 2e-3\n", "\nRESOLUTION = 2e-2\n"),
    Change("accuracy of the place for a peak", "place.py", "RESOLUTION = 41, 1e-5\n", "RESOLUTION = 41, 1e-3\n"),
    Change("standing carriage", "screw.py", "\n_STANDING = 1e-9\n", "\n_STANDING = 0.1\n"),
    Change("size of a job file", "toml_file.py", "\nMOST_BYTES = 1 << 20\n", "\nMOST_BYTES = 1 << 21\n"),
    Change("size of a design", "design_file.py", "\nMOST_BYTES = 1 << 26\n", "\nMOST_BYTES = 1 << 25\n"),
    Change("size of a table", "text.py", "\nLARGEST_FILE = 4_000_000\n", "\nLARGEST_FILE = 8_000_000\n"),
    Change("rows of a CSV", "cam_rows.py", "\nFEWEST_ROWS = 4\n", "\nFEWEST_ROWS = 2\n"),
    Change("cycle of a CSV", "profile_files.py", "\n_ROUNDING = 1e-6\n", "\n_ROUNDING = 1e-3\n"),
    Change("rows of a trace, least", "quality.py", "\nFEWEST_ROWS = 200\n", "\nFEWEST_ROWS = 100\n"),
    Change("rows of a trace, most", "trace_csv.py", "\nMOST_ROWS = 10_000\n", "\nMOST_ROWS = 20_000\n"),
    Change("pieces of a cut list", "list_file.py", "\nMOST_PIECES = 200_000\n", "\nMOST_PIECES = 100_000\n"),
    Change("gaps of a cut list", "list_checks.py", "\nMOST_CAMS = 300\n", "\nMOST_CAMS = 600\n"),
    Change("longest cut", "machine.py", "\nLONGEST = 1000.0\n", "\nLONGEST = 500.0\n"),
    Change("longest cut of a crank", "crank_slider.py", "\n_STROKES = 100.0\n", "\n_STROKES = 200.0\n"),
    Change("size of a cut list", "list_file.py", "\nMOST_BYTES = 32 * 2**20\n", "\nMOST_BYTES = 16 * 2**20\n"),
    Change("samples of a cut list", "list_checks.py", "\nMOST_SAMPLES = 300_000_000\n", "\nMOST_SAMPLES = 900_000_000\n"),
    Change("gentlest ramp", "list_checks.py", "\nLEAST = 1e-6\n", "\nLEAST = 1e-9\n"),
    Change("hardest ramp", "line_plan.py", "\nHARDEST = 1e4\n", "\nHARDEST = 1e5\n"),
    Change("rows of a recorded run", "recording.py", "\n_MOST_ROWS = 200_000\n", "\n_MOST_ROWS = 100_000\n"),
    Change("cuts in one table", "knots.py", "\n_MOST_CUTS = 24\n", "\n_MOST_CUTS = 12\n"),
    Change("step of a trace", "trace_csv.py", "\n_UNEQUAL = 0.01\n", "\n_UNEQUAL = 0.1\n"),
    Change("length of a trace", "quality.py", "\nSHORTEST = 0.3\n", "\nSHORTEST = 0.03\n"),
    Change("scale of a trace", "quality.py", "\n_SCALE = 8.0\n", "\n_SCALE = 30.0\n"),
    Change("fit of a trace", "identification.py", "\n_WORST_FIT = 0.5\n", "\n_WORST_FIT = 0.1\n"),
    Change("confidence", "fit.py", "\nCONFIDENCE = 1.96\n", "\nCONFIDENCE = 1.0\n"),
    Change("bandwidth", "fit.py", '"bandwidth": (10.0, 3000.0)', '"bandwidth": (1.0, 3000.0)'),
    Change("damping", "fit.py", '"damping": (0.1, 3.0)', '"damping": (0.1, 30.0)'),
    Change("gain", "fit.py", '"position_gain": (0.5, 1000.0)', '"position_gain": (0.05, 1000.0)'),
    Change("sample time", "fit.py", '"sample_time": (1e-4, 2e-2)', '"sample_time": (1e-4, 2e-1)'),
    Change("dead time", "fit.py", '"dead_time": (-0.02, 0.05)', '"dead_time": (-0.02, 0.5)'),
    Change("shares of the line speed", "lead.py", "SHARES = (0.1, 0.25, 0.5, 1.0)", "SHARES = (0.2, 0.25, 0.5, 1.0)"),
    Change("resolution of a figure", "picture_files.py", "PIXELS_PER_INCH = 150.0", "PIXELS_PER_INCH = 75.0"),
    Change("width of a figure", "panel.py", "\nWIDTH, LEFT, RIGHT = 648.0,", "\nWIDTH, LEFT, RIGHT = 672.0,"),
    Change("interrupted", "main.py", "\nINTERRUPTED = 130\n", "\nINTERRUPTED = 1\n"),
    Change("reader gone", "output.py", "\nBROKEN_PIPE = 141\n", "\nBROKEN_PIPE = 1\n"),
    Change("check failed", "errors.py", "    exit_code: int = 1\n", "    exit_code: int = 0\n"),
    Change("bad input", "errors.py", "    exit_code = 2\n", "    exit_code = 1\n"),
    Change("infeasible", "errors.py", "    exit_code = 3\n", "    exit_code = 1\n"),
    Change("solver failed", "errors.py", "    exit_code = 4\n", "    exit_code = 1\n"),
    Change("shortest length", "units.py", '"600 mm", "m", 1e-9, 1e6', '"600 mm", "m", 1e-6, 1e6'),
    Change("longest time", "units.py", '"4 ms", "s", 1e-9, 1e6', '"4 ms", "s", 1e-9, 1e9'),
    Change("greatest speed", "units.py", '"m/s", 1e-9, 1e6', '"m/s", 1e-9, 1e7'),
    Change("greatest acceleration", "units.py", '"m/s^2", 1e-9, 1e9', '"m/s^2", 1e-9, 1e12'),
    Change("greatest jerk", "units.py", '"3000 m/s^3", "m/s^3", 1e-9, 1e15', '"3000 m/s^3", "m/s^3", 1e-9, 1e12'),
    Change("least angular rate", "units.py", '"120 rad/s", "rad/s", 1e-6, 1e9', '"120 rad/s", "rad/s", 1e-9, 1e9'),
    Change("greatest gain", "units.py", '"35 1/s", "1/s", 1e-6, 1e9', '"35 1/s", "1/s", 1e-6, 1e6'),
    Change("greatest damping", "servo_table.py", "number_field(0.0, 100.0,", "number_field(0.0, 10.0,"),
    Change("greatest feed-forward", "servo_table.py", "number_field(0.0, 1.0,", "number_field(0.0, 1.1,"),
    Change("points of cam.csv", "structure.py", "whole_field(2, 100_000, 361)", "whole_field(2, 200_000, 361)"),
    # the numbers of the targets
    Change("wraps", "rebuilt.py", "\nLEAST_WRAPS = 3\n", "\nLEAST_WRAPS = 2\n"),
    Change("position of a table", "knots.py", "position: float = 1e-6", "position: float = 3e-6"),
    Change("ratio of a table", "knots.py", "ratio: float = 1e-3", "ratio: float = 3e-3"),
    Change("codesys", "codesys.py", "\nMOST_POINTS = 32_767", "\nMOST_POINTS = 65_535"),
    Change("twincat", "twincat.py", "\nMOST_ROWS = 16_777_216\n", "\nMOST_ROWS = 65_536\n"),
    Change("twincat-cnc", "isg.py", "\nMOST_PAIRS = 360\n", "\nMOST_PAIRS = 720\n"),
    Change("s7-1500t", "siemens.py", "\nMOST_BASIC = 51\n", "\nMOST_BASIC = 60\n"),
    Change("s7-1500t-points", "siemens.py", "\nMOST_POINTS = 10_000\n", "\nMOST_POINTS = 1000\n"),
    Change("pacdrive", "pacdrive.py", "\nMOST_SEGMENTS = 32\n", "\nMOST_SEGMENTS = 64\n"),
    Change("br", "br.py", "\nMOST_SECTIONS = 130\n", "\nMOST_SECTIONS = 131\n"),
    Change("sew", "sew.py", "\nMOST_SPLINE = 64\n", "\nMOST_SPLINE = 65\n"),
    Change("technosoft", "technosoft.py", "\nMOST_POINTS = 8192\n", "\nMOST_POINTS = 8193\n"),
    Change("trio", "trio.py", "\nMOST_POINTS = 16_000\n", "\nMOST_POINTS = 16_001\n"),
    Change("csv", "csv_target.py", "\nMOST_POINTS = 32_767\n", "\nMOST_POINTS = 32_768\n"),
)  # fmt: skip


def place_of(change: Change, root: Path) -> Path:
    """Find the file that holds the text of a change.

    Raises
    ------
    LookupError
        No file has it, or several do.
    """
    files = [file for floor in FLOORS for file in sorted((root / floor).rglob(change.file))]
    found = {file.resolve() for file in files if change.before in file.read_text(encoding="utf-8")}
    if len(found) != 1:
        raise LookupError(
            f"{change.promise}: {change.before.strip()!r} is in {len(found)} files called {change.file}, not in one"
        )
    return found.pop()


def put(file: Path, text: str) -> None:
    """Write a module and drop what was compiled of it: a change in the same second and of the same size would not be seen."""
    file.write_text(text, encoding="utf-8")
    for compiled in (file.parent / "__pycache__").glob(f"{file.stem}.*.pyc"):
        compiled.unlink()


def copied(target: Path) -> None:
    """Copy what the tests need, with links as they are."""
    for name in COPIED:
        source, place = ROOT / name, target / name
        place.parent.mkdir(parents=True, exist_ok=True)
        if source.is_dir():
            shutil.copytree(source, place, symlinks=True, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(source, place)


def tested(root: Path) -> tuple[int, str]:
    """Run the tests of the contract until one fails, the table of numbers first; pytest's exit code, and the test."""
    code, test = _run(root, "tests/contract/test_stated.py")
    return (code, test) if code else _run(root, "tests/contract")


def _run(root: Path, tests: str) -> tuple[int, str]:
    command = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", tests]
    environment = os.environ | {"PYTHONPATH": str(root)}
    done = subprocess.run(command, cwd=root, env=environment, capture_output=True, text=True, check=False)
    failed = re.search(r"^(?:FAILED|ERROR) (.+?)(?: - .*)?$", done.stdout, re.MULTILINE)
    return done.returncode, failed[1] if failed else ""


def made(change: Change, root: Path) -> Row:
    """Make a change in a copy, run the tests, and take it back.

    Raises
    ------
    RuntimeError
        The tests do not run.
    """
    begun = time.perf_counter()
    file = place_of(change, root)
    text = file.read_text(encoding="utf-8")
    put(file, text.replace(change.before, change.after))
    code, test = tested(root)
    put(file, text)
    if code not in (0, 1):
        raise RuntimeError(f"{change.promise}: the tests do not run (pytest ends with {code})")
    outcome = "noticed" if code else "survived"
    print(f"{outcome:9} {change.promise} ({time.perf_counter() - begun:.1f} s) {test}", flush=True)
    return (
        change.promise,
        file.relative_to(root.resolve()).as_posix(),
        change.before.strip(),
        change.after.strip(),
        outcome,
        test,
    )


def main() -> int:
    """Make all changes, or those of which the promise has some words; 1 if one survives.

    Raises
    ------
    RuntimeError
        The tests fail without any change, or do not run with one.
    """
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", default="", metavar="WORDS", help="make these changes only, and write no table")
    parser.add_argument(
        "--jobs", type=int, default=2, metavar="N", help="copies in which changes are made side by side"
    )
    options = parser.parse_args()
    changes = [change for change in CHANGES if options.only in change.promise]
    with tempfile.TemporaryDirectory(prefix="contract-") as folder:
        free: Queue[Path] = Queue()
        for number in range(options.jobs):
            root = Path(folder, str(number))
            copied(root)
            if tested(root)[0] != 0:
                raise RuntimeError("tests/contract fails before anything is changed")
            free.put(root)

        def in_a_free_copy(change: Change) -> Row:
            root = free.get()
            try:
                return made(change, root)
            finally:
                free.put(root)

        with ThreadPoolExecutor(options.jobs) as pool:
            rows = list(pool.map(in_a_free_copy, changes))
    if not options.only:
        with RESULTS.open("w", newline="", encoding="utf-8") as out:
            head = ("promise", "file", "before", "after", "outcome", "first test")
            csv.writer(out, lineterminator="\n").writerows([head, *rows])
    survivors = [row[0] for row in rows if row[4] == "survived"]
    print(f"{len(survivors)} of {len(rows)} survive{': ' if survivors else ''}{', '.join(survivors)}")
    return 1 if survivors else 0


if __name__ == "__main__":
    sys.exit(main())
