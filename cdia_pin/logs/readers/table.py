"""The result of every reader: named columns, before their names are interpreted."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdia_pin.errors import LogError
from cdia_pin.phrases import shortened, some


@dataclass(frozen=True, repr=False)
class Table:
    """Columns of a file.

    Attributes:
        columns: Numbers by column name, each of shape (N,). Integers stay integers, so that nanoseconds since
            1970 keep their digits.
        not_numbers: Columns without numbers, each with an example of its values.
        time_unit: Unit of the times if the format fixes it, such as ``ns``.
        notes: Inferences of the reader, one sentence each.
        format: Name of the format if the file itself tells it, such as ``ros2``; else the columns tell.
    """

    columns: dict[str, NDArray[Any]]
    not_numbers: dict[str, str] = field(default_factory=dict)
    time_unit: str | None = None
    notes: tuple[str, ...] = ()
    format: str | None = None

    def __repr__(self) -> str:
        return (
            f"Table({len(self.columns)} columns: {some([shortened(name, 20) for name in self.columns], 3)})"
        )

    def _side_by_side(self, names: list[str]) -> NDArray[np.float64] | None:
        """Return the array of which these columns are all the columns, in this order; None if there is none."""
        whole = self.columns[names[0]].base
        if not isinstance(whole, np.ndarray) or whole.dtype != np.float64 or whole.ndim != 2:
            return None
        at = [self.columns[name].__array_interface__["data"][0] for name in names]
        mine = all(self.columns[name].base is whole for name in names)
        beginnings = [whole[:, k].__array_interface__["data"][0] for k in range(whole.shape[1])]
        return whole if mine and at == beginnings else None

    def stack(self, names: list[str], source: str) -> NDArray[np.float64]:
        """Return columns side by side; the table's columns become views of them, so that a long log is held once.

        Args:
            names: Names of k columns.
            source: Name of the file, for messages.

        Returns:
            Values [as logged], shape (N, k).

        Raises:
            LogError: If a column holds something else than numbers.
        """
        for name in names:
            if name in self.not_numbers:
                raise LogError(f"{source}: column '{name}' must hold numbers, found {self.not_numbers[name]}")
        whole = self._side_by_side(names)
        if whole is not None:
            return whole
        out = np.column_stack([np.asarray(self.columns[name], dtype=np.float64) for name in names])
        for k, name in enumerate(names):
            if self.columns[name].dtype == out.dtype:
                self.columns[name] = out[:, k]
        return out
