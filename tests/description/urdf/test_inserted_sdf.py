"""Links, joints and frames of SDF in a ``<gazebo>`` without a reference."""

import math

import pytest
from tests.coded import placed

from cartwheel.description import load_text
from cartwheel.geometry import Pose

BODY = (
    '<inertial><mass value="1"/>'
    '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
)
COLLISION = '<collision><geometry><box size="1 1 1"/></geometry></collision>'
LINKS = (
    f'<link name="base">{BODY}{COLLISION}</link><link name="mast"/><link name="arm">{BODY}</link>'
    '<joint name="weld" type="fixed"><parent link="base"/><child link="mast"/>'
    '<origin xyz="0.2 0 0.5"/></joint>'
    '<joint name="hinge" type="continuous"><parent link="base"/><child link="arm"/>'
    '<origin xyz="0 0.3 0" rpy="0 0 1.5707963267948966"/></joint>'
)


def load(*parts):
    """A robot whose parts of SDF begin in line 2."""
    text = f'<robot name="r">{LINKS}<gazebo>\n' + "\n".join(parts) + "\n</gazebo></robot>"
    return load_text(text, file="robot.urdf")


def joint(name, parent, child, more="", kind="fixed"):
    return (
        f'<joint name="{name}" type="{kind}"><parent>{parent}</parent><child>{child}</child>'
        f"{more}</joint>"
    )


def test_a_link_stands_in_the_model_s_frame_and_hangs_on_a_link_of_the_urdf():
    robot = load(
        '<link name="laser"><pose>0.2 0 0.6 0 0 0.5</pose><inertial><mass>0.3</mass></inertial>'
        '<sensor name="scanner" type="ray"/></link>',
        joint("laser_joint", "mast", "laser"),
    )
    laser = robot.link("laser")
    assert laser.pose == Pose.from_xyz_rpy((0.2, 0, 0.6), (0, 0, 0.5))
    assert laser.inertial.mass == 0.3
    assert [(each.name, each.type, each.link) for each in laser.sensors] == [
        ("scanner", "ray", "laser")
    ]
    held = robot.joint("laser_joint")
    assert (held.type, held.parent, held.child) == ("fixed", "mast", "laser")
    assert held.pose.position == (0, 0, 0)
    assert robot.canonical_link == "base"
    assert not robot.diagnostics


def test_poses_may_refer_to_the_urdf_and_to_frames():
    """The arm stands at y = 0.3, a quarter turn to the left: its x is the base's y."""
    robot = load(
        '<frame name="end" attached_to="arm"><pose>1 0 0 0 0 0</pose></frame>',
        '<link name="tool"><pose relative_to="end">0.5 0 0 0 0 0</pose></link>',
        joint("grip", "end", "tool"),
        '<link name="lid"><pose relative_to="weld">0 0 1 0 0 0</pose></link>',
        joint("lock", "base", "lid"),
    )
    assert robot.link("tool").pose.position == pytest.approx((0, 1.8, 0))
    assert robot.link("tool").pose.yaw == pytest.approx(math.pi / 2)
    assert robot.link("lid").pose.position == pytest.approx((0.2, 0, 1.5))
    assert robot.joint("grip").parent == "arm"
    assert not robot.diagnostics


def test_a_joint_between_links_of_the_urdf_carries_its_sensor():
    sensor = '<sensor name="pull" type="force_torque"/>'
    robot = load(joint("stay", "mast", "arm", sensor))
    assert robot.joint("stay").child == "arm"
    (found,) = robot.link("arm").sensors
    assert (found.name, found.joint) == ("pull", "stay")


def test_several_tags_belong_together():
    text = (
        f'<robot name="r">{LINKS}<gazebo>{joint("j", "base", "l")}</gazebo>'
        '<gazebo><link name="l"/></gazebo></robot>'
    )
    robot = load_text(text, file="robot.urdf")
    assert robot.joint("j").child == "l"
    assert not robot.diagnostics


SOUND = '<link name="sound"><pose>0 0 2 0 0 0</pose></link>'


@pytest.mark.parametrize(
    ("part", "code"),
    [
        (
            '<link name="base"/>',
            "name-taken",
        ),
        (
            joint("hinge", "base", "sound"),
            "name-taken",
        ),
        (
            joint("j", "bass", "sound"),
            "joint-link-unknown base",
        ),
        (
            joint("j", "base", "sounds"),
            "joint-link-unknown sound",
        ),
        (
            joint("j", "base", "sound", kind="revolut"),
            "joint-type-unknown revolute",
        ),
        (
            joint("j", "base", "sound", "<axis><mimic joint='hing'/></axis>", "continuous"),
            "mimic-unknown hinge",
        ),
        (
            '<link name="l"><inertial><mass>-2</mass></inertial></link>',
            "mass-not-positive",
        ),
        (
            '<frame name="f" attached_to="mas"/>',
            "name-unknown mast",
        ),
        ("<link/>", "tag-missing"),
    ],
)
def test_a_mistake_costs_its_element_alone(part, code):
    robot = load(SOUND, part)
    (reported,) = robot.diagnostics
    assert placed(reported) == f"robot.urdf:3 error {code}"
    assert reported.values["left_out"] in ("link", "joint", "frame")
    assert {link.name for link in robot.links} == {"base", "mast", "arm", "sound"}
    assert {each.name for each in robot.joints} == {"weld", "hinge"}


def test_what_refers_to_a_link_that_is_left_out_is_reported_too():
    wrong = '<link name="l"><inertial><mass>x</mass></inertial></link>'
    robot = load(wrong, joint("j", "base", "l"))
    assert [(str(each.origin), each.severity) for each in robot.diagnostics] == [
        ("robot.urdf:2", "error"),
        ("robot.urdf:3", "error"),
    ]
    assert robot.diagnostics[1].code.name == "joint-link-unknown"
    assert robot.diagnostics[1].values["name"] == "l"


def test_a_static_robot_asks_for_no_mass():
    link = '<link name="l"><inertial><mass>0</mass></inertial></link>'
    robot = load("<static>true</static>", link)
    assert robot.link("l").inertial is None
    assert not robot.diagnostics
