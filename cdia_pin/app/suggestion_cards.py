"""The suggestions of a search: groups and cards of effects, the tail folded."""

from __future__ import annotations

from cdia_pin.app.parts import button, folded, node
from cdia_pin.app.result_steps import fall
from cdia_pin.app.suggestions import Suggestion, suggestions
from cdia_pin.app.workbench import Workbench
from cdia_pin.changes.confidence import Confidence
from cdia_pin.discovery import Discovery
from cdia_pin.viewers.effect_groups import EffectGroup, effect_groups, term_of
from cdia_pin.viewers.parameter_rows import group_numbers

CHIPS = {Confidence.ESTABLISHED: "good", Confidence.LIKELY: "warn", Confidence.DESCRIPTIVE: "plain"}
MEANING = {
    Confidence.ESTABLISHED: "found again in both halves of the log, at other cut-offs and with links that are wrong",
    Confidence.LIKELY: "found again in most repeats of the search",
    Confidence.DESCRIPTIVE: "lowers the error, and may be something else",
}
FIRST = 3  # suggestions that are not folded; those of the search never are


def suggestion_cards(found: Discovery, bench: Workbench) -> None:
    """Show what a search would add, in groups as `discover` has them, then what else would lower the error.

    Args:
        found: The outcome of the search.
        bench: Takes the steps.
    """
    rows = suggestions(found)
    chosen = {r.text: r for r in rows if r.chosen}
    others = [r for r in rows if not r.chosen]
    if len(chosen) > 1:
        button(
            f"Add all {len(chosen)} found by the search", bench.add_found, mark="add-found", classes="primary"
        )
    groups = effect_groups(found)
    for group in groups:
        if group.confidence is not Confidence.DESCRIPTIVE:
            _group(group, [chosen[term_of(s).label] for s in group.steps], found, bench)
    tail = [g for g in groups if g.confidence is Confidence.DESCRIPTIVE]
    if tail:
        names = ", ".join(g.words(found.model.robot.joints) for g in tail)
        with folded(f"only descriptive: {names}", mark="descriptive"):
            node("p", "They lower the error, and may be something else.", "soft")
            for row in (chosen[term_of(s).label] for g in tail for s in g.steps):
                _row(row, bench, marked=False)
    few = others[: max(FIRST - len(chosen), 0)]
    for row in few:
        _row(row, bench)
    if len(others) > len(few):
        with folded(f"{len(others) - len(few)} others that explain part of the error", mark="others"):
            for row in others[len(few) :]:
                _row(row, bench)


def _group(group: EffectGroup, rows: list[Suggestion], found: Discovery, bench: Workbench) -> None:
    """Show effects of one kind: one as a card, several as a card that opens to them."""
    if len(rows) == 1:
        _row(rows[0], bench)
        return
    with node("article", classes="suggestion", data_mark="group", data_confidence=str(group.confidence)):
        node("b", group.words(found.model.robot.joints))
        confidence_chip(group.confidence)
        numbers = group_numbers(group, found.model.robot)
        if numbers:
            node("p", numbers, "numbers")
        with folded(f"the {len(rows)} effects", mark="members"):
            for row in rows:
                _row(row, bench, marked=False)


def confidence_chip(confidence: Confidence) -> None:
    """Show how far the name of an effect can be trusted.

    Args:
        confidence: Of the effect.
    """
    node("span", str(confidence), f"chip {CHIPS[confidence]}", title=MEANING[confidence])


def _row(row: Suggestion, bench: Workbench, *, marked: bool = True) -> None:
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
                confidence_chip(row.confidence)
        more = f", and {row.more} more" if row.more else ""
        node("p", ", ".join(row.numbers) + more, "numbers", title=row.parts)
        if row.confusions:
            with folded(f"could also be {_few([w for w, _ in row.confusions])}", mark="confusions"):
                for words, motion in row.confusions:
                    node("p", f"{words}: {motion}")
        with node("div", classes="actions"):
            what = f"{row.name} {row.where}"
            button(
                "Preview",
                lambda: bench.preview(row.text),
                mark=f"preview-{row.text}",
                label=f"Preview {what}",
            )
            button("Add", lambda: bench.add(row.text), mark=f"add-{row.text}", label=f"Add {what}")


def _few(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"{names[0]}, or {len(names) - 1} more"
