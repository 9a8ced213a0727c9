"""Job files: what they say, their schema, and every fault with its place."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path

import jsonschema
import pytest

from camwright.jobs.job import BUNDLED_JOB, load_job, parse_job
from camwright.jobs.structure import job_schema
from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import RotaryKnife
from camwright.profiles.servo import Servo

ROOT = Path(__file__).parents[2]
PAPER = BUNDLED_JOB.read_text(encoding="utf-8")


def changed(*changes: tuple[str, str], extra: str = "") -> str:
    """Change the lines of some keys of the paper's job; an empty line drops the key."""
    text = PAPER
    for key, line in changes:
        text, count = re.subn(rf"(?m)^{re.escape(key)}\b.*$", line.replace("\\", r"\\"), text)
        assert count == 1, key
    return text + extra


def faults(text: str) -> tuple[str, ...]:
    with pytest.raises(InputError) as caught:
        parse_job(text, "job.toml")
    assert all(fault.startswith("job.toml: ") for fault in caught.value.faults)
    return tuple(fault.removeprefix("job.toml: ") for fault in caught.value.faults)


def test_the_papers_job_in_si_numbers() -> None:
    job = load_job()
    assert job.name == "paper-600"
    assert job.machine == RotaryKnife(0.4)
    assert job.cut == Cut(0.6, 80 / 60, 0.2, 0.04, 0.2 - 0.04, 1e-4, "return")
    assert job.limits == Limits(200 / 60, 30.0, 3000.0, False)
    assert job.servo == Servo(120.0, 0.7, 35.0, 0.004, 1.0)
    assert job.objective == "peak_acceleration"
    assert job.output.points == 361
    assert parse_job(job.text, "") == job


def test_the_example_is_the_bundled_job() -> None:
    assert (ROOT / "examples" / "paper-600.toml").read_bytes() == BUNDLED_JOB.read_bytes()


def test_what_is_left_out_has_the_stated_default() -> None:
    text = changed(
        ("shear_zone", ""), ("sync_tolerance", ""), ("reversal", ""), ("minimise", ""), ("origin", ""), ("points", "")
    )
    for section in ("[objective]", "[output]"):
        text = text.replace(section, "")
    job = parse_job(text, "")
    assert (job.cut.shear_zone, job.cut.shear_zone_at, job.cut.sync_tolerance) == (0.0, 0.2, 1e-4)
    assert (job.limits.reversal, job.objective, job.cut.origin, job.output.points) == (
        False, "peak_acceleration", "return", 361
    )  # fmt: skip


def test_the_shear_zone_lies_where_it_is_put() -> None:
    job = parse_job(changed(("shear_zone", 'shear_zone = "40 mm"\nshear_zone_at = "0 mm"')), "")
    assert job.cut.shear_zone_at == 0.0
    last = parse_job(changed(("shear_zone", 'shear_zone = "40 mm"\nshear_zone_at = "160 mm"')), "")
    assert last.cut == load_job().cut


def test_a_byte_order_mark_and_windows_line_ends_are_read(tmp_path: Path) -> None:
    file = tmp_path / "job.toml"
    file.write_bytes(b"\xef\xbb\xbf" + PAPER.replace("\n", "\r\n").encode())
    assert load_job(file).cut == load_job().cut


