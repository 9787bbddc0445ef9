"""Drives with several pairs of wheels, of which only some are swapped."""

from tests.checks.test_united_drives import cart, found
from tests.corpus.carts import written

from cartwheel.codes.robot import SKID_STEERING, WHEELS_SWAPPED
from cartwheel.corpus import try_robot

DRIVE = (
    '<gazebo><plugin name="drive" filename="libgazebo_ros_skid_steer_drive.so">'
    "<leftFrontJoint>{0}</leftFrontJoint><rightFrontJoint>{1}</rightFrontJoint>"
    "<leftRearJoint>{2}</leftRearJoint><rightRearJoint>{3}</rightRearJoint>"
    "<wheelSeparation>0.4</wheelSeparation><wheelDiameter>0.2</wheelDiameter><torque>20</torque>"
    "</plugin></gazebo>"
)
LEFT, RIGHT = ("front_left_joint", "back_left_joint"), ("front_right_joint", "back_right_joint")


def driven(*joints):
    """The cart of two axles with one drive of four wheels."""
    return cart().partition("\n")[0] + DRIVE.format(*joints)


def test_rear_wheels_that_are_swapped_explain_why_a_robot_hardly_turns(tmp_path):
    path = written(tmp_path, driven(LEFT[0], RIGHT[0], RIGHT[1], LEFT[1]))
    (swapped,) = found(path, WHEELS_SWAPPED)
    assert swapped.values == {"left": RIGHT[1], "right": LEFT[1], "partly": True}
    (fault,) = try_robot(path, standing=1.0).faults
    assert (fault.test, fault.source, fault.code) == ("turn", "file", WHEELS_SWAPPED)


def test_wheels_that_are_not_swapped_only_slide(tmp_path):
    path = written(tmp_path, driven(LEFT[0], RIGHT[0], LEFT[1], RIGHT[1]))
    assert not found(path, WHEELS_SWAPPED)
    assert found(path, SKID_STEERING)


def test_all_wheels_that_are_swapped_are_told_once(tmp_path):
    path = written(tmp_path, driven(RIGHT[0], LEFT[0], RIGHT[1], LEFT[1]))
    assert not [each for each in found(path, WHEELS_SWAPPED) if "partly" in each.values]
