"""The table of commands: what each does, for which task, and a call that works."""

from __future__ import annotations

from dataclasses import dataclass

START, CAM, PRODUCTION, DRIVE, SHEET, SERVO, BENDER = (
    "Start",
    "Cams",
    "Production",
    "Tables for drives",
    "Recipes for commissioning",
    "The servo",
    "The die-rule bender",
)
"""Tasks, as the help groups the commands."""


@dataclass(frozen=True)
class Command:
    """A command of the command line; its module is ``camwright.cli.<name>``.

    Parameters
    ----------
    does
        What it does, in a sentence.
    task
        What it is for: a heading of the help.
    example
        A call of it.
    """

    does: str
    task: str
    example: str


COMMANDS: dict[str, Command] = {
    "new": Command(
        "Start a job: a commented file with every key, your numbers in it, an example's where you give none.",
        START,
        'camwright new rotary_knife --circumference "500 mm" --length "700 mm" --name board',
    ),
    "examples": Command("List the example jobs, or write one as a file.", START, "camwright examples flying-saw"),
    "keys": Command(
        "List the keys of a job file: what each takes, its default, what it means and what uses it.",
        START,
        "camwright keys position_gain",
    ),
    "schema": Command(
        "Print the JSON Schema of job files, of design.json or of recipe.json, for editors and other programs.",
        START,
        "camwright schema job > job.schema.json",
    ),
    "check": Command("Read a job file and say whether it has faults.", START, "camwright check board.toml"),
    "design": Command(
        "Design the optimal cam of a job; write the design, the cam table and the figures.",
        CAM,
        "camwright design board.toml",
    ),
    "compare": Command(
        "Compare the optimal cam with the linear return and the standard motion laws.",
        CAM,
        "camwright compare board.toml --objectives",
    ),
    "workbench": Command(
        "Open the workbench: see the cam, drag it, prove it, in the browser of this machine.",
        CAM,
        "camwright workbench board.toml",
    ),
    "limits": Command(
        "Say how fast and how short the machine of a job can cut, and which limit binds.",
        CAM,
        "camwright limits board.toml",
    ),
    "ramps": Command(
        "Design how the machine starts into the running line, stops out of it, and makes one piece on demand.",
        CAM,
        'camwright ramps board.toml --latency "10 ms"',
    ),
    "marks": Command(
        "Say how early and how late a print mark may come, by what the controller does, and how to tune its loop.",
        CAM,
        "camwright marks board.toml --delay 2",
    ),
    "envelope": Command(
        "Map which cut lengths and line speeds are possible, with which return, and what binds.",
        CAM,
        "camwright envelope board.toml --points 15",
    ),
    "validate": Command(
        "Judge a cam, camwright's or anyone's, by a job's machine, limits and servo.",
        CAM,
        "camwright validate cam.csv --job board.toml",
    ),
    "quick": Command(
        "Make the patent's quintic cam of a rotary cross-cutter from three lengths.",
        CAM,
        "camwright quick --circumference 400mm --sync 200mm --length 900mm",
    ),
    "cutlist": Command(
        "Work a cut list out: cams, changes, the fastest line speed, tables whose seams are run, and a table for the PLC.",
        PRODUCTION,
        "camwright cutlist board.toml order.csv --line-acceleration '1 m/s^2'",
    ),
    "simulate": Command(
        "Simulate a shift: each piece's length and sync error, with the optimised cams and with linear returns.",
        PRODUCTION,
        "camwright simulate board.toml --list order.csv --line-acceleration '1 m/s^2' --slip 0.0002",
    ),
    "family": Command(
        "Cover a job's line speeds with several cams, as few as are found, and lead from each to the next in the sync zone.",
        PRODUCTION,
        "camwright family short-cut.toml --overlap 5%",
    ),
    "export": Command(
        "Write a design for drives; every file is read back and judged as the drive will run it.",
        DRIVE,
        "camwright export out/board/design.json --to codesys,logix",
    ),
    "audit": Command(
        "Judge a cam that runs today as its drive runs it, and set it beside the optimum of the same job.",
        DRIVE,
        "camwright audit running.csv --job board.toml",
    ),
    "targets": Command(
        "List the targets: limits, interpolation, evidence, and what was never tested on a controller.",
        DRIVE,
        "camwright targets",
    ),
    "recipe": Command(
        "Make the recipe of a product: a folder with all that is needed at the machine.",
        SHEET,
        "camwright recipe board.toml --targets codesys --revision B",
    ),
    "verify": Command(
        "Prove that the folder of a recipe or a family is what was written, and its sheet the cams'; of a recipe the tables, too.",
        SHEET,
        "camwright verify recipe",
    ),
    "book": Command(
        "Design every combination of cut lengths, line speeds and objectives, check it, write its tables, and an index.",
        SHEET,
        "camwright book board.toml --length 400:1200:100 --line-speed 40:80:20 --targets codesys",
    ),
    "identify": Command(
        "Find the servo's parameters from a recorded trace.", SERVO, "camwright identify trace.csv --out servo.toml"
    ),
    "trace": Command(
        "Lay a recorded run over its design: sync error of each cut, lengths, and whether it is offset, drift or scatter.",
        SERVO,
        "camwright trace run.csv --job board.toml",
    ),
    "bend": Command(
        "Turn a drawing of die lines into proved NC programs of a rule bender.", BENDER, "camwright bend carton.dxf"
    ),
}
"""The commands, in the order of the help."""
