"""Output that goes on where stdout or stderr is closed, or cannot write every character."""

from __future__ import annotations

import os
import sys


def mend_streams() -> None:
    """Replace closed streams by nothing, and let the others write what they can."""
    for name in ("stdin", "stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:  # closed by who started the program; the lowest free number is the closed one
            setattr(sys, name, open(os.devnull, "r" if name == "stdin" else "w", encoding="utf-8"))  # noqa: SIM115, PTH123
        elif hasattr(stream, "reconfigure") and name != "stdin":
            stream.reconfigure(errors="replace")
