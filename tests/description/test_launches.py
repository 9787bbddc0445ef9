"""What launch files say about robots."""

from pathlib import Path

import pytest

from cartwheel.description.launches import alternatives, chosen, launches_near

ROBOT = '<robot name="arm"><link name="base"/></robot>'
INCLUDED = """import os
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import Command, LaunchConfiguration

raise SystemExit("never executed")

def generate_launch_description():
    share = os.path.join(get_package_share_directory("arm"))
    xacro_file = os.path.join(share, "urdf", "arm.urdf.xacro")
    text = Command(["xacro ", xacro_file, " sim_mode:=", LaunchConfiguration("sim"),
                    " prefix:=", LaunchConfiguration("prefix"), " seed:=", clock()])
    return LaunchDescription([
        DeclareLaunchArgument("sim", default_value="false"),
        DeclareLaunchArgument("prefix", default_value="left_"),
        Node(package="robot_state_publisher", parameters=[{"robot_description": text}]),
    ])
"""
STARTER = """from launch import LaunchDescription

package = "arm"
share = get_package_share_directory(package)

def generate_launch_description():
    included = IncludeLaunchDescription(
        PythonLaunchDescriptionSource([PathJoinSubstitution(
            [FindPackageShare(package), "launch", "rsp.launch.py"])]),
        launch_arguments={"sim": "true"}.items(),
    )
    spawn = Node(package="ros_gz_sim", executable="create", arguments=["-topic", "description"])
    start = Node(package="controller_manager", executable="spawner",
                 arguments=["arm_controller", "--controller-manager", "/controller_manager",
                            "--param-file", f"{share}/config/a.yaml"])
    return LaunchDescription([included, spawn, TimerAction(period=3.0, actions=[start])])
"""
ROS1 = """<launch>
  <arg name="model" default="$(find arm)/urdf/arm.urdf.xacro"/>
  <arg name="gripper" default="true"/>
  <include file="$(find gazebo_ros)/launch/empty_world.launch"/>
  <group if="$(arg gripper)">
    <param name="robot_description" command="$(find xacro)/xacro --inorder '$(arg model)'
        gripper:=$(arg gripper) user:=$(eval clock())"/>
  </group>
  <group unless="$(arg gripper)">
    <param name="robot_description" command="xacro '$(arg model)' gripper:=no"/>
  </group>
  <include file="$(find arm)/launch/control.launch"/>
</launch>"""
CONTROL = """<launch>
  <rosparam file="$(find arm)/config/a.yaml" command="load"/>
  <node name="s" pkg="controller_manager" type="spawner" args="arm_controller joints --timeout 20"/>
</launch>"""
ROS2_XML = """<launch>
  <let name="path" value="$(find-pkg-share arm)/urdf/arm.urdf.xacro"/>
  <node pkg="robot_state_publisher" exec="robot_state_publisher">
    <param name="robot_description" value="$(command 'xacro $(var path) sim:=true')"/>
  </node>
  <node pkg="ros_gz_sim" exec="create" args="-topic robot_description"/>
</launch>"""


@pytest.fixture
def package(tmp_path):
    """A package with a robot, and launch files by name."""

    def write(**launch):
        folder = tmp_path / "arm"
        for path, text in {
            "package.xml": "<package><name>arm</name></package>",
            "urdf/arm.urdf.xacro": ROBOT,
            "config/a.yaml": "arm_controller: {type: a/B}",
            **{f"launch/{name.replace('_dot_', '.')}": text for name, text in launch.items()},
        }.items():
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            (folder / path).write_text(text)
        return folder

    return write


def test_python_launch_files_are_parsed_and_never_executed(package):
    folder = package(rsp_dot_launch_dot_py=INCLUDED, sim_dot_launch_dot_py=STARTER)
    use = chosen(folder / "urdf/arm.urdf.xacro", launches_near(folder))
    assert use.file == folder / "launch/sim.launch.py"
    assert use.simulated
    assert use.arguments == {"sim_mode": "true", "prefix": "left_"}
    assert use.unknown == 1
    assert use.spawned == ("arm_controller",)
    assert use.controllers == (folder / "config/a.yaml",)


def test_defaults_are_used_where_no_launch_file_gives_a_value(package):
    folder = package(rsp_dot_launch_dot_py=INCLUDED)
    use = chosen(folder / "urdf/arm.urdf.xacro", launches_near(folder))
    assert use.arguments == {"sim_mode": "false", "prefix": "left_"}
    assert not use.simulated


