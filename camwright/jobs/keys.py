"""Every key of a job file: what it takes, its default, what it means, and what uses it."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

from camwright.jobs.machine_tables import either_of
from camwright.jobs.meanings import MACHINE_KIND, MEANINGS
from camwright.jobs.structure import job_schema
from camwright.profiles.machines import MACHINES
from camwright.profiles.machines.fields import fields_of


@dataclass(frozen=True)
class JobKey:
    """A key of a job file.

    Parameters
    ----------
    table
        Table that it stands in, ``"machine"`` or ``"servo.tolerance"``; empty for the top of the file.
    machine
        Kind of the machine whose table has it; empty where every job has it.
    takes
        What is written: the kind of quantity with its unit, or the words to choose from.
    example
        A value, as it stands in a file.
    default
        The value that holds where the key is left out, as it stands in a file; empty where nothing takes its place.
    required
        Whether it must be there.
    meaning
        What it is.
    used_in
        What reads it.
    """

    table: str
    name: str
    machine: str
    takes: str
    example: str
    default: str
    required: bool
    meaning: str
    used_in: str

    @property
    def path(self) -> str:
        """Place in the file: ``cut.length``."""
        return f"{self.table}.{self.name}" if self.table else self.name


def job_keys() -> tuple[JobKey, ...]:
    """List every key of the schema, in the order of a file, the machines one after the other.

    Examples
    --------
    >>> [key.path for key in job_keys()][:2]
    ['name', 'machine.kind']
    """
    schema = job_schema()
    definitions = schema["$defs"]
    keys: list[JobKey] = []

    def table_of(name: str, properties: dict[str, Any], required: list[str], machine: str = "") -> None:
        for key, entry in properties.items():
            inner = _reference(entry)
            if inner is not None:
                table_of(
                    f"{name}.{key}".strip("."), definitions[inner]["properties"], definitions[inner].get("required", [])
                )
            elif "oneOf" in entry and "discriminator" in entry:
                for kind, reference in entry["discriminator"]["mapping"].items():
                    own = definitions[reference.rpartition("/")[2]]
                    first = own.get("oneOf", [{}])[0].get("required", [])  # what the others may be given in place of
                    table_of(key, own["properties"], [*own.get("required", []), *first], kind)
            else:
                keys.append(_key(name, key, machine, entry, key in required))

    table_of("", schema["properties"], schema["required"])
    return tuple(keys)


def find_keys(word: str) -> tuple[JobKey, ...]:
    """Find keys by name, by table, or by their place; nothing where there is no such key."""
    wanted = word.strip("[]").replace("] ", ".").replace(" ", ".")
    return tuple(key for key in job_keys() if wanted in (key.name, key.path, key.table))


def _reference(entry: dict[str, Any]) -> str | None:
    """Name the definition that an entry stands for."""
    reference = entry.get("$ref")
    return reference.rpartition("/")[2] if isinstance(reference, str) else None


def _key(table: str, name: str, machine: str, entry: dict[str, Any], required: bool) -> JobKey:
    """Read a key from its entry in the schema."""
    path = f"{table}.{name}" if table else name
    meaning, used_in = _meaning(path, name, machine)
    default = "" if "default" not in entry else written(entry["default"])
    return JobKey(
        table, name, machine, _takes(path, entry), _example(path, machine, entry), default, required, meaning, used_in
    )


def _meaning(path: str, name: str, machine: str) -> tuple[str, str]:
    """Find what a key means: a machine says it of its own keys, the rest stands in `MEANINGS`."""
    if not machine:
        return MEANINGS[path]
    if name == "kind":
        return MACHINE_KIND
    for key, instead, _ in either_of(MACHINES[machine]):
        if instead.key == name:
            return instead.description, _meaning(path, key, machine)[1]
    (field,) = (each for each in fields_of(MACHINES[machine]) if each.key == name)
    return field.about.description, "motor figures, torque objectives" if field.load else "every command"


def _takes(path: str, entry: dict[str, Any]) -> str:
    """Say what is written for a key."""
    if "enum" in entry:
        return " or ".join(written(word) for word in entry["enum"])
    if "const" in entry:
        return written(entry["const"])
    kind = entry.get("type")
    if kind == "boolean":
        return "true or false"
    if kind in ("number", "integer"):
        return ("whole number" if kind == "integer" else "number") + _range(entry)
    if kind == "array" or "anyOf" in entry:
        return str(entry["description"])
    return "text" if path == "name" else str(entry["description"])


def _range(entry: dict[str, Any]) -> str:
    """Say between which numbers a number must lie."""
    least = f"above {entry['exclusiveMinimum']:g}" if "exclusiveMinimum" in entry else f"from {entry['minimum']:g}"
    return f" {least} to {entry['maximum']:g}"


def _example(path: str, machine: str, entry: dict[str, Any]) -> str:
    """Write an example of a key."""
    if "examples" not in entry:
        return written(entry.get("default", entry.get("enum", [""])[0]))
    turning = path.startswith("limits.") and machine and MACHINES[machine].slave_unit == "rad"
    return written(entry["examples"][-1 if turning else 0])


def written(value: object) -> str:
    """Write a value as it stands in a TOML file."""
    return json.dumps(value, ensure_ascii=False)
