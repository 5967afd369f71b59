"""Which of several changes is named, by what each explains of blocks of time that its fit did not see."""

from collections import defaultdict
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from cdia_pin import Dynamics
from cdia_pin.changes.change_search import ChangeSearch
from cdia_pin.changes.confidence import Confidence
from cdia_pin.changes.difference import Difference
from cdia_pin.changes.differing import Differing
from cdia_pin.effects import (
    EFFECTS,
    ActuatorGain,
    AsymmetricFriction,
    CoulombFriction,
    EncoderOffset,
    JointSpring,
    LinkInertia,
    LoadFriction,
    Term,
    TorqueOffset,
)
from cdia_pin.logs.conditioning import condition
from cdia_pin.regression.block_evidence import BlockFits
from cdia_pin.regression.experiment import Experiment
from cdia_pin.robot import load_robot
from cdia_pin.selection.candidates import LARGE_FAMILY, SCREENED
from cdia_pin.selection.discovery_settings import ChangeSettings, DiscoverySettings
from tests.made_logs import make

BLOCKS = 16
PANDA = load_robot("panda")
PAYLOAD = EFFECTS["payload"].from_scope([], {})


class Evidence:
    """Evidence for single changes; beside one of them no other explains anything, however certain it is."""

    def __init__(self, size=0.0, beside=1.0, **offered):
        self.size, self.beside = size, beside  # the latter: certainty beside another change, over that alone
        self.effects = tuple(Difference(effect, ("after",)) for effect, _, _ in offered.values())
        each = [np.broadcast_to(certainty, 2) for _, certainty, _ in offered.values()]
        self.certainties = np.array(each).T  # by time, and by the speeds too
        self.gains = np.array([gains for _, _, gains in offered.values()])
        self.unseen = self.gains.T  # one for each block

    def fits(self, chosen):
        share = 0.0 if len(chosen) else 1.0
        theta = tuple(np.full(e.size, self.size) for e in self.effects)
        certain = self.beside if len(chosen) else 1.0
        return BlockFits(theta, certain * self.certainties, share * self.gains)


class Search(ChangeSearch):
    """A search in which every change is large enough."""

    def _is_visible(self, change, fits):
        return True


def logs(known=()):
    given = SimpleNamespace(model=Dynamics(PANDA, known))
    searched = defaultdict(lambda: 1)
    return SimpleNamespace(
        experiment=SimpleNamespace(robot=PANDA), given=given, block_time=1.0, searched=searched
    )


def search(known=(), **offered):
    return Search(logs(known), Evidence(**offered), ChangeSettings())


