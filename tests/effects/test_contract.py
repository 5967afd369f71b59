"""What every effect promises, held for each class of the vocabulary without naming one, and for effects made of others.

A new effect is covered as soon as it is in `cdia_pin.effects.EFFECTS`; see docs/effects.md.
"""

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import ClassVar

import numpy as np
import pytest

from cdia_pin.changes.difference import Difference
from cdia_pin.diagnosis.bank import Bank
from cdia_pin.diagnosis.nominal import Nominal
from cdia_pin.dynamics import Dynamics, exciting_trajectory, simulate
from cdia_pin.dynamics.simulate import run_plant
from cdia_pin.effects import (
    EFFECTS,
    BaseTilt,
    Channel,
    Drift,
    Effect,
    Expression,
    JointEffect,
    JointState,
    LinkInertias,
    Parameter,
    PerLog,
    Region,
    Signal,
    State,
    StatefulEffect,
    Term,
    Traits,
    WrappedEffect,
    after,
    effect_from_dict,
    parse_effect,
    register,
)
from cdia_pin.effects.memory import Memory
from cdia_pin.effects.scoped import Scoped
from cdia_pin.errors import EffectError, ModelError, RobotError
from cdia_pin.logs.conditioning import condition
from cdia_pin.regression.experiment import Experiment
from cdia_pin.regression.shape_slopes import Slope
from cdia_pin.robot import RobotModel, load_robot

ROBOTS = ("ur5", "scara")  # revolute joints; revolute ones and a prismatic one


@dataclass(frozen=True)
class HardeningSpring(JointEffect):
    """An effect as a user would add it: one class, f = −k (q − r)³."""

    rest: float = 0.1

    name: ClassVar[str] = "hardening_spring"
    equation: ClassVar[str] = "−k (q − r)³"
    traits: ClassVar[Traits] = Traits({Signal.POSITION})
    parameters = (Parameter("stiffness", "{effort}/{position}³", lower=0.0),)
    shape = (Parameter("rest", "{position}", lower=-7.0, upper=7.0),)

    def columns(self, x: JointState) -> Sequence[np.ndarray]:
        """Return the column of the stiffness."""
        return [-((x.q - self.rest) ** 3)]


@dataclass(frozen=True)
class RelaxingBristle(StatefulEffect):
    """An effect with memory: f = −k z, where the motion bends z and time relaxes it, ż = q̇ − z/T."""

    relaxation: float = 0.5

    name: ClassVar[str] = "relaxing_bristle"
    equation: ClassVar[str] = "−k z,  ż = q̇ − z/T"
    traits: ClassVar[Traits] = Traits({Signal.POSITION, Signal.TIME})
    parameters = (Parameter("stiffness", "{effort}/{position}", lower=0.0),)
    shape = (Parameter("relaxation", "s", lower=1e-3, upper=1e3),)

    def initial_state(self, robot: RobotModel) -> np.ndarray:
        """Return a bristle that is straight."""
        return np.zeros(1)

    def step(self, z: np.ndarray, x: JointState, dq: float, dt: float) -> np.ndarray:
        """Return the bend after a step of constant speed."""
        kept = np.exp(-dt / self.relaxation)
        return z * kept + dq / dt * self.relaxation * (1 - kept)

    def columns(self, x: JointState) -> Sequence[np.ndarray]:
        """Return the column of the stiffness."""
        return [-x.memory[:, 0]]


@dataclass(frozen=True)
class Same(WrappedEffect):
    """An effect made of another one that overrides nothing."""

    effect: Effect


KINDS = [*EFFECTS.values(), HardeningSpring, RelaxingBristle]
USER_EXPRESSIONS = ("sin(3*q)*dq", "a*dq**3 + b*sin(2*q)", "k*tau*sign(dq)", "-m*ddq + c*cos(q)*t")


