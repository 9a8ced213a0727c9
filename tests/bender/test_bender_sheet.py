"""The bending sheet in three languages: complete, with the language's decimal mark, nothing invisible in its text."""

import ast
import re
import shutil
import string
import unicodedata
from collections.abc import Callable
from pathlib import Path

import pytest
from fontTools.ttLib import TTFont
from pypdf import PdfReader

from camwright.bender.catalogue import sheet_words
from camwright.bender.program_file import COLLISIONS
from camwright.cli.main import main
from camwright.house.fonts import font_files
from camwright.house.language import LANGUAGES, Language
from camwright.profiles.notice import Notice, Number

Make = Callable[..., Path]
EXAMPLE = Path(__file__).parents[2] / "examples" / "bender" / "carton.dxf"
LONG = "a_drawing_whose_name_is_longer_than_the_column_of_the_table_of_the_sheet_and_has_no_blank_in_it_rev_17"


def holes(text: str) -> set[str]:
    return {name for _, name, _, _ in string.Formatter().parse(text) if name}


def test_every_language_says_everything():
    english = sheet_words("en").messages
    for language in LANGUAGES:
        messages = sheet_words(language).messages
        assert list(messages) == list(english)
        assert all(text.strip() for text in messages.values())
        assert {key: holes(text) for key, text in messages.items()} == {
            key: holes(text) for key, text in english.items()
        }


def test_every_message_is_used_and_every_one_used_is_there():
    folder = Path(__file__).parents[2] / "camwright" / "bender"
    texts = "".join(file.read_text(encoding="utf-8") for file in [*folder.glob("*.py"), *folder.glob("templates/*")])
    texts = texts.replace("'", '"')
    for key in sheet_words("en").messages:
        group, _, last = key.rpartition(".")
        assert (
            f'"{key}"' in texts
            or f".{key}" in texts
            or (group and f'"{last}"' in texts)
            or (group in ("interpolation", "arcs"))
        ), key


def test_the_fonts_show_every_message():
    covered = set()
    for file in font_files():
        with TTFont(file, lazy=True) as font:
            covered |= set(font.getBestCmap())
    for language in LANGUAGES:
        assert {
            letter
            for text in [*sheet_words(language).messages.values(), *sheet_words(language).notices.values()]
            for letter in text
            if ord(letter) not in covered
        } == set()


@pytest.mark.parametrize(
    ("language", "words"),
    [
        ("en", ["Bending sheet", "Rule length", "427.871 mm", "passed, but for collisions", "6 of 4 mm", "by hand"]),
        ("de", ["Biegeblatt", "Länge der Linie", "427,871 mm", "angenommene Kollisionen", "6 zu 4 mm", "von Hand"]),
        ("zh", ["弯刀作业单", "刀条长度", "427.871 mm", "已接受的碰撞", "6 个，宽 4 mm", "手工"]),
    ],
)
def test_a_sheet_in_each_language(tmp_path: Path, language: Language, words: list[str]):
    drawing = tmp_path / f"{LONG}.dxf"
    shutil.copy(EXAMPLE, drawing)
    more = ("--language", language, "--bridges", "4@100", "--accept-collisions", "--quiet", "--out", tmp_path / "out")
    assert main(["bend", str(drawing), *map(str, more)]) == 0
    page = (tmp_path / "out" / "sheet.html").read_text(encoding="utf-8")
    assert f'<html lang="{language}">' in page
    pdf = PdfReader(tmp_path / "out" / "sheet.pdf")
    text = "\n".join(each.extract_text() for each in pdf.pages)
    assert {letter for letter in text if unicodedata.category(letter)[0] == "C"} <= {"\n"}
    for word in words:
        assert word in page
        assert re.sub(r"\s", "", word) in re.sub(r"\s", "", text)
    assert LONG in re.sub(r"\s", "", text)
    left = re.findall(r"\{\w+\}", page + text)
    assert left == []
    assert sheet_words(language)("figure.bent") in (tmp_path / "out" / f"{LONG}-1-proof.svg").read_text(
        encoding="utf-8"
    )