@pytest.mark.parametrize(
    ("key", "line", "message"),
    [
        ("name", "", 'name: missing; add e.g. name = "paper-600"'),
        ("name", "name = 3", "name = 3: not a text"),
        ("name", 'name = " "', "name = ' ': a name has 1 to 60 characters"),
        ("name", 'name = "../x"', "name = '../x': a name is on one line and has none of"),
        ("name", 'name = "a\\nb"', r"name = 'a\nb': a name is on one line and has none of"),
        ("name", 'name = "..x"', "name = '..x': a name neither begins nor ends with a dot"),
        ("kind", 'kind = "saw"', "[machine] kind = 'saw': not known; write \"rotary_knife\""),
        ("kind", "", '[machine] kind: missing; add e.g. kind = "rotary_knife"'),
        ("circumference", "circumference = 4", "[machine] circumference = 4: a number without a unit"),
        ("length", "", '[cut] length: missing; add e.g. length = "600 mm"'),
        ("length", 'length = "0 mm"', "[cut] length = '0 mm': zero; a length greater than zero is expected"),
        ("length", 'length = "-600 mm"', "[cut] length = '-600 mm': negative"),
        ("length", "length = nan", "[cut] length = nan: a number without a unit"),
        ("line_speed", 'line_speed = "80 m"', "[cut] line_speed = '80 m': a length, but a speed is expected"),
        ("sync_zone", 'sync_zon = "200 mm"', "[cut] sync_zon: there is no such key; did you mean sync_zone?"),
        ("points", '"x\\ny" = 1', r"[output] x\ny: there is no such key; the keys here are origin, points"),
        ("speed", "speed = 200", '[limits] speed = 200: a number without a unit; write e.g. "200 m/min"'),
        ("acceleration", 'acceleration = "inf m/s^2"', "[limits] acceleration = 'inf m/s^2': not an acceleration"),
        ("reversal", 'reversal = "no"', "[limits] reversal = 'no': neither true nor false"),
        ("damping", "", "[servo] damping: missing; add e.g. damping = 0.7"),
        ("damping", "damping = 0", "[servo] damping = 0: the damping ratio must be above 0"),
        ("damping", "damping = -0.7", "[servo] damping = -0.7: the damping ratio must be above 0"),
        ("damping", "damping = nan", "[servo] damping = nan: the damping ratio must be above 0"),
        ("damping", 'damping = "0.7"', "[servo] damping = '0.7': not a number"),
        ("damping", "damping = true", "[servo] damping = True: not a number"),
        ("velocity_feedforward", "velocity_feedforward = 1.5", "more makes the axis run ahead of its command"),
        ("velocity_feedforward", "velocity_feedforward = -0.1", "[servo] velocity_feedforward = -0.1: it is the share"),
        ("minimise", 'minimise = "time"', '[objective] minimise = \'time\': not known; write "peak_acceleration"'),
        ("origin", 'origin = "middle"', '[output] origin = \'middle\': not known; write "return" or "cut"'),
        ("points", "points = 1", "[output] points = 1: not a whole number from 2 to 100000"),
        ("points", "points = 361.0", "[output] points = 361.0: not a whole number"),
        ("points", "points = 1000000000000000000000", "[output] points = 1000000000000000000000: not a whole number"),
        ("[servo]", "[srevo]", "srevo: there is no such key; did you mean servo?"),
    ],
)  # fmt: skip
def test_a_fault_is_told_with_its_place_and_the_way_out(key: str, line: str, message: str) -> None:
    found = faults(changed((key, line)) if not key.startswith("[") else PAPER.replace(key, line))
    assert any(message in fault for fault in found), found


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ([("sync_zone", 'sync_zone = "600 mm"'), ("circumference", 'circumference = "1 m"')],
         "[cut] sync_zone = 600 mm: not below [cut] length = 600 mm, so no return zone is left; shorten"),
        ([("sync_zone", 'sync_zone = "400 mm"')],
         "[cut] sync_zone = 400 mm: not below [machine] circumference = 400 mm"),
        ([("shear_zone", 'shear_zone = "201 mm"')],
         "[cut] shear_zone = 201 mm: above [cut] sync_zone = 200 mm"),
        ([("shear_zone", 'shear_zone = "40 mm"\nshear_zone_at = "161 mm"')],
         "[cut] shear_zone_at = 161 mm: the shear zone of 40 mm would end 201 mm after the start of the sync zone of "),
        ([("speed", 'speed = "79 m/min"')],
         "[limits] speed = 79 m/min: below [cut] line_speed = 80 m/min"),
        ([("sample_time", 'sample_time = "451 ms"')],
         "[servo] sample_time = 451 ms: longer than the cycle of 450 ms"),
        ([("position_gain", 'position_gain = "200 1/s"')],
         "[servo] position_gain = 200 1/s: the sampled position loop is unstable: its spectral radius is 1."),
    ],
)  # fmt: skip
def test_numbers_that_do_not_go_together_are_refused(changes: list[tuple[str, str]], message: str) -> None:
    found = faults(changed(*changes))
    assert len(found) == 1
    assert message in found[0]


