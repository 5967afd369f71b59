"""What monitors are tried on: seeded cases of faults that begin, vanish, return and join each other.

    for case in singles("ur5", share=0.2):
        run = case.run(plant, controller)       # case.faults is the answer

A share is the RMS of the fault's own torque over that of its joint's, along the healthy motion from the time on
at which faults begin.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations
from zlib import crc32

import numpy as np

from benchmarks.online.faults import FastViscousFriction
from benchmarks.online.motions import Chain, Onward
from benchmarks.online.plant import Controller, Drives, OnlinePlant
from benchmarks.online.run import OnlineRun
from benchmarks.online.sensors import POSITION_ONLY, Sensors
from benchmarks.online.sizes import OnlineSizer, nominal, sizer
from benchmarks.plant.faults import Fault
from benchmarks.plant.faults.mechanism import Value
from benchmarks.plant.motion import Motion, Plan

ARMS = ("scara", "ur5", "panda", "xarm7")
SHARES = (0.1, 0.2, 0.5)
FREQUENCY = 7.0  # [rad⁻¹ or m⁻¹] of every ripple; the monitor may know it
BEGIN, SECOND = 3.0, 6.5  # [s], of the first fault and of the one that joins it
GONE, BACK = 6.0, 8.5  # [s], of a fault that vanishes and returns
SHORT, LONG = 10.0, 12.0  # [s], length of a run
LONGEST = 24.0  # [s], length of a run with an unknown fault: its shape shows over the whole of a motion
USUAL = "usual"
CONDITIONS: dict[str, tuple[Sensors, Drives]] = {
    USUAL: (Sensors(), Drives()),
    "positions": (POSITION_ONLY, Drives()),  # velocities are not measured
    "late": (Sensors(), Drives(delay=0.005)),  # torques act 5 ms after their command
}
MOTIONS = 5  # motions of each arm; healthy runs of the same motions can be compared to

MAIN: dict[str, dict[str, Value]] = {
    "coulomb_friction": {"level": 1.0},
    "viscous_friction": {"coefficient": 1.0},
    "actuator_gain": {"gain": -0.1},
    "torque_offset": {"offset": 1.0},
    "joint_spring": {"stiffness": 1.0, "preload": 0.0},
    "position_ripple": {"sine": 1.0, "cosine": 0.6, "frequency": FREQUENCY},
}
BANK = MAIN | {
    "load_friction": {"coefficient": 0.1},
    "rotor_inertia": {"inertia": 0.1},
}
FURTHER: dict[str, dict[str, Value]] = {
    "stribeck_friction": {"level": 1.0, "breakaway": 1.5, "decay": 8.0},
    "asymmetric_friction": {
        "level_positive": 1.0,
        "level_negative": 1.8,
        "coefficient_positive": 1.0,
        "coefficient_negative": 0.4,
    },
    "quadratic_friction": {"coefficient": 1.0},
}
UNKNOWN: dict[str, dict[str, Value]] = {
    "cubic_spring": {"stiffness": 1.0},
    "torque_deadzone": {"width": 1.0},
    "speed_cogging": {"coefficient": 1.0, "frequency": FREQUENCY},
    "posture_friction": {"level": 1.0},
    "speed_bump": {"level": 1.0, "speed": 0.25, "width": 0.06},
}
G = 9.81  # [m/s²]
CARRIED = (0.1, 0.2)  # [1], mass of a payload over that of the arm's links
TILTS = (6.0, 12.0)  # [deg], of the base
PUSHED = (0.1, 0.25)  # [1], force of a push over the weight of the arm's links
PUSH = 1.0  # [s], duration of a push
TRIPLE = ("actuator_gain", "coulomb_friction", "position_ripple")  # of the thesis
# Sets of effects on one joint that are the same torque as another set.
SAME: dict[frozenset[str], frozenset[str]] = {
    frozenset({"torque_offset", "joint_spring"}): frozenset({"joint_spring"}),  # its preload is an offset
    frozenset({"coulomb_friction", "torque_offset"}): frozenset({"asymmetric_friction"}),
    frozenset({"coulomb_friction", "viscous_friction"}): frozenset({"asymmetric_friction"}),
}


@dataclass(frozen=True)
class Case:
    """A run to be made.

    Attributes:
        id: Name that stays the same, such as ``ur5/single/coulomb_friction@elbow_joint/20%``.
        suite: Kind of case.
        robot: Name of the arm.
        faults: What is hidden.
        share: Size of each fault as a share of its joint's torque [1]; 0 without faults.
        motion: Seed of the motion.
        seed: Seed of the sensors' noise.
        duration: Length [s].
        kind: Kind of motion.
        conditions: Sensors and drives of the arm, one of `CONDITIONS`.
    """

    id: str
    suite: str
    robot: str
    faults: tuple[Fault, ...]
    share: float
    motion: int
    seed: int
    duration: float = SHORT
    kind: Motion = field(default_factory=Onward)
    conditions: str = USUAL

    def reference(self, plant: OnlinePlant) -> Plan:
        """Return the motion asked for."""
        return plant.reference(self.kind, self.duration, self.motion)

    def run(self, plant: OnlinePlant, controller: Controller, *, healthy: bool = False) -> OnlineRun:
        """Make the run; the same motion and noise without faults if `healthy`."""
        faults = () if healthy else self.faults
        return plant.run(controller, self.reference(plant), faults, self.duration, self.seed)


def singles(robot: str, share: float = 0.2, effects: Iterable[str] = BANK, joints: int = 3) -> list[Case]:
    """Return each effect alone, on up to some joints where it can be seen, from 3 s on."""
    out = []
    for effect in effects:
        for k, (joint, motion) in enumerate(_places(robot, [effect], share, joints, f"single {effect}")):
            faults = _sized(robot, motion, SHORT, [(effect, joint, {})], share)
            out.append(_case("single", robot, faults, share, motion, k))
    return out


def further(robot: str, share: float = 0.2, joints: int = 3) -> list[Case]:
    """Return the vocabulary's other frictions, which a bank may or may not hold."""
    return singles(robot, share, FURTHER, joints)


