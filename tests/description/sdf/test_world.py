"""Worlds: physics, scene, lights, includes, saved states; damage and files that others wrote."""

from __future__ import annotations

import math
import os
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.coded import named, raises

from cartwheel.codes import files, tags
from cartwheel.description import load_world
from cartwheel.description import model as m
from cartwheel.description.elements.xml import parse, read_file
from cartwheel.description.files.packages import Packages
from cartwheel.description.sdf import read_sdf
from cartwheel.errors import CartwheelError, DescriptionError
from cartwheel.geometry import Pose

QUARTER = math.pi / 2
ROOT = Path(__file__).parents[3]
CORPUS = Path(os.environ.get("CARTWHEEL_CORPUS", ROOT.parent / "shared" / "corpus"))


def world(inside: str, version: str = "1.6", folder: Path | None = None):
    text = f'<sdf version="{version}">\n<world name="w">\n{inside}\n</world></sdf>'
    file = folder / "w.world" if folder else None
    return read_sdf(parse(text, str(file or "w.world")), Packages(file, environment={}))


def box(name: str, inside: str = "") -> str:
    return f'<model name="{name}">{inside}<link name="link"/></model>'


def save_model(folder: Path, name: str, inside: str, version: str = "1.5", file: str = "model.sdf"):
    place = folder / "models" / name
    place.mkdir(parents=True, exist_ok=True)
    (place / "model.config").write_text(
        f'<model><name>{name}</name><sdf version="{version}">{file}</sdf></model>'
    )
    (place / file).write_text(f'<sdf version="{version}">{inside}</sdf>')


def test_defaults_are_gazebo_s():
    empty = world("")
    assert empty.name == "w"
    assert empty.gravity == (0, 0, -9.8)
    assert empty.physics == m.Physics()
    assert empty.shadows
    assert empty.models == ()


def test_physics_scene_and_the_rest():
    found = world(
        """<gravity>0 0 -1.62</gravity><magnetic_field>1e-5 2e-5 3e-5</magnetic_field>
        <physics type="ode" name="slow"><max_step_size>0.01</max_step_size></physics>
        <physics type="ode" name="fast" default="true"><max_step_size>0.002</max_step_size>
          <real_time_factor>1.5</real_time_factor>
          <real_time_update_rate>500</real_time_update_rate>
          <ode><solver><iters>50</iters></solver></ode></physics>
        <scene><ambient>0.1 0.2 0.3 1</ambient><background>0 0 1</background>
          <shadows>false</shadows><sky><clouds/></sky></scene>
        <wind/><atmosphere type="adiabatic"/><gui><camera/></gui>
        <spherical_coordinates><latitude_deg>48</latitude_deg></spherical_coordinates>
        <plugin name="p" filename="libgazebo_ros_state.so"><rate>1</rate></plugin>"""
    )
    assert found.gravity == (0, 0, -1.62)
    assert found.magnetic_field == (1e-5, 2e-5, 3e-5)
    assert found.physics == m.Physics(
        max_step_size=0.002, real_time_factor=1.5, real_time_update_rate=500
    )
    assert found.ambient == (0.1, 0.2, 0.3, 1)
    assert found.background == (0, 0, 1, 1)
    assert not found.shadows
    assert found.spherical_coordinates.find("latitude_deg").text == "48"
    assert found.plugins[0].filename == "libgazebo_ros_state.so"
    reported = sorted((named(d), d.values["tag"]) for d in found.diagnostics)
    assert reported == [("tag-ignored", "ode"), ("tag-ignored", "sky"), ("tag-repeated", "physics")]
    assert {d.severity for d in found.diagnostics} == {"info"}


def test_gravity_stood_in_the_physics_before():
    found = world("<physics type='ode'><gravity>0 0 -3</gravity></physics>", "1.4")
    assert found.gravity == (0, 0, -3)
    oldest = """<physics type='ode'><ode><solver><type>quick</type><dt>0.005</dt></solver>
      <constraints/></ode></physics>"""
    found = world(oldest, "1.3")
    assert found.physics.max_step_size == 0.005
    (reported,) = found.diagnostics
    assert (reported.severity, reported.origin.line) == ("info", 3)
    assert (named(reported), reported.values["tag"]) == ("tag-ignored", "ode")


