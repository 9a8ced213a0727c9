"""The command line: what it prints, what it writes, how it ends."""

from __future__ import annotations

import gc
import io
import json
import math
import os
import re
import resource
import subprocess
import sys
import tomllib
from importlib import import_module
from importlib.metadata import version
from pathlib import Path
from typing import Any

import pytest

from camwright.cli.commands import COMMANDS
from camwright.cli.main import main
from camwright.house.owned import LIST
from camwright.jobs.job import BUNDLED_JOB
from camwright.profiles.errors import InfeasibleError, SolverError
from camwright.profiles.returns import BASELINES
from camwright.studies.cut_lengths import cut_lengths

JOB = str(BUNDLED_JOB)
PAPER = BUNDLED_JOB.read_text(encoding="utf-8")
COMMAND = [sys.executable, "-c", "import sys; from camwright.cli.main import main; sys.exit(main())"]

MEASURES = {
    "peak_speed_m_per_s", "min_speed_m_per_s", "peak_acceleration_m_per_s2", "rms_acceleration_m_per_s2",
    "peak_jerk_m_per_s3", "rms_jerk_m_per_s3", "sync_ratio_error", "motor", "servo",
}  # fmt: skip
COMPARED = MEASURES | {"within_limits", "worst_shear_zone_error_mm"}
SERVO = {"crossing_mm", "settling_mm", "overshoot_mm", "peak_following_error_mm", "shear_zone_error_mm"}
MOTOR = {
    "peak_torque_N_m", "rms_torque_N_m", "peak_speed_rad_per_s", "min_velocity_rad_per_s", "energy_J", "regenerated_J"
}  # fmt: skip
LENGTHS = {"eq9", "eq10", "physical", "linear_return_to_tolerance", "optimised_to_tolerance"}


def strict(text: str) -> dict[str, Any]:
    """Read exactly one JSON object; NaN and infinity are refused."""

    def refuse(constant: str) -> None:
        raise AssertionError(constant)

    answer = json.loads(text, parse_constant=refuse)
    assert isinstance(answer, dict)
    return answer


@pytest.fixture(scope="module")
def designed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    """Run the paper's job once, as a user does."""
    place = tmp_path_factory.mktemp("designed") / "cam"
    run = subprocess.run(
        [*COMMAND, "design", "--out", str(place), "--no-figures", "--json"], capture_output=True, text=True, check=False
    )
    assert (run.returncode, run.stderr) == (0, "")
    return place, strict(run.stdout)


@pytest.mark.parametrize("collects", [True, False])
def test_garbage_is_collected_after_a_command_is_imported_as_before(
    monkeypatch: pytest.MonkeyPatch, collects: bool
) -> None:
    seen: list[bool] = []

    def imported(name: str) -> Any:
        seen.append(gc.isenabled())
        return import_module(name)

    monkeypatch.setattr("camwright.cli.main.import_module", imported)
    before = gc.isenabled()
    try:
        gc.enable() if collects else gc.disable()
        assert main(["targets", "--json"]) == 0
        assert (seen, gc.isenabled()) == ([False], collects)
    finally:
        gc.enable() if before else gc.disable()


