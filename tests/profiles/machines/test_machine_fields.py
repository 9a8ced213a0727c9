"""What machines say of their fields, and the answers that most of them leave to `Machine`."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import pytest

from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.machines import MACHINES, CrankSlider, LinearCarriage, Machine, RotaryKnife
from camwright.profiles.machines.fields import BareNumber, Choice, Quantity, Whole, fields_of

CUT = Cut(0.6, 1.0, 0.2, 0.04, 0.16, 1e-4)
KNIFE, CARRIAGE, CRANK = RotaryKnife(0.4), LinearCarriage(0.8, home=0.1), CrankSlider(0.15, 0.6)


def test_the_machines_are_known_by_the_kind_that_they_name() -> None:
    assert {kind: machine.kind for kind, machine in MACHINES.items()} == {kind: kind for kind in MACHINES}
    assert set(MACHINES.values()) >= {RotaryKnife, LinearCarriage, CrankSlider}
    for machine in MACHINES.values():
        assert machine.noun
        assert machine.summary.endswith(".")


@pytest.mark.parametrize("machine", MACHINES.values())
def test_every_field_says_what_it_is(machine: type[Machine]) -> None:
    found = fields_of(machine)
    assert len({each.key for each in found}) == len(found)
    for each in found:
        assert each.about.description
        if isinstance(each.about, Choice):
            assert each.required or each.default in each.about.words
        elif isinstance(each.about, Whole | BareNumber):
            least = each.about.least if isinstance(each.about, Whole) else math.nextafter(each.about.above, math.inf)
            for value in (each.about.example, *(() if each.required else (each.default,))):
                assert least <= value <= each.about.greatest
        elif not (each.required or each.free):
            assert each.default >= 0.0
    assert [each.name for each in found if each.free] == ([machine.place_name] if machine.place_name else [])


def test_a_field_that_does_not_say_what_it_is_is_refused_when_it_is_asked() -> None:
    @dataclass(frozen=True)
    class Unnamed:
        kind: ClassVar[str] = "unnamed"
        length: Annotated[float, Quantity("length")] = 1.0
        width: float = 2.0

    with pytest.raises(TypeError, match=r"Unnamed\.width does not say what it is"):
        fields_of(Unnamed)


@pytest.mark.parametrize(
    ("machine", "loads"),
    [
        (KNIFE, {"drum_inertia", "drum_friction"}),
        (CARRIAGE, {"mass"}),
        (CRANK, {"crank_inertia", "carriage_mass"}),
    ],
)
def test_what_the_motor_moves_is_told_by_the_kinds_of_the_fields(machine: Machine, loads: set[str]) -> None:
    assert {each.name for each in fields_of(type(machine)) if each.load} == loads
    assert not machine.moves_something
    for name in loads:
        values: dict[str, Any] = {**vars(machine), name: 1.0}
        assert type(machine)(**values).moves_something


def test_only_a_carriage_has_a_guide() -> None:
    assert (KNIFE.guide, CRANK.guide) == (None, None)
    assert CARRIAGE.guide == pytest.approx((0.1, 0.9))
    assert CARRIAGE.with_guide(2.0).guide == (0.1, 2.1)
    with pytest.raises(TypeError, match="rotary_knife of no guide"):
        KNIFE.with_guide(1.0)


def test_only_a_crank_has_a_place_to_choose_and_dead_centres() -> None:
    assert (KNIFE.placed, CARRIAGE.placed, CRANK.placed) == (True, True, False)
    assert math.isnan(CRANK.place)
    assert math.isnan(KNIFE.place)
    assert CRANK.placed_at(1.7).place == 1.7
    assert (KNIFE.dead_centres, CARRIAGE.dead_centres) == (None, None)
    with pytest.raises(TypeError, match="cannot be placed"):
        KNIFE.place_range(CUT)


def test_a_turn_of_each_is_told_in_its_slaves_own_unit() -> None:
    assert (KNIFE.slave_turn, CARRIAGE.slave_turn, CRANK.slave_turn) == (0.4, 1.0, 2 * math.pi)


@pytest.mark.parametrize(
    ("machine", "cut"),
    [
        (LinearCarriage(0.1), CUT),
        (RotaryKnife(0.4, sync="horizontal"), CUT),
        (CrankSlider(0.05, 0.6, sync_at=1.6), CUT),
        (CrankSlider(0.15, 0.6, sync_at=0.1), CUT),
    ],
)
def test_a_zone_that_does_not_fit_is_refused_in_the_words_of_its_faults(machine: Machine, cut: Cut) -> None:
    faults = machine.zone_faults(cut)
    assert len(faults) == 1
    with pytest.raises(InputError) as refused:
        machine.sync_start(cut)
    assert refused.value.messages == faults


def test_a_sync_pace_is_the_greatest_ratio_in_the_zone() -> None:
    for machine in (KNIFE, CARRIAGE, RotaryKnife(0.8, sync="horizontal"), CRANK.placed_at(1.7)):
        assert machine.sync_pace(CUT) == pytest.approx(machine.sync_profile(CUT).extrema(1)[1].value, rel=1e-12)
