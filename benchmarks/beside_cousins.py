"""Warm designs of this version beside those of another, on *cousins* of that one's examples: its own job files with a few lines changed.

`beside` compares the examples themselves; a code that is quick on these may be slow beside them. Of each job both versions are asked in
turn, each in a process of its own, and the least processor time of the runs counts. First an answer must be no worse, but for jobs that are
another problem now: a servo-aware design is one for all line speeds of its job (42 of them), and was one for its full line speed. Writes
the rows as CSV and prints them; ends with 1 where an answer is worse, or a design slower:

    python benchmarks/beside_cousins.py ../before [--runs 2] [--only WORD]
"""

from __future__ import annotations

import argparse
import csv
import json
import statistics
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from beside import RESULTS, ROOT, WORSE, environment, row

ASKED = """
import json, sys, time
import camwright
from camwright import load_job
design = camwright.optimise if hasattr(camwright, "optimise") else camwright.design
job = load_job(sys.argv[1])
for _ in sys.stdin:
    begun = time.process_time()
    found = design(job)
    print(json.dumps({"seconds": time.process_time() - begun, "value": float(found.objective)}), flush=True)
"""
"""Designs the job once for each line that it is sent."""

Changes = Mapping[str, str | None]


@dataclass(frozen=True)
class Cousin:
    """An example with other values; None takes a key away, or a whole table.

    Parameters
    ----------
    name
        What is another.
    of
        The example.
    changes
        Values as a job file writes them, by ``table.key`` or ``[table]``.
    same
        Whether both versions solve the same problem.
    """

    name: str
    of: str
    changes: Changes
    same: bool = True


def _crank(name: str, **changes: str) -> Cousin:
    """Chasing shear with other values, by ``table__key``."""
    return Cousin(f"crank {name}", "chasing-shear", {key.replace("__", "."): value for key, value in changes.items()})


def _aware(name: str, changes: Changes) -> Cousin:
    return Cousin(f"aware {name}", "short-cut", changes, same=False)


COUSINS = (
    *(_crank(f"{length} mm", cut__length=f'"{length} mm"') for length in (700, 800, 1000, 1200, 1500, 2000, 2500)),
    *(_crank(f"{speed} m/min", cut__line_speed=f'"{speed} m/min"') for speed in (10, 20, 40)),
    _crank("longer zone", cut__sync_zone='"180 mm"'),
    _crank("shorter zone", cut__sync_zone='"120 mm"'),
    _crank("shorter rod", machine__rod='"450 mm"'),
    _crank("heavier", machine__carriage_mass='"120 kg"'),
    _crank("place 90 deg", machine__sync_at='"90 deg"'),
    _crank("place 105 deg", machine__sync_at='"105 deg"'),
    *(
        _crank(name.replace("_", " "), objective__minimise=f'"{name}"')
        for name in ("peak_torque", "energy", "rms_acceleration", "peak_acceleration")
    ),
    _crank("energy 1500 mm", cut__length='"1500 mm"', objective__minimise='"energy"'),
    _crank("peak torque 700 mm", cut__length='"700 mm"', objective__minimise='"peak_torque"'),
    _aware("290 mm", {"cut.length": '"290 mm"'}),
    _aware("320 mm", {"cut.length": '"320 mm"'}),
    _aware("peak acceleration", {"cut.length": '"290 mm"', "objective.minimise": '"peak_acceleration"'}),
    _aware("RMS acceleration", {"cut.length": '"290 mm"', "objective.minimise": '"rms_acceleration"'}),
    _aware("no ranges", {"[servo.tolerance]": None}),
    _aware("no ranges 240 mm", {"cut.length": '"240 mm"', "[servo.tolerance]": None}),
    _aware("ranges 5 %", {"servo.tolerance.bandwidth": '"5 %"', "servo.tolerance.damping": '"5 %"'}),
    _aware("range of sample time", {"servo.tolerance.sample_time": '"5 %"'}),
    _aware("other limits", {"limits.acceleration": '"60 m/s^2"', "limits.jerk": '"10000 m/s^3"'}),
    _aware("in sync", {"cut.length": '"290 mm"', "objective.command": '"in_sync"'}),
)


