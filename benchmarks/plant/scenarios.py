"""Hidden effects to be found: one, two or three of the vocabulary, some outside it, or none.

    for s in singles(plant, fraction=0.2):
        run = s.run(plant)              # s.faults is the answer, run.log the question
        later = s.holdout().run(plant)  # same faults, another motion

Sizes are relative: `fraction` is the effect's RMS torque as a share of the joint's, along the nominal motion
of that seed; a tilt, an encoder's zero and a delay stay within what a working robot would have.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import Any

from benchmarks.plant.faults import MECHANISMS, Fault
from benchmarks.plant.motion import Fourier, Motion, PointToPoint
from benchmarks.plant.noise import Noise
from benchmarks.plant.plant import DRAWS, MujocoPlant, Run
from benchmarks.plant.sizes import Sizer

HOLDOUT = 1000  # added to the seed for a second motion with the same faults


@dataclass(frozen=True)
class Scenario:
    """A run to be made.

    Attributes:
        name: What is hidden and how large, for test names and tables.
        faults: The hidden faults.
        seed: Seed of motion and noise.
        motion: Kind of motion.
        noise: Imperfections of the sensors.
        duration: Length [s].
        rate: Sampling rate [Hz].
        noise_seed: Another one gives other noise on the same motion.
    """

    name: str
    faults: tuple[Fault, ...]
    seed: int
    motion: Motion = field(default_factory=Fourier)
    noise: Noise = field(default_factory=Noise)
    duration: float = 36.0
    rate: float = 250.0
    noise_seed: int = DRAWS

    def run(self, plant: MujocoPlant) -> Run:
        """Make the run, or find it on disk."""
        return plant.run(
            self.faults,
            motion=self.motion,
            duration=self.duration,
            rate=self.rate,
            noise=self.noise,
            seed=self.seed,
            noise_seed=self.noise_seed,
        )

    def holdout(self) -> Scenario:
        """Return the same faults under another motion and noise."""
        return replace(self, name=f"{self.name} (held out)", seed=self.seed + HOLDOUT)


Recipe = Callable[[Sizer], Fault]  # who knows how busy the joints are, to a fault of any size


def _on(effect: str, rank: int, **parameters: Any) -> Recipe:
    """Return a fault on the joint that carries the `rank`-th largest torque."""
    return lambda sizer: Fault(effect, joint=sizer.busiest()[rank], **parameters)


def _between(effect: str, rank: int, **parameters: Any) -> Recipe:
    """Return a fault on such a joint and its busier neighbour."""

    def recipe(sizer: Sizer) -> Fault:
        joint = sizer.busiest()[rank]
        return Fault(effect, joint=joint, other=sizer.beside(joint), **parameters)

    return recipe


def _coupled(**parameters: Any) -> Recipe:
    def recipe(sizer: Sizer) -> Fault:
        joint, other = sizer.alike()
        return Fault("coupled_friction", joint=joint, other=other, **parameters)

    return recipe


def _arm(effect: str, **parameters: Any) -> Recipe:
    return lambda _: Fault(effect, **parameters)


Parameters = dict[str, Any]

# Sizes are scaled afterwards; ratios and shapes stay.
PARAMETERS: dict[str, Parameters] = {
    "coulomb_friction": {"level": 1.0},
    "viscous_friction": {"coefficient": 1.0},
    "stribeck_friction": {"level": 1.0, "breakaway": 1.5, "decay": 8.0},
    "asymmetric_friction": {
        "level_positive": 1.0,
        "level_negative": 1.8,
        "coefficient_positive": 1.0,
        "coefficient_negative": 0.4,
    },
    "quadratic_friction": {"coefficient": 1.0},
    "load_friction": {"coefficient": 0.1},
    "position_ripple": {"sine": 1.0, "cosine": 0.6, "frequency": 9.0},
    "actuator_gain": {"gain": -0.1},
    "torque_offset": {"offset": 1.0},
    "rotor_inertia": {"inertia": 0.1},
    "joint_spring": {"stiffness": 1.0, "preload": 0.3},
    "coupled_friction": {"coefficient": 1.0, "level": 1.0},
    "link_inertia": {"mass": 0.5, "com": (0.01, 0.005, 0.02), "inertia": 0.1},
    "payload": {"mass": 1.0, "com": (0.03, 0.01, 0.06), "size": 0.12},
    "base_tilt": {"tilt_x": 0.3, "tilt_y": -0.2},
    "tool_wrench": {"force": (4.0, -3.0, 5.0), "torque": (0.3, 0.2, -0.2)},
    "viscous_medium": {"drag": 10.0, "displaced_mass": 1.0},
    "encoder_offset": {"offset": 0.02},
    "effort_delay": {"delay": 0.005},
}
OUTSIDE_PARAMETERS: dict[str, Parameters] = {
    "cubic_spring": {"stiffness": 1.0},
    "torque_deadzone": {"width": 1.0},
    "speed_cogging": {"coefficient": 1.0},
    "posture_friction": {"level": 1.0},
    "warming_friction": {"level": 1.0, "time": 12.0},
    "cross_spring": {"torque": 1.0},
    "presliding": {"level": 1.0, "reach": 0.1},
    "speed_bump": {"level": 1.0, "speed": 0.25, "width": 0.06},
}
RANKS = {  # of the joint, by the torque it carries; 1 for all others
    "viscous_friction": 2,
    "asymmetric_friction": 2,
    "load_friction": 0,
    "position_ripple": 2,
    "torque_offset": 2,
}


def _recipe(effect: str, parameters: Parameters) -> Recipe:
    places = MECHANISMS[effect].places
    if effect == "coupled_friction":
        return _coupled(**parameters)
    if places == 2:
        return _between(effect, RANKS.get(effect, 1), **parameters)
    return _on(effect, RANKS.get(effect, 1), **parameters) if places else _arm(effect, **parameters)


RECIPES = {effect: _recipe(effect, given) for effect, given in PARAMETERS.items()}
OUTSIDE_RECIPES = {effect: _recipe(effect, given) for effect, given in OUTSIDE_PARAMETERS.items()}
PAIRS: tuple[tuple[Recipe, ...], ...] = (
    (_on("coulomb_friction", 1, level=1.0), RECIPES["payload"]),
    (_on("coulomb_friction", 1, level=1.0), _on("viscous_friction", 1, coefficient=1.0)),
    (_on("viscous_friction", 0, coefficient=1.0), _on("rotor_inertia", 1, inertia=0.1)),
    (_on("coulomb_friction", 2, level=1.0), RECIPES["base_tilt"]),
    (_on("actuator_gain", 1, gain=-0.1), _on("coulomb_friction", 2, level=1.0)),
    (_on("joint_spring", 1, stiffness=1.0, preload=0.3), _on("viscous_friction", 2, coefficient=1.0)),
    (_on("position_ripple", 1, sine=1.0, cosine=0.6, frequency=9.0), _on("coulomb_friction", 1, level=1.0)),
    (_on("torque_offset", 1, offset=1.0), _on("quadratic_friction", 2, coefficient=1.0)),
    (RECIPES["tool_wrench"], _on("viscous_friction", 1, coefficient=1.0)),
    (_on("coulomb_friction", 0, level=1.0), _on("coulomb_friction", 2, level=1.0)),
)
TRIPLES: tuple[tuple[Recipe, ...], ...] = (
    (
        _on("coulomb_friction", 1, level=1.0),
        _on("viscous_friction", 2, coefficient=1.0),
        RECIPES["payload"],
    ),
    (
        _on("coulomb_friction", 0, level=1.0),
        _on("rotor_inertia", 1, inertia=0.1),
        RECIPES["base_tilt"],
    ),
    (
        _on("viscous_friction", 0, coefficient=1.0),
        _on("torque_offset", 1, offset=1.0),
        _on("coulomb_friction", 2, level=1.0),
    ),
    (
        _on("coulomb_friction", 1, level=1.0),
        _on("viscous_friction", 1, coefficient=1.0),
        _on("joint_spring", 2, stiffness=1.0, preload=0.0),
    ),
    (
        _on("position_ripple", 2, sine=1.0, cosine=0.0, frequency=9.0),
        _on("quadratic_friction", 1, coefficient=1.0),
        RECIPES["tool_wrench"],
    ),
)


def singles(plant: MujocoPlant, fraction: float = 0.2, seed: int = 0) -> list[Scenario]:
    """Return each effect of the vocabulary alone, on a sensible joint."""
    return [_scenario(plant, (r,), fraction, seed + k) for k, r in enumerate(RECIPES.values())]


def pairs(plant: MujocoPlant, fraction: float = 0.2, seed: int = 100) -> list[Scenario]:
    """Return two effects at a time."""
    return [_scenario(plant, r, fraction, seed + k) for k, r in enumerate(PAIRS)]


def triples(plant: MujocoPlant, fraction: float = 0.2, seed: int = 200) -> list[Scenario]:
    """Return three effects at a time."""
    return [_scenario(plant, r, fraction, seed + k) for k, r in enumerate(TRIPLES)]


def outside(plant: MujocoPlant, fraction: float = 0.3, seed: int = 300) -> list[Scenario]:
    """Return each effect that the vocabulary lacks."""
    return [_scenario(plant, (r,), fraction, seed + k) for k, r in enumerate(OUTSIDE_RECIPES.values())]


def clean(seed: int = 400) -> list[Scenario]:
    """Return runs with nothing hidden: various noise, poor motions, moves between points."""
    kinds: Iterable[tuple[str, Motion, Noise]] = (
        ("usual", Fourier(), Noise()),
        ("another motion", Fourier(), Noise()),
        ("coloured noise", Fourier(), Noise(colour="ar1", effort_fraction=0.02)),
        ("pink noise", Fourier(), Noise(colour="pink", effort_fraction=0.02)),
        ("strong noise", Fourier(), Noise(effort_fraction=0.05)),
        ("coarse encoders", Fourier(), Noise(position_resolution=2e-4)),
        ("slow", Fourier(speed=0.12), Noise()),
        ("small", Fourier(amplitude=0.1), Noise()),
        ("point to point", PointToPoint(), Noise()),
    )
    return [Scenario(f"clean, {n}", (), seed + k, m, s) for k, (n, m, s) in enumerate(kinds)]


def _scenario(plant: MujocoPlant, recipes: Iterable[Recipe], fraction: float, seed: int) -> Scenario:
    sizer = Sizer(plant, Fourier(), Scenario.duration, seed)
    faults = tuple(sizer.sized(recipe(sizer), fraction) for recipe in recipes)
    return Scenario(f"{' + '.join(map(str, faults))}, {fraction:g}", faults, seed)
