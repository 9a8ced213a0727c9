"""Bridges: where they are placed, cut, listed and refused."""

import csv
import io
import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camwright.bender.job import BUNDLED_BENDER
from camwright.cli.main import main
from camwright.profiles.bender.bridges import BridgeRule, bridge_places, place_bridges, with_cuts
from camwright.profiles.bender.division import FewestBends
from camwright.profiles.bender.nc_code import Numbering, read_program, write_program
from camwright.profiles.bender.outline import Outline
from camwright.profiles.bender.plan import BendPlan, plan_bends
from camwright.profiles.bender.program import NcProgram
from camwright.profiles.errors import InputError
from camwright.validation.bender.bridges import prove_bridges

Make = Callable[..., Path]
STEP = [(0, 0), (100, 0), (100, 80), (160, 80)]
"""Sides of 100, 80 and 60 mm."""


def plan_of(points: list[tuple[float, float]], bulges: list[float] | None = None) -> BendPlan:
    turns = np.zeros(len(points) - 1) if bulges is None else np.array(bulges)
    return plan_bends(Outline(1e-3 * np.array(points, dtype=float), turns, "STEP"), FewestBends(5e-5), least_turn=1e-4)


def run(capsys: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, dict[str, Any], str]:
    code = main(["bend", *map(str, arguments), "--json"])
    out, err = capsys.readouterr()
    return code, json.loads(out) if code < 2 else {}, err + out


def job_with(tmp_path: Path, table: str, name: str = "bender.toml") -> Path:
    path = tmp_path / name
    path.write_text(BUNDLED_BENDER.read_text(encoding="utf-8") + table, encoding="utf-8")
    return path


def test_a_spacing_begins_half_a_spacing_from_the_start():
    bridges = place_bridges(plan_of(STEP), BridgeRule(width=6e-3, spacing=50e-3))
    assert [1e3 * bridge.middle for bridge in bridges] == pytest.approx([25, 75, 125, 175, 225])
    assert [bridge.side for bridge in bridges] == [0, 0, 1, 1, 2]
    assert [1e3 * bridge.from_bend for bridge in bridges] == pytest.approx([25, 75, 25, 75, 45])
    assert all(abs(bridge.moved) < 1e-12 for bridge in bridges)


def test_a_bridge_of_a_spacing_moves_off_a_bend_to_the_nearest_place():
    # the third would lie on the bend at 180 mm: 3 mm half width and 2 mm for the tool leave 175 or 185 mm
    bridges = place_bridges(plan_of(STEP), BridgeRule(width=6e-3, spacing=72.4e-3))
    assert [1e3 * bridge.middle for bridge in bridges] == pytest.approx([36.2, 105.0 + 3.6, 185.0])
    assert 1e3 * bridges[2].moved == pytest.approx(4.0)


def test_a_rule_shorter_than_half_a_spacing_has_none():
    assert place_bridges(plan_of([(0, 0), (40, 0)]), BridgeRule(width=6e-3, spacing=100e-3)) == ()


