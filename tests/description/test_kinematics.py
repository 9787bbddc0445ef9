"""Forward kinematics against what a hand computes."""

import math
from dataclasses import replace

import pytest

from cartwheel.description import load_robot, load_text
from cartwheel.description.kinematics import center_of_mass, joint_positions, link_poses
from cartwheel.description.model import Axis, Joint, Link, RobotDescription
from cartwheel.errors import Origin
from cartwheel.geometry import Pose

BODY = (
    '<inertial><mass value="1"/>'
    '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
)


def arm(*extra):
    links = "".join(f'<link name="{name}">{BODY}</link>' for name in ("base", "upper", "lower"))
    text = f"""<robot name="r">{links}
<joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/>
<origin xyz="0 0 1"/><axis xyz="0 0 1"/></joint>
<joint name="elbow" type="continuous"><parent link="upper"/><child link="lower"/>
<origin xyz="2 0 0"/><axis xyz="0 0 1"/>{extra[0] if extra else ""}</joint></robot>"""
    return load_text(text)


def test_zero_is_as_described():
    robot = arm()
    assert link_poses(robot, {}) == {link.name: link.pose for link in robot.links}


def test_the_centre_of_mass_follows_the_joints():
    robot = arm()
    for angle in (0.0, 1.2):
        place = center_of_mass(robot, link_poses(robot, {"shoulder": angle}))
        wanted = (2 / 3 * math.cos(angle), 2 / 3 * math.sin(angle), 2 / 3)
        assert place == pytest.approx(wanted, abs=1e-12)
    massless = [replace(link, inertial=None) for link in robot.links]
    assert center_of_mass(replace(robot, links=tuple(massless)), link_poses(robot, {})) is None


def test_two_turns():
    poses = link_poses(arm(), {"shoulder": math.pi / 2, "elbow": math.pi / 2})
    assert poses["base"] == Pose()
    assert poses["upper"].position == pytest.approx((0, 0, 1))
    assert poses["lower"].position == pytest.approx((0, 2, 1))
    assert poses["lower"].yaw == pytest.approx(math.pi)


def test_mimic_overrules_and_chains():
    robot = arm('<mimic joint="shoulder" multiplier="-2" offset="0.5"/>')
    assert joint_positions(robot, {"shoulder": 0.1, "elbow": 9}) == pytest.approx(
        {"shoulder": 0.1, "elbow": 0.3}
    )
    assert link_poses(robot, {"shoulder": 0.1})["lower"].yaw == pytest.approx(0.4)


def test_slider():
    text = f"""<robot name="r"><link name="a">{BODY}</link><link name="b">{BODY}</link>
<joint name="j" type="prismatic"><parent link="a"/><child link="b"/><axis xyz="0 3 4"/>
<limit lower="0" upper="9" effort="1" velocity="1"/></joint></robot>"""
    assert link_poses(load_text(text), {"j": 5})["b"].position == pytest.approx((0, 3, 4))


def built(joint):
    """A model of SDF's kind, in which joint frames lie anywhere and links are in any order."""
    here = Origin(file="f")
    return RobotDescription(
        name="r",
        links=(
            Link(name="b", pose=Pose((1, 0, 0)), origin=here),
            Link(name="a", pose=Pose((0, 0, 3)), origin=here),
        ),
        joints=(joint,),
        canonical_link="a",
        origin=here,
    )


def test_joint_frame_away_from_the_child():
    joint = Joint(
        name="j",
        type="revolute",
        parent="a",
        child="b",
        pose=Pose((0, 1, 0)),
        axis=Axis(xyz=(0, 0, 1)),
        origin=Origin(file="f"),
    )
    pose = link_poses(built(joint), {"j": math.pi})["b"]
    assert pose.position == pytest.approx((1, 2, 0), abs=1e-12)
    assert link_poses(built(joint), {})["a"] == Pose((0, 0, 3))


def test_screw():
    joint = Joint(
        name="j",
        type="screw",
        parent="world",
        child="b",
        axis=Axis(xyz=(1, 0, 0)),
        thread_pitch=math.pi,
        origin=Origin(file="f"),
    )
    pose = link_poses(built(joint), {"j": 2 * math.pi})["b"]
    assert pose.position == pytest.approx((3, 0, 0))


def test_the_cart_s_wheels_turn_where_they_are():
    cart = load_robot("rosbots.xacro")
    before, after = link_poses(cart, {}), link_poses(cart, {"wheel_left_joint": 1.0})
    assert after["wheel_left_link"].position == pytest.approx(before["wheel_left_link"].position)
    assert after["wheel_left_link"] != before["wheel_left_link"]
    assert after["wheel_right_link"] == before["wheel_right_link"]


def test_a_long_chain():
    links = "".join(f'<link name="l{n}">{BODY}</link>' for n in range(2000))
    joints = "".join(
        f'<joint name="j{n}" type="fixed"><parent link="l{n}"/><child link="l{n + 1}"/>'
        '<origin xyz="1 0 0"/></joint>'
        for n in range(1999)
    )
    robot = load_text(f'<robot name="r">{links}{joints}</robot>')
    assert link_poses(robot, {})["l1999"].position == pytest.approx((1999, 0, 0))
