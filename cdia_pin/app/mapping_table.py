"""The table of joints in the form: names in the log, drive gains, gear ratios and flipped axes."""

from __future__ import annotations

from collections.abc import Sequence

from cdia_pin.app.form import FLIPS
from cdia_pin.app.load_desk import LoadDesk
from cdia_pin.app.parts import node

COLUMNS = {
    "label": ("name in log", "name in the log"),
    "gain": ("N·m/A", "drive gain"),
    "reduction": ("gear", "gear ratio"),
    "flip_position": ("−q", "flip position"),
    "flip_effort": ("−τ", "flip torque"),
}  # heads, and what they mean


def mapping_table(desk: LoadDesk, joints: Sequence[str]) -> None:
    """Show a row for each joint; what is typed stays, and what is wrong with it stands below.

    Args:
        desk: Whose form is filled.
        joints: Joints of the robot.
    """
    columns = desk.columns
    names = columns.labels if columns is not None else ()
    with node("datalist", id="labels"):
        for label in names:
            node("option", value=label)
    if columns is not None and columns.currents and not all(desk.form.cell(j, "gain") for j in joints):
        node(
            "p",
            "The log has motor currents: type each drive gain, or drop a file with them. A tolerance may follow: "
            "14.9 ± 0.7.",
        )
    if columns is not None and columns.proposed(joints):
        node(
            "p",
            "The names are proposed in the order of the log: look at them before you press Load.",
            data_mark="proposed",
        )
    with node("div", classes="scroll"), node("table", classes="mapping"):
        with node("thead"), node("tr"):
            node("th", "joint")
            for head, meaning in COLUMNS.values():
                node("th", head, title=meaning)
        with node("tbody"):
            for joint in joints:
                with node("tr"):
                    node("td", joint)
                    _cell(desk, joint, "label", "value", list="labels")
                    _cell(desk, joint, "gain", "value", inputmode="decimal")
                    _cell(desk, joint, "reduction", "value", inputmode="decimal")
                    for key in FLIPS:
                        _cell(desk, joint, key, "checked", type="checkbox")
    for mark, sentence in desk.cell_faults.items():
        node("p", sentence, "fault", id=f"fault-{mark}")


def _cell(desk: LoadDesk, joint: str, key: str, what: str, **attributes: str) -> None:
    """Show a cell; its text or mark is the property ``what`` of the element: ``value`` or ``checked``."""
    mark = f"{key}-{joint}"
    with node("td"):
        cell = node("input", aria_label=f"{joint}: {COLUMNS[key][1]}", data_mark=mark, **attributes)
        if value := desk.form.cell(joint, key):
            cell.props[what] = value if isinstance(value, bool) else str(value)
        if mark in desk.faults:
            cell.props["aria-invalid"] = "true"
            cell.props["aria-describedby"] = f"fault-{mark}"
        cell.on(
            "change",
            lambda event: desk.form.note(joint, key, event.args),
            js_handler=f"(event) => emit(event.target.{what})",
        )
