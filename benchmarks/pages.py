"""Measure the pages in a browser, and write docs/results-pages.md.

python -m benchmarks.pages       # a few minutes; needs chromium, and is best left alone on the machine
"""

from __future__ import annotations

import os
import platform
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from benchmarks.markdown import processor, table
from benchmarks.outcomes import CHECKOUT, tell
from benchmarks.publishing import publish
from cdia_pin import Dynamics, Log, compare, discover, exciting_trajectory, load_robot, write_log
from cdia_pin.effects import parse_term
from cdia_pin.viewers import write_report
from cdia_pin.viewers.live import LiveView
from cdia_pin.viewers.scene import Scene, monitor_stages

PAGE = CHECKOUT / "docs" / "results-pages.md"
CHROMIUM = ("--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
TRIES = 5
UPDATES, SECONDS = 30, 10  # a second, and for how long
FRICTION = {"ur5": "coulomb_friction@elbow_joint", "panda": "coulomb_friction@panda_joint4"}
Row = tuple[str, str, str, str]  # claim, target, measured, met


def main() -> None:
    """Measure, and write the page."""
    from playwright.sync_api import sync_playwright

    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=list(CHROMIUM))
        logs = {arm: minute(arm, Path(folder)) for arm in FRICTION}
        rows = [*of_app(browser, logs["ur5"]), *of_report(browser, logs["panda"]), *of_view(browser)]
        browser.close()
    publish(page(rows), PAGE)


def minute(arm: str, folder: Path) -> Path:
    """Write a minute of an arm at 250 Hz, with friction that its URDF lacks."""
    robot, rng = load_robot(arm), np.random.default_rng(4)
    time_ = np.arange(0, 60, 0.004)
    q, v, a = exciting_trajectory(robot, rng, duration=60.0)(time_)
    tau = Dynamics(robot, (parse_term(f"{FRICTION[arm]}: level=5"),)).inverse_dynamics(q, v, a)
    tau += 0.01 * tau.std(axis=0) * rng.standard_normal(tau.shape)
    return write_log(Log(robot.joints, time_, 2e-5 * np.round(q / 2e-5), tau), folder / f"{arm}.csv")


def of_app(browser: Any, log: Path) -> Iterator[Row]:
    """Yield how soon the app is there, and how soon it answers."""
    tell("the app")
    with served(log) as address:
        page = browser.new_page()
        page.set_default_timeout(120_000)
        paints = []
        for _ in range(TRIES):
            page.goto(address)
            page.wait_for_selector("[data-mark=load]")
            paints.append(
                page.evaluate("performance.getEntriesByName('first-contentful-paint')[0].startTime") / 1e3
            )
        yield quick(f"`cdia app`: first contentful paint, median of {TRIES} (largest)", 3.0, paints)
        page.wait_for_selector("[data-mark=verdict]")
        added = []
        for _ in range(TRIES):
            added.append(page.evaluate(ADD, f"add-{FRICTION['ur5']}") / 1e3)
            page.locator("[data-mark=undo]").click()
            page.locator('[data-mark="version-0"][aria-pressed="true"]').wait_for()
            page.locator("[data-mark=running]").wait_for(state="hidden")
        yield quick(f"a click on Add, UR5, 60 s at 250 Hz: answer, median of {TRIES} (largest)", 2.0, added)
        page.close()


ADD = """(mark) => new Promise((resolve) => {
  const begin = performance.now();
  new MutationObserver((_, watcher) => {
    if (!document.querySelector('[data-mark="version-1"][aria-pressed="true"]')) return;
    watcher.disconnect();
    resolve(performance.now() - begin);
  }).observe(document.body, { childList: true, subtree: true, attributes: true });
  document.querySelector(`[data-mark="${mark}"]`).click();
})"""


