"""Ctrl-C that ends a command even if somebody else's code swallows it.

Python raises KeyboardInterrupt wherever the program happens to be. In a destructor or a callback from C, of which a
compiler runs thousands, the exception is printed or dropped and the program goes on: the first Ctrl-C is lost.
"""

from __future__ import annotations

import signal
import sys
import threading
from _thread import interrupt_main
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

AGAIN = 0.5  # [s] after which an interrupt that nothing came of is repeated


@contextmanager
def insistent() -> Iterator[None]:
    """Repeat an interrupt until the code inside is left or is cleaning up after it."""
    in_main = threading.current_thread() is threading.main_thread()  # which alone is interrupted
    if not in_main or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        yield
        return
    left = threading.Event()
    asked = False  # no lock: a handler may come while the program holds it

    def repeat() -> None:
        while not left.wait(AGAIN):
            if asked:
                interrupt_main()

    def interrupted(number: int, frame: FrameType | None) -> None:
        nonlocal asked
        asked = True
        if not isinstance(sys.exc_info()[1], KeyboardInterrupt):
            raise KeyboardInterrupt

    signal.signal(signal.SIGINT, interrupted)
    threading.Thread(target=repeat, name="cdia-interrupt", daemon=True).start()
    try:
        yield
    finally:
        left.set()
        signal.signal(signal.SIGINT, signal.default_int_handler)
