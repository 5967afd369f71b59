"""The plant against Pinocchio and against the table of effects: M q̈ + nle = τ + f, f as stated."""

import ast
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from scipy.integrate import cumulative_trapezoid
from scipy.interpolate import CubicSpline, make_interp_spline

from cdia_pin.errors import EffectError
from cdia_pin.robot import RobotModel, load_robot

pytest.importorskip("mujoco")

import benchmarks.plant
from benchmarks import demo_log
from benchmarks.plant import (
    CLEAN,
    MECHANISMS,
    OUTSIDE,
    VOCABULARY,
    Fault,
    Fourier,
    MujocoPlant,
    Noise,
    PointToPoint,
    Truth,
    cache,
    single,
)
from benchmarks.plant.scenarios import RECIPES, clean, outside, pairs, singles, triples
from benchmarks.plant.sizes import Sizer

ROBOTS = ("ur5", "ur10", "panda", "xarm7", "kinova", "z1", "so101", "scara")
MOVING = 0.03  # [rad/s], above which a joint has left its last step of stiction

Array = np.ndarray
Formula = Callable[[RobotModel, Truth], Array]


@pytest.fixture(scope="module")
def plants() -> Callable[[str], MujocoPlant]:
    made: dict[str, MujocoPlant] = {}
    return lambda name: made.setdefault(name, MujocoPlant(name))


@pytest.fixture(autouse=True)
def cache_elsewhere(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cache, "HOME", tmp_path_factory.getbasetemp() / "cache" / "plant")


def missing_torque(robot: RobotModel, truth: Truth) -> Array:
    """Return f = rnea(truth) − τ."""
    return robot.inverse_dynamics(truth.position, truth.velocity, truth.acceleration) - truth.effort


# ---------------------------------------------------------------- without faults


@pytest.mark.parametrize("name", ROBOTS)
def test_rigid_body_torque_is_pinocchios(name: str, plants) -> None:
    robot, plant = load_robot(name), plants(name)
    q, v, a = np.random.default_rng(0).uniform(-2, 2, (3, 50, robot.n))
    expected = robot.inverse_dynamics(q, v, a)
    error = np.abs(plant.nominal.inverse_dynamics(q, v, a) - expected).max()
    assert error < 1e-11 * np.abs(expected).max()
    np.testing.assert_allclose(plant.nominal.mass_matrix(q[0]), robot.mass_matrix(q[0]), rtol=0, atol=1e-10)


@pytest.mark.parametrize("name", ROBOTS)
def test_plant_without_faults_lacks_nothing(name: str, plants) -> None:
    truth = plants(name).run(duration=2, noise=CLEAN).truth
    robot = load_robot(name)
    assert np.abs(missing_torque(robot, truth)).max() < 1e-9
    np.testing.assert_allclose(truth.position, truth.reference, atol=1e-4)


def test_positions_velocities_and_torques_belong_to_one_instant(plants) -> None:
    """From recorded positions alone the recorded torque follows, with no lag and no false inertia."""
    robot = load_robot("ur5")
    fault = Fault("viscous_friction", joint="elbow_joint", coefficient=8.0)
    run = plants("ur5").run([fault], duration=8, rate=500, noise=CLEAN)
    log = run.log
    spline = make_interp_spline(log.time, log.position, k=7)
    v, a = spline(log.time, 1), spline(log.time, 2)
    inner = np.s_[50:-50]
    f = (robot.inverse_dynamics(log.position, v, a) - log.effort)[inner, 2]
    rate = np.gradient(log.effort[:, 2], log.time)[inner]
    columns = np.column_stack([-v[inner, 2], -a[inner, 2], rate])
    coefficient, inertia, lag = np.linalg.lstsq(columns, f, rcond=None)[0]
    assert coefficient == pytest.approx(8.0, abs=1e-3)
    assert abs(inertia) < 1e-4  # [kg·m²]
    assert abs(lag) < 2e-6  # [s]


def test_error_of_integration_is_of_second_order() -> None:
    fault = Fault("viscous_friction", joint="elbow_joint", coefficient=8.0)
    ends = []
    for step in (2e-3, 1e-3, 5e-4):
        run = MujocoPlant("ur5", step=step).run([fault], duration=3, rate=125, noise=CLEAN, keep=False)
        ends.append(missing_from_positions(load_robot("ur5"), run.log) + 8.0 * run.truth.velocity[:, 2])
    coarse, fine = (np.abs(e[40:-40]).max() for e in (ends[0] - ends[2], ends[1] - ends[2]))
    assert coarse / fine == pytest.approx(5.0, rel=0.3)  # (4² − 1)/(2² − 1) for second order, 3 for first


