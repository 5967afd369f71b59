"""A known weight calibrates the joints that it loads; the others get the common scale, with its tolerance."""

from dataclasses import replace

import numpy as np
import pytest

from cdia_pin import load_robot, read_log
from cdia_pin.errors import LogError
from cdia_pin.identification import calibrate_gains
from cdia_pin.logs.gains import read_gains
from tests.hidden_plants import MEASURED
from tests.made_logs import RATE, make

MASS = 3.0  # [kg]
SCALE = np.array([0.95, 0.92, 1.06, 0.97, 1.03, 0.96])  # true over stated torque [1]


@pytest.fixture(scope="module")
def ur5():
    return load_robot("ur5")


def recorded(robot, seed, mass, scale=SCALE):
    """A log of an arm with friction and a point mass on its tool, by Newton's law, whose torques are scaled."""

    def missing(q, v, a):
        jacobian = robot.tool_jacobian(q)[:, :3]
        speed = np.einsum("nij,nj->ni", jacobian, v)
        force = mass * (robot.gravity_vector - np.gradient(speed, 1 / RATE, axis=0, edge_order=2))
        return np.einsum("nij,ni->nj", jacobian, force) - 4 * np.tanh(v / 0.01) - 5 * v

    log = make(robot, missing, seed=seed, duration=30.0, noise=0.1).log
    return replace(log, effort=log.effort / scale)


@pytest.fixture(scope="module")
def calibrated(ur5):
    return calibrate_gains(ur5, [recorded(ur5, 4, MASS)], [recorded(ur5, 3, 0.0)], MASS)


def test_joints_under_the_weight_get_their_scale(calibrated):
    known = calibrated.determined
    assert known[:4].all()
    assert (np.abs(calibrated.scale - SCALE) < calibrated.tolerance)[known].all()
    np.testing.assert_allclose(calibrated.scale[known], SCALE[known], rtol=0.02)
    np.testing.assert_allclose(calibrated.centre, 0.0, atol=0.01)


def test_logs_whose_scales_are_known_well_still_show_the_payload(ur5):
    """After a calibration the next one has less to tell, and the payload is as visible as before."""
    logs = [
        replace(recorded(ur5, k, m, 1.0), effort_tolerance=np.full(ur5.n, 0.01))
        for k, m in ((4, MASS), (3, 0))
    ]
    found = calibrate_gains(ur5, logs[:1], logs[1:], MASS)
    np.testing.assert_allclose(found.scale, 1.0, atol=0.02)


def test_other_joints_have_the_common_scale_and_a_wide_tolerance(calibrated):
    assert not calibrated.determined[5]  # a point on the axis of the last joint does not load it
    assert calibrated.scale[5] == pytest.approx(np.mean(SCALE[:5]), abs=0.05)
    assert calibrated.tolerance[5] > 0.05


def test_the_gains_are_read_back(calibrated, ur5):
    nominal = np.full(ur5.n, 10.0)
    read = read_gains(calibrated.gains(nominal), ur5.joints)
    np.testing.assert_allclose(read.value, 10 * calibrated.scale, rtol=1e-5)
    np.testing.assert_allclose(read.relative_tolerance, calibrated.tolerance / calibrated.scale, rtol=0.01)


def test_a_weight_that_is_not_there_is_refused(ur5):
    empty = recorded(ur5, 3, 0.0)
    with pytest.raises(LogError, match="above 0 kg"):
        calibrate_gains(ur5, [empty], [empty], 0.0)
    with pytest.raises(LogError, match="with the payload and one without"):
        calibrate_gains(ur5, [empty], [], 1.0)


@pytest.mark.parametrize("factor", [0.6, 1.5])
def test_a_gain_far_from_what_was_stated_is_found_and_leaves_the_others(ur5, factor):
    scale = SCALE.copy()
    scale[2] *= factor
    loaded, unloaded = (recorded(ur5, seed, mass, scale) for seed, mass in ((4, MASS), (3, 0.0)))
    found = calibrate_gains(ur5, [loaded], [unloaded], MASS)
    assert found.determined[:4].all()
    np.testing.assert_allclose(found.scale[:4], scale[:4], rtol=0.03)
    assert (np.abs(found.scale - scale) < found.tolerance)[:4].all()


def test_logs_that_do_not_show_the_payload_are_refused(ur5):
    loaded, unloaded, again = (recorded(ur5, seed, mass) for seed, mass in ((4, MASS), (3, 0.0), (5, 0.0)))
    for first, second, mass in [
        (again, unloaded, MASS),
        (unloaded, loaded, MASS),
        (loaded, unloaded, 10 * MASS),
    ]:
        with pytest.raises(LogError, match="is the first log the one with"):
            calibrate_gains(ur5, [first], [second], mass)


def test_two_motions_of_a_measured_arm_give_the_same_gains():
    folder = MEASURED / "ur10e"
    if not folder.is_dir():
        pytest.skip("measured logs are not at ../shared/data; they have other licences and do not ship")
    robot = load_robot(str(folder / "ur10e.urdf"))
    names = ("loaded_2600g", "fourier_40s", "fourier_50s")
    loaded, *unloaded = (
        read_log(folder / f"{n}.csv", robot, gains=folder / "drive_gains.json") for n in names
    )
    one, other = (calibrate_gains(robot, [loaded], [log], 2.6) for log in unloaded)
    apart = np.abs(one.scale - other.scale)
    assert (apart < np.hypot(one.tolerance, other.tolerance)).all()
    assert (apart[1:4] < 0.03).all()
