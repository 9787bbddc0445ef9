"""Arguments without a default in included launch files, which other files state in many forms."""

import pytest

from cartwheel.description.launches import read_launch

ROBOT = '<robot name="a"><link name="base"/></robot>'
PYTHON = """def generate_launch_description():
    share = get_package_share_directory("bot")
    robot = open(os.path.join(share, "a.urdf")).read()
    node = Node(package="robot_state_publisher", parameters=[{"robot_description": robot}])
    return LaunchDescription([DeclareLaunchArgument("space"), node])
"""
INCLUDES = """def generate_launch_description():
    file = os.path.join(get_package_share_directory("bot"), "launch", "inner.launch.py")
    source = PythonLaunchDescriptionSource(file)
    inner = IncludeLaunchDescription(source{arguments})
    {before}
    return LaunchDescription([{first}inner])
"""
XML = """<launch><arg name="space"/><node pkg="robot_state_publisher" exec="robot_state_publisher">
<param name="robot_description" value="$(command 'cat $(find-pkg-share bot)/a.urdf')"/></node>
</launch>"""


def unknown(tmp_path, name, text):
    """The arguments without a value for which ROS does not start a launch file of a package."""
    folder = tmp_path / "bot"
    (folder / "launch").mkdir(parents=True)
    (folder / "package.xml").write_text("<package><name>bot</name></package>")
    (folder / "a.urdf").write_text(ROBOT)
    (folder / "launch/inner.launch.py").write_text(PYTHON)
    (folder / "launch/inner.launch.xml").write_text(XML)
    (folder / "launch" / name).write_text(text)
    start = read_launch(folder / "launch" / name, {})
    assert [each.description.name for each in start.models] == ["a.urdf"]
    return [each.values["name"] for each in start.diagnostics if each.severity == "warning"]


@pytest.mark.parametrize(
    ("arguments", "before", "first"),
    [
        (', launch_arguments={**{"space": "one"}, "x": "1"}.items()', "", ""),
        (', launch_arguments={**made(), "x": "1"}.items()', "", ""),
        (", launch_arguments=made().items()", "", ""),
        (", launch_arguments=[made(), ('x', '1')]", "", ""),
        ("", "more = {'default_value': 'one'}", 'DeclareLaunchArgument("space", **more), '),
        ("", "more = made()", 'DeclareLaunchArgument("space", **more), '),
        ("", "", 'SetLaunchConfiguration(name="space", value="one"), '),
        ("", "", 'SetLaunchConfiguration("space", value="one"), '),
    ],
)
def test_arguments_in_python_that_may_be_stated(tmp_path, arguments, before, first):
    text = INCLUDES.format(arguments=arguments, before=before, first=first)
    missing = unknown(tmp_path, "outer.launch.py", text)
    assert missing == []


@pytest.mark.parametrize(
    "arguments", ["", ', launch_arguments={**{"x": "1"}}.items()', ", launch_arguments=[('x', '')]"]
)
def test_an_argument_in_python_that_is_not_stated(tmp_path, arguments):
    text = INCLUDES.format(arguments=arguments, before="", first="")
    assert unknown(tmp_path, "outer.launch.py", text) == ["space"]


@pytest.mark.parametrize(
    "text",
    [
        '<arg name="space" default="one"/><include file="$(dirname)/inner.launch.xml"/>',
        '<let name="space" value="one"/><arg name="space"/>'
        '<include file="$(find-pkg-share bot)/launch/inner.launch.xml"/>',
        '<include file="$(find-pkg-share bot)/launch/inner.launch.xml">'
        '<let name="space" value="one"/></include>',
    ],
)
def test_arguments_in_xml_of_ros2_that_are_stated(tmp_path, text):
    assert unknown(tmp_path, "outer.launch.xml", f"<launch>{text}</launch>") == []


def test_an_argument_in_xml_that_is_not_stated(tmp_path):
    text = '<launch><include file="$(dirname)/inner.launch.xml"/></launch>'
    assert unknown(tmp_path, "outer.launch.xml", text) == ["space"]


def test_launch_files_around_one_in_no_package_are_not_searched(tmp_path):
    file = tmp_path / "robot.launch"
    file.write_text(
        '<launch><arg name="model"/><node pkg="gazebo_ros" type="spawn_model" name="s" '
        'args="-urdf -file $(dirname)/a.urdf -model $(arg model)"/></launch>'
    )
    (tmp_path / "a.urdf").write_text(ROBOT)
    (tmp_path / "other").mkdir()
    (tmp_path / "other/all.launch").write_text(
        f'<launch><include file="{file}"><arg name="model" value="one"/></include></launch>'
    )
    assert [each.spawn.name for each in read_launch(file, {}).models] == [""]
