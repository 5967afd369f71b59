"""A real browser for the tests: Debian's chromium, driven by Playwright."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

CHROMIUM = shutil.which("chromium")
# Pages are put together without a graphics card; only what WebGL draws goes through its substitute. If the whole page
# did, each picture of a moving arm would hold up all that the page does, by seconds on a slow machine.
OPTIONS = (
    "--no-sandbox",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
)


@dataclass
class Seen:
    """What a page did beside what it showed.

    Attributes:
        errors: Messages of the console at level error, and exceptions.
        requests: Addresses it asked for, those inside the page left out.
    """

    errors: list[str] = field(default_factory=list)
    requests: list[str] = field(default_factory=list)


@pytest.fixture(scope="session")
def chromium() -> Iterator[Any]:
    """A headless browser for the session; each test opens pages of its own."""
    if CHROMIUM is None:
        reason = "no chromium to open pages in; tests/browser/install puts it there"
        if os.environ.get("CDIA_NEED_BROWSER"):
            pytest.fail(reason)
        pytest.skip(reason)
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=list(OPTIONS))
        yield browser
        browser.close()


@pytest.fixture
def page(chromium: Any) -> Iterator[Any]:
    """An empty page whose errors and requests are in ``page.seen``."""
    context = chromium.new_context(viewport={"width": 1280, "height": 860}, accept_downloads=True)
    page = context.new_page()
    page.seen = watch(page)
    yield page
    context.close()


def watch(page: Any) -> Seen:
    """Take note of a page's errors and of what it asks for."""
    seen = Seen()
    page.on("console", lambda m: seen.errors.append(m.text) if m.type == "error" else None)
    page.on("pageerror", lambda e: seen.errors.append(str(e)))
    page.on(
        "request", lambda r: seen.requests.append(r.url) if not r.url.startswith(("data:", "blob:")) else None
    )
    return seen


@pytest.fixture(scope="session")
def screenshots() -> Path:
    """Where pictures for README and docs go: ``docs/`` where CDIA_SCREENSHOTS says so, else a folder of the tests."""
    folder = Path(os.environ.get("CDIA_SCREENSHOTS", "out/screenshots"))
    folder.mkdir(parents=True, exist_ok=True)
    return folder
