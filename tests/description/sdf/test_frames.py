"""Poses, frames and axes of SDF, against numbers worked out by hand."""

from __future__ import annotations

import math

import pytest
from tests.coded import named, raises

from cartwheel.codes import tags
from cartwheel.description.elements.xml import parse
from cartwheel.description.files.packages import Packages
from cartwheel.description.sdf import read_sdf
from cartwheel.errors import DescriptionError

QUARTER = math.pi / 2


def robot(inside: str, version: str = "1.7", attributes: str = ""):
    text = f'<sdf version="{version}">\n<model name="m" {attributes}>\n{inside}\n</model></sdf>'
    return read_sdf(parse(text, "m.sdf"), Packages(environment={}))


def close(pose, xyz, rpy=(0, 0, 0)):
    assert pose.position == pytest.approx(xyz, abs=1e-9)
    assert pose.rpy == pytest.approx(rpy, abs=1e-9)


def test_link_relative_to_link():
    found = robot(
        f"""<link name="a"><pose>1 2 0 0 0 {QUARTER}</pose></link>
        <link name="b"><pose relative_to="a">1 0 0.5 0 0 0</pose></link>"""
    )
    close(found.link("a").pose, (1, 2, 0), (0, 0, QUARTER))
    close(found.link("b").pose, (1, 3, 0.5), (0, 0, QUARTER))


@pytest.mark.parametrize("text", ["1 2 0", "1 2 0 0 0", "1 2 0 0 0 0 7"])
def test_a_pose_of_another_length_is_read_as_far_as_it_goes(text):
    found = robot(f'<link name="a"><pose>{text}</pose></link>')
    close(found.link("a").pose, (1, 2, 0))
    (reported,) = found.diagnostics
    assert (named(reported), reported.values["stated"]) == ("value-ignored", text)
    assert reported.origin.line == 3


def test_a_model_may_go_by_its_own_name():
    found = robot(
        """<link name="a"><pose>1 0 0 0 0 0</pose><collision name="c">
        <pose relative_to="m">3 0 0 0 0 0</pose><geometry><box/></geometry></collision></link>"""
    )
    close(found.link("a").collisions[0].pose, (2, 0, 0))


def test_the_older_frame_attribute_means_the_same_and_may_be_empty():
    found = robot(
        """<link name="a"><pose frame="">1 0 0 0 0 0</pose></link>
        <link name="b"><pose frame="a">1 0 0 0 0 0</pose></link>""",
        version="1.6",
    )
    close(found.link("b").pose, (2, 0, 0))


@pytest.mark.parametrize(
    ("version", "name"), [("1.5", "frame"), ("1.6", "frame"), ("1.7", "relative_to")]
)
def test_the_older_frame_attribute_is_read_in_all_elements(version, name):
    """sdformat converts it to relative_to."""
    text = f"""<sdf version="{version}"><world name="w">
        <model name="m"><pose {name}="world">1 0 0 0 0 0</pose>
          <link name="a"><pose>0 1 0 0 0 0</pose></link>
          <link name="b"><pose {name}="a">0 1 0 0 0 0</pose>
            <collision name="c"><pose {name}="a">0 0 1 0 0 0</pose><geometry><box/></geometry>
            </collision>
            <visual name="v"><pose {name}="j">0 0 1 0 0 0</pose><geometry><box/></geometry>
            </visual></link>
          <joint name="j" type="fixed"><pose {name}="a">0 0 2 0 0 0</pose><parent>a</parent>
            <child>b</child></joint></model>
        <model name="n"><pose {name}="m">0 0 3 0 0 0</pose><link name="x"/></model>
        <light name="l" type="point"><pose {name}="n">0 0 1 0 0 0</pose></light></world></sdf>"""
    world = read_sdf(parse(text, "w.sdf"), Packages(environment={}))
    m, n = world.models
    b = m.link("b")
    close(m.pose, (1, 0, 0))
    close(n.pose, (1, 0, 3))
    close(world.lights[0].pose, (1, 0, 4))
    close(b.pose, (0, 2, 0))
    close(b.collisions[0].pose, (0, -1, 1))
    close(b.visuals[0].pose, (0, -1, 3))
    close(m.joint("j").pose, (0, -1, 2))


