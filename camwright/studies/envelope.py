"""`EnvelopeAnswer`: which cut lengths and line speeds are possible, as tables and as CSV."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from camwright.design.feasible.envelope import Envelope, envelope, quintic_speed
from camwright.design.feasible.extremes import max_line_speed, placed_fastest
from camwright.house.progress import Step, ignore
from camwright.house.provenance import provenance
from camwright.house.threads import one_thread
from camwright.jobs.job import Job
from camwright.profiles.machines import Machine
from camwright.profiles.objective import OBJECTIVES, MotionObjective, of_motion
from camwright.studies.reach import ACCURACY, Programmes, followed_speed, highest_speed, stand_in, verdict

SHORTEST, LONGEST = 0.5, 2.0
"""Cut lengths of the map as parts of the job's; none of them is shorter than `LEAST_ZONE` of the sync zone."""
LEAST_ZONE = 1.05

Edge = tuple[tuple[float, float], ...]
"""Line speeds (m/s) over cut lengths (m), ascending."""

STRAIGHT = 4e-3
"""Share of the line speed by which the middle between two nodes of an edge may lie off the line."""

FINEST, FINE = 1e-4, 1e-3
"""Nodes of an edge are no closer, relative to the length: of a perfect axis, whose edge is a closed form, and where an edge is steep; of
the axis in tolerance, of which each node is some designs."""

PROBE = 0.29
"""Where a part whose middle lies on the line is looked at once more: the line may cross a bent edge in its middle."""

BETWEEN = 1e-3
"""Accuracy of the line speeds with the axis in tolerance between the cut lengths of the map, relative to them."""

FOLLOWED = 5e-3
"""Share of itself by which the edge of a line that ramps may differ, as a share of the perfect axis', where it is said to follow it."""

POWER, APART = 4.0, 0.99
"""Greatest power of the cut length by which an edge is expected to go on beyond two nodes, of which one is shorter by this factor."""

JUMP, LEAST_JUMP, HOLE = 10.0, 0.03, 1.02
"""Power of the cut length, and share of the line speed, beyond which an edge is taken to jump between two nodes; and factor by which line
speeds above its lower node are looked at for a hole: where there is none the edge is about the upper one."""

SPARED, MISSED = 0.06, 0.03
"""An edge is near where a design keeps the tolerance by no more than the first share, as a logarithm, or misses it by no more than the
other: half a percent of the line speed."""

CLOSEST, ALONE = 2e-2, 1.0
"""Nodes of an edge that is followed with few designs are no closer, relative to the length; and where a node takes some seconds, so that
those at the lengths of the map are the only ones."""

STEEP = 5e-3
"""Share of the line speed by which an edge may change between nodes as close as `FINE`; by more at `FINEST` it jumps."""


@dataclass(frozen=True, eq=False)
class EnvelopeAnswer:
    """The map of a job.

    Parameters
    ----------
    objective
        What was made least at every point.
    quintic, perfect, within
        Highest line speeds (m/s) over cut lengths (m): with the quintic return, with a perfect axis, and with the axis in
        tolerance, which is what `design` would pass, designed anew; a crank's free sync zone placed where the line can run fastest, as the
        map's rows tell. Lines with nodes so close that what lies between is true to `STRAIGHT`, `within` of servo-aware jobs and of lines
        that ramp to a percent, the lower of two nodes where it bends, and straight between the lengths of the map where `sampled`;
        NaN where no line speed works. Where an edge jumps, two nodes have one length.
    """

    job: Job
    objective: MotionObjective
    envelope: Envelope
    quintic: Edge
    perfect: Edge
    within: Edge

    @property
    def sampled(self) -> bool:
        """Whether `within` is found at the lengths of the map alone, and drawn straight between them: a crank's whose zone is free."""
        return not self.job.machine.placed

    @property
    def unit(self) -> str:
        """Unit of the objective."""
        return OBJECTIVES[self.objective].unit(self.job.machine.slave_unit)

    def in_tolerance(self, length: float) -> float | None:
        """Highest line speed with the axis in tolerance at a cut length that is a node (m/s); ``None`` where none works."""
        speed = max(speed for node, speed in self.within if node == length)
        return None if math.isnan(speed) else speed

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
                    "axis_in_tolerance_m_per_min": per_minute(self.in_tolerance(row.length)),
                    "binding": row.binding,
                    **_place(row.machine),
                }
                for row in self.envelope.rows
            ],
            "axis_in_tolerance_at_lengths_only": self.sampled,
            "edges": {
                name: [
                    {"length_mm": length * 1e3, "line_speed_m_per_min": None if math.isnan(speed) else speed * 60}
                    for length, speed in edge
                ]
                for name, edge in (
                    ("quintic", self.quintic),
                    ("perfect_axis", self.perfect),
                    ("axis_in_tolerance", self.within),
                )
            },
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


