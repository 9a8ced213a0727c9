"""The object that ``--json`` prints when a command fails."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from camwright.profiles.errors import CamwrightError, InfeasibleError


def error_answer(exit_code: int, message: str, failure: CamwrightError | None) -> dict[str, Any]:
    """Answer of a command that failed; what is infeasible says what binds, by how much, and what would work."""
    answer: dict[str, Any] = {"status": "error", "exit_code": exit_code, "message": message}
    if isinstance(failure, InfeasibleError):
        answer["status"] = "infeasible"
        answer |= {"binding": failure.binding, "excess": {"value": failure.excess, "unit": failure.unit}}
        answer["suggestions"] = [asdict(suggestion) for suggestion in failure.suggestions]
        answer["line_speeds_kept_m_per_s"] = None if failure.kept is None else list(failure.kept)
        answer["family_bands_m_per_s"] = None if failure.bands is None else [list(band) for band in failure.bands]
    return answer
