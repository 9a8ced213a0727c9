"""Programmes ready for IPOPT, kept once built, and what its answers mean."""

from __future__ import annotations

from enum import Enum
from functools import lru_cache
from typing import Any

from camwright.design.returns.transcription import Programme, Shape

# An answer is one that meets the tolerances, not one that nearly does. CasADi's own remarks on a try that cannot succeed (arcs held on
# limits that leave nothing to choose, a value that is no number) are for its status, not for standard error.
QUIET: dict[str, Any] = {
    "print_time": False,
    "show_eval_warnings": False,
    "inputs_check": False,
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "ipopt.acceptable_iter": 0,
    # nobody asks for multipliers of parameters, whose function takes a quarter of the time to build a programme and a tenth of a solution's
    "calc_lam_p": False,
    "no_nlp_grad": True,
    # multipliers of what is held fixed, which nobody asks for, cost another gradient an iteration
    "ipopt.fixed_variable_treatment": "make_parameter_nodual",
}

# A first look on the grid: convex, so any start will do; it need not be more exact than the grid.
_GRID = {
    "ipopt.mu_strategy": "adaptive",
    "ipopt.tol": 1e-8,
    "ipopt.constr_viol_tol": 1e-10,
    "ipopt.bound_relax_factor": 1e-12,
    "ipopt.max_iter": 100,
}

# The polish starts close to the answer, so it must not be pushed away from active limits; limits are hard.
_POLISH = {
    "ipopt.tol": 1e-11,
    "ipopt.constr_viol_tol": 1e-12,
    "ipopt.dual_inf_tol": 1e-6,
    "ipopt.compl_inf_tol": 1e-11,
    "ipopt.bound_relax_factor": 0.0,
    "ipopt.mu_init": 1e-5,
    "ipopt.bound_push": 1e-8,
    "ipopt.bound_frac": 1e-8,
    "ipopt.slack_bound_push": 1e-8,
    "ipopt.slack_bound_frac": 1e-8,
    "ipopt.max_iter": 120,
}


# With the right arcs a polish with limits at the nodes alone takes less than ten iterations; a limit that is all but touched, forty.
_FIRST_TRY = _POLISH | {"ipopt.max_iter": 60}

# A start known in closed form is the answer but for the margin of the limits: a few steps confirm it.
_CONFIRM = _POLISH | {"ipopt.mu_init": 1e-9, "ipopt.max_iter": 50}


class SolveStatus(Enum):
    """How a design ended, with advice."""

    OPTIMAL = "optimal"
    BEST_FOUND = "best_found"

    @property
    def advice(self) -> str:
        """What the reader of a result should know or do."""
        return {
            SolveStatus.OPTIMAL: "optimal, its pieces polished to the solver's accuracy",
            SolveStatus.BEST_FOUND: "the best that was found, not proved to be the best there is: look at the stated gap and at the starts",
        }[self]


@lru_cache(maxsize=64)
def programme(shape: Shape, known: bool = False) -> Programme:
    """Build the programme of a shape, or take the one built before.

    Parameters
    ----------
    shape
        What decides its form.
    known
        Whether its start will be an answer known in closed form.
    """
    polish = _FIRST_TRY if shape.at_nodes else _POLISH
    return Programme(shape, QUIET | (_CONFIRM if known else polish if shape.free_lengths else _GRID))
