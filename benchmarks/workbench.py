"""What the workbench takes: page ready, previews while a hand drags, the proof on release, page weight, memory after many drags.

Everything is measured in Debian's Chromium, driven by Playwright, on a workbench that is started as a user starts it. Times are wall
times, for that is what a hand waits for: run it on an idle machine. Writes the rows as CSV and prints them; the exit code tells whether
the promises are kept:

    python benchmarks/workbench.py [--starts 5] [--moves 200] [--drags 1000]
"""

from __future__ import annotations

import argparse
import contextlib
import csv
import io
import json
import shutil
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter, time
from typing import Any

from playwright.sync_api import Browser, Page, sync_playwright

from camwright.cli.main import main as command_line

ROOT = Path(__file__).parents[1]
RESULTS = Path(__file__).parent / "results"
MACHINES = {"knife": "paper-600", "carriage": "flying-saw", "crank": "chasing-shear"}
COMMAND = [sys.executable, "-c", "import sys; from camwright.cli.main import main; sys.exit(main())", "workbench"]

READY, PREVIEW, FRAMES, PROOF, CRANK_MORE, WEIGHT, GROWTH = 1.5, 0.050, 30.0, 0.5, 1.5, 6e6, 0.10
"""What the project promises: s, s, frames a second, s, s beyond the command's own time, bytes, share."""

DRAG = """([handle, moves, pace]) => new Promise((done) => {
  const grip = document.querySelector(handle);
  const box = grip.getBoundingClientRect();
  const send = (target, kind, x) => target.dispatchEvent(new PointerEvent(kind, { clientX: x, clientY: box.y, bubbles: true, buttons: 1 }));
  send(grip, "pointerdown", box.x);
  let [count, frames, start, last] = [0, 0, performance.now(), 0];
  const tick = (now) => {
    frames += 1;
    if (now - last >= pace) {
      last = now;
      count += 1;
      send(window, "pointermove", box.x - 40 * Math.sin((2 * Math.PI * count) / moves));
    }
    if (count < moves) return requestAnimationFrame(tick);
    const rate = (1000 * frames) / (performance.now() - start);
    const badge = document.querySelector("#badge");
    const released = performance.now();
    window.proof = new Promise((told) => {
      new MutationObserver((_, seen) => {
        if (!["proved", "failed"].includes(badge.className)) return;
        seen.disconnect();
        told((performance.now() - released) / 1000);
      }).observe(badge, { attributes: true, childList: true });
    });
    send(window, "pointerup", box.x - 15);
    return done(rate);
  };
  requestAnimationFrame(tick);
})"""
"""A hand that drags: moves at a pace (ms), counted in frames of the page; gives frames a second, and promises how long the proof takes from
letting go (s). The page tells that itself, for whoever asks from outside asks now and then."""

DRAWN = """() => {
  const seen = new MutationObserver(() => {
    if (!document.querySelector("#plots path.curve[data-row=jerk]")) return;
    seen.disconnect();
    window.drawnAt = performance.timeOrigin + performance.now();
  });
  seen.observe(document, { childList: true, subtree: true });
}"""
"""Notes when the plots are drawn (ms since 1970)."""

TIMES = """() => performance.getEntriesByType("resource")
  .filter((each) => each.name.endsWith("api/preview")).map((each) => each.duration / 1000)"""
"""How long each preview took from the page and back (s)."""


@dataclass(frozen=True)
class Bench:
    """A running workbench."""

    process: subprocess.Popen[str]
    url: str
    begun: float
    """When the command was given (s since 1970)."""

    def memory(self) -> int:
        """Resident bytes of the server itself."""
        text = Path(f"/proc/{self.process.pid}/status").read_text(encoding="ascii")
        return 1024 * int(next(line.split()[1] for line in text.splitlines() if line.startswith("VmRSS")))


@contextlib.contextmanager
def workbench(example: str) -> Iterator[Bench]:
    """Start a workbench on an example."""
    begun = time()
    arguments = [str(ROOT / "examples" / f"{example}.toml"), "--json", "--no-browser"]
    with (
        tempfile.TemporaryDirectory() as folder,
        subprocess.Popen([*COMMAND, *arguments], stdout=subprocess.PIPE, text=True, cwd=folder) as process,
    ):
        assert process.stdout is not None  # noqa: S101 - asked for above
        try:
            yield Bench(process, json.loads(process.stdout.readline())["url"], begun)
        finally:
            process.terminate()


def opened(browser: Browser, bench: Bench) -> Page:
    """Open the page of a workbench; ready when its plots are drawn."""
    page = browser.new_page(viewport={"width": 1280, "height": 900})
    page.set_default_timeout(120_000)
    page.add_init_script(f"({DRAWN})()")
    page.goto(bench.url)
    page.locator("#plots path.curve[data-row=jerk]").wait_for(state="attached")
    return page


