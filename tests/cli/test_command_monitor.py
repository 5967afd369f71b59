"""``cdia monitor`` says over a log what a monitor would have said live."""

import json
import re

import numpy as np
import pytest

from cdia_pin import Dynamics, Log, load_robot, read_log, write_log
from cdia_pin.campaigns.closed_loop import ClosedLoop, LoopSettings
from cdia_pin.effects import parse_term

ROBOT = ("--robot", "double_pendulum")
BANK = ("--bank", "coulomb_friction", "--bank", "viscous_friction")
FAULT = "viscous_friction@joint2: coefficient=0.2, after=7"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """``healthy.csv``, and ``run.csv`` with a fault after 7 s."""
    out = tmp_path_factory.mktemp("watched")
    settings = LoopSettings(rate=250.0, healthy_duration=10.0, seed=4)
    loop = ClosedLoop(Dynamics(load_robot("double_pendulum")), settings)
    write_log(loop.run(loop.motion(9, 10.0)).log, out / "healthy.csv")
    write_log(loop.run(loop.motion(0, 12.0), [parse_term(FAULT)]).log, out / "run.csv")
    return out


@pytest.fixture(scope="module")
def watched(cdia, folder):
    """What the command says of a healthy run and one with a fault."""
    files = {name: folder / name for name in ("found.json", "found.html", "better.json")}
    shown = cdia(
        "monitor", folder / "run.csv", *ROBOT, "--healthy", folder / "healthy.csv", *BANK, "--no-check",
        "--json", files["found.json"], "--report", files["found.html"], "--save", files["better.json"],
    )  # fmt: skip
    assert shown.code == 0, shown.err
    return shown.out, files


def test_the_fault_is_in_the_document(watched):
    found = json.loads(watched[1]["found.json"].read_text(encoding="utf-8"))
    assert found["schema"] == "cdia-events/1"
    assert [e["stage"] for e in found["events"]] == ["detection", "isolation", "accommodation"]
    assert found["events"][0]["time"] == pytest.approx(7.0, abs=0.2)
    isolation = found["events"][1]
    assert isolation["status"] == "unique"
    assert isolation["joints"] == ["joint2"]
    (fault,) = found["faults"]
    assert (fault["effect"], fault["joint"]) == ("viscous_friction", "joint2")
    assert fault["parameters"]["coefficient"]["value"] == pytest.approx(0.2, rel=0.05)
    assert "tracking_rms" not in found
    assert found["record"]["healthy"][0]["sha256"]
    assert found["record"]["log"]["source"].endswith("run.csv")


def test_a_person_can_read_it(watched):
    text = " ".join(watched[0].split())
    assert "viscous friction" in text
    assert "N·m·s/rad" in text
    assert "the residual left its threshold on joint2" in text


def test_the_end_is_compared_with_the_healthy_run(cdia, folder, watched):
    lasting = json.loads(watched[1]["found.json"].read_text(encoding="utf-8"))["lasting"]
    assert lasting["changes"]["schema"] == "cdia-changes/1"
    assert lasting["changes"]["after"] == ["run.csv (the end)"]
    assert "No change" not in " ".join(watched[0].split())  # a fault is believed
    common = ("monitor", folder / "run.csv", *ROBOT, "--healthy", folder / "healthy.csv", *BANK, "--no-check")
    assert "lasting" not in cdia(*common, "--no-compare", "--json", "-").json


def test_the_saved_model_has_the_fault(watched):
    terms = json.loads(watched[1]["better.json"].read_text(encoding="utf-8"))["terms"]
    assert [t["effect"] for t in terms] == ["viscous_friction"]


def test_the_report_is_there(watched):
    page = watched[1]["found.html"].read_text(encoding="utf-8")
    assert "cdia-monitor-report/1" in page
    assert "cdia monitor" in page


def test_with_the_saved_model_nothing_is_left(cdia, folder, watched):
    log = read_log(folder / "run.csv", load_robot("double_pendulum"))
    begin = int(np.searchsorted(log.time, 7.5))
    late = folder / "late.csv"
    write_log(log.slice(begin, len(log.time)), late)
    common = (*ROBOT, "--healthy", folder / "healthy.csv", *BANK, "--no-check", "--json", "-")
    with_fault = cdia("monitor", late, *common).json["events"]
    assert [e["stage"] for e in with_fault][:1] == ["detection"]
    terms = json.loads(watched[1]["better.json"].read_text(encoding="utf-8"))
    assert terms["terms"]
    # The model is of the faulty arm now: it is the run, not the healthy arm, that it explains.
    learned = cdia("monitor", late, *ROBOT, "--model", watched[1]["better.json"], *BANK, "--no-check",
                   "--threshold", "joint1=0.02,joint2=0.02", "--json", "-")  # fmt: skip
    assert learned.json["events"] == []


def test_the_first_part_is_healthy_if_nothing_else_is_said(cdia, folder):
    shown = cdia("monitor", folder / "run.csv", *ROBOT, *BANK, "--no-check")
    assert shown.code == 0, shown.err
    # 5 s of motion, which begins slowly
    assert re.search(r"the first 5(\.0\d)? s are taken as healthy", " ".join(shown.out.split()))
    assert "detection" in shown.out
    shown = cdia("monitor", folder / "run.csv", *ROBOT, *BANK, "--no-check", "--healthy-until", "6")
    assert "the first 6 s are taken as healthy" in " ".join(shown.out.split())


