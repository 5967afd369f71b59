"""A monitor that was stored and restored goes on as if it had never been stopped, to the last bit."""

import ast
import inspect
import json
import pkgutil
import textwrap
import zipfile
from dataclasses import is_dataclass, replace
from enum import Enum
from importlib import import_module

import numpy as np
import pytest

import cdia_pin.diagnosis
from cdia_pin import Dynamics, Monitor, load_robot
from cdia_pin.campaigns.closed_loop import ClosedLoop, LoopSettings
from cdia_pin.diagnosis.state_codec import TYPES, StateWriter
from cdia_pin.diagnosis.stateful import Stateful
from cdia_pin.diagnosis.thesis import ThesisSettings
from cdia_pin.dynamics import Sensors, exciting_trajectory, simulate
from cdia_pin.effects import CoulombFriction, parse_term
from cdia_pin.errors import ModelError

FOLLOWING = 150  # ticks that are compared after a restart
# A payload, then a push, then a fault of a joint, so that stages follow each other within seconds.
TERMS = (
    "payload: mass=2, after=3",
    "external_wrench@wrist_2_joint: force_z=-60, force_x=40, after=8, until=8.6",
    "viscous_friction@elbow_joint: coefficient=12, after=9.5",
)
FROZEN = slice(2850, 3000)  # samples in which the velocity of a joint stays the same


@pytest.fixture(scope="module")
def robot():
    return load_robot("ur5")


def made(robot, seed, *terms, duration=12.0):
    motion, noise = np.random.default_rng(seed).spawn(2)
    plant = Dynamics(robot, tuple(parse_term(t) for t in terms))
    motion = exciting_trajectory(robot, motion, duration=duration)
    return simulate(plant, motion, sensors=Sensors(effort_share=0.01), rng=noise)


@pytest.fixture(scope="module")
def eventful(robot):
    """A monitor, a log in which much happens, and for each of its states a tick after which the monitor is in it."""
    log = made(robot, 2, *TERMS)
    speed = log.velocity.copy()
    speed[FROZEN, 1] = speed[FROZEN.start, 1]
    log = replace(log, velocity=speed)
    model = Dynamics(
        robot, (parse_term("payload: mass=0.1"), parse_term("coulomb_friction@elbow_joint: level=0.5"))
    )
    return Monitor(model, healthy=[made(robot, 1)]), log


@pytest.fixture(scope="module")
def pendulum():
    settings = LoopSettings(rate=500.0, healthy_runs=1, healthy_duration=10.0, seed=3)
    return ClosedLoop(Dynamics(load_robot("double_pendulum")), settings)


def tick(monitor, log, k):
    v = None if log.velocity is None else log.velocity[k]
    return monitor.update(float(log.time[k]), log.position[k], v, log.effort[k])


def said(monitor, status):
    """All that a caller can read after a tick, as text and bytes."""
    arrays = (status.residual, status.threshold, status.torque_correction)
    nominal = np.linspace(0.5, 1.0, len(status.residual))
    corrected = monitor.correct(nominal), monitor.correct(nominal, nominal)
    numbers = [a.tobytes() for a in (*arrays, *corrected)]
    faults = [(f, f.ci95) for f in status.faults]
    rest = (status.time, status.stages, faults, status.events, status.blind, status.sensors)
    return numbers, rest, monitor.faults, monitor.events, monitor.sensor_faults


def state_of(monitor):
    writer = StateWriter(monitor.model.robot)
    text = writer.part(monitor._safe, "state")
    return text, {name: array.tobytes() for name, array in writer.arrays.items()}