def written(text: str, changes: Changes) -> str:
    """Job file with other values; what it lacks is added to its table.

    Raises ``SystemExit`` where the file does not say afterwards what it was to say.
    """
    kept, table, left = [], "", dict(changes)
    for line in text.splitlines():
        if line.startswith("["):
            kept += _added(table, left)
            table = line.split("]")[0].strip("[")
        key = f"{table}.{line.split('=')[0].strip()}" if "=" in line and not line.startswith("#") else ""
        if f"[{table}]" in changes:
            continue
        if key not in left:
            kept.append(line)
        elif (value := left.pop(key)) is not None:
            kept.append(f"{key.rpartition('.')[2]} = {value}")
    found = "\n".join([*kept, *_added(table, left), ""])
    said = tomllib.loads(found)
    for place, value in changes.items():
        if _at(said, place.strip("[]")) != (None if value is None else tomllib.loads(f"it = {value}")["it"]):
            raise SystemExit(f"{place} = {value} did not go into the job file")
    return found


def _added(table: str, left: dict[str, str | None]) -> list[str]:
    """Lines of a table's keys that were not met in it; they are taken from what is left."""
    own = [key for key in left if key.rpartition(".")[0] == table and table]
    return [f"{key.rpartition('.')[2]} = {value}" for key in own if (value := left.pop(key)) is not None]


def _at(said: dict[str, Any], place: str) -> Any:
    """Give what a file says at a place; None where it says nothing."""
    found: Any = said
    for part in place.split("."):
        found = found.get(part, {})
    return found if found != {} else None


def beside(cousin: Cousin, codes: tuple[Path, Path], kept: str, runs: int) -> dict[str, Any]:
    """Row of a job: both versions in turn, once to begin with and as often as is told."""
    with tempfile.TemporaryDirectory() as directory:
        job = Path(directory) / "job.toml"
        example = codes[0] / "examples" / f"{cousin.of}.toml"
        job.write_text(written(example.read_text(encoding="utf-8"), cousin.changes), encoding="utf-8")
        command = [sys.executable, "-c", ASKED, str(job)]
        sides = [
            subprocess.Popen(
                command,
                cwd=directory,
                env=environment(code, kept),
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                text=True,
            )
            for code in codes
        ]
        try:
            other, own = _in_turn(sides, runs)
        finally:
            for side in sides:
                side.communicate()
    good = not cousin.same or own[-1]["value"] <= other[-1]["value"] * (1 + WORSE)
    times = (min(each["seconds"] for each in of[1:]) for of in (other, own))
    values = {"other_value": other[-1]["value"], "own_value": own[-1]["value"], "same_problem": int(cousin.same)}
    return row(cousin.name, *times, good) | values


def _in_turn(sides: list[subprocess.Popen[str]], runs: int) -> tuple[list[Any], list[Any]]:
    """Answers of both processes, the first of which are not warm."""
    answers: tuple[list[Any], list[Any]] = ([], [])
    for _ in range(runs + 1):
        for side, found in zip(sides, answers, strict=True):
            assert side.stdin is not None  # noqa: S101 - both are pipes
            assert side.stdout is not None  # noqa: S101
            side.stdin.write("again\n")
            side.stdin.flush()
            said = side.stdout.readline()
            if not said:
                raise SystemExit(f"{side.args[-1]} was not designed")  # type: ignore[index]
            found.append(json.loads(said))
    return answers


def main() -> int:
    """Run, judge, write, print; the exit code tells whether the promise is kept."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("other", type=Path, help="folder with the checkout of the other version")
    parser.add_argument("--runs", type=int, default=2)
    parser.add_argument("--only", default="", help="jobs whose name has this in it; writes no file")
    options = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as kept:
        for cousin in (each for each in COUSINS if options.only in each.name):
            found = beside(cousin, (options.other.resolve(), ROOT), kept, options.runs)
            rows.append(found)
            print(
                f"{found['what']}: {found['other_s']:.3f} to {found['own_s']:.3f} s, {found['ratio']:.2f}; "
                f"{found['other_value']:.6g} to {found['own_value']:.6g}" + ("" if found["good"] else ": NOT GOOD"),
                flush=True,
            )
    ratios = sorted(found["ratio"] for found in rows)
    print(f"{len(rows)} jobs, {ratios[0]:.2f} to {ratios[-1]:.2f}, median {statistics.median(ratios):.2f}")
    if not options.only:
        with (RESULTS / "beside_cousins.csv").open("w", newline="", encoding="utf-8") as file:
            table = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
            table.writeheader()
            table.writerows(
                {name: f"{value:.6g}" if isinstance(value, float) else value for name, value in each.items()}
                for each in rows
            )
    return 0 if all(found["good"] and found["ratio"] <= 1.0 for found in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
