"""The bending sheet in three languages: complete, with the language's decimal mark, nothing invisible in its text."""

import re
import shutil
import string
import unicodedata
from collections.abc import Callable
from pathlib import Path

import pytest
from fontTools.ttLib import TTFont
from pypdf import PdfReader

from camwright.bender.catalogue import LANGUAGES, SheetLanguage, sheet_words
from camwright.cli.main import main
from camwright.house.fonts import font_files

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
            letter for text in sheet_words(language).messages.values() for letter in text if ord(letter) not in covered
        } == set()


@pytest.mark.parametrize(
    ("language", "words"),
    [
        ("en", ["Bending sheet", "Rule length", "427.871 mm", "passed, but for collisions", "6 of 4 mm", "by hand"]),
        ("de", ["Biegeblatt", "Länge der Linie", "427,871 mm", "angenommene Kollisionen", "6 zu 4 mm", "von Hand"]),
        ("zh", ["弯刀作业单", "刀条长度", "427.871 mm", "已接受的碰撞", "6 个，宽 4 mm", "手工"]),
    ],
)
def test_a_sheet_in_each_language(tmp_path: Path, language: SheetLanguage, words: list[str]):
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
