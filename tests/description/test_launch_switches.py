"""Launch files that start Gazebo only with another value of one of their arguments."""

import pytest

from cartwheel.description.launches import chosen, launches_near, starters

PUBLISHER = """
def generate_launch_description():
    sim = LaunchConfiguration("sim")
    return LaunchDescription([
        DeclareLaunchArgument("sim", default_value="false"),
        Node(package="robot_state_publisher", executable="robot_state_publisher", parameters=[{
            "robot_description": Command(["xacro ", SHARE + "/robot.xacro", " simulated:=", sim])
        }]),
    ])
"""
FOUND = 'SHARE = get_package_share_directory("bot")\n'
MAIN = """
def generate_launch_description():
    folder = join(SHARE, "launch")
    sim = LaunchConfiguration("use_sim")
    gazebo = IncludeLaunchDescription(join(folder, "world.launch.py"), condition=IfCondition(sim))
    driver = Node(package="driver", executable="driver", condition=UnlessCondition(sim))
    return LaunchDescription([
        DeclareLaunchArgument("gui", default_value="true"),
        DeclareLaunchArgument("use_sim", default_value="false"),
        IncludeLaunchDescription(
            join(folder, "rsp.launch.py"), launch_arguments={"sim": sim}.items()),
        gazebo,
        driver,
    ])
"""
WORLD = """
def generate_launch_description():
    return LaunchDescription([
        Node(package="ros_gz_sim", executable="create", arguments=["-topic", "robot_description"]),
    ])
"""


def package(folder, **launches: str):
    """Writes a package with a xacro and launch files in Python; returns the xacro."""
    (folder / "launch").mkdir(parents=True)
    (folder / "package.xml").write_text("<package><name>bot</name></package>")
    (folder / "robot.xacro").write_text('<robot name="bot"/>')
    for name, text in launches.items():
        (folder / "launch" / f"{name}.launch.py").write_text(FOUND + text)
    return folder / "robot.xacro"


def used(folder, robot):
    use = chosen(robot, launches_near(folder))
    assert use is not None
    return use.file.name, dict(use.arguments), use.switched


def test_the_arguments_with_which_a_launch_file_starts_gazebo_are_used(tmp_path):
    robot = package(tmp_path, rsp=PUBLISHER, world=WORLD, main=MAIN)
    assert used(tmp_path, robot) == (
        "main.launch.py",
        {"simulated": "true"},
        (("use_sim", "true"),),
    )


def test_a_launch_file_that_starts_gazebo_by_default_is_preferred(tmp_path):
    started = MAIN.replace('default_value="false"', 'default_value="True"')
    robot = package(tmp_path, rsp=PUBLISHER, world=WORLD, main=MAIN, other=started)
    assert used(tmp_path, robot) == ("other.launch.py", {"simulated": "True"}, ())


def test_a_launch_file_whose_conditions_start_no_gazebo_keeps_its_defaults(tmp_path):
    robot = package(tmp_path, rsp=PUBLISHER, world=WORLD.replace("create", "bridge"), main=MAIN)
    assert used(tmp_path, robot)[1:] == ({"simulated": "false"}, ())


@pytest.mark.parametrize("kind", ["statement", "expression"])
def test_conditions_of_python_start_gazebo_as_well(tmp_path, kind):
    whole = "gazebo = IncludeLaunchDescription(join(folder, 'world.launch.py'))"
    text = {
        "statement": f"if sim == 'true':\n        {whole}\n    else:\n        gazebo = []",
        "expression": f"{whole} if sim == 'true' else []",
    }[kind]
    old = next(line.strip() for line in MAIN.splitlines() if "gazebo = " in line)
    robot = package(tmp_path, rsp=PUBLISHER, world=WORLD, main=MAIN.replace(old, text))
    assert used(tmp_path, robot)[2] == (("use_sim", "true"),)


def test_a_choice_of_an_argument_starts_gazebo(tmp_path):
    main = MAIN.replace(
        'default_value="false"', 'default_value="real", choices=["real", "fake", "gazebo"]'
    ).replace("(sim)", "(EqualsSubstitution(sim, 'gazebo'))")
    robot = package(tmp_path, rsp=PUBLISHER, world=WORLD, main=main)
    assert used(tmp_path, robot)[1:] == ({"simulated": "gazebo"}, (("use_sim", "gazebo"),))


