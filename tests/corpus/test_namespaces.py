"""Controllers of ROS 2 whose manager, parameters and spawner are in different namespaces."""

import pytest
from tests.corpus.carts import cart, controlled, written

from cartwheel.checks.checking import check
from cartwheel.codes.devices import CONTROLLER_UNDEFINED, CONTROLLERS_FILE_WITHOUT_CONTROLLERS
from cartwheel.codes.running import CONTROLLER_NOT_STARTED
from cartwheel.corpus import try_robot

LAUNCH = """from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    urdf = open(get_package_share_directory('cart') + '/robot.urdf').read()
    return LaunchDescription([
        Node(package='robot_state_publisher', executable='robot_state_publisher',
             parameters=[{{'robot_description': urdf}}]),
        Node(package='ros_gz_sim', executable='create', arguments=['-topic', 'robot_description']),
        Node(package='controller_manager', {spawner}),
        {more}
    ])
"""
PLAIN = "executable='spawner', arguments=['base']"
IN_ROBOT = "executable='spawner', arguments=['base', '-c', '/robot/controller_manager']"


@pytest.fixture
def robot(tmp_path):
    """Writes a cart, its controllers and a launch file, and returns the cart's file.

    The names of nodes in the file of controllers have a prefix. `space` is the namespace that the
    plugin states; None if it states none.
    """

    def write(prefix="", space=None, spawner=PLAIN, *, more="", own=None):
        folder = tmp_path / "cart"
        (folder / "launch").mkdir(parents=True)
        (folder / ".git").mkdir()
        build = "<export><build_type>ament_cmake</build_type></export>"
        (folder / "package.xml").write_text(f"<package><name>cart</name>{build}</package>")
        control = controlled(folder)
        if space is not None:
            tag = f"<ros><namespace>{space}</namespace></ros></plugin>"
            control = control.replace("</plugin></gazebo>", f"{tag}</gazebo>")
        text = (folder / "base.yaml").read_text()
        text = text.replace("\nbase:", f"\n{prefix if own is None else own}base:")
        (folder / "base.yaml").write_text(f"{prefix}{text}")
        launch = LAUNCH.format(spawner=spawner, more=more)
        (folder / "launch/sim.launch.py").write_text(launch)
        return written(folder, cart(), control)

    return write


def reasons(verdict):
    return {each.code for each in verdict.faults}


@pytest.mark.parametrize(
    ("prefix", "space", "spawner"),
    [
        ("", None, PLAIN),
        ("", "/", PLAIN),
        ("/robot/", "/robot", IN_ROBOT),
        ("/robot/", "robot", IN_ROBOT),
        ("/**/", "/robot", IN_ROBOT),
        ("", None, "executable='spawner', arguments=['base', '-c', LaunchConfiguration('no')]"),
        # Foxy's spawner does not use the namespace of its node.
        ("", None, "executable='spawner.py', namespace='robot', arguments=['base']"),
    ],
)
def test_controllers_in_the_namespace_of_their_manager_start(robot, prefix, space, spawner):
    verdict = try_robot(robot(prefix, space, spawner), standing=0.5)
    assert verdict.good, verdict.faults
    assert verdict.controllers == ("base",)


@pytest.mark.parametrize(
    ("prefix", "space", "spawner", "manager"),
    [
        ("", None, IN_ROBOT, "/"),
        ("", None, "executable='spawner', namespace='robot', arguments=['base']", "/"),
        ("/robot/", "/robot", PLAIN, "/robot"),
    ],
)
def test_a_spawner_needs_the_namespace_of_the_manager(robot, prefix, space, spawner, manager):
    file = robot(prefix, space, spawner)
    verdict = try_robot(file, standing=0.5)
    (fault,) = verdict.faults
    assert (fault.test, fault.subject, fault.code) == ("controller", "base", CONTROLLER_UNDEFINED)
    assert fault.reason.values["manager"] == manager
    assert verdict.outcome == "file"
    found = [each for each in check(file).findings if each.code is CONTROLLER_UNDEFINED]
    assert [each.values["manager"] for each in found] == [manager]


def test_a_spawner_may_wait_for_a_manager_outside_of_gazebo(robot):
    node = "Node(package='controller_manager', executable='ros2_control_node', namespace='robot')"
    assert try_robot(robot(spawner=IN_ROBOT, more=node), standing=0.5).good


@pytest.mark.parametrize(
    ("options", "space", "reported"),
    [
        ("", None, True),
        ("namespace='robot'", None, False),
        ("namespace='robot'", "/robot", True),
        ("condition=UnlessCondition('true')", None, False),
        ("condition=UnlessCondition('false')", None, True),
        ("name='controller_manager'", None, True),
        ("name='driver'", None, False),
        # It is unknown whether it starts.
        ("condition=IfCondition(LaunchConfiguration('real'))", None, False),
    ],
)
def test_a_second_manager_of_the_same_name(robot, options, space, reported):
    node = f"Node(package='controller_manager', executable='ros2_control_node', {options}),"
    prefix, spawner = ("/robot/", IN_ROBOT) if space else ("", PLAIN)
    file = robot(prefix, space, spawner, more=node)
    found = [each.values["manager"] for each in check(file).findings]
    name = f"{space or ''}/controller_manager"
    assert found == [name] * reported
    # Which of them starts the controllers is not certain.
    assert try_robot(file, standing=0.5).good


