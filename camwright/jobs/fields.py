"""Fields that only job files have: limits in the slave's own unit, zones as angles, the motor's curve; and what a file is known to say."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, cast

from pydantic import BeforeValidator, ValidationInfo, WithJsonSchema
from pydantic_core import PydanticCustomError

from camwright.house.numbers import METRIC, Units
from camwright.house.setting_fields import Settings, keep, quantity_schema, read_quantity, refusal
from camwright.house.units import KINDS, quantity, shown
from camwright.profiles.errors import InputError
from camwright.profiles.machines import MACHINES, Machine
from camwright.profiles.tables.targets import TARGETS, target_of

Spread = float | tuple[float, float]
"""Range of a parameter: the share of it by which it may be off to both sides, or its two ends."""


_CURVE = '[["0 rpm", "12 N m"], ["3000 rpm", "8 N m"]]'


@dataclass(frozen=True)
class Indirect:
    """What is written as something else than its number, by its place, until that something is known.

    Parameters
    ----------
    angles
        Angles (rad), or a speed, acceleration or jerk of one, until the machine is known.
    times
        Zones as the time that they last (s), until the line speed is known.
    """

    angles: dict[str, float] = field(default_factory=dict)
    times: dict[str, float] = field(default_factory=dict)


@dataclass
class Known(Settings):
    """What is right in itself in a job file, whatever else is wrong; its numbers by their place.

    Parameters
    ----------
    kind
        Kind of the machine; nothing if the file names none that is known.
    indirect
        What has no number yet.
    choices
        Words of the machine by key, those that are known.
    spreads
        Ranges of the servo's parameters, by key.
    servo_aware
        Whether the file says so.
    units
        Those of the file, in which its faults are told.
    """

    kind: str | None = None
    indirect: Indirect = field(default_factory=Indirect)
    choices: dict[str, str] = field(default_factory=dict)
    spreads: dict[str, Spread] = field(default_factory=dict)
    servo_aware: bool = False
    units: Units = METRIC

    @property
    def machine(self) -> type[Machine] | None:
        """The kind of the machine; nothing if it is not known."""
        return MACHINES.get(self.kind or "")

    @property
    def turns(self) -> bool:
        """Whether the slave is an angle."""
        return self.machine is not None and self.machine.slave_unit == "rad"

    def example(self, path: str, examples: list[Any]) -> Any:
        """Choose what a message tells to write at a place: limits have the unit of the slave."""
        return examples[-1 if path.startswith("limits.") and self.turns else 0]


def slave_field(straight: str, turning: str, example: str) -> tuple[BeforeValidator, WithJsonSchema]:
    """Make the parts of a field whose kind is that of the machine's slave.

    Parameters
    ----------
    straight, turning
        Kind where the slave is counted in metres, and where it is an angle; a machine that knows its angle takes both.
    example
        What to write where it is an angle.
    """

    def read(value: object, info: ValidationInfo) -> float | None:
        machine, turns = cast(Known, info.context).kind, cast(Known, info.context).turns
        if not turns and _is(value, turning) and _by_angle(info):
            _keep_angle(read_quantity(value, turning), info)
            return None
        wanted, other = (turning, straight) if turns else (straight, turning)
        shown_example = example if turns else KINDS[straight].example
        if machine is not None and _is(value, other):
            motion = "turns" if turns else "is counted in metres"
            raise refusal(
                f'{shown(value)}: {KINDS[other].name}, but the slave of a {machine} {motion}; write e.g. "{shown_example}"'
            )
        if machine is None and _is(value, turning):
            return read_quantity(value, turning)  # right for a crank, and what the machine is nobody knows
        return keep(read_quantity(value, wanted, example=shown_example), info)

    turning_nouns = " or ".join(machine.noun for machine in MACHINES.values() if machine.slave_unit == "rad")
    words = f"{KINDS[straight].name}, of a {turning_nouns} {KINDS[turning].name}, of a {_knowing()} either, greater than zero"
    return BeforeValidator(read), quantity_schema(words, [KINDS[straight].example, example])


def zone_field(*, zero: bool = False, timed: bool = True) -> tuple[BeforeValidator, WithJsonSchema]:
    """Make the parts of a length that may be written as an angle for machines that know what length it is, or as the time that it lasts.

    Angle and time are kept apart and the field is nothing: what length it is machine and line speed say. ``zero`` is whether none is
    allowed, ``timed`` whether a time is.
    """
    length = KINDS["length"]

    def read(value: object, info: ValidationInfo) -> float | None:
        if timed and _is(value, "time", signed=True):
            known = cast(Known, info.context)
            known.indirect.times[known.path(cast(str, info.field_name))] = read_quantity(value, "time")
            return None
        if not _is(value, "angle", zero=zero):
            return keep(read_quantity(value, "length", zero=zero), info)
        if cast(Known, info.context).machine is not None and not _by_angle(info):
            raise refusal(f'{shown(value)}: an angle, which only a {_knowing()} knows; write e.g. "{length.example}"')
        _keep_angle(read_quantity(value, "angle", zero=zero), info)
        return None

    least = "zero or more" if zero else "greater than zero"
    lasting = f", or {KINDS['time'].name} that it lasts at the line speed" if timed else ""
    words = f"{length.name}, of a {_knowing()} also {KINDS['angle'].name}{lasting}, {least}"
    return BeforeValidator(read), quantity_schema(words, [length.example, "60 deg", *(["40 ms"] if timed else [])])


def _knowing() -> str:
    """Name the machines that know lengths by an angle."""
    return " or ".join(kind for kind, machine in MACHINES.items() if machine.by_angle)


def _by_angle(info: ValidationInfo) -> bool:
    """Whether the machine of the file knows lengths by an angle."""
    machine = cast(Known, info.context).machine
    return machine is not None and machine.by_angle


def _keep_angle(value: float, info: ValidationInfo) -> None:
    """Keep an angle under its place until the machine is known."""
    known = cast(Known, info.context)
    known.indirect.angles[known.path(cast(str, info.field_name))] = value


def curve_field() -> tuple[BeforeValidator, WithJsonSchema]:
    """Make the parts of a motor's torque-speed curve: points of speed and torque, the speeds increasing from zero, the torques falling."""

    def read(value: object) -> tuple[tuple[float, float], ...]:
        if not isinstance(value, list) or len(value) < 2:
            raise refusal(f"{shown(value)}: not two points or more of speed and torque; write e.g. {_CURVE}")
        points: list[tuple[float, float]] = []
        for number, point in enumerate(value, start=1):
            if not isinstance(point, list) or len(point) != 2:
                raise refusal(
                    f"{shown(value)}: point {number}: {shown(point)} is not a pair of speed and torque; write e.g. {_CURVE}"
                )
            try:
                pair = (
                    read_quantity(point[0], "angular rate", zero=True, example="3000 rpm"),
                    read_quantity(point[1], "torque"),
                )
            except PydanticCustomError as error:
                raise refusal(f"{shown(value)}: point {number}: {error.message()}") from error
            before = value[number - 2]
            if number == 1 and pair[0] > 0:
                raise refusal(
                    f'{shown(value)}: point 1: the curve begins at standstill; write "0 rpm" for {shown(point[0])}'
                )
            if points and not pair[0] > points[-1][0]:
                raise refusal(
                    f"{shown(value)}: point {number}: {shown(point[0])} is not above {shown(before[0])}, the speed of the point before; "
                    "give the points by increasing speed"
                )
            if points and pair[1] > points[-1][1]:
                raise refusal(
                    f"{shown(value)}: point {number}: {shown(point[1])} is above {shown(before[1])}, the torque at a lower speed; "
                    f"a motor's torque does not grow with its speed, give {shown(before[1])} at most"
                )
            points.append(pair)
        return tuple(points)

    text = {"type": "string", "maxLength": 100}
    schema = {
        "type": "array",
        "minItems": 2,
        "items": {"type": "array", "prefixItems": [text, text], "minItems": 2, "maxItems": 2},
        "description": "torque that the motor gives over its speed: points of speed, increasing from zero, and torque, never increasing",
        "examples": [[["0 rpm", "12 N m"], ["3000 rpm", "8 N m"]]],
    }
    return BeforeValidator(read), WithJsonSchema(schema)


