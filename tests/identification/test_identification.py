"""The full identification, of an arm in MuJoCo that is known to the last gram, by strong and weak motions."""

import json

import numpy as np
import pytest

from benchmarks.plant import Fault, Fourier, single, slow, small
from cdia_pin import Dynamics, load_model, load_robot, save_model, write_corrected_urdf
from cdia_pin.diagnosis.refitted_halves import refitted_halves
from cdia_pin.discovery.beyond_model import is_known
from cdia_pin.effects import Payload, Term
from cdia_pin.effects.body import Body
from cdia_pin.errors import LogError
from cdia_pin.identification import IdentificationSettings, identify
from cdia_pin.identification.base import base_reduction
from cdia_pin.logs.conditioning import Conditioning, condition
from cdia_pin.regression import Experiment
from cdia_pin.robot.inertia import at_centre_of_mass, is_physical, parameters_of
from cdia_pin.selection import DiscoverySettings, Problem
from tests.hidden_plants import plant_of
from tests.made_logs import make

ARM = "ur5"
WRONG = {"mass": 0.2, "com": (0.01, -0.01, 0.02), "inertia": 0.2}  # mass as a share of the link's
JOINT_SHARE = 0.03  # of the torque limit: Coulomb friction, and viscous at 1 rad/s
ROTORS = (0.1, 0.1, 0.1, 0.03, 0.03, 0.03)  # [kg·m²]


def hidden(robot):
    """Friction and a rotor in each joint, and three links that are not as the URDF says."""
    faults = []
    for joint, limit, rotor in zip(robot.joints, robot.limits.effort, ROTORS, strict=True):
        level = float(JOINT_SHARE * limit)
        faults += [
            Fault("coulomb_friction", joint=joint, level=level),
            Fault("viscous_friction", joint=joint, coefficient=level),
            Fault("rotor_inertia", joint=joint, inertia=rotor),
        ]
    for j in (1, 2, 3):
        mass = WRONG["mass"] * float(robot.inertial_parameters[j, 0])
        faults.append(Fault("link_inertia", joint=robot.joints[j], **{**WRONG, "mass": mass}))
    return faults


def true_parameters(robot):
    out = robot.inertial_parameters.copy()
    for j in (1, 2, 3):
        mass, centre, inertia = at_centre_of_mass(out[j])
        out[j] = parameters_of(
            mass * (1 + WRONG["mass"]), centre + WRONG["com"], inertia * (1 + WRONG["inertia"])
        )
    return out


@pytest.fixture(scope="module")
def robot():
    return load_robot(ARM)


@pytest.fixture(scope="module")
def runs():
    """Runs of the arm by kind of motion, and one that is never fitted."""
    plant = plant_of(ARM)
    faults = hidden(plant.robot)
    motions = {"strong": Fourier(), "slow": slow(), "small": small(), "single": single(plant.joints[2:3])}
    out = {name: plant.run(faults, motion=motion, seed=1) for name, motion in motions.items()}
    return out | {"unseen": plant.run(faults, seed=1001)}


@pytest.fixture(scope="module")
def identified(robot, runs):
    """What is identified from each motion, held against the one that is never fitted."""
    return {
        name: identify(Dynamics(robot), run.log, holdout=runs["unseen"].log)
        for name, run in runs.items()
        if name != "unseen"
    }


def test_an_unseen_motion_is_predicted_to_the_noise(identified, runs, robot):
    """Of the torque, and of the rounded positions through the accelerations."""
    found, unseen = identified["strong"], runs["unseen"]
    motion = condition(unseen.log, robot)
    noise = unseen.noise_std * np.sqrt(2 * motion.cutoff / motion.record["log_rate"])
    noise = np.hypot(noise, Experiment.of(robot, [motion]).blur)
    assert (found.heldout_after < 1.5 * noise).all()
    assert (found.heldout_after < 0.05 * found.heldout_before).all()


