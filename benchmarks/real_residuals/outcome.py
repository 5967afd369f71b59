"""What came of a case, small enough to keep on a line."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import nan
from typing import ClassVar

from benchmarks.outcomes import JsonLine
from benchmarks.real_residuals.answers import Named


@dataclass(frozen=True)
class Outcome(JsonLine):
    """What came of a case.

    Attributes:
        id: Of the case.
        plain: Name of the same case on logs that are not varied.
        draw: Name of the draw, the same in each flow.
        arm: Name of the arm.
        effect: Name of the inserted effect, ``unchanged``, or ``known payload``.
        size: Of the inserted effect [%] of its joint's RMS torque.
        flow: Which question.
        variant: What was done to both logs.
        truth: Label of what differs; empty if nothing does.
        impossible: Why no effect of that size could be inserted; empty if it could.
        named: What the program named.
        verdict: In the program's word.
        errors: Relative error of each parameter that tells the size, where it was named [1].
        held: Whether the interval of each of them holds the truth.
        widths: Half the width of each interval over the true value [1].
        seconds: Processor time of the question [s].
        failure: What the program failed with; empty if it did not.
    """

    id: str
    plain: str
    draw: str
    arm: str
    effect: str
    size: int
    flow: str
    variant: str = ""
    truth: str = ""
    impossible: str = ""
    named: tuple[Named, ...] = ()
    verdict: str = ""
    errors: dict[str, float] = field(default_factory=dict)
    held: dict[str, bool] = field(default_factory=dict)
    widths: dict[str, float] = field(default_factory=dict)
    seconds: float = nan
    failure: str = ""

    @property
    def labels(self) -> frozenset[str]:
        """Names that the program gave."""
        return frozenset(n.label for n in self.named)

    @property
    def exact(self) -> bool:
        """Whether what differs is named, and nothing else; nothing at all where nothing does."""
        return not self.failure and self.labels == frozenset([self.truth] if self.truth else [])

    @property
    def among(self) -> bool:
        """Whether what differs is among the named."""
        return self.truth in self.labels

    @property
    def answer(self) -> str:
        """How right it is, in a word."""
        if self.failure:
            return "failed"
        if self.exact:
            return "exact"
        if not self.named:
            return "nothing"
        return "among" if self.among else "other"

    READ: ClassVar = {"named": lambda v: tuple(map(Named.from_dict, v))}
