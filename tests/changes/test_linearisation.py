"""A change that depends on the torque is as large as it is, not as large as its column at the average of both logs."""

import pytest

from benchmarks.plant import Fault
from tests.changes.test_changes import WRONG, changed, the_only


@pytest.mark.parametrize("gain", [-0.25, 0.35])
def test_a_motor_that_lost_a_quarter_of_its_torque_lost_a_quarter(gain):
    # at the average of both logs it would be g / (1 + g / 2): -0.29 and 0.30
    change = the_only(changed(WRONG, (*WRONG, Fault("actuator_gain", joint="elbow_joint", gain=gain))))
    assert change.term.label == "actuator_gain@elbow_joint"
    assert change.term.values["gain"] == pytest.approx(gain, rel=0.03)


def test_friction_under_load_is_as_large_as_it_is():
    worn = (*WRONG, Fault("load_friction", joint="shoulder_lift_joint", coefficient=0.25))
    change = the_only(changed(WRONG, worn))
    assert change.term.label == "load_friction@shoulder_lift_joint"
    assert change.term.values["coefficient"] == pytest.approx(0.25, rel=0.04)
