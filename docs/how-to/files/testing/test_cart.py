import pytest

from cartwheel.testing import publishes, reaches, stays_within


@pytest.mark.robot("rosbots.xacro", name="cart")
@pytest.mark.world("walls")
def test_the_cart_reaches_its_target(robot, world):
    robot.publish("/part2_cmr/cmd_vel", linear_x=0.4)
    reaches(robot, (1.0, 0.0), within=0.1, timeout=5)
    publishes(world, "/odom", rate=100)


@pytest.mark.robot("rosbots.xacro")
@pytest.mark.parametrize("turn", [-1.0, 1.0])
def test_the_cart_turns_in_place(robot, turn):
    robot.publish("/part2_cmr/cmd_vel", angular_z=turn)
    stays_within(robot, x=(-0.1, 0.1), y=(-0.1, 0.1), tilt=0.1, seconds=3)