@pytest.mark.parametrize(
    ("condition", "expected"),
    [('side == "left"', "yes"), ('side != "left"', "no"), ("side", "yes"), ("clock()", "yes")],
)
def test_conditions_on_known_texts_choose_a_value(package, condition, expected):
    text = INCLUDED.replace(
        'LaunchConfiguration("sim")', f'"yes" if {condition} else "no"'
    ).replace("    share =", '    side = "left"\n    share =')
    folder = package(rsp_dot_launch_dot_py=text)
    use = chosen(folder / "urdf/arm.urdf.xacro", launches_near(folder))
    assert use.arguments["sim_mode"] == expected


def test_launch_files_of_ros1_name_arguments_controllers_and_conditions(package):
    folder = package(sim_dot_launch=ROS1, control_dot_launch=CONTROL)
    use = chosen(folder / "urdf/arm.urdf.xacro", launches_near(folder))
    assert use.file == folder / "launch/sim.launch"
    assert use.simulated
    assert use.arguments == {"gripper": "true"}
    assert use.unknown == 1
    assert use.spawned == ("arm_controller", "joints")
    assert use.controllers == (folder / "config/a.yaml",)
    (control,) = [each for each in launches_near(folder) if each.description is None]
    assert control.file == folder / "launch/control.launch"


def test_an_included_file_of_ros1_may_be_given_a_default(package):
    describe = ROS1.replace('default="true"', 'default="false"')
    folder = package(
        sim_dot_launch="""<launch><arg name="gripper" default="true"/>
            <include file="$(find gazebo_ros)/launch/empty_world.launch"/>
            <include file="$(find arm)/launch/describe.launch">
            <arg name="gripper" default="$(arg gripper)"/></include></launch>""",
        describe_dot_launch=describe.replace(
            '<include file="$(find gazebo_ros)/launch/empty_world.launch"/>', ""
        ),
    )
    use = chosen(folder / "urdf/arm.urdf.xacro", launches_near(folder))
    assert use.file == folder / "launch/sim.launch"
    assert use.arguments == {"gripper": "true"}


def test_xacro_ignores_an_argument_without_a_value(package):
    """As rosgraph's load_mappings does, and a variable that is not set is empty in roslaunch."""
    text = ROS1.replace(
        "user:=$(eval clock())", "extras:=$(optenv CARTWHEEL_NO_SUCH_NAME)\n user:=me"
    )
    folder = package(sim_dot_launch=text)
    use = chosen(folder / "urdf/arm.urdf.xacro", launches_near(folder))
    assert use.arguments == {"gripper": "true", "user": "me"}
    assert use.unknown == 0


@pytest.mark.parametrize("words", ["--inactive b", "b --stopped", "--load-only b", "load b"])
def test_controllers_that_a_spawner_only_loads_are_not_started(package, words):
    more = f'<node name="m" pkg="controller_manager" type="spawner" args="{words}"/></launch>'
    folder = package(sim_dot_launch=ROS1, control_dot_launch=CONTROL.replace("</launch>", more))
    use = chosen(folder / "urdf/arm.urdf.xacro", launches_near(folder))
    assert use.spawned == ("arm_controller", "joints")


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ("unspawner", "arm_controller"),
        ("controller_manager", "stop arm_controller"),
        ("controller_manager", "list"),
    ],
)
def test_other_programs_of_ros1_start_no_controller(package, kind, words):
    node = f'<node name="s" pkg="controller_manager" type="{kind}" args="{words}"/>'
    folder = package(sim_dot_launch=ROS1, control_dot_launch=f"<launch>{node}</launch>")
    use = chosen(folder / "urdf/arm.urdf.xacro", launches_near(folder))
    assert (use.spawned, use.loaded) == ((), ())


def test_a_node_of_ros1_calls_a_service_that_starts_controllers(package):
    request = "call /controller_manager/switch_controller &quot;start_controllers: ['a', 'b']&quot;"
    node = f'<node name="s" pkg="rosservice" type="rosservice" args="{request}"/>'
    folder = package(sim_dot_launch=ROS1, control_dot_launch=f"<launch>{node}</launch>")
    use = chosen(folder / "urdf/arm.urdf.xacro", launches_near(folder))
    assert use.spawned == ("a", "b")


