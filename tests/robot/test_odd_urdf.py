"""URDF files that are no arm are refused with what is wrong, however large or odd they are."""

import time

import pytest

from cdia_pin import load_robot
from cdia_pin.errors import RobotError

INERTIA = '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/>'


def link(name: str, mass: object = 1) -> str:
    origin = '<origin xyz="0.1 0 0.1"/>'
    return f'<link name="{name}"><inertial><mass value="{mass}"/>{origin}{INERTIA}</inertial></link>'


def joint(name: str, parent: str, child: str) -> str:
    return (
        f'<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/>'
        '<axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="10" velocity="3"/></joint>'
    )


def loaded(folder, *parts: str):
    file = folder / "odd.urdf"
    file.write_text(f'<robot name="odd">{"".join(parts)}</robot>')
    return load_robot(file)


def chain(count: int) -> list[str]:
    return [
        *(link(f"l{k}") for k in range(count + 1)),
        *(joint(f"j{k}", f"l{k}", f"l{k + 1}") for k in range(count)),
    ]


@pytest.mark.parametrize(
    ("parts", "said"),
    [
        ([link("a"), link("b"), joint("j1", "a", "b"), joint("j2", "b", "a")], "without a parent"),
        ([link("a"), joint("j", "a", "a")], "without a parent"),
        ([link("a"), link("b"), link("c"), joint("j1", "a", "b")], "found a, c"),
        (
            [*map(link, "abcd"), joint("j1", "a", "b"), joint("j2", "c", "d"), joint("j3", "d", "c")],
            "j2, j3 carry each other in a circle",
        ),
        ([link("a"), link("b"), joint("j1", "a", "b"), joint("j2", "a", "b")], "more than one joint"),
        (chain(2000), "2000 joints"),
        ([link("a"), link("b", 1e308), joint("j", "a", "b")], "below 1e\\+12"),
        ([link("a"), link("b", "9" * 400), joint("j", "a", "b")], "finite"),
        ([link("a"), link("b", "nan"), joint("j", "a", "b")], "finite"),
    ],
)
def test_what_is_no_arm_is_refused(tmp_path, parts, said):
    start = time.monotonic()
    with pytest.raises(RobotError, match=said):
        loaded(tmp_path, *parts)
    assert time.monotonic() - start < 5.0


def test_a_long_chain_of_fixed_and_movable_joints_is_read(tmp_path):
    assert loaded(tmp_path, *chain(30)).n == 30


def test_names_may_hold_markup_and_newlines(tmp_path):
    arm = loaded(
        tmp_path, link("[b]a[/b]"), link("b&#10;c"), joint("[red]j[/x]&#10;1", "[b]a[/b]", "b&#10;c")
    )
    assert arm.n == 1