@pytest.mark.parametrize("frame", ["a", "mark", "absent"])
@pytest.mark.parametrize(("version", "name"), [("1.6", "frame"), ("1.7", "relative_to")])
def test_the_frame_of_an_inertia_is_ignored_with_a_warning(version, name, frame):
    """As in libsdformat, even if the frame does not exist."""
    found = robot(
        f"""<link name="a"/><frame name="mark"><pose>5 0 0 0 0 0</pose></frame>
        <link name="b"><pose>0 2 0 0 0 0</pose>
          <inertial><pose {name}="{frame}">0 0 1 0 0 0</pose><mass>1</mass></inertial></link>""",
        version=version,
    )
    close(found.link("b").inertial.pose, (0, 0, 1))
    (warning,) = [each for each in found.diagnostics if each.code is tags.VALUE_IGNORED]
    assert warning.values["stated"] == frame


@pytest.mark.parametrize("frame", ["", "b"])
def test_the_frame_of_an_inertia_may_be_that_of_its_link(frame):
    found = robot(
        f"""<link name="b"><inertial><pose relative_to="{frame}">0 0 1 0 0 0</pose></inertial>
        </link>"""
    )
    close(found.link("b").inertial.pose, (0, 0, 1))
    assert not found.diagnostics


def test_frames_joints_and_model_as_references():
    found = robot(
        f"""<link name="base"><pose>0 0 1 0 0 0</pose></link>
        <frame name="mount" attached_to="base"><pose>0.5 0 0 0 0 {QUARTER}</pose></frame>
        <frame name="tip" attached_to="mount"><pose>1 0 0 0 0 0</pose></frame>
        <link name="arm"><pose relative_to="hinge"/></link>
        <joint name="hinge" type="revolute">
          <pose relative_to="tip">0 0 2 0 0 0</pose><parent>base</parent><child>arm</child>
          <axis><xyz>0 0 1</xyz></axis></joint>
        <link name="far"><pose relative_to="__model__">9 0 0 0 0 0</pose></link>"""
    )
    # mount at (0.5, 0, 1) looking along y; tip one further: (0.5, 1, 1); hinge two above.
    close(found.link("arm").pose, (0.5, 1, 3), (0, 0, QUARTER))
    close(found.joint("hinge").pose, (0, 0, 0))
    close(found.link("far").pose, (9, 0, 0))


def test_a_joint_s_pose_is_in_its_child_and_its_parent_may_be_a_frame():
    found = robot(
        f"""<link name="base"/><frame name="mount" attached_to="base"/>
        <link name="arm"><pose>1 0 0 0 0 {QUARTER}</pose></link>
        <joint name="hinge" type="revolute"><pose>0 0.25 0 0 0 0</pose>
          <parent>mount</parent><child>arm</child><axis><xyz>1 0 0</xyz></axis></joint>"""
    )
    joint = found.joint("hinge")
    close(joint.pose, (0, 0.25, 0))
    assert (joint.parent, joint.child) == ("base", "arm")
    assert joint.axis.xyz == (1, 0, 0)


def test_a_joint_whose_child_is_a_frame():
    found = robot(
        """<link name="base"/><link name="arm"><pose>5 0 0 0 0 0</pose></link>
        <frame name="grip" attached_to="arm"><pose>0 0 0.5 0 0 0</pose></frame>
        <joint name="hinge" type="fixed"><pose>0 1 0 0 0 0</pose>
          <parent>base</parent><child>grip</child></joint>"""
    )
    assert found.joint("hinge").child == "arm"
    # A frame's own pose counts from what it is attached to: (5, 0, 0.5) in the model.
    close(found.joint("hinge").pose, (0, 1, 0.5))