def ready(browser: Browser, starts: int) -> float:
    """Median time (s) from the command to a page that shows its cam; one start before is not counted."""
    times = []
    for number in range(-1, starts):
        with workbench("paper-600") as bench:
            page = opened(browser, bench)
            if number >= 0:
                times.append(page.evaluate("() => window.drawnAt / 1000") - bench.begun)
            page.close()
    return statistics.median(times)


def weight(browser: Browser) -> tuple[float, int]:
    """Bytes of the page with all that it loads, and how many requests go to other hosts."""
    with workbench("paper-600") as bench:
        page = browser.new_page()
        sizes: list[int] = []
        foreign: list[str] = []

        def loaded(response: Any) -> None:
            if not response.url.startswith(bench.url.partition("?")[0]):
                foreign.append(response.url)
            elif "/api/" not in response.url:
                sizes.append(len(response.body()))

        page.on("requestfinished", lambda request: loaded(request.response()))
        page.goto(bench.url)
        page.locator("#badge.proved").wait_for(timeout=120_000)
        page.close()
    return float(sum(sizes)), len(foreign)


def own_time(example: str) -> float:
    """Time (s) of the command itself in a warm process."""
    arguments = ["design", str(ROOT / "examples" / f"{example}.toml"), "--json", "--no-figures"]
    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
        for number in range(2):
            begun = perf_counter()
            command_line([*arguments, "--out", f"{folder}/{number}"])
        return perf_counter() - begun


def dragged(browser: Browser, example: str, moves: int) -> dict[str, float]:
    """Drag the cut length once to and fro: 95th percentile of the previews (s), frames a second, the proof (s) after letting go."""
    with workbench(example) as bench:
        page = opened(browser, bench)
        page.locator("#badge.proved, #badge.failed").first.wait_for()
        page.evaluate(DRAG, ['g[data-path="cut.length"]', 20, 16])  # makes the programmes
        page.evaluate("() => window.proof")
        page.evaluate("() => performance.clearResourceTimings()")
        page.evaluate("() => performance.setResourceTimingBufferSize(5000)")
        rate = page.evaluate(DRAG, ['g[data-path="cut.length"]', moves, 30])
        proof = page.evaluate("() => window.proof")
        times = sorted(page.evaluate(TIMES))
        page.close()
    return {"previews": len(times), "preview_s": times[int(0.95 * len(times))], "frames_per_s": rate, "proof_s": proof}


def growth(browser: Browser, drags: int) -> tuple[float, float]:
    """Growth of the server's memory and of the page's heap over many drags, after some that fill what is kept on purpose."""
    with workbench("paper-600") as bench:
        page = opened(browser, bench)
        page.locator("#badge.proved").wait_for()
        session = page.context.new_cdp_session(page)

        def heap() -> float:
            session.send("HeapProfiler.collectGarbage")
            return float(session.send("Runtime.getHeapUsage")["usedSize"])

        def drag(count: int) -> tuple[float, float]:
            for _ in range(count):
                page.evaluate(DRAG, ['g[data-path="cut.length"]', 2, 0])
            page.locator("#badge.proved, #badge.failed").first.wait_for()
            return bench.memory(), heap()

        before, after = drag(max(drags // 4, 1)), drag(drags)
        page.close()
    return after[0] / before[0] - 1.0, after[1] / before[1] - 1.0


def main() -> int:
    """Measure, judge, write, print; the exit code tells whether the promises are kept."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--starts", type=int, default=5)
    parser.add_argument("--moves", type=int, default=200)
    parser.add_argument("--drags", type=int, default=1000)
    options = parser.parse_args()
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    if chromium is None:
        print("no Chromium is installed: apt-get install chromium", file=sys.stderr)
        return 1
    rows: list[tuple[str, float, float, bool]] = []

    def promised(name: str, value: float, most: float, *, at_least: bool = False) -> None:
        kept = value >= most if at_least else value <= most
        rows.append((name, value, most, kept))
        print(f"{name},{value:.4g},{most:.4g},{'kept' if kept else 'BROKEN'}", flush=True)

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        promised("ready_s", ready(browser, options.starts), READY)
        size, foreign = weight(browser)
        promised("page_bytes", size, WEIGHT)
        promised("requests_to_other_hosts", foreign, 0)
        for machine, example in MACHINES.items():
            found = dragged(browser, example, options.moves)
            promised(f"{machine}_preview_p95_s", found["preview_s"], PREVIEW)
            promised(f"{machine}_frames_per_s", found["frames_per_s"], FRAMES, at_least=True)
            promised(
                f"{machine}_proof_s", found["proof_s"], own_time(example) + CRANK_MORE if machine == "crank" else PROOF
            )
        server, heap = growth(browser, options.drags)
        promised("server_memory_growth", server, GROWTH)
        promised("page_memory_growth", heap, GROWTH)
        browser.close()
    RESULTS.mkdir(exist_ok=True)
    with (RESULTS / "workbench.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["measure", "value", "promise", "kept"])
        table.writerows((name, f"{value:.6g}", f"{most:.6g}" if most else "", kept) for name, value, most, kept in rows)
    return 0 if all(kept for *_, kept in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
