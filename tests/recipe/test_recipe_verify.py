"""Verifying a recipe folder: nothing passes that was not written, and a fault is told by file and value."""

from __future__ import annotations

import hashlib
import json
import random
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from record_kinds import kinds

from camwright.profiles.errors import InputError
from camwright.profiles.tables.targets import TARGETS, read_table
from camwright.recipes.build import MadeRecipe
from camwright.recipes.html import recipe_html
from camwright.recipes.manifest import manifest_text
from camwright.recipes.recipe_file import canonical, parse_recipe
from camwright.recipes.verify import Fault, examine
from camwright.recipes.write import recipe_files, write_folder


def rebuild(folder: Path) -> None:
    """Write the manifest anew, as someone would who wants a change to pass."""
    files = {
        file.relative_to(folder).as_posix(): file.read_bytes()
        for file in folder.rglob("*")
        if file.is_file() and file.name != "manifest.json"
    }
    origin = parse_recipe(files["recipe.json"].decode(), "recipe.json").provenance
    (folder / "manifest.json").write_bytes(manifest_text(files, origin).encode())


def edit(folder: Path, change: Callable[[dict], object]) -> None:
    """Change recipe.json, and the manifest with it."""
    file = folder / "recipe.json"
    data = json.loads(file.read_text(encoding="utf-8"))
    change(data)
    file.write_bytes(canonical(data).encode())
    rebuild(folder)


def replace_in(file: Path, old: str, new: str) -> None:
    text = file.read_text(encoding="utf-8")
    assert old in text
    file.write_bytes(text.replace(old, new, 1).encode())


def test_a_recipe_as_it_was_written_has_no_fault(folder: Path) -> None:
    assert examine(folder).faults == ()


def test_a_carriage_with_chords_has_no_fault(saw: MadeRecipe, tmp_path: Path) -> None:
    write_folder(recipe_files(saw), tmp_path / "saw")
    assert examine(tmp_path / "saw").faults == ()


def changed_bytes(folder: Path, count: int) -> None:
    """Change one byte at random, so often: each change must be told of the file that it was made in."""
    rng = random.Random(20240607)  # noqa: S311 - no secret
    files = sorted(file for file in folder.rglob("*") if file.is_file())
    sizes = [file.stat().st_size for file in files]
    for i in range(count):
        file = files[i] if i < len(files) else rng.choices(files, sizes)[0]  # every file once, then every byte alike
        whole = file.read_bytes()
        at, flip = rng.randrange(len(whole)), rng.randrange(1, 256)
        file.write_bytes(whole[:at] + bytes([whole[at] ^ flip]) + whole[at + 1 :])
        faults = examine(folder).faults
        path = file.relative_to(folder).as_posix()
        assert any(fault.file == path for fault in faults), (path, at, flip)
        file.write_bytes(whole)
    assert examine(folder).faults == ()


def test_each_of_some_single_byte_changes_is_found(folder: Path) -> None:
    changed_bytes(folder, 30)


@pytest.mark.slow
def test_each_of_200_single_byte_changes_is_found(folder: Path) -> None:
    changed_bytes(folder, 200)


def test_every_byte_of_the_manifest_counts(folder: Path) -> None:
    from camwright.recipes.manifest import read_manifest

    whole = (folder / "manifest.json").read_bytes()
    assert read_manifest(whole)[1] == []
    for at in range(len(whole)):
        for flip in (1, 32, 128):
            assert read_manifest(whole[:at] + bytes([whole[at] ^ flip]) + whole[at + 1 :])[1], at


@pytest.mark.parametrize(
    "text",
    ["", "[]", "1", '"x"', "{}", '{"files": [1], "sha256": NaN}', '{"files": {}}', "[" * 100_000, '{"a": "\\ud800"}'],
)
def test_any_manifest_can_be_told_of(folder: Path, text: str) -> None:
    (folder / "manifest.json").write_text(text, encoding="utf-8")
    assert any(fault.file == "manifest.json" for fault in examine(folder).faults)


