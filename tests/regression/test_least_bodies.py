"""A body whose mass the motion does not show is as small as its torque allows."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from cdia_pin import Dynamics, load_robot, save_model
from cdia_pin.app.exports import urdf_file
from cdia_pin.app.python_lines import _writing
from cdia_pin.cli import main
from cdia_pin.effects import parse_term
from cdia_pin.exports.torque_left_out import states_of
from cdia_pin.logs.conditioning import condition
from cdia_pin.regression.least_bodies import with_least_bodies
from tests.made_logs import make

NOISE = 0.02  # [N·m]
# The first axis stands still: the motion shows how far out the mass of the first link is, and not the mass.
FIRST = "link_inertia@joint1: mass=0.5, first_moment_z=0.01, inertia_xx=0.003, inertia_yy=0.003"


def estimated(*, lower, upper):
    """Return a model of a double pendulum with another first link, and an interval of its mass."""
    robot = load_robot("double_pendulum")
    term = parse_term(FIRST)
    term = replace(term, ci95=((lower, upper), *((v - 1e-3, v + 1e-3) for v in term.theta[1:])))
    model = Dynamics(robot, (term,))
    made = make(robot, noise=NOISE)
    effort = model.inverse_dynamics(made.q, made.v, made.a) + (
        made.log.effort - robot.inverse_dynamics(made.q, made.v, made.a)
    )
    return replace(model, learned_from=(condition(replace(made.log, effort=effort), robot),))


def test_a_mass_that_no_motion_shows_is_the_least_with_the_same_torque():
    model = estimated(lower=-9.0, upper=12.0)
    least, replaced = with_least_bodies(model)
    (before,), (after,) = model.terms, least.terms
    assert replaced == (before,)
    assert abs(after.theta[0]) < 0.1 * before.theta[0]
    assert after.effect.is_physical(np.array(after.theta), model.robot)
    for x in states_of(model):
        change = least.torques(x).reading - model.torques(x).reading
        assert np.sqrt(np.mean(change**2, axis=0)).max() < 0.1 * NOISE


def test_an_exported_urdf_holds_it_and_the_command_says_so(tmp_path, capsys):
    known = save_model(estimated(lower=-9.0, upper=12.0), tmp_path / "model.json")
    file = tmp_path / "corrected.urdf"
    code = main(["export", "--robot", "double_pendulum", "--model", str(known), "--urdf", str(file)])
    said = " ".join(capsys.readouterr().out.split())
    assert code == 0 and "does not show the mass of link_inertia@joint1 (−9.0 to 12 kg)" in said
    before, after = (load_robot(r).inertial_parameters[0, 0] for r in ("double_pendulum", file))
    assert after == pytest.approx(before, rel=0.1)


def test_the_app_exports_it_and_its_python_lines_say_so(tmp_path):
    model = estimated(lower=-9.0, upper=12.0)
    file = tmp_path / "corrected.urdf"
    session = SimpleNamespace(present=SimpleNamespace(model=model), history=SimpleNamespace(at=0))
    file.write_bytes(urdf_file(session))
    before, after = (load_robot(r).inertial_parameters[0, 0] for r in ("double_pendulum", file))
    assert after == pytest.approx(before, rel=0.1)
    assert any(line.startswith("model, _ = with_least_bodies(model)") for line in _writing(session))


def test_a_known_mass_stays():
    model = estimated(lower=1.0, upper=2.0)
    assert with_least_bodies(model) == (model, ())


@pytest.mark.parametrize("forgotten", ["motion", "intervals"])
def test_without_a_motion_or_intervals_nothing_changes(forgotten):
    model = estimated(lower=-9.0, upper=12.0)
    if forgotten == "motion":
        model = replace(model, learned_from=())
    else:
        model = replace(model, terms=(replace(model.terms[0], ci95=None),))
    assert with_least_bodies(model) == (model, ())
