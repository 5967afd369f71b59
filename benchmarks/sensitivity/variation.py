"""Variations of settings: every number that decides, halved and doubled."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any

from cdia_pin.selection import DiscoverySettings

FACTORS = (0.5, 2.0)
LEFT_OUT = (
    "conditioning",
    "most_effects",
    "blocks",
    "criterion.margin",
    "criterion.least_share_of_change",
)  # the filter, the effort, a tie-break, and what only a comparison of logs asks for


@dataclass(frozen=True)
class Variation:
    """One setting times a factor.

    Attributes:
        path: Name of the setting, such as ``criterion.least_share``; empty for the settings as they are.
        factor: What it is multiplied by [1].
    """

    path: str = ""
    factor: float = 1.0

    @property
    def id(self) -> str:
        """Name that stays the same."""
        return f"{self.path} × {self.factor:g}" if self.path else "as it is"

    def settings(self) -> DiscoverySettings:
        """Return the settings of a discovery with this one changed."""
        return (
            _changed(DiscoverySettings(), self.path.split("."), self.factor)
            if self.path
            else DiscoverySettings()
        )


@dataclass(frozen=True)
class Decision:
    """A number that decides.

    Attributes:
        path: Its name.
        value: Its value.
        reason: What its docstring says.
    """

    path: str
    value: float
    reason: str


def decisions() -> list[Decision]:
    """Return every number that decides in a discovery."""
    return list(_decisions(DiscoverySettings(), ""))


def variations() -> list[Variation]:
    """Return the settings as they are, then each number halved and doubled."""
    return [Variation(), *(Variation(d.path, factor) for d in decisions() for factor in FACTORS)]


def _decisions(settings: Any, prefix: str) -> Iterator[Decision]:
    reasons = _reasons(type(settings))
    for field in fields(settings):
        value, path = getattr(settings, field.name), prefix + field.name
        if path in LEFT_OUT:
            continue
        if is_dataclass(value):
            yield from _decisions(value, f"{path}.")
        elif isinstance(value, int | float) and not isinstance(value, bool):
            yield Decision(path, value, reasons[field.name])


def _changed(settings: Any, path: list[str], factor: float) -> Any:
    name, *rest = path
    value = getattr(settings, name)
    if rest:
        return replace(settings, **{name: _changed(value, rest, factor)})
    return replace(settings, **{name: round(value * factor) if isinstance(value, int) else value * factor})


def _reasons(kind: type) -> dict[str, str]:
    """Return what the docstring of a settings class says of each attribute."""
    text = inspect.cleandoc(kind.__doc__ or "").partition("Attributes:")[2]
    parts = re.split(r"\n    (\w+): ", text)
    return dict(zip(parts[1::2], (" ".join(p.split()) for p in parts[2::2]), strict=True))
