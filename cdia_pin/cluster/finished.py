"""What came of one item of work."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar, cast

from cdia_pin.errors import CdiaError
from cdia_pin.phrases import one_line

I = TypeVar("I")  # noqa: E741
R = TypeVar("R")


class ClusterError(CdiaError):
    """The scheduler cannot be reached, its workers cannot do the work, or an item ends them."""


@dataclass(frozen=True)
class Finished(Generic[I, R]):
    """An item with its result, or with the error that it ended in.

    Attributes:
        item: What was worked on.
        value: What the function returned; None where it raised.
        error: What it raised; a `ClusterError` if no worker survived the item; None where it returned.
    """

    item: I
    value: R | None
    error: Exception | None = None

    @property
    def result(self) -> R:
        """Result of the item.

        Raises:
            Exception: What the function raised, if it did.
        """
        if self.error is not None:
            raise self.error
        return cast("R", self.value)

    @property
    def why(self) -> str:
        """The error in one line, with its kind; empty where there was none."""
        return "" if self.error is None else f"{type(self.error).__name__}: {one_line(self.error)}"
