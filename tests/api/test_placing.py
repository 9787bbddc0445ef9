"""Where a program spawns robots: poses, namespaces, frames and controllers."""

import math
import pickle
from pathlib import Path
from typing import Any

import pytest
from tests.coded import coded, raises

import cartwheel as cw
from cartwheel.codes.command import OPTIONS_CONFLICT
from cartwheel.codes.graph import GRAPH_NAME_INVALID
from cartwheel.codes.running import CONTROLLERS_NOT_NAMED, SERVICE_TAKEN
from cartwheel.codes.world import NUMBER_OUT_OF_RANGE
from cartwheel.dialects.ros_control.files import ControllerFiles
from cartwheel.errors import CartwheelError
from cartwheel.geometry import Pose

BOX = """<sdf version="1.6"><model name="box"><static>1</static><pose>1 2 3 0 0 0.5</pose>
  <link name="link"/></model></sdf>"""


@pytest.fixture
def box(tmp_path: Path) -> Path:
    path = tmp_path / "box.sdf"
    path.write_text(BOX)
    return path


def test_a_pose_is_given_or_is_that_of_the_file(box: Path) -> None:
    with cw.World("empty") as world:
        assert world.spawn(box, name="file").pose.position == (1, 2, 3)
        assert world.spawn(box, name="zero", pose=Pose()).pose == Pose()
        assert world.spawn(box, name="x", x=0.0).pose == Pose()
        turned = world.spawn(box, name="turned", y=-1.0, yaw=0.3).pose
        assert turned.position == pytest.approx((0, -1, 0))
        assert turned.yaw == pytest.approx(0.3)
        with raises(OPTIONS_CONFLICT):
            world.spawn(box, name="both", pose=Pose(), x=1.0)
        for bad in (math.nan, math.inf, 1e9):
            with raises(NUMBER_OUT_OF_RANGE):
                world.spawn(box, name="bad", z=bad)
            with raises(NUMBER_OUT_OF_RANGE):
                world.spawn(box, name="bad", pose=Pose((0.0, 0.0, bad)))
        assert world.models == ("ground_plane", "file", "zero", "x", "turned")


def frames(topic: cw.Topic) -> set[tuple[str, str]]:
    return {
        (each.header.frame_id, each.child_frame_id)
        for message in topic.history()
        for each in message.transforms
    }


def test_two_carts_in_namespaces_are_separate() -> None:
    with cw.World("empty") as world:
        left, right = (
            world.spawn("rosbots.xacro", name=name, namespace=name, frame_prefix=name, y=y)
            for name, y in (("left", 1.0), ("right", -1.0))
        )
        assert (left.namespace, right.namespace) == ("/left", "/right")
        assert coded(world, SERVICE_TAKEN) == []
        own, other = set(left.topics), set(right.topics)
        assert own & other == {"/tf"}
        assert "/left/part2_cmr/cmd_vel" in own
        assert {name for name in own if not name.startswith("/left/")} == {"/tf"}
        assert "/left/imu/service" in world.services
        moving, fixed = world.topic("/tf"), world.topic("/tf_static")
        odometry = world.topic("/right/odom")
        right.publish("/right/part2_cmr/cmd_vel", linear_x=0.5)
        world.run(2.0)
        assert left.pose.x == pytest.approx(0.0, abs=0.01)
        assert right.pose.x == pytest.approx(0.5 * 2 - 0.5**2 / 2, abs=0.02)
        assert odometry.latest.header.frame_id == "right/odom"
        pairs = frames(moving) | frames(fixed)
        assert ("left/odom", "left/base_footprint") in pairs
        for parent, child in pairs:
            assert parent.partition("/")[0] == child.partition("/")[0]
            assert parent.partition("/")[0] in ("left", "right")


def test_a_namespace_that_is_no_name() -> None:
    with cw.World("empty") as world:
        for bad in ("two words", "1st", "a//b c"):
            with raises(GRAPH_NAME_INVALID):
                world.spawn("rosbots.xacro", namespace=bad)
        assert world.models == ("ground_plane",)
        assert world.spawn("rosbots.xacro", namespace="/a/b/").namespace == "/a/b"
        assert world.spawn("rosbots.xacro", name="two", y=2.0).namespace == "/"


PACKAGE = "<package><name>arm_bot</name></package>"
URDF = """<robot name="arm"><link name="world"/>
  <link name="a"><inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0"
  iyz="0"/></inertial></link><joint name="a_joint" type="continuous"><parent link="world"/>
  <child link="a"/><axis xyz="0 0 1"/></joint>
  <transmission name="t"><type>transmission_interface/SimpleTransmission</type>
  <joint name="a_joint"><hardwareInterface>hardware_interface/VelocityJointInterface
  </hardwareInterface></joint><actuator name="m"/></transmission>
  <gazebo><plugin name="control" filename="libgazebo_ros_control.so"/></gazebo></robot>"""
