"""Expressions: a user's line of arithmetic, and nothing but arithmetic."""

import time

import numpy as np
import pytest

from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import CoulombFriction, Expression, Signal, State, Term, from_expression, parse_effect
from cdia_pin.errors import EffectError
from cdia_pin.robot import load_robot


@pytest.fixture(scope="module")
def state():
    robot = load_robot("double_pendulum")
    rng = np.random.default_rng(1)
    q, v, a, tau = rng.normal(size=(4, 30, 2))
    return State.of(robot, q, v, a, effort=tau, time=np.linspace(0, 3, 30), sign_width=0.1)


def column(text: str, x: State, parameter: int = 0) -> np.ndarray:
    return from_expression(text, "joint2").basis(x)[:, 1, parameter]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("q", lambda x: x.q),
        ("sin(3*q)*dq", lambda x: np.sin(3 * x.q) * x.v),
        ("-ddq + 2*pi", lambda x: -x.a + 2 * np.pi),
        ("abs(tau)*sign(dq)", lambda x: np.abs(x.effort) * x.sign),
        ("maximum(q, 0)**2 / e", lambda x: np.maximum(x.q, 0) ** 2 / np.e),
        ("exp(-t) * tanh(dq)", lambda x: np.exp(-x.time) * np.tanh(x.v)),
        ("1", lambda x: np.ones_like(x.q)),
    ],
)
def test_an_expression_means_what_it_says(state, text, expected):
    np.testing.assert_allclose(column(text, state), expected(state.joint("joint2")), rtol=1e-14)


def test_the_sign_is_smoothed_as_that_of_friction_is(state):
    np.testing.assert_array_equal(
        from_expression("-sign(dq)", "joint1").basis(state), CoulombFriction("joint1").basis(state)
    )


def test_every_other_name_is_a_parameter(state):
    effect = from_expression("b*dq**3 + a*sin(q) - b*q", "joint2")
    assert [p.name for p in effect.parameters] == ["a", "b"]
    x = state.joint("joint2")
    np.testing.assert_allclose(effect.columns(x)[0], np.sin(x.q))
    np.testing.assert_allclose(effect.columns(x)[1], x.v**3 - x.q)


def test_it_says_what_it_depends_on():
    assert from_expression("k*tau").traits.depends_on == {Signal.TORQUE}
    assert from_expression("k*ddq*sign(dq)").traits.depends_on == {Signal.ACCELERATION, Signal.DIRECTION}
    assert from_expression("k*q*dq*t").traits.depends_on == {Signal.POSITION, Signal.VELOCITY, Signal.TIME}


def test_a_label_is_read_back():
    for text in ("q", "tau", "sin(3*q)*dq", " dq * q "):
        effect = from_expression(text, "joint1")
        assert parse_effect(effect.label) == effect


def test_without_a_joint_it_stands_for_each():
    robot = load_robot("double_pendulum")
    effect = from_expression("q*dq")
    assert [e.scope for e in effect.expand(robot)] == [("joint1",), ("joint2",)]
    with pytest.raises(EffectError, match=r"q\*dq@JOINT"):
        Dynamics(robot, (Term(effect, (1.0,)),))


UNSAFE = [
    "__import__('os').system('true')",
    "q.__class__",
    "q.T",
    "().__class__.__bases__",
    "[q]",
    "(q, dq)",
    "{q}",
    "q[0]",
    "lambda: q",
    "(x := q)",
    "q if q else dq",
    "q and dq",
    "not q",
    "q < 1",
    "q == q",
    "~q",
    "q // 2",
    "q % 2",
    "q @ q",
    "q << 2",
    "'q'",
    "b'q'",
    "f'{q}'",
    "None",
    "True",
    "...",
    "1j",
    "open('f')",
    "eval('q')",
    "sin(q, out=q)",
    "sin(*q)",
    "sin()",
    "sin(q, q)",
    "minimum(q)",
    "sin",
    "sign",
    "sign(q)",
    "sign(d, q)",
    "sign()",
    "sin(q)(q)",
    "_hidden*q",
    "__builtins__*q",
    "q # comment",
    "q; dq",
    "q\ndq",
    "q = 1",
    "yield q",
    "await q",
    "q +",
    "((q)",
    "",
    "   ",
    "\0",
    "q\0",
]


@pytest.mark.parametrize("text", UNSAFE)
def test_what_is_not_arithmetic_is_refused(text):
    with pytest.raises(EffectError):
        from_expression(text, "joint1")


@pytest.mark.parametrize("text", [None, 3, b"q", ["q"]])
def test_what_is_not_text_is_refused(text):
    with pytest.raises(EffectError):
        Expression("joint1", text)


@pytest.mark.parametrize(
    "text",
    [
        "9**9**9**9 * q",
        "9**9**9",
        "q**9**9**9 + 1e250**1e250",
        "exp(exp(exp(exp(9)))) * q",
        "1e308*1e308*q",
        "9" * 290 + "**" + "9" * 8,
        "0x" + "f" * 250,
        "1/0",
        "(-1)**0.5 * q",
        "log(0*q)",
        "sqrt(-1-q*q)",
        "a*(a-a)**(0-1)",
    ],
)
def test_numbers_beyond_all_bounds_are_refused_at_once(text):
    started = time.perf_counter()
    with pytest.raises(EffectError):
        from_expression(text, "joint1")
    assert time.perf_counter() - started < 1.0


@pytest.mark.parametrize(
    "text",
    ["(" * 120 + "q" + ")" * 120, "-" * 250 + "q", "sin(" * 70 + "q" + ")" * 70, "q+" * 149 + "q", "q" * 301],
)
def test_long_and_deep_input_ends_soon(text):
    started = time.perf_counter()
    try:
        from_expression(text, "joint1")
    except EffectError as error:
        assert "\n" not in str(error)
    assert time.perf_counter() - started < 1.0


def test_a_huge_power_is_harmless_until_a_motion_makes_it_infinite(state):
    effect = from_expression("q**999999", "joint2")
    inside = State.of(state.robot, 0.5 * np.tanh(state.q), state.v)
    np.testing.assert_array_equal(effect.basis(inside), 0.0)
    with pytest.raises(EffectError, match="not finite"):
        effect.basis(State.of(state.robot, 2 + 0 * state.q, state.v))


@pytest.mark.parametrize("text", ["1/q", "q/(dq-dq)+0*q", "log(q)", "sqrt(q)", "1/dq"])
def test_a_division_by_zero_on_a_motion_says_so(state, text):
    x = State.of(state.robot, -np.abs(state.q) * (state.q > 0), 0 * state.v)
    with pytest.raises(EffectError, match="not finite"):
        from_expression(text, "joint2").basis(x)


@pytest.mark.parametrize(
    "text", ["sin(a*q)", "a*b*q", "a*q + 1", "abs(a)*q", "maximum(a, b)*q", "a**2*q", "q/a", "exp(a)"]
)
def test_it_must_be_linear_in_its_parameters(text):
    with pytest.raises(EffectError, match="not linear in a"):
        from_expression(text, "joint1")


@pytest.mark.parametrize("text", ["ddq**2", "abs(ddq)", "a*ddq*ddq", "sin(ddq)*q"])
def test_it_must_be_linear_in_the_acceleration(text):
    with pytest.raises(EffectError, match="linear in ddq"):
        from_expression(text, "joint1")


def test_a_bare_parameter_is_more_likely_a_misspelt_effect():
    with pytest.raises(EffectError, match="bare parameter"):
        from_expression("coulomb", "joint1")
    with pytest.raises(EffectError, match="coulomb_friction"):
        parse_effect("coulomb_frction@joint1")
