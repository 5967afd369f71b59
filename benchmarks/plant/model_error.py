"""An arm whose links are not quite what its file says: the model error that every monitor has to live with."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from benchmarks.plant.arm import Arm
from benchmarks.plant.urdf import LinkInertia, write_inertia


def erroneous(stated: Mapping[str, LinkInertia], size: float, seed: int) -> dict[str, LinkInertia]:
    """Return inertias that differ from the stated ones by up to a share, and are as physical as they were.

    Mass and the tensor about the centre of mass are multiplied by 1 ± size, each link by factors of its own;
    the centre of mass moves in a random direction by up to `size` times its distance from the link's frame.

    Args:
        stated: Inertia of each link.
        size: Largest relative error [1].
        seed: Seed of the draw.
    """
    rng = np.random.default_rng(seed)
    out = {}
    for name in sorted(stated):
        link = stated[name]
        mass, distance, tensor = rng.uniform(-size, size, 3)
        direction = rng.standard_normal(3)
        moved = distance * np.linalg.norm(link.com) * direction / np.linalg.norm(direction)
        out[name] = LinkInertia(link.mass * (1 + mass), link.com + moved, link.tensor * (1 + tensor))
    return out


def give(arm: Arm, inertias: Mapping[str, LinkInertia]) -> None:
    """Write inertias into a compiled arm."""
    for name, link in inertias.items():
        if name in arm.links:  # the base does not move
            write_inertia(arm.model, arm.model.body(name).id, link)
    arm.refresh()
