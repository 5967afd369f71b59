"""The monitor of the whole arm: contact at once, then one cause for all joints, before joints decide by themselves.

Contact is said as soon as several joints leave their course together, and is gone when they are back. If what
happened stays, and one payload or tilt explains it on all joints better than effects of the joints do, it is that.
Joints do not decide while either is in question. From then on the arm is computed as it is now, so that further changes
are seen beside it.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cdia_pin.diagnosis import kernels, ridge_kernel
from cdia_pin.diagnosis.bank import Bank
from cdia_pin.diagnosis.healthy_arm import HealthyArm
from cdia_pin.diagnosis.kernel_cache import first_call
from cdia_pin.diagnosis.momentum_observer import MomentumObserver
from cdia_pin.diagnosis.monitor_settings import MonitorSettings
from cdia_pin.diagnosis.stateful import Stateful
from cdia_pin.diagnosis.status import NO_CONTACT, WITHDRAWN, Event, EventStage, Verdict
from cdia_pin.diagnosis.whole_arm import evidence_kernel, isolation_kernel
from cdia_pin.diagnosis.whole_arm.belief import carried, changed, ends, is_possible, known, refines
from cdia_pin.diagnosis.whole_arm.contact import ContactDetector, ContactLimits
from cdia_pin.diagnosis.whole_arm.evidence import ArmEvidence
from cdia_pin.diagnosis.whole_arm.hypotheses import HYPOTHESES
from cdia_pin.diagnosis.whole_arm.isolation import UNDECIDED, ArmDecision, decide, region_95
from cdia_pin.diagnosis.whole_arm.question import Question
from cdia_pin.diagnosis.whole_arm.trial import ArmTrial, why
from cdia_pin.diagnosis.whole_arm.wrench import Contact
from cdia_pin.effects import Term

Array = NDArray[np.float64]

LONGEST_CONTACT = 10.0  # [s], after which joints decide by themselves: nobody leans on an arm for longer
TRIAL = 10.0  # [s] after its isolation, for which an effect is updated, and withdrawn if joints alarm again
REFINED_EVERY = 1.0  # [s] between two updates: each makes a robot model, in a fraction of a millisecond


class ArmMonitor(Stateful):
    """The stages of what concerns the whole arm.

    Args:
        observer: Residuals of all joints.
        bank: Known effects of the joints.
        healthy: What is known of the healthy arm.
        limits: Largest deviations of a healthy arm.
        settings: Settings of the monitor.

    Attributes:
        evidence: Samples since the first alarm of the question; kept while its answer is on trial.
        fresh: Those since further joints left their thresholds, while something is on trial or in question already.
        believed: Effects of the whole arm that are present, with their numbers.
        contact: Contact of the moment; None without.
        apart: Whether joints by themselves explain what they show, so that it is no contact.
        carried_torque: What gravity and motion take of the joints by what is believed [N·m or N], shape (n,).
        moved: Joints whose residual the last look changed by more than a healthy one, shape (n,).
    """

    STATE = (
        "evidence",
        "fresh",
        "detector",
        "believed",
        "contact",
        "apart",
        "carried_torque",
        "_question",
        "_refined_at",
        "_trial",
        "_votes",
        "_decision",
    )
    DERIVED = ("moved",)

    def __init__(
        self,
        observer: MomentumObserver,
        bank: Bank,
        healthy: HealthyArm,
        limits: ContactLimits,
        settings: MonitorSettings,
    ) -> None:
        self.observer, self.bank, self.settings = observer, bank, settings
        self.evidence, self.fresh = (ArmEvidence(observer, bank.width, HYPOTHESES, healthy) for _ in range(2))
        self.detector = ContactDetector(limits)
        self._question: Question | None = None
        for hypothesis in HYPOTHESES:
            region_95(hypothesis.shown)  # imports SciPy's part before the first tick
        if not isolation_kernel.decided.signatures:
            modules = (evidence_kernel, isolation_kernel, ridge_kernel, kernels)
            first_call("the fits of the whole arm", modules, self._tried_once)
        self.reset()

    def _tried_once(self) -> None:
        """Collect a sample and decide in the types of a control loop, and forget it."""
        o, evidence = self.observer, self.evidence
        evidence.start(0.0)
        evidence.add(0.0, o.q, o.v)
        evidence.weight[:], evidence.gram[:] = 1.0, np.eye(evidence.gram.shape[1])
        decide(evidence, self.bank, (0,), self.settings)
        evidence.stop()

    def reset(self) -> None:
        """Return to the healthy arm."""
        self.believed: tuple[Term, ...] = ()
        self.contact: Contact | None = None
        self.carried_torque = np.zeros(self.observer.nominal.robot.n)
        self.moved = np.zeros(self.observer.nominal.robot.n, bool)
        self.observer.carry(self.observer.nominal.robot)
        self._refined_at = -np.inf
        self.restart()

    def restored(self) -> None:
        """Compute the arm with what it carries."""
        self.observer.carry(carried(self.observer.nominal, self.believed))

    def restart(self) -> None:
        """Start the filters again after a gap in the data; what is believed stays."""
        self.detector.reset()
        self.evidence.stop()
        self.contact = None
        self.apart = False
        self._trial: ArmTrial | None = None
        self._votes: deque[int | None] = deque(maxlen=self.settings.votes)
        self._close()

    @property
    def faults(self) -> tuple[Term, ...]:
        """What is believed of the whole arm, and the contact of the moment."""
        return self.believed if self.contact is None else (*self.believed, self.contact.term)

    @property
    def is_busy(self) -> bool:
        """Whether anything is believed, collected or in contact."""
        return bool(self.believed) or self.contact is not None or self.evidence.is_active

    @property
    def asked_since(self) -> float:
        """When joints began to show what is in question [s]; infinite if nothing is."""
        return np.inf if self._question is None else self._question.since

    def is_touched(self, t: float) -> bool:
        """Tell whether there is contact, or its end is not certain yet: then nothing must be corrected.

        Args:
            t: Time [s].
        """
        return self.contact is not None or self.detector.recovers(t)

    def holds_joints(self, t: float) -> bool:
        """Tell whether joints must wait with their own decisions.

        Args:
            t: Time [s].
        """
        if self.contact is not None and t - self.contact.since < LONGEST_CONTACT:
            return True
        lead = self._decision.lead
        open_question = lead > -self.settings.lead and t - self.asked_since < self.settings.ambiguous_after
        return self._counts(self._decision) and (lead > self.settings.lead or open_question)

    def forget(self, j: int) -> None:
        """Forget the collected samples of a joint.

        Args:
            j: The joint's index.
        """
        for evidence in (self.evidence, self.fresh):
            evidence.forget(j)

    # ------------------------------------------------------------- ticks

    def sample(self, dt: float) -> bool:
        """Take the observer's present sample; return whether contact has begun or ended.

        Args:
            dt: Time since the last one [s].
        """
        o = self.observer
        if self.believed:  # its formula may miss a share for a moment, as those of the joints' effects may
            self._carry_torque()
            o.state.amplitude = np.maximum(o.state.amplitude, np.abs(self.carried_torque))
        self.detector.add(o.time, dt, o.remainder, o.state.moving, o.state.nle, o.state.amplitude)
        for evidence in (self.evidence, self.fresh):
            if evidence.is_active:
                evidence.add(o.time, o.q, o.v)
        if self.contact is not None and self.detector.present:
            self.contact = self._touched(self.contact.since)
        return self._is_in_contact != (self.contact is not None)

    @property
    def _is_in_contact(self) -> bool:
        """Whether there is contact, and joints by themselves do not explain what they show."""
        return self.detector.present and not self.apart

    def _carry_torque(self) -> None:
        o = self.observer
        now = np.array(o.carried.rigid_terms(o.q, o.v)[1])
        self.carried_torque = now - o.nominal.robot.rigid_terms(o.q, o.v)[1]

    def follow_contact(self, t: float) -> list[Event]:
        """Say that contact has begun or ended, if so.

        Args:
            t: Time [s].
        """
        if self._is_in_contact == (self.contact is not None):
            return []
        if self.contact is None:
            self.contact = self._touched(t)
            joints, fault = self.contact.joints, (self.contact.term,)
            return [
                Event(
                    t, EventStage.DETECTION, joints, Verdict.NONE, reason="joints leave their course together"
                ),
                Event(t, EventStage.ISOLATION, joints, Verdict.UNIQUE, fault, reason=self.contact.in_words),
            ]
        gone, self.contact = self.contact, None
        said = NO_CONTACT if self.apart else "the contact is gone"
        return [Event(t, EventStage.IDLE, gone.joints, Verdict.NONE, (gone.term,), reason=said)]

    def look(self, t: float, alarmed: Sequence[int]) -> list[Event]:
        """Decide whether one effect of the whole arm explains what joints show.

        Args:
            t: Time [s].
            alarmed: Indices of the joints that have left their thresholds and are not decided.
        """
        asking = set(alarmed)
        self.moved[:] = False
        if self.contact is not None:
            asking |= {self.observer.nominal.robot.joint_index(j) for j in self.contact.joints}
        if not asking:
            return self._refine(t)
        joints, said = sorted(asking), []
        if self._question is None:
            self._question = Question.of(asking, t)
            said = self._begin(t, joints)
        self._question, is_late = self._question.joined_by(asking, t)
        if is_late:
            self.fresh.start(self.observer.time)
        found = self._decided(joints)
        if self.fresh.is_active and not self._is_clear(found):
            newer = self._decided(joints, self.fresh)
            if self._is_clear(newer):
                found, self._question = newer, self._question.of_the_further()
                self._go_on_afresh()
        self._decision = found
        leads = self._counts(found) and found.lead > self.settings.lead
        if found.joints_explain and not leads and not self.apart:
            self.apart = True
            self.detector.settle(self.observer.time, self.observer.remainder)
        self._votes.append(found.index if leads else None)
        agree = len(self._votes) == self._votes.maxlen and len(set(self._votes)) == 1
        if not leads or not agree:
            return said
        return [*said, *self._commit(t, found, self._names(joints))]

    def _names(self, joints: Sequence[int]) -> tuple[str, ...]:
        return tuple(self.observer.nominal.robot.joints[j] for j in joints)

    # ------------------------------------------------------------- beliefs

    def _begin(self, t: float, joints: Sequence[int]) -> list[Event]:
        """Ask what joints show: what is on trial may have other numbers, may be wrong, or this is something else."""
        self._end_trial(t)
        withdrawn = () if self._trial is None else self._withdrawn(self._trial, joints)
        if self._trial is not None:
            self.fresh.start(self.observer.time)
        elif not withdrawn:
            self.evidence.start(self.observer.time)
        self._votes.clear()
        names = self._names(joints)
        return [
            Event(t, EventStage.IDLE, names, Verdict.NONE, (term,), reason=WITHDRAWN) for term in withdrawn
        ]

    def _go_on_afresh(self) -> None:
        """Go on with the samples since a later alarm alone, because these say for sure what it is; end the trial.

        An arm may put down what it took some seconds before, or take it while a joint is in question for a cause of its
        own. The samples in between would hide it for as long again.
        """
        self.evidence, self.fresh, self._trial = self.fresh, self.evidence, None
        self.fresh.stop()
        self._votes.clear()

    def _commit(self, t: float, found: ArmDecision, joints: tuple[str, ...]) -> list[Event]:
        assert found.index is not None
        if self._trial is None or self._trial.index != found.index:
            self._trial = ArmTrial(found.index, self.believed, np.zeros_like(found.theta), t)
        before = self._believe(found)
        self.detector.settle(self.observer.time, self.observer.remainder)
        term = next((b for b in self.believed if b.label == before.label), None)
        events = []
        if self.contact is not None:
            last, self.contact = self.contact, None
            events = [Event(t, EventStage.IDLE, last.joints, Verdict.NONE, (last.term,), reason=NO_CONTACT)]
        self._refined_at = t
        self._close()
        if term is None:
            self._trial = None
            return [*events, Event(t, EventStage.IDLE, joints, Verdict.NONE, (before,), reason="cleared")]
        events.append(Event(t, EventStage.ISOLATION, joints, Verdict.UNIQUE, (term,), reason=why(term)))
        if self.settings.accommodate:
            events.append(Event(t, EventStage.ACCOMMODATION, joints, Verdict.UNIQUE, (term,)))
        return events

    def _refine(self, t: float) -> list[Event]:
        """Update the parameters of what was isolated of late; collect no more after a while."""
        self.apart = False
        self._close()
        self._end_trial(t)
        if self._trial is None:
            self.evidence.stop()
            return []
        if not self.evidence.is_active or t - self._refined_at < REFINED_EVERY:
            return []
        self._refined_at = t
        found = decide(self.evidence, self.bank, (), self.settings)
        if found.index != self._trial.index:
            found = decide(self.evidence, self.bank, (), self.settings, self._trial.index)
            if found.is_sure:
                return []  # its numbers differ, but another effect of the whole arm would explain that better
        if refines(self.believed, found, self.observer.nominal.robot):
            before = self.observer.remainder.copy()
            self._believe(found)
            self.detector.shift(self.observer.remainder - before)
        return []

    def _decided(self, joints: Sequence[int], evidence: ArmEvidence | None = None) -> ArmDecision:
        """Return the decision on samples, all if omitted; none if the arm with what it says would be impossible."""
        found = decide(evidence or self.evidence, self.bank, joints, self.settings)
        if not self._counts(found):  # then it says nothing, possible or not
            return found
        if ends(self.believed, found) or is_possible(
            changed(self.believed, found), self.observer.nominal.robot
        ):
            return found
        return replace(UNDECIDED, joints_explain=found.joints_explain)

    def _end_trial(self, t: float) -> None:
        """End the trial of what was isolated so long ago that it is no longer in doubt."""
        if self._trial is not None and t - self._trial.since > TRIAL:
            self._trial = None

    def _counts(self, found: ArmDecision) -> bool:
        """Tell whether a decision may be believed if it leads: what is on trial needs no more than other numbers."""
        return found.is_sure or (self._trial is not None and found.index == self._trial.index)

    def _is_clear(self, found: ArmDecision) -> bool:
        """Tell whether a decision is sure, and leads all other causes."""
        return found.is_sure and found.lead > self.settings.lead

    def _withdrawn(self, trial: ArmTrial, joints: Sequence[int]) -> tuple[Term, ...]:
        """Withdraw what is on trial if another effect explains all samples better; return what is withdrawn."""
        self.evidence.shift(trial.index, -trial.moved)
        found = decide(self.evidence, self.bank, joints, self.settings)
        self.evidence.shift(trial.index, trial.moved)
        if found.index == trial.index or not self._is_clear(found):
            return ()
        withdrawn = tuple(term for term in self.believed if term not in trial.before)
        self._move(trial.index, -trial.moved)
        self._become(trial.before)
        self.detector.settle(self.observer.time, self.observer.remainder)
        self._trial = None
        return withdrawn

    def _believe(self, found: ArmDecision) -> Term:
        """Add a change to what is believed; return the effect as it is now, or as it was if it is gone."""
        assert found.index is not None
        old, shown = known(self.believed, found)
        others = tuple(b for b in self.believed if b is not old)
        gone = ends(self.believed, found)
        term, moved = changed(self.believed, found), -shown if gone else found.theta
        self._move(found.index, moved)
        self._become(others if gone else (*others, term))
        if self._trial is not None:
            self._trial = replace(self._trial, moved=self._trial.moved + moved)
        return old if old is not None and gone else term

    def _move(self, k: int, theta: Array) -> None:
        """Take a change of a hypothesis out of the present residual, and out of what was collected."""
        o, explained = self.observer, self._columns(k) @ theta
        o.state.residual = o.residual - explained
        o.state.amplitude = np.maximum(o.state.amplitude, np.abs(explained))
        self.moved |= self.evidence.rms(k, theta) > self.evidence.level
        for evidence in (self.evidence, self.fresh):
            evidence.shift(k, theta)

    def _become(self, believed: tuple[Term, ...]) -> None:
        """Believe in effects of the whole arm, and compute the arm as it is with them from now on."""
        self.believed, o = believed, self.observer
        o.carry(carried(o.nominal, believed))
        for j in range(o.nominal.robot.n):
            o.refresh(j)
        self._carry_torque()

    def _columns(self, k: int) -> Array:
        """Return the filtered columns of a hypothesis, shape (n, shown)."""
        first, end = (int(e) - self.bank.width for e in self.evidence.ends[k : k + 2])
        return self.evidence.columns[:, first:end]

    def _close(self) -> None:
        """Take the present question as answered."""
        self._question = None
        self.fresh.stop()
        self._decision = UNDECIDED
        self._votes.clear()

    def _touched(self, since: float) -> Contact:
        o, d = self.observer, self.detector
        return Contact.of(d.deviation, d.limit, o.nominal.robot, o.q, since)
