"""``camwright bend`` from the command line: programs, JSON keys, exit codes, calibration, sheets, the serial line."""

import json
import math
import os
import re
import select
import termios
import threading
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from camwright.bender.job import BUNDLED_BENDER, load_bender
from camwright.bender.program_file import bend_outlines
from camwright.bender.springback_file import BUNDLED
from camwright.cli.main import main
from camwright.house.owned import LIST
from camwright.profiles.bender.nc_code import read_program
from camwright.profiles.bender.outline import Outline
from camwright.profiles.errors import InputError
from tests.pace import in_time

Make = Callable[..., Path]
STEP = [(0, 0), (22, 0), (22, 22), (34.5, 22)]
XON, XOFF = b"\x11", b"\x13"
EXAMPLE = Path(__file__).parents[2] / "examples" / "bender" / "carton.dxf"


def run(capsys: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, dict, str]:
    code = main(["bend", *map(str, arguments), "--json"])
    out, err = capsys.readouterr()
    return code, json.loads(out), err


def changed(tmp_path: Path, *changes: tuple[str, str]) -> Path:
    text = BUNDLED_BENDER.read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = tmp_path / "bender.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_fragment_of_the_paper_from_a_drawing(drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    path = drawing(lambda m, _: m.add_lwpolyline(STEP))
    code, answer, _ = run(capsys, path, "--out", tmp_path / "out", "--no-figures")
    assert code == 0
    assert (answer["outlines"], answer["bends"], answer["length_mm"]) == (1, 2, 56.5)
    assert answer["closing_error_mm"] is None
    assert answer["program"] == str(tmp_path / "out" / "drawing.nc")
    assert answer["deviation_mm"] == pytest.approx(0, abs=1e-9)
    assert answer["cycle_time_s"] < 0.85 * answer["baseline_cycle_time_s"]
    assert isinstance(answer["warnings"], list)
    assert (
        "N010 G01 G91 X22.000\nN011 G01 G90 Y90.000\nN012 G01 G90 Y0.0\nN013 G01 G91 X22.000\n"
        "N014 G01 G90 Y270.000\nN015 G01 G90 Y0.0\nN016 G01 G91 X12.500\n"
    ) in Path(answer["program"]).read_text()
    assert sorted(file.name for file in (tmp_path / "out").iterdir()) == [LIST, "drawing-bends.csv", "drawing.nc"]


