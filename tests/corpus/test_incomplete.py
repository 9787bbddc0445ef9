"""Robots without a mass, or without a part that is not there."""

import pytest
from tests.corpus.carts import cart, plugin, written

from cartwheel.codes.files import (
    FILE_ELSEWHERE,
    FILE_MISSING,
    INCLUDE_ABSENT,
    MACRO_ABSENT,
    XACRO_NAME_UNKNOWN,
)
from cartwheel.codes.robot import (
    BASE_WITHOUT_COLLISION,
    INERTIA_MISSING,
    JOINTS_UNDRIVEN,
    UNBALANCED,
)
from cartwheel.corpus import try_robot

MASS = (
    '<inertial><mass value="2"/>'
    '<inertia ixx="0.02" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial>'
)
COLLISION = '<collision><geometry><box size="0.3 0.15 0.06"/></geometry></collision>'
XACRO = '<robot name="robot" xmlns:xacro="http://www.ros.org/wiki/xacro">'
INCLUDE = '<xacro:include filename="$(find no_such_package)/urdf/arm.xacro"/>'
JOINT = (
    '<joint name="j" type="fixed"><parent link="base"/><child link="foot"/></joint><xacro:foot/>'
)
FOR_GAZEBO = '<gazebo><plugin name="view" filename="libDrawForcePlugin.so"/></gazebo>'
"""A plugin without effect, for which the robot is one for Gazebo and must stand."""
CALL = '<xacro:no_such_arm parent="base"/>'


def expanded(folder, *parts):
    path = folder / "robot.urdf.xacro"
    path.write_text(f"{XACRO}{''.join(parts)}</robot>")
    return path


def test_gazebo_does_not_load_a_robot_whose_root_has_no_mass(tmp_path):
    massless = cart().replace(MASS, "", 1)
    assert massless != cart()
    verdict = try_robot(written(tmp_path, massless, plugin()), standing=1.0)
    assert verdict.loaded
    assert [(each.test, each.code) for each in verdict.faults] == [("load", INERTIA_MISSING)]
    assert verdict.outcome == "file"
    assert try_robot(written(tmp_path, cart(), plugin()), standing=1.0).good


def test_links_need_no_mass_in_a_description_that_nothing_starts_in_gazebo(tmp_path):
    massless = cart().replace(MASS, "", 1)
    assert try_robot(written(tmp_path, massless), standing=1.0).good
    (tmp_path / "package.xml").write_text("<package><name>robot</name></package>")
    launch = tmp_path / "show.launch"
    shown = (
        '<launch><param name="robot_description" textfile="$(find robot)/robot.urdf"/>{}</launch>'
    )
    spawner = '<node name="s" pkg="gazebo_ros" type="spawn_model" args="-param robot_description"/>'
    for node, good in (("", True), (spawner, False)):
        launch.write_text(shown.format(node))
        assert try_robot(written(tmp_path, massless), standing=1.0).good == good


def test_a_mass_may_be_in_a_part_that_is_missing(tmp_path):
    massless = cart().replace(MASS, "", 1)
    verdict = try_robot(expanded(tmp_path, INCLUDE, massless, plugin()), standing=1.0)
    assert INERTIA_MISSING not in {each.code for each in verdict.faults}


@pytest.mark.parametrize(
    ("parts", "reason"),
    [([], BASE_WITHOUT_COLLISION), ([INCLUDE, CALL], INCLUDE_ABSENT)],
)
def test_a_robot_may_fall_because_a_part_is_missing_that_has_its_collisions(
    tmp_path, parts, reason
):
    body = f'<link name="base">{MASS}</link>'
    verdict = try_robot(expanded(tmp_path, *parts, body, FOR_GAZEBO), standing=1.0)
    (fault,) = verdict.faults
    assert (fault.test, fault.code, fault.source) == ("stand", reason, "file")


@pytest.mark.parametrize(
    ("include", "call", "reason"),
    [
        ("", "", UNBALANCED),
        ("feet", '<xacro:foot x="-0.2"/>', INCLUDE_ABSENT),
        ("back", "", INCLUDE_ABSENT),
        ("feet", JOINT, INCLUDE_ABSENT),
        # A sensor carries no robot.
        ("depth_camera", '<xacro:depth_camera parent="base"/>', UNBALANCED),
    ],
)
def test_a_robot_may_tip_over_because_what_supports_it_is_missing(tmp_path, include, call, reason):
    foot = COLLISION.replace("<collision>", '<collision><origin xyz="0.2 0 0"/>')
    parts = [INCLUDE.replace("arm.xacro", f"{include}.xacro")] if include else []
    verdict = try_robot(
        expanded(tmp_path, *parts, f'<link name="base">{MASS}{foot}</link>', call, FOR_GAZEBO),
        standing=1.0,
    )
    (fault,) = verdict.faults
    assert (fault.test, fault.code, fault.source) == ("stand", reason, "file")


