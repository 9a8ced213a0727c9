"""`DriveCam`: a cam that runs today, as its drive runs it."""

from __future__ import annotations

from dataclasses import dataclass, replace

from camwright.drives.alignment import aligned
from camwright.drives.options import with_slopes
from camwright.drives.several_cuts import cuts_of, first_cut
from camwright.jobs.job import Job
from camwright.jobs.place import not_placed, place_in
from camwright.jobs.table_cycle import WholeCycle, whole_cycle
from camwright.profiles.errors import InputError
from camwright.profiles.machines import Machine
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.tables.cam_table import CamTable
from camwright.profiles.tables.count_grid import (
    Counted,
    evened,
    grain_of,
    smoothed,
    spacing_rounded_to,
    without_rounding,
)
from camwright.profiles.tables.splines import cyclic_spline
from camwright.profiles.tables.target import Target, fits_head, no_cycle_in, units_in
from camwright.profiles.tables.targets import detect, layout_of, read_table
from camwright.validation.rebuilt import LEAST_WRAPS, RUN, TableJudgement, cuts_in, each_cut, judge_table, one_cycle

_BESIDE = "the units are those of the text beside the table (--units says others)"


@dataclass(frozen=True, eq=False)
class DriveCam:
    """A cam as its drive runs it.

    Parameters
    ----------
    target, table, notes, job, counted
        As of `camwright.drives.audit.Audit`.
    rebuilt
        The cam from the job's master zero on, as many cuts as the table holds (slave unit over m).
    count
        Size of the counts that its positions are in (slave unit), their rounding taken off; 0 where it has none.
    stored
        Size of the counts that straight lines lead between (slave unit); 0 where none do.
    """

    target: Target
    table: CamTable
    notes: tuple[str, ...]
    job: Job
    rebuilt: CamProfile
    count: float
    counted: bool
    stored: float

    def judged(self) -> TableJudgement:
        """Judge it as an export of the job's own design is judged: over the same run, with the same allowances."""
        job = self.job
        return judge_table(self.rebuilt, job.task, job.servo, LEAST_WRAPS, RUN, self.stored, count=self.count)

    @property
    def cycle(self) -> CamProfile:
        """One cycle of the job: the first, if the table holds several cuts."""
        cuts = cuts_in(self.rebuilt, self.job.cut)
        return each_cut(one_cycle(self.rebuilt, self.job.cut, cuts), self.job.task, cuts)[0]


def running_cam(
    text: str,
    place: str,
    job: Job,
    target: str | None = None,
    units: str | None = None,
    travel: str | None = None,
    slopes: str | None = None,
    *,
    head: str = "",
) -> DriveCam:
    """Rebuild the cam of a file's text as its drive does; arguments as of `camwright.drives.audit.audit`, messages begin with the place.

    Where the layout has no room for a head, ``head`` is the text beside the table, if there is one.

    Raises
    ------
    InputError
        The text is not read, or is no cam of this job.
    """
    layout = detect(text, place) if target is None else layout_of(target)
    what = no_cycle_in(text) or no_cycle_in(head)
    if what:
        raise InputError(
            f"{place}: the table {what}; audit judges a cam's cycles. What camwright ramps, cutlist, family or export --speed-tables "
            "writes is judged in its place between the others, when it is written"
        )
    placed = replace(job, machine=_with_place(job.machine, text, place))
    read = with_slopes(read_table(layout, text, place), slopes)
    if units is None and read.units is None and fits_head(read, head):
        read = replace(read, units=units_in(head), notes=(_BESIDE,))
    whole, cuts = _whole(read, placed, place, units, travel)
    tick = spacing_rounded_to(whole.table.x) * whole.units.master.size
    whole = replace(whole, table=evened(whole.table) or whole.table)
    table, counted = whole.table, without_rounding(whole.table)
    rebuilt = whole.units.to_si(layout.rebuild(table if counted is None else counted.table))
    try:
        one_cycle(rebuilt, job.cut, cuts)
    except InputError as error:  # another period
        raise InputError(*(f"{place}: {fault}" for fault in error.faults)) from error
    count = 0.0 if counted is None else counted.count * whole.units.slave.size
    grain = grain_of(whole.table.y) * whole.units.slave.size
    rebuilt, notes = aligned(
        rebuilt.shift(-rebuilt.start), placed, seen=_smooth(whole, counted), count=count, grain=grain, tick=tick
    )
    told = (*table.notes, *whole.notes, *((counted.note,) if counted else ()), *notes)
    return DriveCam(
        layout, table, told, placed, rebuilt, count, counted is not None, grain if set(table.laws) == {"line"} else 0.0
    )


def _smooth(whole: WholeCycle, counted: Counted | None) -> CamProfile | None:
    """Make of a table in counts what its zero is found from: the counts of straight lines shake the ends of the sync zone."""
    found = smoothed(whole.table) if counted is None and set(whole.table.laws) == {"line"} else None
    if found is None:
        return None
    profile = whole.units.to_si(cyclic_spline(found.x, found.y))
    return profile.shift(-profile.start)


def _whole(table: CamTable, job: Job, place: str, units: str | None, travel: str | None) -> tuple[WholeCycle, int]:
    """Bring a table to whole cycles of the job, and count its cuts: several where it closes on whole counts only then."""
    cuts = cuts_of(table)
    if cuts == 1:
        return whole_cycle(table, job, place, units, travel), 1
    found = whole_cycle(first_cut(table, cuts), job, place, units, travel)
    note = f"the table holds {cuts} cuts, after which it closes"
    return WholeCycle(replace(table, units=found.table.units), found.units, (note, *found.notes)), cuts


def _with_place(machine: Machine, text: str, place: str) -> Machine:
    """Give the job's machine; where the job leaves the place of its sync zone free, it is that of the file."""
    if machine.placed:
        return machine
    found = place_in(machine, text)
    if found is None:
        raise not_placed(machine, place)
    try:
        return machine.placed_at(float(found))
    except ValueError as error:
        raise InputError(f"{place}: {machine.place_name} {found!r} is not a number") from error
