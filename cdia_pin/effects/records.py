"""Records: effects and terms as files hold them."""

from __future__ import annotations

from typing import Any, NotRequired, TypedDict


class EffectRecord(TypedDict):
    """An effect in a file; `cdia_pin.effects.effect_from_dict` reads it.

    Attributes:
        effect: Its name.
        joints: Names of its joints.
        shape: Its shape parameters by name, where it has any.
        varies: How its parameters vary, where they do.
    """

    effect: str
    joints: list[str]
    shape: NotRequired[dict[str, Any]]
    varies: NotRequired[dict[str, Any]]


class ParameterRecord(TypedDict):
    """A parameter in a file, in its unit; the 95 % interval where it was estimated.

    Attributes:
        value: The number.
        unit: Its unit.
        ci95: 95 % interval, statistical and systematic together.
        ci95_statistical: The statistical part alone, where the two were told apart.
    """

    value: float
    unit: str
    ci95: NotRequired[list[float]]
    ci95_statistical: NotRequired[list[float]]


class TermRecord(EffectRecord):
    """A term in a file: an effect, its parameters by name, and its profile; `Term.from_dict` reads it."""

    parameters: dict[str, ParameterRecord]
    profile: dict[str, Any]
