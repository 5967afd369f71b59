"""Characters of files that control a terminal never reach it; what no arm can have is refused."""

import re

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from cdia_pin.dynamics.physical import require_physical
from cdia_pin.effects import parse_term
from cdia_pin.effects.weight import largest_weight
from cdia_pin.phrases import printable
from cdia_pin.robot.catalogue import robots_here

STYLE = re.compile(r"\x1b\[[0-9;]*m")  # what rich writes itself
ODD = "a\x1b]0;owned\x07\x1b[2J\x9b31mb\u202ec\rd"


def controls(text: str) -> set[str]:
    return {c for c in STYLE.sub("", text) if not c.isprintable() and c not in "\n\xa0"}


@given(st.text(max_size=200))
def test_a_printable_text_controls_nothing(text):
    assert not controls(printable(text))
    assert len(printable(text)) == len(text)


@pytest.fixture
def odd_log(log, tmp_path):
    file = tmp_path / f"{ODD}.csv"
    names, *rows = log.read_text().splitlines()
    file.write_text("\n".join([f"{names},{ODD}", *(f"{row},0" for row in rows)]) + "\n")
    return file


@pytest.mark.parametrize(
    "arguments",
    [
        ["check", "LOG"],
        ["compare", "LOG"],
        ["discover", "LOG"],
        ["add", "coulomb_friction@joint2", "LOG"],
        ["convert", "LOG", "OUT"],
        ["compare", "LOG", "--json", "-"],
        ["compare", "LOG", "--topic", ODD, "--convert", ODD],
        ["check", "LOG", "--joint-map", f"{ODD}=joint1"],
        ["compare", "MISSING"],
    ],
)
def test_names_of_files_and_columns_do_not_reach_the_terminal_as_they_are(cdia, odd_log, tmp_path, arguments):
    known = {"LOG": odd_log, "OUT": tmp_path / f"{ODD}2.csv", "MISSING": tmp_path / f"{ODD}3.csv"}
    done = cdia(*(known.get(a, a) for a in arguments), "--robot", "double_pendulum")
    assert not controls(done.out) and not controls(done.err), (done.out, done.err)


@given(name=st.text(st.characters(exclude_characters="/\0"), min_size=1, max_size=30))
@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_names_in_models_do_not_either(cdia, log, tmp_path, name):
    import json

    term = {"effect": name, "joints": [name], "parameters": {"level": 1.0}}
    document = {"schema": "cdia-model/1", "robot": name, "joints": ["joint1", "joint2"], "terms": [term]}
    (tmp_path / "model.json").write_text(json.dumps(document))
    done = cdia(
        "compare", log, "--robot", "double_pendulum", "--no-check", "--model", tmp_path / "model.json"
    )
    assert done.code == 2 and not controls(done.err)


@pytest.mark.parametrize(
    ("fault", "said"),
    [
        ("coulomb_friction@joint1: level=-5", "level = -5 is not within 0 to inf"),
        ("viscous_friction@joint1: coefficient=-1", "coefficient = -1"),
        ("actuator_gain@joint1: gain=-1", "gain = -1"),
        ("payload: mass=-100", "payload"),
        ("coulomb_friction@joint1: level=1e308", "below 1e+12"),
        ("rotor_inertia@joint1: inertia=-0.1", "inertia"),
    ],
)
def test_a_fault_that_no_arm_can_have_is_refused(cdia, tmp_path, fault, said):
    out = tmp_path / "out.csv"
    done = cdia("simulate", "--robot", "double_pendulum", "--fault", fault, "--out", out)
    assert said in done.error and not out.exists()


