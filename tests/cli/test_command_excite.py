"""``cdia excite`` writes a motion that keeps its limits, and says what it gains."""

import json

import numpy as np
import pytest

from cdia_pin import load_robot, read_log

ROBOT = ("--robot", "double_pendulum")
PAIR = ("--between", "actuator_gain@joint1", "link_inertia@joint1")


@pytest.fixture(scope="module")
def designed(cdia, tmp_path_factory):
    folder = tmp_path_factory.mktemp("excite")
    shown = cdia(
        "excite", *ROBOT, *PAIR, "--duration", "12", "--rate", "100", "--out", folder / "motion.csv",
        "--ros", folder / "motion.yaml", "--json", folder / "motion.json",
    )  # fmt: skip
    assert shown.code == 0, shown.err
    return shown, folder


def test_the_files_are_named_and_hold_the_motion(designed):
    shown, folder = designed
    for name in ("motion.csv", "motion.yaml", "motion.json"):
        assert f"wrote {folder / name}" in shown.out
    log = read_log(folder / "motion.csv", load_robot("double_pendulum"))
    assert log.rate == pytest.approx(100.0)
    assert log.duration == pytest.approx(12.0)
    assert (
        (folder / "motion.yaml").read_text(encoding="utf-8").startswith('joint_names: ["joint1", "joint2"]')
    )


def test_peaks_and_gain_are_shown(designed):
    shown, _ = designed
    assert "joint1" in shown.out
    assert "other obstacles are not known" in " ".join(shown.out.split())
    assert "standard deviations" in " ".join(shown.out.split())
    assert "the URDF states no effort limit for joint1, joint2" in shown.err


def test_its_json_says_which_limits_are_kept(designed):
    found = json.loads((designed[1] / "motion.json").read_text(encoding="utf-8"))
    assert found["schema"] == "cdia-excitation/1"
    assert found["gain"]["between"] == list(PAIR[1:])
    assert found["gain"]["enough"]
    for joint in found["joints"]:
        for name, values in found["limits"][joint].items():
            peak, limit = values["peak"], values["limit"]
            if limit is not None:
                assert peak >= limit if name == "lower" else peak <= limit, (joint, name)
    assert found["record"]["seed"] == 0


def test_an_earlier_log_is_what_it_is_measured_against(cdia, log, tmp_path):
    shown = cdia(
        "excite", *ROBOT, *PAIR, "--after", log, "--duration", "8", "--out", tmp_path / "m.csv", "--json", "-"
    )
    assert shown.code == 0, shown.err
    assert shown.json["gain"]["before"] > 0
    assert shown.out.lstrip().startswith("{")


def test_parameters_of_named_effects(cdia, tmp_path):
    limits = ("--speed", "0.3", "--acceleration", "2", "--acceleration", "joint2=1", "--floor", "none")
    wanted = ("--effects", "viscous_friction@joint1,payload", "--duration", "8")
    shown = cdia("excite", *ROBOT, *wanted, *limits, "--out", tmp_path / "m.csv")
    assert shown.code == 0, shown.err
    table = np.genfromtxt(tmp_path / "m.csv", delimiter=",", names=True, deletechars="")
    assert np.abs(table["acceleration.joint2"]).max() <= 1.0
    assert np.abs(table["acceleration.joint1"]).max() <= 2.0
    assert np.abs(table["velocity.joint1"]).max() <= 0.9
    assert "combinations of 11 parameters" in " ".join(shown.out.split())


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--between", "coulomb@joint1", "payload"), "unknown effect 'coulomb'; did you mean"),
        (("--between", "payload", "coulomb_friction@elbow"), "unknown joint 'elbow'; known: joint1, joint2"),
        (("--between", "payload", "payload"), "payload was given twice"),
        (
            ("--between", "encoder_offset@joint1", "base_tilt"),
            "no motion of this arm tells encoder_offset@joint1 from",
        ),
        ((*PAIR, "--effects", "payload"), "--between and --effects are two purposes"),
        (("--duration", "1"), "a motion must last 6 to 600 s"),
        (("--rate", "1"), "10 to 10000 Hz"),
        (("--seed", "-1"), "'--seed': must be 0 to"),
        (("--speed", "0"), "'--speed': must be 0.001 to 1, given 0"),
        (("--acceleration", "fast"), "--acceleration takes A or JOINT=A"),
        (("--acceleration", "elbow=1"), "unknown joint 'elbow'"),
        (("--acceleration", "-1"), "--acceleration is above 0"),
        (("--floor", "low"), "--floor takes a height in m, base or none"),
        (("--floor", "9"), "no posture is free of contact"),
        (("--clearance", "-1"), "'--clearance': must be 0 to 10 m, given -1"),
        (("--srdf", "none.srdf"), "no such SRDF file"),
        (("--model", "none.json"), "none.json"),
        (("--after", "none.csv"), "none.csv"),
    ],
)
def test_what_cannot_be_done_is_one_line(cdia, tmp_path, arguments, said):
    out = tmp_path / "motion.csv"
    assert said in cdia("excite", *ROBOT, "--out", out, *arguments).error
    assert not out.exists()


def test_a_joint_without_room_is_one_line(cdia, tmp_path):
    text = load_robot("scara").urdf.read_text(encoding="utf-8")
    file = tmp_path / "stiff.urdf"
    file.write_text(text.replace('lower="0" upper="0.200"', 'lower="0" upper="0.001"'), encoding="utf-8")
    assert "joint4 leave no room" in cdia("excite", "--robot", file, "--out", tmp_path / "m.csv").error


def test_an_output_that_cannot_be_written_is_said_first(cdia, tmp_path):
    assert "no directory" in cdia("excite", *ROBOT, "--out", tmp_path / "none" / "m.csv").error
