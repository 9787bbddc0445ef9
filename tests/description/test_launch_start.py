"""What a launch file starts: models, their places, and the world."""

from __future__ import annotations

from pathlib import Path

import pytest
from tests.coded import coded, raises

from cartwheel.codes.files import (
    ARGUMENT_UNKNOWN,
    FILE_MISSING,
    LAUNCH_VALUE_UNKNOWN,
    NOT_A_DESCRIPTION,
    XML_MALFORMED,
)
from cartwheel.description.launches import is_launch_file, read_launch

ROS1 = """<launch>
  <arg name="arena" default="$(find bot)/worlds/arena.world"/><arg name="height" default="0.2"/>
  <include file="$(find gazebo_ros)/launch/empty_world.launch">
    <arg name="world_name" value="$(arg arena)"/></include>
  <param name="robot_description" command="xacro $(find bot)/urdf/bot.xacro size:=2"/>
  <node pkg="gazebo_ros" type="spawn_model" name="spawn"
    args="-urdf -param robot_description -model one -x 1 -z $(arg height) -Y -0.5"/>
</launch>"""
ROS2 = """
share = FindPackageShare(package="bot").find("bot")
xacro = LaunchConfiguration("model")

def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument("model", default_value=os.path.join(share, "urdf", "bot.xacro")),
        IncludeLaunchDescription(
            PythonLaunchDescriptionSource(
                [FindPackageShare("ros_gz_sim"), "/launch/gz_sim.launch.py"]),
            launch_arguments={"gz_args": ["-r ", share, "/worlds/arena.world"]}.items(),
        ),
        Node(package="robot_state_publisher", executable="robot_state_publisher",
             parameters=[{"robot_description": Command(["xacro ", xacro, " size:=2"])}]),
        Node(package="ros_gz_sim", executable="create",
             arguments=["-topic", "robot_description", "-name", "one", "-x", "1", "-z", "0.2",
                        "-Y", "-0.5"]),
    ])
"""


@pytest.fixture
def bot(tmp_path: Path) -> Path:
    """A package with a robot and a world."""
    folder = tmp_path / "bot"
    for name in ("launch", "urdf", "worlds"):
        (folder / name).mkdir(parents=True)
    (folder / "package.xml").write_text("<package><name>bot</name></package>")
    for name in ("bot.xacro", "other.urdf"):
        (folder / "urdf" / name).write_text('<robot name="bot"><link name="base"/></robot>')
    (folder / "worlds" / "arena.world").write_text("<sdf version='1.6'><world name='a'/></sdf>")
    return folder


def written(bot: Path, name: str, text: str) -> Path:
    path = bot / "launch" / name
    path.write_text(text)
    return path


@pytest.mark.parametrize(("name", "text"), [("a.launch", ROS1), ("a.launch.py", ROS2)])
def test_a_model_with_its_place_in_a_world(bot: Path, name: str, text: str) -> None:
    start = read_launch(written(bot, name, text), {})
    (model,) = start.models
    assert model.description == bot / "urdf/bot.xacro"
    assert model.use.arguments == {"size": "2"}
    assert model.spawn.name == "one"
    assert model.spawn.place == {"x": 1.0, "z": 0.2, "yaw": -0.5}
    assert Path(start.world) == bot / "worlds/arena.world"
    assert start.diagnostics == ()


def test_arguments_of_a_launch_file(bot: Path) -> None:
    path = written(bot, "a.launch", ROS1)
    start = read_launch(path, {"height": "3", "arena": "mud.world", "heigth": "4"})
    assert start.models[0].spawn.place["z"] == 3.0
    assert start.world == "mud.world"
    (found,) = start.diagnostics
    assert found.code is ARGUMENT_UNKNOWN
    assert found.values == {"name": "heigth", "meant": "height"}


def test_what_only_the_execution_determines_is_reported(bot: Path) -> None:
    text = ROS1.replace("$(arg arena)", "$(anon arena)").replace("size:=2", "size:=$(anon x)")
    text = text.replace("$(arg height)", "$(anon z)")
    start = read_launch(written(bot, "a.launch", text), {})
    assert start.world == ""
    assert start.models[0].use.arguments == {}
    assert start.models[0].spawn.place == {"x": 1.0, "yaw": -0.5}
    assert [each.values["what"] for each in coded(start, LAUNCH_VALUE_UNKNOWN)] == [
        "world",
        "arguments",
        "place",
    ]


