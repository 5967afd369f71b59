"""``cdia effects``: the vocabulary, with equations and units."""

from __future__ import annotations

import inspect
import itertools
import re
from typing import TYPE_CHECKING, Annotated, TypedDict

import typer

from cdia_pin import schemas
from cdia_pin.cli.console import stdout
from cdia_pin.cli.next_command import command_line, show_next
from cdia_pin.cli.options import Json
from cdia_pin.cli.outputs import require_writable, write_json

if TYPE_CHECKING:
    from rich.console import Console

    from cdia_pin.effects import Effect

EXAMPLE_ROBOT = "scara"  # ships; has turning and sliding joints, whose units differ
OWN = "sin(3*q)*dq"  # an expression, which is written in the place of a name


class ParameterEntry(TypedDict):
    """A parameter of an effect, with its bounds and its units on a turning and on a sliding joint."""

    name: str
    unit: str
    unit_sliding: str
    lower: float
    upper: float
    bounded_by_robot: bool


class EffectEntry(TypedDict):
    """An effect as ``cdia effects --json`` writes it."""

    effect: str
    equation: str
    scope: list[str]
    write: str
    parameters: list[ParameterEntry]
    shape: list[str]
    dissipative: bool
    says: str


def effects(
    name: Annotated[
        str | None, typer.Argument(metavar="EFFECT", show_default=False, help="One of them.")
    ] = None,
    json: Json = None,
) -> None:
    """List the effects that can be found, added and simulated; with a name, everything about one."""
    from cdia_pin.effects import EFFECTS
    from cdia_pin.errors import EffectError, unknown_name

    require_writable(json)
    if name is not None and name not in EFFECTS:
        raise EffectError(unknown_name("effect", name, EFFECTS))
    chosen = [name] if name else list(EFFECTS)
    entries = [describe(EFFECTS[n]) for n in chosen]
    console = stdout(json)
    if name:
        _show_one(console, entries[0])
    else:
        _show_all(console, entries)
    if json:
        write_json({"schema": schemas.EFFECTS, "effects": entries}, json)
    following = (
        ("add", entries[0]["write"], "LOG", "--robot", "R") if name else ("effects", entries[0]["effect"])
    )
    show_next(console, command_line(*following))


def describe(kind: type[Effect]) -> EffectEntry:
    """Return everything about an effect, with its units on a turning and on a sliding joint.

    Args:
        kind: Class of the effect.
    """
    from cdia_pin.effects import Expression
    from cdia_pin.robot import load_robot

    robot = load_robot(EXAMPLE_ROBOT)
    turning = [j for j, slides in zip(robot.joints, robot.is_prismatic, strict=True) if not slides]
    sliding = [j for j in robot.joints if j not in turning]
    size = len(kind.scope_fields)
    effect = kind.from_scope(turning[:size], {})
    slid = kind.from_scope((sliding + turning)[:size], {})
    rows = zip(effect.parameters, effect.units(robot), slid.units(robot), *effect.bounds(robot), strict=True)
    return {
        "effect": kind.name,
        "equation": kind.equation,
        "scope": list(kind.scope_fields),
        "write": (OWN if kind is Expression else kind.name)
        + ("@" + "+".join(["JOINT"] * size) if size else ""),
        "parameters": [
            {
                "name": p.name,
                "unit": unit,
                "unit_sliding": unit_sliding,
                "lower": p.lower,
                "upper": p.upper,
                "bounded_by_robot": (low, high) != (p.lower, p.upper),
            }
            for p, unit, unit_sliding, low, high in rows
        ],
        "shape": [p.name for p in kind.shape],
        "dissipative": effect.traits.dissipative,
        "says": _first_paragraphs(kind),
    }


def _first_paragraphs(kind: type[Effect]) -> str:
    """The docstring up to its sections, a line a paragraph, without its markup."""
    from cdia_pin.effects.expression import FUNCTIONS

    text = re.split(r"\n\n(?:Attributes|Args):", inspect.cleandoc(kind.__doc__ or ""))[0]
    text = "\n".join(" ".join(paragraph.split()) for paragraph in text.split("\n\n"))
    return text.replace("of `FUNCTIONS`", ", ".join(FUNCTIONS)).replace("`", "")


def _show_all(console: Console, entries: list[EffectEntry]) -> None:
    from rich.text import Text

    from cdia_pin.viewers.whole_table import WholeTable

    table = WholeTable()
    table.add_column("effect", style="bold", no_wrap=True)
    table.add_column("torque it adds")
    table.add_column("parameters")
    for e in entries:
        table.add_row(Text(e["effect"]), Text(e["equation"]), Text(_brief(e["parameters"])))
    console.print(Text("M q̈ + nle = τ + f;  f of each effect:"))
    console.print(table)
    console.print(
        Text(f"On a sliding joint read N for N·m and m for rad. Your own: cdia discover --extra '{OWN}'")
    )


def _brief(parameters: list[ParameterEntry]) -> str:
    """Parameters with units, those of one unit together, counted ones as a range."""
    groups = []
    for unit, group in itertools.groupby(parameters, key=lambda p: p["unit"]):
        names = [str(p["name"]) for p in group]
        if len(names) > 4:
            names = [f"{names[0]} to {names[-1]}"]
        groups.append(f"{', '.join(names)} [{unit}]")
    return ", ".join(groups)


def _show_one(console: Console, entry: EffectEntry) -> None:
    from rich.text import Text

    from cdia_pin.viewers.whole_table import WholeTable

    console.print(Text(entry["effect"], style="bold"))
    console.print(Text(entry["says"]))
    console.print()
    console.print(Text(f"f = {entry['equation']}"))
    console.print(Text(f"written {entry['write']}", style="dim"))
    table = WholeTable()
    for heading in ("parameter", "unit", "on a sliding joint", "from", "to"):
        table.add_column(heading, style="bold" if heading == "parameter" else None)
    for p in entry["parameters"]:
        ends = ["any" if abs(x) == float("inf") else f"{x:.4g}" for x in (p["lower"], p["upper"])]
        if p["bounded_by_robot"]:
            ends[0] = "the robot's"
        table.add_row(Text(p["name"]), Text(p["unit"]), Text(p["unit_sliding"]), *ends)
    console.print(table)
    if entry["shape"]:
        console.print(Text(f"shape, searched for: {', '.join(entry['shape'])}"))
