"""The seeded logs of the golden set: MuJoCo runs, made once and read by every state of the code."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

from benchmarks import changes
from benchmarks.hidden_effects.case import BETWEEN_POINTS, GOOD, Case
from benchmarks.hidden_effects.drawing import drawn, plant_of, recorded
from benchmarks.plant import Fault, Fourier, MujocoPlant
from benchmarks.plant.model_error import erroneous
from benchmarks.plant.scenarios import OUTSIDE_PARAMETERS, PARAMETERS
from benchmarks.plant.sizes import Sizer
from cdia_pin.logs import Log, write_log

DURATION = 15.0  # [s], of a log; short ones keep the set cheap
WATCHED_RATE = 500.0  # [Hz], of a log for the monitor
WATCHED = 12.0  # [s]
WATCHED_SHARE = 0.3  # of the joint's torque
BEGIN = 5.0  # [s], at which a watched arm gets its fault
SEED = 11

Made = Callable[[], Log]
Plan = tuple[str, str, tuple[str, ...], float, str]  # name, arm, effects, share of the joint's torque, noise

SINGLES: tuple[Plan, ...] = (
    ("ur5_coulomb", "ur5", ("coulomb_friction",), 0.3, "white"),
    ("panda_viscous", "panda", ("viscous_friction",), 0.1, "white"),
    ("kinova_stribeck", "kinova", ("stribeck_friction",), 0.3, "white"),
    ("z1_asymmetric", "z1", ("asymmetric_friction",), 0.3, "coloured"),
    ("xarm7_quadratic", "xarm7", ("quadratic_friction",), 0.3, "white"),
    ("ur5_load", "ur5", ("load_friction",), 0.1, "quantised"),
    ("scara_ripple", "scara", ("position_ripple",), 0.3, "white"),
    ("panda_gain", "panda", ("actuator_gain",), 0.1, "coloured"),
    ("kinova_offset", "kinova", ("torque_offset",), 0.1, "quantised"),
    ("ur5_rotor", "ur5", ("rotor_inertia",), 0.1, "white"),
    ("scara_spring", "scara", ("joint_spring",), 0.3, "quantised"),
    ("z1_coupled", "z1", ("coupled_friction",), 0.3, "white"),
    ("xarm7_link", "xarm7", ("link_inertia",), 0.3, "white"),
    ("panda_payload", "panda", ("payload",), 0.3, "white"),
    ("ur5_tilt", "ur5", ("base_tilt",), 0.1, "white"),
    ("kinova_wrench", "kinova", ("tool_wrench",), 0.3, "coloured"),
    ("panda_medium", "panda", ("viscous_medium",), 0.3, "quantised"),
    ("z1_encoder", "z1", ("encoder_offset",), 0.1, "white"),
    ("ur5_delay", "ur5", ("effort_delay",), 0.1, "white"),
    ("scara_coulomb", "scara", ("coulomb_friction",), 0.3, "coloured"),
)
"""One hidden effect."""

SEVERAL: tuple[Plan, ...] = (
    ("ur5_payload_coulomb", "ur5", ("payload", "coulomb_friction"), 0.3, "white"),
    ("panda_coulomb_viscous", "panda", ("coulomb_friction", "viscous_friction"), 0.3, "coloured"),
    ("kinova_gain_ripple", "kinova", ("actuator_gain", "position_ripple"), 0.1, "white"),
    ("scara_viscous_offset", "scara", ("viscous_friction", "torque_offset"), 0.3, "white"),
    ("xarm7_tilt_encoder", "xarm7", ("base_tilt", "encoder_offset"), 0.1, "quantised"),
    ("ur5_three", "ur5", ("coulomb_friction", "rotor_inertia", "torque_offset"), 0.3, "white"),
    ("panda_three", "panda", ("payload", "stribeck_friction", "joint_spring"), 0.3, "white"),
    ("z1_three", "z1", ("load_friction", "effort_delay", "viscous_friction"), 0.3, "white"),
    ("scara_three", "scara", ("coulomb_friction", "joint_spring", "payload"), 0.3, "quantised"),
)
"""Two and three."""

OUTSIDE: tuple[Plan, ...] = (
    ("ur5_cubic", "ur5", ("cubic_spring",), 0.3, "white"),
    ("panda_deadzone", "panda", ("torque_deadzone",), 0.3, "white"),
    ("kinova_cogging", "kinova", ("speed_cogging",), 0.3, "white"),
    ("z1_posture", "z1", ("posture_friction",), 0.3, "coloured"),
    ("ur5_warming", "ur5", ("warming_friction",), 0.3, "white"),
    ("xarm7_cross", "xarm7", ("cross_spring",), 0.3, "quantised"),
    ("panda_presliding", "panda", ("presliding",), 0.3, "white"),
    ("scara_bump", "scara", ("speed_bump",), 0.3, "white"),
)
"""Physics that the vocabulary lacks."""

POOR: tuple[tuple[Plan, str], ...] = (
    (("ur5_way_coulomb", "ur5", ("coulomb_friction",), 0.3, "white"), "one way"),
    (("panda_posture_offset", "panda", ("torque_offset",), 0.3, "white"), "one posture"),
    (("kinova_slow_link", "kinova", ("link_inertia",), 0.3, "white"), "slow"),
    (("xarm7_planar_payload", "xarm7", ("payload",), 0.3, "white"), "planar"),
    (("z1_speed_stribeck", "z1", ("stribeck_friction",), 0.3, "coloured"), "single speed"),
    (("scara_joint_gain", "scara", ("actuator_gain",), 0.1, "white"), "one joint"),
)
"""Motions on which effects look alike."""

CLEAN: tuple[tuple[Plan, str], ...] = (
    (("ur5_clean", "ur5", (), 0.0, "white"), GOOD),
    (("panda_clean", "panda", (), 0.0, "coloured"), BETWEEN_POINTS),
    (("scara_clean", "scara", (), 0.0, "quantised"), GOOD),
    (("kinova_clean", "kinova", (), 0.0, "coloured"), "slow"),
)
"""Nothing hidden."""

WRONG: tuple[Plan, ...] = (
    ("ur5_wrong_links", "ur5", ("coulomb_friction",), 0.5, "white"),
    ("panda_wrong_links", "panda", (), 0.0, "white"),
)
"""Every link 5 % wrong."""

CHANGES = {  # names of pairs to arm and kind of `benchmarks.changes`
    "ur5_same": ("ur5", "nothing, wrong model"),
    "ur5_heavier": ("ur5", "payload 1.5 kg"),
    "ur5_rubs": ("ur5", "coulomb friction grows"),
    "ur5_warm": ("ur5", "friction falls by 30 %"),
    "ur5_zero": ("ur5", "encoder zero 0.02 rad"),
    "panda_weak": ("panda", "gain −6 %"),
    "panda_shifted": ("panda", "torque offset"),
}

FAULTS = {  # names of watched logs to arm and effect that begins during the log, none if empty
    "ur5_healthy": ("ur5", ""),
    "ur5_fault_coulomb": ("ur5", "coulomb_friction"),
    "ur5_fault_cubic": ("ur5", "cubic_spring"),
    "scara_healthy": ("scara", ""),
    "scara_fault_offset": ("scara", "torque_offset"),
    "panda_healthy": ("panda", ""),
    "panda_fault_gain": ("panda", "actuator_gain"),
}


def logs() -> Iterator[tuple[str, Made]]:
    """Yield the name of each log, and what makes it."""
    for plan in (*SINGLES, *SEVERAL, *OUTSIDE):
        yield plan[0], _hidden(plan, GOOD, 0.0)
    for plan, excitation in (*POOR, *CLEAN):
        yield plan[0], _hidden(plan, excitation, 0.0)
    for plan in WRONG:
        yield plan[0], _hidden(plan, GOOD, 0.05)
    for name, (arm, kind) in CHANGES.items():
        for side in ("before", "after"):
            yield f"{name}_{side}", _side(arm, kind, side)
    for name, (arm, effect) in FAULTS.items():
        yield name, _watched(arm, effect)


def make(folder: Path, say: Callable[[str], None] = print) -> None:
    """Make the logs that a folder lacks; what changes a log needs a new name or an empty folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, made in logs():
        file = folder / f"{name}.npz"
        if not file.exists():
            part = folder / f"part_{name}.npz"
            write_log(made(), part)
            part.rename(file)  # whole or not at all
            say(f"made {file}")


