"""Controller managers without joints, as the simulation reports them as well."""

import pytest
from tests.corpus.carts import cart, controlled, written
from tests.corpus.test_rivals import MANAGER, managed

from cartwheel.api import World
from cartwheel.checks.checking import check
from cartwheel.codes.devices import CONTROL_WITHOUT_JOINTS, TRANSMISSION_JOINT_UNKNOWN
from cartwheel.corpus import try_robot

PARAMETERS = "<parameters>FILE</parameters>"
ROS2 = '<gazebo><plugin name="c" filename="gz_ros2_control-system"/></gazebo>'


@pytest.mark.parametrize(
    ("part", "lacks"),
    [(MANAGER, True), (managed("Effort"), False), (ROS2, True), (controlled, False)],
    ids=["ROS 1", "transmissions", "ROS 2", "ros2_control"],
)
def test_a_manager_without_joints_is_found_without_a_simulation(tmp_path, part, lacks):
    path = written(tmp_path, cart(), part(tmp_path) if callable(part) else part)
    found = [each for each in check(path).findings if each.code is CONTROL_WITHOUT_JOINTS]
    assert len(found) == lacks
    with World("empty", lenient=True) as world:
        world.spawn(path)
        world.run(0.1)
        said = [each for each in world.diagnostics if each.code is CONTROL_WITHOUT_JOINTS]
    assert len(said) == lacks


@pytest.mark.parametrize("managed_by", [MANAGER, ""])
def test_a_transmission_of_a_fixed_joint_is_found_without_a_simulation(tmp_path, managed_by):
    """Without its plugin, nothing reads it."""
    parts = managed("Effort").replace(MANAGER, managed_by)
    robot = cart().replace('type="continuous"', 'type="fixed"', 1)
    found = check(written(tmp_path, robot, parts)).findings
    joints = [each.values["joint"] for each in found if each.code is TRANSMISSION_JOINT_UNKNOWN]
    assert joints == ["left_joint"] * bool(managed_by)


@pytest.mark.parametrize("part", ["", "<ros2_control name='s' type='system'/>"])
def test_without_ros2_control_the_manager_does_not_start_whatever_its_files_contain(tmp_path, part):
    (tmp_path / "base.yaml").write_text("update_rate: 100\n")
    path = written(tmp_path, cart(), part, ROS2.replace("/>", f">{PARAMETERS}</plugin>"))
    path.write_text(path.read_text().replace("FILE", str(tmp_path / "base.yaml")))
    found = [each for each in check(path).findings if each.code is CONTROL_WITHOUT_JOINTS]
    assert [each.severity for each in found] == ["warning" if part else "error"]
    (fault,) = try_robot(path, standing=0.5).faults
    assert fault.source == "file"
    assert (fault.code is CONTROL_WITHOUT_JOINTS) is not bool(part)
