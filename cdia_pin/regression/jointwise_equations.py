"""Normal equations that are the sum of those of single joints, put together when they are asked for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cdia_pin.effects import Effect
from cdia_pin.regression.normal_equations import NormalEquations
from cdia_pin.robot.model import RobotModel

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


@dataclass(frozen=True, eq=False, repr=False)
class JointGram:
    """Normal equations of the samples of one joint.

    Attributes:
        at: Positions of its columns among those of [X y], shape (p,).
        blocks: [X y]ᵀ[X y] of its columns in each block of time, shape (B, p, p).
    """

    at: Indices
    blocks: Array

    def __repr__(self) -> str:
        return f"JointGram({len(self.at)} columns, {len(self.blocks)} blocks)"


class JointwiseEquations(NormalEquations):
    """XᵀX and Xᵀy of effects, from those of single joints.

    A fit needs the sum over the blocks of time alone. The blocks of all parameters are many times larger, and are
    formed only where some are left out.

    Args:
        robot: The robot, for physical bounds.
        effects: The effects whose columns are in X, in this order.
        joints: Normal equations of each joint.
        samples: Number of whitened samples of all joints.
    """

    def __init__(
        self, robot: RobotModel, effects: Sequence[Effect], joints: Sequence[JointGram], samples: int
    ) -> None:
        self.robot = robot
        self.effects = effects
        self.samples = samples
        self.joints = tuple(joints)

    def __repr__(self) -> str:
        size = f"{len(self.effects)} effects, {self.parameters.total} parameters"
        return f"JointwiseEquations({size}, {len(self.joints)} joints, {self.samples} samples)"

    @cached_property
    def total(self) -> Array:
        """Sum of the blocks, shape (P + 1, P + 1)."""
        out = np.zeros((self.parameters.total + 1,) * 2)
        for joint in self.joints:
            out[np.ix_(joint.at, joint.at)] += joint.blocks.sum(axis=0)
        return out

    @cached_property
    def blocks(self) -> Array:  # type: ignore[override]
        """[X y]ᵀ[X y] of each block of time, shape (B, P + 1, P + 1)."""
        size = self.parameters.total + 1
        out = np.zeros((len(self.joints[0].blocks), size, size))
        for joint in self.joints:
            out[:, joint.at[:, None], joint.at] += joint.blocks
        return out
