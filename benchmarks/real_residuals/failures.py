"""What a program failed with, in a line."""

from __future__ import annotations


def failed(why: BaseException) -> str:
    """Return an error as a line; what stops the whole run is raised again.

    Args:
        why: The error.
    """
    if isinstance(why, KeyboardInterrupt | SystemExit):
        raise why
    return f"{type(why).__name__}: {str(why).splitlines()[0] if str(why) else ''}"[:200]
