"""The object that ``camwright compare --json`` prints."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from camwright.answers.measures import profiles_answer
from camwright.studies.comparison import Comparison


def compare_answer(comparison: Comparison, files: Sequence[Path]) -> dict[str, Any]:
    """Answer of ``camwright compare``: the profiles sorted by the job's objective, those that break a limit last."""
    return {
        "job": comparison.job.name,
        "sorted_by": comparison.job.objective,
        "profiles": profiles_answer(comparison),
        "files": [str(file) for file in files],
    }
