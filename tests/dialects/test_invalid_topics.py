"""Plugins whose topics have invalid names or types."""

from pathlib import Path

import pytest
from tests.coded import raises

import cartwheel as cw
from cartwheel.codes.graph import GRAPH_NAME_INVALID, TOPIC_TYPE_MISMATCH
from cartwheel.codes.running import PLUGIN_LEFT_OUT
from cartwheel.errors import GraphError

_ROBOT = """<robot name="cart"><link name="base"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link><gazebo>
<plugin name="truth" filename="libgazebo_ros_p3d.so">
<bodyName>base</bodyName><topicName>{topic}</topicName></plugin>
<plugin name="other" filename="libgazebo_ros_p3d.so">
<bodyName>base</bodyName><topicName>truth</topicName></plugin>
</gazebo></robot>"""


@pytest.mark.parametrize(
    ("topic", "code"), [("", GRAPH_NAME_INVALID), ("clock", TOPIC_TYPE_MISMATCH)]
)
def test_the_plugin_is_reported_and_left_out(topic, code, tmp_path: Path):
    file = tmp_path / "cart.urdf"
    file.write_text(_ROBOT.format(topic=topic))
    with cw.World("empty", lenient=True) as world:
        world.spawn(file)
        (found,) = [each for each in world.diagnostics if each.severity == "error"]
        assert found.code is PLUGIN_LEFT_OUT
        assert found.values["plugin"] == "libgazebo_ros_p3d.so"
        assert found.values["cause"] == code.number
        assert str(found.origin).endswith("cart.urdf:3")
        truth = world.mailbox("/truth")
        world.run(0.1)
        assert truth.drain()
    with cw.World("empty") as world:
        with raises(code, GraphError) as caught:
            world.spawn(file)
        assert str(caught.value.origin).endswith("cart.urdf:3")
        assert world.models == ("ground_plane",)
