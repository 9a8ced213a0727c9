"""Job files of every machine: what they mean, and every fault of theirs with the value that would work."""

from __future__ import annotations

import json
import math
import re
import tomllib
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, ClassVar

import jsonschema
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camwright.jobs.job import Job, load_job, parse_job
from camwright.jobs.numbers import job_numbers
from camwright.jobs.structure import job_schema
from camwright.profiles.errors import InputError
from camwright.profiles.machines import MACHINES, CrankSlider, LinearCarriage, RotaryKnife
from camwright.profiles.machines.fields import Quantity
from camwright.profiles.motor import MotorCurve

EXAMPLES = Path(__file__).parents[2] / "examples"
TEXTS = {
    name: (EXAMPLES / f"{name}.toml").read_text(encoding="utf-8")
    for name in ("paper-600", "flying-saw", "chasing-shear", "thick-product")
}


def changed(name: str, *changes: tuple[str, str]) -> str:
    """Change the lines of some keys of an example, or add them to the table where their first key would stand."""
    text = TEXTS[name]
    for key, line in changes:
        if "." in key:  # table.key: a line that is not there yet
            table = key.split(".")[0]
            text, count = re.subn(rf"(?m)^\[{table}\]$", f"[{table}]\n{line}", text)
        else:
            text, count = re.subn(rf"(?m)^{re.escape(key)}\b.*$", line, text)
        assert count == 1, key
    return text


def read(name: str, *changes: tuple[str, str]) -> Job:
    return parse_job(changed(name, *changes), "job.toml")


def faults(name: str, *changes: tuple[str, str]) -> tuple[str, ...]:
    with pytest.raises(InputError) as caught:
        read(name, *changes)
    return tuple(fault.removeprefix("job.toml: ") for fault in caught.value.faults)


def test_the_flying_saw_in_si_numbers() -> None:
    job = load_job(EXAMPLES / "flying-saw.toml")
    assert job.machine == LinearCarriage(stroke=1.2, home=0.0, mass=180.0, travel_per_turn=0.04)
    assert job.objective == "rms_torque"
    assert read("flying-saw", ("home", 'home = "-100 mm"')).machine == replace(job.machine, home=-0.1)


def test_the_chasing_shear_in_si_numbers() -> None:
    job = load_job(EXAMPLES / "chasing-shear.toml")
    machine = job.machine
    assert isinstance(machine, CrankSlider)
    assert math.isnan(machine.sync_at)
    assert replace(machine, sync_at=1.0) == CrankSlider(0.15, 0.6, 0.0, 0.6, 60.0, 10.0, 1.0)
    assert job.limits.speed == pytest.approx(300 * 2 * math.pi / 60, rel=1e-15)
    assert (job.limits.acceleration, job.limits.jerk) == (400.0, 20000.0)
    placed = read("chasing-shear", ("machine.sync_at", 'sync_at = "95 deg"'), ("offset", 'offset = "-20 mm"')).machine
    assert placed == replace(machine, sync_at=math.radians(95.0), offset=-0.02)


def test_the_thick_products_knife_in_si_numbers() -> None:
    job = load_job(EXAMPLES / "thick-product.toml")
    assert job.machine == RotaryKnife(0.8, 2, 5.0, "horizontal", 0.5, 3.0)
    assert job.machine.pitch == 0.4


@given(degrees=st.integers(1, 150), ratio=st.sampled_from([0.9, 1.0, 1.05]))
def test_an_angle_is_what_the_blade_turns_in_the_sync_zone(degrees: int, ratio: float) -> None:
    """The machine's own sync profile, over the length that the angle was turned into, turns by the angle."""
    for sync in ("tangential", "horizontal"):
        job = read(
            "thick-product",
            ("sync_zone", f'sync_zone = "{degrees} deg"'),
            ("sync_ratio", f"sync_ratio = {ratio}"),
            ("sync", f'sync = "{sync}"'),
            ("shear_zone", ""),
            ("shear_zone_at", ""),
            ("line_speed", 'line_speed = "1 m/min"'),
        )
        assert isinstance(job.machine, RotaryKnife)
        turned = job.machine.sync_profile(job.cut).advance / job.machine.radius
        assert math.degrees(turned) == pytest.approx(degrees, rel=1e-9)


