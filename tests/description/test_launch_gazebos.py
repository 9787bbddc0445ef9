"""Which Gazebo a launch file starts."""

import pytest

from cartwheel.description.launches import launches_near

LAUNCH = """def generate_launch_description():
    share = get_package_share_directory("bot")
    robot = open(os.path.join(share, "a.urdf")).read()
    node = Node(package="robot_state_publisher", parameters=[{{"robot_description": robot}}])
    return LaunchDescription([node, {action}])
"""
INCLUDE = (
    "IncludeLaunchDescription(PythonLaunchDescriptionSource("
    'os.path.join(get_package_share_directory("{package}"), "launch", "gazebo.launch.py")))'
)


def started(folder, action):
    (folder / "launch").mkdir()
    (folder / "package.xml").write_text("<package><name>bot</name></package>")
    (folder / "a.urdf").write_text('<robot name="a"><link name="base"/></robot>')
    (folder / "launch/a.launch.py").write_text(LAUNCH.format(action=action))
    (use,) = launches_near(folder)
    return use.gazebos


@pytest.mark.parametrize(
    ("command", "kinds"),
    [
        ('["gz", "sim", "-r", "a.sdf"]', {"gz"}),
        ('["gz sim -r", " a.sdf"]', {"gz"}),
        ('["/usr/bin/ign", "gazebo", "a.sdf"]', {"gz"}),
        ('["gz", "physics", "-s", "0.01"]', set()),
        ('["gz", "model", "--model-name", "a"]', set()),
        ('["gazebo", "--verbose", "a.world"]', {"classic"}),
        ('["gzserver"]', {"classic"}),
        ('["gz"]', set()),
        ('[" "]', set()),
    ],
)
def test_commands_that_start_gazebo(tmp_path, command, kinds):
    assert started(tmp_path, f"ExecuteProcess(cmd={command})") == kinds


@pytest.mark.parametrize(("package", "kinds"), [("gazebo_ros", {"classic"}), ("other", set())])
def test_a_launch_file_of_an_absent_package_may_start_any_gazebo(tmp_path, package, kinds):
    assert started(tmp_path, INCLUDE.format(package=package)) == kinds
