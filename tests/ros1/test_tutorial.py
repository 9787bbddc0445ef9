"""The tutorial's commands as they are written, in its order, typed into terminals.

Real roslaunch, rosmaster, rviz, rostopic and rosrun; a display in memory for rviz.
"""

from __future__ import annotations

import os
import re
import shutil
import socket
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from PIL import Image
from tests.ros1.desk import Desk, open_desk
from tests.ros1.terminal import Terminal

from cartwheel.description import load_robot

NEEDED = ("roslaunch", "rviz", "rostopic", "rosrun", "Xvfb")
missing = [name for name in NEEDED if shutil.which(name) is None]
pytestmark = [
    pytest.mark.skipif(bool(missing), reason=f"not installed: {', '.join(missing)}"),
    pytest.mark.timeout(600),
]

TOPICS = {
    "/bumpers": "gazebo_msgs/ContactsState",
    "/clock": "rosgraph_msgs/Clock",
    "/gazebo/link_states": "gazebo_msgs/LinkStates",
    "/gazebo/model_states": "gazebo_msgs/ModelStates",
    "/imu/data": "sensor_msgs/Imu",
    "/joint_states": "sensor_msgs/JointState",
    "/odom": "nav_msgs/Odometry",
    "/part2_cmr/cmd_vel": "geometry_msgs/Twist",
    "/rosbots/camera1/camera_info": "sensor_msgs/CameraInfo",
    "/rosbots/camera1/image_raw": "sensor_msgs/Image",
    "/rosbots/camera1/image_raw/compressed": "sensor_msgs/CompressedImage",
    "/rosout": "rosgraph_msgs/Log",
    "/tf": "tf2_msgs/TFMessage",
}
SCENE = (slice(70, 740), slice(370, 1170))
"""Rows and columns of rviz's 3D view in its window, as rosbots.rviz lays it out."""
PANEL = (slice(530, 740), slice(12, 330))
"""The same of its image panel."""


@pytest.fixture(scope="module")
def desk(tmp_path_factory: pytest.TempPathFactory, overlay: object) -> Iterator[Desk]:
    with open_desk(tmp_path_factory.mktemp("desk")) as desk:
        yield desk


@pytest.fixture(scope="module")
def rviz(desk: Desk) -> Terminal:
    terminal = desk.terminal(display=True)
    terminal.run("roscd rosbots_description/launch")
    assert terminal.run("pwd").strip().endswith("rosbots_description/launch")
    terminal.type("roslaunch rosbots_description rviz.launch")
    terminal.wait_for(r"process\[rviz-\d+\]: started")
    return terminal


@pytest.fixture(scope="module")
def world(desk: Desk, rviz: Terminal) -> Terminal:
    terminal = desk.terminal()
    terminal.type("roslaunch gazebo_ros empty_world.launch")
    terminal.wait_for(r"process\[gazebo-\d+\]: started")
    return terminal


@pytest.fixture(scope="module")
def spawned(desk: Desk, world: Terminal) -> Terminal:
    terminal = desk.terminal()
    terminal.type("roslaunch rosbots_description spawn.launch")
    terminal.wait_for(r"spawn_rosbots-\d+\] process has finished cleanly")
    return terminal


@pytest.fixture(scope="module")
def shell(desk: Desk, spawned: Terminal) -> Terminal:
    """The learner's last terminal, where short commands are typed."""
    terminal = desk.terminal()
    terminal.run("roscd rosbots_description/launch")
    return terminal


def eventually(condition: Callable[[], bool], seconds: float = 120.0) -> bool:
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        if condition():
            return True
        time.sleep(0.5)
    return condition()


def test_gzclient_prints_where_the_page_is(world: Terminal) -> None:
    address = world.wait_for(r"http://127\.0\.0\.1:(\d+)")
    with socket.create_connection(("127.0.0.1", int(address[1])), timeout=10):
        pass


def test_the_topics_are_those_of_the_tutorial(shell: Terminal) -> None:
    listed = shell.run("rostopic list").split()
    assert set(TOPICS) <= set(listed)
    assert "/rosbots/camera1/image_raw/compressed" in listed
    # One topic a line: " * /imu/data [sensor_msgs/Imu] 1 publisher".
    shown = shell.run("rostopic list -v")
    assert TOPICS.items() <= dict(re.findall(r"^ \* (\S+) \[(\S+)\]", shown, re.M)).items()
    assert shell.run("rostopic type /imu/data").strip() == TOPICS["/imu/data"]


