"""Programs under test, and the processes that they start."""

from __future__ import annotations

import os
import shutil
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from cartwheel.scenarios import Options, Runner, cases_of, digests
from cartwheel.testing import launching
from cartwheel.testing.launching import Launched

STUBBORN = """
import os, signal, subprocess, sys, time
signal.signal(signal.SIGINT, signal.SIG_IGN)
signal.signal(signal.SIGTERM, signal.SIG_IGN)
if len(sys.argv) > 2:
    subprocess.Popen([sys.executable, *sys.argv[:2]], start_new_session=True)
    sys.exit()
print(os.getpid(), file=open(sys.argv[1] + ".new", "w"), flush=True)
os.rename(sys.argv[1] + ".new", sys.argv[1])
time.sleep(600)
"""
NODE = """#!/usr/bin/python3
import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
rospy.init_node("driver")
speed = Twist()
speed.linear.x = rospy.get_param("~speed")
publisher = rospy.Publisher("/part2_cmr/cmd_vel", Twist, queue_size=1)
rate = rospy.Rate(10)
while not rospy.is_shutdown():
    publisher.publish(speed)
    try:
        rate.sleep()
    except rospy.ROSInterruptException:
        pass
"""
LAUNCH = """<launch><node pkg="driver" type="drive.py" name="driver" output="screen">
<param name="speed" value="0.4"/></node></launch>"""
SCENARIO = """
robots: [{robot: rosbots.xacro, name: cart}]
lockstep: {ros1: true, commands: [/part2_cmr/cmd_vel], wall_timeout: 60, late: fail}
launch:
  command: [roslaunch, driver, drive.launch]
  environment: {ROS_PACKAGE_PATH: FOLDER}
duration: 2
expect: [{reaches: cart, x: 0.7, y: 0}]
"""


def eventually(true: Callable[[], bool]) -> bool:
    end = time.monotonic() + 60
    while not true():
        if time.monotonic() > end:
            return False
        time.sleep(0.02)
    return True


def gone(process: int) -> bool:
    try:
        # A zombie, which nobody has waited for, has ended.
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
    except OSError:
        return True


@pytest.mark.parametrize("daemon", [False, True])
def test_it_ends_with_all_processes(tmp_path, monkeypatch, daemon):
    monkeypatch.setattr(launching, "_GRACE", 0.3)
    (tmp_path / "stubborn.py").write_text(STUBBORN)
    reported = tmp_path / "process"
    command = [sys.executable, "stubborn.py", str(reported), *(["daemon"] if daemon else [])]
    with Launched(command, tmp_path, {}):
        assert eventually(reported.exists)
        process = int(reported.read_text())
        assert not gone(process)
        if daemon:
            assert os.getsid(process) == process
    assert eventually(lambda: gone(process))


@pytest.mark.skipif(shutil.which("roslaunch") is None, reason="ROS 1 is not installed")
def test_nodes_that_a_launch_file_starts_drive_in_lockstep(scenario, tmp_path):
    package = tmp_path / "driver"
    package.mkdir()
    (package / "package.xml").write_text(
        "<package><name>driver</name><version>1.0.0</version><description>d</description>"
        '<maintainer email="a@b.c">a</maintainer><license>MIT</license></package>'
    )
    (package / "drive.launch").write_text(LAUNCH)
    (package / "drive.py").write_text(NODE)
    (package / "drive.py").chmod(0o755)
    loaded = scenario(SCENARIO.replace("FOLDER", str(tmp_path)))
    (case,) = digests(loaded, cases_of(loaded))
    options = Options(folder=tmp_path / "out", record="none", pictures="none", allow_launch=True)
    outcomes = [Runner([loaded], options).run(case) for _ in range(2)]
    assert [each.status for each in outcomes] == ["passed", "passed"], (
        outcomes[0].findings, outcomes[0].output,
    )  # fmt: skip
    assert outcomes[0].trajectories == outcomes[1].trajectories
