"""Auditing foreign cams: units, zeros, straight lines, machines; the answer and the figure."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from camwright import load_job, optimise
from camwright.cli.main import main
from camwright.drives.alignment import aligned
from camwright.drives.audit import Audit, audit, audit_answer
from camwright.drives.export import export_possible
from camwright.drives.options import with_slopes
from camwright.drives.running_cam import running_cam
from camwright.figures.audit import audit_figure
from camwright.house.owned import LIST
from camwright.house.picture_files import write_pictures
from camwright.jobs.job import Job
from camwright.jobs.table_cycle import whole_cycle
from camwright.profiles.cut import Origin
from camwright.profiles.errors import InputError
from camwright.profiles.machines import CrankSlider
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import baseline
from camwright.profiles.servo import Servo
from camwright.profiles.tables.cam_table import TableUnits, Unit, make_table
from camwright.validation.rebuilt import judge_table
from camwright.validation.servo.response import shear_zone_of
from camwright.validation.servo.simulation import simulate

JOB = load_job()
PROFILE = baseline("double_s", JOB.task)
EXAMPLES = Path(__file__).parents[2] / "examples"


def columns(place: Path, profile: CamProfile, begin: float = 0.0, master: float = 1.0, slave: float = 1.0) -> Path:
    x = np.linspace(0.0, profile.length, 241)
    y = profile(x + begin, outside="repeat")
    place.write_text(
        "".join(f"{a * master!r};{b * slave - 3!r}\n" for a, b in zip(x.tolist(), y.tolist(), strict=True))
    )
    return place


def of(result: Audit, name: str) -> float:
    value = next(check.value for check in result.judgement.checks if check.name == name)
    assert value is not None
    return value


@pytest.mark.parametrize("target", ["logix", "codesys", "kollmorgen-kas", "trio"])
def test_an_audit_finds_what_was_written(target: str, tmp_path: Path) -> None:
    (written,) = export_possible(PROFILE, JOB, [target])[0]
    name, text = next(iter(written.files.items()))
    (tmp_path / name).write_bytes(text.encode())
    result = audit(tmp_path / name, JOB)
    assert result.target.name == target
    assert result.judgement.passed
    answer = audit_answer(result, tmp_path / name)
    json.dumps(answer, allow_nan=False)
    assert set(answer) >= {"target", "knots", "profile", "optimum", "saving", "checks"}
    assert set(answer["saving"]) == {"peak_acceleration_rel", "rms_acceleration_rel"}
    if target == "trio":
        assert answer["profile"]["peak_acceleration_m_per_s2"] is None  # straight lines: unbounded
        assert answer["saving_by"] == "differences at the sample time"
        own, best = (answer["sampled"][key]["peak_acceleration"] for key in ("profile", "optimum"))
    else:
        assert answer["saving_by"] == "exact"
        own, best = (answer[key]["peak_acceleration_m_per_s2"] for key in ("profile", "optimum"))
    assert own > best
    assert answer["saving"]["peak_acceleration_rel"] == pytest.approx(1 - best / own)


def test_differences_of_straight_lines_approach_the_acceleration_of_the_curve(tmp_path: Path) -> None:
    # 8192 lines of 0.07 mm: at 1 ms, 1.3 mm, the corners are smoothed out
    job = replace(JOB, servo=replace(JOB.servo, sample_time=0.001))
    (written,) = export_possible(PROFILE, job, ["technosoft"], points=8192, force=True)[0]
    name, text = next(iter(written.files.items()))
    (tmp_path / name).write_text(text)
    result = audit(tmp_path / name, job, target="technosoft")
    v, x = job.cut.line_speed, np.linspace(0, 0.4, 20_001)
    true = v**2 * np.abs(PROFILE(x, 2))
    assert result.sampled.peak_acceleration == pytest.approx(
        float(true.max()), rel=0.03
    )  # rounding to 0.1 um over 1 ms
    assert result.sampled.rms_acceleration == pytest.approx(float(np.sqrt(np.mean(true**2))), rel=0.01)
    assert result.saving("peak_acceleration") == pytest.approx(0.32, abs=0.02)


@pytest.mark.parametrize("units", [None, "deg,mm"])
def test_columns_in_degrees_of_the_cycle(units: str | None, tmp_path: Path) -> None:
    result = audit(columns(tmp_path / "c.csv", PROFILE, master=360 / 0.6, slave=1e3), JOB, units=units)
    assert result.judgement.passed
    assert of(result, "sync_position") < 1e-6
    assert result.cycle.length == pytest.approx(0.6)


@pytest.mark.parametrize("origin", ["return", "cut"])
@pytest.mark.parametrize("begin", [0.0, 0.05, 0.3, 0.55])
def test_the_zeros_of_master_and_slave_are_the_users_affair(origin: Origin, begin: float, tmp_path: Path) -> None:
    job = replace(JOB, cut=replace(JOB.cut, origin=origin))
    profile = baseline("cycloid", job.task)
    result = audit(columns(tmp_path / "c.csv", profile, begin=begin), job, units="m,m")
    assert of(result, "sync_position") < 2e-6
    assert any("master zero is not the job's" in note for note in result.notes) == (begin > 0)
    if begin:
        found = float(next(note for note in result.notes if "zero" in note).split(" begins ")[1].split(" mm")[0]) * 1e-3
        assert found == pytest.approx(0.6 - begin, abs=4e-4)


def test_a_cam_that_is_nowhere_in_sync_fails(tmp_path: Path) -> None:
    x = np.linspace(0, 0.6, 121)
    wave = x * (2 / 3) + 0.02 * np.sin(2 * np.pi * x / 0.6)
    (tmp_path / "c.csv").write_text("".join(f"{a!r},{b!r}\n" for a, b in zip(x.tolist(), wave.tolist(), strict=True)))
    result = audit(tmp_path / "c.csv", JOB)
    assert {check.name for check in result.judgement.checks if not check.passed} >= {"sync_position", "sync_ratio"}


@pytest.mark.parametrize(
    ("text", "units", "message"),
    [
        ("0,0\n1,1\n2,0\n", None, "its unit cannot be told from the pitch"),
        ("0,0\n300,1\n600,400\n", "deg,mm", "master period is 1000 mm, but the cut length is 600 mm; check the units"),
        ("0,0\n300,1\n600,400\n", "parsec,mm", "there is no unit 'parsec' here"),
        ("x [mm],y [mm]\n0,0\n1,1\n2,2\n600,400\n", "mm,mm", r"states its units \(m,m\); leave --units out"),
        (
            "x [mm],y [rad]\n0,0\n1,1\n2,2\n600,4\n",
            None,
            "the slave is counted in rad, but that of the job's machine in m",
        ),
    ],
)
def test_what_is_no_cam_of_the_job_is_refused(text: str, units: str | None, message: str, tmp_path: Path) -> None:
    (tmp_path / "c.csv").write_text(text)
    with pytest.raises(InputError, match=message):
        audit(tmp_path / "c.csv", JOB, units=units)


def test_a_carriage_counted_in_steps(tmp_path: Path) -> None:
    job = load_job(EXAMPLES / "flying-saw.toml")
    (written,) = export_possible(baseline("double_s", job.task), job, ["trio"], force=True)[0]
    name, text = next(iter(written.files.items()))
    (tmp_path / name).write_text(text)
    with pytest.raises(InputError, match="--units cycle,mm"):
        audit(tmp_path / name, job)
    result = audit(tmp_path / name, job, units="cycle,0.1 um")
    assert of(result, "sync_position") < 1e-5
    assert of(result, "stroke") < 0


def test_a_crank_is_placed_as_the_file_says(tmp_path: Path) -> None:
    free = load_job(EXAMPLES / "chasing-shear.toml")
    assert isinstance(free.machine, CrankSlider)
    job: Job = replace(free, machine=replace(free.machine, sync_at=math.radians(85)))
    profile = baseline("poly_3_4_5", job.task)
    (written,) = export_possible(
        profile, job, ["codesys"], force=True, units=TableUnits(Unit("mm", 1e-3), Unit("deg", math.radians(1), "rad"))
    )[0]
    name, text = next(iter(written.files.items()))
    (tmp_path / name).write_text(text)
    result = audit(tmp_path / name, free)
    assert isinstance(result.job.machine, CrankSlider)
    assert result.job.machine.sync_at == math.radians(85)
    assert of(result, "sync_position") < 2e-6
    assert result.table.y[-1] == pytest.approx(360)
    (tmp_path / name).write_text(text.replace("sync_at", "sync"))
    with pytest.raises(InputError, match=r"give \[machine\] sync_at"):
        audit(tmp_path / name, free)


def test_an_unstable_servo_is_said(tmp_path: Path) -> None:
    job = replace(JOB, servo=Servo(80.0, 0.7, 200.0, 0.008, 1.0))
    result = audit(columns(tmp_path / "c.csv", PROFILE), job)
    assert not result.judgement.passed
    assert audit_answer(result, tmp_path / "c.csv")["profile"]["servo"] is None


def test_the_command_writes_the_figure(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "job.toml").write_text(JOB.text)
    file = columns(tmp_path / "c.csv", PROFILE, master=1e3, slave=1e3)
    call = ["audit", str(file), "--job", str(tmp_path / "job.toml"), "--units", "mm,mm"]
    assert main([*call, "--out", str(tmp_path / "out"), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert [Path(name).name for name in answer["files"]] == ["audit.svg", "audit.png"]
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == [LIST, "audit.png", "audit.svg"]
    assert main([*call, "--out", str(tmp_path / "none"), "--no-figures"]) == 0
    assert "peak acceleration (m/s²)" in capsys.readouterr().out
    assert not (tmp_path / "none").exists()
    weak = JOB.text.replace('acceleration = "30 m/s^2"', 'acceleration = "10 m/s^2"')
    (tmp_path / "job.toml").write_text(weak)
    assert main([*call, "--no-figures", "--quiet"]) == 1
    assert main(["audit", str(tmp_path / "none.csv"), "--job", str(tmp_path / "job.toml"), "--no-figures"]) == 2


def test_the_figure_is_the_same_each_time(tmp_path: Path) -> None:
    result = audit(columns(tmp_path / "c.csv", PROFILE), JOB)
    pictures = []
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        files = write_pictures({"audit": audit_figure(result)}, tmp_path / name)
        pictures.append([path.read_bytes() for path in files])
    assert pictures[0] == pictures[1]
    for words in (b"running cam", b"peak jerk"):
        assert len(pictures[0][0]) > 10_000
        assert words in pictures[0][0]


def trio_of(profile: CamProfile, place: Path, size: float, digits: int) -> Path:
    y = [float(profile(at)) for at in np.linspace(0.0, profile.length, 361)]
    place.write_text("".join(f"TABLE({k},{b / size:.{digits}f})\n" for k, b in enumerate(y)))
    return place


def test_reals_are_not_rounded(tmp_path: Path) -> None:
    fine = audit(trio_of(PROFILE, tmp_path / "a.bas", 1e-7, 0), JOB)
    real = audit(trio_of(PROFILE, tmp_path / "b.bas", 0.4, 9), JOB)
    for measure in ("peak_acceleration", "rms_acceleration"):
        assert real.pair(measure)[0] == pytest.approx(fine.pair(measure)[0], rel=2e-3)
    assert real.judgement.passed == fine.judgement.passed


def kernel(profile: CamProfile, size: float, place: Path) -> Path:
    rows = [f"{10_000 * k} {round(float(profile(profile.length * k / 360)) / size)}" for k in range(360)]
    head = "Tablename = K\nTable-ID = 7\nTabletype = 7\nFunctiontype = 1\nLines = 360\nBegintable\n"
    place.write_text(head + "\n".join(rows) + "\nEndTable\n")
    return place


def test_the_travel_that_a_kernels_table_leaves_out(tmp_path: Path) -> None:
    degrees = kernel(PROFILE, 0.4 / 3_600_000, tmp_path / "deg.txt")
    for units in (None, "cycle,0.0001 deg"):
        result = audit(degrees, JOB, units=units)
        assert result.table.advance == pytest.approx(3_600_000)
        assert of(result, "sync_position") < 1e-6
        assert any("the pitch of the job, is taken" in note for note in result.notes)
    assert any("kernel's own: 0.0001 deg, 0.0001 deg" in note for note in audit(degrees, JOB).notes)
    with pytest.raises(
        InputError, match=r"runs on to about 0.36 m .0.1um., and the job's pitch is 0.4 m; say it with --travel"
    ):
        audit(degrees, JOB, units="cycle,0.1um")
    wide = kernel(PROFILE, 1e-7, tmp_path / "mm.txt")
    assert audit(wide, JOB).table.advance == pytest.approx(4_000_000)
    with pytest.raises(InputError, match=r"--travel says 0.3 m a cycle, but the table's own ends are 0.4 m apart"):
        audit(columns(tmp_path / "c.csv", PROFILE), JOB, travel="300 mm", units="m,m")


def millimetres(place: Path, x: list[float], y: list[float]) -> Path:
    place.write_text("x [mm];y [mm]\n" + "".join(f"{a:.6f};{b:.6f}\n" for a, b in zip(x, y, strict=True)))
    return place


@pytest.mark.parametrize(
    ("kind", "told"),
    [
        ("wrapped", "the last row wraps"),
        ("missing", "the row that ends the cycle is missing"),
        ("beyond", "one step beyond the cycle"),
        ("anywhere", "it is counted modulo 0.4 m"),
        ("repeated", "rows that stand there twice"),
    ],
)
def test_ends_that_files_have(kind: str, told: str, tmp_path: Path) -> None:
    x = np.linspace(0.0, 0.6, 361)
    y = PROFILE(x)
    plain = audit(millimetres(tmp_path / "a.csv", (x * 1e3).tolist(), (y * 1e3).tolist()), JOB)
    if kind == "wrapped":
        y[-1] = y[0]
    elif kind == "missing":
        x, y = x[:-1], y[:-1]
    elif kind == "beyond":
        x, y = np.append(x, x[-1] + x[1]), np.append(y, y[0] + 0.4 + y[1] - y[0])
    elif kind == "anywhere":
        y = PROFILE(x + 0.17, outside="repeat") % 0.4
    else:
        x, y = np.append(x, x[-1]), np.append(y, y[-1])
    result = audit(millimetres(tmp_path / "b.csv", (x * 1e3).tolist(), (y * 1e3).tolist()), JOB)
    assert any(told in note for note in result.notes), result.notes
    assert result.judgement.passed == plain.judgement.passed
    assert result.pair("peak_acceleration")[0] == pytest.approx(plain.pair("peak_acceleration")[0], rel=0.02)


ROWS = [(600 * k / 360, 1e3 * float(PROFILE(0.6 * k / 360))) for k in range(361)]


def written(head: str, row: str, begin: float = 0.0, modulus: float = math.inf, size: float = 1.0) -> str:
    return head + "".join(row.format(x=x / size, y=((y + begin) % modulus) / size) + "\n" for x, y in ROWS)


PLAIN = written("x [mm],y [mm]\n", "{x:.6f},{y:.6f}")
PAGES = "".join(f"{line}\n" + ("x [mm],y [mm]\n" if k % 50 == 49 else "") for k, line in enumerate(PLAIN.splitlines()))


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (PAGES, ""),
        (written('Master (");Slave (in)\n', "{x:.9f};{y:.9f}", size=25.4), ""),
        (written("x [%],y [counts]\n", "{x:.6f},{y:.6f}"), "its advance, 400, is taken for the pitch"),
        (written("Master,Slave [inc.]\n", "{x:.6f},{y:.6f}"), "its advance, 400, is taken for the pitch"),
        (written("x [mm],y [mm]\n", "{x:.6f},{y:.6f}", 37.3, 250.0), "modulo 0.25 m and was unwrapped"),
        (written("x [mm],y [mm]\n", "{x:.6f},{y:.6f}", 37.3, 400 / 3), "modulo 0.133333 m and was unwrapped"),
        (written("x [mm],y [mm]\n", "{x:.6f},{y:.6f}", 37.3, 400.0), "modulo 0.4 m and was unwrapped"),
    ],
)
def test_a_table_in_other_clothes_is_the_same_cam(text: str, told: str) -> None:
    """Headings on each page, inches by their sign, counts and parts of a cycle, a slave modulo any length."""
    plain, found = running_cam(PLAIN, "plain.csv", JOB), running_cam(text, "cam.csv", JOB)
    x = np.linspace(0.0, 0.6, 1001)[:-1]
    assert found.cycle(x) == pytest.approx(plain.cycle(x), abs=1e-8)
    assert told in " | ".join(found.notes)


def listed(head: str, row: str, count: int, begin: float = 0.0, sign: float = 1.0, scale: float = 1.0) -> str:
    """Slave positions (mm) at even steps of a cycle, modulo their pitch where they begin elsewhere."""
    y = 1e3 * PROFILE(np.linspace(0.0, 0.6, 361))[:count]
    y = sign * scale * ((y + begin) % 400.0 if begin else y)
    return head + "".join(row.format(value) for value in y.tolist())


def test_swapped_columns_without_names_are_refused() -> None:
    with pytest.raises(
        InputError,
        match="the first column runs over 400 and the second over 600, like the job's pitch and its cut length",
    ):
        running_cam(written("", "{y:.6f} {x:.6f}"), "cam.txt", JOB)


def test_a_jump_that_is_no_turn_is_refused(tmp_path: Path) -> None:
    x = np.linspace(0.0, 600.0, 121)
    y = 1e3 * PROFILE(x * 1e-3)
    y[60:] = 0.97 * y[60:] - 310.0  # by that it does not run on to the pitch
    with pytest.raises(InputError, match=r"the slave jumps by -0.31.* m at point 61, which is no whole turn of 0.4 m;"):
        audit(millimetres(tmp_path / "a.csv", x.tolist(), y.tolist()), JOB)


@pytest.mark.parametrize("zone", [0.2, 0.26])
@pytest.mark.parametrize("wrapped", [False, True])
def test_a_straight_line_over_half_the_cycle_is_no_jump(zone: float, wrapped: bool) -> None:
    """Drives that know lines take the sync zone as one long step; one that turns over within it is still found."""
    job = replace(JOB, cut=replace(JOB.cut, sync_zone=zone))
    x = np.append(np.linspace(0.0, 0.6 - zone, 200), 0.6)
    y = baseline("poly_3_4_5", job.task)(x)
    units = TableUnits(Unit("m", 1.0), Unit("m", 1.0))
    found = whole_cycle(make_table(x, y % 0.4 if wrapped else y, law="line", units=units), job, "a table")
    np.testing.assert_allclose(found.table.y, y, atol=1e-12)
    assert len(found.notes) == wrapped


def test_a_table_of_lines_is_audited_as_it_was_written(tmp_path: Path) -> None:
    (written,) = export_possible(PROFILE, JOB, ["lenze"])[0]
    name, text = next(iter(written.files.items()))
    (tmp_path / name).write_bytes(text.encode())
    assert audit(tmp_path / name, JOB).judgement.passed


@pytest.mark.parametrize(("turn", "within"), [(36_000, 0.15), (131_072, 0.05), (1_048_576, 0.01)])
@pytest.mark.parametrize("points", [361, 3601])
def test_counts_of_an_encoder(turn: int, within: float, points: int, tmp_path: Path) -> None:
    x = np.linspace(0.0, 0.6, points)
    counts = np.rint(PROFILE(x) / 0.4 * turn)
    (tmp_path / "c.csv").write_text("".join(f"{k};{c:.0f}\n" for k, c in enumerate(counts)))
    result = audit(tmp_path / "c.csv", JOB, target="csv")
    true = JOB.cut.line_speed**2 * float(np.abs(PROFILE(np.linspace(0, 0.6, 20_001), 2)).max())
    assert result.counted
    assert result.pair("peak_acceleration")[0] == pytest.approx(true, rel=within)
    saving = 1.0 - result.pair("peak_acceleration")[1] / true
    assert result.saving("peak_acceleration") == pytest.approx(saving, abs=within)
    assert any("whole counts of 1 " in note for note in result.notes)


def test_the_zero_of_a_file_does_not_matter() -> None:
    best = baseline("double_s", JOB.task)
    wanted = [check.value for check in judge_table(aligned(best, JOB)[0], JOB.task, JOB.servo).checks[3:]]
    dice = np.random.default_rng(4)
    for shift in [*dice.uniform(0.0, 0.6, 15), 1e-6, 2e-5, 3e-4, 0.6 - 1e-5]:
        moved = aligned(best.roll(float(shift)), JOB)[0]
        found = judge_table(moved, JOB.task, JOB.servo)
        assert found.passed
        assert [check.value for check in found.checks[3:]] == pytest.approx(wanted, rel=1e-6, abs=1e-12)


@pytest.mark.parametrize("law", ["double_s", "cycloid"])
def test_the_zero_of_a_carriage_does_not_matter_either(law: str) -> None:
    """Its zone is so long that a micrometre beside its beginning fits as well, by what the ratio tells; the points tell it."""
    job = load_job(Path(__file__).parents[2] / "examples" / "flying-saw.toml")
    best = baseline(law, job.task)
    for shift in [*np.random.default_rng(8).uniform(0.0, job.cut.length, 12), 1e-6, 2e-5, job.cut.length - 1e-6]:
        moved = aligned(best.roll(float(shift)), job)[0]
        for found, wanted in zip(moved.extrema(), best.extrema(), strict=True):
            assert found.value == pytest.approx(wanted.value, rel=1e-9, abs=1e-11)
        grid = np.linspace(0.0, 0.999 * job.cut.length, 99)
        assert moved(grid) == pytest.approx(best(grid), abs=1e-9)


@pytest.mark.parametrize("name", ["cross-cutter", "ramping-line", "flying-punch"])
@pytest.mark.parametrize("target", ["codesys", "csv"])
def test_a_table_of_ones_own_lies_where_it_was_written(name: str, target: str) -> None:
    """Its points are few and stand where the motion asks for them: close together at switches, none in the sync zone."""
    job, profile = designed(name)
    (written,) = export_possible(profile, job, [target])[0]
    found = running_cam(next(iter(written.files.values())), "cam", job)
    assert found.judged().passed
    assert not found.counted
    x = np.linspace(0.0, 0.999 * job.cut.length, 301)
    assert np.abs(found.cycle(x) - profile(x)).max() < 1e-8 * max(job.cut.length, job.machine.pitch)


@cache
def designed(name: str) -> tuple[Job, CamProfile]:
    job = load_job(EXAMPLES / f"{name}.toml")
    if name == "short-cut":
        job = replace(job, servo_tolerance=None)
    return job, optimise(job).profile


def test_a_shaped_cam_is_put_where_its_axis_is_in_sync() -> None:
    """The command of the short cut is nowhere in sync; the cam that fits it best there is one that fails."""
    job, profile = designed("short-cut")
    figures = []
    for shift in (0.0, 0.0003, 0.1712, job.cut.length - 1e-4):
        moved, notes = aligned(profile.roll(shift), job)
        judged = judge_table(moved, job.task, job.servo)
        assert judged.passed
        assert any("where the axis fits the shear zone best" in note for note in notes) == (shift == 0.1712)
        figures.append([float(check.value or 0.0) for check in judged.checks[1:]])
    assert np.array(figures) == pytest.approx(
        np.broadcast_to(figures[0], np.shape(figures)), rel=1e-4, abs=1e-3 * job.cut.sync_tolerance
    )


def test_a_shaped_cam_for_one_line_speed_stays_where_it_is_in_tolerance() -> None:
    """It was moved by 3 mm to where its axis fits a little better, and was said to be a sixth nearer to the material than it is."""
    job = replace(load_job(EXAMPLES / "short-cut.toml"), slowest=1.0)
    profile = optimise(job).profile
    grid = np.linspace(0.0, 0.999 * job.cut.length, 301)
    moved, (note,) = aligned(profile, job)
    assert np.abs(moved(grid) - profile(grid)).max() < job.cut.sync_tolerance
    assert note.endswith("the own zero of the file is taken")
    # how far it is open is what the naive twin finds: beginnings at which the axis is in tolerance, the slave's zero free
    open_by = 1e-3 * float(note.split("within ")[1].split(" ")[0])
    begins = np.arange(-60, 60) * 5e-4
    errors = np.array([axis_error(profile.roll(begin % job.cut.length), job) for begin in begins.tolist()])
    within = errors <= job.cut.sync_tolerance
    assert within[60]
    first, last = np.flatnonzero(~within[:60])[-1] + 1, 60 + np.flatnonzero(~within[60:])[0] - 1
    assert open_by == pytest.approx(begins[last] - begins[first], abs=1e-3)
    # a file that begins elsewhere is put where it fits best, and told so
    _, (first_note, second_note) = aligned(profile.roll(0.1712), job)
    assert "where the axis fits the shear zone best" in first_note
    assert second_note.endswith("what fits best is taken")


def axis_error(profile: CamProfile, job: Job) -> float:
    """By how much the axis is off the material in the shear zone, the slave's zero where that is least (m)."""
    run, (start, end) = simulate(profile, job.cut, job.servo), shear_zone_of(job.cut)
    x, y = run.master.ravel(), run.axis.ravel()
    cycles = np.floor(x / job.cut.length)
    place, axis = x - cycles * job.cut.length, y - cycles * job.machine.pitch
    off = (axis - place)[(place >= start) & (place <= end)]
    return float(0.5 * np.ptp(off))