def test_commands_in_launch_files_of_ros2_in_xml(package):
    command = "ros2 control load_controller --set-state active arm_controller"
    text = ROS2_XML.replace("</launch>", f'<executable cmd="{command}"/></launch>')
    folder = package(sim_dot_launch_dot_xml=text)
    use = chosen(folder / "urdf/arm.urdf.xacro", launches_near(folder))
    assert use.spawned == ("arm_controller",)


def test_launch_files_of_ros2_in_xml(package):
    folder = package(sim_dot_launch_dot_xml=ROS2_XML)
    use = chosen(folder / "urdf/arm.urdf.xacro", launches_near(folder))
    assert use.simulated
    assert use.arguments == {"sim": "true"}


def test_arguments_without_a_space_between_them_are_unknown(package):
    folder = package(a_dot_launch_dot_py=INCLUDED.replace(" prefix:=", "prefix:="))
    use = chosen(folder / "urdf/arm.urdf.xacro", launches_near(folder))
    assert use.arguments == {}


@pytest.mark.parametrize(
    "text",
    [
        "def broken(:",
        "x = " + "(" * 5000,
        "while True:\n    pass",
        "include = IncludeLaunchDescription(PythonLaunchDescriptionSource(__file__))",
    ],
)
def test_broken_and_recursive_launch_files_say_nothing(package, text):
    folder = package(a_dot_launch_dot_py=text)
    assert launches_near(folder) == ()


def test_a_launch_file_in_xml_that_includes_itself_ends(package):
    folder = package(a_dot_launch='<launch><include file="$(dirname)/a.launch"/></launch>')
    assert launches_near(folder) == ()


def test_a_document_that_xacro_processes_in_place_has_the_arguments(package):
    text = """def generate_launch_description():
    path = os.path.join(get_package_share_directory("arm"), "urdf", "arm.urdf.xacro")
    layout = input("Layout: ")
    if layout == "1":
        table = "true"
    elif layout == "2":
        table = "false"
    document = xacro.parse(open(path))
    xacro.process_doc(document, mappings={"table": table, "prefix": "left_"})
    description = {"robot_description": document.toxml()}
"""
    folder = package(arm_dot_launch_dot_py=text)
    use = chosen(folder / "urdf/arm.urdf.xacro", launches_near(folder))
    # Which branch is executed is unknown, so the last value is used.
    assert use.arguments == {"table": "false", "prefix": "left_"}


def test_a_part_of_a_joined_path_may_be_a_list_of_substitutions(package):
    text = """def generate_launch_description():
    name = LaunchConfiguration("name", default="arm")
    path = PathJoinSubstitution([FindPackageShare("arm"), "urdf", [name, ".urdf.xacro"]])
    Node(package="robot_state_publisher",
         parameters=[{"robot_description": Command(["xacro ", path])}])
    Node(package="controller_manager", executable="spawner", arguments=[[name, "_controller"]])
"""
    folder = package(arm_dot_launch_dot_py=text)
    use = chosen(folder / "urdf/arm.urdf.xacro", launches_near(folder))
    assert use.spawned == ("arm_controller",)


COMMAND = """def generate_launch_description():
    share = get_package_share_directory("arm")
    path = share + "/urdf/arm.urdf.xacro"
    Node(package="robot_state_publisher",
         parameters=[{{"robot_description": Command(["xacro ", path])}}])
    ExecuteProcess(cmd={command}, shell=True, output="screen")
"""


@pytest.mark.parametrize(
    "command",
    [
        '["ros2", "control", "load_controller", "--set-state", "active", "arm_controller"]',
        '["ros2 control load_controller -c /cm --set_state start ", "arm_controller"]',
        '[[FindExecutable(name="ros2"), " control load_controller --set-state=active", '
        '" arm_controller"]]',
        '["ros2", "control", "load_controller", "arm_controller", share + "/config/a.yaml", '
        '"--set-state", "active"]',
        '["ros2", "control", "load_start_controller", "arm_controller"]',
        '["ros2", "control", "set_controller_state", "arm_controller", "active"]',
        '["ros2", "control", "switch_controllers", "--deactivate", "other", "--activate", '
        '"arm_controller", "--strict"]',
        '["ros2", "run", "controller_manager", "spawner", "arm_controller", "-t", "t/T"]',
        '["bash", "-c", "sleep 5 && ros2 control set_controller_state arm_controller active"]',
        "[\"sh -c 'sleep 5; ros2 run controller_manager spawner arm_controller'\"]",
        '["ros2 service call /controller_manager/switch_controller '
        'controller_manager_msgs/srv/SwitchController \\"{activate_controllers: [arm_controller], '
        'strictness: 2}\\""]',
        '["rosservice call /controller_manager/switch_controller [arm_controller]", "[]", "2"]',
        '["rosrun", "controller_manager", "spawner", "arm_controller"]',
    ],
)
def test_a_command_of_ros2_starts_a_controller(package, command):
    folder = package(arm_dot_launch_dot_py=COMMAND.format(command=command))
    use = chosen(folder / "urdf/arm.urdf.xacro", launches_near(folder))
    assert use.spawned == ("arm_controller",)
    assert use.loaded == ()
    assert [each.name for each in use.controllers] == (["a.yaml"] if "a.yaml" in command else [])


