"""Making one combination of a book: designed, validated, exported. The same wherever it runs: here, in a worker, in a cluster."""

from __future__ import annotations

import hashlib
import math
import os
import platform
import re
import threading
from collections.abc import Sequence
from dataclasses import dataclass, replace

from camwright.answers.measures import objective_unit
from camwright.book.entry import Entry, Limit
from camwright.book.plan import Book, Combination
from camwright.design.feasible.extremes import fastest_line
from camwright.drives.export import Exported, export_possible, export_report
from camwright.house.json_text import to_json
from camwright.house.provenance import provenance
from camwright.jobs.job import Job
from camwright.jobs.servos import servos_of
from camwright.jobs.wording import error_words, unforeseen
from camwright.production.marks import next_lengths
from camwright.profiles.errors import InfeasibleError, InputError, SolverError
from camwright.profiles.mark_range import MarkRange
from camwright.profiles.polynomial.profile import CamProfile
from camwright.stored.design_text import design_text
from camwright.studies.axis_study import axis_study, greatest_sync_error, solve_job
from camwright.studies.design import Design
from camwright.studies.reach import highest_speed
from camwright.studies.speed_band import SpeedBand, job_band
from camwright.validation.bounds.bound import Bound
from camwright.validation.production.line_ramp import line_ramp
from camwright.validation.report import judge

NOT_COMPUTED = "not computed"
"""How a book's designs found their lower bound; finding it takes longer than the design."""
_ONE_AT_A_TIME = threading.Lock()
# the solver is not made for several threads of one process, and workers of a cluster may have them


@dataclass(frozen=True)
class Made:
    """A combination that is done.

    Parameters
    ----------
    entry
        Its line in the index.
    texts
        Its files' texts by name.
    worker
        Name of the process that made it.
    peak_rss
        The most memory that this process has had so far (bytes), 0 where the system does not tell.
    """

    entry: Entry
    texts: dict[str, str]
    worker: str
    peak_rss: int


def make_chunk(book: Book, numbers: Sequence[int]) -> list[Made]:
    """Make some combinations of a book.

    Raises
    ------
    InputError
        This process runs another version of camwright or of a library than the one that plans the book.
    """
    origin = provenance(book.job_sha256)
    libraries = origin["libraries"]
    own = {"camwright": str(origin["camwright"]), **(libraries if isinstance(libraries, dict) else {})}
    faults = [
        f"a worker runs {name} {own.get(name)}, but this book is made with {version}; install the same versions everywhere"
        for name, version in book.versions
        if own.get(name) != version
    ]
    if faults:
        raise InputError(*faults)
    with _ONE_AT_A_TIME:
        return [_made(*_row(book, number)) for number in numbers]


def _made(entry: Entry, texts: dict[str, str]) -> Made:
    return Made(entry, texts, f"{platform.node()}:{os.getpid()}", peak_rss())


def peak_rss() -> int:
    """Give the most memory that this process has had (bytes); 0 where the system does not tell."""
    try:
        import resource
    except ImportError:
        return 0
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def make(book: Book, combination: Combination) -> tuple[Entry, dict[str, str]]:
    """Make one combination; its entry and the texts of its files by name."""
    number, limit = combination.number, None
    try:
        job, cam = book.job(combination), None
        try:
            design = _designed(job)
            cam = design.profile
        finally:
            limit = _limit(job, cam) if combination.first else None
        return _exported(number, design, book.targets, limit)
    except InfeasibleError as error:
        return Entry(number, "infeasible", binding=error.binding, reason="\n".join(error_words(error)), limit=limit), {}
    except InputError as error:
        return _no_job(number, error, limit), {}
    except SolverError as error:
        return Entry(number, "failed", reason="\n".join(error_words(error)), limit=limit), {}


def _row(book: Book, number: int) -> tuple[Entry, dict[str, str]]:
    """Make one combination; what nobody foresaw is its row, and the book goes on."""
    try:
        entry, texts = make(book, book.combination(number))
        entry.to_json()  # a line with a number that is none could not be kept
        return entry, texts
    except Exception as error:  # noqa: BLE001 - whatever it is, the other rows are none the worse for it
        return Entry(number, "failed", reason=unforeseen(error)), {}


