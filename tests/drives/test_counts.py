"""Tables in whole counts of the user's encoders: obeyed or refused, closed exactly, and what is lost in a cut told and judged."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from camwright.cli.main import main
from camwright.drives.export import Exported, export_possible, export_report
from camwright.drives.running_cam import running_cam
from camwright.drives.several_cuts import cuts_of
from camwright.house.owned import LIST
from camwright.jobs.job import Job, load_job, parse_job
from camwright.jobs.table_units import parse_units
from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import baseline
from camwright.profiles.tables.cam_table import make_table
from camwright.profiles.tables.targets import TARGETS
from camwright.stored.save import save
from camwright.studies.design import optimise
from camwright.validation.rebuilt import RUN, judge_table

TEXT = load_job().text
COUNTING = ("trio", "technosoft")


def knife(circumference: str, blades: int = 1) -> Job:
    return parse_job(
        TEXT.replace('circumference = "400 mm"', f'circumference = "{circumference}"\nblades = {blades}'), ""
    )


def profile_of(job: Job) -> CamProfile:
    return baseline("double_s", job.task)


def written(job: Job, target: str, units: str | None = None, **more: object) -> Exported:
    wanted = None if units is None else parse_units(units, job.task)
    results, refused = export_possible(profile_of(job), job, [target], units=wanted, **more)  # type: ignore[arg-type]
    if refused:
        raise InputError("; ".join(f"{name}: {fault}" for name, faults in refused.items() for fault in faults))
    return results[0]


def last_value(result: Exported) -> int:
    text = next(iter(result.files.values())).strip()
    return int(text.replace(")", " ").replace(",", " ").split()[-1])


@pytest.mark.parametrize("target", COUNTING)
@pytest.mark.parametrize("units", ["mm,9.25 um", "mm,40000/rev", "mm,40000 counts/rev", "0.5 mm,40000 / rev"])
def test_the_last_value_is_the_count_of_the_pitch(target: str, units: str) -> None:
    job = knife("370 mm")
    result = written(job, target, units)
    assert result.passed
    assert last_value(result) == 40_000  # 370 mm / 9.25 um
    assert (result.cuts, result.units.slave.size) == (1, pytest.approx(9.25e-6, rel=1e-15))
    assert abs(result.drift) < 1e-15


@pytest.mark.parametrize("target", COUNTING)
@pytest.mark.parametrize(
    ("counts", "blades", "cuts"), [(36_000, 3, 1), (131_072, 3, 3), (65_536, 6, 3), (100_000, 7, 7)]
)
def test_a_table_closes_over_as_many_cuts_as_its_counts_need(target: str, counts: int, blades: int, cuts: int) -> None:
    job = knife(f"{400 * blades} mm", blades)
    result = written(job, target, f"mm,{counts}/rev")
    assert result.cuts == cuts == Fraction(counts, blades).denominator
    assert last_value(result) == counts * cuts // blades
    assert abs(result.drift) < 1e-15
    assert result.passed
    assert result.table.period * result.units.master.size == pytest.approx(0.6 * cuts, rel=1e-12)


@pytest.mark.parametrize("target", COUNTING)
@pytest.mark.parametrize(("counts", "blades", "cuts"), [(36_000, 3, 1), (131_072, 3, 3), (100_000, 7, 7)])
@pytest.mark.parametrize("units", ["cycle,{counts}/rev", None])
def test_a_table_of_several_cuts_is_read_as_that(
    target: str, counts: int, blades: int, cuts: int, units: str | None
) -> None:
    job = knife(f"{400 * blades} mm", blades)
    result = written(job, target, f"mm,{counts}/rev")
    name, text = next(iter(result.files.items()))
    found = running_cam(text, name, job, units=units and units.format(counts=counts))
    assert found.rebuilt.length == pytest.approx(0.6 * cuts, rel=1e-9)
    assert found.rebuilt.advance == pytest.approx(0.4 * cuts, rel=1e-9)
    assert (f"the table holds {cuts} cuts, after which it closes" in found.notes) == (cuts > 1)
    assert found.cycle.length == pytest.approx(0.6, rel=1e-12)
    judged = judge_table(found.rebuilt, job.task, job.servo, stored=0.4 * blades / counts)
    assert judged.passed


@pytest.mark.parametrize("target", COUNTING)
@pytest.mark.parametrize("units", ["mm,131072/rev", "mm,36001/rev", "0.01 mm,9.25 um", None])
def test_an_audit_judges_counts_as_their_export_did(target: str, units: str | None) -> None:
    """Three blades: the drift over the run, what rounding makes of differences, and the zero, with the units of the text beside."""
    job = knife("1200 mm", 3)
    result = written(job, target, units, force=True)
    (name, text), (_, head) = result.files.items()
    found = running_cam(text, name, job, head=head)
    assert [(check.name, check.passed) for check in found.judged().checks] == [
        (check.name, check.passed) for check in result.judgement.checks
    ]
    closure = {check.name: check.value for check in found.judged().checks}["closure"]
    assert closure == pytest.approx(RUN * abs(result.drift), rel=1e-6, abs=1e-9)
    assert "the units are those of the text beside the table (--units says others)" in found.notes
    x = np.linspace(0.0, 0.6, 601)[:-1]
    assert np.abs(found.cycle(x) - profile_of(job)(x)).max() < (2e-7 if units is None else 3e-5)
    assert "the units are those" not in " ".join(
        running_cam(text, name, job, head=head.replace("points: ", "points: 1")).notes
    )


def test_a_table_of_one_cut_is_one() -> None:
    job = knife("400 mm")
    straight = CamProfile.from_arrays([0.0, 0.6], [[0.0, 2 / 3]])
    for profile, cuts in ((profile_of(job), 1), (straight, 1), (profile_of(job).repeat(4), 4)):
        x = np.linspace(0.0, profile.length, 361)
        assert cuts_of(make_table(x, np.rint(profile(x) / 1e-5), law="spline")) == cuts


def test_cambox_is_called_with_the_period_in_the_master_s_unit() -> None:
    job = knife("1200 mm", 3)
    for units, distance in (("mm,131072/rev", "1800"), ("5 um,36000/rev", "120000"), ("deg,36000/rev", "360")):
        result = written(job, "trio", units)
        call = result.files["paper_600_trio.txt"].strip().splitlines()[-1]
        assert call == f"CAMBOX(0, {result.table.points - 1}, 1, {distance}, <link axis>, 4)"
        program = result.files["paper_600_trio.bas"] + call.replace("<link axis>", "1") + "\n"
        table = TARGETS["trio"].read(program, "program.bas")
        assert table.period == float(distance)
        assert list(table.y) == list(result.table.y)
    assert "<link distance>" in written(job, "trio").files["paper_600_trio.txt"]


def test_technosoft_s_master_positions_are_whole_counts_spaced_by_a_power_of_two() -> None:
    rows = [line.split() for line in written(knife("370 mm"), "technosoft", "100 um,9.25 um").files[
        "paper_600_technosoft.txt"
    ].splitlines()]  # fmt: skip
    assert rows[-1] == ["6000", "40000"]
    assert int(rows[1][0]) in (1, 2, 4, 8, 16)


def test_what_is_lost_in_a_cut_is_told_and_fails_beyond_the_tolerance() -> None:
    """43243.24 counts of 9.25 um in 400 mm: no table of up to 24 cuts closes."""
    job = knife("400 mm")
    lost = 43_243 * 9.25e-6 - 0.4
    result = written(job, "trio", "mm,9.25 um", force=True)
    report = export_report([result], job)["targets"]["trio"]
    assert report["drift_per_cut"] == {"value": pytest.approx(lost), "unit": "m", "run_cuts": RUN}
    assert report["cuts"] == 1
    closure = next(check for check in result.judgement.checks if check.name == "closure")
    assert (closure.passed, closure.value) == (False, pytest.approx(RUN * -lost, rel=1e-6))
    assert "over a run of 10000 cuts" in closure.source
    assert "drift of the slave in a cut: -2.25e-06 m" in result.files["paper_600_trio.txt"]
    near = written(job, "trio", "mm,9.2500001 um")
    assert abs(near.drift) > 1e-9


def test_a_drift_that_the_tolerance_bears_passes() -> None:
    job = knife("370.0000000369 mm")  # 0.0000369 um beyond 40000 counts
    result = written(job, "trio", "mm,9.25 um")
    assert result.drift == pytest.approx(-3.69e-11, rel=1e-3)
    assert result.passed


@pytest.mark.parametrize("target", COUNTING)
def test_without_units_three_blades_close_all_the_same(target: str) -> None:
    result = written(knife("1000 mm", 3), target)
    assert abs(result.drift) < 1e-15
    assert last_value(result) == 3_333_333
    assert result.units.slave.symbol == "count"
    assert result.units.slave.size == pytest.approx(1e-7, rel=1e-6)
    assert written(knife("400 mm"), target).units.slave.symbol == "0.1um"


@pytest.mark.parametrize(
    ("target", "units", "said"),
    [
        ("trio", "mm,mm", "trio stores whole counts of the slave, and mm is no count; write the size of one"),
        ("technosoft", "mm,deg", "technosoft stores whole counts of the slave, and deg is no count"),
        ("technosoft", "7.77 um,9.25 um", "technosoft stores the master in whole counts, and the cycle of 600 mm is 77220.07722 of 7.77um"),
        ("technosoft", "0.1 um,9.25 um", "technosoft takes at most 8192 points spaced by 1, 2, 4"),
        ("csv", "mm,9.25 um", "csv takes m, mm, cm, um, in, ft by name"),
        ("csv", "mm,deg", "got mm,deg"),
        ("twincat-cnc", "mm,mm", "twincat-cnc counts the master in 1e-4 deg and the slave in 1e-4 mm; leave --units out"),
    ],
)  # fmt: skip
def test_units_that_a_target_cannot_have_are_refused(target: str, units: str, said: str) -> None:
    with pytest.raises(InputError, match=said.replace("(", r"\(")):
        written(knife("370 mm"), target, units)


@pytest.mark.parametrize(("units", "x", "y"), [("m,m", 0.6, 0.4), ("mm,in", 600.0, 0.4 / 0.0254), ("um,cm", 6e5, 40.0)])
def test_csv_is_written_in_the_units_asked_for(units: str, x: float, y: float) -> None:
    result = written(load_job(), "csv", units)
    assert result.passed
    master, slave = units.split(",")
    rows = [line for line in result.files["paper_600_cam.csv"].splitlines() if not line.startswith("#")]
    assert rows[0] == f"x [{master}],y [{slave}],dy/dx [1],d2y/dx2 [1/m]"
    assert [float(cell) for cell in rows[-1].split(",")[:2]] == pytest.approx([x, y], rel=1e-14)
    assert result.position_error < 1e-12


@pytest.mark.parametrize("text", ["0/rev", "/rev", "-5/rev", "36000/deg", "1.5/rev"])
def test_counts_of_a_turn_that_are_none_are_refused(text: str) -> None:
    with pytest.raises(InputError):
        parse_units(f"mm,{text}", load_job().task)


def test_a_table_of_several_cuts_is_judged_cut_by_cut() -> None:
    """One cut of three that is off must not hide behind the others."""
    job = load_job()
    one = profile_of(job)
    three = one.repeat(3)
    assert judge_table(three, job.task, job.servo).passed
    table = three.coefficients.copy()
    table[one.pieces : 2 * one.pieces, 0] += 3e-4  # the second cut alone
    judged = judge_table(CamProfile(three.breaks, table), job.task, job.servo)
    failed = {check.name for check in judged.checks if not check.passed}
    assert {"sync_position", "position_joins"} <= failed
    assert judged.wraps == 3


def test_the_command_says_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    save(optimise(knife("1200 mm", 3)), tmp_path)
    asked = ["export", str(tmp_path / "design.json"), "--to", "trio", "--out", str(tmp_path / "tables")]
    assert main([*asked, "--units", "mm,131072/rev"]) == 0
    assert "trio: one table for 3 cuts, after which its counts close" in capsys.readouterr().out
    assert main([*asked, "--units", "mm,9.25 um"]) == 1
    said = capsys.readouterr().out
    assert "trio: -2.25 um beyond the pitch in each cut" in said
    assert "failed: closure" in said
    names = {path.name for path in (tmp_path / "tables").iterdir()}
    assert names == {LIST, "report.json", "paper_600_trio.bas.withheld-old", "paper_600_trio.txt.withheld-old"}
    assert json.loads((tmp_path / "tables" / "report.json").read_text())["targets"]["trio"]["cuts"] == 1


COUNTED = '[output]\ncounts = "mm,131072/rev"'


def test_counts_of_the_job_are_those_of_its_tables(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = knife("1200 mm", 3).text.replace("[output]", COUNTED)
    job = parse_job(text, "job.toml")
    assert parse_job(job.text, "again") == job
    results = export_possible(profile_of(job), job, ["trio", "csv", "technosoft"])[0]
    assert [(result.cuts, result.passed) for result in results] == [(3, True), (1, True), (3, True)]
    assert last_value(results[0]) == 131_072
    (asked,) = export_possible(profile_of(job), job, ["trio"], units=parse_units("mm,36000/rev", job.task))[0]
    assert last_value(asked) == 12_000  # an option outdoes the job
    (tmp_path / "job.toml").write_text(text, encoding="utf-8")
    folder = tmp_path / "recipe"
    assert main(["recipe", str(tmp_path / "job.toml"), "--targets", "trio,csv", "--out", str(folder), "--quiet"]) == 0
    assert main(["verify", str(folder), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["faults"] == []


@pytest.mark.parametrize(
    "counts", ['"36000"', '"mm"', '"mm,mm"', "36000", '"mm,36000/rev,mm"', '"mm,-5 um"', '"mm,1/rev/rev"']
)
def test_counts_of_a_job_that_are_none_are_refused(counts: str) -> None:
    with pytest.raises(InputError, match=r"\[output\] counts"):
        parse_job(TEXT.replace("[output]", f"[output]\ncounts = {counts}"), "job.toml")


def test_counts_that_the_machine_does_not_have_are_refused_where_the_table_is_made() -> None:
    job = parse_job(TEXT.replace("[output]", '[output]\ncounts = "furlong,36000/rev"'), "job.toml")
    with pytest.raises(InputError, match=r"trio: \[output\] counts: there is no unit 'furlong'"):
        written(job, "trio")
