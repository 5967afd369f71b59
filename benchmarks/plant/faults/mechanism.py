"""A fault as asked for, and the mechanism that makes it happen in MuJoCo."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import mujoco
import numpy as np
from numpy.typing import NDArray

from cdia_pin.errors import EffectError, unknown_name

if TYPE_CHECKING:
    from benchmarks.plant.arm import Arm

Array = NDArray[np.float64]
Value = float | tuple[float, ...] | str | None
Parameters = dict[str, Value]

# Parameters [N·m·s/rad or N·s/m, …] that are themselves about the slope of a torque over speed.
SLOPES = ("coefficient", "coefficient_positive", "coefficient_negative")


@dataclass(frozen=True, init=False)
class Fault:
    """An effect of known size, hidden in the plant.

        Fault("coulomb_friction", joint="elbow_joint", level=4.0)
        Fault("payload", mass=2.0, com=(0, 0, 0.05), after=4.0)

    Attributes:
        effect: Name of the mechanism, see `benchmarks.plant.MECHANISMS`.
        joint: Joint that it acts on; None where it acts on the whole arm.
        other: Second joint, where the mechanism has two.
        after: Time at which it begins [s of the log].
        ramp: Time it takes to grow to its full size [s].
        until: Time at which it vanishes at once [s of the log].
        parameters: Size and shape, SI units.
    """

    effect: str
    joint: str | None
    other: str | None
    after: float
    ramp: float
    until: float
    parameters: Mapping[str, Value]

    def __init__(
        self,
        effect: str,
        *,
        joint: str | None = None,
        other: str | None = None,
        after: float = -np.inf,
        ramp: float = 0.0,
        until: float = np.inf,
        **parameters: Any,
    ) -> None:
        plain = {k: _plain(v) for k, v in parameters.items()}
        for name, value in zip(
            ("effect", "joint", "other", "after", "ramp", "until", "parameters"),
            (effect, joint, other, after, ramp, until, plain),
            strict=True,
        ):
            object.__setattr__(self, name, value)

    @property
    def joints(self) -> tuple[str, ...]:
        """Joints named by the fault."""
        return tuple(j for j in (self.joint, self.other) if j is not None)

    def with_parameters(self, new: Mapping[str, Value]) -> Fault:
        """Return the fault with some parameters replaced."""
        return Fault(
            self.effect,
            joint=self.joint,
            other=self.other,
            after=self.after,
            ramp=self.ramp,
            until=self.until,
            **{**self.parameters, **new},
        )

    def share(self, t: float) -> float:
        """Return how much of the fault is present at a time [s], between 0 and 1."""
        if t < self.after or t >= self.until:
            return 0.0
        if self.ramp <= 0:
            return 1.0
        return min((t - self.after) / self.ramp, 1.0)

    def __str__(self) -> str:
        where = "@" + "+".join(self.joints) if self.joints else ""
        return f"{self.effect}{where}"


@dataclass
class Step:
    """One instant of the simulation, in the order of the arm's joints; mechanisms add to `force` and `loss`.

    Attributes:
        t: Time [s of the log].
        q: True positions [rad or m], shape (n,).
        v: True velocities [rad/s or m/s], shape (n,).
        command: Commanded torque, which is what gets recorded [N·m or N], shape (n,).
        delivered: Torque that reaches the joint [N·m or N], shape (n,).
        force: Further torque on the joints [N·m or N], shape (n,).
        loss: Dry friction level, MuJoCo's frictionloss [N·m or N], shape (n,).
    """

    t: float
    q: Array
    v: Array
    command: Array
    delivered: Array
    force: Array
    loss: Array

    @classmethod
    def at_rest(cls, q: Array) -> Step:
        """Return a step at positions q [rad or m], nothing moving."""
        zeros = [np.zeros_like(q) for _ in range(5)]
        return cls(0.0, q.copy(), *zeros)


class Mechanism:
    """How one fault happens: before the model is compiled, in its fields, and at every step.

    Attributes:
        defaults: Parameters and their values where the fault gives none.
        sizes: Parameters that scale the effect.
        places: Number of joints that the fault must name; None if it may name one.
        moving: Whether `act_moving` needs the bodies' present places.
    """

    name: ClassVar[str]
    defaults: ClassVar[Parameters] = {}
    sizes: ClassVar[tuple[str, ...]] = ()
    places: ClassVar[int | None] = 1
    moving: ClassVar[bool] = False

    def __init__(self, fault: Fault) -> None:
        for given in fault.parameters:
            if given not in self.defaults:
                raise EffectError(
                    f"plant, {fault.effect}: " + unknown_name("parameter", given, self.defaults)
                )
        if self.places is not None and len(fault.joints) != self.places:
            raise EffectError(
                f"plant, {fault.effect}: names {self.places} joint(s), given {len(fault.joints)}"
            )
        self.fault = fault
        self.p: dict[str, Any] = {**self.defaults, **fault.parameters}
        self.amount = 1.0  # share of the fault that is present
        self.j = -1
        self.other = -1
        self.dof = -1

    @property
    def damping(self) -> float:
        """Largest slope of the torque over speed [N·m·s/rad or N·s/m], which bounds the integration step."""
        return max((abs(self.p[k]) for k in SLOPES if isinstance(self.p.get(k), float)), default=0.0)

    def edit(self, spec: mujoco.MjSpec, arm: Arm) -> None:
        """Add bodies or tendons to the arm's description."""

    def attach(self, arm: Arm) -> None:
        """Find the joints in the compiled arm and note what is changed there."""
        self.arm = arm
        self.model = arm.model
        if self.fault.joint is not None:
            self.j = arm.joint_index(self.fault.joint)
            self.dof = int(arm.dofs[self.j])
        if self.fault.other is not None:
            self.other = arm.joint_index(self.fault.other)
        self.found()

    def found(self) -> None:
        """Note what the model holds before the fault."""

    def present(self, amount: float) -> None:
        """Make a share of the fault present, in the model's own fields where MuJoCo knows the effect."""
        self.amount = amount

    def act(self, x: Step) -> None:
        """Act at one step."""

    def act_moving(self, x: Step) -> None:
        """Act at one step, with the bodies where they are now."""


def _plain(value: Any) -> Value:
    if value is None or isinstance(value, str):
        return value
    return tuple(float(x) for x in value) if np.ndim(value) else float(value)
