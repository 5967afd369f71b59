"""The columns of a large family of shapes are those of the present model, whatever they are."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest

from cdia_pin import Dynamics, load_robot
from cdia_pin.effects import CoulombFriction, JointEffect, Parameter, PositionRipple, Signal, Term, Traits
from cdia_pin.regression.design_matrix import DesignMatrix
from cdia_pin.regression.experiment import Experiment
from cdia_pin.regression.noise import NoiseModel
from tests.made_logs import conditioned, make

RUBBING = Term(CoulombFriction("joint1"), (0.5,))


@dataclass(frozen=True)
class Knee(JointEffect):
    """Friction of the torque beyond a knee."""

    knee: float = 1.0

    name: ClassVar[str] = "knee"
    equation: ClassVar[str] = "−μ max(|τ| − k, 0) sgn(q̇)"
    traits: ClassVar[Traits] = Traits({Signal.TORQUE, Signal.DIRECTION}, dissipative=True)
    parameters = (Parameter("share", "1", lower=0.0),)
    shape = (Parameter("knee", "{effort}", lower=1e-3),)

    def columns(self, x):
        return (-np.maximum(np.abs(x.effort) - self.knee, 0.0) * x.sign,)


@pytest.fixture(scope="module")
def experiment():
    robot = load_robot("double_pendulum")
    return Experiment.of(robot, [conditioned(robot, make(robot, noise=0.01))])


@pytest.fixture(scope="module")
def noise(experiment):
    count = len(experiment.measured)
    return NoiseModel(np.zeros(0), np.full(count, 0.01), (count,))


def family_of(design, family, noise, *terms):
    return design.family(family, design.experiment.predict(Dynamics(design.experiment.robot, terms)), noise)


def test_a_family_that_depends_on_the_torque_follows_the_model(experiment, noise):
    family, design = [Knee("joint1", k) for k in (0.1, 0.2, 0.4)], DesignMatrix(experiment)
    before = family_of(design, family, noise)[0]
    after = family_of(design, family, noise, RUBBING)[0]
    assert np.abs(after - before).max() > 0.1 * np.abs(before).max()
    np.testing.assert_array_equal(after, family_of(DesignMatrix(experiment), family, noise, RUBBING)[0])


def test_a_family_that_depends_on_the_motion_alone_is_kept(experiment, noise):
    family, design = [PositionRipple("joint1", w) for w in (6.0, 8.0, 10.0)], DesignMatrix(experiment)
    assert family_of(design, family, noise)[0] is family_of(design, family, noise, RUBBING)[0]


def test_a_shape_that_the_motion_does_not_show_explains_nothing(experiment, noise):
    family = [Knee("joint1", k) for k in (0.1, 1e6)]
    white, inverse = family_of(DesignMatrix(experiment), family, noise)
    right = white.sum(axis=2)
    shown, hidden = np.einsum("cp,cpq,cq->c", right, inverse, right)
    assert shown > 0
    assert hidden == 0
