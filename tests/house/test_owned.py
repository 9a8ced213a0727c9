"""The list of what a command wrote: a rerun replaces these files and nothing else, and what is not ours is left alone."""

from __future__ import annotations

import json
import os
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import pytest

from camwright.cli.main import main
from camwright.house import files
from camwright.house.owned import LIST, Work, owned, read_list
from camwright.jobs.job import BUNDLED_JOB
from camwright.profiles.errors import InputError
from camwright.studies.quick import quick_cam_text, read_cross_cut

ONE = Work("design", "a job", "1" * 64)
TWO = replace(ONE, sha256="2" * 64)


def write(place: Path, work: Work = ONE, **files: str) -> list[str]:
    """Write files as a command does; the notes."""
    notes: list[str] = []
    with owned(place, work, notes.append) as aside:
        for name, text in files.items():
            (aside / name).write_text(text)
    return notes


def names(place: Path) -> list[str]:
    return sorted(file.name for file in place.iterdir() if file.name != LIST)


def test_figures_of_an_older_run_go_and_notes_stay(tmp_path: Path) -> None:
    assert write(tmp_path, cam="1", figure="1") == []
    (tmp_path / "photo").write_text("mine")
    (tmp_path / "notes").mkdir()
    assert write(tmp_path, cam="2") == []
    assert names(tmp_path) == ["cam", "notes", "photo"]
    assert (tmp_path / "cam").read_text() == "2"


def test_the_same_work_gives_the_same_list_whatever_was_before(tmp_path: Path) -> None:
    write(tmp_path / "a", cam="1")
    write(tmp_path / "b", TWO, cam="0", figure="0")
    write(tmp_path / "b", cam="1")
    assert (tmp_path / "a" / LIST).read_bytes() == (tmp_path / "b" / LIST).read_bytes()


def test_works_of_several_commands_stand_side_by_side(tmp_path: Path) -> None:
    write(tmp_path, cam="1")
    assert write(tmp_path, replace(ONE, command="compare"), comparison="1") == []
    assert write(tmp_path, cam="2", figure="2") == []
    assert names(tmp_path) == ["cam", "comparison", "figure"]


def test_what_another_command_wrote_is_replaced_and_told(tmp_path: Path) -> None:
    write(tmp_path, replace(ONE, command="quick", name="knife"), cam="1", more="1")
    (note,) = write(tmp_path, cam="2")
    assert note == f"{tmp_path}: of what quick made of 'knife' (SHA-256 111111111111) cam is replaced, more stay"
    write(tmp_path, figure="3")  # cam is of the design now, and goes with it
    assert names(tmp_path) == ["figure", "more"]


def test_an_earlier_state_is_replaced_and_told(tmp_path: Path) -> None:
    write(tmp_path, cam="1", figure="1")
    (note,) = write(tmp_path, TWO, cam="2")
    assert note == f"{tmp_path}: what design made of an earlier state of 'a job' (SHA-256 111111111111) is replaced"
    assert names(tmp_path) == ["cam"]


def test_a_work_that_adds_keeps_what_it_wrote_before(tmp_path: Path) -> None:
    tables = replace(ONE, command="export", adds=True)
    write(tmp_path, tables, csv="1")
    assert write(tmp_path, tables, trio="1") == []
    (note,) = write(tmp_path, replace(tables, sha256="2" * 64), trio="2")
    assert note.endswith("trio is replaced, csv stay")
    assert names(tmp_path) == ["csv", "trio"]


def test_a_changed_file_is_kept_under_another_name(tmp_path: Path) -> None:
    for number in ("", "-2"):
        write(tmp_path, **{"cam.csv": "1", "figure.svg": "1"})
        (tmp_path / "cam.csv").write_text(f"corrected {number}")
        (tmp_path / "figure.svg").write_text("annotated")
        notes = write(tmp_path, **{"cam.csv": "2"})
        assert notes == [
            f"{tmp_path / name}: changed since camwright wrote it; kept as {name.replace('.', f'.changed{number}.')}"
            for name in ("cam.csv", "figure.svg")
        ]
        assert (tmp_path / f"cam.changed{number}.csv").read_text() == f"corrected {number}"
    assert names(tmp_path) == [
        "cam.changed-2.csv", "cam.changed.csv", "cam.csv", "figure.changed-2.svg", "figure.changed.svg",
    ]  # fmt: skip


