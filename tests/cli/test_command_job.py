"""The main job by command: check, compare, discover, add, export, convert."""

import json

import pytest

from cdia_pin import Dynamics, load_model, load_robot

ROBOT = ("--robot", "double_pendulum")
JOINTS = ["joint1", "joint2"]


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    return tmp_path_factory.mktemp("out")


@pytest.fixture(scope="module")
def discovered(cdia, logs, out):
    return cdia(
        "discover", logs / "run.csv", *ROBOT, "--holdout", logs / "other.csv",
        "--save", out / "found.json", "--json", out / "discovery.json",
    )  # fmt: skip


@pytest.fixture(scope="module")
def discovery(discovered, out):
    assert discovered.code == 0, discovered.err
    return json.loads((out / "discovery.json").read_text())


def test_check_says_what_it_looked_at(cdia, log):
    found = cdia("check", log, *ROBOT, "--json", "-").json
    assert found["schema"] == "cdia-check/1"
    assert {"rate", "gaps", "sign", "joint_order", "effort_kind"} <= {f["topic"] for f in found["findings"]}
    assert "joint1" in cdia("check", log, *ROBOT).out


def test_compare_json_is_as_the_contract_says(cdia, log):
    found = cdia("compare", log, *ROBOT, "--json", "-").json
    assert found["schema"] == "cdia-comparison/1"
    for key in ("rms", "relative_rms", "bias", "autocorrelation"):
        assert list(found[key]) == JOINTS
    assert found["worst_regions"]


def test_compare_shows_joints_and_regions(cdia, log):
    shown = cdia("compare", log, *ROBOT)
    assert shown.code == 0
    assert shown.err == ""
    assert all(joint in shown.out for joint in JOINTS)
    assert "run.csv: 2000 samples" in shown.out


def test_several_logs_are_compared_together(cdia, logs):
    found = cdia("compare", logs / "run.csv", logs / "other.csv", *ROBOT, "--json", "-").json
    assert len(found["record"]["logs"]) == 2


def test_discover_json_is_as_the_contract_says(discovery):
    assert discovery["schema"] == "cdia-discovery/1"
    assert discovery["robot"] == "double_pendulum"
    assert discovery["joints"] == JOINTS
    assert discovery["verdict"] == "explained"
    (effect,) = discovery["effects"]
    assert effect["effect"] == "coulomb_friction"
    assert effect["joints"] == ["joint2"]
    level = effect["parameters"]["level"]
    assert level["unit"] == "N·m"
    (low, high), (lower, upper) = level["ci95"], level["ci95_statistical"]
    assert low <= lower < level["value"] < upper <= high
    assert effect["confidence"] in {"established", "likely", "descriptive"}
    assert (effect["group"], effect["change_of_model"]) == ("friction", False)
    assert set(discovery["capability"]) == {"payload", "push", "friction", "feedforward_error"}
    for confusion in effect["confusable_with"]:
        assert set(confusion) == {"effect", "joints", "motion"}
    assert [s["added"] for s in discovery["trace"]] == [None, "coulomb_friction@joint2"]
    for step in discovery["trace"]:
        assert list(step["rms"]) == list(step["heldout_rms"]) == JOINTS
    assert list(discovery["noise_floor"]) == JOINTS


def test_discover_says_what_it_found_and_where_it_is(discovered, out):
    assert "coulomb friction" in discovered.out
    assert f"wrote {out / 'found.json'}" in discovered.out
    assert discovered.err == ""


def test_the_answer_is_short_and_the_rest_comes_on_request(cdia, discovered, log):
    asked = cdia("discover", log, *ROBOT, "--effects", "coulomb_friction", "--all")
    for words in ("by itself", "model as given", "level 0.05", "statistical"):
        assert words in asked.out
    assert "--all shows the numbers" in discovered.out
    assert "by itself" not in discovered.out


def test_discover_ranks_single_candidates(discovery):
    first = discovery["ranking"][0]
    assert {"effect", "joints", "parameters", "heldout_rms", "confusable_with"} <= set(first)


def test_the_saved_model_makes_the_error_fall(cdia, discovery, log, out):
    before = cdia("compare", log, *ROBOT, "--json", "-").json["relative_rms"]
    after = cdia("compare", log, *ROBOT, "--model", out / "found.json", "--json", "-").json["relative_rms"]
    assert after["joint2"] < 0.2 * before["joint2"]


def test_nothing_is_missing_where_nothing_is(cdia, logs):
    found = cdia("discover", logs / "clean.csv", *ROBOT, "--json", "-").json
    assert found["verdict"] == "nothing-missing"
    assert found["effects"] == []


def test_a_model_that_has_it_misses_nothing(cdia, discovery, logs, out):
    found = cdia("discover", logs / "other.csv", *ROBOT, "--model", out / "found.json", "--json", "-").json
    assert found["verdict"] == "nothing-missing"


def test_only_named_effects_and_own_ones_are_searched(cdia, log):
    arguments = ("--effects", "torque_offset", "--extra", "sign(dq)@joint2", "--json", "-")
    found = cdia("discover", log, *ROBOT, *arguments).json
    assert [e["effect"] for e in found["effects"]] == ["expression"]


