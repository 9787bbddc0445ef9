"""The controllers and the hardware that launch files and other files near a robot name."""

from pathlib import Path

import pytest
from tests.coded import coded
from tests.dialects.ros_control.arms import beam, robot, ros2_joint, ros2_system, transmission

import cartwheel as cw
from cartwheel.codes.devices import (
    CONTROL_ELSEWHERE,
    CONTROLLER_UNDEFINED,
    CONTROLLERS_FILE_UNREADABLE,
    CONTROLLERS_NOT_FOUND,
)
from cartwheel.corpus import try_robot
from cartwheel.description import load_robot, load_world
from cartwheel.description.launches import launches_near
from cartwheel.dialects.ros_control import selection
from cartwheel.dialects.ros_control.selection import with_published_control

SDF = """<sdf version="1.9"><model name="arm">
  <joint name="foot" type="fixed"><parent>world</parent><child>base</child></joint>
  <link name="base"/>
  <link name="beam"><inertial><mass>1</mass></inertial></link>
  <joint name="beam_joint" type="revolute"><parent>base</parent><child>beam</child>
    <axis><xyz>0 0 1</xyz><limit><lower>-1</lower><upper>1</upper></limit></axis></joint>
  {plugin}</model></sdf>"""
ROS2 = (
    '<plugin filename="gz_ros2_control-system" name="gz_ros2_control::GazeboSimROS2ControlPlugin">'
    "<parameters>{file}</parameters></plugin>"
)
ROS1 = '<plugin filename="libgazebo_ros_control.so" name="control"/>'
CONTROLLERS = """
controller_manager:
  ros__parameters:
    arm_controller: {type: position_controllers/JointGroupPositionController}
arm_controller:
  ros__parameters:
    joints: [beam_joint]
"""
LAUNCH = """<launch>
  <param name="robot_description" command="xacro $(find arm)/robots/{name}"/>
  <node pkg="gazebo_ros" type="spawn_model" name="s" args="-sdf -file $(find arm)/{model}"/>
</launch>"""
SYSTEM = ros2_system(ros2_joint("beam_joint"))


@pytest.fixture
def model(tmp_path):
    """Writes a package with an SDF model and other files, and returns the path of the model."""

    def write(plugin, **files):
        folder = tmp_path / "arm"
        texts = {
            name.replace("__", "/").replace("_dot_", "."): text for name, text in files.items()
        }
        controllers = folder / "config/arm.yaml"
        texts |= {
            "package.xml": "<package><name>arm</name></package>",
            "config/arm.yaml": CONTROLLERS,
            "models/arm_v2/model.sdf": SDF.format(plugin=plugin.format(file=controllers)),
        }
        for name, text in texts.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_text(text)
        return folder / "models/arm_v2/model.sdf"

    return write


@pytest.mark.parametrize(
    "name",
    ["arm_v2_dot_urdf", "arm_dot_urdf", "urdf__model_dot_xacro", "urdf__arm_dot_urdf_dot_xacro"],
)
def test_the_urdf_beside_a_model_lists_the_joints_of_its_controllers(model, name):
    path = model(ROS2, **{f"models__arm_v2__{name}": robot(beam("beam", "world") + SYSTEM, "")})
    with cw.World("empty") as world:
        arm = world.spawn(path)
        (found,) = coded(world, CONTROL_ELSEWHERE)
        assert found.values["joints"] == ("beam_joint",)
        world.publish("/arm_controller/commands", data=[0.5])
        world.run(1.0)
        assert arm.joint("beam_joint") == pytest.approx(0.5, abs=1e-3)


def test_the_launch_file_that_spawns_a_model_names_its_urdf(model):
    """Other descriptions with these joints are those of other models."""
    given = {"name": "other.urdf", "model": "models/arm_v2/model.sdf"}
    held = transmission("beam_joint", "Position")
    path = model(
        ROS1,
        launch__a_dot_launch=LAUNCH.format(**given | {"name": "third.urdf", "model": "b.sdf"}),
        launch__sim_dot_launch=LAUNCH.format(**given),
        robots__other_dot_urdf=robot(beam("beam", "world") + held, ""),
        robots__third_dot_urdf=robot(
            beam("beam", "world") + held.replace("Position", "Effort"), ""
        ),
    )
    found = with_published_control(load_robot(path))
    assert [each.find("type").text for each in found.transmissions] == [
        "transmission_interface/SimpleTransmission"
    ]
    (note,) = coded(found, CONTROL_ELSEWHERE)
    assert note.values["file"].endswith("other.urdf")