def missing_from_positions(robot: RobotModel, log) -> Array:
    spline = make_interp_spline(log.time, log.position, k=7)
    motion = spline(log.time), spline(log.time, 1), spline(log.time, 2)
    return (robot.inverse_dynamics(*motion) - log.effort)[:, 2]


# ---------------------------------------------------------------- one fault at a time


def on_joint(j: int, of: Callable[[Array, Array, Array, Array, Truth], Array]) -> Formula:
    """Return a formula f(q, q̇, q̈, τ, truth) on one joint."""

    def formula(robot: RobotModel, t: Truth) -> Array:
        out = np.zeros_like(t.position)
        out[:, j] = of(t.position[:, j], t.velocity[:, j], t.acceleration[:, j], t.effort[:, j], t)
        return out

    return formula


def coupled(robot: RobotModel, t: Truth) -> Array:
    s = t.velocity[:, 1] + t.velocity[:, 2]
    out = np.zeros_like(t.position)
    out[:, 1] = out[:, 2] = -2.0 * s - 1.5 * np.sign(s)
    return out


def tilted(robot: RobotModel, t: Truth) -> Array:
    g = robot.gravity_vector
    tilted_g = np.array([0.8, -0.5, -np.sqrt(g @ g - 0.8**2 - 0.5**2)])
    return -robot.gravity_regressor(t.position) @ (tilted_g - g)


def pulled(robot: RobotModel, t: Truth) -> Array:
    wrench = np.array([5.0, -3.0, 2.0, 0.3, 0.2, -0.1])
    return np.einsum("kij,i->kj", robot.tool_jacobian(t.position), wrench)


def immersed(robot: RobotModel, t: Truth) -> Array:
    drag = np.einsum("kij,kj->ki", robot.point_mass_matrix(t.position), t.velocity)
    return (-20.0 * drag + 2.0 * robot.gravity(t.position)) / robot.total_mass


def with_bodies(robot: RobotModel, change: Callable[[pin.Model], None], t: Truth) -> Array:
    """Return f of changed inertias from Pinocchio: what the robot needs less what the changed one does."""
    whole = pin.buildModelFromUrdf(str(robot.urdf))
    q0 = pin.neutral(whole)
    held = [whole.getJointId(name) for name in robot.locked]
    model = pin.buildReducedModel(whole, held, q0)
    data, changed = model.createData(), model.copy()
    change(changed)
    changed_data = changed.createData()
    rows = zip(t.position, t.velocity, t.acceleration, strict=True)
    return np.array([pin.rnea(model, data, *r) - pin.rnea(changed, changed_data, *r) for r in rows])


def loaded(robot: RobotModel, t: Truth) -> Array:
    def add(model: pin.Model) -> None:
        frame = model.frames[model.getFrameId(robot.tool_frame)]
        box = pin.Inertia.FromBox(1.5, 0.1, 0.06, 0.2)
        placed = frame.placement * pin.SE3(np.eye(3), np.array([0.02, 0.0, 0.05]))
        model.inertias[frame.parentJoint] += placed.act(box)

    return with_bodies(robot, add, t)


def heavier(robot: RobotModel, t: Truth) -> Array:
    def add(model: pin.Model) -> None:
        joint = model.getJointId(robot.joints[2])
        link = model.inertias[joint]  # one link moves with this joint on both robots
        model.inertias[joint] = pin.Inertia(
            link.mass + 0.5, link.lever + np.array([0.02, 0.01, 0.0]), 1.2 * link.inertia
        )

    return with_bodies(robot, add, t)