@pytest.fixture(scope="module", autouse=True)
def users_effect():
    register(HardeningSpring)
    register(RelaxingBristle)
    yield
    del EFFECTS[HardeningSpring.name], EFFECTS[RelaxingBristle.name]


@cache
def robot_of(name: str) -> RobotModel:
    return load_robot(name)


@cache
def state_of(name: str) -> State:
    """A motion in which every joint moves both ways, under torques that are not just the rigid body's."""
    robot = robot_of(name)
    time = np.linspace(0.0, 10.0, 41)[1:-1]
    q, v, a = exciting_trajectory(robot, np.random.default_rng(2), duration=10.0)(time)
    tau = 1.1 * robot.inverse_dynamics(q, v, a) + np.sin(time)[:, None]
    return replace(State.of(robot, q, v, a, effort=tau, time=time, sign_width=0.01), log="warm")


@cache
def wrapped() -> tuple[tuple[str, Effect], ...]:
    """Effects made of others: each wrapper around bodies, tilts, readings, shapes, memory and a user's line."""
    labels = (
        "payload", "link_inertia@elbow_joint+wrist_1_joint", "base_tilt", "actuator_gain@elbow_joint", "effort_delay",
        "coulomb_friction@elbow_joint", "position_ripple@elbow_joint", "viscous_medium", "a*dq**3 + b*tau@elbow_joint",
    )  # fmt: skip
    inner = (*map(parse_effect, labels), RelaxingBristle("elbow_joint"))
    ripple, stribeck = (parse_effect(f"{n}@elbow_joint") for n in ("position_ripple", "stribeck_friction"))
    coulomb = parse_effect("coulomb_friction@elbow_joint")
    offset = parse_effect("encoder_offset@elbow_joint")
    effects = (
        *(Same(e) for e in (*inner, offset)),
        *(PerLog(e, ("cold", "warm")) for e in inner),
        *(Drift(e, 0.0, 10.0, 3.0) for e in inner),
        *(Difference(e, ("warm",)) for e in (*inner, offset)),
        *(Slope(e, (2.0, 1.0), e.shape[0].name) for e in (ripple, stribeck)),
        Slope(Drift(coulomb, 0.0, 10.0, 3.0), (2.0, 1.0), "time_constant"),
        Slope(PerLog(stribeck, ("cold", "warm")), (2.0, 1.0, 3.0, 0.5), "decay"),
    )
    return tuple(("ur5", e) for e in effects)


@cache
def examples() -> tuple[tuple[str, Effect], ...]:
    """One instance for each kind of scope: of revolute joints, of prismatic joints, of the whole arm."""
    out = []
    for name in ROBOTS:
        robot = robot_of(name)
        for kind in KINDS:
            seen = set()
            for scope in kind.scopes(robot):
                sort = tuple(bool(robot.is_prismatic[robot.joint_index(j)]) for j in scope)
                if sort not in seen:
                    seen.add(sort)
                    out.append((name, kind.from_scope(scope, {})))
    several = ((name, LinkInertias(robot_of(name).joints)) for name in ROBOTS)
    lines = (("ur5", Expression("elbow_joint", text)) for text in USER_EXPRESSIONS)
    return (*out, *several, *lines, *wrapped())


def is_written(effect: Effect) -> bool:
    """Tell whether an effect has a form in files: differences and slopes are made for a regression alone."""
    return not isinstance(effect, Difference | Slope | Same)


def is_named(effect: Effect) -> bool:
    """Tell whether an effect is written by its label: how one varies is not part of that."""
    return not isinstance(effect, WrappedEffect)


def each(chosen: Callable[[Effect], object] = lambda _: True) -> pytest.MarkDecorator:
    """Run a test for every example, or for those that it is about."""
    cases = [(robot, effect) for robot, effect in examples() if chosen(effect)]
    ids = [f"{robot}-{type(effect).__name__}-{effect.label}" for robot, effect in cases]
    return pytest.mark.parametrize(("name", "effect"), cases, ids=ids)