def test_a_post_is_put_before_the_camera(shell: Terminal) -> None:
    shown = shell.run(
        "rosrun gazebo_ros spawn_model -file object.urdf -urdf -x 1 -y 0 -z 1 -model my_object"
    )
    assert "success" in shown.lower()
    reported = shell.run("rosservice call /gazebo/get_world_properties")
    assert "my_object" in reported
    assert "rosbots" in reported


def test_the_imu_is_read(shell: Terminal) -> None:
    shown = shell.run("rostopic echo /imu/data -n1")
    numbers = re.findall(r"linear_acceleration: \n  x: (\S+)\n  y: (\S+)\n  z: (\S+)", shown)
    assert numbers, shown
    x, y, z = (float(number) for number in numbers[0])
    assert abs(x) < 0.2
    assert abs(y) < 0.2
    assert z == pytest.approx(9.8, abs=0.2)


def test_rviz_shows_the_cart_and_its_image(desk: Desk, rviz: Terminal, shell: Terminal) -> None:
    """Model colours in the scene, no white of a link without transform, the post in the panel."""

    found: dict[str, float] = {}

    def seen() -> bool:
        pixels = desk.look().astype(int)
        scene, panel = pixels[SCENE], pixels[PANEL]
        red, green, blue = (scene[..., channel] for channel in range(3))
        cart = ((blue > red + 40) & (blue > green + 10)).sum()
        white = (scene.min(axis=2) > 250).sum()
        found.update(cart=cart, white=white, panel=panel.std())
        return bool(cart > 1500 and white < cart / 4 and panel.std() > 15)

    assert eventually(seen, 240.0), (
        f"{found}, see {desk.folder / 'screen.png'}\n{rviz.said[-3000:]}"
    )
    if pictures := os.environ.get("CARTWHEEL_PICTURES"):
        Image.open(desk.folder / "screen.png").crop((0, 0, 1200, 846)).save(
            Path(pictures) / "rviz.png", optimize=True
        )


LOOK_UP = """
import sys, rospy, tf2_ros
rospy.init_node("look_up", anonymous=True)
buffer = tf2_ros.Buffer()
listener = tf2_ros.TransformListener(buffer)
for link in sys.argv[1:]:
    found = buffer.lookup_transform("odom", link, rospy.Time(0), rospy.Duration(60))
    print(link, found.transform.translation.z)
"""


def test_every_link_has_its_place_below_odom(desk: Desk, shell: Terminal) -> None:
    links = " ".join(link.name for link in load_robot("rosbots.xacro").links)
    (desk.folder / "look_up.py").write_text(LOOK_UP)
    shown = shell.run(f"/usr/bin/python3 {desk.folder}/look_up.py {links}")
    heights = {line.split()[0]: float(line.split()[1]) for line in shown.strip().splitlines()}
    assert sorted(heights) == sorted(links.split())
    assert heights["wheel_left_link"] == pytest.approx(0.26, abs=0.01)
    assert heights["camera_link"] == pytest.approx(0.75 + heights["base_link"], abs=0.01)


def test_the_keyboard_drives_the_cart(desk: Desk, shell: Terminal) -> None:
    positions, speeds = desk.terminal(), desk.terminal()
    positions.type("rostopic echo /odom/pose/pose/position/x")
    speeds.type("rostopic echo /odom/twist/twist/linear/x")

    def shown_next(terminal: Terminal) -> float:
        terminal.forget()
        return float(terminal.wait_for(r"---\n(\S+)\n---")[1])

    def place() -> float:
        return shown_next(positions)

    before = place()
    keys = desk.terminal()
    keys.type("rosrun teleop_twist_keyboard teleop_twist_keyboard.py /cmd_vel:=/part2_cmr/cmd_vel")
    keys.wait_for("linear 0.50 m/s")
    keys.press(",")
    assert eventually(lambda: place() < before - 0.3)
    keys.press("k")

    def speed() -> float:
        return abs(shown_next(speeds))

    assert eventually(lambda: speed() < 0.01)
    held = place()
    assert place() == pytest.approx(held, abs=0.02)
    positions.close_command()
    speeds.close_command()


def test_tf_had_nothing_to_complain_about(rviz: Terminal) -> None:
    rviz.read(0.5)
    complaints = re.findall(r".*(?:TF_|[Ee]xtrapolat|jump back).*", rviz.said)
    assert not complaints


def test_ctrl_c_leaves_nothing_behind(
    world: Terminal, spawned: Terminal, rviz: Terminal, shell: Terminal
) -> None:
    for terminal in (spawned, world, rviz):
        terminal.interrupt()
        assert eventually(lambda terminal=terminal: not terminal.children(), 30.0), terminal.said
