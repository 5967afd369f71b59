"""The repr of every result of a study is one short line that names it."""

from dataclasses import replace

import pytest

from cdia_pin import Dynamics, load_robot
from cdia_pin.campaigns.arm_study import ArmCase, arm_faults
from cdia_pin.campaigns.closed_loop import ClosedLoop, LoopSettings
from cdia_pin.campaigns.loop_comparison import compare_loops
from cdia_pin.campaigns.scara_model import scara_model_study
from cdia_pin.campaigns.scara_run import run
from cdia_pin.campaigns.thesis_presets import physical
from cdia_pin.campaigns.thesis_study import Case, Isolation, LearningRule, ThesisStudy
from cdia_pin.diagnosis import Verdict


@pytest.fixture(scope="module")
def examples() -> list[object]:
    arm = load_robot("scara")
    loop = ClosedLoop(Dynamics(arm), LoopSettings(healthy_runs=1, healthy_duration=2.0))
    compared = compare_loops(loop, loop.monitor(), (), 0.1)
    faults = arm_faults(loop, 0.1)["Coulomb friction"]
    arm_case = ArmCase("scara", "a long name " * 30, faults, compared)
    tick = next(loop.ticks(loop.motion(0, 1.0)))
    preset = physical(arm)
    scenario = replace(preset.cases["30 % torque loss"], duration=0.05)
    case = Case("a long name " * 30, 2.0, 4.0, run(scenario), run(scenario), run(scenario))
    names = ("actuator_gain", "coulomb_friction", "position_ripple")
    isolation = Isolation(names, LearningRule.WITH_GRACE, Verdict.UNKNOWN, names, 7, 2.0)
    study = ThesisStudy(arm.joints, {"physical": preset}, {"physical": (case,)}, (isolation,), case)
    model = scara_model_study(states=10)
    loops = [loop, loop.settings, compared, compared.healthy, arm_case, tick]
    return [*loops, preset, scenario, scenario.faults[0], case.healthy, case, isolation, study, model]


def test_a_repr_is_one_short_line_that_names_the_object(examples):
    for shown in examples:
        text = repr(shown)
        assert text.startswith(type(shown).__name__ + "("), text
        assert "\n" not in text
        assert len(text) < 200, text
