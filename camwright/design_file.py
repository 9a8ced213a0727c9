"""design.json: a profile, the job that it is the answer to, and where both come from."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from camwright.files import read_text
from camwright.job import Job, parse_job
from camwright.provenance import SCHEMA_VERSION, provenance
from profiles.errors import InputError
from profiles.polynomial import CamProfile

if TYPE_CHECKING:
    from camwright.results import Design

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


def job_numbers(job: Job) -> dict[str, Any]:
    """Write a job as plain numbers in SI units."""
    return {
        "name": job.name,
        "machine": {"kind": "rotary_knife", **asdict(job.machine)},
        "cut": asdict(job.cut),
        "limits": asdict(job.limits),
        "servo": asdict(job.servo),
        "objective": job.objective,
        "points": job.output.points,
    }


def objective_answer(design: Design) -> dict[str, Any]:
    """Write the objective of a design: name, value, unit, lower bound and gap."""
    return {
        "name": design.solution.objective_name,
        "value": design.solution.objective,
        "unit": "m/s^2" if design.solution.objective_name.endswith("acceleration") else "m/s^3",
        "lower_bound": design.bound.value,
        "gap": design.gap,
    }


def design_text(design: Design) -> str:
    """Write a design as the text of a design.json."""
    data = {
        "schema_version": SCHEMA_VERSION,
        "status": design.solution.status.value,
        "objective": objective_answer(design),
        "profile": design.profile.to_dict(),
        "job": {"toml": design.job.text, "si": job_numbers(design.job)},
        "provenance": provenance(design.job.sha256),
    }
    return json.dumps(data, indent=1, allow_nan=False) + "\n"


def read_design(path: str | Path) -> StoredDesign:
    """Read a design.json.

    Raises
    ------
    InputError
        The file cannot be read or is not a design.json.
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
    return StoredDesign(profile, parse_job(job["toml"], f"{place}, job.toml"))


def design_schema() -> dict[str, Any]:
    """Make the JSON Schema of a design.json."""
    number, text = {"type": "number"}, {"type": "string"}
    numbers = {"type": "array", "items": number, "minItems": 1}

    def table(**entries: Any) -> dict[str, Any]:
        return {"type": "object", "properties": entries, "required": list(entries), "additionalProperties": False}

    root = table(
        schema_version={"const": SCHEMA_VERSION},
        status={"type": "string", "description": "how the solver ended"},
        objective=table(
            name={"enum": ["peak_acceleration", "rms_acceleration", "peak_jerk", "rms_jerk"]},
            value=number,
            unit={"enum": ["m/s^2", "m/s^3"]},
            lower_bound=number,
            gap={"type": "number", "description": "(value - lower_bound) / value"},
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
                machine=table(kind={"const": "rotary_knife"}, circumference=number),
                cut=table(
                    length=number,
                    line_speed=number,
                    sync_zone=number,
                    shear_zone=number,
                    shear_zone_at=number,
                    sync_tolerance=number,
                    origin={"enum": ["return", "cut"]},
                ),
                limits=table(speed=number, acceleration=number, jerk=number, reversal={"type": "boolean"}),
                servo=table(
                    bandwidth=number,
                    damping=number,
                    position_gain=number,
                    sample_time=number,
                    velocity_feedforward=number,
                ),
                objective={"enum": ["peak_acceleration", "rms_acceleration", "peak_jerk", "rms_jerk"]},
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
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "camwright design"}
    return {**head, **root}
