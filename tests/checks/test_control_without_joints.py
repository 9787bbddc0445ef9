"""Controller managers without joints, as the simulation reports them as well."""

import pytest
from tests.corpus.carts import cart, controlled, written
from tests.corpus.test_rivals import MANAGER, managed

from cartwheel.api import World
from cartwheel.checks.checking import check
from cartwheel.codes.devices import CONTROL_WITHOUT_JOINTS, TRANSMISSION_JOINT_UNKNOWN

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
