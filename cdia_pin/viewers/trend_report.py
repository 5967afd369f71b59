"""The report of a fleet: one HTML file with the short answer, the changes, and a chart of each."""

from __future__ import annotations

import html
from collections.abc import Iterator
from pathlib import Path

from cdia_pin.errors import CdiaError
from cdia_pin.fleet import FleetChange, FleetTrend, RobotTrend
from cdia_pin.fleet.fleet_effects import Role
from cdia_pin.phrases import counted
from cdia_pin.viewers.page import asset
from cdia_pin.viewers.study_report import PAGE, page_style
from cdia_pin.viewers.trend_chart import CHART_STYLE, course_chart
from cdia_pin.viewers.trend_words import (
    agreement_words,
    change_sentence,
    course_words,
    day_words,
    level_words,
    size_words,
    slope_words,
    trend_answer,
)
from cdia_pin.viewers.words import listed, number, sentence_case
from cdia_pin.whole_files import write_whole

MOST_CHARTS = 60  # changes with a chart of their own [1]; each has some kB
MOST_ALONG = 4  # charts of what moved along with a change [1]


def write_trend_report(path: str | Path, trend: FleetTrend, command: str = "") -> Path:
    """Write a trend as one HTML page that needs no network.

    Args:
        path: Where to write; folders are made, an existing file is replaced.
        trend: The outcome of ``fleet_trend``.
        command: What made the report, to be shown.

    Raises:
        CdiaError: If the file cannot be written.
    """
    path = Path(path)
    page = trend_page(trend, command)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, page)
    except OSError as error:
        raise CdiaError(f"the report cannot be written to {path}: {error.strerror}") from None
    return path


def trend_page(trend: FleetTrend, command: str = "") -> str:
    """Return the page.

    Args:
        trend: The outcome of ``fleet_trend``.
        command: What made it.
    """
    lasting = any(c.alarm.lasting for c in trend.changes)
    (head, first), *rest = trend_answer(trend)
    body = [
        f"<section class='card verdict'><div><span class='chip {'warn' if lasting else 'good'}'>{_text(head)}</span>"
        f"<p class='first'>{_text(first)}.</p>",
        "<dl class='answer'>",
        *(f"<dt>{_text(h)}</dt><dd>{_text(t)}</dd>" for h, t in rest),
        "</dl></div></section>",
    ]
    if command:
        body.append(f"<pre style='margin-top:18px'><code>{_text(command)}</code></pre>")
    if trend.changes:
        body += ["<h2>What changed, the surest first</h2>", _changes(trend)]
        body += [_of_change(c) for c in trend.changes[:MOST_CHARTS]]
        if len(trend.changes) > MOST_CHARTS:
            body.append(
                f"<p class='soft'>{counted(len(trend.changes) - MOST_CHARTS, 'more change')} without a chart here.</p>"
            )
    body.append("<h2>Every robot</h2>")
    body += [_of_robot(r, is_open=len(trend.robots) == 1) for r in trend.robots]
    title = (
        f"Trend of {len(trend.robots)} robots"
        if len(trend.robots) != 1
        else f"Trend of {trend.robots[0].robot}"
    )
    style = f"{asset('charts.css')}\n{page_style()}\n{CHART_STYLE}"
    return PAGE.format(title=_text(title), style=style, body="\n".join(body))


def _text(text: str) -> str:
    return html.escape(text)


def _table(heads: list[str], rows: Iterator[list[str]]) -> str:
    head = "".join(f"<th>{_text(h)}</th>" for h in heads)
    lines = "".join(f"<tr>{''.join(f'<td>{_text(c)}</td>' for c in row)}</tr>" for row in rows)
    return (
        f"<div class='card scroll'><table><thead><tr>{head}</tr></thead><tbody>{lines}</tbody></table></div>"
    )


def _changes(trend: FleetTrend) -> str:
    def rows() -> Iterator[list[str]]:
        for c in trend.changes:
            alarm = c.alarm
            yield [
                c.trend.course.robot,
                course_words(c.trend.course),
                size_words(c),
                day_words(alarm.since_time, alarm.since),
                day_words(alarm.raised_time, alarm.raised),
                f"{number(alarm.certainty, 2)} (limit {number(c.trend.limit, 2)})",
                listed(course_words(t.course) for t in c.along),
            ]

    heads = ["robot", "changed", "by ± 95 %", "since", "noticed", "certainty", "moved along"]
    return _table(heads, rows())


def _of_change(change: FleetChange) -> str:
    along = "".join(
        f"<h3 style='margin-top:14px'>moved along: {_text(course_words(t.course))}</h3>{course_chart(t)}"
        for t in change.along[:MOST_ALONG]
    )
    folded = (
        f"<details><summary>{counted(len(change.along), 'parameter')} moved along</summary>{along}</details>"
        if along
        else ""
    )
    return (
        f"<section class='card' style='margin-top:16px'><h3>{_text(change.trend.course.robot)}: "
        f"{_text(change_sentence(change))}</h3>{course_chart(change.trend)}{folded}</section>"
    )


def _of_robot(robot: RobotTrend, *, is_open: bool) -> str:
    c = robot.courses
    said = counted(c.logs, "log") + (f", {len(c.failed)} failed" if c.failed else "")
    said += "" if c.dated else ", without dates: in the order of their names"
    said += f", {counted(len(robot.changes), 'change')}" if robot.changes else ""

    def rows() -> Iterator[list[str]]:
        for t in robot.trends:
            if t.course.role is Role.JOB or not len(t.compared):
                continue
            yield [
                course_words(t.course),
                level_words(t),
                number(t.spread, 2) if t.is_judged else "–",
                f"{len(t.compared)} of {len(t.course.logs)}",
                "; ".join(f"{name} {said}" for name, said in slope_words(t).items()) or "–",
            ]

    heads = ["parameter", "level ± 95 %", "spread", "compared logs", "explained by"]
    sentences = "".join(f"<p>{_text(sentence_case(s))}.</p>" for s in agreement_words(robot))
    failed = "".join(
        f"<p class='soft'>{_text(log)} failed: {_text(why)}</p>" for log, why in c.failed.items()
    )
    head = f"<summary><b>{_text(robot.robot)}</b> <span class='soft'>{_text(said)}</span></summary>"
    state = " open" if is_open else ""
    return f"<details{state}>{head}{sentences}{failed}{_table(heads, rows())}</details>"
