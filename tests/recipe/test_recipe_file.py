"""recipe.json: the one model, its schema, and the physics that it states."""

from __future__ import annotations

import json
from dataclasses import asdict, replace
from itertools import pairwise
from pathlib import Path
from typing import ClassVar

import jsonschema
import numpy as np
import pytest

from camwright.design.feasible.extremes import extremes
from camwright.design.feasible.feasibility import is_feasible
from camwright.jobs.job import BUNDLED_JOB, load_job
from camwright.profiles.closed_forms.reach import greatest_reach
from camwright.profiles.errors import InputError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import RotaryKnife
from camwright.profiles.returns import baseline
from camwright.profiles.servo_tolerance import ServoTolerance
from camwright.profiles.task import Task
from camwright.recipes import build, expected
from camwright.recipes.build import MadeRecipe, designed, make_recipe
from camwright.recipes.catalogue import Catalogue, catalogue
from camwright.recipes.expected import at_speeds
from camwright.recipes.model import Recipe
from camwright.recipes.recipe_file import (
    parse_recipe,
    recipe_schema,
    recipe_text,
    stored_design,
)
from camwright.recipes.sheet import sheet
from camwright.recipes.working_range import can_rest, longest_cut, stopping_distance
from camwright.studies.reach import reach
from camwright.validation.report import judge

EXAMPLES = Path(__file__).parents[2] / "examples"


def test_a_recipe_is_read_back_as_it_was_written(made: MadeRecipe, saw: MadeRecipe) -> None:
    for recipe in (made.recipe, saw.recipe):
        text = recipe_text(recipe)
        again = parse_recipe(text, "here")
        assert again == recipe
        assert recipe_text(again) == text


def test_the_shipped_schema_is_that_of_the_model_and_holds_for_recipes(made: MadeRecipe, saw: MadeRecipe) -> None:
    shipped = json.loads((BUNDLED_JOB.parents[1] / "schemas" / "recipe.schema.json").read_text(encoding="utf-8"))
    assert shipped == recipe_schema(), "write it anew: json.dumps(recipe_schema(), indent=1) and a line end"
    jsonschema.Draft202012Validator.check_schema(shipped)
    for recipe in (made.recipe, saw.recipe):
        jsonschema.validate(json.loads(recipe_text(recipe)), shipped)
    data = json.loads(recipe_text(made.recipe))
    data["job"]["si"]["cut"]["extra"] = 1
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(data, shipped)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda data: data.update(extra=1), "here: extra: "),
        (lambda data: data.pop("zones"), "here: zones: "),
        (lambda data: data.update(released="yes"), "here: released: "),
        (lambda data: data.update(schema_version=2), "here: schema_version: "),
        (lambda data: data["speeds"][1].update(motor_speed="fast"), "here: speeds.1.motor_speed: "),
        (lambda data: data["tables"][0]["files"][0].pop("sha256"), "here: tables.0.files.0.sha256: "),
    ],
)
def test_a_fault_in_the_structure_is_named_with_its_place(made: MadeRecipe, change, said: str) -> None:
    data = json.loads(recipe_text(made.recipe))
    change(data)
    with pytest.raises(InputError) as caught:
        parse_recipe(json.dumps(data), "here")
    assert any(fault.startswith(said) for fault in caught.value.faults)


@pytest.mark.parametrize("text", ["", "[]", "{", "{}", "NaN", '{"schema_version": NaN}', "[" * 100_000])
def test_what_is_no_recipe_is_refused(text: str) -> None:
    with pytest.raises(InputError):
        parse_recipe(text, "here")


def test_the_design_comes_back_bit_by_bit(made: MadeRecipe, paper_design) -> None:
    again = stored_design(made.recipe)
    assert again.profile.to_dict() == paper_design.profile.to_dict()
    assert again.job == paper_design.job


