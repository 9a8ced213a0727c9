"""What ``camwright bend`` answers: one result for a whole drawing."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from itertools import groupby
from pathlib import Path
from typing import Any

from camwright.bender.bend_list import bridge_rows
from camwright.bender.calibration import Calibration
from camwright.bender.drawing import Drawing
from camwright.bender.job import BenderJob
from camwright.bender.program_file import COLLISIONS, ROUNDING, BentOutline
from camwright.house.numbers import number
from camwright.profiles.notice import Notice, Number
from camwright.validation.bender.collision import MOST_REPORTED
from camwright.validation.check import Check

_SHOWN = 10


@dataclass(frozen=True, eq=False)
class BentDrawing:
    """The programs of a drawing.

    Parameters
    ----------
    drawing
        The DXF file.
    sha256
        Its SHA-256, in hexadecimal.
    job
        Bender and rule.
    found
        What was read of it.
    outlines
        One result an outline.
    notes
        What was doubtful about the run.
    collisions_accepted
        Whether the user takes it on himself that the part meets the mould or the rule.
    """

    drawing: Path
    sha256: str
    job: BenderJob
    found: Drawing
    outlines: tuple[BentOutline, ...]
    notes: tuple[str, ...] = ()
    collisions_accepted: bool = False

    @property
    def passed(self) -> bool:
        """Whether every check of every program passed, or fails only in what the user accepts."""
        return not any(self.failed(outline) for outline in self.outlines)

    def accepted(self, check: Check) -> bool:
        """Tell whether a check failed and the user accepts that."""
        return not check.passed and check.name == COLLISIONS and self.collisions_accepted

    def failed(self, outline: BentOutline) -> list[Check]:
        """List the checks of a program that failed and are not accepted."""
        return [check for check in outline.checks if not check.passed and not self.accepted(check)]

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the operator should know: the table's doubtful rows, what was left out, collisions by line."""
        found = [*self.job.warnings, *self.found.warnings, *size_warnings(self.found, self.job), *self.notes]
        for outline in self.outlines:
            found += [*_bridge_lines(outline), *collision_lines(outline, self.job)]
        count = sum(bool(outline.run.collisions) for outline in self.outlines)
        if count and not self.collisions_accepted:
            found.append(_failed_collisions(count))
        return tuple(found)


def _failed_collisions(count: int) -> Notice:
    way_out = (
        "if the rule is guided by hand or lifted over the mould at these bends, accept it with --accept-collisions"
    )
    if count == 1:
        return Notice(f"the check {COLLISIONS} failed in 1 program; {way_out}")
    return Notice(f"the check {COLLISIONS} failed in {{count}} programs; {way_out}", count=str(count))


def size_warnings(found: Drawing, job: BenderJob) -> tuple[str, ...]:
    """Say that a drawing is larger than what the machine is made for: its unit may be wrong."""
    if max(found.size) <= job.greatest_size:
        return ()
    width, height = found.size
    return (
        Notice(
            "the drawing is {width} mm × {height} mm large, beyond the machine's {greatest} mm; if its unit is not {unit}, write "
            'units = "mm" under [drawing] of the bender job',
            width=Number(1e3 * width, ".3f"),
            height=Number(1e3 * height, ".3f"),
            greatest=Number(1e3 * job.greatest_size, "g"),
            unit=found.unit,
        ),
    )


def size_words(found: Drawing) -> str:
    """Width and height of a drawing in words."""
    width, height = found.size
    return f"{1e3 * width:.3f} mm × {1e3 * height:.3f} mm"


def check_words(check: Check) -> str:
    """Value and limit of a check in words."""
    unit = "" if check.unit == "1" else f" {check.unit}"
    return f"{number(check.value, 3)}{unit}, allowed {number(check.limit, 3)}"


def collision_lines(outline: BentOutline, job: BenderJob) -> list[str]:
    """Collisions in words, with the lines of the program at which they happen; the first ones if there are many.

    Neighbouring collisions with the same side of the part are told together.
    """
    blocks = outline.program.bend_blocks()
    numbers = job.numbering.numbers(outline.program.blocks)
    name = outline.program.name
    texts: list[str] = []
    groups = [list(hits) for _, hits in groupby(outline.run.collisions, key=lambda hit: (hit.side, hit.what))]
    for hits in groups[:_SHOWN]:
        side = hits[0].side
        x, y = 1e3 * outline.proof.points[side]
        bends, lines = [str(hit.bend + 1) for hit in hits], [f"N{numbers[blocks[hit.bend]]:03d}" for hit in hits]
        texts.append(
            Notice(
                "{program}, {lines} ({bends}): the part bent so far, side {side} from ({x}, {y}) mm, meets the mould; start "
                "elsewhere, reverse the outline or guide the rule by hand"
                if hits[0].what == "mould"
                else "{program}, {lines} ({bends}): the part bent so far, side {side} from ({x}, {y}) mm, meets the rule that is "
                "still straight; start elsewhere, reverse the outline or guide the rule by hand",
                program=name,
                lines=Notice("line {number}" if len(lines) == 1 else "lines {number}", number=", ".join(lines)),
                bends=Notice("bend {number}" if len(bends) == 1 else "bends {number}", number=", ".join(bends)),
                side=str(side + 1),
                x=Number(x, ".3f"),
                y=Number(y, ".3f"),
            )
        )
    more = sum(map(len, groups[_SHOWN:]))
    if more:
        texts.append(
            Notice(
                "{program}: at least {count} more bends at which the part meets the mould or the rule"
                if len(outline.run.collisions) >= MOST_REPORTED
                else "{program}: {count} more bends at which the part meets the mould or the rule",
                program=name,
                count=str(more),
            )
        )
    return texts


