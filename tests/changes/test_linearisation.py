"""A change that depends on the torque is as large as it is, not as large as its column at the average of both logs."""

from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks.plant import Fault
from cdia_pin.changes.linearisation import sized_about_themselves
from cdia_pin.effects import EncoderOffset
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


@pytest.mark.parametrize(("per_step", "ends_at"), [(1.5, 1.0), (2.5, 2.2)], ids=["settles", "diverges"])
def test_the_first_step_may_be_too_long_and_the_last_may_not(per_step, ends_at):
    """Steps about a size of 1 from 2.2, where the model fits worse than without the change."""

    def about(changes):
        ((size,),) = changes.values()
        step = np.array([-per_step * (size - 1.0)])
        evidence = SimpleNamespace(estimate=lambda _: (step, np.array([[1e-4]])))
        return SimpleNamespace(misfit=10 * (size - 1.0) ** 2, evidence=lambda: evidence)

    search = SimpleNamespace(
        evidence=SimpleNamespace(
            effects=[EncoderOffset("joint1")], estimate=lambda _: (np.array([2.2]), np.array([[1e-4]]))
        ),
        differing=SimpleNamespace(about=about, misfit=10.0),
    )
    assert sized_about_themselves(search, (0,)).theta == pytest.approx(ends_at, abs=0.01)
