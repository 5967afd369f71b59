r"""Simulation of a plant under control, and of the log that its sensors record.

Positions live at t_k, velocities halfway between them (leapfrog [Hairer2006]); with h the step,

.. math:: a_k = \ddot q(q_k, \dot q_k, \tau_k), \quad \dot q_{k+1/2} = \dot q_{k-1/2} + h a_k, \quad
          q_{k+1} = q_k + h \dot q_{k+1/2}, \quad \dot q_{k+1} = \dot q_{k+1/2} + \tfrac{h}{2} a_k

which is of second order in h with one evaluation per step. The second difference of the positions around t_k equals
the acceleration of the torque that is recorded at t_k: holding the torque over a step adds no lag to the log.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cdia_pin.dynamics.controllers import ComputedTorque, Controller
from cdia_pin.dynamics.dynamics import Dynamics
from cdia_pin.dynamics.one_sample import OneSample
from cdia_pin.dynamics.sensors import Sensors
from cdia_pin.dynamics.smoothing import Stiffness
from cdia_pin.dynamics.trajectories import Reference, Trajectory
from cdia_pin.effects import Channel, State, Term
from cdia_pin.errors import ModelError
from cdia_pin.logs.log import Log
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

FASTEST = 1e3  # [rad/s or m/s], a simulation with a larger speed has diverged: no arm is nearly as fast
MOST_STEPS = 30_000_000  # of an integration, eight hours at 1 ms; seven joints take 7 GB and hours
HIGHEST_RATE = 1e5  # [Hz], of a log; no drive records at a higher rate
WATCHED = 50  # [steps], between two checks of the speed
AHEAD = 1000  # [steps] of the desired motion that are computed at once, for speed
WIDE = 0.05  # [1], smoothing width of sgn over the largest speed above which the log gets a note


@dataclass(frozen=True, eq=False, repr=False)
class Run:
    """True motion and torques of a simulation, at every step.

    Attributes:
        time: Time [s], shape (K,).
        q: True positions [rad or m], shape (K, n).
        v: Velocities [rad/s or m/s], shape (K, n).
        a: Accelerations [rad/s² or m/s²], shape (K, n).
        effort: Commanded torques [N·m or N], shape (K, n).
        sign_width: Speed below which sgn q̇ is smoothed [rad/s or m/s], shape (n,).
    """

    time: Array
    q: Array
    v: Array
    a: Array
    effort: Array
    sign_width: Array

    def __repr__(self) -> str:
        steps, joints = self.q.shape
        return f"Run({joints} joints, {steps} steps, {self.time[-1]:.4g} s)"

    def state(self, plant: Dynamics) -> State:
        """Return the run as a state on which effects act.

        Args:
            plant: The plant of this run.

        Returns:
            K samples.
        """
        return State(plant.robot, self.q, self.v, self.a, self.effort, self.time, self.sign_width)


class SimulationStep(NamedTuple):
    """True motion and torques at one step of a simulation.

    Attributes:
        time: Time [s].
        q: True positions [rad or m], shape (n,).
        v: Velocities [rad/s or m/s], shape (n,).
        a: Accelerations [rad/s² or m/s²], shape (n,).
        effort: Commanded torques [N·m or N], shape (n,).
    """

    time: float
    q: Array
    v: Array
    a: Array
    effort: Array


def simulate(
    plant: Dynamics,
    trajectory: Trajectory,
    controller: Controller | None = None,
    *,
    duration: float | None = None,
    rate: float = 250.0,
    step: float | None = None,
    sensors: Sensors | None = None,
    rng: np.random.Generator | None = None,
    progress: Callable[[float], None] | None = None,
) -> Log:
    """Let a plant follow a motion and record it.

    Args:
        plant: The true arm. Its encoder offsets and effort delays act on the readings.
        trajectory: The desired motion; the arm starts at its first position, at rest.
        controller: Called at every step; computed torque on the robot without terms if omitted.
        duration: Length [s]; that of the motion if omitted.
        rate: Samples of the log per second [Hz].
        step: Largest step [s]; if omitted, between 1 ms and 0.2 ms, according to the friction.
        sensors: Imperfections of the recording; none if omitted.
        rng: Source of their noise.
        progress: Called with the share that is done [1], now and then.

    Returns:
        Log of positions, velocities and commanded torques.

    Raises:
        ModelError: If the simulation diverges, or a setting is out of its range.
    """
    sensors = sensors or Sensors()
    if sensors.noisy and rng is None:
        raise ModelError("noise needs a source: give rng=np.random.default_rng(seed)")
    stiffness = Stiffness.of(plant, trajectory)
    if not 0 < rate <= HIGHEST_RATE:
        raise ModelError(f"a log needs a rate above 0 and up to {HIGHEST_RATE:g} Hz, given {rate:g}")
    every = int(np.ceil(1.0 / rate / stiffness.step(step) - 1e-9))
    step = 1.0 / rate / every
    run = run_plant(plant, trajectory, controller, stiffness, duration=duration, step=step, progress=progress)
    return record(plant, run, every, sensors, rng).noted(*_notes(plant, run, stiffness))


def require_steps(duration: float, step: float) -> None:
    """Refuse a simulation that memory does not hold.

    Args:
        duration: Its length [s].
        step: Its step [s].

    Raises:
        ModelError: If it has too many steps.
    """
    if duration / step > MOST_STEPS:
        raise ModelError(
            f"a simulation of {duration:g} s takes {duration / step:.3g} steps of {step:g} s, at most {MOST_STEPS:.3g} "
            "are possible: make it shorter"
        )


def run_plant(
    plant: Dynamics,
    trajectory: Trajectory,
    controller: Controller | None = None,
    stiffness: Stiffness | None = None,
    *,
    duration: float | None = None,
    step: float = 1e-3,
    progress: Callable[[float], None] | None = None,
) -> Run:
    """Integrate a plant under control, without sensors.

    Args:
        plant: The true arm.
        trajectory: The desired motion.
        controller: Computed torque on the robot without terms if omitted.
        stiffness: Stiffness of the plant's friction along the motion; computed if omitted.
        duration: Length [s]; that of the motion if omitted.
        step: Step h [s].
        progress: Called with the share that is done [1], now and then.

    Returns:
        True motion and torques at every step.

    Raises:
        ModelError: If the simulation diverges.
    """
    duration = trajectory.duration if duration is None else duration
    count = int(np.floor(duration / step + 1e-9)) + 1 if duration > 0 else 0
    if count < 2:
        raise ModelError(f"a simulation needs a duration above its step of {step:g} s, given {duration} s")
    require_steps(duration, step)
    width = (stiffness or Stiffness.of(plant, trajectory)).sign_width(step)
    empty = [np.empty((count, plant.robot.n)) for _ in range(4)]
    out = Run(np.empty(count), empty[0], empty[1], empty[2], empty[3], width)
    for k, now in enumerate(islice(steps(lambda t: plant, trajectory, controller, width, step), count)):
        out.time[k], out.q[k], out.v[k], out.a[k], out.effort[k] = now
        if progress and k % WATCHED == 0:
            progress(k / count)
    return out


def steps(
    plant: Callable[[float], Dynamics],
    trajectory: Trajectory,
    controller: Controller | None,
    width: Array,
    step: float,
) -> Iterator[SimulationStep]:
    """Integrate a plant under control step by step, without an end.

    Args:
        plant: Returns the true arm at a time [s]; its terms may change, its robot must not.
        trajectory: The desired motion; the arm starts at its first position, at rest.
        controller: Computed torque on the robot without terms if omitted.
        width: Speed below which sgn q̇ is smoothed [rad/s or m/s], shape (n,).
        step: Step h [s].

    Yields:
        Every step, the first at time zero.

    Raises:
        ModelError: If the simulation diverges.
    """
    arm = plant(0.0)
    robot, moving, shifting = arm.robot, *_acting(arm)
    sample = OneSample(moving, width)
    command = ComputedTorque(Dynamics(robot)) if controller is None else controller
    v = half = tau = np.zeros(robot.n)
    q = trajectory(0.0).q
    q = q + _shift(shifting, State.of(robot, q, v, effort=tau, time=0.0))[0]
    k, memory = 0, moving.memory()
    whole_step, half_step = np.float64(step), np.float64(0.5 * step)
    while True:
        time = step * np.arange(k, k + AHEAD, dtype=float)
        sample.look_ahead(time)
        for i, (t, *asked) in enumerate(zip(time.tolist(), *trajectory(time), strict=True)):
            if (given := plant(t)) is not arm:
                arm, (moving, shifting) = given, _acting(given)
                sample, memory = OneSample(moving, width), moving.memory(memory)
                sample.look_ahead(time)
            read = q - _shift(shifting, State.of(robot, q, v, effort=tau, time=t))[0] if shifting else q
            tau = command(t, read, v, Reference(*asked))
            a = sample.acceleration(i, q, v, tau, memory)
            if k % WATCHED == 0:
                _require_bounded(robot, v, t, step)
            yield SimulationStep(t, q, v, a, tau)
            half = half + (whole_step if k else half_step) * a
            if memory:
                x = State.of(robot, q, v, a, effort=tau, time=t, sign_width=width, memory=memory)
                memory = moving.remembered(x, step * half, step)
            q = q + whole_step * half
            v = half + half_step * a
            k += 1


def _acting(plant: Dynamics) -> tuple[Dynamics, tuple[Term, ...]]:
    """Return the plant with the terms of its motion, and the terms that shift its position readings."""
    return Dynamics(plant.robot, plant.on_motion), plant.on(Channel.POSITION_READING)


def _require_bounded(robot: RobotModel, v: Array, t: float, step: float) -> None:
    if np.abs(v).max() < FASTEST:
        return
    joint = robot.joints[int(np.argmax(np.nan_to_num(np.abs(v), nan=np.inf)))]
    raise ModelError(
        f"the simulation diverged: {joint} is faster than {FASTEST:g} rad/s or m/s at {t:.3g} s; check the parameters, "
        f"the controller's gains and the step of {step:g} s"
    )


def record(
    plant: Dynamics,
    run: Run,
    every: int = 1,
    sensors: Sensors | None = None,
    rng: np.random.Generator | None = None,
) -> Log:
    """Return the log of a run: readings with the plant's sensor effects, then noise and rounding.

    Args:
        plant: The true arm; its encoder offsets and effort delays act on the readings.
        run: Its true motion and torques.
        every: Number of steps per sample [1].
        sensors: Noise and rounding; none if omitted.
        rng: Source of the noise.

    Returns:
        The log, without notes.
    """
    sensors = sensors or Sensors()
    x = run.state(plant)
    position = run.q - _shift(plant.on(Channel.POSITION_READING), x)
    effort = run.effort - sum(t.torque(x) for t in plant.on(Channel.TORQUE_READING))
    kept = np.s_[::every]
    return Log(
        joints=plant.robot.joints,
        time=run.time[kept],
        position=sensors.read_position(position[kept], rng),
        effort=sensors.read_effort(effort[kept], rng),
        velocity=sensors.read_velocity(run.v[kept], rng),
        source=f"simulation of {plant.robot.name}",
    )


def _shift(shifting: Sequence[Term], x: State) -> Array:
    """Return true position minus encoder reading [rad or m], shape (N, n)."""
    return sum((t.shift(x) for t in shifting), np.zeros_like(x.q))


def _notes(plant: Dynamics, run: Run, stiffness: Stiffness) -> list[str]:
    wide = stiffness.rough & (run.sign_width > WIDE * stiffness.speed) & (stiffness.speed > 0)
    return [
        f"friction of {plant.robot.joints[j]} changes its sign over {run.sign_width[j]:.2g} "
        f"{'m/s' if plant.robot.is_prismatic[j] else 'rad/s'}, not at once; a smaller step narrows it"
        for j in np.flatnonzero(wide)
    ]
