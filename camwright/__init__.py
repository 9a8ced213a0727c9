"""camwright: optimal electronic cams for cut-to-length machines, designed, proved, and written for the drive.

Examples
--------
>>> from camwright import load_job, optimise, validate
>>> job = load_job()
>>> result = optimise(job)
>>> result.solution.status.value, result.passed
('optimal', True)
>>> validate(result.profile, job).passed
True
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from camwright.jobs.job import Job, load_job
    from camwright.stored.judge import validate
    from camwright.studies.design import Design, optimise

__all__ = ["Design", "Job", "load_job", "optimise", "validate"]

_HOMES = {
    "Design": "camwright.studies.design",
    "Job": "camwright.jobs.job",
    "load_job": "camwright.jobs.job",
    "optimise": "camwright.studies.design",
    "validate": "camwright.stored.judge",
}


def __getattr__(name: str) -> Any:
    """Import what is asked for when it is asked for: the command line's help must not wait for numpy."""
    if name not in _HOMES:
        raise AttributeError(f"module 'camwright' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)
