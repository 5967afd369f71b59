"""What a check says: one inference, how serious it is, and what to do about it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from cdia_pin import schemas

Severity = Literal["ok", "info", "warning", "error"]


@dataclass(frozen=True)
class Finding:
    """One inference about a log.

    Attributes:
        topic: What it is about: ``reading``, ``rate``, ``gaps``, ``jitter``, ``duplicates``, ``frozen``,
            ``resolution``, ``limits``, ``saturation``, ``excitation``, ``velocity``, ``units``, ``sign``,
            ``joint_order``, ``effort_kind`` or ``lag``.
        severity: ``ok`` (looked at, fine), ``info`` (worth knowing, or it cannot be told), ``warning``
            (results suffer), ``error`` (results would be about the log, not about the robot).
        message: One sentence with the numbers.
        joint: The joint it concerns, None for the whole log.
        advice: What to do, naming the keyword or flag; empty where there is nothing to do.
        value: The numbers behind it, ready for JSON.
    """

    topic: str
    severity: Severity
    message: str
    joint: str | None = None
    advice: str = ""
    value: Mapping[str, Any] = field(default_factory=dict)

    def to_dict(self) -> dict[str, Any]:
        """Return the finding for JSON."""
        return {
            "topic": self.topic,
            "severity": self.severity,
            "joint": self.joint,
            "message": self.message,
            "advice": self.advice,
            "value": dict(self.value),
        }


@dataclass(frozen=True)
class LogCheck:
    """Everything that was inferred about a log.

    Attributes:
        source: Name of the log.
        robot: Name of the robot it was checked against.
        findings: The inferences, in the order of the checks.
        sha256: Hash of the log's file, empty for a log made in memory.
    """

    source: str
    robot: str
    findings: tuple[Finding, ...]
    sha256: str = ""

    @property
    def ok(self) -> bool:
        """True where nothing needs attention: no warning and no error."""
        return not self.problems

    @property
    def problems(self) -> tuple[Finding, ...]:
        """Warnings and errors, errors first."""
        found = [f for f in self.findings if f.severity in {"warning", "error"}]
        return tuple(sorted(found, key=lambda f: f.severity != "error"))

    def about(self, topic: str) -> tuple[Finding, ...]:
        """Findings of one topic."""
        return tuple(f for f in self.findings if f.topic == topic)

    def to_dict(self) -> dict[str, Any]:
        """Return the check for JSON, schema ``cdia-check/1``."""
        return {
            "schema": schemas.CHECK,
            "source": self.source,
            "sha256": self.sha256,
            "robot": self.robot,
            "ok": self.ok,
            "findings": [f.to_dict() for f in self.findings],
        }
