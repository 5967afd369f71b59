"""Results as HTML for a notebook, without scripts: GitHub and printed notebooks show them too."""

from __future__ import annotations

import html
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

from cdia_pin.changes.confidence import Confidence
from cdia_pin.diagnosis import MonitorRun, Stage
from cdia_pin.diagnosis.monitor_record import what_is_blind
from cdia_pin.discovery import Comparison, Discovery, Step
from cdia_pin.phrases import NO_BREAK
from cdia_pin.viewers import sparks
from cdia_pin.viewers.effect_groups import MOST_RIVALS, effect_groups, rivals, term_of
from cdia_pin.viewers.event_words import event_rows, fault_words
from cdia_pin.viewers.parameter_rows import group_numbers, parts_words, shape_parameters, step_parameters
from cdia_pin.viewers.report_isolation import stage_spans
from cdia_pin.viewers.short_answer import short_answer
from cdia_pin.viewers.sparks import BEFORE
from cdia_pin.viewers.stage_colours import STAGE_COLOURS
from cdia_pin.viewers.text_monitor import NEARNESS, run_summary, stage_words
from cdia_pin.viewers.verdict import comparison_sentence, mean_share, unseen_share, verdict_sentences
from cdia_pin.viewers.whole_arm_row import WHOLE_ARM, of_joint, whole_arm_row
from cdia_pin.viewers.words import (
    confusion_words,
    effect_name,
    few,
    joint_units,
    listed,
    number,
    percent,
    region_words,
    sentence_case,
    where_words,
    with_unit,
)

STYLE = """<style>
.cdia-pin { font-variant-numeric: tabular-nums; max-width: 62em; line-height: 1.5; }
.cdia-pin p { margin: 0 0 .6em; }
.cdia-pin details { margin: 0 0 .4em; }
.cdia-pin > p:first-of-type { font-weight: 600; }
.cdia-pin table { border-collapse: collapse; margin: .4em 0 1em; font-size: 13px; }
.cdia-pin th, .cdia-pin td { padding: 3px 14px 3px 0; text-align: left; vertical-align: top;
  border: 0; border-bottom: 1px solid rgba(128, 140, 152, .3); background: transparent; color: inherit; }
.cdia-pin thead th:empty { border: 0; padding: 0; }
.cdia-pin th { opacity: .75; font-weight: 600; vertical-align: bottom; }
.cdia-pin .n { text-align: right; white-space: nowrap; }
.cdia-pin .soft { opacity: .72; font-weight: 400; }
.cdia-pin svg { display: block; max-width: none; }
</style>"""

REGIONS = 3  # worst regions named
LEFT = "the residual left its threshold"


def html_of(result: object) -> str:
    """Return a comparison, a discovery or a monitor's run as HTML.

    Args:
        result: One of these.

    Raises:
        TypeError: If it is none of them.
    """
    for kind, parts in SHOWN.items():
        if isinstance(result, kind):
            return f'{STYLE}<div class="cdia-pin">{"".join(parts(result))}</div>'
    raise TypeError(f"no picture of a {type(result).__name__}")


# ------------------------------------------------------------------ pieces


class Markup(str):
    """Text that is HTML already."""


def _text(value: object) -> str:
    return value if isinstance(value, Markup) else html.escape(str(value))


def _say(sentence: object, style: str = "") -> str:
    return f"<p{f' class={style}' if style else ''}>{_text(sentence)}</p>"


def _table(heads: Sequence[str], rows: Iterable[Sequence[object]], numbers: Sequence[int] = ()) -> Markup:
    """Return a table; the columns in `numbers` stand to the right."""

    def cell(tag: str, k: int, value: object) -> str:
        return f"<{tag}{' class=n' if k in numbers else ''}>{_text(value)}</{tag}>"

    def line(tag: str, row: Sequence[object]) -> str:
        return f"<tr>{''.join(cell(tag, k, v) for k, v in enumerate(row))}</tr>"

    body = "".join(line("td", row) for row in rows)
    return Markup(f"<table><thead>{line('th', heads)}</thead><tbody>{body}</tbody></table>")


def _lines(lines: Iterable[object]) -> Markup:
    return Markup("<br>".join(_text(x) for x in lines))


def _soft(text: str) -> str:
    return f" <span class=soft>({_text(text)})</span>" if text else ""


def _folded(summary: str, numbers: str, inside: Markup) -> str:
    """Return a part that opens with a press; where pages have no such parts, it is open."""
    soft = f" <span class=soft>{_text(numbers)}</span>" if numbers else ""
    return f"<details><summary>{_text(summary)}{soft}</summary>{inside}</details>"


# ------------------------------------------------------------------ results


def _comparison(result: Comparison) -> Iterable[str]:
    robot, share = result.model.robot, result.relative_rms
    largest = float(np.nan_to_num(share).max())
    yield _say(comparison_sentence(result))
    rows = []
    for j, joint in enumerate(robot.joints):
        unit = joint_units(robot, joint)["load"]
        rows.append((
            joint,
            with_unit(number(result.torque_rms[j]), unit),
            with_unit(number(result.rms[j]), unit),
            percent(share[j]),
            Markup(sparks.bar([np.nan_to_num(share[j])], [BEFORE], largest, f"{joint}: {percent(share[j])}")),
            Markup(sparks.line([result.residual[:, j]], [BEFORE], f"residual of {joint} over time")),
        ))  # fmt: skip
    heads = ("joint", "torque RMS", "error RMS", "share", "share of the torque RMS", "residual over time")
    yield _table(heads, rows, numbers=(1, 2, 3))
    for r in result.worst_regions[:REGIONS]:
        yield _say(
            f"On {r.joint} the error is {number(r.ratio, 2)} × its mean where {region_words(r)}.", "soft"
        )