def test_what_is_left_out_has_the_stated_default() -> None:
    bare = parse_job(
        re.sub(r"(?m)^(blades|gear_ratio|sync|inertia|friction|sync_ratio)\b.*$", "", TEXTS["thick-product"]), ""
    )
    assert (bare.machine, bare.cut.sync_ratio) == (RotaryKnife(0.8), 1.0)
    text = re.sub(r"(?m)^(home|mass|travel_per_turn|minimise)\b.*$", "", TEXTS["flying-saw"])
    assert parse_job(text, "").machine == LinearCarriage(1.2)
    text = re.sub(r"(?m)^(offset|crank_inertia|carriage_mass|gear_ratio|minimise)\b.*$", "", TEXTS["chasing-shear"])
    assert replace(parse_job(text, "").machine, sync_at=0.0) == CrankSlider(0.15, 0.6, sync_at=0.0)


@pytest.mark.parametrize("name", TEXTS)
def test_numbers_of_a_job_are_plain_json(name: str) -> None:
    numbers = json.loads(json.dumps(job_numbers(read(name)), allow_nan=False))
    assert numbers["machine"].keys() >= set(tomllib.loads(TEXTS[name])["machine"])
    if name == "chasing-shear":
        assert numbers["machine"]["sync_at"] is None


@pytest.mark.parametrize(
    ("name", "key", "line", "message"),
    [
        ("thick-product", "blades", "blades = 2.5",
         "[machine] blades = 2.5: not a whole number from 1 to 1000; write e.g. blades = 2"),
        ("thick-product", "blades", "blades = 0", "[machine] blades = 0: not a whole number from 1 to 1000"),
        ("thick-product", "blades", 'blades = "2"', "[machine] blades = '2': not a whole number from 1 to 1000"),
        ("thick-product", "blades", "blades = true", "[machine] blades = True: not a whole number from 1 to 1000"),
        ("thick-product", "gear_ratio", "gear_ratio = 0",
         "[machine] gear_ratio = 0: it is motor turns per turn of the machine, above 0"),
        ("thick-product", "sync", 'sync = "vertical"',
         "[machine] sync = 'vertical': not known; write \"tangential\" or \"horizontal\""),
        ("thick-product", "inertia", 'inertia = "5 kg"',
         "[machine] inertia = '5 kg': a mass, but an inertia is expected; write e.g. \"0.05 kg m^2\""),
        ("thick-product", "friction", 'friction = "3 N"', "but a torque is expected; write e.g. \"12 N m\""),
        ("thick-product", "friction", 'friction = "-3 N m"', "negative; a torque not below zero is expected"),
        ("thick-product", "sync_ratio", "sync_ratio = 0",
         "[cut] sync_ratio = 0: it is the speed of the tool over that of the material"),
        ("thick-product", "sync_ratio", 'sync_ratio = "1"',
         "[cut] sync_ratio = '1': not a number; write e.g. sync_ratio = 1.0"),
        ("thick-product", "sync_zone", 'sync_zone = "-40 deg"',
         "[cut] sync_zone = '-40 deg': an angle, but a length is expected"),
        ("thick-product", "sync_zone", 'sync_zone = "170 deg"',
         ("(170 deg): takes the blade beyond ±80° from the cut point, where horizontal sync ends; "
         "shorten it to 160 deg at most")),
        ("thick-product", "sync_zone", 'sync_zone = "252 mm"',
         ("[cut] sync_zone = 252 mm: takes the blade beyond ±80° from the cut point, where horizontal "
         "sync ends; shorten it to 250.779 mm at most")),
        ("flying-saw", "mass", 'mass = "20 N"', "but a mass is expected; write e.g. \"20 kg\""),
        ("flying-saw", "speed", 'speed = "300 rpm"',
         ("[limits] speed = '300 rpm': an angular rate, but the slave of a linear_carriage is counted "
         'in metres; write e.g. "80 m/min"')),
        ("flying-saw", "sync_zone", 'sync_zone = "60 deg"',
         "[cut] sync_zone = '60 deg': an angle, which only a rotary_knife knows; write e.g. \"600 mm\""),
        ("flying-saw", "stroke", 'stroke = "600 mm"',
         ("[machine] stroke = 600 mm: not above the 700 mm that the carriage travels in the sync zone; "
         "lengthen it to 700.001 mm at least, or shorten [cut] sync_zone to 599.999 mm at most")),
        ("flying-saw", "stroke", "", "[machine] stroke: missing; add e.g. stroke = \"800 mm\""),
        ("flying-saw", "mass", "",
         ("[objective] minimise = 'rms_torque': the motor's torque depends on what it moves, which "
         '[machine] does not say; add e.g. mass = "20 kg", or minimise "rms_acceleration"')),
        ("flying-saw", "speed", 'speed = "39 m/min"',
         ("[limits] speed = 39 m/min: below [cut] line_speed = 40 m/min, at which the carriage runs in "
         "the sync zone; run the line at 39 m/min at most")),
        ("chasing-shear", "rod", 'rod = "140 mm"',
         ("[machine] rod = 140 mm: not above [machine] crank + |offset| = 150 mm, so the crank could "
         "not turn all the way round; lengthen the rod to 150.001 mm at least, or shorten the crank to "
         "139.999 mm at most")),
        ("chasing-shear", "offset", 'offset = "-450 mm"',
         "[machine] rod = 600 mm: not above [machine] crank + |offset| = 600 mm"),
        ("chasing-shear", "sync_zone", 'sync_zone = "310 mm"',
         ("[cut] sync_zone = 310 mm: the carriage would travel 310 mm, not below the crank's stroke of "
         "300 mm; shorten the sync zone to 299.999 mm at most")),
        ("chasing-shear", "speed", 'speed = "200 m/min"',
         ("[limits] speed = '200 m/min': a speed, but the slave of a crank_slider turns; write e.g. "
         '"300 rpm"')),
        ("chasing-shear", "acceleration", 'acceleration = "30 m/s^2"',
         ("[limits] acceleration = '30 m/s^2': an acceleration, but the slave of a crank_slider turns; "
         'write e.g. "2000 rad/s^2"')),
        ("chasing-shear", "jerk", "jerk = 5", "[limits] jerk = 5: a number without a unit; write e.g. \"5 rad/s^3\""),
        ("chasing-shear", "jerk", "", "[limits] jerk: missing; add e.g. jerk = \"50000 rad/s^3\""),
        ("chasing-shear", "machine.sync_at", 'sync_at = "20 deg"',
         ("[machine] sync_at = 20 deg: leaves no room for the sync zone of 150 mm between the dead "
         "centres; place it between ")),
        ("chasing-shear", "machine.sync_at", "sync_at = 95",
         '[machine] sync_at = 95: a number without a unit; write e.g. "95 deg"'),
        ("chasing-shear", "crank", "", "[machine] crank: missing; add e.g. crank = \"150 mm\""),
        ("chasing-shear", "crank", 'circumference = "1 m"',
         "[machine] circumference: there is no such key; the keys here are kind, crank, rod"),
        ("chasing-shear", "kind", 'kind = "crank"',
         ("[machine] kind = 'crank': not known; write \"rotary_knife\", \"linear_carriage\" or "
         '"crank_slider"')),
    ],
)  # fmt: skip
def test_a_fault_is_told_with_its_place_and_what_would_work(name: str, key: str, line: str, message: str) -> None:
    found = faults(name, (key, line))
    assert any(message in fault for fault in found), found


