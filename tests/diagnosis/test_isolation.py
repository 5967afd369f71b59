"""The combination that explains a residual: unique if it is the only one, else ambiguous; unknown if there is none."""

from itertools import combinations

import numpy as np
import pytest

from cdia_pin.diagnosis import Bank, Monitor, MonitorSettings
from cdia_pin.diagnosis.belief import JointBelief
from cdia_pin.diagnosis.isolation import Decision, Isolator
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import CoulombFriction, Term
from cdia_pin.robot import load_robot

ROBOT = load_robot("ur5")
NAMES = ("coulomb_friction", "viscous_friction", "actuator_gain", "torque_offset")
BANK = Bank.of(ROBOT, NAMES)
THETA = {"coulomb_friction": 3.0, "viscous_friction": 2.0, "actuator_gain": -0.3, "torque_offset": -2.0}
LEVEL = 0.05  # [N·m], RMS of a healthy residual
SETTINGS = MonitorSettings(most_effects=4)


def columns(count: int = 4000) -> np.ndarray:
    """Columns of the bank along a motion at 1 kHz, shape (K, 4)."""
    t = np.arange(count) * 1e-3
    v = np.sin(2 * np.pi * 0.7 * t) + 0.4 * np.sin(2 * np.pi * 1.9 * t + 1)
    tau = 12 * np.cos(2 * np.pi * 0.45 * t) + 4.0
    return np.column_stack([-np.tanh(v / 0.01), -v, tau, np.ones(count)])


def gram_of(y: np.ndarray, r: np.ndarray) -> np.ndarray:
    both = np.column_stack([y, r])
    return np.triu(both.T @ both)


def decide(y: np.ndarray, r: np.ndarray, isolator: Isolator | None = None, **more) -> Decision:
    isolator = isolator or made()
    return isolator.decide(0, gram_of(y, r), len(r), LEVEL, 100.0, **more)


def made(bank: Bank = BANK, settings: MonitorSettings = SETTINGS) -> Isolator:
    lower, upper = (np.tile(b, (ROBOT.n, 1)) for b in bank.bounds)
    return Isolator(bank, lower, upper, settings)


def noise(count: int, seed: int = 0) -> np.ndarray:
    return LEVEL * np.random.default_rng(seed).standard_normal(count)


@pytest.mark.parametrize("chosen", [c for k in range(5) for c in combinations(range(4), k)], ids=str)
def test_every_combination_is_named(chosen: tuple[int, ...]) -> None:
    y = columns()
    theta = np.array([THETA[n] if i in chosen else 0.0 for i, n in enumerate(NAMES)])
    decision = decide(y, y @ theta + noise(len(y)))
    assert decision.mask == sum(1 << i for i in chosen)
    assert decision.rivals == ()
    np.testing.assert_allclose(decision.theta, theta, atol=0.02)


def test_columns_that_are_alike_are_ambiguous_with_both() -> None:
    y = columns()
    y[:, 1] = -0.7  # the joint only moves at one speed: viscous friction is an offset
    decision = decide(y, 1.4 * np.ones(len(y)) + noise(len(y)))
    named = {decision.mask, *(mask for mask, _ in decision.rivals)}
    # an offset of 1.4 N·m, or a viscous friction that pushes, which there is not
    assert named == {0b1000}
    decision = decide(y, -1.4 * np.ones(len(y)) + noise(len(y)))
    named = {decision.mask, *(mask for mask, _ in decision.rivals)}
    assert named == {0b1000, 0b0010}


def test_friction_that_pushes_is_not_named() -> None:
    y = columns()
    decision = decide(y, -3.0 * y[:, 0] + noise(len(y)))
    assert decision.mask is None or not decision.mask & 1
    assert decide(y, 3.0 * y[:, 0] + noise(len(y))).mask == 1


def test_a_drive_cannot_be_weaker_than_nothing() -> None:
    y = columns()
    assert decide(y, -1.3 * y[:, 2] + noise(len(y))).mask is None


def test_a_residual_that_no_combination_explains_is_unknown() -> None:
    y = columns()
    t = np.arange(len(y)) * 1e-3
    decision = decide(y, 3.0 * np.sin(2 * np.pi * 5.3 * t))
    assert decision.mask is None
    assert decision.key == -1


