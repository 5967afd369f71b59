"""The repr of every public object is one short line that names it."""

import numpy as np
import pytest

import cdia_pin.dynamics as room
from cdia_pin.dynamics import ComputedTorque, Dynamics, Run, Sensors, exciting_trajectory, run_plant
from cdia_pin.dynamics.smoothing import Stiffness
from cdia_pin.dynamics.trajectories import Repeated
from cdia_pin.dynamics.urdf_terms import UrdfValues
from cdia_pin.effects import ActuatorGain, CoulombFriction, State, Term, ViscousFriction
from cdia_pin.robot import load_robot


@pytest.fixture(scope="module")
def examples() -> list[object]:
    arm = load_robot("ur5")
    terms = [
        Term(effect(j), (0.1,))
        for effect in (CoulombFriction, ViscousFriction, ActuatorGain)
        for j in arm.joints
    ]
    plant = Dynamics(arm, tuple(terms))
    motion = exciting_trajectory(arm, np.random.default_rng(0), duration=2.0)
    asked = motion(np.linspace(0.0, 2.0, 500))
    torques = plant.torques(State.of(arm, *asked))
    run = run_plant(plant, motion, duration=0.01)
    stiffness, values = Stiffness.of(plant, motion), UrdfValues.of(plant.terms, arm)
    sensors = Sensors(1e-5, 1e-5, 1e-3, 0.1, 0.01)
    control = ComputedTorque(plant)
    return [
        plant,
        Dynamics(arm),
        motion,
        Repeated(motion),
        asked,
        torques,
        run,
        sensors,
        control,
        stiffness,
        values,
    ]


def test_a_repr_is_one_short_line_that_names_the_object(examples):
    for shown in examples:
        text = repr(shown)
        assert text.startswith(type(shown).__name__ + "("), text
        assert "\n" not in text
        assert len(text) < 200, text


def test_every_public_class_of_the_folder_has_an_example(examples):
    public = {x for x in vars(room).values() if isinstance(x, type)}
    protocols = {x for x in public if getattr(x, "_is_protocol", False)}
    assert public - protocols <= {type(x) for x in examples}
    assert Run in public


def test_the_repr_of_a_model_tells_its_robot_and_terms():
    arm = load_robot("ur5")
    assert repr(Dynamics(arm)) == "Dynamics('ur5', no terms)"