@pytest.mark.parametrize(
    ("version", "axis", "xyz"),
    [
        # The child looks along y: the model's x is its -y.
        ("1.4", "<xyz>1 0 0</xyz>", (0, -1, 0)),
        ("1.5", "<xyz>1 0 0</xyz>", (1, 0, 0)),
        ("1.6", "<xyz>1 0 0</xyz>", (1, 0, 0)),
        ("1.6", "<xyz>1 0 0</xyz><use_parent_model_frame>1</use_parent_model_frame>", (0, -1, 0)),
        ("1.7", '<xyz expressed_in="__model__">1 0 0</xyz>', (0, -1, 0)),
        ("1.7", '<xyz expressed_in="arm">1 0 0</xyz>', (1, 0, 0)),
        ("1.7", '<xyz expressed_in="base">0 0 3</xyz>', (0, 0, 1)),
    ],
)
def test_the_frame_of_an_axis(version, axis, xyz):
    found = robot(
        f"""<link name="base"/><link name="arm"><pose>0 0 0 0 0 {QUARTER}</pose></link>
        <joint name="hinge" type="revolute"><parent>base</parent><child>arm</child>
        <axis>{axis}</axis></joint>""",
        version=version,
    )
    assert found.joint("hinge").axis.xyz == pytest.approx(xyz, abs=1e-12)
    assert not [d for d in found.diagnostics if d.severity == "warning"]


def test_the_parent_models_frame_is_unknown_since_1_7():
    found = robot(
        f"""<link name="base"/><link name="arm"><pose>0 0 0 0 0 {QUARTER}</pose></link>
        <joint name="hinge" type="revolute"><parent>base</parent><child>arm</child>
        <axis><xyz>1 0 0</xyz><use_parent_model_frame>1</use_parent_model_frame></axis></joint>""",
        version="1.8",
    )
    # As in libsdformat, the axis remains in the joint's frame.
    assert found.joint("hinge").axis.xyz == (1, 0, 0)
    (ignored,) = (d for d in found.diagnostics if d.severity == "warning")
    assert (ignored.code, ignored.values["tag"]) == (tags.TAG_IGNORED, "use_parent_model_frame")


def test_parts_relative_to_other_frames():
    found = robot(
        f"""<link name="base"><pose>1 0 0 0 0 {QUARTER}</pose>
          <visual name="v"><pose relative_to="__model__">1 1 0 0 0 0</pose>
            <geometry><sphere><radius>1</radius></sphere></geometry></visual>
          <sensor name="s" type="imu"><pose relative_to="mount">0 0 1 0 0 0</pose></sensor>
          <inertial><pose>0 0 -0.1 0 0 0</pose></inertial></link>
        <frame name="mount"><pose>4 0 0 0 0 0</pose></frame>"""
    )
    link = found.link("base")
    # One metre along the model's y, seen from a link that looks along y, is one ahead.
    close(link.visuals[0].pose, (1, 0, 0), (0, 0, -QUARTER))
    close(link.sensors[0].pose, (0, -3, 1), (0, 0, -QUARTER))
    close(link.inertial.pose, (0, 0, -0.1))


def test_degrees_and_quaternions():
    found = robot(
        """<link name="a"><pose degrees="true">1 0 0 0 0 90</pose></link>
        <link name="b"><pose rotation_format="quat_xyzw">0 0 2 0 0 2 2</pose></link>""",
        version="1.9",
    )
    close(found.link("a").pose, (1, 0, 0), (0, 0, QUARTER))
    close(found.link("b").pose, (0, 0, 2), (0, 0, QUARTER))


NESTED = f"""<link name="base"/>
<model name="arm" {{extra}}><pose>0 0 1 0 0 {QUARTER}</pose>
  <link name="upper"><pose>1 0 0 0 0 0</pose><sensor name="s" type="imu"/></link>
  <link name="lower"><pose relative_to="upper">1 0 0 0 0 0</pose></link>
  <joint name="elbow" type="revolute"><parent>upper</parent><child>lower</child>
    <axis><xyz>0 0 1</xyz></axis></joint></model>
<link name="tool"><pose relative_to="arm::lower">0 0 0.5 0 0 0</pose></link>
<joint name="shoulder" type="fixed"><parent>base</parent><child>arm::upper</child></joint>
<joint name="wrist" type="fixed"><parent>arm::lower</parent><child>tool</child></joint>"""


