"""Makes ``docs/targets.md`` from the registry and files written here: ``python tests/profiles/tables/targets_document.py``."""

from __future__ import annotations

import re
from pathlib import Path

from knives import chosen, written

from camwright.profiles.tables.target import SAFETY_NOTE, Target
from camwright.profiles.tables.targets import TARGETS

DOCUMENT = Path(__file__).parents[3] / "docs" / "targets.md"

_HEAD = f"""# Targets

`camwright export DESIGN --to NAMES` writes a design for drives, `camwright audit FILE --job JOB` reads what they run
today, `camwright targets` lists what is known. No target was tested on a controller: layouts and interpolations come
from the sources named below, and what was inferred is said.

## What every export does

Every file is read back by the target's own reader, the motion is rebuilt as the drive interpolates it, in its number
format, run over three wraps and judged: limits (1 % allowed), sync zone against the sync tolerance, closure, stroke,
reversal, servo. The answer, with all errors and checks, stands in `report.json` beside the tables. A table that fails is
not released unless `--force` is given, and then says so in its head (`NOT RELEASED: …`); either way the exit code is 1.
Where a table is withheld, an older one of that target and product in the same folder is renamed: its name then ends with
`.withheld-old`, so that nobody loads it for the new one. `set_aside` in the report and in `--json` says which.
`--to all` leaves out targets that cannot take the cam and says why; a target that was named is an error then (exit
code 2).

The points are as few as keep the rebuilt motion within the error asked for: `--max-error` for the position (1 um if left
out; for a crank that of the carriage), a thousandth for the ratio, a hundredth of the peak for the acceleration. The
ends of the sync zone always are points, unless a target's points must be evenly spaced. Where a target cannot come so
near, the nearest table is written and marked with `*`. `--points N` asks for a number of points.

`--units M,S` states the units of master and slave: m, mm, um, in, deg, rev, or a quantity like `0.5 um` for a count of
an encoder, or the counts of a turn, `36000/rev`.
A degree of the master is 1/360 of the cycle; a degree of the slave is one of the drum or the crank (of the
motor for a carriage). Each target obeys, or refuses with the reason: `csv` takes lengths by name, `twincat-cnc` has units of
its own. All files state their units.

`trio` and `technosoft` store whole counts. Asked for `--units mm,36000/rev` or `--units 'mm,9.25 um'` they are counts of
your encoder: the last value of a cycle that closes on whole counts is that count, the link distance of CAMBOX is the period
in the master's unit, and Technosoft's master positions are whole counts of it. Where blades do not divide the counts of a
turn, the table holds several cuts (up to 24), after which it closes exactly. What the slave lacks of the pitch in each cut
stands in the report (`drift_per_cut`, `cuts`); added up over a run of 10 000 cuts it must stay within the sync tolerance, or
`closure` fails. Limits of acceleration and jerk may be exceeded by what rounding to counts makes of their differences (two
counts over the sample time squared, four over its cube); the check says how much. Without `--units` a count is 0.1 um, or so
near to it that the cycle closes, and the axis must be scaled so. `[output] counts` in the job says the same as `--units` for
these targets alone, for `export`, `recipe` and `book`.

## Tables that know the line speed

`camwright export DESIGN --to twincat --speed-tables` writes tables of position, ratio and curvature, and of the curvature's
change where these do not do, which the controller adds, each times a power of the line speed. Their sum is another command at
every line speed, which follows the servo: the simulated axis is 0.0021 mm off at most at 300 mm and up to 80 m/min on the
published knife and servo, where the position alone is 0.75 mm off; its limits allow 69 m/min there
([theory](theory.md#8-servo-aware-design)). The position is a smooth return, softer at its ends and steeper in its middle than the
design's. The files are read back and their sum is judged at 21 line speeds, servo and limits included; where one fails none is
written, and the answer says up to which speed all pass.

Only targets with evidence for cams that are scaled while they run take part: `twincat`. A Trio controller can add the moves of
other axes (ADDAX: technical reference manual), but the table multiplier of CAMBOX is read when the command is loaded, so a cut
would run with the speed at its beginning; it is left out. PLCopen's MC_CombineAxes adds axes, not scaled cams. Logix refuses a
second MAPC on a slave that is camming (error 23, illegal dynamic change) unless it waits for the end of the first (MOTION-RM002H,
pages 171 to 181). CODESYS superimposes one distance on a cam (MC_MoveSuperImposed), and says of SMC_GetCamSlaveSetPosition, which
reads a scaled cam, that it must not be called in every cycle (help of SM3_Basic). The old S7-300 technology CPU laid one cam over
another (MC_CamInSuperImposed, A5E00251798), where two or three are needed; for the S7-1500T, which the target `siemens` writes for, none
such was found, nor for the others.

## Auditing a cam

`camwright audit FILE --job JOB` reads a cam in the layout of any target, or columns of numbers as CSV, rebuilds it as its
drive does, judges it, and sets it beside the optimum of the same job: a table, `audit.svg` and `audit.png`. For files
that state no units `--units` tells them, with `cycle` as the master's unit where it is counted in steps of the table, and
quantities like `0.5 um` or `0.0001 deg`; without it the table's period is taken for the cut length and its advance for the
pitch. The cycle is begun where the cam fits the job's sync zone best, wherever the file begins, and a note says where.
A shaped command is put where its axis fits the shear zone; for one line speed alone that leaves its place open by millimetres, so the
file's own zero is kept where the axis is in tolerance, and a note says how far it is open.
Every assumption is a note, one sentence, with the option that gives the truth. Where a layout has no room for a head, the text that
camwright writes beside the table tells its units. Tables that run once (of `ramps`, `cutlist`, `family`) and those that the controller
adds (`--speed-tables`) say so in their heads, and are refused by that: an audit judges cycles. Tables of counts are judged as when they
were exported: closure over a run of 10 000 cuts, and beyond what rounding to counts makes of differences.

Values are taken as stored: reals stay reals, whole numbers are made only where camwright writes. What files leave out or
have twice is put right and told: a slave that is counted modulo its pitch or its turn is unwrapped (a wrapped last row
too), one that runs backwards has its sign turned, a missing last row is added and one too many left out, a master that turns over or rows
that run backwards along it are put in order. A kernel's table
that leaves out where its cycle ends takes the pitch of the job if it runs on to that, else `--travel '400 mm'` says it.
An L5X with a CAM and the CAM_PROFILE computed from it is judged by the profile; a CAM without slopes asks for
`--slopes A,B`; a profile that was never calculated, and a tag whose two copies differ, are refused. TwinCAT sources
(`.TcPOU`, `.TcGVL`) and whole Trio programs (`TABLE`, `BASE`, comments, variables and
their sums, `FOR` loops, lines that go on behind `_`, `CAMBOX` with link distance and multiplier) are read;
motion functions of TwinCAT are POLYNOM1, POLYNOM3, POLYNOM5 and POLYNOM5_MM.
A number in structured text that is no plain number is refused with its line.

Some layouts are read and not written: `galil`, the ECAM table of a Galil program (`EP`, `ET[0]=...`, numbers only; straight lines
between), and `st-arrays`, structured text with one array of master and one of slave positions, as the cam editor Quintic exports
it (a cubic spline is assumed); its CSV is read as columns; and `trio-linked-moves`, a cycle of Trio's `MOVELINK` and `FLEXLINK`
calls: base distance, straight ramps, and those by the curves of the options (sine, powers 5, 7 and 9). That a sine is half a cosine
of the speed follows from the peak accelerations that Trio's reference prints beside a straight ramp's.
Named and refused, with the way out, are TwinCAT's `.xti` items: two searches of public repositories and of Beckhoff's
pages found project items of axes and terminals, but no cam in one, and no description of its elements. The cam
editor's export of a master and a slave position a line and the function blocks' points are read; of its `.tce` files
its help tells no more than the name. Of Omron, Inovance and Delta no layout is known; their points as two columns are
read like anybody's.

Columns of numbers may be separated by commas, semicolons, tabs, bars or blanks, with a decimal point or comma, in quotes,
with `sep=;`, with an index column, in UTF-8, UTF-16, GBK, Shift JIS, Big5 or code page 1252. Headings may take several lines; units stand
in brackets, behind the name, in a line of their own, or behind each number (one unit a column). Columns are known by words in
English, German, Chinese, Japanese, Italian, French and Spanish. Exponents may be Fortran's (`1.0D-3`), signs those of word
processors and Asian keyboards; comments stand behind `#`, `!`, `//`, or `;` where that does not separate cells. Thousands that
are set apart, units that differ within a column, and numbers that may be one with a decimal comma or two are refused with their
line. One column alone is slave positions at even steps of the master; its unit is written above it or said with
`--units cycle,mm`, and whether the last row ends the cycle is told from the travel. Aerotech's cams (`Number of points`,
`Master Units`) are read as columns.
Velocity and acceleration in whatever unit are scaled to the positions, or left out with a note where they do not belong to
them. Positions that are whole counts of an encoder, or have as many digits each as `%g` writes, are noticed where their rounding
would drown the acceleration: it is taken off (the smoothest positions that miss the counts by no more than rounding does), and the
cam compared by differences. So are master positions of even steps that are rounded: a hundredth of a millimetre of the master is a
hundredth of the slave, too.

Between straight lines the acceleration is unbounded in theory. What the drive is commanded is not: it knows the cam at
its samples only. Such cams are compared, like the optimum beside them, by second and third differences of the positions
at the servo's sample time: the greatest over all sampling phases, and the root mean square over the return zone. The
answer then says `"saving_by": "differences at the sample time"`. A shorter sample time shows more of the corners.

> {SAFETY_NOTE}

## Files of others that were tried

Public files, read as a user would, and not kept here. What was refused was refused with its reason and a way out.

Tables:

- LuBieML/FlyingShear, twenty programs of Trio's reference: CAMBOX 0 and 2, FLEXLINK 0 and 1, MOVELINK 0 to 8, 10
  and 11 are read. CAMBOX 3 fills an address twice, CAMBOX 4 leaves some out, MOVELINK 9 and 12 use a variable
  without a number: refused. CAMBOX 1 has no table.
- moaz-ahmed/CAM-Profile, a modified sine in a workbook, is refused as one; as CSV it has two columns of the master,
  `Angle_deg` and `x_norm`: one is to be left out.
- Aerotech's cams, as three public programs write them, are read as columns.
- Teknic-Brendan/ClearPath-Cam-Profiles-With-Arduino (a program in C), simatic-ax/lcamhdl and MCCodeAI/MCCoder
  (calls that build a cam) are not recognised: no points are in them.

Recordings, none of which tells a servo:

- maido-39/free-dog-sdk-dev, twelve joints of a walking robot with command and actual position. `--columns` takes
  one; by its own clock rows are missing, by the nominal one the command stands in stairs of 20 ms.
- mmaag01/Actuator-Net, a geared actuator at 1 kHz, 82 files: two rows of one time. With even times put in, its
  parameters are not told: its loop is one of torque.
- joelxue123/ODrive-fw-v0.5.1-for_work, sines of 1 to 5 Hz at 1 kHz: read with `--columns "13 [ms],3 [rad],6
  [rad]"`; the actual position runs ahead of the sine, by the resonance of a loop without a cascade.
- gkeiel/dc_motor_position_control, a motor under PID, nine files without times: with 2 ms a row put in, no servo is
  told by positions of 3.5 degrees a count.
- aniketgiri96/Robstride_Control_Gui, six joints at 50 Hz: read with `--columns`; no parameter is told at 20 ms a
  row.
- Laiurasol/03_CNC (25 files of a milling machine), jesus-mastrogiacomo/ball-and-beam-nonlinear,
  LukeXII/Control_Digital, ryanGT/systemid, friessssss/C: no times in them.
- CagtayFabry/pytcs (eleven exports of TwinCAT Scope), qblc7/bachelorproject (RTDE): no command beside the actual
  position. M-TRCH/BLEGS_Actuator-Unit, koyomimono/OMUNI: no actual position of an axis.
- moelyaakoubi/GUI-RTDE, six axes of a robot at rest: `--columns` is asked for.

Drawings:

- BrownBear127/open-dieline, six cartons (rte-default, synthetic-all-types, telescope-base, -default, -lid, -liner):
  they have no unit, which is asked for; with it all styles are listed. Their CUT styles bend to 1094, 50, 2896,
  5395, 1852 and 647 mm of rule, lines that stand twice in two of them named.
- mozman/ezdxf: 1_polylines, bin_dxf_r12, hatch_text_box_in_fill, transform_hatch_pattern; LibreCAD/LibreCAD:
  Diode-SCS, alg14, cap3, evd17. All bend; three ask for their unit.

## The targets

The samples are files for a rotary knife: circumference 400 mm, cut length 600 mm, sync zone 200 mm, a jerk-limited
return; master in mm, slave in deg.
"""
_LINES = 30


