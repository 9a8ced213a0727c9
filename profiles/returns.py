"""The published returns as baselines, and how a return and a sync zone make a cycle."""

from __future__ import annotations

from profiles.cycle import Cut
from profiles.errors import InputError
from profiles.laws import LAWS, law
from profiles.machines import RotaryKnife
from profiles.polynomial import CamProfile, join

BASELINES: tuple[str, ...] = ("linear_return", *(name for name in LAWS if name != "linear"))
"""Names of all baselines: the linear return of S1 and every law of the table, placed as a return."""


def place_law(name: str, length: float, height: float, ratio: float = 1.0) -> CamProfile:
    """Place a motion law as a return that leaves and meets the sync zone at the same ratio.

    The return is the straight line of that ratio plus the law, which makes up for what the line would miss::

        y(x) = ratio * x + (height - ratio * length) * s(x / length)

    With the law ``linear`` this is the linear return of S1, of the constant ratio ``height / length``.

    Parameters
    ----------
    name
        Name of the law in `profiles.laws.LAWS`.
    length
        Length of the return zone on the master (m).
    height
        Slave travel in the return zone (slave unit).
    ratio
        Ratio at both ends of the sync zone (slave unit per m).
    """
    correction = height - ratio * length
    placed = law(name).scale(master=length, slave=correction).add_line(ratio)
    breaks = placed.breaks.copy()
    breaks[-1] = length  # the law ends at 1 exactly, its image at the length but for rounding
    return CamProfile(breaks, placed.coefficients.copy())


def baseline(name: str, machine: RotaryKnife, cut: Cut) -> CamProfile:
    """One cycle of a baseline: its return and the machine's sync zone, with the origin that the cut states.

    Raises
    ------
    InputError
        There is no such baseline.
    """
    if name not in BASELINES:
        raise InputError(f"there is no baseline {name!r}; the baselines are {', '.join(BASELINES)}")
    height = machine.pitch - machine.sync_profile(cut).advance
    back = place_law("linear" if name == "linear_return" else name, cut.return_zone, height)
    return assemble(back, machine, cut)


def assemble(back: CamProfile, machine: RotaryKnife, cut: Cut) -> CamProfile:
    """Make one cycle over the master period ``[0, x_c]`` from a return over ``[0, x_c - l_s]`` and the machine's sync zone.

    The cycle starts at slave zero. With the origin at the cut it starts at mid sync zone, and the sync zone is split.
    """
    sync = machine.sync_profile(cut)
    height = machine.pitch - sync.advance
    cycle = join(back, sync.shift(back.end - sync.start, height - float(sync(sync.start))))
    breaks = cycle.breaks.copy()
    breaks[-1] = cut.length
    cycle = CamProfile(breaks, cycle.coefficients.copy())
    return cycle if cut.origin == "return" else cycle.roll(cut.length - 0.5 * cut.sync_zone)
