"""The servo's table, as settings files of every machine have it."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from camwright.house.setting_fields import Table, number_field, quantity_field


class ServoNumbers(Table):
    """The numbers that every discrete servo has."""

    _place = "servo"

    bandwidth: Annotated[float, *quantity_field("angular rate")]
    damping: Annotated[
        float,
        number_field(0.0, 100.0, "the damping ratio must be above 0 (else the velocity loop never settles) and at most 100; "
                     "drives have 0.7 to 0.9", "0.7", above=True),
        Field(description="damping ratio of the velocity loop", examples=[0.7],
              json_schema_extra={"exclusiveMinimum": 0, "maximum": 100}),
    ]  # fmt: skip
    position_gain: Annotated[float, *quantity_field("gain")]
    sample_time: Annotated[float, *quantity_field("time")]
    velocity_feedforward: Annotated[
        float,
        number_field(0.0, 1.0, "it is the share of the command's velocity that is fed forward, from 0 (none) to 1 (all, no "
                     "following error at constant speed); more makes the axis run ahead of its command", "1.0"),
        Field(description="share of the command's velocity fed forward", examples=[1.0],
              json_schema_extra={"minimum": 0, "maximum": 1}),
    ]  # fmt: skip
