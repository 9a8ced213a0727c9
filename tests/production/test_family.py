"""A family of cams: the fewest that cover the line speeds, each in sync over its band, and every change between them."""

from __future__ import annotations

import itertools
import json
import re
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from record_kinds import kinds

from camwright.cli.destination import Destination
from camwright.cli.family import write_family
from camwright.cli.main import main
from camwright.house.json_text import to_json
from camwright.house.language import LANGUAGES, Language
from camwright.house.owned import LIST, Work
from camwright.jobs.examples import example
from camwright.jobs.job import Job, parse_job
from camwright.jobs.servos import servos_of
from camwright.production.family import Family, family
from camwright.production.family_answer import family_answer, family_files, family_record
from camwright.production.family_cams import family_cams
from camwright.production.switching import switchings
from camwright.profiles.errors import InfeasibleError, InputError
from camwright.recipes.catalogue import catalogue
from camwright.recipes.family_sheet import family_sheet, family_sheets
from camwright.recipes.manifest import MANIFEST_FILE, manifest_text
from camwright.recipes.model import Origin
from camwright.recipes.verify import examine
from camwright.stored.design_file import parse_design
from camwright.studies.axis_study import solve_job
from camwright.studies.covering import FOUND_TO
from camwright.studies.family_bands import band_job
from camwright.studies.remedies import family_of, family_words
from camwright.validation.production.cam_change import CamChange, run_change
from camwright.validation.production.motion_table import ShiftCam
from camwright.validation.report import judge
from camwright.validation.servo.line_speeds import line_speed_errors


def job(length: float, tolerance: float, command: str = "shaped", lowest: str = "10 %", ramp: str = "") -> Job:
    """Give the bundled short cut, its servo known, with another length and tolerance (mm)."""
    text = example("short-cut").text
    text = re.sub(r"\[servo\.tolerance\].*?\n\n", "", text, flags=re.DOTALL)
    for key, value in (
        ("length", f'"{length} mm"'),
        ("sync_tolerance", f'"{tolerance} mm"'),
        ("command", f'"{command}"'),
        ("line_speeds", f'["{lowest}", "100 %"]'),
    ):
        text = re.sub(rf"^{key} = .*$", f"{key} = {value}", text, flags=re.MULTILINE)
    line = f'[line]\nacceleration = "{ramp}"\n' if ramp else ""
    return parse_job(text.replace("[servo]", f"{line}[servo]", 1), "family")


@pytest.fixture(scope="module")
def in_sync() -> Family:
    """Two cams in sync themselves, from 70 % of the line speed on."""
    return family(job(290, 0.03, "in_sync", "70 %"), ["csv"])


def require_held(found: Family, speeds: int = 40, phases: int = 64) -> None:
    """Simulate every cam over its band, and every change over the part that both of its cams hold."""
    tolerance = found.found.job.cut.sync_tolerance
    low, high = found.found.job.line_speeds
    cams = found.cams
    assert cams[0].line_speeds[0] == pytest.approx(low, rel=1e-12)
    assert cams[-1].line_speeds[1] == high
    for cam in cams:
        errors = line_speed_errors(
            cam.solution.profile, cam.job.task, servos_of(cam.job), np.linspace(*cam.line_speeds, speeds), phases
        )
        assert errors.max() <= tolerance * (1.0 + 1e-6)
        assert cam.band.holds(cam.line_speeds[0])
        assert cam.band.holds(cam.line_speeds[1])
    for (slower, faster), each in zip(itertools.pairwise(cams), found.switchings, strict=True):
        assert slower.line_speeds[1] >= faster.line_speeds[0] * (1.0 + 0.999 * found.found.overlap.share)
        assert faster.line_speeds[0] <= each.down < each.up <= slower.line_speeds[1]
        for before, after, change in ((slower, faster, each.changes[0]), (faster, slower, each.changes[1])):
            zero = after.running.zero
            between = ShiftCam(change.transitions[0].profile, zero) if change.transitions else None
            run = run_change(
                CamChange(
                    ShiftCam(before.solution.profile, before.running.zero),
                    ShiftCam(after.solution.profile, zero),
                    (before.job.task, after.job.task),
                    between,
                ),
                found.found.job.servo,
                [each.down, each.up],
                phases,
            )
            limits = after.job.limits
            assert run.sync_error <= tolerance
            assert run.peaks.peak_acceleration <= limits.acceleration * 1.001
            assert run.peaks.peak_speed <= limits.speed * 1.001