def test_design_prints_the_promised_object(designed: tuple[Path, dict[str, Any]]) -> None:
    place, answer = designed
    assert answer.keys() == {
        "job", "status", "objective", "lower_bound_method", "starts", "pieces", "profiles", "checks", "passed",
        "minimum_cut_length_mm", "tangential_mismatch", "files",
        "servo_aware", "robust", "lead_time_ms", "length_error_mm", "length_error_with_lead_mm", "length_variation_mm",
        "speed_band", "speed_band_binds", "remedies", "family_bands_m_per_s",
    }  # fmt: skip
    assert answer["speed_band"] == [[0.0, pytest.approx(80 / 60)]]
    assert answer["speed_band_binds"] == ["none", "jerk"]
    assert answer["remedies"] == []
    assert (answer["job"], answer["status"], answer["passed"]) == ("paper-600", "optimal", True)
    objective = answer["objective"]
    assert objective.keys() == {"name", "value", "unit", "lower_bound", "gap"}
    assert (objective["name"], objective["unit"]) == ("peak_acceleration", "m/s^2")
    assert 0 <= objective["gap"] < 1e-6
    assert answer["lower_bound_method"].startswith("closed form")
    assert answer["starts"] is None
    assert answer["profiles"].keys() == {"optimised", *BASELINES}
    for measures in answer["profiles"].values():
        assert measures.keys() == COMPARED
        assert measures["servo"].keys() == SERVO
        assert measures["motor"].keys() == MOTOR
        assert measures["motor"]["rms_torque_N_m"] is None
        assert measures["motor"]["peak_speed_rad_per_s"] == pytest.approx(
            measures["peak_speed_m_per_s"] * 2 * math.pi / 0.4, rel=1e-12
        )
    assert answer["profiles"]["linear_return"]["peak_acceleration_m_per_s2"] is None
    assert answer["profiles"]["optimised"]["peak_acceleration_m_per_s2"] == pytest.approx(objective["value"], rel=1e-9)
    for check in answer["checks"]:
        assert check.keys() == {"name", "passed", "value", "limit", "unit", "at", "source"}
    assert answer["minimum_cut_length_mm"].keys() == LENGTHS
    assert answer["minimum_cut_length_mm"]["eq9"] == pytest.approx(208, abs=2)
    assert answer["files"] == [str(place / "cam.csv"), str(place / "design.json")]


