"""What a file holds of a model, what it lacks with its torque, and what its text says."""

import ast
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cdia_pin import Dynamics, load_robot
from cdia_pin.effects import EFFECTS, Drift, PerLog, Term, parse_effect, parse_term
from cdia_pin.errors import ModelError
from cdia_pin.exports import FORMATS, first_format, ranges_document, torque_left_out
from cdia_pin.logs import Log
from cdia_pin.logs.conditioning import condition
from cdia_pin.logs.motion import names_of

ELBOW = "elbow_joint"
ASYMMETRIC = (
    f"asymmetric_friction@{ELBOW}: level_positive=3, level_negative=5, coefficient_positive=1, "
    "coefficient_negative=2"
)


@pytest.fixture(scope="module")
def robot():
    return load_robot("ur5")


def model_of(robot, *texts: str) -> Dynamics:
    return Dynamics(robot, tuple(map(parse_term, texts)))


def remembering(model: Dynamics) -> Dynamics:
    """The model with a motion that it was learned from."""
    t = np.arange(0, 10, 0.01)
    w = np.linspace(0.8, 2.0, model.robot.n)
    q, v, a = np.sin(w * t[:, None]), w * np.cos(w * t[:, None]), -(w**2) * np.sin(w * t[:, None])
    log = Log(model.robot.joints, t, q, model.inverse_dynamics(q, v, a))
    return replace(model, learned_from=(condition(log, model.robot),))


def text_of(form: str, model: Dynamics) -> str:
    return FORMATS[form].text(model, FORMATS[form].values(model), Path())


def test_asymmetric_friction_is_held_as_its_mean(robot):
    values = FORMATS["urdf"].values(model_of(robot, ASYMMETRIC))
    assert (values.friction[ELBOW], values.damping[ELBOW]) == (4.0, 1.5)
    assert "mean over both directions" in values.approximated[f"asymmetric_friction@{ELBOW}"]
    assert not values.left_out


def test_friction_of_bearings_is_held_wholly(robot):
    label = f"bearing_friction@{ELBOW}"
    values = FORMATS["urdf"].values(model_of(robot, f"{label}: level=0.3, coefficient=0.2"))
    assert (values.friction[ELBOW], values.damping[ELBOW]) == (0.3, 0.2)
    assert values.written == [label] and not values.approximated


@pytest.mark.parametrize(
    ("text", "level"),
    [
        (f"stribeck_friction@{ELBOW}: level=3, breakaway=2", 3.0),
        (f"presliding_friction@{ELBOW}: level=2.5", 2.5),
        (f"thermal_friction@{ELBOW}: level=2, coefficient=1", 2.0),
    ],
)
def test_other_friction_is_held_as_the_nearest_that_simulators_know(robot, text, level):
    values = FORMATS["urdf"].values(model_of(robot, text))
    assert values.friction[ELBOW] == level
    assert list(values.approximated) == [text.partition(":")[0]]


def test_friction_of_its_own_in_each_log_is_held_as_its_mean_and_a_payload_is_not(robot):
    friction = PerLog(parse_effect(f"coulomb_friction@{ELBOW}", robot), ("cold", "warm"))
    drift = Drift(parse_effect(f"viscous_friction@{ELBOW}", robot), 0.0, 100.0, 50.0)
    payload = PerLog(parse_effect("payload", robot), ("one", "two"))
    terms = (Term(friction, (4.0, 2.0)), Term(drift, (3.0, 1.0)), Term(payload, (1.0, *[0.0] * 9) * 2))
    values = FORMATS["urdf"].values(Dynamics(robot, terms))
    assert (values.friction, values.damping) == ({ELBOW: 3.0}, {ELBOW: 2.0})
    assert list(values.left_out) == ["payload[log]"]


@pytest.mark.parametrize("form", FORMATS)
def test_every_effect_is_held_or_left_out_with_a_reason(robot, form):
    for name in EFFECTS:
        scope = next(EFFECTS[name].scopes(robot))
        if name in {"expression"}:
            continue
        effect = EFFECTS[name].from_scope(scope, {})
        values = FORMATS[form].values(Dynamics(robot, (Term(effect, (0.0,) * effect.size),)))
        assert len(values.held) + len(values.left_out) == 1
        assert all(values.left_out.values()) and all(values.approximated.values())