def test_two_cams_in_sync_are_switched_in_the_zone(in_sync: Family) -> None:
    assert in_sync.passed
    assert len(in_sync.cams) == 2
    assert in_sync.found.fewest
    require_held(in_sync, 20)
    (each,) = in_sync.switchings
    assert each.how == "direct"
    assert [change.jump.position for change in each.changes] == pytest.approx([0.0, 0.0], abs=1e-12)


def test_one_cam_will_not_do_where_two_are_the_fewest(in_sync: Family) -> None:
    found = in_sync.found
    low, top = found.cams[1].line_speeds
    for lowest in (found.job.line_speeds[0], low * (1.0 - 6.0 * FOUND_TO)):  # nor does the upper one reach further down
        asked = band_job(found.job, lowest, top)
        solution = solve_job(asked, suggest=False)
        report = judge(solution.profile, asked.task, asked.servo, servo_aware=True, slowest=asked.slowest)
        assert not report.passed


def test_files_and_answer_tell_the_same(in_sync: Family) -> None:
    answer, files = family_answer(in_sync), family_files(in_sync)
    json.dumps(answer, allow_nan=False)
    assert [cam["band_m_per_s"] for cam in answer["cams"]] == [list(cam.line_speeds) for cam in in_sync.cams]
    assert all(cam["worst_sync_error_m"] <= cam["sync_tolerance_m"] for cam in answer["cams"])
    rows = [line.split(",") for line in files["switching.csv"].splitlines() if not line.startswith("#")][1:]
    (switch,) = answer["switching"]
    up, down = (float(row[2]) / 60 for row in rows)
    assert [row[:2] for row in rows] == [["1", "rises above"], ["2", "falls below"]]
    assert switch["up_m_per_s"] - 1e-7 <= up <= switch["up_m_per_s"]  # never where the slower cam no longer holds
    assert switch["down_m_per_s"] <= down <= switch["down_m_per_s"] + 1e-7
    assert rows[0][3:] == ["2", "direct", "keeps its speed"]
    names = [name for table in in_sync.tables for name in table.files]
    assert len(names) == len(set(names)) == 2


def test_each_cam_is_a_design_of_its_own(in_sync: Family) -> None:
    files = family_files(in_sync)
    for cam in in_sync.cams:
        stored = parse_design(files[f"cam-{cam.number}.design.json"], "cam")
        assert stored.job.line_speeds == pytest.approx(cam.line_speeds, rel=1e-15)
        assert stored.job.name == cam.job.name
        x = np.linspace(0.0, stored.profile.end, 20)
        assert (stored.profile(x) == cam.solution.profile(x)).all()


@pytest.mark.slow
def test_the_line_of_a_job_that_ramps_gets_a_wider_overlap(in_sync: Family) -> None:
    ramped = replace(in_sync.found.job.line, acceleration=0.05)
    found = family_cams(replace(in_sync.found.job, line=ramped))
    assert not found.holds_line
    (each,) = switchings(found)
    low, top = each.line_speeds
    assert each.passed
    assert each.down**2 - low**2 == pytest.approx(2 * 0.05 * 2 * found.job.cut.length, rel=1e-9)
    assert top**2 - each.up**2 == pytest.approx(2 * 0.05 * 2 * found.job.cut.length, rel=1e-9)


def test_jobs_without_a_band_are_refused() -> None:
    with pytest.raises(
        InputError, match=r"servo_aware = false: a family is of servo-aware cams.*write servo_aware = true"
    ):
        family_cams(parse_job(example("paper-600").text, "paper"))
    with pytest.raises(InputError, match=r"line_speeds is the one line speed of the job.*write a range"):
        family_cams(replace(job(300, 0.1), slowest=1.0))


@pytest.mark.slow
def test_a_line_speed_without_any_cam_is_told() -> None:
    with pytest.raises(InfeasibleError, match=r"no family of cams covers its line speeds: at 80 m/min there is none"):
        family_cams(job(205, 0.03, "in_sync", "50 %"))


def test_an_overlap_wider_than_any_band_is_told(in_sync: Family) -> None:
    with pytest.raises(InfeasibleError, match=r"below 80 m/min no cam holds a band as wide as the overlap of 40 %"):
        family_cams(in_sync.found.job, 0.4)


