"""The parameters of a recipe as a list: machine, product, limits, servo, each with its value and SI unit."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

from camwright.house.numbers import shown, unit_shown, with_unit
from camwright.house.units import KINDS
from camwright.profiles.machines import MACHINES
from camwright.profiles.machines.fields import Choice, MachineField, Quantity, fields_of
from camwright.recipes.catalogue import Catalogue
from camwright.recipes.model import Recipe


@dataclass(frozen=True)
class Fact:
    """One parameter.

    Parameters
    ----------
    key
        Key of a job file, or what it is called.
    value
        A number (SI), a word of the catalogue, yes or no, or nothing.
    unit
        SI unit of a number; ``"curve"`` for pairs of motor speed and torque.
    group
        ``"machine"`` for what the machine says of itself, whose words other parameters may have too.
    ends
        Ends of the range that the job gives of it.
    """

    key: str
    value: Any
    unit: str = "1"
    group: str = ""
    ends: tuple[float, float] | None = None

    @property
    def name(self) -> str:
        """Key of its name in the catalogue."""
        return f"{self.group}.{self.key}" if self.group else self.key


PRODUCT = {
    "length": "m",
    "line_speed": "m/s",
    "sync_zone": "m",
    "shear_zone": "m",
    "shear_zone_at": "m",
    "sync_time": "s",
    "shear_time": "s",
    "sync_tolerance": "m",
    "sync_ratio": "1",
    "origin": "word",
    "shaped": "word",
}

LINE = {"acceleration": "m/s^2", "stop": "m/s^2", "jerk": "m/s^3"}

POWERS = {"speed": "/s", "acceleration": "/s^2", "jerk": "/s^3"}
"""Measures of the slave, by what follows its unit."""

AT_SPEED = {
    "line_speed": "m/s",
    "motor_speed": "rad/s",
    "peak_torque": "N m",
    "rms_torque": "N m",
    "following_error": "m",
    "sync_error": "m",
    "worst_sync_error": "m",
    "length_offset": "m",
    "length_offset_with_lead": "m",
    "length_variation": "m",
}
"""What is expected at a line speed, besides the measures of the slave."""

SERVO = {
    "bandwidth": "bandwidth",
    "damping": "1",
    "position_gain": "1/s",
    "sample_time": "s",
    "velocity_feedforward": "1",
    "acceleration_feedforward": "s^2",
    "jerk_feedforward": "s^3",
    "dead_time": "s",
    "lead_time": "s",
}


def machine_facts(recipe: Recipe) -> list[Fact]:
    """List the machine's parameters."""
    values = recipe.job.si["machine"]
    units = {each.key: _unit(each) for each in fields_of(MACHINES[values["kind"]])}
    order = dict.fromkeys(each.key for machine in MACHINES.values() for each in fields_of(machine))
    facts = [Fact("kind", values["kind"], "word"), *listed(values, {key: units[key] for key in order if key in units})]
    return [replace(fact, group="machine") for fact in facts]


def _unit(each: MachineField) -> str:
    """Name the unit of a machine's number, as of `Fact`."""
    if isinstance(each.about, Quantity):
        return KINDS[each.about.kind].unit
    return "word" if isinstance(each.about, Choice) else "1"


def product_facts(recipe: Recipe) -> list[Fact]:
    """List the product's numbers and what follows from them."""
    cut = recipe.job.si["cut"]
    facts = [fact for fact in listed(cut, PRODUCT) if fact.key != "shaped" or fact.value]  # the exception
    facts.insert(2, Fact("cuts", 60.0 * cut["line_speed"] / cut["length"]))
    unit = recipe.slave_unit
    return [*facts, Fact("slave_start", recipe.slave_start, unit), Fact("pitch", recipe.pitch, unit)]


def limit_facts(recipe: Recipe) -> list[Fact]:
    """List the limits of the slave, and the ramps of the line that it keeps them in."""
    limits, unit = recipe.job.si["limits"], recipe.slave_unit
    facts = [Fact(key, limits[key], unit + power) for key, power in POWERS.items()]
    turns_back = MACHINES[recipe.job.si["machine"]["kind"]].turns_back  # a carriage cannot help it
    facts.append(Fact("reversal", limits["reversal"] or turns_back, "word"))
    if limits["motor"] is not None:
        facts.append(Fact("motor", limits["motor"]["points"], "curve"))
    line = recipe.job.si.get("line", {})
    return [*facts, *(Fact(key, line[key], unit, "line") for key, unit in LINE.items() if line.get(key) is not None)]


def servo_facts(recipe: Recipe) -> list[Fact]:
    """List the servo's parameters and the lead time that makes up for its lag."""
    return [*servo_rows(recipe.job.si), Fact("mean_lag", recipe.lead_time, "s")]


def servo_rows(si: dict[str, Any]) -> list[Fact]:
    """List the servo's parameters of a job's numbers, with the ranges that it gives."""
    ranges = {key: tuple(ends) for key, ends in (si.get("servo_tolerance") or {}).items() if ends[0] != ends[1]}
    return [replace(fact, ends=ranges.get(fact.key)) for fact in listed(si["servo"], SERVO)]


GROUPS = {
    "section.machine": machine_facts,
    "section.product": product_facts,
    "section.limits": limit_facts,
    "section.servo": servo_facts,
}
"""The parameters by group, under the heading's key."""


def listed(values: dict[str, Any], units: dict[str, str]) -> list[Fact]:
    """List those of some numbers that there are, by their units."""
    return [Fact(key, values[key], unit) for key, unit in units.items() if key in values]


def fact_text(fact: Fact, words: Catalogue) -> str:
    """Write the value of a parameter with its unit."""
    value = fact.value
    if value is None:
        return words("nothing")
    if isinstance(value, bool):
        return words("yes" if value else "no")
    if isinstance(value, str):
        return words.named("word", value)
    if fact.unit == "curve":
        return _curve_text(value, words)
    if fact.ends is None:
        return with_unit(value, fact.unit, units=words.units)
    low, middle, high = (shown(each, fact.unit, units=words.units) for each in (fact.ends[0], value, fact.ends[1]))
    unit = "" if fact.unit == "1" else f" {unit_shown(fact.unit, words.units)}"
    return f"{middle} ({words('speeds.span', low=low, high=high)}){unit}"


def _curve_text(points: Iterable[Iterable[float]], words: Catalogue) -> str:
    pairs = [
        (with_unit(speed, "rad/s", 4, words.units), with_unit(torque, "N m", 4, words.units))
        for speed, torque in points
    ]
    return ";\n".join(f"{speed}, {torque}" for speed, torque in pairs)
