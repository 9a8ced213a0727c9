"""CFF2 files: lines, arcs, blocks and bridges; whatever is no such file is refused by line."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from camwright.bender.die_file import bridge_places, is_cf2, read_cf2
from camwright.bender.drawing import Drawing, Reading, read_drawing
from camwright.bender.dxf_styles import StyleChoice
from camwright.cli.main import main
from camwright.profiles.errors import InputError

DIE = """$BOF
V2
ORDER
Material: birch
END
MAIN,DIE
UM
LL,-50,-50
UR,400,300
SCALE,1,1
C,ONE,0,0,0,1,1
C,ONE,300,0,180,1,1
C,ONE,0,300,0,-1,1
T,2,10,10,0,5,text
END
SUB,ONE
L,2,1,0,0,0,100,0,2,6
L,2,1,0,100,0,100,50,1,6
A,2,1,0,100,50,80,70,80,50,1,0,0
L,2,1,0,80,70,0,70,1,6
L,2,1,0,0,70,0,0,1,6
L,2,2,0,50,0,50,70,2,4
END
$EOF
"""
CUT = StyleChoice(layer="type-1")


def written(folder: Path, *changes: tuple[str, str], name: str = "die.cf2") -> Path:
    text = DIE
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def read(path: Path, style: StyleChoice = CUT, units: str | None = None) -> Drawing:
    return read_drawing(path, Reading(1e-5, 1e-5, units, style))


def test_blocks_are_placed_turned_and_mirrored(tmp_path: Path):
    found = read(written(tmp_path))
    assert [str(style) for style in found.styles] == ["layer=type-1,colour=2,linetype=Continuous"] * 3
    length = 0.1 + 0.05 + 0.02 * math.pi / 2 + 0.08 + 0.07
    for outline in found.outlines:
        assert outline.closed
        assert outline.lengths.sum() == pytest.approx(length)
        assert np.ptp(outline.points, axis=0) == pytest.approx([0.1, 0.07])
    first, turned, mirrored = (1e3 * outline.points for outline in found.outlines)
    np.testing.assert_allclose(turned, [300, 0] - first, atol=1e-9)
    np.testing.assert_allclose(mirrored, [0, 300] + first * [-1, 1], atol=1e-9)
    assert np.sign(found.outlines[2].turns).sum() == -np.sign(found.outlines[0].turns).sum()  # the other way round
    assert any("left out 1 × T (no line work)" in text for text in found.warnings)


def test_bridges_stand_evenly_along_their_lines(tmp_path: Path):
    found = read(written(tmp_path))
    assert found.bridge_width == pytest.approx(6e-3)
    assert len(found.marks) == 15
    places = sorted((round(1e3 * x, 6), round(1e3 * y, 6)) for x, y in (mark.place for mark in found.marks[:5]))
    assert places == [(0.0, 35.0), (33.333333, 0.0), (40.0, 70.0), (66.666667, 0.0), (100.0, 25.0)]
    assert any("15 of 6 mm are placed evenly along them" in text for text in found.warnings)


@pytest.mark.parametrize(("way", "sweep"), [(1, 90.0), (-1, 270.0)])
def test_bridges_of_arcs(tmp_path: Path, way: int, sweep: float):
    path = written(tmp_path, ("50,1,0,0", f"50,{way},3,6"))
    arc = next(line for line in read_cf2(path).lines if line.bridges == 3)
    angles = [math.degrees(math.atan2(y - 50, x - 80)) % 360 for x, y in bridge_places(arc)]
    assert angles == pytest.approx([way * sweep * k / 4 % 360 for k in (1, 2, 3)])
    assert [math.hypot(x - 80, y - 50) for x, y in bridge_places(arc)] == pytest.approx([20.0] * 3)


def test_the_unit_is_the_files_unless_the_job_says_another(tmp_path: Path):
    inches = read(written(tmp_path, ("UM", "UI")))
    assert inches.unit == "in"
    assert inches.size == pytest.approx((0.4 * 25.4, 0.44 * 25.4))
    again = read(written(tmp_path, ("UM", "UI")), units="mm")
    assert again.size == pytest.approx((0.4, 0.44))
    assert any("it says in, the bender job says mm: read in mm" in text for text in again.warnings)


def test_styles_and_common_lines(tmp_path: Path):
    with pytest.raises(InputError, match="the drawing holds 2 styles"):
        read(written(tmp_path), StyleChoice())
    with pytest.raises(InputError, match="its bridges are 4, 6 mm wide, and a rule has one width"):
        read(written(tmp_path), StyleChoice(each=True))
    both = read(written(tmp_path, ("C,ONE,300,0,180,1,1", "C,ONE,0,0,0,1,1")))
    assert len(both.outlines) == 2
    assert len(both.marks) == 10  # what lies on each other has its bridges once


def test_the_command_bends_it_with_its_bridges(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    arguments = ["bend", str(written(tmp_path)), "--layer", "type-1", "--accept-collisions", "--no-figures", "--json"]
    assert main([*arguments, "--out", str(tmp_path / "out")]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert (answer["outlines"], len(answer["bridges"])) == (3, 15)
    assert main([*arguments, "--bridges", "4@80", "--out", str(tmp_path / "other")]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert {round(row["to_mm"] - row["from_mm"], 6) for row in answer["bridges"]} == {4.0}
    assert any(
        "the bridges that are asked for are taken, not the 15 of the file" in text for text in answer["warnings"]
    )


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("$EOF", "", "not a CFF2 file to its end: it breaks off without \\$EOF"),
        ("MAIN,DIE", "SUB,DIE", "there is no block MAIN in it"),
        ("UM\n", "", "the drawing does not say its unit"),
        ("100,0,2,6", "100,zero,2,6", "line 17: 'L,2,1,0,0,0,100,zero,2,6' does not hold 4 numbers from cell 5 on"),
        ("100,0,2,6", "100,inf,2,6", "does not hold 4 numbers"),
        ("100,0,2,6", "100,0,2,0", "line 17: 2 bridges of 0, which are none"),
        ("80,50,1,0,0", "80,50,7,0,0", "line 19: no arc: its ends are 20 and 20 from its centre, its way is 7"),
        ("80,50,1,0,0", "80,59,1,0,0", "line 19: no arc"),
        ("C,ONE,300,0,180,1,1", "C,TWO,300,0,180,1,1", "line 12: the block .* is not in the file"),
        ("C,ONE,300,0,180,1,1", "C,ONE,300,0,180,2,1", "line 12: the block is stretched by 2 and 1"),
        ("L,2,2,0,50", "C,ONE,0,0,0,1,1\nL,2,2,0,50", "is nested more than 8 deep"),
        ("SCALE,1,1", "SCALE,2,2", "line 10: a SCALE other than 1,1 is not read"),
        ("0,0,100,0,2,6", "0,0,1e12,0,2,6", "a coordinate beyond 10000 km"),
    ],
)
def test_what_cannot_be_read_is_refused_by_line(tmp_path: Path, old: str, new: str, message: str):
    path = written(tmp_path, (old, new))
    with pytest.raises(InputError, match=message) as refused:
        read(path)
    assert all(fault.startswith(str(path)) for fault in refused.value.faults)


def test_a_file_is_known_by_its_name_or_its_beginning(tmp_path: Path):
    assert is_cf2(written(tmp_path, name="die.txt"))
    assert not is_cf2(tmp_path / "none.dxf")
    with pytest.raises(InputError, match="the drawing cannot be read"):
        read(tmp_path / "none.cf2")
