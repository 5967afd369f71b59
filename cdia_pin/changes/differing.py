"""Logs before and after, with the columns of what they have in common and of how they may differ."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product
from typing import Self

import numpy as np
from numpy.typing import NDArray

from cdia_pin.changes.common_structure import common_effects, is_rare, plainly_fitted
from cdia_pin.changes.difference import Difference
from cdia_pin.changes.overlap import Overlap
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import Effect, Signal, Term
from cdia_pin.regression.block_evidence import BlockEvidence
from cdia_pin.regression.design_matrix import DesignMatrix
from cdia_pin.regression.experiment import Experiment, Prediction, rms
from cdia_pin.regression.normal_equations import REPEATED
from cdia_pin.regression.shared_parameters import ColumnGroup, SharedRegression
from cdia_pin.regression.speed_parts import speed_parts
from cdia_pin.regression.time_blocks import Block, distinct_time, time_blocks
from cdia_pin.selection.candidates import LARGE_FAMILY, best_shapes, enumerate_candidates
from cdia_pin.selection.discovery_settings import DiscoverySettings
from cdia_pin.selection.problem import GENERIC_SIZE

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Counts = NDArray[np.intp]

ROUNDS = 2  # rounds [1] of weighting, because weights and residuals depend on each other


@dataclass(frozen=True, repr=False)
class Differing:
    """Logs before and after, columns of what they have in common, and columns of how they may differ.

    Attributes:
        experiment: The conditioned logs, those before first.
        before: Number of logs before.
        columns: Columns of effects; those that depend on the motion alone are computed once.
        given: Prediction of the model as it is known, for the logs as they were recorded.
        prediction: Prediction of that model with what every arm has, fitted to both sides.
        after: True for compared samples of the logs after, shape (K,).
        overlap: Samples that count, of joints that move alike in both logs.
        common: Columns of what the logs may have in common.
        changes: Columns of what may differ, zero in the logs that do not have it, without a prior.
        searched: Number of shapes in which each change is looked for, by label.
        blocks: Samples of each block of time. No block has samples of both sides.
        settings: What may have changed, and what it must explain.
        size: RMS torque of each joint that no effect explains, the weight of its rows [N·m or N], shape (n,).
        put_right: Changes of which the logs are free already, and their parameters, shape (p,) each.
        unchanged: Labels of effects that all logs have, of which no change is looked for.
    """

    experiment: Experiment
    before: int
    columns: DesignMatrix
    given: Prediction
    prediction: Prediction
    after: Mask
    overlap: Overlap
    common: tuple[ColumnGroup, ...]
    changes: dict[Difference, ColumnGroup]
    searched: dict[str, int]
    blocks: list[Block]
    settings: DiscoverySettings
    size: Array
    put_right: Mapping[Difference, Array] = field(default_factory=dict)
    unchanged: frozenset[str] = frozenset()

    def __repr__(self) -> str:
        return f"Differing({self.experiment!r}, {len(self.changes)} candidates)"

    @classmethod
    def of(cls, experiment: Experiment, model: Dynamics, before: int, settings: DiscoverySettings) -> Self:
        """Compute all columns.

        Args:
            experiment: The conditioned logs, those before first.
            model: The model as it is known.
            before: Number of logs before.
            settings: What may have changed, and the number of blocks of time per side.
        """
        columns, robot = DesignMatrix(experiment), experiment.robot
        prediction = experiment.predict(plainly_fitted(model, experiment))
        ends = np.cumsum([0, *experiment.lengths])
        after = np.arange(ends[-1]) >= ends[before]
        overlap = Overlap.of(experiment, after, settings.changes)
        used = overlap.used
        names = tuple(s.state.log for s in experiment.segments)
        both = ((names[before:], 1.0, after), (names[:before], -1.0, ~after))
        changes: dict[Difference, ColumnGroup] = {}
        searched: dict[str, int] = {}
        # A change is a difference between the logs, so no candidate has parameters per log besides. A gain that one of
        # them has scales friction too, so it differs from every other change where a joint carries nothing.
        every_load = replace(settings.criterion, least_rigid_share=0.0)
        asked = replace(settings, per_log=(), criterion=every_load)
        present = {t.label: t.effect for t in model.terms}
        for every in enumerate_candidates(experiment, prediction, asked):
            label, joints = every[0].label, every[0].acts_on(robot)
            # a model may have an unusual effect only because it describes its log
            if settings.is_unusual(every[0]) or not used[:, list(joints)].any():
                continue
            # what the model has may change its size, not its shape
            family = [present[label]] if label in present else every
            searched[family[0].label] = len(family)
            sides = both if settings.changes.gone and _may_be_gone(family[0], present.values()) else both[:1]
            for effect in family:
                whole = columns.of(effect, prediction)
                for logs, sign, there in sides:
                    change = Difference(effect, logs, sign)
                    changes[change] = ColumnGroup.of(change, sign * whole * there[:, None, None], robot)
        count, segments = settings.changes.blocks, experiment.segments
        later = time_blocks(segments[before:], count, first=int(ends[before]))
        differing = cls(
            experiment,
            before,
            columns,
            experiment.predict(model),
            prediction,
            after,
            overlap,
            tuple(common_effects(experiment, prediction, columns, rare=settings.changes.rare)),
            changes,
            searched,
            [*time_blocks(segments[:before], count), *later],
            settings,
            np.maximum(rms(prediction.residual, used), 1e-12),
        )
        return differing._weighted()

    def about(self, changes: Mapping[Difference, Array]) -> Self:
        """Return the same logs with some changes alone, and columns that are right for their sizes.

        Other effects of their joints that depend on the torque are left out. A gain that both logs have is beside a
        gain that one has the same as heavier links, so the two could not be told apart. They stay beside a delay, which
        does not scale the torque: without friction under load, delays of a UR3 are 12 % too small.

        Args:
            changes: Parameters of the changes, shape (p,) each.
        """
        x, columns = self.experiment, self.columns.following_zeros()
        left = {change: theta - self.put_right.get(change, 0.0) for change, theta in changes.items()}
        terms = [Term(change, tuple(theta)) for change, theta in left.items()]
        prediction = x.predict(plainly_fitted(Dynamics(x.robot, (*self.given.model.terms, *terms)), x))
        joints = {j for change in changes if not _is_of_time(change) for j in change.acts_on(x.robot)}

        def is_common(effect: Effect) -> bool:
            by_torque = Signal.TORQUE in effect.traits.depends_on
            return effect not in changes and not (by_torque and joints.intersection(effect.acts_on(x.robot)))

        common = common_effects(x, prediction, columns, is_common, self.settings.changes.rare)
        own = {
            change: ColumnGroup.of(change, columns.of(change, prediction, theta), x.robot)
            for change, theta in left.items()
        }
        return replace(
            self, prediction=prediction, common=tuple(common), changes=own, searched={}, put_right={}
        )

    @property
    def names(self) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """Names of the logs before and of those after."""
        names = tuple(s.state.log for s in self.experiment.segments)
        return names[: self.before], names[self.before :]

    @property
    def used(self) -> Mask:
        """True for samples that count, shape (K, n)."""
        return self.overlap.used

    @cached_property
    def counted(self) -> Mask:
        """True for samples of the logs after that count, shape (K, n)."""
        return self.used & self.after[:, None]

    @cached_property
    def counted_before(self) -> Mask:
        """True for samples of the logs before that count, shape (K, n)."""
        return self.used & ~self.after[:, None]

    def counted_with(self, change: Difference) -> Mask:
        """Return True for samples that count of the logs in which a change is present, shape (K, n).

        Args:
            change: The change.
        """
        return self.counted if change.sign > 0 else self.counted_before

    @cached_property
    def samples(self) -> Counts:
        """Number of samples of the logs after that count [1], shape (n,)."""
        return np.asarray(self.counted.sum(axis=0))

    def samples_with(self, change: Difference) -> Counts:
        """Return the number of samples that count of the logs in which a change is present [1], shape (n,).

        Args:
            change: The change.
        """
        return self.samples if change.sign > 0 else np.asarray(self.counted_before.sum(axis=0))

    def mean_squares(self, change: Difference) -> dict[int, Array]:
        """Return the mean of XᵀX of a change over the samples that count of the logs that have it, of each joint.

        Args:
            change: The change, of p parameters.

        Returns:
            By the joint's index, in the square of the unit of a column, shape (p, p) each.
        """
        counted, samples = self.counted_with(change), np.maximum(self.samples_with(change), 1)
        columns = ((j, x[counted[:, j]]) for j, x in self.changes[change].columns.items())
        return {j: x.T @ x / samples[j] for j, x in columns}

    @cached_property
    def torque(self) -> Array:
        """RMS of the measured torque where it counts [N·m or N], shape (n,)."""
        return np.maximum(rms(self.experiment.measured, self.used), 1e-12)

    @property
    def block_time(self) -> float:
        """Duration of a block of the shorter side, without repeats [s]."""
        segments = self.experiment.segments
        sides = (segments[: self.before], segments[self.before :])
        return min(map(distinct_time, sides)) / self.settings.changes.blocks

    @property
    def has_same_motion(self) -> bool:
        """True if a log after drives the motion of one before."""
        logs = self.experiment.segments
        pairs = product(logs[self.before :], logs[: self.before])
        return any(after.lag_behind(before) is not None for after, before in pairs)

    @cached_property
    def residual(self) -> Array:
        """What the model leaves of the logs as recorded, as far as columns tell [N·m or N], shape (K, n)."""
        n = self.experiment.robot.n
        return sum(
            (self.changes[change].torque(theta, n) for change, theta in self.put_right.items()),
            start=self.prediction.residual,
        )

    def scaled(self, joint: int, columns: Array) -> Array:
        """Return columns of a joint in units of what is left there, zero for samples that do not count.

        Args:
            joint: Index of the joint.
            columns: Columns [N·m or N, per unit], shape (K, …).
        """
        return np.where(self.used[:, [joint]], columns / self.size[joint], 0.0)

    def together(self, changes: list[Difference]) -> SharedRegression:
        """Return the regression of the common structure and some changes; the changes have no prior.

        Args:
            changes: The changes.
        """
        groups = [*self.common, *(self.changes[c] for c in changes)]
        return SharedRegression.of(groups, self.residual, self.scaled)

    def beside_common(self, groups: Sequence[ColumnGroup]) -> Array:
        """Return the normal equations of some columns after the common structure is taken out, the response last.

        Args:
            groups: The columns, P of them.

        Returns:
            Shape (P + 1, P + 1).
        """
        first = sum(len(g.scale) for g in self.common)
        return SharedRegression.of([*self.common, *groups], self.residual, self.scaled).beside(first)

    def evidence(self) -> BlockEvidence[Difference]:
        """Return the evidence for all changes by blocks of time."""
        return self.evidence_for(self.screened())

    def evidence_for(self, changes: list[Difference]) -> BlockEvidence[Difference]:
        """Return the evidence for some changes by blocks of time.

        Args:
            changes: The changes.
        """
        parts = speed_parts(self.experiment, self.used)
        robot = self.experiment.robot
        return BlockEvidence.of(changes, self.together(changes), self.blocks, robot, parts)

    def with_both(self, effects: Sequence[Effect]) -> Self:
        """Return the same, where all logs may have some effects of any size, and no change of them is looked for.

        Args:
            effects: The effects.
        """
        robot = self.experiment.robot
        columns = (self.columns.of(e, self.prediction, np.zeros(e.size)) for e in effects)
        own = [ColumnGroup.of(e, x, robot) for e, x in zip(effects, columns, strict=True)]
        unchanged = self.unchanged.union(e.label for e in effects)
        return replace(self, common=(*self.common, *own), unchanged=unchanged)

    def screened(self) -> list[Difference]:
        """Return the changes; of large families on one joint only the shapes that fit best, before as well as after."""
        families: dict[tuple[str, float], list[Difference]] = {}
        for change in self.changes:
            if change.label not in self.unchanged:
                families.setdefault((change.label, change.sign), []).append(change)
        return [c for family in families.values() for c in self._best_shapes(family)]

    def _best_shapes(self, family: list[Difference]) -> list[Difference]:
        joints = family[0].acts_on(self.experiment.robot)
        if len(family) <= LARGE_FAMILY or len(joints) > 1:
            return family
        (j,) = joints
        own = [g for g in self.common if j in g.columns]
        alone = [ColumnGroup({0: g.columns[j]}, g.scale) for g in (*own, *(self.changes[c] for c in family))]
        regression = SharedRegression.of(alone, self.residual[:, [j]], lambda _, x: self.scaled(j, x))
        first = sum(len(g.scale) for g in own)
        left = regression.beside(first)
        gains = [self._gain(left, regression.gram[first:, first:], k, c.size) for k, c in enumerate(family)]
        return [family[k] for k in best_shapes(np.array(gains))]

    @staticmethod
    def _gain(left: Array, whole: Array, k: int, size: int) -> float:
        """Return what the k-th of several changes of equal size explains [1]."""
        own = slice(k * size, (k + 1) * size)
        ridge = REPEATED * np.diag(np.maximum(np.diag(whole[own, own]), 1e-300))
        right = left[own, -1]
        return float(right @ np.linalg.solve(left[own, own] + ridge, right))

    def _weighted(self) -> Self:
        """Return the same with rows weighted by what the common structure and all changes of few shapes leave."""
        few = [c for c in self.changes if c.size < GENERIC_SIZE and self.searched[c.label] <= LARGE_FAMILY]
        generic = list({c.label: c for c in reversed(few)}.values())
        out = self
        for _ in range(ROUNDS):  # weights follow from the residual, and the residual from the weights
            left, _ = out.together(generic).residual()
            out = replace(out, size=np.maximum(rms(left, out.used) * out.size, 1e-12))
        return out


def _may_be_gone(effect: Effect, present: Container[Effect]) -> bool:
    """Tell whether an effect that is in the logs before alone needs columns of its own.

    What both sides may have in common is there before, and less of it after. That says nothing of what may hardly be
    common. What scales the torque needs no such columns, since its size is a share of the torque before.

    Args:
        effect: The effect.
        present: Effects of the model.
    """
    scales = Signal.TORQUE in effect.traits.depends_on and not effect.traits.dissipative
    return is_rare(effect, present) and not scales


def _is_of_time(change: Difference) -> bool:
    """Return True if a change is of when a torque is read, not of its size."""
    return {Signal.TORQUE, Signal.TIME} <= change.traits.depends_on