def test_lights():
    found = world(
        """<light name="lamp" type="spot"><pose>0 0 3 0 0 0</pose><diffuse>1 1 0.5</diffuse>
        <specular>0.1 0.1 0.1 1</specular><direction>0 0 -1</direction>
        <attenuation><range>20</range><constant>0.5</constant><linear>0.01</linear>
          <quadratic>0.001</quadratic></attenuation>
        <spot><inner_angle>0.1</inner_angle><outer_angle>0.5</outer_angle><falloff>2</falloff></spot>
        <cast_shadows>1</cast_shadows></light>"""
    )
    (lamp,) = found.lights
    assert lamp == m.Light(
        name="lamp", type="spot", pose=lamp.pose, diffuse=(1, 1, 0.5, 1),
        specular=(0.1, 0.1, 0.1, 1), direction=(0, 0, -1), range=20,
        attenuation=(0.5, 0.01, 0.001), spot_angle=0.5, spot_inner=0.1, spot_falloff=2,
        cast_shadows=True, origin=lamp.origin,
    )  # fmt: skip
    assert lamp.pose.position == (0, 0, 3)
    with raises(tags.TYPE_UNKNOWN):
        world('<light name="a" type="sun"/>')


def test_the_shipped_sun_and_ground_plane_are_found():
    found = world(
        "<include><uri>model://sun</uri></include>"
        "<include><uri>model://ground_plane</uri></include>"
    )
    assert found.lights[0].type == "directional"
    assert found.models[0].static
    assert isinstance(found.models[0].links[0].collisions[0].shape, m.Plane)
    assert found.diagnostics == ()
    fuel = "https://fuel.gazebosim.org/1.0/OpenRobotics/models/Ground Plane"
    assert world(f"<include><uri>{fuel}</uri></include>").models[0].name == "ground_plane"


def test_include_changes_name_pose_and_static(tmp_path):
    save_model(tmp_path, "post", box("post", "<pose>9 9 9 0 0 0</pose>"))
    plain, changed = world(
        """<include><uri>model://post</uri></include>
        <include><uri>model://post</uri><name>second</name><static>true</static>
          <pose>1 2 3 0 0 0</pose><plugin name="p" filename="lib.so"/></include>""",
        folder=tmp_path,
    ).models
    assert (plain.name, plain.static, plain.pose.position) == ("post", False, (9, 9, 9))
    assert (changed.name, changed.static, changed.pose.position) == ("second", True, (1, 2, 3))
    assert changed.plugins[0].filename == "lib.so"


def test_an_included_file_has_its_own_version_and_relative_files(tmp_path):
    inside = f"""<model name="arm"><link name="a"/>
      <link name="b"><pose>0 0 0 0 0 {QUARTER}</pose>
      <visual name="v"><geometry><mesh><uri>meshes/b.obj</uri></mesh></geometry></visual></link>
      <joint name="j" type="revolute"><parent>a</parent><child>b</child>
      <axis><xyz>1 0 0</xyz></axis></joint></model>"""
    save_model(tmp_path, "arm", inside, version="1.4", file="old.sdf")
    mesh = tmp_path / "models" / "arm" / "meshes" / "b.obj"
    mesh.parent.mkdir()
    mesh.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    (found,) = world("<include><uri>model://arm</uri></include>", "1.9", tmp_path).models
    assert found.joint("j").axis.xyz == pytest.approx((0, -1, 0))
    assert found.link("b").visuals[0].shape.path == mesh
    assert found.origin.file.endswith("w.world")


HEAVY = """<inertial><mass value="2"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>"""
URDF = f"""<robot name="post"><link name="foot">{HEAVY}</link><link name="head">{HEAVY}</link>
  <joint name="neck" type="revolute"><parent link="foot"/><child link="head"/>
    <origin xyz="0 0 1"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="9" velocity="9"/>
  </joint>
  <ros2_control name="h" type="system"><joint name="neck"/></ros2_control>
  <gazebo><plugin name="p" filename="lib.so"><file>{{}}</file></plugin></gazebo></robot>"""


