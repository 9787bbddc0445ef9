"""Published robots, used as a program would: topics, arrays, namespaces and controllers."""

import contextlib
import math
import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from tests.coded import coded

import cartwheel as cw
from cartwheel.codes.running import CONTROLLERS_NOT_NAMED, SERVICE_TAKEN

ROOT = Path(__file__).resolve().parents[2]
CORPUS = Path(os.environ.get("CARTWHEEL_CORPUS", ROOT.parent / "shared" / "corpus"))
TURTLEBOT = CORPUS / "turtlebot3" / "turtlebot3_description" / "urdf"
BURGER, WAFFLE = (TURTLEBOT / f"turtlebot3_{name}.urdf.xacro" for name in ("burger", "waffle"))
MIR = CORPUS / "mir_robot" / "mir_description" / "urdf" / "mir.urdf.xacro"
ARM = ROOT / "docs" / "how-to" / "files" / "arm" / "arm.urdf.xacro"
RRBOT = CORPUS / "gazebo_ros_demos" / "rrbot_description" / "urdf" / "rrbot.xacro"

needs_corpus = pytest.mark.skipif(
    not CORPUS.is_dir(), reason=f"no corpus of others' robots in {CORPUS}"
)


WALL = """<sdf version="1.6"><model name="wall"><static>1</static><pose>2 0 0.5 0 0 0</pose>
  <link name="link"><collision name="c"><geometry><box><size>0.5 4 1</size></box></geometry>
  </collision></link></model></sdf>"""


@needs_corpus
def test_a_burger_drives_to_a_goal_and_sees_a_wall(tmp_path: Path) -> None:
    wall = tmp_path / "wall.sdf"
    wall.write_text(WALL)
    with cw.World("empty") as world:
        burger = world.spawn(BURGER)
        world.spawn(wall)
        scans, commands = world.topic("/scan"), world.topic("/cmd_vel")
        with commands.hold(linear_x=0.2):
            world.run_until(lambda: burger.pose.x > 0.5, timeout=5.0)
        # 0.2 m/s: 2.5 s, and the wheels' acceleration.
        assert world.time == pytest.approx(2.5, abs=0.2)
        assert burger.pose.y == pytest.approx(0.0, abs=0.02)
        commands.publish()
        world.run(1.0)
        scan = cw.scan(scans.wait(timeout=1.0))
        assert scan.ranges.shape == scan.angles.shape == (360,)
        # The face of the wall is at 1.75 m, the laser 0.032 m behind the robot's origin. Five
        # standard deviations of the noise of 0.01 m.
        ahead = scan.ranges[np.argmin(np.abs(scan.angles))]
        assert ahead == pytest.approx(1.75 - burger.pose.x + 0.032, abs=0.05)


@needs_corpus
def test_a_waffle_has_images() -> None:
    with cw.World("walls") as world:
        waffle = world.spawn(WAFFLE)
        cameras = [world.topic(name) for name in waffle.topics if name.endswith("/image_raw")]
        world.run(1.0)
        shapes = {camera.latest.encoding: cw.image(camera.latest).shape for camera in cameras}
        assert {len(shape) for shape in shapes.values()} == {2, 3}
        for camera in cameras:
            size = (camera.latest.height, camera.latest.width)
            assert cw.image(camera.latest).shape[:2] == size


@needs_corpus
def test_two_burgers_in_namespaces_are_separate() -> None:
    with cw.World("empty") as world:
        one, two = (
            world.spawn(
                BURGER, name=name, namespace=name, frame_prefix=name, pose=cw.Pose((0, y, 0))
            )
            for name, y in (("one", 1.0), ("two", -1.0))
        )
        assert coded(world, SERVICE_TAKEN) == []
        shared = set(one.topics) & set(two.topics)
        assert shared == {"/tf"}
        transforms = world.topic("/tf")
        with world.topic("/one/cmd_vel").hold(linear_x=0.2):
            world.run(3.0)
        assert one.pose.x == pytest.approx(0.6, abs=0.05)
        assert two.pose.x == pytest.approx(0.0, abs=0.01)
        frames = {each.child_frame_id for m in transforms.history() for each in m.transforms}
        assert {name.partition("/")[0] for name in frames} == {"one", "two"}