def test_other_white_space_in_the_manifest_is_found(folder: Path) -> None:
    file = folder / "manifest.json"
    data = json.loads(file.read_text(encoding="utf-8"))
    file.write_text(json.dumps(data, indent=2) + "\n", encoding="utf-8")
    assert Fault("manifest.json", "its bytes are not those that were written") in examine(folder).faults


def test_missing_and_added_files_are_found(folder: Path) -> None:
    (folder / "recipe.pdf").unlink()
    (folder / "tables" / "other.st").write_text("x")
    (folder / "link").symlink_to(folder / "recipe.html")
    faults = examine(folder).faults
    assert Fault("recipe.pdf", "missing") in faults
    assert Fault("tables/other.st", "not in the manifest") in faults
    assert any(fault.file == "link" for fault in faults)


def test_a_file_that_became_a_link_or_a_directory_is_found(folder: Path, tmp_path: Path) -> None:
    shutil.copy(folder / "recipe.html", tmp_path / "copy.html")
    (folder / "recipe.html").unlink()
    (folder / "recipe.html").symlink_to(tmp_path / "copy.html")
    assert Fault("recipe.html", "not a readable file") in examine(folder).faults


def test_without_manifest_or_recipe_the_rest_is_told(folder: Path) -> None:
    (folder / "manifest.json").unlink()
    assert Fault("manifest.json", "missing, or not a readable file") in examine(folder).faults
    rebuild(folder)
    (folder / "recipe.json").unlink()
    assert Fault("recipe.json", "missing") in examine(folder).faults


@pytest.mark.parametrize("place", ["nothing here", "file"])
def test_what_is_no_recipe_is_refused(tmp_path: Path, place: str) -> None:
    (tmp_path / "file").write_text("x")
    with pytest.raises(InputError, match="there is no such directory"):
        examine(tmp_path / place)
    with pytest.raises(InputError, match="not a recipe: neither manifest"):
        examine(tmp_path)


def test_a_changed_point_is_told_by_its_value_although_all_checksums_fit(folder: Path) -> None:
    file = next((folder / "tables").glob("*codesys.st"))
    text = file.read_text(encoding="utf-8")
    third = text.index("dY := ", text.index("dX := 195."))
    file.write_bytes((text[:third] + "dY := 100.1" + text[text.index(",", third) :]).encode())
    digest_of = {"path": f"tables/{file.name}"}

    def stay(data: dict) -> None:
        for table in data["tables"]:
            for entry in table["files"]:
                if entry["path"] == digest_of["path"]:
                    entry["sha256"] = hashlib.sha256(file.read_bytes()).hexdigest()

    edit(folder, stay)
    faults = [fault for fault in examine(folder).faults if fault.file == digest_of["path"]]
    assert any("is 100.1, recorded" in fault.what for fault in faults)
    assert any("check acceleration" in fault.what for fault in faults)
    assert len(faults) == len(examine(folder).faults)


