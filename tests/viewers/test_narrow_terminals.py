"""However narrow the terminal is, a table loses no character of its names and numbers."""

import io
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rich.console import Console

from cdia_pin.cli import main
from cdia_pin.discovery import compare
from cdia_pin.dynamics import Dynamics
from cdia_pin.resources import robots_dir
from cdia_pin.robot import load_robot
from cdia_pin.viewers import check_table, comparison_table, discovery_table, where_it_fails
from cdia_pin.viewers.cells import add_row, new_table
from cdia_pin.viewers.text_changes import errors_by_log
from cdia_pin.viewers.text_identification import identification_table
from cdia_pin.viewers.whole_words import WholeWords
from tests.narrow_terminals import NARROW, WIDE, characters, loses_nothing

NAME = "left_arm_shoulder_flexion_and_extension_{}_joint"


TEXTS = st.text(st.sampled_from("ab_+@9.,−% \N{NO-BREAK SPACE}\n关"), min_size=1, max_size=50)


@given(
    rows=st.lists(st.lists(TEXTS, min_size=4, max_size=4), min_size=1, max_size=3), width=st.integers(24, 90)
)
@settings(max_examples=60, deadline=None)
def test_any_table_loses_nothing_at_any_width(rows, width):
    table = new_table("joint", "what acts in it", "torque RMS", "error", left=(0, 1))
    for row in rows:
        add_row(table, *row)
    console = Console(file=io.StringIO(), width=width, color_system=None)
    console.print(table)
    given = Counter(c for row in rows for text in row for c in text if not c.isspace())
    assert not given - Counter(console.file.getvalue())


@given(TEXTS, st.integers(2, 30))
@settings(max_examples=100, deadline=None)
def test_a_line_breaks_at_ordinary_spaces_or_inside_words_that_are_too_long(text, width):
    lines = [line.plain for line in WholeWords(text).wrap(Console(width=80), width)]
    assert "".join("".join(lines).split()) == "".join(text.split())
    assert all(WholeWords(line).widest <= max(width, 2) for line in lines)


def test_a_wide_character_goes_into_the_narrowest_column():
    assert [str(x) for x in WholeWords("关a").wrap(Console(), 1)] == ["关", "a"]


def test_a_number_keeps_its_unit():
    assert [str(x) for x in WholeWords("load 0.25\N{NO-BREAK SPACE}%").wrap(Console(), 10)] == [
        "load",
        "0.25 %",
    ]


@pytest.fixture(scope="module")
def long(results, tmp_path_factory):
    """The comparison with long names and large numbers, and the discovery."""
    text = (robots_dir() / "scara.urdf").read_text()
    for joint in results.robot.joints:
        text = text.replace(f'"{joint}"', f'"{NAME.format(joint)}"')
    path = tmp_path_factory.mktemp("long") / "arm.urdf"
    path.write_text(text)
    robot = load_robot(path)
    logs = [replace(log, joints=robot.joints) for log in results.logs]
    seen = compare(Dynamics(robot), logs[:1])
    large = replace(
        seen, rms=1.2345e8 * seen.rms, torque_rms=9.8765e8 * seen.torque_rms, bias=-1e7 * seen.bias
    )
    found = replace(
        results.discovery, model=Dynamics(robot), trace=results.discovery.trace[:1], structure_left=()
    )
    return large, found


@pytest.mark.parametrize("table", [comparison_table, where_it_fails, lambda c: errors_by_log([c, c])])
def test_comparisons_lose_nothing(table, long):
    loses_nothing(table(long[0]))


@pytest.mark.parametrize("everything", [False, True])
def test_discoveries_lose_nothing(everything, long, doubtful, results):
    for found in (long[1], doubtful, results.discovery):
        loses_nothing(discovery_table(found, everything))


def test_checks_lose_nothing(results):
    loses_nothing(check_table(results.checks[0]))


def test_an_identification_loses_nothing(results):
    from cdia_pin import identification

    found = identification.identify(Dynamics(results.robot), list(results.logs))
    loses_nothing(identification_table(found, everything=True))
    # of the first joint no sample counts in the held-out data: it has no error, and no part in the mean
    unseen = {k: getattr(found, k).copy() for k in ("heldout_torque_rms", "heldout_before", "heldout_after")}
    for x in unseen.values():
        x[0] = 0.0
    console = Console(file=io.StringIO(), width=WIDE)
    console.print(identification_table(replace(found, **unseen)))
    rows = [line.split() for line in console.file.getvalue().splitlines()]
    assert [row[0] for row in rows if row[-2:] == ["–", "–"]] == [results.robot.joints[0]]


@pytest.mark.parametrize("command", [["robots"], ["robots", "ur5"], ["effects"], ["effects", "link_inertia"]])
def test_lists_lose_nothing(command, capsys, monkeypatch):
    said = {}
    for width in (WIDE, *NARROW):
        monkeypatch.setenv("COLUMNS", str(width))
        assert main(command) == 0
        said[width] = characters(capsys.readouterr().out)
    for width in NARROW:
        assert not said[WIDE] - said[width]


def test_a_pipe_gets_what_a_terminal_gets(capsys, monkeypatch):
    monkeypatch.delenv("COLUMNS", raising=False)
    assert main(["robots", "panda"]) == 0
    joints = load_robot("panda").joints
    text = capsys.readouterr().out
    assert all(joint in text for joint in joints) and "…" not in text
    assert np.all([len(line) <= 80 for line in text.splitlines() if "/" not in line])
