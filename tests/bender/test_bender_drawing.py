"""DXF files: every kind of entity, blocks, layers, units, joining, and the files that are refused."""

import math
from collections.abc import Callable
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from block_trees import nested, wide
from ezdxf.math import closed_uniform_bspline
from hypothesis import given
from hypothesis import strategies as st

from camwright.bender.drawing import Drawing, Reading, read_drawing
from camwright.bender.dxf_guard import MOST_ENTITIES
from camwright.bender.dxf_styles import StyleChoice
from camwright.bender.joining import join
from camwright.bender.piece import Piece
from camwright.profiles.errors import InputError

Make = Callable[..., Path]
MM = 1e-3


def read(path: Path, layer: str | None = None, **more: object) -> Drawing:
    """Read all styles of a drawing, each for itself."""
    return read_drawing(path, Reading(1e-5, 1e-5, style=StyleChoice(layer, each=True), **more))  # type: ignore[arg-type]


def test_lwpolyline_in_its_drawing_order(drawing: Make):
    rows = [(0, 0, 0), (22, 0, 0.414214), (32, 10, 0), (32, 40, -0.2)]
    outline = read(drawing(lambda m, _: m.add_lwpolyline(rows, format="xyb"))).outlines[0]
    assert outline.points == pytest.approx(np.array([row[:2] for row in rows]) * MM)
    assert outline.bulges.tolist() == [0, 0.414214, 0]
    assert not outline.closed
    closed = read(drawing(lambda m, _: m.add_lwpolyline(rows, format="xyb", close=True))).outlines[0]
    assert closed.closed
    assert closed.bulges.tolist() == [0, 0.414214, 0, -0.2]
    # closed, and the first vertex repeated at the end
    doubled = read(drawing(lambda m, _: m.add_lwpolyline([*rows, (0, 0, 0)], format="xyb", close=True))).outlines[0]
    assert doubled.points == pytest.approx(closed.points)


def test_old_polyline_and_mirrored_plane(drawing: Make):
    def draw(m, _):
        m.add_polyline2d([(0, 0, 0.5), (10, 0, 0), (10, 5, 0)], format="xyb")
        m.add_lwpolyline([(0, 9, 0.5), (10, 9, 0)], format="xyb", dxfattribs={"extrusion": (0, 0, -1)})
        m.add_arc((0, 50), 5, 0, 90, dxfattribs={"extrusion": (0, 0, -1)})

    old, mirrored, arc = read(drawing(draw)).outlines
    assert old.bulges.tolist() == [0.5, 0]
    assert mirrored.points == pytest.approx(np.array([[0, 9], [-10, 9]]) * MM)
    assert mirrored.bulges.tolist() == [-0.5]
    assert arc.points == pytest.approx(np.array([[-5, 50], [0, 55]]) * MM)
    assert arc.centres[0] == pytest.approx([0, 50 * MM], abs=1e-12)


def test_arcs_and_circles(drawing: Make):
    def draw(m, _):
        m.add_arc((1, 2), 3, 350, 20)
        m.add_arc((100, 0), 5, 10, 300)
        m.add_circle((0, 50), 4)

    short, long, circle = read(drawing(draw)).outlines
    assert short.included == pytest.approx([math.radians(30)])
    assert short.radii == pytest.approx([3 * MM])
    assert long.included.sum() == pytest.approx(math.radians(290))
    assert circle.closed
    assert circle.included.sum() == pytest.approx(2 * math.pi)
    assert circle.centres == pytest.approx(np.array([[0, 50], [0, 50]]) * MM)


def test_curves_within_the_flattening(drawing: Make):
    def draw(m, _):
        m.add_ellipse((0, 0), (40, 0), 0.5)
        m.add_spline([(100, 0), (110, 10), (120, -10), (130, 0)])

    ellipse, spline = read(drawing(draw)).outlines
    assert ellipse.closed
    assert not spline.closed
    # the middles of the ellipse's chords lie within the flattening of it; vertices lie on it
    x, y = ellipse.points.T / MM
    assert np.hypot(x, 2 * y) == pytest.approx(np.full(len(x), 40.0), abs=1e-9)
    middle = 0.5 * (ellipse.points[:-1] + ellipse.points[1:]) / MM
    assert (np.abs(np.hypot(middle[:, 0], 2 * middle[:, 1]) - 40) <= 0.02 + 1e-9).all()


