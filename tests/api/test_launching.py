"""Worlds with the models of a launch file."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from tests.coded import coded, raises
from tests.corpus.carts import cart, written
from tests.corpus.test_rivals import managed

import cartwheel as cw
from cartwheel.codes.devices import CONTROLLER_ONLY_LOADED
from cartwheel.codes.files import (
    ARGUMENT_UNKNOWN,
    LAUNCH_VALUE_UNKNOWN,
    LAUNCH_WORLD_ABSENT,
    NOT_A_DESCRIPTION,
)
from cartwheel.codes.graph import ENTITY_UNKNOWN
from cartwheel.codes.world import MODEL_NAME_TAKEN

TWO = """<launch>
  <arg name="arena" default="$(find carts)/worlds/hall.world"/>
  <include file="$(find gazebo_ros)/launch/empty_world.launch">
    <arg name="world_name" value="$(arg arena)"/></include>
  <param name="robot_description" command="xacro $(find carts)/urdf/cart.xacro"/>
  <node pkg="gazebo_ros" type="spawn_model" name="a"
    args="-urdf -param robot_description -model left -y 2 -robot_namespace left"/>
  <node pkg="gazebo_ros" type="spawn_model" name="b"
    args="-urdf -param robot_description -model NAME -y -2 -robot_namespace right"/>
</launch>"""
CART = """<robot name="cart" xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:arg name="mass" default="2"/>
<link name="base"><inertial><mass value="$(arg mass)"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
<gazebo><plugin name="move" filename="libgazebo_ros_planar_move.so">
<commandTopic>cmd_vel</commandTopic><odometryTopic>odom</odometryTopic></plugin></gazebo></robot>"""
HALL = """<sdf version="1.6"><world name="hall"><model name="pillar"><static>true</static>
<pose>5 0 0.5 0 0 0</pose><link name="link"><collision name="c"><geometry>
<box><size>1 1 1</size></box></geometry></collision></link></model></world></sdf>"""
SLIDER = """<robot name="slider"><link name="base"><inertial><mass value="5"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="bar"><inertial><mass value="1"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="world"/>
  <joint name="foot" type="fixed"><parent link="world"/><child link="base"/></joint>
  <joint name="slide" type="prismatic"><parent link="base"/><child link="bar"/><axis xyz="1 0 0"/>
  <limit lower="-1" upper="1" effort="100" velocity="5"/></joint>
  <ros2_control name="s" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin>
  </hardware><joint name="slide"><command_interface name="position"/>
  <state_interface name="position"/></joint></ros2_control>
  <gazebo><plugin filename="gz_ros2_control-system"
    name="gz_ros2_control::GazeboSimROS2ControlPlugin"/></gazebo></robot>"""
CONTROLLERS = """
controller_manager:
  ros__parameters:
    update_rate: 100
    good: {type: position_controllers/JointGroupPositionController}
    other: {type: position_controllers/JointGroupPositionController}
good:
  ros__parameters: {joints: [slide]}
other:
  ros__parameters: {joints: [slide]}
"""
GZ = """<robot name="gz"><link name="base"><inertial><mass value="2"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<gazebo><plugin filename="gz-sim-odometry-publisher-system"
name="gz::sim::systems::OdometryPublisher"/></gazebo></robot>"""
BRIDGE = """
- ros_topic_name: /robot/odom
  gz_topic_name: /model/gz/odometry
  ros_type_name: nav_msgs/msg/Odometry
  gz_type_name: gz.msgs.Odometry
  direction: GZ_TO_ROS
"""
STARTER = """
def generate_launch_description():
    share = get_package_share_directory("carts")
    file = os.path.join(share, "config", "control.yaml")
    xacro.process_file(os.path.join(share, "urdf", "slider.urdf"))
    return [
        Node(package="controller_manager", executable="ros2_control_node", parameters=[file]),
        Node(package="ros_gz_sim", executable="create", arguments=["-topic", "robot_description"]),
        Node(package="controller_manager", executable="spawner", arguments=["good"]),
    ]
