"""Files as they come from the field and from worse places: read rightly, or refused with file, line and reason."""

from __future__ import annotations

import re
import time
import tracemalloc
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from knives import main_text

from camwright.profiles.errors import InputError
from camwright.profiles.tables.cam_table import CamTable
from camwright.profiles.tables.targets import (
    TARGETS,
    detect,
    read_table,
    target_of,
)
from camwright.profiles.tables.text import LARGEST_FILE, decode, read_text
from tests.pace import in_time


def texts() -> dict[str, str]:
    return {target: main_text(target, "jerk-limited")[1] for target in TARGETS}


def read(target: str, data: bytes) -> CamTable:
    return read_table(TARGETS[target], decode(data, "cam.file"), "cam.file")


def same(target: str, data: bytes) -> bool:
    back, plain = read(target, data), read(target, texts()[target].encode())
    return back.x.tolist() == plain.x.tolist() and back.y.tolist() == plain.y.tolist()


# -- what is read rightly


@pytest.mark.parametrize("target", TARGETS)
def test_line_ends_marks_and_encodings_make_no_difference(target: str) -> None:
    text = texts()[target].replace("\r\n", "\n")
    assert same(target, text.replace("\n", "\r\n").encode())
    assert same(target, b"\xef\xbb\xbf" + text.encode())
    assert same(target, text.encode("utf-16"))
    assert same(target, text.rstrip("\n").encode())
    assert same(target, text.replace("\n", "\r").encode())


def test_a_latin_1_comment_is_no_obstacle() -> None:
    assert same("lenze", texts()["lenze"].replace("//", "// Kurvenstück", 1).encode("latin-1"))
    assert same("codesys", b"(* Messer f\xfcr Stra\xdfe *)\n" + texts()["codesys"].encode())


def test_decimal_commas_where_the_separator_is_another() -> None:
    for target, change in (("lenze", True), ("sew", True), ("twincat-cnc", False)):
        text = re.sub(r"(?m)^([-0-9]+)\.([0-9]+)(\s)([-0-9]+)\.([0-9]+)", r"\1,\2\3\4,\5", texts()[target])
        assert (text != texts()[target]) == change
        assert same(target, text.encode())


def test_members_in_any_order_and_statements_on_one_line() -> None:
    text = texts()["codesys"]
    turned = re.sub(r"\(dX := (\S+), dY := (\S+), dV := (\S+), dA := (\S+)\)", r"(dA:=\4,dY:=\2,dV:=\3,dX:=\1)", text)
    assert turned != text
    assert same("codesys", turned.encode())
    lines = texts()["twincat"].splitlines()
    points = [line for line in lines if line.startswith("camPoints")]
    others = [line for line in lines if not line.startswith(("camPoints", "//"))]
    body = " ".join(reversed(points))
    assert same("twincat", " ".join([*others[:5], body, *others[5:]]).encode())


def test_enums_by_number() -> None:
    text = texts()["twincat"]
    for name, number in (("POLYNOM1;", "1;"), ("POLYNOM5_MM;", "INT#15;")):
        text = text.replace(f"MC_MotionFunctionType.MOTIONFUNCTYPE_{name}", number)
    text = text.replace("MC_MotionPointType.MOTIONPOINTTYPE_MOTION", "16#0008")
    assert "POLYNOM" not in text
    assert same("twincat", text.encode())
    br = texts()["br"].replace("mcCAMSECTLAW_5TH_ORDER_POLYNOM", "4").replace("mcCAMSECTLAW_LAST_POINT", "0")
    assert same("br", br.replace("mcCAMSECTREF_ABSOLUTE", "0").encode())


# -- what is refused

Corpus = tuple[str, str, bytes, str]


