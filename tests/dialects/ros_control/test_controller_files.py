"""Parameter files as launch files and ROS 2's parameter parser read them."""

from pathlib import Path

import pytest
from tests.dialects.ros_control.arms import ROS1, beam, robot, ros2_joint, ros2_plugin, transmission
from tests.dialects.ros_control.arms import ros2_system as system

import cartwheel as cw
from cartwheel.checks.controller_files import ControlFile
from cartwheel.codes import devices, files, graph, running
from cartwheel.description import load_robot
from cartwheel.dialects.ros_control.files import ControllerFiles, read_parameters, ros2_file
from cartwheel.dialects.ros_control.substitution import substitute
from cartwheel.errors import PluginError

GROUP = "position_controllers/JointGroupPositionController"


def started(world):
    return [each.name for each in world.session.shared.get(ControllerFiles).started]


def warnings(world):
    return [d for d in world.diagnostics if d.severity != "info"]


@pytest.fixture
def spawn(tmp_path):
    """Writes a robot with a joint ``beam_joint`` and its files, and spawns it."""
    worlds = []

    def made(*files, given=(), namespace="", prefix="", arguments=None):
        paths = []
        for number, text in enumerate((*files, *given)):
            paths.append(tmp_path / f"file{number}.yaml")
            paths[-1].write_text(text)
        own = paths[: len(files)]
        body = beam(f"{prefix}beam", "world") + system(ros2_joint(f"{prefix}beam_joint"))
        text = robot(body, ros2_plugin(*own, namespace=namespace))
        if prefix:
            head = '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="arm"><xacro:arg'
            head += ' name="tf_prefix" default=""/>'
            text = text.replace('<robot name="arm">', head).replace(prefix, "$(arg tf_prefix)")
        file = tmp_path / ("arm.xacro" if prefix else "arm.urdf")
        file.write_text(text)
        world = cw.World("empty")
        worlds.append(world)
        described = load_robot(file, arguments=arguments) if arguments else file
        world.spawn(described, controllers=paths[len(files) :])
        world.run(0.1)
        return world

    yield made
    for each in worlds:
        each.close()


def test_a_wildcard_holds_the_manager_and_what_all_share(spawn):
    world = spawn(f"""
/**:
  ros__parameters:
    use_sim_time: true
    update_rate: 50
    states: {{type: joint_state_broadcaster/JointStateBroadcaster}}
    group: {{type: {GROUP}}}
    joints: [beam_joint]
""")
    assert started(world) == ["states", "group"]
    box = world.mailbox("/joint_states", size=1000)
    world.run(1.0)
    assert len(box.drain()) == pytest.approx(50, abs=1)
    # What is for all and means nothing to one is no fault of that one.
    assert warnings(world) == []


def test_a_file_that_is_missing_costs_what_it_would_start(tmp_path):
    file = tmp_path / "there.yaml"
    file.write_text(
        f"controller_manager: {{ros__parameters: {{group: {{type: {GROUP}}}}}}}\n"
        "group: {ros__parameters: {joints: [beam_joint]}}"
    )
    body = beam("beam", "world") + system(ros2_joint("beam_joint"))
    urdf = tmp_path / "arm.urdf"
    urdf.write_text(robot(body, ros2_plugin(tmp_path / "gone.yaml", file)))
    with cw.World("empty") as world:
        world.spawn(urdf)
        (reported,) = (each for each in world.diagnostics if each.severity == "error")
        assert reported.code is devices.CONTROLLERS_FILE_UNREADABLE
        assert reported.values["file"].endswith("gone.yaml")
        assert started(world) == ["group"]


@pytest.mark.wording
def test_a_package_that_is_missing_is_named_where_its_file_is_stated(tmp_path):
    urdf = tmp_path / "arm.urdf"
    body = beam("beam", "world") + system(ros2_joint("beam_joint"))
    plugin = ros2_plugin("$(find no_such_control)/config/c.yaml").replace("><param", ">\n<param")
    urdf.write_text(robot(body, plugin))
    with cw.World("empty") as world:
        world.spawn(urdf)
        (reported,) = (each for each in world.diagnostics if each.severity == "error")
    assert reported.code is devices.CONTROLLERS_FILE_UNREADABLE
    assert 'the package "no_such_control" was not found' in reported.message
    lines = urdf.read_text().splitlines()
    assert lines[reported.origin.line - 1].startswith("<parameters>")


