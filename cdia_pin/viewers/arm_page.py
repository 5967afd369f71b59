"""An arm as one page: for a notebook, a file, or a browser, without a server."""

from __future__ import annotations

import html
import tempfile
import webbrowser
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

from cdia_pin.diagnosis.record import MonitorRun
from cdia_pin.discovery.comparison import Comparison
from cdia_pin.dynamics.dynamics import Dynamics
from cdia_pin.errors import CdiaError
from cdia_pin.logs.log import Log
from cdia_pin.viewers.page import asset, embeddable
from cdia_pin.viewers.scene import (
    Scene,
    Timeline,
    scene_assets,
    timeline_of_comparison,
    timeline_of_log,
    timeline_of_run,
)
from cdia_pin.whole_files import write_whole

if TYPE_CHECKING:
    from cdia_pin.robot.model import RobotModel

HEIGHT = 520  # [px] in a notebook


class ArmPage:
    """A picture of an arm that a notebook shows by itself.

    Args:
        scene: The arm.
        timeline: How it moves; None for a picture that rests.
        position: Where it rests then [rad or m], shape (n,).
        title: Of the page.
    """

    def __init__(
        self,
        scene: Scene,
        timeline: Timeline | None = None,
        position: ArrayLike | None = None,
        title: str = "",
    ) -> None:
        begin = position if timeline is None else timeline.position[0]
        self.notes = scene.notes
        self._title = title or scene.robot.name
        self._data = {
            "scene": scene.to_dict(begin),
            "timeline": None if timeline is None else timeline.to_dict(),
        }

    @property
    def html(self) -> str:
        """The page: one file that asks nothing of the network."""
        parts = scene_assets()
        return Template(asset("arm.html")).substitute(
            title=html.escape(self._title),
            licence=parts.licence.replace("--", "- -"),
            style=parts.style,
            meshcat=parts.meshcat,
            script=parts.script,
            data=embeddable(self._data),
        )

    def save(self, path: str | Path) -> Path:
        """Write the page.

        Args:
            path: Where to write; folders are made, an existing file is replaced.

        Returns:
            The path.

        Raises:
            CdiaError: If the file cannot be written.
        """
        path = Path(path)
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            write_whole(path, self.html)
        except OSError as error:
            raise CdiaError(f"the picture cannot be written to {path}: {error.strerror}") from None
        return path

    def open(self) -> Path:
        """Open the page in a browser, from a temporary file that the system clears later."""
        folder = Path(tempfile.mkdtemp(prefix="cdia-"))
        path = self.save(folder / "arm.html")
        webbrowser.open(path.as_uri())
        return path

    def _repr_html_(self) -> str:
        # A frame of its own, without rights: the notebook's page and this one do not see each other.
        page = html.escape(self.html, quote=True)
        style = f"width:100%;height:{HEIGHT}px;border:0"
        return f'<iframe sandbox="allow-scripts" style="{style}" srcdoc="{page}"></iframe>'


def view(
    robot: RobotModel | Dynamics, shown: MonitorRun | Comparison | Log | ArrayLike | None = None
) -> ArmPage:
    """Show an arm: at rest, along a log, or coloured by the state of its joints.

        view(robot)                        # at rest
        view(robot, [0, -1, 1, 0, 0, 0])   # in a pose
        view(model, compare(model, log))   # links coloured by the residual of the model
        view(model, replay(monitor, log))  # links coloured by the stages of a monitor

    Args:
        robot: The arm, or a model of it.
        shown: A monitor's run, a comparison, a log, or a pose [rad or m], shape (n,).

    Returns:
        A picture that a notebook shows; elsewhere ``.open()`` or ``.save(path)`` it.

    Raises:
        CdiaError: If what is to be shown belongs to another arm.
        MissingExtraError: If the extra ``view`` is not installed.
    """
    arm = robot.robot if isinstance(robot, Dynamics) else robot
    if not isinstance(shown, MonitorRun | Comparison | Log):
        return ArmPage(Scene.of(arm), position=shown)
    joints, timeline = _motion(shown)
    if joints != arm.joints:
        raise CdiaError(f"what is to be shown is of the joints {', '.join(joints)}, not of {arm.name}")
    return ArmPage(Scene.of(arm), timeline)


def _motion(shown: MonitorRun | Comparison | Log) -> tuple[tuple[str, ...], Timeline]:
    if isinstance(shown, MonitorRun):
        return shown.joints, timeline_of_run(shown)
    if isinstance(shown, Comparison):
        return shown.model.robot.joints, timeline_of_comparison(shown)
    return shown.joints, timeline_of_log(shown)