FUNCTION = """
def robot(kind):
    if kind == "small":
        return "none.xacro"
    {condition}
        return "other.xacro"
    return "bot.xacro"

def generate_launch_description():
    file = os.path.join(get_package_share_directory("bot"), "urdf", robot("large"))
    return LaunchDescription([
        Node(package="robot_state_publisher", executable="robot_state_publisher",
             parameters=[{{"robot_description": Command(["xacro ", file])}}]),
        Node(package="ros_gz_sim", executable="create", arguments=["-topic", "robot_description"]),
    ])
"""


@pytest.mark.parametrize(
    "condition",
    ['if os.environ["KIND"] == "x":', "for each in os.listdir():", "while os.getpid():"],
)
def test_a_function_that_may_return_different_values_is_reported(bot: Path, condition: str) -> None:
    file = written(bot, "a.launch.py", FUNCTION.format(condition=condition))
    start = read_launch(file, {})
    assert start.models[0].description.name == "bot.xacro"
    (found,) = coded(start, LAUNCH_VALUE_UNKNOWN, what="return")
    assert (found.values["name"], found.values["used"]) == ("robot", "7")
    assert (found.origin.file, found.origin.line) == (str(file), 6)


@pytest.mark.parametrize("condition", ['if kind == "x":', "if False:", "if None:"])
def test_a_function_with_a_known_condition_is_not(bot: Path, condition: str) -> None:
    file = written(bot, "a.launch.py", FUNCTION.format(condition=condition))
    start = read_launch(file, {})
    assert start.models[0].description.name == "bot.xacro"
    assert not start.diagnostics


def test_a_function_that_returns_the_same_value_twice_is_not(bot: Path) -> None:
    text = FUNCTION.format(condition='if os.environ["KIND"] == "x":')
    text = text.replace("other.xacro", "bot.xacro")
    assert not read_launch(written(bot, "a.launch.py", text), {}).diagnostics


VARIABLE = """
def generate_launch_description():
    name = "bot.xacro"
    {branches}
    file = os.path.join(get_package_share_directory("bot"), "urdf", name)
    return LaunchDescription([
        Node(package="robot_state_publisher", executable="robot_state_publisher",
             parameters=[{{"robot_description": Command(["xacro ", file])}}]),
        Node(package="ros_gz_sim", executable="create", arguments=["-topic", "robot_description"]),
    ])
"""
KNOWN, OTHER = '    name = "bot.xacro"', '    name = "other.xacro"'
IF = 'if os.environ["KIND"] == "x":'


@pytest.mark.parametrize(
    ("branches", "lines"),
    [
        ((IF, OTHER, "else:", KNOWN), (5, 7)),
        ((IF, OTHER, 'elif os.environ["KIND"] == "y":', OTHER, "else:", KNOWN), (5, 9)),
        ((IF, KNOWN, "else:", f"    {IF}", f"    {OTHER}", "    else:", f"    {KNOWN}"), (8, 10)),
        ((OTHER.strip(), IF, KNOWN), (4, 6)),
        ((IF, "    pass", "else:", OTHER, "if None:", OTHER, "else:", KNOWN), None),
        ((IF, KNOWN, "else:", KNOWN), None),
        ((IF, OTHER, "    return None"), None),
        ((IF, "    other = 1", "    name = name", "else:", "    other = 2"), None),
        ((IF, KNOWN), None),
        (("for each in range(2):", f"    {IF}", f"    {KNOWN}", "        break"), None),
        (
            (OTHER.strip(), "for each in range(2):", f"    {IF}", f"    {KNOWN}", "        break"),
            (4, 7),
        ),
    ],
)
def test_a_variable_that_may_have_different_values_is_reported(
    bot: Path, branches: tuple[str, ...], lines: tuple[int, int] | None
) -> None:
    text = VARIABLE.format(branches="\n    ".join(branches))
    file = written(bot, "a.launch.py", text)
    start = read_launch(file, {})
    assert start.models[0].description.name == "bot.xacro"
    found = coded(start, LAUNCH_VALUE_UNKNOWN)
    places = [(each.origin.file, each.origin.line, each.values["used"]) for each in found]
    assert places == ([] if lines is None else [(str(file), lines[0], str(lines[1]))])
    assert all((each.values["what"], each.values["name"]) == ("variable", "name") for each in found)


