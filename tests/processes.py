"""Processes that tests start and interrupt."""

import sys

HEEDING = """
import os, signal, sys
signal.signal(signal.SIGINT, signal.SIG_DFL)
os.execv(sys.executable, [sys.executable, *sys.argv[1:]])
"""


def python(*arguments: str) -> list[str]:
    """Return a command that heeds Ctrl-C: shells have what runs in the background, such as these tests, ignore it."""
    return [sys.executable, "-c", HEEDING, *arguments]
