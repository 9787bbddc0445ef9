"""What a URDF says, and every error of one with its place and likely fix."""

import math
from pathlib import Path

import pytest
from tests.coded import named, placed

import cartwheel as cw
from cartwheel.codes import tags
from cartwheel.description import load_robot, load_text
from cartwheel.description import model as m
from cartwheel.errors import DescriptionError
from cartwheel.geometry import Pose

BODY = (
    '<inertial><mass value="1"/>'
    '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
)

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
    trunk = (
        '<inertial><mass value="50"/>'
        '<inertia ixx="9" iyy="9" izz="9" ixy="0" ixz="0" iyz="0"/></inertial>'
    )
    return urdf(
        link("trunk", trunk) + '<link name="a">',
        f'<inertial><mass value="{mass}"/>{inertia}</inertial></link>',
        joint("hinge", "trunk", "a", '<limit effort="1" velocity="1"/>', "continuous"),
    )


def load(text, **more):
    return load_text(text, file="robot.urdf", **more)


def reported(description):
    return [placed(each) for each in description.diagnostics]


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
    # ROS and Gazebo know no capsule.
    assert [named(each) for each in robot.diagnostics] == ["link-cut-short"]
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
    (reported,) = robot.diagnostics
    assert (reported.severity, reported.code.name) == ("info", "tag-ignored")
    assert (reported.values["tag"], reported.values["parent"]) == ("calibration", "joint")


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
    other = {"effort": "velocity", "velocity": "effort"}[what]
    limit = f'<limit {what}="-1" {other}="1"/>'
    robot = load_text(urdf(link("a"), link("b"), joint("j", "a", "b", limit, "continuous")))
    assert getattr(robot.joints[0].axis, what) is None
    (reported,) = robot.diagnostics
    assert reported.code.name == "value-ignored"
    assert (reported.values["attribute"], reported.values["stated"]) == (what, -1)


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
    (urdf(), 1, "model-empty"),
    ("<robot/>", 1, "not-a-description"),
    ('<robot><link name="a"/></robot>', 1, "tag-missing"),
    (urdf(link("a"), link("a")), 3, "duplicate-name"),
    (
        urdf(link("a"), link("b"), joint("j", "a", "b"), joint("j", "a", "b")),
        5,
        "duplicate-name",
    ),
    (
        urdf(link("base_link"), link("camera_link"), joint("j", "base_link", "camera_lnk")),
        4,
        "joint-link-unknown camera_link",
    ),
    (
        urdf(link("a"), joint("j", "world", "a")),
        3,
        "joint-link-unknown",
    ),
    (
        urdf(link("a"), link("b"), link("c"), joint("j", "a", "b")),
        4,
        "multiple-roots",
    ),
    (
        urdf(link("a"), link("b"), joint("j", "a", "b"), joint("k", "b", "a")),
        5,
        "kinematic-loop",
    ),
    (
        urdf(
            link("r"), link("a"), link("b"), joint("j", "a", "b"), joint("k", "b", "a")
        ),
        6,
        "kinematic-loop",
    ),
    (
        urdf(link("a"), link("b"), link("c"), joint("j", "a", "c"), joint("k", "b", "c")),
        6,
        "multiple-parents",
    ),
    (urdf(link("a"), joint("j", "a", "a")), 3, "kinematic-loop"),
    (
        urdf('<link name="world"/>', link("a"), joint("j", "a", "world")),
        4,
        "joint-link-unknown",
    ),
    (
        urdf(link("a"), '<joint name="j" type="fixed"><child link="a"/></joint>'),
        3,
        "tag-missing",
    ),
    (
        urdf(link("a"), '<joint name="j" type="fixed"><parent link="a"/></joint>'),
        3,
        "tag-missing",
    ),
    (
        urdf(link("a"), link("b"), joint("j", "a", "b", kind="revolut")),
        4,
        "joint-type-unknown revolute",
    ),
    (
        urdf('<link name="a">', '<inertial><mass value="abc"/></inertial></link>'),
        3,
        "value-invalid",
    ),
    (
        urdf(
            '<link name="a">',
            '<inertial><mass value="1"/><inertia ixx="-2" iyy="-1" izz="-1" '
            'ixy="0" ixz="0" iyz="0"/></inertial></link>',
        ),
        3,
        "inertia-impossible",
    ),
    (
        urdf(OPEN_VISUAL, '<geometry><sphere radius="-1"/></geometry>', CLOSE_VISUAL),
        3,
        "value-invalid",
    ),
    (
        urdf('<link name="a"><visual>', '<geometry><bx size="1 1 1"/></geometry></visual></link>'),
        3,
        "type-unknown box",
    ),
    (
        urdf(
            OPEN_VISUAL,
            '<origin xyz="0 0"/><geometry><box size="1 1 1"/></geometry>',
            CLOSE_VISUAL,
        ),
        3,
        "value-invalid",
    ),
    (
        urdf('<link name="world"/>'),
        2,
        "model-empty",
    ),
]  # fmt: skip


