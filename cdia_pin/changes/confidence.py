"""How far the name of an effect can be trusted."""

from __future__ import annotations

from enum import StrEnum


class Confidence(StrEnum):
    """How far the name of an effect can be trusted."""

    ESTABLISHED = "established"  # it survives every repeat of the decision
    LIKELY = "likely"  # it survives most
    DESCRIPTIVE = "descriptive"  # it lowers the error, and may be something else