def test_more_effects_than_may_appear_at_once_are_not_tried() -> None:
    y = columns()
    r = y @ np.array(list(THETA.values())) + noise(len(y))
    assert decide(y, r).mask == 0b1111
    assert decide(y, r, made(settings=MonitorSettings(most_effects=2))).mask is None


def test_required_effects_stay_and_do_not_count_as_new() -> None:
    y = columns()
    r = 3.0 * y[:, 0] - 2.0 * y[:, 3] + noise(len(y))
    assert decide(y, r, made(settings=MonitorSettings(most_effects=1)), required=1).mask == 0b1001


def test_a_belief_counts_as_if_it_had_been_measured() -> None:
    y = columns(40)  # too short to tell
    prior, centre = np.array([1e9, 0.0, 0.0, 0.0]), np.array([2.5, 0.0, 0.0, 0.0])
    decision = decide(y, 3.0 * y[:, 0] + noise(len(y)), required=1, prior=prior, centre=centre)
    assert decision.theta[0] == pytest.approx(2.5, abs=1e-3)


def test_intervals_of_95_percent_hold_the_truth_in_95_percent() -> None:
    isolator, y, inside = made(), columns(1000), []
    for seed in range(200):
        r = 2.0 * y[:, 1] - 0.3 * y[:, 2] + noise(len(y), seed)
        mask = 0b0110
        theta = np.zeros(4)
        theta[1:3] = np.linalg.lstsq(y[:, 1:3], r, rcond=None)[0]
        low, high = isolator.intervals(mask, theta, gram_of(y, r), LEVEL, 1.0).T
        inside += ((low < [2.0, -0.3]) & (high > [2.0, -0.3])).tolist()
    assert 0.92 < np.mean(inside) < 0.98


# ---------------------------------------------------------------- a friction that the model has


@pytest.fixture(scope="module")
def with_friction() -> Isolator:
    model = Dynamics(ROBOT, (Term(CoulombFriction(ROBOT.joints[0]), (2.0,)),))
    monitor = Monitor(
        model, threshold=dict.fromkeys(ROBOT.joints, 1.0), rate=1000.0, bank=NAMES, settings=SETTINGS
    )
    return monitor.engine.joint_monitors[0].isolation.isolator


@pytest.mark.parametrize(("change", "named"), [(-1.5, True), (1.5, True), (-3.0, False)])
def test_friction_of_the_model_may_decrease_but_not_change_its_sign(
    with_friction, change: float, named: bool
) -> None:
    y = columns()
    decision = decide(y, change * y[:, 0] + noise(len(y)), with_friction)
    assert (decision.mask == 1) is named


def test_on_other_joints_friction_may_not_decrease(with_friction) -> None:
    y = columns()
    gram = gram_of(y, -1.5 * y[:, 0] + noise(len(y)))
    assert with_friction.decide(1, gram, len(y), LEVEL, 100.0).mask != 1


@pytest.mark.parametrize(
    ("ends", "certain"),
    [
        ([(1.0, 3.0), (-2.0, -1.0)], True),
        ([(1.0, 3.0), (-2.0, 1.0)], False),  # nothing may be left of the second effect
        ([(-1.0, 3.0), (0.5, 1.0)], False),
    ],
)
def test_an_effect_whose_interval_holds_zero_is_not_certain(ends, certain: bool) -> None:
    belief = JointBelief(np.array([2.0, -1.0, 0.0, 0.0]), 0b11, ci95=np.array(ends))
    assert belief.is_certain(BANK) is certain


def test_of_an_effect_with_several_parameters_one_must_differ_from_zero() -> None:
    bank = Bank.of(ROBOT, ["joint_spring"])
    assert JointBelief(np.array([1.0, 5.0]), 1, ci95=np.array([(-1.0, 3.0), (4.0, 6.0)])).is_certain(bank)
    assert not JointBelief(np.array([1.0, 5.0]), 1, ci95=np.array([(-1.0, 3.0), (-4.0, 6.0)])).is_certain(
        bank
    )


def test_what_is_certain_to_be_there_is_not_explained_by_nothing() -> None:
    y = columns()
    r = noise(len(y))
    assert decide(y, r).mask == 0
    assert decide(y, r, caused=True).mask != 0