def gains(mean, more=0.0, deviations=1.0):
    """What a change explains: the same of each block, and on top something that is some deviations from nothing."""
    scatter = np.tile([1.0, -1.0], BLOCKS // 2) * np.sqrt((BLOCKS - 1) / BLOCKS)
    spread = more / deviations * np.sqrt(BLOCKS)
    return mean + more + spread * scatter


def named(found):
    return [found.evidence.effects[c].effect.name for c in found.changes(2)]


@pytest.mark.parametrize(("certainty", "name"), [(3.0, "payload"), (2.0, "torque_offset")])
def test_a_payload_is_not_the_torque_offset_that_is_a_part_of_it(certainty, name):
    offset = (TorqueOffset("joint1"), 7.0, gains(80.0))
    assert named(search(offset=offset, payload=(PAYLOAD, certainty, gains(80.0, 20.0, 4.0)))) == [name]


@pytest.mark.parametrize(("size", "names"), [(0.9, ["encoder_offset"]), (2.2, [])])
def test_an_encoder_that_is_off_by_radians_is_not_named(size, names):
    assert named(search(size=size, zero=(EncoderOffset("panda_joint1"), 9.0, gains(80.0)))) == names


def test_nothing_is_named_where_nothing_is_certain():
    assert named(search(payload=(PAYLOAD, 4.0, gains(90.0)))) == []


@pytest.mark.parametrize(
    ("effect", "deviations", "name"),
    [
        (AsymmetricFriction("joint1"), 1.6, "coulomb_friction"),  # three parameters more
        (AsymmetricFriction("joint1"), 1.9, "asymmetric_friction"),
        (LoadFriction("joint1"), 1.1, "load_friction"),  # as many parameters
    ],
)
def test_an_effect_with_more_parameters_has_to_explain_more_than_chance(effect, deviations, name):
    plain = (CoulombFriction("joint1"), 10.0, gains(90.0))
    assert named(search(plain=plain, other=(effect, 10.0, gains(90.0, 5.0, deviations)))) == [name]


SPRING = JointSpring("panda_joint2")


@pytest.mark.parametrize(
    ("stiffness", "known", "name"),
    [
        (-1.0, (), "link_inertia"),  # no spring pushes away from its rest; a weight above the joint does
        (1.0, (), "joint_spring"),
        (-1.0, (Term(SPRING, (2.0, 0.0)),), "joint_spring"),  # it can have grown weaker
    ],
)
def test_a_spring_that_the_arm_had_not_does_not_grow_weaker(stiffness, known, name):
    spring, link = (SPRING, 12.0, gains(80.0)), (LinkInertia("panda_joint2"), 9.0, gains(80.5))
    assert named(search(known, size=stiffness, spring=spring, link=link)) == [name]


@pytest.mark.parametrize(("certainty", "name"), [(4.0, "link_inertia"), (1.0, "joint_spring")])
def test_what_takes_away_gives_way_to_what_is_less_certain_and_explains_as_much(certainty, name):
    """Before, a link was called a spring of negative stiffness, whose two parameters are certain sooner."""
    spring, link = (SPRING, 12.0, gains(80.5)), (LinkInertia("panda_joint2"), certainty, gains(80.0))
    assert named(search(size=-1.0, spring=spring, link=link)) == [name]


def test_what_is_certain_is_asked_for_whatever_else_explains_more():
    """Before, forty effects that are not certain hid it."""
    kinds = (TorqueOffset, JointSpring, CoulombFriction, LoadFriction, AsymmetricFriction, LinkInertia)
    vague = [kind(joint) for joint in PANDA.joints for kind in kinds]
    offered = {effect.label: (effect, 1.0, gains(90.0)) for effect in vague}
    assert named(search(**offered, gain=(ActuatorGain("panda_joint2"), 10.0, gains(20.0)))) == [
        "actuator_gain"
    ]


def test_what_the_model_lacks_may_have_gone_if_nothing_else_explains_as_much():
    assert named(search(size=-1.0, spring=(SPRING, 12.0, gains(80.0)))) == ["joint_spring"]


def test_what_explains_as_much_and_is_certain_is_a_rival():
    found = search(
        offset=(TorqueOffset("joint1"), 12.0, gains(80.0)),
        gain=(ActuatorGain("joint1"), 8.0, gains(79.9)),
        friction=(CoulombFriction("joint1"), 3.0, gains(79.9)),
    )
    assert found.rivals([0], 0) == [1]


class Crowded(Evidence):
    """Evidence in which each change keeps its certainty beside others."""

    def fits(self, chosen):
        return super().fits(())


def crowded(certainty, others):
    """A torque offset on one joint, and offsets and friction on the other joints that are not there."""
    own = {"own": (TorqueOffset(PANDA.joints[0]), certainty, gains(80.0))}
    kinds = (TorqueOffset, CoulombFriction)
    rest = {f"{kind.name} {j}": (kind(j), others, gains(1.0)) for kind in kinds for j in PANDA.joints[1:]}
    return Search(logs(), Crowded(**own, **rest), ChangeSettings()).beside([0])


@pytest.mark.parametrize(
    ("certainty", "others", "holds", "confidence"),
    [
        (12.0, 0.8, True, Confidence.ESTABLISHED),
        (12.0, 2.5, True, Confidence.LIKELY),
        (8.0, 2.5, False, Confidence.LIKELY),
        ((12.0, 6.0), 0.8, True, Confidence.LIKELY),  # parts of the speeds say less than blocks of time
        ((12.0, 4.0), 0.8, False, Confidence.LIKELY),
        ((12.0, 12.0), (2.5, 0.8), True, Confidence.LIKELY),  # what is not there seems certain by time alone
    ],
)
def test_a_change_must_be_more_certain_than_effects_that_are_not_there(certainty, others, holds, confidence):
    found = crowded(certainty, others)
    assert found.holds([], 0) is holds
    assert found.confidence([], 0) is confidence


def test_few_effects_that_are_not_there_say_little():
    settings = ChangeSettings()
    assert settings.spread(np.array([])) == 1.0
    assert settings.spread(np.array([4.0])) < 1.6
    assert settings.spread(np.full(200, 4.0)) == pytest.approx(4.0, rel=0.05)
    assert settings.spread(np.full(200, 0.1)) == 1.0  # never less than chance


def test_of_a_large_family_shapes_that_came_and_that_are_gone_are_both_asked_for():
    robot, settings = load_robot("double_pendulum"), DiscoverySettings()
    logs = [replace(make(robot, seed=seed, noise=0.02).log, source=f"{seed}.csv") for seed in (1, 2)]
    experiment = Experiment.of(robot, [condition(log, robot, settings.searched) for log in logs])
    differing = Differing.of(experiment, Dynamics(robot), 1, settings)
    ripples = [c for c in differing.screened() if c.label == "position_ripple@joint2"]
    assert differing.searched["position_ripple@joint2"] > LARGE_FAMILY
    assert [c.sign for c in ripples].count(1.0) == [c.sign for c in ripples].count(-1.0) == SCREENED


class Hiding(Evidence):
    """Evidence for two changes: each is what the blocks of time differ by while the other one is looked for."""

    def __init__(self, beside, one, other):
        super().__init__(size=1.0, one=(one, 3.0, gains(40.0)), other=(other, 3.0, gains(40.0)))
        self.beside = beside  # certainty of each beside the other

    def fits(self, chosen):
        there = np.isin([0, 1], list(chosen))
        certainty = np.where(there, 0.0, self.beside if there.any() else 3.0)
        theta = tuple(np.full(e.size, self.size) for e in self.effects)
        return BlockFits(theta, np.tile(certainty, (2, 1)), self.gains * ~there[:, None])

    def unexplained(self, chosen):
        return np.full(BLOCKS, 80.0 - 40.0 * len(chosen))


@pytest.mark.parametrize(
    ("joint", "beside", "names"),
    [
        ("panda_joint4", (30.0, 20.0), ["coulomb_friction", "actuator_gain"]),
        ("panda_joint4", (30.0, 4.0), []),  # beside the first one the other is not certain
        ("panda_joint4", (4.0, 30.0), []),
        ("panda_joint5", (30.0, 20.0), []),  # what differs on another joint hides nothing
    ],
)
def test_two_changes_of_a_joint_that_hide_each_other_are_found(joint, beside, names):
    """Before, viscous friction and a spring of a quarter of a Panda joint's torque each were no change."""
    evidence = Hiding(beside, CoulombFriction("panda_joint4"), ActuatorGain(joint))
    assert named(Search(logs(), evidence, ChangeSettings())) == names


def test_of_two_changes_that_explain_as_much_the_commoner_one_is_named_whatever_came_first():
    """Before, a body on the last link but one stayed in the place of a payload that was picked up."""
    payload, link = (PAYLOAD, 9.0, gains(80.0)), (LinkInertia("panda_joint6"), 9.0, gains(80.5))
    found = search(link=link, payload=payload)
    moves = found._moves((0,))
    assert next(moves) == (1,)


@pytest.mark.parametrize(
    ("beside", "name"), [(1.0, "asymmetric_friction"), (0.22, "asymmetric_friction"), (0.21, "torque_offset")]
)
def test_what_refines_a_plain_effect_must_be_certain_beside_it(beside, name):
    """An offset leaves a part where the model errs; friction with a level of its own each way takes that in."""
    offered = {
        "offset": (TorqueOffset("panda_joint2"), 13.0, gains(0.96)),
        "friction": (AsymmetricFriction("panda_joint2"), 10.0, gains(1.0)),
    }
    assert named(search(beside=beside, **offered)) == [name]


class Circle(Search):
    """A search whose moves lead back: an effect, one of more parameters beside it, that one alone."""

    def _moves(self, now):
        yield {(): (0,), (0,): (0, 1), (0, 1): (1,), (1,): (0,)}[now]


@pytest.mark.parametrize(("lacking", "named"), [(0.0003, "actuator_gain"), (0.015, "joint_spring")])
def test_of_a_search_that_goes_in_a_circle_a_simpler_set_that_explains_the_same_is_taken(lacking, named):
    offered = {
        "gain": (ActuatorGain("panda_joint2"), 9.0, gains(1.0 - lacking)),
        "spring": (JointSpring("panda_joint2"), 9.0, gains(1.0)),
    }
    evidence = Evidence(**offered)
    evidence.unexplained = lambda chosen: (
        2.0 - max((evidence.gains[c] for c in chosen), default=np.zeros(BLOCKS), key=sum)
    )
    found = Circle(logs(), evidence, ChangeSettings())
    assert [found.evidence.effects[c].effect.name for c in found.changes(3)] == [named]


def test_two_parameters_need_less_certainty_than_one_and_many_shapes_more():
    effects = [JointSpring("panda_joint2"), TorqueOffset("panda_joint2"), JointSpring("panda_joint3")]
    fits = Evidence(**{str(k): (e, 4.4, np.ones(32)) for k, e in enumerate(effects)})
    x = logs()
    x.searched["joint_spring@panda_joint3"] = 6
    spring, offset, shaped = Search(x, fits, ChangeSettings()).certainty(fits.fits(()))
    assert offset == pytest.approx(4.4)
    assert spring > 5.0 > shaped > offset
