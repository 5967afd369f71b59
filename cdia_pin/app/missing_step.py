"""The step that names what is missing: ranked effects, their doubles, the history and the next motion."""

from __future__ import annotations

from functools import partial
from typing import Any, Protocol

from cdia_pin.app.next_motion import Doubt, doubts
from cdia_pin.app.parts import button, folded, node
from cdia_pin.app.result_steps import fall, name_of
from cdia_pin.app.session import Session
from cdia_pin.app.suggestions import Suggestion, suggestions
from cdia_pin.effects import EFFECTS
from cdia_pin.viewers import verdict_sentences
from cdia_pin.viewers.words import percent

FIRST = 3  # suggestions that are shown at once, beside all that the search would add


class MissingActions(Protocol):
    """What can be asked of the page."""

    def search(self) -> Any:
        """Look for what is missing."""

    def preview(self, text: str) -> Any:
        """Show what an effect would do."""

    def add(self, text: str) -> Any:
        """Add an effect."""

    def add_found(self) -> Any:
        """Add all that the search would add."""

    def drop_preview(self) -> Any:
        """Forget the preview."""

    def goto(self, at: int) -> Any:
        """Return to a model of the history."""

    def design(self, doubt: Doubt) -> Any:
        """Design a motion that tells two effects apart, and download it."""


def missing_step(session: Session, do: MissingActions, searching: bool) -> None:
    """Show history, suggestions, an effect of one's own, and the next motion."""
    _history(session, do)
    if session.preview is not None:
        _preview(session, do)
    found = session.found
    if found is not None:
        node("p", verdict_sentences(found)[0], "verdict", data_mark="verdict", data_verdict=found.verdict)
        _suggestions(session, do)
    elif searching:
        node("p", "What explains this error? The search is on its way.", "soft")
    else:
        button("Look for what is missing", do.search, mark="search", classes="primary")
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
            button("Leave it", do.drop_preview, mark="drop-preview")


def _suggestions(session: Session, do: MissingActions) -> None:
    assert session.found is not None
    rows = suggestions(session.found)
    chosen = [r for r in rows if r.chosen]
    others = [r for r in rows if not r.chosen]
    if len(chosen) > 1:
        button(f"Add all {len(chosen)} of the search", do.add_found, mark="add-found", classes="primary")
    for row in chosen:
        _row(row, do)
    few = others[: max(FIRST - len(chosen), 0)]
    for row in few:
        _row(row, do)
    if len(others) > len(few):
        with folded(f"{len(others) - len(few)} others that would explain a part of it", mark="others"):
            for row in others[len(few) :]:
                _row(row, do)


def _row(row: Suggestion, do: MissingActions) -> None:
    with node("article", classes="suggestion", data_mark="suggestion", data_effect=row.text):
        with node("header"):
            with node("div"):
                node("b", row.name)
                node("span", f" {row.where}", "soft")
            fall(row.before, row.after)
        if row.chosen:
            node("span", "the search adds it", "chip good")
        if not row.plausible:
            node("span", "held at a bound: not plausible", "chip warn")
        more = f", and {row.more} more" if row.more else ""
        node("p", ", ".join(row.numbers) + more, "numbers")
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
    with folded("Another effect, or one of your own", mark="own"):
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
    """Say what to record next, and offer to design it."""
    rows = doubts(session)
    if not rows:
        return
    with node("div", classes="next-motion", data_mark="next-motion"):
        node("h3", "The next motion to record")
        for k, doubt in enumerate(rows):
            with node("p"):
                node("span", f"To tell {doubt.pair}: ", "soft")
                node("span", doubt.motion + ".")
            if doubt.tellable:
                button(
                    "Design it (.csv)",
                    partial(do.design, doubt),
                    mark=f"design-{k}",
                    label=f"Design a motion: {doubt.pair}",
                )
