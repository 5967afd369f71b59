"""What logs show beyond a model: new effects, and changes of the effects that the model has.

The model remembers the logs that it was learned from. So the question is the same as between two logs: what differs,
after all that both have in common. Terms that did not change keep their values.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from cdia_pin.changes.change_search import ChangeSearch
from cdia_pin.changes.detection import searched, sized_changes
from cdia_pin.changes.interpretation import findings_of
from cdia_pin.changes.run_to_run import RunToRun, as_phenomena
from cdia_pin.discovery.conclusion import conclusion
from cdia_pin.discovery.discovery_result import Discovery, Step
from cdia_pin.discovery.trace import errors_of
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import PerLog, Term
from cdia_pin.logs.motion import Motion, names_of
from cdia_pin.progress import Progress, part
from cdia_pin.regression.experiment import Experiment, rms
from cdia_pin.selection.problem import Problem

Array = NDArray[np.float64]


def discover_beyond(model: Dynamics, logs: Problem, report: Progress) -> Discovery:
    """Find what logs show beyond a model that remembers the logs it was learned from.

    Args:
        model: The model.
        logs: Conditioned logs, without candidates.
        report: Called with a sentence and the share done, from 0 to 1.

    Returns:
        The verdict; a step for each new effect and for each change of a term, whose parameters are differences; and the
        model with all of them. It remembers the new logs.
    """
    after = [s.motion for s in logs.experiment.segments]
    before, known = _apart(model, names_of(after))
    # what the model lacks cannot be taken away from it
    beyond = replace(logs.settings, changes=replace(logs.settings.changes, gone=False))
    found = searched(known, before, after, beyond, part(report, 0.0, 0.8))
    search, chosen = found.search, found.chosen
    run_to_run = RunToRun.of(search, chosen)
    changes, usual = sized_changes(found, run_to_run)
    at = {search.evidence.effects[c].effect: c for c in chosen}
    labels = {t.label for t in model.terms}
    later, steps, so_far = model, [Step(None, *errors_of(logs, model, None))], []
    for change in changes:
        later = updated(later, change.term)
        so_far.append(at[change.term.effect])
        errors = errors_of(logs, later, partial(_left_by_blocks, logs, model, search, tuple(so_far)))
        of_model = change.term.label in labels
        steps.append(Step(change.term, *errors, change.confusions, of_model, change.confidence))
    causes = findings_of(changes, run_to_run)
    findings = (*causes, *as_phenomena(usual, causes))
    return conclusion(logs, later, tuple(steps), part(report, 0.8, 1.0), findings=findings)


def _left_by_blocks(logs: Problem, model: Dynamics, search: ChangeSearch, chosen: Sequence[int]) -> Array:
    """Return the RMS residual of a model with some changes, each block of time left out of their fit, shape (n,)."""
    x = logs.experiment
    return rms(x.predict(model).residual - search.unseen_torque(chosen), x.informative)


def is_known(experiment: Experiment, model: Dynamics) -> bool:
    """Tell whether a model was learned from the same logs, so that there is nothing to compare them with.

    Args:
        experiment: The logs.
        model: The model.
    """
    return all(any(_same(s.motion, m) for m in model.learned_from) for s in experiment.segments)


def _same(one: Motion, other: Motion) -> bool:
    """Tell whether two motions are one log, filtered alike; a file keeps seven digits of it."""
    return one.q.shape == other.q.shape and np.allclose(one.q, other.q, rtol=1e-5, atol=1e-5)


def updated(model: Dynamics, difference: Term) -> Dynamics:
    """Return a model with a new term, or with a term whose parameters changed.

    Args:
        model: The model.
        difference: A term; if the model has it, its parameters are added, up to what is possible. The wider interval of
            both holds the sum: new logs tell a parameter better than how it differs from that of the old ones.
    """
    known = {t.label: t for t in model.terms}
    if difference.label not in known:
        return model.add(difference)
    old = known[difference.label]
    possible = old.effect.nearest_physical(np.add(old.theta, difference.theta), model.robot)
    moved = replace(old, theta=tuple(map(float, possible)))
    new = moved.with_intervals(np.maximum(old.half_widths, difference.half_widths))
    return replace(model, terms=tuple(new if t is old else t for t in model.terms))


def _apart(model: Dynamics, taken: Sequence[str]) -> tuple[list[Motion], Dynamics]:
    """Return the motions that a model remembers, under other names where new logs have the same, and the model.

    Args:
        model: The model.
        taken: Names of the new logs.

    Returns:
        The motions, and the model with parameters per log that know them.
    """
    names = names_of(model.learned_from)
    aliases = {name: f"{name} of the model" for name in names if name in taken}
    motions = [
        replace(m, record={**m.record, "condition": aliases[name]}) if name in aliases else m
        for m, name in zip(model.learned_from, names, strict=True)
    ]
    return motions, replace(model, terms=tuple(_with_aliases(t, aliases) for t in model.terms))


def _with_aliases(term: Term, aliases: Mapping[str, str]) -> Term:
    """Return a term that has the same parameters under another name of a log."""
    effect = term.effect
    if not isinstance(effect, PerLog) or aliases.keys().isdisjoint(effect.logs):
        return term
    again = [log for log in effect.logs if log in aliases]
    theta = [*term.theta, *(x for log in again for x in effect.of_part(term.theta, log))]
    return Term(replace(effect, logs=(*effect.logs, *(aliases[log] for log in again))), tuple(theta))
