"""What a monitor costs: a tick beside the rigid body's own terms, a decision, a closed loop, a program's start.

The floor is what no observer can do without: Pinocchio's `crba` and `nonLinearEffects`, called in a plain loop over
the same samples. Loops over the same second of a recorded run take turns; the figure is the median of their ratios.
The slowest ticks are timed one by one, in every third block. Times are those that the processor worked, so that other
programs do not count; only a program's start is timed by the clock.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from time import perf_counter, thread_time

import numpy as np
import pinocchio as pin

from benchmarks.online.control import NominalControl
from benchmarks.online.plant import OnlinePlant
from benchmarks.online.rigid_body import RigidBody
from benchmarks.online.scenarios import BEGIN
from benchmarks.online.trial import SEED, healthy_runs, log_of
from benchmarks.plant.faults import Fault
from cdia_pin.campaigns.closed_loop import ClosedLoop
from cdia_pin.campaigns.thesis_study import thesis_study
from cdia_pin.diagnosis import DEFAULT_BANK, Monitor, MonitorSettings, Stage
from cdia_pin.dynamics import Dynamics
from cdia_pin.effects import parse_term
from cdia_pin.logs import Log
from cdia_pin.robot import load_robot

ARM, JOINT = "panda", "panda_joint4"
BANKS = {3: DEFAULT_BANK[:3], 6: DEFAULT_BANK}
LEVEL = 4.0  # [N·m] of the dry friction that is watched and accommodated
BLOCK = 1000  # ticks in a loop
WARM = 8.0  # [s] into the run from which on loops are timed: the fault has been isolated
LENGTH = 28.0  # [s]
NEVER = 1_000_000  # votes that a joint under watch waits for, so that it stays under watch
STARTS = 3
ONE_BY_ONE = 3  # blocks, of which one is timed tick by tick
SLOWEST = 99.9  # [%], percentile of the ticks
LOOP = 8.0  # [s] of a closed loop
LOOPS = 3  # of each kind; the fastest counts, for anything else on the computer only slows them
LOOP_FAULTS = {
    "healthy": (),
    "dry friction and a weak motor": (
        f"coulomb_friction@{JOINT}: level=4, after=2",
        "actuator_gain@panda_joint2: gain=-0.25, after=3",
    ),
}
STAGES = {
    "healthy": Stage.HEALTHY,
    "watching": Stage.DETECTED,
    "accommodating, with correct": Stage.ACCOMMODATED,
}


@dataclass(frozen=True)
class TickCost:
    """Time of a tick.

    Attributes:
        effects: Number of known effects.
        state: What the monitor is doing.
        microseconds: Median [µs].
        floor: The same of the floor [µs].
        ratio: Median of the ratios of loops that ran one after the other [1].
        slowest: 99.9th percentile of single ticks over the median of the floor [1].
    """

    effects: int
    state: str
    microseconds: float
    floor: float
    ratio: float
    slowest: float


@dataclass(frozen=True)
class Cost:
    """All that was measured.

    Attributes:
        ticks: Time per tick.
        decisions: Median time of a decision over all combinations of so many effects [µs].
        package: Time to import the package [s].
        diagnosis: Time to import its monitor, after that [s].
        loads_numba: Whether either of these loads numba.
        first: From the program's start to the first answer of a monitor, nothing compiled before [s].
        second: The same, once that is cached [s].
        loops: Time of a closed loop of plant, control and monitor over that of the clock, by what is wrong [1].
        study: Time of both studies of the thesis [s].
    """

    ticks: tuple[TickCost, ...]
    decisions: dict[int, float]
    package: float
    diagnosis: float
    loads_numba: bool
    first: float
    second: float
    loops: dict[str, float]
    study: float


def measure() -> Cost:
    """Measure all; some minutes."""
    plant = OnlinePlant(ARM, seed=SEED)
    learned_from = [log_of(run).slice(0, 20_000) for run in healthy_runs(plant, 1)]
    control, reference = NominalControl(plant.robot), plant.reference(duration=LENGTH, seed=1)
    well = log_of(plant.run(control, reference, (), LENGTH))
    fault = Fault("coulomb_friction", joint=JOINT, level=LEVEL, after=BEGIN)
    ill = log_of(plant.run(control, reference, [fault], LENGTH))
    monitors, decisions = {}, {}
    for effects, bank in BANKS.items():
        for state, log, settings, correct in zip(
            STAGES,
            (well, ill, ill),
            (MonitorSettings(), MonitorSettings(votes=NEVER), MonitorSettings()),
            (False, False, True),
            strict=True,
        ):
            monitor = Monitor(Dynamics(plant.robot), healthy=learned_from, bank=bank, settings=settings)
            monitors[effects, state] = monitor, log, correct
    ticks = tuple(_ticks(plant, well, monitors))
    for effects in BANKS:
        decisions[effects] = _decision(monitors[effects, "watching"][0], plant.joints.index(JOINT))
    with tempfile.TemporaryDirectory() as cache:
        first, second = _start(cache), min(_start(cache) for _ in range(STARTS))
    study = _timed(lambda: _discard(thesis_study()))
    return Cost(ticks, decisions, *_import(), first, second, _loops(), study)


def _loops() -> dict[str, float]:
    """Return how much faster than the clock closed loops at 1 kHz are [1]."""
    loop = ClosedLoop(Dynamics(load_robot(ARM)))
    monitor, motion = loop.monitor(), loop.motion(0, LOOP)
    out = {}
    for name, texts in LOOP_FAULTS.items():
        faults = [parse_term(text, loop.robot) for text in texts]
        times = [_timed(lambda f=faults: _discard(loop.run(motion, f, monitor))) for _ in range(LOOPS)]
        out[name] = LOOP / min(times)
    return out


def _ticks(
    plant: OnlinePlant, floor_log: Log, monitors: dict[tuple[int, str], tuple[Monitor, Log, bool]]
) -> Iterable[TickCost]:
    body = RigidBody(plant.robot)
    start, stop = round(WARM / 1e-3), len(floor_log.time)
    for monitor, log, _ in monitors.values():
        for k in range(start):
            _tick(monitor, log, k)
    took: dict[tuple[int, str], list[float]] = {key: [] for key in monitors}
    floors = []
    single: dict[tuple[int, str], list[float]] = {key: [] for key in monitors}
    for i, at in enumerate(range(start, stop - BLOCK, BLOCK)):
        block = range(at, at + BLOCK)
        if i % ONE_BY_ONE == ONE_BY_ONE - 1:
            for key, (monitor, log, correct) in monitors.items():
                single[key] += _one_by_one(monitor, log, block, correct)
            continue
        floors.append(_timed(lambda block=block: _floor(body, floor_log, block)))
        for key, (monitor, log, correct) in monitors.items():
            stages: list[Stage] = []
            run = _corrected if correct else _watched
            took[key].append(_timed(lambda m=monitor, x=log, r=run, b=block, s=stages: s.append(r(m, x, b))))
            if stages != [STAGES[key[1]]]:
                raise RuntimeError(f"'{key[1]}' was to be timed, and the monitor was {stages[0]}")
    for (effects, state), times in took.items():
        ratio = median(t / f for t, f in zip(times, floors, strict=True))
        floor = _micro(median(floors))
        slowest = 1e6 * float(np.percentile(single[effects, state], SLOWEST)) / floor
        yield TickCost(effects, state, _micro(median(times)), floor, ratio, slowest)


def _one_by_one(monitor: Monitor, log: Log, block: range, corrected: bool) -> list[float]:
    """Return the time of each tick [s]."""
    t, (q, v, tau), out = log.time.tolist(), (log.position, log.velocity, log.effort), []
    for k in block:
        begin = thread_time()
        monitor.update(t[k], q[k], v[k], tau[k])
        if corrected:
            monitor.correct(tau[k], v[k])
        out.append(thread_time() - begin)
    return out


def _floor(body: RigidBody, log: Log, block: range) -> None:
    model, data, q, v = body.model, body.data, log.position, log.velocity
    crba, nle = pin.crba, pin.nonLinearEffects
    for k in block:
        crba(model, data, q[k])
        nle(model, data, q[k], v[k])


def _watched(monitor: Monitor, log: Log, block: range) -> Stage:
    t, q, v, tau, update = log.time.tolist(), log.position, log.velocity, log.effort, monitor.update
    for k in block:
        status = update(t[k], q[k], v[k], tau[k])
    return status.stage


def _corrected(monitor: Monitor, log: Log, block: range) -> Stage:
    t, q, v, tau, update = log.time.tolist(), log.position, log.velocity, log.effort, monitor.update
    correct = monitor.correct
    for k in block:
        status = update(t[k], q[k], v[k], tau[k])
        correct(tau[k], v[k])
    return status.stage


def _sample(log: Log, k: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    assert log.velocity is not None
    return log.position[k], log.velocity[k], log.effort[k]


def _tick(monitor: Monitor, log: Log, k: int) -> None:
    monitor.update(float(log.time[k]), *_sample(log, k))


def _timed(call: Callable[[], None]) -> float:
    begin = thread_time()
    call()
    return thread_time() - begin


def _micro(block: float) -> float:
    return 1e6 * block / BLOCK


def _decision(monitor: Monitor, j: int) -> float:
    """Return the median time of a decision of a joint under watch [µs]."""
    isolation = monitor.engine.joint_monitors[j].isolation  # type: ignore[attr-defined]
    return 1e6 * median(_timed(lambda: _discard(isolation.decide())) for _ in range(300))


IMPORT = """
import sys, time
begin = time.perf_counter()
import cdia_pin
then = time.perf_counter()
from cdia_pin.diagnosis import Monitor
print(then - begin, time.perf_counter() - then, "numba" in sys.modules)
"""
START = f"""
from cdia_pin import Dynamics, load_robot
from cdia_pin.diagnosis import Monitor
import numpy as np
robot = load_robot("{ARM}")
monitor = Monitor(Dynamics(robot), threshold=dict.fromkeys(robot.joints, 1.0), rate=1000.0)
zero = np.zeros(robot.n)
for k in range(3):
    monitor.update(1e-3 * k, zero, zero, zero)
    monitor.correct(zero)
"""


def _import() -> tuple[float, float, bool]:
    answers = [_python(IMPORT, {}).split() for _ in range(STARTS)]
    package, diagnosis, loads = zip(*answers, strict=True)
    return min(map(float, package)), min(map(float, diagnosis)), "True" in loads


def _start(cache: str) -> float:
    """Return how long a program takes that makes a monitor and asks it, its caches in a folder [s]."""
    folders = {"XDG_CACHE_HOME": cache, "NUMBA_CACHE_DIR": str(Path(cache) / "numba")}
    begin = perf_counter()
    _python(START, folders)
    return perf_counter() - begin


def _discard(_: object) -> None:
    pass


def _python(text: str, more: dict[str, str]) -> str:
    done = subprocess.run(
        [sys.executable, "-c", text], env={**os.environ, **more}, capture_output=True, text=True, check=True
    )
    return done.stdout
