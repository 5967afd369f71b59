"""Robots: the rigid-body part of M q̈ + nle = τ + f, where it comes from, and how its file is corrected."""

from cdia_pin.robot.catalogue import CatalogueEntry, catalogue, load_robot
from cdia_pin.robot.joints import JointLimits, LockedJoint
from cdia_pin.robot.model import RobotModel
from cdia_pin.robot.urdf_export import write_corrected_urdf

__all__ = [
    "CatalogueEntry",
    "JointLimits",
    "LockedJoint",
    "RobotModel",
    "catalogue",
    "load_robot",
    "write_corrected_urdf",
]