@pytest.mark.parametrize(("text", "line", "code"), ERRORS)
def test_errors(text, line, code):
    with pytest.raises(DescriptionError) as caught:
        load(text)
    assert str(caught.value.origin) == f"robot.urdf:{line}"
    assert named(caught.value) == code


LOADED = {
    "reversed": (
        joint("j", "a", "b", '<limit lower="2" upper="1" effort="1" velocity="1"/>', "revolute"),
        "limit-reversed",
    ),
    "unreachable": (
        joint("j", "a", "b", '<limit lower="1e9" upper="1e9" effort="0"/>', "revolute"),
        "limit-unreachable",
    ),
    "damping": (joint("j", "a", "b", '<dynamics damping="-1"/>', "continuous"), "value-invalid"),
    "friction": (joint("j", "a", "b", '<dynamics friction="-1"/>', "continuous"), "value-invalid"),
    "mimic": (joint("j", "a", "b", '<mimic joint="k"/>', "continuous"), "mimic-unknown"),
    "itself": (joint("j", "a", "b", '<mimic joint="j"/>', "continuous"), "mimic-unknown"),
    "nothing": (joint("j", "a", "b", '<mimic joint=""/>', "continuous"), "mimic-unknown"),
}


@pytest.mark.parametrize("case", LOADED)
def test_a_robot_is_loaded_without_what_gazebo_ignores_in_a_joint(case):
    text, code = LOADED[case]
    robot = load(urdf(link("a"), link("b"), text))
    (error,) = [each for each in robot.diagnostics if each.severity == "error"]
    assert named(error) == code
    assert str(error.origin) == "robot.urdf:4"
    (made,) = robot.joints
    assert (made.axis.lower, made.axis.upper) == (None, None)
    assert (made.axis.damping, made.axis.friction, made.mimic) == (0, 0, None)
    with cw.World("empty") as world:
        world.spawn(robot)
        world.run(0.1)


def test_of_a_ring_of_mimics_one_joint_moves_independently():
    names = {"j": "k", "k": "j", "l": "k"}
    text = urdf(
        *(link(each) for each in "abcd"),
        *(
            joint(name, "a", child, f'<mimic joint="{leader}"/>', "continuous")
            for (name, leader), child in zip(names.items(), "bcd", strict=True)
        ),
    )
    robot = load(text)
    (error,) = [each for each in robot.diagnostics if each.severity == "error"]
    assert error.values["joint"] == "j"
    leaders = {each.name: each.mimic and each.mimic.joint for each in robot.joints}
    assert leaders == {"j": None, "k": "j", "l": "k"}


