"""The jump at reversals tells on which side of the gear a torque was measured, and what is searched for."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.recordings import libfranka, write
from cdia_pin import Dynamics, discover, load_robot, read_log
from cdia_pin.cli.inputs import Reading, read_logs
from cdia_pin.effects import Term, parse_effect
from cdia_pin.errors import LogError
from cdia_pin.identification.terms import full_model
from cdia_pin.logs import check_log, write_log
from cdia_pin.logs.conditioning import condition
from cdia_pin.logs.torque_side import TorqueSide, side_of_all
from cdia_pin.regression.experiment import Experiment
from cdia_pin.selection import DiscoverySettings
from cdia_pin.selection.candidates import enumerate_candidates
from tests.hidden_plants import MEASURED
from tests.made_logs import make


@pytest.fixture(scope="module")
def panda():
    return load_robot("panda")


def logged(robot, share):
    """A log whose joints have dry friction of a share of their torque limit."""
    friction = share * robot.limits.effort
    return make(robot, lambda q, v, a: -friction * np.tanh(v / 0.01), seed=2, noise=0.02).log


def told(robot, log):
    (finding,) = check_log(log, robot).about("torque_side")
    return finding.value["side"]


@pytest.mark.parametrize(("share", "side"), [(0.05, "motor"), (0.004, "link"), (0.0, "unknown")])
def test_friction_beside_the_torque_limit_tells_the_side(panda, share, side):
    assert told(panda, logged(panda, share)) == side


def test_friction_that_is_not_seen_has_no_size(panda):
    (none,) = check_log(logged(panda, 0.0), panda).about("torque_side")
    assert "no jump at reversals shows dry friction" in none.message
    part = 0.004 * np.array([0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0])  # of the torque limits
    (some,) = check_log(logged(panda, part), panda).about("torque_side")
    assert "-" not in some.message.partition("dry friction of")[2].partition("%")[0]


def test_a_current_that_is_called_a_torque_is_not_taken_for_a_sensor_behind_the_gear(panda):
    log = logged(panda, 0.05)
    current = replace(log, effort=0.05 * log.effort)
    assert told(panda, current) == "unknown"
    assert "coulomb_friction" in offered(panda, current)


def offered(robot, log):
    experiment = Experiment.of(robot, [condition(log, robot)])
    families = enumerate_candidates(experiment, experiment.predict(Dynamics(robot)), DiscoverySettings())
    return {f[0].name for f in families}


def test_behind_the_gear_no_friction_of_the_motor_and_no_rotor_is_offered(panda):
    behind, before = (offered(panda, logged(panda, share)) for share in (0.004, 0.05))
    assert {"coulomb_friction", "coupled_friction", "presliding_friction", "rotor_inertia"} <= before - behind
    assert {"torque_offset", "payload", "joint_spring"} <= behind
    assert "bearing_friction" in behind - before


def test_behind_the_gear_the_friction_of_bearings_is_found(panda):
    level = 0.004 * panda.limits.effort
    found = discover(Dynamics(panda), logged(panda, 0.004)).model
    sizes = {t.effect.scope[0]: t.theta[0] for t in found.terms if t.effect.name == "bearing_friction"}
    assert {t.effect.name for t in found.terms} == {"bearing_friction"}
    assert list(sizes.values()) == pytest.approx([level[panda.joint_index(j)] for j in sizes], rel=0.1)
    assert len(sizes) >= 5  # of a joint that carries much, it hardly shows


def test_what_the_user_says_counts_more_than_what_the_log_shows(panda, tmp_path):
    file = write_log(logged(panda, 0.05), tmp_path / "run.csv")
    log = read_log(file, panda, torque_side="link")
    assert log.torque_side is TorqueSide.LINK
    assert any("behind the gear" in note for note in log.notes)
    assert "coulomb_friction" not in offered(panda, log)
    (finding,) = check_log(log, panda).about("torque_side")
    assert finding.severity == "warning" and "looks like the motor side" in finding.message
    with pytest.raises(LogError, match="side of the torque sensor"):
        read_log(file, panda, torque_side="left")


@pytest.mark.parametrize(("share", "looked_for"), [(0.02, True), (0.004, False), (0.0, False)])
def test_a_format_counts_less_than_friction_that_the_log_shows(panda, tmp_path, share, looked_for):
    made = logged(panda, share)
    moving = replace(made, velocity=np.gradient(made.position, made.time, axis=0))
    file = write(tmp_path / "franka.csv", libfranka(moving))
    log = read_log(file, panda)
    assert log.torque_side is TorqueSide.LINK
    assert ("coulomb_friction" in offered(panda, log)) == looked_for
    assert ("coulomb_friction" in offered(panda, read_log(file, panda, torque_side="link"))) is False
    (finding,) = check_log(log, panda).about("torque_side")
    assert (finding.value["side"] == "unknown") == looked_for
    assert ("--torque-side link" in finding.advice) == looked_for


@pytest.mark.parametrize(
    ("log", "robot", "gains", "side"),
    [
        ("kuka_lwr4/exciting.csv", "kuka_lwr4/kuka_lwr4.urdf", None, "link"),
        ("ur10/exciting.csv", "ur10", None, "motor"),
        ("ur10e/fourier_40s.csv", "ur10e/ur10e.urdf", "ur10e/drive_gains.json", "motor"),
        (
            "panda/exciting.csv",
            "panda",
            None,
            "unknown",
        ),  # sensors behind gears, on bearings with much friction
        (
            "double_pendulum/swing_1.csv",
            "double_pendulum/double_pendulum.urdf",
            None,
            "unknown",
        ),  # two joints
    ],
)
def test_measured_arms(log, robot, gains, side):
    if not MEASURED.is_dir():
        pytest.skip("measured logs are not at ../shared/data; they have other licences and do not ship")
    arm = load_robot(str(MEASURED / robot) if robot.endswith(".urdf") else robot)
    read = read_log(MEASURED / log, arm, gains=gains and MEASURED / gains)
    assert told(arm, read) == side


@pytest.mark.parametrize(
    ("share", "said"),
    [(0.05, ""), (0.013, "cannot be told"), (0.004, "taken as measured behind the gear"), (0.0, "")],
)
def test_a_command_says_what_it_assumes_of_the_side(panda, tmp_path, share, said):
    file = write_log(logged(panda, share), tmp_path / "run.csv")
    (log,), _ = read_logs([file], panda, Reading(), check=True, tell=lambda what, done: None)
    notes = [note for note in log.notes if "side" in note]
    assert [said in note for note in notes] == ([True] if said else [])


def test_temperatures_are_read_and_written(panda, tmp_path):
    log = logged(panda, 0.0)
    warm = 20 + np.outer(np.linspace(0, 10, len(log.time)), np.ones(panda.n))
    for suffix in ("csv", "npz"):
        again = read_log(write_log(replace(log, temperature=warm), tmp_path / f"warm.{suffix}"), panda)
        np.testing.assert_allclose(again.temperature, warm)
    assert read_log(write_log(log, tmp_path / "plain.csv"), panda).temperature is None


def test_friction_that_is_surely_small_speaks_for_a_sensor_behind_the_gear_too():
    from cdia_pin.logs.side_evidence import JointFriction, SideEvidence

    def seen(dry, error):
        return JointFriction(dry, error, 0.0, 1.0, 0.0, 1.0, limit=100.0)

    shown, bounded, open_ended = seen(0.3, 0.05), seen(0.1, 0.1), seen(0.3, 0.6)
    assert SideEvidence({"a": shown, "b": shown, "c": bounded, "d": bounded}).side == "link"
    assert SideEvidence({"a": shown, "b": shown, "c": open_ended, "d": open_ended}).side == "unknown"
    assert SideEvidence({"a": shown, "b": bounded, "c": bounded, "d": bounded}).side == "unknown"


@pytest.mark.parametrize(
    ("sides", "together"),
    [
        ("", "unknown"),
        ("link", "link"),
        ("link unknown", "link"),
        ("link motor", "unknown"),
        ("motor", "motor"),
    ],
)
def test_several_logs_are_of_one_side_if_none_contradicts(sides, together):
    assert side_of_all(map(TorqueSide, sides.split())) == together


def test_a_format_that_its_log_belies_is_not_remembered(panda):
    motion = condition(logged(panda, 0.05), panda)
    said = replace(motion, torque_side=TorqueSide.LINK, side_of_format=True)
    (kept,) = Experiment.of(panda, [said]).remembered()
    assert (kept.torque_side, kept.side_of_format) == (TorqueSide.UNKNOWN, False)
    (shown,) = Experiment.of(panda, [condition(logged(panda, 0.004), panda)]).remembered()
    assert shown.torque_side is TorqueSide.LINK


FRICTION_OF = {
    TorqueSide.MOTOR: ("coulomb_friction@panda_joint4", "viscous_friction@panda_joint4"),
    TorqueSide.LINK: ("bearing_friction@panda_joint4",),
}


@pytest.mark.parametrize("known", [None, *FRICTION_OF])
@pytest.mark.parametrize("side", FRICTION_OF)
def test_an_identification_has_friction_of_one_side_of_each_gear(panda, side, known):
    motion = replace(condition(logged(panda, 0.02), panda), torque_side=side)
    given = FRICTION_OF[known] if known else ()
    terms = [Term(e, (0.1,) * e.size) for e in (parse_effect(label, panda) for label in given)]
    model = full_model(Dynamics(panda, tuple(terms)), Experiment.of(panda, [motion]))
    labels = {t.label for t in model.terms}
    assert {x for x in labels if "friction@panda_joint4" in x} == set(FRICTION_OF[known or side])
    assert {x for x in labels if "friction@panda_joint2" in x} == {
        label.replace("joint4", "joint2") for label in FRICTION_OF[side]
    }
    assert ("rotor_inertia@panda_joint2" in labels) == (side is TorqueSide.MOTOR)
