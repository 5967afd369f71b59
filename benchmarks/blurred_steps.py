"""Measure what the filters do to steps of dry friction, and write docs/results-blurred-steps.md.

Usage:
    python -m benchmarks.blurred_steps

An arm is moved along a prescribed motion. MuJoCo computes its torque, and friction of a known law is added. Without
noise least squares over the compared samples, links known, shows the bias of the conditioning alone. With noise it is
counted how many intervals of `identify` hold the truth.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.markdown import details, table
from benchmarks.outcomes import CHECKOUT
from benchmarks.plant import Fourier, MujocoPlant, Noise
from benchmarks.publishing import made_by, publish
from cdia_pin import Dynamics, Log
from cdia_pin.identification import IdentificationSettings, identify
from cdia_pin.logs.conditioning import Conditioning, condition
from cdia_pin.regression import Experiment

Array = NDArray[np.float64]

PAGE = CHECKOUT / "docs" / "results-blurred-steps.md"
ARM, DURATION, RATE = "ur5", 60.0, 250.0  # [s], [Hz]
SEEDS = (1, 2)
# [Hz], base frequency of the motion: a joint turns back some 30 and some 80 times a minute
BASES = (0.1, 0.25)
CUTOFFS = (5.0, 10.0, 20.0)  # [Hz]
BANDS = (1.0, 1.25, 1.7, 2.0, 3.0)  # [1], cut-off of the motion over that of the compared torques
HEADS = ("parameter", *(f"{band:g}" for band in BANDS))
NOISY = range(11, 15)  # seeds of logs with noise
LENGTHS = (30.0, 60.0, 120.0)  # [s], of logs with noise
FOUND = ("coulomb_friction", "viscous_friction")
DECAY = 8.0  # [s/rad], of the friction that falls with speed


@dataclass(frozen=True)
class Law:
    """A law of friction that is linear in its parameters.

    Attributes:
        name: What it is.
        parameters: Names of its parameters.
        values: Their true values [N·m], of the last one, which is viscous, [N·m·s/rad].
        steps: Returns the columns of the others from the sign of the speed [1] and the speed [rad/s].
    """

    name: str
    parameters: tuple[str, ...]
    values: tuple[float, ...]
    steps: Callable[[Array, Array], tuple[Array, ...]]

    def columns(self, sign: Array, speed: Array) -> Array:
        """Return its columns along a motion, shape (N, parameters).

        Args:
            sign: Sign of the speed [1], shape (N,).
            speed: Speed [rad/s], shape (N,).
        """
        return np.column_stack([*self.steps(sign, speed), speed])


LAWS = (
    Law("Coulomb", ("level", "viscous"), (5.0, 4.0), lambda s, _: (s,)),
    Law(
        "falls with speed",
        ("level", "beyond it at rest", "viscous"),
        (5.0, 3.0, 4.0),
        lambda s, v: (s, np.exp(-DECAY * np.abs(v)) * s),
    ),
    Law(
        "differs by direction",
        ("forward", "backward", "viscous"),
        (6.0, 4.0, 4.0),
        lambda s, _: (s * (s > 0), s * (s < 0)),
    ),
)


def errors(law: Law, cutoff: float, band: float, base: float) -> Array:
    """Return the errors of a law's parameters on every joint, of all seeds, as shares [1], shape (K, parameters).

    Args:
        law: The law of the friction.
        cutoff: Cut-off of the compared torques [Hz].
        band: Cut-off of the motion over it [1].
        base: Base frequency of the motion [Hz].
    """
    plant = MujocoPlant(ARM)
    logs = (_log(plant, law, base, seed, DURATION) for seed in SEEDS)
    return np.vstack(
        [list(_of_joints(plant, law, log, Conditioning(cutoff, motion_band=band))) for log in logs]
    )


def held(band: float, duration: float) -> str:
    """Count the intervals of `identify` that hold the Coulomb and the viscous friction of each joint, of how many.

    Args:
        band: Cut-off of the motion over that of the compared torques [1].
        duration: Length of the log [s].
    """
    plant, settings = MujocoPlant(ARM), IdentificationSettings(Conditioning(motion_band=band), refine=False)
    hits = []
    for seed in NOISY:
        log, noise = _log(plant, LAWS[0], max(BASES), seed, duration), Noise()
        noisy = replace(
            log,
            position=noise.read_position(log.position),
            effort=noise.read_effort(log.effort, RATE, np.random.default_rng(seed)),
        )
        model = identify(Dynamics(plant.robot), noisy, settings=settings).model
        for joint, (name, true) in product(plant.joints, zip(FOUND, LAWS[0].values, strict=True)):
            ((low, high),) = model.find(f"{name}@{joint}").ci95
            hits.append(low <= true <= high)
    return f"{sum(hits)} of {len(hits)}"


def _log(plant: MujocoPlant, law: Law, base: float, seed: int, duration: float) -> Log:
    """Return a log without noise."""
    time = np.arange(0.0, duration, 1 / RATE)
    q, v, a = plant.plan(Fourier(base=base), duration, seed)(time)
    friction = np.column_stack([law.columns(np.sign(x), x) @ law.values for x in v.T])
    return Log(plant.joints, time, q, plant.nominal.inverse_dynamics(q, v, a) + friction)


def _of_joints(plant: MujocoPlant, law: Law, log: Log, conditioning: Conditioning) -> Iterator[Array]:
    motion = condition(log, plant.robot, conditioning)
    experiment = Experiment.of(plant.robot, [motion])
    measured = -experiment.predict(Dynamics(plant.robot)).residual
    sign = experiment.segments[0].state.sign
    for j, moves in enumerate(experiment.moving.T):
        columns = motion.compared(law.columns(sign[:, j], motion.v[:, j]))
        found, *_ = np.linalg.lstsq(columns[moves], measured[moves, j], rcond=None)
        yield found / law.values - 1.0


def page() -> str:
    """Measure, and return the page as Markdown."""
    conditions = [(base, cutoff) for base in BASES for cutoff in CUTOFFS]
    summary, parts = [], []
    for law in LAWS:
        found = {
            (*c, band): errors(law, cutoff=c[1], band=band, base=c[0]) for c in conditions for band in BANDS
        }
        every = [np.vstack([found[*c, band] for c in conditions]) for band in BANDS]
        summary += [(law.name, *row) for row in _rows(law, every)]
        rows = [
            (f"{base:g} Hz", f"{cutoff:g} Hz", *row)
            for base, cutoff in conditions
            for row in _rows(law, [found[base, cutoff, band] for band in BANDS])
        ]
        parts.append(details(law.name, table(("base of the motion", "cut-off", *HEADS), rows)))
    return "\n\n".join([
        "# Steps of friction and the filters",
        made_by("python -m benchmarks.blurred_steps", ("pin", "mujoco", "numpy")),
        f"A UR5 moves for {DURATION:g} s along a sum of five sines, in {len(SEEDS)} draws at {RATE:g} Hz. MuJoCo "
        "computes the torque of the links. Friction of a known law is added on every joint, without any noise. Its "
        "parameters come from least squares over the compared samples.",
        "Columns are `Conditioning.motion_band`: the cut-off of the motion over that of the compared torques. With 1 "
        "the step of the measured torque at a reversal passes two equal filters, and that of the computed friction one "
        "of them. A cell gives the mean error / the largest one.",
        table(("friction", *HEADS), summary),
        "## Intervals of `cdia identify`",
        f"The same arm with Coulomb and viscous friction, a base of {max(BASES):g} Hz, in {len(NOISY)} other draws: "
        "positions rounded to 10⁻⁵ rad, torques with 1 % of white noise, the cut-off that the log asks for. Counted "
        "are 95 % intervals that hold the true friction of a joint.",
        table(
            ("length of the log", *(f"{band:g}" for band in BANDS[::2])),
            [(f"{length:g} s", *(held(band, length) for band in BANDS[::2])) for length in LENGTHS],
        ),
        "## By motion and cut-off",
        *parts,
    ]) + "\n"  # fmt: skip


def _rows(law: Law, found: Sequence[Array]) -> Iterator[tuple[str, ...]]:
    for k, name in enumerate(law.parameters):
        yield (name, *(f"{100 * e[:, k].mean():+.2f} / {100 * np.abs(e[:, k]).max():.2f} %" for e in found))


def main() -> None:
    """Measure, and write the page."""
    given = argparse.ArgumentParser(
        prog="python -m benchmarks.blurred_steps",
        description="Measure what the filters do to steps of friction.",
    )
    given.add_argument("--out", type=Path, default=PAGE, help="page to write")
    publish(page(), given.parse_args().out)


if __name__ == "__main__":
    main()
