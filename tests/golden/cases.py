"""The cases of the golden run: what each command is asked."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from inputs import OBJECTIVES, aware_jobs, faulty_jobs, infeasible_jobs, other_jobs

AUDITED = ("codesys.st", "Cam.L5X", "cam.csv", "twincat_table.st", "lcamhdl.st")
"""Ends of the names of the tables that are audited for every example."""

AUDITED_ONCE = (
    "asc.txt", "br.st", "cambuilder.st", "isg.txt", "kas.csv", "lenze.txt", "pacdrive.st", "sew.txt", "technosoft.txt",
    "to_cam.st", "trio.bas", "trio.txt", "twincat.st",
)  # fmt: skip
"""The other tables, audited for the paper's job only."""

BOOKS = {
    "chasing-shear": ("900:950:50", "20:30:10"),
    "cross-cutter": ("900:920:20", "50:60:10"),
    "flying-saw": ("3000:3100:100", "30:40:10"),
    "paper-600": ("600:620:20", "70:80:10"),
    "short-cut": ("267:270:3", "70:80:10"),
    "thick-product": ("500:510:10", "20:30:10"),
}
"""Cut lengths (mm) and line speeds (m/min) of the books; an example that is not here gets none."""

SUBCOMMANDS = (
    "cutlist", "simulate", "family",
    "new", "examples", "keys", "schema",
    "design", "compare", "limits", "ramps", "marks", "validate", "check", "quick", "envelope", "identify", "trace", "book",
    "export", "audit", "targets",
    "recipe", "verify", "bend", "workbench",
)  # fmt: skip

Prepare = Callable[[Path], None]


@dataclass(frozen=True)
class Case:
    """One run of the command line.

    Parameters
    ----------
    name
        Names the case in the record.
    arguments
        What follows the command's name.
    needs
        Cases whose files this one reads.
    slow
        Whether ``--fast`` leaves it out.
    prepare
        What is done in the scratch directory before.
    """

    name: str
    arguments: tuple[str, ...]
    needs: tuple[str, ...] = ()
    slow: bool = False
    prepare: Prepare | None = None