@pytest.mark.parametrize(
    ("rule", "message"),
    [
        (BridgeRule(6e-3, at=(0.1,)),
         ("STEP: bridge 1 of 6 mm at 100.000 mm along the rule: it lies on bend 1 at (100.000, 0.000) mm, and the tool needs "
         "2 mm; it may go to 95.000 mm or 105.000 mm")),
        (BridgeRule(6e-3, at=(0.05, 0.176)),
         ("STEP: bridge 2 of 6 mm at 176.000 mm along the rule: its edge is 1.000 mm from bend 2 at (100.000, 80.000) mm, and "
         "the tool needs 2 mm; it may go to 175.000 mm or 185.000 mm")),
        (BridgeRule(6e-3, at=(0.001,)),
         ("STEP: bridge 1 of 6 mm at 1.000 mm along the rule: it lies on the start at (0.000, 0.000) mm, and the tool needs "
         "2 mm; it may go to 5.000 mm")),
        (BridgeRule(6e-3, at=(0.239,)),
         ("STEP: bridge 1 of 6 mm at 239.000 mm along the rule: it lies on the end at (160.000, 80.000) mm, and the tool needs "
         "2 mm; it may go to 235.000 mm")),
        (BridgeRule(6e-3, at=(0.3,)),
         "STEP: bridge 1 of 6 mm at 300.000 mm along the rule: the rule is 240.000 mm long; it may go to 235.000 mm"),
        (BridgeRule(6e-3, at=(0.05, 0.055)),
         ("STEP: bridge 2 of 6 mm at 55.000 mm along the rule: it is nearer than 2 mm to the bridge before it; it may go to "
         "58.000 mm")),
        (BridgeRule(6e-3, at=(0.05,), command="M20", tool_distance=0.06),
         ("STEP: bridge 1 of 6 mm at 50.000 mm along the rule: the cutting tool stands 60 mm before the bending place, where "
         "the rule begins; it may go to 60.000 mm")),
        (BridgeRule(0.2, at=(0.05,)),
         ("STEP: bridge 1 of 200 mm at 50.000 mm along the rule: it lies on the start at (0.000, 0.000) mm, and the tool needs "
         "2 mm; no place of this rule is free for it; make bridges narrower or fewer")),
        (BridgeRule(6e-6, spacing=2e-5),
         "STEP: a spacing of 0.02 mm makes 12000 bridges along 240.000 mm of rule, more than 10000; lengthen the spacing"),
    ],
)  # fmt: skip
def test_refusals_say_where_a_bridge_may_go(rule: BridgeRule, message: str):
    with pytest.raises(InputError) as caught:
        place_bridges(plan_of(STEP), rule)
    assert caught.value.faults == (message,) or list(caught.value.faults) == [message]


def test_a_way_out_is_one(tmp_path: Path):
    for wanted in (0.1, 0.178, 0.001, 0.239):
        with pytest.raises(InputError) as caught:
            place_bridges(plan_of(STEP), BridgeRule(6e-3, at=(wanted,)))
        places = str(caught.value).split("it may go to ")[1].replace(" mm", "").split(" or ")
        for place in places:
            assert place_bridges(plan_of(STEP), BridgeRule(6e-3, at=(1e-3 * float(place),)))


@given(
    sides=st.lists(st.tuples(st.floats(4, 200), st.floats(-90, 90)), min_size=1, max_size=12),
    spacing=st.floats(20, 150),
    width=st.floats(1, 12),
    bulge=st.floats(-0.5, 0.5),
)
def test_bridges_keep_clear_and_lengths_are_conserved(
    sides: list[tuple[float, float]], spacing: float, width: float, bulge: float
):
    way, points = 0.0, [(0.0, 0.0)]
    for length, turn in sides:
        points.append((points[-1][0] + length * math.cos(way), points[-1][1] + length * math.sin(way)))
        way += math.radians(turn)
    plan = plan_of(points, [bulge if abs(bulge) > 0.05 else 0.0, *[0.0] * (len(sides) - 1)])
    rule = BridgeRule(1e-3 * width, 1e-3 * spacing, command="M20")
    try:
        bridges = place_bridges(plan, rule)
    except InputError as error:
        told = str(error)
    else:
        told = ""
    if told:
        assert "it may go to" in told or "no place of this rule is free" in told
        return
    marks = np.concatenate([[0.0], np.cumsum(plan.feeds)])
    middles = np.array([bridge.middle for bridge in bridges])
    for middle in middles:  # the naive twin: every bend, one by one
        assert min(abs(middle - mark) for mark in marks) >= rule.width / 2 + rule.clearance - 1e-8
    assert (np.diff(middles) >= rule.width + rule.clearance - 1e-8).all()
    feeds = np.round(1e6 * plan.feeds).astype(np.int64)
    plain = NcProgram("P", feeds, np.full(plan.bends, 45_000))
    program = with_cuts(plain, bridges, rule)
    text = write_program(program, "fagor", Numbering(10, 40), 30_000.0, "M20")
    read = read_program(text, "P", "M20")
    assert (read.feeds == plain.feeds).all()  # what is fed between bends is what was fed without bridges
    assert read.rule_length == plain.rule_length
    assert read.cuts.tolist() == program.cuts.tolist()
    numbers = Numbering(10, 40).numbers(read.blocks)
    lines = [line for line in text.splitlines() if line.startswith("N")][3:-1]
    assert len(lines) == read.blocks
    assert [lines[k] for k in read.cut_blocks()] == [f"N{numbers[k]:03d} M20" for k in read.cut_blocks()]
    assert all(" G90 Y45.000" in lines[k] for k in read.bend_blocks())
    proof = prove_bridges(read, bridges, rule)
    if bridges:
        assert proof is not None
        assert proof.gap >= rule.clearance - 2e-6
        assert proof.shift <= 1e-6
    else:
        assert proof is None