@needs_corpus
def test_a_mir_drives_with_the_controllers_of_its_package() -> None:
    with cw.World("empty") as world:
        mir = world.spawn(MIR, controllers="auto")
        assert coded(world, CONTROLLERS_NOT_NAMED) == []
        (command,) = [name for name in mir.topics if name.endswith("/cmd_vel")]
        world.run(0.5)
        start = mir.pose.x
        with world.topic(command).hold(linear_x=0.3):
            world.run_until(lambda: mir.pose.x > start + 0.5, timeout=5.0)
        assert mir.pose.y == pytest.approx(0.0, abs=0.05)


@needs_corpus
def test_an_rrbot_reaches_its_commands() -> None:
    with cw.World("empty") as world:
        rrbot = world.spawn(RRBOT, controllers="auto")
        topics = [name for name in rrbot.topics if name.endswith("/command")]
        assert len(topics) == 2
        for name in topics:
            world.publish(name, data=0.4)
        world.run_until(lambda: abs(rrbot.joint("joint1") - 0.4) < 0.02, timeout=20.0)
        states = next(name for name in rrbot.topics if name.endswith("/joint_states"))
        message = world.topic(states).wait()
        assert "joint1" in list(message.name)


@needs_corpus
def test_an_rrbot_without_controllers_is_reported() -> None:
    with cw.World("empty") as world:
        world.spawn(RRBOT)
        (found,) = coded(world, CONTROLLERS_NOT_NAMED, model="rrbot")
        assert [Path(str(file)).name for file in found.values["files"]] == ["rrbot_control.yaml"]


@dataclass(frozen=True, kw_only=True)
class Published:
    """A robot, and the topics of its parts; a part that it does not have is None.

    Args:
        file: Its description.
        base: A link with a mass that moves with the robot.
        command: Topic of its drive.
        odometry: Topic of the drive's odometry.
        lasers: Topics of its lasers.
        camera: Topic of its colour images.
        joints: Its joints with commands.
    """

    file: str | Path
    base: str
    command: str | None = None
    odometry: str | None = None
    lasers: tuple[str, ...] = ()
    camera: str | None = None
    joints: tuple[str, ...] = ()


ROBOTS = {
    "cart": Published(
        file="rosbots.xacro",
        base="base_link",
        command="/part2_cmr/cmd_vel",
        odometry="/odom",
        camera="/rosbots/camera1/image_raw",
    ),
    "burger": Published(
        file=BURGER, base="base_link", command="/cmd_vel", odometry="/odom", lasers=("/scan",)
    ),
    "waffle": Published(
        file=WAFFLE,
        base="base_link",
        command="/cmd_vel",
        odometry="/odom",
        lasers=("/scan",),
        camera="/camera/rgb/image_raw",
    ),
    "mir": Published(
        file=MIR,
        base="base_link",
        command="/mobile_base_controller/cmd_vel",
        odometry="/mobile_base_controller/odom",
        lasers=("/f_scan", "/b_scan"),
    ),
    "rrbot": Published(
        file=RRBOT,
        base="link3",
        lasers=("/rrbot/laser/scan",),
        camera="/rrbot/camera1/image_raw",
        joints=("joint1", "joint2"),
    ),
    "arm": Published(file=ARM, base="forearm", joints=("shoulder", "elbow")),
}
BUNDLED = ("cart", "arm")


def having(part: str) -> pytest.MarkDecorator:
    """The robots that have a part, as the argument ``name``."""
    return pytest.mark.parametrize(
        "name",
        [
            pytest.param(name, marks=() if name in BUNDLED else needs_corpus)
            for name, robot in ROBOTS.items()
            if getattr(robot, part)
        ],
    )