def pairs(robot: str, share: float = 0.3, joints: int = 1) -> list[Case]:
    """Return every two of the six main effects on one joint."""
    return [c for two in combinations(MAIN, 2) for c in _together("pair", robot, two, share, joints)]


def triples(robot: str, share: float = 0.3, joints: int = 3) -> list[Case]:
    """Return the thesis' three types on one joint: a weak motor, friction and ripple."""
    return _together("triple", robot, TRIPLE, share, joints)


def unknown(robot: str, share: float = 0.3, joints: int = 2) -> list[Case]:
    """Return shapes that no effect of the vocabulary has."""
    out = []
    for effect in UNKNOWN:
        for k, (joint, motion) in enumerate(_places(robot, [effect], share, joints, f"unknown {effect}")):
            faults = _sized(robot, motion, SHORT, [(effect, joint, {})], share)
            out.append(_case("unknown", robot, faults, share, motion, k, LONGEST))
    return out


def returning(robot: str, share: float = 0.3, joints: int = 1) -> list[Case]:
    """Return faults that are there from 3 to 6 s and again from 8.5 s on."""
    out = []
    for effect in MAIN:
        for k, (joint, motion) in enumerate(_places(robot, [effect], share, joints, f"return {effect}")):
            twice = [(effect, joint, {"until": GONE}), (effect, joint, {"after": BACK})]
            faults = _sized(robot, motion, LONG, twice, share)
            out.append(_case("return", robot, faults, share, motion, k, LONG))
    return out


