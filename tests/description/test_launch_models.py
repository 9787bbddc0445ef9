"""Launch files with several models: descriptions, namespaces, conditions, inherited arguments."""

from __future__ import annotations

from pathlib import Path

import pytest

from cartwheel.codes.files import LAUNCH_VALUE_UNKNOWN
from cartwheel.description.launches import LaunchStart, read_launch
from cartwheel.errors import DescriptionError


@pytest.fixture
def bot(tmp_path: Path) -> Path:
    """A package with two descriptions."""
    folder = tmp_path / "bot"
    for name in ("launch", "urdf"):
        (folder / name).mkdir(parents=True)
    (folder / "package.xml").write_text("<package><name>bot</name></package>")
    for name in ("bot.xacro", "other.urdf"):
        (folder / "urdf" / name).write_text('<robot name="bot"><link name="base"/></robot>')
    return folder


def written(bot: Path, name: str, text: str) -> Path:
    path = bot / "launch" / name
    path.write_text(text)
    return path


TWO_GROUPS = """<launch>
  <group ns="one"><param name="robot_description" textfile="$(find bot)/urdf/bot.xacro"/>
    <node pkg="gazebo_ros" type="spawn_model" name="s" args="-param robot_description -model a"/>
  </group>
  <include ns="two" file="$(find bot)/launch/other.launch"/>
  <node pkg="gazebo_ros" type="spawn_model" name="s" args="-param two/robot_description -model c"/>
</launch>"""
OTHER = """<launch>
  <param name="robot_description" textfile="$(find bot)/urdf/other.urdf"/>
  <group ns="{group}"><node pkg="gazebo_ros" type="spawn_model" name="s"
    args="-param /two/robot_description -model b"/></group>
</launch>"""


@pytest.mark.parametrize(("group", "namespace"), [("", "two"), ("sub/", "two/sub"), ("/x", "x")])
def test_groups_have_descriptions_and_namespaces_of_their_own_in_xml(
    bot: Path, group: str, namespace: str
) -> None:
    written(bot, "other.launch", OTHER.format(group=group))
    start = read_launch(written(bot, "a.launch", TWO_GROUPS), {})
    assert started(start) == [
        ("a", "bot.xacro", "one"),
        ("b", "other.urdf", namespace),
        ("c", "other.urdf", ""),
    ]


def started(start: LaunchStart) -> list[tuple[str, str, str]]:
    """Name, description and namespace of each model."""
    return [(each.spawn.name, each.description.name, each.spawn.namespace) for each in start.models]


@pytest.mark.parametrize(
    ("written_in", "source"),
    [
        ('command="$(find xacro)/xacro $(find bot)/urdf/{}"', "hull"),
        ('textfile="$(find bot)/urdf/{}"', "/one/hull"),
    ],
)
def test_in_ros_1_a_spawner_names_the_parameter_with_its_description(
    bot: Path, written_in: str, source: str
) -> None:
    """What no spawner names is not a description."""
    text = f"""<launch><group ns="one">
      <node pkg="gazebo_ros" type="spawn_model" name="s" args="-param {source} -model a"/>
      <param name="spare" {written_in.format("bot.xacro")}/>
      <param name="hull" {written_in.format("other.urdf")}/></group>
      <node pkg="gazebo_ros" type="other" name="hull"><param name="hull" textfile="no.urdf"/></node>
    </launch>"""
    start = read_launch(written(bot, "a.launch", text), {})
    assert started(start) == [("a", "other.urdf", "one")]
    assert not start.diagnostics


def test_a_namespace_in_xml_for_ros_2(bot: Path) -> None:
    text = """<launch><group><push_ros_namespace namespace="one"/>
      <node pkg="gazebo_ros" exec="spawn_entity.py" namespace="$(var space)"
        args="-file $(find-pkg-share bot)/urdf/other.urdf -entity a"/></group>
      <node pkg="ros_gz_sim" exec="create" namespace="two"
        args="-file $(find-pkg-share bot)/urdf/other.urdf -name b"/></launch>"""
    path = written(bot, "a.launch.xml", text)
    found = [("a", "other.urdf", "one/sub"), ("b", "other.urdf", "")]
    assert started(read_launch(path, {"space": "sub"})) == found
    start = read_launch(path, {})
    assert started(start) == [("a", "other.urdf", ""), found[1]]
    (unknown,) = start.diagnostics
    assert unknown.code is LAUNCH_VALUE_UNKNOWN and unknown.values == {"what": "namespace"}


