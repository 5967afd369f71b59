"""The picture of an arm in a browser: joints where Pinocchio has them, colours that are true, a player that obeys."""

from dataclasses import replace

import numpy as np
import pytest

from cdia_pin import load_robot
from cdia_pin.effects import ExternalWrench, Payload, Term
from cdia_pin.viewers.arm_page import ArmPage
from cdia_pin.viewers.scene import Scene, Timeline, Track, monitor_stages
from cdia_pin.viewers.scene.attached import AttachedWords

DETECTED, ACCOMMODATED = "#d55e00", "#0072b2"
NAMES = [s.name for s in monitor_stages()]


def settled(page, ask, wanted, seconds=10.0):
    """Ask the page until it answers what is wanted."""
    for _ in range(int(seconds * 10)):
        answer = page.evaluate(ask)
        if wanted(answer):
            return answer
        page.wait_for_timeout(100)
    raise AssertionError(f"{ask}: still {answer}")


def opened(page, tmp_path, shown):
    page.goto(shown.save(tmp_path / "arm.html").as_uri())
    assert page.evaluate("() => Boolean(globalThis.arm)"), page.seen.errors
    return page


def motion(robot, faulty, frames=241, duration=8.0):
    """A motion with a fault at a joint from 3 s on, accommodated from 5 s on."""
    time = np.linspace(0.0, duration, frames)
    middle = np.resize([0.3, -1.15, 1.35, -0.6, 1.2, 0.0], robot.n)
    position = middle + 0.3 * np.sin(time[:, None] + np.arange(robot.n))
    stage = np.zeros((frames, robot.n), int)
    stage[time >= 3, faulty] = NAMES.index("detected")
    stage[time >= 5, faulty] = NAMES.index("accommodated")
    level = np.where(stage > 0, 1.5, 0.05)
    torque = np.where(stage > 0, -4.2, 0.0)
    label = ((3.0, "elbow: fault not isolated yet"), (5.0, "coulomb friction: level 4.2 N·m"))
    track = Track("", stage, level, torque, label)
    return Timeline(time, position, monitor_stages(), (track,), desired=position + 0.12)


@pytest.fixture(scope="module")
def ur5():
    robot = load_robot("ur5")
    return robot, Scene.of(robot), motion(robot, 2)


@pytest.fixture
def player(page, tmp_path, ur5):
    _, scene, timeline = ur5
    return opened(page, tmp_path, ArmPage(scene, timeline))


@pytest.mark.parametrize("name", ["ur5", "panda", "scara"])
def test_joints_are_where_pinocchio_has_them(page, tmp_path, name):
    robot = load_robot(name)
    opened(page, tmp_path, ArmPage(Scene.of(robot)))
    settled(page, "() => arm.frames", bool)  # drawing moves what is around the arm
    rng = np.random.default_rng(1)
    for _ in range(5):
        q = rng.uniform(-1.5, 1.5, robot.n)
        state = page.evaluate("(q) => { arm.pose(q); return arm.state(); }", q.tolist())
        ours = np.array([state["joints"][j]["world"] for j in robot.joints])
        np.testing.assert_allclose(ours, robot.joint_placements(q), atol=1e-6)
    assert page.seen.errors == []
    assert [u for u in page.seen.requests if not u.startswith("file://")] == []


def test_a_link_takes_the_colour_of_its_stage(player):
    ask = "(t) => { player.seek(t); return arm.state(); }"
    before, faulty, after = (player.evaluate(ask, t) for t in (1.0, 4.0, 7.0))
    assert near(faulty["joints"]["elbow_joint"]["colour"], DETECTED) < 40
    assert near(after["joints"]["elbow_joint"]["colour"], ACCOMMODATED) < 40
    assert near(before["joints"]["elbow_joint"]["colour"], DETECTED) > 100
    assert (
        before["joints"]["elbow_joint"]["intensity"]
        < 0.1
        < 0.9
        < faulty["joints"]["elbow_joint"]["intensity"]
    )
    wrists = [s["joints"]["wrist_1_joint"]["colour"] for s in (before, faulty, after)]
    assert len(set(wrists)) == 1


