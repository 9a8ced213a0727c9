"""Measures the export: time of all targets for one design, and the error of Logix tables over the number of points."""

from __future__ import annotations

import time

from camwright import load_job
from camwright.export import export
from profiles.returns import baseline
from profiles.tables.cam_table import Unit, Units
from profiles.tables.knots import Accuracy, choose
from profiles.tables.targets import TARGETS


def main() -> None:
    """Print both measurements."""
    job = load_job()
    profile = baseline("double_s", job.machine, job.cut)
    begin, used = time.perf_counter(), time.process_time()
    results = export(profile, job, list(TARGETS), force=True)
    print(
        f"all {len(results)} targets: {time.perf_counter() - begin:.2f} s, "
        f"of the processor {time.process_time() - used:.2f} s"
    )
    smooth = baseline("poly_3_4_5", job.machine, job.cut)
    units = Units(Unit("mm", 1e-3), Unit("deg", job.machine.pitch / 360))
    for points in (20, 35, 60, 100, 180, 360, 1001):
        found = choose(smooth, TARGETS["logix"], units, Accuracy(), points).deviation
        print(
            f"logix, {points:5d} points: position {found.position * 1e6:9.3g} um, acceleration {found.acceleration:.3%}"
        )


if __name__ == "__main__":
    main()