# Every row of the table of effects and every effect outside it, on joints 1 and 2: the f that it must make.
CASES: dict[str, tuple[dict, Formula]] = {
    "coulomb_friction": ({"level": 3.0}, on_joint(2, lambda q, v, a, tau, t: -3 * np.sign(v))),
    "viscous_friction": ({"coefficient": 5.0}, on_joint(2, lambda q, v, a, tau, t: -5 * v)),
    "stribeck_friction": (
        {"level": 2.0, "breakaway": 3.0, "decay": 10.0},
        on_joint(2, lambda q, v, a, tau, t: -(2 + 3 * np.exp(-10 * abs(v))) * np.sign(v)),
    ),
    "asymmetric_friction": (
        {
            "level_positive": 1.0,
            "level_negative": 3.0,
            "coefficient_positive": 4.0,
            "coefficient_negative": 2.0,
        },
        on_joint(2, lambda q, v, a, tau, t: np.where(v > 0, -1 - 4 * v, 3 - 2 * v)),
    ),
    "quadratic_friction": ({"coefficient": 4.0}, on_joint(2, lambda q, v, a, tau, t: -4 * abs(v) * v)),
    "load_friction": (
        {"coefficient": 0.1},
        on_joint(2, lambda q, v, a, tau, t: -0.1 * abs(tau) * np.sign(v)),
    ),
    "position_ripple": (
        {"sine": 2.0, "cosine": 1.0, "frequency": 9.0},
        on_joint(2, lambda q, v, a, tau, t: 2 * np.sin(9 * q) + np.cos(9 * q)),
    ),
    "actuator_gain": ({"gain": -0.2}, on_joint(2, lambda q, v, a, tau, t: -0.2 * tau)),
    "torque_offset": ({"offset": 2.0}, on_joint(2, lambda q, v, a, tau, t: 2.0 + 0 * q)),
    "rotor_inertia": ({"inertia": 0.5}, on_joint(2, lambda q, v, a, tau, t: -0.5 * a)),
    "joint_spring": ({"stiffness": 5.0, "preload": 2.0}, on_joint(2, lambda q, v, a, tau, t: -5 * q + 2)),
    "coupled_friction": ({"coefficient": 2.0, "level": 1.5}, coupled),
    "link_inertia": ({"mass": 0.5, "com": (0.02, 0.01, 0.0), "inertia": 0.2}, heavier),
    "payload": ({"mass": 1.5, "com": (0.02, 0.0, 0.05), "size": (0.1, 0.06, 0.2)}, loaded),
    "base_tilt": ({"tilt_x": 0.8, "tilt_y": -0.5}, tilted),
    "tool_wrench": ({"force": (5.0, -3.0, 2.0), "torque": (0.3, 0.2, -0.1)}, pulled),
    "viscous_medium": ({"drag": 20.0, "displaced_mass": 2.0}, immersed),
    "cubic_spring": ({"stiffness": 4.0}, on_joint(2, lambda q, v, a, tau, t: -4 * q**3)),
    "torque_deadzone": ({"width": 2.0}, on_joint(2, lambda q, v, a, tau, t: -np.clip(tau, -2, 2))),
    "speed_cogging": ({"coefficient": 2.0}, on_joint(2, lambda q, v, a, tau, t: -2 * np.sin(7 * q) * v)),
    "posture_friction": (
        {"level": 2.0},
        on_joint(2, lambda q, v, a, tau, t: -2 * (1 + np.sin(2 * t.position[:, 1])) * np.sign(v)),
    ),
    "warming_friction": (
        {"level": 3.0, "time": 3.0},
        on_joint(2, lambda q, v, a, tau, t: -3 * np.exp(-t.time / 3) * np.sign(v)),
    ),
    "cross_spring": ({"torque": 2.0}, on_joint(2, lambda q, v, a, tau, t: 2 * np.sin(2 * t.position[:, 1]))),
    "speed_bump": (
        {"level": 3.0},
        on_joint(2, lambda q, v, a, tau, t: -3 * np.exp(-(((abs(v) - 0.5) / 0.1) ** 2)) * np.tanh(v / 0.05)),
    ),
}
TWO_JOINTS = ("coupled_friction", "posture_friction", "cross_spring")
READINGS = ("encoder_offset", "effort_delay")  # they change what is read, not what happens


def fault_on(robot: RobotModel, effect: str) -> Fault:
    places = MECHANISMS[effect].places
    joint = robot.joints[2] if places else None
    other = robot.joints[1] if places == 2 else None
    return Fault(effect, joint=joint, other=other, **CASES[effect][0])


def test_every_mechanism_is_checked() -> None:
    assert set(CASES) | set(READINGS) | {"presliding"} == set(MECHANISMS)
    assert not set(VOCABULARY) & set(OUTSIDE)
    assert set(RECIPES) == set(VOCABULARY)


