"""What a URDF says, and every error of one with its place and likely fix."""

import math
from pathlib import Path

import pytest

from cartwheel.description import load_text
from cartwheel.description import model as m
from cartwheel.errors import DescriptionError
from cartwheel.geometry import Pose

BODY = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial>'

OPEN_VISUAL = '<link name="a"><visual>'
CLOSE_VISUAL = "</visual></link>"


def urdf(*lines, name="r"):
    """A robot whose first line of content is line 2."""
    return f'<robot name="{name}">\n' + "\n".join(lines) + "\n</robot>"


def link(name, content=BODY):
    return f'<link name="{name}">{content}</link>'


def joint(name, parent, child, content="", kind="fixed"):
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f"{content}</joint>"
    )


def with_part(inertia, mass=1):
    """A trunk of 50 kg with a part on a hinge, whose mass and inertia stand in line 3."""
    trunk = '<inertial><mass value="50"/><inertia ixx="9" iyy="9" izz="9"/></inertial>'
    return urdf(
        link("trunk", trunk) + '<link name="a">',
        f'<inertial><mass value="{mass}"/>{inertia}</inertial></link>',
        joint("hinge", "trunk", "a", '<limit effort="1" velocity="1"/>', "continuous"),
    )


def load(text, **more):
    return load_text(text, file="robot.urdf", **more)


def told(description):
    return [str(each) for each in description.diagnostics]


def test_a_link_with_all_its_parts():
    robot = load(
        urdf(
            '<material name="blue"><color rgba="0 0 1 0.5"/></material>',
            '<link name="base">',
            '<inertial><origin xyz="0 0 1" rpy="0 0 1.5"/><mass value="2"/>',
            '<inertia ixx="0.1" iyy="0.2" izz="0.25" ixy="0.01" ixz="0.02" iyz="0.03"/></inertial>',
            '<visual><origin xyz="1 2 3"/><geometry><box size="1 2 3"/></geometry>',
            '<material name="blue"/></visual>',
            '<visual name="dome"><geometry><sphere radius="0.5"/></geometry>',
            '<material name="red"><color rgba="1 0 0 1"/></material></visual>',
            '<collision><geometry><cylinder radius="0.1" length="0.2"/></geometry></collision>',
            '<collision><geometry><capsule radius="0.1" length="0.2"/></geometry></collision>',
            '<collision name="nose"><geometry><sphere radius="1"/></geometry></collision>',
            "</link>",
        )
    )
    (base,) = robot.links
    assert robot.canonical_link == "base"
    assert not robot.diagnostics
    assert base.inertial.mass == robot.mass == 2
    assert base.inertial.pose == Pose.from_xyz_rpy((0, 0, 1), (0, 0, 1.5))
    i = base.inertial
    assert (i.ixx, i.iyy, i.izz, i.ixy, i.ixz, i.iyz) == (0.1, 0.2, 0.25, 0.01, 0.02, 0.03)
    assert [(v.name, v.shape) for v in base.visuals] == [
        ("base_visual", m.Box(size=(1, 2, 3))),
        ("dome", m.Sphere(radius=0.5)),
    ]
    assert base.visuals[0].pose == Pose((1, 2, 3))
    assert base.visuals[0].material == m.Material(name="blue", diffuse=(0, 0, 1, 0.5))
    assert base.visuals[1].material.diffuse == (1, 0, 0, 1)
    assert [(c.name, c.aliases, c.shape) for c in base.collisions] == [
        ("base_collision", (), m.Cylinder(radius=0.1, length=0.2)),
        ("base_collision_1", (), m.Capsule(radius=0.1, length=0.2)),
        ("nose_collision", ("base_collision_2", "nose"), m.Sphere(radius=1)),
    ]
    assert str(base.visuals[1].origin) == "robot.urdf:8"