def _hidden(plan: Plan, excitation: str, model_error: float) -> Made:
    def made() -> Log:
        _, arm, effects, share, noise = plan
        case = Case("golden", arm, effects, (share,) * len(effects), noise, excitation, 1, model_error)
        plant, scenario = drawn(case)
        scenario = replace(scenario, duration=min(scenario.duration, DURATION))
        return recorded(case, scenario.run(plant))

    return made


def _side(arm: str, kind: str, side: str) -> Made:
    def made() -> Log:
        plant = plant_of(arm)
        pair = next(p for p in changes.pairs(plant, SEED) if p.kind == kind)
        faults, motion, seed = {
            "before": (pair.before, Fourier(), SEED),
            "after": (pair.after, pair.motion, SEED + changes.OTHER),
        }[side]
        return plant.run(faults, motion=motion, duration=DURATION, seed=seed).log

    return made


def _watched(arm: str, effect: str) -> Made:
    def made() -> Log:
        nominal = plant_of(arm)
        wrong = MujocoPlant(nominal.robot, inertias=erroneous(nominal.nominal.file.inertias, 0.03, SEED))
        sizer = Sizer(nominal, Fourier(), WATCHED, SEED + 1)
        faults: tuple[Fault, ...] = ()
        if effect:
            joint = sizer.busiest()[1]
            given: Any = (PARAMETERS | OUTSIDE_PARAMETERS)[effect]
            sized: Any = sizer.sized(Fault(effect, joint=joint, **given), WATCHED_SHARE).parameters
            faults = (Fault(effect, joint=joint, after=BEGIN, **sized),)
        seed, duration = (SEED + 1, WATCHED) if effect else (SEED, 30.0)
        return wrong.run(faults, duration=duration, rate=WATCHED_RATE, seed=seed, velocity=True).log

    return made
