"""camwright: optimal electronic cams for cut-to-length machines, designed, proved, and written for the drive.

Examples
--------
>>> from camwright import design, load_job, validate
>>> job = load_job()
>>> result = design(job)
>>> result.solution.status.value, result.passed
('optimal', True)
>>> validate(result.profile, job).passed
True
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from camwright.job import Job, load_job
    from camwright.results import Design, design, validate

__all__ = ["Design", "Job", "design", "load_job", "validate"]

_HOMES = {"Job": "job", "load_job": "job", "Design": "results", "design": "results", "validate": "results"}


def __getattr__(name: str) -> Any:
    """Import what is asked for when it is asked for: the command line's help must not wait for numpy."""
    from importlib import import_module

    if name not in _HOMES:
        raise AttributeError(f"module 'camwright' has no attribute {name!r}")
    return getattr(import_module(f"camwright.{_HOMES[name]}"), name)