def test_a_joint_with_all_its_parts():
    robot = load(
        urdf(
            link("a"),
            link("b"),
            '<joint name="ab" type="revolute"><parent link="a"/><child link="b"/>',
            '<origin xyz="1 0 0" rpy="0 0 1"/><axis xyz="0 0 2"/>',
            '<limit lower="-1" upper="2" effort="3" velocity="4"/>',
            '<dynamics damping="0.5" friction="0.6"/><calibration rising="0"/>',
            '<safety_controller k_velocity="1" soft_lower_limit="0"/></joint>',
        )
    )
    (ab,) = robot.joints
    assert (ab.type, ab.parent, ab.child, ab.pose) == ("revolute", "a", "b", Pose())
    assert ab.axis == m.Axis(
        xyz=(0, 0, 1), lower=-1, upper=2, effort=3, velocity=4, damping=0.5, friction=0.6
    )
    assert robot.link("b").pose == Pose.from_xyz_rpy((1, 0, 0), (0, 0, 1))
    (told,) = robot.diagnostics
    assert told.message == (
        "<calibration> in <joint> has no effect: it is for the encoder of a real joint"
    )


@pytest.mark.parametrize(
    "kind", ["fixed", "revolute", "continuous", "prismatic", "floating", "planar"]
)
def test_types_of_joints(kind):
    limit = '<limit effort="1" velocity="1"/>' if kind in ("revolute", "prismatic") else ""
    robot = load(urdf(link("a"), link("b"), joint("j", "a", "b", limit, kind)))
    assert robot.joints[0].type == kind
    assert not robot.diagnostics


def test_axis_defaults_to_x_and_missing_limits_to_zero():
    limit = '<limit effort="1" velocity="1"/>'
    robot = load(urdf(link("a"), link("b"), joint("j", "a", "b", limit, "revolute")))
    assert robot.joints[0].axis.xyz == (1, 0, 0)
    assert (robot.joints[0].axis.lower, robot.joints[0].axis.upper) == (0, 0)


def test_continuous_joints_have_no_range_but_effort():
    limit = '<limit lower="-1" upper="1" effort="5" velocity="inf"/>'
    robot = load(urdf(link("a"), link("b"), joint("j", "a", "b", limit, "continuous")))
    axis = robot.joints[0].axis
    assert (axis.lower, axis.upper, axis.effort, axis.velocity) == (None, None, 5, None)


@pytest.mark.parametrize("what", ["effort", "velocity"])
def test_an_effort_or_velocity_below_zero_means_no_limit(what):
    limit = f'<limit {what}="-1"/>'
    robot = load_text(urdf(link("a"), link("b"), joint("j", "a", "b", limit, "continuous")))
    assert getattr(robot.joints[0].axis, what) is None
    assert [f"the {what} limit -1 is below 0" in d.message for d in robot.diagnostics] == [True]


def test_mimic():
    robot = load(
        urdf(
            link("a"),
            link("b"),
            link("c"),
            joint("j", "a", "b", kind="continuous"),
            joint("k", "a", "c", '<mimic joint="j" multiplier="-2" offset="0.5"/>', "continuous"),
        )
    )
    assert robot.joint("k").mimic == m.Mimic(joint="j", multiplier=-2, offset=0.5)


def test_poses_follow_the_tree_whatever_the_order():
    robot = load(
        urdf(
            link("tip"),
            link("arm"),
            link("base"),
            joint("j2", "arm", "tip", '<origin xyz="1 0 0"/>'),
            joint("j1", "base", "arm", f'<origin xyz="0 0 1" rpy="0 0 {math.pi / 2}"/>'),
        )
    )
    assert robot.canonical_link == "base"
    assert robot.link("tip").pose.position == pytest.approx((0, 1, 1))


def test_link_world_stands_for_the_world():
    robot = load(
        urdf(
            '<link name="world"/>',
            link("base"),
            joint("j", "world", "base", '<origin xyz="0 0 2"/>'),
        )
    )
    assert [each.name for each in robot.links] == ["base"]
    assert robot.canonical_link == "base"
    assert robot.joints[0].parent == "world"
    assert robot.link("base").pose == Pose((0, 0, 2))


