"""A fault of the program itself: one sentence for people, and the traceback in a file."""

from __future__ import annotations

import os
import platform
import tempfile
import traceback

from cdia_pin.phrases import clipped
from cdia_pin.version import __version__


def is_fault(error: BaseException) -> bool:
    """Tell whether an exception is a failure of the program; a panic of Rust is none of Python's ``Exception``.

    Args:
        error: What was raised.
    """
    return isinstance(error, Exception) or type(error).__name__ == "PanicException"


def fault_sentence(error: BaseException, doing: str) -> str:
    """Write the traceback of a fault to a file and return a sentence that names it.

    Args:
        error: What was raised.
        doing: What the program was asked for, such as a command.
    """
    text = "".join(
        [
            f"cdia-pin {__version__}, Python {platform.python_version()}, {platform.platform()}\n{doing}\n\n",
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
        where = f"its traceback is in {name}"
    said = f"{type(error).__name__}: {clipped(str(error), 200)}"
    return f"this is a fault of cdia, not of its input ({said}); {where}; please report it with that file"
