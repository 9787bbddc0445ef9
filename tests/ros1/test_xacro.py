"""The overlay's xacro against the package it stands on, run by itself."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
CORPUS = Path(os.environ.get("CARTWHEEL_CORPUS", ROOT.parent / "shared" / "corpus"))
CART = "robots/rosbots_description/urdf/rosbots.xacro"
OTHERS = [
    ("turtlebot3/turtlebot3_description/urdf/turtlebot3_waffle.urdf.xacro", ()),
    ("mir_robot/mir_description/urdf/mir.urdf.xacro", ("tf_prefix:=a",)),
    ("gazebo_ros_demos/rrbot_description/urdf/rrbot.xacro", ()),
    ("urdf_sim_tutorial/urdf/12-gripper.urdf.xacro", ()),
]

REFERENCE = """
import glob, os, sys, xacro
from xacro import substitution_args
def find(name):
    for root in os.environ["ROS_PACKAGE_PATH"].split(":"):
        for depth in ("", "*/", "*/*/"):
            for found in glob.glob(f"{root}/{depth}{name}/package.xml"):
                return os.path.dirname(found)
    raise KeyError(name)
substitution_args._eval_find = find
substitution_args._eval_dict["find"] = find
xacro.main()
"""


def reference(file: Path, *arguments: str, packages: str) -> str:
    done = subprocess.run(
        [sys.executable, "-c", REFERENCE, str(file), *arguments],
        env={**os.environ, "ROS_PACKAGE_PATH": packages},
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout


@pytest.mark.parametrize(("name", "arguments"), OTHERS)
def test_robots_of_others_come_out_as_with_the_reference(ros, name, arguments):
    file = CORPUS / name
    if not file.is_file():
        pytest.skip(f"no corpus of others' robots in {CORPUS}")
    packages = f"{ROOT / 'ros1' / 'src'}:{CORPUS}"
    done = ros.run("xacro", file, *arguments, environment={"ROS_PACKAGE_PATH": packages})
    assert done.stdout == reference(file, *arguments, packages=packages)


@pytest.mark.parametrize("program", ["xacro", "xacro.py"])
@pytest.mark.parametrize("arguments", [(), ("--inorder",), ("-q",), ("--verbosity=0",)])
def test_the_cart(ros, program, arguments):
    packages = ros.environment["ROS_PACKAGE_PATH"]
    done = ros.run("rosrun", "xacro", program, *arguments, ROOT / CART)
    assert done.stdout == reference(ROOT / CART, packages=packages)


def test_options(ros):
    file = ros.folder / "a.xacro"
    file.write_text(
        '<robot name="a" xmlns:xacro="http://www.ros.org/wiki/xacro">'
        '<xacro:arg name="l" default="one"/><xacro:include filename="$(cwd)/b.xacro"/>'
        '<link name="$(arg l)"/><link name="$(optenv NOT_SET none)"/>'
        "</robot>"
    )
    (ros.folder / "b.xacro").write_text('<robot><link name="of_b"/></robot>')
    done = ros.run("xacro", file, "l:=two", "-o", "out/r.urdf")
    assert done.stdout == ""
    text = (ros.folder / "out" / "r.urdf").read_text()
    assert [name in text for name in ('"one"', '"two"', '"of_b"', '"none"')] == [
        False, True, True, True,
    ]  # fmt: skip
    assert ros.run("xacro", "--deps", file).stdout == str(ros.folder / "b.xacro")


def test_a_package_that_is_missing_is_named(ros):
    file = ros.folder / "a.xacro"
    file.write_text(
        '<robot name="a" xmlns:xacro="http://www.ros.org/wiki/xacro">'
        '<xacro:include filename="$(find no_such_package)/b.xacro"/></robot>'
    )
    done = ros.run("xacro", file, status=2)
    assert '"no_such_package"' in done.stderr
    assert "ROS_PACKAGE_PATH" in done.stderr


MODULE = f"""
import xacro
document = xacro.process_file({str(ROOT / CART)!r}, mappings={{}})
print(document.documentElement.getAttribute("name"), xacro.__name__)
from xacro.xmlutils import first_child_element
import xacro as again
assert again is xacro
"""


def test_the_module_as_others_import_it(ros):
    process = ros.python(MODULE)
    output, errors = process.communicate(timeout=60)
    assert output.split() == ["rosbots", "xacro"], errors
