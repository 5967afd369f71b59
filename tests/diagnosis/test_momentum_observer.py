"""The residual is the missing torque, filtered: exactly in time, joint by joint, effect by effect."""

import numpy as np
import pytest

from cdia_pin.diagnosis import Bank, MonitorSettings
from cdia_pin.diagnosis.momentum_observer import MomentumObserver
from cdia_pin.diagnosis.nominal import Nominal
from cdia_pin.diagnosis.tick_flags import BAD
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import EFFECTS, CoulombFriction, Term
from cdia_pin.robot import load_robot

pytest.importorskip("mujoco")

from benchmarks.online import EXACT, NominalControl, OnlinePlant
from benchmarks.plant.faults import Fault
from benchmarks.plant.motion import Reference

ROBOT = load_robot("panda")
DT, GAMMA = 1e-3, 100.0
SETTINGS = MonitorSettings(bandwidth=GAMMA)
BANK = Bank.of(
    ROBOT, ["coulomb_friction", "viscous_friction", "actuator_gain", "torque_offset", "rotor_inertia"]
)
POSTURE = np.array([0.1, -0.4, 0.2, -1.9, 0.3, 1.4, -0.2])


def observer(*terms: Term, settings: MonitorSettings = SETTINGS) -> MomentumObserver:
    return MomentumObserver(Nominal.of(Dynamics(ROBOT, terms)), BANK.prototypes, settings, DT)


# ---------------------------------------------------------------- exact in time


def test_residual_of_a_constant_torque_follows_the_exponential_exactly() -> None:
    o, missing = observer(), np.linspace(-3.0, 5.0, ROBOT.n)
    still = np.zeros(ROBOT.n)
    held = ROBOT.nonlinear_effects(POSTURE, still) - missing
    for k in range(60):
        o.step(k * DT, POSTURE, still, held)
        np.testing.assert_allclose(o.residual, missing * -np.expm1(-GAMMA * k * DT), rtol=1e-10, atol=1e-12)


def test_ticks_may_be_uneven() -> None:
    o, still = observer(), np.zeros(ROBOT.n)
    held = ROBOT.nonlinear_effects(POSTURE, still) - 2.0
    times = np.cumsum(np.random.default_rng(0).uniform(0.2, 2.0, 80)) * DT
    for t in times:
        o.step(float(t), POSTURE, still, held)
    np.testing.assert_allclose(o.residual, 2.0 * -np.expm1(-GAMMA * (times[-1] - times[0])), rtol=1e-10)


def test_noise_of_the_residual_is_that_of_the_formula() -> None:
    o, rng, std = observer(), np.random.default_rng(1), 1e-3
    held = ROBOT.nonlinear_effects(POSTURE, np.zeros(ROBOT.n))
    seen = []
    for k in range(12_000):
        o.step(k * DT, POSTURE, std * rng.standard_normal(ROBOT.n), held)
        seen.append(o.residual.copy())
    E = np.exp(-GAMMA * DT)
    M = ROBOT.mass_matrix(POSTURE)
    formula = (1 - E) / DT * np.sqrt(2 / (1 + E)) * np.linalg.norm(M, axis=1) * std
    np.testing.assert_allclose(np.std(seen[200:], axis=0), formula, rtol=0.1)


def test_a_sample_that_is_not_finite_changes_nothing() -> None:
    o, still = observer(), np.zeros(ROBOT.n)
    for k in range(5):
        o.step(k * DT, POSTURE, still, still)
    before = o.state.array.copy()
    bad = still.copy()
    bad[2] = np.nan
    assert o.step(5 * DT, POSTURE, bad, still) & BAD
    np.testing.assert_array_equal(o.state.array, before)


def test_after_a_reset_the_same_samples_give_the_same_residual() -> None:
    o, found = observer(), []
    for _ in range(2):
        o.reset()
        rng = np.random.default_rng(3)
        for k in range(20):
            o.step(k * DT, *rng.uniform(-1, 1, (3, ROBOT.n)))
        found.append(o.residual.copy())
    np.testing.assert_array_equal(*found)


# ---------------------------------------------------------------- against another integrator

# RMS error of a residual at 1 kHz and γ = 100/s over its joint's RMS torque [1]; measured 5e-6 and less.
DISCRETE = 1e-5
EULER = 1.5e-3  # the same where MuJoCo moves the arm, whose own steps are of first order [1]


def integrated(joint: int | None = None, coefficient: float = 4.0, ticks: int = 2500):
    """Return time, q, v and command of a computed-torque loop, by Runge–Kutta at 10 kHz; a joint has friction."""
    import pinocchio as pin

    control, plan = NominalControl(ROBOT), OnlinePlant("panda", model_error=0.0).reference(seed=2)
    model, data = control.body.model, control.body.data
    wanted = plan(np.arange(ticks) * DT)
    x = np.r_[wanted.q[0], wanted.v[0]]
    n, out = ROBOT.n, []

    def rate(x, tau):
        f = np.zeros(n)
        if joint is not None:
            f[joint] = -coefficient * x[n + joint]
        return np.r_[x[n:], pin.aba(model, data, x[:n], x[n:], tau + f)]

    for k in range(ticks):
        tau = control(k * DT, x[:n], x[n:], Reference(wanted.q[k], wanted.v[k], wanted.a[k]))
        out.append((k * DT, x[:n], x[n:], tau))
        for _ in range(10):
            h = DT / 10
            k1 = rate(x, tau)
            k2 = rate(x + h / 2 * k1, tau)
            k3 = rate(x + h / 2 * k2, tau)
            x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + rate(x + h * k3, tau))
    return [np.array(s) for s in zip(*out, strict=True)]


