"""How sgn q̇ is smoothed and filtered must not turn one friction into another."""

import numpy as np
import pytest

from benchmarks.plant import Fault, Noise, PointToPoint
from benchmarks.plant.motion import Fourier
from cdia_pin import Dynamics, discover, load_robot
from tests.hidden_plants import labels, plant_of
from tests.made_logs import make

ELBOW = "elbow_joint"


@pytest.fixture(scope="module")
def pendulum():
    return load_robot("double_pendulum")


def coulomb(q, v, a):
    return np.column_stack([-0.1 * np.sign(v[:, 0]), -0.04 * np.sign(v[:, 1])])


@pytest.mark.parametrize("noise", [0.001, 0.003, 0.006])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_coulomb_is_called_coulomb_at_any_noise(seed, noise, pendulum):
    found = discover(Dynamics(pendulum), make(pendulum, coulomb, noise=noise, seed=seed, duration=30.0).log)
    assert labels(found) == {f"coulomb_friction@{j}" for j in pendulum.joints}
    assert found.verdict == "explained"
    values = {s.term.label: s.term.theta[0] for s in found.steps}
    assert values == pytest.approx(
        {"coulomb_friction@joint1": 0.1, "coulomb_friction@joint2": 0.04}, rel=0.03
    )


@pytest.mark.parametrize(
    ("motion", "noise"),
    [
        (Fourier(), Noise(position_resolution=2e-4)),
        (Fourier(speed=0.15), Noise()),
        (PointToPoint(), Noise()),
    ],
    ids=["coarse encoders", "slow", "point to point"],
)
def test_coulomb_is_called_coulomb_on_poor_logs(motion, noise):
    plant = plant_of("ur5")
    run = plant.run([Fault("coulomb_friction", joint=ELBOW, level=3.0)], motion=motion, noise=noise, seed=4)
    found = discover(Dynamics(plant.robot), run.log)
    assert labels(found) == {f"coulomb_friction@{ELBOW}"}
    assert found.steps[0].term.theta[0] == pytest.approx(3.0, rel=0.03)


@pytest.mark.parametrize(
    ("decay", "motion"), [(4.0, PointToPoint()), (15.0, Fourier())], ids=["point to point", "sines"]
)
def test_a_wide_stribeck_curve_is_found_with_its_shape_and_size(decay, motion):
    plant = plant_of("ur5")
    fault = Fault("stribeck_friction", joint=ELBOW, level=2.0, breakaway=3.0, decay=decay)
    found = discover(Dynamics(plant.robot), plant.run([fault], motion=motion, seed=4).log)
    assert labels(found) == {f"stribeck_friction@{ELBOW}"}
    term = found.steps[0].term
    assert term.effect.decay == pytest.approx(decay, rel=0.15)
    assert term.values["level"] == pytest.approx(2.0, rel=0.03)