YAML = """
states: {type: joint_state_controller/JointStateController, publish_rate: 50}
slow: {type: velocity_controllers/JointVelocityController, joint: a_joint}
fast: {type: velocity_controllers/JointVelocityController, joint: a_joint}
"""
LAUNCH = """<launch><rosparam file="$(find arm_bot)/config/controllers.yaml" command="load"/>
  <param name="robot_description" command="xacro $(find arm_bot)/urdf/arm.urdf"/>
  <node name="spawn" pkg="gazebo_ros" type="spawn_model" args="-urdf -param robot_description"/>
  <node name="start" pkg="controller_manager" type="spawner" args="states fast"/></launch>"""


def package(folder: Path, *, launch: bool = True) -> Path:
    """A package with a robot, its controllers and, if asked, a launch file; the robot's file."""
    home = folder / "arm_bot"
    for name in ("urdf", "config", "launch"):
        (home / name).mkdir(parents=True)
    (home / "package.xml").write_text(PACKAGE)
    (home / "config" / "controllers.yaml").write_text(YAML)
    if launch:
        (home / "launch" / "arm.launch").write_text(LAUNCH)
    (home / "urdf" / "arm.urdf").write_text(URDF)
    return home / "urdf" / "arm.urdf"


def test_automatic_controllers_are_those_of_the_launch_file(tmp_path: Path) -> None:
    with cw.World("empty") as world:
        model = world.spawn(package(tmp_path), controllers="auto")
        assert "/fast/command" in model.topics
        assert "/slow/command" not in model.topics
        assert "/joint_states" in model.topics
        world.publish("/fast/command", data=0.5)
        world.run(2.0)
        assert model.joint("a_joint") == pytest.approx(1.0, abs=0.05)
        assert coded(world, CONTROLLERS_NOT_NAMED) == []


def test_without_a_launch_file_they_are_those_of_the_yaml_file(tmp_path: Path) -> None:
    with cw.World("empty") as world:
        model = world.spawn(package(tmp_path, launch=False), controllers="auto")
        # Both command the same joint, so only one of them starts.
        assert len({"/slow/command", "/fast/command"} & set(model.topics)) == 2
        listed = world.call("/controller_manager/list_controllers").controller
        states = {each.name: each.state for each in listed}
        assert states["states"] == "running"
        assert sorted((states["slow"], states["fast"])) == ["initialized", "running"]


def test_a_manager_without_controllers_is_reported(tmp_path: Path) -> None:
    file = package(tmp_path)
    with cw.World("empty") as world:
        world.spawn(file)
        found: list[Any] = coded(world, CONTROLLERS_NOT_NAMED, model="arm")
        assert found[0].values["files"] == (str(tmp_path / "arm_bot/config/controllers.yaml"),)
    for controllers in ((), "auto", tmp_path / "arm_bot/config/controllers.yaml"):
        with cw.World("empty") as world:
            world.spawn(file, controllers=controllers)
            assert coded(world, CONTROLLERS_NOT_NAMED) == []
    with cw.World("empty", strict=True) as world:
        with raises(CONTROLLERS_NOT_NAMED, CartwheelError):
            world.spawn(file)
        assert world.models == ("ground_plane",)


def test_automatic_controllers_of_a_robot_without_a_manager() -> None:
    with cw.World("empty") as world:
        cart = world.spawn("rosbots.xacro", controllers="auto")
        assert "/part2_cmr/cmd_vel" in cart.topics
        assert coded(world, CONTROLLERS_NOT_NAMED) == []


def test_automatic_controllers_are_built_once(tmp_path: Path) -> None:
    built = cw.build("empty", {"robot": package(tmp_path), "controllers": "auto"})
    with built.world() as world:
        assert "/fast/command" in world.model("arm").topics


def test_automatic_controllers_come_back_with_their_robot(tmp_path: Path) -> None:
    with cw.World("empty") as world:
        model = world.spawn(package(tmp_path), controllers="auto")
        world.publish("/fast/command", data=0.5)
        world.run(0.5)
        state, topics, reported = world.save(), model.topics, world.diagnostics
        world.run(1.0)
        expected = model.joint("a_joint")
        # A state of the model that was created again knows its controllers as well.
        for copied in (False, True, True):
            if copied:
                world.restore(state)
                state = pickle.loads(pickle.dumps(world.save()))
            model.delete()
            assert "/fast/command" not in world.topics
            world.restore(state)
            assert model.topics == topics
            listed = world.call("/controller_manager/list_controllers").controller
            assert {each.name for each in listed} == {"states", "fast"}
            assert world.diagnostics == reported
            # Other controllers of the file were not even loaded.
            loaded = world.session.shared.get(ControllerFiles).loaded
            assert {each.name for each in loaded} <= {"states", "fast"}
            world.run(1.0)
            assert model.joint("a_joint") == expected
