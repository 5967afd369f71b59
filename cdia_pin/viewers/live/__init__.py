"""The picture of an arm in a browser while it moves."""

from cdia_pin.viewers.live.frames import FrameMaker
from cdia_pin.viewers.live.view import LiveView

__all__ = ["FrameMaker", "LiveView"]
