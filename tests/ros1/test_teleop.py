"""The program teleop_twist_keyboard, its keys pressed at a terminal of its own."""

import json
import os
import pty
import re
import signal
import subprocess
import termios
import time

import pytest

READER = """
import json, sys
import rospy
from geometry_msgs.msg import Twist, TwistStamped
kind = TwistStamped if sys.argv[2] == "stamped" else Twist
def take(message):
    twist = message.twist if kind is TwistStamped else message
    frame = message.header.frame_id if kind is TwistStamped else ""
    line, turn = twist.linear, twist.angular
    print(json.dumps([[line.x, line.y, line.z, turn.z], frame]), flush=True)
rospy.init_node("reader")
rospy.Subscriber(sys.argv[1], kind, take, queue_size=100)
print("ready", flush=True)
rospy.spin()
"""


class Keyboard:
    """The program at a pseudo-terminal, and a node that reads what it publishes."""

    def __init__(self, ros, *arguments, topic="/cmd_vel", kind="plain"):
        ros.master()
        self._reader = ros.python(READER, topic, kind)
        assert self._reader.stdout.readline() == "ready\n"
        self.terminal, slave = pty.openpty()
        self.before = termios.tcgetattr(self.terminal)
        self.process = ros.start(
            ros.overlay.program("teleop_twist_keyboard", "teleop_twist_keyboard.py"), *arguments,
            stdin=slave, stdout=slave, stderr=slave,
        )  # fmt: skip
        os.close(slave)
        self.said = ""
        self.until("Ctrl-C quits")

    def until(self, text):
        """Reads what the terminal shows, until that."""
        while text not in self.said:
            self.said += os.read(self.terminal, 4096).decode()

    def press(self, keys):
        os.write(self.terminal, keys.encode())

    def next(self):
        """The next message: x, y, z, yaw, and the frame of a stamped one."""
        return json.loads(self._reader.stdout.readline())

    def twist(self):
        return self.next()[0]


# The keys as teleop_twist_keyboard's own help shows them.
@pytest.mark.parametrize(
    ("key", "twist"),
    [
        ("i", [0.5, 0, 0, 0]), ("o", [0.5, 0, 0, -1]), ("u", [0.5, 0, 0, 1]),
        ("j", [0, 0, 0, 1]), ("l", [0, 0, 0, -1]), ("k", [0, 0, 0, 0]),
        (",", [-0.5, 0, 0, 0]), (".", [-0.5, 0, 0, 1]), ("m", [-0.5, 0, 0, -1]),
    ],
)  # fmt: skip
def test_plain_keys(key, twist):
    assert pressed(key) == twist


@pytest.mark.parametrize(
    ("key", "twist"),
    [
        ("I", [0.5, 0, 0, 0]), ("O", [0.5, -0.5, 0, 0]), ("U", [0.5, 0.5, 0, 0]),
        ("J", [0, 0.5, 0, 0]), ("L", [0, -0.5, 0, 0]), ("K", [0, 0, 0, 0]),
        ("<", [-0.5, 0, 0, 0]), (">", [-0.5, -0.5, 0, 0]), ("M", [-0.5, 0.5, 0, 0]),
        ("t", [0, 0, 0.5, 0]), ("b", [0, 0, -0.5, 0]),
    ],
)  # fmt: skip
def test_keys_with_shift_and_up_and_down(key, twist):
    assert pressed(key) == twist


def pressed(key):
    from cartwheel.cli.teleop_keys import Driver

    driver = Driver(0.5, 1.0, move=(1, 1, 1, 1))
    driver.press(key)
    return [*driver.linear, driver.angular]


def test_the_tutorials_command_drives_and_stops(ros):
    keyboard = Keyboard(ros, "/cmd_vel:=/part2_cmr/cmd_vel", topic="/part2_cmr/cmd_vel")
    keyboard.press("i")
    assert keyboard.twist() == [0.5, 0, 0, 0]
    keyboard.press("w")
    assert keyboard.twist() == pytest.approx([0.55, 0, 0, 0])
    keyboard.press("e")
    assert keyboard.twist() == pytest.approx([0.55, 0, 0, 0])
    keyboard.press("j")
    assert keyboard.twist() == pytest.approx([0, 0, 0, 1.1])
    keyboard.press("\x1b[A")
    assert keyboard.twist() == [0, 0, 0, 0]
    keyboard.press("u")
    assert keyboard.twist() == pytest.approx([0.55, 0, 0, 1.1])
    os.killpg(keyboard.process.pid, signal.SIGINT)
    assert keyboard.twist() == [0, 0, 0, 0]
    assert keyboard.process.wait(timeout=60) == 0
    assert termios.tcgetattr(keyboard.terminal) == keyboard.before


def test_parameters(ros):
    keyboard = Keyboard(
        ros, "_speed:=0.2", "_turn:=0.4", "_speed_limit:=0.21", "_stamped:=true",
        "_frame_id:=base_link", kind="stamped",
    )  # fmt: skip
    keyboard.press("q")
    keyboard.next()
    keyboard.press("u")
    twist, frame = keyboard.next()
    assert twist == pytest.approx([0.21, 0, 0, 0.44])
    assert frame == "base_link"
    keyboard.until("the speed is limited to 0.21 m/s")
    os.killpg(keyboard.process.pid, signal.SIGTERM)
    assert keyboard.next()[0] == [0, 0, 0, 0]
    assert keyboard.process.wait(timeout=60) == 0


def test_a_rate_repeats_and_a_timeout_stops(ros):
    keyboard = Keyboard(ros, "_repeat_rate:=20", "_key_timeout:=0.5")
    keyboard.press("i")
    twists = [keyboard.twist()]
    while twists[-1] != [0.5, 0, 0, 0]:
        twists.append(keyboard.twist())
    began = time.monotonic()
    moving = 1
    while keyboard.twist() == [0.5, 0, 0, 0]:
        moving += 1
    # One at the key and, until the timeout, one each twentieth of a second; a busy machine
    # may leave some out.
    assert 2 <= moving <= 12
    assert time.monotonic() - began < 100


def test_letters_of_a_pipe_are_keys(ros):
    ros.master()
    reader = ros.python(READER, "/cmd_vel", "plain")
    assert reader.stdout.readline() == "ready\n"
    done = ros.run("rosrun", "teleop_twist_keyboard", "teleop_twist_keyboard.py", input="i\n")
    assert "not a terminal" in done.stdout
    assert json.loads(reader.stdout.readline())[0][0] in (0.5, 0.0)


def test_nothing_to_read_keys_from(ros):
    ros.master()
    reader = ros.python(READER, "/cmd_vel", "plain")
    assert reader.stdout.readline() == "ready\n"
    done = ros.run(
        "rosrun", "teleop_twist_keyboard", "teleop_twist_keyboard.py",
        stdin=subprocess.DEVNULL, status=1,
    )  # fmt: skip
    assert re.search(r"not a terminal.*launch-prefix", done.stderr, re.DOTALL)