@pytest.mark.parametrize(
    ("command", "loaded", "undecided"),
    [
        ('["ros2 control load_controller arm_controller"]', True, True),
        ('["ros2 control load_controller -c /active arm_controller"]', True, True),
        ('["ros2 control load_controller --set-state=inactive ", "arm_controller"]', True, False),
        ('["ros2 control load_controller arm_controller --set-state configured"]', True, False),
        ('["ros2 control load_configure_controller arm_controller"]', True, False),
        ('["ros2 run controller_manager spawner --inactive arm_controller"]', True, False),
        ('["ros2 run controller_manager spawner arm_controller --stopped"]', True, False),
        ('["ros2 run controller_manager spawner arm_controller --load-only"]', True, False),
        ('["ros2 control set_controller_state arm_controller inactive"]', False, False),
        ('["ros2 control switch_controllers --deactivate arm_controller"]', False, False),
        ('["ros2 control list_controllers -c arm_controller"]', False, False),
        (
            '["ros2 service call /controller_manager/load_controller '
            'controller_manager_msgs/srv/LoadController", "{name: arm_controller}"]',
            True,
            True,
        ),
        ('["ros2 service call /arm/switch_controller Type arm_controller"]', False, False),
        ('["ros2", "control"]', False, False),
    ],
)
def test_a_command_of_ros2_only_loads_a_controller(package, command, loaded, undecided):
    folder = package(arm_dot_launch_dot_py=COMMAND.format(command=command))
    use = chosen(folder / "urdf/arm.urdf.xacro", launches_near(folder))
    assert use.spawned == ()
    assert use.loaded == ("arm_controller",) * loaded
    assert use.undecided == {*["arm_controller"] * undecided}


@pytest.mark.parametrize(
    "command",
    [
        '["ros2", "control", "load_controller", clock(), "--set-state", "active"]',
        '["ros2", "run", "controller_manager", "spawner", clock()]',
    ],
)
def test_a_controller_with_an_unknown_name_may_be_any(package, command):
    folder = package(arm_dot_launch_dot_py=COMMAND.format(command=command))
    use = chosen(folder / "urdf/arm.urdf.xacro", launches_near(folder))
    assert (use.spawned, use.unsure) == ((), True)


def test_a_loaded_controller_may_be_started_later(package):
    text = COMMAND.format(command='["ros2 control load_controller arm_controller"]')
    text += (
        '    ExecuteProcess(cmd=["ros2 control switch_controllers --activate arm_controller"])\n'
    )
    folder = package(arm_dot_launch_dot_py=text)
    use = chosen(folder / "urdf/arm.urdf.xacro", launches_near(folder))
    assert (use.spawned, use.loaded) == (("arm_controller",), ())


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        ("""["'", name, "_x'"]""", "arm_x"),
        ("""["'yes' if '", name, "' == 'arm' else 'no'"]""", "yes"),
        ("""["not ", "False"]""", "True"),
        ("""["'", clock(), "'"]""", None),
        ("""["__import__('os').getcwd()"]""", None),
    ],
)
def test_python_expressions_are_evaluated_without_python(package, expression, expected):
    text = f"""def generate_launch_description():
    name = LaunchConfiguration("name", default="arm")
    path = PathJoinSubstitution([FindPackageShare("arm"), "urdf",
                                 PythonExpression(["'", name, ".urdf.xacro'"])])
    side = PythonExpression({expression})
    Node(package="robot_state_publisher", parameters=[
        {{"robot_description": Command(["xacro ", path, " side:=", side])}}])
"""
    folder = package(arm_dot_launch_dot_py=text)
    use = chosen(folder / "urdf/arm.urdf.xacro", launches_near(folder))
    assert use.arguments == ({} if expected is None else {"side": expected})


