"""What came of a case, small enough to keep on a line."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, fields
from math import inf, nan
from typing import Any

from benchmarks.hidden_effects.oracle import Sight, unordered


@dataclass(frozen=True)
class Outcome:
    """What came of a case; lists are in the order of `hidden` where they are of the hidden effects.

    Attributes:
        id: Of the case.
        suite: Kind of case.
        arm: Name of the arm.
        noise: What its sensors did.
        excitation: How it moved.
        shares: Size of each hidden effect [1].
        hidden: Labels of the hidden effects.
        found: Labels of the effects that were named.
        confusable: Labels of what they can be confused with, according to the discovery; sets joined by ' + '.
        verdict: Of the discovery.
        structure_left: Joints whose residual is not noise, according to the discovery.
        sights: How well each hidden effect shows, see `oracle`; empty where nothing is hidden or nothing can know.
        over_floor: Held-out RMS over the noise floor, the worst joint [1].
        mean_over_floor: The same, RMS over the joints [1].
        parameter_errors: Relative error of the parameters of effects that were rightly named [1].
        covered: Whether the interval of each of their parameters holds the truth.
        resolved: What was found with a log of the proposed motion added; None if none was asked for.
        seconds: Wall time of the discovery [s].
    """

    id: str
    suite: str
    arm: str
    noise: str
    excitation: str
    shares: tuple[float, ...]
    hidden: tuple[str, ...]
    found: tuple[str, ...]
    confusable: tuple[str, ...]
    verdict: str
    structure_left: tuple[str, ...] = ()
    sights: tuple[Sight, ...] = ()
    over_floor: float = nan
    mean_over_floor: float = nan
    parameter_errors: tuple[float, ...] = ()
    covered: tuple[bool, ...] = ()
    resolved: tuple[str, ...] | None = None
    seconds: float = nan

    @property
    def exact(self) -> bool:
        """Whether the effects and joints named are those hidden; beside wrong links, any body may be added."""
        return self.same(self.found)

    @property
    def told(self) -> bool:
        """Whether every hidden effect can be told from all others, by one who knows the noise."""
        return all(s.told for s in self.sights)

    @property
    def confused(self) -> bool:
        """Whether some hidden effect can be seen but not told from another."""
        return any(s.confusable for s in self.sights)

    @property
    def holds_truth(self) -> bool:
        """Whether more than one explanation is given, and the hidden effects are among them."""
        given = {unordered(x) for x in self.found} | {
            unordered(y) for x in self.confusable for y in x.split(" + ")
        }
        return bool(self.confusable) and all(unordered(h) in given for h in self.hidden)

    def same(self, found: tuple[str, ...]) -> bool:
        """Tell whether these effects are those hidden."""
        names = [
            unordered(x) for x in found if self.suite != "model error" or x.partition("@")[0] not in BODIES
        ]
        return sorted(names) == sorted(map(unordered, self.hidden))

    def to_json(self) -> str:
        """Return the outcome as a line of JSON; what is not a number as null."""
        return json.dumps(_plain(asdict(self)), ensure_ascii=False)

    @classmethod
    def from_json(cls, line: str) -> Outcome:
        """Read back what `to_json` wrote."""
        given = json.loads(line)
        known = {f.name for f in fields(cls)}
        given["sights"] = [Sight(**{k: _number(v, inf) for k, v in s.items()}) for s in given["sights"]]
        floats = {"over_floor", "mean_over_floor", "seconds"}
        return cls(
            **{k: _number(v, nan) if k in floats else _tuple(v) for k, v in given.items() if k in known}
        )


BODIES = ("link_inertia", "payload")


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {k: _plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(v) for v in value]
    return None if isinstance(value, float) and not abs(value) < inf else value


def _number(value: Any, missing: float) -> Any:
    return missing if value is None else value


def _tuple(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value
