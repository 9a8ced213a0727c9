"""The command line on every machine: answers, files, and reading them back."""

from __future__ import annotations

import contextlib
import csv
import io
import json
import math
import re
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest

from camwright import load_job
from camwright.cli.main import main
from camwright.jobs.job import parse_job
from camwright.profiles.errors import InputError
from camwright.profiles.machines import CrankSlider
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import BASELINES
from camwright.stored.design_file import design_schema, read_design
from camwright.stored.profile_files import read_cycle
from camwright.studies.comparison import law_names

EXAMPLES = Path(__file__).parents[2] / "examples"
MACHINES = {
    # examples, made quick: the motion's objectives are solved in a tenth of the time of the torque's
    "flying-saw": [("rms_torque", "peak_torque")],
    # its acceleration steps at the ends of the sync zone faster than rows of 0.6 mm tell
    "chasing-shear": [
        ('"rms_torque"', '"rms_acceleration"'),
        ('"0.25 mm"', '"0.5 mm"'),
        ("points = 1441", "points = 4321"),
    ],
    "thick-product": [("peak_acceleration", "rms_acceleration")],
    "cross-cutter": [],
}


def strict(text: str) -> dict[str, Any]:
    """Read exactly one JSON object; NaN and infinity are refused."""

    def refuse(constant: str) -> None:
        raise AssertionError(constant)

    answer = json.loads(text, parse_constant=refuse)
    assert isinstance(answer, dict)
    return answer


def answer_of(capsys: pytest.CaptureFixture[str]) -> dict[str, Any]:
    return strict(capsys.readouterr().out)


def job_file(name: str, place: Path, *changes: tuple[str, str]) -> Path:
    """Write an example with changes."""
    text = (EXAMPLES / f"{name}.toml").read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    file = place / f"{name}.toml"
    file.write_text(text, encoding="utf-8")
    return file


@pytest.fixture(scope="module")
def designed(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], tuple[Path, Path, dict[str, Any]]]:
    """Design an example once: its job file, where its files are, and the answer."""

    @cache
    def design(name: str) -> tuple[Path, Path, dict[str, Any]]:
        place = tmp_path_factory.mktemp(name)
        job = job_file(name, place, *MACHINES[name])
        with contextlib.redirect_stdout(io.StringIO()) as shown:
            assert main(["design", str(job), "--no-figures", "--json", "--out", str(place / "out")]) == 0
        return job, place / "out", strict(shown.getvalue())

    return design


@pytest.mark.parametrize("name", MACHINES)
def test_a_machine_is_designed_written_and_judged_again(
    name: str,
    designed: Callable[[str], tuple[Path, Path, dict[str, Any]]],
    capsys: pytest.CaptureFixture[str],
) -> None:
    job, out, answer = designed(name)
    assert answer["passed"] is True
    asked = load_job(job)
    assert answer["profiles"].keys() == {"optimised", *law_names(asked.task)}
    assert (answer["minimum_cut_length_mm"]["eq9"] is None) == (name != "cross-cutter")
    assert (answer["tangential_mismatch"] is None) == (name in ("flying-saw", "chasing-shear"))
    objective, best = answer["objective"], answer["profiles"]["optimised"]
    if name == "flying-saw":
        assert objective["unit"] == "N m"
        assert objective["value"] == best["motor"]["peak_torque_N_m"]
    if name == "chasing-shear":
        assert objective["unit"] == "rad/s^2"
        assert 0.0 < objective["lower_bound"] <= objective["value"]
        assert answer["lower_bound_method"] == "weak duality, multipliers by an interior point"
        assert objective["value"] - objective["lower_bound"] < 1e-3 * objective["value"]
        assert answer["status"] == "best_found"  # the bound is that of the place which was chosen
        assert answer["starts"]["valleys"] >= 1
        assert best["slave"]["unit"] == "rad"
        assert best["slave"]["rms_acceleration"] == pytest.approx(objective["value"], rel=1e-9)
        assert best["motor"]["peak_speed_rad_per_s"] == pytest.approx(10 * best["slave"]["peak_speed"], rel=1e-12)
        assert best["motor"]["min_velocity_rad_per_s"] >= 0
        assert best["peak_speed_m_per_s"] >= 0.5 * (1 - 1e-9)  # the carriage keeps up with the material
    else:
        assert "slave" not in best
    jsonschema.validate(json.loads((out / "design.json").read_text()), design_schema())
    stored = read_design(out / "design.json")
    for file in ("design.json", "cam.csv"):
        cycle, machine, _ = read_cycle(out / file, asked)
        assert machine == stored.job.machine
        np.testing.assert_allclose(cycle(stored.profile.breaks), stored.profile(stored.profile.breaks), atol=1e-12)
        assert main(["validate", str(out / file), "--job", str(job), "--json"]) == 0
        assert answer_of(capsys)["profile"]["sync_ratio_error"] < 1e-9


@pytest.fixture
def crank_design(designed: Callable[[str], tuple[Path, Path, dict[str, Any]]]) -> tuple[Path, Path]:
    """Design a crank's job with a free sync zone: the job file, and where its files are."""
    return designed("chasing-shear")[:2]


