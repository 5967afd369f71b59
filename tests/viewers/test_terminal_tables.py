"""Tables for the terminal: readable in 80 columns, and no name becomes markup."""

import io
from dataclasses import replace

import numpy as np
import pytest
from rich.console import Console

from cdia_pin.discovery import compare
from cdia_pin.dynamics import Dynamics
from cdia_pin.robot import load_robot
from cdia_pin.viewers import check_table, comparison_table, discovery_table, where_it_fails
from cdia_pin.viewers.short_answer import VERDICTS, short_answer
from cdia_pin.viewers.verdict import unseen_share
from cdia_pin.viewers.words import percent
from tests.viewers.conftest import measured

WIDTHS = (80, 100)


def printed(table, width=100):
    console = Console(file=io.StringIO(), width=width, color_system=None)
    console.print(table)
    text = console.file.getvalue()
    assert max(map(len, text.splitlines())) <= width
    return text


@pytest.mark.parametrize("width", WIDTHS)
def test_every_joint_has_its_error_and_unit(results, width):
    text = printed(comparison_table(results.given), width)
    assert all(joint in text for joint in results.robot.joints)
    assert "N·m" in text
    assert "mean" in text


@pytest.mark.parametrize("width", WIDTHS)
def test_regions_say_where(results, width):
    text = printed(where_it_fails(results.given, most=3), width)
    assert " in [" in text
    assert text.count("joint") == 3 + 1  # the head has the word as well


@pytest.mark.parametrize("width", WIDTHS)
def test_a_discovery_shows_steps_numbers_doubts_and_verdict(doubtful, width):
    text = " ".join(printed(discovery_table(doubtful), width).split())
    assert "model as given" in text
    assert "+ stribeck friction, joint3" in text
    assert "level 4.00 ± 0.10 N·m" in text
    assert "decay 8.00 s/rad" in text
    assert "noise floor" in text
    assert "hard to distinguish from coulomb friction on joint3" in text


@pytest.mark.parametrize("width", WIDTHS)
def test_no_line_of_the_short_answer_loses_a_word(doubtful, width):
    text = " ".join(printed(discovery_table(doubtful, everything=False), width).split())
    for head, said in short_answer(doubtful):
        assert head in text
        assert all(word in text for word in said.split())


def test_effects_of_a_real_discovery_are_listed(results):
    text = printed(discovery_table(results.discovery))
    for step in results.discovery.steps:
        assert step.term.effect.equation in text


@pytest.mark.parametrize("width", WIDTHS)
def test_seven_joints_fit_in_the_width(results, width):
    panda = load_robot("panda")
    pad = lambda x: [*x, *x][: panda.n]  # noqa: E731
    first, able = results.discovery.trace[0], results.discovery.capability
    able = replace(able, friction=np.array(pad(able.friction)))
    wide = replace(
        results.discovery,
        model=Dynamics(panda),
        trace=(replace(first, rms=np.array(pad(first.rms)), heldout_rms=np.array(pad(first.rms))),),
        noise_floor=np.array(pad(results.discovery.noise_floor)),
        torque_rms=np.array(pad(results.discovery.torque_rms)),
        heldout_torque_rms=np.array(pad(results.discovery.heldout_torque_rms)),
        compared_share=np.full(panda.n, 0.4),
        structure_left=panda.joints,
        capability=able,
        verdict="unexplained",
    )
    for everything in (False, True):
        text = printed(discovery_table(wide, everything), width)
        assert all(f"joint{k}" in text for k in range(1, 8))
        assert "…" not in text


@pytest.mark.parametrize("everything", [False, True])
def test_a_joint_that_is_judged_for_a_part_of_the_time_says_so(results, everything):
    n, said = results.robot.n, "judged, % of the time"
    some = replace(results.discovery, compared_share=np.array([0.16, *[0.95] * (n - 1)]))
    most = replace(results.discovery, compared_share=np.full(n, 0.85))
    (line,) = (x for x in printed(discovery_table(some, everything)).splitlines() if said in x)
    assert line.replace(said, "").split() == ["16", *["95"] * (n - 1)]
    assert said not in printed(discovery_table(most, everything))


@pytest.mark.parametrize("width", WIDTHS)
def test_findings_are_listed_problems_first(results, width):
    (check,) = results.checks
    text = printed(check_table(check), width)
    marks = [line.split()[1] for line in text.splitlines() if line.strip()[:1] in set("✓·!✗")]
    assert sorted(marks, key=["error", "warning", "info", "ok"].index) == marks
    assert len(marks) == len(check.findings)


def test_names_are_never_markup(hostile):
    joint = hostile.robot.joints[1]
    assert joint.startswith("[red]")
    assert "[red]j2" in printed(comparison_table(hostile.given), 160)
    assert "[red]j2" in printed(discovery_table(hostile.discovery), 160)


def test_the_error_on_a_held_out_log_is_a_share_of_its_own_torque(results):
    """As `compare` of that log says it, though the log that was fitted has another torque."""
    found = results.discovery
    unseen = measured(results.robot, 3, "held out")
    given, improved = (compare(m, unseen).mean_error for m in (Dynamics(results.robot), found.model))
    assert not np.allclose(found.torque_rms, found.heldout_torque_rms, rtol=0.02)
    assert dict(short_answer(found))[VERDICTS[found.verdict]] == (
        f"error {percent(given)} of the torque, now {percent(improved)}"
    )
    assert unseen_share(found.trace[-1].heldout_rms, found) == pytest.approx(improved, rel=0.02)
    share = found.trace[-1].heldout_rms / found.heldout_torque_rms  # by which the verdict is decided too
    np.testing.assert_allclose(found.capability.feedforward_error, share)
