"""A ROS 2 node that watches an arm: it reads /joint_states and publishes what the monitor says. It commands nothing.

Usage:
    cdia discover healthy.csv --robot ur10 --save model.json      # healthy.csv, or a bag of /joint_states
    python examples/robots/monitor_ros2.py healthy.csv --robot ur10 --model model.json
    ros2 topic echo /arm_monitor

Record the healthy run from the same topic, at the same rate, while the arm does its usual work. If the driver fills
`effort` with motor currents, as that of Universal Robots does by default, add --gains with a file of N·m/A by joint to
both commands.
"""

import argparse
import contextlib
import json
from pathlib import Path
from typing import Any

import numpy as np
from attached_arm import sentence, taught

from cdia_pin import CdiaError, Monitor, load_robot

EVERY = 1.0  # [s], between two messages of which nothing is new


class JointStateWatch:
    """Feeds messages of sensor_msgs/JointState to a monitor.

    Args:
        monitor: The monitor.
        gains: Torque over effort of each joint, {joint: N·m/A}; 1 if omitted.
    """

    def __init__(self, monitor: Monitor, gains: dict[str, float] | None = None) -> None:
        self.monitor = monitor
        self.joints = monitor.model.robot.joints
        self.gains = np.array([1.0 if gains is None else gains[joint] for joint in self.joints])
        self.understood = self.spoken = -np.inf  # [s], time of the last good message, and of the last words
        self.stage = ""

    def take(self, message: Any) -> str | None:
        """Take a message and return the words to publish, as JSON; None if nothing is new. It raises nothing.

        Args:
            message: A JointState, or anything with its fields.
        """
        t = message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec
        try:
            q, tau = self._signal(message, "position"), self._signal(message, "effort")
            v = self._signal(message, "velocity") if len(message.velocity) else None
            status = self.monitor.update(t, q, v, self.gains * tau)
        except (ValueError, CdiaError) as problem:
            # A gripper may speak on the same topic: only a second without a good message is worth words.
            is_due = self._is_due(t, self.understood) and self._is_due(t, self.spoken)
            return self._words(t, stage="no data", problem=str(problem)) if is_due else None
        self.understood = t
        if not (status.events or status.stage != self.stage or self._is_due(t, self.spoken)):
            return None
        stages = zip(self.joints, status.stages, strict=True)
        return self._words(
            t,
            stage=str(status.stage),
            joints={joint: str(stage) for joint, stage in stages if stage != "healthy"},
            faults=[f"{term.label} {term.values}" for term in status.faults],
            sensors=[str(fault) for fault in status.sensors],
            blind=list(status.blind),
            events=[sentence(event) for event in status.events],
        )

    def _signal(self, message: Any, name: str) -> np.ndarray:
        """Return one signal in the order of the arm, whatever the order of the message."""
        if missing := [joint for joint in self.joints if joint not in message.name]:
            raise ValueError(
                f"no joint {', '.join(missing)} in the message; it has {', '.join(message.name)}"
            )
        values = getattr(message, name)
        if len(values) != len(message.name):
            raise ValueError(f"{len(values)} values of {name} for {len(message.name)} joints in the message")
        return np.array([values[message.name.index(joint)] for joint in self.joints], float)

    def _words(self, t: float, **said: Any) -> str:
        self.spoken, self.stage = t, said["stage"]
        return json.dumps({"time": t, **said}, ensure_ascii=False)

    @staticmethod
    def _is_due(t: float, last: float) -> bool:
        return abs(t - last) >= EVERY  # a clock may be set back


def run(watch: JointStateWatch) -> None:
    """Spin the node until it is interrupted."""
    import rclpy
    from rclpy.executors import ExternalShutdownException
    from rclpy.node import Node
    from rclpy.qos import QoSProfile, ReliabilityPolicy
    from sensor_msgs.msg import JointState
    from std_msgs.msg import String

    rclpy.init()
    node = Node("arm_monitor")
    publisher = node.create_publisher(String, "arm_monitor", 10)

    def hear(message: JointState) -> None:
        if words := watch.take(message):
            publisher.publish(String(data=words))

    # Best effort hears every publisher. The queue bridges the ticks in which the monitor decides.
    waiting = QoSProfile(depth=100, reliability=ReliabilityPolicy.BEST_EFFORT)
    node.create_subscription(JointState, "/joint_states", hear, waiting)
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.spin(node)
    node.destroy_node()
    rclpy.try_shutdown()


def main() -> None:
    """Read the command line, let the monitor learn, and run the node."""
    parser = argparse.ArgumentParser(description="Watch an arm on /joint_states.")
    parser.add_argument("healthy", help="log of the healthy arm")
    parser.add_argument("--robot", required=True, help="name or URDF file")
    parser.add_argument("--model", help="model.json of cdia discover; the URDF alone if omitted")
    parser.add_argument("--gains", help="JSON file {joint: N·m/A}, if efforts are currents")
    asked, _ = parser.parse_known_args()  # what is left is of ROS
    robot = load_robot(asked.robot)
    gains = json.loads(Path(asked.gains).read_text(encoding="utf-8")) if asked.gains else None
    run(JointStateWatch(taught(robot, asked.healthy, asked.model, gains), gains))


if __name__ == "__main__":
    main()
