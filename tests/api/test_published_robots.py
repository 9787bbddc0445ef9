"""Published robots, used as a program would: topics, arrays, namespaces and controllers."""

import os
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
RRBOT = CORPUS / "gazebo_ros_demos" / "rrbot_description" / "urdf" / "rrbot.xacro"

pytestmark = pytest.mark.skipif(
    not CORPUS.is_dir(), reason=f"no corpus of others' robots in {CORPUS}"
)


WALL = """<sdf version="1.6"><model name="wall"><static>1</static><pose>2 0 0.5 0 0 0</pose>
  <link name="link"><collision name="c"><geometry><box><size>0.5 4 1</size></box></geometry>
  </collision></link></model></sdf>"""


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


def test_an_rrbot_without_controllers_is_reported() -> None:
    with cw.World("empty") as world:
        world.spawn(RRBOT)
        (found,) = coded(world, CONTROLLERS_NOT_NAMED, model="rrbot")
        assert [Path(str(file)).name for file in found.values["files"]] == ["rrbot_control.yaml"]