def test_transmissions_and_ros2_control_are_passed_on():
    robot = load(
        urdf(
            link("a"),
            '<transmission name="t"><type>x</type></transmission>',
            '<ros2_control name="c" type="system"><hardware/></ros2_control>',
        )
    )
    assert robot.transmissions[0].find("type").text == "x"
    assert robot.ros2_control[0].attribute("type") == "system"
    assert not robot.diagnostics


def test_text_is_kept():
    text = urdf(link("a"))
    assert load(text).text == text


ERRORS = [
    (urdf(), 1, 'the robot "r" has no links\n  Is the robot a xacro macro that is defined'),
    ("<robot/>", 1, "<robot> has neither a name nor links"),
    ('<robot><link name="a"/></robot>', 1, '<robot> has no attribute "name"'),
    ('<robot name=" "><link name="a"/></robot>', 1, 'the attribute "name" of <robot> is empty'),
    (urdf(link("a"), link("a")), 3, 'the link "a" exists twice\n  The first is at robot.urdf:2.'),
    (
        urdf(link("a"), link("b"), joint("j", "a", "b"), joint("j", "a", "b")),
        5,
        'the joint "j" exists twice\n  The first is at robot.urdf:4.',
    ),
    (
        urdf(link("base_link"), link("camera_link"), joint("j", "base_link", "camera_lnk")),
        4,
        'joint "j": child link "camera_lnk" does not exist\n  Did you mean "camera_link"?',
    ),
    (
        urdf(link("a"), joint("j", "world", "a")),
        3,
        'joint "j": parent link "world" does not exist\n  Add <link name="world"/> to fix',
    ),
    (
        urdf(link("a"), link("b"), link("c"), joint("j", "a", "b")),
        4,
        'the links are not one tree: "a", "c" have no joint to a parent\n'
        '  Is a joint missing that has "c" for its child?',
    ),
    (
        urdf(link("a"), link("b"), joint("j", "a", "b"), joint("k", "b", "a")),
        5,
        "the joints make a ring of links: a -> b -> a\n  Turn round or remove",
    ),
    (
        urdf(
            link("r"), link("a"), link("b"), joint("j", "a", "b"), joint("k", "b", "a")
        ),
        6,
        "the joints make a ring of links: a -> b -> a",
    ),
    (
        urdf(link("a"), link("b"), link("c"), joint("j", "a", "c"), joint("k", "b", "c")),
        6,
        'link "c" has two parents: joint "j" joins it to "a", joint "k" to "b"\n'
        '  The joint "j" is at robot.urdf:5.',
    ),
    (urdf(link("a"), joint("j", "a", "a")), 3, 'joint "j" joins the link "a" to itself'),
    (
        urdf('<link name="world"/>', link("a"), joint("j", "a", "world")),
        4,
        'joint "j": the link "world" stands still and cannot be a child',
    ),
    (
        urdf(link("a"), '<joint name="j" type="fixed"><child link="a"/></joint>'),
        3,
        'joint "j" has no <parent>',
    ),
    (
        urdf(link("a"), '<joint name="j" type="fixed"><parent link="a"/></joint>'),
        3,
        'joint "j" has no <child>',
    ),
    (
        urdf(link("a"), link("b"), joint("j", "a", "b", kind="revolut")),
        4,
        'joint "j": the type "revolut" is not known\n  Did you mean "revolute"?',
    ),
    (
        urdf(link("a"), link("b"), joint("j", "a", "b", '\n<axis xyz="0 0 0"/>', "continuous")),
        5,
        'joint "j": the axis 0 0 0 has length 0',
    ),
    (
        urdf(
            link("a"),
            link("b"),
            joint(
                "j",
                "a",
                "b",
                '<limit lower="2" upper="1" effort="1" velocity="1"/>',
                "revolute",
            ),
        ),
        4,
        'joint "j": the lower limit 2 is above the upper limit 1',
    ),
    (
        urdf(link("a"), link("b"), joint("j", "a", "b", '<dynamics damping="-1"/>', "continuous")),
        4,
        'joint "j": the damping -1 is below 0',
    ),
    (
        urdf(link("a"), link("b"), joint("j", "a", "b", '<mimic joint="k"/>', "continuous")),
        4,
        'joint "j" mimics the joint "k", which does not exist',
    ),
    (
        urdf(link("a"), link("b"), joint("j", "a", "b", '<mimic joint="j"/>', "continuous")),
        4,
        'joint "j" mimics itself',
    ),
    (
        urdf('<link name="a">', '<inertial><mass value="abc"/></inertial></link>'),
        3,
        'mass "abc" is not a number',
    ),
    (
        urdf('<link name="a">', "<inertial/></link>"),
        3,
        "<inertial> has no <mass>",
    ),
    (
        urdf(
            '<link name="a">',
            '<inertial><mass value="1"/><inertia ixx="-2" iyy="-1" izz="-1"/></inertial></link>',
        ),
        3,
        'link "a": the inertia is not positive definite: its principal moments are -2, -1 and -1',
    ),
    (
        urdf(OPEN_VISUAL, '<geometry><sphere radius="-1"/></geometry>', CLOSE_VISUAL),
        3,
        'a sphere of link "a" has the negative size -1',
    ),
    (
        urdf('<link name="a"><visual>', '<geometry><bx size="1 1 1"/></geometry></visual></link>'),
        3,
        'the geometry <bx> of link "a" is not known\n  Did you mean "box"?',
    ),
    (
        urdf('<link name="a"><collision>', "<geometry/></collision></link>"),
        3,
        'the <geometry> of a collision of link "a" is empty',
    ),
    (
        urdf('<link name="a">', "<collision/></link>"),
        3,
        'a collision of link "a" has no <geometry>',
    ),
    (
        urdf(
            '<link name="a"><visual>',
            '<geometry><mesh filename="x.stl" scale="1 0 1"/></geometry></visual></link>',
        ),
        3,
        'the scale of a mesh of link "a" is 1 0 1: it is flat',
    ),
    (
        urdf(
            OPEN_VISUAL,
            '<origin xyz="0 0"/><geometry><box size="1 1 1"/></geometry>',
            CLOSE_VISUAL,
        ),
        3,
        'origin xyz "0 0" has 2 numbers, 3 are needed',
    ),
    (
        urdf('<link name="world"/>'),
        2,
        'the only link is "world", which stands for the world itself',
    ),
]  # fmt: skip