def test_slower_lines_follow_the_stated_law(saw: MadeRecipe) -> None:
    rows = saw.recipe.speeds
    assert [row.share for row in rows] == [0.1, 0.25, 0.5, 1.0]
    full = rows[-1]
    for row in rows:
        assert row.line_speed == pytest.approx(row.share * full.line_speed, rel=1e-14)
        for name, power in (("speed", 1), ("motor_speed", 1), ("acceleration", 2), ("jerk", 3)):
            assert getattr(row, name) == pytest.approx(row.share**power * getattr(full, name), rel=1e-12)
        for name in ("peak_torque", "rms_torque"):  # without friction all torque is inertial
            assert getattr(row, name) == pytest.approx(row.share**2 * getattr(full, name), rel=1e-12)
    for slow, fast in pairwise(rows):
        assert slow.following_error < fast.following_error


def test_friction_torque_stays_where_inertial_torque_falls() -> None:
    made = make_recipe(designed(load_job(EXAMPLES / "thick-product.toml")), ["csv"])
    job = load_job(EXAMPLES / "thick-product.toml")
    full = made.recipe.speeds[-1]
    constant = job.machine.friction / job.machine.motor_ratio
    for row in made.recipe.speeds:
        inertial = row.share**2 * (full.peak_torque - constant)
        assert row.peak_torque == pytest.approx(constant + inertial, rel=1e-9)


def test_full_speed_is_what_the_checks_say(made: MadeRecipe) -> None:
    checks, full = {check.name: check.value for check in made.recipe.checks}, made.recipe.speeds[-1]
    for check, value in (
        ("speed", full.speed),
        ("acceleration", full.acceleration),
        ("jerk", full.jerk),
        ("following_error", full.following_error),
        ("shear_zone_error", full.sync_error),
    ):
        assert checks[check] == pytest.approx(value, rel=1e-12)


def test_the_lead_time_cancels_dead_time_and_lag() -> None:
    text = (EXAMPLES / "paper-600.toml").read_text(encoding="utf-8")
    text = text.replace("velocity_feedforward = 1.0", 'velocity_feedforward = 0.9\ndead_time = "3 ms"')
    from camwright.jobs.job import parse_job

    recipe = make_recipe(designed(parse_job(text, "here")), ["csv"]).recipe
    assert recipe.lead_time == pytest.approx(0.003 + 0.1 / 35.0, rel=1e-12)
    for row in recipe.speeds:
        assert row.length_offset == pytest.approx(recipe.lead_time * row.line_speed, abs=2e-5)
        assert abs(row.length_offset_with_lead) < 0.01 * abs(row.length_offset) + 1e-5


def test_the_working_range_is_that_of_the_axis_in_tolerance(made: MadeRecipe, paper_design) -> None:
    job, far = paper_design.job, made.recipe.working_range
    known = reach(job, extremes(job.task))
    assert (far.min_length.value, far.min_length.binding) == (known.min_cut_length, "acceleration")
    assert (far.max_line_speed.value, far.max_line_speed.binding) == (known.max_line_speed, "axis")
    assert (far.min_line_speed.value, far.max_length.value) == (None, None)


@pytest.mark.parametrize(("speed", "acceleration", "jerk"), [(2.0, 4.0, 8.0), (1.0, 30.0, 100.0), (3.0, 2.0, 900.0)])
def test_the_stopping_distance_is_half_of_the_shortest_hop_that_reaches_that_speed(
    speed: float, acceleration: float, jerk: float
) -> None:
    distance = stopping_distance(speed, 0.0, Limits(100.0, acceleration, jerk))
    time = 2.0 * distance / speed  # the mean speed is half the speed
    assert greatest_reach(2.0 * time, 1e9, acceleration, jerk) == pytest.approx(2.0 * distance, rel=1e-9)
    assert stopping_distance(speed, 0.1 * acceleration, Limits(100.0, acceleration, jerk)) > distance


def test_a_knife_without_room_to_stop_has_a_longest_cut(paper_design) -> None:
    job = paper_design.job
    cut, limits = replace(job.cut, length=0.45), replace(job.limits, acceleration=8.0)
    assert can_rest(job.task.with_cut(cut))
    assert not can_rest(Task(job.machine, cut, limits))  # v²/a alone is 0.222 m, and 0.2 m are left of the circle
    found = longest_cut(Task(job.machine, cut, limits))
    assert found.value is not None
    assert found.binding == "acceleration"
    assert is_feasible(Task(job.machine, replace(cut, length=found.value), limits))
    assert not is_feasible(Task(job.machine, replace(cut, length=found.value * 1.0001), limits))