def drawn(effect: Effect, robot: RobotModel, seed: int = 0) -> np.ndarray:
    """Parameters of a moderate size within the effect's bounds."""
    rng = np.random.default_rng(seed)
    lower, upper = effect.bounds(robot)
    theta = np.empty(effect.size)
    for i, (low, high) in enumerate(zip(lower, upper, strict=True)):
        if np.isfinite(low) and np.isfinite(high):
            theta[i] = rng.uniform(0.9 * low + 0.1 * high, 0.1 * low + 0.9 * high)
        elif np.isfinite(low):
            theta[i] = low + rng.exponential()
        else:
            theta[i] = rng.normal()
    return effect.nearest_physical(theta, robot)


def scale(f: np.ndarray) -> float:
    return max(1.0, float(np.abs(f).max()))


# ------------------------------------------------------------------ physics


@each()
def test_torque_basis_and_jacobian_have_the_shapes_of_the_equation(name, effect):
    robot, x = robot_of(name), state_of(name)
    theta = drawn(effect, robot)
    assert effect.basis(x).shape == (len(x), robot.n, effect.size)
    assert effect.jacobian(x, theta).shape == (len(x), robot.n, effect.size)
    assert effect.torque(x, theta).shape == (len(x), robot.n)
    one = State.of(robot, x.q[0], x.v[0], x.a[0], effort=x.effort[0])
    assert effect.torque(one, theta).shape == (1, robot.n)


@each()
def test_no_parameters_no_torque(name, effect):
    x = state_of(name)
    zero = np.zeros(effect.size)
    np.testing.assert_allclose(effect.torque(x, zero), 0.0, atol=1e-12)
    np.testing.assert_array_equal(effect.shift(x, zero), 0.0)
    np.testing.assert_array_equal(effect.gravity_change(x, zero), 0.0)


@each()
def test_a_linear_effect_is_linear(name, effect):
    x, robot = state_of(name), robot_of(name)
    one, two = drawn(effect, robot, 1), drawn(effect, robot, 2)
    together = effect.torque(x, one - 2 * two)
    apart = effect.torque(x, one) - 2 * effect.torque(x, two)
    if effect.traits.linear:
        np.testing.assert_allclose(together, apart, atol=1e-9 * scale(apart))
        np.testing.assert_allclose(effect.basis(x) @ one, effect.torque(x, one), atol=1e-9 * scale(apart))


@each()
def test_the_jacobian_is_the_derivative_of_the_torque(name, effect):
    x, robot = state_of(name), robot_of(name)
    theta = 0.5 * drawn(effect, robot)
    jacobian = effect.jacobian(x, theta)
    for i, step in enumerate(1e-4 * np.maximum(np.abs(theta), 1e-2)):
        shift = step * np.eye(effect.size)[i]
        slope = (effect.torque(x, theta + shift) - effect.torque(x, theta - shift)) / (2 * step)
        np.testing.assert_allclose(jacobian[:, :, i], slope, atol=1e-4 * scale(slope))


@each()
def test_torque_appears_on_its_joints_and_nowhere_else(name, effect):
    robot, x = robot_of(name), state_of(name)
    f = effect.torque(x, drawn(effect, robot))
    acted = list(effect.acts_on(robot))
    assert {robot.joint_index(j) for j in effect.scope} & set(acted) or not effect.scope
    np.testing.assert_array_equal(np.delete(f, acted, axis=1), 0.0)


@each(lambda effect: effect.traits.dissipative)
def test_friction_never_adds_power(name, effect):
    robot = robot_of(name)
    rng = np.random.default_rng(5)
    q, tau = rng.normal(size=(2, 200, robot.n))
    v = rng.normal(size=(200, robot.n)) * 10.0 ** rng.uniform(-5, 1, (200, 1))
    x = State.of(robot, q, v, effort=30 * tau, sign_width=0.01)
    for seed in range(3):
        power = np.einsum("ki,ki->k", effect.torque(x, drawn(effect, robot, seed)), v)
        assert (power <= 1e-12).all()
        assert power.min() < 0
    at_rest = replace(x, v=np.zeros_like(v))
    np.testing.assert_array_equal(effect.torque(at_rest, drawn(effect, robot)), 0.0)


