"""Export, audit and list of targets, as functions and as commands."""

from __future__ import annotations

import hashlib
import json
import math
from dataclasses import replace
from pathlib import Path

import pytest

from camwright import load_job
from camwright.cli.main import main
from camwright.drives.export import (
    export_answer,
    export_possible,
    export_report,
    targets_answer,
)
from camwright.drives.options import parse_targets
from camwright.house.owned import LIST
from camwright.jobs.table_units import default_units, parse_units
from camwright.profiles.errors import InputError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import CrankSlider, LinearCarriage, RotaryKnife
from camwright.profiles.returns import baseline
from camwright.profiles.tables.cam_table import Unit
from camwright.profiles.tables.knots import Accuracy
from camwright.profiles.tables.targets import TARGETS
from camwright.stored.design_text import design_text
from camwright.studies.design import optimise
from camwright.validation.motion import measure_motion

JOB = load_job()
PROFILE = baseline("double_s", JOB.task)


def test_all_targets_are_released_for_a_sound_cam() -> None:
    results = export_possible(PROFILE, JOB, parse_targets("all"))[0]
    answer = export_answer(results)["targets"]
    assert set(answer) == set(TARGETS)
    for name, entry in answer.items():
        assert set(entry) == {"knots", "position_error_m", "acceleration_error_rel", "passed", "files"}
        assert entry["passed"], name
        assert entry["files"]
        assert entry["position_error_m"] <= 3e-6
    report = export_report(results, JOB)
    json.dumps(report, allow_nan=False)
    assert report["targets"]["logix"]["wraps"] == 3
    assert {check["name"] for check in report["targets"]["logix"]["checks"]} >= {"sync_position", "jerk", "closure"}
    dense = report["targets"]["logix"]["dense"]
    assert dense["knots"] > 900
    assert dense["acceleration_error_rel"] > 4 * report["targets"]["logix"]["acceleration_error_rel"]
    assert "dense" not in report["targets"]["codesys"]
    text = next(iter(results[0].files.values()))
    for fact in (JOB.sha256, "peak acceleration: ", "wraps judged: 3", "check the integrity of the imported data"):
        assert fact in text


WEAK = replace(JOB, limits=Limits(JOB.limits.speed, 1.0, JOB.limits.jerk))


@pytest.mark.parametrize(
    "target", ["codesys", "s7-1500t-points", "logix", "br", "trio", "kollmorgen-kas", "lenze", "csv"]
)
def test_a_table_that_breaks_a_limit_is_not_released_unless_forced(target: str) -> None:
    (result,) = export_possible(PROFILE, WEAK, [target])[0]
    assert not result.passed
    assert result.files == {}
    (result,) = export_possible(PROFILE, WEAK, [target], force=True)[0]
    assert not result.passed
    assert any("NOT RELEASED: check acceleration failed" in text for text in result.files.values())


@pytest.mark.parametrize("target", ["codesys", "logix", "technosoft"])
def test_a_table_that_leaves_the_sync_tolerance_is_not_released(target: str) -> None:
    off = PROFILE.add_line(-2e-4 / 0.6)  # 0.2 mm a cycle
    (result,) = export_possible(off, JOB, [target])[0]
    failed = {check.name for check in result.judgement.checks if not check.passed}
    assert failed >= {"closure", "sync_position"}
    assert result.files == {}
    (result,) = export_possible(off, JOB, [target], force=True)[0]
    assert any("NOT RELEASED: check sync_position failed" in text for text in result.files.values())


