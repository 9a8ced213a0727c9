"""`Result`: a design that shows itself in a notebook, draws itself, and gives its cam as a table."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from html import escape
from typing import Any, Literal

import numpy as np

from camwright.answers.measures import objective_unit
from camwright.figures.comparison import bars_figure
from camwright.figures.profile import profile_figure
from camwright.figures.servo import AXES, servo_figure
from camwright.house.numbers import number, shown, unit_shown
from camwright.house.pictures import Picture
from camwright.house.progress import Step, ignore
from camwright.jobs.job import Job
from camwright.notebook.drawing import Plot
from camwright.studies import design as designing
from camwright.studies.comparison import Comparison
from camwright.studies.speed_band import failed_words
from camwright.validation.servo.simulation import simulate

What = Literal["profile", "servo", "comparison"]
"""Figures that a result can draw."""


@dataclass(frozen=True, eq=False)
class Result(designing.Design):
    r"""A `camwright.Design` with what a notebook needs.

    Examples
    --------
    >>> from camwright import load_job, optimise
    >>> result = optimise(load_job())
    >>> "<table>" in result._repr_html_(), result.plot("comparison").title
    (True, 'paper-600: all profiles, by peak acceleration\n† breaks a limit of the job')
    """

    def plot(self, what: What = "profile") -> Plot:
        """Draw a figure of the design, as `camwright design` writes it.

        Parameters
        ----------
        what
            ``"profile"``, ``"servo"`` or ``"comparison"``.

        Returns
        -------
        Drawing
            It shows itself in a notebook; its ``svg`` is the text of a file.

        Raises
        ------
        ValueError
            There is no such figure.
        """
        if what not in _FIGURES:
            raise ValueError(f"there is no figure {what!r}; the figures are {', '.join(_FIGURES)}")
        return Plot(_FIGURES[what](self.comparison))

    def samples(self, points: int | None = None) -> dict[str, np.ndarray[Any, np.dtype[np.float64]]]:
        """Sample one cycle evenly over the master.

        Parameters
        ----------
        points
            Number of points, both ends included; that of the job's cam.csv if not given.

        Returns
        -------
        dict
            By name with unit: ``time_s``, ``master_m``, slave position (``slave_m`` or ``slave_rad``), ``ratio``, and velocity,
            acceleration and jerk at the job's line speed.
        """
        unit, v = self.job.machine.slave_unit, self.job.cut.line_speed
        profile = self.profile
        x = np.linspace(profile.start, profile.end, self.job.output.points if points is None else points)
        return {
            "time_s": (x - profile.start) / v,
            "master_m": x,
            f"slave_{unit}": profile(x),
            "ratio": profile(x, 1),
            f"velocity_{unit}_per_s": profile(x, 1) * v,
            f"acceleration_{unit}_per_s2": profile(x, 2) * v**2,
            f"jerk_{unit}_per_s3": profile(x, 3) * v**3,
        }

    def to_dataframe(self, points: int | None = None) -> Any:
        """Give `samples` as a table of pandas, which camwright does not bring.

        Raises
        ------
        ModuleNotFoundError
            pandas is not installed.
        """
        import pandas as pd

        return pd.DataFrame(self.samples(points))

    def _repr_html_(self) -> str:
        """Write what a notebook shows: how good it is, the profiles side by side, the checks that failed."""
        return "".join((self._head(), _profiles(self.comparison), self._verdict()))

    def _head(self) -> str:
        """Say how the design ended."""
        measure = self.job.units.measure(objective_unit(self.job))
        value = f"{number(self.objective * measure.factor)} {measure.printed}"
        bound = "no lower bound is known" if self.gap is None else f"gap to its lower bound {self.gap:.1e}"
        status = self.solution.status.value.replace("_", " ")
        words = f"{status}, {self.job.objective.replace('_', ' ')} {value}, {bound}"
        return f"<p><b>{escape(self.job.name)}</b>: {escape(words)}</p>"

    def _verdict(self) -> str:
        """Say which checks failed."""
        words = failed_words([name.replace("_", " ") for name in self.failed])
        return f"<p>{escape(words)}</p>"


def optimise(job: Job, step: Step = ignore) -> Result:
    """Find the optimal cam of a job and prove it: arguments and errors as of the command's design.

    Examples
    --------
    >>> from camwright import load_job, optimise
    >>> result = optimise(load_job())
    >>> result.passed, round(result.objective, 2)
    (True, 9.07)
    """
    design = designing.optimise(job, step)
    return Result(**{each.name: getattr(design, each.name) for each in fields(design)})


def _servo(comparison: Comparison) -> Picture:
    """Draw the servo's answer."""
    job = comparison.job
    return servo_figure(comparison, {name: simulate(comparison[name].profile, job.cut, job.servo) for name in AXES})


_FIGURES: dict[str, Callable[[Comparison], Picture]] = {
    "profile": profile_figure,
    "servo": _servo,
    "comparison": bars_figure,
}


def _profiles(comparison: Comparison) -> str:
    """Set the profiles side by side."""
    unit, units = comparison.job.machine.slave_unit, comparison.job.units
    speed, acceleration, jerk = (units.measure(unit + power) for power in ("/s", "/s^2", "/s^3"))
    length = unit_shown("m", units)
    head = (
        "profile",
        f"peak speed ({speed.printed})",
        f"peak acceleration ({acceleration.printed})",
        f"peak jerk ({jerk.printed})",
        f"settling ({length})",
        f"sync error in the shear zone ({length})",
    )
    rows = [
        (
            row.name.replace("_", " "),
            number(row.motion.peak_speed * speed.factor),
            *(
                number(None if value is None else value * measure.factor, without="unbounded")
                for value, measure in ((row.motion.peak_acceleration, acceleration), (row.motion.peak_jerk, jerk))
            ),
            shown(row.response.settling, "m", 4, units),
            shown(row.response.shear_zone_error, "m", 4, units),
        )
        for row in comparison.rows
    ]
    titles = "".join(f"<th>{escape(each)}</th>" for each in head)
    cells = "".join(f"<tr>{''.join(f'<td>{escape(each)}</td>' for each in row)}</tr>" for row in rows)
    return f"<table><thead><tr>{titles}</tr></thead><tbody>{cells}</tbody></table>"
