"""The next motion to record: effects that a log cannot distinguish well, and a motion designed to do so."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from cdia_pin.app.exports import written
from cdia_pin.app.session import Session
from cdia_pin.effects import Effect, Term
from cdia_pin.excitation import excite
from cdia_pin.identifiability import Confusion
from cdia_pin.identifiability.structural_rank import are_alike
from cdia_pin.progress import Progress
from cdia_pin.robot import RobotModel
from cdia_pin.viewers.words import confusion_words, effect_name, few, listed, where_words


@dataclass(frozen=True)
class Doubt:
    """An effect that the log cannot distinguish well from another.

    Attributes:
        one: The effect that was found.
        other: Another explanation: one effect or several together.
        others: All other explanations in words.
        motion: The motion that would distinguish the two, in words.
        tellable: Whether any motion of this arm can.
    """

    one: Effect
    other: tuple[Effect, ...]
    others: str
    motion: str
    tellable: bool

    @property
    def pair(self) -> str:
        """Both in words."""
        return f"{effect_name(self.one)} on {where_words(self.one)} from {self.others}"


def doubts(session: Session) -> list[Doubt]:
    """Return the effects in doubt: those of the model first, then those that the search would add.

    Args:
        session: The session.
    """
    out = {term.label: (term, confusions) for term, confusions in _doubtful(session)}
    return [_doubt(term, confusions, session.inputs.robot) for term, confusions in out.values()]


def _doubt(term: Term, confusions: tuple[Confusion, ...], robot: RobotModel) -> Doubt:
    separable = [c for c in confusions if not are_alike(robot, term.effect, c.effects[0])]
    first = (separable or confusions)[0]
    others = listed(few(confusion_words(c) for c in separable or confusions))
    return Doubt(term.effect, first.effects, others, first.motion, bool(separable))


def _doubtful(session: Session) -> Iterator[tuple[Term, tuple[Confusion, ...]]]:
    for found in (session.history.discovery, session.found):
        for step in found.steps if found else ():
            if step.term is not None and step.confusions:
                yield step.term, step.confusions


def designed(session: Session, doubt: Doubt, tell: Progress) -> tuple[bytes, str]:
    """Design a motion that distinguishes two effects.

    Args:
        session: The session.
        doubt: The two effects.
        tell: Reports progress.

    Returns:
        The motion as the bytes of a CSV file, and its gain in words.

    Raises:
        EffectError: If no motion of this arm distinguishes them.
        RobotError: If the limits of the arm leave no room for a motion.
    """
    motion = excite(
        session.present.model, between=(doubt.one, doubt.other), after=session.inputs.log, progress=tell
    )
    gain = motion.gain
    enough = "" if gain.enough else ", which may not be enough"
    return (
        written("motion.csv", motion.to_csv),
        f"in a log of this motion the two differ by {gain.after:.3g} standard deviations, in this log by "
        f"{gain.before:.2g}{enough}. Check the motion before you run it: obstacles around the arm are not known.",
    )
