"""An interrupted search is not lost: the same command goes on from what it had found."""

import json
from functools import partial

import pytest

from cdia_pin import Dynamics, load_model, load_robot, write_log
from cdia_pin.campaigns import arm_study
from cdia_pin.campaigns.closed_loop import LoopSettings
from cdia_pin.discovery import discover
from cdia_pin.selection import search as searching
from tests.cli.conftest import HIDDEN, pendulum_log

ROBOT = ("--robot", "double_pendulum")
HIDDEN_TOO = "viscous_friction@joint1: coefficient=0.08"


@pytest.fixture(scope="module")
def two(tmp_path_factory):
    """A log with two hidden effects."""
    file = tmp_path_factory.mktemp("two") / "two.csv"
    write_log(pendulum_log(5, HIDDEN, HIDDEN_TOO), file)
    return file


def effects(path) -> list[tuple[str, list[str]]]:
    return [(t["effect"], t["joints"]) for t in json.loads(path.read_text())["terms"]]


def interrupted_after(monkeypatch, moves: int) -> None:
    """Press Ctrl-C in the search after some accepted moves."""
    fitted, calls = searching.fitted, [0]

    def counting(problem, model):
        calls[0] += 1
        if calls[0] > moves + 1:
            raise KeyboardInterrupt
        return fitted(problem, model)

    monkeypatch.setattr(searching, "fitted", counting)


def test_what_was_found_is_kept_and_the_same_command_goes_on(cdia, two, tmp_path, monkeypatch):
    whole, save = tmp_path / "whole.json", tmp_path / "model.json"
    assert cdia("discover", two, *ROBOT, "--save", whole).code == 0
    assert not (tmp_path / "whole.json.unfinished").exists()
    with monkeypatch.context() as patch:
        interrupted_after(patch, 1)
        done = cdia("discover", two, *ROBOT, "--save", save)
    unfinished = tmp_path / "model.json.unfinished"
    assert done.code == 130 and str(unfinished) in done.err and not save.exists()
    assert effects(unfinished)
    again = cdia("discover", two, *ROBOT, "--save", save)
    assert again.code == 0 and "going on from" in again.err
    assert effects(save) == effects(whole)
    assert not unfinished.exists()


def test_another_command_does_not_go_on_from_there(cdia, two, log, tmp_path, monkeypatch):
    save = tmp_path / "model.json"
    with monkeypatch.context() as patch:
        interrupted_after(patch, 1)
        assert cdia("discover", two, *ROBOT, "--save", save).code == 130
    assert "going on" not in cdia("discover", log, *ROBOT, "--save", save).err
    (tmp_path / "model.json.unfinished").write_text("{")
    assert cdia("discover", two, *ROBOT, "--save", save).code == 0


def test_without_a_file_nothing_is_kept(cdia, two, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    interrupted_after(monkeypatch, 1)
    assert cdia("discover", two, *ROBOT).code == 130
    assert not list(tmp_path.iterdir())


def test_each_better_model_is_kept():
    model, kept = Dynamics(load_robot("double_pendulum")), []
    found = discover(model, pendulum_log(5, HIDDEN, HIDDEN_TOO), keep=kept.append)
    assert kept and len(kept[-1].terms) >= len(found.model.terms)


def test_an_interrupted_identification_is_not_lost_either(cdia, two, tmp_path, monkeypatch):
    from cdia_pin.identification import estimate, refinement

    whole, save = tmp_path / "whole.json", tmp_path / "model.json"
    assert cdia("identify", two, *ROBOT, "--save", whole).code == 0
    assert not (tmp_path / "whole.json.unfinished").exists()

    def pressed(*_):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(refinement, "_best_of_each_joint", pressed)
        done = cdia("identify", two, *ROBOT, "--save", save)
    unfinished = tmp_path / "model.json.unfinished"
    assert done.code == 130 and str(unfinished) in done.err and not save.exists()
    kept = load_model(unfinished, load_robot("double_pendulum"))
    begun, fit = [], estimate.Fitter.fit

    def noted(fitter, model, *rest):
        begun.append(model)
        return fit(fitter, model, *rest)

    monkeypatch.setattr(estimate.Fitter, "fit", noted)
    again = cdia("identify", two, *ROBOT, "--save", save)
    assert again.code == 0 and "going on from" in again.err
    assert [t.theta for t in begun[0].terms] == [t.theta for t in kept.terms]
    assert effects(save) == effects(whole)
    assert not unfinished.exists()


def interrupted_study(monkeypatch, finished: int) -> list[str]:
    """Let the study have two short cases, and press Ctrl-C in the case after some; return what is run."""
    compare, begun = arm_study.compare_loops, []

    def counting(loop, monitor, faults, *rest, **more):
        begun.append(faults[0].label)
        if len(begun) > finished:
            raise KeyboardInterrupt
        return compare(loop, monitor, faults, *rest, **more)

    monkeypatch.setattr(arm_study, "compare_loops", counting)
    return begun


@pytest.fixture
def short_study(monkeypatch):
    pytest.importorskip("matplotlib")
    monkeypatch.setattr("cdia_pin.viewers.study_figures.DPI", 30)
    settings = LoopSettings(rate=250.0, healthy_runs=1, healthy_duration=8.0)
    cases = ["30 % torque loss", "Coulomb friction"]
    small = partial(arm_study.arm_study, ["double_pendulum"], settings=settings, duration=6.0, cases=cases)
    monkeypatch.setattr(arm_study, "arm_study", small)


def test_an_interrupted_study_runs_only_what_was_not_finished(cdia, short_study, tmp_path, monkeypatch):
    whole, out = tmp_path / "whole", tmp_path / "out"
    done = cdia("study", "arms", "--out", whole, "--json", tmp_path / "whole.json")
    assert done.code == 0 and "going on" not in done.err
    command = ("study", "arms", "--out", out, "--json", tmp_path / "out.json")
    unfinished = out / "arm_study.html.unfinished"
    with monkeypatch.context() as patch:
        interrupted_study(patch, 1)
        first = cdia(*command)
    assert first.code == 130 and str(unfinished) in first.err
    assert [p.name for p in out.iterdir()] == [unfinished.name]
    begun = interrupted_study(monkeypatch, 1)
    again = cdia(*command)
    assert again.code == 0 and "going on from" in again.err
    assert begun == ["coulomb_friction@joint1"]
    assert again.out.replace(str(out), str(whole)) == done.out
    assert (tmp_path / "out.json").read_text() == (tmp_path / "whole.json").read_text()
    assert {p.name: p.read_bytes() for p in out.glob("*.png")} == {
        p.name: p.read_bytes() for p in whole.glob("*.png")
    }
    assert sorted(p.name for p in out.iterdir()) == sorted(p.name for p in whole.iterdir())


@pytest.mark.parametrize("left", ["{", '{"study": "of another command", "cases": []}', "[1]"])
def test_a_study_begins_anew_where_what_was_left_is_of_no_use(cdia, short_study, tmp_path, monkeypatch, left):
    (tmp_path / "arm_study.html.unfinished").write_text(left)
    begun = interrupted_study(monkeypatch, 0)
    again = cdia("study", "arms", "--out", tmp_path)
    assert again.code == 130 and "going on" not in again.err and len(begun) == 1