def test_the_pixels_have_that_colour(player, tmp_path):
    from PIL import Image

    player.evaluate("() => { player.seek(4.0); arm.pose(arm._shown.position, {desired: null}); }")
    player.wait_for_timeout(1500)
    image = tmp_path / "arm.png"
    player.screenshot(path=image)
    rgb = np.asarray(Image.open(image).convert("RGB")).astype(int)[80:700]
    red, green, blue = rgb[..., 0], rgb[..., 1], rgb[..., 2]
    vermilion = (red > 120) & (red > 1.6 * green) & (green > 1.5 * blue)
    assert vermilion.sum() > 3000


def test_label_arc_and_ghost(player):
    ask = "(t) => { player.seek(t); return arm.state(); }"
    before, faulty, after = (player.evaluate(ask, t) for t in (1.0, 4.0, 7.0))
    assert "healthy" in before["label"]
    assert before["arrow"] is None
    assert faulty["arrow"] == "elbow_joint"
    assert "detected" in faulty["label"]
    assert "not isolated yet" in faulty["label"]
    assert faulty["pin"] == "elbow −4.20 N·m"
    assert "accommodated" in after["label"]
    assert "coulomb friction" in after["label"]
    assert after["ghost"]
    shown = player.inner_text(".arm3d-legend")
    assert all(name in shown for name in NAMES)  # never colour alone


def test_play_pause_and_seek_with_the_mouse(player):
    player.evaluate("() => { player.speed = 0.25; }")  # long enough to be stopped on a slow machine
    player.click("button[aria-label=Play]")
    moved = settled(player, "() => player.time", lambda t: t > 0.2)
    player.click("button[aria-label=Pause]")
    assert not player.evaluate("() => player.playing")
    still = player.evaluate("() => player.time")
    player.wait_for_timeout(300)
    assert player.evaluate("() => player.time") == still >= moved
    box = player.locator(".arm3d-bar input[type=range]").bounding_box()
    player.mouse.click(box["x"] + 0.75 * box["width"], box["y"] + box["height"] / 2)
    assert player.evaluate("() => player.time") == pytest.approx(6.0, abs=0.25)


def test_the_keyboard_does_it_too(player):
    player.focus(".arm3d-view")
    player.keyboard.press("End")
    assert player.evaluate("() => player.time") == pytest.approx(8.0)
    player.keyboard.press("ArrowLeft")
    assert player.evaluate("() => player.time") == pytest.approx(7.0)
    player.keyboard.press("Home")
    assert player.evaluate("() => player.time") == 0.0
    player.keyboard.press("Space")
    assert player.evaluate("() => player.playing")
    player.keyboard.press("Space")
    assert not player.evaluate("() => player.playing")


def test_at_the_end_it_stops_and_begins_again(player):
    player.evaluate("() => { player.seek(7.8); player.speed = 5; player.play(); }")
    settled(player, "() => player.playing", lambda playing: not playing)
    assert player.evaluate("() => player.time") == pytest.approx(8.0)
    player.evaluate("() => { player.speed = 0.25; }")
    player.click("button[aria-label=Play]")
    assert settled(player, "() => player.time", lambda t: 0 < t < 7)


def test_time_is_reported(player):
    told = player.evaluate(
        "() => { const at = []; player.onTime = (t) => at.push(t); player.seek(2.5); return at; }"
    )
    assert told == [2.5]
    assert "2.5 / 8.0 s" in player.inner_text(".arm3d-time")


def test_a_click_picks_a_joint(player, ur5):
    player.evaluate("() => { globalThis.picked = []; arm.onSelect = (joint) => picked.push(joint); }")
    player.wait_for_timeout(300)
    where = player.evaluate(
        """() => { const p = new MeshCat.THREE.Vector3(), area = arm._pane.getBoundingClientRect();
        arm._links.find((l) => l.joint === "elbow_joint").mesh.geometry.boundingBox.getCenter(p);
        arm._links.find((l) => l.joint === "elbow_joint").mesh.localToWorld(p).project(arm.viewer.camera);
        return [area.left + (0.5 + 0.5 * p.x) * area.width, area.top + (0.5 - 0.5 * p.y) * area.height]; }"""
    )
    player.mouse.click(*where)
    assert player.evaluate("() => picked") == ["elbow_joint"]
    assert player.evaluate("() => arm.state().selected") == "elbow_joint"
    assert "elbow_joint" in player.inner_text(".arm3d-head")
    player.evaluate("() => arm.select(null)")
    assert player.evaluate("() => arm.state().selected") is None


