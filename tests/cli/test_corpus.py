"""``cartwheel corpus``: status, table and JSON."""

import json

import pytest

from cartwheel.codes.command import NO_ROBOTS

BOX = """<robot name="box"><link name="box">
<inertial><mass value="3"/>
<inertia ixx="0.5" iyy="0.5" izz="0.5" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="1 1 1"/></geometry></collision></link>
<gazebo><plugin name="p" filename="libunheard_of.so"/></gazebo></robot>
"""


def test_a_folder_gives_a_line_for_each_robot(program, tmp_path):
    (tmp_path / "box.urdf").write_text(BOX)
    (tmp_path / "bad.urdf").write_text('<robot name="bad"><link name="a">')
    done = program("corpus", tmp_path, "--for", "1", status=1)
    head, bad, good, *rest = done.stdout.splitlines()
    assert head.split()[:4] == ["robot", "loaded", "mass", "stands"]
    assert bad.split()[1:4] == ["no", "-", "-"]
    assert good.split()[1:5] == ["yes", "3", "kg", "yes"]
    assert good.endswith("missing unheard_of")
    text = "\n".join(rest)
    assert "bad.urdf: fault in the robot's files\n  load: " in text
    assert "missing plugin unheard_of: 1 robot\n" in text
    assert "1 of 2 robots pass all tests; 1 have faults in their files" in text
    assert text.endswith(
        "1 load, 1 stand, and 0 of the 0 robots that should move do so as commanded"
    )


def test_json_has_the_same(program, tmp_path):
    (tmp_path / "box.urdf").write_text(BOX)
    found = json.loads(program("corpus", tmp_path, "--for", "1", "--json").stdout)
    assert found["schema"] == 2
    assert found["summary"]["robots"] == found["summary"]["good"] == found["summary"]["stand"] == 1
    (box,) = found["robots"]
    assert box["verdict"] == "good"
    assert box["faults"] == []
    assert not box["should_move"]
    assert box["mass"] == 3
    assert box["missing_plugins"] == ["unheard_of"]
    assert box["stands"]["state"] == "yes"
    assert box["speed"] > 0


def test_a_model_of_a_world_has_its_own_line(program, tmp_path):
    text = """<sdf version="1.9"><world name="w"><model name="glider"><link name="l"/>
      <plugin name="p" filename="gz-sim-velocity-control-system"/></model></world></sdf>"""
    (tmp_path / "yard.sdf").write_text(text)
    done = program("corpus", tmp_path, "--for", "1", status=None)
    assert done.stdout.splitlines()[1].startswith("yard.sdf: glider")
    found = json.loads(program("corpus", tmp_path, "--for", "1", "--json", status=None).stdout)
    assert [(each["model"], each["name"]) for each in found["robots"]] == [("glider", "glider")]


def test_a_folder_without_robots_is_an_error(program, tmp_path):
    assert f"[{NO_ROBOTS}]" in program("corpus", tmp_path, status=2).stderr
    assert f"[{NO_ROBOTS}]" in program("corpus", tmp_path / "no", status=2).stderr
    (tmp_path / "hand.xacro").write_text(
        '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:macro name="hand"/></robot>'
    )
    said = program("corpus", tmp_path, status=2).stderr
    assert "contains no robot, but 1 with macros only" in said
    assert "that use them" in said


def test_worlds_without_robots_are_counted(program, tmp_path):
    """Also those in folders named worlds, which contain no models."""
    world = '<sdf version="1.9"><world name="w">{}</world></sdf>'
    (tmp_path / "worlds").mkdir()
    (tmp_path / "worlds" / "a.world").write_text(world.format(""))
    said = program("corpus", tmp_path, status=2).stderr
    assert "contains no robot, but 1 world without robots" in said
    (tmp_path / "b.sdf").write_text(world.format('<model name="m"><link name="l"/></model>'))
    said = program("corpus", tmp_path, status=2).stderr
    assert "contains no robot, but 2 worlds without robots" in said
    assert "that the worlds include" in said
    said = program("corpus", tmp_path / "b.sdf", status=2).stderr
    assert "contains no robot, but 1 world without robots" in said


def test_worlds_beside_a_robot_are_skipped(program, tmp_path):
    (tmp_path / "box.urdf").write_text('<robot name="box"><link name="base"/></robot>')
    (tmp_path / "a.world").write_text('<sdf version="1.9"><world name="w"/></sdf>')
    found = json.loads(program("corpus", tmp_path, "--for", "1", "--json", status=None).stdout)
    assert [each["kind"] for each in found["skipped"]] == ["world"]
    assert "skipped: 1 world\n" in program("corpus", tmp_path, "--for", "1", status=None).stdout


def test_the_arguments_of_a_launch_file_are_printed_with_a_fault(program, tmp_path):
    (tmp_path / "package.xml").write_text("<package><name>cart</name></package>")
    (tmp_path / "cart.xacro").write_text(
        '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="cart"><xacro:arg name="sim"'
        ' default="0"/><link name="base"/><xacro:if value="$(arg sim)"><gazebo>'
        '<plugin name="d" filename="libown_drive.so"/></gazebo></xacro:if></robot>'
    )
    (tmp_path / "cart.launch").write_text(
        '<launch><param name="robot_description" '
        'command="xacro $(find cart)/cart.xacro sim:=1"/></launch>'
    )
    done = program("corpus", tmp_path, "--for", "1", status=1)
    (line,) = [each for each in done.stdout.splitlines() if "sim:=1" in each]
    assert "cart.launch" in line


@pytest.mark.parametrize("sideways", [True, False])
def test_the_column_for_sideways_motion_is_printed_if_a_robot_can_move_so(
    program, tmp_path, sideways
):
    plugin = "gz-sim-velocity-control-system" if sideways else "gz-sim-pose-publisher-system"
    (tmp_path / "box.sdf").write_text(
        '<sdf version="1.9"><model name="box"><link name="l"><collision name="c"><geometry><box>'
        "<size>0.2 0.2 0.2</size></box></geometry></collision></link>"
        f'<plugin name="p" filename="{plugin}"/></model></sdf>'
    )
    done = program("corpus", tmp_path, "--for", "1", status=None)
    head, row = (each.split() for each in done.stdout.splitlines()[:2])
    assert ("sideways" in head) == sideways
    if sideways:
        assert row[head.index("sideways")].endswith("%")


ARM = """<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">{}
<link name="a"><inertial><mass value="$(arg size)"/><inertia ixx="0.5" iyy="0.5" izz="0.5"/>
</inertial><collision><geometry><box size="1 1 1"/></geometry></collision></link></robot>
"""


def test_arguments_are_for_the_robots_that_declare_them(program, tmp_path):
    (tmp_path / "arm.urdf.xacro").write_text(ARM.format('<xacro:arg name="size" default="1"/>'))
    (tmp_path / "bare.urdf.xacro").write_text(ARM.format(""))
    (tmp_path / "box.urdf").write_text(BOX)
    words = ("size:=4", tmp_path, "unheard:=1", "--for", "1", "--json")
    done = program("corpus", *words, status=None)
    arm, bare, box = json.loads(done.stdout)["robots"]
    assert [each["mass"] for each in (arm, bare, box)] == [4, 4, 3]
    assert not any("CW123" in text for each in (arm, bare, box) for text in each["diagnostics"])
    warnings = [line for line in done.stderr.splitlines() if "[CW123" in line]
    assert len(warnings) == 1
    assert '"unheard"' in warnings[0]


def test_arguments_without_a_folder_are_an_error(program):
    assert "a folder is missing" in program("corpus", "size:=4", status=2).stderr
