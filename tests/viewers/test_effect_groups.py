"""Effects are shown in groups, the most trusted first; changes and both parts of an interval are said."""

from dataclasses import replace

import numpy as np
import pytest

from cdia_pin.changes.confidence import Confidence
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import CoulombFriction, Payload, Term, TorqueOffset, ViscousFriction, parse_effect
from cdia_pin.identifiability.confusion import Confusion
from cdia_pin.phrases import NO_BREAK
from cdia_pin.robot import load_robot
from cdia_pin.viewers import verdict_sentences
from cdia_pin.viewers.effect_groups import effect_groups, on_joints, rivals
from cdia_pin.viewers.notebook import html_of
from cdia_pin.viewers.parameter_rows import group_numbers, parameters, parts_words, step_parameters
from cdia_pin.viewers.report_discovery import discovery_data
from cdia_pin.viewers.short_answer import short_answer
from cdia_pin.viewers.text_discovery import discovery_table
from tests.viewers.test_terminal_tables import printed

LIKELY, DESCRIPTIVE = Confidence.LIKELY, Confidence.DESCRIPTIVE


@pytest.fixture(scope="module")
def mixed(results):
    """Friction on all joints that is established, an offset that is likely, a payload that only describes."""
    robot, first = results.robot, results.discovery.trace[0]

    def step(effect, value, confidence=Confidence.ESTABLISHED, **more):
        theta = (value,) + (0.0,) * (effect.size - 1)
        ends = tuple((v - 0.5, v + 0.5) for v in theta)
        narrow = tuple((v - 0.3, v + 0.3) for v in theta)
        term = Term(effect, theta, ci95=ends, ci95_statistical=narrow)
        return replace(first, term=term, confidence=confidence, **more)

    steps = [step(Payload(), 1.0, DESCRIPTIVE), step(TorqueOffset(joint="joint2"), 2.0, LIKELY)]
    steps += [step(CoulombFriction(joint=j), 1.0 + k) for k, j in enumerate(robot.joints)]
    steps.append(step(ViscousFriction(joint="joint1"), 2.1, change_of_model=True))
    return replace(results.discovery, trace=(first, *steps))


def test_groups_come_in_the_order_of_trust(mixed):
    words = [(str(g.confidence), g.words(mixed.model.robot.joints)) for g in effect_groups(mixed)]
    assert words == [
        ("established", "coulomb friction on all 4 joints"),
        ("established", "viscous friction changed on joint1"),
        ("likely", "torque offset on joint2"),
        ("descriptive", "payload"),
    ]


@pytest.mark.parametrize(
    ("mass", "said"), [(1.5, "payload +1.50 ± 0.50 kg"), (-0.8, "payload −0.80 ± 0.50 kg"), (0.4, "payload")]
)
def test_a_payload_is_told_with_its_mass_where_that_is_known(mixed, mass, said):
    group = next(g for g in effect_groups(mixed) if g.name == "payload")
    (step,) = group.steps
    ends = ((mass - 0.5, mass + 0.5), *step.term.ci95[1:])
    term = replace(step.term, theta=(mass, *step.term.theta[1:]), ci95=ends)
    words = replace(group, steps=(replace(step, term=term),)).words_with_rival(mixed.model.robot)
    assert words.replace(NO_BREAK, " ") == said


@pytest.mark.parametrize(
    ("rivals", "said"),
    [
        (("payload",), "torque offset on joint2 (or payload)"),
        (("payload", "actuator_gain@joint2"), "torque offset on joint2 (or actuator gain)"),
        (("joint_spring@joint3",), "torque offset on joint2 (or joint spring on joint3)"),
        (("joint_spring@joint2",), "torque offset on joint2"),  # a finer drawing of the same
        ((), "torque offset on joint2"),
    ],
)
def test_a_likely_effect_is_said_with_what_else_it_may_be(mixed, rivals, said):
    confusions = tuple(Confusion((parse_effect(r),), "sweep the joint slowly") for r in rivals)
    steps = [replace(s, confusions=confusions) if s.confidence is LIKELY else s for s in mixed.steps]
    found = replace(mixed, trace=(mixed.trace[0], *steps))
    assert dict(short_answer(found))["likely"] == said


def test_every_effect_is_in_one_group(mixed):
    shown = [s for g in effect_groups(mixed) for s in g.steps]
    assert {id(s) for s in shown} == {id(s) for s in mixed.steps}
    assert len(shown) == len(mixed.steps)


