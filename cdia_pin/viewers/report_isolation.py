"""Isolation on the page of a run: the hypotheses over time, and the estimated sizes of the faults."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, TypedDict

import numpy as np

from cdia_pin.diagnosis.record import STAGES
from cdia_pin.diagnosis.status import Stage
from cdia_pin.viewers.report_series import Numbers, compact, compact_one
from cdia_pin.viewers.words import effect_name

if TYPE_CHECKING:
    from cdia_pin.diagnosis import MonitorRun
    from cdia_pin.diagnosis.journal import Look
    from cdia_pin.effects import Term

NONE_OF_THEM = "none of these"

Span = tuple[float, float, str]  # from [s], to [s], what


class HypothesisRow(TypedDict):
    """A known effect, and when it was a hypothesis."""

    effect: str
    spans: list[Span]


class ParameterHistory(TypedDict):
    """A parameter over time, with the ends of its interval; ``real`` is its value in the plant."""

    effect: str
    name: str
    unit: str
    time: list[float]
    value: Numbers
    low: Numbers
    high: Numbers
    real: float | None


def stage_spans(run: MonitorRun, j: int) -> list[Span]:
    """Return the stages of a joint, one after the other.

    Args:
        run: The run.
        j: Index of the joint.
    """
    change = np.flatnonzero(np.diff(run.stages[:, j], prepend=255))
    ends = [*run.time[change[1:]], run.time[-1]]
    return [span_of(run.time[k], end, STAGES[run.stages[k, j]]) for k, end in zip(change, ends, strict=True)]


def hypotheses(run: MonitorRun, j: int) -> list[HypothesisRow]:
    """Return when each known effect was a hypothesis on a joint.

    Open: detected, and no decision taken yet. Leading: in the combination that explains best. Possible: in another
    one that explains the same.

    Args:
        run: The run.
        j: Index of the joint.

    Returns:
        A row for each effect; no row if no hypothesis was ever tested.
    """
    looks = [look for look in run.looks if look.joint == run.joints[j]]
    if not looks:
        return []
    end = float(run.time[-1])
    lives = list(zip(looks, [*(look.time for look in looks[1:]), end], strict=True))
    open_ = _open(run, j, lives)
    rows: list[HypothesisRow] = []
    for effect in (*run.record["bank"], None):
        spans: list[Span] = [] if effect is None else [span_of(a, b, "open") for a, b in open_]
        for look, until in lives:
            how = _how(effect, look)
            if how and spans and spans[-1][1:] == (round(look.time, 4), how):
                spans[-1] = (spans[-1][0], round(until, 4), how)
            elif how:
                spans.append(span_of(look.time, until, how))
        name = NONE_OF_THEM if effect is None else effect.replace("_", " ")
        rows.append({"effect": name, "spans": sorted(spans, key=lambda s: s[0])})
    return rows


def parameters(run: MonitorRun, j: int, present: Sequence[Term]) -> list[ParameterHistory]:
    """Return the estimates of each parameter of a joint's faults over time.

    Args:
        run: With its beliefs.
        j: Index of the joint.
        present: Faults that the plant has, where they are known.
    """
    joint = run.joints[j]
    terms = {t.label: t for b in run.beliefs for t in b.faults if joint in t.effect.scope}
    return [
        _parameter(run, term, p, present)
        for term in terms.values()
        if term.effect.name != "unknown"  # its weights mean nothing one by one
        for p in range(term.effect.size)
    ]


def _parameter(run: MonitorRun, term: Term, p: int, present: Sequence[Term]) -> ParameterHistory:
    known = [next((t for t in b.faults if t.label == term.label), None) for b in run.beliefs]
    value = [np.nan if t is None else t.theta[p] for t in known]
    low, high = ([np.nan if t is None or not t.ci95 else t.ci95[p][end] for t in known] for end in (0, 1))
    time = [run.time[0], *(b.time for b in run.beliefs), run.time[-1]]

    def around(values: list[float]) -> Numbers:
        return compact([np.nan, *values, values[-1]])

    real = next((t.theta[p] for t in present if t.label == term.label), None)
    return {
        "effect": effect_name(term.effect),
        "name": term.effect.parameters[p].name.replace("_", " "),
        "unit": term.effect.units(run.robot)[p],
        "time": [round(float(t), 4) for t in time],
        "value": around(value),
        "low": around(low),
        "high": around(high),
        "real": None if real is None else compact_one(real),
    }


def _how(effect: str | None, look: Look) -> str:
    if look.leading is None:
        return "leading" if effect is None else ""
    if effect in look.leading:
        return "leading"
    return "possible" if any(effect in rival for rival in look.rivals) else ""


def _open(run: MonitorRun, j: int, lives: list[tuple[Look, float]]) -> list[tuple[float, float]]:
    """Return when a joint's fault was detected, and no effect had been named yet."""
    spans = []
    for begin, end, stage in stage_spans(run, j):
        named = [look.time for look, until in lives if until > begin and look.leading != ()]
        until = min([end, *named])
        if stage == Stage.DETECTED and until > begin:
            spans.append((begin, until))
    return spans


def span_of(begin: float, end: float, what: object) -> Span:
    """Return an interval of time with what holds in it.

    Args:
        begin: Its start [s].
        end: Its end [s].
        what: What holds.
    """
    return round(float(begin), 4), round(float(end), 4), str(what)
