"""A change that depends on the torque is as large as it is, not as large as its column at the average of both logs."""

from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks.plant import Fault
from cdia_pin import Dynamics, load_robot, what_changed
from cdia_pin.changes.confidence import Confidence
from cdia_pin.changes.linearisation import sized_about_themselves
from cdia_pin.effects import EncoderOffset
from cdia_pin.logs import Log
from tests.changes.test_changes import WRONG, changed, the_only
from tests.made_logs import motion


@pytest.mark.parametrize("gain", [-0.25, 0.35])
def test_a_motor_that_lost_a_quarter_of_its_torque_lost_a_quarter(gain):
    # at the average of both logs it would be g / (1 + g / 2): -0.29 and 0.30
    change = the_only(changed(WRONG, (*WRONG, Fault("actuator_gain", joint="elbow_joint", gain=gain))))
    assert change.term.label == "actuator_gain@elbow_joint"
    assert change.term.values["gain"] == pytest.approx(gain, rel=0.03)


def test_friction_under_load_is_as_large_as_it_is():
    worn = (*WRONG, Fault("load_friction", joint="shoulder_lift_joint", coefficient=0.25))
    change = the_only(changed(WRONG, worn))
    assert change.term.label == "load_friction@shoulder_lift_joint"
    assert change.term.values["coefficient"] == pytest.approx(0.25, rel=0.04)


@pytest.mark.parametrize(("per_step", "ends_at"), [(1.5, 1.0), (2.5, 2.2)], ids=["settles", "diverges"])
def test_the_first_step_may_be_too_long_and_the_last_may_not(per_step, ends_at):
    """Steps about a size of 1 from 2.2, where the model fits worse than without the change."""

    def about(changes):
        ((size,),) = changes.values()
        step = np.array([-per_step * (size - 1.0)])
        estimate = (step, np.array([[1e-4]]))
        evidence = SimpleNamespace(estimate=lambda _: estimate, left=10 * (size - 1.0) ** 2)
        return SimpleNamespace(evidence=lambda: evidence)

    search = SimpleNamespace(
        evidence=SimpleNamespace(
            effects=[EncoderOffset("joint1")],
            estimate=lambda _: (np.array([2.2]), np.array([[1e-4]])),
            left=10.0,
        ),
        differing=SimpleNamespace(about=about),
    )
    assert sized_about_themselves(search, (0,)).theta == pytest.approx(ends_at, abs=0.01)


@pytest.mark.parametrize(("joint", "zero"), [("joint1", 0.1), ("joint2", -0.15)])
@pytest.mark.parametrize("seeds", [(5, 6), (7, 8)])
def test_a_zero_is_as_large_as_it_is_though_the_urdf_weighs_too_little_and_a_ripple_has_moved_too(
    joint, zero, seeds
):
    robot = load_robot("double_pendulum")
    heavier = robot.with_inertial_parameters(1.6 * robot.inertial_parameters)
    logs = []
    for name, seed, offset in zip(("a.csv", "b.csv"), seeds, (0.0, zero), strict=True):
        t, q, v, a = motion(robot.n, seed, duration=24.0)
        effort = heavier.inverse_dynamics(q, v, a)
        effort[:, 0] += 0.1 * np.sin(30.0 * q[:, 0])
        effort += np.random.default_rng(seed).normal(0.0, 0.003, effort.shape)
        read = q.copy()
        read[:, robot.joint_index(joint)] -= offset
        logs.append(Log(robot.joints, t, read, effort, source=name))
    by_label = {c.term.label: c for c in what_changed(Dynamics(robot), *logs).changes}
    term = by_label.pop(f"encoder_offset@{joint}").term
    assert term.theta[0] == pytest.approx(zero, rel=0.01)
    assert set(by_label) <= {f"position_ripple@{joint}"}  # in what is read, the ripple is elsewhere too
    assert all(c.confidence is Confidence.LIKELY for c in by_label.values())
