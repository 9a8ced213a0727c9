"""Names of profiles in words, and the parts of zones."""

from __future__ import annotations

from collections.abc import Iterable

from camwright.profiles.cut import Cut
from camwright.profiles.laws import LAWS
from camwright.studies.measured import Measured

_TITLES = {
    "linear_return": "linear return",
    "quintic": "quintic with standstill",
    "crank_tabulated": "tabulated crank",
    "screw_carriage": "screw-driven carriage",
}


def title(name: str) -> str:
    """Write the name of a profile in words."""
    return LAWS[name].title if name in LAWS else _TITLES.get(name, name)


def marked(row: Measured) -> str:
    """Write the name of a measured profile, marked if it breaks a limit of the job."""
    return title(row.name) if row.within_limits else f"{title(row.name)} †"


def broken_note(rows: Iterable[Measured]) -> str:
    """Say what the mark means, where a profile has it: a last line of a heading."""
    return "" if all(row.within_limits for row in rows) else "\n† breaks a limit of the job"


def zone_parts(cut: Cut, start: float, length: float) -> list[tuple[float, float]]:
    """Give a zone as parts of the period ``[0, x_c]``: two where it goes over the seam.

    Parameters
    ----------
    start
        Master position at which the zone begins (m), of any cycle.
    length
        Length of the zone (m).
    """
    first = start % cut.length
    last = first + length
    return [(first, last)] if last <= cut.length * (1 + 1e-12) else [(first, cut.length), (0.0, last - cut.length)]
