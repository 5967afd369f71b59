"""One joint under watch: the four stages of the scheme, and the way from one to the next ([Thesis] fig. 6).

A joint is healthy until its remainder, the residual less what is believed already, passes the threshold:
*detection*. From then on its normal equations are collected and looked at several times a second; when enough looks
in a row agree, the fault is *isolated* and from then on *accommodated*. An effect whose torque stays away where it
would show is *idle*: no longer corrected for, but remembered, and taken up again at once when it returns. At no
stage is anything final: later looks may decide otherwise.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cdia_pin.diagnosis.belief import Belief
from cdia_pin.diagnosis.beliefs import Beliefs
from cdia_pin.diagnosis.evidence import Evidence, Votes
from cdia_pin.diagnosis.isolation import Isolator
from cdia_pin.diagnosis.learning import Healthy
from cdia_pin.diagnosis.observer import Observer
from cdia_pin.diagnosis.settings import MonitorSettings
from cdia_pin.diagnosis.status import Event, Stage, Verdict
from cdia_pin.diagnosis.words import what_separates
from cdia_pin.effects import Profile, Term, Unknown

SHORT_LIVED = 3.0  # [s], a belief that fails sooner was none
MOST_FAILURES = 3  # of beliefs in a row, after which nothing known is believed
CALM = 0.5  # [s] below the threshold after which an alarm that led to nothing is dropped


class JointWatch:
    """The stages of one joint.

    Args:
        j: The joint.
        observer: Its residual and normal equations.
        isolator: Decides between effects.
        healthy: What a healthy joint is like.
        unknown: Neurons for what no effect explains.
        settings: How quickly, how surely, how boldly.
    """

    def __init__(
        self,
        j: int,
        observer: Observer,
        isolator: Isolator,
        healthy: Healthy,
        unknown: Unknown,
        settings: MonitorSettings,
    ) -> None:
        self.j, self.observer, self.settings, self.unknown = j, observer, settings, unknown
        self.name, self.bank = observer.nominal.robot.joints[j], isolator.bank
        self.evidence = Evidence(j, observer, isolator, healthy)
        self.reset()

    def reset(self) -> None:
        """Return to healthy, believing nothing."""
        self.beliefs = Beliefs(self.j, self.observer, self.bank, self.unknown)
        self.evidence.reset()
        self.stage = Stage.HEALTHY
        self.since = self.last_alarm = -np.inf
        self._votes = Votes(self.settings.votes)
        self._failures = 0
        self._doubted = np.inf  # since when, if ever
        self._mixed = False  # does the evidence hold what was seen before a belief failed?

    def restart(self) -> None:
        """Begin the present stage anew, after a gap in the data; beliefs stay."""
        self._votes.clear()
        if self.stage not in (Stage.HEALTHY, Stage.IDLE):
            self.evidence.restart()

    @property
    def deaf(self) -> bool:
        """Whether another alarm would change nothing; an unknown torque's approximation follows by itself."""
        return self.stage is Stage.DETECTED or self.beliefs.now.verdict is Verdict.UNKNOWN

    @property
    def faults(self) -> tuple[Term, ...]:
        """Faults believed in."""
        return self.beliefs.faults

    @property
    def profiles(self) -> dict[int, Profile]:
        """Of effects of the bank that are only there in a part of the motion, by index."""
        return self.beliefs.presence.profiles

    # ------------------------------------------------------------- detection

    def alarm(self, t: float) -> list[Event]:
        """Answer a remainder beyond the threshold."""
        self.last_alarm = t
        if self.deaf:
            return []
        known = self.beliefs.now if self._believes else None
        if known is not None and t - self.since < 2 * self.settings.decide_every:
            return []
        if known is not None and t - self.since < SHORT_LIVED:
            return self._doubt(t)
        self._failures = 0
        self.evidence.restart(beside=known)
        detection = self._event(t, "detection")
        if self.beliefs.unknown_before:
            return [detection, *self._commit_unknown(t)]
        self.beliefs.neurons.start()
        self.beliefs.memories.begin()
        self.beliefs.reconsider()
        self._begin(t, Stage.DETECTED)
        self._mixed = False
        return [detection]

    def look(self, t: float) -> list[Event]:
        """Look at the normal equations and at what has been believed."""
        if self.observer.joint[self.observer.k.EXCEEDED, self.j] >= self.settings.debounce:
            self.last_alarm = t
        self.beliefs.look()
        if self._doubted < np.inf:
            return self._settle_doubt(t)
        if self.stage is Stage.DETECTED:
            return self._isolate(t) if self.evidence.is_enough or self.beliefs.memories else []
        return self._follow(t) if self._believes else []

    # ------------------------------------------------------------- isolation

    def _isolate(self, t: float) -> list[Event]:
        returned = self.beliefs.recall()
        if returned is not None:
            return self._commit(t, replace(returned, verdict=Verdict.UNIQUE), "as it was before")
        mask = self.beliefs.now.mask
        decision = self.evidence.decide(required=mask)
        if decision.mask is None and mask:
            decision = self.evidence.decide()
        self._votes.add(decision)
        if not self._votes.agree:
            return []
        if not decision.mask:
            return self._nothing_known(t) if decision.mask is None else self._dismiss(t)
        if not self._votes.are_clear and t - self.since < self.settings.ambiguous_after:
            return []
        verdict = Verdict.AMBIGUOUS if decision.rivals else Verdict.UNIQUE
        return self._commit(t, self.evidence.belief(decision, verdict))

    def _follow(self, t: float) -> list[Event]:
        """Follow the size of what is believed; let it be decided anew if something else explains more."""
        now, unknown = self.beliefs.now, self.beliefs.now.verdict is Verdict.UNKNOWN
        if unknown:
            self.beliefs.neurons.believe()
            if self.beliefs.neurons.is_away():
                self.beliefs.drop_unknown()
                self._rest()
                return [self._event(t, "idle", "the unknown torque is gone; remembered, in case it returns")]
        decision = self.evidence.decide()
        self._votes.add(decision)
        sure = self._votes.agree and self._votes.are_clear
        if now.mask and decision.mask == now.mask:
            found = self.evidence.belief(decision, now.verdict)
            self.beliefs.hold(replace(found, rivals=now.rivals))
            if now.verdict is not Verdict.AMBIGUOUS or not sure:
                return []
            only = replace(found, verdict=Verdict.UNIQUE, rivals=())
            return self._commit(t, only, "the motion since then tells them apart")
        if not sure or not decision.mask or (unknown and t - self.since < 2 * SHORT_LIVED):
            return []
        before = ", ".join(term.label for term in self.faults) or str(now.verdict)
        return self._commit(
            t, self.evidence.belief(decision, Verdict.UNIQUE), f"decided anew, before: {before}"
        )

    def _commit(self, t: float, belief: Belief, reason: str = "") -> list[Event]:
        self.evidence.rely_on_nothing()
        self.beliefs.commit(belief)
        if belief.verdict is Verdict.AMBIGUOUS:
            reason = what_separates([self.faults, *self.beliefs.alternatives])
        return self._believed(t, reason)

    def _commit_unknown(self, t: float) -> list[Event]:
        self.beliefs.commit_unknown()
        return self._believed(t, "no combination of the bank explains it; its torque is being learned")

    def _believed(self, t: float, reason: str) -> list[Event]:
        self._begin(t, self._settled)
        self.observer.joint[self.observer.k.EXCEEDED, self.j] = 0.0
        events = [self._event(t, "isolation", reason)]
        return [*events, self._event(t, "accommodation")] if self.settings.accommodate else events

    # ------------------------------------------------------------- doubt

    def _doubt(self, t: float) -> list[Event]:
        """Wait a moment whether a young belief is gone rather than wrong."""
        self.stage, self._doubted = Stage.DETECTED, t
        return [self._event(t, "detection", "what was isolated does not explain what follows")]

    def _settle_doubt(self, t: float) -> list[Event]:
        """Take back a belief that has failed soon: what was seen since the detection is decided upon anew."""
        if t - self._doubted < 1.5 * self.settings.gone_after + 4.0 / self.observer.bandwidth[self.j]:
            return []
        self._doubted = np.inf
        if t - self.last_alarm > 2 * self.settings.decide_every:  # a moment's roughness
            self.stage = self._settled
            return []
        self._failures += 1
        self.evidence.rely_on_nothing()
        if self._failures >= MOST_FAILURES:
            return self._commit_unknown(t)
        self.beliefs.hold(Belief.nothing(self.bank))
        self._begin(t, Stage.DETECTED)
        self._mixed = True
        return []

    def _nothing_known(self, t: float) -> list[Event]:
        """Leave out what was seen before a belief failed: something else may have begun then. Else it is unknown."""
        if not self._mixed:
            return self._commit_unknown(t) if t - self.since >= self.settings.unknown_after else []
        self.evidence.restart()
        self._begin(t, Stage.DETECTED)
        self._mixed = False
        return []

    # ------------------------------------------------------------- idle monitoring

    def absent(self, t: float) -> list[Event]:
        """Drop the effects whose torque has stayed away where it would show."""
        gone = self.beliefs.absent()
        if not gone:
            return []
        self._doubted = np.inf
        if self.beliefs.come_and_go(gone):
            self.beliefs.confine(gone)
            self.evidence.restart()
            self._begin(t, self._settled)
            reason = "present only in a region of the motion"
            return [Event(t, "idle", (self.name,), self.beliefs.now.verdict, self.faults, reason=reason)]
        faults = self.beliefs.drop(gone)
        self.evidence.restart(beside=self.beliefs.now)
        self._begin(t, self.stage)
        if not self.beliefs.now.mask:
            self._rest()
        reason = "gone; remembered, in case it returns"
        return [Event(t, "idle", (self.name,), Verdict.NONE, faults, reason=reason)]

    def _dismiss(self, t: float) -> list[Event]:
        if t - self.last_alarm <= CALM:
            return []
        self._rest()
        return [self._event(t, "idle", "below the threshold again before it could be isolated")]

    def _rest(self) -> None:
        self.stage = Stage.IDLE if self.beliefs.remembers else Stage.HEALTHY
        self.beliefs.rest()
        self.evidence.end()

    # ------------------------------------------------------------- all stages

    @property
    def _believes(self) -> bool:
        return self.stage in (Stage.ACCOMMODATED, Stage.ISOLATED)

    @property
    def _settled(self) -> Stage:
        """The stage of a joint whose fault is known."""
        return Stage.ACCOMMODATED if self.settings.accommodate else Stage.ISOLATED

    def _begin(self, t: float, stage: Stage) -> None:
        self.stage, self.since = stage, t
        self._votes.clear()

    def _event(self, t: float, stage: str, reason: str = "") -> Event:
        if stage in ("detection", "idle"):
            return Event(t, stage, (self.name,), Verdict.NONE, reason=reason)
        b = self.beliefs
        return Event(t, stage, (self.name,), b.now.verdict, b.faults, b.alternatives, reason)