def test_a_file_that_is_not_on_the_list_is_not_overwritten(tmp_path: Path) -> None:
    (tmp_path / "cam").write_text("mine")
    with pytest.raises(InputError, match=r"cam is there already, and not on the list .* choose another --out"):
        write(tmp_path, cam="1", figure="1")
    assert names(tmp_path) == ["cam"]
    assert not (tmp_path / LIST).exists()
    assert write(tmp_path, cam="mine") == []  # the same bytes: nothing is lost


@pytest.mark.parametrize("name", ["cam", LIST])
@pytest.mark.parametrize(
    ("make", "what"),
    [
        (lambda place: place.symlink_to("elsewhere"), "a link"),
        (lambda place: place.mkdir(), "a directory"),
        (os.mkfifo, "a device"),
    ],
)
def test_links_devices_and_directories_are_left_alone(
    make: Callable[[Path], None], what: str, name: str, tmp_path: Path
) -> None:
    place = tmp_path / "out"
    place.mkdir()
    make(place / name)
    with pytest.raises(InputError, match=rf"{what} is in the way of the file .* left alone; move it away"):
        write(place, cam="1")
    assert os.listdir(place) == [name]
    assert not (tmp_path / "elsewhere").exists()


@pytest.mark.parametrize(
    "damage",
    [
        lambda text: text[:-5],
        lambda text: text.replace('"cam": "', '"cam": "x'),
        lambda text: text[:0],
        lambda text: text[:0] + "[]",
        lambda text: "not JSON" + text,
        lambda text: text.replace('"cam"', '"../cam"'),
        lambda text: text.replace('"cam"', f'"{LIST}"'),
        lambda text: text.replace('"schema_version": 1', '"schema_version": 2'),
        lambda text: text + " ",
        lambda text: text[:0] + "[" * 100_000,
    ],
)
def test_a_damaged_list_is_refused(damage: Callable[[str], str], tmp_path: Path) -> None:
    write(tmp_path / "out", cam="1")
    (tmp_path / "cam").write_text("outside")
    file = tmp_path / "out" / LIST
    file.write_text(damage(file.read_text()))
    with pytest.raises(InputError, match=r"is damaged, so nothing here is overwritten; .* choose another --out"):
        write(tmp_path / "out", figure="1")
    assert (tmp_path / "cam").read_text() == "outside"


