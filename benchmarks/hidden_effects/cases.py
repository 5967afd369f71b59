"""Every case of the benchmark, by suite."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import product
from zlib import crc32

import numpy as np

from benchmarks.hidden_effects.case import BETWEEN_POINTS, ENCODERS, GOOD, NOISES, POOR, Case
from benchmarks.plant.scenarios import OUTSIDE_PARAMETERS, PARAMETERS

ARMS = ("ur5", "panda", "kinova", "z1")
LIGHT_WRISTS = ("z1", "xarm7")  # steps of the encoder make torque of the size of a wrist's own
EVERY_ARM = tuple(dict.fromkeys((*ARMS, *LIGHT_WRISTS)))
SMALL, LARGE = (0.05, 0.1), (0.3, 0.5)  # shares of a joint's torque
SIZES = (SMALL[0], LARGE[0], SMALL[1], LARGE[1])
VOCABULARY, OUTSIDE = tuple(PARAMETERS), tuple(OUTSIDE_PARAMETERS)
OF_A_JOINT = (  # what can be told from links that are a little wrong
    "coulomb_friction",
    "viscous_friction",
    "stribeck_friction",
    "asymmetric_friction",
    "quadratic_friction",
    "load_friction",
    "position_ripple",
    "actuator_gain",
    "torque_offset",
    "rotor_inertia",
    "joint_spring",
)
ALIKE = {  # motions, and effects that are much like others on them
    "one posture": (
        "torque_offset",
        "joint_spring",
        "actuator_gain",
        "encoder_offset",
        "position_ripple",
        "base_tilt",
        "tool_wrench",
        "payload",
        "link_inertia",
    ),
    "one way": (
        "coulomb_friction",
        "viscous_friction",
        "quadratic_friction",
        "stribeck_friction",
        "asymmetric_friction",
        "torque_offset",
    ),
}
ERRORS = (0.03, 0.05)  # of the links [1]
VISIBLE = (0.2, 0.5)  # shares beside such errors
PAIRS, TRIPLES, CLEAN = 18, 12, 10  # of each arm; clean ones with each noise
SAMPLE = 8  # one case in so many


def singles() -> Iterator[Case]:
    """Yield every effect on every arm with every noise, sizes in turn."""
    for (e, effect), (a, arm), (n, noise) in product(*map(enumerate, (VOCABULARY, ARMS, NOISES))):
        yield Case("single", arm, (effect,), (SIZES[(e + a + n) % 4],), noise)


def poor() -> Iterator[Case]:
    """Yield every effect on every arm, on motions that show it poorly: kinds of motion, sizes and noise in turn."""
    for (e, effect), (a, arm) in product(*map(enumerate, (VOCABULARY, ARMS))):
        kind, noise = POOR[(e + 2 * a) % len(POOR)], tuple(NOISES)[(e + a) % len(NOISES)]
        yield Case("poor", arm, (effect,), (SIZES[(e + a) % 4],), noise, kind)


def alike() -> Iterator[Case]:
    """Yield effects on motions on which others are the same, sizes and noise in turn."""
    for motion, effects in ALIKE.items():
        for (e, effect), (a, arm) in product(*map(enumerate, (effects, ARMS))):
            yield Case(
                "alike",
                arm,
                (effect,),
                (SIZES[(e + a) % 4],),
                tuple(NOISES)[(e + 2 * a) % len(NOISES)],
                motion,
            )


def pairs() -> Iterator[Case]:
    """Yield two effects, drawn; on one joint and on two in turn."""
    return _together("pair", 2, PAIRS)


def triples() -> Iterator[Case]:
    """Yield three effects, drawn."""
    return _together("triple", 3, TRIPLES)


def model_error() -> Iterator[Case]:
    """Yield an effect of one joint, or nothing, in an arm whose links all differ from the file."""
    for (e, effects), (a, arm) in product(enumerate([*((e,) for e in OF_A_JOINT), ()]), enumerate(ARMS)):
        shares, noise = (VISIBLE[(e + a) % 2],) * len(effects), tuple(NOISES)[(e + 2 * a) % len(NOISES)]
        error = ERRORS[(e + a // 2) % 2]
        yield Case("model error", arm, effects, shares, noise, number=round(100 * error), model_error=error)


def clean() -> Iterator[Case]:
    """Yield arms that lack nothing, on good and poor motions."""
    for arm, (n, noise) in product(ARMS, enumerate(NOISES)):
        kinds = [GOOD] * 5 + [BETWEEN_POINTS] * 2 + [POOR[(n + k) % len(POOR)] for k in range(3)]
        yield from (Case("clean", arm, (), (), noise, kind, k) for k, kind in enumerate(kinds[:CLEAN]))


def light_wrists() -> Iterator[Case]:
    """Yield arms with light wrists that lack nothing and whose positions are read in steps of an encoder.

    Motions of some steps only count most: their accelerations are those of the steps.
    """
    kinds = [GOOD, "one posture", "one posture", BETWEEN_POINTS, "slow"]
    for arm, noise, (k, kind) in product(LIGHT_WRISTS, ENCODERS, enumerate(kinds)):
        yield Case("light wrist", arm, (), (), noise, kind, k)


def outside() -> Iterator[Case]:
    """Yield every effect that the vocabulary lacks on every arm, small and large, noise in turn."""
    for (e, effect), (a, arm), (s, size) in product(*map(enumerate, (OUTSIDE, ARMS, (SMALL, LARGE)))):
        noise = tuple(NOISES)[(e + a + s) % len(NOISES)]
        yield Case("outside", arm, (effect,), (size[(e + a) % 2],), noise)


SUITES = {
    "single": singles,
    "pair": pairs,
    "triple": triples,
    "poor": poor,
    "alike": alike,
    "model error": model_error,
    "clean": clean,
    "light wrist": light_wrists,
    "outside": outside,
}


def planned(arms: Iterable[str] = EVERY_ARM, suites: Iterable[str] = SUITES, every: int = 1) -> list[Case]:
    """Return the cases of some arms and suites, of each suite one in so many, in an order that mixes them all."""
    out = []
    for suite in suites:
        out += _mixed(c for c in SUITES[suite]() if c.arm in arms)[::every]
    return _mixed(out)


def _mixed(cases: Iterable[Case]) -> list[Case]:
    return sorted(cases, key=lambda c: (c.seed, c.id))


def _together(suite: str, count: int, number: int) -> Iterator[Case]:
    for (a, arm), k in product(enumerate(ARMS), range(number)):
        rng = np.random.default_rng([crc32(f"{arm} {suite}".encode()), k])
        effects = tuple(rng.choice(VOCABULARY, count, replace=False).tolist())
        shares = tuple(SIZES[(a + k + i) % 4] for i in range(count))
        yield Case(suite, arm, effects, shares, tuple(NOISES)[(a + k) % len(NOISES)], number=k)
