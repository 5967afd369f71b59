"""The picture of an arm: meshes, joints and motion for the browser."""

from cdia_pin.viewers.scene.scene import Scene

__all__ = ["Scene"]
