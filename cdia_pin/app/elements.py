"""The arm and the charts as elements of a page."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypedDict

from nicegui.element import Element

from cdia_pin.viewers.report_data import JointReport
from cdia_pin.viewers.scene import Frame, SceneDocument, StageDocument, TimelineDocument


class JointTile(TypedDict):
    """What a tile says of its joint; ``unit`` is that of its torque, ``blind`` whether a fault could go unseen."""

    name: str
    short: str
    unit: str
    blind: bool


class ArmElement(Element, component="assets/arm.js", default_classes="arm-box"):
    """The picture of an arm; a click on a link chooses its joint.

    Args:
        choose: Called with the joint whose link was clicked, or None for none.
    """

    def __init__(self, choose: Callable[[str | None], Any]) -> None:
        super().__init__()
        self.on("joint", lambda event: choose(event.args))

    def draw(
        self, scene: SceneDocument, stages: list[StageDocument], reach: list[list[float]] | None = None
    ) -> None:
        """Draw an arm anew.

        Args:
            scene: Of `Scene.to_dict`.
            stages: What colours mean.
            reach: Positions that the picture must hold, where no motion is known yet [rad or m], shape (K, n).
        """
        self.run_method("draw", scene, stages, reach)

    def play(self, timeline: TimelineDocument, variant: int) -> None:
        """Show a motion.

        Args:
            timeline: The motion and its tracks.
            variant: Index of the track that colours it.
        """
        self.run_method("play", timeline, variant)

    def append(self, piece: Frame, stages: list[StageDocument]) -> None:
        """Show a piece of the timeline of a moving arm.

        Args:
            piece: New frames.
            stages: What colours mean.
        """
        self.run_method("append", piece, stages)

    def select(self, joint: str | None) -> None:
        """Highlight the link of a joint.

        Args:
            joint: Name; None for no link.
        """
        self.run_method("select", joint)


class ChartsElement(Element, component="assets/charts.js", default_classes="charts"):
    """The charts of one joint."""

    def draw(self, joint: JointReport) -> None:
        """Draw the charts of a joint.

        Args:
            joint: Of `picture.joint`.
        """
        self.run_method("draw", joint)


class DropElement(Element, component="assets/drop.js"):
    """Takes files that are dropped anywhere on the page, and those that are chosen.

    Args:
        address: To which the files are sent.
        suffixes: Ends of the names of files that can be of use.
        dropped: Called with the name of a folder below which all files of one drop are.
        refused: Called with a sentence that says why files cannot be taken.
    """

    CHOOSE = (
        "() => document.getElementById('drop-input').click()"  # what a button does that opens the dialogue
    )

    def __init__(
        self,
        address: str,
        suffixes: Sequence[str],
        dropped: Callable[[str], Any],
        refused: Callable[[str], Any],
    ) -> None:
        super().__init__()
        self.props["address"], self.props["suffixes"] = address, list(suffixes)
        self.on("dropped", lambda event: dropped(event.args))
        self.on("refused", lambda event: refused(event.args))


class LiveElement(Element, component="assets/live.js", default_classes="live-box"):
    """Tiles and a chart of a moving arm; a press on a tile chooses its joint.

    Args:
        choose: Called with the joint whose tile was pressed.
    """

    def __init__(self, choose: Callable[[str], Any]) -> None:
        super().__init__()
        self.on("joint", lambda event: choose(event.args))

    def begin(self, joints: list[JointTile], stages: list[StageDocument]) -> None:
        """Begin anew with the joints of an arm.

        Args:
            joints: One tile each.
            stages: What colours mean.
        """
        self.run_method("begin", joints, stages)

    def push(self, piece: Frame) -> None:
        """Show new frames.

        Args:
            piece: Of `LiveRun.take`.
        """
        self.run_method("push", piece)

    def select(self, joint: str) -> None:
        """Show the residual of a joint.

        Args:
            joint: Name.
        """
        self.run_method("select", joint)
