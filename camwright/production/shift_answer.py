"""What ``camwright simulate --json`` prints, and the table of pieces."""

from __future__ import annotations

from typing import Any

import numpy as np

from camwright.house.provenance import camwright_version
from camwright.production.simulation import MOTIONS, MotionRuns, ShiftStudy
from camwright.profiles.polynomial.profile import FloatArray

PIECES_HEADER = "piece,asked [mm],time [s],line speed [m/min]," + ",".join(
    f"{motion} length [mm],{motion} sync error [mm]" for motion in MOTIONS
)


def shift_answer(study: ShiftStudy) -> dict[str, Any]:
    """Answer of ``camwright simulate``."""
    planned, wrong = study.planned, study.disturbances
    tolerance = planned.job.cut.sync_tolerance
    return {
        "job": planned.job.name,
        "pieces": planned.asked.pieces,
        "material_m": float(study.lengths.sum()),
        "time_s": float(study.cut_times[-1]),
        "line": "given" if study.given else "planned",
        "pieces_too_fast": study.too_fast,
        "pieces_ramped_too_hard": study.too_hard,
        "servos": study.servos,
        "sync_tolerance_m": tolerance,
        "disturbances": {"noise_m": wrong.noise, "slip": wrong.slip, "marks_m": wrong.marks, "seed": wrong.seed},
        **{motion: _motion(run, tolerance) for motion, run in study.runs.items()},
        "histogram": {
            "edges_m": study.edges.tolist(),
            **{motion: [int(count) for count in study.histogram(motion)] for motion in MOTIONS},
        },
    }


def _motion(run: MotionRuns, tolerance: float) -> dict[str, Any]:
    """Measures of one motion."""
    return {
        "length_error_m": _spread(run.length_errors),
        "sync_error_m": _spread(run.nominal.sync_errors),
        "pieces_outside_tolerance": run.outside(tolerance),
        "worst_piece": int(run.nominal.sync_errors.argmax()) + 1,
        "all_servos": {
            "length_error_m": float(run.worst_length_errors.max()),
            "sync_error_m": float(run.worst_sync_errors.max()),
            "pieces_outside_tolerance": int((run.worst_sync_errors > tolerance).sum()),
        },
    }


def _spread(values: FloatArray) -> dict[str, float]:
    """Mean, standard deviation, and the greatest magnitude, of all and of all but one in a hundred."""
    size = np.abs(values)
    return {
        "mean": float(values.mean()),
        "deviation": float(values.std()),
        "of_99_percent": float(np.quantile(size, 0.99)),
        "worst": float(size.max()),
    }


def pieces_text(study: ShiftStudy) -> str:
    """Write the table of pieces, with the job's own servo."""
    job = study.planned.job
    speeds = study.planned.line.speed(study.cut_times) * 60
    columns = [np.arange(1, len(study.lengths) + 1), study.lengths * 1e3, study.cut_times, speeds]
    for motion in MOTIONS:
        run = study.runs[motion].nominal
        columns += [run.lengths * 1e3, run.sync_errors * 1e3]
    lines = [f"# camwright {camwright_version()}: {job.name}", f"# job SHA-256: {job.sha256}", PIECES_HEADER]
    lines += [
        ",".join([str(int(row[0])), *(f"{value:.9g}" for value in row[1:])])
        for row in np.column_stack(columns).tolist()
    ]
    return "\n".join(lines) + "\n"