INERTIA = (
    '<inertial><mass value="2"/>'
    '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>'
)
LIMB = (
    f'<link name="limb">{INERTIA.replace("<mass", """<origin xyz="0.1 0 0.5"/><mass""")}'
    "{collision}</link>"
    '<joint name="shoulder" type="revolute"><parent link="base"/><child link="limb"/>'
    '<origin xyz="0 0 0.05"/><axis xyz="0 1 0"/>'
    '<limit lower="-2" upper="2" effort="9" velocity="9"/></joint>'
)
HAND = (
    f'<link name="hand">{INERTIA}<collision><geometry><mesh filename="no_such.stl"/></geometry>'
    '</collision></link><joint name="wrist" type="{kind}"><parent link="limb"/>'
    '<child link="hand"/><origin xyz="0.02 0 1"/></joint>'
)


@pytest.mark.parametrize(
    ("kind", "reason"), [("fixed", JOINTS_UNDRIVEN), ("continuous", FILE_MISSING)]
)
def test_a_missing_mesh_of_a_limb_that_gives_way_is_not_why_a_robot_falls(tmp_path, kind, reason):
    """A wheel without its mesh may be, although a limb that gives way carries it."""
    base = f'<link name="base">{MASS}{COLLISION}</link>'
    limb = LIMB.replace("{collision}", "") + HAND.replace("{kind}", kind)
    verdict = try_robot(written(tmp_path, base, limb, FOR_GAZEBO), standing=3.0)
    assert any(each.code is FILE_MISSING for each in verdict.diagnostics)
    stand = next(each for each in verdict.faults if each.test == "stand")
    assert (stand.code, stand.source) == (reason, "file")
    if kind == "fixed":
        assert stand.reason.values["joints"] == ("shoulder",)


def test_a_missing_mesh_of_another_link_stays_the_reason(tmp_path):
    mesh = '<collision><geometry><mesh filename="no_such.stl"/></geometry></collision>'
    base = f'<link name="base">{MASS}{mesh}</link>'
    limb = LIMB.replace("{collision}", "")
    verdict = try_robot(written(tmp_path, base, limb, FOR_GAZEBO), standing=3.0)
    stand = next(each for each in verdict.faults if each.test == "stand")
    assert stand.code is FILE_MISSING


SDF_BODY = (
    '<inertial><mass>1</mass></inertial><collision name="c"><geometry><box>'
    "<size>0.1 0.1 0.1</size></box></geometry></collision>"
)
LEG = """<include><uri>model://absent/leg</uri>{name}</include>
<joint name="hip" type="fixed"><parent>body</parent><child>{instance}::{link}</child></joint>
<plugin name="p" filename="gz-sim-joint-position-controller-system">
<joint_name>{instance}::knee</joint_name></plugin>"""


@pytest.mark.parametrize(
    ("name", "instance", "explained"),
    [("<name>l1</name>", "l1", True), ("", "leg", True), ("<name>l1</name>", "l2", False)],
)
def test_what_is_missing_in_a_model_that_was_not_found_is_explained_by_its_include(
    tmp_path, name, instance, explained
):
    leg = LEG.format(name=name, instance=instance, link="thigh")
    path = tmp_path / "model.sdf"
    path.write_text(
        '<sdf version="1.9"><model name="robot"><link name="body"><inertial><mass>1</mass>'
        '</inertial><collision name="c"><pose>0.3 0 0 0 0 0</pose><geometry><box>'
        f"<size>0.1 0.1 0.1</size></box></geometry></collision></link>{leg}</model></sdf>"
    )
    faults = try_robot(path, standing=0.5).faults
    # The model may be elsewhere.
    about = {each.test: (each.code, each.source) for each in faults}
    assert about.keys() == {"plugin", "stand"}
    assert about["stand"] == (FILE_MISSING, "unknown")
    assert (about["plugin"] == (FILE_MISSING, "unknown")) is explained


@pytest.mark.parametrize(
    ("part", "reason"), [("body", "unknown"), ("lidar_3d", "file"), ("camera", "file")]
)
def test_a_body_may_be_in_a_model_that_was_not_found_and_a_sensor_carries_none(
    tmp_path, part, reason
):
    path = tmp_path / "model.sdf"
    path.write_text(
        '<sdf version="1.9"><model name="robot"><link name="mast"><inertial><mass>1</mass>'
        f"</inertial></link><include><uri>model://no_such_{part}</uri></include>"
        f"<plugin name='view' filename='libDrawForcePlugin.so'/></model></sdf>"
    )
    (fault,) = try_robot(path, standing=0.5).faults
    assert (fault.test, fault.source) == ("stand", reason)


