"""What changes mean: friction that falls on many joints is a warm arm, torques that all come later are a recorder."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cdia_pin.changes.changes_result import Change
from cdia_pin.changes.phenomenon import Phenomenon, PhenomenonKind
from cdia_pin.effects import EffortDelay
from cdia_pin.robot.model import RobotModel

FEWEST = 3  # joints [1]; a change on fewer may be a fault of each of them
# Share of the joints [1] that a change of temperature must reach, because it reaches all drives.
MOST_JOINTS = 0.5


def findings_of(changes: Sequence[Change], robot: RobotModel) -> tuple[Phenomenon, ...]:
    """Return the phenomena behind changes: a cause of several of them, or one that is not in the arm.

    Args:
        changes: The changes.
        robot: The arm.
    """
    return (*_temperature(changes, robot), *_recorder(changes, robot))


def _temperature(changes: Sequence[Change], robot: RobotModel) -> tuple[Phenomenon, ...]:
    """Return that the drives are warmer or colder, if friction fell or rose on most joints."""
    change_of: dict[str, float] = {}  # friction torque of each joint, relative to before where that is known
    for c in changes:
        if c.term.effect.traits.dissipative and c.term.effect.scope:
            for joint in c.term.effect.scope:
                size = float(c.torque_rms[robot.joint_index(joint)])
                change_of[joint] = change_of.get(joint, 0.0) + size * float(np.sign(sum(c.term.theta)))
    signs = {np.sign(v) for v in change_of.values()}
    if len(change_of) < max(FEWEST, MOST_JOINTS * robot.n) or len(signs) != 1:
        return ()
    fell = signs == {-1.0}
    growth = [c.growth for c in changes if c.term.effect.traits.dissipative and c.growth is not None]
    mean = float(np.median(growth)) if growth else float("nan")
    by = f" by {abs(100 * mean):.0f} % (median)" if growth else ""
    count = f"all {robot.n} joints" if len(change_of) == robot.n else f"{len(change_of)} of {robot.n} joints"
    sentence = f"friction {'fell' if fell else 'rose'} on {count}{by}, and rose on none: " + (
        "the drives are warmer than before" if fell else "the drives are colder than before, or carry more"
    )
    if not fell:
        sentence = sentence.replace("rose on none", "fell on none")
    kind = PhenomenonKind.WARMING if fell else PhenomenonKind.COOLING
    return (Phenomenon(kind, tuple(change_of), sentence, {"median_growth": mean} if growth else {}),)


def _recorder(changes: Sequence[Change], robot: RobotModel) -> tuple[Phenomenon, ...]:
    """Return that the torques of all joints are recorded later or earlier, if one delay of them all changed."""
    out = []
    for c in changes:
        if isinstance(c.term.effect, EffortDelay) and not c.term.effect.scope:
            delay = c.term.theta[0]
            sentence = (
                f"the torques of all joints are recorded {1e3 * abs(delay):.2g} ms "
                f"{'later' if delay > 0 else 'earlier'} beside the positions than before: that is how the logs were "
                "recorded, or another controller, and not the arm"
            )
            out.append(Phenomenon(PhenomenonKind.RECORDER, robot.joints, sentence, {"delay": delay}))
    return tuple(out)
