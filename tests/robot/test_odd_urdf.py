"""URDF files that are no arm are refused with what is wrong, however large or odd they are."""

import time

import pytest

from cdia_pin import load_robot
from cdia_pin.errors import RobotError
from cdia_pin.robot.collision import CollisionModel
from cdia_pin.viewers.scene.visuals import visuals_of

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


def one_joint(of_link: str = "", of_joint: str = "", of_file: str = "", **limits: str) -> list[str]:
    given = {"lower": "-3", "upper": "3", "effort": "10", "velocity": "3", **limits}
    limit = "<limit " + " ".join(f'{key}="{text}"' for key, text in given.items()) + "/>"
    plain = joint("j", "a", "b")
    whole = plain.replace(plain[plain.index("<limit") : plain.index("</joint>")], limit + of_joint)
    return [of_file, link("a"), link("b").replace("</link>", f"{of_link}</link>"), whole]


@pytest.mark.parametrize(
    "text", ["inf", "-inf", "nan", "1e400", "ten", "", "1_0", "0x10", "1 2", "1,5", "1e13"]
)
@pytest.mark.parametrize("key", ["lower", "upper", "effort", "velocity", "damping", "friction"])
def test_a_number_of_a_joint_that_makes_no_sense_is_named(tmp_path, capfd, key, text):
    dynamics = f'<dynamics {key}="{text}"/>'
    parts = one_joint(of_joint=dynamics) if key in {"damping", "friction"} else one_joint(**{key: text})
    with pytest.raises(RobotError, match=f"joint 'j': the {key}.* must be .*given '{text}'") as refused:
        loaded(tmp_path, *parts)
    assert "\n" not in str(refused.value)
    assert capfd.readouterr() == ("", "")  # the parser writes to the terminal by itself


@pytest.mark.parametrize(
    ("parts", "said"),
    [
        (one_joint(effort="-5"), "'j': the effort limit must be 0 or more, given '-5'"),
        (one_joint(velocity="-5"), "'j': the velocity limit must be 0 or more, given '-5'"),
        (one_joint(of_joint='<dynamics friction="-5"/>'), "'j': the friction must be 0 or more, given '-5'"),
        (one_joint(of_file=link("a")), "two links are named 'a'"),
        (one_joint(of_file=joint("j", "a", "b")), "two joints are named 'j'"),
        (
            [part.replace('effort="10"', "") for part in one_joint()],
            "joint 'j': the effort limit is missing, it must be a number",
        ),
        (
            [part.replace('izz="0.1"', 'izz="inf"') for part in one_joint()],
            "link 'a': izz must be finite, given 'inf'",
        ),
    ],
)
def test_what_the_parser_refuses_without_a_name_is_named(tmp_path, parts, said):
    with pytest.raises(RobotError, match=said):
        loaded(tmp_path, *parts)


ODD = ["inf", "nan", "abc", "", "1 2 3 4"]
SHAPES = ['<box size="{}"/>', '<sphere radius="{}"/>', '<mesh filename="a.stl" scale="{}"/>', "<cone/>"]
UNUSED = [
    *({"of_link": f"<visual><geometry>{shape}</geometry></visual>"} for shape in ["", *SHAPES]),
    *({"of_link": f"<collision><geometry>{shape}</geometry></collision>"} for shape in ["", *SHAPES]),
    {"of_joint": '<calibration rising="{}"/>'},
    {"of_joint": '<safety_controller k_velocity="{}"/>'},
    {"of_joint": "<dynamics/>"},
    {"of_file": 2 * '<material name="m"><color rgba="{} 0 0 1"/></material>'},
    {
        "of_file": '<joint name="k" type="fixed"><parent link="b"/><child link="c"/><limit effort="{}"/></joint>'
    },
    {"upper": "3 ", "effort": " 10 "},
]


@pytest.mark.parametrize("text", ODD)
@pytest.mark.parametrize("odd", UNUSED)
def test_what_is_in_no_equation_of_motion_spoils_nothing(tmp_path, capfd, odd, text):
    parts = one_joint(**{key: given.replace("{}", text) for key, given in odd.items()})
    arm = loaded(tmp_path, *parts, *([link("c")] if "of_file" in odd and "joint" in odd["of_file"] else []))
    assert arm.limits.effort == [10.0] and arm.limits.upper == [3.0]
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("text", ODD)
@pytest.mark.parametrize("shape", SHAPES)
def test_a_shape_that_cannot_be_read_is_named_where_contacts_are_looked_for(tmp_path, shape, text):
    collision = f"<collision><geometry>{shape.format(text)}</geometry></collision>"
    arm = loaded(tmp_path, *one_joint(of_link=collision))
    with pytest.raises(RobotError, match=r"odd\.urdf: link 'b': its collision shape: "):
        CollisionModel(arm)


@pytest.mark.parametrize("text", ODD)
@pytest.mark.parametrize("shape", SHAPES)
def test_a_shape_that_cannot_be_read_is_left_out_of_the_picture(tmp_path, shape, text):
    good = '<visual><geometry><box size="1 1 1"/></geometry></visual>'
    odd = f"<visual><geometry>{shape.format(text)}</geometry></visual>"
    arm = loaded(tmp_path, *one_joint(of_link=odd + good))
    assert [visual.kind for visual in visuals_of(arm)] == ["box"]
