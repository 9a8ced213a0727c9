"""`EnvelopeAnswer`: which cut lengths and line speeds are possible, as tables and as CSV."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from camwright.design.feasible.envelope import Envelope, envelope
from camwright.house.progress import Step, ignore
from camwright.house.provenance import provenance
from camwright.jobs.job import Job
from camwright.profiles.machines import Machine
from camwright.profiles.objective import OBJECTIVES, MotionObjective, of_motion

SHORTEST, LONGEST = 0.5, 2.0
"""Cut lengths of the map as parts of the job's; none of them is shorter than `LEAST_ZONE` of the sync zone."""
LEAST_ZONE = 1.05


@dataclass(frozen=True, eq=False)
class EnvelopeAnswer:
    """The map of a job.

    Parameters
    ----------
    job
        The job.
    objective
        What was made least at every point.
    envelope
        The map.
    """

    job: Job
    objective: MotionObjective
    envelope: Envelope

    @property
    def unit(self) -> str:
        """Unit of the objective."""
        return OBJECTIVES[self.objective].unit(self.job.machine.slave_unit)

    def to_dict(self) -> dict[str, Any]:
        """Give the object that ``--json`` prints."""
        return {
            "job": self.job.name,
            "objective": {"name": self.objective, "unit": self.unit},
            "points": [
                {
                    "length_mm": point.length * 1e3,
                    "line_speed_m_per_min": point.line_speed * 60,
                    "optimised": point.optimised,
                    "quintic": point.quintic,
                    "linear": point.linear,
                    "objective": point.objective,
                    "binding": point.binding,
                }
                for point in self.envelope.points
            ],
            "max_line_speed": [
                {
                    "length_mm": row.length * 1e3,
                    "optimised_m_per_min": per_minute(row.optimised),
                    "quintic_m_per_min": per_minute(row.quintic),
                    "linear_m_per_min": per_minute(row.linear),
                    "binding": row.binding,
                    **_place(row.machine),
                }
                for row in self.envelope.rows
            ],
        }

    def files(self) -> dict[str, str]:
        """Give the texts of the files by name: every point, and the table of the highest line speed at each cut length."""
        answer = self.to_dict()
        rows = {"envelope.csv": answer["points"], "max-line-speed.csv": answer["max_line_speed"]}
        origin = provenance(self.job.sha256)
        head = [
            f"# job: {self.job.name}",
            f"# camwright: {origin['camwright']}",
            f"# job_sha256: {self.job.sha256}",
            f"# objective: {self.objective} ({self.unit})",
        ]
        return {name: "\n".join([*head, *_csv(entries)]) + "\n" for name, entries in rows.items()}


def envelope_answer(job: Job, points: int, step: Step = ignore) -> EnvelopeAnswer:
    """Compute the map of a job: from half to twice its cut length, up to the line speed at which the sync zone alone is too fast.

    Parameters
    ----------
    job
        The job.
    points
        Number of cut lengths, and of line speeds.
    step
        Told what begins now.

    Raises
    ------
    InputError
        The machine cannot be in sync over the zone.
    """
    shortest = max(SHORTEST * job.cut.length, LEAST_ZONE * job.cut.sync_zone)
    lengths = np.linspace(shortest, LONGEST * job.cut.length, points).round(6)
    fastest = job.limits.speed / job.machine.sync_pace(job.cut)
    speeds = np.linspace(fastest / points, fastest, points)
    objective = of_motion(job.objective)
    found = envelope(job.task, objective, lengths.tolist(), speeds.tolist(), step)
    return EnvelopeAnswer(job, objective, found)


def _place(machine: Machine) -> dict[str, float]:
    """Where the machine has its sync zone, if that is a number of its own."""
    if not machine.place_name:
        return {}
    unit, factor = ("deg", math.degrees(1.0)) if machine.slave_unit == "rad" else ("mm", 1e3)
    return {f"{machine.place_name}_{unit}": machine.place * factor}


def per_minute(speed: float | None) -> float | None:
    """Turn m/s into m/min."""
    return None if speed is None else speed * 60


def _csv(entries: list[dict[str, Any]]) -> list[str]:
    """Write entries as lines of CSV: what is not there is empty, truths are 1 and 0."""

    def cell(value: object) -> str:
        return "" if value is None else str(int(value)) if isinstance(value, bool) else str(value)

    return [",".join(entries[0]), *(",".join(map(cell, entry.values())) for entry in entries)]
