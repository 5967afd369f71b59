"""`BenchPage`: what a workbench asks of each page that shows it."""

from __future__ import annotations

from typing import Protocol


class BenchPage(Protocol):
    """What a workbench asks of each page that shows it."""

    def show(self, *marks: str) -> None:
        """Fill steps anew.

        Args:
            *marks: Which ones; all if none is given.
        """

    def draw_arm(self) -> None:
        """Draw the arm anew, and its motion."""

    def draw_motion(self) -> None:
        """Show the motion of the log, coloured anew."""

    def draw_joint(self) -> None:
        """Show the joint that is chosen."""

    def focus(self, mark: str) -> None:
        """Move the keyboard to a step, for the button that had it is gone.

        Args:
            mark: Of the step.
        """