def test_a_file_of_another_computer_is_the_one_in_the_package(tmp_path):
    package = tmp_path / "my_arm"
    (package / "config").mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>my_arm</name></package>")
    (package / "config" / "there.yaml").write_text(
        f"controller_manager: {{ros__parameters: {{group: {{type: {GROUP}}}}}}}\n"
        "group: {ros__parameters: {joints: [beam_joint]}}"
    )
    body = beam("beam", "world") + system(ros2_joint("beam_joint"))
    urdf = package / "arm.urdf"
    stated = "/home/me/ws/install/my_arm/share/my_arm/config/there.yaml"
    urdf.write_text(robot(body, ros2_plugin(stated)))
    with cw.World("empty") as world:
        world.spawn(urdf)
        (reported,) = (each for each in world.diagnostics if each.code is files.FILE_ELSEWHERE)
        assert reported.values["name"] == stated
        assert started(world) == ["group"]


@pytest.mark.parametrize("key", ["/robot1/controller_manager", "/**/controller_manager"])
def test_names_with_a_namespace(spawn, key):
    text = f"""
{key}:
  ros__parameters:
    group: {{type: {GROUP}}}
/robot1/group:
  ros__parameters: {{joints: [beam_joint]}}
/robot2/group:
  ros__parameters: {{joints: [elbow]}}
"""
    world = spawn(text, namespace="robot1")
    assert started(world) == ["group"]
    assert "/robot1/group/commands" in [topic.name for topic in world.graph.topics()]
    world.graph.service("/robot1/controller_manager/list_controllers")


def test_a_key_that_stands_twice_holds_both(spawn):
    world = spawn(f"""
/**:
  controller_manager:
    ros__parameters:
      update_rate: 100
      c: {{type: {GROUP}}}
/**:
  c:
    ros__parameters:
      joints: [wrong]
/**:
  c:
    ros__parameters:
      joints: [beam_joint]
""")
    assert started(world) == ["c"]
    assert warnings(world) == []


def test_numbers_with_an_exponent_are_numbers_in_ros2_and_texts_in_ros1(tmp_path):
    path = tmp_path / "a.yaml"
    numbers = "[0.5, 1e6, -2E-3, .5e1, 1.e2, '3e4', e5, 0x1e5]"
    path.write_text(f"c:\n  ros__parameters:\n    list: {numbers}\n")
    (values,) = read_parameters(path)["c"].values()
    assert values["list"] == [0.5, 1e6, -2e-3, 5.0, 100.0, "3e4", "e5", 0x1E5]
    path.write_text(f"c:\n  list: {numbers}\n")
    assert read_parameters(path)["c"]["list"][1] == "1e6"


def test_nested_namespaces_are_the_same(spawn):
    world = spawn(
        f"""
robot1:
  controller_manager:
    ros__parameters:
      group: {{type: {GROUP}}}
  group:
    ros__parameters: {{joints: [beam_joint]}}
""",
        namespace="/robot1",
    )
    assert started(world) == ["group"]


def test_a_manager_of_another_namespace_is_reported(spawn):
    world = spawn(f"/robot1/controller_manager: {{ros__parameters: {{group: {{type: {GROUP}}}}}}}")
    assert started(world) == []
    (reported,) = warnings(world)
    assert reported.code is devices.CONTROLLERS_FILE_WITHOUT_CONTROLLERS
    assert reported.values["nodes"] == ("/robot1/controller_manager",)


def test_several_files_make_one_whole_and_later_ones_win(spawn):
    manager = f"controller_manager: {{ros__parameters: {{group: {{type: {GROUP}}}}}}}"
    first = "group: {ros__parameters: {joints: [elbow]}}"
    given = "group: {ros__parameters: {joints: [beam_joint]}}"
    world = spawn(manager, first, given=[given])
    assert started(world) == ["group"]


