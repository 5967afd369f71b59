"""The residual is what the error equation says; weights learn with one sign and run away with the other."""

from dataclasses import dataclass

import numpy as np
import pytest

from cdia_pin import Dynamics, load_robot
from cdia_pin.campaigns.scara_run import Scenario, run
from cdia_pin.diagnosis.thesis import FixedGains, KnownEffects, Neurons, ThesisEngine, ThesisSettings
from cdia_pin.diagnosis.thesis.sample_interval import ArmSample, IntervalEvaluator
from cdia_pin.diagnosis.thesis.velocity_observers import ColumnScale, VelocityObservers
from cdia_pin.effects import CoulombFriction, Term, TorqueOffset, ViscousFriction

GAMMA = 50.0
QUIET = ThesisSettings(gamma=GAMMA, unmodelled=(1e6,) * 6)


@pytest.fixture(scope="module")
def arm():
    return load_robot("ur5")


@pytest.fixture(scope="module")
def scara():
    return load_robot("scara")


def test_a_constant_fault_on_an_arm_at_rest_gives_the_closed_form(arm):
    q, v = np.array([0.3, -1.2, 1.0, -0.5, 0.8, 0.1]), np.zeros(6)
    fault = np.array([3.0, -8.0, 4.0, 0.5, -0.3, 0.1])
    tau = arm.gravity(q) - fault  # it takes this to stay at rest
    engine = ThesisEngine(arm, settings=QUIET)
    last = [engine.update(0.002 * k, q, v, tau) for k in range(26)][-1]
    expected = -(1 - np.exp(-GAMMA * 0.05)) / GAMMA * np.linalg.solve(arm.mass_matrix(q), fault)
    np.testing.assert_allclose(last.residual, expected, rtol=1e-10)


def test_a_healthy_motion_leaves_almost_no_residual(scara):
    moved = run(
        Scenario((), np.zeros(4), duration=1.0),
        ThesisEngine(scara, settings=ThesisSettings(unmodelled=(1e3,) * 4)),
    )
    torque = 100.0 * np.einsum("nij,nj->ni", scara.mass_matrix(moved.q), moved.residual)  # γ M e ≈ −ρ
    assert (np.abs(torque).max(axis=0) < 1e-4 * np.sqrt((moved.effort**2).mean(axis=0))).all()


def test_the_error_of_discretisation_falls_with_the_square_of_the_step(scara):
    def largest(tick):
        engine = ThesisEngine(scara, settings=ThesisSettings(unmodelled=(1e3,) * 4))
        return np.abs(run(Scenario((), np.zeros(4), duration=0.8, tick=tick), engine).residual[:, :2]).max()

    assert largest(4e-3) / largest(2e-3) == pytest.approx(4.0, rel=0.3)


def test_other_discretisations_are_far_worse(scara):
    watching = ThesisEngine(scara, settings=ThesisSettings(unmodelled=(1e3,) * 4))
    moved = run(Scenario((), np.zeros(4), duration=2.0), watching)
    bias = scara.nonlinear_effects(moved.q, moved.v)
    wanted = [
        np.linalg.solve(*pair) for pair in zip(scara.mass_matrix(moved.q), moved.effort - bias, strict=True)
    ]
    left, gain = np.exp(-0.1), -np.expm1(-0.1) / 100.0
    euler, frozen, worst = moved.v[0], moved.v[0], np.zeros((2, 4))
    for now, after, a in zip(moved.v[:-1], moved.v[1:], wanted[:-1], strict=True):
        euler = euler + 1e-3 * (a - 100.0 * (euler - now))
        frozen = now + left * (frozen - now) + gain * a
        worst = np.maximum(worst, np.abs([euler - after, frozen - after]))
    ours = np.abs(moved.residual).max(axis=0)[:2]
    assert (worst[0, :2] > 100 * ours).all()
    assert (worst[1, :2] > 1000 * ours).all()


