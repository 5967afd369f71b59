"""Terms as people type them: ``coulomb_friction@elbow_joint: level=5, after=4``."""

from __future__ import annotations

from cdia_pin.effects.effect import Effect
from cdia_pin.effects.profile import ALWAYS, Between, Incipient, Intermittent, Profile, Region
from cdia_pin.effects.term import Term
from cdia_pin.effects.vocabulary import parse_effect
from cdia_pin.errors import EffectError
from cdia_pin.robot.model import RobotModel

REGION_KEYS = {"q": "position", "dq": "velocity", "speed": "speed", "tau": "effort"}
MOMENTS = ("after", "until")
TIME_KEYS = (*MOMENTS, "rate", "period", "duty")
LATEST = 1e10  # [s], 300 years; a time of day in Unix seconds is below it
KINDS = "after and until; after and rate; after, period and duty; or one of " + ", ".join(REGION_KEYS)


def parse_term(text: str, robot: RobotModel | None = None) -> Term:
    """Read ``EFFECT[@JOINT]: name=value, …`` with parameters, shape and profile.

    Profile keys are after, until [s]; rate [1/s] (incipient); period [s] and duty (intermittent); and regions
    q, dq, speed, tau as ``LOWER..UPPER`` with either end left out. A key that is a parameter of the effect is
    that parameter.

    Args:
        text: The term.
        robot: Checks the joint names, if given.

    Raises:
        EffectError: If a name or number is not valid.
        RobotError: If a joint is not of the robot.
    """
    label, _, rest = text.partition(":")
    pairs: dict[str, str] = {}
    for item in filter(None, (part.strip() for part in rest.split(","))):
        key, equals, value = (part.strip() for part in item.partition("="))
        if not (key and equals and value):
            raise EffectError(f"'{item}' in '{text}' is not of the form name=value")
        if key in pairs:
            raise EffectError(f"'{text}' gives {key} twice")
        pairs[key] = value
    effect = parse_effect(label, robot)
    shape = {p.name: _number(pairs.pop(p.name), text) for p in effect.shape if p.name in pairs}
    effect = effect.with_shape(**shape) if shape else effect
    values = {p.name: _number(pairs.pop(p.name), text) for p in effect.parameters if p.name in pairs}
    profile_keys = {k: pairs.pop(k) for k in (*TIME_KEYS, *REGION_KEYS) if k in pairs}
    if pairs:
        valid = [
            *(p.name for p in effect.parameters),
            *(p.name for p in effect.shape),
            *TIME_KEYS,
            *REGION_KEYS,
        ]
        raise EffectError(f"{effect.label} takes {', '.join(valid)}; given {', '.join(pairs)} in '{text}'")
    return Term.of(effect, parse_profile(profile_keys, effect, text), **values)


def parse_profile(keys: dict[str, str], effect: Effect, text: str) -> Profile:
    """Return the profile that the keys describe; they must all belong to one kind.

    Args:
        keys: What is written for each key of a profile.
        effect: Whose profile it is; a region is one of its joint.
        text: The whole term, for messages.
    """
    if not keys:
        return ALWAYS
    given = set(keys)
    if len(given) == 1 and given <= set(REGION_KEYS):
        return _region(*keys.popitem(), effect, text)
    times = {k: _number(v, text) for k, v in keys.items() if k in TIME_KEYS}
    for key, value in times.items():
        least = 0.0 if key in MOMENTS else -float("inf")  # a profile refuses the others itself
        if not least <= value <= LATEST:
            raise EffectError(f"'{text}': {key} is 0 to {LATEST:g}, given {keys[key]}")
    if given <= {"after", "until"}:
        return Between(times.get("after", -float("inf")), times.get("until", float("inf")))
    start = times.get("after", 0.0)
    if "rate" in given and given <= {"after", "rate"}:
        return Incipient(start, times["rate"])
    if "period" in given and given <= {"after", "period", "duty"}:
        return Intermittent(start, times["period"], times.get("duty", 0.5))
    raise EffectError(f"'{text}': {', '.join(keys)} do not make a profile; it takes {KINDS}")


def _region(key: str, span: str, effect: Effect, text: str) -> Region:
    if not effect.scope:
        raise EffectError(f"'{text}': a region needs an effect of one joint")
    lower, dots, upper = (part.strip() for part in span.partition(".."))
    if not dots or not (lower or upper):
        raise EffectError(f"'{text}': a region is written {key}=LOWER..UPPER")
    ends = {k: _number(v, text) for k, v in (("lower", lower), ("upper", upper)) if v}
    return Region(effect.scope[0], REGION_KEYS[key], **ends)


def _number(text: str, whole: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise EffectError(f"'{text}' in '{whole}' is not a number") from None
