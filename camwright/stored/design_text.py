"""Writing a design as design.json: apart from the reading of one, for who reads a design needs nothing of what makes one."""

from __future__ import annotations

from camwright.answers.axis import axis_answer, robust_answer
from camwright.answers.measures import agreement_answer, objective_answer
from camwright.house.json_text import to_lines
from camwright.house.provenance import SCHEMA_VERSION, provenance
from camwright.jobs.numbers import job_numbers
from camwright.studies.design import Design


def design_text(design: Design) -> str:
    """Write a design as the text of a design.json."""
    data = {
        "schema_version": SCHEMA_VERSION,
        "status": design.solution.status.value,
        "objective": objective_answer(design),
        "lower_bound_method": design.bound.method,
        "starts": agreement_answer(design),
        "servo_aware": axis_answer(design.axis),
        "robust": robust_answer(design.robust),
        "profile": design.profile.to_dict(),
        "job": {"toml": design.job.text, "si": job_numbers(design.job)},
        "provenance": provenance(design.job.sha256),
    }
    return to_lines(data) + "\n"
