"""Numbers that the documents promise: each stands in its document and is the one that the code goes by.

The numbers are written out here. Nothing is computed from the constants of the code, so that a constant that is changed is
noticed. To change a promise, change the document, the code and this table.
"""

from __future__ import annotations

import math
import re
from functools import cache
from pathlib import Path

import pytest

from camwright import load_job
from camwright.answers.axis import lead_answer
from camwright.cli.main import INTERRUPTED
from camwright.design import place
from camwright.design.production import line_plan
from camwright.design.returns import transcription
from camwright.design.servo_aware import axis_response
from camwright.design.torque import placing
from camwright.design.torque import search as torque_search
from camwright.figures import panel
from camwright.house import picture_files
from camwright.house.output import BROKEN_PIPE
from camwright.jobs import job as job_file
from camwright.jobs.table_units import parse_units
from camwright.production import list_checks, list_file
from camwright.profiles.cut import Cut
from camwright.profiles.errors import CamwrightError, InfeasibleError, InputError, MissingExtraError, SolverError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import RotaryKnife, crank_slider, machine
from camwright.profiles.tables import cam_rows, knots, text, trace_csv
from camwright.profiles.tables.knots import Accuracy
from camwright.profiles.tables.targets import TARGETS
from camwright.profiles.task import Task
from camwright.recipes import sheet_faults
from camwright.stored import design_file, profile_files
from camwright.studies import axis_lengths, screw
from camwright.studies import recording as recorded_run
from camwright.validation import motion, motor, rebuilt, report
from camwright.validation.bounds import minimum_length
from camwright.validation.identify import fit, identification, quality
from camwright.validation.servo import axis_motion, lead, simulation

FREE = Limits(math.inf, math.inf, math.inf)
"""Nothing here asks for limits."""

DOCS = Path(__file__).parents[2] / "docs"