LOOP = """
for name in ["bot.xacro", "other.urdf"]:
    file = PathJoinSubstitution([FindPackageShare("bot"), "urdf", name])
    {publish}
    Node(package="ros_gz_sim", executable="create",
         arguments=["-name", name, {source}])
"""
STATE_PUBLISHER = (
    'Node(package="robot_state_publisher", namespace=name, parameters=[{"robot_description": %s}])'
)


@pytest.mark.parametrize(
    ("publish", "source"),
    [
        (STATE_PUBLISHER % 'Command(["xacro ", file])', '"-topic", f"/{name}/robot_description"'),
        (STATE_PUBLISHER % "open(file).read()", '"-topic", name + "/robot_description"'),
        ("text = xacro.process_file(file).toxml()", '"-string", text'),
    ],
)
def test_each_model_in_python_has_its_description(bot: Path, publish: str, source: str) -> None:
    path = written(bot, "a.launch.py", LOOP.format(publish=publish, source=source))
    assert started(read_launch(path, {})) == [
        ("bot.xacro", "bot.xacro", ""),
        ("other.urdf", "other.urdf", ""),
    ]


def spawner(name: str, more: str = "") -> str:
    """A node in Python that spawns a model."""
    return (
        'Node(package="gazebo_ros", executable="spawn_entity.py", arguments=["-entity", '
        f'"{name}", "-file", os.path.join(FindPackageShare("bot"), "urdf/other.urdf")]{more})'
    )


def test_namespaces_of_nodes_and_groups_in_python(bot: Path) -> None:
    text = f"""
GroupAction([PushRosNamespace(LaunchConfiguration("space")), {spawner("a")},
             GroupAction([PushRosNamespace("sub"), {spawner("b", ', namespace="arm"')}]),
             {spawner("c")}])
DeclareLaunchArgument("space", default_value="one")
{spawner("d")}
"""
    path = written(bot, "a.launch.py", text)
    spaces = {name: space for name, _, space in started(read_launch(path, {}))}
    assert spaces == {"a": "one", "b": "one/sub/arm", "c": "one", "d": ""}


GROUPED = """
def generate_launch_description():
    first = {one}
    second = {two}
    third = {three}
    later = RegisterEventHandler(OnProcessExit(target_action=first, on_exit=[third]))
    group = GroupAction(actions=[PushRosNamespace("one"), first, SetParameter("a", "b")])
    never = GroupAction([PushRosNamespace("two"), second], condition=IfCondition("false"))
    return LaunchDescription([later, group, never])
"""


def test_an_action_in_a_variable_has_the_namespace_of_the_group_that_contains_it(bot: Path) -> None:
    text = GROUPED.format(one=spawner("a"), two=spawner("b"), three=spawner("c"))
    assert started(read_launch(written(bot, "a.launch.py", text), {})) == [
        ("c", "other.urdf", ""),
        ("a", "other.urdf", "one"),
    ]


@pytest.mark.parametrize(
    "collected",
    [
        "nodes = [first, other]",
        "nodes = []\nnodes.append(first)\nnodes.append(other)",
        "nodes = [*[first], other]",
    ],
)
@pytest.mark.parametrize(
    "used",
    [
        "for number, node in enumerate(nodes, start=1):\n"
        '    GroupAction([PushRosNamespace(f"s{number}"), nodes[number - 1]])',
        'GroupAction([PushRosNamespace("s1"), nodes[0]])\n'
        'GroupAction([PushRosNamespace("s2"), *nodes])',
        'for space, node in zip(["s1", "s2"], nodes):\n'
        "    GroupAction([PushRosNamespace(space), node])",
    ],
    ids=["enumerate", "starred", "zip"],
)
def test_actions_in_lists_have_the_namespaces_of_their_groups(
    bot: Path, collected: str, used: str
) -> None:
    text = f"first = {spawner('a')}\nother = {spawner('b')}\n{collected}\n{used}\n"
    start = read_launch(written(bot, "a.launch.py", text), {})
    assert started(start) == [("a", "other.urdf", "s1"), ("b", "other.urdf", "s2")]


