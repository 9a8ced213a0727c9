"""Makes the pictures of the workbench anew, by Chromium and Playwright: ``python docs/workbench_pictures.py [NAME …]``."""

from __future__ import annotations

import contextlib
import json
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from playwright.sync_api import Page, sync_playwright

HERE = Path(__file__).parent
FIGURES = HERE / "figures"
EXAMPLES = HERE.parent / "examples"
COMMAND = [sys.executable, "-m", "camwright", "workbench"]
PATIENCE = 120_000


@contextlib.contextmanager
def workbench(example: str) -> Iterator[str]:
    """Start a workbench on an example; gives its address."""
    arguments = [str(EXAMPLES / f"{example}.toml"), "--json", "--no-browser"]
    with (
        tempfile.TemporaryDirectory() as folder,
        subprocess.Popen([*COMMAND, *arguments], stdout=subprocess.PIPE, text=True, cwd=folder) as process,
    ):
        assert process.stdout is not None  # noqa: S101 - asked for above
        try:
            yield json.loads(process.stdout.readline())["url"]
        finally:
            process.terminate()


def judged(page: Page) -> None:
    """Wait for the verdict."""
    page.locator("#badge.proved, #badge.failed").first.wait_for()


def view(page: Page, name: str) -> None:
    """Open a view and wait for its answer."""
    page.click(f"[data-view={name}]")
    page.locator("#panel .waiting").wait_for(state="detached")


def shot(page: Page, name: str, selector: str | None = None) -> None:
    """Keep what the page, or a part of it, shows."""
    page.mouse.move(2, 2)
    page.wait_for_timeout(300)
    target: Any = page if selector is None else page.locator(selector)
    target.screenshot(path=FIGURES / f"{name}.png")


def overview(page: Page) -> None:
    """Show the whole page."""
    shot(page, "workbench")


def drag(page: Page) -> None:
    """Drag the cut length; the hand still holds it."""
    box = page.locator('g[data-path="cut.length"] path').bounding_box()
    assert box is not None  # noqa: S101 - the handle is there
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x - 60, y, steps=6)
    page.locator("#badge", has_text="preview").wait_for()
    page.wait_for_timeout(800)
    page.screenshot(path=FIGURES / "workbench-drag.png")
    page.mouse.up()


def impossible(page: Page) -> None:
    """Ask for what cannot be."""
    page.fill('[id="field-cut.length"]', "300 mm")
    page.press('[id="field-cut.length"]', "Tab")
    page.locator("#refusal button").first.wait_for()
    shot(page, "workbench-impossible", "#cam")


def servo(page: Page) -> None:
    """Show what the servo makes of the cam."""
    view(page, "servo")
    page.locator("#panel .here").wait_for(state="attached")
    shot(page, "workbench-servo", "#views")


def tradeoff(page: Page) -> None:
    """Show what each objective costs in the others."""
    view(page, "tradeoff")
    shot(page, "workbench-tradeoff", "#views")


def envelope(page: Page) -> None:
    """Draw the map."""
    page.click("[data-view=envelope]")
    page.click("#panel button")
    page.locator("#panel path.possible").wait_for()
    shot(page, "workbench-map", "#views")


def bender(page: Page) -> None:
    """Bend a drawing."""
    page.click("[data-view=bender]")
    page.locator("#panel input[type=file]").first.set_input_files(EXAMPLES / "bender" / "carton.dxf")
    page.locator("#panel img").first.wait_for()
    shot(page, "workbench-bender", "#views")


def phone(page: Page) -> None:
    """Show the page as a telephone does, in the dark."""
    page.set_viewport_size({"width": 390, "height": 844})
    page.emulate_media(color_scheme="dark")
    shot(page, "workbench-phone")


PICTURES: tuple[Callable[[Page], None], ...] = (overview, drag, impossible, servo, tradeoff, envelope, bender, phone)


def main() -> None:
    """Make the pictures that are named, or all."""
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    if chromium is None:
        raise SystemExit("no Chromium is installed: apt-get install chromium")
    with workbench("paper-600") as url, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        for draw in PICTURES:
            if len(sys.argv) > 1 and draw.__name__ not in sys.argv[1:]:
                continue
            page = browser.new_page(viewport={"width": 1280, "height": 1000}, locale="en-GB")
            page.set_default_timeout(PATIENCE)
            page.goto(url)
            judged(page)
            draw(page)
            page.close()
        browser.close()


if __name__ == "__main__":
    main()
