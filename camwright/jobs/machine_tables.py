"""The machine tables of job files, one for each kind of machine, and the machines that they stand for."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Annotated, Literal

from pydantic import Field

from camwright.jobs.fields import (
    Known,
    Table,
    number_field,
    quantity_field,
    whole_field,
)
from camwright.profiles.machines import (
    CrankSlider,
    LinearCarriage,
    Machine,
    RotaryKnife,
)

_GEAR = number_field(
    0.0,
    1e6,
    "it is motor turns per turn of the machine, above 0 and at most 1e6; write 1 for a direct drive",
    "10",
    above=True,
)
_GearRatio = Annotated[
    float,
    _GEAR,
    Field(description="motor turns per turn", examples=[10], json_schema_extra={"exclusiveMinimum": 0, "maximum": 1e6}),
]
_NONE_MASS = Field(json_schema_extra={"default": "0 kg"})
_NONE_INERTIA = Field(json_schema_extra={"default": "0 kg m^2"})


class RotaryKnifeTable(Table):
    """Blades on a drum that turns one way."""

    kind: Annotated[Literal["rotary_knife"], Field(description="which machine", examples=["rotary_knife"])]
    circumference: Annotated[float, *quantity_field("length", example="400 mm")]
    blades: Annotated[
        int,
        whole_field(1, 1000, 2),
        Field(description="blades, evenly spaced", json_schema_extra={"minimum": 1, "maximum": 1000}),
    ] = 1
    gear_ratio: _GearRatio = 1.0
    sync: Annotated[
        Literal["tangential", "horizontal"],
        Field(description="which speed of the blade is in sync: on its circle, or along the material"),
    ] = "tangential"
    inertia: Annotated[float, *quantity_field("inertia", zero=True), _NONE_INERTIA] = 0.0
    friction: Annotated[float, *quantity_field("torque", zero=True), Field(json_schema_extra={"default": "0 N m"})] = (
        0.0
    )


class LinearCarriageTable(Table):
    """A carriage on a screw or rack: flying shear, flying saw."""

    kind: Annotated[Literal["linear_carriage"], Field(description="which machine", examples=["linear_carriage"])]
    stroke: Annotated[float, *quantity_field("length", example="800 mm")]
    home: Annotated[
        float, *quantity_field("length", signed=True, example="0 mm"), Field(json_schema_extra={"default": "0 mm"})
    ] = 0.0
    mass: Annotated[float, *quantity_field("mass", zero=True), _NONE_MASS] = 0.0
    travel_per_turn: Annotated[
        float, *quantity_field("length", example="20 mm"), Field(json_schema_extra={"default": "1 m"})
    ] = 1.0


class CrankSliderTable(Table):
    """A carriage driven by a crank and a rod: chasing shear."""

    kind: Annotated[Literal["crank_slider"], Field(description="which machine", examples=["crank_slider"])]
    crank: Annotated[float, *quantity_field("length", example="150 mm")]
    rod: Annotated[float, *quantity_field("length")]
    offset: Annotated[
        float, *quantity_field("length", signed=True, example="0 mm"), Field(json_schema_extra={"default": "0 mm"})
    ] = 0.0
    crank_inertia: Annotated[float, *quantity_field("inertia", zero=True), _NONE_INERTIA] = 0.0
    carriage_mass: Annotated[float, *quantity_field("mass", zero=True), _NONE_MASS] = 0.0
    gear_ratio: _GearRatio = 1.0
    sync_at: Annotated[float | None, *quantity_field("angle", signed=True)] = None


MachineTable = Annotated[RotaryKnifeTable | LinearCarriageTable | CrankSliderTable, Field(discriminator="kind")]
"""Any machine table."""

TABLES: dict[str, type[Table]] = {
    "rotary_knife": RotaryKnifeTable,
    "linear_carriage": LinearCarriageTable,
    "crank_slider": CrankSliderTable,
}
"""The machine tables by kind."""


def machine_of(known: Known) -> Machine | None:
    """Make the machine of a job file from what is known of it; nothing where a number is missing that it needs."""
    make = _MAKERS.get(known.kind or "")
    try:
        return None if make is None else make(known)
    except KeyError:
        return None


def _rotary_knife(known: Known) -> RotaryKnife | None:
    number = known.numbers
    if known.sync not in ("tangential", "horizontal"):
        return None
    return RotaryKnife(
        circumference=number["circumference"],
        blades=int(number["blades"]),
        gear_ratio=number["gear_ratio"],
        sync="tangential" if known.sync == "tangential" else "horizontal",
        drum_inertia=number["inertia"],
        drum_friction=number["friction"],
    )


def _linear_carriage(known: Known) -> LinearCarriage:
    number = known.numbers
    return LinearCarriage(number["stroke"], number["home"], number["mass"], number["travel_per_turn"])


def _crank_slider(known: Known) -> CrankSlider:
    number = known.numbers
    return CrankSlider(
        crank=number["crank"],
        rod=number["rod"],
        offset=number["offset"],
        crank_inertia=number["crank_inertia"],
        carriage_mass=number["carriage_mass"],
        gear_ratio=number["gear_ratio"],
        sync_at=number.get("sync_at", math.nan),
    )


_MAKERS: dict[str, Callable[[Known], Machine | None]] = {
    "rotary_knife": _rotary_knife,
    "linear_carriage": _linear_carriage,
    "crank_slider": _crank_slider,
}
