"""How far each effect of a discovery can be trusted: its decision and its size are repeated under other assumptions.

Nobody knows the right cut-off, the right links, or what else acts. An effect that is real does not depend on them.
The repeats: both halves of every log, 0.7 and 1.4 of the cut-off, and links that are five percent wrong. An established
effect is besides larger than what the model leaves, and several blocks of time show it, for one short motion says
nothing of the next. Unless every joint has it, each half of the log shows it by itself, and all repeats find about the
same torque: what follows a little of everything is another effect in each log, or of another size.
A gain that is not established may stand for something else, and then it scales the other effects of its joint: their
intervals reach to where they are without it.
What is established only beside descriptive effects that cancel it is likely, and its interval reaches to where it is
without them.
What only joints at rest show is descriptive, because static friction carries an unknown part of their load; it is
likely at most where no joint moves.
An effect that is not everyday must be certain beside all everyday ones, for these are on every arm. A body is asked for
beside the other links too, because the mass of a link is hard to tell from that of the next one.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cdia_pin.changes.confidence import Confidence
from cdia_pin.discovery.decision import Repeat
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import ActuatorGain, Term
from cdia_pin.effects.body import Body
from cdia_pin.effects.refinements import is_plain
from cdia_pin.errors import LogError
from cdia_pin.logs.conditioning import condition
from cdia_pin.logs.motion import Motion
from cdia_pin.regression.design_matrix import DesignMatrix
from cdia_pin.regression.effort_scale import doubted_scale, effort_tolerance, scale_error
from cdia_pin.regression.experiment import Experiment
from cdia_pin.regression.intervals import NORMAL_95
from cdia_pin.selection.discovery_settings import ConfidenceSettings
from cdia_pin.selection.problem import Problem

Array = NDArray[np.float64]

# On measured legs a sound payload moved by 0.3 half widths, and those that a wrench and a spring held up by 6 and 7.
# What is sound on a Panda moves by 3.5 at most, on a UR10, a UR10e and a UR5 by 1.7.
HELD_UP = 4.0  # half widths [1] by which an effect may move where all that is descriptive is left out


@dataclass(frozen=True)
class Trust:
    """What the repeats say about an effect.

    Attributes:
        confidence: How far its name can be trusted.
        of_speeds: Half width of the 95 % interval of its parameters by quarters of the speeds, where they show more
            than blocks of time, else 0, in their units, shape (p,).
        systematic: Half width by which its parameters differ between the repeats, in their units, shape (p,).
    """

    confidence: Confidence
    of_speeds: Array
    systematic: Array


def trust_in(logs: Problem, model: Dynamics, given: Dynamics) -> dict[str, Trust]:
    """Return how far the effects that were found can be trusted, by label.

    Args:
        logs: The logs.
        model: The fitted model.
        given: The model before the discovery; its own terms are not judged.
    """
    known = {t.label for t in given.terms}
    found = [t for t in model.terms if t.label not in known]
    if not found:
        return {}
    settings = logs.settings
    whole = replace(Repeat.of(logs, model), by_speed=True)
    resting = logs.experiment.resting
    moving = replace(whole, at_rest=False, by_speed=False) if resting.any() else whole
    logs.experiment.forget()
    others = [
        Repeat(DesignMatrix(x), replace(model, robot=x.robot), settings).settled()
        for x in variations(logs, model)
    ]
    repeats = [*whole.halves, *others]
    out = {}
    for term in found:
        size = whole.theta(term)
        telling = [r for r in repeats if r.survives(term) or r.could_show(term, size)]
        survived = [r.survives(term) for r in telling]
        shown = len(telling) >= settings.confidence.least_shown * len(repeats)
        alone = all(half in telling for half in whole.halves)
        if isinstance(term.effect, Body):  # the next link may have the same mass
            survived.append(whole.crowded.survives(term, spared=0))
        moved = np.array([r.theta(term) - size for r in telling]).reshape(-1, term.effect.size)
        steady = _is_steady(whole, term, moved)
        torque = whole.torque(term, np.array(term.theta))
        scale = effort_tolerance(logs.experiment, term.effect, torque) * np.abs(term.theta)
        systematic = np.hypot(np.abs(moved).max(axis=0, initial=0.0), scale)
        lasting = whole.spread(term) >= settings.confidence.least_spread
        moves = moving.needs(term)
        needed = whole.needs(term) and shown and (moves or bool(resting.all()))
        everywhere = is_plain(term.effect) or (alone and steady)
        firm = everywhere and lasting and whole.stands_out(term) and moves
        confidence = _confidence(needed, firm, survived, settings.confidence)
        by_time, by_speed = (
            np.sqrt(np.diag(c)) for c in (whole.covariance(term), whole.covariance_by_speed(term))
        )
        of_speeds = np.where(by_speed > by_time, NORMAL_95 * by_speed, 0.0)
        out[term.label] = Trust(confidence, of_speeds, systematic)
    out = {t.label: _without_descriptive(t, whole, out) for t in found}
    likely = (t for t in found if out[t.label].confidence is not Confidence.ESTABLISHED)
    doubt = doubted_scale(likely, model.robot)

    def widened(term: Term) -> Trust:
        theta, known = np.array(term.theta), out[term.label]
        scale = scale_error(term.effect, whole.torque(term, theta), doubt) * np.abs(theta)
        return replace(known, systematic=np.hypot(known.systematic, scale))

    return {t.label: widened(t) for t in found} if doubt.any() else out


def _is_steady(whole: Repeat, term: Term, moved: Array) -> bool:
    """Tell whether all repeats find about the same torque of an effect.

    Args:
        whole: The decision on the whole log.
        term: The effect.
        moved: Its parameters in the repeats less those in the whole log, shape (repeats, p).
    """
    own = np.max(whole.torque(term, whole.theta(term)))
    most = whole.settings.confidence.most_moved
    return all(np.max(whole.torque(term, change)) <= most * own for change in moved)


def _without_descriptive(term: Term, whole: Repeat, trust: Mapping[str, Trust]) -> Trust:
    """Return how far an effect can be trusted if what is descriptive is something else, gains apart: they scale it."""
    known = trust[term.label]
    if known.confidence is Confidence.DESCRIPTIVE:
        return known
    left_out = [
        t
        for t in whole.model.terms
        if t.label in trust
        and trust[t.label].confidence is Confidence.DESCRIPTIVE
        and not isinstance(t.effect, ActuatorGain)
    ]
    if not left_out:
        return known
    moved = np.abs(whole.theta_without(term, left_out) - whole.theta(term))
    statistical = np.maximum(NORMAL_95 * np.sqrt(np.diag(whole.covariance(term))), known.of_speeds)
    if (moved <= HELD_UP * np.hypot(statistical, known.systematic)).all():
        return known
    return replace(known, confidence=Confidence.LIKELY, systematic=np.maximum(known.systematic, moved))


def _confidence(
    needed: bool, firm: bool, survived: Sequence[bool], settings: ConfidenceSettings
) -> Confidence:
    if not needed or np.mean(survived) < settings.likely_share:
        return Confidence.DESCRIPTIVE
    return Confidence.ESTABLISHED if firm and all(survived) else Confidence.LIKELY


def variations(logs: Problem, model: Dynamics) -> Iterator[Experiment]:
    """Yield the logs with other cut-offs and with wrong links, which nobody knows better.

    Args:
        logs: The logs.
        model: The model, at whose friction between two joints samples are left out.
    """
    effects = [t.effect for t in model.terms]
    return (x.without_rest_of(effects) for x in _varied(logs))


def _varied(logs: Problem) -> Iterator[Experiment]:
    x, settings = logs.experiment, logs.settings
    for factor in settings.confidence.cutoffs:
        try:
            yield Experiment.of(x.robot, list(_filtered(logs, factor)), x.rest)
        except LogError:  # the log cannot be filtered there: its rate is too low, or too little is left
            continue
    bodies = x.robot.inertial_parameters
    for seed in range(settings.confidence.wrong_links):
        error = np.random.default_rng(seed).normal(0.0, settings.confidence.link_error, len(bodies))
        robot = x.robot.with_inertial_parameters(bodies * (1 + error[:, None]))
        yield Experiment.of(robot, [s.motion for s in x.segments], x.rest)


def _filtered(logs: Problem, factor: float) -> Iterator[Motion]:
    for log, segment in zip(logs.logs, logs.experiment.segments, strict=True):
        given = replace(logs.settings.searched, cutoff=factor * segment.motion.cutoff)
        yield condition(log, logs.experiment.robot, given)
