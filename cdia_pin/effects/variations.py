"""Variations: the ways in which an effect's parameters can vary, by the names that files give them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from cdia_pin.effects.drift import Drift
from cdia_pin.effects.effect import Effect
from cdia_pin.effects.per_log import PerLog
from cdia_pin.effects.varying import Varying
from cdia_pin.errors import EffectError, unknown_name


def varied(effect: Effect, how: Mapping[str, Any]) -> Varying:
    """Read back what `Varying.variation` wrote; raises EffectError with what is valid.

    Args:
        effect: The plain effect.
        how: What its parameters vary with, as in a file.
    """
    given = dict(how)
    kind = str(given.pop("with", ""))
    kinds: dict[str, type[PerLog] | type[Drift]] = {PerLog.kind: PerLog, Drift.kind: Drift}
    if kind not in kinds:
        raise EffectError(unknown_name("variation", kind, kinds))
    if "logs" in given:
        given["logs"] = tuple(map(str, given["logs"]))
    try:
        return kinds[kind](effect, **given)
    except TypeError:
        wanted = [f.name for f in fields(kinds[kind])][1:]
        raise EffectError(
            f"{effect.label}: what varies with {kind} takes {', '.join(wanted)}; given {', '.join(given) or 'none'}"
        ) from None
