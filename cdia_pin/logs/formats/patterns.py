"""Patterns of column names: ``#`` stands for the number of a joint, ``*`` for its name.

On an arm of one joint a pattern may be a whole name, which stands for the first joint.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from functools import cache

from cdia_pin.errors import LogError, unknown_name
from cdia_pin.logs.columns import ALIASES
from cdia_pin.phrases import some

NUMBER, NAME = "#", "*"
ONLY = "1"  # label of the only joint, where a pattern is a whole name
TIME = "time"


def labels_of(pattern: str, names: Iterable[str]) -> dict[str, str]:
    """Find the columns of a pattern.

    Args:
        pattern: Such as ``actual_q_#`` or ``*/position``.
        names: Names of columns.

    Returns:
        The column of each joint label, in the order of the names.
    """
    expression = _expression(pattern)
    matches = ((name, expression.fullmatch(name.strip())) for name in names)
    return {match.group(1).strip() if match.groups() else ONLY: name for name, match in matches if match}


def column_patterns(
    given: Mapping[str, str] | Sequence[str] | None, *, one_joint: bool = False
) -> dict[str, str]:
    """Read which columns hold which signal, as a user says it.

    Args:
        given: {signal: pattern}, or texts ``signal=pattern``, several separated by commas; a signal is one of
            ``ALIASES`` or ``time``, whose pattern is the name of its column.
        one_joint: Whether the arm has one joint, so that a pattern may be a whole name.

    Returns:
        {signal: pattern}; empty for None.

    Raises:
        LogError: If a signal is unknown, or a pattern does not have one ``#`` or ``*``.
    """
    if given is None:
        return {}
    texts = [given] if isinstance(given, str) else given
    pairs = given.items() if isinstance(given, Mapping) else map(_pair, ",".join(texts).split(","))
    out = {}
    for signal, pattern in pairs:
        if signal not in {*ALIASES, TIME}:
            raise LogError("columns: " + unknown_name("signal", signal, [*ALIASES, TIME]))
        marks = pattern.count(NUMBER) + pattern.count(NAME)
        if signal != TIME and marks != 1 and not (one_joint and marks == 0):
            raise LogError(
                f"columns: '{pattern}' needs one {NUMBER} for the number of a joint, or one {NAME} for its name, "
                f"such as {signal}={pattern.rstrip('0123456789#*')}{NUMBER}"
            )
        out[signal] = pattern
    return out


def required_labels(signal: str, pattern: str, names: Sequence[str]) -> dict[str, str]:
    """Find the columns of a pattern that a user gave.

    Args:
        signal: What they hold, for the message.
        pattern: The pattern.
        names: Names of the columns of the file.

    Returns:
        The column of each joint label.

    Raises:
        LogError: If no column matches.
    """
    if found := labels_of(pattern, names):
        return found
    raise LogError(f"columns: {signal}={pattern} matches no column; the log has {some(list(names))}")


@cache
def _expression(pattern: str) -> re.Pattern[str]:
    parts = {re.escape(NUMBER): r"(\d+)", re.escape(NAME): "(.+)"}
    text = re.escape(pattern.strip())
    for mark, group in parts.items():
        text = text.replace(mark, group)
    return re.compile(text, re.IGNORECASE)


def _pair(text: str) -> tuple[str, str]:
    signal, equals, pattern = text.partition("=")
    if not equals or not signal.strip() or not pattern.strip():
        raise LogError(f"columns: '{text}' is not of the form signal=pattern, such as position=q_{NUMBER}")
    return signal.strip(), pattern.strip()