def test_the_place_of_the_sync_zone_is_kept_in_both_files(crank_design: tuple[Path, Path]) -> None:
    job, place = crank_design
    machine = read_design(place / "design.json").job.machine
    assert isinstance(machine, CrankSlider)
    assert f"# sync_at: {machine.sync_at!r} rad\n" in (place / "cam.csv").read_text()
    header = next(line for line in (place / "cam.csv").read_text().splitlines() if not line.startswith("#"))
    assert header == "x [mm],y [rad],dy/dx [rad/m],d2y/dx2 [rad/m^2],d3y/dx3 [rad/m^3]"
    given = parse_job(job.read_text().replace("[machine]", '[machine]\nsync_at = "90 deg"'), "")
    assert read_cycle(place / "cam.csv", given)[1] == given.machine  # what the job gives counts


def test_a_table_that_does_not_say_where_its_sync_zone_lies_is_refused(crank_design: tuple[Path, Path]) -> None:
    job, place = crank_design
    text = (place / "cam.csv").read_text()
    bare = place / "bare.csv"
    for line in ("", "# sync_at: 1e9e9 rad"):
        bare.write_text(re.sub(r"(?m)^# sync_at.*$", line, text))
        with pytest.raises(
            InputError, match=r"does not say where on the crank its sync zone lies.*give \[machine\] sync_at"
        ):
            read_cycle(bare, load_job(job))
    bare.write_text(re.sub(r"(?m)^# sync_at.*$", "# sync_at: 3.1 rad", text))
    with pytest.raises(InputError, match="leaves no room for the sync zone"):
        read_cycle(bare, load_job(job))


def test_a_design_whose_sync_zone_was_moved_out_of_the_stroke_is_refused(crank_design: tuple[Path, Path]) -> None:
    data = json.loads((crank_design[1] / "design.json").read_text())
    for wrong in (None, "95 deg", 3.1, True):
        data["job"]["si"]["machine"]["sync_at"] = wrong
        file = crank_design[1] / "wrong.json"
        file.write_text(json.dumps(data))
        with pytest.raises(InputError, match=r"job.si.machine.sync_at, where on the crank the sync zone lies, must be"):
            read_design(file)


def test_a_table_in_another_slave_unit_is_refused(crank_design: tuple[Path, Path]) -> None:
    with pytest.raises(InputError, match=r"the slave is counted in rad, but that of the job's machine in m"):
        read_cycle(crank_design[1] / "cam.csv", load_job())


def test_a_crank_has_the_laws_that_it_can_run() -> None:
    asked = load_job(EXAMPLES / "chasing-shear.toml")
    assert law_names(asked.task) == ("linear_return", "poly_3_4_5", "crank_tabulated")
    saw = load_job(EXAMPLES / "flying-saw.toml")
    assert law_names(saw.task) == BASELINES


def test_a_law_of_another_machine_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["compare", str(EXAMPLES / "chasing-shear.toml"), "--with", "cycloid", "--no-figures"]
    assert main(arguments) == 2
    message = capsys.readouterr().err
    assert "--with 'cycloid': there is no such law for this machine; the laws are linear_return, poly_3_4_5" in message