def example_cases(example: str) -> Iterator[Case]:
    """List what is asked about each example."""
    job, runs = f"examples/{example}.toml", f"runs/{example}"
    stem = example.replace("-", "_")
    design, made = f"{example}/design", f"{runs}/design/design.json"

    def case(name: str, *arguments: str, needs: Sequence[str] = (), slow: bool = False) -> Case:
        return Case(f"{example}/{name}", (*arguments, "--json"), tuple(f"{example}/{need}" for need in needs), slow)

    def out(name: str) -> tuple[str, str]:
        return "--out", f"{runs}/{name}"

    yield case("check", "check", job)
    yield case("design", "design", job, *out("design"))
    yield case("design-brief", "design", job, "--brief", *out("design-brief"), slow=example == "short-cut")
    for name in OBJECTIVES:
        changed = f"jobs/objective/{example}--{name}.toml"
        yield case(f"objective-{name}", "design", changed, "--no-figures", *out(f"objective-{name}"))
    yield case("compare", "compare", job, *out("compare"))
    yield case("compare-with", "compare", job, "--with", "linear_return", "--with", "poly_3_4_5", "--no-figures")
    yield case("compare-objectives", "compare", job, "--objectives", *out("compare-objectives"))
    yield case("limits", "limits", job, slow=example == "short-cut")
    yield case("ramps", "ramps", job, *out("ramps"), slow=example == "short-cut")
    yield case("marks", "marks", job, *out("marks"), "--delay", "2", slow=example == "short-cut")
    yield case("family", "family", job, *out("family"), slow=example == "short-cut")
    ramp, order = ("--line-acceleration", "0.2 m/s^2"), "lists/order.csv"
    yield case("cutlist", "cutlist", job, order, *ramp, *out("cutlist"), slow=example == "short-cut")
    yield case(
        "simulate",
        "simulate",
        job,
        "--list",
        order,
        *ramp,
        "--slip",
        "0.0002",
        *out("simulate"),
        slow=example == "short-cut",
    )
    yield case("envelope", "envelope", job, "--points", "3", *out("envelope"))
    yield case("validate-design", "validate", made, "--job", job, needs=["design"])
    yield case("validate-table", "validate", f"{runs}/design/cam.csv", "--job", job, needs=["design"])
    yield case("export", "export", made, "--to", "all", *out("export"), needs=["design"])
    yield case("export-forced", "export", made, "--to", "all", "--force", *out("forced"), needs=["design"])
    yield case("export-again", "export", made, "--to", "all", *out("forced"), needs=["design", "export-forced"])
    yield case("export-options", "export", made, "--to", "codesys,logix,csv,trio", "--points", "200", "--max-error", "10 um",
               "--units", "in,rev", *out("options"), needs=["design"])  # fmt: skip
    ends = (*AUDITED, *AUDITED_ONCE) if example == "paper-600" else AUDITED
    for end in ends:
        table = f"{runs}/export/{stem}_{end}"
        figures = out(f"audit-{end}") if end == "codesys.st" else ("--no-figures",)
        slow = end in (*AUDITED_ONCE, *AUDITED[3:])
        yield case(f"audit-{end}", "audit", table, "--job", job, *figures, needs=["design", "export"], slow=slow)
    for language in ("en", "de", "zh"):
        targets = "all" if language == "de" else "codesys,twincat"
        yield case(f"recipe-{language}", "recipe", made, "--targets", targets, "--language", language, "--note",
                   f"Maß {language}", *out(f"recipe-{language}"), needs=["design"])  # fmt: skip
    yield case("verify", "verify", f"{runs}/recipe-en", needs=["design", "recipe-en"])
    recipes = [f"{runs}/recipe-en", f"{runs}/recipe-de"]
    yield case("recipe-compare", "recipe", "--compare", *recipes, needs=["design", "recipe-en", "recipe-de"])
    if example in BOOKS:
        length, speed = BOOKS[example]
        ranges = ("--length", length, "--line-speed", speed, "--jobs", "1", "--targets", "csv,codesys")
        slow = example == "short-cut"
        yield case("book", "book", job, *ranges, *out("book"), slow=slow)
        yield case("book-resume", "book", job, *ranges, "--resume", *out("book"), needs=["book"], slow=slow)
    if design not in SPOKEN:
        return
    for name, arguments in SPOKEN[design].items():
        needs = (design, f"{example}/recipe-en", f"{example}/recipe-de")
        yield Case(f"{example}/spoken-{name}", arguments, needs, slow=example != "chasing-shear")


SPOKEN: dict[str, dict[str, tuple[str, ...]]] = {
    f"{example}/design": {
        "check": ("check", f"examples/{example}.toml"),
        "design": ("design", f"examples/{example}.toml", "--no-figures"),
        "compare": ("compare", f"examples/{example}.toml", "--no-figures"),
        "compare-objectives": ("compare", f"examples/{example}.toml", "--objectives", "--no-figures"),
        "limits": ("limits", f"examples/{example}.toml"),
        "validate": ("validate", f"runs/{example}/design/cam.csv", "--job", f"examples/{example}.toml"),
        "envelope": ("envelope", f"examples/{example}.toml", "--points", "3", "--no-figures"),
        "export": ("export", f"runs/{example}/design/design.json", "--to", "all"),
        "recipe": (
            "recipe",
            f"runs/{example}/design/design.json",
            "--targets",
            "csv",
            "--out",
            f"runs/{example}/spoken",
        ),
        "recipe-compare": ("recipe", "--compare", f"runs/{example}/recipe-en", f"runs/{example}/recipe-de"),
        "verify": ("verify", f"runs/{example}/recipe-en"),
        "quiet": ("design", f"examples/{example}.toml", "--quiet", "--no-figures"),
    }
    for example in ("paper-600", "chasing-shear", "flying-saw")
}
"""Runs whose text for people is recorded, by the design that they need."""


