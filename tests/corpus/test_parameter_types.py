"""Parameters for which ROS 2 starts no controller, although Cartwheel does."""

import pytest
from tests.corpus.carts import cart, controlled, written

from cartwheel.checks.checking import check
from cartwheel.codes.devices import CONTROLLER_PARAMETER_TYPE, CONTROLLERS_FILE_UNREADABLE
from cartwheel.corpus import try_robot


def spoilt(folder, old, new):
    robot = written(folder, cart(), controlled(folder))
    file = folder / "base.yaml"
    assert old in file.read_text()
    file.write_text(file.read_text().replace(old, new))
    return robot


@pytest.mark.parametrize(
    ("change", "fault", "line"),
    [
        (
            ("wheel_radius: 0.05", "wheel_radius: 0.05\n    publish_rate: 50"),
            ("base", CONTROLLER_PARAMETER_TYPE),
            10,
        ),
        (
            ("ros__parameters:\n    base:", "ros__parameters:\n    update_rate: 100.0\n    base:"),
            ("gz_ros2_control-system", CONTROLLER_PARAMETER_TYPE),
            3,
        ),
        (
            (
                "wheel_radius: 0.05",
                "wheel_radius: 0.05\n    twist_covariance_diagonal: [0, 0, 0, 0, 0, 0.1]",
            ),
            ("gz_ros2_control-system", CONTROLLERS_FILE_UNREADABLE),
            10,
        ),
    ],
)
def test_a_controller_that_ros_2_does_not_start_is_a_fault_of_the_file(
    change, fault, line, tmp_path
):
    robot = spoilt(tmp_path, *change)
    subject, code = fault
    verdict = try_robot(robot, standing=0.5)
    # Here, it drives.
    assert all(drive.passes for drive in verdict.drives)
    assert verdict.drives
    (found,) = verdict.faults
    assert (found.test, found.subject, found.code) == ("controller", subject, code)
    assert found.reason.origin.line == line
    assert verdict.outcome == "file"
    reported = [each for each in check(robot).findings if each.code is code]
    assert [(each.severity, each.origin.line) for each in reported] == [("error", line)]


def test_how_a_controller_drives_that_ros_2_does_not_start_is_no_fault(tmp_path):
    """The separation is that of wheels further apart, so the base turns too fast."""
    robot = spoilt(tmp_path, "wheel_separation: 0.2", "wheel_separation: 1")
    verdict = try_robot(robot, standing=0.5)
    assert not all(drive.passes for drive in verdict.drives)
    assert [each.code for each in verdict.faults] == [CONTROLLER_PARAMETER_TYPE]
