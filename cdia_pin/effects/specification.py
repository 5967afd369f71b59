"""Terms as people type them: ``coulomb_friction@elbow_joint: level=5, after=4``."""

from __future__ import annotations

from cdia_pin.effects.effect import Effect
from cdia_pin.effects.profile import ALWAYS, Between, Incipient, Intermittent, Profile, Region
from cdia_pin.effects.term import Term
from cdia_pin.errors import EffectError

REGION_KEYS = {"q": "position", "dq": "velocity", "speed": "speed", "tau": "effort"}
TIME_KEYS = ("after", "until", "rate", "period", "duty")


def parse_term(text: str) -> Term:
    """Read ``EFFECT[@JOINT]: name=value, …`` with parameters, shape and profile.

    Profile keys are after, until [s]; rate [1/s] (incipient); period [s] and duty (intermittent); and regions
    q, dq, speed, tau as ``LOWER..UPPER`` with either end left out.

    Raises:
        EffectError: If a name or number is not valid.
    """
    from cdia_pin.effects import parse_effect

    label, _, rest = text.partition(":")
    pairs: dict[str, str] = {}
    for item in filter(None, (part.strip() for part in rest.split(","))):
        key, equals, value = item.partition("=")
        if not equals:
            raise EffectError(f"'{item}' in '{text}' is not of the form name=value")
        pairs[key.strip()] = value.strip()
    profile_keys = {k: pairs.pop(k) for k in (*TIME_KEYS, *REGION_KEYS) if k in pairs}
    effect = parse_effect(label)
    shape = {p.name: _number(pairs.pop(p.name), text) for p in effect.shape if p.name in pairs}
    effect = effect.with_shape(**shape) if shape else effect
    values = {k: _number(v, text) for k, v in pairs.items()}
    return Term.of(effect, parse_profile(profile_keys, effect, text), **values)


def parse_profile(keys: dict[str, str], effect: Effect, text: str) -> Profile:
    """Return the profile that the keys describe; they must all belong to one kind."""
    if not keys:
        return ALWAYS
    times = {k: _number(v, text) for k, v in keys.items() if k in TIME_KEYS}
    regions = {k: v for k, v in keys.items() if k in REGION_KEYS}
    if len(regions) > 1 or (regions and times):
        raise EffectError(f"'{text}': a profile is either one region or a stretch of time")
    if regions:
        key, span = next(iter(regions.items()))
        if not effect.scope:
            raise EffectError(f"'{text}': a region needs an effect of one joint")
        lower, dots, upper = span.partition("..")
        if not dots:
            raise EffectError(f"'{text}': a region is written {key}=LOWER..UPPER")
        ends = {k: _number(v, text) for k, v in (("lower", lower), ("upper", upper)) if v}
        return Region(effect.scope[0], REGION_KEYS[key], **ends)
    start = times.get("after", 0.0)
    if "rate" in times:
        return Incipient(start, times["rate"])
    if "period" in times:
        return Intermittent(start, times["period"], times.get("duty", 0.5))
    return Between(times.get("after", -float("inf")), times.get("until", float("inf")))


def _number(text: str, whole: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise EffectError(f"'{text}' in '{whole}' is not a number") from None
