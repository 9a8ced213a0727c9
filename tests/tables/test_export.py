"""Export, audit and list of targets, as functions and as commands."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner

from camwright import load_job
from camwright.audit import audit, audit_answer
from camwright.commands.tables import register
from camwright.export import export, export_answer, export_report, targets_answer
from camwright.table_options import parse_targets, parse_units
from profiles.errors import InputError
from profiles.limits import Limits
from profiles.returns import baseline
from profiles.tables.knots import Accuracy
from profiles.tables.targets import TARGETS

JOB = load_job()
PROFILE = baseline("double_s", JOB.machine, JOB.cut)


def test_all_targets_are_released_for_a_sound_cam() -> None:
    results = export(PROFILE, JOB, parse_targets("all"))
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
    text = next(iter(results[0].files.values()))
    for fact in (JOB.sha256, "peak acceleration: ", "wraps judged: 3", "check the integrity of the imported data"):
        assert fact in text


def test_a_table_that_breaks_a_limit_is_not_released_unless_forced() -> None:
    weak = replace(JOB, limits=Limits(JOB.limits.speed, 1.0, JOB.limits.jerk))
    (result,) = export(PROFILE, weak, ["codesys"])
    assert not result.passed
    assert result.files == {}
    (result,) = export(PROFILE, weak, ["codesys"], force=True)
    assert not result.passed
    assert "// NOT RELEASED: check acceleration failed" in next(iter(result.files.values()))


def test_points_units_and_accuracy() -> None:
    units = parse_units("deg,rev", JOB.machine, JOB.cut)
    (result,) = export(PROFILE, JOB, ["twincat"], units=units, points=20)
    assert result.table.points == 20
    assert result.table.x[-1] == pytest.approx(360)
    assert result.table.y[-1] == pytest.approx(1)
    smooth = baseline("poly_3_4_5", JOB.machine, JOB.cut)
    (fine,) = export(smooth, JOB, ["s7-1500t-points"], accuracy=Accuracy(position=1e-9))
    (coarse,) = export(smooth, JOB, ["s7-1500t-points"], accuracy=Accuracy(position=1e-5))
    assert coarse.table.points < fine.table.points
    assert fine.deviation.position <= 1e-9


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: parse_targets("codesys,omron"), "there is no target 'omron'"),
        (lambda: parse_targets(" ,"), "--to names one or more targets"),
        (lambda: parse_units("mm", JOB.machine, JOB.cut), "--units takes the master's unit and the slave's"),
        (lambda: parse_units("mm,furlong", JOB.machine, JOB.cut), "there is no unit 'furlong'"),
        (lambda: export(PROFILE, JOB, ["s7-1500t", "codesys"], points=60), "s7-1500t: s7-1500t takes 2 to 51 points"),
    ],
)
def test_wrong_options_are_refused(call: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        call()  # type: ignore[operator]


@pytest.mark.parametrize("target", ["logix", "codesys", "kollmorgen-kas", "trio"])
def test_an_audit_finds_what_was_written(target: str, tmp_path: Path) -> None:
    (written,) = export(PROFILE, JOB, [target])
    name, text = next(iter(written.files.items()))
    (tmp_path / name).write_bytes(text.encode())
    result = audit(tmp_path / name, JOB)
    assert result.target.name == target
    assert result.judgement.passed
    answer = audit_answer(result, tmp_path / name)
    json.dumps(answer, allow_nan=False)
    if target == "trio":
        assert answer["profile"]["peak_acceleration_m_per_s2"] is None  # straight lines: unbounded
        assert answer["saving_by"] == "differences at the sample time"
        own, best = (answer["sampled"][key]["peak_acceleration"] for key in ("profile", "optimum"))
        assert answer["saving"]["peak_acceleration_rel"] == pytest.approx(1 - best / own)
    else:
        own, best = (answer[key]["peak_acceleration_m_per_s2"] for key in ("profile", "optimum"))
        assert own > best
        assert answer["saving"]["peak_acceleration_rel"] == pytest.approx(1 - best / own)


def test_an_audit_without_units_takes_the_cycle_for_the_jobs(tmp_path: Path) -> None:
    x = [0.6 * k / 120 for k in range(121)]
    y = PROFILE(x)
    (tmp_path / "cam.csv").write_text(
        "".join(f"{a * 360 / 0.6!r};{b * 25 - 3!r}\n" for a, b in zip(x, y.tolist(), strict=True))
    )
    result = audit(tmp_path / "cam.csv", JOB)
    assert result.judgement.passed
    (tmp_path / "flat.csv").write_text("0,0\n1,1\n2,0\n")
    with pytest.raises(InputError, match="its unit cannot be told from the pitch"):
        audit(tmp_path / "flat.csv", JOB)


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


def test_the_commands(tmp_path: Path) -> None:
    app = typer.Typer()
    register(app)
    run = CliRunner()
    listed = run.invoke(app, ["targets", "--json"])
    assert [entry["name"] for entry in json.loads(listed.stdout)] == list(TARGETS)
    assert "logix" in run.invoke(app, ["targets"]).stdout
    from camwright.design_file import design_text
    from camwright.results import design

    (tmp_path / "design.json").write_text(design_text(design(JOB)))
    done = run.invoke(
        app, ["export", str(tmp_path / "design.json"), "--to", "codesys,logix", "--units", "mm,deg", "--json"]
    )
    answer = json.loads(done.stdout)["targets"]
    assert answer["codesys"]["position_error_m"] <= 1e-9 * JOB.machine.pitch
    assert answer["codesys"]["knots"] <= 24
    assert answer["logix"]["acceleration_error_rel"] <= 0.01
    assert {path.name for path in (tmp_path / "tables").iterdir()} == {
        "report.json", *answer["codesys"]["files"], *answer["logix"]["files"]
    }  # fmt: skip
    (tmp_path / "job.toml").write_text(JOB.text)
    cam = tmp_path / "tables" / answer["logix"]["files"][0]
    found = run.invoke(app, ["audit", str(cam), "--job", str(tmp_path / "job.toml"), "--json"])
    assert json.loads(found.stdout)["target"] == "logix"
    assert "saving" in run.invoke(app, ["audit", str(cam), "--job", str(tmp_path / "job.toml")]).stdout
    assert "Tables as the drives" in run.invoke(app, ["export", str(tmp_path / "design.json"), "--to", "br"]).stdout
