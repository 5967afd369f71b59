"""The short answer of a discovery: five lines that a user must know."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from cdia_pin.changes.confidence import Confidence
from cdia_pin.changes.phenomenon import PhenomenonKind
from cdia_pin.robot.catalogue import STANDARD_GRAVITY
from cdia_pin.viewers.effect_groups import MOST_JOINTS, effect_groups, on_joints, these_joints
from cdia_pin.viewers.verdict import error_left, mean_share, rest_words, unseen_share
from cdia_pin.viewers.words import joint_units, listed, number, percent, short_names, with_unit

if TYPE_CHECKING:
    from cdia_pin.discovery import Discovery

VERDICTS = {
    "nothing-missing": "nothing is missing",
    "explained": "explained down to the noise",
    "explained-in-practice": "explained in practice",
    "unexplained": "not explained yet",
}

# Noise over the torque, mean over the joints [1], above which a log shows little: a fault has to make more than a tenth
# of the torque to be visible in a hundred independent samples of such noise.
NOISY = 0.2


def short_answer(found: Discovery) -> list[tuple[str, str]]:
    """Return head and text of each line: verdict, where the model fails, what is established, what is likely, its use.

    Args:
        found: The outcome of ``discover``.
    """
    first, last = found.trace[0], found.trace[-1]
    before, after = (percent(unseen_share(s.heldout_rms, found)) for s in (first, last))
    fell = f"error {before} of the torque" + ("" if first is last else f", now {after}")
    lines = [(VERDICTS[found.verdict], fell), ("where it fails", _where(found))]
    groups, joints = effect_groups(found), found.model.robot.joints
    for confidence in (Confidence.ESTABLISHED, Confidence.LIKELY):
        named = [g.words_with_rival(found.model.robot) for g in groups if g.confidence is confidence]
        if named or confidence is Confidence.ESTABLISHED:
            lines.append((str(confidence), "; ".join(named) or "nothing"))
    if found.resting and found.steps:
        resting = these_joints(found.resting, joints)
        lines.append(("at rest", f"{resting}: {rest_words(found)}"))
    able = list(noticed(found))
    lines.append(("good for", f"notices {listed(able)}" if able else "nothing: no sample counts"))
    tail = list(dict.fromkeys(g.name for g in groups if g.confidence is Confidence.DESCRIPTIVE))
    if tail:
        does = "lowers" if len(tail) == 1 else "they lower"
        lines.append(("only descriptive", f"{listed(tail)}: {does} the error, and may be something else"))
    return lines


def _where(found: Discovery) -> str:
    """Return the joints on which structure is left, the worst first, with their error, and what shape it has."""
    robot = found.model.robot
    if not found.structure_left:
        noise = mean_share(found.noise_floor, found)
        little = f", {percent(noise)} of the torque: this log shows little" if noise > NOISY else ""
        return f"nowhere: what is left is noise{little}"
    error, names = error_left(found), short_names(robot.joints)
    worst = sorted(error, key=lambda j: -error[j])
    shown = [f"{names[j]} {percent(error[j])}" for j in worst[:MOST_JOINTS]]
    more = f" and {len(worst) - MOST_JOINTS} more" if len(worst) > MOST_JOINTS else ""
    return f"{', '.join(shown)}{more}: {_shape_left(found)}"


def _shape_left(found: Discovery) -> str:
    """Return what the structure that is left looks like, where that was recognised."""
    memory = [j for f in found.findings if f.kind == PhenomenonKind.MEMORY for j in f.joints]
    seen = [j for j in found.structure_left if j in memory]
    if not seen:
        return "structure that no effect explains"
    return f"friction{on_joints(seen, found.model.robot.joints)} builds up after a reversal"


def noticed(found: Discovery) -> Iterator[str]:
    """Yield the smallest changes that the model lets a user notice: payload, push, growth of friction.

    A payload as heavy as the arm, or a push as large as its weight, says that the motion shows none.

    Args:
        found: The outcome of ``discover``.
    """
    able, robot = found.capability, found.model.robot
    mass = robot.total_mass
    if able.payload < mass:
        yield f"a payload of {with_unit(number(able.payload, 2), 'kg')}"
    if able.push < mass * STANDARD_GRAVITY:
        yield f"a push of {with_unit(number(able.push, 2), 'N')}"
    units = [joint_units(robot, j)["load"] for j in robot.joints]
    for unit in dict.fromkeys(units):
        of_unit = [
            float(f) for f, u in zip(able.friction, units, strict=True) if u == unit and np.isfinite(f)
        ]
        if not of_unit:
            continue
        least, most = number(min(of_unit), 2), number(max(of_unit), 2)
        yield f"friction that grows by {with_unit(least if least == most else f'{least} to {most}', unit)}"