def test_packages_with_robots_of_the_same_name_do_not_hide_the_own_urdf(model):
    file = model(ROS2, models__arm_v2__arm_dot_urdf=robot(beam("beam", "world") + SYSTEM, ""))
    other = robot(beam("other", "world") + ros2_system(ros2_joint("other_joint")), "")
    for number in range(20):
        package = file.parents[3] / f"a{number}"
        (package / "launch").mkdir(parents=True)
        (package / "package.xml").write_text(f"<package><name>a{number}</name></package>")
        (package / "arm.urdf").write_text(other)
        (package / "launch/arm.launch").write_text(
            '<launch><param name="robot_description" '
            f'textfile="$(find a{number})/arm.urdf"/></launch>'
        )
    found = with_published_control(load_robot(file))
    (system,) = found.ros2_control
    assert "beam_joint" in {each.attribute("name") for each in system.find_all("joint")}


@pytest.mark.parametrize(
    "urdf",
    [
        robot(beam("beam", "world"), ""),
        robot(beam("beam", "world") + ros2_system(ros2_joint("other_joint")), ""),
        "<robot",
    ],
)
def test_a_urdf_of_another_robot_is_not_used(model, urdf):
    described = load_robot(model(ROS2, models__arm_v2__arm_dot_urdf=urdf))
    assert with_published_control(described) is described


def test_a_model_with_its_own_hardware_or_without_controllers_stays_as_it_is(model):
    urdf = robot(beam("beam", "world") + SYSTEM, "")
    for plugin in (SYSTEM + ROS2, ""):
        described = load_robot(model(plugin, models__arm_v2__arm_dot_urdf=urdf))
        assert with_published_control(described) is described
    other = load_robot(described.origin.file.replace("model.sdf", "arm.urdf"))
    assert with_published_control(other) is other


WORLD = '<sdf version="1.9"><world name="hall">{}</world></sdf>'
STARTED = """<launch>
  <param name="robot_description" command="xacro $(find arm)/robots/other.urdf"/>
  <include file="$(find gazebo_ros)/launch/empty_world.launch">
    <arg name="world_name" value="{place}/worlds/hall.world"/>
  </include>
  <rosparam file="$(find arm)/config/good.yaml"/>
  <node pkg="controller_manager" type="spawner" name="s" args="good"/>
</launch>"""


def in_world(plugin, *, x=0.0):
    """A world that contains the model."""
    held = SDF.format(plugin=plugin).replace(
        '<model name="arm">', f"<model name='arm'><pose>{x} 0 0 0 0 0</pose>"
    )
    return WORLD.format(held.partition(">")[2].removesuffix("</sdf>"))


@pytest.mark.parametrize("name", ["worlds__arm_dot_urdf", "urdf__arm_dot_urdf_dot_xacro"])
def test_the_urdf_of_a_model_in_a_world_lists_the_joints_of_its_controllers(model, name):
    urdf = robot(beam("beam", "world") + SYSTEM, "")
    path = model(ROS2, **{name: urdf}).parents[2]
    world_file = path / "worlds/hall.world"
    world_file.parent.mkdir(exist_ok=True)
    world_file.write_text(in_world(ROS2.format(file=path / "config/arm.yaml")))
    with cw.World(world_file) as world:
        assert len(coded(world, CONTROL_ELSEWHERE)) == 1
        world.publish("/arm_controller/commands", data=[0.5])
        world.run(1.0)
        assert world.model("arm").joint("beam_joint") == pytest.approx(0.5, abs=1e-3)