def test_the_first_format_is_one_that_holds_a_term(robot):
    assert first_format(model_of(robot, f"coulomb_friction@{ELBOW}: level=1")) == "urdf"
    assert first_format(model_of(robot, f"rotor_inertia@{ELBOW}: inertia=1")) == "mjcf"
    assert first_format(model_of(robot, f"torque_offset@{ELBOW}: offset=2")) is None


def test_the_torque_left_out_is_that_of_the_term(robot):
    offset = f"torque_offset@{ELBOW}: offset=2"
    model = remembering(model_of(robot, offset, f"coulomb_friction@{ELBOW}: level=1"))
    values = FORMATS["urdf"].values(model)
    lacking = torque_left_out(values, model)
    assert list(lacking) == [f"torque_offset@{ELBOW}"]
    expected = np.where(np.array(robot.joints) == ELBOW, 2.0, 0.0)
    np.testing.assert_allclose(list(lacking[f"torque_offset@{ELBOW}"].values()), expected, atol=1e-9)


def test_the_torque_that_a_mean_lacks_is_half_the_difference_of_the_directions(robot):
    model = remembering(model_of(robot, f"asymmetric_friction@{ELBOW}: level_positive=3, level_negative=5"))
    lacking = torque_left_out(FORMATS["urdf"].values(model), model)
    assert lacking[f"asymmetric_friction@{ELBOW}"][ELBOW] == pytest.approx(1.0, rel=0.02)


def test_friction_of_the_load_is_left_out_with_its_torque(robot):
    """f = −α |τ| sgn q̇ and τ = τ₀ − f, so with the motion |f| = α |τ₀| / (1 ∓ α)."""
    label = f"load_friction@{ELBOW}"
    model = remembering(model_of(robot, f"{label}: coefficient=0.1"))
    values = FORMATS["mjcf"].values(model)
    assert label in values.left_out
    (motion,) = model.learned_from
    j = robot.joint_index(ELBOW)
    load = np.sqrt(np.mean(robot.inverse_dynamics(motion.q, motion.v, motion.a)[:, j] ** 2))
    assert 0.1 / 1.1 * load < torque_left_out(values, model)[label][ELBOW] < 0.1 / 0.9 * load


def test_two_logs_of_one_name_keep_their_own_numbers(robot):
    (motion,) = remembering(Dynamics(robot)).learned_from
    logs = names_of([motion, motion])
    offset = PerLog(parse_effect(f"torque_offset@{ELBOW}", robot), tuple(logs))
    model = Dynamics(robot, (Term(offset, (3.0, 4.0)),), learned_from=(motion, motion))
    lacking = torque_left_out(FORMATS["urdf"].values(model), model)
    assert lacking[f"torque_offset@{ELBOW}[log]"][ELBOW] == pytest.approx(np.sqrt(12.5))


def test_a_model_that_remembers_no_motion_has_no_torques(robot):
    model = model_of(robot, f"torque_offset@{ELBOW}: offset=2")
    assert torque_left_out(FORMATS["mjcf"].values(model), model) == {}


def test_the_breakaway_is_held_where_friction_at_rest_has_a_place(robot):
    label = f"stribeck_friction@{ELBOW}"
    model = model_of(robot, f"{label}: level=3, breakaway=2, decay=5")
    for form, breakaway in (("isaac_lab", 2.0), ("mjcf", 0.0), ("urdf", 0.0)):
        values = FORMATS[form].values(model)
        assert ("breakaway at rest" in values.approximated[label]) == bool(breakaway)
        total = sum(sum(t.theta) for t in values.beyond[label].written)
        assert total == pytest.approx(3.0 + breakaway)


def test_isaac_lab_has_friction_at_rest_and_in_motion(robot):
    text = text_of(
        "isaac_lab",
        model_of(
            robot,
            f"stribeck_friction@{ELBOW}: level=3, breakaway=2",
            f"viscous_friction@{ELBOW}: coefficient=0.7",
            f"rotor_inertia@{ELBOW}: inertia=0.2",
        ),
    )
    call = next(n for n in ast.walk(ast.parse(text)) if isinstance(n, ast.Call))
    numbers = {
        k.arg: ast.literal_eval(k.value)[ELBOW] for k in call.keywords if isinstance(k.value, ast.Dict)
    }
    assert numbers == {
        "effort_limit_sim": 150.0,
        "armature": 0.2,
        "friction": 5.0,
        "dynamic_friction": 3.0,
        "viscous_friction": 0.7,
    }


