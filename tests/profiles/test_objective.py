"""The table of objectives: one row each, and what every room says of it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import get_args

import pytest

import camwright
from camwright.jobs.structure import JobFile
from camwright.profiles.objective import (
    COMMAND_OBJECTIVES,
    MOTION_OBJECTIVES,
    OBJECTIVES,
    Objective,
    ObjectiveName,
    of_command,
    of_motion,
)
from camwright.validation.motion import MotionMeasures
from camwright.validation.motor import MotorMeasures

HOME = Path(camwright.__file__).parent


def test_every_name_has_one_row() -> None:
    assert tuple(OBJECTIVES) == get_args(ObjectiveName)
    assert [objective.name for objective in OBJECTIVES.values()] == list(OBJECTIVES)


def test_the_units_are_those_of_the_measures() -> None:
    assert {name: objective.unit("rad") for name, objective in OBJECTIVES.items()} == {
        "peak_acceleration": "rad/s^2",
        "rms_acceleration": "rad/s^2",
        "peak_jerk": "rad/s^3",
        "rms_jerk": "rad/s^3",
        "rms_torque": "N m",
        "peak_torque": "N m",
        "energy": "J",
        "sync_error": "m",
    }


@pytest.mark.parametrize("name", COMMAND_OBJECTIVES)
def test_every_objective_of_the_command_is_measured_by_its_name(name: ObjectiveName) -> None:
    measures = MotorMeasures if OBJECTIVES[name].of == "motor" else MotionMeasures
    assert name in measures.__dataclass_fields__


@pytest.mark.parametrize(("name", "objective"), OBJECTIVES.items())
def test_the_name_says_form_and_order(name: str, objective: Objective) -> None:
    assert objective.form == ("drawn" if name == "energy" else name.split("_")[0].replace("sync", "peak"))
    assert objective.order == {"acceleration": 2, "jerk": 3}.get(name.rpartition("_")[2], 0)
    assert objective.over_time(2.0, 3.0) == 2.0 * 3.0**objective.order


def test_stand_ins_are_what_they_stand_for_where_they_can() -> None:
    assert [of_motion(name) for name in MOTION_OBJECTIVES] == list(MOTION_OBJECTIVES)
    assert [of_command(name) for name in COMMAND_OBJECTIVES] == list(COMMAND_OBJECTIVES)
    assert of_command("sync_error") == of_motion("sync_error") == "peak_acceleration"
    assert {of_motion(name) for name in COMMAND_OBJECTIVES if OBJECTIVES[name].of == "motor"} == {"rms_acceleration"}


@pytest.mark.parametrize("language", ["en", "de", "zh"])
def test_every_objective_has_a_word_in_every_language_of_the_recipe(language: str) -> None:
    words = json.loads((HOME / "recipes" / "messages" / f"{language}.json").read_text(encoding="utf-8"))
    assert all(f"word.{name}" in words for name in OBJECTIVES)


def test_job_files_know_the_same_names() -> None:
    table = JobFile.model_json_schema()["$defs"]["ObjectiveTable"]
    assert table["properties"]["minimise"]["enum"] == list(OBJECTIVES)
