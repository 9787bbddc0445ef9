"""Wheels that are available to controllers, but that no controller commands."""

import pytest
from tests.corpus.carts import plugin, written

import cartwheel
from cartwheel.codes.robot import BODY_ON_GROUND, SKID_STEERING
from cartwheel.corpus import try_robot

LINK = (
    '<link name="{name}"><inertial><mass value="{mass}"/>'
    '<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/>'
    "</inertial><collision><geometry>{shape}</geometry></collision></link>"
)
JOINT = (
    '<joint name="{name}_joint" type="{kind}"><parent link="{parent}"/><child link="{name}"/>'
    '<origin xyz="{at}"/><axis xyz="0 1 0"/>{more}</joint>'
)
TRANSMISSION = (
    '<transmission name="{joint}_t"><type>transmission_interface/SimpleTransmission</type>'
    '<joint name="{joint}"><hardwareInterface>hardware_interface/{kind}JointInterface'
    '</hardwareInterface></joint><actuator name="{joint}_a"/></transmission>'
)
MANAGER = '<gazebo><plugin name="m" filename="libgazebo_ros_control.so"/></gazebo>'
CONTROLLER = "rear: {{type: effort_controllers/JointEffortController, joint: {joint}}}\n"


def rover(kind="Effort", manager="", rocker=False):
    """A cart with driven wheels in front. Its rear wheels have transmissions."""
    text = LINK.format(name="base", mass=5, shape='<box size="0.4 0.2 0.1"/>')
    held = "base"
    if rocker:
        held = "rocker"
        text += LINK.format(name=held, mass=1, shape='<box size="0.1 0.1 0.02"/>')
        limit = '<limit lower="-1" upper="1" effort="9" velocity="9"/>'
        place = {"parent": "base", "kind": "revolute", "at": "-0.15 0 0", "more": limit}
        text += JOINT.format(name=held, **place)
    for name, x in (("front", 0.15), ("rear", -0.15)):
        for side, y in (("left", 0.15), ("right", -0.15)):
            wheel = side if name == "front" else f"{name}_{side}"
            parent = held if name == "rear" else "base"
            at = f"{0 if parent == 'rocker' else x} {y} 0"
            text += LINK.format(name=wheel, mass=0.5, shape='<sphere radius="0.1"/>')
            text += JOINT.format(name=wheel, kind="continuous", parent=parent, at=at, more="")
            if name == "rear":
                text += TRANSMISSION.format(joint=f"{wheel}_joint", kind=kind)
    limit = '<limit lower="-1" upper="1" effort="9" velocity="9"/>'
    text += LINK.format(name="arm", mass=0.1, shape='<box size="0.1 0.02 0.02"/>')
    text += JOINT.format(name="arm", kind="revolute", parent="base", at="0 0 0.1", more=limit)
    text += TRANSMISSION.format(joint="arm_joint", kind="Effort")
    drive = plugin(0.3).replace("Diameter>0.1<", "Diameter>0.2<")
    return text + drive + manager


@pytest.mark.parametrize(
    ("kind", "manager", "commanded", "slides"),
    [
        ("Effort", "", "", True),
        ("Velocity", "", "", False),
        # The controllers may be in another package.
        ("Effort", MANAGER, "", False),
        ("Effort", MANAGER, "arm_joint", True),
        ("Effort", MANAGER, "rear_left_joint", False),
    ],
)
def test_wheels_that_no_controller_commands_slide_to_the_side_in_a_turn(
    tmp_path, kind, manager, commanded, slides
):
    if commanded:
        (tmp_path / "config").mkdir()
        (tmp_path / "package.xml").write_text("<package><name>rover</name></package>")
        (tmp_path / "config" / "c.yaml").write_text(CONTROLLER.format(joint=commanded))
    path = written(tmp_path, rover(kind, manager))
    codes = {each.code for each in cartwheel.check(path).findings}
    assert (SKID_STEERING in codes) == slides


def test_wheels_of_a_rocker_that_roll_freely_do_not_brake(tmp_path):
    """The servos of their transmissions have no effort, because there is no controller."""
    verdict = try_robot(written(tmp_path, rover(manager=MANAGER, rocker=True)), standing=1.0)
    (driven,) = verdict.drives
    assert not driven.passes
    assert BODY_ON_GROUND not in {each.code for each in verdict.observed}


def test_the_place_in_a_controller_file_is_relative_like_that_in_the_robot(tmp_path, monkeypatch):
    (tmp_path / "config").mkdir()
    (tmp_path / "package.xml").write_text("<package><name>rover</name></package>")
    kind = "position_controllers/JointPositionControler"
    (tmp_path / "config" / "c.yaml").write_text(f"arm: {{type: {kind}, joint: arm_joint}}\n")
    written(tmp_path, rover(manager=MANAGER))
    monkeypatch.chdir(tmp_path)
    files = {each.origin.file for each in cartwheel.check("robot.urdf").findings if each.origin}
    assert "config/c.yaml" in files
    assert not [file for file in files if file.startswith("/")]
