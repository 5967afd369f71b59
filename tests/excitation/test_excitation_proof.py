"""What a poor motion leaves open the designed one decides: shown on arms in MuJoCo, with noise and quantisation."""

import pytest

from benchmarks.plant import Fault
from benchmarks.plant.motion import Fourier, Given, small
from cdia_pin import Dynamics, ExcitationSettings, discover, excite
from cdia_pin.discovery import Discovery
from cdia_pin.effects import parse_effect
from tests.hidden_plants import label, labels, plant_of

FIRST_ALONE = Fourier(joints=("joint1",), speed=0.2)
SETTINGS = ExcitationSettings(duration=24.0, draws=16, refinements=32)
# arm, what is hidden, the poor motion, the rival
CASES = {
    "a weak drive, a heavier link": (
        "double_pendulum", Fault("actuator_gain", joint="joint1", gain=-0.2), FIRST_ALONE, "link_inertia@joint1"
    ),
    "a heavier link, a weak drive": (
        "double_pendulum", Fault("link_inertia", joint="joint1", mass=0.15), FIRST_ALONE, "tool_wrench"
    ),
    "a spring, a heavier link": (
        "ur5",
        Fault("joint_spring", joint="shoulder_lift_joint", stiffness=10.0, preload=0.0),
        small(0.1),
        "link_inertia@shoulder_lift_joint",
    ),
}  # fmt: skip


def named(found: Discovery) -> set[str]:
    """What was found, and what else it could be."""
    return labels(found) | {e.label for s in found.steps for c in s.confusions for e in c.effects}


@pytest.mark.parametrize("case", CASES)
def test_the_designed_motion_decides_what_the_poor_one_leaves_open(case):
    arm, fault, poor, rival = CASES[case]
    plant, hidden = plant_of(arm), label(fault)
    model = Dynamics(plant.robot)
    log = plant.run([fault], motion=poor, seed=2, duration=30.0).log
    assert {hidden, rival} <= named(discover(model, log))

    pair = (parse_effect(hidden, plant.robot), parse_effect(rival, plant.robot))
    motion = excite(model, between=pair, after=log, settings=SETTINGS)
    assert motion.gain.enough
    assert motion.gain.after > motion.gain.before

    given = Given(motion.trajectory, motion.trajectory.duration)
    again = plant.run([fault], motion=given, seed=3, duration=SETTINGS.duration).log
    found = discover(model, again)
    assert labels(found) == {hidden}
    assert rival not in named(found)
    assert found.verdict == "explained"


def test_the_plant_follows_a_given_motion():
    plant = plant_of("double_pendulum")
    motion = excite(plant.robot, settings=ExcitationSettings(duration=8.0, draws=1, refinements=0))
    run = plant.run(motion=Given(motion.trajectory, 8.0), duration=8.0)
    error = run.truth.position - motion.trajectory(run.truth.time).q
    assert abs(error).max() < 0.02
