"""recipe.pdf read back: pages, fonts, glyphs, vectors, bytes."""

from __future__ import annotations

import io
import re
import unicodedata
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pypdf
import pytest

from camwright.house.language import LANGUAGES, Language
from camwright.jobs.job import parse_job
from camwright.recipes.build import MadeRecipe, designed, make_recipe
from camwright.recipes.catalogue import catalogue
from camwright.recipes.pdf import recipe_pdf

EXAMPLES = Path(__file__).parents[2] / "examples"


def read(data: bytes) -> pypdf.PdfReader:
    return pypdf.PdfReader(io.BytesIO(data))


def resources(page: Any) -> Iterator[Any]:
    """Give the resources of a page and of every form drawn on it."""
    stack = [page["/Resources"]]
    while stack:
        found = stack.pop().get_object()
        yield found
        for item in found.get("/XObject", {}).values():
            form = item.get_object()
            if "/Resources" in form:
                stack.append(form["/Resources"])


def test_pages_title_and_size(made: MadeRecipe, saw: MadeRecipe) -> None:
    for recipe in (made.recipe, saw.recipe):
        for language in LANGUAGES:
            data = recipe_pdf(replace(recipe, language=language))
            assert len(data) < 1_000_000
            pages = read(data).pages
            assert 2 <= len(pages) <= 5
            for page in pages:
                assert [float(x) for x in page.mediabox[2:]] == pytest.approx([595.276, 841.89], abs=0.01)  # A4


@pytest.mark.parametrize("language", LANGUAGES)
def test_units_of_headings_are_whole(made: MadeRecipe, language: Language) -> None:
    text = "".join(page.extract_text() for page in read(recipe_pdf(replace(made.recipe, language=language))).pages)
    assert "(m/\n" not in text
    assert re.search(rf"\(m/min\)\s+{catalogue(language)('marks.redesign')}", text)


def test_the_same_recipe_gives_the_same_bytes_without_any_date(made: MadeRecipe) -> None:
    first, second = recipe_pdf(made.recipe), recipe_pdf(made.recipe)
    assert first == second
    metadata = read(first).metadata
    assert metadata is not None
    assert not {"/CreationDate", "/ModDate"} & set(metadata)
    assert b"CreateDate" not in first


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_font_is_embedded_and_no_glyph_is_missing(made: MadeRecipe, language: Language) -> None:
    reader = read(recipe_pdf(replace(made.recipe, language=language)))
    names = set()
    for page in reader.pages:
        for found in resources(page):
            for font in found.get("/Font", {}).values():
                descendant = font["/DescendantFonts"][0].get_object()
                descriptor = descendant["/FontDescriptor"]
                assert {"/FontFile2", "/FontFile3"} & set(descriptor), font["/BaseFont"]
                assert font["/Encoding"] == "/Identity-H"
                names.add(str(font["/BaseFont"]).partition("+")[2])
        assert shown_glyphs(page, reader)
        assert 0 not in shown_glyphs(page, reader)  # .notdef, the empty box
    assert {name.partition("-")[0] for name in names} == {"DejaVuSans"} | (
        {"NotoSansSC"} if language == "zh" else set()
    )


def shown_glyphs(page: Any, reader: pypdf.PdfReader) -> set[int]:
    """Glyph numbers of all text shown on a page, its forms included: every code has two bytes."""
    glyphs: set[int] = set()
    streams = [page.get_contents()]
    for found in resources(page):
        streams += [
            pypdf.generic.ContentStream(form, reader)
            for form in (item.get_object() for item in found.get("/XObject", {}).values())
            if form.get("/Subtype") == "/Form"
        ]
    for stream in streams:
        for operands, operator in stream.operations:
            if operator in (b"Tj", b"TJ"):
                texts = operands[0] if operator == b"TJ" else operands
                for text in texts:
                    if isinstance(text, pypdf.generic.TextStringObject | pypdf.generic.ByteStringObject):
                        codes = text.original_bytes
                        glyphs |= {codes[i] << 8 | codes[i + 1] for i in range(0, len(codes), 2)}
    return glyphs