@pytest.mark.parametrize(
    ("fault", "said"),
    [
        (
            "coulomb_friction@elbow_joint: level=1e9",
            "1e+09 N·m at elbow_joint, more than 10 times the 150 N·m",
        ),
        ("viscous_friction@elbow_joint: coefficient=1e6", "at elbow_joint"),
        ("rotor_inertia@elbow_joint: inertia=1e9", "at elbow_joint"),
        ("payload: mass=1e6", "more than 10 times"),
        ("torque_offset@wrist_3_joint: offset=-1e6", "at wrist_3_joint"),
        ("coulomb_friction@elbow_joint: level=5, after=-4", "after is 0 to 1e+10, given -4"),
        ("coulomb_friction@elbow_joint: level=5, after=1e308", "after is 0 to 1e+10, given 1e308"),
        ("coulomb_friction@elbow_joint: level=5, until=inf", "until is 0 to 1e+10, given inf"),
        ("coulomb_friction@elbow_joint: level=5, after=1, rate=1e300", "rate is 0 to 1e+10"),
    ],
)
def test_a_fault_that_is_larger_than_any_is_refused(cdia, tmp_path, fault, said):
    out = tmp_path / "out.csv"
    done = cdia("simulate", "--robot", "ur5", "--duration", "5", "--fault", fault, "--out", out)
    assert said in done.error and not out.exists()


@given(share=st.floats(0.0, 2.0), sign=st.sampled_from([-1, 1]))
def test_a_fault_of_up_to_twice_the_effort_is_not_refused(ur5, share, sign):
    for joint, effort in zip(ur5.joints, ur5.limits.effort, strict=True):
        require_physical([parse_term(f"torque_offset@{joint}: offset={sign * share * effort}")], ur5)
        require_physical([parse_term(f"coulomb_friction@{joint}: level={share * effort}")], ur5)


def test_what_arms_have_is_not_refused():
    for arm in robots_here():
        require_physical([parse_term(f"payload: mass={0.2 * arm.total_mass}")], arm)
        for joint, weight in zip(arm.joints, largest_weight(arm), strict=True):
            require_physical([parse_term(f"coulomb_friction@{joint}: level={weight}")], arm)


def model_with(folder, *terms):
    import json

    file = folder / "model.json"
    document = {
        "schema": "cdia-model/1",
        "robot": "ur5",
        "joints": [
            *("shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint"),
            *("wrist_1_joint", "wrist_2_joint", "wrist_3_joint"),
        ],
        "terms": list(terms),
    }
    file.write_text(json.dumps(document))
    return file


def body(mass: float) -> dict:
    names = ("first_moment_x", "first_moment_y", "first_moment_z")
    inertias = [f"inertia_{axes}" for axes in ("xx", "xy", "yy", "xz", "yz", "zz")]
    numbers = {"mass": mass} | dict.fromkeys((*names, *inertias), 0.0)
    return {"effect": "payload", "joints": [], "parameters": numbers}


def friction(level: float) -> dict:
    return {"effect": "coulomb_friction", "joints": ["elbow_joint"], "parameters": {"level": level}}


@pytest.mark.parametrize("term", [body(-100.0), friction(-5.0), friction(1e9)])
def test_export_refuses_what_a_urdf_cannot_be(cdia, tmp_path, term):
    out = tmp_path / "arm.urdf"
    done = cdia("export", "--robot", "ur5", "--model", model_with(tmp_path, term), "--urdf", out)
    assert "no arm can be written" in done.error and not out.exists()


def test_export_lists_what_it_could_not_express_and_adds_up_what_comes_twice(cdia, tmp_path):
    offset = {"effect": "torque_offset", "joints": ["elbow_joint"], "parameters": {"offset": 1.0}}
    model = model_with(tmp_path, friction(1.0), friction(2.0), body(1.0), body(0.5), offset)
    out = tmp_path / "arm.urdf"
    done = cdia("export", "--robot", "ur5", "--model", model, "--urdf", out)
    assert done.code == 0, done.err
    assert "not in the URDF  torque_offset@elbow_joint" in done.out
    assert 'friction="3.0"' in out.read_text()
    assert "1.5" in out.read_text()


def test_a_model_with_a_number_that_no_arm_has_is_doubted(cdia, tmp_path):
    done = cdia("check", "none.csv", "--robot", "ur5")
    assert done.code == 2
    model = model_with(tmp_path, friction(-5.0))
    huge = model_with(tmp_path, friction(1e9))
    assert "more than 10 times" in cdia("compare", "none.csv", "--robot", "ur5", "--model", huge).err
    model_with(tmp_path, friction(-5.0))
    assert "level = -5" in cdia("compare", "none.csv", "--robot", "ur5", "--model", model).err
