"""Finds the profile: job to problem to programme to IPOPT to profile. The only package that knows CasADi."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from design.feasibility import is_feasible
    from design.ipopt import SolveStatus
    from design.optimise import OBJECTIVES, Objective, Solution, solve
    from design.refusal import require_feasible

__all__ = ["OBJECTIVES", "Objective", "Solution", "SolveStatus", "is_feasible", "require_feasible", "solve"]

_HOMES = {
    "is_feasible": "feasibility",
    "require_feasible": "refusal",
    "SolveStatus": "ipopt",
    "OBJECTIVES": "optimise",
    "Objective": "optimise",
    "Solution": "optimise",
    "solve": "optimise",
}


def __getattr__(name: str) -> Any:
    """Import what is asked for when it is asked for: a command that only needs the moves of a bender must not wait for CasADi."""
    from importlib import import_module

    if name not in _HOMES:
        raise AttributeError(f"module 'design' has no attribute {name!r}")
    return getattr(import_module(f"design.{_HOMES[name]}"), name)
