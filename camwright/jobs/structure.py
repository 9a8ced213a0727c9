"""The structure of a job file: its tables and keys as pydantic models, and its JSON Schema."""

from __future__ import annotations

import re
from functools import cache
from typing import Annotated, Any, Literal

from pydantic import Field, create_model

from camwright.house.files import is_device_name
from camwright.house.numbers import units_of
from camwright.house.servo_table import ServoNumbers
from camwright.house.setting_fields import Table, checked, number_field, quantity_field, whole_field
from camwright.house.settings import read_settings
from camwright.house.unit_keys import plain_keys
from camwright.house.units import shown
from camwright.jobs.angles import settle_angles, settle_times
from camwright.jobs.fields import Known, Spread, curve_field, slave_field, targets_field, zone_field
from camwright.jobs.line_speeds import line_speeds_field
from camwright.jobs.machine_tables import either_faults, either_of, machine_of, machine_tables, table_of
from camwright.jobs.spread_fields import aware_only, damping_spread, quantity_spread
from camwright.profiles.machines import MACHINES, Machine
from camwright.profiles.machines.fields import Choice, fields_of
from camwright.profiles.objective import ObjectiveName

Command = Literal["in_sync", "shaped"]
"""What a servo-aware design may do in the sync zone: the command in sync all over it, or shaped so that the axis is in the shear zone."""

_LONGEST_NAME = 60
_COUNTS = re.compile(r" *[0-9a-z. /-]+, *([0-9]+(\.[0-9]+)? ?[a-z]+|[0-9]+( counts?)? ?/ ?rev) *")
_REFUSED_IN_NAMES = '/\\<>:"|?*'


def _name(value: object) -> str | None:
    """Say what is wrong with the name of a job: it is also the name of the output directory."""
    if not isinstance(value, str):
        return f'{shown(value)}: not a text; write e.g. "paper-600"'
    if not value.strip() or len(value) > _LONGEST_NAME:
        return f"{shown(value)}: a name has 1 to {_LONGEST_NAME} characters"
    if not value.isprintable() or any(letter in _REFUSED_IN_NAMES for letter in value):
        return (
            f"{shown(value)}: a name is on one line and has none of {_REFUSED_IN_NAMES}; it names the output directory"
        )
    if value[0] in ". " or value[-1] in ". ":
        return f"{shown(value)}: a name neither begins nor ends with a dot or a space; it names the output directory"
    if is_device_name(value):
        return f"{shown(value)}: Windows takes this name for a device; it names the output directory, so choose another"
    return None


def _counts(value: object) -> str | None:
    """Say what is wrong with the counts of encoders as they are written; what they are is read when a table is made."""
    if not isinstance(value, str) or len(value) > _LONGEST_NAME or not _COUNTS.fullmatch(value):
        return f'{shown(value)}: not two units; write the master\'s and the slave\'s, e.g. counts = "mm,36000/rev" or "mm,9.25 um"'
    return None


class CutTable(Table):
    """What is cut, how fast, and where the knife must be in sync."""

    _place = "cut"

    length: Annotated[float, *quantity_field("length")]
    line_speed: Annotated[float, *quantity_field("speed")]
    sync_zone: Annotated[float | None, *zone_field()]
    shear_zone: Annotated[float | None, *zone_field(zero=True), Field(json_schema_extra={"default": "0 mm"})] = 0.0
    shear_zone_at: Annotated[float | None, *zone_field(zero=True, timed=False)] = None
    sync_tolerance: Annotated[
        float, *quantity_field("length", example="0.1 mm"), Field(json_schema_extra={"default": "0.1 mm"})
    ] = 1e-4
    sync_ratio: Annotated[
        float,
        number_field(0.1, 10.0, "it is the speed of the tool over that of the material, from 0.1 to 10; 1 is in sync", "1.0"),
        Field(description="speed of the tool over that of the material in the sync zone",
              json_schema_extra={"minimum": 0.1, "maximum": 10}),
    ] = 1.0  # fmt: skip


class LimitsTable(Table):
    """What the slave may do."""

    _place = "limits"

    speed: Annotated[float | None, *slave_field("speed", "angular rate", "300 rpm")]
    acceleration: Annotated[float | None, *slave_field("acceleration", "angular acceleration", "2000 rad/s^2")]
    jerk: Annotated[float | None, *slave_field("jerk", "angular jerk", "50000 rad/s^3")]
    reversal: Annotated[bool, Field(description="whether the slave may run backwards")] = False
    motor: Annotated[tuple[tuple[float, float], ...] | None, *curve_field()] = None


class ServoToleranceTable(Table):
    """Ranges in which the servo's parameters are known to lie."""

    _place = "servo.tolerance"

    bandwidth: Annotated[Spread | None, *quantity_spread("angular rate", "108 rad/s", "132 rad/s")] = None
    damping: Annotated[Spread | None, *damping_spread()] = None
    position_gain: Annotated[Spread | None, *quantity_spread("gain", "33 1/s", "37 1/s")] = None
    sample_time: Annotated[Spread | None, *quantity_spread("time", "3.9 ms", "4.1 ms")] = None
    dead_time: Annotated[Spread | None, *quantity_spread("time", "0 ms", "1 ms", zero=True)] = None


class ServoTable(ServoNumbers):
    """The discrete servo."""

    dead_time: Annotated[float, *quantity_field("time", zero=True), Field(json_schema_extra={"default": "0 ms"})] = 0.0
    lead_time: Annotated[float, *quantity_field("time", zero=True), Field(json_schema_extra={"default": "0 ms"})] = 0.0
    acceleration_feedforward: Annotated[
        float, *quantity_field("time squared", zero=True), Field(json_schema_extra={"default": "0 s^2"})
    ] = 0.0
    jerk_feedforward: Annotated[
        float, *quantity_field("time cubed", zero=True), Field(json_schema_extra={"default": "0 s^3"})
    ] = 0.0
    tolerance: ServoToleranceTable | None = None


