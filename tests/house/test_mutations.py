"""The script that changes promised numbers knows all of them, and finds each in the code."""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[2]

ELSEWHERE = {
    "extra missing",
    "kollmorgen-kas",
    "logix",
    "schneider-asc",
    "lenze",
    "codesys-cambuilder",
    "twincat-table",
}
"""A number that another one's change covers, and targets without a limit."""


def loaded(name: str, file: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, file)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def script() -> Iterator[ModuleType]:
    yield loaded("mutate_contract", ROOT / "benchmarks" / "mutate_contract.py")
    del sys.modules["mutate_contract"]


def test_every_change_finds_its_text(script: ModuleType) -> None:
    for change in script.CHANGES:
        assert change.before != change.after
        script.place_of(change, ROOT)  # raises if the text is not in exactly one file


def test_every_promised_number_is_changed(script: ModuleType) -> None:
    stated = loaded("stated_numbers", ROOT / "tests" / "contract" / "test_stated.py")
    del sys.modules["stated_numbers"]
    changed = {change.promise for change in script.CHANGES}
    assert {*stated.NUMBERS, *stated.CONTROLLERS} - changed == ELSEWHERE