def test_points_units_and_accuracy() -> None:
    units = parse_units("deg,rev", JOB.task)
    (result,) = export_possible(PROFILE, JOB, ["twincat"], units=units, points=20)[0]
    assert result.table.points == 20
    assert result.table.x[-1] == pytest.approx(360)
    assert result.table.y[-1] == pytest.approx(1)
    smooth = baseline("poly_3_4_5", JOB.task)
    (fine,) = export_possible(smooth, JOB, ["s7-1500t-points"], accuracy=Accuracy(position=1e-9))[0]
    (coarse,) = export_possible(smooth, JOB, ["s7-1500t-points"], accuracy=Accuracy(position=1e-5))[0]
    assert coarse.table.points < fine.table.points
    assert fine.deviation.position <= 1e-9


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: parse_targets("codesys,omron"), "there is no target 'omron'"),
        (lambda: parse_targets(" ,"), "--to names one or more targets"),
        (lambda: parse_units("mm", JOB.task), "--units takes the master's unit and the slave's"),
        (lambda: parse_units("mm,0/rev", JOB.task), "--units: '0/rev': counts in a turn are a whole number from 1"),
        (lambda: parse_units("0 mm,mm", JOB.task), "--units: '0 mm': zero"),
        (lambda: parse_units("mm,furlong", JOB.task), "there is no unit 'furlong'"),
    ],
)
def test_wrong_options_are_refused(call: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        call()  # type: ignore[operator]


def test_targets() -> None:
    answer = targets_answer()
    assert [entry["name"] for entry in answer] == list(TARGETS)
    assert set(answer[0]) >= {
        "name",
        "interpolation",
        "max_points",
        "number_format",
        "evidence",
        "tested_on_controller",
    }


def test_the_commands(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    def said(*arguments: str) -> str:
        assert main(arguments) == 0
        return capsys.readouterr().out

    assert [entry["name"] for entry in json.loads(said("targets", "--json"))] == list(TARGETS)
    assert "logix" in said("targets")
    file = tmp_path / "design.json"
    file.write_text(design_text(optimise(JOB)))
    answer = json.loads(said("export", str(file), "--to", "codesys,logix", "--units", "mm,deg", "--json"))["targets"]
    assert answer["codesys"]["position_error_m"] <= 1e-9 * JOB.machine.pitch
    assert answer["codesys"]["knots"] <= 24
    assert answer["logix"]["acceleration_error_rel"] <= 0.01
    assert {path.name for path in (tmp_path / "tables").iterdir()} == {
        LIST, "report.json", *answer["codesys"]["files"], *answer["logix"]["files"]
    }  # fmt: skip
    assert "Tables as the drives" in said("export", str(file), "--to", "br")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Make a folder with a design, and the design of the same cycle for a job that it breaks."""
    from camwright.stored.design_text import design_text
    from camwright.studies.design import optimise

    place = tmp_path_factory.mktemp("designs")
    text = design_text(optimise(JOB))
    (place / "design.json").write_text(text)
    stored = json.loads(text)
    stored["job"]["toml"] = JOB.text.replace('acceleration = "30 m/s^2"', 'acceleration = "8 m/s^2"')
    stored["provenance"]["job_sha256"] = hashlib.sha256(stored["job"]["toml"].encode()).hexdigest()
    (place / "broken.json").write_text(json.dumps(stored))
    (place / "job.toml").write_text(JOB.text)
    return place


def test_exit_codes(folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = ["--out", str(tmp_path / "t"), "--json"]
    assert main(["export", str(folder / "design.json"), "--to", "codesys", *out]) == 0
    answer = json.loads(capsys.readouterr().out)["targets"]["codesys"]
    assert all((tmp_path / "t" / file).is_file() for file in answer["files"])
    assert main(["export", str(folder / "broken.json"), "--to", "logix", *out]) == 1
    assert json.loads(capsys.readouterr().out)["targets"]["logix"] == {**answer_of(tmp_path, "logix"), "files": []}
    assert main(["export", str(folder / "broken.json"), "--to", "logix", "--force", *out]) == 1
    forced = json.loads(capsys.readouterr().out)["targets"]["logix"]["files"]
    assert "NOT RELEASED: check acceleration failed" in (tmp_path / "t" / forced[0]).read_text()
    for arguments, message in (
        ([str(folder / "design.json"), "--to", "omron"], "there is no target 'omron'"),
        (
            [str(folder / "job.toml"), "--to", "csv"],
            "not a design.json; if it is a job, design it first: camwright design",
        ),
        ([str(folder / "none.json"), "--to", "csv"], "there is no such design file"),
        (
            [str(folder / "design.json"), "--to", "csv", "--units", "mm"],
            "--units takes the master's unit and the slave's",
        ),
        ([str(folder / "design.json"), "--to", "csv", "--max-error", "1 kg"], "length"),
        ([str(folder / "design.json"), "--to", "pacdrive", "--points", "34"], "takes 2 to 33 points; 34 are asked for"),
    ):
        assert main(["export", *arguments, "--out", str(tmp_path / "none")]) == 2
        assert message in capsys.readouterr().err
        assert not (tmp_path / "none").exists()


def answer_of(place: Path, target: str) -> dict[str, object]:
    """Read what the report beside the tables says of a target, in the words of the answer."""
    entry = json.loads((place / "t" / "report.json").read_text())["targets"][target]
    return {key: entry[key] for key in ("knots", "position_error_m", "acceleration_error_rel", "passed", "files")}


def test_all_leaves_out_who_cannot_take_the_cam(tmp_path: Path) -> None:
    negative = PROFILE.shift(0.0, -0.01)
    results, refused = export_possible(negative, JOB, ["codesys", "kollmorgen-kas"], force=True)
    assert [result.target.name for result in results] == ["codesys"]
    assert "begin at 0, stay above 0" in refused["kollmorgen-kas"][0]
    assert export_report(results, JOB, refused)["refused"]["kollmorgen-kas"]
    assert "the IDE scales" in refused["kollmorgen-kas"][0]


def test_units_of_each_machine() -> None:
    drum = RotaryKnife(0.4, blades=2)  # a degree is one of the drum, whatever its blades
    units = parse_units("deg,deg", JOB.task.with_machine(drum))
    assert (units.master.size, units.slave.size) == pytest.approx((0.6 / 360, 0.4 / 360))
    count = parse_units("mm,0.5 um", JOB.task.with_machine(drum)).slave
    assert count.symbol == "0.5um"
    assert count.size == pytest.approx(5e-7)
    assert parse_units("cycle,mm", JOB.task.with_machine(drum), 4096.0).master.size == pytest.approx(0.6 / 4096)
    with pytest.raises(InputError, match="there is no unit 'cycle' here"):
        parse_units("cycle,mm", JOB.task.with_machine(drum))
    crank = CrankSlider(0.15, 0.6)
    assert parse_units("mm,deg", JOB.task.with_machine(crank)).slave == Unit("deg", math.radians(1), "rad")
    assert default_units(crank).slave.si == "rad"
    with pytest.raises(InputError, match="there is no unit 'mm' here; the units are rad, deg, rev"):
        parse_units("mm,mm", JOB.task.with_machine(crank))
    assert parse_units("mm,rev", JOB.task.with_machine(LinearCarriage(1.2, travel_per_turn=0.04))).slave.size == 0.04


def test_a_cam_that_runs_along_a_limit_has_a_table_near_enough_to_keep_it() -> None:
    cam = baseline("modified_trapezoid", JOB.task)
    peak = measure_motion(cam, JOB.task).peak_acceleration
    assert peak is not None
    near, coarse = replace(JOB, limits=replace(JOB.limits, acceleration=peak)), Accuracy(1e-3, 0.1, 0.1)
    names = ("csv", "s7-1500t-points", "logix")
    free, kept = (export_possible(cam, job, names, accuracy=coarse)[0] for job in (JOB, near))
    assert [each.passed for each in (*free, *kept)] == 6 * [True]
    for few, more in zip(free, kept, strict=True):
        assert few.table.points < more.table.points
        asked = export_possible(cam, near, [few.target.name], accuracy=coarse, points=few.table.points)[0][0]
        assert [check.name for check in asked.judgement.checks if not check.passed] == ["acceleration"]