@each(
    lambda effect: effect.traits.channel is not Channel.TORQUE_READING
)  # a late reading needs its neighbours in time
def test_the_torque_of_a_trajectory_is_that_of_its_samples(name, effect):
    robot, x = robot_of(name), state_of(name)
    theta = drawn(effect, robot)
    f = effect.torque(x, theta)
    for k in (0, 7, len(x) - 1):
        one = replace(x.sample(k), memory={m: m.along(x)[k] for m in effect.memories})
        np.testing.assert_allclose(effect.torque(one, theta)[0], f[k], atol=1e-9 * scale(f))


def louder(signal: np.ndarray, time: np.ndarray) -> np.ndarray:
    """Another signal of the same shape: larger, with another course."""
    return 1.3 * signal + (0.2 + 0.1 * np.cos(3 * time))[:, None]


CHANGED: dict[Signal, Callable[[State], State]] = {  # in one signal alone, all others as they were
    Signal.POSITION: lambda x: x.with_position(louder(x.q, x.time)),
    Signal.VELOCITY: lambda x: replace(x, v=2 * x.v, sign_width=2 * x.sign_width),
    Signal.DIRECTION: lambda x: replace(x, sign_width=1e3 * x.sign_width),
    Signal.ACCELERATION: lambda x: replace(x, a=louder(x.a, x.time)),
    Signal.TORQUE: lambda x: x.with_effort(louder(x.effort, x.time)),
    Signal.TIME: lambda x: replace(x, time=1.2 * x.time + 0.3),
    Signal.TEMPERATURE: lambda x: replace(x, temperature=louder(np.full_like(x.q, 25.0), x.time)),
    Signal.GRAVITY: lambda x: x.with_gravity_change(np.tile([1.0, -2.0, 0.5], (len(x), 1))),
}


def changes_with(effect: Effect, signal: Signal, x: State) -> bool:
    return not np.array_equal(effect.basis(CHANGED[signal](x)), effect.basis(x))


@each()
def test_a_signal_that_it_does_not_declare_leaves_it_as_it_is(name, effect):
    changing = {s for s in Signal if changes_with(effect, s, state_of(name))}
    assert changing <= effect.traits.depends_on


@pytest.mark.parametrize("kind", KINDS, ids=lambda k: k.name)
def test_each_signal_that_it_declares_changes_it_on_some_joint(kind):
    x = state_of("ur5")
    effects = [kind.from_scope(scope, {}) for scope in kind.scopes(x.robot)]
    for signal in effects[0].traits.depends_on:
        assert any(changes_with(e, signal, x) for e in effects), signal


@each(lambda effect: isinstance(effect, WrappedEffect))
def test_an_effect_made_of_another_depends_on_all_that_it_declares(name, effect):
    assert {s for s in Signal if changes_with(effect, s, state_of(name))} == effect.traits.depends_on


@each(lambda effect: Signal.TORQUE in effect.traits.depends_on)
def test_it_is_in_proportion_to_the_torque_for_either_sign(name, effect):
    """Models divide to solve for the torque; a distorted reading comes after that."""
    if effect.traits.channel is Channel.TORQUE_READING:
        return
    x = state_of(name)
    theta = drawn(effect, x.robot)
    none, once, thrice = (effect.torque(x.with_effort(k * x.effort), theta) for k in (0, 1, 3))
    np.testing.assert_allclose(thrice - none, 3 * (once - none), atol=1e-9 * scale(thrice))