LOOPS = """
robots = [{"name": "one", "sim": "true"}]
robots.append({"name": "two", "sim": "false"})

def generate_launch_description():
    share = get_package_share_directory("arm")
    nodes = []
    for index, robot in enumerate(robots):
        text = Command(["xacro ", share + "/urdf/arm.urdf.xacro", " name:=", robot["name"],
                        " sim:=", robot["sim"], " port:=", str(7000 + 10 * index)])
        nodes += [Node(package="robot_state_publisher", parameters=[{"robot_description": text}])]
    nodes += [Node(package="controller_manager", executable="spawner", arguments=[name])
              for name in ("joints", "arm_controller")]
    for name, values in {"gripper": 1}.items():
        nodes.append(Node(package="controller_manager", executable="spawner", arguments=[name]))
    return LaunchDescription(nodes)
"""


SPAWNING = """
from launch_ros.actions import Node
def spawner(names, active=True, more=None):
    flags = {flags}
    return Node(package="controller_manager", executable="spawner", arguments=flags + names)
def generate_launch_description():
    robot = Command(["xacro ", FindPackageShare("arm"), "/urdf/arm.urdf.xacro"])
    return LaunchDescription([
        Node(package="robot_state_publisher", executable="robot_state_publisher",
             parameters=[{{"robot_description": robot}}]),
        spawner(["a"]), spawner(["b"], active=False), spawner(["c"], more="x"),
    ])
"""


@pytest.mark.parametrize(
    ("flags", "started"),
    [
        ('["--inactive"] if not active else []', ("a", "c")),
        ('["--inactive"] if active is False or not active else []', ("a", "c")),
        ('["--inactive"] if more is None and active else []', ("b", "c")),
        ('["--inactive"] if more is not None or not active else []', ("a",)),
        ('["--inactive"] if more in ["x", "y"] else []', ("a", "b")),
        ('[more or "d"]', ("d", "a", "b", "x", "c")),
        ('["--inactive"] if active == unknown() else []', ()),
    ],
)
def test_conditions_of_python_decide_which_controllers_are_started(package, flags, started):
    folder = package(arm_dot_launch_dot_py=SPAWNING.format(flags=flags))
    use = chosen(folder / "urdf/arm.urdf.xacro", launches_near(folder))
    assert use.spawned == started


@pytest.mark.parametrize(
    ("content", "names"),
    [
        ("robots: [{name: one}, {name: two}]", ["one", "two"]),
        ("robots: {name: one}", []),
        ("robots: [", []),
        ("- name: one", []),
        ("", []),
    ],
)
def test_robots_that_a_yaml_file_lists_are_known(package, content, names):
    text = LOOPS.replace(
        LOOPS[: LOOPS.index("def generate")],
        "with open(get_package_share_directory('arm') + '/config/robots.yaml') as file:\n"
        "    robots = yaml.safe_load(file)['robots']\n",
    )
    folder = package(sim_dot_launch_dot_py=text)
    (folder / "config/robots.yaml").write_text(content)
    uses = [use for use in launches_near(folder) if use.description is not None]
    assert [use.arguments["name"] for use in uses if "name" in use.arguments] == names


MAPPED = """
def described(file, sizes):
    with open(sizes, "r") as opened:
        values = yaml.safe_load(opened)["/**"]["ros__parameters"]
    return xacro.process_file(
        file, mappings={key: str(value) for key, value in values.items()}
    ).toxml()

def generate_launch_description():
    folder = get_package_share_directory("arm")
    text = described(os.path.join(folder, "urdf", "arm.urdf.xacro"),
                     os.path.join(folder, "config", "sizes.yaml"))
    return LaunchDescription([
        Node(package="robot_state_publisher", executable="robot_state_publisher",
             parameters=[{"robot_description": text}])])
"""


def test_arguments_of_xacro_that_a_yaml_file_lists_are_known(package):
    folder = package(sim_dot_launch_dot_py=MAPPED)
    (folder / "config/sizes.yaml").write_text(
        "/**:\n  ros__parameters:\n    length: 0.3\n    wheels: 4\n"
    )
    (use,) = (use for use in launches_near(folder) if use.description is not None)
    assert use.arguments == {"length": "0.3", "wheels": "4"}
    (folder / "config/sizes.yaml").unlink()
    (use,) = (use for use in launches_near(folder) if use.description is not None)
    assert use.arguments == {}


