"""An arm that is not our model: MuJoCo moves it, faults change it, sensors record it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from benchmarks.plant import cache
from benchmarks.plant.arm import GRAVITY, Arm
from benchmarks.plant.faults import Fault, Mechanism, mechanism
from benchmarks.plant.faults.sensing import EffortDelay, EncoderOffset
from benchmarks.plant.motion import Fourier, Motion, Plan, Reach
from benchmarks.plant.noise import Noise
from benchmarks.plant.simulate import SETTLE, controller_gains, simulate
from cdia_pin.logs.log import Log
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

LARGEST_STEP = 5e-4  # [s]
SPEED_SHARE, SPEED_CAP = 0.6, 1.5  # share of the velocity limit [1], and never more than [rad/s or m/s]
EFFORT_SHARE = 0.7  # share of the effort limit that the nominal torque may reach
DAMPED = 0.5  # largest share of a joint's speed that explicit damping may take in one step


class Truth(NamedTuple):
    """What the arm really did, shape (N, n) each: M q̈ + nle = effort + f holds at each sample.

    Attributes:
        time: Time [s], shape (N,).
        position: True positions [rad or m].
        velocity: True velocities [rad/s or m/s].
        acceleration: True accelerations [rad/s² or m/s²].
        effort: Commanded torques, without noise or delay [N·m or N].
        reference: Positions asked for [rad or m].
    """

    time: Array
    position: Array
    velocity: Array
    acceleration: Array
    effort: Array
    reference: Array


@dataclass(frozen=True)
class Run:
    """One run of the plant.

    Attributes:
        log: What the sensors recorded.
        truth: What really happened.
        noise_std: Standard deviation of the torque noise [N·m or N], shape (n,).
        faults: What was hidden.
    """

    log: Log
    truth: Truth
    noise_std: Array
    faults: tuple[Fault, ...]


class MujocoPlant:
    """A robot arm in MuJoCo, with faults to order.

    Args:
        robot: A loaded robot, the name of one in the catalogue, or the path of a URDF.
        locked: Position of each joint that does not move, where a path is given.
        tool: Link that carries a payload, where a path is given; the last one if omitted.
    """

    def __init__(
        self,
        robot: RobotModel | str | Path,
        locked: Mapping[str, float] | None = None,
        tool: str | None = None,
    ) -> None:
        joints: Sequence[str] | None = None
        gravity = np.array(GRAVITY)
        if isinstance(robot, str) and not robot.endswith(".urdf"):
            from cdia_pin.robot.catalogue import load_robot

            robot = load_robot(robot)
        if isinstance(robot, RobotModel):
            urdf, joints = robot.urdf, robot.joints
            locked = {name: held.position for name, held in robot.locked.items()}
            tool, gravity = tool or robot.tool_frame, robot.gravity_vector
            self.name = robot.name
        else:
            urdf = Path(robot)
            self.name = urdf.stem
        self._description = (Path(urdf), dict(locked or {}), joints, tool, gravity)
        self.nominal = self.arm()
        self.joints = self.nominal.joints
        limits = [self.nominal.file.limits[j] for j in self.joints]
        self.effort_limits = np.array([k.effort for k in limits])
        self.reach = Reach(
            np.array([k.lower for k in limits]),
            np.array([k.upper for k in limits]),
            np.minimum(SPEED_SHARE * np.array([k.velocity for k in limits]), SPEED_CAP),
            self.joints,
        )

    def arm(self, mechanisms: Sequence[Mechanism] = (), step: float = LARGEST_STEP) -> Arm:
        """Return the compiled arm with mechanisms attached; nominal without."""
        urdf, locked, joints, tool, gravity = self._description
        arm = Arm(urdf, locked, joints=joints, tool=tool, gravity=gravity, editors=mechanisms, step=step)
        for k in mechanisms:
            k.attach(arm)
        return arm

    # ---------------------------------------------------------------- motion

    def plan(self, motion: Motion, duration: float, seed: int) -> Plan:
        """Return a motion whose nominal torque stays within limits, or comes closest in a few draws.

        Args:
            motion: Kind of motion.
            duration: Its length [s].
            seed: Seed of the draw.
        """
        grid = np.arange(0.0, duration, 0.05)
        best: tuple[float, Plan] | None = None
        for draw in range(8):
            plan = motion.plan(self.reach, duration, np.random.default_rng([seed, draw]))
            torque = self.nominal.inverse_dynamics(*plan(grid))
            load = float(np.max(np.abs(torque) / self.effort_limits))
            if best is None or load < best[0]:
                best = (load, plan)
            if load <= EFFORT_SHARE:
                break
        assert best is not None
        return best[1]

    # ---------------------------------------------------------------- runs

    def run(
        self,
        faults: Sequence[Fault] = (),
        *,
        motion: Motion | None = None,
        duration: float = 36.0,
        rate: float = 250.0,
        noise: Noise | None = None,
        seed: int = 0,
        velocity: bool = False,
        keep: bool = True,
    ) -> Run:
        """Move the arm and record it.

        Args:
            faults: What the nominal model does not know.
            motion: Kind of motion; a Fourier series on all joints if omitted.
            duration: Length of the log [s].
            rate: Sampling rate of the log [Hz].
            noise: Imperfections of the sensors; the usual ones if omitted.
            seed: Seed of motion and noise.
            velocity: Whether the log has velocities.
            keep: Whether the noise-free run is kept on disk for the next time.

        Returns:
            The log beside the truth.
        """
        faults, motion, noise = tuple(faults), motion or Fourier(), noise or Noise()
        urdf, *rest = self._description
        name = cache.key(urdf.read_bytes(), *rest, faults, motion, duration, rate, seed)
        exact = cache.load(name) if keep else None
        if exact is None:
            exact = self._exact(faults, motion, duration, rate, seed)
            if keep:
                cache.save(name, exact)
        rng = np.random.default_rng([seed, 1])
        std = noise.std_of(exact["effort"])
        shape = exact["effort"].shape
        efforts = exact["read_effort"] + std * noise.draw(shape, rate, rng)
        velocities = exact["velocity"] + noise.velocity_std * rng.standard_normal(shape) if velocity else None
        log = Log(
            joints=self.joints,
            time=exact["time"],
            position=noise.quantise(exact["read_position"]),
            effort=efforts,
            velocity=velocities,
            source=f"plant {self.name}: {', '.join(map(str, faults)) or 'no fault'}, seed {seed}",
        )
        return Run(log, Truth(*(exact[k] for k in Truth._fields)), std, faults)

    def _exact(
        self, faults: tuple[Fault, ...], motion: Motion, duration: float, rate: float, seed: int
    ) -> dict[str, Array]:
        mechanisms = [mechanism(f) for f in faults]
        every, step = self._steps(faults, rate)
        samples = round(duration * rate)
        settle = round(SETTLE / step)
        time = np.maximum(np.arange(-settle, (samples - 1) * every + 1) * step, 0.0)
        plan = self.plan(motion, duration, seed)
        reference = plan(time)
        # The nominal torque is smooth: every 4 ms is enough for a spline to be exact to the micronewton metre.
        knots = np.arange(0.0, time[-1] + 0.008, 0.004)
        torque = self.nominal.inverse_dynamics(*plan(knots))
        feedforward = CubicSpline(knots, torque)(time)
        postures = plan(np.linspace(0.0, time[-1], 40)).q
        gains = controller_gains(self.nominal, postures, torque, self.effort_limits, step)
        arm = self.arm(mechanisms, step)
        done = simulate(arm, mechanisms, reference, feedforward, gains, step=step, settle=settle)
        fine = np.arange(len(done.q)) * step
        at = np.s_[::every]
        read_effort, read_position = done.command[at].copy(), done.q[at].copy()
        for k in mechanisms:
            columns = np.arange(len(self.joints)) if k.j < 0 else np.array([k.j])
            if isinstance(k, EffortDelay):
                late = CubicSpline(fine, done.command[:, columns])
                read_effort[:, columns] = late(np.maximum(fine[at] - k.p["delay"], 0.0))
            elif isinstance(k, EncoderOffset):
                read_position[:, columns] -= k.p["offset"]
        return {
            "time": np.arange(samples) / rate,
            "position": done.q[at].copy(),
            "velocity": done.v[at].copy(),
            "acceleration": done.a[at].copy(),
            "effort": done.command[at].copy(),
            "reference": reference.q[settle:][at].copy(),
            "read_effort": read_effort,
            "read_position": read_position,
        }

    def _steps(self, faults: Sequence[Fault], rate: float) -> tuple[int, float]:
        """Return integration steps per sample, and the step [s]; smaller where damping is strong for a joint."""
        step = LARGEST_STEP
        at = self.nominal.mass_matrix(self.reach.middle)
        free = 1 / np.diag(np.linalg.inv(at))
        for fault in faults:
            strongest = [abs(v) for k, v in fault.parameters.items() if k.startswith("coefficient")]
            if not strongest or fault.effect in {"load_friction"}:
                continue
            for joint in fault.joints:
                largest = float(max(strongest))
                step = min(step, DAMPED * float(free[self.joints.index(joint)]) / max(largest, 1e-12))
        every = max(1, int(np.ceil(1.0 / (rate * step) - 1e-9)))
        return every, 1.0 / (rate * every)