@pytest.mark.parametrize(("text", "line", "message"), ERRORS)
def test_errors(text, line, message):
    with pytest.raises(DescriptionError) as caught:
        load(text)
    assert str(caught.value).startswith(f"robot.urdf:{line}: {message}")


@pytest.mark.parametrize("mass", [1, 40])
def test_an_inertia_without_a_moment_above_zero_is_an_error(mass):
    with pytest.raises(DescriptionError, match=r"robot\.urdf:3: .*not positive definite"):
        load(with_part('<inertia ixx="-1" iyy="-1" izz="-1"/>', mass=mass))


def test_a_moment_below_zero_is_raised_with_the_others():
    made = load(with_part('<inertia ixx="-0.1" iyy="1" izz="2"/>')).link("a").inertial
    # The first counts as next to nothing; half of what is missing goes to each of the two.
    assert (made.ixx, made.iyy, made.izz) == pytest.approx((0.5, 1.5, 2.0), abs=1e-5)


def test_an_inertia_that_no_body_has_is_mended_on_a_main_part_too():
    """The largest moment stays, and the others are raised until they add up to it."""
    made = load(with_part('<inertia ixx="0.5" iyy="1" izz="2"/>', mass=40)).link("a").inertial
    assert (made.ixx, made.iyy, made.izz) == pytest.approx((0.75, 1.25, 2.0))


