"""A small function at many places: each of its steps once for all of them.

CasADi evaluates a mapped function place by place, and each step of each place goes through its interpreter. Taken as steps on columns, a
number for each place, a step goes through it once: a tenth of the time, with the same numbers.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca


@dataclass(frozen=True, eq=False)
class Steps:
    """A function in scalar symbols, as steps.

    Parameters
    ----------
    asked
        What it is a function of, columns of symbols (`casadi.SX`).
    told
        What it tells, dense columns of expressions.
    """

    asked: list[Any]
    told: list[Any]

    @cached_property
    def _function(self) -> Any:
        return ca.Function("steps", self.asked, self.told)

    @cached_property
    def _listed(self) -> list[tuple[int, list[int], list[int], float]]:
        """Operation of each step, where it takes from, where it puts to, and a constant's value."""
        own = self._function
        listed = []
        for k in range(own.n_instructions()):
            operation = int(own.instruction_id(k))
            constant = float(own.instruction_constant(k)) if operation == ca.OP_CONST else 0.0
            listed.append((operation, own.instruction_input(k), own.instruction_output(k), constant))
        return listed

    def at(self, count: int, given: list[list[Any]]) -> list[list[Any]]:
        """Evaluate it at a number of places.

        Parameters
        ----------
        count
            Number of places.
        given
            For each of what is asked its rows, each a column of a number for each place or one for all (`casadi.MX`).

        Returns
        -------
        list
            For each of what is told its rows, columns of a number for each place.
        """
        held: dict[int, Any] = {}
        told: list[list[Any]] = [[None] * column.numel() for column in self.told]
        for operation, takes, puts, constant in self._listed:
            if operation == ca.OP_OUTPUT:
                told[puts[0]][puts[1]] = held[takes[0]]
            elif operation == ca.OP_INPUT:
                held[puts[0]] = given[takes[0]][takes[1]]
            elif operation == ca.OP_CONST:
                held[puts[0]] = ca.MX(constant)
            elif len(takes) == 1:
                held[puts[0]] = ca.MX.unary(operation, held[takes[0]])
            else:
                held[puts[0]] = ca.MX.binary(operation, held[takes[0]], held[takes[1]])
        return [[_for_all(row, count) for row in rows] for rows in told]


def _for_all(row: Any, count: int) -> Any:
    """Column of a number for each place, also of what is the same at all."""
    return row if row.numel() == count else ca.repmat(row, count, 1)