NUMBERS: dict[str, tuple[object, object, str, str]] = {
    "limit": (report.ALLOWANCE, 1e-9, "contract", "exceeded by no more than 1e-9 of the limit"),
    "travel": (report.CLOSURE, 1e-12, "contract", "the pitch to 1e-12 of it"),
    "position at joins": (motion.POSITION_JUMP, 1e-12, "contract", "position to 1e-12 of the cut length"),
    "ratio at joins": (motion.RATIO_JUMP, 1e-9, "contract", "ratio to 1e-9,"),
    "ratio slope at joins": (motion.SLOPE_JUMP, 1e-9, "contract", "ratio slope to 1e-9 of its peak"),
    "ratio in sync": (report.SYNC_RATIO, 1e-9, "contract", "allow a ratio error of 1e-9 in the sync zone"),
    "drawn in": (transcription.LIMIT_MARGIN, 2e-10, "contract", "keeps limits drawn in by 2e-10"),
    "memory of the servo": (simulation._FORGOTTEN, 1e-12, "contract", "moves the axis by less than 1e-12 of the command"),
    "phases": (simulation.PHASES, 16, "contract", "at all 16 phases"),
    "phases of a design": (axis_response.PHASES, 16, "contract", "`phases` (16)"),
    "samples": (simulation._MOST_SAMPLES, 131_072, "contract", "remembers more than 131 072 samples"),
    "samples one by one": (simulation.WHOLE, 8192, "contract", "more than 8192 a phase"),
    "limits of the axis": (axis_motion.ALLOWANCE, 1e-3, "contract", "to 1e-3 of the limit, at every phase"),
    "cut length, axis in sync": (axis_lengths._LENGTH_RESOLUTION, 2e-4, "contract", "to 2e-4 of the pitch; at the edge"),
    "cut length to a tolerance": (minimum_length._LENGTH_RESOLUTION, 3e-6, "contract", "to 3e-6 of the pitch, the sync zone to 1e-5"),
    "sync zone to a tolerance": (minimum_length._ZONE_RESOLUTION, 1e-5, "contract", "to 3e-6 of the pitch, the sync zone to 1e-5"),
    "sync zones tried": (minimum_length._FINE, 64, "contract", "narrower than a 64th of the room"),
    "meshes of a torque": ((torque_search.FIRST, *torque_search.LADDER[-1:]), (60, 1500), "contract", "intervals, the best on up to 1500"),
    "settled torque": (torque_search.SETTLED, 1e-4, "contract", "gains less than 1e-4"),
    "places of a torque": (placing.PLACES, 24, "contract", "24 places of the sync zone for all other objectives"),
    "meshes of a place": ((placing.FINE, placing.FINEST), (120, 300), "contract", "on a mesh laid anew (300 intervals for a peak)"),
    "meshes of a place that tell": ((placing.SETTLED, placing.STILL), (1e-3, 5e-3), "contract", "than 1e-3 and moved the place by 0.005"),
    "places of the sync zone": (place.PLACES, 9, "contract", "9 places and to 0.002 rad"),
    "places for a peak": (place.PEAK_PLACES, 41, "contract", "41 places of the sync zone are tried"),
    "accuracy of the place for a peak": (place.PEAK_RESOLUTION, 1e-5, "contract", "gone down to 1e-5 rad"),
    "valleys gone down": (place.MOST_DEEP, 3, "contract", "the three deepest valleys"),
    "accuracy of the place": (place.RESOLUTION, 2e-3, "contract", "to 0.002 rad"),
    "standing": (motor._STANDING, 1e-9, "contract", "below 1e-9 of the greatest ratio"),
    "standing carriage": (screw._STANDING, 1e-9, "contract", "below 1e-9 of the greatest ratio"),
    "size of a job file": (job_file.MOST_BYTES, 1_048_576, "contract", "A job file has at most 1 MiB"),
    "size of a design": (design_file.MOST_BYTES, 67_108_864, "contract", "a design, recipe or CSV file 64 MiB"),
    "size of a table": (text.LARGEST_FILE, 4_000_000, "contract", "a table of a drive 4 000 000 bytes"),
    "rows of a CSV": (cam_rows.FEWEST_ROWS, 4, "contract", "4 rows or more"),
    "cycle of a CSV": (profile_files._ROUNDING, 1e-6, "contract", "one cycle of the job to a millionth of the"),
    "rows of a trace, least": (quality.FEWEST_ROWS, 200, "contract", "200 to 10 000 rows"),
    "rows of a trace, most": (trace_csv.MOST_ROWS, 10_000, "contract", "200 to 10 000 rows"),
    "pieces of a cut list": (list_file.MOST_PIECES, 200_000, "contract", "at most 200 000 pieces of 300 different gaps"),
    "gaps of a cut list": (list_checks.MOST_CAMS, 300, "contract", "at most 200 000 pieces of 300 different gaps"),
    "longest cut": (machine.LONGEST, 1000, "contract", "at most 1000 times as long as its sync zone"),
    "longest cut of a crank": (crank_slider._STROKES, 100, "contract", "of a crank at most 100 times its stroke"),
    "size of a cut list": (list_file.MOST_BYTES, 33_554_432, "contract", "and 32 MiB; its servos"),
    "samples of a cut list": (list_checks.MOST_SAMPLES, 300_000_000, "contract", "at most 3e8 samples"),
    "gentlest ramp": (list_checks.LEAST, 1e-6, "contract", "ramps with 1e-6 to 10 000 m/s²"),
    "hardest ramp": (line_plan.HARDEST, 1e4, "contract", "ramps with 1e-6 to 10 000 m/s²"),
    "rows of a recorded run": (recorded_run._MOST_ROWS, 200_000, "contract", "up to 200 000 rows"),
    "cuts in one table": (knots._MOST_CUTS, 24, "targets", "several cuts (up to 24)"),
    "step of a trace": (trace_csv._UNEQUAL, 0.01, "contract", "equally spaced to 1 % of their step"),
    "length of a trace": (quality.SHORTEST, 0.3, "contract", "over 0.3 s at least"),
    "scale of a trace": (quality._SCALE, 8.0, "contract", "more than 8 times as far as the command or less than an 8th"),
    "fit of a trace": (identification._WORST_FIT, 0.5, "contract", "a fit below 0.5"),
    "confidence": (fit.CONFIDENCE, 1.96, "contract", "95 % confidence"),
    "bandwidth": (fit.RANGES["bandwidth"], (10.0, 3000.0), "contract", "ω 10 to 3000 rad/s"),
    "damping": (fit.RANGES["damping"], (0.1, 3.0), "contract", "ζ 0.1 to 3"),
    "gain": (fit.RANGES["position_gain"], (0.5, 1000.0), "contract", "K 0.5 to 1000 1/s"),
    "sample time": (fit.RANGES["sample_time"], (1e-4, 2e-2), "contract", "ΔT 0.1 to 20 ms"),
    "dead time": (fit.RANGES["dead_time"][1], 0.05, "contract", "dead time up to 50 ms"),
    "shares of the line speed": (lead.SHARES, (0.1, 0.25, 0.5, 1.0), "contract", "(`10`, `25`, `50`, `100`)"),
    "resolution of a figure": (picture_files.PIXELS_PER_INCH, 150, "contract", "PNG (648 pt at 150 pixels an inch,"),
    "width of a figure": (panel.WIDTH, 648, "contract", "PNG (648 pt at 150 pixels an inch,"),
    "interrupted": (INTERRUPTED, 130, "contract", "| 130, 141 | interrupted; the reader of standard output is gone |"),
    "reader gone": (BROKEN_PIPE, 141, "contract", "| 130, 141 | interrupted; the reader of standard output is gone |"),
    "check failed": (CamwrightError.exit_code, 1, "contract", "| 1 | done, but a check failed |"),
    "bad input": (InputError.exit_code, 2, "contract", "| 2 | bad input, or nothing can be written"),
    "extra missing": (MissingExtraError.exit_code, 2, "contract", "| 2 | bad input, or nothing can be written"),
    "infeasible": (InfeasibleError.exit_code, 3, "contract", "| 3 | infeasible"),
    "solver failed": (SolverError.exit_code, 4, "contract", "| 4 | the solver failed on a job that has an answer |"),
    "limit of a table": (rebuilt.ALLOWANCE, 0.01, "targets", "limits (1 % allowed)"),
    "wraps": (rebuilt.LEAST_WRAPS, 3, "targets", "run over three wraps"),
    "position of a table": (Accuracy().position, 1e-6, "targets", "(1 um if left"),
    "ratio of a table": (Accuracy().ratio, 1e-3, "targets", "a thousandth for the ratio"),
    "acceleration of a table": (Accuracy().acceleration, 0.01, "targets", "a hundredth of the peak for the acceleration"),
    "recorded values": (sheet_faults.SAME, 1e-6, "recipes", "must be the recorded values, to 1e-6 of them"),
}  # fmt: skip

