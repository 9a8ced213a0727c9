"""The command ``camwright new``."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from camwright.cli.options import Json, Quiet
from camwright.cli.views.parts import new_text
from camwright.house.files import write_files
from camwright.house.output import Voice
from camwright.jobs.examples import Example, example, examples
from camwright.jobs.job import parse_job
from camwright.jobs.keys import JobKey, job_keys
from camwright.jobs.machine_tables import either_of
from camwright.jobs.template import job_template, values_of
from camwright.profiles.errors import InputError
from camwright.profiles.machines import MACHINES

if TYPE_CHECKING:
    from rich.console import RenderableType


_OPTIONS = {
    "name": "name",
    "circumference": "machine.circumference",
    "diameter": "machine.diameter",
    "stroke": "machine.stroke",
    "crank": "machine.crank",
    "rod": "machine.rod",
    "length": "cut.length",
    "line_speed": "cut.line_speed",
    "sync_zone": "cut.sync_zone",
    "shear_zone": "cut.shear_zone",
    "speed": "limits.speed",
    "acceleration": "limits.acceleration",
    "jerk": "limits.jerk",
    "bandwidth": "servo.bandwidth",
    "damping": "servo.damping",
    "position_gain": "servo.position_gain",
    "sample_time": "servo.sample_time",
    "velocity_feedforward": "servo.velocity_feedforward",
}
"""Keys that have an option of their own."""

_Text = Annotated[str | None, typer.Option(metavar="VALUE", help="As it stands in a job file.", show_default=False)]


def run(
    machine: Annotated[
        str | None, typer.Argument(metavar="[MACHINE]", help="rotary_knife, linear_carriage or crank_slider.")
    ] = None,
    like: Annotated[
        str | None,
        typer.Option("--like", metavar="EXAMPLE", help="Take the values of this example where none is given."),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE", help="The job file; NAME.toml if left out.")
    ] = None,
    name: _Text = None,
    circumference: _Text = None,
    diameter: _Text = None,
    stroke: _Text = None,
    crank: _Text = None,
    rod: _Text = None,
    length: _Text = None,
    line_speed: _Text = None,
    sync_zone: _Text = None,
    shear_zone: _Text = None,
    speed: _Text = None,
    acceleration: _Text = None,
    jerk: _Text = None,
    bandwidth: _Text = None,
    damping: _Text = None,
    position_gain: _Text = None,
    sample_time: _Text = None,
    velocity_feedforward: _Text = None,
    others: Annotated[
        list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help='Any key, e.g. "cut.sync_tolerance=0.2 mm".')
    ] = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Start a job: a commented file with every key, your numbers in it, an example's where you give none."""
    options = locals()
    given = {place: _value(options[option]) for option, place in _OPTIONS.items() if options[option] is not None}
    given |= dict(_setting(text) for text in others or ())
    base = _base(machine, like)
    values = {**values_of(base.text), "name": f"my-{base.name}", **given}
    for key, instead, _ in either_of(MACHINES[base.machine]):
        if f"machine.{instead.key}" in given and f"machine.{key}" not in given:
            del values[f"machine.{key}"]  # the example's
    known = {key.path: key for key in job_keys() if key.machine in ("", base.machine)}
    for place in given:
        if place not in known:
            raise InputError(f"a {base.machine} job has no key {place!r}; camwright keys lists them")
    if sys.stdin.isatty() and not as_json and not quiet:
        values |= _asked(
            [key for key in known.values() if key.required and key.path not in given and key.path in values], values
        )
    text = job_template(values, f"A job of a {base.machine}, made from the example {base.name}.")
    parse_job(text, "the new job")  # refuses numbers that do not go together, with their places
    file = Path(f"{values['name']}.toml") if out is None else out
    _write(file, text)
    Voice(as_json, quiet).answer(lambda: _answer(file, base, values), lambda: _view(file))
    return 0


def _base(machine: str | None, like: str | None) -> Example:
    """Find the example that lends its values."""
    if like is not None:
        base = example(like)
        if machine is not None and _kind(machine) != base.machine:
            raise InputError(
                f"the example {base.name} is of a {base.machine}, not of a {_kind(machine)}; leave one of them out"
            )
        return base
    kind = "rotary_knife" if machine is None else _kind(machine)
    preferred = [each for each in examples().values() if each.machine == kind]
    if not preferred:
        raise InputError(f"no example has a {kind}; write the job by hand: camwright keys lists its keys")
    return next((each for each in preferred if each.name == "paper-600"), preferred[0])


def _kind(word: str) -> str:
    """Read the kind of a machine, however its words are joined."""
    kind = word.lower().replace("-", "_").replace(" ", "_")
    if kind not in MACHINES:
        raise InputError(f"there is no machine {word!r}; the machines are {', '.join(MACHINES)}")
    return kind


def _value(text: str) -> object:
    """Read a value as it stands in a job file; what is no number, word of truth or list is a text."""
    try:
        return json.loads(text)
    except ValueError:
        return text


def _setting(text: str) -> tuple[str, object]:
    """Read ``KEY=VALUE``."""
    place, sign, value = text.partition("=")
    if not sign:
        raise InputError(f'--set {text!r}: not KEY=VALUE; write e.g. --set "cut.sync_tolerance=0.2 mm"')
    return place.strip(), _value(value.strip())


def _asked(keys: list[JobKey], values: dict[str, Any]) -> dict[str, object]:
    """Ask for what must be known, the value at hand offered."""
    answers: dict[str, object] = {}
    for key in keys:
        if key.name != "kind":
            said = typer.prompt(f"{key.path}: {key.meaning}", default=str(values[key.path]), err=True)
            answers[key.path] = said if isinstance(values[key.path], str) else _value(said)
    return answers


def _write(file: Path, text: str) -> None:
    """Write a new file; never over another."""
    if file.exists() or file.is_symlink():
        raise InputError(f"{file}: there already; name another with --out")
    write_files(file.parent, {file.name: text})


def _answer(file: Path, base: Example, values: dict[str, Any]) -> dict[str, Any]:
    """Say as JSON what was written."""
    return {"file": str(file), "name": values["name"], "machine": base.machine, "like": base.name}


def _view(file: Path) -> RenderableType:
    """Say what was written, and what comes next."""
    return new_text(
        f"wrote {file}\n"
        f"Next: camwright check {file}    reads it again after you edited it\n"
        f"      camwright design {file}   designs it\n"
        f"      camwright recipe {file}   makes the sheet and tables for the machine"
    )
