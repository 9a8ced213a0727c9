"""Styles: layer, colour and linetype tell cut, crease and half-cut lines apart, and are never joined into one rule."""

from collections.abc import Callable
from pathlib import Path

import pytest

from camwright.bender.drawing import Drawing, Reading, read_drawing
from camwright.bender.dxf_styles import StyleChoice, style_choice
from camwright.profiles.errors import InputError

Make = Callable[..., Path]


def read(path: Path, choice: StyleChoice) -> Drawing:
    return read_drawing(path, Reading(1e-5, 1e-5, style=choice))


def dieline(m, d):
    """Draw a frame whose lower half is cut, with a crease across that meets its corners."""
    d.layers.add("CUT", color=1)
    d.layers.add("CREASE", color=3)
    for start, end in (((0, 0), (100, 0)), ((100, 0), (100, 60)), ((0, 60), (0, 0))):
        m.add_line(start, end, dxfattribs={"layer": "CUT"})
    m.add_line((0, 60), (100, 60), dxfattribs={"layer": "CREASE"})


def test_styles_are_listed_with_count_and_length_where_none_is_chosen(drawing: Make):
    path = drawing(dieline)
    with pytest.raises(InputError) as error:
        read(path, StyleChoice())
    first, *rows = error.value.faults
    assert "the drawing holds 2 styles, which are never joined into one rule" in first
    assert rows == [
        "--style layer=CUT,colour=1,linetype=Continuous: 3 entities, 220.000 mm",
        "--style layer=CREASE,colour=3,linetype=Continuous: 1 entity, 100.000 mm",
    ]


def test_a_chosen_style_is_bent_alone_and_all_of_them_each_for_itself(drawing: Make):
    path = drawing(dieline)
    for choice in (StyleChoice(layer="cut"), StyleChoice(colour="1"), StyleChoice("CUT", "1", "CONTINUOUS")):
        (outline,) = read(path, choice).outlines
        assert outline.lengths.sum() == pytest.approx(0.220)
        assert not outline.closed
    found = read(path, StyleChoice(each=True))
    assert [style.layer for style in found.styles] == ["CUT", "CREASE"]
    assert [len(outline.bulges) for outline in found.outlines] == [3, 1]
    with pytest.raises(InputError, match="no line has the style colour=5; the styles are\n--style layer=CUT"):
        read(path, StyleChoice(colour="5"))


@pytest.mark.parametrize(
    "other",
    [{"color": 3}, {"linetype": "DASHED"}, {"true_color": 0xFF8000}, {"layer": "HALF"}],
    ids=["colour", "linetype", "true colour", "layer"],
)
def test_whatever_tells_two_lines_apart_keeps_them_apart(drawing: Make, other: dict[str, object]):
    def draw(m, d):
        d.linetypes.add("DASHED", [2.0, 1.0, -1.0])
        m.add_line((0, 0), (50, 0))
        m.add_line((50, 0), (50, 40), dxfattribs=other)

    path = drawing(draw, version="R2010")
    with pytest.raises(InputError, match="the drawing holds 2 styles"):
        read(path, StyleChoice())
    assert len(read(path, StyleChoice(each=True)).outlines) == 2


def test_a_layer_with_several_styles_is_no_choice(drawing: Make):
    def draw(m, _):
        m.add_line((0, 0), (50, 0), dxfattribs={"layer": "DIE", "color": 1})
        m.add_line((50, 0), (50, 40), dxfattribs={"layer": "DIE", "color": 3})

    with pytest.raises(InputError, match="the drawing holds 2 styles"):
        read(drawing(draw), StyleChoice(layer="DIE"))


def test_what_is_taken_from_layer_and_block_is_resolved(drawing: Make):
    def draw(m, d):
        d.layers.add("CUT", color=1, linetype="DASHED")
        d.linetypes.add("DASHED", [2.0, 1.0, -1.0])
        block = d.blocks.new("PART")
        block.add_line((0, 0), (5, 0))  # layer 0: its reference's layer, and that layer's colour
        block.add_line((0, 9), (5, 9), dxfattribs={"color": 0, "linetype": "BYBLOCK", "layer": "OWN"})
        m.add_blockref("PART", (0, 0), dxfattribs={"layer": "CUT", "color": 6})
        m.add_line((0, 20), (5, 20), dxfattribs={"layer": "CUT", "color": 1, "linetype": "DASHED"})
        m.add_line((0, 30), (5, 30), dxfattribs={"color": 0})

    found = read(drawing(draw), StyleChoice(each=True))
    # drawn by layer and drawn with the layer's own colour is one style
    assert [str(style) for style in found.styles] == [
        "layer=CUT,colour=1,linetype=DASHED",
        "layer=CUT,colour=1,linetype=DASHED",
        "layer=OWN,colour=6,linetype=DASHED",
        "layer=0,colour=7,linetype=Continuous",
    ]


def test_a_layer_needs_no_entry_in_the_table(drawing: Make):
    def draw(m, _):
        m.add_line((0, 0), (50, 0), dxfattribs={"layer": "CUT"})
        m.add_line((0, 5), (50, 5), dxfattribs={"layer": "CREASE"})

    path = drawing(draw)
    assert len(read(path, StyleChoice(layer="CUT")).outlines) == 1
    with pytest.raises(InputError, match="no layer 'CUTS'; the layers are 0, CREASE, CUT, Defpoints"):
        read(path, StyleChoice(layer="CUTS"))