class ObjectiveTable(Table):
    """What is made least, and whether of the command alone or with the axis in mind."""

    _place = "objective"

    servo_aware: Annotated[
        bool, Field(description="whether the axis, not only its command, keeps the sync tolerance")
    ] = False
    minimise: Annotated[
        ObjectiveName,
        aware_only('minimise e.g. "peak_acceleration"', only="sync_error"),
        Field(description="what is made least; sync_error, that of the axis in the shear zone, only if servo_aware"),
    ] = "peak_acceleration"
    command: Annotated[
        Command | None,
        aware_only("leave command out"),
        Field(
            description="whether the command keeps in sync in the whole sync zone, or only the axis in the shear zone; only if servo_aware",
            json_schema_extra={"default": "in_sync"},
        ),
    ] = None
    line_speeds: Annotated[tuple[str, ...] | None, *line_speeds_field(), aware_only("leave line_speeds out")] = None


class LineTable(Table):
    """How the line ramps its speed."""

    _place = "line"

    acceleration: Annotated[float | None, *quantity_field("acceleration", example="1 m/s^2")] = None
    stop: Annotated[float | None, *quantity_field("acceleration", example="5 m/s^2")] = None
    jerk: Annotated[float | None, *quantity_field("jerk", example="50 m/s^3")] = None


class OutputTable(Table):
    """How the cam is written."""

    _place = "output"

    origin: Annotated[
        Literal["return", "cut"], Field(description="master zero: start of the return zone, or mid sync zone")
    ] = "return"
    points: Annotated[
        int,
        whole_field(2, 100_000, 361),
        Field(description="rows of cam.csv", json_schema_extra={"minimum": 2, "maximum": 100_000}),
    ] = 361
    targets: Annotated[tuple[str, ...], *targets_field()] = ()
    counts: Annotated[
        str,
        checked(_counts),
        Field(
            description="units of master and slave for targets that store whole counts: the size of a count, or counts a turn",
            examples=["mm,36000/rev", "mm,9.25 um"],
            json_schema_extra={"maxLength": _LONGEST_NAME},
        ),
    ] = ""


class JobFile(Table):
    """A job for camwright: one machine, one product, one drive."""

    name: Annotated[
        str,
        checked(_name),
        Field(
            description="names the job and its output directory",
            examples=["paper-600"],
            json_schema_extra={"minLength": 1, "maxLength": _LONGEST_NAME, "pattern": r'^[^/\\<>:"|?*\n\r]+$'},
        ),
    ]
    machine: Table
    cut: CutTable
    limits: LimitsTable
    servo: ServoTable
    line: LineTable = LineTable()
    objective: ObjectiveTable = ObjectiveTable()
    output: OutputTable = OutputTable()


def job_model() -> type[JobFile]:
    """Model of a job file for the machines that there are."""
    return _job_model(tuple(MACHINES.values()))


@cache
def _job_model(machines: tuple[type[Machine], ...]) -> type[JobFile]:
    """Make the model of a job file; machines are those that `machine_tables` knows."""
    del machines
    return create_model("JobFile", __base__=JobFile, __doc__=JobFile.__doc__, machine=(machine_tables(), ...))


def job_schema() -> dict[str, Any]:
    """Make the JSON Schema of a job file from the models."""
    schema = job_model().model_json_schema()
    for definition in (schema, *schema["$defs"].values()):
        for entry in definition["properties"].values():
            # left out, not null: TOML knows no null
            if "default" in entry and entry["default"] is None:
                del entry["default"]
            if {"type": "null"} in entry.get("anyOf", ()):
                (only,) = (kind for kind in entry.pop("anyOf") if kind != {"type": "null"})
                entry.update(only)
    for machine in MACHINES.values():
        definition = schema["$defs"][table_of(machine).__name__]
        for key, instead, _ in either_of(machine):
            definition["oneOf"] = [{"required": [key]}, {"required": [instead.key]}]
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}


def read_structure(data: dict[str, Any]) -> tuple[JobFile | None, Known, list[str]]:
    """Check the structure and every single value of a job file.

    Parameters
    ----------
    data
        What the TOML file holds.

    Returns
    -------
    (file, known, faults)
        The file, or nothing if it has faults; what is right in itself, defaults of what was left out included; one
        message for each fault, each with its place.
    """
    data, misnamed = plain_keys(job_model(), data)
    table, objective = data.get("machine"), data.get("objective")
    kind = table.get("kind") if isinstance(table, dict) else None
    known = Known(
        kind=kind if isinstance(kind, str) and kind in MACHINES else None,
        servo_aware=isinstance(objective, dict) and objective.get("servo_aware", False) is not False,
        units=units_of(data),
    )
    if isinstance(table, dict):
        known.choices.update(_choices(table, known))
    own = [] if known.machine is None or not isinstance(table, dict) else list(either_faults(known.machine, table))
    file, faults = read_settings(job_model(), data, known)
    settle_times(known)
    settle_angles(known, None if own else machine_of(known))
    faults = [*misnamed, *own, *faults]
    return None if faults else file, known, faults


def _choices(table: dict[str, Any], known: Known) -> dict[str, str]:
    """Words of a machine table that are known, those that it leaves out included."""
    found = {}
    for each in fields_of(known.machine) if known.machine is not None else ():
        word = table.get(each.key, each.default)
        if isinstance(each.about, Choice) and word in each.about.words:
            found[each.key] = word
    return found
