"""Two carts from one file, and robots of others from their own files, through roslaunch."""

from __future__ import annotations

import json
import os
import re
from pathlib import Path
from typing import Any

import pytest

CORPUS = Path(os.environ.get("CARTWHEEL_CORPUS", Path(__file__).parents[3] / "shared" / "corpus"))
needs_corpus = pytest.mark.skipif(not CORPUS.is_dir(), reason="no corpus of robots here")

PACKAGE = """<package format="2"><name>{name}</name><version>1.0.0</version>
  <description>d</description><maintainer email="a@b.c">a</maintainer><license>l</license></package>
"""

DRIVER = """
import json, math, sys, time, rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry

rospy.init_node("driver")
orders, out = json.loads(sys.argv[1]), {}
last = {}

def hear(topic, message):
    last[topic] = message

def place(topic):
    message = last[topic]
    at, turn = message.pose.pose.position, message.pose.pose.orientation
    return [at.x, at.y, 2 * math.atan2(turn.z, turn.w)]

for order in orders:
    rospy.Subscriber(order["odom"], Odometry, lambda m, t=order["odom"]: hear(t, m))
commands = {o["command"]: rospy.Publisher(o["command"], Twist, queue_size=1) for o in orders}
until = time.monotonic() + 120
while len(last) < len({o["odom"] for o in orders}) or not all(
    p.get_num_connections() for p in commands.values()
):
    assert time.monotonic() < until, (sorted(last), sorted(commands))
    time.sleep(0.1)
before = {o["odom"]: place(o["odom"]) for o in orders}
end = rospy.Time.now() + rospy.Duration(4)
while rospy.Time.now() < end:
    for order in orders:
        twist = Twist()
        twist.linear.x, twist.angular.z = order["speed"], order["turn"]
        commands[order["command"]].publish(twist)
    rospy.sleep(0.1)
for order in orders:
    frames = last[order["odom"]].header.frame_id, last[order["odom"]].child_frame_id
    name = order["odom"]
    out[name] = dict(before=before[name], after=place(name), frames=frames)
print(json.dumps(out))
"""


def drive(ros: Any, *orders: dict[str, Any]) -> dict[str, Any]:
    """Drives for 4 s of simulated time; where each robot was and is."""
    file = ros.folder / "driver.py"
    file.write_text(DRIVER)
    done = ros.run("/usr/bin/python3", file, json.dumps(orders))
    answer: dict[str, Any] = json.loads(done.stdout.strip().splitlines()[-1])
    return answer


def listed(ros: Any) -> set[str]:
    return set(ros.run("rostopic", "list").stdout.split())


def launch(ros: Any, *words: str | Path, packages: Path | None = None) -> None:
    path = ros.environment["ROS_PACKAGE_PATH"]
    environment = {"ROS_PACKAGE_PATH": f"{packages}:{path}"} if packages else {}
    # Into a file: nobody reads a pipe here, and a full one would hold roslaunch up.
    with (ros.folder / "launch.log").open("w") as log:
        ros.start("roslaunch", *words, environment=environment, stdout=log, stderr=log)


TWO = """<launch>
  <include file="$(find gazebo_ros)/launch/empty_world.launch">
    <arg name="gui" value="false"/>
  </include>
  <param name="robot_description"
         command="$(find xacro)/xacro '$(find rosbots_description)/urdf/rosbots.xacro'"/>
  <param name="/left/tf_prefix" value="left"/><param name="/right/tf_prefix" value="right"/>
  <node name="a" pkg="gazebo_ros" type="spawn_model"
        args="-urdf -param robot_description -model left -robot_namespace left -y 2"/>
  <node name="b" pkg="gazebo_ros" type="spawn_model"
        args="-urdf -param robot_description -model right -robot_namespace right -y -2"/>
</launch>"""


def test_two_carts_from_one_file_drive_apart(ros: Any) -> None:
    ros.master()
    (ros.folder / "two.launch").write_text(TWO)
    launch(ros, ros.folder / "two.launch")
    reported = drive(
        ros,
        {"odom": "/left/odom", "command": "/left/part2_cmr/cmd_vel", "speed": 0.5, "turn": 0.0},
        {"odom": "/right/odom", "command": "/right/part2_cmr/cmd_vel", "speed": -0.5, "turn": 0.0},
    )
    left, right = reported["/left/odom"], reported["/right/odom"]
    assert left["after"][0] > 1.0
    assert right["after"][0] < -1.0
    assert left["after"][1] == pytest.approx(2.0, abs=0.05)
    assert right["after"][1] == pytest.approx(-2.0, abs=0.05)
    assert left["frames"] == ["left/odom", "left/base_link"]
    assert right["frames"] == ["right/odom", "right/base_link"]
    topics = listed(ros)
    for side in ("left", "right"):
        assert {
            f"/{side}/{name}"
            for name in ("odom", "imu/data", "joint_states", "bumpers", "camera1/image_raw")
        } <= topics
    assert not {"/odom", "/imu/data", "/part2_cmr/cmd_vel"} & topics
    shown = ros.run("rostopic", "echo", "-n4", "/tf").stdout
    frames = set(re.findall(r'frame_id: "(\S+)"', shown))
    assert frames
    assert all(frame.startswith(("left/", "right/")) for frame in frames)


