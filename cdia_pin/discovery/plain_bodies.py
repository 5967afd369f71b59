"""Rotors and offsets of joints come before a body that predicts hardly better than they do.

A body has ten parameters and acts on several joints. Where a motion tells little of masses, it follows the rotors of
these joints and a little of whatever else is there. It then names a link that is as it was, another one in each log.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property

from cdia_pin.discovery.certain_effects import with_certain
from cdia_pin.discovery.decision import Repeat
from cdia_pin.discovery.one_by_one import heldout_error
from cdia_pin.discovery.trace import without_doubtful
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Effect, RotorInertia, Term, TorqueOffset
from cdia_pin.effects.body import Body
from cdia_pin.effects.refinements import REFINED
from cdia_pin.regression.gauss_newton import DIVERGED, fitted_together
from cdia_pin.selection.every_link import has_every_link
from cdia_pin.selection.problem import WhitenedProblem

PARTS = (RotorInertia, TorqueOffset)  # what a body is to a single joint: inertia, and load


def with_plain_bodies(problem: WhitenedProblem, model: Dynamics, given: Dynamics) -> Dynamics:
    """Return a model without the bodies that rotors and offsets of their joints replace, the least certain first.

    They do if blocks of time that were not fitted are predicted about as well with them as with all bodies, also
    without the effects of either model that may be nothing. Bodies of an arm that they explain wholly stay, for they
    are no coincidence. So do they where every link may be wrong.

    Args:
        problem: The logs and their noise.
        model: The fitted model.
        given: The model before the discovery; its terms stay as they are.
    """
    known = {t.label for t in given.terms}
    if not problem.settings.may_find(kind.name for kind in PARTS):
        return model
    bodies = found_bodies(model, given)
    if not bodies or has_every_link(model) or not problem.problem.lack_of_fit(model).left.any():
        return model
    repeat = Repeat.of(problem.problem, model)
    now = with_bodies = _Judged(problem, model, known)
    worth = problem.settings.confidence.worth_of_bodies
    for body in sorted(bodies, key=repeat.certainty):
        others = now.model.remove(body.label)
        with suppress(*DIVERGED):  # then the body stays
            plain = _Judged(
                problem, with_certain(problem, others, list(_parts(problem, others, body))), known
            )
            if plain.predicts_as_well_as(with_bodies, worth):
                now = plain
    return now.model


def found_bodies(model: Dynamics, given: Dynamics) -> list[Term]:
    """Return the bodies of a model that the model before the discovery has not.

    Args:
        model: The model.
        given: The model before.
    """
    known = {t.label for t in given.terms}
    return [t for t in model.terms if isinstance(t.effect, Body) and t.label not in known]


@dataclass(frozen=True)
class _Judged:
    """A model with its error on blocks of time that were not fitted, which is computed when it is asked for.

    Attributes:
        problem: The logs and their noise.
        model: The model.
        known: Labels of effects that stay in any case.
    """

    problem: WhitenedProblem
    model: Dynamics
    known: Collection[str]

    @cached_property
    def error(self) -> float:
        """Relative error [1]."""
        return heldout_error(self.problem, self.model)

    @cached_property
    def settled_error(self) -> float:
        """The same without the effects that may be nothing [1]."""
        settled = without_doubtful(self.problem, self.model, self.known)
        return heldout_error(self.problem, fitted_together(self.problem.regression, settled))

    def predicts_as_well_as(self, other: _Judged, worth: float) -> bool:
        """Tell whether neither error is more than a factor above that of another model.

        Args:
            other: The other model.
            worth: The factor [1].
        """
        return self.error <= worth * other.error and self.settled_error <= worth * other.settled_error


def _parts(problem: WhitenedProblem, others: Dynamics, body: Term) -> Iterator[Effect]:
    """Yield the candidates that a body is to each of its joints, unless the other terms have such a one."""
    candidates = {f[0].label: f[0] for f in problem.problem.families}
    for j in body.effect.acts_on(others.robot):
        joint = others.robot.joints[j]
        own = [t.effect for t in others.terms if t.effect.scope == (joint,)]
        for kind in PARTS:
            part = candidates.get(kind(joint).label)
            if part and not any(e.name == kind.name or kind in REFINED.get(type(e), ()) for e in own):
                yield part