def test_a_motion_that_is_driven_three_times_is_left_out_with_its_repeats(robot):
    plant = plant_of(ARM)
    log = plant.run(hidden(plant.robot), motion=Fourier(base=0.125), duration=24.0, seed=1).log
    found = identify(Dynamics(robot), log)
    assert (found.heldout_after < 0.05 * found.heldout_before).all()


def test_the_model_remembers_its_log(identified, runs, robot, tmp_path):
    """So a monitor fits it to halves of that log for its thresholds, and a later log is compared with it."""
    save_model(identified["strong"].model, tmp_path / "model.json")
    model, log = load_model(tmp_path / "model.json", robot), runs["strong"].log
    assert len(refitted_halves(model, [log], 1.0)) == 2
    assert is_known(Problem.conditioned(robot, [log], (), DiscoverySettings()).experiment, model)
    unseen = Problem.conditioned(robot, [runs["unseen"].log], (), DiscoverySettings())
    assert not is_known(unseen.experiment, model)


def test_intervals_cover_friction_and_rotors(identified, robot):
    plant, faults = plant_of(ARM), hidden(robot)
    others = [identify(Dynamics(robot), plant.run(faults, motion=Fourier(), seed=s).log) for s in (2, 3)]
    covered = []
    for model in (identified["strong"].model, *(found.model for found in others)):
        for fault in faults:
            if fault.effect == "link_inertia":
                continue
            (value,) = (v for v in fault.parameters.values() if isinstance(v, float))
            ((lower, upper),) = model.find(f"{fault.effect}@{fault.joint}").ci95
            covered.append(lower <= value <= upper)
    assert np.mean(covered) >= 0.9


@pytest.mark.parametrize("motion", ["strong", "slow"])
def test_intervals_cover_base_parameters(identified, robot, motion):
    base = identified[motion].base
    _, reduction = base_reduction(robot)
    covered = np.abs(base.value - reduction @ true_parameters(robot).ravel()) <= base.half_width
    assert covered[base.identifiable].mean() >= 0.85
    assert covered.mean() >= 0.85


@pytest.mark.parametrize("motion", ["strong", "slow", "small", "single"])
def test_every_link_is_a_body_that_can_exist(identified, robot, motion):
    found = identified[motion]
    assert len(found.bodies) == robot.n
    assert is_physical(found.inertial_parameters).all()
    assert (found.margin > 0).all()
    assert all(t.effect.is_physical(np.array(t.theta), robot) for t in found.model.terms)


@pytest.mark.parametrize("motion", ["slow", "small", "single"])
def test_a_weak_motion_spoils_nothing(identified, motion):
    """The unseen motion is the strong one: with what this log could not tell, errors must not grow."""
    found = identified[motion]
    assert (found.heldout_after < 1.02 * found.heldout_before).all()
    assert (
        np.mean(found.heldout_after / found.heldout_before)
        < {"slow": 0.05, "small": 0.1, "single": 0.95}[motion]
    )


def test_without_the_hold_on_the_urdf_a_weak_motion_does_spoil(identified, robot, runs):
    free = identify(
        Dynamics(robot),
        runs["small"].log,
        holdout=runs["unseen"].log,
        settings=IdentificationSettings(strength=1e-6),
    )
    held = identified["small"]
    assert held.strength > 1.0
    assert np.mean(held.heldout_after / held.heldout_before) < np.mean(
        free.heldout_after / free.heldout_before
    )


def test_what_one_joint_cannot_identify_stays_as_in_the_urdf(identified, robot):
    found = identified["single"]
    assert found.base.identifiable.sum() < 0.5 * identified["strong"].base.identifiable.sum()
    nearest_base = found.inertial_parameters[0] - robot.inertial_parameters[0]  # a link that does not move
    assert np.abs(nearest_base).max() < 0.02 * np.abs(robot.inertial_parameters[0]).max()


def test_it_is_the_same_every_time(identified, robot, runs):
    again = identify(Dynamics(robot), runs["slow"].log, holdout=runs["unseen"].log)
    assert [t.theta for t in again.model.terms] == [t.theta for t in identified["slow"].model.terms]


