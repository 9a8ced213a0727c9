"""What a job file may hold: the ends of the promised ranges are taken, what lies beyond is refused."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from camwright import load_job
from camwright.house.units import quantity
from camwright.profiles.errors import InputError

TEXT = load_job().text

RANGES = [
    ("length", "m", 1e-9, 1e6),
    ("time", "s", 1e-9, 1e6),
    ("speed", "m/s", 1e-9, 1e6),
    ("angular rate", "rad/s", 1e-6, 1e9),
    ("gain", "1/s", 1e-6, 1e9),
    ("acceleration", "m/s^2", 1e-9, 1e9),
    ("jerk", "m/s^3", 1e-9, 1e15),
]


@pytest.mark.parametrize(("kind", "unit", "least", "greatest"), RANGES)
def test_quantities_have_the_promised_range(kind: str, unit: str, least: float, greatest: float) -> None:
    for value in (least, greatest):
        assert quantity(f"{value!r} {unit}", kind) == value
    for value in (0.999 * least, 1.001 * greatest):
        with pytest.raises(InputError, match=r"\d"):
            quantity(f"{value!r} {unit}", kind)


def job_with(tmp_path: Path, key: str, value: str) -> Path:
    """Write the paper's job with another value."""
    text, count = re.subn(rf"^{key} = .*$", f"{key} = {value}", TEXT, flags=re.MULTILINE)
    assert count == 1
    file = tmp_path / "job.toml"
    file.write_text(text, encoding="utf-8")
    return file


@pytest.mark.parametrize(
    ("key", "taken", "refused"),
    [
        ("damping", ("1e-300", "100.0"), ("0.0", "100.001", "-0.7")),
        ("velocity_feedforward", ("0.0", "1.0"), ("-0.001", "1.001")),
        ("points", ("2", "100000"), ("1", "100001")),
    ],
)
def test_bare_numbers_have_the_promised_range(
    key: str, taken: tuple[str, ...], refused: tuple[str, ...], tmp_path: Path
) -> None:
    for value in taken:
        assert not refusals(job_with(tmp_path, key, value), key)
    for value in refused:
        assert refusals(job_with(tmp_path, key, value), key)


def refusals(file: Path, key: str) -> list[str]:
    """List what is said against a key's value itself; a loop that it makes unstable is another matter."""
    try:
        load_job(file)
    except InputError as error:
        return [fault for fault in error.faults if f"] {key} = " in fault]
    return []


def test_a_job_file_has_at_most_a_mebibyte(tmp_path: Path) -> None:
    file = tmp_path / "job.toml"
    for size, taken in ((1_048_576, True), (1_048_577, False)):
        file.write_text(TEXT + "#" * (size - len(TEXT.encode())), encoding="utf-8")
        assert file.stat().st_size == size
        if taken:
            load_job(file)
        else:
            with pytest.raises(InputError):
                load_job(file)


@pytest.mark.parametrize(
    ("text", "kind", "value"),
    [
        ("1 m", "length", 1.0),
        ("1 mm", "length", 1e-3),
        ("1 cm", "length", 1e-2),
        ("1 um", "length", 1e-6),
        ("1 in", "length", 0.0254),
        ("1 ft", "length", 0.3048),
        ("1 s", "time", 1.0),
        ("1 ms", "time", 1e-3),
        ("1 min", "time", 60.0),
        ("1 h", "time", 3600.0),
        ("1 rad", "angle", 1.0),
        ("1 deg", "angle", 3.141592653589793 / 180),
        ("1 rev", "angle", 2 * 3.141592653589793),
        ("1 rpm", "angular rate", 2 * 3.141592653589793 / 60),
        ("80 m/min", "speed", 80 / 60),
        ("600 mm", "length", 0.6),
        ("24 in", "length", 0.6096),
        ("4 ms", "time", 0.004),
        ("120 rad/s", "angular rate", 120.0),
        ("35 1/s", "gain", 35.0),
    ],
)
def test_the_promised_units_are_read(text: str, kind: str, value: float) -> None:
    assert quantity(text, kind) == pytest.approx(value, rel=1e-15)


def test_angle_is_a_dimension_of_its_own() -> None:
    with pytest.raises(InputError):
        quantity("120 1/s", "angular rate")
    with pytest.raises(InputError):
        quantity("35 rad/s", "gain")
