"""The result of a discovery: steps that each lower the error, a verdict, and a model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdia_pin import schemas
from cdia_pin.changes.confidence import Confidence
from cdia_pin.changes.phenomenon import Phenomenon
from cdia_pin.discovery.capability import Capability
from cdia_pin.discovery.discovery_documents import DiscoveryJson, DiscoveryRecord, FoundEffectJson
from cdia_pin.discovery.groups import group_of
from cdia_pin.discovery.verdict import DiscoveryVerdict
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Term
from cdia_pin.identifiability.confusion import Confusion
from cdia_pin.phrases import clipped, some
from cdia_pin.regression.shares import mean_share
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]


@dataclass(frozen=True, repr=False)
class Step:
    """One effect added.

    Attributes:
        term: The effect with its parameters and intervals in the final model; None for the model as given.
        rms: RMS residual of each joint when all steps up to this one are fitted together [N·m or N], shape (n,).
        heldout_rms: Held-out RMS residual of each joint [N·m or N], shape (n,).
        confusions: Other explanations of what this effect explains.
        change_of_model: Whether the model as given has the effect too; the parameters are differences then.
        confidence: How far the name can be trusted.
    """

    term: Term | None
    rms: Array
    heldout_rms: Array
    confusions: tuple[Confusion, ...] = ()
    change_of_model: bool = False
    confidence: Confidence = Confidence.ESTABLISHED

    def __repr__(self) -> str:
        what = clipped(self.term.label, 60) if self.term else "model as given"
        return f"Step({what}; held-out RMS {_range(self.heldout_rms)})"


@dataclass(frozen=True, repr=False)
class Ranked:
    """What one candidate would explain alone.

    Attributes:
        term: The effect with parameters and intervals, fitted together with the model as given.
        heldout_before: Held-out RMS residual of each joint without the effect [N·m or N], shape (n,).
        heldout_after: Held-out RMS residual of each joint with the effect [N·m or N], shape (n,).
        confusions: Other effects that would explain about as much.
    """

    term: Term
    heldout_before: Array
    heldout_after: Array
    confusions: tuple[Confusion, ...]

    def __repr__(self) -> str:
        errors = f"{_range(self.heldout_before)} → {_range(self.heldout_after)}"
        return f"Ranked({clipped(self.term.label, 60)}; held-out RMS {errors})"


@dataclass(frozen=True, repr=False)
class Discovery:
    """The outcome of `discover`.

    Attributes:
        model: The improved model.
        verdict: ``nothing-missing``, ``explained``, ``explained-in-practice`` or ``unexplained``.
        trace: The model as given, then every effect that was added, in the order of what it explains.
        noise_floor: RMS residual that no smooth function of the motion explains [N·m or N], shape (n,).
        structure_left: Names of the joints whose residual is not noise.
        torque_rms: RMS of the measured torque [N·m or N], shape (n,).
        heldout_torque_rms: That of the data that was not fitted: of the held-out logs if there are any, shape (n,).
        compared_share: Share of the samples on which a joint is judged [1], shape (n,): near rest it is not.
        ranking: What the best candidates would explain alone, the best first.
        record: Logs, hashes, settings and version, enough to run the discovery again.
        capability: What the improved model lets a user notice.
        findings: Phenomena: what several effects mean together, and patterns of the residual.
        held: Names of the joints at rest that a brake or friction holds, so that their torque does not count.
        resting: Names of the other joints that are near rest for most of every log. Static friction carries a part of
            their load, so that what only they show is not established, and their errors are in no mean.
    """

    model: Dynamics
    verdict: DiscoveryVerdict
    trace: tuple[Step, ...]
    noise_floor: Array
    structure_left: tuple[str, ...]
    torque_rms: Array
    heldout_torque_rms: Array
    compared_share: Array
    ranking: tuple[Ranked, ...]
    record: DiscoveryRecord
    capability: Capability
    findings: tuple[Phenomenon, ...] = ()
    held: tuple[str, ...] = ()
    resting: tuple[str, ...] = ()

    def __repr__(self) -> str:
        added = some([clipped(s.term.label, 45) for s in self.steps if s.term], 2)
        errors = (
            100 * mean_share(s.heldout_rms, self.heldout_torque_rms, self.counted)
            for s in (self.trace[0], self.trace[-1])
        )
        error = " → ".join(f"{e:.3g} %" for e in errors)
        return f"Discovery({self.verdict}{': ' if added else ''}{added}; held-out error {error})"

    @property
    def counted(self) -> NDArray[np.bool_]:
        """True for the joints of which a mean is taken, shape (n,): those that move, or all where none moves."""
        moving = np.array([j not in (*self.resting, *self.held) for j in self.model.robot.joints])
        return moving if moving.any() else ~moving

    @property
    def steps(self) -> tuple[Step, ...]:
        """The effects that were added, the strongest first."""
        return self.trace[1:]

    def to_dict(self) -> DiscoveryJson:
        """Return the JSON of schema ``cdia-discovery/1``."""
        robot = self.model.robot
        return {
            "schema": schemas.DISCOVERY,
            "robot": robot.name,
            "joints": list(robot.joints),
            "verdict": str(self.verdict),
            "effects": [
                {
                    **_entry(s.term, s.confusions, robot),
                    "confidence": str(s.confidence),
                    "group": group_of(s.term.effect),
                    "change_of_model": s.change_of_model,
                }
                for s in self.steps
                if s.term is not None
            ],
            "trace": [
                {
                    "added": step.term.label if step.term else None,
                    "rms": robot.by_joint(step.rms),
                    "heldout_rms": robot.by_joint(step.heldout_rms),
                }
                for step in self.trace
            ],
            "noise_floor": robot.by_joint(self.noise_floor),
            "torque_rms": robot.by_joint(self.torque_rms),
            "heldout_torque_rms": robot.by_joint(self.heldout_torque_rms),
            "compared_share": robot.by_joint(self.compared_share),
            "structure_left": list(self.structure_left),
            "held": list(self.held),
            "resting": list(self.resting),
            "ranking": [
                {
                    **_entry(r.term, r.confusions, robot),
                    "heldout_rms": {
                        "before": robot.by_joint(r.heldout_before),
                        "after": robot.by_joint(r.heldout_after),
                    },
                }
                for r in self.ranking
            ],
            "capability": self.capability.to_dict(robot),
            "findings": [f.to_dict() for f in self.findings],
            "record": self.record,
        }


def _entry(term: Term, confusions: tuple[Confusion, ...], robot: RobotModel) -> FoundEffectJson:
    entry: FoundEffectJson = {
        "effect": term.effect.name,
        "joints": list(term.effect.joints(robot)),
        "parameters": term.parameters_to_dict(robot),
        "confusable_with": [c.to_dict(robot) for c in confusions],
    }
    described = term.effect.to_dict()
    if "shape" in described:
        entry["shape"] = described["shape"]
    if "varies" in described:
        entry["varies"] = described["varies"]
    return entry


def _range(values: Array) -> str:
    """Return the smallest and the largest of some numbers."""
    return f"{np.min(values):.3g} to {np.max(values):.3g}"
