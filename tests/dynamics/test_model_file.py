"""Models as files: what is written is read, what is no model is refused in one line."""

import json

import pytest

from cdia_pin.dynamics import Dynamics, load_model, save_model
from cdia_pin.effects import Term, parse_term
from cdia_pin.errors import ModelError
from cdia_pin.robot import load_robot

TERMS = (
    "coulomb_friction@elbow_joint: level=4.1, after=3",
    "stribeck_friction@wrist_1_joint: level=1, breakaway=.5, decay=3",
    "payload: mass=1.5, first_moment_z=.1",
    "effort_delay: delay=.004",
    "a*sin(q) + b*dq**3@wrist_2_joint: a=.1, b=-2",
    "unknown@wrist_3_joint: position_weight_1=.3, q=-1..1",
)


@pytest.fixture(scope="module")
def arm():
    return load_robot("ur5")


@pytest.fixture
def model(arm):
    terms = [parse_term(t, arm) for t in TERMS]
    terms[0] = Term(terms[0].effect, terms[0].theta, terms[0].profile, ci95=((3.9, 4.3),))
    return Dynamics(arm, tuple(terms))


@pytest.fixture
def document(model, tmp_path):
    return json.loads(save_model(model, tmp_path / "model.json").read_text(encoding="utf-8"))


def written(document, tmp_path):
    path = tmp_path / "changed.json"
    path.write_text(json.dumps(document), encoding="utf-8")
    return path


def refused(path, robot) -> str:
    with pytest.raises(ModelError) as error:
        load_model(path, robot)
    message = str(error.value)
    assert path.name in message
    assert "\n" not in message
    return message


def test_a_model_survives_its_file(arm, model, tmp_path):
    path = save_model(model, tmp_path / "model.json", record={"logs": ["run.csv"], "seed": 3})
    again = load_model(path, arm)
    assert again == model
    assert again.terms[0].ci95 == ((3.9, 4.3),)
    assert json.loads(path.read_text(encoding="utf-8"))["record"]["seed"] == 3


def test_a_bare_model_is_a_model(arm, tmp_path):
    assert load_model(save_model(Dynamics(arm), tmp_path / "m.json"), arm).terms == ()


def test_a_file_can_be_written_by_hand(arm, tmp_path):
    by_hand = {
        "schema": "cdia-model/1",
        "robot": "ur5",
        "joints": list(arm.joints),
        "terms": [{"effect": "coulomb_friction", "joints": ["elbow_joint"], "parameters": {"level": 4.1}}],
    }
    (term,) = load_model(written(by_hand, tmp_path), arm).terms
    assert term == parse_term("coulomb_friction@elbow_joint: level=4.1")


def test_a_parameter_in_another_unit_is_refused(arm, document, tmp_path):
    document["terms"][0]["parameters"]["level"].update(value=4100.0, unit="N·mm")
    message = refused(written(document, tmp_path), arm)
    assert "coulomb_friction@elbow_joint: level is in N·m, given in 'N·mm'" in message
    document["terms"][0]["parameters"]["level"]["unit"] = None
    assert "given in 'None'" in refused(written(document, tmp_path), arm)


def test_a_unit_depends_on_the_joint(tmp_path):
    scara = load_robot("scara")
    slides = scara.joints[int(scara.is_prismatic.argmax())]
    path = save_model(
        Dynamics(scara, (parse_term(f"coulomb_friction@{slides}: level=4"),)), tmp_path / "m.json"
    )
    document = json.loads(path.read_text(encoding="utf-8"))
    assert load_model(path, scara).terms[0].theta == (4.0,)
    document["terms"][0]["parameters"]["level"]["unit"] = "N·m"
    assert "level is in N, given in 'N·m'" in refused(written(document, tmp_path), scara)


def test_units_may_be_typed(arm, document, tmp_path):
    document["terms"][0]["parameters"]["level"]["unit"] = "N * m"
    assert load_model(written(document, tmp_path), arm).terms[0].theta == (4.1,)


