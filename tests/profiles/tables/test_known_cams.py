"""Cams whose interpolation is known from the makers' own data, and foreign texts that must be read as meant."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from camwright.drives.options import with_slopes
from camwright.profiles.errors import InputError
from camwright.profiles.tables.cam_table import make_table
from camwright.profiles.tables.interpolation import quintics
from camwright.profiles.tables.splines import clamped_spline, cyclic_spline
from camwright.profiles.tables.targets import TARGETS, detect
from camwright.profiles.tables.text import decode

L5X = """<?xml version="1.0" encoding="UTF-8"?>
<RSLogix5000Content SchemaRevision="1.0"><Controller Use="Context"><Tags Use="Context">
<Tag Name="KnifeCam" TagType="Base" DataType="CAM" Dimensions="{n}" Constant="false" ExternalAccess="Read/Write">
{data}
</Tag>{more}
</Tags></Controller></RSLogix5000Content>
"""
SLOPE = (
    '<Tag Name="KnifeCam_StartSlope" TagType="Base" DataType="REAL" Radix="Float"><Data Format="Decorated">'
    '<DataValue DataType="REAL" Radix="Float" Value="1.0"/></Data></Tag>'
)
ROWS = '<Data Format="L5K"><![CDATA[[[0.0,0.0,1],[40.0,20.0,1],[100.0,25.0,1]]]]></Data>'

# A captured CAM_PROFILE: rows of 14 integers, and the coefficients that they decode to.
CAPTURED = (
    "[[2,0,0,0,0,1,0,0,1072693248,0,-1080956027,515396076,1059086925,-755914243],"
    "[2,1078198272,0,1077149696,0,1,0,0,1070176665,-1717986918,{c2},{c3}],"
    "[2,1079574528,0,1077477376,0,1,0,0,0,0,0,0,0,0]]"
)
RECORDED = np.array([[0, 1, -0.0175, 1.25e-4], [20, 0.2, -0.0025, 9.259259259e-6]])


def words(value: float) -> str:
    high, low = np.array([value]).astype(">f8").view(">i4")
    return f"{high},{low}"


def test_the_captured_profile_of_logix_is_the_clamped_spline() -> None:
    end = SLOPE.replace("StartSlope", "EndSlope").replace('"1.0"', '"0.0"')
    table = TARGETS["logix"].read(L5X.format(n=3, data=ROWS, more=SLOPE + end), "cam.L5X")
    rebuilt = TARGETS["logix"].rebuild(table)
    assert rebuilt.breaks.tolist() == [0, 40, 100]
    assert rebuilt.coefficients == pytest.approx(RECORDED, abs=1e-6)
    assert rebuilt.coefficients[:, 3] == pytest.approx(RECORDED[:, 3], rel=1e-6)
    assert rebuilt(100.0, 1) == pytest.approx(0, abs=1e-12)


def test_coefficients_are_read_from_a_captured_profile() -> None:
    body = CAPTURED.format(c2=words(-0.0025), c3=words(1 / 108_000))
    text = L5X.format(n=3, data=f'<Data Format="L5K"><![CDATA[{body}]]></Data>', more="").replace(
        'DataType="CAM"', 'DataType="CAM_PROFILE"'
    )
    rebuilt = TARGETS["logix"].rebuild(TARGETS["logix"].read(text, "profile.L5X"))
    assert rebuilt.coefficients[:, :4] == pytest.approx(RECORDED, abs=1e-9)
    assert rebuilt.coefficients[:, 4:] == pytest.approx(np.zeros((2, 2)), abs=1e-12)


def test_linear_segments_of_logix() -> None:
    rows = ROWS.replace("[40.0,20.0,1]", "[40.0,20.0,0]")
    table = TARGETS["logix"].read(L5X.format(n=3, data=rows, more=""), "cam.L5X")
    with pytest.raises(InputError, match="--slopes START,END"):  # none is invented
        TARGETS["logix"].rebuild(table)
    rebuilt = TARGETS["logix"].rebuild(with_slopes(table, "0,0"))
    assert rebuilt(70.0) == pytest.approx(22.5)
    assert rebuilt(40.0, 1, side="left") == pytest.approx(5 / 60)  # the spline runs into the line


def test_decorated_data_come_first_and_unused_rows_are_dropped() -> None:
    element = (
        '<Element Index="[{k}]"><Structure DataType="CAM"><DataValueMember Name="Slave" Value="{y}"/>'
        '<DataValueMember Name="SegmentType" Value="1"/><DataValueMember Name="Master" Value="{x}"/></Structure>'
        "</Element>"
    )
    rows = [(0, 0), (40, 20), (90, 25), (0, 0), (0, 0)]
    elements = "".join(element.format(k=k, x=x, y=y) for k, (x, y) in enumerate(rows))
    same = '<Data Format="L5K"><![CDATA[[[0,0,1],[40,20,1],[90,25,1]]]]></Data>'
    data = f'{same}<Data Format="Decorated"><Array DataType="CAM" Dimensions="5">{elements}</Array></Data>'
    table = TARGETS["logix"].read(L5X.format(n=5, data=data, more=""), "cam.L5X")
    assert table.x.tolist() == [0, 40, 90]
    data = data.replace("[40,20,1]", "[40,21,1]")
    with pytest.raises(InputError, match="the two copies of 'KnifeCam'"):
        TARGETS["logix"].read(L5X.format(n=5, data=data, more=""), "cam.L5X")


CODESYS = """
{{attribute 'qualified_only'}}
VAR_GLOBAL
 a : ARRAY[0..3] OF SMC_CAMXYVA := [ {points} ];
 c : MC_CAM_REF := (byType := {kind}, xStart := 0, xEnd := 360, nElements := 4, nTappets := 0);
