"""What changes mean: friction that falls on many joints is a warm arm, torques that all come later are a recorder."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cdia_pin.changes.changes_result import Change
from cdia_pin.changes.phenomenon import Phenomenon, PhenomenonKind
from cdia_pin.changes.run_to_run import RunToRun
from cdia_pin.effects import EffortDelay
from cdia_pin.effects.body import Body

FEWEST = 3  # joints [1]; a change on fewer may be a fault of each of them
# Share of the joints [1] that a change of temperature must reach, because it reaches all drives.
MOST_JOINTS = 0.5
# Difference over the friction that both sides have in common [1], above which that before is too small to be told: the
# common part is not quite the mean of both sides.
MOST_GROWTH = 1.0  # [1]


def findings_of(changes: Sequence[Change], run_to_run: RunToRun) -> tuple[Phenomenon, ...]:
    """Return the phenomena behind changes: a cause of several of them, or one that is not in the arm.

    Args:
        changes: The changes.
        run_to_run: Friction of both sides, whether it is named as a change or not.
    """
    return (*_temperature(changes, run_to_run), *_recorder(changes, run_to_run.joints))


def _temperature(changes: Sequence[Change], run_to_run: RunToRun) -> tuple[Phenomenon, ...]:
    """Return that the drives are warmer or colder, if friction fell or rose on most joints.

    No joint need differ by more than is usual from run to run: that all of them do so in one direction is not usual.
    Beside a heavier body it is, because joints that carry more have more friction.
    """
    growth, usual = run_to_run.growth, run_to_run.settings.spread
    differ = np.flatnonzero(np.abs(np.nan_to_num(growth)) >= usual)
    signs = set(np.sign(growth[differ]))
    carried = {np.sign(c.term.theta[0]) for c in changes if isinstance(c.term.effect, Body)}
    if len(differ) < max(FEWEST, MOST_JOINTS * len(growth)) or len(signs) != 1 or signs == carried:
        return ()
    fell = signs == {-1.0}
    median, after = float(np.median(growth[differ])), float(np.median(run_to_run.after[differ]))
    told = min(median, MOST_GROWTH)
    # what both sides have in common is their mean, each weighted by its samples
    grown = max(told / (1.0 - after * told), -1.0)
    at_least = "at least " if told < median else ""
    everywhere = len(differ) == len(growth)
    count = f"all {len(growth)} joints" if everywhere else f"{len(differ)} of {len(growth)} joints"
    others = (
        "" if everywhere else f"; on the others it differs by less than {100 * usual:.0f} %, or is not known"
    )
    cause = "are warmer than before" if fell else "are colder than before, or carry more"
    sentence = (
        f"friction {'fell' if fell else 'rose'} on {count} by {at_least}{abs(100 * grown):.0f} % (median){others}: "
        f"the drives {cause}"
    )
    kind = PhenomenonKind.WARMING if fell else PhenomenonKind.COOLING
    joints = tuple(run_to_run.joints[j] for j in differ)
    return (Phenomenon(kind, joints, sentence, {"median_growth": grown}),)


def _recorder(changes: Sequence[Change], joints: tuple[str, ...]) -> tuple[Phenomenon, ...]:
    """Return that the torques of all joints are recorded later or earlier, if one delay of them all changed."""
    out = []
    for c in changes:
        if isinstance(c.term.effect, EffortDelay) and not c.term.effect.scope:
            delay = c.term.theta[0]
            sentence = (
                f"the torques of all joints are recorded {1e3 * abs(delay):.2g} ms "
                f"{'later' if delay > 0 else 'earlier'} beside the positions than before: that is how the logs were "
                "recorded, or another controller, and not the arm"
            )
            out.append(Phenomenon(PhenomenonKind.RECORDER, joints, sentence, {"delay": delay}))
    return tuple(out)