def test_a_urdf_is_included_as_gazebo_converts_it(tmp_path):
    place = tmp_path / "models" / "post"
    place.mkdir(parents=True)
    (place / "model.config").write_text("<model><name>post</name><sdf>post.urdf</sdf></model>")
    (place / "post.urdf").write_text(URDF.format("$(eval 1 + 1) of $(find post)"))
    (place / "package.xml").write_text("<package><name>post</name></package>")
    found = world(
        """<include><uri>model://post</uri><name>mine</name><pose>1 2 3 0 0 0</pose></include>
        <model name="cart"><link name="bed"/>
          <include><uri>model://post</uri><pose>0 0 5 0 0 0</pose></include>
          <joint name="bolt" type="fixed"><parent>bed</parent><child>post::foot</child></joint>
        </model>""",
        folder=tmp_path,
    )
    mine, cart = found.models
    assert (mine.name, mine.pose.position, mine.canonical_link) == ("mine", (1, 2, 3), "foot")
    assert mine.link("head").pose.position == (0, 0, 1)
    assert mine.joint("neck").axis.upper == 1
    assert mine.plugins[0].element.find("file").text == f"2 of {place}"
    assert [each.attribute("name") for each in mine.ros2_control] == ["h"]
    assert '<robot name="post">' in mine.text
    assert cart.link("post::head").pose.position == (0, 0, 6)
    assert cart.joint("post::neck").child == "post::head"
    assert found.diagnostics == ()


def test_a_model_includes_and_merges_others(tmp_path):
    save_model(
        tmp_path,
        "wheel",
        """<model name="wheel"><link name="rim"><pose>0 0 1 0 0 0</pose></link>
        <link name="tyre"/><joint name="j" type="fixed"><parent>rim</parent><child>tyre</child>
        </joint></model>""",
    )
    inside = """<model name="cart"><link name="base"/>
      <include {}><uri>model://wheel</uri><name>left</name><pose>0 1 0 0 0 0</pose></include>
      <joint name="axle" type="fixed"><parent>base</parent><child>{}rim</child></joint></model>"""
    (nested,) = world(inside.format("", "left::"), "1.9", tmp_path).models
    assert [each.name for each in nested.links] == ["base", "left::rim", "left::tyre"]
    assert nested.link("left::rim").pose.position == (0, 1, 1)
    (merged,) = world(inside.format('merge="true"', ""), "1.9", tmp_path).models
    assert [each.name for each in merged.links] == ["base", "rim", "tyre"]
    assert merged.link("rim").pose.position == (0, 1, 1)
    assert merged.joint("j").child == "tyre"


def test_models_relative_to_models_and_frames():
    found = world(
        f"""{box("table", f"<pose>1 0 0 0 0 {QUARTER}</pose>")}
        <frame name="corner" attached_to="table::link"><pose>0.5 0 0 0 0 0</pose></frame>
        {box("cup", '<pose relative_to="corner">0 0 1 0 0 0</pose>')}""",
        "1.8",
    )
    assert found.models[1].pose.position == pytest.approx((1, 0.5, 1))


def test_saved_state_moves_models_lights_and_lone_links():
    found = world(
        f"""{box("a", "<pose>1 1 1 0 0 0</pose>")}{box("b")}{box("gone")}
        <light name="sun" type="directional"/>
        <state world_name="w"><sim_time>1 0</sim_time>
          <model name="a"><pose>2 0 0 0 0 {QUARTER}</pose><scale>1 1 1</scale>
            <link name="link"><pose>2 0 0.5 0 0 {QUARTER}</pose><velocity>0 0 0 0 0 0</velocity>
            </link></model>
          <model name="stranger"><pose>0 0 0 0 0 0</pose></model>
          <light name="sun"><pose>0 0 20 0 0 0</pose></light>
          <deletions><name>gone</name></deletions></state>"""
    )
    assert [each.name for each in found.models] == ["a", "b"]
    assert found.models[0].pose.position == (2, 0, 0)
    assert found.models[0].links[0].pose.position == pytest.approx((0, 0, 0.5))
    assert found.lights[0].pose.position == (0, 0, 20)
    assert {d.severity for d in found.diagnostics} == {"info"}
    stranger, time = found.diagnostics
    assert (named(stranger), stranger.values["name"]) == ("not-simulated", "stranger")
    assert (named(time), time.values["tag"]) == ("tag-ignored", "sim_time")


