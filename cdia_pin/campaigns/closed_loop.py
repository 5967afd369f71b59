"""A closed loop around an arm with faults: nominal control, with or without a monitor that compensates.

The plant's bodies differ from the model's by a few percent. Its positions are rounded, its velocities and torques
have noise. The monitor learns from healthy runs of the same plant on other motions.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass, field

import numpy as np
from numpy.typing import NDArray

from cdia_pin.campaigns.model_error import with_model_error
from cdia_pin.campaigns.monitored_control import MonitoredControl, Tick
from cdia_pin.diagnosis import DEFAULT_BANK, Bank, Monitor, MonitorRun, MonitorSettings, Recorder
from cdia_pin.diagnosis.thesis import ThesisSettings
from cdia_pin.dynamics.controllers import ComputedTorque
from cdia_pin.dynamics.dynamics import Dynamics
from cdia_pin.dynamics.sensors import MOST_NOISE
from cdia_pin.dynamics.simulate import HIGHEST_RATE, Run, run_plant, steps
from cdia_pin.dynamics.smoothing import Stiffness
from cdia_pin.dynamics.trajectories import Trajectory, exciting_trajectory
from cdia_pin.effects import JointEffect, Term
from cdia_pin.errors import ModelError
from cdia_pin.logs.log import Log
from cdia_pin.phrases import shortened
from cdia_pin.progress import Progress, silent
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

ENCODER, SLIDE_ENCODER = 2e-5, 2e-6  # [rad], [m], step of the position readings: an encoder of 18 bits
VELOCITY, SLIDE_VELOCITY = 1e-3, 1e-4  # [rad/s], [m/s], standard deviation of the velocity noise


@dataclass(frozen=True)
class LoopSettings:
    """Settings of a closed loop.

    Attributes:
        rate: Control ticks per second [Hz]; a torque is held from one tick to the next.
        noise: Noise of the measured torques over their RMS [1]. With 0, positions and velocities are exact too.
        model_error: Largest relative error of the model's inertias [1].
        healthy_runs: Number of runs from which a monitor learns.
        healthy_duration: Length of each of these runs [s].
        seed: Seed of motions, noise and model error.
        speed: Largest speed of the motions over the limit of the joint [1].
    """

    rate: float = 1000.0
    noise: float = 0.01
    model_error: float = 0.03
    healthy_runs: int = 2
    healthy_duration: float = 20.0
    seed: int = 0
    speed: float = 0.6

    def __post_init__(self) -> None:
        sane = 0 < self.rate <= HIGHEST_RATE and 0 <= self.noise <= MOST_NOISE
        if not (sane and self.healthy_runs > 0 and self.healthy_duration > 0):
            raise ModelError(
                f"a closed loop needs rate > 0 Hz and up to {HIGHEST_RATE:g} Hz, noise ≥ 0 and up to {MOST_NOISE:g}, "
                "and healthy runs longer than 0 s, given "
                f"{self.rate}, {self.noise}, {self.healthy_runs} × {self.healthy_duration}"
            )
        if self.seed < 0:
            raise ModelError(f"a seed is 0 or more, given {self.seed}")
        if not 0 < self.speed <= 1:
            raise ModelError(f"the speed of a motion is above 0 and at most 1, given {self.speed}")


@dataclass(frozen=True, eq=False, repr=False)
class LoopRun:
    """One run of the loop.

    Attributes:
        run: True motion and torques, at every step of the integration.
        log: Readings of the controller, at every tick; each sample has the torque since the sample before.
        error: True position minus desired position at every tick [rad or m], shape (K, n).
        monitored: Output of the monitor; None without one.
    """

    run: Run
    log: Log
    error: Array
    monitored: MonitorRun | None = None

    def __repr__(self) -> str:
        watched = "monitored" if self.monitored is not None else "without a monitor"
        return f"LoopRun({self.error.shape[1]} joints, {len(self.log.time)} ticks, {watched})"

    def tracking(self, since: float = -np.inf) -> Array:
        """Compute the RMS tracking error.

        Args:
            since: Time from which samples count [s].

        Returns:
            RMS error of each joint [rad or m], shape (n,).
        """
        return np.asarray(np.sqrt(np.mean(self.error[self.log.time >= since] ** 2, axis=0)))


@dataclass(frozen=True, repr=False)
class ClosedLoop:
    """A plant, the controller's model of it, and its sensors.

    Attributes:
        model: Model of the controller and of the monitor.
        settings: Rate, noise, error of the model.
        robot: Robot with the true bodies of the plant.
        effort_noise: Standard deviation of the torque noise [N·m or N], shape (n,).
    """

    model: Dynamics
    settings: LoopSettings = field(default_factory=LoopSettings)
    robot: RobotModel = field(init=False)
    effort_noise: Array = field(init=False, compare=False)

    def __post_init__(self) -> None:
        s, robot = self.settings, self.model.robot
        body = with_model_error(robot, s.model_error, np.random.default_rng([s.seed, 1]))
        object.__setattr__(self, "robot", body)
        motion = self.motion(0, s.healthy_duration)(np.linspace(0, s.healthy_duration, 400))
        torque = robot.inverse_dynamics(motion.q, motion.v, motion.a)
        object.__setattr__(self, "effort_noise", s.noise * np.sqrt(np.mean(torque**2, axis=0)))

    def __repr__(self) -> str:
        return (
            f"ClosedLoop({shortened(self.robot.name)}, {self.settings.rate:g} Hz, seed {self.settings.seed})"
        )

    def motion(self, number: int, duration: float) -> Trajectory:
        """Return one of the loop's motions.

        Args:
            number: Number of the motion; each number gives another motion.
            duration: Length [s].

        Returns:
            A random exciting motion.
        """
        rng = np.random.default_rng([self.settings.seed, 2, number])
        return exciting_trajectory(self.model.robot, rng, duration=duration, speed=self.settings.speed)

    def monitor(
        self,
        *,
        bank: Bank | Iterable[str | JointEffect] = DEFAULT_BANK,
        engine: str = "momentum",
        settings: MonitorSettings | ThesisSettings | None = None,
        progress: Progress = silent,
    ) -> Monitor:
        """Return a monitor that has learned from healthy runs, on motions that are not used otherwise.

        Args:
            bank: Known effects that are hypotheses on every joint.
            engine: ``momentum`` or ``thesis``.
            settings: Settings of the engine; its defaults if omitted.
            progress: Called with the current work and the share that is done [1].

        Returns:
            The monitor, ready for its first tick.
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
        watch: Callable[[Tick], None] = lambda tick: None,
    ) -> LoopRun:
        """Let the plant follow a motion.

        Args:
            motion: The desired motion.
            faults: True faults, which the model lacks.
            monitor: Monitors the run, and compensates if its settings allow it; None for no monitor.
            noise: Number of the noise; the same number gives the same noise.
            progress: Called with the share that is done [1], now and then.
            watch: Called with each tick.

        Returns:
            True motion, readings and the output of the monitor.

        Raises:
            ModelError: If the simulation diverges.
        """
        plant = self._plant(faults)
        stiffness, inner = self._steps(plant, motion)
        recorder = Recorder(monitor) if monitor is not None else None
        seen = []

        def note(tick: Tick) -> None:
            watch(tick)
            seen.append((tick.time, tick.q, tick.v, tick.effort))
            if recorder is not None and tick.status is not None:
                recorder(tick.status, tick.q, tick.v, tick.effort, tick.desired)

        control = self._control(monitor, noise, note)
        step = 1.0 / self.settings.rate / inner
        run = run_plant(plant, motion, control, stiffness, step=step, progress=progress)
        time, q, v, tau = (np.array(column) for column in zip(*seen, strict=True))
        source = f"closed loop of {plant.robot.name}, motion seed {self.settings.seed}"
        log = Log(plant.robot.joints, time, q, tau, v, source=source)
        monitored = None if recorder is None else recorder.finish(loop=asdict(self.settings))
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
        """Let the plant follow a motion tick by tick, without an end.

        Args:
            motion: The desired motion.
            faults: True faults, which the model lacks.
            monitor: Monitors the run, and compensates if its settings allow it; None for no monitor.
            acts: Returns True for a fault that acts now, so that faults can be switched while the arm moves.
            noise: Number of the noise; the same number gives the same noise.

        Yields:
            Every tick, as soon as it is computed.

        Raises:
            ModelError: If the simulation diverges.
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
        """Return the stiffness of a plant, and the number of integration steps per tick."""
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
        """Return the function that turns true positions, velocities and torques into readings."""
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
