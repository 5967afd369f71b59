"""What seems to have changed, and is not certain enough to be named.

Between motions that differ, effects that are not there seem to be. What is hardly more certain than these may be a
change or not. To keep it back would be to say that nothing changed.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from cdia_pin.changes.sizes import sized
from cdia_pin.effects import Term
from cdia_pin.phrases import clipped

if TYPE_CHECKING:
    from cdia_pin.changes.changes_documents import UncertainJson
    from cdia_pin.changes.found_changes import FoundChanges
    from cdia_pin.changes.run_to_run import RunToRun
    from cdia_pin.robot.model import RobotModel

# In 120 pairs of unchanged logs of eight arms something is told in one with 0.5, in none with 0.8, in two with 0.2.
LEAST_SHARE = 0.5  # [1], certainty of a change over that which a name needs, from which it is told


@dataclass(frozen=True, repr=False)
class Uncertain:
    """A change that explains what differs, and may be none.

    Attributes:
        term: The effect; its parameters are the differences, after minus before. Its 95 % intervals are wider by the
            factor by which effects that are not there seem more certain than by chance.
        share: Its certainty over that which a name needs [1], below 1.
    """

    term: Term
    share: float

    def __repr__(self) -> str:
        return (
            f"Uncertain({clipped(self.term.label, 60)}, {100 * self.share:.0f} % of the certainty of a name)"
        )

    def to_dict(self, robot: RobotModel) -> UncertainJson:
        """Return the change for JSON.

        Args:
            robot: The arm, for the names and units of its joints.
        """
        return {
            "effect": self.term.effect.name,
            "joints": list(self.term.effect.joints(robot)),
            "difference": self.term.parameters_to_dict(robot),
            "share": self.share,
        }


def too_uncertain(found: FoundChanges, run_to_run: RunToRun, told: Collection[str]) -> tuple[Uncertain, ...]:
    """Return what was found and is too uncertain to be named, the most certain first.

    Args:
        found: The changes.
        run_to_run: Friction of both sides beside what was found.
        told: Labels of what is told already: named, or a usual difference.
    """
    search, out = found.search, []
    spread = max(search.spreads)
    for c, term in zip(found.chosen, sized(found), strict=True):
        rest = [o for o in found.chosen if o != c]
        share = search.certainty(search.evidence.fits(rest))[c] / search.settings.least_certainty
        torque = search.torque(c, np.array(term.theta))
        may_be_nothing = run_to_run.allowed_for(term, torque).may_be_nothing
        if LEAST_SHARE <= share < 1.0 and not may_be_nothing and term.label not in told:
            wider = term.with_intervals(spread * term.half_widths)
            out.append(Uncertain(run_to_run.allowed_for(wider, torque), float(share)))
    return tuple(sorted(out, key=lambda u: -u.share))