def test_a_list_of_actions_starts_where_it_is_used(bot: Path) -> None:
    text = f"""
nodes = [{spawner("a")}]
nodes += [{spawner("b")}]
GroupAction(actions=[PushRosNamespace("one")] + nodes)
"""
    start = read_launch(written(bot, "a.launch.py", text), {})
    assert started(start) == [("a", "other.urdf", "one"), ("b", "other.urdf", "one")]


def test_an_action_whose_use_is_unknown_is_started(bot: Path) -> None:
    text = f"""
GroupAction([PushRosNamespace("one"), PushRosNamespace("two")])
spawn = {spawner("a")}
Composed(entities(lambda: spawn))
"""
    start = read_launch(written(bot, "a.launch.py", text), {})
    assert started(start) == [("a", "other.urdf", "")]


@pytest.mark.parametrize(
    "calls",
    [
        'robot("a", "one", x=1.0) + robot("b", x=2.0)',
        '[OpaqueFunction(function=launched, args=["a"], kwargs={"space": "one", "x": 1.0}),'
        ' OpaqueFunction(function=launched, args=["b"], kwargs={"x": 2.0})]',
        "[each for name, space, x in LIST for each in robot(name, space, x=x)]",
        '[launch.actions.OpaqueFunction(function=launched, args=["a", "one"], kwargs={"x": 1.0}),'
        ' launch.actions.OpaqueFunction(function=launched, args=["b"], kwargs={"x": 2.0})]',
        'robot(*["a", "one"], **{"x": 1.0}) + robot(*["b"], **{"x": 2.0})',
    ],
    ids=["calls", "opaque functions", "comprehension", "modules", "stars"],
)
def test_functions_of_a_file_are_evaluated_for_their_arguments(bot: Path, calls: str) -> None:
    node = spawner("NAME").replace('"NAME"', 'name, "-x", str(x)')
    other = """
def launched(context, name, space="two", *, x=0.0):
    return robot(name, space, x=x)"""
    other = other if "launched" in calls else ""
    text = f"""
LIST = [("a", "one", 1.0), ("b", "two", 2.0)]
def generate_launch_description():
    return LaunchDescription({calls})
{other}
def robot(name, space="two", *, x=0.0):
    if name == "none":
        return []
    spawn = {node}
    return [GroupAction([PushRosNamespace(space), spawn])]
"""
    start = read_launch(written(bot, "a.launch.py", text), {})
    assert started(start) == [("a", "other.urdf", "one"), ("b", "other.urdf", "two")]
    assert [dict(each.spawn.place) for each in start.models] == [{"x": 1.0}, {"x": 2.0}]


def test_functions_that_call_themselves_end(bot: Path) -> None:
    text = f"""
def many(name):
    return [{spawner("a")}, many(name), many(name), many(name)]
many("a")
"""
    with pytest.raises(DescriptionError):
        read_launch(written(bot, "a.launch.py", text.replace("other.urdf", "absent.urdf")), {})


def test_a_function_returns_the_value_of_its_branch(bot: Path) -> None:
    text = """
def file(kind):
    if kind == "bot":
        return "bot.xacro"
    return "other.urdf"
xacro.process_file(os.path.join(FindPackageShare("bot"), "urdf", file("bot")))
"""
    (model,) = read_launch(written(bot, "a.launch.py", text), {}).models
    assert model.description.name == "bot.xacro"


@pytest.mark.parametrize(
    "body",
    [
        """
    for each in ROBOTS:
        if each["name"] == name:
            return each["file"]
    return "absent.urdf\"""",
        """
    for each in ROBOTS:
        if each["name"] != name:
            continue
        file = each["file"]
        break
    else:
        file = "absent.urdf"
    return file""",
        """
    try:
        return dict(a="bot.xacro", b="other.urdf")[name]
    except KeyError:
        pass
    return "absent.urdf\"""",
    ],
    ids=["return", "continue and break", "try"],
)
def test_loops_and_functions_end_where_python_ends_them(bot: Path, body: str) -> None:
    text = f"""
ROBOTS = [{{"name": "a", "file": "bot.xacro"}}, {{"name": "b", "file": "other.urdf"}}]
def file(name):{body}
for name in ["a", "b"]:
    Node(package="gazebo_ros", executable="spawn_entity.py", arguments=["-entity", name, "-file",
         os.path.join(FindPackageShare("bot"), "urdf", file(name))])
"""
    start = read_launch(written(bot, "a.launch.py", text), {})
    assert started(start) == [("a", "bot.xacro", ""), ("b", "other.urdf", "")]