def _discovery(result: Discovery) -> Iterable[str]:
    robot = result.model.robot
    (verdict, error), *answer = short_answer(result)
    yield _say(f"{sentence_case(verdict)}: {error}.")
    yield _table(("", ""), answer)
    named = [g for g in effect_groups(result) if g.confidence is not Confidence.DESCRIPTIVE]
    tail = [g for g in effect_groups(result) if g.confidence is Confidence.DESCRIPTIVE]
    for group in named:
        head = f"{group.confidence}: {group.words(robot.joints)}"
        yield _folded(head, group_numbers(group, robot), _effects(group.steps, result))
    if tail:
        words = f"only descriptive: {', '.join(g.words(robot.joints) for g in tail)}"
        yield _folded(words, "", _effects([s for g in tail for s in g.steps], result))
    yield _table(("error, share of the torque RMS", ""), [(_errors(result), _falling(result))])
    sentences = (_say(s) for s in verdict_sentences(result))
    yield _folded("the same in sentences", "", Markup("".join(sentences)))


def _effects(steps: Iterable[Step], result: Discovery) -> Markup:
    """Return the table of some effects, with both parts of each interval."""
    robot, rows = result.model.robot, []
    for step in steps:
        term = term_of(step)
        sizes = [Markup(f"{_text(p['name'])} {_text(p['text'])}{_soft(parts_words(p))}")
                 for p in step_parameters(step, robot)]  # fmt: skip
        sizes += [Markup(_text(f"{p['name']} {p['text']}")) for p in shape_parameters(term, robot)]
        doubts = few((confusion_words(c) for c in rivals(term.effect, step.confusions)), MOST_RIVALS)
        where = f"on {where_words(term.effect)}"
        named = Markup(f"<b>{_text(effect_name(term.effect))}</b><br>{_text(where)}")
        rows.append((named, f"f = {term.effect.equation}", _lines(sizes), listed(doubts) or "–"))
    return _table(("effect", "equation", "parameters ± 95 %", "could be mistaken for"), rows)


def _errors(result: Discovery) -> Markup:
    columns = {
        "as given": result.trace[0].rms,
        "improved": result.trace[-1].rms,
        "held out": result.trace[-1].heldout_rms,
        "noise floor": result.noise_floor,
    }
    torques = {"held out": result.heldout_torque_rms}
    shares = [rms / np.maximum(torques.get(name, result.torque_rms), 1e-12) for name, rms in columns.items()]
    rows = [(joint, *(percent(s[j]) for s in shares)) for j, joint in enumerate(result.model.robot.joints)]
    return _table(("joint", *columns), rows, numbers=range(1, 1 + len(columns)))


def _falling(result: Discovery) -> Markup:
    fitted = [mean_share(s.rms, result) for s in result.trace]
    heldout = [unseen_share(s.heldout_rms, result) for s in result.trace]
    words = f"mean error, effect by effect: {', '.join(map(percent, fitted))}"
    key = "blue: fitted; orange: held out; dotted: noise floor"
    picture = sparks.fall(fitted, heldout, mean_share(result.noise_floor, result), words)
    return Markup(f"{picture}<span class=soft>{key}</span>")


def _run(result: MonitorRun) -> Iterable[str]:
    yield _say(run_summary(result))
    begin, end = float(result.time[0]), float(result.time[-1])
    rows = []
    seen: set[str] = set()
    colours = {str(s): (colour, 0.3 if s is Stage.HEALTHY else 1.0) for s, colour in STAGE_COLOURS.items()}
    for j, joint in enumerate(result.joints):
        unit = joint_units(result.robot, joint)["load" if result.in_torque else "velocity"]
        spans = stage_spans(result, j)
        seen |= {s for _, _, s in spans}
        words = f"{joint}: {', '.join(f'{s} from {a:.2f} s' for a, _, s in spans)}"
        rows.append((
            stage_words(joint, joint in result.blind),
            with_unit(number(float(result.typical_threshold[j])), unit),
            percent(float(result.nearness[j])),
            Markup(sparks.strip([(a, b, *colours[s]) for a, b, s in spans], begin, end, words)),
            _lines(fault_words(t, result.robot) for t in of_joint(result.faults, joint)) or "–",
        ))  # fmt: skip
    if (arm := whole_arm_row(result)) is not None:
        rows.append((WHOLE_ARM, "–", "–", Markup(arm.stage), _lines(arm.believed) or "–"))
    heads = (
        "joint",
        "typical threshold",
        NEARNESS,
        f"stages, {begin:.4g} to {end:.4g} s",
        "fault at the end",
    )
    yield _table(heads, rows, numbers=(1, 2))
    if advice := what_is_blind(result.record):
        yield _say(advice)
    keys = (f'<span style="color:{c}">■</span> {s}' for s, c in STAGE_COLOURS.items() if str(s) in seen)
    yield _say(Markup(" &nbsp; ".join(keys)), "soft")
    said = [
        (
            f"{row.time:.3f}{NO_BREAK}s",
            row.joints,
            row.stage,
            _lines(filter(None, (row.verdict, *row.said, row.reason))) or LEFT,
        )
        for row in event_rows(result.events, result.robot)
    ]
    if said:
        yield _table(("time", "joint", "stage", "event"), said, numbers=(0,))


SHOWN: dict[type, Callable[[Any], Iterable[str]]] = {
    Comparison: _comparison,
    Discovery: _discovery,
    MonitorRun: _run,
}
