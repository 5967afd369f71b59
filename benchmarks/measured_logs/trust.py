"""What an arm lacks, and what of it to trust: two logs identified apart, and how far their answers agree."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.measured_logs.errors import Bench
from cdia_pin import Dynamics, IdentificationSettings, identify
from cdia_pin.effects import ActuatorGain, Effect, LoadFriction, RotorInertia, TorqueOffset
from cdia_pin.effects.body import Body
from cdia_pin.regression.experiment import Experiment, rms

Array = NDArray[np.float64]

NOTABLE = 0.02  # share of a joint's torque from which a cause is worth a word
AGREED = 0.3  # of its size by which two answers may differ to be trusted

KINDS: dict[str, tuple[type[Effect], ...]] = {
    "links unlike the URDF's": (Body,),
    "rotor inertia": (RotorInertia,),
    "torque offset": (TorqueOffset,),
    "friction that grows with the load": (LoadFriction,),
    "a drive of another gain": (ActuatorGain,),
}
FRICTION = "friction of the joint"  # everything else


@dataclass(frozen=True)
class Cause:
    """What one kind of physics does in one joint.

    Attributes:
        kind: The kind of physics.
        joint: Name of the joint.
        size: Its RMS torque over that of the joint [1], mean of the two answers.
        apart: RMS difference of the two answers over their mean size [1].
    """

    kind: str
    joint: str
    size: float
    apart: float

    @property
    def trusted(self) -> bool:
        """Whether both logs say about the same."""
        return self.apart <= AGREED


def causes(bench: Bench) -> list[Cause]:
    """Identify both logs of a case apart, and compare what the answers say on the motion of the second.

    Args:
        bench: The case.
    """
    settings = IdentificationSettings(conditioning=bench.conditioning)
    robot = bench.case.robot
    models = [
        identify(Dynamics(robot), log, settings=settings).model
        for log in (bench.case.fitted, bench.case.unseen)
    ]
    seen, used = bench.unseen, bench.unseen.informative
    whole = rms(seen.measured, used)
    torques = [_by_kind(model, seen) for model in models]
    out = []
    for kind in (FRICTION, *KINDS):
        one, two = (t[kind] for t in torques)
        size, apart = (rms(one, used) + rms(two, used)) / 2, rms(one - two, used)
        for j, joint in enumerate(robot.joints):
            if size[j] >= NOTABLE * whole[j]:
                out.append(Cause(kind, joint, float(size[j] / whole[j]), float(apart[j] / size[j])))
    return out


def sentences(arm: str, found: Sequence[Cause], names: dict[str, str]) -> list[str]:
    """Return in words what an arm lacks: what both logs say, then what only one does.

    Args:
        arm: Name of the arm.
        found: Its causes.
        names: Short names of its joints.
    """
    out = []
    for trusted, head in (
        (True, f"Both logs of the {arm} say that its URDF lacks"),
        (False, "Not to be trusted:"),
    ):
        parts = []
        for kind in dict.fromkeys(c.kind for c in found):
            some = [c for c in found if c.kind == kind and c.trusted is trusted]
            if some:
                joints = ", ".join(f"{names[c.joint]} {100 * c.size:.0f} %" for c in some)
                ends = dict.fromkeys(f"{100 * end([c.apart for c in some]):.0f}" for end in (min, max))
                parts.append(f"{kind} ({joints} of the torque; the two differ by {'–'.join(ends)} % of it)")
        if parts:
            out.append(f"{head} {'; '.join(parts)}.")
    return out


def _by_kind(model: Dynamics, experiment: Experiment) -> dict[str, Array]:
    """Return the torque of each kind of physics along an experiment's motion [N·m or N], shape (K, n) each."""
    (segment,) = experiment.segments
    x = segment.state.with_effort(model.torques(segment.state).actuator)
    out = {kind: np.zeros_like(x.q) for kind in (FRICTION, *KINDS)}
    for term in model.terms:
        kind = next((k for k, types in KINDS.items() if isinstance(term.effect, types)), FRICTION)
        out[kind] += term.torque(x)
    return {kind: segment.motion.compared(torque) for kind, torque in out.items()}