def test_the_suggested_values_work_as_they_are_printed() -> None:
    slow = ("line_speed", 'line_speed = "10 m/min"')
    read("thick-product", ("sync_zone", 'sync_zone = "160 deg"'), slow)
    read("thick-product", ("sync_zone", 'sync_zone = "250.779 mm"'), slow)
    read("flying-saw", ("stroke", 'stroke = "700.001 mm"'))
    read("flying-saw", ("stroke", 'stroke = "600 mm"'), ("sync_zone", 'sync_zone = "599.999 mm"'))
    read("chasing-shear", ("rod", 'rod = "150.001 mm"'))
    read("chasing-shear", ("rod", 'rod = "140 mm"'), ("crank", 'crank = "139.999 mm"'))


def test_the_range_named_for_sync_at_is_the_whole_range() -> None:
    (fault,) = faults("chasing-shear", ("machine.sync_at", 'sync_at = "20 deg"'))
    least, greatest = map(float, re.findall(r"([0-9.]+) deg", fault)[-2:])
    for degrees in (least, greatest):
        changes = (("machine.sync_at", f'sync_at = "{degrees} deg"'), ("speed", 'speed = "100000 rpm"'))
        read("chasing-shear", *changes)
    for degrees in (least - 0.002, greatest + 0.002):
        changes = (("machine.sync_at", f'sync_at = "{degrees} deg"'), ("speed", 'speed = "100000 rpm"'))
        assert "sync_at" in faults("chasing-shear", *changes)[0]