@pytest.mark.parametrize("ratio", ["1.0", "1.05"])
def test_the_quintic_of_the_cross_cutter_is_a_baseline_where_it_is_another(
    ratio: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """It keeps the pitch, is in sync at the sync ratio, and never runs backwards, where the polynomial 3-4-5 does."""
    job = job_file(
        "cross-cutter", tmp_path, ('sync_tolerance = "0.1 mm"', f'sync_tolerance = "0.1 mm"\nsync_ratio = {ratio}')
    )
    arguments = ["--no-figures", "--json", "--with", "quintic", "--with", "poly_3_4_5"]
    assert main(["compare", str(job), *arguments]) == 0
    profiles = answer_of(capsys)["profiles"]
    assert profiles["quintic"]["min_speed_m_per_s"] == pytest.approx(0, abs=1e-12)
    assert profiles["poly_3_4_5"]["min_speed_m_per_s"] < -1e-3
    assert profiles["quintic"]["sync_ratio_error"] < 1e-12
    assert profiles["quintic"]["peak_jerk_m_per_s3"] is not None
    short = job_file("cross-cutter", tmp_path, ('length = "900 mm" ', 'length = "600 mm" '))
    assert main(["compare", str(short), *arguments]) == 2
    assert "--with 'quintic': there is no such law" in capsys.readouterr().err


def test_limits_of_a_carriage(capsys: pytest.CaptureFixture[str]) -> None:
    job = EXAMPLES / "flying-saw.toml"
    assert main(["limits", str(job), "--json"]) == 0
    answer = answer_of(capsys)
    assert answer["max_line_speed_m_per_min"] > 40
    assert answer["min_cut_length_mm"] < 3000
    assert answer["binding"].keys() == {"line_speed", "cut_length"}
    assert set(answer["minimum_cut_length_mm"].values()) == {None}
    assert main(["limits", str(job)]) == 0
    assert "Minimum cut length" not in capsys.readouterr().out


def test_check_tells_every_machine_in_its_own_units(capsys: pytest.CaptureFixture[str]) -> None:
    for name, words in (
        ("flying-saw", "stroke 1200 mm"),
        ("chasing-shear", "crank 150 mm, rod 600 mm, offset 0 mm"),
        ("thick-product", "circumference 800 mm, 2 blades, horizontal sync"),
    ):
        assert main(["check", str(EXAMPLES / f"{name}.toml")]) == 0
        shown = capsys.readouterr().out
        assert words in shown.replace("\n", " ")
        assert ("rpm" in shown) == (name == "chasing-shear")


def test_an_infeasible_machine_says_what_would_work(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    job = job_file("flying-saw", tmp_path, ('"6 m/s^2"', '"0.8 m/s^2"'))
    assert main(["design", str(job), "--no-figures", "--json", "--out", str(tmp_path / "out")]) == 3
    answer = answer_of(capsys)
    assert (answer["status"], answer["binding"], answer["excess"]["unit"]) == ("infeasible", "acceleration", "m/s^2")
    assert {"line_speed", "acceleration"} <= {suggestion["change"] for suggestion in answer["suggestions"]}


def test_the_envelope_is_told_and_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    job = EXAMPLES / "paper-600.toml"
    assert main(["envelope", str(job), "--points", "4", "--json", "--out", str(tmp_path)]) == 0
    answer = answer_of(capsys)
    assert len(answer["points"]) == 20
    assert [row["length_mm"] for row in answer["max_line_speed"]] == pytest.approx(
        [300, 400, 600, 900, 1200], rel=1e-12
    )
    names = ["envelope.csv", "envelope.png", "envelope.svg", "max-line-speed.csv"]
    assert answer["files"] == [str(tmp_path / name) for name in names]
    for point in answer["points"]:
        assert point["optimised"] or not point["quintic"]
        assert point["optimised"] == (point["objective"] is not None)
    lines = [line for line in (tmp_path / "envelope.csv").read_text().splitlines() if not line.startswith("#")]
    rows = list(csv.DictReader(lines))
    assert [float(row["line_speed_m_per_min"]) for row in rows] == [
        point["line_speed_m_per_min"] for point in answer["points"]
    ]
    assert [row["optimised"] == "1" for row in rows] == [point["optimised"] for point in answer["points"]]
    assert main(["envelope", str(job), "--points", "2", "--out", str(tmp_path)]) == 0
    assert "Highest line speed" in capsys.readouterr().out


def test_tables_of_angles_are_read_in_degrees_too(tmp_path: Path) -> None:
    """A straight line, a turn a cycle, as anyone may write it."""
    job = parse_job(
        (EXAMPLES / "chasing-shear.toml").read_text().replace("[machine]", '[machine]\nsync_at = "90 deg"'), ""
    )
    file = tmp_path / "anyones.csv"
    file.write_text("x [mm],y [deg]\n" + "".join(f"{x},{x * 0.4}\n" for x in range(0, 901, 90)))
    cycle = read_cycle(file, job)[0]
    assert isinstance(cycle, CamProfile)
    assert cycle(0.9) == pytest.approx(2 * math.pi, rel=1e-12)
    file.write_text("x [mm],y [deg],dy/dx [1],d2y/dx2 [1/m]\n0,0,0,0\n")
    with pytest.raises(InputError, match="does not go with y, which is an angle"):
        read_cycle(file, job)


def test_a_crank_is_compared_with_its_carriage_on_a_screw_where_that_is_asked(
    designed: Callable[[str], tuple[Path, Path, dict[str, Any]]], capsys: pytest.CaptureFixture[str]
) -> None:
    job, _, _ = designed("chasing-shear")
    command = ["compare", str(job), "--no-figures", "--with", "linear_return", "--json"]
    assert main(command) == 0
    plain = strict(capsys.readouterr().out)["profiles"]
    assert main([*command, "--screw"]) == 0
    beside = strict(capsys.readouterr().out)["profiles"]
    assert plain.keys() == {"optimised", "linear_return"}
    assert beside.keys() == {*plain, "screw_carriage"}
    assert plain == {name: beside[name] for name in plain}


def test_a_screw_is_refused_where_there_is_none_and_beside_objectives(
    designed: Callable[[str], tuple[Path, Path, dict[str, Any]]], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["compare", str(EXAMPLES / "flying-saw.toml"), "--screw"]) == 2
    assert "--screw: only a crank whose carriage has a mass" in capsys.readouterr().err
    assert main(["compare", str(EXAMPLES / "chasing-shear.toml"), "--objectives", "--screw"]) == 2
    assert "leave out --screw" in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.parametrize("job", sorted(EXAMPLES.glob("*.toml")), ids=lambda file: file.stem)
def test_the_table_that_design_writes_passes_as_its_design_does(
    job: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # as many rows as the example asks for hold its motion in the sync zone, wherever the design puts that
    assert main(["design", str(job), "--no-figures", "--quiet", "--out", str(tmp_path)]) == 0
    capsys.readouterr()
    assert main(["validate", str(tmp_path / "cam.csv"), "--job", str(job), "--json"]) == 0
    assert answer_of(capsys)["passed"] is True
