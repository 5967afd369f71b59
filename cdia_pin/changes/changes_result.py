"""What changed between logs: effects with their differences, and the largest changes that would not be seen."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from cdia_pin import schemas
from cdia_pin.changes.changes_documents import ChangeJson, ChangesJson, ChangesRecord
from cdia_pin.changes.confidence import Confidence
from cdia_pin.changes.overlap import NotCompared
from cdia_pin.changes.phenomenon import Phenomenon
from cdia_pin.changes.run_to_run import UsualFriction
from cdia_pin.changes.uncertain import Uncertain
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Term
from cdia_pin.identifiability.confusion import Confusion
from cdia_pin.phrases import clipped, some
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

# Size before over the difference [1], below which it is too uncertain to tell a growth: a fit of friction that was not
# there gives half a percent of what came.
LEAST_BEFORE = 0.05  # [1]


class ChangesVerdict(StrEnum):
    """Whether anything differs between the logs."""

    CHANGED = "changed"
    UNCHANGED = "unchanged"
    NOT_COMPARABLE = "not-comparable"


@dataclass(frozen=True, repr=False)
class Change:
    """One effect by which the logs differ.

    Attributes:
        term: The effect; its parameters are the differences, after minus before, with 95 % intervals.
        before: The parameters before, for friction, shape (p,); None where they have no meaning of their own.
        torque_rms: RMS torque of the change in the logs that have it, mostly those after [N·m or N], shape (n,).
        evidence: Log-likelihood that is lost without the change [1].
        confusions: Other changes that would explain nearly as much.
        confidence: How far the name can be trusted.
    """

    term: Term
    before: tuple[float, ...] | None
    torque_rms: Array
    evidence: float
    confusions: tuple[Confusion, ...] = ()
    confidence: Confidence = Confidence.ESTABLISHED

    def __repr__(self) -> str:
        torque = f"torque up to {np.max(self.torque_rms):.3g}"
        return f"Change({clipped(self.term.label, 60)}; {torque}, evidence {self.evidence:.3g})"

    @property
    def growth(self) -> float | None:
        """Difference over the size before [1], of an effect with one parameter that was clearly present before."""
        if self.before is None or len(self.before) != 1:
            return None
        (difference,), (before,) = self.term.theta, self.before
        return difference / before if before > LEAST_BEFORE * abs(difference) else None

    def to_dict(self, robot: RobotModel) -> ChangeJson:
        """Return the change for JSON.

        Args:
            robot: The arm, for the names and units of its joints.
        """
        names = [p.name for p in self.term.effect.parameters]
        out: ChangeJson = {
            "effect": self.term.effect.name,
            "joints": list(self.term.effect.joints(robot)),
            "difference": self.term.parameters_to_dict(robot),
            "before": None if self.before is None else dict(zip(names, self.before, strict=True)),
            "growth": self.growth,
            "torque_rms": robot.by_joint(self.torque_rms),
            "evidence": self.evidence,
            "confidence": str(self.confidence),
            "confusable_with": [c.to_dict(robot) for c in self.confusions],
        }
        described = self.term.effect.to_dict()
        if "shape" in described:
            out["shape"] = described["shape"]
        return out


@dataclass(frozen=True, repr=False)
class Bound:
    """The largest change of one effect with one parameter that these logs would not show.

    Attributes:
        term: The effect; its parameter is the largest that is too uncertain to be named, or not visible.
        torque: RMS torque of such a change in the logs after [N·m or N].
    """

    term: Term
    torque: float

    def __repr__(self) -> str:
        return f"Bound({clipped(self.term.label, 60)}, torque {self.torque:.3g})"


@dataclass(frozen=True, repr=False)
class Changes:
    """The outcome of `what_changed`.

    Attributes:
        model: The model with which both sides were compared.
        before: Names of the logs before.
        after: Names of the logs after.
        changes: Effects by which the logs differ, first what explains most; empty if nothing changed.
        bounds: For each joint by name, the largest change of one effect that would not be found.
        findings: What several changes mean together.
        rms_before: RMS residual of the model in the logs before, where both sides are compared [N·m or N], shape (n,);
            NaN for joints that are not compared.
        rms_after: The same in the logs after.
        record: Logs, hashes and settings.
        torque_rms: RMS measured torque where both sides are compared [N·m or N], shape (n,).
        uncertain: What explains a part of what differs and is too uncertain to be named, the most certain first.
        usual: Differences of friction that are no larger than what an unchanged arm shows from run to run.
        not_compared: Why nothing is known about a joint, by its name.
        spread: Root mean square certainty of effects that are not there, at least 1; where the motions differ it is
            larger, and a change must be more certain by this factor [1].
        same_motion: Whether a log after drives the motion of one before.
    """

    model: Dynamics
    before: tuple[str, ...]
    after: tuple[str, ...]
    changes: tuple[Change, ...]
    bounds: dict[str, Bound]
    findings: tuple[Phenomenon, ...]
    rms_before: Array
    rms_after: Array
    record: ChangesRecord
    torque_rms: Array
    usual: tuple[UsualFriction, ...] = ()
    uncertain: tuple[Uncertain, ...] = ()
    not_compared: Mapping[str, NotCompared] = field(default_factory=dict)
    spread: float = 1.0
    same_motion: bool = False

    def __repr__(self) -> str:
        changed = some([clipped(c.term.label, 45) for c in self.changes], 2)
        sides = " to ".join(
            some([clipped(name, 20) for name in side], 1) for side in (self.before, self.after)
        )
        return f"Changes({self.verdict}{': ' if changed else ''}{changed}; from {sides})"

    @property
    def verdict(self) -> ChangesVerdict:
        """Whether anything differs, as far as the logs tell."""
        if len(self.not_compared) == self.model.robot.n:
            return ChangesVerdict.NOT_COMPARABLE
        return ChangesVerdict.CHANGED if self.changes else ChangesVerdict.UNCHANGED

    def share_of(self, joint: str) -> float:
        """Return the bound of a joint over the joint's RMS torque [1].

        Args:
            joint: A joint with a bound.
        """
        return self.bounds[joint].torque / float(self.torque_rms[self.model.robot.joint_index(joint)])

    def _compared(self, values: Mapping[str, float]) -> dict[str, float]:
        return {joint: value for joint, value in values.items() if joint not in self.not_compared}

    def to_dict(self) -> ChangesJson:
        """Return the JSON of schema ``cdia-changes/1``."""
        robot = self.model.robot
        return {
            "schema": schemas.CHANGES,
            "robot": robot.name,
            "joints": list(robot.joints),
            "before": list(self.before),
            "after": list(self.after),
            "verdict": str(self.verdict),
            "changes": [c.to_dict(robot) for c in self.changes],
            "bounds": {
                joint: {
                    "effect": b.term.effect.name,
                    "parameters": b.term.parameters_to_dict(robot),
                    "torque_rms": b.torque,
                    "share": self.share_of(joint),
                }
                for joint, b in self.bounds.items()
            },
            "not_compared": {j: str(why) for j, why in self.not_compared.items()},
            "uncertain": [u.to_dict(robot) for u in self.uncertain],
            "usual_friction": [u.to_dict() for u in self.usual],
            "spread": self.spread,
            "findings": [f.to_dict() for f in self.findings],
            "rms": {
                "before": self._compared(robot.by_joint(self.rms_before)),
                "after": self._compared(robot.by_joint(self.rms_after)),
            },
            "record": self.record,
        }
