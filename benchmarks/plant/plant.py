"""An arm that is not our model: MuJoCo moves it, faults change it, sensors record it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from benchmarks.plant import cache
from benchmarks.plant.arm import Arm
from benchmarks.plant.faults import Fault, Mechanism, mechanism
from benchmarks.plant.faults.sensing import EffortDelay, EncoderOffset
from benchmarks.plant.model_error import give
from benchmarks.plant.motion import Fourier, Motion, Plan, Reach
from benchmarks.plant.noise import Noise
from benchmarks.plant.run import Run, record
from benchmarks.plant.simulate import Simulated, controller_gains, simulate
from benchmarks.plant.urdf import LinkInertia
from cdia_pin.robot import RobotModel, load_robot

Array = NDArray[np.float64]

LARGEST_STEP = 5e-4  # [s]
SETTLE = 1.0  # [s] at the first posture before the log begins, so that it starts at rest with the faults on
SPEED_SHARE, SPEED_CAP = 0.6, 1.5  # share of the velocity limit [1], and never more than [rad/s or m/s]
EFFORT_SHARE = 0.7  # share of the effort limit that the nominal torque may reach
DRAWS = 8  # motions tried to stay within it
FINER = 4  # a shorter step for what diverges
DAMPED = 0.5  # largest share of a joint's speed that damping may take in one step, which bounds the step


class MujocoPlant:
    """A robot arm in MuJoCo, with faults to order.

    Args:
        robot: A loaded robot, its name in the catalogue, or the path of a URDF.
        step: Largest integration step [s].
        inertias: Inertias of links that are not what the file says; motions and sizes are planned without them.
    """

    def __init__(
        self,
        robot: RobotModel | str | Path,
        *,
        step: float = LARGEST_STEP,
        inertias: Mapping[str, LinkInertia] | None = None,
    ) -> None:
        self.robot = robot if isinstance(robot, RobotModel) else load_robot(robot)
        self.joints = self.robot.joints
        self.step = step
        self.inertias: dict[str, LinkInertia] = {}
        self.nominal = self.arm()
        self.inertias.update(inertias or {})
        limits = self.robot.limits
        speed = np.minimum(SPEED_SHARE * limits.velocity, SPEED_CAP)
        self.reach = Reach(limits.lower, limits.upper, speed, self.joints)

    def arm(self, mechanisms: Sequence[Mechanism] = (), step: float | None = None) -> Arm:
        """Return the compiled arm with its inertias and mechanisms attached."""
        robot = self.robot
        arm = Arm(
            robot.urdf,
            {name: held.position for name, held in robot.locked.items()},
            joints=robot.joints,
            tool=robot.tool_frame,
            gravity=robot.gravity_vector,
            editors=mechanisms,
            step=step or self.step,
        )
        give(arm, self.inertias)
        for k in mechanisms:
            k.attach(arm)
        return arm

    def plan(self, motion: Motion, duration: float, seed: int) -> Plan:
        """Return a motion whose nominal torque stays within limits, or comes closest in a few draws.

        Args:
            motion: Kind of motion.
            duration: Its length [s].
            seed: Seed of the draw.
        """
        grid = np.arange(0.0, duration, 0.05)
        plans = []
        for draw in range(DRAWS):
            plan = motion.plan(self.reach, duration, np.random.default_rng([seed, draw]))
            torque = self.nominal.inverse_dynamics(*plan(grid))
            load = float(np.max(np.abs(torque) / self.robot.limits.effort))
            plans.append((load, draw, plan))
            if load <= EFFORT_SHARE:
                break
        return min(plans)[2]

    def run(
        self,
        faults: Sequence[Fault] = (),
        *,
        motion: Motion | None = None,
        duration: float = 36.0,
        rate: float = 250.0,
        noise: Noise | None = None,
        seed: int = 0,
        noise_seed: int = DRAWS,
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
            noise_seed: Another one gives other noise on the same motion.
            velocity: Whether the log has velocities.
            keep: Whether the noise-free run is kept on disk for the next time.

        Returns:
            The log beside the truth.

        Raises:
            EffectError: If a fault or a parameter of it is unknown.
            FloatingPointError: If the faults make the arm diverge.
        """
        faults, motion = tuple(faults), motion or Fourier()
        robot = self.robot
        name = cache.key(
            robot.urdf.read_bytes(),
            robot.locked,
            robot.tool_frame,
            robot.gravity_vector,
            robot.limits,
            {k: (i.mass, i.com.tolist(), i.tensor.tolist()) for k, i in self.inertias.items()},
            *(self.step, faults, motion, duration, rate, seed),
        )
        exact = cache.load(name) if keep else None
        if exact is None:
            exact = self._exact(faults, motion, duration, rate, seed)
            if keep:
                cache.save(name, exact)
        return record(
            exact,
            self.joints,
            faults,
            noise or Noise(),
            rate=rate,
            velocity=velocity,
            rng=np.random.default_rng([seed, noise_seed]),
            source=f"plant {robot.name}: {', '.join(map(str, faults)) or 'no fault'}, seed {seed}",
        )

    def _exact(
        self, faults: tuple[Fault, ...], motion: Motion, duration: float, rate: float, seed: int
    ) -> dict[str, Array]:
        """Return the run without noise, at the samples of the log."""
        every, step = self._steps([mechanism(f) for f in faults], rate)
        try:
            return self._simulated(faults, motion, duration, rate, seed, every, step)
        except FloatingPointError:  # drive and fault together may need a shorter step than each alone
            return self._simulated(faults, motion, duration, rate, seed, FINER * every, step / FINER)

    def _simulated(
        self,
        faults: tuple[Fault, ...],
        motion: Motion,
        duration: float,
        rate: float,
        seed: int,
        every: int,
        step: float,
    ) -> dict[str, Array]:
        mechanisms = [mechanism(f) for f in faults]
        arm = self.arm(mechanisms)
        arm.use_step(step)
        samples, settle = round(duration * rate), round(SETTLE / step)
        time = np.arange(-settle, (samples - 1) * every + 1) * step
        plan = self.plan(motion, duration, seed)
        reference = plan(np.maximum(time, 0.0))
        # The nominal torque is smooth: with a knot every 4 ms the spline misses it by less than 1e-6 of it.
        knots = np.arange(0.0, time[-1] + 0.008, 0.004)
        torque = self.nominal.inverse_dynamics(*plan(knots))
        feedforward = CubicSpline(knots, torque)(np.maximum(time, 0.0))
        postures = plan(np.linspace(0.0, time[-1], 40)).q
        gains = controller_gains(self.nominal, postures, torque, self.robot.limits.effort, step)
        done = simulate(arm, mechanisms, reference, feedforward, gains, step=step, settle=settle)
        at = np.s_[::every]
        return {
            "time": np.arange(samples) / rate,
            "position": done.q[at].copy(),
            "velocity": done.v[at].copy(),
            "acceleration": done.a[at].copy(),
            "effort": done.command[at].copy(),
            "reference": reference.q[settle:][at].copy(),
            **_readings(mechanisms, done, at, step),
        }

    def _steps(self, mechanisms: Sequence[Mechanism], rate: float) -> tuple[int, float]:
        """Return steps per sample and the step [s]: a shorter one where a light joint is strongly damped."""
        middle = self.nominal.mass_matrix(self.reach.middle)
        free = dict(zip(self.joints, 1 / np.diag(np.linalg.inv(middle)), strict=True))
        step = self.step
        for k in mechanisms:
            for joint in k.fault.joints if k.damping else ():
                step = min(step, DAMPED * float(free[joint]) / k.damping)
        every = max(1, int(np.ceil(1.0 / (rate * step) - 1e-9)))
        return every, 1.0 / (rate * every)


def _readings(mechanisms: Sequence[Mechanism], done: Simulated, at: slice, step: float) -> dict[str, Array]:
    """Return the signals that a sensor at fault reports, where they differ from the truth."""
    time = np.arange(len(done.q)) * step
    out: dict[str, Array] = {}
    for k in mechanisms:
        columns = np.arange(done.q.shape[1]) if k.j < 0 else np.array([k.j])
        if isinstance(k, EffortDelay):
            late = CubicSpline(time, done.command[:, columns])(np.maximum(time[at] - k.p["delay"], 0.0))
            out.setdefault("read_effort", done.command[at].copy())[:, columns] = late
        elif isinstance(k, EncoderOffset):
            out.setdefault("read_position", done.q[at].copy())[:, columns] -= k.p["offset"]
    return out
