"""Drives of robots that are fixed to the world."""

import pytest
from tests.checks.test_steering_and_casters import BODY, REAR
from tests.checks.test_wheel_speed import CLASSIC

from cartwheel.api import World
from cartwheel.checks.checking import check
from cartwheel.codes.robot import BASE_FIXED
from cartwheel.codes.running import MODEL_NOT_MOVABLE

WORLD = '<link name="world"/>'
HOLD = '<joint name="hold" type="{}"><parent link="{}"/><child link="{}"/></joint>'
FOOT = '<link name="foot"/>'


@pytest.mark.parametrize(
    ("held", "reported"),
    [
        ("", False),
        (WORLD + HOLD.format("fixed", "world", "base"), True),
        (
            WORLD
            + FOOT
            + HOLD.format("fixed", "world", "foot")
            + HOLD.replace("hold", "on").format("fixed", "foot", "base"),
            True,
        ),
        (WORLD + HOLD.format("prismatic", "world", "base"), False),
        (FOOT + HOLD.format("fixed", "foot", "base"), False),
    ],
)
def test_a_drive_of_a_robot_that_the_world_holds_is_reported(tmp_path, held, reported):
    path = tmp_path / "cart.urdf"
    path.write_text(f'<robot name="cart">{BODY.format(more="")}{REAR}{held}{CLASSIC}</robot>')
    found = [each for each in check(path).findings if each.code is BASE_FIXED]
    assert len(found) == reported
    for each in found:
        assert each.values == {"plugin": "libgazebo_ros_diff_drive.so", "joint": "hold"}
        assert each.severity == "warning"


SDF = """<sdf version="1.9"><model name="cart"><static>{static}</static>{held}
  <link name="base"><pose>0 0 0.2 0 0 0</pose></link>
  {wheels}{plugin}</model></sdf>"""
WHEEL = """<link name="{0}"><pose>0 {1} 0.1 0 0 0</pose><collision name="c"><geometry><sphere>
  <radius>0.1</radius></sphere></geometry></collision></link>
  <joint name="{0}_joint" type="revolute">
  <parent>base</parent><child>{0}</child><axis><xyz>0 1 0</xyz></axis></joint>"""


def model(static="false", held=""):
    return SDF.format(
        static=static,
        held=held,
        wheels=WHEEL.format("left", 0.2) + WHEEL.format("right", -0.2),
        plugin=CLASSIC.removeprefix("<gazebo>").removesuffix("</gazebo>"),
    )


@pytest.mark.wording
@pytest.mark.parametrize("name", ["cart.urdf", "cart.sdf"])
def test_only_a_urdf_has_a_link_for_the_world(tmp_path, name):
    path = tmp_path / name
    held = '<joint name="hold" type="fixed"><parent>world</parent><child>base</child></joint>'
    text = model(held=held)
    if name.endswith(".urdf"):
        held = WORLD + HOLD.format("fixed", "world", "base")
        text = f'<robot name="cart">{BODY.format(more="")}{REAR}{held}{CLASSIC}</robot>'
    path.write_text(text)
    (found,) = [each for each in check(path).findings if each.code is BASE_FIXED]
    assert ('the link "world"' in found.hint) == name.endswith(".urdf")


@pytest.mark.parametrize("static", [True, False])
def test_a_drive_of_a_static_model_is_reported(tmp_path, static):
    path = tmp_path / "model.sdf"
    path.write_text(model(static=str(static)))
    found = [each for each in check(path).findings if each.code is BASE_FIXED]
    assert [each.values for each in found] == [{"plugin": "libgazebo_ros_diff_drive.so"}] * static


BOX = (
    '<link name="base"><inertial><mass value="{}"/><inertia ixx="1" iyy="1" izz="1"/></inertial>'
    '<collision><geometry><box size="1 1 1"/></geometry></collision></link>'
)
MOVER = '<gazebo><plugin name="p" filename="{}"/></gazebo>'
PLANAR = MOVER.format("libgazebo_ros_planar_move.so")


@pytest.mark.parametrize(
    ("parts", "joint"),
    [
        (BOX.format(1) + PLANAR, None),
        (BOX.format(1) + WORLD + HOLD.format("fixed", "world", "base") + PLANAR, "hold"),
        (BOX.format(1) + "<gazebo><static>true</static></gazebo>" + PLANAR, ""),
        (
            BOX.format(1)
            + WORLD
            + HOLD.format("fixed", "world", "base")
            + MOVER.format("gz-sim-velocity-control-system"),
            "hold",
        ),
        # It moves only joints.
        (
            BOX.format(1)
            + WORLD
            + HOLD.format("fixed", "world", "base")
            + MOVER.format("libgazebo_ros_joint_state_publisher.so"),
            None,
        ),
    ],
)
def test_a_plugin_that_moves_a_held_model_is_reported(tmp_path, parts, joint):
    path = tmp_path / "box.urdf"
    path.write_text(f'<robot name="box">{parts}</robot>')
    found = [each for each in check(path).findings if each.code is MODEL_NOT_MOVABLE]
    assert len(found) == (joint is not None)
    with World("empty", lenient=True) as world:
        world.spawn(path)
        run = [each for each in world.diagnostics if MODEL_NOT_MOVABLE.number in str(each.values)]
        assert bool(run) == bool(found)
    for each in found:
        assert each.values.get("joint", "") == joint