@pytest.mark.parametrize("name", ["ur5", "panda"])
@pytest.mark.parametrize("effect", CASES)
def test_fault_adds_the_torque_of_the_table(name: str, effect: str, plants) -> None:
    robot = load_robot(name)
    truth = plants(name).run([fault_on(robot, effect)], duration=3, noise=CLEAN, seed=1).truth
    f, expected = missing_torque(robot, truth), CASES[effect][1](robot, truth)
    slipping = np.abs(truth.velocity[:, 2]) > MOVING
    if effect in TWO_JOINTS:
        slipping &= np.abs(truth.velocity[:, 1] + truth.velocity[:, 2]) > MOVING
    assert slipping.mean() > 0.5
    np.testing.assert_allclose(f[slipping], expected[slipping], rtol=0, atol=1e-9)
    assert np.abs(expected).max() > 0.2  # [N·m], so that a wrong sign cannot pass


def test_encoder_offset_shows_in_the_reading_alone(plants) -> None:
    robot = load_robot("ur5")
    run = plants("ur5").run(
        [Fault("encoder_offset", joint="elbow_joint", offset=0.05)], duration=3, noise=CLEAN
    )
    shift = run.truth.position - run.log.position
    np.testing.assert_allclose(shift, np.tile([0, 0, 0.05, 0, 0, 0], (len(shift), 1)), atol=1e-12)
    assert np.abs(missing_torque(robot, run.truth)).max() < 1e-9
    # The controller holds the reading, not the joint, to the reference.
    assert np.abs(run.log.position - run.truth.reference)[:, 2].max() < 0.01


@pytest.mark.parametrize("joint", [None, "elbow_joint"])
def test_effort_delay_shows_in_the_reading_alone(joint: str | None, plants) -> None:
    run = plants("ur5").run([Fault("effort_delay", joint=joint, delay=0.0123)], duration=3, noise=CLEAN)
    t = run.truth.time
    late = CubicSpline(t, run.truth.effort)(np.maximum(t - 0.0123, 0.0))
    read = [joint is None or j == joint for j in run.log.joints]
    np.testing.assert_allclose(run.log.effort, np.where(read, late, run.truth.effort), atol=1e-3)
    assert np.abs(run.log.effort - run.truth.effort)[:, 2].max() > 0.05


def test_presliding_is_coulomb_far_from_a_reversal_and_lags_after_it(plants) -> None:
    robot = load_robot("ur5")
    truth = (
        plants("ur5")
        .run([Fault("presliding", joint="elbow_joint", level=3.0)], duration=6, noise=CLEAN, seed=1)
        .truth
    )
    f, v = missing_torque(robot, truth)[:, 2], truth.velocity[:, 2]
    assert np.abs(f).max() <= 3.0 + 1e-9
    far = np.abs(v) > 0.8 * np.abs(v).max()
    np.testing.assert_allclose(f[far], -3.0 * np.sign(v[far]), atol=0.3)
    assert (f * v > 0.01).any()  # a bristle gives back what it stored; Coulomb friction never does


def test_dry_friction_holds_a_joint_that_pushes_less(plants) -> None:
    robot = load_robot("ur5")
    level = 200.0
    truth = (
        plants("ur5")
        .run(
            [Fault("coulomb_friction", joint="shoulder_lift_joint", level=level)],
            motion=single(["elbow_joint"]),
            duration=4,
            noise=CLEAN,
        )
        .truth
    )
    assert np.ptp(truth.position[:, 1]) < 1e-4
    assert np.abs(missing_torque(robot, truth)[:, 1]).max() < level


def test_strong_damping_of_a_light_joint_is_stable(plants) -> None:
    run = plants("ur5").run(
        [Fault("viscous_friction", joint="wrist_3_joint", coefficient=0.5)], duration=1, noise=CLEAN
    )
    f = missing_torque(load_robot("ur5"), run.truth)[:, 5]
    np.testing.assert_allclose(f, -0.5 * run.truth.velocity[:, 5], atol=1e-9)


