"""A job in inches is answered in inches on the screen and in refusals; JSON keeps its units, which its keys name."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest
from inch_job import JOB

from camwright import load_job, optimise
from camwright.cli.main import main
from camwright.house.numbers import INCH
from camwright.jobs.job import parse_job
from camwright.profiles.errors import InfeasibleError, InputError

METRIC = re.compile(r"(?<![\w.])[0-9.]+ (mm|m/min|m/s)\b|\b(mm|m/min|m/s[²³]?)(?= *[│┃])")


@pytest.fixture
def job(tmp_path: Path) -> Path:
    file = tmp_path / "boards.toml"
    file.write_text(JOB, encoding="utf-8")
    return file


@pytest.mark.parametrize("command", ["check", "design", "limits", "compare", "envelope"])
def test_the_screen_is_in_inches(
    command: str, job: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    more = {"envelope": ["--points", "2"]}.get(command, [])
    out = [] if command in ("check", "limits") else ["--out", str(tmp_path / "out"), "--no-figures"]
    assert main([command, str(job), *more, *out]) == 0
    said = capsys.readouterr().out
    assert "ft/min" in said
    assert re.search(r"\bin\b", said)
    assert not METRIC.search(said), METRIC.search(said)


def test_a_refusal_offers_inches_that_work(job: Path, capsys: pytest.CaptureFixture[str]) -> None:
    short = JOB.replace('"100 ft/s^2"', '"20 ft/s^2"')
    asked = parse_job(short, "boards.toml")
    assert asked.units is INCH
    with pytest.raises(InfeasibleError) as refused:
        optimise(asked)
    said = str(refused.value)
    assert not re.search(r"[0-9] (mm|m/min|m/s)\b", said), said
    offers = dict(re.findall(r'\[(?:cut|limits)\] (\w+) = "([0-9.]+ [^"]+)"', said))
    assert set(offers) >= {"line_speed", "length", "acceleration"}
    for key, offer in offers.items():
        optimise(parse_job(re.sub(rf"(?m)^{key} = .*$", f'{key} = "{offer}"', short, count=1), ""))
    job.write_text(short, encoding="utf-8")
    assert main(["design", str(job), "--json", "--no-figures"]) == 3
    answer = json.loads(capsys.readouterr().out)
    assert {each["unit"] for each in answer["suggestions"]} <= {"in", "ft/min", "ft/s^2", "ft/s^3"}


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ('sync_zone = "6 in"|sync_zone = "25 in"', r"\[cut\] sync_zone = 25 in: not below \[cut\] length = 24 in"),
        ('shear_zone = "1.5 in"|shear_zone = "7 in"', r"\[cut\] shear_zone = 7 in: above \[cut\] sync_zone = 6 in"),
        (
            'speed = "650 fpm"|speed = "200 fpm"',
            r"speed = 200 ft/min: below \[cut\] line_speed = 260 ft/min.*line at 200 ft/min",
        ),
        ('sync_zone = "6 in"|sync_zone = "16 in"', r"\[cut\] sync_zone = 16 in: .* 15.75 in"),
    ],
)
def test_faults_are_told_in_inches(change: str, told: str) -> None:
    before, after = change.split("|")
    assert before in JOB
    with pytest.raises(InputError, match=told):
        parse_job(JOB.replace(before, after, 1), "boards.toml")


def test_units_are_no_part_of_the_numbers() -> None:
    job = load_job()
    assert replace(job, units=INCH) == job


def test_a_book_of_an_inch_job_is_in_inches(job: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    cut = parse_job(JOB, "boards.toml").cut
    inches, feet = round(cut.length / 0.0254), round(cut.line_speed * 60 / 0.3048)
    book = tmp_path / "book"
    call = ["book", str(job), "--length", f"{inches}:{inches + 1}:1", "--line-speed", str(feet), "--jobs", "1"]
    assert main([*call, "--out", str(book), "--quiet"]) == 0
    lines = [line for line in (book / "index.csv").read_text().splitlines() if not line.startswith("#")]
    first = dict(zip(lines[0].split(","), lines[1].split(","), strict=True))
    assert not [name for name in first if re.search(r"_mm|_m_per", name)]
    assert (float(first["length_in"]), float(first["line_speed_ft_per_min"])) == (inches, feet)
    assert first["unit"] == "ft/s^2"
    assert float(first["value"]) == pytest.approx(float(first["peak_acceleration_ft_per_s2"]))
    assert first["folder"] == f"designs/{inches}in/{feet}ft-per-min/peak_acceleration"
    own = json.loads((book / first["folder"] / "design.json").read_text())
    assert f'length = "{inches} in"' in own["job"]["toml"]
    page = re.sub("<[^>]+>", "|", (book / "index.html").read_text())
    assert "length in" in page
    assert "highest line speed of the book ft/min" in page
    assert not re.search(r"\b(mm|m/min|m/s[²³]?)\b", page.partition("recipe book|")[2].replace("12mm", ""))
    limits = (book / "limits.csv").read_text()
    assert "physical_line_speed_ft_per_min" in limits


def test_an_audit_of_an_inch_job_is_in_inches(job: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    design = tmp_path / "out"
    assert main(["design", str(job), "--no-figures", "--quiet", "--out", str(design)]) == 0
    assert main(["export", str(design / "design.json"), "--to", "csv", "--quiet", "--out", str(tmp_path / "t")]) == 0
    (table,) = (tmp_path / "t").glob("*.csv")
    capsys.readouterr()
    assert main(["audit", str(table), "--job", str(job), "--no-figures", "--out", str(tmp_path / "a")]) == 0
    said = capsys.readouterr().out
    assert "peak speed (ft/min)" in said
    assert "following error of the servo (in)" in said
    assert "-0.0 %" not in said
    assert not re.search(r"\((mm|m/s[²³]?)\)", said)


@pytest.mark.parametrize("command", ["ramps", "marks", "cutlist", "simulate"])
def test_production_is_told_in_inches(
    command: str, job: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    order = tmp_path / "order.csv"
    order.write_text("length [in],quantity\n24,2\n18,1\n", encoding="utf-8")
    ramp = ["--line-acceleration", "3 ft/s^2"]
    more = {"cutlist": [str(order), *ramp], "simulate": ["--list", str(order), *ramp]}.get(command, [])
    assert main([command, str(job), *more, "--out", str(tmp_path / "out"), "--no-figures"]) == 0
    said = capsys.readouterr().out
    assert not METRIC.search(said), METRIC.search(said)
    assert "m/s" not in said
    if command == "cutlist":
        assert "ramps with 3 ft/s²" in said
