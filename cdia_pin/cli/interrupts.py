"""Ctrl-C that ends a command even if other code swallows it.

Python raises KeyboardInterrupt wherever the program happens to be. In a destructor or in a callback from C, of which a
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

AGAIN = 0.5  # [s] between repetitions of an interrupt that nothing came of

_answered = threading.Event()  # the code inside ends because it was interrupted


@contextmanager
def until_interrupted() -> Iterator[None]:
    """Leave the block without an error when it is interrupted: how what runs until Ctrl-C ends."""
    try:
        yield
    except KeyboardInterrupt:
        _answered.set()


@contextmanager
def insistent() -> Iterator[None]:
    """Repeat an interrupt until the code inside is left, is cleaning up after it or has answered it.

    A second Ctrl-C of the user ends a clean-up as well.
    """
    main = threading.main_thread()
    in_main = threading.current_thread() is main  # which alone is interrupted
    if not in_main or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        yield
        return
    left = threading.Event()
    _answered.clear()
    asked = repeated = False  # no lock: a handler may come while the program holds it

    def repeat() -> None:
        nonlocal repeated
        while not left.wait(AGAIN):
            if asked:
                repeated = True
                if main.ident is not None and hasattr(signal, "pthread_kill"):
                    signal.pthread_kill(main.ident, signal.SIGINT)  # wakes a call that blocks
                else:
                    interrupt_main()

    def interrupted(number: int, frame: FrameType | None) -> None:
        nonlocal asked, repeated
        asked, by_us, repeated = True, repeated, False
        if not by_us or not (left.is_set() or _answered.is_set() or _is_cleaning_up()):
            raise KeyboardInterrupt

    unraisable = sys.unraisablehook

    def say_what_was_swallowed(lost: sys.UnraisableHookArgs) -> None:
        if not isinstance(lost.exc_value, KeyboardInterrupt):  # which comes again
            unraisable(lost)

    sys.unraisablehook = say_what_was_swallowed
    signal.signal(signal.SIGINT, interrupted)
    repeating = threading.Thread(target=repeat, name="cdia-interrupt", daemon=True)
    repeating.start()
    try:
        yield
    finally:
        left.set()
        repeating.join()
        signal.signal(signal.SIGINT, signal.default_int_handler)
        sys.unraisablehook = unraisable
        # An interrupt inside a string that is executed, as compilers have them, is remembered until the next such
        # string: Python would end by it whatever the exit code.
        exec("pass")


def _is_cleaning_up() -> bool:
    """Tell whether an interrupt, or what somebody made of it, is being handled."""
    error = sys.exc_info()[1]
    while error is not None and not isinstance(error, KeyboardInterrupt):
        error = error.__context__
    return error is not None
