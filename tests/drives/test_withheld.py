"""What becomes of an older table when its new version is withheld: it is set aside, and nothing is lost."""

from __future__ import annotations

import hashlib
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from knives import HEADER, KNIVES, written

from camwright import load_job
from camwright.cli.main import main
from camwright.drives.withheld import (
    ENDING,
    older_tables,
    setting_aside,
)
from camwright.house.owned import LIST, Work
from camwright.house.progress import ignore
from camwright.profiles.errors import InputError
from camwright.profiles.tables.target import Header
from camwright.profiles.tables.targets import TARGETS
from camwright.stored.design_text import design_text
from camwright.studies.design import optimise

JOB = load_job()
TABLES = ("paper_600_Cam.L5X", "paper_600_Cam_mccp.txt")


@pytest.fixture(scope="module")
def designs(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Make a sound design, and the same cycle stored for a job whose acceleration limit it breaks."""
    place = tmp_path_factory.mktemp("designs")
    text = design_text(optimise(JOB))
    (place / "sound.json").write_text(text)
    stored = json.loads(text)
    stored["job"]["toml"] = JOB.text.replace('acceleration = "30 m/s^2"', 'acceleration = "8 m/s^2"')
    stored["provenance"]["job_sha256"] = hashlib.sha256(stored["job"]["toml"].encode()).hexdigest()
    (place / "broken.json").write_text(json.dumps(stored))
    return place / "sound.json", place / "broken.json"


def export(
    path: Path, to: str, out: Path, capsys: pytest.CaptureFixture[str], *more: str
) -> tuple[int, dict[str, Any]]:
    code = main(["export", str(path), "--to", to, "--out", str(out), "--json", *more])
    said = capsys.readouterr().out
    return code, json.loads(said) if said else {}


def contents(place: Path) -> dict[str, bytes]:
    return {file.name: file.read_bytes() for file in place.iterdir() if file.name not in ("report.json", LIST)}


@pytest.mark.parametrize("target", TARGETS)
def test_the_names_of_a_target_s_files_are_known_beforehand(target: str) -> None:
    for name in KNIVES:
        assert TARGETS[target].file_names(HEADER) == tuple(written(target, name))


def test_no_two_targets_share_a_file() -> None:
    names = [name for target in TARGETS.values() for name in target.file_names(HEADER)]
    assert len(set(names)) == len(names)


def test_an_older_table_is_renamed_and_its_bytes_are_kept(
    designs: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    sound, broken = designs
    code, answer = export(sound, "logix,codesys", tmp_path, capsys)
    assert (code, answer["set_aside"]) == (0, {})
    before = contents(tmp_path)
    code, answer = export(broken, "logix", tmp_path, capsys)
    assert code == 1
    assert answer["set_aside"] == {"logix": {name: name + ENDING for name in TABLES}}
    assert json.loads((tmp_path / "report.json").read_text())["set_aside"] == answer["set_aside"]
    after = contents(tmp_path)
    assert not set(after) & set(TABLES)
    # the table of the target that was not asked for stays; nothing is lost
    assert after == {name + ENDING if name in TABLES else name: data for name, data in before.items()}
    # a second time there is nothing left to rename
    assert export(broken, "logix", tmp_path, capsys) == (1, {**answer, "set_aside": {}})
    assert contents(tmp_path) == after


def test_what_was_set_aside_before_is_not_overwritten(
    designs: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    sound, broken = designs
    for endings in (("",), ("", "-2"), ("", "-2", "-3")):
        export(sound, "csv", tmp_path, capsys)
        assert (tmp_path / "paper_600_cam.csv").is_file()
        _, answer = export(broken, "csv", tmp_path, capsys)
        assert answer["set_aside"] == {"csv": {"paper_600_cam.csv": f"paper_600_cam.csv{ENDING}{endings[-1]}"}}
        assert set(contents(tmp_path)) == {f"paper_600_cam.csv{ENDING}{end}" for end in endings}


def test_a_forced_table_takes_the_older_one_s_place_and_says_so(
    designs: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    sound, broken = designs
    export(sound, "csv", tmp_path, capsys)
    code, answer = export(broken, "csv", tmp_path, capsys, "--force")
    assert (code, answer["set_aside"]) == (1, {})
    assert "NOT RELEASED" in (tmp_path / "paper_600_cam.csv").read_text()


def test_a_target_that_cannot_take_the_new_cam_leaves_no_older_table_either(
    designs: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    sound, _ = designs
    export(sound, "all", tmp_path, capsys)

    def refuse(*_: object) -> dict[str, str]:
        raise InputError("too wide for this drive")

    monkeypatch.setitem(TARGETS, "kollmorgen-kas", replace(TARGETS["kollmorgen-kas"], write=refuse))
    # named, it is an error: nothing is written and nothing renamed
    before = contents(tmp_path)
    assert export(sound, "kollmorgen-kas", tmp_path, capsys)[0] == 2
    assert contents(tmp_path) == before
    code, answer = export(sound, "all", tmp_path, capsys)
    assert code == 0
    old = ("paper_600_kas.csv", "paper_600_kas.txt")
    assert answer["set_aside"] == {"kollmorgen-kas": {name: name + ENDING for name in old}}
    assert contents(tmp_path) == {name + ENDING if name in old else name: data for name, data in before.items()}


def test_the_screen_says_so(
    designs: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    sound, broken = designs
    export(sound, "csv", tmp_path, capsys)
    assert main(["export", str(broken), "--to", "csv", "--out", str(tmp_path)]) == 1
    said = capsys.readouterr().out
    assert "csv: the new table is withheld; the older paper_600_cam.csv is now paper_600_cam.csv.withheld-old" in said


def test_tables_of_another_product_stay(
    designs: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    other = tmp_path / "other_cam.csv"
    other.write_text("x [mm],y [mm]\n")
    _, answer = export(designs[1], "csv", tmp_path, capsys)
    assert answer["set_aside"] == {}
    assert other.is_file()


def test_an_older_table_that_cannot_be_removed_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "p_cam.csv").write_text("old")
    older = older_tables(tmp_path, [TARGETS["csv"], TARGETS["logix"]], Header("p", "0"))
    assert older == {"csv": {"p_cam.csv": f"p_cam.csv{ENDING}"}}
    work = Work("export", "p", "0" * 64)

    def fail(_: Path, *, missing_ok: bool = False) -> None:
        raise PermissionError(13, "Permission denied")

    with monkeypatch.context() as patch:
        patch.setattr(Path, "unlink", fail)
        with (
            pytest.raises(
                InputError, match=r"p_cam.csv: this older table cannot be removed: Permission denied; do not"
            ),
            setting_aside(tmp_path, work, older, ignore) as aside,
        ):
            assert (aside / f"p_cam.csv{ENDING}").read_text() == "old"
    with setting_aside(tmp_path, work, older, ignore):
        pass
    assert not (tmp_path / "p_cam.csv").exists()
    assert older_tables(tmp_path / "none", [TARGETS["csv"]], Header("p", "0")) == {}