def along(time, q, v, tau):
    """Return residuals and filtered columns, where each torque acts from its tick to the next."""
    o = observer()
    r, y = [], []
    for k, t in enumerate(time):
        o.step(float(t), q[k], v[k], tau[max(k - 1, 0)])
        r.append(o.residual.copy())
        y.append(o.filtered.copy())
    return np.array(r), np.array(y)


def share(r, tau):
    return np.sqrt(np.mean(r[100:] ** 2, axis=0) / np.mean(tau**2, axis=0))


@pytest.mark.parametrize("joint", [None, 1, 3])
def test_joints_do_not_mix_but_for_the_error_of_discretisation(joint: int | None) -> None:
    time, q, v, tau = integrated(joint)
    r, y = along(time, q, v, tau)
    relative = share(r, tau)
    if joint is not None:
        assert relative[joint] > 1e-3
        left = r[:, joint] - 4.0 * y[:, joint, BANK.names.index("viscous_friction")]
        relative[joint] = share(left, tau[:, joint])
    assert relative.max() < DISCRETE


@pytest.fixture(scope="module")
def plant() -> OnlinePlant:
    return OnlinePlant("panda", model_error=0.0, sensors=EXACT)


@pytest.mark.parametrize(
    ("effect", "parameters"),
    [
        ("coulomb_friction", {"level": 2.0}),
        ("viscous_friction", {"coefficient": 3.0}),
        ("actuator_gain", {"gain": -0.3}),
        ("torque_offset", {"offset": -4.0}),
        ("rotor_inertia", {"inertia": 0.3}),
    ],
)
def test_residual_is_the_filtered_columns_times_the_parameters(
    plant: OnlinePlant, effect, parameters
) -> None:
    fault = Fault(effect, joint="panda_joint4", **parameters)
    run = plant.run(NominalControl(plant.robot), plant.reference(seed=2), [fault], 4.0)
    r, y = along(run.time, run.q, run.v, run.arrived)
    column = BANK.span(BANK.names.index(effect)).start
    (theta,) = parameters.values()
    r[:, 3] -= theta * y[:, 3, column]
    if (
        effect == "coulomb_friction"
    ):  # at rest it is anything up to its level: until the filter has forgotten that
        rests = np.convolve(np.abs(run.v[:, 3]) < 0.02, np.ones(100))[: len(r)] > 0
        assert 0.2 < rests.mean() < 0.8
        r[rests] = 0.0
    assert share(r, run.arrived).max() < EULER


# ---------------------------------------------------------------- what the model has, and what is corrected


def test_a_term_of_the_model_is_no_residual() -> None:
    o = observer(Term(CoulombFriction("panda_joint2"), (5.0,)))
    v = np.full(ROBOT.n, 0.3)
    M, nle = ROBOT.mass_matrix(POSTURE), ROBOT.nonlinear_effects(POSTURE, v)
    assert M.shape == (ROBOT.n, ROBOT.n)
    held = nle.copy()
    held[1] += 5.0  # what the friction takes
    for k in range(200):
        o.step(k * DT, POSTURE, v, held)
    np.testing.assert_allclose(o.residual, 0.0, atol=1e-6)


@pytest.mark.parametrize(("gain", "divisor"), [(-0.3, 0.7), (0.5, 1.5), (-0.97, 0.1)])
def test_a_weak_drive_is_asked_for_more_but_not_without_end(gain: float, divisor: float) -> None:
    o, still = observer(), np.zeros(ROBOT.n)
    held = ROBOT.nonlinear_effects(POSTURE, still)
    for k in range(3):
        o.step(k * DT, POSTURE, still, held)
    theta = np.zeros(BANK.width)
    theta[BANK.span(BANK.names.index("actuator_gain"))] = gain
    o.believe(3, theta)
    tau = np.arange(1.0, ROBOT.n + 1)
    expected = tau - o.remainder
    expected[3] /= divisor
    np.testing.assert_allclose(o.correct(tau), expected, rtol=1e-9)


def test_dry_friction_is_made_up_for_in_the_direction_that_is_asked_for() -> None:
    o, still = observer(), np.zeros(ROBOT.n)
    for k in range(3):
        o.step(k * DT, POSTURE, still, ROBOT.nonlinear_effects(POSTURE, still))
    o.believed[3, 0] = 2.0
    forth, back = (o.correct(still, s * np.ones(ROBOT.n))[3] for s in (1, -1))
    assert (forth, back) == (pytest.approx(2.0, abs=1e-6), pytest.approx(-2.0, abs=1e-6))
    assert EFFECTS["coulomb_friction"].name == BANK.names[0]
