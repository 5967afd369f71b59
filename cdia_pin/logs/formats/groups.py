"""Groups of columns that differ by the number or the name of a joint only."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from cdia_pin.logs.formats.patterns import NAME, NUMBER, ONLY, labels_of

FEWEST_LETTERS = 1  # [characters] that columns must share to be a group by name
SEPARATORS = "._/ "


@dataclass(frozen=True)
class JointColumns:
    """Columns of one quantity, one for each joint.

    Attributes:
        pattern: Their names, with ``#`` or ``*`` in the place of the joint.
        labels: The column of each joint label, in the order of the joints as far as it is known.
    """

    pattern: str
    labels: dict[str, str]


def grouped(names: Sequence[str], count: int) -> list[JointColumns]:
    """Find the groups of columns with one member for each joint.

    Args:
        names: Names of columns, in the order of the file.
        count: Number of joints; of one joint each column is a group, by its whole name.

    Returns:
        The groups, those with numbers first, without overlap.
    """
    if count == 1:
        return [JointColumns(name, {ONLY: name}) for name in names if not set(name) & {NUMBER, NAME}]
    groups: list[JointColumns] = []
    taken: set[str] = set()
    for pattern, often in Counter([*_numbered(names), *_named(names)]).items():
        if often < count:  # too few names fit, and each look at all of them takes time
            continue
        labels = labels_of(pattern, [name for name in names if name not in taken])
        if NUMBER in pattern:
            labels = dict(sorted(labels.items(), key=lambda item: int(item[0])))
            consecutive = [int(k) for k in labels] in (list(range(count)), list(range(1, count + 1)))
        else:
            consecutive = len(labels) == count
        if consecutive:
            groups.append(JointColumns(pattern, labels))
            taken.update(labels.values())
    return groups


def _numbered(names: Sequence[str]) -> list[str]:
    """Return each name with one of its numbers left out."""
    return [
        name[: m.start()] + NUMBER + name[m.end() :]
        for name in names
        if not set(name) & {NUMBER, NAME}
        for m in re.finditer(r"\d+", name)
    ]


def _named(names: Sequence[str]) -> list[str]:
    """Return each name with its beginning or its end left out, at every separator."""
    out = []
    for name in names:
        if set(name) & {NUMBER, NAME}:
            continue
        for k, letter in enumerate(name):
            if letter in SEPARATORS and FEWEST_LETTERS <= k < len(name) - FEWEST_LETTERS:
                out += [name[: k + 1] + NAME, NAME + name[k:]]
    return out