def test_a_changed_start_is_told_although_all_checksums_fit(folder: Path) -> None:
    """A point of its table in file and recipe.json alike: the motion is not the one designed anew, and breaks a limit."""
    file = folder / "ramps" / "ramp_in_paper_600_cam.csv"
    lines = file.read_text(encoding="utf-8").splitlines(keepends=True)
    at = next(k for k in range(len(lines) - 2, 0, -1) if lines[k][:1].isdigit())
    cells = lines[at].split(",")
    lines[at] = ",".join([cells[0], repr(float(cells[1]) + 0.5), *cells[2:]])
    file.write_bytes("".join(lines).encode())

    def stay(data: dict) -> None:
        table = next(each for each in data["start_tables"][0]["tables"] if each["target"] == "csv")
        table["files"][0]["sha256"] = hashlib.sha256(file.read_bytes()).hexdigest()
        table["points"]["slave"] = read_table(TARGETS["csv"], "".join(lines), file.name).y.tolist()

    edit(folder, stay)
    faults = examine(folder).faults
    assert {fault.file for fault in faults} <= {"ramps/ramp_in_paper_600_cam.csv", "recipe.html"}
    assert any("position error" in fault.what for fault in faults)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (
            lambda data: data["job"]["si"]["cut"].update(length=0.61),
            "job.si.cut.length is 0.61, the job's text says 0.6",
        ),
        (lambda data: data.update(name="other"), "name is 'other', the job's text says 'paper-600'"),
        (lambda data: data.update(released=False), "released is False, its checks say True"),
        (
            lambda data: data["job"].update(toml=data["job"]["toml"] + "\n"),
            "the stored job is not the one that was designed",
        ),
        (lambda data: data["tables"][0].update(target="none"), "there is no target 'none'"),
        (lambda data: data["profile"]["breaks"].reverse(), "break"),
    ],
)
def test_what_recipe_json_says_twice_must_agree(folder: Path, change: Callable[[dict], object], said: str) -> None:
    edit(folder, change)
    assert any(fault.file == "recipe.json" and said in fault.what for fault in examine(folder).faults), examine(
        folder
    ).faults


def test_a_promise_that_the_table_does_not_keep_is_told(folder: Path) -> None:
    def better(data: dict) -> None:
        data["tables"][1]["position_error"] = 1e-12
        data["tables"][1]["checks"][4]["value"] = 0.0
        data["tables"][1]["points"]["slave"][3] += 1e-9

    edit(folder, better)
    faults = examine(folder).faults
    assert {fault.file for fault in faults} == {"tables/paper_600_Cam.L5X"}
    assert any(
        fault.what.startswith("position error (m): ") and fault.what.endswith("recorded 1e-12") for fault in faults
    )
    assert any(fault.what.startswith("point 4: slave is ") for fault in faults)


def test_a_changed_profile_is_told_by_all_tables(folder: Path) -> None:
    def bend(data: dict) -> None:
        data["profile"]["coefficients"][2][3] *= 1.001

    edit(folder, bend)
    assert len({fault.file for fault in examine(folder).faults}) == 3


def test_a_table_that_cannot_be_read_is_told(folder: Path) -> None:
    file = next((folder / "tables").glob("*.csv"))
    file.write_bytes(b"x [mm],y [mm]\n0,\x00\n")
    rebuild(folder)
    faults = [fault for fault in examine(folder).faults if fault.file == f"tables/{file.name}"]
    assert any("SHA-256" in fault.what for fault in faults)
    assert any("control character" in fault.what for fault in faults)


def test_what_is_proved_is_said(folder: Path) -> None:
    found = examine(folder)
    assert found.faults == found.notes == ()
    files, tables, starts, _, sheet, rest = found.proved
    assert files.startswith(f"{len([file for file in folder.rglob('*') if file.is_file()])} files have the checksums")
    assert tables.startswith("3 tables, read and rebuilt as their drives do")
    assert starts.startswith("9 tables of start, stop and one piece have so, between the park and the cam")
    assert sheet == "recipe.html, recipe.pdf, recipe.xlsx say what recipe.json says"
    assert rest == "not proved: who wrote it (no signature was checked)"


def test_tables_that_the_recipe_has_must_be_there(folder: Path) -> None:
    """Tables taken out of the folder and of the manifest, as someone would who wants it to pass."""
    shutil.rmtree(folder / "tables")
    rebuild(folder)
    faults = examine(folder).faults
    assert len(faults) == 4
    assert {fault.what for fault in faults} == {"missing, or not a readable file: recipe.json has it"}


def test_a_released_table_has_files(folder: Path) -> None:
    (file,) = (folder / "tables").glob("*_cam.csv")
    file.unlink()
    edit(folder, lambda data: data["tables"][2].update(files=[]))
    assert examine(folder).faults == (Fault("recipe.json", "the table for csv is released and has no file"),)


