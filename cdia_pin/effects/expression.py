"""An effect written as one line of text, parsed to a safe subset of arithmetic and never evaluated as code."""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects.effect import Effect, JointEffect, Parameter
from cdia_pin.effects.state import JointState
from cdia_pin.errors import EffectError
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]
Values = Mapping[str, Any]

SIGNALS = ("q", "dq", "ddq", "tau", "t")
CONSTANTS = {"pi": np.pi, "e": np.e}
FUNCTIONS: dict[str, Callable[..., Any]] = {
    "sin": np.sin, "cos": np.cos, "tan": np.tan, "tanh": np.tanh, "atan": np.arctan, "exp": np.exp,
    "log": np.log, "sqrt": np.sqrt, "abs": np.abs, "minimum": np.minimum, "maximum": np.maximum,
}  # fmt: skip
OPERATORS: dict[type, Callable[..., Any]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
    ast.Pow: operator.pow, ast.USub: operator.neg, ast.UAdd: operator.pos,
}  # fmt: skip
LONGEST = 300  # characters


@dataclass(frozen=True)
class Expression(JointEffect):
    """A user's own effect, such as ``sin(3*q)*dq`` or ``a*dq**3 + b*sin(q)``.

    Known names are q, dq, ddq, tau, t of the joint, sign(dq) smoothed at rest, pi, e and the functions of
    `FUNCTIONS`. Every other name is a parameter, in which the expression must be linear; without one, the whole
    expression is scaled by ``coefficient``.

    Attributes:
        joint: Name of the joint; None stands for every joint in turn, as a candidate of a search.
        text: The expression, torque per unit of the parameters.
    """

    joint: str | None = None  # type: ignore[assignment]
    text: str = "q"

    name: ClassVar[str] = "expression"
    equation: ClassVar[str] = "your own: Σ θᵢ gᵢ(q, dq, ddq, tau, t)"

    def __post_init__(self) -> None:
        tree = _parse(self.text)
        names = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
        known = {*SIGNALS, *CONSTANTS, *FUNCTIONS, "sign"}
        object.__setattr__(self, "_tree", tree)
        object.__setattr__(self, "_free", tuple(sorted(names - known)))
        self._check_linear()

    @property
    def of_torque(self) -> bool:  # type: ignore[override]
        """Whether the expression names the torque."""
        return any(isinstance(n, ast.Name) and n.id == "tau" for n in ast.walk(self._tree))  # type: ignore[attr-defined]

    @property
    def label(self) -> str:
        """The text, with the joint."""
        return self.text + (f"@{self.joint}" if self.joint else "")

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:  # type: ignore[override]
        """One parameter per free name, or the coefficient of the whole."""
        names: tuple[str, ...] = self._free or ("coefficient",)  # type: ignore[attr-defined]
        return tuple(Parameter(n, "{effort}/expression") for n in names)

    def columns(self, x: JointState) -> Sequence[Array]:
        """Return the expression with each parameter set to one and the others to zero."""
        signals = {"q": x.q, "dq": x.v, "ddq": x.a, "tau": x.effort, "t": x.time, "sgn dq": x.sign}
        free: tuple[str, ...] = self._free  # type: ignore[attr-defined]
        if not free:
            return [self._evaluate(signals)]
        rest = self._evaluate({**signals, **dict.fromkeys(free, 0.0)})
        return [self._evaluate({**signals, **dict.fromkeys(free, 0.0), name: 1.0}) - rest for name in free]

    def expand(self, robot: RobotModel) -> Iterator[Effect]:
        """Yield the effect on its joint, or on each joint of the robot."""
        for joint in (self.joint,) if self.joint else robot.joints:
            yield replace(self, joint=joint)

    def _evaluate(self, values: Values) -> Array:
        with np.errstate(all="ignore"):
            out = np.broadcast_to(_value(self._tree.body, values), np.shape(values["q"]))  # type: ignore[attr-defined]
        if not np.isfinite(out).all():
            raise EffectError(f"expression '{self.text}' is not finite on this motion (log, sqrt or division?)")
        return np.asarray(out, float)

    def _check_linear(self) -> None:
        free: tuple[str, ...] = self._free  # type: ignore[attr-defined]
        if not free:
            return
        rng = np.random.default_rng(0)
        probe = {s: rng.uniform(0.3, 0.9, 5) for s in (*SIGNALS, "sgn dq")}
        with np.errstate(all="ignore"):
            at = lambda k: np.asarray(_value(self._tree.body, {**probe, **dict(zip(free, k, strict=True))}))  # type: ignore[attr-defined]  # noqa: E731
            zero, k = at(np.zeros(len(free))), rng.uniform(0.5, 1.5, len(free))
            linear = np.allclose(at(2 * k), 2 * at(k), rtol=1e-9) and np.allclose(zero, 0.0)
        if not linear:
            raise EffectError(
                f"expression '{self.text}' is not linear in {', '.join(free)}; known names are "
                f"{', '.join((*SIGNALS, 'sign', *CONSTANTS, *FUNCTIONS))}, every other name is a parameter"
            )


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


def _parse(text: str) -> ast.Expression:
    if not text.strip() or len(text) > LONGEST:
        raise EffectError(f"an expression has 1 to {LONGEST} characters, given {len(text)}")
    try:
        tree = ast.parse(text.strip(), mode="eval")
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise EffectError(f"expression '{text}' cannot be read: {error}") from None
    for node in ast.walk(tree):
        _check(node, text)
    return tree


def _check(node: ast.AST, text: str) -> None:
    allowed = (ast.Expression, ast.BinOp, ast.UnaryOp, ast.Name, ast.Load, ast.Constant, ast.Call, *OPERATORS)
    if not isinstance(node, allowed):
        raise EffectError(f"expression '{text}': {type(node).__name__} is not arithmetic")
    if isinstance(node, ast.Constant) and (isinstance(node.value, bool) or not isinstance(node.value, int | float)):
        raise EffectError(f"expression '{text}': {node.value!r} is not a number")
    if isinstance(node, ast.Call):
        known = (*FUNCTIONS, "sign")
        if not isinstance(node.func, ast.Name) or node.func.id not in known or node.keywords:
            raise EffectError(f"expression '{text}': the functions are {', '.join(known)}")
        if node.func.id == "sign" and ast.unparse(node.args) != "dq":  # type: ignore[arg-type]
            raise EffectError(f"expression '{text}': only sign(dq) is known, smoothed at rest")
        if len(node.args) != (2 if node.func.id in {"minimum", "maximum"} else 1):
            raise EffectError(f"expression '{text}': {node.func.id} takes another number of arguments")


def _value(node: ast.expr, values: Values) -> Any:
    match node:
        case ast.Constant():
            return float(node.value)  # type: ignore[arg-type]
        case ast.Name():
            return values[node.id] if node.id in values else CONSTANTS[node.id]
        case ast.UnaryOp():
            return OPERATORS[type(node.op)](_value(node.operand, values))
        case ast.BinOp():
            return OPERATORS[type(node.op)](_value(node.left, values), _value(node.right, values))
        case ast.Call(func=ast.Name(id="sign")):
            return values["sgn dq"]
        case ast.Call(func=ast.Name(id=name)):
            return FUNCTIONS[name](*(_value(a, values) for a in node.args))
    raise AssertionError(node)  # _check let nothing else through