def _is(value: object, kind: str, *, zero: bool = False, signed: bool = False) -> bool:
    """Whether a value is a quantity of a kind, in range."""
    return isinstance(value, str) and _text_is(value, kind, zero, signed)


@lru_cache(maxsize=256)
def _text_is(text: str, kind: str, zero: bool, signed: bool) -> bool:
    """Whether a text is a quantity of a kind, in range; kept, like the quantities themselves."""
    try:
        quantity(text, kind, zero=zero, signed=signed)
    except InputError:
        return False
    return True


def targets_field() -> tuple[BeforeValidator, WithJsonSchema]:
    """Make the parts of a list of targets, each by its name in any case, or all of them."""

    def read(value: object) -> tuple[str, ...]:
        if isinstance(value, tuple):
            return value  # the default
        if value == "all":
            return tuple(TARGETS)
        if not isinstance(value, list) or not value or not all(isinstance(each, str) for each in value):
            raise refusal(f'{shown(value)}: not a list of targets; write e.g. targets = ["csv", "codesys"], or "all"')
        try:
            return tuple(dict.fromkeys(target_of(each).name for each in value))
        except InputError as error:
            raise refusal(f"{shown(value)}: {error}") from error

    schema = {
        "anyOf": [{"const": "all"}, {"type": "array", "minItems": 1, "items": {"type": "string", "maxLength": 40}}],
        "description": "a list of names of targets, or all",
        "examples": [["csv", "codesys"]],
        "default": ["csv"],
    }
    return BeforeValidator(read), WithJsonSchema(schema)