def test_controllers_of_a_manager_outside_of_gazebo_are_not_those_of_the_robot(robot):
    """Their parameters may be in the program of the driver."""
    node = "Node(package='controller_manager', executable='{}'{}),"
    more = node.format("ros2_control_node", ", namespace='driver'")
    words = ", arguments=['real', '-c', '{}']"
    other = node.format("spawner", words.format("/driver/controller_manager"))
    file = robot(more=more + other)
    verdict = try_robot(file, standing=0.5)
    assert verdict.good, verdict.faults
    assert (verdict.spawned, verdict.observed) == (("base",), ())
    launch = file.parent / "launch/sim.launch.py"
    launch.write_text(launch.read_text().replace("/driver/", "/"))
    verdict = try_robot(file, standing=0.5)
    assert verdict.spawned == ("base", "real")
    assert [each.code for each in verdict.observed] == [CONTROLLER_UNDEFINED]


@pytest.mark.parametrize(("prefix", "space"), [("", "/robot"), ("/robot/", None)])
def test_parameters_for_a_manager_in_another_namespace(robot, prefix, space):
    file = robot(prefix, space, IN_ROBOT if space else PLAIN)
    verdict = try_robot(file, standing=0.5)
    assert reasons(verdict) == {CONTROLLERS_FILE_WITHOUT_CONTROLLERS}
    assert verdict.outcome == "file"
    codes = [each.code for each in check(file).findings]
    assert codes == [CONTROLLERS_FILE_WITHOUT_CONTROLLERS]


@pytest.mark.wording
def test_parameters_for_a_controller_in_another_namespace(robot):
    verdict = try_robot(robot(own="/robot/"), standing=0.5)
    assert reasons(verdict) == {CONTROLLER_NOT_STARTED}
    assert '"/robot/base"' in verdict.faults[0].reason.hint
    assert verdict.outcome == "file"


@pytest.mark.parametrize("writes", [False, True])
def test_controllers_may_be_in_a_file_that_a_launch_file_writes(tmp_path, writes):
    """Then nothing is known about them, and the fault may not be in the files of the robot."""
    text = controlled(tmp_path)
    (tmp_path / "base.yaml").write_text("controller_manager: {ros__parameters: {}}\n")
    (tmp_path / ".git").mkdir()
    (tmp_path / "package.xml").write_text("<package><name>cart</name></package>")
    robot = written(tmp_path, cart(), text)
    (tmp_path / "launch").mkdir()
    (tmp_path / "launch" / "sim.launch.py").write_text(f"""
def generate_launch_description():
    {"yaml.dump({}, open('/a.yaml', 'w'))" if writes else "pass"}
    robot = open("{robot}").read()
    return LaunchDescription([
        Node(package="robot_state_publisher", parameters=[{{"robot_description": robot}}]),
        Node(package="ros_gz_sim", executable="create", arguments=["-topic", "robot_description"]),
        Node(package="controller_manager", executable="spawner", arguments=["base"]),
    ])
""")
    verdict = try_robot(robot, standing=1.0)
    assert {each.source for each in verdict.faults} == {"unknown" if writes else "file"}
    assert (CONTROLLER_UNDEFINED in {each.code for each in verdict.faults}) == (not writes)


@pytest.mark.parametrize("passed", [False, True])
def test_a_spawner_may_load_a_file_that_the_manager_lacks(tmp_path, passed):
    """The file in the tag of the plugin then contains only parameters of the manager."""
    text = controlled(tmp_path)
    (tmp_path / "base.yaml").rename(tmp_path / "drive.yaml")
    (tmp_path / "base.yaml").write_text("controller_manager: {ros__parameters: {update_rate: 90}}")
    (tmp_path / ".git").mkdir()
    (tmp_path / "package.xml").write_text("<package><name>cart</name></package>")
    robot = written(tmp_path, cart(), text)
    (tmp_path / "launch").mkdir()
    more = f', "--param-file", "{tmp_path}/drive.yaml"' if passed else ""
    (tmp_path / "launch" / "sim.launch.py").write_text(f"""
def generate_launch_description():
    robot = open("{robot}").read()
    return LaunchDescription([
        Node(package="robot_state_publisher", parameters=[{{"robot_description": robot}}]),
        Node(package="ros_gz_sim", executable="create", arguments=["-topic", "robot_description"]),
        Node(package="controller_manager", executable="spawner", arguments=["base"{more}]),
    ])
""")
    verdict = try_robot(robot, standing=1.0)
    assert verdict.good == passed
    assert verdict.controllers == (("base",) if passed else ())