@pytest.mark.parametrize("kind", ["fixed", "floating", "planar"])
def test_a_joint_that_mimics_one_without_a_position_moves_independently(kind):
    text = urdf(
        *(link(each) for each in "abcd"),
        joint("lead", "a", "b", kind=kind),
        joint("j", "a", "c", '<mimic joint="lead"/>', "continuous"),
        joint("k", "a", "d", '<mimic joint="j"/>', kind),
    )
    robot = load(text)
    errors = [each.values["joint"] for each in robot.diagnostics if each.severity == "error"]
    assert errors == (["j"] if kind == "fixed" else ["j", "k"])
    assert not any(each.mimic for each in robot.joints)
    with cw.World("empty") as world:
        world.spawn(robot)
        world.run(0.1)


def test_a_material_without_a_name_ends_the_shapes_of_its_link():
    """As in urdfdom, which skips the rest of the link."""
    box = '<geometry><box size="1 1 1"/></geometry>'
    seen = f'<visual name="{{}}">{box}{{}}</visual>'
    nameless = '<material><color rgba="1 0 0 1"/></material>'
    robot = load(
        urdf(
            '<link name="a">' + f"<collision>{box}</collision>",
            seen.format("first", '<material name="m"/>'),
            seen.format("second", nameless),
            seen.format("third", ""),
            BODY + "</link>",
            link("b", BODY + seen.format("other", "") + f"<collision>{box}</collision>"),
            joint("j", "a", "b"),
        )
    )
    assert [each.name for each in robot.link("a").visuals] == ["first"]
    assert not robot.link("a").collisions
    assert robot.link("a").inertial is not None
    assert len(robot.link("b").visuals) == len(robot.link("b").collisions) == 1
    (reported,) = [each for each in robot.diagnostics if named(each) == "element-left-out"]
    assert (reported.origin.line, reported.values["left_out"]) == (4, "collision")


def test_a_floating_joint_of_the_world_leaves_its_link_free():
    text = urdf(
        '<link name="world"/>',
        link("base", BODY + "<collision><geometry><sphere radius='0.1'/></geometry></collision>"),
        joint("free", "world", "base", '<origin xyz="0 0 2"/>', "floating"),
    )
    robot = load(text)
    assert not robot.joints
    assert robot.link("base").pose == Pose((0, 0, 2))
    with cw.World("empty") as world:
        model = world.spawn(robot)
        assert world.session.simulation.moves(model.name)
        world.run(2.0)
        assert model.pose.z == pytest.approx(-1.9, abs=0.01)


def test_a_mesh_with_a_scale_of_0_is_left_out():
    robot = load(
        urdf(
            OPEN_VISUAL, '<geometry><mesh filename="x.stl" scale="1 0 1"/></geometry>', CLOSE_VISUAL
        )
    )
    (error,) = [each for each in robot.diagnostics if each.severity == "error"]
    assert error.values["left_out"] == "visual"
    assert not robot.links[0].visuals


@pytest.mark.parametrize("mass", [1, 40])
def test_an_inertia_without_a_moment_above_zero_is_an_error(mass):
    with pytest.raises(DescriptionError) as caught:
        load(with_part('<inertia ixx="-1" iyy="-1" izz="-1" ixy="0" ixz="0" iyz="0"/>', mass=mass))
    assert named(caught.value) == "inertia-impossible"
    assert caught.value.origin.line == 3


def test_a_moment_below_zero_is_raised_with_the_others():
    made = (
        load(with_part('<inertia ixx="-0.1" iyy="1" izz="2" ixy="0" ixz="0" iyz="0"/>'))
        .link("a")
        .inertial
    )
    # The first counts as next to nothing; half of what is missing goes to each of the two.
    assert (made.ixx, made.iyy, made.izz) == pytest.approx((0.5, 1.5, 2.0), abs=1e-5)


def test_an_inertia_that_no_body_has_is_mended_on_a_main_part_too():
    """The largest moment stays, and the others are raised until they add up to it."""
    made = (
        load(with_part('<inertia ixx="0.5" iyy="1" izz="2" ixy="0" ixz="0" iyz="0"/>', mass=40))
        .link("a")
        .inertial
    )
    assert (made.ixx, made.iyy, made.izz) == pytest.approx((0.75, 1.25, 2.0))


