"""The picture of an arm: meshes, joints and motion for the browser."""

from cdia_pin.viewers.scene.assets import SceneAssets, scene_assets
from cdia_pin.viewers.scene.of_comparison import timeline_of_comparison
from cdia_pin.viewers.scene.of_run import monitor_stages, timeline_of_run
from cdia_pin.viewers.scene.scene import Scene
from cdia_pin.viewers.scene.timeline import SceneStage, Timeline, Track, timeline_of_log

__all__ = [
    "Scene",
    "SceneAssets",
    "SceneStage",
    "Timeline",
    "Track",
    "monitor_stages",
    "scene_assets",
    "timeline_of_comparison",
    "timeline_of_log",
    "timeline_of_run",
]
