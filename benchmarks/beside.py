"""Warm designs and books of this version beside those of another, on that one's own job files.

The other version is a checkout, for example of the first one, `git worktree add ../before 85b1673`. A warm design is the job designed again
in the same process, its bounds and bands included where a version has them; the measure is processor time, and the least of the runs
counts. An answer must be no worse, and a book must have as many designs that passed. Checks of single designs are not compared, which the
first version made less strictly (its shear settles 0.21 mm off), nor is the least sync error: a shaped command is designed for all line
speeds of its job now, and was for one. Writes the rows as CSV and prints them; ends with 1 where a warm design is slower, or an answer
worse:

    python benchmarks/beside.py ../before [--runs 3]
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
RESULTS = ROOT / "benchmarks" / "results"

WORSE = 1e-4
"""Share by which an objective may be above the other version's."""

BOOKS = {
    "paper-600": ("250:1190:20", "40:120:20"),
    "thick-product": ("240:320:20", "20:40:20"),
    "cross-cutter": ("500:800:20", "100:150:50"),
    "flying-saw": ("2000:3000:200", "40:60:20"),
    "chasing-shear": ("800:900:50", "20:40:20"),
}
"""Cut lengths (mm) and line speeds (m/min) of the books, by the job that they are of."""

WARM = """
import json, sys, time
import camwright
from camwright import load_job
design = camwright.optimise if hasattr(camwright, "optimise") else camwright.design
job = load_job(sys.argv[1])
found = design(job)
seconds = []
for _ in range(int(sys.argv[2])):
    begun = time.process_time()
    found = design(job)
    seconds.append(time.process_time() - begun)
asked = job.objective if isinstance(job.objective, str) else job.objective.minimise
print(json.dumps({"seconds": min(seconds), "value": float(found.objective), "asked": str(asked)}))
"""

COMMAND = """
import sys
try:
    from camwright.cli.main import main
except ImportError:
    from camwright.cli import main
if __name__ == "__main__":  # workers begin by reading this file
    sys.exit(main())
"""


def environment(code: Path, kept: str) -> dict[str, str]:
    """Environment in which a checkout is the one that is imported; one thread, compiled files in a folder of their own."""
    told = {"PYTHONPATH": str(code), "PYTHONPYCACHEPREFIX": kept, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    return {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"} | told


def spent(command: list[str], directory: str, surroundings: dict[str, str]) -> tuple[float, str]:
    """Processor time (s) of a process, and what it printed."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, cwd=directory, env=surroundings, capture_output=True, text=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if not done.stdout:
        raise SystemExit(f"{' '.join(command[-8:])} printed nothing: {done.stderr[-500:]}")
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, done.stdout


def warm(codes: tuple[Path, Path], kept: str, runs: int) -> list[dict[str, Any]]:
    """Rows of all examples of the other version: this code's warm design beside its own."""
    rows = []
    for job in sorted((codes[0] / "examples").glob("*.toml")):
        answers = []
        for code in codes:
            with tempfile.TemporaryDirectory() as directory:
                command = [sys.executable, "-c", WARM, str(job), str(runs)]
                answers.append(json.loads(spent(command, directory, environment(code, kept))[1]))
        other, own = answers
        same = own["asked"] != "sync_error"
        good = not same or own["value"] <= other["value"] * (1 + WORSE)
        rows.append(row(f"design {job.stem}", other["seconds"], own["seconds"], good))
        rows[-1] |= {"other_value": other["value"], "own_value": own["value"]}
    return rows


def books(codes: tuple[Path, Path], kept: str, runs: int) -> list[dict[str, Any]]:
    """Rows of the books: the whole command with one process, the runs of both versions in alternation."""
    rows = []
    for name, (lengths, speeds) in BOOKS.items():
        times: tuple[list[float], list[float]] = ([], [])
        passed = [0, 0]
        for _ in range(runs):
            for side, code in enumerate(codes):
                with tempfile.TemporaryDirectory() as directory:
                    script = Path(directory) / "command.py"
                    script.write_text(COMMAND, encoding="utf-8")
                    command = [sys.executable, str(script), "book", str(codes[0] / "examples" / f"{name}.toml")]
                    command += ["--length", lengths, "--line-speed", speeds, "--targets", "codesys", "--jobs", "1"]
                    seconds, said = spent([*command, "--out", "book", "--json"], directory, environment(code, kept))
                times[side].append(seconds)
                answer = json.loads(said)
                passed[side] = answer["designs"] - answer["infeasible"] - answer["check_failed"]
        rows.append(row(f"book {name}", min(times[0]), min(times[1]), passed[1] >= passed[0]))
        rows[-1] |= {"other_value": passed[0], "own_value": passed[1]}
    return rows


def row(what: str, other: float, own: float, good: bool) -> dict[str, Any]:
    """One row, both times in seconds."""
    return {"what": what, "good": int(good), "other_s": other, "own_s": own, "ratio": own / other}


def main() -> int:
    """Run, judge, write, print; the exit code tells whether the promise is kept."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("other", type=Path, help="folder with the checkout of the other version")
    parser.add_argument("--runs", type=int, default=3)
    options = parser.parse_args()
    codes = options.other.resolve(), ROOT
    with tempfile.TemporaryDirectory() as kept:
        rows = warm(codes, kept, options.runs) + books(codes, kept, options.runs)
    with (RESULTS / "beside.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        table.writeheader()
        table.writerows(
            {name: f"{value:.6g}" if isinstance(value, float) else value for name, value in each.items()}
            for each in rows
        )
    for each in rows:
        print(
            f"{each['what']}: {each['other_s']:.3f} to {each['own_s']:.3f} s, {each['ratio']:.2f}"
            + ("" if each["good"] else ": NOT GOOD")
        )
    kept_promise = all(each["good"] and (each["ratio"] <= 1.0 or each["what"].startswith("book")) for each in rows)
    return 0 if kept_promise else 1


if __name__ == "__main__":
    sys.exit(main())
