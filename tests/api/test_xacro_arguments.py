"""Arguments of xacro files that a program gives as numbers and booleans."""

import numpy as np
import pytest
from tests.coded import coded, raises

import cartwheel as cw
from cartwheel.codes.command import OPTION_INVALID
from cartwheel.codes.files import ARGUMENT_UNKNOWN
from cartwheel.errors import DescriptionError

XACRO = """<robot name="bot" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="top" default="false"/><xacro:arg name="size" default="1"/>
  <xacro:property name="shown" value="${'$(arg top)'.replace('x', 'y')}"/>
  <link name="base"><inertial><mass value="1"/>
    <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
    <collision><geometry><box size="$(arg size) 1 1"/></geometry></collision></link>
  <xacro:if value="$(arg top)"><link name="top"/>
    <joint name="fixed" type="fixed"><parent link="base"/><child link="top"/></joint></xacro:if>
</robot>"""


@pytest.mark.parametrize("make", ["spawn", "build"])
@pytest.mark.parametrize(
    ("value", "there"),
    [(True, True), (False, False), (1, True), (0, False), (np.bool_(True), True), ("true", True),
     (np.int64(1), True)],
)  # fmt: skip
def test_numbers_and_booleans_are_written_as_xacro_does(value, there, make):
    robot = {"robot": XACRO, "arguments": {"top": value, "size": 0.5}}
    world = cw.build("empty", robot).world() if make == "build" else cw.World()
    if make == "spawn":
        world.spawn(**robot)
    assert ("top" in world.model("bot").links) is there


def test_a_misspelt_argument_is_an_error():
    robot = {"robot": XACRO, "arguments": {"tob": True}}
    with raises(ARGUMENT_UNKNOWN, DescriptionError, name="tob", meant="top"):
        cw.World().spawn(**robot)
    with raises(ARGUMENT_UNKNOWN, DescriptionError, name="tob"):
        cw.build("empty", robot)
    # Unless it is ignored, or a file that is missing might declare it.
    cw.World(ignore="CW123").spawn(**robot)
    cw.build("empty", robot, ignore="CW123")
    include = '<xacro:include filename="$(find not_there)/more.xacro"/>'
    robot["robot"] = XACRO.replace("<xacro:arg", f"{include}<xacro:arg", 1)
    with cw.World() as world:
        world.spawn(**robot)
        assert coded(world, ARGUMENT_UNKNOWN, name="tob")


@pytest.mark.parametrize(
    "values", [{"top": None}, {"top": [1]}, {"top": object()}, {1: "a"}, ["a"]]
)
def test_other_kinds_are_refused_at_the_call(values):
    with raises(OPTION_INVALID):
        cw.World().spawn(XACRO, arguments=values)
    with raises(OPTION_INVALID):
        cw.build("empty", {"robot": XACRO, "arguments": values})