@one_thread()
def envelope_answer(job: Job, points: int, step: Step = ignore) -> EnvelopeAnswer:
    """Compute the map of a job: from half to twice its cut length, up to the line speed at which the sync zone alone is too fast.

    Parameters
    ----------
    points
        Number of cut lengths, beside the job's own and the pitch, and of line speeds.

    Raises
    ------
    InputError
        The machine cannot be in sync over the zone.
    """
    shortest = max(SHORTEST * job.cut.length, LEAST_ZONE * job.cut.sync_zone)
    longest = LONGEST * job.cut.length
    nodes = (
        {job.cut.length, job.machine.pitch / job.cut.sync_ratio} if job.machine.slave_unit == "m" else {job.cut.length}
    )
    even = np.linspace(shortest, longest, points).round(6)
    lengths = np.union1d(even, [node for node in nodes if shortest < node < longest])
    top = job.limits.speed / job.machine.sync_pace(job.cut)
    speeds = np.linspace(top / points, top, points)
    objective = of_motion(job.objective)
    found = envelope(job.task, objective, lengths.tolist(), speeds.tolist(), step)
    step("the edges between the cut lengths")

    job_at = _Lengths(job, lengths.tolist())
    perfect = true_edge(lambda length, _: job_at.fastest(length), lengths.tolist(), FINEST)
    if not job.machine.placed:  # each of its designs places the zone anew
        within = tuple(_nodes(job_at.in_tolerance, lengths.tolist()))
    elif job.servo_aware or job.line.ramps:  # whose designs are dear
        closest = ALONE if job.servo_aware else CLOSEST
        within = followed_edge(job_at.in_tolerance, job_at.near, lengths.tolist(), closest)
    else:
        within = true_edge(job_at.in_tolerance, lengths.tolist(), FINE)
    quintic = true_edge(lambda length, _: quintic_speed(job_at(length).task), lengths.tolist(), FINEST)
    return EnvelopeAnswer(job, objective, found, quintic, perfect, within)


