"""`Comparison`: the optimised profile beside the baselines, all measured alike."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from camwright.job import Job
from camwright.progress import Step, ignore
from profiles.errors import InputError
from profiles.polynomial import CamProfile
from profiles.returns import BASELINES, baseline

if TYPE_CHECKING:
    from validation.motion import Motion
    from validation.response import ServoResponse


@dataclass(frozen=True, eq=False)
class Measured:
    """A profile and its measures.

    Parameters
    ----------
    name
        ``"optimised"`` or the name of a baseline.
    profile
        One cycle.
    motion
        Measures of its motion at line speed.
    response
        What the servo makes of it.
    """

    name: str
    profile: CamProfile
    motion: Motion
    response: ServoResponse


@dataclass(frozen=True, eq=False)
class Comparison:
    """Profiles of one job, measured alike.

    Parameters
    ----------
    job
        The job.
    rows
        The profiles, sorted by peak acceleration, the unbounded ones last.
    """

    job: Job
    rows: tuple[Measured, ...]

    def __getitem__(self, name: str) -> Measured:
        """Return the profile of that name."""
        return next(row for row in self.rows if row.name == name)


def require_baselines(names: Sequence[str]) -> None:
    """Refuse names of baselines that do not exist, all at once.

    Raises
    ------
    InputError
        With one message for each.
    """
    import difflib

    faults = []
    for name in names:
        if name not in BASELINES:
            near = difflib.get_close_matches(name[:50], BASELINES, n=1)
            advice = f"did you mean {near[0]}?" if near else f"the laws are {', '.join(BASELINES)}"
            faults.append(f"--with {name[:50]!r}: there is no such law; {advice}")
    if faults:
        raise InputError(*faults)


def compare(job: Job, optimised: CamProfile, names: Sequence[str] = BASELINES, step: Step = ignore) -> Comparison:
    """Measure the optimised profile of a job and baselines.

    Parameters
    ----------
    job
        The job.
    optimised
        Its optimised cycle.
    names
        Names of baselines, from `profiles.returns.BASELINES`.
    step
        Told what begins now.

    Raises
    ------
    InputError
        There is no such baseline.
    """
    require_baselines(names)
    profiles = {"optimised": optimised, **{name: baseline(name, job.machine, job.cut) for name in names}}
    rows = []
    for name, profile in profiles.items():
        step(f"measuring {name}")
        rows.append(_measure(name, profile, job))
    rows.sort(key=lambda row: math.inf if row.motion.peak_acceleration is None else row.motion.peak_acceleration)
    return Comparison(job, tuple(rows))


def _measure(name: str, profile: CamProfile, job: Job) -> Measured:
    """Measure one profile."""
    from validation.motion import measure_motion
    from validation.response import servo_response

    return Measured(
        name,
        profile,
        measure_motion(profile, job.cut),
        servo_response(profile, job.machine, job.cut, job.servo),
    )
