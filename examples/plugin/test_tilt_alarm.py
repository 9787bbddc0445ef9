"""Tests the plugin in a simulation. Run it with `pytest` after `pip install -e .`."""

from pathlib import Path

import cartwheel as cw

ROBOT = Path(__file__).with_name("robot.urdf")


def test_the_alarm_is_raised_when_the_robot_tips_over() -> None:
    with cw.World("empty", strict=True) as world:
        crate = world.spawn(ROBOT, z=0.1)
        alarms = world.mailbox("/tilt_alarm")
        world.run(seconds=0.5)
        assert [alarm.data for alarm in alarms.drain()] == [False] * 6
        crate.pose = cw.Pose.from_xyz_rpy((0.0, 0.0, 0.5), (0.6, 0.0, 0.0))
        world.run(seconds=0.1)
        assert alarms.drain()[-1].data
