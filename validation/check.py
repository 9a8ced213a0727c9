"""`Check`: one judgement on a profile."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Check:
    """One judgement: a quantity, what it may be, and where it is worst.

    A check with a value and a limit passes when the value does not exceed the limit, the named allowance for rounding
    apart.

    Parameters
    ----------
    name
        Name of the check, words joined by underscores.
    passed
        Whether the profile passed.
    value
        What was found (SI), ``None`` where it is unbounded or does not exist.
    limit
        What is allowed (SI), ``None`` where the value only has to exist.
    unit
        SI unit of value and limit, ``"1"`` for a pure number.
    at
        Master position in the cycle where the value is reached (m), ``None`` where it belongs to no one position.
    source
        Equation or rule that the check stands for.
    """

    name: str
    passed: bool
    value: float | None
    limit: float | None
    unit: str
    at: float | None
    source: str

    @classmethod
    def at_most(
        cls, name: str, value: float, limit: float, unit: str, source: str, at: float | None = None, room: float = 0.0
    ) -> Check:
        """Judge a value that must not exceed a limit by more than some room for rounding."""
        return cls(name, value <= limit + room, value, limit, unit, at, source)