@pytest.mark.parametrize("digits", [3, 4, 6])
@pytest.mark.parametrize("points", [121, 361])
@pytest.mark.parametrize("law", ["double_s", "modified_sine"])
def test_the_zero_of_rounded_positions_is_found(law: str, points: int, digits: int) -> None:
    """The last digit shakes the ratio, and so would choose a zero up to 0.3 mm away."""
    profile = baseline(law, JOB.task)
    x = np.linspace(0.0, profile.length, points)
    rows = "".join(f"{1e3 * a:.9f},{1e3 * b:.{digits}f}\n" for a, b in zip(x, profile(x), strict=True))
    found = running_cam("x [mm],y [mm]\n" + rows, "cam.csv", JOB)
    at = np.linspace(0.0, profile.length, 1001)[:-1]
    assert np.abs(found.cycle(at) - profile(at)).max() < 0.02 * JOB.cut.sync_tolerance


def test_the_zero_of_a_normalised_table_is_found() -> None:
    """Its master positions are rounded too: no point stands on the zone's ends to more digits than the file has."""
    x = np.linspace(0.0, PROFILE.length, 361)
    found = running_cam("".join(f"{a / 0.6:.6f},{PROFILE(a) / 0.4:.6f}\n" for a in x.tolist()), "cam.csv", JOB)
    assert np.abs(found.cycle(x[:-1]) - PROFILE(x[:-1])).max() < 0.02 * JOB.cut.sync_tolerance