def test_the_parts_of_an_interval_add_in_squares(mixed):
    (row,) = step_parameters(mixed.steps[1], mixed.model.robot)
    assert parts_words(row) == "± 0.30 statistical, ± 0.40 systematic"


def test_an_interval_without_parts_says_nothing_of_them(results):
    term = Term(CoulombFriction(joint="joint1"), (1.0,), ci95=((0.5, 1.5),))
    (row,) = parameters(term, results.robot)
    assert parts_words(row) == ""


def test_a_change_says_since_when(mixed):
    change = effect_groups(mixed)[1]
    said = group_numbers(change, mixed.model.robot).replace("\xa0", " ")
    assert said == "coefficient +2.10 ± 0.50 N·m·s/rad since the model"


@pytest.mark.parametrize("verdict", ["explained", "explained-in-practice", "unexplained"])
def test_a_verdict_names_what_is_established_first(mixed, verdict):
    left = () if verdict == "explained" else ("joint3",)
    first, *more = verdict_sentences(replace(mixed, verdict=verdict, structure_left=left))
    assert (
        "coulomb friction on all 4 joints, viscous friction changed on joint1 and torque offset on joint2 (likely)"
        in first
    )
    assert "payload" not in first
    assert "payload" in next(s for s in more if s.startswith("Added to describe"))


def test_what_is_left_is_small_in_practice(mixed):
    said = verdict_sentences(replace(mixed, verdict="explained-in-practice", structure_left=("joint3",)))[0]
    share = mixed.trace[-1].heldout_rms[2] / mixed.torque_rms[2]
    assert f"on joint3 has structure, but is small, at most {100 * share:.0f}" in said


@pytest.mark.parametrize("joints", [("one",), ("one", "two"), ("one", "two", "three")])
def test_all_joints_are_said_as_all(joints):
    assert on_joints(joints, joints) in {" on one", " on both joints", " on all 3 joints"}
    assert on_joints((), joints) == ""


def test_every_view_shows_the_same(mixed):
    data = discovery_data(mixed)
    assert [tuple(line.values()) for line in data["answer"]] == short_answer(mixed)
    assert sorted(n for g in data["groups"] for n in g["members"]) == [e["number"] for e in data["effects"]]
    page, text = html_of(mixed), " ".join(printed(discovery_table(mixed, everything=True), 100).split())
    for words in ("coulomb friction on all 4 joints", "viscous friction changed on joint1", "torque offset"):
        assert words in page
        assert words in text
    assert "since the model" in page
    assert "since the model" in text


def test_rivals_on_the_same_joint_come_first(doubtful):
    (same,) = doubtful.steps[0].confusions
    other = replace(same, effects=(CoulombFriction(joint="joint1"),))
    assert rivals(doubtful.steps[0].term.effect, (other, same)) == [same, other]


ONE_JOINT = """<robot name="lever"><link name="base"/><link name="bar"><inertial><mass value="1"/>
<origin xyz="0.2 0 0"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="hinge" type="revolute"><parent link="base"/><child link="bar"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" effort="10" velocity="5"/></joint></robot>"""


def test_an_arm_of_one_joint_has_an_answer(results, tmp_path):
    (tmp_path / "lever.urdf").write_text(ONE_JOINT)
    found = results.discovery
    able = replace(found.capability, friction=found.capability.friction[:1], payload=np.inf, push=np.inf)
    cut = tuple(replace(s, rms=s.rms[:1], heldout_rms=s.heldout_rms[:1]) for s in found.trace[:1])
    alone = replace(
        found,
        model=Dynamics(load_robot(tmp_path / "lever.urdf")),
        trace=cut,
        torque_rms=found.torque_rms[:1],
        heldout_torque_rms=found.heldout_torque_rms[:1],
        noise_floor=found.noise_floor[:1],
        structure_left=(),
        capability=able,
    )
    said = dict(short_answer(alone))
    assert said["good for"].startswith("notices friction that grows by")


def test_a_push_as_large_as_the_weight_of_the_arm_is_no_use(results):
    found = results.discovery
    mass = found.model.robot.total_mass
    small, large = (
        replace(found, capability=replace(found.capability, payload=k * mass, push=k * mass * 9.81))
        for k in (0.5, 2.0)
    )
    assert "a payload of" in dict(short_answer(small))["good for"]
    assert "a push of" in dict(short_answer(small))["good for"]
    assert "a payload" not in dict(short_answer(large))["good for"]
    assert "a push" not in dict(short_answer(large))["good for"]