@each()
def test_it_is_affine_in_the_acceleration(name, effect):
    x = state_of(name)
    theta = drawn(effect, x.robot)
    none, once, thrice = (effect.torque(replace(x, a=k * x.a), theta) for k in (0, 1, 3))
    np.testing.assert_allclose(thrice - none, 3 * (once - none), atol=1e-8 * scale(thrice))


@each()
def test_it_shifts_the_encoders_exactly_if_it_says_so(name, effect):
    x = state_of(name)
    shifts = bool(effect.shift(x, drawn(effect, x.robot)).any())
    assert shifts == (effect.traits.channel is Channel.POSITION_READING)


@each()
def test_it_turns_gravity_exactly_if_it_says_so(name, effect):
    x = state_of(name)
    assert effect.traits.turns_gravity == bool(effect.gravity_change(x, drawn(effect, x.robot)).any())


@pytest.mark.parametrize("kind", KINDS, ids=lambda k: k.name)
def test_what_it_calls_not_linear_is_not_linear_on_some_joint(kind):
    x = state_of("ur5")
    effects = [kind.from_scope(scope, {}) for scope in kind.scopes(x.robot)]
    if not all(e.traits.linear for e in effects):
        drawings = [(e, drawn(e, x.robot, 1), drawn(e, x.robot, 2)) for e in effects]
        bent = [e.torque(x, one + two) - e.torque(x, one) - e.torque(x, two) for e, one, two in drawings]
        assert np.abs(bent).max() > 1e-3


# ------------------------------------------------------------------ units and bounds


@each()
def test_every_parameter_has_a_unit_of_its_joint(name, effect):
    robot = robot_of(name)
    units = effect.units(robot)
    assert len(units) == effect.size == len(effect.parameters)
    for unit in units:
        assert unit and "{" not in unit
    if len(effect.scope) and robot.is_prismatic[robot.joint_index(effect.scope[0])]:
        assert not any("rad" in u for u in units)
    assert len({p.name for p in effect.parameters}) == effect.size


@each()
def test_bounds_are_in_order_and_allow_no_effect(name, effect):
    robot = robot_of(name)
    lower, upper = effect.bounds(robot)
    assert lower.shape == upper.shape == (effect.size,)
    assert (lower < upper).all()
    assert effect.is_physical(np.zeros(effect.size), robot)


@each()
def test_the_nearest_physical_parameters_are_physical_and_stay(name, effect):
    robot = robot_of(name)
    rng = np.random.default_rng(9)
    for size in (0.1, 1.0, 30.0):
        wild = size * rng.normal(size=effect.size)
        near = effect.nearest_physical(wild, robot)
        assert near.shape == (effect.size,)
        assert effect.is_physical(near, robot)
        np.testing.assert_array_equal(effect.nearest_physical(near, robot), near)
    theta = drawn(effect, robot, 4)
    np.testing.assert_array_equal(effect.nearest_physical(theta, robot), theta)
    assert effect.prior_scale(robot).shape == (effect.size,)
    assert (effect.prior_scale(robot) > 0).all()


@each()
def test_shapes_worth_trying_are_shapes_of_the_same_effect(name, effect):
    for other in effect.shape_grid(state_of(name)):
        assert type(other) is type(effect)
        assert other.label == effect.label
        for p in other.shape:
            assert p.lower <= other.shape_values[p.name] <= p.upper
    for p in effect.shape:
        with pytest.raises(EffectError, match=p.name.replace("_", "[_ ]")):
            effect.with_shape(**{p.name: np.nan})


# ------------------------------------------------------------------ names and files


@each(is_written)
def test_it_survives_a_file_exactly(name, effect):
    robot = robot_of(name)
    theta = tuple(drawn(effect, robot, 6).tolist())
    ci95 = tuple((t - 0.1, t + 0.1) for t in theta)
    for profile in (after(4.0), Region(robot.joints[0], "speed", upper=0.3)):
        term = Term(effect, theta, profile, ci95)
        again = Term.from_dict(json.loads(json.dumps(term.to_dict(robot))))
        assert again == term
        assert again.ci95 == ci95
    assert effect_from_dict(json.loads(json.dumps(effect.to_dict()))) == effect


