"""The structure of a job file: its tables and keys as pydantic models, its JSON Schema, its faults in plain words."""

from __future__ import annotations

import difflib
import json
import math
from typing import Annotated, Any, Literal, cast

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, ValidationInfo, WithJsonSchema
from pydantic_core import ErrorDetails, PydanticCustomError

from camwright.units import KINDS, quantity, shown
from profiles.errors import InputError

Objective = Literal["peak_acceleration", "rms_acceleration", "peak_jerk", "rms_jerk"]

_LONGEST_NAME = 60
_REFUSED_IN_NAMES = '/\\<>:"|?*'


def _quantity(kind: str, *, zero: bool = False) -> tuple[BeforeValidator, WithJsonSchema]:
    """Make the parts of a field that is written as a number with a unit."""

    def read(value: object, info: ValidationInfo) -> float:
        try:
            return _kept(quantity(value, kind, zero=zero), info)
        except InputError as error:
            raise PydanticCustomError("quantity", "{message}", {"message": str(error)}) from error

    wanted = KINDS[kind]
    least = "zero or more" if zero else "greater than zero"
    schema = {
        "type": "string",
        "description": f"{wanted.name}, {least}, as a number and a unit",
        "examples": [wanted.example],
        "minLength": 3,
        "maxLength": 100,
        "pattern": r"^\s*[+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]{1,3})?\s*([A-Za-z°µμ/]|1\s*/).*$",
    }
    return BeforeValidator(read), WithJsonSchema(schema)


def _kept(value: float, info: ValidationInfo) -> float:
    """Keep a number that is right in itself, so that it can be checked against others although the file has faults."""
    cast(dict[str, float], info.context)[cast(str, info.field_name)] = value
    return value


def _number(least: float, greatest: float, words: str, *, above: bool = False) -> BeforeValidator:
    """Make the validator of a field that is written as a bare number in a range."""

    def read(value: object, info: ValidationInfo) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            message = f"{shown(value)}: not a number; write e.g. {info.field_name} = 0.7"
        elif not (least < value <= greatest if above else least <= value <= greatest) or not math.isfinite(value):
            message = f"{shown(value)}: {words}"
        else:
            return _kept(float(value), info)
        raise PydanticCustomError("number", "{message}", {"message": message})

    return BeforeValidator(read)


def _name(value: object) -> str:
    """Check the name of a job: it is also the name of the output directory."""
    if not isinstance(value, str):
        message = f'{shown(value)}: not a text; write e.g. "paper-600"'
    elif not value.strip() or len(value) > _LONGEST_NAME:
        message = f"{shown(value)}: a name has 1 to {_LONGEST_NAME} characters"
    elif not value.isprintable() or any(letter in _REFUSED_IN_NAMES for letter in value):
        message = (
            f"{shown(value)}: a name is on one line and has none of {_REFUSED_IN_NAMES}; it names the output directory"
        )
    elif value[0] in ". " or value[-1] in ". ":
        message = f"{shown(value)}: a name neither begins nor ends with a dot or a space; it names the output directory"
    else:
        return value
    raise PydanticCustomError("name", "{message}", {"message": message})


