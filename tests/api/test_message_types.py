"""Message types from the workspace of a world."""

from tests.coded import raises
from tests.message_packages import write_package

from cartwheel import World
from cartwheel.codes.graph import (
    MESSAGE_DEFINITIONS_DIFFER,
    MESSAGE_TYPE_IN_USE,
    MESSAGE_TYPE_UNKNOWN,
)

CRATE = """<robot name="crate"><link name="base_link">
  <inertial><mass value="1"/>
    <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial>
  <collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision>
</link></robot>
"""


def test_a_world_knows_the_types_of_its_workspace(tmp_path):
    write_package(tmp_path / "here" / "world_msgs", {"msg/Load.msg": "float64 load 2.5\n"})
    with World(package_path=[tmp_path / "here"]) as world, World() as other:
        publisher = world.advertise("/load", "world_msgs/Load")
        got = []
        world.subscribe("/load", got.append, type="world_msgs/msg/Load")
        world.publish("/load")
        world.run(0.01)
        assert got[0].load == 2.5
        publisher.publish(world.message_class("world_msgs/Load")(load=3.0))
        assert got[1].load == 3.0
        # The other world does not see the workspace.
        with raises(MESSAGE_TYPE_UNKNOWN):
            other.message_class("world_msgs/msg/Load")


def test_one_folder_may_be_a_text(tmp_path):
    write_package(tmp_path / "lone_msgs", {"msg/Load.msg": "float64 load\n"})
    with World(package_path=str(tmp_path)) as world:
        assert world.message_class("lone_msgs/Load")(load=3.0).load == 3.0


def test_a_spawned_model_brings_the_types_of_its_workspace(tmp_path):
    write_package(tmp_path / "ws" / "src" / "spawned_msgs", {"msg/Load.msg": "float64 load\n"})
    urdf = tmp_path / "ws" / "src" / "crate" / "crate.urdf"
    write_package(urdf.parent, {"crate.urdf": CRATE})
    with World() as world:
        with raises(MESSAGE_TYPE_UNKNOWN):
            world.advertise("/load", "spawned_msgs/msg/Load")
        world.spawn(urdf)
        assert world.message_class("spawned_msgs/msg/Load")(load=1.0).load == 1.0


def test_the_type_of_another_workspace_does_not_replace_one(tmp_path):
    for name, text in (("a", "float64 load\n"), ("b", "int8 load\n")):
        write_package(tmp_path / name / "mixed_msgs", {"msg/Load.msg": text})
    with World(package_path=[tmp_path / "a"]) as one, World(package_path=[tmp_path / "b"]) as two:
        one.advertise("/load", "mixed_msgs/msg/Load")
        with raises(MESSAGE_TYPE_IN_USE):
            two.advertise("/load", "mixed_msgs/msg/Load")


def test_a_world_reports_that_it_ignores_a_package(tmp_path):
    for name, text in (("a", "float64 load\n"), ("b", "int8 load\n")):
        write_package(tmp_path / name / "copied_msgs", {"msg/Load.msg": text})
    with World(package_path=[tmp_path / "a", tmp_path / "b"]) as world:
        world.advertise("/load", "copied_msgs/msg/Load")
        world.run(0.01)
        (found,) = [each for each in world.diagnostics if each.code is MESSAGE_DEFINITIONS_DIFFER]
        assert found.values["other"] == str(tmp_path / "b/copied_msgs/msg/Load.msg")