@pytest.mark.parametrize("language", LANGUAGES)
def test_what_a_fitter_needs_can_be_read(made: MadeRecipe, language: Language) -> None:
    recipe, words = replace(made.recipe, language=language), catalogue(language)
    text = "".join(page.extract_text() for page in read(recipe_pdf(recipe)).pages)
    squeezed = "".join(text.split()).replace("\u2010", "").replace("-", "")
    for key in words.messages:
        if key.startswith("section."):
            assert "".join(words(key).split()).replace("-", "") in squeezed, key
    for table in recipe.tables:
        for file in table.files:
            assert file.sha256[:16] in squeezed
    assert recipe.provenance.job_sha256 in squeezed
    assert f"116{words.units.decimal}7" in squeezed  # the highest line speed
    assert not {letter for letter in text if unicodedata.category(letter) == "Cf"}  # copies without what nobody sees
    assert "336.62".replace(".", words.units.decimal) in squeezed  # the shortest cut


def test_the_figure_is_drawn_as_lines(made: MadeRecipe) -> None:
    for page in read(recipe_pdf(made.recipe)).pages:
        for found in resources(page):
            assert all(item.get_object()["/Subtype"] != "/Image" for item in found.get("/XObject", {}).values())


NOTES = [
    '#panic("x") #set page(paper: "a3") $x^2$ *bold* _it_ `raw` @label <label> // /* \\',
    "= heading\n- item\n\n\n1. one",
    "שלום العربية \u202eevil\u202c \u200f\u0000\x07\r\n\t end",
    "🦊 😀 切刀 飞剪 é ﬁ \U0010ffff \ue000",
    "x" * 2000,
    '"); } #import "/etc/passwd"',
]


@pytest.mark.parametrize("note", NOTES)
def test_any_text_of_a_user_is_printed_with_glyphs_and_does_nothing(made: MadeRecipe, note: str) -> None:
    reader = read(recipe_pdf(replace(made.recipe, name=note[:60], note=note)))
    assert 2 <= len(reader.pages) <= 5
    for page in reader.pages:
        assert float(page.mediabox[2]) == pytest.approx(595.276, abs=0.01)
        assert 0 not in shown_glyphs(page, reader)


def test_what_no_font_shows_is_spelled_out(made: MadeRecipe) -> None:
    text = read(recipe_pdf(replace(made.recipe, note="fox \U0001f98a end"))).pages[0].extract_text()
    assert "fox ⟨U+1F98A⟩ end" in text


MOTOR = 'motor = [["0 rpm", "60 N m"], ["3000 rpm", "60 N m"], ["4000 rpm", "40 N m"]]'


@pytest.mark.parametrize("language", LANGUAGES)
def test_a_recipe_that_is_not_released_says_so_on_every_page(language: Language) -> None:
    text = (EXAMPLES / "paper-600.toml").read_text(encoding="utf-8")
    text = text.replace("reversal = false", f"reversal = false\n{MOTOR}")
    text = text.replace(
        'circumference = "400 mm"', 'circumference = "400 mm"\ninertia = "0.2 kg m^2"\nfriction = "1 N m"'
    )
    text = text.replace('sync_tolerance = "0.1 mm"', 'sync_tolerance = "0.001 mm"')
    recipe = make_recipe(designed(parse_job(text, "here")), ["trio", "codesys"], language).recipe
    assert not recipe.released
    words, reader = catalogue(language), read(recipe_pdf(recipe))
    for page in reader.pages:
        assert "".join(words("not_released").split()) in "".join(page.extract_text().split())
        assert 0 not in shown_glyphs(page, reader)
    whole = "".join("".join(page.extract_text().split()) for page in reader.pages)
    assert "4000" + "1/min,40N⋅m" in whole  # the motor's curve
    assert "✗" in whole
    assert "".join(words("import.not_released").split())[:12] in whole