@each(is_named)
def test_it_is_found_by_its_label(name, effect):
    found = parse_effect(effect.label, robot_of(name))
    assert found == effect
    assert found.label == effect.label


@each()
def test_equal_effects_are_one_in_a_set(name, effect):
    again = [effect_from_dict(effect.to_dict())] if is_written(effect) else []
    assert len({effect, replace(effect), *again}) == 1


@each(lambda effect: not is_written(effect))
def test_what_has_no_form_in_a_file_is_not_written(name, effect):
    with pytest.raises(EffectError, match="no form in a file"):
        effect.to_dict()


@each(lambda effect: effect.scope)
def test_another_robot_cannot_have_it(name, effect):
    with pytest.raises(RobotError, match=effect.scope[0]):
        Dynamics(robot_of("scara" if name == "ur5" else "ur5"), (Term(effect, (0.0,) * effect.size),))


@pytest.mark.parametrize("kind", KINDS, ids=lambda k: k.name)
def test_too_many_joints_are_refused_with_the_form_to_write(kind):
    with pytest.raises(EffectError, match=f"write {kind.name}"):
        kind.from_scope(["a", "b", "c"], {})


def test_a_name_is_taken_once():
    @dataclass(frozen=True)
    class Impostor(HardeningSpring):
        pass

    with pytest.raises(EffectError, match="exists already"):
        register(Impostor)


@each(lambda effect: Signal.TORQUE in effect.traits.depends_on)
def test_the_torque_under_several_actuator_torques_is_that_under_each(name, effect):
    x = state_of(name)
    theta = drawn(effect, x.robot)
    efforts = np.random.default_rng(0).normal(size=(*x.q.shape, 3))
    every = effect.torques(x, efforts, theta)
    for k in range(3):
        np.testing.assert_allclose(every[:, :, k], effect.torque(x.with_effort(efforts[:, :, k]), theta))


# ------------------------------------------------------------------ effects made of others, effects with memory

DERIVED = {
    "size",
    "by_body",
    "on_links",
    "from_scope",
    "scopes",
    "torques",
}  # from other parts of the contract, or of the class alone


def test_an_effect_made_of_another_has_all_of_its_contract():
    contract = {n for kind in (Effect, Scoped) for n in vars(kind) if not n.startswith("_")}
    assert contract - DERIVED <= vars(WrappedEffect).keys()


@each(
    lambda effect: (
        type(effect).is_distinct is not Effect.is_distinct and not isinstance(effect, WrappedEffect)
    )
)
def test_an_effect_that_may_not_be_distinct_is_the_simpler_one_then(name, effect):
    robot, x = robot_of(name), state_of(name)
    theta = drawn(effect, robot)
    theta[effect.simpler.size :] = 0.0
    assert not effect.is_distinct(theta)
    np.testing.assert_allclose(
        effect.torque(x, theta), effect.simpler.torque(x, theta[: effect.simpler.size]), atol=1e-12
    )


@each(lambda effect: isinstance(effect, WrappedEffect))
def test_an_effect_made_of_another_acts_where_that_one_does(name, effect):
    robot, inner = robot_of(name), effect.effect
    assert (effect.scope, effect.acts_on(robot)) == (inner.scope, inner.acts_on(robot))
    assert effect.traits.channel is inner.traits.channel
    assert effect.plausibility == inner.plausibility
    assert effect.memories == inner.memories
    assert effect.label.startswith(inner.label)