def test_faults_add_up(plants) -> None:
    robot = load_robot("ur5")
    effects = ("coulomb_friction", "viscous_friction", "torque_offset", "joint_spring", "rotor_inertia")
    truth = plants("ur5").run([fault_on(robot, e) for e in effects], duration=3, noise=CLEAN, seed=1).truth
    expected = sum(CASES[e][1](robot, truth) for e in effects)
    slipping = np.abs(truth.velocity[:, 2]) > MOVING
    np.testing.assert_allclose(missing_torque(robot, truth)[slipping], expected[slipping], rtol=0, atol=1e-9)


@pytest.mark.parametrize("effect", ["torque_offset", "rotor_inertia", "payload", "base_tilt", "tool_wrench"])
def test_fault_begins_at_its_time_and_grows_along_its_ramp(effect: str, plants) -> None:
    robot = load_robot("ur5")
    always = fault_on(robot, effect)
    fault = Fault(effect, joint=always.joint, after=1.0, ramp=0.5, **always.parameters)
    truth = plants("ur5").run([fault], duration=2.5, noise=CLEAN, seed=1).truth
    f, full = missing_torque(robot, truth), CASES[effect][1](robot, truth)
    before, within, after = truth.time < 1, np.isclose(truth.time, 1.248), truth.time > 1.5
    assert np.abs(f[before]).max() < 1e-9
    np.testing.assert_allclose(f[after], full[after], rtol=0, atol=1e-9)
    if effect != "base_tilt":  # half a tilt is not half its torque: gravity keeps its size
        np.testing.assert_allclose(f[within], 0.496 * full[within], rtol=0, atol=1e-3)


@pytest.mark.parametrize(
    ("fault", "says"),
    [
        (Fault("coulomb_frition", joint="elbow_joint"), "coulomb_friction"),
        (Fault("coulomb_friction", joint="elbow_joint", size=1.0), "level"),
        (Fault("coulomb_friction"), "1 joint"),
        (Fault("payload", joint="elbow_joint"), "0 joint"),
        (Fault("effort_delay", after=1.0), "all the time"),
    ],
)
def test_wrong_fault_is_refused_with_what_is_known(fault: Fault, says: str, plants) -> None:
    with pytest.raises(EffectError, match=says):
        plants("ur5").run([fault], duration=1)


def test_plant_shares_no_physics_with_the_package() -> None:
    allowed = {"cdia_pin.errors", "cdia_pin.logs.log", "cdia_pin.robot"}
    for file in Path(benchmarks.plant.__file__).parent.rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("cdia_pin"):
                assert node.module in allowed, file
            names = [a.name for a in node.names] if isinstance(node, ast.Import) else []
            assert not {"pinocchio"} & set(names), file


# ---------------------------------------------------------------- motion and sensors


@pytest.mark.parametrize("name", ["ur5", "panda", "scara"])
@pytest.mark.parametrize("motion", [Fourier(), PointToPoint(), Fourier(speed=0.12), Fourier(amplitude=0.1)])
def test_motion_stays_within_limits_and_starts_and_ends_at_rest(name: str, motion, plants) -> None:
    plant, robot = plants(name), load_robot(name)
    for seed in range(3):
        t = np.linspace(0, 20, 2001)
        q, v, a = plant.plan(motion, 20.0, seed)(t)
        assert (q > robot.limits.lower).all()
        assert (q < robot.limits.upper).all()
        assert (np.abs(v) <= np.minimum(0.6 * robot.limits.velocity, 1.5) * (1 + 1e-3)).all()
        assert np.abs(v[[0, -1]]).max() < 1e-9
        assert np.abs(a[[0, -1]]).max() < 1e-9
        np.testing.assert_allclose(cumulative_trapezoid(v, t, axis=0, initial=0), q - q[0], atol=1e-3)
        np.testing.assert_allclose(cumulative_trapezoid(a, t, axis=0, initial=0), v, atol=1e-3)


def test_single_moves_one_joint(plants) -> None:
    q, _, _ = plants("ur5").plan(single(["wrist_1_joint"]), 10.0, 0)(np.linspace(0, 10, 100))
    assert [j for j, moved in zip(plants("ur5").joints, np.ptp(q, axis=0) > 0, strict=True) if moved] == [
        "wrist_1_joint"
    ]


