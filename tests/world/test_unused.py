"""Descriptions that the physics ignores are reported with their place, once for each kind."""

import pytest
from tests.coded import coded

import cartwheel as cw
from cartwheel.codes import world as world_codes
from cartwheel.description import load_text
from cartwheel.errors import Diagnostic

URDF = """<robot name="r">
  <link name="base">
    <inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><box size="1 1 1"/></geometry></collision>
    <collision><geometry><sphere radius="1"/></geometry></collision>
  </link>
  <link name="arm">
    <inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <joint name="j" type="revolute">
    <parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="5" velocity="2"/>
  </joint>
  <gazebo reference="base">{tags}</gazebo>
</robot>"""


def notes(tags: str) -> list[Diagnostic]:
    with cw.World("empty") as world:
        world.spawn(load_text(URDF.format(tags=tags), file="r.urdf"))
        return coded(world, world_codes.PHYSICS_SETTING_IGNORED)


@pytest.mark.parametrize(
    ("tags", "setting", "line", "count"),
    [
        ("<minDepth>0.001</minDepth>", "min_depth", 4, 2),
        ("<maxVel>1</maxVel>", "max_vel", 4, 2),
        (
            "<collision><surface><friction><ode><slip1>0.1</slip1><slip2>0</slip2></ode></friction>"
            "</surface></collision>",
            "slip1",
            4,
            2,
        ),
        ("<dampingFactor>0.1</dampingFactor>", "velocity decay", 2, 1),
    ],
)
def test_a_tag_that_does_nothing_is_reported_at_its_first_place(tags, setting, line, count) -> None:
    (note,) = [each for each in notes(tags) if each.values["setting"] == setting]
    assert note.severity == "info"
    assert note.origin.line == line
    assert note.values["count"] == count


def test_a_velocity_limit_is_reported_and_nothing_else_is() -> None:
    surface = (
        "<collision><surface><friction><ode><slip1>0</slip1></ode><torsional><coefficient>1"
        "</coefficient><patch_radius>0.1</patch_radius></torsional></friction><bounce>"
        "<restitution_coefficient>0</restitution_coefficient></bounce><contact>"
        "<collide_bitmask>1</collide_bitmask></contact></surface></collision>"
    )
    (only,) = notes(f"<mu1>1</mu1><mu2>2</mu2><fdir1>1 0 0</fdir1><kp>1e6</kp>{surface}")
    assert only.values["setting"] == "a joint's velocity limit"
    assert only.origin.line == 10


def test_a_velocity_limit_that_controllers_heed_is_none_without_effect() -> None:
    plugin = '<gazebo><plugin name="c" filename="libgazebo_ros_control.so"/></gazebo>'
    transmission = """<transmission name="t"><type>transmission_interface/SimpleTransmission</type>
      <joint name="j"><hardwareInterface>PositionJointInterface</hardwareInterface></joint>
      </transmission>"""
    for more, received in (("", 1), (transmission, 1), (plugin, 1), (plugin + transmission, 0)):
        text = URDF.format(tags="").replace("</robot>", f"{more}</robot>")
        with cw.World("empty") as world:
            world.spawn(load_text(text, file="r.urdf"))
            setting = "a joint's velocity limit"
            found = coded(world, world_codes.PHYSICS_SETTING_IGNORED, setting=setting)
        assert len(found) == received, more


AXIS = "a joint axis"
RESISTANCE = "a joint's limits, damping, friction or spring"
LOOP = """<sdf version="1.7"><model name="loop"><link name="a"/><link name="b"/><link name="c"/>
  <joint name="ab" type="revolute"><parent>a</parent><child>b</child><axis/></joint>
  <joint name="ac" type="revolute"><parent>a</parent><child>c</child><axis/></joint>
  <joint name="bc" type="{}"><parent>b</parent><child>c</child>
    <axis>{}</axis></joint></model></sdf>"""


@pytest.mark.parametrize(
    ("kind", "axis", "setting"),
    [
        ("revolute", "", None),
        ("fixed", "", None),
        ("revolute", "<dynamics><damping>1</damping></dynamics>", RESISTANCE),
        ("prismatic", "", AXIS),
    ],
)
def test_what_a_joint_that_closes_a_loop_does_not_do_is_reported(kind, axis, setting) -> None:
    with cw.World("empty") as world:
        world.spawn(load_text(LOOP.format(kind, axis), file="l.sdf"))
        received = [
            each
            for each in coded(world, world_codes.PHYSICS_SETTING_IGNORED)
            if each.origin.line == 4 and each.values["setting"] in (RESISTANCE, AXIS)
        ]
    assert [each.values["setting"] for each in received] == ([] if setting is None else [setting])


@pytest.mark.parametrize(("coefficient", "received"), [(0.5, 0), (1.0, 0), (1.5, 2)])
def test_a_restitution_above_1_is_reported(coefficient, received) -> None:
    bounce = f"""<collision><surface><bounce><threshold>0.1</threshold><restitution_coefficient>
      {coefficient}</restitution_coefficient></bounce></surface></collision>"""
    said = [each for each in notes(bounce) if each.values["setting"] == "a restitution above 1"]
    assert [each.values["count"] for each in said] == ([2] if received else [])
