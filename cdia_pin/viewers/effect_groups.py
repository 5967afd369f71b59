"""Effects of a discovery as people read them: in groups, the most trusted first, what only describes apart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from cdia_pin.changes.confidence import Confidence
from cdia_pin.discovery.groups import group_of
from cdia_pin.effects import Payload
from cdia_pin.identifiability.rival_names import other_names
from cdia_pin.viewers.words import effect_name, listed, short_names, with_interval, with_sign

if TYPE_CHECKING:
    from cdia_pin.discovery import Discovery, Step
    from cdia_pin.effects import Effect, Term
    from cdia_pin.identifiability import Confusion
    from cdia_pin.robot.model import RobotModel

MOST_RIVALS = 2  # other explanations of an effect that are named before they are counted
MOST_JOINTS = 3  # joints that a line names before it counts the others


@dataclass(frozen=True, repr=False)
class EffectGroup:
    """Effects of one kind that are trusted alike: one line for people.

    Attributes:
        confidence: How far their names can be trusted.
        changed: Whether the model as given has them too; their parameters are differences then.
        name: Such as ``friction``.
        steps: The effects, in the order of the discovery.
    """

    confidence: Confidence
    changed: bool
    name: str
    steps: tuple[Step, ...]

    def __repr__(self) -> str:
        return f"EffectGroup({self.confidence}: {self.name}, {len(self.steps)} effects)"

    def words(self, joints: Sequence[str]) -> str:
        """Return ``friction on all 6 joints``, with ``changed`` where the model has it already.

        Args:
            joints: Names of all joints of the arm.
        """
        where = list(dict.fromkeys(j for s in self.steps for j in term_of(s).effect.scope))
        return f"{self.name}{' changed' if self.changed else ''}{on_joints(where, joints)}"

    def words_with_rival(self, robot: RobotModel) -> str:
        """Return ``link inertia on elbow (or joint spring)``: of a single effect also what else it may be.

        A payload is told with its mass, if that is known to differ from zero. It is negative where the model carries a
        tool that the arm has not.

        Args:
            robot: The arm.
        """
        said, term = self.words(robot.joints), term_of(self.steps[0])
        if len(self.steps) > 1:
            return said
        if isinstance(term.effect, Payload) and term.ci95 and abs(term.theta[0]) > term.half_widths[0]:
            said += f" {with_sign(with_interval(term.theta[0], term.ci95[0], 'kg'), term.theta[0])}"
        others = rivals(term.effect, other_names(term, self.steps[0].confusions, robot))
        if not others:
            return said
        scope = others[0].effects[0].scope
        where = "" if scope == term.effect.scope else on_joints(scope, robot.joints)
        return f"{said} (or {' with '.join(map(effect_name, others[0].effects))}{where})"


def term_of(step: Step) -> Term:
    """Return the effect of a step; only the first step of a trace is without.

    Args:
        step: A step that added an effect.
    """
    assert step.term is not None
    return step.term


def effect_groups(found: Discovery) -> list[EffectGroup]:
    """Return the effects of a discovery in groups, the established ones first.

    Args:
        found: The outcome of ``discover``.
    """
    sorted_ = [(c, s) for c in Confidence for s in found.steps if s.confidence is c]
    members: dict[tuple[Confidence, bool, str], list[Step]] = {}
    for confidence, step in sorted_:
        key = (confidence, step.change_of_model, group_of(term_of(step).effect))
        members.setdefault(key, []).append(step)
    return [
        EffectGroup(confidence, changed, _name(name, steps), tuple(steps))
        for (confidence, changed, name), steps in members.items()
    ]


def on_joints(some: Sequence[str], every: Sequence[str]) -> str:
    """Return `` on all 6 joints`` or `` on elbow and wrist``, with a space before it; empty for the whole arm.

    Args:
        some: Names of joints.
        every: Names of all joints of the arm.
    """
    return f" on {these_joints(some, every)}" if some else ""


def these_joints(some: Sequence[str], every: Sequence[str]) -> str:
    """Return ``all 6 joints``, ``elbow and wrist``, or how many joints there are.

    Args:
        some: Names of joints.
        every: Names of all joints of the arm.
    """
    if len(some) == len(every) > 1:
        return "both joints" if len(every) == 2 else f"all {len(every)} joints"
    if len(some) > MOST_JOINTS:
        return f"{len(some)} joints"
    names = short_names(every)
    return listed(names[j] for j in some)


def _name(group: str, steps: Sequence[Step]) -> str:
    """Return the name of the effects where all are of one kind, and else that of their group."""
    kinds = {effect_name(term_of(s).effect) for s in steps}
    return kinds.pop() if len(kinds) == 1 else group


def rivals(effect: Effect, confusions: Sequence[Confusion]) -> list[Confusion]:
    """Return other explanations of an effect, those on the same joint first.

    Args:
        effect: The effect.
        confusions: Its other explanations.
    """

    def elsewhere(confusion: Confusion) -> bool:
        scopes = [e.scope for e in confusion.effects]
        return not all(s == effect.scope or (s and set(s) <= set(effect.scope)) for s in scopes)

    return sorted(confusions, key=elsewhere)
