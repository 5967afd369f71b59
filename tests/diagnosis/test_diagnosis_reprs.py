"""A public object prints as one short line."""

import numpy as np
import pytest

from cdia_pin import Dynamics, Monitor, MonitorSettings, load_robot
from cdia_pin.diagnosis import Bank, Event, Recorder, Stage, Status, Verdict
from cdia_pin.diagnosis.thesis import ThesisSettings
from cdia_pin.effects import Term, Unknown

ROBOT = load_robot("ur5")
N = ROBOT.n
UNKNOWN = Term(Unknown(ROBOT.joints[0]), (0.0,) * Unknown(ROBOT.joints[0]).size)
EVENT = Event(1.0, "isolation", ROBOT.joints, Verdict.UNKNOWN, (UNKNOWN,) * N, ((UNKNOWN,) * N,))
STATUS = Status(1.0, (Stage.HEALTHY,) * N, np.zeros(N), np.ones(N), np.zeros(N), (UNKNOWN,) * N, (EVENT,))


def monitor() -> Monitor:
    return Monitor(Dynamics(ROBOT), threshold=dict.fromkeys(ROBOT.joints, 1.0), rate=500.0)


@pytest.mark.parametrize(
    "made",
    [
        lambda: Bank.of(ROBOT),
        lambda: EVENT,
        lambda: STATUS,
        lambda: MonitorSettings(votes=5),
        ThesisSettings,
        monitor,
        lambda: Recorder(monitor()),
        lambda: Recorder(monitor()).finish(),
    ],
)
def test_a_repr_is_one_short_line(made) -> None:
    text = repr(made())
    assert len(text) < 200
    assert "\n" not in text


def test_settings_print_what_differs_from_the_defaults() -> None:
    assert repr(MonitorSettings(votes=5)) == "MonitorSettings(votes=5)"
    assert repr(MonitorSettings()) == "MonitorSettings()"
