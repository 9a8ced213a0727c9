"""What ``camwright bend`` refuses: file, entity and reason are named, the exit code is 2, and nothing is left behind."""

import json
import math
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from block_trees import nested, wide

from camwright.bender.dxf_guard import MOST_ENTITIES
from camwright.bender.job import BUNDLED_BENDER
from camwright.cli.main import main

Make = Callable[..., Path]


def refused(capsys: pytest.CaptureFixture[str], path: Path, out: Path, *more: str) -> str:
    """Bend a drawing, expect it to be refused; what is said on standard error."""
    before = sorted(path.parent.iterdir())
    code = main(["bend", str(path), "--out", str(out), "--json", *more])
    said, err = capsys.readouterr()
    assert code == 2
    assert json.loads(said)["status"] == "error"
    assert "Traceback" not in err
    assert all(line.startswith("camwright: ") for line in err.splitlines())
    assert str(path) in err or path.name in err
    assert sorted(path.parent.iterdir()) == before
    assert not out.exists()
    return err


ROWS = {
    "empty drawing": (lambda *_: None, "the drawing is empty"),
    "NaN": (lambda m, _: m.add_line((0, 0), (math.nan, 1)), "LINE #[0-9A-F]+ on layer 0: .*NaN"),
    "NaN in a spline": (
        lambda m, _: m.add_spline([(0, 0), (math.nan, 1), (5, 5)]),
        "SPLINE #[0-9A-F]+ on layer 0: its geometry cannot be used",
    ),
    "spline of one place": (
        lambda m, _: m.add_spline([(0, 0), (0, 0)]),
        "SPLINE #[0-9A-F]+ on layer 0: its geometry cannot be used",
    ),
    "self-crossing outline": (
        lambda m, _: m.add_lwpolyline([(0, 0), (20, 0), (20, 20), (10, -20)]),
        r"LWPOLYLINE #[0-9A-F]+ on layer 0: the outline crosses or touches itself at \(15.000, 0.000\) mm",
    ),
    "crossing at a vertex": (
        lambda m, _: m.add_lwpolyline([(0, 0), (20, 0), (20, 20), (10, 20), (10, 0), (10, -20)]),
        r"LWPOLYLINE #[0-9A-F]+ on layer 0: the outline crosses or touches itself at \(10.000, 0.000\) mm",
    ),
    "3-D polyline": (
        lambda m, _: m.add_polyline3d([(0, 0, 0), (1, 0, 5)]),
        "POLYLINE #[0-9A-F]+ on layer 0: it is three-dimensional, from z = 0 to 5",
    ),
    "3-D spline": (
        lambda m, _: m.add_spline([(0, 0, 0), (1, 0, 5), (2, 2, 2)]),
        "SPLINE #[0-9A-F]+ on layer 0: it is three-dimensional",
    ),
    "angle beyond the table": (
        lambda m, _: m.add_lwpolyline([(0, 0), (20, 0), (0, 0.01)]),
        "LWPOLYLINE #[0-9A-F]+ on layer 0: bend 1 at .* lies outside the springback table",
    ),
    "feed below the least step": (
        lambda m, _: m.add_line((50, 0), (50, 0.02)),
        "LINE #[0-9A-F]+ on layer 0: .* a feed of 0.020 mm is shorter than the machine's least step of 0.050 mm",
    ),
    "radius below the least": (
        lambda m, _: m.add_arc((0, 0), 0.3, 0, 90),
        "ARC #[0-9A-F]+ on layer 0: segment 1: radius 0.300 mm is less than the rule's least radius 0.500 mm",
    ),
    "deep blocks": (nested, "INSERT #[0-9A-F]+ on layer 0: blocks are nested more than 8 deep"),
    "blocks that unfold": (wide, f"unfold to more than {MOST_ENTITIES} entities"),
}


@pytest.mark.parametrize("row", ROWS)
def test_a_drawing_that_cannot_be_bent(drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str], row: str):
    draw, reason = ROWS[row]
    assert re.search(reason, refused(capsys, drawing(draw), tmp_path / "out"))


def test_a_drawing_without_units(drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    path = drawing(lambda m, _: m.add_line((0, 0), (9, 0)), units=0)
    assert "does not say its unit ($INSUNITS is 0 or missing)" in refused(capsys, path, tmp_path / "out")


def test_an_angle_beyond_the_mould_s_range(drawing: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    job = tmp_path / "bender.toml"
    job.write_text(BUNDLED_BENDER.read_text(encoding="utf-8").replace('"175 deg"', '"60 deg"'), encoding="utf-8")
    path = drawing(lambda m, _: m.add_lwpolyline([(0, 0), (22, 0), (22, 22)]))
    err = refused(capsys, path, tmp_path / "out", "--job", str(job))
    reason = "workpiece angle 90.000° needs a mould angle of 90.000°, beyond the mould's range of 60.000°"
    assert re.search(rf"LWPOLYLINE #[0-9A-F]+ on layer 0: bend 1 at \(22.000, 0.000\) mm: {reason}", err)


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"", "the drawing is empty"),
        (b"G01 X1\n", "not a DXF file"),
        (b"\x89PNG\r\n\x1a\n" * 10, "not a DXF file"),
        (b"  0\nSECTION\n  2\nENTITIES\n  0\nLINE\nnonsense\n", "not a DXF file"),
        (
            b"  0\nSECTION\n  2\nENTITIES\n" + b"  0\nPOINT\n  8\n0\n 10\n0.0\n 20\n0.0\n" * 10**6,
            f"more than {MOST_ENTITIES} entities",
        ),
        (
            b"AutoCAD Binary DXF\r\n\x1a\x00" + b"\x00\x00POINT\x00\x08\x000\x00" * (MOST_ENTITIES + 1),
            f"more than {MOST_ENTITIES} entities",
        ),
    ],
    ids=["nothing", "text", "picture", "broken off", "a million entities", "binary bomb"],
)
def test_a_file_that_is_no_drawing(tmp_path: Path, capsys: pytest.CaptureFixture[str], content: bytes, reason: str):
    path = tmp_path / "x.dxf"
    path.write_bytes(content)
    assert reason in refused(capsys, path, tmp_path / "out")