def distances(points: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Distance of each place from a polyline, every side tried."""
    start, along = points[:-1], np.diff(points, axis=0)
    t = ((places[:, None] - start) * along).sum(axis=2) / (along**2).sum(axis=1)
    return np.hypot(*(places[:, None] - start - np.clip(t, 0, 1)[..., None] * along).transpose(2, 0, 1)).min(axis=1)


def test_distance_of_a_polyline_from_its_curve_is_measured(drawing: Make):
    # an S whose chord it meets in the middle, and a closed spline whose knots do not crowd at its ends
    wave, corners = [(0, 0), (3, 6), (6, -6), (9, 0)], [(100, 100), (110, 100), (110, 110), (100, 110)]

    def draw(m, _):
        m.add_open_spline(wave)
        m.add_spline().apply_construction_tool(closed_uniform_bspline(corners))

    first, second = read(drawing(draw)).outlines
    t = np.linspace(0, 1, 2001)[:, None]
    bernstein = [(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3]
    places = sum(b * np.array(p, dtype=float) for b, p in zip(bernstein, wave, strict=True)) * MM
    away = distances(first.points, places)
    assert first.flattening <= 1e-5
    assert away.max() == pytest.approx(first.flattening, rel=0.1)
    assert second.closed
    # the mean of four neighbouring control points' basis: a uniform cubic begins at (p0 + 4 p1 + p2) / 6
    p = np.array(corners, dtype=float)
    assert second.points[0] == pytest.approx((p[0] + 4 * p[1] + p[2]) / 6 * MM)
    assert (second.points > 100 * MM).all()
    assert (second.points < 110 * MM).all()


def test_frame_of_an_old_fitted_polyline_is_no_line(drawing: Make):
    def draw(m, _):
        line = m.add_polyline2d([(0, 0), (5, 0), (50, 50), (9, 0)])
        line.vertices[2].dxf.flags |= 16

    assert read(drawing(draw)).outlines[0].points == pytest.approx(np.array([[0, 0], [5, 0], [9, 0]]) * MM)


def test_blocks_layers_and_what_is_left_out(drawing: Make):
    def draw(m, d):
        d.layers.add("CUT")
        d.layers.add("HIDDEN").off()
        block = d.blocks.new("PART")
        block.add_line((0, 0), (5, 0))
        block.add_line((5, 0), (5, 5))
        m.add_blockref(
            "PART", (100, 0), dxfattribs={"rotation": 90, "layer": "CUT", "column_count": 2, "column_spacing": 50}
        )
        m.add_line((0, 0), (1, 0), dxfattribs={"layer": "HIDDEN"})
        m.add_line((0, 20), (7, 20))
        m.add_text("note")

    path = drawing(draw)
    found = read(path)
    assert len(found.outlines) == 3
    assert found.outlines[0].points == pytest.approx(np.array([[100, 0], [100, 5], [95, 5]]) * MM, abs=1e-12)
    assert found.warnings == (
        "drawing.dxf: left out 1 × TEXT (no line work)",
        "drawing.dxf: left out 1 × entity on layer HIDDEN (off or frozen)",
    )
    assert [style.layer for style in found.styles] == ["CUT", "CUT", "0"]
    assert len(read(path, layer="cut").outlines) == 2
    with pytest.raises(InputError, match="no layer 'CUTS'; the layers are 0, CUT, Defpoints, HIDDEN"):
        read(path, layer="CUTS")


@pytest.mark.parametrize(("code", "metres"), [(1, 0.0254), (4, 1e-3), (5, 1e-2), (6, 1.0)])
def test_units(drawing: Make, code: int, metres: float):
    path = drawing(lambda m, _: m.add_line((0, 0), (1, 0)), units=code)
    assert read(path).outlines[0].points[1, 0] == metres


def test_units_missing(drawing: Make):
    path = drawing(lambda m, _: m.add_line((0, 0), (1, 0)), units=0)
    with pytest.raises(InputError, match="does not say its unit"):
        read(path)
    assert read(path, units="in").outlines[0].points[1, 0] == 0.0254
    with pytest.raises(InputError, match="unit code 7"):
        read(drawing(lambda m, _: m.add_line((0, 0), (1, 0)), units=7))


def test_loose_entities_are_joined_within_the_gap(drawing: Make):
    def draw(m, _):
        m.add_line((0, 0), (10, 0))
        m.add_line((0, 10), (10, 10))  # against the direction of travel
        m.add_arc((10, 5), 5, -90, 90)
        m.add_line((0, 10.006), (0, 0))
        m.add_line((40, 0), (50, 0))
        m.add_line((50.02, 0), (60, 0))  # too far away

    first, second, third = read(drawing(draw)).outlines
    assert first.closed
    assert "3 joined to it" in first.name
    assert first.points == pytest.approx(np.array([[0, 0], [10, 0], [10, 10], [0, 10], [0, 0]]) * MM, abs=1e-12)
    assert first.bulges == pytest.approx([0, math.tan(math.pi / 4), 0, 0])
    assert not second.closed
    assert not third.closed


@given(st.randoms(use_true_random=False), st.integers(2, 12))
def test_any_order_and_sense_of_the_pieces_gives_the_same_path(random, count: int):
    corners = [np.array([math.cos(2 * math.pi * i / count), math.sin(2 * math.pi * i / count)]) for i in range(count)]
    pieces = []
    for i in range(count if count > 2 else 1):
        ends = np.array([corners[i], corners[(i + 1) % count]])
        piece = Piece(ends, np.array([0.25]), f"piece {i}")
        pieces.append(piece.reverse() if random.random() < 0.5 else piece)
    random.shuffle(pieces)
    (path,) = join(pieces, 1e-6)
    assert len(path.bulges) == len(pieces)
    assert path.closed == (count > 2)
    assert abs(path.bulges).tolist() == [0.25] * len(pieces)
    assert abs(path.bulges.sum()) == pytest.approx(0.25 * len(pieces))  # all of one sense


def nan_line(m, _):
    m.add_line((0, 0), (math.nan, 1))


@pytest.mark.parametrize(
    ("draw", "message"),
    [
        (lambda *_: None, "the drawing is empty"),
        (lambda m, *_: m.add_text("only a note"), "the drawing is empty; left out 1 × TEXT"),
        (
            lambda m, *_: m.add_line((1, 1), (1, 1)),
            r"the drawing is empty; left out 1 × LINE #2F on layer 0 \(no length\)",
        ),
        (nan_line, "LINE #2F on layer 0: .*NaN"),
        (
            lambda m, *_: m.add_lwpolyline([(0, 0, math.inf), (1, 0, 0)], format="xyb"),
            "LWPOLYLINE #2F .*NaN or infinite",
        ),
        (lambda m, *_: m.add_arc((0, 0), math.nan, 0, 90), "ARC #2F on layer 0: radius nan"),
        (lambda m, *_: m.add_arc((0, 0), 1, math.nan, 90), "ARC #2F on layer 0: an angle is NaN"),
        (lambda m, *_: m.add_circle((0, 0), 0), r"left out 1 × CIRCLE #2F on layer 0 \(no length\)"),
        (
            lambda m, *_: m.add_polyline3d([(0, 0, 0), (1, 0, 5)]),
            "POLYLINE #2F on layer 0: it is three-dimensional, from z = 0 to 5",
        ),
        (lambda m, *_: m.add_line((0, 0, 0), (1, 0, 2)), "LINE #2F on layer 0: it is three-dimensional"),
        (lambda m, *_: m.add_lwpolyline([(0, 0), (1, 0)], dxfattribs={"extrusion": (0, 1, 0)}), "its plane is tilted"),
        (lambda m, *_: m.add_lwpolyline([(0, 0)]), r"left out 1 × LWPOLYLINE #2F on layer 0 \(no length\)"),
        (lambda m, *_: m.add_polymesh((3, 3)), "it is a mesh"),
        (nested, "blocks are nested more than 8 deep"),
        (wide, f"unfold to more than {MOST_ENTITIES} entities"),
    ],
)
def test_refused_with_file_entity_and_reason(drawing: Make, draw, message: str):
    path = drawing(draw)
    with pytest.raises(InputError, match=message) as error:
        read(path)
    assert all(fault.startswith(str(path)) for fault in error.value.faults)


def test_all_faults_at_once(drawing: Make):
    def draw(m, d):
        m.add_line((1, 1), (math.nan, 1))
        m.add_circle((0, 0), -1)
        m.add_line((0, 0, 0), (1, 0, 2))

    with pytest.raises(InputError) as error:
        read(drawing(draw))
    assert len(error.value.faults) == 3


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "the drawing is empty"),
        (b"G01 X1\n", "not a DXF file"),
        (b"\x89PNG\r\n\x1a\n" * 10, "not a DXF file"),
        (b"  0\nSECTION\n  2\nENTITIES\n  0\nLINE\nnonsense\n", "not a DXF file"),
        (b"AutoCAD Binary DXF\r\n\x1a\x00\x07", "not a DXF file"),
    ],
)
def test_text_that_is_no_dxf(tmp_path: Path, content: bytes, message: str):
    path = tmp_path / "x.dxf"
    path.write_bytes(content)
    with pytest.raises(InputError, match=message):
        read(path)


def test_missing_file_and_directory(tmp_path: Path):
    with pytest.raises(InputError, match="there is no such drawing"):
        read(tmp_path / "none.dxf")
    with pytest.raises(InputError, match="a directory, not a drawing"):
        read(tmp_path)


def test_a_million_entities_are_refused_before_they_are_read(tmp_path: Path):
    path = tmp_path / "bomb.dxf"
    point = b"  0\nPOINT\n  8\n0\n 10\n0.0\n 20\n0.0\n"
    path.write_bytes(b"  0\nSECTION\n  2\nENTITIES\n" + point * 10**6 + b"  0\nENDSEC\n  0\nEOF\n")
    with pytest.raises(InputError, match=f"more than {MOST_ENTITIES} entities"):
        read(path)


def test_what_has_no_length_is_left_out_with_a_warning(drawing: Make):
    def draw(m, _):
        m.add_lwpolyline([(0, 0), (50, 0), (50, 0), (50, 40), (0, 40), (0, 1e-6)], close=True)
        m.add_line((5, 5), (5, 5))
        m.add_circle((9, 9), 0)
        m.add_lwpolyline([(7, 7), (7, 7)])
        m.add_line((30, 5), (30.005, 5))

    found = read(drawing(draw))
    (frame,) = found.outlines
    assert frame.closed
    assert frame.points == pytest.approx(MM * np.array([[0, 0], [50, 0], [50, 40], [0, 40], [0, 0]]))
    said = "\n".join(found.warnings)
    for part in (
        "1 × segment without length of LWPOLYLINE #2F on layer 0", "LINE #30 on layer 0 (no length)",
        "CIRCLE #31 on layer 0 (no length)", "LWPOLYLINE #32 on layer 0 (no length)", "1 × line not longer than the gap",
    ):  # fmt: skip
        assert part in said


def test_a_bulge_beyond_belief_is_a_line(drawing: Make):
    rows = [(0, 0, 1e9), (100, 0, 0), (100, 50, 0)]
    found = read(drawing(lambda m, _: m.add_lwpolyline(rows, format="xyb")))
    assert found.outlines[0].bulges.tolist() == [0, 0]
    assert "bulge 1e+09 of LWPOLYLINE #2F on layer 0, taken as a line" in found.warnings[0]


def test_the_job_s_unit_wins_over_the_header(drawing: Make):
    path = drawing(lambda m, _: m.add_line((0, 0), (100, 0)), units=1)
    found = read(path, units="mm")
    assert (found.unit, found.size) == ("mm", (0.1, 0.0))
    assert found.warnings == ("drawing.dxf: its header says in ($INSUNITS), the bender job says mm: read in mm",)
    header = read(path)
    assert (header.unit, header.size[0], header.warnings) == ("in", pytest.approx(2.54), ())
    assert read(drawing(lambda m, _: m.add_line((0, 0), (1, 0)), units=7), units="mm").size[0] == 1e-3


@pytest.mark.parametrize("sense", [1, -1])
def test_the_size_holds_the_bellies_of_arcs(drawing: Make, sense: int):
    def draw(m, _):
        m.add_lwpolyline([(0, 0, 0.5 * sense), (30, 0, 0), (30, 1, 0)], format="xyb")
        m.add_arc((100, 50), 20, 80, 280)

    found = read(drawing(draw))
    # naive twin: many places on each arc
    places = [outline.points for outline in found.outlines]
    for outline in found.outlines:
        for k in np.flatnonzero(outline.arcs):
            out = outline.points[k] - outline.centres[k]
            turn = np.linspace(0, outline.included[k], 20001)
            x, y = np.cos(turn) * out[0] - np.sin(turn) * out[1], np.sin(turn) * out[0] + np.cos(turn) * out[1]
            places.append(outline.centres[k] + np.stack([x, y], axis=1))
    assert found.size == pytest.approx(np.ptp(np.vstack(places), axis=0), rel=1e-7)


ABSURD = {
    "line": lambda m, _: m.add_line((0, 0), (1e300, 0)),
    "circle": lambda m, _: m.add_circle((0, 0), 1e300),
    "spline": lambda m, _: m.add_open_spline([(0, 0), (1e300, 1), (3, 4), (5, 6)]),
    "ellipse": lambda m, _: m.add_ellipse((0, 0), (1e300, 0), 0.5),
    "polyline": lambda m, _: m.add_lwpolyline([(0, 0, 1), (1, 1e300, 0.5), (2, 2, 0)], format="xyb"),
    "far away": lambda m, _: m.add_line((1e11, 0), (1e11, 5)),
}


@pytest.mark.parametrize("name", ABSURD)
def test_absurd_coordinates(drawing: Make, name: str):
    with pytest.raises(InputError, match=r"#2F on layer 0: .*(coordinate|geometry)"):
        read(drawing(ABSURD[name]))


@pytest.mark.parametrize("binary", [False, True])
@pytest.mark.parametrize("part", [0.02, 0.5, 0.9, 0.999])
def test_a_file_that_breaks_off(drawing: Make, binary: bool, part: float):
    path = drawing(lambda m, _: m.add_line((0, 0), (9, 0)))
    if binary:
        ezdxf.readfile(path).saveas(path, fmt="bin")
        assert len(read(path).outlines) == 1
    data = path.read_bytes()
    path.write_bytes(data[: int(part * len(data))])
    with pytest.raises(InputError, match=r"not a DXF file to its end: it breaks off without EOF"):
        read(path)


DAMAGE = {
    "handle": ("LINE\n  5\n2F\n", "LINE\n  5\nXYZ\n"),
    "order of coordinates": (" 10\n0.0\n 20\n0.0\n 30\n0.0\n 11\n", " 20\n0.0\n 10\n0.0\n 30\n0.0\n 11\n"),
}


@pytest.mark.parametrize("name", DAMAGE)
def test_a_damaged_file_is_read_as_far_as_it_can_be_repaired(drawing: Make, name: str):
    path = drawing(lambda m, _: m.add_line((0, 0), (9, 0)))
    text = path.read_text()
    assert DAMAGE[name][0] in text
    path.write_text(text.replace(*DAMAGE[name]))
    found = read(path)
    assert found.outlines[0].lengths == pytest.approx([9 * MM])
    assert "the file is damaged" in found.warnings[0]
    assert "was read as far as it could be repaired" in found.warnings[0]


def test_what_the_repair_did_is_said(drawing: Make):
    path = drawing(lambda m, _: m.add_line((0, 0), (9, 0)))
    path.write_text(path.read_text().replace("LINE\n  5\n2F\n", "LINE\n  5\nXYZ\n 62\n1.0\n"))
    assert any('repaired: recovered invalid integer value "1.0"' in text for text in read(path).warnings)


def test_a_number_is_not_guessed(drawing: Make):
    path = drawing(lambda m, _: m.add_line((0, 0), (9.5, 0)))
    path.write_text(path.read_text().replace("11\n9.5\n", "11\n9,5\n"))
    with pytest.raises(InputError, match=r"numbers cannot be read .* a guessed coordinate is none"):
        read(path)


def test_devices_are_no_drawings():
    with pytest.raises(InputError, match="/dev/zero: a device or a pipe, not a drawing"):
        read(Path("/dev/zero"))
