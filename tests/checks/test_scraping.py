"""Bodies whose flat underside slides on the ground beside the driven wheels."""

import pytest

import cartwheel
from cartwheel.codes.robot import BODY_ON_GROUND, WHEELS_OFF_GROUND

INERTIAL = (
    '<inertial><mass value="1"/>'
    '<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>'
)
WHEELS = ("front_left", "front_right", "back_left", "back_right")
MECANUM = (
    '<gazebo><plugin name="drive" filename="gz-sim-mecanum-drive-system">'
    + "".join(f"<{name}_joint>{name}_joint</{name}_joint>" for name in WHEELS)
    + "</plugin></gazebo>"
)
CONTROL = (
    '<ros2_control name="s" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem'
    "</plugin></hardware>"
    + "".join(
        f'<joint name="{name}_joint"><command_interface name="velocity"/></joint>'
        for name in WHEELS
    )
    + "</ros2_control>"
)


def robot(height, drive):
    """A box on four wheels of a radius of 0.05 m, whose underside is at a height."""
    wheels = "".join(
        f'<link name="{name}">{INERTIAL}<collision><origin rpy="1.5708 0 0"/><geometry>'
        f'<cylinder radius="0.05" length="0.04"/></geometry></collision></link>'
        f'<joint name="{name}_joint" type="continuous"><parent link="base"/><child link="{name}"/>'
        f'<origin xyz="{0.15 if "front" in name else -0.15} '
        f'{0.18 if "left" in name else -0.18} 0"/>'
        '<axis xyz="0 1 0"/></joint>'
        for name in WHEELS
    )
    return (
        f'<robot name="r"><link name="base">{INERTIAL}<collision><origin xyz="0 0 {height}"/>'
        f'<geometry><box size="0.4 0.3 0.1"/></geometry></collision></link>{wheels}{drive}</robot>'
    )


@pytest.mark.parametrize("drive", [MECANUM, CONTROL], ids=["plugin", "controllers"])
@pytest.mark.parametrize(("height", "scrapes"), [(0.0, True), (0.01, False)])
def test_a_body_between_wheels_without_sides_scrapes(tmp_path, drive, height, scrapes):
    path = tmp_path / "robot.urdf"
    path.write_text(robot(height, drive))
    found = [each for each in cartwheel.check(path).findings if each.code is BODY_ON_GROUND]
    assert [each.values["link"] for each in found] == (["base"] if scrapes else [])


SIDES = """<gazebo><plugin name="d" filename="libgazebo_ros_diff_drive.so">
  <left_joint>front_left_joint</left_joint><right_joint>front_right_joint</right_joint>
  <wheel_separation>0.36</wheel_separation><wheel_diameter>0.1</wheel_diameter></plugin></gazebo>"""
CASTER = f"""<link name="caster">{INERTIAL}<collision><geometry><sphere radius="0.02"/></geometry>
  </collision></link><joint name="c" type="fixed"><parent link="base"/><child link="caster"/>
  <origin xyz="-0.15 0 {{height}}"/></joint>"""


@pytest.mark.parametrize(("height", "code"), [(-0.03, BODY_ON_GROUND), (-0.055, WHEELS_OFF_GROUND)])
def test_a_body_beside_wheels_that_a_caster_raises_does_not_brake_them(tmp_path, height, code):
    text = robot(0.0, CASTER.format(height=height) + SIDES)
    path = tmp_path / "robot.urdf"
    path.write_text(text)
    codes = {BODY_ON_GROUND, WHEELS_OFF_GROUND}
    found = {each.code for each in cartwheel.check(path).findings if each.code in codes}
    assert found == {code}
