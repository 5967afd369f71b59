"""What a file holds of a model, and what it lacks, as lines and as JSON."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from cdia_pin.dynamics import Dynamics
    from cdia_pin.dynamics.simulator_values import SimulatorValues
    from cdia_pin.effects import Term
    from cdia_pin.robot import RobotModel

IN, OUT = "in the ", "not in the "
SHOWN = 0.01  # share of a term's largest torque [1] below which a joint is not named
TORQUES = "The torques are RMS over the motion that the model remembers."
NO_MOTION = "The torque of what is not in a file is unknown: the model remembers no motion. One of cdia discover does."


def show_contents(
    console: Console, title: str, values: SimulatorValues, model: Dynamics
) -> dict[str, object]:
    """Print which terms a file holds, and which it lacks with their torque, and return the same for JSON.

    Args:
        console: Where.
        title: Name of the file's format.
        values: What it holds.
        model: The model.
    """
    from cdia_pin.exports import torque_left_out

    torque = torque_left_out(values, model)
    console.print(_grid(_lines(title, values, torque, model.robot)))
    return {
        "written": values.written,
        "approximated": values.approximated,
        "left_out": values.left_out,
        "lacking_rms": torque,
    }


def show_least_bodies(console: Console, unknown: Sequence[Term], model: Dynamics) -> None:
    """Print which bodies of a file are the least that give the torque, because no motion shows their mass.

    Args:
        console: Where.
        unknown: The terms as they were fitted.
        model: The model with the least bodies.
    """
    from cdia_pin.viewers.words import number

    for term in unknown:
        mass, least = term.theta[0], model.find(term.label).theta[0]
        low, high = term.ci95[0] if term.ci95 else (mass, mass)
        console.print(
            f"The motion does not show the mass of {term.label} ({number(low, 2)} to {number(high, 2)} kg). Files hold "
            f"the least change that gives the same torque: {number(least, 2)} kg in place of {number(mass, 2)} kg.\n",
            markup=False,
        )


def show_ranges(console: Console, model: Dynamics) -> dict[str, object]:
    """Print how many parameters have an interval, and which terms have none, and return the terms for JSON.

    Args:
        console: Where.
        model: The model.
    """
    size = sum(t.effect.size for t in model.terms if t.ci95 is not None)
    without = [t.label for t in model.terms if t.ci95 is None]
    rows = [(IN + "ranges", f"{size} parameters of {len(model.terms) - len(without)} terms")]
    if without:
        rows.append((OUT + "ranges", f"{', '.join(without)}: nobody estimated an interval"))
    console.print(_grid(rows))
    return {"without_interval": without}


def _grid(rows: Iterable[tuple[str, str]]) -> Table:
    from rich.table import Table

    from cdia_pin.viewers.cells import clean

    grid = Table.grid(padding=(0, 2))
    grid.add_column(no_wrap=True)
    grid.add_column()
    for head, line in rows:
        grid.add_row(head, clean(line))
    return grid


def _lines(
    title: str, values: SimulatorValues, torque: Mapping[str, Mapping[str, float]], robot: RobotModel
) -> Iterator[tuple[str, str]]:
    if values.written:
        yield IN + title, ", ".join(values.written)
    for label, how in values.approximated.items():
        lacking = _torque_words(torque.get(label, {}), robot)
        yield IN + title, f"{label}: {how}" + (lacking and f"; it lacks {lacking}")
    by_reason: dict[str, list[str]] = {}
    for label, why in values.left_out.items():
        lacking = _torque_words(torque.get(label, {}), robot)
        by_reason.setdefault(why, []).append(label + (lacking and f" ({lacking})"))
    for why, labels in by_reason.items():
        yield OUT + title, f"{', '.join(labels)}: {why}"


def _torque_words(rms: Mapping[str, float], robot: RobotModel) -> str:
    """Return ``2.1 N·m on elbow_joint`` for the joints that count, empty if nothing is known."""
    from cdia_pin.viewers.words import joint_units, listed, number, with_unit

    least = SHOWN * max(rms.values(), default=0.0)
    shown = [
        f"{with_unit(number(v, 2), joint_units(robot, j)['load'])} on {j}"
        for j, v in rms.items()
        if v > least
    ]
    return listed(shown) or ("no torque" if rms else "")
