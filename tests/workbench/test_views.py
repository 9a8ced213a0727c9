"""The views beside the plots, each in a real browser."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camwright.cli.main import main
from camwright.jobs.job import load_job
from camwright.profiles.returns import baseline
from camwright.studies.design import optimise
from camwright.validation.servo.simulation import simulate

EXAMPLES = Path(__file__).parents[2] / "examples"


def opened(page: Any, view: str, seen: str) -> Any:
    page.click(f"[data-view={view}]")
    panel = page.locator("#panel", has_text=seen)
    panel.wait_for()
    return panel


@pytest.fixture
def table() -> bytes:
    """Make the quintic cam of the bundled job as a spreadsheet has it."""
    job = load_job()
    x = np.linspace(0.0, job.cut.length, 361)
    rows = zip(x, baseline("poly_3_4_5", job.task)(x), strict=True)
    return "\n".join(["x [mm],y [mm]", *(f"{1e3 * a:.6f},{1e3 * b:.9f}" for a, b in rows)]).encode()


@pytest.fixture
def recording() -> bytes:
    """Record the bundled job's own cam as its servo runs it, to a tenth of a micrometre."""
    result = optimise(load_job())
    job, profile = result.job, result.profile
    servo = replace(job.servo, position_gain=30.0)
    times = np.arange(0.0, 4 * job.cut.period, 2e-3)
    x = times * job.cut.line_speed
    run = simulate(profile, job.cut, servo)
    order = np.argsort(run.master[0] % job.cut.length)
    lag = np.interp(
        x % job.cut.length,
        (run.master[0] % job.cut.length)[order],
        (run.command[0] - run.axis[0])[order],
        period=job.cut.length,
    )
    command = profile(x, outside="repeat")
    rows = zip(times, command, command - lag, strict=True)
    return "\n".join(
        ["time [ms],command [mm],actual [mm]", *(f"{1e3 * t:.1f},{1e3 * a:.4f},{1e3 * b:.4f}" for t, a, b in rows)]
    ).encode()


def test_checks_are_named_in_words(page: Any) -> None:
    panel = opened(page, "checks", "Ratio error in the sync zone")
    assert "Released for line speeds: 0 … 80 m/min" in panel.inner_text()
    assert "_" not in panel.inner_text()


def test_the_servo_at_every_phase_and_speed(page: Any) -> None:
    panel = opened(page, "servo", "16 sampling phases")
    assert page.locator("#panel path.phase").count() == 3 * 16
    assert "0.020273" in panel.inner_text()
    slider = page.locator("#servo-speed")
    slider.fill("50")
    page.locator("#panel", has_text="40 m/min (50 %)").wait_for()
    page.locator("#panel td", has_text="0.020273").wait_for(state="detached")


def test_comparison_and_trade_off(page: Any) -> None:
    panel = opened(page, "compare", "polynomial 3-4-5")
    assert page.locator("#panel rect.bar").count() == 12
    assert "parabolic *" in panel.inner_text()
    opened(page, "tradeoff", "Multiples of the best value")
    assert page.locator("#panel circle.own").count() == 4
    page.locator('#panel circle.own[aria-label*="RMS acceleration"]').press("Enter")
    page.locator("#badge.proved", has_text="RMS acceleration 7.8156").wait_for()


def test_how_far_puts_a_limit_into_the_job(page: Any) -> None:
    opened(page, "limits", "highest line speed")
    page.locator("#panel tr", has_text="axis in tolerance").first.locator("button").click()
    page.locator("#badge.proved").wait_for()
    assert page.input_value('[id="field-cut.line_speed"]') == "116.7 m/min"


def test_a_click_on_the_map_sets_the_working_point_and_marks_it_as_of_another_job(page: Any) -> None:
    page.click("[data-view=envelope]")
    page.locator("#panel button").click()
    page.locator("#panel path.possible").wait_for()
    assert page.locator("#panel path.curve").count() == 4
    page.locator("#panel svg").click(position={"x": 250, "y": 200})
    page.wait_for_timeout(200)
    assert page.input_value('[id="field-cut.length"]') != "600 mm"
    page.locator("#outdated").wait_for()


