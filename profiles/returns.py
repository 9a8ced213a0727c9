"""The published returns as baselines, and how a return and a sync zone make a cycle."""

from __future__ import annotations

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.laws import LAWS, law
from camwright.profiles.polynomial.profile import CamProfile, join
from camwright.profiles.polynomial.rows import ascending
from camwright.profiles.task import Task

BASELINES: tuple[str, ...] = ("linear_return", *(name for name in LAWS if name != "linear"))
"""Names of all baselines: the linear return of S1 and every law of the table, placed as a return."""


def law_return(name: str, length: float, height: float, ratio: float = 1.0) -> CamProfile:
    """Place a motion law as a return that leaves and meets the sync zone at the same ratio.

    The return is the straight line of that ratio plus the law, which makes up for what the line would miss::

        y(x) = ratio * x + (height - ratio * length) * s(x / length)

    With the law ``linear`` this is the linear return of S1, of the constant ratio ``height / length``.

    Parameters
    ----------
    name
        Name of the law in `camwright.profiles.laws.LAWS`.
    length
        Length of the return zone on the master (m).
    height
        Slave travel in the return zone (slave unit).
    ratio
        Ratio at both ends of the sync zone (slave unit per m).
    """
    correction = height - ratio * length
    return law(name).scale(master=length, slave=correction).add_line(ratio).over(0.0, length)


def baseline_names(task: Task) -> tuple[str, ...]:
    """Names of the baselines that a machine can have.

    Laws are defined for returns between two sync zones of the same constant ratio; where the ratio changes in the sync zone there are the
    linear return, the quintic between the zone's ends, and what the machine has of its own.
    """
    if task.straight:
        return BASELINES
    return ("linear_return", "poly_3_4_5", *task.machine.own_baselines)


def baseline(name: str, task: Task) -> CamProfile:
    """One cycle of a baseline: its return and the machine's sync zone, with the origin that the cut states.

    Raises
    ------
    InputError
        There is no such baseline for this machine.

    Examples
    --------
    >>> from camwright import baseline, load_job
    >>> job = load_job()
    >>> round(baseline("poly_3_4_5", job.task).extrema(1)[0].value, 9)     # 1 - 15/8 of 1 - 0.2/0.4
    0.0625
    """
    cut = task.cut
    if name not in baseline_names(task):
        raise InputError(
            f"there is no baseline {name!r} for this machine; the baselines are {', '.join(baseline_names(task))}"
        )
    sync, height = task.sync, task.height
    if name == "crank_tabulated":
        quintic = assemble(quintic_between(sync, cut.return_zone, height), task.from_return())
        table = tabulate_crank(quintic)
        return table if cut.origin == "return" else table.roll(cut.length - 0.5 * cut.sync_zone)
    if task.straight:
        back = law_return("linear" if name == "linear_return" else name, cut.return_zone, height, cut.sync_ratio)
    elif name == "linear_return":
        back = law_return("linear", cut.return_zone, height, 0.0)
    else:
        back = quintic_between(sync, cut.return_zone, height)
    return assemble(back, task)


def quintic_between(sync: CamProfile, length: float, height: float) -> CamProfile:
    """Quintic return that meets position, ratio and ratio slope at both ends of a sync zone (Hermite).

    Parameters
    ----------
    sync
        Slave in the sync zone.
    length
        Length of the return zone (m).
    height
        Slave travel in the return zone (slave unit).
    """
    v0, v1 = float(sync(sync.end, 1)) * length, float(sync(sync.start, 1)) * length
    a0, a1 = float(sync(sync.end, 2)) * length**2, float(sync(sync.start, 2)) * length**2
    d = height - v0 - a0 / 2  # what the cubic and higher powers make up for: position, ratio, ratio slope at the end
    e, f = v1 - v0 - a0, a1 - a0
    unit = [0.0, v0, a0 / 2, 10 * d - 4 * e + f / 2, -15 * d + 7 * e - f, 6 * d - 3 * e + f / 2]
    return CamProfile.from_arrays([0.0, length], [unit / length ** np.arange(6)])


def tabulate_crank(cycle: CamProfile, points: int = 360) -> CamProfile:
    """Make the running curve of S3 from a table.

    Crank angles evenly around the turn, the master positions at which they are passed, and between these the crank's speed by
    differences, interpolated over the master.

    Parameters
    ----------
    cycle
        The crank's cycle that the table is taken from, with a ratio that is never negative; it starts at the return.
    points
        Number of angles, 360 or more in S3.
    """
    angle = np.linspace(0.0, cycle.advance, points + 1)
    dense = np.linspace(cycle.start, cycle.end, 64 * points + 1)
    passed = np.maximum.accumulate(cycle(dense))
    growing = np.concatenate([[True], np.diff(passed) > 0])
    x = np.interp(angle, passed[growing], dense[growing])
    x[0], x[-1] = cycle.start, cycle.end
    keep = np.concatenate([[True], np.diff(x) > 1e-9 * cycle.length])
    keep[-1] = True
    x, angle = x[keep], angle[keep]
    middle = 0.5 * (x[:-1] + x[1:])
    speed = np.diff(angle) / np.diff(x)
    # the speed between two middles is the straight line; at the seam the cycle repeats
    around = np.concatenate([[middle[-1] - cycle.length], middle, [middle[0] + cycle.length]])
    pace = np.concatenate([[speed[-1]], speed, [speed[0]]])
    breaks = ascending(np.concatenate([[cycle.start], middle, [cycle.end]]))
    at = np.interp(breaks, around, pace)
    rise = np.diff(breaks) * 0.5 * (at[:-1] + at[1:])
    # differences and straight lines do not add up to the turn; S3's drive closes the cycle by the last value
    at *= cycle.advance / rise.sum()
    rise *= cycle.advance / rise.sum()
    start = np.concatenate([[0.0], np.cumsum(rise)[:-1]])
    slope = np.diff(at) / np.diff(breaks)
    return CamProfile.from_arrays(breaks, np.stack([start, at[:-1], slope / 2], axis=1))


def assemble(back: CamProfile, task: Task) -> CamProfile:
    """Make one cycle over the master period ``[0, x_c]`` from a return over ``[0, x_c - l_s]`` and the machine's sync zone.

    The cycle starts at slave zero. With the origin at the cut it starts at mid sync zone, and the sync zone is split.
    """
    cut, sync = task.cut, task.sync
    cycle = join(back, sync.shift(back.end - sync.start, task.height - float(sync(sync.start))))
    if cut.origin == "cut":
        cycle = cycle.roll(cut.length - 0.5 * cut.sync_zone)
    return cycle.over(0.0, cut.length)
