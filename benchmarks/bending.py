"""Time and memory of ``camwright bend`` on a drawing of 10 000 segments, figures and sheet included.

Run it with ``python benchmarks/bending.py``. The limits of the project are 5 s and 300 MB.
"""

from __future__ import annotations

import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

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


def main() -> None:
    """Measure and print."""
    with tempfile.TemporaryDirectory() as folder:
        drawing = Path(folder) / "meander.dxf"
        document = ezdxf.new("R2000", units=4)
        document.modelspace().add_lwpolyline(meander(), format="xyb")
        document.saveas(drawing)
        run = "import sys; from camwright.cli import main; sys.exit(main())"
        command = [sys.executable, "-c", run, "bend", str(drawing), "--out", folder + "/out", "--json"]
        start = time.perf_counter()
        answer = json.loads(subprocess.run(command, stdout=subprocess.PIPE, check=True).stdout)
        usage = resource.getrusage(resource.RUSAGE_CHILDREN)
        took = time.perf_counter() - start
        print(f"segments          {len(meander()) - 1}")
        print(f"bends             {answer['bends']}")
        print(f"deviation         {answer['deviation_mm']:.4f} mm, chord error {answer['chord_error_mm']:.4f} mm")
        print(f"time              {took:.2f} s wall, {usage.ru_utime + usage.ru_stime:.2f} s CPU (limit 5 s)")
        print(f"peak memory       {usage.ru_maxrss / 1024:.0f} MB (limit 300 MB)")
        print(
            f"cycle time        {answer['cycle_time_s']:.1f} s, sequential trapezoids {answer['baseline_cycle_time_s']:.1f} s"
        )


if __name__ == "__main__":
    main()