@pytest.mark.parametrize("colour", ["white", "ar1", "pink"])
def test_noise_has_the_stated_size_and_colour(colour: str, plants) -> None:
    noise = Noise(effort_fraction=0.02, colour=colour, position_resolution=1e-4)
    run = plants("ur5").run(duration=8, noise=noise)
    drawn = run.log.effort - run.truth.effort
    np.testing.assert_allclose(drawn.std(axis=0), run.noise_std, rtol=0.25)
    rms = np.sqrt(np.mean(run.truth.effort**2, axis=0))
    busy = rms > 0.02 * rms.max()
    np.testing.assert_allclose(run.noise_std[busy], 0.02 * rms[busy])
    lag1 = np.mean(drawn[1:] * drawn[:-1], axis=0) / np.mean(drawn**2, axis=0)
    expected = {"white": (-0.1, 0.1), "ar1": (0.7, 0.9), "pink": (0.5, 0.95)}[colour]
    assert (lag1 > expected[0]).all()
    assert (lag1 < expected[1]).all()
    steps = run.log.position / 1e-4
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-6)


def test_log_has_velocity_only_where_asked(plants) -> None:
    assert plants("ur5").run(duration=1).log.velocity is None
    run = plants("ur5").run(duration=1, velocity=True)
    np.testing.assert_array_equal(run.log.velocity, run.truth.velocity)


def test_run_is_the_same_again_from_disk_and_anew_and_other_with_another_seed(plants) -> None:
    faults = [Fault("coulomb_friction", joint="elbow_joint", level=3.0)]
    runs = [plants("ur5").run(faults, duration=1, keep=k, seed=5) for k in (True, True, False)]
    for run in runs[1:]:
        np.testing.assert_array_equal(run.log.effort, runs[0].log.effort)
        np.testing.assert_array_equal(run.log.position, runs[0].log.position)
    other = plants("ur5").run(faults, duration=1, seed=6)
    assert np.abs(other.log.position - runs[0].log.position).max() > 0.01


# ---------------------------------------------------------------- scenarios


def test_sizes_predict_the_torque_that_the_plant_shows(plants) -> None:
    plant, robot = plants("ur5"), load_robot("ur5")
    sizer = Sizer(plant, Fourier(), 6.0, 1)
    for effect in ("viscous_friction", "rotor_inertia", "payload", "base_tilt", "torque_offset"):
        fault = fault_on(robot, effect)
        predicted = np.sqrt(np.mean(sizer.torque_of(fault) ** 2, axis=0))
        truth = plant.run([fault], duration=6, noise=CLEAN, seed=1).truth
        seen = np.sqrt(np.mean(missing_torque(robot, truth) ** 2, axis=0))
        np.testing.assert_allclose(predicted, seen, rtol=0.1, atol=0.1)


@pytest.mark.parametrize("name", ["ur5", "scara"])
def test_scenarios_have_the_size_asked_for(name: str, plants) -> None:
    plant = plants(name)
    scenarios = singles(plant, 0.2)
    if name == "ur5":
        scenarios += [*pairs(plant, 0.2)[1:2], *triples(plant, 0.2)[2:3], *outside(plant, 0.2)]
    for scenario in scenarios:
        sizer = Sizer(plant, scenario.motion, scenario.duration, scenario.seed)
        for fault in scenario.faults:
            # A tilt, an encoder's zero and a delay are bounded by what is plausible.
            bounded = fault.effect in {"base_tilt", *READINGS}
            share = sizer.share(fault)
            assert share == pytest.approx(0.2, rel=0.1) or (bounded and 0 < share < 0.2)
    assert all(s.faults == () for s in clean())


def test_holdout_has_the_same_faults_under_another_motion(plants) -> None:
    scenario = singles(plants("ur5"))[0]
    assert scenario.holdout().faults == scenario.faults
    assert scenario.holdout().seed != scenario.seed


# ---------------------------------------------------------------- the demo's log


def test_demo_log_is_what_its_script_makes(tmp_path: Path) -> None:
    demo_log.write(demo_log.make_run(), tmp_path / "demo.csv")
    made, ships = (
        (p.read_text().splitlines()[0], np.loadtxt(p, delimiter=",", skiprows=1))
        for p in (tmp_path / "demo.csv", demo_log.OUT)
    )
    assert made[0] == ships[0]
    assert "velocity" not in ships[0]
    np.testing.assert_allclose(made[1], ships[1], atol=1e-3)
    assert demo_log.OUT.stat().st_size < 1.2e6
