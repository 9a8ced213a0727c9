"""Files: written whole or not at all, read back without loss, carrying where they come from."""

from __future__ import annotations

import errno
import hashlib
import json
import os
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path

import jsonschema
import numpy as np
import pytest

from camwright import load_job, validate
from camwright.house.files import staged, write_files
from camwright.house.provenance import provenance
from camwright.jobs.job import BUNDLED_JOB, Job
from camwright.profiles.errors import InputError
from camwright.profiles.returns import baseline
from camwright.profiles.tables.cam_csv import write_cam_csv
from camwright.profiles.tables.cam_rows import read_cam_csv
from camwright.stored.design_file import (
    design_schema,
    parse_design,
    read_design,
)
from camwright.stored.design_text import design_text
from camwright.stored.profile_files import cam_text, read_cycle, rows_note
from camwright.studies.design import Design, optimise

EXAMPLES = Path(__file__).parents[2] / "examples"
FULL = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def tree(place: Path) -> dict[str, str | None]:
    """Everything below a place: texts of files, nothing for directories."""
    return {str(entry.relative_to(place)): entry.read_text() if entry.is_file() else None for entry in place.rglob("*")}


def test_files_appear_together_and_the_folder_aside_goes(tmp_path: Path) -> None:
    with staged(tmp_path / "a" / "b") as aside:
        (aside / "one").write_text("1")
        (aside / "two").write_text("2")
        assert [entry for entry in (tmp_path / "a" / "b").iterdir() if entry.is_file()] == []
    assert tree(tmp_path) == {"a": None, "a/b": None, "a/b/one": "1", "a/b/two": "2"}


def test_files_that_were_there_are_replaced_and_others_kept(tmp_path: Path) -> None:
    (tmp_path / "one").write_text("old")
    (tmp_path / "mine").write_text("kept")
    with staged(tmp_path) as aside:
        (aside / "one").write_text("new")
    assert tree(tmp_path) == {"one": "new", "mine": "kept"}


@pytest.mark.parametrize("failure", [FULL, KeyboardInterrupt(), InputError("x")])
def test_nothing_is_left_when_the_work_fails(tmp_path: Path, failure: BaseException) -> None:
    def work() -> None:
        with staged(tmp_path / "a" / "b") as aside:
            (aside / "one").write_text("1")
            raise failure

    with pytest.raises(InputError if isinstance(failure, OSError) else type(failure)) as caught:
        work()
    assert tree(tmp_path) == {}
    if isinstance(failure, OSError):
        assert "the files cannot be written: No space left on device; what was there is as it was" in str(caught.value)


def test_many_files_are_brought_to_the_disk_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    synced: list[str] = []
    monkeypatch.setattr(os, "fsync", lambda _: synced.append("one"))
    monkeypatch.setattr(os, "sync", lambda: synced.append("all"), raising=False)
    for count, meant in ((3, ["one"] * 3), (300, ["all"])):
        write_files(tmp_path / str(count), {f"{k}.txt": "x" for k in range(count)})
        assert synced == meant
        assert len(list((tmp_path / str(count)).iterdir())) == count
        synced.clear()


@pytest.mark.parametrize("call", [1, 2])
@pytest.mark.parametrize("function", ["fsync", "replace"])
def test_nothing_is_left_when_the_disk_is_full(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, function: str, call: int
) -> None:
    (tmp_path / "one").write_text("old")
    real, calls = getattr(os, function), []

    def failing(*arguments: object) -> object:
        calls.append(arguments)
        if len(calls) == call:
            raise FULL
        return real(*arguments)

    def work() -> None:
        with staged(tmp_path) as aside:
            (aside / "new").write_text("n")
            (aside / "one").write_text("1")
            (aside / "zwei").write_text("2")
            monkeypatch.setattr(os, function, failing)

    with pytest.raises(InputError, match="No space left on device"):
        work()
    assert tree(tmp_path) == {"one": "old"}


def test_what_is_in_the_way_is_refused_and_kept(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("kept")
    (tmp_path / "cam.csv").mkdir()
    before = tree(tmp_path)

    def write(place: Path) -> None:
        with staged(place) as aside:
            (aside / "a").write_text("a")
            (aside / "cam.csv").write_text("c")

    with pytest.raises(InputError, match=r"the output directory cannot be made: a file is in the way"):
        write(tmp_path / "file")
    with pytest.raises(InputError, match=r"the output directory cannot be made: Not a directory"):
        write(tmp_path / "file" / "below")
    with pytest.raises(InputError, match=r"a directory is in the way of the file cam.csv"):
        write(tmp_path)
    with pytest.raises(InputError, match=r"embedded null"):
        write(tmp_path / "a\0b")
    assert tree(tmp_path) == before


def test_a_directory_that_may_not_be_written_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_arguments: object, **_options: object) -> str:
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))

    monkeypatch.setattr("tempfile.mkdtemp", refuse)  # permissions bind no superuser, whom tests may run as
    with pytest.raises(InputError, match=r"Permission denied.*choose another --out"), staged(tmp_path / "a"):
        pass
    assert tree(tmp_path) == {}


def test_provenance_names_versions_and_the_job_but_no_time() -> None:
    job = load_job()
    assert provenance(job.sha256) == {
        "camwright": version("camwright"),
        "job_sha256": hashlib.sha256(BUNDLED_JOB.read_bytes()).hexdigest(),
        "libraries": {name: version(name) for name in ("casadi", "numpy", "scipy")},
        "schema_version": 1,
    }


@pytest.fixture(scope="module")
def paper() -> Design:
    return optimise(load_job())


