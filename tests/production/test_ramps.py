"""Starts and stops of jobs: the one-shot cam, its judgement, its tables in every target, its bounds."""

from dataclasses import replace

import numpy as np
import pytest

from camwright.drives.running_cam import running_cam
from camwright.jobs.examples import example
from camwright.jobs.job import Job, load_job
from camwright.production.ramp_tables import KINDS, stretch_of, write_ramps
from camwright.production.ramps import one_shot_cycle, ramps, waiting
from camwright.profiles.errors import InfeasibleError, InputError
from camwright.profiles.line import Line
from camwright.profiles.machines import CrankSlider
from camwright.profiles.servo import Servo
from camwright.profiles.tables.targets import TARGETS
from camwright.validation.servo.response import greatest_shear_zone_error

PAPER = load_job()
CYCLIC = {"twincat-table", "s7-1500t-points", "kollmorgen-kas", "sew"}
"""Targets whose splines close the cycle by themselves: a motion from rest to another speed is none for them."""


def of(name: str, **cut: object) -> Job:
    """Load an example, changed."""
    job = load_job(example(name).path)
    return replace(job, cut=replace(job.cut, **cut))


def crank() -> Job:
    """Give the chasing shear with its place given, so that nothing is designed but the ramps."""
    job = load_job(example("chasing-shear").path)
    return replace(job, machine=job.machine.placed_at(1.7))


JOBS = {
    "paper": PAPER,
    "cut-origin": of("cross-cutter"),
    "saw": of("flying-saw"),
    "horizontal": of("thick-product"),
    "crank": crank(),
}


def test_the_machine_of_the_paper() -> None:
    found = ramps(PAPER)
    assert found.one_shot.length == pytest.approx(0.6, rel=1e-12)
    assert found.one_shot.length == pytest.approx(2 * 0.4 - 0.2, rel=1e-12)  # 2 y_c - l_s
    assert found.peak_acceleration == pytest.approx(9.07177, abs=1e-5)
    assert found.least_sensor * 1e3 == pytest.approx(185.9, abs=0.05)
    assert found.least_sensor == pytest.approx(found.arcs.run_up.master + PAPER.cut.line_speed * 0.01 + 0.1)
    assert found.sensor == pytest.approx(0.2 + PAPER.cut.line_speed * 0.01 + 0.1)
    assert ramps(PAPER, latency=0.0).least_sensor == pytest.approx(found.least_sensor - PAPER.cut.line_speed * 0.01)
    assert found.passed


@pytest.mark.parametrize("name", JOBS)
def test_the_one_shot_is_smooth_from_rest_to_rest(name: str) -> None:
    found = ramps(JOBS[name])
    cam, job = found.one_shot, JOBS[name]
    assert cam(cam.start) == 0.0
    assert cam.advance == pytest.approx(job.machine.pitch, abs=1e-9)
    for order in (0, 1, 2):
        size = cam.peak(order) or 1.0
        assert np.abs(cam.jumps(order, seam=order > 0)).max() <= 2e-8 * size
    assert found.passed, [check.name for check in found.checks if not check.passed]


@pytest.mark.parametrize("name", JOBS)
@pytest.mark.parametrize("aim", ["peak_acceleration", "rms_acceleration", "shortest"])
def test_bounds_are_not_above(name: str, aim: str) -> None:
    found = ramps(JOBS[name], aim=aim)
    values = {"peak_acceleration": "peak_acceleration", "rms_acceleration": "heat", "shortest": "master"}
    for ramp, bound in zip((found.ramp_in, found.ramp_out), found.bounds, strict=True):
        if bound is None:
            assert JOBS[name].machine.turns_back
            assert aim != "peak_acceleration"
            continue
        assert bound <= getattr(ramp, values[aim]) * (1 + 1e-7)
        if JOBS[name].task.straight or aim == "peak_acceleration":
            assert bound == pytest.approx(getattr(ramp, values[aim]), rel=1e-3)


@pytest.mark.parametrize("name", JOBS)
def test_tables_of_every_target_hand_over(name: str) -> None:
    """Each table in its place, rebuilt as the drive does, is judged; what the drive cannot run is withheld."""
    found = ramps(JOBS[name])
    tables = write_ramps(found, list(TARGETS), required=False)
    for kind in KINDS:
        taken = {result.target.name for result in tables.results[kind]}
        assert taken | set(tables.refused[kind]) == set(TARGETS)
        for result in tables.results[kind]:
            assert bool(result.files) == result.passed
            for file in result.files:
                assert file.startswith(kind)
            if result.files:
                refused_by_audit(list(result.files.items()), found.job)
    released = {kind: {each.target.name for each in tables.results[kind] if each.passed} for kind in KINDS}
    for kind in ("ramp_in", "ramp_out"):
        assert not released[kind] & CYCLIC
        assert {"codesys", "twincat", "csv", "s7-1500t", "pacdrive", "logix"} <= released[kind]
    assert {"codesys", "twincat", "csv", "s7-1500t", "logix"} <= released["one_shot"]
    if JOBS[name].machine.slave_unit == "m" and JOBS[name].task.straight:
        # the IDE of the one that is left out takes no cam that comes back below its start
        assert released["one_shot"] >= CYCLIC - ({"kollmorgen-kas"} if JOBS[name].machine.turns_back else set())


