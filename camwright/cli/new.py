"""The command ``camwright new``."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from camwright.cli.options import Json, Quiet
from camwright.cli.views.parts import View, new_text
from camwright.house.files import write_files
from camwright.house.output import Voice
from camwright.jobs.examples import Example, example, examples
from camwright.jobs.job import BUNDLED_JOB, parse_job
from camwright.jobs.keys import JobKey, job_keys, written
from camwright.jobs.machine_tables import either_of
from camwright.jobs.template import job_template, values_of
from camwright.profiles.errors import InputError
from camwright.profiles.machines import MACHINES

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

_KINDS = " or ".join((", ".join([*MACHINES][:-1]), [*MACHINES][-1]))

_OWN = ("machine.", "cut.", "limits.", "servo.")
"""Tables whose numbers are the user's machine's own."""

_FIRST = ("paper-600", "flying-saw", "chasing-shear")
"""Examples that lend their values to a job of which only the machine is said."""


def _key(place: str) -> Any:
    """Make the option of a key: what the key means, and what is written there."""
    key = next(each for each in job_keys() if each.path == place)
    paper = values_of(BUNDLED_JOB.read_text(encoding="utf-8"))
    value = written(paper[place]) if place in paper else key.example
    meaning = key.meaning[0].upper() + key.meaning[1:]
    return typer.Option(metavar="VALUE", help=f"{meaning}, e.g. {value}.", show_default=False)


def run(
    machine: Annotated[
        str | None,
        typer.Argument(
            metavar="[MACHINE]",
            help=f"{_KINDS}; or an example: flying-saw, chasing-shear, thick-product …",
        ),
    ] = None,
    like: Annotated[
        str | None,
        typer.Option("--like", metavar="EXAMPLE", help="Take the values of this example where none is given."),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE", help="The job file; NAME.toml if left out.")
    ] = None,
    name: Annotated[str | None, _key("name")] = None,
    circumference: Annotated[str | None, _key("machine.circumference")] = None,
    diameter: Annotated[str | None, _key("machine.diameter")] = None,
    stroke: Annotated[str | None, _key("machine.stroke")] = None,
    crank: Annotated[str | None, _key("machine.crank")] = None,
    rod: Annotated[str | None, _key("machine.rod")] = None,
    length: Annotated[str | None, _key("cut.length")] = None,
    line_speed: Annotated[str | None, _key("cut.line_speed")] = None,
    sync_zone: Annotated[str | None, _key("cut.sync_zone")] = None,
    shear_zone: Annotated[str | None, _key("cut.shear_zone")] = None,
    speed: Annotated[str | None, _key("limits.speed")] = None,
    acceleration: Annotated[str | None, _key("limits.acceleration")] = None,
    jerk: Annotated[str | None, _key("limits.jerk")] = None,
    bandwidth: Annotated[str | None, _key("servo.bandwidth")] = None,
    damping: Annotated[str | None, _key("servo.damping")] = None,
    position_gain: Annotated[str | None, _key("servo.position_gain")] = None,
    sample_time: Annotated[str | None, _key("servo.sample_time")] = None,
    velocity_feedforward: Annotated[str | None, _key("servo.velocity_feedforward")] = None,
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
        given |= _asked(
            [key for key in known.values() if key.required and key.path not in given and key.path in values], values
        )
        values |= given
    text = job_template(values, f"A job of a {base.machine}, made from the example {base.name}.")
    parse_job(text, "the new job")  # refuses numbers that do not go together, with their places
    file = Path(f"{values['name']}.toml") if out is None else out
    _write(file, text)
    lent = {
        place: value
        for place, value in values.items()
        if place not in given
        and place.startswith(_OWN)
        and place != "machine.kind"
        and written(value) != known[place].default
    }
    Voice(as_json, quiet).answer(lambda: _answer(file, base, values, lent), lambda: _view(file, base, lent))
    return 0


def _base(machine: str | None, like: str | None) -> Example:
    """Find the example that lends its values."""
    known = examples()
    kind = next(iter(MACHINES)) if machine is None else _joined(machine, "_")
    if like is not None:
        base = example(like)
        if (
            machine is not None
            and (known[named].machine if (named := _joined(machine, "-")) in known else kind) != base.machine
        ):
            raise InputError(f"the example {base.name} is of a {base.machine}, not of a {kind}; leave one of them out")
        return base
    if machine is not None and _joined(machine, "-") in known:
        return known[_joined(machine, "-")]
    if kind not in MACHINES:
        raise InputError(
            f"there is no machine {machine!r}; the machines are {', '.join(MACHINES)}, "
            f"and each example may be named in their place: {', '.join(known)}"
        )
    preferred = sorted(
        (each for each in known.values() if each.machine == kind), key=lambda each: each.name not in _FIRST
    )
    if not preferred:
        raise InputError(f"no example has a {kind}; write the job by hand: camwright keys lists its keys")
    return preferred[0]


def _joined(word: str, by: str) -> str:
    """Join the words of a name, however they were joined."""
    return word.strip().lower().replace("-", " ").replace("_", " ").replace(" ", by)


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


def _answer(file: Path, base: Example, values: dict[str, Any], lent: dict[str, Any]) -> dict[str, Any]:
    """Say as JSON what was written."""
    return {"file": str(file), "name": values["name"], "machine": base.machine, "like": base.name, "lent": lent}


def _view(file: Path, base: Example, lent: dict[str, Any]) -> View:
    """Say what was written, what the example lent, and what comes next."""
    taken = ", ".join(f"{place} = {written(value)}" for place, value in lent.items())
    return new_text(
        f"wrote {file}\n"
        + (f"Of the example {base.name}, which are not your machine's until you say so: {taken}\n" if lent else "")
        + f"Next: camwright check {file}    reads it again after you edited it\n"
        f"      camwright design {file}   designs it\n"
        f"      camwright recipe {file}   makes the sheet and tables for the machine"
    )
