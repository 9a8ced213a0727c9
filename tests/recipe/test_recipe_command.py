"""The commands ``camwright recipe`` and ``camwright verify``: files, exit codes, messages."""

from __future__ import annotations

import hashlib
import html
import json
import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import openpyxl
import pypdf
import pytest

from camwright.book.plan import plan_book
from camwright.cli.main import main
from camwright.jobs.job import load_job, parse_job
from camwright.profiles.errors import InputError
from camwright.profiles.tables.targets import TARGETS
from camwright.recipes.compare import compare_recipes, position_difference, read_recipe
from camwright.recipes.verify import examine

Say = Callable[..., tuple[int, str, str]]


@pytest.fixture
def say(capsys: pytest.CaptureFixture[str]) -> Say:
    def run(*arguments: object) -> tuple[int, str, str]:
        code = main([str(argument) for argument in arguments])
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    return run


def contents(folder: Path) -> dict[str, bytes]:
    return {file.relative_to(folder).as_posix(): file.read_bytes() for file in folder.rglob("*") if file.is_file()}


def test_the_folder_holds_what_the_answer_lists(say: Say, paper_job: Path, tmp_path: Path) -> None:
    out = tmp_path / "a" / "b"
    code, said, _ = say("recipe", paper_job, "--targets", "codesys,logix,csv", "--out", out, "--json")
    assert code == 0
    listed = {entry["path"]: entry["sha256"] for entry in json.loads(said)["files"]}
    found = contents(out)
    assert listed == {path: hashlib.sha256(data).hexdigest() for path, data in found.items()}
    assert set(found) >= {"recipe.json", "recipe.pdf", "recipe.html", "recipe.xlsx", "manifest.json"}
    assert sum(path.startswith("tables/") for path in found) == 4
    assert not list(tmp_path.rglob(".camwright-*"))
    code, said, _ = say("verify", out, "--json")
    answer = json.loads(said)
    assert (code, answer["ok"], answer["faults"], answer["notes"]) == (0, True, [], [])
    assert len(answer["proved"]) == 6
    assert sum(path.startswith("ramps/") for path in found) >= 3 * 3


@pytest.mark.slow
def test_a_recipe_with_everything_takes_less_than_6_s_of_processor_time(paper_job: Path, tmp_path: Path) -> None:
    began = resource.getrusage(resource.RUSAGE_CHILDREN)
    command = [
        sys.executable,
        "-c",
        "import sys; from camwright.cli.main import main; sys.exit(main())",
        "recipe",
        str(paper_job),
    ]
    subprocess.run([*command, "--targets", "codesys,logix,csv", "--out", str(tmp_path / "out")], check=True)
    ended = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert ended.ru_utime + ended.ru_stime - began.ru_utime - began.ru_stime < 6.0
    assert (tmp_path / "out" / "recipe.pdf").stat().st_size < 1_000_000
    assert (tmp_path / "out" / "recipe.html").stat().st_size < 2_000_000


def test_a_job_its_design_and_a_second_run_give_the_same_bytes(say: Say, paper_job: Path, tmp_path: Path) -> None:
    assert say("design", paper_job, "--no-figures", "--out", tmp_path / "design", "--quiet")[0] == 0
    for source, out in (
        (paper_job, "one"),
        (paper_job, "two"),
        (tmp_path / "design" / "design.json", "three"),
    ):
        assert say("recipe", source, "--targets", "csv", "--out", tmp_path / out, "--language", "zh", "--quiet")[0] == 0
    assert contents(tmp_path / "one") == contents(tmp_path / "two") == contents(tmp_path / "three")


def test_all_files_of_an_older_recipe_are_replaced(say: Say, paper_job: Path, tmp_path: Path) -> None:
    out = tmp_path / "recipe"
    say("recipe", paper_job, "--targets", "codesys,logix", "--out", out)
    code, _, _ = say("recipe", paper_job, "--targets", "csv", "--out", out, "--note", "second")
    assert code == 0
    assert [path for path in contents(out) if path.startswith("tables/")] == ["tables/paper_600_cam.csv"]
    assert examine(out).faults == ()


def test_notes_and_photos_stay_and_changed_files_are_kept(
    say: Say, paper_job: Path, folder: Path, tmp_path: Path
) -> None:
    notes = {"notes.txt": b"bearing warm", "photos/one.jpg": b"\xff\xd8", "tables/read me.txt": b"mine"}
    (folder / "photos").mkdir()
    for name, data in notes.items():
        (folder / name).write_bytes(data)
    (folder / "link").symlink_to("/nowhere")
    (folder / "recipe.html").write_bytes(b"filled in by hand")
    assert say("recipe", paper_job, "--targets", "csv", "--out", tmp_path / "fresh", "--quiet")[0] == 0
    code, _, complaint = say("recipe", paper_job, "--targets", "csv", "--out", folder)
    assert code == 0
    assert "recipe.html: changed since camwright wrote it; kept as recipe.changed.html" in complaint
    assert contents(folder) == {**contents(tmp_path / "fresh"), **notes, "recipe.changed.html": b"filled in by hand"}
    assert (folder / "link").readlink() == Path("/nowhere")


