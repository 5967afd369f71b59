"""The search for the smallest set of changes that explains what differs between logs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations
from typing import Self

import numpy as np
from numpy.typing import NDArray

from cdia_pin.changes.common_structure import is_rare
from cdia_pin.changes.confidence import Confidence
from cdia_pin.changes.difference import Difference
from cdia_pin.changes.differing import Differing
from cdia_pin.changes.significance import certainty_of_several
from cdia_pin.effects.effect import share_a_joint
from cdia_pin.effects.refinements import LEVELS, plain_forms
from cdia_pin.regression.block_evidence import TOLD_APART, BlockEvidence, BlockFits
from cdia_pin.regression.parameter_blocks import ParameterBlocks
from cdia_pin.selection.discovery_settings import ChangeSettings

Array = NDArray[np.float64]

MOST_MOVES = 60  # moves of one search [1]; a guard, because no set is visited twice
LARGEST_GAINS = 40  # certain changes [1] that may be named; the others explain less
# Of 49 pairs of changes put on one joint of measured arms 38 are named exactly with 6, 39 with 3 and 38 with 12.
LARGEST_HIDDEN = 6  # uncertain changes [1] beside each of which another one is looked for
# The search fits a gain of 20 % by its slope, and leaves 0.0003 of it, which an effect of three parameters explains. Of
# Stribeck friction, Coulomb friction lacks 0.015, of a heavier link a payload 0.018: these are no other names.
SAME = 0.002  # [1], share of what a set explains that a simpler one may lack and explain the same
# Of a body's ten parameters, the six second moments show little. Without this limit, 3 of 188 effects fewer are named
# in logs of ten seconds; with 3 it is the same.
MOST_FEWER = 4  # parameters [1] by which one change counts as simpler than another, at most


@dataclass(frozen=True, repr=False)
class ChangeSearch:
    """The search in the evidence of two logs.

    Attributes:
        differing: Logs before and after, and the columns of all changes.
        evidence: Normal equations without each block of time.
        settings: What a change must explain.
        spreads: Root mean square certainty of effects that are not there [1], at least 1, for each of the two
            certainties of `BlockFits`. A change must be more certain than the settings say by these factors.
    """

    differing: Differing
    evidence: BlockEvidence[Difference]
    settings: ChangeSettings
    spreads: tuple[float, float] = (1.0, 1.0)

    def __repr__(self) -> str:
        return f"ChangeSearch({self.evidence!r})"

    def certainty(self, fits: BlockFits) -> Array:
        """Return how certain each change is, over how certain those seem that are not there [1], shape (C,).

        At the limit of a name, it is that of a single parameter which chance would show as rarely.

        Args:
            fits: Each change beside a set.
        """
        return self._of_all_parameters(fits) * self._of_one

    def _of_all_parameters(self, fits: BlockFits) -> Array:
        """Return the certainty of each change as a root mean square over its parameters [1], shape (C,)."""
        return np.asarray((fits.certainties / np.array(self.spreads)[:, None]).min(axis=0))

    @cached_property
    def _of_one(self) -> Array:
        """Certainty of a single parameter over that of each change which chance shows as rarely [1], shape (C,)."""
        one, shapes = self.settings.least_certainty, self.differing.searched
        blocks = len(self.evidence.unseen)
        of_several = [
            certainty_of_several(one, min(e.size, TOLD_APART), shapes[e.label], blocks)
            for e in self.evidence.effects
        ]
        return one / np.array(of_several)

    def changes(self, most: int) -> tuple[int, ...]:
        """Return the indices of the changes: they are added one by one, exchanged, and dropped.

        A search that can only return to a set from which it came has gone in a circle. The last set is taken, or a
        simpler one that explains the same.

        Args:
            most: Largest number of changes [1].
        """
        walk: list[tuple[int, ...]] = [()]
        for _ in range(MOST_MOVES):
            moves = (s for s in self._moves(walk[-1]) if len(s) <= most)
            first = next(moves, None)
            if first is None:
                break
            after = first if first not in walk else next((s for s in moves if s not in walk), None)
            if after is None:
                return self._simplest_as_good(walk[walk.index(first) :])
            walk.append(after)
        return walk[-1]

    def _simplest_as_good(self, circle: Sequence[tuple[int, ...]]) -> tuple[int, ...]:
        """Return the simplest set of a circle that explains the same as the last one."""
        left = [float(np.sum(self.evidence.unexplained(s))) for s in circle]
        explained = float(np.sum(self.evidence.unexplained(()))) - left[-1]
        as_good = [s for s, of in zip(circle, left, strict=True) if of - left[-1] <= SAME * explained]
        return min([*as_good, circle[-1]], key=self._simplicity)

    def _simplicity(self, chosen: Sequence[int]) -> tuple[int, float]:
        """Return the number of parameters of a set and how rare its effects are; the smaller, the simpler."""
        ranks = [self._rank(c) for c in chosen]
        return sum(count for count, _ in ranks), sum(penalty for _, penalty in ranks)

    def rivals(self, chosen: Sequence[int], one: int) -> list[int]:
        """Return the changes that explain as much as one of a set, the best first.

        Args:
            chosen: Indices of the set.
            one: Index of one of its members.
        """
        fits = self.evidence.fits(rest := _without(chosen, one))
        return [c for c in self._alike(one, self._nameable(rest, fits), fits) if c != one]

    def beside(self, found: Sequence[int]) -> Self:
        """Return the same search, in which a change must be more certain than effects that are not there.

        Where the model errs otherwise in one log than in the other, as between motions that differ, all effects take a
        part of that, and blocks of one log do not show it, nor parts of the speeds all of it. The effects that were not
        found tell how much it is: their certainties are spread wider than by chance, which is their empirical null
        [Efron2004].

        Args:
            found: Indices of the changes that were found.
        """
        fits, effects = self.evidence.fits(found), self.evidence.effects
        labels = {effects[c].label for c in found}
        first = {e.label: c for c, e in reversed([*enumerate(effects)]) if e.size == 1 and e.sign > 0}
        others = [c for label, c in first.items() if label not in labels]
        by_time, by_both = (self.settings.spread(certainty[others]) for certainty in fits.certainties)
        return replace(self, spreads=(by_time, by_both))

    def holds(self, rest: Sequence[int], one: int) -> bool:
        """Tell whether one change is certain enough beside others, or explains more than all that are.

        Args:
            rest: Indices of the other changes.
            one: Index of the change.
        """
        return one in self._comparable(rest, self.evidence.fits(rest))

    def confidence(self, rest: Sequence[int], one: int) -> Confidence:
        """Return how far the name of a change can be trusted: established if it is twice as certain as it must be.

        Blocks of time that are too short to be independent establish nothing.

        Args:
            rest: Indices of the other changes.
            one: Index of the change.
        """
        independent = self.differing.block_time >= self.settings.independent_time
        sure = self.certainty(self.evidence.fits(rest))[one] >= 2 * self.settings.least_certainty
        return Confidence.ESTABLISHED if sure and independent else Confidence.LIKELY

    def torque(self, change: int, theta: Array) -> Array:
        """Return the RMS torque of a change in the logs that have it [N·m or N], shape (n,).

        Args:
            change: Index of the change.
            theta: Its parameters, shape (p,).
        """
        squares = self._squares
        if change not in squares:
            squares[change] = self.differing.mean_squares(self.evidence.effects[change])
        out = np.zeros(self.differing.experiment.robot.n)
        for j, square in squares[change].items():
            out[j] = np.sqrt(max(float(theta @ square @ theta), 0.0))
        return out

    @cached_property
    def _squares(self) -> dict[int, dict[int, Array]]:
        return {}

    def visible_sizes(self, chosen: Sequence[int]) -> dict[int, float]:
        """Return from which size on a change of one parameter of one joint is visible beside a set, in its unit.

        Args:
            chosen: Indices of the set.

        Returns:
            By index of the change; those are left out of which the logs after say nothing.
        """
        x = self.differing
        out: dict[int, float] = {}
        powers, samples = self.evidence.powers(chosen), x.samples
        for c, change in enumerate(self.evidence.effects):
            joints = change.acts_on(x.experiment.robot)
            if c in chosen or change.size > 1 or change.shape or len(joints) > 1 or change.sign < 0:
                continue
            per_unit = float(self.torque(c, np.ones(1))[joints[0]])
            if per_unit > 0.0:
                power, j = powers[self.evidence.parameters[c].start], joints[0]
                out[c] = self.settings.visible_from(per_unit, power, float(x.torque[j]), float(samples[j]))
        return out

    def unseen_torque(self, chosen: Sequence[int]) -> Array:
        """Return the torque of a set in the logs after; each block of time is left out of the fit that predicts it.

        Args:
            chosen: Indices of the set.

        Returns:
            In N·m or N, shape (samples after, n).
        """
        x, effects = self.differing, [self.evidence.effects[c] for c in chosen]
        f = np.zeros_like(x.prediction.residual)
        for change in x.put_right.keys() & set(effects):  # known as it is, columns are those of the rest
            recorded = [s.motion.effort for s in x.experiment.segments]
            f += x.experiment.torque_of(change, x.put_right[change], recorded)
        parts = ParameterBlocks.of(effects)
        for theta, block in zip(self.evidence.estimates(chosen), x.blocks, strict=True):
            for change, own in zip(effects, parts, strict=True):
                rest = theta[own] - x.put_right.get(change, 0.0)
                for j, columns in x.changes[change].columns.items():
                    f[block, j] += columns[block] @ rest
        return f[x.after]

    def _moves(self, now: tuple[int, ...]) -> Iterator[tuple[int, ...]]:
        """Yield sets that are better than a set: first simpler ones, then one with another change."""
        for one in now:
            rest = _without(now, one)
            best = self._best(rest)
            if best is None:
                yield rest
            elif best[0] != one and (one not in best[1] or self._rank(best[0]) < self._rank(one)):
                yield _sorted(*rest, best[0])
        for two in combinations(now, 2):
            rest = tuple(c for c in now if c not in two)
            best = self._best(rest)
            if best is not None and best[0] not in two and not self._refines(best[0], two):
                single = _sorted(*rest, best[0])
                if self._may_stand_for(single, now, rest):
                    yield single
        yield from self._with_plain_pairs(now)
        best = self._best(now)
        if best is not None:
            yield _sorted(*now, best[0])
        else:
            yield from self._with_hidden_pairs(now)

    def _with_hidden_pairs(self, now: tuple[int, ...]) -> Iterator[tuple[int, ...]]:
        """Yield sets with two more changes of a joint, those that explain most first.

        A change is uncertain while another one of its joint is what the blocks of time differ by. Beside each other
        both are certain.
        """
        effects, pairs = self.evidence.effects, set[tuple[int, ...]]()
        for one in self._largest(now):
            best = self._best((*now, one))
            if best is None:
                continue
            other = best[0]
            robot = self.differing.experiment.robot
            if share_a_joint(effects[one], effects[other], robot) and self.holds((*now, other), one):
                pairs.add(_sorted(*now, one, other))
        yield from sorted(pairs, key=lambda s: float(np.sum(self.evidence.unexplained(s))))

    def _largest(self, now: Sequence[int]) -> list[int]:
        """Return the changes that explain most beside a set, however uncertain, each in its best shape."""
        out: dict[str, int] = {}
        fits = self.evidence.fits(now)
        for c in self._visible(now, fits, fits.gain > 0):
            out.setdefault(self.evidence.effects[c].label, c)
        return [*out.values()][:LARGEST_HIDDEN]

    def _with_plain_pairs(self, now: tuple[int, ...]) -> Iterator[tuple[int, ...]]:
        """Yield sets with two plain effects in the place of one that refines both, those that explain most first.

        Friction that grew alike in both directions is no asymmetric friction, though one name explains all of it. Both
        must hold: of a motion that does not tell them apart, one would stand for both.
        """
        for one in now:
            rest, fewer = _without(now, one), self._parameters(one) - 2
            plain = [c for c in self._plain_forms(one) if c not in now]
            pairs = [
                _sorted(*rest, *two)
                for two in combinations(plain, 2)
                if fewer > 0 and self._refines(one, two)
            ]
            for simpler in sorted(pairs, key=lambda s: float(np.sum(self.evidence.unexplained(s)))):
                as_much = self._may_stand_for(simpler, now, rest, fewer)
                if as_much and all(self.holds(_without(simpler, c), c) for c in simpler if c in plain):
                    yield simpler

    def plain_form(self, one: int) -> int | None:
        """Return the index of the plain effect that a change refines first of all; None if it refines nothing.

        Args:
            one: Index of the change.
        """
        return next(iter(self._plain_forms(one)), None)

    def _plain_forms(self, one: int) -> list[int]:
        """Return the indices of the plain effects that a change refines."""
        refined = self.evidence.effects[one]
        labels = [(form.label, refined.sign) for form in plain_forms(refined.effect)]
        return [self._index[label] for label in labels if label in self._index]

    @cached_property
    def _index(self) -> dict[tuple[str, float], int]:
        """Index of each change by its label and its sign; of several shapes, the last."""
        return {(effect.label, effect.sign): c for c, effect in enumerate(self.evidence.effects)}

    def _refines(self, one: int, two: Sequence[int]) -> bool:
        """Tell whether a change is a finer form of two plain ones together, and so no simpler than these."""
        effects = self.evidence.effects
        plain = {form.label for form in plain_forms(effects[one].effect)}
        are_levels = {type(effects[c].effect) for c in two} == LEVELS
        return not are_levels and all(effects[c].label in plain for c in two)

    def _may_stand_for(
        self, simpler: Sequence[int], now: Sequence[int], rest: Sequence[int], fewer: int = 1
    ) -> bool:
        """Tell whether a simpler set explains about as much as another one.

        Args:
            simpler: Indices of the simpler set.
            now: Indices of the other one.
            rest: Indices of what both have.
            fewer: Number of parameters by which it is simpler [1].
        """
        left = self.evidence.unexplained
        return self.is_slight(left(simpler) - left(now), float(np.sum(left(rest) - left(simpler))), fewer)

    def _best(self, chosen: Sequence[int]) -> tuple[int, list[int]] | None:
        """Return the change to be added to a set, and all that explain as much; None if none can be named."""
        fits = self.evidence.fits(chosen)
        gain = fits.gain
        comparable = self._comparable(chosen, fits)
        if not comparable:
            return None
        most = max(comparable, key=lambda c: gain[c])
        alike = self._alike(most, comparable, fits)
        alike += self._plain_enough(chosen, most, [c for c in comparable if c not in alike])

        def simplicity(c: int) -> tuple[bool, tuple[int, float], float]:
            return self._is_loss(c, fits.theta[c]), self._rank(c), -gain[c]

        return min(alike, key=simplicity), alike

    def _plain_enough(self, chosen: Sequence[int], one: int, among: Sequence[int]) -> list[int]:
        """Return those plain forms of a change, among some, beside which its other parameters are too uncertain.

        What an offset leaves where a model errs, an asymmetric friction takes in with its other three parameters. In
        logs of measured arms this holds in 8 of 12 cases in which the plain effect was put in, and in 4 of 30 in which
        the finer one was.
        """
        least, size = self.settings.better_certainty, self.evidence.effects[one].size

        def of_others(plain: int) -> float:
            others = size - self.evidence.effects[plain].size
            of_all = float(self._of_all_parameters(self.evidence.fits([*chosen, plain]))[one])
            return of_all * float(np.sqrt(size / others)) if others else of_all

        return [c for c in self._plain_forms(one) if c in among and of_others(c) < least]

    def _comparable(self, chosen: Sequence[int], fits: BlockFits) -> list[int]:
        """Return the changes that can be named beside a set, and those that explain more than all of these."""
        nameable = self._nameable(chosen, fits)
        if not nameable:
            return []
        comparable = [*nameable, *self._better(chosen, nameable, fits)]
        return [*comparable, *self._there_instead(chosen, comparable, fits)]

    def _better(self, chosen: Sequence[int], nameable: Sequence[int], fits: BlockFits) -> list[int]:
        """Return the changes that are too uncertain to be named alone and explain more than all that are not.

        That something changed is certain then. What it is must not be the part of it with the fewest parameters.
        """
        gain = fits.gain
        most = max(nameable, key=lambda c: gain[c])
        return [
            c
            for c in self._visible(chosen, fits, self._less_certain(fits))
            if not self.is_slight(fits.gains[c] - fits.gains[most], gain[c])
        ]

    def _there_instead(self, chosen: Sequence[int], comparable: Sequence[int], fits: BlockFits) -> list[int]:
        """Return the changes that explain as much as the best ones, if all of these take away what was never there.

        That something changed is certain then. A spring of negative stiffness has two parameters, which are certain
        sooner than the ten of the link for which it stands.
        """
        most = max(comparable, key=lambda c: fits.gain[c])
        if not all(self._is_loss(c, fits.theta[c]) for c in self._alike(most, comparable, fits)):
            return []
        less_certain = self._alike(most, self._visible(chosen, fits, self._less_certain(fits)), fits)
        return [c for c in less_certain if c not in comparable and not self._is_loss(c, fits.theta[c])]

    def _alike(self, one: int, others: Sequence[int], fits: BlockFits) -> list[int]:
        """Return the changes that explain as much as one, itself included, the best first."""
        alike = [
            c
            for c in others
            if c != one
            and self.is_slight(
                fits.gains[one] - fits.gains[c], fits.gain[one], self._parameters(one) - self._parameters(c)
            )
        ]
        return sorted([one, *alike], key=lambda c: -fits.gain[c])

    def is_slight(self, lost: Array, explained: float, fewer: int = 1) -> bool:
        """Return True if what is lost on the blocks, shape (B,), may be chance or does not matter.

        Args:
            lost: What the one explains and the other does not [1].
            explained: What the one explains [1].
            fewer: Number of parameters by which the other is simpler [1].
        """
        spread = float(np.std(lost, ddof=1) * np.sqrt(len(lost) * np.clip(fewer, 1, MOST_FEWER)))
        return float(lost.sum()) < max(self.settings.alike * explained, self.settings.doubt * spread)

    def _parameters(self, change: int) -> int:
        """Return the number of parameters of a change, those of its shape included [1]."""
        effect = self.evidence.effects[change]
        return effect.size + len(effect.shape)

    def _rank(self, change: int) -> tuple[int, float]:
        """Return by what one of two changes that explain as much is named: fewer parameters, then a commoner effect."""
        return self._parameters(change), self.evidence.effects[change].plausibility.penalty

    def _nameable(self, chosen: Sequence[int], fits: BlockFits) -> list[int]:
        """Return the changes that can be named beside a set."""
        return self._visible(chosen, fits, self.certainty(fits) >= self.settings.least_certainty)

    def _less_certain(self, fits: BlockFits) -> NDArray[np.bool_]:
        """Return which changes are too uncertain to be named alone, and certain enough to explain what others are."""
        enough = self._of_all_parameters(fits) >= self.settings.better_certainty
        return np.asarray(enough & (self.certainty(fits) < self.settings.least_certainty))

    def _visible(self, chosen: Sequence[int], fits: BlockFits, among: NDArray[np.bool_]) -> list[int]:
        """Return the changes beside a set that are possible and of some size, among some, the best first."""
        present = {self.evidence.effects[c].label for c in chosen}
        some = np.flatnonzero(among)
        return [
            int(c)
            for c in some[np.argsort(-fits.gain[some])][:LARGEST_GAINS]
            if self.evidence.effects[c].label not in present
            and fits.gain[c] > 0
            and self._is_possible(int(c), fits)
            and self._is_visible(int(c), fits)
        ]

    def _is_possible(self, change: int, fits: BlockFits) -> bool:
        """Return True if the size of a change is within its bounds.

        An encoder's zero has a slope alone in the search. Where one is large, another one seems to be off by radians.
        """
        lower, upper = self.evidence.effects[change].bounds(self.differing.experiment.robot)
        return bool(np.all((lower <= fits.theta[change]) & (fits.theta[change] <= upper)))

    def _is_loss(self, change: int, theta: Array) -> bool:
        """Return True if a change takes away what neither every arm nor the model has, as a spring that grew weaker.

        Args:
            change: Index of the change.
            theta: Its parameters, shape (p,).
        """
        x, one = self.differing, self.evidence.effects[change]
        lower, upper = one.effect.bounds(x.experiment.robot)
        takes_away = one.sign < 0 or bool(np.any((theta < lower) | (theta > upper)))
        return takes_away and is_rare(one.effect, {t.effect for t in x.given.model.terms})

    def _is_visible(self, change: int, fits: BlockFits) -> bool:
        x, torque = self.differing, self.torque(change, fits.theta[change])
        samples = x.samples_with(self.evidence.effects[change])
        return self.settings.is_visible(float(fits.gain[change]), torque, x.size, x.torque, samples)


def _sorted(*chosen: int) -> tuple[int, ...]:
    return tuple(sorted(chosen))


def _without(chosen: Sequence[int], one: int) -> tuple[int, ...]:
    return tuple(c for c in chosen if c != one)