SOURCES = [
    *(Path(__file__).parents[2] / "camwright" / "bender").glob("*.py"),
    Path(__file__).parents[2] / "camwright" / "cli" / "bend.py",
    Path(__file__).parents[2] / "profiles" / "bender" / "springback.py",
]


def texts_of(node: ast.expr, names: dict[str, list[ast.expr]]) -> set[str]:
    """Texts that an expression may be: a constant, one of two, a name that was given one, a sentence with the check's name."""
    if isinstance(node, ast.Constant):
        return {str(node.value)}
    if isinstance(node, ast.IfExp):
        return texts_of(node.body, names) | texts_of(node.orelse, names)
    if isinstance(node, ast.Name):
        return {text for value in names.get(node.id, []) for text in texts_of(value, names)}
    if isinstance(node, ast.BoolOp):
        return {text for value in node.values for text in texts_of(value, names)}
    if isinstance(node, ast.JoinedStr):
        found = {""}
        for part in node.values:
            inner = part.value if isinstance(part, ast.FormattedValue) else part
            known = {**names, "COLLISIONS": [ast.Constant(COLLISIONS)]}
            found = {text + more for text in found for more in texts_of(inner, known)}
        return found
    return set()


def templates() -> set[str]:
    """Give the templates of all notices of the bender's sources."""
    found = set()
    for file in SOURCES:
        for function in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if not isinstance(function, ast.FunctionDef | ast.Lambda):
                continue
            names: dict[str, list[ast.expr]] = {}
            for node in ast.walk(function):
                if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
                    names.setdefault(node.targets[0].id, []).append(node.value)
            for node in ast.walk(function):
                if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                    name = node.func.id
                    found |= texts_of(node.args[0], names) if name == "Notice" else set()
                    found |= texts_of(node.args[1], names) if name == "_few" else set()
    return found


def test_every_notice_can_be_said_in_every_language():
    used = templates() | {"off or frozen", "invisible"}  # the two reasons why a thing is not shown
    assert len(used) > 40
    for language in ("de", "zh"):
        said = sheet_words(language).notices
        assert set(said) == used
        assert {text: holes(other) for text, other in said.items()} == {text: holes(text) for text in used}
        assert all(other.strip() and (other != text or text == "{file}: {what}") for text, other in said.items())


def test_a_notice_is_said_with_what_it_holds():
    name = Notice("{what} on layer {layer}", what="LINE #2F", layer="CUT {a}")
    told = Notice("{name} (no length)", name=name)
    assert told == "LINE #2F on layer CUT {a} (no length)"
    assert sheet_words("en").said(told) == told
    assert sheet_words("de").said(told) == "LINE #2F auf Layer CUT {a} (ohne Länge)"
    bulge = Notice("bulge {bulge} of {name}, taken as a line", bulge=Number(1.5e6, "g"), name=name)
    assert sheet_words("de").said(bulge) == "Bulge 1,5e+06 von LINE #2F auf Layer CUT {a}, als Gerade genommen"
    assert sheet_words("zh").said("repaired by a library") == "repaired by a library"


@pytest.mark.parametrize(("language", "words"), [("de", "trifft das Werkzeug"), ("zh", "碰到模具")])
def test_warnings_of_a_sheet_are_in_its_language(drawing: Make, tmp_path: Path, language: str, words: str):
    def draw(m, d):
        d.layers.add("OLD").freeze()
        m.add_lwpolyline([(0, 0), (100, 0), (100, 60), (0, 60)], close=True)
        m.add_line((0, 0), (100, 0))
        m.add_line((5, 5), (5, 5))
        m.add_line((0, 0), (9, 9), dxfattribs={"layer": "OLD"})
        m.add_text("note")

    code = main(["bend", str(drawing(draw)), "--language", language, "--quiet", "--out", str(tmp_path / "out")])
    assert code == 1
    page = (tmp_path / "out" / "sheet.html").read_text(encoding="utf-8")
    warnings = re.search(r"<ul>(.*?)</ul>", page, re.DOTALL)[1]
    assert words in warnings
    assert warnings.count("<li>") == 7
    english = re.compile(r"\b(?:the|lies|left|out|and|of|from|with|layer|meets|failed|off)\b")
    assert not english.findall(re.sub("drawing|DRAWING", "", warnings))