ARM = """<model name="arm"><link name="base"/>
  <link name="upper"><pose>0 0 1 0 0 0</pose></link>
  <link name="slider"><pose>0 0 2 0 0 0</pose></link>
  <joint name="anchor" type="fixed"><parent>world</parent><child>base</child></joint>
  <joint name="turn" type="revolute"><parent>base</parent><child>upper</child>
    <pose>0 0 -0.5 0 0 0.3</pose><axis><xyz>0 1 0</xyz></axis></joint>
  <joint name="reach" type="prismatic"><parent>upper</parent><child>slider</child>
    <axis><xyz>0 0 1</xyz></axis></joint>{}</model>"""


def saved(turn, reach, extra="", links=""):
    """The arm as Gazebo saves it: each link's pose in the world, by its joints from the base on."""
    base = Pose.from_xyz_rpy((2, 1, 0), (0, 0, 0.5))
    hinge = Pose.from_xyz_rpy((0, 0, 0.5), (0, 0, 0.3))
    upper = base @ hinge @ Pose.from_xyz_rpy((0, 0, 0), (0, turn, 0)) @ hinge.inverse()
    upper = upper @ Pose((0, 0, 1))
    slider = upper @ Pose((0, 0, 1 + reach))

    def written(pose):
        return " ".join(f"{value:.6f}" for value in (*pose.position, *pose.rpy))

    poses = "".join(
        f'<link name="{name}"><pose>{written(pose)}</pose></link>'
        for name, pose in (("base", base), ("upper", upper), ("slider", slider))
    )
    return f"""{ARM.format(extra)}<state world_name="w"><model name="arm">
      <pose>{written(base)}</pose>{poses}{links}</model></state>"""


def test_a_saved_state_states_where_joints_are():
    found = world(saved(0.7, -0.2))
    assert dict(found.models[0].joint_positions) == pytest.approx(
        {"turn": 0.7, "reach": -0.2}, abs=1e-4
    )
    assert found.diagnostics == ()


def test_a_joint_of_several_degrees_of_freedom_is_reported():
    ball = """<link name="ball"/><joint name="socket" type="ball"><parent>base</parent>
      <child>ball</child></joint>"""
    turned = '<link name="ball"><pose>2 1 0 0.2 0.3 0</pose></link>'
    found = world(saved(0, 0, ball, turned))
    assert found.models[0].joint_positions == ()
    (reported,) = found.diagnostics
    assert reported.severity == "warning"
    assert named(reported) == "not-simulated"


@pytest.mark.parametrize(
    ("inside", "code"),
    [
        (
            box("a", '<pose relative_to="b"/>') + box("b", '<pose relative_to="a"/>'),
            "frames-circular",
        ),
        ("<physics><max_step_size>0</max_step_size></physics>", "value-invalid"),
        ("<gravity>0 -9.8</gravity>", "value-invalid"),
    ],
)
def test_errors(inside, code):
    with pytest.raises(DescriptionError) as caught:
        world(inside)
    assert named(caught.value) == code
    assert caught.value.origin.line >= 2


@pytest.mark.parametrize(
    ("uri", "code"),
    [
        ("model://nothing_there", "file-missing"),
        ("https://a.b/1.0/c/models/Dragon", "file-on-network"),
        ("model://walker", "not-simulated"),
    ],
)
def test_a_missing_model_costs_the_one_model(uri, code, tmp_path):
    save_model(tmp_path, "walker", '<actor name="walker"/>')
    found = world(f"<include><uri>{uri}</uri></include>" + box("a"), folder=tmp_path)
    assert [model.name for model in found.models] == ["a"]
    (reported,) = found.diagnostics
    assert reported.severity == "error"
    assert (named(reported), reported.values["left_out"]) == (code, "include")
    assert reported.origin.line >= 2


