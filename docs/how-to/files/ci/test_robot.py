import pytest

import cartwheel as cw


def test_the_robot_drives_as_commanded():
    with cw.World("empty", strict=True) as world:
        robot = world.spawn("rosbots.xacro")
        with world.record("drive.mcap", topics=["!*/image*"], overwrite=True):
            robot.publish("/part2_cmr/cmd_vel", linear_x=0.5)
            world.run(seconds=5)
        assert robot.pose.x == pytest.approx(2.375, abs=0.05)
