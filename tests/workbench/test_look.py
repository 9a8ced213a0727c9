"""How the page looks and reads: languages, a telephone, light and dark, names for screen readers, paper."""

from __future__ import annotations

import io
import re
from pathlib import Path
from typing import Any

import pypdf
import pytest

PAGE = Path(__file__).parents[2] / "camwright" / "workbench" / "page"
STYLE = (PAGE / "style.css").read_text(encoding="utf-8")
DRAWINGS = (PAGE / "drawings.css").read_text(encoding="utf-8")
COLOURS = {name: (light, dark) for name, light, dark in re.findall(r"--(\w+): light-dark\((#\w{6}), (#\w{6})\)", STYLE)}
NAMELESS = """() => [...document.querySelectorAll("button, input, select, textarea, [role=slider], [role=tab], [role=button], iframe, img")]
  .filter((each) => !(each.textContent.trim() || each.getAttribute("aria-label") || each.labels?.length || each.title || each.alt))
  .map((each) => each.outerHTML.slice(0, 120))"""


def luminance(colour: str) -> float:
    parts = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: str, other: str) -> float:
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("look", [0, 1], ids=["light", "dark"])
@pytest.mark.parametrize("name", ["ink", "soft", "bad", "good"])
def test_texts_have_the_contrast_of_wcag(name: str, look: int) -> None:
    assert contrast(COLOURS[name][look], COLOURS["ground"][look]) >= 4.5
    if name == "ink":  # names of limits stand on the zones
        assert contrast(COLOURS[name][look], COLOURS["shear"][look]) >= 4.5


@pytest.mark.parametrize("look", [0, 1], ids=["light", "dark"])
@pytest.mark.parametrize("name", ["cam", "linear", "law", "other"])
def test_lines_are_seen_on_every_ground(name: str, look: int) -> None:
    for ground in ("ground", "zone", "shear"):
        assert contrast(COLOURS[name][look], COLOURS[ground][look]) >= 3


def test_curves_differ_without_their_colours() -> None:
    kinds = ("pinned", "law", "linear_return", "poly_3_4_5", "overlay")
    dashes = [re.search(rf"\.curve\.{kind} {{[^}}]*stroke-dasharray: ([^;]+);", DRAWINGS) for kind in kinds]
    found = [match[1] for match in dashes if match]
    assert len(found) == len(kinds)
    assert len(set(found)) == len(kinds)


def test_the_page_speaks_three_languages(page: Any) -> None:
    for language, undo, check in (
        ("de", "Rückgängig", "Fehler des Verhältnisses in der Synchronzone"),
        ("zh", "撤销", "同步区速比误差"),
        ("en", "Undo", "Ratio error in the sync zone"),
    ):
        page.select_option("#language", language)
        page.locator("#undo", has_text=undo).wait_for()
        page.locator("#panel td", has_text=check).wait_for()
        assert page.get_attribute("html", "lang") == language
    page.select_option("#language", "zh")  # whose words may be broken after each sign
    page.click("[data-view=compare]")
    page.locator("#panel rect.bar").first.wait_for()
    assert page.locator("#panel td").first.bounding_box()["width"] >= 80
    page.click("[data-view=checks]")
    page.select_option("#language", "de")
    page.locator('.field[data-path="cut.sync_tolerance"] label', has_text="Synchrontoleranz").wait_for()
    page.locator('[id="field-cut.sync_tolerance"]').focus()
    assert "cut.sync_tolerance: wie weit die Achse" in page.inner_text("#about")
    page.locator("#panel td", has_text="0,020273").wait_for()  # decimals as its recipes have them
    assert page.input_value('[id="field-cut.sync_tolerance"]') == "0.1 mm"  # as it stands in the job file


@pytest.mark.parametrize("width", [390, 768, 1280])
def test_nothing_is_wider_than_the_screen(width: int, page: Any) -> None:
    page.set_viewport_size({"width": width, "height": 844})
    for view in ("checks", "servo", "compare", "limits", "machine"):
        page.click(f"[data-view={view}]")
        page.locator("#panel .waiting").wait_for(state="detached")
        assert page.evaluate("document.documentElement.scrollWidth") <= width, view


def test_everything_has_a_name_for_who_does_not_see_it(page: Any) -> None:
    for view in ("checks", "servo", "compare", "limits", "envelope", "export", "recipe", "audit", "machine", "bender"):
        page.click(f"[data-view={view}]")
        page.locator("#panel .waiting").wait_for(state="detached")
        assert page.evaluate(NAMELESS) == [], view


def test_the_tabs_go_by_arrow_keys(page: Any) -> None:
    page.locator("#tab-checks").focus()
    page.keyboard.press("ArrowLeft")
    assert page.get_attribute("#tab-bender", "aria-selected") == "true"
    page.keyboard.press("ArrowRight")
    assert page.evaluate("document.activeElement.id") == "tab-checks"


def test_light_and_dark_by_choice(page: Any) -> None:
    colour = "getComputedStyle(document.body).backgroundColor"
    page.select_option("#look", "dark")
    assert page.evaluate(colour) == "rgb(21, 24, 28)"
    page.select_option("#look", "light")
    assert page.evaluate(colour) == "rgb(255, 255, 255)"


def test_on_paper_stand_plots_readings_and_the_view(page: Any) -> None:
    page.emulate_media(media="print")
    for shown in ("#plots", "#readings", "#panel table", "#badge"):
        assert page.locator(shown).first.is_visible(), shown
    for hidden in ("nav", "#job", "#tabs"):
        assert not page.locator(hidden).is_visible(), hidden
    sheet = pypdf.PdfReader(io.BytesIO(page.pdf(format="A4")))
    texts = [each.extract_text() for each in sheet.pages]
    assert "jerk binds" in texts[0]  # plots on the first page, under the name
    assert 'sync_tolerance = "0.1 mm"' in texts[-1]  # and the job file on the last
