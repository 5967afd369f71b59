"""The loops of `examples/robots`, fed by stand-ins for robots and ROS: what they read, and what they say."""

import importlib
import importlib.util
import json
import socket
import sys
from itertools import islice
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest

from cdia_pin import ClosedLoop, Dynamics, LoopSettings, effects, load_robot, read_log, write_log
from cdia_pin.dynamics import save_model

ROBOTS = Path(__file__).resolve().parents[2] / "examples" / "robots"
ONSET = 2.0  # [s]
BANK = ("coulomb_friction", "viscous_friction")
GRIPPER = "gripper_joint"


def example(name):
    spec = importlib.util.spec_from_file_location(name, ROBOTS / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


sys.path.insert(0, str(ROBOTS))  # as Python does for a script that is run there
attached = importlib.import_module("attached_arm")
ros2, ur_rtde, libfranka = (example(f"monitor_{n}") for n in ("ros2", "ur_rtde", "libfranka"))


@pytest.fixture(scope="module")
def loop():
    settings = LoopSettings(rate=500.0, healthy_runs=1, healthy_duration=10.0, seed=3)
    return ClosedLoop(Dynamics(load_robot("double_pendulum")), settings)


@pytest.fixture(scope="module")
def learned(loop):
    return loop.monitor(bank=BANK)


@pytest.fixture
def monitor(learned):
    learned.reset()
    return learned


@pytest.fixture(scope="module")
def log(loop):
    """A run whose second joint gains friction on the way, a quarter of its torque; nothing corrects for it."""
    fault = effects.parse_term(f"coulomb_friction@joint2: level=0.05, after={ONSET:g}", loop.robot)
    return loop.run(loop.motion(0, 6.0), [fault]).log


def message(log, k, order=(GRIPPER, "joint2", "joint1"), **other):
    """Sample k as a JointState, with the joints in an order of its own and one that is none of the arm."""
    stamp = SimpleNamespace(sec=int(log.time[k]), nanosec=round(1e9 * (log.time[k] % 1)))
    said = {"header": SimpleNamespace(stamp=stamp), "name": list(order)}
    for name, signal in (("position", log.position), ("velocity", log.velocity), ("effort", log.effort)):
        by_joint = {GRIPPER: 7.0, **dict(zip(log.joints, signal[k], strict=True))}
        said[name] = [by_joint[joint] for joint in order]
    return SimpleNamespace(**{**said, **other})


def messages(log):
    """Every sample, in an order that changes from message to message."""
    orders = [("joint2", GRIPPER, "joint1"), ("joint1", "joint2", GRIPPER), (GRIPPER, "joint2", "joint1")]
    return (message(log, k, orders[k % 3]) for k in range(len(log.time)))


def ticks(log):
    return zip(log.time, log.position, log.velocity, log.effort, strict=True)


def words(watch, published):
    return [json.loads(said) for one in published if (said := watch.take(one)) is not None]


def test_a_fault_is_published_whatever_the_order_of_the_joints(monitor, log):
    said = words(ros2.JointStateWatch(monitor), messages(log))
    assert said[0]["stage"] == "healthy" and not said[0]["events"]
    first = next(s for s in said if s["events"])
    assert ONSET < first["time"] < ONSET + 0.5
    assert first["events"][0].startswith("detection on joint2")
    assert first["joints"] == {"joint2": "detected"}
    assert any("coulomb_friction" in fault for fault in said[-1]["faults"])
    assert said[-1]["stage"] == "accommodated"


def test_a_healthy_arm_speaks_once_a_second(monitor, log):
    before = islice(messages(log), int(0.9 * ONSET * log.rate))
    assert [s["stage"] for s in words(ros2.JointStateWatch(monitor), before)] == ["healthy", "healthy"]


def test_efforts_that_are_currents_become_torques(monitor, log):
    gains = {"joint1": 10.0, "joint2": 0.5}
    by_ampere = np.array([gains[j] for j in log.joints])
    scaled = SimpleNamespace(**{n: getattr(log, n) for n in ("joints", "time", "position", "velocity")})
    scaled.effort = log.effort / by_ampere
    said = words(ros2.JointStateWatch(monitor, gains), messages(scaled))
    assert next(s for s in said if s["events"])["time"] > ONSET


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"name": ["joint2", "x", "y"]}, "no joint joint1"),
        ({"name": []}, "no joint joint1, joint2"),
        ({"effort": []}, "0 values of effort for 3 joints"),
        ({"position": [1.0]}, "1 values of position for 3 joints"),
        ({"velocity": []}, "without velocities"),
        ({"velocity": [1.0]}, "1 values of velocity for 3 joints"),
    ],
)
def test_a_message_that_lacks_something_is_told_once_a_second_and_raises_nothing(monitor, log, wrong, says):
    watch = ros2.JointStateWatch(monitor)
    count = int(1.5 * log.rate)
    said = words(watch, (message(log, k, **wrong) for k in range(count)))
    assert [s["stage"] for s in said] == ["no data", "no data"]
    assert says in said[0]["problem"]
    assert [s["stage"] for s in words(watch, [message(log, count)])] == ["healthy"]


