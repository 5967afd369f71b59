"""A closed loop around an arm with faults: nominal control, a monitor that watches and corrects it, or neither.

The plant's bodies differ from the model's by a few percent, its positions are read in steps, its velocities and
torques with noise. The monitor learns from healthy runs of the same plant on other motions.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdia_pin.campaigns.model_error import with_model_error
from cdia_pin.campaigns.monitored_control import MonitoredControl, Tick
from cdia_pin.diagnosis import DEFAULT_BANK, Bank, Monitor, MonitorRun, Recorder
from cdia_pin.dynamics.controllers import ComputedTorque
from cdia_pin.dynamics.dynamics import Dynamics
from cdia_pin.dynamics.simulate import Run, run_plant, steps
from cdia_pin.dynamics.smoothing import Stiffness
from cdia_pin.dynamics.trajectories import Trajectory, exciting_trajectory
from cdia_pin.effects import JointEffect, Term
from cdia_pin.errors import ModelError
from cdia_pin.logs.log import Log
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]
Tell = Callable[[str, float], None]

ENCODER, SLIDE_ENCODER = 2e-5, 2e-6  # [rad], [m], step of a position as it is read
VELOCITY, SLIDE_VELOCITY = 1e-3, 1e-4  # [rad/s], [m/s], deviation of a velocity's noise


@dataclass(frozen=True)
class LoopSettings:
    """What a closed loop is like.

    Attributes:
        rate: Ticks of control per second; a torque is held from one to the next [Hz].
        noise: Noise of the measured torques over their RMS; with any, positions and velocities have theirs [1].
        model_error: Largest relative error of the model's inertias [1].
        healthy_runs: Runs that a monitor learns from.
        healthy_duration: Length of each [s].
        seed: Of motions, noise and model error.
    """

    rate: float = 1000.0
    noise: float = 0.01
    model_error: float = 0.03
    healthy_runs: int = 2
    healthy_duration: float = 20.0
    seed: int = 0

    def __post_init__(self) -> None:
        if not (self.rate > 0 and self.noise >= 0 and self.healthy_runs > 0 and self.healthy_duration > 0):
            raise ModelError(
                "a closed loop needs rate > 0 Hz, noise ≥ 0, and healthy runs longer than 0 s, given "
                f"{self.rate}, {self.noise}, {self.healthy_runs} × {self.healthy_duration}"
            )
        if self.seed < 0:
            raise ModelError(f"a seed is 0 or more, given {self.seed}")


@dataclass(frozen=True, eq=False)
class LoopRun:
    """One run of the loop.

    Attributes:
        run: What really happened, at every step of the integration.
        log: What the controller saw, at every tick; with each sample the torque that acted since the one before.
        error: Position less desired position, as it really was, at every tick [rad or m], shape (K, n).
        monitored: What the monitor said; None without one.
    """

    run: Run
    log: Log
    error: Array
    monitored: MonitorRun | None = None

    def tracking(self, since: float = -np.inf) -> Array:
        """Return the RMS of the tracking error from a time on [rad or m], shape (n,)."""
        return np.asarray(np.sqrt(np.mean(self.error[self.log.time >= since] ** 2, axis=0)))


@dataclass(frozen=True)
class ClosedLoop:
    """A plant, the model that its controller has of it, and their sensors.

    Attributes:
        model: What the controller and the monitor know.
        settings: Rate, noise, error of the model.
        robot: The bodies that the plant really has.
        effort_noise: Deviation of the measured torques' noise [N·m or N], shape (n,).
    """

    model: Dynamics
    settings: LoopSettings = field(default_factory=LoopSettings)
    robot: RobotModel = field(init=False)
    effort_noise: Array = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        s, robot = self.settings, self.model.robot
        body = with_model_error(robot, s.model_error, np.random.default_rng([s.seed, 1]))
        object.__setattr__(self, "robot", body)
        motion = self.motion(0, s.healthy_duration)(np.linspace(0, s.healthy_duration, 400))
        torque = robot.inverse_dynamics(motion.q, motion.v, motion.a)
        object.__setattr__(self, "effort_noise", s.noise * np.sqrt(np.mean(torque**2, axis=0)))

    def motion(self, number: int, duration: float) -> Trajectory:
        """Return one of the loop's motions; different numbers, different motions."""
        return exciting_trajectory(
            self.model.robot, np.random.default_rng([self.settings.seed, 2, number]), duration=duration
        )

    def monitor(
        self,
        *,
        bank: Bank | Iterable[str | JointEffect] = DEFAULT_BANK,
        engine: str = "momentum",
        settings: Any = None,
        progress: Tell = lambda sentence, share: None,
    ) -> Monitor:
        """Return a monitor that has learned from healthy runs, on motions that are used for nothing else.

        Args:
            bank: Known effects that are asked of every joint.
            engine: ``momentum`` or ``thesis``.
            settings: Of the engine.
            progress: Told what is done, and the share that is done.
        """
        s = self.settings
        runs = []
        for k in range(s.healthy_runs):
            progress(f"healthy run {k + 1} of {s.healthy_runs}", k / s.healthy_runs)
            runs.append(self.run(self.motion(100 + k, s.healthy_duration), noise=100 + k).log)
        progress("learning from the healthy runs", 1.0)
        return Monitor(self.model, healthy=runs, bank=bank, engine=engine, settings=settings)

    def run(
        self,
        motion: Trajectory,
        faults: Sequence[Term] = (),
        monitor: Monitor | None = None,
        *,
        noise: int = 0,
        progress: Callable[[float], None] | None = None,
    ) -> LoopRun:
        """Let the plant follow a motion.

        Args:
            motion: Asked for.
            faults: What the plant has and the model has not.
            monitor: Watches, and corrects if its settings say so.
            noise: Number of the noise; the same number, the same noise.
            progress: Told the share that is done, now and then.

        Raises:
            ModelError: If the arm runs away.
        """
        plant = self._plant(faults)
        stiffness, inner = self._steps(plant, motion)
        recorder = Recorder(monitor) if monitor is not None else None
        seen = []

        def watch(tick: Tick) -> None:
            seen.append((tick.time, tick.q, tick.v, tick.effort))
            if recorder is not None and tick.status is not None:
                recorder(tick.status, tick.q, tick.v, tick.effort, tick.desired)

        control = self._control(monitor, noise, watch)
        step = 1.0 / self.settings.rate / inner
        run = run_plant(plant, motion, control, stiffness, step=step, progress=progress)
        time, q, v, tau = (np.array(column) for column in zip(*seen, strict=True))
        source = f"closed loop of {plant.robot.name}, motion seed {self.settings.seed}"
        log = Log(plant.robot.joints, time, q, tau, v, source=source)
        monitored = None if recorder is None else recorder.finish(loop=vars(self.settings))
        return LoopRun(run, log, run.q[::inner][: len(time)] - motion(time).q, monitored)

    def ticks(
        self,
        motion: Trajectory,
        faults: Sequence[Term] = (),
        monitor: Monitor | None = None,
        *,
        acts: Callable[[Term], bool] = lambda fault: True,
        noise: int = 0,
    ) -> Iterator[Tick]:
        """Let the plant follow a motion tick by tick, for as long as ticks are asked for.

        Args:
            motion: Asked for.
            faults: What the plant may have and the model has not.
            monitor: Watches, and corrects if its settings say so.
            acts: Tells which of the faults act now, so that they can be switched while the arm moves.
            noise: Number of the noise.

        Yields:
            Every tick, as soon as it has happened.

        Raises:
            ModelError: If the arm runs away.
        """
        whole = self._plant(faults)
        stiffness, inner = self._steps(whole, motion)
        step = 1.0 / self.settings.rate / inner
        plant, acting = whole, tuple(faults)

        def now(t: float) -> Dynamics:
            nonlocal plant, acting
            if (chosen := tuple(f for f in faults if acts(f))) != acting:
                plant, acting = self._plant(chosen), chosen
            return plant

        waiting: deque[Tick] = deque()
        control = self._control(monitor, noise, waiting.append)
        for _ in steps(now, motion, control, stiffness.sign_width(step), step):
            while waiting:
                yield waiting.popleft()

    def _plant(self, faults: Sequence[Term]) -> Dynamics:
        return Dynamics(self.robot, (*self.model.terms, *faults))  # a fault adds to a term of the same name

    def _steps(self, plant: Dynamics, motion: Trajectory) -> tuple[Stiffness, int]:
        """Return how stiff a plant is, and the steps of its integration in a tick."""
        stiffness = Stiffness.of(plant, motion)
        return stiffness, int(np.ceil(1.0 / self.settings.rate / stiffness.step(None) - 1e-9))

    def _control(
        self, monitor: Monitor | None, noise: int, watch: Callable[[Tick], None]
    ) -> MonitoredControl:
        readings = self._readings(np.random.default_rng([self.settings.seed, 3, noise]))
        return MonitoredControl(ComputedTorque(self.model), self.settings.rate, readings, monitor, watch)

    def _readings(
        self, rng: np.random.Generator
    ) -> Callable[[Array, Array, Array], tuple[Array, Array, Array]]:
        """Return what reads positions, velocities and torques."""
        slides = self.robot.is_prismatic
        if not self.settings.noise:
            return lambda q, v, tau: (q.copy(), v.copy(), tau.copy())
        quantum = np.where(slides, SLIDE_ENCODER, ENCODER)
        deviation = np.where(slides, SLIDE_VELOCITY, VELOCITY)
        n = len(slides)

        def read(q: Array, v: Array, tau: Array) -> tuple[Array, Array, Array]:
            noise = rng.standard_normal((2, n))
            return (
                quantum * np.round(q / quantum),
                v + deviation * noise[0],
                tau + self.effort_noise * noise[1],
            )

        return read
