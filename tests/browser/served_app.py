"""The app in a process of its own, and what tests ask of its pages."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import threading
from typing import Any

from tests.processes import python

PATIENCE = 180_000  # [ms], on a machine that does much else


class Served:
    """The app in a process of its own."""

    def __init__(self, *arguments: str) -> None:
        self.address, self.entry, self.said = "", "", []
        command = python("-m", "cdia_pin", "app", "--no-open", "--port", "0", *arguments)
        # NiceGUI serves its own tests otherwise.
        environment = {k: v for k, v in os.environ.items() if not k.startswith("PYTEST")} | {"NO_COLOR": "1"}
        self.process = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment
        )
        ready = threading.Event()

        def listen() -> None:
            for line in self.process.stdout or ():
                self.said.append(line)
                if found := re.search(r"(http://127\.0\.0\.1:\d+)/\?token=\S+", line):
                    self.entry, self.address = found[0], found[1]
                    ready.set()
            ready.set()  # it has ended

        threading.Thread(target=listen, daemon=True).start()
        if not (ready.wait(PATIENCE / 1e3) and self.address):
            self.process.kill()
            raise AssertionError(f"the app did not begin: {''.join(self.said)}")

    def interrupt(self) -> int:
        """Press Ctrl-C; return the exit code."""
        self.process.send_signal(signal.SIGINT)
        return self.process.wait(60)


def quiet(page: Any, app: Served) -> None:
    """Nothing on the console, and nothing asked of another machine."""
    assert page.seen.errors == [], page.seen.errors
    assert [r for r in page.seen.requests if not r.replace("ws:", "http:").startswith(app.address)] == []


def mark(page: Any, name: str) -> Any:
    return page.locator(f'[data-mark="{name}"]')


def error(page: Any) -> float:
    """The error that the page states [1]."""
    return float(mark(page, "error").get_attribute("data-value"))


def reachable(page: Any, name: str) -> bool:
    """Whether a mouse gets to an element without scrolling: it is in the window, and nothing lies over it."""
    return mark(page, name).evaluate(
        """(e) => { const { left, top, width, height } = e.getBoundingClientRect();
           return e.contains(document.elementFromPoint(left + 0.5 * width, top + 0.5 * height)); }"""
    )
