"""Launch files that pass the text of a xacro without expanding it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from tests.coded import coded

from cartwheel.checks import check
from cartwheel.codes.files import DESCRIPTION_NOT_EXPANDED
from cartwheel.corpus import robots_in, try_robot
from cartwheel.description.launches import launches_near, read_launch, unexpanded

FILE = "$(find bot)/urdf/bot.urdf.xacro"
PARAM = '<param name="robot_description" {}/>'
SPAWN = '<node name="s" pkg="gazebo_ros" type="spawn_model" args="-urdf -param robot_description"/>'
TEXT, CAT, XACRO = (
    PARAM.format(each)
    for each in (f'textfile="{FILE}"', f"command=\"cat '{FILE}'\"", f'command="xacro {FILE}"')
)
PYTHON = """
def generate_launch_description():
    file = os.path.join(get_package_share_directory("bot"), "urdf", "bot.urdf.xacro")
    return LaunchDescription([
        Node(package="robot_state_publisher", executable="robot_state_publisher",
             parameters=[{{"robot_description":
                 Command(["{program} ", file])}}]),
        Node(package="ros_gz_sim", executable="create", arguments=["-topic", "robot_description"]),
    ])
"""
INERTIAL = (
    '<inertial><mass value="${mass}"/><inertia ixx="0.1" iyy="0.1" izz="0.1" '
    'ixy="0" ixz="0" iyz="0"/></inertial>'
    '<collision><geometry><box size="0.3 0.3 0.1"/></geometry></collision>'
)
HEAD = '<robot name="bot" xmlns:xacro="http://www.ros.org/wiki/xacro">'
SENSOR = '<gazebo><plugin name="p" filename="libgazebo_ros_p3d.so"/></gazebo>'
MASS = '<xacro:property name="mass" value="1"/>'
BODY = f'<link name="base">{INERTIAL}</link>{SENSOR}'
Write = Callable[..., Path]


@pytest.fixture
def bot(tmp_path: Path) -> Write:
    """Writes a robot and launch files, and returns the robot's file."""
    folder = tmp_path / "bot"
    for name in ("launch", "urdf"):
        (folder / name).mkdir(parents=True)
    (folder / "package.xml").write_text("<package><name>bot</name></package>")

    def write(body: str, *files: str) -> Path:
        path = folder / "urdf/bot.urdf.xacro"
        path.write_text(f"{HEAD}{body}</robot>")
        for index, text in enumerate(files):
            python = "def " in text
            name = f"{index}.launch" + ".py" * python
            (folder / "launch" / name).write_text(
                text if python else f"<launch>\n{text}\n</launch>"
            )
        return path

    return write


@pytest.mark.parametrize(
    ("text", "name", "line"),
    [
        (TEXT + SPAWN, "0.launch", 2),
        (CAT + SPAWN, "0.launch", 2),
        (f"{SPAWN}\n{CAT}", "0.launch", 3),
        (PYTHON.format(program="cat"), "0.launch.py", 7),
    ],
)
def test_a_xacro_whose_text_is_passed_is_reported_with_the_line_of_the_launch_file(
    bot: Write, text: str, name: str, line: int
) -> None:
    # One that only shows the robot does not help.
    path = bot(MASS + BODY, text, XACRO)
    launch = path.parents[1] / "launch" / name
    (found,) = unexpanded(path, launches_near(path.parents[1]))
    assert found.origin is not None
    assert (found.origin.file, found.origin.line) == (str(launch), line)
    assert [each.origin for each in check(path).findings if each.code is found.code] == [
        found.origin
    ]
    (said,) = coded(read_launch(launch, {}), DESCRIPTION_NOT_EXPANDED)
    assert said == found
    assert [*robots_in(path.parents[1])] == [path]
    verdict = try_robot(path, standing=1.0)
    assert verdict.stands
    assert [(each.test, each.reason) for each in verdict.faults] == [("load", found)]
    assert verdict.outcome == "file"


@pytest.mark.parametrize(
    ("body", "files"),
    [
        (MASS + BODY, (XACRO + SPAWN,)),
        (MASS + BODY, (PYTHON.format(program="xacro"),)),
        # Another launch file that starts Gazebo expands it, or Gazebo is not started.
        (MASS + BODY, (CAT + SPAWN, XACRO + SPAWN)),
        (MASS + BODY, (CAT,)),
        # It needs no expansion.
        (BODY.replace("${mass}", "1"), (CAT + SPAWN,)),
        (f"<!-- {MASS} ${{x}} -->" + BODY.replace("${mass}", "1"), (TEXT + SPAWN,)),
    ],
)
def test_other_launch_files_are_not_reported(bot: Write, body: str, files: tuple[str, ...]) -> None:
    path = bot(body, *files)
    assert not [*unexpanded(path, launches_near(path.parents[1]))]
    assert DESCRIPTION_NOT_EXPANDED not in {each.code for each in check(path).findings}
    assert try_robot(path, standing=1.0).good


def test_the_launch_file_that_is_started_is_reported_although_another_one_expands(
    bot: Write,
) -> None:
    path = bot(MASS + BODY, CAT + SPAWN, XACRO + SPAWN)
    folder = path.parents[1] / "launch"
    starts = [read_launch(folder / f"{index}.launch", {}) for index in (0, 1)]
    assert [len(coded(each, DESCRIPTION_NOT_EXPANDED)) for each in starts] == [1, 0]