def refused_by_audit(files: list[tuple[str, str]], job: Job) -> None:
    """See that an audit, which judges cycles, names a table that runs once: by its own head or by that of the text beside it."""
    (name, text), (beside, head) = [*files, ("", "")][:2]
    with pytest.raises(
        InputError, match="the table runs once, between rest and a cam or from one cam into another; audit judges"
    ):
        running_cam(text, name, job, head=head)
    if beside:
        with pytest.raises(InputError, match="this is the text beside a table, not the table"):
            running_cam(head, beside, job)


def test_a_table_that_hands_over_badly_is_withheld() -> None:
    """A start that is a micrometre too fast at the end is seen."""
    found = ramps(PAPER)
    cam = found.start_table
    judge = stretch_of(found, "ramp_in", cam).judge
    assert judge(cam, 0.0).passed
    assert not judge(cam.scale(slave=1.003), 0.0).passed


def test_where_the_running_cam_begins_at_the_cut_so_the_tables_end_there() -> None:
    found = ramps(JOBS["cut-origin"])
    half = 0.5 * found.job.cut.sync_zone
    assert found.start_table.length == pytest.approx(found.ramp_in.master + half)
    assert found.stop_table.length == pytest.approx(found.ramp_out.master + half)
    assert float(found.start_table(found.start_table.end, 1, side="left")) == pytest.approx(1.0)
    assert float(found.stop_table(0.0, 1)) == pytest.approx(1.0)
    assert float(found.stop_table(0.0)) == 0.0


def test_the_wait_is_longer_than_the_servo_remembers() -> None:
    found = ramps(PAPER)
    short, long = waiting(PAPER), 3 * waiting(PAPER)
    errors = []
    for wait in (short, long):
        cycle, task = one_shot_cycle(found.stand, found.one_shot, found.zone_end, wait)
        errors.append(greatest_shear_zone_error(cycle, task, PAPER.servo))
    assert errors[0] == pytest.approx(errors[1], rel=1e-6)


def test_an_unstable_servo_fails_and_does_not_stop_the_design() -> None:
    job = replace(PAPER, servo=Servo(120.0, 0.7, 500.0, 0.004, 1.0))
    found = ramps(job)
    assert not found.passed
    assert "servo_stability" in [check.name for check in found.checks if not check.passed]


def test_a_slow_servo_is_not_in_sync_from_rest() -> None:
    job = replace(PAPER, servo=replace(PAPER.servo, position_gain=4.0, velocity_feedforward=0.0))
    assert "shear_zone_error" in [check.name for check in ramps(job).checks if not check.passed]


def test_a_crank_of_free_place_starts_where_the_running_cam_has_its_zone() -> None:
    job = load_job(example("chasing-shear").path)
    job = replace(job, objective="rms_acceleration")
    found = ramps(job)
    assert isinstance(found.job.machine, CrankSlider)
    assert found.job.machine.placed


def test_a_shaped_command_starts_into_its_own_zone() -> None:
    """The zone of a shaped command is that of the running cam, and the axis from rest is judged for itself."""
    job = load_job(example("short-cut").path)
    found = ramps(replace(job, slowest=1.0, servo_tolerance=None))
    zone = found.stand.zone
    assert np.abs(zone(np.linspace(zone.start, zone.end, 9), 1) - 1.0).max() > 1e-3  # not in sync: shaped
    cam = found.one_shot
    assert np.abs(cam.jumps(1)).max() <= 1e-7
    task, middle = found.job.task, job.cut.shear_zone_at + 0.5 * job.cut.shear_zone
    assert (
        abs(float(zone(middle)) - task.slave_at_sync_start - middle) < 0.005
    )  # there the axis is in sync, so the command is near


def test_no_start_is_refused_with_what_works() -> None:
    with pytest.raises(InfeasibleError, match="What works, each alone, tried") as caught:
        ramps(PAPER, park=-0.11)
    assert [each.change for each in caught.value.suggestions] == ["park", "line_speed"]


def test_a_target_that_takes_none_is_a_fault() -> None:
    """Where a drive takes whole periods, 136.296296… mm are none."""
    with pytest.raises(InputError, match=r"br: .*whole"):
        write_ramps(ramps(PAPER, aim="shortest"), ["br"])


@pytest.mark.parametrize("aim", ["peak_acceleration", "rms_acceleration", "shortest"])
@pytest.mark.parametrize(
    ("name", "line"),
    [
        ("paper", Line(1.0, 2.0, 10.0)),
        ("paper", Line(5.0, 5.0, 50.0)),
        ("saw", Line(0.2, 0.5, 2.0)),
        ("horizontal", Line(1.0, 2.0, 10.0)),
    ],
)
def test_a_line_that_ramps_is_borne_by_start_and_stop(name: str, line: Line, aim: str) -> None:
    found = ramps(replace(JOBS[name], line=line), aim=aim)
    assert found.passed, [check.name for check in found.checks if not check.passed]
    assert "line_ramp" in [check.name for check in found.checks]
    steady = ramps(JOBS[name], aim=aim)
    if aim == "peak_acceleration":  # it costs next to nothing
        assert (
            steady.ramp_in.peak_acceleration
            <= found.ramp_in.peak_acceleration
            <= 1.0015 * steady.ramp_in.peak_acceleration
        )
    assert found.fastest <= steady.fastest