def _bridge_lines(outline: BentOutline) -> list[str]:
    """Bridges that do not lie where their spacing would have them, in words."""
    moved = [bridge for bridge in outline.bridges if abs(bridge.moved) > ROUNDING]
    if not moved:
        return []
    furthest = max(moved, key=lambda bridge: abs(bridge.moved))
    return [
        Notice(
            "{program}: {count} of {all} bridges are moved along the rule to stay clear of bends and ends, the one at {middle} mm "
            "by {moved} mm",
            program=outline.program.name,
            count=str(len(moved)),
            all=str(len(outline.bridges)),
            middle=Number(1e3 * furthest.middle, ".3f"),
            moved=Number(1e3 * abs(furthest.moved), ".3f"),
        )
    ]


def answer(result: BentDrawing, programs: Sequence[Path], files: Sequence[Path]) -> dict[str, Any]:
    """Gather what ``--json`` prints."""
    closing = [outline.proof.closing_error for outline in result.outlines if outline.proof.closing_error is not None]
    return {
        "unit": result.found.unit,
        "size_mm": [1e3 * side for side in result.found.size],
        "styles": [asdict(style) for style in dict.fromkeys(result.found.styles)],
        "overlaps": [
            {"first": overlap.first, "second": overlap.second, "length_mm": 1e3 * overlap.length}
            for overlap in result.found.overlaps
        ],
        "near_ends": [
            {
                "first": ends.first,
                "second": ends.second,
                "distance_mm": 1e3 * ends.distance,
                "gap_mm": 1e3 * ends.gap,
                "place_mm": [1e3 * part for part in ends.place],
            }
            for ends in result.found.near_ends
        ],
        "outlines": len(result.outlines),
        "bends": sum(outline.plan.bends for outline in result.outlines),
        "length_mm": sum(int(outline.program.feeds.sum()) for outline in result.outlines) / 1e3,
        "deviation_mm": max(1e3 * outline.proof.deviation for outline in result.outlines),
        "chord_error_mm": max(1e3 * outline.plan.chord_error for outline in result.outlines),
        "closing_error_mm": 1e3 * max(closing) if closing else None,
        "program": str(programs[0]),
        "programs": [
            {"file": str(path), "sha256": outline.sha256, "bends": outline.plan.bends, "style": str(style)}
            for path, outline, style in zip(programs, result.outlines, result.found.styles, strict=True)
        ],
        "bridges": [
            {
                "program": outline.program.name,
                "number": row.number,
                "after_bend": row.after,
                "from_mm": row.begin,
                "to_mm": row.end,
                "middle_mm": row.middle,
                "line": None if row.line is None else f"N{row.line:03d}",
            }
            for outline in result.outlines
            for row in bridge_rows(outline, result.job)
        ],
        "bridge_command": result.job.bridges.command,
        "cycle_time_s": sum(outline.run.times.total for outline in result.outlines),
        "baseline_cycle_time_s": sum(outline.run.paper_times.total for outline in result.outlines),
        "feed_overshoot_mm": max(1e3 * outline.run.feed_overshoot[0] for outline in result.outlines),
        "mould_overshoot_deg": max(math.degrees(outline.run.mould_overshoot[0]) for outline in result.outlines),
        "collisions": sum(len(outline.run.collisions) for outline in result.outlines),
        "checks": [
            {
                "program": outline.program.name,
                "name": check.name,
                "passed": check.passed,
                "accepted": result.accepted(check),
                "value": check.value,
                "limit": check.limit,
                "unit": check.unit,
                "source": check.source,
            }
            for outline in result.outlines
            for check in outline.checks
        ],
        "passed": result.passed,
        "warnings": list(result.warnings),
        "files": [str(path) for path in files],
    }


def calibration_answer(result: Calibration, files: Sequence[Path]) -> dict[str, Any]:
    """Gather what ``--calibrate --json`` prints."""
    return {
        "table": str(files[0]),
        "test_bends": len(result.bends),
        "angle_rows": len(result.springback.workpiece),
        "radius_rows": len(result.springback.radius),
        "largest_residual_deg": max(abs(residual) for residual in result.residuals),
        "warnings": list(result.springback.warnings()),
        "files": [str(file) for file in files],
    }
