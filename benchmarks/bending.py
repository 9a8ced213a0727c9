"""Time and memory of ``camwright bend`` on a drawing of 10 000 segments, figures and sheet included.

Before the figures count, the program that was written must hold as many bends as the answer says, the bent rule must lie within
chord error + 5 µm of the drawing, and figures and sheet must be there. The measure is processor time of the whole cold process,
so that other programs on the machine do not count: the least of some runs, after one that is not counted. Prints one CSV row a
measure, and ends with 1 if a promise is not kept:

    python benchmarks/bending.py [--runs 3]
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import ezdxf

ROWS, UNITS = 100, 49
"""Rows of the meander, and pairs of a line and an arc in a row; two more segments lead to the next row."""


def meander() -> list[tuple[float, float, float]]:
    """Vertices and bulges of a line of ``ROWS * (2 * UNITS + 2)`` segments that does not cross itself (mm)."""
    vertices: list[tuple[float, float, float]] = []
    for row in range(ROWS):
        y, ahead = 6.0 * row, 1.0 if row % 2 == 0 else -1.0
        x = 0.0 if ahead > 0 else 4.0 * UNITS
        for unit in range(UNITS):
            bulge = 0.5 if unit % 2 else -0.5
            vertices += [(x, y, 0.0), (x + 2 * ahead, y, bulge)]
            x += 4 * ahead
        vertices += [(x, y, 0.0), (x + 2 * ahead, y + 3, 0.0)]
    x, y, _ = vertices[-1]
    return [*vertices, (x, y + 10, 0.0)]


MOST_TIME, MOST_MEMORY = 5.0, 300.0
"""Processor time (s) and peak memory (MB) that the project promises."""


def bend(drawing: Path, out: Path) -> tuple[dict[str, Any], float, float, float]:
    """Run the command: its answer, processor time (s), wall time (s), peak memory (MB)."""
    run = "import sys; from camwright.cli.main import main; sys.exit(main())"
    command = [sys.executable, "-c", run, "bend", str(drawing), "--out", str(out), "--json"]
    start = time.perf_counter()
    with (out.parent / "answer.json").open("w+", encoding="utf-8") as said:
        process = subprocess.Popen(command, stdout=said)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        said.seek(0)
        text = said.read()
    if process.returncode != 0:
        raise SystemExit(f"the command ended with {process.returncode}")
    took = time.perf_counter() - start
    return json.loads(text), usage.ru_utime + usage.ru_stime, took, usage.ru_maxrss / 1024


def require_sound(answer: dict[str, Any], out: Path) -> None:
    """End the benchmark if the command did not do its work."""
    lines = Path(answer["program"]).read_text(encoding="ascii").splitlines()
    bends = sum(1 for line in lines if " G90 Y" in line and not line.endswith(" Y0.0"))
    names = {file.name for file in out.iterdir()}
    wanted = {f"meander-{kind}.{end}" for kind in ("proof", "times") for end in ("svg", "png")} | {
        "sheet.pdf",
        "sheet.html",
    }
    near = answer["deviation_mm"] <= answer["chord_error_mm"] + 0.005
    if not (answer["passed"] and near and bends == answer["bends"] and wanted <= names):
        raise SystemExit("the program is not what was promised")


def main() -> int:
    """Measure, print, judge."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=3)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        drawing, out = Path(folder) / "meander.dxf", Path(folder) / "out"
        document = ezdxf.new("R2000", units=4)  # type: ignore[attr-defined]
        document.modelspace().add_lwpolyline(meander(), format="xyb")
        document.saveas(drawing)
        runs = []
        for _ in range(options.runs + 1):
            answer, *measures = bend(drawing, out)
            require_sound(answer, out)
            runs.append(measures)
    processor, wall, memory = (min(column) for column in zip(*runs[1:], strict=True))
    print("measure,value,limit")
    print(f"segments,{len(meander()) - 1},")
    print(f"bends,{answer['bends']},")
    print(f"deviation_mm,{answer['deviation_mm']:.4f},{answer['chord_error_mm'] + 0.005:.4f}")
    print(f"processor_s,{processor:.2f},{MOST_TIME:g}")
    print(f"wall_s,{wall:.2f},")
    print(f"peak_memory_mb,{memory:.0f},{MOST_MEMORY:g}")
    print(f"cycle_s,{answer['cycle_time_s']:.1f},")
    print(f"sequential_cycle_s,{answer['baseline_cycle_time_s']:.1f},")
    return 0 if processor < MOST_TIME and memory < MOST_MEMORY else 1


if __name__ == "__main__":
    sys.exit(main())
