"""Finds the profile: job to problem to programme to IPOPT to profile. The only package that knows CasADi."""

from design.feasibility import is_feasible, require_feasible
from design.ipopt import SolveStatus
from design.optimise import OBJECTIVES, Objective, Solution, solve

__all__ = ["OBJECTIVES", "Objective", "Solution", "SolveStatus", "is_feasible", "require_feasible", "solve"]
