"""Topics that a plugin's <ros> element renames, in all forms that ROS 2 accepts."""

import pytest
from tests.devices.rays.walls import messages, world_of

RAY = "libgazebo_ros_ray_sensor.so"
SCAN = "<output_type>sensor_msgs/LaserScan</output_type>"


def argument(*words: str) -> str:
    return "".join(f"<argument>{word}</argument>" for word in words)


@pytest.mark.parametrize(
    ("rules", "topic"),
    [
        (argument("~/out:=scan"), "/bot/scan"),
        (argument(" ~/out:=/scan "), "/scan"),
        (argument("--ros-args", "-r", "~/out:=scan"), "/bot/scan"),
        (argument("--ros-args", "--remap", "~/out:=scan"), "/bot/scan"),
        (argument("--ros-args", "-p", "a:=1", "--", "~/out:=scan"), "/bot/scan"),
        (argument("cloud:~/out:=scan"), "/bot/scan"),
        ("<remapping>cloud:~/out:=scan</remapping>", "/bot/scan"),
        ("<remapping>rostopic://~/out:=scan</remapping>", "/bot/scan"),
        ("<remapping>cloud:rostopic://~/out:=scan</remapping>", "/bot/scan"),
        ("<remapping>~/out:=~/scan</remapping>", "/bot/cloud/scan"),
        (argument("__ns:=/other", "~/out:=scan"), "/other/scan"),
        # The first rule for a name counts, and arguments come first.
        ("<remapping>~/out:=second</remapping>" + argument("~/out:=first"), "/bot/first"),
        ("<remapping>~/out:=first</remapping><remapping>~/out:=second</remapping>", "/bot/first"),
        # No rules: one without its flag, one for another node, and a parameter.
        (argument("--ros-args", "~/out:=scan"), "/bot/cloud/out"),
        (argument("other:~/out:=scan"), "/bot/cloud/out"),
        (argument("scan"), "/bot/cloud/out"),
    ],
)
def test_a_topic_is_renamed(make, rules, topic):
    world = world_of(make, RAY, f"<ros><namespace>/bot</namespace>{rules}</ros>{SCAN}")
    assert messages(world, topic)
