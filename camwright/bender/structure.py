"""The structure of a bender's settings files: the bender job, and tables of springback."""

from __future__ import annotations

import re
from typing import Annotated, Literal, Self

from pydantic import AfterValidator, Field, model_validator

from camwright.house.servo_table import ServoNumbers
from camwright.house.setting_fields import Table, line_field, quantity_field, refusal, row_field, whole_field
from camwright.profiles.bender.bridges import BridgeRule
from camwright.profiles.bender.division import DivisionRule, EqualSides, EqualSteps, FewestBends
from camwright.profiles.bender.nc_code import Flavour
from camwright.profiles.bender.springback import PAPER_STEP, Interpolation
from camwright.profiles.limits import Limits

Unit = Literal["none", "mm", "cm", "m", "in", "ft"]
"""Unit of drawings, whatever their headers say; none for the headers'."""


class RuleTable(Table):
    """The rule that is bent."""

    _place = "rule"

    thickness: Annotated[float, *quantity_field("length", example="0.71 mm")]
    height: Annotated[float, *quantity_field("length", example="23.8 mm")]
    hardness: Annotated[str, *line_field("standard")]
    least_radius: Annotated[float, *quantity_field("length", example="0.5 mm")]


class ChordErrorTable(Table):
    """Arcs as the fewest bends within a chord error."""

    _place = "arcs"

    rule: Literal["chord_error"]
    chord_error: Annotated[float, *quantity_field("length", example="0.05 mm")]

    @property
    def division(self) -> DivisionRule:
        """The rule by which arcs become bends."""
        return FewestBends(self.chord_error)


class SidesTable(Table):
    """Arcs as equal sides of a full circle."""

    _place = "arcs"

    rule: Literal["sides"]
    sides: Annotated[int, whole_field(3, 100_000, 25)] = 25

    @property
    def division(self) -> DivisionRule:
        """The rule by which arcs become bends."""
        return EqualSides(self.sides)


class StepTable(Table):
    """Arcs as equal steps along them."""

    _place = "arcs"

    rule: Literal["step"]
    step: Annotated[float, *quantity_field("length", example="2 mm")]

    @property
    def division(self) -> DivisionRule:
        """The rule by which arcs become bends."""
        return EqualSteps(self.step)


class SpringbackTable(Table):
    """Which springback table is the rule's."""

    _place = "springback"

    table: Annotated[str, *line_field("example")]
    interpolation: Interpolation = "linear"


class MouldTable(Table):
    """The mould, which turns and bends: a joint below ``least_turn`` is smooth, an axis within its ``window`` has arrived."""

    _place = "mould"

    greatest_angle: Annotated[float, *quantity_field("angle", example="175 deg")]
    least_turn: Annotated[float, *quantity_field("angle", example="0.01 deg")]
    finger_radius: Annotated[float, *quantity_field("length", example="8 mm")]
    play: Annotated[float, *quantity_field("angle", zero=True, example="2.5 deg")]
    envelope: Annotated[
        list[Annotated[tuple[float, float], row_field("length", "length")]],
        Field(examples=[[["0 mm", "0 mm"], ["30 mm", "5 mm"]]]),
    ]
    speed: Annotated[float, *quantity_field("angular rate", example="720 deg/s")]
    acceleration: Annotated[float, *quantity_field("angular acceleration", example="20000 deg/s^2")]
    jerk: Annotated[float, *quantity_field("angular jerk", example="4000000 deg/s^3")]
    window: Annotated[float, *quantity_field("angle", example="0.02 deg")]


class FeedTable(Table):
    """The feed, which pushes the rule."""

    _place = "feed"

    least_step: Annotated[float, *quantity_field("length", example="0.05 mm")]
    speed: Annotated[float, *quantity_field("speed", example="30 m/min")]
    acceleration: Annotated[float, *quantity_field("acceleration", example="5 m/s^2")]
    jerk: Annotated[float, *quantity_field("jerk", example="1000 m/s^3")]
    window: Annotated[float, *quantity_field("length", example="0.01 mm")]


class DrawingTable(Table):
    """How drawings are read: ends within ``gap`` are joined, curves become polylines at most ``flattening`` away."""

    _place = "drawing"

    gap: Annotated[float, *quantity_field("length", example="0.01 mm")]
    flattening: Annotated[float, *quantity_field("length", example="0.01 mm")]
    units: Unit = "none"
    greatest_size: Annotated[float | None, *quantity_field("length", example="2 m")] = None


