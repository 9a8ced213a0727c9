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
        answer["line_speeds_kept_m_per_s"] = _listed(failure.covered.part)
        answer["family_bands_m_per_s"] = _listed(failure.covered.family)
    return answer


def _listed(band: tuple[Any, ...] | None) -> list[Any] | None:
    """Put a band, or several, as JSON has them."""
    return None if band is None else [list(each) if isinstance(each, tuple) else each for each in band]