class _Table(BaseModel):
    """A table of a job file: no unknown keys, no conversions."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True, allow_inf_nan=False)


class MachineTable(_Table):
    """The machine."""

    kind: Annotated[Literal["rotary_knife"], Field(description="which machine", examples=["rotary_knife"])]
    circumference: Annotated[float, *_quantity("length")]


class CutTable(_Table):
    """What is cut, how fast, and where the knife must be in sync."""

    length: Annotated[float, *_quantity("length")]
    line_speed: Annotated[float, *_quantity("speed")]
    sync_zone: Annotated[float, *_quantity("length")]
    shear_zone: Annotated[float, *_quantity("length", zero=True), Field(json_schema_extra={"default": "0 mm"})] = 0.0
    shear_zone_at: Annotated[float | None, *_quantity("length", zero=True)] = None
    sync_tolerance: Annotated[float, *_quantity("length"), Field(json_schema_extra={"default": "0.1 mm"})] = 1e-4


class LimitsTable(_Table):
    """What the slave may do."""

    speed: Annotated[float, *_quantity("speed")]
    acceleration: Annotated[float, *_quantity("acceleration")]
    jerk: Annotated[float, *_quantity("jerk")]
    reversal: Annotated[bool, Field(description="whether the slave may run backwards")] = False


class ServoTable(_Table):
    """The discrete servo."""

    bandwidth: Annotated[float, *_quantity("angular rate")]
    damping: Annotated[
        float,
        _number(0.0, 100.0, "the damping ratio must be above 0 (else the velocity loop never settles) and at most 100; "
                "drives have 0.7 to 0.9", above=True),
        Field(description="damping ratio of the velocity loop", examples=[0.7],
              json_schema_extra={"exclusiveMinimum": 0, "maximum": 100}),
    ]  # fmt: skip
    position_gain: Annotated[float, *_quantity("gain")]
    sample_time: Annotated[float, *_quantity("time")]
    velocity_feedforward: Annotated[
        float,
        _number(0.0, 1.0, "it is the share of the command's velocity that is fed forward, from 0 (none) to 1 (all, no "
                "following error at constant speed); more makes the axis run ahead of its command"),
        Field(description="share of the command's velocity fed forward", examples=[1.0],
              json_schema_extra={"minimum": 0, "maximum": 1}),
    ]  # fmt: skip


class ObjectiveTable(_Table):
    """What is made least."""

    minimise: Annotated[Objective, Field(description="what is made least")] = "peak_acceleration"


class OutputTable(_Table):
    """How the cam is written."""

    origin: Annotated[
        Literal["return", "cut"], Field(description="master zero: start of the return zone, or mid sync zone")
    ] = "return"
    points: Annotated[int, Field(ge=2, le=100_000, description="rows of cam.csv")] = 361


class JobFile(_Table):
    """A job for camwright: one machine, one product, one drive."""

    name: Annotated[
        str,
        BeforeValidator(_name),
        Field(
            description="names the job and its output directory",
            json_schema_extra={"minLength": 1, "maxLength": _LONGEST_NAME, "pattern": r'^[^/\\<>:"|?*\n\r]+$'},
        ),
    ]
    machine: MachineTable
    cut: CutTable
    limits: LimitsTable
    servo: ServoTable
    objective: ObjectiveTable = ObjectiveTable()
    output: OutputTable = OutputTable()


def job_schema() -> dict[str, Any]:
    """Make the JSON Schema of a job file from the models."""
    schema = JobFile.model_json_schema()
    for definition in (schema, *schema["$defs"].values()):
        for entry in definition["properties"].values():
            if "default" in entry and entry["default"] is None:
                del entry["default"]  # left out, not null: TOML knows no null
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}


def read_structure(data: dict[str, Any]) -> tuple[JobFile | None, dict[str, float], list[str]]:
    """Check the structure and every single value of a job file.

    Parameters
    ----------
    data
        What the TOML file holds.

    Returns
    -------
    (file, values, faults)
        The file, or nothing if it has faults; the numbers that are right in themselves, by key, in SI units; one
        message for each fault, each with its place.
    """
    values: dict[str, float] = {}
    try:
        return JobFile.model_validate(data, context=values), values, []
    except ValidationError as error:
        return None, values, [_fault(entry) for entry in error.errors(include_url=False)]


def _fault(error: ErrorDetails) -> str:
    """Say what is wrong, where, and the way out."""
    place, key = [str(part) for part in error["loc"][:-1]], str(error["loc"][-1])
    model = _model_at(place)
    where = f"[{place[0]}] {key}" if place else (f"[{key}]" if _is_table(key) else key)
    kind, value = error["type"], error["input"]
    if kind == "missing":
        return f"{where}: missing; {_example(place, key)}"
    if kind == "extra_forbidden":
        known = list(model.model_fields)
        where = f"[{place[0]}] {shown(key)[1:-1]}" if place else shown(key)[1:-1]
        near = difflib.get_close_matches(key[:100], known, n=1, cutoff=0.5)
        advice = f"did you mean {near[0]}?" if near else f"the keys here are {', '.join(known)}"
        return f"{where}: there is no such key; {advice}"
    if kind in ("quantity", "number", "name"):
        return f"{where} = {error['msg']}"
    if kind == "literal_error":
        allowed = str(error["ctx"]["expected"]).replace("'", '"')
        return f"{where} = {shown(value)}: not known; write {allowed}"
    if kind == "bool_type":
        return f"{where} = {shown(value)}: neither true nor false; write true or false without quotes"
    if kind in ("int_type", "int_from_float", "greater_than_equal", "less_than_equal", "int_parsing_size"):
        return f"{where} = {shown(value)}: not a whole number from 2 to 100000; write e.g. {key} = 361"
    return f"{where} = {shown(value)}: not a table; write [{key}] on a line of its own and its keys below"


def _is_table(key: str) -> bool:
    """Whether a key of the file names one of its tables."""
    return key in JobFile.model_fields and key != "name"


def _model_at(place: list[str]) -> type[BaseModel]:
    """Find the model of a table by its place."""
    return cast(type[BaseModel], JobFile.model_fields[place[0]].annotation) if place else JobFile


def _example(place: list[str], key: str) -> str:
    """Say what to write for a key or table that is missing."""
    if not place:
        return f"add the table [{key}]" if _is_table(key) else f'add e.g. {key} = "paper-600"'
    schema = _model_at(place).model_json_schema()["properties"][key]
    return f"add e.g. {key} = {json.dumps(schema['examples'][0])}"
