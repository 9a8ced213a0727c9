"""The object that ``camwright trace --json`` prints."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from camwright.answers.measures import checks_answer, millimetres
from camwright.studies.recording import RecordedRun
from camwright.validation.recording.offset_drift_scatter import Errors


def trace_answer(found: RecordedRun, path: Path, files: Sequence[Path]) -> dict[str, Any]:
    """Answer of ``camwright trace``."""
    run = found.run
    return {
        "job": found.job.name,
        "file": str(path),
        "notes": list(found.notes),
        "rows": len(run.times),
        "master": "reconstructed" if run.reconstructed else "recorded",
        "master_shift_mm": run.master_shift * 1e3,
        "line_speed_m_per_s": run.line_speed,
        "lag_ms": millimetres(run.zeros.lag),
        "cuts": [
            {
                "number": cut.number,
                "time_s": cut.time,
                "line_speed_m_per_s": cut.line_speed,
                "sync_error_mm": cut.error * 1e3,
                "greatest_mm": cut.greatest * 1e3,
                "command_mm": cut.command * 1e3,
                "axis_mm": cut.axis * 1e3,
                "length_mm": millimetres(cut.length),
            }
            for cut in found.cuts
        ],
        "errors": {name: _errors(getattr(found, name)) for name in ("total", "command", "axis")},
        "expected": None
        if found.expected is None
        else {"offset_mm": -1e3 * found.expected.offset, "range_mm": 1e3 * found.expected.variation},
        "kind": found.kind,
        "causes": list(found.causes),
        "checks": checks_answer(found.checks),
        "passed": found.passed,
        "files": [str(file) for file in files],
    }


def _errors(errors: Errors) -> dict[str, Any]:
    """Errors told apart, in mm and ms."""
    return {
        "offset_mm": errors.offset * 1e3,
        "drift_mm_per_cut": millimetres(errors.drift),
        "drift_interval_mm_per_cut": _interval(errors.drift_interval),
        "lag_ms": millimetres(errors.lag),
        "lag_interval_ms": _interval(errors.lag_interval),
        "scatter_mm": millimetres(errors.scatter),
        "range_mm": millimetres(errors.range),
    }


def _interval(bounds: tuple[float, float] | None) -> list[float] | None:
    return None if bounds is None else [1e3 * bound for bound in bounds]
