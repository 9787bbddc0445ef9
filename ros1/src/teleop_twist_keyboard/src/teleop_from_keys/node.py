"""The ROS node that converts key presses to Twist messages."""

from __future__ import annotations

import contextlib
import os
import select
import signal
import sys
import termios
import time
import tty
from collections.abc import Iterator
from typing import Any

import rospy
from geometry_msgs.msg import Twist, TwistStamped

from teleop_from_keys.keys import HELP, Driver

FOR_DELIVERY = 0.15
"""Time in s to wait until the last message is sent."""

NO_KEYS = """\
standard input is not a terminal and contains no keys. Run the program in a separate terminal:
  rosrun teleop_twist_keyboard teleop_twist_keyboard.py
In a launch file, set launch-prefix="xterm -e" for the node."""


class Teleop:
    """Publishes the commands of a `Driver` on ``cmd_vel``.

    The parameters are those of the original teleop_twist_keyboard.
    """

    def __init__(self, end: int) -> None:
        """`end` is a descriptor that becomes readable when the program should stop."""
        self._end = end
        number = _parameter
        self.driver = Driver(number("~speed", 0.5), number("~turn", 1.0))
        self._speed_limit = number("~speed_limit", 1000.0)
        self._turn_limit = number("~turn_limit", 1000.0)
        repeat_rate = number("~repeat_rate", 0.0)
        self._repeat = 1.0 / repeat_rate if repeat_rate > 0 else None
        self._timeout = number("~key_timeout", 0.0) or None
        self._frame = str(rospy.get_param("~frame_id", ""))
        self._stamped = bool(rospy.get_param("~stamped", False))
        kind = TwistStamped if self._stamped else Twist
        self._publisher = rospy.Publisher("cmd_vel", kind, queue_size=1)

    def wait_for_reader(self) -> bool:
        """Waits for a subscriber, and prints a message every few seconds.

        Returns:
            False if the program should stop before there is a subscriber.
        """
        printed = time.monotonic()
        while not self._publisher.get_num_connections():
            if time.monotonic() - printed > 1.0:
                printed = time.monotonic() + 4.0
                print(f"waiting for a subscriber on {self._publisher.resolved_name}")
            if select.select([self._end], [], [], 0.02)[0]:
                return False
        return True

    def run(self) -> int:
        """Reads keys until the input ends or the program should stop. Returns the exit status."""
        terminal = os.isatty(sys.stdin.fileno())
        if not terminal:
            print("standard input is not a terminal: its characters are used as keys")
        print(f"publishing on {self._publisher.resolved_name}\n\n{HELP}\n\n{self.driver}")
        keys = 0
        last_key = last_sent = time.monotonic()
        while True:
            wake = []
            if self._repeat:
                wake.append(last_sent + self._repeat)
            if self._timeout and any(self.driver.move):
                wake.append(last_key + self._timeout)
            wait = max(0.0, min(wake) - time.monotonic()) if wake else None
            ready = select.select([sys.stdin, self._end], [], [], wait)[0]
            if self._end in ready:
                print()
                return 0
            if ready:
                pressed = _read_keys()
                if pressed is None:
                    if not keys and not terminal:
                        print(NO_KEYS, file=sys.stderr)
                        return 1
                    return 0
                for key in pressed:
                    keys += 1
                    self._press(key)
                last_key = time.monotonic()
            elif self._timeout and time.monotonic() - last_key >= self._timeout:
                self.driver.press("k")
            self.publish()
            last_sent = time.monotonic()

    def stop(self) -> None:
        """Stops the robot."""
        self.driver.press("k")
        self.publish()
        time.sleep(FOR_DELIVERY)

    def publish(self) -> None:
        """Publishes the current command."""
        message: Any = TwistStamped() if self._stamped else Twist()
        twist = message
        if self._stamped:
            message.header.stamp = rospy.Time.now()
            message.header.frame_id = self._frame
            twist = message.twist
        twist.linear.x, twist.linear.y, twist.linear.z = self.driver.linear
        twist.angular.z = self.driver.angular
        self._publisher.publish(message)

    def _press(self, key: str) -> None:
        driver = self.driver
        before = driver.speed, driver.turn
        driver.press(key)
        if driver.speed > self._speed_limit:
            driver.speed = self._speed_limit
            print(f"the speed is limited to {driver.speed:g} m/s")
        if driver.turn > self._turn_limit:
            driver.turn = self._turn_limit
            print(f"the turning speed is limited to {driver.turn:g} rad/s")
        if (driver.speed, driver.turn) != before:
            print(driver)


def main() -> int:
    """Runs the node; returns the exit status."""
    # On a signal, rospy would shut down the node before the final stop command is sent.
    rospy.init_node("teleop_twist_keyboard", disable_signals=True)
    sys.stdout.reconfigure(line_buffering=True)
    teleop = Teleop(_end_of_program())
    status = 0
    with _single_keys():
        if teleop.wait_for_reader():
            try:
                status = teleop.run()
            finally:
                teleop.stop()
    rospy.signal_shutdown("done")
    return status


def _end_of_program() -> int:
    """Returns a descriptor that becomes readable when the program receives a signal to stop.

    The signal must not raise an exception: during `publish`, the message would remain in rospy's
    buffer, and would be sent again with the next message.
    """
    wakes, wake = os.pipe()
    os.set_blocking(wake, False)
    signal.set_wakeup_fd(wake)
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, lambda _number, _frame: None)
    return wakes


def _parameter(name: str, default: float) -> float:
    value = rospy.get_param(name, default)
    try:
        return float(value)
    except (TypeError, ValueError):
        raise SystemExit(f"the parameter {name} is {value!r}, which is not a number") from None


@contextlib.contextmanager
def _single_keys() -> Iterator[None]:
    """Makes the terminal pass on each key immediately, and restores its settings afterwards."""
    descriptor = sys.stdin.fileno()
    if not os.isatty(descriptor):
        yield
        return
    before = termios.tcgetattr(descriptor)
    try:
        # Ctrl-C still sends a signal, as roslaunch does.
        tty.setcbreak(descriptor, termios.TCSANOW)
        yield
    finally:
        with contextlib.suppress(termios.error):  # The terminal may be gone.
            termios.tcsetattr(descriptor, termios.TCSANOW, before)


def _read_keys() -> str | None:
    """Returns the pressed keys; None at the end of the input."""
    data = os.read(sys.stdin.fileno(), 64)
    if not data:
        return None
    text = data.decode("utf-8", "replace")
    # Arrow and function keys send an escape sequence, whose letters are not commands.
    return "k" if text.startswith("\x1b") else "".join(text.split("\n"))
