"""Changes between logs: two MuJoCo runs of one arm, of other motion and noise, and what `what_changed` says.

    python -m benchmarks.changes --arms ur5 panda --seeds 3

In most pairs the URDF is wrong in the same way before and after: every link by 3 to 5 % in mass and inertia, every
joint with friction that the model lacks; ``outside`` adds physics that the vocabulary does not know.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from time import perf_counter

import numpy as np

from benchmarks.plant import Fault, Fourier, Motion, MujocoPlant, PointToPoint
from benchmarks.plant.sizes import Sizer
from cdia_pin.changes import Changes, what_changed
from cdia_pin.dynamics import Dynamics

DURATION = 36.0  # [s]
OTHER = 1000  # added to the seed for the motion and noise after
SHARE = 0.1  # of the joint's RMS torque, size of a change
Faults = tuple[Fault, ...]
Recipe = Callable[[Sizer, Faults], Faults]  # what the arm has before, to what it has after


@dataclass(frozen=True)
class Pair:
    """Two runs.

    Attributes:
        kind: What changes.
        before: Faults in the first run.
        after: Faults in the second.
        motion: Kind of motion of the second.
        changed: Labels of what changed.
        meaning: Kind of the finding that says what they mean together, empty if each effect is to be named.
    """

    kind: str
    before: Faults
    after: Faults
    motion: Motion
    changed: frozenset[str]
    meaning: str = ""

    def held(self, found: Changes) -> Iterator[bool]:
        """Yield for each change that happened whether its interval holds the true size of its first parameter."""
        was, is_now = ({str(f): f for f in side} for side in (self.before, self.after))
        for term in (c.term for c in found.changes if c.term.label in self.changed and c.term.ci95):
            name = next(iter(is_now[term.label].parameters))
            before, after = (
                float(side[term.label].parameters[name]) if term.label in side else 0.0  # type: ignore[arg-type]
                for side in (was, is_now)
            )
            low, high = term.ci95[0]
            yield low <= after - before <= high

    def answered(self, found: Changes) -> bool:
        """Tell whether what changed is named, and nothing else."""
        named = frozenset(c.term.label for c in found.changes)
        if self.meaning:  # small parts of it may stay unseen
            return named <= self.changed and self.meaning in {f.kind for f in found.findings}
        return named == self.changed


def wrong_model(sizer: Sizer, seed: int) -> Faults:
    """Return links that are a few percent wrong and friction on every joint, drawn anew for each seed."""
    rng, robot, out = np.random.default_rng(seed), sizer.plant.robot, []
    for j, joint in enumerate(robot.joints):
        mass = 0.8 * float(robot.inertial_parameters[j][0])
        errors = [rng.choice([-1, 1]) * rng.uniform(0.03, 0.05) for _ in range(2)]
        torque = max(sizer.rms[j], 0.02 * sizer.rms.max())
        level, coefficient = (float(rng.uniform(0.05, 0.2) * torque) for _ in range(2))
        out += [
            Fault("link_inertia", joint=joint, mass=errors[0] * mass, inertia=errors[1]),
            Fault("coulomb_friction", joint=joint, level=level),
            Fault("viscous_friction", joint=joint, coefficient=coefficient),
        ]
    return tuple(out)


def unknown_physics(sizer: Sizer) -> Faults:
    """Return a hysteresis, a resonance and a hardening spring on the busiest joints."""
    torque = dict(zip(sizer.plant.joints, map(float, SHARE * sizer.rms), strict=True))
    first, second, third = sizer.busiest()[:3]
    return (
        Fault("presliding", joint=second, level=torque[second], reach=0.1),
        Fault("speed_bump", joint=third, level=torque[third], speed=0.25, width=0.06),
        Fault("cubic_spring", joint=first, stiffness=0.3 * torque[first]),
    )


def _grown(effect: str, parameter: str) -> Recipe:
    def recipe(sizer: Sizer, before: Faults) -> Faults:
        joint = sizer.busiest()[1]
        more = SHARE * float(sizer.rms[sizer.plant.joints.index(joint)])
        return tuple(
            f.with_parameters({parameter: float(f.parameters[parameter]) + more})  # type: ignore[arg-type]
            if (f.effect, f.joint) == (effect, joint)
            else f
            for f in before
        )

    return recipe


def _warm(sizer: Sizer, before: Faults) -> Faults:
    sizes = ("level", "coefficient")
    return tuple(
        f.with_parameters({k: 0.7 * v for k, v in f.parameters.items() if k in sizes})  # type: ignore[operator]
        if f.effect.endswith("friction")
        else f
        for f in before
    )


def _offset(sizer: Sizer, before: Faults) -> Faults:
    joint = sizer.busiest()[2]
    torque = SHARE * float(sizer.rms[sizer.plant.joints.index(joint)])
    return (*before, Fault("torque_offset", joint=joint, offset=torque))


RECIPES: dict[str, Recipe] = {
    "payload 1.5 kg": lambda _, b: (*b, Fault("payload", mass=1.5, com=(0.03, 0.01, 0.06), size=0.12)),
    "payload 0.3 kg": lambda _, b: (*b, Fault("payload", mass=0.3, com=(0.0, 0.02, 0.05), size=0.08)),
    "coulomb friction grows": _grown("coulomb_friction", "level"),
    "viscous friction grows": _grown("viscous_friction", "coefficient"),
    "friction falls by 30 %": _warm,
    "torque offset": _offset,
    "gain −6 %": lambda s, b: (*b, Fault("actuator_gain", joint=s.busiest()[1], gain=-0.06)),
    "encoder zero 0.02 rad": lambda s, b: (*b, Fault("encoder_offset", joint=s.busiest()[1], offset=0.02)),
}


def pairs(plant: MujocoPlant, seed: int) -> Iterator[Pair]:
    """Yield four pairs in which nothing changed, and one for each change."""
    sizer = Sizer(plant, Fourier(), DURATION, seed)
    wrong = wrong_model(sizer, seed)
    outside = (*wrong, *unknown_physics(sizer))
    none: frozenset[str] = frozenset()
    yield Pair("nothing, exact model", (), (), Fourier(), none)
    yield Pair("nothing, wrong model", wrong, wrong, Fourier(), none)
    yield Pair("nothing, wrong model, point to point after", wrong, wrong, PointToPoint(), none)
    yield Pair("nothing, wrong model and unknown physics", outside, outside, Fourier(), none)
    for kind, recipe in RECIPES.items():
        after = recipe(sizer, wrong)
        changed = frozenset(str(f) for f in after if f not in wrong)
        yield Pair(kind, wrong, after, Fourier(), changed, "warming" if recipe is _warm else "")


def measured(plant: MujocoPlant, pair: Pair, seed: int) -> Changes:
    """Make both runs and ask what changed."""
    sides = ((pair.before, Fourier(), seed), (pair.after, pair.motion, seed + OTHER))
    logs = [plant.run(f, motion=m, duration=DURATION, seed=s).log for f, m, s in sides]
    return what_changed(Dynamics(plant.robot), *logs)


def main(arguments: Sequence[str] | None = None) -> None:
    """Print a line for each pair, and how often the names were exact for each kind."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--arms", nargs="+", default=["ur5", "panda"])
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--kinds", default="", help="only kinds that begin so")
    given = parser.parse_args(arguments)
    right: dict[str, list[bool]] = {}
    held: list[bool] = []
    for arm in given.arms:
        plant = MujocoPlant(arm)
        for seed in range(given.seeds):
            for pair in (p for p in pairs(plant, seed) if p.kind.startswith(given.kinds)):
                began = perf_counter()
                found = measured(plant, pair, seed)
                right.setdefault(pair.kind, []).append(pair.answered(found))
                held += pair.held(found)
                said = [f"{c.term.label} {c.term.theta[0]:+.3g}" for c in found.changes]
                print(
                    f"{arm} {seed} {pair.kind}: {', '.join(said) or 'nothing'} ({perf_counter() - began:.0f} s)"
                )
    for kind, exact in right.items():
        print(f"{kind}: {sum(exact)} of {len(exact)}")
    print(f"intervals that hold the truth: {sum(held)} of {len(held)}")


if __name__ == "__main__":
    main()