def test_a_loop_over_unknown_values_may_not_be_executed(bot: Path) -> None:
    text = f"""
def launched(name):
    for each in unknown():
        return []
    return [{spawner("a")}]
launched("a")
"""
    assert started(read_launch(written(bot, "a.launch.py", text), {})) == [("a", "other.urdf", "")]


def test_functions_that_nest_too_deeply_end(bot: Path) -> None:
    levels = 60
    functions = "".join(
        f"def f{number}(x):\n    return {'[' * levels}f{number + 1}(x){']' * levels}\n"
        for number in range(9)
    )
    text = f"{spawner('a')}\n{functions}def f9(x):\n    return x\nf0(1)\n"
    start = read_launch(written(bot, "a.launch.py", text), {})
    assert all(name == "a" for name, _, _ in started(start))


CONTROLLED = """
def robot(name):
    return GroupAction([
        PushRosNamespace(name),
        Node(package="ros_gz_sim", executable="create", arguments=["-name", name, "-file",
             os.path.join(FindPackageShare("bot"), "urdf/other.urdf")]),
        Node(package="controller_manager", executable="spawner", arguments=[name + "_arm",
             "--param-file", os.path.join(FindPackageShare("bot"), "config", name + ".yaml")]),
    ])
robot("one")
robot("two")
Node(package="ros_gz_sim", executable="create", arguments=["-name", "three", "-file",
     os.path.join(FindPackageShare("bot"), "urdf/other.urdf")])
Node(package="controller_manager", executable="spawner", arguments=["base", "leg", MANAGER])
"""


@pytest.mark.parametrize(
    ("manager", "names"),
    [
        ('"--activate-as-group"', (("one_arm",), ("two_arm",), ("base", "leg"))),
        ('"--inactive"', (("one_arm",), ("two_arm",), None)),
        ('"-c", "/two/controller_manager"', (("one_arm",), ("two_arm", "base", "leg"), None)),
        ('"--unload-on-kill", "top"', (("one_arm",), ("two_arm",), ("base", "leg", "top"))),
        (
            '"--controller-manager=/two/controller_manager"',
            (("one_arm",), ("two_arm", "base", "leg"), None),
        ),
        ('"-c", [UNKNOWN, "/controller_manager"]', (("one_arm",), ("two_arm",), ("base", "leg"))),
    ],
)
def test_each_robot_has_the_controllers_of_its_namespace(
    bot: Path, manager: str, names: tuple[tuple[str, ...] | None, ...]
) -> None:
    (bot / "config").mkdir()
    for name in ("one", "two"):
        (bot / f"config/{name}.yaml").write_text("{}")
    path = written(bot, "a.launch.py", CONTROLLED.replace("MANAGER", manager))
    uses = [each.use for each in read_launch(path, {}).models]
    for use, expected in zip(uses, names, strict=True):
        assert expected is None or use.spawned == expected
    assert [each.name for each in uses[0].controllers] == ["one.yaml"]
    assert [each.name for each in uses[1].controllers] == ["two.yaml"]
    # A robot without controllers in its namespace has all that a file may define for it.
    assert [each.name for each in uses[2].controllers] == ["one.yaml", "two.yaml"]


def test_in_xml_each_robot_has_the_controllers_of_its_namespace(bot: Path) -> None:
    (bot / "config").mkdir()
    group = """<group ns="{0}">
    <param name="robot_description" textfile="$(find bot)/urdf/bot.xacro"/>
    <rosparam file="$(find bot)/config/{0}.yaml"/>
    <node pkg="gazebo_ros" type="spawn_model" name="s" args="-param robot_description -model {0}"/>
    <node pkg="controller_manager" type="spawner" name="c" args="{0}_arm"/></group>"""
    for name in ("one", "two"):
        (bot / f"config/{name}.yaml").write_text("a: {type: b}")
    text = f"<launch>{group.format('one')}{group.format('two')}</launch>"
    uses = [each.use for each in read_launch(written(bot, "a.launch", text), {}).models]
    assert [each.spawned for each in uses] == [("one_arm",), ("two_arm",)]
    assert [[file.name for file in each.controllers] for each in uses] == [
        ["one.yaml"],
        ["two.yaml"],
    ]