def test_what_a_style_that_is_not_bent_holds_does_not_matter(drawing: Make):
    def draw(m, _):
        m.add_line((0, 0), (50, 0), dxfattribs={"layer": "CUT"})
        m.add_line((0, 0, 0), (1, 0, 5), dxfattribs={"layer": "MODEL"})

    path = drawing(draw)
    assert len(read(path, StyleChoice(layer="CUT")).outlines) == 1
    with pytest.raises(InputError, match="three-dimensional"):
        read(path, StyleChoice(layer="MODEL"))


def test_hidden_things_are_left_out_reference_by_reference(drawing: Make):
    def draw(m, d):
        d.layers.add("CUT")
        d.layers.add("FROZEN").freeze()
        d.layers.add("OFF").off()
        part, outer = d.blocks.new("PART"), d.blocks.new("OUTER")
        part.add_line((0, 0), (5, 0), dxfattribs={"layer": "CUT"})
        part.add_line((0, 5), (5, 5), dxfattribs={"layer": "CUT", "invisible": 1})  # a state of a dynamic block
        outer.add_blockref("PART", (0, 50), dxfattribs={"layer": "FROZEN"})
        outer.add_blockref("PART", (0, 60), dxfattribs={"layer": "0"})
        for x, attributes in enumerate(({}, {"layer": "FROZEN"}, {"layer": "OFF"}, {"invisible": 1})):
            handles.append(m.add_blockref("PART", (0, 10 * x), dxfattribs=attributes).dxf.handle)
        m.add_blockref("OUTER", (0, 0))

    handles: list[str] = []
    found = read(drawing(draw), StyleChoice())
    assert sorted(float(outline.points[0, 1]) for outline in found.outlines) == pytest.approx([0, 60e-3])
    shown, frozen, off, invisible = handles
    said = "\n".join(found.warnings)
    assert f"block reference #{frozen} on layer FROZEN (off or frozen)" in said
    assert f"block reference #{off} on layer OFF (off or frozen)" in said
    assert f"block reference #{invisible} on layer 0 (invisible)" in said
    assert f"entity in block reference #{shown} on layer CUT (invisible)" in said


@pytest.mark.parametrize(
    ("text", "layer", "expected"),
    [
        ("layer=CUT,colour=1", None, StyleChoice("CUT", "1", None, False)),
        ("layer=A,B, linetype=DOT", None, StyleChoice("A,B", None, "DOT", False)),
        ("colour=#ff8000", "CUT", StyleChoice("CUT", "#ff8000", None, False)),
        (None, "CUT", StyleChoice("CUT", None, None, False)),
    ],
)
def test_a_style_as_it_is_written(text: str | None, layer: str | None, expected: StyleChoice):
    assert style_choice(text, layer, each=False) == expected


@pytest.mark.parametrize("text", ["", "CUT", "layer=", "color=1", "layer=A,layer=B"])
def test_what_is_no_style(text: str):
    with pytest.raises(InputError, match="not a style; write some of layer=, colour= and linetype="):
        style_choice(text, None, each=False)


def test_two_layers_are_no_choice():
    with pytest.raises(InputError, match="name two layers"):
        style_choice("layer=A", "B", each=False)


@pytest.mark.parametrize("choice", [StyleChoice(layer="CUT"), StyleChoice(colour="1"), StyleChoice(each=True)])
def test_lines_of_different_styles_that_lie_on_each_other_are_named(drawing: Make, choice: StyleChoice):
    handles = []

    def draw(m, d):
        d.layers.add("CUT", color=1)
        d.layers.add("CREASE", color=3)
        handles.append(m.add_line((0, 0), (100, 0), dxfattribs={"layer": "CUT"}).dxf.handle)
        handles.append(m.add_line((90, 0), (30, 0), dxfattribs={"layer": "CREASE"}).dxf.handle)
        m.add_line((0, 20), (100, 20), dxfattribs={"layer": "CREASE"})

    found = read(drawing(draw), choice)
    (told,) = (text for text in found.warnings if "their styles differ" in text)
    assert f"LINE #{handles[1]} on layer CREASE lies on LINE #{handles[0]} on layer CUT over 60.000 mm" in told
    assert sum(outline.lengths.sum() for outline in found.outlines) == pytest.approx(0.26 if choice.each else 0.1)
    assert found.overlaps == ()


def test_lines_of_styles_that_are_not_bent_are_not_compared(drawing: Make):
    def draw(m, d):
        m.add_line((0, 50), (100, 50), dxfattribs={"layer": "CUT"})
        for layer in ("CREASE", "HALF"):
            m.add_line((0, 0), (100, 0), dxfattribs={"layer": layer})

    assert not any("styles differ" in text for text in read(drawing(draw), StyleChoice(layer="CUT")).warnings)


def test_arcs_of_different_styles_and_what_cannot_be_bent_elsewhere(drawing: Make):
    def draw(m, d):
        m.add_arc((0, 0), 20, 0, 90, dxfattribs={"layer": "CUT"})
        m.add_arc((0, 0), 20, 45, 135, dxfattribs={"layer": "CREASE"})
        m.add_line((0, 0, 0), (10, 0, 5), dxfattribs={"layer": "CREASE"})  # not plane: of no interest to the cut
        m.add_text("note", dxfattribs={"layer": "CREASE"})

    found = read(drawing(draw), StyleChoice(layer="CUT"))
    (told,) = (text for text in found.warnings if "their styles differ" in text)
    assert "over 15.708 mm" in told  # an eighth of the circle
    assert not any("left out" in text for text in found.warnings)