def aware_cases(examples: dict[str, str]) -> Iterator[Case]:
    """List the servo-aware designs."""
    for name in aware_jobs(examples):
        arguments = ("design", f"jobs/aware/{name}.toml", "--no-figures", "--out", f"runs/aware/{name}", "--json")
        yield Case(f"aware/{name}", arguments, slow="short-cut" in name or "in_sync" in name)
    name = "paper-600--shaped-sync_error"
    yield Case(f"aware-limits/{name}", ("limits", f"jobs/aware/{name}.toml", "--json"), slow=True)
    yield Case(f"aware-figures/{name}", ("design", f"jobs/aware/{name}.toml", "--out", "runs/aware-figures", "--json"))


def other_cases(examples: dict[str, str]) -> Iterator[Case]:
    """List the jobs with keys that no example has."""
    for name in other_jobs(examples):
        job, out = f"jobs/other/{name}.toml", f"runs/other/{name}"
        design = f"other/{name}/design"
        yield Case(design, ("design", job, "--no-figures", "--out", out, "--json"))
        yield Case(f"other/{name}/limits", ("limits", job, "--json"), slow=True)
        yield Case(
            f"other/{name}/validate", ("validate", f"{out}/cam.csv", "--job", job, "--json"), (design,), slow=True
        )
        export = ("export", f"{out}/design.json", "--to", "all", "--json")
        yield Case(f"other/{name}/export", export, (design,))
        recipe = ("recipe", job, "--targets", "csv", "--out", f"{out}-recipe", "--json")
        yield Case(f"other/{name}/recipe", recipe, slow=True)
    both = ("runs/paper-600/recipe-en", "runs/other/paper--slower-recipe")
    needs = ("paper-600/design", "paper-600/recipe-en", "other/paper--slower/recipe")
    yield Case("other/recipe-compare", ("recipe", "--compare", *both, "--json"), needs, slow=True)
    yield Case("other/recipe-compare-spoken", ("recipe", "--compare", *both), needs, slow=True)


def infeasible_cases(examples: dict[str, str]) -> Iterator[Case]:
    """List the jobs that no motion can do."""
    for name in infeasible_jobs(examples):
        job = f"jobs/infeasible/{name}.toml"
        for command in ("check", "design", "compare"):
            figures = () if command == "check" else ("--no-figures",)
            yield Case(f"infeasible/{name}/{command}", (command, job, *figures, "--json"))
        if name != "short--exact":  # 40 s
            yield Case(f"infeasible/{name}/limits", ("limits", job, "--json"), slow=True)
        yield Case(f"infeasible/{name}/objectives", ("compare", job, "--objectives", "--no-figures", "--json"))
        yield Case(
            f"infeasible/{name}/envelope",
            ("envelope", job, "--points", "2", "--no-figures", "--out", f"runs/infeasible/{name}-envelope", "--json"),
            slow=True,
        )
        recipe = ("recipe", job, "--targets", "csv", "--out", f"runs/infeasible/{name}")
        yield Case(f"infeasible/{name}/recipe", recipe, slow=True)
        yield Case(f"infeasible/{name}/validate", ("validate", "cams/plain.csv", "--job", job, "--json"), slow=True)
    book = ("book", "jobs/infeasible/paper--short.toml", "--length", "150:350:100", "--line-speed", "80", "--jobs", "1")
    yield Case("infeasible/book", (*book, "--out", "runs/infeasible/book", "--json"))


def faulty_cases(examples: dict[str, str]) -> Iterator[Case]:
    """List faulty job files."""
    for name in faulty_jobs(examples):
        job = f"jobs/faulty/{name}.toml"
        yield Case(f"faulty/{name}/check", ("check", job, "--json"))
        yield Case(f"faulty/{name}/design", ("design", job, "--no-figures", "--out", f"runs/faulty/{name}"), slow=True)


def damage(source: str, target: str, file: str, change: Callable[[bytes], bytes]) -> Prepare:
    """Copy a folder and change a file of the copy."""

    def prepare(scratch: Path) -> None:
        shutil.rmtree(scratch / target, ignore_errors=True)
        shutil.copytree(scratch / source, scratch / target)
        path = scratch / target / file
        path.write_bytes(change(path.read_bytes()))

    return prepare