def test_a_failure_puts_everything_back(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write(tmp_path, **{"a.csv": "1", "b.csv": "1", "c.svg": "1"})
    (tmp_path / "b.csv").write_text("changed")
    before = {file.name: file.read_bytes() for file in tmp_path.iterdir()}
    unlink = Path.unlink

    def fail(path: Path, *, missing_ok: bool = False) -> None:
        if path.name == "c.svg":
            raise OSError(5, "the disk is gone")
        unlink(path, missing_ok=missing_ok)

    monkeypatch.setattr(Path, "unlink", fail)
    with pytest.raises(InputError, match="the disk is gone"):
        write(tmp_path, TWO, **{"a.csv": "2", "b.csv": "2", "d.csv": "2"})
    monkeypatch.undo()
    assert {file.name: file.read_bytes() for file in tmp_path.iterdir()} == before


def job_text(length: str) -> str:
    return BUNDLED_JOB.read_text(encoding="utf-8").replace('"600 mm"', f'"{length}"')


def test_two_jobs_of_one_name_do_not_overwrite_each_other(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("a.toml").write_text(job_text("600 mm"))
    Path("b.toml").write_text(job_text("650 mm"))
    assert main(["design", "a.toml", "--no-figures", "--quiet"]) == 0
    before = Path("out/paper-600/design.json").read_bytes()
    assert main(["design", "b.toml", "--no-figures", "--quiet"]) == 2
    said = capsys.readouterr().err
    assert "holds the design of a.toml, which is called 'paper-600' too; give one of them another name" in said
    assert Path("out/paper-600/design.json").read_bytes() == before
    Path("a.toml").unlink()  # the same file under another name, or edited: its design is replaced, and told
    assert main(["design", "b.toml", "--no-figures", "--quiet"]) == 0
    assert "what design made of an earlier state of 'paper-600'" in capsys.readouterr().err
    assert Path("out/paper-600/design.json").read_bytes() != before


def test_commands_at_the_same_moment_write_one_after_another(tmp_path: Path) -> None:
    """Each finds all that the one before left: no files of two works under one list, and every replacement is told."""
    works = [replace(ONE, sha256=digit * 64) for digit in "12345678"]
    ready = threading.Barrier(len(works))

    def wrote(work: Work) -> list[str]:
        ready.wait()
        return write(tmp_path / "out", work, **{f"file{number}": work.sha256 for number in range(20)})

    with ThreadPoolExecutor(len(works)) as pool:
        notes = list(pool.map(wrote, works))
    (entry,) = read_list(tmp_path / "out")
    assert {(tmp_path / "out" / name).read_text() for name in entry.files} == {entry.sha256}
    assert names(tmp_path / "out") == sorted(entry.files)
    assert sorted(map(len, notes)) == [0] + [1] * (len(works) - 1)


def test_a_command_that_was_killed_while_it_moved_its_files_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(files, "_WAIT", 0.02)
    (tmp_path / ".camwright-moving").mkdir()
    with pytest.raises(
        InputError, match=r"another camwright is moving its files here, or was killed .* remove .*\.camwright-moving"
    ):
        write(tmp_path, cam="1")
    assert names(tmp_path) == [".camwright-moving"]
    (tmp_path / ".camwright-moving-recipe").mkdir()
    with pytest.raises(InputError, match="nothing was written"), files.replaced(tmp_path / "recipe", lambda _: True):
        pass
    assert not (tmp_path / "recipe").exists()


def test_markup_in_a_path_is_text(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "[neu]" / "[b]:smile:"
    assert main(["quick", "--circumference", "400mm", "--sync", "80mm", "--length", "600mm", "--out", str(folder)]) == 0
    assert str(folder) in capsys.readouterr().out.replace("\n", "")
    table = tmp_path / "[" / "b]cam.csv"
    table.parent.mkdir()
    table.write_text(quick_cam_text(read_cross_cut("400mm", "80mm", "600mm")))
    job = str(BUNDLED_JOB)
    for arguments in (["audit", str(table), "--job", job, "--no-figures"], ["validate", str(table), "--job", job]):
        assert main(arguments) in (0, 1)
    assert "[/b]cam.csv" in capsys.readouterr().out.replace("\n", "")


def test_the_list_is_read_by_people(tmp_path: Path) -> None:
    write(tmp_path, cam="1")
    listed = json.loads((tmp_path / LIST).read_text())
    assert listed["kind"] == "camwright files"
    assert listed["written"][0].keys() == {"command", "name", "sha256", "files"}


@pytest.mark.parametrize("name", ["con", "AUX", "nul.job", "Com1", "lpt9", "prn . x", "COM²"])
def test_names_of_devices_are_no_names(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("job.toml").write_text(job_text("600 mm").replace('"paper-600"', f'"{name}"'), encoding="utf-8")
    assert main(["check", "job.toml"]) == 2
    assert "Windows takes this name for a device; it names the output directory" in capsys.readouterr().err
    assert main(["new", name]) == 2
    Path(f"{name}.dxf").write_text("")
    assert main(["bend", f"{name}.dxf"]) == 2
    assert "for a device, and the files are called after it; rename the file" in capsys.readouterr().err
    assert not Path("out").exists()


@pytest.mark.parametrize("name", ["control", "console-2", "com10", "lpt", "a con", "nullmotor"])
def test_names_that_only_look_like_devices_are_names(name: str, tmp_path: Path) -> None:
    (tmp_path / "job.toml").write_text(job_text("600 mm").replace('"paper-600"', f'"{name}"'), encoding="utf-8")
    assert main(["check", str(tmp_path / "job.toml"), "--quiet"]) == 0
