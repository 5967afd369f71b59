"""Nothing is compiled in a control loop: what a monitor compiled when it was made serves all that it meets."""

import numpy as np

from cdia_pin.diagnosis import (
    Monitor,
    correction_kernel,
    fits,
    kernels,
    lasting_kernel,
    sample_kernel,
)
from cdia_pin.diagnosis.whole_arm import contact_kernel, evidence_kernel, isolation_kernel
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Payload, State
from cdia_pin.robot import load_robot
from cdia_pin.robot.inertia import parameters_of

KERNELS = (
    correction_kernel,
    fits,
    kernels,
    lasting_kernel,
    sample_kernel,
    contact_kernel,
    evidence_kernel,
    isolation_kernel,
)
RATE = 500.0


def compiled() -> dict[str, int]:
    """In how many types of arguments each function of the kernels was compiled."""
    return {
        f"{module.__name__}.{name}": len(f.signatures)
        for module in KERNELS
        for name, f in vars(module).items()
        if hasattr(f, "signatures")
    }


def test_a_payload_is_met_and_a_monitor_restored_without_compiling(tmp_path) -> None:
    robot = load_robot("ur5")
    monitor = Monitor(Dynamics(robot), threshold=dict.fromkeys(robot.joints, 1.0), rate=RATE)
    before = compiled()
    t = np.arange(0.0, 8.0, 1.0 / RATE)
    w = np.linspace(1.0, 2.0, robot.n)
    q, v, a = np.sin(t[:, None] * w), w * np.cos(t[:, None] * w), -(w**2) * np.sin(t[:, None] * w)
    x = State.of(robot, q, v, a)
    body = parameters_of(4.0, (0.0, 0.0, 0.1), 0.01 * np.eye(3))
    tau = x.effort - np.where(t > 2.0, 1.0, 0.0)[:, None] * Payload().torque(x, body)

    def feed(begin: float, end: float) -> None:
        for k in np.flatnonzero((t >= begin) & (t < end)):
            monitor.update(t[k], q[k], v[k], tau[k])
            monitor.correct(tau[k], v[k])

    feed(0.0, 3.0)
    path = monitor.save(tmp_path / "monitor.npz")
    monitor = Monitor.load(path, robot)
    feed(3.0, 8.0)
    assert "payload" in [term.effect.name for term in monitor.faults]
    assert compiled() == before