def check(monitor, log, instants, path):
    """Store a monitor at some ticks of a log, and compare what follows with what it says itself."""
    monitor.reset()
    files, truth, stored = {}, [], {}
    for k in range(len(log.time)):
        truth.append(said(monitor, tick(monitor, log, k)))
        if k in instants:
            files[k], stored[k] = monitor.save(path / f"{k}.npz"), state_of(monitor)
    for k, file in files.items():
        again = Monitor.load(file, monitor.model.robot)
        assert state_of(again) == stored[k]
        assert again.record == monitor.record
        for later in range(k + 1, min(k + 1 + FOLLOWING, len(log.time))):
            assert said(again, tick(again, log, later)) == truth[later], f"stored at tick {k}, tick {later}"


def test_it_goes_on_from_every_stage(eventful, tmp_path):
    monitor, log = eventful
    monitor.reset()
    first = {}
    for k in range(len(log.time)):
        status, arm = tick(monitor, log, k), monitor.engine.arm
        states = {
            **{str(stage): stage in status.stages for stage in set(status.stages)},
            "all healthy": set(status.stages) == {"healthy"},
            "payload": any(t.label == "payload" for t in arm.believed),
            "contact": arm.contact is not None,
            "contact beside a payload": arm.contact is not None and bool(arm.believed),
            "bad samples": "jumps" in " ".join(e.reason for e in status.events),
            "sensor": bool(status.sensors),
            "blind": bool(status.blind),
        }
        for name, is_so in states.items():
            if is_so:
                first.setdefault(name, k + 3)  # not at the very tick of the change
    expected = {
        "all healthy",
        "detected",
        "payload",
        "contact",
        "contact beside a payload",
        "bad samples",
        "sensor",
    }
    assert expected <= set(first), sorted(first)
    random = np.random.default_rng(7).integers(1, len(log.time) - FOLLOWING, size=5).tolist()
    check(monitor, log, {*first.values(), *random}, tmp_path)


# What the bank of the first does not hold is learned as an unknown fault, and its effects come and go with the speed.
@pytest.mark.parametrize(
    ("engine", "fault", "bank"),
    [
        (
            "momentum",
            "position_ripple@joint2: frequency=4, cosine=0.3, sine=0.2",
            ("coulomb_friction", "viscous_friction: speed=0.1.."),
        ),
        ("thesis", "coulomb_friction@joint2: level=0.2", ("coulomb_friction", "viscous_friction")),
    ],
)
def test_both_engines_go_on_while_they_isolate_and_compensate(pendulum, tmp_path, engine, fault, bank):
    settings = ThesisSettings(grace=1.0, longest_isolation=2.0) if engine == "thesis" else None
    monitor = pendulum.monitor(bank=bank, engine=engine, settings=settings)
    log = pendulum.run(pendulum.motion(0, 6.0), [parse_term(f"{fault}, after=1, until=4.5")], monitor).log
    verdicts = {e.verdict for e in monitor.events}
    assert verdicts & ({"unknown"} if engine == "momentum" else {"unique", "ambiguous"})
    random = np.random.default_rng(1).integers(1, len(log.time) - 1, size=8).tolist()
    check(monitor, log, {*random, 505, 520, 1200, 2100}, tmp_path)


def test_a_monitor_of_positions_alone_goes_on(robot, tmp_path):
    healthy, log = (replace(made(robot, seed, duration=4.0), velocity=None) for seed in (1, 2))
    check(Monitor(Dynamics(robot), healthy=[healthy]), log, {2, 40, 500}, tmp_path)


def test_a_veto_outlives_a_restart(eventful, robot, tmp_path):
    monitor, _ = eventful
    monitor.reset()
    monitor.allow_correction(False)
    again = Monitor.load(monitor.save(tmp_path / "m.npz"), robot)
    monitor.allow_correction(True)
    assert not again._safe._given.is_wanted


def test_a_monitor_with_a_given_threshold_is_stored(robot, tmp_path):
    monitor = Monitor(Dynamics(robot), threshold=dict.fromkeys(robot.joints, 2.0), rate=250.0)
    check(monitor, made(robot, 2, duration=1.0), {0, 100}, tmp_path)


# ------------------------------------------------------------- files that are not whole