def test_what_is_in_the_way_of_a_new_file_is_not_overwritten(say: Say, paper_job: Path, folder: Path) -> None:
    (folder / "tables" / "paper_600_trio.bas").write_bytes(b"mine")
    before = contents(folder)
    code, _, complaint = say("recipe", paper_job, "--targets", "trio", "--out", folder)
    assert code == 2
    assert "paper_600_trio.bas: not written by camwright, and in the way; nothing was changed" in complaint
    (folder / "manifest.json").write_bytes(before["manifest.json"][:-3])
    assert say("recipe", paper_job, "--targets", "csv", "--out", folder)[0] == 2
    assert contents(folder) == {**before, "manifest.json": before["manifest.json"][:-3]}


def test_recipes_of_two_jobs_of_one_name(
    say: Say, paper_job: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    text = paper_job.read_text(encoding="utf-8")
    Path("a.toml").write_text(text)
    Path("b.toml").write_text(text + "# another\n")
    assert say("recipe", "a.toml", "--quiet")[0] == 0
    code, _, complaint = say("recipe", "b.toml", "--quiet")
    assert code == 2
    assert "holds the recipe of a.toml, which is called 'paper-600' too" in complaint
    Path("a.toml").unlink()
    code, _, complaint = say("recipe", "b.toml", "--quiet")
    assert code == 0
    assert "the recipe of another job, or of an earlier state of it" in complaint


def test_anything_else_is_left_alone(say: Say, paper_job: Path, tmp_path: Path) -> None:
    out = tmp_path / "mine"
    out.mkdir()
    (out / "letter.txt").write_text("dear")
    (tmp_path / "file").write_text("x")
    for place, why in (
        (out, "something else is there, which is not overwritten"),
        (tmp_path / "file", "a file is in the way"),
    ):
        code, _, complaint = say("recipe", paper_job, "--targets", "csv", "--out", place)
        assert code == 2
        assert f"{why}; choose another --out" in complaint
    assert contents(tmp_path) == {"mine/letter.txt": b"dear", "file": b"x"}
    code, _, complaint = say("recipe", paper_job, "--targets", "csv", "--out", tmp_path / "file" / "below")
    assert code == 2
    assert "a file is in the way; choose another --out" in complaint


def test_a_failure_while_writing_leaves_the_old_recipe(
    say: Say, paper_job: Path, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = contents(folder)

    def full(_: Path) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("camwright.house.files.flush", full)
    code, _, complaint = say("recipe", paper_job, "--targets", "csv", "--out", folder)
    assert code == 2
    assert "No space left on device; what was there is unchanged" in complaint
    assert contents(folder) == before
    assert not list(folder.parent.glob(".camwright-*"))


def test_an_empty_directory_is_taken(say: Say, paper_job: Path, tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    assert say("recipe", paper_job, "--targets", "csv", "--out", tmp_path / "empty", "--quiet")[0] == 0
    assert examine(tmp_path / "empty").faults == ()


def test_all_targets(say: Say, paper_job: Path, tmp_path: Path) -> None:
    out = tmp_path / "all"
    code, _, _ = say("recipe", paper_job, "--targets", "all", "--out", out, "--language", "de")
    recipe = read_recipe(out)
    assert {table.target for table in recipe.tables} | {each.target for each in recipe.refused} == set(TARGETS)
    assert code == (0 if recipe.released else 1)
    assert examine(out).faults == ()


def test_a_failed_check_is_not_released_and_ends_with_1(
    say: Say, job_with: Callable[..., Path], tmp_path: Path
) -> None:
    out = tmp_path / "failed"
    job = job_with(sync_tolerance='"0.001 mm"')
    code, said, _ = say("recipe", job, "--targets", "csv", "--out", out)
    assert code == 1
    assert "NOT RELEASED: settling – (limit 200 mm); shear_zone_error 0.020273 mm (limit 0.001 mm);" in said
    assert f"camwright design {job} says what makes it pass" in " ".join(said.split())
    _, answer, _ = say("recipe", job, "--targets", "csv", "--out", out, "--json")
    failed = {check.name for check in read_recipe(out).checks if not check.passed}
    assert json.loads(answer)["released"] is False
    assert failed <= set(json.loads(answer)["failed_checks"])
    recipe = read_recipe(out)
    assert not recipe.released
    assert [table.files for table in recipe.tables] == [()]
    assert "NOT RELEASED: a check failed. Do not run this cam." in (out / "recipe.html").read_text(encoding="utf-8")
    assert examine(out).faults == ()


def test_an_infeasible_job_ends_with_3(say: Say, job_with: Callable[..., Path], tmp_path: Path) -> None:
    code, said, _ = say("recipe", job_with(length='"300 mm"'), "--targets", "csv", "--out", tmp_path / "none", "--json")
    assert code == 3
    assert json.loads(said)["binding"] == "jerk"
    assert not (tmp_path / "none").exists()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ([], "no job or design is named; write e.g. camwright recipe JOB"),
        (["JOB", "--customer", "c" * 101], "--customer has 101 characters; it may have 100"),
        (["JOB", "--targets", "cvs", "--out", "x"], "there is no target 'cvs'"),
        (["JOB", "--targets", " , ", "--out", "x"], "--targets names no target"),
        (["none.toml", "--targets", "csv", "--out", "x"], "there is no such job or design file"),
        (["JOB", "--compare", "a", "b"], "--compare takes two recipe folders and nothing else"),
        (["--compare", "a", "b"], "a: there is no such directory"),
        (["--compare", ".", "."], "not a recipe: there is no recipe.json"),
        (
            ["JOB", "--targets", "csv", "--out", "x", "--note", "n" * 2001],
            "--note has 2001 characters; it may have 2000",
        ),
        (["JOB", "--targets", "csv", "--out", "x", "--language", "fr"], "fr"),
        (["JOB", "--targets", "csv", "--out", "a\0b"], "embedded null"),  # byte or character, by the version of Python
    ],
)
def test_faults_end_with_2(
    say: Say, paper_job: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], said: str
) -> None:
    monkeypatch.chdir(tmp_path)
    code, _, complaint = say("recipe", *(paper_job if each == "JOB" else each for each in arguments))
    assert code == 2
    assert said in complaint
    assert list(tmp_path.iterdir()) == []


