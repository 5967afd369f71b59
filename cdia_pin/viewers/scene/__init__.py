"""The picture of an arm: meshes, joints and motion for the browser."""

from cdia_pin.viewers.scene.assets import SceneAssets, scene_assets
from cdia_pin.viewers.scene.comparison_timeline import timeline_of_comparison
from cdia_pin.viewers.scene.run_timeline import monitor_stages, timeline_of_run
from cdia_pin.viewers.scene.scene import Scene, SceneDocument
from cdia_pin.viewers.scene.timeline import (
    Frame,
    SceneStage,
    StageDocument,
    Timeline,
    TimelineDocument,
    Track,
    timeline_of_log,
)

__all__ = [
    "Frame",
    "Scene",
    "SceneAssets",
    "SceneDocument",
    "SceneStage",
    "StageDocument",
    "Timeline",
    "TimelineDocument",
    "Track",
    "monitor_stages",
    "scene_assets",
    "timeline_of_comparison",
    "timeline_of_log",
    "timeline_of_run",
]