def test_another_speaker_on_the_topic_is_ignored(monitor, log):
    watch = ros2.JointStateWatch(monitor)
    both = (m for k in range(200) for m in (message(log, k), message(log, k, name=["a", "b", "c"])))
    assert [s["stage"] for s in words(watch, both)] == ["healthy"]


def test_an_effort_that_is_no_number_is_a_sensor_fault(monitor, log):
    watch = ros2.JointStateWatch(monitor)
    dead = {"effort": [np.nan] * 3}
    said = words(watch, (message(log, k, **(dead if k > 100 else {})) for k in range(600)))
    assert any("torque sensor" in fault for fault in said[-1]["sensors"])


def test_the_node_publishes_what_the_watch_says(monitor, log, monkeypatch, tmp_path):
    """The whole program, with a stand-in for rclpy that publishes the log when it spins."""
    published, wired = [], {}

    class Node:
        def __init__(self, name):
            wired["node"] = name

        def create_publisher(self, kind, topic, depth):
            wired["says"] = topic
            return SimpleNamespace(publish=lambda said: published.append(said.data))

        def create_subscription(self, kind, topic, callback, qos):
            wired["hears"], wired["callback"] = topic, callback

        def destroy_node(self):
            wired["destroyed"] = True

    def spin(node):
        for one in messages(log):
            wired["callback"](one)
        raise KeyboardInterrupt

    names = {
        "rclpy": {"init": lambda: None, "spin": spin, "try_shutdown": lambda: None},
        "rclpy.executors": {"ExternalShutdownException": type("ExternalShutdownException", (Exception,), {})},
        "rclpy.node": {"Node": Node},
        "rclpy.qos": {"QoSProfile": SimpleNamespace, "ReliabilityPolicy": SimpleNamespace(BEST_EFFORT=2)},
        "sensor_msgs": {},
        "sensor_msgs.msg": {"JointState": SimpleNamespace},
        "std_msgs": {},
        "std_msgs.msg": {"String": SimpleNamespace},
    }
    for name, holds in names.items():
        module = ModuleType(name)
        module.__dict__.update(holds)
        monkeypatch.setitem(sys.modules, name, module)
    monkeypatch.setattr(attached, "Monitor", lambda model, healthy: monitor)
    healthy, model = write_log(log, tmp_path / "healthy.csv"), tmp_path / "model.json"
    save_model(monitor.model, model)
    given = [
        "node",
        str(healthy),
        "--robot",
        "double_pendulum",
        "--model",
        str(model),
        "--ros-args",
        "-r",
        "a:=b",
    ]
    monkeypatch.setattr(sys, "argv", given)
    ros2.main()
    assert (wired["hears"], wired["says"], wired["destroyed"]) == ("/joint_states", "arm_monitor", True)
    assert any(event.startswith("detection") for said in published for event in json.loads(said)["events"])


