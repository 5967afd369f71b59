"""The first step: a robot and a log, by path or upload, with names, units and gains."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from nicegui import events, ui

from cdia_pin.app.form import Form
from cdia_pin.app.inputs import Request
from cdia_pin.app.parts import button, folded, node
from cdia_pin.errors import LogError
from cdia_pin.logs.conversion import ANGLES, LENGTHS, TORQUES
from cdia_pin.logs.timestamps import SECONDS
from cdia_pin.resources import logs_dir
from cdia_pin.robot import RobotModel, catalogue

LARGEST = 500  # [MB], of a log that is uploaded
SUFFIXES = ".csv,.tsv,.txt,.parquet,.pq,.npz,.db3,.mcap"
DEMO = Request("ur5", logs_dir() / "demo_ur5.csv")
CHOICES = {
    "angle": ("Angles", {u: u for u in ANGLES}),
    "length": ("Lengths", {u: u for u in LENGTHS}),
    "torque": (
        "Torques",
        {"Nm": "N·m", "Nmm": "N·mm", "A": "A"} | {u: u for u in TORQUES if u not in "NmmA"},
    ),
    "time": ("Times", {"": "automatic", **{u: u for u in SECONDS}}),
}
COLUMNS = {"label": "name in the log", "gain": "gain [N·m/A]", "reduction": "gear ratio"}
FLIPS = {"flip_position": "flip q", "flip_effort": "flip τ"}


class LoadStep:
    """The form of the first step; it keeps its texts while the rest of the page changes.

    Args:
        load: Called with the request.
        refuse: Called with a sentence that says why something cannot be used.
    """

    def __init__(self, load: Callable[[Request], Any], refuse: Callable[[str], None]) -> None:
        self.form = Form()
        self._load, self._refuse = load, refuse
        self._folder = tempfile.TemporaryDirectory(prefix="cdia-app-")

    def close(self) -> None:
        """Delete what was uploaded."""
        self._folder.cleanup()

    def show(self, robot: RobotModel | None) -> None:
        """Build the form.

        Args:
            robot: The arm that is loaded, whose joints can be named; None before one is.
        """
        form = self.form
        with node("datalist", id="robots"):
            for name, entry in catalogue().items():
                node("option", entry.description, value=name)
        ui.input("Robot", value=form.robot, placeholder="a name, or the path of a URDF").bind_value_to(
            form, "robot"
        ).props("outlined dense stack-label list=robots data-mark=robot")
        with node("div", classes="beside"):
            self._path = ui.input("Log", value=form.log, placeholder="path of a log").bind_value_to(
                form, "log"
            )
            self._path.props("outlined dense stack-label data-mark=log")
            upload = ui.upload(
                auto_upload=True,
                max_file_size=LARGEST * 10**6,
                on_upload=self._receive,
                on_rejected=lambda: self._too_large("The file"),
            )
            upload.props(f"accept={SUFFIXES}").classes("hidden-upload")
            button("Upload…", lambda: upload.run_method("pickFiles"), mark="upload", label="Upload a log")
        node(
            "p",
            f"CSV, Parquet, npz, or a ROS 2 bag. An upload has at most {LARGEST} MB; a path has no limit.",
            "soft",
        )
        with folded("Names, units, drive gains", mark="mapping", open_=not form.plain):
            with node("div", classes="units"):
                for key, (name, known) in CHOICES.items():
                    ui.select(known, label=name, value=form.units[key]).bind_value_to(form.units, key).props(
                        f"outlined dense options-dense data-mark=unit-{key}"
                    )
            if robot is not None:
                self._table(robot)
            else:
                node("p", "Load the robot first to name its joints here.", "soft")
        with node("div", classes="actions"):
            button("Load", self._submit, mark="load", classes="primary")
            button("Try the demo log", self._try, mark="demo")

    def _table(self, robot: RobotModel) -> None:
        with node("div", classes="scroll"), node("table", classes="mapping"):
            with node("thead"), node("tr"):
                for head in ("joint", *COLUMNS.values(), *FLIPS.values()):
                    node("th", head)
            with node("tbody"):
                for joint in robot.joints:
                    with node("tr"):
                        node("td", joint)
                        for key, head in COLUMNS.items():
                            self._cell(
                                joint, key, head, "value", inputmode="text" if key == "label" else "decimal"
                            )
                        for key, head in FLIPS.items():
                            self._cell(joint, key, head, "checked", type="checkbox")

    def _cell(self, joint: str, key: str, head: str, what: str, **attributes: str) -> None:
        with node("td"):
            cell = node("input", aria_label=f"{joint}: {head}", data_mark=f"{key}-{joint}", **attributes)
            if value := self.form.joints.get(joint, {}).get(key):
                cell.props[what] = value
            cell.on(
                "change",
                lambda event: self.form.note(joint, key, event.args),
                js_handler=f"(event) => emit(event.target.{what})",
            )

    def _submit(self) -> Any:
        try:
            return self._load(self.form.request())
        except LogError as error:
            return self._refuse(str(error))

    def _try(self) -> Any:
        self.form.take(DEMO)
        return self._load(DEMO)

    async def _receive(self, event: events.UploadEventArguments) -> None:
        if event.file.size() > LARGEST * 10**6:
            self._too_large(event.file.name)
            return
        path = Path(self._folder.name) / Path(event.file.name).name
        await event.file.save(path)
        self.form.uploads[str(path)] = path.name
        self._path.value = str(path)

    def _too_large(self, name: str) -> None:
        self._refuse(f"{name} is larger than {LARGEST} MB: give its path instead.")
