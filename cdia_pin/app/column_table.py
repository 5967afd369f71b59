"""The table of columns in the form: which columns of a log hold which signal, chosen from what they look like."""

from __future__ import annotations

from collections.abc import Iterator

from cdia_pin.app.load_desk import LoadDesk
from cdia_pin.app.parts import node
from cdia_pin.logs.formats.guess import ColumnGuess
from cdia_pin.logs.formats.patterns import TIME

SIGNALS = {
    TIME: "time",
    "position": "positions",
    "velocity": "velocities",
    "effort": "torques",
    "current": "motor currents",
    "temperature": "temperatures",
}  # as the table names them
NONE = "by name, or none"  # said of a signal for which no columns are chosen


def column_table(desk: LoadDesk) -> None:
    """Show a row for each signal, where columns have unknown names; what is chosen stays in the form.

    Args:
        desk: Whose form is filled.
    """
    guesses = desk.columns.guesses if desk.columns is not None else ()
    if not guesses and not any(desk.form.columns.values()):
        return
    if guesses:
        node(
            "p",
            "The columns are proposed by what they look like: look at them before you press Load. "
            "# stands for the number of a joint, * for its name.",
            data_mark="proposed-columns",
        )
    with node("div", classes="scroll"), node("table", classes="mapping columns"):
        with node("thead"), node("tr"):
            node("th", "signal")
            node("th", "columns of the log")
        with node("tbody"):
            for signal, name in SIGNALS.items():
                with node("tr"):
                    node("td", name)
                    with node("td"):
                        _choice(desk, signal, guesses)


def _choice(desk: LoadDesk, signal: str, guesses: tuple[ColumnGuess, ...]) -> None:
    chosen = desk.form.columns.get(signal, "")
    box = node("select", aria_label=f"columns of {SIGNALS[signal]}", data_mark=f"columns-{signal}")
    with box:
        for pattern, said in _options(chosen, guesses):
            option = node("option", said, value=pattern)
            if pattern == chosen:
                option.props["selected"] = True
    box.on(
        "change",
        lambda event: desk.form.columns.update({signal: event.args}),
        js_handler="(event) => emit(event.target.value)",
    )


def _options(chosen: str, guesses: tuple[ColumnGuess, ...]) -> Iterator[tuple[str, str]]:
    """Yield patterns with what is said of them; the one that is chosen is among them."""
    yield "", NONE
    if chosen not in {"", *(g.pattern for g in guesses)}:
        yield chosen, chosen
    for guess in guesses:
        yield guess.pattern, f"{guess.pattern}: {guess.lowest:.3g} to {guess.highest:.3g}, {guess.said}"