@pytest.mark.parametrize("text", ["5", "0.5 %", "60 %", "x %", "nan %"])
def test_overlaps_that_are_none_are_refused(text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "job.toml"
    file.write_text(example("short-cut").text)
    assert main(["family", str(file), "--overlap", text]) == 2
    assert "--overlap takes 1 % to 50 %, e.g. 5 %" in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.parametrize(
    ("length", "tolerance", "ramp"),
    [(266, 0.05, ""), (260, 0.1, ""), (263, 0.06, ""), (280, 0.02, ""), (266, 0.05, "0.02 m/s^2")],
)
def test_shaped_families_hold_every_line_speed(length: float, tolerance: float, ramp: str) -> None:
    found = family(job(length, tolerance, ramp=ramp), ["csv", "codesys"])
    assert found.passed
    assert found.found.fewest
    assert len(found.cams) == 2
    require_held(found)
    assert [each.how for each in found.switchings] == ["transition"]


def test_a_design_that_fails_is_shown_the_family(in_sync: Family) -> None:
    bands = family_of(in_sync.found.job)
    assert bands is not None
    assert bands[-1] == pytest.approx(in_sync.cams[-1].line_speeds, rel=0.05)
    assert family_words(bands, in_sync.found.job.units) == (
        f"A family of 2 cams covers its line speeds, each holds a band (camwright family): 56 m/min to {60 * bands[0][1]:.4g} m/min, "
        f"{60 * bands[1][0]:.4g} m/min to 80 m/min"
    )
    assert family_of(replace(in_sync.found.job, slowest=1.0)) is None


@pytest.mark.parametrize("as_json", [True, False])
def test_the_command_writes_and_says_what_was_found(
    in_sync: Family,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    as_json: bool,
) -> None:
    monkeypatch.setattr("camwright.cli.family.family", lambda *_: in_sync)
    (tmp_path / "job.toml").write_text(in_sync.found.job.text, encoding="utf-8")
    out = tmp_path / "family"
    assert main(["family", str(tmp_path / "job.toml"), "--out", str(out), *(["--json"] if as_json else [])]) == 0
    shown = capsys.readouterr().out
    expected = {
        "switching.csv",
        "cams.csv",
        "cam-1.design.json",
        "cam-2.design.json",
        "family.json",
        "family.svg",
        "family.png",
        "family.html",
        "family.pdf",
        "manifest.json",
    }
    assert expected <= {file.name for file in out.iterdir()}
    assert len(list((out / "csv").glob("F*.csv"))) == 2
    stored = json.loads((out / "family.json").read_text())
    assert len(stored["profiles"]["cams"]) == 2
    assert stored["profiles"]["transitions"] == []
    if as_json:
        answer = json.loads(shown)
        assert answer["fewest"]
        assert {Path(file).name for file in answer["files"]} >= expected
        assert {key: value for key, value in answer.items() if key != "files"} == {
            key: value for key, value in stored.items() if key in answer
        }
    else:
        assert "2 cams, the fewest, from 56 m/min to" in " ".join(shown.split())
        assert "the line must keep its speed until a change is over" in " ".join(shown.split())
        svg = (out / "family.svg").read_text()
        assert all(words in svg for words in ("cam 1", "cam 2", "sync tolerance", "between switching down and up"))


@pytest.fixture(scope="module")
def written(in_sync: Family, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Write that family, its sheet in German."""
    out = tmp_path_factory.mktemp("family") / "out"
    work = Work("family", in_sync.found.job.name, in_sync.found.job.sha256)
    write_family(in_sync, Destination(out, work), "de", figures=False)
    return out


def test_the_folder_of_a_family_is_verified(written: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["verify", str(written)]) == 0
    shown = " ".join(capsys.readouterr().out.split())
    assert "2 changes, run anew, have the recorded checks" in shown
    assert "2 cams, judged and run over their bands anew, have the recorded sync errors" in shown


def forge(out: Path, record: dict) -> None:
    """Write another family.json into a folder, and a manifest that agrees with it."""
    (out / "family.json").write_text(to_json(record))
    files = {path.relative_to(out).as_posix(): path.read_bytes() for path in out.rglob("*") if path.is_file()}
    listed = {name: content for name, content in files.items() if Path(name).name not in (LIST, MANIFEST_FILE)}
    origin = json.loads((out / MANIFEST_FILE).read_text())["provenance"]
    (out / MANIFEST_FILE).write_text(
        manifest_text(listed, Origin(**{key: origin[key] for key in ("camwright", "job_sha256", "libraries")}))
    )


def test_nothing_of_a_family_can_be_left_out(written: Path, tmp_path: Path) -> None:
    """Every kind of key and item is taken out once; which libraries made it is a statement that nobody can prove."""
    out = shutil.copytree(written, tmp_path / "family")
    text = (out / "family.json").read_text()
    for kind, place in kinds(json.loads(text)).items():
        if kind[:2] == ("provenance", "libraries") or (kind[0] == "profiles" and len(kind) > 3):
            continue
        record = json.loads(text)
        parent = record
        for key in place[:-1]:
            parent = parent[key]
        del parent[place[-1]]
        forge(out, record)
        assert any(fault.file == "family.json" for fault in examine(out).faults), kind


@pytest.mark.parametrize(
    ("keys", "told"),
    [
        (("cams", 0, "worst_sync_error_m"), "cams.1.worst_sync_error_m"),
        (("switching", 0, "transition", "down", "checks", 0, "value"), "switching.2-1.sync"),
    ],
)
def test_a_family_that_says_what_its_cams_do_not_is_told(
    written: Path, tmp_path: Path, keys: tuple[str | int, ...], told: str
) -> None:
    out = shutil.copytree(written, tmp_path / "family")
    record = json.loads((out / "family.json").read_text())
    place = record
    for key in keys[:-1]:
        place = place[key]
    place[keys[-1]] *= 0.9
    # the forger makes sheet and manifest anew: only the cams themselves contradict
    for name, content in family_sheets(record).items():
        (out / name).write_bytes(content)
    forge(out, record)
    (fault,) = examine(out).faults
    assert (fault.file, fault.what.partition(":")[0]) == ("family.json", told)


def test_a_changed_table_of_a_family_and_one_too_many_are_told(written: Path, tmp_path: Path) -> None:
    out = shutil.copytree(written, tmp_path / "family")
    table = next((out / "csv").glob("F001*"))
    table.write_text(table.read_text().replace("0", "1", 1))
    (out / "csv" / "other.csv").write_text("0")
    assert {fault.file for fault in examine(out).faults} == {f"csv/{table.name}", "csv/other.csv"}


@pytest.mark.parametrize("language", LANGUAGES)
def test_the_sheet_of_a_family_is_in_the_language_of_its_reader(in_sync: Family, language: Language) -> None:
    words, english = catalogue(language), catalogue("en")
    data = family_sheet(family_record(in_sync, language), words)
    assert [section["heading"] for section in data["sections"]][:2] == [
        words("heading.cams"), words("heading.switching"),
    ]  # fmt: skip
    known = {text for text in english.messages.values() if len(text) > 12 and "{" not in text}
    assert language == "en" or [text for text in known if text in str(data)] == []
    (each,) = in_sync.switchings
    cells = str(data["sections"][1]["blocks"][0]["rows"])
    for speed in (each.up, each.down):
        assert f"{60 * speed:.3f}"[:-1].replace(".", words.units.decimal) in cells


def test_a_family_of_one_cam_has_nothing_to_say_of_others(in_sync: Family) -> None:
    record = family_record(in_sync, "en")
    record |= {"cams": record["cams"][:1], "switching": []}
    record["si"]["servo_tolerance"] = {"bandwidth": [108.0, 132.0], "damping": [0.7, 0.7]}
    data = family_sheet(record, catalogue("en"))
    assert ["Cams", "1"] in data["head"]
    assert "overlap" not in str(data["head"]).lower()
    servo = next(group for column in data["groups"] for group in column if group["heading"] == "Servo")
    assert ["Bandwidth of the velocity loop", "120 (108 to 132) rad/s"] in servo["rows"]
    assert ["Damping of the velocity loop", "0.7"] in servo["rows"]
    (signed,) = next(each for each in data["sections"] if each["key"] == "section.record")["blocks"]
    assert len(signed["rows"]) == 1
    assert signed["rows"][0][0].startswith("Cut length of cam 1 at ")


def test_a_family_whose_change_needs_a_standstill_is_not_released(in_sync: Family) -> None:
    (each,) = in_sync.switchings
    stopped = replace(each, changes=(each.changes[0], replace(each.changes[1], how="stop")))
    found = replace(in_sync, switchings=(stopped,))
    assert stopped.how == "stop"
    assert not stopped.passed
    assert not found.passed
    assert not family_answer(found)["passed"]
    assert ",stop," in family_files(found)["switching.csv"]