"""


@pytest.fixture
def package(tmp_path: Path) -> Path:
    folder = tmp_path / "carts"
    texts = {
        "package.xml": "<package><name>carts</name></package>",
        "urdf/cart.xacro": CART,
        "urdf/slider.urdf": SLIDER,
        "config/control.yaml": CONTROLLERS,
        "worlds/hall.world": HALL,
        "launch/two.launch": TWO.replace("NAME", "right"),
        "launch/twins.launch": TWO.replace("NAME", "left"),
        "launch/slider.launch.py": STARTER,
    }
    for name, text in texts.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    return folder


def test_two_robots_of_a_launch_file_drive_in_its_world(package: Path) -> None:
    with cw.launch(package / "launch/two.launch", seed=3) as world:
        assert world.models == ("pillar", "left", "right")
        assert [round(world.model(name).pose.y, 6) for name in ("left", "right")] == [2.0, -2.0]
        world.publish("/right/cmd_vel", linear_x=1.0)
        world.run(1.0)
        assert world.model("right").pose.x > 0.9
        assert abs(world.model("left").pose.x) < 1e-3


ARM = """<robot name="arm"><link name="base"><inertial><mass value="5"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="beam"><inertial><mass value="1"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="world"/>
  <joint name="foot" type="fixed"><parent link="world"/><child link="base"/></joint>
  <joint name="turn" type="revolute"><parent link="base"/><child link="beam"/><origin xyz="1 0 0"/>
  <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="100" velocity="5"/></joint></robot>"""
PLACED = """<launch>
  <param name="robot_description" textfile="$(find carts)/urdf/arm.urdf"/>
  <node pkg="gazebo_ros" type="spawn_model" name="a" args="-urdf -param robot_description
    -model one -x=1 -J turn 0.5 -J one::foot 2 -J absent 1"/>
  <node pkg="gazebo_ros" type="spawn_model" name="b" args="-urdf -param robot_description
    -model two -y 3 -reference_frame one::beam -J two::turn 7 -unpause -wait one"/>
  <node pkg="gazebo_ros" type="spawn_model" name="c" args="-urdf -param robot_description
    -model three -reference_frame nowhere"/>
  <node pkg="gazebo_ros" type="spawn_model" name="d" args="-sdf -database pole -model pole -y 5"/>
  <node pkg="gazebo_ros" type="spawn_model" name="e" args="-sdf -database lost -model lost"/>
</launch>"""


def test_a_launch_file_places_models_and_joints(package: Path) -> None:
    (package / "urdf/arm.urdf").write_text(ARM)
    (package / "models/pole").mkdir(parents=True)
    pole = HALL[HALL.index("<model") : HALL.index("</world>")]
    (package / "models/pole/model.sdf").write_text(f'<sdf version="1.6">{pole}</sdf>')
    file = package / "launch/placed.launch"
    file.write_text(PLACED)
    with cw.launch(file) as world:
        assert world.models[1:] == ("one", "pole", "two")
        assert world.model("pole").pose.y == 5.0
        assert world.model("one").joint("turn") == pytest.approx(0.5)
        # At most the limit, as in Gazebo.
        assert world.model("two").joint("turn") == pytest.approx(1.0)
        pose = world.model("two").pose
        at = (2.0 - 3.0 * math.sin(0.5), 3.0 * math.cos(0.5))
        assert (pose.x, pose.y) == pytest.approx(at)
        found = coded(world.diagnostics, ENTITY_UNKNOWN)
        assert sorted(str(each.values["name"]) for each in found) == ["absent", "nowhere"]
        (lost,) = coded(world.diagnostics, LAUNCH_VALUE_UNKNOWN)
        assert (lost.values["what"], lost.values["name"]) == ("model", "lost")


CREATED = """
def generate_launch_description():
    share = get_package_share_directory("carts")
    cart = Command(["xacro ", share, "/urdf/cart.xacro"])
    return [
        Node(package="robot_state_publisher", executable="robot_state_publisher",
             parameters=[{"robot_description": cart}]),
        Node(package="ros_gz_sim", executable="create",
             arguments=["--topic", "robot_description", "--name=bot", "-x", "1"]),
        Node(package="ros_gz_sim", executable="create",
             parameters=[{"topic": "robot_description", "name": "bot", "x": 2.0,
                          "allow_renaming": True}]),
        Node(package="ros_gz_sim", executable="create",
             arguments=["-topic", "robot_description", "-name", "bot", "-x", "3",
                        "-allow_renaming", "true"]),
        Node(package="ros_gz_sim", executable="create",
             arguments=["-topic", "robot_description", "-name", "bot",
                        "-allow_renaming=false"]),
    ]
