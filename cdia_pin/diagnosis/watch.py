"""One joint under watch: the four stages of the scheme, and the way from one to the next ([Thesis] fig. 6).

A joint is healthy until its remainder, the residual less what is believed already, passes the threshold:
*detection*. From then on its normal equations are collected and looked at several times a second; when enough looks
in a row agree, the fault is *isolated* and from then on *accommodated*. An effect whose torque stays away where it
would show is *idle*: no longer corrected for, but remembered, and taken up again at once when it returns. At no
stage is anything final: later looks may decide otherwise.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis.approximation import weights
from cdia_pin.diagnosis.bank import on_joint
from cdia_pin.diagnosis.isolation import Decision, Isolator
from cdia_pin.diagnosis.learning import Healthy
from cdia_pin.diagnosis.observer import Observer
from cdia_pin.diagnosis.region import RegionLearner
from cdia_pin.diagnosis.settings import MonitorSettings
from cdia_pin.diagnosis.status import Event, Stage, Verdict
from cdia_pin.diagnosis.words import what_separates
from cdia_pin.effects import Profile, Term, Unknown

Array = NDArray[np.float64]

REMEMBERED = 1.0  # [s], how long a belief counts as measured when the next fault comes
RETURN_LOOKS = 3  # looks that a remembered fault must explain to be taken up again
SHORT_LIVED = 3.0  # [s], a belief that fails sooner was none
MOST_FAILURES = 3  # of beliefs in a row, after which nothing known is believed
ENOUGH = 6.0  # correlation times of a healthy residual, that a decision is based on
MOST_WAITED = 0.4  # [1], share of the memory that is waited for at most
GONE_UNKNOWN = 0.6  # [s] without an unknown torque, where it would show, after which it is dropped
CALM = 0.5  # [s] below the threshold after which an alarm that led to nothing is dropped


@dataclass(frozen=True)
class Memory:
    """A fault that was there and is gone.

    Attributes:
        mask: Its effects, one bit each.
        theta: Their parameters, shape (P,).
    """

    mask: int
    theta: Array


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
        self.j, self.observer, self.isolator, self.settings = j, observer, isolator, settings
        self.name = observer.nominal.robot.joints[j]
        self.bank = isolator.bank
        self.unknown = unknown
        self.level = float(healthy.level[j])
        self.independent = float(healthy.memory[j]) / observer.dt  # ticks
        self._forget()

    def _forget(self) -> None:
        self.profiles: dict[int, Profile] = {
            i: on_joint(p, self.name) for i, p in enumerate(self.bank.profiles) if p.kind != "always"
        }
        self.regions: dict[int, RegionLearner] = {}
        self.observer.columns[self.observer.k.PRESENT, self.j] = 1.0
        self.stage = Stage.HEALTHY
        self.verdict = Verdict.NONE
        self.mask = 0  # effects believed in
        self.theta = np.zeros(self.bank.width)
        self.ci95: Array | None = None
        self.rivals: tuple[tuple[int, Array], ...] = ()
        self.memories: list[Memory] = []
        self.since = self.last_alarm = -np.inf
        self._votes: deque[tuple[int, bool]] = deque(maxlen=self.settings.votes)
        self._prior = np.zeros(self.bank.width)
        self._centre = np.zeros(self.bank.width)
        self._recalled, self._away, self._failures = 0, 0, 0
        self._was_unknown = self._mixed = False
        self._doubted = np.inf

    def reset(self) -> None:
        """Return to healthy, believing nothing."""
        self._forget()
        self._believe()
        self.observer.stop_learning(self.j)
        self.observer.end_decision(self.j)

    def restart(self) -> None:
        """Begin the present stage anew, after a gap in the data; beliefs stay."""
        self._votes.clear()
        if self.stage not in (Stage.HEALTHY, Stage.IDLE):
            self._keep_belief()
            self.observer.restart_decision(self.j)

    # ------------------------------------------------------------- detection

    def alarm(self, t: float) -> list[Event]:
        """Answer a remainder beyond the threshold."""
        self.last_alarm = t
        if self.stage is Stage.DETECTED:
            return []
        if self.stage in (Stage.ACCOMMODATED, Stage.ISOLATED):
            if self.verdict is Verdict.UNKNOWN or t - self.since < 2 * self.settings.decide_every:
                return []  # the approximation follows by itself
            if t - self.since < SHORT_LIVED:
                return self._doubt(t)
            self._failures = 0
            self._keep_belief()
        else:
            self._prior[:] = 0.0
            self._failures = 0
        if self._was_unknown:
            self.observer.restart_decision(self.j)
            return [self._event(t, "detection"), *self._commit_unknown(t)]
        self.observer.restart_decision(self.j)
        if not self.observer.joint[self.observer.k.LEARNING, self.j]:
            self.observer.start_learning(self.j)
        self.stage, self.verdict = Stage.DETECTED, Verdict.NONE
        self.since, self._recalled, self._mixed = t, 0, False
        self._votes.clear()
        return [self._event(t, "detection")]

    def _doubt(self, t: float) -> list[Event]:
        """Wait a moment whether a young belief is gone rather than wrong."""
        self.stage, self._doubted = Stage.DETECTED, t
        return [self._event(t, "detection", "what was isolated does not explain what follows")]

    @property
    def deaf(self) -> bool:
        """Whether another alarm would change nothing."""
        return self.stage is Stage.DETECTED or self.verdict is Verdict.UNKNOWN

    def _settle_doubt(self, t: float) -> list[Event]:
        """Take back a belief that has failed soon: what was seen since the detection is decided upon anew."""
        if t - self._doubted < 1.5 * self.settings.gone_after + 4.0 / self.observer.bandwidth[self.j]:
            return []
        self._doubted = np.inf
        if t - self.last_alarm > 2 * self.settings.decide_every:  # a moment's roughness
            self.stage = Stage.ACCOMMODATED if self.settings.accommodate else Stage.ISOLATED
            return []
        self._failures += 1
        self.mask, self.theta, self.ci95, self.rivals = 0, np.zeros(self.bank.width), None, ()
        self._prior[:] = 0.0
        if self._failures >= MOST_FAILURES:
            return self._commit_unknown(t)
        self._believe()
        self.verdict, self.since, self._mixed = Verdict.NONE, t, True
        self._votes.clear()
        return []

    def _nothing_known(self, t: float) -> list[Event]:
        """Leave out what was seen before a belief failed: something else may have begun then. Else it is unknown."""
        if not self._mixed:
            return self._commit_unknown(t) if t - self.since >= self.settings.unknown_after else []
        self.observer.restart_decision(self.j)
        self._mixed, self.since = False, t
        self._votes.clear()
        return []

    def _keep_belief(self) -> None:
        """Hold what is believed for measured, so that the next fault is decided upon beside it."""
        weight = self.observer.joint[self.observer.k.WEIGHT, self.j]
        columns = self.bank.columns(self.isolator.members(self.mask))
        diagonal = np.diag(self.observer.gram[self.j])[columns] / max(weight, 1.0)
        self._prior[:] = 0.0
        self._prior[columns] = diagonal * REMEMBERED / self.observer.dt
        self._centre = self.theta.copy()

    # ------------------------------------------------------------- looks

    def look(self, t: float) -> list[Event]:
        """Look at the normal equations and at what has been believed."""
        if self.observer.joint[self.observer.k.EXCEEDED, self.j] >= self.settings.debounce:
            self.last_alarm = t
        self._watch_regions()
        if self._doubted < np.inf:
            return self._settle_doubt(t)
        if self.stage is Stage.DETECTED:
            return self._isolate(t) if self._has_seen_enough() else []
        if self.stage in (Stage.ACCOMMODATED, Stage.ISOLATED):
            return self._follow(t)
        return []

    def _decide(self, required: int = 0) -> Decision:
        o = self.observer
        return self.isolator.decide(
            self.j,
            o.gram[self.j],
            max(float(o.joint[o.k.WEIGHT, self.j]), 1.0),
            self.level,
            self.independent,
            required=required,
            prior=self._prior,
            centre=self._centre,
        )

    def _isolate(self, t: float) -> list[Event]:
        if self._recall():
            return self._commit(t, self.mask, Verdict.UNIQUE, "as it was before")
        decision = self._decide(required=self.mask)
        if decision.mask is None and self.mask:
            decision = self._decide()
        self._votes.append((decision.key, bool(decision.rivals)))
        waited = t - self.since
        if not self._agreed():
            return []
        if decision.mask == 0:
            return self._dismiss(t) if t - self.last_alarm > CALM else []
        if decision.mask is None:
            return self._nothing_known(t)
        clear = not any(ambiguous for _, ambiguous in self._votes)
        if not clear and waited < self.settings.ambiguous_after:
            return []
        self.theta, self.rivals = decision.theta, decision.rivals
        self._interval(decision)
        return self._commit(t, decision.mask, Verdict.UNIQUE if not decision.rivals else Verdict.AMBIGUOUS)

    def _has_seen_enough(self) -> bool:
        """Tell whether there are samples enough to decide, or to remember a fault by."""
        o = self.observer
        enough = min(ENOUGH * self.independent, MOST_WAITED * self.settings.memory / o.dt)
        return bool(self.memories) or o.joint[o.k.WEIGHT, self.j] >= enough

    def _agreed(self) -> bool:
        return len(self._votes) == self._votes.maxlen and len({key for key, _ in self._votes}) == 1

    def _follow(self, t: float) -> list[Event]:
        """Follow the size of what is believed; let it be decided anew if something else explains more."""
        if self.verdict is Verdict.UNKNOWN:
            self._approximate()
            if self._is_away():
                return self._drop_unknown(t)
        decision = self._decide()
        self._votes.append((decision.key, bool(decision.rivals)))
        if decision.mask is not None and decision.mask == self.mask and self.mask:
            self.theta = decision.theta
            self._interval(decision)
            self._believe()
            if self.verdict is Verdict.AMBIGUOUS and self._agreed() and not any(a for _, a in self._votes):
                self.rivals = ()
                return self._commit(t, self.mask, Verdict.UNIQUE, "the motion since then tells them apart")
            return []
        wanted = decision.mask is not None and decision.mask > 0 and not decision.rivals
        if self.verdict is Verdict.UNKNOWN and t - self.since < 2 * SHORT_LIVED:
            return []
        if self._agreed() and wanted and not any(a for _, a in self._votes):
            before = ", ".join(term.label for term in self.faults) or str(self.verdict)
            self.theta, self.rivals = decision.theta, ()
            self._interval(decision)
            return self._commit(t, decision.mask or 0, Verdict.UNIQUE, f"decided anew, before: {before}")
        return []

    # ------------------------------------------------------------- beliefs

    def _commit(self, t: float, mask: int, verdict: Verdict, reason: str = "") -> list[Event]:
        self.mask, self.verdict, self._was_unknown = mask, verdict, False
        self._prior[:] = 0.0
        self._forget_neurons()
        self.memories = [m for m in self.memories if m.mask & mask == 0]
        if verdict is Verdict.AMBIGUOUS:
            reason = what_separates([self.faults, *self.alternatives])
        return self._believed(t, reason)

    def _commit_unknown(self, t: float) -> list[Event]:
        self.mask, self.verdict, self.rivals, self.ci95 = 0, Verdict.UNKNOWN, (), None
        self.theta = np.zeros(self.bank.width)
        self._approximate()
        return self._believed(t, "no combination of the bank explains it; its torque is being learned")

    def _believed(self, t: float, reason: str) -> list[Event]:
        self._believe()
        self.since = t
        self._votes.clear()
        self.observer.joint[self.observer.k.EXCEEDED, self.j] = 0.0
        self.stage = Stage.ACCOMMODATED if self.settings.accommodate else Stage.ISOLATED
        events = [self._event(t, "isolation", reason)]
        if self.settings.accommodate:
            events.append(self._event(t, "accommodation"))
        return events

    def _believe(self) -> None:
        o = self.observer
        o.believe(self.j, self.theta if self.mask else np.zeros(self.bank.width))
        o.absent[self.j] *= np.array([self.mask >> i & 1 for i in range(len(o.effects))])

    def _interval(self, decision: Decision) -> None:
        if decision.mask:
            gram = self.observer.gram[self.j]
            self.ci95 = self.isolator.intervals(
                decision.mask, decision.theta, gram, decision.noise, self.independent
            )

    def _forget_neurons(self) -> None:
        """Believe no unknown fault; what its neurons have seen stays, in case that nothing known holds."""
        self.observer.neurons[self.observer.k.WEIGHTS, self.j] = 0.0
        self.observer.refresh(self.j)

    def _approximate(self) -> None:
        o = self.observer
        o.neurons[o.k.WEIGHTS, self.j] = weights(o.neuron_gram[self.j])
        o.refresh(self.j)

    # ------------------------------------------------------------- idle monitoring

    def absent(self, t: float) -> list[Event]:
        """Drop the effects whose torque has stayed away where it would show."""
        o = self.observer
        gone = [i for i in self.isolator.members(self.mask) if o.absent[self.j, i] >= o.idle_ticks]
        if not gone:
            return []
        known = [i for i in gone if i in self.regions and self.regions[i].region is not None]
        if known == gone:
            return self._gate(t, gone)
        mask = sum(1 << i for i in gone)
        theta = np.zeros_like(self.theta)
        columns = self.bank.columns(gone)
        theta[columns] = self.theta[columns]
        faults = self._terms(mask, theta)
        self.memories = [m for m in self.memories if m.mask != mask] + [Memory(mask, theta)]
        o.absent[self.j] = 0.0
        self.mask &= ~mask
        self.theta = np.where(np.isin(np.arange(len(theta)), columns), 0.0, self.theta)
        self.ci95, self.rivals = None, ()
        self._keep_belief()
        self._believe()
        o.restart_decision(self.j)
        self._votes.clear()
        self.since, self._doubted = t, np.inf
        if not self.mask:
            self._rest()
        return [
            Event(
                t, "idle", (self.name,), Verdict.NONE, faults, reason="gone; remembered, in case it returns"
            )
        ]

    def _gate(self, t: float, effects: list[int]) -> list[Event]:
        """Keep effects that come and go with the motion, present from now on only in the region that was learned."""
        for i in effects:
            region = self.regions[i].region
            assert region is not None
            self.profiles[i] = region
        self.observer.absent[self.j] = 0.0
        self.observer.restart_decision(self.j)
        self._keep_belief()
        self._votes.clear()
        self._doubted = np.inf
        self.stage = Stage.ACCOMMODATED if self.settings.accommodate else Stage.ISOLATED
        self.since = t
        return [
            Event(
                t,
                "idle",
                (self.name,),
                self.verdict,
                self.faults,
                reason="present only in a region of the motion",
            )
        ]

    def _rest(self) -> None:
        self.stage = Stage.IDLE if self.memories or self._was_unknown else Stage.HEALTHY
        self.verdict = Verdict.NONE
        self.mask = 0
        self.theta = np.zeros(self.bank.width)
        self._believe()
        if not self._was_unknown:
            self.observer.stop_learning(self.j)
        self.observer.end_decision(self.j)

    def _dismiss(self, t: float) -> list[Event]:
        self._rest()
        return [self._event(t, "idle", "below the threshold again before it could be isolated")]

    def _is_away(self) -> bool:
        """Tell whether an unknown fault has stayed away where it would show."""
        o = self.observer
        learned = float(o.joint[o.k.LEARNED, self.j])
        visible = abs(learned) > 2 * o.threshold[self.j]
        if visible and abs(o.residual[self.j]) < o.threshold[self.j]:
            self._away += 1
        elif visible:
            self._away = 0
        return self._away * self.settings.decide_every >= GONE_UNKNOWN

    def _drop_unknown(self, t: float) -> list[Event]:
        self._away, self._was_unknown = 0, True
        self._forget_neurons()
        self._rest()
        return [self._event(t, "idle", "the unknown torque is gone; remembered, in case it returns")]

    def _recall(self) -> bool:
        """Tell whether a remembered fault explains what has been seen since the alarm, and believe it again."""
        o = self.observer
        G = o.gram[self.j]
        P = self.bank.width
        upper = np.triu(G[:P, :P])
        full = upper + np.triu(upper, 1).T
        for memory in self.memories:
            theta = self.theta + memory.theta
            rss = G[-1, -1] - 2 * theta @ G[:P, -1] + theta @ full @ theta
            if rss < 0.05 * G[-1, -1]:
                self._recalled += 1
                if self._recalled >= RETURN_LOOKS:
                    self.mask |= memory.mask
                    self.theta, self.ci95, self.rivals = theta, None, ()
                    return True
                return False
        self._recalled = 0
        return False

    # ------------------------------------------------------------- profiles

    def _watch_regions(self) -> None:
        """Collect where the effects of the joint, believed or remembered, are present and where not."""
        o = self.observer
        threshold = 1.5 * float(o.threshold[self.j])
        for mask, theta in [(self.mask, self.theta), *((m.mask, m.theta) for m in self.memories)]:
            for i in self.isolator.members(mask):
                if i in self.profiles:
                    continue
                span = self.bank.span(i)
                own = float(theta[span] @ o.filtered[self.j, span])
                if abs(own) <= threshold:  # both are 0 where the filters have just begun
                    continue
                others = float(o.believed[self.j] @ o.filtered[self.j]) - (own if mask & self.mask else 0.0)
                share = (float(o.residual[self.j]) - others) / own
                learner = self.regions.setdefault(i, RegionLearner(self.name))
                learner.add(share, float(o.q[self.j]), float(o.v[self.j]))

    # ------------------------------------------------------------- what is said

    @property
    def faults(self) -> tuple[Term, ...]:
        """Faults believed in; what is unknown as its learned neurons."""
        if self.verdict is Verdict.UNKNOWN:
            w = self.observer.neurons[self.observer.k.WEIGHTS, self.j]
            return (Term(self.unknown, tuple(w)),)
        return self._terms(self.mask, self.theta, self.ci95)

    @property
    def alternatives(self) -> tuple[tuple[Term, ...], ...]:
        """Other combinations that explain the same."""
        return tuple(self._terms(mask, theta) for mask, theta in self.rivals)

    def _terms(self, mask: int, theta: Array, ci95: Array | None = None) -> tuple[Term, ...]:
        terms, at = [], 0
        for i in self.isolator.members(mask):
            effect = self.bank.effect(i, self.name)
            interval = (
                None if ci95 is None else tuple((float(a), float(b)) for a, b in ci95[at : at + effect.size])
            )
            at += effect.size
            term = Term(effect, tuple(theta[self.bank.span(i)]), ci95=interval)
            region = self.profiles.get(i) or (self.regions[i].region if i in self.regions else None)
            terms.append(replace(term, profile=region) if region is not None else term)
        return tuple(terms)

    def _event(self, t: float, stage: str, reason: str = "") -> Event:
        if stage in ("detection", "idle"):
            return Event(t, stage, (self.name,), Verdict.NONE, reason=reason)
        return Event(t, stage, (self.name,), self.verdict, self.faults, self.alternatives, reason)
