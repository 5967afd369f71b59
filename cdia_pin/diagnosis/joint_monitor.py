"""The monitor of one joint: the four stages of the scheme and the transitions between them ([Thesis] fig. 6).

A joint is healthy until its remainder passes the threshold (*detection*). The remainder is the residual less the
torque of the present faults. The joint then collects normal equations and decides several times a second (a *look*).
When enough looks in a row agree, the fault is *isolated* and *accommodated*. An effect whose torque stays away where it
would show is *cleared* (stage ``idle``) but remembered. No stage is final: later looks may decide otherwise.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cdia_pin.diagnosis.belief import JointBelief
from cdia_pin.diagnosis.belief_state import BeliefState
from cdia_pin.diagnosis.healthy_arm import HealthyArm
from cdia_pin.diagnosis.isolation import LEAST_EXPLAINED, Decision, Isolator
from cdia_pin.diagnosis.joint_isolation import JointIsolation, Votes
from cdia_pin.diagnosis.momentum_observer import MomentumObserver
from cdia_pin.diagnosis.monitor_settings import MonitorSettings
from cdia_pin.diagnosis.stateful import Stateful
from cdia_pin.diagnosis.status import Event, EventStage, Stage, Verdict
from cdia_pin.diagnosis.tried_names import TriedNames
from cdia_pin.diagnosis.words import what_separates
from cdia_pin.effects import Profile, Term, Unknown
from cdia_pin.identifiability.distinguishing_motions import prepare

TRIAL_TIME = 3.0  # [s]; a belief that fails sooner was wrong, one that fails later met a further fault
# Where four combinations or more fitted alike on measured arms, it was a push or an error of the model.
MOST_ALIKE = 2  # rivals that a name may have [1]
CALM_TIME = 0.5  # [s] below the threshold after which an alarm without a fault is dismissed
ENDED_TIME = (
    1.0  # [s] of a residual below the threshold without any correction, after which a fault may have ended
)
REACTION_LOOKS = 2  # looks after a decision in which an alarm is not answered: the filters still settle
CLEARED = "cleared; the fault is remembered"
DOUBT_ABSENCES = 1.5  # [1], times `gone_after` that a doubt waits, so that a fault can be seen to clear first
DOUBT_FILTERS = 4.0  # [1], time constants of the filter that it waits besides


class JointMonitor(Stateful):
    """The stages of one joint.

    Args:
        j: The joint's index.
        observer: Its residual and normal equations.
        isolator: Decides between effects.
        healthy: What is known of the healthy arm.
        unknown: Neurons for an unknown fault.
        settings: Settings of the monitor.

    Attributes:
        stage: Stage of the joint.
        since: Time at which the stage began [s].
        waits: Whether the joint must not decide, because something of the whole arm is in question.
        lasts: Whether an effect of the bank has explained more of late than a healthy arm shows.
    """

    STATE = (
        "beliefs",
        "isolation",
        "stage",
        "waits",
        "lasts",
        "since",
        "last_alarm",
        "_onset",
        "_votes",
        "_names",
        "_doubted",
        "_mixed",
        "_gone_at",
        "_beyond",
        "_asks_again",
    )

    def __init__(
        self,
        j: int,
        observer: MomentumObserver,
        isolator: Isolator,
        healthy: HealthyArm,
        unknown: Unknown,
        settings: MonitorSettings,
    ) -> None:
        self.j, self.observer, self.settings, self.unknown = j, observer, settings, unknown
        self.name, self.bank = observer.nominal.robot.joints[j], isolator.bank
        self.isolation = JointIsolation(j, observer, isolator, healthy)
        prepare(observer.nominal.robot, self.name)
        self.reset()

    def reset(self) -> None:
        """Return to healthy, and believe in nothing."""
        self.beliefs = BeliefState(self.j, self.observer, self.bank, self.unknown)
        self.isolation.reset()
        self.stage = Stage.HEALTHY
        self.waits = self.lasts = False
        self.since = self.last_alarm = -np.inf
        self._onset = -np.inf  # [s], of what is believed, if nothing was believed before
        self._votes = Votes(self.settings.votes)
        self._names = TriedNames()
        self._doubted = np.inf  # [s], since when the belief is doubted
        self._mixed = False  # do the normal equations hold samples from before a belief failed?
        self._gone_at = -np.inf  # [s], when all that was believed was cleared
        self._beyond = -np.inf  # [s], when the residual was beyond the threshold, whatever is believed
        self._asks_again = False  # has another name been found, and is it asked for again on new samples?

    def restart(self) -> None:
        """Start the present stage again after a gap in the data; beliefs stay."""
        self.lasts = False
        self._votes.clear()
        if self.stage not in (Stage.HEALTHY, Stage.IDLE):
            self.isolation.restart()

    @property
    def ignores_alarms(self) -> bool:
        """Whether another alarm would change nothing: isolation goes on, or an unknown fault is being learned."""
        return self.stage is Stage.DETECTED or self.beliefs.now.verdict is Verdict.UNKNOWN

    @property
    def faults(self) -> tuple[Term, ...]:
        """Believed faults."""
        return self.beliefs.faults

    @property
    def profiles(self) -> dict[int, Profile]:
        """Profiles of the bank's effects that are present in a part of the motion only, by index."""
        return self.beliefs.presence.profiles

    # ------------------------------------------------------------- detection

    @property
    def is_undecided(self) -> bool:
        """Whether the joint has left its threshold, and its own decision is open."""
        return self.stage is Stage.DETECTED and self._doubted == np.inf

    @property
    def is_calm(self) -> bool:
        """Whether the joint is not being decided on."""
        return self.stage is not Stage.DETECTED and self.beliefs.now.verdict is not Verdict.UNKNOWN

    def excuse(self) -> None:
        """Take back what is undecided, because something of the whole arm was the cause."""
        self.lasts = False
        if not self.is_undecided:
            return
        self._votes.clear()
        if self.beliefs.now.mask:
            self.stage = self._settled
            self.isolation.restart(beside=self.beliefs.now)
        else:
            self._rest()

    def collect_again(self) -> None:
        """Collect normal equations anew beside what is believed, because the residual of those before was another."""
        if self.stage not in (Stage.HEALTHY, Stage.IDLE):
            self._votes.clear()
            self.isolation.restart(beside=self.beliefs.now)

    def withdraw(self, t: float, since: float) -> list[Event]:
        """Take back what was decided of late, because something of the whole arm was the cause.

        Args:
            t: Time [s].
            since: When that began [s].
        """
        if self._onset < since or not (self._believes or self._doubted < np.inf):
            return []
        self._doubted = np.inf
        taken_back = self._no_longer(t, self.faults, "one cause for all joints")
        self.isolation.drop_prior()
        self._rest()
        return [taken_back]

    def alarm(self, t: float, reason: str = "") -> list[Event]:
        """Answer a remainder beyond the threshold, or a small one that lasts.

        Args:
            t: Time [s].
            reason: A remark for the event.
        """
        self.last_alarm = t
        if self.ignores_alarms:
            return []
        known = self.beliefs.now if self._believes else None
        if known is not None and t - self.since < REACTION_LOOKS * self.settings.decide_every:
            return []
        if known is not None and t - self.since < TRIAL_TIME:
            return self._doubt(t)
        self._names.forgive(t - self.since)
        self.isolation.restart(beside=known)
        detection = self._event(t, EventStage.DETECTION, reason)
        if self.beliefs.unknown_before:
            return [detection, *self._commit_unknown(t)]
        self._onset = t if known is None else -np.inf
        self.beliefs.neurons.start()
        self.beliefs.memory.begin()
        self.beliefs.reconsider()
        self._begin(t, Stage.DETECTED)
        self._mixed = False
        was_there = t - self._gone_at < TRIAL_TIME  # what was said to be gone was not, so its name was wrong
        return [detection, *self._commit_unknown(t)] if was_there and self._names.fail() else [detection]

    def look(self, t: float) -> list[Event]:
        """Take a decision from the normal equations, and check what is believed.

        Args:
            t: Time [s].
        """
        if self.lasts or self.observer.state.exceeded[self.j] >= self.settings.debounce:
            self.last_alarm = t
        if abs(self.observer.residual[self.j]) > self.observer.threshold[self.j]:
            self._beyond = t
        self.beliefs.look()
        if self.waits:
            return []
        if self._doubted < np.inf:
            return self._settle_doubt(t)
        if self.stage is Stage.DETECTED:
            return self._isolate(t) if self.isolation.is_enough or self.beliefs.memory else []
        return self._follow(t) if self._believes else []

    # ------------------------------------------------------------- isolation

    def _isolate(self, t: float) -> list[Event]:
        returned = self.beliefs.recall()
        if returned is not None:
            return self._commit(
                t, replace(returned, verdict=Verdict.UNIQUE), "a remembered fault has returned"
            )
        mask = self.beliefs.now.mask
        has_gone = bool(mask) and self.isolation.is_less_without(self.beliefs.now)
        decision = self.isolation.decide(required=0 if has_gone else mask, caused=self.lasts, afresh=has_gone)
        if decision.mask is None and mask:
            decision = self.isolation.decide(caused=self.lasts)
        self._votes.add(decision)
        if not self._votes.agree:
            return []
        if has_gone and not mask & (decision.mask or 0):
            return self._gone(t)
        return self._decided(t, decision)

    def _decided(self, t: float, decision: Decision) -> list[Event]:
        """Answer a decision on which the last looks agree."""
        if not decision.mask:
            return self._none_possible(t) if decision.mask is None else self._dismiss(t)
        if not self._votes.are_clear and t - self.since < self.settings.ambiguous_after:
            return []
        if any(rival == 0 for rival, _ in decision.rivals) and t - self.last_alarm > CALM_TIME:
            return self._dismiss(t)  # it fits alike that nothing is there, and the residual says so too
        if len(decision.rivals) > MOST_ALIKE or not self.isolation.determines(decision):
            return []  # what fits so many names, or has so many parameters, is no name yet; the motion goes on
        verdict = Verdict.AMBIGUOUS if decision.rivals else Verdict.UNIQUE
        belief = self.isolation.belief(decision, verdict)
        is_real = belief.is_certain(self.bank) and self.isolation.explained(decision) >= LEAST_EXPLAINED
        return self._commit(t, belief) if is_real else self._dismiss(t)

    def _follow(self, t: float) -> list[Event]:
        """Update the parameters of what is believed; decide again if another combination explains more."""
        now, unknown = self.beliefs.now, self.beliefs.now.verdict is Verdict.UNKNOWN
        if unknown:
            self.beliefs.neurons.believe()
            if self.beliefs.neurons.is_cleared():
                self.beliefs.clear_unknown()
                self._rest()
                return [self._event(t, EventStage.IDLE, "the unknown fault has cleared; it is remembered")]
        if not self.isolation.is_enough:
            return []
        decision = self.isolation.decide()
        self._votes.add(decision)
        if now.mask and self._votes.agree and self._has_faded:
            return self._gone(t)
        if now.mask and decision.mask == now.mask:
            return self._confirmed(t, decision)
        too_soon = unknown and t - self.since < 2 * TRIAL_TIME
        is_another = self._votes.are_sure and decision.mask and not too_soon
        return self._decided_again(t, decision) if is_another else []

    def _confirmed(self, t: float, decision: Decision) -> list[Event]:
        """Update the parameters of what is believed; say so if it is the only explanation now."""
        now, self._asks_again = self.beliefs.now, False
        found = self.isolation.belief(decision, now.verdict)
        self.beliefs.hold(replace(found, rivals=now.rivals))
        if now.verdict is not Verdict.AMBIGUOUS or not self._votes.are_sure:
            return []
        only = replace(found, verdict=Verdict.UNIQUE, rivals=())
        return self._commit(t, only, "the motion since then separates them")

    def _decided_again(self, t: float, decision: Decision) -> list[Event]:
        """Believe in another name; where the fault may have ended, only if the samples since say so too.

        Samples from before and after an end look like a combination that nearly cancels.
        """
        if self.beliefs.now.mask and t - self._beyond > ENDED_TIME and not self._asks_again:
            self._asks_again = True
            self._votes.clear()
            self.isolation.restart()
            return []
        before = ", ".join(term.label for term in self.faults) or str(self.beliefs.now.verdict)
        found = self.isolation.belief(decision, Verdict.UNIQUE)
        is_name = found.is_certain(self.bank) and self.isolation.determines(decision)
        return self._commit(t, found, f"decided again; before: {before}") if is_name else []

    def _commit(self, t: float, belief: JointBelief, reason: str = "") -> list[Event]:
        self.isolation.drop_prior()
        self._names.forgive(t - self.since)
        if self._names.replace(belief.mask):
            return self._commit_unknown(t)
        self.beliefs.commit(belief)
        if belief.verdict is Verdict.AMBIGUOUS:
            reason = what_separates([self.faults, *self.beliefs.alternatives], self.observer.nominal.robot)
        return self._believed(t, reason)

    def _commit_unknown(self, t: float) -> list[Event]:
        self.beliefs.commit_unknown()
        return self._believed(t, "no combination of the bank explains the fault; its torque is being learned")

    def _believed(self, t: float, reason: str) -> list[Event]:
        self._begin(t, self._settled)
        self.observer.state.exceeded[self.j] = 0.0
        events = [self._event(t, EventStage.ISOLATION, reason)]
        return [*events, self._event(t, EventStage.ACCOMMODATION)] if self.settings.accommodate else events

    # ------------------------------------------------------------- doubt

    def _doubt(self, t: float) -> list[Event]:
        """Wait until it shows whether a young belief is wrong or its fault has cleared."""
        self.stage, self._doubted = Stage.DETECTED, t
        return [
            self._event(
                t, EventStage.DETECTION, "the isolated fault does not explain the residual any longer"
            )
        ]

    def _settle_doubt(self, t: float) -> list[Event]:
        """Take back a belief that has failed soon; decide again on all samples since the detection."""
        if t - self._doubted < (
            DOUBT_ABSENCES * self.settings.gone_after + DOUBT_FILTERS / self.observer.bandwidth[self.j]
        ):
            return []
        self._doubted = np.inf
        if t - self.last_alarm > REACTION_LOOKS * self.settings.decide_every:  # the alarm was a short one
            self.stage = self._settled
            return []
        self.isolation.drop_prior()
        if self._names.fail():
            return self._commit_unknown(t)
        self.beliefs.hold(JointBelief.nothing(self.bank))
        self._begin(t, Stage.DETECTED)
        self._mixed = True
        return []

    def _none_possible(self, t: float) -> list[Event]:
        """Drop the samples from before a belief failed, for another fault may have begun then; else call it unknown."""
        if not self._mixed:
            return self._commit_unknown(t) if t - self.since >= self.settings.unknown_after else []
        self.isolation.restart()
        self._begin(t, Stage.DETECTED)
        self._mixed = False
        return []

    # ------------------------------------------------------------- cleared faults

    def absent(self, t: float) -> list[Event]:
        """Clear the effects whose torque has stayed away where it would show.

        Args:
            t: Time [s].
        """
        absent = self.beliefs.absent()
        if not absent:
            return []
        was_doubted, self._doubted = self._doubted < np.inf, np.inf
        if self.beliefs.come_and_go(absent):
            self.beliefs.confine(absent)
            self.isolation.restart()
            self._begin(t, self._settled)
            reason = "present only in a region of the motion"
            verdict = self.beliefs.now.verdict
            return [Event(t, EventStage.IDLE, (self.name,), verdict, self.faults, reason=reason)]
        faults = self.beliefs.clear(absent)
        if was_doubted:
            self._names.fail()
        self._names.tried = self.beliefs.now.mask
        self.isolation.restart(beside=self.beliefs.now)
        self._begin(t, self.stage)
        if not self.beliefs.now.mask:
            self._rest()
        return [self._no_longer(t, faults, CLEARED)]

    def _gone(self, t: float) -> list[Event]:
        """Clear all that is believed, because the residual is less without it."""
        faults = self.beliefs.clear(self.bank.members(self.beliefs.now.mask))
        self._gone_at = t
        self._rest()
        return [self._no_longer(t, faults, CLEARED)]

    def _dismiss(self, t: float) -> list[Event]:
        if t - self.last_alarm <= CALM_TIME:
            return []
        self._rest()
        return [self._event(t, EventStage.IDLE, "below the threshold again before the fault was isolated")]

    def _rest(self) -> None:
        self.stage = Stage.IDLE if self.beliefs.remembers else Stage.HEALTHY
        self._names.tried = 0
        self.beliefs.rest()
        self.isolation.end()

    @property
    def _has_faded(self) -> bool:
        """Whether the samples of late are nearer to no fault than to what was isolated."""
        then = self.beliefs.isolated
        same = then.mask == self.beliefs.now.mask
        return same and self.isolation.is_less_without(then)

    @property
    def _believes(self) -> bool:
        return self.stage in (Stage.ACCOMMODATED, Stage.ISOLATED)

    @property
    def _settled(self) -> Stage:
        """Stage of a joint whose fault is isolated."""
        return Stage.ACCOMMODATED if self.settings.accommodate else Stage.ISOLATED

    def _begin(self, t: float, stage: Stage) -> None:
        self.stage, self.since, self._asks_again = stage, t, False
        self._votes.clear()

    def _no_longer(self, t: float, faults: tuple[Term, ...], reason: str) -> Event:
        return Event(t, EventStage.IDLE, (self.name,), Verdict.NONE, faults, reason=reason)

    def _event(self, t: float, stage: EventStage, reason: str = "") -> Event:
        if stage in (EventStage.DETECTION, EventStage.IDLE):
            return Event(t, stage, (self.name,), Verdict.NONE, reason=reason)
        b = self.beliefs
        return Event(t, stage, (self.name,), b.now.verdict, b.faults, b.alternatives, reason)
