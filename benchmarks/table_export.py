"""What `camwright export DESIGN --to all` costs for each example, and the error of Logix tables over the number of points.

Before anything is timed every file that is released is read back and rebuilt, and its position is compared with the design at
20 001 places: it must lie within the error that the export states. The measure is processor time of the whole cold
process, so that other programs on the machine do not count: the least of some runs, after one that is not counted.
``warm_s`` is the export alone, in a process that has done it before. Prints one CSV row for each example below a heading, then
the Logix tables below another, and ends with 1 if the promise is not kept:

    python benchmarks/table_export.py [--runs 3]
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from time import process_time

import numpy as np

from camwright import load_job, optimise
from camwright.drives.export import Exported, export_possible
from camwright.jobs.job import Job
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import baseline
from camwright.profiles.tables.cam_table import TableUnits, Unit
from camwright.profiles.tables.knots import Accuracy, choose
from camwright.profiles.tables.targets import TARGETS, read_table
from camwright.stored.design_text import design_text

EXAMPLES = Path(__file__).parent.parent / "examples"

MOST = 2.0
"""Processor time (s) of one export of all targets that the project promises."""

_PLACES = 20_001
_ROUNDING = 1e-12


def wrong(profile: CamProfile, result: Exported) -> str:
    """Say in which way a released file is not what the export says of it; nothing if it is."""
    name, text = next(iter(result.files.items()))
    table = read_table(result.target, text, name)
    units = table.units or result.table.units
    if units is None:  # a layout that states none: those that it was written in
        return ""
    rebuilt = units.to_si(result.target.rebuild(table))
    x = np.linspace(profile.start, min(profile.end, rebuilt.end), _PLACES)
    off = float(np.abs(rebuilt(np.maximum(x, rebuilt.start)) - profile(x)).max())
    most = 1.1 * result.deviation.position + _ROUNDING * profile.length
    return "" if off <= most else f"{name}: off by {off:g}, stated {result.deviation.position:g}"


def cold(file: Path, directory: str) -> float:
    """Processor time (s) of the whole command."""
    run = "import sys; from camwright.cli.main import main; sys.exit(main())"
    command = [sys.executable, "-c", run, "export", str(file), "--to", "all", "--out", directory, "--quiet"]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    code = subprocess.run(command, check=False, stdout=subprocess.DEVNULL).returncode
    if code not in (0, 1):
        raise SystemExit(f"{file}: the export ended with {code}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def measured(path: Path, runs: int) -> tuple[str, float]:
    """Design an example, judge and time its export; a CSV row, and the cold time (s)."""
    job: Job = load_job(path)
    found = optimise(job)
    profile, job = found.profile, found.job
    results, refused = export_possible(profile, job, list(TARGETS))
    faults = [fault for result in results if result.files and (fault := wrong(profile, result))]
    if faults or len(results) + len(refused) != len(TARGETS):
        raise SystemExit("\n".join([f"{path}: the files are not what was promised", *faults]))
    began = process_time()
    export_possible(profile, job, list(TARGETS))
    warm = process_time() - began
    with tempfile.TemporaryDirectory() as directory:
        file = Path(directory) / "design.json"
        file.write_text(design_text(found), encoding="utf-8")
        times = [cold(file, directory) for _ in range(runs + 1)][1:]
    released = sum(1 for result in results if result.files)
    withheld = len(results) - released
    most = max(result.table.points for result in results)
    row = f"{path.stem},{released},{withheld},{len(refused)},{most},{warm:.2f},{min(times):.2f},{min(times) <= MOST}"
    return row, min(times)


def main() -> int:
    """Measure, print, judge."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=3)
    options = parser.parse_args()
    print(f"example,released,withheld,refused,most_points,warm_s,cold_s,below_{MOST:g}_s")
    times = []
    for path in sorted(EXAMPLES.glob("*.toml")):
        row, took = measured(path, options.runs)
        print(row, flush=True)
        times.append(took)
    job = load_job()
    smooth = baseline("poly_3_4_5", job.task)
    units = TableUnits(Unit("mm", 1e-3), Unit("deg", job.machine.pitch / 360))
    print("logix_points,position_um,acceleration_rel")
    for points in (20, 35, 60, 100, 180, 360, 1001):
        off = choose(smooth, TARGETS["logix"], units, Accuracy(), points).deviation
        print(f"{points},{off.position * 1e6:.3g},{off.acceleration:.5f}")
    return 0 if max(times) <= MOST else 1


if __name__ == "__main__":
    sys.exit(main())
