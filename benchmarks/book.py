"""A book of 960 designs with validation and one target: designs a second, beside one processor and beside `camwright design` for each.

First the book must be right: some of its designs, drawn by lot, have the objective that `camwright design` gives for the same job, to
1e-9, and the books of one and of two processes are the same byte for byte. Then wall and processor times of the whole commands are
taken, and the peak memory, that of all its processes added up, for 100 designs and with `--large` for 10 000. One processor means
one: the command with one worker is kept to one processor, or the process that leads, which writes the files, would use a second.
Wall times mean something only where nothing else runs; designs a processor second do where something does. Writes a row as CSV:

    python benchmarks/book.py [--large] [--target codesys]
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import random
import resource
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any

ROOT = Path(__file__).parent.parent
JOB = ROOT / "examples" / "paper-600.toml"
RESULTS = Path(__file__).parent / "results"

RATE, SCALING, LOOP, MEMORY = 60.0, 1.7, 8.0, 600.0
"""Promised: designs a second on two processors; ratio to one processor; ratio to a loop of commands; greatest memory (MB)."""

COMMAND = [sys.executable, "-c", "import sys; from camwright.cli.main import main; sys.exit(main())"]
OBJECTIVES = ["--objective", "peak_acceleration", "--objective", "rms_acceleration"]
SAME = 1e-9
SAMPLE = 5


@dataclass(frozen=True)
class Run:
    """A command that was run: its answer, wall and processor time (s)."""

    answer: dict[str, Any]
    wall: float
    processor: float


def run(*arguments: str, processors: int) -> Run:
    """Run a command of camwright on some of the processors; one whose checks failed counts as done."""
    allowed = sorted(os.sched_getaffinity(0))
    if len(allowed) < processors:
        raise SystemExit(f"{processors} processors are needed, {len(allowed)} may be used")
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), perf_counter()
    done = subprocess.run(
        [*COMMAND, *arguments, "--json"],
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=lambda: os.sched_setaffinity(0, allowed[:processors]),
    )
    wall, after = perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode not in (0, 1):
        raise SystemExit(f"{arguments}: ended with {done.returncode}: {done.stderr}")
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Run(json.loads(done.stdout), wall, spent)


def book(out: Path, length: str, jobs: int, target: str) -> Run:
    """Make a book of five line speeds and two objectives, with a process for each of some processors."""
    ranges = ["--length", length, "--line-speed", "40:120:20", *OBJECTIVES]
    options = ["--targets", target, "--jobs", str(jobs), "--out", str(out)]
    return run("book", str(JOB), *ranges, *options, processors=jobs)


def designed_alone(root: Path, directory: Path) -> list[float]:
    """Design some combinations of a book by the command, compare the objectives; processor times of the commands (s)."""
    lines = (root / "index.csv").read_text(encoding="utf-8").splitlines()
    rows = [row for row in csv.DictReader(line for line in lines if not line.startswith("#")) if row["folder"]]
    times = []
    for row in random.Random(6).sample(rows, SAMPLE):  # noqa: S311 - a sample, no secret
        job = directory / "job.toml"
        stored = json.loads((root / row["folder"] / "design.json").read_text(encoding="utf-8"))
        job.write_text(stored["job"]["toml"], encoding="utf-8")
        alone = run("design", str(job), "--no-figures", "--out", str(directory / "alone"), processors=2)
        found, expected = float(row["value"]), alone.answer["objective"]["value"]
        if abs(found - expected) > SAME * max(1.0, abs(expected)):
            raise SystemExit(f"number {row['number']}: the book has {found!r}, camwright design {expected!r}")
        times.append(alone.processor)
    return times


def same(one: Path, other: Path) -> bool:
    """Whether two folders hold the same files, byte for byte."""
    trees = [
        {file.relative_to(root): file.read_bytes() for file in root.rglob("*") if file.is_file()}
        for root in (one, other)
    ]
    return trees[0] == trees[1]


def main() -> int:
    """Run, judge, write, print; the exit code tells whether the promises are kept."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--large", action="store_true", help="a book of 10 000 designs, too")
    parser.add_argument("--target", default="codesys")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        directory = Path(name)
        two = book(directory / "two", "250:1200:10", 2, options.target)
        one = book(directory / "one", "250:1200:10", 1, options.target)
        if not same(directory / "one", directory / "two"):
            raise SystemExit("the books of one and of two processes differ")
        alone = designed_alone(directory / "two", directory)
        small = book(directory / "small", "250:1150:100", 2, options.target)
        large = book(directory / "large", "250:1249:1", 2, options.target) if options.large else None
    designs = two.answer["designs"]
    rate = designs / two.wall
    row = {
        "target": options.target,
        "designs": designs,
        "infeasible": two.answer["infeasible"],
        "check_failed": two.answer["check_failed"],
        "failed": two.answer["failed"],
        "wall_s": round(two.wall, 2),
        "designs_per_s": round(rate, 1),
        "designs_per_processor_s": round(designs / two.processor, 1),
        "ratio_to_one_processor": round(one.wall / two.wall, 2),
        "ratio_to_commands": round(rate * sum(alone) / len(alone), 1),
        "peak_mb_100": round(small.answer["peak_rss_mb"]),
        "peak_mb_960": round(two.answer["peak_rss_mb"]),
        "peak_mb_10000": round(large.answer["peak_rss_mb"]) if large else "",
        "designs_per_s_10000": round(large.answer["designs_per_s"], 1) if large else "",
    }
    RESULTS.mkdir(exist_ok=True)
    with (RESULTS / "book.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, list(row), lineterminator="\n")
        table.writeheader()
        table.writerow(row)
    print("\n".join(f"{key},{value}" for key, value in row.items()))
    greatest = max(each.answer["peak_rss_mb"] for each in (small, two, large) if each)
    kept = rate >= RATE and one.wall / two.wall >= SCALING and row["ratio_to_commands"] >= LOOP and greatest < MEMORY
    return 0 if kept else 1


if __name__ == "__main__":
    sys.exit(main())
