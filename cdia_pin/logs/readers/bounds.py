"""How large the contents of a compressed log may be: known before they are read, and bounded."""

from __future__ import annotations

from cdia_pin.errors import LogError

ALWAYS = 64 * 2**20  # [B], contents that any file may have: an hour of an arm at 125 Hz
GROWTH = 100  # [1], contents over the size of the file; measured signals shrink to a tenth at best
MOST = 8 * 2**30  # [B], contents of any file


def require_bounded(contents: int, size: int, source: str) -> None:
    """Refuse a file whose contents are out of all proportion to its size.

    Args:
        contents: Size of its contents when they are decompressed [B].
        size: Size of the file [B].
        source: Its name, for messages.

    Raises:
        LogError: If the contents are too large.
    """
    most = min(MOST, max(ALWAYS, GROWTH * size))
    if contents > most:
        raise LogError(
            f"{source}: its {size / 1e6:.3g} MB would become {contents / 1e6:.3g} MB when they are decompressed; "
            f"{most / 1e6:.3g} MB are read at most"
        )