WARNINGS = [
    (
        with_part('<inertia ixx="1" iyy="1" izz="3"/>'),
        'robot.urdf:3: warning: link "a": no body has this inertia: of its principal moments 1, 1 '
        "and 3 kg m², the two smaller add up to 2, less than the largest; here the smaller are 1.5 "
        "and 1.5. A solid box has",
    ),
    (
        with_part(""),
        'robot.urdf:3: warning: link "a" moves, and all its mass lies in a point, with',
    ),
    (
        with_part('<inertia ixx="1" iyy="1" izz="0"/>'),
        'robot.urdf:3: warning: link "a": the inertia is not positive definite: its principal '
        "moments are 0, 1 and 1 kg m²; here the smaller are 1e-06 and 1.",
    ),
    (
        urdf('<link name="a"><inertial><mass value="0"/></inertial></link>'),
        'robot.urdf:2: warning: link "a" has the mass 0: it counts as a frame without mass',
    ),
    (
        urdf(link("a"), '<link name="b"/>', joint("j", "a", "b", kind="continuous")),
        'robot.urdf:3: warning: link "b" moves on the joint "j" but has no <inertial>: '
        "Gazebo drops it with its joint. Here it has 0.001 kg, as it has no geometry either. "
        'Write in link "b": <inertial><origin xyz="0 0 0"/><mass value="0.001"/><inertia '
        'ixx="1e-06" ixy="0" ixz="0" iyy="1e-06" iyz="0" izz="1e-06"/></inertial>',
    ),
    (
        urdf('<link name="a"/>'),
        'robot.urdf:2: warning: the root link "a", with all that is fixed to it, has no '
        "<inertial>: Gazebo does not load such a robot. Here it has 0.001 kg, as it has no "
        'geometry either. Write in link "a": <inertial><origin xyz="0 0 0"/>'
        '<mass value="0.001"/><inertia ixx="1e-06" ixy="0" ixz="0" iyy="1e-06" iyz="0" '
        'izz="1e-06"/></inertial>',
    ),
    (
        urdf(link("a"), link("b"), joint("j", "a", "b", kind="revolute")),
        'robot.urdf:4: warning: joint "j" of type revolute has no <limit>: ROS refuses it, '
        "here it is unlimited",
    ),
    (
        urdf(
            '<link name="a">' + BODY,
            '<visual><geometry><box size="0 1 1"/></geometry></visual></link>',
        ),
        'robot.urdf:3: warning: a box of link "a" has the size 0 1 1: the visual is left out',
    ),
    (
        urdf(
            '<material name="grey"><color rgba="1 1 1 1"/></material>',
            '<link name="a">' + BODY,
            '<visual><geometry><box size="1 1 1"/></geometry>',
            '<material name="gray"/></visual></link>',
        ),
        'robot.urdf:5: warning: the material "gray" is not defined. Did you mean "grey"?',
    ),
    (
        urdf(
            '<material name="g"><color rgba="1 1 1 1"/></material>',
            '<material name="g"><color rgba="0 0 0 1"/></material>',
            link("a"),
        ),
        'robot.urdf:3: warning: the material "g" is defined twice, differently: the first counts',
    ),
    (
        urdf('<material name="g"><color rgba="255 0 0 1"/></material>', link("a")),
        'robot.urdf:2: warning: the colour "255 0 0 1" is not within 0 and 1',
    ),
    (
        urdf('<material name="g">', '<color rgba="1 0 0"/></material>', link("a")),
        'robot.urdf:3: warning: the colour "1 0 0" has no opacity: it is taken for 1',
    ),
    (
        urdf('<material name="g">', '<color rgba="1 0"/></material>', link("a")),
        'robot.urdf:3: warning: color rgba "1 0" has 2 numbers, 4 are needed: '
        "the colour is left out",
    ),
    (
        urdf('<material name="g"><texture filename="x.png"/></material>', link("a")),
        'robot.urdf:2: warning: the texture "x.png" does not exist. Looked for',
    ),
    (
        urdf(link("a"), "<jont/>"),
        "robot.urdf:3: warning: <jont> in <robot> is not understood and is ignored. "
        "Did you mean <joint>?",
    ),
    (
        urdf(link("a"), '<include filename="x"/>'),
        "robot.urdf:3: warning: <include> has no effect: write <xacro:include>",
    ),
    (
        urdf('<link name="world">' + BODY + "</link>", link("a"), joint("j", "world", "a")),
        'robot.urdf:2: warning: the link "world" stands for the world itself: what it consists '
        "of is left out",
    ),
]