CONTROLLERS: dict[str, tuple[int, int | None, str]] = {
    "codesys": (2, 32_767, "float64"),
    "codesys-cambuilder": (2, 32_767, "float64"),
    "twincat": (2, 16_777_216, "float64"),
    "twincat-table": (2, 16_777_216, "float64"),
    "twincat-cnc": (2, 361, "int32"),
    "s7-1500t": (2, 51, "float64"),
    "s7-1500t-points": (2, 10_000, "float64"),
    "logix": (2, None, "float32"),
    "schneider-asc": (2, None, "float64"),
    "pacdrive": (2, 33, "float64"),
    "br": (2, 130, "float32"),
    "kollmorgen-kas": (5, None, "float64"),
    "sew": (2, 64, "float64"),
    "lenze": (2, None, "float64"),
    "technosoft": (2, 8192, "int32"),
    "trio": (2, 16_000, "int32"),
    "csv": (4, 32_767, "float64"),
}
"""Fewest and most points of each target, ``None`` where no limit is documented, and its numbers."""


@cache
def document(name: str) -> str:
    """Text of a document, on one line, so that a promise may run over the end of one."""
    return " ".join((DOCS / f"{name}.md").read_text(encoding="utf-8").split())


@pytest.mark.parametrize("name", NUMBERS)
def test_the_code_goes_by_the_promised_number(name: str) -> None:
    found, promised, where, words = NUMBERS[name]
    assert found == promised
    assert words in document(where), f"docs/{where}.md no longer says: {words}"


def test_the_targets_take_the_points_that_are_promised() -> None:
    assert {
        name: (target.min_points, target.max_points, target.number_format) for name, target in TARGETS.items()
    } == CONTROLLERS


@pytest.mark.parametrize("name", CONTROLLERS)
def test_the_document_says_so(name: str) -> None:
    least, most, numbers = CONTROLLERS[name]
    (row,) = re.findall(rf"^\| \[`{name}`\].*$", (DOCS / "targets.md").read_text(encoding="utf-8"), re.MULTILINE)
    points, kept = (cell.strip() for cell in row.split("|")[3:5])
    assert points == ("no limit documented" if most is None else f"{least} to {most}")
    assert kept == numbers


def test_no_target_is_said_to_have_been_tested_on_a_controller() -> None:
    assert "No target was tested on a controller" in document("targets")
    assert not any(target.tested_on_controller for target in TARGETS.values())


def test_units_of_a_table_are_the_promised_ones() -> None:
    cut = Cut(0.6, 1.0, 0.2, 0.04, 0.0, 1e-4)
    assert "m, mm, um, in, deg, rev, or a quantity like `0.5 um`" in document("targets")
    for name, master, slave in (
        ("m", 1.0, 1.0),
        ("mm", 0.001, 0.001),
        ("um", 1e-6, 1e-6),
        ("in", 0.0254, 0.0254),
        ("deg", 0.6 / 360, 0.4 / 360),  # 1/360 of the cycle, and of the drum
        ("rev", 0.6, 0.4),
        ("0.5 um", 0.5e-6, 0.5e-6),
    ):
        units = parse_units(f"{name},{name}", Task(RotaryKnife(0.4), cut, FREE))
        assert (units.master.size, units.slave.size) == pytest.approx((master, slave), rel=1e-15)


def test_shares_are_the_keys_of_the_answer() -> None:
    errors = [lead.LengthError(share, share, 0.0, 0.0, 0.0) for share in lead.SHARES]
    answer = lead_answer(load_job(), errors)
    for key in ("length_error_mm", "length_error_with_lead_mm", "length_variation_mm"):
        assert list(answer[key]) == ["10", "25", "50", "100"]