def test_the_paper_s_arc_rule_by_job(drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    path = drawing(lambda m, _: m.add_circle((0, 0), 5.5))
    job = changed(tmp_path, ('rule = "chord_error"', 'rule = "sides"'), ('chord_error = "0.05 mm"', "sides = 25"))
    _, answer, _ = run(capsys, path, "--job", job, "--out", tmp_path / "out", "--no-figures")
    assert answer["bends"] == 25
    program = read_program(Path(answer["program"]).read_text())
    assert abs(program.bends - 16_900).max() <= 2  # beta(5.5 mm) = 16.9°, rounding distributed
    _, fewer, _ = run(capsys, path, "--out", tmp_path / "out", "--no-figures")
    assert fewer["bends"] < 25


def test_example_drawing_with_everything(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    code, answer, _ = run(capsys, EXAMPLE, "--out", tmp_path, "--accept-collisions")
    assert code == 0
    assert answer["outlines"] == 3
    assert answer["passed"]
    assert answer["cycle_time_s"] < 0.85 * answer["baseline_cycle_time_s"]
    assert answer["deviation_mm"] <= answer["chord_error_mm"] + 0.005
    assert answer["closing_error_mm"] <= 0.010
    files = {Path(file).name for file in answer["files"]}
    assert {"carton-1.nc", "carton-1-bends.csv", "carton-1-proof.svg", "carton-1-times.png", "sheet.pdf"} <= files
    assert all(Path(file).stat().st_size > 0 for file in answer["files"])
    page = (tmp_path / "sheet.html").read_text(encoding="utf-8")
    assert answer["programs"][0]["sha256"] in page
    assert page.count('role="img"') == 3
    assert "http://" not in page.replace("http://www.w3.org", "").replace("http://purl.org", "").replace(
        "http://creativecommons.org", ""
    )
    assert (tmp_path / "sheet.pdf").read_bytes().startswith(b"%PDF")


def test_examples_of_job_and_measurements(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    folder = EXAMPLE.parent
    code, answer, _ = run(capsys, EXAMPLE, "--job", folder / "paper-arcs.toml", "--out", tmp_path / "a", "--no-figures")
    assert code == 1  # the part meets the mould
    assert Path(answer["program"]).read_text().startswith("%\n(CARTON-1)\nN001 G21\n")
    code, answer, _ = run(capsys, "--calibrate", folder / "measurements.csv", "--out", tmp_path / "b")
    assert code == 0
    assert answer["warnings"] == []
    assert 0 < answer["largest_residual_deg"] <= 0.1 + 1e-9


def test_same_input_same_bytes(drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    path = drawing(lambda m, _: m.add_lwpolyline(STEP))
    for name in ("a", "b"):
        run(capsys, path, "--out", tmp_path / name)
    for file in (tmp_path / "a").iterdir():
        assert file.read_bytes() == (tmp_path / "b" / file.name).read_bytes(), file.name


def test_names_are_escaped(drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    def draw(m, d):
        d.layers.add("A&B'{{x}}#strong[y]")
        m.add_lwpolyline(STEP, dxfattribs={"layer": "A&B'{{x}}#strong[y]"})

    path = drawing(draw, name="a'b&c.dxf")
    code, answer, _ = run(capsys, path, "--out", tmp_path / "out")
    assert code == 0
    page = (tmp_path / "out" / "sheet.html").read_text(encoding="utf-8")
    assert "A&amp;B&#39;{{x}}#strong[y]" in page
    assert Path(answer["program"]).name == "a'b&c.nc"
    assert Path(answer["program"]).read_text().startswith("%A-B-C\n")


def test_start_and_reverse(drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    path = drawing(lambda m, _: m.add_lwpolyline([(0, 0), (40, 0), (40, 20), (0, 20)], close=True))

    def feeds(*more: str) -> list[int]:
        _, answer, _ = run(capsys, path, "--out", tmp_path / "out", "--no-figures", *more)
        program = read_program(Path(answer["program"]).read_text())
        assert (program.bends < 0).all() == ("--reverse" in more)
        return program.feeds.tolist()

    assert feeds() == [40_000, 20_000, 40_000, 20_000]
    assert feeds("--start", "39,1") == [20_000, 40_000, 20_000, 40_000]
    assert feeds("--reverse") == [20_000, 40_000, 20_000, 40_000]


def test_collisions_are_reported_by_line(drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    path = drawing(lambda m, _: m.add_lwpolyline([(0, 0), (100, 0), (100, 4), (-100, 4)]))
    code, answer, _ = run(capsys, path, "--out", tmp_path / "out", "--no-figures")
    assert code == 1
    assert answer["collisions"] == 1
    assert any("line N014 (bend 2): the part bent so far, side 1 from (0.000, 0.000) mm, meets the mould" in w
               for w in answer["warnings"])  # fmt: skip


def test_a_collision_fails_a_check_unless_it_is_accepted(
    drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    path = drawing(lambda m, _: m.add_lwpolyline([(0, 0), (100, 0), (100, 4), (-100, 4)]))
    more = ("--out", tmp_path / "out", "--no-figures")
    code, answer, _ = run(capsys, path, *more)
    assert code == 1
    assert answer["passed"] is False
    (failed,) = (check for check in answer["checks"] if not check["passed"])
    assert (failed["program"], failed["name"], failed["value"], failed["limit"]) == ("DRAWING", "collisions", 1, 0)
    assert failed["accepted"] is False
    assert any(
        text.startswith("the check collisions failed in 1 program; ") and text.endswith("with --accept-collisions")
        for text in answer["warnings"]
    )
    code, answer, _ = run(capsys, path, *more, "--accept-collisions")
    assert code == 0
    assert answer["passed"] is True
    (failed,) = (check for check in answer["checks"] if not check["passed"])
    assert failed["accepted"] is True
    assert not any("--accept-collisions" in text for text in answer["warnings"])
    assert any("meets the mould" in text for text in answer["warnings"])
    assert main(["bend", str(path), *map(str, more)]) == 1
    shown = capsys.readouterr().out
    assert "DRAWING: collisions 1, allowed 0" in shown
    assert main(["bend", str(path), *map(str, more), "--accept-collisions"]) == 0
    shown = capsys.readouterr().out
    assert "accepted" in shown
    assert "FAILED" not in shown


def test_accepting_collisions_accepts_nothing_else(drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    path = drawing(lambda m, _: m.add_lwpolyline(STEP))
    job = changed(tmp_path, ("velocity_feedforward = 0.0", "velocity_feedforward = 1.0"))
    code, answer, _ = run(capsys, path, "--job", job, "--out", tmp_path / "out", "--no-figures", "--accept-collisions")
    assert code == 1
    assert {check["name"] for check in answer["checks"] if not check["passed"]} == {"feed_overshoot", "mould_overshoot"}
    assert not any(check["accepted"] for check in answer["checks"])


def test_overshoot_fails_a_check(drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    path = drawing(lambda m, _: m.add_lwpolyline(STEP))
    job = changed(tmp_path, ("velocity_feedforward = 0.0", "velocity_feedforward = 1.0"))
    assert main(["bend", str(path), "--job", str(job), "--out", str(tmp_path / "out"), "--no-figures"]) == 1
    assert "DRAWING: feed_overshoot 0.000" in capsys.readouterr().out
    code, answer, _ = run(capsys, path, "--job", job, "--out", tmp_path / "out", "--no-figures")
    assert code == 1
    assert not answer["passed"]
    assert answer["feed_overshoot_mm"] > 0.1
    code, answer, _ = run(capsys, path, "--out", tmp_path / "out", "--no-figures")
    assert code == 0
    assert answer["feed_overshoot_mm"] < 1e-6


def test_no_collision_on_a_plain_drawing_and_all_lines_of_one_that_collides(
    drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    _, answer, _ = run(capsys, drawing(lambda m, _: m.add_lwpolyline(STEP)), "--out", tmp_path / "a", "--no-figures")
    assert answer["collisions"] == 0
    assert not any("meets" in text for text in answer["warnings"])
    ring = drawing(lambda m, _: m.add_circle((0, 0), 30))
    _, answer, _ = run(capsys, ring, "--out", tmp_path / "b", "--no-figures")
    (told,) = (text for text in answer["warnings"] if "meets the mould" in text)
    numbers = re.findall(r"N(\d+)", told)
    lines = Path(answer["program"]).read_text().splitlines()
    assert len(numbers) == answer["collisions"] > 1
    bends = [line for line in lines if " G90 Y" in line and not line.endswith("Y0.0")]
    assert [line.split()[0] for line in bends][-len(numbers) :] == [f"N{number}" for number in numbers]


def test_curves_count_in_the_deviation(drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    path = drawing(lambda m, _: m.add_ellipse((0, 0), (40, 0), 0.5))
    _, answer, _ = run(capsys, path, "--out", tmp_path / "out", "--no-figures")
    assert 0.002 < answer["chord_error_mm"] <= 0.010
    assert answer["chord_error_mm"] < answer["deviation_mm"] <= answer["chord_error_mm"] + 0.005


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (('thickness = "0.71 mm"', "thickness = 0.71"), "[rule] thickness = 0.71: a number without a unit"),
        (('gap = "0.01 mm"', 'gaps = "0.01 mm"'), "[drawing] gaps: there is no such key; did you mean gap?"),
        (('gap = "0.01 mm"', 'gaps = "0.01 mm"'), "[drawing] gap: missing"),
        (('hardness = "standard"', 'hardness = "soft"'), "no table for a rule of 0.71 mm, hardness 'soft'"),
        (('flavour = "fagor"', 'flavour = "heidenhain"'), "flavour = 'heidenhain': not known; write \"fagor\" or \"iso\""),
        (('greatest_angle = "175 deg"', 'greatest_angle = "180 deg"'), "the mould turns by less than 180° to a side"),
        (('table = "example"', 'table = "mine.toml"'), "mine.toml: there is no such springback table"),
        (('["30 mm", "5 mm"]', '["30 mm", "1 mm"]'), "must be convex"),
        (("damping = 0.8", "damping = 0"), "[servo] damping = 0: the damping ratio must be above 0"),
        (("first_line = 10", "first_line = 10.5"), "[program] first_line = 10.5: not a whole number"),
        (('jerk = "1000 m/s^3"', 'jerk = "1000 m/s^2"'), "but a jerk is expected"),
        (("[feed]", "[fed]"), "[feed]: missing; add the table [feed]"),
        (('name = "example-bender"', "name = "), "not TOML"),
    ],
)  # fmt: skip
def test_faults_of_the_bender_job(tmp_path: Path, change: tuple[str, str], message: str):
    with pytest.raises(InputError) as error:
        load_bender(changed(tmp_path, change))
    assert message in str(error.value)
    assert "bender.toml" in str(error.value) or "example.toml" in str(error.value) or "mine.toml" in str(error.value)


def test_printed_table_warns_by_row_and_does_not_cover(
    drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    job = changed(tmp_path, ('table = "example"', 'table = "paper-printed"'))
    path = drawing(lambda m, _: m.add_lwpolyline([(0, 0), (20, 0), (40, 6)]))  # 16.7°
    code, answer, _ = run(capsys, path, "--job", job, "--out", tmp_path / "out", "--no-figures")
    assert code == 0
    assert any("paper-printed: angle table, row 2" in text and "under-bends" in text for text in answer["warnings"])
    gamma = math.degrees(math.atan2(6, 20))
    program = read_program(Path(answer["program"]).read_text())
    assert program.bends[0] / 1e3 == pytest.approx(16.8 + 0.14 * (gamma - 15), abs=1e-3)
    code, _, err = run(capsys, drawing(lambda m, _: m.add_lwpolyline(STEP)), "--job", job, "--out", tmp_path / "b")
    assert code == 2
    assert "measure a row for it" in err


def test_bundled_tables_can_be_read():
    assert {path.stem for path in BUNDLED.glob("*.toml")} == {"example", "paper-printed"}
    assert [text for text in load_bender().warnings if "under-bends" in text] == []


def test_calibration(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    path = tmp_path / "steel.csv"
    path.write_text(
        "mould_deg,workpiece_deg,radius_mm\n0.1,0.09,\n16.8,15.0,\n16.8,15.2,\n48,45.1,\n93,90,\n\n16.9,14.4,5.5\n16.8,14.4,6\n"
    )
    code, answer, _ = run(capsys, "--calibrate", path, "--out", tmp_path / "out")
    assert code == 0
    assert (answer["test_bends"], answer["angle_rows"], answer["radius_rows"]) == (7, 4, 2)
    assert answer["largest_residual_deg"] == pytest.approx(0.1)
    residuals = (tmp_path / "out" / "steel-residuals.csv").read_text().splitlines()
    assert residuals[2:4] == ["3,,16.8,15,0.1000", "4,,16.8,15.2,-0.1000"]
    # the table it wrote is one that a job can name
    job = changed(tmp_path, ('table = "example"', 'table = "out/steel.toml"'))
    table = load_bender(job).springback
    assert math.degrees(table.mould_angle(math.radians(15.1))) == pytest.approx(16.8)
    assert math.degrees(table.mould_angle(math.radians(90))) == pytest.approx(93)
    assert float(table.factor(table.radius[:1])[0]) == pytest.approx(16.9 / 14.4)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("mould,workpiece\n1,2\n", "row 1: the columns are mould, workpiece"),
        ("mould_deg,workpiece_deg\n1,x\n", "row 2: '1,x' is not numbers"),
        ("mould_deg,workpiece_deg\n1\n", "row 2: '1': give 2 numbers above zero"),
        ("mould_deg,workpiece_deg\n1,nan\n", "row 2: '1,nan': give 2 numbers"),
        ("mould_deg,workpiece_deg\n190,80\n", "row 2: an angle of 190°"),
        ("mould_deg,workpiece_deg\n20,18\n", "the angle table has 1 rows"),
        ("mould_deg,workpiece_deg\n20,18\n30,17\n", "row 2: the mould angle 20.000° does not exceed the 30.000°"),
    ],
)
def test_measurements_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str, message: str):
    path = tmp_path / "m.csv"
    path.write_text(text)
    code, _, err = run(capsys, "--calibrate", path, "--out", tmp_path / "out")
    assert code == 2
    assert message in err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "no drawing is named"),
        (["x.dxf", "--calibrate", "m.csv"], "leave the drawing out"),
        (["x.dxf", "--start", "1"], "--start '1': not a place"),
        (["x.dxf", "--start", "1,nan"], "not a place"),
        (["x.dxf", "--handshake", "none"], "handshake"),
        (["x.dxf", "--job", "none.toml"], "none.toml: there is no such bender job"),
    ],
)
def test_arguments_refused(capsys: pytest.CaptureFixture[str], arguments: list[str], message: str):
    code, _, err = run(capsys, *arguments)
    assert code == 2
    assert message in err


def test_tables_for_people(drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    path = drawing(lambda m, _: m.add_lwpolyline(STEP))
    assert main(["bend", str(path), "--out", str(tmp_path / "out"), "--no-figures"]) == 0
    out = capsys.readouterr().out
    assert "Programs of drawing.dxf" in out
    assert "56.500" in out
    assert "passed" in out
    assert main(["bend", str(path), "--out", str(tmp_path / "out"), "--no-figures", "--quiet"]) == 0
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize("handshake", ["xonxoff", "rtscts"])
def test_serial_line(drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str], handshake: str):
    pytest.importorskip("serial")
    machine, port = os.openpty()
    received, quiet, flags = bytearray(), [], []

    def listen() -> None:
        while b"M30\r\n\x1b" not in received:
            received.extend(os.read(machine, 16))
            if len(flags) == 0:
                flags.append(termios.tcgetattr(port))
                if handshake == "xonxoff":
                    os.write(machine, XOFF)
                    time.sleep(0.1)  # what was on its way arrives
                    while select.select([machine], [], [], 0.1)[0]:
                        received.extend(os.read(machine, 4096))
                    quiet.append(b"M30" not in received and not select.select([machine], [], [], 0.3)[0])
                    os.write(machine, XON)

    listener = threading.Thread(target=listen, daemon=True)
    listener.start()
    path = drawing(lambda m, _: m.add_lwpolyline([(10 * i, 5 * (i % 2)) for i in range(2000)]))
    code, answer, _ = run(
        capsys, path, "--out", tmp_path / "out", "--no-figures", "--port", os.ttyname(port), "--handshake", handshake
    )
    listener.join(20)
    os.close(port)
    os.close(machine)
    assert code == 0
    written = Path(answer["program"]).read_text().replace("%DRAWING\n", "%DRAWING,MX,\n")
    assert bytes(received).replace(b"\r\n", b"\n").decode() == written + "\x1b"
    software, hardware = bool(flags[0][0] & termios.IXON), bool(flags[0][2] & termios.CRTSCTS)
    assert (software, hardware) == (handshake == "xonxoff", handshake == "rtscts")
    assert quiet == ([True] if handshake == "xonxoff" else [])


def test_serial_line_that_stays_held_up(
    drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
):
    pytest.importorskip("serial")
    monkeypatch.setattr("camwright.bender.sending._WAIT", 0.3)
    machine, port = os.openpty()  # nobody reads: its buffer fills up
    path = drawing(lambda m, _: m.add_lwpolyline([(10 * i, 5 * (i % 2)) for i in range(2000)]))
    code, _, err = run(capsys, path, "--out", tmp_path / "out", "--no-figures", "--port", os.ttyname(port))
    os.close(port)
    os.close(machine)
    assert code == 2
    assert re.search(r"the machine held the line up for 0.3 s; \d+ lines of the program were handed over", err)


def test_bytes_that_do_not_leave_are_noticed(monkeypatch: pytest.MonkeyPatch):
    serial = pytest.importorskip("serial")
    from camwright.bender import sending

    monkeypatch.setattr(sending, "_WAIT", 0.1)

    class Line:
        def __init__(self, *waiting: int) -> None:
            self.left, self.discarded = list(waiting), False

        @property
        def out_waiting(self) -> int:
            return self.left.pop(0) if len(self.left) > 1 else self.left[0]

        def reset_output_buffer(self) -> None:
            self.discarded = True

    sending._drain(Line(*range(12, -1, -1)))
    held = Line(9, 7, 7)
    with pytest.raises(serial.SerialTimeoutException):
        sending._drain(held)
    assert held.discarded


def test_a_program_that_failed_is_not_sent(drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    path = drawing(lambda m, _: m.add_lwpolyline(STEP))
    job = changed(tmp_path, ("velocity_feedforward = 0.0", "velocity_feedforward = 1.0"))
    code, answer, _ = run(
        capsys, path, "--job", job, "--out", tmp_path / "out", "--no-figures", "--port", tmp_path / "none"
    )
    assert code == 1
    assert any("nothing is sent to" in text and "a check failed" in text for text in answer["warnings"])


def test_serial_line_that_is_none(drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    pytest.importorskip("serial")
    path = drawing(lambda m, _: m.add_lwpolyline(STEP))
    code, _, err = run(capsys, path, "--out", tmp_path / "out", "--no-figures", "--port", tmp_path / "tty")
    assert code == 2
    assert "the serial line cannot be used" in err


def two_styles(m, d):
    m.add_lwpolyline([(0, 0), (50, 0), (50, 30)], dxfattribs={"layer": "CUT", "color": 1})
    m.add_line((0, 20), (40, 20), dxfattribs={"layer": "CREASE", "color": 3})


def test_styles_on_the_command_line(drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    path, out = drawing(two_styles), tmp_path / "out"
    code, answer, err = run(capsys, path, "--out", out, "--no-figures")
    assert code == 2
    assert not out.exists()
    assert "--style layer=CUT,colour=1,linetype=Continuous: 1 entity, 80.000 mm" in err
    assert "--style layer=CREASE,colour=3,linetype=Continuous: 1 entity, 40.000 mm" in answer["message"]
    for choice in (("--style", "layer=CUT,colour=1"), ("--style", "colour=1"), ("--layer", "cut")):
        code, answer, _ = run(capsys, path, "--out", out, "--no-figures", *choice)
        assert (code, answer["outlines"], answer["length_mm"]) == (0, 1, 80.0)
        assert answer["styles"] == [{"layer": "CUT", "colour": "1", "linetype": "Continuous"}]
    code, answer, _ = run(capsys, path, "--out", out, "--styles", "all")
    assert code == 0
    assert [program["style"] for program in answer["programs"]] == [
        "layer=CUT,colour=1,linetype=Continuous", "layer=CREASE,colour=3,linetype=Continuous",
    ]  # fmt: skip
    assert "layer=CREASE,colour=3" in (out / "sheet.html").read_text(encoding="utf-8")


def test_unit_and_size_are_told_always(drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    path = drawing(lambda m, _: m.add_lwpolyline(STEP), units=1)
    code, answer, _ = run(capsys, path, "--out", tmp_path / "out", "--no-figures")
    assert (code, answer["unit"], answer["size_mm"]) == (0, "in", pytest.approx([34.5 * 25.4, 22 * 25.4]))
    assert not any("beyond the machine" in text for text in answer["warnings"])
    assert main(["bend", str(path), "--out", str(tmp_path / "out"), "--no-figures"]) == 0
    assert "the drawing is 876.300 mm × 558.800 mm large, its unit is in" in capsys.readouterr().out
    large = drawing(lambda m, _: m.add_line((0, 0), (100, 0)), units=1)
    _, answer, _ = run(capsys, large, "--out", tmp_path / "out", "--no-figures")
    assert any("2540.000 mm × 0.000 mm large, beyond the machine's 2000 mm" in text for text in answer["warnings"])
    unsaid = changed(tmp_path, ('greatest_size = "2 m"', ""))
    _, answer, _ = run(capsys, large, "--job", unsaid, "--out", tmp_path / "out", "--no-figures")
    assert not any("beyond the machine" in text for text in answer["warnings"])


def test_doubles_near_ends_and_chords_in_the_answer(drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    def draw(m, _):
        m.add_line((0, 0), (40, 0))
        m.add_line((40, 0), (10, 0))
        m.add_line((40, 0.5), (40, 30))
        points = [(20 * math.cos(a), 60 + 20 * math.sin(a)) for a in (math.radians(5 * k) for k in range(19))]
        m.add_lwpolyline(points)

    path, out = drawing(draw), tmp_path / "out"
    code, answer, _ = run(capsys, path, "--out", out, "--no-figures")
    assert code == 0
    assert answer["overlaps"] == [
        {"first": "LINE #2F on layer 0", "second": "LINE #30 on layer 0", "length_mm": pytest.approx(30)}
    ]
    (ends,) = answer["near_ends"]
    assert (ends["first"], ends["second"]) == ("LINE #2F on layer 0", "LINE #31 on layer 0")
    assert (ends["distance_mm"], ends["gap_mm"]) == (pytest.approx(0.5), pytest.approx(0.51))
    few = answer["bends"]
    code, answer, _ = run(capsys, path, "--out", out, "--no-figures", "--arcs", "keep")
    assert (code, answer["bends"]) == (0, 17)
    assert few < 17
    code, _, err = run(capsys, path, "--out", tmp_path / "none", "--no-figures", "--overlaps", "refuse")
    assert code == 2
    assert "LINE #30 on layer 0 lies on LINE #2F on layer 0 over 30.000 mm" in err
    joined = changed(tmp_path, ('gap = "0.01 mm"', f'gap = "{ends["gap_mm"]} mm"'))
    code, answer, _ = run(capsys, path, "--job", joined, "--out", out, "--no-figures")
    assert answer["near_ends"] == []


def test_time_does_not_grow_with_the_length_of_a_side(
    drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    path = drawing(lambda m, _: m.add_lwpolyline([(0, 0), (1e6, 0), (1e6, 600)]))
    begin = time.process_time()
    code, answer, _ = run(capsys, path, "--out", tmp_path / "out", "--no-figures")
    assert in_time(time.process_time() - begin, 2.0)
    assert (code, answer["length_mm"]) == (0, 1_000_600.0)


def test_outlines_alike_are_run_once_and_judged_each_for_itself(
    drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    shape = [(0, 0), (100, 0), (100, 4), (-100, 4)]

    def draw(m, _):
        for i in range(3):
            m.add_lwpolyline([(x + 300 * i, y + 0.1 * i) for x, y in shape])
        m.add_lwpolyline([(x + 1000, y) for x, y in STEP])

    code, answer, _ = run(capsys, drawing(draw), "--out", tmp_path / "out", "--no-figures")
    alone, single, _ = run(
        capsys, drawing(lambda m, _: m.add_lwpolyline(shape), name="one.dxf"), "--out", tmp_path / "one", "--no-figures"
    )
    assert code == alone == 1
    assert answer["collisions"] == 3 * single["collisions"] == 3
    told = [text for text in answer["warnings"] if "meets the mould" in text]
    assert [f"side 1 from ({300 * i}.000, 0.{i}00) mm" in text for i, text in enumerate(told)] == [True] * 3
    lists = [(tmp_path / "out" / f"drawing-{i}-bends.csv").read_text() for i in (1, 2, 3, 4)]
    assert lists[0] == lists[1] == lists[2] == (tmp_path / "one" / "one-bends.csv").read_text() != lists[3]


def test_an_outline_that_is_bent_like_another_is_what_it_is_alone():
    job, dice = load_bender(), np.random.default_rng(3)
    shape = 1e-3 * np.array([[0, 0], [60, 0], [60, 20], [30, 45], [0, 20], [0, 0]])
    bulges = np.array([0, 0.3, 0, -0.2, 0])
    places = [(0.0, 0.0), *(1e-6 * dice.integers(0, 10**6, 2) for _ in range(5))]
    outlines = [Outline(shape + place, bulges, f"LINE {i}") for i, place in enumerate(places)]
    together = bend_outlines(outlines, job, "rule")
    for i, (found, outline) in enumerate(zip(together, outlines, strict=True)):
        (alone,) = bend_outlines([outline], job, "rule")
        assert found.program.name == f"RULE-{i + 1}"
        assert found.text == alone.text.replace("RULE", f"RULE-{i + 1}")
        assert found.plan.outline is outline
        np.testing.assert_allclose(found.plan.vertices, alone.plan.vertices, atol=1e-12)
        np.testing.assert_allclose(found.proof.points, alone.proof.points, atol=1e-9)
        assert found.proof.deviation == pytest.approx(alone.proof.deviation, abs=1e-9)
        assert [check.passed for check in found.checks] == [check.passed for check in alone.checks]


def test_faults_of_outlines_alike_are_told_once_a_shape():
    sharp = 1e-3 * np.array([[0, 0], [40, 0], [0.0, 0.001]])
    outlines = [Outline(sharp + 0.1 * i, np.zeros(2), f"LINE {i}") for i in range(3)]
    with pytest.raises(InputError) as refused:
        bend_outlines(outlines, load_bender(), "rule")
    assert len(refused.value.faults) == 3  # a fault names its outline: none is passed over while there is room