EXPRESSION = """
x = os.environ["KIND"] == "x"

def generate_launch_description():
    log = "debug" if x else "info"
    file = os.path.join(get_package_share_directory("bot"), "urdf", {file})
    return LaunchDescription([
        LogInfo(msg=log),
        Node(package="robot_state_publisher", executable="robot_state_publisher",
             arguments=["--log-level", log],
             parameters=[{{"robot_description": Command(["xacro ", file, " size:=", {size}])}}]),
        Node(package="ros_gz_sim", executable="create",
             arguments=["-topic", "robot_description", "-z", {z}]),
        Node(package="controller_manager", executable="spawner", arguments=[{controller}]),
    ] + {more})
"""
PLAIN = {"file": '"bot.xacro"', "size": '"1"', "z": '"0.1"', "controller": '"move"', "more": "[]"}


@pytest.mark.parametrize(
    ("changed", "line"),
    [
        ({}, None),
        ({"file": '"bot.xacro" if x else "other.urdf"'}, 6),
        ({"file": '"bot.xacro" if x else "bot.xacro"'}, None),
        ({"size": '"1" if x else "2"'}, 11),
        ({"size": '"1" if True else "2"'}, None),
        ({"z": '"0.1" if x else "0.2"'}, 13),
        ({"controller": '"move" if x else "hold"'}, 14),
        ({"controller": '"move", *([] if not x else ["--inactive"])'}, 14),
        ({"more": '([Node(package="rviz2", executable="rviz2")] if x else [])'}, None),
    ],
)
def test_a_conditional_expression_that_decides_what_is_started_is_reported(
    bot: Path, changed: dict[str, str], line: int | None
) -> None:
    file = written(bot, "a.launch.py", EXPRESSION.format(**{**PLAIN, **changed}))
    start = read_launch(file, {})
    (model,) = start.models
    assert (model.description.name, model.use.arguments) == ("bot.xacro", {"size": "1"})
    assert (model.spawn.place, model.use.spawned) == ({"z": 0.1}, ("move",))
    found = coded(start, LAUNCH_VALUE_UNKNOWN)
    places = [(each.origin.file, each.origin.line, each.values["used"]) for each in found]
    assert places == ([] if line is None else [(str(file), line, str(line))])
    assert all(each.values["what"] == "expression" for each in found)


def test_a_conditional_expression_may_be_in_a_default_or_an_included_file(bot: Path) -> None:
    default = """
def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument("size", default_value="1" if os.environ["KIND"] else "2"),
        Node(package="robot_state_publisher", executable="robot_state_publisher",
             parameters=[{"robot_description": Command(
                 ["xacro ", os.path.join(get_package_share_directory("bot"), "urdf/bot.xacro"),
                  " size:=", LaunchConfiguration("size")])}]),
    ])
"""
    inner = written(bot, "inner.launch.py", default)
    outer = written(
        bot,
        "outer.launch.py",
        """
def generate_launch_description():
    return LaunchDescription([IncludeLaunchDescription(PythonLaunchDescriptionSource(
        os.path.join(get_package_share_directory("bot"), "launch", "inner.launch.py")))])
""",
    )
    for file in (inner, outer):
        start = read_launch(file, {})
        assert start.models[0].use.arguments == {"size": "1"}
        (found,) = coded(start, LAUNCH_VALUE_UNKNOWN, what="expression")
        assert (found.origin.file, found.origin.line) == (str(inner), 4)
    assert not coded(read_launch(inner, {"size": "3"}), LAUNCH_VALUE_UNKNOWN)


def test_a_branch_does_not_know_the_variables_of_the_other(bot: Path) -> None:
    branches = [IF, '    part = "other"', "else:", '    name = f"{part}.xacro"']
    text = VARIABLE.format(branches="\n    ".join(["part = 'bot'", *branches]))
    start = read_launch(written(bot, "a.launch.py", text), {})
    assert start.models[0].description.name == "bot.xacro"


