"""Effects that reduce to simpler ones: a friction that no longer falls with the speed is a Coulomb friction."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Term


def simplified(model: Dynamics) -> Dynamics:
    """Return a model with simpler effects in the place of those that its parameters reduce to them, not yet fitted.

    Args:
        model: A fitted model; the same is returned if all its effects are distinct.
    """
    terms = [_simplified(t) for t in model.terms]
    if all(new is old for new, old in zip(terms, model.terms, strict=True)):
        return model
    return replace(model, terms=tuple({t.effect: t for t in terms}.values()))


def _simplified(term: Term) -> Term:
    simpler = term.effect.simpler
    if simpler is None or term.effect.is_distinct(np.array(term.theta)):
        return term
    return Term(simpler, term.theta[: simpler.size], term.profile)
