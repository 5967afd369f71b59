"""The commands on measured logs of real arms, where they are."""

import json

import pytest

from cdia_pin import load_model, load_robot
from cdia_pin.discovery import DiscoveryVerdict


def test_a_bag_says_the_same_as_the_csv(cdia, measured):
    csv, bag = (
        cdia("compare", measured / "ur10" / name, "--robot", "ur10", "--cutoff", 5, "--json", "-").json
        for name in ("exciting.csv", "exciting.db3")
    )
    for key in ("rms", "relative_rms", "bias"):
        assert bag[key] == pytest.approx(csv[key], rel=1e-3)


SIMPLE = ("--effects", "coulomb_friction,viscous_friction,torque_offset")  # quick
LOGS = {
    "panda": ("panda/exciting.csv", "panda", SIMPLE),
    "ur10": ("ur10/exciting.csv", "ur10", SIMPLE),
    "ur10e": ("ur10e/fourier_40s.csv", "ur10e/ur10e.urdf", (*SIMPLE, "--gains", "ur10e/drive_gains.json")),
}


@pytest.mark.parametrize("arm", LOGS)
def test_discover_ends_with_a_verdict_and_a_model(cdia, measured, tmp_path, arm):
    log, robot, options = LOGS[arm]
    robot = str(measured / robot) if robot.endswith(".urdf") else robot
    options = [measured / o if o.endswith(".json") else o for o in options]
    model, result = tmp_path / "model.json", tmp_path / "result.json"
    outcome = cdia("discover", measured / log, "--robot", robot, *options, "--save", model, "--json", result)
    assert outcome.code == 0, outcome.err
    found = json.loads(result.read_text())
    assert found["verdict"] in set(DiscoveryVerdict)
    assert load_model(model, load_robot(robot)).terms
    first, last = found["trace"][0], found["trace"][-1]
    mean = lambda step: sum(step["heldout_rms"][j] / found["torque_rms"][j] for j in found["joints"])  # noqa: E731
    assert mean(last) < mean(first)