def corpus() -> Iterator[Corpus]:
    """Name, target, bytes and the reason that the refusal must give."""
    t = texts()
    big = b"1" * 10_000_000
    for target in TARGETS:
        yield f"10 MB line, {target}", target, big, "larger than 4000000 bytes"
        yield f"empty, {target}", target, b"", "the file is empty"
        yield f"blank, {target}", target, b"\xef\xbb\xbf \n\t\r\n", "the file is empty"
        yield f"binary, {target}", target, bytes(range(256)) * 40, "this is not a text file"
        yield f"prose, {target}", target, b"All work and no play makes Jack a dull boy.\n" * 50, "."
        yield f"zeros, {target}", target, b"\x00" * 3_000_000, "not a text file"
        yield f"long line below the limit, {target}", target, b"7 " * 1_900_000, "."
        yield f"brackets, {target}", target, b"x := " + b"(" * 3_000_000, "."
        if target != "schneider-asc":  # its layout neither counts its points nor marks its end
            yield f"half the file, {target}", target, t[target].encode()[: len(t[target]) * 3 // 5], "."
    yield "odd UTF-16", "lenze", b"\xff\xfe0\x00 \x00\xd8\xdb", "begins like UTF-16 but is not"
    yield "unicode digits", "lenze", "0 0\n١ ٢\n".encode(), r"line 2: '\\u0661' is not a number"
    yield "unicode digits in code", "codesys", t["codesys"].replace("dX := ", "dX := ٣").encode(), "begins nothing"
    yield "superscript", "sew", "2\n0\t0\n²\t1\n".encode(), "line 3: .* is not a number"
    yield "NaN", "lenze", b"0 0\nNaN 1\n", "line 2: 'NaN' is not a number"
    yield "infinity", "lenze", b"0 0\n1 1e999\n", r"line 2: '1e999' is beyond 1e\+12"
    yield "inf", "kollmorgen-kas", t["kollmorgen-kas"].replace("600.0;", "inf;", 1).encode(), "'inf' is not a number"
    yield "nan in code", "s7-1500t", t["s7-1500t"].replace(":= 600.0", ":= nan", 1).encode(), "must be a number"
    yield "underscored", "sew", b"2\n0\t0\n1_0\t1\n", "is not a number"
    yield "hexadecimal", "sew", b"2\n0\t0\n0x10\t1\n", "is not a number"
    yield "huge integer", "technosoft", b"0 0\n1 " + b"9" * 1500, "is not a whole number"
    yield "huge number", "lenze", b"0 0\n1 " + b"9" * 1500, "is not a number"
    yield (
        "decimal comma between commas",
        "csv",
        b"x [mm],y [mm]\n0,0,0,0\n1,0,1,0\n2,0,2,0\n3,0,3,0\n",
        "line 2: 4 cells",
    )
    yield "comma and point", "lenze", b"0 0\n1.000,5 1\n", "is not a number"
    yield "count too large", "sew", b"5\n0\t0\n1\t1\n", "says 5 points, but 2 follow"
    yield "count missing", "sew", b"0.0\t0.0\n1\t1\n", "line 1: .* is not a whole number"
    yield "negative count", "sew", b"-2\n0\t0\n1\t1\n", "says -2 points"
    yield "one column", "sew", b"2\n0\n1\n", "line 2: the line has 1 values"
    yield "four columns", "lenze", b"0 0 0 0\n", "line 1: the line has 4 values"
    yield (
        "duplicates",
        "lenze",
        b"0 0\n1 1\n1 2\n",
        r"line 3: master positions must increase strictly; 1\.0 occurs twice",
    )
    yield "descending", "lenze", b"0 0\n2 1\n1 2\n", r"line 3: .*; 1\.0 follows 2\.0"
    yield "one point", "lenze", b"0 0\n", "at least 2 points; the file holds 1"
    yield "too many lines", "lenze", b"1 1\n" * 100_000, "there are 100001 lines"
    yield "rows after the end", "kollmorgen-kas", t["kollmorgen-kas"].encode() + b"1;1;SPLINE\n", "is not expected here"
    yield (
        "linear rows",
        "kollmorgen-kas",
        t["kollmorgen-kas"].replace("SPLINE", "LINE").encode(),
        "line 3: .* x;y;SPLINE",
    )
    yield "no cyclic", "kollmorgen-kas", t["kollmorgen-kas"].replace("CYCLIC;YES;\n", "").encode(), "CYCLIC;YES; or"
    yield (
        "three segments",
        "kollmorgen-kas",
        b"CYCLIC;NO;\nTABLE_BEGIN\n0;0;SPLINE\n1;1;SPLINE\nTABLE_END",
        "at least 5",
    )
    yield "key twice", "schneider-asc", b"YFactor=1\r\nyfactor=2\r\nCamPoints\r\n", "line 2: 'yfactor' is given twice"
    yield "no key", "schneider-asc", b"CamPoints\n0\n1\n", "the head has no yfactor"
    asc = t["schneider-asc"]
    yield "negative factor", "schneider-asc", asc.replace("XFactor=", "XFactor=-").encode(), "XFactor must be positive"
    yield "other mode", "schneider-asc", asc.replace("Mode=1", "Mode=2").encode(), "InterpolationMode '2' is not read"
    yield "wrong Lines", "twincat-cnc", t["twincat-cnc"].replace("Lines = 3", "Lines = 9").encode(), "Lines says 9"
    yield "no EndTable", "twincat-cnc", t["twincat-cnc"].replace("EndTable", "").encode(), "EndTable is missing"
    four = b"Tabletype = 5\nFunctiontype = 3\nLines = 1\nBegintable\n0 1 2 3\nEndTable"
    yield "coefficients", "twincat-cnc", four, "Tabletype 5 with Functiontype 3 is not read"
    yield "unknown key", "twincat-cnc", b"Tabellenname = x\n", "line 1: 'Tabellenname = x' is no line"
    yield (
        "odd zebra",
        "twincat-cnc",
        (b"Tabletype = 7\nFunctiontype = 4\nLines = 3\nBegintable\n0 0\n1 1\n2 2\nEndTable"),
        "even number of pairs; there are 3",
    )
    yield (
        "two turns",
        "twincat-cnc",
        (b"Tabletype = 7\nFunctiontype = 1\nLines = 2\nBegintable\n0 0\n3600000 1\nEndTable"),
        "more than one turn",
    )
    yield "uneven", "technosoft", b"0 0\n1 1\n3 2\n", "line 3: the master positions must be evenly spaced"
    yield "spacing", "technosoft", b"0 0\n3 1\n", "line 2: .* evenly spaced"
    yield "decimals", "technosoft", b"0 0\n1 1.5\n", r"line 2: '1\.5' is not a whole number"
    yield "33 bits", "technosoft", b"0 0\n1 2147483648\n", "outside 32 bits"
    yield "gap", "trio", b"TABLE(0, 1, 2)\nTABLE(3, 4)\n", "the addresses of the table have a gap"
    yield "twice", "trio", b"TABLE(0, 1, 2)\nTABLE(1, 4)\n", "line 2: the address 1 is filled twice"
    yield "basic", "trio", b"MOVE(3)\n", "there is no line TABLE"
    st_text = t["codesys"]
    points = st_text.index("SMC_CAMXYVA := [")
    yield (
        "nElements",
        "codesys",
        re.sub(r"nElements := \d+", "nElements := 77", st_text).encode(),
        "nElements does not agree",
    )
    yield (
        "xEnd",
        "codesys",
        st_text.replace("xEnd := 600.0", "xEnd := 500.0").encode(),
        r"xend does not agree .* 600\.0",
    )
    yield "byType", "codesys", st_text.replace("SMC_CAM_TYPE.XYVA", "2").encode(), "byType does not say XYVA"
    yield (
        "missing row",
        "codesys",
        re.sub(r"\(dX := 0\.0[^)]*\),\s*", "", st_text).encode(),
        r"has \d+ places but \d+ values",
    )
    yield "unknown member", "codesys", st_text.replace("dV :=", "dQ :=").encode(), "SMC_CAMXYVA has no member 'dq'"
    yield "member twice", "codesys", st_text.replace("dV :=", "dY :=").encode(), "the member 'dy' is given twice"
    yield "open comment", "codesys", st_text.encode() + b"(* and on", "a comment begins here and never ends"
    yield (
        "deep",
        "codesys",
        (st_text[:points] + "SMC_CAMXYVA := " + "[" * 400 + "]" * 400).encode(),
        "nested more than 8",
    )
    yield "bomb", "codesys", (st_text[:points] + "SMC_CAMXYVA := [99999999((dX := 1))]").encode(), "cannot be repeated"
    yield (
        "bombs",
        "codesys",
        (st_text[:points] + "SMC_CAMXYVA := [" + "399999(" * 6 + "(dX := 1)" + ")" * 6 + "];").encode(),
        ".",
    )
    yield (
        "two cams",
        "codesys",
        st_text.encode() + st_text.encode().replace(b"aKnife", b"bKnife"),
        "more than one array",
    )
    yield "too many words", "codesys", b"a;" * 1_500_000, "goes on beyond 200000 words"
    yield "array of a million", "codesys", b"x : ARRAY[0..99999999] OF SMC_CAMXYVA := [];", "up to 1000000"
    yield "no poly5", "codesys-cambuilder", b"b.Append(SMCB.Poly7(a, b));", r"one SMCB\.Poly5\(left, right\) only"
    yield "bound", "codesys-cambuilder", b"b.Append(SMCB.Poly5(SMCB.BoundImplicit(), 7));", "a segment's bound must be"
    yield "open bound", "codesys-cambuilder", b"b.Append(Poly5(BoundImplicit(), BoundImplicit()));", "right bound"
    yield (
        "broken chain",
        "codesys-cambuilder",
        (b"b.Append(Poly5(Bound(0), Bound(1, 1)));b.Append(Poly5(Bound(1, 2), Bound(2, 1)));"),
        "not the right bound of the segment before",
    )
    tc = t["twincat"]
    yield "index", "twincat", tc.replace("PointIndex := 2;", "PointIndex := 7;").encode(), "PointIndex must be 2"
    yield "jump", "twincat", tc.replace("RelIndexNextPoint := 1;", "RelIndexNextPoint := 2;").encode(), "in their order"
    for value in ("0,0", "NaN", "2.0*0.5", "rJerk"):
        spoilt = tc.replace("SlaveJerk := 0.0;", f"SlaveJerk := {value};", 1).encode()
        assert spoilt != tc.encode()
        yield f"jerk {value}", "twincat", spoilt, "slavejerk must be a number"
    for value in ("2.0*(0.5*1)", "1+1.0", "1.0abc", "1 (2)"):
        bound = f"b.Append(Poly5(Bound(0), Bound(2, {value})));".encode()
        yield f"bound {value}", "codesys-cambuilder", bound, "a bound's value must be a number"
    yield "bound left out", "codesys-cambuilder", b"b.Append(Poly5(Bound(0), Bound(2, 1, )));", r"missing before '\)'"
    logix = t["logix"]
    slope = logix.replace("[0.9]]></Data>", "[1.5]]></Data>", 1).encode()
    assert slope != logix.encode()
    yield "two slopes", "logix", slope, r"two copies of '\w+_StartSlope' \(L5K and Decorated\) differ: 1.5 and 0.9"
    yield "third value", "lenze", b"0 0\n1 0.5\n2 1 .5\n3 2\n", "line has 3 values, those above it 2"
    asc = t["schneider-asc"]
    at = asc.index("CamPoints") + 20
    end = asc.index("\n", at) + 1
    yield "empty row", "schneider-asc", (asc[:end] + "\r\n" + asc[end:]).encode(), "among the points is empty"
    yield "named bound", "codesys-cambuilder", b"b.Append(Poly5(Bound(0), Bound(Y := 2, X := 1)));", "without names"
    yield (
        "named side",
        "codesys-cambuilder",
        b"b.Append(Poly5(right := Bound(0), left := Bound(2, 1)));",
        "without names",
    )
    yield (
        "gap in points",
        "twincat",
        re.sub(r"camPoints\[3\].*\n", "", tc).encode(),
        "the points have a gap: 4 follows 2",
    )
    yield "other law", "twincat", tc.replace("POLYNOM5_MM", "SINUSLINIE").encode(), "motion function .* is not read"
    yield "law 24", "twincat", b"p[1].FunctionType := 24;p[2].FunctionType := 15;", "motion function '24.0' is not read"
    yield "no rest", "twincat", re.sub("POLYNOM5_MM", "POLYNOM5", tc).encode(), "a POLYNOM5 leads from rest to rest"
    yield (
        "given twice",
        "twincat",
        tc.encode() + b"camPoints[2].MasterPos := 7.0;",
        "given twice, with different values",
    )
    yield "ragged", "twincat-table", b"T[0,0] := 1; T[0,1] := 1; T[1,0] := 2;", "one cell only|missing"
    yield "third column", "twincat-table", b"T[0,0] := 1; T[0,2] := 1;", "the columns 0 and 1, not 2"
    many = ",".join(f"(leadingValue:={k})" for k in range(52))
    yield (
        "52 points",
        "s7-1500t",
        f"p : ARRAY[1..52] OF LCamHdl_typeBasicPoint := [{many}];".encode(),
        "at most 51 points",
    )
    yield (
        "33 segments",
        "pacdrive",
        "".join(
            f"m.astCamPoint[{k}].lrX := {k}; m.astCamPoint[{k}].etCamType := Poly5Com;" for k in range(34)
        ).encode(),
        "at most 33 points; the file holds 34",
    )
    yield (
        "other cam type",
        "pacdrive",
        t["pacdrive"].replace("Poly5Com", "ModSin").encode(),
        "etCamType is not Poly5Com",
    )
    yield "count of points", "pacdrive", re.sub(r"Points := \d+", "Points := 3", t["pacdrive"]).encode(), "Points is 3"
    yield "no terminator", "br", t["br"].replace("LAST_POINT", "STRAIGHT_LINE").encode(), "the terminator is missing"
    yield "relative", "br", t["br"].replace("REF_ABSOLUTE", "REF_RELATIVE").encode(), "absolute positions only"
    l5x = t["logix"]
    yield (
        "doctype",
        "logix",
        l5x.replace("<RSLogix", '<!DOCTYPE x [<!ENTITY a "b">]><RSLogix').encode(),
        "document type",
    )
    yield "segment type", "logix", re.sub(r'(SegmentType".*?)"1"/', r'\1"2"/', l5x).encode(), "the SegmentType is 2"
    yield "no member", "logix", l5x.replace('Name="Slave"', 'Name="Slaw"').encode(), "element 0 .* has no Slave"
    yield (
        "two tags",
        "logix",
        l5x.replace("</Tags>", '<Tag Name="B" DataType="CAM"/></Tags>').encode(),
        "more than one cam",
    )
    yield "no tag", "logix", b"<a><Tag DataType='DINT'/></a>", "no tag of the type CAM"
    yield "deep XML", "logix", b"<a>" * 900_000, "no XML"
    yield (
        "short profile",
        "logix",
        (b"<t><Tag DataType='CAM_PROFILE'><Data Format='L5K'>[[1,2],[3,4]]</Data></Tag></t>"),
        "does not hold 14 integers",
    )


CORPUS = {name: (target, data, reason) for name, target, data, reason in corpus()}


def test_the_corpus_is_large_enough() -> None:
    assert len(CORPUS) >= 200


@pytest.mark.parametrize("name", CORPUS)
def test_is_refused_with_file_line_and_reason(name: str) -> None:
    target, data, reason = CORPUS[name]
    begin = time.process_time()
    with pytest.raises(InputError) as caught:
        read(target, data)
    assert in_time(time.process_time() - begin, 1.0)
    message = str(caught.value)
    assert message.startswith("cam.file")
    assert re.search(reason, message), message
    assert len(message) < 400


@pytest.mark.parametrize("name", ["too many words", "deep XML", "brackets, codesys", "10 MB line, logix", "bombs"])
def test_takes_little_memory(name: str) -> None:
    target, data, _ = CORPUS[name]
    tracemalloc.start()
    with pytest.raises(InputError):
        read(target, data)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 200_000_000


def test_files_are_read_within_bounds(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="the file cannot be read: No such file"):
        read_text(tmp_path / "none.st")
    with pytest.raises(InputError, match="cannot be read: Is a directory"):
        read_text(tmp_path)
    (tmp_path / "large").write_bytes(b" " * (LARGEST_FILE + 1))
    with pytest.raises(InputError, match="large: the file is larger than 4000000 bytes"):
        read_text(tmp_path / "large")
    (tmp_path / "cam").write_bytes(b"0 0\r\n1 1")
    assert read_text(tmp_path / "cam") == "0 0\n1 1"


def test_an_unknown_layout_or_target_is_refused() -> None:
    with pytest.raises(InputError, match="the layout is not recognised"):
        detect("1 2 3", "cam")
    with pytest.raises(InputError, match="there is no target 'omron'; the targets are codesys"):
        target_of("omron")


@pytest.mark.parametrize("filler", ["\n", " ", "\t", "#\n", ".Append ", "0", "x ", "/", "camwright "])
def test_the_layout_is_sought_in_no_time(filler: str) -> None:
    text = filler * (200_000 // len(filler))
    begin = time.process_time()
    with pytest.raises(InputError, match="the layout is not recognised"):
        detect(text + "$", "cam")
    assert in_time(time.process_time() - begin, 0.5)


def test_columns_with_names_and_decimal_commas_are_recognised() -> None:
    for text in (
        "Winkel;Weg\n0,0;0,5\n1,5;2,0\n3,0;3,5\n",
        "master,slave\n0,0.5\n1.5,2\n3,3.5\n",
        "# x\nA;B\n0;0.5\n1.5;2\n3;3.5",
    ):
        assert detect(text, "t").name == "csv"
        table = TARGETS["csv"].read(text, "t")
        assert (table.x.tolist(), table.y.tolist()) == ([0, 1.5, 3], [0.5, 2, 3.5])


# -- fuzzing

PIECES = """( ) [ ] := := ; , .. : . # // (* *) { } ' " = < > <Tag </Tag> dX dY a[1].MasterPos p 1 0 -1 2.5 1e3 1e999
16#F ARRAY OF [0..1] SMC_CAMXYVA MC_MotionFunctionPoint LREAL# 3( Append Poly5 Bound TABLE( Begintable EndTable
CamPoints SPLINE CYCLIC;YES; Lines Tabletype ٣ é"""
WORDS = st.sampled_from([*PIECES.split(), "\n", "\t", "\u2028"])


@pytest.mark.parametrize("target", TARGETS)
@settings(max_examples=60)
@given(st.lists(WORDS, max_size=40), st.integers(0, 10_000), st.integers(0, 60))
def test_damaged_files_are_read_or_refused(target: str, words: list[str], at: int, cut: int) -> None:
    text = texts()[target]
    at %= len(text)
    for candidate in (" ".join(words), text[:at] + " ".join(words) + text[at + cut :]):
        try:
            table = read(target, candidate.encode())
            TARGETS[target].rebuild(table)
        except InputError:
            continue
        assert table.points >= 2


@given(st.binary(max_size=400))
def test_any_bytes_are_read_or_refused(data: bytes) -> None:
    for target in TARGETS:
        try:
            table = read(target, data)
        except InputError as error:
            message = str(error)
        else:
            message = f"cam.file with {table.points} points"
        assert message.startswith("cam.file")


@pytest.mark.parametrize(
    ("text", "what"),
    [
        (
            '<?xml version="1.0"?>\n<TcSmItem xmlns:xsi="x"><Camming/></TcSmItem>\n',
            "an item of a TwinCAT project (.xti)",
        ),
    ],
)
def test_files_that_are_not_read_are_named_with_a_way_out(text: str, what: str) -> None:
    with pytest.raises(InputError) as caught:
        detect(text, "f")
    assert str(caught.value).startswith(f"f: {what}")
    assert "write the cam's points as two columns, master and slave with their units, and audit that" in str(
        caught.value
    )