class _Lengths:
    """The job at cut lengths, of which some are those of the map; and how fast its line can run there."""

    def __init__(self, job: Job, lengths: list[float]) -> None:
        self._job, self._lengths = job, lengths
        self._at: dict[float, tuple[Job, float | None]] = {}
        self._found: dict[float, float | None] = {}
        self._programmes = Programmes(job)

    def _known(self, length: float) -> tuple[Job, float | None]:
        """Give the job at a cut length, a crank's free sync zone placed where the line can run fastest, and that speed (m/s)."""
        if length not in self._at:
            there = self._job.task.with_length(length)
            job = replace(self._job, machine=placed_fastest(there).machine, cut=there.cut)
            self._at[length] = job, max_line_speed(job.task)
        return self._at[length]

    def __call__(self, length: float) -> Job:
        """Give the job at a cut length."""
        return self._known(length)[0]

    def fastest(self, length: float) -> float | None:
        """Give the highest line speed of the perfect axis (m/s); ``None`` where none works."""
        return self._known(length)[1]

    def in_tolerance(self, length: float, expected: float) -> float | None:
        """Find that of the axis in tolerance from about where it is expected; ``None`` where none works."""
        self._found[length] = (self._aware if self._job.servo_aware else self._blind)(length, expected)
        return self._found[length]

    def near(self, length: float, speed: float) -> bool:
        """Say whether that is near a line speed, by one design."""
        (there, top), blind = self._known(length), not self._job.servo_aware
        if top is None or (blind and speed > top):
            return False
        task = there.task.designed_at(speed)
        failed, missed = verdict(there, task, stand_in(there)) if blind else self._programmes.verdict(task)
        return -SPARED <= missed <= MISSED or (blind and not failed and speed >= (1.0 - STRAIGHT) * top)

    def _aware(self, length: float, expected: float) -> float | None:
        """Find the edge of a servo-aware job, which is made for about what its machine can do."""
        cut = self._job.cut
        if math.isnan(expected):
            expected = cut.line_speed * length / cut.length
        elif len(self._found) == 1:  # cycles of one time
            expected *= length / next(iter(self._found))
        return followed_speed(*self._known(length), expected, self._programmes)

    def _blind(self, length: float, expected: float) -> float | None:
        """Begin at the perfect axis' edge where that is the edge of the next shorter length too, or is about what is expected."""
        there, top = self._known(length)
        accuracy = ACCURACY if length in self._lengths else BETWEEN
        accuracy = STRAIGHT if there.line.ramps else accuracy
        shorter = max((each for each in self._found if each < length), default=None)
        at_top = shorter is not None and self._found[shorter] == self.fastest(shorter)
        near: float | None = expected * (
            1.0 - 0.5 * accuracy
        )  # the line is as often on one side of the edge as on the other
        if (jump := at_jump(self._found, length)) is not None:
            low, high = jump  # between there may be a hole, above which line speeds pass again: the edge is below it
            near = low if verdict(there, there.task.designed_at(low * HOLE), stand_in(there))[0] else high
        elif at_top or math.isnan(expected) or top is None or expected >= (1.0 - STRAIGHT) * top:
            near = None
        elif there.line.ramps:  # where the edge is not followed well that of a line which keeps its speed is nearer
            share = self._share(shorter, top)
            follows = length not in self._lengths or abs(expected / top - share) <= FOLLOWED * share
            near = expected if follows else None
        return highest_speed(there, top, near, accuracy)[0]

    def _share(self, length: float | None, top: float) -> float:
        """Share of the perfect axis' edge at which the edge of a length was found; 0 where none was."""
        return 0.0 if length is None else (self._found[length] or 0.0) / (self.fastest(length) or top)


def true_edge(fastest: Callable[[float, float], float | None], lengths: list[float], finest: float) -> Edge:
    """Follow a highest line speed over the cut length: nodes are added until the line between them is true.

    A part is true where two places between its ends lie on the line. What remains when nodes are as close as they may be is a jump: it is
    drawn upright, on the side on which less is possible.

    Parameters
    ----------
    fastest
        Highest line speed (m/s), ``None`` where none works, of a cut length (m) and the line speed that is expected there (m/s; NaN where
        none is).
    lengths
        First nodes, ascending.
    finest
        Nodes are no closer than this share of the length, where the edge is not steep.
    """

    def node(length: float, expected: float) -> tuple[float, float]:
        speed = fastest(length, expected)
        return length, math.nan if speed is None else speed

    def between(left: tuple[float, float], right: tuple[float, float], finest: float) -> Edge:
        steep = abs(right[1] - left[1]) > STEEP * max(left[1], right[1])
        apart = (right[0] - left[0]) / right[0]
        if apart <= FINEST or (apart <= finest and not steep) or (math.isnan(left[1]) and math.isnan(right[1])):
            return ((max(left, right, key=lambda each: each[1])[0], min(left[1], right[1])),) if steep else ()

        def on_line(share: float) -> tuple[tuple[float, float], bool]:
            expected = left[1] + share * (right[1] - left[1])
            found = node(left[0] + share * (right[0] - left[0]), expected)
            return found, abs(expected - found[1]) <= STRAIGHT * found[1]

        middle, straight = on_line(0.5)
        if straight:
            probe, straight = on_line(PROBE)
            if straight:
                return probe, middle
        return *between(left, middle, finest), middle, *between(middle, right, finest)

    found: list[tuple[float, float]] = []
    for left, right in pairwise(_nodes(fastest, lengths)):
        found += [*([] if found else [left]), *between(left, right, finest), right]
    return tuple(found)


