"""What changed between logs is asked in the same way when a user asks for parameters per log."""

import pytest

from cdia_pin import Dynamics, discover, load_robot, what_changed
from cdia_pin.selection import DiscoverySettings
from tests.changes.test_conditions import pair

ASKED = "viscous_friction@joint1"


@pytest.fixture(scope="module")
def pendulum():
    return load_robot("double_pendulum")


@pytest.mark.parametrize("asked", [ASKED, "viscous_friction"])
def test_changes_do_not_depend_on_parameters_per_log(pendulum, asked):
    first, second = pair(pendulum, 0.1, 0.2)
    plain, per_log = (
        what_changed(Dynamics(pendulum), first, second, settings=settings).to_dict()
        for settings in (DiscoverySettings(), DiscoverySettings(per_log=(asked,)))
    )
    assert plain["changes"] == per_log["changes"]
    assert [c["effect"] for c in plain["changes"]] == ["viscous_friction"]


def test_a_discovery_gives_parameters_per_log_to_an_effect_that_is_asked_for(pendulum):
    found = discover(
        Dynamics(pendulum), pair(pendulum, 0.1, 0.1), settings=DiscoverySettings(per_log=(ASKED,))
    )
    (term,) = (s.term for s in found.steps if s.term.label.startswith(ASKED))
    assert [p.name for p in term.effect.parameters] == ["coefficient[log1.csv]", "coefficient[log2.csv]"]
    assert term.theta == pytest.approx((0.1, 0.1), rel=0.05)
