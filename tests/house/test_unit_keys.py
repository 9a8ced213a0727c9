"""Keys that name a unit: every key of job, bender and springback files that takes a number with a unit, one after the other."""

from __future__ import annotations

import copy
import json
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from camwright.bender.structure import BenderFile, SpringbackFile
from camwright.house.setting_fields import Settings
from camwright.house.settings import read_settings
from camwright.house.toml_file import toml_data
from camwright.house.units import dimension_of
from camwright.jobs.structure import read_structure

ROOT = Path(__file__).parents[2]
JOBS = sorted((ROOT / "examples").glob("*.toml"))
BENDERS = [ROOT / "camwright" / "bender" / "bender.toml"]
SPRINGBACKS = sorted((ROOT / "camwright" / "bender" / "tables").glob("*.toml"))


def of_job(data: dict[str, Any]) -> list[str]:
    return read_structure(data)[2]


def of_bender(data: dict[str, Any]) -> list[str]:
    return read_settings(BenderFile, data, Settings())[1]


def of_springback(data: dict[str, Any]) -> list[str]:
    return read_settings(SpringbackFile, data, Settings())[1]


READERS = [
    *((file, of_job) for file in JOBS),
    *((file, of_bender) for file in BENDERS),
    *((file, of_springback) for file in SPRINGBACKS),
]


def quantities(data: Any, place: str = "") -> Iterator[tuple[str, list[Any], str, str]]:
    """Every key whose value is a number and a unit: its table as it is written, the way to it, the key, the value."""
    for key, value in data.items():
        if isinstance(value, dict):
            for where, way, *rest in quantities(value, f"{place}.{key}".strip(".")):
                yield where, [key, *way], *rest
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            for at, each in enumerate(value):
                for _, way, *rest in quantities(each):
                    yield f"[[{key}]] {at + 1}", [key, at, *way], *rest
        elif isinstance(value, str) and dimension_of(value) is not None:
            yield f"[{place}]", [], key, value


def suffix(unit: str) -> str:
    """Write a unit as the end of a key: ``m/s^2`` is ``m_per_s2``."""
    return unit.replace("1/", "per_").replace("/", "_per_").replace("^", "").replace(" ", "_")


def renamed(data: dict[str, Any], way: list[Any], key: str, new: str, value: Any) -> dict[str, Any]:
    data = copy.deepcopy(data)
    table: Any = data
    for step in way:
        table = table[step]
    del table[key]
    table[new] = value
    return data


@pytest.mark.parametrize(("file", "reader"), READERS, ids=lambda each: each.stem if isinstance(each, Path) else "")
def test_a_unit_in_any_key_is_told_and_what_to_write(file: Path, reader: Callable[[dict[str, Any]], list[str]]) -> None:
    data = toml_data(file.read_text(encoding="utf-8"), str(file), "file")
    assert reader(data) == []
    found = list(quantities(data))
    assert found
    for where, way, key, text in found:
        number, unit = text.split(" ", 1)
        new = f"{key}_{suffix(unit)}"
        for value in (text, json.loads(number)):
            # one fault: nothing is missing
            (fault,) = reader(renamed(data, way, key, new, value))
            shown = f"{where} {new} = {value!r}: the key names a unit, which belongs to the value; write {key} = "
            assert fault == f'{shown}"{text}"', text


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        # another unit of the same kind, written short; one of another kind; a value of no unit
        ('length = "600 mm"', "length_in = 24", 'write length = "24 in"'),
        ('line_speed = "80 m/min"', "line_speed_m_min = 80", 'write line_speed = "80 m/min"'),
        ('line_speed = "80 m/min"', "line_speed_kg = 80", 'write e.g. line_speed = "80 m/min"'),
        ('line_speed = "80 m/min"', "line_speed_m_per_s = true", 'write e.g. line_speed = "80 m/min"'),
        ('circumference = "400 mm"', "diameter_mm = 127.3", 'write diameter = "127.3 mm"'),
    ],
)  # fmt: skip
def test_what_to_write_is_what_was_meant_or_else_an_example(old: str, new: str, told: str) -> None:
    text = (ROOT / "examples" / "paper-600.toml").read_text(encoding="utf-8")
    assert old in text
    (fault,) = of_job(toml_data(text.replace(old, new), "job", "job file"))
    assert fault.endswith(told)


def test_a_range_is_read_with_both_its_ends() -> None:
    text = (ROOT / "examples" / "paper-600.toml").read_text(encoding="utf-8")
    text = re.sub(r"\[servo.tolerance\][^\[]*", "", text) + "\n[servo.tolerance]\nbandwidth_rad_per_s = [108, 132]\n"
    (fault,) = of_job(toml_data(text, "job", "job file"))
    assert fault.startswith("[servo.tolerance] bandwidth_rad_per_s = [108, 132]: ")
    assert fault.endswith('write bandwidth = ["108 rad/s", "132 rad/s"]')


@pytest.mark.parametrize(
    ("more", "told"),
    [
        ("length_m = 0.6", "[cut] length_m: there is no such key; did you mean length?"),  # beside length
        ("sync_zone_at = 1", "[cut] sync_zone_at: there is no such key; did you mean sync_zone?"),  # no unit
        ("sync_ratio_m = 1", "[cut] sync_ratio_m: there is no such key; did you mean sync_ratio?"),  # of no unit
    ],
)
def test_other_keys_are_told_as_before(more: str, told: str) -> None:
    text = (ROOT / "examples" / "paper-600.toml").read_text(encoding="utf-8").replace("[cut]", f"[cut]\n{more}")
    assert of_job(toml_data(text, "job", "job file")) == [told]