def misuse_cases() -> Iterator[Case]:
    """List wrong uses of the commands."""
    job, made = "examples/paper-600.toml", "runs/paper-600/design/design.json"
    needs, recipe = ("paper-600/design",), ("paper-600/design", "paper-600/recipe-en")
    wrong: dict[str, tuple[str, ...]] = {
        "nothing": (),
        "unknown-command": ("desgin", job),
        "unknown-option": ("design", job, "--fast"),
        "missing-argument": ("check",),
        "missing-file": ("check", "jobs/none.toml", "--json"),
        "directory": ("check", "jobs", "--json"),
        "unknown-law": ("compare", job, "--with", "quintic", "--no-figures", "--json"),
        "law-and-objectives": ("compare", job, "--objectives", "--with", "poly_3_4_5", "--json"),
        "laws-of-others": ("compare", job, "--with", "crank_tabulated", "--json"),
        "cutlist-no-ramp": ("cutlist", job, "lists/order.csv", "--json"),
        "cutlist-faulty": ("cutlist", job, "lists/faulty.csv", "--line-acceleration", "1 m/s^2", "--json"),
        "simulate-two-lines": (
            "simulate", job, "--list", "lists/order.csv", "--line", "lists/line.csv", "--line-acceleration", "1 m/s^2", "--json"
        ),
        "envelope-points": ("envelope", job, "--points", "1", "--json"),
        "validate-no-file": ("validate", "cams/none.csv", "--job", job, "--json"),
        "validate-plain": ("validate", "cams/plain.csv", "--job", job, "--json"),
        "validate-plain-spoken": ("validate", "cams/plain.csv", "--job", job),
        "validate-no-y": ("validate", "cams/no-y.csv", "--job", job, "--json"),
        "validate-other-length": ("validate", "cams/other-length.csv", "--job", job, "--json"),
        "validate-nonsense": ("validate", "cams/nonsense.st", "--job", job, "--json"),
        "export-job": ("export", job, "--to", "csv", "--json"),
        "audit-plain": ("audit", "cams/columns.txt", "--job", job, "--no-figures", "--json"),
        "audit-plain-mm": ("audit", "cams/columns.txt", "--job", job, "--units", "mm,mm", "--no-figures", "--json"),
        "audit-plain-named": ("audit", "cams/columns.txt", "--job", job, "--target", "kollmorgen-kas", "--no-figures", "--json"),
        "audit-csv": ("audit", "cams/plain.csv", "--job", job, "--no-figures", "--json"),
        "audit-nonsense": ("audit", "cams/nonsense.st", "--job", job, "--no-figures", "--json"),
        "audit-no-target": ("audit", "cams/plain.csv", "--job", job, "--target", "none", "--json"),
        "recipe-nothing": ("recipe", "--json"),
        "recipe-table": ("recipe", "cams/plain.csv", "--targets", "csv", "--out", "runs/misuse/recipe", "--json"),
        "recipe-language": ("recipe", job, "--targets", "csv", "--out", "runs/misuse/recipe", "--language", "fr", "--json"),
        "recipe-over-others": ("recipe", job, "--targets", "csv", "--out", "cams", "--json"),
        "verify-none": ("verify", "cams", "--json"),
        "quick-long-zone": ("quick", "--circumference", "400 mm", "--sync", "450 mm", "--length", "600 mm", "--json"),
        "quick-no-unit": ("quick", "--circumference", "400", "--sync", "200", "--length", "600", "--json"),
        "book-range": ("book", job, "--length", "600:500:10", "--line-speed", "80", "--json"),
        "book-objective": ("book", job, "--length", "600", "--line-speed", "80", "--objective", "rms_torque", "--json"),
        "book-targets": ("book", job, "--length", "600", "--line-speed", "80", "--targets", "none", "--json"),
        "bend-nothing": ("bend", "--json"),
        "bend-both": ("bend", "drawings/step.dxf", "--calibrate", "benders/bends.csv", "--json"),
        "bend-start": ("bend", "drawings/step.dxf", "--start", "1;2", "--json"),
        "bend-layer": ("bend", "drawings/step.dxf", "--layer", "NONE", "--no-figures", "--json"),
        "bend-job": ("bend", "drawings/step.dxf", "--job", "benders/typo.toml", "--no-figures", "--json"),
        "bend-calibrate": ("bend", "--calibrate", "benders/bends.csv", "--json"),
        "bend-no-file": ("bend", "drawings/none.dxf", "--json"),
    }  # fmt: skip
    for name, arguments in wrong.items():
        yield Case(f"misuse/{name}", arguments)
    yield Case("misuse/export-target", ("export", made, "--to", "siemens", "--json"), needs)
    yield Case("misuse/export-units", ("export", made, "--to", "csv", "--units", "mm", "--json"), needs)
    yield Case("misuse/export-points", ("export", made, "--to", "sew,codesys", "--points", "100000", "--json"), needs)
    tampered = damage(
        "runs/paper-600/design", "runs/misuse/design", "design.json", lambda data: data.replace(b"600 mm", b"610 mm")
    )
    arguments = ("validate", "runs/misuse/design/design.json", "--job", job, "--json")
    yield Case("misuse/validate-tampered", arguments, needs, prepare=tampered)
    for name, file, change in (
        ("table", "tables/paper_600_codesys.st", lambda data: data.replace(b"0", b"1", 1)),
        ("recipe", "recipe.json", lambda data: data.replace(b"600", b"601", 1)),
        ("manifest", "manifest.json", lambda data: data[:-20]),
    ):
        target = f"runs/misuse/recipe-{name}"
        yield Case(f"misuse/verify-{name}", ("verify", target, "--json"), recipe,
                   prepare=damage("runs/paper-600/recipe-en", target, file, change))  # fmt: skip
        yield Case(f"misuse/recipe-compare-{name}", ("recipe", "--compare", "runs/paper-600/recipe-en", target, "--json"),
                   (*recipe, f"misuse/verify-{name}"))  # fmt: skip