@pytest.mark.parametrize("unit", ["", "x [mm],y [mm]\n"])
def test_a_slave_that_counts_backwards_is_turned(unit: str) -> None:
    x = np.linspace(0.0, PROFILE.length, 361)
    rows = "".join(f"{1e3 * a!r},{-1e3 * b!r}\n" for a, b in zip(x.tolist(), PROFILE(x).tolist(), strict=True))
    found = running_cam(unit + rows, "cam.csv", JOB)
    assert np.abs(found.cycle(x[:-1]) - PROFILE(x[:-1])).max() < 1e-6
    assert any("the slave runs backwards in the file, -" in note for note in found.notes)
    turned = running_cam(unit + "".join(reversed(rows.splitlines(keepends=True))), "cam.csv", JOB)
    assert np.abs(turned.cycle(x[:-1]) - PROFILE(x[:-1])).max() < 1e-6
    assert any("the rows run backwards along the master" in note for note in turned.notes)


@pytest.mark.parametrize("shift", [0.0, 0.0004, 0.13733, 0.4441])
def test_the_verdict_of_sampled_rows_does_not_depend_on_the_zero(shift: float, tmp_path: Path) -> None:
    profile = baseline("cycloid", JOB.task)
    x = np.linspace(0.0, 0.6, 1201)
    y = profile(x + shift, outside="repeat")
    result = audit(millimetres(tmp_path / "a.csv", (x * 1e3).tolist(), (y * 1e3).tolist()), JOB)
    assert result.judgement.passed == judge_table(profile, JOB.task, JOB.servo).passed
    assert of(result, "sync_position") < 0.1 * JOB.cut.sync_tolerance
    told = [note for note in result.notes if "master zero" in note]
    assert bool(told) == (shift > 0.01)
    if told:
        assert float(told[0].split(" begins ")[1].split(" mm")[0]) == pytest.approx((0.6 - shift) * 1e3, abs=0.25)