"""


def test_gz_models_have_names_and_places_from_all_kinds_of_arguments(package: Path) -> None:
    file = package / "launch/created.launch.py"
    file.write_text(CREATED)
    with cw.launch(file) as world:
        assert world.models[1:] == ("bot", "bot_0", "bot_1")
        assert [world.model(name).pose.x for name in world.models[1:]] == [1.0, 2.0, 3.0]
        assert len(coded(world.diagnostics, MODEL_NAME_TAKEN)) == 1


def test_the_launch_file_starts_the_controllers_that_it_names(package: Path) -> None:
    with cw.launch(package / "launch/slider.launch.py") as world:
        world.publish("/good/commands", data=[0.5])
        world.run(1.0)
        assert world.model("slider").joint("slide") == pytest.approx(0.5, abs=1e-3)
        assert "/other/commands" not in {each.name for each in world.session.graph.topics()}


@pytest.mark.parametrize(
    ("starts", "severity"),
    [
        ('ExecuteProcess(cmd=["ros2", "control", "load_controller", "good"])', "warning"),
        (
            'ExecuteProcess(cmd=["ros2 control load_controller good --set-state inactive"])',
            "info",
        ),
        (
            'Node(package="controller_manager", executable="spawner",'
            ' arguments=["good", "--inactive"])',
            "info",
        ),
    ],
)
def test_a_controller_that_is_only_loaded_commands_no_joint(
    package: Path, starts: str, severity: str
) -> None:
    file = package / "launch/slider.launch.py"
    spawner = 'Node(package="controller_manager", executable="spawner", arguments=["good"])'
    assert spawner in STARTER
    file.write_text(STARTER.replace(spawner, starts))
    (package / "config/control.yaml").write_text(
        CONTROLLERS.replace(
            "    other: {type: position_controllers/JointGroupPositionController}\n", ""
        )
    )
    with cw.launch(file) as world:
        (found,) = coded(world.diagnostics, CONTROLLER_ONLY_LOADED)
        assert found.severity == severity
        assert found.values["controller"] == "good"
        world.publish("/good/commands", data=[0.5])
        world.run(0.5)
        slider = world.model("slider")
        assert slider.joint("slide") == pytest.approx(0.0, abs=1e-3)
        (listed,) = world.call("/controller_manager/list_controllers").controller
        assert (listed.name, listed.state) == ("good", "inactive")
        state = world.save()
        switch = world.call(
            "/controller_manager/switch_controller", activate_controllers=["good"], strictness=2
        )
        assert switch.ok
        world.publish("/good/commands", data=[0.5])
        world.run(1.0)
        assert slider.joint("slide") == pytest.approx(0.5, abs=1e-3)
        world.restore(state)
        (listed,) = world.call("/controller_manager/list_controllers").controller
        assert listed.state == "inactive"


@pytest.mark.parametrize(
    "bridge",
    [
        'RosGzBridge(bridge_name="b", config_file=CONFIG)',
        'Node(package="ros_gz_bridge", executable="parameter_bridge",'
        ' arguments=["--ros-args", "-p", ["config_file:=", CONFIG]])',
        'Node(package="ros_gz_bridge", executable="bridge_node",'
        ' parameters=[{"config_file": CONFIG}])',
        'Node(package="ros_gz_bridge", executable="parameter_bridge", namespace="robot",'
        ' arguments=["/model/gz/odometry@nav_msgs/msg/Odometry[gz.msgs.Odometry"],'
        ' remappings=[("/model/gz/odometry", "odom")])',
    ],
)
def test_topics_have_the_names_that_the_bridge_of_a_launch_file_gives(
    package: Path, bridge: str
) -> None:
    (package / "config/bridge.yaml").write_text(BRIDGE)
    place = 'os.path.join(get_package_share_directory("carts"), "config", "bridge.yaml")'
    text = STARTER.replace("    return [", f"    {bridge.replace('CONFIG', place)}\n    return [")
    text = text.replace("slider.urdf", "gz.urdf")
    (package / "urdf/gz.urdf").write_text(GZ)
    (package / "launch/gz.launch.py").write_text(text)
    with cw.launch(package / "launch/gz.launch.py") as world:
        topics = {each.name for each in world.session.graph.topics()}
    assert "/robot/odom" in topics and "/model/gz/odometry" not in topics


@pytest.mark.parametrize(
    "words",
    [
        '"--controller-ros-args", "-r ~/commands:=/go --remap a:=b"',
        '"--controller-ros-args=-r /good/commands:=/go"',
        '"--controller-ros-args", "-r a:=b", "--controller-ros-args", "-r ~/commands:=/go"',
    ],
)
def test_a_spawner_renames_topics_of_its_controller(package: Path, words: str) -> None:
    file = package / "launch/slider.launch.py"
    assert '["good"]' in STARTER
    file.write_text(STARTER.replace('["good"]', f'["good", {words}]'))
    with cw.launch(file) as world:
        state = world.save()
        world.publish("/go", data=[0.5])
        world.run(1.0)
        assert world.model("slider").joint("slide") == pytest.approx(0.5, abs=1e-3)
        assert "/good/commands" not in {each.name for each in world.session.graph.topics()}
        world.model("slider").delete()
        world.restore(state)
        assert "/go" in {each.name for each in world.session.graph.topics()}


@pytest.mark.parametrize(
    "bridge",
    [
        '<ros_gz_bridge bridge_name="b" config_file="CONFIG"/>',
        '<node pkg="ros_gz_bridge" exec="parameter_bridge">'
        '<param name="config_file" value="CONFIG"/></node>',
    ],
)
def test_the_bridge_of_a_launch_file_in_xml(package: Path, bridge: str) -> None:
    (package / "config/bridge.yaml").write_text(BRIDGE)
    (package / "urdf/gz.urdf").write_text(GZ)
    share = "$(find-pkg-share carts)"
    file = package / "launch/gz.launch.xml"
    file.write_text(
        f"""<launch><node pkg="ros_gz_sim" exec="create" args="-file {share}/urdf/gz.urdf"/>
        {bridge.replace("CONFIG", f"{share}/config/bridge.yaml")}</launch>"""
    )
    with cw.launch(file) as world:
        topics = {each.name for each in world.session.graph.topics()}
    assert "/robot/odom" in topics and "/model/gz/odometry" not in topics


def test_another_world_and_arguments(package: Path) -> None:
    file = package / "launch/two.launch"
    with cw.launch(file, world="empty") as world:
        assert "pillar" not in world.models
    with cw.launch(file, {"arena": "worlds/willow.world"}) as world:
        (found,) = coded(world, LAUNCH_WORLD_ABSENT)
        assert found.values == {"name": "worlds/willow.world"}
        assert "left" in world.models
    with cw.launch(file, {"arena": "worlds/mud.world"}) as world:
        assert not coded(world, LAUNCH_WORLD_ABSENT)
    with raises(LAUNCH_WORLD_ABSENT):
        cw.launch(file, {"arena": "worlds/willow.world"}, strict=True)
    with raises(ARGUMENT_UNKNOWN):
        cw.launch(file, {"aerna": "mud"})


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        ("-r empty.sdf", "empty"),
        ("-r -v4 shapes.sdf", "shapes"),
        ("/usr/share/gz/worlds/empty.sdf", "empty"),
        ("", "default"),
    ],
)
def test_a_world_of_new_gazebo_has_its_name(package: Path, arguments: str, name: str) -> None:
    file = package / "launch/gz.launch.xml"
    file.write_text(
        f"""<launch><include file="$(find-pkg-share ros_gz_sim)/launch/gz_sim.launch.py">
        <arg name="gz_args" value="{arguments}"/></include>
        <node pkg="ros_gz_sim" exec="create" args="-file $(find-pkg-share carts)/urdf/gz.urdf"/>
        </launch>"""
    )
    (package / "urdf/gz.urdf").write_text(GZ)
    with cw.launch(file) as world:
        assert world.session.simulation.engine.world.name == name


def test_a_published_model_that_the_world_contains_is_not_spawned(package: Path) -> None:
    file = package / "launch/show.launch"
    file.write_text("\n".join(line for line in TWO.split("\n") if "-param" not in line and
                              "spawn_model" not in line))  # fmt: skip
    with cw.launch(file) as world:
        assert world.models == ("pillar", "cart")
    (package / "urdf/cart.xacro").write_text(CART.replace('name="cart"', 'name="pillar"'))
    with cw.launch(file) as world:
        assert world.models == ("pillar",)
    with cw.launch(file, world="empty") as world:
        assert world.models == ("ground_plane", "pillar")


IN_WORLD = """<sdf version="1.8"><world name="hall"><model name="slider">
<link name="base"><inertial><mass>5</mass></inertial></link>
<link name="bar"><inertial><mass>1</mass></inertial></link>
<joint name="foot" type="fixed"><parent>world</parent><child>base</child></joint>
<joint name="slide" type="prismatic"><parent>base</parent><child>bar</child><axis><xyz>1 0 0</xyz>
<limit><lower>-1</lower><upper>1</upper><effort>100</effort></limit></axis></joint>
<plugin filename="gz_ros2_control-system" name="gz_ros2_control::GazeboSimROS2ControlPlugin"/>
</model></world></sdf>"""
PUBLISHED = """
        IncludeLaunchDescription(
            PythonLaunchDescriptionSource(
                [FindPackageShare("ros_gz_sim"), "/launch/gz_sim.launch.py"]),
            launch_arguments={"gz_args": ["-r ", share, "/worlds/hall.world"]}.items()),
        Node(package="robot_state_publisher", executable="robot_state_publisher",
             parameters=[{"robot_description": Command(["xacro ", share, "/urdf/slider.urdf"])}]),
        Node(package="robot_state_publisher", executable="robot_state_publisher", namespace="cart",
             parameters=[{"robot_description": Command(["xacro ", share, "/urdf/cart.xacro"])}]),