def single_cases() -> Iterator[Case]:
    """List the commands that are about no example, and what they say of themselves."""
    yield Case("version", ("--version",))
    yield Case("help", ("--help",))
    for name in SUBCOMMANDS:
        yield Case(f"help/{name}", (name, "--help"))
    yield Case("design-bundled", ("design", "--no-figures", "--json"))
    yield Case("targets", ("targets", "--json"))
    for of in ("job", "design", "recipe"):
        yield Case(f"schema/{of}", ("schema", of))
    yield Case("keys", ("keys", "--json"))
    yield Case("keys-length", ("keys", "length"))
    yield Case("keys-unknown", ("keys", "lenght", "--json"))
    yield Case("examples", ("examples", "--json"))
    yield Case("examples-write", ("examples", "paper-600", "--out", "runs/examples", "--json"))
    for machine in ("rotary_knife", "linear_carriage", "crank_slider"):
        yield Case(f"new/{machine}", ("new", machine, "--out", f"runs/new/{machine}.toml", "--json"))
    yield Case("new/length", ("new", "rotary_knife", "--length", "700 mm", "--out", "runs/new/length.toml", "--json"))
    yield Case("new/no-unit", ("new", "rotary_knife", "--length", "700", "--out", "runs/new/no-unit.toml", "--json"))
    # it listens until it is ended, so only what it refuses can be asked
    yield Case("workbench-no-job", ("workbench", "nowhere.toml", "--no-browser", "--json"))
    yield Case("targets-spoken", ("targets",))
    for length in ("300 mm", "600 mm", "628.6 mm", "900 mm", "40 in"):
        lengths = ("--circumference", "400 mm", "--sync", "200 mm", "--length", length)
        name = length.replace(" ", "-")
        yield Case(f"quick/{name}", ("quick", *lengths, "--out", f"runs/quick/{name}", "--json"))
    yield Case("quick/spoken", ("quick", "--circumference", "400mm", "--sync", "200mm", "--length", "900mm"))
    objectives = ("--objective", "rms_jerk", "--objective", "peak_jerk")
    book = (
        "book",
        "examples/paper-600.toml",
        "--length",
        "250:650:200",
        "--line-speed",
        "60:120:60",
        *objectives,
        "--targets",
        "all",
    )
    yield Case("book-two-objectives", (*book, "--jobs", "2", "--out", "runs/book", "--json"))
    yield Case("book-spoken", (*book, "--resume", "--out", "runs/book"), ("book-two-objectives",))