def test_parameters_of_one_name_in_several_files_are_merged():
    parts = [
        {"c": {"ros__parameters": {"gains": {"a": {"p": 1}, "b": {"p": 2}}}}},
        {"c": {"ros__parameters": {"gains": {"b": {"p": 3, "i": 4}}}}},
    ]
    found = ros2_file(parts, "")
    assert found.nodes["c"] == {"gains": {"a": {"p": 1}, "b": {"p": 3, "i": 4}}}
    assert parts[0]["c"]["ros__parameters"]["gains"]["b"] == {"p": 2}


def test_a_file_may_give_topics_other_names(spawn):
    world = spawn(f"""
controller_manager:
  ros__parameters:
    group:
      type: {GROUP}
      node_options_args: ["--ros-args", "--remap", "/group/commands:=/go"]
group: {{ros__parameters: {{joints: [beam_joint]}}}}
""")
    topics = [topic.name for topic in world.graph.topics()]
    assert "/go" in topics
    assert "/group/commands" not in topics


@pytest.mark.parametrize("word", ["var", "arg"])
def test_a_prefix_is_the_robots_argument(spawn, word):
    text = f"""
controller_manager:
  ros__parameters:
    group: {{type: {GROUP}}}
group:
  ros__parameters:
    joints: ["$({word} tf_prefix)beam_joint"]
"""
    world = spawn(text, prefix="left_", arguments={"tf_prefix": "left_"})
    assert started(world) == ["group"]
    assert warnings(world) == []


def test_an_argument_that_the_robot_does_not_have_is_reported(spawn):
    with pytest.raises(PluginError) as caught:
        spawn('group: {ros__parameters: {rate: "$(var other)"}}')
    assert caught.value.code is devices.CONTROLLERS_FILE_ARGUMENT
    assert caught.value.values["name"] == "other"
    assert str(caught.value.origin).endswith("file0.yaml")


def test_ros1s_files_have_arguments_and_packages_too(tmp_path):
    body = beam("beam", "world") + transmission("beam_joint", "Position")
    file = tmp_path / "control.yaml"
    file.write_text(
        """
robot1:
  states: {type: joint_state_controller/JointStateController, publish_rate: "$(optenv RATE 20)"}
  one: {type: position_controllers/JointPositionController, joint: "beam_$(optenv WORD joint)"}
"""
    )
    path = tmp_path / "arm.urdf"
    path.write_text(robot(body, ROS1.replace(">/<", ">/robot1<")))
    with cw.World("empty") as world:
        world.spawn(path, controllers=[file])
        box = world.mailbox("/robot1/joint_states", size=1000)
        world.run(1.0)
        assert len(box.drain()) == pytest.approx(20, abs=1)
        assert "/robot1/one/command" in [topic.name for topic in world.graph.topics()]
        assert warnings(world) == []


def test_everything_that_can_be_replaced(tmp_path, monkeypatch):
    package = tmp_path / "src" / "my_robot"
    package.mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>my_robot</name></package>")
    file = package / "config" / "control.yaml"
    monkeypatch.setenv("SIDE", "left")
    content = {
        "a": "$(env SIDE)_arm",
        "$(env SIDE)_key": ["$(find my_robot)/x", "$(find-pkg-share my_robot)/x"],
        "number": "$(arg rate)",
        "text": "$(arg rate) Hz",
        "plain": 3,
        "other": "no (call) here, $5",
    }
    assert substitute(content, file, {"rate": "50.5"}) == {
        "a": "left_arm",
        "left_key": [f"{package}/x", f"{package}/x"],
        "number": 50.5,
        "text": "50.5 Hz",
        "plain": 3,
        "other": "no (call) here, $5",
    }
    for text in ("$(eval 1 + 1)", "$(env NO_SUCH_VARIABLE)", "$(find no_such_package)"):
        with pytest.raises(PluginError) as caught:
            substitute(text, Path(file), {})
        assert caught.value.code is devices.CONTROLLERS_FILE_ARGUMENT


