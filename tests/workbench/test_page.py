"""The page in a real browser: drag, undo, impossible and back, every view, and no call to anyone else."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from typing import Any

import pytest

api = pytest.importorskip("playwright.sync_api", reason="Playwright is not installed")
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium is installed: apt-get install chromium")

PATIENCE = 60_000


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture
def page(browser: Any, address: str) -> Iterator[Any]:
    page = browser.new_page(viewport={"width": 1280, "height": 900})
    page.set_default_timeout(PATIENCE)
    faults: list[str] = []
    foreign: list[str] = []
    page.on("pageerror", lambda error: faults.append(str(error)))
    page.on("console", lambda message: message.type == "error" and faults.append(message.text))
    page.on(
        "request",
        lambda request: (
            request.url.startswith("http") and "127.0.0.1" not in request.url and foreign.append(request.url)
        ),
    )
    page.goto(address)
    page.locator("#badge.proved").wait_for()
    yield page
    assert faults == []
    assert foreign == []
    page.close()


def dragged(page: Any, path: str, by: float) -> None:
    """Take a handle and move it by some pixels."""
    box = page.locator(f'g[data-path="{path}"] path').bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    for step in range(1, 11):
        page.mouse.move(x + by * step / 10, y)
    page.mouse.up()


def length(page: Any) -> str:
    return str(page.input_value('[id="field-cut.length"]'))


def test_a_drag_is_previewed_proved_and_undone(page: Any) -> None:
    assert "peak_acceleration 9.0718" in page.inner_text("#badge")
    dragged(page, "cut.length", -60)
    page.wait_for_timeout(200)
    page.locator("#badge.proved").wait_for()
    shorter = length(page)
    assert 400 < float(shorter.strip('"').split()[0]) < 590
    assert "9.0718" not in page.inner_text("#badge")
    page.click("#undo")
    page.locator("#badge", has_text="9.0718").wait_for()
    assert length(page) == '"600 mm"'
    page.click("#redo")
    page.wait_for_timeout(100)
    assert length(page) == shorter


def test_an_impossible_job_keeps_the_last_cam_and_offers_ways_out(page: Any) -> None:
    page.fill('[id="field-cut.length"]', '"300 mm"')
    page.press('[id="field-cut.length"]', "Tab")
    page.locator("#refusal button").first.wait_for()
    assert page.locator("#plots.infeasible path.curve").count() > 0
    page.locator("#refusal button", has_text="cut.length").click()
    page.locator("#badge.proved, #badge.failed").wait_for()
    assert length(page) == '"337 mm"'


def test_a_fault_stands_at_its_field(page: Any) -> None:
    page.fill('[id="field-servo.damping"]', "0")
    page.press('[id="field-servo.damping"]', "Tab")
    page.locator('[data-path="servo.damping"] .fault').wait_for()
    page.click("#undo")
    page.locator("#badge.proved").wait_for()


def test_keys_move_a_handle(page: Any) -> None:
    page.locator('g[data-path="cut.length"]').focus()
    page.keyboard.press("ArrowRight")
    page.wait_for_timeout(100)
    assert length(page) == '"606 mm"'


def test_every_view_shows_something(page: Any) -> None:
    for view, seen in (
        ("checks", "sync_ratio"),
        ("compare", "polynomial 3-4-5"),
        ("limits", "max_line_speed"),
        ("audit", "Drop a table file"),
        ("machine", "Run"),
    ):
        page.click(f"[data-view={view}]")
        page.locator("#panel", has_text=seen).wait_for()
    for view, seen in (("envelope", "#panel svg path"), ("export", "#panel li a"), ("recipe", "#panel li a")):
        page.click(f"[data-view={view}]")
        page.locator("#panel button").click()
        page.locator(seen).first.wait_for()


def test_the_page_speaks_three_languages_and_fits_a_telephone(page: Any) -> None:
    for language, word in (("de", "Rückgängig"), ("zh", "撤销"), ("en", "Undo")):
        page.select_option("#language", language)
        page.locator("#undo", has_text=word).wait_for()
    page.set_viewport_size({"width": 390, "height": 800})
    page.wait_for_timeout(100)
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
