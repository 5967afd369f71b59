"""Phenomena in a fitted model and its residual: friction that drifts, and friction with memory at reversals."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from cdia_pin.changes.phenomenon import Phenomenon, PhenomenonKind
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import CoulombFriction, Drift, Term
from cdia_pin.effects.presliding import longest_reach
from cdia_pin.logs.reversals import reversals
from cdia_pin.regression.experiment import Experiment, Prediction
from cdia_pin.regression.friction_memory import bent
from cdia_pin.regression.regression import Regression
from cdia_pin.robot.model import RobotModel
from cdia_pin.selection.discovery_settings import MemorySettings

Array = NDArray[np.float64]

# Reaches of friction with memory, over the joint's travel [1]; the first is too short to count.
REACHES = np.geomspace(0.005, 0.5, 16)
NEURONS = 9  # radial basis functions [1] over a joint's speed, so that memory is more than friction of speed


def recognised(
    regression: Regression, model: Dynamics, left: Sequence[str], settings: MemorySettings
) -> tuple[Phenomenon, ...]:
    """Return the phenomena in a fitted model and in its residual.

    Args:
        regression: The conditioned logs and their noise.
        model: Model that was fitted to them, with intervals.
        left: Names of the joints on which structure is left.
        settings: When friction counts as having memory.
    """
    return (*_drifts(model, left), *_memories(regression, model, settings))


def _drifts(model: Dynamics, left: Sequence[str]) -> Iterator[Phenomenon]:
    """Yield a phenomenon for each effect that drifts."""
    for term in model.terms:
        effect = term.effect
        if not isinstance(effect, Drift):
            continue
        robot, joints = model.robot, effect.scope or model.robot.joints
        first, last = (effect.of_part(term.theta, part) for part in effect.parts)
        largest = int(np.argmax(np.abs(np.array(last) - np.array(first))))
        parameter, unit = effect.effect.parameters[largest], effect.effect.units(robot)[largest]
        fell = abs(last[largest]) < abs(first[largest])
        meaning = ""
        if effect.traits.dissipative:
            meaning = ", as in a drive that warms up" if fell else ", as in a drive that cools down"
        if set(joints) & set(left):
            meaning = "; structure is left there, so it may be something else that changes with time"
        yield Phenomenon(
            PhenomenonKind.DRIFT,
            joints,
            f"{effect.name.replace('_', ' ')} on {', '.join(joints)} drifts within the log: {parameter.name} from "
            f"{first[largest]:.3g} to {last[largest]:.3g} {unit} (time constant {effect.time_constant:.2g} s){meaning}",
            {
                f"{parameter.name}_start": first[largest],
                f"{parameter.name}_end": last[largest],
                "time_constant": effect.time_constant,
            },
        )


def _memories(regression: Regression, model: Dynamics, settings: MemorySettings) -> Iterator[Phenomenon]:
    """Yield a phenomenon for each joint whose torque after a reversal depends on the distance travelled."""
    experiment, whitening = regression.experiment, regression.whitening
    prediction = experiment.predict(model)
    for j, joint in enumerate(model.robot.joints):
        turns = sum(reversals(s.motion.v[:, j]) for s in experiment.segments)
        if experiment.resting[j] or turns < settings.least_reversals:
            continue
        own = [
            _columns(regression, prediction, t, j) for t in model.terms if j in t.effect.acts_on(model.robot)
        ]
        # memory must be more than direction and speed
        level = regression.design.of(CoulombFriction(joint), prediction)[:, 0, :]
        beside = whitening.joint(j, np.column_stack([*own, level, _of_speed(experiment, j)]))
        y = whitening.joint(j, prediction.residual[:, j])
        basis = _orthonormal(beside)
        left = y - basis @ (basis.T @ y)
        travel = max(float(np.ptp(s.motion.q[:, j])) for s in experiment.segments)
        gains, levels = [], []
        for reach in REACHES * travel:
            z = whitening.joint(j, -bent(experiment, j, float(reach)))
            new = z - basis @ (basis.T @ z)
            size = float(new @ new)
            level_of = float(new @ left) / size if size > 1e-6 * float(z @ z) else 0.0
            gains.append(level_of**2 * size)
            levels.append(level_of)
        best = int(np.argmax(gains))
        torque = float(np.sqrt(np.mean(experiment.measured[:, j] ** 2)))
        enough = max(
            settings.least_share * float(left @ left),
            4 * np.log(max(len(y), 2)) + 2 * np.log(len(REACHES) * model.robot.n),
        )
        short = REACHES[best] * travel <= longest_reach(model.robot, j)
        if best > 0 and short and gains[best] > enough and levels[best] > settings.least_torque * torque:
            yield _presliding(model.robot, joint, levels[best], float(REACHES[best] * travel), turns)


def _presliding(robot: RobotModel, joint: str, level: float, reach: float, turns: int) -> Phenomenon:
    prismatic = bool(robot.is_prismatic[robot.joint_index(joint)])
    x, effort = ("m", "N") if prismatic else ("rad", "N·m")
    stiffness = level / reach
    return Phenomenon(
        PhenomenonKind.MEMORY,
        (joint,),
        f"friction on {joint} has memory at its {turns} reversals: it looks like presliding, {level:.2g} {effort} "
        f"built up over about {reach:.2g} {x} (stiffness ≈ {stiffness:.2g} {effort}/{x})",
        {"level": level, "reach": reach, "stiffness": stiffness, "reversals": turns},
    )


def _columns(regression: Regression, prediction: Prediction, term: Term, j: int) -> Array:
    x = regression.design.of(term.effect, prediction, np.array(term.theta))
    return x[:, term.effect.acts_on(regression.experiment.robot).index(j), :]


def _of_speed(experiment: Experiment, j: int) -> Array:
    """Return smooth functions of a joint's speed, filtered like the torques, shape (K, NEURONS)."""
    fastest = max(float(np.percentile(np.abs(s.motion.v[:, j]), 99)) for s in experiment.segments)
    centres, width = np.linspace(-fastest, fastest, NEURONS, retstep=True)
    return experiment.compared(lambda m: np.exp(-(((m.v[:, [j]] - centres) / max(float(width), 1e-9)) ** 2)))


def _orthonormal(columns: Array) -> Array:
    from scipy.linalg import svd

    norm = np.linalg.norm(columns, axis=0)
    seen = norm > 1e-12 * norm.max(initial=0.0)
    # numpy's default algorithm does not converge on some columns that nearly repeat each other
    left, values, _ = svd(columns[:, seen] / norm[seen], full_matrices=False, lapack_driver="gesvd")
    return np.asarray(left[:, values > 1e-5 * values[0]]) if len(values) else columns[:, :0]
