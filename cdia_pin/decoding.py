"""Reading with another library: its decoders raise whatever the bytes of a broken file happen to mean."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from cdia_pin.errors import CdiaError
from cdia_pin.phrases import LONGEST_REASON, one_line


@contextmanager
def decoding(refusal: Callable[[str], CdiaError]) -> Iterator[None]:
    """Turn every error of a decoder into one of ours; ours pass.

    A list of what a decoder can raise is never whole: a zip file of a later version is a `NotImplementedError`,
    an encrypted one a `RuntimeError`.

    Args:
        refusal: Returns the error to raise, given what the decoder said, on one line.

    Raises:
        CdiaError: What ``refusal`` returned, if the block raised anything else.
    """
    try:
        yield
    except CdiaError:
        raise
    except Exception as error:
        raise refusal(one_line(error, LONGEST_REASON)) from None
