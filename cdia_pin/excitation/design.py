"""The design of a motion that is safe and shows chosen parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Effect
from cdia_pin.excitation.excitation_documents import ExcitationRecord
from cdia_pin.excitation.excitation_result import Excitation
from cdia_pin.excitation.excitation_settings import ExcitationSettings
from cdia_pin.excitation.limits import motion_limits
from cdia_pin.excitation.question import Explanation, Question
from cdia_pin.excitation.search import MotionSearch
from cdia_pin.logs.log import Log
from cdia_pin.progress import Progress, silent
from cdia_pin.robot.collision import CollisionModel, standing_height
from cdia_pin.robot.model import RobotModel
from cdia_pin.threads import on_one_thread
from cdia_pin.version import __version__


@on_one_thread
def excite(
    model: Dynamics | RobotModel,
    *,
    between: tuple[Explanation, Explanation] | None = None,
    effects: Sequence[Effect] | None = None,
    after: Log | Sequence[Log] = (),
    settings: ExcitationSettings | None = None,
    progress: Progress | None = None,
) -> Excitation:
    """Design a motion within all limits that shows parameters, or separates two explanations.

    The motion starts and ends at rest in one posture and moves every joint. The arm touches neither itself nor the
    floor. The rest of the surroundings is not known: look at the motion before it is driven.

    Args:
        model: The arm, with the terms that its URDF is known to lack.
        between: Two explanations, each one effect or several together; a log of the motion shows which is true.
        effects: Effects whose parameters the motion shows; the model's if omitted, or friction and inertia of all
            joints if the model has none.
        after: Logs that exist already; the gain is measured against them, or against any motion within the limits.
        settings: Duration, limits, seed.
        progress: Called with a sentence and the share done, from 0 to 1.

    Returns:
        The motion, the limits that it keeps, and its gain.

    Raises:
        EffectError: If an effect does not fit the robot, or no motion separates the two explanations.
        RobotError: If limits or settings leave no room for a motion.
        LogError: If a log cannot be used.
    """
    dynamics = model if isinstance(model, Dynamics) else Dynamics(model)
    chosen = settings or ExcitationSettings()
    tell = progress or silent
    tell("reading the limits", 0.0)
    robot = dynamics.robot
    limits = motion_limits(robot, speed=chosen.speed, effort=chosen.effort, acceleration=chosen.acceleration)
    question = Question(dynamics, limits, chosen)
    goal = question.between(*between) if between else question.parameters(effects)
    floor = standing_height(robot) if chosen.floor == "base" else chosen.floor
    collisions = CollisionModel(robot, clearance=chosen.clearance, floor=floor, srdf=chosen.srdf)
    search = MotionSearch(dynamics, limits, collisions, goal, question.noise, chosen.duration)
    trajectory, any_other = search.best(
        chosen.draws,
        chosen.refinements,
        np.random.default_rng(chosen.seed),
        lambda sentence, share: tell(sentence, 0.05 + 0.9 * share),
    )
    tell("measuring the gain", 0.96)
    gain = question.gain(goal, trajectory, any_other, [after] if isinstance(after, Log) else list(after))
    time = np.arange(int(np.floor(trajectory.duration * chosen.rate)) + 1) / chosen.rate
    q, v, a = trajectory(time)
    tell("done", 1.0)
    return Excitation(
        robot=robot,
        trajectory=trajectory,
        time=time,
        position=q,
        velocity=v,
        acceleration=a,
        effort=dynamics.inverse_dynamics(q, v, a, time=time),
        limits=limits,
        clearance=chosen.clearance,
        floor=floor,
        checked=len(collisions.pairs),
        gain=gain,
        warnings=limits.assumed,
        record=_record(chosen, dynamics),
    )


def _record(chosen: ExcitationSettings, model: Dynamics) -> ExcitationRecord:
    given = chosen.acceleration
    return {
        "version": __version__,
        "duration": chosen.duration,
        "rate": chosen.rate,
        "speed": chosen.speed,
        "effort": chosen.effort,
        "acceleration": dict(given) if isinstance(given, Mapping) else given,
        "clearance": chosen.clearance,
        "floor": chosen.floor,
        "srdf": str(chosen.srdf) if chosen.srdf else None,
        "size": chosen.size,
        "noise": chosen.noise,
        "seed": chosen.seed,
        "draws": chosen.draws,
        "refinements": chosen.refinements,
        "terms": [t.label for t in model.terms],
    }
