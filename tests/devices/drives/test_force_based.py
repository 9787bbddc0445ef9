"""The covariance of a drive that is pushed."""

from cartwheel.devices.drives.force_based import covariance
from cartwheel.devices.drives.odometry import UNKNOWN


def test_the_heading_is_uncertain_while_the_robot_turns():
    standing = covariance(z=2.0, turning=False).reshape(6, 6)
    turning = covariance(z=2.0, turning=True).reshape(6, 6)
    assert standing.diagonal().tolist() == [1e-3, 1e-3, 2.0, UNKNOWN, UNKNOWN, 0.01]
    assert turning.diagonal().tolist() == [1e-3, 1e-3, 2.0, UNKNOWN, UNKNOWN, 100.0]
    assert standing.sum() == standing.diagonal().sum()
