"""Settings of a discovery: the effects that may be found, and every number that decides, with its reason."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, fields, is_dataclass, replace
from typing import Any, Literal, NotRequired, TypedDict

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects import Effect
from cdia_pin.logs.conditioning import Conditioning
from cdia_pin.phrases import settings_repr
from cdia_pin.regression.lack_of_fit import LackOfFitSettings
from cdia_pin.regression.noise import NoiseSettings
from cdia_pin.regression.rest import RestSettings
from cdia_pin.selection.criterion import SelectionCriterion

Array = NDArray[np.float64]

FELT = 0.2  # RMS torque of an effect over what is left of a joint [1], above which the effect concerns that joint


class SearchRecord(TypedDict):
    """What is searched for, so that a search can be repeated."""

    effects: list[str] | Literal["all"]
    extra: list[Mapping[str, Any]]  # effects of the user's own, as they describe themselves
    expected: NotRequired[list[str]]  # unusual effects that the user expected
    decisions: NotRequired[dict[str, float]]  # numbers that decide, where they are not the usual ones


@dataclass(frozen=True, repr=False)
class EveryLinkSettings:
    """When a URDF counts as slightly wrong everywhere.

    Attributes:
        over_blur: Torque that the links must explain, over the torque that position noise causes through the
            accelerations [1]. At one posture that noise is known to a factor of three.
        largest_error: Largest RMS of the links' parameters over their prior standard deviations [1]. Noise of the
            accelerations leads to more.
        least_fall: Share by which the sum of squares of held-out blocks must fall [1].
    """

    over_blur: float = 5.0
    largest_error: float = 0.5
    least_fall: float = 0.08

    __repr__ = settings_repr


@dataclass(frozen=True, repr=False)
class AlternativeSettings:
    """When another explanation counts as possible.

    Attributes:
        doubt: Difference of χ² up to which two explanations are hard to distinguish, in variances of the noise [1].
            Under white noise a difference of 30 has a probability of 3e-7 where one of the two is true; residuals with
            structure need such a margin.
        undetermined_share: One standard deviation of an alternative's torque on other motions, over the torque that
            the effect explains [1]. Below it the alternative is the effect under another name.
        first_order_share: Share of what an effect explains that an effect which is not linear must explain to first
            order to be fitted at its own optimum [1].
    """

    doubt: float = 30.0
    undetermined_share: float = 0.2
    first_order_share: float = 0.9

    __repr__ = settings_repr


@dataclass(frozen=True, repr=False)
class MemorySettings:
    """When friction after a reversal counts as having memory.

    Attributes:
        least_share: Share of the residual of a joint that memory must explain [1].
        least_torque: Level of the friction that builds up, over the joint's RMS torque [1].
        least_reversals: Reversals of a joint in all logs [1]. After one reversal in each direction the distance
            travelled is a function of position and direction; the third is the first that tells them apart.
    """

    least_share: float = 0.1
    least_torque: float = 0.01
    least_reversals: int = 3

    __repr__ = settings_repr


@dataclass(frozen=True, repr=False)
class ChangeSettings:
    """When a difference between logs counts as a change of the arm.

    Residuals of measured arms repeat with the posture, not with the sample. So evidence is counted by contiguous blocks
    of time: each block is predicted from all others, and intervals come from how the estimates differ when one block
    is left out [Efron1982]. Neither depends on how smooth the recorded torque is.

    Attributes:
        blocks: Blocks of time per side [1]. Half or twice as many changes few names.
        least_certainty: Estimate over its standard deviation from blocks [1]. On pairs of logs between which nothing
            changed the largest was about 4; inserted effects of a quarter of a joint's torque mostly have more than 10.
            Several parameters, whose root mean square counts, need as much as chance shows as rarely.
        better_certainty: The same of all parameters alike, of a change that explains more than all that are certain
            [1]. A body has ten parameters, and in logs of ten seconds they are rarely certain together: a payload was
            called a torque offset of the joint below it. Of 188 inserted effects in such logs 71 are named with 5, that
            is without this rule, 75 with 2.5 and 74 with 0; in logs of half a minute and more all three name the same.
        least_share: Share of what is left on the joints concerned that the change must explain on blocks that were
            left out [1].
        least_torque: RMS torque of a change over that of the joint on which it is largest [1].
        least_moving: Share of the time in which a joint must move in both logs to be compared [1]. A model is wrong in
            another way at each posture, so a joint that rests at different postures always seems to have changed.
        reach: Largest speed of a sample over the fastest of the other side [1]. What one side never reaches is an
            extrapolation there, and its error seems to be a change.
        alike: Share of what a change explains by which another one may explain less and still be as good [1].
        doubt: The same, in standard deviations of the difference over the blocks, times the root of the number of
            parameters by which the other one is simpler [1]. Without that root, 3 more of 188 effects in logs of ten
            seconds get a wrong name, mostly friction that differs by direction in place of Coulomb friction.
        independent_time: Duration of a block from which its neighbours tell something else [s]. From shorter ones
            nothing is established: runs of 3 to 4 s, repeated with nothing changed, differ by more than that shows.
        rare: Prior standard deviation of what both sides may have in common, but neither every arm nor the model has,
            over the joint's torque [1]. With 1, they take in what changed in logs of ten seconds with few reversals.
            In logs of half a minute and more, 1 and 0.01 name about as many changes.
        gone: Whether such an effect may have been there before and be gone, as a ripple is after a repair.
        prior_effects: Effects that count as much as the knowledge that one that is not there has a certainty of 1 [1].
            An arm of six joints has some 45, one of two joints 10. With half or twice of it, one more or fewer of 56
            pairs of a UR5's logs has a wrong name, and no inserted effect more or fewer is named.
    """

    blocks: int = 16
    least_certainty: float = 5.0
    better_certainty: float = 2.5
    least_share: float = 0.1
    least_torque: float = 0.03
    least_moving: float = 0.05
    reach: float = 1.05
    alike: float = 0.02
    doubt: float = 1.0
    independent_time: float = 0.3
    rare: float = 0.01
    gone: bool = True
    prior_effects: float = 10.0

    __repr__ = settings_repr

    def spread(self, certainties: Array) -> float:
        """Return the root mean square certainty of effects that are not there, at least 1 [1].

        Args:
            certainties: Estimate over standard deviation of each [1], shape (C,).
        """
        squares, count = float(np.sum(certainties**2)), len(certainties)
        return max(1.0, float(np.sqrt((self.prior_effects + squares) / (self.prior_effects + count))))

    def is_sure(self, certainty: float, gain: float) -> bool:
        """Tell whether an effect is certain, and helps on blocks of time that its fit did not see.

        Args:
            certainty: Estimate over its standard deviation [1].
            gain: What it explains on blocks that were left out [1].
        """
        return bool(gain > 0 and certainty >= self.least_certainty)

    def is_visible(
        self, gain: float, torque: Array, left: Array, measured: Array, samples: NDArray[np.intp]
    ) -> bool:
        """Tell whether an effect is of some size, and explains a visible share of what is left.

        Args:
            gain: What it explains on blocks that were left out, in units of what is left on each joint [1].
            torque: RMS of its torque on each joint [N·m or N], shape (n,).
            left: RMS torque that no effect explains [N·m or N], shape (n,).
            measured: RMS of the measured torque [N·m or N], shape (n,).
            samples: Number of samples of each joint that count [1], shape (n,).
        """
        felt = float(np.sum(samples[torque > FELT * left]))  # sum of squares that is left on these joints
        large = np.max(torque / measured) >= self.least_torque
        return bool(large and gain >= self.least_share * (gain + felt))

    def visible_from(self, torque: float, power: float, measured: float, samples: float) -> float:
        """Return the size from which on a change of one parameter of one joint is visible in any case, in its unit.

        Args:
            torque: RMS of its torque for one unit [N·m or N], above zero.
            power: What it explains for one unit, in units of what is left on the joint [1/unit²].
            measured: RMS of the measured torque [N·m or N].
            samples: Number of samples of the joint that count [1].
        """
        felt = self.least_share / (1.0 - self.least_share) * samples  # the least that it must explain [1]
        return max(self.least_torque * measured / torque, float(np.sqrt(felt / power)))


@dataclass(frozen=True, repr=False)
class RunToRunSettings:
    """By how much friction and the scale of a torque differ between two runs although nothing happened to the joint.

    Attributes:
        spread: Standard deviation of the difference over the friction before [1], as known beforehand. Between runs of
            one industrial arm friction differs by 1 to 9 % for reasons that no log tells, such as temperature.
        weight: Joints of the logs at hand that count as much as this knowledge [1].
        largest_spread: Largest standard deviation that the other joints can show [1]. A drive that warms up by tens of
            degrees loses more friction than three times this; that is a change.
        deviations: Size of a change over the standard deviation, from which it is named [1].
        scale: Standard deviation of the difference of a torque's scale [1], as known beforehand. Magnets lose 0.1 to
            0.2 % of their torque per kelvin. Between runs of a quadruped's legs it is 1 %, of a UR10e 0.2 to 2 %.
    """

    spread: float = 0.04
    weight: float = 2.0
    largest_spread: float = 0.07
    deviations: float = 3.0
    scale: float = 0.01

    __repr__ = settings_repr


@dataclass(frozen=True, repr=False)
class ConfidenceSettings:
    """How the decision about an effect is repeated, and what it must show each time.

    Attributes:
        blocks: Contiguous blocks of time [1]; each half of a log has half of them.
        cutoffs: Cut-offs over that of the discovery [1]. The right one is not known better.
        wrong_links: Number of repeats with wrong links [1].
        link_error: Standard deviation of their error over the links' parameters [1]. URDFs of makers are about as good.
        least_certainty: Estimate over its standard deviation from blocks, root mean square over the parameters [1].
        power: Certainty that an effect of the size found should have in a repeat, over ``least_certainty`` [1]. Where
            it would have less, the repeat says nothing, as half of a log in which a joint hardly moves.
        least_shown: Share of the repeats that must say something [1].
        likely_share: Share of those repeats that a likely effect survives [1].
        unusual_certainty: The same certainty that a fluid, a steady wrench or a tilt needs beside all everyday effects
            unless the user expects it [1]. Such effects take in what everyday ones leave.
        clear_of_others: Error that all others leave, everyday effects included, on the joints of an effect and on
            blocks of time that were not fitted, over the error with it, from which on it is visible beside them, and
            an unusual one needs no such certainty [1]. It is 2.2 to 3.4 for the springs of a Baxter, and 1.0 to 1.5
            for unusual effects that nobody believes on other arms.
        worth_of_doubted: Held-out error of a model without unusual effects that are not that certain, over the error
            with them, up to which they are left out [1]. On measured arms it is 0.8 to 1.04, on an LWR4+ 1.06; an
            elasticity that is there, and hard to tell from a payload, is worth 1.08.
        worth_of_bodies: Held-out error of a model with rotors and offsets in the place of bodies, over the error with
            the bodies, up to which rotors and offsets are named [1]. On measured arms it is 1.01 to 1.03 for links that
            are as the maker says, and 1.05 to 2.6 for a hand, a tool, or a link that is wrong. The same ratio decides
            whether drive gains are tried in the place of bodies: it is 0.86 where two gains are known to be wrong, and
            1.2 to 3.1 on arms whose gains nobody doubts.
        worth_of_refinement: Held-out error of a joint with a plain effect, over that with a refined form of it, up to
            which the plain one is named [1].
        clear_refinement: The same ratio above which a refinement stays even if the plain effects of all joints together
            could stand for it [1].
        clear_difference: The same ratio above which asymmetric friction or a drift stays even if the halves of the log
            do not agree on what differs [1]. On measured arms it is 1.7 at most where they do not.
        least_spread: Share of the blocks of time over which the squared torque of an established effect is spread [1].
            A variance from fewer is hardly one. On logs of six arms it is 0.17 or more, in a log with one short motion
            0.09.
        least_over_left: RMS torque of an established effect over what the model leaves on the joint [1]. What is left
            could be mistaken for a smaller one.
        most_moved: RMS of the torque by which a repeat changes an established effect, over that of the effect [1];
            friction that every joint has may change by more. On logs of six arms it is 0.31 at most for effects that
            another log of the arm has too, and 0.44 and more for offsets, links and asymmetric friction that it lacks.
    """

    blocks: int = 32
    cutoffs: tuple[float, ...] = (0.7, 1.4)
    wrong_links: int = 2
    link_error: float = 0.05
    least_certainty: float = 3.0
    power: float = 2.0
    least_shown: float = 0.5
    likely_share: float = 0.7
    unusual_certainty: float = 20.0
    clear_of_others: float = 2.0
    worth_of_doubted: float = 1.05
    worth_of_bodies: float = 1.03
    worth_of_refinement: float = 1.1
    clear_refinement: float = 1.5
    clear_difference: float = 2.0
    least_spread: float = 0.125
    least_over_left: float = 1.0
    most_moved: float = 0.35

    __repr__ = settings_repr


@dataclass(frozen=True, repr=False)
class PracticeSettings:
    """When structure that is left does not matter in practice: it is small, and no single cause stands out.

    Attributes:
        tolerable_error: Largest error of a joint on data that was not fitted, over its torque [1]. Good identified
            models of industrial arms leave five to ten percent.
        tolerable_structure: Largest error of a joint over its noise floor [1]. Measured arms whose residual follows
            everything a little leave 1.3 to 2.4, a single effect that has no name leaves 2.7 and more.
        negligible_error: Error of a joint on data that was not fitted, over its torque [1], below which structure never
            matters: neither a drive's gain nor a torque sensor is known better.
    """

    tolerable_error: float = 0.1
    tolerable_structure: float = 2.5
    negligible_error: float = 0.01

    __repr__ = settings_repr


# Settings that the record of a discovery states by themselves.
RECORDED = ("conditioning", "effects", "extra", "per_log", "expected", "most_effects", "blocks")


@dataclass(frozen=True, repr=False)
class DiscoverySettings:
    """What a discovery searches for, and how.

    Attributes:
        conditioning: How logs are filtered.
        effects: Names of the effects that may be found; all but ``unknown`` and ``expression`` if None.
        extra: The user's own effects that may be found as well.
        per_log: Names or labels of effects that get parameters of their own in each log in any case.
        expected: Names of unusual effects that the user expects, such as ``viscous_medium`` under water.
        most_effects: Largest number of effects in the model [1].
        most_samples: Largest number of compared samples of a log [1]: three minutes at the highest cut-off, quarter of
            an hour at the lowest. A longer log is searched in stretches, which hold its motions many times.
        blocks: Number of contiguous blocks of time for held-out errors and intervals [1].
        criterion: What an effect must explain to be named.
        every_link: When a URDF counts as slightly wrong everywhere.
        alternatives: When another explanation counts as possible.
        lack_of_fit: When the residual of a model counts as structure.
        memory: When friction after a reversal counts as having memory.
        practice: When structure that is left does not matter.
        changes: When a difference between logs counts as a change of the arm.
        run_to_run: By how much friction differs although nothing happened.
        confidence: How the decision about an effect is repeated.
        noise: How the noise of a joint is estimated.
        rest: Which samples show friction.
    """

    conditioning: Conditioning = field(default_factory=Conditioning)
    effects: tuple[str, ...] | None = None
    extra: tuple[Effect, ...] = ()
    per_log: tuple[str, ...] = ()
    expected: tuple[str, ...] = ()
    most_effects: int = 40
    most_samples: int = 10_000
    blocks: int = 10
    criterion: SelectionCriterion = field(default_factory=SelectionCriterion)
    every_link: EveryLinkSettings = field(default_factory=EveryLinkSettings)
    alternatives: AlternativeSettings = field(default_factory=AlternativeSettings)
    lack_of_fit: LackOfFitSettings = field(default_factory=LackOfFitSettings)
    memory: MemorySettings = field(default_factory=MemorySettings)
    practice: PracticeSettings = field(default_factory=PracticeSettings)
    changes: ChangeSettings = field(default_factory=ChangeSettings)
    run_to_run: RunToRunSettings = field(default_factory=RunToRunSettings)
    confidence: ConfidenceSettings = field(default_factory=ConfidenceSettings)
    noise: NoiseSettings = field(default_factory=NoiseSettings)
    rest: RestSettings = field(default_factory=RestSettings)

    def may_find(self, names: Iterable[str]) -> bool:
        """Tell whether effects may be found: the user asked for all of them, or for no effects in particular.

        Args:
            names: Names of the effects.
        """
        return self.effects is None or set(names) <= set(self.effects)

    def is_unusual(self, effect: Effect) -> bool:
        """Tell whether an arm in use hardly ever has an effect, and the user neither expects it nor asks for it.

        Args:
            effect: The effect.
        """
        return effect.plausibility.unusual and effect.name not in (*self.expected, *(self.effects or ()))

    __repr__ = settings_repr

    @property
    def searched(self) -> Conditioning:
        """How logs are filtered in which effects are searched."""
        return replace(self.conditioning, most=self.most_samples)

    def record(self) -> SearchRecord:
        """Return what is searched for; numbers that decide are recorded where they are not the usual ones."""
        record: SearchRecord = {
            "effects": list(self.effects) if self.effects else "all",
            "extra": [e.to_dict() for e in self.extra],
        }
        if self.expected:
            record["expected"] = list(self.expected)
        if changed := self.changed_decisions():
            record["decisions"] = changed
        return record

    def changed_decisions(self) -> dict[str, float]:
        """Return the numbers that decide and differ from their defaults, by name as ``criterion.least_share``."""
        return dict(_changed(self, type(self)()))


def _changed(given: Any, usual: Any, prefix: str = "") -> Iterator[tuple[str, float]]:
    """Yield the numbers that differ, by name; settings within settings have a point in theirs."""
    for f in fields(given):
        name, one, default = prefix + f.name, getattr(given, f.name), getattr(usual, f.name)
        if name in RECORDED or one == default:
            continue
        if is_dataclass(one):
            yield from _changed(one, default, f"{name}.")
        else:
            yield name, one