def test_a_design_is_read_back_bit_by_bit(paper: Design, tmp_path: Path) -> None:
    file = tmp_path / "design.json"
    file.write_text(design_text(paper))
    stored = read_design(file)
    np.testing.assert_array_equal(stored.profile.breaks, paper.profile.breaks)
    np.testing.assert_array_equal(stored.profile.coefficients, paper.profile.coefficients)
    assert stored.job == paper.job
    np.testing.assert_array_equal(read_cycle(file, paper.job)[0].coefficients, paper.profile.coefficients)


def test_a_design_keeps_the_shipped_schema(paper: Design) -> None:
    shipped = json.loads((BUNDLED_JOB.parent.parent / "schemas" / "design.schema.json").read_text(encoding="utf-8"))
    assert shipped == design_schema()
    jsonschema.Draft202012Validator.check_schema(shipped)
    data = json.loads(design_text(paper))
    jsonschema.validate(data, shipped)
    data["extra"] = 1
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(data, shipped)


def test_the_same_job_gives_the_same_bytes(paper: Design) -> None:
    again = optimise(load_job())
    assert (design_text(again), cam_text(again)) == (design_text(paper), cam_text(paper))


def test_the_table_has_its_origin_its_rows_and_its_breaks(paper: Design) -> None:
    text = cam_text(paper)
    comments = [line for line in text.splitlines() if line.startswith("#")]
    assert comments[:3] == [
        "# job: paper-600",
        f"# camwright: {version('camwright')}",
        f"# job_sha256: {paper.job.sha256}",
    ]
    rows = read_cam_csv(text, "")
    assert len(rows.x) == 361
    np.testing.assert_allclose(np.interp(paper.profile.breaks, rows.x, rows.x), paper.profile.breaks, rtol=1e-15)
    distance = np.abs(paper.profile.breaks[:, None] - rows.x).min(axis=1)
    assert distance.max() < 1e-15
    np.testing.assert_allclose(rows.y, paper.profile(np.clip(rows.x, 0.0, 0.6)), atol=1e-15)


def test_a_table_rounded_to_micrometres_is_still_this_cycle(tmp_path: Path) -> None:
    job = load_job()
    profile = baseline("poly_3_4_5", job.task)
    x = np.linspace(0.0, 0.6, 91)
    file = tmp_path / "cam.csv"
    file.write_text(
        "x [mm],y [mm]\n" + "".join(f"{a:.4f},{b:.4f}\n" for a, b in zip(x * 1e3, profile(x) * 1e3, strict=True))
    )
    read = read_cycle(file, job)[0]
    assert (read.start, read.end) == (0.0, 0.6)
    assert np.abs(read(x) - profile(x)).max() < 1e-7


def test_a_table_of_another_cut_length_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "cam.csv"
    file.write_text("x [mm],y [mm]\n" + "".join(f"{i},{i}\n" for i in range(0, 591, 10)))
    with pytest.raises(InputError, match=r"from 0 mm to 590 mm, but a cycle of the job from 0 mm to 600 mm"):
        read_cycle(file, load_job())


def damaged(paper: Design, **changes: object) -> str:
    return json.dumps({**json.loads(design_text(paper)), **changes})


def test_a_damaged_design_is_refused(paper: Design) -> None:
    whole = design_text(paper)
    job = json.loads(whole)["job"]
    cases = [
        (whole[: len(whole) // 2], "d.json: not JSON: "),
        ("[" * 100_000, "nested too deeply"),
        ("[]", "not a design.json: schema_version, status, objective, profile, job, provenance missing"),
        ("{}", "not a design.json: schema_version"),
        (damaged(paper, schema_version=2), "schema_version 2 is not read; this camwright reads 1"),
        (damaged(paper, job=3), "job.toml, the text of the job file, is missing"),
        (damaged(paper, job={**job, "toml": job["toml"] + "#"}), "the stored job is not the one that was designed"),
        (damaged(paper, provenance=[]), "the stored job is not the one that was designed"),
        (damaged(paper, profile={"breaks": [0]}), "d.json: a profile is an object with the keys"),
        (damaged(paper, profile={"breaks": [0, "a"], "coefficients": [[1]]}), "must be lists of numbers"),
        (damaged(paper, profile={"breaks": [0, 1], "coefficients": [[float("nan")]]}), "must be finite numbers"),
    ]
    for text, message in cases:
        with pytest.raises(InputError) as caught:
            parse_design(text, "d.json")
        assert message in str(caught.value)


def test_rows_too_few_for_the_sync_zone_are_told_with_how_many_would_do(tmp_path: Path) -> None:
    """A blade in horizontal sync is no quintic over wide steps; what is told passes, and one step less does not."""
    job = load_job(EXAMPLES / "thick-product.toml")
    cam = baseline("poly_3_4_5", job.task)
    assert rows_note(cam, job) == ""

    def with_rows(rows: int) -> Job:
        return replace(job, output=replace(job.output, points=rows))

    note = rows_note(cam, with_rows(40))
    assert note == (
        "cam.csv: 40 rows hold the ratio in the sync zone to 9.9e-08, of which validate allows 1e-09; write [output] points = 157"
    )
    assert rows_note(cam, with_rows(157)) == ""
    for rows, passes in ((40, False), (157, True)):
        (tmp_path / "cam.csv").write_text(write_cam_csv(cam, rows, []))
        checks = {check.name: check.passed for check in validate(tmp_path / "cam.csv", job).checks}
        assert checks["sync_ratio"] == passes
