"""What a cold `camwright design` of the bundled job costs: without figures beside two imports, and with figures beside without.

The two are CasADi, which it cannot do without, and scipy.signal, which it could have used.

The measure is processor time of the whole process, so that other programs on the machine do not count; the runs alternate, after
one of each that is not counted (compiled files, disk cache). The output of every counted run must be a design whose checks
passed. Writes the runs as CSV and prints the medians and their ratio:

    python benchmarks/cold_start.py [--runs 9]
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path
from time import perf_counter

RESULTS = Path(__file__).parent / "results"

MOST = 1.0
"""Greatest ratio of a design without figures to the imports that the project promises."""

MOST_WITH_FIGURES = 2.0
"""Greatest ratio of a design with figures to one without."""

ENVIRONMENT = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
"""What the processes run in: an installed copy is compiled, so the checkout is too."""

IMPORTS = [sys.executable, "-c", "import casadi, scipy.signal"]
FIGURES = [
    sys.executable,
    "-c",
    "import sys; from camwright.cli.main import main; sys.exit(main())",
    "design",
    "--json",
]
DESIGN = [*FIGURES, "--no-figures"]


def run(command: list[str], directory: str) -> tuple[float, float, str]:
    """Processor and wall time (s) of a process, and what it printed."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), perf_counter()
    done = subprocess.run(command, cwd=directory, env=ENVIRONMENT, capture_output=True, text=True, check=True)
    wall, after = perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, wall, done.stdout


def main() -> int:
    """Run, judge, write, print; the exit code tells whether the promise is kept."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=9)
    options = parser.parse_args()
    rows = []
    for number in range(-1, options.runs):
        row: dict[str, float] = {"run": number}
        for name, command in (("imports", IMPORTS), ("figures", FIGURES), ("design", DESIGN)):
            with tempfile.TemporaryDirectory() as directory:
                processor, wall, output = run(command, directory)
            row |= {f"{name}_processor_s": processor, f"{name}_wall_s": wall}
        answer = json.loads(output)
        if not answer["passed"] or answer["status"] != "optimal":
            print("the design of the bundled job did not pass its checks", file=sys.stderr)
            return 1
        if number >= 0:
            rows.append(row)
    RESULTS.mkdir(exist_ok=True)
    with (RESULTS / "cold_start.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        table.writeheader()
        table.writerows(rows)
    middle = {name: statistics.median(row[name] for row in rows) for name in rows[0]}
    ratio = middle["design_processor_s"] / middle["imports_processor_s"]
    with_figures = middle["figures_processor_s"] / middle["design_processor_s"]
    print("measure,value")
    for name in list(rows[0])[1:]:
        print(f"{name},{middle[name]:.3f}")
    print(f"design over imports,{ratio:.2f} (promised below {MOST:g})")
    print(f"with figures over without,{with_figures:.2f} (promised below {MOST_WITH_FIGURES:g})")
    return 0 if ratio < MOST and with_figures < MOST_WITH_FIGURES else 1


if __name__ == "__main__":
    sys.exit(main())