def test_loops_are_evaluated_for_each_of_their_values(package):
    folder = package(sim_dot_launch_dot_py=LOOPS)
    uses = [use for use in launches_near(folder) if use.description is not None]
    assert [use.arguments for use in uses] == [
        {"name": "one", "sim": "true", "port": "7000"},
        {"name": "two", "sim": "false", "port": "7010"},
    ]
    for use in uses:
        assert set(use.spawned) >= {"joints", "arm_controller", "gripper"}


@pytest.mark.parametrize(
    "loop",
    [
        "    name = 'a'\n    for _ in range(10**6):\n        name = name + name\n",
        "    name = ['a']\n    for _ in range(900):\n        name.append(name)\n",
        "    name = ['a']\n    for _ in range(900):\n        name = name + name\n",
        "    name = 3\n    for _ in range(900):\n        name = name * name\n",
        f"    name = 0x{'f' * 6000}\n",
        "    name = ''\n" + "".join(
            f"{'    ' * (2 * depth + 1)}for x in range(99):\n"
            f"{'    ' * (2 * depth + 2)}for y in range(99):\n" for depth in range(4)
        ) + f"{'    ' * 9}name = 'a'\n",
        "    for name in unknown():\n        pass\n",
    ],
)  # fmt: skip
def test_loops_of_strangers_end(package, loop):
    text = LOOPS.replace("    nodes = []\n", f"    nodes = []\n{loop}").replace(
        'robot["name"]', "name"
    )
    folder = package(sim_dot_launch_dot_py=text)
    assert any(use.description is not None for use in launches_near(folder))


def test_launch_files_are_known_by_their_folder(package):
    folder = package(sim_dot_py=STARTER, rsp_dot_launch_dot_py=INCLUDED)
    use = chosen(folder / "urdf/arm.urdf.xacro", launches_near(folder))
    assert use.file == folder / "launch/sim.py"


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        ("name + '_x'", "left_x"),
        ("2 * arg('count')", "6"),
        ("'yes' if name == 'left' and wide else 'no'", "yes"),
        ("find('arm')[-4:] + '_' + name", "/arm_left"),
        ("optenv('CARTWHEEL_NO_SUCH_NAME', 'none')", "none"),
        ("str(count).rjust(10**9)", None),
        ("unknown + 1", None),
        ("__import__('os').getcwd()", None),
    ],
)
def test_expressions_of_roslaunch_are_evaluated_within_limits(package, expression, expected):
    text = f"""<launch>
  <arg name="name" default="left"/><arg name="count" default="3"/><arg name="wide" value="true"/>
  <arg name="value" value="$(eval {expression})"/>
  <param name="robot_description"
    command="xacro $(find arm)/urdf/arm.urdf.xacro side:=$(arg value)"/>
</launch>"""
    folder = package(sim_dot_launch=text)
    use = chosen(folder / "urdf/arm.urdf.xacro", launches_near(folder))
    assert use.arguments == ({} if expected is None else {"side": expected})


def test_an_expression_decides_which_elements_are_read(package):
    text = """<launch>
  <arg name="kind" default="a"/>
  <group if="$(eval kind == 'b')">
    <param name="robot_description" command="xacro $(find arm)/urdf/arm.urdf.xacro side:=b"/>
  </group>
  <group unless="$(eval arg('kind') == 'b')">
    <param name="robot_description" command="xacro $(find arm)/urdf/arm.urdf.xacro side:=a"/>
  </group>
</launch>"""
    (use,) = launches_near(package(sim_dot_launch=text))
    assert use.arguments == {"side": "a"}


VARIANTS = """<launch>
  <arg name="size" default="small"/>
  <arg name="colour" default="arm"/>
  <param name="robot_description" command="xacro $(find arm)/urdf/arm_$(arg size).urdf.xacro
      size:=$(arg size) colour:=$(arg colour)"/>
  <include file="$(find arm)/launch/control.launch">
    <arg name="size" value="$(arg size)"/>
  </include>
</launch>"""
SIZED = """<launch>
  <arg name="size"/>
  <rosparam file="$(find arm)/config/$(arg size).yaml"/>
</launch>"""
VARIANTS_ROS2 = """import os
def generate_launch_description():
    size = LaunchConfiguration("size")
    share = FindPackageShare("arm")
    text = Command(["xacro ", share, "/urdf/arm_", size, ".urdf.xacro"])
    return LaunchDescription([DeclareLaunchArgument("size", default_value="small")])
"""
MODEL = """<launch>
  <arg name="model" default="$(env SOME_UNSET_MODEL)"/>
  <param name="robot_description" command="xacro $(find arm)/urdf/arm_$(arg model).urdf.xacro"/>
</launch>"""
SIZES = ["arm_large.old.urdf.xacro", "arm_large.urdf.xacro", "arm_small.urdf.xacro"]
ANY = MODEL.replace("arm_$(arg model).urdf.xacro", "$(arg model).xacro")