@pytest.mark.parametrize(("spawned", "driven"), [("arm", True), ("other", False)])
def test_a_model_in_a_saved_world_has_the_hardware_of_the_urdf_that_was_spawned(
    model, spawned, driven
):
    """Neither the launch file nor the name of the URDF refers to the world."""
    launch = f"""<launch>
      <param name="robot_description" command="xacro $(find arm)/urdf/robot.urdf.xacro"/>
      <node pkg="gazebo_ros" type="spawn_model" name="s"
        args="-urdf -param robot_description -model {spawned}"/></launch>"""
    urdf = robot(beam("beam", "world") + SYSTEM, "")
    files = {"launch__sim_dot_launch": launch, "urdf__robot_dot_urdf_dot_xacro": urdf}
    path = model(ROS2, **files).parents[2]
    world_file = path / "worlds/hall.world"
    world_file.parent.mkdir(exist_ok=True)
    world_file.write_text(in_world(ROS2.format(file=path / "config/arm.yaml")))
    found = selection.world_with_published_control(load_world(world_file))
    assert bool(found.models[0].ros2_control) == driven


def test_launch_files_are_read_once_for_all_models_of_a_world(model, monkeypatch):
    path = model(ROS2, worlds__arm_dot_urdf=robot(beam("beam", "world") + SYSTEM, "")).parents[2]
    world_file = path / "worlds/hall.world"
    one = in_world(ROS2.format(file=path / "config/arm.yaml"))
    held = one.partition('name="hall">')[2].removesuffix("</world></sdf>")
    world_file.write_text(WORLD.format(held + held.replace("name='arm'", "name='second'")))
    read = []
    monkeypatch.setattr(selection, "launches_near", lambda *given: read.append(given) or ())
    found = selection.world_with_published_control(load_world(world_file))
    assert len(read) == 1
    assert [bool(each.ros2_control) for each in found.models] == [True, False]


@pytest.mark.parametrize("place", ["$(find arm)", "/home/them/ws/src/arm"])
def test_a_launch_file_starts_the_controllers_of_a_model_in_its_world(model, place):
    """The world is in the package, although its path may be that of another computer."""
    held = transmission("beam_joint", "Position")
    path = model(
        ROS1,
        launch__hall_dot_launch=STARTED.format(place=place),
        worlds__hall_dot_world=in_world(ROS1, x=2.0),
        robots__other_dot_urdf=robot(beam("beam", "world") + held, ""),
        config__good_dot_yaml=ONE.format(name="good", joint="beam"),
    ).parents[2]
    with cw.launch(path / "launch/hall.launch") as world:
        assert world.models == ("arm",)
        assert len(coded(world, CONTROL_ELSEWHERE)) == 1
        assert world.model("arm").pose.x == pytest.approx(2.0)
        world.publish("/good/command", data=0.5)
        world.run(1.0)
        assert world.model("arm").joint("beam_joint") == pytest.approx(0.5, abs=1e-3)


def test_it_starts_those_of_a_model_that_lists_its_joints_itself(model):
    path = model(
        ROS1,
        launch__hall_dot_launch=STARTED.format(place="$(find arm)")
        .replace("other.urdf", "arm.urdf")
        .replace("good.yaml", "arm.yaml")
        .replace("good", "arm_controller"),
        worlds__hall_dot_world=in_world(
            SYSTEM + '<plugin filename="gz_ros2_control-system" name="control"/>'
        ),
        robots__arm_dot_urdf=robot(beam("beam", "world"), ""),
    ).parents[2]
    with cw.launch(path / "launch/hall.launch") as world:
        assert world.models == ("arm",)
        world.publish("/arm_controller/commands", data=[0.5])
        world.run(1.0)
        assert world.model("arm").joint("beam_joint") == pytest.approx(0.5, abs=1e-3)


def test_a_launch_file_that_describes_another_robot_leaves_the_world_as_it_is(model):
    held = transmission("other_joint", "Position")
    path = model(
        ROS1,
        launch__hall_dot_launch=STARTED.format(place="$(find arm)"),
        worlds__hall_dot_world=in_world(ROS1),
        robots__other_dot_urdf=robot(beam("other", "world") + held, "").replace(
            'name="arm"', 'name="second"'
        ),
        config__good_dot_yaml=ONE.format(name="good", joint="beam"),
    ).parents[2]
    with cw.launch(path / "launch/hall.launch") as world:
        assert not coded(world, CONTROL_ELSEWHERE)
        assert world.models == ("arm", "second")