def test_the_tool_s_distance_is_fed_before():
    plan = plan_of(STEP)
    rule = BridgeRule(6e-3, at=(0.05, 0.14), command="M20", tool_distance=0.04)
    bridges = place_bridges(plan, rule)
    program = with_cuts(NcProgram("P", np.array([100_000, 80_000, 60_000]), np.array([90_000, -90_000])), bridges, rule)
    assert program.cuts.tolist() == [10_000, 100_000]
    text = write_program(program, "fagor", Numbering(), 30_000.0, "M20")
    assert text.splitlines()[4:] == [
        "N010 G01 G91 X10.000", "N011 M20", "N012 G01 G91 X90.000", "N013 M20", "N014 G01 G90 Y90.000", "N015 G01 G90 Y0.0",
        "N016 G01 G91 X80.000", "N017 G01 G90 Y270.000", "N018 G01 G90 Y0.0", "N019 G01 G91 X60.000", "N020 M30",
    ]  # fmt: skip
    assert prove_bridges(read_program(text, "P", "M20"), bridges, rule).shift == pytest.approx(0, abs=1e-12)


def test_a_cut_elsewhere_is_seen():
    plan = plan_of(STEP)
    rule = BridgeRule(6e-3, at=(0.05,), command="M20")
    bridges = place_bridges(plan, rule)
    plain = NcProgram("P", np.array([100_000, 80_000, 60_000]), np.array([90_000, -90_000]))
    wrong = replace(plain, cuts=np.array([96_000]))
    proof = prove_bridges(wrong, bridges, rule)
    assert proof.shift == pytest.approx(46e-3)
    assert proof.gap == pytest.approx(1e-3)
    with pytest.raises(ValueError, match="0 cuts for 1 bridges"):
        prove_bridges(plain, bridges, rule)
    with pytest.raises(InputError, match="one after the other"):
        replace(plain, cuts=np.array([300_000]))
    assert bridge_places(plain, bridges).tolist() == [50_000]


def test_cuts_are_read_only_where_the_job_names_the_command():
    text = "%P\nN001 G71\nN010 G01 G91 X10.000\nN011 M20\nN012 G01 G91 X5.000\nN013 M30\n"
    assert read_program(text, "p", "M20").cuts.tolist() == [10_000]
    for command in (None, "M21"):
        with pytest.raises(InputError, match="line 4: 'N011 M20' is not a header"):
            read_program(text, "p", command)


