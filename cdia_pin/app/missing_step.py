"""The step of the missing effects: ranking, confusions, history and the next motion."""

from __future__ import annotations

from functools import partial
from typing import Any, Protocol

from cdia_pin.app.next_motion import Doubt, doubts
from cdia_pin.app.parts import button, folded, node
from cdia_pin.app.result_steps import fall, name_of
from cdia_pin.app.session import Session
from cdia_pin.app.suggestions import Suggestion, suggestions
from cdia_pin.changes.confidence import Confidence
from cdia_pin.discovery import Discovery
from cdia_pin.effects import EFFECTS
from cdia_pin.viewers.effect_groups import EffectGroup, effect_groups, term_of
from cdia_pin.viewers.parameter_rows import group_numbers
from cdia_pin.viewers.short_answer import short_answer
from cdia_pin.viewers.words import percent, sentence_case

ANSWERED = ("where it fails", "good for")  # lines of the short answer; the cards say the others
CHIPS = {Confidence.ESTABLISHED: "good", Confidence.LIKELY: "warn", Confidence.DESCRIPTIVE: "plain"}
MEANING = {
    Confidence.ESTABLISHED: "found again in both halves of the log, at other cut-offs and with links that are wrong",
    Confidence.LIKELY: "found again in most repeats of the search",
    Confidence.DESCRIPTIVE: "lowers the error, and may be something else",
}
FIRST = 3  # suggestions that are not folded; those of the search never are


class MissingActions(Protocol):
    """What the step can ask of its page."""

    def search(self) -> Any:
        """Search for the missing effects."""

    def preview(self, text: str) -> Any:
        """Show the error with one more effect.

        Args:
            text: Such as ``coulomb_friction@elbow_joint``.
        """

    def add(self, text: str) -> Any:
        """Add an effect.

        Args:
            text: Such as ``coulomb_friction@elbow_joint``.
        """

    def add_found(self) -> Any:
        """Add all effects of the search."""

    def drop_preview(self) -> Any:
        """Forget the preview."""

    def goto(self, at: int) -> Any:
        """Return to a model of the history.

        Args:
            at: Its index.
        """

    def design(self, doubt: Doubt) -> Any:
        """Design a motion that distinguishes two effects, and download it.

        Args:
            doubt: The two effects.
        """


def missing_step(session: Session, do: MissingActions, searching: bool) -> None:
    """Show history, suggestions, an effect of the user's own, and the next motion.

    Args:
        session: The session.
        do: The page.
        searching: Whether a search is running.
    """
    _history(session, do)
    if session.preview is not None:
        _preview(session, do)
    found = session.found
    if found is not None:
        _answer(found)
        _suggestions(session, do)
    elif searching:
        node("p", "The search is running.", "soft")
    else:
        button("Search for missing effects", do.search, mark="search", classes="primary")
    _own(session, do)
    _next_motion(session, do)


def _history(session: Session, do: MissingActions) -> None:
    history = session.history
    with node("div", classes="history", role="group", aria_label="History"):
        for k, version in enumerate(history.versions):
            present = k == history.at
            with button("", partial(do.goto, k), mark=f"version-{k}", classes="version") as entry:
                entry.props["aria-pressed"] = "true" if present else "false"
                entry.classes("undone" if k > history.at else "")
                node("span", name_of(version))
                node("b", percent(version.error))
        with node("div", classes="undo"):
            button(
                "Undo",
                lambda: do.goto(history.at - 1),
                mark="undo",
                classes="quiet",
                disabled=not history.can_undo,
            )
            button(
                "Redo",
                lambda: do.goto(history.at + 1),
                mark="redo",
                classes="quiet",
                disabled=not history.can_redo,
            )


def _preview(session: Session, do: MissingActions) -> None:
    preview = session.preview
    assert preview is not None
    (text,) = preview.added
    with node("div", classes="preview", data_mark="preview"):
        with node("p"):
            node("span", f"With {name_of(preview).removeprefix('+ ')} the error is ")
            fall(session.present.error, preview.error)
        with node("div", classes="actions"):
            button("Add it", lambda: do.add(text), mark="add-preview", classes="primary")
            button("Discard", do.drop_preview, mark="drop-preview")


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