def test_all_faults_are_told_at_once_those_between_numbers_too() -> None:
    found = faults(
        changed(
            ("name", ""),
            ("circumference", "circumference = 400"),
            ("sync_zone", 'sync_zone = "700 mm"'),
            ("speed", 'speed = "10 m/min"'),
            ("damping", "damping = 0"),
            extra="\n[srevo]\n",
        )
    )
    assert [fault.split(":")[0].split(" =")[0] for fault in found] == [
        "name", "[machine] circumference", "[servo] damping", "srevo", "[cut] sync_zone", "[limits] speed"
    ]  # fmt: skip


def test_a_missing_shear_zone_is_zero_in_the_checks_too() -> None:
    found = faults(changed(("shear_zone", 'shear_zone_at = "201 mm"')))
    assert len(found) == 1
    assert found[0].startswith("[cut] shear_zone_at = 201 mm: the shear zone of 0 mm would end 201 mm after the start")
    assert found[0].endswith("begin it at 200 mm at the latest")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("name = ", r"not TOML: Invalid value \(at the end, line 1\)"),
        ("\n\nname == 3\n", "not TOML: .*line 3"),
        ("a = 1\na = 2", r"not TOML: Cannot overwrite a value \(at the end, line 2\)"),
        ("x = " + "[" * 100_000, "nested too deeply"),
        ("x = " + "9" * 5000, "not TOML: .*4300 digits"),
        ("machine = 3", r"\[machine\] = 3: not a table; write \[machine\] on a line of its own"),
        ("[[machine]]\nkind = 1", r"\[machine\] = .*: not a table"),
        ("cut = 3", r"\[cut\] = 3: not a table"),
        ("", r"\[servo\]: missing; add the table \[servo\]"),
    ],
)
def test_what_is_no_job_file_is_refused(text: str, message: str) -> None:
    assert re.search(message, "\n".join(faults(text))), faults(text)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "the job file is empty"),
        (b" \n\t\n", "the job file is empty"),
        (b"name = '\xff'", r"not UTF-8 text \(byte 8\)"),
        (PAPER.encode() + b"#" * (1 << 20), "larger than 1048576 bytes"),
    ],
)
def test_a_file_that_cannot_be_a_job_file_is_refused(tmp_path: Path, data: bytes, message: str) -> None:
    file = tmp_path / "job.toml"
    file.write_bytes(data)
    with pytest.raises(InputError, match=message):
        load_job(file)


def test_a_path_that_is_no_readable_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="there is no such job file"):
        load_job(tmp_path / "none.toml")
    with pytest.raises(InputError, match="a directory, not a job file"):
        load_job(tmp_path)
    with pytest.raises(InputError, match="cannot be read: Not a directory"):
        load_job(BUNDLED_JOB / "x")
    with pytest.raises(InputError, match="cannot be read: embedded null"):
        load_job("a\0b")
    with pytest.raises(InputError, match="cannot be read: File name too long"):
        load_job("x" * 5000)


def test_the_shipped_schema_is_that_of_the_models() -> None:
    shipped = json.loads((BUNDLED_JOB.parent.parent / "schemas" / "job.schema.json").read_text(encoding="utf-8"))
    assert shipped == job_schema()
    jsonschema.Draft202012Validator.check_schema(shipped)


@pytest.mark.parametrize("file", sorted((ROOT / "examples").glob("*.toml")), ids=lambda file: file.name)
def test_examples_keep_the_schema(file: Path) -> None:
    jsonschema.validate(tomllib.loads(file.read_text(encoding="utf-8")), job_schema())


@pytest.mark.parametrize(
    ("key", "line"),
    [
        ("length", "length = 600"),
        ("length", 'length = "-600 mm"'),
        ("length", 'length = "600"'),
        ("damping", "damping = 0"),
        ("velocity_feedforward", "velocity_feedforward = 1.5"),
        ("points", "points = 1"),
        ("origin", 'origin = "middle"'),
        ("sync_tolerance", 'sync_tol = "1 mm"'),
        ("name", 'name = "a/b"'),
        ("jerk", ""),
    ],
)
def test_the_schema_refuses_what_the_reader_refuses(key: str, line: str) -> None:
    text = changed((key, line))
    assert faults(text)
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(tomllib.loads(text), job_schema())