def test_another_robot_is_refused(model, tmp_path):
    path = save_model(model, tmp_path / "model.json")
    assert "joint1" in refused(path, load_robot("scara"))
    assert "made for 'ur5'" in refused(path, load_robot("ur10"))  # whose joints have the same names


def test_the_same_robot_under_another_name_is_accepted(arm, model, tmp_path):
    copy = tmp_path / "my_ur5.urdf"
    copy.write_bytes(arm.urdf.read_bytes())
    path = save_model(model, tmp_path / "model.json")
    assert load_model(path, load_robot(copy)).terms == model.terms


@pytest.mark.parametrize(
    "text", ["", "not json", "[]", "3", "null", "{}", '{"schema": "cdia-report/1"}', "[" * 100_000]
)
def test_a_file_that_is_not_a_model_is_refused(arm, tmp_path, text):
    path = tmp_path / "model.json"
    path.write_text(text, encoding="utf-8")
    assert "not a model" in refused(path, arm)


def test_bytes_that_are_not_text_are_refused(arm, tmp_path):
    path = tmp_path / "model.json"
    path.write_bytes(b"\xff\xfe\x00\x01")
    assert "not a model" in refused(path, arm)


def test_a_missing_file_is_refused(arm, tmp_path):
    assert "No such file" in refused(tmp_path / "missing.json", arm)
    assert "cannot read" in refused(tmp_path, arm)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda t: t.update(effect="coulomb_frction"), "coulomb_friction"),
        (lambda t: t.update(effect=None), "unknown effect"),
        (lambda t: t.update(joints=["elbow"]), "elbow_joint"),
        (lambda t: t.update(joints=[]), "takes 1 joint"),
        (lambda t: t.update(joints="elbow_joint"), "joints must be a list"),
        (lambda t: t.update(joints=[3]), "takes 1 joint"),
        (lambda t: t.update(shape={"decay": 3.0}), "decay"),
        (lambda t: t.update(shape=[1.0]), "shape an object"),
        (lambda t: t.update(parameters={}), "no value for parameter level"),
        (lambda t: t.update(parameters={"level": 1.0, "levle": 2.0}), "levle"),
        (lambda t: t["parameters"]["level"].update(value=float("nan")), "finite"),
        (lambda t: t["parameters"]["level"].update(value=float("inf")), "finite"),
        (lambda t: t["parameters"]["level"].update(value="four"), "not valid"),
        (lambda t: t["parameters"]["level"].pop("value"), "not valid"),
        (lambda t: t["parameters"]["level"].update(ci95=[1.0]), "not valid"),
        (lambda t: t.update(profile={"kind": "sometimes"}), "sometimes"),
        (lambda t: t.update(profile={"kind": "between", "start": "now"}), "must be a number"),
        (lambda t: t.update(profile={"kind": "region", "joint": "elbow", "signal": "speed"}), "elbow_joint"),
        (lambda t: t.clear(), "unknown effect"),
    ],
)
def test_a_damaged_term_is_named(arm, document, tmp_path, change, message):
    change(document["terms"][0])
    assert message in refused(written(document, tmp_path), arm)


@pytest.mark.parametrize(
    ("key", "value"),
    [("terms", None), ("terms", [3]), ("terms", {"a": 1}), ("joints", None), ("joints", "elbow")],
)
def test_a_damaged_document_is_refused(arm, document, tmp_path, key, value):
    document[key] = value
    refused(written(document, tmp_path), arm)


def test_a_file_that_cannot_be_written_raises_a_model_error(model, tmp_path):
    with pytest.raises(ModelError, match="cannot write"):
        save_model(model, tmp_path / "no" / "folder.json")
    with pytest.raises(ModelError, match="plain JSON"):
        save_model(model, tmp_path / "m.json", record={"a": object()})
    assert not (tmp_path / "m.json").exists()
