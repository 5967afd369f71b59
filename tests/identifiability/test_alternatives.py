"""What a motion cannot tell apart is said, with a motion that can, instead of chosen in silence."""

import numpy as np
import pytest

from benchmarks.plant import Fault
from benchmarks.plant.motion import Fourier
from cdia_pin import Dynamics, compare, load_robot
from cdia_pin.discovery import Discovery, add_effect, discover
from cdia_pin.effects import parse_effect
from cdia_pin.identifiability.alternatives import Alternatives
from cdia_pin.regression.normal_equations import NormalEquations
from cdia_pin.selection.evidence import Evidence
from tests.hidden_plants import label, labels, plant_of

ELBOW, PAN = "elbow_joint", "shoulder_pan_joint"
FIRST_ALONE = Fourier(joints=("joint1",), speed=0.2)  # slow: next to nothing but gravity
PAN_ALONE = Fourier(harmonics=1, base=0.2, joints=(PAN,))  # nothing but inertia about one axis


def run(arm: str, fault: Fault, motion: Fourier):
    """Return a log and the bare model of its arm."""
    plant = plant_of(arm)
    done = plant.run([fault], motion=motion, seed=2, duration=30.0)
    return done.log, Dynamics(plant.robot)


def confusable(result: Discovery) -> dict[str, str]:
    """Other explanations, with the motion that would tell."""
    return {e.label: c.motion for s in result.steps for c in s.confusions for e in c.effects}


# Pairs of explanations with the same columns on the motion given, each hidden once.
CASES = {
    "a body on the tool, a change of the last link": (
        "ur5",
        Fourier(),
        [("payload", None, {"mass": 0.5, "com": (0.02, 0.0, 0.03), "size": 0.1}),
         ("link_inertia", "wrist_3_joint", {"mass": 0.5, "com": (0.02, 0.0, 0.03)})],
        [{"payload"}, {"link_inertia@wrist_3_joint"}],
    ),
    "levels by direction, one level and an offset": (
        "ur5",
        Fourier(),
        [("asymmetric_friction", ELBOW, {"level_positive": 2.0, "level_negative": 4.0})],
        [{f"asymmetric_friction@{ELBOW}"}, {f"coulomb_friction@{ELBOW}", f"torque_offset@{ELBOW}"}],
    ),
    "a drive's gain, a mass at a fixed place, where gravity is all": (
        "double_pendulum",
        FIRST_ALONE,
        [("actuator_gain", "joint1", {"gain": -0.2})],
        [{"actuator_gain@joint1"}, {"link_inertia@joint1"}],
    ),
    "a tilt in the plane of a planar arm, its first encoder's zero": (
        "double_pendulum",
        Fourier(),
        [("encoder_offset", "joint1", {"offset": 0.1}),
         ("base_tilt", None, {"tilt_y": -1.0})],
        [{"encoder_offset@joint1"}, {"base_tilt"}],
    ),
    "a rotor, a link's inertia about the only axis that turns": (
        "ur5",
        PAN_ALONE,
        [("rotor_inertia", PAN, {"inertia": 1.0})],
        [{f"rotor_inertia@{PAN}"}, {f"link_inertia@{PAN}"}],
    ),
}  # fmt: skip


EACH = [(case, k) for case, (_, _, faults, _) in CASES.items() for k in range(len(faults))]


@pytest.mark.parametrize(("case", "k"), EACH, ids=[f"{c} ({CASES[c][2][k][0]})" for c, k in EACH])
def test_one_explanation_is_found_and_its_twin_is_named(case, k):
    arm, motion, faults, twins = CASES[case]
    effect, joint, parameters = faults[k]
    log, model = run(arm, Fault(effect, joint=joint, **parameters), motion)
    result = discover(model, log)
    assert labels(result) in twins
    assert result.verdict == "explained"
    (other,) = (t for t in twins if t != labels(result))
    named = confusable(result)
    assert other & set(named), f"found {labels(result)}, confusable with {sorted(named)}"
    assert all(named.values())


@pytest.mark.parametrize(("case", "k"), EACH, ids=[f"{c} ({CASES[c][2][k][0]})" for c, k in EACH])
def test_twins_explain_equally_well(case, k):
    """What the tests above rest on: neither explanation leaves more than the other, on any joint."""
    arm, motion, faults, twins = CASES[case]
    effect, joint, parameters = faults[k]
    log, bare = run(arm, Fault(effect, joint=joint, **parameters), motion)
    left = []
    for twin in twins:
        model = bare
        for one in sorted(twin):
            result = add_effect(model, parse_effect(one, bare.robot), log)
            model = result.model
        left.append(result.trace[-1].rms)
    np.testing.assert_allclose(*left, rtol=0.05)
    assert (left[0] < 0.5 * compare(bare, log).rms).any()


@pytest.mark.parametrize(
    ("arm", "motion", "fault"),
    [
        ("double_pendulum", FIRST_ALONE, Fault("link_inertia", joint="joint1", mass=0.15)),
        ("double_pendulum", FIRST_ALONE, Fault("payload", mass=0.1, com=(0.0, 0.0, 0.05), size=0.02)),
        ("ur5", PAN_ALONE, Fault("rotor_inertia", joint=PAN, inertia=1.0)),
        ("ur5", PAN_ALONE, Fault("viscous_friction", joint=PAN, coefficient=3.0)),
    ],
    ids=lambda x: x if isinstance(x, str) else x.effect if isinstance(x, Fault) else "",
)
def test_on_a_poor_motion_the_hidden_effect_is_found_or_named(arm, motion, fault):
    log, model = run(arm, fault, motion)
    result = discover(model, log)
    hidden = label(fault)
    named = labels(result) | set(confusable(result))
    assert hidden in named, f"found {labels(result)}, confusable with {sorted(confusable(result))}"


def test_what_the_motion_separates_is_no_confusion():
    """A full motion tells a gain from a mass."""
    log, model = run("ur5", Fault("actuator_gain", joint=ELBOW, gain=-0.2), Fourier())
    result = discover(model, log)
    assert labels(result) == {f"actuator_gain@{ELBOW}"}
    assert f"link_inertia@{ELBOW}" not in confusable(result)
    assert "payload" not in confusable(result)


def test_a_rival_acts_on_a_joint_of_the_effect():
    """Where another joint is fitted badly, much lowers its error, but takes the place of nothing here."""
    robot, rng = load_robot("double_pendulum"), np.random.default_rng(0)
    effects = [parse_effect(f"{kind}_friction@joint{j}") for kind in ("coulomb", "viscous") for j in (1, 2)]
    x = rng.normal(size=(4000, 4))
    x[:2000, [1, 3]] = x[2000:, [0, 2]] = 0.0  # the first half of the rows is joint 1, the second joint 2
    y = x @ [0.2, 0.0, 0.0, 1.0] + rng.normal(size=4000)
    whole = np.column_stack([x, y])
    evidence = Evidence(NormalEquations(robot, effects, (whole.T @ whole)[None], 4000))
    assert evidence.gains([])[3] > evidence.gains([])[0]
    assert Alternatives(evidence, [0]).of(0) == ()