def test_targets_that_cannot_take_the_cam_are_named_or_refused(paper_design, monkeypatch: pytest.MonkeyPatch) -> None:
    def picky(profile, job, names, *, step):
        results, _ = build_export(profile, job, ["csv"], step=step)
        return results, {"trio": ("too long",)}

    build_export = build.export_possible
    monkeypatch.setattr(build, "export_possible", picky)
    with pytest.raises(InputError, match="trio: too long"):
        make_recipe(paper_design, ["csv", "trio"])
    recipe = make_recipe(paper_design, ["csv", "trio"], required=False).recipe
    assert [asdict(each) for each in recipe.refused] == [{"target": "trio", "reasons": ("too long",)}]


@pytest.mark.parametrize(
    ("name", "sync", "shear"),
    [
        ("paper-600", [(0.4, 0.6)], [(0.56, 0.6)]),
        ("cross-cutter", [(0.0, 0.1), (0.8, 0.9)], [(0.89, 0.9), (0.0, 0.01)]),  # the cut is at master zero
        ("no shear zone", [(0.4, 0.6)], [(0.6, 0.6)]),
    ],
)
def test_zones_lie_on_the_master_where_the_job_puts_them(name: str, sync: list, shear: list) -> None:
    known = name if (EXAMPLES / f"{name}.toml").exists() else "paper-600"
    job = load_job(EXAMPLES / f"{known}.toml")
    if known != name:
        job = replace(job, cut=replace(job.cut, shear_zone=0.0, shear_zone_at=job.cut.sync_zone))
    zones = expected.zones(job.cut)
    assert np.array(zones.sync) == pytest.approx(np.array(sync), abs=1e-15)
    assert np.array(zones.shear) == pytest.approx(np.array(shear), abs=1e-12)


class Swinging(RotaryKnife):
    """A knife that comes back, and has no guide."""

    turns_back: ClassVar[bool] = True

    @property
    def pitch(self) -> float:
        """Travel per cycle: none."""
        return 0.0


def test_a_slave_that_comes_back_without_a_guide_can_wait_at_rest(paper_design) -> None:
    task = paper_design.job.task.with_machine(Swinging(0.4))
    assert can_rest(task)
    assert longest_cut(task).value is None


def test_the_worst_servo_of_the_ranges_stands_beside_the_sync_error(made: MadeRecipe) -> None:
    """A sheet of a job with ranges has a row of it; one of a job without has none, nor has its recipe.json the key."""
    assert "worst_sync_error" not in recipe_text(made.recipe)
    servo = load_job().servo
    job = replace(load_job(), servo_tolerance=ServoTolerance((100.0, 140.0), *((end, end) for end in (
        servo.damping, servo.position_gain, servo.sample_time, servo.dead_time
    ))))  # fmt: skip
    cam = baseline("cycloid", job.task)
    rows = at_speeds(cam, job, judge(cam, job.task, servo))
    pairs = [(row.worst_sync_error or 0.0, row.sync_error or 0.0) for row in rows]
    assert all(worst >= own * (1 - 1e-6) for worst, own in pairs)
    assert pairs[-1][0] > 1.1 * pairs[-1][1]
    words = catalogue("en")
    shown = [row[0] for row in _speed_rows(replace(made.recipe, speeds=rows), words)]
    assert words("column.worst_sync_error") in shown
    assert words("column.worst_sync_error") not in [row[0] for row in _speed_rows(made.recipe, words)]


def _speed_rows(recipe: Recipe, words: Catalogue) -> list[list[str]]:
    """Rows of what to expect at lower line speeds."""
    return next(each for each in sheet(recipe, words)["sections"] if each["key"] == "section.speeds")["blocks"][0][
        "rows"
    ]
