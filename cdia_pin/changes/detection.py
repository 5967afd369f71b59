"""What changed on an arm between two logs or two groups of logs. Their motions may differ."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from cdia_pin.changes.both_sides import search_beside_both
from cdia_pin.changes.changes_result import Bound, Change, Changes
from cdia_pin.changes.confidence import Confidence
from cdia_pin.changes.differing import Differing
from cdia_pin.changes.found_changes import FoundChanges
from cdia_pin.changes.interpretation import findings_of
from cdia_pin.changes.late_torque import put_right
from cdia_pin.changes.linearisation import sized_about_themselves, without_made_up
from cdia_pin.changes.run_to_run import RunToRun, UsualFriction, is_friction_of_joint
from cdia_pin.changes.sizes import covering, friction_before, sized
from cdia_pin.changes.uncertain import too_uncertain
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Effect, Term
from cdia_pin.effects.body import Body
from cdia_pin.errors import LogError
from cdia_pin.identifiability.confusion import Confusion
from cdia_pin.identifiability.distinguishing_motions import motion_between
from cdia_pin.identifiability.rival_names import other_names
from cdia_pin.logs.conditioning import Motion, condition
from cdia_pin.logs.log import Log
from cdia_pin.progress import Progress, silent
from cdia_pin.regression.effort_scale import doubted_scale, scale_error
from cdia_pin.regression.experiment import Experiment, rms
from cdia_pin.robot.model import RobotModel
from cdia_pin.selection.discovery_settings import DiscoverySettings
from cdia_pin.threads import on_one_thread
from cdia_pin.version import __version__

# Width of the interval of a body's mass beside another body, over that without it, above which the two are one.
FAR_MORE_CERTAIN = 2.0  # [1]; on a measured arm without much motion 1.3 and 4 name the same

UNCERTAIN = 1e-9  # certainty of an estimate of zero [1], so that none is not divided by zero


@on_one_thread
def what_changed(
    model: Dynamics,
    before: Log | Motion | Sequence[Log | Motion],
    after: Log | Motion | Sequence[Log | Motion],
    *,
    settings: DiscoverySettings | None = None,
    progress: Progress | None = None,
) -> Changes:
    """Find the effects by which an arm differs between logs.

    Args:
        model: The model of the arm as it is known. It may be wrong if it is wrong in the same way before and after.
        before: One log or several; one that is conditioned already is taken as it is.
        after: The same; their motions may be different.
        settings: What may have changed, and how logs are conditioned.
        progress: Called with a sentence and the share done, from 0 to 1.

    Returns:
        The changes, and the largest changes that would not be found.

    Raises:
        LogError: If a log is too short, of other joints, or on both sides.
        EffectError: If the settings name an unknown effect.
    """
    settings = settings or DiscoverySettings()
    first, last = ([side] if isinstance(side, Log | Motion) else list(side) for side in (before, after))
    if not first or not last:
        raise LogError("what_changed needs at least one log before and one after")
    tell = progress or silent
    tell("conditioning", 0.0)
    earlier, later = (
        [log if isinstance(log, Motion) else condition(log, model.robot, settings.searched) for log in side]
        for side in (first, last)
    )
    found = searched(model, earlier, later, settings, tell)
    differing = found.search.differing
    tell("computing intervals", 0.9)
    run_to_run = RunToRun.of(found.search, found.chosen)
    changes, usual = sized_changes(found, run_to_run)
    errors = [
        np.where(counted.any(axis=0), rms(differing.given.residual, counted), np.nan)
        for counted in (differing.counted_before, differing.counted)
    ]
    tell("done", 1.0)
    return Changes(
        model=model,
        before=differing.names[0],
        after=differing.names[1],
        changes=changes,
        usual=usual,
        uncertain=too_uncertain(found, run_to_run, {c.term.label for c in changes} | _labels(usual)),
        torque_rms=differing.torque,
        not_compared={model.robot.joints[j]: why for j, why in differing.overlap.reasons.items()},
        bounds=_bounds(found, run_to_run),
        findings=findings_of(changes, run_to_run),
        rms_before=errors[0],
        rms_after=errors[1],
        spread=max(found.search.spreads),
        same_motion=differing.has_same_motion,
        record={
            "version": __version__,
            "before": [m.record for m in earlier],
            "after": [m.record for m in later],
            "blocks": settings.changes.blocks,
            **settings.record(),
        },
    )


def searched(
    model: Dynamics,
    before: Sequence[Motion],
    after: Sequence[Motion],
    settings: DiscoverySettings,
    tell: Progress = silent,
) -> FoundChanges:
    """Search for changes, and return what was found.

    Args:
        model: The model of the arm as it is known.
        before: Conditioned logs.
        after: Conditioned logs.
        settings: What may have changed.
        tell: Called with a sentence and the share done, from 0 to 1.

    Raises:
        LogError: If a log is of other joints, or on both sides.
    """
    rest = replace(settings.rest, resting_share=1.0 - settings.changes.least_moving)
    experiment = Experiment.of(model.robot, [*before, *after], rest)
    tell("fitting what the logs have in common", 0.1)
    differing = Differing.of(experiment, model, len(before), settings)
    earlier, later = differing.names
    if set(earlier) & set(later):
        raise LogError(
            f"logs before and after must be of different conditions, both have {', '.join(earlier)}"
        )
    tell("looking for changes", 0.3)
    found = _searched(differing, settings)
    late = put_right(differing)
    if late is None:
        return found
    tell("looking for changes beside the late torque", 0.6)
    other = _searched(late, settings)
    return other if late.put_right.keys() & set(other.effects) and other.leaves_less(found) else found


def _searched(differing: Differing, settings: DiscoverySettings) -> FoundChanges:
    search, chosen = search_beside_both(differing, settings)
    found = without_made_up(sized_about_themselves(search, chosen))
    return replace(found, search=search.beside(found.chosen))


def sized_changes(
    found: FoundChanges, run_to_run: RunToRun
) -> tuple[tuple[Change, ...], tuple[UsualFriction, ...]]:
    """Return the changes with their sizes, in the order of what would be lost without them, and usual differences.

    Sizes are fitted beside the usual differences of friction, which are no changes of the arm. The total interval of a
    change of friction allows for the usual difference. What is named is certain beside all others, and is there without
    those that cannot be named too: these are no part of its size, for they may stand for the same torque with the other
    sign. A change whose size beside them is another one is only likely.

    Args:
        found: The changes.
        run_to_run: Friction of both sides beside what was found.
    """
    search, chosen = found.search, found.chosen
    evidence, effects = search.evidence, search.evidence.effects
    earlier = friction_before(search.differing, [effects[c] for c in chosen])
    with_all = float(np.sum(evidence.unexplained(chosen)))
    terms, usual = _sizes(found, run_to_run)
    named = [c for c in _there(terms, usual) if search.holds([o for o in chosen if o != c], c)]
    if 0 < len(named) < len(chosen):
        # what cannot be named may have stood for the same torque with the other sign: then neither of the two is there
        named = _there(*_sizes(sized_about_themselves(search, tuple(named)), run_to_run))
    sizes = _sizes_of(named, found, terms, usual, run_to_run)
    model = search.differing.given.model
    doubt = doubted_scale(model.terms, model.robot)
    corrections, robot = _corrections(found), search.differing.experiment.robot
    out: list[Change] = []
    instead: dict[int, int] = {}  # what may be there in the place of a change
    for one in (c for c in named if not sizes[c].may_be_nothing):
        term = sizes[one]
        torque = search.torque(one, np.array(term.theta))
        rest = [c for c in chosen if c != one]
        without = float(np.sum(evidence.unexplained(rest)))
        rivals = search.rivals(chosen, one)
        confusions = tuple(_confusions(term, [effects[c].effect for c in rivals], robot))
        confidence = search.confidence(rest, one)
        before = earlier.get(effects[one])
        is_doubtful = _falls_below_nothing(term, before) or not _agree(term, terms[one])
        is_doubtful |= one in corrections
        names = other_names(term, confusions, robot)
        if names and confidence is Confidence.ESTABLISHED and not is_doubtful:
            instead[one] = next(c for c in rivals if effects[c].label == names[0].effects[0].label)
        if is_doubtful or names:
            confidence = Confidence.LIKELY
        lost = (without - with_all) / 2
        scale = scale_error(term.effect, torque, doubt)  # a gain of the model may be something else
        term = term.less_certain(scale * np.abs(term.theta)) if scale else term
        out.append(Change(term, before, torque, lost, confusions, confidence))
    parts = _parts_of_others(found, out)
    if parts:
        whole = tuple(c for c in chosen if effects[c].effect.label not in parts)
        return sized_changes(sized_about_themselves(search, whole), run_to_run)
    settled = _with_or_without_likely(found, out, instead)
    return tuple(sorted(settled, key=lambda c: -c.evidence)), tuple(usual)


def _sizes(found: FoundChanges, run_to_run: RunToRun) -> tuple[dict[int, Term], list[UsualFriction]]:
    """Return the size of each change by its index, with intervals that allow for usual differences, and these."""
    search, chosen = found.search, found.chosen
    terms = sized(found)
    allowed = {
        c: run_to_run.allowed_for(t, search.torque(c, np.array(t.theta)))
        for c, t in zip(chosen, terms, strict=True)
    }
    return allowed, run_to_run.usual(search, chosen, terms)


def _sizes_of(
    named: Sequence[int],
    found: FoundChanges,
    terms: Mapping[int, Term],
    usual: Sequence[UsualFriction],
    run_to_run: RunToRun,
) -> Mapping[int, Term]:
    """Return the sizes of what is named, beside usual differences of friction and nothing else that was found."""
    slight = _labels(usual)
    kept = tuple(c for c in found.chosen if c in named or terms[c].label in slight)
    if not named or len(kept) == len(found.chosen):
        return terms
    return _sizes(sized_about_themselves(found.search, kept), run_to_run)[0]


def _labels(usual: Sequence[UsualFriction]) -> set[str]:
    """Return the labels of changes that differ by no more than those of an unchanged arm."""
    return {label for u in usual for label in u.effects}


def _agree(one: Term, other: Term) -> bool:
    """Tell whether two estimates of a change have intervals in common."""
    apart = np.abs(np.subtract(one.theta, other.theta))
    return bool((apart <= one.half_widths + other.half_widths).all())


def _there(terms: Mapping[int, Term], usual: Sequence[UsualFriction]) -> list[int]:
    """Return the changes that are neither usual nor, within their intervals, nothing."""
    slight = _labels(usual)
    return [c for c, t in terms.items() if not (t.may_be_nothing or t.label in slight)]


def _falls_below_nothing(term: Term, before: Sequence[float] | None) -> bool:
    """Tell whether friction falls by more than there was, within its interval: something else changed."""
    if before is None or len(before) != 1 or term.ci95 is None:
        return False
    ((_, most),) = term.ci95
    return before[0] + most < 0.0


def _parts_of_others(found: FoundChanges, changes: Sequence[Change]) -> set[str]:
    """Return the labels of bodies that are only likely, and without which an established body is far more certain.

    Bodies of links that follow each other are the same to a motion that hardly turns the joints between them. What is
    likely then is a part of what is established.
    """
    bodies = [c for c in changes if isinstance(c.term.effect, Body)]
    sure = [c.term for c in bodies if c.confidence is Confidence.ESTABLISHED]
    effects, out = found.search.evidence.effects, set()
    for likely in (c.term.label for c in bodies if c.confidence is Confidence.LIKELY and sure):
        rest = tuple(c for c in found.chosen if effects[c].effect.label != likely)
        alone = {t.label: t.half_widths[0] for t in sized(sized_about_themselves(found.search, rest))}
        if any(t.half_widths[0] > FAR_MORE_CERTAIN * alone[t.label] for t in sure):
            out.add(likely)
    return out


def _corrections(found: FoundChanges) -> set[int]:
    """Return the index of the body that may only correct another one, if there is such a one.

    It explains next to nothing of what the other one explains without it. However small, a part of a payload on the
    link before it is certain, if it is alike in all blocks of time.
    """
    search = found.search
    own = [c for c in found.chosen if isinstance(search.evidence.effects[c].effect, Body)]
    if len(own) < 2:
        return set()

    def left_without(*some: int) -> float:
        return float(np.sum(search.evidence.unexplained([c for c in found.chosen if c not in some])))

    least = min(own, key=left_without)
    without = left_without(least)
    explained = max(left_without(least, other) - without for other in own if other != least)
    is_slight = without - left_without() < search.settings.alike * explained
    return {least} if is_slight else set()


def _with_or_without_likely(
    found: FoundChanges, changes: Sequence[Change], instead: Mapping[int, int]
) -> list[Change]:
    """Return changes whose sizes, where they are established, hold also if what is only likely is not there.

    A part of a payload may else be found on the link before it as well, and the payload is too light by that. A change
    that may be nothing then is likely itself. What refines a plain effect is there in that form, and what is certain
    under another name: that much is certain.

    Args:
        found: The changes.
        changes: The same with their sizes.
        instead: What may be there in the place of a change, by their indices.
    """
    labels = {c.term.label for c in changes if c.confidence is Confidence.ESTABLISHED}
    if not 0 < len(labels) < len(changes):
        return list(changes)
    search = found.search
    effects = search.evidence.effects
    sure = {c for c in found.chosen if effects[c].effect.label in labels}
    forms = (instead.get(c, search.plain_form(c)) for c in found.chosen if c not in sure)
    rest = sure | {form for form in forms if form is not None and effects[form].effect.label not in labels}
    alone = {t.label: t for t in sized(sized_about_themselves(search, tuple(sorted(rest))))}
    covered = [
        replace(c, term=covering(c.term, alone[c.term.label])) if c.term.label in labels else c
        for c in changes
    ]
    return [replace(c, confidence=Confidence.LIKELY) if c.term.may_be_nothing else c for c in covered]


def _confusions(term: Term, rivals: Sequence[Effect], robot: RobotModel) -> Iterator[Confusion]:
    """Yield each rival of a change once, in its best shape, the best first."""
    best: dict[str, Effect] = {}
    for rival in rivals:
        best.setdefault(rival.label, rival)
    for label, rival in best.items():
        if label != term.label:
            yield Confusion((rival,), motion_between(term.effect, rival, robot))


def _bounds(found: FoundChanges, run_to_run: RunToRun) -> dict[str, Bound]:
    """Return for each joint that is compared the largest change of one parameter that would not be named.

    It is too small to be visible, or too uncertain to be named where the logs already differ by a little the other way.
    """
    search, chosen = found.search, found.chosen
    differing = search.differing
    robot = differing.experiment.robot
    fits = search.evidence.fits(chosen)
    certainty = np.maximum(search.certainty(fits), UNCERTAIN)
    out: dict[str, Bound] = {}
    for c, visible in search.visible_sizes(chosen).items():
        difference = search.evidence.effects[c]
        joints = difference.acts_on(robot)
        there = float(fits.theta[c][0])
        unsure = abs(there) / certainty[c]
        unseen = max(abs(there) + search.settings.least_certainty * unsure, visible)
        limit = Term(difference.effect, (float(np.copysign(unseen, -there)),))
        torque = float(search.torque(c, np.array(limit.theta))[joints[0]])
        if is_friction_of_joint(difference.effect) and 0.0 < torque < run_to_run.size(joints[0]):
            limit = limit.with_theta(np.array(limit.theta) * run_to_run.size(joints[0]) / torque)
            torque = run_to_run.size(joints[0])
        bound = Bound(limit, torque)
        joint = robot.joints[joints[0]]
        if bound.torque <= differing.torque[joints[0]] and (
            joint not in out or bound.torque > out[joint].torque
        ):
            out[joint] = bound
    return {j: out[j] for j in robot.joints if j in out}