STARTER = """<launch>
  <param name="robot_description" command="xacro $(find arm)/robots/arm.urdf"/>
  <rosparam file="$(find arm)/config/good.yaml"/><rosparam file="$(find arm)/config/bad.yaml"/>
  <rosparam file="$(find arm)/config/other.yaml"/>
  <node pkg="controller_manager" type="spawner" name="s" args="good bad"/>
</launch>"""
STATES = "good: {type: joint_state_controller/JointStateController, publish_rate: 50}"
ONE = "{name}: {{type: position_controllers/JointPositionController, joint: {joint}_joint}}"


def test_an_unreadable_controller_file_of_a_launch_file_is_reported(model, tmp_path):
    body = beam("beam", "world") + beam("tip", "beam", origin="0 0 0.5")
    held = transmission("beam_joint", "Position") + transmission("tip_joint", "Position")
    model(
        "",
        launch__sim_dot_launch=STARTER,
        robots__arm_dot_urdf=robot(body + held, ROS1),
        config__good_dot_yaml=ONE.format(name="good", joint="beam"),
        config__bad_dot_yaml=ONE.format(name="bad", joint="tip") + "\nx: [",
        config__other_dot_yaml="moveit: [",
    )
    path = tmp_path / "arm/robots/arm.urdf"
    with cw.World("empty") as world:
        world.spawn(path, controllers="auto")
        (found,) = coded(world, CONTROLLERS_FILE_UNREADABLE)
        assert found.origin.file.endswith("bad.yaml")
        assert found.values["controllers"] == ("bad",)
    verdict = try_robot(path, standing=1.0)
    assert verdict.controllers == ("good",)
    (fault,) = verdict.faults
    assert (fault.test, fault.subject, fault.source) == ("controller", "bad", "file")
    assert fault.code is CONTROLLERS_FILE_UNREADABLE


@pytest.mark.parametrize(
    "tag", [ROS1, ROS1.replace("/>", "><parameters>{file}</parameters></plugin>")]
)
def test_a_controller_that_only_a_launch_file_names_is_reported(model, tmp_path, tag):
    good = tmp_path / "arm/config/good.yaml"
    model(
        "",
        launch__sim_dot_launch=STARTER,
        robots__arm_dot_urdf=robot(
            beam("beam", "world") + transmission("beam_joint", "Position"), tag.format(file=good)
        ),
        config__good_dot_yaml=STATES,
    )
    path = tmp_path / "arm/robots/arm.urdf"
    with cw.World("empty") as world:
        world.spawn(path, controllers="auto")
        (found,) = coded(world, CONTROLLER_UNDEFINED)
        assert found.values["controller"] == "bad"
        assert [Path(each).name for each in found.values["absent"]] == ["bad.yaml", "other.yaml"]
        assert found.origin.file.endswith("sim.launch")
    verdict = try_robot(path, standing=1.0)
    assert [(each.subject, each.code) for each in verdict.faults] == [("bad", CONTROLLER_UNDEFINED)]


@pytest.mark.parametrize(
    "parameters",
    [
        "<rosparam>bad: {}</rosparam>",
        '<rosparam file="$(find arm)/config/one.yaml" ns="bad"/>',
        '<rosparam file="$(find arm)/config/absent.yaml" ns="arm/bad"/>',
    ],
)
def test_a_controller_whose_parameters_a_launch_file_names_is_not_reported(
    model, tmp_path, parameters
):
    held = beam("beam", "world") + transmission("beam_joint", "Position")
    model(
        "",
        launch__sim_dot_launch=STARTER.replace("</launch>", f"{parameters}</launch>"),
        robots__arm_dot_urdf=robot(held, ROS1),
        config__good_dot_yaml=ONE.format(name="good", joint="beam"),
    )
    with cw.World("empty") as world:
        world.spawn(tmp_path / "arm/robots/arm.urdf", controllers="auto")
        assert not coded(world, CONTROLLER_UNDEFINED)


ABSENT = '<rosparam file="$(find {package})/config/absent.yaml"{ns}/>'


