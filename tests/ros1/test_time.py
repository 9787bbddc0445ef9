"""Simulated time for others: transforms are there when their messages are, at any speed."""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.ros1.desk import Desk, open_desk

LISTENER = """
import sys, time, rospy, tf2_ros
from nav_msgs.msg import Odometry
from sensor_msgs.msg import CameraInfo, Imu, JointState

rospy.init_node("listener", anonymous=True)
buffer = tf2_ros.Buffer()
transforms = tf2_ros.TransformListener(buffer)
rospy.sleep(1.0)
heard, late, back, hearers = {}, {}, {}, []
last = {}

def comes(frame, stamp):
    # With a timeout, `can_transform` would look again after each hundredth of it.
    until = time.monotonic() + 100
    while not buffer.can_transform("odom", frame, stamp):
        if time.monotonic() > until:
            return False
        time.sleep(0.01)
    return True

def hear(name, stamp, frames):
    heard[name] = heard.get(name, 0) + 1
    back[name] = back.get(name, 0) + (stamp <= last.get(name, rospy.Time(0)))
    last[name] = stamp
    # What a message filter waits for: the frames at the message's own time.
    late[name] = late.get(name, 0) + 1
    if all(comes(frame, stamp) for frame in frames):
        late[name] -= 1

def listen(name, kind, frames):
    hearers.append(
        rospy.Subscriber(name, kind, lambda m: hear(name, m.header.stamp, frames), queue_size=1000)
    )

listen("/odom", Odometry, ["base_link", "wheel_left_link"])
listen("/imu/data", Imu, ["base_link"])
listen("/rosbots/camera1/camera_info", CameraInfo, ["camera"])
while len(heard) < len(hearers):
    time.sleep(0.05)
heard.update(dict.fromkeys(heard, 0))
rospy.sleep(float(sys.argv[1]))
for hearer in hearers:
    hearer.unregister()
began = time.monotonic()
while any(late.values()) and time.monotonic() - began < 60:
    time.sleep(0.05)
print("heard", heard)
print("late", late)
print("back", back)
"""


@pytest.fixture
def desk(tmp_path: Path, overlay: object) -> Iterator[Desk]:
    with open_desk(tmp_path) as desk:
        yield desk


@pytest.mark.parametrize("speed", [0.5, 4.0])
def test_transforms_keep_up_with_messages(desk: Desk, tmp_path: Path, speed: float) -> None:
    simulation = desk.terminal()
    program = Path(sys.executable).with_name("cartwheel")
    simulation.type(f"{program} run --headless --ros1 --speed {speed}")
    shell = desk.terminal()
    publisher = desk.terminal()
    publisher.run(f"cd {tmp_path}")
    simulation.wait_for("rosbots in|robot ")
    publisher.run("until rostopic list | grep -q /clock; do sleep 0.2; done")
    publisher.run("rosparam set use_sim_time true")
    publisher.run(
        "rosrun xacro xacro -o robot.urdf $(rospack find rosbots_description)/urdf/rosbots.xacro"
    )
    publisher.run("rosparam set robot_description -t robot.urdf")
    publisher.type("rosrun robot_state_publisher robot_state_publisher")
    (tmp_path / "listener.py").write_text(LISTENER)
    shown = shell.run(f"/usr/bin/python3 {tmp_path}/listener.py {2 * speed}")
    heard, late, back = (
        ast.literal_eval(line.split(" ", 1)[1]) for line in shown.strip().splitlines()[-3:]
    )
    assert heard["/odom"] > 100 * speed
    assert heard["/imu/data"] > 30 * speed
    assert heard["/rosbots/camera1/camera_info"] > 30 * speed
    assert not any(late.values())
    assert not any(back.values())
