"""Inertias that are far too large for a body."""

import pytest
from tests.corpus.carts import cart, plugin, written

import cartwheel
from cartwheel.codes.robot import INERTIA_GEOMETRY_MISMATCH
from cartwheel.corpus import try_robot

USUAL = 'ixx="0.02" iyy="0.02" izz="0.02"'
MISSING = '<visual><geometry><mesh filename="body.stl"/></geometry></visual>'


def base(moment, more=""):
    """The cart, whose body has three equal moments of inertia in kg m²."""
    inertia = USUAL.replace("0.02", f"{moment:g}")
    text = cart().replace(USUAL, inertia, 1).replace("</inertial>", f"</inertial>{more}", 1)
    assert moment == 0.02 or inertia in text
    return text


@pytest.mark.parametrize("more", ["", MISSING])
def test_a_body_that_no_tyre_turns_is_the_reason(tmp_path, more):
    verdict = try_robot(written(tmp_path, base(1e5, more), plugin()), standing=1.0)
    turned = [fault for fault in verdict.faults if fault.test == "turn"]
    assert [(each.code, each.source) for each in turned] == [(INERTIA_GEOMETRY_MISMATCH, "file")]


@pytest.mark.parametrize(
    ("moment", "more", "told"),
    [
        (0.02, "", False),
        (0.5, "", True),
        # The mesh may be larger than the collision.
        (0.5, MISSING, False),
        (1e3, MISSING, True),
    ],
)
def test_a_missing_mesh_only_excuses_what_it_may_contain(tmp_path, moment, more, told):
    found = cartwheel.check(written(tmp_path, base(moment, more), plugin())).findings
    links = [each.values["link"] for each in found if each.code is INERTIA_GEOMETRY_MISMATCH]
    assert ("base" in links) is told


def test_an_inertia_beyond_any_motor_comes_before_gains(tmp_path):
    """A link of 10 g with 1 kg m² swings whatever its controller does."""
    moments = 'ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"'
    mass = '<inertial><mass value="{}"/><inertia {}/></inertial>'
    box = '<collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision>'
    limb = mass.format(0.01, moments)
    path = written(
        tmp_path,
        f'<link name="world"/><link name="base">{mass.format(1, moments)}{box}</link>'
        '<joint name="fix" type="fixed"><parent link="world"/><child link="base"/></joint>'
        f'<link name="limb">{limb}{box}</link><joint name="hip" type="revolute">'
        '<parent link="base"/><child link="limb"/><origin xyz="0 0 0.2"/><axis xyz="0 0 1"/>'
        '<limit lower="-1" upper="1" effort="9" velocity="9"/></joint>'
        '<transmission name="t"><type>transmission_interface/SimpleTransmission</type>'
        '<joint name="hip"><hardwareInterface>hardware_interface/EffortJointInterface'
        '</hardwareInterface></joint><actuator name="a"/></transmission>'
        '<gazebo><plugin name="c" filename="libgazebo_ros_control.so"/></gazebo>',
    )
    (tmp_path / "package.xml").write_text("<package><name>hips</name></package>")
    (tmp_path / "config").mkdir()
    (tmp_path / "config" / "hips.yaml").write_text(
        "hip_controller: {type: effort_controllers/JointPositionController, joint: hip,"
        " pid: {p: 10.0, i: 0.0, d: 0.0}}\n"
    )
    (fault,) = [each for each in try_robot(path, standing=1.0).faults if each.test == "reach"]
    assert (fault.subject, fault.code) == ("hip", INERTIA_GEOMETRY_MISMATCH)