@pytest.mark.parametrize(
    ("parameters", "reported"),
    [
        (ABSENT.format(package="arm", ns=' ns="arm/bad"'), True),
        (ABSENT.format(package="other", ns=' ns="arm/bad"'), False),
        (ABSENT.format(package="arm", ns=' ns="arm/idle"'), False),
        (ABSENT.format(package="arm", ns=""), False),
        (ABSENT.format(package="arm", ns=' ns="bad"').replace("absent", "$(env X)"), False),
    ],
    ids=["absent", "package", "idle", "several", "unknown"],
)
def test_a_missing_file_with_the_parameters_of_a_started_controller_is_reported(
    model, tmp_path, parameters, reported
):
    held = beam("beam", "world") + transmission("beam_joint", "Position")
    model(
        "",
        launch__sim_dot_launch=STARTER.replace("</launch>", f"\n{parameters}</launch>"),
        robots__arm_dot_urdf=robot(held, ROS1),
        config__good_dot_yaml=STATES,
    )
    path = tmp_path / "arm/robots/arm.urdf"
    for found in (try_robot(path, standing=1.0).observed, cw.check(path).findings):
        unread = [each for each in found if each.code is CONTROLLERS_FILE_UNREADABLE]
        assert [each.values["controllers"] for each in unread] == [("bad",)] * reported
        assert [each.origin.line for each in unread] == [7] * reported
        assert not any(each.code is CONTROLLERS_NOT_FOUND for each in found)
    if reported:
        faults = try_robot(path, standing=1.0).faults
        assert [(each.subject, each.code) for each in faults] == [
            ("bad", CONTROLLERS_FILE_UNREADABLE)
        ]


@pytest.mark.parametrize("joint", ["beam", "wheel"])
def test_controllers_that_a_distant_launch_file_starts_are_only_those_of_the_robot(tmp_path, joint):
    """A copy of a robot in a group of packages without controllers, which no launch file starts."""
    held = beam("beam", "world") + transmission("beam_joint", "Position")
    texts = {
        "sims/arms/package.xml": "<package><name>arms</name></package>",
        "sims/arms/models/arm.urdf": robot(held, ROS1),
    }
    for package, driven in (("a", "door"), ("b", joint)):
        texts |= {
            f"robots/{package}/package.xml": f"<package><name>{package}</name></package>",
            f"robots/{package}/config/good.yaml": ONE.format(name="good", joint=driven),
            f"robots/{package}/launch/control.launch": STARTER.replace(
                "arm)", f"{package})"
            ).replace("good bad", "good"),
        }
    for name, text in texts.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    verdict = try_robot(
        tmp_path / "sims/arms/models/arm.urdf", launches=launches_near(tmp_path), standing=1.0
    )
    assert verdict.controllers == (("good",) if joint == "beam" else ())
    codes = [each.code for each in verdict.faults]
    assert codes == ([] if joint == "beam" else [CONTROLLERS_NOT_FOUND])


SPAWNER = '<node pkg="controller_manager" type="spawner" name="s" args="good"/>'
DRIVE = (
    '<plugin name="drive" filename="libgazebo_ros_diff_drive.so"><leftJoint>beam_joint</leftJoint>'
    "<rightJoint>tip_joint</rightJoint></plugin>"
)


@pytest.mark.parametrize(
    ("plugins", "spawner", "started"),
    [(ROS1 + DRIVE, "", False), (ROS1 + DRIVE, SPAWNER, True), (ROS1, "", True)],
    ids=["driven", "spawned", "only control"],
)
def test_controllers_of_driven_wheels_that_a_launch_file_only_loads_are_not_started(
    model, tmp_path, plugins, spawner, started
):
    body = beam("beam", "world") + beam("tip", "world") + transmission("beam_joint", "Position")
    model(
        "",
        launch__sim_dot_launch=STARTER.replace(STARTER.splitlines()[4], spawner),
        robots__arm_dot_urdf=robot(body, plugins),
        config__good_dot_yaml=ONE.format(name="good", joint="beam"),
    )
    verdict = try_robot(tmp_path / "arm/robots/arm.urdf", standing=0.1)
    assert verdict.controllers == ("good",) * started
