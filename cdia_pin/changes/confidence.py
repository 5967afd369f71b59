"""How far the name of an effect can be trusted."""

from __future__ import annotations

from enum import StrEnum


class Confidence(StrEnum):
    """How far the name of an effect can be trusted."""

    # of what a model lacks: it survives every repeat of the decision; of a change: it is twice as certain as it must be
    ESTABLISHED = "established"
    LIKELY = "likely"  # it survives most repeats, or is as certain as it must be
    DESCRIPTIVE = "descriptive"  # it lowers the error, and may be something else