@each(lambda effect: isinstance(effect, Same))
def test_an_effect_that_overrides_nothing_is_the_other_one(name, effect):
    robot, x, inner = robot_of(name), state_of(name), effect.effect
    theta, wild = drawn(effect, robot), 30 * np.random.default_rng(9).normal(size=effect.size)
    for method in ("torque", "jacobian", "shift", "gravity_change"):
        np.testing.assert_array_equal(getattr(effect, method)(x, theta), getattr(inner, method)(x, theta))
    for method in ("bounds", "prior_scale", "acts_on", "joints", "units"):
        np.testing.assert_array_equal(getattr(effect, method)(robot), getattr(inner, method)(robot))
    np.testing.assert_array_equal(effect.nearest_physical(wild, robot), inner.nearest_physical(wild, robot))
    assert effect.is_physical(wild, robot) == inner.is_physical(wild, robot)
    assert effect.is_distinct(wild) == inner.is_distinct(wild)
    for fact in (
        "name",
        "equation",
        "label",
        "parameters",
        "shape",
        "shape_values",
        "bodies",
        "scope_fields",
    ):
        assert getattr(effect, fact) == getattr(inner, fact)
    assert [e.effect for e in effect.shape_grid(x)] == list(inner.shape_grid(x))
    assert [e.effect for e in effect.nearly_alike(x)] == list(inner.nearly_alike(x))


@each(lambda effect: effect.memories)
def test_a_memory_begins_as_it_is_known_and_anew_where_time_goes_back(name, effect):
    x, (memory,) = state_of(name), effect.memories
    z = memory.along(x)
    np.testing.assert_array_equal(z[0], memory.initial_state(x.robot))
    later = replace(x, q=x.q[20:], v=x.v[20:], a=x.a[20:], effort=x.effort[20:], time=x.time[20:])
    np.testing.assert_allclose(memory.along(replace(later, memory={memory: z[20]})), z[20:], atol=1e-12)
    twice = (np.concatenate([s, s]) for s in (x.q, x.v, x.a, x.effort, x.time))
    np.testing.assert_array_equal(memory.along(State(x.robot, *twice, x.sign_width)), np.vstack([z, z]))
    still = replace(x, time=np.zeros_like(x.time))
    np.testing.assert_array_equal(memory.along(still), np.tile(z[0], (len(x), 1)))


@pytest.mark.parametrize("kind", [k for k in KINDS if issubclass(k, Memory)], ids=lambda k: k.name)
def test_a_memory_in_a_simulation_is_that_of_the_motion(kind):
    """M q̈ + nle − τ of every step of a simulation is the torque that the effect has along its motion."""
    robot, effect = robot_of("ur5"), kind("elbow_joint")
    plant = Dynamics(robot, (Term(effect, tuple(sensible(effect))),))
    run = run_plant(plant, reference(), duration=2.0)
    along = plant.missing_torque(run.state(plant))
    stepped = robot.inverse_dynamics(run.q, run.v, run.a) - run.effort
    np.testing.assert_allclose(stepped, along, atol=1e-8)
    assert np.abs(along).max() > 1.0


@pytest.mark.parametrize("kind", [k for k in KINDS if issubclass(k, Memory)], ids=lambda k: k.name)
def test_a_monitor_refuses_a_memory_or_takes_what_it_is_where_the_past_has_no_weight(kind):
    robot, effect = robot_of("ur5"), kind("elbow_joint")
    with pytest.raises(EffectError, match="has memory"):
        Bank.of(robot, [effect])
    model = Dynamics(robot, (Term(effect, (1.0,) * effect.size),))
    if effect.steady is None:
        with pytest.raises(ModelError, match="memory"):
            Nominal.of(model)
    else:
        assert [t.effect for t in Nominal.of(model).of_joints] == [effect.steady]


@each()
def test_where_the_past_has_no_weight_is_no_memory(name, effect):
    if effect.steady is not None:
        assert effect.steady.memories == ()
        assert effect.steady.size == effect.size


# ------------------------------------------------------------------ a fault in a plant, found in its log

SHARE = 0.15  # largest torque of each parameter, beside the RMS torque of the joints
LOG = {"duration": 8.0, "rate": 200.0}