def spawned(world: cw.World, name: str) -> cw.Model:
    """The robot, at rest, with its controllers."""
    robot = world.spawn(ROBOTS[name].file, controllers="auto")
    world.run(1.0)
    return robot


RED_BOX = """<robot name="box"><link name="box">
  <inertial><mass value="50"/><inertia ixx="5" iyy="5" izz="5" ixy="0" ixz="0" iyz="0"/></inertial>
  <visual><geometry><box size="0.4 0.4 1"/></geometry></visual>
  <collision><geometry><box size="0.4 0.4 1"/></geometry></collision>
</link><gazebo reference="box"><material>Gazebo/Red</material></gazebo></robot>"""


@having("command")
def test_it_drives_straight(name: str) -> None:
    robot, speed = ROBOTS[name], 0.2
    with cw.World("empty") as world:
        model = spawned(world, name)
        odometry = world.topic(robot.odometry or "")
        with world.topic(robot.command or "").hold(linear_x=speed):
            world.run(1.0)
            start = model.pose
            world.run(3.0)
        moved = start.inverse() @ model.pose
        assert moved.x == pytest.approx(3.0 * speed, rel=0.05)
        assert moved.y == pytest.approx(0.0, abs=0.01)
        assert moved.yaw == pytest.approx(0.0, abs=0.01)
        assert odometry.latest.twist.twist.linear.x == pytest.approx(speed, rel=0.05)


@having("command")
@pytest.mark.parametrize("turn", [-0.4, 0.4])
def test_it_turns_in_place(name: str, turn: float) -> None:
    robot = ROBOTS[name]
    with cw.World("empty") as world:
        model = spawned(world, name)
        odometry = world.topic(robot.odometry or "")
        with world.topic(robot.command or "").hold(angular_z=turn):
            world.run(2.0)
            start = model.pose
            world.run(3.0)
        moved = start.inverse() @ model.pose
        assert moved.yaw == pytest.approx(3.0 * turn, rel=0.05)
        assert math.hypot(moved.x, moved.y) < 0.05
        assert odometry.latest.twist.twist.angular.z == pytest.approx(turn, rel=0.05)


