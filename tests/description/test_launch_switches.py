"""Launch files that start Gazebo only with another value of one of their arguments."""

import pytest

from cartwheel.description.launches import chosen, launches_near

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
