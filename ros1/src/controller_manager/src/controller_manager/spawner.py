"""The program spawner: loads and starts controllers, and takes them away when it ends."""

from __future__ import annotations

import argparse
import threading
from pathlib import Path

from controller_manager.services import Manager, ManagerError, join_ros, own_arguments


def main() -> int:
    """Runs the program; returns its exit status."""
    arguments = parse(own_arguments())
    import rospy

    join_ros("spawner")
    manager = Manager(arguments.namespace or "")
    endless = arguments.no_timeout or arguments.timeout <= 0
    try:
        rospy.loginfo("Waiting for the controller manager")
        manager.wait(None if endless else arguments.timeout)
        if arguments.wait_for and not heard(arguments.wait_for):
            return 0
        loaded = load(manager, names_of(arguments.controllers))
        if loaded and not arguments.stopped:
            start(manager, loaded)
    except ManagerError as error:
        if not rospy.is_shutdown():
            rospy.logerr(str(error))
        return 1
    # Services can still be called then, and no longer when `spin` has returned.
    rospy.on_shutdown(lambda: leave(manager, loaded))
    rospy.spin()
    return 0


def parse(words: list[str]) -> argparse.Namespace:
    """The arguments; exits with 2 where they make no sense."""
    parser = argparse.ArgumentParser(
        prog="spawner", description="Loads and starts controllers until it is interrupted."
    )
    parser.add_argument("--stopped", action="store_true", help="load them, but do not start them")
    parser.add_argument("--wait-for", metavar="TOPIC", help="load them when this Bool is true")
    parser.add_argument("--namespace", metavar="NS", help="namespace of the controller manager")
    parser.add_argument(
        "--timeout",
        metavar="SECONDS",
        type=float,
        default=30.0,
        help="how long to wait for the controller manager, 30 s; 0 and less is endless",
    )
    parser.add_argument("--no-timeout", action="store_true", help="wait endlessly")
    parser.add_argument("--shutdown-timeout", metavar="SECONDS", help="of no effect")
    parser.add_argument(
        "controllers",
        metavar="CONTROLLER",
        nargs="+",
        help="a name, or a YAML file whose top-level names are taken after it was loaded",
    )
    return parser.parse_args(words)


def names_of(words: list[str]) -> list[str]:
    """The controllers; a YAML file among the words is put onto the parameter server."""
    import rosparam
    import yaml

    names = []
    for word in words:
        if Path(word).is_file():
            content = yaml.safe_load(Path(word).read_text()) or {}
            rosparam.upload_params("", content)
            names += list(content)
        else:
            names.append(word)
    return names


def heard(topic: str) -> bool:
    """Waits for a true message; false where the program is ended before."""
    import rospy
    from std_msgs.msg import Bool

    came = threading.Event()
    subscriber = rospy.Subscriber(topic, Bool, lambda message: message.data and came.set())
    while not came.wait(0.05):
        if rospy.is_shutdown():
            return False
    subscriber.unregister()
    return True


def load(manager: Manager, names: list[str]) -> list[str]:
    """Loads controllers; returns those that were."""
    import rospy

    loaded = []
    for name in names:
        rospy.loginfo(f"Loading controller: {name}")
        if manager.load(name):
            loaded.append(name)
        else:
            rospy.logerr(f"Failed to load {name}: the simulation says why")
    return loaded


def start(manager: Manager, names: list[str]) -> None:
    """Starts controllers, all or none."""
    import rospy

    if manager.switch(names, []):
        rospy.loginfo(f"Started controllers: {', '.join(names)}")
    else:
        rospy.logerr(f"Failed to start controllers: {', '.join(names)}: the simulation says why")


def leave(manager: Manager, names: list[str]) -> None:
    """Stops and unloads what was loaded, where the simulation is still there."""
    try:
        running = manager.running()
        manager.switch([], [name for name in names if name in running])
        for name in reversed(names):
            manager.unload(name)
    except ManagerError:
        # Often the whole launch ends, and the simulation was faster.
        return