def of_report(browser: Any, log: Path) -> Iterator[Row]:
    """Yield how large a report is, and what it asks for."""
    tell("a report")
    from cdia_pin import read_log

    robot = load_robot("panda")
    model, measured = Dynamics(robot), read_log(log, robot)
    found = discover(model, measured)
    path = write_report(
        log.with_suffix(".html"),
        compare(model, measured),
        improved=compare(found.model, measured),
        discovery=found,
    )
    size = path.stat().st_size / 1e6
    yield "report of `discover`, Panda, 60 s", "≤ 6 MB", f"{size:.1f} MB", word(size <= 6)
    page, asked, wrong = browser.new_page(), [], []
    page.on("request", lambda r: asked.append(r.url) if r.url.startswith(("http", "ws")) else None)
    page.on("pageerror", lambda e: wrong.append(str(e)))
    page.goto(path.as_uri())
    page.wait_for_function("globalThis.motion?.arm")
    yield (
        "requests of that report, opened from disk, to any host",
        "0",
        str(len(asked)),
        word(not asked and not wrong),
    )
    page.close()


def of_view(browser: Any) -> Iterator[Row]:
    """Yield whether the live view keeps up."""
    tell("the live view")
    robot = load_robot("ur5")
    with LiveView(Scene.of(robot), stages=monitor_stages()) as view:
        page = browser.new_page(viewport={"width": 1280, "height": 800})
        page.goto(view.address)
        page.wait_for_function("globalThis.player")
        page.wait_for_timeout(2000)
        drawn = "arm.viewer.renderer.info.render.frame"
        before, begin = page.evaluate(drawn), time.monotonic()
        for k in range(UPDATES * SECONDS):
            colours = {
                "stage": [[k // 10 % 6] * robot.n],
                "level": [[1.0] * robot.n],
                "torque": [[0.0] * robot.n],
            }
            view.show({"time": [k / UPDATES], "position": [[0.001 * k] * robot.n], **colours})
            page.wait_for_timeout(max(0.0, 1e3 * (begin + (k + 1) / UPDATES - time.monotonic())))
        took = time.monotonic() - begin
        arrived, behind = page.evaluate("[player._data.time.length, player.end - player.time]")
        shown = (page.evaluate(drawn) - before) / took
        cost = page.evaluate(
            "(() => { const t = performance.now(); for (let k = 0; k < 300; k++) player.seek(k / 100);"
            " return (performance.now() - t) / 300; })()"
        )
        page.close()
    every = UPDATES * SECONDS
    yield (
        f"`cdia view`, UR5: {UPDATES} colour updates a second for {SECONDS} s: applied, and behind at the end",
        f"{every}, ≤ 0.5 s",
        f"{arrived}, {behind:.2f} s",
        word(arrived == every and behind <= 0.5),
    )
    yield "the same: an update without drawing", "≤ 33 ms", f"{cost:.2g} ms", word(cost <= 33)
    yield (
        "the same: pictures drawn, by software without a GPU",
        "30 a second",
        f"{shown:.0f} a second",
        word(shown >= 29),
    )


def quick(claim: str, limit: float, took: list[float]) -> Row:
    """Return a row about times [s]."""
    return claim, f"≤ {limit:g} s", f"{median(took):.2f} s ({max(took):.2f} s)", word(median(took) <= limit)


def word(met: bool) -> str:
    """Return whether a target was met, in a word."""
    return "yes" if met else "**no**"


@contextmanager
def served(log: Path) -> Iterator[str]:
    """Run the app with a log beside this process; yield its address."""
    command = [
        sys.executable,
        "-m",
        "cdia_pin",
        "app",
        str(log),
        "--robot",
        "ur5",
        "--no-open",
        "--port",
        "0",
    ]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    try:
        for line in process.stdout or ():
            if found := re.search(r"http://\S+", line):
                yield found[0]
                break
    finally:
        process.terminate()
        process.wait(30)


def page(rows: list[Row]) -> str:
    """Return the results as Markdown."""
    load = os.getloadavg()[0]
    return "\n".join(
        [
            "# Results of the pages",
            "",
            f"Generated by `python -m benchmarks.pages` with Python {platform.python_version()}, {processor()}, "
            f"{os.cpu_count()} cores, load {load:.1f}; do not edit.",
            "Times are those of headless chromium, which draws in software here.",
            "",
            table(("claim", "target", "measured", "met"), rows),
            "",
        ]
    )


if __name__ == "__main__":
    main()
