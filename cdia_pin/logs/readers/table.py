"""What every reader returns: named columns, before anyone asks what they mean."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdia_pin.errors import LogError


@dataclass(frozen=True)
class Table:
    """Columns of a file.

    Attributes:
        columns: Numbers by column name, each of shape (N,); integers stay integers, so that
            nanoseconds since 1970 keep their digits.
        not_numbers: Columns that hold something else, with an example of it.
        time_unit: Unit of the times where the format fixes it, such as ``ns``.
        notes: What the reader inferred, one sentence each.
    """

    columns: dict[str, NDArray[Any]]
    not_numbers: dict[str, str] = field(default_factory=dict)
    time_unit: str | None = None
    notes: tuple[str, ...] = ()

    def stack(self, names: list[str], source: str) -> NDArray[np.float64]:
        """Return columns side by side as float64, shape (N, len(names)).

        Raises:
            LogError: If a column holds something that is not a number.
        """
        for name in names:
            if name in self.not_numbers:
                raise LogError(f"{source}: column '{name}' must hold numbers, found {self.not_numbers[name]}")
        return np.column_stack([np.asarray(self.columns[name], dtype=np.float64) for name in names])