@having("lasers")
def test_each_laser_sees_a_box_where_it_is(name: str) -> None:
    for topic in ROBOTS[name].lasers:
        with cw.World("empty") as world:
            model = spawned(world, name)
            scans = world.topic(topic)
            place = model.link(scans.wait().header.frame_id).pose
            # In the direction of the middle ray, in the plane of the scan.
            angles = cw.scan(scans.latest).angles
            middle = float(angles[len(angles) // 2])
            ahead = place.apply((1.2 * math.cos(middle), 1.2 * math.sin(middle), 0.0))
            yaw = place.rpy[2] + math.copysign(middle, place.apply((0, 0, 1))[2] - place.z)
            world.spawn(RED_BOX, pose=cw.Pose.from_xyz_rpy(ahead, (0, 0, yaw))).link(
                "box"
            ).gravity = False
            scans.wait()
            flat = cw.scan(scans.wait()).points
            points = place.apply(np.column_stack([flat, np.zeros(len(flat))]))
            box = cw.Pose.from_xyz_rpy(ahead, (0, 0, yaw)).inverse().apply(points)
            face = box[np.abs(box[:, 1]) < 0.18]
            face = face[np.abs(face[:, 0]) < 0.4]
            assert len(face) > 5
            # Noise of at most 0.01 m, and resolutions of up to 0.015 m.
            assert np.median(face[:, 0]) == pytest.approx(-0.2, abs=0.02)
            assert np.all(np.abs(face[:, 0] + 0.2) < 0.08)


@having("camera")
def test_a_camera_sees_a_red_box_at_its_pixels(name: str) -> None:
    topic = ROBOTS[name].camera or ""
    with cw.World("empty") as world:
        model = spawned(world, name)
        images = world.topic(topic)
        information = world.topic(topic.replace("image_raw", "camera_info"))
        image = images.wait()
        eye = optical(model, image.header.frame_id)
        ahead = eye.apply((0.3, 0.0, 2.0))
        place = cw.Pose((ahead[0], ahead[1], 0.5 if ahead[2] < 1.0 else ahead[2]))
        world.spawn(RED_BOX, pose=place).link("box").gravity = False
        images.wait()
        pixels = cw.image(images.wait()).astype(int)
        red = (pixels[..., 0] > 60) & (pixels[..., 1:].max(axis=-1) < 0.4 * pixels[..., 0])
        columns = np.flatnonzero(red.any(axis=0))
        corners = np.array(
            [(x, y, z) for x in (-0.2, 0.2) for y in (-0.2, 0.2) for z in (-0.5, 0.5)]
        )
        seen = eye.inverse().apply(place.apply(corners)) @ cw.camera_matrix(information.latest).T
        expected = seen[:, 0] / seen[:, 2]
        # Two pixels, and those of lenses with distortion.
        tolerance = 2.0 + 0.005 * image.width
        assert columns.min() == pytest.approx(max(expected.min(), 0.0), abs=tolerance)
        assert columns.max() == pytest.approx(min(expected.max(), image.width - 1.0), abs=tolerance)


def optical(model: cw.Model, frame: str) -> cw.Pose:
    """The frame of an image, with z forwards; some descriptions name the link of the camera."""
    pose = model.link(frame).pose
    forwards = np.array(pose.apply((0.0, 0.0, 1.0))) - pose.position
    if abs(forwards[2]) < 0.7:
        return pose
    return pose @ cw.Pose.from_xyz_rpy((0, 0, 0), (-math.pi / 2, 0, -math.pi / 2))


def test_the_cart_s_bumper_fires_at_a_box() -> None:
    with cw.World("empty") as world:
        cart = spawned(world, "cart")
        world.spawn(RED_BOX, x=1.2, z=0.5)
        bumper = world.topic("/bumpers")
        cart.publish("/part2_cmr/cmd_vel", linear_x=0.3)
        world.run(0.5)
        assert not bumper.latest.states
        world.run_until(lambda: len(bumper.latest.states) > 0, timeout=10.0)
        assert bumper.latest.states[0].collision2_name.startswith("box::")
        assert world.contacts(between=(cart, "box"))


@having("joints")
def test_an_arm_reaches_a_pose_and_carries_its_weight(name: str) -> None:
    with cw.World("empty") as world:
        arm = spawned(world, name)
        command(world, name, (0.5, -0.3))
        world.run(8.0)
        reached = [arm.joint(joint) for joint in ROBOTS[name].joints]
        # A PID controller without an effective integral gain sags by its load over its gain.
        assert reached == pytest.approx([0.5, -0.3], abs=0.15 if name == "rrbot" else 0.01)
        for added in (0.0, 2.0):
            arm.link(ROBOTS[name].base).mass += added
            world.run(8.0)
            for joint, first in zip(ROBOTS[name].joints, arms(name), strict=True):
                assert arm.joints[joint].effort == pytest.approx(
                    -moment_of_weight(arm, first), abs=0.02
                )


def test_an_arm_reaches_the_goal_of_an_action() -> None:
    with cw.World("empty") as world:
        arm = spawned(world, "arm")
        joints = ROBOTS["arm"].joints
        goal = world.send_goal(
            "/arm_controller/follow_joint_trajectory",
            trajectory={
                "joint_names": list(joints),
                "points": [{"positions": [-0.6, 1.0], "time_from_start": 2.0}],
            },
        )
        goal.result(timeout=5.0)
        assert goal.status == "succeeded"
        assert goal.feedback is not None
        assert [arm.joint(joint) for joint in joints] == pytest.approx([-0.6, 1.0], abs=0.01)


def command(world: cw.World, name: str, positions: tuple[float, float]) -> None:
    """Commands an arm by the topics of its controllers."""
    if name == "rrbot":
        for joint, position in zip(ROBOTS[name].joints, positions, strict=True):
            world.publish(f"/rrbot/{joint}_position_controller/command", data=position)
        return
    point = {"positions": list(positions), "time_from_start": 1.0}
    world.publish(
        "/arm_controller/joint_trajectory", joint_names=list(ROBOTS[name].joints), points=[point]
    )


def arms(name: str) -> tuple[str, str]:
    """The first link that each joint of an arm moves."""
    return ("link2", "link3") if name == "rrbot" else ("upper_arm", "forearm")


def moment_of_weight(arm: cw.Model, first: str) -> float:
    """The moment about the y axis of a link's joint of the weight of this and all later links."""
    axis = arm.link(first).pose.x
    moved = arm.links[arm.links.index(first) :]
    return sum(
        9.8 * link.mass * (link.pose.apply(link.center_of_mass)[0] - axis)
        for link in map(arm.link, moved)
        if link.mass
    )


@having("command")
def test_a_sliding_robot_is_braked_by_its_friction(name: str) -> None:
    # Otherwise, the friction of casters is limited and softened.
    with cw.World("empty", without="all") as world:
        model = spawned(world, name)
        for friction in (0.1, 0.2):
            for link in map(model.link, model.links):
                with contextlib.suppress(cw.CartwheelError):
                    link.friction = friction
            model.velocity = cw.Twist(linear=(0.0, 1.0, 0.0))
            world.run(0.1)
            before = model.velocity.linear[1]
            world.run(0.2)
            braking = (before - model.velocity.linear[1]) / 0.2
            assert braking == pytest.approx(friction * 9.8, rel=0.1)


@having("command")
def test_a_push_moves_a_heavier_robot_less(name: str) -> None:
    with cw.World("empty") as world:
        model = spawned(world, name)
        world.gravity = (0.0, 0.0, 0.0)
        for added in (0.0, 10.0):
            model.link(ROBOTS[name].base).mass += added
            model.pose = cw.Pose((0.0, 0.0, 5.0))
            model.push(force=(20.0, 0.0, 0.0), seconds=0.1)
            world.run(0.1)
            impulse = sum(
                link.mass * speed_of_centre(link)
                for link in map(model.link, model.links)
                if link.mass
            )
            assert impulse == pytest.approx(2.0, rel=0.01)
            assert model.mass == pytest.approx(sum(model.link(each).mass for each in model.links))


def speed_of_centre(link: cw.Link) -> float:
    """The velocity of a link's centre of mass along x, m/s."""
    arm = np.array(link.pose.apply(link.center_of_mass)) - link.pose.position
    return float((np.array(link.velocity.linear) + np.cross(link.velocity.angular, arm))[0])


@having("base")
def test_a_state_is_saved_changed_and_restored(name: str) -> None:
    robot = ROBOTS[name]

    def go(world: cw.World) -> None:
        if robot.command:
            with world.topic(robot.command).hold(linear_x=0.2, angular_z=0.3):
                world.run(1.0)
        else:
            command(world, name, (0.4, -0.4))
            world.run(1.0)

    def found(model: cw.Model) -> list[object]:
        places = [model.link(each).pose for each in model.links]
        return [places, dict(model.joints.velocities), model.mass]

    with cw.World("empty", seed=2) as world:
        model = spawned(world, name)
        go(world)
        state = world.save()
        go(world)
        expected = found(model)
        model.link(robot.base).mass += 5.0
        model.link(robot.base).gravity = False
        world.gravity = (0.0, 0.0, -1.62)
        if robot.command:
            model.pose = cw.Pose((3.0, 2.0, 0.5))
        else:
            model.joints.positions = dict.fromkeys(robot.joints, 1.0)
        world.run(0.5)
        assert found(model) != expected
        world.restore(state)
        go(world)
        assert found(model) == expected