def joining(robot: str, share: float = 0.3) -> list[Case]:
    """Return a fault at 3 s which one of another type joins at 6.5 s, on the same joint and on another."""
    out, names = [], list(MAIN)
    for k, first in enumerate(names):
        second = names[(k + 1 + k // 2) % len(names)]
        for same in (True, False):
            wanted = [first, second] if same else [first]
            what = f"joining {first} {second} {same}"
            for joint, motion in _places(robot, wanted, share, 1, what):
                other = joint if same else _another(robot, second, share, motion, joint, what)
                if other is None:
                    continue
                two = [(first, joint, {}), (second, other, {"after": SECOND})]
                faults = _sized(robot, motion, LONG, two, share)
                out.append(_case("joining", robot, faults, share, motion, k, LONG))
    return out


def fast_only(robot: str, shares: Sequence[float] = (0.3, 0.5), joints: int = 2) -> list[Case]:
    """Return viscous friction that is only there above 0.5 rad/s (or m/s)."""
    out, effect = [], FastViscousFriction.name
    for share in shares:
        for k, (joint, motion) in enumerate(_places(robot, [effect], share, joints, "fast only")):
            faults = _sized(robot, motion, SHORT, [(effect, joint, {})], share)
            out.append(_case("profile", robot, faults, share, motion, k))
    return out


def healthy(robot: str, runs: int = 10, duration: float = SHORT) -> list[Case]:
    """Return runs without any fault, on the motions of the other cases first."""
    return [
        Case(f"{robot}/healthy/{k}", "healthy", robot, (), 0.0, k, 10_000 + k, duration) for k in range(runs)
    ]


def healthy_hour(robot: str, minutes: int = 60) -> list[Case]:
    """Return runs of a minute without any fault, each three motions in a chain."""
    return [
        Case(f"{robot}/hour/{k}", "hour", robot, (), 0.0, 100 + k, 20_000 + k, 60.0, Chain())
        for k in range(minutes)
    ]


def whole_arm(robot: str) -> list[Case]:
    """Return a payload picked up, a base that tilts, and pushes of a second at the tool, from 3 s on."""
    arm, out = nominal(robot).robot, []
    weight = arm.total_mass * G
    for k, motion in enumerate((0, 1, 2)):
        rng = _rng(robot, "whole arm", str(k))
        away = rng.normal(size=3)
        along = rng.normal(size=3)
        along /= np.linalg.norm(along)
        for share in CARRIED:
            centre = tuple(float(c) for c in 0.05 * away / np.linalg.norm(away))
            body = Fault("payload", after=BEGIN, mass=share * arm.total_mass, com=centre)
            out.append(_case("arm", robot, (body,), share, motion, k))
        for angle in TILTS:
            side = G * np.sin(np.radians(angle)) * np.array([np.cos(k), np.sin(k)])
            tilt = Fault("base_tilt", after=BEGIN, tilt_x=float(side[0]), tilt_y=float(side[1]))
            out.append(_case("arm", robot, (tilt,), angle / 100, motion, k))
        for share in PUSHED:
            force = tuple(float(f) for f in share * weight * along)
            push = Fault("tool_wrench", after=BEGIN, until=BEGIN + PUSH, force=force)
            out.append(_case("arm", robot, (push,), share, motion, k))
    return [replace(c, id=f"{c.id}/{c.motion}") for c in out]


def under(robot: str, conditions: str, joints: int = 2, minutes: int = 3) -> list[Case]:
    """Return a few single faults, and healthy minutes, under other conditions than the usual ones."""
    some = ("coulomb_friction", "actuator_gain", "torque_offset")
    cases = [c for share in (0.2, 0.5) for c in singles(robot, share, some, joints)] + healthy_hour(
        robot, minutes
    )
    return [
        replace(c, id=c.id.replace(f"/{c.suite}/", f"/{conditions} {c.suite}/"), conditions=conditions)
        for c in cases
    ]


def every_case(robot: str) -> Iterator[Case]:
    """Return all cases of an arm but the healthy hour."""
    for share in SHARES:
        yield from singles(robot, share)
        yield from further(robot, share)
    yield from pairs(robot)
    yield from triples(robot)
    for share in (0.3, 0.5):
        yield from unknown(robot, share)
    yield from returning(robot)
    yield from joining(robot)
    yield from fast_only(robot)
    yield from healthy(robot)


def same_torque(effects: Iterable[str]) -> tuple[frozenset[str], ...]:
    """Return the sets of effects on one joint that are the same torque as these, themselves first.

    A fault with a part of the motion healthy goes by the name of its effect.
    """
    given = frozenset("viscous_friction" if e == FastViscousFriction.name else e for e in effects)
    return (given, SAME[given]) if given in SAME else (given,)


# ---------------------------------------------------------------- drawing


def _places(
    robot: str, effects: Sequence[str], share: float, joints: int, what: str
) -> list[tuple[str, int]]:
    """Draw joints, and a motion for each, on which all the effects can be seen; as many as there are."""
    rng = _rng(robot, what)
    order, out = rng.permutation(nominal(robot).joints), []
    for joint in order.tolist():
        for motion in rng.permutation(MOTIONS).tolist():
            look = sizer(robot, SHORT, motion, BEGIN)
            if all(look.shows(_fault(look, e, joint, {}), share) for e in effects):
                out.append((joint, motion))
                break
        if len(out) == joints:
            break
    return out


def _another(robot: str, effect: str, share: float, motion: int, joint: str, what: str) -> str | None:
    look = sizer(robot, SHORT, motion, BEGIN)
    others = [j for j in look.plant.joints if j != joint and look.shows(_fault(look, effect, j, {}), share)]
    return str(_rng(robot, what, "other").choice(others)) if others else None


def _sized(
    robot: str,
    motion: int,
    duration: float,
    wanted: Sequence[tuple[str, str, dict[str, float]]],
    share: float,
) -> tuple[Fault, ...]:
    """Return faults of a size; each an effect, a joint, and `after` and `until` where not 3 s and for ever."""
    look = sizer(robot, duration, motion, BEGIN)
    return tuple(look.sized(_fault(look, *one), share) for one in wanted)


def _fault(look: OnlineSizer, effect: str, joint: str, times: dict[str, float]) -> Fault:
    known = BANK | FURTHER | UNKNOWN | {FastViscousFriction.name: FastViscousFriction.defaults}
    two = effect == "posture_friction"
    return Fault(
        effect,
        joint=joint,
        other=look.beside(joint) if two else None,
        **{"after": BEGIN, **times, **known[effect]},  # type: ignore[arg-type]
    )


def _together(suite: str, robot: str, effects: Sequence[str], share: float, joints: int) -> list[Case]:
    out = []
    for k, (joint, motion) in enumerate(_places(robot, effects, share, joints, f"{suite} {effects}")):
        faults = _sized(robot, motion, SHORT, [(e, joint, {}) for e in effects], share)
        out.append(_case(suite, robot, faults, share, motion, k))
    return out


def _case(
    suite: str,
    robot: str,
    faults: tuple[Fault, ...],
    share: float,
    motion: int,
    number: int,
    duration: float = SHORT,
) -> Case:
    names = dict.fromkeys(str(f) for f in faults)  # once, also where it returns
    name = f"{robot}/{suite}/{'+'.join(names)}/{share:.0%}"
    return Case(name, suite, robot, faults, share, motion, crc32(name.encode()) + number, duration)


def _rng(*what: str) -> np.random.Generator:
    return np.random.default_rng(crc32(" ".join(what).encode()))
