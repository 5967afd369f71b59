"""A discovery in the terminal: the error step by step, the effects, their confusions, the verdict."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from cdia_pin.changes.confidence import Confidence
from cdia_pin.regression import shares
from cdia_pin.viewers.cells import clean, new_table
from cdia_pin.viewers.effect_groups import effect_groups, rivals, term_of
from cdia_pin.viewers.parameter_rows import shape_parameters, step_parameters
from cdia_pin.viewers.short_answer import short_answer
from cdia_pin.viewers.verdict import addition_sentences, mean_share, unseen_share, verdict_sentences
from cdia_pin.viewers.words import (
    advice_words,
    confusion_words,
    effect_name,
    effect_words,
    few,
    joints_words,
    percent,
    profile_words,
    sentence_case,
    short_names,
)

if TYPE_CHECKING:
    from cdia_pin.discovery import Discovery, Step

MANY = 4  # parameters; of an effect with more, only those that differ from zero are listed
# Share of the samples [1]. Motions that were made to identify an arm have 85 % and more; below, the errors are those
# of a part of the work that the arm does.
MOST_OF_THE_TIME = 0.8
NOTABLE_FALL = 0.1  # share of a joint's error by which a step must lower it to stand out
VERDICT_STYLE = {
    "nothing-missing": "green",
    "explained": "green",
    "explained-in-practice": "green",
    "unexplained": "yellow",
}
CONFIDENCE_STYLE = {
    Confidence.ESTABLISHED: "green",
    Confidence.LIKELY: "yellow",
    Confidence.DESCRIPTIVE: "dim",
}


def discovery_table(found: Discovery, everything: bool = True) -> RenderableType:
    """Return the short answer, and the errors by joint; on request also each step and every number.

    Args:
        found: The outcome of ``discover``.
        everything: Whether every step, effect and confusion is shown.
    """
    answer = Table.grid(padding=(0, 2))
    answer.add_column(no_wrap=True)
    answer.add_column()
    style = VERDICT_STYLE.get(found.verdict, "")
    for k, (head, text) in enumerate(short_answer(found)):
        answer.add_row(clean(head, f"bold {style}" if k == 0 else "bold"), clean(text))
    if not everything:
        return Group(Padding(answer, (0, 1)), _errors(found))
    parts: list[RenderableType] = [Padding(answer, (0, 1)), _steps(found)]
    if found.steps:
        parts.append(_effects(found))
    if sum(len({c.motion for c in s.confusions}) for s in found.steps) > 1:  # else the verdict says it
        parts.append(_confusions(found))
    said = verdict_sentences(found)
    parts += [Padding(clean(s, f"bold {style}" if k == 0 else ""), (0, 1)) for k, s in enumerate(said)]
    return Group(*parts)


def addition_table(found: Discovery) -> RenderableType:
    """Return the error before and after one effect was added, its numbers, and how sure its name is.

    Args:
        found: The outcome of ``add_effect``.
    """
    said = [Padding(clean(s, "" if k else "bold"), (0, 1)) for k, s in enumerate(addition_sentences(found))]
    return Group(_steps(found), _effects(found), *said)


def _errors(found: Discovery) -> Table:
    """Return the error by joint: before, after, on data that was not fitted, and that of noise alone."""
    table = _error_table(found, "mean")
    last = found.trace[-1]
    torque = found.torque_rms
    rows = [("model as given", found.trace[0].rms, torque)]
    if found.steps:
        rows.append(("with what was found", last.rms, torque))
        rows.append(("on data not fitted", last.heldout_rms, found.heldout_torque_rms))
    for name, error, over in (*rows, ("noise floor", found.noise_floor, torque)):
        by_joint, mean = error / np.maximum(over, 1e-12), shares.mean_share(error, over, found.counted)
        table.add_row(clean(name), *map(_figure, by_joint), _figure(mean))
    _add_compared(table, found)
    return table


def _add_compared(table: Table, found: Discovery) -> None:
    """Add how much of the time each joint is judged, where that is not nearly all of it."""
    share = found.compared_share
    if (share[found.counted] < MOST_OF_THE_TIME).any():
        table.add_row(Text("judged, % of the time", "dim"), *(Text(_figure(s), "dim") for s in share))


def _error_table(found: Discovery, *more: str) -> Table:
    """Return a table without rows, with a column for each joint."""
    joints = found.model.robot.joints
    names = short_names(joints)
    heads = [names[j].replace("_", "\n", 1) + "\nrests" * (j in found.resting) for j in joints]
    return new_table("error, % of torque RMS", *heads, *more, left=(0,))


def _steps(found: Discovery) -> Table:
    names = short_names(found.model.robot.joints)
    table = _error_table(found, "mean", "held\nout")
    torque = np.maximum(found.torque_rms, 1e-12)
    for k, step in enumerate(found.trace):
        share = step.rms / torque
        fell = step.rms < (1 - NOTABLE_FALL) * found.trace[max(k - 1, 0)].rms
        table.add_row(
            clean(_added(step, names)),
            *(Text(_figure(s), "bold green" if f else "") for s, f in zip(share, fell, strict=True)),
            Text(_figure(mean_share(step.rms, found)), "bold"),
            Text(_figure(unseen_share(step.heldout_rms, found))),
        )
    floor = [_figure(s) for s in found.noise_floor / torque]
    table.add_row(
        *(Text(c, "dim") for c in ("noise floor", *floor, _figure(mean_share(found.noise_floor, found)), ""))
    )
    _add_compared(table, found)
    return table


def _added(step: Step, names: dict[str, str]) -> str:
    if step.term is None:
        return "model as given"
    effect = step.term.effect
    where = joints_words([names[j] for j in effect.scope])
    return ", ".join([f"+ {effect_name(effect)}", *filter(None, [where])])


def _effects(found: Discovery) -> Table:
    table = new_table("found", "f, and its parameters ± 95 % (statistical, systematic)", left=(0, 1))
    for step in (s for group in effect_groups(found) for s in group.steps):
        term = term_of(step)
        name = clean(effect_name(term.effect), "bold")
        name.append_text(clean(f"\n{joints_words(term.effect.scope) or 'whole arm'}", "not bold"))
        style = CONFIDENCE_STYLE[step.confidence]
        name.append_text(clean(f"\n{step.confidence}", f"not bold {style}"))
        rows = [*_shown(step, found)]
        rows += [f"{p['name']} {p['text']}" for p in shape_parameters(term, found.model.robot)]
        if profile_words(term):
            rows.append(f"present: {profile_words(term)}")
        table.add_row(name, clean("\n".join([f"f = {term.effect.equation}", *rows])))
    return table


def _shown(step: Step, found: Discovery) -> list[str]:
    every = step_parameters(step, found.model.robot)
    shown = [p for p in every if p["telling"] or len(every) <= MANY]
    rows = [f"{p['name']} {p['text']}" + (f" ({', '.join(p['parts'])})" if p["parts"] else "") for p in shown]
    left = len(every) - len(shown)
    return [*rows, f"({left} more whose interval holds 0)"] if left else rows


def _confusions(found: Discovery) -> RenderableType:
    """Return what could be mistaken for what, by the motion that would distinguish it."""
    by_motion: dict[str, dict[str, list[str]]] = {}
    for step in found.steps:
        effect = term_of(step).effect
        for c in rivals(effect, step.confusions):
            pairs = by_motion.setdefault(c.motion, {})
            pairs.setdefault(effect_words(effect), []).append(confusion_words(c))
    parts: list[RenderableType] = []
    for motion, pairs in by_motion.items():
        parts.append(clean(f"{sentence_case(advice_words(motion))}:", "italic"))
        lines = (clean(f"{one} ↔ {', '.join(few(others))}") for one, others in pairs.items())
        parts += [Padding(line, (0, 0, 0, 2)) for line in lines]
    return Padding(Group(*parts), (0, 1, 1, 1))


def _figure(share: float) -> str:
    """Return a share in percent without the sign; a dash for a joint of which no sample counts."""
    return percent(share).removesuffix("%").rstrip() if share > 0 else "–"