def test_bridges_by_option_are_cut_by_hand(drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    path = drawing(lambda m, _: m.add_lwpolyline(STEP))
    more = ("--out", tmp_path / "out", "--no-figures")
    code, plain, _ = run(capsys, path, *more)
    text = Path(plain["program"]).read_text()
    assert code == 0
    assert plain["bridges"] == []
    code, answer, _ = run(capsys, path, *more, "--bridges", "6@72.4")
    assert code == 0
    assert answer["length_mm"] == plain["length_mm"]
    assert Path(answer["program"]).read_text() == text
    assert answer["bridge_command"] is None
    assert [(b["after_bend"], b["from_mm"], b["to_mm"], b["line"]) for b in answer["bridges"]] == [
        (0, pytest.approx(33.2), pytest.approx(39.2), None),
        (1, pytest.approx(5.6), pytest.approx(11.6), None),
        (2, pytest.approx(2.0), pytest.approx(8.0), None),
    ]
    assert {check["name"] for check in answer["checks"]} >= {"bridge_clearance", "bridge_place"}
    assert ("DRAWING: 1 of 3 bridges are moved along the rule to stay clear of bends and ends, the one at 185.000 mm by "
            "4.000 mm") in answer["warnings"]  # fmt: skip
    rows = list(csv.DictReader(io.StringIO((tmp_path / "out" / "drawing-bends.csv").read_text())))
    assert [row["bridges_mm"] for row in rows] == ["33.200-39.200", "5.600-11.600", "2.000-8.000"]
    assert [row["cut_lines"] for row in rows] == ["", "", ""]


def test_bridges_by_job_are_cut_by_the_machine(drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    path = drawing(lambda m, _: m.add_lwpolyline(STEP))
    job = job_with(tmp_path, '\n[bridges]\nwidth = "6 mm"\nat = ["50 mm", "70 mm", "140 mm"]\ncommand = "M20"\n')
    code, answer, _ = run(capsys, path, "--job", job, "--out", tmp_path / "out", "--no-figures")
    assert code == 0
    lines = Path(answer["program"]).read_text().splitlines()
    cut = [line.split()[0] for line in lines if line.endswith(" M20")]
    assert [bridge["line"] for bridge in answer["bridges"]] == cut
    assert len(cut) == 3
    fed = sum(float(line.split("X")[1]) for line in lines if " G91 X" in line)
    assert fed == pytest.approx(answer["length_mm"], abs=1e-9) == 240.0
    rows = list(csv.DictReader(io.StringIO((tmp_path / "out" / "drawing-bends.csv").read_text())))
    assert [row["bridges_mm"] for row in rows] == ["47.000-53.000;67.000-73.000", "37.000-43.000", ""]
    assert [row["cut_lines"] for row in rows] == [f"{cut[0]};{cut[1]}", cut[2], ""]
    bent = [line.split()[0] for line in lines if " G90 Y" in line and not line.endswith("Y0.0")]
    assert [row["line"] for row in rows[:-1]] == bent


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ('width = "6 mm"\nspacing = "90 mm"\nat = ["50 mm"]', "spacing, at and layer exclude each other"),
        ('spacing = "90 mm"', "width is missing"),
        ('width = "6 mm"', "spacing is missing"),
        ('width = "6 mm"\nspacing = "0 mm"', "spacing"),
        ('width = "6"\nspacing = "90 mm"', "width"),
        ('width = "6 mm"\nat = ["-5 mm"]', "at"),
        ('command = "M30"', "M30 stop the program"),
        ('command = "G01"', "not a cut command"),
        ('depth = "6 mm"', "depth"),
    ],
)
def test_tables_that_are_refused(
    drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str], table: str, message: str
):
    path = drawing(lambda m, _: m.add_lwpolyline(STEP))
    job = job_with(tmp_path, f"\n[bridges]\n{table}\n")
    code, _, err = run(capsys, path, "--job", job, "--out", tmp_path / "out", "--no-figures")
    assert code == 2
    assert "[bridges]" in err
    assert message in err


@pytest.mark.parametrize("text", ["6", "6@", "@100", "6@4", "0@100", "nan@100", "6@inf", "6@100@3", "6 mm@100"])
def test_options_that_are_refused(drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str):
    path = drawing(lambda m, _: m.add_lwpolyline(STEP))
    code, _, err = run(capsys, path, "--out", tmp_path / "out", "--no-figures", "--bridges", text)
    assert code == 2
    assert "write two numbers in mm, e.g. --bridges 6@100" in err