@pytest.mark.parametrize(
    ("include", "code"),
    [
        ("<include/>", "tag-missing"),
        ("<include><uri/></include>", "tag-missing"),
        ("<include><uri>package://no_such/m</uri></include>", "file-missing"),
        ("<include><uri>file://$(find no_such)/m</uri></include>", "file-missing"),
    ],
)
def test_an_include_that_names_nothing_costs_itself_alone(include, code, tmp_path):
    file = tmp_path / "w.world"
    file.write_text(f'<sdf version="1.6"><world name="w">\n{include}{box("a")}</world></sdf>')
    found = load_world(file)
    assert [model.name for model in found.models] == ["a"]
    (reported,) = found.diagnostics
    assert reported.severity == "error"
    assert (named(reported), reported.values["left_out"]) == (code, "include")
    assert (reported.origin.file, reported.origin.line) == (str(file), 2)


def test_a_package_of_a_plain_world_is_found(tmp_path):
    package = tmp_path / "src" / "props"
    package.mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>props</name></package>")
    save_model(package, "crate", box("crate"))
    file = tmp_path / "src" / "w.world"
    uri = "file://$(find props)/models/crate"
    file.write_text(
        f'<sdf version="1.6"><world name="w"><include><uri>{uri}</uri></include></world></sdf>'
    )
    found = load_world(file)
    assert [model.name for model in found.models] == ["crate"]
    assert found.diagnostics == ()


JOINED = """<model name="a"><pose>0 0 2 0 0 0</pose><link name="l"/></model>
  <model name="b"><pose>1 0 2 0 0 0</pose><link name="k"/><link name="l"/></model>
  <model name="wall"><static>true</static><link name="l"/></model>
  <joint name="j" type="{type}"><parent>{parent}</parent><child>{child}</child>
    <pose>0 0 0.5 0 0 0</pose><axis><xyz>0 1 0</xyz></axis></joint>"""


@pytest.mark.parametrize(
    ("parent", "child"), [("world", "b"), ("world", "b::k"), ("wall", "b::k"), ("wall::l", "b")]
)
def test_a_joint_of_the_world_holds_a_model(parent, child):
    found = world(JOINED.format(type="revolute", parent=parent, child=child), "1.10")
    assert found.joints == ()
    assert found.diagnostics == ()
    (joint,) = found.models[1].joints
    assert (joint.parent, joint.child, joint.type) == ("world", "k", "revolute")
    assert joint.pose.position == (0, 0, 0.5)


def test_a_joint_of_the_world_that_names_a_static_child_holds_the_parent():
    found = world(JOINED.format(type="fixed", parent="a", child="wall"), "1.10")
    (joint,) = found.models[0].joints
    assert (joint.parent, joint.child) == ("world", "l")


def test_a_joint_between_models():
    found = world(JOINED.format(type="revolute", parent="a", child="b::l"), "1.10")
    (joint,) = found.joints
    assert (joint.parent, joint.child) == ("a::l", "b::l")
    assert found.diagnostics == ()


def test_a_joint_of_the_world_that_cannot_act_is_reported():
    (reported,) = world(JOINED.format(type="prismatic", parent="a", child="b"), "1.10").diagnostics
    assert (reported.severity, reported.origin.line) == ("error", 6)
    assert (named(reported), reported.values["name"]) == ("element-left-out", "j")
    damped = JOINED.format(type="revolute", parent="a", child="b").replace(
        "<xyz>", "<dynamics><damping>1</damping></dynamics><xyz>"
    )
    (reported,) = world(damped, "1.10").diagnostics
    assert reported.severity == "warning"
    assert (named(reported), reported.values["joint"]) == ("not-simulated", "j")
    with pytest.raises(DescriptionError) as caught:
        world(JOINED.format(type="fixed", parent="a", child="c"), "1.10")
    assert named(caught.value) == "joint-link-unknown"
    gone = "<include><uri>model://c</uri></include>"
    _, reported = world(
        gone + JOINED.format(type="fixed", parent="a", child="c"), "1.10"
    ).diagnostics
    assert reported.values["left_out"] == "joint"