def test_verify_tells_the_file_and_ends_with_1(say: Say, folder: Path) -> None:
    with (folder / "recipe.html").open("ab") as file:
        file.write(b"\n")
    code, said, _ = say("verify", folder)
    assert code == 1
    assert "recipe.html" in said
    code, said, _ = say("verify", folder, "--json")
    answer = json.loads(said)
    assert (code, answer["ok"], [fault["file"] for fault in answer["faults"]]) == (1, False, ["recipe.html"])
    assert "SHA-256 is" in answer["faults"][0]["what"]


def test_verify_of_no_recipe_ends_with_2(say: Say, tmp_path: Path) -> None:
    assert say("verify", tmp_path)[0] == 2
    assert say("verify", tmp_path / "none")[0] == 2


def test_compare_tells_what_changes(say: Say, folder: Path, job_with: Callable[..., Path], tmp_path: Path) -> None:
    other = tmp_path / "other"
    job = job_with(line_speed='"70 m/min"', jerk='"2000 m/s^3"')
    assert say("recipe", job, "--targets", "csv,trio", "--out", other, "--quiet")[0] == 0
    code, said, _ = say("recipe", "--compare", folder, other, "--json")
    assert code == 0
    answer = json.loads(said)
    assert answer["same"] is False
    changes = {(change["group"], change["name"]): change for change in answer["changes"]}
    assert changes["product", "line_speed"] | {"group": "", "name": ""} == {
        "group": "", "name": "", "unit": "m/min", "before": pytest.approx(80.0), "after": pytest.approx(70.0),
    }  # fmt: skip
    assert (changes["limits", "jerk"]["before"], changes["limits", "jerk"]["after"]) == (3000.0, 2000.0)
    assert ("limits", "acceleration") not in changes
    assert changes["reached", "acceleration"]["after"] < changes["reached", "acceleration"]["before"]
    assert changes["tables", "trio: files"]["before"] is None
    assert changes["tables", "codesys: files"]["after"] is None
    assert ("tables", "csv: files") in changes
    off = changes["cam", "largest position difference over the master"]
    assert off["unit"] == "mm"
    assert off["after"] == pytest.approx(1e3 * position_difference(read_recipe(folder), read_recipe(other))[0])
    assert 0.0 < off["after"] < 5.0
    code, said, _ = say("recipe", "--compare", folder, other)
    assert code == 0
    assert "What changes on the machine" in said


def test_compare_of_a_recipe_with_itself_finds_nothing(say: Say, folder: Path) -> None:
    code, said, _ = say("recipe", "--compare", folder, folder, "--json")
    assert (code, json.loads(said)["changes"], json.loads(said)["same"]) == (0, [], True)
    assert "nothing changes" in say("recipe", "--compare", folder, folder)[1]