@pytest.mark.parametrize(
    ("topic", "remappings", "space", "ros"),
    [
        ("/model/a/odometry", '[("/model/a/odometry", "odom")]', "one", "/one/odom"),
        ("/model/a/odometry", '[("/model/a/odometry", "/odom")]', "one", "/odom"),
        ("odometry", "[]", "one", "/one/odometry"),
        ("/model/a/odometry", "[]", "one", None),
        ("/model/a/odometry", '[("/model/a/odometry", UNKNOWN)]', "one", None),
        ("/model/a/odometry", '[], "-r", "/model/a/odometry:=odom", "-r", "x"', "one", "/one/odom"),
        ("/model/a/odometry", '[], "--remap", "/model/a/odometry:=/odom"', "one", "/odom"),
        ("/model/a/odometry", '[], "-r", "__ns:=/two"', "one", None),
    ],
)
def test_the_arguments_of_a_bridge_rename_topics(
    bot: Path, topic: str, remappings: str, space: str, ros: str | None
) -> None:
    remappings, _, more = remappings.partition("], ")
    remappings = remappings.removesuffix("]") + "]"
    text = f"""
xacro.process_file("{bot}/urdf/bot.xacro")
bridge = Node(package="ros_gz_bridge", executable="parameter_bridge", remappings={remappings},
     arguments=["{topic}@nav_msgs/msg/Odometry[gz.msgs.Odometry", "--ros-args", {more}])
GroupAction([PushRosNamespace("{space}"), bridge])
"""
    renamed = read_launch(written(bot, "a.launch.py", text), {}).renamed
    assert [(each.gz, each.ros) for each in renamed] == ([] if ros is None else [(topic, ros)])


@pytest.mark.parametrize(
    ("condition", "expected"),
    [
        ("IfCondition(sim)", True),
        ("UnlessCondition(sim)", False),
        ("IfCondition(NotSubstitution(sim))", False),
        ('IfCondition(EqualsSubstitution(kind, "arm"))', True),
        ('UnlessCondition(predicate_expression=EqualsSubstitution(kind, "arm"))', False),
        ('IfCondition(NotEqualsSubstitution(kind, "arm"))', False),
        ('IfCondition(AndSubstitution(sim, "false"))', False),
        ('IfCondition(OrSubstitution(sim, "false"))', True),
        ("IfCondition(PythonExpression([\"'\", kind, \"' == 'leg'\"]))", False),
        ("IfCondition(LaunchConfiguration('unknown'))", True),
        ("IfCondition(AndSubstitution())", True),
        ("other", True),
    ],
)
def test_conditions_of_actions_in_python(bot: Path, condition: str, expected: bool) -> None:
    text = f"""
sim, kind = LaunchConfiguration("sim"), LaunchConfiguration("kind")
DeclareLaunchArgument("sim", default_value="True")
DeclareLaunchArgument("kind", default_value="arm")
{spawner("always")}
{spawner("one", f", condition={condition}")}
GroupAction([{spawner("two")}], condition={condition})
"""
    names = [name for name, _, _ in started(read_launch(written(bot, "a.launch.py", text), {}))]
    assert names == (["always", "one", "two"] if expected else ["always"])


def test_branches_of_known_conditions_in_python(bot: Path) -> None:
    text = f"""
def start(context):
    kind = LaunchConfiguration("kind").perform(context)
    if kind == "arm":
        {spawner("arm")}
    elif kind == unknown:
        {spawner("perhaps")}
    else:
        {spawner("leg")}
DeclareLaunchArgument("kind", default_value="arm")
OpaqueFunction(function=start)
"""
    path = written(bot, "a.launch.py", text)
    assert [each[0] for each in started(read_launch(path, {}))] == ["arm"]
    assert [each[0] for each in started(read_launch(path, {"kind": "b"}))] == ["perhaps", "leg"]