def test_two_tracks_are_a_choice(page, tmp_path, ur5):
    _, scene, timeline = ur5
    (track,) = timeline.tracks
    calm = Track("with coulomb friction", 0 * track.stage, 0.1 * track.level, 0 * track.torque)
    named = Track("as given", track.stage, track.level, track.torque, track.label)
    both = Timeline(timeline.time, timeline.position, timeline.stages, (named, calm))
    opened(page, tmp_path, ArmPage(scene, both))
    page.evaluate("() => player.seek(4.0)")
    given = page.evaluate("() => arm.state().joints.elbow_joint.intensity")
    page.click("text=with coulomb friction")
    assert page.evaluate("() => arm.state().joints.elbow_joint.intensity") < 0.2 < given
    page.click("text=as given")
    assert page.evaluate("() => arm.state().joints.elbow_joint.intensity") == given


def test_dark_and_light(chromium, tmp_path, ur5, screenshots):
    _, scene, timeline = ur5
    path = ArmPage(scene, timeline).save(tmp_path / "arm.html")
    brightness = {}
    for theme in ("light", "dark"):
        context = chromium.new_context(viewport={"width": 1280, "height": 800}, color_scheme=theme)
        page = context.new_page()
        page.goto(path.as_uri())
        page.evaluate("() => player.seek(4.0)")
        page.wait_for_timeout(2000)
        page.screenshot(path=screenshots / f"arm-{theme}.png")
        assert page.evaluate("() => arm.box.dataset.theme") == theme
        brightness[theme] = page.evaluate("() => getComputedStyle(arm.box).color")
        context.close()
    assert len(set(brightness.values())) == 2


def test_without_webgl_the_page_still_answers(page, tmp_path):
    robot = load_robot("scara")
    page.add_init_script("HTMLCanvasElement.prototype.getContext = () => null")
    opened(page, tmp_path, ArmPage(Scene.of(robot), motion(robot, 1)))
    page.evaluate("() => player.seek(4.0)")
    assert page.evaluate("() => arm.state().joints.joint2.stage") == "detected"
    assert "WebGL" in page.inner_text(".arm3d-notes")


def test_a_picture_that_is_taken_away_leaves_nothing(player):
    drawn = "() => { arm.dispose(); return [document.querySelectorAll('.arm3d').length, arm.frames]; }"
    left, frames = player.evaluate(drawn)
    player.wait_for_timeout(300)
    assert left == 0
    assert player.evaluate("() => arm.frames") == frames
    assert player.seen.errors == []


def near(colour, other):
    """Distance of two colours."""
    values = [np.array([int(c[i : i + 2], 16) for i in (1, 3, 5)]) for c in (colour, other)]
    return float(np.linalg.norm(values[0] - values[1]))


FARTHEST = """(base) => { // how far from the middle of the picture a point of the arm comes, the edge at 1
  const { THREE } = MeshCat, { camera, scene } = arm.viewer;
  let most = 0;
  for (let t = player.begin; t <= player.end; t += 0.25) {
    player.seek(t);
    scene.updateMatrixWorld(true);
    for (const { joint, mesh } of arm._links) {
      const at = mesh.geometry.attributes.position;
      for (let k = 0; (base || joint !== null) && k < at.count; k += 20) {
        const p = new THREE.Vector3().fromBufferAttribute(at, k).applyMatrix4(mesh.matrixWorld).project(camera);
        most = Math.max(most, Math.abs(p.x), Math.abs(p.y));
      }
    }
  }
  return most;
}"""
LINK = """<link name="{0}"><inertial><mass value="2"/>
  <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>"""