def test_positions_alone_will_do(cdia, folder):
    robot = load_robot("double_pendulum")
    log = read_log(folder / "run.csv", robot)
    write_log(Log(log.joints, log.time, log.position, log.effort), folder / "blind.csv")
    arguments = ("monitor", folder / "blind.csv", *ROBOT, *BANK, "--no-check")
    assert cdia(*arguments, "--json", "-").json["events"][0]["joints"] == ["joint2"]
    mixed = cdia(*arguments, "--healthy", folder / "healthy.csv")
    assert "not all logs have velocities" in " ".join(mixed.out.split())
    assert "velocities" in cdia(*arguments, "--engine", "thesis").error


def test_the_engine_of_the_thesis_runs_too(cdia, folder):
    arguments = ("monitor", folder / "run.csv", *ROBOT, *BANK, "--no-check", "--engine", "thesis")
    found = cdia(*arguments, "--json", "-").json
    assert found["record"]["engine"] == "thesis"
    assert found["events"][0]["time"] == pytest.approx(7.1, abs=0.2)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--engine", "momentm"], "did you mean momentum"),
        (["--bank", "columb_friction"], "did you mean coulomb_friction"),
        (["--bank", "payload"], "not an effect of one joint"),
        (["--threshold", "joint1"], "JOINT=VALUE"),
        (["--threshold", "joint1=much"], "JOINT=VALUE"),
        (["--threshold", "joint1=0.1"], "no value for joint joint2"),
        (["--threshold", "jiont1=0.1"], "did you mean joint1"),
        (["--healthy-until", "100"], "cannot be split at 100 s"),
        (["--healthy-until", "0"], "'--healthy-until': must be 0.01 to 100000 s"),
        (["--healthy-until", "1"], "too short to learn from"),
        (["--healthy-until", "5", "--threshold", "joint1=1,joint2=1"], "leave out --healthy"),
        (["--healthy", "nowhere.csv"], "nowhere.csv"),
        (["--json", "/nowhere/x.json"], "no directory /nowhere"),
    ],
)
def test_bad_settings_are_one_line(cdia, folder, arguments, said):
    assert said in cdia("monitor", folder / "run.csv", *ROBOT, "--no-check", *arguments).error


def test_healthy_runs_of_another_rate_are_resampled(cdia, folder):
    log = read_log(folder / "run.csv", load_robot("double_pendulum"))
    slow = Log(log.joints, log.time[::2], log.position[::2], log.effort[::2], log.velocity[::2])
    write_log(slow, folder / "slow.csv")
    arguments = (
        "monitor",
        folder / "slow.csv",
        *ROBOT,
        *BANK,
        "--no-check",
        "--healthy",
        folder / "healthy.csv",
    )
    told = cdia(*arguments)
    assert "healthy.csv: thinned from 250 Hz to 125 Hz" in " ".join(told.out.split())
    found = cdia(*arguments, "--json", "-").json
    assert found["events"][0]["time"] == pytest.approx(7.0, abs=0.2)
    assert found["record"]["rate"] == pytest.approx(125.0)


def test_what_it_can_see_is_in_the_document(watched):
    sight = json.loads(watched[1]["found.json"].read_text(encoding="utf-8"))["record"]["sight"]
    assert list(sight) == ["joint1", "joint2"]
    for joint in sight.values():
        assert joint["share"] == pytest.approx(joint["threshold"] / joint["torque_rms"])
        assert joint["blind"] == (joint["share"] > 0.3)
    assert "of torque" in watched[0]


def test_a_log_must_not_be_overwritten(cdia, folder):
    said = cdia("monitor", folder / "run.csv", *ROBOT, "--json", folder / "run.csv").error
    assert "read from" in said


# ------------------------------------------------------------- one monitor over several logs


@pytest.fixture(scope="module")
def parts(folder):
    """``first.csv`` and ``second.csv``: the run with the fault, cut after it was isolated."""
    log = read_log(folder / "run.csv", load_robot("double_pendulum"))
    cut = int(np.searchsorted(log.time, 9.0))
    names = folder / "first.csv", folder / "second.csv"
    for name, piece in zip(names, (log.slice(0, cut), log.slice(cut, len(log.time))), strict=True):
        write_log(piece, name)
    return names


def test_a_monitor_goes_on_with_the_next_log(cdia, folder, watched, parts):
    state, learned = folder / "monitor.npz", ("--healthy", folder / "healthy.csv", *BANK)
    common = (*ROBOT, "--no-check", "--state", state, "--json", "-")
    first = cdia("monitor", parts[0], *learned, *common).json
    second = cdia("monitor", parts[1], *common).json
    assert "the stored monitor does not keep them" in second["not_compared"]
    whole = json.loads(watched[1]["found.json"].read_text(encoding="utf-8"))
    assert first["events"] + second["events"] == whole["events"]
    assert second["faults"] == whole["faults"]
    assert second["record"]["healthy"] == first["record"]["healthy"]


def test_what_a_state_holds_is_not_given_again(cdia, folder, parts):
    state = folder / "again.npz"
    state.write_bytes(b"")
    shown = cdia("monitor", parts[1], *ROBOT, "--state", state, "--threshold", "joint1=1,joint2=1", *BANK)
    assert shown.code != 0
    assert "leave out --threshold, --bank" in shown.err
    broken = cdia("monitor", parts[1], *ROBOT, "--state", state)
    assert broken.code != 0
    assert "not a whole monitor" in broken.err
