"""Refined effects give way to the plain ones that they refine, unless they predict their joint clearly better.

Asymmetry, a Stribeck curve and bristles refine the friction that every joint has, a spring refines an offset, and a
drift whatever drifts. Any of them follows a little of what a measured joint does besides, another one in each log. The
plain name holds from log to log.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import chain

from cdia_pin.discovery.certain_effects import with_certain
from cdia_pin.discovery.decision import Repeat
from cdia_pin.discovery.differing_parts import differs, tells_apart
from cdia_pin.discovery.plain_friction import held_out_growth
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Term
from cdia_pin.effects.refinements import plain_forms
from cdia_pin.selection.problem import WhitenedProblem


def with_plain_forms(problem: WhitenedProblem, model: Dynamics, given: Dynamics) -> Dynamics:
    """Return a model of plain effects where structure is left in any case, and they predict the joint about as well.

    Args:
        problem: The logs and their noise.
        model: The fitted model.
        given: The model before the discovery; its terms stay as they are.
    """
    known = {t.label for t in given.terms}
    refined = [t for t in model.terms if t.label not in known and plain_forms(t.effect)]
    plain_kinds = {plain.name for t in refined for plain in plain_forms(t.effect)}
    if not refined or not problem.settings.may_find(plain_kinds):
        return model
    whole = Repeat.of(problem.problem, model)
    # Refinements of an arm that they explain wholly are no coincidence. Where structure is left on one joint, the same
    # hidden cause may act on the others, and a refinement can follow it there until nothing is left.
    beside_structure = bool(problem.problem.lack_of_fit(model).left.any())
    alike = [t for t in refined if tells_apart(t.effect) and not differs(whole, t, beside_structure)]
    doubtful = refined if beside_structure else alike
    if not doubtful:
        return model
    plain = _plain(problem, model, doubtful)
    growth = held_out_growth(problem, model, plain)
    given_up = [t for t in doubtful if not _is_needed(whole, t, growth[_joint(model, t)], t in alike)]
    if given_up == doubtful:
        return plain
    return _plain(problem, model, given_up) if given_up else model


def _joint(model: Dynamics, term: Term) -> int:
    return model.robot.joint_index(term.effect.scope[0])


def _is_needed(whole: Repeat, term: Term, growth: float, is_alike: bool) -> bool:
    """Tell whether a refined effect stays, because its joint's error would grow without the refinement."""
    confidence = whole.settings.confidence
    if growth <= confidence.worth_of_refinement:
        return False
    if tells_apart(term.effect):
        return growth > confidence.clear_difference or not is_alike
    return growth > confidence.clear_refinement or whole.crowded.is_visible(term)


def _plain(problem: WhitenedProblem, model: Dynamics, refined: Sequence[Term]) -> Dynamics:
    """Return a fitted model with the plain forms of some terms: the certain ones, or the first where none is."""
    kept = replace(model, terms=tuple(t for t in model.terms if t not in refined))
    present = {t.label for t in kept.terms}
    forms = [plain_forms(t.effect) for t in refined]
    added = [e for e in dict.fromkeys(chain(*forms)) if e.label not in present]
    return with_certain(problem, kept, added, forms)