SHEET: dict[str, Callable[[dict], object]] = {
    "slave_start": lambda data: data.update(slave_start=0.01),
    "pitch": lambda data: data.update(pitch=0.41),
    "objective.value": lambda data: data["objective"].update(value=data["objective"]["value"] * 0.99),
    "objective.name": lambda data: data["objective"].update(name="peak_jerk"),
    "zones.shear[0][1]": lambda data: data["zones"]["shear"][0].__setitem__(1, data["zones"]["shear"][0][1] + 1e-4),
    "checks.acceleration.value": lambda data: check(data, "acceleration").update(value=7.0),
    "checks.acceleration.limit": lambda data: check(data, "acceleration").update(limit=40.0),
    "checks are ": lambda data: data["checks"].remove(check(data, "settling")),
    "speeds[3].following_error": lambda data: data["speeds"][3].update(following_error=1e-3),
    "speeds[1].acceleration": lambda data: data["speeds"][1].update(acceleration=None),
    "speeds has 4 entries": lambda data: data["speeds"].pop(),
    "lead_time": lambda data: data.update(lead_time=0.05),
    "speed_band[0].high": lambda data: data["speed_band"][0].update(high=1.01 * data["speed_band"][0]["high"]),
    "speed_band[0].high_binding": lambda data: data["speed_band"][0].update(high_binding="none"),
    "working_range.max_line_speed.value": lambda data: data["working_range"]["max_line_speed"].update(value=3.0),
    "start_stop.park": lambda data: data["start_stop"].update(park=-0.21),
    "start_stop.ramp_in.peak_acceleration": lambda data: data["start_stop"]["ramp_in"].update(peak_acceleration=8.0),
    "start_stop.ramp_out": lambda data: data["start_stop"].update(ramp_out=None),
    "marks[9].redesign.earliest": lambda data: data["marks"][9]["redesign"].update(earliest=-0.3),
    "marks[9].redesign.latest": lambda data: data["marks"][9]["redesign"].update(latest=0.3),
    "start_tables.ramp_in.profile": lambda data: data["start_tables"][0]["profile"]["coefficients"][0].__setitem__(
        0, 1e-3
    ),
    "start_tables are not those": lambda data: data["start_tables"].pop(),
    "start_tables are not those of": lambda data: data.pop("start_tables"),
    "start_tables.ramp_out is not for the targets": lambda data: data["start_tables"][1]["tables"].pop(),
    "start_tables.one_shot.profile": lambda data: data["start_tables"][2]["profile"]["breaks"].pop(),
    "start_stop: ": lambda data: data.update(start_stop=None),
    "marks has 10 entries, recorded 0": lambda data: data["marks"].clear(),
    "line_ramp: ": lambda data: data.update(line_ramp=None),
    "line_ramp.by_speed has": lambda data: data["line_ramp"]["by_speed"].pop(),
    "line_ramp.by_speed[0].": lambda data: data["line_ramp"]["by_speed"][0].update(stop=99.0),
    "steps of csv": lambda data: data["tables"][2].update(steps=[]),
    "working_range.min_length.binding": lambda data: data["working_range"]["min_length"].update(binding="stroke"),
}


def check(data: dict, name: str) -> dict:
    return next(each for each in data["checks"] if each["name"] == name)


@pytest.mark.parametrize("place", SHEET)
def test_values_of_the_sheet_are_those_of_its_cam(folder: Path, place: str) -> None:
    """Every checksum fits, and the page and the rest are made anew of the changed recipe.json."""
    edit(folder, SHEET[place])
    recipe = parse_recipe((folder / "recipe.json").read_text(encoding="utf-8"), "recipe.json")
    (folder / "recipe.html").write_text(recipe_html(recipe), encoding="utf-8", newline="")
    rebuild(folder)
    faults = examine(folder).faults
    assert len(faults) == 1, faults
    assert faults[0].file == "recipe.json"
    assert faults[0].what.startswith(place)


