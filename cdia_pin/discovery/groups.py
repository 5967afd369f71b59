"""Groups: effects of one kind on several joints are one line for people, such as friction on all six joints."""

from __future__ import annotations

from cdia_pin.effects import Effect
from cdia_pin.effects.inertia import LinkInertia
from cdia_pin.effects.link_inertias import LinkInertias

FRICTION, LINKS = "friction", "links unlike the URDF"


def group_of(effect: Effect) -> str:
    """Return the group that an effect is shown in: friction, links, or its own kind on all joints.

    Args:
        effect: The effect.
    """
    if effect.traits.dissipative and effect.scope:
        return FRICTION
    if isinstance(effect, LinkInertia | LinkInertias):
        return LINKS
    return effect.name.replace("_", " ")
