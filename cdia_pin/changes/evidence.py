"""Evidence for differences between logs, after everything that the logs may have in common."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from cdia_pin.changes.common_structure import common_effects, smooth_functions
from cdia_pin.changes.difference import Difference
from cdia_pin.effects import LinkInertia, ToolWrench, ViscousMedium
from cdia_pin.regression.design_matrix import DesignMatrix
from cdia_pin.regression.experiment import Experiment, Prediction, rms
from cdia_pin.regression.noise import fit_noise
from cdia_pin.regression.normal_equations import NormalEquations
from cdia_pin.regression.shared_parameters import ColumnGroup, SharedRegression
from cdia_pin.regression.whitening import Whitening
from cdia_pin.selection.candidates import LARGE_FAMILY, SCREENED, enumerate_candidates
from cdia_pin.selection.discovery_settings import DiscoverySettings
from cdia_pin.selection.evidence import Evidence

Array = NDArray[np.float64]

GENERIC_SIZE = 10  # parameters [1]; effects with as many or more would fit noise in its first estimate
# Searched for only if asked: links do not change, and a steady force on a tool is nearly always a weight.
UNUSUAL = (LinkInertia, ToolWrench, ViscousMedium)
ROUNDS = 2  # rounds [1] of weighting, because weights and residuals depend on each other
INF = float("inf")


@dataclass(frozen=True, repr=False)
class Differing:
    """Logs before and after, columns of what they have in common, and columns of how they may differ.

    Attributes:
        experiment: The conditioned logs, those before first.
        prediction: Prediction of the model with which both sides are compared.
        after: True for compared samples of the logs after, shape (K,).
        common: Columns of what the logs may have in common.
        changes: Columns of what may differ by joint, zero before [N·m or N per unit], shape (K, p) each.
        searched: Number of shapes in which each change is looked for, by label.
        noise: Rough noise of each joint's compared torque [N·m or N], shape (n,).
        settings: What may have changed, and what it must explain.
        edges: First sample of each block of time and the end, shape (B + 1,). No block has samples of both sides.
    """

    experiment: Experiment
    prediction: Prediction
    after: NDArray[np.bool_]
    common: tuple[ColumnGroup, ...]
    changes: dict[Difference, dict[int, Array]]
    searched: dict[str, int]
    noise: Array
    settings: DiscoverySettings
    edges: NDArray[np.intp]

    def __repr__(self) -> str:
        return f"Differing({self.experiment!r}, {len(self.changes)} candidates)"

    @classmethod
    def of(
        cls,
        experiment: Experiment,
        prediction: Prediction,
        before: int,
        noise: Array,
        settings: DiscoverySettings,
    ) -> Self:
        """Compute all columns.

        Args:
            experiment: The conditioned logs, those before first.
            prediction: Prediction of the model.
            before: Number of logs before.
            noise: Rough noise of each joint's compared torque [N·m or N], shape (n,).
            settings: What may have changed, and the number of blocks of time per side.
        """
        columns, robot = DesignMatrix(experiment), experiment.robot
        ends = np.cumsum([0, *experiment.lengths])
        after = np.arange(ends[-1]) >= ends[before]
        logs = tuple(s.state.log for s in experiment.segments[before:])
        # a change is a difference between the logs, so no candidate has parameters per log besides
        families = enumerate_candidates(experiment, prediction, replace(settings, per_log=()))
        changes = {}
        asked = settings.effects or ()
        for effect in (e for family in families for e in family):
            if isinstance(effect, UNUSUAL) and effect.name not in asked:
                continue
            change = Difference(effect, logs)
            x = columns.of(change, prediction)
            changes[change] = {j: x[:, i, :] for i, j in enumerate(effect.acts_on(robot))}
        sides = ((0, ends[before]), (ends[before], ends[-1]))
        edges = [np.linspace(start, stop, settings.blocks + 1) for start, stop in sides]
        differing = cls(
            experiment,
            prediction,
            after,
            tuple(common_effects(experiment, prediction, columns)),
            changes,
            {f[0].label: len(f) for f in families},
            noise,
            settings,
            np.concatenate([edges[0][:-1], edges[1]]).astype(int),
        )
        left = rms(differing.beside_common(differing.generic())[0], experiment.informative)
        smooth = smooth_functions(experiment, prediction, left)
        return replace(differing, common=(*differing.common, *smooth))

    def generic(self) -> list[Difference]:
        """Return all changes of few parameters and few shapes; what they leave together is surely noise."""
        few = [c for c in self.changes if c.size < GENERIC_SIZE and self.searched[c.label] <= LARGE_FAMILY]
        return list({c.label: c for c in reversed(few)}.values())

    def whitened(self, changed: Sequence[Difference]) -> Whitening:
        """Return the noise that the common structure and some changes leave.

        Args:
            changed: The changes.
        """
        x = self.experiment
        left, used = self.beside_common(changed)
        parts = zip(left.T, x.informative.T, x.nearness.T, used, strict=True)
        noise = [
            fit_noise(e, use, near, x.lengths, m, settings=self.settings.noise) for e, use, near, m in parts
        ]
        misfit = np.maximum(rms(left, x.informative) / self.noise, 1.0)
        noise = [replace(m, sigma=m.sigma * more) for m, more in zip(noise, misfit, strict=True)]
        return Whitening.of(x, noise, self.edges)

    def beside_common(self, changed: Sequence[Difference] = ()) -> tuple[Array, Array]:
        """Return the residual of a fit of the common structure and some changes.

        Args:
            changed: The changes.

        Returns:
            Residual [N·m or N], shape (K, n), and the effective number of parameters of each joint [1], shape (n,).
        """
        use, residual = self.experiment.informative, self.prediction.residual
        size = np.maximum(rms(residual, use), 1e-12)
        for _ in range(ROUNDS):  # weights follow from the residual, and the residual from the weights
            scaled = lambda j, x, size=size: np.where(use[:, [j]], x / size[j], 0.0)  # noqa: E731
            left, used = SharedRegression.of(
                [*self.common, *self._parts(changed)], residual, scaled
            ).residual()
            left = left * size
            size = np.maximum(rms(left, use), 1e-12)
        return left, used

    def evidence(self, whitening: Whitening, found: Collection[Difference] = ()) -> Evidence:
        """Return the evidence for all changes, after the common structure is projected out.

        Args:
            whitening: Noise and blocks of time.
            found: Changes that are candidates in any case; of other large families only the best shapes are.
        """
        robot, residual = self.experiment.robot, self.prediction.residual
        effects = self._screened(whitening, found)
        regression = SharedRegression.of([*self.common, *self._parts(effects)], residual, whitening.joint)
        rows, prior = regression.beside(len(regression.precision) - sum(e.size for e in effects))
        pairs = list(zip(self.edges[:-1], self.edges[1:], strict=True))
        blocks = np.stack([sum(r[start:stop].T @ r[start:stop] for r in rows) for start, stop in pairs])
        blocks += prior / len(blocks)
        return Evidence(
            NormalEquations(robot, effects, blocks, whitening.samples),
            self.settings.criterion,
            searched=self.searched,
            needed=self.settings.criterion.least_share_of_change
            * np.array([np.sum(r[self.after, -1] ** 2) for r in rows]),
        )

    def _parts(self, changes: Sequence[Difference]) -> list[ColumnGroup]:
        return [ColumnGroup(self.changes[c], np.full(c.size, INF)) for c in changes]

    def _screened(self, whitening: Whitening, found: Collection[Difference]) -> list[Difference]:
        """Return the changes; of large families only the shapes that fit best."""
        every = list(self.changes)
        regression = SharedRegression.of(
            [*self.common, *self._parts(every)], self.prediction.residual, whitening.joint
        )
        first = len(regression.precision) - sum(c.size for c in every)
        gram = regression.gram[first:, first:] - regression.gram[first:, :first] @ regression.explained_by(
            first
        )
        gains = NormalEquations(self.experiment.robot, every, gram[None], whitening.samples).gains(())
        kept: dict[str, list[Difference]] = {}
        for c in np.argsort(gains)[::-1]:
            family = kept.setdefault(every[c].label, [])
            if every[c] in found or len(family) < SCREENED or self.searched[every[c].label] <= LARGE_FAMILY:
                family.append(every[c])
        return [c for family in kept.values() for c in family]