class Receive:
    """A stand-in for RTDEReceiveInterface: packets go on by themselves, also between two calls."""

    def __init__(self, log, gains):
        self.log, self.gains, self.calls = log, gains, 0

    def packet(self):
        self.calls += 1
        return min(self.calls // 7, len(self.log.time) - 1)

    def isConnected(self):
        return self.calls // 7 < len(self.log.time)

    def getTimestamp(self):
        return self.log.time[self.packet()]

    def getActualQ(self):
        return list(self.log.position[self.packet()])

    def getActualQd(self):
        return list(self.log.velocity[self.packet()])

    def getActualCurrent(self):
        return list(self.log.effort[self.packet()] / self.gains)


def assert_are_samples(read, log):
    """Every tick is one sample of the log, whole, and none comes twice."""
    at = np.searchsorted(log.time, [t for t, *_ in read])
    assert len(at) > 10 and (np.diff(at) > 0).all()
    for k, (t, q, v, tau) in zip(at, read, strict=True):
        assert t == log.time[k]
        np.testing.assert_array_equal(q, log.position[k])
        np.testing.assert_array_equal(v, log.velocity[k])
        np.testing.assert_allclose(tau, log.effort[k])


def test_ticks_of_rtde_are_whole_packets(log, monkeypatch):
    monkeypatch.setattr(ur_rtde, "POLL", 0.0)
    gains = np.array([10.0, 0.5])
    assert_are_samples(list(ur_rtde.ticks(Receive(log, gains), gains)), log)


def test_ticks_of_libfranka_are_new_states(log, monkeypatch):
    monkeypatch.setattr(libfranka, "POLL", 0.0)
    states = iter(
        SimpleNamespace(time=SimpleNamespace(to_sec=lambda t=t: t), q=list(q), dq=list(v), tau_J=list(tau))
        for t, q, v, tau in ticks(log)
        for _ in range(2)  # each is read twice
    )
    assert_are_samples(list(islice(libfranka.ticks(lambda: next(states)), 50)), log)


def test_ticks_by_udp_are_what_the_loop_sent():
    receiver, sender = (socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(2))
    with receiver, sender:
        receiver.bind(("127.0.0.1", 0))
        receiver.settimeout(5.0)
        sender.sendto(np.arange(22.0).tobytes(), receiver.getsockname())
        t, q, v, tau = next(libfranka.ticks_from_udp(receiver))
    assert t == 0.0
    np.testing.assert_array_equal(np.concatenate([q, v, tau]), np.arange(1.0, 22.0))


def test_a_loop_says_what_the_monitor_finds(monitor, log):
    said = []
    attached.watch(ticks(log), monitor, said.append)
    assert "detection on joint2" in said[0]
    assert any("coulomb_friction@joint2" in s for s in said)


def test_a_recorded_run_is_read_as_it_was(loop, log, tmp_path):
    path = tmp_path / "healthy.csv"
    attached.record(iter(ticks(log)), loop.model.robot, str(path), seconds=1.0)
    again = read_log(path, loop.model.robot)
    assert again.duration == pytest.approx(1.0, abs=0.01)
    for name in ("position", "velocity", "effort"):
        np.testing.assert_array_equal(getattr(again, name), getattr(log, name)[: len(again.time)])


def test_the_whole_programs_record_and_watch(monitor, log, monkeypatch, tmp_path, capsys):
    """With stand-ins for the two libraries, whose joints are those of a small arm."""
    gains = np.array([10.0, 0.5])
    gains_file = tmp_path / "gains.json"
    gains_file.write_text(json.dumps(dict(zip(log.joints, gains, strict=True))))

    def robot(address, realtime):
        states = (
            SimpleNamespace(time=SimpleNamespace(to_sec=lambda t=t: t), q=q, dq=v, tau_J=tau)
            for t, q, v, tau in ticks(log)
        )
        return SimpleNamespace(read_once=lambda: next(states, None) or ctrl_c())

    def ctrl_c():
        raise KeyboardInterrupt

    stand_ins = {
        "rtde_receive": {"RTDEReceiveInterface": lambda address: Receive(log, gains)},
        "pylibfranka": {"Robot": robot, "RealtimeConfig": SimpleNamespace(kIgnore=1)},
    }
    programs = [(ur_rtde, ["here", "--gains", str(gains_file)]), (libfranka, ["--address", "here"])]
    for (loops, given), (name, holds) in zip(programs, stand_ins.items(), strict=True):
        module = ModuleType(name)
        module.__dict__.update(holds)
        monkeypatch.setitem(sys.modules, name, module)
        monkeypatch.setattr(loops, "POLL", 0.0)
        monkeypatch.setattr(attached, "Monitor", lambda model, healthy: monitor)
        monitor.reset()
        healthy = tmp_path / f"{name}.csv"
        common = ["program", *given, "--robot", "double_pendulum"]
        monkeypatch.setattr(sys, "argv", [*common, "--record", str(healthy), "--seconds", "1"])
        loops.main()
        monkeypatch.setattr(sys, "argv", [*common, "--healthy", str(healthy)])
        loops.main()
        assert "detection on joint2" in capsys.readouterr().out
        monkeypatch.setattr(sys, "argv", common)
        with pytest.raises(SystemExit):
            loops.main()
        assert "give --record, or --healthy" in capsys.readouterr().err