@pytest.mark.parametrize(
    ("slopes", "message"),
    [("1", "--slopes takes the start slope and the end slope"), ("a,b", "--slopes takes"), ("1e9,1", "are no ratios")],
)
def test_slopes_that_are_none(slopes: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        with_slopes(make_table([0, 1, 2], [0, 1, 2], law="spline"), slopes)
    with pytest.raises(InputError, match="this table has its slopes, or needs none"):
        with_slopes(make_table([0, 1, 2], [0, 1, 2], law="line"), "1,1")


@pytest.mark.parametrize(
    ("text", "units", "told"),
    [
        (listed("slave [mm]\n", "{:.6f}\n", 361), None, "one column of 361 numbers is taken for slave positions"),
        (
            listed("slave [mm]\n", "{:.6f}\n", 360),
            None,
            "the list ends a step before the cycle, 400 mm beyond its first row",
        ),
        (listed("", "{:.6f},\n", 360), "cycle,mm", "the list ends a step before the cycle"),
        (listed("", "{:.6f}\n", 361), "deg,mm", "one column of 361 numbers"),
        (listed("", "{:.0f}\n", 361, scale=1e4), "cycle,0.0001 mm", "one column of 361 numbers"),
        (listed("Folgeachse (mm)\n", "{:.6f}\n", 360, 123.4).replace(".", ","), None, "unwrapped by that"),
        (listed("", "{:.6f} mm\n", 361, sign=-1.0), None, "its sign was turned"),
    ],
)
def test_a_list_of_the_slave_alone(text: str, units: str | None, told: str) -> None:
    found = running_cam(text, "f.csv", JOB, units=units)
    assert found.judged().passed
    assert any(told in note for note in found.notes)
    x = np.linspace(0.0, 0.6, 901)[:-1]
    assert np.abs(found.cycle(x) - PROFILE(x)).max() < 5e-7


def test_a_list_without_a_unit_asks_for_it() -> None:
    with pytest.raises(
        InputError,
        match="a list of 361 numbers, slave positions at even steps of the master, says no unit; write it above",
    ):
        running_cam(listed("", "{:.6f}\n", 361), "f.csv", JOB)


@pytest.mark.parametrize("shift", [0.0, 0.2345678])
@pytest.mark.parametrize("points", [361, 1441])
@pytest.mark.parametrize(("master", "slave"), [("{:.2f}", "{:.6f}"), ("{:g}", "{:g}"), ("{:.7g}", "{:.7g}")])
def test_the_zero_and_the_verdict_of_coarse_numbers(master: str, slave: str, points: int, shift: float) -> None:
    """Master positions to 0.01 mm, or six digits of both: a ratio of neighbours says nothing, a cam of smooth positions does."""
    x = np.linspace(0.0, 0.6, points)[:-1]
    y = PROFILE(x, outside="repeat")
    order = np.argsort((x + shift) % 0.6)
    at, up = ((x + shift) % 0.6)[order], np.where(x + shift >= 0.6, y - 0.4, y)[order]
    pairs = zip([*at, at[0] + 0.6], [*up, up[0] + 0.4], strict=True)
    text = "x [mm],y [mm]\n" + "".join(f"{master},{slave}\n".format(1e3 * a, 1e3 * b) for a, b in pairs)
    found = running_cam(text, "f.csv", JOB)
    assert {check.name for check in found.judged().checks if not check.passed} <= {
        "closure"
    }  # what the digits make of 10 000 cuts
    x = np.linspace(0.0, 0.6, 901)[:-1]
    assert np.abs(found.cycle(x) - PROFILE(x)).max() < 5e-6
