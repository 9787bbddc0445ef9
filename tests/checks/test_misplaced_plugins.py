"""Plugins and links that findings name: the right place, joint, tag and body."""

import pytest

import cartwheel
from cartwheel.codes.devices import (
    PLUGIN_MISPLACED,
    PLUGIN_PARAMETER_MISSING,
    PLUGIN_PARAMETER_UNKNOWN,
)
from cartwheel.codes.robot import BASE_WITHOUT_COLLISION

LINK = (
    '<link name="base">'
    '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
    "</inertial>"
    '<collision><geometry><box size="1 1 1"/></geometry></collision></link>'
)
LASER = '<plugin name="p" filename="libgazebo_ros_laser.so"/>'
SENSOR = f'<sensor name="s" type="ray"><ray/>{LASER}</sensor>'


def misplaced(path):
    found = cartwheel.check(path).findings
    return [each.values["place"] for each in found if each.code is PLUGIN_MISPLACED]


@pytest.mark.parametrize(
    ("tags", "places"),
    [
        (f"<gazebo>{LASER}</gazebo>", ["sensor"]),
        (f'<gazebo reference="base">{SENSOR}</gazebo>', []),
        ('<gazebo><plugin name="p" filename="libgazebo_ros_p3d.so"/></gazebo>', []),
        ('<gazebo><plugin name="p" filename="libmine.so"/></gazebo>', []),
    ],
)
def test_a_plugin_outside_its_sensor_is_reported(tmp_path, tags, places):
    path = tmp_path / "robot.urdf"
    path.write_text(f'<robot name="robot">{LINK}{tags}</robot>')
    assert misplaced(path) == places


def test_a_plugin_of_a_model_in_a_world_is_reported(tmp_path):
    path = tmp_path / "a.world"
    plugin = '<plugin name="p" filename="libgazebo_ros_diff_drive.so"/>'
    path.write_text(f'<sdf version="1.6"><world name="w">{plugin}</world></sdf>')
    assert misplaced(path) == ["model"]


@pytest.mark.parametrize("lost", ["mesh", "model"])
def test_a_missing_mesh_contains_no_joint(tmp_path, lost):
    """A missing model may contain one."""
    mesh = (
        '<link name="l"><visual name="v"><geometry><mesh><uri>model://gone/a.dae</uri></mesh>'
        "</geometry></visual></link>"
    )
    part = mesh if lost == "mesh" else "<include><uri>model://gone</uri></include>"
    path = tmp_path / "robot.sdf"
    path.write_text(
        f'<sdf version="1.7"><model name="m"><link name="base"/>{part}'
        '<plugin name="p" filename="libgazebo_ros_diff_drive.so"/></model></sdf>'
    )
    missing = [
        each for each in cartwheel.check(path).findings if each.code is PLUGIN_PARAMETER_MISSING
    ]
    assert len(missing) == (2 if lost == "mesh" else 0)


@pytest.mark.parametrize("other", ["", "<hackBaseline>0</hackBaseline>"])
def test_a_tag_is_not_replaced_by_one_that_exists_in_another_spelling(tmp_path, other):
    camera = (
        '<gazebo reference="base"><sensor name="s" type="camera"><camera/>'
        '<plugin name="p" filename="libgazebo_ros_camera.so"><hackbaseline>0.2</hackbaseline>'
        f"{other}</plugin></sensor></gazebo>"
    )
    path = tmp_path / "robot.urdf"
    path.write_text(f'<robot name="robot">{LINK}{camera}</robot>')
    (found,) = [e for e in cartwheel.check(path).findings if e.code is PLUGIN_PARAMETER_UNKNOWN]
    assert bool(found.instead) == (not other)


def test_the_body_without_a_collision_is_the_largest_link_of_those_fixed_together(tmp_path):
    """The first ones in the file are an IMU and a footprint."""
    wheel = LINK.replace('"base"', '"wheel"')
    names = ("imu", "0.01"), ("base", "0.4")
    looks = "".join(
        f'<link name="{name}"><visual><geometry><box size="{size} {size} {size}"/></geometry>'
        "</visual></link>"
        for name, size in names
    )
    joints = "".join(
        f'<joint name="{child}_j" type="{kind}"><parent link="foot"/><child link="{child}"/>'
        "</joint>"
        for child, kind in (("imu", "fixed"), ("base", "fixed"), ("wheel", "continuous"))
    )
    path = tmp_path / "robot.urdf"
    path.write_text(f'<robot name="robot">{looks}<link name="foot"/>{wheel}{joints}</robot>')
    (found,) = [e for e in cartwheel.check(path).findings if e.code is BASE_WITHOUT_COLLISION]
    assert found.values["link"] == "base"
