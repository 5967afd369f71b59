"""Whether an effect of the whole arm is there is asked of its parameters together."""

import numpy as np
import pytest

from cdia_pin.diagnosis.whole_arm.hypotheses import HYPOTHESES
from cdia_pin.diagnosis.whole_arm.isolation import ArmDecision
from cdia_pin.diagnosis.whole_arm.trial import is_gone, why

PAYLOAD = HYPOTHESES[0]
HANGS_AT = 0.3  # [m]


def decision(theta: tuple[float, ...], explained: float = 0.95) -> ArmDecision:
    """What a motion shows in which all joints move in step: m + z / 0.3 m to 0.05 kg, and each alone hardly.

    Args:
        theta: Mass [kg] and first moments [kg·m].
        explained: Share of the remainder that it explains [1].
    """
    shown = np.array([1.0, 0.0, 0.0, 1.0 / HANGS_AT]) / 0.05
    weak = np.diag(1.0 / np.array([1.0, 0.01, 0.01, 0.3]) ** 2)
    return ArmDecision(0, np.array(theta), np.outer(shown, shown) + weak, 20.0, explained)


def test_a_payload_is_sure_though_each_interval_holds_zero() -> None:
    found = decision((0.3, 0.0, 0.0, 0.09))
    assert (np.abs(found.theta) < found.half).all()
    assert found.is_sure
    assert not decision((0.3, 0.0, 0.0, 0.09), explained=0.7).is_sure


def test_two_parameters_that_cancel_in_the_torque_are_nothing() -> None:
    assert not decision((0.3, 0.0, 0.0, -0.09)).is_sure


def test_the_event_says_that_no_number_is_known() -> None:
    found = decision((0.3, 0.0, 0.0, 0.09))
    assert "none of its numbers" in why(PAYLOAD.term(found.theta, found.half))
    assert why(PAYLOAD.term(np.array([2.0, 0.0, 0.0, 0.1]), found.half)) == "one cause for all joints"


@pytest.mark.parametrize(
    ("change", "gone"),
    [
        ((-0.3, 0.0, 0.0, -0.09), True),
        ((-0.27, 0.0, 0.0, -0.08), True),  # a tenth is left, as its formula may miss
        ((-0.6, 0.0, 0.0, 0.0), True),  # the same torque, as another mass elsewhere
        ((-0.1, 0.0, 0.0, -0.03), False),
        ((0.0, 0.0, 0.0, 0.0), False),
    ],
)
def test_what_is_put_down_is_gone(change: tuple[float, ...], gone: bool) -> None:
    assert is_gone(np.array([0.3, 0.0, 0.0, 0.09]), decision(change)) == gone
