"""The last net of the command line: what nobody expected ends in one line, and its traceback in a file."""

from __future__ import annotations

import os
import platform
import sys
import tempfile
import traceback
from pathlib import Path

from cdia_pin.cli.failures import one_line
from cdia_pin.version import __version__

UNEXPECTED = 70  # exit code, EX_SOFTWARE of sysexits.h


def is_caught(error: BaseException) -> bool:
    """Tell whether an exception is a failure of the program; a panic of Rust is none of Python's ``Exception``.

    Args:
        error: What was raised.
    """
    return isinstance(error, Exception) or type(error).__name__ == "PanicException"


def describe(error: BaseException, command: str) -> str:
    """Write the traceback of a failure to a file and return the line to be printed.

    Args:
        error: What was raised.
        command: What the user typed.
    """
    said = f"{type(error).__name__}: {one_line(error)}"
    text = "".join(
        [
            f"cdia-pin {__version__}, Python {platform.python_version()}, {platform.platform()}\n{command}\n\n",
            *traceback.format_exception(error),
        ]
    )
    try:
        handle, name = tempfile.mkstemp(prefix="cdia-error-", suffix=".txt")
        with os.fdopen(handle, "w", encoding="utf-8", errors="backslashreplace") as file:
            file.write(text)
    except OSError as failure:
        where = f"its traceback cannot be written ({failure.strerror})"
    else:
        where = f"its traceback is in {Path(name)}"
    return (
        f"this is a fault of cdia, not of its input ({said[:200]}); {where}; please report it with that file"
    )


def mend_streams() -> None:
    """Let output go on where stdout or stderr is closed, or cannot write every character."""
    for name in ("stdin", "stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:  # closed by who started the program; the lowest free number is the closed one
            setattr(sys, name, open(os.devnull, "r" if name == "stdin" else "w", encoding="utf-8"))  # noqa: SIM115, PTH123
        elif hasattr(stream, "reconfigure") and name != "stdin":
            stream.reconfigure(errors="replace")
