"""Discover which physical effects a model lacks: the main job, from logs to a verdict and a better model."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

import cdia_pin
from cdia_pin.discovery.candidates import Columns, enumerate_candidates, screen
from cdia_pin.discovery.confusion import find_confusions
from cdia_pin.discovery.evidence import Evidence, Fit, needed_gain
from cdia_pin.discovery.experiment import Experiment, Prediction
from cdia_pin.discovery.fitting import Whitened, gather, refit, with_intervals
from cdia_pin.discovery.heldout import held_out_rms, rms
from cdia_pin.discovery.result import Discovery, Step
from cdia_pin.discovery.search import Names, improve, names
from cdia_pin.discovery.settings import DiscoverySettings
from cdia_pin.discovery.shapes import refine_shapes
from cdia_pin.discovery.structure import Structure, look_for_structure
from cdia_pin.discovery.whitening import NoiseModel
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Effect, Term
from cdia_pin.logs.conditioning import condition
from cdia_pin.logs.log import Log

Array = NDArray[np.float64]
Progress = Callable[[str, float], None]
Swaps = set[tuple[str, str]]

PASSES = 5  # searches at most, each with the noise that the one before left, until nothing changes
ROUGHLY = 2  # iterations of a refit while searching
MOST_MOVES = 120
GENERIC_SIZE = 10  # families of larger effects do not take part in the first estimate of the noise


@dataclass(frozen=True)
class _Found:
    """A searched set: the refitted model, its normal equations beside all candidates, and the noise used."""

    model: Dynamics
    evidence: Evidence
    whitened: Whitened


def discover(
    model: Dynamics,
    logs: Log | Sequence[Log],
    *,
    holdout: Log | Sequence[Log] | None = None,
    settings: DiscoverySettings | None = None,
    progress: Progress | None = None,
) -> Discovery:
    """Find the effects that a model lacks in measured logs, add them, and say what is left.

    Args:
        model: What is known: a bare robot, or one with terms, which are fitted again together with what is found.
        logs: One log or several of the same arm in the same condition.
        holdout: Logs that are only predicted; without, each block of time is predicted from the others.
        settings: What to search for and how.
        progress: Called with a sentence and the share done, from 0 to 1.

    Returns:
        The verdict, the steps, and the improved model.

    Raises:
        LogError: If a log is too short or of other joints.
        EffectError: If the settings name an unknown effect.
    """
    settings = settings or DiscoverySettings()
    tell = progress or (lambda sentence, share: None)
    given = [logs] if isinstance(logs, Log) else list(logs)
    others = [] if holdout is None else [holdout] if isinstance(holdout, Log) else list(holdout)
    tell("conditioning", 0.0)
    experiment = Experiment.of(model.robot, [condition(log, model.robot, settings.conditioning) for log in given])
    unseen = [condition(log, model.robot, settings.conditioning) for log in others]
    held_out = Experiment.of(model.robot, unseen) if unseen else None
    columns = Columns(experiment)

    families = enumerate_candidates(experiment, experiment.predict(model), settings)
    noise = _first_noise(experiment, columns, model, families, settings)
    whitened = Whitened.of(experiment, noise, settings.blocks)
    found = _Found(model, gather(experiment, columns, experiment.predict(model), [], whitened), whitened)
    futile: Swaps = set()
    for k in range(PASSES):
        before = set(_labels(found.model))
        lap = lambda s, share, k=k: tell(s, 0.1 + 0.75 * (k + share) / PASSES)  # noqa: E731
        found = _search(experiment, columns, found.model, families, whitened, settings, futile, lap)
        structure = _structure(experiment, columns, found)
        whitened = Whitened.of(experiment, structure.noise, settings.blocks)
        if k > 0 and set(_labels(found.model)) == before:
            break
    tell("checking what else could explain it", 0.85)
    model_found, evidence = refit(experiment, columns, found.model, whitened)
    pruned = _Found(model_found, evidence, whitened)
    structure = _structure(experiment, columns, pruned)
    trace = _trace(experiment, columns, model, pruned, held_out, families)
    tell("done", 1.0)
    left = tuple(j for j, s in zip(model.robot.joints, structure.left, strict=True) if s)
    verdict = "unexplained" if left else "explained" if len(trace) > 1 else "nothing-missing"
    final = Dynamics(model.robot, tuple(s.term for s in trace[1:] if s.term))
    base = tuple(t for t in pruned.model.terms if t.label not in {u.label for u in final.terms})
    return Discovery(
        model=Dynamics(model.robot, base + final.terms),
        verdict=verdict,
        trace=trace,
        noise_floor=structure.floor,
        structure_left=left,
        torque_rms=rms(experiment.measured, experiment.informative),
        record={
            "version": cdia_pin.__version__,
            "logs": [s.motion.record for s in experiment.segments],
            "holdout": [m.record for m in unseen],
            "blocks": settings.blocks,
            "effects": list(settings.effects) if settings.effects else "all",
        },
    )


def _search(
    experiment: Experiment,
    columns: Columns,
    model: Dynamics,
    families: list[list[Effect]],
    whitened: Whitened,
    settings: DiscoverySettings,
    futile: Swaps,
    tell: Progress,
) -> _Found:
    """Add, drop and exchange effects, refitting and differentiating anew after each move.

    A move is kept only if the cost falls at its own optimum, not just in the normal equations that proposed it, so
    that the search cannot turn in circles. A swap that failed is not tried again, in whatever company: a gain on the
    model's torque seems able to replace the friction in that torque, until the friction is gone.
    """
    model, _ = refit(experiment, columns, model, whitened)
    evidence = _candidates_beside(experiment, columns, experiment.predict(model), families, whitened)
    now = evidence.fit(_indices(evidence, model), bodies=True)
    failed: set[Names] = set()
    for moves in range(MOST_MOVES):
        present = names(evidence, now.chosen)

        def allowed(chosen: tuple[int, ...], evidence: Evidence = evidence, present: Names = present) -> bool:
            tried = names(evidence, chosen)
            return tried not in failed and not _swaps(present, tried) & futile

        better = improve(evidence, now.chosen, allowed, most=settings.most_effects)
        if better is None:
            break
        trial = _model_of(model, evidence, better.chosen, better.theta)
        tell(_what_changed(model, trial), 1.0 - 0.9**moves)
        failed.add(names(evidence, better.chosen))
        trial, _ = refit(experiment, columns, trial, whitened, ROUGHLY)
        trial = refine_shapes(experiment, columns, trial, whitened, known=_labels(model))
        beside = _candidates_beside(experiment, columns, experiment.predict(trial), families, whitened)
        fit = beside.fit(_indices(beside, trial), bodies=True)
        if not fit.physical or fit.cost > now.cost + _sacrifice(evidence, now, better):
            futile |= _swaps(present, frozenset(_labels(trial)))
            continue
        model, evidence, now = trial, beside, fit
    return _Found(model, evidence, whitened)


def _sacrifice(evidence: Evidence, now: Fit, after: Fit) -> float:
    """Return the cost that a move may add: none, or what an effect that is dropped would have had to earn."""
    dropped = set(now.chosen) - set(after.chosen)
    if not now.physical:
        return float("inf")
    return max((evidence.least_gain[c] for c in dropped), default=0.0) if set(after.chosen) < set(now.chosen) else -1e-6


def _swaps(before: Names, after: Names) -> Swaps:
    """Return which effect came for which."""
    return {(new, old) for new in after - before for old in before - after}


def _indices(evidence: Evidence, model: Dynamics) -> list[int]:
    present = {t.effect for t in model.terms}
    return [i for i, e in enumerate(evidence.effects) if e in present]


def _labels(model: Dynamics) -> list[str]:
    return [t.label for t in model.terms]


def _what_changed(before: Dynamics, after: Dynamics) -> str:
    had, has = set(_labels(before)), set(_labels(after))
    return ", ".join([*(f"+ {x}" for x in sorted(has - had)), *(f"− {x}" for x in sorted(had - has))])


def _candidates_beside(
    experiment: Experiment,
    columns: Columns,
    prediction: Prediction,
    families: list[list[Effect]],
    whitened: Whitened,
) -> Evidence:
    leftover = np.column_stack([whitened.joint(j, prediction.residual[:, j]) for j in range(experiment.robot.n)])
    screened = screen(families, columns, prediction, whitened.noise, leftover)
    present = [t.effect for t in prediction.model.terms]
    evidence = gather(experiment, columns, prediction, list(dict.fromkeys([*present, *screened])), whitened)
    looked_for = {e.label: 1 for e in present} | {f[0].label: len(f) for f in families}
    use = experiment.informative
    needed = needed_gain(
        np.sum(leftover**2, axis=0), rms(prediction.residual, use), rms(experiment.measured, use)
    )
    return replace(evidence, searched=looked_for, needed=needed)


def _model_of(model: Dynamics, evidence: Evidence, chosen: Sequence[int], theta: Array) -> Dynamics:
    profiles = {t.effect: t.profile for t in model.terms}
    terms, at = [], 0
    for c in chosen:
        effect = evidence.effects[c]
        values = tuple(float(v) for v in theta[at : at + effect.size])
        term = Term(effect, values)
        terms.append(replace(term, profile=profiles[effect]) if effect in profiles else term)
        at += effect.size
    return Dynamics(model.robot, tuple(terms))


def _first_noise(
    experiment: Experiment,
    columns: Columns,
    model: Dynamics,
    families: list[list[Effect]],
    settings: DiscoverySettings,
) -> list[NoiseModel]:
    """Estimate the noise before anything is known: what all simple effects together leave."""
    prediction = experiment.predict(model)
    generic = [f[0] for f in families if f[0].size < GENERIC_SIZE and len(f) < 20]
    effects = list(dict.fromkeys([*(t.effect for t in model.terms), *generic]))
    edges = np.linspace(0, len(experiment.measured), settings.blocks + 1).astype(int)
    return list(look_for_structure(experiment, prediction, _own(experiment, columns, prediction, effects), edges).innermost)


def _structure(experiment: Experiment, columns: Columns, found: _Found) -> Structure:
    prediction = experiment.predict(found.model)
    own = _own(experiment, columns, prediction, [t.effect for t in found.model.terms])
    return look_for_structure(experiment, prediction, own, found.whitened.edges)


def _own(experiment: Experiment, columns: Columns, prediction: Prediction, effects: Sequence[Effect]) -> list[Array]:
    """Return the columns of effects joint by joint, as if each joint had its own parameters."""
    present = {t.effect: np.array(t.theta) for t in prediction.model.terms}
    out: list[list[Array]] = [[] for _ in range(experiment.robot.n)]
    for effect in effects:
        x = columns.of(effect, prediction, present.get(effect))
        for i, j in enumerate(effect.acts_on(experiment.robot)):
            out[j].append(x[:, i, :])
    empty = np.zeros((len(experiment.measured), 0))
    return [np.column_stack(parts) if parts else empty for parts in out]


def _trace(
    experiment: Experiment,
    columns: Columns,
    base: Dynamics,
    found: _Found,
    held_out: Experiment | None,
    families: list[list[Effect]],
) -> tuple[Step, ...]:
    """Add the found effects again one by one, the most telling first, to see the error fall."""
    whitened = found.whitened
    final, evidence = refit(experiment, columns, found.model, whitened)
    final = with_intervals(final, evidence)
    known = {t.label for t in base.terms}
    pending = [t for t in final.terms if t.label not in known]
    model = Dynamics(base.robot, tuple(t for t in final.terms if t.label in known))
    beside = _candidates_beside(experiment, columns, experiment.predict(final), families, whitened)
    index = {e: i for i, e in enumerate(beside.effects)}
    chosen = [index[t.effect] for t in model.terms]
    use = experiment.informative
    steps = [_step(None, base, experiment, held_out, columns, whitened, (), use)]
    while pending:
        gains = beside.gains(chosen)
        best = max(pending, key=lambda t: gains[index[t.effect]])
        pending.remove(best)
        chosen.append(index[best.effect])
        model, _ = refit(experiment, columns, model.add(best), whitened, ROUGHLY + 1)
        confusions = find_confusions(beside, [index[t.effect] for t in final.terms], index[best.effect])
        steps.append(_step(best, model, experiment, held_out, columns, whitened, confusions, use))
    return tuple(steps)


def _step(
    term: Term | None,
    model: Dynamics,
    experiment: Experiment,
    held_out: Experiment | None,
    columns: Columns,
    whitened: Whitened,
    confusions: tuple,  # type: ignore[type-arg]
    use: NDArray[np.bool_],
) -> Step:
    prediction = experiment.predict(model)
    fitted = rms(prediction.residual, use)
    if held_out is not None:
        unseen = rms(held_out.predict(model).residual, held_out.informative)
    elif term is None:
        unseen = fitted  # nothing was fitted
    else:
        unseen = held_out_rms(experiment, columns, prediction, whitened)
    return Step(term, fitted, unseen, confusions)
