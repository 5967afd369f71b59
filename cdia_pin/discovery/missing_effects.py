"""The missing effects: from a model and logs to a verdict and a better model."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress

from cdia_pin.changes.conditions import changes_between, effects_that_differ, with_parameters_per_log
from cdia_pin.changes.phenomenon import Phenomenon
from cdia_pin.discovery.beyond_model import discover_beyond, is_known
from cdia_pin.discovery.conclusion import concluded
from cdia_pin.discovery.discovery_result import Discovery
from cdia_pin.discovery.doubted_effects import doubted, harmful, plain_model
from cdia_pin.discovery.drive_gains import costs_less, with_drive_gains
from cdia_pin.discovery.plain_bodies import with_plain_bodies
from cdia_pin.discovery.plain_forms import with_plain_forms
from cdia_pin.discovery.plain_friction import with_plain_friction
from cdia_pin.discovery.ranking import rank
from cdia_pin.discovery.unusual_effects import everyday, has_unusual_rival, unusual_terms
from cdia_pin.discovery.weighed_payload import with_weighed_payload
from cdia_pin.dynamics import Dynamics
from cdia_pin.logs.log import Log, listed
from cdia_pin.progress import Progress, part, silent
from cdia_pin.regression.gauss_newton import DIVERGED
from cdia_pin.selection.discovery_settings import DiscoverySettings
from cdia_pin.selection.every_link import has_every_link, with_every_link
from cdia_pin.selection.problem import Problem, WhitenedProblem
from cdia_pin.selection.search import Swaps, search
from cdia_pin.threads import on_one_thread

PASSES = (
    5  # searches at most [1], each with the noise that the one before left; it ends sooner if nothing changes
)
# The steps to plainer effects. The plain form of friction under load may stand for Coulomb friction too.
PLAINER = (
    with_plain_friction,
    with_plain_forms,
    with_plain_friction,
    with_plain_bodies,
    with_weighed_payload,
)


@on_one_thread
def discover(
    model: Dynamics,
    logs: Log | Sequence[Log],
    *,
    holdout: Log | Sequence[Log] | None = None,
    settings: DiscoverySettings | None = None,
    progress: Progress | None = None,
    start: Dynamics | None = None,
    keep: Callable[[Dynamics], None] | None = None,
) -> Discovery:
    """Find the effects that a model lacks in measured logs, add them, and decide whether structure is left.

    Args:
        model: The model as it is known: a bare robot, or one with terms. A model that remembers the logs it was learned
            from is compared with them: what is found are new effects and changes of its terms. The terms of another
            model are fitted again together with what is found.
        logs: One log or several of the same arm. Effects that differ between conditions may have parameters per log;
            all other parameters are common.
        holdout: Logs that are only predicted; without them, each block of time is predicted from the others.
        settings: What to search for, and how.
        progress: Called with a sentence and the share done, from 0 to 1.
        start: What an interrupted discovery of the same logs last gave to ``keep``: the search begins there.
        keep: Called with each better model that the search finds, which is not yet the result.

    Returns:
        The verdict, the steps, and the improved model.

    Raises:
        LogError: If a log is too short or of other joints.
        EffectError: If the settings name an unknown effect.
    """
    report = progress or silent
    report("conditioning", 0.0)
    settings, given = settings or DiscoverySettings(), listed(logs)
    problem = Problem.conditioned(model.robot, given, listed(holdout), settings)
    if model.learned_from and not settings.per_log and not is_known(problem.experiment, model):
        return discover_beyond(model, problem, report)
    # differences between the logs are found first, after all that the logs may have in common
    changes = changes_between(model, given, settings, part(report, 0.0, 0.05))
    problem = problem.around(model).with_parts(effects_that_differ(changes))
    findings = tuple(f for c in changes for f in c.findings)
    return discover_in(problem, model, report, findings=findings, start=start, keep=keep)


def discover_in(
    problem: Problem,
    model: Dynamics,
    progress: Progress | None = None,
    *,
    findings: tuple[Phenomenon, ...] = (),
    start: Dynamics | None = None,
    keep: Callable[[Dynamics], None] | None = None,
) -> Discovery:
    """Find missing effects as `discover` does, in logs that are already conditioned.

    Args:
        problem: The logs, and the candidates for the model.
        model: The model as it is known.
        progress: Called with a sentence and the share done, from 0 to 1.
        findings: Phenomena that are already known; they are added to the result.
        start: Model at which the search begins; the model as it is known if None.
        keep: Called with each better model that the search finds.
    """
    report = progress or silent
    apart = (*problem.settings.per_log, *problem.differing)
    model = with_parameters_per_log(model, problem.experiment.logs, apart)
    report("estimating the noise", 0.05)
    first = problem.without_rest_of(t.effect for t in model.terms).with_first_noise(model)
    whitened, found = _searched(first, model, start or model, part(report, 0.1, 0.5), keep)
    with_gains = with_drive_gains(whitened, found, model)
    if with_gains is not None:
        again, other = _searched(whitened, model, with_gains, part(report, 0.5, 0.6), keep)
        if costs_less(whitened, other, found):
            whitened, found = again, other
    with_links = with_every_link(whitened, found)
    if with_links is not None:
        answer = _answer(
            model, *_searched(whitened, model, with_links, part(report, 0.6, 0.8)), report, findings
        )
        if has_every_link(answer.model):
            return answer
    return _answer(model, whitened, found, report, findings)


def _answer(
    model: Dynamics,
    problem: WhitenedProblem,
    found: Dynamics,
    report: Progress,
    findings: tuple[Phenomenon, ...],
) -> Discovery:
    for plainer in PLAINER:
        with suppress(*DIVERGED):  # then the model stays as it is
            found = plainer(problem, found, model)
    report("ranking the effects", 0.85)
    return concluded(problem, model, found, report, ranking=rank(problem, model), findings=findings)


def _searched(
    problem: WhitenedProblem,
    model: Dynamics,
    found: Dynamics,
    report: Progress,
    keep: Callable[[Dynamics], None] | None = None,
) -> tuple[WhitenedProblem, Dynamics]:
    """Search from a model several times, each time with the noise that the search before left.

    Everyday effects come first: what they explain is not left to unusual ones, which follow a little of everything.
    Where an unusual one explains as much alone, or is there beyond doubt, they may have stood for it, so that another
    search begins with all.
    """
    first, start = problem, found
    futile = Swaps()
    needed: set[str] = set()  # doubted effects without which no model predicts as well
    for k in range(PASSES):
        before = found
        now = part(report, k / PASSES, (k + 1) / PASSES)
        problem = problem.with_drift(found)
        found = search(problem if k else everyday(problem, found), found, futile, now, keep)
        harm = harmful(problem, found, model)
        doubt = (doubted(problem, found, model) | harm) - needed
        if doubt:
            plain = plain_model(problem, found, before, doubt, now)
            if plain is None:
                needed |= doubt - harm
            else:
                problem, found = problem.without(doubt), plain
        there = {t.label for t in unusual_terms(problem, found, model)} - doubt
        if (k == 0 and has_unusual_rival(first, start, found)) or (k == 1 and there):
            anew = first.without(doubt)
            other = search(anew, start, Swaps(), now)
            found = other if costs_less(anew, other, found) else found
        problem = problem.with_noise_left_by(found)
        if k > 0 and {t.label for t in found.terms} == {t.label for t in before.terms}:
            break
    return problem, found