@pytest.fixture
def sizes(package):
    """A package with robots in three sizes, and launch files by name."""

    def write(**launch):
        folder = package(**launch)
        for size in ("small", "large", "large.old"):
            (folder / f"urdf/arm_{size}.urdf.xacro").write_text(ROBOT)
            (folder / f"config/{size}.yaml").write_text("c: {type: a/B}")
        (folder / "urdf/leg_large.urdf.xacro").write_text(ROBOT)
        return folder

    return write


def test_a_launch_file_starts_robots_of_other_sizes_with_other_arguments(sizes):
    folder = sizes(sim_dot_launch=VARIANTS, control_dot_launch=SIZED)
    uses = [each for each in launches_near(folder) if each.description is not None]
    found = {each.description.name: each for each in uses}
    assert sorted(found) == SIZES
    assert len(uses) == 3
    for size in ("small", "large", "large.old"):
        use = found[f"arm_{size}.urdf.xacro"]
        assert use.arguments == {"size": size, "colour": "arm"}
        assert [each.name for each in use.controllers] == [f"{size}.yaml"]


def test_a_python_launch_file_starts_robots_of_other_sizes(sizes):
    uses = launches_near(sizes(sim_dot_launch_dot_py=VARIANTS_ROS2))
    assert sorted(each.description.name for each in uses) == SIZES


def test_a_name_with_an_unknown_part_is_any_such_name(sizes, monkeypatch):
    monkeypatch.delenv("SOME_UNSET_MODEL", raising=False)
    uses = launches_near(sizes(sim_dot_launch=MODEL))
    assert sorted(each.description.name for each in uses) == SIZES
    assert {each.unknown for each in uses} == {1}


def test_a_name_of_which_nothing_is_known_is_no_name(sizes, monkeypatch):
    monkeypatch.delenv("SOME_UNSET_MODEL", raising=False)
    assert launches_near(sizes(sim_dot_launch=ANY)) == ()


def test_a_file_whose_whole_name_is_an_argument_is_guessed(sizes):
    named = VARIANTS.replace('default="small"', 'default="arm_small"').replace("arm_$", "$")
    uses = launches_near(sizes(sim_dot_launch=named, control_dot_launch=CONTROL))
    guessed = {each.description.name: each.guessed for each in uses if each.description}
    assert guessed.pop("arm_small.urdf.xacro") is False
    others = [*SIZES[:2], "arm.urdf.xacro", "leg_large.urdf.xacro"]
    assert guessed == dict.fromkeys(others, True)


def test_a_stranger_with_many_arguments_does_not_make_the_search_long(sizes, monkeypatch):
    many = "".join(f'<arg name="a{number}" default="arm"/>' for number in range(2000))
    folder = sizes(sim_dot_launch=VARIANTS.replace("<launch>", f"<launch>{many}"))
    searched = []

    def beside(file, word):
        searched.append(word)
        return {}

    monkeypatch.setattr(alternatives, "beside", beside)
    assert launches_near(folder)
    assert 0 < len(searched) <= 100


def test_the_launch_file_that_starts_controllers_is_chosen(package):
    """Another one, whose name comes first, loads a file of controllers and starts none of it."""
    spawner = '<node name="s" pkg="controller_manager" type="spawner" args=""/>'
    sleeper = ROS1.replace("control.launch", "none.launch")
    none = CONTROL.replace(CONTROL.splitlines()[2].strip(), spawner)
    folder = package(
        a_dot_launch=sleeper, none_dot_launch=none, b_dot_launch=ROS1, control_dot_launch=CONTROL
    )
    launches = launches_near(folder)
    assert any(each.file.name == "a.launch" and each.controllers for each in launches)
    use = chosen(folder / "urdf/arm.urdf.xacro", launches)
    assert use.file == folder / "launch/b.launch"
    assert use.spawned == ("arm_controller", "joints")


