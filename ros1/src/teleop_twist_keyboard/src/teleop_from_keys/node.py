"""The ROS node: keys in, Twist out."""

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
"""s that the last message gets to leave the process."""

NO_KEYS = """\
no keys come from standard input, which is no terminal. Start this in a terminal of its own:
  rosrun teleop_twist_keyboard teleop_twist_keyboard.py
or, in a launch file, give its node launch-prefix="xterm -e"."""


class Teleop:
    """Publishes what a `Driver` says, on ``cmd_vel``; parameters as in teleop_twist_keyboard."""

    def __init__(self, end: int) -> None:
        """`end` is a descriptor that can be read as soon as the program should end."""
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
        """Waits until somebody reads the topic, saying so where it takes a while.

        Returns False where the program should end first.
        """
        told = time.monotonic()
        while not self._publisher.get_num_connections():
            if time.monotonic() - told > 1.0:
                told = time.monotonic() + 4.0
                print(f"waiting: nobody reads {self._publisher.resolved_name} yet")
            if select.select([self._end], [], [], 0.02)[0]:
                return False
        return True

    def run(self) -> int:
        """Takes keys until they end or the program should; returns the exit status."""
        terminal = os.isatty(sys.stdin.fileno())
        if not terminal:
            print("standard input is no terminal: its letters are taken as keys")
        print(f"driving {self._publisher.resolved_name}\n\n{HELP}\n\n{self.driver}")
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
        """Lets the robot stand."""
        self.driver.press("k")
        self.publish()
        time.sleep(FOR_DELIVERY)

    def publish(self) -> None:
        """Sends what the driver says now."""
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
            print(f"faster than {driver.speed:g} m/s is not allowed")
        if driver.turn > self._turn_limit:
            driver.turn = self._turn_limit
            print(f"faster than {driver.turn:g} rad/s is not allowed")
        if (driver.speed, driver.turn) != before:
            print(driver)


def main() -> int:
    """Runs the node; returns the exit status."""
    # rospy would take the node out of the graph before the last stop was sent.
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
    """A descriptor that can be read as soon as a signal asks for the end.

    An exception in the middle of publishing would leave that message in rospy's buffer, to be
    sent once more with the next one.
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
        raise SystemExit(f"the parameter {name} is {value!r}, which is no number") from None


@contextlib.contextmanager
def _single_keys() -> Iterator[None]:
    """Makes a terminal hand over each key as it is pressed, and puts it back as it was."""
    descriptor = sys.stdin.fileno()
    if not os.isatty(descriptor):
        yield
        return
    before = termios.tcgetattr(descriptor)
    try:
        # Ctrl-C stays a signal, which also roslaunch sends.
        tty.setcbreak(descriptor, termios.TCSANOW)
        yield
    finally:
        with contextlib.suppress(termios.error):  # The terminal may be gone.
            termios.tcsetattr(descriptor, termios.TCSANOW, before)


def _read_keys() -> str | None:
    """The keys that are there; None where there will be no more."""
    data = os.read(sys.stdin.fileno(), 64)
    if not data:
        return None
    text = data.decode("utf-8", "replace")
    # An arrow or a function key is an escape and letters that mean nothing here.
    return "k" if text.startswith("\x1b") else "".join(text.split("\n"))
