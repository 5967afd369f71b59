r"""The scheme of the thesis, one tick at a time: detection, isolation, accommodation, clearance ([Thesis] ch. 3).

f is on the side of the torque, M q̈ + V + G + η = τ + f. Some printed equations do not hold; the corrections and their
reasons stand where they are used: `threshold`, `gains`, `velocity_observers`, `filter_bank`, `clearance`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cdia_pin.diagnosis.stateful import Stateful
from cdia_pin.diagnosis.status import Event, EventStage, Status, Verdict
from cdia_pin.diagnosis.thesis.accommodation import accommodate
from cdia_pin.diagnosis.thesis.basis import KnownEffects, Neurons
from cdia_pin.diagnosis.thesis.clearance import ClearanceMonitor
from cdia_pin.diagnosis.thesis.event_log import EventLog
from cdia_pin.diagnosis.thesis.fault_estimate import NEURONS, FaultEstimate
from cdia_pin.diagnosis.thesis.filter_bank import OPEN, FilterBank, FilterDecision
from cdia_pin.diagnosis.thesis.joint_stages import joint_stages
from cdia_pin.diagnosis.thesis.sample_interval import ArmSample, IntervalEvaluator, SampleInterval
from cdia_pin.diagnosis.thesis.thesis_settings import ThesisSettings, per_joint
from cdia_pin.diagnosis.thesis.threshold import THRESHOLDS
from cdia_pin.diagnosis.thesis.unmodelled_bound import learn_unmodelled
from cdia_pin.dynamics.dynamics import Dynamics
from cdia_pin.effects import JointEffect, Term
from cdia_pin.errors import ModelError
from cdia_pin.logs.log import Log
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]


class ThesisEngine(Stateful):
    """Detects, isolates and accommodates faults of an arm, and notices when they have cleared.

    Args:
        model: The healthy arm.
        bank: Effects that a fault may be, each on any joint: effects, or their classes for the usual shape.
            Without any, every fault is unknown, and the neurons alone compensate it.
        settings: See `ThesisSettings`.
        healthy: Runs without fault, from which η₀ is learned if the settings do not give it.

    Attributes:
        unmodelled: η₀, bound of the unmodelled torque [N·m or N], shape (n,).

    Raises:
        ModelError: If η₀ is neither given nor can be learned, or a setting does not fit the robot.
        EffectError: If an entry of the bank is not an effect of one joint.
    """

    STATE = (
        "_now",
        "_effort",
        "_threshold",
        "_estimate",
        "_bank",
        "_announced",
        "_samples_beyond",
        "_time_beyond",
        "_log",
        "_clearance",
    )

    def __init__(
        self,
        model: Dynamics | RobotModel,
        bank: Sequence[JointEffect | type[JointEffect]] = (),
        settings: ThesisSettings | None = None,
        healthy: Sequence[Log] = (),
    ) -> None:
        self.model = Dynamics(model) if isinstance(model, RobotModel) else model
        self.settings = s = settings or ThesisSettings()
        self.robot = self.model.robot
        self._evaluator = IntervalEvaluator(self.model, s.sign_width, s.longest_step)
        self._gamma = per_joint(self.robot, "gamma", s.gamma)
        if s.unmodelled is None:
            self.unmodelled = learn_unmodelled(
                self._evaluator, self._gamma, healthy, margin=s.unmodelled_margin, threshold=s.threshold
            )
        else:
            self.unmodelled = per_joint(self.robot, "unmodelled", s.unmodelled)
        self._types = KnownEffects.of(self.robot, bank)
        count = s.neurons
        self._neurons = Neurons.within_limits(self.robot, count) if isinstance(count, int) else count
        self._absent_torque = s.idle_torque * self.unmodelled
        self.nothing = np.zeros(self.robot.n)
        self.reset()

    def reset(self) -> None:
        """Return to the start; settings and η₀ stay."""
        self._now: ArmSample | None = None
        self._effort = np.zeros(self.robot.n)
        self._threshold = THRESHOLDS[self.settings.threshold](self._gamma, self.unmodelled)
        self._estimate = FaultEstimate(
            self._neurons, self._types, self.settings, self._gamma, self._absent_torque
        )
        self._bank: FilterBank | None = None
        self._announced: FilterDecision = OPEN
        self._samples_beyond, self._time_beyond = 0, 0.0
        self._log = EventLog(self.robot.joints)
        self._clearance = ClearanceMonitor(self._absent_torque, self.settings.idle_time)

    def new_part(self, name: str) -> FilterBank:
        """Make a bank of filters, which is there during an isolation."""
        return FilterBank(self._types, self.settings, self.unmodelled, self._gamma)

    def pause(self) -> None:
        """Forget the last sample and the errors of the observers; the next sample starts again. Beliefs stay."""
        self._now = None
        filters = None if self._bank is None else self._bank.filters
        for observers in (self._estimate.observer, self._estimate.isolated.filter, filters):
            if observers is not None:
                observers.error[:] = 0.0
        self._samples_beyond, self._time_beyond = 0, 0.0

    def drop_detection(self) -> None:
        """End an isolation that has not come to a decision: the samples that it began with may have been bad."""
        if not self._estimate.learning or not self._announced.is_open:
            return
        self._estimate.learning, self._bank = False, None
        self._estimate.restart_neurons()
        acting = self._estimate.isolated.acting()
        self._log.concerned &= acting if self._estimate.isolated.filter is not None else False

    def update(self, t: float, q: ArrayLike, v: ArrayLike | None, tau: ArrayLike) -> Status:
        """Take a sample and return the diagnosis.

        Args:
            t: Time [s].
            q: Positions [rad or m], shape (n,).
            v: Velocities [rad/s or m/s], shape (n,); the scheme needs them.
            tau: Torque that acted since the previous update [N·m or N], shape (n,); not used the first time.

        Raises:
            ModelError: If a number is not finite, a shape is wrong, time does not increase, or velocities are
                missing. The engine is then as it was before.
        """
        if v is None:
            raise ModelError("the engine thesis observes velocities: give them, or use the engine momentum")
        self._log.news.clear()
        now = self._evaluator.sample(t, q, v)
        if self._now is None:
            self._now = now
            return self._status(np.zeros(self.robot.n), ())
        step = self._evaluator.between(self._now, now, tau)
        self._now, self._effort = now, step.joints.effort
        self._estimate.see(step)
        bound = self._threshold.step(step.inverse_inertia, step.duration)
        residual = self._decide(step, bound) if self._estimate.learning else self._watch(step, bound)
        self._clear(step)
        return self._status(residual, tuple(self._log.news))

    def correct(self, tau: ArrayLike, v_desired: ArrayLike | None = None) -> Array:
        """Return τ = (τ₀ − f̂)/(1 + h) within the effort limits for the last state [N·m or N], shape (n,).

        A nominal torque that is not finite is returned unchanged, and so is any before the first detection.

        Args:
            tau: τ₀ [N·m or N], shape (n,).
            v_desired: Velocity in whose direction dry friction is compensated [rad/s or m/s], shape (n,); the
                measured one if omitted.

        Raises:
            ModelError: If the shape is wrong.
        """
        nominal = np.array(tau, dtype=np.float64)
        if nominal.shape != (self.robot.n,):
            raise ModelError(
                f"a nominal torque has one number per joint, shape ({self.robot.n},), given {nominal.shape}"
            )
        if not self._accommodating or not np.isfinite(nominal).all():
            return nominal
        desired = None if v_desired is None else np.asarray(v_desired, dtype=np.float64)
        return accommodate(
            nominal, self._fault_torque(desired), self.settings.smallest_gain, self.robot.limits.effort
        )

    @property
    def faults(self) -> tuple[Term, ...]:
        """Isolated effects that act, with the parameters learned so far."""
        return self._estimate.isolated.terms()

    @property
    def notes(self) -> tuple[str, ...]:
        """One sentence on η₀."""
        learned = "given" if self.settings.unmodelled is not None else "learned from healthy runs"
        bounds = ", ".join(f"{j} {b:.3g}" for j, b in zip(self.robot.joints, self.unmodelled, strict=True))
        return (f"unmodelled torque η₀, {learned}: {bounds} N·m or N",)

    def _watch(self, step: SampleInterval, bound: Array) -> Array:
        """Compare the arm with what is known of it; isolated effects follow slow changes."""
        estimate, known = self._estimate, self._estimate.isolated.filter
        base, scale = (
            (estimate.observer, estimate.neuron_scale) if known is None else (known, estimate.type_scale)
        )
        error = base.step(step, scale)[0]
        beyond: NDArray[np.bool_] = np.abs(error) > bound
        if not beyond.any():
            self._samples_beyond, self._time_beyond = 0, 0.0
            return np.array(error)
        self._samples_beyond += 1
        self._time_beyond += step.duration
        if known is not None:
            base.adapt(step, scale, np.array([True]))
        patient = known is None or self._time_beyond >= self.settings.readapt
        if self._samples_beyond >= self.settings.confirm and patient:
            self._detect(step.time, error, beyond)
        return np.array(error)

    def _detect(self, time: float, error: Array, beyond: NDArray[np.bool_]) -> None:
        """Start isolation: the neurons approximate the fault while the bank excludes combinations."""
        self._estimate.learning, self._announced = True, OPEN
        self._log.concerned |= beyond
        self._log.cleared &= ~beyond
        self._estimate.restart_neurons(error)
        known, types = self._estimate.isolated.filter, self._estimate.isolated.types
        if len(types) < len(self._types.effects):
            self._bank = FilterBank(self._types, self.settings, self.unmodelled, self._gamma, known, types)
        self._log.add(time, EventStage.DETECTION, Verdict.NONE, "the velocity error left its threshold")
        if self.settings.accommodate:
            reason = "by the neurons, until an effect is isolated"
            self._log.add(time, EventStage.ACCOMMODATION, Verdict.NONE, reason)
        if self._bank is None:
            self._announce(time, FilterDecision(Verdict.UNKNOWN))

    def _decide(self, step: SampleInterval, bound: Array) -> Array:
        """Advance the neurons and the bank, and announce what the bank decides."""
        e, known = self._estimate, self._estimate.isolated.filter
        torque = 0.0 if known is None else known.torque(e.type_scale.columns)[0]
        error = e.observer.step(step, e.neuron_scale, torque)[0]
        e.observer.adapt(step, e.neuron_scale, np.array([bool((np.abs(error) > bound).any())]))
        if self._bank is not None:
            self._bank.step(step, e.type_scale, bound)
            self._announce(step.time, self._bank.decide())
        return np.array(error)

    def _announce(self, time: float, decision: FilterDecision) -> None:
        """Report a new decision, and act on it."""
        last = self._announced
        same = decision.verdict is last.verdict and set(decision.filters) == set(last.filters)
        if same or decision.verdict is Verdict.NONE:
            return
        self._announced = decision
        if decision.verdict is Verdict.UNKNOWN:
            self._bank = None
            reason = "no combination of known effects explains the fault"
            self._log.add(time, EventStage.ISOLATION, Verdict.UNKNOWN, reason)
            return
        bank, isolated = self._bank, self._estimate.isolated
        assert bank is not None
        found = [isolated.terms_of(bank.filters.only(m), bank.members[m]) for m in decision.filters]
        if decision.verdict is Verdict.AMBIGUOUS:
            reason = f"{len(found)} of {len(bank.members)} combinations still explain the fault"
            self._log.add(time, EventStage.ISOLATION, Verdict.AMBIGUOUS, reason, found[0], tuple(found[1:]))
            return
        index = decision.filters[0]
        isolated.replace(bank.filters.only(index), bank.members[index])
        self._bank, self._estimate.learning = None, False
        self._estimate.restart_neurons()
        self._samples_beyond, self._time_beyond = 0, 0.0
        reason = "all other combinations are excluded"
        self._log.add(time, EventStage.ISOLATION, Verdict.UNIQUE, reason, found[0])
        if self.settings.accommodate:
            reason = "by the isolated effects"
            self._log.add(time, EventStage.ACCOMMODATION, Verdict.UNIQUE, reason, found[0])

    def _clear(self, step: SampleInterval) -> None:
        """Drop the faults whose torque has been small for long enough, and report them as cleared."""
        estimate, isolated = self._estimate, self._estimate.isolated
        absent = self._clearance.step(estimate.torques(), step.duration)
        if not absent:
            return
        self._log.cleared |= self._log.concerned
        if NEURONS in absent:
            estimate.learning, self._bank, self._announced = False, None, OPEN
            error = estimate.observer.error[0]
            estimate.restart_neurons(error)
            if isolated.filter is not None:
                isolated.filter.error[0] = error
        types, known = isolated.types & frozenset(absent), isolated.filter
        terms = isolated.terms(types)
        if types and known is not None:
            isolated.clear(types)
            if estimate.is_empty:
                estimate.restart_neurons(known.error[0])
        if estimate.is_empty:
            self._log.concerned[:] = False
        names = [self._types.effects[i].name for i in sorted(types)]
        names += ["the unknown fault"] * (NEURONS in absent)
        reason = f"cleared: {', '.join(names)}; torque below {self.settings.idle_torque:g} η₀"
        self._log.add(step.time, EventStage.IDLE, Verdict.NONE, reason, terms)

    @property
    def _accommodating(self) -> bool:
        return self.settings.accommodate and not self._estimate.is_empty

    def _fault_torque(self, v_desired: Array | None = None) -> Callable[[Array], Array]:
        """Return f̂ at the last state as a function of the torque [N·m or N], shape (n,)."""
        now = self._now
        assert now is not None
        return lambda effort: self._estimate.torque(self._evaluator.at(now, effort, v_desired))

    def _status(self, residual: Array, events: tuple[Event, ...]) -> Status:
        assert self._now is not None
        acting, bound = self._estimate.isolated.acting(), self._threshold.value
        correction = -self._fault_torque()(self._effort) if self._accommodating else self.nothing
        stages = joint_stages(
            isolating=self._log.concerned & self._estimate.learning,
            undecided=self._announced.is_open,
            acting=acting,
            beyond=np.abs(residual) > bound,
            cleared=self._log.cleared,
            accommodate=self.settings.accommodate,
        )
        return Status(self._now.time, stages, residual, bound.copy(), correction, self.faults, events)
