"""Launch files in Python that import modules of their package, and configurations of MoveIt."""

import pytest

from cartwheel.description.launches import launches_near

LAUNCH = """
from {module} import {names}
from launch import LaunchDescription

def start(context, *args, **kwargs):
    sim = context.perform_substitution(LaunchConfiguration("sim")).lower()
    names = ["driver_controller"] if sim != "true" else ["arm_controller"]
    return [Node(package="controller_manager", executable="spawner", arguments=names)]

def generate_launch_description():
    description = LaunchDescription()
    declare(description)
    description.add_action(publisher("arm.urdf.xacro"))
    description.add_action(OpaqueFunction(function=start))
    return description
"""
COMMON = """
import os
PACKAGE = "arm"

def declare(description):
    description.add_action(DeclareLaunchArgument("sim", default_value="True"))

def publisher(name):
    file = os.path.join(get_package_share_directory(PACKAGE), name)
    sim = LaunchConfiguration("sim")
    return Node(package="robot_state_publisher", executable="robot_state_publisher",
                parameters=[{"robot_description": Command(["xacro ", file, " sim:=", sim])}])

def other():
    return Node(package="controller_manager", executable="spawner", arguments=["other"])
"""


@pytest.fixture
def arm(tmp_path):
    folder = tmp_path / "arm"
    (folder / "launch" / "modules").mkdir(parents=True)
    (folder / "arm").mkdir()
    (folder / "package.xml").write_text("<package><name>arm</name></package>")
    (folder / "arm.urdf.xacro").write_text('<robot name="arm"><link name="base"/></robot>')
    return folder


def read(folder, text):
    (folder / "launch/sim.launch.py").write_text(text)
    return [each for each in launches_near(folder) if each.file.name == "sim.launch.py"]


@pytest.mark.parametrize(
    ("module", "file", "found"),
    [
        ("common", "launch/common.py", True),
        ("modules.common", "launch/modules/common.py", True),
        ("modules", "launch/modules/__init__.py", True),
        (".common", "launch/common.py", True),
        ("..common", "common.py", True),
        ("arm.common", "arm/common.py", True),
        # These are in another package, or are none.
        ("...common", "../common.py", False),
        ("common", "common.py", False),
    ],
)
@pytest.mark.parametrize("names", ["*", "declare, publisher"])
def test_functions_and_constants_of_modules_of_the_package_are_read(
    arm, module, file, found, names
):
    (arm / file).write_text(COMMON)
    (use,) = read(arm, LAUNCH.format(module=module, names=names))
    assert (use.description is not None) is found
    assert not found or use.arguments == {"sim": "True"}
    # Nothing calls the function that starts another controller.
    assert use.spawned == (("arm_controller",) if found else ("driver_controller",))


def test_modules_may_import_modules_of_their_folder_and_each_other(arm):
    (arm / "launch/modules/__init__.py").write_text("from common import *\nfrom modules import x")
    (arm / "launch/modules/common.py").write_text("from modules import *\n" + COMMON)
    (use,) = read(arm, LAUNCH.format(module="modules", names="*"))
    assert use.spawned == ("arm_controller",)


def test_what_a_module_costs_is_limited(arm):
    for index in range(60):
        (arm / f"launch/m{index}.py").write_text(f"from m{index + 1} import *\n")
    (arm / "launch/m60.py").write_text(COMMON)
    (use,) = read(arm, LAUNCH.format(module="m0", names="*"))
    assert use.description is None


MOVEIT = """
def generate_launch_description():
    config = ({builder}.robot_description_semantic("config/arm.srdf").to_moveit_configs())
    return LaunchDescription([
        Node(package="robot_state_publisher", executable="robot_state_publisher",
             parameters=[config.robot_description]),
        Node(package="ros_gz_sim", executable="create", arguments=["-topic", "robot_description"]),
    ])
"""
BUILDER = 'MoveItConfigsBuilder("arm", package_name="arm")'
FILE = '.robot_description(file_path="arm.urdf.xacro", mappings={"sim": "true"})'


@pytest.mark.parametrize(
    ("builder", "file", "arguments"),
    [
        (BUILDER + FILE, "arm.urdf.xacro", {"sim": "true"}),
        (BUILDER, "config/arm.urdf.xacro", {}),
        (BUILDER + '.robot_description("arm.urdf.xacro")', "arm.urdf.xacro", {}),
    ],
)
def test_configurations_of_moveit_contain_the_description(arm, builder, file, arguments):
    (arm / "config").mkdir()
    (arm / "config/arm.urdf.xacro").write_text((arm / "arm.urdf.xacro").read_text())
    (use,) = read(arm, MOVEIT.format(builder=builder))
    assert use.simulated
    assert (use.description, use.arguments) == (arm / file, arguments)
