"""The conclusion: trace, verdict and record of a model that was found."""

from __future__ import annotations

from cdia_pin.changes.finding import Finding
from cdia_pin.discovery.discovery_result import Discovery, Ranked, Step
from cdia_pin.discovery.recognition import recognised
from cdia_pin.discovery.trace import trace
from cdia_pin.dynamics import Dynamics
from cdia_pin.progress import Progress
from cdia_pin.regression.experiment import rms
from cdia_pin.regression.fitting import Whitened
from cdia_pin.selection.problem import Problem
from cdia_pin.version import __version__


def concluded(
    problem: Problem,
    base: Dynamics,
    found: Dynamics,
    whitened: Whitened,
    ranking: tuple[Ranked, ...],
    tell: Progress,
    forced: tuple[str, ...] = (),
    findings: tuple[Finding, ...] = (),
) -> Discovery:
    """Return the result of a discovery.

    Args:
        problem: Logs and candidates.
        base: The model that the discovery started from.
        found: The model that it ended with.
        whitened: Noise and blocks.
        ranking: What each candidate would explain by itself.
        tell: Called with a sentence and the share done.
        forced: Labels of effects that stay in any case.
        findings: What is known of the logs besides.
    """
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
            "version": __version__,
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
