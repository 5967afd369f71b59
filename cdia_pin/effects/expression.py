"""An effect written as one line of text, such as ``sin(3*q)*dq``."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects import arithmetic
from cdia_pin.effects.arithmetic import CONSTANTS, FUNCTIONS, KNOWN, SIGN, SIGNALS, Values
from cdia_pin.effects.effect import Effect
from cdia_pin.effects.joint_effect import JointEffect
from cdia_pin.effects.parameter import Parameter
from cdia_pin.effects.plausibility import Plausibility
from cdia_pin.effects.state import JointState
from cdia_pin.effects.traits import Signal, Traits
from cdia_pin.errors import EffectError
from cdia_pin.robot.model import RobotModel

__all__ = ["CONSTANTS", "FUNCTIONS", "SIGNALS", "Expression", "from_expression"]

Array = NDArray[np.float64]

SIGNAL_OF = {
    "q": Signal.POSITION,
    "dq": Signal.VELOCITY,
    "ddq": Signal.ACCELERATION,
    "tau": Signal.TORQUE,
    "t": Signal.TIME,
    SIGN: Signal.DIRECTION,
}  # by the name in the text


@dataclass(frozen=True)
class Expression(JointEffect):
    """A user's own effect, such as ``sin(3*q)*dq`` or ``a*dq**3 + b*sin(q)``.

    Known names are q, dq, ddq, tau, t of the joint, sign(dq) smoothed at rest, pi, e and the functions of
    `FUNCTIONS`. Every other name is a parameter, in which the expression must be linear; without
    one, the whole expression is scaled by ``coefficient``. In ddq it must be affine: accelerations are solved
    for.

    Attributes:
        joint: Name of the joint; None stands for every joint in turn, as a candidate of a search.
        text: The expression, torque per unit of the parameters.
    """

    joint: str | None = None  # type: ignore[assignment]
    text: str = "q"

    name: ClassVar[str] = "expression"
    plausibility: ClassVar[Plausibility] = Plausibility(searched=False)
    equation: ClassVar[str] = "your own: Σ θᵢ gᵢ(q, dq, ddq, tau, t)"

    def __post_init__(self) -> None:
        _ = self._tree  # raises if the text is not arithmetic
        object.__setattr__(self, "text", self.text.strip())
        if self.text in self._free:
            raise EffectError(f"expression '{self.text}' is a bare parameter; known names are {KNOWN}")
        _check_linear(self)

    @cached_property
    def traits(self) -> Traits:
        """Depends on the signals that the text names."""
        return Traits({signal for name, signal in SIGNAL_OF.items() if name in self._names})

    @property
    def label(self) -> str:
        """The text, with the joint."""
        return self.text + (f"@{self.joint}" if self.joint else "")

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:  # type: ignore[override]
        """One parameter per free name, or the coefficient of the whole."""
        return tuple(Parameter(n, "{effort} per unit") for n in self._free or ("coefficient",))

    def check(self, robot: RobotModel) -> None:
        """Make sure that the expression names a joint of the robot.

        Args:
            robot: The arm, n joints.
        """
        if self.joint is None:
            raise EffectError(f"expression '{self.text}' needs a joint: write {self.text}@JOINT")
        super().check(robot)

    def columns(self, x: JointState) -> Sequence[Array]:
        """Return the expression with each parameter set to one and the others to zero.

        Args:
            x: Signals of the joint, N samples.
        """
        signals = {"q": x.q, "dq": x.v, "ddq": x.a, "tau": x.effort, "t": x.time, SIGN: x.sign}
        if not self._free:
            return [self._evaluate(signals)]
        zero = dict.fromkeys(self._free, np.float64(0.0))
        return [self._evaluate({**signals, **zero, name: np.float64(1.0)}) for name in self._free]

    def expand(self, robot: RobotModel) -> Iterator[Effect]:
        """Yield the effect on its joint, or on each joint of the robot.

        Args:
            robot: The arm, n joints.
        """
        for joint in (self.joint,) if self.joint else robot.joints:
            yield replace(self, joint=joint)

    @cached_property
    def _tree(self) -> ast.expr:
        return arithmetic.parse(self.text)

    @cached_property
    def _names(self) -> frozenset[str]:
        return frozenset(arithmetic.names(self._tree))

    @cached_property
    def _free(self) -> tuple[str, ...]:
        return tuple(sorted(self._names - {*SIGNALS, SIGN, *CONSTANTS}))

    def _evaluate(self, values: Values) -> Array:
        out = np.broadcast_to(arithmetic.value(self._tree, values), np.shape(values["q"]))
        if not np.isfinite(out).all():
            raise EffectError(
                f"expression '{self.text}' is not finite on this motion (division by 0, log, sqrt, power?)"
            )
        return np.asarray(out, float)


def from_expression(text: str, joint: str | None = None) -> Expression:
    """Make an effect from one line of arithmetic.

    Args:
        text: Such as ``sin(3*q)*dq``, the torque per unit of the coefficient, or ``a*dq**3 + b*q``.
        joint: Joint it acts on; None to let a search ask for it on every joint.

    Returns:
        An effect that works in every role.

    Raises:
        EffectError: If the text is not arithmetic of the known names, or not linear in its parameters.
    """
    return Expression(joint=joint, text=text)


def _check_linear(expression: Expression) -> None:
    """Try the expression at drawn states: is it linear in its parameters and affine in ddq where finite?"""
    text, tree, free = expression.text, expression._tree, expression._free
    rng = np.random.default_rng(0)
    draws = np.concatenate([rng.uniform(0.3, 0.9, 16), rng.uniform(1.5, 3.0, 8), rng.uniform(-2.0, 2.0, 24)])
    probe = {s: rng.permutation(draws) for s in (*SIGNALS, SIGN)}

    def at(theta: Array, ddq: float | None = None) -> Array:
        values = {**probe, **dict(zip(free, theta, strict=True))}
        if ddq is not None:
            values["ddq"] = np.full(len(draws), ddq)
        return np.broadcast_to(arithmetic.value(tree, values), len(draws))

    def vanishes(remainder: Array, size: Array) -> bool:
        finite = np.isfinite(remainder) & np.isfinite(size)
        return bool((np.abs(remainder) <= 1e-9 * (1e-3 + np.abs(size)))[finite].all())

    if not np.isfinite(at(rng.normal(size=len(free)))).any():
        raise EffectError(f"expression '{text}' is not finite at any state that was tried")
    with np.errstate(all="ignore"):
        for _ in range(4 if free else 0):
            one, two = rng.normal(size=(2, len(free)))
            first, second, size = at(one), at(two), np.abs(at(one)) + np.abs(at(two))
            if not (vanishes(at(one + two) - first - second, size) and vanishes(at(-one) + first, size)):
                raise EffectError(
                    f"expression '{text}' is not linear in {', '.join(free)}; known names are {KNOWN}, every "
                    "other name is a parameter"
                )
        if Signal.ACCELERATION in expression.traits.depends_on:
            one = rng.normal(size=len(free))
            bent = at(one, 2.0) + at(one, -3.0) - at(one, 1.0) - at(one, -2.0)  # zero for an affine ddq
            if not vanishes(bent, np.abs(at(one, 2.0)) + np.abs(at(one, -3.0))):
                raise EffectError(f"expression '{text}' must be linear in ddq, for a motion to be solved for")
