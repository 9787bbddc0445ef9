"""Controller files that only a launch file names."""

import pytest
from tests.corpus.carts import cart, controlled

from cartwheel.checks.checking import check
from cartwheel.codes.robot import WHEEL_SEPARATION_MISMATCH
from cartwheel.corpus import try_robot

LAUNCH = """<launch><node pkg="robot_state_publisher" exec="robot_state_publisher">
<param name="robot_description"
value="$(command 'xacro $(find-pkg-share cart)/robot.urdf')"/></node>
<node pkg="controller_manager" exec="ros2_control_node">
<param from="$(find-pkg-share cart)/settings/base.yaml"/></node>
<node pkg="controller_manager" exec="spawner" args="base"/></launch>"""


@pytest.mark.parametrize("named", [True, False])
def test_a_wrong_size_in_a_file_that_a_launch_file_loads_is_found(tmp_path, named):
    package = tmp_path / "cart"
    (package / "settings").mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>cart</name></package>")
    text = controlled(package / "settings", separation=0.4)
    tag = text[text.index("<parameters>") : text.index("</parameters>") + len("</parameters>")]
    path = package / "robot.urdf"
    path.write_text(
        f'<robot name="cart">{cart()}{text if named else text.replace(tag, "")}</robot>'
    )
    (package / "cart.launch.xml").write_text(LAUNCH)
    codes = [each.code for each in check(path).findings]
    assert WHEEL_SEPARATION_MISMATCH in codes
    (fault,) = try_robot(path, standing=1.0).faults
    assert fault.code is WHEEL_SEPARATION_MISMATCH
