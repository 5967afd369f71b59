"""The fit of one log, on a plant that is not our model: friction beside a payload, and a gain beside both."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.plant import Fault, MujocoPlant
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Payload, Term
from cdia_pin.fleet import FleetFitSettings
from cdia_pin.fleet.fleet_effects import Role
from cdia_pin.fleet.log_fit import LogFit
from cdia_pin.logs.conditioning import condition
from cdia_pin.regression.experiment import Experiment

LEVELS = (8.0, 8.0, 6.0, 2.0, 2.0, 1.5)  # [N·m]
GAIN = -0.05


@pytest.fixture(scope="module")
def fit():
    plant = MujocoPlant("ur5", step=2e-3)
    joints = plant.joints
    faults = [
        *(Fault("coulomb_friction", joint=j, level=a) for j, a in zip(joints, LEVELS, strict=True)),
        Fault("payload", mass=2.0, com=(0.0, 0.0, 0.05)),
        Fault("actuator_gain", joint="elbow_joint", gain=GAIN),
    ]
    log = plant.run(faults, duration=8.0, rate=100.0, seed=3).log
    experiment = Experiment.of(plant.robot, [condition(log, plant.robot)])
    return LogFit.of(experiment, Dynamics(plant.robot), FleetFitSettings())


def found(fit, label):
    effect = next(e for e, _ in fit.every if e.label == label)
    theta, covariance = fit.difference(effect)
    return theta[0], fit.quantile * np.sqrt(covariance[0, 0])


def test_a_payload_does_not_pass_for_friction(fit):
    mass, _ = found(fit, "payload")
    assert mass == pytest.approx(2.0, abs=0.1)
    for joint, level in zip(fit.robot.joints, LEVELS, strict=True):
        if joint != "elbow_joint":  # whose gain is not fitted here
            value, half = found(fit, f"coulomb_friction@{joint}")
            assert value == pytest.approx(level, abs=max(2 * half, 0.02 * level))


def test_the_load_holds_the_payload_of_the_log(fit):
    payload = Term(Payload(), (2.0, 0.0, 0.0, 0.1, 0.005, 0.0, 0.005, 0.0, 0.0, 0.0))
    motion = fit.motion
    q, v, a = motion.q[motion.kept], motion.v[motion.kept], motion.a[motion.kept]

    def load(model):
        return np.sqrt(np.mean(model.inverse_dynamics(q, v, a) ** 2, axis=0))

    empty, loaded = load(Dynamics(fit.robot)), load(Dynamics(fit.robot, (payload,)))
    lift = fit.robot.joints.index("shoulder_lift_joint")
    assert loaded[lift] > 1.1 * empty[lift]
    assert fit.load[lift] == pytest.approx(loaded[lift], rel=0.02)


def test_a_gain_that_is_looked_for_scales_friction_and_payload_too(fit):
    gain, half = found(fit, "actuator_gain@elbow_joint")
    assert gain == pytest.approx(GAIN, abs=max(2 * half, 0.005))
    effect = next(e for e, _ in fit.every if e.label == "actuator_gain@elbow_joint")
    assert fit.is_named(effect)


def test_roles_and_what_the_motion_cannot_show(fit):
    roles = {e.label: role for e, role in fit.every}
    assert roles["payload"] is Role.JOB
    assert roles["coulomb_friction@elbow_joint"] is Role.USUAL
    assert roles["actuator_gain@elbow_joint"] is Role.SEARCHED
    zero_of_base = next(e for e, _ in fit.every if e.label == "encoder_offset@shoulder_pan_joint")
    assert fit.why_not_shown(zero_of_base)  # nothing depends on where the base is turned to