@pytest.mark.parametrize(
    "publisher", ["joint_state_controller", "joint_broad", "JointStateBroadcaster"]
)
def test_a_launch_file_that_only_starts_a_publisher_of_states_comes_last(package, publisher):
    """MoveIt's assistant writes such launch files, although those of the robot start more."""
    states = CONTROL.replace("arm_controller joints", publisher)
    folder = package(
        a_dot_launch=ROS1.replace("control.launch", "states.launch"),
        states_dot_launch=states,
        b_dot_launch=ROS1,
        control_dot_launch=CONTROL,
    )
    launches = launches_near(folder)
    (other,) = [each for each in launches if each.file.name == "a.launch"]
    assert other.spawned == (publisher,)
    use = chosen(folder / "urdf/arm.urdf.xacro", launches)
    assert use.file == folder / "launch/b.launch"
    alone = chosen(folder / "urdf/arm.urdf.xacro", [other])
    assert alone is other


@pytest.mark.parametrize(
    ("content", "namespace", "name"),
    [
        ("type: a/B\njoint: j", 'ns="left/grip_controller"', "grip_controller="),
        ("# One.\n\n  joint: j\n  type: a/B", 'ns="left/grip_controller"', "grip_controller="),
        ("---\n  arm:\n    type: a/B", 'ns="robot"', ""),
        ("type: a/B\njoint: j", "", ""),
        ("arm_controller: {type: a/B}", 'ns="robot"', ""),
        ("type: a/B", 'ns="$(arg unknown)"', ""),
    ],
)
def test_the_namespace_of_a_single_controller_is_its_name(package, content, namespace, name):
    loaded = CONTROL.replace("<rosparam ", f"<rosparam {namespace} ")
    folder = package(a_dot_launch=ROS1, control_dot_launch=loaded)
    (folder / "config/a.yaml").write_text(content)
    (use,) = [each for each in launches_near(folder) if each.file.name == "a.launch"]
    assert use.controllers == (Path(f"{name}{folder}/config/a.yaml"),)


UNUSED = """
def generate_launch_description():
    text = Command(["xacro ", os.path.join(get_package_share_directory("arm"),
                                           "urdf", "arm.urdf.xacro")])
    gazebo = IncludeLaunchDescription(PythonLaunchDescriptionSource(
        [FindPackageShare("ros_gz_sim"), "/launch/gz_sim.launch.py"]))
    spawn = Node(package="ros_gz_sim", executable="create", arguments=["-string", text])
    start = Node(package="controller_manager", executable="spawner", arguments=["a"])
    load = ExecuteProcess(cmd=["ros2", "run", "controller_manager", "spawner", "b"])
    %s
"""


@pytest.mark.parametrize(
    ("end", "spawned"),
    [
        ("return LaunchDescription([gazebo, spawn])", []),
        ("return LaunchDescription([gazebo, spawn, start])", ["a"]),
        ("delayed = TimerAction(period=2.0, actions=[start, load])\n"
         "    return LaunchDescription([gazebo, spawn])", []),
        ("delayed = TimerAction(period=2.0, actions=[start, load])\n"
         "    return LaunchDescription([gazebo, spawn, delayed])", ["a", "b"]),
        ("nodes = [start, load]\n    return LaunchDescription([gazebo, spawn])", []),
        ("nodes = [start, load]\n    return made(gazebo, spawn, nodes)", ["a", "b"]),
        ("after = OnProcessExit(target_action=start, on_exit=[load])\n"
         "    return LaunchDescription([gazebo, spawn, RegisterEventHandler(after)])", ["b"]),
        ("return LaunchDescription([locals()[name] for name in names])", ["a", "b"]),
        ("return Made.start(start, gazebo)", ["a"]),
    ],
)  # fmt: skip
def test_actions_in_python_that_nothing_reads_are_not_started(package, end, spawned):
    folder = package(gazebo_dot_launch_dot_py=UNUSED % end)
    (use,) = launches_near(folder)
    assert sorted(use.spawned) == spawned


def test_a_launch_file_without_a_needed_argument_comes_after_the_one_that_states_it(package):
    included = ROS1.replace("<launch>", '<launch><arg name="speed"/>')
    whole = '<launch><include file="$(find arm)/launch/a.launch"><arg name="speed" value="2"/>'
    folder = package(a_dot_launch=included, z_dot_launch=whole + "</include></launch>")
    use = chosen(folder / "urdf/arm.urdf.xacro", launches_near(folder))
    assert (use.file.name, use.lacking) == ("z.launch", False)