def test_other_values_of_an_argument_are_not_taken_for_a_file_that_is_not_expanded(
    bot: Write,
) -> None:
    """The launch file is read again for each of them, and passes the text of the first robot."""
    path = bot(
        MASS + BODY,
        TEXT.replace("robot_description", "one/robot_description")
        + '<arg name="size" default="small"/>'
        + XACRO.replace("bot.urdf", "arm_$(arg size).urdf")
        + SPAWN,
    )
    for size in ("small", "large"):
        path.with_name(f"arm_{size}.urdf.xacro").write_text(path.read_text())
    plain = {
        use.description.name: use.plain is not None
        for use in launches_near(path.parents[1])
        if use.description is not None
    }
    assert plain == {
        "bot.urdf.xacro": True,
        "arm_small.urdf.xacro": False,
        "arm_large.urdf.xacro": False,
    }


RAW = '<node name="s" pkg="gazebo_ros" type="spawn_model" args="-file {} -urdf -model bot"/>'
SPAWNER = """
def generate_launch_description():
    file = os.path.join(get_package_share_directory("bot"), "urdf", "bot.urdf.xacro")
    return LaunchDescription([
        Node(package="robot_state_publisher", executable="robot_state_publisher",
             parameters=[{"robot_description": Command(["xacro ", file])}]),
        Node(package="gazebo_ros", executable="spawn_entity.py",
             arguments=["-entity", "bot", "-file", file]),
    ])
"""


@pytest.mark.parametrize(
    ("text", "line"), [(RAW.format(FILE), 2), (XACRO + "\n" + RAW.format(FILE), 3), (SPAWNER, 7)]
)
def test_a_spawner_that_reads_a_xacro_is_reported(bot: Write, text: str, line: int) -> None:
    """Also if the launch file publishes the expanded description."""
    path = bot(MASS + BODY, text)
    (found,) = coded(check(path).findings, DESCRIPTION_NOT_EXPANDED)
    assert found.origin is not None
    assert found.origin.line == line
    launch = next((path.parent.parent / "launch").iterdir())
    assert coded(read_launch(launch, {}).diagnostics, DESCRIPTION_NOT_EXPANDED)
    assert [each.code for each in try_robot(path, standing=1.0).faults] == [
        DESCRIPTION_NOT_EXPANDED
    ]
    assert not coded(check(bot(MASS + BODY, XACRO + SPAWN)).findings, DESCRIPTION_NOT_EXPANDED)


def test_a_spawner_may_read_a_file_without_expressions(bot: Write) -> None:
    path = bot(BODY.replace("${mass}", "1"), RAW.format(FILE))
    assert not coded(check(path).findings, DESCRIPTION_NOT_EXPANDED)


URDF = '<robot name="bot">{body}</robot>'
MESH = '<{where}><geometry><mesh filename="$(find bot)/body.stl"/></geometry></{where}>'
CONTROL = (
    '<gazebo><plugin name="c" filename="libgazebo_ros2_control.so">'
    "<parameters>$(find bot)/urdf/c.yaml</parameters></plugin></gazebo>"
)
GENERATED = "<!-- | This document was autogenerated by xacro from bot.urdf.xacro | -->\n"


def urdf(bot: Write, body: str, *launches: str, head: str = "") -> Path:
    """A URDF that does not declare xacro, beside the launch files of the fixture."""
    path = bot("", *(each.replace("bot.urdf.xacro", "bot.urdf") for each in launches))
    path.unlink()
    path = path.with_name("bot.urdf")
    link = f'<link name="base">{INERTIAL}</link>'.replace("${mass}", "1")
    path.write_text(head + URDF.format(body=link.replace("</link>", "") + body))
    return path


@pytest.mark.parametrize(
    ("body", "launch", "lost"),
    [
        (f"</link>{CONTROL}", TEXT + SPAWN, True),
        (f"</link>{CONTROL}", XACRO + SPAWN, False),
        (f"{MESH.format(where='collision')}</link>", TEXT + SPAWN, True),
        (f"{MESH.format(where='visual')}</link>", TEXT + SPAWN, False),
        (f"</link><!--{CONTROL}-->", TEXT + SPAWN, False),
    ],
)
def test_gazebo_does_not_find_files_of_a_urdf_that_is_not_expanded(
    bot: Write, body: str, launch: str, lost: bool
) -> None:
    path = urdf(bot, body, launch)
    found = [*unexpanded(path, launches_near(path.parents[1]))]
    assert [each.code for each in found] == [DESCRIPTION_NOT_EXPANDED] * lost
    assert [e.code for e in check(path).findings if e.code in (DESCRIPTION_NOT_EXPANDED,)] == [
        DESCRIPTION_NOT_EXPANDED
    ] * lost


@pytest.mark.parametrize(
    ("head", "launch", "lost"),
    [
        (GENERATED, (), True),
        (GENERATED, (TEXT,), True),
        (GENERATED, (XACRO,), False),
        # Another repository may expand it.
        ("", (), False),
    ],
)
def test_nothing_expands_the_output_of_xacro_again(
    bot: Write, head: str, launch: tuple[str, ...], lost: bool
) -> None:
    path = urdf(bot, f"</link>{CONTROL}", *launch, head=head)
    faults = [each for each in try_robot(path, standing=1.0).faults if each.test == "load"]
    assert [each.code for each in faults] == [DESCRIPTION_NOT_EXPANDED] * lost
    assert all(each.source == "file" for each in faults)
