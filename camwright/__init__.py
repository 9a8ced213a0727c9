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
    from camwright.drives.audit import audit
    from camwright.drives.table_files import export
    from camwright.jobs.job import Job, load_job
    from camwright.notebook.result import Result, optimise
    from camwright.profiles.cut import Cut
    from camwright.profiles.errors import CamwrightError, InfeasibleError, InputError, MissingExtraError, SolverError
    from camwright.profiles.limits import Limits
    from camwright.profiles.machines import CrankSlider, LinearCarriage, Machine, RotaryKnife
    from camwright.profiles.objective import Objective
    from camwright.profiles.returns import baseline
    from camwright.profiles.servo import Servo
    from camwright.profiles.task import Task
    from camwright.recipes.write import recipe
    from camwright.stored.design_file import read_design
    from camwright.stored.judge import validate
    from camwright.stored.save import save
    from camwright.studies.comparison import compare
    from camwright.studies.design import Design
    from camwright.studies.limits import limits

_HOMES = {
    "CamwrightError": "camwright.profiles.errors",
    "CrankSlider": "camwright.profiles.machines",
    "Cut": "camwright.profiles.cut",
    "Design": "camwright.studies.design",
    "InfeasibleError": "camwright.profiles.errors",
    "InputError": "camwright.profiles.errors",
    "Job": "camwright.jobs.job",
    "Limits": "camwright.profiles.limits",
    "LinearCarriage": "camwright.profiles.machines",
    "Machine": "camwright.profiles.machines",
    "MissingExtraError": "camwright.profiles.errors",
    "Objective": "camwright.profiles.objective",
    "Result": "camwright.notebook.result",
    "RotaryKnife": "camwright.profiles.machines",
    "Servo": "camwright.profiles.servo",
    "SolverError": "camwright.profiles.errors",
    "Task": "camwright.profiles.task",
    "audit": "camwright.drives.audit",
    "baseline": "camwright.profiles.returns",
    "compare": "camwright.studies.comparison",
    "export": "camwright.drives.table_files",
    "limits": "camwright.studies.limits",
    "load_job": "camwright.jobs.job",
    "optimise": "camwright.notebook.result",
    "read_design": "camwright.stored.design_file",
    "recipe": "camwright.recipes.write",
    "save": "camwright.stored.save",
    "validate": "camwright.stored.judge",
}

__all__ = [
    "CamwrightError", "CrankSlider", "Cut", "Design", "InfeasibleError", "InputError", "Job", "Limits", "LinearCarriage",
    "Machine", "MissingExtraError", "Objective", "Result", "RotaryKnife", "Servo", "SolverError", "Task", "audit",
    "baseline", "compare", "export", "limits", "load_job", "optimise", "read_design", "recipe", "save", "validate",
]  # fmt: skip


def __getattr__(name: str) -> Any:
    """Import what is asked for when it is asked for: the command line's help must not wait for numpy."""
    if name not in _HOMES:
        raise AttributeError(f"module 'camwright' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)
