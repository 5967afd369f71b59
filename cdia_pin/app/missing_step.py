"""The step of the missing effects: history, verdict, suggestions, an effect of the user's own, the next motion."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from cdia_pin.app.next_motion import Doubt, doubts
from cdia_pin.app.parts import button, folded, node
from cdia_pin.app.result_steps import FEW, fall, name_of
from cdia_pin.app.session import Session
from cdia_pin.app.suggestion_cards import confidence_chip, suggestion_cards
from cdia_pin.app.workbench import Workbench
from cdia_pin.discovery import Discovery
from cdia_pin.effects import EFFECTS
from cdia_pin.viewers.effect_groups import effect_groups
from cdia_pin.viewers.parameter_rows import group_numbers
from cdia_pin.viewers.short_answer import short_answer
from cdia_pin.viewers.words import percent, sentence_case

ANSWERED = ("where it fails", "good for")  # lines of the short answer; the cards say the others
FIRST = 2  # motions to record that are not folded


def missing_step(session: Session, bench: Workbench, design: Callable[[Doubt], Any]) -> None:
    """Show history, suggestions, an effect of the user's own, and the next motion.

    Args:
        session: The session.
        bench: Takes the steps.
        design: Hands out a motion that distinguishes two effects.
    """
    _history(session, bench)
    _added(session)
    if session.preview is not None:
        _preview(session, bench)
    found = session.found
    if found is not None:
        _answer(found)
        suggestion_cards(found, bench)
    elif bench.searching:
        node("p", "The search is running.", "soft")
    else:
        button("Search for missing effects", bench.search, mark="search", classes="primary")
    _own(session, bench)
    _next_motion(session, design)


def _history(session: Session, bench: Workbench) -> None:
    history = session.history
    with node("div", classes="history", role="group", aria_label="History"):
        for k, version in enumerate(history.versions):
            present = k == history.at
            with button("", partial(bench.goto, k), mark=f"version-{k}", classes="version") as entry:
                entry.props["aria-pressed"] = "true" if present else "false"
                entry.classes("undone" if k > history.at else "")
                node("span", name_of(version))
                node("b", percent(version.error))
        with node("div", classes="undo"):
            button(
                "Undo",
                lambda: bench.goto(history.at - 1),
                mark="undo",
                classes="quiet",
                disabled=not history.can_undo,
            )
            button(
                "Redo",
                lambda: bench.goto(history.at + 1),
                mark="redo",
                classes="quiet",
                disabled=not history.can_redo,
            )


def _added(session: Session) -> None:
    """Show in a fold what has been added, in groups with their confidence."""
    made = session.history.discovery
    if made is None or len(made.steps) <= FEW:
        return
    with folded(f"What was added: {len(made.steps)} effects", mark="added"):
        for group in effect_groups(made):
            with node("p"):
                confidence_chip(group.confidence)
                node("span", f" {group.words(made.model.robot.joints)} ")
                node("span", group_numbers(group, made.model.robot), "soft")


def _preview(session: Session, bench: Workbench) -> None:
    preview = session.preview
    assert preview is not None
    (text,) = preview.added
    with node("div", classes="preview", data_mark="preview"):
        with node("p"):
            node("span", f"With {name_of(preview).removeprefix('+ ')} the error is ")
            fall(session.present.error, preview.error)
        with node("div", classes="actions"):
            button("Add it", lambda: bench.add(text), mark="add-preview", classes="primary")
            button("Discard", bench.drop_preview, mark="drop-preview")


def _answer(found: Discovery) -> None:
    """Show the verdict, where the model would still fail, and what it would be good for."""
    (verdict, error), *lines = short_answer(found)
    said = f"{sentence_case(verdict)}: {error}"
    node("p", said, "verdict", data_mark="verdict", data_verdict=found.verdict)
    with node("dl", classes="answer"):
        for head, text in lines:
            if head in ANSWERED:
                node("dt", head)
                node("dd", text)


def _own(session: Session, bench: Workbench) -> None:
    joints = session.inputs.robot.joints
    with folded("Another effect, or your own", mark="own", open_=bool(bench.typed)):
        with node("datalist", id="effects"):
            for name in EFFECTS:
                if name not in {"expression"}:
                    node("option", value=name)
        box = node(
            "input",
            classes="typed",
            list="effects",
            aria_label="effect",
            placeholder=f"sin(3*q)*dq@{joints[min(2, len(joints) - 1)]}",
            data_mark="own-effect",
            value=bench.typed,
        )
        box.on("input", lambda e: bench.type_own(e.args), js_handler="(event) => emit(event.target.value)")
        if bench.own_fault:
            box.props["aria-invalid"] = "true"
            node("p", bench.own_fault, "fault", data_mark="own-fault")
        node("p", "NAME@JOINT, or an expression of q, dq, ddq, tau at a joint.", "soft")
        with node("div", classes="actions"):
            button("Preview", lambda: bench.preview(bench.typed), mark="own-preview")
            button("Add", lambda: bench.add(bench.typed), mark="own-add")


def _next_motion(session: Session, design: Callable[[Doubt], Any]) -> None:
    """Show which motion to record next, and offer to design it."""
    rows = doubts(session)
    if not rows:
        return
    with node("div", classes="next-motion", data_mark="next-motion"):
        node("h3", "The next motion to record")
        for k, doubt in enumerate(rows[:FIRST]):
            _doubt(k, doubt, design)
        if more := rows[FIRST:]:
            with folded(f"{len(more)} more", mark="more-motions"):
                for k, doubt in enumerate(more, FIRST):
                    _doubt(k, doubt, design)


def _doubt(k: int, doubt: Doubt, design: Callable[[Doubt], Any]) -> None:
    with node("p"):
        node("span", f"To distinguish {doubt.pair}: ", "soft")
        node("span", doubt.motion + ".")
    if doubt.tellable:
        button(
            "Design it (.csv)",
            partial(design, doubt),
            mark=f"design-{k}",
            label=f"Design a motion: {doubt.pair}",
        )
