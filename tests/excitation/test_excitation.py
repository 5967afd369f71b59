"""A designed motion keeps every limit, touches nothing, and is the same again with the same seed."""

import numpy as np
import pytest

from cdia_pin import Dynamics, Excitation, ExcitationSettings, excite, load_robot, read_log
from cdia_pin.effects import parse_effect, parse_term
from cdia_pin.errors import RobotError
from cdia_pin.robot.collision import CollisionModel
from cdia_pin.viewers.text_excitation import limits_table
from tests.narrow_terminals import loses_nothing

QUICK = ExcitationSettings(duration=12.0, draws=4, refinements=8)
RATE = 250.0  # [Hz]


@pytest.fixture(scope="module", params=["ur5", "panda"])
def designed(request):
    return excite(load_robot(request.param), settings=QUICK)


@pytest.fixture(scope="module")
def exported(designed, tmp_path_factory):
    """Columns of the CSV file by name."""
    file = designed.to_csv(tmp_path_factory.mktemp("excite") / "motion.csv")
    table = np.genfromtxt(file, delimiter=",", names=True, deletechars="")
    signal = lambda name: np.column_stack([table[f"{name}.{j}"] for j in designed.joints])  # noqa: E731
    return {"time": table["time"]} | {
        s: signal(s) for s in ("position", "velocity", "acceleration", "effort")
    }


def test_it_is_as_long_and_as_fine_as_was_asked(exported):
    np.testing.assert_allclose(np.diff(exported["time"]), 1 / RATE, atol=1e-8)
    assert exported["time"][0] == 0.0
    assert exported["time"][-1] == pytest.approx(QUICK.duration)


def test_positions_are_within_the_urdfs_limits(designed, exported):
    limits = designed.robot.limits
    assert (exported["position"] > limits.lower).all()
    assert (exported["position"] < limits.upper).all()


def test_speeds_and_accelerations_of_the_samples_are_within_their_limits(designed, exported):
    """By finite differences of what a controller is given, not by what the design says of itself."""
    v = np.diff(exported["position"], axis=0) * RATE
    a = np.diff(exported["position"], 2, axis=0) * RATE**2
    rounding = 4e-9 * RATE**2
    assert (np.abs(v) <= QUICK.speed * designed.robot.limits.velocity + 1e-6).all()
    assert (np.abs(a) <= designed.limits.acceleration + rounding).all()
    middle = exported["velocity"][:-1] + np.diff(exported["velocity"], axis=0) / 2
    np.testing.assert_allclose(v, middle, atol=1e-3)
    np.testing.assert_allclose(a, exported["acceleration"][1:-1], atol=0.02)


def test_efforts_of_the_rigid_body_are_within_their_limits(designed, exported):
    robot = designed.robot
    tau = robot.inverse_dynamics(exported["position"], exported["velocity"], exported["acceleration"])
    assert (np.abs(tau) <= QUICK.effort * robot.limits.effort).all()
    np.testing.assert_allclose(tau, exported["effort"], atol=1e-5)


def test_it_begins_and_ends_at_rest(exported):
    for end in (0, -1):
        for signal in ("velocity", "acceleration"):
            np.testing.assert_allclose(exported[signal][end], 0.0, atol=1e-8)
    np.testing.assert_allclose(exported["position"][0], exported["position"][-1], atol=1e-8)


def test_no_sample_touches_anything(designed, exported):
    shapes = CollisionModel(designed.robot, clearance=0.5 * QUICK.clearance, floor=designed.floor)
    assert shapes.first_contact(exported["position"]) is None
    assert designed.checked == len(shapes.pairs) > 0


def test_every_joint_moves(exported):
    assert (np.ptp(exported["position"], axis=0) > 0.05).all()


def test_it_shows_more_than_the_first_motion_drawn(designed):
    assert designed.gain.between == ()
    assert designed.gain.after > 1.0
    seen, count = designed.gain.seen
    assert 0 < seen < count  # the first link's mass is seen by nothing


