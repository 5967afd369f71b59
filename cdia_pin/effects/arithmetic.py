"""A safe subset of arithmetic: parsed from text, checked node by node, and never evaluated as code.

Numbers, names, + − * / **, and a few functions; no attributes, subscripts, comparisons, strings or keywords.
All numbers are IEEE doubles, so that a tower of powers overflows to infinity at once.
"""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from cdia_pin.errors import EffectError
from cdia_pin.phrases import counted

Values = Mapping[str, Any]

SIGNALS = ("q", "dq", "ddq", "tau", "t")
SIGN = "sign(dq)"  # the one call that is a signal: smoothed at rest
CONSTANTS = {"pi": np.float64(np.pi), "e": np.float64(np.e)}
FUNCTIONS: dict[str, Callable[..., Any]] = {
    "sin": np.sin, "cos": np.cos, "tan": np.tan, "tanh": np.tanh, "atan": np.arctan, "exp": np.exp,
    "log": np.log, "sqrt": np.sqrt, "abs": np.abs, "minimum": np.minimum, "maximum": np.maximum,
}  # fmt: skip
OPERATORS: dict[type, Callable[..., Any]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
    ast.Pow: operator.pow, ast.USub: operator.neg, ast.UAdd: operator.pos,
}  # fmt: skip
KNOWN = ", ".join((*SIGNALS, SIGN, *CONSTANTS, *FUNCTIONS))
LONGEST = 300  # characters
DEEPEST = 100  # operations within each other


def parse(text: str) -> ast.expr:
    """Return the syntax tree of an expression.

    Args:
        text: Numbers, names, + − * / **, and the functions of `FUNCTIONS`.

    Raises:
        EffectError: If the text is too long, cannot be read, or is more than arithmetic.
    """
    if not isinstance(text, str) or not text.strip() or len(text) > LONGEST:
        size = len(text) if isinstance(text, str) else repr(text)
        raise EffectError(f"an expression has 1 to {LONGEST} characters, given {size}")
    if "#" in text:
        raise EffectError(f"expression '{text}' cannot hold a comment")
    try:
        tree = ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise EffectError(f"expression '{text}' cannot be read: it is no arithmetic") from None
    _check(tree, text, DEEPEST)
    return tree


def names(tree: ast.expr) -> set[str]:
    """Return the names whose values the expression needs; ``sign(dq)`` counts as one.

    Args:
        tree: From `parse`.
    """
    match tree:
        case ast.Name(id=name):
            return {name}
        case ast.UnaryOp(operand=inner):
            return names(inner)
        case ast.BinOp(left=left, right=right):
            return names(left) | names(right)
        case ast.Call(func=ast.Name(id="sign")):
            return {SIGN}
        case ast.Call(args=args):
            return set().union(*(names(a) for a in args))
    return set()


def value(tree: ast.expr, values: Values) -> Any:
    """Return the value of an expression, without warnings about what is not finite.

    Args:
        tree: From `parse`.
        values: Arrays or numbers by name, for all `names` but the constants.
    """
    with np.errstate(all="ignore"):
        return _value(tree, {**CONSTANTS, **values})


def _check(node: ast.expr, text: str, depth: int) -> None:  # noqa: PLR0912  (one case per kind of node)
    """Let through what `_value` can compute, nothing else."""
    if depth == 0:
        raise EffectError(f"expression '{text}' is nested more than {DEEPEST} deep")
    match node:
        case ast.Constant(value=bool() | complex()):
            raise EffectError(f"expression '{text}': {node.value!r} is not a real number")
        case ast.Constant(value=int() | float() as number):
            if not abs(number) < 1e300:
                raise EffectError(f"expression '{text}': a number is too large")
        case ast.Name(id=name):
            if name in FUNCTIONS or name == "sign":
                raise EffectError(f"expression '{text}': {name} needs an argument in brackets")
            if name.startswith("_"):
                raise EffectError(f"expression '{text}': a name begins with a letter, given {name}")
        case ast.UnaryOp(op=ast.USub() | ast.UAdd(), operand=inner):
            _check(inner, text, depth - 1)
        case ast.BinOp(op=op, left=left, right=right) if type(op) in OPERATORS:
            _check(left, text, depth - 1)
            _check(right, text, depth - 1)
        case ast.Call(func=ast.Name(id="sign"), args=[ast.Name(id="dq")], keywords=[]):
            pass
        case ast.Call(func=ast.Name(id="sign")):
            raise EffectError(f"expression '{text}': only {SIGN} is known, smoothed at rest")
        case ast.Call(func=ast.Name(id=name), args=args, keywords=[]) if name in FUNCTIONS:
            wanted = 2 if name in {"minimum", "maximum"} else 1
            if len(args) != wanted:
                raise EffectError(
                    f"expression '{text}': {name} takes {counted(wanted, 'argument')}, given {len(args)}"
                )
            for inner in args:
                _check(inner, text, depth - 1)
        case ast.Call():
            raise EffectError(f"expression '{text}': the functions are {', '.join((*FUNCTIONS, SIGN))}")
        case _:
            raise EffectError(
                f"expression '{text}': this is not arithmetic, which has numbers, names, + - * / **, brackets and "
                "functions"
            )


def _value(node: ast.expr, values: Values) -> Any:
    match node:
        case ast.Constant(value=number):
            return np.float64(number)  # type: ignore[arg-type]
        case ast.Name(id=name):
            return values[name]
        case ast.UnaryOp(op=op, operand=inner):
            return OPERATORS[type(op)](_value(inner, values))
        case ast.BinOp(op=op, left=left, right=right):
            return OPERATORS[type(op)](_value(left, values), _value(right, values))
        case ast.Call(func=ast.Name(id="sign")):
            return values[SIGN]
        case ast.Call(func=ast.Name(id=name), args=args):
            return FUNCTIONS[name](*(_value(a, values) for a in args))
    raise AssertionError(node)  # _check let nothing else through