def test_a_saved_model_and_a_corrected_urdf_say_the_same(identified, robot, tmp_path):
    found = identified["strong"]
    again = load_model(save_model(found.model, tmp_path / "model.json", record=found.record), robot)
    assert again == found.model
    totals = dict(zip(robot.joints, found.inertial_parameters, strict=True))
    corrected = load_robot(write_corrected_urdf(robot, tmp_path / "corrected.urdf", inertial=totals))
    assert corrected.inertial_parameters == pytest.approx(found.inertial_parameters, abs=1e-9)


def test_the_record_is_json_that_names_every_base_parameter(identified):
    found = identified["strong"]
    document = json.loads(json.dumps(found.to_dict()))
    assert document["schema"] == "cdia-identification/1"
    assert [b["name"] for b in document["base_parameters"]] == list(found.base.names)
    assert set(document["heldout_rms"]["after"]) == set(document["joints"])
    assert document["record"]["holdout"]


def test_a_plain_law_suffices_for_plain_friction(identified):
    assert identified["strong"].refined == ()


# ------------------------------------------------------------------ logs made in the open


@pytest.fixture(scope="module")
def pendulum():
    return load_robot("double_pendulum")


def settings(**more):
    return IdentificationSettings(conditioning=Conditioning(cutoff=8.0), **more)


@pytest.mark.parametrize(
    ("law", "name"),
    [
        (lambda q, v, a, load: -0.2 * np.abs(load) * np.tanh(v / 1e-3), "load_friction"),
        (lambda q, v, a, load: -0.5 * np.tanh(v / 0.5), "-tanh(dq/"),
        (
            lambda q, v, a, load: -(0.1 + 0.5 * np.exp(-5 * np.abs(v))) * np.tanh(v / 1e-3),
            "stribeck_friction",
        ),
    ],
)
def test_a_richer_law_is_taken_where_the_log_asks_for_it(pendulum, law, name):
    weight = 0.3 * np.abs(pendulum.inverse_dynamics(*np.zeros((3, 1, 2)) + 0.5)).max()

    def missing(q, v, a):
        out = np.zeros_like(q)
        load = pendulum.inverse_dynamics(q, v, a)[:, 0]
        out[:, 0] = law(q[:, 0], v[:, 0], a[:, 0], load / weight) * weight
        return out

    log = make(pendulum, missing, noise=1e-3 * weight, duration=40.0).log
    found = identify(Dynamics(pendulum), log, settings=settings())
    assert any(label.startswith(name) for label in found.refined)
    plain = identify(Dynamics(pendulum), log, settings=settings(refine=False))
    assert plain.refined == ()
    assert found.heldout_after[0] < 0.7 * plain.heldout_after[0]


def test_a_clean_log_is_left_to_the_urdf(pendulum):
    log = make(pendulum, noise=1e-3).log
    found = identify(Dynamics(pendulum), log, settings=settings())
    assert found.refined == ()
    assert found.inertial_parameters == pytest.approx(pendulum.inertial_parameters, abs=0.02)


def test_a_payload_that_is_known_takes_the_place_of_its_link(pendulum):
    known = Dynamics(pendulum, (Term(Payload(), (0.0,) * 10),))
    found = identify(known, make(pendulum, noise=1e-3).log, settings=settings())
    carriers = [t.effect.carrier(pendulum) for t in found.model.terms if isinstance(t.effect, Body)]
    assert sorted(carriers) == list(range(pendulum.n))


def test_a_log_of_other_joints_is_refused(pendulum, robot):
    with pytest.raises(LogError, match="joints"):
        identify(Dynamics(robot), make(pendulum).log)


def test_progress_ends_at_one(pendulum):
    told = []
    identify(
        Dynamics(pendulum), make(pendulum).log, settings=settings(), progress=lambda *said: told.append(said)
    )
    shares = [share for _, share in told]
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
