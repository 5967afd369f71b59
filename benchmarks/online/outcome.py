"""What came of a case, small enough to keep on a line: the figures of the results, not the run."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from math import isnan, nan
from typing import Any


@dataclass(frozen=True)
class JointOutcome:
    """What came of the faults of one joint; NaN for what never happened or does not apply.

    Attributes:
        joint: Name of the joint.
        detected: Whether a detection named it while a fault was there.
        delay: From when the faults' torque exceeded the threshold to the detection [s].
        since_begin: From when the fault began to the detection [s].
        plain_delay: The plain observer's delay from its own threshold [s].
        plain_since_begin: The plain observer's time from the fault's beginning [s].
        verdict: What was believed when it was asked, see `trial`.
        named: The sets of effects named then, the likeliest first.
        right: Whether the first of these is the true one.
        unique: Whether it is, and there are no others.
        holds: Whether the true one is among them.
        tracking: RMS distance from the reference over the last seconds, over that of a healthy arm [1].
        against_none: The same over that of the faulty arm without accommodation [1]; 0 if that one diverged.
        recovered: Share of the variance of the faults' torque that the correction made up for [1].
        learned: The same of what is believed at the end, as a formula of its own [1].
        region: Where the fault was found to be present; empty if everywhere.
    """

    joint: str
    detected: bool
    delay: float = nan
    since_begin: float = nan
    plain_delay: float = nan
    plain_since_begin: float = nan
    verdict: str = ""
    named: tuple[str, ...] = ()
    right: bool = False
    unique: bool = False
    holds: bool = False
    tracking: float = nan
    against_none: float = nan
    recovered: float = nan
    learned: float = nan
    region: str = ""


@dataclass(frozen=True)
class Outcome:
    """What came of a case.

    Attributes:
        id: Of the case.
        suite: Kind of case; `further` for single effects beyond the usual bank.
        robot: Name of the arm.
        conditions: Its sensors and drives.
        share: Size of each fault [1].
        effects: What was hidden.
        minutes: Length of the run [min].
        false_alarms: Detections on joints that had no fault yet.
        plain_false_alarms: Joints on which the plain observer alarmed before a fault was there.
        joints: Joint by joint, those with faults.
        drop: From when a fault vanished until it was no longer believed in [s].
        again: From its return until it was named [s].
        said: The events, in words.
    """

    id: str
    suite: str
    robot: str
    conditions: str
    share: float
    effects: tuple[str, ...]
    minutes: float
    false_alarms: int
    plain_false_alarms: int
    joints: tuple[JointOutcome, ...] = ()
    drop: float = nan
    again: float = nan
    said: tuple[str, ...] = ()

    def to_json(self) -> str:
        """Return the outcome as a line of JSON; NaN as null."""
        return json.dumps(_plain(asdict(self)), ensure_ascii=False)

    @classmethod
    def from_json(cls, line: str) -> Outcome:
        """Read back what `to_json` wrote."""
        given = json.loads(line)
        joints = tuple(JointOutcome(**_typed(j)) for j in given.pop("joints"))
        return cls(**_typed(given), joints=joints)


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {k: _plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(v) for v in value]
    return None if isinstance(value, float) and isnan(value) else value


def _typed(given: dict[str, Any]) -> dict[str, Any]:
    return {k: nan if v is None else tuple(v) if isinstance(v, list) else v for k, v in given.items()}
