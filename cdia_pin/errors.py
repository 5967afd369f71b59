"""Errors of the package: one base class, and one-line messages that name what to do."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class CdiaError(Exception):
    """Base of every error that this package raises on purpose."""


class RobotError(CdiaError):
    """The robot description cannot be found, read or used as an arm."""


class LogError(CdiaError):
    """The log cannot be read, or its signals cannot be used."""


class EffectError(CdiaError):
    """An effect, its parameters or its profile are not valid."""


class ModelError(CdiaError):
    """A saved model cannot be read or does not belong to this robot."""


def unknown_name(kind: str, given: str, valid: Iterable[str]) -> str:
    """Write a message for an unknown name.

    Args:
        kind: What the name stands for, such as ``joint``.
        given: The unknown name.
        valid: The valid names.

    Returns:
        One line with up to three similar names, or with all valid ones where none is similar.
    """
    names = list(valid)
    near = difflib.get_close_matches(given, names, n=3, cutoff=0.5)
    hint = f"did you mean {', '.join(near)}?" if near else f"known: {', '.join(names)}"
    return f"unknown {kind} '{given}'; {hint}"