def test_places_belong_to_one_rule(drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    def draw(m: Any, _: Any) -> None:
        m.add_lwpolyline(STEP)
        m.add_lwpolyline([(0, 200), (100, 200)])

    job = job_with(tmp_path, '\n[bridges]\nwidth = "6 mm"\nat = ["50 mm"]\n')
    code, _, err = run(capsys, drawing(draw), "--job", job, "--out", tmp_path / "out", "--no-figures")
    assert code == 2
    assert "[bridges] at names places along one rule, and the drawing has 2; write spacing instead" in err


def test_an_arc_takes_bridges_only_between_its_bends(drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    # 20 mm of radius: the bends are nearer than the bridge and its tool need
    path = drawing(lambda m, _: m.add_circle((0, 0), 20))
    code, _, err = run(capsys, path, "--out", tmp_path / "out", "--no-figures", "--bridges", "6@60")
    assert code == 2
    assert "no place of this rule is free for it" in err


def test_bridges_by_marks_of_a_layer(drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    def draw(m: Any, _: Any) -> None:
        m.add_lwpolyline(STEP)
        m.add_lwpolyline([(0, 200), (100, 200)])
        m.add_point((100, 40), dxfattribs={"layer": "Bridges"})
        m.add_line((47, 0), (53, 0), dxfattribs={"layer": "Bridges"})  # drawn along the rule
        m.add_line((30, 195), (30, 205), dxfattribs={"layer": "Bridges"})  # drawn across it
        m.add_text("6 mm", dxfattribs={"layer": "Bridges"})

    job = job_with(tmp_path, '\n[bridges]\nwidth = "6 mm"\nlayer = "BRIDGES"\ncommand = "M20"\n')
    code, answer, _ = run(capsys, drawing(draw), "--job", job, "--out", tmp_path / "out", "--no-figures")
    assert code == 0
    assert answer["outlines"] == 2
    assert [(b["program"], b["middle_mm"]) for b in answer["bridges"]] == [
        ("DRAWING-1", 50.0), ("DRAWING-1", 140.0), ("DRAWING-2", 30.0),
    ]  # fmt: skip
    assert any("TEXT (no mark of a bridge: draw a point or a line)" in text for text in answer["warnings"])


def test_a_layer_without_marks_is_told(drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    job = job_with(tmp_path, '\n[bridges]\nwidth = "6 mm"\nlayer = "BRIDGES"\n')
    path = drawing(lambda m, _: m.add_lwpolyline(STEP))
    code, answer, _ = run(capsys, path, "--job", job, "--out", tmp_path / "out", "--no-figures")
    assert code == 0
    assert answer["bridges"] == []
    assert "no bridge is marked: layer BRIDGES holds no point and no line" in answer["warnings"]


def test_a_mark_beside_every_rule_is_refused(drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    def draw(m: Any, _: Any) -> None:
        m.add_lwpolyline(STEP)
        m.add_point((50, 10), dxfattribs={"layer": "BRIDGES"})
        m.add_point((100, 0), dxfattribs={"layer": "BRIDGES"})

    path = drawing(draw)
    job = job_with(tmp_path, '\n[bridges]\nwidth = "6 mm"\nlayer = "BRIDGES"\n')
    code, _, err = run(capsys, path, "--job", job, "--out", tmp_path / "out", "--no-figures")
    assert code == 2
    assert ("on layer BRIDGES at (50.000, 10.000) mm marks a bridge, but no rule passes within 3 mm of it; the nearest does at "
            "(50.000, 0.000) mm: move the mark there") in err  # fmt: skip


def test_a_mark_on_a_bend_is_refused_with_where_it_may_go(
    drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    def draw(m: Any, _: Any) -> None:
        m.add_lwpolyline(STEP)
        m.add_point((100, 0), dxfattribs={"layer": "BRIDGES"})

    job = job_with(tmp_path, '\n[bridges]\nwidth = "6 mm"\nlayer = "BRIDGES"\n')
    code, _, err = run(capsys, drawing(draw), "--job", job, "--out", tmp_path / "out", "--no-figures")
    assert code == 2
    assert (
        "it lies on bend 1 at (100.000, 0.000) mm, and the tool needs 2 mm; it may go to 95.000 mm or 105.000 mm" in err
    )