END_VAR
"""
DEFAULT = [
    "(dX := 0.0, dY := 0.0, dV := 0.0, dA := 0.0)",
    "(dX := 120.0, dY := 120.0, dV := 1.0, dA := 0.0)",
    "(dX := 240.0, dY := 240.0, dV := 1.0, dA := 0.0)",
    "(dX := 360.0, dY := 360.0, dV := 0.0, dA := 0.0)",
]


def is_the_default_cam(rebuilt: object) -> bool:
    # y = 120 (6u³ − 8u⁴ + 3u⁵) from rest to ratio 1, the straight line, and the first part from its end
    u = np.linspace(0, 1, 101)
    first = Polynomial([0, 0, 0, 6, -8, 3])(u) * 120
    third = 360 - first[::-1]
    y = rebuilt(np.concatenate([120 * u, 120 + 120 * u, 240 + 120 * u]))  # type: ignore[operator]
    return bool(np.abs(y - np.concatenate([first, 120 + 120 * u, third])).max() <= 1e-12 * 360)


@pytest.mark.parametrize(
    ("points", "kind"),
    [
        (DEFAULT, "SMC_CAM_TYPE.XYVA"),
        (DEFAULT, "3"),
        (
            [
                "(dY:=LREAL#0, dX:=0)",
                "(dA:=0,dV:=1.0E0,dY:=1_20,dX:=LREAL#1.2E+2)",
                *DEFAULT[2:3],
                "(dX := 360, dY := 36.0e1)",
            ],
            "3",
        ),
        ([DEFAULT[0], "(* one *) // two (*\n" + DEFAULT[1] + "/* three */", "\n" + DEFAULT[2], DEFAULT[3]], "BYTE#3"),
    ],
)
def test_the_default_cam_of_codesys(points: list[str], kind: str) -> None:
    text = CODESYS.format(points=",\n".join(points), kind=kind)
    assert detect(text, "cam").name == "codesys"
    assert is_the_default_cam(TARGETS["codesys"].rebuild(TARGETS["codesys"].read(text, "cam.st")))


def test_the_builders_example() -> None:
    text = """VAR camBuilder : SMCB.CamBuilder; END_VAR
    camBuilder.Init();
    camBuilder.Append(SMCB.Poly5(SMCB.BoundImplicit(), SMCB.Bound(120, 120, 1)));
    camBuilder.Append(
        SMCB.Poly5(SMCB.BoundImplicit(), SMCB.Bound(240, 240, 1)));
    camBuilder.Append(SMCB.Poly5(SMCB.Bound(240, 240, 1, 0), SMCB.Bound(360, 360)));
    SMCB.InitCamRef(camRef, ADR(aCamSegments), XSIZEOF(aCamSegments)); camBuilder.Write(camRef);"""
    assert detect(text, "cam").name == "codesys-cambuilder"
    for target in ("codesys", "codesys-cambuilder"):
        assert is_the_default_cam(TARGETS[target].rebuild(TARGETS[target].read(text, "cam.st")))


def test_xy_tables_of_codesys() -> None:
    text = """VAR t : SMC_CAMTable_LREAL_3_2 := (Table := [[0, 0], [1, 2], [3, 3]], fEditorMasterMin := 0);
    c : MC_CAM_REF := (byType := 2, byInterpolationQuality := {q}, nElements := 3); END_VAR"""
    line = TARGETS["codesys"].rebuild(TARGETS["codesys"].read(text.format(q=1), "t"))
    assert line(2.0) == 2.5
    spline = TARGETS["codesys"].read(text.format(q=3), "t")
    assert set(spline.laws) == {"spline"}


def test_the_public_generators_form_of_a_twincat_cam() -> None:
    point = """point := {k};
    _Camming.camPoints[point].SlavePos := {y}; _Camming.camPoints[point].MasterPos := {x};
    _Camming.camPoints[point].PointIndex := point;
    _Camming.camPoints[point].FunctionType := {f};
    _Camming.camPoints[point].PointType := {t};
    _Camming.camPoints[point].RelIndexNextPoint := 1; _Camming.camPoints[point].SlaveVelo := {v};
    _Camming.camPoints[point].SlaveJerk := 0.00;
    """
    rows = [
        {"k": 1, "x": "0.0", "y": "0.0", "v": "0.0", "f": "MC_X.MOTIONFUNCTYPE_POLYNOM5_MM", "t": "16#2000"},
        {"k": 2, "x": "120.0", "y": "120.0", "v": "1.0", "f": "1", "t": "MC_MotionPointType.MOTIONPOINTTYPE_MOTION"},
        {"k": 3, "x": "180.0", "y": "0.0", "v": "7.0", "f": "1", "t": "0"},
        {"k": 4, "x": "240.0", "y": "240.0", "v": "1.0", "f": "POLYNOM5_MM", "t": "8"},
        {"k": "point + 1", "x": "360.0", "y": "360.0", "v": "0.0", "f": "15", "t": "MOTIONPOINTTYPE_MOTION"},
    ]
    text = (
        "".join(point.format(**row) for row in rows)
        + "_Camming.camTableSelect(CamTable := _Camming.camRef, Execute := TRUE);"
    )
    assert detect(text, "cam").name == "twincat"
    table = TARGETS["twincat"].read(text, "cam.st")
    assert table.laws == ("quintic", "line", "quintic")  # the third point is of the type IGNORE
    assert is_the_default_cam(TARGETS["twincat"].rebuild(table))


def test_position_tables_of_twincat() -> None:
    for text in (
        "Table1 : ARRAY[0..3, 0..1] OF LREAL := [0.0, 0.0, 10.0, 5.0, 20.0, 11.0, 2(30.0)];",
        (
            "Table1[1,0] := 10; Table1[1,1] := 5; Table1[0][0] := 0; Table1[0,1] := 0.0; T2 := 7;"
            "Table1[2,0] := 20.0; Table1[2,1] := 11.0; Table1[3,0] := 30.0; Table1[3,1] := 30.0;"
        ),
    ):
        table = TARGETS["twincat-table"].read(text, "t.st")
        assert table.x.tolist() == [0, 10, 20, 30]
        assert table.y.tolist() == [0, 5, 11, 30]


def test_siemens_assignments() -> None:
    text = """camProfile : ARRAY[1..2] OF LCamHdl_typeBasicPoint;
    camProfile[1].leadingValue := 0.0; camProfile[1].followingValue := 0.0;
    camProfile[2].leadingValue := 1.0; camProfile[2].followingValue := 1.0;
    camProfile[2].velocityRatio := 0; camProfile[2].accelerationRatio := 0;"""
    table = TARGETS["s7-1500t"].read(text, "t")
    assert TARGETS["s7-1500t"].rebuild(table)(0.5) == pytest.approx(0.5)  # 3-4-5


def test_the_sample_of_schneider_is_half_a_cosine() -> None:
    head = "Header=SoMachine Motion Builder\r\nVersion=4.2\r\nYFactor=30\r\nxfactor=360\r\nYOffset=-10\r\nXOffset=5\r\n"
    head += "StartSlope=0\r\nEndSlope=0\r\nInterpolationMode=1\r\nCamPoints\r\n"
    values = 0.5 * (1 - np.cos(np.pi * np.arange(360) / 359))
    assert values[1:4] == pytest.approx([1.91446788459615e-05, 7.65772493088808e-05, 0.000172293313276365], rel=1e-11)
    text = "\ufeff" + head + "\r\n".join(map(repr, values.tolist())) + "\r\n"
    rebuilt = TARGETS["schneider-asc"].rebuild(TARGETS["schneider-asc"].read(decode(text.encode(), "a"), "a"))
    x = np.linspace(5, 365, 1001)
    assert rebuilt(x) == pytest.approx(-10 + 15 * (1 - np.cos(np.pi * (x - 5) / 360)), abs=1e-7)


def test_foreign_point_lists() -> None:
    lenze = TARGETS["lenze"].read("10.0 20.0 1.0 // point 1\n\n20,0\t30,0 2.5 // point 2\n", "t")
    assert (lenze.x.tolist(), lenze.y.tolist()) == ([10, 20], [20, 30])
    for text in ("3\n0\t0\n0.125\t1\n1\t2\n", "3;\n0;0\n0,125;1\n1;2\n", "3\r\n0;0\r\n0.125;1\r\n1;2"):
        table = TARGETS["sew"].read(decode(text.encode(), "t"), "t")
        assert table.x.tolist() == [0, 0.125, 1]
    rows = ("0;0", "100;111", "200;222", "300;333", "1000;1000")
    kas = "CYCLIC;YES;\nTABLE_BEGIN;;\n" + "".join(f"{row};SPLINE\n" for row in rows) + "TABLE_END;;\n"
    table = TARGETS["kollmorgen-kas"].read(kas, "t")
    assert (table.points, table.periodic, table.advance) == (5, True, 1000)
    assert detect(kas, "t").name == "kollmorgen-kas"
    technosoft = TARGETS["technosoft"].read("0 0\n128 5\n256\t9\n", "t")
    assert technosoft.y.tolist() == [0, 5, 9]
    trio = TARGETS["trio"].read("TABLE(4, 3, 4)\ntable ( 0, 0, 1, 2,2 )\n", "t")
    assert trio.y.tolist() == [0, 1, 2, 2, 3, 4]


def test_zebra_tables_of_the_cnc_kernel() -> None:
    text = (
        "Tablename = Smallest_Table # Table name\nTable-ID = 404\nTabletype = 7 # 2-column\nFunction type = 4\n"
        "Lines = 2\nBegintable\n100000 0\n1500000 3400000\nEndTable\n"
    )
    table = TARGETS["twincat-cnc"].read(text, "t")
    assert table.laws == ("quintic", "line")  # the segment from the last pair to the first is the first segment
    rebuilt = TARGETS["twincat-cnc"].rebuild(table)
    slope = -3400000 / 2200000
    assert rebuilt(100000.0, 1) == pytest.approx(slope)
    assert rebuilt(1500000.0, 1, side="left") == pytest.approx(slope)
    assert rebuilt.jumps(2) == pytest.approx([0, 0], abs=1e-16)
    column = "Tablename T\nTable-ID 1\nTabletype 3\nFunctiontype 1\nLines 4\n"
    column += "Begintable\n0,5 # a\n1,5E+0\n6,12574E-17\n1\nEndTable"
    table = TARGETS["twincat-cnc"].read(column, "t")
    assert table.x.tolist() == [0, 900_000, 1_800_000, 2_700_000, 3_600_000]
    assert table.y.tolist() == [0.5, 1.5, 6.12574e-17, 1, 0.5]


def test_a_written_zebra_table_comes_back() -> None:
    x = np.array([0.0, 2_400_000, 3_600_000])
    table = make_table(x, [0, 1_000_000, 2_200_000], [1, 1, 1], [0, 0, 0], law=("quintic", "line"))
    from knives import HEADER

    text = next(iter(TARGETS["twincat-cnc"].write(table, HEADER).values()))
    assert "Functiontype = 4" in text
    back = TARGETS["twincat-cnc"].read(text.replace("advance", "gone"), "t")
    assert not back.travel_known
    assert back.laws == ("quintic", "line")


@pytest.mark.parametrize("points", [2, 3, 4, 5, 12, 200])
def test_splines_against_scipy(points: int) -> None:
    from scipy.interpolate import CubicSpline

    rng = np.random.default_rng(points)
    x = np.cumsum(rng.uniform(0.1, 1, points))
    y = rng.uniform(0, 1, points)
    dense = np.linspace(x[0], x[-1], 999)
    theirs = CubicSpline(x, y, bc_type=((1, 0.5), (1, -2.0)))
    for order in range(3):
        size = np.abs(theirs(dense, order)).max()
        assert clamped_spline(x, y, 0.5, -2.0)(dense, order) == pytest.approx(theirs(dense, order), abs=1e-14 * size)
    if points > 2:
        y[-1] = y[0]
        theirs = CubicSpline(x, y, bc_type="periodic")
        for order in range(3):
            size = np.abs(theirs(dense, order)).max()
            assert cyclic_spline(x, y)(dense, order) == pytest.approx(theirs(dense, order), abs=1e-14 * size)
    else:
        assert cyclic_spline(x, y)(dense, 1) == pytest.approx((y[1] - y[0]) / (x[1] - x[0]))


def test_splines_against_their_conditions() -> None:
    rng = np.random.default_rng(3)
    x = np.cumsum(rng.uniform(0.1, 1, 12))
    y = np.cumsum(rng.uniform(0, 1, 12))
    clamped = clamped_spline(x, y, 0.3, -0.7)
    assert clamped(x) == pytest.approx(y)
    assert [float(clamped(x[0], 1)), float(clamped(x[-1], 1))] == pytest.approx([0.3, -0.7])
    cyclic = cyclic_spline(x, y)
    for order in (0, 1, 2):
        assert cyclic.jumps(order) == pytest.approx(np.zeros(11), abs=1e-11)
    assert cyclic.advance == pytest.approx(y[-1] - y[0])


def test_a_quintic_against_its_conditions() -> None:
    table = make_table([0, 0.5, 2], [1, -1, 3], [0.5, 2, -1], [3, -4, 5])
    rebuilt = quintics(table)
    for k, x in enumerate(table.x):
        for order, column in enumerate((table.y, table.ratio, table.ratio_slope)):
            for side in ("left", "right"):
                assert rebuilt(x, order, side=side) == pytest.approx(column[k])  # type: ignore[arg-type]


@pytest.mark.parametrize("text", ["0,0\n1.5,2\n3,3\n", "# mine\n0;0\n1,5;2\n3;3", "0\t0\n1,5\t2.0\n3\t3\n"])
def test_two_plain_columns(text: str) -> None:
    assert detect(text, "t").name == "csv"
    table = TARGETS["csv"].read(text, "t")
    assert (table.x.tolist(), table.y.tolist(), table.units) == ([0, 1.5, 3], [0, 2, 3], None)
    assert TARGETS["csv"].rebuild(table).jumps(2) == pytest.approx([0, 0], abs=1e-12)