def test_blades_share_the_circumference() -> None:
    tangential = (("sync", 'sync = "tangential"'), ("sync_ratio", "sync_ratio = 1.1"), ("length", 'length = "900 mm"'))
    (fault,) = faults("thick-product", ("sync_zone", 'sync_zone = "364 mm"'), *tangential)
    assert fault.startswith(
        "[cut] sync_zone = 364 mm: not below the 363.6363636 mm that [machine] circumference = 800 mm, blades = 2 and"
    )
    longest = re.search(r"shorten the sync zone to ([0-9.]+ mm) at most", fault)
    assert longest is not None
    read("thick-product", ("sync_zone", f'sync_zone = "{longest.group(1)}"'), *tangential)
    (fault,) = faults("thick-product", ("blades", "blades = 9"))
    assert "blades = 9" in fault


def test_the_crank_must_be_as_fast_as_the_sync_zone_needs_wherever_it_lies() -> None:
    """Against the least over a scan of places."""
    job = read("chasing-shear", ("offset", 'offset = "40 mm"'))
    machine = job.machine
    assert isinstance(machine, CrankSlider)
    least, greatest = machine.place_range(job.cut)
    scan = [replace(machine, sync_at=least + (greatest - least) * i / 400).sync_pace(job.cut) for i in range(1, 400)]
    best = machine.sync_pace(job.cut)
    assert best <= min(scan)
    assert best == pytest.approx(min(scan), rel=2e-3)
    rpm = best * job.cut.line_speed * 30 / math.pi
    slow = ("speed", f'speed = "{0.999 * rpm:.6f} rpm"')
    (fault,) = faults("chasing-shear", ("offset", 'offset = "40 mm"'), slow)
    assert "that the crank needs in the sync zone, wherever it lies on the crank" in fault
    works = re.search(r"run the line at ([0-9.]+ m/min) at most", fault)
    assert works is not None
    read("chasing-shear", ("offset", 'offset = "40 mm"'), slow, ("line_speed", f'line_speed = "{works.group(1)}"'))


def test_horizontal_sync_and_over_speed_need_a_faster_knife() -> None:
    need = 30 / math.cos(math.radians(20.0))
    (fault,) = faults("thick-product", ("speed", f'speed = "{need - 0.01:.6f} m/min"'))
    assert f"below the {need:.6g} m/min at which the knife runs in the sync zone" in fault
    read("thick-product", ("speed", f'speed = "{need + 0.01:.6f} m/min"'))
    (fault,) = faults("flying-saw", ("cut.sync_ratio", "sync_ratio = 1.2"), ("speed", 'speed = "47 m/min"'))
    assert (
        "below the 48 m/min at which the carriage runs in the sync zone ([cut] line_speed = 40 m/min, times 1.2)"
        in fault
    )


def test_a_motors_curve_is_read() -> None:
    curve = 'motor = [["0 rpm", "12 N m"], ["2000 rpm", "12 N m"], ["50 rev/s", "8 N m"]]'
    job = read("flying-saw", ("limits.motor", curve))
    assert isinstance(job.limits.motor, MotorCurve)
    expected = [[0.0, 12.0], [2000 * math.pi / 30, 12.0], [100 * math.pi, 8.0]]
    np.testing.assert_allclose(job.limits.motor.points, expected, rtol=1e-15)
    assert read("flying-saw").limits.motor is None
    assert job_numbers(job)["limits"]["motor"] == {"points": job.limits.motor.points}