def test_a_saved_state_reaches_nested_models_and_states_motion():
    found = world(
        """<model name="m"><link name="a"/><model name="in"><link name="i"/></model></model>
        <state world_name="w"><model name="m"><pose>0 2 0 0 0 0</pose>
          <link name="a"><velocity>0 0 0.5 0 0 0</velocity></link>
          <model name="in"><link name="i"><pose>0 2 9 0 0 0</pose></link></model></model></state>"""
    )
    assert found.models[0].link("in::i").pose.position == (0, 0, 9)
    (reported,) = found.diagnostics
    assert (named(reported), reported.values["tag"]) == ("not-simulated", "velocity")
    assert reported.origin.line == 5


@pytest.mark.parametrize("tag", ["actor", "population", "road"])
def test_what_is_not_simulated_is_reported_by_name(tag):
    found = world(f'<{tag} name="it"><pose>0 0 0 0 0 0</pose></{tag}>' + box("a"))
    assert [model.name for model in found.models] == ["a"]
    (reported,) = found.diagnostics
    assert reported.severity == "warning"
    assert (named(reported), reported.values["tag"]) == ("not-simulated", tag)


def test_a_model_that_needs_a_missing_part_is_left_out():
    found = world(
        box("a")
        + """<model name="cart"><link name="base"><pose relative_to="n::b">0 0 1 0 0 0</pose></link>
        <include><uri>nothing_there</uri><name>n</name></include></model><model name="shelf">
        <include><uri>nothing_there</uri>
        </include></model><model name="on"><pose relative_to="shelf"/><link name="x"/></model>""",
        "1.9",
    )
    assert [model.name for model in found.models] == ["a"]
    assert {each.severity for each in found.diagnostics} == {"error"}
    reported = [(each.values["name"], each.values["left_out"]) for each in found.diagnostics]
    missing = ("nothing_there", "include")
    assert reported == [missing, ("n::b", "model"), missing, ("shelf", "model")]


def test_a_static_model_stays_static_in_another(tmp_path):
    save_model(tmp_path, "wall", '<model name="wall"><static>1</static><link name="l"/></model>')
    include = "<include><uri>model://wall</uri></include>"
    alone, mixed = world(
        f'<model name="a">{include}</model><model name="b">{include}<link name="ball"/></model>',
        "1.9",
        tmp_path,
    ).models
    assert alone.static
    assert alone.joints == ()
    assert not mixed.static
    ((parent, child),) = [(joint.parent, joint.child) for joint in mixed.joints]
    assert (parent, child) == ("world", "wall::l")


def test_a_model_without_links_is_left_out():
    found = world(box("a") + '<model name="empty"/>')
    assert [model.name for model in found.models] == ["a"]
    (reported,) = found.diagnostics
    assert reported.severity == "warning"
    assert (named(reported), reported.values["left_out"]) == ("model-empty", "model")


def test_only_the_first_world_is_run():
    found = world(box("a") + "</world><world name='b'><x/>")
    assert found.name == "w"
    (reported,) = found.diagnostics
    assert (named(reported), reported.values["name"]) == ("element-left-out", "b")


@pytest.mark.parametrize("uri", ["tree", "file://tree", "model://tree"])
def test_a_bare_name_is_that_of_a_model(uri, tmp_path):
    save_model(tmp_path, "tree", box("tree"))
    (found,) = world(f"<include><uri>{uri}</uri></include>", folder=tmp_path).models
    assert found.name == "tree"


def test_a_damaged_model_config_is_done_without(tmp_path):
    save_model(tmp_path, "door", box("door"))
    (tmp_path / "models/door/model.config").write_text("<model>door & frame</model>")
    found = world("<include><uri>model://door</uri></include>", folder=tmp_path)
    assert [model.name for model in found.models] == ["door"]
    (reported,) = found.diagnostics
    assert reported.severity == "info"
    assert named(reported) == "xml-malformed"


def test_the_default_plugin_is_none():
    plugin = '<plugin name="__default__" filename="__default__"/>'
    found = world(plugin + box("a", plugin))
    assert found.plugins == found.models[0].plugins == found.diagnostics == ()