class Part:
    """Stands for a joint or an actuator of Drake; it keeps what is set."""

    def __init__(self, name: str, joint: "Part | None" = None) -> None:
        self._name, self._joint, self.held = name, joint, {}

    def name(self):
        return self._name

    def joint(self):
        return self._joint

    def __getattr__(self, key):
        return lambda value: self.held.update({key.removeprefix("set_default_"): value})


class Plant:
    """Stands for Drake's plant, with the methods that the exported lines call; only one joint is driven."""

    def __init__(self, joints) -> None:
        self.joints = {j: Part(j) for j in joints}
        self.actuators = [Part("motor_of_the_elbow", self.joints[ELBOW])]

    def GetJointActuatorIndices(self):
        return range(len(self.actuators))

    def get_joint_actuator(self, index):
        return self.actuators[index]

    def GetJointByName(self, name):
        return self.joints[name]

    def AddJointActuator(self, name, joint, limit):
        self.actuators.append(Part(name, joint))
        return self.actuators[-1]


def test_the_lines_for_drake_set_damping_and_rotor_inertia(robot):
    model = model_of(
        robot, f"viscous_friction@{ELBOW}: coefficient=0.7", f"rotor_inertia@{ELBOW}: inertia=0.2"
    )
    names: dict = {}
    exec(text_of("drake", model), names)
    plant = Plant(robot.joints)
    names["apply"](plant)
    assert plant.joints[ELBOW].held == {"damping": 0.7}
    assert plant.actuators[0].held == {"rotor_inertia": 0.2, "gear_ratio": 1.0}
    assert len(plant.actuators) == robot.n


def test_a_ur_is_told_mass_centre_and_inertia_in_the_flange(robot):
    from cdia_pin.robot.inertia import parameters_of

    tensor = np.array([[3e-3, 1e-4, 2e-4], [1e-4, 4e-3, 3e-4], [2e-4, 3e-4, 5e-3]])
    theta = parameters_of(2.0, [0.01, -0.02, 0.06], tensor)
    model = Dynamics(robot, (Term(parse_effect("payload", robot), tuple(theta)),))
    line = text_of("ur_payload", model).splitlines()[-1]
    assert line.startswith("set_target_payload(")
    mass, centre, inertia = ast.literal_eval(line.removeprefix("set_target_payload"))
    assert robot.tool_frame == "tool0"
    assert mass == 2.0
    np.testing.assert_allclose(centre, [0.01, -0.02, 0.06], atol=1e-6)
    np.testing.assert_allclose(inertia, [3e-3, 4e-3, 5e-3, 1e-4, 2e-4, 3e-4], atol=1e-6)


def test_a_ur_is_told_no_inertia_that_no_body_has(robot):
    line = text_of("ur_payload", model_of(robot, "payload: mass=1, first_moment_z=0.1")).splitlines()[-1]
    assert line == "set_target_payload(1.000000, [0, 0, 0.100000])"


def test_a_ur_cannot_be_told_that_a_tool_is_missing(robot):
    with pytest.raises(ModelError, match="lacks a tool"):
        text_of("ur_payload", model_of(robot, "payload: mass=-0.05"))


def test_ranges_are_the_intervals_within_the_physical_bounds(robot):
    friction = parse_term(f"coulomb_friction@{ELBOW}: level=1").with_intervals(np.array([1.5]))
    link = parse_term(f"link_inertia@{ELBOW}: mass=0.1").with_intervals(np.full(10, 0.01))
    bare = parse_term(f"viscous_friction@{ELBOW}: coefficient=2")
    document = ranges_document(Dynamics(robot, (friction, link, bare)))
    assert json.loads(json.dumps(document)) == document
    level, mass, *_, coefficient = document["parameters"]
    assert (level["lower"], level["value"], level["upper"], level["base"]) == (0.0, 1.0, 2.5, 0.0)
    of_urdf = robot.inertial_parameters[robot.joint_index(ELBOW)][0]
    assert mass["base"] == of_urdf
    assert [mass[k] for k in ("lower", "value", "upper")] == pytest.approx(
        of_urdf + np.array([0.09, 0.1, 0.11])
    )
    assert "lower" not in coefficient and coefficient["unit"] == "N·m·s/rad"
