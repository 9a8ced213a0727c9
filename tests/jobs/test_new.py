"""A first job: the list of keys, the commented file, the examples, and what is refused."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camwright.cli import new
from camwright.cli.main import main
from camwright.jobs.examples import examples
from camwright.jobs.job import load_job, parse_job
from camwright.jobs.keys import find_keys, job_keys
from camwright.jobs.structure import job_schema
from camwright.jobs.template import job_template, values_of
from camwright.profiles.machines import MACHINES


@pytest.fixture(autouse=True)
def _here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def said(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    code = main(arguments)
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def test_every_key_of_the_schema_is_listed_with_its_meaning() -> None:
    schema = job_schema()
    tables = {name: set(each["properties"]) for name, each in schema["$defs"].items()}
    listed = [key.name for key in job_keys() if key.table]
    # a table within a table is no key of its own
    assert sorted(listed) == sorted(key for keys in tables.values() for key in keys if key != "tolerance")
    for key in job_keys():
        assert key.meaning, key.path
        assert key.used_in, key.path
        assert key.takes, key.path
        assert key.required or key.default or key.example, key.path


def test_a_key_is_found_by_its_name_its_table_and_its_place() -> None:
    assert [key.path for key in find_keys("position_gain")] == ["servo.position_gain", "servo.tolerance.position_gain"]
    assert {key.table for key in find_keys("[servo]")} == {"servo"}
    (length,) = find_keys("[cut] length")
    assert (length.required, length.example, length.default) == (True, '"600 mm"', "")
    (damping,) = find_keys("servo.damping")
    assert damping.takes == "number above 0 to 100"
    assert find_keys("colour") == ()


@pytest.mark.parametrize("name", list(examples()))
def test_a_new_job_asks_for_what_its_example_asks(name: str) -> None:
    """Every number of the example stands in the new file; every key of its machine is there, once."""
    one = examples()[name]
    text = job_template(values_of(one.text), "A job.")
    again, before = parse_job(text, "new"), parse_job(one.text, "example")
    # as they are written: of a free crank the place of the sync zone is not a number, which from Python 3.13 on equals nothing
    told = [repr((job.machine, job.cut, job.limits, job.servo)) for job in (again, before)]
    assert told[0] == told[1]
    assert again.objective == before.objective
    for key in job_keys():
        if key.machine in ("", one.machine):
            table = text.replace("# [", "[").partition(f"[{key.table}]")[2].partition("\n[")[0] if key.table else text
            lines = [line for line in table.splitlines() if line.removeprefix("# ").startswith(f"{key.name} = ")]
            assert len(lines) == 1, key.path


@pytest.mark.parametrize("kind", list(MACHINES))
def test_without_a_terminal_nothing_is_asked_and_the_job_passes_check(
    kind: str, capsys: pytest.CaptureFixture[str]
) -> None:
    code, out, _ = said(capsys, "new", kind.replace("_", "-"), "--name", "mine", "--json")
    assert code == 0
    answer = json.loads(out)
    assert (answer["file"], answer["name"], answer["machine"]) == ("mine.toml", "mine", kind)
    assert set(answer) == {"file", "name", "machine", "like", "lent"}
    assert load_job("mine.toml").machine.kind == kind
    assert said(capsys, "check", "mine.toml")[0] == 0


def test_options_and_settings_stand_in_the_file(capsys: pytest.CaptureFixture[str]) -> None:
    options = ["--circumference", "24 in", "--length", "30 in", "--sync-zone", "8 in", "--shear-zone", "1 in"]
    more = ["--damping", "0.8", "--set", "cut.sync_tolerance=0.2 mm", "--set", "limits.reversal=true"]
    assert said(capsys, "new", *options, *more, "--out", "sub/job.toml")[0] == 0
    job = load_job("sub/job.toml")
    assert (job.machine.pitch, job.cut.length) == (pytest.approx(0.6096), pytest.approx(0.762))
    assert (job.servo.damping, job.cut.sync_tolerance, job.limits.reversal) == (0.8, pytest.approx(2e-4), True)
    assert 'circumference = "24 in"' in Path("sub/job.toml").read_text()


def test_in_a_terminal_what_is_required_is_asked_with_the_example_offered(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    asked: list[str] = []

    def prompt(question: str, default: str, **_: Any) -> str:
        asked.append(question)
        return "700 mm" if question.startswith("cut.length") else default

    monkeypatch.setattr(new.sys.stdin, "isatty", lambda: True)
    monkeypatch.setattr(new.typer, "prompt", prompt)
    assert said(capsys, "new", "--line-speed", "60 m/min", "--name", "asked")[0] == 0
    places = [question.partition(":")[0] for question in asked]
    assert places[:3] == ["machine.circumference", "cut.length", "cut.sync_zone"]
    assert "cut.line_speed" not in places
    job = load_job("asked.toml")
    assert (job.cut.length, job.cut.line_speed) == (pytest.approx(0.7), pytest.approx(1.0))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["new", "guillotine"], "there is no machine 'guillotine'; the machines are rotary_knife, linear_carriage,"),
        (["new", "--like", "banana"], "there is no example 'banana'; the examples are "),
        (["new", "crank_slider", "--like", "paper-600"], "of a rotary_knife, not of a crank_slider"),
        (["new", "--stroke", "1 m"], "a rotary_knife job has no key 'machine.stroke'; camwright keys lists them"),
        (["new", "--length", "150"], '[cut] length = 150: a number without a unit; write e.g. "150 mm"'),
        (["new", "--circumference", "150 mm"], "[cut] sync_zone = 200 mm: not below [machine] circumference"),
        (["new", "--set", "cut.length"], "not KEY=VALUE"),
        (["keys", "colour"], "a job file has no key or table 'colour'"),
        (["examples", "banana"], "there is no example 'banana'"),
    ],
)
def test_what_cannot_be_is_refused_and_nothing_written(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    code, _, err = said(capsys, *arguments)
    assert code == 2
    assert message in err
    assert list(Path().iterdir()) == []


def test_nothing_is_written_over(capsys: pytest.CaptureFixture[str]) -> None:
    Path("mine.toml").write_text("mine")
    code, _, err = said(capsys, "new", "--name", "mine")
    assert (code, Path("mine.toml").read_text()) == (2, "mine")
    assert "mine.toml: there already; name another with --out" in err
    assert said(capsys, "examples", "paper-600")[0] == 0
    assert said(capsys, "examples", "paper-600")[0] == 2
    assert load_job("paper-600.toml").name == "paper-600"


@pytest.mark.parametrize("of", ["job", "design", "recipe"])
def test_the_schemas_are_printed(of: str, capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = said(capsys, "schema", of)
    assert code == 0
    assert json.loads(out)["$schema"] == "https://json-schema.org/draft/2020-12/schema"


def test_lists_for_people_and_for_programs(capsys: pytest.CaptureFixture[str]) -> None:
    assert "flying-saw" in said(capsys, "examples")[1]
    assert "circumference of the blade circle" in said(capsys, "keys", "circumference")[1].replace("\n", " ")
    names = {each["name"] for each in json.loads(said(capsys, "examples", "--json")[1])["examples"]}
    assert {"paper-600", "flying-saw", "chasing-shear"} <= names
    paths = {each["path"] for each in json.loads(said(capsys, "keys", "--json")[1])["keys"]}
    assert {"cut.length", "servo.tolerance.damping", "machine.stroke"} <= paths


def test_a_diameter_takes_the_place_of_the_examples_circumference(capsys: pytest.CaptureFixture[str]) -> None:
    code, _, _ = said(capsys, "new", "--diameter", "150 mm", "--name", "by-diameter")
    assert code == 0
    made = load_job(Path("by-diameter.toml"))
    assert made.machine.slave_turn == pytest.approx(np.pi * 0.15, rel=1e-15)


@pytest.mark.parametrize(
    ("words", "kind", "like"),
    [
        (["flying saw"], "linear_carriage", "flying-saw"),
        (["Chasing-Shear"], "crank_slider", "chasing-shear"),
        (["thick_product"], "rotary_knife", "thick-product"),
        (["linear carriage"], "linear_carriage", "flying-saw"),
        (["rotary-knife"], "rotary_knife", "paper-600"),
        (["crank_slider"], "crank_slider", "chasing-shear"),
        (["flying-saw", "--like", "flying-punch"], "linear_carriage", "flying-punch"),
    ],
)
def test_a_machine_is_known_by_its_kind_and_by_the_names_of_examples(
    words: list[str], kind: str, like: str, capsys: pytest.CaptureFixture[str]
) -> None:
    code, out, _ = said(capsys, "new", *words, "--json")
    answer = json.loads(out)
    assert (code, answer["machine"], answer["like"]) == (0, kind, like)


def test_what_the_example_lent_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    own = ["--length", "2.4 m", "--stroke", "900 mm", "--set", "machine.mass=75 kg"]
    code, out, _ = said(capsys, "new", "flying-saw", *own, "--json", "--name", "tube")
    lent = json.loads(out)["lent"]
    example_values = values_of(examples()["flying-saw"].text)
    assert code == 0
    assert lent["servo.bandwidth"] == example_values["servo.bandwidth"]
    assert not {"cut.length", "machine.stroke", "machine.mass", "machine.kind", "name"} & set(lent)
    assert all(place.startswith(("machine.", "cut.", "limits.", "servo.")) for place in lent)
    code, out, _ = said(capsys, "new", "flying-saw", *own, "--name", "pipe")
    words = " ".join(out.split())
    assert f'servo.bandwidth = "{lent["servo.bandwidth"]}"' in words
    assert "which are not your machine's until you say so" in words


def test_each_option_says_what_its_key_means(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "160")
    assert main(["new", "--help"]) == 0
    words = " ".join(capsys.readouterr().out.replace("│", " ").split())
    assert 'Circumference of the blade circle, e.g. "400 mm".' in words
    assert 'Length of material over which the tool moves with it, e.g. "200 mm".' in words