_COMMAND = re.compile(r"M\d{1,4}")
_PROGRAM_STOPS = {0, 1, 2, 30}
"""M functions that stop or end a program in every control."""


def _cut_command(text: str) -> str:
    if not _COMMAND.fullmatch(text) or int(text[1:]) in _PROGRAM_STOPS:
        raise refusal(
            f'"{text}": not a cut command; write the M function that the builder of the machine gave to its cutting tool, e.g. '
            'command = "M20" (M0, M1, M2 and M30 stop the program), or leave it out: bridges are then cut by hand'
        )
    return text


class BridgesTable(Table):
    """Bridges: breaks of the rule, and their tool."""

    _place = "bridges"

    width: Annotated[float | None, *quantity_field("length", example="6 mm")] = None
    spacing: Annotated[float | None, *quantity_field("length", example="100 mm")] = None
    layer: Annotated[str | None, *line_field("BRIDGES")] = None
    at: Annotated[
        list[Annotated[float, *quantity_field("length", example="50 mm")]], Field(examples=[["50 mm", "150 mm"]])
    ] = Field(default_factory=list)
    clearance: Annotated[float, *quantity_field("length", zero=True, example="2 mm")] = BridgeRule.clearance
    command: Annotated[str | None, *line_field("M20"), AfterValidator(_cut_command)] = None
    tool_distance: Annotated[float, *quantity_field("length", zero=True, example="40 mm")] = 0.0

    @model_validator(mode="after")
    def _whole(self) -> Self:
        ways = (self.spacing is not None) + bool(self.at) + (self.layer is not None)
        if ways > 1:
            raise refusal("spacing, at and layer exclude each other: leave one of them")
        if ways and self.width is None:
            raise refusal('width is missing: write how much of the rule is cut out, e.g. width = "6 mm"')
        if self.width is not None and not ways:
            raise refusal(
                'spacing is missing: write how far apart bridges are, e.g. spacing = "100 mm", or their places, at = ["50 mm"], '
                'or the layer of their marks, layer = "BRIDGES"'
            )
        return self

    @property
    def rule(self) -> BridgeRule:
        """Which bridges a rule gets."""
        return BridgeRule(
            self.width or 0.0,
            self.spacing,
            tuple(self.at),
            self.clearance,
            self.command,
            self.tool_distance,
            self.layer,
        )


class ProgramTable(Table):
    """How programs are written."""

    _place = "program"

    flavour: Flavour = "fagor"
    first_line: Annotated[int, whole_field(4, 99_999_999, 10)] = 10
    last_line: Annotated[int, whole_field(4, 99_999_999, 9999)] = 9999


class BenderFile(Table):
    """A bender job: the machine, the rule, and how drawings become programs."""

    name: Annotated[str, *line_field("example-bender")]
    rule: RuleTable
    arcs: Annotated[ChordErrorTable | SidesTable | StepTable, Field(discriminator="rule")]
    springback: SpringbackTable
    mould: MouldTable
    feed: FeedTable
    servo: ServoNumbers
    drawing: DrawingTable
    program: ProgramTable
    bridges: BridgesTable = BridgesTable()


class SpringbackRule(Table):
    """What one rule springs back."""

    thickness: Annotated[float, *quantity_field("length", example="0.71 mm")]
    hardness: Annotated[str, *line_field("standard")]
    angles: Annotated[
        list[Annotated[tuple[float, float], row_field("angle", "angle")]], Field(examples=[[["15 deg", "16.8 deg"]]])
    ]
    radius_step: Annotated[float, *quantity_field("angle", example="14.4 deg")] = PAPER_STEP
    radii: Annotated[list[Annotated[tuple[float, float], row_field("length", "angle")]], Field(default=[])]


class SpringbackFile(Table):
    """Springback of one rule or more."""

    name: Annotated[str, *line_field("steel")]
    rule: Annotated[list[SpringbackRule], Field(min_length=1)]


def limits_of(axis: MouldTable | FeedTable) -> Limits:
    """Limits of an axis of the bender."""
    return Limits(axis.speed, axis.acceleration, axis.jerk, reversal=True)
