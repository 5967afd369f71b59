"""The benchmark on measured logs: what it compares, on logs made in the open."""

import numpy as np
import pytest

from benchmarks.measured_logs.cases import Case, halves
from benchmarks.measured_logs.errors import Bench
from benchmarks.measured_logs.least_squares import least_squares
from benchmarks.measured_logs.measuring import Measured
from benchmarks.measured_logs.page import page, skipped
from benchmarks.measured_logs.trust import FRICTION, Cause, causes, sentences
from benchmarks.peers.figaroh_process import AbsentError, figaroh
from cdia_pin import Dynamics, load_robot
from tests.made_logs import make

NOISE = 0.01


def friction(q, v, a):
    return -0.3 * np.tanh(v / 1e-3)


@pytest.fixture(scope="module")
def bench():
    robot = load_robot("double_pendulum")
    fitted, unseen = (make(robot, friction, seed=s, noise=NOISE, duration=30.0).log for s in (1, 2))
    return Bench.of(Case("made", "pendulum", "double_pendulum", robot, fitted, unseen, (50.0, 50.0)), 10.0)


def test_halves_share_no_sample(bench):
    log = bench.case.fitted
    first, second = halves(log)
    assert len(first.time) + len(second.time) == len(log.time)
    assert first.time[-1] < second.time[0]
    assert first.duration == pytest.approx(second.duration, abs=0.02)


def test_least_squares_predicts_down_to_the_noise(bench):
    column = least_squares(bench)
    urdf = bench.column("URDF", Dynamics(bench.case.robot))
    torque = np.sqrt(np.mean(bench.unseen.measured**2, axis=0))
    assert (column.moving * torque < 2 * NOISE).all()
    assert (column.moving < 0.2 * urdf.moving).all()


def test_both_logs_lack_the_friction_that_they_were_made_with(bench):
    found = causes(bench)
    trusted = {c.joint for c in found if c.kind == FRICTION and c.trusted}
    assert trusted == set(bench.case.robot.joints)
    (said, *_) = sentences("pendulum", found, {j: j for j in bench.case.robot.joints})
    assert said.startswith("Both logs of the pendulum say that its URDF lacks friction of the joint (joint1 ")


def test_answers_that_differ_are_not_trusted():
    far = Cause("rotor inertia", "elbow", 0.05, 0.8)
    (said,) = sentences("arm", [far], {"elbow": "elbow"})
    assert said == "Not to be trusted: rotor inertia (elbow 5 % of the torque; the two differ by 80 % of it)."


def test_figaroh_says_why_it_is_absent(bench):
    with pytest.raises(AbsentError, match=r"^its interpreter does not start \(No such file or directory\)$"):
        figaroh(bench, "/no/such/python")


def test_a_page_counts_joints_and_names_who_was_absent(bench):
    urdf = bench.column("URDF", Dynamics(bench.case.robot))
    fitted = least_squares(bench)
    ours = bench.left("cdia identify", 0.3 * np.ones_like(bench.unseen.measured) * NOISE)
    measured = Measured(bench, (urdf, fitted, ours), absent="no figaroh here")
    said = page([measured], {"made": []})
    assert "| full least squares, moving | 10 Hz | 2 of 2 | 2 of 2 | yes |" in said
    assert "figaroh took no part in made: no figaroh here." in said
    assert "Skipped" in skipped()