def test_points_that_are_left_out_are_told(folder: Path) -> None:
    edit(folder, lambda data: data["tables"][2]["points"]["slave"].pop())
    assert any("recorded of the slave" in fault.what for fault in examine(folder).faults)


def test_tables_of_starts_go_with_those_of_the_cam(folder: Path) -> None:
    for file in (folder / "tables").iterdir():
        file.unlink()
    edit(folder, lambda data: data.update(tables=[]))
    faults = [fault.what for fault in examine(folder).faults]
    assert any(what.startswith("tables and refused are empty") for what in faults)


def test_a_page_that_says_something_else_is_told(folder: Path) -> None:
    replace_in(folder / "recipe.html", "paper-600", "paper-601")
    (folder / "recipe.pdf").write_bytes((folder / "recipe.pdf").read_bytes() + b"%\n")
    rebuild(folder)
    found = examine(folder)
    assert found.faults == (Fault("recipe.html", "is not what this camwright makes of recipe.json"),)
    (note,) = found.notes
    assert note.file == "recipe.pdf"
    assert note.what.endswith("or was made with other versions of the typesetting libraries")


FREE = ("provenance", "libraries")
"""What made it: a statement that nobody can prove."""


def without_each(folder: Path, under: str) -> None:
    """Take out each kind of key and item, and empty each object and list, the manifest written anew: each must be told."""
    data = json.loads((folder / "recipe.json").read_text(encoding="utf-8"))
    written = (folder / "recipe.json").read_bytes()
    files = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file() and path.name != "manifest.json"}
    origin = parse_recipe(json.dumps(data), "recipe.json").provenance
    for kind, place in kinds(data).items():
        if kind[0] != under or kind[:2] == FREE:
            continue
        for emptied in (False, True):
            forged = json.loads(json.dumps(data))
            parent = forged
            for part in place[:-1]:
                parent = parent[part]
            if emptied and not (isinstance(parent[place[-1]], dict | list) and parent[place[-1]]):
                continue
            if emptied:
                parent[place[-1]] = type(parent[place[-1]])()
            else:
                del parent[place[-1]]
            files[folder / "recipe.json"] = canonical(forged).encode()
            (folder / "recipe.json").write_bytes(files[folder / "recipe.json"])
            named = {path.relative_to(folder).as_posix(): content for path, content in files.items()}
            (folder / "manifest.json").write_bytes(manifest_text(named, origin).encode())
            assert any(not fault.file.startswith("recipe.h") for fault in examine(folder).faults), (kind, emptied)
    (folder / "recipe.json").write_bytes(written)


@pytest.mark.parametrize("under", ["job", "speeds", "refused"])
def test_nothing_can_be_left_out(folder: Path, under: str) -> None:
    without_each(folder, under)


@pytest.mark.slow
def test_nothing_at_all_can_be_left_out(folder: Path) -> None:
    for under in json.loads((folder / "recipe.json").read_text(encoding="utf-8")):
        without_each(folder, under)


def test_a_recipe_of_another_version_is_not_computed_anew(folder: Path) -> None:
    edit(folder, lambda data: data["provenance"].update(camwright="0.1.0"))
    found = examine(folder)
    assert found.faults == ()
    assert found.notes[0].what.startswith("made by camwright 0.1.0: ")
    assert not any("computed anew" in line for line in found.proved)


def test_files_of_the_desktop_are_named_and_no_fault(folder: Path) -> None:
    for name in ("Thumbs.db", ".DS_Store", "tables/desktop.ini", "tables/.DS_Store"):
        (folder / name).write_bytes(b"\x00")
    found = examine(folder)
    assert found.faults == ()
    assert [note.file for note in found.notes] == [".DS_Store", "Thumbs.db", "tables/.DS_Store", "tables/desktop.ini"]
    (folder / "tables" / "Thumbs.db").symlink_to(folder / "recipe.html")
    (folder / "my thumbs.db").write_bytes(b"")
    assert [fault.file for fault in examine(folder).faults] == ["my thumbs.db", "tables/Thumbs.db"]