def test_recipes_of_different_machines_can_be_compared(made, saw) -> None:
    changes = {(change.group, change.name): change for change in compare_recipes(made.recipe, saw.recipe)}
    assert changes["machine", "kind"].after == "linear_carriage"
    assert changes["machine", "stroke"].before is None
    assert changes["machine", "circumference"].after is None


NAMES = ["=cmd+A1", "#panic() $x$ @a {{7}} {% % } & ' ; (x)", "飞剪 切刀", "مقص", "🦊 e\u0301 ﬁ"]


@pytest.mark.parametrize("name", NAMES)
def test_any_allowed_name_makes_a_sound_recipe(
    say: Say, job_with: Callable[..., Path], tmp_path: Path, name: str
) -> None:
    out = tmp_path / "out"
    job = job_with(name=json.dumps(name, ensure_ascii=False))
    code, _, complaint = say(
        "recipe", job, "--targets", "codesys,twincat,logix", "--out", out, "--note", f"{name}\n*) (* //"
    )
    assert code == 0, complaint
    assert examine(out).faults == ()
    assert read_recipe(out).name == name
    for path in contents(out):
        assert path.isascii()
        assert not set(path) & set(' *?<>|:"\\')


GIVEN = {"revision": "B-7", "customer": "Müller & Söhne <Wien>", "author": "=A1+B2", "date": "28th of November"}


@pytest.mark.parametrize(("language", "named"), [("en", "Revision"), ("de", "Kunde"), ("zh", "客户")])
def test_what_the_user_gives_stands_in_every_file(
    say: Say, paper_job: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, language: str, named: str
) -> None:
    monkeypatch.chdir(tmp_path)
    options = [part for name, text in GIVEN.items() for part in (f"--{name}", text)]
    assert say("recipe", paper_job, "--language", language, *options)[0] == 0
    folder = tmp_path / "out" / "paper-600-recipe"
    assert {each.name for each in (folder / "tables").iterdir()} == {"paper_600_cam.csv"}
    pdf = "".join(page.extract_text() for page in pypdf.PdfReader(folder / "recipe.pdf").pages)
    page = html.unescape((folder / "recipe.html").read_text(encoding="utf-8"))
    sheet = openpyxl.load_workbook(folder / "recipe.xlsx").worksheets[0]
    cells = [str(cell.value) for row in sheet.iter_rows() for cell in row]
    stored = json.loads((folder / "recipe.json").read_text(encoding="utf-8"))
    assert stored["particulars"] == GIVEN
    for text in (named, *GIVEN.values()):
        assert text.replace(" ", "") in pdf.replace(" ", "").replace("\n", "")
        assert text in page
        assert text in cells
    assert examine(folder).faults == ()


def test_without_particulars_the_file_is_as_before_they_were_known(folder: Path) -> None:
    assert "particulars" not in json.loads((folder / "recipe.json").read_text(encoding="utf-8"))


def test_the_targets_of_the_job_are_taken_by_recipe_export_and_book(
    say: Say, paper_job: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    job = tmp_path / "job.toml"
    text = paper_job.read_text(encoding="utf-8")
    assert "[output]" in text
    job.write_text(text.replace("[output]", '[output]\ntargets = ["CSV", "Trio"]', 1), encoding="utf-8")
    assert load_job(job).output.targets == ("csv", "trio")
    assert say("design", job, "--no-figures")[0] == 0
    assert say("export", "out/paper-600/design.json")[0] == 0
    written = {each.name for each in Path("out/paper-600/tables").iterdir()}
    assert {"paper_600_cam.csv", "paper_600_trio.bas"} <= written
    assert plan_book(load_job(job), "600mm:600mm:1mm", "80:80:1").targets == ("csv", "trio")
    assert say("recipe", "out/paper-600/design.json", "--out", "recipe")[0] == 0
    assert [table.target for table in read_recipe(Path("recipe")).tables] == ["csv", "trio"]


@pytest.mark.parametrize(
    ("written", "told"),
    [
        ('["cvs"]', r"\[output\] targets = \['cvs'\]: there is no target 'cvs'"),
        (
            "[]",
            r'\[output\] targets = \[\]: not a list of targets; write e.g. targets = \["csv", "codesys"\], or "all"',
        ),
        ('"csv"', r"\[output\] targets = 'csv': not a list of targets"),
    ],
)
def test_targets_of_a_job_that_do_not_exist_are_told(paper_job: Path, written: str, told: str) -> None:
    text = paper_job.read_text(encoding="utf-8").replace("[output]", f"[output]\ntargets = {written}", 1)
    with pytest.raises(InputError, match=told):
        parse_job(text, "job.toml")