def test_a_box_of_negative_size_is_as_large_without_the_sign():
    text = urdf(
        '<link name="a"><collision>',
        '<geometry><box size="1 -2 3"/></geometry>',
        "</collision></link>",
    )
    robot = load(text)
    assert robot.links[0].collisions[0].shape == m.Box(size=(1, 2, 3))
    assert told(robot)[0].startswith(
        'robot.urdf:3: warning: a box of link "a" has the negative size 1 -2 3: it counts'
    )


@pytest.mark.parametrize(("text", "message"), WARNINGS)
def test_warnings(text, message):
    assert any(each.startswith(message) for each in told(load(text)))


@pytest.mark.parametrize(
    ("kind", "uri", "said"),
    [
        ("visual", "package://none/x.stl", 'the package "none" was not found; a visual of link "a"'
         " is left out. Searched: "),
        ("visual", "x.stl", 'the mesh "x.stl" does not exist; a visual of link "a" is left out.'
         " Looked for "),
        ("collision", "y.stl", 'the mesh "y.stl" does not exist; a collision of link "a" is left'
         " out and touches nothing. Looked for "),
        ("collision", "torn.stl", "torn.stl: has no triangles; a collision of link "),
    ],
)  # fmt: skip
def test_a_mesh_that_cannot_be_had_costs_its_shape(kind, uri, said, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("torn.stl").write_text("solid\nfacet")
    shape = f'<{kind}><geometry><mesh filename="{uri}"/></geometry></{kind}>'
    box = f'<{kind}><geometry><box size="1 1 1"/></geometry></{kind}>'
    robot = load(urdf('<link name="a">' + BODY, shape, box + "</link>"))
    left = robot.links[0].visuals if kind == "visual" else robot.links[0].collisions
    assert [part.shape for part in left] == [m.Box(size=(1, 1, 1))]
    (error,) = [each for each in told(robot) if each.startswith("robot.urdf:3: error: ")]
    assert said in error


def test_mesh(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("wheel.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    text = urdf(
        '<link name="a">' + BODY,
        '<visual><geometry><mesh filename="wheel.obj" scale="1 -1 1"/></geometry>',
        '<material name="m"><color rgba="1 0 0 1"/></material></visual></link>',
    )
    (visual,) = load(text).links[0].visuals
    assert visual.shape == m.Mesh(uri="wheel.obj", path=tmp_path / "wheel.obj", scale=(1, -1, 1))
    assert visual.material.yields_to_mesh


def test_point_masses_are_good_enough_where_they_are_fixed():
    point = '<inertial><mass value="0.1"/></inertial>'
    robot = load(urdf(link("a"), link("b", point), joint("j", "a", "b")))
    assert robot.link("b").inertial.mass == 0.1
    assert told(robot) == ['robot.urdf:3: info: link "b" is a point mass: its inertia is 0']


def test_a_warning_is_told_once_for_a_macro_called_twice():
    text = """<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:macro name="part" params="name"><link name="${name}"><oops/></link></xacro:macro>
<xacro:part name="a"/>
</robot>"""
    twice = text.replace(
        '<xacro:part name="a"/>',
        '<xacro:part name="a"/><xacro:part name="b"/>' + joint("j", "a", "b"),
    )
    assert sum("<oops>" in each for each in told(load(twice))) == 1