def labels(path) -> list[str]:
    return [t.label for t in load_model(path, load_robot("double_pendulum")).terms]


@pytest.fixture(scope="module")
def added(cdia, logs, out):
    saved = out / "added.json"
    outcome = cdia(
        "add", "coulomb_friction@joint2", logs / "run.csv", *ROBOT, "--save", saved,
        "--json", out / "added_result.json",
    )  # fmt: skip
    assert outcome.code == 0, outcome.err
    return saved


def test_add_makes_the_error_fall(added, out):
    before, after = json.loads((out / "added_result.json").read_text())["trace"]
    assert (before["added"], after["added"]) == (None, "coulomb_friction@joint2")
    assert after["heldout_rms"]["joint2"] < 0.2 * before["heldout_rms"]["joint2"]
    assert labels(added) == ["coulomb_friction@joint2"]


def test_add_says_where_an_effect_explains_nothing(cdia, log):
    assert "does not lower the error" in cdia("add", "torque_offset@joint1", log, *ROBOT).out


def test_an_effect_that_is_there_already_is_replaced(cdia, added, log, out):
    again = out / "again.json"
    outcome = cdia("add", "coulomb_friction@joint2", log, *ROBOT, "--model", added, "--save", again)
    assert outcome.code == 0
    assert "has coulomb_friction@joint2 already: it is left out, and fitted again" in " ".join(
        outcome.out.split()
    )
    assert [t.label for t in load_model(again, load_robot("double_pendulum")).terms] == [
        "coulomb_friction@joint2"
    ]


def test_a_report_is_one_page(cdia, log, out):
    page = out / "before.html"
    assert cdia("compare", log, *ROBOT, "--report", page).code == 0
    text = page.read_text()
    assert "joint2" in text
    assert f"cdia compare {log}" in text


def test_export_writes_what_a_urdf_can_hold(cdia, discovery, out):
    urdf = out / "corrected.urdf"
    outcome = cdia("export", *ROBOT, "--model", out / "found.json", "--urdf", urdf)
    assert outcome.code == 0, outcome.err
    level = discovery["effects"][0]["parameters"]["level"]["value"]
    assert load_robot(urdf).urdf_friction[1] == pytest.approx(level)


@pytest.fixture
def model_of(out):
    from cdia_pin import save_model
    from cdia_pin.effects import parse_term

    def write(name, *terms):
        return save_model(Dynamics(load_robot("double_pendulum"), tuple(map(parse_term, terms))), out / name)

    return write


def test_export_says_what_it_cannot_hold(cdia, model_of, out):
    model = model_of(
        "mixed.json", "viscous_friction@joint1: coefficient=0.1", "torque_offset@joint2: offset=0.2"
    )
    found = cdia("export", *ROBOT, "--model", model, "--urdf", out / "mixed.urdf", "--json", "-").json[
        "files"
    ]["urdf"]
    assert found["written"] == ["viscous_friction@joint1"]
    assert list(found["left_out"]) == ["torque_offset@joint2"]
    assert load_robot(out / "mixed.urdf").urdf_damping[0] == pytest.approx(0.1)


def test_export_of_bodies_gives_the_same_torques(cdia, model_of, out):
    import numpy as np

    tool = "payload: mass=0.3, first_moment_z=0.02, inertia_xx=0.01, inertia_yy=0.01, inertia_zz=0.01"
    model = model_of("bodies.json", tool, "link_inertia@joint1: mass=0.1")
    assert cdia("export", *ROBOT, "--model", model, "--urdf", out / "bodies.urdf").code == 0
    q, v, a = np.random.default_rng(0).uniform(-1, 1, (3, 2))
    improved = load_model(model, load_robot("double_pendulum"))
    assert load_robot(out / "bodies.urdf").inverse_dynamics(q, v, a) == pytest.approx(
        improved.inverse_dynamics(q, v, a)
    )


@pytest.mark.parametrize(
    "terms", [[], ["torque_offset@joint1: offset=1"], ["coulomb_friction@joint1: level=1, after=4"]]
)
def test_export_of_nothing_is_an_error(cdia, model_of, out, terms):
    model = model_of("nothing.json", *terms)
    assert cdia("export", *ROBOT, "--model", model, "--urdf", out / "none.urdf").code == 2
    assert not (out / "none.urdf").exists()


@pytest.mark.parametrize("suffix", ["csv", "parquet", "npz"])
def test_convert_keeps_every_number(cdia, log, out, suffix):
    import numpy as np

    from cdia_pin import read_log

    target = out / f"converted.{suffix}"
    assert cdia("convert", log, target, *ROBOT).code == 0
    robot = load_robot("double_pendulum")
    before, after = read_log(log, robot), read_log(target, robot)
    assert np.array_equal(before.effort, after.effort)
    assert np.array_equal(before.time, after.time)


def test_convert_to_an_unknown_format_is_an_error(cdia, log, out):
    assert ".parquet" in cdia("convert", log, out / "run.xlsx", *ROBOT).error
