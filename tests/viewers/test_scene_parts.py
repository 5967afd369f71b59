"""What an arm looks like: shapes where its file puts them, capsules where there are none, and joints that move."""

import base64
import json

import numpy as np
import pinocchio as pin
import pytest

from cdia_pin import CdiaError, load_robot
from cdia_pin.robot import catalogue
from cdia_pin.robot.urdf import read_urdf
from cdia_pin.robot.urdf_edit import text_of
from cdia_pin.robot.urdf_values import welded
from cdia_pin.viewers.scene import Scene
from cdia_pin.viewers.scene.bodies import bodies_of
from cdia_pin.viewers.scene.chain import chain_of
from cdia_pin.viewers.scene.meshes import Mesh, shares, simplified

LARGEST = 2_000_000  # characters of JSON
UPRIGHT = "icub_left_arm"  # all its files call y up, and mean it; Pinocchio's reader passes over that

PENDULUM = """<robot name="bare">
  <link name="base"/>
  <link name="arm">{visual}<inertial><mass value="1"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="tip"><inertial><mass value="1"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0 0 0.3"/>
    <axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="50" velocity="2"/></joint>
  <joint name="slide" type="prismatic"><parent link="arm"/><child link="tip"/><origin xyz="0.4 0 0"/>
    <axis xyz="1 0 0"/><limit lower="0" upper="0.3" effort="50" velocity="2"/></joint>
</robot>"""


def written(tmp_path, visual=""):
    path = tmp_path / "bare.urdf"
    path.write_text(PENDULUM.format(visual=visual), encoding="utf-8")
    return load_robot(path)


def boxes(meshes, names):
    """Lower and upper corner of what each joint moves, None where nothing is to be seen."""
    out = {}
    for name in names:
        points = [m.mesh.vertices for m in meshes if m.joint == name]
        out[name] = (np.vstack(points).min(axis=0), np.vstack(points).max(axis=0)) if points else None
    return out


def pinocchio_boxes(robot):
    """The same as Pinocchio reads the robot's file, through another reader of meshes."""
    held = {name: joint.position for name, joint in robot.locked.items()}
    xml = text_of(welded(read_urdf(robot.urdf).tree, held))
    model = pin.buildModelFromXML(xml)
    shapes = pin.buildGeomFromUrdfString(model, xml, pin.VISUAL, None, [str(p) for p in robot.package_dirs])
    corners = {}
    for shape in shapes.geometryObjects:
        shape.geometry.computeLocalAABB()
        box = shape.geometry.aabb_local
        vertices = getattr(shape.geometry, "vertices", None)
        if vertices is None:
            ends = np.array([box.min_, box.max_])
            points = np.array(np.meshgrid(*ends.T)).reshape(3, -1).T
        else:
            points = np.array(vertices())
        joint = None if shape.parentJoint == 0 else model.names[shape.parentJoint]
        moved = points @ shape.placement.rotation.T + shape.placement.translation
        corners.setdefault(joint, []).append(moved)
    found = {j: np.vstack(p) for j, p in corners.items()}
    return {j: (p.min(axis=0), p.max(axis=0)) for j, p in found.items()}


@pytest.fixture(
    scope="module",
    params=sorted(name for name, entry in catalogue().items() if entry.source != "robot_descriptions"),
)
def arm(request):
    return load_robot(request.param)


def test_every_arm_of_the_catalogue_is_drawn(arm):
    scene = Scene.of(arm)
    assert not scene.notes
    text = json.dumps(scene.to_dict())
    assert 10_000 < len(text) < LARGEST
    seen = {m.joint for m in scene.meshes}
    assert len(seen - {None}) >= min(arm.n, 2)
    for mesh, coarse in zip(scene.meshes, scene.coarse, strict=True):
        for one in (mesh.mesh, coarse.mesh):
            assert np.isfinite(one.vertices).all()
            assert one.triangles.max() < len(one.vertices)
    fine, plain = (sum(len(m.mesh.triangles) for m in meshes) for meshes in (scene.meshes, scene.coarse))
    assert plain < 30_000
    assert fine < 90_000


def test_shapes_are_where_pinocchio_has_them(arm):
    if arm.name == UPRIGHT:
        pytest.skip("its meshes are turned upright, which Pinocchio's reader does not do")
    meshes, _ = bodies_of(arm, chain_of(arm))
    ours = boxes(meshes, (None, *arm.joints))
    theirs = pinocchio_boxes(arm)
    for joint, (low, high) in theirs.items():
        assert ours[joint] is not None, joint
        np.testing.assert_allclose(ours[joint][0], low, atol=2e-3)
        np.testing.assert_allclose(ours[joint][1], high, atol=2e-3)


