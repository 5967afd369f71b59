"""One tile for each joint: its error before and after."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from cdia_pin.app.parts import node
from cdia_pin.app.picture import improved
from cdia_pin.app.session import Session
from cdia_pin.viewers.words import percent, short_names


def tiles(session: Session, chosen: str, choose: Callable[[str], Any]) -> None:
    """Show the joints; each tile is a button that chooses its joint.

    Args:
        session: Its preview is shown in place of the present model, if there is one.
        chosen: Name of the joint that is chosen.
        choose: Called with the joint whose tile is pressed.
    """
    before, after = session.history.first.comparison, improved(session)
    robot = session.inputs.robot
    short = short_names(robot.joints)
    worst = robot.joints[(after or before).worst]
    largest = max(float(np.nan_to_num(before.relative_rms).max()), 1e-9)
    for j, joint in enumerate(robot.joints):
        first = float(before.relative_rms[j])
        last = first if after is None else float(after.relative_rms[j])
        is_worst = joint == worst
        said = f"{joint}: error {percent(first)}" + ("" if after is None else f", now {percent(last)}")
        said += ", the largest" if is_worst else ""
        tile = node(
            "button",
            classes="tile preview-tile" if session.preview else "tile",
            type="button",
            aria_label=said,
            aria_pressed="true" if joint == chosen else "false",
            data_mark=f"tile-{joint}",
            data_before=f"{first:.6f}",
            data_after=f"{last:.6f}",
        ).on("click", partial(choose, joint), args=[])
        with tile:
            with node("span", classes="head"):
                node("span", short[joint], "name")
                if is_worst:
                    node("span", "worst", "worst")
            with node("span", classes="numbers"):
                node("span", percent(first), "b" if after is None else "b was")
                if after is not None:
                    node("span", percent(last), "a")
            with node("span", classes="bar", aria_hidden="true"):
                node("i", classes="one", style=_width(first / largest))
                if after is not None:
                    node("i", classes="two", style=_width(last / largest))


def _width(share: float) -> str:
    """Return the style of a bar; a joint without torque has none."""
    return f"width:{100 * min(float(np.nan_to_num(share)), 1):.1f}%"