"""


@pytest.mark.parametrize(
    "source", ['"-topic", "cart/robot_description"', '"-file", share + "/urdf/cart.xacro"', ""]
)
def test_a_published_model_of_the_world_and_spawned_ones_are_all_there(
    package: Path, source: str
) -> None:
    """Without a spawner, the second published model is in no world, as in Gazebo."""
    (package / "worlds/hall.world").write_text(IN_WORLD)
    line = next(each for each in STARTER.split("\n") if '"create"' in each)
    create = f"""Node(package="ros_gz_sim", executable="create",
             arguments=["-name", "two", "-y", "3", {source}]),"""
    text = STARTER.replace(line, PUBLISHED + (create if source else ""))
    file = package / "launch/both.launch.py"
    file.write_text("\n".join(each for each in text.split("\n") if "process_file" not in each))
    with cw.launch(file) as world:
        assert sorted(world.models) == ["slider", *["two"] * bool(source)]
        world.publish("/good/commands", data=[0.5])
        world.run(1.0)
        assert world.model("slider").joint("slide") == pytest.approx(0.5, abs=1e-3)
        if source:
            assert world.model("two").pose.y == pytest.approx(3.0)
        assert not coded(world, MODEL_NAME_TAKEN)


def test_a_model_whose_name_is_taken_is_not_spawned(package: Path) -> None:
    with cw.launch(package / "launch/twins.launch") as world:
        assert world.models == ("pillar", "left")
        assert world.model("left").pose.y == pytest.approx(2.0)
        assert [each.values for each in coded(world, MODEL_NAME_TAKEN)] == [{"name": "left"}]
    text = TWO.replace("-model left", "-model pillar").replace("NAME", "right")
    (package / "launch/two.launch").write_text(text)
    with cw.launch(package / "launch/two.launch") as world:
        assert world.models == ("pillar", "right")
        assert coded(world, MODEL_NAME_TAKEN)


def test_errors_of_a_launch_file(package: Path) -> None:
    with raises(NOT_A_DESCRIPTION):
        cw.launch(package / "urdf/cart.xacro")
    with raises(NOT_A_DESCRIPTION):
        cw.World().spawn(package / "launch/slider.launch.py")
    (package / "launch/two.launch").write_text(TWO.replace("$(arg arena)", "$(env NO_SUCH_ARENA)"))
    with cw.launch(package / "launch/two.launch") as world:
        assert [each.values for each in coded(world, LAUNCH_VALUE_UNKNOWN)] == [{"what": "world"}]


@pytest.mark.parametrize(
    ("outside", "inside", "manager"),
    [("", "drives/", "/"), ("drives", "", "/drives")],
    ids=["path", "namespace"],
)
def test_a_spawner_of_ros1_names_a_controller_by_its_path(
    tmp_path: Path, outside: str, inside: str, manager: str
) -> None:
    """Its topics are below this path, in the namespace of the controller manager."""
    space = f"<robotNamespace>{manager}</robotNamespace></plugin></gazebo>"
    parts = managed("Velocity").replace("/></gazebo>", f">{space}")
    written(tmp_path, cart(), parts)
    (tmp_path / "package.xml").write_text("<package><name>cart</name></package>")
    (tmp_path / "drives.yaml").write_text(
        "drives:\n  base:\n    type: diff_drive_controller/DiffDriveController\n"
        "    left_wheel: left_joint\n    right_wheel: right_joint\n"
        "    wheel_separation: 0.2\n    wheel_radius: 0.05\n"
    )
    launch = tmp_path / "sim.launch"
    launch.write_text(f"""<launch>
      <rosparam file="$(find cart)/drives.yaml"/>
      <param name="robot_description" textfile="$(find cart)/robot.urdf"/>
      <node pkg="gazebo_ros" type="spawn_model" name="s" args="-param robot_description"/>
      <node pkg="controller_manager" type="spawner" name="c" ns="{outside}"
        args="{inside}base"/>
    </launch>""")
    with cw.launch(launch) as world:
        world.run(0.1)
        names = {topic.name for topic in world.session.graph.topics()}
        found = {name for name in names if name.endswith("/cmd_vel")}
        assert found == {"/drives/base/cmd_vel"}
