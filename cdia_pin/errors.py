"""Errors of the package: one base class, one line a person can act on."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class CdiaError(Exception):
    """Base of every error that this package raises on purpose."""


class RobotError(CdiaError):
    """The robot description cannot be found, read or used as an arm."""


class LogError(CdiaError):
    """The log cannot be read, or holds signals that cannot be used."""


class EffectError(CdiaError):
    """An effect, its parameters or its profile are not what they must be."""


class ModelError(CdiaError):
    """A saved model cannot be read or does not belong to this robot."""


def unknown_name(kind: str, given: str, valid: Iterable[str]) -> str:
    """Say that a name is unknown, with the nearest valid ones first."""
    names = list(valid)
    near = difflib.get_close_matches(given, names, n=3, cutoff=0.5)
    hint = f"did you mean {', '.join(near)}?" if near else f"known: {', '.join(names)}"
    return f"unknown {kind} '{given}'; {hint}"