def test_a_log_of_it_can_be_read(designed, exported, tmp_path):
    log = read_log(designed.to_csv(tmp_path / "motion.csv"), designed.robot)
    np.testing.assert_allclose(log.position, exported["position"])
    np.testing.assert_allclose(log.effort, exported["effort"])


def test_a_ros_trajectory_is_the_same_motion(designed, tmp_path):
    yaml = pytest.importorskip("ruamel.yaml", reason="rosbags brings ruamel.yaml")
    file = designed.to_ros(tmp_path / "motion.yaml", rate=50.0)
    message = yaml.YAML(typ="safe").load(file)
    assert message["joint_names"] == list(designed.joints)
    stamps = [p["time_from_start"] for p in message["points"]]
    time = np.array([s["sec"] + 1e-9 * s["nanosec"] for s in stamps])
    assert (np.diff(time) > 0).all()
    assert all(0 <= s["nanosec"] < 10**9 and isinstance(s["sec"], int) for s in stamps)
    points = [[p[k] for p in message["points"]] for k in ("positions", "velocities", "accelerations")]
    np.testing.assert_allclose(points, designed.trajectory(time), atol=1e-8)
    assert all("effort" not in p for p in message["points"])


def pendulum(**changed) -> Excitation:
    settings = ExcitationSettings(**{"duration": 8.0, "draws": 3, "refinements": 4} | changed)
    return excite(load_robot("double_pendulum"), settings=settings)


def test_a_seed_makes_it_repeatable():
    one, same, other = (pendulum(seed=s) for s in (1, 1, 2))
    assert np.array_equal(one.position, same.position)
    assert one.gain == same.gain
    assert not np.array_equal(one.position, other.position)


def test_more_search_is_never_worse():
    few, many = (pendulum(draws=10, refinements=n) for n in (0, 40))
    assert many.gain.after >= few.gain.after


def test_limits_that_are_asked_for_are_kept():
    motion = pendulum(speed=0.2, acceleration={"joint2": 0.5})
    peaks = motion.peaks()
    assert (peaks["velocity"] <= 0.2 * 3.0).all()
    assert peaks["acceleration"][1] <= 0.5


def test_a_floor_keeps_the_arm_above_it():
    robot = load_robot("ur5")
    motion = excite(robot, settings=ExcitationSettings(duration=8.0, draws=2, refinements=2, floor=0.01))
    heights = robot.joint_placements(motion.position)[:, 2:, 2, 3]
    assert heights.min() > 0.01
    assert motion.floor == 0.01


def test_terms_of_the_model_count_for_the_effort():
    robot = load_robot("panda")
    light = ExcitationSettings(duration=8.0, draws=2, refinements=0)
    payload = parse_term("payload: mass=2.5", robot)
    motion = excite(Dynamics(robot, (payload,)), settings=light)
    tau = Dynamics(robot, (payload,)).inverse_dynamics(*motion.reference)
    assert (np.abs(tau) <= motion.limits.effort).all()
    assert motion.gain.seen[1] == 10  # the parameters of what the model has


def test_an_arm_that_cannot_hold_itself_is_refused():
    robot = load_robot("panda")
    heavy = Dynamics(robot, (parse_term("payload: mass=60", robot),))
    with pytest.raises(RobotError, match="effort limits"):
        excite(heavy, settings=QUICK)


def test_a_floor_too_high_is_refused():
    with pytest.raises(RobotError, match=r"no posture is free of contact.*floor"):
        excite(load_robot("ur5"), settings=ExcitationSettings(floor=3.0))


def test_progress_goes_from_nothing_to_all():
    shares = []
    excite(
        load_robot("double_pendulum"),
        effects=[parse_effect("coulomb_friction@joint1")],
        settings=ExcitationSettings(duration=8.0, draws=2, refinements=2),
        progress=lambda sentence, share: shares.append(share),
    )
    assert shares[0] == 0.0
    assert shares[-1] == 1.0
    assert shares == sorted(shares)


def test_its_table_loses_no_limit_in_a_narrow_terminal(designed):
    loses_nothing(limits_table(designed))