WARNINGS = [
    (
        with_part('<inertia ixx="1" iyy="1" izz="3" ixy="0" ixz="0" iyz="0"/>'),
        "robot.urdf:3 warning inertia-impossible",
    ),
    (
        with_part(""),
        "robot.urdf:3 warning inertia-impossible",
    ),
    (
        with_part('<inertia ixx="1" iyy="1" izz="0" ixy="0" ixz="0" iyz="0"/>'),
        "robot.urdf:3 warning inertia-impossible",
    ),
    (
        urdf('<link name="a"><inertial><mass value="0"/></inertial></link>'),
        "robot.urdf:2 warning mass-not-positive",
    ),
    (
        urdf('<link name="a"><inertial><mass value="1e-109"/></inertial></link>'),
        "robot.urdf:2 warning mass-not-positive",
    ),
    (
        urdf(link("a"), '<link name="b"/>', joint("j", "a", "b", kind="continuous")),
        "robot.urdf:3 warning inertia-missing",
    ),
    (
        urdf('<link name="a"/>'),
        "robot.urdf:2 warning inertia-missing",
    ),
    (
        urdf(link("a"), link("b"), joint("j", "a", "b", kind="revolute")),
        "robot.urdf:4 warning limit-missing",
    ),
    (
        urdf(
            '<link name="a">' + BODY,
            '<visual><geometry><box size="0 1 1"/></geometry></visual></link>',
        ),
        "robot.urdf:3 warning value-ignored",
    ),
    (
        urdf(
            '<material name="grey"><color rgba="1 1 1 1"/></material>',
            '<link name="a">' + BODY,
            '<visual><geometry><box size="1 1 1"/></geometry>',
            '<material name="gray"/></visual></link>',
        ),
        "robot.urdf:5 warning material-undefined grey",
    ),
    (
        urdf(
            '<material name="g"><color rgba="1 1 1 1"/></material>',
            '<material name="g"><color rgba="0 0 0 1"/></material>',
            link("a"),
        ),
        "robot.urdf:3 error name-taken",
    ),
    (
        urdf(
            '<material name="g"><color rgba="1 1 1 1"/></material>',
            '<link name="a">' + BODY,
            '<visual><geometry><box size="1 1 1"/></geometry>',
            '<material name="g"><color rgba="0 0 0 1"/></material></visual></link>',
        ),
        "robot.urdf:5 warning material-differs",
    ),
    (
        urdf('<material name="g">', "<color/>", "</material>", link("a")),
        "robot.urdf:3 warning tag-missing",
    ),
    (
        urdf('<material name="g"><color rgba="255 0 0 1"/></material>', link("a")),
        "robot.urdf:2 warning value-ignored",
    ),
    (
        urdf('<material name="g">', '<color rgba="1 0 0"/></material>', link("a")),
        "robot.urdf:3 warning value-ignored",
    ),
    (
        urdf('<material name="g">', '<color rgba="1 0"/></material>', link("a")),
        "robot.urdf:3 warning value-ignored",
    ),
    (
        urdf('<material name="g"><texture filename="x.png"/></material>', link("a")),
        "robot.urdf:2 warning file-missing",
    ),
    (
        urdf(link("a"), "<jont/>"),
        "robot.urdf:3 warning tag-ignored joint",
    ),
    (
        urdf(link("a"), '<include filename="x"/>'),
        "robot.urdf:3 warning xacro-prefix xacro:include",
    ),
    (
        urdf('<link name="world">' + BODY + "</link>", link("a"), joint("j", "world", "a")),
        "robot.urdf:2 warning element-left-out",
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
    assert reported(robot)[0] == "robot.urdf:3 warning value-ignored"
    assert robot.diagnostics[0].values["stated"] == (1, -2, 3)


@pytest.mark.parametrize(("text", "warning"), WARNINGS)
def test_warnings(text, warning):
    assert warning in reported(load(text))


@pytest.mark.parametrize(
    ("kind", "uri", "expected"),
    [
        ("visual", "package://none/x.stl", ("file-missing", "package")),
        ("visual", "x.stl", ("file-missing", "mesh")),
        ("collision", "y.stl", ("file-missing", "mesh")),
        ("collision", "torn.stl", ("mesh-unreadable", "mesh")),
    ],
)
def test_a_mesh_that_cannot_be_had_costs_its_shape(kind, uri, expected, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("torn.stl").write_text("solid\nfacet")
    shape = f'<{kind}><geometry><mesh filename="{uri}"/></geometry></{kind}>'
    box = f'<{kind}><geometry><box size="1 1 1"/></geometry></{kind}>'
    robot = load(urdf('<link name="a">' + BODY, shape, box + "</link>"))
    left = robot.links[0].visuals if kind == "visual" else robot.links[0].collisions
    assert [part.shape for part in left] == [m.Box(size=(1, 1, 1))]
    (error,) = [each for each in robot.diagnostics if each.severity == "error"]
    assert str(error.origin) == "robot.urdf:3"
    assert (error.code.name, error.values["kind"]) == expected
    assert error.values["left_out"] == kind


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
    assert reported(robot) == ["robot.urdf:3 info inertia-impossible"]


def test_a_warning_is_reported_once_for_a_macro_called_twice():
    text = """<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:macro name="part" params="name"><link name="${name}"><oops/></link></xacro:macro>
<xacro:part name="a"/>
</robot>"""
    twice = text.replace(
        '<xacro:part name="a"/>',
        '<xacro:part name="a"/><xacro:part name="b"/>' + joint("j", "a", "b"),
    )
    assert sum(each.values.get("tag") == "oops" for each in load(twice).diagnostics) == 1


@pytest.mark.parametrize("content", ["", "<geometry/>"])
@pytest.mark.parametrize("kind", ["visual", "collision"])
def test_a_shape_without_geometry_is_left_out(kind, content):
    robot = load(urdf(link("a", f"{BODY}<{kind}>{content}</{kind}>")))
    (only,) = robot.links
    assert not only.visuals + only.collisions
    (said,) = robot.diagnostics
    assert said.code is tags.LINK_CUT_SHORT
    assert said.severity == ("error" if kind == "collision" else "warning")
    assert said.values["left_out"] == kind
    assert said.origin.line == 2


@pytest.mark.parametrize(
    ("shapes", "first"),
    [
        ('<sphere radius="0.1"/>\n<box size="1 1 1"/>', m.Sphere),
        ('<box size="1 1 1"/>\n<cylinder radius="0.1" length="-0.2"/>', m.Box),
        ('<box size="1 1 1"/>\n<box size="2 2 2"/>', m.Box),
    ],
)
def test_of_several_shapes_the_first_is_used(shapes, first):
    content = f"{BODY}<collision><geometry>{shapes}</geometry></collision>"
    robot = load_text(urdf(link("a", content)))
    (collision,) = robot.links[0].collisions
    assert isinstance(collision.shape, first)
    assert not isinstance(collision.shape, m.Box) or collision.shape.size == (1.0, 1.0, 1.0)
    (found,) = (each for each in robot.diagnostics if each.code is tags.TAG_REPEATED)
    assert found.origin.line == 3


@pytest.mark.parametrize("name", ["", " "])
def test_a_robot_with_an_empty_name_is_called_as_its_file(name, tmp_path):
    """ROS and Gazebo accept it."""
    path = tmp_path / "cart.urdf"
    path.write_text(f'<robot name="{name}"><link name="a"/></robot>')
    robot = load_robot(path)
    assert robot.name == "cart"
    assert any(each.values.get("missing") == "name" for each in robot.diagnostics)