def test_a_term_of_the_model_is_not_missing(arm):
    friction = Term.of(ViscousFriction("elbow_joint"), coefficient=7.0)
    q, v = np.full(6, 0.4), np.full(6, 0.5)
    x = dict(zip(("bare", "with"), (Dynamics(arm), Dynamics(arm, (friction,))), strict=True))
    tau = x["with"].inverse_dynamics(q, v, np.zeros(6))
    lack = {}
    for name, model in x.items():
        before, now = ArmSample(0.0, q - 0.0005, v), ArmSample(0.002, q + 0.0005, v)
        lack[name] = IntervalEvaluator(model, 0.01, 1.0).step(before, now, tau).missing
    np.testing.assert_allclose(lack["with"], 0.0, atol=1e-9)
    np.testing.assert_allclose(lack["bare"], [0, 0, -7.0 * 0.5, 0, 0, 0], atol=1e-9)


@dataclass(frozen=True)
class OtherSign:
    """The law with the sign as printed, which belongs to another convention."""

    gains: FixedGains

    def rate(self, error, at):
        return -self.gains.rate(error, at)


def learn(scara, gains, steps=1500):
    """Neurons against a constant fault on a swinging arm; returns the largest weight and the last f̂."""
    basis = Neurons.over(scara, np.full(4, 2.0), np.full(4, 2.0), 4)
    observer, scale = VelocityObservers.fresh(basis, gains, np.full(4, 100.0)), ColumnScale(basis)
    stepper = IntervalEvaluator(Dynamics(scara), 0.01, 1.0)
    fault = np.array([20.0, -10.0, 0.05, 15.0])
    for k in range(steps):
        a, b = (
            ArmSample(0.001 * i, np.full(4, np.sin(0.001 * i)), np.full(4, np.cos(0.001 * i)))
            for i in (k, k + 1)
        )
        M, nle = (
            scara.mass_matrix(0.5 * (a.q + b.q)),
            scara.nonlinear_effects(0.5 * (a.q + b.q), 0.5 * (a.v + b.v)),
        )
        step = stepper.step(a, b, M @ (b.v - a.v) / 0.001 + nle - fault)
        scale.see(step)
        observer.step(step, scale)
        observer.adapt(step, scale, np.array([True]))
    return np.abs(observer.weights).max(), observer.torque(scale.columns)[0], fault


FAST = FixedGains(torque=(1e-9,) * 4, state=(3e5, 3e4, 0.1, 5e5))


def test_the_lyapunov_law_learns_a_fault(scara):
    largest, found, fault = learn(scara, FAST)
    np.testing.assert_allclose(found, fault, rtol=0.05)
    assert largest < 100.0


def test_with_the_other_sign_the_weights_run_away(scara):
    largest, found, fault = learn(scara, OtherSign(FAST))
    assert largest == pytest.approx(1e4)  # at their bound
    assert np.abs(found - fault).max() > 1e3


def test_the_lyapunov_function_never_grows(scara):
    """U = ½ eᵀe + ½ W̃ᵀ Γ⁻¹ W̃ for faults within the basis and no unmodelled torque."""
    basis = KnownEffects.of(scara, (TorqueOffset, CoulombFriction))
    gains = FixedGains(torque=(1.0,) * 4, state=(1e5, 5e4, 0.1, 1e5))
    observer, scale = VelocityObservers.fresh(basis, gains, np.full(4, 100.0)), ColumnScale(basis)
    true = np.array([[5.0, 10.0], [3.0, 5.0], [0.01, 0.01], [5.0, 8.0]])
    stepper, values, h = IntervalEvaluator(Dynamics(scara), 0.3, 1.0), [], 2e-4
    for k in range(1500):
        a, b = (
            ArmSample(h * i, np.full(4, np.sin(3 * h * i)), np.full(4, 3 * np.cos(3 * h * i)))
            for i in (k, k + 1)
        )
        q, v = 0.5 * (a.q + b.q), 0.5 * (a.v + b.v)
        rigid = scara.mass_matrix(q) @ (b.v - a.v) / h + scara.nonlinear_effects(q, v)
        fault = (basis.columns(stepper.state(0.0, q, v, v, v)) * true).sum(axis=1)
        step = stepper.step(a, b, rigid - fault)
        scale.see(step)
        observer.step(step, scale)
        observer.adapt(step, scale, np.array([True]))
        wrong = observer.weights[0] - true
        values.append(
            0.5 * (observer.error**2).sum() + 0.5 * (wrong**2 / np.array(gains.state)[:, None]).sum()
        )
    assert values[-1] < 0.98 * values[0]
    assert (np.diff(values) < 1e-3 * values[0]).all()
    assert (np.diff(values[::50]) <= 0).all()