def _no_job(number: int, error: InputError, limit: Limit | None) -> Entry:
    """Enter a combination that is no job; what binds is the key of the job file that the first fault names."""
    key = re.search(r"\[\w+\] (\w+)", error_words(error)[0])
    return Entry(
        number, "infeasible", binding=key[1] if key else "job", reason="; ".join(error_words(error)), limit=limit
    )


def _limit(job: Job, cam: CamProfile | None) -> Limit | None:
    """Find how fast a cut length can be run, by the job's cam quicker; left out where each design places the sync zone anew.

    That would take minutes.
    """
    if not job.machine.placed:
        return None
    perfect, binding = fastest_line(job.task)
    speed, failed = highest_speed(job, perfect, cam=cam)
    return Limit(perfect, binding, speed, failed or binding)


def _designed(job: Job) -> Design:
    """Design and check a job like `camwright.studies.design.design`, without what a book does not hold.

    Left out are the lower bound, the baselines, the minimum cut lengths, the ranges of the servo, where the cut falls at other line
    speeds, and the search for what would work.
    """
    solution = solve_job(job, suggest=False)
    placed = replace(job, machine=solution.machine)
    report = judge(solution.profile, placed.task, job.servo, servo_aware=job.servo_aware, slowest=job.slowest)
    if report.servo is None:
        raise InputError("the servo is unstable")
    return Design(
        job=placed,
        solution=solution,
        bound=Bound(math.nan, NOT_COMPUTED),
        report=report,
        axis=axis_study(placed, solution),
        robust=None,
        band=job_band(solution.profile, placed, report) if report.passed else SpeedBand((), ()),
    )


def _exported(number: int, design: Design, targets: Sequence[str], limit: Limit | None) -> tuple[Entry, dict[str, str]]:
    """Write the tables of a design, read them back and judge them, and gather everything."""
    results, refused = export_possible(design.profile, design.job, targets)
    failed = design.failed
    for result in results:
        failed += [f"{result.target.name}: {check.name}" for check in result.judgement.checks if not check.passed]
    failed += [f"{name}: refused" for name in refused]
    texts = {
        "design.json": design_text(design),
        "report.json": to_json(_report(design, results, refused)),
        **{name: text for result in results for name, text in result.files.items()},
    }
    tool, servo = design.report.tool, design.report.servo
    ramp = None if failed else line_ramp(design.profile, design.job.task)
    marks = MarkRange(None, None) if failed else next_lengths(design.job)
    entry = Entry(
        number,
        "check_failed" if failed else "passed",
        objective=design.objective + 0.0,  # no negative zero
        unit=objective_unit(design.job),
        peak_speed=tool.peak_speed,
        peak_acceleration=tool.peak_acceleration,
        rms_acceleration=tool.rms_acceleration,
        peak_jerk=tool.peak_jerk,
        following_error=servo.peak_following_error if servo else None,
        settling=servo.settling if servo else None,
        shear_zone_error=servo.shear_zone_error if servo else None,
        worst_shear_zone_error=greatest_sync_error(design.profile, design.job)
        if len(servos_of(design.job)) > 1
        else None,
        failed_checks=tuple(failed),
        tables=tuple((result.target.name, result.table.points) for result in results if result.passed),
        reason="; ".join(f"{name}: {fault}" for name, faults in refused.items() for fault in faults),
        limit=limit,
        speed_band=design.band.parts,
        mark_earliest=marks.earliest,
        mark_latest=marks.latest,
        line_ramp=_finite(ramp.ramp.value) if ramp else None,
        line_stop=_finite(ramp.braking.value) if ramp else None,
        files=tuple((name, hashlib.sha256(text.encode()).hexdigest()) for name, text in sorted(texts.items())),
    )
    return entry, texts


def _finite(value: float) -> float | None:
    """Give a number; nothing for what is unlimited."""
    return value if math.isfinite(value) else None


def _report(design: Design, results: list[Exported], refused: dict[str, tuple[str, ...]]) -> dict[str, object]:
    """Contents of a combination's report.json: the checks of the design, then what ``camwright export`` reports."""
    return {
        "checks": [vars(check) for check in design.report.checks],
        "passed": design.passed,
        **export_report(results, design.job, refused),
    }
