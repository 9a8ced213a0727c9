"""A watch on IPOPT's multipliers: a programme whose limits cannot be met is ended when they run away.

IPOPT itself looks at its unknowns only. Where a peak is asked for that the mesh cannot reach its multipliers grow without end, the
factorisations then put off one pivot after the other and each takes seconds: minutes on a knife with friction and a cut of ten pitches.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

import casadi as ca
import numpy as np

MOST_MULTIPLIER = 1e12
"""Multiplier (scaled) beyond which a programme is held to have no answer."""
MOST_AT_FIRST = 1e9
"""The same for a first look, which has other starts: on the way to there a factorisation takes a minute where limits leave no room."""


@dataclass(frozen=True, eq=False)
class WatchedSolver:
    """IPOPT for a programme, and the watch that it needs as long as it lives."""

    solver: ca.Function
    watch: MultiplierWatch

    @classmethod
    def of(cls, name: str, nlp: dict[str, Any], options: dict[str, Any]) -> Self:
        """Build the solver of a programme, as `casadi.nlpsol` does."""
        watch = MultiplierWatch(nlp["x"].numel(), nlp["g"].numel(), nlp["p"].numel())
        return cls(ca.nlpsol(name, "ipopt", nlp, options | {"iteration_callback": watch}), watch)


class MultiplierWatch(ca.Callback):
    """What IPOPT asks after every iteration whether to go on; as long as a solver uses it, it must be kept."""

    def __init__(self, unknowns: int, rows: int, parameters: int) -> None:
        """Make the watch of a programme of so many unknowns, constraints and parameters."""
        ca.Callback.__init__(self)
        self.most = MOST_MULTIPLIER
        self._sizes = {"x": unknowns, "f": 1, "g": rows, "lam_x": unknowns, "lam_g": rows, "lam_p": parameters}
        self.construct("multiplier_watch", {})
        self._multipliers = int(self.index_in("lam_g"))

    def get_n_in(self) -> int:
        """Count what the solver hands over: its outputs."""
        return int(ca.nlpsol_n_out())

    def get_n_out(self) -> int:
        """Count the answers: whether to end."""
        return 1

    def get_name_in(self, number: int) -> str:
        """Name an input."""
        return str(ca.nlpsol_out(number))

    def get_sparsity_in(self, number: int) -> ca.Sparsity:
        """Give the shape of an input."""
        return ca.Sparsity.dense(self._sizes[ca.nlpsol_out(number)])

    def has_eval_buffer(self) -> bool:
        """Ask for the numbers where they lie: to make matrices of all of them every iteration takes longer than many a step."""
        return True

    def eval_buffer(self, given: Sequence[memoryview], answers: Sequence[memoryview]) -> int:
        """Tell whether to end: where a multiplier of a constraint has run away."""
        multipliers = np.frombuffer(given[self._multipliers])
        np.frombuffer(answers[0])[0] = not np.abs(multipliers).max(initial=0.0) < self.most
        return 0