def test_a_plugin_may_be_for_what_a_merged_model_contains(tmp_path):
    path = tmp_path / "model.sdf"
    path.write_text(
        f'<sdf version="1.9"><model name="robot"><link name="body">{SDF_BODY}</link>'
        '<include merge="true"><uri>model://no_such_base</uri></include>'
        '<plugin name="p" filename="gz-sim-joint-position-controller-system">'
        "<joint_name>knee</joint_name></plugin></model></sdf>"
    )
    (fault,) = try_robot(path, standing=0.5).faults
    assert (fault.test, fault.code, fault.source) == ("plugin", FILE_MISSING, "unknown")


def test_a_collision_of_a_package_that_is_not_here_is_no_fault_of_the_file(tmp_path):
    mesh = '<collision><geometry><mesh filename="package://no_such_meshes/base.stl"/></geometry>'
    body = f'<link name="base">{MASS}{mesh}</collision></link>'
    (fault,) = try_robot(written(tmp_path, body, FOR_GAZEBO), standing=1.0).faults
    assert (fault.test, fault.code, fault.source) == ("stand", FILE_MISSING, "unknown")


@pytest.mark.parametrize("end", ["jinja", "erb", "in"])
@pytest.mark.parametrize("alone", [False, True])
def test_a_model_that_a_build_makes_from_a_template_is_no_fault_of_the_file(tmp_path, end, alone):
    """Its author need not write the file."""
    body = tmp_path / "models" / "body"
    body.mkdir(parents=True)
    (body / "model.config").write_text(
        '<model><name>body</name><sdf version="1.6">body.sdf</sdf></model>'
    )
    (body / f"body.sdf.{end}").write_text("{{ body }}")
    path = tmp_path / "models" / "robot.sdf"
    camera = f'<link name="camera"><pose>0 0 1 0 0 0</pose>{MASS}</link>'
    path.write_text(
        '<sdf version="1.6"><model name="robot"><include><uri>model://body</uri></include>'
        f"{'' if alone else camera}</model></sdf>"
    )
    verdict = try_robot(path, standing=0.5)
    assert verdict.faults[0].test == "load"
    assert {(each.code, each.source) for each in verdict.faults} == {(FILE_MISSING, "unknown")}
    reason = verdict.faults[0].reason
    assert reason is not None
    assert reason.values["template"] == str(body / f"body.sdf.{end}")
    (body / f"body.sdf.{end}").unlink()
    assert {each.source for each in try_robot(path, standing=0.5).faults} == {"file"}
    for named, source in (("my-body/body.sdf", "file"), ("models/body/body.sdf", "unknown")):
        (tmp_path / "CMakeLists.txt").write_text(f"add_custom_command(OUTPUT {named})")
        assert {each.source for each in try_robot(path, standing=0.5).faults} == {source}


SPAWNED = (
    '<launch><param name="robot_description" command="xacro $(find robot)/robot.urdf.xacro"/>'
    '<node name="s" pkg="gazebo_ros" type="spawn_model" args="-param robot_description"/></launch>'
)
BESIDE = '<xacro:include filename="movers.xacro"/>'


@pytest.mark.parametrize("built", [False, True])
@pytest.mark.parametrize("spawned", [False, True])
def test_what_moves_a_robot_that_is_started_in_gazebo_may_be_in_an_absent_file(
    tmp_path, built, spawned
):
    """Without wheels, nothing shows whether the robot should move."""
    (tmp_path / "package.xml").write_text("<package><name>robot</name></package>")
    if spawned:
        (tmp_path / "robot.launch").write_text(SPAWNED)
    if built:
        (tmp_path / "movers.xacro.in").write_text("@MOVERS@")
    path = expanded(tmp_path, BESIDE, f'<link name="base">{MASS}{COLLISION}</link>')
    verdict = try_robot(path, standing=1.0)
    found = [(each.test, each.code, each.source) for each in verdict.faults]
    if built:
        assert found == ([("plugin", INCLUDE_ABSENT, "unknown")] if spawned else [])
    else:
        # Its xacro stops at the include.
        assert found == [("load", INCLUDE_ABSENT, "file")]
    assert all(bool(each.reason.values["template"]) == built for each in verdict.faults)


def test_an_included_file_of_a_package_that_is_not_here_may_be_another_one(tmp_path):
    """The package may be installed, as that of another robot from which this one was copied."""
    (tmp_path / "package.xml").write_text("<package><name>robot</name></package>")
    (tmp_path / "drive.xacro").write_text(f"<robot>{cart()}</robot>")
    include = '<xacro:include filename="$(find other_robot)/drive.xacro"/>'
    verdict = try_robot(expanded(tmp_path, include), standing=0.5)
    (fault,) = (each for each in verdict.faults if each.test == "load")
    assert (fault.code, fault.source, fault.reason.severity) == (
        FILE_ELSEWHERE,
        "unknown",
        "warning",
    )