def _suggestions(session: Session, do: MissingActions) -> None:
    found = session.found
    assert found is not None
    rows = suggestions(found)
    chosen = {r.text: r for r in rows if r.chosen}
    others = [r for r in rows if not r.chosen]
    if len(chosen) > 1:
        button(
            f"Add all {len(chosen)} found by the search", do.add_found, mark="add-found", classes="primary"
        )
    groups = effect_groups(found)
    for group in groups:
        if group.confidence is not Confidence.DESCRIPTIVE:
            _group(group, [chosen[term_of(s).label] for s in group.steps], found, do)
    tail = [g for g in groups if g.confidence is Confidence.DESCRIPTIVE]
    if tail:
        names = ", ".join(g.words(found.model.robot.joints) for g in tail)
        with folded(f"only descriptive: {names}", mark="descriptive"):
            node("p", "They lower the error, and may be something else.", "soft")
            for row in (chosen[term_of(s).label] for g in tail for s in g.steps):
                _row(row, do, marked=False)
    few = others[: max(FIRST - len(chosen), 0)]
    for row in few:
        _row(row, do)
    if len(others) > len(few):
        with folded(f"{len(others) - len(few)} others that explain part of the error", mark="others"):
            for row in others[len(few) :]:
                _row(row, do)


def _group(group: EffectGroup, rows: list[Suggestion], found: Discovery, do: MissingActions) -> None:
    """Show effects of one kind: one as a card, several as a card that opens to them."""
    if len(rows) == 1:
        _row(rows[0], do)
        return
    with node("article", classes="suggestion", data_mark="group", data_confidence=str(group.confidence)):
        node("b", group.words(found.model.robot.joints))
        _chip(group.confidence)
        numbers = group_numbers(group, found.model.robot)
        if numbers:
            node("p", numbers, "numbers")
        with folded(f"the {len(rows)} effects", mark="members"):
            for row in rows:
                _row(row, do, marked=False)


def _chip(confidence: Confidence) -> None:
    node("span", str(confidence), f"chip {CHIPS[confidence]}", title=MEANING[confidence])


def _row(row: Suggestion, do: MissingActions, *, marked: bool = True) -> None:
    """Show an effect; `marked`: with its confidence, where what is around it does not say it."""
    with node("article", classes="suggestion", data_mark="suggestion", data_effect=row.text) as card:
        with node("header"):
            with node("div"):
                node("b", row.name)
                node("span", f" {row.where}", "soft")
            fall(row.before, row.after)
        if row.confidence is not None:
            card.props["data-confidence"] = str(row.confidence)
            if marked:
                _chip(row.confidence)
        if not row.plausible:
            node("span", "held at a bound: not plausible", "chip warn")
        more = f", and {row.more} more" if row.more else ""
        node("p", ", ".join(row.numbers) + more, "numbers", title=row.parts)
        if row.confusions:
            with folded(f"could also be {_few([w for w, _ in row.confusions])}", mark="confusions"):
                for words, motion in row.confusions:
                    node("p", f"{words}: {motion}")
        with node("div", classes="actions"):
            what = f"{row.name} {row.where}"
            button(
                "Preview", lambda: do.preview(row.text), mark=f"preview-{row.text}", label=f"Preview {what}"
            )
            button("Add", lambda: do.add(row.text), mark=f"add-{row.text}", label=f"Add {what}")


def _few(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"{names[0]}, or {len(names) - 1} more"


def _own(session: Session, do: MissingActions) -> None:
    joints = session.inputs.robot.joints
    with folded("Another effect, or your own", mark="own"):
        with node("datalist", id="effects"):
            for name in EFFECTS:
                if name not in {"expression"}:
                    node("option", value=name)
        typed = {"text": ""}
        box = node(
            "input",
            classes="typed",
            list="effects",
            aria_label="effect",
            placeholder=f"sin(3*q)*dq@{joints[min(2, len(joints) - 1)]}",
            data_mark="own-effect",
        )
        box.on("input", lambda e: typed.update(text=e.args), js_handler="(event) => emit(event.target.value)")
        node("p", "NAME@JOINT, or an expression of q, dq, ddq, tau at a joint.", "soft")
        with node("div", classes="actions"):
            button("Preview", lambda: do.preview(typed["text"].strip()), mark="own-preview")
            button("Add", lambda: do.add(typed["text"].strip()), mark="own-add")


def _next_motion(session: Session, do: MissingActions) -> None:
    """Show which motion to record next, and offer to design it."""
    rows = doubts(session)
    if not rows:
        return
    with node("div", classes="next-motion", data_mark="next-motion"):
        node("h3", "The next motion to record")
        for k, doubt in enumerate(rows):
            with node("p"):
                node("span", f"To distinguish {doubt.pair}: ", "soft")
                node("span", doubt.motion + ".")
            if doubt.tellable:
                button(
                    "Design it (.csv)",
                    partial(do.design, doubt),
                    mark=f"design-{k}",
                    label=f"Design a motion: {doubt.pair}",
                )