@pytest.mark.parametrize(
    ("process", "world"),
    [
        ('["gazebo", "--verbose", "arena.world", "-s", "libgazebo_ros_factory.so"]', "arena.world"),
        ('["gz sim -r arena.sdf"]', "arena.sdf"),
        ('["rviz2", "-d", "arena.world"]', ""),
    ],
)
def test_a_command_that_starts_gazebo_names_the_world(bot: Path, process: str, world: str) -> None:
    described = f'xacro.process_file("{bot}/urdf/bot.xacro")\n'
    path = written(bot, "a_launch.py", f"{described}ExecuteProcess(cmd={process})\n")
    assert read_launch(path, {}).world == world


def test_gazebos_launch_file_inherits_the_argument_world_in_ros_2(bot: Path) -> None:
    text = 'DeclareLaunchArgument("world", default_value="arena.world")\n'
    text += f'os.popen("xacro {bot}/urdf/bot.xacro").read()\n'
    path = written(bot, "a.launch.py", text)
    assert read_launch(path, {}).world == "arena.world"
    assert read_launch(path, {"world": "mud.world"}).world == "mud.world"


def test_each_spawned_model_has_its_file(bot: Path) -> None:
    """A model from a file is not that of robot_description, and there may be several of one."""
    nodes = "".join(
        f'<node pkg="gazebo_ros" type="spawn_model" name="{name}" args="-model {name} '
        f'-robot_namespace /{name} {source}"/>'
        for name, source in (
            ("a", "-urdf -file $(find bot)/urdf/other.urdf"),
            ("b", "-param robot_description"),
            ("c", "-param robot_description"),
            ("d", "-sdf -file $(find bot)/absent.sdf"),
        )
    )
    described = '<param name="robot_description" textfile="$(find bot)/urdf/bot.xacro"/>'
    start = read_launch(written(bot, "a.launch", f"<launch>{nodes}{described}</launch>"), {})
    assert [(each.spawn.name, each.description.name) for each in start.models] == [
        ("a", "other.urdf"),
        ("b", "bot.xacro"),
        ("c", "bot.xacro"),
    ]
    assert [each.spawn.namespace for each in start.models] == ["a", "b", "c"]
    (found,) = start.diagnostics
    assert found.code is LAUNCH_VALUE_UNKNOWN and found.values == {"what": "model", "name": "d"}


def test_a_description_that_is_only_shown_is_started(bot: Path) -> None:
    text = (
        '<launch><param name="robot_description" textfile="$(find bot)/urdf/bot.xacro"/></launch>'
    )
    (model,) = read_launch(written(bot, "display.launch", text), {}).models
    assert model.description.name == "bot.xacro" and model.spawn.place == {}


@pytest.mark.parametrize(
    "place",
    [
        'os.path.expanduser("~/ws/src/bot/urdf/other.urdf")',
        'get_package_share_directory("bot") + "/other.urdf"',
        '"/opt/other.urdf"',
    ],
)
def test_a_description_at_another_place_is_found_in_the_package(bot: Path, place: str) -> None:
    """Launch files name places on the computers of their authors, or those to which setup.py
    installs a file."""
    path = written(bot, "a.launch.py", f"xacro.process_file({place})\n")
    (model,) = read_launch(path, {}).models
    assert model.description == bot / "urdf/other.urdf"
    (bot / "other").mkdir()
    (bot / "other" / "other.urdf").write_text("<robot/>")
    if "expanduser" not in place:
        with raises(NOT_A_DESCRIPTION):  # which one is unknown
            read_launch(path, {})


@pytest.mark.parametrize(
    ("name", "text", "code"),
    [
        ("absent.launch", None, FILE_MISSING),
        ("a.launch", "<launch/>", NOT_A_DESCRIPTION),
        ("a.launch", "<launch", XML_MALFORMED),
        ("a.launch.py", "def (", NOT_A_DESCRIPTION),
        ("a.xml", "<robot name='a'><link name='b'/></robot>", NOT_A_DESCRIPTION),
        ("a.launch.py", "for a in l:\n" + " x = 1\n" * 10, NOT_A_DESCRIPTION),
    ],
)
def test_a_launch_file_without_a_description_is_an_error(bot, name, text, code) -> None:
    path = bot / "launch" / name if text is None else written(bot, name, text)
    with raises(code):
        read_launch(path, {})


