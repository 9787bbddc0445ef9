"""Functions of launch and of other packages, and of other files, in launch files in Python."""

import time

import pytest

from cartwheel.description.launches import chosen, launches_near

LAUNCH = """
def generate_launch_description():
    share = get_package_share_directory("bot")
    return LaunchDescription([{actions}])
"""
PUBLISHER = (
    'Node(package="robot_state_publisher", executable="robot_state_publisher",'
    ' parameters=[{{"robot_description": {}}}])'
)
SPAWNED = 'Node(package="ros_gz_sim", executable="create", arguments=["-topic", "x"])'


def package(folder, text, name="main.launch.py"):
    """Writes a package with a xacro, controllers and a launch file; returns the xacro."""
    (folder / "launch").mkdir(parents=True, exist_ok=True)
    (folder / "package.xml").write_text("<package><name>bot</name></package>")
    (folder / "robot.xacro").write_text('<robot name="bot"/>')
    for file in ("a.yaml", "b.yaml"):
        (folder / file).write_text(f"{file[0]}: {{ros__parameters: {{type: x/X}}}}\n")
    (folder / "launch" / name).write_text(text)
    return folder / "robot.xacro"


def used(folder, *actions, **files):
    """What the launch file of a package with these actions starts."""
    robot = package(folder, LAUNCH.format(actions=", ".join(actions)))
    for name, text in files.items():
        (folder / "launch" / f"{name}.py").write_text(text)
    use = chosen(robot, launches_near(folder))
    assert use is not None
    return use


LOADED = PUBLISHER.format('load_xacro(Path(os.path.join(share, "robot.xacro")), {"size": "5"})')


@pytest.mark.parametrize(
    ("call", "names", "files"),
    [
        ('generate_load_controller_launch_description("a", share + "/a.yaml")', ["a"], ["a.yaml"]),
        (
            "generate_load_controller_launch_description(controller_name='a', "
            "controller_type='x/X', controller_params_file=os.path.join(share, 'a.yaml'))",
            ["a"],
            ["a.yaml"],
        ),
        (
            'generate_controllers_spawner_launch_description(["a", "b"], '
            'controller_params_files=[share + "/a.yaml", share + "/b.yaml"])',
            ["a", "b"],
            ["a.yaml", "b.yaml"],
        ),
        (
            "generate_controllers_spawner_launch_description_from_dict("
            '{"a": share + "/a.yaml", "b": [share + "/b.yaml"]})',
            ["a", "b"],
            ["a.yaml", "b.yaml"],
        ),
        (
            'generate_load_controller_launch_description("a", extra_spawner_args=["--inactive"])',
            [],
            [],
        ),
    ],
)
def test_controllers_that_functions_of_the_controller_manager_start(tmp_path, call, names, files):
    use = used(tmp_path, LOADED, call)
    assert list(use.spawned) == names
    assert [each.name for each in use.controllers] == files
    assert list(use.loaded) == ([] if names else ["a"])


def test_a_description_that_load_xacro_expands_has_its_arguments(tmp_path):
    assert used(tmp_path, LOADED).arguments == {"size": "5"}


def test_a_launch_file_that_a_function_includes_receives_arguments(tmp_path):
    include = (
        'include_launch_py_description("bot", ["launch", "inner.launch.py"], '
        'launch_arguments={"sim": "True"}.items())'
    )
    inner = LAUNCH.format(
        actions='DeclareLaunchArgument("sim", default_value="False"), OpaqueFunction(function=run)'
    )
    inner += (
        "\ndef run(context):\n    share = get_package_share_directory('bot')\n    return ["
        + LOADED.replace('"5"', 'read_launch_argument("sim", context)')
        + "]\n"
    )
    use = used(tmp_path, include, SPAWNED, **{"inner.launch": inner})
    assert use.file.name == "main.launch.py"
    assert use.arguments == {"size": "True"}


def test_a_file_beside_the_launch_file_is_included(tmp_path):
    include = 'IncludeLaunchDescription([ThisLaunchFileDir(), "/inner.launch.py"])'
    inner = LAUNCH.format(actions=LOADED)
    use = used(tmp_path, include, SPAWNED, **{"inner.launch": inner})
    assert use.file.name == "main.launch.py"