def _adds(target: Target) -> str:
    """Say how the controller adds scaled cams, where that is known."""
    return f"Adds scaled cams (`--speed-tables`): {target.adds_scaled}\n\n" if target.adds_scaled else ""


def document() -> str:
    """Make the whole document."""
    rows = ["| name | controller | points | numbers | points of the sample | position error of the sample (µm) |"]
    rows.append("|---|---|---|---|---|---|")
    sections = []
    for target in TARGETS.values():
        choice, files = chosen(target.name, "jerk-limited"), written(target.name, "jerk-limited")
        most = "no limit documented" if target.max_points is None else f"{target.min_points} to {target.max_points}"
        error = choice.deviation.position * 1e6
        shown = "below 1e-6" if error < 1e-6 else f"{error:.1g}"
        rows.append(
            f"| [`{target.name}`](#{target.name}) | {target.title} | {most} | {target.number_format} "
            f"| {choice.table.points} | {shown} |"
        )
        steps = "\n".join(f"{k}. {step}" for k, step in enumerate(target.steps, start=1))
        sections.append(
            f"### {target.name}\n\n{target.title}. Between the points: {target.interpolation}.\n\n"
            f"Limits: {most} points, numbers in {target.number_format}{_step(target)}.\n\nTo bring it in:\n\n{steps}\n\n"
            f"Evidence: {target.evidence}\n\n" + _adds(target) + "\n".join(_sample(*item) for item in files.items())
        )
    return _HEAD + "\n" + "\n".join(rows) + "\n\n" + "\n".join(sections)


def _step(target: Target) -> str:
    return f", points at least {target.least_step:.2g} of the period apart" if target.least_step else ""


def _sample(name: str, text: str) -> str:
    lines = [line[:160] + (" …" if len(line) > 160 else "") for line in text.replace("\r\n", "\n").splitlines()]
    if len(lines) > _LINES:
        lines = [*lines[: _LINES - 5], "…", *lines[-4:]]
    return f"`{name}`:\n\n```\n" + "\n".join(re.sub("```", "'''", line) for line in lines) + "\n```\n"


if __name__ == "__main__":
    DOCUMENT.write_text(document(), encoding="utf-8")
