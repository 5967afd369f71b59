"""The first step: a robot and a log, by path or dropped on the page, with names, units and gains."""

from __future__ import annotations

from nicegui import ui

from cdia_pin.app.column_table import column_table
from cdia_pin.app.dropped import LARGEST
from cdia_pin.app.elements import DropElement
from cdia_pin.app.inputs import Request
from cdia_pin.app.mapping_table import mapping_table
from cdia_pin.app.parts import button, folded, node
from cdia_pin.app.workbench import Workbench
from cdia_pin.logs.conversion import ANGLES, LENGTHS, TORQUES
from cdia_pin.logs.formats import FORMATS
from cdia_pin.logs.timestamps import SECONDS
from cdia_pin.resources import logs_dir
from cdia_pin.robot import catalogue

DEMO = Request("ur5", logs_dir() / "demo_ur5.csv")
AUTOMATIC = "automatic"  # the format, or the log, says it
CHOICES = {
    "angle": ("Angles", {"": AUTOMATIC, **{u: u for u in ANGLES}}),
    "length": ("Lengths", {u: u for u in LENGTHS}),
    "torque": (
        "Torques",
        {u: u for u in TORQUES} | {"Nm": "N·m", "Nmm": "N·mm"},
    ),
    "time": ("Times", {"": AUTOMATIC, **{u: u for u in SECONDS}}),
}


def load_step(bench: Workbench) -> None:
    """Build the form; its texts stay in the workbench while the page changes.

    Args:
        bench: The workbench.
    """
    desk = bench.desk
    with node("datalist", id="robots"):
        for name, entry in catalogue().items():
            node("option", entry.description, value=name)
    _field(bench, "robot", "Robot", "a name, or the path of a URDF", "list=robots")
    if desk.form.model is not None:
        with node("p", data_mark="saved-model"):
            node("span", f"with the terms of {desk.form.model.name} ", "soft")
            button(
                "Remove",
                bench.remove_model,
                mark="remove-model",
                classes="quiet",
                label="Remove the saved model",
            )
    with node("div", classes="beside"):
        _field(bench, "log", "Log", "path of a log")
        files = node(
            "button", "Files…", "button", type="button", data_mark="upload", aria_label="Choose files"
        )
        files.on("click", js_handler=DropElement.CHOOSE)
    node(
        "p",
        "Or drop files anywhere on the page: a log (CSV, Parquet, npz, ROS 2 bag, LeRobot dataset), a URDF with its "
        "meshes as a folder or a zip file, drive gains, a saved model. "
        f"A dropped file has at most {LARGEST} MB; a path has no limit.",
        "soft",
    )
    unmapped = bool({"mapping", "log", "episode"} & set(desk.faults)) or bool(desk.cell_faults)
    with folded("Format, names, units, drive gains", mark="mapping", open_=unmapped or not desk.form.plain):
        if "mapping" in desk.faults:
            node("p", desk.faults["mapping"], "fault", data_mark="mapping-fault")
        with node("div", classes="units"):
            formats = {"": AUTOMATIC, **{name: name for name in FORMATS}}
            ui.select(formats, label="Format", value=desk.form.format).bind_value_to(
                desk.form, "format"
            ).props("outlined dense options-dense data-mark=format")
            _field(bench, "episode", "Episode", "of a LeRobot dataset")
            _field(bench, "rate", "Rate [Hz]", "of rows without times")
            for unit, (name, known) in CHOICES.items():
                ui.select(known, label=name, value=desk.form.units[unit]).bind_value_to(
                    desk.form.units, unit
                ).props(f"outlined dense options-dense data-mark=unit-{unit}")
        column_table(desk)
        if desk.arm is not None:
            mapping_table(desk, desk.arm.robot.joints)
        else:
            node("p", "The joints can be named here once the robot is read.", "soft")
    with node("div", classes="actions"):
        button("Load", bench.submit, mark="load", classes="primary")
        button("Try the demo log", lambda: bench.load(DEMO), mark="demo")


def _field(bench: Workbench, name: str, label: str, hint: str, more: str = "") -> None:
    """Show a field of the form, with what is wrong with it; its text stays."""
    form, fault = bench.desk.form, bench.desk.faults.get(name)
    field = ui.input(label, value=getattr(form, name), placeholder=hint).bind_value_to(form, name)
    field.props(f"outlined dense stack-label data-mark={name} {more}")
    field.error = fault
