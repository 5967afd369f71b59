"""The main job: from a model and logs to the effects that are missing, a verdict and a better model."""

from __future__ import annotations

from collections.abc import Sequence

import cdia_pin
from cdia_pin.discovery.candidates import per_log
from cdia_pin.discovery.conditions import changes_between, effects_that_differ, with_parameters_per_log
from cdia_pin.discovery.every_link import has_every_link, with_every_link
from cdia_pin.discovery.experiment import rms
from cdia_pin.discovery.finding import Finding
from cdia_pin.discovery.fitting import Whitened, refit
from cdia_pin.discovery.problem import Problem
from cdia_pin.discovery.ranking import rank
from cdia_pin.discovery.recognition import recognised
from cdia_pin.discovery.result import Discovery, Ranked, Step
from cdia_pin.discovery.search import Progress, Swaps, search
from cdia_pin.discovery.settings import DiscoverySettings
from cdia_pin.discovery.shapes import refine_shapes
from cdia_pin.discovery.trace import trace
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Effect, Expression, Term, Unknown
from cdia_pin.errors import EffectError
from cdia_pin.logs.log import Log

PASSES = 5  # searches at most, each with the noise that the one before left, until nothing changes


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
        logs: One log or several of the same arm. Effects that differ between their conditions may have parameters of
            their own in each; all others are common.
        holdout: Logs that are only predicted; without, each block of time is predicted from the others.
        settings: What to search for and how.
        progress: Called with a sentence and the share done, from 0 to 1.

    Returns:
        The verdict, the steps, and the improved model.

    Raises:
        LogError: If a log is too short or of other joints.
        EffectError: If the settings name an unknown effect.
    """
    tell = progress or _silent
    tell("conditioning", 0.0)
    settings, given = settings or DiscoverySettings(), _listed(logs)
    # what differs between the logs is told first, beside all that they may have in common
    changes = changes_between(model, given, settings, lambda sentence, share: tell(sentence, 0.05 * share))
    problem = Problem.of(model, given, _listed(holdout), settings).with_parts(effects_that_differ(changes))
    findings = tuple(f for c in changes for f in c.findings)
    return discover_in(problem, model, tell, findings=findings)


def discover_in(
    problem: Problem,
    model: Dynamics,
    progress: Progress | None = None,
    *,
    findings: tuple[Finding, ...] = (),
) -> Discovery:
    """Answer as `discover` does, from logs that are conditioned already.

    Args:
        problem: The logs, with the candidates around the model.
        model: What is known.
        progress: Called with a sentence and the share done.
        findings: What is known of the logs besides, to be handed on.
    """
    tell = progress or _silent
    apart = (*problem.settings.per_log, *problem.differing)
    model = with_parameters_per_log(model, problem.experiment.logs, apart)
    tell("looking at the noise", 0.05)
    problem = problem.without_rest_of(t.effect for t in model.terms)
    whitened = problem.first_noise(model)
    problem, found, whitened = _searched(problem, model, whitened, _part(tell, 0.1, 0.6))
    richer = with_every_link(problem, found, whitened)
    if richer is not None:
        again = _searched(problem, richer, whitened, _part(tell, 0.6, 0.8))
        answer = _answer(model, *again, tell, findings)
        if has_every_link(answer.model):
            return answer
    return _answer(model, problem, found, whitened, tell, findings)


def _answer(
    model: Dynamics,
    problem: Problem,
    found: Dynamics,
    whitened: Whitened,
    tell: Progress,
    findings: tuple[Finding, ...],
) -> Discovery:
    tell("asking what each effect explains", 0.85)
    ranking = rank(problem, model, whitened)
    return _concluded(problem, model, found, whitened, ranking, tell, findings=findings)


def _searched(
    problem: Problem, found: Dynamics, whitened: Whitened, tell: Progress
) -> tuple[Problem, Dynamics, Whitened]:
    """Search from a model, again and again with the noise that the search before left."""
    futile = Swaps()
    for k in range(PASSES):
        before = {t.label for t in found.terms}
        lap = _part(tell, k / PASSES, (k + 1) / PASSES)
        problem = problem.with_drift(found)
        found = search(problem, found, whitened, futile, lap)
        problem = problem.without_rest_of(t.effect for t in found.terms)
        whitened = problem.whitened(problem.structure(found))
        if k > 0 and {t.label for t in found.terms} == before:
            break
    return problem, found, whitened


def _part(tell: Progress, start: float, end: float) -> Progress:
    """Return how to tell of a part of the work."""
    return lambda sentence, share: tell(sentence, start + (end - start) * share)


def add_effect(
    model: Dynamics,
    effect: Effect,
    logs: Log | Sequence[Log],
    *,
    holdout: Log | Sequence[Log] | None = None,
    settings: DiscoverySettings | None = None,
    progress: Progress | None = None,
) -> Discovery:
    """Add one effect to a model and fit all of it to logs, whatever the evidence for it.

    Args:
        model: The model; a term of the same effect and scope is replaced.
        effect: The effect to add; its shape is fitted too.
        logs: One log or several.
        holdout: Logs that are only predicted.
        settings: How logs are conditioned.
        progress: Called with a sentence and the share done.

    Returns:
        A trace of two steps, before and after, and whether structure is left.

    Raises:
        LogError: If a log is too short or of other joints.
        EffectError: If the effect cannot be seen in these logs.
    """
    tell = progress or _silent
    tell("conditioning", 0.0)
    problem = Problem.of(model, _listed(logs), _listed(holdout), settings or DiscoverySettings())
    return add_effect_in(problem, model, effect, tell)


def add_effect_in(
    problem: Problem, model: Dynamics, effect: Effect, progress: Progress | None = None
) -> Discovery:
    """Answer as `add_effect` does, from logs that are conditioned already.

    Args:
        problem: The logs, with the candidates around the model.
        model: The model.
        effect: The effect to add.
        progress: Called with a sentence and the share done.

    Raises:
        EffectError: If the effect cannot be seen in these logs.
    """
    tell = progress or _silent
    tell("looking at the noise", 0.1)
    (effect,) = per_log([effect], problem.experiment, problem.settings.per_log)
    problem = problem.without_rest_of([effect, *(t.effect for t in model.terms)])
    whitened = problem.first_noise(model)
    tell(f"fitting {effect.label}", 0.3)
    base = model.remove(effect.label) if effect.label in {t.label for t in model.terms} else model
    along = problem.experiment.along(problem.experiment.predict(model))
    trials = [effect] if isinstance(effect, Expression) else list(effect.shape_grid(along))
    if not trials:
        raise EffectError(f"{effect.label} cannot be seen in these logs: its joint hardly moves")
    if isinstance(effect, Unknown) or not effect.shape:
        trials = trials[:1]
    fits = [_fitted(problem, base, e, whitened) for e in trials]
    best = min(fits, key=lambda f: f[1])[0]
    best = refine_shapes(problem.experiment, problem.columns, best, whitened, [t.label for t in base.terms])
    whitened = problem.whitened(problem.structure(best))
    return _concluded(problem, base, best, whitened, (), tell, forced=(effect.label,))


def _fitted(problem: Problem, base: Dynamics, effect: Effect, whitened: Whitened) -> tuple[Dynamics, float]:
    trial = base.add(Term(effect, (0.0,) * effect.size))
    trial, evidence = refit(problem.experiment, problem.columns, trial, whitened)
    return trial, evidence.fit(range(len(trial.terms)), bodies=True).chi2


def _concluded(
    problem: Problem,
    base: Dynamics,
    found: Dynamics,
    whitened: Whitened,
    ranking: tuple[Ranked, ...],
    tell: Progress,
    forced: tuple[str, ...] = (),
    findings: tuple[Finding, ...] = (),
) -> Discovery:
    final, steps = trace(problem, base, found, whitened, forced)
    structure = problem.structure(final)
    tell("done", 1.0)
    left = tuple(j for j, s in zip(base.robot.joints, structure.left, strict=True) if s)
    experiment = problem.experiment
    return Discovery(
        model=final,
        verdict=_verdict(left, steps),
        trace=steps,
        noise_floor=structure.floor,
        structure_left=left,
        torque_rms=rms(experiment.measured, experiment.informative),
        ranking=ranking,
        record={
            "version": cdia_pin.__version__,
            "logs": [s.motion.record for s in experiment.segments],
            "holdout": [s.motion.record for s in problem.held_out.segments] if problem.held_out else [],
            "blocks": problem.settings.blocks,
            "effects": list(problem.settings.effects) if problem.settings.effects else "all",
            "extra": [e.to_dict() for e in problem.settings.extra],
            "per_log": [*problem.settings.per_log, *problem.differing],
            "most_effects": problem.settings.most_effects,
        },
        findings=(*findings, *recognised(problem, final, problem.whitened(structure), left)),
    )


def _verdict(left: tuple[str, ...], steps: tuple[Step, ...]) -> str:
    if left:
        return "unexplained"
    return "explained" if len(steps) > 1 else "nothing-missing"


def _listed(logs: Log | Sequence[Log] | None) -> list[Log]:
    return [] if logs is None else [logs] if isinstance(logs, Log) else list(logs)


def _silent(sentence: str, share: float) -> None:
    """Tell nobody."""