def test_a_brief_design_is_the_same_cam_with_the_same_proof(
    designed: tuple[Path, dict[str, Any]], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    place, answer = designed
    assert main(["design", "--brief", "--out", str(tmp_path / "cam"), "--json"]) == 0
    brief = strict(capsys.readouterr().out)
    assert answer.keys() - brief.keys() == {
        "profiles", "remedies", "family_bands_m_per_s", "minimum_cut_length_mm",
        "lead_time_ms", "length_error_mm", "length_error_with_lead_mm", "length_variation_mm",
    }  # fmt: skip
    assert {key: answer[key] for key in brief if key != "files"} == {k: v for k, v in brief.items() if k != "files"}
    for name in ("cam.csv", "design.json", LIST):
        assert (tmp_path / "cam" / name).read_bytes() == (place / name).read_bytes()
    assert main(["design", "--brief", "--out", str(tmp_path / "cam")]) == 0
    shown = capsys.readouterr().out
    assert "settling" in shown
    assert "linear_return" not in shown
    assert shown.splitlines()[-1].startswith("paper-600: passed every check")


def test_design_writes_its_files_and_nothing_else(designed: tuple[Path, dict[str, Any]]) -> None:
    assert sorted(entry.name for entry in designed[0].iterdir()) == [LIST, "cam.csv", "design.json"]


@pytest.mark.parametrize("name", ["cam.csv", "design.json"])
def test_validate_passes_what_design_wrote(
    designed: tuple[Path, dict[str, Any]], name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["validate", str(designed[0] / name), "--job", JOB, "--json"]) == 0
    answer = strict(capsys.readouterr().out)
    assert answer["passed"] is True
    assert answer["profile"].keys() == MEASURES
    assert {check["name"] for check in answer["checks"]} == {check["name"] for check in designed[1]["checks"]}


def test_validate_ends_with_1_when_a_check_fails(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rows = "\n".join(f"{i},{i * 400 / 600}" for i in range(0, 601, 10))  # constant ratio: never in sync
    (tmp_path / "cam.csv").write_text(f"x [mm],y [mm]\n{rows}\n")
    assert main(["validate", str(tmp_path / "cam.csv"), "--job", JOB]) == 1
    shown = capsys.readouterr().out
    assert "FAILED" in shown
    assert re.search(r"checks? failed: .*sync_ratio", shown)


def test_the_files_go_to_out_and_the_jobs_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["design", "--no-figures", "--quiet"]) == 0
    assert sorted(str(file) for file in Path("out").rglob("*.*")) == [
        f"out/paper-600/{LIST}", "out/paper-600/cam.csv", "out/paper-600/design.json"
    ]  # fmt: skip


def test_design_shows_tables(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["design", JOB, "--out", str(tmp_path), "--no-figures"]) == 0
    shown = capsys.readouterr()
    for words in ("paper-600: optimal", "linear_return", "unbounded", "Checks", "Minimum cut length", "design.json"):
        assert words in shown.out
    assert shown.err == ""


def test_quiet_says_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for arguments in (["design", "--no-figures", "--out", str(tmp_path)], ["limits", JOB], ["check", JOB]):
        assert main([*arguments, "--quiet"]) == 0
    assert capsys.readouterr() == ("", "")


@pytest.fixture
def figures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Stand in for the drawing of figures, which is slow and tested elsewhere."""

    def draw(_what: object, directory: Path) -> list[Path]:
        (directory / "figure.svg").write_text("<svg/>")
        return [directory / "figure.svg"]

    monkeypatch.setattr("camwright.cli.design.design_figures", lambda _: {"figure": None})
    monkeypatch.setattr("camwright.cli.destination.write_pictures", draw)


def test_figures_are_written_with_the_other_files(
    figures: None, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["design", "--json", "--out", str(tmp_path)]) == 0
    names = ["cam.csv", "design.json", "figure.svg"]
    assert strict(capsys.readouterr().out)["files"] == [str(tmp_path / name) for name in names]
    assert sorted(entry.name for entry in tmp_path.iterdir()) == [LIST, *names]


def test_a_figure_that_fails_leaves_nothing(
    figures: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fail(_what: object, _directory: Path) -> list[Path]:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("camwright.cli.destination.write_pictures", fail)
    assert main(["design", "--out", str(tmp_path / "new" / "cam")]) == 2
    assert "No space left on device" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_compare_sorts_by_the_objective_and_puts_what_breaks_a_limit_last(
    figures: None, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["compare", JOB, "--json", "--out", str(tmp_path)]) == 0
    answer = strict(capsys.readouterr().out)
    assert answer["sorted_by"] == "peak_acceleration"
    profiles = list(answer["profiles"].values())
    for kept in (True, False):
        peaks = [each["peak_acceleration_m_per_s2"] for each in profiles if each["within_limits"] is kept]
        bounded = [peak for peak in peaks if peak is not None]
        assert peaks == [*sorted(bounded), *[None] * (len(peaks) - len(bounded))]
    assert [each["within_limits"] for each in profiles] == sorted(
        (each["within_limits"] for each in profiles), reverse=True
    )
    assert len(profiles) == len(BASELINES) + 1
    assert answer["files"] == [str(tmp_path / "figure.svg")]


def test_compare_with_some_laws(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = [
        "compare",
        JOB,
        "--no-figures",
        "--json",
        "--with",
        "cycloid",
        "--with",
        "linear_return",
        "--with",
        "cycloid",
    ]
    assert main(arguments) == 0
    assert list(strict(capsys.readouterr().out)["profiles"]) == ["optimised", "cycloid", "linear_return"]
    assert main(["compare", JOB, "--with", "cubc", "--with", "quux", "--no-figures"]) == 2
    errors = capsys.readouterr().err
    assert "--with 'cubc': there is no such law; did you mean cubic?" in errors
    assert "--with 'quux': there is no such law; the laws are linear_return, " in errors


def test_limits(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["limits", JOB, "--json"]) == 0
    answer = strict(capsys.readouterr().out)
    assert answer["minimum_cut_length_mm"].keys() == LENGTHS
    assert answer["binding"] == {"line_speed": "acceleration", "cut_length": "acceleration"}
    assert answer["max_line_speed_m_per_min"] > 80
    assert answer["min_cut_length_mm"] < 400
    assert answer["physical_bound_binding"] in {"speed", "acceleration", "jerk"}
    assert answer["transition_length_mm"]["crossing"] == pytest.approx(81.5, abs=1.5)
    assert main(["limits", JOB]) == 0
    shown = capsys.readouterr().out
    assert "physical bound" in shown
    assert "highest line speed at a cut length of 600 mm" in shown


def test_limits_where_the_servo_does_not_settle_has_nulls(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    job = tmp_path / "job.toml"
    short = PAPER.replace('sync_zone = "200 mm"', 'sync_zone = "50 mm"')
    job.write_text(short)
    assert main(["limits", str(job), "--json"]) == 0
    answer = strict(capsys.readouterr().out)
    assert answer["minimum_cut_length_mm"]["eq9"] is None
    assert main(["limits", str(job)]) == 0


def test_check(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", JOB, "--json"]) == 0
    assert strict(capsys.readouterr().out)["si"]["cut"]["length"] == 0.6
    assert main(["check", JOB]) == 0
    assert "The job file has no faults." in capsys.readouterr().out


def test_version_and_help(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"camwright {version('camwright')}\n"
    assert main(["--help"]) == 0
    shown = capsys.readouterr().out
    for command in (
        "design", "compare", "limits", "validate", "check", "quick", "export", "audit", "targets", "bend"
    ):  # fmt: skip
        assert command in shown


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["check"], "Missing argument 'JOB'"),
        (["nonsense"], "No such command 'nonsense'"),
        (["check", JOB, "--nonsense"], "No such option"),
        (["validate", JOB], "Missing option '--job'"),
        (["check", "none.toml"], "none.toml: there is no such job file"),
        (["check", "."], ".: a directory, not a job file; name a file in it"),
        (["check", "a\0b"], "embedded null"),
        (["design", "none.toml"], "none.toml: there is no such job file"),
        (["validate", "none.csv", "--job", JOB], "none.csv: there is no such profile file"),
        (["design", JOB, "--out", ""], "--out: the name is empty; name where to write to, or leave --out out"),
        (["export", JOB, "--out="], "--out: the name is empty"),
        (["validate", ".", "--job", JOB], ".: a directory, not a profile file"),
        (["validate", JOB, "--job", JOB], "there is no table of two columns in it"),
    ],
)
@pytest.mark.parametrize("as_json", [False, True])
def test_bad_input_ends_with_2_and_one_message(
    arguments: list[str], message: str, as_json: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([*arguments, *(["--json"] if as_json else [])]) == 2
    shown = capsys.readouterr()
    assert message in shown.err
    assert all(line.startswith("camwright: ") for line in shown.err.splitlines())
    if as_json:
        answer = strict(shown.out)
        assert (answer["status"], answer["exit_code"]) == ("error", 2)
        assert message in answer["message"]
    else:
        assert shown.out == ""


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('name = "paper-600"', "", "name: missing"),
        ("sync_zone =", "sync_zon =", "[cut] sync_zon: there is no such key; did you mean sync_zone?"),
        ("[servo]", "[serv]", "serv: there is no such key; did you mean servo?"),
        ('"200 m/min"', "200", '[limits] speed = 200: a number without a unit; write e.g. "200 m/min"'),
        ('"200 m/min"', '"200 m"', "[limits] speed = '200 m': a length, but a speed is expected"),
        ('"600 mm"', '"nan mm"', "[cut] length = 'nan mm': not a length"),
        ('"600 mm"', "inf", "[cut] length = inf: a number without a unit"),
        ('"600 mm"', '"-600 mm"', "[cut] length = '-600 mm': negative"),
        ('"600 mm"', '"0 mm"', "[cut] length = '0 mm': zero"),
        ('"600 mm"', '"200 mm"', "[cut] sync_zone = 200 mm: not below [cut] length = 200 mm"),
        ('"400 mm"', '"200 mm"', "[cut] sync_zone = 200 mm: not below [machine] circumference = 200 mm"),
        ('"40 mm"', '"240 mm"', "[cut] shear_zone = 240 mm: above [cut] sync_zone = 200 mm"),
        ("damping = 0.7", "damping = 0", "[servo] damping = 0: the damping ratio must be above 0"),
        ("damping = 0.7", "damping = -1", "[servo] damping = -1: the damping ratio must be above 0"),
        ('"4 ms"', '"500 ms"', "[servo] sample_time = 500 ms: longer than the cycle of 450 ms"),
        ('"200 m/min"', '"79 m/min"', "[limits] speed = 79 m/min: below [cut] line_speed = 80 m/min"),
        ("[machine]", "[machine", "not TOML: "),
        ("points = 361", "points = 3", "[output] points = 3: too few to hold the 7 ends of the profile's pieces"),
    ],
)  # fmt: skip
def test_a_bad_job_ends_with_2_and_leaves_nothing(
    old: str, new: str, message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert old in PAPER
    job = tmp_path / "job.toml"
    job.write_text(PAPER.replace(old, new, 1))
    assert main(["design", str(job), "--no-figures", "--json", "--out", str(tmp_path / "out" / "x")]) == 2
    shown = capsys.readouterr()
    assert message in shown.err
    assert message in strict(shown.out)["message"]
    assert [entry.name for entry in tmp_path.iterdir()] == ["job.toml"]


def test_all_faults_are_told_one_a_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    job = tmp_path / "job.toml"
    job.write_text(PAPER.replace('"600 mm"', "600").replace("damping = 0.7", "damping = 0").replace("points", "poins"))
    assert main(["check", str(job)]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 3
    assert all(line.startswith(f"camwright: {job}: [") for line in lines)


def test_a_file_in_the_way_of_the_output_is_refused_and_kept(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("kept")
    for place in ("file", "file/below"):
        assert main(["design", "--no-figures", "--out", str(tmp_path / place)]) == 2
        assert "the output directory cannot be made" in capsys.readouterr().err
    assert [entry.name for entry in tmp_path.iterdir()] == ["file"]


def test_an_output_that_may_not_be_written_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    if not Path("/proc/self").is_dir():
        pytest.skip("needs a file system that nobody may write to")
    assert main(["design", "--no-figures", "--out", "/proc/camwright"]) == 2
    assert re.search(
        r"/proc/camwright: the output directory cannot be made: .+; choose another --out", capsys.readouterr().err
    )


def test_a_full_disk_ends_with_2_and_leaves_nothing(tmp_path: Path) -> None:
    """The kernel refuses to let a file grow beyond 4 kB, as a full disk does; cam.csv needs more."""
    run = subprocess.run(
        [*COMMAND, "design", "--no-figures", "--out", str(tmp_path / "out" / "cam")],
        capture_output=True,
        text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096)),
        check=False,
    )
    assert run.returncode == 2
    assert "the files cannot be written: File too large; what was there is as it was" in run.stderr
    assert "Traceback" not in run.stderr
    assert list(tmp_path.iterdir()) == []


def test_a_job_that_physics_forbids_ends_with_3(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    job = tmp_path / "job.toml"
    job.write_text(PAPER.replace('"30 m/s^2"', '"3 m/s^2"'))
    assert main(["design", str(job), "--no-figures", "--json", "--out", str(tmp_path / "out")]) == 3
    shown = capsys.readouterr()
    answer = strict(shown.out)
    assert (answer["status"], answer["exit_code"]) == ("infeasible", 3)
    assert answer.keys() == {
        "status",
        "exit_code",
        "message",
        "binding",
        "excess",
        "suggestions",
        "line_speeds_kept_m_per_s",
        "family_bands_m_per_s",
    }
    assert answer["binding"] == "acceleration"
    assert answer["excess"].keys() == {"value", "unit"}
    assert answer["excess"]["unit"] == "m/s^2"
    assert answer["excess"]["value"] > 0
    assert all(suggestion.keys() == {"change", "value", "unit"} for suggestion in answer["suggestions"])
    assert {suggestion["change"] for suggestion in answer["suggestions"]} >= {"line_speed", "length"}
    assert answer["message"].splitlines()[0] in shown.err
    assert [entry.name for entry in tmp_path.iterdir()] == ["job.toml"]


@pytest.mark.parametrize(
    ("failure", "status", "exit_code"),
    [
        (InfeasibleError("no room", "jerk", 1.0, "m/s^3", ()), "infeasible", 3),
        (SolverError("lost its way"), "error", 4),
        (KeyboardInterrupt(), None, 130),
    ],
)
def test_a_failure_of_the_solver_has_its_exit_code(
    failure: BaseException,
    status: str | None,
    exit_code: int,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def fail(*_arguments: object, **_options: object) -> None:
        raise failure

    monkeypatch.setattr("camwright.studies.axis_study.solve", fail)
    assert main(["design", "--json", "--out", str(tmp_path / "out")]) == exit_code
    shown = capsys.readouterr().out
    assert (strict(shown)["status"] if shown else None) == status
    assert list(tmp_path.iterdir()) == []


def test_who_stops_the_command_while_it_starts_sees_no_traceback() -> None:
    """Its modules are imported before anything of it could catch the interruption."""
    code = (
        "import runpy, sys\n"
        "class Stop:\n"
        "    def find_spec(self, name, *_):\n"
        "        if name == 'typer': raise KeyboardInterrupt\n"
        "sys.meta_path.insert(0, Stop())\n"
        "runpy.run_module('camwright', run_name='__main__')"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (run.returncode, run.stdout, run.stderr) == (130, "", "")
    project = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert project["scripts"] == {"camwright": "camwright.__main__:main"}


def test_what_nobody_foresaw_ends_with_4_and_no_traceback(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    def breaks(*_: object, **__: object) -> None:
        raise ZeroDivisionError("by nothing")

    monkeypatch.setattr("camwright.cli.design.optimise", breaks)
    assert main(["design", JOB, "--out", str(tmp_path / "out"), "--json"]) == 4
    out, err = capsys.readouterr()
    assert "a fault of camwright, not of the job: ZeroDivisionError: by nothing (in breaks)" in err
    assert "Traceback" not in err
    assert json.loads(out)["exit_code"] == 4
    assert not (tmp_path / "out").exists()


def test_a_reader_that_goes_away_is_no_error_worth_a_word() -> None:
    with subprocess.Popen([*COMMAND, "check", JOB], stdout=subprocess.PIPE, stderr=subprocess.PIPE) as run:
        assert run.stdout is not None
        assert run.stderr is not None
        run.stdout.close()
        assert run.stderr.read() == b""
    assert run.returncode == 141


def test_standard_output_that_cannot_be_written_ends_with_2() -> None:
    if not Path("/dev/full").exists():
        pytest.skip("needs /dev/full")
    with open("/dev/full", "w") as full:
        run = subprocess.run([*COMMAND, "check", JOB], stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert run.returncode == 2
    assert run.stderr == "camwright: the answer cannot be written to standard output: No space left on device\n"


def test_an_encoding_without_the_letters_is_no_obstacle() -> None:
    environment = {**os.environ, "PYTHONIOENCODING": "ascii", "PYTHONUTF8": "0"}
    run = subprocess.run([*COMMAND, "limits", JOB], capture_output=True, text=True, env=environment, check=False)
    assert (run.returncode, run.stderr) == (0, "")


@pytest.mark.parametrize("name", COMMANDS)
def test_the_table_of_commands_says_what_each_module_does(name: str) -> None:
    command = import_module(f"camwright.cli.{name}").run
    assert (command.__doc__ or "").splitlines()[0] == COMMANDS[name].does


def test_a_module_of_the_command_line_is_a_command() -> None:
    others = {"__init__", "commands", "destination", "main", "options"}
    assert {file.stem for file in Path(import_module("camwright.cli").__path__[0]).glob("*.py")} == {*COMMANDS, *others}


def test_help_and_check_import_nothing_heavy() -> None:
    heavy = "{'casadi', 'matplotlib', 'scipy.linalg', 'scipy.optimize', 'scipy.signal', 'scipy.interpolate'}"
    light = "{'numpy', 'pint', 'pydantic'}"
    for arguments, forbidden in ((["--help"], f"{heavy} | {light}"), (["check", JOB, "--json"], heavy)):
        code = f"import sys; from camwright.cli.main import main; main({arguments!r});"
        code += f"print(({forbidden}) & sys.modules.keys())"
        run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        assert run.stdout.splitlines()[-1] == "set()"


def test_a_design_without_figures_loads_the_solver_and_no_library_beside_it(tmp_path: Path) -> None:
    heavy = "{'scipy', 'matplotlib', 'clarabel', 'pint', 'jinja2', 'typst', 'rich.table', 'ezdxf', 'starlette'}"
    arguments = ["design", "--json", "--no-figures", "--out", str(tmp_path / "out")]
    code = f"import sys; from camwright.cli.main import main; main({arguments!r});"
    code += f"print('casadi' in sys.modules, ({heavy}) & sys.modules.keys())"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.splitlines()[-1] == "True set()"


def test_progress_is_shown_on_a_terminal(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("FORCE_COLOR", "1")
    seen: list[str] = []
    monkeypatch.setattr("camwright.studies.limits.cut_lengths", lambda job: (seen.append("asked"), cut_lengths(job))[1])
    assert main(["limits", JOB, "--json"]) == 0
    shown = capsys.readouterr()
    assert strict(shown.out)
    assert seen == ["asked"]
    assert "finding minimum cut lengths" in shown.err


def test_help_groups_commands_by_task_and_swallows_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--help"]) == 0
    told = capsys.readouterr().out
    assert all(command.task in told for command in COMMANDS.values())
    assert main(["identify", "--help"]) == 0
    told = " ".join(capsys.readouterr().out.split())
    assert "Write the [servo] table" in told
    assert "Example: camwright identify trace.csv" in told


@pytest.mark.parametrize(
    ("typed", "word", "completed"),
    [
        ("camwright li", 1, {"limits"}),
        ("camwright limits --js", 2, {"--json"}),
        ("camwright ex", 1, {"examples", "export"}),
    ],
)
def test_a_shell_completes_commands_and_their_options(typed: str, word: int, completed: set[str]) -> None:
    asked = {"COMP_WORDS": typed, "COMP_CWORD": str(word), "_CAMWRIGHT_COMPLETE": "complete_bash"}
    done = subprocess.run(COMMAND, env=os.environ | asked, capture_output=True, text=True, check=False)
    assert set(done.stdout.split()) == completed


def test_check_reads_standard_input(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    for data, code, words in (
        (PAPER.encode(), 0, "paper-600: cut 600 mm"),
        (PAPER.replace('"600 mm"', "600").encode(), 2, "standard input: [cut] length = 600: a number without a unit"),
        (b"\xff\xfe", 2, "standard input: not UTF-8 text (byte 0)"),
        (b"#" * (1 << 20) + b"#", 2, "standard input: larger than 1048576 bytes"),
    ):
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(data)))
        assert main(["check", "-"]) == code
        captured = capsys.readouterr()
        assert words in captured.out + captured.err


def test_validate_takes_what_a_bare_table_leaves_out(
    designed: tuple[Path, dict[str, Any]], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = [line.split(",") for line in (designed[0] / "cam.csv").read_text().splitlines() if line[0].isdigit()]
    bare = tmp_path / "bare.csv"
    bare.write_text("\n".join(f"{x},{float(y) / 10.0!r}" for x, y, *_ in rows))  # the slave in centimetres
    assert main(["validate", str(bare), "--job", JOB, "--units", "mm,cm", "--json"]) == 0
    stated = strict(capsys.readouterr().out)
    assert stated["passed"] is True
    assert main(["validate", str(bare), "--job", JOB, "--units", "mm,mm", "--json"]) == 1
    capsys.readouterr()
    assert main(["validate", str(designed[0] / "design.json"), "--job", JOB, "--units", "mm,mm"]) == 2
    assert "leave --units and --travel out" in capsys.readouterr().err


def test_a_job_that_begins_with_a_byte_order_mark_is_checked(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """As Windows' editor saves it, its lines ended in two characters."""
    file = tmp_path / "job.toml"
    file.write_bytes(b"\xef\xbb\xbf" + PAPER.replace("\n", "\r\n").encode())
    assert main(["check", str(file)]) == 0
    assert "no faults" in capsys.readouterr().out


@pytest.mark.parametrize("below", ["", "a/b"])
def test_a_file_in_the_place_of_the_output_is_refused_before_the_work(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, below: str
) -> None:
    monkeypatch.setattr("camwright.cli.main._application", lambda _: pytest.fail("the work was begun"))
    (tmp_path / "file").write_text("mine")
    assert main(["design", "--out", str(tmp_path / "file" / below)]) == 2
    assert "a file is in the way; choose another --out" in capsys.readouterr().err
