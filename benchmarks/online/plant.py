"""A closed loop: an arm in MuJoCo that is not the model, sensors, drives, faults, and a controller to try.

plant = OnlinePlant("ur5", seed=1)
run = plant.run(controller, plant.reference(seed=3), [Fault("coulomb_friction", joint=..., level=4, after=3)])
run.fault_torque
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from benchmarks.online.faults import mechanism
from benchmarks.online.motions import Onward
from benchmarks.online.physics import Physics
from benchmarks.online.run import OnlineRun
from benchmarks.online.sensors import Readings, Sensors
from benchmarks.plant.arm import Arm
from benchmarks.plant.faults import Fault, Mechanism
from benchmarks.plant.model_error import erroneous, give
from benchmarks.plant.motion import Motion, Plan, Reference
from benchmarks.plant.plant import MujocoPlant
from benchmarks.plant.simulate import FASTEST
from cdia_pin.robot import RobotModel

Array = NDArray[np.float64]

# Faults that change the arm itself: their torque is found by inverse dynamics, after the run.
BODIES = ("payload", "link_inertia", "base_tilt", "tool_wrench", "viscous_medium")
OFTEN = 256  # ticks between two looks at whether the simulation has diverged


class Controller(Protocol):
    """Anything that answers a reading with a torque, once per tick."""

    def __call__(self, t: float, q: Array, v: Array | None, reference: Reference) -> Array:
        """Return the torque to command [N·m or N], shape (n,).

        Args:
            t: Time [s].
            q: Positions as measured [rad or m], shape (n,).
            v: Velocities as measured [rad/s or m/s], shape (n,), or None.
            reference: The motion asked for now, (n,) each.
        """
        ...


@dataclass(frozen=True)
class Drives:
    """How a command becomes a torque.

    Attributes:
        rate: Ticks per second; a command is held from one to the next [Hz].
        delay: Time from a command to its torque, rounded to physical steps [s].
    """

    rate: float = 1000.0
    delay: float = 0.0


class OnlinePlant:
    """An arm to be controlled, whose inertias differ from its file's.

    Args:
        robot: A loaded robot, its name in the catalogue, or the path of a URDF.
        model_error: Largest relative error of masses, centres and inertias [1].
        seed: Seed of these errors.
        sensors: Imperfections of the readings.
        drives: Imperfections of the torque.
    """

    def __init__(
        self,
        robot: RobotModel | str | Path,
        *,
        model_error: float = 0.03,
        seed: int = 0,
        sensors: Sensors | None = None,
        drives: Drives | None = None,
    ) -> None:
        self.nominal = MujocoPlant(robot)  # the arm that the file describes
        self.robot = self.nominal.robot
        self.joints = self.robot.joints
        self.sensors, self.drives = sensors or Sensors(), drives or Drives()
        self.inertias = erroneous(self.nominal.nominal.file.inertias, model_error, seed)

    def arm(self, mechanisms: Sequence[Mechanism] = (), step: float | None = None) -> Arm:
        """Return the compiled arm with its true inertias and mechanisms attached."""
        arm = self.nominal.arm(mechanisms, step)
        give(arm, self.inertias)
        for k in mechanisms:
            k.found()  # anew, for those that note inertias
        return arm

    def reference(self, motion: Motion | None = None, duration: float = 10.0, seed: int = 0) -> Plan:
        """Return a motion within the robot's limits; the usual one if none is named."""
        return self.nominal.plan(motion or Onward(), duration, seed)

    def run(
        self,
        controller: Controller,
        reference: Callable[[Array], Reference],
        faults: Sequence[Fault] = (),
        duration: float = 10.0,
        seed: int = 0,
    ) -> OnlineRun:
        """Let a controller move the arm, which starts at rest where the reference does.

        Args:
            controller: Called once per tick.
            reference: Motion as a function of times (K,) [s].
            faults: What the model does not know.
            duration: Length of the run [s].
            seed: Seed of the sensors' noise.

        Raises:
            EffectError: If a fault or a parameter of it is unknown.
            FloatingPointError: If the arm diverges.
        """
        faults = tuple(faults)
        mechanisms = [mechanism(f) for f in faults]
        # shorter where a joint is strongly damped
        every, step = self.nominal._steps(mechanisms, self.drives.rate)
        time = np.arange(round(duration * self.drives.rate)) / self.drives.rate
        wanted = Reference(*(np.ascontiguousarray(s) for s in reference(time)))
        rows = [Reference(*row) for row in zip(*wanted, strict=True)]
        arm = self.arm(mechanisms, step)
        physics = Physics(arm, mechanisms, wanted.q[0], step)
        read = Readings(self.sensors, self.robot.is_prismatic, len(time), np.random.default_rng(seed))
        command, limited, arrived, q, v, a, f = (np.empty_like(wanted.q) for _ in range(7))
        most = self.robot.limits.effort
        late = round(self.drives.delay / step)  # steps
        for k, t in enumerate(time.tolist()):
            q[k], v[k] = physics.q, physics.v
            command[k] = controller(t, *read(k, q[k], v[k]), rows[k])
            np.minimum(np.maximum(command[k], -most), most, out=limited[k])
            for i in range(every):
                torque = limited[max((k * every + i - late) // every, 0)]  # at rest before the first command
                physics.respond(t + i * step, torque)
                if i == 0:
                    arrived[k], a[k], f[k] = torque, physics.a, physics.fault_torque(torque)
                physics.integrate()
            if k % OFTEN == 0 and not np.abs(physics.v).max() < FASTEST:
                raise FloatingPointError(f"the plant diverged at {t:g} s with {faults or 'no fault'}")
        if any(fault.effect in BODIES for fault in faults):
            f = self.arm().inverse_dynamics(q, v, a) - arrived
        return OnlineRun(self.joints, time, read.q, read.v, command, arrived, q, v, a, wanted, f, faults)
