r"""The scheme of the thesis, from detection to idle monitoring, one tick at a time ([Thesis] ch. 3, corrected).

f is on the side of the torque, M q̈ + V + G + η = τ + f. What was corrected, and why, stands where it is used:
`threshold`, `gains`, `observer`, `isolation`, `idle`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cdia_pin.diagnosis.status import Event, Stage, Status, Verdict
from cdia_pin.diagnosis.thesis.accommodation import accommodate
from cdia_pin.diagnosis.thesis.basis import KnownEffects, Neurons
from cdia_pin.diagnosis.thesis.clearance import ClearanceMonitor
from cdia_pin.diagnosis.thesis.filter_bank import OPEN, FilterBank, FilterDecision, Types
from cdia_pin.diagnosis.thesis.sample_interval import ArmSample, IntervalEvaluator, SampleInterval
from cdia_pin.diagnosis.thesis.thesis_settings import ThesisSettings
from cdia_pin.diagnosis.thesis.threshold import THRESHOLDS
from cdia_pin.diagnosis.thesis.unmodelled_bound import learn_unmodelled
from cdia_pin.diagnosis.thesis.velocity_observers import ColumnScale, VelocityObservers
from cdia_pin.dynamics.dynamics import Dynamics
from cdia_pin.effects import JointEffect, Term
from cdia_pin.errors import ModelError
from cdia_pin.logs.log import Log
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]

NEURONS = -1  # key of the approximator in the idle monitor, beside the types of effects


class ThesisEngine:
    """Detects, isolates and accommodates faults of an arm, and notes when they are gone.

    Args:
        model: What is known of the arm.
        bank: Effects that a fault may be, each on any joint: effects, or their classes for the usual shape.
            Without any, every fault is unknown and is accommodated by the neurons alone.
        settings: See `ThesisSettings`.
        healthy: Runs without fault, from which η₀ is learned where the settings do not give it.

    Raises:
        ModelError: If η₀ is neither given nor to be learned, or a setting does not fit the robot.
        EffectError: If an entry of the bank is no effect of one joint.
    """

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
        self._stepper = IntervalEvaluator(self.model, s.sign_width, s.longest_step)
        self._gamma = self._per_joint("gamma", s.gamma)
        if s.unmodelled is None:
            self.unmodelled = learn_unmodelled(
                self._stepper, self._gamma, healthy, margin=s.unmodelled_margin, threshold=s.threshold
            )
        else:
            self.unmodelled = self._per_joint("unmodelled", s.unmodelled)
        self._types = KnownEffects.of(self.robot, bank)
        self._neurons = _neurons(self.robot, s.neurons) if isinstance(s.neurons, int) else s.neurons
        self._idle_torque = s.idle_torque * self.unmodelled
        self.reset()

    def reset(self) -> None:
        """Forget everything but the settings and η₀."""
        n = self.robot.n
        self.events: list[Event] = []
        self._now: ArmSample | None = None
        self._effort = np.zeros(n)
        self._threshold = THRESHOLDS[self.settings.threshold](self._gamma, self.unmodelled)
        self._neuron_scale, self._type_scale = ColumnScale(self._neurons), ColumnScale(self._types)
        self._observer = self._fresh_observer()
        self._known: VelocityObservers | None = None
        self._isolated: Types = frozenset()
        self._bank: FilterBank | None = None
        self._deciding = False  # from detection until a unique effect is isolated, or the fault is gone
        self._said: FilterDecision = OPEN
        self._samples_beyond, self._time_beyond = 0, 0.0
        self._concerned = np.zeros(n, dtype=bool)
        self._left = np.zeros(n, dtype=bool)  # joints whose fault has gone
        self._idle = ClearanceMonitor(self._idle_torque, self.settings.idle_time)

    def pause(self) -> None:
        """Forget the last sample, and what errors its observers had; the next begins anew. What is believed stays."""
        self._now = None
        for observers in (self._observer, self._known, None if self._bank is None else self._bank.filters):
            if observers is not None:
                observers.error[:] = 0.0
        self._samples_beyond, self._time_beyond = 0, 0.0

    # ------------------------------------------------------------- once per tick

    def update(self, t: float, q: ArrayLike, v: ArrayLike | None, tau: ArrayLike) -> Status:
        """Take a sample and say what is thought of the arm now.

        Args:
            t: Time [s].
            q: Positions [rad or m], shape (n,).
            v: Velocities [rad/s or m/s], shape (n,); the scheme cannot do without.
            tau: Torque that acted since the previous update [N·m or N], shape (n,); not used the first time.

        Raises:
            ModelError: If a number is not finite, a shape is wrong, time does not go on, or velocities are
                missing. The engine is then as it was before.
        """
        if v is None:
            raise ModelError("the engine thesis observes velocities: give them, or use the engine momentum")
        now = self._stepper.sample(t, q, v)
        if self._now is None:
            self._now = now
            return self._status(np.zeros(self.robot.n), ())
        step = self._stepper.step(self._now, now, tau)
        self._now, self._effort = now, step.joints.effort
        self._neuron_scale.see(step)
        self._type_scale.see(step)
        bound = self._threshold.step(step.inverse_inertia, step.duration)
        before = len(self.events)
        residual = self._decide(step, bound) if self._deciding else self._watch(step, bound)
        self._monitor_idle(step)
        return self._status(residual, tuple(self.events[before:]))

    def correct(self, tau: ArrayLike, v_desired: ArrayLike | None = None) -> Array:
        """Return τ = (τ₀ − f̂)/(1 + h) within the effort limits, for the state of the last update.

        A nominal torque that is not finite is returned as it is, and so is any before the first detection.

        Args:
            tau: τ₀ [N·m or N], shape (n,).
            v_desired: Velocity asked for [rad/s or m/s], shape (n,), in whose direction dry friction is
                compensated; the measured one if omitted.

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
        asked = None if v_desired is None else np.asarray(v_desired, dtype=np.float64)
        torque = partial(self._torque, v_desired=asked)
        return accommodate(nominal, torque, self.settings.smallest_gain, self.robot.limits.effort)

    @property
    def faults(self) -> tuple[Term, ...]:
        """Effects isolated, as far as they act, with the parameters learned so far."""
        return () if self._known is None else self._terms(self._known, self._isolated)

    @property
    def notes(self) -> tuple[str, ...]:
        """What η₀ is, one sentence."""
        learned = "given" if self.settings.unmodelled is not None else "learned from healthy runs"
        bounds = ", ".join(f"{j} {b:.3g}" for j, b in zip(self.robot.joints, self.unmodelled, strict=True))
        return (f"unmodelled torque η₀, {learned}: {bounds} N·m or N",)

    # ------------------------------------------------------------- stages

    def _watch(self, step: SampleInterval, bound: Array) -> Array:
        """Compare the arm with what is known of it; isolated effects follow slow changes."""
        base, scale = (
            (self._observer, self._neuron_scale) if self._known is None else (self._known, self._type_scale)
        )
        error = base.step(step, scale)[0]
        beyond: NDArray[np.bool_] = np.abs(error) > bound
        if not beyond.any():
            self._samples_beyond, self._time_beyond = 0, 0.0
            return error.copy()
        self._samples_beyond += 1
        self._time_beyond += step.duration
        if self._known is not None:
            base.adapt(step, scale, np.array([True]))
        patient = self._known is None or self._time_beyond >= self.settings.readapt
        if self._samples_beyond >= self.settings.confirm and patient:
            self._detect(step.time, error, beyond)
        return error.copy()

    def _detect(self, time: float, error: Array, beyond: NDArray[np.bool_]) -> None:
        self._deciding, self._said = True, OPEN
        self._concerned = self._concerned | beyond
        self._left &= ~beyond
        self._observer = self._fresh_observer(error)
        left = len(self._types.effects) - len(self._isolated)
        self._bank = (
            FilterBank(self._types, self.settings, self.unmodelled, self._gamma, self._known, self._isolated)
            if left
            else None
        )
        self._say(time, "detection", Verdict.NONE, "the velocity error left its threshold")
        if self.settings.accommodate:
            self._say(time, "accommodation", Verdict.NONE, "by the neurons, until an effect is isolated")
        if self._bank is None:
            self._announce(time, FilterDecision(Verdict.UNKNOWN))

    def _decide(self, step: SampleInterval, bound: Array) -> Array:
        """Let the neurons approximate the fault while the bank looks for its name."""
        known = 0.0 if self._known is None else self._known.torque(self._type_scale.columns)[0]
        error = self._observer.step(step, self._neuron_scale, known)[0]
        self._observer.adapt(step, self._neuron_scale, np.array([bool((np.abs(error) > bound).any())]))
        if self._bank is not None:
            self._bank.step(step, self._type_scale, bound)
            self._announce(step.time, self._bank.decide())
        return error.copy()

    def _announce(self, time: float, decision: FilterDecision) -> None:
        """Tell a new decision, and act on it."""
        same = decision.verdict is self._said.verdict and set(decision.filters) == set(self._said.filters)
        if same or decision.verdict is Verdict.NONE:
            return
        self._said = decision
        if decision.verdict is Verdict.UNKNOWN:
            self._bank = None
            self._say(time, "isolation", Verdict.UNKNOWN, "no combination of known effects stays equivalent")
            return
        assert self._bank is not None
        found = [self._terms(self._bank.filters.only(m), self._bank.members[m]) for m in decision.filters]
        if decision.verdict is Verdict.AMBIGUOUS:
            reason = f"{len(found)} of {len(self._bank.members)} combinations are still equivalent"
            self._say(time, "isolation", Verdict.AMBIGUOUS, reason, found[0], tuple(found[1:]))
            return
        index = decision.filters[0]
        self._known, self._isolated = self._bank.filters.only(index), self._bank.members[index]
        self._bank, self._deciding = None, False
        self._observer = self._fresh_observer()
        self._samples_beyond, self._time_beyond = 0, 0.0
        self._say(time, "isolation", Verdict.UNIQUE, "all other combinations are excluded", found[0])
        if self.settings.accommodate:
            self._say(time, "accommodation", Verdict.UNIQUE, "by the isolated effects", found[0])

    def _monitor_idle(self, step: SampleInterval) -> None:
        torques = {}
        if self._known is not None:
            each = self._type_scale.columns * self._known.weights[0]
            torques = {i: each[:, self._types.of_type == i].sum(axis=1) for i in self._isolated}
        if self._deciding:
            torques[NEURONS] = self._observer.torque(self._neuron_scale.columns)[0]
        gone = self._idle.step(torques, step.duration)
        if not gone:
            return
        self._left |= self._concerned
        if NEURONS in gone:
            self._deciding, self._bank, self._said = False, None, OPEN
            error = self._observer.error[0]
            self._observer = self._fresh_observer(error)
            if self._known is not None:
                self._known.error[0] = error
        types = self._isolated & frozenset(gone)
        terms = self._terms(self._known, types) if self._known is not None else ()
        if types and self._known is not None:
            self._isolated -= types
            kept = np.isin(self._types.of_type, list(self._isolated))
            self._known.used *= kept
            self._known.weights *= kept
            if not self._isolated:
                if not self._deciding:
                    self._observer = self._fresh_observer(self._known.error[0])
                self._known = None
        if self._known is None and not self._deciding:
            self._concerned[:] = False
        names = [self._types.effects[i].name for i in sorted(types)] + ["what had no name"] * (
            NEURONS in gone
        )
        reason = f"{', '.join(names)}: torque below {self.settings.idle_torque:g} η₀"
        self._say(step.time, "idle", Verdict.NONE, reason, terms, joints=self._left)

    # ------------------------------------------------------------- what is known

    @property
    def _accommodating(self) -> bool:
        return self.settings.accommodate and (self._deciding or self._known is not None)

    def _torque(self, effort: Array, v_desired: Array | None = None) -> Array:
        """f̂ where the arm is now, under a torque [N·m or N], shape (n,)."""
        now = self._now
        assert now is not None
        x = self._stepper.state(now.time, now.q, now.v, np.zeros_like(now.q), effort)
        if v_desired is not None:
            x = replace(x, sign=np.tanh(v_desired / self.settings.sign_width))
        f = np.zeros_like(effort)
        if self._deciding:
            f = f + self._observer.torque(self._neurons.columns(x))[0]
        if self._known is not None:
            f = f + self._known.torque(self._types.columns(x))[0]
        return f

    def _terms(self, filter_: VelocityObservers, types: Types) -> tuple[Term, ...]:
        """The effects of a filter whose torque counts, with the parameters it has learned."""
        return self._types.terms(filter_.weights[0], self._present(filter_, types))

    def _present(self, filter_: VelocityObservers, types: Types) -> NDArray[np.bool_]:
        """Which effect acts on which joint by more than what counts as absent, (n, N)."""
        most = np.abs(filter_.weights[0]) * self._type_scale.largest
        return np.stack(
            [
                (most[:, self._types.of_type == i].sum(axis=1) > self._idle_torque) & (i in types)
                for i in range(len(self._types.effects))
            ],
            axis=1,
        )

    def _say(
        self,
        time: float,
        stage: str,
        verdict: Verdict,
        reason: str,
        faults: tuple[Term, ...] = (),
        alternatives: tuple[tuple[Term, ...], ...] = (),
        joints: NDArray[np.bool_] | None = None,
    ) -> None:
        concerned = self._concerned if joints is None else joints
        named = {j for term in faults for j in term.effect.scope}
        names = tuple(j for i, j in enumerate(self.robot.joints) if (j in named if named else concerned[i]))
        self.events.append(Event(time, stage, names, verdict, faults, alternatives, reason))

    def _status(self, residual: Array, events: tuple[Event, ...]) -> Status:
        assert self._now is not None
        faults: tuple[Term, ...] = ()
        acting = np.zeros(self.robot.n, dtype=bool)
        if self._known is not None:
            present = self._present(self._known, self._isolated)
            faults = self._types.terms(self._known.weights[0], present)
            acting = np.any(present, axis=1)
        correction = -self._torque(self._effort) if self._accommodating else np.zeros(self.robot.n)
        bound = self._threshold.value
        stages = tuple(
            self._stage(j, bool(acting[j]), abs(residual[j]) > bound[j]) for j in range(self.robot.n)
        )
        return Status(self._now.time, stages, residual, bound.copy(), correction, faults, events)

    def _stage(self, j: int, acting: bool, beyond: bool) -> Stage:
        corrected = Stage.ACCOMMODATED if self.settings.accommodate else Stage.ISOLATED
        if self._deciding and self._concerned[j]:
            undecided = self._said is OPEN or not self.settings.accommodate
            return Stage.DETECTED if undecided else Stage.ACCOMMODATED
        if acting:
            return corrected
        if beyond:
            return Stage.SUSPECT
        return Stage.IDLE if self._left[j] else Stage.HEALTHY

    def _fresh_observer(self, error: Array | None = None) -> VelocityObservers:
        observer = VelocityObservers.fresh(self._neurons, self.settings.observer_gains, self._gamma)
        if error is not None:
            observer.error[0] = error
        return observer

    def _per_joint(self, name: str, given: float | tuple[float, ...]) -> Array:
        value = np.array(given, dtype=np.float64)
        if value.shape not in {(), (self.robot.n,)} or not (np.isfinite(value).all() and (value > 0).all()):
            raise ModelError(
                f"{name} must be above 0, one number or one for each of {', '.join(self.robot.joints)}, given {given}"
            )
        return np.broadcast_to(value, (self.robot.n,)).copy()


def _neurons(robot: RobotModel, count: int) -> Neurons:
    """Neurons over the joint limits; π, 3 rad/s, 0.5 m and 0.5 m/s where there are none."""
    limits = robot.limits
    far = np.maximum(np.abs(limits.lower), np.abs(limits.upper))
    position = np.where(np.isfinite(far) & (far > 0), far, np.where(robot.is_prismatic, 0.5, np.pi))
    velocity = np.where(np.isfinite(limits.velocity), limits.velocity, np.where(robot.is_prismatic, 0.5, 3.0))
    return Neurons.over(robot, position, velocity, count)