def test_the_joints_move_as_pinocchio_moves_them(arm):
    q = np.random.default_rng(3).uniform(-1, 1, arm.n)
    pose = np.eye(4)
    for joint, value, true in zip(chain_of(arm), q, arm.joint_placements(q), strict=True):
        motion = np.eye(4)
        if joint.prismatic:
            motion[:3, 3] = joint.axis * value
        else:
            motion[:3, :3] = pin.exp3(joint.axis * value)
        pose = pose @ joint.placement @ motion
        np.testing.assert_allclose(pose, true, atol=1e-12)


def test_meshes_that_are_meant_upright_are_turned():
    robot = load_robot(UPRIGHT)
    meshes, _ = bodies_of(robot, chain_of(robot))
    low, high = boxes(meshes, [None])[None]
    assert (high - low)[2] > 2 * (high - low)[1]  # a standing body, not a lying one


def test_the_same_arm_gives_the_same_text():
    first, second = (json.dumps(Scene.of(load_robot("scara")).to_dict()) for _ in range(2))
    assert first == second


def test_a_slide_differs_from_a_turn():
    joints = {j["name"]: j for j in Scene.of(load_robot("scara")).to_dict()["joints"]}
    assert [j["kind"] for j in joints.values()] == ["revolute", "revolute", "revolute", "prismatic"]
    assert {j["unit"] for j in joints.values()} == {"N·m", "N"}


def test_positions_survive_the_packing():
    scene = Scene.of(load_robot("ur5"))
    for mesh, given in zip(scene.meshes, scene.to_dict()["meshes"], strict=True):
        steps = np.frombuffer(base64.b64decode(given["vertices"]), "<u2").reshape(-1, 3)
        low, high = np.array(given["low"]), np.array(given["high"])
        np.testing.assert_allclose(low + steps / 65535 * (high - low), mesh.mesh.vertices, atol=2e-5)
        kind = "<u4" if given["wide"] else "<u2"
        triangles = np.frombuffer(base64.b64decode(given["triangles"]), kind).reshape(-1, 3)
        np.testing.assert_array_equal(triangles, mesh.mesh.triangles)


def test_an_arm_without_shapes_is_drawn_as_capsules(tmp_path):
    scene = Scene.of(written(tmp_path))
    assert "capsules" in " ".join(scene.notes)
    assert {m.joint for m in scene.meshes} == {None, "shoulder", "slide"}
    low, high = boxes(scene.meshes, ["shoulder"])["shoulder"]
    assert high[0] > 0.4 > low[0]  # as far as the next joint


def test_a_missing_mesh_is_noted_and_its_link_drawn(tmp_path):
    visual = '<visual><geometry><mesh filename="package://nowhere/arm.stl"/></geometry></visual>'
    scene = Scene.of(written(tmp_path, visual))
    said = " ".join(scene.notes)
    assert "package://nowhere/arm.stl" in said
    assert "arm" in said
    assert "shoulder" in {m.joint for m in scene.meshes}


def test_a_broken_mesh_is_noted(tmp_path):
    (tmp_path / "arm.stl").write_bytes(b"solid nothing at all")
    scene = Scene.of(written(tmp_path, '<visual><geometry><mesh filename="arm.stl"/></geometry></visual>'))
    assert any("arm.stl" in note for note in scene.notes) or "shoulder" in {m.joint for m in scene.meshes}
    assert scene.meshes


def test_the_colour_of_the_file_is_kept(tmp_path):
    visual = (
        '<visual><geometry><box size="0.1 0.1 0.1"/></geometry>'
        '<material name="m"><color rgba="1 0.5 0 1"/></material></visual>'
    )
    scene = Scene.of(written(tmp_path, visual))
    colours = {m["joint"]: m["colour"] for m in scene.to_dict()["meshes"] if m["joint"] == "shoulder"}
    assert colours == {"shoulder": "#ff8000"}


def test_locked_fingers_stay_with_the_hand():
    robot = load_robot("panda")
    scene = Scene.of(robot)
    assert {m.joint for m in scene.meshes if "finger" in m.link} == {"panda_joint7"}


@pytest.mark.parametrize("pose", [[0.0], [np.nan] * 4, "home", [[0.0] * 4]])
def test_a_wrong_pose_is_refused(pose):
    with pytest.raises(CdiaError, match="4 finite numbers"):
        Scene.of(load_robot("scara")).to_dict(pose)


def test_triangles_are_shared_out_by_size_and_none_gets_more_than_it_has():
    cube = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], float)
    small = Mesh(cube, np.zeros((100, 3), int), (0, 0, 0))
    large = Mesh(10 * cube, np.zeros((5000, 3), int), (0, 0, 0))
    given = list(shares([small, large], 2000))
    assert given[0] == 100
    assert given[1] == pytest.approx(1900, abs=2)


def test_a_simplified_mesh_keeps_its_shape():
    import trimesh

    ball = trimesh.creation.icosphere(subdivisions=6)
    few = simplified(Mesh(ball.vertices, ball.faces, (0, 0, 0)), 2000)
    assert len(few.triangles) < 2500
    np.testing.assert_allclose(np.linalg.norm(few.vertices, axis=1), 1.0, atol=0.02)
