"""design.json: a profile, the job that it is the answer to, and where both come from."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, get_args, get_type_hints

from camwright.house.files import read_text
from camwright.house.provenance import SCHEMA_VERSION
from camwright.jobs.job import Job, parse_job
from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.machines import MACHINES, Machine
from camwright.profiles.machines.fields import Choice, MachineField, Whole, fields_of
from camwright.profiles.objective import OBJECTIVES
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.servo import Servo
from camwright.profiles.servo_tolerance import ServoTolerance

MOST_BYTES = 1 << 26
"""The most bytes that a design or table file may have."""


_KEYS = ("schema_version", "status", "objective", "profile", "job", "provenance")


@dataclass(frozen=True, eq=False)
class StoredDesign:
    """What a design.json holds.

    Parameters
    ----------
    profile
        One cycle, bit by bit as it was designed.
    job
        The job, read again from its stored text.
    """

    profile: CamProfile
    job: Job


def read_design(path: str | Path) -> StoredDesign:
    """Read a design.json.

    Raises
    ------
    InputError
        The file cannot be read or is not a design.json.

    Examples
    --------
    >>> import tempfile
    >>> from camwright import load_job, optimise, read_design, save
    >>> result = optimise(load_job())
    >>> stored = read_design(save(result, tempfile.mkdtemp())[0])
    >>> bool(stored.profile(0.1) == result.profile(0.1)), stored.job == result.job
    (True, True)
    """
    return parse_design(read_text(Path(path), "design file", MOST_BYTES), str(path))


def parse_design(text: str, place: str) -> StoredDesign:
    """Read the text of a design.json; messages begin with the place.

    Raises
    ------
    InputError
        It is not a design.json of this schema version, or its job was changed after it was stored.
    """
    try:
        data = json.loads(text)
    except RecursionError as error:
        raise InputError(f"{place}: not a design.json: nested too deeply") from error
    except ValueError as error:  # JSONDecodeError, and integers beyond Python's limit of digits
        raise InputError(f"{place}: not JSON: {error}") from error
    missing = [key for key in _KEYS if not isinstance(data, dict) or key not in data]
    if missing:
        raise InputError(f"{place}: not a design.json: {', '.join(missing)} missing; camwright design writes one")
    if data["schema_version"] != SCHEMA_VERSION:
        raise InputError(
            f"{place}: schema_version {data['schema_version']!r:.40} is not read; this camwright reads {SCHEMA_VERSION}"
        )
    job, origin = data["job"], data["provenance"]
    if not isinstance(job, dict) or not isinstance(job.get("toml"), str):
        raise InputError(f"{place}: not a design.json: job.toml, the text of the job file, is missing")
    stored = origin.get("job_sha256") if isinstance(origin, dict) else None
    if hashlib.sha256(job["toml"].encode("utf-8", "surrogatepass")).hexdigest() != stored:
        raise InputError(
            f"{place}: the stored job is not the one that was designed (its SHA-256 differs); design it anew"
        )
    try:
        profile = CamProfile.from_dict(data["profile"])
    except InputError as error:
        raise InputError(f"{place}: {error}") from error
    return StoredDesign(profile, _with_place(parse_job(job["toml"], f"{place}, job.toml"), job.get("si"), place))


def _with_place(job: Job, numbers: object, place: str) -> Job:
    """Put a sync zone that the job leaves free where the design chose it."""
    machine = job.machine
    if machine.placed:
        return job
    stored = numbers.get("machine") if isinstance(numbers, dict) else None
    angle = stored.get(machine.place_name) if isinstance(stored, dict) else None
    least, greatest = machine.place_range(job.cut)
    if isinstance(angle, bool) or not isinstance(angle, int | float) or not least < angle < greatest:
        raise InputError(
            f"{place}: not a design.json: job.si.machine.{machine.place_name}, where on the {machine.noun} the sync zone lies, must be a "
            f"number from {least:.6g} to {greatest:.6g} ({machine.slave_unit})"
        )
    return replace(job, machine=machine.placed_at(float(angle)))


def _field_schema(each: MachineField, machine: type[Machine]) -> dict[str, Any]:
    """Make the schema of a stored number of a machine."""
    if isinstance(each.about, Choice):
        return {"enum": list(each.about.words)}
    if isinstance(each.about, Whole):
        return {"type": "integer"}
    if each.name == machine.place_name:
        what = f"{machine.noun} angle" if machine.slave_unit == "rad" else f"place of the {machine.noun}"
        return {"type": "number", "description": f"{what} at mid sync zone ({machine.slave_unit}), given or chosen"}
    return {"type": "number"}


def _numbers_schema(kind: type) -> dict[str, Any]:
    """Describe the numbers, words and switches of a dataclass by its types; what may be left out is a number where it is there."""
    known = {float: "number", float | None: "number", bool: "boolean"}
    return {
        name: {"type": known[of]} if of in known else {"enum": list(get_args(of))}
        for name, of in get_type_hints(kind).items()
    }


def design_schema() -> dict[str, Any]:
    """Make the JSON Schema of a design.json."""
    number, whole, text = {"type": "number"}, {"type": "integer"}, {"type": "string"}
    maybe = {"type": ["number", "null"]}
    objectives = list(OBJECTIVES)
    units = list(dict.fromkeys(each.unit(slave) for slave in ("m", "rad") for each in OBJECTIVES.values()))
    numbers = {"type": "array", "items": number, "minItems": 1}

    def table(**entries: Any) -> dict[str, Any]:
        return {"type": "object", "properties": entries, "required": list(entries), "additionalProperties": False}

    def lax(left_out: tuple[str, ...], **entries: Any) -> dict[str, Any]:
        return table(**entries) | {"required": [key for key in entries if key not in left_out]}

    def nullable(description: str, **entries: Any) -> dict[str, Any]:
        return {"oneOf": [{"type": "null"}, table(**entries)], "description": description}

    ends = {"type": "array", "items": number, "minItems": 2, "maxItems": 2}
    curve = nullable("motor speed (rad/s) and torque (N m)", points={"type": "array", "items": ends})
    machines = [
        table(kind={"const": kind}, **{each.key: _field_schema(each, machine) for each in fields_of(machine)})
        for kind, machine in MACHINES.items()
    ]
    root = table(
        schema_version={"const": SCHEMA_VERSION},
        status={"type": "string", "description": "how the solver ended"},
        objective=table(
            name={"enum": objectives},
            value=number,
            unit={"enum": units},
            lower_bound=maybe,
            gap={**maybe, "description": "(value - lower_bound) / value; null without a bound"},
        ),
        lower_bound_method={
            "type": "string",
            "description": "how the lower bound was found; none where there is none, not computed in a book",
        },
        starts=nullable(
            "agreement of several starts; null where the problem is convex",
            converged=whole,
            agreeing=whole,
            spread=number,
            residual=number,
            valleys=whole,
        ),
        servo_aware=nullable(
            "sync error of the axis in the shear zone; null for a servo-blind design",
            mode={"enum": ["in_sync", "shaped"]},
            designed_error_mm=number,
            simulated_error_mm=number,
            phases=whole,
            axis_limits={"type": "boolean"},
            line_speeds_m_per_s=ends,
            line_speeds_used_m_per_s=numbers,
        ),
        robust=nullable(
            "sync error over the ranges of the servo; null where the job gives none",
            worst_error_mm=number,
            draws=whole,
            designed_worst_error_mm=maybe,
            vertices=whole,
        ),
        profile=table(
            breaks={**numbers, "minItems": 2, "description": "ends of the pieces on the master (m)"},
            coefficients={
                "type": "array",
                "items": numbers,
                "minItems": 1,
                "description": "per piece, ascending powers of the distance from its first break (m per m**power)",
            },
        ),
        job=table(
            toml={"type": "string", "description": "the job file as it was read"},
            si=table(
                name=text,
                machine={"oneOf": machines},
                cut=lax(("sync_time", "shear_time"), **_numbers_schema(Cut)),
                limits=table(speed=number, acceleration=number, jerk=number, reversal={"type": "boolean"}, motor=curve),
                servo=lax(("acceleration_feedforward", "jerk_feedforward"), **_numbers_schema(Servo)),
                objective={"enum": objectives},
                servo_aware={"type": "boolean"},
                command={"enum": ["in_sync", "shaped"]},
                slowest={**number, "description": "least line speed to be in sync at over that of the cut"},
                servo_tolerance=nullable(
                    "least and greatest value of each parameter of the servo",
                    **dict.fromkeys(ServoTolerance.__dataclass_fields__, ends),
                ),
                points={"type": "integer", "minimum": 2},
            ),
        ),
        provenance=table(
            camwright=text,
            job_sha256={"type": "string", "pattern": "^[0-9a-f]{64}$"},
            libraries={"type": "object", "additionalProperties": text},
            schema_version={"const": SCHEMA_VERSION},
        ),
    )
    line = {
        **table(acceleration=maybe, stop=maybe, jerk=maybe),
        "description": "how the line ramps its speed, if it does",
    }
    root["properties"]["job"]["properties"]["si"]["properties"]["line"] = line
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "camwright design"}
    return {**head, **root}
