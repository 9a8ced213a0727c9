"""What a cut list must be so that it can be worked out: refusals of lists, ramps and changes, each with its line and its way out."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from camwright.design.production.line_plan import HARDEST
from camwright.house.numbers import with_unit
from camwright.jobs.job import Job
from camwright.production.cams import ListCam
from camwright.production.changes import Change
from camwright.profiles.cut_list import CutList
from camwright.profiles.errors import InfeasibleError, InputError
from camwright.profiles.line_run import LineRun
from camwright.profiles.polynomial.profile import FloatArray

MOST_CAMS = 300
"""Most cams of a list."""

LEAST = 1e-6
"""Least acceleration of a line that is planned for (m/s²): with less it would take weeks to speed up."""

MOST_SAMPLES = 300_000_000
"""Most samples of servos that are run for a list: two weeks of production at 4 ms, or minutes of processor time."""

_MOST_FAULTS = 20


def require_room(job: Job, asked: CutList) -> None:
    """Refuse lengths that leave no room for the sync zone, by their line, and more lengths than a list may have."""
    zone, units = job.cut.sync_zone, job.units
    short, first = np.unique(asked.lines[asked.gaps <= zone], return_index=True)
    gaps = asked.gaps[asked.gaps <= zone][first].tolist()
    if len(short):
        raise InputError(
            *(
                f"{asked.place}, line {line}: a length of {with_unit(gap, 'm', 4, units)} leaves no room for the sync zone of "
                f"{with_unit(zone, 'm', 4, units)}; cut longer pieces, or shorten [cut] sync_zone"
                for line, gap in zip(short.tolist()[:_MOST_FAULTS], gaps, strict=False)
            )
        )
    longest = job.machine.longest_cut(zone)
    far = np.flatnonzero(asked.gaps > longest)
    if len(far):
        raise InputError(
            f"{asked.where(int(far[0]))}: a piece of {with_unit(float(asked.gaps[far[0]]), 'm', 4, units)} is longer than "
            f"{with_unit(longest, 'm', 4, units)}, the longest that a cam is for with a sync zone of {with_unit(zone, 'm', 4, units)}; "
            "make it on demand, with the one-shot cam of camwright ramps"
        )
    lengths = len(np.unique(asked.gaps))
    if lengths > MOST_CAMS:
        raise InputError(
            f"{asked.place}: {lengths} different gaps between cuts, the limit is {MOST_CAMS}; round the lengths, or split the list"
        )


def require_passed(material: float, line: LineRun) -> None:
    """Refuse a line that stands still before a list of so much material (m) is cut."""
    if line.length < material and line.speeds[-1] == 0.0:
        raise InputError(
            f"the line stands still after {line.length:.6g} m, the list needs {material:.6g} m; let it run longer, or shorten the list"
        )


def require_simulable(time: float, job: Job, runs: int = 1) -> None:
    """Refuse a list that takes so long that running its servos would not end.

    Parameters
    ----------
    time
        How long the list takes (s).
    runs
        How often a servo runs through it.
    """
    samples = runs * time / job.servo.sample_time
    if samples > MOST_SAMPLES:
        raise InputError(
            f"the list takes {time:.4g} s on this line, which is {samples:.3g} samples of the servo{'s' if runs > 1 else ''}; at most "
            f"{MOST_SAMPLES:g} are run: shorten the list, let the line run faster, or draw fewer servos"
        )


def require_ramp(job: Job) -> None:
    """Refuse a ramp of the line that no line has."""
    ramp = job.line.acceleration
    if ramp is None or LEAST <= ramp <= HARDEST:
        return
    told, least, most = (with_unit(each, "m/s^2", 4, job.units) for each in (ramp, LEAST, HARDEST))
    why = f"a jump; a plan takes at most {most}" if ramp > HARDEST else f"which is none; a plan takes {least} at least"
    raise InputError(
        f"the line's ramp is {told}, {why}: write --line-acceleration or [line] acceleration as the line can do, e.g. 0.5 m/s^2"
    )


def require_possible(job: Job, asked: CutList, of: NDArray[np.intp], perfect: FloatArray) -> None:
    """Refuse gaps that no line speed allows."""
    for number in np.flatnonzero(perfect <= 0.0).tolist():
        at = int(np.flatnonzero(of == number)[0])
        raise InfeasibleError(
            f"{asked.where(at)}: {with_unit(float(asked.gaps[at]), 'm', 4, job.units)} cannot be cut at any line speed; "
            "a shorter sync zone or a longer piece would help: ask camwright limits",
            "cut_length",
            None,
            "m",
            (),
        )


def require_running(
    job: Job, asked: CutList, of: NDArray[np.intp], changes: dict[tuple[int, int], Change], cams: Sequence[ListCam]
) -> None:
    """Refuse a list with a change that no motion makes while the line runs."""
    for change in changes.values():
        if change.times and change.how == "stop":
            at = int(change.first_pieces(of)[0])
            one, other = (
                with_unit(cams[number - 1].length, "m", 4, job.units) for number in (change.before, change.after)
            )
            way = (
                f"place the sync zone at one place for all: --common-place, or {{@machine}}.{job.machine.place_name}"
                if job.machine.place_name
                else 'let two pieces at least follow, let the command be in sync ([objective] command = "in_sync")'
                if job.cut.shaped
                else "put a length between them"
            )
            raise InfeasibleError(
                f"{asked.where(at)}: from {one} to {other} no motion within the limits leads while the line runs; "
                + way.replace("{@machine}.", "[machine] "),
                "change",
                None,
                "m",
                (),
            )
