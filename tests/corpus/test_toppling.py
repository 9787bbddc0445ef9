"""Robots that come down, or fall over, when their joints move."""

import re

import pytest

from cartwheel.codes.robot import UNBALANCED
from cartwheel.corpus import try_robot

LINK = (
    '<link name="{name}"><inertial><origin xyz="0 0 {z}"/><mass value="{mass}"/>'
    '<inertia ixx="0.1" iyy="0.1" izz="0.1" '
    'ixy="0" ixz="0" iyz="0"/></inertial><collision><origin xyz="0 0 {z}"/>'
    '<geometry><box size="{size}"/></geometry></collision></link>'
)
MOVED = (
    '<joint name="{name}_joint" type="revolute"><parent link="base"/><child link="{name}"/>'
    '<origin xyz="{at}"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="500" velocity="2"/>'
    '<dynamics damping="1"/></joint>'
)
MOTOR = (
    '<gazebo><plugin name="m" filename="gz-sim-joint-position-controller-system">'
    "<joint_name>{name}_joint</joint_name><p_gain>2000</p_gain><d_gain>100</d_gain></plugin></gazebo>"
)
ARM = LINK.format(name="arm", z=0.6, mass=5, size="0.05 0.05 0.2")
WORLD = (
    '<link name="world"/><joint name="mount" type="fixed"><parent link="world"/>'
    '<child link="base"/></joint>'
)


def tried(tmp_path, *parts):
    path = tmp_path / "robot.urdf"
    path.write_text(f'<robot name="robot">{"".join(parts)}</robot>')
    return try_robot(path, standing=2.0)


@pytest.mark.parametrize(("wide", "more", "falls"), [(0.1, "", 1), (0.1, WORLD, 0), (0.6, "", 0)])
def test_an_arm_that_nothing_fixes_to_the_world_may_tip_over(tmp_path, wide, more, falls):
    base = LINK.format(name="base", z=0.05, mass=2, size=f"{wide} 0.3 0.1")
    joint = MOVED.format(name="arm", at="0 0 0.1")
    verdict = tried(tmp_path, base, ARM, joint, MOTOR.format(name="arm"), more)
    assert verdict.reaches
    assert {(each.test, each.code, each.source) for each in verdict.faults} == (
        {("stand", UNBALANCED, "file")} if falls else set()
    )


@pytest.mark.parametrize("named", ["collision", "visual"])
def test_a_robot_may_stand_on_a_missing_mesh(tmp_path, named):
    mesh = f'<{named}><geometry><mesh filename="package://nowhere/foot.stl"/></geometry></{named}>'
    base = LINK.format(name="base", z=0.05, mass=2, size="0.1 0.3 0.1")
    base = base.replace("</link>", f"{mesh}</link>")
    joint = MOVED.format(name="arm", at="0 0 0.1")
    verdict = tried(tmp_path, base, ARM, joint, MOTOR.format(name="arm"))
    assert verdict.reaches
    assert any(each.code is UNBALANCED for each in verdict.faults) == (named == "visual")


def test_a_robot_without_weight_and_collisions_turns_with_its_arm(tmp_path):
    base = LINK.format(name="base", z=0.05, mass=2, size="1 1 1")
    light = "".join(
        f'<gazebo reference="{name}"><gravity>false</gravity></gazebo>' for name in ("base", "arm")
    )
    parts = [re.sub("<collision>.*</collision>", "", each) for each in (base, ARM)]
    joint = MOVED.format(name="arm", at="0 0 0.1")
    verdict = tried(tmp_path, *parts, joint, MOTOR.format(name="arm"), light)
    assert verdict.reaches
    assert verdict.stand.state == "yes"
    assert not any(each.code is UNBALANCED for each in verdict.faults)


ROTOR = (
    '<link name="{name}">'
    '<inertial><mass value="0.01"/><inertia ixx="1e-5" iyy="1e-5" izz="1e-5" ixy="0" '
    'ixz="0" iyz="0"/>'
    '</inertial></link><joint name="{name}_joint" type="continuous"><parent link="base"/>'
    '<child link="{name}"/><origin xyz="{x} {y} 0.15"/><axis xyz="0 0 1"/></joint><gazebo>'
    '<plugin name="{name}" filename="gz-sim-multicopter-motor-model-system">'
    "<jointName>{name}_joint</jointName><linkName>{name}</linkName><motorNumber>{number}"
    "</motorNumber><turningDirection>{way}</turningDirection><maxRotVelocity>800</maxRotVelocity>"
    "<motorConstant>{thrust}</motorConstant><momentConstant>0.016</momentConstant>"
    "<commandSubTopic>motors</commandSubTopic><motorType>velocity</motorType></plugin></gazebo>"
)


def test_an_aircraft_that_tilted_in_the_air_does_not_tip_over_on_the_ground(tmp_path):
    """Its joints move after the flight, from standstill."""
    base = LINK.format(name="base", z=0.05, mass=1, size="0.3 0.3 0.1")
    camera = LINK.format(name="camera", z=0, mass=0.1, size="0.05 0.05 0.05")
    camera = camera.replace('"0.1" i', '"0.001" i').replace('izz="0.1"', 'izz="0.001"')
    joint = MOVED.format(name="camera", at="0 0 0.13")
    motor = MOTOR.format(name="camera").replace(">2000<", ">20<").replace(">100<", ">2<")
    rotors = [
        ROTOR.format(name=f"rotor_{n}", number=n, x=x, y=y, way=way, thrust=thrust)
        for n, (x, y, way, thrust) in enumerate(
            [
                (0.2, 0.2, "ccw", 1e-5),
                (-0.2, -0.2, "ccw", 8.5e-6),
                (0.2, -0.2, "cw", 8.5e-6),
                (-0.2, 0.2, "cw", 8.5e-6),
            ]
        )
    ]
    verdict = tried(tmp_path, base, camera, joint, motor, *rotors)
    assert verdict.flights
    assert verdict.reaches
    assert not verdict.faults


def test_a_robot_may_fall_when_its_legs_move(tmp_path):
    base = LINK.format(name="base", z=0.6, mass=5, size="0.3 0.3 0.1")
    leg = LINK.format(name="leg", z=-0.25, mass=1, size="0.1 0.3 0.5")
    joint = MOVED.format(name="leg", at="0 0 0.55")
    verdict = tried(tmp_path, base, leg, joint, MOTOR.format(name="leg"))
    assert verdict.reaches
    assert not verdict.faults


LIFT = (
    '<joint name="foot_joint" type="prismatic"><parent link="base"/><child link="foot"/>'
    '<axis xyz="0 0 1"/><limit lower="-0.3" upper="0.3" effort="1000" velocity="2"/></joint>'
)
HELD = (
    '<gazebo><plugin name="m" filename="gz-sim-joint-position-controller-system">'
    "<joint_name>foot_joint</joint_name><p_gain>{gain}</p_gain><d_gain>200</d_gain>"
    "<initial_position>0.1</initial_position></plugin></gazebo>"
)


@pytest.mark.parametrize(("gain", "state"), [(20000, "yes"), (1500, "sinks")])
def test_a_robot_that_bends_its_legs_on_purpose_does_not_sink(tmp_path, gain, state):
    """It does if the load bends them further."""
    base = LINK.format(name="base", z=0.5, mass=5, size="0.3 0.3 0.1")
    foot = LINK.format(name="foot", z=0.05, mass=5, size="0.5 0.5 0.1")
    stand = tried(tmp_path, base, foot, LIFT, HELD.format(gain=gain)).stand
    assert stand.sunk > 0.09
    assert stand.state == state
