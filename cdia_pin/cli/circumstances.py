"""Options that say how an arm stands and works: unusual effects that the user expects."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer

CIRCUMSTANCES = "The arm's circumstances"


class Surroundings(StrEnum):
    """What the arm moves in."""

    AIR = "air"
    WATER = "water"


class Mounting(StrEnum):
    """How the base of the arm stands, beside what the URDF says."""

    UPRIGHT = "upright"
    TILTED = "tilted"


Environment = Annotated[
    Surroundings,
    typer.Option(
        "--environment",
        help="What the arm moves in. In water, drag of the whole arm is an everyday effect.",
        rich_help_panel=CIRCUMSTANCES,
    ),
]
Contact = Annotated[
    bool,
    typer.Option(
        "--contact",
        help="The tool touches something: a steady wrench on it is an everyday effect.",
        rich_help_panel=CIRCUMSTANCES,
    ),
]
Mounted = Annotated[
    Mounting,
    typer.Option(
        "--mounted",
        help="How the base stands beside the URDF. Tilted: gravity in another direction is an everyday effect.",
        rich_help_panel=CIRCUMSTANCES,
    ),
]


def expected_effects(environment: Surroundings, contact: bool, mounted: Mounting) -> tuple[str, ...]:
    """Return the names of the unusual effects that a user expects, for `DiscoverySettings`.

    Args:
        environment: What the arm moves in.
        contact: Whether the tool touches something.
        mounted: How the base stands.
    """
    from cdia_pin.effects import BaseTilt, ToolWrench, ViscousMedium

    expected = {
        ViscousMedium.name: environment is Surroundings.WATER,
        ToolWrench.name: contact,
        BaseTilt.name: mounted is Mounting.TILTED,
    }
    return tuple(name for name, is_expected in expected.items() if is_expected)
