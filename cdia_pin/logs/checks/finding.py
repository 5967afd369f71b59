"""Findings of a check: an inference, its severity, and advice."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TypedDict

from cdia_pin import schemas
from cdia_pin.phrases import shortened


class Severity(StrEnum):
    """How much a finding matters."""

    OK = "ok"  # checked, without a problem
    INFO = "info"  # worth knowing, or it cannot be determined
    WARNING = "warning"  # results suffer
    ERROR = "error"  # results would describe the log and not the robot


class Topic(StrEnum):
    """Property of a log that a finding is about."""

    READING = "reading"  # a note of the reader
    RATE = "rate"
    GAPS = "gaps"
    JITTER = "jitter"
    DUPLICATES = "duplicates"
    COPIED = "copied"  # a stretch of samples that an earlier one equals
    FROZEN = "frozen"
    WILD = "wild"  # single samples that no motion makes
    RESOLUTION = "resolution"
    LIMITS = "limits"
    SATURATION = "saturation"
    EXCITATION = "excitation"
    VELOCITY = "velocity"
    UNITS = "units"
    MOUNTING = "mounting"  # how the base stands
    SIGN = "sign"
    JOINT_ORDER = "joint_order"
    ROBOT = "robot"
    EFFORT_KIND = "effort_kind"
    TORQUE_SIDE = "torque_side"
    LAG = "lag"


class FindingRecord(TypedDict):
    """A finding in JSON; keys as the attributes of `Finding`."""

    topic: Topic
    severity: Severity
    joint: str | None
    message: str
    advice: str
    value: dict[str, object]


class CheckRecord(TypedDict):
    """A check in JSON, schema ``cdia-check/1``; keys as the attributes of `LogCheck`."""

    schema: str
    source: str
    sha256: str
    robot: str
    ok: bool
    findings: list[FindingRecord]


@dataclass(frozen=True, repr=False)
class Finding:
    """One inference about a log.

    Attributes:
        topic: Property of the log.
        severity: How much it matters.
        message: One sentence with the numbers.
        joint: The joint concerned; None for the whole log.
        advice: What to do, with the keyword or flag; empty if there is nothing to do.
        value: The numbers of the message, ready for JSON; their keys depend on the topic.
        misleads: Whether a search would be misled by what an error states. False for an error in a signal that a
            search does not use.
    """

    topic: Topic
    severity: Severity
    message: str
    joint: str | None = None
    advice: str = ""
    value: Mapping[str, object] = field(default_factory=dict)
    misleads: bool = True

    def __repr__(self) -> str:
        about = self.topic if self.joint is None else f"{self.topic} of {shortened(self.joint, 30)}"
        return f"Finding({self.severity}, {about}: {shortened(self.message, 90)})"

    def to_dict(self) -> FindingRecord:
        """Return the finding for JSON."""
        return {
            "topic": self.topic,
            "severity": self.severity,
            "joint": self.joint,
            "message": self.message,
            "advice": self.advice,
            "value": dict(self.value),
        }


@dataclass(frozen=True, repr=False)
class LogCheck:
    """All inferences about a log.

    Attributes:
        source: Name of the log.
        robot: Name of the robot.
        findings: The inferences, in the order of the checks.
        sha256: Hash of the log's file; empty for a log made in memory.
    """

    source: str
    robot: str
    findings: tuple[Finding, ...]
    sha256: str = ""

    def __repr__(self) -> str:
        counts = f"{len(self.findings)} findings, {len(self.problems)} of them warnings or errors"
        return f"LogCheck({shortened(self.source)} of robot {shortened(self.robot)}: {counts})"

    @property
    def ok(self) -> bool:
        """True without warnings and errors."""
        return not self.problems

    @property
    def problems(self) -> tuple[Finding, ...]:
        """Warnings and errors, errors first."""
        found = [f for f in self.findings if f.severity in {Severity.WARNING, Severity.ERROR}]
        return tuple(sorted(found, key=lambda f: f.severity is not Severity.ERROR))

    @property
    def obstacles(self) -> tuple[Finding, ...]:
        """Errors that would make a search describe the log and not the robot."""
        return tuple(f for f in self.findings if f.severity is Severity.ERROR and f.misleads)

    @property
    def mend(self) -> str:
        """One sentence: what stands in the way of a search, and what mends it; empty if nothing does."""
        if not self.obstacles:
            return ""
        said = "; ".join(
            f"{f.joint}: {f.message}" if f.joint and f.joint not in f.message else f.message
            for f in self.obstacles
        )
        advice = list(dict.fromkeys(f.advice for f in self.obstacles if f.advice))
        options = " ".join(a for a in advice if a.startswith("--"))
        steps = ([f"add {options}"] if options else []) + [a for a in advice if not a.startswith("--")]
        return f"{self.source}: {said}" + (f". To mend it, {'; '.join(steps)}" if steps else "")

    def about(self, topic: str) -> tuple[Finding, ...]:
        """Return the findings of one topic.

        Args:
            topic: The topic, or its name.

        Returns:
            The findings, in the order of the checks.
        """
        return tuple(f for f in self.findings if f.topic == topic)

    def to_dict(self) -> CheckRecord:
        """Return the check for JSON, schema ``cdia-check/1``."""
        return {
            "schema": schemas.CHECK,
            "source": self.source,
            "sha256": self.sha256,
            "robot": self.robot,
            "ok": self.ok,
            "findings": [f.to_dict() for f in self.findings],
        }
