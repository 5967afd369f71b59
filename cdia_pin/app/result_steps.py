"""The steps that show results: check, compare, export."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from nicegui import ui

from cdia_pin.app.advice import CONVERSION, ROBOT, advice_words, conversion_words
from cdia_pin.app.history import Version
from cdia_pin.app.parts import button, folded, node
from cdia_pin.app.python_lines import python_lines
from cdia_pin.app.session import Session
from cdia_pin.app.workbench import Workbench
from cdia_pin.logs import LogCheck
from cdia_pin.logs.checks.finding import Finding
from cdia_pin.viewers.short_answer import noticed
from cdia_pin.viewers.words import listed, percent, region_words, sentence_case, short_names

REGIONS = 3  # that are shown
FEW = 3  # effects that are named in a line; more are counted
MARKS = {"ok": "✓", "info": "·", "warning": "!", "error": "✕"}


def check_step(check: LogCheck, bench: Workbench) -> None:
    """Show the findings of a check, problems first.

    Args:
        check: The outcome of ``check_log``.
        bench: Takes the steps.
    """
    problems = check.problems
    rest = [f for f in check.findings if f not in problems]
    if not problems:
        node("p", f"Nothing needs attention in {len(check.findings)} findings.", "good", data_mark="check-ok")
    for finding in problems:
        _finding(finding, bench)
    with folded(f"{len(rest)} more" if problems else "All findings", mark="findings"):
        for finding in rest:
            _finding(finding, bench)


def _finding(finding: Finding, bench: Workbench) -> None:
    with node("div", classes=f"finding {finding.severity}", data_mark="finding"):
        node("span", MARKS[finding.severity], "mark", aria_label=finding.severity)
        with node("div"):
            where = f"{finding.joint}: " if finding.joint else ""
            node("p", f"{where}{advice_words(finding.message)}")
            if finding.advice:
                node("p", advice_words(finding.advice), "soft")
            if finding.severity not in {"warning", "error"}:
                return
            for option in CONVERSION.findall(finding.advice):
                said = sentence_case(conversion_words(option))
                button(said, partial(bench.convert, option), mark=f"apply-{option}", classes="quiet")
            for robot in ROBOT.findall(finding.advice):
                said = f"Read the log as one of {robot}"
                button(said, partial(bench.take_robot, robot), mark=f"robot-{robot}", classes="quiet")


def compare_step(session: Session, bench: Workbench) -> None:
    """Show where the present model fails.

    Args:
        session: The session.
        bench: Takes the steps.
    """
    comparison = session.present.comparison
    short = short_names(comparison.model.robot.joints)
    with node("p"):
        node("span", "The error of the model is ")
        node(
            "b", percent(session.present.error), data_mark="error", data_value=f"{session.present.error:.6f}"
        )
        node("span", " of the measured torque (RMS, mean over the joints). It is largest at")
    with node("ul", classes="regions"):
        for region in comparison.worst_regions[:REGIONS]:
            with node("li"):
                button(
                    short[region.joint], partial(bench.choose, region.joint), mark="region", classes="link"
                )
                node("span", f" {region_words(region)}: {region.ratio:.1f} × its mean", "soft")
    known = session.known
    if known is not None:
        node("p", f"On motions such as this one it notices {listed(noticed(known))}.", data_mark="capability")


def export_step(session: Session, export: Callable[[str], Any]) -> None:
    """Offer the files, and the Python lines that make them.

    Args:
        session: The session.
        export: Downloads a file of `workbench.FILES`.
    """
    with node("div", classes="actions"):
        for what, name in (
            ("model", "Model"),
            ("urdf", "URDF"),
            ("report", "Report"),
            ("python", "Python"),
        ):
            button(name, partial(export, what), mark=f"export-{what}", label=f"Download {name}")
    script = python_lines(session)
    with folded("The Python lines that do the same", mark="python"):
        node("pre", script, data_mark="python-lines", tabindex="0")
        button("Copy", lambda: ui.clipboard.write(script), mark="copy", classes="quiet")


def fall(before: float, after: float) -> None:
    """Show an error that falls: ``48 % → 8.2 %``.

    Args:
        before: Share of the torque RMS [1].
        after: The same after a step [1].
    """
    with node("span", classes="fall"):
        node("span", percent(before), "b")
        node("span", " → ", "soft", aria_label="falls to")
        node("span", percent(after), "a")


def name_of(version: Version) -> str:
    """Return the name of a version of the history.

    Args:
        version: One of them.
    """
    if not version.added:
        return "as given"
    if len(version.added) > FEW:
        return f"+ {len(version.added)} effects"
    return "+ " + ", ".join(text.replace("_", " ").replace("@", " on ") for text in version.added)