@pytest.mark.parametrize("name", ["parent.launch.py", "parent.launch"])
def test_included_files_inherit_arguments_in_ros_2(bot: Path, name: str) -> None:
    included = f"{bot}/launch/child.launch.py"
    written(
        bot,
        "child.launch.py",
        'DeclareLaunchArgument("kind", default_value="bot.xacro")\n'
        'xacro.process_file(os.path.join(FindPackageShare("bot"), "urdf", '
        'LaunchConfiguration("kind")))\n',
    )
    python = 'DeclareLaunchArgument("kind", default_value="other.urdf")\n'
    python += f'IncludeLaunchDescription("{included}")\n'
    text = f'<launch><arg name="kind" default="other.urdf"/><include file="{included}"/></launch>'
    path = written(bot, name, python if name.endswith("py") else text)
    assert read_launch(path, {}).models[0].description.name == "other.urdf"
    assert read_launch(path, {"kind": "bot.xacro"}).models[0].description.name == "bot.xacro"


def test_a_file_in_python_that_begins_with_a_byte_order_mark(bot: Path) -> None:
    path = written(bot, "a.launch.py", "\ufeff" + spawner("a") + "\n")
    assert [each[0] for each in started(read_launch(path, {}))] == ["a"]


def test_a_file_at_another_place_is_spawned(bot: Path) -> None:
    """The file of a model is found in the package, as that of robot_description is."""
    text = spawner("a").replace('FindPackageShare("bot")', '"/opt/ws/src/bot"')
    assert started(read_launch(written(bot, "a.launch.py", text), {})) == [("a", "other.urdf", "")]


@pytest.mark.wording
@pytest.mark.parametrize("group", ["", "one"])
def test_a_robot_whose_description_is_absent_is_not_replaced_by_another(
    bot: Path, group: str
) -> None:
    """A misspelt file, or a package that is not found, would otherwise be the crate."""
    for stated in ("$(find bot)/urdf/bott.xacro", "$(find other_bot)/urdf/robot.xacro"):
        text = f"""<launch>
          <node pkg="gazebo_ros" type="spawn_model" name="a"
            args="-urdf -file $(find bot)/urdf/other.urdf -model crate"/>
          <group ns="{group}"><param name="robot_description" command="xacro {stated}"/>
          <node pkg="gazebo_ros" type="spawn_model" name="b"
            args="-urdf -param robot_description -model robot"/></group></launch>"""
        start = read_launch(written(bot, "a.launch", text), {})
        assert [each.spawn.name for each in start.models] == ["crate"]
        (found,) = start.diagnostics
        assert found.values == {"what": "model", "name": "robot"}
        assert ("bott.xacro" if "bott" in stated else 'package "other_bot"') in found.hint


def test_a_missing_configuration_of_the_bridge_is_reported(bot: Path) -> None:
    text = f'xacro.process_file("{bot}/urdf/bot.xacro")\n'
    text += 'RosGzBridge(bridge_name="b", config_file="/absent/bridge.yaml")\n'
    (found,) = read_launch(written(bot, "a.launch.py", text), {}).diagnostics
    assert found.values == {"what": "bridge", "name": "/absent/bridge.yaml"}


REMAPPED = """
share = get_package_share_directory("bot")

def generate_launch_description():
    return LaunchDescription([
        Node(package="robot_state_publisher", executable="robot_state_publisher", {space}
             parameters=[{{"robot_description":
                           Command(["xacro ", os.path.join(share, "urdf", "other.urdf")])}}],
             remappings=[("{old}", "{new}"), ("/tf", "tf")]),
        Node(package="robot_state_publisher", executable="robot_state_publisher", {space}
             parameters=[{{"robot_description":
                           Command(["xacro ", os.path.join(share, "urdf", "bot.xacro")])}}]),
        Node(package="ros_gz_sim", executable="create", {space}
             arguments=["-topic", "robot_description", "-name", "one"]),
        Node(package="ros_gz_sim", executable="create", {space}
             arguments=["-topic", "dock_description", "-name", "dock"]),
    ])
"""


@pytest.mark.parametrize(
    ("space", "old", "new"),
    [
        ("", "robot_description", "dock_description"),
        ("", "/robot_description", "/dock_description"),
        ('namespace="x",', "robot_description", "dock_description"),
        ('namespace="x",', "/x/robot_description", "/x/dock_description"),
    ],
)
def test_publishers_of_two_descriptions_have_topics_of_their_own(
    bot: Path, space: str, old: str, new: str
) -> None:
    """Such as those of a robot and of its dock."""
    text = REMAPPED.format(space=space, old=old, new=new)
    found = [each[:2] for each in started(read_launch(written(bot, "a.launch.py", text), {}))]
    assert found == [("one", "bot.xacro"), ("dock", "other.urdf")]