@pytest.fixture
def stored(eventful, tmp_path):
    monitor, log = eventful
    monitor.reset()
    for k in range(20):
        tick(monitor, log, k)
    return monitor.save(tmp_path / "monitor.npz")


def changed(path, **entries):
    """Write the same file with other entries of its text."""
    with zipfile.ZipFile(path) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    document = json.loads(members["monitor.json"]) | entries
    members["monitor.json"] = json.dumps(document).encode()
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in members.items():
            archive.writestr(name, data)
    return document


def refused(path, robot):
    with pytest.raises(ModelError) as error:
        Monitor.load(path, robot)
    assert "\n" not in str(error.value)
    assert str(path) in str(error.value)
    return str(error.value)


def test_a_cut_or_damaged_file_is_refused(stored, robot):
    whole = stored.read_bytes()
    for size in (0, 10, len(whole) // 2, len(whole) - 5):
        stored.write_bytes(whole[:size])
        refused(stored, robot)
    for at in range(40, len(whole), len(whole) // 25):
        stored.write_bytes(whole[:at] + bytes([whole[at] ^ 0xFF]) + whole[at + 1 :])
        try:
            Monitor.load(stored, robot)  # a byte that says nothing, such as a date
        except ModelError as error:
            assert "\n" not in str(error)


def test_a_file_of_another_kind_is_refused(tmp_path, robot, stored):
    assert "cannot read" in refused(tmp_path / "none.npz", robot)
    np.savez(tmp_path / "other.npz", a=np.zeros(3))
    assert "not a whole monitor" in refused(tmp_path / "other.npz", robot)
    changed(stored, schema="cdia-monitor/0")
    assert "cdia-monitor/1" in refused(stored, robot)


def test_another_version_of_the_package_is_refused(stored, robot):
    changed(stored, version="0.0.9")
    assert "0.0.9" in refused(stored, robot)


def test_another_arm_is_refused(stored, robot):
    assert "joints" in refused(stored, load_robot("double_pendulum"))
    heavier = robot.inertial_parameters
    assert "masses" in refused(stored, robot.with_inertial_parameters(1.001 * heavier))
    assert "gravity" in refused(stored, robot.with_gravity([0.0, 1.0, -9.7]))


@pytest.mark.parametrize("broken", ["part", "type", "array", "value"])
def test_a_state_that_is_not_of_this_monitor_is_refused(stored, robot, broken):
    state = changed(stored)["state"]
    if broken == "part":
        state["_check"]["part"]["more"] = 1
    elif broken == "type":
        state["_last"] = {"record": "Path", "fields": {}}
    elif broken == "array":
        state["_nominal"] = {"array": "state/none"}
    else:
        state["_time"] = {"number": "many", "type": "float64"}
    changed(stored, state=state)
    refused(stored, robot)


def test_an_effect_without_a_name_is_not_stored(robot, tmp_path):
    class Nameless(CoulombFriction):
        name = "nameless"

    threshold = dict.fromkeys(robot.joints, 2.0)
    monitor = Monitor(Dynamics(robot), threshold=threshold, bank=[Nameless(robot.joints[0])], engine="thesis")
    with pytest.raises(ModelError, match="register"):
        monitor.save(tmp_path / "m.npz")
    assert not list(tmp_path.iterdir())


def test_a_file_that_cannot_be_written_leaves_the_old_one(stored, eventful, tmp_path):
    with pytest.raises(ModelError, match="cannot write"):
        eventful[0].save(tmp_path / "none" / "m.npz")


# ------------------------------------------------------------- no attribute is forgotten

CHANGES = {"append", "add", "clear", "extend", "pop", "popleft", "update", "insert", "setdefault", "remove"}


def classes():
    for found in pkgutil.walk_packages(cdia_pin.diagnosis.__path__, "cdia_pin.diagnosis."):
        import_module(found.name)
    known, left = set(), [Stateful]
    while left:
        left += [c for c in left.pop().__subclasses__() if c.__module__.startswith("cdia_pin.")]
        known.update(left)
    return sorted(known, key=lambda c: c.__name__)


def written(node):
    """Names of the attributes of self that a statement or a call changes."""
    if isinstance(node, ast.Assign | ast.AugAssign | ast.AnnAssign):
        targets = node.targets if isinstance(node, ast.Assign) else [node.target]
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in CHANGES:
        targets = [node.func.value]
    else:
        return
    while targets:
        target = targets.pop()
        if isinstance(target, ast.Tuple | ast.List):
            targets += target.elts
        elif isinstance(target, ast.Subscript | ast.Starred):
            targets.append(target.value)
        elif isinstance(target, ast.Attribute) and getattr(target.value, "id", "") == "self":
            yield target.attr


@pytest.mark.parametrize("kind", classes(), ids=lambda c: c.__name__)
def test_what_a_method_changes_is_stored(kind):
    tree = ast.parse(textwrap.dedent(inspect.getsource(kind))).body[0]
    methods = [m for m in tree.body if isinstance(m, ast.FunctionDef) and m.name != "__init__"]
    changed_names = {name for m in methods for node in ast.walk(m) for name in written(node)}
    in_array = {name for name, value in vars(kind).items() if hasattr(value, "__set__")}
    assert changed_names - {*kind.STATE, *kind.DERIVED} - in_array == set()
    assert len(set(kind.STATE)) == len(kind.STATE)


def walk(part):
    """A part and all further parts that are stored with it."""
    yield part
    for name in part.STATE:
        held = getattr(part, name)
        inner = (
            held.values() if isinstance(held, dict) else held if isinstance(held, list | tuple) else [held]
        )
        for one in inner:
            if isinstance(one, Stateful):
                yield from walk(one)


def frozen(x):
    """A value that compares by content; objects of other kinds compare by identity."""
    if isinstance(x, np.ndarray):
        return x.shape, x.dtype.str, x.tobytes()
    if isinstance(x, dict):
        return tuple((k, frozen(v)) for k, v in x.items())
    if isinstance(x, list | tuple):
        return tuple(frozen(v) for v in x)
    return x if isinstance(x, bool | int | float | str | Enum | None) else id(x)


def fixed(monitor):
    """The attributes of all parts that are not stored, and do not show what is stored."""
    parts = list(walk(monitor._safe))
    arrays = [a for p in parts for a in (getattr(p, n) for n in p.STATE) if isinstance(a, np.ndarray)]
    out = {}
    for i, part in enumerate(parts):
        for name in vars(part).keys() - {*part.STATE, *part.DERIVED}:
            value = getattr(part, name)
            if not isinstance(value, np.ndarray) or not any(np.shares_memory(value, a) for a in arrays):
                out[type(part).__name__, i, name] = value
    return out


# Classes of attributes that are not stored: they hold nothing of the past, but for caches and buffers.
WITHOUT_PAST = {"RobotModel", "Isolator", "EventLogFile"}


def test_what_is_not_stored_does_not_change_and_has_no_past(eventful):
    monitor, log = eventful
    monitor.reset()
    before = {key: frozen(value) for key, value in fixed(monitor).items()}
    for k in range(0, len(log.time)):
        tick(monitor, log, k)
    after = fixed(monitor)
    shared = before.keys() & after.keys()
    assert len(shared) > 100
    assert [key for key in shared if frozen(after[key]) != before[key]] == []
    strange = {
        type(value).__name__
        for value in after.values()
        if type(value).__module__.startswith("cdia_pin.")
        and not (
            isinstance(value, Stateful | Enum) or (is_dataclass(value) and value.__dataclass_params__.frozen)
        )
    }
    assert strange <= WITHOUT_PAST


def test_the_records_of_a_state_are_where_the_list_says():
    for name, module in TYPES.items():
        found = getattr(import_module(module), name)
        assert issubclass(found, Enum) or is_dataclass(found)
