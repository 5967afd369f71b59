"""The engine `momentum`: residuals in torque units, joint by joint; each look fits every combination of effects."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import floor

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.alignment import Alignment
from cdia_pin.diagnosis.approximation import unknown_of
from cdia_pin.diagnosis.bank import Bank
from cdia_pin.diagnosis.correction_kernel import command
from cdia_pin.diagnosis.healthy_arm import HealthyArm, assumed_healthy_arm, learn_healthy_arm
from cdia_pin.diagnosis.isolation import Decision, Isolator
from cdia_pin.diagnosis.joint_monitor import JointMonitor
from cdia_pin.diagnosis.lasting import LastingDetector
from cdia_pin.diagnosis.momentum_observer import MomentumObserver
from cdia_pin.diagnosis.monitor_settings import MonitorSettings
from cdia_pin.diagnosis.nominal import Nominal
from cdia_pin.diagnosis.residuals import SETTLING
from cdia_pin.diagnosis.sight import JointSight
from cdia_pin.diagnosis.stateful import Stateful
from cdia_pin.diagnosis.status import LASTS, Event, EventStage, Stage, Status, Verdict
from cdia_pin.diagnosis.tick_flags import ABSENT, ALARM, BAD
from cdia_pin.diagnosis.whole_arm.arm_monitor import ArmMonitor
from cdia_pin.diagnosis.whole_arm.belief import added_torque
from cdia_pin.diagnosis.whole_arm.contact_kernel import TOGETHER
from cdia_pin.diagnosis.whole_arm.learning import PERIOD, Learned, assumed, learn
from cdia_pin.dynamics.dynamics import Dynamics
from cdia_pin.effects import State, Term
from cdia_pin.errors import ModelError
from cdia_pin.logs.log import Log

Array = NDArray[np.float64]

LASTING_EVERY = 0.25  # [s] between two questions whether something small lasts
LARGEST_GAP = 5.0  # ticks without a sample after which the filters start again: what they hold is too old


class MomentumEngine(Stateful):
    """Monitors an arm by the momentum observer.

    Args:
        model: The healthy arm.
        bank: Known effects.
        settings: Settings of the monitor.
        healthy: Runs of the healthy arm, from which thresholds are learned.
        threshold: η₀ of each joint [N·m or N], if there are no healthy runs.
        rate: Ticks per second [Hz]; that of the healthy runs if omitted.
        position_only: Whether `update` gets no velocities, if there are no healthy runs.
        learned: What another engine has learned, in place of runs and threshold.

    Attributes:
        learned: What healthy runs taught, or the threshold stands for.

    Raises:
        ModelError: If there are neither healthy runs nor a threshold with a rate.
    """

    STATE = (
        "observer",
        "_alignment",
        "joint_monitors",
        "arm",
        "lasting",
        "_quiet_until",
        "_next",
        "_next_look",
        "_next_sample",
        "_last_sample",
        "_next_lasting",
        "_next_arm_look",
        "_lasts",
        "_bad",
        "_stages",
        "_faults",
    )
    DERIVED = ("_busy", "_gated", "_muted")

    def __init__(
        self,
        model: Dynamics,
        bank: Bank,
        settings: MonitorSettings,
        *,
        healthy: Sequence[Log] = (),
        threshold: Mapping[str, float] | None = None,
        rate: float | None = None,
        position_only: bool = False,
        learned: Learned | None = None,
    ) -> None:
        robot = model.robot
        self.settings, self.bank = settings, bank
        if learned is not None and rate:
            self.healthy: HealthyArm = learned.healthy
        elif healthy:
            self.healthy = learn_healthy_arm(model, healthy, bank, settings)
            rate = rate or float(np.median([run.rate for run in healthy]))
            position_only = healthy[0].velocity is None
        elif threshold is not None and rate:
            self.healthy = assumed_healthy_arm(Nominal.of(model), threshold, settings)
        else:
            raise ModelError(
                "a monitor needs the size of a healthy residual: give healthy=[log, …], "
                "or threshold={joint: N·m} and rate=Hz"
            )
        self.dt = 1.0 / rate
        nominal = self.healthy.nominal
        unknown = [unknown_of(self.healthy, j, settings) for j in range(robot.n)]
        self.observer = MomentumObserver(
            nominal, bank.prototypes, settings, self.dt, unknown, self.healthy.bandwidth
        )
        self.observer.use_sign_width(self.healthy.sign_width)
        if self.healthy.is_measured:
            self.observer.use_velocities(self.healthy.velocity_range)
        self.observer.state.bound = self.healthy.bound
        self.observer.state.rest_bound = self.healthy.rest_bound
        lower, upper = _parameter_bounds(bank, nominal)
        isolator = Isolator(bank, lower, upper, settings)
        self._alignment = Alignment(self.dt, nominal.delay, position_only)
        self.lasting = LastingDetector(bank, robot.n, settings.memory)
        if learned is None and healthy:
            learned = learn(self.observer, self._alignment, self.lasting, healthy, self.healthy)
        self.learned = learned or assumed(robot.n, len(bank), self.healthy)
        self.lasting.limit = self.learned.lasting
        self.joint_monitors = [
            JointMonitor(j, self.observer, isolator, self.healthy, unknown[j], settings)
            for j in range(robot.n)
        ]
        self.arm = ArmMonitor(self.observer, bank, self.healthy, self.learned.contact, settings)
        self._offset = nominal.offset if nominal.offset.any() else None
        self._limit = robot.limits.effort
        self._blind = self.healthy.sight.blind
        self.nothing = np.zeros(robot.n)
        self._muted: list[int] = []  # joints whose alarms are ignored
        self.reset()

    def reset(self) -> None:
        """Return to the start; what healthy runs taught stays."""
        self.observer.reset()
        self._alignment.reset()
        for monitor in self.joint_monitors:
            monitor.reset()
        self.arm.reset()
        self.lasting.reset()
        self._quiet_until = np.inf  # [s], until when the filters settle
        self._next = [-np.inf] * len(self.joint_monitors)
        self._next_look = np.inf
        self._next_sample = self._last_sample = self._next_lasting = self._next_arm_look = -np.inf
        self._lasts: list[int] = []
        self.observer.correct_from_now(False)
        self._bad = False
        self._stages: tuple[Stage, ...] = (Stage.HEALTHY,) * len(self.joint_monitors)
        self._faults: tuple[Term, ...] = ()
        self._group_joints()

    def restored(self) -> None:
        """Group the joints by their stages."""
        self._group_joints()

    def _group_joints(self) -> None:
        """Find the joints that are not healthy, those with effects that come and go, and those that ignore alarms."""
        self._busy = [m for m in self.joint_monitors if m.stage is not Stage.HEALTHY]
        self._gated = [m for m in self.joint_monitors if m.profiles]
        muted = [m.j for m in self._busy if m.ignores_alarms]
        if muted != self._muted:
            self.observer.state.muted, self._muted = 0.0, muted
            self.observer.state.muted[muted] = 1.0

    def update(self, t: float, q: Array, v: Array | None, tau: Array) -> Status:
        """Take one tick; see `Engine.update`."""
        o = self.observer
        then = t
        if v is None or not self._alignment.is_direct:
            sample = self._alignment(t, q, v, tau)
            if sample is None:
                return self._status(t, ())
            then, q, v, tau = sample
        if self._offset is not None:
            q = q + self._offset
        gap = then - o.time
        if not gap > 0:
            return self._bad_data(t, f"time goes from {o.time:.6g} s to {then:.6g} s")
        if gap > LARGEST_GAP * self.dt:
            self._start(then)
        if self._gated:
            self._gate(then, q, v, tau)
        asks = o.step(then, q, v, tau)
        if asks & BAD:
            return self._bad_data(t, "a position, velocity or torque is not a number")
        if self._bad and then >= self._quiet_until:
            self._bad = False
        samples = then >= self._next_sample and then >= self._quiet_until and self._sample(then, tau)
        if not asks and not samples and then < self._next_look:
            return self._status(t, ())
        return self._status(t, self._attend(t, then, asks))

    def correct(self, tau: Array, v_desired: Array | None = None) -> Array:
        """Return the torque to command in place of a nominal one; see `Engine.correct`."""
        if not self._corrects:
            return tau
        if self.arm.believed:
            o = self.observer
            tau = tau + added_torque(o.nominal.robot, o.carried, o.q, o.v, tau)
        return self.observer.correct(tau, v_desired)

    @property
    def faults(self) -> tuple[Term, ...]:
        """Faults now believed in, of the whole arm and of all joints."""
        return (*self.arm.faults, *(term for monitor in self.joint_monitors for term in monitor.faults))

    @property
    def decisions(self) -> tuple[Decision | None, ...]:
        """The last decision on each joint, None before its first."""
        return tuple([monitor.isolation.last for monitor in self.joint_monitors])

    @property
    def notes(self) -> tuple[str, ...]:
        """What healthy runs taught, one sentence each."""
        return self.healthy.notes

    @property
    def sight(self) -> dict[str, JointSight]:
        """Threshold and healthy torque of each joint, by its name."""
        return self.healthy.sight.to_dict()

    # ------------------------------------------------------------- ticks that need attention

    def _sample(self, then: float, tau: Array) -> bool:
        """Show the slower detectors the present sample; return whether they need attention."""
        o = self.observer
        dt = then - self._last_sample if self._last_sample > -np.inf else 0.0
        self._last_sample, self._next_sample = then, then + PERIOD * (1.0 - 1e-9)
        self.lasting.add(dt, o.filtered, o.remainder, tau, o.state.steady)
        if then >= self._next_lasting:
            self._next_lasting = then + LASTING_EVERY
            for monitor, lasts in zip(
                self.joint_monitors, self.lasting.beyond(o.state.amplitude).tolist(), strict=True
            ):
                monitor.lasts = lasts
            self._lasts = [m.j for m in self.joint_monitors if m.lasts and m.is_calm]
        changed = self.arm.sample(dt)
        return changed or bool(self._lasts)

    def _attend(self, t: float, then: float, asks: int) -> tuple[Event, ...]:
        o = self.observer
        new: list[Event] = self.arm.follow_contact(t)
        if any(e.stage is EventStage.IDLE for e in new) and not self.arm.apart:
            self._excuse_joints()
        if then >= self._quiet_until and not (self.arm.contact and self.arm.holds_joints(t)):
            if asks & ALARM:
                for monitor in self.joint_monitors:
                    if o.state.exceeded[monitor.j] >= self.settings.debounce:
                        new += monitor.alarm(t)
            for j in self._lasts:
                new += self.joint_monitors[j].alarm(t, LASTS)
        self._lasts = []
        if asks & ABSENT:
            for monitor in self._busy:
                new += self._heard(monitor, monitor.absent(t))
        if then >= self._next_arm_look:
            new += self._look_at_arm(t, then)
        waits = self.arm.holds_joints(t)
        for monitor in self._busy:
            monitor.waits = waits
            if then >= self._next[monitor.j]:
                # Joints take turns, so that no tick decides on several.
                late = monitor.j / len(self.joint_monitors) * self.settings.decide_every
                steps = floor((then - late) / self.settings.decide_every) + 1
                self._next[monitor.j] = steps * self.settings.decide_every + late
                new += self._heard(monitor, monitor.look(t))
        self._group_joints()
        looks = [self._next[m.j] for m in self._busy]
        self._next_look = min([*looks, self._next_arm_look] if self.arm.is_busy else looks, default=np.inf)
        self._stages = tuple(self._stage_of(m) for m in self.joint_monitors)
        o.correct_from_now(self._corrects)
        self._faults = (*self.arm.faults, *(term for m in self._busy for term in m.faults))
        return tuple(new)

    def _heard(self, monitor: JointMonitor, said: list[Event]) -> list[Event]:
        """Return what a joint said; the slower detectors then start again on what is left."""
        if said:
            self.lasting.reset([monitor.j])
            if any(e.stage is EventStage.ISOLATION for e in said):
                self.arm.forget(monitor.j)  # what is left of it now speaks for itself
            if self.arm.contact is None:
                self.arm.detector.settle(self.observer.time, self.observer.remainder)
        return said

    def _look_at_arm(self, t: float, then: float) -> list[Event]:
        """Ask whether something of the whole arm explains what joints show."""
        self._next_arm_look = then + self.settings.decide_every
        since = self.arm.asked_since
        new = self.arm.look(t, [m.j for m in self.joint_monitors if m.is_undecided])
        for j in np.flatnonzero(self.arm.moved):
            self.joint_monitors[j].collect_again()
        if new and self.arm.asked_since == np.inf:  # the question is answered
            self._excuse_joints()
        if any(e.stage is EventStage.ISOLATION for e in new):
            for monitor in self.joint_monitors:
                new += monitor.withdraw(t, since - TOGETHER)
        return new

    def _excuse_joints(self) -> None:
        """Take back what joints had not decided, because the whole arm was the cause."""
        for monitor in self.joint_monitors:
            monitor.excuse()
        self.lasting.reset()

    def _stage_of(self, monitor: JointMonitor) -> Stage:
        """Return the stage of a joint; one that is touched is isolated, and not compensated."""
        touched = self.arm.contact is not None and monitor.name in self.arm.contact.joints
        return Stage.ISOLATED if touched else monitor.stage

    def _gate(self, t: float, q: Array, v: Array, tau: Array) -> None:
        """Set the presence of the effects that have a profile."""
        o = self.observer
        x = State(o.nominal.robot, q[None], v[None], q[None], tau[None], np.array([t]), o.state.sign_width)
        for monitor in self._gated:
            for i, profile in monitor.profiles.items():
                o.state.present[monitor.j, self.bank.span(i)] = profile(x)[0]

    # ------------------------------------------------------------- starts and bad data

    def _start(self, t: float) -> None:
        """Start the filters; alarms and corrections wait until they have settled."""
        self.observer.reset()
        for monitor in self.joint_monitors:
            monitor.restart()
        self._last_sample = self._next_sample = self._next_lasting = -np.inf
        self._lasts = []
        self.arm.restart()
        self.lasting.reset()
        self._quiet_until = t + SETTLING / float(self.observer.bandwidth.min())

    def _bad_data(self, t: float, reason: str) -> Status:
        """Correct nothing until data have been good for as long as the filters need."""
        event: tuple[Event, ...] = ()
        if not self._bad:
            event = (
                Event(
                    t,
                    EventStage.ACCOMMODATION,
                    self.observer.nominal.robot.joints,
                    Verdict.NONE,
                    reason=f"{reason}; nominal control",
                ),
            )
        self._bad = True
        self.pause()
        return self._status(t, event)

    @property
    def needs_even_ticks(self) -> bool:
        """Whether a tick left out is to be filled, because signals are shifted or differentiated by ticks."""
        return not self._alignment.is_direct

    def pause(self) -> None:
        """Forget past samples: the next one starts the filters again. Beliefs stay."""
        self._quiet_until = np.inf
        self.observer.time = -np.inf
        self._alignment.reset()

    @property
    def _corrects(self) -> bool:
        """Whether torques are corrected: never against whoever pushes the arm."""
        if not (self._busy or self.arm.believed) or not self.settings.accommodate:
            return False
        t = self.observer.time
        return t >= self._quiet_until and not self.arm.is_touched(t)

    def _status(self, t: float, events: tuple[Event, ...]) -> Status:
        o = self.observer
        correction = self.nothing
        if self._corrects:
            correction = np.empty(len(self.nothing))
            command(o.addition, self.arm.carried_torque, self._limit, correction)
        residual, threshold = o.residual.copy(), o.threshold.copy()
        return Status(t, self._stages, residual, threshold, correction, self._faults, events, self._blind)


def _parameter_bounds(bank: Bank, nominal: Nominal) -> tuple[Array, Array]:
    """Return the bounds of every parameter on every joint; a term of the model may vanish, but not change its sign."""
    lower, upper = (np.tile(b, (nominal.robot.n, 1)) for b in bank.bounds)
    for term in nominal.of_joints:
        i = bank.index(term.effect)  # type: ignore[arg-type]
        if i is not None:
            j = nominal.robot.joint_index(term.effect.scope[0])
            lower[j, bank.span(i)] -= term.theta
            upper[j, bank.span(i)] -= term.theta
    return lower, upper