def test_a_model_that_includes_itself(tmp_path):
    include = "<include><uri>model://{}</uri></include>"
    save_model(tmp_path, "a", f'<model name="a">{include.format("b")}</model>')
    save_model(tmp_path, "b", f'<model name="b">{include.format("a")}</model>')
    with pytest.raises(DescriptionError) as caught:
        world(include.format("a"), folder=tmp_path)
    assert named(caught.value) == "include-recursive"


SAMPLE = (
    '<sdf version="1.6"><world name="w"><gravity>0 0 -9.8</gravity>'
    '<light name="l" type="point"><pose>0 0 1 0 0 0</pose></light><model name="m">'
    '<pose>1 2 3 0 0 0</pose><link name="a"><inertial><mass>1</mass></inertial>'
    '<visual name="v"><geometry><box><size>1 1 1</size></box></geometry></visual>'
    '<sensor name="s" type="camera"><camera><image><width>9</width></image></camera></sensor>'
    '</link><link name="b"><pose frame="a">0 0 1 0 0 0</pose></link><joint name="j" '
    'type="revolute"><parent>a</parent><child>b</child><axis><xyz>0 0 1</xyz></axis></joint>'
    '<plugin name="p" filename="f.so"><x>1</x></plugin></model></world></sdf>'
)
WORDS = ["", "nan", "1e999", "-1", "a", "b", "world", "<pose/>", "</link>", "__model__", "::", "0"]


def test_the_sample_is_whole():
    assert read_sdf(parse(SAMPLE, "s.sdf"), Packages(environment={})).diagnostics == ()


@settings(max_examples=300)
@given(
    st.lists(
        st.tuples(
            st.integers(0, len(SAMPLE)), st.integers(0, 30), st.sampled_from(WORDS) | st.text()
        ),
        max_size=3,
    )
)
def test_damage_ends_in_a_description_or_its_error(cuts):
    text = SAMPLE
    for start, length, put in cuts:
        text = text[:start] + put + text[start + length :]
    try:
        found = read_sdf(parse(text, "s.sdf"), Packages(environment={}))
    except DescriptionError as error:
        assert error.origin is not None
        return
    assert isinstance(found, m.WorldDescription | m.RobotDescription)


def corpus_files() -> list[Path]:
    return sorted([*CORPUS.rglob("*.world"), *CORPUS.rglob("*.sdf")]) if CORPUS.is_dir() else []


LACKS = (files.FILE_MISSING, files.SDF_VERSION, files.NOT_A_DESCRIPTION)


@pytest.mark.skipif(not corpus_files(), reason=f"no corpus of others' robots in {CORPUS}")
def test_worlds_of_others_load_or_lack_something():
    loaded = 0
    for file in corpus_files():
        try:
            found = read_sdf(read_file(file), Packages(file))
        except CartwheelError as error:
            assert error.code in LACKS, f"{file}: {error}"
            assert error.origin is not None
            continue
        loaded += 1
        for reported in found.diagnostics:
            assert reported.origin is not None
            if reported.severity == "error":
                assert reported.code is files.FILE_MISSING
    assert loaded >= 20


def test_of_models_of_one_name_the_first_keeps_it():
    names = ("a", "b", "a", "a_1", "a", "b")
    found = world("".join(map(box, names)))
    assert [each.name for each in found.models] == ["a", "b", "a_2", "a_1", "a_3", "b_1"]
    reported = [each.values["renamed"] for each in found.diagnostics if named(each) == "name-taken"]
    assert reported == ["a_2", "a_3", "b_1"]


def test_a_model_folder_whose_file_is_yet_to_be_made_costs_itself(tmp_path, monkeypatch):
    """rotors' iris has its file made by a build."""
    folder = tmp_path / "models" / "iris"
    folder.mkdir(parents=True)
    (folder / "model.config").write_text(
        '<model><name>i</name><sdf version="1.4">iris.sdf</sdf></model>'
    )
    found = world("<include><uri>model://iris</uri></include>" + box("a"), folder=tmp_path)
    assert [each.name for each in found.models] == ["a"]
    (reported,) = found.diagnostics
    assert reported.severity == "error"
    assert (named(reported), reported.values["left_out"]) == ("file-missing", "include")