@cache
def reference():
    return exciting_trajectory(robot_of("ur5"), np.random.default_rng(3), duration=8.0, base=0.15)


@cache
def asked() -> State:
    time = np.linspace(0.0, LOG["duration"], 400)
    x = State.of(robot_of("ur5"), *reference()(time), time=time, sign_width=0.01)
    return replace(x, temperature=25.0 + time[:, None] * np.ones(x.robot.n))


def visible(kind: type[Effect]) -> Effect:
    """An effect on joints that carry load, with a shape that this motion shows."""
    scopes = list(kind.scopes(asked().robot))
    grid = kind.from_scope(scopes[min(2, len(scopes) - 1)], {}).shape_grid(asked())
    return grid[len(grid) // 2]


def sensible(effect: Effect) -> np.ndarray:
    """Physical parameters, each of them worth a share of the torque that the motion takes."""
    x, robot = asked(), asked().robot
    acted = list(effect.acts_on(robot))
    columns = np.abs(effect.basis(x)[:, acted]).max(axis=(0, 1))
    unit = SHARE * np.sqrt(np.mean(x.effort[:, acted] ** 2)) / np.maximum(columns, 1e-6)
    rng = np.random.default_rng(8)
    theta = np.where(columns > 1e-6, unit * rng.uniform(0.6, 1.0, effect.size), 0.0)
    return effect.nearest_physical(theta, robot)


def fitted(effect: Effect, experiment: Experiment) -> tuple[np.ndarray, np.ndarray]:
    """Fit one effect to an experiment by Gauss and Newton; return its parameters and their columns."""
    theta = np.zeros(effect.size)
    used = experiment.informative[:, list(effect.acts_on(experiment.robot))]
    for _ in range(5):
        prediction = experiment.predict(Dynamics(experiment.robot, (Term(effect, tuple(theta)),)))
        columns = experiment.columns(effect, prediction, theta)[used]
        left = prediction.residual[:, list(effect.acts_on(experiment.robot))][used]
        unit = 1.0 / np.maximum(np.sqrt(np.mean(columns**2, axis=0)), 1e-9)
        theta = theta + unit * np.linalg.lstsq(columns * unit, left, rcond=1e-6)[0]
    return theta, columns * unit


@pytest.mark.parametrize("kind", KINDS, ids=lambda k: k.name)
def test_a_fault_in_the_plant_is_recovered_from_its_log(kind):
    robot = robot_of("ur5")
    effect = visible(kind)
    truth = sensible(effect)
    plant = Dynamics(robot, (Term(effect, tuple(truth)),))
    experiment = Experiment.of(robot, [condition(simulate(plant, reference(), **LOG), robot)])
    theta, columns = fitted(effect, experiment)
    healthy, with_truth, with_fit = (
        experiment.predict(Dynamics(robot, terms)).residual[experiment.informative]
        for terms in ((), plant.terms, (Term(effect, tuple(theta)),))
    )
    missing = np.sqrt(np.mean(healthy**2))
    assert np.sqrt(np.mean(with_truth**2)) < 0.03 * missing, "the plant is not what the effect says"
    assert np.sqrt(np.mean(with_fit**2)) < 0.03 * missing
    if np.linalg.cond(columns) < 30:  # otherwise this motion does not tell its parameters apart
        np.testing.assert_allclose(theta, truth, rtol=0.05, atol=0.02 * np.abs(truth).max())


def test_a_fit_that_goes_beyond_the_steepest_tilt_gets_a_finite_slope():
    tilt, robot = BaseTilt(), load_robot("ur5")
    x = State.of(robot, np.zeros((1, robot.n)), np.zeros((1, robot.n)))
    assert np.isfinite(tilt.jacobian(x, np.array([9.0, 9.0]))).all()
    assert np.isfinite(tilt.torque(x, np.array([9.0, 9.0]))).all()