def test_launch_files_are_known_by_their_name_or_contents(bot: Path) -> None:
    for name, text, expected in (
        ("a.launch", "", True),
        ("a.launch.xml", "", True),
        ("a.launch.py", "", True),
        ("start.py", "", True),
        ("a.xml", "<launch/>", True),
        ("b.xml", "<robot/>", False),
        ("a.urdf", "<launch/>", False),
    ):
        assert is_launch_file(written(bot, name, text)) is expected, name
    assert not is_launch_file(bot / "launch")


@pytest.mark.parametrize("tag", ["arg", "let"])
def test_a_constant_is_no_argument(bot: Path, tag: str) -> None:
    text = f'<launch><{tag} name="kind" value="bot"/><param name="robot_description" '
    text += 'textfile="$(find bot)/urdf/$(arg kind).xacro"/></launch>'
    start = read_launch(written(bot, "a.launch", text), {"kind": "other"})
    assert [each.description.name for each in start.models] == ["bot.xacro"]
    (found,) = start.diagnostics
    assert found.code is ARGUMENT_UNKNOWN and found.values["name"] == "kind"


@pytest.mark.wording
@pytest.mark.parametrize(
    ("name", "text"),
    [
        (
            "a.launch",
            """<launch><arg name="height" default="1"/><arg name="kind"/><arg name="b" value="1"/>
            <param name="robot_description" textfile="$(find bot)/urdf/$(arg kind).xacro"/>
            </launch>""",
        ),
        (
            "a.launch.py",
            'DeclareLaunchArgument("height", default_value="1")\nDeclareLaunchArgument("kind")\n',
        ),
    ],
)
def test_required_arguments_are_named(bot: Path, name: str, text: str) -> None:
    with raises(NOT_A_DESCRIPTION) as caught:
        read_launch(written(bot, name, text), {})
    assert "Its arguments: height, kind. Without a value: kind." in caught.value.hint
    assert "Pass kind:=VALUE." in caught.value.hint
    assert 'without a value for "kind"' in str(caught.value)
    assert caught.value.origin is not None
    assert caught.value.origin.line == (1 if name == "a.launch" else 2)


def test_a_required_argument_without_effect_on_the_robot_is_reported(bot: Path) -> None:
    """Also one of an included launch file."""
    robot = '<param name="robot_description" textfile="$(find bot)/urdf/bot.xacro"/>'
    written(bot, "b.launch", '<launch>\n<arg name="port"/></launch>')
    include = '<include file="$(find bot)/launch/b.launch"/>'
    start = read_launch(
        written(bot, "a.launch", f'<launch><arg name="user"/>\n{robot}{include}</launch>'), {}
    )
    assert [each.description.name for each in start.models] == ["bot.xacro"]
    found = [(each.code, each.values["name"], each.origin.line) for each in start.diagnostics]
    assert found == [(LAUNCH_VALUE_UNKNOWN, "user", 1), (LAUNCH_VALUE_UNKNOWN, "port", 2)]
    assert "user:=VALUE" in str(start.diagnostics[0].hint)


@pytest.mark.parametrize(
    ("stated", "robots"),
    [(["other"], ["other.xacro"]), (["other", "other"], ["other.xacro"]), (["other", "bot"], [])],
)
def test_a_value_on_which_all_including_launch_files_agree_is_used(
    bot: Path, stated: list[str], robots: list[str]
) -> None:
    (bot / "urdf" / "other.xacro").write_text((bot / "urdf" / "bot.xacro").read_text())
    text = '<param name="robot_description" textfile="$(find bot)/urdf/$(arg kind).xacro"/>'
    path = written(bot, "robot.launch", f'<launch><arg name="kind"/>{text}</launch>')
    for number, value in enumerate(stated):
        arg = f'<arg name="kind" value="{value}"/>'
        include = f'<include file="$(find bot)/launch/robot.launch">{arg}</include>'
        written(bot, f"{number}.launch", f"<launch>{include}</launch>")
    if not robots:
        with raises(NOT_A_DESCRIPTION):
            read_launch(path, {})
        return
    start = read_launch(path, {})
    assert [each.description.name for each in start.models] == robots
    (note,) = start.diagnostics
    assert (note.severity, note.values["name"]) == ("info", "kind")
    given = read_launch(path, {"kind": "bot"})
    assert [each.description.name for each in given.models] == ["bot.xacro"]
    assert not given.diagnostics