def identify_cases() -> Iterator[Case]:
    """List the traces."""
    for name in ("assumed", "fitted", "turning", "gap", "short", "no-unit", "no-number", "stands", "none"):
        yield Case(
            f"identify/{name}", ("identify", f"traces/{name}.csv", "--out", f"runs/identify/{name}.toml", "--json")
        )
    yield Case("identify/given", ("identify", "traces/fitted.csv", "--velocity-feedforward", "0.9", "--json"))
    yield Case("identify/given-wrong", ("identify", "traces/fitted.csv", "--velocity-feedforward", "2", "--json"))
    yield Case("identify/spoken", ("identify", "traces/assumed.csv"))
    yield Case("identify/directory", ("identify", "traces/assumed.csv", "--out", "runs"))


def trace_cases() -> Iterator[Case]:
    """List the recorded runs."""
    judged = ("--job", "examples/paper-600.toml", "--design", "traces/quintic.csv")
    yield Case("trace/run", ("trace", "traces/run.csv", *judged, "--out", "runs/trace", "--json"))
    yield Case("trace/without-master", ("trace", "traces/run-without-master.csv", *judged, "--no-figures", "--json"))
    yield Case("trace/spoken", ("trace", "traces/run.csv", *judged, "--no-figures"))
    yield Case("trace/other-cam", ("trace", "traces/assumed.csv", *judged, "--no-figures", "--json"))


def bend_cases() -> Iterator[Case]:
    """List what the bender is asked."""
    carton, arcs = "examples/bender/carton.dxf", "examples/bender/paper-arcs.toml"
    tests = "examples/bender/measurements.csv"
    asked: dict[str, tuple[str, ...]] = {
        "carton": (carton,),
        "carton-arcs": (carton, "--job", arcs),
        "carton-layer": (carton, "--layer", "CUT", "--no-figures"),
        "carton-notes": (carton, "--layer", "NOTES", "--no-figures"),
        "carton-reverse": (carton, "--start", "10,0", "--reverse", "--no-figures"),
        "step": ("drawings/step.dxf",),
        "square": ("drawings/square.dxf", "--no-figures"),
        "crossing": ("drawings/crossing.dxf", "--no-figures"),
        "no-unit": ("drawings/no-unit.dxf", "--no-figures"),
        "no-length": ("drawings/no-length.dxf", "--no-figures"),
        "nothing": ("drawings/nothing.dxf", "--no-figures"),
        "nonsense": ("drawings/nonsense.dxf", "--no-figures"),
        "calibrate": ("--calibrate", tests),
        "calibrate-arcs": ("--calibrate", tests, "--job", arcs),
    }
    for name, arguments in asked.items():
        yield Case(f"bend/{name}", ("bend", *arguments, "--out", f"runs/bend/{name}", "--json"))
    yield Case("bend/spoken", ("bend", carton, "--no-figures", "--out", "runs/bend/spoken"))
    yield Case("bend/calibrate-spoken", ("bend", "--calibrate", tests, "--out", "runs/bend/calibrate-spoken"))


def all_cases(examples: dict[str, str]) -> list[Case]:
    """List all cases, each after those that it needs."""
    cases: list[Case] = [*single_cases()]
    for example in examples:
        cases += example_cases(example)
    cases += aware_cases(examples)
    cases += other_cases(examples)
    cases += infeasible_cases(examples)
    cases += faulty_cases(examples)
    cases += misuse_cases()
    cases += identify_cases()
    cases += trace_cases()
    cases += bend_cases()
    known: set[str] = set()
    for case in cases:
        if case.name in known or not known.issuperset(case.needs):
            raise SystemExit(f"golden: {case.name} is there twice or comes before what it needs")
        known.add(case.name)
    return cases