def followed_edge(
    fastest: Callable[[float, float], float | None],
    near: Callable[[float, float], bool],
    lengths: list[float],
    closest: float,
) -> Edge:
    """Follow a highest line speed over the cut length with few designs: between two nodes it goes as a power of the length.

    In the middle between them it is looked whether that is so; if not, the middle is a node. Between nodes as close as they may be, where
    the edge bends, the lower of both is drawn.

    Parameters
    ----------
    fastest, lengths
        As in `true_edge`.
    near
        Whether the edge is near a line speed (m/s) at a cut length (m).
    closest
        Nodes are no closer than this share of the length.
    """

    def between(left: tuple[float, float], right: tuple[float, float]) -> Edge:
        (shorter, low), (longer, high) = left, right
        if math.isnan(low + high):
            return ()
        middle, expected = math.sqrt(shorter * longer), math.sqrt(low * high)
        if near(middle, expected):
            return tuple(
                (shorter * (longer / shorter) ** share, low * (high / low) ** share) for share in (0.25, 0.5, 0.75)
            )
        if longer - shorter <= closest * longer:
            return ((longer if low < high else shorter, min(low, high)),)
        speed = fastest(middle, expected)
        node = middle, math.nan if speed is None else speed
        return *between(left, node), node, *between(node, right)

    found: list[tuple[float, float]] = []
    for left, right in pairwise(_nodes(fastest, lengths)):
        found += [*([] if found else [left]), *between(left, right), right]
    return tuple(found)


def _nodes(fastest: Callable[[float, float], float | None], lengths: list[float]) -> list[tuple[float, float]]:
    """Find a highest line speed at cut lengths, each from where those before lead to; NaN where none works."""
    found: list[tuple[float, float]] = []
    for length in lengths:
        speed = fastest(length, _expected(found, length))
        found.append((length, math.nan if speed is None else speed))
    return found


def at_jump(found: dict[float, float | None], length: float) -> tuple[float, float] | None:
    """Give the line speeds of the nodes beside a length between which an edge jumps (m/s), the lower one first; ``None`` elsewhere."""
    before = max((each for each in found if each < length), default=None)
    after = min((each for each in found if each > length), default=None)
    if before is None or after is None:
        return None
    low, high = sorted((found[before] or 0.0, found[after] or 0.0))
    jumps = low > 0.0 and math.log(high / low) > max(JUMP * math.log(after / before), LEAST_JUMP)
    return (low, high) if jumps else None


def _expected(nodes: list[tuple[float, float]], length: float) -> float:
    """Follow an edge beyond its last nodes: as the power of the length that goes through two of them, NaN after none (m/s)."""
    last, speed = nodes[-1] if nodes else (math.nan, math.nan)
    before = [node for node in nodes[:-1] if node[0] < APART * last][-1:]
    if math.isnan(speed) or not before or math.isnan(before[0][1]):
        return speed
    power = math.log(speed / before[0][1]) / math.log(last / before[0][0])
    return float(speed * (length / last) ** min(max(power, -POWER), POWER))


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
