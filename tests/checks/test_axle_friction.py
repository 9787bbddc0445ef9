"""Wheels whose friction along their axle differs from that in their rolling direction."""

import pytest
from tests.corpus.carts import written

import cartwheel
from cartwheel.codes.robot import SKID_STEERING
from cartwheel.corpus import try_robot

BASE = (
    '<link name="base">'
    '<inertial><mass value="8"/><inertia ixx="0.2" iyy="0.2" izz="0.3" ixy="0" ixz="0" iyz="0"/>'
    '</inertial><collision><geometry><box size="0.5 0.25 0.06"/></geometry></collision></link>'
)
WHEEL = (
    '<link name="{name}">'
    '<inertial><mass value="0.4"/><inertia ixx="1e-3" iyy="1e-3" izz="2e-3" ixy="0" '
    'ixz="0" iyz="0"/>'
    '</inertial><collision><geometry><cylinder radius="0.1" length="0.04"/></geometry></collision>'
    '</link><joint name="{name}_joint" type="continuous"><parent link="base"/>'
    '<child link="{name}"/><origin xyz="{x} {y} -0.02" rpy="-1.5708 0 0"/>'
    '<axis xyz="0 0 1"/></joint>'
    '<gazebo reference="{name}"><mu1>{mu1}</mu1><mu2>{mu2}</mu2>{fdir}</gazebo>'
)
AXLE = "<fdir1>0 0 1</fdir1>"
DRIVE = (
    '<gazebo><plugin name="drive" filename="libgazebo_ros_diff_drive.so">{joints}'
    "<wheel_separation>0.4</wheel_separation><wheel_diameter>0.2</wheel_diameter>"
    "<max_wheel_torque>20</max_wheel_torque></plugin></gazebo>"
)


def cart(mu1, mu2, *, driven=("back",), fdir=AXLE):
    """A cart with two axles. The friction is that of the front wheels, or of all driven ones."""
    wheels, joints = "", ""
    for end, x in (("front", 0.18), ("back", -0.18)):
        special = end == "front" or len(driven) == 2
        for side, y in (("left", 0.2), ("right", -0.2)):
            wheels += WHEEL.format(
                name=f"{end}_{side}",
                x=x,
                y=y,
                mu1=mu1 if special else 1,
                mu2=mu2 if special else 1,
                fdir=fdir if special else "",
            )
            if end in driven:
                joints += f"<{side}_joint>{end}_{side}_joint</{side}_joint>"
    pairs = f"<num_wheel_pairs>{len(driven)}</num_wheel_pairs>"
    return BASE + wheels + DRIVE.format(joints=pairs + joints)


def predicted(path):
    found = [e for e in cartwheel.check(path).findings if e.code is SKID_STEERING]
    return found[0].values["ratio"] if found else 1.0


@pytest.mark.parametrize("driven", [("back",), ("front", "back")])
@pytest.mark.parametrize("mu1", [0.0, 0.2, 1.0])
def test_the_friction_along_the_axle_slows_a_turn_down(tmp_path, mu1, driven):
    path = written(tmp_path, cart(mu1, 1, driven=driven))
    (drive,) = try_robot(path, standing=1.0).drives
    assert predicted(path) == pytest.approx(1.0 + drive.error_turn, abs=0.07)


@pytest.mark.parametrize("fdir", ["", "<fdir1>1 0 0</fdir1>"])
def test_directions_of_the_world_or_that_turn_with_the_wheel_do_not_let_it_slide(tmp_path, fdir):
    path = written(tmp_path, cart(0, 1, fdir=fdir))
    assert predicted(path) < 0.7


def test_wheels_that_slide_freely_along_their_axle_are_no_fault(tmp_path):
    path = written(tmp_path, cart(0, 1))
    assert not [each for each in cartwheel.check(path).findings if each.code is SKID_STEERING]
    assert try_robot(path, standing=1.0).good