ROS1 = """<launch>
    <arg name="mode" default="false"/>
    <param name="robot_description" command="xacro $(find bot)/robot.xacro simulated:=$(arg mode)"/>
    <group if="$(arg mode)">
        <node pkg="gazebo_ros" type="spawn_model" name="s" args="-param robot_description"/>
    </group>
</launch>"""
ROS2 = """<launch>
    <arg name="mode" default="real"><choice value="real"/><choice value="gz"/></arg>
    <node pkg="robot_state_publisher" exec="robot_state_publisher"><param name="robot_description"
        value="$(command 'xacro $(find-pkg-share bot)/robot.xacro simulated:=$(var mode)')"/></node>
    <node pkg="ros_gz_sim" exec="create" args="-topic robot_description"
        if="$(eval '&quot;$(var mode)&quot; == &quot;gz&quot;')"/>
</launch>"""


@pytest.mark.parametrize(("text", "value"), [(ROS1, "true"), (ROS2, "gz")])
def test_a_launch_file_in_xml_starts_gazebo_with_another_value(tmp_path, text, value):
    robot = package(tmp_path)
    (tmp_path / "launch" / "main.launch").write_text(text)
    assert used(tmp_path, robot)[1:] == ({"simulated": value}, (("mode", value),))


ARMS = """<launch>
    <arg name="prefix" default=""/>
    <arg name="model" default=""/>
    <arg name="use_controllers" default="false"/>
    <param name="robot_description"
        command="xacro $(find bot)/urdf/$(arg model).urdf.xacro name:=$(arg model)"/>
    <node pkg="gazebo_ros" type="spawn_model" name="s" args="-param robot_description"/>
    <group if="$(arg use_controllers)">
        <rosparam file="$(find bot)/config/$(arg model).yaml"/>
        <node pkg="controller_manager" type="spawner" name="c" args="arm_controller"/>
    </group>
</launch>"""
REAL = """<launch>
    <param name="robot_description" command="xacro $(find bot)/urdf/small.urdf.xacro"/>
    <rosparam file="$(find bot)/config/real.yaml"/>
    <node pkg="controller_manager" type="spawner" name="c" args="real_controller"/>
</launch>"""


@pytest.fixture
def arms(tmp_path):
    """Two arms of which a launch file starts the one that an argument without a default names."""
    package(tmp_path)
    for folder in ("urdf", "config"):
        (tmp_path / folder).mkdir()
    for name in ("small", "large"):
        (tmp_path / "urdf" / f"{name}.urdf.xacro").write_text('<robot name="arm"/>')
        (tmp_path / "config" / f"{name}.yaml").write_text("arm_controller: {type: a/B}\n")
    (tmp_path / "config" / "real.yaml").write_text("real_controller: {type: a/B}\n")
    (tmp_path / "launch" / "arms.launch").write_text(ARMS)
    return tmp_path


@pytest.mark.parametrize("name", ["small", "large"])
def test_an_empty_argument_is_the_name_of_a_description(arms, name):
    robot = arms / "urdf" / f"{name}.urdf.xacro"
    uses = [each for each in launches_near(arms) if each.description == robot]
    use = chosen(robot, uses)
    assert use is not None
    assert use.simulated
    assert use.arguments == {"name": name}
    assert not use.spawned
    # With another value of an argument, it starts controllers.
    (other,) = (each for each in uses if each.switched)
    assert other.switched == (("use_controllers", "true"),)
    assert other.spawned == ("arm_controller",)
    assert [path.name for path in other.controllers] == [f"{name}.yaml"]


def test_controllers_in_gazebo_are_preferred_to_those_of_the_real_robot(arms):
    """Its launch file loads the same description."""
    (arms / "launch" / "a.launch").write_text(REAL)
    robot = arms / "urdf" / "small.urdf.xacro"
    found = starters(robot, launches_near(arms), described=True)
    assert [each.spawned for each in found] == [("arm_controller",), ("real_controller",)]


def test_controllers_of_a_robot_that_an_argument_names_are_for_no_other(arms):
    text = ARMS.replace('default="false"', 'default="true"')
    (arms / "launch" / "arms.launch").write_text(text)
    uses = launches_near(arms)
    assert {each.description and each.description.name for each in uses} == {
        "large.urdf.xacro",
        "small.urdf.xacro",
    }
    assert all(each.spawned for each in uses)