LIBRARY = """
def described(file, arguments={}):
    command = ["xacro ", file]
    for key, value in arguments.items():
        command.extend([" {}:=".format(key), value])
    return Command(command)
"""
BESIDE = 'load_python_launch_file_as_module(share + "/launch/library.py")'


@pytest.mark.parametrize(
    "function", ['getattr(module, "described")', "module.described"], ids=["getattr", "attribute"]
)
def test_functions_of_an_imported_file_are_evaluated(tmp_path, function):
    made = f"""module = {BESIDE}
    get = {function}
    found = {"get" if "getattr" in function else function}(share + "/robot.xacro", {{"size": "5"}})
    return Launch"""
    text = LAUNCH.format(actions=PUBLISHER.format("found")).replace("return Launch", made)
    robot = package(tmp_path, text)
    (tmp_path / "launch" / "library.py").write_text(LIBRARY)
    use = chosen(robot, launches_near(tmp_path))
    assert use is not None
    assert use.arguments == {"size": "5"}


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        ('"{}{}".format("a", 5)', "a5"),
        ('"{1}-{0}".format("a", "b")', "b-a"),
        ('"{name}".format(name="c")', "c"),
        ('"{{}}{}".format("a")', "{}a"),
        ('"{:5}".format("a")', None),
        ('"{}".format(unknown)', None),
        ('"{".format("a")', None),
        ("LaunchContext().perform_substitution(TextSubstitution(text='a'))", "a"),
    ],
)
def test_texts_that_a_launch_file_formats(tmp_path, value, expected):
    use = used(tmp_path, LOADED.replace('"5"', value))
    assert use.arguments.get("size") == expected


def test_a_guessed_description_keeps_its_own_defaults(tmp_path):
    """The launch file may start any description; the values are those of its default one."""
    text = """<launch>
      <arg name="model" default="large"/><arg name="dof" default="7"/>
      <arg name="sim" default="true"/><arg name="mass" default="3"/>
      <param name="robot_description" command="xacro $(find bot)/$(arg model).xacro
        joints:=$(arg dof) sim:=$(arg sim) mass:=$(arg mass) name:=arm"/></launch>"""
    package(tmp_path, text, name="main.launch")
    for name in ("large", "small"):
        (tmp_path / f"{name}.xacro").write_text(
            '<robot name="x" xmlns:xacro="http://wiki.ros.org/xacro"><xacro:arg name="joints"'
            ' default="6"/><xacro:arg name="sim" default="false"/><xacro:arg name="name"'
            ' default="y"/></robot>'
        )
    launches = launches_near(tmp_path)
    given = {"sim": "true", "mass": "3", "name": "arm"}
    for name, expected in (("large", {"joints": "7", **given}), ("small", given)):
        use = chosen(tmp_path / f"{name}.xacro", launches)
        assert use is not None
        assert use.arguments == expected


def test_methods_with_the_name_of_a_function_are_not_evaluated(tmp_path):
    """Otherwise, those that call each other would take exponential time."""
    text = LAUNCH.format(actions=LOADED) + "".join(
        f"\ndef step(x):\n    {'self.step(x); ' * 30}\n    return step(x)" for _ in range(3)
    )
    before = time.thread_time()
    use = chosen(package(tmp_path, text), launches_near(tmp_path))
    assert use is not None
    assert time.thread_time() - before < 1.0


@pytest.mark.parametrize("call", ["yaml.dump({}, file)", "yaml.safe_dump({}, file)", "print(1)"])
def test_a_launch_file_that_writes_yaml_may_write_controllers(tmp_path, call):
    text = LAUNCH.format(actions=LOADED) + (
        f"\nwith NamedTemporaryFile(mode='w', delete=False) as file:\n    {call}\n"
    )
    use = chosen(package(tmp_path, text), launches_near(tmp_path))
    assert use is not None
    assert use.incomplete == ("dump" in call)


@pytest.mark.parametrize(
    ("words", "stated"),
    [('"a", "-t", "x/X"', True), ('"a", "--controller-type", "x/X"', True), ('"a"', False)],
)
def test_types_that_a_launch_file_states_may_not_be_in_its_files(tmp_path, words, stated):
    spawner = f'Node(package="controller_manager", executable="spawner", arguments=[{words}])'
    use = used(tmp_path, LOADED, spawner)
    assert use.typed == ({"a"} if stated else set())
    assert use.spawned == ("a",)
