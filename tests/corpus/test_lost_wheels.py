"""Robots whose driven wheels lose their collision, because its mesh does not exist."""

import pytest
from tests.corpus.carts import cart, plugin, written

from cartwheel.codes.files import FILE_MISSING
from cartwheel.codes.robot import WHEEL_SEPARATION_MISMATCH
from cartwheel.corpus import try_robot

MESH = '<mesh filename="package://no_such_package/{name}.stl"/>'
CYLINDER = '<cylinder radius="0.1" length="0.04"/>'
BODY = (
    '<link name="{name}"><inertial><mass value="{mass}"/><inertia ixx="0.02" iyy="0.02" izz="0.02"'
    " "
    'ixy="0" ixz="0" iyz="0"/></inertial><collision><origin xyz="0 0 {z}"/><geometry>{shape}'
    "</geometry></collision></link>"
)
DRIVE = (
    '<gazebo><plugin name="drive" filename="libgazebo_ros_diff_drive.so"><num_wheel_pairs>2'
    "</num_wheel_pairs>{joints}<wheel_separation>0.5</wheel_separation><wheel_diameter>0.2"
    "</wheel_diameter></plugin></gazebo>"
)


def rover(wheel):
    """A rover of which each side has a passive rocker with two wheels, and a body whose mesh does
    not exist.
    """
    parts = BODY.format(name="base", mass=4, z=0, shape=MESH.format(name="body"))
    joints = ""
    for side, y in (("left", 0.25), ("right", -0.25)):
        box = '<box size="0.3 0.02 0.02"/>'
        parts += BODY.format(name=f"{side}_rocker", mass=0.5, z=-0.08, shape=box)
        parts += (
            f'<joint name="{side}_rocker_joint" type="revolute"><parent link="base"/>'
            f'<child link="{side}_rocker"/><origin xyz="0.04 {y} 0"/><axis xyz="0 1 0"/>'
            '<limit lower="-0.3" upper="0.3" effort="50" velocity="5"/></joint>'
        )
        for end, x in (("front", 0.15), ("back", -0.15)):
            name = f"{side}_{end}"
            parts += BODY.format(name=name, mass=0.4, z=0, shape=wheel).replace(
                'origin xyz="0 0 0"', 'origin rpy="1.5708 0 0"'
            )
            parts += (
                f'<joint name="{name}_joint" type="continuous"><parent link="{side}_rocker"/>'
                f'<child link="{name}"/><origin xyz="{x} 0 -0.15"/><axis xyz="0 1 0"/></joint>'
            )
            joints += f"<{side}_joint>{name}_joint</{side}_joint>"
    return parts + DRIVE.format(joints=joints)


def test_the_lost_wheels_are_why_a_rover_on_rockers_neither_stands_nor_drives(tmp_path):
    """The body has lost its collision as well, and the rockers, which nothing holds, rest on the
    ground.
    """
    verdict = try_robot(written(tmp_path, rover(MESH.format(name="wheel"))), standing=2.0)
    faults = {fault.test: fault for fault in verdict.faults}
    assert set(faults) == {"stand", "drive", "turn"}
    for fault in faults.values():
        assert fault.code is FILE_MISSING
        assert fault.reason.values["link"].startswith(("left_", "right_"))
        assert not fault.reason.values["link"].endswith("rocker")


def test_the_lost_body_is_not_why_a_rover_does_not_drive(tmp_path):
    (drive,) = try_robot(written(tmp_path, rover(CYLINDER)), standing=2.0).drives
    assert drive.follows


@pytest.mark.parametrize("separation", [0.2, 0.3])
def test_a_size_explains_a_turn_rate_although_a_passive_mesh_is_lost(tmp_path, separation):
    lost = BODY.format(name="box", mass=0.1, z=0, shape=MESH.format(name="box"))
    lost += '<joint name="box_joint" type="fixed"><parent link="base"/><child link="box"/></joint>'
    verdict = try_robot(written(tmp_path, cart(), lost, plugin(separation)), standing=1.0)
    codes = [fault.code for fault in verdict.faults]
    assert codes == [WHEEL_SEPARATION_MISMATCH] * (separation != 0.2)