@pytest.mark.parametrize(
    ("curve", "message"),
    [
        ("3", "3: not two points or more of speed and torque; write e.g."),
        ('[["0 rpm", "12 N m"]]', "not two points or more"),
        ('[["0 rpm", "12 N m"], 3]', "point 2: 3 is not a pair of speed and torque"),
        ('[["0 rpm", "12 N m"], ["3000 rpm", "8 N"]]', "point 2: '8 N': "),
        ('[["0 rpm", "12 N m"], [3000, "8 N m"]]',
         "point 2: 3000: a number without a unit; write e.g. \"3000 rpm\""),
        ('[["10 rpm", "12 N m"], ["3000 rpm", "8 N m"]]',
         "point 1: the curve begins at standstill; write \"0 rpm\" for '10 rpm'"),
        ('[["0 rpm", "12 N m"], ["3000 rpm", "8 N m"], ["2000 rpm", "7 N m"]]',
         "point 3: '2000 rpm' is not above '3000 rpm', the speed of the point before; give the points by increasing"),
        ('[["0 rpm", "12 N m"], ["3000 rpm", "13 N m"]]',
         "a motor's torque does not grow with its speed, give '12 N m' at most"),
    ],
)  # fmt: skip
def test_a_bad_motors_curve_is_refused(curve: str, message: str) -> None:
    (fault,) = faults("flying-saw", ("limits.motor", f"motor = {curve}"))
    assert fault.startswith("[limits] motor = ")
    assert message in fault


def test_a_motors_curve_needs_to_know_what_is_moved() -> None:
    curve = 'motor = [["0 rpm", "12 N m"], ["3000 rpm", "8 N m"]]'
    (fault,) = faults("paper-600", ("limits.motor", curve))
    assert fault.startswith("[limits] motor: the motor's torque depends on what it moves")


def test_all_faults_of_machine_and_limits_are_told_at_once() -> None:
    found = faults(
        "chasing-shear",
        ("rod", 'rod = "10 kg"'),
        ("gear_ratio", "gear_ratio = -1"),
        ("speed", 'speed = "80 m/min"'),
        ("jerk", 'jerk = "3 rad"'),
    )
    assert [fault.split(" =")[0] for fault in found] == [
        "[machine] rod", "[machine] gear_ratio", "[limits] speed", "[limits] jerk"
    ]  # fmt: skip


@pytest.mark.parametrize("name", TEXTS)
def test_examples_keep_the_schema_and_others_do_not(name: str) -> None:
    data = tomllib.loads(TEXTS[name])
    schema = job_schema()
    jsonschema.validate(data, schema)
    for key, value in (("kind", "saw"), ("wheels", 3)):
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate({**data, "machine": {**data["machine"], key: value}}, schema)


def test_a_machine_may_have_keys_of_other_tables(monkeypatch: pytest.MonkeyPatch) -> None:
    """A number of the machine is never taken for one of the cut, nor the other way round."""

    @dataclass(frozen=True)
    class Named(LinearCarriage):
        kind: ClassVar[str] = "named"
        length: Annotated[float, Quantity("length")] = 3.0
        speed: Annotated[float, Quantity("speed")] = 4.0

    monkeypatch.setitem(MACHINES, "named", Named)
    text = (EXAMPLES / "flying-saw.toml").read_text(encoding="utf-8")
    job = parse_job(text.replace('kind = "linear_carriage"', 'kind = "named"\nlength = "7 m"'), "job.toml")
    plain = parse_job(text, "job.toml")
    assert (job.cut, job.limits) == (plain.cut, plain.limits)
    assert isinstance(job.machine, Named)
    assert (job.machine.length, job.machine.speed) == (7.0, 4.0)


@pytest.mark.parametrize("length", ["201 m", "10 km", "1e6 m"])
def test_a_cut_that_no_cam_is_for_is_refused_at_once(length: str) -> None:
    text = TEXTS["paper-600"].replace('"600 mm"', '"200 m"')
    assert parse_job(text, "job").cut.length == 200.0
    with pytest.raises(
        InputError, match=r"\[cut\] length = .* above 200000 mm, .*sync_zone = 200 mm; cut shorter or .*camwright ramps"
    ):
        parse_job(text.replace('"200 m"', f'"{length}"'), "job")


def test_zones_of_nothing_and_a_crank_of_hundreds_of_turns_are_refused() -> None:
    text = TEXTS["paper-600"].replace('"40 mm"', '"0.01 mm"')
    with pytest.raises(InputError, match=r"\[cut\] length = 600 mm: above 500 mm, .*sync_zone = 0.5 mm"):
        parse_job(text.replace('sync_zone = "200 mm"', 'sync_zone = "0.5 mm"'), "job")
    crank = TEXTS["chasing-shear"].replace('"900 mm"', '"30 m"')
    assert parse_job(crank, "job").cut.length == 30.0  # a hundred strokes of 300 mm
    with pytest.raises(InputError, match="above 30000 mm"):
        parse_job(crank.replace('"30 m"', '"31 m"'), "job")
