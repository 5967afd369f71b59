"""``cdia robots``: the catalogue of arms, or the joints of one arm."""

from __future__ import annotations

from collections.abc import Iterable
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypedDict

import typer

from cdia_pin import schemas
from cdia_pin.cli.console import stdout
from cdia_pin.cli.failures import CommandError
from cdia_pin.cli.next_command import command_line, show_next
from cdia_pin.cli.options import Json
from cdia_pin.cli.outputs import require_writable, write_json

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray
    from rich.console import Console

    from cdia_pin.robot import RobotModel
    from cdia_pin.robot.catalogue import CatalogueEntry


class RobotEntry(TypedDict):
    """A robot as ``cdia robots --json`` writes it: mass [kg], gravity [m/s²].

    One that is not on this machine has no joints, and no mass.
    """

    name: str
    description: str
    count: int
    joints: list[str]
    source: str
    available: bool
    urdf: str
    tool_frame: str
    mass: float | None
    gravity: NDArray[np.float64] | None
    licence: str
    origin: str
    warnings: list[str]


def robots(
    name: Annotated[
        str | None,
        typer.Argument(metavar="R", show_default=False, help="One of them, or the path of a URDF file."),
    ] = None,
    lock: Annotated[
        list[str] | None,
        typer.Option(
            "--lock",
            metavar="JOINT[=POSITION]",
            show_default=False,
            help="Joints that do not belong to the arm, names or patterns such as head_*, with their position "
            "\\[rad or m]; several with commas or repeated.",
        ),
    ] = None,
    save: Annotated[
        Path | None,
        typer.Option(
            "--save",
            "-s",
            metavar="FILE",
            show_default=False,
            help="Write a URDF of the arm alone, with the joints fixed that do not move; give it to --robot.",
        ),
    ] = None,
    json: Json = None,
) -> None:
    """List the robots of the catalogue; with a name or a URDF file, show its joints and limits.

    A robot with a head, a hand or two arms is not one chain. Lock what does not belong to the arm:

    cdia robots tiago.urdf --lock 'head_*,hand_*' --save arm.urdf
    """
    from cdia_pin.robot import catalogue, load_robot
    from cdia_pin.robot.arm_urdf import write_arm_urdf

    require_writable(json, save)
    console = stdout(json)
    if name is None and (lock or save):
        raise CommandError(
            "--lock and --save need a robot: cdia robots arm.urdf --lock 'head_*' --save arm_alone.urdf"
        )
    if name is not None:
        arm = load_robot(name, lock=_locked(lock or ()))
        entries = [_entry(arm)]
        _show_one(console, arm)
        if save:
            console.print(f"{write_arm_urdf(arm, save)} has the arm alone", markup=False, soft_wrap=True)
    else:
        entries = [
            _entry(load_robot(known)) if entry.available else _not_here(entry)
            for known, entry in catalogue().items()
        ]
        _show_all(console, entries)
    if json:
        write_json({"schema": schemas.ROBOTS, "robots": entries}, json)
    chosen = (
        command_line("check", "LOG", "--robot", save or name)
        if name
        else command_line("robots", entries[0]["name"])
    )
    show_next(console, chosen)


def _locked(given: Iterable[str]) -> dict[str, float | None]:
    """Return the joints to lock with their position, None where none is given."""
    out: dict[str, float | None] = {}
    for part in (p.strip() for text in given for p in text.split(",")):
        joint, states, position = part.partition("=")
        try:
            at = float(position) if states else None
        except ValueError:
            at = float("nan")
        if at is not None and not isfinite(at):
            raise CommandError(f"--lock {part}: the position must be a number [rad or m], joint=0.15")
        out[joint.strip()] = at
    return out


def _entry(robot: RobotModel) -> RobotEntry:
    from cdia_pin.robot import catalogue

    known = catalogue().get(robot.name)
    # a file of the user's may have the name of a known arm, which need not be here
    if known is not None and not (known.available and known.path == robot.urdf):
        known = None
    return {
        "name": robot.name,
        "description": known.description if known else "",
        "count": robot.n,
        "joints": list(robot.joints),
        "source": known.source if known else "file",
        "available": True,
        "urdf": str(robot.urdf),
        "tool_frame": robot.tool_frame,
        "mass": robot.total_mass,
        "gravity": robot.gravity_vector,
        "licence": known.licence if known else "",
        "origin": known.origin if known else "",
        "warnings": list(robot.warnings),
    }


def _not_here(entry: CatalogueEntry) -> RobotEntry:
    """Return a robot that is fetched at its first use."""
    return {
        "name": entry.name,
        "description": entry.description,
        "count": entry.joints or 0,
        "joints": [],
        "source": entry.source,
        "available": False,
        "urdf": "",
        "tool_frame": entry.tool_frame,
        "mass": None,
        "gravity": None,
        "licence": entry.licence,
        "origin": entry.origin,
        "warnings": [],
    }


def _show_all(console: Console, entries: list[RobotEntry]) -> None:
    from rich.text import Text

    from cdia_pin.viewers.whole_table import WholeTable

    table = WholeTable()
    table.add_column("name", style="bold", no_wrap=True)
    table.add_column("joints", justify="right")
    table.add_column("what it is, its licence and where it is from")
    for e in entries:
        where = e["source"] if e["available"] else "fetched at its first use"
        said = Text.assemble(e["description"], (f"\n{e['licence']}; {where}", "dim"))
        table.add_row(Text(e["name"]), str(e["count"]), said)
    console.print(table)
    console.print("--robot takes one of these names, or the path of any fixed-base arm's URDF file.")
    if any(not e["available"] for e in entries):
        console.print(
            'Those that are fetched need pip install "cdia-pin[robots]", git and the network once; then they are kept.',
            markup=False,
        )


def _show_one(console: Console, robot: RobotModel) -> None:
    from rich.text import Text

    from cdia_pin.viewers.whole_table import WholeTable

    entry = _entry(robot)
    console.print(Text(f"{robot.name}: {entry['description'] or 'read from a URDF file'}", style="bold"))
    console.print(Text(f"{robot.total_mass:.4g} kg move; tool frame {robot.tool_frame}", style="dim"))
    if entry["licence"]:
        console.print(
            Text(f"licence {entry['licence']}; from {entry['origin']}", style="dim"), soft_wrap=True
        )
    console.print(Text(str(robot.urdf), style="dim"), soft_wrap=True)
    table = WholeTable()
    table.add_column("joint", style="bold")
    for heading in ("kind", "from", "to", "speed", "effort"):
        table.add_column(heading, justify="left" if heading == "kind" else "right")
    limits = robot.limits
    for j, joint in enumerate(robot.joints):
        kind = "sliding" if robot.is_prismatic[j] else "continuous" if robot.is_continuous[j] else "turning"
        x, effort = ("m", "N") if robot.is_prismatic[j] else ("rad", "N·m")
        units = (x, x, f"{x}/s", effort)
        values = (limits.lower[j], limits.upper[j], limits.velocity[j], limits.effort[j])
        table.add_row(Text(joint), kind, *(_limit(v, u) for v, u in zip(values, units, strict=True)))
    console.print(table)
    for locked, how in list(robot.locked.items())[:8]:
        console.print(Text(f"held: {locked} at {how.position:g} ({how.reason})", style="dim"))
    if len(robot.locked) > 8:
        console.print(Text(f"held: … {len(robot.locked)} joints in all", style="dim"))
    for sentence in robot.warnings:
        console.print(Text(f"warning: {sentence}", style="yellow"))


def _limit(value: float, unit: str) -> str:
    return f"{value:.4g} {unit}" if abs(value) < float("inf") else "not stated"