@pytest.mark.parametrize("target", ["codesys", "logix"])
def test_what_is_downloaded_is_what_the_command_line_writes(
    target: str, page: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    page.click("[data-view=export]")
    page.select_option("#panel select", target)
    page.locator("#panel button").click()
    link = page.locator("#panel li a").first
    link.wait_for()
    name = link.get_attribute("download")
    with page.expect_download() as download:
        link.click()
    monkeypatch.chdir(tmp_path)
    Path("job.toml").write_text(page.input_value("#toml"))
    assert main(["design", "job.toml", "--no-figures", "--quiet", "--out", "out"]) == 0
    assert main(["export", "out/design.json", "--to", target, "--quiet", "--out", "tables"]) == 0
    assert Path(download.value.path()).read_bytes() == Path("tables", name).read_bytes()


def test_a_recipe_is_shown_as_it_is_printed(page: Any) -> None:
    page.click("[data-view=recipe]")
    page.locator("#panel button").click()
    page.locator("#panel li a", has_text="recipe.pdf").wait_for()
    assert page.get_attribute("#panel iframe", "src").startswith("blob:http://127.0.0.1")


def test_a_dropped_table_is_judged_and_lies_over_the_plots(page: Any, table: bytes) -> None:
    page.click("[data-view=audit]")
    page.set_input_files("#panel input[type=file]", {"name": "running.csv", "mimeType": "text/csv", "buffer": table})
    page.locator("#panel td", has_text="29.3 %").wait_for()
    assert page.locator("path.curve.overlay").count() == 5
    page.locator("#legend button").click()
    assert page.locator("path.curve.overlay").count() == 0


def test_a_recording_is_laid_over_the_design_and_its_servo_taken(page: Any, recording: bytes) -> None:
    page.click("[data-view=audit]")
    page.set_input_files("#panel input[type=file]", {"name": "scope.csv", "mimeType": "text/csv", "buffer": recording})
    page.locator("#panel th", has_text="95 %").wait_for()
    page.locator("#panel td", has_text="drift per cut").wait_for()
    assert page.locator("path.curve.overlay.actual").count() == 3  # nobody differentiates a recording twice
    page.locator("#panel button", has_text="Use this servo").click()
    page.locator("#badge.proved, #badge.failed").first.wait_for()
    assert page.input_value('[id="field-servo.position_gain"]') != "35 1/s"


def test_what_is_no_table_is_refused_in_words(page: Any) -> None:
    page.click("[data-view=audit]")
    page.set_input_files(
        "#panel input[type=file]", {"name": "a.csv", "mimeType": "text/csv", "buffer": b"<b>nothing</b>"}
    )
    page.locator("#panel p.failed", has_text="a.csv").wait_for()
    assert page.locator("#panel b").count() == 0


def test_the_machine_moves(page: Any) -> None:
    page.click("[data-view=machine]")
    before = page.locator("#panel svg").inner_html()
    page.click("#panel button")
    page.wait_for_timeout(300)
    assert page.locator("#panel svg").inner_html() != before
    page.click("#panel button")
    page.wait_for_timeout(100)
    still = page.locator("#panel svg").inner_html()
    page.wait_for_timeout(200)
    assert page.locator("#panel svg").inner_html() == still


def test_a_drawing_is_bent(page: Any) -> None:
    page.click("[data-view=bender]")
    page.locator("#panel input[type=file]").first.set_input_files(EXAMPLES / "bender" / "carton.dxf")
    page.locator("#panel img").first.wait_for()
    text = page.inner_text("#panel")
    assert "meets the mould" in text
    assert "120 × 98 mm" in text
    assert page.locator("#panel img").first.evaluate("image => image.naturalWidth") > 0
    page.locator("#panel td.failed").wait_for()
    page.check("#panel label:has-text('although the bent part meets the mould') input")
    page.locator("#panel td.passed").wait_for()
    page.select_option("#panel select", "carton-3")
    assert page.locator("#panel details", has_text="carton-3").locator("tbody tr").count() == 3