@pytest.mark.parametrize("built", [False, True])
def test_what_turns_wheels_may_be_in_a_file_that_a_build_makes(tmp_path, built):
    if built:
        (tmp_path / "movers.xacro.in").write_text("@MOVERS@")
    (fault,) = try_robot(expanded(tmp_path, BESIDE, cart()), standing=1.0).faults
    assert (fault.test, fault.code) == ("plugin" if built else "load", INCLUDE_ABSENT)
    assert fault.source == ("unknown" if built else "file")


@pytest.mark.parametrize(
    ("file", "test"),
    [
        ("$(find robot)/urdf/drive.xacro", "load"),
        ("urdf/drive.xacro", "load"),
        ("../far_robot/drive.xacro", "plugin"),
        ("$(find far_robot)/drive.xacro", "plugin"),
    ],
)
def test_xacro_stops_at_a_file_that_its_own_package_does_not_contain(tmp_path, file, test):
    """A package that is not here may contain the file."""
    folder = tmp_path / "src" / "robot"
    folder.mkdir(parents=True)
    (folder / "package.xml").write_text("<package><name>robot</name></package>")
    include = f'<xacro:include filename="{file}"/>'
    (fault,) = try_robot(expanded(folder, include, cart()), standing=1.0).faults
    source = "unknown" if "far_robot)" in file else "file"
    assert (fault.test, fault.code, fault.source) == (test, INCLUDE_ABSENT, source)


def test_a_robot_whose_base_is_in_an_absent_include_is_incomplete(tmp_path):
    """Only a sensor on an empty link is left, which stands and publishes."""
    sensor = (
        f'<link name="box">{MASS}{COLLISION}</link><joint name="box_joint" type="fixed">'
        '<parent link="base"/><child link="box"/></joint>'
    )
    verdict = try_robot(expanded(tmp_path, INCLUDE, CALL, sensor, FOR_GAZEBO), standing=1.0)
    assert [(each.test, each.code) for each in verdict.faults] == [("plugin", INCLUDE_ABSENT)]
    assert verdict.outcome != "file"
    whole = sensor + '<link name="base"/>'
    (fault,) = try_robot(expanded(tmp_path, INCLUDE, CALL, whole, FOR_GAZEBO), standing=1.0).faults
    # Whether the arm would work is unknown.
    assert (fault.test, fault.code, fault.source) == ("load", MACRO_ABSENT, "unknown")


@pytest.mark.parametrize(
    ("part", "outcome"),
    [
        ('<xacro:if value="$(arg size)"/>', "unknown"),
        ('<xacro:include filename="$(find no_such_package)/arm.xacro"/><xacro:property name="size" '
         'value="${load_yaml(\'$(find no_such_package)/size.yaml\')}"/>${size}', "unknown"),
        # A name is misspelt.
        ('<xacro:arg name="size" default="1"/><xacro:if value="$(arg sise)"/>', "file"),
        ('<xacro:if value="${size}"/>', "file"),
    ],
)  # fmt: skip
def test_a_description_is_not_at_fault_for_what_is_elsewhere(tmp_path, part, outcome):
    verdict = try_robot(expanded(tmp_path, part, f'<link name="base">{MASS}</link>'), standing=1.0)
    assert [each.test for each in verdict.faults] == ["load"]
    assert verdict.outcome == outcome


OWN_INCLUDE = '<xacro:include filename="$(find robot)/urdf/arm.xacro"/>'
STATED = '<xacro:property name="{}" value="2"/>'


@pytest.mark.parametrize(
    ("include", "properties", "source"),
    [
        (INCLUDE, "", "unknown"),
        # A similar name need not be meant.
        (INCLUDE, STATED.format("M_PJ"), "unknown"),
        (INCLUDE + OWN_INCLUDE, "", "unknown"),
        (OWN_INCLUDE, "", "file"),
        ("", "", "file"),
    ],
)
def test_a_package_that_was_not_found_may_define_an_unknown_name(
    tmp_path, include, properties, source
):
    (tmp_path / "package.xml").write_text("<package><name>robot</name></package>")
    own = cart().replace('value="2"', 'value="${J_PJ}"', 1)
    verdict = try_robot(expanded(tmp_path, include, properties, own, plugin()), standing=1.0)
    (fault,) = verdict.faults
    assert (fault.test, fault.code, fault.source) == ("load", XACRO_NAME_UNKNOWN, source)
    assert verdict.outcome == source