TURNS = """<joint name="{0}" type="revolute"><parent link="{1}"/><child link="{2}"/><origin xyz="{3}"/>
  <axis xyz="0 1 0"/><limit lower="-2" upper="2" velocity="4" effort="90"/></joint>"""
BARE = f"""{LINK.format("upper")}{LINK.format("lower")}{TURNS.format("shoulder", "base", "upper", "0 0 0.5")}
  {TURNS.format("elbow", "upper", "lower", "0.4 0 0")}"""  # no shapes
BOX = """<link name="base"><visual><origin xyz="0 0 {2}"/>
  <geometry><box size="{0} {0} {1}"/></geometry></visual></link>"""


def test_the_whole_arm_is_in_the_picture_in_every_pose(player):
    settled(player, "() => arm.frames", lambda frames: frames > 0)
    assert 0.5 < player.evaluate(FARTHEST, True) < 0.95


@pytest.mark.parametrize(
    ("base", "whole"),
    [
        (
            '<link name="base"/>',
            True,
        ),  # a pedestal of which nothing is known is drawn as a capsule, longer than the arm
        (BOX.format(0.4, 0.5, 0.25), True),
        (BOX.format(4.0, 0.05, 0.4), False),  # a table top
    ],
)
def test_what_an_arm_stands_on_is_in_the_picture_unless_the_arm_would_be_small(page, tmp_path, base, whole):
    (tmp_path / "arm.urdf").write_text(f'<robot name="arm">{base}{BARE}</robot>')
    robot = load_robot(tmp_path / "arm.urdf")
    time = np.linspace(0.0, 4.0, 41)
    position = np.stack([0.3 * np.sin(time), 0.4 * np.cos(time)], axis=1)
    nothing = np.zeros(position.shape)
    track = Track("", nothing.astype(int), nothing, nothing)
    opened(page, tmp_path, ArmPage(Scene.of(robot), Timeline(time, position, monitor_stages(), (track,))))
    settled(page, "() => arm.frames", lambda frames: frames > 0)
    assert 0.3 < page.evaluate(FARTHEST, False) < 0.95
    assert (page.evaluate(FARTHEST, True) < 0.95) == whole


# ------------------------------------------------------------------ what acts on the whole arm


def test_a_contact_is_an_arrow_and_a_payload_a_ball(page, tmp_path, ur5):
    robot, scene, timeline = ur5
    document_of = AttachedWords(robot)
    push = Term(ExternalWrench("elbow_joint"), (0.0, 0.0, -40.0, 0.0, 0.0, 0.0))
    payload = Term(Payload(), (2.0, 0.0, 0.0, 0.1, *[0.0] * 6))
    now = document_of([push, payload])
    track = replace(timeline.tracks[0], attached=((2.0, now), (6.0, document_of([payload]))))
    opened(page, tmp_path, ArmPage(scene, replace(timeline, tracks=(track,))))
    ask = "(t) => { player.seek(t); return arm.state(); }"
    assert page.evaluate(ask, 1.0)["attached"] is None
    shown = page.evaluate(ask, 4.0)
    q = timeline.position[int(np.argmin(np.abs(timeline.time - 4.0)))]
    place = robot.joint_placements(q)[robot.joint_index("elbow_joint")] @ [*now["push"]["at"], 1.0]
    np.testing.assert_allclose(shown["arrowAt"], place[:3], atol=2e-3)
    assert shown["arrowLength"] == pytest.approx(0.4)  # 10 cm for 10 N, as the legend says
    legend = page.evaluate("() => arm.box.querySelector('.arm3d-legend').textContent")
    assert "10 cm for 10 N" in legend
    assert shown["ballSize"] == pytest.approx((3 * 2.0 / (4 * np.pi * 2000)) ** (1 / 3))
    assert shown["arrow"] is None  # the missing torque is that of the contact
    later = page.evaluate(ask, 7.0)
    assert later["arrowAt"] is None
    assert later["ballSize"] > 0
    assert page.seen.errors == []
