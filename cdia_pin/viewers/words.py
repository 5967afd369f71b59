"""Words and numbers that the terminal and the pages share: one wording for one result."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from cdia_pin.discovery.comparison import signal_units
from cdia_pin.effects import Always, Between, Incipient, Intermittent, Region, Varying
from cdia_pin.identifiability.distinguishing_motions import NO_MOTION
from cdia_pin.phrases import NO_BREAK

if TYPE_CHECKING:
    from cdia_pin.discovery.comparison import ResidualRegion
    from cdia_pin.effects import Effect, Term
    from cdia_pin.identifiability import Confusion
    from cdia_pin.robot.model import RobotModel

VARYING = {"log": "per log", "time": "(drifting)"}
MOST_JOINTS = 2  # that are named; of more, only their number is said


# ------------------------------------------------------------------ numbers

NOTICEABLE = 0.99  # [1], of an error, above which it has not fallen


def number(value: float, digits: int = 3) -> str:
    """Return a number as text, with a power of ten only where it is tiny or huge.

    Args:
        value: The number.
        digits: Significant digits.
    """
    if value == 0 or not math.isfinite(value):
        return f"{value:g}".replace("-", "−")
    power = math.floor(math.log10(abs(value)))
    text = f"{value:.{digits - 1}e}" if not -4 <= power < 7 else f"{value:.{max(digits - 1 - power, 0)}f}"
    return text.replace("-", "−")


def percent(share: float) -> str:
    """Return a share as ``97 %``, ``4.6 %`` or ``0.92 %``.

    Args:
        share: The share [1].
    """
    if not math.isfinite(share):
        return "–"
    value = 100 * share
    if 0 < value < 0.005:
        return f"<0.01{NO_BREAK}%"
    return f"{value:.{0 if value >= 9.95 else 1 if value >= 0.995 else 2}f}{NO_BREAK}%"


def course_words(before: float, after: float) -> str:
    """Return ``falls from 12 % to 3.4 %``, ``stays at 12 %`` or ``rises from 12 % to 14 %``.

    Args:
        before: A share [1].
        after: The same later [1].
    """
    if NOTICEABLE * before <= after <= before / NOTICEABLE:
        return f"stays at {percent(after)}"
    return f"{'falls' if after < before else 'rises'} from {percent(before)} to {percent(after)}"


def with_interval(value: float, interval: tuple[float, float] | None, unit: str) -> str:
    """Return ``4.10 ± 0.21 N·m``, with the digits that the interval leaves; the unit 1 is not written.

    Args:
        value: An estimate.
        interval: Its lower and upper end, None where there is none.
        unit: Its unit.
    """
    lower, upper = interval or (value, value)
    half = (upper - lower) / 2
    if not (math.isfinite(half) and half > 1e-9 * abs(value)):
        return with_unit(number(value), unit)
    places = _places(half)

    def fixed(x: float) -> str:
        return (f"{round(x, places) + 0.0:.{places}f}" if places <= 6 else f"{x:.2e}").replace("-", "−")

    if abs((lower + upper) / 2 - value) > 0.1 * half:
        return with_unit(f"{fixed(value)} [{fixed(lower)}, {fixed(upper)}]", unit)
    return with_unit(f"{fixed(value)} ± {fixed(half)}", unit)


def with_sign(text: str, value: float) -> str:
    """Return a difference with its sign, also where it is positive.

    Args:
        text: The difference in words.
        value: The difference.
    """
    return f"+{text}" if value > 0 else text


def half_widths(*widths: float) -> tuple[str, ...]:
    """Return half widths of intervals with the same decimals, two digits of the widest.

    Args:
        *widths: Positive numbers of one unit.
    """
    widest = max(widths)
    if not (math.isfinite(widest) and widest > 0):
        return tuple(number(w, 2) for w in widths)
    places = _places(widest)
    return tuple(f"{w:.{places}f}" if places <= 6 else f"{w:.1e}".replace("-", "−") for w in widths)


def _places(width: float) -> int:
    """Return the decimals that leave two digits of a width."""
    return max(1 - math.floor(math.log10(float(f"{width:.1e}"))), 0)


def with_unit(text: str, unit: str) -> str:
    """Return a number with its unit.

    Args:
        text: The number.
        unit: Its unit; 1 is not written.
    """
    return text if unit == "1" else f"{text}{NO_BREAK}{unit}"


def advice_words(motion: str) -> str:
    """Return what to drive to distinguish two explanations, or that no motion does, as the end of a sentence.

    Args:
        motion: Of a confusion.
    """
    return motion if motion.startswith(NO_MOTION) else f"to distinguish them, {motion}"


def sentence_case(text: str) -> str:
    """Return a text whose first letter is a capital.

    Args:
        text: Not empty.
    """
    return text[0].upper() + text[1:]


def region_words(region: ResidualRegion) -> str:
    """Return ``velocity in [−0.10, 0.10] rad/s``, with enough digits to distinguish the ends.

    Args:
        region: Of a comparison.
    """
    width = abs(region.upper - region.lower)
    places = _places(width) if width > 0 else 3
    ends = (f"{round(x, places) + 0.0:.{places}f}".replace("-", "−") for x in (region.lower, region.upper))
    return f"{region.signal} in [{f',{NO_BREAK}'.join(ends)}]{NO_BREAK}{region.unit}"


# ------------------------------------------------------------------ names


def joint_units(robot: RobotModel, joint: str) -> dict[str, str]:
    """Return the unit of each signal of a joint: position, velocity, acceleration, load and time.

    Args:
        robot: The arm.
        joint: Name of the joint.
    """
    return signal_units(bool(robot.is_prismatic[robot.joint_index(joint)]))


def short_names(joints: Sequence[str]) -> dict[str, str]:
    """Return names without the words that all of them begin or end with, such as ``panda_``, ``wam/`` or ``_joint``.

    A bare number is no name: what all begin with stays before it.

    Args:
        joints: Names.

    Returns:
        Full name → short name.
    """
    words = [re.findall(r"[^_/]*[_/]?", j)[:-1] for j in joints]
    first = last = 0
    if len(joints) > 1:
        most = min(map(len, words)) - 1
        while first < most and len({w[first] for w in words}) == 1:
            first += 1
        while last < most - first and len({w[-1 - last] for w in words}) == 1:
            last += 1
        if first and any("".join(w[first : len(w) - last]).rstrip("_/").isdecimal() for w in words):
            first -= 1
    short = ["".join(w[first : len(w) - last]) for w in words]
    short = [s.rstrip("_/") for s in short] if last else short
    return dict(zip(joints, short if all(short) and len(set(short)) == len(joints) else joints, strict=True))


def effect_name(effect: Effect) -> str:
    """Return ``coulomb friction`` for the effect of that name; a user's expression stays as it is written.

    Args:
        effect: The effect.
    """
    if isinstance(effect, Varying):
        return f"{effect_name(effect.effect)} {VARYING[effect.kind]}"
    name = effect.label.partition("@")[0]
    return name.replace("_", " ") if name.isidentifier() else name


def effect_words(effect: Effect) -> str:
    """Return ``coulomb friction on elbow_joint``, or ``payload`` for an effect of the whole arm.

    Args:
        effect: The effect.
    """
    return effect_name(effect) + (f" on {joints_words(effect.scope)}" if effect.scope else "")


def joints_words(joints: Sequence[str]) -> str:
    """Return the names of one joint or two, or how many there are."""
    return listed(joints) if len(joints) <= MOST_JOINTS else f"{len(joints)} joints"


def where_words(effect: Effect) -> str:
    """Return the joints of an effect, or that it is one of the whole arm."""
    return joints_words(effect.scope) or "the whole arm"


def parameter_name(name: str) -> str:
    """Return ``coefficient positive`` for the parameter of that name; the log that it belongs to stays as it is."""
    word, bracket, log = name.partition("[")
    return word.replace("_", " ") + bracket + log


def confusion_words(confusion: Confusion) -> str:
    """Return the other explanation, ``load friction on elbow_joint``."""
    return " with ".join(effect_words(e) for e in confusion.effects)


def profile_words(term: Term) -> str:
    """Return when or where a term is present, in words; empty if it always is.

    Args:
        term: An effect with numbers.
    """
    match term.profile:
        case Always():
            return ""
        case Between(start=start, end=end):
            return _ends(start, end, "from {} s on", "until {} s", "from {} s to {} s")
        case Region(joint=joint, signal=signal, lower=lower, upper=upper):
            where = _ends(lower, upper, "above {}", "below {}", "from {} to {}")
            return f"where the {signal} of {joint} is {where}"
        case Incipient(start=start, rate=rate):
            return f"growing from {number(start)} s on, with a time constant of {number(1 / rate)} s"
        case Intermittent(start=start, period=period, duty=duty):
            return f"from {number(start)} s on, in the first {percent(duty)} of every {number(period)} s"
        case other:
            given = other.to_dict()
            return f"{given.pop('kind')} ({', '.join(f'{k} {v}' for k, v in given.items())})"


def _ends(lower: float, upper: float, above: str, below: str, between: str) -> str:
    """Return the end of a range that is open, or both ends."""
    if math.isinf(upper):
        return above.format(number(lower))
    return below.format(number(upper)) if math.isinf(lower) else between.format(number(lower), number(upper))


def few(items: Iterable[str], most: int = 4) -> list[str]:
    """Return the first names, and how many more there are.

    Args:
        items: Names; repeated ones count once.
        most: Names to return.
    """
    names = list(dict.fromkeys(items))
    return names if len(names) <= most else [*names[:most], f"{len(names) - most} more"]


def listed(items: Iterable[str]) -> str:
    """Return ``a``, ``a and b`` or ``a, b and c``."""
    names = list(items)
    return " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)
