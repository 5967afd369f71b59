"""Faults, gains and bounds of the thesis' numerical studies: as its appendix prints them, and of physical size."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from cdia_pin.campaigns.scara_run import PRINTED_START, Fault, Scenario
from cdia_pin.diagnosis.thesis import FixedGains, Neurons, ThesisSettings
from cdia_pin.effects import (
    ActuatorGain,
    CoulombFriction,
    JointEffect,
    PositionRipple,
    StribeckFriction,
    ViscousFriction,
)
from cdia_pin.phrases import shortened
from cdia_pin.robot import RobotModel

Array = NDArray[np.float64]

J = "joint1"  # any joint: a fault of a study is on all joints
FIRST, SECOND = 2.0, 4.0  # [s], onset of the component fault and of the actuator fault
RANGE = np.pi * np.array([5 / 6, 7 / 9, 3 / 2, 0.2 / np.pi])  # [rad, rad, rad, m], Table 1
SPEED = np.pi * np.array([10 / 3, 5, 55 / 3, 1.2 / np.pi])  # [rad/s, rad/s, rad/s, m/s], Table 1

COULOMB = np.array([20.0, 10.0, 0.01, 20.0])  # [N·m, N·m, N·m, N], an eighth to a half of the torque RMS
VISCOUS = np.array([15.0, 8.0, 0.01, 30.0])  # [N·m·s/rad, …, N·s/m]
UNMODELLED = np.array([1.0, 0.3, 0.001, 1.0])  # [N·m, N·m, N·m, N], 0.3 to 3 % of the torque RMS
KNOWN_BOUND = tuple(1.2 * UNMODELLED)  # [N·m, N·m, N·m, N], η₀, the bound that the engine knows
LOSS = -0.3  # [1], lost share of the torque
RIPPLE = PositionRipple(J, frequency=3.0)
KNOWN: tuple[JointEffect, ...] = (ActuatorGain(J), CoulombFriction(J), RIPPLE)


@dataclass(frozen=True, eq=False, repr=False)
class Preset:
    """A study of the observer of detection and approximation.

    Attributes:
        name: ``literal`` or ``physical``.
        about: Description of its faults, gains and limits.
        cases: Scenarios by name; the last one has its own figures.
        settings: Settings of the engine.
    """

    name: str
    about: str
    cases: dict[str, Scenario]
    settings: ThesisSettings = field(default_factory=ThesisSettings)

    def __repr__(self) -> str:
        return f"Preset({shortened(self.name)}, {len(self.cases)} cases)"


def physical(robot: RobotModel) -> Preset:
    """Return faults of a realistic size, with gains that scale with the arm's inertia.

    Args:
        robot: The SCARA arm.

    Returns:
        Four cases and the settings of the engine.
    """
    coulomb = Fault(CoulombFriction(J), COULOMB[:, None], FIRST)
    viscous = Fault(ViscousFriction(J), VISCOUS[:, None], FIRST)
    loss = Fault(ActuatorGain(J), np.full((4, 1), LOSS), FIRST)
    late_loss = Fault(ActuatorGain(J), np.full((4, 1), LOSS), SECOND)
    cases = {
        "30 % torque loss": (loss,),
        "Coulomb friction": (coulomb,),
        "viscous friction": (viscous,),
        "friction, then torque loss": (coulomb, viscous, late_loss),
    }
    return Preset(
        "physical",
        "Faults of a realistic size, unmodelled torques of a few percent of the arm's torques, gains that scale "
        "with the inertia of each joint.",
        {name: Scenario(faults, UNMODELLED, duration=8.0) for name, faults in cases.items()},
        ThesisSettings(unmodelled=KNOWN_BOUND),
    )


def literal(robot: RobotModel) -> Preset:
    """Return the faults and gains of the appendix.

    The signs are changed to f = −Fc − Fa τ. The component fault is a Coulomb torque that drives the motion, a viscous
    torque of 2000 N·m·s/rad and a slow ripple. The actuator fault multiplies the torques by 8, 11, 11 and 1.9. The
    neurons are 32 rad wide. Only the threshold is corrected, and the weights at small residuals.

    Args:
        robot: The SCARA arm.

    Returns:
        Three cases and the settings of the engine.
    """
    size = np.array([1e2, 1e2, 1e-2, 1e1])
    gain = Fault(ActuatorGain(J), np.array([[7.0], [10.0], [10.0], [0.9]]), SECOND)
    component = (
        Fault(StribeckFriction(J, decay=1e4), np.column_stack([-size, -0.05 * size]), FIRST),
        Fault(ViscousFriction(J), 20.0 * size[:, None], FIRST),
        Fault(PositionRipple(J, frequency=0.2), np.column_stack([10.0 * size, np.zeros(4)]), FIRST),
    )
    cases = {
        "actuator fault alone": (gain,),
        "component fault alone": component,
        "both, as printed": (*component, gain),
    }
    places, width = np.linspace(-1.0, 1.0, 7), np.full(4, 1e-3**-0.5)
    return Preset(
        "literal",
        "Faults, gains and neurons as the appendix prints them, with a corrected threshold and a longer duration: "
        "the printed 2 s end before the faults begin. The printed actuator fault is a gain and not a loss; the "
        "printed friction drives the motion.",
        {
            name: Scenario(
                faults, 2 * np.array([1e-4, 1e-4, 1e-3, 1e-6]), start=PRINTED_START, duration=10.0, substeps=2
            )
            for name, faults in cases.items()
        },
        ThesisSettings(
            unmodelled=tuple(5e-5 * SPEED),
            neurons=Neurons(robot, np.outer(RANGE, places), np.outer(SPEED, places), width, width),
            observer_gains=FixedGains(torque=(10.0, 10.0, 1.0, 1.0), state=(10.0, 10.0, 0.1, 1e5)),
        ),
    )


PRESETS = {"literal": literal, "physical": physical}


def isolation_faults() -> dict[str, Fault]:
    """Return one fault of each of the three types of the thesis' bank (§4.3), by name."""
    ripple = np.column_stack([1.5 * COULOMB, 0.5 * COULOMB])
    return {
        "actuator_gain": Fault(KNOWN[0], np.full((4, 1), LOSS), FIRST),
        "coulomb_friction": Fault(KNOWN[1], 1.5 * COULOMB[:, None], FIRST),
        "position_ripple": Fault(KNOWN[2], ripple, FIRST),
    }