@pytest.mark.parametrize(
    ("content", "world"),
    [
        ("world:=$(find bot)/worlds/arena.world", "arena.world"),
        ("", ""),
        ("world:=$(find other)/worlds/arena.world", "arena.world"),
        ("world:=$(env ARENA)", None),
        ("gui:=$(find other)/gui", None),
        ("robot", None),
        ("spawner", None),
    ],
)
def test_a_launch_file_that_starts_only_a_world_needs_a_known_one(bot, content, world):
    """Without a world it must be sure that none is stated, and a robot must not be missing."""
    name, assigned, value = content.partition(":=")
    file = bot / "launch" / "sim.launch"
    argument = f'<arg name="{name}" value="{value}"/>' if assigned else ""
    more = {
        "robot": '<param name="robot_description" textfile="$(find bot)/urdf/none.urdf"/>',
        "spawner": '<node pkg="gazebo_ros" type="spawn_model" name="s" args="-param robot"/>',
    }.get(content, "")
    file.write_text(f"""<launch><include file="$(find gazebo_ros)/launch/empty_world.launch">
      {argument}</include>{more}</launch>""")
    if world is None:
        with raises(NOT_A_DESCRIPTION):
            read_launch(file, {})
    else:
        start = read_launch(file, {})
        assert (start.models, Path(start.world).name, start.diagnostics) == ((), world, ())


def test_replaced_parts_of_paths_count_and_those_of_texts_are_reported(bot):
    file = bot / "launch" / "sim.launch.py"

    def start(expression: str):
        file.write_text(f"""
share = get_package_share_directory("bot")
with open(os.path.join(share, "urdf", "other.urdf")) as opened:
    text = opened.read()
def generate_launch_description():
    return LaunchDescription([
        Node(package="robot_state_publisher", executable="robot_state_publisher",
             parameters=[{{"robot_description": {expression}}}]),
        Node(package="ros_gz_sim", executable="create", arguments=["-topic", "robot_description"]),
    ])
""")
        started = read_launch(file, {})
        return [each.description.name for each in started.models], started.diagnostics

    xacro = "Command(['xacro ', share + '/urdf/robot.xacro'.replace('robot', 'bot')])"
    assert start(xacro) == (["bot.xacro"], ())
    assert start("text.replace('absent', 'present')") == (["other.urdf"], ())
    names, found = start("text.replace('base', 'body')")
    assert (names, len(found)) == (["other.urdf"], 1)
    assert coded(found, LAUNCH_VALUE_UNKNOWN, what="text", name="other.urdf", used="8")
    # Neither an empty part nor a text that would be too long is an error.
    assert start("text.replace('', 'a' * 9)")[0] == ["other.urdf"]
    with raises(NOT_A_DESCRIPTION):
        start("'aaaaaaaa.urdf'" + ".replace('a', 'aaaaaaaa')" * 6)


def test_a_package_of_another_repository_is_reported(bot: Path) -> None:
    for folder in (bot, bot.parent / "neighbour"):
        (folder / ".git").mkdir(parents=True)
    arm = bot.parent / "neighbour" / "arm"
    arm.mkdir()
    (arm / "package.xml").write_text("<package><name>arm</name></package>")
    (arm / "arm.urdf").write_text((bot / "urdf" / "other.urdf").read_text())
    text = '<launch><param name="robot_description" textfile="$(find arm)/arm.urdf"/></launch>'
    launch = written(bot, "arm.launch", text)
    start = read_launch(launch, {})
    assert [each.description for each in start.models] == [arm / "arm.urdf"]
    assert [each.values["name"] for each in start.diagnostics] == ["arm"]