def test_nested_models_keep_their_names_under_theirs():
    found = robot(NESTED.format(extra=""))
    assert [link.name for link in found.links] == ["base", "tool", "arm::upper", "arm::lower"]
    close(found.link("arm::upper").pose, (0, 1, 1), (0, 0, QUARTER))
    close(found.link("arm::lower").pose, (0, 2, 1), (0, 0, QUARTER))
    close(found.link("tool").pose, (0, 2, 1.5), (0, 0, QUARTER))
    elbow = found.joint("arm::elbow")
    assert (elbow.parent, elbow.child) == ("arm::upper", "arm::lower")
    assert found.joint("shoulder").child == "arm::upper"
    assert found.link("arm::upper").sensors[0].link == "arm::upper"


def test_placement_frame_puts_that_frame_where_the_pose_says():
    found = robot(NESTED.format(extra='placement_frame="lower"'))
    close(found.link("arm::lower").pose, (0, 0, 1), (0, 0, QUARTER))
    close(found.link("arm::upper").pose, (0, -1, 1), (0, 0, QUARTER))


def test_canonical_link():
    links = '<link name="a"/><link name="b"/>'
    assert robot(links).canonical_link == "a"
    assert robot(links, attributes='canonical_link="b"').canonical_link == "b"
    only = '<model name="inner"><link name="x"/></model>'
    assert robot(only).canonical_link == "inner::x"


@pytest.mark.parametrize(
    ("inside", "code"),
    [
        (
            """<link name="a"><pose relative_to="b"/></link>
            <link name="b"><pose relative_to="c"/></link>
            <link name="c"><pose relative_to="a"/></link>""",
            "frames-circular",
        ),
        (
            """<link name="a"/><frame name="f" attached_to="g"/>
            <frame name="g" attached_to="f"/>""",
            "frames-circular",
        ),
        (
            """<link name="chassis"/><link name="b">
            <pose relative_to="chasis"/></link>""",
            "name-unknown chassis",
        ),
        ('<link name="a"/><link name="a"/>', "name-taken"),
        ('<link name="__model__"/>', "name-taken"),
        ("", "model-empty"),
    ],
)
def test_wrong_frames(inside, code):
    with pytest.raises(DescriptionError) as caught:
        robot(inside)
    assert named(caught.value) == code


def test_canonical_link_that_is_missing():
    with raises(tags.NAME_UNKNOWN):
        robot('<link name="a"/>', attributes='canonical_link="b"')


def test_a_joint_may_be_called_as_a_link_in_older_files():
    inside = """<link name="a"/><link name="b"/><joint name="b" type="fixed">
      <pose>0 0 1 0 0 0</pose><parent>a</parent><child>b</child></joint>"""
    found = robot(inside, version="1.6")
    close(found.joint("b").pose, (0, 0, 1))
    assert found.diagnostics == ()
    assert named(robot(inside, version="1.7").diagnostics[0]) == "name-taken"


@pytest.mark.parametrize(
    ("attributes", "code"),
    [
        ('rotation_format="quat_xyz"', "type-unknown quat_xyzw"),
        ('rotation_format="quat_xyzw" degrees="true"', "value-invalid"),
    ],
)
def test_a_notation_that_is_none_is_refused(attributes, code):
    with pytest.raises(DescriptionError) as caught:
        robot(f'<link name="a"><pose {attributes}>1 0 0 0 0 0</pose></link>')
    assert named(caught.value) == code and caught.value.values["tag"] == "pose"


def test_a_sensor_with_an_unknown_frame_keeps_its_pose_as_in_gazebo():
    made = robot(
        "<link name='l'><sensor name='imu' type='imu'><pose relative_to='nowhere'>0 0 0.2 0 0 0"
        "</pose></sensor></link>",
        version="1.9",
    )
    (sensor,) = made.links[0].sensors
    close(sensor.pose, (0, 0, 0.2))
    (found,) = [each for each in made.diagnostics if each.code is tags.NAME_UNKNOWN]
    assert (found.severity, found.values["name"]) == ("warning", "nowhere")