TURTLEBOT = """<launch>
  <arg name="model"/>
  <include file="$(find gazebo_ros)/launch/empty_world.launch">
    <arg name="gui" value="false"/>
  </include>
  <arg name="file" value="$(find turtlebot3_description)/urdf/turtlebot3_$(arg model).urdf.xacro"/>
  <param name="robot_description" command="$(find xacro)/xacro --inorder $(arg file)"/>
  <node pkg="gazebo_ros" type="spawn_model" name="spawn_urdf"
        args="-urdf -model turtlebot3 -z 0.02 -param robot_description"/>
</launch>"""


@needs_corpus
def test_turtlebot3(ros: Any) -> None:
    (ros.folder / "packages").mkdir()
    (ros.folder / "packages" / "turtlebot3_description").symlink_to(
        CORPUS / "turtlebot3" / "turtlebot3_description"
    )
    ros.master()
    (ros.folder / "bot.launch").write_text(TURTLEBOT)
    launch(ros, ros.folder / "bot.launch", "model:=waffle_pi", packages=ros.folder / "packages")
    reported = drive(ros, {"odom": "/odom", "command": "/cmd_vel", "speed": 0.2, "turn": 0.0})
    assert reported["/odom"]["after"][0] - reported["/odom"]["before"][0] > 0.6
    wanted = {"/scan", "/imu", "/joint_states", "/tf", "/camera/rgb/image_raw"}
    assert wanted <= listed(ros)
    assert "ranges: [" in ros.run("rostopic", "echo", "-n1", "/scan").stdout


@needs_corpus
def test_two_pioneers(ros: Any) -> None:
    """multi_robot_scenario.launch of gazebo_plugins' tests, as its authors wrote it."""
    folder = ros.folder / "packages" / "gazebo_plugins"
    folder.mkdir(parents=True)
    (folder / "package.xml").write_text(PACKAGE.format(name="gazebo_plugins"))
    (folder / "test").symlink_to(CORPUS / "gazebo_plugins_tests" / "gazebo_plugins" / "test")
    ros.master()
    file = folder / "test" / "multi_robot_scenario" / "launch" / "multi_robot_scenario.launch"
    launch(ros, file, packages=folder.parent)
    reported = drive(
        ros,
        {"odom": "/r1/odom", "command": "/r1/cmd_vel", "speed": -0.3, "turn": 0.0},
        {"odom": "/r2/odom", "command": "/r2/cmd_vel", "speed": -0.3, "turn": 0.0},
    )
    # They face each other, so backwards is apart.
    r1, r2 = reported["/r1/odom"], reported["/r2/odom"]
    assert r1["after"][1] - r1["before"][1] < -0.6
    assert r2["after"][1] - r2["before"][1] > 0.6
    assert {"/r1/front_laser/scan", "/r2/front_camera/image_raw"} <= listed(ros)


@needs_corpus
def test_mir(ros: Any) -> None:
    """mir_empty_world.launch: its own controllers, remappings, and a world that begins paused."""
    packages = ros.folder / "packages"
    packages.mkdir()
    for name in ("mir_description", "mir_gazebo"):
        (packages / name).symlink_to(CORPUS / "mir_robot" / name)
    ros.master()
    launch(ros, "mir_gazebo", "mir_empty_world.launch", "gui:=false", packages=packages)
    ros.run("rosservice", "call", "--wait", "/gazebo/unpause_physics")
    reported = drive(ros, {"odom": "/odom", "command": "/cmd_vel", "speed": 0.3, "turn": 0.0})
    # Up to 0.3 m/s at no more than 2 m/s².
    assert reported["/odom"]["after"][0] - reported["/odom"]["before"][0] > 0.8
    assert {"/f_scan", "/b_scan", "/imu_data", "/mir/joint_states"} <= listed(ros)
    assert "ranges: [" in ros.run("rostopic", "echo", "-n1", "/f_scan").stdout