def test_a_name_with_a_space_costs_its_controller_only(tmp_path):
    """ROS refuses such a name when the controller is loaded; the others start."""
    (tmp_path / "arm.urdf").write_text(
        robot(beam("beam", "world") + transmission("beam_joint", "Effort"), ROS1)
    )
    (tmp_path / "arm.yaml").write_text("""
Revolute 2_controller:
  type: effort_controllers/JointEffortController
  joint: beam_joint
held:
  type: effort_controllers/JointEffortController
  joint: beam_joint
""")
    with cw.World("empty") as world:
        world.spawn(tmp_path / "arm.urdf", controllers=[tmp_path / "arm.yaml"])
        world.run(0.1)
        assert started(world) == ["held"]
        (refused,) = [d for d in world.diagnostics if d.code is running.CONTROLLER_NOT_STARTED]
        assert refused.values["controller"] == "Revolute 2_controller"
        assert refused.values["cause"] == graph.GRAPH_NAME_INVALID.number


INLINE = """<launch>
  <rosparam>
    arm:
      first: {type: effort_controllers/JointPositionController, joint: one}
  </rosparam>
  <group ns="arm">
    <rosparam ns="second">
      type: position_controllers/JointPositionController
      joint: two
    </rosparam>
    <rosparam param="source_list">[a, b]</rosparam>
    <rosparam ns="/top" param="third">{type: a/BController, joint: three}</rosparam>
    <rosparam file="other.yaml" command="load"/>
  </group>
</launch>"""


def test_a_launch_file_may_contain_the_parameters_itself(tmp_path):
    file = tmp_path / "sim.launch"
    file.write_text(INLINE)
    assert read_parameters(file) == {
        "arm": {
            "first": {"type": "effort_controllers/JointPositionController", "joint": "one"},
            "second": {"type": "position_controllers/JointPositionController", "joint": "two"},
        },
        "top": {"third": {"type": "a/BController", "joint": "three"}},
    }
    stated = ControlFile(path=file, named=True).controllers
    assert [(each.name, each.type.node.start_mark.line + 1) for each in stated] == [
        ("arm/first", 4), ("arm/second", 8), ("top/third", 12),
    ]  # fmt: skip
    file.write_text(INLINE.replace("joint: two", "joint: [two"))
    with pytest.raises(PluginError) as caught:
        read_parameters(file)
    assert caught.value.code is devices.CONTROLLERS_FILE_UNREADABLE
    file.write_text(INLINE.replace("launch>", "robot>"))
    with pytest.raises(PluginError):
        read_parameters(file)


def test_several_parameters_may_be_on_one_line_of_a_launch_file(tmp_path):
    file = tmp_path / "sim.launch"
    one = '<rosparam param="{0}">{{type: a/BController, joint: j{0}}}</rosparam>'
    file.write_text(
        f"<launch><!-- {one.format('z')}\n-->{one.format('a')}"
        f'<rosparam file="x>y.yaml"/><node><rosparam>n: 1</rosparam></node>{one.format("b")}\n\n'
        '<rosparam\n param="c">\n  # <!-- a\n remark -->\n  type: a/BController\n'
        "  joint: jc\n</rosparam></launch>"
    )
    assert read_parameters(file) == {
        name: {"type": "a/BController", "joint": f"j{name}"} for name in "abc"
    }
    stated = ControlFile(path=file, named=True).controllers
    assert (stated[-1].name, stated[-1].type.node.start_mark.line + 1) == ("c", 8)


def test_controllers_in_a_launch_file_run(tmp_path):
    """The launch file is found beside the robot, and may be passed as a controller file."""
    folder = tmp_path / "arm"
    (folder / "launch").mkdir(parents=True)
    (folder / "package.xml").write_text("<package><name>arm</name></package>")
    path = folder / "arm.urdf"
    path.write_text(robot(beam("b", "world") + transmission("b_joint", "Effort"), ROS1))
    launch = folder / "launch/sim.launch"
    launch.write_text(
        """<launch><param name="robot_description" textfile="$(find arm)/arm.urdf"/>
        <rosparam>
          b_controller:
            type: effort_controllers/JointPositionController
            joint: b_joint
            pid: {p: 3000.0, i: 0.0, d: 100.0}
        </rosparam>
        <node name="s" pkg="controller_manager" type="spawner" args="b_controller"/></launch>"""
    )
    for given in ("auto", [launch]):
        world = cw.World("empty")
        arm = world.spawn(path, controllers=given)
        arm.publish("/b_controller/command", data=0.3)
        world.run(seconds=3)
        assert arm.joint("b_joint") == pytest.approx(0.3, abs=0.05)
