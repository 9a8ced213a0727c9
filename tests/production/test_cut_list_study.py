"""Cut lists worked out: cams, changes, transitions, plans, seams, and what the servo makes of them."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from camwright.design.production.transition import RunningCam, transition_speed
from camwright.drives.running_cam import running_cam
from camwright.jobs.job import Job, load_job
from camwright.production.changes import find_changes
from camwright.production.common_place import placed_alike
from camwright.production.cut_list import ListStudy, line_of, plan_list, study_list
from camwright.production.list_answer import list_answer, list_files
from camwright.production.list_checks import require_running
from camwright.production.list_file import parse_cut_list, parse_line_run
from camwright.profiles.cut_list import CutList, ListRow
from camwright.profiles.errors import InfeasibleError, InputError
from tests.pace import in_time

EXAMPLES = Path(__file__).parents[2] / "examples"
THE_LIST = CutList((ListRow(0.6, 3, line=1), ListRow(0.3, 3, line=2), ListRow(0.6, 3, line=3)))


def study(job: Job, asked: CutList, targets: tuple[str, ...] = ("csv",), ramp: float = 1.0) -> ListStudy:
    return study_list(line_of(job, ramp), asked, targets)


@pytest.fixture(scope="module")
def known() -> ListStudy:
    return study(load_job(), THE_LIST, ("csv", "codesys", "logix"))


def test_the_answer_of_the_published_list(known: ListStudy) -> None:
    answer = list_answer(known)
    assert (answer["pieces"], answer["cams"], answer["transitions"], answer["scrap_mm"]) == (9, 2, 0, 0.0)
    assert answer["time_s"] == pytest.approx(4.051, abs=5e-4)
    assert answer["time_at_slowest_s"] == pytest.approx(5.666, abs=5e-4)
    assert [(cell["from"], cell["to"], cell["how"]) for cell in answer["matrix"]] == [
        (1, 2, "slow_down"),
        (2, 1, "direct"),
    ]


def test_cams_bear_the_ramp_where_it_is_made(known: ListStudy) -> None:
    assert [cam.bears_ramps for cam in known.planned.cams] == [True, False]  # the short one runs at a steady line only
    assert known.passed
    ramping = plan_list(line_of(load_job(), 1.0), CutList((ListRow(0.3), ListRow(0.302), ListRow(0.6))))
    plain = plan_list(load_job(), CutList((ListRow(0.3), ListRow(0.302))), known.planned.line)
    assert ramping.cams[1].bears_ramps
    assert ramping.cams[1].line_speed < plain.cams[1].line_speed  # its highest leaves no room for a ramp


def test_tables_of_cams_in_sync_meet_in_float64_and_to_their_rounding_in_float32(known: ListStudy) -> None:
    for table in known.tables:
        exact = table.number_format == "float64"
        assert table.jump.position < 1e-12
        assert table.jump.velocity < (1e-12 if exact else 1e-6)
        assert table.jump.acceleration < (1e-9 if exact else 0.01)
        assert table.within
        assert not table.withheld


def test_the_servo_is_off_where_the_line_ramps(known: ListStudy) -> None:
    off = known.run.sync_errors > known.planned.job.cut.sync_tolerance
    assert np.flatnonzero(off).tolist() == [2, 6]  # the last piece before the short ones, and the first after
    assert known.off == 2


def test_files_for_the_controller(known: ListStudy) -> None:
    files = list_files(known)
    rows = [line.split(",") for line in files["cut-list.csv"].splitlines() if line[:1].isdigit()]
    assert [row[0] for row in rows] == [str(k) for k in range(1, 10)]
    assert [row[3] for row in rows] == list("111222111")
    for row, highest in zip(rows, known.planned.highest.tolist(), strict=True):
        assert float(row[5]) / 60 <= highest
        assert float(row[5]) / 60 == pytest.approx(highest, abs=1e-6)
    again = parse_line_run(files["line-speed.csv"], "plan")
    assert again.time == pytest.approx(known.planned.line.time, rel=1e-12)


def test_crops_and_skips() -> None:
    asked = parse_cut_list("200 mm,1,skip\n300 mm,1,crop\n600 mm,2\n", "L")
    found = plan_list(line_of(load_job(), 0.5), asked)
    assert [cam.length for cam in found.cams] == pytest.approx([0.5, 0.6])
    assert asked.scrap == pytest.approx(0.5)
    assert found.line.length == pytest.approx(1.7)


def test_a_ramp_that_is_a_small_part_of_the_limits_is_borne_but_for_rounding() -> None:
    """The jerk limit is exceeded by 5e-10, which in terms of so gentle a ramp is a millionth."""
    found = plan_list(
        line_of(load_job(EXAMPLES / "cross-sealer.toml"), 0.3), CutList((ListRow(0.25, 1), ListRow(0.9, 1)))
    )
    assert all(cam.bears_ramps and cam.report.passed for cam in found.cams)
    checks = [check for cam in found.cams for check in cam.report.checks if check.name == "line_ramp"]
    assert all(check.limit == pytest.approx(0.3, rel=1e-5) for check in checks)


def test_a_plan_without_a_stated_ramp_is_refused() -> None:
    with pytest.raises(InputError, match="how hard the line ramps is not stated"):
        line_of(load_job(), None)
    assert line_of(load_job(), 0.3).line.acceleration == 0.3


def test_lengths_without_room_for_the_zone_are_refused_by_line() -> None:
    with pytest.raises(InputError) as caught:
        study(load_job(), CutList((ListRow(0.6, 1, line=2), ListRow(0.2, 1, line=3), ListRow(0.15, 1, line=5))))
    assert [fault.split(":")[0] for fault in caught.value.faults] == ["cut list, line 3", "cut list, line 5"]


def test_more_lengths_than_a_list_may_have_are_refused() -> None:
    many = CutList(tuple(ListRow(0.3 + 1e-4 * k) for k in range(301)), "order.csv")
    with pytest.raises(
        InputError, match=r"order\.csv: 301 different gaps between cuts, the limit is 300; round the lengths, or split"
    ):
        study(load_job(), many)


def test_the_origin_of_the_job_does_not_matter() -> None:
    job = load_job()
    other = plan_list(line_of(replace(job, cut=replace(job.cut, origin="cut")), 1.0), THE_LIST)
    same = plan_list(line_of(job, 1.0), THE_LIST)
    for one, two in zip(other.cams, same.cams, strict=True):
        assert one.solution.profile.breaks == pytest.approx(two.solution.profile.breaks)


def test_zones_that_last_a_time_are_the_same_for_all_cams() -> None:
    found = study(load_job(EXAMPLES / "flying-punch.toml"), CutList((ListRow(0.75, 2), ListRow(0.6, 2))))
    assert len({cam.job.cut.sync_zone for cam in found.planned.cams}) == 1
    assert found.planned.cams[1].line_speed < found.planned.cams[0].line_speed
    assert [change.how for change in found.planned.changes.values()] == ["slow_down", "direct"]
    assert found.passed


def crank() -> Job:
    job = load_job(EXAMPLES / "chasing-shear.toml")
    return replace(job, objective="peak_acceleration")


def test_cranks_that_lie_elsewhere_go_through_transitions_or_share_a_place() -> None:
    asked = CutList((ListRow(0.9, 2), ListRow(0.5, 2), ListRow(0.9, 1)))
    job = crank()
    own = study(job, asked)
    changes = own.planned.changes
    places = {cam.job.machine.place for cam in own.planned.cams}
    assert len(places) == 2
    assert [change.how for change in changes.values()] == ["transition", "transition"]
    assert all(change.jump.position > 1e-5 for change in changes.values())
    assert all(all(each.passed for each in change.transitions) for change in changes.values())
    assert own.tables[0].jump.position < 1e-9  # through the transitions' tables nothing steps
    assert own.tables[0].jump.velocity < 1e-9
    assert own.off == 0
    place = placed_alike(line_of(job, 1.0), asked)
    assert place.found is not None
    assert place.found.compared == 2
    assert place.found.cost >= 0.0
    alike = study(place.job, asked)
    assert [change.how for change in alike.planned.changes.values()] == ["direct", "direct"]
    worst = max(
        one.solution.minimised / other.solution.minimised - 1.0
        for one, other in zip(alike.planned.cams, own.planned.cams, strict=True)
    )
    assert place.found.cost == pytest.approx(worst, abs=1e-3)


def test_targets_that_close_a_cycle_by_themselves_do_not_take_a_transition() -> None:
    found = study(crank(), CutList((ListRow(0.9, 1), ListRow(0.5, 1))), ("twincat", "twincat-table", "kollmorgen-kas"))
    exact, closing, scaled = found.tables
    assert exact.passed
    assert {"T001 to 002"} <= {name.partition("_K")[0].replace("_", " ") for name in exact.files}
    name, text = next(each for each in exact.files.items() if each[0].startswith("T001"))
    with pytest.raises(
        InputError, match=r"the table runs once, .* or from one cam into another; audit judges a cam's cycles"
    ):
        running_cam(text, name, crank())
    assert not closing.passed
    assert closing.jump.velocity > 1e-3
    assert [fault.partition(":")[0] for fault in scaled.refused] == ["T001 to 002"]
    assert not found.passed
    rows = [line.split(",") for line in list_files(found)["cut-list.csv"].splitlines() if line[:1].isdigit()]
    assert [row[4] for row in rows] == ["", "T001 to 002"]


def test_nothing_is_placed_where_nothing_is_free() -> None:
    place = placed_alike(line_of(load_job(), 1.0), THE_LIST)
    assert place.found is None
    assert place.words() == "the sync zone lies at one place for all lengths already"


@pytest.mark.slow
def test_shaped_commands_do_not_meet_and_go_through_transitions_on_a_slower_line() -> None:
    job = load_job(EXAMPLES / "short-cut.toml")
    asked = CutList((ListRow(0.3, 2), ListRow(0.29, 2)))
    found = study(job, asked, ramp=0.2)
    change = found.planned.changes[1, 2]
    assert change.jump.velocity > 0.05
    assert change.how == "transition"
    assert change.line_speed < job.cut.line_speed
    assert found.tables[0].jump.velocity < 1e-6


def test_shaped_commands_without_a_transition_change_through_a_cycle_in_sync(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing leads from shaped to shaped at once here: a cycle that ends in sync comes between, and two pieces are needed."""

    def none_between_shaped(before: RunningCam, after: RunningCam) -> float | None:
        return None if before.task.cut.shaped and after.task.cut.shaped else transition_speed(before, after)

    monkeypatch.setattr("camwright.production.changes.transition_speed", none_between_shaped)
    job = replace(load_job(EXAMPLES / "short-cut.toml"), slowest=1.0)
    found = study(job, CutList((ListRow(0.3, 2), ListRow(0.29, 3))), ramp=0.2)
    change = found.planned.changes[1, 2]
    assert (change.how, len(change.transitions), change.jump.velocity > 0.05) == ("sync_cycle", 2, True)
    assert found.planned.changes[2, 1].how == "sync_cycle"  # not made by the list
    into, out = (each.profile for each in change.transitions)
    task = found.planned.cams[1].job.task
    assert float(into(into.end, 1)) == pytest.approx(task.cut.sync_ratio, abs=1e-12)
    assert float(into(into.end, 2)) == pytest.approx(0.0, abs=1e-12)
    assert float(out(out.start, 1)) == pytest.approx(task.cut.sync_ratio, abs=1e-12)
    assert found.tables[0].passed
    assert found.tables[0].jump.velocity < 1e-6
    assert (found.planned.highest[2:4] == change.line_speed).all()
    rows = [line.split(",") for line in list_files(found)["cut-list.csv"].splitlines() if line[:1].isdigit()]
    assert [row[4] for row in rows] == ["", "", "T001 to 002a", "T001 to 002b", ""]
    assert {"T001 to 002a", "T001 to 002b"} <= {
        name.partition("_K")[0].replace("_", " ")[:12] for name in found.tables[0].files
    }
    cams, alone = found.planned.cams, np.array([0, 0, 1])
    changes = find_changes(cams, alone, "rms_acceleration")
    assert changes[1, 2].how == "stop"
    with pytest.raises(
        InfeasibleError, match=r"line 8: from 300 mm to 290 mm .* let two pieces at least follow, let the"
    ):
        require_running(job, CutList((ListRow(0.3, 2, line=7), ListRow(0.29, 1, line=8))), alone, changes, cams)


def test_a_change_that_needs_a_stop_is_refused_with_a_way_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("camwright.production.changes.transition_speed", lambda *_cams: None)
    with pytest.raises(
        InfeasibleError,
        match=r"cut list, line 7: from 900 mm to 500 mm no motion .* --common-place, or \[machine\] sync_at",
    ):
        study(crank(), CutList((ListRow(0.9, 1, line=6), ListRow(0.5, 1, line=7))))


def test_a_thousand_pieces_of_fifty_lengths_in_ten_seconds() -> None:
    draw = np.random.default_rng(3)
    lengths = np.round(np.linspace(0.3, 1.2, 50), 4)
    asked = CutList(tuple(ListRow(float(draw.choice(lengths))) for _ in range(1000)))
    begun = time.process_time()
    found = study(load_job(), asked)
    assert in_time(time.process_time() - begun, 10.0)
    assert len(found.planned.cams) == 50
    assert {change.how for change in found.planned.changes.values()} == {"direct", "slow_down"}
    assert found.tables[0].jump.velocity < 1e-12
