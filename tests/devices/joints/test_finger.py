"""The angle of a finger's joint."""

from cartwheel.devices.joints.finger import bent


def test_a_joint_bends_in_proportion_up_to_its_limits():
    assert bent(1.0, 4.0, 0.0, 2.0) == 0.25
    assert bent(1.0, -4.0, -1.0, 2.0) == -0.25
    assert bent(100.0, 4.0, 0.0, 2.0) == 2.0
    assert bent(-1.0, 4.0, 0.0, 2.0) == 0.0
